// SPDX-License-Identifier: Apache-2.0
#include "stmap.h"

#include <cstring>
#include <optional>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/image/picture.h"
#include "anamorph/parallel.h"
#include "inverse_points.h"
#include "recipe.h"
#include "recipe_content.h"

namespace anamorph::command {
namespace {

/// The map from the source of a recipe to its picture.
class InverseStMap final : public PictureReader {
  public:
    InverseStMap(const std::string& recipe, const std::vector<Assignment>& given, bool up)
        : m_content(open_recipe(recipe, given)), m_up(up) {
        for (int s = 0; s < m_content->subimages(); ++s) m_maps.push_back(opened(recipe, s));
    }
    int subimages() override { return m_content->subimages(); }
    const OIIO::ImageSpec& spec(int subimage) override { return of(subimage).spec; }
    void read(int subimage, const Box& box, std::byte* pixels) override {
        const Opened& map = of(subimage);
        default_parallel_for()(box.height(), [&](std::int64_t row) {
            const int y = box.y0 + static_cast<int>(row);
            for (int x = box.x0; x < box.x1; ++x) {
                float uv[2] = {-1, -1};
                if (const auto p = map.points->of({x + 0.5, y + 0.5})) {
                    uv[0] = static_cast<float>((p->x - map.corner.x) / map.shown.width);
                    const double v = (p->y - map.corner.y) / map.shown.height;
                    uv[1] = static_cast<float>(m_up ? 1 - v : v);
                }
                std::memcpy(pixels + (row * box.width() + x - box.x0) * std::ptrdiff_t{sizeof uv}, uv,
                            sizeof uv);
            }
        });
    }

  private:
    struct Opened {
        std::shared_ptr<const SolvedPicture> picture;
        OIIO::ImageSpec spec;
        Point<double> corner;  ///< of the display window, in pixels of the map
        Size shown;
        std::unique_ptr<InversePoints> points;
    };
    const Opened& of(int subimage) const { return m_maps.at(static_cast<std::size_t>(subimage)); }

    Opened opened(const std::string& recipe, int subimage) const {
        const std::optional<JoinSource> made = m_content->join_source(subimage);
        const Picture* picture = made ? made->picture->of_maps() : nullptr;
        if (!picture || picture->maps.size() != 1 || picture->maps[0].layers.size() != 1)
            throw Error("in " + printable(recipe) +
                        ": its picture has no single source point: it is not one map of one source");
        const BlockMap& map = *picture->maps[0].blocks;
        const Chart& source = picture->maps[0].layers[0].border.chart();
        const Size size{static_cast<int>(source.width()), static_cast<int>(source.height())};
        const OIIO::ImageSpec& windows = m_content->header(subimage, 0);
        // Maps that know of overscan count from the display window's corner, others from the data window's.
        const Size& known = picture->overscan;
        Opened to{
            made->picture, OIIO::ImageSpec(size.width, size.height, 2, OIIO::TypeDesc::FLOAT), {}, {}, {}};
        to.spec.channelnames = {"R", "G"};
        to.corner = {static_cast<double>(windows.full_x - windows.x - known.width),
                     static_cast<double>(windows.full_y - windows.y - known.height)};
        to.shown = {windows.full_width, windows.full_height};
        const Box data{-known.width, -known.height, windows.width - known.width,
                       windows.height - known.height};
        to.points = std::make_unique<InversePoints>(map, data, size);
        return to;
    }

    std::shared_ptr<const Content> m_content;
    bool m_up;
    std::vector<Opened> m_maps;
};

/// An ST-map with v turned round.
class TurnedStMap final : public PictureReader {
  public:
    explicit TurnedStMap(std::unique_ptr<PictureReader> map) : m_map(std::move(map)) {}
    int subimages() override { return m_map->subimages(); }
    const OIIO::ImageSpec& spec(int subimage) override { return m_map->spec(subimage); }
    void read(int subimage, const Box& box, std::byte* pixels) override {
        m_map->read(subimage, box, pixels);
        const std::int64_t count = std::int64_t{box.width()} * box.height();
        for (std::int64_t i = 0; i < count; ++i) {
            float uv[2];
            std::memcpy(uv, pixels + i * std::ptrdiff_t{sizeof uv}, sizeof uv);
            // No point stays none.
            if (uv[0] != -1 || uv[1] != -1) uv[1] = static_cast<float>(1 - double{uv[1]});
            std::memcpy(pixels + i * std::ptrdiff_t{sizeof uv}, uv, sizeof uv);
        }
    }

  private:
    std::unique_ptr<PictureReader> m_map;
};

}  // namespace

std::unique_ptr<PictureReader> open_stmap(const std::string& recipe, const std::vector<Assignment>& given,
                                          const StMapKind& kind) {
    const Operation* operation = operation_of(recipe);
    if (!operation) throw Error("RECIPE", printable(recipe), "must be the name of a recipe");
    if (!ParameterValues(*operation->parameters).knows("flip_v"))
        throw Error("RECIPE", printable(recipe),
                    "must be of an operation that has ST-maps: ." + operation->name + " has none");
    std::vector<Assignment> keys = given;
    keys.push_back({"output", kind.inverse ? "color" : "stmap"});
    const bool is_up = RecipeReader().load(recipe, keys).values.toggle("flip_v");
    if (kind.inverse) return std::make_unique<InverseStMap>(recipe, keys, kind.up || is_up);
    if (is_up || !kind.up) return open_picture(recipe, keys);
    // Of a warp flip_v is also about the ST-map that it reads.
    if (ParameterValues(*operation->parameters).knows("mesh"))
        return std::make_unique<TurnedStMap>(open_picture(recipe, keys));
    keys.push_back({"flip_v", "1"});
    return open_picture(recipe, keys);
}

}  // namespace anamorph::command
