//! DICOM files as users of such programs reported them, rebuilt: each is read, and its voxels lie where SimpleITK 2.5.7 has them,
//! where that reads the file. They lie beside the folder that `TYNDALL_DATA` names.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};

use tyndall::sources::{Selection, Space, VolumeData, read_volume};
use tyndall_needs::needs;

fn reported(path: &str) -> PathBuf {
    Path::new(&std::env::var("TYNDALL_DATA").unwrap()).join("../reported").join(path)
}

/// The mean of all values, and the mean place of all values, in voxels.
fn moments(volume: &VolumeData) -> (f64, [f64; 3]) {
    let [width, height, _] = volume.size.map(|side| side as usize);
    let (mut sum, mut places) = (0.0, [0.0; 3]);
    for at in 0..volume.samples.len() {
        let value = f64::from(volume.samples.get(at).unwrap());
        sum += value;
        let place = [at % width, at / width % height, at / (width * height)];
        (0..3).for_each(|axis| places[axis] += value * place[axis] as f64);
    }
    (sum / volume.samples.len() as f64, places.map(|place| place / sum))
}

/// A file or folder, and what must become of it.
struct Expected {
    path: &'static str,
    size: [u32; 3],
    spacing: [f32; 3],
    /// The centre of the first voxel, right, anterior, superior, mm; none where the file does not say.
    origin: Option<[f64; 3]>,
    mean: f64,
    range: (f32, f32),
    /// The mean place of all values along z, in voxels: which end is up.
    height: f64,
    /// Parts of the notes.
    notes: &'static [&'static str],
}

const WHOLE: [u32; 3] = [24, 20, 16];
const UP: f64 = 7.6087;
const DOWN: f64 = 7.3913;
const MEAN: f64 = 10.28125;

