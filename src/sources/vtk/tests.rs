#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples,
    self_describing::tests::{Folder, mutate},
};
use glam::Vec3;

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

fn vtk(kind: &str, array: &str, data: &[u8]) -> Vec<u8> {
    let head = format!(
        "# vtk DataFile Version 3.0\ntitle\n{kind}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 4\nORIGIN 0 0 0\n\
         SPACING 1 2 3\nPOINT_DATA 24\n{array}\n"
    );
    [head.as_bytes(), data].concat()
}

const SCALARS: &str = "SCALARS values unsigned_char\nLOOKUP_TABLE default";

#[test]
fn text_and_binary_are_the_same() {
    let folder = Folder::new();
    let binary = folder.read("a.vtk", vtk("BINARY", SCALARS, &ramp()));
    assert_eq!((binary.size, binary.spacing), ([2, 3, 4], Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(binary.samples, Samples::U8(ramp()));
    let text: Vec<String> = ramp().iter().map(u8::to_string).collect();
    assert_eq!(folder.read("a.vtk", vtk("ASCII", SCALARS, text.join("\n").as_bytes())), binary);
    let field = folder.read("a.vtk", vtk("BINARY", "FIELD data 1\nvalues 1 24 unsigned_char", &ramp()));
    assert_eq!(
        (field.samples, field.notes),
        (binary.samples, vec!["of its arrays the first, `values`, is read".to_owned()])
    );
}

#[test]
fn every_sample_type_is_read_most_significant_byte_first() {
    let folder = Folder::new();
    let read = |name: &str, number: &[u8]| {
        let array = format!("SCALARS values {name} 1\nLOOKUP_TABLE default");
        folder.read("a.vtk", vtk("BINARY", &array, &number.repeat(24))).samples.get(0).unwrap()
    };
    assert_eq!(read("char", &[0xff]), -1.0);
    assert_eq!(read("short", &(-300_i16).to_be_bytes()), -300.0);
    assert_eq!(read("unsigned_short", &60000_u16.to_be_bytes()), 60000.0);
    assert_eq!(read("int", &(-70000_i32).to_be_bytes()), -70000.0);
    assert_eq!(read("unsigned_int", &70000_u32.to_be_bytes()), 70000.0);
    assert_eq!(read("long", &(-5_i64).to_be_bytes()), -5.0);
    assert_eq!(read("unsigned_long", &5_u64.to_be_bytes()), 5.0);
    assert_eq!(read("float", &0.5_f32.to_be_bytes()), 0.5);
    assert_eq!(read("double", &0.5_f64.to_be_bytes()), 0.5);
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let folder = Folder::new();
    let whole = String::from_utf8(vtk("BINARY", SCALARS, b"")).unwrap();
    let with = |old: &str, new: &str| {
        assert!(whole.contains(old), "{old}");
        folder.refusal("a.vtk", [whole.replace(old, new).as_bytes(), &ramp()].concat())
    };
    assert!(with("STRUCTURED_POINTS", "UNSTRUCTURED_GRID").contains("its dataset is UNSTRUCTURED_GRID"));
    assert!(
        with("POINT_DATA 24", "POINT_DATA 23").contains("POINT_DATA counts 23 points; DIMENSIONS make 24")
    );
    assert!(with("POINT_DATA 24", "CELL_DATA 24").contains("it has cell data"));
    assert!(with("2 3 4", "2 3").starts_with("a.vtk:5: expected three numbers after DIMENSIONS"));
    assert!(with("2 3 4", "1000000000 1000000000 1000000000").contains("limit"));
    assert!(with("2 3 4", "0 3 4").contains("every side"));
    assert!(with("1 2 3", "1 nan 3").contains("spacing 1 x NaN x 3"));
    assert!(with("unsigned_char", "bit").contains("expected a type from char"));
    assert!(with("unsigned_char", "float").contains("need 96"));
    assert!(with("unsigned_char", "unsigned_char 3").contains("expected 1 number a point, found `3`"));
    assert!(
        with("SCALARS values unsigned_char", "VECTORS values float").contains("its first array are VECTORS")
    );
    assert!(with("BINARY", "XML").starts_with("a.vtk:3: expected `ASCII` or `BINARY`"));
    assert!(with("LOOKUP_TABLE default", "").contains("expected `LOOKUP_TABLE default`"));
    assert!(
        folder
            .refusal("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n")
            .contains("ends before its point data")
    );
}

#[test]
fn damaged_headers_never_panic() {
    let file = vtk("BINARY", SCALARS, &ramp());
    mutate("a.vtk", &file, file.len());
    mutate("a.vtk", &vtk("ASCII", SCALARS, &b"12 ".repeat(24)), 250);
}
