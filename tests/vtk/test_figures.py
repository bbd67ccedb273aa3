# SPDX-License-Identifier: Apache-2.0
# The figure classes from Python: every property set and read, and a script from reader to lines.
import os
import tempfile

import anamorph

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

    # The same as a picture.
    picture = anamorph.vtkAnamorphFigureImage()
    for name, value in view + [("Style", picture.DEPTH), ("Lighting", picture.BLINN), ("Antialias", False)]:
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
