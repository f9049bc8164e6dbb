//! Functions and data that are hardly there, or that no scene may hold: nothing panics, and nothing wrong comes out.

use crate::panel::{click, drag, function_over, press};
use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use tyndall::components::Validate;
use tyndall::prelude::*;
use tyndall::sources::{Histogram, Samples, VolumeData};

fn histogram(samples: Vec<f32>) -> Histogram {
    let size = [samples.len() as u32, 1, 1];
    VolumeData::new(size, Vec3::ONE, Samples::F32(samples)).unwrap().histogram
}

fn functions() -> Vec<TransferFunction> {
    let nan = f32::NAN;
    let at = |position, opacity| ControlPoint(position, Vec3::ONE, opacity);
    let of = |points: Vec<ControlPoint>| TransferFunction { points, ..Default::default() };
    let iso = |value, width, absorption| IsoValue { value, width, absorption, ..Default::default() };
    vec![
        TransferFunction::default(),
        of(vec![at(0.5, 0.5)]),
        of(vec![at(0.5, 0.0), at(0.5, 1.0), at(0.5, 1.0), at(0.5, 0.0)]),
        of(vec![at(nan, nan), at(0.5, nan), at(nan, 0.5)]),
        of(vec![at(2.0, 3.0), at(-1.0, -1.0)]),
        of((0..3000).map(|index| at(index as f32 / 3000.0, 0.5)).collect()),
        TransferFunction {
            iso: vec![iso(0.5, 0.1, 1.0), iso(nan, nan, nan), iso(1e38, 0.0, 1e38)],
            ..Default::default()
        },
        TransferFunction {
            iso: vec![iso(0.5, 0.0, 2.0)],
            classification: Classification::PreIntegrated,
            ..Default::default()
        },
        TransferFunction { entries: 0, ..of(vec![at(0.1, 0.2), at(0.9, 1.0)]) },
        TransferFunction { domain: Auto::Value(Vec2::new(nan, nan)), ..Default::default() },
        TransferFunction { domain: Auto::Value(Vec2::new(1.0, 0.0)), ..Default::default() },
    ]
}

#[test]
fn nothing_panics() {
    let histograms = [
        None,
        Some(histogram(vec![7.0; 9])),
        Some(histogram(vec![f32::NAN; 4])),
        Some(histogram(vec![-1e30, 0.0, 1e30])),
        Some(histogram(vec![0.0, f32::from_bits(1)])),
    ];
    for function in functions() {
        for histogram in &histograms {
            for domain in [(0.0, 1.0), (5.0, 6.0), (-1e30, 1e30)] {
                let mut harness = function_over(function.clone(), histogram.clone(), domain, 1.0);
                press(&mut harness, "Domain");
                if histogram.is_some() {
                    press(&mut harness, "Data");
                }
                press(&mut harness, "Add point");
                press(&mut harness, "Add iso value");
                press(&mut harness, "Next point");
            }
        }
    }
}

/// Numbers that look random and are the same every time.
struct Lots(u64);

impl Lots {
    fn next(&mut self, below: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(below)) as u32
    }
}

#[test]
fn whatever_is_done_to_a_right_function_leaves_it_right() {
    for seed in 0..4 {
        let mut lots = Lots(seed);
        let mut harness =
            function_over(TransferFunction::default(), Some(crate::panel::two_humps()), (0.0, 255.0), 1.0);
        for step in 0..60 {
            let picture = harness.get_by_label("Transfer function of head").rect();
            let at = picture.min + vec2(lots.next(380) as f32, lots.next(210) as f32);
            match lots.next(6) {
                0 => click(&mut harness, at),
                1 | 2 => {
                    let by = vec2(lots.next(400) as f32 - 200.0, lots.next(300) as f32 - 150.0);
                    drag(&mut harness, at, by);
                }
                3 => press(&mut harness, ["Add point", "Add iso value", "Next point"][lots.next(3) as usize]),
                4 => {
                    let keys =
                        [Key::Delete, Key::ArrowLeft, Key::ArrowUp, Key::ArrowDown, Key::Tab, Key::Plus];
                    harness.key_press(keys[lots.next(6) as usize]);
                    harness.run();
                }
                _ => {
                    harness.key_press(Key::Escape);
                    harness.run();
                }
            }
            let function = &harness.state().edits.component;
            assert_eq!(function.problems(), [], "seed {seed}, step {step}: {function:?}");
            assert!(
                function
                    .points
                    .iter()
                    .all(|point| (0.0..=1.0).contains(&point.0) && (0.0..=1.0).contains(&point.2))
            );
            assert!(
                function
                    .iso
                    .iter()
                    .all(|iso| iso.value.is_finite() && iso.absorption >= 0.0 && iso.width > 0.0)
            );
        }
        assert!(!harness.state().edits.log.is_empty());
    }
}
