// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/flat_picture.h"

#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

Picture flat_picture(const FlatRequest& request, FlatMap map) {
    Picture picture = picture_through(std::move(map.blocks), Border(request.source, request.wrap),
                                      request.filter, request.output);
    picture.says = std::move(map.says);
    picture.overscan = request.plan.overscan;
    picture.adds_alpha = request.adds_alpha;
    picture.data = request.data;
    return picture;
}

/// Copied by itself, a variant with a string that memory is too short for ends the program (libstdc++ 12).
Attribute copy_of(const Attribute& attribute) {
    const auto* const text = std::get_if<std::string>(&attribute.value);
    if (!text) return attribute;
    std::string copy = *text;
    return {attribute.name, std::move(copy)};
}

class FlatPictures final : public Pictures {
  public:
    FlatPictures(const FlatRequest& request, MakeFlatMap make_map)
        : m_request(request), m_make_map(std::move(make_map)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_request.target, level);
        const Size& overscan = m_request.plan.overscan;
        if (!size || (level > 0 && (m_request.display || !(overscan == Size{})))) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.display = m_request.display;
        picture.add_overscan(overscan);
        picture.keeps_format =
            level == 0 && picture.shows({m_request.source.width(), m_request.source.height()});
        picture.pixels = pixels_of(m_request.output);
        picture.says = {{"anamorph:tol", m_request.plan.tol}};
        if (m_request.says)
            for (const Attribute& attribute : *m_request.says) picture.says.push_back(copy_of(attribute));
        picture.adds_alpha = m_request.adds_alpha;
        if (picture.pixels == PixelKind::color && m_request.filter == Filter::nearest) picture.moves = 0;
        if (picture.pixels == PixelKind::color) picture.moved_channels = moved_channels(m_request.data);
        picture.solve = [request = m_request, make_map = m_make_map, size = *size] {
            return solved(flat_picture(request, make_map(size)));
        };
        return picture;
    }
    SourceFaces faces() const override { return faces_of(m_request.source); }

  private:
    FlatRequest m_request;
    MakeFlatMap m_make_map;
};

}  // namespace

void add_to(FlatRequest& request, Attributes more) {
    auto all = std::make_shared<Attributes>();
    if (request.says)
        for (const Attribute& attribute : *request.says) all->push_back(copy_of(attribute));
    for (Attribute& attribute : more) all->push_back(std::move(attribute));
    request.says = std::move(all);
}

std::shared_ptr<const Attributes> saying(Attribute attribute) {
    auto all = std::make_shared<Attributes>();
    all->push_back(std::move(attribute));
    return all;
}

FlatRequest flat_request(const ParameterValues& values, const SourceFacts& source, const Size& target) {
    FlatRequest r{Chart(Projection::rectilinear, source.width, source.height),
                  target,
                  {},
                  rows::filter_of(values),
                  rows::chosen<Wrap>(values, "wrap"),
                  rows::chosen_output(values)};
    r.plan.scheme = rows::chosen<Scheme>(values, "scheme");
    r.plan.tol = values.number("tol");
    r.plan.cull = ends_at_edges(r.wrap, r.output) && !source.overscan;
    r.adds_alpha =
        rows::adds_alpha(values, source.has_alpha, r.wrap == Wrap::automatic || r.wrap == Wrap::black);
    r.data = rows::data_of(values, source, r.filter);
    rows::check_overscan(values);
    r.plan.overscan = rows::overscan_of(values, target);
    return r;
}

SourceFaces faces_of(const Chart& source) {
    const FaceGrid grid = faces_of(source.projection());
    // Edges within pixels part no texels: in their rows faces go on in each other.
    const bool parts_columns = grid.columns > 0 && source.width() % grid.columns == 0;
    return {parts_columns ? grid.columns : 1, std::max(1, grid.rows)};
}

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const MakeFlatMap& make_map) {
    return std::make_unique<FlatPictures>(request, make_map);
}

}  // namespace anamorph
