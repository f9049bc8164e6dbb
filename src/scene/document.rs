//! A scene as its files say it: every value with its place, nothing in the world yet.

use super::advice::advice;
use super::edit;
use super::names::{nearest_file, suggestion};
use super::parts::{Named, Part};
use super::problem::{Place, Problem, Severity, SourceFile};
use super::reader::{Allowed, Reader};
use super::references::references;
use crate::components::{AssetPath, SceneSettings};
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::{Reflect, TypeInfo, TypeRegistration, TypeRegistry, structs::Struct};
use std::any::TypeId;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A component of an entity as read.
pub struct SceneComponent {
    /// The name that it is written by.
    pub name: String,
    /// Its type.
    pub type_id: TypeId,
    /// Its value, with defaults for what is not written.
    pub value: Box<dyn Reflect>,
}

/// An entity as read.
pub struct SceneEntity {
    /// Its name, which is its identity.
    pub name: String,
    /// Its components, in the order in which they are written.
    pub components: Vec<SceneComponent>,
    /// Where its name stands.
    pub place: Place,
    /// Where each value stands, by its path: `Mesh`, `Mesh.radius`, `TransferFunction.points[2]`.
    places: HashMap<String, Place>,
}

impl SceneEntity {
    /// Whether the value at `path` stands in a file, as opposed to being a default.
    pub fn is_written(&self, path: &str) -> bool {
        self.places.contains_key(path)
    }

    /// Where the value at `path` stands; where it is not written, the nearest thing around it that is.
    pub fn place_of(&self, path: &str) -> Place {
        let mut path = path;
        loop {
            if let Some(place) = self.places.get(path) {
                return place.clone();
            }
            match path.rfind(['.', '[']) {
                Some(end) => path = &path[..end],
                None => return self.place.clone(),
            }
        }
    }
}

/// `entity.Component.field=VALUE`, or `field=VALUE` for the head of the scene: replaces what a file says.
#[derive(Clone, Debug)]
pub struct Override {
    /// What is to be replaced.
    pub path: String,
    /// The RON text to put there.
    pub value: String,
}

impl std::str::FromStr for Override {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, value) =
            text.split_once('=').ok_or("expected entity.Component.field=VALUE, found no `=`")?;
        Ok(Self { path: path.trim().into(), value: value.trim().into() })
    }
}

/// All that the files of a scene say.
#[derive(Default)]
pub struct SceneDocument {
    /// The head.
    pub settings: SceneSettings,
    /// The entities, in the order in which they are written, those of included files first.
    pub entities: Vec<SceneEntity>,
    /// Every file that was read: the scene, what it includes, components kept in files of their own.
    pub files: Vec<PathBuf>,
    /// What is wrong. With errors among them the document is not fit to be shown.
    pub problems: Vec<Problem>,
    /// Where the head's fields stand.
    head: HashMap<String, Place>,
    /// Where each entity is in the list.
    index: HashMap<String, usize>,
    /// The files that could be read.
    sources: HashMap<PathBuf, Arc<SourceFile>>,
}

impl SceneDocument {
    /// Reads the scene at `path` and all that it includes, with `overrides` in force.
    pub fn load(path: &Path, registry: &TypeRegistry, overrides: &[Override]) -> Self {
        let mut texts = HashMap::new();
        let mut document = Self::load_with(path, registry, &texts);
        for change in overrides {
            if document.has_errors() {
                break;
            }
            match edit::apply(&document, change, registry) {
                Ok((file, text)) => {
                    texts.insert(file, text);
                    document = Self::load_with(path, registry, &texts);
                }
                Err(problem) => document.problems.push(*problem),
            }
        }
        document.looked_over()
    }

    /// The same scene with other texts in some of its files. The rest is as it was read, whatever is on disk by now.
    pub(super) fn with_texts(&self, registry: &TypeRegistry, changed: HashMap<PathBuf, String>) -> Self {
        let Some(path) = self.files.first() else { return Self::default() };
        let sources = self.sources.iter().map(|(path, file)| (path.clone(), file.text().to_owned()));
        let mut texts: HashMap<PathBuf, String> = sources.collect();
        texts.extend(changed);
        Self::load_with(path, registry, &texts).looked_over()
    }

    /// With the problems that show only in all of it.
    fn looked_over(mut self) -> Self {
        self.problems.extend(references(&self));
        if !self.has_errors() {
            self.problems.extend(advice(&self));
        }
        self
    }

