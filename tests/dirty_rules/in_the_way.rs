//! A block, fog and wax one behind the other in one of two lights.

use crate::table::Table;

/// `a` comes down on `block`, goes through `fog` and gets to `wax`; in `b` they stand side by side.
const SCENE: &str = r#"(
    meshes_shade_volumes: true,
    volumes_shade_meshes: true,
    entities: {
        "eye": ( ViewCamera: (eye: (30.0, 2.0, 4.0), target: (0.0, 0.0, 6.0)) ),
        "a": ( DirectionalLight: (direction: (0.02, 0.0, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        "b": ( DirectionalLight: (direction: (-1.0, 0.2, 0.0), irradiance: (3.0, 2.0, 2.0)) ),
        "block": (
            Transform: (translation: (0.8, 0.0, 12.0)),
            Mesh: Box(size: (1.0, 1.0, 1.0)),
            Phong: (diffuse: (0.5, 0.6, 0.7)),
        ),
        "fog": (
            Transform: (translation: (0.0, 0.0, 6.0)),
            Volume: Raw(path: "fog.raw", size: (12, 12, 16), spacing: (0.25, 0.25, 0.25)),
            TransferFunction: (
                domain: (0.0, 120.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (1.0, (0.5, 0.9, 0.2), 0.3)],
                entries: 64,
            ),
            VolumeLighting: LightVolume(g: 0.2),
            Shading: Scattering,
        ),
        "wax": (
            Transform: (translation: (0.0, 0.0, 0.0)),
            Mesh: Sphere(radius: 1.5, subdivisions: 2),
            Subsurface: (material: Preset("skin1"), g: 0.2),
            ScatteringMaps: (samples: 4, progressive: false),
            Shading: Scattering,
        ),
    },
)"#;

/// The light of `a` on `wax`, without `fog` in between.
const WAX_LIT: &str = "light_gbuffer 1, scattered_radiosity 1, combine 1";
/// What stands in the way of `a` does so elsewhere, for `fog` and for `wax`.
const BLOCK_MOVED: &str = "volume_shadow 1, scattered_light 1, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1";

pub const TABLE: Table = Table {
    name: "in the way",
    scene: SCENE,
    rows: &[
        ("meshes_shade_volumes", "false", "scattered_light 1, summed_light 1"),
        ("volumes_shade_meshes", "false", WAX_LIT),
        ("a.DirectionalLight.irradiance", "(2.0, 2.0, 1.0)", "combine 1, summed_light 1"),
        (
            "a.DirectionalLight.direction",
            "(0.03, 0.0, -1.0)",
            "light_volume 1, volume_shadow 1, scattered_light 1, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        (
            "b.DirectionalLight.direction",
            "(-1.0, 0.3, 0.0)",
            "light_volume 1, scattered_light 1, summed_light 1, light_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        ("block.Transform.translation", "(0.9, 0.0, 12.0)", BLOCK_MOVED),
        (
            "block.Transform.translation",
            "(20.0, 0.0, 12.0)",
            "scattered_light 1, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        (
            "block.Mesh.size",
            "(1.0, 1.2, 1.0)",
            "upload_meshes 1 of 12 triangles, volume_shadow 1, scattered_light 1, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        ("block.Phong.diffuse", "(0.9, 0.6, 0.7)", ""),
        ("fog.Transform.translation", "(0.1, 0.0, 6.0)", BLOCK_MOVED),
        (
            "fog.TransferFunction.points[1].2",
            "0.4",
            "classify 1, light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        (
            "fog.TransferFunction.points[1].1",
            "(0.5, 0.2, 0.2)",
            "classify 1, light_cells 1, light_network 1, scattered_light 2, summed_light 1",
        ),
        ("fog.VolumeLighting.g", "0.3", "light_network 1, scattered_light 2, summed_light 1"),
        ("fog.VolumeLighting", "EmissionAbsorption", WAX_LIT),
        ("fog.Shading", "Local", WAX_LIT),
        (
            "wax.Transform.translation",
            "(0.1, 0.0, 0.0)",
            "light_gbuffer 2, dimmed_gbuffer 1, scattered_radiosity 2, combine 1",
        ),
        (
            "fog.VolumeLighting",
            "LightVolume(g: 0.2, resolution: 0.5)",
            "light_volume 2, scattered_light 2, summed_light 1, light_gbuffer 1, dimmed_gbuffer 1, scattered_radiosity 1, combine 1",
        ),
        ("wax.Subsurface.g", "0.3", "scattered_radiosity 2, combine 1"),
        ("wax.Subsurface.g", "None", "scattered_radiosity 2, combine 1"),
        ("wax.Subsurface.material.0", "\"marble\"", "scattered_radiosity 2, combine 1"),
        ("wax.Shading", "Local", ""),
    ],
};
