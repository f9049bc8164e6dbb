#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples, Space,
    self_describing::tests::{Folder, is_at, mutate, place_of, values},
};
use glam::{DVec3, Vec3};

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
    assert_eq!((field.samples, field.notes.len()), (binary.samples, 0));
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

/// A file whose lines are all written, for values 0 to 23.
fn text(dataset: &str, data: &str) -> String {
    format!("# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET {dataset}\n{data}\n{}", numbers(24))
}

fn numbers(count: u32) -> String {
    (0..count).map(|value| format!("{value} ")).collect()
}

const IMAGE: &str = "STRUCTURED_POINTS\nDIMENSIONS 2 3 4\nORIGIN 5 6 7\nSPACING 1 2 3";

#[test]
fn fields_of_the_data_set_are_passed_over() {
    let folder = Folder::new();
    let fields =
        "FIELD FieldData 3\nTIME 1 1 double\n0.25\nnames 1 2 string\na%20b\nc d\nCYCLE 1 2 int\n7\n8";
    let read = |dataset: &str| folder.read("a.vtk", text(dataset, &format!("POINT_DATA 24\n{SCALARS}")));
    let plain = read(IMAGE);
    assert_eq!((&plain.samples, plain.notes.len()), (&Samples::U8(ramp()), 0));
    assert_eq!(read(&IMAGE.replacen('\n', &format!("\n{fields}\n"), 1)), plain);
    assert_eq!(read(&format!("{IMAGE}\n{fields}\nMETADATA\nINFORMATION 0\n")), plain);
    // The same in binary, where texts have their lengths in front.
    let long = "x".repeat(100);
    let data = [
        b"FIELD FieldData 3\nTIME 1 1 double\n".as_slice(),
        &0.25_f64.to_be_bytes(),
        b"\nnames 1 2 string\n\xc3a\nb\x80\x64",
        long.as_bytes(),
        b"\nbits 1 9 bit\n\xff\x80\nPOINT_DATA 24\n",
        SCALARS.as_bytes(),
        b"\n",
        &ramp(),
        b"\nMETADATA\nINFORMATION 0\n\n",
    ];
    let head = format!("# vtk DataFile Version 5.1\nt\nBINARY\nDATASET {IMAGE}\n");
    assert_eq!(folder.read("a.vtk", [head.as_bytes(), &data.concat()].concat()), plain);
}

#[test]
fn the_first_array_of_single_numbers_is_read_wherever_it_stands() {
    let folder = Folder::new();
    let vectors: Vec<u8> = (0..72_u16).flat_map(|value| f32::from(value).to_be_bytes()).collect();
    let more = [
        &vectors[..],
        b"\nMETADATA\nCOMPONENT_NAMES\na\nb\n\n",
        SCALARS.as_bytes(),
        b"\n",
        &ramp(),
        b"\nFIELD f 2\nother 1 3 int\n",
        &[0; 12],
        b"\nsecond%20one 1 24 unsigned_char\n",
        &ramp(),
    ];
    let file = vtk("BINARY", "VECTORS speed float", &more.concat());
    let first = folder.read("a.vtk", &file);
    assert_eq!((&first.samples, first.frame.origin), (&Samples::U8(ramp()), DVec3::ZERO));
    assert_eq!(
        first.notes,
        ["of its 3 arrays `values` is read; `index` chooses another: `speed` is 1, `second one` is 2"]
    );
    let speed = folder.chosen("a.vtk", &file, 1, Some(2)).unwrap();
    assert_eq!(values(&speed)[..3], [2.0, 5.0, 8.0]);
    // A component asks for an array that has some.
    assert_eq!(values(&folder.chosen("a.vtk", &file, 0, Some(1)).unwrap())[..3], [1.0, 4.0, 7.0]);
    assert!(folder.chosen("a.vtk", &file, 3, None).unwrap_err().ends_with("its 3 volumes are 0 to 2"));
    assert!(
        folder.chosen("a.vtk", &file, 0, Some(3)).unwrap_err().ends_with("3 numbers of a voxel are 0 to 2")
    );
    // What is broken behind the array that is read does not matter, but is told.
    let broken = vtk("BINARY", SCALARS, &[&ramp()[..], b"\nNONSENSE 5\n"].concat());
    let read = folder.read("a.vtk", broken);
    assert!(read.notes[0].contains("what follows its first arrays is left out"), "{:?}", read.notes);
}

