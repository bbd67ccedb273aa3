// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/pano_project.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/image/layered_picture.h"
#include "anamorph/image/masked_source.h"
#include "anamorph/number/hypot.h"
#include "anamorph/operation/film.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/pano_formula.h"
#include "anamorph/operation/read_once.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/panorama/hugin_project.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

const char* const kProjectRows[] = {"image", "layers", "feather"};
/// What a project says itself, and what is drawn in another way.
const char* const kRowsOfOneSource[] = {
    "from",       "srcfov",  "srcvfov",   "srcfocal",    "srcsensor",  "srccrop",  "srcd",       "srcyaw",
    "srcpitch",   "srcroll", "srclens",   "pixels",      "machine",    "stereo",   "eye",        "srce",
    "srcpadding", "seam",    "front_yaw", "front_pitch", "front_roll", "back_yaw", "back_pitch", "back_roll"};

std::shared_ptr<const HuginProject> read_project(const SideFile& file, const SideFileReader& reader) {
    return read_once<HuginProject>(file, "hugin project",
                                   [&] { return parse_hugin_project(reader.text(file.name), file.name); });
}

/// The numbers of the images that are drawn.
std::vector<std::size_t> drawn_images(const ParameterValues& values, const HuginProject& project) {
    if (values.given("image")) {
        const auto one = static_cast<std::size_t>(values.whole("image"));
        if (one >= project.images.size())
            throw Error("image", values.text("image"),
                        "must be the number of an image of the project, 0 to " +
                            std::to_string(project.images.size() - 1));
        return {one};
    }
    std::vector<std::size_t> all(project.images.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
}

/// An image as it is drawn.
struct ProjectImage {
    Chart chart;
    Orientation held;
    SourceMask mask;
    bool is_cut;         ///< has the mask anything that is not drawn?
    bool sees_no_plane;  ///< does a part of it look away from the plane of its transfer?

    Box shown() const { return mask.rectangle.value_or(Box{0, 0, chart.width(), chart.height()}); }
};

SourceMask mask_of(const HuginImage& image) {
    SourceMask mask;
    mask.holes = image.masks;
    if (!image.crop) return mask;
    const Box& crop = *image.crop;
    mask.rectangle = intersection(crop, {0, 0, image.size.width, image.size.height});
    if (mask.rectangle->empty())
        throw Error("S: must have pixels of the image, " + std::to_string(image.size.width) + "x" +
                    std::to_string(image.size.height));
    if (image.is_round)
        mask.circle = {{{0.5 * (crop.x0 + crop.x1), 0.5 * (crop.y0 + crop.y1)},
                        0.5 * std::min(crop.width(), crop.height())}};
    return mask;
}

/// How far a ray of an image looks toward the plane that its camera's transfer is about; where that is not positive it meets none.
class TowardPlane {
  public:
    TowardPlane(const Chart& chart, const HuginImage& image) : m_chart(chart) {
        const glm::dvec3 n = image.transfer->normal();
        const auto [x, y, z] = image.transfer->camera;
        const double before = 1 - glm::dot(n, glm::dvec3(x, y, z));
        m_toward = glm::transpose(rotation({image.yaw, image.pitch, image.roll})) * (before < 0 ? -n : n);
    }
    template <class T>
    T operator()(const T& x, const T& y) const {
        const Ray<T> ray = m_chart.ray(x, y, 0);
        return ray.x * m_toward.x + ray.y * m_toward.y + ray.z * m_toward.z;
    }
    /// Is it possible that a part of the image looks away?
    bool may_look_away() const {
        constexpr int kParts = 32;
        const auto part = [](int i, int size) {
            return Interval(1.0 * i * size / kParts, (i + 1.0) * size / kParts);
        };
        for (int i = 0; i < kParts * kParts; ++i) {
            const Interval x = part(i % kParts, m_chart.width()), y = part(i / kParts, m_chart.height());
            if (!(m_chart.inside(x, y, 0).hi < 0) && !((*this)(x, y).lo > 0)) return true;
        }
        return false;
    }

  private:
    Chart m_chart;
    glm::dvec3 m_toward;
};

ProjectImage drawn(const HuginImage& image) {
    const auto is_given = [](double value) { return value != 0; };
    const auto shift = image.lens.end() - 2;  // d and e
    LensModel lens;
    VerticalField vertical;
    Orientation held{image.yaw, image.pitch, image.roll};
    held.transfer = image.transfer;
    if (rows_turn(image.projection) && std::none_of(image.lens.begin(), shift, is_given)) {
        // Without a lens a picture whose columns are azimuths is shifted by looking elsewhere, and having its horizon elsewhere.
        if (shift[1] != 0) vertical.horizon = 0.5 * image.size.height + shift[1];
        held.ahead = -shift[0] * image.fov / image.size.width;
        if (held.ahead != 0 && image.transfer)
            throw Error("d" + brief(shift[0]) + ": must be 0 with TrX, TrY or TrZ");
    } else if (std::any_of(image.lens.begin(), image.lens.end(), is_given)) {
        lens = {LensModel::Kind::ptlens, {image.lens.begin(), image.lens.end()}};
    }
    const Chart chart(image.projection, image.size.width, image.size.height, image.fov, PixelSpacing::edges,
                      "", 1, lens, vertical);
    SourceMask mask = mask_of(image);
    bool sees_no_plane = false;
    if (image.transfer) {
        const TowardPlane toward(chart, image);
        sees_no_plane = toward.may_look_away();
        if (sees_no_plane) mask.shows = [toward](double x, double y) { return toward(x, y) > 0; };
    }
    return {chart, held, mask, image.crop || !image.masks.empty() || sees_no_plane, sees_no_plane};
}

// --- Weights -----------------------------------------------------------------------------------------------

/// How far within the edges of what an image shows a point of it lies, in pixels: those of the image and of its crop, which may be
/// round. A seam is none, nor a pole.
class EdgeDistance {
  public:
    explicit EdgeDistance(const ProjectImage& image)
        : m_box(image.shown()),
          m_circle(image.mask.circle),
          m_has_sides(image.mask.rectangle || !image.chart.closed()),
          m_has_ends(image.mask.rectangle || !image.chart.reaches_poles()) {}

    double operator()(const Point<double>& p) const {
        double least = m_circle ? m_circle->radius - hypot(p.x - m_circle->middle.x, p.y - m_circle->middle.y)
                                : HUGE_VAL;
        if (m_has_sides) least = std::min({least, p.x - m_box.x0, m_box.x1 - p.x});
        if (m_has_ends) least = std::min({least, p.y - m_box.y0, m_box.y1 - p.y});
        return least;
    }
    /// The largest that is finite.
    double most() const {
        const double across = m_has_sides ? m_box.width() : HUGE_VAL,
                     down = m_has_ends ? m_box.height() : HUGE_VAL;
        return 0.5 * std::min(across, down);
    }

  private:
    Box m_box;
    std::optional<SourceMask::Circle> m_circle;
    bool m_has_sides, m_has_ends;
};

/// A weight that rises with the distance of a pixel's source point from the image's edges, to 1 at `feather` pixels. Source points
/// are exact but for rounding, of pixels' middles.
class EdgeWeights {
  public:
    EdgeWeights(const Panorama& map, const EdgeDistance& distance, double feather)
        : m_map(std::make_shared<const Panorama>(map)),
          m_pieces(map.target_pieces()),
          m_distance(distance),
          m_feather(feather) {}

    /// `box`: pixels from the corner of the target on.
    void operator()(const Box& box, float* weights, const ParallelFor& parallel_for) const {
        parallel_for(box.height(), [&](std::int64_t row) {
            float* to = weights + row * box.width();
            for (int x = box.x0; x < box.x1; ++x)
                *to++ = static_cast<float>(weight(x + 0.5, static_cast<double>(box.y0 + row) + 0.5));
        });
    }

  private:
    /// The least weight, so that wherever an image is seen alone it is.
    static constexpr double kLeast = 0x1p-20;

    double weight(double x, double y) const {
        Point<double> point{};
        int piece = 0;
        if (!m_map->exact(x, y, target_piece(x, y), point, piece)) return kLeast;
        return std::clamp(m_distance(point) / m_feather, kLeast, 1.0);
    }
    int target_piece(double x, double y) const {
        for (std::size_t i = 1; i < m_pieces.size(); ++i) {
            const Box& box = m_pieces[i];
            if (x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1) return static_cast<int>(i);
        }
        return 0;
    }

    std::shared_ptr<const Panorama> m_map;
    std::vector<Box> m_pieces;
    EdgeDistance m_distance;
    double m_feather;
};

// --- Pictures ----------------------------------------------------------------------------------------------

/// All images over each other, as asked for.
struct LayersRequest {
    std::vector<ProjectImage> images;
    Chart target;
    Orientation look;
    ReprojectOptions options;
    Layering layering = Layering::over;
    std::optional<double> feather = {};
    int channels = 0, alpha = -1;  ///< of every source
    Attribute from;
};

class SolvedLayers final : public SolvedPicture {
  public:
    explicit SolvedLayers(const LayersRequest& request) : m_output(request.options.output) {
        m_layers.layering = request.layering;
        m_layers.alpha = request.alpha >= 0 ? request.alpha : request.channels;
        m_layers.shows_alpha = m_output == Output::coverage;
        Picture maps;
        for (std::size_t i = 0; i < request.images.size(); ++i) {
            Picture picture = layer(request, static_cast<int>(i));
            maps.maps.push_back(picture.maps.front());
            m_layers.layers.push_back({std::move(picture), weights(request, request.images[i])});
        }
        maps.filter = request.options.filter;
        maps.output = m_output;
        maps.overscan = request.options.overscan;
        m_maps = solved(std::move(maps));
    }

    Attributes reached(const ParallelFor& parallel_for) const override {
        return m_maps->reached(parallel_for);
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        if (m_output != Output::color && m_output != Output::coverage)
            return m_maps->draw(sources, box, view, parallel_for);
        return m_layers.draw(sources, box, view, parallel_for);
    }

  private:
    static Picture layer(const LayersRequest& request, int i) {
        const ProjectImage& image = request.images[static_cast<std::size_t>(i)];
        ReprojectOptions options = request.options;
        // Errors and bounds are of all that the map has, as elsewhere.
        if (options.output == Output::coverage) options.output = Output::color;
        options.adds_alpha = false;
        Picture picture =
            reprojected_picture(Panorama(image.chart, request.target, request.look, image.held), options);
        picture.maps.front().layers.front().source = i;
        return picture;
    }
    /// Nothing where all weights are 1.
    static std::function<void(const Box&, float*, const ParallelFor&)> weights(const LayersRequest& request,
                                                                               const ProjectImage& image) {
        const EdgeDistance distance(image);
        const double feather =
            request.feather.value_or(request.layering == Layering::mean ? distance.most() : 0);
        if (!(feather > 0 && feather < HUGE_VAL) || request.images.size() == 1) return {};
        const Panorama map(image.chart, request.target, request.look, image.held);
        return [weights = EdgeWeights(map, distance, feather), overscan = request.options.overscan](
                   const Box& box, float* values, const ParallelFor& parallel_for) {
            weights(moved(box, -overscan.width, -overscan.height), values, parallel_for);
        };
    }

    Output m_output;
    LayeredPicture m_layers;
    std::unique_ptr<const SolvedPicture> m_maps;
};

class Layers final : public Pictures {
  public:
    explicit Layers(LayersRequest request) : m_request(std::move(request)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        LayersRequest request = m_request;
        std::optional<PanoramaLevel> made =
            panorama_level(request.target, request.options, pixels_of(request.options.output), level);
        if (!made) return {};
        request.target = made->target;
        PictureRequest& picture = made->request;
        picture.says.push_back({"anamorph:tol", request.options.tol});
        picture.says.push_back(request.from);
        picture.solve = [request] { return std::make_unique<SolvedLayers>(request); };
        return std::move(picture);
    }
    std::unique_ptr<Source> over_source(std::size_t i, const Source& source) const override {
        return std::make_unique<MaskedSource>(source, m_request.images.at(i).mask, m_request.alpha);
    }

  private:
    LayersRequest m_request;
};

/// Pictures of a project, with what they say of it, and of which a part is drawn in its place in the whole, the display window.
class ProjectPictures final : public Pictures {
  public:
    ProjectPictures(std::unique_ptr<const Pictures> whole, std::optional<Box> crop, std::string not_applied)
        : m_whole(std::move(whole)), m_crop(crop), m_not_applied(std::move(not_applied)) {}

    int frames() const override { return m_whole->frames(); }
    std::optional<PictureRequest> picture(int frame, int level) const override {
        if (m_crop && level > 0) return {};
        std::optional<PictureRequest> request = m_whole->picture(frame, level);
        if (!request) return {};
        if (!m_not_applied.empty()) request->says.push_back({"anamorph:not_applied", m_not_applied});
        if (m_crop) crop(*request, *m_crop);
        return request;
    }
    SourceFaces faces() const override { return m_whole->faces(); }
    std::unique_ptr<Source> over_source(std::size_t i, const Source& source) const override {
        return m_whole->over_source(i, source);
    }

  private:
    class Cropped final : public SolvedPicture {
      public:
        Cropped(std::unique_ptr<const SolvedPicture> whole, const Box& crop)
            : m_whole(std::move(whole)), m_crop(crop) {}
        Attributes reached(const ParallelFor& parallel_for) const override {
            return m_whole->reached(parallel_for);
        }
        std::unique_ptr<const SolvedPicture> of_moved() const override {
            std::unique_ptr<const SolvedPicture> moved = m_whole->of_moved();
            return moved ? std::make_unique<Cropped>(std::move(moved), m_crop) : nullptr;
        }
        bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                  const ParallelFor& parallel_for) const override {
            return m_whole->draw(sources, moved(box, m_crop.x0, m_crop.y0), view, parallel_for);
        }

      private:
        std::unique_ptr<const SolvedPicture> m_whole;
        Box m_crop;
    };
    static void crop(PictureRequest& request, const Box& part) {
        request.display = moved({0, 0, request.size.width, request.size.height}, -part.x0, -part.y0);
        request.size = {part.width(), part.height()};
        request.solve = [solve = request.solve, part] { return std::make_unique<Cropped>(solve(), part); };
    }

    std::unique_ptr<const Pictures> m_whole;
    std::optional<Box> m_crop;
    std::string m_not_applied;
};

