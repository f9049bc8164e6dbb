//! What is done with a mutated file.

use bevy_app::App;
use bevy_ecs::reflect::AppTypeRegistry;
use std::path::Path;
use tyndall::TyndallPlugins;
use tyndall::scene::SceneDocument;
use tyndall::sources::{self, Kind, MeshData, Normals, Selection, VolumeData};

/// The readers of everything that a person may name.
pub struct Targets {
    app: App,
}

impl Targets {
    pub fn new() -> Self {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        Self { app }
    }

    /// Reads a file as the program would, and looks at what comes of it. Answers whether it was read.
    pub fn read(&self, path: &Path) -> bool {
        match sources::recognise(path) {
            Some(Kind::Mesh) => mesh(path),
            Some(Kind::Volume { .. }) => volume(path),
            None => self.scene(path),
        }
    }

    fn scene(&self, path: &Path) -> bool {
        let registry = self.app.world().resource::<AppTypeRegistry>().read();
        let document = SceneDocument::load(path, &registry, &[]);
        let mut messages = document.problems.iter().map(ToString::to_string);
        assert!(messages.all(|message| !message.chars().any(is_control)), "a message has control characters");
        !document.has_errors()
    }
}

/// What no message may have: a terminal would obey it.
fn is_control(letter: char) -> bool {
    letter.is_control() && !matches!(letter, '\n' | '\t')
}

fn told<Read>(read: Result<Read, sources::SourceError>) -> Option<Read> {
    match read {
        Ok(read) => Some(read),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 4000, "a message of {} bytes", message.len());
            None
        }
    }
}

fn mesh(path: &Path) -> bool {
    let Some(mesh) = told(sources::read_mesh(path, Normals::Auto)) else { return false };
    assert_sound(&mesh);
    _ = mesh.statistics();
    true
}

/// What [`MeshData`] promises.
fn assert_sound(mesh: &MeshData) {
    let vertices = mesh.positions.len();
    assert_eq!(vertices, mesh.normals.len(), "normals");
    assert!(mesh.colours.is_empty() || mesh.colours.len() == vertices, "colours");
    assert!(
        mesh.texture_coordinates.is_empty() || mesh.texture_coordinates.len() == vertices,
        "texture coordinates"
    );
    assert!(mesh.positions.iter().all(|position| position.is_finite()), "positions");
    assert!(mesh.normals.iter().all(|normal| normal.is_normalized()), "normals of length 1");
    assert!(mesh.triangles.iter().flatten().all(|vertex| (*vertex as usize) < vertices), "indices");
    let ends = mesh.parts.iter().map(|part| (part.triangles.end, part.material));
    assert!(
        ends.clone().all(|(end, material)| end as usize <= mesh.triangles.len()
            && (material as usize) < mesh.materials.len()),
        "parts"
    );
}

fn volume(path: &Path) -> bool {
    let first = told(sources::read_volume(path, &Selection::default()));
    let other = Selection { index: 1, component: Some(1), series: Some("1".into()) };
    let second = told(sources::read_volume(path, &other));
    first.iter().chain(&second).for_each(assert_whole);
    first.is_some()
}

/// What [`VolumeData`] promises.
fn assert_whole(volume: &VolumeData) {
    let voxels: u64 = volume.size.iter().map(|side| u64::from(*side)).product();
    assert_eq!(voxels, volume.samples.len() as u64, "samples");
    assert!(volume.spacing.is_finite() && volume.spacing.min_element() > 0.0, "spacing {}", volume.spacing);
    let (low, high) = volume.range;
    assert!(low <= high || voxels == volume.non_finite, "range {low} to {high}");
}
