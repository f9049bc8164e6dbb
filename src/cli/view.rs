//! `tyndall view`.

use super::arguments::ViewArguments;
use super::exit::{self, Failure};
use super::open::Input;
use super::render::{check_camera, check_overrides};
use crate::gpu::GpuOptions;
use crate::scene::LiveScene;
use crate::window::{self, SessionOptions, WindowOptions};
use bevy_app::App;

pub(super) fn run(mut app: App, arguments: &ViewArguments) -> Result<(), Failure> {
    let input = Input::of(&arguments.files, &arguments.directions)?;
    let scene = match &input.text {
        Some(text) => LiveScene::open_text(&mut app, &input.path, text.clone(), &arguments.overrides),
        None => LiveScene::open(&mut app, &input.path, &arguments.overrides),
    };
    let problems = scene.problems(app.world());
    if scene.is_refused() {
        // What is wrong in the files is told in the window, where one sees it mended; what is wrong here can only be mended here.
        let at_fault = check_overrides(&problems)
            .err()
            .or((input.text.is_none() && !input.path.is_file()).then_some(Failure::Input));
        if let Some(failure) = at_fault {
            exit::print(&problems);
            return Err(failure);
        }
    } else {
        check_camera(app.world_mut(), arguments.camera.as_deref())?;
    }
    let session = SessionOptions {
        scene,
        camera: arguments.camera.clone(),
        screenshots: ".".into(),
        tell: Some(exit::print),
    };
    let gpu = GpuOptions { portable: arguments.portable };
    Ok(window::run(app, WindowOptions { size: arguments.size, gpu, session })?)
}
