//! What a value should look like, and what was found in its stead, in words.

use crate::components::{Leading, Shorthand};
use bevy_reflect::enums::{StructVariantInfo, VariantInfo};
use bevy_reflect::structs::StructInfo;
use bevy_reflect::{NamedField, TypeInfo, TypeRegistration};

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
    let info = registration.type_info();
    let name = info.type_path_table().short_path();
    if let Some(kind) = Kind::of(info.type_path()) {
        return kind.one();
    }
    match (name, info) {
        ("bool", _) => "`true` or `false`".into(),
        ("char", _) => "a letter in quotes `'a'`".into(),
        ("String", _) => "text in quotes".into(),
        ("AssetPath", _) => "a path in quotes".into(),
        (_, TypeInfo::Struct(fields)) if info.type_path().starts_with("glam::") => {
            vector(fields).unwrap_or_else(|| format!("a `{name}`"))
        }
        (_, TypeInfo::Array(items)) => format!("{} values in parentheses", items.capacity()),
        _ => format!("a `{name}`"),
    }
}

/// The same in as few words as can be: `number`, `(x, y, z)`.
pub(crate) fn wanted_in_short(registration: &TypeRegistration) -> String {
    let wanted = wanted(registration);
    match wanted.split_once('`') {
        Some((words, vector)) if vector.starts_with('(') => {
            let kind = if words.contains("whole") { " whole numbers" } else { "" };
            format!("{}{kind}", vector.trim_end_matches('`'))
        }
        _ => wanted.strip_prefix("a ").unwrap_or(&wanted).to_owned(),
    }
}

/// Whether [`wanted`] says all there is to say.
pub(super) fn is_plain(registration: &TypeRegistration) -> bool {
    !wanted(registration).starts_with("a `")
}

/// What is more to be said of a whole number that its type does not hold.
pub(super) fn too_large(registration: &TypeRegistration, text: &str) -> Option<String> {
    let kind = Kind::of(registration.type_info().type_path())?;
    let number: i128 = text.replace('_', "").parse().ok()?;
    let (least, greatest) = kind.limits()?;
    match () {
        () if number > greatest => Some(format!("at most {greatest} can be written here")),
        () if number < least && least < 0 => Some(format!("at least {least} can be written here")),
        () => None,
    }
}

/// What numbers of a type are called.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Real,
    /// Whole numbers of so many bits.
    Signed(u32),
    Unsigned(u32),
    NonZero,
}

impl Kind {
    fn of(type_path: &str) -> Option<Self> {
        Some(match type_path {
            "f32" | "f64" => Self::Real,
            "u8" => Self::Unsigned(8),
            "u16" => Self::Unsigned(16),
            "u32" => Self::Unsigned(32),
            "u64" => Self::Unsigned(64),
            "u128" => Self::Unsigned(128),
            "usize" => Self::Unsigned(usize::BITS),
            "i8" => Self::Signed(8),
            "i16" => Self::Signed(16),
            "i32" => Self::Signed(32),
            "i64" => Self::Signed(64),
            "i128" => Self::Signed(128),
            "isize" => Self::Signed(isize::BITS),
            path if path.contains("::NonZero") => Self::NonZero,
            _ => return None,
        })
    }

    fn limits(self) -> Option<(i128, i128)> {
        match self {
            Self::Unsigned(bits @ ..128) => Some((0, (1 << bits) - 1)),
            Self::Signed(bits @ ..128) => Some((-(1 << (bits - 1)), (1 << (bits - 1)) - 1)),
            _ => None,
        }
    }

    fn one(self) -> String {
        match (self, self.limits()) {
            (Self::Real, _) => "a number".into(),
            (Self::NonZero, _) => "a whole number other than 0".into(),
            // Short enough to be worth telling.
            (Self::Signed(8 | 16) | Self::Unsigned(8 | 16), Some((least, greatest))) => {
                format!("a whole number from {least} to {greatest}")
            }
            (Self::Unsigned(_), _) => "a whole number of 0 or more".into(),
            (Self::Signed(_), _) => "a whole number".into(),
        }
    }

    fn many(self) -> String {
        self.one().replacen("a ", "", 1).replacen("number", "numbers", 1)
    }
}

/// A vector of glam's by the names of its parts, or a matrix, whose parts are written one after the other.
fn vector(fields: &StructInfo) -> Option<String> {
    let first = fields.field_at(0)?.type_path();
    let names: Vec<&str> = fields.iter().map(NamedField::name).collect();
    if first == "bool" {
        return Some(format!("{} of `true` and `false` `({})`", word(names.len()), names.join(", ")));
    }
    if let Some(kind) = Kind::of(first) {
        return Some(format!("{} {} `({})`", word(names.len()), kind.many(), names.join(", ")));
    }
    let columns = fields.iter().map(|field| match field.type_info()? {
        TypeInfo::Struct(column) => count(column),
        _ => None,
    });
    let all = columns.sum::<Option<usize>>()?;
    Some(format!("{} numbers in parentheses, column after column", word(all)))
}

/// The numbers of a matrix or a column.
fn count(fields: &StructInfo) -> Option<usize> {
    let each = fields.iter().map(|field| match field.type_info()? {
        TypeInfo::Struct(column) => count(column),
        info => Kind::of(info.type_path()).map(|_| 1),
    });
    each.sum()
}

fn word(count: usize) -> String {
    let words = ["two", "three", "four", "five", "six"];
    count.checked_sub(2).and_then(|index| words.get(index)).map_or(count.to_string(), |word| (*word).into())
}

/// The first characters of a text, on one line.
pub(super) fn excerpt(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let short: String = line.chars().take(40).collect();
    if short.len() < text.len() { format!("{short}…") } else { short }
}
