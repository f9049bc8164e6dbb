//! A loaded scene becomes a picture in memory.

use crate::components::Auto;
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, PassTimer, read_texture};
use crate::passes::{products, raycast::RayCaster, surface::Surface, tonemap::Tonemap};
use crate::plain::piece;
use crate::report::Report;
use crate::scene::{self, EntityProblems, Override, Problem, Problems, SceneDocument, Severity};
use crate::view::{CutOut, FAR, Picture};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use bevy_reflect::TypeRegistry;
use std::path::Path;
use std::time::Instant;

/// A picture in memory, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green and blue of each pixel.
    pub pixels: Pixels,
    /// How much of the background each pixel hides, from 0 to 1, where [`CutOut`] has it left out.
    pub coverage: Option<Vec<f32>>,
    /// How encoded pixels are: by the curve of sRGB, or by an exponent.
    pub gamma: Auto<f32>,
}

/// The pixels of an [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// Scene-referred linear radiance; without the background as much as there is of it in the pixel (premultiplied).
    Radiance(Vec<[f32; 3]>),
    /// Exposed and encoded; without the background the colour of what is there, however little of the pixel it hides (straight).
    Encoded(Vec<[u8; 3]>),
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The scene has errors, which are in [`Problems`].
    #[error("the scene has errors")]
    Scene,
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Reads the scene at `path` into the world, or reports in [`Problems`] why it cannot; then what was there before stays.
pub fn load_scene(app: &mut App, path: &Path, overrides: &[Override]) -> SceneDocument {
    load(app, |registry| SceneDocument::load(path, registry, overrides))
}

/// The same for a scene whose text is in no file yet, as if it stood in one at `path`.
pub fn load_text(app: &mut App, path: &Path, text: String, overrides: &[Override]) -> SceneDocument {
    load(app, |registry| SceneDocument::of_text(path, text, registry, overrides))
}

fn load(app: &mut App, read: impl FnOnce(&TypeRegistry) -> SceneDocument) -> SceneDocument {
    let started = Instant::now();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let document = read(&registry.read());
    app.world_mut().insert_resource(Problems(document.problems.clone()));
    if !document.has_errors() {
        scene::reconcile(app.world_mut(), &document);
    }
    app.world_mut().resource_mut::<Report>().spent("read scene", started);
    document
}

/// The problems of the scene so far, those found after reading with the places that the document knows for them.
pub fn problems(world: &World, document: &SceneDocument) -> Vec<Problem> {
    let placed = |problem: &Problem| {
        let Some((entity, path)) = &problem.subject else { return problem.clone() };
        let name = world.get::<Name>(*entity).map(Name::as_str);
        let place = name.and_then(|name| document.entity(name)).map(|entity| entity.place_of(path));
        let who = name.map_or(String::new(), |name| format!("`{}`: ", piece(name)));
        Problem { message: format!("{who}{}", problem.message), place, ..problem.clone() }
    };
    let whole = world.resource::<Problems>().0.iter().map(placed);
    let mut own: Vec<Problem> =
        entity_problems(world).iter().flat_map(|all| all.iter()).map(placed).collect();
    // Entities have no order of their own; a text has.
    own.sort_by_cached_key(|problem| {
        problem.place.as_ref().map(|place| (place.file.path().to_owned(), place.bytes.start))
    });
    whole.chain(own).collect()
}

/// What is wrong with each entity that has something wrong with it.
fn entity_problems(world: &World) -> Vec<&EntityProblems> {
    let query = world.try_query::<&EntityProblems>();
    query.map(|mut query| query.iter(world).collect()).unwrap_or_default()
}

fn has_errors(world: &World) -> bool {
    let is_error = |problem: &Problem| problem.severity == Severity::Error;
    world.resource::<Problems>().has_errors()
        || entity_problems(world).iter().any(|all| all.iter().any(is_error))
}

/// Every problem of a document and of the files that its sound components name, for a program that ends with them: what could be read
/// replaces the scene in the world, even where errors would have kept it out.
pub fn all_problems(app: &mut App, document: &SceneDocument) -> Vec<Problem> {
    scene::reconcile(app.world_mut(), document);
    app.update();
    problems(app.world(), document)
}

/// Draws the world as it is now and brings the picture back.
///
/// # Errors
///
/// If the scene has errors, or the GPU fails. Needs a [`Gpu`] resource.
pub fn render(app: &mut App) -> Result<Image, RenderError> {
    update(app)?;
    if has_errors(app.world()) {
        return Err(RenderError::Scene);
    }
    Ok(finish(app.world_mut())?)
}

/// The same, showing what there is to be shown of a scene with errors, as while its files are being edited.
///
/// # Errors
///
/// If the GPU fails. Needs a [`Gpu`] resource.
pub fn render_what_is_there(app: &mut App) -> Result<Image, GpuError> {
    update(app)?;
    finish(app.world_mut())
}

