//! The files that components name, read into the world.

mod labels;
mod once;
mod width;

use crate::Stage;
use crate::components::{
    self, Auto, DataFrame, LabelColour, Mesh, Place, Placement, Subsurface, TransferFunction, Volume,
};
use crate::optics::transfer::{domain_around, domain_of_labels};
use crate::scene::{EntityProblems, Problem};
use crate::sources::trail::{FileState, Trail};
use crate::sources::{
    self, LayoutError, MeshData, MeshStatistics, RawLayout, Samples, Selection, SourceError, Space,
    VolumeData,
};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use once::Once;
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads meshes and volumes when the components that name them change.
pub(crate) struct LoadingPlugin;

impl Plugin for LoadingPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<FileChanged>();
        // What was read may lie elsewhere.
        let systems = (unload, load_meshes, load_volumes, components::place, width::advise).chain();
        app.add_systems(Update, systems.in_set(Stage::Load));
    }
}

/// The triangles of a [`Mesh`], until they are on the GPU.
#[derive(Component, Clone, Debug)]
pub struct LoadedMesh {
    /// The triangles, which equal meshes share; taken away once they are uploaded.
    pub data: Option<Arc<MeshData>>,
    /// Corners of the box around the mesh, in the mesh's own space.
    pub bounds: (Vec3, Vec3),
    /// Vertices that lie farthest out in some directions.
    pub extremes: Vec<Vec3>,
}

impl LoadedMesh {
    /// The mesh, with what is known of it once its triangles are gone.
    pub fn new(data: MeshData) -> Self {
        let (bounds, extremes) = (data.bounds().unwrap_or_default(), data.extremes());
        Self { data: Some(Arc::new(data)), bounds, extremes }
    }
}

/// The samples of a [`Volume`], until they are on the GPU.
#[derive(Component, Clone, Debug)]
pub struct LoadedVolume {
    /// Ranges and bricks, without the samples, which are only as many as they are.
    pub data: Arc<VolumeData>,
    /// The samples, which equal volumes share; taken away once they are uploaded.
    pub samples: Option<Arc<Samples>>,
}

impl LoadedVolume {
    /// The volume, with what is known of it once its samples are gone.
    pub fn new(mut data: VolumeData) -> Self {
        let emptied = data.samples.emptied();
        let samples = std::mem::replace(&mut data.samples, emptied);
        Self { data: Arc::new(data), samples: Some(Arc::new(samples)) }
    }

    /// Half of what the volume measures along its axes, mm.
    pub fn half_extent(&self) -> Vec3 {
        Vec3::from(self.data.size.map(|voxels| voxels as f32)) * self.data.spacing * 0.5
    }

    /// The data values at the ends of a transfer function's table: those of its labels, those written, or else those that a preset is about, that
    /// the file recommends, or that the data have.
    pub fn domain(&self, function: &TransferFunction) -> (f32, f32) {
        let data = &self.data;
        let labels = domain_of_labels(&function.labels).or_else(|| {
            self.default_labels(function).map(|labels| domain_around(*labels.start(), *labels.end()))
        });
        if let Some(domain) = labels {
            return domain;
        }
        let automatic = function
            .preset_domain()
            .or(data.window.filter(|window| window.0 < window.1))
            .unwrap_or(data.core_range);
        match function.domain {
            Auto::Value(domain) => (domain.x, domain.y),
            Auto::Auto if automatic.0 < automatic.1 => automatic,
            // Constant data has no range. What is not 0 is there: it is as far from it as values get.
            Auto::Auto if automatic.0 > f32::MIN_POSITIVE => (0.0, automatic.0),
            Auto::Auto if automatic.0 < -f32::MIN_POSITIVE => (2.0 * automatic.0, automatic.0),
            Auto::Auto => (0.0, 1.0),
        }
    }

    /// The function that a volume is drawn with: the one written, with the points of its preset, if it has one; of a label map without any, a
    /// colour for each label; white where the data are colours and the function says none.
    pub fn function_in_force(&self, function: &TransferFunction) -> TransferFunction {
        match self.default_labels(function) {
            Some(values) => {
                TransferFunction { preset: None, labels: self.colours_of(values), ..function.clone() }
            }
            None => {
                let in_force = function.in_force(Some(&self.data.histogram), self.domain(function));
                if self.data.samples.format() == sources::SampleFormat::Rgba8
                    && function.colours_are_unwritten()
                {
                    in_force.in_white()
                } else {
                    in_force
                }
            }
        }
    }
}

/// What a component said when its files were read last. One that is written again, but is the same, is not read again.
#[derive(Component)]
struct ReadFor<Component: Send + Sync + 'static>(Component);

