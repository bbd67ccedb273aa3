// SPDX-License-Identifier: Apache-2.0
#include "recipe_content.h"

#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "anamorph/chain/joined.h"
#include "anamorph/face_source.h"
#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/joining.h"
#include "anamorph/lens_database.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/memo.h"
#include "anamorph/operation/solved.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/picture_tiles.h"
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
    explicit Solved(std::unique_ptr<const SolvedPicture> picture) : m_picture(std::move(picture)) {}

    const SolvedPicture& picture() const { return *m_picture; }
    /// The picture of its channels that are only moved; null where there are none.
    const SolvedPicture* moved() {
        std::call_once(m_moved_once, [this] { m_moved = m_picture->of_moved(); });
        return m_moved.get();
    }
    const Attributes& reached() {
        std::call_once(m_once, [this] { m_reached = m_picture->reached(own_threads()); });
        return m_reached;
    }

  private:
    std::unique_ptr<const SolvedPicture> m_picture;
    std::once_flag m_once, m_moved_once;
    Attributes m_reached;
    std::unique_ptr<const SolvedPicture> m_moved;
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
    /// Opens a part of a source that is no recipe; its header is read once.
    std::unique_ptr<CacheSource> open_file(const SideFile& file, int part);
    /// Opens a part of each of the six files that a source's name stands for.
    std::unique_ptr<FaceSource> open_faces(const SideFile& file, int part);
    /// The names of a source's parts, of which there is at least one; recipes give none.
    std::vector<std::string> parts_of(const SideFile& file);

  private:
    /// What is known of a part of a file.
    struct Header {
        std::vector<std::string> parts;  ///< names of all parts, by the first
        std::vector<ImageSpec> levels;
    };
    std::shared_ptr<const Header> header_of(const SideFile& file, int part);

    RecipeReader m_reader;
    std::map<std::pair<std::string, int>, std::shared_ptr<const Header>> m_headers;  ///< by name and part
    std::map<std::pair<std::string, int>, std::unique_ptr<CacheSource>>
        m_opened;  ///< files whose headers have been read, until they are asked for
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

/// Does a file name the images that are a recipe's sources?
bool gathers(const Recipe& recipe) {
    return !recipe.operation->gathering_file(recipe.files).empty();
}

/// Those sources of a recipe that are given, in the order of their keys, or all that a file gathers.
std::vector<SideFile> sources_of(const Recipe& recipe) {
    const std::vector<std::string>& keys = recipe.operation->sources;
    std::vector<SideFile> sources;
    if (gathers(recipe)) {
        for (const std::string& key : recipe.linked_images) sources.push_back(recipe.files.at(key));
        return sources;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const auto file = recipe.files.find(keys[i]);
        const bool given = file != recipe.files.end();
        if (i < recipe.operation->least_sources && !given)
            throw Error::not_given(keys[i], ": must be the name of an image");
        if (given && i > sources.size())
            throw Error(keys[i], printable(file->second.name), "must be given together with " + keys[i - 1]);
        if (given) sources.push_back(file->second);
    }
    return sources;
}

