// SPDX-License-Identifier: Apache-2.0
#include "viewed_panorama.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/thread.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/mosaic.h"
#include "anamorph/operation/pano.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/side_files.h"

namespace anamorph_viewer {

using anamorph::Assignment;
using anamorph::Error;

namespace {

bool has_key(const std::vector<Assignment>& options, const std::string& key) {
    return std::any_of(options.begin(), options.end(), [&](const Assignment& a) { return a.key == key; });
}

/// Reads files only; neither operation has any.
std::unique_ptr<const anamorph::Pictures> read(const anamorph::Operation& operation,
                                               const anamorph::ParameterValues& values,
                                               const std::vector<anamorph::SourceImage>& known) {
    return operation.read({values, known, {}, anamorph::side_file_reader()});
}

}  // namespace

ViewedPanorama::ViewedPanorama(const std::string& file, const std::vector<Assignment>& options)
    : m_operation(anamorph::find_operation(has_key(options, "circles") ? "mosaic" : "pano")),
      m_options(options) {
    for (const char* key : {"src", "yaw", "pitch", "roll", "fov", "size", "output"})
        if (has_key(options, key)) throw Error(std::string(key) + " is the viewer's own: must not be given");
    anamorph::check_file_name("src", file);
    auto image = std::make_unique<anamorph::CacheSource>(OIIO::ImageCache::create(true), file, 0, 0);
    image->keep_rows();
    const OIIO::ImageSpec spec = image->spec();
    m_known = {anamorph::source_image(anamorph::upright(spec))};
    m_hdr = image->type() == anamorph::PixelType::float32 || image->type() == anamorph::PixelType::half;
    m_channels = spec.nchannels;
    const anamorph::ParameterValues first = this->values({}, {64, 64});
    if (is_mosaic()) {
        m_right = first.number("x");
        m_ahead = first.number("z");
    }
    const auto pictures = read(*m_operation, first, m_known);
    std::vector<std::unique_ptr<anamorph::Source>> images;
    images.push_back(std::move(image));
    m_stacks = anamorph::make_source_stacks(std::move(images), {spec}, *pictures, first.text("colorspace"));
}

bool ViewedPanorama::is_mosaic() const {
    return m_operation->name == "mosaic";
}

void ViewedPanorama::move(double right, double ahead) {
    if (!is_mosaic() || !(std::hypot(m_right + right, m_ahead + ahead) <= 1)) return;
    m_right += right;
    m_ahead += ahead;
    std::erase_if(m_options, [](const Assignment& a) { return a.key == "x" || a.key == "z"; });
    m_options.push_back({"x", anamorph::shortest(m_right)});
    m_options.push_back({"z", anamorph::shortest(m_ahead)});
}

anamorph::ParameterValues ViewedPanorama::values(const View& view, const anamorph::Size& size) const {
    anamorph::ParameterValues values(*m_operation->parameters);
    values.assign(m_options);
    values.set("yaw", view.yaw);
    values.set("pitch", view.pitch);
    values.set("fov", view.fov);
    values.set("size", size);
    return values;
}

std::vector<float> ViewedPanorama::draw(const View& view, const anamorph::Size& size) const {
    const auto picture = read(*m_operation, this->values(view, size), m_known)->picture(0, 0);
    std::vector<float> pixels(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) *
                              static_cast<std::size_t>(m_channels));
    const auto to = anamorph::packed_view(reinterpret_cast<std::byte*>(pixels.data()),
                                          anamorph::PixelType::float32, size.width, size.height, m_channels);
    anamorph::draw_picture(*picture->solve(), m_stacks, {0, 0, size.width, size.height}, to,
                           anamorph::default_parallel_for());
    return pixels;
}

/// What a card's picture is of, without its pixels.
CardPicture ViewedPanorama::card_chart() const {
    const anamorph::ParameterValues values = this->values({}, {64, 64});
    const anamorph::SourceFacts& facts = m_known.front().facts;
    const auto check_target = [](const anamorph::Chart& target) {
        if (target.projection() != anamorph::Projection::rectilinear || target.lens())
            refuse_card("views that are not rectilinear");
    };
    if (is_mosaic()) {
        if (values.given("circle")) refuse_card("one circle alone");
        const anamorph::ConcentricStack stack = anamorph::read_concentric_stack(values);
        const anamorph::Chart chart = anamorph::read_slit_panorama(values, facts, stack.circles);
        check_target(anamorph::read_target_chart(values, chart));
        return {chart, {}, {}, stack};
    }
    const anamorph::ReprojectRequest request = anamorph::read_reproject_request(values, facts);
    check_target(request.target);
    if (request.source.chart.spacing() != anamorph::PixelSpacing::edges)
        refuse_card("pixels from centre to centre");
    if (request.source.chart.padding().pixels > 0) refuse_card("images with padding");
    if (request.source.chart.vertical().horizon) refuse_card("parts of panoramas");
    return {request.source.chart, request.held, {}};
}

CardPicture ViewedPanorama::card_picture() const {
    CardPicture picture = card_chart();
    const int panoramas = picture.stack ? picture.stack->circles : 1;
    picture.texels = card_texels(*m_stacks.front(), panoramas);
    picture.chart = picture.chart.resized(picture.texels.size.width, picture.texels.size.height / panoramas);
    return picture;
}

Direction ViewedPanorama::direction(const View& view, const anamorph::Size& size, double x, double y) const {
    const anamorph::ParameterValues values = this->values(view, size);
    const anamorph::Chart unused(anamorph::Projection::equirectangular, 2, 1);
    const anamorph::Chart target = anamorph::read_target_chart(values, unused);
    const anamorph::Ray<double> ray =
        anamorph::transform(anamorph::rotation(anamorph::read_orientation(values)), target.ray(x, y, 0));
    constexpr double kDegrees = 180 / std::numbers::pi;
    return {std::atan2(ray.x, ray.z) * kDegrees, std::atan2(-ray.y, std::hypot(ray.x, ray.z)) * kDegrees};
}

}  // namespace anamorph_viewer