// --- Requests ----------------------------------------------------------------------------------------------

/// All that the pictures of any frame share.
struct ProjectRequest {
    std::shared_ptr<const HuginProject> project;
    std::string name;
    std::vector<std::size_t> numbers;
    std::vector<ProjectImage> images;
    std::vector<SourceImage> sources;

    bool is_layered() const { return images.size() > 1 || images[0].is_cut; }
    std::string of_all() const { return " of a project of " + std::to_string(project->images.size()); }
    /// The first source.
    TakenSource first() const { return {images[0].chart, "image " + std::to_string(numbers[0]) + of_all()}; }
    /// What is said of the source of all.
    Attribute says() const {
        if (images.size() == 1) return first().says();
        return {"anamorph:from", std::to_string(images.size()) + " layers" + of_all()};
    }
};

/// The values with what the project's panorama says where they say nothing, and its crop, where that is drawn.
struct TargetValues {
    ParameterValues values;
    std::optional<Box> crop = {};
};
TargetValues with_target(const ParameterValues& given, const ProjectRequest& request) {
    TargetValues target{given};
    if (given.given("to")) return target;
    if (!request.project->panorama)
        throw Error::not_given("to", " and \"" + printable(request.name) +
                                         "\" has no row p: must be one of " + projection_names());
    const HuginPanorama& panorama = *request.project->panorama;
    try {
        panorama.check(request.name);
    } catch (const Error& error) {
        throw Error::not_given("to", ": " + std::string(error.what()));
    }
    const auto is_given = [&](std::initializer_list<const char*> names) {
        return std::any_of(names.begin(), names.end(), [&](const char* name) { return given.given(name); });
    };
    target.values.set("to", std::string(name_of(panorama.projection)));
    const bool has_field = is_given({"fov", "vfov", "focal"});
    if (!has_field) target.values.set("fov", panorama.fov);
    if (panorama.d && !given.given("d")) target.values.set("d", *panorama.d);
    if (!given.given("size")) target.values.set("size", panorama.size);
    if (given.given("size") && given.extent("size").height < 0) {
        const double width = given.extent("size").width;
        const double height = std::round(width * panorama.size.height / panorama.size.width);
        target.values.set("size", Size{static_cast<int>(width),
                                       static_cast<int>(std::clamp(height, 1.0, double{kMaxSide}))});
    }
    if (!has_field && !is_given({"size", "lens", "overscan", "padding"})) target.crop = panorama.crop;
    return target;
}

