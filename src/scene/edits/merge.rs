//! Two changes of one value become one, where they do not meet.

use crate::scene::path;
use crate::scene::write::equal;
use bevy_reflect::enums::VariantType;
use bevy_reflect::{PartialReflect, ReflectDeserialize, ReflectRef, TypeRegistry};

/// What comes of a value that changed on two sides.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Merge {
    /// Paths at which our value is to be taken.
    pub taken: Vec<String>,
    /// Paths at which both sides have changed it, to different values.
    pub conflicts: Vec<String>,
}

/// Puts what is taken of `ours` into a copy of `theirs`. Whether all of it fits.
pub(super) fn take(
    merge: &Merge,
    ours: &dyn PartialReflect,
    theirs: &mut dyn PartialReflect,
    registry: &TypeRegistry,
) -> bool {
    merge.taken.iter().all(|at| match (path::get_mut(theirs, at), path::get(ours, at)) {
        (Some(target), Some(value)) => path::replace(target, value, registry),
        _ => false,
    })
}

/// What to do to `theirs`, so that it has what either side changed of `base`. Fields, tuples and lists of one length are looked into;
/// what is written as one word, as vectors are here, is not divided.
pub(super) fn merge(
    base: &dyn PartialReflect,
    ours: &dyn PartialReflect,
    theirs: &dyn PartialReflect,
    registry: &TypeRegistry,
) -> Merge {
    let mut merge = Merge::default();
    Merger { registry, merge: &mut merge }.value(String::new(), [base, ours, theirs]);
    merge
}

struct Merger<'m> {
    registry: &'m TypeRegistry,
    merge: &'m mut Merge,
}

