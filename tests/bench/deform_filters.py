#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphDeform on image data, rectilinear grids and surfaces, with bumps that have depth and frames, beside plain VTK.

A terrain of SIDE x SIDE points between 0 and 1 and 50 Gaussians, as in speed_vs_error --op deform. Rows: all computed anew, one bump of
the 50 edited, and with normals. Beside them VTK's own filters: vtkWarpVector, which moves points by vectors that stand in an array
already, so that it computes no bump (warp), and what makes such vectors first, vtkArrayCalculator with the sum as its formula
(calculator) and vtkTransformFilter with a vtkThinPlateSplineTransform of as many landmarks as bumps (spline), which is no sum of bumps
and has no error here. Errors are the largest of a coordinate, against the sum in long double; times are medians of whole updates, those of a
point of the processor.

Needs plain VTK (not ParaView's, which is built for debugging) and the module anamorph. Fails if a row of ours is off by more than it
may be."""
import argparse
import csv
import statistics
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkRectilinearGrid, vtkStructuredGrid
from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform
from vtkmodules.vtkFiltersCore import vtkArrayCalculator
from vtkmodules.vtkFiltersGeneral import vtkTransformFilter, vtkWarpVector

from anamorph import vtkAnamorphDeform

BUMPS, SEED = 50, 1
# Points are float: their step below 2, and what the filter proves of its sums, which is less.
MOST = 2.0 ** -23


def bumps(depth, frames):
    """Centre, extent, vector in rows; centre and extent in depth; quaternions."""
    random = np.random.default_rng(SEED)
    rows = np.concatenate([random.uniform(0, 1, (BUMPS, 2)), random.uniform(0.02, 0.08, (BUMPS, 2)),
                           random.uniform(-0.05, 0.05, (BUMPS, 2)), random.uniform(-0.2, 0.2, (BUMPS, 1))], 1)
    depths = np.stack([random.uniform(-0.2, 0.2, BUMPS), random.uniform(0.05, 0.2, BUMPS)], 1) if depth else None
    turns = random.normal(size=(BUMPS, 4)) if frames else None
    return rows, depths, turns


def matrix(q):
    w, x, y, z = q.astype(np.longdouble) / np.sqrt((q.astype(np.longdouble) ** 2).sum())
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def moved(points, kind, real=np.longdouble):
    """Eq. (4.1), with the third way of bumps that have depth."""
    rows, depths, turns = kind
    points = points.astype(real)
    out = points.copy()
    for k, row in enumerate(rows):
        way = points - np.array([*row[:2], depths[k][0] if depths is not None else 0], real)
        if turns is not None:
            way = way @ matrix(turns[k]).astype(real)
        own = way[:, :2] / row[2:4]
        squared = (own ** 2).sum(1)
        if depths is not None:
            squared += (way[:, 2] / depths[k][1]) ** 2
        out += np.exp(-squared)[:, None] * row[4:]
    return out


def image(side):
    data = vtkImageData()
    data.SetDimensions(side, side, 1)
    data.SetSpacing(1 / (side - 1), 1 / (side - 1), 1)
    return data


def rectilinear(side):
    data, axis = vtkRectilinearGrid(), np.linspace(0, 1, side) ** 1.25
    data.SetDimensions(side, side, 1)
    data.SetXCoordinates(numpy_to_vtk(axis.astype(np.float32), deep=True))
    data.SetYCoordinates(numpy_to_vtk(axis.astype(np.float32), deep=True))
    data.SetZCoordinates(numpy_to_vtk(np.zeros(1, np.float32), deep=True))
    return data


def sheet(side):
    """A structured grid that rises and falls."""
    data, points = vtkStructuredGrid(), vtkPoints()
    v, u = np.mgrid[0:side, 0:side] / (side - 1)
    at = np.stack([u, v, 0.2 * np.sin(7 * u) * np.cos(5 * v)], -1).reshape(-1, 3).astype(np.float32)
    points.SetData(numpy_to_vtk(at, deep=True))
    data.SetDimensions(side, side, 1)
    data.SetPoints(points)
    return data


def points_of(data):
    if isinstance(data, vtkImageData):
        i, j = np.mgrid[0:data.GetDimensions()[1], 0:data.GetDimensions()[0]]
        return np.stack([j * data.GetSpacing()[0], i * data.GetSpacing()[1], i * 0.0], -1).reshape(-1, 3)
    if isinstance(data, vtkRectilinearGrid):
        y, x = np.meshgrid(vtk_to_numpy(data.GetYCoordinates()), vtk_to_numpy(data.GetXCoordinates()), indexing="ij")
        return np.stack([x, y, x * 0], -1).reshape(-1, 3).astype(float)
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def ours(data, kind, normals):
    rows, depths, turns = kind
    deform = vtkAnamorphDeform()
    deform.rows = rows
    deform.SetInputData(data)
    deform.SetAutomaticPlane(False)
    deform.SetOutputPointsPrecision(deform.SINGLE_PRECISION)
    deform.SetComputeNormals(normals)
    for k, row in enumerate(rows):
        deform.AddDeformation(*row)
        if depths is not None:
            deform.SetDepth(k, *depths[k])
        if turns is not None:
            deform.SetOrientation(k, *turns[k])
    return deform


def warp(data, vectors):
    shown = data.NewInstance()
    shown.ShallowCopy(data)
    array = numpy_to_vtk(vectors, deep=True)
    array.SetName("way")
    shown.GetPointData().SetVectors(array)
    filter_ = vtkWarpVector()
    filter_.SetInputData(shown)
    return filter_


def calculator(data, kind):
    """Bumps without depth."""
    terms = {axis: "+".join(f"({row[4 + axis]!r})*exp(-((coordsX-{row[0]!r})/{row[2]!r})^2-((coordsY-{row[1]!r})/{row[3]!r})^2)"
                            for row in kind[0].tolist()) for axis in range(3)}
    vectors, filter_ = vtkArrayCalculator(), vtkWarpVector()
    vectors.SetInputData(data)
    for axis, name in enumerate(("coordsX", "coordsY")):
        vectors.AddCoordinateScalarVariable(name, axis)
    vectors.SetFunction(f"({terms[0]})*iHat+({terms[1]})*jHat+({terms[2]})*kHat")
    vectors.SetResultArrayName("way")
    filter_.SetInputConnection(vectors.GetOutputPort())
    filter_.SetInputArrayToProcess(0, 0, 0, 0, "way")
    filter_.first = vectors
    return filter_


def spline(data, kind):
    sources, targets, transform, filter_ = vtkPoints(), vtkPoints(), vtkThinPlateSplineTransform(), vtkTransformFilter()
    for row in kind[0]:
        sources.InsertNextPoint(row[0], row[1], 0)
        targets.InsertNextPoint(row[0] + row[4], row[1] + row[5], row[6])
    transform.SetSourceLandmarks(sources)
    transform.SetTargetLandmarks(targets)
    transform.SetBasisToR2LogR()
    filter_.SetInputData(data)
    filter_.SetTransform(transform)
    return filter_


def seconds(filter_, rounds, touch):
    """On the wall, and of the processor, all threads together."""
    times = []
    for i in range(rounds):
        touch(filter_, i)
        begin = time.perf_counter(), time.process_time()
        filter_.Update()
        times.append((time.perf_counter() - begin[0], time.process_time() - begin[1]))
    return [statistics.median(each) for each in zip(*times)]


def anew(filter_, i):
    """All of the list is another, so that every bump is computed."""
    if isinstance(filter_, vtkAnamorphDeform):
        for k, row in enumerate(filter_.rows):
            filter_.SetDeformation(k, *row[:4], *(row[4:] * (1 + i % 2)))
    else:
        getattr(filter_, "first", filter_).Modified()


def edit(filter_, i):
    row = filter_.rows[7]
    filter_.SetDeformation(7, *row[:6], row[6] * (1 + i % 2))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--csv", help="a file for the table")
    arguments = parser.parse_args()
    count, rows, failed = arguments.side ** 2, [], False

    def report(case, scheme, filter_, touch, truth=None):
        nonlocal failed
        filter_.Update()
        off = np.abs(points_of(filter_.GetOutputDataObject(0)) - truth).max() if truth is not None else None
        wall, spent = seconds(filter_, 1 if scheme == "calculator" else arguments.rounds, touch)
        rows.append({"case": case, "scheme": scheme, "ms": 1e3 * wall, "processor_ms": 1e3 * spent, "ns_per_point": 1e9 * spent / count,
                     "worst": "" if off is None else float(off)})
        print(f"{case:12} {scheme:16} {1e3 * wall:9.2f} ms {1e3 * spent:9.2f} of the processor {1e9 * spent / count:9.2f} ns a point"
              + ("" if off is None else f"   worst {float(off):.2e}"), flush=True)
        failed = failed or (off is not None and scheme.startswith("deform") and not off <= MOST)

    for case, data, kind in (("image", image(arguments.side), bumps(False, False)),
                             ("rectilinear", rectilinear(arguments.side), bumps(False, False)),
                             ("surface", sheet(arguments.side), bumps(False, False)),
                             ("depth", sheet(arguments.side), bumps(True, False)),
                             ("frames", sheet(arguments.side), bumps(True, True))):
        points = points_of(data)
        truth = moved(points, kind)
        report(case, "deform", ours(data, kind, False), anew, truth)
        report(case, "deform, edit", ours(data, kind, False), edit)
        report(case, "deform, normals", ours(data, kind, True), anew, truth)
        report(case, "warp", warp(data, (truth - points).astype(np.float32)), anew, truth)
        if kind[1] is None:
            report(case, "calculator", calculator(data, kind), anew, truth)
        if case == "surface":
            report(case, "spline", spline(data, kind), anew)
    if arguments.csv:
        with open(arguments.csv, "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    if failed:
        sys.exit("a point is off by more than it may be")


if __name__ == "__main__":
    main()
