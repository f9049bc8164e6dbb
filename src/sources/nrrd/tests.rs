#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples,
    self_describing::tests::{Folder, gzip, mutate, values},
};
use glam::Vec3;

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
    let text: Vec<String> = ramp(24).iter().map(u8::to_string).collect();
    assert_eq!(folder.read("a.nrrd", nrrd(&with("ascii"), text.join(" ").as_bytes())), raw);
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

#[test]
fn axes_that_are_no_space_are_the_first_entry_or_refused() {
    let folder = Folder::new();
    let of = |sizes: &str, kinds: &str| {
        let count = sizes.split(' ').count();
        nrrd(
            &format!("type: uchar\ndimension: {count}\nsizes: {sizes}\nkinds: {kinds}\nencoding: raw"),
            &ramp(24),
        )
    };
    let times = folder.read("a.nrrd", of("2 3 2 2", "domain domain domain time"));
    assert_eq!((times.size, values(&times).len()), ([2, 3, 2], 12));
    assert_eq!(times.notes, ["only the first of the 2 entries of axis 4 (time) is read"]);
    let colours = folder.refusal("a.nrrd", of("3 2 2 2", "3-color domain domain domain"));
    assert!(
        colours.contains("3 numbers at each place (axis 1, 3-color); choose one: `unu slice -a 0"),
        "{colours}"
    );
    assert_eq!(folder.read("a.nrrd", of("1 6 4", "list domain domain")).size, [6, 4, 1]);
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
    assert!(with("raw", "bzip2").contains("bzip2, is not read; pack it with gzip"));
    assert!(with("raw", "gzip").contains("the gzip stream is corrupt"));
    assert!(with("raw", "ascii").contains("sample 1: expected a number of type U8"));
    assert!(with("raw", "hex").contains("corrupt (expected a hexadecimal digit)"));
    assert!(with("encoding: raw", "").contains("encoding: it is missing"));
    assert!(refused(&format!("{BYTES}\nspacings: 1 nan 1")).contains("spacing 1 x NaN x 1 mm"));
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
