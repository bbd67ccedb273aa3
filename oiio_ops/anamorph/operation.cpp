// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation.h"

#include <algorithm>

namespace anamorph {

std::string operation_key(const OperationKind& kind, const ParameterValues& values,
                          const std::vector<SourceImage>& images, const SideFiles& files) {
    std::string key = kind.name + "\n" + values.key(kind.sources);
    for (const SourceImage& image : images) {
        const SourceFacts& facts = image.facts;
        key += std::to_string(facts.width) + "x" + std::to_string(facts.height) + " " +
               std::to_string(image.channels) + " \"" + image.color_space + "\" ";
        if (facts.projection) key += std::string(name_of(*facts.projection)) + " as " + facts.said_by;
        if (facts.fov) key += " fov=" + shortest(*facts.fov);
        key += "\n";
    }
    for (const auto& [name, file] : files)
        if (std::find(kind.sources.begin(), kind.sources.end(), name) == kind.sources.end())
            key += name + "=" + file.name + "\n" + file.identity + "\n";
    return key;
}

}  // namespace anamorph
