# SPDX-License-Identifier: Apache-2.0
"""The representation "Ellipsoids" shows figures, blocks of them and tensors of an image as core's renderer does, fits the view to
them, selects them, and survives a state file. "Outlines of Ellipsoids" are those of core, and follow the camera. Several ranks show what
one process does."""
import os
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os
import sys

import anamorph
import numpy as np
from paraview import simple
from paraview.simple import *
from textures import texture_of
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

SIZE, COLORS = 200, {(250, 20, 30): 0, (20, 30, 250): 1}
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))


def script(name, shift):
    with open(name, "w") as file:
        file.write("figure f 2 a b\nellipsoid a 100 200 150\nellipsoid b 120 80 90\njoint j a 0 150 0 b 0 -50 0\n"
                   f"repeat 0 1 moveto f a {500 + shift} 400 300\nrepeat 0 1 bendby b j world 60 y\n"
                   "repeat 0 1 colour a 250 20 30\nrepeat 0 1 colour b 20 30 250\nstop")
    return OpenDataFile(os.path.abspath(name))


def new_view(parallel):
    view = CreateRenderView(ViewSize=[SIZE, SIZE], OrientationAxesVisibility=0, UseColorPaletteForBackground=0, Background=[0, 0, 0],
                            UseFXAA=0)
    view.CameraParallelProjection = parallel
    return view


def show(source, view):
    """As ellipsoids in their own colors, without light."""
    shown = Show(source, view)
    shown.SetRepresentationType("Ellipsoids")
    ColorBy(shown, ("POINTS", "Color"))
    shown.MapScalars, shown.Ambient, shown.Diffuse, shown.Specular = 0, 1, 0, 0
    return shown


def pixels(view):
    Render(view)
    SaveScreenshot("view.png", view, ImageResolution=[SIZE, SIZE])
    reader = vtkPNGReader()
    reader.SetFileName("view.png")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)[..., :3].astype(int)


def ids(view):
    found = np.full((SIZE, SIZE), -1)
    for color, body in COLORS.items():
        found[(pixels(view) == color).all(-1)] = body
    return found


def triangles(representation):
    """As many as a representation's mapper has."""
    return representation.GetActor().GetMapper().GetInputDataObject(0, 0).GetNumberOfElements(vtkDataObject.CELL)


def core_picture(data, view, style):
    image = anamorph.vtkAnamorphFigureImage()
    image.SetInputData(data)
    image.SetViewMode(image.CAMERA)
    image.SetStyle(style)
    image.SetViewSize(SIZE, SIZE)
    image.SetCameraPosition(*view.CameraPosition)
    image.SetCameraFocalPoint(*view.CameraFocalPoint)
    image.SetCameraViewUp(*view.CameraViewUp)
    image.SetCameraViewAngle(view.CameraViewAngle)
    image.SetCameraParallelProjection(view.CameraParallelProjection)
    image.SetCameraParallelScale(view.CameraParallelScale)
    image.Update()
    return vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)


def core_ids(data, view):
    return core_picture(data, view, anamorph.vtkAnamorphFigureImage.BODY_ID)[..., 0]


def thick(mask):
    """With the pixels around each."""
    wide = np.pad(mask, 1)
    return sum(wide[y:y + SIZE, x:x + SIZE] for y in (0, 1, 2) for x in (0, 1, 2)) > 0


def block(source, index=None):
    data = servermanager.Fetch(source)
    return data.GetBlock(index) if index is not None else data


