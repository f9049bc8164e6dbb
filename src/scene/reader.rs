//! RON parts become reflected values, by the types that the registry knows.

use super::names::{Known, nearest, suggestion};
use super::numbers;
use super::parts::{Misfit, Named, Part, Payload, Shape};
use super::problem::{Place, Problem, SourceFile};
use super::wanted::{excerpt, how_to_write, is_led, is_plain, shorthand, too_large, wanted};
use crate::components::{AssetPath, Names, Range, ReflectValidate, Required, Untagged};
use crate::plain::piece;
use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, EnumInfo, VariantInfo};
use bevy_reflect::list::DynamicList;
use bevy_reflect::serde::TypedReflectDeserializer;
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::tuple::DynamicTuple;
use bevy_reflect::tuple_struct::DynamicTupleStruct;
use bevy_reflect::{
    NamedField, PartialReflect, Reflect, ReflectDeserialize, ReflectFromReflect, TypeInfo, TypeRegistration,
    TypeRegistry,
};
use std::any::TypeId;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Reads the parts of one file. Problems and the places of values gather in it.
pub(super) struct Reader<'r> {
    pub registry: &'r TypeRegistry,
    pub file: Arc<SourceFile>,
    /// Every problem met so far.
    pub problems: Vec<Problem>,
    /// Where each value stands, by its path from the entity: `Mesh.radius`.
    pub places: Vec<(String, Place)>,
    /// Path of the value being read.
    path: String,
    /// How many values may still be read.
    left: usize,
}

/// Problems that are kept of a file. Nobody reads as many, and memory has an end.
const MOST_PROBLEMS: usize = 100_000;

/// Values that a file may hold: each takes many times the memory of its text.
const MOST_VALUES: usize = 1_000_000;

/// What a field allows, by its attributes, of the numbers and texts in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Allowed<'a> {
    range: Option<&'a Range>,
    names: Option<&'a Names>,
}

impl<'a> Allowed<'a> {
    pub fn by(attributes: &'a CustomAttributes) -> Self {
        Self { range: attributes.get(), names: attributes.get() }
    }

    fn or(self, other: Self) -> Self {
        Self { range: self.range.or(other.range), names: self.names.or(other.names) }
    }
}

/// A value that was read, unless a problem was reported in its stead.
type Value = Option<Box<dyn PartialReflect>>;

impl<'r> Reader<'r> {
    pub fn new(registry: &'r TypeRegistry, file: Arc<SourceFile>) -> Self {
        Self {
            registry,
            file,
            problems: Vec::new(),
            places: Vec::new(),
            path: String::new(),
            left: MOST_VALUES,
        }
    }

    pub fn place(&self, part: &Part) -> Place {
        Place { file: self.file.clone(), bytes: part.bytes() }
    }

    pub fn report(&mut self, part: &Part, problem: Problem) {
        let place = self.place(part);
        self.keep(problem.at(place));
    }

    fn keep(&mut self, problem: Problem) {
        match self.problems.len() {
            0..MOST_PROBLEMS => self.problems.push(problem),
            MOST_PROBLEMS => {
                let message = format!("{MOST_PROBLEMS} problems were found so far; more are not told");
                self.problems.push(Problem { message, help: None, ..problem });
            }
            _ => {}
        }
    }

    pub fn report_misfit(&mut self, misfit: Misfit) {
        let place = |bytes| Place { file: self.file.clone(), bytes };
        let other = misfit.other.map(|(bytes, label)| (place(bytes), label));
        let problem = Problem { help: misfit.help, other, ..Problem::error(misfit.message) };
        let problem = problem.at(place(misfit.bytes));
        self.keep(problem);
    }

    /// What has another shape than `expected`.
    pub fn report_shape(&mut self, part: &Part, misfit: Misfit, expected: &str) {
        if misfit.bytes.start == part.bytes().start && !misfit.is_bracket {
            let found = excerpt(part.text);
            self.report(part, Problem::error(format!("expected {expected}, found `{found}`")));
        } else {
            self.report_misfit(misfit);
        }
    }

    /// Reads a whole component or other registered type, complete with the defaults of what is not written.
    pub fn complete(
        &mut self,
        part: &Part,
        registration: &TypeRegistration,
        name: &str,
    ) -> Option<Box<dyn Reflect>> {
        self.path = name.to_owned();
        let before = self.problems.len();
        let value = self.value(part, registration, Allowed::default())?;
        if self.problems.len() > before {
            return None;
        }
        let whole =
            registration.data::<ReflectFromReflect>().and_then(|data| data.from_reflect(value.as_ref()));
        if whole.is_none() {
            let problem =
                Problem::error(format!("`{name}` is not complete: a field without a default is missing"));
            self.report(part, problem);
        }
        whole
    }

