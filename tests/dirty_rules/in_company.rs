//! Opaque and translucent meshes beside volumes, all out of each other's light.

use crate::table::Table;

/// `wax` is computed at the points of its surface, `jar` in maps; `fog` scatters light, `smoke` emits it.
pub const SCENE: &str = r#"(
    millimetres_per_unit: 1.0,
    background: (0.1, 0.1, 0.2),
    shading: Scattering,
    meshes_shade_volumes: true,
    volumes_shade_meshes: true,
    entities: {
        "eye": ( ViewCamera: (
            eye: (0.0, 0.0, 40.0), target: (0.0, 0.0, 0.0), up: (0.0, 1.0, 0.0),
            projection: Perspective(vertical_fov: 35.0), exposure: 0.0, gamma: 2.2,
        ) ),
        "a": ( DirectionalLight: (direction: (0.2, -0.1, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        "b": ( DirectionalLight: (direction: (0.5, 0.5, -1.0), irradiance: (3.0, 2.0, 2.0)) ),
        "wax": (
            Transform: (translation: (-8.0, 0.0, 0.0), rotation: (0.0, 0.0, 0.0), scale: 1.0),
            Mesh: Sphere(radius: 2.0, subdivisions: 2),
            Subsurface: (
                material: Custom(sigma_a: (0.1, 0.2, 0.3), sigma_s: (5.0, 5.0, 4.0), g: 0.1, eta: 1.3),
                model: CalibratedDipole,
                specular: Some((strength: 0.2, shininess: 20.0)),
                local: (ambient: (0.1, 0.1, 0.1), diffuse: (0.5, 0.6, 0.7), specular: (0.1, 0.1, 0.1), shininess: 9.0),
            ),
            ScatteringMaps: (
                strategy: Adaptive, cameras: 2, samples: 4, candidates: Auto, resolution: Auto, radius: Auto,
                bias: Auto, progressive: false,
            ),
            Shading: Scattering,
        ),
        "jar": (
            Transform: (translation: (8.0, 0.0, 0.0)),
            Mesh: Sphere(radius: 2.0, subdivisions: 1),
            Subsurface: (material: Preset("skin1"), g: Some(0.2)),
            ScatteringMaps: (cameras: 2, samples: 4, resolution: Texels(16, 20), progressive: false),
        ),
        "above": ( ScatteringCamera: (target: "jar", direction: (0.1, -1.0, 0.0)) ),
        "block": (
            Transform: (translation: (0.0, 8.0, 0.0), rotation: (10.0, 20.0, 0.0), scale: 1.5),
            Mesh: Box(size: (2.0, 2.0, 2.0)),
            Phong: (ambient: (0.1, 0.1, 0.1), diffuse: (0.5, 0.6, 0.7), specular: (0.1, 0.1, 0.1), shininess: 9.0),
            Lifted: (by: 0.5),
            Caption: (text: "a block"),
        ),
        "fog": (
            Transform: (translation: (0.0, 0.0, 0.0), rotation: (0.0, 0.0, 0.0), scale: 1.0),
            Volume: Raw(
                path: "fog.raw", size: (12, 12, 16), format: U8, endian: Little, spacing: (0.25, 0.25, 0.25),
                skip_bytes: 0,
            ),
            TransferFunction: (
                domain: (0.0, 120.0),
                points: [(0.0, (1.0, 0.5, 0.2), 0.0), (0.3, (0.9, 0.6, 0.2), 0.05), (1.0, (0.5, 0.9, 0.2), 0.3)],
                entries: 64, classification: Post, opacity_length: 0.25,
            ),
            VolumeLighting: LightVolume(
                cone_angle: Auto, resolution: 1.0, blend: true, towards_eye: false, gradient_specular: 0.1,
                emission: 0.0, g: 0.2,
            ),
            RayCast: (step: 0.5, early_termination: 0.99, skip_empty: true),
            Shading: Scattering,
        ),
        "smoke": (
            Transform: (translation: (0.0, -8.0, 0.0)),
            Volume: Raw(path: "smoke.raw", size: (10, 10, 10), format: U8, spacing: (0.4, 0.4, 0.4)),
            TransferFunction: (
                iso: [(value: 40.0, width: 10.0, color: (0.2, 0.8, 0.1), absorption: 0.5)],
                entries: 32, classification: PreIntegrated,
            ),
            VolumeLighting: Gradient(ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 16.0),
            RayCast: (step: 1.0),
        ),
    },
)"#;

/// Light is scattered linearly: of a light's colour only the sums over all lights are made again.
const LIGHT_COLOURED: &str = "combine 2, summed_light 1";

/// Of two lights one, on two meshes and one volume.
pub const LIGHT_TURNED: &str =
    "light_gbuffer 2, scattered_radiosity 2, combine 2, light_volume 1, scattered_light 1, summed_light 1";

/// Whatever scatters does so otherwise, since coefficients are per millimetre.
const UNIT_CHANGED: &str = "scattered_radiosity 4, combine 2, classify 2, preintegrate 1, light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1";

/// The light of two lights that leaves one mesh.
const WAX_SCATTERS_OTHERWISE: &str = "scattered_radiosity 2, combine 1";
const WAX_MOVED: &str = "light_gbuffer 2, scattered_radiosity 2, combine 1";
pub const WAX_RESHAPED: &str =
    "upload_meshes 1, surface_points 1, light_gbuffer 2, scattered_radiosity 2, combine 1";
const WAX_MAPPED: &str = "scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1";

const JAR_SCATTERS_OTHERWISE: &str = "scattered_radiosity 2, combine 1";
pub const JAR_MAPPED: &str = "scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1";
const JAR_MOVED: &str =
    "light_gbuffer 2, scattering_gbuffer 1, scattering_texels 1, scattered_radiosity 2, combine 1";

/// The light of two lights in one volume, from its medium on.
const FOG_RECLASSIFIED: &str =
    "classify 1, light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1";
/// The same where light arrives as before.
const FOG_COLOURED: &str =
    "classify 1 of 64 entries, light_cells 1, light_network 1, scattered_light 2, summed_light 1";
pub const FOG_RELOADED: &str = "upload_volumes 1 of 2304 voxels, classify 1, light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1";
pub const FOG_LIT_ANEW: &str =
    "light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1";
const FOG_SCATTERS_OTHERWISE: &str = "light_network 1, scattered_light 2, summed_light 1";

pub const SMOKE_RECLASSIFIED: &str = "classify 1 of 32 entries, preintegrate 1";
pub const SMOKE_RELOADED: &str = "upload_volumes 1 of 1000 voxels, classify 1 of 32 entries, preintegrate 1";

pub const TABLE: Table = Table {
    name: "in company",
    scene: SCENE,
    rows: &[
        // The frame alone.
        ("eye.ViewCamera.eye", "(1.0, 2.0, 41.0)", ""),
        ("eye.ViewCamera.target", "(0.5, 0.0, 0.0)", ""),
        ("eye.ViewCamera.up", "(0.2, 1.0, 0.0)", ""),
        ("eye.ViewCamera.projection.vertical_fov", "40.0", ""),
        ("eye.ViewCamera.projection", "Orthographic(height: 30.0)", ""),
        ("eye.ViewCamera.exposure", "1.0", ""),
        ("eye.ViewCamera.gamma", "1.8", ""),
        ("eye.ViewCamera.gamma", "Auto", ""),
        ("background", "(0.3, 0.0, 0.1)", ""),
        ("block.Phong.ambient", "(0.2, 0.1, 0.1)", ""),
        ("block.Phong.diffuse", "(0.2, 0.6, 0.7)", ""),
        ("block.Phong.specular", "(0.3, 0.1, 0.1)", ""),
        ("block.Phong.shininess", "30.0", ""),
        ("block.Caption.text", "\"the block\"", ""),
        ("block.Lifted.by", "0.6", ""),
        // The head.
        ("millimetres_per_unit", "2.0", UNIT_CHANGED),
        ("shading", "Local", ""),
        ("meshes_shade_volumes", "false", ""),
        ("volumes_shade_meshes", "false", ""),
        // Lights.
        ("a.DirectionalLight.irradiance", "(2.0, 2.0, 1.0)", LIGHT_COLOURED),
        ("b.DirectionalLight.direction", "(0.5, 0.4, -1.0)", LIGHT_TURNED),
        ("b.DirectionalLight.direction", "(1.0, 1.0, -2.0)", ""),
        // A mesh that scatters, at the points of its surface.
        ("wax.Transform.translation", "(-8.0, 0.5, 0.0)", WAX_MOVED),
        ("wax.Transform.rotation", "(0.0, 10.0, 0.0)", WAX_MOVED),
        ("wax.Transform.scale", "1.1", WAX_MOVED),
        ("wax.Mesh.radius", "2.1", WAX_RESHAPED),
        ("wax.Mesh.subdivisions", "1", WAX_RESHAPED),
        ("wax.Mesh", "Box(size: (3.0, 2.0, 2.0))", WAX_RESHAPED),
        ("wax.Subsurface.material.sigma_a", "(0.3, 0.2, 0.3)", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.material.sigma_s", "(5.0, 6.0, 4.0)", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.material.g", "0.2", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.material.eta", "1.4", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.material", "Preset(\"marble\")", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.model", "DirectionalDipole", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.model", "StandardDipole", WAX_SCATTERS_OTHERWISE),
        ("wax.Subsurface.specular", "None", ""),
        ("wax.Subsurface.specular.strength", "0.4", ""),
        ("wax.Subsurface.specular.shininess", "40.0", ""),
        ("wax.Subsurface.local.ambient", "(0.2, 0.1, 0.1)", ""),
        ("wax.Subsurface.local.diffuse", "(0.2, 0.6, 0.7)", ""),
        ("wax.Subsurface.local.specular", "(0.3, 0.1, 0.1)", ""),
        ("wax.Subsurface.local.shininess", "30.0", ""),
        ("wax.ScatteringMaps.strategy", "Uniform", WAX_MAPPED),
        ("wax.ScatteringMaps.cameras", "3", ""),
        ("wax.ScatteringMaps.samples", "5", WAX_SCATTERS_OTHERWISE),
        ("wax.ScatteringMaps.candidates", "8", ""),
        ("wax.ScatteringMaps.resolution", "Texels(16, 16)", WAX_MAPPED),
        ("wax.ScatteringMaps.radius", "Millimetres(0.5)", WAX_SCATTERS_OTHERWISE),
        ("wax.ScatteringMaps.bias", "0.1", ""),
        ("wax.ScatteringMaps.progressive", "true", ""),
        ("wax.Shading", "Local", ""),
        // One that does so in maps, and its camera.
        ("jar.Transform.translation", "(8.0, 0.5, 0.0)", JAR_MOVED),
        ("jar.Subsurface.g", "0.5", JAR_SCATTERS_OTHERWISE),
        ("jar.Subsurface.material.0", "\"marble\"", JAR_SCATTERS_OTHERWISE),
        ("jar.Subsurface.g", "0.7", JAR_SCATTERS_OTHERWISE),
        ("jar.Subsurface.g", "None", JAR_SCATTERS_OTHERWISE),
        ("jar.ScatteringMaps.cameras", "3", JAR_MAPPED),
        ("jar.ScatteringMaps.resolution.0", "18", JAR_MAPPED),
        ("jar.ScatteringMaps.resolution.1", "18", JAR_MAPPED),
        ("jar.ScatteringMaps.bias", "0.1", JAR_MAPPED),
        ("above.ScatteringCamera.direction", "(0.2, -1.0, 0.0)", JAR_MAPPED),
        (
            "above.ScatteringCamera.target",
            "\"wax\"",
            "scattering_gbuffer 2, scattering_texels 2, scattered_radiosity 4, combine 2",
        ),
        // A mesh that stands in nobody's light.
        ("block.Transform.translation", "(0.0, 9.0, 0.0)", ""),
        ("block.Transform.scale", "(1.0, 1.5, 1.2)", ""),
        ("block.Mesh.size", "(2.0, 2.0, 1.0)", "upload_meshes 1 of 12 triangles"),
        ("block.Mesh", "Plane(size: (2.0, 2.0))", "upload_meshes 1 of 2 triangles"),
        // A volume that scatters.
        ("fog.Transform.translation", "(0.0, 0.5, 0.0)", ""),
        ("fog.Transform.rotation", "(0.0, 10.0, 0.0)", "light_volume 2, scattered_light 2, summed_light 1"),
        ("fog.Transform.scale", "1.1", "light_volume 2, light_network 1, scattered_light 2, summed_light 1"),
        ("fog.Volume.path", "\"thin.raw\"", FOG_RELOADED),
        ("fog.Volume.size", "(12, 16, 12)", FOG_RELOADED),
        ("fog.Volume.format", "I8", FOG_RELOADED),
        ("fog.Volume.endian", "Big", FOG_RELOADED),
        ("fog.Volume.spacing", "(0.25, 0.2, 0.25)", FOG_RELOADED),
        ("fog.TransferFunction.domain", "(10.0, 120.0)", FOG_RECLASSIFIED),
        ("fog.TransferFunction.domain", "Auto", FOG_RECLASSIFIED),
        ("fog.TransferFunction.points[1].0", "0.4", FOG_RECLASSIFIED),
        ("fog.TransferFunction.points[1].1", "(0.9, 0.6, 0.8)", FOG_COLOURED),
        ("fog.TransferFunction.points[1].2", "0.06", FOG_RECLASSIFIED),
        ("fog.TransferFunction.points", "[(1.0, (0.5, 0.9, 0.2), 0.3)]", FOG_RECLASSIFIED),
        ("fog.TransferFunction.entries", "128", FOG_RECLASSIFIED),
        ("fog.TransferFunction.opacity_length", "0.5", FOG_RECLASSIFIED),
        // As long as a voxel, which it is already: the table is made again, but what is made from it is not.
        ("fog.TransferFunction.opacity_length", "Auto", "classify 1 of 64 entries"),
        (
            "fog.TransferFunction.classification",
            "Pre",
            "classify 1 of 64 entries, preclassify 1 of 2304 voxels",
        ),
        ("fog.VolumeLighting.cone_angle", "30.0", FOG_SCATTERS_OTHERWISE),
        ("fog.VolumeLighting.resolution", "0.5", "light_volume 2, scattered_light 2, summed_light 1"),
        ("fog.VolumeLighting.blend", "false", "scattered_light 2, summed_light 1"),
        (
            "fog.VolumeLighting.towards_eye",
            "true",
            "light_network 1, scattered_light 2, summed_light 1, eye_light 1",
        ),
        ("fog.VolumeLighting.gradient_specular", "0.2", ""),
        ("fog.VolumeLighting.emission", "0.1", ""),
        ("fog.VolumeLighting.g", "0.3", FOG_SCATTERS_OTHERWISE),
        ("fog.VolumeLighting", "SingleScattering()", ""),
        ("fog.VolumeLighting", "Gradient()", ""),
        ("fog.VolumeLighting", "EmissionAbsorption", ""),
        ("fog.RayCast.step", "0.6", ""),
        ("fog.RayCast.early_termination", "0.2", ""),
        ("fog.RayCast.skip_empty", "false", ""),
        ("fog.Shading", "Local", ""),
        // One that emits it, and is classified by the values at the ends of segments.
        ("smoke.Transform.translation", "(0.0, -8.5, 0.0)", ""),
        ("smoke.Transform.scale", "1.1", "preintegrate 1"),
        ("smoke.Volume", "Raw(path: \"wide.raw\", size: (10, 10, 10), format: U16)", SMOKE_RELOADED),
        ("smoke.Volume.spacing", "(0.4, 0.4, 0.3)", SMOKE_RELOADED),
        ("smoke.TransferFunction.domain", "(0.0, 100.0)", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.iso[0].value", "50.0", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.iso[0].width", "15.0", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.iso[0].color", "(0.8, 0.2, 0.1)", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.iso[0].absorption", "0.8", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.iso", "[]", SMOKE_RECLASSIFIED),
        ("smoke.TransferFunction.classification", "Post", "classify 1 of 32 entries"),
        ("smoke.VolumeLighting.ambient", "0.3", ""),
        ("smoke.VolumeLighting.diffuse", "0.6", ""),
        ("smoke.VolumeLighting.specular", "0.2", ""),
        ("smoke.VolumeLighting.shininess", "8.0", ""),
        ("smoke.RayCast.step", "0.8", "preintegrate 1"),
    ],
};
