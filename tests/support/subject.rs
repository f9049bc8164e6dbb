//! One translucent mesh, the light that leaves its points, and what that should be.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::support::Studio;
use bevy_ecs::prelude::*;
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;
use tyndall::components::{MapResolution, ScatteringCameraOf, ScatteringMaps, Subsurface};
use tyndall::cpu::{ScatteredPoint, brute_force, scattered_points};
use tyndall::report::{PassRecord, Report};
use tyndall::{LightTexels, Refinement, render};

pub const MARBLE: &str = "Preset(\"marble\")";

pub const LIGHT: &str = "\"light\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0)) ),";

/// A picture so small that it costs nothing: points are what is looked at.
pub const PIXELS: u32 = 96;

/// One translucent mesh in one light.
pub struct Subject {
    pub studio: Studio,
    pub mesh: Entity,
}

/// Points at which the light is known.
pub struct Truth {
    pub indices: Vec<usize>,
    pub radiosity: Vec<DVec3>,
}

impl Subject {
    pub fn new(mesh: &str, material: &str, millimetres: f64) -> Self {
        let mesh = format!("{LIGHT} \"mesh\": ( Mesh: {mesh}, Subsurface: (material: {material}) )");
        Self::of(Studio::new(), &mesh, millimetres)
    }

    pub fn of(mut studio: Studio, entities: &str, millimetres: f64) -> Self {
        studio.app.world_mut().resource_mut::<Report>().measure = true;
        let scene = format!("(millimetres_per_unit: {millimetres:?}, entities: {{ {entities} }})");
        studio.radiance(&scene, PIXELS, PIXELS);
        let world = studio.app.world_mut();
        let mesh = world.query_filtered::<Entity, With<Subsurface>>().single(world).unwrap();
        Self { studio, mesh }
    }

    pub fn sphere(subdivisions: u32) -> Self {
        Self::new(&format!("Sphere(subdivisions: {subdivisions})"), MARBLE, 20.0)
    }

    pub fn bunny() -> Self {
        let path = Path::new(&std::env::var("TYNDALL_DATA").unwrap()).join("meshes/stanford-bunny.obj");
        Self::new(&format!("File(path: {path:?}, normals: Smooth(180.0))"), MARBLE, 250.0)
    }

    pub fn world(&mut self) -> &mut World {
        self.studio.app.world_mut()
    }

    pub fn set(&mut self, component: impl Component) {
        let mesh = self.mesh;
        self.world().entity_mut(mesh).insert(component);
    }

    /// What runs in the next frame.
    pub fn frame(&mut self) -> BTreeMap<&'static str, PassRecord> {
        self.world().resource_mut::<Report>().passes.clear();
        render::render(&mut self.studio.app).unwrap();
        self.studio.report().passes.clone()
    }

    pub fn points(&self) -> Vec<ScatteredPoint> {
        scattered_points(self.studio.app.world(), self.mesh).unwrap()
    }

    pub fn radiosity(&self) -> Vec<DVec3> {
        self.points().iter().map(|point| point.radiosity.as_dvec3()).collect()
    }

    /// What the points send out with these maps.
    pub fn with(&mut self, maps: ScatteringMaps) -> Vec<DVec3> {
        self.set(maps);
        self.frame();
        self.radiosity()
    }

    pub fn refine(&mut self, sets: u32, per_update: u32) {
        self.world().insert_resource(Refinement { sets, per_update });
    }

    /// What leaves points spread over the surface, summed over as many texels of the light along a side.
    pub fn truth(&mut self, probes: usize, texels: u32) -> Truth {
        let usual = *self.world().resource::<LightTexels>();
        self.world().insert_resource(LightTexels(texels));
        self.frame();
        let points = self.points();
        let indices: Vec<usize> = (0..probes).map(|index| index * points.len() / probes).collect();
        let chosen: Vec<ScatteredPoint> = indices.iter().map(|index| points[*index]).collect();
        let radiosity = brute_force(self.studio.app.world(), self.mesh, &chosen).unwrap();
        self.world().insert_resource(usual);
        self.frame();
        Truth { indices, radiosity }
    }

    /// How many scattering cameras look at the mesh, and how many of them are its children.
    pub fn cameras(&mut self) -> (usize, usize) {
        let mesh = self.mesh;
        let world = self.world();
        let mut cameras = world.query::<(&ScatteringCameraOf, Option<&ChildOf>)>();
        let all: Vec<bool> = cameras
            .iter(world)
            .filter(|(of, _)| of.0 == mesh)
            .map(|(_, parent)| parent.is_some_and(|parent| parent.parent() == mesh))
            .collect();
        (all.len(), all.iter().filter(|is_child| **is_child).count())
    }
}

impl Truth {
    pub fn of(&self, found: &[DVec3]) -> Vec<DVec3> {
        self.indices.iter().map(|index| found[*index]).collect()
    }

    pub fn error(&self, found: &[DVec3]) -> f64 {
        relative_rmse(&self.of(found), &self.radiosity)
    }

    /// How far the mean of all probes is off.
    pub fn mean_error(&self, found: &[DVec3]) -> f64 {
        mean(&self.of(found)) / mean(&self.radiosity) - 1.0
    }
}

pub fn relative_rmse(found: &[DVec3], truth: &[DVec3]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let wrong: f64 = found.iter().zip(truth).map(|(found, truth)| found.distance_squared(*truth)).sum();
    (wrong / truth.iter().map(|truth| truth.length_squared()).sum::<f64>()).sqrt()
}

pub fn mean(radiosity: &[DVec3]) -> f64 {
    radiosity.iter().map(|radiosity| radiosity.element_sum() / 3.0).sum::<f64>() / radiosity.len() as f64
}

/// Maps of square texels.
pub fn maps(cameras: u32, side: u32) -> ScatteringMaps {
    ScatteringMaps { cameras, resolution: MapResolution::Texels(side, side), ..Default::default() }
}

pub fn work(passes: &BTreeMap<&'static str, PassRecord>, pass: &str, unit: &str) -> u64 {
    passes[pass].work[unit]
}
