//! What a file seems to be, by its first bytes: for messages about files that are not what was asked for.

use std::path::Path;

/// Bytes of a file that tell what it seems to be.
pub(crate) const HEAD: usize = 512;

/// What is read here, for who gave something else.
pub(crate) const READ_HERE: &str = "read here are scenes (.ron), meshes (.obj, .ply, .stl, .gltf), volumes (.nrrd, .nii, .vtk, .tif, .npy, DICOM)";

/// What a file seems to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seems {
    /// A mesh, in a format of this name.
    Mesh(&'static str),
    /// A volume, in a format of this name.
    Volume(&'static str),
    /// Something else, with its article.
    Other(&'static str),
    /// Text of no kind that is known here.
    Text,
}

impl Seems {
    /// "a mesh (OBJ)", "a PNG picture".
    pub fn words(self) -> String {
        match self {
            Self::Mesh(format) => format!("a mesh ({format})"),
            Self::Volume(format) => format!("a volume ({format})"),
            Self::Other(what) => what.to_owned(),
            Self::Text => "text".to_owned(),
        }
    }
}

/// Formats by the bytes that stand at an offset.
const MAGIC: &[(usize, &[u8], Seems)] = &[
    (0, b"NRRD", Seems::Volume("NRRD")),
    (0, b"# vtk DataFile", Seems::Volume("VTK")),
    (128, b"DICM", Seems::Volume("DICOM")),
    (344, b"n+1\0", Seems::Volume("NIfTI")),
    (344, b"ni1\0", Seems::Volume("NIfTI header")),
    (4, b"n+2\0", Seems::Volume("NIfTI")),
    (0, b"\x93NUMPY", Seems::Volume("NumPy")),
    (0, b"\x89HDF\r\n\x1a\n", Seems::Other("an HDF5 file")),
    (0, b"II*\0", Seems::Volume("TIFF")),
    (0, b"MM\0*", Seems::Volume("TIFF")),
    (0, b"II+\0", Seems::Volume("TIFF")),
    (0, b"MM\0+", Seems::Volume("TIFF")),
    (0, b"\x89PNG\r\n\x1a\n", Seems::Other("a PNG picture")),
    (0, b"\xff\xd8\xff", Seems::Other("a JPEG picture")),
    (0, b"\0\0\0\x0cjP  ", Seems::Other("a JPEG 2000 picture")),
    (0, b"GIF8", Seems::Other("a GIF picture")),
    (0, b"\x76\x2f\x31\x01", Seems::Other("an EXR picture")),
    (0, b"#?RADIANCE", Seems::Other("an HDR picture")),
    (8, b"WEBP", Seems::Other("a WebP picture")),
    (8, b"WAVE", Seems::Other("a sound")),
    (0, b"ID3", Seems::Other("a sound")),
    (0, b"OggS", Seems::Other("a sound or film")),
    (4, b"ftyp", Seems::Other("a film")),
    (0, b"\x1aE\xdf\xa3", Seems::Other("a film")),
    (0, b"%PDF-", Seems::Other("a PDF document")),
    (0, b"%!PS", Seems::Other("a PostScript document")),
    (0, b"PK\x03\x04", Seems::Other("a zip archive")),
    (0, b"PK\x05\x06", Seems::Other("a zip archive")),
    (257, b"ustar", Seems::Other("a tar archive")),
    (0, b"7z\xbc\xaf\x27\x1c", Seems::Other("a 7z archive")),
    (0, b"Rar!\x1a\x07", Seems::Other("a RAR archive")),
    (0, b"BZh", Seems::Other("a bzip2-packed file")),
    (0, b"\xfd7zXZ\0", Seems::Other("an xz-packed file")),
    (0, b"\x28\xb5\x2f\xfd", Seems::Other("a zstd-packed file")),
    (0, b"\x7fELF", Seems::Other("a program or library (ELF)")),
    (0, b"\xcf\xfa\xed\xfe", Seems::Other("a program or library (Mach-O)")),
    (0, b"\xca\xfe\xba\xbe", Seems::Other("a program (Java or Mach-O)")),
    (0, b"\0asm", Seems::Other("a program (WebAssembly)")),
    (0, b"SQLite format 3\0", Seems::Other("a SQLite database")),
    (0, b"glTF", Seems::Mesh("glTF")),
    (0, b"ply\n", Seems::Mesh("PLY")),
    (0, b"ply\r", Seems::Mesh("PLY")),
    (0, b"solid ", Seems::Mesh("STL")),
    (0, b"OFF\n", Seems::Mesh("OFF")),
    (0, b"OFF\r", Seems::Mesh("OFF")),
    (0, b"Kaydara FBX Binary", Seems::Mesh("FBX")),
    (0, b"; FBX", Seems::Mesh("FBX")),
    (0, b"BLENDER", Seems::Other("a Blender file")),
    (0, b"#!/", Seems::Other("a script")),
    (0, b"MZ", Seems::Other("a program or library (Windows)")),
    (0, b"BM", Seems::Other("a BMP picture")),
];

/// What begins with these letters, behind white space and whatever their case.
const WORDS: &[(&str, Seems)] = &[
    ("objecttype", Seems::Volume("MetaImage")),
    ("ndims", Seems::Volume("MetaImage")),
    ("<!doctype html", Seems::Other("a web page")),
    ("<html", Seems::Other("a web page")),
    ("<svg", Seems::Other("an SVG picture")),
];

/// Endings of what is recognised by nothing else.
const ENDINGS: &[(&str, Seems)] = &[
    (".nii.gz", Seems::Volume("NIfTI, packed")),
    (".stl", Seems::Mesh("STL")),
    (".dcm", Seems::Volume("DICOM")),
    (".raw", Seems::Volume("raw samples")),
];

/// What the file at `path` that begins with the bytes of `head`, [`HEAD`] of them if it is as long, seems to be.
pub(crate) fn seems(path: &Path, head: &[u8]) -> Seems {
    if head.is_empty() {
        return Seems::Other("an empty file");
    }
    let text = text_of(head);
    let begins = |(offset, magic, _): &&(usize, &[u8], Seems)| {
        // Two letters are the beginning of many a word.
        (magic.len() > 2 || text.is_none()) && head.get(*offset..).is_some_and(|head| head.starts_with(magic))
    };
    if let Some((.., seems)) = MAGIC.iter().find(begins) {
        return *seems;
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    if let Some((_, seems)) = ENDINGS.iter().find(|(ending, _)| name.ends_with(ending)) {
        return *seems;
    }
    if head.starts_with(&[0x1f, 0x8b]) {
        return Seems::Other("a gzip-packed file");
    }
    match text {
        Some(text) => of_text(text),
        None => Seems::Other("binary data"),
    }
}

/// The head as text, if that is what it is; its last character may be cut.
fn text_of(head: &[u8]) -> Option<&str> {
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&head[..error.valid_up_to()]).ok()?
        }
        Err(_) => return None,
    };
    let is_of_text = |c: char| !c.is_control() || c.is_ascii_whitespace() || c == '\u{1b}' || c == '\u{8}';
    text.chars().all(is_of_text).then_some(text)
}