/// The pictures of one part of a recipe's sources.
class RecipeContent final : public Content {
  public:
    /// `parts`: how many the source has that has most.
    RecipeContent(const Recipe& recipe, Opening& opening, int part, int parts) {
        ParameterValues values = recipe.values;
        std::vector<OpenSource> images;
        std::vector<ImageSpec> specs, shown;
        std::vector<SourceImage> known;
        std::string identity;
        const bool is_gathered = gathers(recipe);
        const std::vector<SideFile> sources = sources_of(recipe);
        for (const SideFile& file : sources) {
            const int own = part_in(file, opening, part, parts);
            images.push_back(open_source(file, opening, own));
            const OpenSource& open = images.back();
            specs.push_back(open.faces ? open.faces->spec() : open.image->spec());
            if (is_gathered) specs.back().attribute("Orientation", 1);
            shown.push_back(open.faces ? specs.back() : upright(specs.back()));
            known.push_back(open.faces ? open.faces->known() : source_image(shown.back()));
            identity += file.identity + std::to_string(own) + "\n";
        }
        if (!specs.empty()) m_source = shown[0];
        m_lenses = find_lenses(*recipe.operation, values, shown, known);
        if (parts > 1) m_part = std::to_string(part) + " of " + std::to_string(parts);
        std::vector<std::string> missing;
        if (is_gathered) identity += recipe.files.at(recipe.operation->main_file).identity;
        for (const std::string& key : recipe.linked_images) {
            // One file may be several of the images that are gathered, each cut in its own way.
            identity += key + "\n";
            if (is_gathered) continue;
            const SideFile& file = recipe.files.at(key);
            identity += file.identity;
            images.push_back(open_or_none(key, file, opening, part, parts));
            if (!images.back().image) missing.push_back(key);
            specs.push_back(images.back().image ? images.back().image->spec() : ImageSpec());
        }
        const KeyedFileReader reader(recipe.files);
        m_pictures = recipe.operation->read({values, known, recipe.files, reader, missing});
        for (const auto& [key, file] : recipe.files)
            if (!is_drawn(recipe, key)) m_side_files.emplace_back(key, file);
        m_key = operation_key(*recipe.operation, values, known, recipe.files);
        m_tile = tile_of(values);
        m_says_hash = values.knows("hash") && values.toggle("hash");
        if (values.knows("reached")) m_says_reached = values.toggle("reached");
        if (values.knows("mip") && values.toggle("mip"))
            while (m_pictures->picture(0, m_levels)) ++m_levels;
        const bool has_tiles = !known.empty() && (images[0].content ? !images[0].content->prefers_scanlines()
                                                                    : specs[0].tile_width > 0);
        m_prefers_scanlines = values.knows("tile") && !values.given("tile") && m_levels == 1 && !has_tiles;
        const PictureRequest first = *m_pictures->picture(0, 0);
        m_space = filtering_space(values, first.pixels);
        m_stored = moves_stored(first, specs, m_space);
        const std::vector<ImageSpec> of_sources(specs.begin(), specs.begin() + std::ssize(known));
        m_moves_channels = !m_stored && moves_channels_stored(first, of_sources);
        m_chain = recipe.operation->name;
        join(recipe, images, first.pixels);
        if (!m_joined) make_stacks(images, specs, identity);
        if (!m_joined && m_moves_channels) {
            std::vector<OpenSource> again;
            for (std::size_t i = 0; i < known.size(); ++i)
                again.push_back(open_source(sources[i], opening, images[i].part));
            make_stored_stacks(again, of_sources, identity);
        }
        // What is wrong with a picture is said when it is opened.
        for (int i = 0; subimages() == 1 && i < m_levels; ++i) {
            Level& l = level(0, i);
            l.solved = solve(l);
        }
    }

    int subimages() const override { return m_pictures->frames(); }
    int levels(int) const override { return m_levels; }
    const ImageSpec& header(int subimage, int level) const override {
        return this->level(subimage, level).header;
    }
    const ImageSpec& spec(int subimage, int level) const override {
        Level& l = this->level(subimage, level);
        std::call_once(l.once, [&] {
            l.spec = l.header;
            // What a frame of a film reached is not known without solving it.
            const bool is_asked = m_says_reached.value_or(false);
            if (const std::shared_ptr<Solved> solved = is_asked && !l.solved ? solve(l) : l.solved)
                say_reached(*solved, l.spec);
            else if (m_says_reached)
                say_not_computed(l.spec);
            if (const std::string keys = first_parts(); !keys.empty())
                l.spec.attribute("anamorph:first_part", keys);
            if (m_says_hash && level == 0) l.spec.attribute("anamorph:hash", hash_of(subimage));
        });
        return l.spec;
    }

    void read(int subimage, int level, const Box& box, std::byte* pixels) const override {
        const Level& l = this->level(subimage, level);
        const std::shared_ptr<Solved> solved = l.solved ? l.solved : solve(l);
        const bool small = std::int64_t{box.width()} * box.height() < kParallelPixels;
        if (!m_stored && (!l.header.channelformats.empty() || loses_values(l.header.format)))
            return read_types(l, *solved, box, pixels, small ? serial_for : own_threads());
        const StoredPixels as = m_stored ? stored_pixels(l.header)
                                         : StoredPixels{pixel_type(l.header.format), l.header.nchannels};
        draw_picture(solved->picture(), *m_stacks, box,
                     packed_view(pixels, as.type, box.width(), box.height(), as.channels),
                     small ? serial_for : own_threads());
    }

    bool prefers_scanlines() const override { return m_prefers_scanlines; }

