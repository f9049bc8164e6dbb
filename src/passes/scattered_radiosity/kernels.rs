//! The kernels of the pass, and the parts of their shaders that are made for a use.

use crate::gpu::{Gpu, GpuError, Kernel, KernelDescriptor, binding};
use crate::report::Report;
use bevy_ecs::prelude::Resource;
use std::collections::HashMap;

/// What the estimator of a kernel is made for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    /// The standard dipole instead of the directional one.
    pub standard: bool,
    /// The published discs, at most so many points of one, and whether all are used.
    pub uniform: Option<(u32, bool)>,
}

/// Where a kernel evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Place {
    /// At all points of the surface.
    Points,
    /// At the points that no camera sees.
    Unseen,
    /// At the texels of maps.
    Texels,
    /// Nowhere: points take what texels hold.
    Gather,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Scatterer {
    kernels: HashMap<(Place, Variant), Kernel>,
    version: u64,
}

impl Scatterer {
    pub fn next_version(&mut self) -> u64 {
        self.version += 1;
        self.version
    }

    /// The kernel for a place, made when it is first asked for.
    pub fn kernel(
        &mut self,
        gpu: &Gpu,
        place: Place,
        variant: Variant,
        report: &mut Report,
    ) -> Result<&Kernel, GpuError> {
        let variant = if place == Place::Gather { Variant::default() } else { variant };
        match self.kernels.entry((place, variant)) {
            std::collections::hash_map::Entry::Occupied(entry) => Ok(entry.into_mut()),
            std::collections::hash_map::Entry::Vacant(entry) => {
                let (name, kernel) = make(gpu, place, variant)?;
                report.pipelines.push(name);
                Ok(entry.insert(kernel))
            }
        }
    }
}

fn make(gpu: &Gpu, place: Place, variant: Variant) -> Result<(&'static str, Kernel), GpuError> {
    use binding::{LAYERS, LAYERS_OUT, STORAGE, STORAGE_OUT, TEXTURE, UNIFORM};
    let (name, entry_point, mut bindings) = match place {
        Place::Points => {
            ("scattered_radiosity", "at_points", vec![UNIFORM, UNIFORM, TEXTURE, STORAGE, STORAGE_OUT])
        }
        Place::Unseen => (
            "scattered_radiosity",
            "at_points",
            vec![UNIFORM, UNIFORM, TEXTURE, STORAGE, STORAGE_OUT, STORAGE, STORAGE],
        ),
        Place::Texels => (
            "scattered_texels",
            "at_texels",
            vec![UNIFORM, UNIFORM, TEXTURE, STORAGE, STORAGE, LAYERS, LAYERS_OUT, STORAGE, STORAGE],
        ),
        Place::Gather => (
            "gather",
            "gather",
            vec![UNIFORM, STORAGE, LAYERS, STORAGE, STORAGE, LAYERS, UNIFORM, STORAGE_OUT],
        ),
    };
    let generated =
        [sampling_module(&variant, bindings.len() as u32), listing_module(place == Place::Unseen)];
    if variant.uniform.is_some() {
        bindings.push(UNIFORM);
    }
    let descriptor = KernelDescriptor { name, generated: &generated, entry_point, bindings: &bindings };
    Ok((name, Kernel::new(gpu, &descriptor)?))
}

/// The WGSL module `sampling`: how discs are sampled, and which dipole is evaluated. `binding` is where the points of a disc are bound.
pub(crate) fn sampling_module(variant: &Variant, binding: u32) -> (&'static str, String) {
    let discs = match variant.uniform {
        None => "#import sampling_adaptive\n".to_owned(),
        Some((capacity, all)) => format!(
            "#import sampling_uniform\nconst ALL_CANDIDATES = {all};\n\
             @group(0) @binding({binding}) var<uniform> discs: array<vec4f, {capacity}>;\n"
        ),
    };
    ("sampling", format!("{discs}const STANDARD_DIPOLE = {};\n", variant.standard))
}

/// The WGSL module `listing`: at which points a kernel evaluates.
pub(crate) fn listing_module(unseen: bool) -> (&'static str, String) {
    let text = if unseen {
        "@group(0) @binding(5) var<storage, read> unseen: array<u32>;
@group(0) @binding(6) var<storage, read> counts: vec2u;
fn listed_points() -> u32 { return counts.y; }
fn listed_point(i: u32) -> u32 { return unseen[i]; }
"
    } else {
        "fn listed_points() -> u32 { return estimator.points; }
fn listed_point(i: u32) -> u32 { return i; }
"
    };
    ("listing", text.to_owned())
}
