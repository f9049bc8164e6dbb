//! A path written in a scene, relative to the file that it is written in.

use bevy_reflect::{Reflect, ReflectDeserialize, ReflectSerialize, std_traits::ReflectDefault};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::{Path, PathBuf};

/// A file that a scene names. Relative paths start at the folder of the file that names them.
///
/// Deserialising gives the path as written; the reader of scenes then calls [`AssetPath::resolve`] for every one that it meets, in
/// components of plugins too.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(opaque)]
#[reflect(Clone, Debug, PartialEq, Default, Deserialize, Serialize)]
pub struct AssetPath {
    written: String,
    resolved: PathBuf,
}

impl AssetPath {
    /// A path that needs no resolving, for scenes built in code.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        let resolved = path.into();
        Self { written: resolved.display().to_string(), resolved }
    }

    /// The path as it stands in the scene.
    pub fn written(&self) -> &str {
        &self.written
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.resolved
    }

    /// Makes the path start at `folder`, unless it is absolute.
    pub fn resolve(&mut self, folder: &Path) {
        self.resolved = folder.join(&self.written);
    }
}

impl Serialize for AssetPath {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.written.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for AssetPath {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(Self::new)
    }
}
