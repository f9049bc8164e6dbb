//! What can be written in a component: its fields, variants, and the types in them, as reflection knows them.

use super::markdown::{laid_out, wrapped};
use crate::components::{AssetPath, Names, Range, Required, Unit, Untagged};
use crate::scene;
use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, EnumInfo, VariantInfo};
use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::{
    PartialReflect, Reflect, ReflectDeserialize, ReflectFromReflect, ReflectRef, TypeInfo, TypeRegistration,
    TypeRegistry,
};
use std::any::TypeId;

/// Lists what can be written in a type, and in the types of its fields.
pub(super) struct Listing<'r> {
    registry: &'r TypeRegistry,
    width: usize,
    /// Types that are told of in a part of their own, the first of them the one that is asked for.
    types: Vec<TypeId>,
}

/// A field as it is told of.
struct Field<'a> {
    name: String,
    ty: TypeId,
    docs: Option<&'a str>,
    attributes: &'a CustomAttributes,
    default: Option<&'a dyn PartialReflect>,
}

impl<'r> Listing<'r> {
    pub fn new(registry: &'r TypeRegistry, width: usize) -> Self {
        Self { registry, width, types: Vec::new() }
    }

    /// A part for the type and one for each type in it that has fields or variants of its own.
    pub fn parts(mut self, of: &TypeRegistration) -> Vec<String> {
        self.types.push(of.type_id());
        let mut parts = Vec::new();
        let mut next = 0;
        while let Some(ty) = self.types.get(next) {
            next += 1;
            let Some(registration) = self.registry.get(*ty) else { continue };
            let body = self.part(registration);
            if !body.is_empty() {
                let name = registration.type_info().type_path_table().short_path();
                let what = match registration.type_info() {
                    TypeInfo::Enum(_) => "is one of",
                    _ => "has the fields",
                };
                parts.push(format!("{name} {what}\n{}", body.join("\n")));
            }
        }
        parts
    }

    fn part(&mut self, registration: &TypeRegistration) -> Vec<String> {
        let default = registration.data::<ReflectDefault>().map(|data| data.default());
        match registration.type_info() {
            TypeInfo::Struct(info) => {
                let default = default.as_deref().map(PartialReflect::reflect_ref);
                let fields = info.iter().enumerate().map(|(index, field)| Field {
                    name: field.name().into(),
                    ty: field.type_id(),
                    docs: field.docs(),
                    attributes: field.custom_attributes(),
                    default: match &default {
                        Some(ReflectRef::Struct(fields)) => fields.field_at(index),
                        _ => None,
                    },
                });
                fields.map(|field| self.field(&field, 2)).collect()
            }
            TypeInfo::TupleStruct(info) => {
                let fields = info.iter().map(|field| Field {
                    name: format!("{}.", field.index() + 1),
                    ty: field.type_id(),
                    docs: field.docs(),
                    attributes: field.custom_attributes(),
                    default: None,
                });
                fields.map(|field| self.field(&field, 2)).collect()
            }
            TypeInfo::Enum(info) => {
                info.iter().flat_map(|variant| self.variant(info, variant, registration)).collect()
            }
            _ => Vec::new(),
        }
    }

    /// A variant, and its fields below it.
    fn variant(
        &mut self,
        of: &EnumInfo,
        variant: &VariantInfo,
        registration: &TypeRegistration,
    ) -> Vec<String> {
        let whole = self.with_defaults(variant, registration);
        let default = whole.as_deref().map(PartialReflect::reflect_ref);
        let default_at = |index| match &default {
            Some(ReflectRef::Enum(value)) => value.field_at(index),
            _ => None,
        };
        let (head, fields): (String, Vec<Field>) = match variant {
            VariantInfo::Unit(_) => (variant.name().into(), Vec::new()),
            VariantInfo::Tuple(info) => {
                let types: Vec<String> =
                    info.iter().map(|field| self.kind(field.type_id(), field.custom_attributes())).collect();
                let types = types.join(", ");
                let head = if of.has_attribute::<Untagged>() {
                    types
                } else {
                    format!("{}({types})", variant.name())
                };
                (head, Vec::new())
            }
            VariantInfo::Struct(info) => {
                let fields = info.iter().enumerate().map(|(index, field)| Field {
                    name: field.name().into(),
                    ty: field.type_id(),
                    docs: field.docs(),
                    attributes: field.custom_attributes(),
                    default: default_at(index),
                });
                (format!("{}(…)", variant.name()), fields.collect())
            }
        };
        let mut lines = vec![self.entry(&head, variant.docs().unwrap_or_default(), &[], 2)];
        lines.extend(fields.iter().map(|field| self.field(field, 6)));
        lines
    }

