// SPDX-License-Identifier: Apache-2.0
// Bumps as users list them: with names, and with mirror images that are made when the list is used.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/deform/deformation.h"

namespace anamorph {

/// Whether a bump has an image on the other side of a line: of u = mirror_at, or of v = mirror_at.
enum class DeformationMirror { none, u, v };

/// One line of a list: a bump, what it is called, and its image.
struct DeformationEntry {
    Deformation deformation;
    std::string name;  ///< need not be the only one of that name; may be empty
    DeformationMirror mirror = DeformationMirror::none;
    double mirror_at = 0;

    DeformationEntry() = default;
    /// An entry without name and image.
    DeformationEntry(const Deformation& bump) : deformation(bump) {}
    bool operator==(const DeformationEntry&) const = default;
};

/// The most bytes of a name.
inline constexpr std::size_t kMostNameBytes = 100;

/// Checks a name: at most kMostNameBytes bytes, no control characters, commas and quotes, and no blanks at its ends. Throws Error.
void check_deformation_name(std::string_view name);
/// Checks an entry as check_deformation(), its name, and that mirror_at and the image are finite. Throws Error.
void check_entry(const DeformationEntry& entry);

/// How space is mirrored where u, or v, is: V becomes V - 2 (gradient . V) step, where a step is 1 in that parameter and 0 in the
/// other. The standard is that of x and y.
struct MirrorSteps {
    glm::dvec3 step_u{1, 0, 0}, gradient_u{1, 0, 0}, step_v{0, 1, 0}, gradient_v{0, 1, 0};
};

/// Bumps with their images: first those of all entries in their order, then the images. A bump that is its own image has none.
struct DeformationsWithImages {
    std::vector<Deformation> list;
    std::vector<std::size_t> entry;  ///< the entry that each is of
};
/// Makes the images of a list. Throws Error on entries that check_entry() refuses.
DeformationsWithImages with_images(const std::vector<DeformationEntry>& entries,
                                   const MirrorSteps& steps = {});

}  // namespace anamorph
