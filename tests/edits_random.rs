//! Whatever is done to a scene, in its text or by edits, it never fails badly, and the world is the one that its files make.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tyndall::components::{NameOf, Names, Range, ReflectValidate};
use tyndall::prelude::*;
use tyndall::scene::{Edits, SaveError, SceneDocument, SceneEntities, Side, reconcile, to_ron};
use tyndall_turntable::{Turntable, TurntablePlugin};

use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, VariantInfo};
use bevy_reflect::list::DynamicList;
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::tuple::DynamicTuple;
use bevy_reflect::tuple_struct::DynamicTupleStruct;
use bevy_reflect::{PartialReflect, ReflectFromReflect, ReflectRef, TypeInfo, TypeRegistry};

/// Marsaglia's xorshift: the same numbers everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn pick<'t, T>(&mut self, from: &'t [T]) -> &'t T {
        let at = self.below(from.len());
        &from[at]
    }
}

/// Makes values of any type that scenes can write.
struct Maker<'r> {
    registry: &'r TypeRegistry,
    /// Where paths start.
    folder: PathBuf,
    /// Whether what fields allow is heeded.
    is_careful: bool,
}

/// What a field allows.
#[derive(Clone, Copy, Default)]
struct Allowed {
    range: Option<Range>,
    names: Option<Names>,
    is_name: bool,
}

impl Allowed {
    fn by(attributes: &CustomAttributes) -> Self {
        Self {
            range: attributes.get().copied(),
            names: attributes.get().copied(),
            is_name: attributes.contains::<NameOf>(),
        }
    }
}

