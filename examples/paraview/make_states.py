# SPDX-License-Identifier: Apache-2.0
"""Makes the states in this folder that are not of panoramas, with the files that they read.

Usage, with the plugin's folder in PV_PLUGIN_PATH, after xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" where there is no screen:
    pvpython make_states.py OUT

Writes to the folder OUT, whose files the states name without a folder:
    bumps.pvsm           a ball deformed by a list of bumps, its second output above it: the table can be edited, bumps be dragged
    expressions.pvsm     blend shapes of expressions.glb, over time by the file's animation, and beside it a sum by weights of one's own
    splats.pvsm          the Gaussian splats of splats.ply as ellipsoids
    atoms.pvsm           the crystal of benzene.cif as ORTEP draws it: octants cut out of the ellipsoids of 50%
"""
import os
import shutil
import sys
import xml.etree.ElementTree as xml

import numpy as np
from paraview.simple import *

OUT = os.path.abspath(sys.argv[1])
os.makedirs(OUT, exist_ok=True)

# The vector of a bump, centre and extent in (u, v), kernel, on; the depth: centre, extent, side (1: the front, 2: the back, as seen along the vector).
LoadPlugin(os.environ["PV_PLUGIN_PATH"] + "/Anamorph.so", remote=False, ns=globals())
HEAD = [([0, 0.22, 0.30, 0.07, 0, 0.02, 0.07, 0, 1], [0, 0, 1]),
        ([0, 0.0, 0.08, 0.16, 0, -0.02, 0.16, 0, 1], [0, 0, 1]),
        ([0, -0.22, 0.20, 0.05, 0, 0, 0.05, 0, 1], [0, 0, 1]),
        ([-0.16, 0.10, 0.08, 0.06, 0, 0, -0.07, 0, 1], [0, 0, 2]),
        ([0.16, 0.10, 0.08, 0.06, 0, 0, -0.07, 0, 1], [0, 0, 2])]
# These move along the surface, whose front is not along their vectors: the depth says where they are.
NEAR = [0.45, 0.3, 0]
SMILE = [([-0.17, -0.21, 0.08, 0.08, 0, 0.13, 0.03, 0, 1], NEAR), ([0.17, -0.21, 0.08, 0.08, 0, 0.13, 0.03, 0, 1], NEAR)]
FROWN = [([0, 0.24, 0.12, 0.07, 0, -0.12, 0.08, 0, 1], NEAR), ([0, -0.24, 0.12, 0.05, 0, 0.05, 0.0, 0, 1], NEAR)]


def new_view():
    for proxy in [*GetSources().values(), *GetViews(), *GetLayouts().values()]:
        Delete(proxy)
    view = CreateRenderView()
    view.ViewSize = [640, 480]
    view.UseColorPaletteForBackground = 0
    view.Background = [0.13, 0.16, 0.21]
    view.OrientationAxesVisibility = 0
    return view


def look(view, position, focus=(0, 0, 0), angle=30):
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp, view.CameraViewAngle = position, focus, [0, 1, 0], angle


def is_default(group, kind, element):
    """Whether a state's property has the value that a new proxy has."""
    prototype = servermanager.ProxyManager().GetPrototypeProxy(group, kind)
    known = prototype and prototype.GetProperty(element.get("name"))
    if not known or not hasattr(known, "GetElement") or element.find("Proxy") is not None:
        return False

    def number(text):
        try:
            return float(text)
        except ValueError:
            return text

    values = [number(e.get("value")) for e in element.findall("Element")]
    return values == [number(str(known.GetElement(i))) for i in range(known.GetNumberOfElements())]


def save(name):
    """The state, with the names of its files as they are in OUT, without what a new proxy has anyway, and what nothing uses."""
    path = f"{OUT}/{name}.pvsm"
    SaveState(path)
    tree = xml.parse(path)
    state = tree.getroot().find("ServerManagerState")
    for proxy in state.findall("Proxy"):
        for element in proxy.findall("Property"):
            if is_default(proxy.get("group"), proxy.get("type"), element):
                proxy.remove(element)
            for domain in element.findall("Domain"):
                element.remove(domain)
    for unused in ("settings", "animation_writers"):
        for proxy in state.findall("Proxy"):
            if proxy.get("group") == unused:
                state.remove(proxy)
    text = xml.tostring(tree.getroot(), encoding="unicode")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(OUT + "/", "") + "\n")


def skin(display, color=(0.93, 0.76, 0.62)):
    display.ColorArrayName = ["POINTS", ""]
    display.DiffuseColor = display.AmbientColor = color
    display.Specular = 0.2


