//! Values within a component by the paths that the reader of scenes gives them: `Mesh.radius`, `TransferFunction.points[2].1`.
//!
//! A path follows what is written: an optional value and an enum without names are passed through, since neither has a word of its own
//! for what it holds.

use crate::components::Untagged;
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, VariantInfo, VariantType};
use bevy_reflect::tuple::DynamicTuple;
use bevy_reflect::{
    PartialReflect, Reflect, ReflectFromReflect, ReflectMut, ReflectRef, TypeInfo, TypeRegistry,
};

/// One step of a path: a field by name or by number, or an element of a list.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step<'p> {
    Field(&'p str),
    Element(usize),
}

/// The name of the component that a path begins with, and the rest.
pub(super) fn component_of(path: &str) -> (&str, &str) {
    path.split_at(path.find(['.', '[']).unwrap_or(path.len()))
}

/// The steps of `.field.2[3]`; none where it is no path.
fn steps(path: &str) -> Option<Vec<Step<'_>>> {
    let mut rest = path;
    let mut steps = Vec::new();
    while !rest.is_empty() {
        let end = rest[1..].find(['.', '[']).map_or(rest.len(), |end| end + 1);
        let (step, after) = rest.split_at(end);
        steps.push(match step.strip_prefix('.') {
            Some("") => return None,
            Some(field) => Step::Field(field),
            None => Step::Element(step.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?),
        });
        rest = after;
    }
    Some(steps)
}

/// The value at `.field.2[3]` below `value`.
pub(super) fn get<'v>(value: &'v dyn PartialReflect, path: &str) -> Option<&'v dyn PartialReflect> {
    steps(path)?.into_iter().try_fold(value, step)
}

/// The same, to be changed.
pub(super) fn get_mut<'v>(
    value: &'v mut dyn PartialReflect,
    path: &str,
) -> Option<&'v mut dyn PartialReflect> {
    steps(path)?.into_iter().try_fold(value, step_mut)
}

fn step<'v>(value: &'v dyn PartialReflect, to: Step) -> Option<&'v dyn PartialReflect> {
    if let Some(inner) = passed_through(value) {
        return step(inner, to);
    }
    match (value.reflect_ref(), to) {
        (ReflectRef::Struct(fields), Step::Field(name)) => fields.field(name),
        (ReflectRef::TupleStruct(fields), Step::Field(number)) => fields.field(number.parse().ok()?),
        (ReflectRef::Tuple(fields), Step::Field(number)) => fields.field(number.parse().ok()?),
        (ReflectRef::Enum(fields), Step::Field(name)) => match fields.variant_type() {
            VariantType::Struct => fields.field(name),
            _ => fields.field_at(name.parse().ok()?),
        },
        (ReflectRef::List(list), Step::Element(index)) => list.get(index),
        _ => None,
    }
}

fn step_mut<'v>(value: &'v mut dyn PartialReflect, to: Step) -> Option<&'v mut dyn PartialReflect> {
    if passed_through(value).is_some() {
        let ReflectMut::Enum(holder) = value.reflect_mut() else { return None };
        return step_mut(holder.field_at_mut(0)?, to);
    }
    match (value.reflect_mut(), to) {
        (ReflectMut::Struct(fields), Step::Field(name)) => fields.field_mut(name),
        (ReflectMut::TupleStruct(fields), Step::Field(number)) => fields.field_mut(number.parse().ok()?),
        (ReflectMut::Tuple(fields), Step::Field(number)) => fields.field_mut(number.parse().ok()?),
        (ReflectMut::Enum(fields), Step::Field(name)) => match fields.variant_type() {
            VariantType::Struct => fields.field_mut(name),
            _ => fields.field_at_mut(name.parse().ok()?),
        },
        (ReflectMut::List(list), Step::Element(index)) => list.get_mut(index),
        _ => None,
    }
}

/// What an optional value, or one without the name of its variant, holds.
pub(super) fn passed_through(value: &dyn PartialReflect) -> Option<&dyn PartialReflect> {
    let ReflectRef::Enum(holder) = value.reflect_ref() else { return None };
    let is_holder = value.get_represented_type_info().is_some_and(is_passed_through);
    let holds_one = holder.variant_type() == VariantType::Tuple && holder.field_len() == 1;
    holder.field_at(0).filter(|_| is_holder && holds_one)
}

fn is_passed_through(info: &TypeInfo) -> bool {
    is_option(info) || matches!(info, TypeInfo::Enum(info) if info.has_attribute::<Untagged>())
}

