# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""A script opens by its ending, plays as an animation, and survives a state file."""
import os

from paraview import servermanager, simple
from paraview.simple import Delete, FindSource, GetAnimationScene, LoadPlugin, LoadState, OpenDataFile, SaveState

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))


def centers(source):
    points = servermanager.Fetch(source)
    return [points.GetPoint(i) for i in range(points.GetNumberOfPoints())]


for name in ("ball.nudes", "ball.n"):
    with open(name, "w") as file:
        file.write("figure f 1 ball\nellipsoid ball 10 20 30\nlinear 0 8 moveby f ball 80 0 -40\nstop")
    ball = OpenDataFile(os.path.abspath(name))
    assert ball.GetXMLName() == "AnamorphFigureReader", ball.GetXMLName()
    assert list(ball.TimestepValues) == [1, 2, 3, 4, 5, 6, 7, 8]

for time, x in ((3, 30), (8, 80), (0, 10), (5.5, 50)):
    ball.UpdatePipeline(time)
    assert centers(ball) == [(x, 0, x / 2)], (time, centers(ball))

scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
assert (scene.StartTime, scene.EndTime) == (1, 8)

surface = simple.AnamorphFigureGeometry(Input=ball, Tolerance=0.5)
outline = simple.AnamorphFigureOutline(Input=ball, Hidden="Kept")
sticks = simple.AnamorphFigureSkeleton(Input=ball, LevelOfDetail=2)
for source in (surface, outline, sticks):
    source.UpdatePipeline(2)
    assert source.GetDataInformation().GetNumberOfCells() > 0
assert abs(surface.GetDataInformation().GetBounds()[3] - 20) < 1e-5
simple.RenameSource("sticks", sticks)
ball.Joints = 1
SaveState("figures.pvsm")
for source in (surface, outline, sticks, ball):
    Delete(source)
LoadState("figures.pvsm")
restored = FindSource("sticks")
assert restored.LevelOfDetail == 2
assert restored.Input.Joints == 1
restored.UpdatePipeline(4)
assert abs(restored.GetDataInformation().GetBounds()[0] - 40) < 1e-9
