//! Real files, many of them broken, through scene, reader and picture. They lie in the folder that `TYNDALL_DATA` names.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::path::{Path, PathBuf};
use support::Studio;
use tyndall::render;
use tyndall::scene::Severity;
use tyndall::sources::{
    Endian, RawLayout, SampleFormat, Samples, Selection, VolumeData, read_raw, read_volume,
};
use tyndall_needs::needs;

fn data(path: &str) -> PathBuf {
    Path::new(&std::env::var("TYNDALL_DATA").unwrap()).join(path)
}

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(data(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.to_string_lossy().ends_with(ending));
    files.sort();
    files
}

/// The picture of a scene, or the errors that it was refused with.
fn try_draw(studio: &mut Studio, scene: &str) -> Result<Vec<[f32; 3]>, Vec<String>> {
    let path = studio.file("scene.ron", scene.as_bytes());
    let document = render::load_scene(&mut studio.app, &path, &[]);
    assert!(!document.has_errors(), "{:#?}", document.problems);
    studio.app.insert_resource(tyndall::Picture {
        size: glam::UVec2::new(48, 48),
        camera: None,
        encoded: false,
    });
    let drawn = render::render(&mut studio.app);
    let problems = render::problems(studio.app.world(), &document);
    match drawn {
        Ok(render::Image { pixels: render::Pixels::Radiance(pixels), .. }) => Ok(pixels),
        Ok(_) => unreachable!("radiance was asked for"),
        Err(error) => {
            let errors: Vec<String> = problems
                .iter()
                .filter(|problem| problem.severity == Severity::Error)
                .map(ToString::to_string)
                .collect();
            assert!(!errors.is_empty(), "{error}");
            Err(errors)
        }
    }
}

const LIGHT: &str =
    "\"sun\": ( DirectionalLight: (direction: (-0.4, -0.7, -1.0), irradiance: (3.0, 3.0, 3.0)) ),";

#[needs(gpu, data)]
#[test]
fn every_mesh_is_drawn_or_refused_with_a_reason_and_its_place() {
    let mut refused = 0;
    let all: Vec<PathBuf> = files("meshes", ".obj").into_iter().chain(files("meshes/odd", ".obj")).collect();
    assert!(all.len() >= 40, "{}", all.len());
    for mesh in all {
        // A studio each: a broken mesh must not live on what the one before left.
        let mut studio = Studio::new();
        match try_draw(&mut studio, &format!("(entities: {{ {LIGHT} \"mesh\": ( Mesh: File({mesh:?}) ) }})"))
        {
            Ok(pixels) => {
                assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "{mesh:?}");
                let seen = pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
                // One vertex at 1e30 makes a needle that no pixel can show.
                assert!(
                    seen > 0 || mesh.ends_with("made_huge_coordinates.obj"),
                    "nothing of {mesh:?} is to be seen"
                );
            }
            Err(errors) => {
                refused += 1;
                assert!(errors[0].contains("scene.ron:1:"), "{errors:?}");
                assert!(errors[0].contains(&*mesh.file_name().unwrap().to_string_lossy()), "{errors:?}");
            }
        }
    }
    assert!((10..=16).contains(&refused), "{refused} refused");
}

/// Size and type stand in the names: `tooth_103x94x161_uint16_be.raw.gz`.
fn described(path: &Path) -> String {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let parts: Vec<&str> = name.split(['_', '.']).collect();
    let size = parts
        .iter()
        .find(|part| part.split('x').count() == 3 && part.as_bytes()[0].is_ascii_digit())
        .unwrap();
    let format = [("uint8", "U8"), ("uint16", "U16"), ("int16", "I16"), ("float32", "F32")];
    let (_, format) = format.iter().find(|(written, _)| parts.contains(written)).unwrap();
    let endian = if parts.contains(&"be") { "Big" } else { "Little" };
    format!(
        "Volume: Raw(path: {path:?}, size: ({}), format: {format}, endian: {endian})",
        size.replace('x', ", ")
    )
}