impl Merger<'_> {
    fn value(&mut self, at: String, three: [&dyn PartialReflect; 3]) {
        let [base, ours, theirs] = three;
        if equal(ours, base, self.registry) || equal(ours, theirs, self.registry) {
        } else if equal(theirs, base, self.registry) {
            self.merge.taken.push(at);
        } else if let Some(fields) = self.divided(three) {
            for (step, three) in fields {
                self.value(format!("{at}{step}"), three);
            }
        } else {
            self.merge.conflicts.push(at);
        }
    }

    /// The parts of three values, each with the step that leads to it; none for what is one whole, or not the same kind three times.
    fn divided<'v>(
        &self,
        [base, ours, theirs]: [&'v dyn PartialReflect; 3],
    ) -> Option<Vec<(String, [&'v dyn PartialReflect; 3])>> {
        let info = base.get_represented_type_info()?;
        let registration = self.registry.get(info.type_id())?;
        if registration.data::<ReflectDeserialize>().is_some() {
            return None;
        }
        let numbered = |count, get: &dyn Fn(usize) -> Option<[&'v dyn PartialReflect; 3]>| {
            (0..count).map(|at| Some((format!(".{at}"), get(at)?))).collect()
        };
        match (base.reflect_ref(), ours.reflect_ref(), theirs.reflect_ref()) {
            (ReflectRef::Struct(b), ReflectRef::Struct(o), ReflectRef::Struct(t)) => (0..b.field_len())
                .map(|at| {
                    let name = b.name_at(at)?;
                    Some((format!(".{name}"), [b.field_at(at)?, o.field(name)?, t.field(name)?]))
                })
                .collect(),
            (ReflectRef::TupleStruct(b), ReflectRef::TupleStruct(o), ReflectRef::TupleStruct(t)) => {
                numbered(b.field_len(), &|at| Some([b.field(at)?, o.field(at)?, t.field(at)?]))
            }
            (ReflectRef::Tuple(b), ReflectRef::Tuple(o), ReflectRef::Tuple(t)) => {
                numbered(b.field_len(), &|at| Some([b.field(at)?, o.field(at)?, t.field(at)?]))
            }
            (ReflectRef::List(b), ReflectRef::List(o), ReflectRef::List(t)) => {
                let one_length = b.len() == o.len() && b.len() == t.len();
                let element = |at| Some((format!("[{at}]"), [b.get(at)?, o.get(at)?, t.get(at)?]));
                one_length.then(|| (0..b.len()).map(element).collect())?
            }
            (ReflectRef::Enum(b), ReflectRef::Enum(o), ReflectRef::Enum(t)) => {
                let is_one = b.variant_name() == o.variant_name() && b.variant_name() == t.variant_name();
                if !is_one || b.field_len() == 0 {
                    return None;
                }
                let through = [base, ours, theirs].map(path::passed_through);
                if let [Some(b), Some(o), Some(t)] = through {
                    return Some(vec![(String::new(), [b, o, t])]);
                }
                let all = |at| Some([b.field_at(at)?, o.field_at(at)?, t.field_at(at)?]);
                match b.variant_type() {
                    VariantType::Struct => (0..b.field_len())
                        .map(|at| Some((format!(".{}", b.name_at(at)?), all(at)?)))
                        .collect(),
                    _ => numbered(b.field_len(), &all),
                }
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{ControlPoint, Material, Specular, Subsurface, TransferFunction};
    use glam::Vec3;

    fn paths(
        base: &dyn PartialReflect,
        ours: &dyn PartialReflect,
        theirs: &dyn PartialReflect,
    ) -> [String; 2] {
        let mut registry = TypeRegistry::new();
        registry.register::<Subsurface>();
        registry.register::<TransferFunction>();
        let merge = merge(base, ours, theirs, &registry);
        // The whole has an empty path.
        [merge.taken, merge.conflicts].map(|paths| {
            let named: Vec<_> =
                paths.iter().map(|path| if path.is_empty() { "whole" } else { path }).collect();
            named.join(" ")
        })
    }

    #[test]
    fn fields_that_one_side_changed_are_taken_and_those_of_both_are_conflicts() {
        let base = Subsurface { specular: Some(Specular::default()), ..Subsurface::default() };
        let with = |strength, shininess, material: &str| Subsurface {
            specular: Some(Specular { strength, shininess }),
            material: Material::Preset(material.into()),
            ..base.clone()
        };
        let ours = with(0.5, 60.0, "wax");
        assert_eq!(paths(&base, &base, &ours), ["", ""]);
        assert_eq!(paths(&base, &ours, &ours), ["", ""]);
        assert_eq!(
            paths(&base, &with(0.5, 60.0, "marble"), &with(0.2, 9.0, "wax")),
            [".specular.strength", ""]
        );
        assert_eq!(paths(&base, &ours, &with(0.7, 60.0, "marble")), [".material", ".specular.strength"]);
        let none = Subsurface { specular: None, ..base.clone() };
        assert_eq!(paths(&base, &none, &with(0.2, 9.0, "marble")), ["", ".specular"]);
        let mut skin = base.clone();
        skin.local.diffuse.x = 0.5;
        let mut green = base.clone();
        green.local.diffuse.y = 0.25;
        assert_eq!(paths(&base, &skin, &green), ["", ".local.diffuse"], "a colour is one value");
    }

    #[test]
    fn lists_of_one_length_are_looked_into_and_others_are_one_whole() {
        let points = |opacities: &[f32]| TransferFunction {
            points: opacities.iter().map(|opacity| ControlPoint(0.5, Vec3::ONE, *opacity)).collect(),
            ..TransferFunction::default()
        };
        let base = points(&[0.1, 0.2]);
        assert_eq!(paths(&base, &points(&[0.3, 0.2]), &points(&[0.1, 0.4])), [".points[0]", ""]);
        assert_eq!(paths(&base, &points(&[0.3, 0.2]), &points(&[0.5, 0.4])), ["", ".points[0].2"]);
        assert_eq!(paths(&base, &points(&[0.1]), &points(&[0.1, 0.4])), ["", ".points"]);
        assert_eq!(paths(&base, &points(&[0.1]), &base), ["whole", ""]);
    }
}
