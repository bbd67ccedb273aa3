// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/flat_picture.h"

#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

/// The map and its picture.
class FlatPicture {
  public:
    FlatPicture(const FlatRequest& r, std::shared_ptr<const BlockMap> blocks) {
        const Chart flat(Projection::rectilinear, r.source.width, r.source.height);
        m_picture.maps = {{std::move(blocks), {{Border(flat, r.wrap)}}}};
        m_picture.filter = r.filter;
        m_picture.output = r.output;
    }
    const Picture& picture() const { return m_picture; }

  private:
    Picture m_picture;
};

class FlatPictures final : public Pictures {
  public:
    FlatPictures(const FlatRequest& request, FlatBlocks blocks)
        : m_request(request), m_blocks(std::move(blocks)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_request.target, level);
        if (!size) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.pixels = pixels_of(m_request.output);
        picture.says = {{"anamorph:tol", m_request.plan.tol}};
        picture.says.insert(picture.says.end(), m_request.says.begin(), m_request.says.end());
        if (picture.pixels == PixelKind::color && m_request.filter == Filter::nearest) picture.moves = 0;
        picture.solve = [request = m_request, blocks = m_blocks, size = *size] {
            return std::make_unique<Solved<FlatPicture>>(FlatPicture(request, blocks(size)));
        };
        return picture;
    }

  private:
    FlatRequest m_request;
    FlatBlocks m_blocks;
};

}  // namespace

FlatRequest flat_request(const ParameterValues& values, const Size& source, const Size& target) {
    FlatRequest r{source,
                  target,
                  {},
                  rows::chosen<Filter>(values, "filter"),
                  rows::chosen<Wrap>(values, "wrap"),
                  rows::chosen_output(values)};
    r.plan.scheme = rows::chosen<Scheme>(values, "scheme");
    r.plan.tol = values.number("tol");
    r.plan.cull = ends_at_edges(r.wrap, r.output);
    return r;
}

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const FlatBlocks& blocks) {
    return std::make_unique<FlatPictures>(request, blocks);
}

}  // namespace anamorph
