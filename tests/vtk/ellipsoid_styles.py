# SPDX-License-Identifier: Apache-2.0
"""Styles of vtkAnamorphEllipsoidMapper against rays written out here in numpy: which pixels an ellipsoid without the octant toward the eye covers,
how deep they are, and where principal ellipses and hatches are; sizes by probability against a sum over the Gaussian; what is drawn
while a window is interacted with; labels by VTK's own mapper. Needs a display."""
import os
import tempfile

import anamorph
import numpy as np
from ellipsoid_scene import Scene, crowd, points_of
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkHardwareSelector
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingLabel import vtkLabeledDataMapper
import vtkmodules.vtkRenderingFreeType  # noqa: F401

SEED = 20261129
print("seed", SEED)
random = np.random.default_rng(SEED)
SIZE, ANGLE = 400, 30


def rotation(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rays(scene, parallel_scale):
    """Eyes and directions of all pixels, rows from the bottom up; a direction is 1 long along the camera's axis."""
    camera = scene.camera
    position, focus = np.array(camera.GetPosition()), np.array(camera.GetFocalPoint())
    back = (position - focus) / np.linalg.norm(position - focus)
    right = np.cross(camera.GetViewUp(), back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    y, x = (np.mgrid[0:SIZE, 0:SIZE] + 0.5) / SIZE * 2 - 1
    spread = x[..., None] * right + y[..., None] * up
    if parallel_scale:
        return position + parallel_scale * spread, np.broadcast_to(-back, spread.shape)
    return np.broadcast_to(position, spread.shape), spread * np.tan(np.radians(ANGLE / 2)) - back


def octant_of(axes, q, eyes, directions, parallel):
    """Of an ellipsoid about the origin without its octant toward the eye: depth (inf: not seen), the point in units of the axes, the face (-1: none)."""
    turn = rotation(q)
    e, d = eyes @ turn / axes, directions @ turn / axes
    toward = -d[0, 0] if parallel else e[0, 0]
    side = np.where(toward < 0, -1, 1)
    a, b, c = (d * d).sum(-1), (e * d).sum(-1), (e * e).sum(-1) - 1
    with np.errstate(invalid="ignore", divide="ignore"):
        t = (-b - np.sqrt(b * b - a * c)) / a
        point = e + t[..., None] * d
        within = (point * side > 0).all(-1)
        planes = np.where(d * side < 0, -e / d, np.inf)
        first = planes.min(-1)
        face = np.where(within, planes.argmin(-1), -1)
        t = np.where(within, first, t)
        point = e + t[..., None] * d
        seen = (b * b - a * c >= 0) & ~(within & ((point * point).sum(-1) > 1))
    return np.where(seen, t, np.inf), point, face


def grown(mask):
    """A mask and its neighbours."""
    result = mask.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            result |= np.roll(mask, step, axis)
    return result


def pixels_from(values):
    """How many pixels a smooth function is from 0, to first order, and whether that is so around."""
    dy, dx = np.gradient(values)
    return np.abs(values) / np.hypot(dx, dy)


def octants_and_ellipses():
    for trial in range(6):
        axes, q = random.uniform(0.4, 1.0, 3), random.normal(size=4)
        data = points_of([[0, 0, 0]], Axes=[axes], Orientation=[q])
        for parallel_scale in (None, 1.2):
            mapper = anamorph.vtkAnamorphEllipsoidMapper()
            mapper.SetInputData(data)
            scene = Scene(mapper, SIZE, SIZE)
            scene.look(3.5 * (lambda v: v / np.linalg.norm(v))(random.normal(size=3)), angle=ANGLE, parallel_scale=parallel_scale)
            scene.actor.GetProperty().LightingOff()
            plain = scene.colors()
            mapper.SetStyle(mapper.PRINCIPAL_ELLIPSES)
            lines, whole = scene.colors(), scene.depths()
            mapper.SetStyle(mapper.OCTANT)
            octant, depths = scene.colors(), scene.depths()
            eyes, directions = rays(scene, parallel_scale)
            exact, point, face = octant_of(axes, q, eyes, directions, parallel_scale is not None)
            # Silhouettes and depths, but where a pixel's middle is at an edge.
            edge = grown(np.isfinite(exact)) & grown(~np.isfinite(exact))
            assert np.array_equal(np.isfinite(depths)[~edge], np.isfinite(exact)[~edge]), trial
            smooth = np.isfinite(exact) & ~edge & ~(grown(face != face[SIZE // 2, SIZE // 2]) & grown(face == face[SIZE // 2, SIZE // 2]))
            both = smooth & np.isfinite(depths)
            assert both.sum() > 5000 and np.quantile(np.abs(depths[both] - exact[both]), 0.999) < 1e-4, trial
            assert (face >= 0).sum() > 500, "the octant is toward the eye"
            deeper = (face >= 0) & both
            assert (depths[deeper] > whole[deeper] - 1e-4).all()
            # Ink: on all that is within half a pixel of a principal plane, on nothing that is 2 pixels from all of them.
            dark = lines.sum(2) == 0
            shown = (plain.sum(2) > 0) & ~grown(plain.sum(2) == 0)
            turn = rotation(q)
            e, d = eyes @ turn / axes, directions @ turn / axes
            a, b, c = (d * d).sum(-1), (e * d).sum(-1), (e * e).sum(-1) - 1
            with np.errstate(invalid="ignore"):
                surface = e + ((-b - np.sqrt(b * b - a * c)) / a)[..., None] * d
                away = np.min([pixels_from(surface[..., k]) for k in range(3)], 0)
                inside = shown & ((surface * (surface @ np.eye(3))).sum(-1) > 0) & (b * b - a * c > 0.02 * b * b)
            assert dark[inside & (away < 0.5)].all() and not dark[inside & (away > 2)].any(), trial
            assert np.array_equal(lines[shown & ~dark], plain[shown & ~dark])
            hatched = [np.where(face == k, 5 * point[..., (k + 1) % 3], np.nan) for k in range(3)]
            for hatch in hatched:
                dy, dx = np.gradient(hatch)
                off = np.abs(hatch - np.round(hatch)) / np.hypot(dx, dy)
                inner = np.isfinite(off) & ~edge
                ink = octant.sum(2) == 0
                # Where a face is seen edge on the lines are next to each other.
                assert (~ink[inner & (off < 0.5)]).sum() <= 0.01 * inner.sum() and ink[inner & (off > 2)].sum() <= 0.01 * inner.sum(), trial


def selections_see_the_octant():
    """A second body in the octant of the first is found through it."""
    data = points_of([[0, 0, 0], [0.3, 0.3, 0.3]], Axes=[[1, 1, 1], [0.1, 0.1, 0.1]], Orientation=[[1, 0, 0, 0]] * 2)
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    scene = Scene(mapper, 100, 100)
    scene.look((4, 4, 4), angle=ANGLE)
    for style, wanted in ((mapper.PLAIN, [0]), (mapper.OCTANT, [1])):
        mapper.SetStyle(style)
        scene.window.Render()
        selector = vtkHardwareSelector()
        selector.SetRenderer(scene.renderer)
        selector.SetFieldAssociation(vtkDataObject.FIELD_ASSOCIATION_POINTS)
        selector.SetArea(50, 50, 50, 50)
        found = selector.Select().GetNode(0).GetSelectionList()
        assert [found.GetValue(i) for i in range(found.GetNumberOfTuples())] == wanted, (style, found)


def probabilities():
    """A body of a covariance holds as much of the Gaussian as it says: counted in the middle of thin shells."""
    covariance = np.diag([4.0, 1, 0.25])
    data = points_of([[0, 0, 0]], U=[covariance.ravel()])
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    mapper.SetShape(mapper.COVARIANCE)
    mapper.SetTensorArray("U")
    assert np.allclose(mapper.GetBounds(), [-2, 2, -1, 1, -0.5, 0.5], rtol=1e-12), "half axes are roots"
    for probability in (0.001, 0.01, 0.2, 0.5, 0.9, 0.99, 0.9999):
        mapper.SetProbability(probability)
        scale = mapper.GetBounds()[1] / 2
        step = scale / 100000
        r = (np.arange(100000) + 0.5) * step
        held = np.sqrt(2 / np.pi) * (r * r * np.exp(-r * r / 2)).sum() * step
        assert abs(held / probability - 1) < 1e-9, (probability, held)
    for bad in (-0.5, 1.0, 2.0, float("nan")):
        told = []
        mapper.AddObserver("ErrorEvent", lambda *_: told.append(1))
        mapper.SetProbability(bad)
        mapper.GetBounds()
        assert told, bad
        mapper.RemoveAllObservers()


CELL = """data_x
_cell_length_a 10
_cell_length_b 10
_cell_length_c 10
_cell_angle_alpha 90
_cell_angle_beta 90
_cell_angle_gamma 90
loop_
_atom_site_label
_atom_site_fract_x
_atom_site_fract_y
_atom_site_fract_z
_atom_site_U_iso_or_equiv
C1 .1 .1 .1 ?
O1 .5 .1 .1 .04
H1 .1 .5 .1 ?
loop_
_atom_site_aniso_label
_atom_site_aniso_U_11
_atom_site_aniso_U_22
_atom_site_aniso_U_33
_atom_site_aniso_U_23
_atom_site_aniso_U_13
_atom_site_aniso_U_12
C1 .01 .04 .09 0 0 0
"""


def structures():
    """Atoms of a .cif are as large as the probability says; places, and atoms without displacement, stay."""
    path = os.path.join(tempfile.mkdtemp(), "x.cif")
    with open(path, "w") as file:
        file.write(CELL)
    reader = anamorph.vtkAnamorphFigureReader()
    reader.SetFileName(path)

    def read():
        reader.Update()
        data = reader.GetOutput()
        return vtk_to_numpy(data.GetPoints().GetData()).copy(), vtk_to_numpy(data.GetPointData().GetArray("Axes")).copy()

    points, half = read()
    reader.SetProbability(0.9)
    moved, most = read()
    assert np.array_equal(points, moved) and np.array_equal(half[2], most[2])
    # Of a chi-squared distribution with 3 degrees of freedom: quantiles 2.365974 and 6.251389, from tables.
    assert np.allclose(most[:2] / half[:2], np.sqrt(6.251389 / 2.365974), rtol=1e-6), most / half
    told = []
    reader.AddObserver("ErrorEvent", lambda *_: told.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    reader.SetProbability(1)
    reader.Update()
    assert told
    # Their names are labels.
    reader.RemoveAllObservers()
    reader.SetProbability(0.5)
    reader.Update()
    mapper, labels, actor = anamorph.vtkAnamorphEllipsoidMapper(), vtkLabeledDataMapper(), vtkActor2D()
    mapper.SetInputConnection(reader.GetOutputPort())
    scene = Scene(mapper, 300, 300)
    scene.renderer.ResetCamera()
    before = scene.colors()
    labels.SetInputConnection(reader.GetOutputPort())
    labels.SetLabelModeToLabelFieldData()
    labels.SetFieldDataName("Name")
    actor.SetMapper(labels)
    scene.renderer.AddActor(actor)
    after = scene.colors()
    assert 50 < (before != after).any(2).sum() < 5000, "three names"


def interaction():
    """While a window is interacted with the largest bodies are drawn, the very pixels that they alone have; and all of them when it is still."""
    data = crowd(400, 0.05)
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    scene = Scene(mapper, 256, 256)
    scene.look((1.7, 2.1, 3.4), angle=ANGLE)
    still = scene.colors()
    longest = vtk_to_numpy(data.GetPointData().GetArray("Axes")).max(1)
    for count in (1, 37, 399, 400, 0):
        mapper.SetInteractiveBodies(count)
        scene.window.SetDesiredUpdateRate(15)
        fast = scene.ids()
        ids = fast.copy()
        scene.window.SetDesiredUpdateRate(0.001)
        every = scene.ids()
        if count in (0, 400):
            assert np.array_equal(fast, every)
            continue
        kept = set(np.argsort(-longest)[:count])
        assert set(ids[ids >= 0]) <= kept and (ids >= 0).any()
        hit = np.isin(every, list(kept))
        assert np.array_equal(fast[hit], every[hit])
    assert np.array_equal(scene_colors_again(data), still)


def scene_colors_again(data):
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    mapper.SetInteractiveBodies(0)
    scene = Scene(mapper, 256, 256)
    scene.look((1.7, 2.1, 3.4), angle=ANGLE)
    return scene.colors()


for check in (probabilities, structures, octants_and_ellipses, selections_see_the_octant, interaction):
    check()
    print(check.__name__, "is as it should be")