impl Maker<'_> {
    fn value(&self, random: &mut Random, info: &TypeInfo, allowed: Allowed) -> Box<dyn Reflect> {
        let from_reflect = self.registry.get_type_data::<ReflectFromReflect>(info.type_id()).unwrap();
        let validate = self.registry.get_type_data::<ReflectValidate>(info.type_id());
        loop {
            if let Some(whole) = self.plain(random, info, allowed) {
                return whole;
            }
            let parts = self.parts(random, info, allowed);
            let whole =
                from_reflect.from_reflect(parts.as_ref()).unwrap_or_else(|| panic!("{}", info.type_path()));
            let problems =
                validate.and_then(|validate| validate.get(whole.as_ref())).map(|value| value.problems());
            if !self.is_careful || problems.unwrap_or_default().is_empty() {
                return whole;
            }
        }
    }

    fn plain(&self, random: &mut Random, info: &TypeInfo, allowed: Allowed) -> Option<Box<dyn Reflect>> {
        let number = |random: &mut Random| self.number(random, allowed.range);
        Some(match info.type_path_table().short_path() {
            "f32" => Box::new(number(random)),
            "u32" => Box::new(number(random).abs() as u32),
            "u64" => Box::new(random.next() >> random.below(64)),
            "bool" => Box::new(random.one_in(2)),
            "String" => Box::new(self.text(random, allowed)),
            "i32" => Box::new(number(random) as i32),
            "Vec2" => Box::new(Vec2::from_array([0; 2].map(|_| number(random)))),
            "Vec3" => Box::new(Vec3::from_array([0; 3].map(|_| number(random)))),
            "UVec3" => Box::new(UVec3::from_array([0; 3].map(|_| number(random).abs() as u32))),
            "AssetPath" => {
                let mut path = AssetPath::new(self.text(random, Allowed::default()));
                path.resolve(&self.folder);
                Box::new(path)
            }
            "Option<String>" if random.one_in(2) => Box::new(Some(self.text(random, allowed))),
            _ => return None,
        })
    }

    fn number(&self, random: &mut Random, range: Option<Range>) -> f32 {
        let range = range.unwrap_or(Range::new(f64::from(f32::MIN), f64::from(f32::MAX)));
        if !self.is_careful && random.one_in(4) {
            return *random.pick(&[f32::NAN, f32::INFINITY, -1e30, -1.0, 0.0, 1e30]);
        }
        loop {
            let share = random.below(1001) as f32 / 1000.0;
            let (min, max) = (range.min.max(-1e6) as f32, range.max.min(1e6) as f32);
            let number = match random.below(6) {
                0 => f32::from_bits(random.next() as u32),
                1 => *random.pick(&[range.min as f32, range.max as f32, 0.0, 1.0, 1e-40, 1e20, 0.1]),
                2 => random.below(10) as f32,
                _ => min + share * (max - min),
            };
            if number.is_finite() && range.contains(f64::from(number)) {
                return number;
            }
        }
    }

    fn text(&self, random: &mut Random, allowed: Allowed) -> String {
        if allowed.is_name {
            return (*random.pick(&["ball", "bowl"])).to_owned();
        }
        match allowed.names.filter(|_| self.is_careful || random.one_in(2)) {
            Some(names) => (*random.pick(names.known)).to_owned(),
            None => {
                let letters = [
                    'a', 'Z', '0', ' ', '"', '\\', '/', '.', '\n', '\t', '\r', '\u{7f}', 'é', '猫', '🐈',
                    '(', '#',
                ];
                (0..random.below(12)).map(|_| *random.pick(&letters)).collect()
            }
        }
    }

    fn parts(&self, random: &mut Random, info: &TypeInfo, allowed: Allowed) -> Box<dyn PartialReflect> {
        let inner = |random: &mut Random, info: Option<&'static TypeInfo>, allowed| {
            self.value(random, info.unwrap(), allowed).into_partial_reflect()
        };
        match info {
            TypeInfo::Struct(info) => {
                let mut fields = DynamicStruct::default();
                for field in info.iter() {
                    let value = inner(random, field.type_info(), Allowed::by(field.custom_attributes()));
                    fields.insert_boxed(field.name(), value);
                }
                Box::new(fields)
            }
            TypeInfo::TupleStruct(info) => {
                let mut fields = DynamicTupleStruct::default();
                for field in info.iter() {
                    fields.insert_boxed(inner(
                        random,
                        field.type_info(),
                        Allowed::by(field.custom_attributes()),
                    ));
                }
                Box::new(fields)
            }
            TypeInfo::List(info) => {
                let elements = (0..random.below(4)).map(|_| inner(random, info.item_info(), allowed));
                Box::new(elements.collect::<DynamicList>())
            }
            TypeInfo::Enum(info) => {
                let variant = info.variant_at(random.below(info.variant_len())).unwrap();
                let payload = match variant {
                    VariantInfo::Unit(_) => DynamicVariant::Unit,
                    VariantInfo::Tuple(tuple) => {
                        let mut fields = DynamicTuple::default();
                        for field in tuple.iter() {
                            let own = Allowed::by(field.custom_attributes());
                            let own = Allowed {
                                range: own.range.or(allowed.range),
                                names: own.names.or(allowed.names),
                                is_name: own.is_name || allowed.is_name,
                            };
                            fields.insert_boxed(inner(random, field.type_info(), own));
                        }
                        DynamicVariant::Tuple(fields)
                    }
                    VariantInfo::Struct(known) => {
                        let mut fields = DynamicStruct::default();
                        for field in known.iter() {
                            let own = Allowed::by(field.custom_attributes());
                            fields.insert_boxed(field.name(), inner(random, field.type_info(), own));
                        }
                        DynamicVariant::Struct(fields)
                    }
                };
                Box::new(DynamicEnum::new(variant.name(), payload))
            }
            other => panic!("no values of {} are made yet", other.type_path()),
        }
    }
}

/// Every component that scenes can write.
fn components(registry: &TypeRegistry) -> Vec<&'static TypeInfo> {
    let mut all: Vec<_> =
        registry.iter_with_data::<ReflectComponent>().map(|(known, _)| known.type_info()).collect();
    // Bevy registers some of its own, which are no plain data.
    all.retain(|info| !info.type_path().starts_with("bevy"));
    all.sort_by_key(|info| info.type_path());
    all
}

fn registry() -> AppTypeRegistry {
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).add_plugins(TurntablePlugin);
    app.world().resource::<AppTypeRegistry>().clone()
}

fn named<'d>(document: &'d SceneDocument, entity: &str, component: &str) -> &'d dyn Reflect {
    let entity = document.entities.iter().find(|known| known.name == entity).unwrap();
    let found = entity.components.iter().find(|known| known.name == component);
    found.unwrap_or_else(|| panic!("no {component}")).value.as_ref()
}

