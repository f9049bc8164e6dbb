use super::{AlsoCalled, Range, Slider, Unit};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How finely a volume is sampled along a ray: speed against accuracy.
///
/// | field | unit | range | default |
/// |---|---|---|---|
/// | `step` | voxels (of the shortest spacing) | 0.01 to 100 | 1.0 |
/// | `early_termination` | opacity at which a ray ends; 1 never | 0 to 1 | 0.99 |
/// | `skip_empty` | leap over bricks that the transfer function leaves empty; the picture is the same | – | true |
///
/// The error falls with the square of `step`, and `early_termination` leaves out at most one minus its value of the light behind.
///
/// ```ron
/// RayCast: (step: 0.5, early_termination: 0.999)
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[reflect(@AlsoCalled(&["RayMarch", "RayMarching", "RayCaster", "VolumeRendering"]))]
pub struct RayCast {
    /// Distance of the samples.
    #[reflect(@Range::new(0.01, 100.0), @Slider::logarithmic(0.1, 10.0), @Unit("voxels"))]
    pub step: f32,
    /// The opacity at which a ray is taken to be at its end.
    #[reflect(@Range::new(0.0, 1.0))]
    pub early_termination: f32,
    /// Whether empty bricks are leapt over.
    pub skip_empty: bool,
}

impl Default for RayCast {
    fn default() -> Self {
        Self { step: 1.0, early_termination: 0.99, skip_empty: true }
    }
}
