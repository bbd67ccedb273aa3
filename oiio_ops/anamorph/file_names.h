// SPDX-License-Identifier: Apache-2.0
// Which names of files are opened at all, and which file a name stands for.
#pragma once

#include <string>

namespace anamorph {

/// Throws Error naming `key` where `name` is that of a pipe, a device or a folder, which would be waited for;
/// or an address (http://..., or any other scheme), which OpenImageIO may connect to, unless the environment
/// variable ANAMORPH_ALLOW_URLS is 1. A name that is none of a file may be one that OpenImageIO makes pixels
/// of, and passes.
void check_file_name(const std::string& key, const std::string& name);

/// Another text after each change of a file, whether it was written over or replaced; empty where there is none.
std::string file_state(const std::string& name);

}  // namespace anamorph
