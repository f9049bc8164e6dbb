//! The density of a C60 molecule: sixty carbon atoms at the corners of a truncated icosahedron, ninety bonds.

/// Voxels along each side.
const SIDE: usize = 32;
/// The ratio of the golden section.
const PHI: f64 = 1.618_033_988_749_895;
/// Length of a bond in the coordinates of [`atoms`].
const BOND: f64 = 2.0;
/// Voxels per unit of those coordinates, so that two voxels on each side of the box stay empty.
const SCALE: f64 = 2.12;
/// Standard deviation of an atom's Gaussian, in voxels.
const ATOM_WIDTH: f64 = 1.15;
/// Standard deviation across a bond, in voxels.
const BOND_WIDTH: f64 = 0.8;
/// Peak of a bond beside an atom's peak of 1.
const BOND_PEAK: f64 = 0.6;

type Point = [f64; 3];

/// One byte per voxel, x fastest; the densest voxel is 255.
pub fn raw() -> Vec<u8> {
    let atoms = atoms().map(|atom| atom.map(|coordinate| coordinate * SCALE));
    let bonds = bonds(&atoms);
    let mut density = Vec::with_capacity(SIDE * SIDE * SIDE);
    let centre = |index: usize| index as f64 + 0.5 - SIDE as f64 / 2.0;
    for z in 0..SIDE {
        for y in 0..SIDE {
            for x in 0..SIDE {
                density.push(density_at([centre(x), centre(y), centre(z)], &atoms, &bonds));
            }
        }
    }
    let highest = density.iter().copied().fold(0.0, f64::max);
    density.into_iter().map(|value| (255.0 * value / highest).round() as u8).collect()
}

fn density_at(point: Point, atoms: &[Point], bonds: &[(Point, Point)]) -> f64 {
    let gaussian = |squared_distance: f64, width: f64| libm::exp(-0.5 * squared_distance / (width * width));
    let of_atoms: f64 = atoms.iter().map(|&atom| gaussian(squared(minus(point, atom)), ATOM_WIDTH)).sum();
    let of_bonds: f64 = bonds.iter().map(|&bond| gaussian(squared_distance(point, bond), BOND_WIDTH)).sum();
    of_atoms + BOND_PEAK * of_bonds
}

/// Corners of a truncated icosahedron with edges of length 2: the even permutations, with all signs, of
/// (0, 1, 3φ), (1, 2 + φ, 2φ) and (φ, 2, 2φ + 1).
fn atoms() -> [Point; 60] {
    let corners = [[0.0, 1.0, 3.0 * PHI], [1.0, 2.0 + PHI, 2.0 * PHI], [PHI, 2.0, 2.0 * PHI + 1.0]];
    let mut atoms = Vec::with_capacity(60);
    for [a, b, c] in corners {
        for permuted in [[a, b, c], [b, c, a], [c, a, b]] {
            for signs in 0..8_u32 {
                let negative = |axis: usize| signs >> axis & 1 == 1;
                // A zero has no sign of its own.
                if (0..3).any(|axis| negative(axis) && permuted[axis] == 0.0) {
                    continue;
                }
                atoms.push(std::array::from_fn(|axis| {
                    if negative(axis) { -permuted[axis] } else { permuted[axis] }
                }));
            }
        }
    }
    std::array::from_fn(|index| atoms[index])
}

/// Pairs of nearest neighbours.
fn bonds(atoms: &[Point]) -> Vec<(Point, Point)> {
    let longest = 1.01 * BOND * SCALE;
    let pairs = atoms.iter().enumerate().flat_map(|(index, &a)| atoms[..index].iter().map(move |&b| (a, b)));
    pairs.filter(|&(a, b)| squared(minus(a, b)) < longest * longest).collect()
}

/// From a point to the nearest point of a line segment.
fn squared_distance(point: Point, (start, end): (Point, Point)) -> f64 {
    let along = minus(end, start);
    let from_start = minus(point, start);
    let t = (dot(from_start, along) / squared(along)).clamp(0.0, 1.0);
    squared(minus(from_start, along.map(|coordinate| t * coordinate)))
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn squared(a: Point) -> f64 {
    dot(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixty_atoms_with_three_bonds_each() {
        let atoms = atoms();
        let radius = squared(atoms[0]);
        assert!(atoms.iter().all(|&atom| (squared(atom) - radius).abs() < 1e-9));
        let scaled = atoms.map(|atom| atom.map(|coordinate| coordinate * SCALE));
        let bonds = bonds(&scaled);
        assert_eq!(bonds.len(), 90);
        for atom in scaled {
            assert_eq!(bonds.iter().filter(|(a, b)| *a == atom || *b == atom).count(), 3);
        }
    }

    #[test]
    fn two_voxels_around_it_are_empty() {
        let raw = raw();
        assert_eq!(raw.len(), SIDE.pow(3));
        assert_eq!(raw.iter().max(), Some(&255));
        let mut next_layer = 0;
        for (index, &value) in raw.iter().enumerate() {
            let place = [index % SIDE, index / SIDE % SIDE, index / SIDE / SIDE];
            let from_side = place.map(|at| at.min(SIDE - 1 - at)).into_iter().min();
            match from_side {
                Some(0 | 1) => assert_eq!(value, 0, "at {place:?}"),
                Some(2) => next_layer = next_layer.max(value),
                _ => {}
            }
        }
        assert!(next_layer > 0, "the molecule fills the rest");
    }

    #[test]
    fn it_is_hollow() {
        let raw = raw();
        let middle = SIDE / 2;
        assert_eq!(raw[(middle * SIDE + middle) * SIDE + middle], 0);
    }
}
