# SPDX-License-Identifier: Apache-2.0
# vtkPanoramicProjectionPass makes a panorama of a scene; thrown back from where it was taken, it shows what a camera there
# sees. Needs a display.
import math

import anamorph
import vtkmodules.vtkInteractionStyle  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTriangleFilter
from vtkmodules.vtkFiltersModeling import vtkLinearSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture,
                                         vtkWindowToImageFilter)
from vtkmodules.vtkRenderingOpenGL2 import vtkPanoramicProjectionPass, vtkRenderStepsPass

WIDTH, VIEW = 1024, 256
POSITION, TOLERANCE = (0.3, -0.2, 0.4), 1
# The panorama is sampled twice, by its pixels and by the view: smooth colours lose little, outlines more.
LEAST_PSNR = 33


def scene():
    """A room with a box and a ball, in colours that change over it."""
    room, box, ball = vtkCubeSource(), vtkCubeSource(), vtkSphereSource()
    for cube, size in ((room, 4), (box, 0.6)):
        for set_length in (cube.SetXLength, cube.SetYLength, cube.SetZLength):
            set_length(size)
    box.SetCenter(0.8, -0.4, -1)
    ball.SetCenter(-0.5, 0.3, -1.2)
    ball.SetRadius(0.4)
    ball.SetThetaResolution(20)
    ball.SetPhiResolution(14)
    together, triangles, finer = vtkAppendPolyData(), vtkTriangleFilter(), vtkLinearSubdivisionFilter()
    for source in (room, box, ball):
        together.AddInputConnection(source.GetOutputPort())
    triangles.SetInputConnection(together.GetOutputPort())
    finer.SetInputConnection(triangles.GetOutputPort())
    finer.SetNumberOfSubdivisions(2)
    finer.Update()
    mesh = finer.GetOutput()
    colours = vtkUnsignedCharArray()
    colours.SetNumberOfComponents(3)
    for i in range(mesh.GetNumberOfPoints()):
        x, y, z = mesh.GetPoint(i)
        colours.InsertNextTuple3(*(127 + 110 * math.sin(w + p) for w, p in ((3 * x + y, 0), (3 * y - z, 1), (3 * z + x, 2))))
    mesh.GetPointData().SetScalars(colours)
    return mesh


def actor_of(mesh, texture=None):
    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(mesh)
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    if texture:
        mapper.ScalarVisibilityOff()
        actor.SetTexture(texture)
    return actor


def picture(actor, size, panorama=False):
    renderer, window, grab = vtkRenderer(), vtkRenderWindow(), vtkWindowToImageFilter()
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(POSITION)
    camera.SetFocalPoint(POSITION[0], POSITION[1], POSITION[2] - 1)
    camera.SetViewAngle(70)
    camera.SetClippingRange(0.05, 20)
    if panorama:
        steps, around = vtkRenderStepsPass(), vtkPanoramicProjectionPass()
        around.SetProjectionTypeToEquirectangular()
        around.SetAngle(360)
        around.SetCubeResolution(WIDTH // 2)
        around.SetDelegatePass(steps)
        renderer.SetPass(around)
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    window.Render()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    window.Finalize()
    return image


def pixels(image):
    return vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)


mesh = scene()
panorama = picture(actor_of(mesh), (WIDTH, WIDTH // 2), True)
projection = anamorph.vtkAnamorphPanoramaProjection()
projection.SetInputData(mesh)
projection.SetPosition(POSITION)
projection.SetPanoramaWidth(WIDTH)
projection.SetPanoramaHeight(WIDTH // 2)
projection.SetTolerance(TOLERANCE)
projection.Update()
painted = projection.GetOutputDataObject(0)
assert painted.GetNumberOfCells() > 1000
texture = vtkTexture()
texture.SetInputData(panorama)
texture.InterpolateOn()
texture.RepeatOff()
texture.EdgeClampOn()
truth = pixels(picture(actor_of(mesh), (VIEW, VIEW)))
shown = pixels(picture(actor_of(painted, texture), (VIEW, VIEW)))
square = ((truth - shown) ** 2).mean()
psnr = 10 * math.log10(255 ** 2 / square)
print("triangles", painted.GetNumberOfCells(), "PSNR", round(psnr, 2), flush=True)
assert truth.std() > 30
assert psnr >= LEAST_PSNR, psnr
# The same fragment by fragment. Nothing is hidden here; borders of shadows by a map of distances cost pixels at outlines.
thrown, projector, shader = actor_of(mesh), anamorph.vtkAnamorphPanoramaProjector(), anamorph.vtkAnamorphProjectionShader()
thrown.GetMapper().ScalarVisibilityOff()
projector.SetPanorama(texture)
projector.SetPosition(POSITION)
shader.AddProjector(projector)
shader.AddTo(thrown)
for occluders, least in ((None, LEAST_PSNR), (mesh, LEAST_PSNR - 1)):
    projector.SetOccluderData(occluders)
    by_fragment = 10 * math.log10(255 ** 2 / ((truth - pixels(picture(thrown, (VIEW, VIEW)))) ** 2).mean())
    print("fragment by fragment", round(by_fragment, 2), flush=True)
    assert by_fragment >= least, by_fragment
# A panorama that were off would show.
texels = painted.GetPointData().GetTCoords()
for i in range(painted.GetNumberOfPoints()):
    u, v = texels.GetTuple2(i)
    texels.SetTuple2(i, u + 4 / WIDTH, v)
moved = pixels(picture(actor_of(painted, texture), (VIEW, VIEW)))
worse = 10 * math.log10(255 ** 2 / ((truth - moved) ** 2).mean())
print("moved by 4 texels", round(worse, 2), flush=True)
assert worse < psnr - 3, (worse, psnr)