    /// Reads a value that stands at `path`.
    pub fn value_at(
        &mut self,
        path: &str,
        part: &Part,
        registration: &TypeRegistration,
        allowed: Allowed,
    ) -> Value {
        let before = self.problems.len();
        self.path = path.to_owned();
        self.value(part, registration, allowed).filter(|_| self.problems.len() == before)
    }

    /// Reads one value of a registered type. `allowed` is what the field that it stands in allows.
    pub fn value(&mut self, part: &Part, registration: &TypeRegistration, allowed: Allowed) -> Value {
        if self.left <= 1 {
            if self.left == 1 {
                self.left = 0;
                let problem = Problem::error(format!("the file holds more than {MOST_VALUES} values"));
                let problem = problem.label("one too many");
                self.report(part, problem.help("what is that large belongs in a mesh or a volume"));
            }
            return None;
        }
        self.left -= 1;
        let first = self.places.len();
        self.places.push((self.path.clone(), self.place(part)));
        let before = self.problems.len();
        let value = match registration.type_info() {
            _ if registration.data::<ReflectDeserialize>().is_some() => {
                self.leaf(part, registration, allowed)
            }
            TypeInfo::Struct(info) => {
                let (led, fields) =
                    match self.shaped(part, part.struct_payload(shorthand(info)), "`(field: value, …)`")? {
                        Payload::Led(first) => (Some(first), Vec::new()),
                        Payload::Fields(fields) => (None, fields),
                        _ => (None, Vec::new()),
                    };
                let known: Vec<_> = info.iter().collect();
                let read = self.fields(
                    part,
                    led,
                    fields,
                    &known,
                    registration.type_info().type_path_table().short_path(),
                );
                Some(Box::new(represent(read, registration.type_info())) as Box<dyn PartialReflect>)
            }
            TypeInfo::TupleStruct(info) => {
                let types: Vec<_> = info
                    .iter()
                    .map(|field| (field.type_id(), Allowed::by(field.custom_attributes())))
                    .collect();
                self.tuple(part, &types).map(|values| {
                    let mut tuple = DynamicTupleStruct::default();
                    values.into_iter().for_each(|value| tuple.insert_boxed(value));
                    tuple.set_represented_type(Some(registration.type_info()));
                    Box::new(tuple) as Box<dyn PartialReflect>
                })
            }
            TypeInfo::Tuple(info) => {
                let types: Vec<_> = info.iter().map(|field| (field.type_id(), allowed)).collect();
                self.tuple(part, &types).map(|values| {
                    let mut tuple = DynamicTuple::default();
                    values.into_iter().for_each(|value| tuple.insert_boxed(value));
                    Box::new(tuple) as Box<dyn PartialReflect>
                })
            }
            TypeInfo::List(info) => self.list(part, info.item_ty().id(), allowed),
            TypeInfo::Enum(info) => self.enumeration(part, info, registration, allowed),
            _ => self.leaf(part, registration, allowed),
        };
        if self.problems.len() == before {
            self.validate(part, registration, value.as_deref(), first);
        }
        value
    }

    /// A value that serde reads in one go: numbers, text, vectors, types with a format of their own.
    fn leaf(&mut self, part: &Part, registration: &TypeRegistration, allowed: Allowed) -> Value {
        let seed = TypedReflectDeserializer::new(registration, self.registry);
        let mut value = match part.read(seed) {
            Ok(value) => value,
            Err(misfit) => {
                let problem = Problem::error(format!(
                    "expected {}, found `{}`",
                    wanted(registration),
                    excerpt(part.text)
                ));
                let help = match is_plain(registration) {
                    true => too_large(registration, part.text),
                    false => Some(misfit.message),
                };
                self.report(part, Problem { help, ..problem });
                return None;
            }
        };
        if let Some(path) = value.try_downcast_mut::<AssetPath>() {
            path.resolve(self.file.path().parent().unwrap_or(Path::new("")));
        }
        if let Some(refused) = numbers::refused(value.as_ref(), allowed.range) {
            // What does not fit into 32 bits reads as infinite; the text says what was meant.
            let found = refused.digits.unwrap_or_else(|| excerpt(part.text));
            let message = format!("{} must be {}, found `{found}`", self.name(), refused.wanted);
            self.report(part, Problem::error(message).label("out of range"));
            return None;
        }
        if let Some(names) = allowed.names
            && let Some(name) = value.try_downcast_ref::<String>()
            && !names.contains(name)
        {
            let known = format!("known here: {}", names.known.join(", "));
            let help = nearest(name, names.known.iter().copied())
                .map_or(known.clone(), |near| format!("did you mean `{near}`? {known}"));
            let name = piece(name);
            let problem = Problem::error(format!("there is no {} `{name}`", names.of)).label("unknown name");
            self.report(part, problem.help(help));
            return None;
        }
        Some(value)
    }

