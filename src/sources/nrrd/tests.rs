#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples, Space,
    self_describing::tests::{Folder, gzip, is_at, mutate, place_of, values},
};
use glam::{DVec3, Vec3};
use std::io::Write;

fn nrrd(header: &str, data: &[u8]) -> Vec<u8> {
    [b"NRRD0004\n", header.as_bytes(), b"\n\n", data].concat()
}

const BYTES: &str = "type: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw";

fn ramp(count: u8) -> Vec<u8> {
    (0..count).collect()
}

#[test]
fn attached_detached_packed_and_written_out_are_the_same() {
    let folder = Folder::new();
    let raw = folder.read("a.nrrd", nrrd(BYTES, &ramp(24)));
    assert_eq!((raw.size, raw.spacing, &raw.samples), ([2, 3, 4], Vec3::ONE, &Samples::U8(ramp(24))));
    let with = |encoding: &str| BYTES.replace("raw", encoding);
    assert_eq!(folder.read("a.nrrd", nrrd(&with("gzip"), &gzip(&ramp(24)))), raw);
    let mut bzip2 = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    bzip2.write_all(&ramp(24)).unwrap();
    assert_eq!(folder.read("a.nrrd", nrrd(&with("bzip2"), &bzip2.finish().unwrap())), raw);
    let header = String::from_utf8(nrrd(BYTES, b"")).unwrap().replace('\n', "\r\n");
    let windows = [b"\xef\xbb\xbf", header.as_bytes(), &ramp(24)];
    assert_eq!(folder.read("a.nrrd", windows.concat()), raw);
    let text: Vec<String> = ramp(24).iter().map(u8::to_string).collect();
    assert_eq!(folder.read("a.nrrd", nrrd(&with("ascii"), text.join(" ").as_bytes())), raw);
    let skipped = format!("note {}", text.join(" "));
    let skipping = format!("{}\nbyte skip: 5", with("ascii"));
    assert_eq!(folder.read("a.nrrd", nrrd(&skipping, skipped.as_bytes())), raw);
    let hex: String = ramp(24).iter().map(|byte| format!("{byte:02X}\n")).collect();
    assert_eq!(folder.read("a.nrrd", nrrd(&with("hex"), hex.as_bytes())), raw);
    folder.file("a.bin", ramp(24));
    assert_eq!(folder.read("a.nhdr", nrrd(&format!("{BYTES}\ndata file: a.bin"), b"")), raw);
    for part in 0..4_u8 {
        folder.file(&format!("s{:02}.bin", part + 1), &ramp(24)[usize::from(part) * 6..][..6]);
    }
    assert_eq!(folder.read("a.nhdr", nrrd(&format!("{BYTES}\ndata file: s%02d.bin 1 4 1 2"), b"")), raw);
    let list = format!("{BYTES}\ndata file: LIST\ns01.bin\ns02.bin\ns03.bin\ns04.bin");
    assert_eq!(folder.read("a.nhdr", format!("NRRD0004\n{list}")), raw);
    // Line skips come first, then byte skips, or all but the end.
    let skipped = [b"one\ntwo\nab".as_slice(), &ramp(24)].concat();
    folder.file("a.bin", &skipped);
    let skip = |skip: &str| folder.read("a.nhdr", nrrd(&format!("{BYTES}\ndata file: a.bin\n{skip}"), b""));
    assert_eq!(skip("line skip: 2\nbyte skip: 2"), raw);
    assert_eq!(skip("byte skip: -1"), raw);
}

