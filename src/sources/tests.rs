use std::path::Path;
#[test]
fn probe() {
    for folder in ["meshes/odd", "meshes"] {
        let mut files: Vec<_> =
            std::fs::read_dir(Path::new(&std::env::var_os("TYNDALL_DATA").unwrap()).join(folder))
                .unwrap()
                .map(|e| e.unwrap().path())
                .filter(|p| p.extension().is_some_and(|e| e == "obj"))
                .collect();
        files.sort();
        for f in files {
            let n = f.file_name().unwrap().to_string_lossy().into_owned();
            let t = std::time::Instant::now();
            match super::read_obj(&f) {
                Ok(m) => {
                    let e = t.elapsed();
                    let s = m.statistics();
                    println!(
                        "{n}: v {} t {} open {} nm {} comp {} area {} {:?} {:?}",
                        s.vertices,
                        s.triangles,
                        s.open_edges,
                        s.non_manifold_edges,
                        s.components,
                        s.area,
                        m.notes,
                        e
                    );
                    assert!(m.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
                }
                Err(e) => println!("ERR {n}: {e}"),
            }
        }
    }
}
