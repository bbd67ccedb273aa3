# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphEllipsoidMapper draws what core's own renderer does (vtkAnamorphFigureImage), pixel for pixel; and what VTK offers
# besides (selection, lights, textures, clipping planes) works on it. Needs a display.
import gc
import math

import numpy as np
import vtkmodules.vtkInteractionStyle  # noqa: F401
from conformance import ghosts_of
from ellipsoid_scene import Scene, core_picture, crowd, points_of
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference as Reference, vtkSOADataArrayTemplate, vtkStringArray, vtkUnsignedCharArray, vtkWeakReference
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkDataObject, vtkImageData, vtkMultiBlockDataSet, vtkPartitionedDataSet,
                                           vtkPartitionedDataSetCollection, vtkPlane)
from vtkmodules.vtkRenderingCore import (vtkCellPicker, vtkCompositeDataDisplayAttributes, vtkHardwareSelector, vtkLight,
                                         vtkPolyDataMapper, vtkPropPicker, vtkRenderWindow, vtkTexture)

import anamorph

Image = anamorph.vtkAnamorphFigureImage
WRONG_PIXELS = 0.002  # of all; measured: at most 0.00006, where two bodies are equally near or a limb is on a pixel's middle
EYE, ANGLE, SCALE = (1.7, 2.1, 3.4), 34, 1.2
IDENTITY = (1.0, 0, 0, 0)


def mapper_of(data, **settings):
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    for name, value in settings.items():
        getattr(mapper, "Set" + name)(value)
    return mapper


def scenes(data, size=256, eye=EYE, focus=(0, 0, 0), scale=SCALE):
    """The data in perspective, and in parallel."""
    for parallel_scale in (None, scale):
        scene = Scene(mapper_of(data), size, size)
        scene.look(eye, focus, angle=ANGLE, parallel_scale=parallel_scale)
        yield scene


def wrong(scene, data):
    return (scene.ids() != core_picture(data, scene, Image.BODY_ID)).mean()


def depth_step(scene, depths):
    """How far apart depths are that a buffer of 24 bits tells apart."""
    near, far = scene.camera.GetClippingRange()
    if scene.camera.GetParallelProjection():
        return (far - near) / 2 ** 24
    return depths ** 2 * (far - near) / (near * far) / 2 ** 24


def ids_and_depths_are_those_of_core():
    for data in (crowd(2000), crowd(60, 0.2), crowd(300, 0.04, aspect=30)):
        for scene in scenes(data, 512):
            ids, reference = scene.ids(), core_picture(data, scene, Image.BODY_ID)
            assert (ids >= 0).mean() > 0.3
            assert (ids != reference).mean() <= WRONG_PIXELS, (ids != reference).mean()
            depths, exact = scene.depths(), core_picture(data, scene, Image.DEPTH)
            if scene.camera.GetParallelProjection():
                exact += np.linalg.norm(EYE)  # core counts from the middle of the view
            # In steps of a buffer of 24 bits; limbs, where the surface is seen edge-on, are a few in a thousand.
            same = (ids == reference) & (ids >= 0)
            error = np.abs(depths - exact)[same]
            steps = error / depth_step(scene, exact[same])
            assert np.quantile(steps, 0.99) < 4 and error.max() < 2e-3, (np.quantile(steps, 0.99), error.max())


def light_as_core(scene):
    scene.actor.GetProperty().SetAmbient(0.3)
    scene.actor.GetProperty().SetDiffuse(0.7)
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(-1, 2, 2)
    light.SetFocalPoint(0, 0, 0)
    scene.renderer.AddLight(light)


def shading_is_that_of_core():
    data = crowd(200, 0.1)
    for scene in scenes(data):
        scene.mapper.SetScalarModeToUsePointFieldData()
        scene.mapper.SelectColorArray("Color")
        light_as_core(scene)
        ids, reference = scene.ids(), core_picture(data, scene, Image.BODY_ID)
        scene.mapper.SelectColorArray("Color")
        exact = core_picture(data, scene, Image.SHADED, Lighting=Image.LAMBERT, Antialias=False)
        error = np.abs(scene.colors() - exact[..., :3])[(ids == reference) & (ids >= 0)]
        # Two roundings to bytes, of the color and of the result; a normal turns fast at a limb.
        assert error.mean() < 0.3 and np.quantile(error, 0.999) <= 2, (error.mean(), np.quantile(error, 0.999), error.max())


