//! Pictures that colour surfaces, PNG, JPEG, BMP and TGA, by the crate `image`.

use super::mesh::{TextureImage, quoted};
use super::{SourceError, beside, file, trail};
use std::collections::HashMap;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most texels of a side.
const MOST_TEXELS: u32 = 16_384;

/// Bytes that a picture may take while it is decoded.
const MOST_BYTES: u64 = 1 << 29;

/// The longest file that is read, in bytes.
const MOST_FILE_BYTES: u64 = 1 << 28;

/// Decodes a picture that is in memory.
///
/// # Errors
///
/// What is wrong with it, in words.
pub(super) fn decode(bytes: &[u8]) -> Result<Arc<TextureImage>, String> {
    let mut reader = image::ImageReader::new(Cursor::new(bytes));
    reader = reader.with_guessed_format().map_err(|error| error.to_string())?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MOST_TEXELS);
    limits.max_image_height = Some(MOST_TEXELS);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
    let (width, height) = picture.dimensions();
    if width == 0 || height == 0 {
        return Err("it has no texels".to_owned());
    }
    let texels = picture.pixels().map(|texel| texel.0).collect();
    Ok(Arc::new(TextureImage { width, height, texels }))
}

/// The pictures that a mesh names, each read once.
#[derive(Default)]
pub(super) struct Textures {
    read: HashMap<PathBuf, Option<Arc<TextureImage>>>,
    bytes: usize,
    /// What is to be told.
    pub notes: Vec<String>,
}

impl Textures {
    /// The picture of a name, looked for in these folders. If there is none, or it cannot be read, a note says so.
    pub fn load(&mut self, folders: &[&Path], name: &str) -> Option<Arc<TextureImage>> {
        let Some(path) = find(folders, name) else {
            self.tell(format!("texture `{}` is not there", quoted(name)));
            return None;
        };
        if let Some(known) = self.read.get(&path) {
            return known.clone();
        }
        let picture = match read(&path) {
            Ok(picture) => self.keep(picture),
            Err(problem) => {
                self.tell(format!("texture `{}` cannot be read: {problem}", quoted(name)));
                None
            }
        };
        self.read.insert(path, picture.clone());
        picture
    }

    /// The picture, if there is still room for it.
    pub fn keep(&mut self, picture: Arc<TextureImage>) -> Option<Arc<TextureImage>> {
        self.bytes += picture.texels.len() * 4;
        if self.bytes as u64 > 2 * MOST_BYTES {
            self.tell("textures of more than 1 GiB are left out".to_owned());
            return None;
        }
        Some(picture)
    }

    /// Says something, once.
    pub fn tell(&mut self, note: String) {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }
}

fn read(path: &Path) -> Result<Arc<TextureImage>, String> {
    let without_path = |error: SourceError| error.to_string().replace(&format!("{}: ", path.display()), "");
    let (file, bytes) = file::open(path).map_err(without_path)?;
    if bytes > MOST_FILE_BYTES {
        return Err(format!("{bytes} bytes; at most {MOST_FILE_BYTES} are read"));
    }
    let mut content = Vec::new();
    file.take(MOST_FILE_BYTES).read_to_end(&mut content).map_err(|error| error.to_string())?;
    decode(&content)
}

/// Where a file lies that another one names: in one of the folders, with the path that is written, or with its last part alone, as paths
/// of other machines lead nowhere.
pub(super) fn find(folders: &[&Path], name: &str) -> Option<PathBuf> {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let here = folders.iter().map(|folder| Some(folder.join(name)));
    let other = folders.iter().map(|folder| beside::in_place_of(folder, name));
    let last = folders.iter().map(|folder| Some(folder.join(last)));
    here.chain(other).chain(last).flatten().find(|path| {
        // One that comes later counts as well.
        trail::note(path);
        path.is_file()
    })
}
