//! Attributes that a field carries in its reflection: what a reader of scenes checks and an inspector shows.

use bevy_reflect::{Reflect, reflect_trait};

/// The closed range that a number, or each part of a vector, must lie in.
///
/// ```
/// use bevy_reflect::Reflect;
/// use tyndall::components::Range;
///
/// #[derive(Reflect)]
/// struct Fog {
///     #[reflect(@Range::new(0.0, 1.0))]
///     density: f32,
/// }
/// ```
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The least value allowed.
    pub min: f64,
    /// The greatest value allowed.
    pub max: f64,
    /// Whether `min` itself is refused.
    pub above_min: bool,
}

impl Range {
    /// From `min` to `max`, both allowed.
    pub const fn new(min: f64, max: f64) -> Self {
        Self { min, max, above_min: false }
    }

    /// Zero and everything above.
    pub const fn non_negative() -> Self {
        Self::new(0.0, f64::MAX)
    }

    /// Everything above zero.
    pub const fn positive() -> Self {
        Self { min: 0.0, max: f64::MAX, above_min: true }
    }

    /// Whether `value` is allowed. NaN never is. A bound that 32 bits do not hold exactly allows its 32-bit neighbour, which is what
    /// a field of 32 bits has in its stead. What is to be above 0 is at least [`LEAST_ABOVE_0`](Self::LEAST_ABOVE_0).
    pub fn contains(&self, value: f64) -> bool {
        let min = self.min.min(f64::from(self.min as f32));
        let max = self.max.max(f64::from(self.max as f32));
        value <= max && if self.above_min { value > min && !self.counts_as_0(value) } else { value >= min }
    }

    /// The least number above 0 that a GPU tells from 0: 1.2e-38, the least normal number of 32 bits.
    pub const LEAST_ABOVE_0: f64 = f32::MIN_POSITIVE as f64;

    /// Whether a number that is to be above 0 is so close to it that a GPU takes it for 0.
    pub(crate) fn counts_as_0(&self, value: f64) -> bool {
        self.above_min && self.min == 0.0 && value > 0.0 && value < Self::LEAST_ABOVE_0
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (min, max) = (short(self.min), short(self.max));
        match (self.above_min, self.max == f64::MAX) {
            (true, true) => write!(f, "above {min}"),
            (false, true) => write!(f, "at least {min}"),
            (true, false) => write!(f, "above {min} and at most {max}"),
            (false, false) => write!(f, "from {min} to {max}"),
        }
    }
}

/// A number with its digits, or with an exponent where that is much shorter.
fn short(number: f64) -> String {
    let (plain, exponent) = (number.to_string(), format!("{number:e}"));
    if plain.len() > exponent.len() + 4 { exponent } else { plain }
}

/// A vector as it is written in RON.
pub(crate) fn in_ron(numbers: &[f32]) -> String {
    let numbers: Vec<_> = numbers.iter().map(f32::to_string).collect();
    format!("({})", numbers.join(", "))
}

/// The unit of a field, for people: `"mm"`, `"degrees"`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Unit(pub &'static str);

/// Marks the first field of an enum's variant as one that may stand without its name, if it stands alone: `File("head.nii")`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Leading;

/// Marks the first field of a struct as one that a name in front of the parentheses stands for: with `Shorthand("Preset")`,
/// `Preset("Object")` means `(preset: "Object")`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Shorthand(pub &'static str);

/// Marks a field of an enum variant that has no default and must be written.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Required;

/// The texts that a field may hold, in small or capital letters.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(opaque)]
pub struct Names {
    /// What one of them is the name of, for people: `"medium"`.
    pub of: &'static str,
    /// All of them.
    pub known: &'static [&'static str],
}

impl Names {
    /// Whether `name` is one of them.
    pub fn contains(&self, name: &str) -> bool {
        self.known.iter().any(|known| known.eq_ignore_ascii_case(name))
    }
}

/// What else people call a component, a variant or a field, to be suggested where they write it so: what other programs call it, or what it is
/// for. It cannot be written by these names.
///
/// ```
/// use bevy_reflect::Reflect;
/// use tyndall::components::AlsoCalled;
///
/// #[derive(Reflect)]
/// #[reflect(@AlsoCalled(&["Spin"]))]
/// struct Turning {
///     #[reflect(@AlsoCalled(&["rate", "speed"]))]
///     degrees_per_second: f32,
/// }
/// ```
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(opaque)]
pub struct AlsoCalled(pub &'static [&'static str]);

/// Marks a field of a component that holds the name of another entity, for which the scene must write the component that this names:
/// `#[reflect(@NameOf("Subsurface"))]`.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct NameOf(pub &'static str);

/// Marks an enum whose variants are written without their names: a unit variant by its bare word, a variant with one field by the
/// value alone. Of several such variants the first that fits is taken.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Untagged;

/// Checks that concern several fields of a value together.
///
/// Implement it and write `#[reflect(Validate)]` on the type; the reader of scenes calls it after the fields are read.
#[reflect_trait]
pub trait Validate {
    /// What is wrong: the name of the field at fault (empty for the whole value), and a sentence that says what was expected
    /// and what was found.
    fn problems(&self) -> Vec<(&'static str, String)>;
}
