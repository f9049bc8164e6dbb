#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Labels, Samples, Space,
    self_describing::tests::{Folder, gzip, is_at, mutate, place_of, values},
};
use super::*;
use glam::Vec3;

/// A header that can be written in either version and byte order.
struct Nifti {
    is_2: bool,
    big: bool,
    bytes: Vec<u8>,
}

impl Nifti {
    fn new(is_2: bool, big: bool, dims: &[i64], datatype: i16) -> Self {
        let mut nifti = Self { is_2, big, bytes: vec![0; if is_2 { 544 } else { 352 }] };
        nifti.put(0, &(if is_2 { 540_i32 } else { 348 }).to_le_bytes());
        let magic: &[u8] = if is_2 { b"n+2\0\r\n\x1a\n" } else { b"n+1\0" };
        let at = if is_2 { 4 } else { 344 };
        nifti.bytes[at..at + magic.len()].copy_from_slice(magic);
        for (index, dim) in [dims.len() as i64].iter().chain(dims).enumerate() {
            if is_2 {
                nifti.put(16 + 8 * index, &dim.to_le_bytes());
            } else {
                nifti.put(40 + 2 * index, &(*dim as i16).to_le_bytes());
            }
        }
        nifti.put(if is_2 { 12 } else { 70 }, &datatype.to_le_bytes());
        nifti.floats(76, 104, &[1.0, 1.0, 1.0, 1.0]);
        nifti
    }

    fn put(&mut self, at: usize, bytes: &[u8]) {
        let mut bytes = bytes.to_vec();
        if self.big {
            bytes.reverse();
        }
        self.bytes[at..at + bytes.len()].copy_from_slice(&bytes);
    }

    fn floats(&mut self, at_1: usize, at_2: usize, values: &[f64]) {
        for (index, value) in values.iter().enumerate() {
            if self.is_2 {
                self.put(at_2 + 8 * index, &value.to_le_bytes());
            } else {
                self.put(at_1 + 4 * index, &(*value as f32).to_le_bytes());
            }
        }
    }

    fn sform(&mut self, rows: [[f64; 4]; 3]) {
        self.put(if self.is_2 { 348 } else { 254 }, &1_i16.to_le_bytes());
        if self.is_2 {
            self.put(348, &1_i32.to_le_bytes());
        }
        self.floats(280, 400, &rows.concat());
    }

    fn with(&self, data: &[u8]) -> Vec<u8> {
        [&self.bytes, data].concat()
    }
}

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

#[test]
fn both_versions_are_read_in_both_byte_orders_packed_or_not() {
    let folder = Folder::new();
    for (is_2, big) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut nifti = Nifti::new(is_2, big, &[2, 3, 4], 2);
        nifti.floats(76, 104, &[1.0, 0.5, 1.0, 2.0]);
        let volume = folder.read("a.nii", nifti.with(&ramp()));
        assert_eq!((volume.size, volume.spacing), ([2, 3, 4], Vec3::new(0.5, 1.0, 2.0)), "{is_2} {big}");
        assert_eq!(volume.samples, Samples::U8(ramp()));
        assert_eq!(folder.read("a.nii.gz", gzip(&nifti.with(&ramp()))), volume);
    }
    let mut pair = Nifti::new(false, false, &[2, 3, 4], 2);
    pair.bytes[344..348].copy_from_slice(b"ni1\0");
    folder.file("b.img", ramp());
    assert_eq!(folder.read("b.hdr", &pair.bytes).samples, Samples::U8(ramp()));
    assert_eq!(
        read(&folder.path("b.hdr"), &Selection::default()).unwrap(),
        crate::sources::read_volume(&folder.path("b.img"), &Selection::default()).unwrap()
    );
}

#[test]
fn every_sample_type_is_read() {
    let folder = Folder::new();
    for big in [false, true] {
        let read = |datatype, number: &[u8]| {
            let mut number = number.to_vec();
            if big {
                number.reverse();
            }
            values(&folder.read("a.nii", Nifti::new(false, big, &[1], datatype).with(&number)))[0]
        };
        assert_eq!(read(2, &[200]), 200.0);
        assert_eq!(read(256, &[200]), -56.0);
        assert_eq!(read(4, &(-300_i16).to_le_bytes()), -300.0);
        assert_eq!(read(512, &60000_u16.to_le_bytes()), 60000.0);
        assert_eq!(read(8, &(-70000_i32).to_le_bytes()), -70000.0);
        assert_eq!(read(768, &70000_u32.to_le_bytes()), 70000.0);
        assert_eq!(read(1024, &(-7_i64).to_le_bytes()), -7.0);
        assert_eq!(read(1280, &(1_u64 << 40).to_le_bytes()), 1_099_511_627_776.0);
        assert_eq!(read(16, &0.25_f32.to_le_bytes()), 0.25);
        assert_eq!(read(64, &0.25_f64.to_le_bytes()), 0.25);
    }
}