    /// Whether anything keeps the scene from being shown.
    pub fn has_errors(&self) -> bool {
        self.problems.iter().any(|problem| problem.severity == Severity::Error)
    }

    /// The entity of this name.
    pub fn entity(&self, name: &str) -> Option<&SceneEntity> {
        self.index.get(name).map(|index| &self.entities[*index])
    }

    /// Where a field of the head stands; `""` is the head itself.
    pub(super) fn head_place(&self, field: &str) -> Option<&Place> {
        self.head.get(field)
    }

    fn load_with(path: &Path, registry: &TypeRegistry, texts: &HashMap<PathBuf, String>) -> Self {
        let mut loader = Loader {
            registry,
            texts,
            document: Self::default(),
            settings: SceneSettings::default(),
            read: HashMap::new(),
            included: HashSet::new(),
        };
        loader.included.insert(identity(path));
        loader.file(path, None, true);
        let mut document = loader.document;
        document.settings = loader.settings;
        document.sources = loader.read.into_iter().filter_map(|(path, file)| Some((path, file?))).collect();
        document
    }
}

struct Loader<'a> {
    registry: &'a TypeRegistry,
    /// Texts that stand in for what is on disk.
    texts: &'a HashMap<PathBuf, String>,
    document: SceneDocument,
    settings: SceneSettings,
    /// Every file tried so far, and its text if it has one: what several entities share is read, and reported, once.
    read: HashMap<PathBuf, Option<Arc<SourceFile>>>,
    /// The scene and what it includes, by [`identity`].
    included: HashSet<PathBuf>,
}

impl<'a> Loader<'a> {
    /// Reads a scene file: the scene itself (`main`) or one that it includes.
    fn file(&mut self, path: &Path, named_at: Option<&Place>, main: bool) {
        let Some(file) = self.text(path, named_at) else { return };
        let mut reader = Reader::new(self.registry, file.clone());
        let whole = Part::whole(file.text()).trimmed();
        if whole.text.is_empty() {
            let problem = Problem::error("the file is empty").label("nothing but white space and comments");
            reader.report(&whole, problem.help("a scene is written `( entities: { … } )`"));
        } else {
            self.head(&mut reader, &Part::whole(file.text()), &whole, main);
        }
        self.document.problems.append(&mut reader.problems);
    }

    fn head(&mut self, reader: &mut Reader, file: &Part, whole: &Part, main: bool) {
        // Parsed with what stands around it, so that nothing stands there unnoticed.
        let fields = match file.fields() {
            Ok(fields) => fields,
            Err(misfit) => return reader.report_shape(whole, misfit, "a scene `( entities: { … } )`"),
        };
        if main {
            self.document.head.insert(String::new(), reader.place(whole));
        }
        let mut seen: Vec<(&str, Place)> = Vec::new();
        for Named { name, value } in &fields {
            if let Some((_, first)) = seen.iter().find(|(seen, _)| *seen == name.text) {
                let other = Some((first.clone(), "first written here".into()));
                let problem = Problem {
                    other,
                    ..Problem::error(format!("`{}` is written twice", name.text)).label("again here")
                };
                reader.report(name, problem);
                continue;
            }
            seen.push((name.text, reader.place(name)));
            self.head_field(reader, name, value, main);
        }
    }

    fn head_field(&mut self, reader: &mut Reader, name: &Part, value: &Part, main: bool) {
        match name.text {
            "entities" => self.entities(reader, value),
            "include" => self.includes(reader, value),
            field if main && SETTINGS.contains(&field) => self.setting(reader, field, value),
            field if SETTINGS.contains(&field) => {
                let problem = Problem::error(format!(
                    "`{field}` belongs in the head of the scene, not in a file that it includes"
                ));
                reader.report(name, problem);
            }
            other => {
                let mut known = SETTINGS.to_vec();
                known.extend(["include", "entities"]);
                let problem =
                    Problem::error(format!("a scene has no field `{other}`")).label("unknown field");
                reader.report(name, problem.help(suggestion(other, &known)));
            }
        }
    }