def a_camera_within_and_a_plane_show_the_far_side():
    ball = points_of([(0, 0, 0), (0, 0, -1.5)], Axes=[(2.0, 1.5, 3), (0.3, 0.4, 0.2)], Orientation=[IDENTITY] * 2,
                     Id=np.array([(0, 0, 255), (1, 0, 255)], np.uint8))
    scene = Scene(mapper_of(ball), 256, 256)
    scene.look((0.3, 0.2, 0.9), (0, 0, -1), angle=80)
    scene.camera.SetClippingRange(0.01, 10)
    ids = scene.ids()
    assert (ids == core_picture(ball, scene, Image.BODY_ID)).all() and set(np.unique(ids)) == {0, 1}
    # Far sides are where the rays leave: x^T diag(a)^-2 x = 1.
    depth, t = scene.depths()[128, 20], math.tan(math.radians(40)) / 128
    away = np.array([-0.3, -0.2, -1.9]) / np.linalg.norm([-0.3, -0.2, -1.9])
    right = np.cross(away, (0, 1, 0)) / np.linalg.norm(np.cross(away, (0, 1, 0)))
    ray = away + right * (20.5 - 128) * t + np.cross(right, away) * 0.5 * t
    point = np.array([0.3, 0.2, 0.9]) + depth * ray
    assert abs(np.sum((point / (2, 1.5, 3)) ** 2) - 1) < 1e-3, point
    # The near plane cuts the front off.
    scene.look((0, 0, 6), angle=40)
    scene.camera.SetClippingRange(4, 12)
    assert scene.ids()[128, 128] == 1 and scene.ids()[128, 150] == 0
    assert abs(scene.depths()[128, 190] - 6) < 3 and scene.depths()[128, 160] > 6
    # So does a clipping plane, in the world's coordinates: everything left of it is gone.
    scene = Scene(mapper_of(ball), 256, 256)
    scene.actor.SetPosition(0.5, 0, 0)
    plane = vtkPlane()
    plane.SetOrigin(0.5, 0, 0)
    plane.SetNormal(1, 0, 0)
    scene.mapper.AddClippingPlane(plane)
    scene.look((0.5, 0, 12), (0.5, 0, 0), parallel_scale=3)
    ids = scene.ids()
    assert (ids[:, :127] == -1).all() and ids[128, 140] == 0


def needles_and_discs():
    data = points_of([(0, 0, 0), (0.4, 0.1, 0)], Axes=[(1, 1e-3, 1e-3), (0.4, 0.4, 4e-4)],
                     Orientation=[(0.9, 0.1, 0.2, 0.35), (0.6, 0.5, 0.2, 0.3)], Id=np.array([(0, 0, 255), (1, 0, 255)], np.uint8))
    for scene in scenes(data, 512, scale=0.6):
        ids = scene.ids()
        assert (ids == 0).sum() > 100 and (ids == 1).sum() > 1000
        assert wrong(scene, data) < 2e-4


def any_scale_and_any_origin():
    plain = crowd(60, 0.2)
    centers, axes = (vtk_to_numpy(a) for a in (plain.GetPoints().GetData(), plain.GetPointData().GetArray("Axes")))
    turns = vtk_to_numpy(plain.GetPointData().GetArray("Orientation"))
    ids = vtk_to_numpy(plain.GetPointData().GetArray("Id"))
    for factor, origin in ((1e-9, 0), (1e9, 0), (1, 1e6), (1e-3, 1e5)):
        origin = np.array([1, -2, 3]) * float(origin)
        data = points_of(origin + factor * centers, Axes=factor * axes, Orientation=turns, Id=ids)
        for scene in scenes(data, 256, origin + factor * np.array(EYE), origin, factor * SCALE):
            # VTK's camera has a few digits less of such an origin.
            assert wrong(scene, data) <= WRONG_PIXELS, (factor, origin, wrong(scene, data))


def turns_of(data):
    """The rotations of the points' quaternions, as matrices."""
    turns = vtk_to_numpy(data.GetPointData().GetArray("Orientation"))
    w, x, y, z = (turns / np.linalg.norm(turns, axis=1)[:, None]).T
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)


def tensors_are_axes():
    data = crowd(60, 0.2)
    centers, axes = (vtk_to_numpy(a) for a in (data.GetPoints().GetData(), data.GetPointData().GetArray("Axes")))
    turn = turns_of(data)
    symmetric = np.einsum("nij,nj,nkj->nik", turn, axes, turn)
    general = np.einsum("nij,nj,jk->nik", turn, axes, np.array([[0.6, 0, 0.8], [0, -1, 0], [0.8, 0, -0.6]]))
    covariance = np.einsum("nij,nj,nkj->nik", turn, axes ** 2, turn) * 0.25
    six = symmetric.reshape(-1, 9)[:, [0, 4, 8, 1, 5, 2]]
    ids = vtk_to_numpy(data.GetPointData().GetArray("Id"))
    expected = next(scenes(data)).ids()
    for shape, tensor, scale in (("TENSOR", symmetric, 1), ("TENSOR", general, 1), ("TENSOR", six, 1), ("COVARIANCE", covariance, 2)):
        points = points_of(centers, Tensor=tensor.reshape(len(ids), -1), Id=ids)
        scene = Scene(mapper_of(points, TensorArray="Tensor", ScaleFactor=scale,
                                Shape=getattr(anamorph.vtkAnamorphEllipsoidMapper, shape)), 256, 256)
        scene.look(EYE, angle=ANGLE)
        assert (scene.ids() != expected).mean() < 1e-4, shape


