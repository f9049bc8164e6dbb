//! Where an entity is: as written, as moved by animation, and the product of the two.

use super::attributes::{ReflectValidate, Untagged, Validate, in_ron};
use super::{AlsoCalled, Range, SceneSettings};
use crate::loading::{LoadedMesh, LoadedVolume};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};

/// Position, orientation and size of an entity, as written.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `translation` | vector | scene units | finite | (0, 0, 0) |
/// | `rotation` | angles about the fixed x, then y, then z axis | degrees | finite | (0, 0, 0) |
/// | `scale` | a number or (x, y, z) | – | not 0 | 1.0 |
/// | `fit` | `None`, or how long the longest side of the box around the mesh or volume is to be, before `scale` | mm | above 0 | `None` |
///
/// What `fit` says is applied first, then scale, then rotation, then translation. `fit` is for files whose unit is not known: how light
/// scatters in a mesh depends on what it measures.
///
/// ```ron
/// Transform: (translation: (-1.0, 0.0, 0.0), rotation: (0.0, 30.0, 0.0), scale: 8.0)
/// Transform: (fit: 40.0)
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
#[reflect(@AlsoCalled(&["Position", "Translation", "Rotation", "Scale", "Pose", "Location"]))]
#[require(Placement)]
pub struct Transform {
    /// Scene units.
    #[reflect(@super::Unit("scene units"))]
    #[reflect(@AlsoCalled(&["position", "location", "offset"]))]
    pub translation: Vec3,
    /// Degrees about the fixed x, then y, then z axis.
    #[reflect(@super::Unit("degrees"))]
    #[reflect(@AlsoCalled(&["orientation", "angles", "euler"]))]
    pub rotation: Vec3,
    /// Factor along the entity's own axes.
    pub scale: Scale,
    /// What the longest side of the mesh or volume measures without `scale`, mm.
    #[reflect(@Range::positive(), @super::Unit("mm"))]
    #[reflect(@AlsoCalled(&["size", "fit_to", "normalize", "extent"]))]
    pub fit: Option<f32>,
}

impl Transform {
    /// The factor that makes what measures `extent` along its sides, in scene units, as long as `fit` asks for.
    fn fitting(&self, extent: Vec3, millimetres_per_unit: f32) -> f64 {
        let longest = f64::from(extent.max_element()) * f64::from(millimetres_per_unit);
        self.fit.map(|fit| f64::from(fit) / longest).filter(|factor| factor.is_normal()).unwrap_or(1.0)
    }

    /// The matrix that takes the entity's space to the scene's, in double precision, but for what [`fit`](Self::fit) makes of it, which depends on
    /// what is loaded.
    pub fn scene_from_entity(&self) -> DAffine3 {
        let angles = self.rotation.as_dvec3() * std::f64::consts::PI / 180.0;
        let rotation = DQuat::from_euler(EulerRot::XYZEx, angles.x, angles.y, angles.z);
        DAffine3::from_scale_rotation_translation(
            self.scale.xyz().as_dvec3(),
            rotation,
            self.translation.as_dvec3(),
        )
    }
}

impl Validate for Transform {
    fn problems(&self) -> Vec<(&'static str, String)> {
        let scale = self.scale.xyz();
        if scale.cmpne(Vec3::ZERO).all() {
            return Vec::new();
        }
        let found = match self.scale {
            Scale::Uniform(factor) => factor.to_string(),
            Scale::PerAxis(factors) => in_ron(&factors.to_array()),
        };
        vec![("scale", format!("a scale must not be 0, which would leave nothing to see; found {found}"))]
    }
}

/// A scale factor along each axis, in RON one number for all three or `(x, y, z)`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq, @Untagged)]
pub enum Scale {
    /// The same along all axes.
    Uniform(f32),
    /// Along x, y and z.
    PerAxis(Vec3),
}

impl Default for Scale {
    fn default() -> Self {
        Self::Uniform(1.0)
    }
}