#[needs(gpu, data)]
#[test]
fn every_volume_is_drawn() {
    let all = files("volumes", ".raw.gz");
    assert!(all.len() >= 15, "{}", all.len());
    for volume in all {
        let mut studio = Studio::new();
        let scene = format!(
            "(entities: {{ {LIGHT} \"v\": ( {}, VolumeLighting: Gradient(), RayCast: (step: 4.0) ) }})",
            described(&volume)
        );
        let pixels = try_draw(&mut studio, &scene).unwrap_or_else(|errors| panic!("{volume:?}: {errors:?}"));
        assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "{volume:?}");
        // Values that use little of their format's range are faint in the default ramp.
        assert!(pixels.iter().any(|pixel| pixel[0] > 1e-6), "nothing of {volume:?} is to be seen");
    }
}

#[needs(gpu, data)]
#[test]
fn lying_volumes_are_refused_and_constant_ones_are_drawn() {
    let draw = |name: &str, size: &str| {
        let volume = data("volumes/odd").join(name);
        try_draw(
            &mut Studio::new(),
            &format!("(entities: {{ \"v\": ( Volume: Raw(path: {volume:?}, size: ({size})) ) }})"),
        )
    };
    let short = draw("bucky_truncated_20000.raw", "32, 32, 32").unwrap_err();
    assert!(short[0].contains("20000") && short[0].contains("32768"), "{short:?}");
    let long = draw("bucky_one_byte_long.raw", "32, 32, 32").unwrap_err();
    assert!(long[0].contains("32769") && long[0].contains("skip_bytes"), "{long:?}");
    let huge = draw("constant_16.raw", "4294967295, 4294967295, 4294967295").unwrap_err();
    assert!(huge[0].contains("4294967295"), "{huge:?}");
    assert!(draw("constant_16.raw", "16, 16, 16").is_ok());
}

/// Bars from the low corner along x (value 85), y (170) and z (255): each end is where its axis says, at the spacing written.
#[needs(gpu, data)]
#[test]
fn the_axes_of_a_volume_are_those_of_the_scene() {
    let mut studio = Studio::new();
    let volume = data("volumes/axes_test_96x64x48_uint8.raw.gz");
    let mut seen = |eye: &str, up: &str, points: &str| {
        let scene = format!(
            "(entities: {{
                \"eye\": ( ViewCamera: (eye: {eye}, up: {up}, projection: Orthographic(height: 96.0)) ),
                \"v\": ( Volume: Raw(path: {volume:?}, size: (96, 64, 48), spacing: (1.0, 1.5, 2.0)),
                    TransferFunction: (points: [{points}]), RayCast: (step: 0.5) ) }})"
        );
        let path = studio.file("scene.ron", scene.as_bytes());
        let document = render::load_scene(&mut studio.app, &path, &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        studio.app.insert_resource(tyndall::Picture {
            size: glam::UVec2::new(96, 96),
            camera: None,
            encoded: false,
        });
        let Ok(render::Image { pixels: render::Pixels::Radiance(pixels), .. }) =
            render::render(&mut studio.app)
        else {
            panic!()
        };
        // Columns and rows that show anything.
        let shown = |along: usize| {
            let lit = |i: usize| {
                pixels
                    .iter()
                    .enumerate()
                    .any(|(at, pixel)| (if along == 0 { at % 96 } else { at / 96 }) == i && pixel[0] > 0.2)
            };
            let all: Vec<usize> = (0..96).filter(|i| lit(*i)).collect();
            (all[0], all[all.len() - 1])
        };
        (shown(0), shown(1))
    };
    let only = |value: f32| {
        let at = value / 255.0;
        format!(
            "({:?}, (1.0, 1.0, 1.0), 0.0), ({:?}, (1.0, 1.0, 1.0), 0.9), ({:?}, (1.0, 1.0, 1.0), 0.9), ({:?}, (1.0, 1.0, 1.0), 0.0)",
            at - 0.02,
            at - 0.01,
            (at + 0.01).min(0.999),
            (at + 0.02).min(1.0)
        )
    };
    // The volume measures 96 mm along each axis. From +z, x is to the right and y up.
    let ((left, right), _) = seen("(0.0, 0.0, 200.0)", "(0.0, 1.0, 0.0)", &only(85.0));
    assert!(left <= 8 && right > 40, "the bar along x goes from {left} to {right}");
    let ((_, right), (top, bottom)) = seen("(0.0, 0.0, 200.0)", "(0.0, 1.0, 0.0)", &only(170.0));
    assert!(
        bottom >= 80 && top < 40 && right < 40,
        "the bar along y goes from row {bottom} to {top}, at most column {right}"
    );
    // From +x, with y up, z grows to the left.
    let ((left, right), (top, _)) = seen(
        "(200.0, 0.0, 0.0)",
        "(0.0, 1.0, 0.0)",
        "(0.97, (1.0, 1.0, 1.0), 0.0), (1.0, (1.0, 1.0, 1.0), 0.9)",
    );
    assert!(
        right >= 70 && left < 40 && top > 40,
        "the bar along z goes from column {right} to {left}, at row {top}"
    );
}

