//! Reflected values become RON, as the reader reads it.

use super::layout::{Item, Written};
use super::path::{is_option, same};
use super::wanted::shorthand;
use crate::components::{AssetPath, Leading, Required, Shorthand, Untagged};
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, Enum, EnumInfo, VariantInfo};
use bevy_reflect::serde::TypedReflectSerializer;
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::{
    NamedField, PartialReflect, Reflect, ReflectDeserialize, ReflectFromReflect, ReflectRef, TypeInfo,
    TypeRegistration, TypeRegistry,
};

/// Why a value cannot be written in a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Its type is unknown.
    #[error(
        "`{type_path}` is not registered for reflection; the plugin that defines it must call `app.register_type` for it"
    )]
    Unregistered {
        /// The type.
        type_path: String,
    },
    /// Its serializer fails, or it has none.
    #[error("`{type_path}` cannot be serialized: {message}; derive `Serialize` and reflect it")]
    Serialize {
        /// The type.
        type_path: String,
        /// What the serializer says.
        message: String,
    },
    /// What was written is read as something else.
    #[error(
        "`{type_path}` is not read as it is written: `{text}` gives another value; do its `Serialize`, `Deserialize` and defaults fit together?"
    )]
    Unfaithful {
        /// The type.
        type_path: String,
        /// How it would be written.
        text: String,
    },
}

/// The value in RON, on one line, as scenes write it: what is left out has its default.
///
/// ```
/// use tyndall::components::Phong;
/// use tyndall::prelude::*;
///
/// let mut registry = bevy_reflect::TypeRegistry::new();
/// registry.register::<Phong>();
/// let phong = Phong { shininess: 8.0, ..Phong::default() };
/// assert_eq!(tyndall::scene::to_ron(&phong, &registry)?, "(shininess: 8.0)");
/// # Ok::<(), tyndall::scene::WriteError>(())
/// ```
///
/// # Errors
///
/// If a type in it is not registered, or cannot be serialized.
pub fn to_ron(value: &dyn PartialReflect, registry: &TypeRegistry) -> Result<String, WriteError> {
    Writer { registry, leaves_out_defaults: true }.value(value).map(|written| written.line())
}

/// The same with all fields, those that have their defaults too.
pub(crate) fn in_full(value: &dyn PartialReflect, registry: &TypeRegistry) -> Result<String, WriteError> {
    Writer { registry, leaves_out_defaults: false }.value(value).map(|written| written.line())
}

/// Whether two values are equal: by their own comparison, or else by what would be written.
pub(super) fn equal(one: &dyn PartialReflect, other: &dyn PartialReflect, registry: &TypeRegistry) -> bool {
    one.reflect_partial_eq(other).unwrap_or_else(|| match (to_ron(one, registry), to_ron(other, registry)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    })
}

/// Writes values of registered types.
pub(super) struct Writer<'r> {
    pub registry: &'r TypeRegistry,
    /// Whether fields that have their defaults are left out.
    pub leaves_out_defaults: bool,
}

impl<'r> Writer<'r> {
    /// A value, by its type.
    pub fn value(&self, value: &dyn PartialReflect) -> Result<Written, WriteError> {
        let unknown = || WriteError::Unregistered { type_path: value.reflect_type_path().to_owned() };
        let info = value.get_represented_type_info().ok_or_else(unknown)?;
        let registration = self.registry.get(info.type_id()).ok_or_else(unknown)?;
        if registration.data::<ReflectDeserialize>().is_some() {
            return self.leaf(value, registration);
        }
        match (info, value.reflect_ref()) {
            (TypeInfo::Struct(info), ReflectRef::Struct(fields)) => {
                let default = self.leaves_out_defaults.then(|| self.default_struct(value, registration));
                let known: Vec<_> = info.iter().collect();
                let default = default.flatten();
                let short = shorthand(info).filter(|_| {
                    let first = known.first().and_then(|first| fields.field(first.name()));
                    first.is_some_and(is_there)
                });
                let open = short.map_or("(".to_owned(), |name| format!("{name}("));
                self.fields(
                    &open,
                    &known,
                    |name| fields.field(name),
                    |name| match default.as_ref()?.reflect_ref() {
                        ReflectRef::Struct(fields) => fields.field(name),
                        _ => None,
                    },
                )
            }
            (TypeInfo::TupleStruct(_), ReflectRef::TupleStruct(fields)) => {
                self.list("(", fields.iter_fields())
            }
            (TypeInfo::Tuple(_), ReflectRef::Tuple(fields)) => self.list("(", fields.iter_fields()),
            (TypeInfo::List(_), ReflectRef::List(list)) => self.list("[", list.iter()),
            (TypeInfo::Enum(info), ReflectRef::Enum(holder)) => self.enumeration(info, holder, registration),
            _ => self.leaf(value, registration),
        }
    }

