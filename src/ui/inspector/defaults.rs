//! Values to begin with: of types, and of the variants of enums.

use super::field::Field;
use super::leaf::{Leaf, Number, copy, whole, with_parts};
use crate::components::{ReflectChooseVariant, Required};
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, EnumInfo, VariantInfo};
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::tuple::DynamicTuple;
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeInfo, TypeRegistry, std_traits::ReflectDefault};
use std::any::TypeId;

/// A type's own default.
pub(super) fn of_type(ty: TypeId, registry: &TypeRegistry) -> Option<Box<dyn Reflect>> {
    registry.get_type_data::<ReflectDefault>(ty).map(|data| data.default())
}

/// A value for a field to begin with: the default of its type, made to fit what the field allows.
pub(super) fn of_field(ty: TypeId, field: &Field, registry: &TypeRegistry) -> Option<Box<dyn Reflect>> {
    let value = of_type(ty, registry)?;
    if value.downcast_ref::<String>().is_some()
        && let Some(first) = field.names().and_then(|names| names.known.first())
    {
        return Some(Box::new((*first).to_owned()));
    }
    let Some(range) = field.range() else { return Some(value) };
    let fit = |number: Number| {
        let low = if range.above_min { range.min + 1.0 } else { range.min };
        number.boxed(if range.contains(number.value) {
            number.value
        } else {
            low.clamp(range.min, range.max)
        })
    };
    if let Some(number) = Number::of(value.as_partial_reflect()) {
        return Some(fit(number));
    }
    if let Some(Leaf::Vector(numbers)) = Leaf::of(value.as_partial_reflect()) {
        let parts = numbers.into_iter().map(|(name, number)| (name, fit(number))).collect();
        return with_parts(value.as_partial_reflect(), parts, registry);
    }
    Some(value)
}

/// `value` with `variant` chosen in place of the one that it has: what the type itself makes of it, or the variant's defaults.
pub(super) fn of_variant(
    value: &dyn PartialReflect,
    info: &'static EnumInfo,
    variant: &'static VariantInfo,
    field: &Field,
    registry: &TypeRegistry,
) -> Option<Box<dyn Reflect>> {
    let own = || {
        let choose = registry.get_type_data::<ReflectChooseVariant>(info.type_id())?;
        let value = copy(value, registry)?;
        choose.get(value.as_ref())?.chosen(variant.name())
    };
    own().or_else(|| variant_default(info, variant, field, registry))
}

/// A variant with its defaults.
pub(super) fn variant_default(
    info: &'static EnumInfo,
    variant: &'static VariantInfo,
    field: &Field,
    registry: &TypeRegistry,
) -> Option<Box<dyn Reflect>> {
    // The default of the type knows best.
    if let Some(default) = of_type(info.type_id(), registry)
        && let ReflectRef::Enum(value) = default.reflect_ref()
        && value.variant_name() == variant.name()
    {
        return Some(default);
    }
    // Then those that the fields of the variant declare, which are applied where nothing stands; then those of their types.
    [Filled::None, Filled::Required, Filled::All].into_iter().find_map(|filled| {
        whole(&with_fields(variant, filled, field, registry)?, type_info(info, registry)?, registry)
    })
}

/// Which fields are given the default of their type.
#[derive(Clone, Copy, PartialEq)]
enum Filled {
    None,
    Required,
    All,
}

fn with_fields(
    variant: &'static VariantInfo,
    filled: Filled,
    around: &Field,
    registry: &TypeRegistry,
) -> Option<DynamicEnum> {
    let payload = match variant {
        VariantInfo::Unit(_) => DynamicVariant::Unit,
        VariantInfo::Struct(info) => {
            let mut fields = DynamicStruct::default();
            for named in info.iter() {
                if filled == Filled::All || filled == Filled::Required && named.has_attribute::<Required>() {
                    let value = of_field(named.type_id(), &Field::named(named), registry)?;
                    fields.insert_boxed(named.name(), value.into_partial_reflect());
                }
            }
            DynamicVariant::Struct(fields)
        }
        // Fields without names have no default of their own.
        VariantInfo::Tuple(info) => {
            let mut fields = DynamicTuple::default();
            for unnamed in info.iter() {
                let value = of_field(unnamed.type_id(), &around.inside(unnamed), registry)?;
                fields.insert_boxed(value.into_partial_reflect());
            }
            DynamicVariant::Tuple(fields)
        }
    };
    Some(DynamicEnum::new(variant.name(), payload))
}

fn type_info(info: &EnumInfo, registry: &TypeRegistry) -> Option<&'static TypeInfo> {
    registry.get(info.type_id()).map(|registration| registration.type_info())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::{Auto, Material, Mesh, Projection, SampleRadius, Volume};
    use bevy_reflect::{GetTypeRegistration, Typed};
    use glam::{UVec3, Vec3};

    fn chosen<T: Reflect + Typed + GetTypeRegistration>(value: T, variant: &str) -> T {
        let mut registry = TypeRegistry::new();
        registry.register::<T>();
        registry.register::<Vec3>();
        let info = T::type_info().as_enum().unwrap();
        let variant = info.variant(variant).unwrap();
        of_variant(&value, info, variant, &Field::default(), &registry).unwrap().take::<T>().unwrap()
    }

    #[test]
    fn variants_begin_with_their_defaults() {
        assert_eq!(chosen(Projection::default(), "Orthographic"), Projection::Orthographic { height: 2.0 });
        assert_eq!(chosen(Mesh::CornellBox, "Box"), Mesh::Box { size: Vec3::ONE });
        assert_eq!(chosen(Mesh::CornellBox, "File"), Mesh::file(""));
        assert_eq!(chosen(Auto::<u32>::Auto, "Value"), Auto::Value(0));
        // A radius must be above 0.
        assert!(matches!(chosen(SampleRadius::Auto, "Millimetres"), SampleRadius::Millimetres(r) if r > 0.0));
        let raw = chosen(Volume::file(""), "Raw");
        assert!(matches!(raw, Volume::Raw { size: UVec3::ONE, spacing: Vec3::ONE, .. }), "{raw:?}");
    }

    #[test]
    fn a_medium_keeps_its_coefficients() {
        let Material::Custom { sigma_s: Some(sigma_s), sigma_t: None, .. } =
            chosen(Material::Preset("marble".into()), "Custom")
        else {
            panic!("marble has coefficients");
        };
        assert!(sigma_s.min_element() > 0.0);
        let unknown = chosen(Material::Preset("nothing".into()), "Custom");
        assert!(matches!(unknown, Material::Custom { sigma_s: None, .. }));
    }
}