/// A scene that anything can be tried on: of several files, with all kinds of comments and breaks.
const SCENE: &[(&str, &str)] = &[
    (
        "scene.ron",
        r#"// A scene.
(
    background: (0.1, 0.2, 0.3), /* dark */
    include: ["more.ron"],
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 1.0, 4.0)) ), // looks
        "ball": (
            Mesh: Sphere(radius: 2.0), Transform: (scale: 2),
            // Shared.
            Subsurface: File("jade.ron"),
        ),
        "bone": ( Volume: Raw(path: "b.raw", size: (1, 1, 1)), TransferFunction: (points: [
            (0.25, (1.0, 0.50, 0.25), 0.1), // thin
            (0.75, (1, 1, 1), 0.90),
        ]), VolumeLighting: Gradient ),
        "from above": ( ScatteringCamera: (target: "ball") ),
    },
)
"#,
    ),
    ("more.ron", "(entities: {\"bowl\": ( Mesh: Box(), Subsurface: File(\"./jade.ron\"), Turntable: () )})"),
    (
        "jade.ron",
        "// Jade.\n(\n  material: Custom(sigma_a: (0.1, 0.2, 0.3), sigma_s: Some((1, 2, 3))),\n  specular: None,\n)",
    ),
];

fn write(folder: &Path, files: &BTreeMap<String, Vec<u8>>) {
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
}

fn originals() -> BTreeMap<String, Vec<u8>> {
    SCENE.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
}

#[test]
fn any_value_of_any_component_reads_as_it_was_written() {
    const VALUES: usize = 150;
    let registry = registry();
    let registry = registry.read();
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let maker = Maker { registry: &registry, folder: folder.path().to_owned(), is_careful: true };
    let types = components(&registry);
    assert!(types.len() >= 14, "{types:?}");
    for info in types {
        let name = info.type_path_table().short_path();
        let values: Vec<_> =
            (0..VALUES).map(|_| maker.value(&mut random, info, Allowed::default())).collect();
        let written = values.iter().map(|value| to_ron(value.as_partial_reflect(), &registry).unwrap());
        let written: Vec<String> = written.collect();
        let entities: String =
            written.iter().enumerate().map(|(at, text)| format!("\"{at}\": ( {name}: {text} ),\n")).collect();
        // Beside entities that they may name.
        write(folder.path(), &originals());
        let part = SCENE[0].1.replace("    background: (0.1, 0.2, 0.3), /* dark */\n", "");
        fs::write(folder.path().join("part.ron"), part).unwrap();
        let text = format!("(include: [\"part.ron\"], entities: {{\n{entities}}})");
        fs::write(folder.path().join("all.ron"), text).unwrap();
        let document = SceneDocument::load(&folder.path().join("all.ron"), &registry, &[]);
        let errors =
            document.problems.iter().filter(|problem| problem.severity == tyndall::scene::Severity::Error);
        let errors: Vec<_> = errors.map(|problem| problem.message.clone()).collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");
        for (at, value) in values.iter().enumerate() {
            let read = named(&document, &at.to_string(), name);
            let (read, value) = (format!("{read:?}"), format!("{value:?}"));
            assert_eq!(read, value, "{}", written[at]);
        }
    }
}

#[test]
fn what_is_left_out_has_its_default() {
    let registry = registry();
    let registry = registry.read();
    let text = |value: &dyn Reflect| to_ron(value.as_partial_reflect(), &registry).unwrap();
    let cases: [(&dyn Reflect, &str); 12] = [
        (&Transform { scale: Scale::Uniform(2.0), ..Transform::default() }, "(scale: 2.0)"),
        (
            &Transform { scale: Scale::PerAxis(Vec3::new(1.0, 2.0, 0.5)), ..Transform::default() },
            "(scale: (1.0, 2.0, 0.5))",
        ),
        (&Phong::default(), "()"),
        (&Mesh::default(), "Sphere()"),
        (&Mesh::Sphere { radius: 0.1, subdivisions: 5 }, "Sphere(radius: 0.1)"),
        (&Mesh::CornellBox, "CornellBox"),
        (&Mesh::file("a \"b\".obj"), r#"File("a \"b\".obj")"#),
        (
            &Subsurface { specular: Some(Specular::default()), ..Subsurface::default() },
            "(specular: Some(()))",
        ),
        (
            &Material::Custom {
                sigma_a: Some(Vec3::ONE),
                sigma_s: Some(Vec3::X),
                sigma_t: None,
                albedo: None,
                g: 0.0,
                eta: 1.5,
            },
            "Custom(sigma_a: (1.0, 1.0, 1.0), sigma_s: (1.0, 0.0, 0.0), eta: 1.5)",
        ),
        (
            &Volume::Raw {
                path: AssetPath::new("a.raw"),
                size: UVec3::ONE,
                format: SampleFormat::U8,
                endian: Endian::Little,
                spacing: Vec3::ONE,
                skip_bytes: 3,
                interpolation: Default::default(),
            },
            r#"Raw(path: "a.raw", size: (1, 1, 1), skip_bytes: 3)"#,
        ),
        (
            &TransferFunction {
                domain: Auto::Value(Vec2::new(0.0, 255.0)),
                iso: vec![IsoValue::default()],
                ..TransferFunction::default()
            },
            "(domain: (0.0, 255.0), iso: [()])",
        ),
        (&Turntable { degrees_per_second: 1e-9, ..Turntable::default() }, "(degrees_per_second: 1e-9)"),
    ];
    for (value, expected) in cases {
        assert_eq!(text(value), expected);
    }
}

/// The scene while it is edited, and its files as they were when they last made a scene.
struct Trial<'r> {
    registry: &'r AppTypeRegistry,
    folder: PathBuf,
    /// Where the files are put that the world must be made of.
    twin: PathBuf,
    world: World,
    edits: Edits,
    good: BTreeMap<String, Vec<u8>>,
}