    fn setting(&mut self, reader: &mut Reader, name: &str, part: &Part) {
        self.document.head.insert(name.into(), reader.place(part));
        let registration = self.registry.get(TypeId::of::<SceneSettings>());
        let Some(TypeInfo::Struct(info)) = registration.map(TypeRegistration::type_info) else { return };
        let Some(field) = info.field(name) else { return };
        let Some(registration) = self.registry.get(field.type_id()) else { return };
        let allowed = Allowed::by(field.custom_attributes());
        if let Some(value) = reader.value_at(name, part, registration, allowed)
            && let Some(target) = self.settings.field_mut(name)
        {
            target.apply(value.as_ref());
        }
    }

    fn includes(&mut self, reader: &mut Reader, part: &Part) {
        let Some(registration) = self.registry.get(TypeId::of::<AssetPath>()) else { return };
        let elements = match part.elements() {
            Ok(elements) => elements,
            Err(misfit) => return reader.report_shape(part, misfit, "a list of paths `[\"…\"]`"),
        };
        for element in elements {
            let Some(value) = reader.value_at("include", &element, registration, Allowed::default()) else {
                continue;
            };
            let Some(path) = value.try_downcast_ref::<AssetPath>().map(|path| path.path().to_owned()) else {
                continue;
            };
            if self.included.insert(identity(&path)) {
                self.file(&path, Some(&reader.place(&element)), false);
            }
        }
    }

    fn entities(&mut self, reader: &mut Reader, part: &Part) {
        let entries = match part.entries() {
            Ok(entries) => entries,
            Err(misfit) => {
                return reader.report_shape(part, misfit, "entities by name `{ \"name\": ( … ), … }`");
            }
        };
        self.document.head.entry("entities".into()).or_insert_with(|| reader.place(part));
        for Named { name, value } in entries {
            let place = reader.place(&name);
            let name = match name.read(std::marker::PhantomData::<String>) {
                Ok(text) => text,
                Err(_) => {
                    let message = format!("expected a name in quotes, found `{}`", name.text);
                    let problem = Problem::error(message).help(format!("write `\"{}\"`", name.text));
                    reader.report(&name, problem);
                    continue;
                }
            };
            if let Some(first) = self.document.entity(&name) {
                let elsewhere = first.place.to_string();
                let other = Some((first.place.clone(), "first here".into()));
                let problem =
                    Problem::error(format!("two entities are called `{name}`")).label("again here").at(place);
                reader.problems.push(Problem {
                    other,
                    ..problem.help(format!("the first stands at {elsewhere}; a name is an identity"))
                });
                continue;
            }
            let entity = self.entity(reader, name, place, &value);
            self.document.index.insert(entity.name.clone(), self.document.entities.len());
            self.document.entities.push(entity);
        }
    }

    fn entity(&mut self, reader: &mut Reader, name: String, place: Place, part: &Part) -> SceneEntity {
        let mut entity = SceneEntity { name, components: Vec::new(), place, places: HashMap::new() };
        let fields = match part.fields() {
            Ok(fields) => fields,
            Err(misfit) => {
                reader.report_shape(part, misfit, "components `( Name: value, … )`");
                return entity;
            }
        };
        entity.places.insert(String::new(), reader.place(part));
        let mut names: HashMap<&str, Place> = HashMap::new();
        for Named { name, value } in fields {
            let Some(registration) = self.component_type(reader, &name) else { continue };
            if entity.components.iter().any(|component| component.type_id == registration.type_id()) {
                let other = names.get(name.text).map(|first| (first.clone(), "first written here".into()));
                let message = format!("`{}` is written twice on `{}`", name.text, entity.name);
                let problem = Problem { other, ..Problem::error(message).label("again here") };
                reader.report(&name, problem);
                continue;
            }
            names.insert(name.text, reader.place(&name));
            let value = self.component(reader, name.text, &value, registration);
            entity.places.extend(reader.places.drain(..));
            if let Some(value) = value {
                entity.components.push(SceneComponent {
                    name: name.text.into(),
                    type_id: registration.type_id(),
                    value,
                });
            }
        }
        entity
    }

