//! What is to be shown: a scene, or files that a scene is made for.

use super::exit::Failure;
use crate::render;
use crate::scene::{Orientation, Override, SceneDocument, is_data, scene_of_files, untitled_for};
use bevy_app::App;
use clap::Args;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// How meshes are to be looked at.
#[derive(Args, Clone, Debug)]
pub(super) struct Directions {
    /// For files without a scene: what is up in the picture, such as +z or 0,1,1; of patients, the head is
    #[arg(long, value_name = "AXIS", value_parser = direction, allow_hyphen_values = true)]
    pub up: Option<Vec3>,
    /// For files without a scene: where the camera stands, such as -y or 1,0,1; of patients, in front
    #[arg(long, value_name = "AXIS", value_parser = direction, allow_hyphen_values = true)]
    pub front: Option<Vec3>,
}

impl Directions {
    pub fn orientation(&self) -> Orientation {
        Orientation { up: self.up, front: self.front }
    }
}

/// A scene on disk, or one that was made and is in no file.
pub(super) struct Input {
    pub path: PathBuf,
    pub text: Option<String>,
}

impl Input {
    /// One scene is taken as it is; data, and several files, become a scene.
    pub fn of(files: &[PathBuf], directions: &Directions) -> Result<Self, Failure> {
        let one = match files {
            [one] if !is_data(one) => Some(one),
            _ => None,
        };
        match one {
            Some(path) if directions.up.is_some() || directions.front.is_some() => {
                Err(Failure::Usage(format!(
                    "{} is a scene, which says itself how it is looked at; `--up` and `--front` are for meshes and volumes",
                    path.display()
                )))
            }
            Some(path) => Ok(Self { path: path.clone(), text: None }),
            None => {
                let path = untitled_for(files);
                let text =
                    scene_of_files(files, path.parent().unwrap_or(Path::new("")), &directions.orientation());
                let text = text.map_err(|error| Failure::Usage(error.to_string()))?;
                Ok(Self { path, text: Some(text) })
            }
        }
    }

    /// Reads it into the world.
    pub fn load(&self, app: &mut App, overrides: &[Override]) -> SceneDocument {
        match &self.text {
            Some(text) => render::load_text(app, &self.path, text.clone(), overrides),
            None => render::load_scene(app, &self.path, overrides),
        }
    }
}

/// `+z`, `-y`, `x` or three numbers between commas.
fn direction(text: &str) -> Result<Vec3, String> {
    let (sign, axis) = match text.strip_prefix('-') {
        Some(axis) => (-1.0, axis),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let axis = match axis {
        "x" | "X" => Some(Vec3::X),
        "y" | "Y" => Some(Vec3::Y),
        "z" | "Z" => Some(Vec3::Z),
        _ => None,
    };
    let numbers = || {
        let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers?.try_into().ok().map(Vec3::from_array)
    };
    axis.map(|axis| axis * sign)
        .or_else(numbers)
        .filter(|direction| direction.is_finite() && *direction != Vec3::ZERO)
        .ok_or_else(|| "expected an axis such as +z or -y, or a direction such as 0,1,1".into())
}
