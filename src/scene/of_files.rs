//! A scene for files that are none: meshes and volumes that somebody wants to look at.
//!
//! What comes of it is a text like any other, so that it can be read, edited and saved, and shows how scenes are written.

use super::text::{SCENE, read_text};
use super::tokens::tokens;
use super::write::quoted;
use crate::sources::{self, Kind};
use glam::Vec3;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// How meshes and volumes are to be looked at that say nothing of it themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// The direction that is up in the picture; else +y, and of patients the head.
    pub up: Option<Vec3>,
    /// The direction from what is seen to the camera; else +z, and of patients the front.
    pub front: Option<Vec3>,
}

/// Why there is no scene for a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OfFilesError {
    /// Up and front do not span a picture.
    #[error("`--up` and `--front` must point in different directions, and not both ways along one line")]
    Directions,
    /// Only one scene can be shown.
    #[error("several scenes cannot be shown at once; name one of them, and meshes and volumes beside it")]
    SeveralScenes,
    /// A file that is no mesh or volume cannot be read as a scene either.
    #[error("{message}")]
    Unreadable {
        /// Why.
        message: String,
    },
    /// There is nothing that something could be added to.
    #[error("{}: expected a scene `( entities: {{ … }} )`, which the other files could be added to; name a scene, meshes or volumes", .path.display())]
    NoEntities {
        /// The file.
        path: PathBuf,
    },
}

/// Whether a file is opened as data: a mesh or a volume, as opposed to a scene or something that is neither.
pub fn is_data(path: &Path) -> bool {
    sources::recognise(path).is_some()
}

/// Where the scene that is made for files would stand if it were saved: beside the scene among them, whose paths it takes over, or else in
/// the folder that the program runs in.
pub fn untitled_for(files: &[PathBuf]) -> PathBuf {
    let scene = files.iter().find(|file| !is_data(file));
    scene.map_or_else(|| PathBuf::from(UNTITLED), |scene| scene.with_file_name(UNTITLED))
}

/// The text of a scene that shows `files`, each an entity of its own, as it would stand in a file in `folder`. One of them may be a scene
/// itself, which the others are added to.
///
/// Files that say how they lie in a patient lie so; the camera looks at these from the front, the head up, and stands where everything fills
/// nine tenths of the picture. A strong light comes from beside it, a weak one from its other side.
///
/// # Errors
///
/// If there is no picture for the directions that are asked for, there are several scenes, or one that has no entities.
pub fn scene_of_files(
    files: &[PathBuf],
    folder: &Path,
    orientation: &Orientation,
) -> Result<String, OfFilesError> {
    let kinds: Vec<(&PathBuf, Option<Kind>)> =
        files.iter().map(|file| (file, sources::recognise(file))).collect();
    let has_volumes = kinds.iter().any(|(_, kind)| matches!(kind, Some(Kind::Volume { .. })));
    let is_patient = kinds.iter().any(|(_, kind)| matches!(kind, Some(Kind::Volume { in_patient: true })));
    let view = Basis::new(orientation, is_patient).ok_or(OfFilesError::Directions)?;
    let mut scenes = kinds.iter().filter(|(_, kind)| kind.is_none()).map(|(file, _)| *file);
    let scene = scenes.next();
    if scenes.next().is_some() {
        return Err(OfFilesError::SeveralScenes);
    }
    let mut text = String::new();
    let mut names = BTreeSet::from(RESERVED.map(str::to_owned));
    let mut is_in_metres = false;
    let around = scene.map(|scene| Around::read(scene, &mut names)).transpose()?;
    for (file, kind) in &kinds {
        let Some(kind) = kind else { continue };
        let name = quoted(&free_name(file, &mut names));
        let path = quoted(&relative_to(file, folder));
        _ = match kind {
            Kind::Mesh => {
                let medium =
                    medium_of(file).map(|medium| format!("\n            Subsurface: {},", medium.in_ron()));
                is_in_metres |= medium.is_some();
                let medium = medium.unwrap_or_default();
                writeln!(text, "        {name}: (\n            Mesh: File({path}),{medium}\n        ),")
            }
            Kind::Volume { in_patient } => {
                let file = if *in_patient { format!("path: {path}, place: Patient") } else { path };
                writeln!(
                    text,
                    "        {name}: (\n            Volume: File({file}),\n            TransferFunction: Preset(\"Object\"),\n            \
                     VolumeLighting: Gradient(),\n        ),"
                )
            }
        };
    }
    Ok(match around {
        // A scene has its own camera and lights.
        Some(around) => format!("{}{text}    {}", around.before, around.behind),
        None => format!(
            "{}(\n    background: (0.03, 0.03, 0.035),\n{}    entities: {{\n{text}{}    }},\n)\n",
            heading(files),
            if is_in_metres && !has_volumes { "    millimetres_per_unit: 1000.0,\n" } else { "" },
            view.camera_and_lights()
        ),
    })
}

