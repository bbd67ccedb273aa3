// SPDX-License-Identifier: Apache-2.0
#include "text_of_file.h"

#include <fstream>

#include "anamorph/error.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph_vtk {

using anamorph::Error;

std::string text_of_file(const std::string& name) {
    std::ifstream file(name, std::ios::binary | std::ios::ate);
    if (!file) throw Error(name + ": cannot be read");
    const std::streamoff size = file.tellg();
    if (size < 0 || static_cast<std::size_t>(size) > anamorph::text_file::kMostBytes)
        throw Error(name + ": must be at most " + std::to_string(anamorph::text_file::kMostBytes) +
                    " bytes long");
    std::string text(static_cast<std::size_t>(size), '\0');
    file.seekg(0);
    if (!file.read(text.data(), size)) throw Error(name + ": cannot be read");
    return text;
}

}  // namespace anamorph_vtk
