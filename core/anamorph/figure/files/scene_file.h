// SPDX-License-Identifier: Apache-2.0
// Figures for other programs: glTF 2.0 with their motion, OBJ, VTK's XML.
//
// A body is a sphere of cells, scaled, turned and moved: by default of 24 x 48, within 0.5 % of its half-axes
// from the ellipsoid, or, with a tolerance in units, of as many as hold it (surface_steps.h). Space becomes right-handed, z becoming -z.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// Frames as a binary glTF file (.glb): a node for each figure and in it one for each body, in metres, each 500 units
/// long. Between frames, positions and half-axes are interpolated linearly, rotations along the shortest arc. Colors
/// are those of the first frame. Throws Error where there are no frames, where frames have different bodies, and where
/// a number does not fit float, where the tolerance is not positive or asks for too many triangles. It holds in all frames.
std::string glb_file(std::span<const FigureFrame> frames, double frames_per_second,
                     std::optional<double> tolerance = {});

/// A frame as a Wavefront OBJ file: an object for each body, in units, with normals; colors stand behind the
/// points, as most programs read them. Throws Error where the tolerance is not positive or asks for too many triangles.
std::string obj_file(const FigureFrame& frame, std::optional<double> tolerance = {});

/// A frame as a .vtp file, VTK's XML of polygonal data, in ASCII: what vtkAnamorphFigureReader makes of it in double precision, a
/// point for each body with its arrays (vtk_filters/filters/figure_data.h), and joints and view as field data.
/// Programs without Anamorph read it as points. Names are UTF-8.
std::string vtp_file(const FigureFrame& frame);

}  // namespace anamorph::figure
