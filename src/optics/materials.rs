//! Media by name: what light meets inside them.
//!
//! The measured ones are those of Jensen, Marschner, Levoy & Hanrahan, *A Practical Model for Subsurface Light Transport*
//! (SIGGRAPH 2001), figure 5: scattering and absorption coefficients of red, green and blue light, and an index of refraction. The
//! scattering coefficients are reduced already, sigma_s' = (1 - g) sigma_s, so each medium is given as the isotropic one (g = 0) with
//! that coefficient.

use super::medium::Medium;

/// A medium with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedMedium {
    /// Its name.
    pub name: &'static str,
    /// Reduced scattering coefficient of red, green and blue, per mm.
    pub sigma_s_reduced: [f64; 3],
    /// Absorption coefficient of red, green and blue, per mm.
    pub sigma_a: [f64; 3],
    /// Index of refraction.
    pub eta: f64,
}

impl NamedMedium {
    const fn new(name: &'static str, sigma_s_reduced: [f64; 3], sigma_a: [f64; 3], eta: f64) -> Self {
        Self { name, sigma_s_reduced, sigma_a, eta }
    }

    /// The isotropic medium of each colour.
    pub fn coefficients(&self) -> [Medium; 3] {
        std::array::from_fn(|colour| Medium {
            sigma_a: self.sigma_a[colour],
            sigma_s: self.sigma_s_reduced[colour],
            g: 0.0,
            eta: self.eta,
        })
    }
}

/// Every medium with a name. All are measured but `wax`, which is this project's own: made up to look like a candle, with numbers of the
/// size that paraffin has, and no measurement behind any digit.
pub const MEDIA: [NamedMedium; 12] = [
    NamedMedium::new("apple", [2.29, 2.39, 1.97], [0.003, 0.0034, 0.046], 1.3),
    NamedMedium::new("chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19], 1.3),
    NamedMedium::new("cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163], 1.3),
    NamedMedium::new("ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45], 1.3),
    NamedMedium::new("marble", [2.19, 2.62, 3.0], [0.0021, 0.0041, 0.0071], 1.5),
    NamedMedium::new("potato", [0.68, 0.7, 0.55], [0.0024, 0.009, 0.12], 1.3),
    NamedMedium::new("skimmilk", [0.7, 1.22, 1.9], [0.0014, 0.0025, 0.0142], 1.3),
    NamedMedium::new("skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48], 1.3),
    NamedMedium::new("skin2", [1.09, 1.59, 1.79], [0.013, 0.07, 0.145], 1.3),
    NamedMedium::new("spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0], 1.3),
    NamedMedium::new("wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014], 1.3),
    NamedMedium::new("wax", [1.1, 1.3, 1.6], [0.003, 0.008, 0.03], 1.43),
];

/// Second names, and what they stand for.
pub const ALIASES: [(&str, &str); 3] = [("chicken", "chicken1"), ("milk", "wholemilk"), ("skin", "skin1")];

/// Every name, second ones too.
pub const NAMES: [&str; MEDIA.len() + ALIASES.len()] = {
    let mut names = [""; MEDIA.len() + ALIASES.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = if index < MEDIA.len() { MEDIA[index].name } else { ALIASES[index - MEDIA.len()].0 };
        index += 1;
    }
    names
};

/// The medium of this name, in small or capital letters.
pub fn named(name: &str) -> Option<&'static NamedMedium> {
    const KNOWN: &[NamedMedium] = &MEDIA;
    let alias = ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(name));
    let name = alias.map_or(name, |(_, meant)| meant);
    KNOWN.iter().find(|medium| medium.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_media_are_those_of_the_table() {
        let text = include_str!("../../tests/truth/materials.json");
        let table: serde_json::Value = serde_json::from_str(text).unwrap_or_default();
        let cases = table["cases"].as_array().cloned().unwrap_or_default();
        assert_eq!(cases.len() + 1, MEDIA.len(), "all but wax are measured");
        for case in cases {
            let name = case["name"].as_str().unwrap_or_default();
            let Some(medium) = named(name) else { panic!("no {name}") };
            let numbers = |field: &str| [0, 1, 2].map(|colour| case[field][colour].as_f64());
            assert_eq!(medium.sigma_s_reduced.map(Some), numbers("sigma_s_prime_per_mm"), "{name}");
            assert_eq!(medium.sigma_a.map(Some), numbers("sigma_a_per_mm"), "{name}");
            assert_eq!(Some(medium.eta), case["eta"].as_f64(), "{name}");
        }
    }

    #[test]
    fn every_name_is_one_medium_in_small_and_capital_letters() {
        for name in NAMES {
            assert!(named(name).is_some() && named(name) == named(&name.to_uppercase()), "{name}");
            assert_eq!(NAMES.iter().filter(|other| **other == name).count(), 1, "{name}");
        }
        assert_eq!(named("milk"), named("wholemilk"));
        assert_eq!(named("skin"), named("skin1"));
        assert_eq!(named("granite"), None);
    }
}
