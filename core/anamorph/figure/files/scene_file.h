// SPDX-License-Identifier: Apache-2.0
// Figures for other programs: glTF 2.0 with their motion, OBJ, VTK's XML.
//
// A body is a sphere of 24 x 48 cells, scaled, turned and moved; its cells are within 0.5 % of its half-axes
// from the ellipsoid. Space becomes right-handed, z becoming -z.
#pragma once

#include <span>
#include <string>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// Frames as a binary glTF file (.glb): a node for each figure and in it one for each body, in metres, each 500 units
/// long. Between frames, positions and half-axes are interpolated linearly, rotations along the shortest arc. Colors
/// are those of the first frame. Throws Error where there are no frames, where frames have different bodies, and where
/// a number does not fit float.
std::string glb_file(std::span<const FigureFrame> frames, double frames_per_second);

/// A frame as a Wavefront OBJ file: an object for each body, in units, with normals; colors stand behind the
/// points, as most programs read them.
std::string obj_file(const FigureFrame& frame);

/// A frame as a .vtp file, VTK's XML of polygonal data, in ASCII: what vtkAnamorphFigureReader makes of it in double precision, a
/// point for each body with its arrays (vtk_filters/filters/figure_data.h), and joints and view as field data.
/// Programs without Anamorph read it as points. Names are UTF-8.
std::string vtp_file(const FigureFrame& frame);

}  // namespace anamorph::figure