    fn list<'v>(
        &self,
        open: &str,
        values: impl Iterator<Item = &'v dyn PartialReflect>,
    ) -> Result<Written, WriteError> {
        let items = values.map(|value| Ok(Item { name: None, value: self.value(value)? }));
        let items = items.collect::<Result<Vec<_>, _>>()?;
        let close = if open == "[" { ']' } else { ')' };
        Ok(Written::Group { open: open.into(), items, close, spaced: false })
    }

    fn fields<'v>(
        &self,
        open: &str,
        known: &[&NamedField],
        field: impl Fn(&str) -> Option<&'v dyn PartialReflect>,
        default: impl Fn(&str) -> Option<&'v dyn PartialReflect>,
    ) -> Result<Written, WriteError> {
        let mut items = Vec::new();
        for name in known.iter().map(|known| known.name()) {
            let Some(value) = field(name) else { continue };
            let is_required =
                known.iter().any(|known| known.name() == name && known.has_attribute::<Required>());
            if !is_required && default(name).is_some_and(|default| same(default, value)) {
                continue;
            }
            items.push(Item { name: Some(name.to_owned()), value: self.value(value)? });
        }
        let first = known.first();
        let is_short =
            first.is_some_and(|first| first.has_attribute::<Leading>() || first.has_attribute::<Shorthand>());
        match items.as_mut_slice() {
            [only]
                if is_short && open.len() > 1 && only.name.as_deref() == first.map(|first| first.name()) =>
            {
                only.name = None;
            }
            _ if first.is_some_and(|first| first.has_attribute::<Shorthand>()) => {
                return Ok(Written::Group { open: "(".into(), items, close: ')', spaced: false });
            }
            _ => {}
        }
        Ok(Written::Group { open: open.into(), items, close: ')', spaced: false })
    }

    fn enumeration(
        &self,
        info: &EnumInfo,
        holder: &dyn Enum,
        registration: &TypeRegistration,
    ) -> Result<Written, WriteError> {
        let variant = holder.variant_name();
        let known = info.variant(variant);
        if info.has_attribute::<Untagged>() {
            return match holder.field_at(0) {
                Some(inner) => self.value(inner),
                None => Ok(Written::Word(variant.to_owned())),
            };
        }
        if is_option(registration.type_info()) {
            return self.option(holder);
        }
        let open = format!("{variant}(");
        match known {
            Some(VariantInfo::Struct(fields)) => {
                let default = self.leaves_out_defaults.then(|| self.default_variant(holder, registration));
                let default = default.flatten();
                let known: Vec<_> = fields.iter().collect();
                self.fields(
                    &open,
                    &known,
                    |name| holder.field(name),
                    |name| match default.as_ref()?.reflect_ref() {
                        ReflectRef::Enum(fields) => fields.field(name),
                        _ => None,
                    },
                )
            }
            Some(VariantInfo::Tuple(_)) => self.list(&open, holder.iter_fields().map(|field| field.value())),
            _ => Ok(Written::Word(variant.to_owned())),
        }
    }

    /// `None`, what it holds as it is where that cannot be taken for one of the two words, else `Some(value)`.
    fn option(&self, holder: &dyn Enum) -> Result<Written, WriteError> {
        let Some(inner) = holder.field_at(0) else { return Ok(Written::Word("None".into())) };
        let registration =
            inner.get_represented_type_info().and_then(|info| self.registry.get(info.type_id()));
        let is_plain = registration.is_some_and(|inner| inner.data::<ReflectDeserialize>().is_some());
        let value = self.value(inner)?;
        let is_word = matches!(&value, Written::Word(word) if word.starts_with(|c: char| c.is_alphabetic()));
        if is_plain && !is_word {
            return Ok(value);
        }
        let items = vec![Item { name: None, value }];
        Ok(Written::Group { open: "Some(".into(), items, close: ')', spaced: false })
    }

    /// What a struct becomes whose required fields alone are written.
    fn default_struct(
        &self,
        value: &dyn PartialReflect,
        registration: &TypeRegistration,
    ) -> Option<Box<dyn Reflect>> {
        let (TypeInfo::Struct(info), ReflectRef::Struct(fields)) =
            (registration.type_info(), value.reflect_ref())
        else {
            return None;
        };
        let required = required(info.iter(), |name| fields.field(name))?;
        registration.data::<ReflectFromReflect>()?.from_reflect(&required)
    }

    /// What a variant becomes whose required fields alone are written.
    fn default_variant(
        &self,
        holder: &dyn Enum,
        registration: &TypeRegistration,
    ) -> Option<Box<dyn Reflect>> {
        let TypeInfo::Enum(info) = registration.type_info() else { return None };
        let VariantInfo::Struct(variant) = info.variant(holder.variant_name())? else { return None };
        let required = required(variant.iter(), |name| holder.field(name))?;
        let least = DynamicEnum::new(variant.name(), DynamicVariant::Struct(required));
        registration.data::<ReflectFromReflect>()?.from_reflect(&least)
    }

    /// A value that serde writes in one go.
    fn leaf(
        &self,
        value: &dyn PartialReflect,
        registration: &TypeRegistration,
    ) -> Result<Written, WriteError> {
        if let Some(word) = word(value) {
            return Ok(Written::Word(word));
        }
        // Vectors, which are read as tuples, with the digits that single numbers have.
        if registration.type_info().type_path().starts_with("glam::")
            && let ReflectRef::Struct(fields) = value.reflect_ref()
            && let Some(numbers) =
                fields.iter_fields().map(|(_, field)| word(field)).collect::<Option<Vec<_>>>()
        {
            return Ok(Written::Word(format!("({})", numbers.join(", "))));
        }
        let serializer = TypedReflectSerializer::new(value, self.registry);
        let style =
            ron::ser::PrettyConfig::new().compact_arrays(true).compact_structs(true).compact_maps(true);
        let text = ron::ser::to_string_pretty(&serializer, style);
        text.map(Written::Word).map_err(|error| WriteError::Serialize {
            type_path: value.reflect_type_path().to_owned(),
            message: error.to_string(),
        })
    }
}

