# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""Every proxy of the plugin can be made; every property is documented, has the default of the C++ class and the range that
it takes, both those of the core's rows of numbers where it has one; every parameter of a class is a property."""
import contextlib
import glob
import os
import re
import sqlite3
import subprocess
import xml.etree.ElementTree as xml

import anamorph
import surfaces
from paraview import servermanager
from paraview.simple import LoadPlugin
from paraview.vtk.vtkFiltersSources import vtkPlaneSource
from paraview.vtk.vtkImagingCore import vtkRTAnalyticSource

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
PAPERS = ("Oka 1987", "Chapman 1986", "Kim 2003")
# What a panel has no use for: other ways to set the same, and what the host sets.
NO_PROPERTY = {
    "vtkAnamorphBlendShapeReader": {"SetFileName"},  # AddFileName() takes several
    "vtkAnamorphDrape": {"SetBlendWeight", "SetPositionsConnection", "SetHeightConnection", "SetDeformationsConnection", "SetBackConnection"},
    "vtkAnamorphFigureImage": {"SetBumpConnection"},
    "vtkAnamorphDeform": {"SetController", "SetDeformationList", "SetDeformationEnabled", "SetTableConnection",
                          "SetOrientation", "SetMirror", "SetDeformationName"},  # Frames and Names have them
    "vtkAnamorphDeformImage": {"SetDeformationList"},
    "vtkAnamorphImageMorph": {"SetOtherConnection", "SetLinesConnection", "SetOtherLinesConnection"},
    "vtkAnamorphImageWarp": {"SetMeshConnection"},
    "vtkAnamorphInbetween": {"SetKey"},
    "vtkAnamorphPanoramaProjection": {"SetController", "SetTimeBudget"},  # the proxy gives it time
    "vtkAnamorphProjectionBake": {"SetController"},
    "vtkAnamorphReliefSource": {"SetSize"},
}
# The core's rows of numbers, by name. Properties have the name of their row but for these.
ROW_OF = {("vtkAnamorphFigureGeometry", "Tolerance"): "surface_tol", ("vtkAnamorphFigureOutline", "Tolerance"): "outline_tol",
          ("vtkAnamorphFigureSkeleton", "Tolerance"): "sphere_tol",
          ("vtkAnamorphFigureImage", "OutlineTolerance"): "figure_outline_tol",
          ("vtkAnamorphPanoramaProjection", "Tolerance"): "projection_tol",
          ("vtkAnamorphNonlinearTexture", "Tolerance"): "texture_tol",
          ("vtkAnamorphDrape", "Tolerance"): "drape_tol",
          ("vtkAnamorphDrape", "CameraParallelScale"): "drape_parallel_scale"}
# Classes whose properties are an operation's parameters, under the same names.
OPERATION_OF = {"vtkAnamorphDrape": "drape", "vtkAnamorphFigureImage": "figure"}
# Parameters of those that are no property, as VTK has its own words for them, or does without.
NOT_OFFERED = {"drape_data_filter", "drape_fov", "drape_scale", "drape_view", "drape_wrap", "drape_output"}
# Numbers that the panel has in a table, where they have no range of their own.
IN_TABLES = {"extent"}
# What depends on the input is refused when the filter executes; the least value is in the XML all the same.
LEAST_ALONE = {"SelectedDeformation": 0, "BaseIndex": 0, "Resolution": 0}
# Setters that count as another class does.
NAMED_BY = {(name, "SetProjection"): "vtkAnamorphPanoramaProjection"
            for name in ("vtkAnamorphProjectionBake", "vtkAnamorphPanoramaView")}
# Proxies with fewer numbers than others: of these defaults, ends of ranges, and parameters.
FEW = {"AnamorphBlendShapeReader": (2, 1, 4), "AnamorphBlendShapeWriter": (3, 2, 6), "AnamorphNonlinearTexture": (3, 3, 3),
       "AnamorphSplatReader": (0, 0, 1)}
# Entries of menus that do not say the name of their value.
OTHER_WORDS = {"As the input", "As the inputs", "Blend to unit length"}
# A panel shows a slider, of a hundred steps, for what has two ends: of farther ones no step would be of use. Ends beyond this are left to the filter, and
# the panel shows a field.
FAR = 720
SLIDER_STEPS = 100  # a default that lies before half of the first is a field's, too