    /// Fields by their names; `led` is the first of them, if it stands in front without its name.
    fn fields(
        &mut self,
        whole: &Part,
        led: Option<Part>,
        written: Vec<Named>,
        known: &[&NamedField],
        owner: &str,
    ) -> DynamicStruct {
        let mut read = DynamicStruct::default();
        let mut seen: Vec<(&str, Place)> = Vec::new();
        if let (Some(value), Some(field)) = (led, known.first()) {
            seen.push((field.name(), self.place(&value)));
            self.field(&mut read, field, &value);
        }
        for Named { name, value } in &written {
            let Some(field) = known.iter().find(|field| field.name() == name.text) else {
                let names: Vec<Known> = known.iter().map(|field| Known::field(field)).collect();
                let problem =
                    Problem::error(format!("`{owner}` has no field `{}`", name.text)).label("unknown field");
                self.report(name, problem.help(suggestion(name.text, &names)));
                continue;
            };
            if let Some((_, first)) = seen.iter().find(|(seen, _)| *seen == name.text) {
                let other = Some((first.clone(), "first written here".into()));
                let problem = Problem {
                    other,
                    ..Problem::error(format!("`{}` is written twice", name.text)).label("again here")
                };
                self.report(name, problem);
                continue;
            }
            seen.push((field.name(), self.place(name)));
            self.field(&mut read, field, value);
        }
        for field in known.iter().filter(|field| field.has_attribute::<Required>()) {
            if !seen.iter().any(|(name, _)| *name == field.name()) {
                let problem =
                    Problem::error(format!("`{owner}` needs `{}`, which has no default", field.name()))
                        .label("missing in here");
                self.report(whole, problem.help(format!("write `{}: …`", field.name())));
            }
        }
        read
    }

    fn field(&mut self, read: &mut DynamicStruct, field: &NamedField, value: &Part) {
        if let Some(value) = self.within(&format!(".{}", field.name()), |reader| {
            reader.typed(value, field.type_id(), Allowed::by(field.custom_attributes()))
        }) {
            read.insert_boxed(field.name(), value);
        }
    }

    fn tuple(&mut self, part: &Part, types: &[(TypeId, Allowed)]) -> Option<Vec<Box<dyn PartialReflect>>> {
        let parts = match part.tuple(types.len()) {
            Ok(parts) if parts.len() == types.len() => parts,
            Ok(parts) => {
                self.report(
                    part,
                    Problem::error(format!(
                        "expected {} values in parentheses, found {}",
                        types.len(),
                        parts.len()
                    )),
                );
                return None;
            }
            Err(_) => {
                let problem = Problem::error(format!(
                    "expected {} values in parentheses, found `{}`",
                    types.len(),
                    excerpt(part.text)
                ));
                self.report(part, problem);
                return None;
            }
        };
        let values: Vec<_> = parts
            .iter()
            .zip(types)
            .enumerate()
            .map(|(index, (part, (ty, allowed)))| {
                self.within(&format!(".{index}"), |reader| reader.typed(part, *ty, *allowed))
            })
            .collect();
        values.into_iter().collect()
    }

    fn list(&mut self, part: &Part, item: TypeId, allowed: Allowed) -> Value {
        let elements = self.shaped(part, part.elements(), "a list `[value, …]`")?;
        let mut list = DynamicList::default();
        for (index, element) in elements.iter().enumerate() {
            if let Some(value) =
                self.within(&format!("[{index}]"), |reader| reader.typed(element, item, allowed))
            {
                list.push_box(value);
            }
        }
        Some(Box::new(list))
    }

