# SPDX-License-Identifier: Apache-2.0
# The figure classes from Python: every property set and read, and a script from reader to lines.
import os
import subprocess
import tempfile

import anamorph
import conformance
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_INT, VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSetAttributes, vtkPolyData
from vtkmodules.vtkImagingCore import vtkImageFlip

reader = anamorph.vtkAnamorphFigureReader()
for name, value in [("FileName", "walk.n"), ("Dialect", reader.STRICT), ("NumberOfLibraries", 2), ("Joints", True),
                    ("OutputPointsPrecision", reader.SINGLE_PRECISION)]:
    getattr(reader, "Set" + name)(value)
    assert getattr(reader, "Get" + name)() == value, name
reader.SetLibrary(1, "fred.n")
assert reader.GetLibrary(1) == "fred.n" and "fred.n" in str(reader)

view = [("ViewMode", 1), ("ViewSize", (300, 200)), ("CameraPosition", (1, 2, 3)), ("CameraFocalPoint", (4, 5, 6)),
        ("CameraViewUp", (1, 0, 0)), ("CameraParallelProjection", True), ("CameraParallelScale", 7),
        ("CameraViewAngle", 40)]
geometry = anamorph.vtkAnamorphFigureGeometry()
for name, value in view + [("ToleranceMode", geometry.PIXELS), ("Tolerance", 0.5),
                           ("OutputPointsPrecision", geometry.DOUBLE_PRECISION)]:
    getattr(geometry, "Set" + name)(value)
    assert getattr(geometry, "Get" + name)() == value, name
outline = anamorph.vtkAnamorphFigureOutline()
for name, value in view + [("Hidden", outline.KEPT), ("Crossings", True), ("Connected", True), ("Tolerance", 0.5),
                           ("OutputPointsPrecision", outline.SINGLE_PRECISION)]:
    getattr(outline, "Set" + name)(value)
    assert getattr(outline, "Get" + name)() == value, name
