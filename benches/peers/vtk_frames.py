"""Draws the comparison's frames with VTK and prints one line of JSON. Run inside the venv that compare.py makes.

python vtk_frames.py --data DIR --volume engine --lighting ea --mapper cpu --warm-up 2 --frames 5 --images PREFIX

Frame i is seen from i degrees of azimuth. The first --warm-up frames are drawn but not reported. Each later frame is timed
around Render and WaitForCompletion with the process's CPU clock, which counts all threads. PREFIX_0000.png and the last
frame's PNG are written outside the timed spans. Needs the `vtk` wheel and nothing else, and imports only what it draws with.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the window
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  registers the volume's drawing
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

import setting

GPU_MEMORY_BYTES = 2 << 30  # the mapper's own default may be smaller than the volume


def load(volume, path):
    """Point data: the outermost samples lie on the border of the drawn box."""
    n, spacing = volume.samples, volume.spacing
    origin = -spacing * (n - 1) / 2
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.SetSpacing(spacing, spacing, spacing)
    image.SetOrigin(origin, origin, origin)
    image.AllocateScalars(VTK_UNSIGNED_CHAR, 1)
    memoryview(image.GetPointData().GetScalars()).cast("B")[:] = path.read_bytes()
    return image


def appearance(volume, lighting):
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for value, *rgb in volume.color:
        color.AddRGBPoint(value, *rgb)
    for value, alpha in volume.opacity:
        opacity.AddPoint(value, alpha)
    look = vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(setting.OPACITY_LENGTH)
    look.SetInterpolationTypeToLinear()
    look.SetShade(lighting != "ea")
    look.SetAmbient(setting.PHONG["ambient"])
    look.SetDiffuse(setting.PHONG["diffuse"])
    look.SetSpecular(setting.PHONG["specular"])
    look.SetSpecularPower(setting.PHONG["shininess"])
    look.SetScatteringAnisotropy(setting.SCATTERING["anisotropy"])
    return look


def gpu_mapper():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetMaxMemoryInBytes(GPU_MEMORY_BYTES)
    mapper.SetUseJittering(False)
    return mapper


def scatter(mapper):
    mapper.SetVolumetricScatteringBlending(setting.SCATTERING["blending"])
    mapper.SetGlobalIlluminationReach(setting.SCATTERING["reach"])


def cpu_mapper():
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInteractiveSampleDistance(setting.STEP)
    mapper.SetMinimumImageSampleDistance(1.0)
    mapper.SetMaximumImageSampleDistance(1.0)
    return mapper


def make_mapper(kind, image):
    mapper = {"gpu": gpu_mapper, "cpu": cpu_mapper}[kind]()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(setting.STEP)
    mapper.SetImageSampleDistance(1.0)
    return mapper


def sun():
    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPositional(False)
    light.SetPosition(*setting.LIGHT_FROM)
    light.SetFocalPoint(*setting.TARGET)
    light.SetColor(1.0, 1.0, 1.0)
    light.SetIntensity(1.0)
    return light


def stage(volume):
    renderer = vtkRenderer()
    renderer.SetBackground(*setting.BACKGROUND)
    renderer.AddVolume(volume)
    renderer.RemoveAllLights()
    renderer.AddLight(sun())
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*setting.EYE)
    camera.SetFocalPoint(*setting.TARGET)
    camera.SetViewUp(*setting.UP)
    camera.SetViewAngle(setting.VERTICAL_FOV)  # vertical, VTK's default reading
    return renderer


def off_screen(renderer):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(*setting.SIZE)
    window.SetDesiredUpdateRate(0.0001)  # no hurry: nothing may lower the quality
    window.AddRenderer(renderer)
    return window


def save(window, path):
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    writer = vtkPNGWriter()
    writer.SetFileName(str(path))
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()
    low, high = grab.GetOutput().GetScalarRange()
    if low == high:
        sys.exit(f"VTK drew nothing: every value of {path} is {low:g}. Its messages above say why.")


def draw(window):
    """CPU and wall seconds of one frame."""
    cpu, wall = time.process_time(), time.perf_counter()
    window.Render()
    window.WaitForCompletion()
    return time.process_time() - cpu, time.perf_counter() - wall


def turn_and_draw(window, renderer, args):
    times, last = [], args.warm_up + args.frames - 1
    save_cpu = None
    for frame in range(last + 1):
        if frame:
            renderer.GetActiveCamera().Azimuth(setting.DEGREES_PER_FRAME)
        renderer.ResetCameraClippingRange()
        times.append(draw(window))
        if frame in (0, last):
            before = time.process_time()
            save(window, f"{args.images}_{frame:04}.png")
            save_cpu = time.process_time() - before
    return times[args.warm_up :], save_cpu


def gl_renderer(window):
    lines = window.ReportCapabilities().splitlines()
    return next((line.split(":", 1)[1].strip() for line in lines if "renderer string" in line), "unknown")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with the volumes")
    parser.add_argument("--volume", choices=setting.VOLUMES, default="engine")
    parser.add_argument("--lighting", choices=("ea", "phong", "scatter"), required=True)
    parser.add_argument("--mapper", choices=("cpu", "gpu"), required=True)
    parser.add_argument("--warm-up", type=int, default=setting.WARM_UP_FRAMES)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--images", required=True, help="prefix of the PNG files")
    return parser.parse_args()


def main():
    args = arguments()
    spec = setting.VOLUMES[args.volume]
    volume = vtkVolume()
    mapper = make_mapper(args.mapper, load(spec, args.data / spec.file_name(args.volume)))
    if args.lighting == "scatter":
        scatter(mapper)
    volume.SetMapper(mapper)
    volume.SetProperty(appearance(spec, args.lighting))
    renderer = stage(volume)
    window = off_screen(renderer)
    times, save_cpu = turn_and_draw(window, renderer, args)
    print(
        json.dumps(
            {
                "cpu_s": [round(cpu, 4) for cpu, _ in times],
                "wall_s": [round(wall, 4) for _, wall in times],
                "save_png_cpu_s": round(save_cpu, 4),
                "eye": [round(c, 3) for c in renderer.GetActiveCamera().GetPosition()],
                "vtk": vtkVersion.GetVTKVersion(),
                "window": window.GetClassName(),
                "gl_renderer": gl_renderer(window),
            }
        )
    )


if __name__ == "__main__":
    main()