/// Whether the type is an `Option`.
pub(super) fn is_option(info: &TypeInfo) -> bool {
    matches!(info, TypeInfo::Enum(info) if info.type_path().starts_with("core::option::Option<"))
}

/// Puts `new` in the place of `target`, whatever stands there. A value for an optional target, or for one without the names of its
/// variants, may be what it would hold.
///
/// Whether it could be done: `new` may be of another type.
pub(super) fn replace(
    target: &mut dyn PartialReflect,
    new: &dyn PartialReflect,
    registry: &TypeRegistry,
) -> bool {
    let Some(info) = target.get_represented_type_info() else { return false };
    let Some(whole) = as_type(info, new, registry) else { return false };
    target.try_as_reflect_mut().is_some_and(|target| target.set(whole).is_ok())
}

/// `value` as a value of the type.
pub(super) fn as_type(
    info: &TypeInfo,
    value: &dyn PartialReflect,
    registry: &TypeRegistry,
) -> Option<Box<dyn Reflect>> {
    let from_reflect = registry.get_type_data::<ReflectFromReflect>(info.type_id())?;
    match value.get_represented_type_info() {
        Some(own) if own.type_id() == info.type_id() => return from_reflect.from_reflect(value),
        None => {
            if let Some(whole) = from_reflect.from_reflect(value) {
                return Some(whole);
            }
        }
        // Fields are matched by name, so another type's would be taken for this one's with the rest left out.
        Some(_) => {}
    }
    let TypeInfo::Enum(holder) = info else { return None };
    if !is_passed_through(info) {
        return None;
    }
    holder.iter().find_map(|variant| {
        let VariantInfo::Tuple(tuple) = variant else { return None };
        let inner = as_type(tuple.field_at(0)?.type_info()?, value, registry)?;
        let mut fields = DynamicTuple::default();
        fields.insert_boxed(inner.into_partial_reflect());
        from_reflect.from_reflect(&DynamicEnum::new(variant.name(), DynamicVariant::Tuple(fields)))
    })
}

/// Whether two values are known to be equal.
pub(super) fn same(one: &dyn PartialReflect, other: &dyn PartialReflect) -> bool {
    one.reflect_partial_eq(other) == Some(true)
}

/// A copy of a value of a scene; none where its type can be copied in no way.
pub(super) fn copy(value: &dyn Reflect, registry: &TypeRegistry) -> Option<Box<dyn Reflect>> {
    value.reflect_clone().ok().or_else(|| {
        let dynamic = value.to_dynamic().ok()?;
        as_type(value.get_represented_type_info()?, dynamic.as_ref(), registry)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{Auto, Specular, Subsurface, TransferFunction};
    use glam::Vec2;

    #[test]
    fn a_path_is_taken_apart_or_refused() {
        let all = [Step::Field("a"), Step::Field("2"), Step::Element(3), Step::Field("b")];
        assert_eq!(steps(".a.2[3].b"), Some(all.to_vec()));
        assert_eq!(steps(""), Some(vec![]));
        for wrong in ["a", ".", "..a", ".a[", ".a[]", ".a[-1]", ".a[1", ".ä[1]x", "[99999999999999999999]"] {
            assert_eq!(steps(wrong), None, "{wrong}");
        }
        assert_eq!(component_of("A.b[2]"), ("A", ".b[2]"));
    }

    #[test]
    fn what_may_be_absent_is_passed_through_and_filled() {
        let mut registry = TypeRegistry::new();
        registry.register::<Subsurface>();
        registry.register::<TransferFunction>();
        let mut skin = Subsurface { specular: Some(Specular::default()), ..Subsurface::default() };
        let strength = get_mut(&mut skin, ".specular.strength").unwrap();
        assert!(replace(strength, &0.5_f32, &registry));
        assert!(!replace(strength, &0.5_f64, &registry), "another type");
        assert_eq!(skin.specular.unwrap().strength, 0.5);
        let specular = get_mut(&mut skin, ".specular").unwrap();
        assert!(replace(specular, &None::<Specular>, &registry));
        assert!(get(&skin, ".specular.strength").is_none());
        let specular = get_mut(&mut skin, ".specular").unwrap();
        assert!(replace(specular, &Specular::default(), &registry), "the bare value");
        assert_eq!(skin.specular, Some(Specular::default()));
        let mut function = TransferFunction::default();
        assert!(replace(get_mut(&mut function, ".domain").unwrap(), &Vec2::Y, &registry));
        assert_eq!(function.domain, Auto::Value(Vec2::Y));
        assert!(get(&function, ".domain.x").is_some() && get(&function, ".points[0]").is_none());
    }
}