def proxies():
    """(group, element) of every proxy in the plugin's XML."""
    # Those as they are written, and those that are made of the core's lists.
    sources = [os.environ[place] + "/plugins/paraview/anamorph/*.xml" for place in ("ANAMORPH_SOURCE_DIR", "ANAMORPH_BUILD_DIR")]
    for path in sorted(path for source in sources for path in glob.glob(source)):
        for group in xml.parse(path).getroot().iter("ProxyGroup"):
            for element in group:
                if element.tag.endswith("Proxy"):
                    yield group.get("name"), element


def properties(element):
    return [child for child in element if child.tag.endswith("Property")]


def numbers(value):
    return [float(v) for v in value] if isinstance(value, (list, tuple)) else [float(value)]


def cites(text):
    return any(paper in " ".join(text.split()) for paper in PAPERS)


def check_documentation(element):
    documentation = element.find("Documentation")
    assert documentation.get("short_help") and cites(documentation.get("long_help")), element.get("name")
    assert cites(documentation.text), element.get("name")
    for p in properties(element):
        text = p.findtext("Documentation") or ""
        assert cites(text) and len(text.split()) > 6, (element.get("name"), p.get("name"), text)


def check_defaults(element):
    """The XML's defaults are those of a new object. Returns how many were compared."""
    name, new = element.get("name"), getattr(anamorph, element.get("class"))()
    compared = 0
    for p in properties(element):
        command, default = p.get("command"), p.get("default_values")
        if not (command or "").startswith("Set") or default is None:
            continue
        if p.get("repeat_command"):
            shown = [] if default == "none" else numbers(default.split())
            count, size = getattr(new, "G" + p.get("set_number_command")[1:])(), int(p.get("number_of_elements_per_command"))
            kept = [v for i in range(count) for v in numbers(getattr(new, "G" + command[1:])(i))] if shown else []
            assert kept == shown and count * size == len(shown), (name, p.get("name"), kept, shown)
        elif p.tag == "StringVectorProperty":
            assert (getattr(new, "G" + command[1:])() or "") == default, (name, p.get("name"))
        else:
            value = getattr(new, "G" + command[1:])()
            assert numbers(value) == numbers(default.split()), (name, p.get("name"), value, default)
        compared += 1
    return compared


def check_parameters(element):
    """Every SetX of the class itself, and of its bases here, is the command of a property."""
    cls = getattr(anamorph, element.get("class"))
    inherited = {m for base in cls.__mro__[1:] if not base.__name__.startswith("vtkAnamorph") for m in dir(base)}
    own = {m for m in dir(cls) if m.startswith("Set") and m not in inherited and not re.search("To[A-Z]", m[3:])}
    used = {p.get(key) for p in properties(element) for key in ("command", "set_number_command")}
    missing = own - used - NO_PROPERTY.get(element.get("class"), set())
    assert not missing, (element.get("name"), missing)
    return len(own)


def core_rows():
    """What the core says of its numbers: default, least, most (None: no end or a far one), both as a panel shows them; of
    its choices, their values."""
    rows, menus = {}, {}
    for line in subprocess.run([os.environ["ANAMORPH_ROWS"]], capture_output=True, check=True, text=True).stdout.splitlines():
        name, *texts = line.split()
        if name == "menu":
            menus[texts[0]] = texts[1:]
            continue
        standard, least, most, above, below, integer = (float(text) for text in texts)
        steps = (standard - least) / (most - least) * SLIDER_STEPS
        slid = abs(most) < FAR and (steps == 0 or steps > 0.5)
        rows[name] = {"default": standard, "min": least + 0.001 * above if abs(least) < FAR else None,
                      "max": most - 0.001 * below if slid else None, "integer": bool(integer)}
    assert len(rows) >= 9 and menus, rows
    return rows, menus


def domain_of(p):
    found = [d for d in p if d.tag in ("IntRangeDomain", "DoubleRangeDomain", "EnumerationDomain", "BooleanDomain")]
    return found[0] if found else None