first, second = script("first.nudes", 0), script("second.nudes", 300)
for parallel in (0, 1):
    view = new_view(parallel)
    shown = show(first, view)
    assert (shown.EllipsoidAxes, shown.EllipsoidOrientation) == ("Axes", "Orientation")
    ResetCamera(view)
    view.CameraPosition = [p + d for p, d in zip(view.CameraPosition, (300, 200, 0))]
    seen = ids(view)
    # Bodies fill the view: it was reset to what the points stand for.
    assert (seen >= 0).mean() > 0.1 and (seen != core_ids(block(first), view)).mean() <= 0.002
    # A rectangle in which both bodies are.
    SelectSurfacePoints(Rectangle=[0, 0, SIZE, SIZE], View=view)
    extract = ExtractSelection(Input=first)
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfPoints() == 2
    y, x = np.argwhere(seen == 1)[len(np.argwhere(seen == 1)) // 2]
    ClearSelection(first)
    SelectSurfacePoints(Rectangle=[int(x), int(y), int(x) + 1, int(y) + 1], View=view)
    extract = ExtractSelection(Input=first)
    extract.UpdatePipeline()
    found = servermanager.Fetch(extract).GetPointData().GetArray("vtkOriginalPointIds")
    assert vtk_to_numpy(found).tolist() == [1], vtk_to_numpy(found)
    ClearSelection(first)

# Outlines follow the camera: what is drawn is next to what core draws, and the other way round, in the bodies' colors.
for parallel in (0, 1):
    view = new_view(parallel)
    shown = Show(first, view)
    shown.SetRepresentationType("Outlines of Ellipsoids")
    assert (shown.OutlineHidden, shown.OutlineTolerance) == ("Removed", 0.1)
    ColorBy(shown, ("POINTS", "Color"))
    shown.MapScalars = 0
    ResetCamera(view)
    for turn in (0, 40, 80):
        GetActiveCamera().Azimuth(turn)
        drawn = pixels(view).max(-1) > 60
        alpha = core_picture(block(first), view, anamorph.vtkAnamorphFigureImage.OUTLINE)[..., 3]
        assert drawn.sum() > 300 and (drawn & ~thick(alpha > 0)).sum() == 0, (parallel, turn, (drawn & ~thick(alpha > 0)).sum())
        assert ((alpha > 128) & ~thick(drawn)).sum() <= 3, (parallel, turn, ((alpha > 128) & ~thick(drawn)).sum())
        assert {tuple(color) for color in np.unique(pixels(view)[drawn], axis=0)} == set(COLORS)
    shown.OutlineHidden = "Transparent"
    assert (pixels(view).max(-1) > 60).sum() > drawn.sum() + 20

# Surfaces follow the camera, too: they show core's bodies, and the nearer the camera is the more triangles there are.
for parallel in (0, 1):
    view = new_view(parallel)
    shown = Show(first, view)
    shown.SetRepresentationType("Surfaces of Ellipsoids")
    assert shown.SurfaceTolerance == 0.25
    ColorBy(shown, ("POINTS", "Color"))
    shown.MapScalars, shown.Ambient, shown.Diffuse, shown.Specular = 0, 1, 0, 0
    ResetCamera(view)
    counts = []
    for zoom in (1, 8):
        GetActiveCamera().Zoom(zoom)
        assert (ids(view) != core_ids(block(first), view)).mean() <= 0.005, (parallel, zoom)
        surfaces = shown.GetClientSideObject().GetActiveRepresentation()
        counts.append(triangles(surfaces))
    shown.SurfaceTolerance = 4
    Render(view)
    counts.append(triangles(surfaces))
    assert counts[1] > 4 * counts[0] and counts[2] < counts[1] / 4, counts

# A texture for the body whose name the script gives it.
with open("dressed.nudes", "w") as file:
    file.write("figure f 2 a b\nellipsoid a 100 100 100\nellipsoid b 100 100 100\njoint j a 0 150 0 b 0 -150 0\n"
               "repeat 0 1 moveto f a 500 400 300\nrepeat 0 1 colour a 250 20 30\nrepeat 0 1 colour b 20 30 250\n"
               "repeat 0 1 texture b wood 0 0\nstop")
green = vtkImageData()
green.SetDimensions(4, 4, 1)
green.GetPointData().SetScalars(numpy_to_vtk(np.tile(np.array([10, 240, 60], np.uint8), (16, 1)), deep=True))
writer = vtkPNGWriter()
writer.SetFileName("wood.png")
writer.SetInputData(green)
writer.Write()
view = new_view(1)
shown = show(OpenDataFile(os.path.abspath("dressed.nudes")), view)
ResetCamera(view)
before = pixels(view)
shown.EllipsoidTextures, shown.EllipsoidTextureNames = [texture_of(os.path.abspath("wood.png"))], ["wood"]
after = pixels(view)
assert ((after == (10, 240, 60)).all(-1) == (before == (20, 30, 250)).all(-1)).all() and (after == (10, 240, 60)).all(-1).sum() > 500
assert ((after == (250, 20, 30)).all(-1) == (before == (250, 20, 30)).all(-1)).all()
shown.EllipsoidTextures = []
assert (pixels(view) == before).all()

# Blocks: what is nearest of both.
both = GroupDatasets(Input=[first, second])
view = new_view(0)
show(both, view)
ResetCamera(view)
parts = [core_ids(block(both, i), view) for i in (0, 1)]
assert ((ids(view) >= 0) != ((parts[0] >= 0) | (parts[1] >= 0))).mean() <= 0.002

# Of one block alone.
shown = GetDisplayProperties(both, view)
hierarchy = both.GetDataInformation().GetHierarchy()
for i, part in enumerate(parts):
    shown.BlockSelectors = [hierarchy.GetNodePath(hierarchy.GetChild(hierarchy.GetRootNode(), i))]
    assert (ids(view) != part).mean() <= 0.002, i

# Tensors of an image, whose points inside are drawn as well as those of its surface.
image = vtkImageData()
image.SetDimensions(3, 3, 3)
tensors = np.tile(np.diag([0.3, 0.2, 0.1]).ravel(), (27, 1))
tensors[:13] = tensors[14:] = 0
for name, values in (("D", tensors), ("Color", np.tile(np.array([250, 20, 30], np.uint8), (27, 1)))):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    image.GetPointData().AddArray(array)
producer = TrivialProducer()
producer.GetClientSideObject().SetOutput(image)
view = new_view(1)
shown = show(producer, view)
shown.EllipsoidShape, shown.EllipsoidTensor, shown.EllipsoidScaleFactor = "Tensor", "D", 2.0
view.CameraPosition, view.CameraFocalPoint, view.CameraParallelScale = [1, 1, 9], [1, 1, 1], 1
y, x = (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE * 2 - 1
inside = (x / 0.6) ** 2 + (y / 0.4) ** 2 < 1
assert ((ids(view) == 0) != inside).mean() <= 0.002

# A state file. ParaView 6.1 prints an error of its own when it loads one in which a selection was cleared, so nothing of above is in it.
Delete(producer)
ResetSession()
show(script("first.nudes", 0), new_view(0))
shown = show(script("second.nudes", 300), new_view(0))
shown.EllipsoidShape, shown.EllipsoidScaleFactor, shown.EllipsoidOrientation = "Covariance", 2.0, "None"
SaveState("ellipsoids.pvsm")
ResetSession()
LoadState("ellipsoids.pvsm")
restored = [GetRepresentation(s, v) for v in GetViews() for s in GetSources().values() if s.GetXMLName() == "AnamorphFigureReader"]
kept = [(r.Representation, r.EllipsoidShape, r.EllipsoidOrientation, r.EllipsoidScaleFactor) for r in restored]
assert ("Ellipsoids", "Covariance", "None", 2) in kept and ("Ellipsoids", "Axes", "Orientation", 1) in kept, kept

# Defaults of the properties are those of the mapper.
proxy, mapper = servermanager.ProxyManager().NewProxy("representations", "AnamorphEllipsoidRepresentation"), anamorph.vtkAnamorphEllipsoidMapper()
for name in ("Shape", "AxesArray", "OrientationArray", "TensorArray", "ScaleFactor", "TextureArray", "TextureMapping"):
    default = proxy.GetProperty(name).GetDefaultValue(0) if name.endswith("Array") else proxy.GetProperty(name).GetElement(0)
    assert default == getattr(mapper, "Get" + name)(), (name, default)
proxy, outline = servermanager.ProxyManager().NewProxy("representations", "AnamorphOutlineRepresentation"), anamorph.vtkAnamorphFigureOutline()
for name in ("Hidden", "Crossings", "Connected", "Tolerance"):
    assert proxy.GetProperty(name).GetElement(0) == getattr(outline, "Get" + name)(), name
proxy, surface = servermanager.ProxyManager().NewProxy("representations", "AnamorphSurfaceRepresentation"), anamorph.vtkAnamorphFigureGeometry()
assert proxy.GetProperty("Tolerance").GetElement(0) == surface.GetTolerance()
print("shown")
'''
# What several ranks show, of which all but the first have no figures, is what one process does.
RANKS = r'''
import os
from paraview import simple
from paraview.simple import *
from textures import texture_of
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
figures = OpenDataFile(os.path.abspath("first.nudes"))
for name in ("Ellipsoids", "Outlines of Ellipsoids", "Surfaces of Ellipsoids"):
    view = CreateRenderView(ViewSize=[100, 100], OrientationAxesVisibility=0)
    Show(figures, view).SetRepresentationType(name)
    ResetCamera(view)
    Render(view)
    SaveScreenshot("ranks.png", view)
    reader = vtkPNGReader()
    reader.SetFileName("ranks.png")
    reader.Update()
    print("sum", vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int).sum())
'''


def run(script, number, *program):
    with open("show.py", "w") as file:
        file.write(script)
    done = subprocess.run([*xvfb_run(number), *program, "show.py"], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
                          capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:], done.stderr[-5000:])
    assert "ERR" not in done.stderr and "rror" not in done.stderr, done.stderr[-5000:]
    return [line for line in done.stdout.splitlines() if line.startswith(("shown", "sum"))]


assert run(SCRIPT, 361, "pvpython") == ["shown"]
alone, together = run(RANKS, 366, "pvpython"), run(RANKS, 371, "mpiexec", "--oversubscribe", "--mca",
                                               "mpi_yield_when_idle", "1", "-n", "2", "pvbatch")
assert alone == together and len(set(alone)) == 3, (alone, together)
