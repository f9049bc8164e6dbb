//! Attributes that a field carries for people: what an inspector shows, and a reader of scenes need not know.

use bevy_reflect::{Reflect, reflect_trait};

/// The values that a slider offers; others that the field's [`Range`](super::Range) allows can still be typed.
///
/// ```
/// use bevy_reflect::Reflect;
/// use tyndall::components::{Range, Slider};
///
/// #[derive(Reflect)]
/// struct Highlight {
///     #[reflect(@Range::new(0.0, 10_000.0), @Slider::logarithmic(1.0, 10_000.0))]
///     shininess: f32,
/// }
/// ```
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// The left end.
    pub min: f64,
    /// The right end.
    pub max: f64,
    /// Whether equal ways multiply by equal factors, as values that span decades want.
    pub is_logarithmic: bool,
}

impl Slider {
    /// Equal ways add equal amounts.
    pub const fn linear(min: f64, max: f64) -> Self {
        Self { min, max, is_logarithmic: false }
    }

    /// Equal ways multiply by equal factors.
    pub const fn logarithmic(min: f64, max: f64) -> Self {
        Self { min, max, is_logarithmic: true }
    }
}

/// Marks a vector whose parts are for red, green and blue light.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rgb {
    /// A colour that can be shown, linear; parts above 1 are brighter than white.
    Colour,
    /// Coefficients of a medium, which look like nothing in themselves.
    Coefficients,
}

/// Marks a vector in the scene of which only the direction matters.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction;

/// What a field without a name is called: `#[reflect(@Label("position"))]`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label(pub &'static str);

/// What an enum becomes when a person chooses another of its variants, where defaults would lose what is known.
///
/// Implement it and write `#[reflect(ChooseVariant)]` on the type.
#[reflect_trait]
pub trait ChooseVariant {
    /// The same thing as `variant`; none where defaults say as much.
    fn chosen(&self, variant: &str) -> Option<Box<dyn Reflect>>;
}
