//! The numbers in a value, and whether they are allowed.

use crate::components::Range;
use bevy_reflect::enums::VariantInfo;
use bevy_reflect::{PartialReflect, ReflectRef, TypeInfo};
use std::cmp::Ordering;

/// A number that is not allowed.
#[derive(Debug, PartialEq)]
pub(super) struct Refused {
    /// What it has to be.
    pub wanted: String,
    /// Its digits, as they would be written; none where only the text has them, because it is not finite or does not fit.
    pub digits: Option<String>,
}

/// The first number in a value, however deep, that is not finite or not in the range that its field allows. `range` is that of the field which
/// the value stands in; fields inside of it may have their own.
pub(super) fn refused(value: &dyn PartialReflect, range: Option<&Range>) -> Option<Refused> {
    let info = value.get_represented_type_info();
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => fields.iter_fields().enumerate().find_map(|(index, (_, field))| {
            let own = info.and_then(|info| info.as_struct().ok()?.field_at(index)?.get_attribute());
            refused(field, own.or(range))
        }),
        ReflectRef::TupleStruct(fields) => fields.iter_fields().enumerate().find_map(|(index, field)| {
            let own = info.and_then(|info| info.as_tuple_struct().ok()?.field_at(index)?.get_attribute());
            refused(field, own.or(range))
        }),
        ReflectRef::Enum(variant) => variant.iter_fields().enumerate().find_map(|(index, field)| {
            refused(field.value(), of_variant(info, variant.variant_name(), index).or(range))
        }),
        ReflectRef::Tuple(fields) => fields.iter_fields().find_map(|field| refused(field, range)),
        ReflectRef::List(items) => items.iter().find_map(|item| refused(item, range)),
        ReflectRef::Array(items) => items.iter().find_map(|item| refused(item, range)),
        // Ranges are about values, not about what they are found by.
        ReflectRef::Map(entries) => entries.iter().find_map(|(_, entry)| refused(entry, range)),
        ReflectRef::Set(items) => items.iter().find_map(|item| refused(item, range)),
        _ => Number::of(value)?.refused(range),
    }
}