    /// Reads a component, from its own file where it is written as `File("…")` and the type has no such kind itself.
    fn component(
        &mut self,
        reader: &mut Reader,
        name: &str,
        part: &Part,
        registration: &TypeRegistration,
    ) -> Option<Box<dyn Reflect>> {
        let has_own_files =
            matches!(registration.type_info(), TypeInfo::Enum(info) if info.contains_variant("File"));
        let file_part = if has_own_files { None } else { edit::file_path(part) };
        let Some(path_part) = file_part else { return reader.complete(part, registration, name) };
        let path_type = self.registry.get(TypeId::of::<AssetPath>())?;
        let path = reader.value_at(name, &path_part, path_type, Allowed::default())?;
        let path = path.try_downcast_ref::<AssetPath>()?.path().to_owned();
        let file = self.text(&path, Some(&reader.place(&path_part)))?;
        let mut own = Reader::new(self.registry, file.clone());
        let whole = Part::whole(file.text()).trimmed();
        if whole.text.is_empty() {
            let problem = Problem::error("the file is empty").label("nothing but white space and comments");
            own.report(&whole, problem.help(format!("write what would stand behind `{name}:` in a scene")));
        }
        let value = if whole.text.is_empty() { None } else { own.complete(&whole, registration, name) };
        reader.places.append(&mut own.places);
        // What several entities share is reported once.
        own.problems.retain(|problem| {
            let known = self.document.problems.iter().chain(&reader.problems);
            !known.into_iter().any(|other| other.is_same(problem))
        });
        reader.problems.append(&mut own.problems);
        value
    }

    fn component_type(&self, reader: &mut Reader, name: &Part) -> Option<&'a TypeRegistration> {
        let found = self.registry.get_with_short_type_path(name.text);
        if let Some(registration) =
            found.filter(|registration| registration.data::<ReflectComponent>().is_some())
        {
            return Some(registration);
        }
        let components =
            self.registry.iter().filter(|registration| registration.data::<ReflectComponent>().is_some());
        let mut known: Vec<_> =
            components.map(|registration| registration.type_info().type_path_table().short_path()).collect();
        known.sort_unstable();
        let problem = if self.registry.is_ambiguous(name.text) {
            Problem::error(format!("more than one plugin has a component `{}`", name.text)).label("ambiguous")
        } else {
            Problem::error(format!("there is no component `{}`", name.text))
                .label("unknown component")
                .help(suggestion(name.text, &known))
        };
        reader.report(name, problem);
        None
    }

    fn text(&mut self, path: &Path, named_at: Option<&Place>) -> Option<Arc<SourceFile>> {
        if let Some(file) = self.read.get(path) {
            return file.clone();
        }
        self.document.files.push(path.to_owned());
        let read = match self.texts.get(path) {
            Some(text) => Ok(SourceFile::new(path, text.as_str())),
            None => read_text(path),
        };
        let file = read
            .map_err(|problem| {
                let place = problem.place.clone().or(named_at.cloned());
                self.document.problems.push(problem.at_maybe(place));
            })
            .ok();
        self.read.insert(path.to_owned(), file.clone());
        file
    }
}

/// The same for every way to write the path of a file.
pub(super) fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// The fields of [`SceneSettings`].
pub(super) const SETTINGS: [&str; 5] =
    ["millimetres_per_unit", "background", "shading", "meshes_shade_volumes", "volumes_shade_meshes"];

/// A scene is written by hand; what is larger is not one.
const MAX_SCENE_BYTES: u64 = 64 << 20;

fn read_text(path: &Path) -> Result<Arc<SourceFile>, Box<Problem>> {
    use std::io::Read;
    let unreadable = |error: std::io::Error| {
        Box::new(match error.kind() {
            std::io::ErrorKind::NotFound => {
                let help = nearest_file(path)
                    .map_or("check the path and the folder it is relative to".into(), |near| {
                        format!("did you mean `{near}`?")
                    });
                Problem::error(format!("there is no file {}", path.display())).help(help)
            }
            _ => Problem::error(format!("cannot read {}: {error}", path.display())),
        })
    };
    // Asked before opening: opening a pipe waits for its writer.
    if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        let problem = Problem::error(format!("{} is a folder", path.display()));
        return Err(Box::new(problem.help("name a file in it")));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(unreadable)?;
    file.take(MAX_SCENE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_SCENE_BYTES {
        return Err(Box::new(Problem::error(format!(
            "{} is longer than {MAX_SCENE_BYTES} bytes: is it a scene?",
            path.display()
        ))));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let start = error.utf8_error().valid_up_to();
        let file = SourceFile::new(path, String::from_utf8_lossy(error.as_bytes()).as_ref());
        let bytes = start..start + char::REPLACEMENT_CHARACTER.len_utf8();
        let problem = Problem::error(format!("{} is not UTF-8 text", path.display()));
        Box::new(problem.label("not UTF-8").help("save it as UTF-8").at(Place { file, bytes }))
    })?;
    Ok(SourceFile::new(path, text))
}