/// Whether a value is not `None`.
pub(super) fn is_there(value: &dyn PartialReflect) -> bool {
    match value.reflect_ref() {
        ReflectRef::Enum(holder) => holder.variant_name() != "None",
        _ => true,
    }
}

/// The fields that have no default.
fn required<'v, 'i>(
    known: impl Iterator<Item = &'i NamedField>,
    field: impl Fn(&str) -> Option<&'v dyn PartialReflect>,
) -> Option<DynamicStruct> {
    let mut required = DynamicStruct::default();
    for known in known.filter(|known| known.has_attribute::<Required>()) {
        let value = field(known.name())?.reflect_clone().ok()?;
        required.insert_boxed(known.name(), value.into_partial_reflect());
    }
    Some(required)
}

/// Numbers, truths and texts.
fn word(value: &dyn PartialReflect) -> Option<String> {
    macro_rules! whole {
        ($($number:ty),*) => {
            $(if let Some(number) = value.try_downcast_ref::<$number>() {
                return Some(number.to_string());
            })*
        };
    }
    whole!(bool, u8, u16, u32, u64, u128, usize, i8, i16, i32, i64, i128, isize);
    if let Some(number) = value.try_downcast_ref::<f32>() {
        return Some(shorter(format!("{number:?}"), format!("{number:e}")));
    }
    if let Some(number) = value.try_downcast_ref::<f64>() {
        return Some(shorter(format!("{number:?}"), format!("{number:e}")));
    }
    if let Some(path) = value.try_downcast_ref::<AssetPath>() {
        return Some(quoted(path.written()));
    }
    value.try_downcast_ref::<String>().map(|text| quoted(text))
}

/// A number's digits, or the form with an exponent where that is much shorter.
fn shorter(plain: String, exponent: String) -> String {
    if plain.len() > exponent.len() + 4 { exponent } else { plain }
}

/// Text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            '\t' => quoted.push_str("\\t"),
            _ if letter.is_control() => quoted.extend(letter.escape_unicode()),
            _ => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_their_bits() {
        let words = [
            (1.0, "1.0"),
            (-0.0, "-0.0"),
            (0.1, "0.1"),
            (16_777_216.0, "16777216.0"),
            (1e12, "1e12"),
            (1e-7, "1e-7"),
            (0.001, "0.001"),
            (f32::MAX, "3.4028235e38"),
            (f32::MIN_POSITIVE, "1.1754944e-38"),
            (1.0e-45, "1e-45"),
        ];
        for (number, expected) in words {
            let word = word(&number).unwrap();
            assert_eq!(word, expected);
            assert_eq!(ron::from_str::<f32>(&word).unwrap().to_bits(), number.to_bits());
        }
    }

    #[test]
    fn any_text_can_be_quoted() {
        for text in
            ["", "plain", "\"\\", "a\nb\r\tc", "\0\u{7f}\u{9b}", "ä 猫 🐈", "r#\"x\"#", "// no comment"]
        {
            assert_eq!(ron::from_str::<String>(&quoted(text)).unwrap(), text);
        }
    }
}