/// Refuses rows that a project says itself, be they values or key frames.
void check_rows(const ParameterValues& values) {
    for (const char* name : kRowsOfOneSource)
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "must not be given with a project of Hugin as src");
    for (const char* name : {"layers", "feather"})
        if (values.given(name) && values.given("image"))
            throw Error(name, printable(values.text(name)),
                        "must not be given with image, of which there is one");
}

/// Refuses ways of drawing that projects have not.
void check_ways(const ParameterValues& values) {
    if (values.text("scheme") == "hardware")
        throw Error("scheme", "hardware", "must not be given with a project of Hugin as src");
    if (values.given("machine"))
        throw Error("machine", printable(values.text("machine")),
                    "must not be given with a project of Hugin as src");
    if (has_formula(values)) throw Error("to", "formula", "must not be given with a project of Hugin as src");
    if (values.given("face") && !values.given("to"))
        throw Error("face", values.text("face"), "must be given together with to");
}

/// What layers cannot be.
void check_layered(const ParameterValues& values, const std::vector<ProjectImage>& images) {
    const bool is_single = images.size() == 1;
    if (values.number("shutter") > 0)
        throw Error("shutter", printable(values.text("shutter")),
                    "must be of an image that is not cropped: of a project, with image=N");
    if (is_stmap(rows::chosen_output(values)) && !is_single)
        throw Error("output", values.text("output"), "must be of one image: with image=N");
    if (is_stmap(rows::chosen_output(values)) && images[0].sees_no_plane)
        throw Error("output", values.text("output"),
                    "must be of an image of which no part looks away from its plane (TrX to Tpp)");
    const auto wrap = rows::chosen<Wrap>(values, "wrap");
    if (wrap != Wrap::automatic && wrap != Wrap::black)
        throw Error("wrap", values.text("wrap"),
                    "must be automatic or black where images of a project are layered or cropped");
    for (const char* name : {"data_channels", "data_filter"})
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "must not be given where images of a project are layered or cropped: their channels "
                        "are mixed");
}

