//! The `bunny` package: a script that exports two arrays, `positions` and `cells`.

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::mesh::Mesh;

/// Reads the arrays as JSON; the script is never run.
pub fn mesh(script: &[u8]) -> Result<Mesh> {
    let script = str::from_utf8(script).context("index.js is no UTF-8")?;
    let positions = rows(script, "positions", |value| value.as_f64())?;
    let triangles = rows(script, "cells", |value| u32::try_from(value.as_u64()?).ok())?;
    let in_range = |index: &u32| (*index as usize) < positions.len();
    ensure!(triangles.iter().flatten().all(in_range), "a cell names a position that does not exist");
    Ok(Mesh { positions, triangles })
}

/// The array of triples after `exports.NAME=`.
fn rows<T>(script: &str, name: &str, read: impl Fn(&Value) -> Option<T>) -> Result<Vec<[T; 3]>> {
    let start = format!("exports.{name}=");
    let at = script.find(&start).with_context(|| format!("index.js has no `{start}`"))? + start.len();
    let mut values = serde_json::Deserializer::from_str(&script[at..]).into_iter::<Vec<[Value; 3]>>();
    let rows = values.next().with_context(|| format!("nothing follows `{start}`"))?;
    let rows = rows.with_context(|| format!("`{name}` is not a list of triples"))?;
    let triple = |[a, b, c]: &[Value; 3]| Some([read(a)?, read(b)?, read(c)?]);
    rows.iter()
        .map(triple)
        .collect::<Option<_>>()
        .with_context(|| format!("`{name}` holds something else than numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_become_a_mesh() {
        let script = b"exports.positions=[[0.5,0,1],[1,0,0],[0,2,0]]\nexports.cells=[[0,1,2]]\n";
        let mesh = mesh(script).unwrap();
        assert_eq!(mesh.positions, [[0.5, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn other_scripts_are_errors() {
        for script in
            ["", "exports.positions=[[0,0]]", "exports.positions=[[0,0,0]]\nexports.cells=[[0,0,1]]"]
        {
            assert!(mesh(script.as_bytes()).is_err(), "{script}");
        }
    }
}
