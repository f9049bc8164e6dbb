//! Values that are shown in one piece: numbers, vectors, colours, texts, paths, switches.

use super::field::Field;
use crate::components::{AssetPath, Range};
use bevy_reflect::structs::Struct;
use bevy_reflect::{PartialReflect, Reflect, ReflectFromReflect, ReflectRef, TypeInfo, TypeRegistry};

/// A value that is shown in one piece.
pub(super) enum Leaf<'v> {
    Switch(bool),
    Number(Number),
    /// Numbers by name, at most four.
    Vector(Vec<(&'v str, Number)>),
    Text(&'v str),
    Path(&'v AssetPath),
    /// What can only be shown and typed as it stands in a scene.
    Written,
}

/// A number of some primitive type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    pub value: f64,
    pub is_whole: bool,
    /// What the type can hold.
    pub limits: Range,
    convert: fn(f64) -> Box<dyn Reflect>,
}

macro_rules! numbers {
    ($value:expr; $($ty:ty: $is_whole:expr),* $(,)?) => {
        $(if let Some(value) = $value.try_downcast_ref::<$ty>() {
            return Some(Number {
                value: *value as f64,
                is_whole: $is_whole,
                limits: Range::new(<$ty>::MIN as f64, <$ty>::MAX as f64),
                convert: |number| Box::new(number as $ty),
            });
        })*
    };
}

impl Number {
    pub fn of(value: &dyn PartialReflect) -> Option<Self> {
        numbers!(value;
            f32: false, f64: false, u32: true, i32: true, u64: true, i64: true,
            u16: true, i16: true, u8: true, i8: true, usize: true, isize: true,
        );
        None
    }

    /// Another number of the same type.
    pub fn boxed(&self, value: f64) -> Box<dyn Reflect> {
        (self.convert)(value)
    }

    /// What both the type and the field allow.
    pub fn range(&self, field: &Field) -> Range {
        let Some(range) = field.range() else { return self.limits };
        Range { min: range.min.max(self.limits.min), max: range.max.min(self.limits.max), ..range }
    }
}

impl<'v> Leaf<'v> {
    /// The value as a leaf, unless it is one that has others inside.
    pub fn of(value: &'v dyn PartialReflect) -> Option<Self> {
        if let Some(number) = Number::of(value) {
            return Some(Self::Number(number));
        }
        if let Some(switch) = value.try_downcast_ref::<bool>() {
            return Some(Self::Switch(*switch));
        }
        if let Some(text) = value.try_downcast_ref::<String>() {
            return Some(Self::Text(text));
        }
        if let Some(path) = value.try_downcast_ref::<AssetPath>() {
            return Some(Self::Path(path));
        }
        match value.reflect_ref() {
            ReflectRef::Struct(fields) => vector(fields).map(Self::Vector),
            ReflectRef::TupleStruct(_) | ReflectRef::Tuple(_) | ReflectRef::List(_) | ReflectRef::Enum(_) => {
                None
            }
            ReflectRef::Array(_) => None,
            _ => Some(Self::Written),
        }
    }
}

/// Two to four numbers whose names are letters: the vectors of glam and those like them.
fn vector(fields: &dyn Struct) -> Option<Vec<(&str, Number)>> {
    let is_small = (2..=4).contains(&fields.field_len());
    let parts = (0..fields.field_len().min(5)).map(|index| {
        let name = fields.name_at(index).filter(|name| name.len() == 1)?;
        Some((name, Number::of(fields.field_at(index)?)?))
    });
    parts.collect::<Option<Vec<_>>>().filter(|_| is_small)
}

/// A vector with one of its parts exchanged for each of `parts`, by name.
pub(super) fn with_parts(
    vector: &dyn PartialReflect,
    parts: Vec<(&str, Box<dyn Reflect>)>,
    registry: &TypeRegistry,
) -> Option<Box<dyn Reflect>> {
    let ReflectRef::Struct(fields) = vector.reflect_ref() else { return None };
    let mut changed = fields.to_dynamic_struct().ok()?;
    for (name, part) in parts {
        changed.insert_boxed(name.to_owned(), part.into_partial_reflect());
    }
    whole(&changed, vector.get_represented_type_info()?, registry)
}

/// A value of the very type, made of what stands for it.
pub(super) fn whole(
    value: &dyn PartialReflect,
    info: &TypeInfo,
    registry: &TypeRegistry,
) -> Option<Box<dyn Reflect>> {
    registry.get_type_data::<ReflectFromReflect>(info.type_id())?.from_reflect(value)
}

/// A copy of a value, of the very type.
pub(super) fn copy(value: &dyn PartialReflect, registry: &TypeRegistry) -> Option<Box<dyn Reflect>> {
    value.reflect_clone().ok().or_else(|| whole(value, value.get_represented_type_info()?, registry))
}