#[test]
fn every_sample_type_is_read_in_both_byte_orders() {
    let folder = Folder::new();
    let check = |name: &str, little: &[u8], expected: Samples| {
        let mut big = little.to_vec();
        let bytes = little.len() / 2;
        big.chunks_exact_mut(bytes).for_each(<[u8]>::reverse);
        for (endian, data) in [("little", little), ("big", &big)] {
            let header = format!("type: {name}\ndimension: 1\nsizes: 2\nencoding: raw\nendian: {endian}");
            let volume = folder.read("a.nrrd", nrrd(&header, data));
            assert_eq!((volume.size, &volume.samples), ([2, 1, 1], &expected), "{name} {endian}");
        }
    };
    check("int8", &[0xff, 5], Samples::I8(vec![-1, 5]));
    check("uint8", &[255, 5], Samples::U8(vec![255, 5]));
    check("short", &[[0xfe, 0xff], [1, 2]].concat(), Samples::I16(vec![-2, 513]));
    check("unsigned short", &[[0xfe, 0xff], [1, 2]].concat(), Samples::U16(vec![65534, 513]));
    check(
        "int",
        &[(-70000_i32).to_le_bytes(), 3_i32.to_le_bytes()].concat(),
        Samples::F32(vec![-70000.0, 3.0]),
    );
    check("uint32", &[300_u32.to_le_bytes(), 3_u32.to_le_bytes()].concat(), Samples::U16(vec![300, 3]));
    check("longlong", &[(-3_i64).to_le_bytes(), 3_i64.to_le_bytes()].concat(), Samples::I8(vec![-3, 3]));
    check("uint64_t", &[3_u64.to_le_bytes(), 4_u64.to_le_bytes()].concat(), Samples::U8(vec![3, 4]));
    check("float", &[0.5_f32.to_le_bytes(), 4_f32.to_le_bytes()].concat(), Samples::F32(vec![0.5, 4.0]));
    check(
        "double",
        &[0.5_f64.to_le_bytes(), 1e300_f64.to_le_bytes()].concat(),
        Samples::F32(vec![0.5, f32::INFINITY]),
    );
}

#[test]
fn axes_follow_their_directions() {
    let folder = Folder::new();
    let read = |more: &str| folder.read("a.nrrd", nrrd(&format!("{BYTES}\n{more}"), &ramp(24)));
    assert_eq!(read("spacings: 0.5 1 2").spacing, Vec3::new(0.5, 1.0, 2.0));
    let metres = read(
        "space: 3D-right-handed\nspace units: \"m\" \"m\" \"m\"\nspace directions: (1,0,0) (0,1,0) (0,0,2)",
    );
    assert_eq!((metres.spacing, metres.notes.len()), (Vec3::new(1000.0, 1000.0, 2000.0), 0));
    let lps = read("space: left-posterior-superior\nspace directions: (1, 0, 0) (0, 1, 0) (0, 0, 3)");
    assert_eq!((lps.sample([0, 0, 0]), lps.spacing), (Some(5.0), Vec3::new(1.0, 1.0, 3.0)));
    assert!(lps.notes[0].contains("left, posterior, superior"), "{:?}", lps.notes);
    let turned = read("space dimension: 3\nspace directions: (0,0,1) (2,0,0) (0,-3,0)");
    assert_eq!((turned.size, turned.spacing), ([3, 4, 2], Vec3::new(2.0, 3.0, 1.0)));
    assert_eq!(turned.sample([1, 0, 1]), Some(f32::from(1_u8 + 2 + 3 * 6)));
    let oblique = read("space dimension: 3\nspace directions: (3,4,0) (-4,3,0) (0,0,1)");
    assert!(oblique.frame.degrees_off() > 1.0, "{:?}", oblique.frame);
}

/// A file of bytes 0 to 23 with axes of these sizes and kinds.
fn of(sizes: &str, kinds: &str, more: &str) -> Vec<u8> {
    let count = sizes.split(' ').count();
    let kinds = if kinds.is_empty() { String::new() } else { format!("\nkinds: {kinds}") };
    nrrd(&format!("type: uchar\ndimension: {count}\nsizes: {sizes}{kinds}\nencoding: raw{more}"), &ramp(24))
}

