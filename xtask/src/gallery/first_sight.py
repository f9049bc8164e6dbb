"""Draws files with another program's own defaults: first_sight.py f3d|vtk WIDTH HEIGHT INPUT OUTPUT [INPUT OUTPUT ...]

One file at a time in a process of its own, so that one that cannot be opened takes no other with it. Needs the wheels `f3d` and `vtk`.
"""

import multiprocessing
import sys

MESHES = {"obj": "vtkOBJReader", "ply": "vtkPLYReader", "stl": "vtkSTLReader"}
VOLUMES = {
    "nii": "vtkNIFTIImageReader",
    "nii.gz": "vtkNIFTIImageReader",
    "nrrd": "vtkNrrdReader",
    "nhdr": "vtkNrrdReader",
    "mha": "vtkMetaImageReader",
    "mhd": "vtkMetaImageReader",
    "dcm": "vtkDICOMImageReader",
    "vtk": "vtkStructuredPointsReader",
    "vti": "vtkXMLImageDataReader",
    "tif": "vtkTIFFReader",
    "tiff": "vtkTIFFReader",
}


def f3d(width, height, source, picture):
    import f3d

    f3d.Log.set_verbose_level(f3d.Log.QUIET)
    engine = f3d.Engine.create(True)
    engine.window.size = width, height
    engine.scene.add(source)
    engine.window.render_to_image().save(picture)


def vtk(width, height, source, picture):
    import vtk

    def reader(kinds):
        name = next((name for ending, name in kinds.items() if source.lower().endswith("." + ending)), None)
        if name is None:
            return None
        found = getattr(vtk, name)()
        found.SetFileName(source)
        return found

    vtk.vtkObject.GlobalWarningDisplayOff()
    renderer = vtk.vtkRenderer()
    if mesh := reader(MESHES):
        mapper, shown = vtk.vtkPolyDataMapper(), vtk.vtkActor()
        mapper.SetInputConnection(mesh.GetOutputPort())
    elif volume := reader(VOLUMES):
        mapper, shown = vtk.vtkSmartVolumeMapper(), vtk.vtkVolume()
        mapper.SetInputConnection(volume.GetOutputPort())
    else:
        sys.exit(f"{source}: VTK has no reader for it")
    shown.SetMapper(mapper)
    renderer.AddViewProp(shown)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    window.Render()
    image, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    image.SetInput(window)
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(picture)
    writer.Write()


if __name__ == "__main__":
    draw = {"f3d": f3d, "vtk": vtk}[sys.argv[1]]
    width, height = int(sys.argv[2]), int(sys.argv[3])
    for source, picture in zip(sys.argv[4::2], sys.argv[5::2]):
        process = multiprocessing.Process(target=draw, args=(width, height, source, picture))
        process.start()
        process.join(120)
        process.kill()
