#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples, Space,
    self_describing::tests::{Folder, is_at, mutate, place_of, zlib},
};
use glam::{DVec3, Vec3};

const HEAD: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\n";

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

fn local(head: &str, data: &[u8]) -> Vec<u8> {
    [head.as_bytes(), b"ElementDataFile = LOCAL\n", data].concat()
}

#[test]
fn local_detached_packed_and_listed_are_the_same() {
    let folder = Folder::new();
    let volume = folder.read("a.mha", local(HEAD, &ramp()));
    assert_eq!((volume.size, volume.spacing, &volume.samples), ([2, 3, 4], Vec3::ONE, &Samples::U8(ramp())));
    let packed = format!("{HEAD}CompressedData = True\nCompressedDataSize = 9\n");
    assert_eq!(folder.read("a.mha", local(&packed, &zlib(&ramp()))), volume);
    folder.file("a.raw", [b"header".as_slice(), &ramp()].concat());
    for size in [6, -1] {
        let header = format!("{HEAD}HeaderSize = {size}\nElementDataFile = a.raw\n");
        assert_eq!(folder.read("a.mhd", header), volume, "{size}");
    }
    for part in 0..4 {
        folder.file(&format!("s{part}"), &ramp()[part * 6..][..6]);
    }
    assert_eq!(folder.read("a.mhd", format!("{HEAD}ElementDataFile = s%d 0 3 1\n")), volume);
    assert_eq!(folder.read("a.mhd", format!("{HEAD}ElementDataFile = LIST\ns0\ns1\ns2\ns3\n")), volume);
    let text: Vec<String> = ramp().iter().map(u8::to_string).collect();
    let header = format!("{HEAD}BinaryData = False\n");
    assert_eq!(folder.read("a.mha", local(&header, text.join(" ").as_bytes())), volume);
}

#[test]
fn types_byte_order_spacing_and_directions_are_kept() {
    let folder = Folder::new();
    let read = |kind: &str, data: &[u8]| {
        let head = format!("NDims = 1\nDimSize = 1\nElementType = {kind}\nElementByteOrderMSB = True\n");
        folder.read("a.mha", local(&head, data)).samples.get(0).unwrap()
    };
    assert_eq!(read("MET_CHAR", &[0xff]), -1.0);
    assert_eq!(read("MET_SHORT", &(-300_i16).to_be_bytes()), -300.0);
    assert_eq!(read("MET_USHORT", &60000_u16.to_be_bytes()), 60000.0);
    assert_eq!(read("MET_LONG", &(-70000_i32).to_be_bytes()), -70000.0);
    assert_eq!(read("MET_UINT", &70000_u32.to_be_bytes()), 70000.0);
    assert_eq!(read("MET_LONG_LONG", &(-5_i64).to_be_bytes()), -5.0);
    assert_eq!(read("MET_ULONG_LONG", &5_u64.to_be_bytes()), 5.0);
    assert_eq!(read("MET_FLOAT", &0.5_f32.to_be_bytes()), 0.5);
    assert_eq!(read("MET_DOUBLE", &0.5_f64.to_be_bytes()), 0.5);
    let flipped = format!("{HEAD}ElementSpacing = 1 2 3\nTransformMatrix = -1 0 0 0 1 0 0 0 1\n");
    let volume = folder.read("a.mha", local(&flipped, &ramp()));
    assert_eq!((volume.spacing, volume.sample([0, 0, 0])), (Vec3::new(1.0, 2.0, 3.0), Some(1.0)));
    assert!(volume.notes[0].contains("-x, +y, +z"), "{:?}", volume.notes);
    let medical = format!("{HEAD}AnatomicalOrientation = RAI\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n");
    let volume = folder.read("a.mha", local(&medical, &ramp()));
    assert!(volume.notes[0].contains("left, posterior, superior"), "{:?}", volume.notes);
}

#[test]
fn channels_are_colours_or_chosen_and_so_is_one_of_several_volumes() {
    let folder = Folder::new();
    let of = |size: &str, more: &str| {
        let count = size.split(' ').count();
        local(&format!("NDims = {count}\nDimSize = {size}\nElementType = MET_UCHAR\n{more}"), &ramp())
    };
    let rgb = of("2 2 2", "ElementNumberOfChannels = 3\n");
    let Samples::Rgba8(colours) = folder.read("a.mha", &rgb).samples else { panic!() };
    assert_eq!((colours.len(), colours[7]), (8, [21, 22, 23, 255]));
    assert_eq!(folder.chosen("a.mha", &rgb, 0, Some(2)).unwrap().sample([1, 0, 0]), Some(5.0));
    let pairs = of("2 3 2", "ElementNumberOfChannels = 2\n");
    assert_eq!(folder.read("a.mha", &pairs).sample([1, 0, 0]), Some(2.0));
    let times = of("2 3 2 2", "ElementSpacing = 1 2 3 4\nOffset = 5 6 7 8\n");
    let second = folder.chosen("a.mha", &times, 1, None).unwrap();
    assert_eq!((second.sample([0; 3]), second.frame.origin), (Some(12.0), DVec3::new(5.0, 6.0, 7.0)));
    assert!(folder.chosen("a.mha", &times, 2, None).unwrap_err().ends_with("its 2 volumes are 0 to 1"));
}

