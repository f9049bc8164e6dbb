//! The files of a scene become a document.

use super::document::{Details, Position, SETTINGS, SceneComponent, SceneDocument, SceneEntity, identity};
use super::edit;
use super::frame::Frame;
use super::names::{Known, suggestion};
use super::parts::{Named, Part};
use super::problem::{Place, Problem, SourceFile};
use super::reader::{Allowed, Reader};
use super::text::{COMPONENT, SCENE, read_text, stranger};
use super::wanted::excerpt;
use crate::components::{AssetPath, SceneSettings};
use crate::plain::piece;
use crate::whole_file::folder_of;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::{Reflect, TypeInfo, TypeRegistration, TypeRegistry, structs::Struct};
use std::any::TypeId;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads the scene at `path` with `texts` in place of what is on disk, and takes over from `last` what is the same.
pub(super) fn load(
    path: &Path,
    registry: &TypeRegistry,
    texts: &HashMap<PathBuf, String>,
    last: Option<&SceneDocument>,
) -> SceneDocument {
    let mut loader = Loader {
        registry,
        texts,
        last,
        document: SceneDocument::default(),
        settings: SceneSettings::default(),
        path,
        home: identity(&folder_of(path)),
        read: HashMap::new(),
        fetched: HashMap::new(),
        included: HashSet::new(),
        chain: Vec::new(),
        known: None,
        suggested: HashMap::new(),
        told: HashSet::new(),
        broken: HashSet::new(),
    };
    loader.included.insert(identity(path));
    loader.file(path, None, true);
    let mut document = loader.document;
    document.problems.iter_mut().for_each(Problem::conceal);
    document.settings = loader.settings;
    document.sources = loader.read.into_iter().filter_map(|(path, file)| Some((path, file?))).collect();
    document
}

struct Loader<'a> {
    registry: &'a TypeRegistry,
    /// Texts that stand in for what is on disk.
    texts: &'a HashMap<PathBuf, String>,
    /// What was read before.
    last: Option<&'a SceneDocument>,
    document: SceneDocument,
    settings: SceneSettings,
    /// The scene, and the folder that it is in.
    path: &'a Path,
    home: PathBuf,
    /// Every file tried so far, and its text if it has one: what several entities share is read, and reported, once.
    read: HashMap<PathBuf, Option<Arc<SourceFile>>>,
    /// Files that were looked into, but not used yet.
    fetched: HashMap<PathBuf, Result<Arc<SourceFile>, Box<Problem>>>,
    /// The scene and what it includes, by [`identity`].
    included: HashSet<PathBuf>,
    /// The files that include each other down to the one that is being read.
    chain: Vec<PathBuf>,
    /// The names of all components, once one was asked for that is none.
    known: Option<Vec<Known<'a>>>,
    /// What was said of names that are none of these.
    suggested: HashMap<String, String>,
    /// What was reported of files that several entities share.
    told: HashSet<(Option<Place>, String)>,
    /// Files that hold no component of a type, which was reported.
    broken: HashSet<(PathBuf, TypeId)>,
}

/// Names of no component that it is looked into what may be meant by them.
const MOST_SUGGESTED: usize = 1000;

/// How deep files may include each other.
const MOST_INCLUDES: usize = 64;

impl<'a> Loader<'a> {
    /// Reads a scene file: the scene itself (`main`) or one that it includes.
    fn file(&mut self, path: &Path, named_at: Option<&Place>, main: bool) {
        if self.chain.len() > MOST_INCLUDES {
            let problem = Problem::error(format!(
                "files include each other more than {MOST_INCLUDES} deep: {}",
                self.links(path)
            ));
            let problem = problem.label("one too many").help("include them side by side in one file");
            return self.document.problems.push(problem.at_maybe(named_at.cloned()));
        }
        let Some(file) = self.text(path, SCENE, named_at) else { return };
        self.chain.push(path.to_owned());
        let mut reader = Reader::new(self.registry, file.clone());
        let frame = self.last.and_then(|last| last.frames.get(path)).and_then(|frame| frame.moved(&file));
        if let Some(frame) = frame
            && let (Some(whole), Some(fields), Some(entries)) =
                (frame.whole(), frame.fields(), frame.entries())
        {
            self.head(&mut reader, &whole, &fields, Some(entries), main);
            self.document.frames.insert(path.to_owned(), frame);
        } else {
            self.new_file(&mut reader, &file, named_at, main);
        }
        self.document.problems.append(&mut reader.problems);
        self.chain.pop();
    }

