//! Sequences of points and the disc that thins out.

use crate::close;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;
use tyndall::optics::sampling::{ExponentialDisc, halton, radical_inverse, sphere_point, van_der_corput};

#[test]
fn digits_are_mirrored_at_the_point() {
    assert_eq!(van_der_corput(0b1011), 0.5 + 0.25 + 0.0625);
    close(radical_inverse(2 * 9 + 3 + 1, 3), 1.0 / 3.0 + 1.0 / 9.0 + 2.0 / 27.0, 1.0, 1e-15, "base 3");
    for index in 0..1000 {
        assert_eq!(radical_inverse(index, 2), van_der_corput(index as u32));
    }
    for index in [0, 1, u32::MAX - 1, u32::MAX] {
        let point = halton(index);
        assert!(point.cmpge(glam::DVec2::ZERO).all() && point.cmplt(glam::DVec2::ONE).all());
    }
}

#[test]
fn halton_points_are_even() {
    const COUNT: u32 = 1024;
    let points: Vec<_> = (1..=COUNT).map(halton).collect();
    // Boxes from the origin hold as many points as their area says; of random points some would be off by 0.02.
    let mut worst = 0f64;
    for x in 1..=40 {
        for y in 1..=40 {
            let corner = glam::dvec2(f64::from(x), f64::from(y)) / 40.0;
            let inside = points.iter().filter(|point| point.cmplt(corner).all()).count();
            worst = worst.max((inside as f64 / f64::from(COUNT) - corner.x * corner.y).abs());
        }
    }
    assert!(worst < 0.006, "{worst}");
}

#[test]
fn directions_are_even() {
    const COUNT: u32 = 4096;
    let (mut mean, mut spread) = (DVec3::ZERO, DMat3::ZERO);
    for index in 0..COUNT {
        let at = halton(index);
        let direction = sphere_point(at.x, at.y);
        close(direction.length(), 1.0, 1.0, 1e-15, "unit length");
        mean += direction / f64::from(COUNT);
        spread += DMat3::from_cols(direction * direction.x, direction * direction.y, direction * direction.z);
    }
    assert!(mean.length() < 2e-3, "{mean}");
    let expected = DMat3::IDENTITY * (f64::from(COUNT) / 3.0);
    assert!(spread.abs_diff_eq(expected, 2e-3 * f64::from(COUNT)), "{spread}");
    assert_eq!((sphere_point(0.0, 0.3).z, sphere_point(1.0, 0.3).z), (1.0, -1.0));
}

/// The probability of a point nearer than `r`, by Simpson's rule.
fn probability(disc: &ExponentialDisc, r: f64) -> f64 {
    const STEPS: u32 = 20_000;
    let at = |index: u32| {
        // Closer steps near the centre.
        let t = f64::from(index) / f64::from(STEPS);
        let r = r * t * t * t;
        TAU * r * disc.density(r) * 3.0 * t * t
    };
    let inner: f64 = (1..STEPS).map(|index| at(index) * if index % 2 == 1 { 4.0 } else { 2.0 }).sum();
    r * (at(0) + at(STEPS) + inner) / (3.0 * f64::from(STEPS))
}

#[test]
fn density_of_a_disc_integrates_to_1() {
    for radius in [1e-3, 1.0, 50.0] {
        for optical in [0.0, 1e-12, 1e-3, 0.0999, 0.1001, 1.0, 10.0, 45.0, 1e3, 1e5] {
            let disc = ExponentialDisc { sigma: optical / radius, radius };
            close(probability(&disc, radius), 1.0, 1.0, 1e-7, &format!("{optical} over {radius}"));
        }
        let even = ExponentialDisc { sigma: 0.0, radius };
        close(even.density(radius / 2.0) * even.area(), 1.0, 1.0, 1e-14, "even");
        assert_eq!(even.density(radius * 1.01), 0.0);
    }
}

#[test]
fn points_of_a_disc_follow_its_density() {
    const COUNT: usize = 2000;
    for optical in [0.0, 1e-6, 0.5, 3.0, 20.0, 1e4] {
        let disc = ExponentialDisc { sigma: optical / 2.0, radius: 2.0 };
        let mut points = disc.points(COUNT);
        assert_eq!(points.len(), COUNT);
        let mean = points.iter().map(|point| point.position).sum::<glam::DVec2>() / COUNT as f64;
        let scale = points.iter().map(|point| point.position.length()).sum::<f64>() / COUNT as f64;
        assert!(mean.length() < 0.05 * scale, "{optical}: {mean}");
        points.sort_by(|a, b| a.position.length().total_cmp(&b.position.length()));
        for (index, point) in points.iter().enumerate().step_by(97) {
            let r = point.position.length();
            assert!(r <= disc.radius);
            close(point.density, disc.density(r), point.density, 1e-12, "density");
            let below = (index as f64 + 0.5) / COUNT as f64;
            close(probability(&disc, r), below, 1.0, 0.02, &format!("{optical}, nearer than {r}"));
        }
    }
}