def give(new, command, values):
    """Calls a setter of several numbers, or of a list of them."""
    setter = getattr(new, command)
    try:
        setter(*values)
    except TypeError:
        setter(values)


def row_of(element, name, rows):
    """The name of a property's row, whether there is one or not."""
    cls, snake = element.get("class"), re.sub("(?<!^)([A-Z])", r"_\1", name).lower()
    operation = f"{OPERATION_OF.get(cls)}_{snake}"
    return ROW_OF.get((cls, name), operation if operation in rows else snake)


def clamped_to(cls, command, size, number):
    """The least and the most that a setter makes of what is far out; None where it keeps that."""
    ends = []
    for far in (-2**31, 2**31 - 1) if number is int else (-1e300, 1e300):
        new = cls()
        give(new, command, [far] * size)
        value = numbers(getattr(new, "G" + command[1:])())[0]
        ends.append(None if value == far else value)
    return ends


def check_menu(cls, command, entries):
    """A menu has all values that the class takes, each under the name of its enumerator."""
    values = [int(entry.get("value")) for entry in entries]
    least, most = clamped_to(cls, command, 1, int)
    assert values == list(range(int(least), int(most) + 1)), (cls.__name__, command, values, least, most)
    named, namer = {}, getattr(anamorph, NAMED_BY.get((cls.__name__, command), cls.__name__))
    for name in dir(namer):
        if re.fullmatch("[A-Z][A-Z0-9_]+", name) and isinstance(getattr(namer, name), int):
            named.setdefault(getattr(namer, name), set()).update(name.lower().split("_"))
    for value, text in ((int(entry.get("value")), entry.get("text")) for entry in entries):
        words = set(re.findall("[a-z]+", text.lower()))
        assert text in OTHER_WORDS or words & named[value], (cls.__name__, command, text, named[value])


def check_whole(element, rows, menus):
    """Every number has the default, the range and the type of its row in the core, or else the range of its class, no more
    and no less. Returns the rows that were compared."""
    cls, seen = getattr(anamorph, element.get("class")), set()
    for p in properties(element):
        name, command, domain = p.get("name"), p.get("command") or "", domain_of(p)
        if not command.startswith("Set") or domain is None or domain.tag == "BooleanDomain" or p.get("repeat_command"):
            continue
        where = (element.get("name"), name)
        if domain.tag == "EnumerationDomain":
            check_menu(cls, command, list(domain))
            menu = row_of(element, name, menus)
            if menu in menus:
                seen.add(menu)
                words = [entry.get("text").lower().replace(" ", "_") for entry in domain]
                # Menus of VTK's enumerators keep the places that states have, whatever the core adds in between.
                assert sorted(words) == sorted(menus[menu]), (where, words, menus[menu])
                assert menu in ("drape_surface", "drape_filter") or words == menus[menu], (where, words, menus[menu])
            continue
        number = int if domain.tag == "IntRangeDomain" else float
        shown = {end: float(domain.get(end)) if domain.get(end) else None for end in ("min", "max")}
        row = row_of(element, name, rows)
        if row in rows:
            seen.add(row)
            assert shown == {end: rows[row][end] for end in ("min", "max")}, (where, shown, rows[row])
            assert set(numbers(p.get("default_values").split())) == {rows[row]["default"]}, (where, rows[row])
            assert rows[row]["integer"] == (number is int), where
        elif name in LEAST_ALONE:
            assert shown == {"min": LEAST_ALONE[name], "max": None}, (where, shown)
        else:
            least, most = (end if end is None or abs(end) < FAR else None
                           for end in clamped_to(cls, command, int(p.get("number_of_elements")), number))
            assert shown == {"min": least, "max": most}, (where, shown, least, most)
    return seen


def check_surfaces(element, words):
    """The proxy has a weight, with its name, for every surface of the core's list."""
    menu, weights = (next(p for p in properties(element) if p.get("name") == name) for name in ("Surface", "BlendWeights"))
    texts = [entry.get("text") for entry in domain_of(menu)]
    labels = [(int(label.get("component")), label.get("label")) for label in weights.iter("ComponentLabel")]
    assert len(texts) == len(words) == int(weights.get("number_of_elements")), (texts, words)
    assert labels == list(enumerate(texts)), labels
    assert texts[anamorph.vtkAnamorphDrape.POSITIONS] == "Positions" and anamorph.vtkAnamorphDrape.POSITIONS == 7, texts
    assert texts[anamorph.vtkAnamorphDrape.FORMULA] == "Formula" and anamorph.vtkAnamorphDrape.FORMULA == 8, texts