#[test]
fn cells_are_voxels_between_points() {
    let folder = Folder::new();
    let cells = text(&IMAGE.replace("2 3 4", "3 4 1"), &format!("CELL_DATA 6\n{SCALARS}"));
    let cells = folder.read("a.vtk", cells);
    assert_eq!((cells.size, cells.spacing), ([2, 3, 1], Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!((cells.frame.origin, cells.frame.space), (DVec3::new(5.5, 7.0, 7.0), Space::World));
}

#[test]
fn rectilinear_and_structured_grids_are_images_where_they_are_even() {
    let folder = Folder::new();
    let grid = |z: &str| {
        format!(
            "RECTILINEAR_GRID\nDIMENSIONS 2 3 4\nX_COORDINATES 2 float\n0 0.5\nY_COORDINATES 3 double\n1 0 -1\nZ_COORDINATES 4 int\n{z}"
        )
    };
    let data = format!("POINT_DATA 24\n{SCALARS}");
    let even = folder.read("a.vtk", text(&grid("7 9 11 13"), &data));
    assert_eq!((even.size, even.spacing), ([2, 3, 4], Vec3::new(0.5, 1.0, 2.0)));
    assert_eq!((even.frame.origin, even.sample([0, 2, 0])), (DVec3::new(0.0, -1.0, 7.0), Some(0.0)));
    assert!(even.notes[0].contains("its rectilinear grid is even"), "{:?}", even.notes);
    let uneven = folder.refusal("a.vtk", text(&grid("7 9 11 14"), &data));
    assert!(uneven.contains("its grid is not even along z: its coordinates are 2 to 3 apart"), "{uneven}");
    assert!(
        folder
            .refusal("a.vtk", text(&grid("7 9 11 13").replace("2 3 4", "2 3 5"), &data))
            .contains("Z_COORDINATES are 4; DIMENSIONS make 5")
    );
    let points = |bend: f32| -> Vec<u8> {
        let point = |index: u16| {
            let [x, y, z] = [index % 2, index / 2 % 3, index / 6].map(f32::from);
            let bend = if index == 20 { bend } else { 0.0 };
            [x * 0.6 - y * 0.8 + bend, x * 0.8 + y * 0.6, 4.0 + z].map(f32::to_be_bytes).concat()
        };
        let head = b"# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 3 4\nPOINTS 24 float\n";
        let points: Vec<u8> = (0..24).flat_map(point).collect();
        [head.as_slice(), &points, b"\nPOINT_DATA 24\n", SCALARS.as_bytes(), b"\n", &ramp()].concat()
    };
    let turned = folder.read("a.vtk", points(0.0));
    // The file's x is nearest to the world's y, and its y to -x.
    assert_eq!((turned.size, turned.sample([2, 1, 0])), ([3, 2, 4], Some(1.0)));
    assert!(is_at(place_of(&turned, [2, 1, 0]), [0.6, 0.8, 4.0]));
    assert!(turned.spacing.abs_diff_eq(Vec3::ONE, 1e-5) && turned.frame.space == Space::World);
    assert!(folder.refusal("a.vtk", points(0.1)).contains("not even along z: point 20"));
}

#[test]
fn colours_are_read_whole_and_tables_of_colours_are_labels() {
    let folder = Folder::new();
    let colours = |kind: &str, array: &str, data: &[u8]| {
        let file = vtk(kind, array, data);
        let Samples::Rgba8(colours) = folder.read("a.vtk", file).samples else { panic!("{array}") };
        colours
    };
    let bytes: Vec<u8> = (0..96).collect();
    assert_eq!(colours("BINARY", "COLOR_SCALARS c 4", &bytes)[1], [4, 5, 6, 7]);
    assert_eq!(
        colours("BINARY", "SCALARS c unsigned_char 3\nLOOKUP_TABLE default", &bytes)[1],
        [3, 4, 5, 255]
    );
    assert_eq!(colours("ASCII", "COLOR_SCALARS c 3", &b"0 0.5 1 ".repeat(24))[1], [0, 128, 255, 255]);
    let table = "\nLOOKUP_TABLE mine 24\n";
    let labelled = |name: &str, text: bool| {
        let array = format!("SCALARS l unsigned_char 1\nLOOKUP_TABLE {name}");
        let data = if text {
            [numbers(24).as_bytes(), table.as_bytes(), &b"0.2 0.4 1 0.6 ".repeat(24)].concat()
        } else {
            [&ramp()[..], table.as_bytes(), &[51, 102, 255, 153].repeat(24)].concat()
        };
        folder.read("a.vtk", vtk(if text { "ASCII" } else { "BINARY" }, &array, &data)).labels
    };
    for text in [true, false] {
        let labels = labelled("mine", text).unwrap().entries;
        assert_eq!((labels.len(), labels[5].value), (24, 5.0));
        let colour = labels[5].colour.unwrap();
        assert!(colour.iter().zip([0.2, 0.4, 1.0, 0.6]).all(|(a, b)| (a - b).abs() < 1e-6), "{colour:?}");
        assert_eq!(labelled("default", text), None);
    }
}

#[test]
fn numbers_are_read_however_they_are_written() {
    let folder = Folder::new();
    let read = |kind: &str, written: &str| {
        let array = format!("SCALARS s {kind} 1\nLOOKUP_TABLE default");
        let data = written.repeat(24);
        values(&folder.read("a.vtk", vtk("ASCII", &array, data.as_bytes())))[0]
    };
    assert!(read("float", "1.#QNAN ").is_nan());
    assert_eq!(read("double", "1.25D+01\r\n"), 12.5);
    assert_eq!(read("unsigned_char", "7.0 "), 7.0);
    let marked = [b"\xef\xbb\xbf".as_slice(), &vtk("BINARY", SCALARS, &ramp())].concat();
    assert_eq!(folder.read("a.vtk", marked).samples, Samples::U8(ramp()));
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
    assert!(with("POINT_DATA 24", "CELL_DATA 24").contains("CELL_DATA counts 24 cells; DIMENSIONS make 6"));
    assert!(with("2 3 4", "2 3").starts_with("a.vtk:5: expected three numbers after DIMENSIONS"));
    assert!(with("2 3 4", "1000000000 1000000000 1000000000").contains("limit"));
    assert!(with("2 3 4", "0 3 4").contains("every side"));
    assert!(with("1 2 3", "1 nan 3").contains("spacing 1 x NaN x 3"));
    assert!(with("unsigned_char", "long_double").contains("expected a type from char"));
    assert!(with("unsigned_char", "float").contains("need 96"));
    assert!(with("unsigned_char", "unsigned_char 2").contains("number 0 of 2 at each need 47"));
    assert!(with("POINT_DATA 24\n", "").contains("expected POINT_DATA in front of arrays, found `SCALARS`"));
    assert!(with("DIMENSIONS 2 3 4\n", "").contains("DIMENSIONS is missing in front of the data"));
    assert!(with("DATASET STRUCTURED_POINTS\n", "").contains("ends before its DATASET"));
    assert!(with(SCALARS, "NONSENSE").contains("expected a keyword of an even grid, found `NONSENSE`"));
    assert!(with("BINARY", "XML").starts_with("a.vtk:3: expected `ASCII` or `BINARY`"));
    assert!(with("LOOKUP_TABLE default", "").contains("expected `LOOKUP_TABLE default`"));
    assert!(
        folder
            .refusal("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n")
            .contains("ends before its point data")
    );
}

#[test]
fn damaged_headers_never_panic() {
    let file = vtk("BINARY", SCALARS, &ramp());
    mutate("a.vtk", &file, file.len());
    mutate("a.vtk", &vtk("ASCII", SCALARS, &b"12 ".repeat(24)), 250);
    let field =
        vtk("BINARY", "FIELD f 2\nnames 1 2 string\n\u{3}abc\u{1}d\nvalues 1 24 unsigned_char", &ramp());
    mutate("a.vtk", &field, field.len());
    let grid = "RECTILINEAR_GRID\nDIMENSIONS 2 3 4\nX_COORDINATES 2 float\n0 1\nY_COORDINATES 3 float\n0 1 2\nZ_COORDINATES 4 int\n0 1 2 3";
    let file = text(grid, &format!("POINT_DATA 24\n{SCALARS}"));
    mutate("a.vtk", file.as_bytes(), file.len());
    let points: String =
        (0..24).map(|index| format!("{} {} {}\n", index % 2, index / 2 % 3, index / 6)).collect();
    let grid = format!("STRUCTURED_GRID\nDIMENSIONS 2 3 4\nPOINTS 24 float\n{points}");
    let file = text(&grid, "POINT_DATA 24\nCOLOR_SCALARS c 1");
    mutate("a.vtk", file.as_bytes(), file.len());
}
