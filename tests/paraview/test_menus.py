# SPDX-License-Identifier: Apache-2.0
"""Files of figures are shown as ellipsoids at once; filters of figures are offered where there are figures; lists of rows tell when
their last row is not whole; the plugin speaks of all that it has."""
import os
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os

from paraview import servermanager, simple
from paraview.simple import *
from paraview.vtk.vtkCommonCore import VTK_STRING
from paraview.vtk.util.misc import calldata_type

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
with open("figure.nudes", "w") as file:
    file.write("figure f 1 a\nellipsoid a 5 8 4\nrepeat 0 2 moveto f a 500 500 300\nstop\n")
with open("walk.bvh", "w") as file:
    file.write("HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 10 0\n}\n}\n"
               "MOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n")
figures = []
for name in ("figure.nudes", "walk.bvh", os.environ["ANAMORPH_SOURCE_DIR"] + "/examples/figures/benzene.cif"):
    figures.append(OpenDataFile(os.path.abspath(name)))
    view = CreateRenderView()
    shown = Show(figures[-1], view)
    assert shown.Representation == "Ellipsoids", (name, shown.Representation)
    Render(view)
    assert shown.SMProxy.GetProperty("EllipsoidAxes") is None or shown.EllipsoidAxes, name


def offered(name, source):
    """As menus find out, with a proxy that is none of the pipeline's."""
    inputs = servermanager.ProxyManager().GetPrototypeProxy("filters", name).GetProperty("Input")
    inputs.RemoveAllUncheckedProxies()
    inputs.AddUncheckedInputConnection(source.SMProxy, 0)
    try:
        return bool(inputs.IsInDomains())
    finally:
        inputs.RemoveAllUncheckedProxies()


def missing(name, source):
    """The kind of the first domain in which a source is not, of which a menu makes the words why a filter is not offered."""
    inputs = servermanager.ProxyManager().GetPrototypeProxy("filters", name).GetProperty("Input")
    inputs.RemoveAllUncheckedProxies()
    inputs.AddUncheckedInputConnection(source.SMProxy, 0)
    domains = inputs.NewDomainIterator()
    domains.Begin()
    while domains.GetDomain().IsInDomain(inputs):
        domains.Next()
    inputs.RemoveAllUncheckedProxies()
    return domains.GetDomain().GetClassName()


# A sphere has an array of three components, its normals, and none of axes; an array of that name has to have three.
sphere = Sphere()
numbers = Calculator(Input=sphere, ResultArrayName="Axes", Function="coordsX")
vectors = Calculator(Input=sphere, ResultArrayName="Axes", Function="coords + iHat")
for source in (sphere, numbers, vectors):
    source.UpdatePipeline()
for name in ("AnamorphFigureGeometry", "AnamorphFigureOutline", "AnamorphFigureImage", "AnamorphFigureSkeleton"):
    assert [offered(name, source) for source in (sphere, numbers, vectors)] == [False, False, True], name
    assert all(offered(name, source) for source in figures), name
    # An array of three components there is: no menu may say that it is missing.
    assert missing(name, sphere) == "vtkSMAnamorphArrayDomain", (name, missing(name, sphere))


# What moves points takes grids whose points are implied, and blocks and levels of them; trees of cells are greyed out.
wavelet = Wavelet(WholeExtent=[-4, 4, -4, 4, -2, 2])
levels, trees, table = HierarchicalFractal(MaximumLevel=2), HyperTreeGridRandom(), ProgrammableSource(OutputDataSetType="vtkTable")
blocks = GroupDatasets(Input=[wavelet, sphere])
for source in (wavelet, blocks, levels, trees, table):
    source.UpdatePipeline()
for name in ("AnamorphDeform", "AnamorphInbetween"):
    allowed = [offered(name, source) for source in (sphere, wavelet, blocks, levels, trees, table)]
    assert allowed == [True, True, True, True, False, False], (name, allowed)
warped = simple.AnamorphDeform(Input=wavelet)
warped.UpdatePipeline()
kind = warped.GetDataInformation().GetDataSetTypeAsString()
assert kind == "vtkStructuredGrid" and warped.GetDataInformation().GetNumberOfPoints() == 9 * 9 * 5, kind
assert warped.PointData["RTData"], "the array of the grid is lost"
warped = simple.AnamorphDeform(Input=levels)
warped.UpdatePipeline()
assert warped.GetDataInformation().GetNumberOfPoints() == levels.GetDataInformation().GetNumberOfPoints() > 0

