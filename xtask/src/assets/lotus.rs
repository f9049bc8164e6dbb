//! A lotus blossom: one closed surface from a thick seat to petals as thin as their tips are sharp.
//!
//! Lit from behind, it shows at a glance what a model of subsurface scattering is worth: the seat stays dark, the
//! petals glow, and the light that bleeds between them comes only from scattering.
//!
//! The surface is a grid. A column is a half-plane through the upright axis; in it a closed curve runs from the
//! middle of the seat up the outside of one whorl of petals, over the rim, down the inside, up the next whorl, and
//! ends on top of the bud. Petals arise because the height of the rim changes from column to column.
//! No column's curve meets itself, so neither does the surface; the final swirl only turns circles about the axis.

use std::f64::consts::{PI, TAU};

use super::mesh::Mesh;

/// Half-planes around the axis; a multiple of twice the number of petals puts a column on each tip and notch.
const COLUMNS: usize = 108;
const PETALS: f64 = 6.0;
/// Turn about the axis per unit of distance from it.
const SWIRL: f64 = 0.22;

const COMMENT: &str = "A lotus blossom, closed and manifold, made by `cargo xtask assets`.
Licence: MIT OR Apache-2.0, as the project.";

/// A point of a half-plane: distance from the axis, and height.
type Point = [f64; 2];

/// One ring of petals that share a thin wall.
struct Whorl {
    /// Where its wall grows out of the seat.
    root: Point,
    /// Length of the wall from the root to a petal's tip.
    length: f64,
    /// Part of the length at which two petals part.
    notch: f64,
    /// Slope of the wall at the root, halfway, and at the tip, in radians above the horizontal.
    slopes: [f64; 3],
    /// How much steeper a petal's edge is than its middle, which makes it a hollow hand.
    cup: f64,
    /// Half the thickness of the wall at the root and at the rim.
    half_thickness: [f64; 2],
    /// Turn of the whole whorl, in petals.
    offset: f64,
    /// Steps from the root to the rim, on each side.
    rows: usize,
}

const WHORLS: [Whorl; 3] = [
    Whorl {
        root: [0.30, 0.14],
        length: 1.26,
        notch: 0.36,
        slopes: [0.15, 1.16, 0.50],
        cup: 0.40,
        half_thickness: [0.050, 0.009],
        offset: 0.0,
        rows: 10,
    },
    Whorl {
        root: [0.205, 0.22],
        length: 1.24,
        notch: 0.34,
        slopes: [0.62, 1.38, 1.05],
        cup: 0.26,
        half_thickness: [0.036, 0.008],
        offset: 0.5,
        rows: 8,
    },
    Whorl {
        root: [0.125, 0.27],
        length: 0.95,
        notch: 0.40,
        slopes: [1.10, 1.57, 1.44],
        cup: 0.15,
        half_thickness: [0.026, 0.007],
        offset: 0.0,
        rows: 6,
    },
];

/// The blossom as OBJ text.
pub fn obj() -> Vec<u8> {
    mesh().to_obj(COMMENT).into_bytes()
}

fn mesh() -> Mesh {
    let columns: Vec<Vec<Point>> = (0..COLUMNS).map(|column| profile(azimuth(column))).collect();
    let rows = columns[0].len();
    let mut positions = vec![[0.0, columns[0][0][1], 0.0]];
    for row in 1..rows - 1 {
        for (column, profile) in columns.iter().enumerate() {
            let [radius, height] = profile[row];
            let angle = azimuth(column) + SWIRL * radius;
            positions.push([radius * libm::sin(angle), height, radius * libm::cos(angle)]);
        }
    }
    positions.push([0.0, columns[0][rows - 1][1], 0.0]);
    let mut mesh = Mesh { positions, triangles: triangles(rows) };
    fit(&mut mesh);
    mesh
}

fn azimuth(column: usize) -> f64 {
    TAU * column as f64 / COLUMNS as f64
}