    std::optional<JoinSource> join_source(int subimage) const override {
        const Level& l = level(subimage, 0);
        const std::shared_ptr<Solved> solved = l.solved ? l.solved : solve(l);
        return JoinSource{std::shared_ptr<const SolvedPicture>(solved, &solved->picture()),
                          l.request.shown(),
                          m_stacks,
                          m_stored_stacks,
                          m_space,
                          m_stored,
                          l.key,
                          m_said_of_chain.empty() ? m_chain : m_said_of_chain,
                          l.header.get_float_attribute("anamorph:tol")};
    }

  private:
    struct Level {
        PictureRequest request;
        std::string key;  ///< the same text, the same picture
        ImageSpec header;
        std::shared_ptr<Solved> solved;
        std::once_flag once;
        ImageSpec spec;  ///< the header with what was reached
    };

    /// The digits of the hash of a picture, drawn for it.
    std::string hash_of(int subimage) const {
        FileHasher hasher;
        hasher.add_picture(hashed_picture(level(subimage, 0).header),
                           [&](const Box& box, std::byte* pixels) { read(subimage, 0, box, pixels); });
        return hash_digits(hasher.hash());
    }

    /// What a picture reached; where its pixels have to be drawn for that and nobody asked, what is known without.
    void say_reached(Solved& solved, ImageSpec& spec) const {
        if (!solved.picture().reached_by_drawing() || m_says_reached.value_or(false))
            return add_attributes(spec, solved.reached());
        add_attributes(spec, solved.picture().known());
        if (m_says_reached) say_not_computed(spec);
    }
    static void say_not_computed(ImageSpec& spec) {
        spec.attribute("anamorph:not_computed", "max_error: reached=1 computes it");
    }