def points_without_an_ellipsoid_are_skipped_and_counted():
    nan, inf = math.nan, math.inf
    centers = [(0, 0, 0), (1, 0, 0), (nan, 0, 0), (0, inf, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (-1, 0, 0)]
    axes = [(0.1, 0.2, 0.3), (0.1, 0, 0.1), (1, 1, 1), (1, 1, 1), (nan, 1, 1), (1, inf, 1), (1, 1, 1), (0.3, 0.2, 0.1)]
    turns = [IDENTITY] * 6 + [(0, 0, 0, 0), IDENTITY]
    data = points_of(centers, Axes=axes, Orientation=turns,
                     Id=np.array([(i, 0, 255) for i in range(len(axes))], np.uint8))
    scene = next(scenes(data))
    assert set(np.unique(scene.ids())) == {-1, 0, 7}
    assert scene.mapper.GetNumberOfSkippedPoints() == 6
    assert scene.mapper.GetBounds() == (-1.3, 0.1, -0.2, 0.2, -0.3, 0.3)
    ghosts = vtkUnsignedCharArray()
    ghosts.SetName("vtkGhostType")
    for i in range(len(axes)):
        ghosts.InsertNextValue(2 if i == 7 else 0)  # hidden
    data.GetPointData().AddArray(ghosts)
    data.Modified()
    assert set(np.unique(scene.ids())) == {-1, 0}
    for empty in (points_of([]), points_of([(0, 0, 0)], Axes=[(0.0, 0, 0)], Orientation=[IDENTITY])):
        scene = next(scenes(empty))
        assert scene.colors().max() == 0


def pair(ghosts=None, axes=((0.5, 0.5, 0.5), (0.5, 0.4, 0.3))):
    """Two bodies beside each other, 0 and 1."""
    data = points_of([(-1, 0, 0), (1, 0, 0)], Axes=np.array(axes), Orientation=[IDENTITY] * 2,
                     Id=np.array([(0, 0, 255), (1, 0, 255)], np.uint8))
    if ghosts:
        data.GetPointData().AddArray(ghosts_of(ghosts))
    return data


def shown(scene):
    return set(np.unique(scene.ids())) - {-1}


def ghosts_are_neither_drawn_nor_met():
    duplicate, hidden, other = 1, 2, 64
    left, right = (-1.5, -0.5, -0.5, 0.5, -0.5, 0.5), (0.5, 1.5, -0.4, 0.4, -0.3, 0.3)
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, pair((hidden, 0)))
    blocks.SetBlock(1, pair((duplicate, 0)))
    for data, wanted, bounds in ((pair((0, duplicate)), {0}, left), (pair((duplicate | other, 0)), {1}, right),
                                 (pair((0, hidden)), {0}, left), (pair((other, duplicate)), {0}, left),
                                 (pair((hidden, duplicate)), set(), None), (blocks, {1}, right)):
        for scene in scenes(data):
            assert shown(scene) == wanted
            assert scene.mapper.GetBounds() == (bounds or (1, -1, 1, -1, 1, -1))
            assert scene.mapper.GetNumberOfSkippedPoints() == 0, "they are bodies"
            found = selected(scene, vtkDataObject.FIELD_ASSOCIATION_POINTS, 0, 0, 255, 255)
            assert set().union(*found.values()) == wanted
        if isinstance(data, vtkMultiBlockDataSet):
            continue
        for point, x in enumerate((-1.0, 1.0)):
            t, cell = Reference(0.0), Reference(0)
            met = scene.mapper.IntersectWithLine(data, (x, 0, 5), (x, 0, -5), t, cell)
            assert met == (point if point in wanted else -1), (met, wanted)


def an_axis_may_be_negative_and_arrays_of_any_layout():
    plain = [scene.ids() for scene in scenes(pair())]
    assert set(np.unique(plain[0])) == {-1, 0, 1}
    mirrored = pair(axes=((-0.5, 0.5, -0.5), (0.5, -0.4, -0.3)))
    apart, integers = pair(), pair(axes=((5, 5, 5), (5, 4, 3)))
    for array in (apart.GetPoints().GetData(), apart.GetPointData().GetArray("Axes"), apart.GetPointData().GetArray("Orientation")):
        copy = vtkSOADataArrayTemplate["float64"]()
        copy.SetName(array.GetName())
        copy.SetNumberOfComponents(array.GetNumberOfComponents())
        copy.SetNumberOfTuples(2)
        for i in range(2):
            copy.SetTuple(i, array.GetTuple(i))
        assert not copy.HasStandardMemoryLayout()
        if array is apart.GetPoints().GetData():
            apart.GetPoints().SetData(copy)
        else:
            apart.GetPointData().AddArray(copy)
    for data, scale in ((mirrored, 1), (apart, 1), (integers, 0.1)):
        for scene, wanted in zip(scenes(data), plain):
            scene.mapper.SetScaleFactor(scale)
            scene.look(EYE, angle=ANGLE, parallel_scale=SCALE if scene.camera.GetParallelProjection() else None)
            assert (scene.ids() != wanted).mean() < 1e-4