impl<'r> Trial<'r> {
    fn new(registry: &'r AppTypeRegistry, folder: PathBuf, twin: PathBuf) -> Self {
        write(&folder, &originals());
        let mut world = World::new();
        world.insert_resource(registry.clone());
        let edits =
            Edits::open(&mut world, &folder.join("scene.ron"), &[]).unwrap_or_else(|told| panic!("{told:?}"));
        Self { registry, folder, twin, world, edits, good: originals() }
    }

    fn load(&self) -> SceneDocument {
        SceneDocument::load(&self.folder.join("scene.ron"), &self.registry.read(), &[])
    }

    /// What is on disk counts as good if it makes a scene.
    fn look(&mut self) {
        if !self.load().has_errors() {
            self.good = self.on_disk();
        }
    }

    fn on_disk(&self) -> BTreeMap<String, Vec<u8>> {
        self.good.keys().map(|name| (name.clone(), fs::read(self.folder.join(name)).unwrap())).collect()
    }

    /// Asserts that the world is the one that the good files and the unsaved edits make.
    fn check(&mut self, what: &str) {
        let mut files = self.good.clone();
        for (path, text) in self.edits.preview(&mut self.world).unwrap() {
            let name = path.strip_prefix(&self.folder).unwrap();
            files.insert(
                name.strip_prefix(".").unwrap_or(name).to_str().unwrap().to_owned(),
                text.into_bytes(),
            );
        }
        write(&self.twin, &files);
        let document = SceneDocument::load(&self.twin.join("scene.ron"), &self.registry.read(), &[]);
        assert!(!document.has_errors(), "{what}: {:?}", document.problems);
        let mut fresh = World::new();
        fresh.insert_resource(self.registry.clone());
        reconcile(&mut fresh, &document);
        let (shown, made) = (described(&self.world, &self.folder), described(&fresh, &self.twin));
        for (name, shown) in &shown {
            assert_eq!(Some(shown), made.get(name), "{what}: `{name}`");
        }
        assert_eq!(shown.len(), made.len(), "{what}: {:?} and {:?}", shown.keys(), made.keys());
    }
}

fn described(world: &World, folder: &Path) -> BTreeMap<String, String> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let folder = folder.to_str().unwrap();
    let mut all = BTreeMap::new();
    all.insert(String::new(), format!("{:?}", world.resource::<SceneSettings>()));
    let components: Vec<_> = registry.iter_with_data::<ReflectComponent>().collect();
    for (name, entity) in &world.resource::<SceneEntities>().0 {
        let entity = world.entity(*entity);
        let values = components.iter().filter_map(|(known, component)| {
            let value = component.reflect(entity)?;
            Some(
                format!("{}: {value:?}", known.type_info().type_path_table().short_path())
                    .replace(folder, ""),
            )
        });
        let mut values: Vec<_> = values.collect();
        values.sort_unstable();
        all.insert(name.clone(), values.join("\n"));
    }
    all
}

