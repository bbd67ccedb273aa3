// SPDX-License-Identifier: Apache-2.0
// Figures of ellipsoids, performed from scripts of NUDES: a film whose subimages are the frames.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/figure/image/mrasel_maps.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "anamorph/figure/outline/fit.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/operation/figure_look.h"
#include "anamorph/operation/figure_mips.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/read_once.h"
#include "anamorph/operation/rows.h"

namespace anamorph {
namespace {

constexpr int kDefaultSide = 1000;
constexpr int kMostFrameNumber = 1'000'000;
// A host that asks how many subimages there are looks at each.
constexpr int kMostSubimages = 100'000;
// The largest angles and places that users set.
constexpr double kFar = 1e9;
// Chords of outlines, in pixels.
constexpr double kChordError = 0.02;

/// What else Filter::antialias may average by.
const std::vector<rows::Word>& averages() {
    static const std::vector<rows::Word> words = {
        {"trilinear", figure::TextureAverage::trilinear,
         "between the two levels of a pyramid next to the longer side of what a pixel shows (Williams 1983)"},
        {"summed_area", figure::TextureAverage::summed_area,
         "the mean over the least rectangle along the texture's sides that covers what a pixel shows, from a "
         "table of sums (Crow 1984)"},
        {"mrasel", figure::TextureAverage::mrasel, "the nearest texel of the level that MRASEL takes"}};
    return words;
}

Parameter texture_filter() {
    Parameter row = rows::filter(averages());
    row.documentation = "of style textured: " + row.documentation;
    return row;
}

Parameter texture_clamp() {
    Parameter row = rows::clamp();
    row.documentation = "of style textured: " + row.documentation;
    return row;
}

void read_filter(const ParameterValues& values, figure::FigureLook& look) {
    const bool own = std::any_of(averages().begin(), averages().end(),
                                 [&](const rows::Word& word) { return word.name == values.text("filter"); });
    look.filter = own ? Filter::antialias : rows::filter_of(values);
    look.average =
        own ? rows::chosen<figure::TextureAverage>(values, "filter") : figure::TextureAverage::footprint;
}

/// What is performed, and which of it.
ParameterTable script_rows() {
    using namespace rows;
    return {
        file("script",
             "the script of NUDES, or a motion (.bvh), a crystal structure (.cif), frames (.3) or a frame of "
             "MRASEL (.mrasel); by default the recipe's name without .figure, and of a name that ends in .n, "
             ".nudes, .bvh, .cif or .mrasel that file itself"),
        file("library", "a file of figures without stop, included ahead of the script"),
        enumeration("dialect", "classic",
                    {{"classic", figure::Dialect::classic}, {"strict", figure::Dialect::strict}},
                    "classic: as the programs of 2003 ran scripts, but abut and touch end in exact contact; "
                    "strict: as the language is documented"),
        whole("frame", "", "", 0, kMostFrameNumber,
              "the frame of the script that is drawn, 0 the figures at rest; by default all that it shows, "
              "each a subimage"),
    };
}

/// How bodies are drawn, and under what light.
ParameterTable style_rows() {
    using namespace rows;
    return {
        rows::size("width and height of the picture, or its width alone; by default 1000x1000, a pixel for "
                   "each unit of the script's window, which is as large as fits"),
        overscan(),
        tile(),
        mip(),
        hash(),
        enumeration(
            "style", "shaded",
            {{"shaded", figure::FigureStyle::shaded},
             {"outline", figure::FigureStyle::outline},
             {"stick", figure::FigureStyle::stick},
             {"depth", figure::FigureStyle::depth},
             {"id", figure::FigureStyle::id},
             {"uv", figure::FigureStyle::uv},
             {"textured", figure::FigureStyle::textured}},
            "shaded, bodies in their colors; outline, without hidden lines; stick, from joint to joint; "
            "depth, from the eye, without perspective from the plane through the place, in units, 1e30 "
            "where there is no body; id, 1 for the first body, 0 for none; uv, the point of a body's "
            "texture, (-1, -1) for none; textured, shaded, with the pictures that the script names"),
        choice("output", "picture", {"picture", "mips"},
               "picture; mips, the pyramid of each texture in one picture, each a subimage: the level in "
               "three quarters, red, green and blue, in the fourth the next level alike"),
        toggle("antialias", "1",
               "of styles shaded and textured: pixels are the mean of 16 x 16 samples; 0: what is in their "
               "middle"),
        enumeration(
            "lighting", "rasel",
            {{"rasel", figure::Lighting::rasel},
             {"lambert", figure::Lighting::lambert},
             {"blinn", figure::Lighting::blinn}},
            "of styles shaded and textured: rasel, soft from one pole of a body to the other; lambert; "
            "blinn, with highlights"),
        numbers("light", -kInfinity,
                "x,y,z: the direction to the light, x to the right, y up, z away; by default 0,1,0, and for "
                "lambert and blinn -1,2,-2"),
        number("ambient", "", "0.3", 0, 1, "the share of light that comes from everywhere"),
        number("specular", "", "0.3", 0, 1, "of blinn: how strong highlights are"),
        number("shininess", "", "30", 0, 10000, "of blinn: how narrow they are"),
        number(
            "perturbation", "", "0", 0, 1,
            "of styles shaded and textured: the most by which the light of a pixel is off at random, against "
            "contours where few intensities are shown; of n levels 0.5/(n-1) is half a step"),
        whole("seed", "", "0", 0, 1'000'000'000, "of the random numbers of perturbation"),
    };
}

/// Who sees them, before what.
ParameterTable figure_view_rows() {
    using namespace rows;
    return {
        numbers("camera", -kInfinity,
                "x,y,z in degrees: how space is turned before it is seen, as the script's observe does, in "
                "its place"),
        numbers("place", -kInfinity, "x,y,z: what is seen in the middle, in place of the script's place"),
        number("perspective", "units", "", 0.01, kFar,
               "distance of the eye from the place; by default no perspective"),
        toggle("fit", "0",
               "1: the figures fill the picture; without frame, those of all frames that are shown"),
        number("zoom", "", "1", 1e-6, 1e6, "magnifies about the middle"),
        numbers("background", 0,
                "red,green,blue, 0 to 255; or bands from above, end,red,green,blue each, the end a share of "
                "the height, 0 to 1; by default the bands of the frame, or transparent"),
        image("backdrop", "a picture behind the figures, stretched to the size, before the background"),
    };
}

/// The rows of textures, and what all styles of lines have.
ParameterTable line_rows() {
    using namespace rows;
    return {
        toggle("line_colors", "0", "of styles outline and stick: 1, lines in the colors of the bodies"),
        numbers("viewport", -kInfinity,
                "of styles outline and stick: x,y,a,b: the middle, from the upper left, each from -10 to 10, "
                "and the half-axes, from 0.0001 to 10, of an ellipse in shares of the picture's width and "
                "height; lines end at it"),
        enumeration(
            "mapping", "latlong",
            {{"latlong", figure::BodyMapping::latlong},
             {"mirrored", figure::BodyMapping::mirrored},
             {"linear", figure::BodyMapping::linear},
             {"octahedral", figure::BodyMapping::octahedral}},
            "of styles uv and textured, how a texture lies on a body: latlong, once around, the seam at "
            "the back; mirrored, over the front and again over the back; linear, stripes stay straight; "
            "octahedral, without a pole"),
        texture_filter(),
        texture_clamp(),
    };
}

ParameterTable make_figure_table() {
    ParameterTable table;
    for (const ParameterTable& part :
         {script_rows(),
          style_rows(),
          figure_relief_rows(),
          figure_view_rows(),
          {rows::number("line_width", "pixels", "1.5", 0.01, 1000, "of styles outline and stick")},
          figure_outline_rows(),
          line_rows()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

// --- Scripts -----------------------------------------------------------------------------------------------

/// What a script includes lies beside it.
std::string beside(const std::string& script, const std::string& name) {
    return (std::filesystem::path(script).parent_path() / name).string();
}

const SideFile& script_of(const SideFiles& files) {
    const auto found = files.find("script");
    if (found == files.end()) throw Error::not_given("script", ": must be the name of a script of NUDES");
    return found->second;
}

std::string short_name(const SideFile& file) {
    return std::filesystem::path(file.name).filename().string();
}

std::optional<std::string> text_or_none(const SideFileReader& reader, const std::string& name) {
    try {
        return reader.text(name);
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// `on_include(name)` hears of what the script and its libraries include.
figure::Script read_script(const ParameterValues& values, const SideFiles& files,
                           const SideFileReader& reader,
                           const std::function<void(const std::string& file)>& on_include = {}) {
    const SideFile& script = script_of(files);
    figure::ScriptOptions options;
    options.dialect = rows::chosen<figure::Dialect>(values, "dialect");
    const auto library = files.find("library");
    if (library != files.end()) options.libraries = {library->second.name};
    options.include = [&](const std::string& name) {
        const bool is_library = library != files.end() && name == library->second.name;
        const std::string file = is_library ? name : beside(script.name, name);
        if (on_include && !is_library) on_include(file);
        return text_or_none(reader, file);
    };
    return figure::parse_script(reader.text(script.name), short_name(script), options);
}

/// The file beside the script that a name means: that name, or one with the ending of a picture.
std::string picture_beside(const std::string& script, const std::string& name, const SideFileReader& reader) {
    const std::string file = beside(script, name);
    if (reader.exists(file)) return file;
    for (const char* ending : {".exr", ".tif", ".tx", ".png", ".jpg", ".ppm"}) {
        std::string known = file;
        known += ending;
        if (reader.exists(known)) return known;
    }
    return file;
}

bool are_mips(const ParameterValues& values) {
    return values.text("output") == "mips";
}

bool is_textured(const ParameterValues& values) {
    return are_mips(values) ||
           rows::chosen<figure::FigureStyle>(values, "style") == figure::FigureStyle::textured;
}

const char* const kTextureKey = "texture/";
const char* const kMapKey = "map/";

/// Adds the files of a texture: the maps that MTEXTURE makes of its name, or else a picture.
void add_texture(LinkedFiles& linked, const std::string& script, const std::string& name,
                 const SideFileReader& reader) {
    if (!reader.exists(figure::mrasel_map_file(beside(script, name), figure::kMraselSide))) {
        linked.push_back({kTextureKey + name, picture_beside(script, name, reader), true});
        return;
    }
    for (int level = 0; level < figure::kMraselMaps; ++level) {
        const std::string file = figure::mrasel_map_file(name, figure::MraselMaps::side(level));
        if (!reader.exists(beside(script, file)))
            throw Error(printable(file) + " does not exist: must be beside " +
                        printable(figure::mrasel_map_file(name, figure::kMraselSide)) +
                        ", as MTEXTURE writes it");
        linked.push_back({kMapKey + file, beside(script, file)});
    }
}

/// Maps of MRASEL, and a table of their sums where it is asked for.
struct MapTexture {
    explicit MapTexture(figure::MraselMaps read) : maps(std::move(read)) {}
    figure::MraselMaps maps;
    Pyramid pyramid{maps};
};

/// The maps that add_texture() found of a name; null where there are none.
std::shared_ptr<const Source> maps_of(const std::string& name, const OperationInput& input) {
    const auto first = input.files.find(kMapKey + figure::mrasel_map_file(name, figure::kMraselSide));
    if (first == input.files.end()) return nullptr;
    const std::string beside = first->second.name.substr(0, first->second.name.rfind('.'));
    const auto maps = std::make_shared<MapTexture>(figure::MraselMaps::read_from(
        beside, [&](const std::string& file) { return input.reader.text(file); }));
    return {maps, &maps->pyramid};
}

/// What scripts include, and, where they are drawn, their textures in the order of the program, and the backdrop.
LinkedFiles linked_files(const ParameterValues& values, const SideFiles& files,
                         const SideFileReader& reader) {
    LinkedFiles linked;
    const SideFile& file = script_of(files);
    const auto add_textures = [&](const std::vector<std::string>& names) {
        if (!is_textured(values)) return;
        for (const std::string& name : names) add_texture(linked, file.name, name, reader);
    };
    if (!figure::is_motion_file(file.name))
        add_textures(read_script(values, files, reader, [&](const std::string& included) {
                         linked.push_back({"script/" + included, included});
                     }).program.images);
    else if (is_textured(values))
        add_textures(figure::read_motion(reader.text(file.name), short_name(file))->images());
    const auto backdrop = files.find("backdrop");
    if (backdrop != files.end()) linked.push_back({"picture/backdrop", backdrop->second.name, true});
    const auto bump = files.find("bump");
    if (bump != files.end()) linked.push_back({"picture/bump", bump->second.name, true});
    return linked;
}

/// A motion that threads share.
class Film {
  public:
    explicit Film(std::unique_ptr<figure::Motion> motion) : m_motion(std::move(motion)) {
        for (const std::string& warning : m_motion->warnings())
            m_warnings += (m_warnings.empty() ? "" : "; ") + warning;
        m_first = m_motion->first_frame();
        m_step = m_motion->frame_step();
    }

    /// The frames that are shown; 1, that at rest, where there are none.
    int count() const {
        const std::lock_guard lock(*m_mutex);
        return std::max(1, m_motion->frame_count());
    }
    /// The warnings of the file, in one line.
    const std::string& warnings() const { return m_warnings; }
    /// The number of the i-th of these.
    int number(int i) const {
        const std::lock_guard lock(*m_mutex);
        return m_motion->frame_count() > 0 ? m_first + i * m_step : 0;
    }
    figure::FigureFrame frame(int number) const {
        const std::lock_guard lock(*m_mutex);
        return m_motion->frame(number);
    }
    const std::vector<std::string>& images() const { return m_motion->images(); }

  private:
    std::unique_ptr<std::mutex> m_mutex = std::make_unique<std::mutex>();
    std::unique_ptr<figure::Motion> m_motion;
    std::string m_warnings;
    int m_first = 1, m_step = 1;
};

std::unique_ptr<figure::Motion> open_motion(const OperationInput& input) {
    const SideFile& file = script_of(input.files);
    if (figure::is_motion_file(file.name))
        return figure::read_motion(input.reader.text(file.name), short_name(file));
    figure::Script read = read_script(input.values, input.files, input.reader);
    for (const figure::Diagnostic& d : read.diagnostics)
        if (d.severity == figure::Severity::error) throw Error(d.text());
    return std::make_unique<figure::Performance>(std::move(read.program));
}

std::shared_ptr<const Film> read_film(const OperationInput& input) {
    // Of all files that the motion is made of.
    std::string identity;
    for (const auto& [key, file] : input.files) identity += key + "\n" + file.identity + "\n";
    const SideFile& script = script_of(input.files);
    const std::string how = "figure " + input.values.text("dialect") + "\n" + identity;
    return read_once<Film>(script, how, [&] { return Film(open_motion(input)); });
}

// --- Pictures ----------------------------------------------------------------------------------------------

/// Where they are given.
std::optional<glm::dvec3> three(const ParameterValues& values, const char* name, double least, double most) {
    if (!values.given(name)) return std::nullopt;
    return rows::three_numbers(values, name, least, most);
}

/// What is asked for, but the frame.
struct FigureRequest {
    Size size;
    figure::FigureLook look;
    std::optional<glm::dvec3> camera, place;
    double zoom = 1, eye_distance = HUGE_VAL;
    bool fit = false;
    std::string missing;                              ///< textures
    std::vector<std::shared_ptr<const Source>> maps;  ///< of the textures, null where the host has a picture

    /// `extent`: that the view is fitted to, where it is.
    figure::View view_of(const figure::FigureFrame& frame, const figure::SeenExtent& extent,
                         const Size& of) const {
        const glm::dvec2 page(of.width, of.height);
        figure::View view = figure::view_in(frame, page);
        if (camera) view.rotation = glm::mat3_cast(figure::turn_xyz(*camera));
        if (place) view.center = *place;
        view.eye_distance = eye_distance;
        if (fit) figure::fit_view(view, extent, page);
        view.middle = 0.5 * page + zoom * (view.middle - 0.5 * page);
        view.scale *= zoom;
        return view;
    }
    void add_extent(const figure::FigureFrame& frame, figure::SeenExtent& extent) const {
        figure::add_seen_extent(frame, view_of(frame, figure::SeenExtent(), size), extent);
    }
};

figure::Light read_light(const ParameterValues& values) {
    figure::Light light;
    light.lighting = rows::chosen<figure::Lighting>(values, "lighting");
    light.toward = figure::usual_light(light.lighting);
    if (const auto given = three(values, "light", -kFar, kFar)) {
        const double size = std::max({std::fabs(given->x), std::fabs(given->y), std::fabs(given->z)});
        if (size == 0) throw Error("light", printable(values.text("light")), "must not be 0,0,0");
        light.toward = glm::normalize(*given / size);
    }
    light.ambient = values.number("ambient");
    light.specular = values.number("specular");
    light.shininess = values.number("shininess");
    return light;
}

/// The viewport in shares of the picture.
void read_viewport(const ParameterValues& values, figure::FigureLook& look) {
    if (!values.given("viewport")) return;
    const std::string text = values.text("viewport");
    look.lines.viewport = figure::viewport_of("viewport", text, values.numbers("viewport"));
    if (look.style != figure::FigureStyle::outline && look.style != figure::FigureStyle::stick)
        throw Error("viewport", printable(text), "is of styles outline and stick alone");
}

/// A colour, or bands.
void read_background(const ParameterValues& values, figure::FigureLook& look) {
    if (!values.given("background")) return;
    const std::vector<double>& numbers = values.numbers("background");
    if (numbers.size() % 4 != 0 || numbers.empty()) {
        look.background = rows::three_numbers(values, "background", 0, 255) / 255.0;
        return;
    }
    double from = 0;
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
        const figure::BackgroundBand band{numbers[i], {numbers[i + 1], numbers[i + 2], numbers[i + 3]}};
        const double most = std::max({band.color.r, band.color.g, band.color.b});
        if (!(band.end >= from && band.end <= 1 && most <= 255))
            throw Error(
                "background", printable(values.text("background")),
                "must be red,green,blue from 0 to 255, or bands of an end, ascending from 0 to 1, and these");
        look.bands.push_back(band);
        from = band.end;
    }
}

FigureRequest read_request(const ParameterValues& values) {
    FigureRequest request;
    request.size = rows::size_of(values, {kDefaultSide, kDefaultSide});
    figure::FigureLook& look = request.look;
    look.overscan = rows::overscan_of(values, request.size);
    look.style = rows::chosen<figure::FigureStyle>(values, "style");
    look.light = read_light(values);
    look.antialias = values.toggle("antialias");
    look.perturbation = values.number("perturbation");
    look.seed = values.whole("seed");
    const bool shaded =
        look.style == figure::FigureStyle::shaded || look.style == figure::FigureStyle::textured;
    if (!shaded && values.given("perturbation"))
        throw Error("perturbation", printable(values.text("perturbation")),
                    "is of styles shaded and textured alone");
    if (!values.given("perturbation") && values.given("seed"))
        throw Error("seed", printable(values.text("seed")), "must be given with perturbation");
    read_background(values, look);
    look.mapping = rows::chosen<figure::BodyMapping>(values, "mapping");
    read_filter(values, look);
    look.backdrop = values.given("backdrop");
    read_figure_relief(values, values.given("bump"), look);
    if (values.text("solid") == "formula" && !values.given("red") && !values.given("green") &&
        !values.given("blue"))
        throw Error("solid", "formula", "must be given with red, green or blue");
    look.lines.tol = kChordError;
    look.lines.line_width = values.number("line_width");
    look.lines.colors = values.toggle("line_colors");
    read_figure_outlines(values, look);
    read_viewport(values, look);
    request.camera = three(values, "camera", -kFar, kFar);
    request.place = three(values, "place", -kFar, kFar);
    request.fit = values.toggle("fit");
    request.zoom = values.number("zoom");
    if (values.given("perspective")) request.eye_distance = values.number("perspective");
    return request;
}

class SolvedFigure final : public SolvedPicture {
  public:
    SolvedFigure(figure::FigurePicture picture, figure::FigureStyle style,
                 std::vector<std::shared_ptr<const Source>> maps)
        : m_picture(std::move(picture)), m_style(style), m_maps(std::move(maps)) {}

    /// Rays meet the bodies themselves; only curved lines are made of chords.
    Attributes reached(const ParallelFor&) const override {
        const bool chords = m_style == figure::FigureStyle::outline;
        Attributes all = {{"anamorph:max_error", chords ? m_picture.line_error() : 0.0},
                          {"anamorph:exact_fraction", chords ? 0.0 : 1.0}};
        std::string names;
        for (const std::string& name : m_picture.left_out()) names += (names.empty() ? "" : ", ") + name;
        if (!names.empty()) all.push_back({"anamorph:left_out", names});
        return all;
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        // Each texture's maps, or the next of the host's pictures, the last of which is the backdrop.
        std::vector<const Source*> all;
        auto next = sources.begin();
        for (const auto& maps : m_maps)
            all.push_back(maps ? maps.get() : next == sources.end() ? nullptr : *next++);
        all.insert(all.end(), next, sources.end());
        m_picture.draw(box, view, parallel_for, all);
        return true;
    }

  private:
    figure::FigurePicture m_picture;
    figure::FigureStyle m_style;
    std::vector<std::shared_ptr<const Source>> m_maps;
};

class Figures final : public Pictures {
  public:
    Figures(FigureRequest request, std::shared_ptr<const Film> film, std::optional<int> frame)
        : m_request(std::move(request)), m_film(std::move(film)), m_frame(frame) {
        if (!m_frame) m_frames = m_film->count();
        if (m_frames > kMostSubimages)
            throw Error::not_given("frame", " and the script shows " + std::to_string(m_frames) +
                                                " frames: must be given where there are more than " +
                                                std::to_string(kMostSubimages));
        if (!m_request.fit) return;
        figure::SeenExtent extent;
        for (int i = 0; i < m_frames; ++i)
            m_request.add_extent(m_film->frame(m_frame ? *m_frame : m_film->number(i)), extent);
        m_extent = std::make_shared<const figure::SeenExtent>(extent);
    }

    int frames() const override { return m_frames; }

    std::optional<PictureRequest> picture(int frame, int level) const override {
        const std::optional<Size> size = level_size(m_request.size, level);
        const Size& overscan = m_request.look.overscan;
        if (!size || (level > 0 && !(overscan == Size{}))) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.add_overscan(overscan);
        const int number = m_frame ? *m_frame : m_film->number(frame);
        describe(picture, number);
        picture.solve = [request = m_request, film = m_film, extent = m_extent, number, size = *size,
                         all = picture.size, level] {
            figure::FigureFrame scene = film->frame(number);
            FigureRequest r = request;
            r.look.lines.line_width = std::ldexp(r.look.lines.line_width, -level);
            if (auto& viewport = r.look.lines.viewport)
                viewport = in_pixels(*viewport, {size.width, size.height},
                                     {r.look.overscan.width, r.look.overscan.height});
            figure::View view = r.view_of(scene, *extent, size);
            view.middle += glm::dvec2(r.look.overscan.width, r.look.overscan.height);
            return std::make_unique<SolvedFigure>(figure::FigurePicture(std::move(scene), view, all, r.look),
                                                  r.look.style, r.maps);
        };
        return picture;
    }

  private:
    void describe(PictureRequest& picture, int number) const {
        switch (m_request.look.style) {
            case figure::FigureStyle::depth:
                picture.channels = {"Z"};
                break;
            case figure::FigureStyle::id:
                picture.channels = {"id"};
                break;
            case figure::FigureStyle::uv:
                picture.pixels = PixelKind::point;
                break;
            default:
                picture.channels = {"R", "G", "B", "A"};
                picture.says.push_back({"oiio:ColorSpace", std::string("sRGB")});
        }
        const bool chords = m_request.look.style == figure::FigureStyle::outline;
        const figure::DrawingOptions& lines = m_request.look.lines;
        const bool holds = figure::holds_tolerance(lines.style);
        if (lines.style == figure::OutlineStyle::limbs || holds)
            picture.says.push_back({"anamorph:tol", !chords ? 0.0 : holds ? lines.simple_tol : kChordError});
        picture.says.push_back({"anamorph:frame", number});
        if (!m_request.missing.empty())
            picture.says.push_back({"anamorph:missing_textures", m_request.missing});
        if (!m_film->warnings().empty()) picture.says.push_back({"anamorph:warnings", m_film->warnings()});
    }

    FigureRequest m_request;
    std::shared_ptr<const Film> m_film;
    std::optional<int> m_frame;
    int m_frames = 1;
    std::shared_ptr<const figure::SeenExtent> m_extent = std::make_shared<const figure::SeenExtent>();
};

/// Pyramids of all textures.
std::unique_ptr<const Pictures> read_mips(const OperationInput& input, const Film& film,
                                          const FigureRequest& request) {
    if (film.images().empty()) throw Error("output", "mips", "must be picture, as the script has no texture");
    if (input.values.given("overscan"))
        throw Error("overscan", printable(input.values.text("overscan")),
                    "must not be given with output=mips");
    std::vector<MipTexture> textures;
    for (const std::string& name : film.images()) {
        const std::string key = kTextureKey + name;
        MipTexture texture{name, {}, request.maps[textures.size()]};
        if (texture.maps)
            texture.size = texture.maps->size(0);
        else if (std::find(input.missing.begin(), input.missing.end(), key) == input.missing.end()) {
            const Box shown = input.reader.image(key, input.files.at(key).name)->display();
            texture.size = Size{shown.width(), shown.height()};
        }
        if (texture.size && 2 * std::max(texture.size->width, texture.size->height) > kMaxSide)
            throw Error(name + " has too many pixels for output=mips: must have up to " +
                        std::to_string(kMaxSide / 2) + " either way");
        textures.push_back(std::move(texture));
    }
    Attributes says;
    if (!request.missing.empty()) says.push_back({"anamorph:missing_textures", request.missing});
    return mip_pictures(std::move(textures), says);
}

std::unique_ptr<const Pictures> read_figures(const OperationInput& input) {
    FigureRequest request = read_request(input.values);
    std::optional<int> frame;
    if (input.values.given("frame")) frame = input.values.whole("frame");
    const std::shared_ptr<const Film> film = read_film(input);
    if (is_textured(input.values)) {
        request.look.textures = film->images();
        for (const std::string& name : film->images()) request.maps.push_back(maps_of(name, input));
    }
    // Scripts may name textures that nobody has; this one is meant.
    if (std::find(input.missing.begin(), input.missing.end(), "picture/bump") != input.missing.end())
        throw Error("bump", printable(input.files.at("bump").name), "must be an image that can be opened");
    for (const std::string& key : input.missing)
        request.missing += (request.missing.empty() ? "" : ", ") + key.substr(key.find('/') + 1);
    if (are_mips(input.values)) return read_mips(input, *film, request);
    return std::make_unique<Figures>(std::move(request), film, frame);
}

const char* const kExampleScript = R"(* A doll that waves.
figure doll 4 body head left right
ellipsoid body  130 190  90
ellipsoid head   85 100  85
ellipsoid left   45 150  45
ellipsoid right  45 150  45
joint neck   body    0 175 0   head   0 -90 0
joint lshldr body -120 130 0   left   0 140 0
joint rshldr body  120 130 0   right  0 140 0
repeat 0 1 moveto doll body 500 420 500
repeat 0 1 colour body 200 60 50
repeat 0 1 bendby right rshldr world 150 z
stop
)";

}  // namespace

const Operation& figure_operation() {
    static const ParameterTable table = make_figure_table();
    static const Operation operation{
        .name = "figure",
        .title = "Figures of ellipsoids, performed from a script of NUDES",
        .parameters = &table,
        .sources = {},
        .least_sources = 0,
        .example = {"script=doll.nudes&size=48x24", {{"doll.nudes", kExampleScript}}},
        .make = read_figures,
        .main_file = "script",
        .endings = {"n", "nudes", "bvh", "cif", "mrasel"},
        .linked = linked_files};
    return operation;
}

}  // namespace anamorph
