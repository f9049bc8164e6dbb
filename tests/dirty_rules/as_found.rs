//! Files as people have them: in colour, several volumes in one, with a place of their own, seen by a camera that frames them.

use crate::table::Table;

const SCENE: &str = r#"(
    entities: {
        "eye": ( ViewCamera: (frame: (from: (0.2, 0.1, 1.0), fill: 0.8), projection: Orthographic(height: 10.0)) ),
        "a": ( DirectionalLight: (direction: (0.2, -0.1, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        "shard": ( Transform: (translation: (-2.5, 0.0, 0.0)), Mesh: File(path: "painted.obj", normals: Smooth(100.0)) ),
        "scan": (
            Transform: (translation: (2.5, 0.0, 0.0), fit: 3.0),
            Volume: File(path: "series.nrrd"),
            TransferFunction: Preset("Object"),
            VolumeLighting: Gradient(),
        ),
        "other": (
            Volume: File(path: "series.nrrd", component: 0, index: 1),
            VolumeLighting: Gradient(),
        ),
    },
)"#;

const SCAN_RELOADED: &str = "upload_volumes 1 of 216 voxels, classify 1 of 1024 entries";

pub const TABLE: Table = Table {
    name: "as found",
    scene: SCENE,
    rows: &[
        ("eye.ViewCamera.frame.fill", "0.7", ""),
        ("eye.ViewCamera.frame.from", "(1.0, 0.1, 1.0)", ""),
        ("eye.ViewCamera.frame.flat", "FrontOnTop", ""),
        ("eye.ViewCamera.frame.flat", "FrontBelow", ""),
        ("eye.ViewCamera.frame", "None", ""),
        ("eye.ViewCamera.gamma", "2.0", ""),
        ("shard.Mesh.materials", "false", "upload_meshes 1 of 4 triangles"),
        ("shard.Mesh.normals", "Smooth(20.0)", "upload_meshes 1 of 4 triangles"),
        ("shard.Mesh.normals", "Flat", "upload_meshes 1 of 4 triangles"),
        ("shard.Transform.fit", "2.0", ""),
        ("shard.Transform.fit", "Some(3.0)", ""),
        ("scan.Transform.fit", "None", ""),
        ("scan.Transform.fit", "2.5", ""),
        ("scan.Volume.index", "1", SCAN_RELOADED),
        ("scan.Volume.component", "1", SCAN_RELOADED),
        ("other.Volume.component", "1", SCAN_RELOADED),
        (
            "scan.Volume.interpolation",
            "Nearest",
            "upload_volumes 1 of 216 voxels, classify 1 of 1024 entries, preclassify 1",
        ),
        ("scan.Volume.interpolation", "Linear", SCAN_RELOADED),
        ("scan.Volume.place", "Patient", SCAN_RELOADED),
        ("scan.TransferFunction.preset", "\"Glow\"", "classify 1 of 1024 entries"),
        (
            "scan.TransferFunction",
            "(points: [(0.0, (1.0, 0.5, 0.2), 0.0), (0.4, (0.5, 0.9, 0.2), 0.3)])",
            "classify 1 of 1024 entries",
        ),
    ],
};
