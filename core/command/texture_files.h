// SPDX-License-Identifier: Apache-2.0
// The pictures that a motion names, from files beside it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/figure/image/mrasel_maps.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/source.h"

namespace anamorph::command {

/// Reads the maps NAME.512, NAME.256, ..., NAME.1. Throws Error.
figure::MraselMaps read_maps(const std::string& name);

/// Textures in memory, with their pyramids.
class TextureFiles {
  public:
    /// Those of `names`: in the folder of `script` the maps that MTEXTURE makes of a name, or else a file of that name, or with
    /// the ending .png or .ppm.
    /// warn(what) hears of each that is not there or cannot be read.
    TextureFiles(const std::string& script, const std::vector<std::string>& names,
                 const std::function<void(const std::string& what)>& warn);

    /// Adds the picture of a file, .png or .ppm, behind those. Throws Error.
    void add(const std::string& file);

    /// In the order of their names, null where one is missing; then what add() added.
    const std::vector<const Source*>& sources() const { return m_sources; }

  private:
    struct Texture;
    struct Delete {
        void operator()(Texture* texture) const;
    };
    std::vector<std::unique_ptr<Texture, Delete>> m_textures;
    std::vector<const Source*> m_sources;
};

}  // namespace anamorph::command