def composite_data_of_every_kind():
    upper = points_of([(0, 1, 0)], Axes=[(0.2, 0.3, 0.4)], Orientation=[IDENTITY], Id=np.array([(2, 0, 255)], np.uint8))
    blocks, inner = vtkMultiBlockDataSet(), vtkMultiBlockDataSet()
    collection, parts = vtkPartitionedDataSetCollection(), vtkPartitionedDataSet()
    blocks.SetBlock(0, pair())
    blocks.SetBlock(2, points_of([]))
    inner.SetBlock(1, upper)
    blocks.SetBlock(3, inner)
    collection.SetPartition(0, 0, pair())
    collection.SetPartition(2, 1, upper)
    parts.SetPartition(0, pair())
    parts.SetPartition(2, upper)
    for data in (blocks, collection, parts):
        scene = next(scenes(data))
        assert shown(scene) == {0, 1, 2}, data.GetClassName()
        assert scene.mapper.GetBounds() == (-1.5, 1.5, -0.5, 1.3, -0.5, 0.5)
    for data in (vtkMultiBlockDataSet(), vtkPartitionedDataSetCollection(), vtkPartitionedDataSet()):
        scene = next(scenes(data))
        assert scene.colors().max() == 0 and scene.mapper.GetBounds() == (1, -1, 1, -1, 1, -1)
    # One block without the arrays is an error that names them; nothing is drawn.
    blocks.SetBlock(1, points_of([(0, 0, 0)]))
    scene, said = next(scenes(pair())), []
    scene.mapper.AddObserver("ErrorEvent", lambda caller, event: said.append(event))
    scene.mapper.SetInputDataObject(blocks)
    assert scene.colors().max() == 0 and len(said) == 1, "once, not for every picture"


def changes_within_data_are_seen():
    whole, blocks, block, inner = pair(), vtkMultiBlockDataSet(), pair(), vtkMultiBlockDataSet()
    inner.SetBlock(0, block)
    blocks.SetBlock(1, inner)
    for data, changed in ((whole, whole), (blocks, block)):
        scene = next(scenes(data))
        before = scene.ids()
        assert (scene.ids() == before).all()
        axes = changed.GetPointData().GetArray("Axes")
        axes.SetTuple(0, (0.1, 0.1, 0.1))
        axes.Modified()
        assert scene.mapper.GetBounds()[0] == -1.1, data.GetClassName()
        assert 0 < (scene.ids() == 0).sum() < (before == 0).sum() / 4, data.GetClassName()
        changed.GetPoints().SetPoint(0, -2, 0, 0)
        changed.GetPoints().Modified()
        assert scene.mapper.GetBounds()[0] == -2.1, data.GetClassName()
        changed.GetPointData().AddArray(ghosts_of((0, 2)))
        assert shown(scene) <= {0} and scene.mapper.GetBounds()[1] == -1.9, data.GetClassName()
        changed.Initialize()
        assert scene.colors().max() == 0, data.GetClassName()


def graphics_resources_are_released_and_made_again():
    data, other = pair(), vtkRenderWindow()
    fresh = mapper_of(data)
    for window in (other, None):
        fresh.ReleaseGraphicsResources(window)  # nothing has been drawn
    texture = texture_of(image_of(np.full((4, 4, 3), 90)))
    for textured in (False, True):
        scene = next(scenes(data))
        if textured:
            numbers = numpy_to_vtk(np.zeros(2), deep=True)
            numbers.SetName("Texture")
            data.GetPointData().AddArray(numbers)
            scene.mapper.AddTexture(texture)
        before = scene.colors()
        assert before.max() > 0
        for window in (scene.window, scene.window, other, None):
            scene.mapper.ReleaseGraphicsResources(window)
            scene.mapper.ReleaseGraphicsResources(window)
            assert (scene.colors() == before).all()
        scene.window.Finalize()
        scene.mapper.ReleaseGraphicsResources(scene.window)


