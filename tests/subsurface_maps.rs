//! Points and maps of translucent meshes against the same integral summed over every texel that the light reaches: how far they are off,
//! what they cost, what they miss, and what further sets of samples add.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/subject.rs"]
mod subject;
mod support;
#[path = "support/translucent.rs"]
mod translucent;

use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::fmt::Write;
use subject::{Subject, maps, mean, relative_rmse, work};
use support::Studio;
use translucent::{grey, sun};
use tyndall::components::{
    DipoleModel, MapResolution, MapStrategy, ScatteringCamera, ScatteringCameraOf, ScatteringMaps, Shading,
    Subsurface,
};
use tyndall::cpu::ScatteredPoint;
use tyndall::report::PassRecord;
use tyndall_needs::needs;

fn points_against_truth(subject: &mut Subject, probes: usize) {
    let truth = subject.truth(probes, 1024);
    let usual = truth.error(&subject.radiosity());
    // With few samples in the same light, so that what is off is noise and not what the light's texels round away.
    subject.world().insert_resource(tyndall::LightTexels(1024));
    let few = ScatteringMaps { samples: 48, ..Default::default() };
    let one = truth.error(&subject.with(few));
    subject.refine(16, 16);
    subject.frame();
    let many = truth.error(&subject.radiosity());
    println!(
        "{:.3} %; of few samples {:.3} %, of sixteen sets {:.3} %",
        100.0 * usual,
        100.0 * one,
        100.0 * many
    );
    assert!(usual < 0.02, "{usual}");
    assert!(many < one / 2.0, "{many} of sixteen sets, {one} of one");
}

#[needs(gpu)]
#[test]
fn points_of_a_sphere_send_out_what_the_sum_over_its_lit_side_says() {
    points_against_truth(&mut Subject::sphere(5), 48);
}

#[needs(gpu, data)]
#[test]
fn points_of_a_bunny_send_out_what_the_sum_over_its_lit_side_says() {
    points_against_truth(&mut Subject::bunny(), 48);
}

#[needs(gpu)]
#[test]
fn every_model_is_summed_rightly() {
    let mut subject = Subject::sphere(4);
    for model in [DipoleModel::StandardDipole, DipoleModel::DirectionalDipole] {
        let mesh = subject.mesh;
        subject.world().get_mut::<Subsurface>(mesh).unwrap().model = model;
        let truth = subject.truth(40, 512);
        let error = truth.error(&subject.radiosity());
        println!("{model:?}: {:.3} %", 100.0 * error);
        assert!(error < 0.02, "{model:?}: {error}");
    }
}

#[needs(gpu)]
#[test]
fn maps_hold_what_the_sum_over_the_lit_side_says() {
    let mut subject = Subject::sphere(5);
    let truth = subject.truth(40, 512);
    let error = truth.error(&subject.with(maps(16, 256)));
    println!("16 maps of 256 x 256: {:.3} %", 100.0 * error);
    assert!(error < 0.03, "{error}");
}

#[needs(gpu)]
#[test]
fn more_cameras_and_more_texels_change_the_mean_by_little() {
    let mut subject = Subject::sphere(4);
    let mut steps = |settings: &[(u32, u32)]| {
        let means: Vec<f64> =
            settings.iter().map(|(cameras, side)| mean(&subject.with(maps(*cameras, *side)))).collect();
        for (pair, setting) in means.windows(2).zip(settings) {
            println!("{setting:?} to the next: {:+.3} %", 100.0 * (pair[1] / pair[0] - 1.0));
            assert!((pair[1] / pair[0] - 1.0).abs() < 0.01, "{setting:?}: {pair:?}");
        }
    };
    steps(&[(4, 256), (8, 256), (16, 256), (32, 256)]);
    steps(&[(8, 128), (8, 256), (8, 512)]);
}

