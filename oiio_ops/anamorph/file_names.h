// SPDX-License-Identifier: Apache-2.0
// The names of files that are opened at all, and the file that a name stands for.
#pragma once

#include <string>
#include <string_view>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// Checks a name of a file. Throws Error naming `key` where `name` is that of a pipe, a device or a folder,
/// which would be waited for; or an address (http://..., or any other scheme), which OpenImageIO may connect
/// to, unless the environment variable ANAMORPH_ALLOW_URLS is 1. A name that is none of a file may be one
/// that OpenImageIO makes pixels of, and passes.
void check_file_name(const std::string& key, const std::string& name);

/// A text that differs after each change of a file, whether it was written over or replaced; empty where
/// there is no file. It stays where a file is moved away and back, and where its time is set back.
std::string content_state(const std::string& name);
/// The same, which stays in neither case.
std::string file_state(const std::string& name);

/// Is the part before the first `?` a name that ends in `extension` (".pano"), in any case of letters?
bool has_extension(std::string_view name, std::string_view extension);

/// The operation whose recipes have such a name, or that draws files of such a name, or null.
const Operation* operation_of(std::string_view name);
/// Is it the name of a file that the operation draws as it stands?
bool ends_as_main_file(const Operation& operation, std::string_view name);

}  // namespace anamorph
