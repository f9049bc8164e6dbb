//! `tyndall info`.

use super::arguments::InfoArguments;
use super::exit::{self, Failure};
use super::open::{Directions, Input};
use super::render::gpu_description;
use super::terminal;
use crate::components::LabelColour;
use crate::gpu::{Gpu, GpuOptions};
use crate::loading::{Contents, contents};
use crate::optics::labels::srgb_of_linear;
use crate::plain;
use crate::render;
use crate::sources::Histogram;
use bevy_app::App;
use serde_json::{Value, json};

/// Of the histogram's 256, so that it fits a terminal's line.
const BINS_PER_COLUMN: usize = 4;

pub(super) fn run(app: &mut App, arguments: &InfoArguments) -> Result<(), Failure> {
    let facts = match arguments.files.as_slice() {
        [] => machine()?,
        files => {
            let input = Input::of(files, &Directions { up: None, front: None })?;
            let document = input.load(app, &[]);
            let problems = render::all_problems(app, &document);
            exit::print(&problems);
            if problems.iter().any(|problem| problem.severity == crate::scene::Severity::Error) {
                return Err(Failure::Input);
            }
            let entities = contents(app.world_mut());
            entities
                .iter()
                .map(|(name, contents)| (name.clone(), describe(contents, arguments.json)))
                .collect::<serde_json::Map<_, _>>()
                .into()
        }
    };
    if arguments.json { terminal::json(&facts) } else { terminal::data(&lines(&facts, 0)) }
}

fn machine() -> Result<Value, Failure> {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default()))?;
    let limits = gpu.device.limits();
    Ok(json!({
        "tyndall": env!("CARGO_PKG_VERSION"),
        "adapter": gpu_description(&gpu),
        "limits": {
            "picture": limits.max_texture_dimension_2d,
            "volume side": limits.max_texture_dimension_3d,
            "volumes at once": limits.max_sampled_textures_per_shader_stage - 3,
            "mesh buffer bytes": limits.max_buffer_size,
        },
    }))
}

fn describe(contents: &Contents, for_machines: bool) -> Value {
    match contents {
        Contents::Mesh(mesh) => json!({
            "vertices": mesh.vertices,
            "triangles": mesh.triangles,
            "area": mesh.area,
            "open edges": mesh.open_edges,
            "non-manifold edges": mesh.non_manifold_edges,
            "components": mesh.components,
            "closed components": mesh.closed_components,
            "volume": mesh.volume,
            "mean thickness": mesh.thickness,
            "bounds": mesh.bounds.map(|(low, high)| [low.to_array(), high.to_array()]),
        }),
        Contents::Volume { size, format, spacing, range, non_finite, histogram, labels } => {
            let mut facts = json!({
            "size": size,
            "format": format!("{format:?}"),
            "spacing mm": spacing.to_array(),
            "range": [range.0, range.1],
            "non-finite": non_finite,
            "histogram": if for_machines {
                json!({ "range": [histogram.range.0, histogram.range.1], "bins": histogram.bins })
            } else {
                sparkline(histogram).into()
            },
            });
            if !labels.is_empty() {
                facts["labels"] = labels.iter().map(|label| describe_label(label, for_machines)).collect();
            }
            facts
        }
    }
}

/// A label by its value: colour as sRGB encodes it, opacity, name, voxels.
fn describe_label((label, voxels): &(LabelColour, u64), for_machines: bool) -> (String, Value) {
    let [red, green, blue] =
        srgb_of_linear(label.color).to_array().map(|channel| (255.0 * channel).round() as u8);
    let colour = format!("#{red:02x}{green:02x}{blue:02x}");
    let LabelColour { opacity, name, .. } = label;
    let facts = if for_machines {
        json!({ "colour": colour, "opacity": opacity, "name": name, "voxels": voxels })
    } else {
        let opacity = if *opacity == 1.0 { String::new() } else { format!(", opacity {opacity}") };
        let name = if name.is_empty() { String::new() } else { format!(", {name}") };
        format!("{colour}{opacity}, {voxels} voxels{name}").into()
    };
    (label.value.to_string(), facts)
}

/// A histogram as a line of bars between its ends; their heights are logarithms of the counts, as one value often outnumbers the others.
fn sparkline(histogram: &Histogram) -> String {
    const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let columns: Vec<u64> = histogram
        .bins
        .chunks(BINS_PER_COLUMN)
        .map(|bins| bins.iter().copied().fold(0, u64::saturating_add))
        .collect();
    let height = |samples: u64| ((samples as f64) + 1.0).ln();
    let greatest = columns.iter().map(|&samples| height(samples)).fold(0.0, f64::max);
    let bar = |&samples: &u64| match samples {
        0 => ' ',
        samples => BARS[((height(samples) / greatest * 8.0).ceil() as usize).clamp(1, 8) - 1],
    };
    let bars: String = columns.iter().map(bar).collect();
    format!("{} |{bars}| {} (log)", histogram.range.0, histogram.range.1)
}

/// Nested facts as indented lines.
fn lines(facts: &Value, depth: usize) -> String {
    let Value::Object(facts) = facts else { return String::new() };
    let indent = "  ".repeat(depth);
    let line = |(name, value): (&String, &Value)| match value {
        Value::Object(_) => format!("{indent}{}\n{}", plain::line(name), lines(value, depth + 1)),
        Value::String(text) => format!("{indent}{name}: {text}\n"),
        other => format!("{indent}{name}: {other}\n"),
    };
    facts.iter().map(line).collect()
}