/// One disc serves all points, so they err together, and the mean of many probes is no better than one of them. Its density falls as
/// light does in the medium, not as the kernel, which is why this takes a medium in which light gets through the whole body.
#[needs(gpu)]
#[test]
fn published_discs_converge_where_they_cover_the_kernel() {
    let mut subject = Subject::new("Sphere(subdivisions: 4)", &grey(0.1, 3.0, 0.0, 1.3), 1.0);
    let truth = subject.truth(40, 512);
    let mut errors = Vec::new();
    for samples in [16, 64, 256, 1024] {
        let uniform = ScatteringMaps { strategy: MapStrategy::Uniform, samples, ..maps(4, 64) };
        let found = subject.with(uniform);
        errors.push(truth.mean_error(&found));
        println!(
            "{samples}: mean {:+.3} %, relative RMSE {:.3} %",
            100.0 * errors[errors.len() - 1],
            100.0 * truth.error(&found)
        );
    }
    subject.refine(4, 4);
    let found = subject.with(ScatteringMaps { strategy: MapStrategy::Uniform, samples: 1024, ..maps(4, 64) });
    let more = truth.mean_error(&found);
    println!("four sets: mean {:+.3} %, relative RMSE {:.3} %", 100.0 * more, 100.0 * truth.error(&found));
    assert!(errors[3].abs() < 0.02, "{errors:?}");
    assert!(errors[3].abs() < errors[0].abs() / 10.0, "{errors:?}");
    assert!(more.abs() < 0.005, "{more}");
}

#[needs(gpu)]
#[test]
fn only_texels_that_points_want_are_evaluated_and_cameras_all_around_see_every_point() {
    let mut subject = Subject::sphere(4);
    let points = subject.points().len() as u64;
    for strategy in [MapStrategy::Adaptive, MapStrategy::Uniform] {
        subject.set(ScatteringMaps { strategy, samples: 16, ..maps(16, 128) });
        let passes = subject.frame();
        let texels = work(&passes, "scattered_radiosity", "texels");
        let unseen = work(&passes, "scattered_radiosity", "points no camera sees");
        let all = work(&passes, "scattering_gbuffer", "texels");
        println!("{strategy:?}: {texels} of {all} texels for {points} points, {unseen} unseen");
        assert_eq!(all, 16 * 128 * 128);
        assert!(texels < all);
        assert_eq!(unseen, 0);
        match strategy {
            MapStrategy::Adaptive => assert!(texels <= 4 * points),
            // A disc in each square.
            MapStrategy::Uniform => assert!(texels > all / 2),
        }
    }
}

#[needs(gpu)]
#[test]
fn what_a_single_camera_does_not_see_is_evaluated_at_its_points() {
    let mut subject = Subject::sphere(4);
    // So many that the dimmest points are not all noise.
    let many = |maps: ScatteringMaps| ScatteringMaps { samples: 192, ..maps };
    subject.set(many(ScatteringMaps::default()));
    subject.frame();
    let direct = subject.radiosity();
    let points = subject.points();
    let half = points.len() as u64 / 2;
    let by_hand = ScatteringCamera { target: "mesh".into(), direction: Vec3::new(1.0, 0.0, 1.0) };
    for name in ["one automatic camera", "one by hand"] {
        match name {
            "one by hand" => {
                subject.world().spawn(by_hand.clone());
                subject.set(many(maps(0, 256)));
            }
            _ => subject.set(many(maps(1, 256))),
        }
        let passes = subject.frame();
        assert_eq!(subject.cameras().0, 1);
        let unseen = work(&passes, "scattered_radiosity", "points no camera sees");
        assert!((half * 9 / 10..half * 12 / 10).contains(&unseen), "{name}: {unseen} of {}", points.len());
        let found = subject.radiosity();
        let error = relative_rmse(&found, &direct);
        // Directly evaluated, with the same samples.
        let same = found.iter().zip(&direct).filter(|(a, b)| a.distance(**b) <= 1e-4 * b.length()).count();
        // The least against direct evaluation, whose noise is large where hardly any light arrives.
        let least = found.iter().zip(&direct).map(|(a, b)| a.min_element() / b.min_element());
        let least = least.fold(f64::INFINITY, f64::min);
        println!("{name}: {unseen} unseen, {same} the same, off {:.3} %, least {least:.3}", 100.0 * error);
        assert!(error < 0.02, "{name}: {error}");
        assert!(same as u64 >= unseen, "{name}: {same} of {unseen}");
        assert!(least > 0.5, "{name}: {least}");
        if name == "one by hand" {
            let seen = |point: &ScatteredPoint| point.position.dot(by_hand.direction) < -0.3;
            let dark =
                points.iter().zip(&found).filter(|(point, m_o)| seen(point) && m_o.min_element() <= 0.0);
            assert_eq!(dark.count(), 0);
        }
    }
}

