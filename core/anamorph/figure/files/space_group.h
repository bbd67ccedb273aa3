// SPDX-License-Identifier: Apache-2.0
// The operations of space groups by the groups' names, from the tables of gemmi (symmetry.hpp), which are those of the
// International Tables for Crystallography A.
#pragma once

#include <string>
#include <vector>

#include "anamorph/figure/files/cif_symmetry.h"

namespace anamorph::figure {

/// The names that a file gives its group; those that it does not give are empty.
struct SpaceGroupName {
    std::string hall;  ///< Hall symbol, such as `P 32 2"`; it says all
    std::string
        short_name;  ///< Hermann-Mauguin symbol, short or full, such as `P 32 2 1`, `P 21/c`, `F d -3 m :2`, `R -3 m H`
    std::string number;             ///< number in the International Tables, from 1 to 230
    double alpha = 90, gamma = 90;  ///< cell angles, degrees: they tell hexagonal from rhombohedral axes
};

struct SpaceGroup {
    std::vector<SymmetryOperation> operations;  ///< the first is x,y,z; none where the name is not known
    /// The setting that was taken, such as `F d -3 m :1`, where another origin is as usual and the name does
    /// not say which.
    std::string one_of_two;
};

/// Finds a group by the first that is given of the Hall symbol, the Hermann-Mauguin symbol and the number.
/// Where a number leaves the setting open it is the first of the tables: unique axis b, cell choice 1,
/// hexagonal axes where the cell has their angles.
SpaceGroup space_group(const SpaceGroupName& name);

}  // namespace anamorph::figure