# What is made while a second output is the active one is of that, and so is a first bump.
thrown = simple.AnamorphPanoramaProjection(Input=sphere, Position=[1.5, 0, 0], Direction=[-1, 0, 0], PanoramaWidth=256, PanoramaHeight=128, Tolerance=2)
thrown.UpdatePipeline()
rest = thrown.SMProxy.GetOutputPort(1)
active = servermanager.ProxyManager().GetSelectionModel("ActiveSources")
for name in ("AnamorphDeform", "AnamorphInbetween", "AnamorphPanoramaProjection"):
    active.Select(rest, active.CLEAR_AND_SELECT)
    active.SetCurrentProxy(rest, active.CLEAR_AND_SELECT)
    made = getattr(simple, name)()
    made.UpdatePipeline()
    given = made.SMProxy.GetProperty("Input")
    assert given.GetProxy(0).GetXMLName() == "AnamorphPanoramaProjection" and given.GetOutputPortForConnection(0) == 1, name
    if name == "AnamorphDeform":
        # The far half of a ball: in the middle of its plane lies one sheet, which the panorama has not reached.
        assert list(made.Bumps[:2]) == [0, 0] and made.Bumps[6] > 0.1, list(made.Bumps)
    Delete(made)

# Pictures have one slice: filters of them are greyed out for volumes.
slice_, ball = Wavelet(WholeExtent=[0, 9, 0, 9, 0, 0]), simple.Sphere()
for source in (slice_, ball):
    source.UpdatePipeline()
for name in ("AnamorphRelief", "AnamorphDrape", "AnamorphPanoramaView", "AnamorphImageWarp", "AnamorphImageMorph"):
    allowed = [offered(name, source) for source in (slice_, wavelet, ball)]
    assert allowed == [True, False, False], (name, allowed)
    assert missing(name, wavelet) == "vtkSMAnamorphSliceDomain", (name, missing(name, wavelet))
for name in ("AnamorphFigureGeometry", "AnamorphNonlinearTexture", "AnamorphProjectionBake"):
    assert missing(name, wavelet) == "vtkSMDataTypeDomain", (name, missing(name, wavelet))
for name in ("AnamorphNonlinearTexture", "AnamorphProjectionBake"):
    assert missing(name, ball) == "vtkSMAnamorphArrayDomain", (name, missing(name, ball))


def errors_of(filter, **values):
    told = []

    @calldata_type(VTK_STRING)
    def tell(caller, event, text):
        told.append(text)

    tag = filter.SMProxy.AddObserver("ErrorEvent", tell)
    for name, value in values.items():
        setattr(filter, name, value)
    filter.SMProxy.UpdateVTKObjects()
    filter.SMProxy.RemoveObserver(tag)
    return told


picture = Wavelet(WholeExtent=[0, 9, 0, 9, 0, 0])
lists = [(simple.AnamorphDeform(Input=sphere), "Deformations", 9), (simple.AnamorphDeform(Input=sphere), "Bumps", 19),
         (simple.AnamorphDeformImage(Input=wavelet), "Deformations", 9), (simple.AnamorphInbetween(Input=[sphere]), "Keys", 3),
         (simple.AnamorphDrape(Input=picture), "Lights", 3), (simple.AnamorphProjectionBake(Input=sphere, Panoramas=[picture]), "Projectors", 9)]
for filter, name, row in lists:
    for count in (row - 1, 2 * row + 1):
        told = errors_of(filter, **{name: [1] * count})
        assert len(told) == 1, (name, count, told)
        for words in (f"{name} has {count} numbers", f"must be rows of {row}", f"the last {count % row} are dropped"):
            assert words in told[0], (words, told)
    for count in (row, 3 * row):
        assert errors_of(filter, **{name: [1] * count}) == [], (name, count)

shown = Show(sphere, CreateRenderView())
shown.SetRepresentationType("Panorama")
assert shown.PanoramaShadows == "Map", shown.PanoramaShadows
for mode in ("Rays", "Rays in stills"):
    shown.PanoramaShadows = mode
    Render()
print("done")
'''

with open("menus.py", "w") as file:
    file.write(SCRIPT)
done = subprocess.run([*xvfb_run(381), "pvpython", "menus.py"], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
                      capture_output=True, text=True)
assert done.returncode == 0 and "done" in done.stdout, done.stdout + done.stderr
with open(os.environ["ANAMORPH_SOURCE_DIR"] + "/plugins/paraview/anamorph/paraview.plugin") as file:
    described = file.read()
assert all(paper in described for paper in ("Oka et al. 1987", "Chapman 1986", "Kim 2003")), described
