//! Colours for labels that nobody has given any.

use glam::{DMat3, DVec3, Vec3};

/// How far apart the hues of consecutive labels are, in turns: the golden section, so that any run of them is spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Lightness and chroma of labels, in turn: neighbours in hue differ in these.
const TONES: [(f64, f64); 5] = [(0.66, 0.17), (0.85, 0.13), (0.45, 0.13), (0.75, 0.10), (0.56, 0.16)];

/// A colour for a label, linear, each channel 0 to 1: always the same for a value, and far from those of the values beside it.
pub fn palette(value: i32) -> Vec3 {
    let index = f64::from(value.wrapping_sub(1));
    let hue = std::f64::consts::TAU * (0.07 + GOLDEN * index).rem_euclid(1.0);
    let (lightness, chroma) = TONES[value.wrapping_sub(1).rem_euclid(TONES.len() as i32) as usize];
    linear_of_oklab(DVec3::new(lightness, chroma * hue.cos(), chroma * hue.sin()))
        .clamp(DVec3::ZERO, DVec3::ONE)
        .as_vec3()
}

/// Linear primaries from those that sRGB encodes, each 0 to 1 (IEC 61966-2-1).
pub fn linear_of_srgb(encoded: Vec3) -> Vec3 {
    let channel = |value: f32| {
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::from(encoded.to_array().map(channel))
}

/// The inverse of [`linear_of_srgb`]; what is beyond 1 becomes 1.
pub fn srgb_of_linear(linear: Vec3) -> Vec3 {
    let channel = |value: f32| {
        if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
    };
    Vec3::from(linear.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(channel))
}

/// Linear primaries of sRGB from Oklab (Ottosson 2020), in which distances are as they are seen.
fn linear_of_oklab(lab: DVec3) -> DVec3 {
    let roots = DMat3::from_cols_array(&[
        1.0,
        1.0,
        1.0,
        0.396_337_777_4,
        -0.105_561_345_8,
        -0.089_484_177_5,
        0.215_803_757_3,
        -0.063_854_172_8,
        -1.291_485_548,
    ]);
    let primaries = DMat3::from_cols_array(&[
        4.076_741_662_1,
        -1.268_438_004_6,
        -0.004_196_086_3,
        -3.307_711_591_3,
        2.609_757_401_1,
        -0.703_418_614_7,
        0.230_969_929_2,
        -0.341_319_396_5,
        1.707_614_701,
    ]);
    let lms = roots * lab;
    primaries * (lms * lms * lms)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse of `linear_of_oklab`, by its own constants.
    fn oklab(linear: Vec3) -> DVec3 {
        let rgb = linear.as_dvec3();
        let lms = DVec3::new(
            0.412_221_470_8 * rgb.x + 0.536_332_536_3 * rgb.y + 0.051_445_992_9 * rgb.z,
            0.211_903_498_2 * rgb.x + 0.680_699_545_1 * rgb.y + 0.107_396_956_6 * rgb.z,
            0.088_302_461_9 * rgb.x + 0.281_718_837_6 * rgb.y + 0.629_978_700_5 * rgb.z,
        );
        let lms = DVec3::new(lms.x.cbrt(), lms.y.cbrt(), lms.z.cbrt());
        DVec3::new(
            0.210_454_255_3 * lms.x + 0.793_617_785 * lms.y - 0.004_072_046_8 * lms.z,
            1.977_998_495_1 * lms.x - 2.428_592_205 * lms.y + 0.450_593_709_9 * lms.z,
            0.025_904_037_1 * lms.x + 0.782_771_766_2 * lms.y - 0.808_675_766 * lms.z,
        )
    }

    #[test]
    fn labels_are_told_apart() {
        let colours: Vec<DVec3> = (1..=24).map(|value| oklab(palette(value))).collect();
        let mut nearest = f64::MAX;
        for (index, one) in colours.iter().enumerate() {
            for other in &colours[..index] {
                nearest = nearest.min(one.distance(*other));
            }
        }
        // Just noticeable is about 0.02.
        assert!(nearest > 0.045, "{nearest}");
        for value in (-300..300).chain([i32::MIN + 1, i32::MAX - 1, 65_535]) {
            let (one, next) = (oklab(palette(value)), oklab(palette(value.wrapping_add(1))));
            assert!(one.distance(next) > 0.15, "{value}: {one:?} {next:?}");
            assert!(palette(value).min_element() >= 0.0 && palette(value).max_element() > 0.1, "{value}");
        }
    }
}