    fn enumeration(
        &mut self,
        part: &Part,
        info: &'static EnumInfo,
        registration: &TypeRegistration,
        allowed: Allowed,
    ) -> Value {
        if info.has_attribute::<Untagged>() {
            return self.untagged(part, info, registration, allowed);
        }
        if info.type_path().starts_with("core::option::Option<") {
            return self.option(part, info, registration, allowed);
        }
        let word = part.word();
        let Some(variant) = word.and_then(|word| info.variant(word.text)) else {
            let at = word.unwrap_or(*part);
            let message = format!("`{}` is no kind of {}", excerpt(at.text), self.name());
            let problem = Problem::error(message).label("unknown");
            let help = match word {
                Some(word) => suggestion(word.text, &info.iter().map(Known::variant).collect::<Vec<_>>()),
                None => format!("write {}", info.iter().map(how_to_write).collect::<Vec<_>>().join(" or ")),
            };
            self.report(&at, problem.help(help));
            return None;
        };
        let shape = match variant {
            VariantInfo::Unit(_) => Shape::Unit,
            VariantInfo::Tuple(info) => Shape::Tuple(info.field_len()),
            VariantInfo::Struct(info) if is_led(info) => Shape::LedStruct,
            VariantInfo::Struct(_) => Shape::Struct,
        };
        let how = how_to_write(variant);
        let bare = word.is_some_and(|word| word.text.len() == part.text.len());
        let payload = match shape {
            // A bare name stands for all defaults.
            Shape::Struct | Shape::LedStruct if bare => Payload::Fields(Vec::new()),
            Shape::Tuple(_) if bare => {
                self.report(part, Problem::error(format!("expected {how}, found `{}`", part.text)));
                return None;
            }
            _ => self.shaped(part, part.payload(shape), &how)?,
        };
        let variant_value = match (variant, payload) {
            (VariantInfo::Struct(info), Payload::Fields(fields)) => {
                let known: Vec<_> = info.iter().collect();
                DynamicVariant::Struct(self.fields(part, None, fields, &known, variant.name()))
            }
            (VariantInfo::Struct(info), Payload::Led(first)) => {
                let known: Vec<_> = info.iter().collect();
                DynamicVariant::Struct(self.fields(part, Some(first), Vec::new(), &known, variant.name()))
            }
            (VariantInfo::Tuple(info), Payload::Values(parts)) => {
                let mut tuple = DynamicTuple::default();
                for (index, (part, field)) in parts.iter().zip(info.iter()).enumerate() {
                    tuple.insert_boxed(self.within(&format!(".{index}"), |reader| {
                        reader.typed(part, field.type_id(), Allowed::by(field.custom_attributes()))
                    })?);
                }
                DynamicVariant::Tuple(tuple)
            }
            _ => DynamicVariant::Unit,
        };
        Some(Box::new(enum_value(variant.name(), variant_value, registration)))
    }

    /// An enum written without the names of its variants.
    fn untagged(
        &mut self,
        part: &Part,
        info: &'static EnumInfo,
        registration: &TypeRegistration,
        allowed: Allowed,
    ) -> Value {
        if let Some(VariantInfo::Unit(unit)) = info.variant(part.text) {
            return Some(Box::new(enum_value(unit.name(), DynamicVariant::Unit, registration)));
        }
        let carriers = info.iter().filter_map(|variant| match variant {
            VariantInfo::Tuple(tuple) if tuple.field_len() == 1 => {
                tuple.field_at(0).map(|field| (variant.name(), field))
            }
            _ => None,
        });
        let before = (self.problems.len(), self.places.len());
        let mut first_problems = Vec::new();
        for (name, field) in carriers {
            if let Some(value) =
                self.typed(part, field.type_id(), Allowed::by(field.custom_attributes()).or(allowed))
            {
                let mut tuple = DynamicTuple::default();
                tuple.insert_boxed(value);
                return Some(Box::new(enum_value(name, DynamicVariant::Tuple(tuple), registration)));
            }
            let problems = self.problems.split_off(before.0);
            self.places.truncate(before.1);
            if first_problems.is_empty() || problems.iter().any(|problem| problem.label == "out of range") {
                first_problems = problems;
            }
        }
        let out_of_range = first_problems.iter().any(|problem| problem.label == "out of range");
        match self.alternatives(info).filter(|_| !out_of_range) {
            Some(wanted) => {
                let message = format!("expected {wanted}, found `{}`", excerpt(part.text));
                self.report(part, Problem::error(message));
            }
            None => self.problems.extend(first_problems),
        }
        None
    }

    /// All that an enum written without names may be, if that is soon said.
    fn alternatives(&self, info: &EnumInfo) -> Option<String> {
        let each = info.iter().map(|variant| match variant {
            VariantInfo::Tuple(tuple) => {
                let registration = self.registry.get(tuple.field_at(0)?.type_id())?;
                is_plain(registration).then(|| wanted(registration))
            }
            _ => Some(format!("`{}`", variant.name())),
        });
        Some(each.collect::<Option<Vec<_>>>()?.join(" or "))
    }

