# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphEllipsoidMapper without the bodies that others hide draws the same colors and depths as with all of them: dense and sparse
crowds, needles and discs, in perspective and in parallel, from afar and from between them, moved, in a part of a window, and beside other
things. Most of a crowd is left out; what is seen through is not. Needs a display."""
import sys

import numpy as np
from ellipsoid_scene import Scene, crowd, points_of
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

import anamorph

Mapper = anamorph.vtkAnamorphEllipsoidMapper
IDENTITY = (1.0, 0, 0, 0)


def mapper_of(data, **settings):
    mapper = Mapper()
    mapper.SetInputData(data)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("Color")
    for name, value in settings.items():
        getattr(mapper, "Set" + name)(value)
    return mapper


def drawn(scene, how):
    """Colors, depths, and how many bodies were drawn for them."""
    scene.mapper.SetOcclusionCulling(how)
    colors, depths = scene.colors(), scene.depths()
    return colors, depths, scene.mapper.GetNumberOfDrawnBodies()


def most_left_out(scene, what):
    """The share of the bodies that is left out; the pictures have to be the same."""
    every, culled = drawn(scene, Mapper.NEVER), drawn(scene, Mapper.ALWAYS)
    different = (every[0] != culled[0]).any(2) | (every[1] != culled[1])
    assert not different.any(), (what, int(different.sum()), "pixels differ", culled[2], every[2])
    return 1 - culled[2] / every[2]


def crowds(rounds, seed):
    random = np.random.default_rng(seed)
    for i in range(rounds):
        count, aspect = int(10 ** random.uniform(1, 4.3)), random.choice([1.0, 3, 30, 1000])
        data = crowd(count, 10 ** random.uniform(-2.7, -0.7), aspect, seed=int(random.integers(1 << 30)))
        scene = Scene(mapper_of(data), int(random.integers(30, 400)), int(random.integers(30, 400)))
        scene.window.SetMultiSamples(int(random.choice([0, 0, 4])))
        if random.random() < 0.3:
            scene.renderer.SetViewport(0.2, 0.1, 0.9, 0.7)
        if random.random() < 0.3:
            scene.actor.SetPosition(*random.uniform(-1, 1, 3))
            scene.actor.SetScale(*random.uniform(0.3, 2, 3))
            scene.actor.RotateWXYZ(random.uniform(0, 360), *random.normal(size=3))
        eye = random.normal(size=3)
        eye *= 10 ** random.uniform(-0.5, 2) / np.linalg.norm(eye)
        parallel = 10 ** random.uniform(-2, 0.3) if random.random() < 0.4 else None
        scene.look(eye, random.uniform(-0.5, 0.5, 3), angle=random.uniform(1, 120), parallel_scale=parallel)
        share = most_left_out(scene, (seed, i))
        yield share, scene


def pictures_are_the_same(rounds, seed):
    shares = [share for share, _ in crowds(rounds, seed)]
    assert np.mean(np.array(shares) > 0.3) > 0.3, shares


def most_of_a_crowd_is_left_out():
    scene = Scene(mapper_of(crowd(100000, 0.015)), 256, 256)
    scene.look((1.2, 1, 4.5))
    assert most_left_out(scene, "crowd") > 0.9
    # From between them all are drawn; those that are beside the picture, none.
    scene.look((0, 0, 0), (0, 0, -1))
    scene.camera.SetClippingRange(0.01, 10)
    assert most_left_out(scene, "within") == 0
    sparse = Scene(mapper_of(crowd(1000, 0.002, 1)), 256, 256)
    sparse.look((0, 0, 50), (0.5, 0, 0), parallel_scale=0.5)
    centers = np.array([sparse.mapper.GetInput().GetPoint(i) for i in range(1000)])
    outside = (np.abs(centers[:, 0] - 0.5) > 0.51) | (np.abs(centers[:, 1]) > 0.51)
    assert most_left_out(sparse, "beside") >= outside.mean() > 0.4


def a_body_hides_another_only_if_it_covers_it():
    """A small ball behind a large one, which comes out on a side; and one before it."""
    for x, hidden in ((0, True), (0.7, True), (0.88, False), (1.1, False)):
        data = points_of([(0, 0, 0), (x, 0, -1)], Axes=[(1.0, 1, 1), (0.2, 0.2, 0.2)], Orientation=[IDENTITY] * 2,
                         Color=np.array([(255, 0, 0), (0, 255, 0)], np.uint8))
        scene = Scene(mapper_of(data), 256, 256)
        scene.look((0, 0, 50), parallel_scale=1.5)
        colors, _, count = drawn(scene, Mapper.ALWAYS)
        assert (count == 1) == hidden and ((colors[..., 1] > 20).any()) != hidden, (x, count)
    scene.look((0, 0, -50), parallel_scale=1.5)
    assert drawn(scene, Mapper.ALWAYS)[2] == 2


def what_is_seen_through_is_drawn():
    data = crowd(3000, 0.06)
    scene = Scene(mapper_of(data), 128, 128)
    scene.look((1.2, 1, 4.5))
    opaque = most_left_out(scene, "opaque")
    assert opaque > 0.5
    scene.actor.GetProperty().SetOpacity(0.5)
    assert most_left_out(scene, "opacity") == 0
    scene.actor.GetProperty().SetOpacity(1)
    scene.mapper.SetStyle(Mapper.OCTANT)
    assert most_left_out(scene, "octants") == 0
    scene.mapper.SetStyle(Mapper.PRINCIPAL_ELLIPSES)
    assert most_left_out(scene, "ellipses") > 0.5
    plane = vtkPlane()
    plane.SetNormal(-1, 0, 0)
    scene.mapper.AddClippingPlane(plane)
    assert most_left_out(scene, "a plane") == 0
    scene.mapper.RemoveAllClippingPlanes()
    # Where they change, so does what is drawn.
    scene.mapper.SetScaleFactor(0.5)
    assert most_left_out(scene, "smaller") < opaque - 0.1
    scene.mapper.SetScaleFactor(1)
    # Something else stands among them.
    source, mapper, other = vtkPlaneSource(), vtkPolyDataMapper(), vtkActor()
    source.SetOrigin(-2, -2, 0.3)
    source.SetPoint1(2, -2, 0.3)
    source.SetPoint2(-2, 2, 0.3)
    mapper.SetInputConnection(source.GetOutputPort())
    other.SetMapper(mapper)
    scene.renderer.AddActor(other)
    assert most_left_out(scene, "a wall") > 0.5
    # An interactor that asks for frames has all that is not hidden, if they are no more than it draws at most.
    scene.window.SetDesiredUpdateRate(15)
    scene.mapper.SetInteractiveBodies(2000)
    assert most_left_out_of(scene) == drawn(scene, Mapper.ALWAYS)[2]
    scene.mapper.SetInteractiveBodies(100)
    assert drawn(scene, Mapper.ALWAYS)[2] == 100


def most_left_out_of(scene):
    scene.window.SetDesiredUpdateRate(0.01)
    count = drawn(scene, Mapper.ALWAYS)[2]
    scene.window.SetDesiredUpdateRate(15)
    return count


def automatic_is_for_many_in_software():
    few, many = (Scene(mapper_of(crowd(count, 0.03)), 64, 64) for count in (19000, 21000))
    for scene in (few, many):
        scene.look((1.2, 1, 4.5))
    many.window.Render()
    software = "llvmpipe" in many.window.ReportCapabilities()
    assert drawn(few, Mapper.AUTOMATIC)[2] == 19000
    assert (drawn(many, Mapper.AUTOMATIC)[2] < 10000) == software


pictures_are_the_same(int(sys.argv[1]) if len(sys.argv) > 1 else 12, int(sys.argv[2]) if len(sys.argv) > 2 else 1)
most_of_a_crowd_is_left_out()
a_body_hides_another_only_if_it_covers_it()
what_is_seen_through_is_drawn()
automatic_is_for_many_in_software()
