//! Which kinds of lighting the ray caster needs code for: software adapters run all that is there, whether its result counts or not.

use super::raycast::Lit;
use std::fmt::Write;

/// Kinds of lighting, as the shader knows them.
pub(super) const EMITS: u32 = 0;
pub(super) const GRADIENT: u32 = 1;
pub(super) const SCATTERS_ONCE: u32 = 2;
pub(super) const UNLIT: u32 = 3;
pub(super) const SCATTERS: u32 = 4;
pub(super) const SCATTERS_TOWARDS_EYE: u32 = 5;

/// What any of the volumes needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Kinds {
    /// Anything but the colours as they are.
    lit: bool,
    /// Gradients for normals.
    gradient: bool,
    /// Light that was scattered, once or more often.
    scattering: bool,
    /// Lights, for volumes that scatter.
    lights: u32,
    /// Light that was scattered more often.
    often: bool,
    /// Scattering that is not the same in all directions.
    leaning: bool,
    /// Scattering often in a forward peak, which counts as none.
    peak: bool,
    /// Light that goes on towards the eye.
    towards_eye: bool,
    /// Highlights in scattered light.
    highlights: bool,
    /// Light that is scattered once, of lights that share a sum.
    shared: bool,
    /// The lighting of each volume, where it is the same in all parts of the picture.
    of_volumes: Vec<Option<u32>>,
}

impl Kinds {
    /// For volumes, each as it is lit in every part of the picture.
    pub(super) fn of(volumes: Vec<Vec<Lit>>, lights: u32) -> Self {
        let alone = |parts: &Vec<Lit>| {
            let first = parts.first()?.kind;
            parts.iter().all(|lit| lit.kind == first).then_some(first)
        };
        let mut kinds = Self { of_volumes: volumes.iter().map(alone).collect(), ..Default::default() };
        for lit in volumes.into_iter().flatten() {
            let once = lit.kind == SCATTERS_ONCE;
            let often = [SCATTERS, SCATTERS_TOWARDS_EYE].contains(&lit.kind);
            kinds.lit |= lit.kind != EMITS;
            kinds.gradient |= lit.kind == GRADIENT;
            kinds.scattering |= once || often;
            kinds.often |= often;
            kinds.leaning |= (once || often) && lit.g != 0.0;
            kinds.peak |= lit.kind == SCATTERS && lit.g > 0.0;
            kinds.towards_eye |= lit.kind == SCATTERS_TOWARDS_EYE;
            kinds.highlights |= often && lit.specular > 0.0;
            kinds.shared |= once && lit.shares;
        }
        kinds.lights = if kinds.scattering { lights } else { 0 };
        kinds
    }

    /// For shaders that want everything.
    pub fn all() -> Self {
        Self {
            lit: true,
            gradient: true,
            scattering: true,
            lights: 2,
            often: true,
            leaning: true,
            peak: true,
            towards_eye: true,
            highlights: true,
            shared: true,
            of_volumes: vec![None, Some(SCATTERS)],
        }
    }

    /// Lights that volumes which scatter go through one by one.
    pub fn lights(&self) -> u64 {
        u64::from(self.lights)
    }

    /// Iterations of loops that it takes to light a sample, at most, where a normal and the depth of a light take so many.
    pub fn loops(&self, all_lights: u64, normal: u64, light: u64) -> u64 {
        let normal = if self.gradient || self.highlights { normal } else { 0 };
        let gradient = if self.gradient { all_lights + 1 } else { 0 };
        let scattering = if self.scattering { self.lights() * (1 + light) + 1 } else { 0 };
        // The loop that looks for samples to light together.
        let together = u64::from(self.lit);
        together + normal + gradient.max(scattering)
    }

    /// The WGSL module `lighting`.
    pub fn module(&self) -> (&'static str, String) {
        let constants = [
            ("ANY_LIT", self.lit),
            ("ANY_GRADIENT", self.gradient),
            ("ANY_SCATTERING", self.scattering),
            ("ANY_OFTEN", self.often),
            ("ANY_LEANING", self.leaning),
            ("ANY_PEAK", self.peak),
            ("ANY_TOWARDS_EYE", self.towards_eye),
            ("ANY_HIGHLIGHT", self.highlights),
            ("ANY_SHARED", self.shared),
        ];
        let mut text = String::new();
        for (name, value) in constants {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "const {name} = {value};");
        }
        // A number that is known unrolls the loop over lights, which then fetches each as it is.
        let _ =
            writeln!(text, "const LIGHTS = {}u;\nconst LIGHT_WAYS = {}u;", self.lights, self.lights.max(1));
        // Lavapipe compiles shaders anew for the values of uniforms that they branch on, and with them for others, which change from frame to frame.
        let _ = writeln!(text, "fn lighting_of(volume: u32, asked: u32) -> u32 {{\n    switch volume {{");
        for (volume, kind) in self.of_volumes.iter().enumerate() {
            if let Some(kind) = kind {
                let _ = writeln!(text, "        case {volume}u: {{ return {kind}u; }}");
            }
        }
        text.push_str("        default: { return asked; }\n    }\n}\n");
        ("lighting", text)
    }
}
