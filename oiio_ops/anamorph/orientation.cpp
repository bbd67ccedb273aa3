// SPDX-License-Identifier: Apache-2.0
#include "anamorph/orientation.h"

#include <cstring>
#include <utility>

#include "anamorph/image_source.h"

namespace anamorph {

StoredOrder::StoredOrder(int orientation) {
    swaps = orientation >= 5 && orientation <= 8;
    mirrors_x = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    mirrors_y = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
}

Size StoredOrder::upright_size(const Size& stored) const {
    return swaps ? Size{stored.height, stored.width} : stored;
}

void StoredOrder::mirror(Box& box, const Size& stored) const {
    if (mirrors_x) box = {stored.width - box.x1, box.y0, stored.width - box.x0, box.y1};
    if (mirrors_y) box = {box.x0, stored.height - box.y1, box.x1, stored.height - box.y0};
}

Box StoredOrder::stored_box(const Box& upright, const Size& stored) const {
    Box box = swaps ? Box{upright.y0, upright.x0, upright.y1, upright.x1} : upright;
    mirror(box, stored);
    return box;
}

Box StoredOrder::upright_box(const Box& box, const Size& stored) const {
    Box upright = box;
    mirror(upright, stored);
    return swaps ? Box{upright.y0, upright.x0, upright.y1, upright.x1} : upright;
}

void StoredOrder::turn(const std::byte* from, std::byte* to, int width, int height, std::ptrdiff_t pixel,
                       std::ptrdiff_t to_row_stride) const {
    const Size stored = upright_size({width, height});
    const std::ptrdiff_t row = stored.width * pixel;
    // Steps in the stored pixels for a step right and a step down in the upright ones.
    std::ptrdiff_t along_x = mirrors_x ? -pixel : pixel, along_y = mirrors_y ? -row : row;
    from += (mirrors_x ? (stored.width - 1) * pixel : 0) + (mirrors_y ? (stored.height - 1) * row : 0);
    if (swaps) std::swap(along_x, along_y);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            std::memcpy(to + y * to_row_stride + x * pixel, from + y * along_y + x * along_x,
                        static_cast<std::size_t>(pixel));
}

namespace {

/// Turns the place of a part of a panorama, as Google's Photo Sphere metadata have it of the stored image.
void turn_photo_sphere(const StoredOrder& order, OIIO::ImageSpec& spec) {
    constexpr float kMost = 1 << 24;
    const auto name = [](const char* what, const char* side) {
        return std::string("GPano:") + what + side + "Pixels";
    };
    bool is_sound = true;
    const auto number = [&](const std::string& key) {
        const double given = spec.get_int_attribute(
            key, static_cast<int>(std::lround(std::clamp(spec.get_float_attribute(key), -kMost, kMost))));
        is_sound = is_sound && std::fabs(given) <= kMost;
        return static_cast<int>(std::clamp<double>(given, -kMost, kMost));
    };
    const Size whole{number(name("FullPano", "Width")), number(name("FullPano", "Height"))},
        part{number(name("CroppedAreaImage", "Width")), number(name("CroppedAreaImage", "Height"))};
    const int x = number(name("CroppedArea", "Left")), y = number(name("CroppedArea", "Top"));
    if (!is_sound) return;
    const Box box = order.upright_box({x, y, x + part.width, y + part.height}, whole);
    const Size size = order.upright_size(whole);
    for (const auto& [key, value] : {std::pair{name("FullPano", "Width"), size.width},
                                     {name("FullPano", "Height"), size.height},
                                     {name("CroppedAreaImage", "Width"), box.width()},
                                     {name("CroppedAreaImage", "Height"), box.height()},
                                     {name("CroppedArea", "Left"), box.x0},
                                     {name("CroppedArea", "Top"), box.y0}})
        if (spec.find_attribute(key)) spec.attribute(key, value);
}

}  // namespace

OIIO::ImageSpec upright(const OIIO::ImageSpec& spec) {
    OIIO::ImageSpec out = spec;
    if (spec.find_attribute("Orientation")) out.attribute("Orientation", 1);
    const StoredOrder order(spec);
    if (order.is_upright()) return out;
    turn_photo_sphere(order, out);
    const Frame frame = frame_of(spec);
    const Size stored{frame.width, frame.height}, size = order.upright_size(stored);
    const Box data = order.upright_box(frame.data, stored);
    out.x = data.x0, out.y = data.y0;
    out.width = data.width(), out.height = data.height();
    out.full_x = out.full_y = 0;
    out.full_width = size.width, out.full_height = size.height;
    if (const double aspect = pixel_aspect_of(spec); order.swaps && aspect != 1)
        out.attribute("PixelAspectRatio", static_cast<float>(1 / aspect));
    return out;
}

bool UprightSource::read(int level, const Box& box, std::byte* texels,
                         std::ptrdiff_t row_stride) const noexcept {
    try {
        const Box stored = m_order.stored_box(box, m_base.size(level));
        const std::ptrdiff_t pixel = std::ptrdiff_t{channels()} * size_of(type());
        const std::ptrdiff_t stored_row = stored.width() * pixel;
        std::vector<std::byte> raw(static_cast<std::size_t>(stored_row * stored.height()));
        if (!m_base.read(level, stored, raw.data(), stored_row)) return false;
        m_order.turn(raw.data(), texels, box.width(), box.height(), pixel, row_stride);
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace anamorph