#[rustfmt::skip]
const FILES: &[Expected] = &[
    Expected { path: "fail/05_dicom_decimal_comma/comma", size: WHOLE, spacing: [0.5, 0.5, 1.5], origin: Some([-5.5, -4.5, 0.0]), mean: -89.71875, range: (-100.0, 100.0), height: 7.4875, notes: &[] },
    Expected { path: "fail/05_dicom_decimal_comma/point", size: WHOLE, spacing: [0.5, 0.5, 1.5], origin: Some([-5.5, -4.5, 0.0]), mean: -89.71875, range: (-100.0, 100.0), height: 7.4875, notes: &[] },
    Expected { path: "fail/06_dicom_rtdose/up.dcm", size: WHOLE, spacing: [2.5, 2.5, 3.0], origin: Some([-27.5, -22.5, 0.0]), mean: MEAN / 100.0, range: (0.0, 2.0), height: UP, notes: &[] },
    Expected { path: "fail/06_dicom_rtdose/down.dcm", size: WHOLE, spacing: [2.5, 2.5, 3.0], origin: Some([-27.5, -22.5, 0.0]), mean: MEAN / 100.0, range: (0.0, 2.0), height: DOWN, notes: &[] },
    Expected { path: "fail/06_dicom_rtdose/absolute.dcm", size: WHOLE, spacing: [2.5, 2.5, 3.0], origin: Some([-27.5, -22.5, 100.0]), mean: MEAN / 100.0, range: (0.0, 2.0), height: UP, notes: &[] },
    Expected { path: "fail/07_dicom_nm_signed_spacing/neg.dcm", size: WHOLE, spacing: [2.0, 2.0, 4.0], origin: Some([-16.0, -13.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: DOWN, notes: &[] },
    // SimpleITK leaves out a position that stands where others have it; it is taken here.
    Expected { path: "fail/07_dicom_nm_signed_spacing/neg_top.dcm", size: WHOLE, spacing: [2.0, 2.0, 4.0], origin: Some([-16.0, -13.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: DOWN, notes: &[] },
    Expected { path: "fail/07_dicom_nm_signed_spacing/pos.dcm", size: WHOLE, spacing: [2.0, 2.0, 4.0], origin: Some([-16.0, -13.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "fail/07_dicom_nm_signed_spacing/pos_top.dcm", size: WHOLE, spacing: [2.0, 2.0, 4.0], origin: Some([-16.0, -13.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "fail/09_dicom_without_preamble/ima", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "fail/09_dicom_without_preamble/plain", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "fail/09_dicom_without_preamble/meta_only", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "fail/10_dicom_media_folder/cd", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["left out, as README.TXT"] },
    Expected { path: "fail/10_dicom_media_folder/cd/DICOMDIR", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["names no file that is there; its folder is read"] },
    Expected { path: "fail/21_small_header_quirks/one_spacing.dcm", size: WHOLE, spacing: [0.5, 0.5, 1.0], origin: Some([-11.5, -9.5, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["stacked by number"] },
    // SimpleITK leaves the location out, and has this one upside down.
    Expected { path: "fail/21_small_header_quirks/sliceloc", size: WHOLE, spacing: [1.0, 1.0, 3.0], origin: None, mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["no position in the patient"] },
    Expected { path: "fail/21_small_header_quirks/seg1bit.dcm", size: WHOLE, spacing: [1.0, 1.0, 1.0], origin: Some([-23.0, -19.0, 0.0]), mean: 28.15625 / 255.0, range: (0.0, 1.0), height: 7.592, notes: &[] },
    Expected { path: "pass/dicom_bits/mono1.dcm", size: WHOLE, spacing: [1.0, 1.0, 1.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["MONOCHROME1"] },
    Expected { path: "pass/dicom_bits/overlay12.dcm", size: WHOLE, spacing: [1.0, 1.0, 1.0], origin: Some([-23.0, -19.0, 0.0]), mean: 164.5, range: (0.0, 3200.0), height: UP, notes: &[] },
    Expected { path: "pass/dicom_bits/shift12.dcm", size: WHOLE, spacing: [1.0, 1.0, 1.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "pass/dicom_bits/ut_vr.dcm", size: WHOLE, spacing: [0.5, 0.5, 1.0], origin: Some([-11.5, -9.5, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    // SimpleITK puts both time points on top of each other.
    Expected { path: "pass/dicom_series/enhanced.dcm", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: 2.0 * MEAN - 10.0, range: (-10.0, 390.0), height: 7.71, notes: &["`index` chooses one of 2 volumes"] },
    Expected { path: "pass/dicom_series/gap", size: [24, 20, 14], spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: 6.80357, range: (0.0, 200.0), height: 6.6588, notes: &["2.000 to 6.000 mm apart"] },
    Expected { path: "pass/dicom_series/pet", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &[] },
    Expected { path: "pass/dicom_series/sagittal", size: [16, 24, 20], spacing: [2.0, 1.0, 1.0], origin: Some([-30.0, -23.0, -19.0]), mean: MEAN, range: (0.0, 200.0), height: 8.4362, notes: &[] },
    Expected { path: "pass/dicom_series/sameinst", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, -30.0]), mean: MEAN, range: (0.0, 200.0), height: DOWN, notes: &[] },
    // The slices' own distance; the way from one to the next, 2.129 mm, is in the frame.
    Expected { path: "pass/dicom_series/tilt", size: WHOLE, spacing: [1.0, 1.0, 2.0], origin: Some([-23.0, -19.0, 0.0]), mean: MEAN, range: (0.0, 200.0), height: UP, notes: &["stacked at 20.1°"] },
];

#[needs(data)]
#[test]
fn every_reported_file_is_read_and_lies_where_it_should() {
    let mut wrong = Vec::new();
    for expected in FILES {
        let volume = match read_volume(&reported(expected.path), &Selection::default()) {
            Ok(volume) => volume,
            Err(error) => {
                wrong.push(error.to_string());
                continue;
            }
        };
        let (mean, places) = moments(&volume);
        let origin = (volume.frame.space == Space::Patient).then_some(volume.frame.origin.to_array());
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        let is_right = volume.size == expected.size
            && volume.spacing.abs_diff_eq(expected.spacing.into(), 1e-5)
            && match (origin, expected.origin) {
                (Some(found), Some(expected)) => near(&found, &expected),
                (found, expected) => found.is_none() && expected.is_none(),
            }
            && (volume.range.0 - expected.range.0).abs() < 1e-5
            && (volume.range.1 - expected.range.1).abs() < 1e-4
            && near(&[mean], &[expected.mean])
            && (places[2] - expected.height).abs() < 0.02
            && expected.notes.iter().all(|part| volume.notes.iter().any(|note| note.contains(part)));
        if !is_right {
            wrong.push(format!(
                "{}: {:?} {} {origin:?} mean {mean} range {:?} places {places:?} {:?}",
                expected.path, volume.size, volume.spacing, volume.range, volume.notes
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What holds no picture is refused with its frame, its packing and what is wrong.
#[needs(data)]
#[test]
fn packed_nothing_is_refused() {
    for (file, packing) in
        [("j2k", "JPEG 2000 Lossless Only"), ("htj2k", "High-Throughput JPEG 2000 Lossless Only")]
    {
        let path = reported(&format!("fail/21_small_header_quirks/{file}.dcm"));
        let refused = read_volume(&path, &Selection::default()).unwrap_err().to_string();
        assert!(refused.contains("the file is damaged"), "{refused}");
        assert!(refused.contains(packing) || refused.contains("not in items"), "{refused}");
        assert!(!refused.contains("dcmdjpeg"), "{refused}");
    }
}

/// The slices of a tilted gantry lie where they say, one by one.
#[needs(data)]
#[test]
fn slices_of_a_tilted_gantry_lie_where_they_say() {
    let volume = read_volume(&reported("pass/dicom_series/tilt"), &Selection::default()).unwrap();
    let step = volume.frame.directions[2] * f64::from(volume.spacing.z);
    // Towards the back by the tangent of 0.35, and up.
    let expected = glam::DVec3::new(0.0, -2.0 * 0.35_f64.tan(), 2.0);
    assert!(step.distance(expected) < 1e-4, "{step}");
}