    fn field(&mut self, field: &Field, indent: usize) -> String {
        let kind = self.kind(field.ty, field.attributes);
        let mut facts: Vec<String> = Vec::new();
        facts.extend(field.attributes.get::<Unit>().map(|unit| unit.0.to_owned()));
        facts.extend(field.attributes.get::<Range>().map(Range::to_string));
        if field.attributes.contains::<Required>() {
            facts.push("must be written".into());
        } else {
            let default = field.default.and_then(|value| scene::in_full(value, self.registry).ok());
            facts.extend(default.map(|text| format!("default {text}")));
        }
        self.entry(
            &format!("{} {kind}", with_colon(&field.name)),
            field.docs.unwrap_or_default(),
            &facts,
            indent,
        )
    }

    /// A head, and below it what it means.
    fn entry(&self, head: &str, docs: &str, facts: &[String], indent: usize) -> String {
        let blank = |more: usize| " ".repeat(indent + more);
        let mut text = wrapped(head, self.width, &blank(0), &blank(8));
        let docs = laid_out(docs, self.width.saturating_sub(indent + 4));
        for line in docs.lines() {
            text += &format!("\n{}{line}", blank(4));
        }
        if !facts.is_empty() {
            text += &format!("\n{}", wrapped(&facts.join("; "), self.width, &blank(4), &blank(4)));
        }
        // Blank lines between paragraphs have no end.
        text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
    }

    /// How values of a type are written, in short. A type with fields or variants goes by its name, and is told of later.
    fn kind(&mut self, ty: TypeId, attributes: &CustomAttributes) -> String {
        let Some(registration) = self.registry.get(ty) else { return "a value".into() };
        let info = registration.type_info();
        if let Some(names) = attributes.get::<Names>() {
            return format!(
                "one of {}",
                names.known.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
            );
        }
        match info {
            TypeInfo::Enum(of) if is_transparent(of) => {
                let each: Vec<String> = of
                    .iter()
                    .map(|variant| match variant {
                        VariantInfo::Tuple(inner) if inner.field_len() == 1 => {
                            inner.field_at(0).map_or_else(String::new, |field| {
                                self.kind(field.type_id(), field.custom_attributes())
                            })
                        }
                        other => other.name().to_owned(),
                    })
                    .collect();
                each.join(" or ")
            }
            _ if ty == TypeId::of::<AssetPath>() => "path in quotes".into(),
            _ if registration.data::<ReflectDeserialize>().is_some() => scene::wanted_in_short(registration),
            TypeInfo::List(list) => format!("[{}, …]", self.kind(list.item_ty().id(), attributes)),
            TypeInfo::Array(array) => {
                format!("({}, …), {} of them", self.kind(array.item_ty().id(), attributes), array.capacity())
            }
            TypeInfo::Tuple(tuple) => {
                let each: Vec<String> =
                    tuple.iter().map(|field| self.kind(field.type_id(), attributes)).collect();
                format!("({})", each.join(", "))
            }
            TypeInfo::Struct(_) | TypeInfo::TupleStruct(_) | TypeInfo::Enum(_) => {
                if !self.types.contains(&ty) {
                    self.types.push(ty);
                }
                info.type_path_table().short_path().to_owned()
            }
            _ => scene::wanted_in_short(registration),
        }
    }

    /// A variant with the defaults of its fields, where they have some.
    fn with_defaults(
        &self,
        variant: &VariantInfo,
        registration: &TypeRegistration,
    ) -> Option<Box<dyn Reflect>> {
        let VariantInfo::Struct(info) = variant else { return None };
        let mut fields = DynamicStruct::default();
        for field in info.iter().filter(|field| field.has_attribute::<Required>()) {
            let default = self.registry.get_type_data::<ReflectDefault>(field.type_id())?.default();
            fields.insert_boxed(field.name(), default.into_partial_reflect());
        }
        let value = DynamicEnum::new(variant.name(), DynamicVariant::Struct(fields));
        registration.data::<ReflectFromReflect>()?.from_reflect(&value)
    }
}

/// Whether the values inside are written without the name of the variant.
fn is_transparent(info: &EnumInfo) -> bool {
    info.has_attribute::<Untagged>() || info.type_path_table().ident() == Some("Option")
}

/// Fields without names have a number instead.
fn with_colon(name: &str) -> String {
    if name.ends_with('.') { name.into() } else { format!("{name}:") }
}
