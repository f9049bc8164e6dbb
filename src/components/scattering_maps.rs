use super::{Auto, Label, Range, Slider, Unit, Validate, attributes::ReflectValidate};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How finely the light that leaves a translucent mesh is computed: speed against accuracy.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `strategy` | `Adaptive` or `Uniform` | – | – | `Adaptive` |
/// | `cameras` | scattering cameras that the program spreads around the mesh | – | 0 to 64 | 16 |
/// | `samples` | points of the light for each point of the surface and each light | – | 1 to 1,024 | 128 |
/// | `candidates` | `Auto`, or points of which the `samples` nearest are used | – | `samples` to 4,096 | `Auto` |
/// | `resolution` | `Auto`, or `Texels(w, h)` of each camera's map | texels | 1 to 4,096 | `Auto` |
/// | `radius` | `Auto`, or `Millimetres(r)` of the disc that samples lie in | mm | above 0 | `Auto` |
/// | `bias` | `Auto`, or how far behind what a map shows a point still counts as seen | the mesh's radius | 0 to 1 | `Auto` |
/// | `progressive` | whether the pictures of a still scene average into a better one | – | – | true |
///
/// *Uniform* is the algorithm as published (Dal Corso, Frisvad, Mosegaard & Bærentzen, *Interactive Directional Subsurface Scattering and
/// Transport of Emergent Light*, 2016): every covered texel of every camera's map is evaluated with the same discs of samples, whose
/// density falls exponentially from the middle. *Adaptive* is what this project makes of it: the resolution comes from the mean free
/// path and from the mesh's size on the screen, and each point of the surface is evaluated once. What the fields mean to either:
///
/// | field | `Adaptive` | `Uniform` |
/// |---|---|---|
/// | `cameras` | as many, with `resolution: Texels(w, h)` or beside cameras by hand; otherwise no maps are made | as many |
/// | `samples` | as many | as many |
/// | `candidates` | without effect | `Auto` takes `samples`, so all are used |
/// | `resolution` | `Auto`: the points of the surface itself, refined as the mean free path and the picture call for | `Auto`: the size of the picture |
/// | `radius` | `Auto`: as far as light gets in the medium | the same |
/// | `bias` | `Auto`: from the texels' size | the same |
/// | `progressive` | the samples differ from picture to picture | the same |
///
/// Where the mean free path is much shorter than the way that light gets in the medium, few of *Uniform*'s samples fall where the light
/// is, and the mesh comes out too dark and patchy; a smaller `radius` helps with light from the front and cuts off that from behind.
///
/// [`ScatteringCamera`](super::ScatteringCamera) entities add views by hand to either, whatever `cameras` says. Every
/// [`Subsurface`](super::Subsurface) has a `ScatteringMaps`, by default if none is written.
///
/// ```ron
/// ScatteringMaps: (samples: 16, resolution: Texels(256, 256))
/// ScatteringMaps: (strategy: Uniform, cameras: 8, samples: 48, candidates: 96, resolution: Texels(1200, 680), radius: Millimetres(5.0))
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
pub struct ScatteringMaps {
    /// How points and samples are chosen.
    pub strategy: MapStrategy,
    /// Cameras that are spread around the mesh.
    #[reflect(@Range::new(0.0, 64.0))]
    pub cameras: u32,
    /// Points of the light per point of the surface.
    #[reflect(@Range::new(1.0, 1024.0), @Slider::logarithmic(1.0, 1024.0))]
    pub samples: u32,
    /// Points of the light of which the nearest are used.
    #[reflect(@Range::new(1.0, 4096.0), @Slider::logarithmic(1.0, 4096.0))]
    pub candidates: Auto<u32>,
    /// Texels of each camera's map.
    pub resolution: MapResolution,
    /// How far from a point of the surface its samples lie.
    pub radius: SampleRadius,
    /// How far a point may lie behind what a map shows and still count as seen.
    #[reflect(@Range::new(0.0, 1.0), @Unit("mesh radii"))]
    pub bias: Auto<f32>,
    /// Whether a picture of a still scene goes on improving.
    pub progressive: bool,
}

impl Default for ScatteringMaps {
    fn default() -> Self {
        Self {
            strategy: MapStrategy::Adaptive,
            cameras: 16,
            samples: 128,
            candidates: Auto::Auto,
            resolution: MapResolution::Auto,
            radius: SampleRadius::Auto,
            bias: Auto::Auto,
            progressive: true,
        }
    }
}

impl Validate for ScatteringMaps {
    fn problems(&self) -> Vec<(&'static str, String)> {
        match self.candidates {
            Auto::Value(candidates) if candidates < self.samples => vec![(
                "candidates",
                format!(
                    "the {} `samples` are chosen from the `candidates`, of which there must be as many or more; found {candidates}",
                    self.samples
                ),
            )],
            _ => Vec::new(),
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
    Texels(
        /// Texels from left to right.
        #[reflect(@Range::new(1.0, 4096.0), @Slider::logarithmic(16.0, 4096.0), @Label("across"), @Unit("texels"))]
        u32,
        /// Texels from top to bottom.
        #[reflect(@Range::new(1.0, 4096.0), @Slider::logarithmic(16.0, 4096.0), @Label("down"), @Unit("texels"))]
        u32,
    ),
}

/// How far samples lie from the point that they are for.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum SampleRadius {
    /// As far as light gets in the medium.
    #[default]
    Auto,
    /// This far.
    Millimetres(
        #[reflect(@Range::positive(), @Slider::logarithmic(0.01, 100.0), @Label("radius"), @Unit("mm"))] f32,
    ),
}