/// What must become of a file that says itself what it holds.
#[derive(Debug)]
enum Outcome {
    /// Size, spacing in mm, format, range, and parts of the notes.
    Volume([u32; 3], [f32; 3], &'static str, (f32, f32), &'static [&'static str]),
    /// A part of the error.
    Refused(&'static str),
}
use Outcome::{Refused, Volume};

/// Every file of `volumes/formats` and the NRRD files of `volumes/odd`.
const FORMATS: &[(&str, Outcome)] = &[
    ("formats/HeadMRVolume.mhd", Volume([48, 62, 42], [4.0, 4.0, 4.0], "U8", (0.0, 255.0), &[])),
    ("formats/HeadMRVolume.raw", Refused("name their header,")),
    (
        "formats/dicom/CT_small.dcm",
        Volume(
            [128, 128, 1],
            [0.661468, 0.661468, 5.0],
            "I16",
            (-896.0, 1167.0),
            &["left, posterior, superior"],
        ),
    ),
    (
        "formats/dicom/MR_small.dcm",
        Volume([64, 64, 1], [0.3125, 0.3125, 0.8], "I16", (127.0, 2145.0), &["left, posterior, superior"]),
    ),
    (
        "formats/dicom/MR_small_RLE.dcm",
        Volume([64, 64, 1], [0.3125, 0.3125, 0.8], "I16", (127.0, 2145.0), &["left, posterior, superior"]),
    ),
    (
        "formats/dicom/MR_small_bigendian.dcm",
        Volume([64, 64, 1], [0.3125, 0.3125, 0.8], "I16", (127.0, 2145.0), &["left, posterior, superior"]),
    ),
    ("formats/frogtissue.mhd", Volume([500, 470, 136], [1.0, 1.0, 1.5], "U8", (0.0, 29.0), &[])),
    ("formats/frogtissue.zraw", Refused("name their header,")),
    ("formats/heptane.nii.gz", Volume([302, 302, 302], [1.0, 1.0, 1.0], "U8", (0.0, 255.0), &[])),
    ("formats/ironProt.vtk", Volume([68, 68, 68], [1.0, 1.0, 1.0], "U8", (0.0, 255.0), &[])),
    ("formats/mni152_t1.nii.gz", Volume([197, 233, 189], [1.0, 1.0, 1.0], "U8", (0.0, 255.0), &[])),
    ("formats/neghip.slc", Refused("SLC volumes are not read; convert it to NRRD")),
    ("formats/niftirs/27_float32.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "F32", (0.0, 26.0), &[])),
    ("formats/niftirs/27_float64.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "F32", (0.0, 26.0), &[])),
    ("formats/niftirs/27_int16.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "I16", (0.0, 26.0), &[])),
    ("formats/niftirs/27_int32.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U8", (0.0, 26.0), &[])),
    ("formats/niftirs/27_int64.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U8", (0.0, 26.0), &[])),
    ("formats/niftirs/27_int8.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "I8", (0.0, 26.0), &[])),
    ("formats/niftirs/27_uint16.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U16", (0.0, 26.0), &[])),
    ("formats/niftirs/27_uint32.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U8", (0.0, 26.0), &[])),
    ("formats/niftirs/27_uint64.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U8", (0.0, 26.0), &[])),
    ("formats/niftirs/27_uint8.nii", Volume([3, 3, 3], [1.0, 1.0, 1.0], "U8", (0.0, 26.0), &[])),
    (
        "formats/niftirs/avg152T1_LR_nifti.nii.gz",
        Volume([91, 109, 91], [2.0, 2.0, 2.0], "U8", (0.0, 255.0), &["left, anterior, superior"]),
    ),
    ("formats/niftirs/f32.nii.gz", Volume([11, 11, 11], [1.0, 1.0, 1.0], "F32", (0.0, 1.0), &[])),
    ("formats/niftirs/minimal.nii", Volume([64, 64, 10], [3.0, 3.0, 3.0], "U8", (0.0, 63.0), &[])),
    ("formats/niftirs/minimal.nii.gz", Volume([64, 64, 10], [3.0, 3.0, 3.0], "U8", (0.0, 63.0), &[])),
    ("formats/nrrdjl/bswap.nrrd", Volume([2, 2, 1], [1.0, 1.0, 1.0], "U16", (1.0, 255.0), &[])),
    (
        "formats/nrrdjl/small.nrrd",
        Volume([10, 10, 10], [1.0, 1.0, 1.0], "F32", (34.49416, 173.21498), &["left, posterior, superior"]),
    ),
    ("formats/nrrdjl/small.raw", Refused("bare samples do not say what they are; write `Volume: Raw(")),
    (
        "formats/nrrdjl/smallgz.nrrd",
        Volume([10, 10, 10], [1.0, 1.0, 1.0], "F32", (34.49416, 173.21498), &["left, posterior, superior"]),
    ),
    (
        "formats/nrrdjl/test_helix.nrrd",
        Volume(
            [11, 12, 13],
            [0.436364, 0.4, 0.369231],
            "F32",
            (1.0, 1.0),
            &[
                "each voxel has 7 numbers (axis 1, 3D-masked-symmetric-matrix); number 0, counted from 0, is read",
            ],
        ),
    ),
    (
        "formats/pynrrd/BallBinary30x30x30.nhdr",
        Volume([30, 30, 30], [1.0, 1.0, 1.0], "I16", (0.0, 257.0), &["left, posterior, superior"]),
    ),
    (
        "formats/pynrrd/BallBinary30x30x30.nrrd",
        Volume([30, 30, 30], [1.0, 1.0, 1.0], "I16", (0.0, 257.0), &["left, posterior, superior"]),
    ),
    ("formats/pynrrd/BallBinary30x30x30.raw", Refused("name their header,")),
    (
        "formats/pynrrd/BallBinary30x30x30_gz.nrrd",
        Volume([30, 30, 30], [1.0, 1.0, 1.0], "I16", (0.0, 257.0), &["left, posterior, superior"]),
    ),
    ("formats/pynrrd/test1d_ascii.nrrd", Volume([27, 1, 1], [1.0458, 1.0, 1.0], "U8", (1.0, 27.0), &[])),
    (
        "formats/pynrrd/test_simple4d_raw.nrrd",
        Volume(
            [1, 1, 1],
            [1.5, 1.5, 1.0],
            "F32",
            (0.76903427, 0.76903427),
            &["1 of 1 64-bit floats are rounded"],
        ),
    ),
    ("formats/stroke_FLAIR.nii.gz", Volume([124, 160, 140], [1.0, 1.0, 1.0], "U8", (0.0, 255.0), &[])),
    ("formats/stroke_T1.nii.gz", Volume([124, 160, 140], [1.0, 1.0, 1.0], "U8", (0.0, 252.0), &[])),
    ("formats/tooth.nhdr", Volume([103, 94, 161], [1.0, 1.0, 1.0], "U16", (0.0, 1300.0), &[])),
    ("odd/hex_encoding.nrrd", Volume([4, 4, 4], [1.0, 1.0, 1.0], "U8", (0.0, 63.0), &[])),
    ("odd/liar_sizes.nrrd", Refused("64 x 64 x 64 voxels of 1 byte need 262144 (229376 fewer")),
    (
        "odd/missing_endian_u16.nrrd",
        Refused("endian: it is missing from the header; add a line `endian: little`"),
    ),
];

#[needs(data)]
#[test]
fn every_format_loads_or_says_why_not() {
    let folders = ["formats", "formats/dicom", "formats/niftirs", "formats/nrrdjl", "formats/pynrrd", "odd"];
    let mut all: Vec<String> = Vec::new();
    for folder in folders {
        let ending = if folder == "odd" { ".nrrd" } else { "" };
        let found = files(&format!("volumes/{folder}"), ending).into_iter().filter(|path| path.is_file());
        all.extend(found.map(|path| format!("{folder}/{}", path.file_name().unwrap().to_string_lossy())));
    }
    all.sort();
    let mut listed: Vec<&str> = FORMATS.iter().map(|(name, _)| *name).collect();
    listed.sort_unstable();
    assert_eq!(all, listed);
    let mut wrong = Vec::new();
    for (name, expected) in FORMATS {
        let read = read_volume(&data("volumes").join(name), &Selection::default());
        let as_expected = match (&read, expected) {
            (Ok(volume), Volume(size, spacing, format, range, notes)) => {
                volume.size == *size
                    && volume.spacing.abs_diff_eq(glam::Vec3::from(*spacing), 1e-5)
                    && volume.samples.format().to_string() == *format
                    && (volume.range.0 - range.0).abs().max((volume.range.1 - range.1).abs())
                        <= 1e-4 * range.1.abs()
                    && volume.notes.len() == notes.len()
                    && notes.iter().zip(&volume.notes).all(|(part, note)| note.contains(part))
                    && volume.histogram.bins.iter().sum::<u64>() + volume.non_finite
                        == volume.samples.len() as u64
            }
            (Err(error), Refused(part)) => {
                error.to_string().contains(part) && error.to_string().contains(name)
            }
            _ => false,
        };
        if !as_expected {
            let read = read.map(|volume| {
                let format = volume.samples.format();
                (volume.size, volume.spacing, format, volume.range, volume.non_finite, volume.notes)
            });
            wrong.push(format!("{name}: {read:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What bare samples have too: no place, and no window.
fn voxels(volume: VolumeData) -> ([u32; 3], glam::Vec3, Samples, (f32, f32)) {
    (volume.size, volume.spacing, volume.samples, volume.range)
}

/// The same voxels through a header and as bare samples.
#[needs(data)]
#[test]
fn headers_give_what_their_bare_samples_give() {
    let layout =
        |size, format, endian| RawLayout { size, format, endian, spacing: glam::Vec3::ONE, skip_bytes: 0 };
    let volumes = data("volumes");
    let tooth = read_volume(&volumes.join("formats/tooth.nhdr"), &Selection::default()).unwrap();
    let bare = layout([103, 94, 161], SampleFormat::U16, Endian::Big);
    assert_eq!(
        voxels(tooth),
        voxels(read_raw(&volumes.join("tooth_103x94x161_uint16_be.raw.gz"), &bare).unwrap())
    );
    let head = read_volume(&volumes.join("formats/HeadMRVolume.mhd"), &Selection::default()).unwrap();
    let bare = layout([48, 62, 42], SampleFormat::U8, Endian::Little);
    assert_eq!(head.samples, read_raw(&volumes.join("formats/HeadMRVolume.raw"), &bare).unwrap().samples);
    let pynrrd =
        |name: &str| read_volume(&volumes.join("formats/pynrrd").join(name), &Selection::default()).unwrap();
    let ball = pynrrd("BallBinary30x30x30.nrrd");
    assert_eq!(ball, pynrrd("BallBinary30x30x30.nhdr"));
    assert_eq!(ball, pynrrd("BallBinary30x30x30_gz.nrrd"));
    let dicom =
        |name: &str| read_volume(&volumes.join("formats/dicom").join(name), &Selection::default()).unwrap();
    assert_eq!(dicom("MR_small.dcm"), dicom("MR_small_RLE.dcm"));
    assert_eq!(dicom("MR_small.dcm").samples, dicom("MR_small_bigendian.dcm").samples);
}
