// SPDX-License-Identifier: Apache-2.0
// Crystals: what the operations of a space group make of the atoms that a file lists.
//
// Places are fractions of the cell. Atoms of the asymmetric unit that are bonded, across borders of the cell as
// well, are a molecule. Molecules with an atom as it is listed stay where that is; of each other one the image
// whose middle lies in the cell is taken. Where bonds go on from cell to cell without end, every atom has its
// image in the cell.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

namespace anamorph::figure {

/// A symmetry operation: p becomes turn p + shift.
struct SymmetryOperation {
    glm::dmat3 turn{1.0};
    glm::dvec3 shift{0.0};

    glm::dvec3 operator()(const glm::dvec3& p) const { return turn * p + shift; }
};

/// Reads `-x,1/2+y,-z`: three sums of x, y, z and numbers. Throws Error where it is none, or changes volumes.
SymmetryOperation symmetry_operation(std::string_view text);

/// An atom's image under an operation.
struct CrystalSite {
    std::size_t atom = 0, operation = 0;
    glm::dvec3 place{0.0};
};
/// Two sites, the first before the second.
struct CrystalBond {
    std::size_t first = 0, second = 0;
};
struct Crystal {
    std::vector<CrystalSite> sites;
    std::vector<CrystalBond> bonds;
};

/// The most sites and bonds that are made.
struct CrystalLimits {
    std::size_t sites = 0, bonds = 0;
};

/// The contents of a cell. `places`: of the atoms; of operations the first is x,y,z; `cell` takes places to
/// Angstrom. Atoms are bonded that are closer than their `radii` together; one of radius 0 has no bond. Throws
/// Error where there are more sites or bonds than `limits` says.
Crystal crystal_of(const std::vector<glm::dvec3>& places, const std::vector<double>& radii,
                   const std::vector<SymmetryOperation>& operations, const glm::dmat3& cell,
                   const CrystalLimits& limits);

}  // namespace anamorph::figure