    /// The files that lead to one, as far as one may care to read.
    fn links(&self, path: &Path) -> String {
        let name =
            |path: &Path| format!("`{}`", piece(&path.file_name().unwrap_or_default().to_string_lossy()));
        let first = self.chain.iter().take(2).map(|path| name(path));
        let last = self.chain.iter().rev().take(1).map(|path| name(path));
        let all: Vec<String> = first.chain(["…".to_owned()]).chain(last).chain([name(path)]).collect();
        all.join(" > ")
    }

    /// Takes a file apart.
    fn new_file(&mut self, reader: &mut Reader, file: &SourceFile, named_at: Option<&Place>, main: bool) {
        let whole = Part::whole(file.text()).trimmed();
        if whole.text.is_empty() {
            let problem = Problem::error("the file is empty").label("nothing but white space and comments");
            return reader.report(&whole, problem.help("a scene is written `( entities: { … } )`"));
        }
        // Parsed with what stands around it, so that nothing stands there unnoticed.
        match Part::whole(file.text()).fields() {
            Ok(fields) => self.head(reader, &whole, &fields, None, main),
            Err(misfit) => match stranger(file, SCENE) {
                Some(problem) => reader.problems.push(problem.at_maybe(named_at.cloned())),
                None => reader.report_shape(&whole, misfit, "a scene `( entities: { … } )`"),
            },
        }
    }

    /// Reads the fields of a file. `entries` are the entities, where it is known already where they are.
    fn head(
        &mut self,
        reader: &mut Reader,
        whole: &Part,
        fields: &[Named],
        mut entries: Option<Vec<(String, Named)>>,
        main: bool,
    ) {
        if main {
            self.document.head.insert(String::new(), reader.place(whole));
        }
        let mut seen: HashMap<&str, Place> = HashMap::new();
        for Named { name, value } in fields {
            if let Some(first) = seen.get(name.text) {
                let other = Some((first.clone(), "first written here".into()));
                let problem = Problem {
                    other,
                    ..Problem::error(format!("`{}` is written twice", name.text)).label("again here")
                };
                reader.report(name, problem);
                continue;
            }
            seen.insert(name.text, reader.place(name));
            if name.text != "entities" {
                self.head_field(reader, name, value, main);
                continue;
            }
            let before = reader.problems.len();
            let is_known = entries.is_some();
            let Some(entries) = entries.take().or_else(|| Self::entries(reader, value)) else { continue };
            if !is_known && reader.problems.len() == before {
                let names = entries.iter().map(|(name, parts)| (name.as_str(), parts));
                let frame = Frame::new(&reader.file, whole, fields, names);
                self.document.frames.insert(reader.file.path().to_owned(), frame);
            }
            self.entities(reader, value, entries);
        }
    }

