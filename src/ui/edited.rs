//! What a person changed: a value of a component, by its path.

use crate::components::Untagged;
use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::enums::{Enum, VariantType};
use bevy_reflect::{PartialReflect, Reflect, ReflectMut, ReflectRef, TypeInfo};
use egui::{Id, Ui};

/// A value of a component that a person changed.
#[derive(Debug)]
pub struct Edited {
    /// Where the value stands in its component, as scenes write it: `projection.vertical_fov`, `points[2]`, `material.sigma_a`. Empty
    /// for the whole component.
    pub path: String,
    /// The new value, of the very type that stands there.
    pub value: Box<dyn Reflect>,
    /// Whether the change is complete. While a drag goes on it is not: all of it is one change, to be undone as one.
    pub finished: bool,
}

/// Why a value could not be put into a component.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditError {
    /// The component has nothing at this path.
    #[error(
        "there is no `{path}` in a `{component}`: `{step}` leads nowhere; the component may have changed since"
    )]
    NoSuchPath {
        /// The path.
        path: String,
        /// The part of it at which there is nothing.
        step: String,
        /// The type of the component.
        component: String,
    },
    /// What stands at the path is of another type.
    #[error("`{path}` holds a `{expected}`, and was given a `{found}`")]
    WrongType {
        /// The path.
        path: String,
        /// The type of what stands there.
        expected: String,
        /// The type of the new value.
        found: String,
    },
}

impl Edited {
    /// Puts the value into `component`.
    ///
    /// # Errors
    ///
    /// If there is nothing at the path, or something of another type.
    pub fn apply(&self, component: &mut dyn PartialReflect) -> Result<(), EditError> {
        put(component, &self.path, self.value.as_ref())
    }
}

/// Puts a value into a component.
pub(super) fn put(
    component: &mut dyn PartialReflect,
    path: &str,
    value: &dyn Reflect,
) -> Result<(), EditError> {
    let name = component.reflect_short_type_path().to_owned();
    let mut target = component;
    for step in steps(path) {
        target = match child(contents(target), step) {
            Some(child) => child,
            None => {
                return Err(EditError::NoSuchPath {
                    path: path.to_owned(),
                    step: step.to_owned(),
                    component: name,
                });
            }
        };
    }
    let wrong_type = EditError::WrongType {
        path: path.to_owned(),
        expected: target.reflect_short_type_path().to_owned(),
        found: value.reflect_short_type_path().to_owned(),
    };
    let copy = value.reflect_clone().ok();
    match (target.try_as_reflect_mut(), copy) {
        (Some(target), Some(copy)) => target.set(copy).map_err(|_| wrong_type),
        _ => target.try_apply(value.as_partial_reflect()).map_err(|_| wrong_type),
    }
}

/// What stands at a path of a component.
pub(super) fn get<'v>(component: &'v dyn PartialReflect, path: &str) -> Option<&'v dyn PartialReflect> {
    steps(path).try_fold(component, |value, step| match contents_of(value).reflect_ref() {
        ReflectRef::Struct(fields) => fields.field(step),
        ReflectRef::TupleStruct(fields) => fields.field(step.parse().ok()?),
        ReflectRef::Tuple(fields) => fields.field(step.parse().ok()?),
        ReflectRef::Enum(variant) => match variant.variant_type() {
            VariantType::Struct => variant.field(step),
            _ => variant.field_at(step.parse().ok()?),
        },
        ReflectRef::List(items) => items.get(step.parse().ok()?),
        ReflectRef::Array(items) => items.get(step.parse().ok()?),
        _ => None,
    })
}

/// The names and numbers of a path, one after the other.
fn steps(path: &str) -> impl Iterator<Item = &str> {
    path.split(['.', '[', ']']).filter(|step| !step.is_empty())
}

fn child<'v>(value: &'v mut dyn PartialReflect, step: &str) -> Option<&'v mut dyn PartialReflect> {
    match value.reflect_mut() {
        ReflectMut::Struct(fields) => fields.field_mut(step),
        ReflectMut::TupleStruct(fields) => fields.field_mut(step.parse().ok()?),
        ReflectMut::Tuple(fields) => fields.field_mut(step.parse().ok()?),
        ReflectMut::Enum(variant) => match variant.variant_type() {
            VariantType::Struct => variant.field_mut(step),
            _ => variant.field_at_mut(step.parse().ok()?),
        },
        ReflectMut::List(items) => items.get_mut(step.parse().ok()?),
        ReflectMut::Array(items) => items.get_mut(step.parse().ok()?),
        _ => None,
    }
}

