"""Two synthetic volumes, the same bytes on every machine whose numpy rounds alike: no download, no random numbers.

`engine`: a machine part by constructive solid geometry. Casting at 110, steel at 220, one voxel of soft edge, noise of +-6
from an integer hash. `bucky`: Gaussians on the 60 corners and 90 edges of a truncated icosahedron.

A solid is a signed distance, negative inside. Array index order is [z, y, x], so x is fastest in the file. The published
checksums depend on which steps run in f32 and which in f64, hence the care about types below.
"""

import hashlib
import itertools

import numpy as np

from setting import VOLUMES

SLAB = 16  # z slices evaluated at once: bounds the memory, does not change a bit of the result


def sample_centres(n):
    return (((np.arange(n, dtype=np.float64) + 0.5) / n) * 2 - 1).astype(np.float32)


def grid(n, z_range):
    axis = sample_centres(n)
    z, y, x = np.meshgrid(axis[z_range], axis, axis, indexing="ij")
    return x, y, z


class Solids:
    """Distances to solids at the points of one slab."""

    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z

    def box(self, centre, half):
        """f32 throughout: Python floats do not widen an f32 array."""
        q = [abs(p - c) - h for p, c, h in zip((self.x, self.y, self.z), centre, half)]
        outside = np.sqrt(sum((np.maximum(a, 0) ** 2 for a in q[1:]), start=np.maximum(q[0], 0) ** 2))
        inside = np.minimum(np.maximum(np.maximum(q[0], q[1]), q[2]), 0)
        return outside + inside

    def cylinder(self, centre, direction, radius, half_length):
        """f64 from the axial coordinate on: numpy's f64 scalars do widen."""
        axis = np.array(direction, dtype=np.float64)
        axis /= np.linalg.norm(axis)
        px, py, pz = self.x - centre[0], self.y - centre[1], self.z - centre[2]
        along = px * axis[0] + py * axis[1] + pz * axis[2]
        across = np.sqrt(np.maximum(px * px + py * py + pz * pz - along * along, 0))
        return np.maximum(across - radius, abs(along) - half_length)


def union(*solids):
    return np.minimum.reduce(solids)


def cut(solid, *holes):
    return np.maximum.reduce([solid, *(-hole for hole in holes)])


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def casting(s):
    body = union(
        s.box((0, 0, -0.1), (0.72, 0.42, 0.6)),
        s.box((0, 0, 0.62), (0.78, 0.50, 0.10)),  # head flange
        s.cylinder((0, 0, -0.72), X, 0.24, 0.80),  # crankcase
    )
    water_jackets = [s.box((0, side * 0.335, 0.05), (0.60, 0.025, 0.35)) for side in (1, -1)]
    bores = [s.cylinder((0.36 * side, 0, 0.0), Z, 0.25, 0.9) for side in (-1, 1)]
    ports = [s.cylinder((0.36 * side, 0.42, 0.1), Y, 0.10, 0.3) for side in (-1, 1)]
    return cut(body, *bores, *ports, s.cylinder((0, 0, -0.72), X, 0.14, 0.95), *water_jackets)


def steel(s):
    parts = [s.cylinder((0, 0, -0.72), X, 0.07, 0.92)]  # shaft
    for side in (-1, 1):
        x = 0.36 * side
        parts.append(cut(s.cylinder((x, 0, -0.05), Z, 0.27, 0.62), s.cylinder((x, 0, -0.05), Z, 0.23, 0.7)))  # liner
        parts.append(s.cylinder((x, 0.10, 0.80), (0, 0.35, 1), 0.055, 0.26))  # valve stems
        parts.append(s.cylinder((x, -0.10, 0.80), (0, -0.35, 1), 0.055, 0.26))
        parts.extend(s.cylinder((0.68 * side, 0.42 * t, 0.60), Z, 0.05, 0.20) for t in (-1, 1))  # bolts
    return union(*parts)


def coverage(distance, width):
    """1 inside, 0 outside, smooth over +-width."""
    t = np.clip(0.5 - distance / (2 * width), 0, 1)
    return t * t * (3 - 2 * t)


def hash_noise(first, shape):
    """-6..6 from the running number of each voxel; the multiplications wrap at 32 bits on purpose."""
    h = np.arange(first, first + np.prod(shape), dtype=np.uint32).reshape(shape) * np.uint32(2654435761)
    h ^= h >> 15
    h *= np.uint32(2246822519)
    h ^= h >> 13
    return ((h >> 8) & 0xFF).astype(np.float32) / 255 * 12 - 6


def to_bytes(values):
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def engine(n):
    voxel = np.float32(2.0 / n)
    slabs = []
    for z0 in range(0, n, SLAB):
        solids = Solids(*grid(n, slice(z0, z0 + SLAB)))
        metal = coverage(steel(solids), voxel)
        value = 110.0 * coverage(casting(solids), voxel) * (1 - metal) + 220.0 * metal
        slabs.append(to_bytes(value + hash_noise(z0 * n * n, value.shape)))
    return np.concatenate(slabs)


def truncated_icosahedron(radius):
    """Corners, sorted so that sums over them always run in one order, and edges."""
    phi = (1 + 5**0.5) / 2
    corners = set()
    for base in ((0, 1, 3 * phi), (1, 2 + phi, 2 * phi), (phi, 2, 2 * phi + 1)):
        for signs in itertools.product((1, -1), repeat=3):
            q = [c * sign + 0.0 for c, sign in zip(base, signs)]
            for turn in range(3):  # even permutations
                corners.add(tuple(round(q[(k + turn) % 3], 9) + 0.0 for k in range(3)))
    corners = np.array(sorted(corners))
    corners = corners / np.linalg.norm(corners[0]) * radius
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    shortest = apart[apart > 1e-6].min()
    edges = [(a, b) for a in range(60) for b in range(a) if abs(apart[a, b] - shortest) < 1e-6]
    if (len(corners), len(edges)) != (60, 90):
        raise AssertionError(f"a truncated icosahedron has 60 corners and 90 edges, not {len(corners)} and {len(edges)}")
    return corners, edges


def bucky(n):
    x, y, z = grid(n, slice(None))
    corners, edges = truncated_icosahedron(0.72)
    density = np.zeros(x.shape, np.float64)
    for c in corners:
        density += np.exp(-((x - c[0]) ** 2 + (y - c[1]) ** 2 + (z - c[2]) ** 2) / (2 * 0.13**2))
    for a, b in edges:
        p, u = corners[a], corners[b] - corners[a]
        t = np.clip(((x - p[0]) * u[0] + (y - p[1]) * u[1] + (z - p[2]) * u[2]) / (u @ u), 0, 1)
        square = (x - p[0] - t * u[0]) ** 2 + (y - p[1] - t * u[1]) ** 2 + (z - p[2] - t * u[2]) ** 2
        density = density + 0.55 * np.exp(-square / (2 * 0.07**2))
    return to_bytes(density / density.max() * 255)


def make(name, folder):
    """The volume's path and SHA-256; computed only where the file is missing or has the wrong length."""
    volume = VOLUMES[name]
    path = folder / volume.file_name(name)
    if not path.exists() or path.stat().st_size != volume.samples**3:
        {"engine": engine, "bucky": bucky}[name](volume.samples).tofile(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return path, digest
