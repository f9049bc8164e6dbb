use super::{Auto, Range, Unit};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How finely the light that leaves a translucent mesh is computed: speed against accuracy.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct ScatteringMaps {
    /// How points and samples are chosen.
    pub strategy: MapStrategy,
    /// Cameras that are spread around the mesh.
    #[reflect(@Range::new(0.0, 64.0))]
    pub cameras: u32,
    /// Points of the light per point of the surface.
    #[reflect(@Range::new(1.0, 1024.0))]
    pub samples: u32,
    /// Points of the light of which the nearest are used.
    #[reflect(@Range::new(1.0, 65_536.0))]
    pub candidates: Auto<u32>,
    /// Texels of each camera's map.
    pub resolution: MapResolution,
    /// How far from a point of the surface its samples lie.
    pub radius: SampleRadius,
    /// How far a point may lie behind what a map shows and still count as seen.
    #[reflect(@Range::new(0.0, 1.0))]
    pub bias: Auto<f32>,
    /// Whether a picture of a still scene goes on improving.
    pub progressive: bool,
}

impl Default for ScatteringMaps {
    fn default() -> Self {
        Self {
            strategy: MapStrategy::Adaptive,
            cameras: 16,
            samples: 48,
            candidates: Auto::Auto,
            resolution: MapResolution::Auto,
            radius: SampleRadius::Auto,
            bias: Auto::Auto,
            progressive: true,
        }
    }
}

/// How the points of a surface and the samples of each are chosen.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum MapStrategy {
    /// Where they are worth most.
    #[default]
    Adaptive,
    /// Everywhere alike, as published.
    Uniform,
}

/// Texels of a camera's map.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum MapResolution {
    /// As many as the medium and the picture call for.
    #[default]
    Auto,
    /// Across and down.
    Texels(#[reflect(@Range::new(1.0, 4096.0))] u32, #[reflect(@Range::new(1.0, 4096.0))] u32),
}

/// How far samples lie from the point that they are for.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum SampleRadius {
    /// As far as light gets in the medium.
    #[default]
    Auto,
    /// This far.
    Millimetres(#[reflect(@Range::positive(), @Unit("mm"))] f32),
}