/// Has the next update read all meshes and volumes again.
pub(crate) fn read_again(world: &mut World) {
    read_again_for::<Mesh>(world);
    read_again_for::<Volume>(world);
}

fn read_again_for<Source: Component<Mutability = Mutable>>(world: &mut World) {
    let mut sources = world.query::<(Entity, &mut Source)>();
    let all: Vec<Entity> = sources
        .iter_mut(world)
        .map(|(entity, mut source)| {
            source.set_changed();
            entity
        })
        .collect();
    for entity in all {
        world.entity_mut(entity).remove::<ReadFor<Source>>();
    }
}

/// The corners of a box in its own space.
pub(crate) fn corners((low, high): (Vec3, Vec3)) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |corner| {
        let pick = |axis: usize| f64::from(if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// The corners of an entity's box in the scene.
pub(crate) fn placed_corners(placement: &Placement, bounds: (Vec3, Vec3)) -> impl Iterator<Item = DVec3> {
    let scene_from_entity = placement.0;
    corners(bounds).map(move |corner| scene_from_entity.transform_point3(corner))
}

/// A file that a component named, or that was read for one, has changed on disk. Systems that read files read again what this one was
/// part of; the components themselves stay as they are.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct FileChanged(pub PathBuf);

/// The files that were read for the components of an entity, by the name of the component: what is watched while a scene is live.
/// Systems of plugins that read files say so here.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct FilesRead(BTreeMap<&'static str, Trail>);

impl FilesRead {
    /// Replaces what was read for a component earlier.
    pub fn set(commands: &mut Commands, entity: Entity, component: &'static str, files: Trail) {
        commands.queue(move |world: &mut World| {
            let Ok(mut entity) = world.get_entity_mut(entity) else { return };
            match entity.get_mut::<Self>() {
                Some(mut read) if read.0.get(component) != Some(&files) => {
                    read.0.insert(component, files);
                }
                Some(_) => {}
                None if files.is_empty() => {}
                None => {
                    entity.insert(Self(BTreeMap::from([(component, files)])));
                }
            }
        });
    }

    /// The files that were read for a component.
    pub fn of(&self, component: &str) -> Option<&Trail> {
        self.0.get(component)
    }

    /// The files that were read for any component.
    pub fn all(&self) -> impl Iterator<Item = (&PathBuf, &FileState)> {
        self.0.values().flatten()
    }

    /// Whether any of these files was read for a component.
    fn has_any(&self, component: &str, files: &HashSet<&Path>) -> bool {
        self.of(component).is_some_and(|read| read.keys().any(|file| files.contains(file.as_path())))
    }
}

type WrittenMesh<'a> = (Entity, &'a Mesh, Option<&'a ReadFor<Mesh>>, Option<&'a LoadedMesh>, Has<Subsurface>);

fn load_meshes(
    mut commands: Commands,
    meshes: Query<WrittenMesh, Or<(Changed<Mesh>, Added<Subsurface>)>>,
    all: Query<(Entity, &Mesh, &FilesRead, Has<Subsurface>)>,
    mut changed: MessageReader<FileChanged>,
) {
    // What becomes translucent is read again if it was let go of: it is to be refined.
    let is_gone = |loaded: Option<&LoadedMesh>| loaded.is_some_and(|loaded| loaded.data.is_none());
    let due = meshes.iter().filter(|(_, mesh, read, loaded, scatters)| {
        read.is_none_or(|read| read.0 != **mesh) || *scatters && is_gone(*loaded)
    });
    let mut due: BTreeMap<Entity, (&Mesh, bool)> =
        due.map(|(entity, mesh, .., scatters)| (entity, (mesh, scatters))).collect();
    let files: HashSet<&Path> = changed.read().map(|file| file.0.as_path()).collect();
    if !files.is_empty() {
        let stale = all.iter().filter(|(_, _, read, _)| read.has_any("Mesh", &files));
        due.extend(stale.map(|(entity, mesh, _, scatters)| (entity, (mesh, scatters))));
    }
    let mut once = Once::new(|mesh: &Mesh| read_mesh(mesh).map(LoadedMesh::new));
    for (entity, (mesh, scatters)) in due {
        let (read, files) = once.read(mesh);
        let problems = match read {
            Ok(loaded) => {
                let data = loaded.data.as_deref();
                let note = |note: &String| Problem::note(note.clone()).on(entity, "Mesh");
                let notes = data.iter().flat_map(|data| &data.notes).map(note);
                let medium = data.and_then(MeshData::medium).filter(|_| !scatters);
                let unused = medium.map(|medium| {
                    Problem::note("its file describes a medium inside, which only a `Subsurface` shows")
                        .help(format!("add `Subsurface: {}`; lengths are millimetres", medium.in_ron()))
                        .on(entity, "Mesh")
                });
                let problems = notes.chain(unused).collect();
                let origin = data.map_or(DVec3::ZERO, |data| data.origin);
                let mut entity = commands.entity(entity);
                match origin == DVec3::ZERO {
                    true => entity.remove::<DataFrame>(),
                    false => entity.insert(DataFrame::SceneUnits(glam::DAffine3::from_translation(origin))),
                };
                entity.insert(loaded.clone());
                problems
            }
            // What was loaded last stays.
            Err(error) => vec![Problem::error(error.to_string()).on(entity, "Mesh.path")],
        };
        commands.entity(entity).insert(ReadFor(mesh.clone()));
        FilesRead::set(&mut commands, entity, "Mesh", files.clone());
        EntityProblems::set(&mut commands, entity, "load_meshes", problems);
    }
}

fn read_mesh(mesh: &Mesh) -> Result<MeshData, SourceError> {
    Ok(match mesh {
        Mesh::File { path, normals, materials } => {
            let mesh = sources::read_mesh(path.path(), *normals)?;
            if *materials { mesh } else { mesh.without_materials() }
        }
        Mesh::Sphere { radius, subdivisions } => sources::procedural::sphere(*radius, *subdivisions),
        Mesh::Box { size } => sources::procedural::cuboid(*size),
        Mesh::Plane { size } => sources::procedural::plane(*size),
        Mesh::CornellBox => sources::procedural::cornell_box(),
    })
}

fn load_volumes(
    mut commands: Commands,
    volumes: Query<(Entity, &Volume, Option<&ReadFor<Volume>>), Changed<Volume>>,
    all: Query<(Entity, &Volume, &FilesRead)>,
    mut changed: MessageReader<FileChanged>,
) {
    let due = volumes.iter().filter(|(_, volume, read)| read.is_none_or(|read| read.0 != **volume));
    let mut due: BTreeMap<Entity, &Volume> = due.map(|(entity, volume, _)| (entity, volume)).collect();
    let files: HashSet<&Path> = changed.read().map(|file| file.0.as_path()).collect();
    if !files.is_empty() {
        let stale = all.iter().filter(|(.., read)| read.has_any("Volume", &files));
        due.extend(stale.map(|(entity, volume, _)| (entity, volume)));
    }
    let mut once = Once::new(|volume: &Volume| read_volume(volume).map(LoadedVolume::new));
    for (entity, volume) in due {
        let (read, files) = once.read(volume);
        let problems = match read {
            Ok(loaded) => {
                let problems = notes_on(volume, loaded).map(|note| note.on(entity, "Volume")).collect();
                let frame = frame_of(volume, &loaded.data);
                let mut entity = commands.entity(entity);
                match frame {
                    Some(frame) => entity.insert(frame),
                    None => entity.remove::<DataFrame>(),
                };
                entity.insert(loaded.clone());
                problems
            }
            // What was loaded last stays.
            Err(error) => {
                vec![Problem::error(error.to_string()).on(entity, field_at_fault(volume, error))]
            }
        };
        commands.entity(entity).insert(ReadFor(volume.clone()));
        FilesRead::set(&mut commands, entity, "Volume", files.clone());
        EntityProblems::set(&mut commands, entity, "load_volumes", problems);
    }
}

/// Where a volume lies whose component asks for the place that its file says.
fn frame_of(volume: &Volume, data: &VolumeData) -> Option<DataFrame> {
    let Volume::File { place: Place::Patient, .. } = volume else { return None };
    let is_known = data.frame.space != Space::Unknown;
    is_known.then(|| DataFrame::Millimetres(data.frame.world_from_box(data.size, data.spacing)))
}

/// What is left of a rotation, where the file's place is not asked for; and that there is none, where it is.
fn note_on_place(volume: &Volume, data: &VolumeData) -> Option<String> {
    let Volume::File { place, .. } = volume else { return None };
    let degrees = data.frame.degrees_off();
    match place {
        Place::Patient if data.frame.space == Space::Unknown => {
            Some("the file does not say where it lies; it is centred on the entity's origin".to_owned())
        }
        Place::Centred if degrees >= LEAST_TOLD_DEGREES => Some(format!(
            "its axes are up to {degrees:.1}° off the world's; it is drawn upright (`place: Patient` draws it as it lies)"
        )),
        _ => None,
    }
}

/// The least rotation, in degrees, that is told of.
const LEAST_TOLD_DEGREES: f64 = 0.05;

fn notes_on(volume: &Volume, loaded: &LoadedVolume) -> impl Iterator<Item = Problem> {
    let data = &loaded.data;
    let voxels = data.size.map(u64::from).iter().product::<u64>();
    let unfit = (data.non_finite > 0).then(|| {
        format!("{} of {} samples are not finite; they are drawn as transparent", data.non_finite, voxels)
    });
    let labels = labels::notes(volume, data);
    data.notes
        .iter()
        .cloned()
        .chain(note_on_place(volume, data))
        .chain(unfit)
        .chain(labels)
        .map(Problem::note)
}

/// The field of a [`Volume`] that an error is about.
fn field_at_fault(volume: &Volume, error: &SourceError) -> &'static str {
    match error {
        // A file says everything else itself.
        _ if matches!(volume, Volume::File { .. }) => "Volume.path",
        SourceError::Layout { problem: LayoutError::Spacing { .. }, .. } => "Volume.spacing",
        SourceError::Layout { problem: LayoutError::Skip { .. }, .. } => "Volume.skip_bytes",
        SourceError::Layout { .. } | SourceError::Length { .. } => "Volume.size",
        _ => "Volume.path",
    }
}

