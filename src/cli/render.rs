//! `tyndall render`.

use super::arguments::RenderArguments;
use super::exit::{self, Failure};
use super::open::Input;
use super::output::{self, Output};
use super::outputs::Outputs;
use super::progress;
use crate::components::ViewCamera;
use crate::gpu::{Gpu, GpuOptions};
use crate::plain;
use crate::render::{self, RenderError};
use crate::report::Report;
use crate::scene::{Problem, SceneDocument, Severity, nearest};
use crate::{CutOut, Picture, Refinement, SceneTime};
use bevy_app::App;
use bevy_ecs::prelude::*;
use std::path::Path;
use std::time::Instant;

pub(super) fn run(app: &mut App, arguments: &RenderArguments, started: Instant) -> Result<(), Failure> {
    let mut output = Output::of(arguments)?;
    let outputs = Outputs::check(arguments, &output)?;
    let input = Input::of(&arguments.files, &arguments.directions)?;
    app.world_mut().resource_mut::<Report>().spent("start", started);
    // The driver takes its time to wake up; meanwhile the scene is read.
    let options = GpuOptions { portable: arguments.portable };
    let gpu = std::thread::spawn(move || (pollster::block_on(Gpu::new(&options)), Instant::now()));
    let document = input.load(app, &arguments.overrides);
    let fine = check_document(app, &document)
        .and_then(|()| check_camera(app.world_mut(), arguments.camera.as_deref()))
        .and_then(|()| outputs.spare(&document));
    if let Err(failure) = fine {
        // Drivers do not take it well when the program ends while they wake up.
        let _ = gpu.join();
        return Err(failure);
    }
    let waiting = Instant::now();
    let (gpu, _) = gpu
        .join()
        .map_err(|_| Failure::Machine("the graphics driver panicked while it was opened".into()))?;
    app.insert_resource(gpu?);
    app.insert_resource(Picture {
        size: arguments.size,
        camera: arguments.camera.clone(),
        encoded: output.format.is_encoded(),
    });
    app.insert_resource(CutOut(arguments.transparent));
    app.insert_resource(Refinement { sets: arguments.passes, per_update: arguments.passes });
    let mut report = app.world_mut().resource_mut::<Report>();
    report.spent("wait for the driver", waiting);
    report.measure = arguments.stats.is_some();

    let frames = arguments.frames.clone().unwrap_or(0..1);
    let bar = progress::bar(frames.end - frames.start);
    for frame in frames {
        app.world_mut().insert_resource(SceneTime { seconds: frame as f64 / arguments.fps });
        let drawn = render::render(app);
        if let Err(RenderError::Scene) = drawn {
            bar.finish_and_clear();
            exit::print(&render::problems(app.world(), &document));
        }
        let image = drawn?;
        outputs.spare_read(app.world())?;
        let writing = Instant::now();
        output.write(frame, &image)?;
        app.world_mut().resource_mut::<Report>().spent("write", writing);
        bar.inc(1);
    }
    output.finish()?;
    bar.finish_and_clear();
    exit::print(&notes(&render::problems(app.world(), &document)));
    if let Some(path) = &arguments.stats {
        write_stats(app.world(), path, started)?;
    }
    Ok(())
}

fn check_document(app: &mut App, document: &SceneDocument) -> Result<(), Failure> {
    if !document.has_errors() {
        return Ok(());
    }
    exit::print(&render::all_problems(app, document));
    Err(check_overrides(&document.problems).err().unwrap_or(Failure::Input))
}

/// Whether every `--set` names something that the scene has.
pub(super) fn check_overrides(problems: &[Problem]) -> Result<(), Failure> {
    let from_command_line = |problem: &Problem| {
        problem.place.as_ref().is_some_and(|place| place.file.path() == Path::new("--set"))
    };
    if problems.iter().any(from_command_line) {
        return Err(Failure::Usage("a `--set` names what the scene does not have; nothing was drawn".into()));
    }
    Ok(())
}

fn notes(problems: &[Problem]) -> Vec<Problem> {
    problems.iter().filter(|problem| problem.severity == Severity::Note).cloned().collect()
}

/// Whether the scene has the camera that is asked for.
pub(super) fn check_camera(world: &mut World, wanted: Option<&str>) -> Result<(), Failure> {
    let Some(wanted) = wanted else { return Ok(()) };
    let mut cameras = world.query_filtered::<&Name, With<ViewCamera>>();
    let names: Vec<&str> = cameras.iter(world).map(Name::as_str).collect();
    if names.contains(&wanted) {
        return Ok(());
    }
    let help = match nearest(wanted, names.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if names.is_empty() => "the scene has no ViewCamera".into(),
        None => format!("the scene has: {}", names.join(", ")),
    };
    Err(Failure::Usage(plain::message(&format!("there is no camera `{wanted}`: {help}"))))
}

fn write_stats(world: &World, path: &Path, started: Instant) -> Result<(), Failure> {
    let gpu = world.resource::<Gpu>();
    let report = world.resource::<Report>();
    let stats = serde_json::json!({
        "adapter": gpu_description(gpu),
        "passes": report.passes,
        "pipelines": report.pipelines,
        "gpu_bytes": report.gpu_bytes,
        "timeline_ms": report.timeline,
        "total_ms": started.elapsed().as_secs_f64() * 1e3,
    });
    output::write(path, format!("{stats:#}\n").as_bytes())
}

/// Who the adapter is, and which variants it gets.
pub(super) fn gpu_description(gpu: &Gpu) -> serde_json::Value {
    let formats = crate::gpu::VolumeFormat::all(gpu);
    serde_json::json!({
        "name": gpu.info.name,
        "driver": format!("{} {}", gpu.info.driver, gpu.info.driver_info).trim(),
        "backend": gpu.info.backend.to_string(),
        "kind": format!("{:?}", gpu.info.device_type),
        "timestamps": gpu.has(wgpu::Features::TIMESTAMP_QUERY),
        "volume_formats": formats,
    })
}