def nothing_of_a_mapper_stays():
    data, left = pair(), [vtkWeakReference() for _ in range(4)]
    scene, blocks = next(scenes(data)), vtkCompositeDataDisplayAttributes()
    texture = texture_of(image_of(np.full((4, 4, 3), 90)))
    scene.mapper.AddTexture(texture)
    scene.mapper.SetCompositeDataDisplayAttributes(blocks)
    scene.colors()
    for each, of in zip(left, (scene.mapper, data, blocks, texture)):
        each.Set(of)
    scene.actor.SetMapper(None)
    scene.mapper = None
    del data, of, blocks, texture
    gc.collect()
    assert [each.Get() for each in left] == [None] * 4
    assert scene.colors().max() == 0


def selected(scene, field, x0, y0, x1, y1):
    """The ids that the hardware selector finds, by block."""
    selector = vtkHardwareSelector()
    selector.SetRenderer(scene.renderer)
    selector.SetArea(x0, y0, x1, y1)
    selector.SetFieldAssociation(field)
    selection, found = selector.Select(), {}
    for i in range(selection.GetNumberOfNodes()):
        node = selection.GetNode(i)
        assert node.GetProperties().Get(node.PROP()) is scene.actor
        block = node.GetProperties().Get(node.COMPOSITE_INDEX())
        found.setdefault(block, set()).update(vtk_to_numpy(node.GetSelectionList()).tolist())
    return found


def selection_finds_points_and_cells():
    data = crowd(300, 0.08)
    for scene in scenes(data):
        ids = scene.ids()
        x0, y0, x1, y1 = 100, 90, 160, 170
        expected = set(np.unique(ids[y0:y1 + 1, x0:x1 + 1])) - {-1}
        assert len(expected) > 20
        found = selected(scene, vtkDataObject.FIELD_ASSOCIATION_POINTS, x0, y0, x1, y1)
        assert set().union(*found.values()) == expected, (found, expected)
    # Cells in another order than the points.
    cells = vtkCellArray()
    for i in range(300):
        cells.InsertNextCell(1, [299 - i])
    data.SetVerts(cells)
    scene = next(scenes(data))
    expected = {299 - i for i in set(np.unique(scene.ids()[y0:y1 + 1, x0:x1 + 1])) - {-1}}
    found = selected(scene, vtkDataObject.FIELD_ASSOCIATION_CELLS, x0, y0, x1, y1)
    assert set().union(*found.values()) == expected
    picker = vtkPropPicker()
    y, x = np.argwhere(scene.ids() >= 0)[5000]
    assert picker.Pick(float(x), float(y), 0, scene.renderer) and picker.GetActor() is scene.actor
    depth = scene.depths()[y, x]
    away = np.array(scene.camera.GetDirectionOfProjection())
    assert abs(np.dot(np.array(picker.GetPickPosition()) - scene.camera.GetPosition(), away) - depth) < 1e-3


def blocks_are_drawn_and_told_apart():
    parts = [crowd(40, 0.15, seed=2), crowd(30, 0.15, seed=3)]
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, parts[0])
    blocks.SetBlock(2, parts[1])
    for i, part in enumerate(parts):
        levels = numpy_to_vtk(np.full(part.GetNumberOfPoints(), float(i)), deep=True)
        levels.SetName("Level")
        part.GetPointData().AddArray(levels)
    scene = next(scenes(blocks))
    alone = [next(scenes(part)) for part in parts]
    for each in alone:
        each.camera.DeepCopy(scene.camera)
    ids, depths = [each.ids() for each in alone], [each.depths() for each in alone]
    first = depths[0] < depths[1]
    assert (scene.ids() != np.where(first, *ids)).mean() < 1e-4
    found = selected(scene, vtkDataObject.FIELD_ASSOCIATION_POINTS, 60, 60, 200, 200)
    area = (slice(60, 201), slice(60, 201))
    assert found == {1: set(np.unique(ids[0][area][first[area]])) - {-1},
                     3: set(np.unique(ids[1][area][~first[area]])) - {-1}}
    # Scalars of each block have their own colors.
    scene.mapper.SetScalarModeToUsePointFieldData()
    scene.mapper.SelectColorArray("Level")
    scene.mapper.SetScalarRange(0, 1)
    scene.actor.GetProperty().LightingOff()
    colors = scene.colors()
    assert (colors[first][:, 0] == 255).all() and (colors[~first & np.isfinite(depths[1])][:, 2] == 255).all()