/// Joins neighbouring columns: a fan of triangles around each end of the axis, halved quadrilaterals between.
fn triangles(rows: usize) -> Vec<[u32; 3]> {
    let (last, columns) = (rows - 1, COLUMNS as u32);
    let index = |row: usize, column: u32| match row {
        0 => 0,
        row if row == last => 1 + (last as u32 - 1) * columns,
        row => 1 + (row as u32 - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for row in 0..last {
        for column in 0..columns {
            let [a, b] = [index(row, column), index(row, column + 1)];
            let [c, d] = [index(row + 1, column + 1), index(row + 1, column)];
            if row > 0 {
                triangles.push([a, b, c]);
            }
            if row + 1 < last {
                triangles.push([a, c, d]);
            }
        }
    }
    triangles
}

/// The closed curve of one half-plane, from the bottom of the axis to its top.
fn profile(azimuth: f64) -> Vec<Point> {
    let mut curve = seat();
    for whorl in &WHORLS {
        whorl.append(azimuth, &mut curve);
    }
    curve.extend(bud());
    curve
}

/// From the middle of the underside to below the outermost petals.
fn seat() -> Vec<Point> {
    let foot = [[0.0, 0.0], [0.17, 0.0], [0.30, 0.004], [0.335, 0.03], [0.31, 0.065]];
    foot.into_iter().collect()
}

/// From inside the innermost petals to the top of the axis.
fn bud() -> Vec<Point> {
    let rows = 4;
    let point = |row: usize| {
        let angle = 0.5 * PI * row as f64 / rows as f64;
        [0.085 * libm::cos(angle), 0.31 + 0.16 * libm::sin(angle)]
    };
    (0..rows).map(point).chain([[0.0, 0.47]]).collect()
}

impl Whorl {
    /// Appends the outside from the root to the rim, and the inside back to the root.
    fn append(&self, azimuth: f64, curve: &mut Vec<Point>) {
        let off_middle = self.off_middle(azimuth);
        let reach = self.reach(azimuth, off_middle);
        let wall = self.wall(reach, off_middle);
        let outside = wall.iter().map(|&(middle, normal)| plus(middle, normal));
        let inside = wall.iter().rev().map(|&(middle, normal)| plus(middle, normal.map(|n| -n)));
        curve.extend(outside);
        // Between the two sides one point stands out along the wall, which rounds the rim.
        let (end, normal) = wall[self.rows - 1];
        curve.push(plus(end, [-0.8 * normal[1], 0.8 * normal[0]]));
        curve.extend(inside);
    }

    /// 0 in the middle of a petal, 1 in the notch beside it.
    fn off_middle(&self, azimuth: f64) -> f64 {
        let turns = azimuth / TAU * PETALS - self.offset;
        2.0 * (turns - turns.round()).abs()
    }

    /// Length of the wall in this half-plane: the outline of a petal, a little different for each.
    fn reach(&self, azimuth: f64, off_middle: f64) -> f64 {
        let outline = libm::pow(1.0 - libm::pow(off_middle, 1.15), 0.66);
        let unevenness = 1.0 + 0.04 * libm::sin(2.0 * azimuth + 3.0 * self.length);
        self.length * unevenness * (self.notch + (1.0 - self.notch) * outline)
    }

    /// The middle of the wall from root to rim, and its normal as long as half the thickness, pointing outwards.
    fn wall(&self, reach: f64, off_middle: f64) -> Vec<(Point, Point)> {
        const STEPS: usize = 8;
        let mut middle = self.root;
        let mut wall = Vec::with_capacity(self.rows);
        for row in 0..self.rows {
            let along = row as f64 / (self.rows - 1) as f64;
            let slope = self.slope(along * reach / self.length, off_middle);
            let [at_root, at_rim] = self.half_thickness;
            let half = at_rim + (at_root - at_rim) * (1.0 - along) * (1.0 - along);
            wall.push((middle, [half * libm::sin(slope), -half * libm::cos(slope)]));
            let step = reach / ((self.rows - 1) * STEPS) as f64;
            for part in 0..STEPS {
                let along = (row as f64 + (part as f64 + 0.5) / STEPS as f64) / (self.rows - 1) as f64;
                let slope = self.slope(along * reach / self.length, off_middle);
                middle = plus(middle, [step * libm::cos(slope), step * libm::sin(slope)]);
            }
        }
        wall
    }

    /// Slope of the wall, a parabola through the three given ones, steeper at a petal's edge.
    fn slope(&self, along: f64, off_middle: f64) -> f64 {
        let [root, halfway, tip] = self.slopes;
        let parabola = root
            + along * (4.0 * halfway - 3.0 * root - tip)
            + along * along * (2.0 * root + 2.0 * tip - 4.0 * halfway);
        parabola + self.cup * off_middle * off_middle * along
    }
}

/// Puts the lowest point on y = -1, centres the rest, and makes the largest side 2 long.
fn fit(mesh: &mut Mesh) {
    let (low, high) = mesh.bounds();
    let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    for position in &mut mesh.positions {
        let place = |axis: usize, origin: f64| 2.0 / longest * (position[axis] - origin);
        let centred = |axis: usize| place(axis, 0.5 * (low[axis] + high[axis]));
        *position = [centred(0), place(1, low[1]) - 1.0, centred(2)].map(five_decimals);
    }
}

/// Five decimals are what the file holds; zero has no sign.
fn five_decimals(value: f64) -> f64 {
    (value * 1e5).round() / 1e5 + 0.0
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_and_sits_on_the_ground() {
        let mesh = mesh();
        assert_eq!(mesh.open_edges(), 0);
        let (low, high) = mesh.bounds();
        assert_eq!(low[1], -1.0);
        for axis in 0..3 {
            assert!(low[axis] >= -1.0 && high[axis] <= 1.0, "{low:?} {high:?}");
        }
        assert!(obj().len() <= 400_000, "{} bytes", obj().len());
    }

    #[test]
    fn normals_point_outwards() {
        let Mesh { positions, triangles } = mesh();
        let six_volumes = triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|index| positions[index as usize]);
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        });
        assert!(six_volumes.sum::<f64>() > 0.0);
    }

    #[test]
    fn no_half_plane_is_crossed_twice() {
        for column in 0..COLUMNS {
            let curve = profile(azimuth(column));
            let segments: Vec<_> = curve.windows(2).map(|ends| (ends[0], ends[1])).collect();
            for (i, &first) in segments.iter().enumerate() {
                for (j, &second) in segments.iter().enumerate().skip(i + 2) {
                    assert!(!cross(first, second), "column {column}: segments {i} and {j}");
                }
            }
            let inner = &curve[1..curve.len() - 1];
            assert!(inner.iter().all(|&[radius, _]| radius > 0.0), "column {column}");
        }
    }

    fn cross((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
        let side =
            |p: Point, q: Point, r: Point| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    }
}