#[needs(gpu)]
#[test]
fn a_camera_by_hand_is_one_more() {
    let mut subject = Subject::sphere(3);
    subject.world().spawn(ScatteringCamera { target: "mesh".into(), direction: Vec3::NEG_Z });
    subject.set(ScatteringMaps { samples: 16, resolution: MapResolution::Texels(64, 48), ..maps(5, 1) });
    let passes = subject.frame();
    assert_eq!(work(&passes, "scattering_gbuffer", "texels"), 6 * 64 * 48);
    assert_eq!(subject.cameras(), (6, 5));
}

#[needs(gpu, data)]
#[test]
fn hollows_that_no_camera_looks_into_are_not_dark_and_nothing_leaks_from_one_surface_to_another() {
    let mut subject = Subject::bunny();
    subject.refine(16, 16);
    let direct = subject.with(ScatteringMaps::default());
    subject.refine(1, 1);
    let mean = mean(&direct);
    subject.set(maps(4, 256));
    let unseen = work(&subject.frame(), "scattered_radiosity", "points no camera sees");
    let found = subject.radiosity();
    // Points that send out so much of the mean, by how much of that the maps say.
    let ratios = |share: f64| {
        let lit =
            found.iter().zip(&direct).filter(move |(_, direct)| direct.element_sum() > 3.0 * share * mean);
        let ratio = lit.map(|(found, direct)| found.element_sum() / direct.element_sum());
        ratio.fold((f64::INFINITY, 0.0f64), |(least, most), ratio| (least.min(ratio), most.max(ratio)))
    };
    let (all, bright) = (ratios(0.01), ratios(0.1));
    let error = relative_rmse(&found, &direct);
    println!(
        "{unseen} of {} unseen, {all:.3?}, bright {bright:.3?}, off {:.2} %",
        found.len(),
        100.0 * error
    );
    assert!(unseen > 0);
    assert!(error < 0.02, "{error}");
    assert!(all.0 > 0.0, "{all:?}");
    // Noise alone makes a third; a texel of another surface can be off by any factor.
    assert!(bright.0 > 0.65 && bright.1 < 1.5, "{bright:?}");
}

