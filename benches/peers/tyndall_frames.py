"""Tyndall's side: the same picture as a scene file, and the runs that cost its frames."""

import math
import os
from pathlib import Path

import setting
from processes import Failure, run

FRAMES_PER_SECOND = 25  # of `tyndall render --frames`

SCENE = """\
// {title}. Written by benches/peers/compare.py: edits are lost.
(
    millimetres_per_unit: 1.0,
    background: {background},
    entities: {{
        "eye": (
            ViewCamera: (
                eye: {eye},
                target: {target},
                up: {up},
                projection: Perspective(vertical_fov: {fov}),
                gamma: 1.0, // PNG values are 255 x radiance, as in VTK
            ),
            Turntable: (degrees_per_second: {degrees_per_second}, axis: {up}),
        ),
        "sun": (
            DirectionalLight: (
                direction: {light_direction},
                // pi: a white Lambertian surface that faces it has radiance 1; 4 pi: so has a white grain that scatters evenly
                irradiance: {irradiance},
            ),{light_turntable}
        ),
        "{name}": (
            Volume: Raw(
                path: "{file_name}",
                size: ({samples}, {samples}, {samples}),
                format: U8,
                spacing: {spacing},
            ),
            TransferFunction: (
                domain: (0.0, 255.0),
                points: [
{points}
                ],
                opacity_length: {opacity_length},
            ),
            VolumeLighting: {lighting},
            RayCast: (step: {step_in_voxels}),
        ),
    }},
)
"""

TITLES = {
    "ea": "Emission and absorption",
    "phong": "Gradient Phong lighting",
    "scatter": "Scattered light",
    "scatter-turned": "Scattered light, of a light that turns",
}
LIGHT_TURNTABLE = """
            Turntable: (degrees_per_second: {degrees_per_second}, axis: {up}),"""


def ron(value):
    """Floats in full, tuples in brackets: RON wants a decimal point, which Python's repr of a float gives."""
    if isinstance(value, (tuple, list)):
        return "(" + ", ".join(ron(v) for v in value) + ")"
    return repr(round(float(value), 9))


def is_scattering(lighting):
    return lighting.startswith("scatter")


def lighting_value(lighting):
    if lighting == "ea":
        return "EmissionAbsorption"
    if is_scattering(lighting):
        return "LightVolume()"
    blinn = {**setting.PHONG, "shininess": setting.BLINN_SHININESS}
    return "Gradient(" + ", ".join(f"{key}: {ron(value)}" for key, value in blinn.items()) + ")"


def scene(name, lighting):
    volume = setting.VOLUMES[name]
    points = setting.merged_points(volume)
    pace = ron(setting.DEGREES_PER_FRAME * FRAMES_PER_SECOND)
    turntable = LIGHT_TURNTABLE.format(degrees_per_second=pace, up=ron(setting.UP))
    return SCENE.format(
        title=f"{TITLES[lighting]}, {name}",
        background=ron(setting.BACKGROUND),
        eye=ron(setting.EYE),
        target=ron(setting.TARGET),
        up=ron(setting.UP),
        fov=ron(setting.VERTICAL_FOV),
        degrees_per_second=pace,
        light_turntable=turntable if lighting == "scatter-turned" else "",
        light_direction=ron([to - at for at, to in zip(setting.LIGHT_FROM, setting.TARGET)]),
        irradiance=ron([math.pi * (4 if is_scattering(lighting) else 1)] * 3),
        name=name,
        file_name=volume.file_name(name),
        samples=volume.samples,
        spacing=ron([volume.spacing] * 3),
        points="\n".join(f"{' ' * 20}({ron(v / 255)}, {ron(rgb)}, {ron(a)})," for v, rgb, a in points),
        opacity_length=ron(setting.OPACITY_LENGTH),
        lighting=lighting_value(lighting),
        step_in_voxels=ron(setting.STEP / volume.spacing),
    )


def write_scene(folder, name, lighting):
    path = folder / f"{name}_{lighting}.ron"
    path.write_text(scene(name, lighting))
    return path


def environment(software):
    """Vulkan on the CPU where the machine has no GPU."""
    env = dict(os.environ)
    if software and not {"VK_ICD_FILENAMES", "VK_DRIVER_FILES"} & env.keys():
        env["VK_ICD_FILENAMES"] = str(lavapipe())
    return env


def lavapipe():
    for folder in ("/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"):
        for manifest in sorted(Path(folder).glob("lvp_icd*.json")):
            return manifest
    raise Failure("no software Vulkan driver (lvp_icd*.json): install mesa-vulkan-drivers, or set VK_ICD_FILENAMES")


def first_image(tyndall, scene_path, images, env, timeout):
    png = Path(f"{images}.png")
    return run([*command(tyndall, scene_path, png)], env, png, timeout)


def frames(tyndall, scene_path, images, count, env, timeout, more=()):
    """A run that draws frames 0..count into {images}_0000.png and on."""
    first, last = (Path(f"{images}_{i:04}.png") for i in (0, count - 1))
    last.unlink(missing_ok=True)
    words = [*command(tyndall, scene_path, f"{images}.png"), "--frames", f"0..{count}", *more]
    result = run(words, env, first, timeout)
    if not last.exists():
        raise Failure(f"{' '.join(map(str, words))}\n  ended well but left no {last.name}")
    return result


def command(tyndall, scene_path, png):
    width, height = setting.SIZE
    return [tyndall, "render", scene_path, "-o", png, "--size", f"{width}x{height}"]


def cpu_per_frame(tyndall, scene_path, images, warm_up, count, env, timeout):
    """(CPU of warm_up + count frames - CPU of warm_up frames) / count: start-up, loading and shader compilation cancel.

    The short run comes first and its images are overwritten, with equals, by the long one. What Tyndall says of its passes comes from a run of
    its own: to count samples it reads each picture back.
    """
    frames(tyndall, scene_path, images, warm_up, env, timeout, ("--stats", f"{images}_stats.json"))
    short = frames(tyndall, scene_path, images, warm_up, env, timeout)
    long = frames(tyndall, scene_path, images, warm_up + count, env, timeout)
    return {
        "cpu_s": [round((long.cpu_s - short.cpu_s) / count, 4)],
        "first_png_s": short.first_png_s,
        "whole_process_cpu_s": {"short": round(short.cpu_s, 3), "long": round(long.cpu_s, 3)},
    }
