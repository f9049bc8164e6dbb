#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples,
    self_describing::tests::{Folder, mutate, zlib},
};
use glam::Vec3;

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
fn what_is_wrong_is_told_with_its_line() {
    let folder = Folder::new();
    let with = |old: &str, new: &str| folder.refusal("a.mha", local(&HEAD.replace(old, new), &ramp()));
    assert!(with("2 3 4", "2 3 5").contains("24 bytes after its header; 2 x 3 x 5 voxels of 1 byte need 30"));
    assert!(with("2 3 4", "1000000000 1000000000 1000000000").contains("limit"));
    assert!(with("2 3 4", "2 0 4").contains("every side"));
    assert!(with("2 3 4", "2 3").starts_with("a.mha:2: NDims: expected the count of `DimSize`"));
    assert!(with("MET_UCHAR", "MET_UCHAR_ARRAY").starts_with("a.mha:4: ElementType: expected MET_CHAR"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nElementSpacing = 1 nan 1").contains("spacing 1 x NaN x 1"));
    assert!(with("MET_UCHAR", "MET_UCHAR\nElementNumberOfChannels = 3").contains("split the channels"));
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