std::string name_of_image(const HuginProject& project, std::size_t number) {
    return "image " + std::to_string(number) + " (" + printable(project.images[number].file) + ")";
}

/// The images are those that the project was made of, and go together.
void check_sources(const ProjectRequest& request, const ParameterValues& values) {
    for (std::size_t i = 0; i < request.sources.size(); ++i) {
        const SourceImage &source = request.sources[i], &first = request.sources[0];
        const std::string name = name_of_image(*request.project, request.numbers[i]),
                          first_name = name_of_image(*request.project, request.numbers[0]);
        const Size said = request.project->images[request.numbers[i]].size;
        if (!(source.size() == said))
            throw Error(name + " is " + std::to_string(source.facts.width) + "x" +
                        std::to_string(source.facts.height) + " and its project says " +
                        std::to_string(said.width) + "x" + std::to_string(said.height) +
                        ": must be the same");
        if (source.channels != first.channels || source.alpha != first.alpha)
            throw Error(name + " has " + std::to_string(source.channels) + " channels and " + first_name +
                        " " + std::to_string(first.channels) + ": must be the same, with alpha in one place");
        check_color_space(source, name, first, first_name, values);
    }
}

ProjectRequest read_request(const OperationInput& input) {
    const SideFile& file = input.files.at("src");
    ProjectRequest request{read_project(file, input.reader), file.name, {}, {}, input.sources};
    request.numbers = drawn_images(input.values, *request.project);
    if (request.numbers.size() != input.sources.size())
        throw Error("sources", std::to_string(input.sources.size()),
                    "must be the " + std::to_string(request.numbers.size()) +
                        " images of the project that are drawn");
    for (const std::size_t number : request.numbers)
        text_file::in_entry(file.name, name_of_image(*request.project, number),
                            [&] { request.images.push_back(drawn(request.project->images[number])); });
    check_sources(request, input.values);
    return request;
}