def blocks_have_looks():
    ball = {"Axes": [(0.4, 0.4, 0.4)], "Orientation": [IDENTITY]}
    inner, blocks = vtkMultiBlockDataSet(), vtkMultiBlockDataSet()
    for i, x in enumerate((-0.5, 0.5)):
        inner.SetBlock(i, points_of([(x, 0, 0)], **ball))
    blocks.SetBlock(0, inner)
    blocks.SetBlock(1, points_of([(1.5, 0, 0)], **ball))
    looks = vtkCompositeDataDisplayAttributes()
    scene = Scene(mapper_of(blocks, CompositeDataDisplayAttributes=looks), 150, 50)
    scene.look((0.5, 0, 5), (0.5, 0, 0), parallel_scale=0.5)
    scene.actor.GetProperty().LightingOff()
    scene.actor.GetProperty().SetColor(0, 0, 1)

    def seen():
        return [scene.colors()[25, x].tolist() for x in (25, 75, 125)]

    assert seen() == [[0, 0, 255]] * 3
    looks.SetBlockColor(inner, (1, 0, 0))
    looks.SetBlockColor(inner.GetBlock(1), (0, 1, 0))  # what is said of a block itself counts
    assert seen() == [[255, 0, 0], [0, 255, 0], [0, 0, 255]]
    looks.SetBlockVisibility(blocks, False)
    looks.SetBlockVisibility(inner.GetBlock(0), True)
    assert seen() == [[255, 0, 0], [0, 0, 0], [0, 0, 0]]
    assert np.allclose(scene.mapper.GetBounds(), (-0.9, -0.1, -0.4, 0.4, -0.4, 0.4))
    looks.SetBlockOpacity(inner, 0.5)
    assert abs(seen()[0][0] - 191) <= 1 and scene.mapper.HasTranslucentPolygonalGeometry()
    looks.RemoveBlockVisibilities()
    looks.RemoveBlockOpacities()
    scene.actor.GetProperty().SetColor(1, 1, 0)
    assert seen() == [[255, 0, 0], [0, 255, 0], [255, 255, 0]]


def scalars_of_cells():
    data = points_of([(-0.5, 0, 0), (0.5, 0, 0)], Axes=[(0.4, 0.4, 0.4)] * 2, Orientation=[IDENTITY] * 2)
    cells = vtkCellArray()
    for i in (1, 0):
        cells.InsertNextCell(1, [i])
    data.SetVerts(cells)
    colors = vtkUnsignedCharArray()
    colors.SetNumberOfComponents(3)
    colors.InsertNextTuple3(255, 0, 0)
    colors.InsertNextTuple3(0, 255, 0)
    data.GetCellData().SetScalars(colors)
    scene = Scene(mapper_of(data), 100, 100)
    scene.actor.GetProperty().LightingOff()
    scene.look((0, 0, 5), parallel_scale=1)
    assert scene.colors()[50, 25].tolist() == [0, 255, 0] and scene.colors()[50, 75].tolist() == [255, 0, 0]
    # Without scalars, the color of the material.
    scene.mapper.ScalarVisibilityOff()
    scene.actor.GetProperty().SetColor(0, 0, 1)
    assert scene.colors()[50, 25].tolist() == [0, 0, 255]
    # Both sides of what is transparent: 1 - (1 - 0.5)^2 of it.
    scene.actor.GetProperty().SetOpacity(0.5)
    assert abs(scene.colors()[50, 25][2] - 191) <= 1


def textures_are_those_of_the_geometry():
    picture = vtkImageData()
    picture.SetDimensions(64, 32, 1)
    u, v = np.meshgrid(np.arange(64) / 64, np.arange(32) / 32)
    texels = np.stack([128 + 100 * np.cos(2 * np.pi * u), 128 + 100 * np.sin(2 * np.pi * u), 40 + 200 * v], -1)
    scalars = numpy_to_vtk(texels.reshape(-1, 3).astype(np.uint8), deep=True)
    picture.GetPointData().SetScalars(scalars)
    data = crowd(8, 0.4, seed=5)
    geometry = anamorph.vtkAnamorphFigureGeometry()
    geometry.SetInputData(data)
    geometry.SetTolerance(1e-4)
    triangles = vtkPolyDataMapper()
    triangles.SetInputConnection(geometry.GetOutputPort())
    triangles.ScalarVisibilityOff()
    colors = []
    for mapper in (mapper_of(data), triangles):
        mapper.ScalarVisibilityOff()
        scene, texture = Scene(mapper, 256, 256), vtkTexture()
        texture.SetInputData(picture)
        texture.InterpolateOn()
        texture.RepeatOn()
        scene.actor.SetTexture(texture)
        scene.actor.GetProperty().LightingOff()
        scene.look(EYE, angle=ANGLE)
        colors.append(scene.colors())
    seen = (colors[0].sum(2) > 0) & (colors[1].sum(2) > 0)
    error = np.abs(colors[0] - colors[1])[seen].max(1)
    assert seen.mean() > 0.3 and np.quantile(error, 0.99) <= 6 and error.mean() < 1.5, (error.mean(), np.quantile(error, 0.99))


