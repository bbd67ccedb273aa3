// SPDX-License-Identifier: Apache-2.0
#include "recipe_content.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <thread>

#include "anamorph/image_source.h"
#include "anamorph/memo.h"
#include "anamorph/metadata.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/picture.h"
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

/// A drawing and, once asked for, what it reached.
class Solved {
  public:
    explicit Solved(const PictureRequest& request) : m_drawing(request.solve()) {}

    const Drawing& drawing() const { return *m_drawing; }
    const Facts& reached() {
        std::call_once(m_once, [this] { m_reached = m_drawing->reached(own_threads()); });
        return m_reached;
    }

  private:
    std::unique_ptr<const Drawing> m_drawing;
    std::once_flag m_once;
    Facts m_reached;
};

std::shared_ptr<Solved> solve(const PictureRequest& request) {
    static auto& memo = *new Memo<Solved>(16);
    return memo.get(request.key, [&] { return std::make_shared<Solved>(request); });
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

class RecipeContent final : public Content {
  public:
    RecipeContent(const std::string& name, const std::vector<Assignment>& config) {
        const Recipe recipe = load_recipe(name, config);
        const ParameterValues& values = recipe.values;
        std::vector<std::unique_ptr<Source>> images;
        std::vector<ImageSpec> specs;
        std::string identity;
        for (const SideFile& file : sources_of(recipe)) {
            auto image = std::make_unique<CacheSource>(shared_cache(), cached_name(file.name, file.identity),
                                                       0, 0, CacheSource::Facts::from_file);
            specs.push_back(image->spec());
            images.push_back(std::move(image));
            identity += file.identity;
        }
        std::vector<ImageSpec> upright_specs;
        for (const ImageSpec& spec : specs) upright_specs.push_back(upright(spec));
        m_source = upright_specs[0];
        m_operation = recipe.kind->read(values, upright_specs, recipe.files);
        const PictureRequest first = *m_operation->picture(0, 0);
        check_size(first, m_source);

        const std::string space = filtering_space(values, first.pixels);
        const Operation::Faces faces = m_operation->faces();
        static auto& stacks = *new Memo<const SourceStacks>(2);
        m_stacks = stacks.get(identity + space + "\n" + std::to_string(faces.columns * faces.rows), [&] {
            return std::make_shared<const SourceStacks>(
                make_source_stacks(std::move(images), specs, faces, space));
        });

        m_tile = values.extent("tile");
        if (m_tile.height < 0) m_tile.height = m_tile.width;
        if (values.toggle("mip"))
            while (m_operation->picture(0, m_levels)) ++m_levels;
        // What a film of many frames reached is not known without solving them all.
        for (int i = 0; subimages() == 1 && i < m_levels; ++i) {
            Level& l = level(0, i);
            l.solved = solve(l.request);
            add_facts(l.spec, l.solved->reached());
        }
    }

    int subimages() const override { return m_operation->frames(); }
    int levels(int) const override { return m_levels; }
    const ImageSpec& spec(int subimage, int level) const override {
        return this->level(subimage, level).spec;
    }

    void read(int subimage, int level, const Box& box, std::byte* pixels) const override {
        const Level& l = this->level(subimage, level);
        const std::shared_ptr<Solved> solved = l.solved ? l.solved : solve(l.request);
        const bool small = std::int64_t{box.width()} * box.height() < kParallelPixels;
        const Picture picture(solved->drawing(), *m_stacks);
        picture.draw(
            box, packed_view(pixels, pixel_type(l.spec.format), box.width(), box.height(), l.spec.nchannels),
            small ? serial_for : own_threads());
    }

  private:
    struct Level {
        PictureRequest request;
        ImageSpec spec;
        std::shared_ptr<Solved> solved;
    };

    /// Those that are given, in their order.
    static std::vector<SideFile> sources_of(const Recipe& recipe) {
        const std::vector<std::string>& keys = recipe.kind->sources;
        std::vector<SideFile> sources;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const auto file = recipe.files.find(keys[i]);
            const bool given = file != recipe.files.end();
            if (i < recipe.kind->least_sources && !given)
                throw Error(keys[i] + " is not given: must be the name of an image");
            if (given && i > sources.size())
                throw Error(keys[i], printable(file->second.name),
                            "must be given together with " + keys[i - 1]);
            if (given) sources.push_back(file->second);
        }
        return sources;
    }

    Level& level(int subimage, int number) const {
        const std::lock_guard lock(m_mutex);
        const auto [found, is_new] = m_known.try_emplace({subimage, number});
        if (is_new) {
            Level& made = found->second;
            made.request = *m_operation->picture(subimage, number);
            made.spec = picture_spec(m_source, made.request);
            const bool tiled = m_tile.width > 0 && m_tile.height > 0;
            made.spec.tile_width = tiled ? m_tile.width : 0;
            made.spec.tile_height = tiled ? m_tile.height : 0;
        }
        return found->second;
    }

    ImageSpec m_source;  ///< of the first source, upright
    std::unique_ptr<const Operation> m_operation;
    std::shared_ptr<const SourceStacks> m_stacks;
    SizeValue m_tile;
    int m_levels = 1;
    mutable std::mutex m_mutex;
    mutable std::map<std::pair<int, int>, Level> m_known;  ///< by frame and MIP level
};

}  // namespace

std::shared_ptr<const Content> open_recipe(const std::string& name, const std::vector<Assignment>& config) {
    return std::make_shared<RecipeContent>(name, config);
}

}  // namespace anamorph
