//! Numbers of every type in components of plugins: their ranges, that they are finite, and what is said of those that are not.

use super::{Files, app, errors};
use glam::{
    DMat2, DVec2, DVec3, DVec4, I8Vec2, I16Vec3, I64Vec4, IVec2, IVec3, IVec4, Quat, U8Vec3, U16Vec2,
    U64Vec2, UVec2, UVec4, Vec4,
};
use std::collections::HashMap;
use std::num::NonZeroU32;
use tyndall::prelude::*;
use tyndall::scene::{EditError, Edits};

/// Every field allows -2 to 3.
macro_rules! probe {
    ($($field:ident: $ty:ty),* $(,)?) => {
        #[derive(Component, Reflect, Clone, Debug, PartialEq)]
        #[reflect(Component, Default, PartialEq)]
        struct Probe {
            $(#[reflect(@Range::new(-2.0, 3.0))] $field: $ty,)*
            free: Free,
        }

        impl Default for Probe {
            fn default() -> Self {
                Self { $($field: Default::default(),)* free: Free::default() }
            }
        }
    };
}

/// Of which any finite number will do.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
struct Free {
    double: f64,
    four: Vec4,
    three: DVec3,
    turn: Quat,
    matrix: DMat2,
}

probe! {
    u8: u8, u16: u16, u32: u32, u64: u64, usize: usize,
    i8: i8, i16: i16, i32: i32, i64: i64, isize: isize,
    f32: f32, f64: f64,
    vec2: Vec2, vec3: Vec3, vec4: Vec4, dvec2: DVec2, dvec3: DVec3, dvec4: DVec4,
    uvec2: UVec2, uvec3: UVec3, uvec4: UVec4, ivec2: IVec2, ivec3: IVec3, ivec4: IVec4,
    i8vec2: I8Vec2, u8vec3: U8Vec3, i16vec3: I16Vec3, u16vec2: U16Vec2, u64vec2: U64Vec2, i64vec4: I64Vec4,
    quat: Quat, matrix: DMat2, positive: Option<NonZeroU32>,
    maybe: Option<u8>, list: Vec<i64>, pair: (f64, u8), array: [f64; 2], table: HashMap<String, f64>,
}

/// A field, a value of it that is allowed, one that is not, and the number in it that is at fault.
const CASES: &[(&str, &str, &str, &str)] = &[
    ("u8", "3", "4", "4"),
    ("u16", "3", "4", "4"),
    ("u32", "3", "4", "4"),
    ("u64", "3", "18446744073709551615", "18446744073709551615"),
    ("usize", "3", "4", "4"),
    ("i8", "-2", "-3", "-3"),
    ("i16", "-2", "-3", "-3"),
    ("i32", "-2", "-3", "-3"),
    ("i64", "-2", "-9223372036854775808", "-9223372036854775808"),
    ("isize", "-2", "-3", "-3"),
    ("f32", "3.0", "3.5", "3.5"),
    ("f64", "3.0", "3.0000000001", "3.0000000001"),
    ("vec2", "(1, 2)", "(1, 4)", "4"),
    ("vec3", "(1, 2, 3)", "(1, 2, 4)", "4"),
    ("vec4", "(1, 2, 3, 3)", "(1, 2, 3, 4)", "4"),
    ("dvec2", "(1, 2)", "(-2.5, 2)", "-2.5"),
    ("dvec3", "(1, 2, 3)", "(1, -2.5, 3)", "-2.5"),
    ("dvec4", "(1, 2, 3, 3)", "(1, 2, 3, -2.5)", "-2.5"),
    ("uvec2", "(1, 2)", "(1, 4)", "4"),
    ("uvec3", "(1, 2, 3)", "(1, 2, 4)", "4"),
    ("uvec4", "(1, 2, 3, 3)", "(9, 2, 3, 3)", "9"),
    ("ivec2", "(1, -2)", "(1, -3)", "-3"),
    ("ivec3", "(1, -2, 3)", "(1, -3, 3)", "-3"),
    ("ivec4", "(1, -2, 3, 3)", "(1, -2, 3, 9)", "9"),
    ("i8vec2", "(1, -2)", "(1, -3)", "-3"),
    ("u8vec3", "(1, 2, 3)", "(1, 2, 200)", "200"),
    ("i16vec3", "(1, 2, 3)", "(1, 2, 200)", "200"),
    ("u16vec2", "(1, 2)", "(1, 200)", "200"),
    ("u64vec2", "(1, 2)", "(1, 200)", "200"),
    ("i64vec4", "(1, 2, 3, 3)", "(1, 2, 3, -200)", "-200"),
    ("quat", "(0, 0, 0, 1)", "(0, 0, 0, 4)", "4"),
    ("matrix", "(1, 0, 0, 1)", "(1, 0, 0, 4)", "4"),
    ("positive", "3", "4", "4"),
    ("maybe", "3", "Some(4)", "4"),
    ("list", "[1, 3]", "[1, 4]", "4"),
    ("pair", "(1, 3)", "(1, 4)", "4"),
    ("array", "(1, 3)", "(1, 4)", "4"),
    ("table", "{\"a\": 3}", "{\"a\": 3, \"b\": 4}", "4"),
];

fn read(probe: &str, overrides: &[&str]) -> Vec<String> {
    let mut app = app();
    app.register_type::<Probe>();
    errors(&Files::scene(&format!("\"it\": ( Probe: ({probe}) )")).load_into(&mut app, overrides).problems)
}

#[test]
fn ranges_hold_for_numbers_of_every_type() {
    for (field, fine, wrong, digits) in CASES {
        assert_eq!(read(&format!("{field}: {fine}"), &[]), [""; 0], "{field}");
        let expected = format!("must be from -2 to 3, found `{digits}`; ");
        for errors in [
            read(&format!("{field}: {wrong}"), &[]),
            read("", &[&format!("it.Probe.{field}={wrong}")]),
            read(&format!("{field}: {fine}"), &[&format!("it.Probe.{field}={wrong}")]),
        ] {
            assert!(errors.len() == 1 && errors[0].ends_with(&expected), "{field}: {errors:?}");
        }
    }
}

#[test]
fn every_field_is_tried() {
    let mut fields: Vec<&str> = CASES.iter().map(|(field, ..)| *field).collect();
    fields.push("free");
    let bevy_reflect::TypeInfo::Struct(info) = <Probe as bevy_reflect::Typed>::type_info() else {
        panic!("it is a struct")
    };
    assert_eq!(info.field_names(), fields);
}

#[test]
fn what_is_not_finite_is_refused_without_a_range() {
    let cases = [
        ("double", "inf", "inf"),
        ("double", "1e999", "1e999"),
        ("four", "(0, 0, NaN, 0)", "(0, 0, NaN, 0)"),
        ("four", "(0, 0, 1e39, 0)", "(0, 0, 1e39, 0)"),
        ("three", "(0, -inf, 0)", "(0, -inf, 0)"),
        ("turn", "(0, 0, NaN, 1)", "(0, 0, NaN, 1)"),
        ("matrix", "(0, 0, NaN, 1)", "(0, 0, NaN, 1)"),
    ];
    for (field, value, found) in cases {
        let errors = read(&format!("free: ({field}: {value})"), &[]);
        assert_eq!(errors, [format!("`{field}` must be a finite number, found `{found}`; ")]);
    }
    assert_eq!(read("free: (double: 1e300, four: (1e38, 0, 0, 0), three: (1e300, 0, 0))", &[]), [""; 0]);
}

#[test]
fn what_is_wanted_is_told_for_numbers_of_every_type() {
    let cases = [
        ("u8", "300", "a whole number from 0 to 255", "at most 255 can be written here"),
        ("i8", "-129", "a whole number from -128 to 127", "at least -128 can be written here"),
        ("u16", "-1", "a whole number from 0 to 65535", ""),
        ("u32", "5_000_000_000", "a whole number of 0 or more", "at most 4294967295 can be written here"),
        ("u64", "1.5", "a whole number of 0 or more", ""),
        ("i64", "\"1\"", "a whole number", ""),
        ("f64", "big", "a number", ""),
        ("vec4", "(1, 2, 3)", "four numbers `(x, y, z, w)`", ""),
        ("dvec2", "1", "two numbers `(x, y)`", ""),
        ("dvec4", "1", "four numbers `(x, y, z, w)`", ""),
        ("uvec2", "(-1, 0)", "two whole numbers of 0 or more `(x, y)`", ""),
        ("uvec4", "1", "four whole numbers of 0 or more `(x, y, z, w)`", ""),
        ("ivec2", "1.5", "two whole numbers `(x, y)`", ""),
        ("i64vec4", "1", "four whole numbers `(x, y, z, w)`", ""),
        ("u8vec3", "(1, 2, 300)", "three whole numbers from 0 to 255 `(x, y, z)`", ""),
        ("quat", "1", "four numbers `(x, y, z, w)`", ""),
        ("matrix", "1", "four numbers in parentheses, column after column", ""),
        ("positive", "0", "a whole number other than 0", ""),
    ];
    for (field, value, wanted, help) in cases {
        assert_eq!(
            read(&format!("{field}: {value}"), &[]),
            [format!("expected {wanted}, found `{value}`; {help}")],
            "{field}"
        );
    }
}

#[test]
fn an_edit_is_held_to_the_same() {
    let files = Files::scene("\"it\": ( Probe: (u8: 1) )");
    let mut app = app();
    app.register_type::<Probe>();
    let mut edits = Edits::open(app.world_mut(), &files.path(), &[]).unwrap();
    let mut set =
        |path: &str, value: &dyn Reflect| edits.set(app.world_mut(), "it", path, value.as_partial_reflect());
    set("Probe.u8", &3_u8).unwrap();
    set("Probe.dvec3", &DVec3::ONE).unwrap();
    for (path, value) in [
        ("Probe.u8", &4_u8 as &dyn Reflect),
        ("Probe.dvec3", &DVec3::new(0.0, 4.0, 0.0)),
        ("Probe.dvec3", &DVec3::NAN),
        ("Probe.uvec4", &UVec4::splat(4)),
        ("Probe.free.turn", &Quat::NAN),
    ] {
        let refused = set(path, value);
        let told = refused.as_ref().map_err(EditError::to_string).err().unwrap_or_default();
        assert!(told.contains("must be"), "{path}: {refused:?}");
    }
}