ReprojectOptions read_options(const ParameterValues& values, const SourceFacts& facts, const Chart& target) {
    ReprojectOptions options = read_reproject_options(values, facts);
    options.scheme = rows::chosen<Scheme>(values, "scheme");
    options.overscan = read_overscan(values, target);
    options.source_overscan = false;
    return options;
}

}  // namespace

ParameterTable rows::project() {
    return {
        whole("image", "", "", 0, static_cast<int>(kMostHuginImages) - 1,
              "of a project of Hugin as src: the image that is drawn, by its number there, from 0; by "
              "default all of them, over each other"),
        enumeration(
            "layers", "order", {{"order", Layering::over}, {"blend", Layering::mean}},
            "of the images of a project, which are seen where they overlap: order, later images cover those "
            "before them; blend, their mean, by weights that rise from their edges"),
        number("feather", "source pixels", "", 0, 1e6,
               "of layers: the distance from an image's edges, or those of its crop, at which its weight has "
               "risen from 0 to 1; by "
               "default 0 for order, and for blend the distance of its middle"),
    };
}

bool is_of_project(const SideFiles& files) {
    return !pano_operation().gathering_file(files).empty();
}

void refuse_rows_of_projects(const ParameterValues& values) {
    for (const char* name : kProjectRows)
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "must be given together with a project of Hugin as src, x.pto");
}

