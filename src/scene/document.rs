//! A scene as its files say it: every value with its place, nothing in the world yet.

use super::advice::advice;
use super::edit;
use super::frame::Frame;
use super::loader;
use super::problem::{Place, Problem, Severity, SourceFile};
use super::references::references;
use crate::components::{AssetPath, SceneSettings};
use crate::sources::trail::{self, Trail};
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeRegistry};
use std::any::TypeId;
use std::collections::HashMap;
use std::ops::Range;
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
#[derive(Clone)]
pub struct SceneEntity {
    /// Its name, which is its identity.
    pub name: String,
    /// Its components, in the order in which they are written. Shared with the document before, where the text is the same.
    pub components: Arc<[SceneComponent]>,
    /// Where its name stands.
    pub place: Place,
    /// Where its components stand, in the same file.
    pub(super) bytes: Range<usize>,
    pub(super) details: Arc<Details>,
}

/// What is known about the text of an entity, wherever in the file it stands.
#[derive(Default)]
pub(super) struct Details {
    /// Where each value stands, by its path: `Mesh`, `Mesh.radius`, `TransferFunction.points[2]`.
    pub(super) places: HashMap<String, Position>,
    /// The files of components that are kept in files of their own.
    pub(super) files: Vec<Arc<SourceFile>>,
    /// Whether reading it gave no problem.
    pub(super) is_sound: bool,
}

pub(super) enum Position {
    /// In the text of the entity, from where that begins.
    Within(Range<usize>),
    /// In another file.
    Elsewhere(Place),
}

impl SceneEntity {
    /// Whether the value at `path` stands in a file, as opposed to being a default.
    pub fn is_written(&self, path: &str) -> bool {
        self.details.places.contains_key(path)
    }

    /// Where the value at `path` stands; where it is not written, the nearest thing around it that is.
    pub fn place_of(&self, path: &str) -> Place {
        let mut path = path;
        loop {
            match self.details.places.get(path) {
                Some(Position::Elsewhere(place)) => return place.clone(),
                Some(Position::Within(bytes)) => {
                    let bytes = self.bytes.start + bytes.start..self.bytes.start + bytes.end;
                    return Place { file: self.place.file.clone(), bytes };
                }
                None => {}
            }
            match path.rfind(['.', '[']) {
                Some(end) => path = &path[..end],
                None => return self.place.clone(),
            }
        }
    }

    /// The value of a component.
    pub fn component(&self, type_id: TypeId) -> Option<&dyn Reflect> {
        let component = self.components.iter().find(|component| component.type_id == type_id)?;
        Some(component.value.as_ref())
    }

    /// Whether it is the one of an earlier document, not only one that is equal.
    pub(super) fn is_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.components, &other.components)
    }

    pub(super) fn text(&self) -> &str {
        &self.place.file.text()[self.bytes.clone()]
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
    pub(super) head: HashMap<String, Place>,
    /// Where each entity is in the list.
    pub(super) index: HashMap<String, usize>,
    /// The files that could be read.
    pub(super) sources: HashMap<PathBuf, Arc<SourceFile>>,
    /// Where the parts of the scene and its includes are, of those that are whole.
    pub(super) frames: HashMap<PathBuf, Frame>,
    /// Every file that was looked for, and how it was then.
    trail: Trail,
}

impl SceneDocument {
    /// Reads the scene at `path` and all that it includes, with `overrides` in force.
    pub fn load(path: &Path, registry: &TypeRegistry, overrides: &[Override]) -> Self {
        Self::load_after(path, registry, overrides, None)
    }

    /// The same of a scene whose text is in no file yet, as if it stood in one at `path`.
    pub fn of_text(path: &Path, text: String, registry: &TypeRegistry, overrides: &[Override]) -> Self {
        let texts = HashMap::from([(path.to_owned(), text)]);
        let (mut document, trail) =
            trail::follow(|| Self::overridden(path, registry, overrides, None, texts));
        document.trail = trail;
        document.looked_over()
    }

    /// The same, without reading again the entities whose text is as it was in an earlier document of the same scene.
    pub fn load_after(
        path: &Path,
        registry: &TypeRegistry,
        overrides: &[Override],
        last: Option<&Self>,
    ) -> Self {
        let (mut document, trail) =
            trail::follow(|| Self::overridden(path, registry, overrides, last, HashMap::new()));
        document.trail = trail;
        document.looked_over()
    }

    /// The same scene with other texts in some of its files. The rest is as it was read, whatever is on disk by now. What another version of
    /// the scene, `last`, says in the same words is not read again.
    pub(super) fn with_texts(
        &self,
        registry: &TypeRegistry,
        changed: HashMap<PathBuf, String>,
        last: &Self,
    ) -> Self {
        let Some(path) = self.files.first() else { return Self::default() };
        let sources = self.sources.iter().map(|(path, file)| (path.clone(), file.text().to_owned()));
        let mut texts: HashMap<PathBuf, String> = sources.collect();
        texts.extend(changed);
        loader::load(path, registry, &texts, Some(last)).looked_over()
    }

    /// With the problems that show only in all of it.
    fn looked_over(mut self) -> Self {
        self.problems.extend(references(&self));
        if !self.has_errors() {
            self.problems.extend(advice(&self));
        }
        self
    }

    /// Reads a scene with `texts` in place of what is on disk, and then with each override in it.
    fn overridden(
        path: &Path,
        registry: &TypeRegistry,
        overrides: &[Override],
        last: Option<&Self>,
        mut texts: HashMap<PathBuf, String>,
    ) -> Self {
        let mut document = loader::load(path, registry, &texts, last);
        for change in overrides {
            if document.has_errors() {
                break;
            }
            match edit::apply(&document, change, registry) {
                Ok((file, text)) => {
                    texts.insert(file, text);
                    document = loader::load(path, registry, &texts, Some(&document));
                }
                Err(problem) => document.problems.push(*problem),
            }
        }
        document
    }

    /// Every file that was looked for while it was read, found or not, and how it was then.
    pub fn trail(&self) -> &Trail {
        &self.trail
    }

    /// The text of a file as it was used, if it could be read.
    pub(super) fn source(&self, path: &Path) -> Option<&SourceFile> {
        self.sources.get(path).map(Arc::as_ref)
    }

    /// The files that values of its components name: meshes, volumes and others.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        let values = self.entities.iter().flat_map(|entity| entity.components.iter());
        values.flat_map(|component| {
            let mut paths = Vec::new();
            paths_in(component.value.as_partial_reflect(), &mut paths);
            paths
        })
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
}

fn paths_in<'v>(value: &'v dyn PartialReflect, paths: &mut Vec<&'v Path>) {
    if let Some(path) = value.try_downcast_ref::<AssetPath>() {
        return paths.push(path.path());
    }
    let mut within = |inner: &'v dyn PartialReflect| paths_in(inner, paths);
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => fields.iter_fields().for_each(|(_, field)| within(field)),
        ReflectRef::TupleStruct(fields) => fields.iter_fields().for_each(within),
        ReflectRef::Tuple(fields) => fields.iter_fields().for_each(within),
        ReflectRef::List(list) => list.iter().for_each(within),
        ReflectRef::Enum(fields) => fields.iter_fields().for_each(|field| within(field.value())),
        _ => {}
    }
}

/// The same for every way to write the path of a file.
pub(super) fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// The fields of [`SceneSettings`].
pub(super) const SETTINGS: [&str; 5] =
    ["millimetres_per_unit", "background", "shading", "meshes_shade_volumes", "volumes_shade_meshes"];