/// Paths of values within a value, its own included.
fn paths(value: &dyn PartialReflect, path: &str, all: &mut Vec<String>) {
    all.push(path.to_owned());
    let is_vector = value.reflect_type_path().starts_with("glam::");
    match value.reflect_ref() {
        ReflectRef::Struct(fields) if !is_vector => {
            fields.iter_fields().for_each(|(name, field)| paths(field, &format!("{path}.{name}"), all));
        }
        ReflectRef::TupleStruct(fields) => {
            let fields = fields.iter_fields().enumerate();
            fields.for_each(|(at, field)| paths(field, &format!("{path}.{at}"), all));
        }
        ReflectRef::List(list) => {
            list.iter().enumerate().for_each(|(at, element)| paths(element, &format!("{path}[{at}]"), all));
        }
        ReflectRef::Enum(fields) => {
            let is_held = ["Option<", "Auto<", "Scale"]
                .iter()
                .any(|kind| value.reflect_short_type_path().starts_with(kind));
            for (at, field) in fields.iter_fields().enumerate() {
                match field.name() {
                    Some(name) => paths(field.value(), &format!("{path}.{name}"), all),
                    None if is_held => {}
                    None => paths(field.value(), &format!("{path}.{at}"), all),
                }
            }
        }
        _ => {}
    }
}

/// A value of the type of what stands at the path, if the path leads somewhere.
fn other(random: &mut Random, maker: &Maker, whole: &dyn Reflect, at: &str) -> Option<Box<dyn Reflect>> {
    let found = bevy_reflect::GetPath::reflect_path(whole, at).ok()?;
    let info = found.get_represented_type_info()?;
    Some(maker.value(random, info, Allowed::default()))
}