def deformed(name, source, bumps):
    source.UpdatePipeline()
    return AnamorphDeform(registrationName=name, Input=source, AutomaticPlane=0, Deformations=sum((b for b, _ in bumps), []),
                          Depths=sum((d for _, d in bumps), []))


def head():
    return Sphere(registrationName="ball", Radius=0.5, ThetaResolution=96, PhiResolution=72)


view = new_view()
bumps = deformed("face", head(), HEAD)
bumps.Names = ["brow", "nose", "mouth", "left eye", "right eye"]
bumps.GenerateOverlay = 1
skin(Show(bumps, view))
lines = Show(OutputPort(bumps, 1), view)
lines.LineWidth = 2
look(view, [1.2, 0.35, 2.2])
save("bumps")

view = new_view()
ball = head()
face = deformed("face", ball, HEAD)
shapes = GroupDatasets(Input=[face, deformed("smile", ball, HEAD + SMILE), deformed("frown", ball, HEAD + FROWN)])
shapes.BlockNames = ["face", "smile", "frown"]
SaveData(OUT + "/expressions.glb", proxy=shapes, Keys=[0, 1, 0, 1, 1, 1, 2, 1, 0, 2, 2, 0, 3, 2, 1.2, 4, 2, 0])
view = new_view()
reader = AnamorphBlendShapeReader(registrationName="expressions.glb", FileName=[OUT + "/expressions.glb"])
skin(Show(reader, view))
beside = []
for name in ("face", "smile", "frown"):
    block = ExtractBlock(registrationName=name, Input=OutputPort(reader, 1), Selectors=["/Root/" + ("base" if name == "face" else name)])
    beside.append(block)
own = AnamorphInbetween(registrationName="own weights", Input=beside, Mode="Base and deltas", Weights=[0, 1.0, 0.8])
moved = Transform(registrationName="beside", Input=own)
moved.Transform.Translate = [1.15, 0, 0]
skin(Show(moved, view), (0.80, 0.84, 0.93))
look(view, [0.57, 0.15, 3.4], [0.57, 0, 0])
GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
GetAnimationScene().AnimationTime = 1
save("expressions")

# A knotted ribbon of splats: axes in standard deviations along, across and through it.
random = np.random.default_rng(1)
t = random.uniform(0, 2 * np.pi, 4000)


def knot(t):
    r = 2 + np.cos(3 * t)
    return np.stack([r * np.cos(2 * t), r * np.sin(2 * t), np.sin(3 * t)], -1)


along = knot(t + 1e-4) - knot(t - 1e-4)
along /= np.linalg.norm(along, axis=1, keepdims=True)
points = knot(t) + 0.16 * random.normal(size=(len(t), 3))
middle = np.array([1.0, 0, 0]) + along  # a turn by pi about the middle of x and the way takes one to the other
turn = np.concatenate([np.zeros((len(t), 1)), middle / np.linalg.norm(middle, axis=1, keepdims=True)], 1)
colors = 0.5 + 0.5 * np.cos(t[:, None] + np.array([0, 2.1, 4.2]))
HARMONIC = 1 / (2 * np.sqrt(np.pi))
splats = np.concatenate([points, (colors - 0.5) / HARMONIC, np.full((len(t), 1), 8.0), np.log(random.uniform(0.5, 1, (len(t), 3)) * [0.12, 0.03, 0.03]),
                         turn], 1).astype("<f4")
NAMES = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
with open(OUT + "/splats.ply", "wb") as file:
    file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(t)}\n" + "".join(f"property float {name}\n" for name in NAMES)
                + "end_header\n").encode() + splats.tobytes())
view = new_view()
cloud = AnamorphSplatReader(registrationName="splats.ply", FileName=OUT + "/splats.ply")
shown = Show(cloud, view)
shown.SetRepresentationType("Ellipsoids")
shown.MapScalars = 0
look(view, [0, 0, 13])
save("splats")

view = new_view()
source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "figures", "benzene.cif")
shutil.copyfile(source, OUT + "/benzene.cif")
atoms = AnamorphFigureReader(registrationName="benzene.cif", FileName=OUT + "/benzene.cif", Joints=1)
atoms.UpdatePipeline()
shown = Show(atoms, view)
shown.SetRepresentationType("Ellipsoids")
shown.EllipsoidStyle = "Octant"
bonds = Tube(registrationName="bonds", Input=atoms, Radius=6, NumberofSides=12)
skin(Show(bonds, view), (0.8, 0.8, 0.8))
shown.MapScalars = 0
Render(view)
middle, size = np.array(atoms.GetDataInformation().GetBounds()).reshape(3, 2).mean(1), 900
look(view, list(middle + 2.9 * size * np.array([0.25, 0.35, 0.9])), list(middle), 20)
save("atoms")