    /// A value that may be absent: `None`, `Some(value)`, or the value itself.
    fn option(
        &mut self,
        part: &Part,
        info: &'static EnumInfo,
        registration: &TypeRegistration,
        allowed: Allowed,
    ) -> Value {
        let is_tagged = part
            .word()
            .is_some_and(|word| ["some", "none"].iter().any(|tag| tag.eq_ignore_ascii_case(word.text)));
        let inner = match is_tagged {
            true => self.shaped(part, part.option(), "`Some(value)` or `None`")?,
            false => Some(*part),
        };
        let Some(inner) = inner else {
            return Some(Box::new(enum_value("None", DynamicVariant::Unit, registration)));
        };
        let VariantInfo::Tuple(some) = info.variant("Some")? else { return None };
        let mut tuple = DynamicTuple::default();
        let places = self.places.len();
        tuple.insert_boxed(self.typed(&inner, some.field_at(0)?.type_id(), allowed)?);
        // The place of the whole stands for the path, so that what replaces it may be `None`.
        self.places.remove(places);
        Some(Box::new(enum_value("Some", DynamicVariant::Tuple(tuple), registration)))
    }

    fn typed(&mut self, part: &Part, ty: TypeId, allowed: Allowed) -> Value {
        match self.registry.get(ty) {
            Some(registration) => self.value(part, registration, allowed),
            None => {
                let problem = Problem::error("the type of this field is not registered for reflection");
                self.report(
                    part,
                    problem.help("the plugin that defines it must call `app.register_type` for it"),
                );
                None
            }
        }
    }

    /// Has a value look at itself as a whole. The places in it are those from `first` on.
    fn validate(
        &mut self,
        part: &Part,
        registration: &TypeRegistration,
        value: Option<&dyn PartialReflect>,
        first: usize,
    ) {
        let (Some(validate), Some(from_reflect), Some(value)) =
            (registration.data::<ReflectValidate>(), registration.data::<ReflectFromReflect>(), value)
        else {
            return;
        };
        let Some(whole) = from_reflect.from_reflect(value) else { return };
        let found = validate.get(whole.as_ref()).map(|value| value.problems()).unwrap_or_default();
        if found.is_empty() {
            return;
        }
        let within = self.places[first..].iter();
        let places: HashMap<String, Place> = within.cloned().collect();
        for (field, message) in found {
            let written = places.get(&format!("{}.{field}", self.path)).cloned();
            let place = written.unwrap_or_else(|| self.place(part));
            self.keep(Problem::error(message).at(place));
        }
    }

    fn within<T>(&mut self, step: &str, read: impl FnOnce(&mut Self) -> T) -> T {
        let length = self.path.len();
        self.path.push_str(step);
        let value = read(self);
        self.path.truncate(length);
        value
    }

    fn shaped<T>(&mut self, part: &Part, result: Result<T, Misfit>, expected: &str) -> Option<T> {
        result.map_err(|misfit| self.report_shape(part, misfit, expected)).ok()
    }

    /// What the value being read is called: `` `radius` ``, or the place it has among values without names.
    fn name(&self) -> String {
        let mut steps = self.path.rsplit('.');
        let last = steps.next().unwrap_or_default();
        match (last.parse::<usize>(), steps.next()) {
            (Ok(index), Some(owner)) => format!("value {} of `{owner}`", index + 1),
            _ => format!("`{last}`"),
        }
    }
}

fn represent(mut fields: DynamicStruct, info: &'static TypeInfo) -> DynamicStruct {
    fields.set_represented_type(Some(info));
    fields
}

fn enum_value(name: &str, variant: DynamicVariant, registration: &TypeRegistration) -> DynamicEnum {
    let mut value = DynamicEnum::new(name, variant);
    value.set_represented_type(Some(registration.type_info()));
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::TransferFunction;

    #[test]
    fn what_is_larger_than_memory_bears_is_refused() {
        let mut registry = TypeRegistry::new();
        registry.register::<TransferFunction>();
        let text = format!("(points: [{}])", "(0.0, (0.0, 0.0, 0.0), 0.0),".repeat(100));
        let file = SourceFile::new("function.ron", text);
        let registration = registry.get(TypeId::of::<TransferFunction>()).unwrap();
        let read = |left: usize| {
            let mut reader = Reader { left, ..Reader::new(&registry, file.clone()) };
            let value = reader.complete(&Part::whole(file.text()), registration, "TransferFunction");
            (
                value.is_some(),
                reader.problems.len(),
                reader.problems.first().map(|problem| problem.message.clone()),
            )
        };
        assert_eq!(read(1000), (true, 0, None));
        let (is_read, problems, first) = read(50);
        assert!(!is_read && problems == 1 && first.unwrap().contains("values"));
    }
}
