// SPDX-License-Identifier: Apache-2.0
// Motions and figures of other programs, as frames of ellipsoids.
//
// BVH (Biovision hierarchy; .bvh): a bone, from a joint to the next, is an ellipsoid along it; the file's
// frames are numbered from 1, and frame 0 is the skeleton at rest. The whole motion is moved and scaled into
// the window of 1000 units.
//
// CIF (crystallographic information file; .cif): the atoms of the first structure, in one frame, and where the
// file lists operations of symmetry, or else names a space group (space_group.h), all that these make of them in a
// cell (cif_symmetry.h; of a modulated structure, the average one), as ellipsoids of anisotropic displacement that hold the atom with a probability
// that is given, of 1/2 by default, spheres where displacement is isotropic, and small spheres where none is given. Joints are bonds:
// where two atoms are closer than their covalent radii (Cordero et al. 2008) and 0.4 Angstrom together.
//
// Frames as the original programs print them (.3; frame_file.h), and the one that MRASEL draws (.mrasel;
// mrasel_file.h).
//
// Right-handed coordinates are mirrored to those of frame.h, z becoming -z.
#pragma once

#include <memory>
#include <string_view>

#include "anamorph/figure/body/motion.h"

namespace anamorph::figure {

/// Does a file's name end like that of a file of frames (.bvh, .cif, .3, .mrasel), in lower or upper case?
bool is_motion_file(std::string_view name);

/// Reads the text of a file in the format that the ending of its name says, .3 for any other. Throws Error naming the
/// file and the line or entry.
/// `probability`: that of the ellipsoids of a .cif.
std::unique_ptr<Motion> read_motion(std::string_view text, std::string_view name, double probability = 0.5);

/// Reads the text of a BVH file, whatever its name. Throws Error naming the file and the line.
std::unique_ptr<Motion> read_bvh(std::string_view text, std::string_view name);
/// Reads the text of a CIF file, whatever its name. Throws Error naming the file and the entry.
std::unique_ptr<Motion> read_cif(std::string_view text, std::string_view name, double probability = 0.5);

}  // namespace anamorph::figure
