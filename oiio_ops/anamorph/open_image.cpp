// SPDX-License-Identifier: Apache-2.0
#include "anamorph/open_image.h"

#include "anamorph/file_names.h"

namespace anamorph {
namespace {

constexpr bool kLocksItself = OIIO_VERSION >= OIIO_MAKE_VERSION(2, 4, 9);

std::mutex& opening_mutex() {
    static std::mutex mutex;
    return mutex;
}

}  // namespace

OpeningLock::OpeningLock(const std::string& name) {
    if (!kLocksItself && !operation_of(name)) m_lock = std::unique_lock(opening_mutex());
}

std::unique_ptr<OIIO::ImageInput> open_image(const std::string& name, const OIIO::ImageSpec* config) {
    const OpeningLock lock(name);
    return OIIO::ImageInput::open(name, config);
}

}  // namespace anamorph