    fn head_field(&mut self, reader: &mut Reader, name: &Part, value: &Part, main: bool) {
        match name.text {
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
                let known: Vec<Known> = known.into_iter().map(Known::plain).collect();
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

    /// The entities by name.
    fn entries<'t>(reader: &mut Reader, part: &Part<'t>) -> Option<Vec<(String, Named<'t>)>> {
        let entries = match part.entries() {
            Ok(entries) => entries,
            Err(misfit) => {
                reader.report_shape(part, misfit, "entities by name `{ \"name\": ( … ), … }`");
                return None;
            }
        };
        let mut named = Vec::new();
        for entry in entries {
            match entry.name.read(std::marker::PhantomData::<String>) {
                Ok(text) => named.push((text, entry)),
                Err(_) => {
                    let text = excerpt(entry.name.text);
                    let problem = Problem::error(format!("expected a name in quotes, found `{text}`"));
                    reader.report(&entry.name, problem.help(format!("write `\"{text}\"`")));
                }
            }
        }
        Some(named)
    }

    fn entities(&mut self, reader: &mut Reader, part: &Part, entries: Vec<(String, Named)>) {
        self.document.head.entry("entities".into()).or_insert_with(|| reader.place(part));
        self.document.entities.reserve(entries.len());
        self.document.index.reserve(entries.len());
        for (name, Named { name: key, value }) in entries {
            let place = reader.place(&key);
            if let Some(first) = self.document.entity(&name) {
                let elsewhere = first.place.to_string();
                let other = Some((first.place.clone(), "first here".into()));
                let problem = Problem::error(format!("two entities are called `{}`", piece(&name)))
                    .label("again here")
                    .at(place);
                reader.problems.push(Problem {
                    other,
                    ..problem.help(format!("the first stands at {elsewhere}; a name is an identity"))
                });
                continue;
            }
            let entity = match self.as_before(reader, &name, &place, &value) {
                Some(entity) => entity,
                None => self.entity(reader, name, place, &value),
            };
            self.document.index.insert(entity.name.clone(), self.document.entities.len());
            self.document.entities.push(entity);
        }
    }

    /// The entity of an earlier document, if neither its text nor that of the files of its components has changed.
    fn as_before(&mut self, reader: &Reader, name: &str, place: &Place, part: &Part) -> Option<SceneEntity> {
        let before = self.last?.entity(name)?;
        let is_same = before.details.is_sound
            && before.place.file.path() == reader.file.path()
            && before.text() == part.text;
        if !is_same || !before.details.files.iter().all(|file| self.is_as_before(file)) {
            return None;
        }
        for file in &before.details.files {
            self.text(file.path(), COMPONENT, Some(place));
        }
        Some(SceneEntity { place: place.clone(), bytes: part.bytes(), ..before.clone() })
    }

    fn is_as_before(&mut self, before: &Arc<SourceFile>) -> bool {
        let path = before.path();
        if let Some(file) = self.read.get(path) {
            return file.as_ref().is_some_and(|file| Arc::ptr_eq(file, before));
        }
        let fetched = self.fetch(path, COMPONENT);
        let is_same = fetched.as_ref().is_ok_and(|file| Arc::ptr_eq(file, before));
        self.fetched.insert(path.to_owned(), fetched);
        is_same
    }

    fn entity(&mut self, reader: &mut Reader, name: String, place: Place, part: &Part) -> SceneEntity {
        let before = reader.problems.len();
        // Those of what stands in front of the entities.
        reader.places.clear();
        let mut details = Details::default();
        let bytes = part.bytes();
        let (components, written) = match part.fields() {
            Ok(fields) => {
                let written = fields.len();
                let components = self.components(reader, &name, fields, &mut details);
                reader.places.push((String::new(), reader.place(part)));
                (components, written)
            }
            Err(misfit) => {
                reader.report_shape(part, misfit, "components `( Name: value, … )`");
                (Vec::new(), 0)
            }
        };
        // What is wrong with a file that entities share is reported once, and yet none of them is sound.
        details.is_sound = reader.problems.len() == before && components.len() == written;
        let position = |place: Place| {
            let is_within = bytes.start <= place.bytes.start && place.bytes.end <= bytes.end;
            match Arc::ptr_eq(&place.file, &reader.file) && is_within {
                true => Position::Within(place.bytes.start - bytes.start..place.bytes.end - bytes.start),
                false => Position::Elsewhere(place),
            }
        };
        details.places = reader.places.drain(..).map(|(path, place)| (path, position(place))).collect();
        SceneEntity { name, components: components.into(), place, bytes, details: Arc::new(details) }
    }

    fn components(
        &mut self,
        reader: &mut Reader,
        entity: &str,
        fields: Vec<Named>,
        details: &mut Details,
    ) -> Vec<SceneComponent> {
        let mut components: Vec<SceneComponent> = Vec::new();
        let mut names: HashMap<&str, Place> = HashMap::new();
        for Named { name, value } in fields {
            let Some(registration) = self.component_type(reader, &name) else { continue };
            let type_id = registration.type_id();
            if components.iter().any(|component| component.type_id == type_id) {
                let other = names.get(name.text).map(|first| (first.clone(), "first written here".into()));
                let message = format!("`{}` is written twice on `{}`", name.text, piece(entity));
                let problem = Problem { other, ..Problem::error(message).label("again here") };
                reader.report(&name, problem);
                continue;
            }
            names.insert(name.text, reader.place(&name));
            let value = self.component(reader, name.text, &value, registration, &mut details.files);
            if let Some(value) = value {
                components.push(SceneComponent { name: name.text.into(), type_id, value });
            }
        }
        components
    }

    /// Reads a component, from its own file where it is written as `File("…")` and the type has no such kind itself.
    fn component(
        &mut self,
        reader: &mut Reader,
        name: &str,
        part: &Part,
        registration: &TypeRegistration,
        files: &mut Vec<Arc<SourceFile>>,
    ) -> Option<Box<dyn Reflect>> {
        let has_own_files =
            matches!(registration.type_info(), TypeInfo::Enum(info) if info.contains_variant("File"));
        let file_part = if has_own_files { None } else { edit::file_path(part) };
        let Some(path_part) = file_part else { return reader.complete(part, registration, name) };
        let path_type = self.registry.get(TypeId::of::<AssetPath>())?;
        let path = reader.value_at(name, &path_part, path_type, Allowed::default())?;
        let path = path.try_downcast_ref::<AssetPath>()?.path().to_owned();
        let file = self.text(&path, COMPONENT, Some(&reader.place(&path_part)))?;
        files.push(file.clone());
        if self.broken.contains(&(path.clone(), registration.type_id())) {
            return None;
        }
        let mut own = Reader::new(self.registry, file);
        let value = own.whole_file(registration, name);
        reader.places.append(&mut own.places);
        if value.is_none() {
            self.broken.insert((path, registration.type_id()));
        }
        // What is read as components of several types is reported once.
        own.problems.retain(|problem| self.told.insert((problem.place.clone(), problem.message.clone())));
        reader.problems.append(&mut own.problems);
        value
    }

    /// What may be meant by the name of no component. The same slip is often made many times, and looked into once.
    fn suggested(&mut self, name: &str) -> String {
        if let Some(known) = self.suggested.get(name) {
            return known.clone();
        }
        let known = self.known.get_or_insert_with(|| Known::components(self.registry));
        if self.suggested.len() >= MOST_SUGGESTED {
            return suggestion("", known);
        }
        let suggestion = suggestion(name, known);
        self.suggested.insert(name.to_owned(), suggestion.clone());
        suggestion
    }

    fn component_type(&mut self, reader: &mut Reader, name: &Part) -> Option<&'a TypeRegistration> {
        let found = self.registry.get_with_short_type_path(name.text);
        if let Some(registration) =
            found.filter(|registration| registration.data::<ReflectComponent>().is_some())
        {
            return Some(registration);
        }
        let problem = if self.registry.is_ambiguous(name.text) {
            Problem::error(format!("more than one plugin has a component `{}`", name.text)).label("ambiguous")
        } else {
            Problem::error(format!("there is no component `{}`", name.text))
                .label("unknown component")
                .help(self.suggested(name.text))
        };
        reader.report(name, problem);
        None
    }

