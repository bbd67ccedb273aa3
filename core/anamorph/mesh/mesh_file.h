// SPDX-License-Identifier: Apache-2.0
// Warps from text and from ST-maps. The core opens no files: a host hands over what it has read, and a name
// for messages. All functions throw Error: one line that names the file and the entry.
//
// A mesh in JSON (positions as in mesh_data.h; keys in any order, others are refused):
//
//     {
//       "direction": "pull",        pull (the default): vertices in the target say where in the source they
//                                   come from; push: vertices in the source say where in the target they go
//       "units": "pixels",          pixels (the default) or fractions
//       "columns": 2, "rows": 1,    cells
//       "vertices": [[0, 0], [99.5, 4], [200, 0],  [0, 100], [101, 96], [200, 100]],
//                                   (columns + 1) (rows + 1) positions, row by row from the top left
//       "x": [0, 100, 200],         optional: where the lines stand, ascending; else evenly, edge to edge
//       "y": [0, 100],
//       "levels": [                 optional: cells subdivided into four, level by level
//         {"cells": [[1, 0]],       column and row of cells of the level above (here: of the mesh itself)
//          "vertices": [[3, 1, 151, 52]]}    column and row on the lattice of this level (here: 5 x 3), and
//       ]                                    the position
//     }
//
// Pairs of points in JSON, x, y in the target and u, v in the source:
//
//     {"units": "pixels", "points": [[x, y, u, v], ...]}
//
// and in CSV, in pixels: one pair x,y,u,v a line; empty lines and lines that start with # are passed over,
// and so is a first line that names the columns (x,y,u,v).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/mesh/mesh_data.h"

namespace anamorph {

/// Reads a mesh or pairs of points, whichever the JSON text holds ("vertices" or "points").
WarpMap parse_mesh_json(std::string_view text, std::string_view name);
/// Reads pairs of points in the CSV format described above.
WarpMap parse_points_csv(std::string_view text, std::string_view name);
/// Reads a warp in the format that the ending of the name says: CSV for .csv, else JSON.
WarpMap parse_warp_file(std::string_view text, std::string_view name);
/// Writes a mesh as JSON that parse_mesh_json() reads: the same numbers, to the bit. Throws Error where it is an ST-map's, which
/// is an image and no text, or has a number that is not finite.
std::string mesh_json(const ControlMesh& mesh);

/// The most pixels of an ST-map that may be vertices.
inline constexpr int kMostStMapVertices = 1 << 28;
/// The most pixels of an ST-map either way.
inline constexpr int kMostStMapSide = 1 << 20;

/// Makes a pull mesh from an ST-map: pixel (i, j) of an image of width x height says where in the source the centre
/// of that pixel (of an image that covers the target) comes from, as fractions (u right, v down, edge to
/// edge). `uv` points at u of pixel (0, 0); v stands behind u, pixels `pixel_stride` and rows `row_stride`
/// floats apart. Every `step`-th pixel is taken, and the last of each row and column; 1 takes all. With `v_up` v goes
/// up, from 0 at the lower edge.
WarpMap mesh_from_stmap(const float* uv, int width, int height, std::ptrdiff_t pixel_stride,
                        std::ptrdiff_t row_stride, int step, std::string_view name, bool v_up = false);
/// Makes a pull mesh from every pixel of an ST-map of two channels, without gaps, which it keeps. A pixel whose u or v
/// is not a finite number is a hole. Throws Error where all are.
WarpMap mesh_from_stmap(std::vector<float> uv, int width, int height, std::string_view name,
                        bool v_up = false);

}  // namespace anamorph
