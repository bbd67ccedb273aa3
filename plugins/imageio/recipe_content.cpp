// SPDX-License-Identifier: Apache-2.0
#include "recipe_content.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "anamorph/image_source.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/memo.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/side_files.h"
#include "anamorph/source_stack.h"
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

/// A picture and, once asked for, what it reached.
class Solved {
  public:
    explicit Solved(const PictureRequest& request) : m_picture(request.solve()) {}

    const SolvedPicture& picture() const { return *m_picture; }
    const Attributes& reached() {
        std::call_once(m_once, [this] { m_reached = m_picture->reached(own_threads()); });
        return m_reached;
    }

  private:
    std::unique_ptr<const SolvedPicture> m_picture;
    std::once_flag m_once;
    Attributes m_reached;
};

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

/// All that one reading from outside opens: nothing twice, nor what another one holds open.
class Opening {
  public:
    std::shared_ptr<const Content> open(const std::string& name, const std::vector<Assignment>& config);
    /// A source that is no recipe; its header is read once.
    std::unique_ptr<CacheSource> open_file(const SideFile& file);

  private:
    RecipeReader m_reader;
    std::map<std::string, std::vector<ImageSpec>> m_headers;       ///< levels of files, by name
    std::map<std::string, std::shared_ptr<const Content>> m_open;  ///< by identity
};

/// The open pictures of the process, by identity.
class OpenPictures {
  public:
    static OpenPictures& instance() {
        static auto& pictures = *new OpenPictures;
        return pictures;
    }
    std::shared_ptr<const Content> find(const std::string& identity) {
        const std::lock_guard lock(m_mutex);
        const auto found = m_open.find(identity);
        return found == m_open.end() ? nullptr : found->second.lock();
    }
    void add(const std::string& identity, const std::shared_ptr<const Content>& content) {
        const std::lock_guard lock(m_mutex);
        std::erase_if(m_open, [](const auto& entry) { return entry.second.expired(); });
        m_open[identity] = content;
    }

  private:
    std::mutex m_mutex;
    std::map<std::string, std::weak_ptr<const Content>> m_open;
};

class RecipeContent final : public Content {
  public:
    RecipeContent(const Recipe& recipe, Opening& opening) {
        const ParameterValues& values = recipe.values;
        std::vector<OpenSource> images;
        std::vector<ImageSpec> specs;
        std::vector<SourceImage> known;
        std::string identity;
        for (const SideFile& file : sources_of(recipe)) {
            images.push_back(open_source(file, opening));
            specs.push_back(images.back().image->spec());
            known.push_back(source_image(upright(specs.back())));
            identity += file.identity;
        }
        if (!specs.empty()) m_source = upright(specs[0]);
        std::vector<std::string> missing;
        for (const std::string& key : recipe.linked_images) {
            const SideFile& file = recipe.files.at(key);
            identity += file.identity;
            images.push_back(open_or_none(file, opening));
            if (!images.back().image) missing.push_back(key);
            specs.push_back(images.back().image ? images.back().image->spec() : ImageSpec());
        }
        m_pictures = recipe.operation->read({values, known, recipe.files, side_file_reader(), missing});
        m_key = operation_key(*recipe.operation, values, known, recipe.files);
        m_tile = tile_of(values);
        const PictureRequest first = *m_pictures->picture(0, 0);
        const std::string space = filtering_space(values, first.pixels);
        m_stored = moves_stored(first, specs, space);
        if (m_stored) keep_stored(images[*first.moves]);
        const SourceFaces faces = m_pictures->faces();
        static auto& stacks = *new Memo<const SourceStacks>(2);
        const std::string stack_key = identity + space + "\n" + std::to_string(faces.columns) + "x" +
                                      std::to_string(faces.rows) +
                                      (m_stored ? " stored " + std::to_string(*first.moves) : "");
        m_stacks = stacks.get(stack_key, [&] {
            std::vector<std::unique_ptr<Source>> sources;
            for (OpenSource& open : images) sources.push_back(std::move(open.image));
            return std::make_shared<const SourceStacks>(
                make_source_stacks(std::move(sources), specs, faces, space));
        });

        if (values.knows("mip") && values.toggle("mip"))
            while (m_pictures->picture(0, m_levels)) ++m_levels;
        // What a film of many frames reached is not known without solving them all, nor what a picture did whose pixels
        // have to be drawn for that.
        for (int i = 0; subimages() == 1 && i < m_levels; ++i) {
            Level& l = level(0, i);
            l.solved = solve(l);
            if (!l.solved->picture().reached_by_drawing()) add_attributes(l.spec, l.solved->reached());
        }
    }

    int subimages() const override { return m_pictures->frames(); }
    int levels(int) const override { return m_levels; }
    const ImageSpec& spec(int subimage, int level) const override {
        return this->level(subimage, level).spec;
    }

    void read(int subimage, int level, const Box& box, std::byte* pixels) const override {
        const Level& l = this->level(subimage, level);
        const std::shared_ptr<Solved> solved = l.solved ? l.solved : solve(l);
        const bool small = std::int64_t{box.width()} * box.height() < kParallelPixels;
        const StoredPixels as =
            m_stored ? stored_pixels(l.spec) : StoredPixels{pixel_type(l.spec.format), l.spec.nchannels};
        draw_picture(solved->picture(), *m_stacks, box,
                     packed_view(pixels, as.type, box.width(), box.height(), as.channels),
                     small ? serial_for : own_threads());
    }