/// Boxes as OBJ, each by its half width and the heights of its bottom and top.
fn boxes(all: &[[f64; 3]]) -> String {
    let mut text = String::new();
    for (index, [half, low, high]) in all.iter().enumerate() {
        for corner in 0..8 {
            let side = |bit: usize, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
            let [x, y, z] = [side(0, -half, *half), side(1, *low, *high), side(2, -half, *half)];
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        for (normal, face) in [
            ("1 0 0", [2, 4, 8, 6]),
            ("-1 0 0", [1, 5, 7, 3]),
            ("0 1 0", [3, 7, 8, 4]),
            ("0 -1 0", [1, 2, 6, 5]),
        ]
        .into_iter()
        .chain([("0 0 1", [5, 6, 8, 7]), ("0 0 -1", [1, 3, 4, 2])])
        {
            let corners = face.map(|corner| format!("{}//-1", 8 * index + corner)).join(" ");
            writeln!(text, "vn {normal}\nf {corners}").unwrap();
        }
    }
    text
}

#[needs(gpu)]
#[test]
fn a_slab_in_the_shadow_of_another_takes_nothing_from_its_texels() {
    let studio = Studio::new();
    studio.file("slabs.obj", boxes(&[[1.0, 0.1, 0.2], [0.95, -0.1, 0.0]]).as_bytes());
    // Light dies out over a tenth of a slab.
    let slabs = format!(
        "{} \"mesh\": ( Mesh: File(\"slabs.obj\"), Subsurface: (material: {}) )",
        sun(0.0),
        grey(30.0, 70.0, 0.0, 1.3)
    );
    let mut subject = Subject::of(studio, &slabs, 1.0);
    let points = subject.points();
    let slab = |lit: bool, radiosity: &[DVec3]| {
        let of: Vec<DVec3> = points
            .iter()
            .zip(radiosity)
            .filter(|(point, _)| {
                if lit {
                    point.normal.y > 0.9
                        && point.position.y > 0.15
                        && point.position.abs().max_element() < 0.9
                } else {
                    point.position.y < 0.05
                }
            })
            .map(|(_, radiosity)| *radiosity)
            .collect();
        let greatest = of.iter().map(|radiosity| radiosity.max_element()).fold(0.0, f64::max);
        (mean(&of), greatest)
    };
    let mut all = vec![("points", ScatteringMaps::default())];
    for (name, strategy) in [("adaptive", MapStrategy::Adaptive), ("uniform", MapStrategy::Uniform)] {
        all.push((name, ScatteringMaps { strategy, ..maps(16, 256) }));
    }
    let mut direct = None;
    for (name, maps) in all {
        let found = subject.with(maps);
        let (lit, (shadowed, most)) = (slab(true, &found).0, slab(false, &found));
        println!("{name}: lit {lit:.3e}, shadowed {shadowed:.3e}, at most {most:.3e}");
        let direct = *direct.get_or_insert(lit);
        // All points of a plane share a published disc, and its noise.
        let tolerance = if name == "uniform" { 0.06 } else { 0.01 };
        assert!((lit / direct - 1.0).abs() < tolerance, "{name}: {lit}, directly {direct}");
        assert!(
            shadowed < 1e-6 * lit && most < 1e-6 * lit,
            "{name}: {shadowed}, at most {most}, beside {lit}"
        );
    }
}

/// What each point is off by after 1, 4 and 16 sets of samples, as the square over the mean's.
fn variances(subject: &mut Subject, maps: &ScatteringMaps, reference: &[DVec3]) -> [f64; 3] {
    [1, 4, 16].map(|sets| {
        subject.refine(sets, sets);
        // Something else between, so that the sets begin again.
        subject.with(ScatteringMaps { samples: 1, progressive: false, ..Default::default() });
        relative_rmse(&subject.with(maps.clone()), reference).powi(2)
    })
}

#[needs(gpu)]
#[test]
fn sets_of_samples_average_into_less_noise() {
    let mut subject = Subject::sphere(3);
    subject.refine(64, 64);
    let reference = subject.with(ScatteringMaps { samples: 1024, ..Default::default() });
    let few = ScatteringMaps { samples: 24, ..Default::default() };
    let points = variances(&mut subject, &few, &reference);
    println!("points: {:?}", points.map(|v| format!("{v:.2e}")));
    for pair in points.windows(2) {
        assert!(pair[1] < pair[0] / 3.0, "{points:?}");
    }
    let in_maps = variances(&mut subject, &ScatteringMaps { samples: 24, ..maps(4, 128) }, &reference);
    println!("maps: {:?}", in_maps.map(|v| format!("{v:.2e}")));
    // What the maps' texels blur remains.
    assert!(in_maps[1] < in_maps[0] / 3.0, "{in_maps:?}");
    assert!(in_maps[2] < in_maps[1], "{in_maps:?}");
}

#[needs(gpu)]
#[test]
fn results_are_the_same_every_time() {
    let run = |maps: &ScatteringMaps| {
        let mut subject = Subject::sphere(3);
        subject.refine(3, 2);
        subject.set(maps.clone());
        subject.frame();
        subject.frame();
        subject.points()
    };
    let few = ScatteringMaps { samples: 24, ..maps(6, 64) };
    let uniform = ScatteringMaps { strategy: MapStrategy::Uniform, ..few };
    for maps in [ScatteringMaps { samples: 24, ..Default::default() }, few, uniform] {
        assert!(run(&maps) == run(&maps), "{maps:?}");
    }
}

/// What ran, by name, but the drawing of the picture itself.
fn ran(passes: &BTreeMap<&'static str, PassRecord>) -> Vec<(&'static str, u64)> {
    let drawing = ["surface", "tonemap"];
    passes
        .iter()
        .filter(|(pass, _)| !drawing.contains(pass))
        .map(|(pass, record)| (*pass, record.runs))
        .collect()
}

#[needs(gpu)]
#[test]
fn a_still_scene_is_refined_until_the_sets_that_are_wanted() {
    let few = ScatteringMaps { samples: 8, ..Default::default() };
    let in_maps = ScatteringMaps { samples: 8, ..maps(3, 32) };
    let once = [("combine", 1), ("scattered_radiosity", 1)];
    let once_in_maps =
        [("combine", 1), ("scattered_radiosity", 1), ("scattering_gbuffer", 1), ("scattering_texels", 1)];
    let mut subject = Subject::sphere(3);
    for (maps, once) in [(few, &once[..]), (in_maps, &once_in_maps[..])] {
        subject.refine(1, 1);
        let first = subject.with(maps.clone());
        assert_eq!(ran(&subject.frame()), []);
        subject.refine(4, 1);
        for _ in 1..4 {
            assert_eq!(ran(&subject.frame()), once);
        }
        let fourth = subject.radiosity();
        assert!(fourth != first);
        assert_eq!(ran(&subject.frame()), []);
        assert!(subject.radiosity() == fourth);
        subject.refine(10, 4);
        let runs = |subject: &mut Subject| {
            subject.frame().get("scattered_radiosity").map_or(0, |record| record.runs)
        };
        assert_eq!([(); 3].map(|()| runs(&mut subject)), [4, 2, 0]);
        // Without progress there is one set, whatever is wanted.
        let one = subject.with(ScatteringMaps { progressive: false, ..maps });
        assert!(one == first);
        assert_eq!(ran(&subject.frame()), []);
    }
}

#[needs(gpu)]
#[test]
fn cameras_are_children_of_the_mesh_while_maps_are_made() {
    let mut subject = Subject::sphere(2);
    assert_eq!(subject.cameras(), (0, 0));
    let few = |cameras| ScatteringMaps { samples: 4, ..maps(cameras, 16) };
    for (cameras, expected) in [(5, 5), (12, 12), (3, 3), (0, 0), (4, 4)] {
        subject.set(few(cameras));
        let passes = subject.frame();
        assert_eq!(subject.cameras(), (expected, expected));
        assert_eq!(passes.contains_key("scattering_gbuffer"), expected > 0);
    }
    subject.set(ScatteringMaps { samples: 4, ..Default::default() });
    subject.frame();
    assert_eq!(subject.cameras(), (0, 0));
    subject.set(ScatteringMaps {
        strategy: MapStrategy::Uniform,
        cameras: 2,
        samples: 4,
        ..Default::default()
    });
    subject.frame();
    assert_eq!(subject.cameras(), (2, 2));
    assert!(subject.studio.report().gpu_bytes.contains_key("scattering_gbuffer"));
    subject.set(Shading::Local);
    subject.frame();
    assert_eq!(subject.cameras(), (0, 0));
    assert!(!subject.studio.report().gpu_bytes.contains_key("scattering_gbuffer"));
    subject.set(Shading::Scattering);
    subject.frame();
    assert_eq!(subject.cameras(), (2, 2));
    let mesh = subject.mesh;
    subject.world().despawn(mesh);
    subject.frame();
    let world = subject.world();
    assert_eq!(world.query::<&ScatteringCameraOf>().iter(world).count(), 0);
    assert!(!subject.studio.report().gpu_bytes.contains_key("scattering_gbuffer"));
}