    /// Draws channels of several types: in float, and then each in its own.
    void read_types(const Level& level, Solved& solved, const Box& box, std::byte* pixels,
                    const ParallelFor& parallel_for) const {
        const ImageSpec& spec = level.header;
        const auto count = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()),
                   channels = static_cast<std::size_t>(spec.nchannels);
        std::vector<float> drawn(count * channels);
        draw_picture(solved.picture(), *m_stacks, box,
                     packed_view(reinterpret_cast<std::byte*>(drawn.data()), PixelType::float32, box.width(),
                                 box.height(), spec.nchannels),
                     parallel_for);
        const auto pixel = static_cast<OIIO::stride_t>(spec.pixel_bytes(true)),
                   floats = static_cast<OIIO::stride_t>(channels * sizeof(float));
        for (int c = 0; c < spec.nchannels; ++c)
            OIIO::convert_image(1, box.width(), box.height(), 1, drawn.data() + c, OIIO::TypeFloat, floats,
                                floats * box.width(), OIIO::AutoStride,
                                pixels + (c > 0 ? spec.pixel_bytes(0, c, true) : 0), spec.channelformat(c),
                                pixel, pixel * box.width(), OIIO::AutoStride);
        if (m_stored_stacks && solved.moved())
            move_channels(level, *solved.moved(), box, pixels, parallel_for);
    }

    /// Draws the channels that are only moved again, as the sources store them.
    void move_channels(const Level& level, const SolvedPicture& moved, const Box& box, std::byte* pixels,
                       const ParallelFor& parallel_for) const {
        const Source& source = (*m_stored_stacks)[0]->top();
        const ImageSpec& spec = level.header;
        const auto count = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()),
                   from_pixel = static_cast<std::size_t>(source.channels() * size_of(source.type())),
                   to_pixel = spec.pixel_bytes(true);
        std::vector<std::byte> drawn(count * from_pixel);
        draw_picture(moved, *m_stored_stacks, box,
                     packed_view(drawn.data(), source.type(), box.width(), box.height(), source.channels()),
                     parallel_for);
        for (const int c : level.request.moved_channels) {
            // What the picture has more stands behind the source's channels.
            const std::size_t at = c > 0 ? spec.pixel_bytes(0, c, true) : 0,
                              size = spec.channelformat(c).size();
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(pixels + i * to_pixel + at, drawn.data() + i * from_pixel + at, size);
        }
    }

    struct OpenSource {
        std::unique_ptr<CacheSource> image;
        std::shared_ptr<const Content> content;  ///< of a recipe
        int part = 0;
        std::unique_ptr<FaceSource> faces = {};  ///< six files, in place of `image`
    };

    /// Joins the picture with its source's, where that is a recipe and it can be done. Says what came of it.
    void join(const Recipe& recipe, const std::vector<OpenSource>& images, PixelKind pixels) {
        if (m_nested.empty()) return;
        const std::string reason = why_not_joined(recipe.values, images, pixels);
        if (!m_joined) {
            m_said_of_chain = m_chain + " of a picture that is drawn first: " + reason;
            return;
        }
        m_stacks = m_joined->stacks;
        if (m_moves_channels) m_stored_stacks = m_joined->stored_stacks;
        m_key += "joined with " + m_joined->key;
        m_chain += " of " + m_joined->chain;
        m_said_of_chain = m_chain;
    }
    /// Joins it, or returns the reason why not.
    std::string why_not_joined(const ParameterValues& values, const std::vector<OpenSource>& images,
                               PixelKind pixels) {
        if (const std::string reason = why_drawn_apart(m_chain, values, subimages()); !reason.empty())
            return reason;
        if (!images[0].content) return "its source is no recipe";
        std::optional<JoinSource> source = images[0].content->join_source(images[0].part);
        if (!source) return "its source is no picture of maps";
        for (int i = 0; i < m_levels; ++i) {
            const PictureRequest request = *m_pictures->picture(0, i);
            const std::unique_ptr<const SolvedPicture> own = request.solve();
            const Joined joined =
                joined_sides({*own, request.shown(), m_space, m_stored}, pixels,
                             {*source->picture, source->shown, source->space, source->stored});
            if (!joined.picture) return joined.reason;
        }
        m_joined = std::move(source);
        return "";
    }

    void make_stacks(std::vector<OpenSource>& images, const std::vector<ImageSpec>& specs,
                     const std::string& identity) {
        const PictureRequest first = *m_pictures->picture(0, 0);
        if (m_stored) keep_stored(images[*first.moves]);
        const SourceFaces faces = m_pictures->faces();
        static auto& stacks = *new Memo<const SourceStacks>(2);
        const std::string key = identity + m_space + "\n" + std::to_string(faces.columns) + "x" +
                                std::to_string(faces.rows) +
                                (m_stored ? " stored " + std::to_string(*first.moves) : "");
        m_stacks = stacks.get(key, [&] {
            return std::make_shared<const SourceStacks>(
                make_source_stacks(taken(images), specs, *m_pictures, m_space));
        });
    }

    /// The sources as they are stored, for channels that are only moved.
    void make_stored_stacks(std::vector<OpenSource>& images, const std::vector<ImageSpec>& specs,
                            const std::string& identity) {
        for (const OpenSource& open : images) keep_stored(open);
        static auto& stacks = *new Memo<const SourceStacks>(2);
        m_stored_stacks = stacks.get(identity, [&] {
            return std::make_shared<const SourceStacks>(
                make_source_stacks(taken(images), specs, *m_pictures, ""));
        });
    }

    static std::vector<std::unique_ptr<Source>> taken(std::vector<OpenSource>& images) {
        std::vector<std::unique_ptr<Source>> sources;
        for (OpenSource& open : images)
            sources.push_back(open.faces ? std::unique_ptr<Source>(std::move(open.faces))
                                         : std::move(open.image));
        return sources;
    }

    /// A cache would make float of what is stored otherwise; recipes are read by what they show.
    static void keep_stored(const OpenSource& open) {
        if (open.faces)
            open.faces->keep_stored();
        else if (const std::shared_ptr<const Content> content = open.content)
            open.image->keep_stored([content, part = open.part](const Box& box, std::byte* pixels) {
                content->read(part, 0, box, pixels);
            });
        else
            open.image->keep_stored();
    }

    /// A source that is a recipe stays open while this picture is, so that the cache that asks for it by its
    /// name does not make it again.
    OpenSource open_source(const SideFile& file, Opening& opening, int part) {
        if (file.faces) return {nullptr, nullptr, part, opening.open_faces(file, part)};
        if (!operation_of(file.name)) return {opening.open_file(file, part), nullptr, part};
        const std::shared_ptr<const Content> content =
            in_recipe(file.name, [&] { return opening.open(file.name, {}); });
        m_nested.push_back(content);
        return {std::make_unique<CacheSource>(
                    shared_cache(), cached_name(file.name, file.identity), file.name, part,
                    [&](int level) {
                        return level < content->levels(part) ? content->header(part, level) : ImageSpec();
                    }),
                content, part};
    }

    /// The part of a source that goes with `part` of `parts`: the same, or the only one.
    static int part_in(const SideFile& file, Opening& opening, int part, int parts) {
        const auto own = static_cast<int>(opening.parts_of(file).size());
        if (own != 1 && own != parts)
            throw Error("source \"" + printable(file.name) + "\" has " + std::to_string(own) +
                        " parts: must have 1, or as many as another has, " + std::to_string(parts));
        return own > 1 ? part : 0;
    }

    /// Its part that goes with `part` of `parts`, where it has as many, else its first.
    OpenSource open_or_none(const std::string& key, const SideFile& file, Opening& opening, int part,
                            int parts) {
        try {
            const auto own = static_cast<int>(opening.parts_of(file).size());
            if (own > 1 && own != parts) m_first_parts.insert(key.substr(key.find('/') + 1));
            return open_source(file, opening, own == parts ? part : 0);
        } catch (const Error&) {
            return {};
        }
    }

    /// Does a key name a source, or an image that is drawn as one ("picture/KEY" by its key)?
    static bool is_drawn(const Recipe& recipe, const std::string& key) {
        const auto has = [](const std::vector<std::string>& keys, const std::string& one) {
            return std::find(keys.begin(), keys.end(), one) != keys.end();
        };
        return has(recipe.operation->sources, key) || has(recipe.linked_images, key) ||
               has(recipe.linked_images, "picture/" + key);
    }

    /// The keys of files beside the sources of which only the first of several parts is read, as far as they have been.
    std::string first_parts() const {
        std::set<std::string> keys = m_first_parts;
        for (const auto& [key, file] : m_side_files)
            if (is_first_of_parts(file)) keys.insert(key.substr(0, key.find('/')));
        std::string all;
        for (const std::string& key : keys) all += (all.empty() ? "" : ", ") + key;
        return all;
    }

    static Size tile_of(const ParameterValues& values) {
        if (!values.knows("tile")) return {};
        const Size tile = values.extent("tile");
        return {tile.width, tile.height < 0 ? tile.width : tile.height};
    }

    /// Of several parts each says which it is, and keeps its name.
    void say_part(ImageSpec& spec) const {
        spec.attribute("anamorph:subimage", m_part);
        for (const char* name : {"oiio:subimagename", "view"})
            if (const OIIO::ParamValue* own = m_source->find_attribute(name))
                spec.attribute(name, own->get_string());
    }

    std::shared_ptr<Solved> solve(const Level& level) const {
        static auto& memo = *new Memo<Solved>(16);
        return memo.get(level.key, [&] {
            std::unique_ptr<const SolvedPicture> picture = level.request.solve();
            if (m_joined)
                picture = solved(
                    *joined_picture(*picture->of_maps(), *m_joined->picture->of_maps(), m_joined->shown)
                         .picture);
            return std::make_shared<Solved>(std::move(picture));
        });
    }

    Level& level(int subimage, int number) const {
        const std::lock_guard lock(m_mutex);
        const auto [found, is_new] = m_known.try_emplace({subimage, number});
        if (is_new) {
            Level& made = found->second;
            made.request = *m_pictures->picture(subimage, number);
            // Windows of coarser levels would not lie on pixels.
            made.request.keeps_format = made.request.keeps_format && m_levels == 1;
            made.key = m_key + "frame " + std::to_string(subimage) + " level " + std::to_string(number);
            made.header = picture_spec(m_source ? &*m_source : nullptr, made.request, m_stored, true);
            // Channels that are moved keep the type of all of them.
            if (m_moves_channels && made.header.channelformats.empty()) made.header.format = m_source->format;
            if (!m_part.empty()) say_part(made.header);
            add_attributes(made.header, m_lenses);
            if (!m_said_of_chain.empty()) made.header.attribute("anamorph:chain", m_said_of_chain);
            if (m_joined)
                made.header.attribute(
                    "anamorph:tol", std::min(m_joined->tol, made.header.get_float_attribute("anamorph:tol")));
            const bool tiled = m_tile.width > 0 && m_tile.height > 0;
            made.header.tile_width = tiled ? m_tile.width : 0;
            made.header.tile_height = tiled ? m_tile.height : 0;
        }
        return found->second;
    }

    std::optional<ImageSpec> m_source;  ///< of the first source, upright
    std::unique_ptr<const Pictures> m_pictures;
    std::string m_key;                    ///< of the operation
    Attributes m_lenses;                  ///< what lenses of a database are
    std::string m_part;                   ///< which of several parts is drawn, "0 of 3"
    std::string m_chain;                  ///< the maps that the picture is drawn through, "pano of lens"
    std::string m_said_of_chain;          ///< what the picture says of that where its source is a recipe
    std::set<std::string> m_first_parts;  ///< keys of images that are drawn of which only the first part is
    std::vector<std::pair<std::string, SideFile>> m_side_files;  ///< files that are not drawn, by their keys
    std::optional<JoinSource> m_joined;
    std::string m_space;  ///< the color space that sources are filtered in
    std::vector<std::shared_ptr<const Content>> m_nested;
    std::shared_ptr<const SourceStacks> m_stacks;
    Size m_tile;
    bool m_prefers_scanlines = false, m_says_hash = false;
    std::optional<bool> m_says_reached;  ///< none where the operation has no key of it
    int m_levels = 1;
    bool m_stored = false;                                ///< as moves_stored() says
    bool m_moves_channels = false;                        ///< as moves_channels_stored() says
    std::shared_ptr<const SourceStacks> m_stored_stacks;  ///< for that
    mutable std::mutex m_mutex;
    mutable std::map<std::pair<int, int>, Level> m_known;  ///< by frame and MIP level
};