def image_of(colors):
    """A picture of rows from the bottom up."""
    picture = vtkImageData()
    picture.SetDimensions(colors.shape[1], colors.shape[0], 1)
    picture.GetPointData().SetScalars(numpy_to_vtk(colors.reshape(-1, colors.shape[2]).astype(np.uint8), deep=True))
    return picture


def texture_of(picture):
    texture = vtkTexture()
    texture.SetInputData(picture)
    texture.InterpolateOn()
    return texture


def waves(width, height, phase):
    """Three smooth patterns, which go around; none looks the same mirrored or turned."""
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    return image_of(np.stack([128 + 100 * np.cos(2 * np.pi * u + phase), 128 + 100 * np.sin(2 * np.pi * u + v),
                              40 + 200 * v * v], -1))


def bodies_with_textures():
    """Eight bodies, of which some have one of two textures, one has none and one a name that is not there."""
    data = crowd(8, 0.4, seed=5)
    names, numbers = vtkStringArray(), [0, 1, 0, 1, 0, 1, -1, 7]
    names.SetName("Texture")
    for number in numbers:
        names.InsertNextValue({0: "first", 1: "second", -1: ""}.get(number, "none"))
    data.GetPointData().AddArray(names)
    offsets = numpy_to_vtk(np.array([(0, 0), (0, 0), (9, 4), (30, -25), (-200, 0), (3, 45), (0, 0), (0, 0)], float), deep=True)
    offsets.SetName("TextureOffset")
    data.GetPointData().AddArray(offsets)
    return data, numbers


def textures_of_bodies_are_those_of_core():
    (data, numbers), pictures = bodies_with_textures(), {"first": waves(64, 32, 0), "second": waves(40, 48, 1)}
    numbered = numpy_to_vtk(np.array(numbers, np.int32), deep=True)
    numbered.SetName("Number")
    data.GetPointData().AddArray(numbered)
    for scene in scenes(data):
        mapper = scene.mapper
        light_as_core(scene)
        ids, reference = scene.ids(), core_picture(data, scene, Image.BODY_ID)
        mapper.SelectColorArray("Color")
        plain = scene.colors()
        for name, picture in pictures.items():
            mapper.AddTexture(texture_of(picture), name)
        assert mapper.GetNumberOfTextures() == 2
        for mapping in ("LATLONG", "MIRRORED", "LINEAR", "OCTAHEDRAL"):
            mapper.SetTextureMapping(getattr(mapper, mapping))
            image = anamorph.vtkAnamorphFigureImage()
            for name, picture in pictures.items():
                image.AddTexture(name, picture)
            exact = core_picture(data, scene, Image.SHADED, image=image, Lighting=Image.LAMBERT, Antialias=False,
                                 TextureMapping=getattr(Image, mapping))
            colors, same = scene.colors(), (ids == reference) & (ids >= 0)
            error = np.abs(colors - exact[..., :3]).max(2)
            # Where the square of a mapping ends, a texture has an edge: lines of pixels.
            assert error[same].mean() < 1 and np.quantile(error[same], 0.98) <= 2, (mapping, error[same].mean(),
                                                                                   np.quantile(error[same], 0.98))
            for body, number in enumerate(numbers):
                changed = (colors != plain).any(2)[same & (ids == body)]
                assert len(changed) > 20 and (changed.mean() > 0.9 if number in (0, 1) else not changed.any()), (body, number)
            mapper.SetTextureArray("Number")
            assert (scene.colors() == colors).all(), mapping
            mapper.SetTextureArray("Texture")
        # Selection does not see textures, and without them all is as before.
        found = selected(scene, vtkDataObject.FIELD_ASSOCIATION_POINTS, 100, 90, 160, 170)
        assert set().union(*found.values()) == set(np.unique(ids[90:171, 100:161])) - {-1}
        mapper.RemoveAllTextures()
        assert (scene.colors() == plain).all()


def a_body_shows_through_its_texture():
    ball = points_of([(0, 0, 0)], Axes=[(1.0, 1, 1)], Orientation=[IDENTITY], Texture=np.zeros(1))
    for texel, multiplied, wanted in (([200, 100, 40, 128], False, [100, 50, 147]), ([100, 50, 20, 128], True, [100, 50, 147]),
                                      ([90], False, [90, 90, 90]), ([90, 128], False, [45, 45, 172])):
        scene, texture = Scene(mapper_of(ball), 64, 64), texture_of(image_of(np.tile(texel, (4, 4, 1))))
        texture.SetPremultipliedAlpha(multiplied)
        scene.mapper.AddTexture(texture)
        scene.mapper.ScalarVisibilityOff()
        scene.actor.GetProperty().LightingOff()
        scene.actor.GetProperty().SetColor(0, 0, 1)
        scene.look((0, 0, 5), parallel_scale=1.2)
        assert np.abs(scene.colors()[32, 32] - wanted).max() <= 2, (texel, scene.colors()[32, 32])