  private:
    struct Level {
        PictureRequest request;
        std::string key;  ///< the same text, the same picture
        ImageSpec spec;
        std::shared_ptr<Solved> solved;
    };

    struct OpenSource {
        std::unique_ptr<CacheSource> image;
        std::shared_ptr<const Content> content;  ///< of a recipe
    };

    /// A cache would make float of what is stored otherwise; recipes are read by what they show.
    static void keep_stored(const OpenSource& open) {
        if (const std::shared_ptr<const Content> content = open.content)
            open.image->keep_stored(
                [content](const Box& box, std::byte* pixels) { content->read(0, 0, box, pixels); });
        else
            open.image->keep_stored();
    }

    /// A source that is a recipe stays open while this picture is, so that the cache that asks for it by its
    /// name does not make it again.
    OpenSource open_source(const SideFile& file, Opening& opening) {
        if (!operation_of(file.name)) return {opening.open_file(file), nullptr};
        const std::shared_ptr<const Content> content =
            in_recipe(file.name, [&] { return opening.open(file.name, {}); });
        m_nested.push_back(content);
        return {std::make_unique<CacheSource>(
                    shared_cache(), cached_name(file.name, file.identity), file.name,
                    [&](int level) {
                        return level < content->levels(0) ? content->spec(0, level) : ImageSpec();
                    }),
                content};
    }

    OpenSource open_or_none(const SideFile& file, Opening& opening) {
        try {
            return open_source(file, opening);
        } catch (const Error&) {
            return {};
        }
    }

    /// Those that are given, in their order.
    static std::vector<SideFile> sources_of(const Recipe& recipe) {
        const std::vector<std::string>& keys = recipe.operation->sources;
        std::vector<SideFile> sources;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const auto file = recipe.files.find(keys[i]);
            const bool given = file != recipe.files.end();
            if (i < recipe.operation->least_sources && !given)
                throw Error(keys[i] + " is not given: must be the name of an image");
            if (given && i > sources.size())
                throw Error(keys[i], printable(file->second.name),
                            "must be given together with " + keys[i - 1]);
            if (given) sources.push_back(file->second);
        }
        return sources;
    }

    static Size tile_of(const ParameterValues& values) {
        if (!values.knows("tile")) return {};
        const Size tile = values.extent("tile");
        return {tile.width, tile.height < 0 ? tile.width : tile.height};
    }

    static std::shared_ptr<Solved> solve(const Level& level) {
        static auto& memo = *new Memo<Solved>(16);
        return memo.get(level.key, [&] { return std::make_shared<Solved>(level.request); });
    }

    Level& level(int subimage, int number) const {
        const std::lock_guard lock(m_mutex);
        const auto [found, is_new] = m_known.try_emplace({subimage, number});
        if (is_new) {
            Level& made = found->second;
            made.request = *m_pictures->picture(subimage, number);
            made.key = m_key + "frame " + std::to_string(subimage) + " level " + std::to_string(number);
            made.spec = picture_spec(m_source ? &*m_source : nullptr, made.request, m_stored);
            const bool tiled = m_tile.width > 0 && m_tile.height > 0;
            made.spec.tile_width = tiled ? m_tile.width : 0;
            made.spec.tile_height = tiled ? m_tile.height : 0;
        }
        return found->second;
    }

    std::optional<ImageSpec> m_source;  ///< of the first source, upright
    std::unique_ptr<const Pictures> m_pictures;
    std::string m_key;  ///< of the operation
    std::vector<std::shared_ptr<const Content>> m_nested;
    std::shared_ptr<const SourceStacks> m_stacks;
    Size m_tile;
    int m_levels = 1;
    bool m_stored = false;  ///< as moves_stored() says
    mutable std::mutex m_mutex;
    mutable std::map<std::pair<int, int>, Level> m_known;  ///< by frame and MIP level
};

std::shared_ptr<const Content> Opening::open(const std::string& name, const std::vector<Assignment>& config) {
    const Recipe recipe = m_reader.load(name, config);
    std::shared_ptr<const Content>& content = m_open[recipe.identity];
    if (!content) content = OpenPictures::instance().find(recipe.identity);
    if (content) return content;
    auto made = std::make_shared<const RecipeContent>(recipe, *this);
    OpenPictures::instance().add(recipe.identity, made);
    return m_open[recipe.identity] = made;
}

std::unique_ptr<CacheSource> Opening::open_file(const SideFile& file) {
    const std::string name = cached_name(file.name, file.identity);
    const auto known = m_headers.find(file.name);
    const bool is_new = known == m_headers.end();
    auto source = is_new ? std::make_unique<CacheSource>(shared_cache(), name, file.name)
                         : std::make_unique<CacheSource>(shared_cache(), name, file.name, [&](int level) {
                               const auto i = static_cast<std::size_t>(level);
                               return i < known->second.size() ? known->second[i] : ImageSpec();
                           });
    if (is_new) m_headers[file.name] = source->specs();
    source->keep_rows();
    return source;
}

}  // namespace

std::shared_ptr<const Content> open_recipe(const std::string& name, const std::vector<Assignment>& config) {
    // An ST-map that is a recipe is opened by OpenImageIO while the recipe that names it is.
    static thread_local Opening* around = nullptr;
    if (around) return around->open(name, config);
    Opening opening;
    struct Around {
        explicit Around(Opening& opening) { around = &opening; }
        ~Around() { around = nullptr; }
    } const guard(opening);
    return opening.open(name, config);
}

}  // namespace anamorph
