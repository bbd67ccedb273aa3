// SPDX-License-Identifier: Apache-2.0
// One lens of a database of Lensfun's, by its name, as a model of the core. It knows no host: the database may be any that Lensfun
// has loaded.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/size.h"

struct lfDatabase;

namespace anamorph {

/// What a text says of a lens, and else the metadata of a picture that was taken through it.
struct LensName {
    std::string text;  ///< for messages
    std::string maker, camera, lens;
    std::optional<double> focal, crop;
};

/// A lens as the core has it, of pictures of one size.
struct FoundLens {
    LensModel model;
    std::optional<Projection> projection;
    double focal_length = 0;  ///< of the picture without distortion, in pixels
    std::string name;         ///< what was found
};

/// Does a value name a lens of the database, as lensfun:lens=NAME does?
bool is_of_lens_database(std::string_view text);

/// Parses such a value; throws Error naming `parameter`.
LensName parse_lens_name(const std::string& parameter, const std::string& text);

/// The lens of a database that is asked for, of pictures of a size in pixels. Throws Error naming `parameter`, with names that are near
/// where there is no such lens, and where the database's numbers are those of none. It is there where Anamorph is built with Lensfun.
/// Searches write into the database: they must be one at a time.
FoundLens find_lens(const lfDatabase& database, const std::string& parameter, const LensName& asked,
                    const Size& size);

}  // namespace anamorph
