//! Which texels of the maps are worth evaluating, and which points no camera sees.

use super::{CameraMaps, Recipe};
use crate::gpu::{
    Gpu, GpuError, Invocations, Kernel, KernelDescriptor, Layers, PassTimer, binding, storage, storage_array,
    uniform_buffer,
};
use crate::passes::body::Body;
use crate::passes::gbuffer::OrthographicView;
use crate::view::normal_matrix;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::Resource;
use glam::{DMat4, Mat4, Vec2};

mirror! {
    /// Mirror of `MapCamera` in `shaders/shared/maps.wgsl`.
    "gather":
    pub(crate) struct MapCameraUniform as "MapCamera" {
        view_from_mesh: Mat4,
        view_from_mesh_normal: Mat4,
        low: Vec2,
        inverse_texel: f32,
    }
}

mirror! {
    /// Mirror of `Maps` in `shaders/shared/maps.wgsl`.
    "gather":
    pub(crate) struct MapsUniform as "Maps" {
        cameras: u32,
        points: u32,
        bias: f32,
        best_only: u32,
    }
}

/// The kernels that choose texels.
#[derive(Resource, Default, Debug)]
pub(crate) struct TexelChooser {
    kernels: Option<[Kernel; 3]>,
}

/// Chooses the texels of what cameras see.
pub(super) fn choose(
    gpu: &Gpu,
    chooser: &mut TexelChooser,
    recipe: Recipe,
    gbuffer: Layers,
    views: Vec<OrthographicView>,
    timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<CameraMaps, GpuError> {
    let kernels = match chooser.kernels.take() {
        Some(kernels) => kernels,
        None => {
            report.pipelines.push("scattering_texels");
            [kernel(gpu, "choose")?, kernel(gpu, "list")?, kernel(gpu, "plan")?]
        }
    };
    let [choose, list, plan] = chooser.kernels.insert(kernels);
    let texels = recipe.size.element_product() * views.len() as u32;
    let points = recipe.count;
    let uniform = MapsUniform {
        cameras: views.len() as u32,
        points,
        bias: recipe.bias.unwrap_or(-1.0),
        best_only: u32::from(recipe.best_only),
    };
    let cameras: Vec<_> = views.iter().map(|view| map_camera(&recipe.body, view)).collect();
    let wanted = storage(gpu, "wanted texels", u64::from(texels.div_ceil(32)) * 4);
    let radiosity = Layers::new(gpu, "scattered_texels", recipe.size, views.len() as u32);
    let maps = CameraMaps {
        uniform: uniform_buffer(gpu, "maps", &uniform),
        cameras: storage_array(gpu, "map cameras", &cameras),
        best: storage(gpu, "best cameras", u64::from(points) * 4),
        counts: storage(gpu, "counts", 16),
        texels: storage(gpu, "texels", u64::from(texels) * 4),
        unseen: storage(gpu, "unseen points", u64::from(points) * 4),
        dispatches: storage(gpu, "dispatches", 24),
        gbuffer,
        radiosity,
        views,
        recipe,
    };
    let resources = [
        maps.uniform.as_entire_binding(),
        maps.cameras.as_entire_binding(),
        wgpu::BindingResource::TextureView(&maps.gbuffer.view),
        maps.recipe.points.vertices.as_entire_binding(),
        maps.best.as_entire_binding(),
        wanted.as_entire_binding(),
        maps.counts.as_entire_binding(),
        maps.texels.as_entire_binding(),
        maps.unseen.as_entire_binding(),
        maps.dispatches.as_entire_binding(),
    ];
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let timing = timer.and_then(|timer| timer.time_compute("scattering_texels"));
    choose.run(gpu, &mut encoder, &resources, Invocations::Count(points), timing);
    list.run(gpu, &mut encoder, &resources, Invocations::Count(texels), None);
    plan.run(gpu, &mut encoder, &resources, Invocations::Count(1), None);
    gpu.queue.submit([encoder.finish()]);
    report.ran("scattering_texels", &[("points", u64::from(points)), ("texels", u64::from(texels))]);
    Ok(maps)
}

fn kernel(gpu: &Gpu, entry_point: &str) -> Result<Kernel, GpuError> {
    let mut bindings = vec![binding::UNIFORM, binding::STORAGE, binding::LAYERS, binding::STORAGE];
    bindings.extend([binding::STORAGE_OUT; 6]);
    Kernel::new(
        gpu,
        &KernelDescriptor { name: "scattering_texels", generated: &[], entry_point, bindings: &bindings },
    )
}

fn map_camera(body: &Body, view: &OrthographicView) -> MapCameraUniform {
    let view_from_mesh = view.view_from_body * body.body_from_mesh;
    MapCameraUniform {
        view_from_mesh: DMat4::from(view_from_mesh).as_mat4(),
        view_from_mesh_normal: normal_matrix(view_from_mesh).as_mat4(),
        low: view.low.truncate().as_vec2(),
        inverse_texel: view.texels_per_length() as f32,
    }
}