#[test]
fn the_affine_turns_the_volume_and_scaling_applies() {
    let folder = Folder::new();
    let mut nifti = Nifti::new(false, false, &[2, 3, 4], 2);
    nifti.sform([[-2.0, 0.0, 0.0, 9.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]]);
    let volume = folder.read("a.nii", nifti.with(&ramp()));
    assert_eq!((volume.spacing, volume.sample([0, 0, 0])), (Vec3::new(2.0, 3.0, 4.0), Some(1.0)));
    assert!(volume.notes[0].contains("left, anterior, superior"), "{:?}", volume.notes);
    // The qform: half a turn about z, and the third axis reversed.
    let mut nifti = Nifti::new(true, false, &[2, 3, 4], 2);
    nifti.put(344, &1_i32.to_le_bytes());
    nifti.floats(256, 352, &[0.0, 0.0, 1.0]);
    nifti.floats(76, 104, &[-1.0, 1.0, 1.0, 1.0]);
    nifti.put(500, &3_i32.to_le_bytes());
    let volume = folder.read("a.nii", nifti.with(&ramp()));
    assert_eq!((volume.spacing, volume.sample([0, 0, 0])), (Vec3::splat(1e-3), Some(23.0)));
    // Half a turn about a diagonal, as it is rounded to 32 bits: exactly that.
    nifti.floats(256, 352, &[0.707_106_77, 0.707_106_77, 0.0]);
    assert!(folder.read("a.nii", nifti.with(&ramp())).frame.degrees_off() < 1e-3);
    let mut nifti = Nifti::new(false, false, &[2, 3, 4], 4);
    nifti.floats(112, 0, &[2.0, -10.0]);
    let samples: Vec<u8> = (0..24_i16).flat_map(i16::to_le_bytes).collect();
    assert_eq!(values(&folder.read("a.nii", nifti.with(&samples)))[..3], [-10.0, -8.0, -6.0]);
}

#[test]
fn one_of_several_volumes_is_read_and_one_of_several_numbers() {
    let folder = Folder::new();
    let file = Nifti::new(false, false, &[2, 3, 2, 2], 2).with(&ramp());
    let times = folder.read("a.nii", &file);
    assert_eq!((times.size, times.samples), ([2, 3, 2], Samples::U8((0..12).collect())));
    assert_eq!(
        times.notes,
        ["it holds 2 volumes (dim[4], time); number 0, counted from 0, is read: `index` chooses"]
    );
    for packed in [file.clone(), gzip(&file)] {
        assert_eq!(folder.chosen("a.nii", &packed, 1, None).unwrap().sample([1, 0, 0]), Some(13.0));
        let refused = folder.chosen("a.nii", &packed, 2, None).unwrap_err();
        assert!(refused.ends_with("index is 2, but its 2 volumes are 0 to 1"), "{refused}");
    }
    let vectors = Nifti::new(true, true, &[2, 2, 1, 2, 3], 2).with(&ramp());
    let chosen = folder.chosen("a.nii", vectors, 1, Some(2)).unwrap();
    assert_eq!(values(&chosen), [20.0, 21.0, 22.0, 23.0]);
}

#[test]
fn colours_are_read_whole_or_channel_by_channel() {
    let folder = Folder::new();
    let rgb = Nifti::new(false, false, &[2, 2, 2], 128).with(&ramp());
    let Samples::Rgba8(colours) = folder.read("a.nii", &rgb).samples else { panic!() };
    assert_eq!((colours.len(), colours[2]), (8, [6, 7, 8, 255]));
    assert_eq!(folder.chosen("a.nii", &rgb, 0, Some(1)).unwrap().sample([1, 0, 0]), Some(4.0));
    let rgba = Nifti::new(false, false, &[2, 3], 2304).with(&ramp());
    assert_eq!(
        folder.read("a.nii", &rgba).samples,
        Samples::Rgba8((0..6).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]).collect())
    );
    // The same as planes of bytes, by what they mean.
    let mut planes = Nifti::new(false, false, &[2, 2, 2, 1, 3], 2);
    planes.put(68, &2003_i16.to_le_bytes());
    let Samples::Rgba8(colours) = folder.read("a.nii", planes.with(&ramp())).samples else { panic!() };
    assert_eq!(colours[1], [1, 9, 17, 255]);
}