/// The medium inside a mesh, if its file is of a format that can say so, and does. Its lengths are metres in the file.
fn medium_of(file: &Path) -> Option<sources::MeshSubsurface> {
    let ending = file.extension()?.to_str()?.to_ascii_lowercase();
    // Whatever is wrong with it is told when it is loaded.
    let mesh =
        matches!(ending.as_str(), "gltf" | "glb").then(|| sources::read_mesh(file, Default::default()));
    mesh?.ok()?.medium()
}

/// The text of a scene in front of the bracket that closes its entities, and from there on.
struct Around {
    before: String,
    behind: String,
}

impl Around {
    /// Adds the names that the scene has to `taken`.
    fn read(scene: &Path, taken: &mut BTreeSet<String>) -> Result<Self, OfFilesError> {
        let nothing = || OfFilesError::NoEntities { path: scene.to_owned() };
        let unreadable = |problem: Box<super::Problem>| OfFilesError::Unreadable { message: problem.message };
        let file = read_text(scene, SCENE, true).map_err(unreadable)?;
        let text = file.text();
        let mut open = Vec::new();
        let mut entities = None;
        let mut before = [""; 2];
        for token in tokens(text) {
            let word = &text[token.clone()];
            match word {
                "(" | "[" | "{" => {
                    if word == "{" && open.len() == 1 && before == ["entities", ":"] {
                        entities = Some(open.len());
                    }
                    open.push(token.start);
                }
                ")" | "]" | "}" => {
                    open.pop();
                    if entities == Some(open.len()) {
                        let comma = if matches!(before[1], "," | "{") { "" } else { "," };
                        let inside = text[..token.start].trim_end();
                        let before = format!("{inside}{comma}\n");
                        return Ok(Self { before, behind: text[token.start..].to_owned() });
                    }
                }
                quoted if quoted.starts_with('"') => taken.extend(ron::from_str::<String>(quoted)),
                _ => {}
            }
            before = [before[1], word];
        }
        Err(nothing())
    }
}

/// What a scene that is in no file is called in messages.
const UNTITLED: &str = "untitled.ron";

/// Names of what is there beside the files.
const RESERVED: [&str; 3] = ["camera", "key light", "fill light"];

fn heading(files: &[PathBuf]) -> String {
    let name = |file: &PathBuf| file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
    let names: Vec<String> = files.iter().take(3).map(name).collect();
    let more = if files.len() > 3 { format!(" and {} more", files.len() - 3) } else { String::new() };
    let line: String = format!("{}{more}", names.join(", ")).chars().filter(|c| !c.is_control()).collect();
    format!("// {line}: made by `tyndall new`.\n")
}

/// A name for the entity of a file that no other has.
fn free_name(file: &Path, taken: &mut BTreeSet<String>) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
    let stem = match name.find('.') {
        Some(end) if end > 0 => &name[..end],
        _ => &name,
    };
    let stem: String = stem.chars().filter(|c| !c.is_control() && !matches!(c, '.' | '"' | '\\')).collect();
    let stem = if stem.trim().is_empty() { "data".to_owned() } else { stem };
    let numbered = (1..).map(|number| if number == 1 { stem.clone() } else { format!("{stem} {number}") });
    let free = numbered.into_iter().find(|name| !taken.contains(name)).unwrap_or(stem);
    taken.insert(free.clone());
    free
}

/// The path of a file as a scene in `folder` names it: relative where it lies below, or beside.
pub(super) fn relative_to(file: &Path, folder: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let relative = match (whole(file), whole(folder)) {
        (Ok(file), Ok(folder)) => {
            let near = file.strip_prefix(&folder).map(Path::to_owned);
            let beside = || {
                let rest = file.strip_prefix(folder.parent()?).ok()?;
                Some(Path::new("..").join(rest))
            };
            near.ok().or_else(beside).unwrap_or(file)
        }
        _ => file.to_owned(),
    };
    // The folder itself.
    let relative = if relative.as_os_str().is_empty() { Path::new(".").to_owned() } else { relative };
    relative.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}

/// The directions of a picture in the scene.
struct Basis {
    right: Vec3,
    up: Vec3,
    back: Vec3,
    /// How flat things are seen, unless the front was asked for.
    flat: &'static str,
}

