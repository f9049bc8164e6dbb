//! `tyndall new`.

use super::arguments::NewArguments;
use super::exit::Failure;
use super::{output, terminal};
use crate::scene::{is_data, scene_of_files};
use crate::whole_file::folder_of;
use std::path::{Path, PathBuf};

mod tour;

pub(super) fn run(arguments: &NewArguments) -> Result<(), Failure> {
    if let Some(output) = &arguments.output {
        return scene_for(arguments, output);
    }
    let [folder] = arguments.paths.as_slice() else {
        return Err(Failure::Usage("for several files, say which scene to write: `-o scene.ron`".into()));
    };
    if is_data(folder) && !folder.is_dir() {
        let message = format!("say which scene to write for {}: `-o scene.ron`", folder.display());
        return Err(Failure::Usage(message));
    }
    if folder.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(Failure::Usage(format!("{} is not empty; nothing was written", folder.display())));
    }
    let files = match () {
        () if arguments.plugin => plugin(folder, arguments.tyndall.as_deref())?,
        () if arguments.tour => {
            tour::FILES.iter().map(|(name, contents)| (*name, contents.to_vec())).collect()
        }
        () => scene(),
    };
    let mut made = Made::default();
    for (name, contents) in files {
        let path = folder.join(name);
        let written = made.folders_to(&path).and_then(|()| output::write(&path, &contents));
        if let Err(failure) = written {
            made.undo();
            return Err(failure);
        }
        made.files.push(path);
    }
    for path in made.files {
        terminal::tell(format_args!("wrote {}", path.display()));
    }
    Ok(())
}

/// Writes a scene that shows the files.
fn scene_for(arguments: &NewArguments, output: &Path) -> Result<(), Failure> {
    let missing = arguments.paths.iter().find(|path| !is_data(path));
    if let Some(path) = missing {
        let message =
            format!("{} is no mesh or volume that is read here; nothing was written", path.display());
        return Err(Failure::Usage(message));
    }
    if output.exists() {
        let message = format!("{} is there already; nothing was written", output.display());
        return Err(Failure::Usage(message));
    }
    output::check_folder(output)?;
    let text = scene_of_files(&arguments.paths, &folder_of(output), &arguments.directions.orientation());
    let text = text.map_err(|error| Failure::Usage(error.to_string()))?;
    output::write(output, text.as_bytes())?;
    terminal::tell(format_args!("wrote {}", output.display()));
    Ok(())
}

/// What was made so far: all of it, or nothing, is to be there in the end.
#[derive(Default)]
struct Made {
    folders: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Made {
    /// Makes the folders that a file lies in.
    fn folders_to(&mut self, path: &Path) -> Result<(), Failure> {
        let missing =
            path.ancestors().skip(1).take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let missing: Vec<&Path> = missing.collect();
        for folder in missing.into_iter().rev() {
            std::fs::create_dir(folder).map_err(|error| {
                Failure::Usage(format!("cannot make the folder {}: {error}", folder.display()))
            })?;
            self.folders.push(folder.to_owned());
        }
        Ok(())
    }

    fn undo(self) {
        // What cannot be taken away either is left.
        self.files.iter().for_each(|file| _ = std::fs::remove_file(file));
        self.folders.iter().rev().for_each(|folder| _ = std::fs::remove_dir(folder));
    }
}

type Files = Vec<(&'static str, Vec<u8>)>;

fn scene() -> Files {
    vec![("scene.ron", include_bytes!("templates/scene.ron").to_vec()), ("scene.raw", cloud())]
}

/// 8 x 8 x 8 samples that fall off from the middle.
fn cloud() -> Vec<u8> {
    let centred = |index: usize| (index as f32 - 3.5) / 3.5;
    let cell = |index: usize| [index % 8, index / 8 % 8, index / 64].map(centred);
    (0..512)
        .map(|index| (255.0 * (1.0 - cell(index).map(|x| x * x).iter().sum::<f32>()).max(0.0)) as u8)
        .collect()
}

fn plugin(folder: &Path, checkout: Option<&Path>) -> Result<Files, Failure> {
    let name = crate_name(folder);
    let tyndall = match checkout {
        Some(checkout) => {
            let absolute = checkout.canonicalize();
            let absolute = absolute
                .map_err(|error| Failure::Usage(format!("cannot find {}: {error}", checkout.display())))?;
            format!("{{ path = {:?} }}", absolute.display().to_string())
        }
        None => format!("{:?}", env!("CARGO_PKG_VERSION")),
    };
    let manifest = include_str!("templates/plugin.toml").replace("NAME", &name).replace("TYNDALL", &tyndall);
    Ok(vec![
        ("Cargo.toml", manifest.into_bytes()),
        ("src/main.rs", include_bytes!("templates/plugin.rs").to_vec()),
        ("scene.ron", include_bytes!("templates/plugin_scene.ron").to_vec()),
    ])
}

/// A name that Cargo takes, as near to the folder's as can be.
fn crate_name(folder: &Path) -> String {
    let folder = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    let name: String = folder.chars().map(|c| if fits(c) { c } else { '_' }).collect();
    match name.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => name,
        _ => format!("plugin_{}", name.trim_matches(['_', '-'])).trim_end_matches('_').into(),
    }
}
