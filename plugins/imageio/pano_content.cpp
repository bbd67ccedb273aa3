// SPDX-License-Identifier: Apache-2.0
#include "pano_content.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <thread>

#include "anamorph/image_source.h"
#include "anamorph/metadata.h"
#include "anamorph/parallel.h"
#include "anamorph/picture.h"
#include "memo.h"
#include "recipe.h"

namespace anamorph {
namespace {

using OIIO::ImageSpec;

/// Threads of our own: a thread that waits on OpenImageIO's pool inside a read takes up other tasks of the
/// host, and its cache is not made for that. Never destroyed: nothing is to be joined while a process ends.
ParallelFor own_threads() {
    static const int hardware = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    int threads = OIIO::get_int_attribute("threads");
    if (threads < 1) threads = hardware;
    if (threads == 1) return serial_for;
    static auto& pool = *new OIIO::thread_pool(hardware - 1);
    return parallel_for_on(pool, threads);
}

/// Pictures below this many pixels are drawn by the calling thread.
constexpr std::int64_t kParallelPixels = 128 * 128;

ImageCacheRef shared_cache() {
    return OIIO::ImageCache::create(true);
}

/// A reprojection and, once asked for, what it reached.
class Solved {
  public:
    Solved(const Panorama& map, const ReprojectOptions& options) : m_reprojection(map, options) {}

    const Reprojection& reprojection() const { return m_reprojection; }
    const Reached& reached() {
        std::call_once(m_once, [this] { m_reached = m_reprojection.reached(own_threads()); });
        return m_reached;
    }

  private:
    Reprojection m_reprojection;
    std::once_flag m_once;
    Reached m_reached;
};

std::string text_of(const Chart& chart) {
    return std::string(name_of(chart.projection())) + " " + std::to_string(chart.width()) + "x" +
           std::to_string(chart.height()) + " " + shortest(chart.fov()) + " " +
           std::to_string(static_cast<int>(chart.spacing())) + " ";
}

std::shared_ptr<Solved> solve(const ReprojectRequest& request) {
    static auto& memo = *new Memo<Solved>(64);
    const Orientation& o = request.orientation;
    const ReprojectOptions& p = request.options;
    std::string key = text_of(request.source) + text_of(request.target);
    for (const double number : {o.yaw, o.pitch, o.roll, p.tol}) key += shortest(number) + " ";
    for (const int number : {static_cast<int>(p.scheme), static_cast<int>(p.filter), static_cast<int>(p.wrap),
                             static_cast<int>(p.output)})
        key += std::to_string(number) + " ";
    return memo.get(key, [&] { return std::make_shared<Solved>(request.map(), p); });
}

/// The name by which the cache is asked for a source: another spelling of its path after each change of its
/// identity, since the cache would go on with what it knows, and to have it forget is not safe while others
/// read.
std::string cached_name(const std::string& source, const std::string& identity) {
    struct Known {
        std::string identity;
        unsigned changes = 0;
    };
    static auto& mutex = *new std::mutex;
    static auto& known = *new std::map<std::string, Known>;
    const std::lock_guard lock(mutex);
    Known& k = known[source];
    if (!k.identity.empty() && k.identity != identity) ++k.changes;
    k.identity = identity;
    if (k.changes == 0) return source;
    // The number of changes in binary, of "./" and ".//".
    const std::filesystem::path path(source.substr(0, source.find('?')));
    std::string spelling;
    for (unsigned rest = k.changes; rest > 0; rest >>= 1) spelling += rest & 1 ? ".//" : "./";
    const std::string folder = path.has_parent_path() ? path.parent_path().string() + "/" : "";
    return folder + spelling + path.filename().string() + source.substr(path.string().size());
}

class PanoContent final : public Content {
  public:
    PanoContent(const std::string& name, const std::vector<Assignment>& config) {
        const Recipe recipe = load_recipe(name, config);
        const std::string identity = source_identity(name, recipe);
        auto image = std::make_unique<CacheSource>(shared_cache(), cached_name(recipe.source, identity));
        const ImageSpec source = image->spec();
        ReprojectRequest request = read_reproject_request(recipe.values, facts_of(source));
        check_size(request.target, source.nchannels, source.format);

        const std::string space = filtering_space(recipe.values, request);
        static auto& stacks = *new Memo<const SourceStack>(2);
        m_source = stacks.get(identity + space + "\n" + std::to_string(request.source.pieces().size()), [&] {
            return std::make_shared<const SourceStack>(std::move(image), source, request, space);
        });

        Extent tile = recipe.values.extent("tile");
        if (tile.height < 0) tile.height = tile.width;
        std::optional<Chart> target = request.target;
        do {
            request.target = *target;
            Level level{solve(request), {}};
            level.spec = picture_spec(source, request, level.solved->reached());
            level.spec.tile_width = tile.width > 0 && tile.height > 0 ? tile.width : 0;
            level.spec.tile_height = tile.width > 0 && tile.height > 0 ? tile.height : 0;
            m_levels.push_back(std::move(level));
            target = recipe.values.toggle("mip") ? half_size(*target) : std::nullopt;
        } while (target);
    }

    int levels() const override { return static_cast<int>(m_levels.size()); }
    const ImageSpec& spec(int level) const override { return m_levels[static_cast<std::size_t>(level)].spec; }

    void read(int level, const Box& box, std::byte* pixels) const override {
        const Level& l = m_levels[static_cast<std::size_t>(level)];
        const bool small = std::int64_t{box.width()} * box.height() < kParallelPixels;
        const Picture picture(l.solved->reprojection(), *m_source);
        picture.draw(
            box, packed_view(pixels, pixel_type(l.spec.format), box.width(), box.height(), l.spec.nchannels),
            small ? serial_for : own_threads());
    }

  private:
    struct Level {
        std::shared_ptr<Solved> solved;
        ImageSpec spec;
    };
    std::shared_ptr<const SourceStack> m_source;
    std::vector<Level> m_levels;
};

}  // namespace

std::shared_ptr<const Content> open_pano(const std::string& name, const std::vector<Assignment>& config) {
    return std::make_shared<PanoContent>(name, config);
}

}  // namespace anamorph