/// Whether the enum is written without the names of its variants, so that paths do not count it as a step: `Option` and those marked
/// [`Untagged`].
pub(super) fn is_transparent(value: &dyn Enum) -> bool {
    let Some(TypeInfo::Enum(info)) = value.get_represented_type_info() else { return false };
    let attributes: &CustomAttributes = info.custom_attributes();
    attributes.contains::<Untagged>() || info.type_path_table().ident() == Some("Option")
}

fn holds_one_value(value: &dyn Enum) -> bool {
    value.variant_type() == VariantType::Tuple && value.field_len() == 1 && is_transparent(value)
}

fn contents_of(value: &dyn PartialReflect) -> &dyn PartialReflect {
    match value.reflect_ref() {
        ReflectRef::Enum(variant) if holds_one_value(variant) => {
            variant.field_at(0).map_or(value, |inner| contents_of(inner))
        }
        _ => value,
    }
}

fn contents(value: &mut dyn PartialReflect) -> &mut dyn PartialReflect {
    let is_wrapped = matches!(value.reflect_ref(), ReflectRef::Enum(variant) if holds_one_value(variant));
    if !is_wrapped {
        return value;
    }
    match value.reflect_mut() {
        ReflectMut::Enum(variant) => match variant.field_at_mut(0) {
            Some(inner) => contents(inner),
            None => unreachable!("a variant that holds one value has a first field"),
        },
        _ => unreachable!("it was an enum a moment ago"),
    }
}

/// Turns the changes of a widget into changes that are finished or not: those made while a button of the pointer is down belong to one
/// gesture, whose end is reported too. None where there is nothing to report.
pub(super) fn settle(ui: &Ui, id: Id, changed: bool) -> Option<bool> {
    let id = id.with("gesture");
    let is_down = ui.input(|input| input.pointer.any_down());
    let was_open = ui.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    let is_open = is_down && (was_open || changed);
    if is_open != was_open {
        ui.data_mut(|data| data.insert_temp(id, is_open));
    }
    match (changed, is_down) {
        (true, is_down) => Some(!is_down),
        (false, false) if was_open => Some(true),
        (false, _) => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::{Auto, Material, Specular, Subsurface, TransferFunction, ViewCamera};
    use glam::{Vec2, Vec3};

    fn edited(path: &str, value: impl Reflect) -> Edited {
        Edited { path: path.into(), value: Box::new(value), finished: true }
    }

    #[test]
    fn a_value_goes_where_its_path_leads() {
        let mut camera = ViewCamera::default();
        edited("projection.vertical_fov", 30.0_f32).apply(&mut camera).unwrap();
        assert_eq!(camera.projection, crate::components::Projection::Perspective { vertical_fov: 30.0 });
        let mut body = Subsurface {
            specular: Some(Specular::default()),
            material: Material::Preset("wax".into()),
            ..Default::default()
        };
        edited("specular.strength", 0.5_f32).apply(&mut body).unwrap();
        edited("material.0", String::from("marble")).apply(&mut body).unwrap();
        assert_eq!((body.specular.unwrap().strength, &body.material), (0.5, &Material::default()));
        edited("specular", None::<Specular>).apply(&mut body).unwrap();
        assert_eq!(body.specular, None);
        let mut function =
            TransferFunction { points: TransferFunction::default().points_in_force(), ..Default::default() };
        edited("points[1].1", Vec3::X).apply(&mut function).unwrap();
        edited("domain", Auto::Value(Vec2::Y)).apply(&mut function).unwrap();
        assert_eq!((function.points[1].1, function.domain), (Vec3::X, Auto::Value(Vec2::Y)));
        assert_eq!(get(&function, "points[1].1").unwrap().try_downcast_ref(), Some(&Vec3::X));
        edited("", TransferFunction::default()).apply(&mut function).unwrap();
        assert_eq!(function, TransferFunction::default());
    }

    #[test]
    fn a_list_becomes_shorter() {
        let mut function =
            TransferFunction { points: TransferFunction::default().points_in_force(), ..Default::default() };
        edited("points", vec![function.points[1]]).apply(&mut function).unwrap();
        assert_eq!(function.points.len(), 1);
    }

    #[test]
    fn what_cannot_be_put_anywhere_is_an_error() {
        let mut camera = ViewCamera::default();
        let nowhere = edited("projection.height", 1.0_f32).apply(&mut camera).unwrap_err();
        assert!(matches!(&nowhere, EditError::NoSuchPath { step, .. } if step == "height"), "{nowhere}");
        let wrong = edited("eye", 1.0_f32).apply(&mut camera).unwrap_err();
        assert_eq!(wrong.to_string(), "`eye` holds a `Vec3`, and was given a `f32`");
        assert_eq!(camera, ViewCamera::default());
    }
}