/// What was read for a component goes with it.
fn unload(
    mut commands: Commands,
    mut meshes: RemovedComponents<Mesh>,
    mut volumes: RemovedComponents<Volume>,
) {
    for entity in meshes.read() {
        commands.entity(entity).try_remove::<(LoadedMesh, ReadFor<Mesh>, DataFrame)>();
        FilesRead::set(&mut commands, entity, "Mesh", Trail::new());
        EntityProblems::set(&mut commands, entity, "load_meshes", Vec::new());
    }
    for entity in volumes.read() {
        commands.entity(entity).try_remove::<(LoadedVolume, ReadFor<Volume>, DataFrame)>();
        FilesRead::set(&mut commands, entity, "Volume", Trail::new());
        EntityProblems::set(&mut commands, entity, "load_volumes", Vec::new());
    }
}

fn read_volume(volume: &Volume) -> Result<VolumeData, SourceError> {
    let (path, size, format, endian, spacing, skip_bytes) = match volume {
        Volume::File { path, index, component, series, .. } => {
            let component = match component {
                Auto::Auto => None,
                Auto::Value(component) => Some(*component),
            };
            let selection = Selection { index: *index, component, series: series.clone() };
            return sources::read_volume(path.path(), &selection);
        }
        Volume::Raw { path, size, format, endian, spacing, skip_bytes, .. } => {
            (path, size, format, endian, spacing, skip_bytes)
        }
    };
    let layout = RawLayout {
        size: size.to_array(),
        format: *format,
        endian: *endian,
        spacing: *spacing,
        skip_bytes: *skip_bytes,
    };
    sources::read_raw(path.path(), &layout)
}

