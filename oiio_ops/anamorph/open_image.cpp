// SPDX-License-Identifier: Apache-2.0
#include "anamorph/open_image.h"

#include <string_view>

namespace anamorph {
namespace {

constexpr bool kLocksItself = OIIO_VERSION >= OIIO_MAKE_VERSION(2, 4, 9);

bool is_recipe(const std::string& name) {
    const std::unique_ptr<OIIO::ImageInput> reader = OIIO::ImageInput::create(name);
    if (!reader) static_cast<void>(OIIO::geterror());  // whoever opens it says that
    return reader && std::string_view(reader->format_name()) == "anamorph_recipes";
}

std::mutex& opening_mutex() {
    static std::mutex mutex;
    return mutex;
}

}  // namespace

OpeningLock::OpeningLock(const std::string& name) {
    if (!kLocksItself && !is_recipe(name)) m_lock = std::unique_lock(opening_mutex());
}

std::unique_ptr<OIIO::ImageInput> open_image(const std::string& name, const OIIO::ImageSpec* config) {
    const OpeningLock lock(name);
    return OIIO::ImageInput::open(name, config);
}

}  // namespace anamorph
