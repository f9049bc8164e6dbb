"""What every program in the comparison is told to draw. Python standard library only: each side imports this one table."""

from dataclasses import dataclass

SIZE = (1200, 680)
BACKGROUND = (0.05, 0.05, 0.07)

EYE = (380.0, -520.0, 330.0)
TARGET = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
VERTICAL_FOV = 30.0
DEGREES_PER_FRAME = 1.0  # right-handed about UP, through TARGET: frame i is drawn at i degrees

LIGHT_FROM = (400.0, -300.0, 500.0)  # directional, white, intensity 1, travels from here to TARGET

# Distances are in scene units; one voxel of the engine is one unit.
STEP = 1.0
OPACITY_LENGTH = 1.0

PHONG = {"ambient": 0.2, "diffuse": 0.8, "specular": 0.3, "shininess": 20.0}
# The half-vector turns by half the angle of the mirrored light: four times the exponent makes a highlight of the same width.
BLINN_SHININESS = 4.0 * PHONG["shininess"]

# VTK's volumetric scattering: only secondary rays, no gradients, each 0.3 of the longest way through the volume; even scattering.
SCATTERING = {"blending": 1.0, "reach": 0.3, "anisotropy": 0.0}

WARM_UP_FRAMES = 2


@dataclass(frozen=True)
class Volume:
    """A cube of unsigned bytes, x fastest, centred on the origin, and its transfer function."""

    samples: int  # per axis
    spacing: float  # scene units between samples
    sha256: str
    color: tuple  # (data value, r, g, b)
    opacity: tuple  # (data value, opacity over OPACITY_LENGTH)

    def file_name(self, name):
        n = self.samples
        return f"{name}_like_{n}x{n}x{n}_u8.raw"


VOLUMES = {
    "engine": Volume(
        samples=256,
        spacing=1.0,
        sha256="41ab2e5108ae07638618f5d1d511fef1c3d88cf4202aa8f56d487defe33d9657",
        color=(
            (0, 0.0, 0.0, 0.0),
            (60, 0.55, 0.6, 0.7),
            (140, 0.75, 0.78, 0.82),
            (180, 0.95, 0.55, 0.15),
            (255, 1.0, 0.85, 0.5),
        ),
        opacity=((0, 0.0), (50, 0.0), (90, 0.03), (130, 0.06), (170, 0.10), (200, 0.55), (255, 0.80)),
    ),
    "bucky": Volume(
        samples=32,
        spacing=8.0,  # the engine's extent, so the step is an eighth of a voxel
        sha256="86ca57126772c60bf5989f43f63aca61823b254ba6c96d7f3893c16953a238a1",
        color=((0, 0.1, 0.1, 0.4), (80, 0.2, 0.5, 0.9), (140, 0.9, 0.8, 0.3), (255, 1.0, 0.3, 0.1)),
        opacity=((0, 0.0), (50, 0.0), (90, 0.02), (160, 0.10), (255, 0.5)),
    ),
}


def interpolate(points, value):
    """Linear interpolation in a table of (data value, component, ...); constant beyond its ends."""
    if value <= points[0][0]:
        return points[0][1:]
    for (v0, *low), (v1, *high) in zip(points, points[1:]):
        if value <= v1:
            t = (value - v0) / (v1 - v0)
            return tuple(a + t * (b - a) for a, b in zip(low, high))
    return points[-1][1:]


def merged_points(volume):
    """Colour and opacity on the union of their breakpoints: the same two piecewise linear functions, exactly."""
    values = sorted({point[0] for point in volume.color} | {point[0] for point in volume.opacity})
    return [(v, interpolate(volume.color, v), interpolate(volume.opacity, v)[0]) for v in values]