impl Trial<'_> {
    /// Does something to the scene by an edit. Whether it could be done.
    fn edit(&mut self, random: &mut Random) -> bool {
        let registry = self.registry.read();
        let maker = Maker { registry: &registry, folder: self.folder.clone(), is_careful: !random.one_in(4) };
        let document = self.edits.document();
        let names: Vec<String> = document.entities.iter().map(|entity| entity.name.clone()).collect();
        if names.is_empty() {
            return self.edits.add_entity(&mut self.world, "ball", &[&Subsurface::default()]).is_ok();
        }
        let entity = random.pick(&names).clone();
        let written = document.entities.iter().find(|known| known.name == entity).unwrap();
        let known: Vec<String> = written.components.iter().map(|component| component.name.clone()).collect();
        let fresh_name = (*random.pick(&["a", "b", "ball", "ä\n\"", "from below"])).to_owned();
        let types = components(&registry);
        let info = *random.pick(&types);
        let (edits, world) = (&mut self.edits, &mut self.world);
        let done = match random.below(16) {
            0 => edits.remove_entity(world, &entity),
            1 if names.len() < 9 => {
                let value = maker.value(random, info, Allowed::default());
                edits.add_entity(world, &fresh_name, &[value.as_ref()])
            }
            2 => edits.rename_entity(world, &entity, &fresh_name),
            3 => edits.add_component(world, &entity, maker.value(random, info, Allowed::default()).as_ref()),
            4 if !known.is_empty() => {
                edits.remove_component(world, &entity, &known[random.below(known.len())])
            }
            5 => {
                let settings = SceneSettings::default();
                let names = ["background", "millimetres_per_unit", "shading", "nothing", ""];
                let name = *random.pick(&names);
                let value = other(random, &maker, &settings, &format!(".{name}"));
                let value = value.unwrap_or_else(|| Box::new(0.5_f32));
                edits.set_setting(world, name, value.as_partial_reflect())
            }
            _ if !known.is_empty() => {
                let component = random.pick(&known).clone();
                let value = named(edits.document(), &entity, &component);
                let mut all = Vec::new();
                paths(value.as_partial_reflect(), "", &mut all);
                let at = random.pick(&all).clone();
                let (mut path, wrong) = (format!("{component}{at}"), random.one_in(12));
                let new = match other(random, &maker, value, &at) {
                    Some(new) if !wrong => new,
                    _ => Box::new("nothing that fits".to_owned()),
                };
                if random.one_in(20) {
                    path.push_str([".x", "[3]", "[", ".", "é", ".0"][random.below(6)]);
                }
                if random.one_in(10) {
                    edits.begin_drag();
                } else if random.one_in(5) {
                    edits.end_drag();
                }
                edits.set(world, &entity, &path, new.as_partial_reflect())
            }
            _ => return false,
        };
        if let Err(error) = &done {
            assert!(!error.to_string().is_empty());
        }
        done.is_ok()
    }

    /// Changes a file as somebody else might. Whether it still makes a scene.
    fn scribble(&mut self, random: &mut Random) -> bool {
        let names: Vec<String> = self.good.keys().cloned().collect();
        let name = random.pick(&names).clone();
        let text = match random.below(4) {
            0 => SCENE.iter().find(|(known, _)| *known == name).unwrap().1.as_bytes().to_vec(),
            1 => mutated(&self.good[&name], random),
            _ => other_number(&self.good[&name], random),
        };
        fs::write(self.folder.join(&name), text).unwrap();
        let document = self.load();
        let is_good = !document.has_errors();
        let before = described(&self.world, &self.folder);
        match self.edits.reload(&mut self.world, document) {
            Ok(_) => assert!(is_good),
            Err(problems) => {
                assert!(!is_good && !problems.is_empty());
                assert_eq!(described(&self.world, &self.folder), before);
                if random.one_in(2) {
                    let good = self.good.clone();
                    write(&self.folder, &good);
                }
            }
        }
        if is_good {
            self.good = self.on_disk();
        }
        is_good
    }

    fn save(&mut self, random: &mut Random) -> bool {
        match self.edits.save(&mut self.world) {
            Ok(_) => {
                self.look();
                assert!(!self.edits.is_unsaved() && self.edits.preview(&mut self.world).unwrap().is_empty());
                true
            }
            Err(SaveError::Broken(_)) => {
                assert!(self.load().has_errors());
                let good = self.good.clone();
                write(&self.folder, &good);
                false
            }
            Err(SaveError::Conflicts { .. }) => {
                self.look();
                let conflicts = self.edits.conflicts();
                assert!(!conflicts.is_empty() && self.edits.is_unsaved());
                let id = conflicts[random.below(conflicts.len())].id;
                let side = *random.pick(&[Side::Ours, Side::Theirs, Side::Theirs]);
                if let Err(error) = self.edits.resolve(&mut self.world, id, side) {
                    assert!(!error.to_string().is_empty());
                }
                false
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// Another number in the place of one.
fn other_number(text: &[u8], random: &mut Random) -> Vec<u8> {
    let starts: Vec<usize> = (1..text.len())
        .filter(|at| text[*at].is_ascii_digit() && matches!(text[at - 1], b' ' | b'('))
        .collect();
    if starts.is_empty() {
        return text.to_vec();
    }
    let start = *random.pick(&starts);
    let length = text[start..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.').count();
    let new = format!("{}.{}", random.below(3), random.below(100));
    [&text[..start], new.as_bytes(), &text[start + length..]].concat()
}

/// Bytes flipped, left out, put twice, cut off or put in.
fn mutated(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..1 + random.below(3) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(12)).min(bytes.len());
        match random.below(5) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            3 => bytes.truncate(at),
            _ => bytes.insert(at, *random.pick(b"()[]{}\"':,/*#r\\-.e9\n ")),
        }
    }
    bytes
}

/// Two halves, which run at once.
#[test]
fn after_five_thousand_edits_the_world_is_the_one_that_the_files_make() {
    edit_at_random(0xD1B5_4A32_D192_ED03);
}

#[test]
fn after_five_thousand_other_edits_the_world_is_the_one_that_the_files_make() {
    edit_at_random(0x2545_F491_4F6C_DD1D);
}

fn edit_at_random(seed: u64) {
    const EDITS: usize = 5_000;
    let registry = registry();
    let (folder, twin) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mut trial = Trial::new(&registry, folder.path().to_owned(), twin.path().to_owned());
    let mut random = Random(seed);
    let mut done: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for round in 0..EDITS {
        let (what, could) = match random.below(20) {
            0 | 1 => ("undo", trial.edits.undo(&mut trial.world).unwrap_or(false)),
            2 => ("redo", trial.edits.redo(&mut trial.world).unwrap_or(false)),
            3 => ("save", trial.save(&mut random)),
            4..7 => ("scribble", trial.scribble(&mut random)),
            _ => ("edit", trial.edit(&mut random)),
        };
        done.entry(what).or_default()[usize::from(could)] += 1;
        trial.check(&format!("{what} in round {round}"));
        // What was scribbled may have taken most of the scene away.
        if trial.edits.document().entities.len() < 3 || round % 500 == 499 {
            write(&trial.folder, &originals());
            let document = trial.load();
            assert!(trial.edits.reload(&mut trial.world, document).is_ok());
            trial.look();
            trial.check("a new beginning");
        }
    }
    eprintln!("could not, could: {done:?}");
    assert!(done.values().all(|[_, worked]| *worked >= 20), "{done:?}");
    assert!(["edit", "save", "scribble"].iter().all(|what| done[what][0] >= 20), "{done:?}");
}
