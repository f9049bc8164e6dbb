//! What a value should look like, and what was found in its stead, in words.

use crate::components::{Leading, Shorthand};
use bevy_reflect::enums::{StructVariantInfo, VariantInfo};
use bevy_reflect::structs::StructInfo;
use bevy_reflect::{PartialReflect, TypeRegistration};

pub(super) fn how_to_write(variant: &VariantInfo) -> String {
    match variant {
        VariantInfo::Unit(info) => format!("`{}`", info.name()),
        VariantInfo::Tuple(info) => format!("`{}({})`", info.name(), vec!["…"; info.field_len()].join(", ")),
        VariantInfo::Struct(info) if is_led(info) => format!("`{}(…)`", info.name()),
        VariantInfo::Struct(info) => format!("`{}(field: value, …)`", info.name()),
    }
}

/// Whether the first field of a variant may stand without its name.
pub(super) fn is_led(variant: &StructVariantInfo) -> bool {
    variant.iter().next().is_some_and(|field| field.has_attribute::<Leading>())
}

/// The name in front of the parentheses that stands for the first field of a struct, if one does.
pub(super) fn shorthand(info: &StructInfo) -> Option<&'static str> {
    info.iter().next()?.get_attribute::<Shorthand>().map(|shorthand| shorthand.0)
}

/// What a leaf of this type looks like.
pub(super) fn wanted(registration: &TypeRegistration) -> String {
    let name = registration.type_info().type_path_table().short_path();
    match name {
        "f32" | "f64" => "a number".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of 0 or more".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "bool" => "`true` or `false`".into(),
        "String" => "text in quotes".into(),
        "AssetPath" => "a path in quotes".into(),
        "Vec2" => "two numbers `(x, y)`".into(),
        "Vec3" => "three numbers `(x, y, z)`".into(),
        "Vec4" => "four numbers `(x, y, z, w)`".into(),
        "UVec2" => "two whole numbers of 0 or more `(x, y)`".into(),
        "UVec3" => "three whole numbers of 0 or more `(x, y, z)`".into(),
        _ => format!("a `{name}`"),
    }
}

/// Whether [`wanted`] says all there is to say.
pub(super) fn is_plain(registration: &TypeRegistration) -> bool {
    !wanted(registration).starts_with("a `")
}

/// The numbers in a leaf, each with its digits as they would be written.
pub(super) fn numbers(value: &dyn PartialReflect) -> Vec<(f64, String)> {
    use glam::{UVec3, Vec2, Vec3};
    let single = |number: &f32| (f64::from(*number), number.to_string());
    let whole = |number: &u32| (f64::from(*number), number.to_string());
    if let Some(number) = value.try_downcast_ref::<f32>() {
        vec![single(number)]
    } else if let Some(number) = value.try_downcast_ref::<f64>() {
        vec![(*number, number.to_string())]
    } else if let Some(number) = value.try_downcast_ref::<u32>() {
        vec![whole(number)]
    } else if let Some(number) = value.try_downcast_ref::<i32>() {
        vec![(f64::from(*number), number.to_string())]
    } else if let Some(vector) = value.try_downcast_ref::<Vec2>() {
        vector.to_array().iter().map(single).collect()
    } else if let Some(vector) = value.try_downcast_ref::<Vec3>() {
        vector.to_array().iter().map(single).collect()
    } else if let Some(vector) = value.try_downcast_ref::<UVec3>() {
        vector.to_array().iter().map(whole).collect()
    } else {
        Vec::new()
    }
}

/// The first characters of a text, on one line.
pub(super) fn excerpt(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let short: String = line.chars().take(40).collect();
    if short.len() < text.len() { format!("{short}…") } else { short }
}
