// SPDX-License-Identifier: Apache-2.0
// What filters that move points take: point sets, and grids whose points are implied by their axes, which come
// out as structured grids, as those of vtkWarpScalar and vtkWarpVector do.
#pragma once

#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkDataObject;
class vtkInformation;
class vtkPointSet;

namespace anamorph_vtk {

/// Appends the types that make_output_of_points() takes to those of an input port, and any other type after them, so
/// that these are refused in words of ours. The composite comes first: the pipeline leaves its leaves to the filter.
void require_points(vtkInformation* port);

/// Sees to it, in RequestDataObject(), that an output is of the class that `input` becomes: point sets and trees of data
/// stay what they are, image data and rectilinear grids become vtkStructuredGrid, and AMR vtkMultiBlockDataSet. Throws
/// anamorph::Error on other types, which it names together with the input.
void make_output_of_points(vtkInformation* output, vtkDataObject* input, const char* name);

/// The data, with AMR as a vtkMultiBlockDataSet of its levels, whose blocks are shared.
vtkSmartPointer<vtkDataObject> without_levels(vtkDataObject* data);

/// A new data set of the class that moved points of `data` are in; null if it has no points that can be moved.
vtkSmartPointer<vtkPointSet> new_point_set_like(vtkDataObject* data);

/// The data set itself if it is a point set. Image data and rectilinear grids with explicit points, as a structured
/// grid of the same extent that shares their arrays, blanked and ghost ones too: points are float where all axes of a
/// rectilinear grid are, else double. Null if there are no points that can be moved. Throws anamorph::Error on grids
/// of 2^31 points or more and on axes that are too short.
vtkSmartPointer<vtkPointSet> with_explicit_points(vtkDataObject* data);

/// When a leaf was last modified, axes of a rectilinear grid counted.
vtkMTimeType time_of_points(vtkDataObject* data);

}  // namespace anamorph_vtk
