#!/usr/bin/env python3
"""How far VTK's volumetric scattering is from the light in a cloud, path traced: the reference of `cargo bench --bench volumes`.

    target/peers/venv/bin/python benches/peers/cloud.py TRUTH/images [FOLDER FOR PICTURES]

Runs inside the venv that compare.py makes. VTK knows no irradiance, so the errors that say something are those after the best factor
for each channel. The scene is the one of the truth's README: orthographic from +z, light along (-2, -1, -1).
"""

import sys
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the window
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  registers the volume's drawing
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

VOXELS, SIDE, RAYS = 64, 128, 4
SIGMA_T, ALBEDO, G = 12.0, (0.95, 0.85, 0.6), 0.3
LIGHT_FROM = (2.0, 1.0, 1.0)
STEP = 1 / VOXELS  # half a voxel
SHOWN = 2e-4  # the reference adds up to more where it shows the cloud
# Blending 1 is secondary rays alone between 0, gradients alone, and 2; reach is the length of secondary rays.
SETTINGS = [(0.0, 0.0), (1.0, 0.3), (1.0, 1.0), (2.0, 0.3), (2.0, 1.0)]


def image(density):
    data = vtkImageData()
    data.SetDimensions(VOXELS, VOXELS, VOXELS)
    data.SetSpacing([2 / VOXELS] * 3)
    data.SetOrigin([1 / VOXELS - 1] * 3)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(density, np.float32).ravel(), deep=True))
    return data


def appearance(greatest):
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    color.AddRGBPoint(0.0, *ALBEDO)
    color.AddRGBPoint(greatest, *ALBEDO)
    for value in np.linspace(0.0, greatest, 513):
        opacity.AddPoint(value, -np.expm1(-SIGMA_T * value * STEP))
    look = vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(STEP)
    look.SetInterpolationTypeToLinear()
    look.ShadeOn()
    look.SetAmbient(0.0)
    look.SetDiffuse(1.0)
    look.SetSpecular(0.0)
    look.SetScatteringAnisotropy(G)
    return look


def stage(volume):
    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPositional(False)
    light.SetPosition(*LIGHT_FROM)
    light.SetFocalPoint(0.0, 0.0, 0.0)
    renderer = vtkRenderer()
    renderer.SetBackground(0.0, 0.0, 0.0)
    renderer.AddVolume(volume)
    renderer.RemoveAllLights()
    renderer.AddLight(light)
    camera = renderer.GetActiveCamera()
    camera.SetParallelProjection(True)
    camera.SetParallelScale(1.2)
    camera.SetPosition(0.0, 0.0, 10.0)
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    renderer.ResetCameraClippingRange()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(SIDE * RAYS, SIDE * RAYS)
    window.AddRenderer(renderer)
    return window


def draw(window):
    """The pixels as shares of white, from the top, each the mean of its rays."""
    window.Render()
    window.WaitForCompletion()
    pixels, n = vtkUnsignedCharArray(), SIDE * RAYS
    window.GetPixelData(0, 0, n - 1, n - 1, 1, pixels, 0)
    seen = vtk_to_numpy(pixels).reshape(SIDE, RAYS, SIDE, RAYS, 3)[::-1].astype(np.float64)
    return seen.mean((1, 3)) / 255.0


def error(seen, truth):
    """Relative root mean square errors: of all channels, and of each."""
    squares = ((seen - truth) ** 2).mean(0)
    return [np.sqrt(squares.mean()) / truth.mean(), *(np.sqrt(squares) / truth.mean(0))]


def main():
    folder = Path(sys.argv[1])
    density, truth = np.load(folder / "grid_density_zyx.npy"), np.load(folder / "grid_mean.npy").astype(np.float64)
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetUseJittering(False)
    mapper.SetInputData(image(density))
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(STEP)
    mapper.SetImageSampleDistance(1.0)
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(appearance(float(density.max())))
    window = stage(volume)
    shown = truth.sum(2) > SHOWN
    print("| blending | reach | error as it is | after the best factors | red | green | blue |\n|---|---|---|---|---|---|---|")
    for blending, reach in SETTINGS:
        mapper.SetVolumetricScatteringBlending(blending)
        mapper.SetGlobalIlluminationReach(reach)
        picture = draw(window)
        seen, wanted = picture[shown], truth[shown]
        factors = (seen * wanted).sum(0) / (seen**2).sum(0)
        figures = [error(seen, wanted)[0], *error(factors * seen, wanted)]
        print(f"| {blending:g} | {reach:g} | " + " | ".join(f"{100 * figure:.1f} %" for figure in figures) + " |", flush=True)
        if len(sys.argv) > 2:
            save(Path(sys.argv[2]) / f"cloud_{blending:g}_{reach:g}.png", factors * picture, truth)


def save(path, seen, truth):
    """The picture with its factors, the reference, and their difference times 3."""
    from PIL import Image

    panels = np.concatenate([seen, truth, 3 * np.abs(seen - truth)], axis=1)
    encoded = np.clip(panels / truth.max(), 0, 1) ** (1 / 2.2)
    Image.fromarray(np.rint(255 * encoded).astype(np.uint8)).save(path)


if __name__ == "__main__":
    main()