#[test]
fn one_of_several_volumes_is_read_whichever_axis_they_lie_along() {
    let folder = Folder::new();
    let last = of("2 3 2 2", "domain domain domain time", "");
    let times = folder.read("a.nrrd", &last);
    assert_eq!((times.size, times.samples), ([2, 3, 2], Samples::U8(ramp(12))));
    assert_eq!(
        times.notes,
        ["it holds 2 volumes (axis 4, time); number 0, counted from 0, is read: `index` chooses"]
    );
    let second = folder.chosen("a.nrrd", &last, 1, None).unwrap();
    assert_eq!(values(&second), (12..24).map(|value| value as f32).collect::<Vec<_>>());
    let refused = folder.chosen("a.nrrd", &last, 2, None).unwrap_err();
    assert!(refused.ends_with("index is 2, but its 2 volumes are 0 to 1"), "{refused}");
    let first = of("2 3 2 2", "list domain domain domain", "");
    let second = folder.chosen("a.nrrd", &first, 1, None).unwrap();
    assert_eq!((second.size, second.sample([1, 0, 0])), ([3, 2, 2], Some(3.0)));
    let within =
        of("3 2 2 2", "domain list domain domain", "\nspace directions: (1,0,0) none (0,1,0) (0,0,1)");
    let second = folder.chosen("a.nrrd", &within, 1, None).unwrap();
    assert_eq!((second.size, values(&second)[..4].to_vec()), ([3, 2, 2], vec![3.0, 4.0, 5.0, 9.0]));
    // Vectors with a component for time, as ITK writes them, and vectors of nan.
    for none in ["none", "(nan,nan,nan,nan)", "(0,0,0,2.5)"] {
        let vectors =
            format!("\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,3,0) {none}\nspace origin: (1,2,3,0)");
        let itk = folder.chosen("a.nrrd", of("2 3 2 2", "", &vectors), 1, None).unwrap();
        assert_eq!(
            (itk.size, itk.spacing, itk.sample([0; 3])),
            ([2, 3, 2], Vec3::new(1.0, 1.0, 3.0), Some(12.0))
        );
    }
    let text = "type: uchar\ndimension: 4\nsizes: 2 1 2 2\nencoding: ascii\nkinds: list domain domain domain";
    let written = folder.chosen("a.nrrd", nrrd(text, b"0 1 2 3 4 5 6 7"), 1, None).unwrap();
    assert_eq!(values(&written), [1.0, 3.0, 5.0, 7.0]);
    let short = folder.chosen("a.nrrd", nrrd(text, b"0 1 2"), 1, None).unwrap_err();
    assert!(short.contains("3 numbers; 1 x 2 x 2 voxels of 1 byte, entry 1 of 2 need 8 (5 fewer"), "{short}");
    let kept = folder.read("a.nrrd", of("1 6 4", "list domain domain", ""));
    assert_eq!((kept.size, kept.notes.len()), ([6, 4, 1], 0));
    // Each volume in a file of its own: only that of the one that is asked for is needed.
    folder.file("t1.raw", &ramp(24)[12..]);
    let detached = of("2 3 2 2", "", "\ndata file: t%d.raw 0 1 1");
    assert_eq!(folder.chosen("a.nhdr", &detached, 1, None).unwrap().sample([0; 3]), Some(12.0));
    assert!(folder.refusal("a.nhdr", &detached).contains("t0.raw: no such file"));
}

#[test]
fn numbers_of_a_voxel_are_colours_or_chosen() {
    let folder = Folder::new();
    let vectors = of("3 2 2 2", "vector domain domain domain", "");
    let component = |component| folder.chosen("a.nrrd", &vectors, 0, Some(component));
    assert_eq!(values(&component(2).unwrap())[..3], [2.0, 5.0, 8.0]);
    assert!(component(3).unwrap_err().ends_with("component is 3, but the 3 numbers of a voxel are 0 to 2"));
    let first = folder.read("a.nrrd", &vectors);
    assert_eq!(
        (values(&first)[1], &*first.notes[0]),
        (
            3.0,
            "each voxel has 3 numbers (axis 1, vector); number 0, counted from 0, is read: `component` chooses"
        )
    );
    let interleaved = of("3 2 2 2", "RGB-color domain domain domain", "");
    let colours = folder.read("a.nrrd", &interleaved);
    let Samples::Rgba8(colours) = &colours.samples else { panic!("{:?}", colours.samples) };
    assert_eq!((colours.len(), colours[1]), (8, [3, 4, 5, 255]));
    assert_eq!(values(&folder.chosen("a.nrrd", &interleaved, 0, Some(1)).unwrap())[..2], [1.0, 4.0]);
    let planes = folder.read("a.nrrd", of("2 3 4", "domain domain RGBA-color", ""));
    assert_eq!(
        (planes.size, &planes.samples),
        ([2, 3, 1], &Samples::Rgba8((0..6).map(|i| [i, i + 6, i + 12, i + 18]).collect()))
    );
    // Nothing says what an axis is: few numbers that alternate are those of a voxel.
    let guessed = nrrd("type: uchar\ndimension: 4\nsizes: 2 2 2 6\nencoding: raw", &ramp(48));
    let guessed = folder.chosen("a.nrrd", guessed, 0, Some(1)).unwrap();
    assert_eq!((guessed.size, guessed.sample([1, 0, 0])), ([2, 2, 6], Some(3.0)));
}

