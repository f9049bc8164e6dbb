//! What each sheet shows.

use super::scans::Scan;

/// A contact sheet: one scan in many cells.
pub struct Sheet {
    pub name: &'static str,
    pub title: &'static str,
    pub scan: Scan,
    /// Degrees about the x axis that make the scan stand upright, then about the vertical.
    pub turned: (f64, f64),
    /// How tall it is, in millimetres: small enough for light to come through.
    pub millimetres: f64,
    pub columns: usize,
    /// How much wider than tall its cells are.
    pub aspect: f64,
    /// Sets of samples that are averaged where the command says nothing else.
    pub passes: u32,
    /// The cells of a row, one after the other for each of `lights`.
    row: &'static [Look],
    lights: &'static [Light],
}

/// One cell.
pub struct Cell {
    pub label: String,
    pub look: Look,
    pub light: Light,
}

/// What a cell's body is like.
#[derive(Clone, Copy)]
pub struct Look {
    label: &'static str,
    pub material: &'static str,
    pub model: &'static str,
    /// In RON.
    pub specular: &'static str,
    /// Fields of `ScatteringMaps`, in RON.
    pub maps: &'static str,
}

/// A directional light.
#[derive(Clone, Copy)]
pub struct Light {
    label: &'static str,
    pub direction: (f64, f64, f64),
    pub irradiance: f64,
}

const FRONT: Light = Light { label: "front", direction: (0.6, -0.7, -1.0), irradiance: 3.0 };
const BEHIND: Light = Light { label: "behind", direction: (-0.25, -0.45, 1.0), irradiance: 5.0 };
/// For what lets little through.
const BRIGHT: Light = Light { irradiance: 12.0, ..BEHIND };

const PLAIN: Look =
    Look { label: "", material: "cream", model: "CalibratedDipole", specular: "None", maps: "" };

/// Maps of so many texels that they can be compared with the published ones.
const fn maps(label: &'static str, maps: &'static str) -> Look {
    Look { label, maps, ..PLAIN }
}

const fn model(label: &'static str, material: &'static str, model: &'static str) -> Look {
    Look { label, material, model, ..PLAIN }
}

/// The sheets, in the order in which they are drawn.
pub const SHEETS: &[Sheet] = &[
    Sheet {
        name: "bunny",
        title: "Bunny, 40 mm, cream: cameras and strategies",
        scan: Scan::Bunny,
        turned: (0.0, 0.0),
        millimetres: 40.0,
        columns: 6,
        aspect: 1.0,
        passes: 1,
        row: &[
            maps("Adaptive, points", ""),
            maps("Adaptive, K = 4", "cameras: 4, resolution: Texels(512, 512)"),
            maps("Adaptive, K = 8", "cameras: 8, resolution: Texels(512, 512)"),
            maps("Adaptive, K = 16", "cameras: 16, resolution: Texels(512, 512)"),
            maps("Uniform, K = 16", "strategy: Uniform, cameras: 16, resolution: Texels(512, 512)"),
            // The radius at which what is published looks best here.
            maps(
                "Uniform, K = 16, 2 mm",
                "strategy: Uniform, cameras: 16, resolution: Texels(512, 512), radius: Millimetres(2.0)",
            ),
        ],
        lights: &[FRONT, BRIGHT],
    },
    Sheet {
        name: "dragon",
        title: "Dragon, 25 mm, skin",
        scan: Scan::Dragon,
        turned: (0.0, 0.0),
        millimetres: 25.0,
        columns: 2,
        aspect: 1.4,
        passes: 16,
        row: &[Look { material: "skin1", ..PLAIN }],
        lights: &[FRONT, BEHIND],
    },
    Sheet {
        name: "buddha",
        title: "Buddha, 40 mm: models",
        scan: Scan::Buddha,
        turned: (0.0, 0.0),
        millimetres: 40.0,
        columns: 6,
        aspect: 0.6,
        passes: 16,
        row: &[
            model("milk, standard", "wholemilk", "StandardDipole"),
            model("milk, directional", "wholemilk", "DirectionalDipole"),
            model("milk, calibrated", "wholemilk", "CalibratedDipole"),
            model("potato, standard", "potato", "StandardDipole"),
            model("potato, directional", "potato", "DirectionalDipole"),
            model("potato, calibrated", "potato", "CalibratedDipole"),
        ],
        lights: &[FRONT, BEHIND],
    },
    Sheet {
        name: "lucy",
        title: "Lucy, 60 mm, marble with a highlight",
        scan: Scan::Lucy,
        turned: (-90.0, 180.0),
        millimetres: 60.0,
        columns: 2,
        aspect: 0.7,
        passes: 16,
        row: &[Look { material: "marble", specular: "Some((strength: 0.04, shininess: 120.0))", ..PLAIN }],
        lights: &[FRONT, BEHIND],
    },
    Sheet {
        name: "sphere",
        title: "Sphere, 20 mm, potato",
        scan: Scan::Sphere,
        turned: (0.0, 0.0),
        millimetres: 20.0,
        columns: 2,
        aspect: 1.0,
        passes: 16,
        row: &[Look { material: "potato", ..PLAIN }],
        lights: &[FRONT, BRIGHT],
    },
    Sheet {
        name: "spot",
        title: "Spot, 40 mm, wax",
        scan: Scan::Spot,
        turned: (0.0, 150.0),
        millimetres: 40.0,
        columns: 2,
        aspect: 0.8,
        passes: 16,
        row: &[Look { material: "wax", ..PLAIN }],
        lights: &[FRONT, BEHIND],
    },
];

impl Sheet {
    /// Row by row.
    pub fn cells(&self) -> Vec<Cell> {
        let row = |light: &'static Light| {
            self.row.iter().map(|look| {
                let comma = if look.label.is_empty() { "" } else { ", " };
                Cell { label: format!("{}{comma}{}", look.label, light.label), look: *look, light: *light }
            })
        };
        self.lights.iter().flat_map(row).collect()
    }
}