LinkedFiles images_of_project(const ParameterValues& values, const SideFiles& files,
                              const SideFileReader& reader) {
    if (!is_of_project(files)) return {};
    const SideFile& file = files.at("src");
    const HuginProject project = parse_hugin_project(reader.text(file.name), file.name);
    const std::filesystem::path folder = std::filesystem::path(file.name).parent_path();
    LinkedFiles images;
    for (const std::size_t number : drawn_images(values, project)) {
        project.images[number].check(file.name);
        images.push_back(
            {"src/" + std::to_string(number), (folder / project.images[number].file).string(), true});
    }
    return images;
}

std::unique_ptr<const Pictures> pictures_of_project(const OperationInput& input) {
    check_ways(input.values);
    const ProjectRequest request = read_request(input);
    if (request.is_layered()) check_layered(input.values, request.images);
    const auto make = [request](const ParameterValues& given) -> std::unique_ptr<const Pictures> {
        check_rows(given);
        const ParameterValues values = with_target(given, request).values;
        const SourceFacts& facts = request.sources[0].facts;
        const auto [target, look] = read_target_view(values, request.images[0].chart);
        const ReprojectOptions options = read_options(values, facts, target);
        if (!request.is_layered())
            return reprojected_pictures({request.first(), target, look, request.images[0].held, options});
        LayersRequest layers{request.images, target, look, options, {}, {}, {}, {}, request.says()};
        layers.layering = rows::chosen<Layering>(values, "layers");
        if (values.given("feather")) layers.feather = values.number("feather");
        layers.channels = request.sources[0].channels;
        layers.alpha = request.sources[0].alpha;
        return std::make_unique<Layers>(std::move(layers));
    };
    std::unique_ptr<const Pictures> pictures = film_pictures(input, make);
    return std::make_unique<ProjectPictures>(std::move(pictures), with_target(input.values, request).crop,
                                             request.project->not_applied);
}

}  // namespace anamorph