#[test]
fn voxels_lie_where_the_header_says() {
    let folder = Folder::new();
    let read = |more: &str| folder.read("a.nrrd", nrrd(&format!("{BYTES}\n{more}"), &ramp(24)));
    let oblique = "space directions: (0.8,0.6,0) (-1.2,1.6,0) (0,0,3)\nspace origin: (10,-20,30)";
    // Left, posterior, superior: the file's x and y count the other way.
    let lps = read(&format!("space: left-posterior-superior\n{oblique}"));
    assert_eq!(lps.frame.space, Space::Patient);
    for (voxel, value) in [([1, 2, 0], 0.0), ([0, 2, 0], 1.0), ([1, 0, 3], 22.0)] {
        assert_eq!(lps.sample(voxel), Some(value));
    }
    assert!(is_at(place_of(&lps, [1, 2, 0]), [-10.0, 20.0, 30.0]));
    assert!(is_at(place_of(&lps, [0, 2, 0]), [-10.8, 19.4, 30.0]));
    assert!(is_at(place_of(&lps, [1, 0, 3]), [-10.0 + 2.4, 20.0 - 3.2, 39.0]));
    let metres = read(&format!("space: RAS\nspace units: \"m\" \"m\" \"m\"\n{oblique}"));
    assert!(is_at(place_of(&metres, [0; 3]), [10e3, -20e3, 30e3]));
    let world = read(&format!("space: 3D-right-handed\n{oblique}"));
    assert_eq!((world.frame.space, world.frame.origin), (Space::World, DVec3::new(10.0, -20.0, 30.0)));
    assert!(read(&format!("space: 3D-left-handed\n{oblique}")).notes[0].contains("shown mirrored"));
    assert_eq!(read("spacings: 1 1 1").frame.space, Space::Unknown);
    // Ends of cells, or of what lies between samples.
    let ends = "axis mins: 0 nan -2\naxis maxs: 6 nan 2";
    let cells = read(ends);
    assert_eq!((cells.spacing, cells.frame.origin), (Vec3::new(3.0, 1.0, 1.0), DVec3::new(1.5, 0.0, -1.5)));
    let nodes = read(&format!("{ends}\ncenterings: node node node"));
    assert_eq!((nodes.spacing.x, nodes.frame.origin), (6.0, DVec3::new(0.0, 0.0, -2.0)));
    assert_eq!(nodes.frame.space, Space::World);
    let unknown = read("spacings: nan 1 3");
    assert_eq!(unknown.spacing, Vec3::new(1.0, 1.0, 3.0));
    assert_eq!(unknown.notes, ["its spacing along axis 1 is unknown (nan); 1 is taken"]);
}