def with_input(cls):
    """A new object that has what it needs to execute, seen by a camera."""
    new = cls()
    if cls in (anamorph.vtkAnamorphReliefSource, anamorph.vtkAnamorphDrape, anamorph.vtkAnamorphPanoramaView,
               anamorph.vtkAnamorphDeformImage, anamorph.vtkAnamorphImageMorph, anamorph.vtkAnamorphImageWarp):
        picture = vtkRTAnalyticSource()
        picture.SetWholeExtent(0, 9, 0, 19, 0, 0)  # twice as high as wide, as the last projection is
        picture.Update()
        new.SetInputData(picture.GetOutput())
        if cls is anamorph.vtkAnamorphDrape:
            relief = with_input(anamorph.vtkAnamorphReliefSource)
            relief.Update()
            new.SetInputData(1, relief.GetOutput())
        elif cls is anamorph.vtkAnamorphImageMorph:
            new.SetInputData(1, picture.GetOutput())
        elif cls is anamorph.vtkAnamorphImageWarp:
            mesh = vtkPlaneSource()
            mesh.Update()
            new.SetInputData(1, mesh.GetOutput())
    elif cls is anamorph.vtkAnamorphBlendShapeReader:
        with open("shape.obj", "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        new.AddFileName("shape.obj")
    elif cls is anamorph.vtkAnamorphBlendShapeWriter:
        plane = vtkPlaneSource()
        plane.Update()
        new.AddInputData(plane.GetOutput())
        new.SetFileName("plane.glb")
    elif cls is anamorph.vtkAnamorphSplatReader:
        with open("splats.ply", "w") as file:
            file.write(surfaces.splats_head(0))
        new.SetFileName("splats.ply")
    elif cls is anamorph.vtkAnamorphFigureReader:
        with open("ranges.nudes", "w") as file:
            file.write("figure f 1 a\nellipsoid a 5 8 4\nrepeat 0 2 moveto f a 500 500 300\nstop\n")
        new.SetFileName("ranges.nudes")
    elif issubclass(cls, anamorph.vtkAnamorphFigureAlgorithm):
        reader = with_input(anamorph.vtkAnamorphFigureReader)
        reader.Update()
        new.SetInputData(reader.GetOutput())
        new.SetViewMode(1)
        if cls is anamorph.vtkAnamorphFigureGeometry:
            new.SetToleranceMode(1)
            new.SetTolerance(100)
        new.SetCameraParallelProjection(True)
    else:
        plane = vtkPlaneSource()
        plane.Update()
        for _ in range(2 if cls is anamorph.vtkAnamorphInbetween else 1):
            new.AddInputDataObject(plane.GetOutput())
        if cls is anamorph.vtkAnamorphPanoramaProjection:
            # Of the largest panorama too, few triangles; twice as high as wide, as the last projection is.
            new.SetPanoramaHeight(8192)
            new.SetPosition(0, 0, 1)
            new.SetTolerance(1000)
        elif cls is anamorph.vtkAnamorphProjectionBake:
            picture = vtkRTAnalyticSource()
            picture.SetWholeExtent(0, 9, 0, 19, 0, 0)
            new.AddPanoramaConnection(picture.GetOutputPort())
            new.AddProjector(0, 0, 1, 0, 0, -1, 0, 1, 0)
            new.SetWidth(16)
            new.SetHeight(16)
    return new


def is_taken(cls, command, value, perspective):
    """Whether a value is kept as it is, and the class executes with it."""
    new, errors = with_input(cls), []
    new.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    new.GetExecutive().AddObserver("ErrorEvent", lambda *_: errors.append(1))
    if perspective:
        new.SetCameraParallelProjection(False)
    if command == "SetVerticalFieldOfView":
        new.SetProjection(anamorph.vtkAnamorphPanoramaProjection.FISHEYE)  # which may have all of it
    give(new, command, value)
    kept = numbers(getattr(new, "G" + command[1:])()) == [float(v) for v in value]
    if kept:
        new.Update()
    return kept and not errors


def check_ranges(element):
    """What a property's domain allows is what the class takes, at both ends and not a step beyond. Returns how many ends
    there were."""
    cls, ends = getattr(anamorph, element.get("class")), 0
    for p in properties(element):
        command, size = p.get("command") or "", int(p.get("number_of_elements") or 1)
        domains = [d for d in p if d.tag in ("IntRangeDomain", "DoubleRangeDomain", "EnumerationDomain")]
        if not command.startswith("Set") or not domains or p.get("repeat_command"):
            continue
        if domains[0].tag == "EnumerationDomain":
            values = [int(entry.get("value")) for entry in domains[0]]
            assert values == list(range(len(values))), (p.get("name"), values)
            least, most, number = values[0], values[-1], int
        else:
            least, most = domains[0].get("min"), domains[0].get("max")
            number = int if domains[0].tag == "IntRangeDomain" else float
        perspective = p.get("name") == "CameraViewAngle"
        for end, outwards in ((least, -1), (most, 1)):
            if end is None:
                continue
            end = number(end)
            # An open end is shown as a thousandth beside it; a step leads over it.
            beyond = end + outwards * (1 if number is int else 0.001)
            where = (element.get("name"), p.get("name"), end, beyond)
            assert is_taken(cls, command, [end] * size, perspective), where
            assert not is_taken(cls, command, [beyond] * size, perspective), where
            ends += 1
    return ends


folder = os.environ["ANAMORPH_SOURCE_DIR"] + "/plugins/paraview/anamorph/"
icons = {file.get("alias") for file in xml.parse(folder + "anamorph.qrc").getroot().iter("file")}
assert icons == set(os.listdir(folder + "icons")), icons
(rows, menus), compared_rows = core_rows(), set()
found = list(proxies())
assert len(found) >= 4, found
manager = servermanager.ProxyManager()
for group, element in found:
    name = element.get("name")
    proxy = manager.NewProxy(group, name)
    assert proxy is not None, name
    proxy.UpdateVTKObjects()
    if element.get("class"):
        assert proxy.GetClientSideObject().GetClassName() == element.get("class"), name
    for p in properties(element):
        assert proxy.GetProperty(p.get("name")) is not None, (name, p.get("name"))
    check_documentation(element)
    if element.get("base_proxyname") or not hasattr(anamorph, element.get("class") or ""):
        continue
    if group == "writers":  # Save Data offers them
        assert element.find("Hints/WriterFactory").get("extensions"), name
    else:
        assert element.find("Hints/ShowInMenu").get("category") == "Anamorph", name
        icon = element.find("Hints/ShowInMenu").get("icon")
        assert icon.startswith(":/anamorph/") and icon[len(":/anamorph/"):] in icons, (name, icon)
    compared, own = check_defaults(element), check_parameters(element)
    least_compared, least_ends, least_own = FEW.get(name, (4, 2, 4))
    assert compared >= least_compared and own >= least_own, (name, compared, own)
    compared_rows |= check_whole(element, rows, menus)
    if element.get("class") == "vtkAnamorphDrape":
        check_surfaces(element, menus["drape_surface"])
    ends = check_ranges(element)
    assert ends >= least_ends, (name, ends)
    print(name, ":", compared, "defaults,", own, "parameters,", ends, "ends of ranges")
# ParaView's help has a page of each, where Qt's tools made any.
for path in glob.glob(os.environ["ANAMORPH_BUILD_DIR"] + "/plugins/paraview/anamorph/paraview_help/*.qch"):
    with contextlib.closing(sqlite3.connect(path)) as pages:
        names = {row[0] for row in pages.execute("SELECT Name FROM FileNameTable")}
    wanted = {f"{group}.{element.get('name')}.html" for group, element in found if group in ("sources", "filters", "writers")}
    assert len(wanted) > 12 and wanted <= names, wanted - names
wanted_rows = (set(rows) | set(menus)) - IN_TABLES - NOT_OFFERED
assert compared_rows == wanted_rows, compared_rows ^ wanted_rows
