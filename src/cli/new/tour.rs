//! What the tour of the README is made with: every scene that the project ships, and what they read.

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        /// Paths in the folder, with what is in the files.
        pub(super) const FILES: &[(&str, &[u8])] = &[$(($path, include_bytes!(concat!("../../../", $path)))),*];
    };
}

files! {
    "assets/c60_32x32x32_u8.raw",
    "assets/lotus.obj",
    "scenes/c60_emission.ron",
    "scenes/c60_levels.ron",
    "scenes/cornell.ron",
    "scenes/cut_through.ron",
    "scenes/dipoles.ron",
    "scenes/hybrid.ron",
    "scenes/light_and_shadow.ron",
    "scenes/light_volume.ron",
    "scenes/materials/cream.ron",
    "scenes/materials/marble.ron",
    "scenes/materials/skin.ron",
    "scenes/materials/wax.ron",
    "scenes/orthographic.ron",
    "scenes/overlapping_volumes.ron",
    "scenes/pre_integrated.ron",
    "scenes/scattering_maps.ron",
    "scenes/showcase.ron",
    "scenes/studio.ron",
    "scenes/transfer_functions/ember.ron",
    "scenes/transfer_functions/frost.ron",
    "scenes/transfer_functions/mist.ron",
    "scenes/transfer_functions/resin.ron",
    "scenes/translucent.ron",
    "scenes/turntable.ron",
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use std::fs;
    use std::path::Path;

    #[test]
    fn no_scene_is_forgotten() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut found = Vec::new();
        for folder in ["scenes", "scenes/materials", "scenes/transfer_functions"] {
            for entry in fs::read_dir(root.join(folder)).unwrap().map(Result::unwrap) {
                if entry.path().is_file() {
                    found.push(format!("{folder}/{}", entry.file_name().to_string_lossy()));
                }
            }
        }
        found.sort();
        let mut shipped: Vec<&str> = FILES.iter().map(|(path, _)| *path).collect();
        shipped.retain(|path| path.starts_with("scenes/"));
        shipped.sort_unstable();
        assert_eq!(shipped, found);
    }
}
