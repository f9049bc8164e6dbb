//! Inputs as users of such programs reported them, rebuilt: what is seen of each. They lie beside the folder that `TYNDALL_DATA` names. Meshes
//! are measured in `src/sources/mesh_file/reported.rs`, DICOM files in `reported_dicom.rs`, and what is hostile in `hostile_scenes.rs`.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use bevy_app::App;
use std::path::{Path, PathBuf};
use support::Studio;
use tyndall::scene::{Problem, Severity};
use tyndall::sources::{Samples, Selection, VolumeData, read_volume};
use tyndall::{TyndallPlugins, render};
use tyndall_needs::needs;

fn reported(path: &str) -> PathBuf {
    Path::new(&std::env::var("TYNDALL_DATA").unwrap()).join("../reported").join(path)
}

fn read(path: &str) -> VolumeData {
    read_volume(&reported(path), &Selection::default()).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// What is wrong with a scene, or worth knowing of it.
fn problems(app: &mut App, scene: &Path) -> Vec<Problem> {
    let document = render::load_scene(app, scene, &[]);
    render::all_problems(app, &document)
}

/// The scenes of a folder.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let mut scenes: Vec<PathBuf> =
        std::fs::read_dir(reported(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|ending| ending == "ron"));
    scenes.sort();
    scenes
}

/// What is refused, with a reason: text that is no number, words that no mesh has, and codecs that no kept crate reads.
const REFUSED: [&str; 8] = [
    "htj2k.ron",
    "decimal_comma.ron",
    "exp.ron",
    "rational.ron",
    "nondigit.ron",
    "fo.ron",
    "upperkw.ron",
    // A codestream that the decoder says is broken.
    "j2k.ron",
];