/// The pictures of all parts of a recipe's source, one after the other. The last few are kept.
class PartsContent final : public Content {
  public:
    PartsContent(const Recipe& recipe, int count) : m_recipe(recipe), m_count(count) {}

    int subimages() const override { return m_count; }
    int levels(int subimage) const override {
        const std::shared_ptr<const RecipeContent> content = part_or_none(subimage);
        return content ? content->levels(0) : 1;
    }
    /// A host that is told of no part takes those before it for all. So of one that cannot be drawn it is told what it
    /// knows of the first, and why when it reads it.
    const ImageSpec& spec(int subimage, int level) const override {
        const std::lock_guard lock(m_mutex);
        const auto found = m_specs.find({subimage, level});
        if (found != m_specs.end()) return found->second;
        const std::shared_ptr<const RecipeContent> content = part_or_none(subimage);
        return m_specs[{subimage, level}] = content ? content->spec(0, level) : part(0)->spec(0, 0);
    }
    void read(int subimage, int level, const Box& box, std::byte* pixels) const override {
        part(subimage)->read(0, level, box, pixels);
    }
    bool prefers_scanlines() const override { return part(0)->prefers_scanlines(); }
    std::optional<JoinSource> join_source(int subimage) const override {
        return part(subimage)->join_source(0);
    }

