//! What can be typed.

use super::open::Directions;
use crate::picture_file::Format;
use crate::scene::Override;
use clap::{Args, Parser, Subcommand};
use glam::UVec2;
use std::ops::Range;
use std::path::PathBuf;

/// Light scattering in meshes and volumes, as data.
#[derive(Parser, Debug)]
#[command(name = "tyndall", version, about, arg_required_else_help = true, disable_help_subcommand = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand, Debug)]
pub(super) enum Command {
    /// Show a scene, meshes or volumes in a window, and read them again whenever their files change
    View(ViewArguments),
    /// Draw a scene, meshes or volumes into a PNG or EXR file, or frames into files or for a video encoder
    Render(RenderArguments),
    /// Find every problem of scenes: syntax, names, values, files
    Check(CheckArguments),
    /// Tell what this machine draws with, or what a scene or a file holds
    Info(InfoArguments),
    /// Write a starter scene, a scene for meshes and volumes, or a starter plugin crate
    New(NewArguments),
    /// Tell of a command, or of a component that scenes are written with; `help components` lists these
    Help(HelpArguments),
}

#[derive(Args, Debug)]
pub(super) struct HelpArguments {
    /// A command, a component such as Volume, or `components`
    pub topic: Option<String>,
}

#[derive(Args, Debug)]
pub(super) struct ViewArguments {
    /// A scene (RON), or meshes, volumes and folders of slices to look at together
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub directions: Directions,
    /// Pixels of the window across and down; else what it was when it was last closed
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// The ViewCamera to begin with, by its entity's name; else the first by name
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Replace a value of the scene
    #[arg(long = "set", value_name = "ENTITY.COMPONENT.FIELD=VALUE")]
    pub overrides: Vec<Override>,
    /// Use only what WebGPU guarantees on every adapter
    #[arg(long)]
    pub portable: bool,
}

#[derive(Args, Debug)]
pub(super) struct RenderArguments {
    /// A scene (RON), or meshes, volumes and folders of slices to draw together
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub directions: Directions,
    /// The picture to write, or - for standard output; without --format its ending says which kind: .png, .exr, .y4m, .rgb
    #[arg(short, long, default_value = "out.png")]
    pub output: PathBuf,
    /// What to write; on standard output PNG where nothing is said
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// Leave the background out: alpha says how much of it each pixel hides
    #[arg(long)]
    pub transparent: bool,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = size)]
    pub size: UVec2,
    /// The ViewCamera to draw with, by its entity's name; else the first by name
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Draw frames A to B-1 of the scene's animation, as out_0000.png and so on; one behind the other where the output can hold them all
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub frames: Option<Range<u64>>,
    /// Frames a second of the animation
    #[arg(long, default_value_t = 25.0, value_parser = rate)]
    pub fps: f64,
    /// Average so many sets of samples in the light that leaves translucent meshes: less noise, in proportion more time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub passes: u32,
    /// Replace a value of the scene
    #[arg(long = "set", value_name = "ENTITY.COMPONENT.FIELD=VALUE")]
    pub overrides: Vec<Override>,
    /// Write what was done, how often, on how much, and how long it took, as JSON
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Use only what WebGPU guarantees on every adapter
    #[arg(long)]
    pub portable: bool,
}

#[derive(Args, Debug)]
pub(super) struct CheckArguments {
    /// Scenes (RON), meshes, volumes, folders of slices
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print the problems as JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub(super) struct InfoArguments {
    /// A scene (RON), or meshes, volumes and folders of slices; without any, the machine
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub(super) struct NewArguments {
    /// The folder to make; or meshes, volumes and folders of slices to write a scene for
    #[arg(required = true, value_name = "DIR|FILE")]
    pub paths: Vec<PathBuf>,
    /// The scene to write for the files
    #[arg(short, long, value_name = "SCENE", conflicts_with = "plugin")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub directions: Directions,
    /// Make a plugin crate with a component of its own instead of a scene
    #[arg(long)]
    pub plugin: bool,
    /// Write what the tour of the README starts from: all example scenes, and what they read
    #[arg(long, conflicts_with = "plugin")]
    pub tour: bool,
    /// For a plugin: the checkout of Tyndall to build against, instead of the published crate
    #[arg(long, value_name = "FOLDER", requires = "plugin")]
    pub tyndall: Option<PathBuf>,
}

fn size(text: &str) -> Result<UVec2, String> {
    let pixels = |text: &str| text.parse::<u32>().ok().filter(|pixels| *pixels > 0);
    let parsed = text
        .split_once(['x', 'X'])
        .and_then(|(across, down)| Some(UVec2::new(pixels(across)?, pixels(down)?)));
    parsed.ok_or_else(|| "expected WIDTHxHEIGHT in pixels, such as 960x540".into())
}

fn frames(text: &str) -> Result<Range<u64>, String> {
    let parsed =
        text.split_once("..").and_then(|(from, to)| Some(from.trim().parse().ok()?..to.trim().parse().ok()?));
    parsed
        .filter(|frames: &Range<u64>| !frames.is_empty())
        .ok_or_else(|| "expected A..B with A below B, such as 0..25".into())
}

fn rate(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|rate: &f64| rate.is_finite() && *rate > 0.0);
    parsed.ok_or_else(|| "expected a number above 0".into())
}