/// What a scene holds, for people and machines.
#[derive(Clone, Debug)]
pub enum Contents {
    /// A mesh.
    Mesh(MeshStatistics),
    /// A volume.
    Volume {
        /// Voxels along x, y and z.
        size: [u32; 3],
        /// Type of a sample.
        format: sources::SampleFormat,
        /// Millimetres between voxel centres.
        spacing: Vec3,
        /// Least and greatest finite sample.
        range: (f32, f32),
        /// Samples that are NaN or infinite.
        non_finite: u64,
        /// How often each value occurs.
        histogram: sources::Histogram,
        /// Of a label map, the labels that occur, in the colours that they have by default, and how many voxels each has.
        labels: Vec<(LabelColour, u64)>,
    },
}

/// What each entity of the world holds, by name, in alphabetical order. Only what is not yet uploaded can be looked at.
pub fn contents(world: &mut World) -> Vec<(String, Contents)> {
    let mut query = world.query::<(&Name, Option<&LoadedMesh>, Option<&LoadedVolume>)>();
    let mut all = Vec::new();
    for (name, mesh, volume) in query.iter(world) {
        if let Some(data) = mesh.and_then(|mesh| mesh.data.as_ref()) {
            all.push((name.to_string(), Contents::Mesh(data.statistics())));
        }
        if let Some(volume) = volume {
            let data = &volume.data;
            let (size, format) = (data.size, data.samples.format());
            let (spacing, range, non_finite) = (data.spacing, data.range, data.non_finite);
            let (histogram, labels) = (data.histogram.clone(), volume.label_counts());
            all.push((
                name.to_string(),
                Contents::Volume { size, format, spacing, range, non_finite, histogram, labels },
            ));
        }
    }
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}
