# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphPanoramaView in pipelines: times, pieces, odd inputs, progress and abort, and what filters behind it are told.
import math

import numpy as np
from conformance import Source, errors_of, picture, pixels, steps_of, time_of
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR, vtkSOADataArrayTemplate, vtkWeakReference
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkMultiBlockDataSet, vtkTable
from vtkmodules.vtkImagingCore import vtkImageFlip

import anamorph

WIDTH, HEIGHT = 30, 20


def view_of(given=None, size=(WIDTH, HEIGHT)):
    """Down to the left, over the panorama's pole."""
    view = anamorph.vtkAnamorphPanoramaView()
    view.SetViewSize(*size)
    view.SetYaw(170)
    view.SetPitch(-70)
    view.SetViewAngle(100)
    if isinstance(given, vtkDataObject):
        view.SetInputDataObject(given)
    elif given:
        view.SetInputConnection(given.GetOutputPort())
    return view


def seen(given):
    view = view_of(given)
    view.Update()
    return pixels(view.GetOutput())


def pieces_are_the_whole():
    whole = seen(picture())
    assert len(np.unique(whole)) > 50
    for count in (2, 3, 7):
        union = np.full_like(whole, np.nan)
        for piece in range(count):
            view = view_of(picture())
            view.UpdatePiece(piece, count, 0)
            x0, x1, y0, y1, _, _ = view.GetOutput().GetExtent()
            assert (x1 - x0 + 1) * (y1 - y0 + 1) < WIDTH * HEIGHT, "a part"
            union[y0:y1 + 1, x0:x1 + 1] = pixels(view.GetOutput())
        assert (union == whole).all(), count
    nothing = view_of(picture())
    assert errors_of(nothing, lambda: nothing.UpdateExtent([0, -1, 0, -1, 0, -1])) == ""
    assert nothing.GetOutput().GetNumberOfPoints() == 0


def time_is_passed():
    source = Source(lambda time: picture(1 + time), (0.0, 1.0, 2.0))
    view = view_of(source)
    assert steps_of(view) == [0, 1, 2]
    for time in (2.0, 1.0):
        view.UpdateTimeStep(time)
        assert time_of(view.GetOutput()) == time
        assert (pixels(view.GetOutput()) == seen(picture(1 + time))).all()
    view.UpdateTimeStep(1.0)
    assert [asked[0] for asked in source.asked] == [2, 1], "once for each time"


def odd_inputs_are_named_and_it_goes_on():
    bare, many = vtkImageData(), vtkImageData()
    bare.SetDimensions(4, 2, 1)
    many.SetDimensions(4, 2, 1)
    many.AllocateScalars(VTK_UNSIGNED_CHAR, 5)
    short = picture()
    short.GetPointData().GetScalars().SetNumberOfTuples(7)
    assert "port 0" in errors_of(view_of())
    assert "vtkImageData is required" in errors_of(view_of(vtkTable()))
    for image, said in ((vtkImageData(), "the panorama has no pixels"), (bare, "has no point array"), (short, "has no point array"),
                        (many, "has 5 components, but must have 1 to 4"), (picture(kind=np.float64), "of type double, but must be"),
                        (picture(kind=np.int32), "of type int, but must be")):
        view = view_of(image)
        assert said in errors_of(view), said
        assert view.GetOutput().GetNumberOfPoints() == 0 and view.GetMaxError() == 0
        view.SetInputDataObject(picture())
        assert errors_of(view) == "" and (pixels(view.GetOutput()) == seen(picture())).all()
    for name, said in (("Yaw", "yaw"), ("Pitch", "pitch"), ("Roll", "roll"), ("ViewAngle", "fov"), ("Tolerance", "tol"),
                       ("FieldOfView", "srcfov"), ("PanniniDistance", "srcd"), ("VerticalFieldOfView", "srcvfov"),
                       ("ProjectionAlpha", "srce")):
        view = view_of(picture())
        getattr(view, "Set" + name)(math.nan)
        assert said + "=nan: must be" in errors_of(view), name


def where_an_image_begins_is_its_own_matter():
    image, plain = picture(), seen(picture())
    image.SetExtent(3, 66, -5, 26, 7, 7)
    image.SetOrigin(1, 2, 3)
    image.SetSpacing(4, 5, 6)
    before = pixels(image).copy()
    view = view_of(image)
    view.Update()
    assert (pixels(view.GetOutput()) == plain).all()
    assert view.GetOutput().GetSpacing() == (1, 1, 1) and view.GetOutput().GetOrigin() == (0, 0, 0)
    assert (pixels(image) == before).all() and image.GetExtent() == (3, 66, -5, 26, 7, 7)


