# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""What is recorded of every proxy of the plugin makes the same bits when it is run again, in the order recorded and in
others, whether inputs are updated between or not."""
import ast
import glob
import os
import random
import xml.etree.ElementTree as xml

import surfaces
from paraview import servermanager, simple, smtrace
from paraview.simple import *

PLUGIN = os.environ["ANAMORPH_PLUGIN"]
ORDERS = {True: 3, False: 1}  # how many but the one recorded, with inputs updated between and without
FIGURE = ("figure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 5 20 8\njoint j a 0 40 0 b 0 -20 0\n"
          "repeat 0 1 moveto f a 300 200 300\nlinear 0 4 moveby f world 40 0 -8\nstop\n")


def start_again():
    ResetSession()
    LoadPlugin(PLUGIN, remote=False, ns=vars(simple))
    globals().update(vars(simple))


def apply(proxy, **values):
    """Sets properties as the window's Apply does: all of them, then one update of the server, all recorded."""
    modified = smtrace.PropertiesModified(proxy)
    for name, value in values.items():
        prop = proxy.GetProperty(name)
        if isinstance(prop, servermanager.ProxyProperty):
            prop.SMProperty.SetInputConnection(0, value.SMProxy, 0)
            continue
        elements = list(value) if isinstance(value, (list, tuple)) else [value]
        if prop.SMProperty.GetRepeatable():
            prop.SMProperty.SetNumberOfElements(len(elements))
        for i, element in enumerate(elements):
            prop.SMProperty.SetElement(i, prop.ConvertValue(element))
    proxy.UpdateVTKObjects()
    modified.finalize()
    proxy.UpdatePipeline()


# ---- What is recorded ----

def upright_plane(**arguments):
    plane = Plane(Origin=[-.5, 0, -.5], Point1=[.5, 0, -.5], Point2=[-.5, 0, .5], XResolution=20, YResolution=20,
                  **arguments)
    plane.UpdatePipeline()
    return plane


def texture_coordinates_after_the_plane():
    deform = AnamorphDeform(registrationName="result", Input=upright_plane())
    apply(deform, ParameterMode=1)


def a_bump_in_texture_coordinates():
    deform = AnamorphDeform(registrationName="result", Input=upright_plane())
    apply(deform, ParameterMode=1, Deformations=[.3, .7, .1, .2, 0, 1, 0, 0, 1])
    apply(deform, SelectedCenter=[.4, .6, 0])
    apply(deform, SelectedCorner=[.7, .65, 0], OutputPointsPrecision=1)


def handles_and_then_the_plane():
    deform = AnamorphDeform(registrationName="result", Input=upright_plane())
    apply(deform, SelectedCenter=[.1, .3, .15], SelectedVector=[.1, .2, .3])
    apply(deform, SelectedCorner=[-.1, .3, .35])
    apply(deform, AutomaticPlane=0, Origin=[.1, .2, .3], Axis1=[.3, 0, .1], Axis2=[0, .2, .7])
    apply(deform, SelectedCorner=[.31, .3, .57])
    apply(deform, ParameterMode=1)


def another_row():
    deform = AnamorphDeform(registrationName="result", Input=upright_plane())
    apply(deform, Deformations=surfaces.BUMPS)
    apply(deform, SelectedDeformation=2)
    apply(deform, SelectedCenter=[.1, 0, .2], SelectedDeformation=1, GenerateOverlay=1)
    apply(deform, SelectedVector=[.1, .5, .1], SelectedDeformation=3, ComputeNormals=0, Cutoff=1e-3)
    apply(deform, SelectedDeformation=0, ComputeDisplacement=0)