impl Scale {
    /// The factors along x, y and z.
    pub fn xyz(self) -> Vec3 {
        match self {
            Self::Uniform(factor) => Vec3::splat(factor),
            Self::PerAxis(factors) => factors,
        }
    }
}

/// How an animation moves an entity beyond its [`Transform`]. Systems in [`Stage::Animate`](crate::Stage::Animate) write it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(Placement)]
pub struct Motion(pub DAffine3);

/// Where the data that were loaded for an entity lie in its own space, if not about its origin: a volume in its patient, a mesh far away
/// from the origin of its coordinates. Written while files are read.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub enum DataFrame {
    /// Takes the data's space to the entity's, both in scene units.
    SceneUnits(DAffine3),
    /// The same with a translation in millimetres.
    Millimetres(DAffine3),
}

impl DataFrame {
    /// The matrix that takes the data's space to the entity's, in scene units.
    pub fn entity_from_data(&self, millimetres_per_unit: f32) -> DAffine3 {
        match *self {
            Self::SceneUnits(affine) => affine,
            Self::Millimetres(affine) => {
                DAffine3 { translation: affine.translation / f64::from(millimetres_per_unit), ..affine }
            }
        }
    }
}

/// Where the entity's data are now: its [`Motion`] after its [`Transform`] after its [`DataFrame`]. Derived in [`Stage::Place`](crate::Stage::Place); read it, never
/// write it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement(pub DAffine3);

type Moved =
    Or<(Changed<Transform>, Changed<Motion>, Changed<DataFrame>, Changed<LoadedMesh>, Changed<LoadedVolume>)>;

type Loaded<'a> = (Option<&'a LoadedMesh>, Option<&'a LoadedVolume>);

/// What an entity's data measure along their sides, in scene units.
fn extent((mesh, volume): (Option<&LoadedMesh>, Option<&LoadedVolume>), unit: f32) -> Option<Vec3> {
    let of_mesh = mesh.map(|mesh| mesh.bounds.1 - mesh.bounds.0);
    of_mesh.or_else(|| volume.map(|volume| 2.0 * volume.half_extent() / unit))
}

/// Derives [`Placement`], and wakes nothing where the result is the same.
pub(crate) fn place(
    mut entities: Query<(Option<&Transform>, Option<&Motion>, Option<&DataFrame>, Loaded, &mut Placement)>,
    changed: Query<Entity, (With<Placement>, Moved)>,
    measured: Query<(Entity, Has<DataFrame>, Option<&Transform>), With<Placement>>,
    settings: Res<SceneSettings>,
    (mut no_transform, mut no_motion, mut no_frame): (
        RemovedComponents<Transform>,
        RemovedComponents<Motion>,
        RemovedComponents<DataFrame>,
    ),
) {
    let depends_on_unit = |(entity, framed, transform): (Entity, bool, Option<&Transform>)| {
        (framed || transform.is_some_and(|transform| transform.fit.is_some())).then_some(entity)
    };
    let rescaled = measured.iter().filter(|_| settings.is_changed()).filter_map(depends_on_unit);
    let removed = no_transform.read().chain(no_motion.read()).chain(no_frame.read());
    for entity in changed.iter().chain(rescaled).chain(removed) {
        let Ok((transform, motion, frame, loaded, mut placement)) = entities.get_mut(entity) else {
            continue;
        };
        let unit = settings.millimetres_per_unit;
        let still = transform.map_or(DAffine3::IDENTITY, |transform| {
            let fitting = extent(loaded, unit).map_or(1.0, |extent| transform.fitting(extent, unit));
            transform.scene_from_entity() * DAffine3::from_scale(DVec3::splat(fitting))
        });
        let own = frame.map_or(DAffine3::IDENTITY, |frame| frame.entity_from_data(unit));
        let moved = motion.map_or(DAffine3::IDENTITY, |motion| motion.0);
        placement.set_if_neq(Placement(moved * still * own));
    }
}
