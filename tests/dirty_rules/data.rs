//! The meshes and volumes that the scenes name.

/// The files that the scenes name. Each byte is a sign, so that all of them are text.
pub fn files() -> Vec<(&'static str, String)> {
    let blob = |size: [i32; 3], scale: f32| {
        let [x, y, z] = size;
        let cells = (0..x * y * z).map(move |cell| [cell % x, cell / x % y, cell / x / y]);
        let apart = move |cell: [i32; 3]| {
            (0..3)
                .map(|axis| (2.0 * cell[axis] as f32 / (size[axis] - 1) as f32 - 1.0).powi(2))
                .sum::<f32>()
                .sqrt()
        };
        cells.map(move |cell| char::from((scale * (1.3 - apart(cell)).max(0.0)) as u8)).collect::<String>()
    };
    let box_of = |size: [i32; 3]| blob(size, 90.0);
    let wide =
        |text: String, filler: &str| text.chars().map(|sign| format!("{sign}{filler}")).collect::<String>();
    let head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 6 6 6\nspacings: 0.5 0.5 0.5\nencoding: raw\n\n";
    let series = "NRRD0005\ntype: uint8\ndimension: 5\nsizes: 2 6 6 6 2\nkinds: vector domain domain domain list\n\
        space: left-posterior-superior\nspace directions: none (0.5,0,0) (0,0.4,0.3) (0,-0.3,0.4) none\nspace origin: (1,2,3)\n\
        encoding: raw\n\n";
    vec![
        ("series.nrrd", format!("{series}{}", blob([12, 6, 12], 90.0))),
        (
            "painted.obj",
            "v 2 0 0 1 0 0\nv -1 1 0 0 1 0\nv -1 -1 1 0 0 1\nv -1 -1 -1 1 1 0\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n".into(),
        ),
        ("fog.raw", box_of([12, 12, 16])),
        ("thin.raw", blob([12, 12, 16], 60.0)),
        ("smoke.raw", box_of([10, 10, 10])),
        ("longer.raw", format!("head{}", box_of([10, 10, 10]))),
        ("wide.raw", wide(box_of([10, 10, 10]), "\0")),
        ("floats.raw", wide(box_of([10, 10, 10]), "\0\0B")),
        ("cube.nrrd", format!("{head}{}", box_of([6, 6, 6]))),
        ("other.nrrd", format!("{head}{}", blob([6, 6, 6], 60.0))),
        (
            "shard.obj",
            "v 2 0 0\nv -1 1 0\nv -1 -1 1\nv -1 -1 -1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n".into(),
        ),
        (
            "other.obj",
            "v 2 0 0\nv -1 1.2 0\nv -1 -1 1\nv -1 -1 -1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n".into(),
        ),
    ]
}