#[test]
fn place_window_and_labels_are_kept() {
    let folder = Folder::new();
    let mut nifti = Nifti::new(false, false, &[2, 3, 4], 2);
    nifti.bytes[123] = 3;
    nifti.floats(124, 192, &[200.0, 10.0]);
    nifti.put(68, &1002_i16.to_le_bytes());
    nifti.floats(268, 376, &[7.0, 8.0, 9.0]);
    let unplaced = folder.read("a.nii", nifti.with(&ramp()));
    assert_eq!(unplaced.frame.space, Space::Unknown);
    assert_eq!((unplaced.window, unplaced.labels), (Some((10.0, 200.0)), Some(Labels::default())));
    // The sform wins; its unit is the micrometre.
    nifti.put(252, &1_i16.to_le_bytes());
    nifti.sform([[-2000.0, 0.0, 0.0, 9e3], [0.0, 3e3, 0.0, -4e3], [0.0, 1e3, 4e3, 5e3]]);
    let placed = folder.read("a.nii", nifti.with(&ramp()));
    assert_eq!((placed.frame.space, placed.sample([1, 0, 0])), (Space::Patient, Some(0.0)));
    assert!(is_at(place_of(&placed, [1, 0, 0]), [9.0, -4.0, 5.0]));
    assert!(is_at(place_of(&placed, [0, 0, 2]), [7.0, -4.0, 13.0]));
    assert!(is_at(place_of(&placed, [1, 1, 0]), [9.0, -1.0, 6.0]));
    // Without it, the qform.
    nifti.put(254, &0_i16.to_le_bytes());
    let placed = folder.read("a.nii", nifti.with(&ramp()));
    assert!(is_at(placed.frame.origin, [7e-3, 8e-3, 9e-3]));
    let mut fractions = Nifti::new(true, true, &[6], 16);
    fractions.put(504, &1002_i32.to_le_bytes());
    fractions.floats(124, 192, &[0.0, 0.0]);
    let volume = folder.read("a.nii", fractions.with(&0.5_f32.to_be_bytes().repeat(6)));
    assert_eq!((volume.labels, volume.window), (None, None));
}

#[test]
fn what_is_wrong_is_told() {
    let folder = Folder::new();
    let refused = |nifti: &Nifti| folder.refusal("a.nii", nifti.with(&ramp()));
    let of = |dims: &[i64], datatype| Nifti::new(true, false, dims, datatype);
    assert!(
        refused(&of(&[2, 3, 5], 2)).contains("24 bytes after its header; 2 x 3 x 5 voxels of 1 byte need 30")
    );
    assert!(refused(&of(&[1 << 40, 1 << 40, 1 << 40], 64)).contains("limit"));
    assert!(refused(&of(&[2, 0, 5], 2)).contains("every side"));
    assert!(refused(&of(&[2, -3, 5], 2)).contains("every side"));
    assert!(refused(&of(&[2, 3, 4], 128)).contains("2 x 3 x 4 voxels of 3 bytes need 72"));
    assert!(refused(&of(&[2, 3, 4], 32)).contains("its samples are complex numbers (datatype 32)"));
    assert!(refused(&of(&[2, 3, 4], 1)).contains("single bits"));
    let mut nan = of(&[2, 3, 4], 2);
    nan.floats(76, 104, &[1.0, f64::NAN, 1.0, 1.0]);
    assert!(refused(&nan).contains("spacing NaN"));
    let mut none = of(&[2, 3, 4], 2);
    none.put(16, &9_i64.to_le_bytes());
    assert!(refused(&none).contains("dim[0]: 9 dimensions; expected 1 to 7"));
    let packed = gzip(&of(&[1000, 1000, 1000], 2).with(&ramp()));
    assert!(folder.refusal("a.nii.gz", packed).contains("unpacked bytes"));
    let short = of(&[2, 3, 4], 2).bytes[..500].to_vec();
    assert!(folder.refusal("a.nii", short).contains("cut off"));
    assert!(folder.refusal("a.nii", "nothing").contains("no mark of NIfTI"));
}

#[test]
fn damaged_headers_never_panic() {
    let mut nifti = Nifti::new(false, false, &[2, 3, 4], 2);
    nifti.sform([[-2.0, 0.0, 0.0, 9.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]]);
    mutate("a.nii", &nifti.with(&ramp()), 352);
    mutate("a.nii", &Nifti::new(true, true, &[2, 3, 4], 2).with(&ramp()), 544);
}