impl Basis {
    fn new(orientation: &Orientation, is_patient: bool) -> Option<Self> {
        let (up, front) = if is_patient { (Vec3::Z, Vec3::Y) } else { (Vec3::Y, Vec3::Z) };
        let up = orientation.up.unwrap_or(up).try_normalize()?;
        let front = match orientation.front {
            Some(front) => front,
            // What is up may leave the usual front behind.
            None if up.cross(front).length() > 1e-3 => front,
            None => up.any_orthonormal_vector(),
        };
        let right = up.cross(front).try_normalize()?;
        let flat = match orientation.front {
            Some(_) => "",
            None if is_patient => ", flat: FrontOnTop",
            None => ", flat: FrontBelow",
        };
        Some(Self { right, up, back: right.cross(up), flat })
    }

    /// The direction that light travels which comes from `right`, `up` and `back` of the camera.
    fn light(&self, right: f32, up: f32, back: f32) -> Vec3 {
        -(self.right * right + self.up * up + self.back * back)
    }

    fn camera_and_lights(&self) -> String {
        let (from, up) = (vector(self.back), vector(self.up));
        let flat = self.flat;
        let key = vector(self.light(-0.5, 0.6, 1.0));
        let fill = vector(self.light(0.8, -0.1, 0.7));
        format!(
            "        \"camera\": (\n            ViewCamera: (up: {up}, frame: (from: {from}{flat}), projection: Perspective(vertical_fov: 25.0)),\n        ),\n        \
             \"key light\": (\n            DirectionalLight: (direction: {key}, irradiance: (2.6, 2.6, 2.6)),\n        ),\n        \
             \"fill light\": (\n            DirectionalLight: (direction: {fill}, irradiance: (0.6, 0.62, 0.65)),\n        ),\n"
        )
    }
}

fn vector(vector: Vec3) -> String {
    let digits = |number: f32| {
        // -0 is written as 0.
        let rounded = (number * 1000.0).round() / 1000.0 + 0.0;
        format!("{rounded:?}")
    };
    format!("({})", vector.to_array().map(digits).join(", "))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn every_file_becomes_an_entity_with_a_name_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("b")).unwrap();
        for name in ["camera.obj", "a.obj", "b/a.obj"] {
            std::fs::write(at(name), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        }
        let files = [at("camera.obj"), at("a.obj"), at("b/a.obj")];
        let text = scene_of_files(&files, folder.path(), &Orientation::default()).unwrap();
        for part in
            ["\"camera 2\": (", "Mesh: File(\"camera.obj\")", "\"a\": (", "\"a 2\": (", "File(\"b/a.obj\")"]
        {
            assert!(text.contains(part), "{part} in {text}");
        }
        let beside = scene_of_files(&files[1..2], &at("b"), &Orientation::default()).unwrap();
        assert!(beside.contains("File(\"../a.obj\")"), "{beside}");
        assert_eq!(relative_to(folder.path(), folder.path()), ".");
    }

    #[test]
    fn files_are_added_to_a_scene() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        for entities in ["{ \"a\": ( Mesh: Box() ) }", "{ \"a\": ( Mesh: Box() ), /* } */ }", "{}"] {
            std::fs::write(at("s.ron"), format!("// {{\n( background: (1, 1, 1), entities: {entities}, )\n"))
                .unwrap();
            let files = [at("a.obj"), at("s.ron")];
            assert_eq!(untitled_for(&files), at("untitled.ron"));
            let text = scene_of_files(&files, folder.path(), &Orientation::default()).unwrap();
            let name = if entities == "{}" { "a" } else { "a 2" };
            assert!(text.contains(&format!("\"{name}\": (\n            Mesh: File(\"a.obj\"),")), "{text}");
            let parsed: Result<ron::Value, _> = ron::from_str(&text);
            assert!(parsed.is_ok(), "{parsed:?} {text}");
        }
        let twice = [at("s.ron"), at("s.ron")];
        assert_eq!(
            scene_of_files(&twice, folder.path(), &Orientation::default()),
            Err(OfFilesError::SeveralScenes)
        );
    }

    #[test]
    fn up_and_front_are_as_asked_for() {
        let view = |up, front| Basis::new(&Orientation { up, front }, false);
        let upright = view(Some(Vec3::Z), None).unwrap();
        assert!(upright.up.abs_diff_eq(Vec3::Z, 1e-6) && upright.back.z.abs() < 1e-6);
        let side = view(None, Some(Vec3::new(2.0, 1.0, 0.0))).unwrap();
        assert!(side.back.abs_diff_eq(Vec3::X, 1e-6), "{}", side.back);
        assert!(view(Some(Vec3::Y), Some(Vec3::NEG_Y)).is_none() && view(Some(Vec3::ZERO), None).is_none());
        let patient = Basis::new(&Orientation::default(), true).unwrap();
        assert!((patient.back, patient.up) == (Vec3::Y, Vec3::Z));
        // Seen from the front, the right hand is on the left.
        assert!(patient.right.abs_diff_eq(Vec3::NEG_X, 1e-6));
    }
}