    /// The picture of one part, made by an opening that goes on, or by one that all of them share.
    std::shared_ptr<const RecipeContent> part(int i, Opening* opening = nullptr) const {
        return m_parts.get(std::to_string(i), [&] {
            const std::lock_guard lock(m_opening_later);
            return std::make_shared<const RecipeContent>(m_recipe, opening ? *opening : m_later, i, m_count);
        });
    }

  private:
    static constexpr std::size_t kKept = 4;

    std::shared_ptr<const RecipeContent> part_or_none(int i) const {
        try {
            return part(i);
        } catch (const Error&) {
            return nullptr;
        }
    }

    Recipe m_recipe;
    int m_count;
    mutable std::mutex m_opening_later;
    mutable Opening m_later;
    mutable Memo<const RecipeContent> m_parts{kKept};
    mutable std::mutex m_mutex;
    mutable std::map<std::pair<int, int>, ImageSpec> m_specs;  ///< by part and level
};

/// The part that `asked` names, by its name or number.
int part_named(const std::string& asked, const std::vector<std::string>& parts) {
    const auto found = std::find(parts.begin(), parts.end(), asked);
    if (found != parts.end() && !asked.empty()) return static_cast<int>(found - parts.begin());
    const bool is_number =
        !asked.empty() && asked.size() < 9 && asked.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && std::stoul(asked) < parts.size()) return std::stoi(asked);
    std::string names;
    for (const std::string& name : parts)
        if (!name.empty()) names += (names.empty() ? ", or one of " : ", ") + printable(name);
    throw Error("subimage", printable(asked),
                "must be an integer from 0 to " + std::to_string(parts.size() - 1) + names);
}