def shapes_of_files():
    for k in (0, 1):
        with open(f"shape{k}.obj", "w") as file:
            file.write(f"v 0 0 {k}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    reader = AnamorphBlendShapeReader(registrationName="result", FileName=[os.path.abspath(f"shape{k}.obj") for k in (0, 1)])
    apply(reader, Weights=[.5])
    apply(reader, Weights=[.25], Animation=-1)


def a_volume_deformed():
    wavelet = Wavelet(WholeExtent=[-5, 5, -5, 5, 0, 3])
    wavelet.UpdatePipeline()
    image = AnamorphDeformImage(registrationName="result", Input=wavelet)
    apply(image, Deformations=[0, 0, 3, 3, .4, .2, .1, 0, 1], Background=-1)
    apply(image, Inverse=1, Interpolation=2, Axis1=[1, .1, 0])


def splats_of_a_file():
    values = surfaces.np.random.default_rng(5).normal(0, 1, (30, 14)).astype("<f4")
    with open("splats.ply", "wb") as file:
        file.write(surfaces.splats_head(30).encode() + values.tobytes())
    AnamorphSplatReader(registrationName="result", FileName=os.path.abspath("splats.ply"))


def a_whole_table():
    deform = AnamorphDeform(registrationName="result", Input=upright_plane())
    apply(deform, Names=["brow"], Bumps=[.1, .2, 0, .2, .1, .3, 0, .2, .1, 0, 1, 1, 1, 0, .2, 0, 1, .05, 1])
    apply(deform, SelectedVector=[.1, .2, 0], ComputeFolds=1)


def files_and_a_table():
    plane = upright_plane()
    table = CSVReader(FileName=[os.path.abspath("list.csv")])
    table.UpdatePipeline()
    deform = AnamorphDeform(registrationName="result", Input=plane, Table=table)
    apply(deform, FileName=os.path.abspath("list.csv"))
    apply(deform, ImportFile=os.path.abspath("list.csv"), SelectedDeformation=1)
    apply(deform, SelectedCenter=[.1, 0, .2])


def surfaces_in_between():
    plane = upright_plane()
    bump = AnamorphDeform(registrationName="bump", Input=plane)
    other = AnamorphDeform(registrationName="other", Input=plane, Deformations=surfaces.BUMPS)
    for source in (bump, other):
        source.UpdatePipeline()
    masked = Calculator(Input=plane, ResultArrayName="Mask", Function="coordsX^2")
    masked.UpdatePipeline()
    between = AnamorphInbetween(registrationName="result", Input=[masked, bump, other])
    apply(between, Weights=[2, -1, 3], NormalizeWeights=1)
    apply(between, Mode=1, BaseIndex=0, Weights=[.5, .25, 0], Masks=["", "Mask", ""], OutputPointsPrecision=1)
    apply(between, Masks=[], Mode=0, Interpolation=2, Normals=0,
          Keys=[0, 0, 1, 1, 1, .5, 1, 2, .5, 2, 2, 1])


def a_relief_of_a_file():
    relief = AnamorphReliefSource(registrationName="result", FileName=os.path.abspath("hills.png"))
    apply(relief, HeightScale=.3, HeightOffset=.1, Smoothing=1.5, SampleRate=3, Component=0)
    apply(relief, Origin=[0, 0, 0], Point1=[2, 0, 1], Point2=[0, 3, 1], KeepAspect=0, GenerateNormals=1)
    apply(relief, Resolution=[17, 23], OutputPointsPrecision=1)


def a_relief_of_the_pipeline():
    picture = Wavelet(WholeExtent=[0, 10, 0, 10, 0, 0])
    picture.UpdatePipeline()
    relief = AnamorphRelief(registrationName="result", Input=picture)
    apply(relief, HeightScale=.01, Smoothing=1, Resolution=[9, 0])


def a_picture_on_a_surface():
    picture = Wavelet(WholeExtent=[0, 20, 0, 10, 0, 0])
    picture.UpdatePipeline()
    drape = AnamorphDrape(registrationName="result", Input=picture)
    apply(drape, Surface=2, Angle=300, Radius=.4, ViewSize=[60, 40], CameraPosition=[.3, .4, 2])
    apply(drape, Surface=4, Turn=.3, Direction=20, CameraViewAngle=40, Tolerance=.5, Filter=1, Background=[1, .5, 0, 1])
    apply(drape, Surface=5, Amplitude=.1, Wavelength=.3, Phase=.2, CameraFocalPoint=[.1, 0, 0], CameraViewUp=[.1, 1, 0])
    apply(drape, Surface=3, Tube=.1, Style=2, CameraParallelProjection=1, CameraParallelScale=.7)


def surfaces_of_inputs_in_light():
    picture = Wavelet(WholeExtent=[0, 20, 0, 10, 0, 0])
    picture.UpdatePipeline()
    relief = AnamorphRelief(registrationName="relief", Input=picture, HeightScale=.001)
    vectors = Calculator(registrationName="vectors", Input=picture,
                         Function="iHat*coordsX/10+jHat*coordsY/10+kHat*coordsX*coordsY/100", ResultArrayName="Place")
    table = CSVReader(FileName=[os.path.abspath("list.csv")])
    for source in (relief, vectors, table):
        source.UpdatePipeline()
    drape = AnamorphDrape(registrationName="result", Input=picture, Positions=relief, ViewSize=[60, 40])
    apply(drape, Surface=7, Shading=2, Lights=[0, 1, 2, 3, 0, 1], Ambient=.1, Diffuse=.7, Specular=.3, Shininess=5)
    apply(drape, Deformations=table, DeformationFileName=os.path.abspath("list.csv"))
    apply(drape, BlendWeights=[0, 0, .3, 0, .1, 0, 0, 0], Positions=vectors, PositionsArrayName="Place")
    apply(drape, Surface=0, BlendWeights=[0, .2, 0, 0, 0, 0, 0, 0], Height=vectors, HeightArrayName="RTData",
          HeightScale=.001, HeightSmooth=2, Shading=1)


def figures_performed():
    figures = AnamorphFigureReader(registrationName="figures", FileName=os.path.abspath("figure.nudes"))
    figures.UpdatePipeline()
    apply(figures, Joints=1, Dialect=1, OutputPointsPrecision=0, Libraries=[])
    for name, values in {
            "AnamorphFigureGeometry": {"ToleranceMode": 1, "Tolerance": .5, "OutputPointsPrecision": 1},
            "AnamorphFigureImage": {"Style": 1, "Lighting": 2, "Antialias": 0, "Outlines": 1, "OutlineTolerance": 2, "Solid": 4,
                                    "SolidScale": 30, "SolidSamples": 2, "SolidRed": "x/scale", "SolidGreen": "k",
                                    "SolidBlue": "own_blue", "SolidDefinitions": "k=0.5", "BumpScale": -3, "TextureMapping": 2},
            "AnamorphFigureOutline": {"Hidden": 1, "Crossings": 1, "Connected": 1, "Tolerance": .5},
            "AnamorphFigureSkeleton": {"Mode": 2, "LevelOfDetail": 1, "Tolerance": 3}}.items():
        drawn = getattr(simple, name)(registrationName="result " + name, Input=figures)
        apply(drawn, **values)
        apply(drawn, ViewMode=1, ViewSize=[300, 200], CameraPosition=[400, 300, 900], CameraViewAngle=40,
              CameraFocalPoint=[300, 200, -300], CameraViewUp=[.1, 1, 0])
        apply(drawn, CameraParallelProjection=1, CameraParallelScale=200)


def a_panorama_thrown_onto_a_plane():
    projection = AnamorphPanoramaProjection(registrationName="result", Input=upright_plane())
    apply(projection, Position=[.1, .4, .1], Tolerance=2)
    apply(projection, Projection=1, PanoramaWidth=600, PanoramaHeight=200, Direction=[1, 0, .2], Occlusion=0)


def a_texture_on_few_polygons():
    ball = Sphere(ThetaResolution=6, PhiResolution=6)
    textured = AnamorphNonlinearTexture(registrationName="result", Input=TextureMaptoSphere(Input=ball, PreventSeam=1))
    apply(textured, TextureWidth=300, TextureHeight=200, Tolerance=2)


def a_panorama_baked():
    mesh, picture = Plane(), Wavelet(WholeExtent=[0, 63, 0, 31, 0, 0])
    bake = AnamorphProjectionBake(registrationName="result", Input=mesh, Panoramas=[picture])
    apply(bake, Projectors=[0, 0, 1, 0, 0, -1, 0, 1, 0], Width=40, Height=30)
    apply(bake, FieldOfView=300, Projection=1, Fade=4, Margin=2, Projectors=[.1, .2, 1, 0, .1, -1, 0, 1, 0], Occlusion=0)


def a_view_of_a_panorama():
    picture = Wavelet(WholeExtent=[0, 15, 0, 7, 0, 0])
    picture.UpdatePipeline()
    view = AnamorphPanoramaView(registrationName="result", Input=picture)
    apply(view, Yaw=40, Pitch=-10, Roll=3, ViewAngle=70, ViewSize=[60, 40], Tolerance=.1)
    apply(view, Projection=11, FieldOfView=200, PanniniDistance=.5)
    apply(view, Projection=3, Lens="kb4:k1=0.02")


def an_image_warped_by_a_mesh():
    image = Wavelet(registrationName="image", WholeExtent=[0, 20, 0, 20, 0, 0])
    image.UpdatePipeline()
    mesh = Plane(registrationName="mesh", Origin=[0, 0, 0], Point1=[20, 0, 0], Point2=[0, 20, 0], XResolution=8, YResolution=8)
    mesh.UpdatePipeline()
    moved = AnamorphDeform(registrationName="moved", Input=mesh)
    apply(moved, AutomaticPlane=0, Origin=[0, 0, 0], Axis1=[20, 0, 0], Axis2=[0, 20, 0], Deformations=[.5, .5, .3, .3, 3, 0, 0, 0, 1])
    SetActiveSource(image)  # whose arrays a new filter's are chosen from
    warp = AnamorphImageWarp(registrationName="result", Input=image, Mesh=moved)
    apply(warp, Amount=.5, Tolerance=.001, Interpolation=1)


def an_image_that_becomes_another():
    images = [Wavelet(registrationName=name, WholeExtent=[0, 20, 0, 20, 0, 0], Maximum=most) for name, most in (("image", 255), ("second", 99))]
    lines = [Line(registrationName=name, Point1=[4, 5, 0], Point2=end, Resolution=1) for name, end in (("here", [15, 6, 0]), ("there", [12, 14, 0]))]
    for source in images + lines:
        source.UpdatePipeline()
    SetActiveSource(images[0])
    morph = AnamorphImageMorph(registrationName="result", Input=images[0], Other=images[1], Lines=lines[0], OtherLines=lines[1])
    apply(morph, Shape=.25, PinBorder=1, Tolerance=.001, Interpolation=1)
    apply(morph, ColorFollowsShape=0, Color=.75, WeightA=.5, WeightB=1, WeightP=1)


SESSIONS = [texture_coordinates_after_the_plane, a_bump_in_texture_coordinates, handles_and_then_the_plane, another_row, shapes_of_files,
            files_and_a_table, surfaces_in_between, a_relief_of_a_file, a_relief_of_the_pipeline,
            a_picture_on_a_surface, surfaces_of_inputs_in_light, figures_performed, a_panorama_thrown_onto_a_plane,
            a_texture_on_few_polygons, a_panorama_baked, a_view_of_a_panorama, a_volume_deformed, a_whole_table,
            splats_of_a_file, an_image_warped_by_a_mesh, an_image_that_becomes_another]


# ---- What is compared ----

def bits_of(data):
    """Of all arrays and points of a data set; of an image, how many points there are."""
    if data.IsA("vtkMultiBlockDataSet"):
        blocks = [bits_of(data.GetBlock(k)) for k in range(data.GetNumberOfBlocks())]
        return [(name, value) for block in blocks for name, value in block]
    found = []
    for fields in (data.GetPointData(), data.GetCellData(), data.GetFieldData()):
        for i in range(fields.GetNumberOfArrays()):
            array = fields.GetAbstractArray(i)
            values = [array.GetVariantValue(k).ToString() for k in range(array.GetNumberOfValues())] \
                if array.IsA("vtkStringArray") else surfaces.vtk_to_numpy(array).tobytes()
            found.append((array.GetName(), values))
    points = data.GetPoints() if data.IsA("vtkPointSet") else None
    found.append(("points", surfaces.vtk_to_numpy(points.GetData()).tobytes() if points else data.GetNumberOfPoints()))
    found.append(("cells", data.GetNumberOfCells()))
    return found


def results():
    """By name: the properties of the proxies of the plugin, without handles, and the bits of their outputs."""
    found = {}
    for (name, _), source in sorted(GetSources().items()):
        if not source.GetXMLName().startswith("Anamorph"):
            continue
        for time in (0, 1.5):
            source.UpdatePipeline(time)
            outputs = [bits_of(servermanager.Fetch(OutputPort(source, i)))
                       for i in range(source.SMProxy.GetNumberOfOutputPorts())]
            assert any(dict(bits)["points"] for bits in outputs), name
            found[name, time] = outputs
        handles = ("SelectedCenter", "SelectedCorner", "SelectedTip", "SelectedVector")
        found[name] = {p: str(source.GetPropertyValue(p)) for p in source.ListProperties()
                       if not source.GetProperty(p).SMProperty.GetInformationOnly() and p not in handles
                       and not isinstance(source.GetProperty(p), servermanager.ProxyProperty)}
    return found


def record(session):
    start_again()
    smtrace.start_trace()
    session()
    trace = smtrace.stop_trace()
    recorded = results()
    assert any(name[0].startswith("result") for name in recorded if isinstance(name, tuple)), list(recorded)
    return trace, recorded


def variant(trace, order, update):
    """The trace with the properties of each block in another order (None: as recorded), and with all sources updated
    before a filter is made of them, and after each block, as the window does it, or not."""
    lines, made, block, last = [], [], [], None

    def finish():
        if order:
            order.shuffle(block)
        lines.extend(block)
        if update and block:
            lines.append(made[-1] + ".UpdatePipeline()")
        block.clear()
    for statement in ast.parse(trace).body:
        text = ast.get_source_segment(trace, statement)
        assigned = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if not isinstance(assigned, ast.Attribute) or statement.lineno != last + 1:
            finish()
        if isinstance(assigned, ast.Attribute):
            made.append(assigned.value.id)
            block.append(text)
        else:
            lines.append(text)
            if isinstance(assigned, ast.Name) and update and not block:
                made.append(assigned.id)
        last = statement.end_lineno
    finish()
    return "\n".join(lines)


def check(session):
    trace, recorded = record(session)
    for update, shuffled in ORDERS.items():
        for order in [None] + [random.Random(seed) for seed in range(shuffled)]:
            text = variant(trace, order, update)
            start_again()
            exec(text, {})
            found = results()
            assert found.keys() == recorded.keys(), (session.__name__, list(found))
            for name in recorded:
                assert found[name] == recorded[name], (session.__name__, name, text)
    return {source.GetXMLName() for source in GetSources().values()}


surfaces.write_inputs(os.getcwd())
with open("figure.nudes", "w") as script:
    script.write(FIGURE)
start_again()
AnamorphDeform(Input=upright_plane(), Deformations=surfaces.BUMPS).ExportFile = os.path.abspath("list.csv")
traced = set()
for session in SESSIONS:
    traced |= check(session)
    print(session.__name__, "ok", flush=True)
proxies = {element.get("name") for place in ("ANAMORPH_SOURCE_DIR", "ANAMORPH_BUILD_DIR")
           for path in glob.glob(os.environ[place] + "/plugins/paraview/anamorph/*.xml")
           for group in xml.parse(path).getroot().iter("ProxyGroup") for element in group
           if element.tag.endswith("Proxy") and group.get("name") not in ("representations", "writers")}
assert proxies <= traced, proxies - traced
