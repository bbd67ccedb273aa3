// SPDX-License-Identifier: Apache-2.0
// Images that stay in memory under a name, NAME.anabuf: written by one output of a process, read by its
// inputs.
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <cstdint>
#include <memory>
#include <string>

#include "content.h"

namespace anamorph {

/// Puts an image in the place of one of the same name. `name` may be the temporary one that hosts write to
/// before they rename (NAME.XXXXXXXX.temp.anabuf).
void store_buffer(const std::string& name, std::shared_ptr<const OIIO::ImageBuf> image);

/// The number of times that a name was stored.
std::int64_t buffer_generation(const std::string& name);

/// Opens a stored image. Throws Error when nothing was stored under the name.
std::shared_ptr<const Content> open_buffer(const std::string& name);

}  // namespace anamorph