#[test]
fn segments_of_slicer_are_labels() {
    let folder = Folder::new();
    let segment = |number: u32, value: u32, layer: u32, name: &str| {
        format!(
            "\nSegment{number}_LabelValue:={value}\nSegment{number}_Layer:={layer}\nSegment{number}_Name:={name}\nSegment{number}_Color:=0.5 0.25 1"
        )
    };
    let segments =
        [segment(0, 1, 0, "bone"), segment(1, 2, 0, "skin"), segment(2, 1, 1, "a vessel")].concat();
    let file = of("2 3 2 2", "list domain domain domain", &segments);
    let labels = |index| folder.chosen("a.seg.nrrd", &file, index, None).unwrap().labels.unwrap().entries;
    let names = |index| labels(index).into_iter().map(|label| (label.value, label.name)).collect::<Vec<_>>();
    assert_eq!(names(0), [(1.0, "bone".to_owned()), (2.0, "skin".to_owned())]);
    assert_eq!(names(1), [(1.0, "a vessel".to_owned())]);
    assert_eq!(labels(1)[0].colour, Some([0.5, 0.25, 1.0, 1.0]));
    assert_eq!(folder.read("a.nrrd", nrrd(BYTES, &ramp(24))).labels, None);
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let folder = Folder::new();
    let refused = |header: &str| folder.refusal("a.nrrd", nrrd(header, &ramp(24)));
    let with = |old: &str, new: &str| refused(&BYTES.replace(old, new));
    assert!(
        with("2 3 4", "2 3 5")
            .contains("24 bytes after its header; 2 x 3 x 5 voxels of 1 byte need 30 (6 fewer")
    );
    assert!(with("2 3 4", "1000000000 1000000000 1000000000").contains("limit"));
    assert!(with("2 3 4", "99999999999 1 1").contains("limit"));
    assert!(with("2 3 4", "0 3 4").contains("every side needs at least 1"));
    assert!(with("2 3 4", "2 3 x").starts_with("a.nrrd:4: sizes: expected whole numbers"));
    assert!(with("2 3 4", "2 3").starts_with("a.nrrd:3: dimension: expected the count of `sizes`, 2"));
    assert!(with("uchar", "block").starts_with("a.nrrd:2: type: expected int8 to uint64"));
    assert!(with("uchar", "short").contains("endian: it is missing from the header"));
    assert!(with("raw", "bzip2").contains("the bzip2 stream is corrupt"));
    assert!(with("raw", "zstd").contains("expected raw, gzip, bzip2, ascii or hex"));
    assert!(with("raw", "gzip").contains("the gzip stream is corrupt"));
    assert!(with("raw", "ascii").contains("sample 1: expected a number of type U8"));
    assert!(with("raw", "hex").contains("corrupt (expected a hexadecimal digit)"));
    assert!(with("encoding: raw", "").contains("encoding: it is missing"));
    assert!(refused(&format!("{BYTES}\nspacings: 1 inf 1")).contains("spacing 1 x inf x 1 mm"));
    assert!(
        refused(&format!("{BYTES}\nspace directions: (1,0,0) (1,0,0) (0,0,1)")).contains("lie in a plane")
    );
    assert!(refused(&format!("{BYTES}\ndata file: none.raw")).contains("none.raw: no such file"));
    assert!(
        refused(&format!("{BYTES}\ndata file: s%d 1 99999999999 1"))
            .contains("expected 1 to 65536 data files")
    );
    assert!(refused(&format!("{BYTES}\ndata file: s%d 1 5 1")).contains("do not divide by 5 data files"));
    assert!(refused(&"x".repeat(100_000)).contains("goes on and on"));
}

#[test]
fn a_small_file_that_unpacks_to_much_takes_no_more_than_its_size() {
    let folder = Folder::new();
    let packed = gzip(&vec![0; 64 << 20]);
    let bomb = nrrd(&BYTES.replace("raw", "gzip"), &packed);
    let volume = folder.read("a.nrrd", &bomb);
    assert_eq!((volume.size, volume.notes.len()), ([2, 3, 4], 1));
    let liar = nrrd(&BYTES.replace("raw", "gzip").replace("2 3 4", "2000 2000 2000"), &gzip(&ramp(24)));
    assert!(folder.refusal("a.nrrd", liar).contains("24 unpacked bytes"));
}

#[test]
fn damaged_headers_never_panic() {
    let header = format!(
        "{BYTES}\nspace: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,3)\nkinds: domain domain domain"
    );
    let file = nrrd(&header, &ramp(24));
    mutate("a.nrrd", &file, file.len() - 24);
    let file =
        nrrd(&format!("{}\ndata file: a%d.raw 1 3 1\nbyte skip: 0", BYTES.replace("raw", "gzip")), b"");
    mutate("a.nhdr", &file, file.len());
}