/// The range of a field of a variant, where it has one of its own.
fn of_variant(info: Option<&'static TypeInfo>, variant: &str, index: usize) -> Option<&'static Range> {
    match info?.as_enum().ok()?.variant(variant)? {
        VariantInfo::Struct(fields) => fields.field_at(index)?.get_attribute(),
        VariantInfo::Tuple(fields) => fields.field_at(index)?.get_attribute(),
        VariantInfo::Unit(_) => None,
    }
}

/// A number of any type.
#[derive(Clone, Copy, Debug)]
enum Number {
    Single(f32),
    Double(f64),
    Whole(i128),
}

macro_rules! whole {
    ($value:expr; $($ty:ty),*; $($wide:ty),*; $($non_zero:ty),*) => {
        $(if let Some(number) = $value.try_downcast_ref::<$ty>() {
            return Some(Self::Whole(i128::from(*number)));
        })*
        $(if let Some(number) = $value.try_downcast_ref::<$wide>() {
            return Some(Self::Whole(i128::try_from(*number).unwrap_or(i128::MAX)));
        })*
        $(if let Some(number) = $value.try_downcast_ref::<$non_zero>() {
            return Some(Self::Whole(i128::try_from(number.get()).unwrap_or(i128::MAX)));
        })*
    };
}

impl Number {
    fn of(value: &dyn PartialReflect) -> Option<Self> {
        use std::num::*;
        if let Some(number) = value.try_downcast_ref::<f32>() {
            return Some(Self::Single(*number));
        }
        if let Some(number) = value.try_downcast_ref::<f64>() {
            return Some(Self::Double(*number));
        }
        whole!(value;
            u8, u16, u32, u64, i8, i16, i32, i64;
            usize, isize, i128, u128;
            NonZeroU8, NonZeroU16, NonZeroU32, NonZeroU64, NonZeroU128, NonZeroUsize,
            NonZeroI8, NonZeroI16, NonZeroI32, NonZeroI64, NonZeroI128, NonZeroIsize
        );
        None
    }

    fn refused(self, range: Option<&Range>) -> Option<Refused> {
        let range = range.copied().unwrap_or(Range::new(f64::MIN, f64::MAX));
        if self.is_in(&range) {
            return None;
        }
        let is_bounded = range.min > f64::MIN || range.max < f64::MAX;
        let wanted = match self {
            _ if !is_bounded => "a finite number".into(),
            _ if self.counts_as_0(&range) => {
                format!("{range} (at least 1.2e-38: a GPU takes less for 0)")
            }
            _ => range.to_string(),
        };
        Some(Refused { wanted, digits: self.digits() })
    }

    fn is_in(self, range: &Range) -> bool {
        let is_between = |low: Ordering, high: Ordering| {
            high != Ordering::Greater
                && (low == Ordering::Greater || low == Ordering::Equal && !range.above_min)
        };
        match self {
            Self::Single(number) => number.is_finite() && range.contains(f64::from(number)),
            Self::Double(number) => {
                let to = |bound: f64| number.partial_cmp(&bound).unwrap_or(Ordering::Greater);
                number.is_finite() && !range.counts_as_0(number) && is_between(to(range.min), to(range.max))
            }
            Self::Whole(number) => is_between(compare(number, range.min), compare(number, range.max)),
        }
    }

    /// Whether it is above 0, as it is to be, but not on a GPU.
    fn counts_as_0(self, range: &Range) -> bool {
        match self {
            Self::Single(number) => range.counts_as_0(f64::from(number)),
            Self::Double(number) => range.counts_as_0(number),
            Self::Whole(_) => false,
        }
    }

    fn digits(self) -> Option<String> {
        match self {
            Self::Single(number) => number.is_finite().then(|| number.to_string()),
            Self::Double(number) => number.is_finite().then(|| number.to_string()),
            // Stands for all above it.
            Self::Whole(i128::MAX) => None,
            Self::Whole(number) => Some(number.to_string()),
        }
    }
}

/// Compares where 64 bits of floating point do not hold every whole number.
fn compare(whole: i128, bound: f64) -> Ordering {
    match (whole as f64).total_cmp(&(bound + 0.0)) {
        Ordering::Equal => whole.cmp(&(bound as i128)),
        unequal => unequal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_reflect::Reflect;
    use glam::{DVec3, I64Vec2, Mat2, Quat, U8Vec4, Vec4};
    use std::num::NonZeroU16;

    fn digits(value: &dyn Reflect, range: &Range) -> Option<String> {
        refused(value.as_partial_reflect(), Some(range)).and_then(|refused| refused.digits)
    }

    #[test]
    fn every_type_of_number_is_looked_at() {
        let small = Range::new(-2.0, 3.0);
        let numbers: [(&dyn Reflect, &str); 17] = [
            (&4_u8, "4"),
            (&4_u16, "4"),
            (&4_u32, "4"),
            (&4_u64, "4"),
            (&4_usize, "4"),
            (&4_u128, "4"),
            (&-3_i8, "-3"),
            (&-3_i16, "-3"),
            (&-3_i32, "-3"),
            (&-3_i64, "-3"),
            (&-3_isize, "-3"),
            (&3.5_f32, "3.5"),
            (&-2.25_f64, "-2.25"),
            (&Vec4::new(0.0, 1.0, 2.0, 3.25), "3.25"),
            (&DVec3::new(0.0, -9.0, 0.0), "-9"),
            (&I64Vec2::new(1, -5), "-5"),
            (&U8Vec4::new(0, 0, 200, 0), "200"),
        ];
        for (number, expected) in numbers {
            assert_eq!(digits(number, &small).as_deref(), Some(expected), "{number:?}");
        }
        assert_eq!(digits(&NonZeroU16::MAX, &small).as_deref(), Some("65535"));
        assert_eq!(digits(&Quat::from_xyzw(0.0, 0.0, 0.0, -7.0), &small).as_deref(), Some("-7"));
        assert_eq!(digits(&Mat2::from_cols_array(&[0.0, 0.0, 0.0, 8.0]), &small).as_deref(), Some("8"));
        assert_eq!(digits(&vec![Some([1.0_f32, 5.0])], &small).as_deref(), Some("5"));
        for fine in [&3_u8 as &dyn Reflect, &-2_i64, &-2.0_f64, &3.0_f32, &Vec4::ONE, &"4".to_owned(), &true]
        {
            assert_eq!(refused(fine.as_partial_reflect(), Some(&small)), None, "{fine:?}");
        }
    }

    #[test]
    fn what_is_not_finite_is_refused_without_a_range() {
        for value in [&f64::NAN as &dyn Reflect, &f32::INFINITY, &DVec3::NEG_INFINITY, &Quat::NAN] {
            let refused = refused(value.as_partial_reflect(), None);
            assert_eq!(
                refused,
                Some(Refused { wanted: "a finite number".into(), digits: None }),
                "{value:?}"
            );
        }
        assert_eq!(refused(&u64::MAX, None), None);
    }

    #[test]
    fn bounds_are_exact_but_for_numbers_of_32_bits() {
        let range = Range::new(0.0, 9_007_199_254_740_992.0);
        assert_eq!(digits(&9_007_199_254_740_992_u64, &range), None);
        assert_eq!(digits(&9_007_199_254_740_993_u64, &range).as_deref(), Some("9007199254740993"));
        let tenth = Range::new(0.1, 1.0);
        assert_eq!(digits(&0.1_f32, &tenth), None);
        assert_eq!(digits(&0.1_f64, &tenth), None);
        assert_eq!(digits(&0.099_999_999_9_f64, &tenth).as_deref(), Some("0.0999999999"));
        assert_eq!(digits(&0_u8, &Range::positive()).as_deref(), Some("0"));
        assert_eq!(digits(&-0.0_f64, &Range::non_negative()), None, "it is 0");
    }

    #[test]
    fn what_a_gpu_takes_for_0_is_not_above_0() {
        let least = f32::MIN_POSITIVE;
        for fine in [&least as &dyn Reflect, &f64::from(least), &1_u8] {
            assert_eq!(refused(fine.as_partial_reflect(), Some(&Range::positive())), None, "{fine:?}");
        }
        for tiny in [&1e-45_f32 as &dyn Reflect, &1e-39_f32, &1e-39_f64, &Vec4::new(1.0, 1.0, 1e-39, 1.0)] {
            let told = refused(tiny.as_partial_reflect(), Some(&Range::positive())).unwrap().wanted;
            assert!(told.starts_with("above 0") && told.contains("1.2e-38"), "{told}");
        }
        // What may be 0 may be taken for 0, and where 0 itself is refused, so is what has the wrong sign.
        assert_eq!(digits(&1e-45_f32, &Range::non_negative()), None);
        let told = refused(&-1e-45_f32, Some(&Range::positive())).unwrap().wanted;
        assert_eq!(told, "above 0");
    }

    #[test]
    fn fields_inside_have_ranges_of_their_own() {
        #[derive(Reflect)]
        struct Outer {
            #[reflect(@Range::new(0.0, 10.0))]
            wide: Option<u8>,
            plain: u8,
        }
        let within = Range::new(0.0, 3.0);
        assert_eq!(digits(&Outer { wide: Some(9), plain: 2 }, &within), None);
        assert_eq!(digits(&Outer { wide: Some(11), plain: 2 }, &within).as_deref(), Some("11"));
        assert_eq!(digits(&Outer { wide: None, plain: 4 }, &within).as_deref(), Some("4"));
    }
}
