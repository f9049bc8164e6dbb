//! The fields of components, by reflection: all that there are, and those in which two values differ.
//!
//! A field is named by the way to it, through variants, with `[]` for the elements of a list: `Mesh.Sphere.radius`. A variant, and the
//! length of a list, count as fields.

use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::enums::VariantInfo;
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeInfo, Typed};
use std::collections::{BTreeMap, BTreeSet};
use tyndall::prelude::{App, SceneSettings, TyndallPlugins};

/// Every field of the framework's components, and of the head of a scene.
pub fn of_scenes() -> BTreeSet<String> {
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let components = registry.iter().filter(|known| known.data::<ReflectComponent>().is_some());
    let own =
        components.map(|known| known.type_info()).filter(|info| info.type_path().starts_with("tyndall::"));
    let mut fields = BTreeSet::new();
    for info in own.chain([SceneSettings::type_info()]) {
        describe(info, info.type_path_table().short_path().to_owned(), &mut fields);
    }
    fields
}

/// What can be changed in a value of a type.
fn describe(info: &TypeInfo, path: String, fields: &mut BTreeSet<String>) {
    let mut inner = |info: Option<&'static TypeInfo>, path: String| match info {
        Some(info) => describe(info, path, fields),
        None => _ = fields.insert(path),
    };
    match info {
        _ if is_whole(info) => _ = fields.insert(path),
        TypeInfo::Struct(info) => {
            info.iter().for_each(|field| inner(field.type_info(), format!("{path}.{}", field.name())));
        }
        TypeInfo::TupleStruct(info) => {
            info.iter().for_each(|field| inner(field.type_info(), format!("{path}.{}", field.index())));
        }
        TypeInfo::List(info) => {
            inner(info.item_info(), format!("{path}[]"));
            fields.insert(format!("{path}[]"));
        }
        TypeInfo::Enum(info) => {
            for variant in info.iter() {
                let path = format!("{path}.{}", variant.name());
                match variant {
                    VariantInfo::Struct(variant) => variant
                        .iter()
                        .for_each(|field| inner(field.type_info(), format!("{path}.{}", field.name()))),
                    VariantInfo::Tuple(variant) => variant
                        .iter()
                        .for_each(|field| inner(field.type_info(), format!("{path}.{}", field.index()))),
                    VariantInfo::Unit(_) => {}
                }
                inner(None, path);
            }
        }
        _ => _ = fields.insert(path),
    }
}

/// A vector is one value.
fn is_whole(info: &TypeInfo) -> bool {
    info.type_path().starts_with("glam::")
}

/// The fields in which two values of a component differ. Of what only one of them has, its variant and the length of its lists.
pub fn differences(before: &dyn Reflect, after: &dyn Reflect) -> BTreeSet<String> {
    let [before, after] = [before, after].map(|value| {
        let mut found = Found::default();
        found.take(value.as_partial_reflect(), value.reflect_short_type_path().to_owned());
        found
    });
    let variants = before.variants.symmetric_difference(&after.variants).cloned();
    let has_changed = |(path, values): (&String, &Vec<String>)| {
        let others = after.values.get(path).filter(|others| others.len() == values.len())?;
        (others != values).then(|| path.clone())
    };
    variants.chain(before.values.iter().filter_map(has_changed)).collect()
}

/// What a value is made of.
#[derive(Default)]
struct Found {
    variants: BTreeSet<String>,
    values: BTreeMap<String, Vec<String>>,
}

impl Found {
    fn take(&mut self, value: &dyn PartialReflect, path: String) {
        if value.get_represented_type_info().is_some_and(is_whole) {
            return self.keep(path, format!("{value:?}"));
        }
        match value.reflect_ref() {
            ReflectRef::Struct(fields) => {
                fields.iter_fields().for_each(|(name, field)| self.take(field, format!("{path}.{name}")));
            }
            ReflectRef::TupleStruct(fields) => {
                fields
                    .iter_fields()
                    .enumerate()
                    .for_each(|(index, field)| self.take(field, format!("{path}.{index}")));
            }
            ReflectRef::List(list) => {
                self.keep(format!("{path}[]"), list.len().to_string());
                list.iter().for_each(|element| self.take(element, format!("{path}[]")));
            }
            ReflectRef::Enum(holder) => {
                let path = format!("{path}.{}", holder.variant_name());
                for (index, field) in holder.iter_fields().enumerate() {
                    let name = holder.name_at(index).map_or(index.to_string(), str::to_owned);
                    self.take(field.value(), format!("{path}.{name}"));
                }
                self.variants.insert(path);
            }
            _ => self.keep(path, format!("{value:?}")),
        }
    }

    fn keep(&mut self, path: String, value: String) {
        self.values.entry(path).or_default().push(value);
    }
}