#[test]
fn voxels_lie_where_the_header_says() {
    let folder = Folder::new();
    let read = |more: &str| folder.read("a.mha", local(&format!("{HEAD}{more}"), &ramp()));
    assert_eq!(read("").frame.space, Space::Unknown);
    let placed = "Offset = 10 -20 30\nElementSpacing = 1 2 3\nTransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\n";
    let world = read(placed);
    assert_eq!((world.frame.space, world.frame.origin), (Space::World, DVec3::new(10.0, -20.0, 30.0)));
    assert!(is_at(place_of(&world, [1, 2, 3]), [10.0 + 0.8 - 2.4, -20.0 + 0.6 + 3.2, 39.0]));
    // ITK's world is left, posterior, superior.
    let patient = read(&format!("{placed}AnatomicalOrientation = RAI\nDistanceUnits = cm\n"));
    assert_eq!((patient.frame.space, patient.sample([1, 2, 0])), (Space::Patient, Some(0.0)));
    assert!(is_at(place_of(&patient, [1, 2, 0]), [-100.0, 200.0, 300.0]));
    assert!(is_at(place_of(&patient, [0, 2, 0]), [-108.0, 194.0, 300.0]));
}

#[test]
fn headers_from_windows_are_read() {
    let folder = Folder::new();
    folder.file("vol.raw", ramp());
    let header = format!("\u{feff}{HEAD}ElementDataFile = C:\\scans\\vol.raw\n").replace('\n', "\r\n");
    let volume = folder.read("a.mhd", header);
    assert_eq!(volume.samples, Samples::U8(ramp()));
    assert_eq!(
        volume.notes,
        ["its header names `C:\\scans\\vol.raw`, which is no file here; `vol.raw` beside it is read"]
    );
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let folder = Folder::new();
    let with = |old: &str, new: &str| folder.refusal("a.mha", local(&HEAD.replace(old, new), &ramp()));
    assert!(with("2 3 4", "2 3 5").contains("24 bytes after its header; 2 x 3 x 5 voxels of 1 byte need 30"));
    assert!(with("2 3 4", "1000000000 1000000000 1000000000").contains("limit"));
    assert!(with("2 3 4", "2 0 4").contains("every side"));
    assert!(with("2 3 4", "2 3").starts_with("a.mha:2: NDims: expected the count of `DimSize`"));
    assert!(with("MET_UCHAR", "MET_UCHAR_ARRAY").starts_with("a.mha:4: ElementType: expected MET_CHAR"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nElementSpacing = 1 nan 1").contains("spacing 1 x NaN x 1"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nElementNumberOfChannels = 0").contains("expected a number from 1"));
    assert!(
        with("MET_UCHAR", "MET_UCHAR\nElementNumberOfChannels = 2")
            .contains("voxels of 1 byte, number 0 of 2 at each need 47")
    );
    assert!(with("MET_UCHAR", "MET_UCHAR\nDistanceUnits = feet").contains("expected um, mm, cm or m"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nCompressedData = True").contains("the zlib stream is corrupt"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nHeaderSize = -7").contains("expected bytes from 0, or -1"));
    assert!(folder.refusal("a.mhd", HEAD).contains("ElementDataFile: it is missing"));
    assert!(
        folder.refusal("a.mhd", format!("{HEAD}ElementDataFile = b.raw")).contains("b.raw: no such file")
    );
    assert!(folder.refusal("a.mhd", "nothing").contains("no line such as"));
}

#[test]
fn damaged_headers_never_panic() {
    let head =
        format!("{HEAD}ElementSpacing = 1 2 3\nTransformMatrix = -1 0 0 0 1 0 0 0 1\nHeaderSize = 0\n");
    let file = local(&head, &ramp());
    mutate("a.mha", &file, file.len() - 24);
    let file = local(&format!("{HEAD}CompressedData = True\n"), &zlib(&ramp()));
    mutate("a.mha", &file, file.len());
}
