//! What meshes can be besides, and maps as they were published.

use crate::table::Table;

const SCENE: &str = r#"(
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 20.0), projection: Orthographic(height: 10.0)) ),
        "a": ( DirectionalLight: (direction: (0.2, -0.1, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        "b": ( DirectionalLight: (direction: (0.5, 0.5, -1.0), irradiance: (3.0, 2.0, 2.0)) ),
        "shard": (
            Transform: (translation: (-2.5, 0.0, 0.0), scale: (1.0, 0.8, 1.2)),
            Mesh: File("shard.obj"),
            Subsurface: (material: Custom(sigma_t: (5.0, 5.0, 4.0), albedo: (0.9, 0.8, 0.95))),
            ScatteringMaps: (
                strategy: Uniform, cameras: 2, samples: 4, candidates: 8, resolution: Texels(16, 16),
                radius: Millimetres(1.0), bias: 0.1, progressive: false,
            ),
        ),
        "tile": (
            Transform: (translation: (2.5, 0.0, 0.0), rotation: (70.0, 20.0, 0.0)),
            Mesh: Plane(size: (3.0, 2.0)),
        ),
    },
)"#;

/// Of one mesh, in two lights.
const SCATTERS_OTHERWISE: &str = "scattered_radiosity 2, combine 1";
const MAPPED: &str = "scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1";
const RESHAPED: &str = "upload_meshes 1, surface_points 1, light_gbuffer 2, scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1";

pub const TABLE: Table = Table {
    name: "meshes",
    scene: SCENE,
    rows: &[
        ("eye.ViewCamera.projection.height", "11.0", ""),
        ("shard.Mesh.path", "\"other.obj\"", RESHAPED),
        ("shard.Mesh", "Sphere(radius: 1.0, subdivisions: 1)", RESHAPED),
        ("shard.Mesh.normals", "Flat", RESHAPED),
        ("shard.Mesh.normals", "Smooth(100.0)", RESHAPED),
        (
            "shard.Transform.scale",
            "(1.0, 0.9, 1.2)",
            "surface_points 1, light_gbuffer 2, scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1",
        ),
        ("shard.Subsurface.material.sigma_t", "(5.0, 6.0, 4.0)", SCATTERS_OTHERWISE),
        ("shard.Subsurface.material.albedo", "(0.9, 0.9, 0.95)", SCATTERS_OTHERWISE),
        (
            "shard.Subsurface.material",
            "Custom(sigma_a: (0.1, 0.1, 0.1), sigma_s: (3.0, 3.0, 3.0))",
            SCATTERS_OTHERWISE,
        ),
        ("shard.ScatteringMaps.strategy", "Adaptive", MAPPED),
        ("shard.ScatteringMaps.samples", "5", SCATTERS_OTHERWISE),
        ("shard.ScatteringMaps.candidates", "6", SCATTERS_OTHERWISE),
        ("shard.ScatteringMaps.candidates", "Auto", SCATTERS_OTHERWISE),
        ("shard.ScatteringMaps.radius.0", "0.3", SCATTERS_OTHERWISE),
        ("shard.ScatteringMaps.radius", "Auto", SCATTERS_OTHERWISE),
        ("shard.ScatteringMaps.bias", "0.2", MAPPED),
        ("tile.Mesh.size", "(3.0, 2.5)", "upload_meshes 1 of 2 triangles"),
        ("tile.Mesh", "CornellBox", "upload_meshes 1 of 10 triangles"),
    ],
};