/// What a recipe shows: the pictures of one part of its source, or of all.
std::shared_ptr<const Content> content_of(const Recipe& recipe, Opening& opening) {
    std::vector<std::string> parts(1);
    for (const SideFile& file : sources_of(recipe))
        if (std::vector<std::string> own = opening.parts_of(file); own.size() > parts.size())
            parts = std::move(own);
    const auto count = static_cast<int>(parts.size());
    const bool is_asked = recipe.values.knows("subimage") && recipe.values.given("subimage");
    if (is_asked || count == 1)
        return std::make_shared<const RecipeContent>(
            recipe, opening, is_asked ? part_named(recipe.values.text("subimage"), parts) : 0, count);
    auto all = std::make_shared<const PartsContent>(recipe, count);
    const std::shared_ptr<const RecipeContent> first = all->part(0, &opening);
    if (first->subimages() > 1) return first;
    return all;
}

std::shared_ptr<const Content> Opening::open(const std::string& name, const std::vector<Assignment>& config) {
    const Recipe recipe = m_reader.load(name, config);
    std::shared_ptr<const Content>& content = m_open[recipe.identity];
    if (!content) content = OpenPictures::instance().find(recipe.identity);
    if (content) return content;
    std::shared_ptr<const Content> made = content_of(recipe, *this);
    OpenPictures::instance().add(recipe.identity, made);
    return m_open[recipe.identity] = made;
}

std::unique_ptr<CacheSource> Opening::open_file(const SideFile& file, int part) {
    const std::shared_ptr<const Header> header = header_of(file, part);
    std::unique_ptr<CacheSource> source = std::move(m_opened[{file.name, part}]);
    if (!source)
        source = std::make_unique<CacheSource>(
            shared_cache(), cached_name(file.name, file.identity), file.name, part, [&](int level) {
                const auto i = static_cast<std::size_t>(level);
                return i < header->levels.size() ? header->levels[i] : ImageSpec();
            });
    source->keep_rows();
    return source;
}

/// The header of a part of a file, read once while the file is what it is; the file is then kept for open_file().
std::shared_ptr<const Opening::Header> Opening::header_of(const SideFile& file, int part) {
    const std::pair<std::string, int> key(file.name, part);
    std::shared_ptr<const Header>& header = m_headers[key];
    if (header) return header;
    const auto read = [&] {
        std::unique_ptr<CacheSource>& source = m_opened[key];
        source = std::make_unique<CacheSource>(shared_cache(), cached_name(file.name, file.identity),
                                               file.name, part);
        return std::make_shared<const Header>(Header{source->parts(), source->specs()});
    };
    constexpr std::size_t kKept = 256;
    static auto& memo = *new Memo<const Header>(kKept);
    int unassociated = 0;
    shared_cache()->getattribute("unassociatedalpha", unassociated);
    // What has no state may change without a trace.
    header = file_state(file.name).empty()
                 ? read()
                 : memo.get(std::to_string(part) + " " + std::to_string(unassociated) + "\n" + file.name +
                                "\n" + file.identity,
                            read);
    return header;
}

SideFile face_of(const FaceFiles& faces, std::size_t i) {
    return {faces.names[i], faces.identities[i], true};
}

std::unique_ptr<FaceSource> Opening::open_faces(const SideFile& file, int part) {
    const FaceFiles& faces = *file.faces;
    std::vector<std::unique_ptr<CacheSource>> files;
    for (std::size_t i = 0; i < faces.names.size(); ++i) files.push_back(open_file(face_of(faces, i), part));
    return std::make_unique<FaceSource>(std::move(files), faces);
}

std::vector<std::string> Opening::parts_of(const SideFile& file) {
    if (file.faces) {
        const std::vector<std::string> parts = parts_of(face_of(*file.faces, 0));
        for (std::size_t i = 1; i < file.faces->names.size(); ++i)
            if (const auto own = parts_of(face_of(*file.faces, i)).size(); own != parts.size())
                throw Error("source \"" + printable(file.faces->names[i]) + "\" has " + std::to_string(own) +
                            " parts: must have as many as \"" + printable(file.faces->names[0]) + "\", " +
                            std::to_string(parts.size()));
        return parts;
    }
    if (operation_of(file.name))
        return std::vector<std::string>(
            static_cast<std::size_t>(in_recipe(file.name, [&] { return open(file.name, {}); })->subimages()));
    return header_of(file, 0)->parts;
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