skeleton = anamorph.vtkAnamorphFigureSkeleton()
for name, value in view + [("Mode", skeleton.SPHERES), ("LevelOfDetail", 3), ("Tolerance", 0.5),
                           ("OutputPointsPrecision", skeleton.SINGLE_PRECISION)]:
    getattr(skeleton, "Set" + name)(value)
    assert getattr(skeleton, "Get" + name)() == value, name

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "one.nudes")
    with open(path, "w") as file:
        file.write("figure f 1 a\nellipsoid a 10 20 30\nlinear 0 3 moveby f a 3 0 0\nstop")
    reader = anamorph.vtkAnamorphFigureReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.UpdateTimeStep(2)
    assert reader.GetOutput().GetPoint(0) == (2, 0, 0)
    assert reader.GetOutput().GetPointData().GetAbstractArray("Name").GetValue(0) == "a"
    geometry = anamorph.vtkAnamorphFigureGeometry()
    geometry.SetInputConnection(reader.GetOutputPort())
    geometry.Update()
    bounds = geometry.GetOutput().GetBounds()
    assert abs(bounds[3] - 20) < 1e-5 and bounds[1] > 10, bounds
    for cls in (anamorph.vtkAnamorphFigureOutline, anamorph.vtkAnamorphFigureSkeleton):
        lines = cls()
        lines.SetInputConnection(reader.GetOutputPort())
        lines.Update()
        assert lines.GetOutput().GetNumberOfLines() == 1
        assert lines.GetOutput().GetCellData().GetAbstractArray("Name").GetValue(0) == "a"

    # Written to a file and read back, a frame is drawn the same.
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader, vtkPolyDataWriter
    writer = vtkPolyDataWriter()
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetFileName(os.path.join(folder, "frame.vtk"))
    writer.SetFileTypeToBinary()
    writer.Write()
    back = vtkPolyDataReader()
    back.SetFileName(writer.GetFileName())
    for cls in (anamorph.vtkAnamorphFigureGeometry, anamorph.vtkAnamorphFigureOutline, anamorph.vtkAnamorphFigureSkeleton):
        drawn = []
        for source in (reader, back):
            lines = cls()
            lines.SetInputConnection(source.GetOutputPort())
            lines.Update()
            output = lines.GetOutput()
            drawn.append([output.GetPoint(i) for i in range(output.GetNumberOfPoints())])
        assert drawn[0] == drawn[1] and len(drawn[0]) > 1, cls

    # Written by the program, a frame is what the reader makes of it, with the fields that say how it is seen.
    if "ANAMORPH_FIGURE" in os.environ:
        with open(path, "w") as file:
            file.write("figure doll 2 trunk arm\nellipsoid trunk 60 100 40\nellipsoid arm 20 80 20\n"
                       "joint shoulder trunk 60 80 0 arm 0 75 0\nrepeat 0 3 moveto doll trunk 500 480 510\n"
                       "repeat 0 3 observe 10 20 30\nrepeat 0 3 place 400 450 500\nrepeat 0 1 texture arm wood 3 4\n"
                       "repeat 0 1 colour arm 10 20 250\nlinear 0 3 spinby doll trunk world 77 y\nstop")
        same_file = os.path.join(folder, "frame.vtp")
        subprocess.run([os.environ["ANAMORPH_FIGURE"], "vtp", path, "--frame", "2", "-o", same_file], check=True)
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        again, frames = vtkXMLPolyDataReader(), anamorph.vtkAnamorphFigureReader()
        again.SetFileName(same_file)
        again.Update()
        frames.SetFileName(path)
        frames.UpdateTimeStep(2)

        def listed(data):
            """All that a data set holds, by name."""
            fields = {"points": [data.GetPoint(i) for i in range(data.GetNumberOfPoints())], "verts": data.GetNumberOfVerts()}
            for field in (data.GetPointData(), data.GetFieldData()):
                for k in range(field.GetNumberOfArrays()):
                    array = field.GetAbstractArray(k)
                    kind = array.GetDataTypeAsString().replace("idtype", "long long")
                    fields[array.GetName()] = (kind, array.GetNumberOfComponents(), [
                        array.GetVariantValue(i).ToString() for i in range(array.GetNumberOfValues())])
            return fields

        written, read = listed(again.GetOutput()), listed(frames.GetOutput())
        assert written == read and len(read) >= 13, [(n, written.get(n), read.get(n)) for n in {*written, *read}
                                                    if written.get(n) != read.get(n)]

    # The same as a picture.
    picture = anamorph.vtkAnamorphFigureImage()
    for name, value in view + [("Style", picture.DEPTH), ("Lighting", picture.BLINN), ("Antialias", False),
                               ("TextureMapping", picture.LINEAR)]:
        getattr(picture, "Set" + name)(value)
        assert getattr(picture, "Get" + name)() == value, name
    assert "Style: depth" in str(picture) and "Lighting: blinn" in str(picture)
    pictures = []
    for source in (reader, back):
        picture = anamorph.vtkAnamorphFigureImage()
        picture.SetInputConnection(source.GetOutputPort())
        picture.SetViewMode(picture.CAMERA)
        x, y, z = reader.GetOutput().GetPoint(0)
        picture.SetCameraFocalPoint(x, y, z)
        picture.SetCameraPosition(x, y, z + 500)
        picture.SetViewSize(200, 160)
        picture.SetStyle(picture.BODY_ID)
        picture.Update()
        assert picture.GetOutput().GetDimensions() == (200, 160, 1)
        ids = picture.GetOutput().GetPointData().GetScalars()
        pictures.append([ids.GetValue(i) for i in range(ids.GetNumberOfTuples())])
    assert pictures[0] == pictures[1] and {-1, 0} <= set(pictures[0]), set(pictures[0])
    # Filters behind it know its numbers before it has drawn.
    for style, kind, components in ((picture.SHADED, VTK_UNSIGNED_CHAR, 4), (picture.OUTLINE, VTK_UNSIGNED_CHAR, 4),
                                    (picture.DEPTH, VTK_FLOAT, 1), (picture.BODY_ID, VTK_INT, 1)):
        picture.SetStyle(style)
        flip = vtkImageFlip()
        flip.SetInputConnection(picture.GetOutputPort())
        flip.SetFilteredAxis(1)
        flip.UpdateInformation()
        told = vtkDataObject.GetActiveFieldInformation(flip.GetOutputInformation(0), vtkDataObject.FIELD_ASSOCIATION_POINTS,
                                                       vtkDataSetAttributes.SCALARS)
        assert told.Get(vtkDataObject.FIELD_ARRAY_TYPE()) == kind, style
        assert told.Get(vtkDataObject.FIELD_NUMBER_OF_COMPONENTS()) == components, style
        flip.Update()
        upright, turned = (each.GetOutput().GetPointData().GetScalars() for each in (picture, flip))
        assert upright.GetDataType() == turned.GetDataType() == kind
        assert all(upright.GetTuple(i) == turned.GetTuple((159 - i // 200) * 200 + i % 200) for i in range(0, 32000, 97))

# An image of bumps that changes over time tells its times, too.
image = anamorph.vtkAnamorphFigureImage()
image.SetInputDataObject(vtkPolyData())
bumps = conformance.Source(conformance.picture, [0.5, 2.0])
image.SetBumpConnection(bumps.GetOutputPort())
assert conformance.steps_of(image) == [0.5, 2.0], conformance.steps_of(image)
