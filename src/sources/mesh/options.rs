//! What a person may say about how a mesh is read.

use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How the normals of a mesh come about.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum Normals {
    /// Those of the file; where it has none, by its smoothing groups; where it has none of those either, `Smooth(40.0)`.
    #[default]
    Auto,
    /// Those of the faces, whatever the file says.
    Flat,
    /// Means over the faces that meet at no more than this angle, in degrees, whatever the file says; 180 rounds every edge.
    Smooth(#[reflect(@crate::components::Range::new(0.0, 180.0), @crate::components::Unit("degrees"))] f32),
}

/// The angle, in degrees, beyond which edges are hard where nobody says otherwise.
pub const CREASE_DEGREES: f32 = 40.0;