def arrays_of_any_layout_are_read():
    for name, kind in (("uint8", np.uint8), ("uint16", np.uint16), ("float32", np.float32)):
        image = picture(kind=kind)
        numbers, apart = image.GetPointData().GetScalars(), vtkSOADataArrayTemplate[name]()
        apart.SetNumberOfComponents(1)
        apart.SetNumberOfTuples(numbers.GetNumberOfTuples())
        for i in range(numbers.GetNumberOfTuples()):
            apart.SetTuple(i, numbers.GetTuple(i))
        assert not apart.HasStandardMemoryLayout()
        image.GetPointData().SetScalars(apart)
        assert (seen(image) == seen(picture(kind=kind))).all(), name


def what_is_not_finite_stays_where_it_is():
    image, plain = picture(), seen(picture())
    for at, value in ((5, math.nan), (64 * 5 + 7, math.inf)):
        image.GetPointData().GetScalars().SetValue(at, value)
    there = seen(image)
    odd = ~np.isfinite(there)
    assert 0 < odd.sum() < 20 and (there == plain)[~odd].all(), odd.sum()


def blocks_are_viewed_one_by_one():
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, picture())
    blocks.SetBlock(2, picture(3))
    view = view_of(blocks)
    view.Update()
    out = view.GetOutputDataObject(0)
    assert (pixels(out.GetBlock(0)) == seen(picture())).all() and (pixels(out.GetBlock(2)) == seen(picture(3))).all()
    assert out.GetBlock(1) is None


def filters_behind_it_know_its_numbers():
    for kind, wanted in ((np.uint8, VTK_UNSIGNED_CHAR), (np.float32, VTK_FLOAT)):
        flip, view = vtkImageFlip(), view_of(picture(kind=kind))
        flip.SetInputConnection(view.GetOutputPort())
        flip.SetFilteredAxis(1)
        flip.Update()
        assert flip.GetOutput().GetScalarType() == wanted
        assert (pixels(flip.GetOutput()) == seen(picture(kind=kind))[::-1]).all()


def progress_rises_to_1_and_abort_leaves_nothing():
    view, reports = view_of(picture(), (300, 300)), []
    view.AddObserver("ProgressEvent", lambda caller, event: reports.append(caller.GetProgress()))
    view.Update()
    assert len(reports) > 2 and reports == sorted(reports) and reports[-1] == 1, reports
    whole = pixels(view.GetOutput()).copy()
    tag = view.AddObserver("ProgressEvent", lambda caller, event: caller.SetAbortExecute(1) if caller.GetProgress() > 0.1 else None)
    view.Modified()
    assert errors_of(view) == "", "a wish is no error"
    assert view.GetOutput().GetNumberOfPoints() == 0 and view.GetMaxError() == 0
    view.RemoveObserver(tag)
    view.SetAbortExecute(0)
    view.Modified()
    view.Update()
    assert (pixels(view.GetOutput()) == whole).all()


def values_count_once_and_are_printed():
    view = view_of(picture())
    for name, value in (("Projection", 2), ("FieldOfView", 123.5), ("PanniniDistance", 0.25), ("Lens", "brown:k1=0.125"), ("Yaw", 11.5),
                        ("VerticalFieldOfView", 90.5), ("ProjectionAlpha", 0.75), ("Keys", "filter=bicubic"),
                        ("Pitch", 12.5), ("Roll", 13.5), ("ViewAngle", 14.5), ("ViewSize", (15, 16)), ("Tolerance", 0.0625)):
        before = view.GetMTime()
        getattr(view, "Set" + name)(value)
        after = view.GetMTime()
        assert after > before, name
        getattr(view, "Set" + name)(value)
        assert view.GetMTime() == after and getattr(view, "Get" + name)() == value, name
        printed = "rectilinear" if name == "Projection" else "15 16" if name == "ViewSize" else str(value)
        assert name + ": " + printed in str(view), name
    made = view.GetMTime()
    view.Update()
    assert view.GetMTime() == made, "it executes without being modified"
    executions = []
    view.AddObserver("StartEvent", lambda caller, event: executions.append(event))
    view.Update()
    assert executions == []
    view.SetYaw(20)
    view.Update()
    assert len(executions) == 1


def nothing_stays():
    image = picture()
    view, left = view_of(image), [vtkWeakReference() for _ in range(3)]
    view.Update()
    for reference, each in zip(left, (view, view.GetOutput(), image)):
        reference.Set(each)
    del view, image, each
    assert all(reference.Get() is None for reference in left)


pieces_are_the_whole()
time_is_passed()
odd_inputs_are_named_and_it_goes_on()
where_an_image_begins_is_its_own_matter()
arrays_of_any_layout_are_read()
what_is_not_finite_stays_where_it_is()
blocks_are_viewed_one_by_one()
filters_behind_it_know_its_numbers()
progress_rises_to_1_and_abort_leaves_nothing()
values_count_once_and_are_printed()
nothing_stays()
