// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformation_entry.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

/// The image of a bump: u (or v) is mirrored in parameters, depths stay, and so does which side is the front. Of the frame, the mirrored
/// axes are the turn by the opposite angle about the two axes that change (r^2 does not know which way an axis goes).
Deformation image_of(const DeformationEntry& entry, const MirrorSteps& steps) {
    Deformation image = entry.deformation;
    const bool across = entry.mirror == DeformationMirror::u;
    double& center = across ? image.center.x : image.center.y;
    center = 2 * entry.mirror_at - center;
    const glm::dvec3 step = across ? steps.step_u : steps.step_v,
                     gradient = across ? steps.gradient_u : steps.gradient_v;
    image.vector -= 2 * glm::dot(gradient, image.vector) * step;
    glm::dvec4& q = image.orientation;
    q.w = -q.w;
    (across ? q.z : q.y) *= -1;
    return image;
}

}  // namespace

void check_deformation_name(std::string_view name) {
    const auto is_bad = [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == ',' || c == '"';
    };
    const bool blank = !name.empty() && (name.front() == ' ' || name.back() == ' ');
    if (name.size() > kMostNameBytes || blank || std::any_of(name.begin(), name.end(), is_bad))
        throw Error(
            "name", text_file::excerpt(name),
            "must be at most " + std::to_string(kMostNameBytes) +
                " bytes, without commas, quotes and control characters, and without blanks at its ends");
}

void check_entry(const DeformationEntry& entry) {
    check_deformation(entry.deformation);
    check_deformation_name(entry.name);
    if (!std::isfinite(entry.mirror_at))
        throw Error("mirror_at", shortest(entry.mirror_at), "must be a finite number");
    if (entry.mirror == DeformationMirror::none) return;
    const glm::dvec2 c = entry.deformation.center;
    if (!std::isfinite(2 * entry.mirror_at - (entry.mirror == DeformationMirror::u ? c.x : c.y)))
        throw Error("mirror_at", shortest(entry.mirror_at),
                    "the centre of the image must be a finite number");
}

DeformationsWithImages with_images(const std::vector<DeformationEntry>& entries, const MirrorSteps& steps) {
    DeformationsWithImages all;
    for (const DeformationEntry& entry : entries) {
        check_entry(entry);
        all.entry.push_back(all.list.size());
        all.list.push_back(entry.deformation);
    }
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (entries[i].mirror == DeformationMirror::none) continue;
        const Deformation image = image_of(entries[i], steps);
        if (image == entries[i].deformation) continue;
        check_deformation(image);
        all.list.push_back(image);
        all.entry.push_back(i);
    }
    return all;
}

}  // namespace anamorph
