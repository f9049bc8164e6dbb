//! A value that is either written or left to the program.

use super::attributes::Untagged;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// `Auto`, or a value: in RON simply the word `Auto` or the value itself.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq, @Untagged)]
pub enum Auto<T: Default + Clone + PartialEq + std::fmt::Debug> {
    /// The program decides; the field's documentation says how.
    #[default]
    Auto,
    /// This value.
    Value(T),
}

impl<T: Default + Copy + PartialEq + std::fmt::Debug> Auto<T> {
    /// The value written, or `auto`.
    pub fn unwrap_or(self, auto: T) -> T {
        match self {
            Self::Auto => auto,
            Self::Value(value) => value,
        }
    }
}