fn of_text(text: &str) -> Seems {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let begins = |word: &str| text.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    if let Some((_, seems)) = WORDS.iter().find(|(word, _)| begins(word)) {
        return *seems;
    }
    if begins("<?xml") || begins("<") {
        let has = |word: &str| text.contains(word);
        return match () {
            () if has("<VTKFile") => Seems::Volume("VTK XML"),
            () if has("<COLLADA") => Seems::Mesh("COLLADA"),
            () if has("<svg") => Seems::Other("an SVG picture"),
            () => Seems::Other("an XML file"),
        };
    }
    if is_obj(text) { Seems::Mesh("OBJ") } else { Seems::Text }
}

/// Whether all lines but comments begin as those of an OBJ file do, and one of them says something of a mesh.
fn is_obj(text: &str) -> bool {
    const KNOWN: [&str; 13] =
        ["v", "vn", "vt", "vp", "f", "l", "p", "o", "g", "s", "usemtl", "mtllib", "usemap"];
    // The last line may be cut.
    let whole = text.rfind('\n').map_or(text, |end| &text[..end]);
    let firsts = whole.lines().filter_map(|line| line.split_whitespace().next());
    let mut firsts = firsts.filter(|first| !first.starts_with('#')).peekable();
    // A file may open with a comment that is longer than what is looked at.
    let says_so = || text.starts_with('#') && text.to_lowercase().contains("obj");
    match firsts.peek() {
        Some(_) => firsts.all(|first| KNOWN.contains(&first)),
        None => says_so(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_how_they_begin() {
        let at = |offset: usize, magic: &[u8]| [vec![b' '; offset], magic.to_vec()].concat();
        for (name, head, words) in [
            ("a", b"\x89PNG\r\n\x1a\nIHDR".to_vec(), "a PNG picture"),
            ("a.obj", b"# by hand\nv 0 0 0\nv 1 0 0\nf 1 2 3".to_vec(), "a mesh (OBJ)"),
            ("a", b"\xef\xbb\xbfmtllib a.mtl\r\no a\r\n".to_vec(), "a mesh (OBJ)"),
            ("a", at(344, b"n+1\0"), "a volume (NIfTI)"),
            ("a.nii.gz", b"\x1f\x8b\x08\0".to_vec(), "a volume (NIfTI, packed)"),
            ("a.gz", b"\x1f\x8b\x08\0".to_vec(), "a gzip-packed file"),
            ("a", at(128, b"DICM"), "a volume (DICOM)"),
            ("a", b"NRRD0004\n".to_vec(), "a volume (NRRD)"),
            ("a.zip", b"PK\x03\x04".to_vec(), "a zip archive"),
            ("a", b"\x7fELF\x02".to_vec(), "a program or library (ELF)"),
            ("a", b"ObjectType = Image\n".to_vec(), "a volume (MetaImage)"),
            ("a", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">".to_vec(), "a volume (VTK XML)"),
            ("a", b"root:x:0:0:root:/root:/bin/bash\n".to_vec(), "text"),
            ("a", b"f(x) = x\n".to_vec(), "text"),
            ("a", "caf\u{e9}".as_bytes()[..4].to_vec(), "text"),
            ("a", vec![0, 1, 2, 3], "binary data"),
            ("a", Vec::new(), "an empty file"),
        ] {
            assert_eq!(seems(Path::new(name), &head).words(), words, "{head:?}");
        }
    }
}