def a_cell_picker_finds_what_is_seen():
    data = crowd(300, 0.08)
    cells = vtkCellArray()
    for i in range(300):
        cells.InsertNextCell(1, [299 - i])  # in another order than the points
    data.SetVerts(cells)
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(1, data)
    random = np.random.default_rng(3)
    for whole in (data, blocks):
        for scene in scenes(whole):
            scene.actor.SetPosition(0.2, 0.1, 0)
            scene.actor.RotateZ(20)
            scene.actor.SetScale(1.5, 1, 1)
            scene.renderer.ResetCameraClippingRange()
            ids, depths, picker = scene.ids(), scene.depths(), vtkCellPicker()
            scene.mapper.AddLocators(picker)
            picker.SetTolerance(0.2)  # bodies reach beyond the boxes of the blocks' points
            position, away = np.array(scene.camera.GetPosition()), np.array(scene.camera.GetDirectionOfProjection())
            for y, x in random.integers(0, 256, (200, 2)):
                found = picker.Pick(float(x), float(y), 0, scene.renderer)
                inner = ids[max(y - 1, 0):y + 2, max(x - 1, 0):x + 2]
                if (inner != ids[y, x]).any():
                    continue  # a limb: pickers look through the corner of a pixel
                assert bool(found) == (ids[y, x] >= 0), (x, y)
                if found:
                    assert (picker.GetPointId(), picker.GetCellId()) == (ids[y, x], 299 - ids[y, x])
                    assert picker.GetActor() is scene.actor
                    depth = np.dot(np.array(picker.GetPickPosition()) - position, away)
                    assert abs(depth - depths[y, x]) < 0.05, (depth, depths[y, x])


def a_mapper_draws_in_several_windows():
    mapper, first = mapper_of(crowd(40, 0.2)), None
    windows = [Scene(mapper, 64, 64), Scene(mapper, 64, 64)]
    for scene in (*windows, *windows):
        scene.look(EYE, angle=ANGLE)
        colors = scene.colors()
        first = colors if first is None else first
        assert (colors == first).all() and (colors > 0).any(2).mean() > 0.2
    del scene, windows[0]
    assert (windows[0].colors() == first).all()
    # Without an input, nothing.
    assert Scene(anamorph.vtkAnamorphEllipsoidMapper(), 64, 64).colors().max() == 0


def an_actor_moves_turns_and_scales_it():
    data = crowd(40, 0.2)
    scene = Scene(mapper_of(data), 256, 256)
    scene.actor.SetScale(2, 0.5, 1)
    scene.actor.RotateY(30)
    scene.actor.SetPosition(0.1, 0.2, 0.3)
    # The same bodies, moved: M R diag(a) of each is a general matrix.
    matrix = np.array([[scene.actor.GetMatrix().GetElement(i, j) for j in range(4)] for i in range(4)])
    centers, axes = (vtk_to_numpy(a) for a in (data.GetPoints().GetData(), data.GetPointData().GetArray("Axes")))
    own = turns_of(data) * axes[:, None, :]
    moved = points_of(centers @ matrix[:3, :3].T + matrix[:3, 3], Tensor=(matrix[:3, :3] @ own).reshape(-1, 9),
                      Id=vtk_to_numpy(data.GetPointData().GetArray("Id")))
    other = Scene(mapper_of(moved, TensorArray="Tensor", Shape=anamorph.vtkAnamorphEllipsoidMapper.TENSOR), 256, 256)
    for each in (scene, other):
        each.look(EYE, angle=ANGLE)
    assert (scene.ids() != other.ids()).mean() < 1e-4 and (scene.ids() >= 0).mean() > 0.2
    other.camera.DeepCopy(scene.camera)
    for each in (scene, other):
        each.mapper.ScalarVisibilityOff()
    assert np.quantile(np.abs(scene.colors() - other.colors()), 0.999) <= 1


ids_and_depths_are_those_of_core()
shading_is_that_of_core()
a_camera_within_and_a_plane_show_the_far_side()
needles_and_discs()
any_scale_and_any_origin()
tensors_are_axes()
points_without_an_ellipsoid_are_skipped_and_counted()
ghosts_are_neither_drawn_nor_met()
an_axis_may_be_negative_and_arrays_of_any_layout()
composite_data_of_every_kind()
changes_within_data_are_seen()
graphics_resources_are_released_and_made_again()
nothing_of_a_mapper_stays()
selection_finds_points_and_cells()
blocks_are_drawn_and_told_apart()
blocks_have_looks()
scalars_of_cells()
textures_are_those_of_the_geometry()
textures_of_bodies_are_those_of_core()
a_body_shows_through_its_texture()
a_cell_picker_finds_what_is_seen()
an_actor_moves_turns_and_scales_it()
a_mapper_draws_in_several_windows()
