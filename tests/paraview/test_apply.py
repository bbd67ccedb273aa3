# SPDX-License-Identifier: Apache-2.0
"""What Apply shows of every filter on a sphere, a plane, a wavelet and a slice of it, all left as they are when they are made: something that is there, finite and seen, without an error;
or the filter is not offered for such data, and says in words what it wants."""
import glob
import os
import subprocess
import xml.etree.ElementTree as xml

from display import xvfb_run

SCRIPT = r'''
import os
import sys

import numpy as np
from paraview import servermanager, simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
GREYED = {filter: set(sources.split(",")) for filter, sources in (entry.split(":") for entry in os.environ["GREYED"].split())}


def offered(name, source):
    inputs = servermanager.ProxyManager().GetPrototypeProxy("filters", name).GetProperty("Input")
    inputs.RemoveAllUncheckedProxies()
    inputs.AddUncheckedInputConnection(source.SMProxy, 0)
    try:
        return bool(inputs.IsInDomains())
    finally:
        inputs.RemoveAllUncheckedProxies()


def seen(view):
    SaveScreenshot("seen.png", view, ImageResolution=[160, 120])
    reader = vtkPNGReader()
    reader.SetFileName("seen.png")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


for kind in ("Sphere", "Plane", "Wavelet", "Slice"):
    for name in sys.argv[1:]:
        source = getattr(simple, kind)() if kind != "Slice" else Wavelet(WholeExtent=[-10, 10, -10, 10, 0, 0])
        source.UpdatePipeline()
        wanted = kind not in GREYED.get(name, ())
        assert offered(name, source) == wanted, (name, kind, "is offered" if not wanted else "is not offered")
        if wanted:
            print(f"# {name} on {kind}", file=sys.stderr, flush=True)
            # The window asks for a second input, which these cannot do without.
            seconds = {"AnamorphProjectionBake": lambda: {"Panoramas": Wavelet(WholeExtent=[0, 63, 0, 31, 0, 0])},
                       "AnamorphImageMorph": lambda: {"Other": Wavelet(WholeExtent=[0, 20, 0, 20, 0, 0], Maximum=100)},
                       "AnamorphImageWarp": lambda: {"Mesh": Plane(Origin=[-10, -10, 0], Point1=[10, -10, 0], Point2=[-10, 10, 0])}}
            more = seconds.get(name, dict)()
            filter = getattr(simple, name)(Input=source, **more)
            view = CreateRenderView()
            view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 0, 0], 0
            shown = Show(filter, view)
            bounds = np.array(filter.GetDataInformation().GetBounds())
            assert np.isfinite(bounds).all() and (bounds[1::2] - bounds[::2]).max() > 0, (name, kind, bounds)
            ResetCamera(view)
            pixels = seen(view)
            assert (pixels.sum(1) > 30).mean() > 0.02, (name, kind, "shows nothing")
            if name == "AnamorphRelief":  # a tenth of its plane high, whatever the numbers are
                assert abs(bounds[5] - bounds[4] - 0.1) < 1e-5, bounds
            print("shown", name, kind, shown.Representation, [round(x, 3) for x in bounds])
            Delete(filter)
            Delete(view)
        Delete(source)
print("every one")
'''

# Filters of figures want the array Axes, those of pictures an image, and textures are baked or laid on a mesh with texture coordinates.
GREYED = {name: "Sphere,Plane,Wavelet,Slice" for name in ("AnamorphFigureGeometry", "AnamorphFigureOutline", "AnamorphFigureSkeleton", "AnamorphFigureImage")}
GREYED.update({name: "Sphere,Plane,Wavelet" for name in ("AnamorphRelief", "AnamorphDrape", "AnamorphPanoramaView", "AnamorphImageMorph", "AnamorphImageWarp")})
GREYED.update({"AnamorphDeformImage": "Sphere,Plane", "AnamorphProjectionBake": "Sphere,Wavelet,Slice",
               "AnamorphNonlinearTexture": "Sphere,Wavelet,Slice"})
folders = [os.environ[place] + "/plugins/paraview/anamorph/*.xml" for place in ("ANAMORPH_SOURCE_DIR", "ANAMORPH_BUILD_DIR")]
filters = [element.get("name") for path in sorted(p for f in folders for p in glob.glob(f)) for group in xml.parse(path).getroot().iter("ProxyGroup")
           if group.get("name") == "filters" for element in group if element.tag.endswith("Proxy")]
assert len(filters) >= 12, filters
with open("apply.py", "w") as file:
    file.write(SCRIPT)
done = subprocess.run([*xvfb_run(377), "pvpython", "apply.py", *filters], capture_output=True, text=True, timeout=280,
                      env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "GREYED": " ".join(f"{k}:{v}" for k, v in GREYED.items())})
assert done.returncode == 0 and "every one" in done.stdout, (done.stdout[-3000:], done.stderr[-3000:])
print(done.stdout)
assert "ERR" not in done.stderr and "rror" not in done.stderr, done.stderr[-5000:]
