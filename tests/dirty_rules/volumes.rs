//! What volumes can be besides, and light that is swept towards the eye.

use crate::table::Table;

const SCENE: &str = r#"(
    entities: {
        "eye": ( ViewCamera: (eye: (4.0, 5.0, 20.0), projection: Orthographic(height: 10.0)) ),
        "a": ( DirectionalLight: (direction: (0.2, -0.1, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        "b": ( DirectionalLight: (direction: (0.5, 0.5, -1.0), irradiance: (3.0, 2.0, 2.0)) ),
        "cube": (
            Transform: (translation: (-2.5, 0.0, 0.0)),
            Volume: File("cube.nrrd"),
            TransferFunction: (points: [(0.0, (1.0, 0.5, 0.2), 0.0), (0.4, (0.5, 0.9, 0.2), 0.3)], entries: 32),
            VolumeLighting: SingleScattering(g: 0.3, resolution: 1.0),
        ),
        "cloud": (
            Transform: (translation: (2.5, 0.0, 0.0), scale: (1.0, 1.1, 1.2)),
            Volume: Raw(path: "smoke.raw", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3)),
            TransferFunction: (
                domain: (0.0, 120.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (1.0, (0.5, 0.9, 0.2), 0.3)],
                entries: 64, classification: Pre,
            ),
            VolumeLighting: LightVolume(cone_angle: 40.0, towards_eye: true, g: 0.4),
        ),
        "map": (
            Transform: (translation: (0.0, -8.0, 0.0)),
            Volume: Raw(path: "smoke.raw", size: (10, 10, 10)),
            TransferFunction: (labels: [(value: 30, color: (0.9, 0.2, 0.1), opacity: 0.5, name: "smoke")]),
            VolumeLighting: Gradient(),
        ),
    },
)"#;

/// Light is swept towards the eye along three axes.
const EYE_MOVED: &str = "eye_light 3";
const CLOUD_RELOADED: &str = "upload_volumes 1 of 1000 voxels, classify 1 of 64 entries, preclassify 1, light_volume 2, light_cells 1, light_network 1, scattered_light 2, summed_light 1, eye_light 3";
const CLOUD_SCATTERS_OTHERWISE: &str = "light_network 1, scattered_light 2, summed_light 1, eye_light 3";

/// Normals are of what is visible of labels.
const MAP_RECOLOURED: &str = "classify 1 of 3 entries, preclassify 1 of 1000 voxels";
const MAP_RELOADED: &str = "upload_volumes 1 of 1000 voxels, classify 1 of 3 entries, preclassify 1";

pub const TABLE: Table = Table {
    name: "volumes",
    scene: SCENE,
    rows: &[
        ("eye.ViewCamera.eye", "(4.0, 6.0, 20.0)", EYE_MOVED),
        // As far as rays are parallel.
        ("eye.ViewCamera.projection.height", "11.0", ""),
        ("eye.ViewCamera.projection", "Perspective(vertical_fov: 30.0)", EYE_MOVED),
        ("a.DirectionalLight.irradiance", "(2.0, 2.0, 1.0)", "summed_light 1, eye_light 3"),
        (
            "a.DirectionalLight.direction",
            "(0.2, -0.2, -1.0)",
            "light_volume 2, scattered_light 1, summed_light 1, eye_light 3",
        ),
        (
            "cube.Volume.path",
            "\"other.nrrd\"",
            "upload_volumes 1 of 216 voxels, classify 1 of 32 entries, light_volume 2",
        ),
        (
            "cube.Volume",
            "Raw(path: \"smoke.raw\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3))",
            "upload_volumes 1 of 1000 voxels, classify 1 of 32 entries, light_volume 2",
        ),
        ("cube.TransferFunction.points[1].2", "0.4", "classify 1 of 32 entries, light_volume 2"),
        ("cube.TransferFunction.points[1].1", "(0.5, 0.2, 0.2)", "classify 1 of 32 entries"),
        ("cube.VolumeLighting.g", "0.4", ""),
        ("cube.VolumeLighting.resolution", "0.5", "light_volume 2"),
        (
            "cube.VolumeLighting",
            "LightVolume()",
            "light_cells 1 of 216 cells, light_network 1, scattered_light 2, summed_light 1",
        ),
        (
            "cloud.Transform.scale",
            "(1.0, 1.2, 1.2)",
            "light_volume 2, light_network 1, scattered_light 2, summed_light 1, eye_light 3",
        ),
        (
            "cloud.Volume",
            "Raw(path: \"longer.raw\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3), skip_bytes: 4)",
            CLOUD_RELOADED,
        ),
        (
            "cloud.Volume",
            "Raw(path: \"wide.raw\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3), format: I16)",
            CLOUD_RELOADED,
        ),
        (
            "cloud.Volume",
            "Raw(path: \"floats.raw\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3), format: F32)",
            CLOUD_RELOADED,
        ),
        (
            "cloud.Volume",
            "Raw(path: \"floats.raw\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3), format: Rgba8)",
            CLOUD_RELOADED,
        ),
        ("cloud.TransferFunction.classification", "Post", "classify 1 of 64 entries"),
        ("cloud.VolumeLighting.cone_angle", "50.0", CLOUD_SCATTERS_OTHERWISE),
        ("cloud.VolumeLighting.g", "0.5", CLOUD_SCATTERS_OTHERWISE),
        ("map.Volume.interpolation", "Linear", MAP_RELOADED),
        ("map.Volume.interpolation", "Nearest", MAP_RELOADED),
        ("map.TransferFunction.labels[0].value", "31", MAP_RECOLOURED),
        ("map.TransferFunction.labels[0].color", "(0.8, 0.2, 0.1)", MAP_RECOLOURED),
        ("map.TransferFunction.labels[0].opacity", "0.6", MAP_RECOLOURED),
        ("map.TransferFunction.labels[0].name", "\"fog\"", MAP_RECOLOURED),
        ("map.TransferFunction.labels", "[]", "classify 1 of 1024 entries"),
        ("map.VolumeLighting", "EmissionAbsorption", ""),
        ("cloud.VolumeLighting.towards_eye", "false", "light_network 1, scattered_light 2, summed_light 1"),
    ],
};