#[needs(data)]
#[test]
fn every_scene_is_read_or_refused_at_its_place() {
    let folders = |kind: &str| {
        let all = std::fs::read_dir(reported(kind)).unwrap().map(|entry| entry.unwrap());
        let folders = all.filter(|entry| entry.file_type().unwrap().is_dir());
        let name = |entry: std::fs::DirEntry| format!("{kind}/{}", entry.file_name().to_string_lossy());
        folders.map(name).collect::<Vec<_>>()
    };
    let mut all: Vec<PathBuf> =
        [folders("fail"), folders("pass")].concat().iter().flat_map(|folder| scenes(folder)).collect();
    // These wait for meshes that their generator makes.
    all.retain(|scene| {
        !["ecef.ron", "origin.ron", "mm.ron", "lv_iso.ron"].iter().any(|name| scene.ends_with(name))
    });
    assert!(all.len() > 100, "{}", all.len());
    let mut wrong = Vec::new();
    for scene in all {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let problems = problems(&mut app, &scene);
        let errors: Vec<&Problem> =
            problems.iter().filter(|problem| problem.severity == Severity::Error).collect();
        let is_refused = REFUSED.iter().any(|name| scene.ends_with(name));
        if errors.is_empty() == is_refused || errors.iter().any(|error| error.place.is_none()) {
            wrong.push(format!("{}: {errors:#?}", scene.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The mean difference of two pictures, 0 to 255.
fn off(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: u64 = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / (3 * a.len()) as f64
}

fn mean(pixels: &[[u8; 3]]) -> f64 {
    pixels.iter().flatten().map(|value| f64::from(*value)).sum::<f64>() / (3 * pixels.len()) as f64
}

const SIZE: (u32, u32) = (160, 120);

fn draw(path: &str) -> Vec<[u8; 3]> {
    Studio::new().encoded(&reported(path), SIZE.0, SIZE.1)
}

#[needs(gpu, data)]
#[test]
fn one_object_looks_alike_whatever_its_numbers_are_stored_as() {
    let folder = "fail/01_default_function_16bit";
    let reference = draw(&format!("{folder}/f32.ron"));
    assert!(mean(&reference) > 3.0, "{}", mean(&reference));
    for name in ["u8", "i16_small", "u16_12bit", "i16_ct"] {
        let off = off(&draw(&format!("{folder}/{name}.ron")), &reference);
        assert!(off < 1.0, "{name} is off by {off} of {}", mean(&reference));
    }
}

/// How much of a picture a colour has, and where its middle is, 0 to 1 from left to right.
fn middle_of(pixels: &[[u8; 3]], is_it: impl Fn(&[u8; 3]) -> bool) -> (f64, f64) {
    let found: Vec<f64> = pixels
        .iter()
        .enumerate()
        .filter(|(_, pixel)| is_it(pixel))
        .map(|(index, _)| (index as u32 % SIZE.0) as f64 / f64::from(SIZE.0))
        .collect();
    (found.len() as f64 / pixels.len() as f64, found.iter().sum::<f64>() / found.len().max(1) as f64)
}

fn is_red([red, green, blue]: &[u8; 3]) -> bool {
    u32::from(*red) > 60 && u32::from(*red) > 2 * u32::from(*green).max(u32::from(*blue))
}

#[needs(gpu, data)]
#[test]
fn a_mask_lies_on_its_scan() {
    let folder = "fail/02_patient_space_ignored";
    let files = [reported(&format!("{folder}/scan.nii")), reported(&format!("{folder}/mask.nii"))];
    let text = tyndall::scene::scene_of_files(&files, Path::new("."), &Default::default()).unwrap();
    assert_eq!(text.matches("place: Patient").count(), 2, "{text}");
    // As its own scene shows it: the camera looks along z, +x on the right.
    let text = std::fs::read_to_string(reported(&format!("{folder}/overlay.ron"))).unwrap();
    let mut placed = text;
    for file in ["scan.nii", "mask.nii"] {
        let path = reported(&format!("{folder}/{file}"));
        placed =
            placed.replace(&format!("File(\"{file}\")"), &format!("File(path: {path:?}, place: Patient)"));
    }
    assert_eq!(placed.matches("Patient").count(), 2, "{placed}");
    let mut studio = Studio::new();
    let path = studio.file("placed.ron", placed.as_bytes());
    let (share, at) = middle_of(&studio.encoded(&path, SIZE.0, SIZE.1), is_red);
    assert!(share > 0.005 && at > 0.58, "{share} of the picture, at {at}");
}

#[needs(gpu, data)]
#[test]
fn labels_do_not_mix() {
    for name in ["Post", "Pre", "PreIntegrated"] {
        let pixels = draw(&format!("fail/17_label_volumes/{name}.ron"));
        assert_eq!(middle_of(&pixels, is_red).0, 0.0, "{name}: there is no label between 0 and 4");
    }
}

#[needs(gpu, data)]
#[test]
fn masked_data_end_as_smoothly_as_others() {
    for lighting in ["Grad", "Ligh", "Emis"] {
        let [masked, zero] = ["nan", "zero"].map(|name| {
            let scene = reported(&format!("fail/15_nan_masked_volume/{name}_{lighting}.ron"));
            let text = std::fs::read_to_string(&scene).unwrap();
            let folder = scene.parent().unwrap().to_string_lossy().into_owned();
            let text = text.replace("File(\"", &format!("File(\"{folder}/"));
            let text = text.replace("TransferFunction: (", "TransferFunction: (domain: (0.0, 200.0), ");
            let mut studio = Studio::new();
            let path = studio.file("scene.ron", text.as_bytes());
            studio.encoded(&path, SIZE.0, SIZE.1)
        });
        let (off, mean) = (off(&masked, &zero), mean(&zero));
        assert!(mean > 3.0 && off < 0.2 * mean, "{lighting}: off by {off} of {mean}");
    }
}

#[needs(gpu, data)]
#[test]
fn sides_and_edges_of_meshes_do_not_depend_on_how_they_are_written() {
    let same = [
        ("fail/13_obj_hard_edges/normals", "fail/13_obj_hard_edges/soff", 0.1),
        ("fail/13_obj_hard_edges/normals", "fail/13_obj_hard_edges/sgroups", 0.1),
        ("fail/13_obj_hard_edges/normals", "fail/13_obj_hard_edges/plain", 0.1),
        ("fail/14_winding_under_subsurface/sss_good", "fail/14_winding_under_subsurface/sss_inward", 0.3),
        ("fail/14_winding_under_subsurface/sss_good", "fail/14_winding_under_subsurface/sss_mixed", 0.3),
        ("fail/14_winding_under_subsurface/sss_good", "fail/14_winding_under_subsurface/sss_vn_in", 0.3),
        ("fail/14_winding_under_subsurface/phong_good", "fail/14_winding_under_subsurface/phong_mixed", 0.1),
        ("fail/14_winding_under_subsurface/phong_good", "fail/14_winding_under_subsurface/phong_inward", 0.1),
        ("pass/mirror_and_scale/baked", "pass/mirror_and_scale/scaled", 0.1),
        ("pass/far_from_origin/p_0", "pass/far_from_origin/p_1000000", 0.02),
        ("pass/far_from_origin/s_0", "pass/far_from_origin/s_1000000", 0.02),
    ];
    for (one, other, most) in same {
        let [a, b] = [one, other].map(|path| draw(&format!("{path}.ron")));
        let off = off(&a, &b);
        assert!(mean(&a) > 1.0 && off <= most, "{other}: off by {off} of {}", mean(&a));
    }
}

#[needs(gpu, data)]
#[test]
fn meshes_have_the_colours_of_their_files() {
    let pixels = draw("fail/20_obj_materials_silent/mtl.ron");
    let green = middle_of(&pixels, |[r, g, b]| *g > 60 && u32::from(*g) > 2 * u32::from(*r.max(b))).0;
    assert!(green > 0.03 && middle_of(&pixels, is_red).0 > 0.01, "{green}");
    let pixels = draw("fail/20_obj_materials_silent/vcol.ron");
    let hues: std::collections::HashSet<[bool; 3]> = pixels
        .iter()
        .filter(|pixel| pixel.iter().any(|value| *value > 100))
        .map(|pixel| {
            let most = *pixel.iter().max().unwrap();
            pixel.map(|value| u32::from(value) * 2 > u32::from(most))
        })
        .collect();
    assert!(hues.len() >= 5, "{hues:?}");
}

#[needs(data)]
#[test]
fn headers_are_read_as_they_are_written() {
    type Facts = (&'static str, [u32; 3], [f32; 3]);
    let files: [Facts; 17] = [
        ("fail/12_windows_paths_in_headers/back.mhd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("fail/12_windows_paths_in_headers/dotback.mhd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("fail/12_windows_paths_in_headers/drive.mhd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("fail/12_windows_paths_in_headers/back.nhdr", [24, 20, 16], [1.0; 3]),
        ("fail/16_byte_order_mark/bom.mhd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("fail/19_nrrd_list_axis_first/seq.nrrd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("fail/21_small_header_quirks/minmax.nrrd", [24, 20, 16], [1.0, 1.0, 3.0]),
        ("fail/21_small_header_quirks/spnan.nrrd", [24, 20, 16], [1.0, 1.0, 3.0]),
        ("fail/21_small_header_quirks/rgb.nii", [24, 20, 16], [1.0; 3]),
        ("pass/detached_headers/neg.mhd", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("pass/detached_headers/gz.nhdr", [24, 20, 16], [1.0; 3]),
        ("pass/nifti_orientation/big.nii", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("pass/nifti_orientation/asr.nii", [16, 24, 20], [2.0, 1.0, 1.0]),
        ("pass/nifti_orientation/UPPER.NII.GZ", [24, 20, 16], [1.0; 3]),
        ("pass/vtk_forms/dimlast.vtk", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("pass/vtk_forms/metadata.vtk", [24, 20, 16], [1.0, 1.0, 2.0]),
        ("pass/vtk_forms/negspacing.vtk", [24, 20, 16], [1.0, 1.0, 2.0]),
    ];
    let mut wrong = Vec::new();
    for (path, size, spacing) in files {
        let volume = read(path);
        let is_near = volume.spacing.to_array().iter().zip(spacing).all(|(a, b)| (a - b).abs() < 1e-4);
        if volume.size != size || !is_near {
            wrong.push(format!("{path}: {:?} {:?}", volume.size, volume.spacing));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(matches!(read("fail/21_small_header_quirks/rgb.nii").samples, Samples::Rgba8(_)));
}

#[needs(data)]
#[test]
fn each_of_several_volumes_can_be_chosen() {
    let path = reported("fail/19_nrrd_list_axis_first/seq.nrrd");
    let of = |index| read_volume(&path, &Selection { index, ..Selection::default() });
    let (first, second) = (of(0).unwrap(), of(1).unwrap());
    assert_eq!(first.size, second.size);
    assert!(first.samples != second.samples);
    let error = of(999).unwrap_err().to_string();
    assert!(error.contains("999"), "{error}");
}

#[needs(data)]
#[test]
fn what_lies_in_front_of_samples_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("big.raw");
    let skip_bytes = 1 << 40;
    // A hole of a terabyte: whoever reads it does not come back.
    let file = std::fs::File::create(&path).unwrap();
    if file.set_len(skip_bytes + 1920).is_err() {
        return;
    }
    let scene = folder.path().join("big.ron");
    let text = format!(
        "(entities: {{ \"v\": ( Volume: Raw(path: \"big.raw\", size: (48, 40, 1), skip_bytes: {skip_bytes}) ) }})"
    );
    std::fs::write(&scene, text).unwrap();
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let found = problems(&mut app, &scene);
    assert!(found.iter().all(|problem| problem.severity == Severity::Note), "{found:#?}");
}

#[needs(gpu, data)]
#[test]
fn pictures_at_the_extremes_are_of_numbers_and_of_light() {
    let folders = ["subnormal_nan", "negative_radiance", "uniform_candidates_black"];
    for folder in folders {
        for scene in scenes(&format!("broken/{folder}")) {
            let mut studio = Studio::new();
            let text = std::fs::read_to_string(&scene).unwrap();
            let beside = scene.parent().unwrap().to_string_lossy().into_owned();
            let text = text.replace("path: \"", &format!("path: \"{beside}/"));
            let path = studio.file("scene.ron", text.as_bytes());
            let document = render::load_scene(&mut studio.app, &path, &[]);
            // What is too small for the GPU may be refused as well.
            if document.has_errors() {
                continue;
            }
            let pixels = studio.radiance(&text, 32, 32);
            let is_light = |value: &f32| value.is_finite() && *value >= 0.0;
            assert!(pixels.iter().flatten().all(is_light), "{}", scene.display());
        }
    }
}