    fn text(&mut self, path: &Path, wanted: &str, named_at: Option<&Place>) -> Option<Arc<SourceFile>> {
        if let Some(file) = self.read.get(path) {
            return file.clone();
        }
        self.document.files.push(path.to_owned());
        let read = self.fetched.remove(path).unwrap_or_else(|| self.fetch(path, wanted));
        let file = read
            .map_err(|problem| {
                let place = problem.place.clone().or(named_at.cloned());
                self.document.problems.push(problem.at_maybe(place));
            })
            .ok();
        self.read.insert(path.to_owned(), file.clone());
        file
    }

    /// The text of a file; the same as before where it says the same, so that places in it are the same too.
    fn fetch(&self, path: &Path, wanted: &str) -> Result<Arc<SourceFile>, Box<Problem>> {
        let is_seen = self.is_seen(path);
        let file = match self.texts.get(path) {
            Some(text) if is_seen => SourceFile::new(path, text.as_str()),
            Some(text) => SourceFile::unseen(path, text.as_str()),
            None => read_text(path, wanted, is_seen)?,
        };
        let before = self.last.and_then(|last| last.sources.get(path));
        let is_same =
            |before: &&Arc<SourceFile>| before.text() == file.text() && before.is_shown() == file.is_shown();
        Ok(before.filter(is_same).cloned().unwrap_or(file))
    }

    /// Whether problems of a file are shown with its text: a scene from elsewhere can name any file, but only its own are its affair.
    fn is_seen(&self, path: &Path) -> bool {
        path == self.path || identity(path).starts_with(&self.home)
    }
}