/// Opens another device if the one that the world is drawn with is gone, and says why it was. The scene stays; what was on the device is made
/// again by the updates that follow, from files that are read again where need be.
///
/// # Errors
///
/// If there is no other device.
pub fn recover(world: &mut World) -> Result<Option<String>, GpuError> {
    let gpu = world.get_resource::<Gpu>().ok_or(GpuError::Missing)?;
    let Some(reason) = gpu.lost().map(str::to_owned) else { return Ok(None) };
    log::warn!("the graphics device was lost ({reason}); another is opened");
    let another = pollster::block_on(Gpu::new(&gpu.options))?;
    replace_device(world, another);
    Ok(Some(reason))
}

/// Has the world drawn with another device.
pub(crate) fn replace_device(world: &mut World, gpu: Gpu) {
    products::forget_device(world);
    world.resource_mut::<Failure>().forget();
    world.insert_resource(gpu);
}

fn update(app: &mut App) -> Result<(), GpuError> {
    recover(app.world_mut())?;
    if app.world().resource::<Report>().measure && !app.world().contains_resource::<PassTimer>() {
        let timer = PassTimer::new(app.world().resource::<Gpu>());
        timer.map(|timer| app.insert_resource(timer));
    }
    let started = Instant::now();
    app.update();
    let world = app.world_mut();
    world.resource_mut::<Report>().spent("update", started);
    world.resource_mut::<Failure>().take().map_or(Ok(()), Err)
}

fn finish(world: &mut World) -> Result<Image, GpuError> {
    let started = Instant::now();
    world.resource::<Gpu>().wait("drawing")?;
    world.resource_mut::<Report>().spent("draw", started);
    let started = Instant::now();
    let image = read_image(world, world.resource::<Picture>().encoded)?;
    world.resource_mut::<Report>().spent("read back", started);
    measure(world)?;
    Ok(image)
}

/// The picture that was drawn last, encoded for a screen or as radiance.
pub(crate) fn read_image(world: &World, encoded: bool) -> Result<Image, GpuError> {
    let gpu = world.resource::<Gpu>();
    let picture = world.resource::<Picture>();
    let (width, height) = (picture.size.x, picture.size.y);
    let is_cut_out = world.resource::<CutOut>().0;
    let tonemap = world.resource::<Tonemap>();
    let (pixels, coverage): (_, Vec<f32>) = match &tonemap.encoded {
        Some(target) if encoded => {
            let bytes = read_texture(gpu, &target.texture)?;
            let (texels, _) = bytes.as_chunks::<4>();
            let pixels = texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
            (Pixels::Encoded(pixels), texels.iter().map(|texel| f32::from(texel[3]) / 255.0).collect())
        }
        _ => {
            let texels = read_radiance(world)?;
            let pixels = texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
            let coverage = match world.resource::<RayCaster>().radiance() {
                Some(_) => texels.iter().map(|texel| texel[3]).collect(),
                None => texels.iter().map(|texel| if texel[3] < FAR { 1.0 } else { 0.0 }).collect(),
            };
            (Pixels::Radiance(pixels), coverage)
        }
    };
    Ok(Image { width, height, pixels, coverage: is_cut_out.then_some(coverage), gamma: tonemap.gamma })
}

/// The texels of the last pass that drew radiance.
fn read_radiance(world: &World) -> Result<Vec<[f32; 4]>, GpuError> {
    let target = world.resource::<RayCaster>().radiance().or(world.resource::<Surface>().colour());
    let Some(target) = target else { return Ok(Vec::new()) };
    let bytes = read_texture(world.resource::<Gpu>(), &target.texture)?;
    Ok(bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect())
}

/// Adds what costs time to find out: GPU times and the samples that rays took.
fn measure(world: &mut World) -> Result<(), GpuError> {
    if !world.resource::<Report>().measure {
        return Ok(());
    }
    let samples = match world.resource::<RayCaster>().radiance() {
        // Else the texels say something else.
        Some(_) if !world.resource::<CutOut>().0 => {
            read_radiance(world)?.iter().map(|texel| f64::from(texel[3])).sum::<f64>() as u64
        }
        _ => 0,
    };
    let times = world.resource_scope(|world, gpu: Mut<Gpu>| match world.get_resource_mut::<PassTimer>() {
        Some(mut timer) => timer.collect(&gpu),
        None => Ok(Vec::new()),
    })?;
    let mut report = world.resource_mut::<Report>();
    for (pass, milliseconds) in times {
        report.took(pass, milliseconds);
    }
    if let Some(record) = report.passes.get_mut("raycast") {
        *record.work.entry("samples").or_default() += samples;
    }
    Ok(())
}
