// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/hugin_project.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "anamorph/image/source.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

using text_file::excerpt;

/// The values of a row by their names, as they are written; texts without their quotes.
struct Row {
    std::string label;
    std::map<std::string, std::string_view, std::less<>> values;
};

/// All other names are one letter.
constexpr std::string_view kLongNames[] = {
    "TrX", "TrY", "TrZ", "Tpy", "Tpp", "TiX", "TiY", "TiZ", "TiS", "Te0", "Te1", "Te2", "Te3", "Eev", "Er",
    "Eb",  "Ra",  "Rb",  "Rc",  "Rd",  "Re",  "Va",  "Vb",  "Vc",  "Vd",  "Vx",  "Vy",  "Vm",  "Vf"};

std::string_view name_at(std::string_view text) {
    for (const std::string_view name : kLongNames)
        if (text.starts_with(name)) return name;
    return text.substr(0, text_file::starts_name(text.front()) && text.front() != '_' ? 1 : 0);
}

/// The values of a row, behind its letter.
Row row_of(std::string_view text, const std::string& label) {
    Row row{label, {}};
    while (!(text = text_file::trimmed(text)).empty()) {
        const std::string_view name = name_at(text);
        if (name.empty()) throw Error("\"" + excerpt(text) + "\": must begin with a name, as in v65.5");
        text.remove_prefix(name.size());
        const bool is_quoted = text.starts_with('"');
        if (is_quoted) text.remove_prefix(1);
        const std::size_t end = text.find_first_of(is_quoted ? "\"" : " \t");
        if (is_quoted && end == std::string_view::npos)
            throw Error(std::string(name) + ": must end with a quotation mark");
        if (!row.values.emplace(name, text.substr(0, end)).second)
            throw Error(excerpt(name) + ": must be given once");
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + (is_quoted ? 1 : 0));
    }
    return row;
}

/// A value that a row must have.
std::string_view value_of_row(const Row& row, std::string_view name) {
    const auto found = row.values.find(name);
    if (found == row.values.end()) throw Error(std::string(name) + " is missing: must be given");
    return found->second;
}

/// A value of a row, for messages.
std::string written(std::string_view name, std::string_view value) {
    return excerpt(std::string(name) + std::string(value));
}

/// The number that a value is; no number where it is none, or none that is finite.
double number_in(std::string_view value) {
    double number = 0;
    return text_file::take_number(value, number) && value.empty() && std::isfinite(number)
               ? number
               : std::numeric_limits<double>::quiet_NaN();
}

double checked_number(std::string_view name, std::string_view value, double least, double most) {
    const double number = number_in(value);
    if (!(number >= least && number <= most))
        throw Error(written(name, value) + ": must be " + std::string(name) + " and a number from " +
                    brief(least) + " to " + brief(most));
    return number;
}

int checked_whole(std::string_view name, std::string_view value, int least, int most) {
    const double number = number_in(value);
    if (!(number >= least && number <= most && number == std::floor(number)))
        throw Error(written(name, value) + ": must be " + std::string(name) + " and an integer from " +
                    std::to_string(least) + " to " + std::to_string(most));
    return static_cast<int>(number);
}

constexpr double kMostNumber = 1e9;

/// S: left,right,top,bottom; none where it has no pixels and says so by four zeros.
std::optional<Box> checked_crop(std::string_view value) {
    const std::vector<std::string_view> fields = text_file::fields_of(value);
    std::array<int, 4> sides{};
    bool holds = fields.size() == sides.size();
    for (std::size_t i = 0; holds && i < sides.size(); ++i) {
        const double side = number_in(fields[i]);
        holds = std::fabs(side) <= kMaxSide && side == std::floor(side);
        if (holds) sides[i] = static_cast<int>(side);
    }
    if (holds && sides == std::array<int, 4>{}) return {};
    if (!holds || sides[0] >= sides[1] || sides[2] >= sides[3])
        throw Error(written("S", value) +
                    ": must be S and left,right,top,bottom in pixels, with left below right and top below "
                    "bottom");
    return Box{sides[0], sides[2], sides[1], sides[3]};
}

// --- Images ------------------------------------------------------------------------------------------------

/// A number f of a row i or p, and the projection that it is.
struct Format {
    int number;
    Projection projection;
};
constexpr Format kImageFormats[] = {{0, Projection::rectilinear},     {1, Projection::cylindrical},
                                    {2, Projection::fisheye},         {3, Projection::fisheye},
                                    {4, Projection::equirectangular}, {8, Projection::orthographic},
                                    {10, Projection::stereographic},  {21, Projection::equisolid}};
constexpr Format kPanoramaFormats[] = {
    {0, Projection::rectilinear}, {1, Projection::cylindrical},   {2, Projection::equirectangular},
    {3, Projection::fisheye},     {4, Projection::stereographic}, {5, Projection::mercator},
    {7, Projection::sinusoidal},  {9, Projection::equisolid},     {14, Projection::orthographic},
    {15, Projection::equisolid},  {19, Projection::pannini},      {21, Projection::hammer}};
constexpr int kGeneralPannini = 19;

template <std::size_t N>
const Format* find_format(const Format (&formats)[N], int number) {
    const auto* const found = std::find_if(std::begin(formats), std::end(formats),
                                           [&](const Format& format) { return format.number == number; });
    return found == std::end(formats) ? nullptr : found;
}
/// "0 (rectilinear), 1 (cylindrical)": what is drawn.
template <std::size_t N>
std::string names_of(const Format (&formats)[N]) {
    std::string names;
    for (const Format& format : formats)
        names += (names.empty() ? "" : ", ") + std::to_string(format.number) + " (" +
                 std::string(name_of(format.projection)) + ")";
    return names;
}
template <std::size_t N>
std::string refused_format(const Format (&formats)[N], const Row& row, int number) {
    return row.label + ": f" + std::to_string(number) +
           ": must be one of the projections that there are here, " + names_of(formats);
}

/// The hosts' circular fisheyes: a crop of theirs is round.
bool has_round_crop(int format) {
    return format == 2 || format == 8;
}

const std::set<std::string, std::less<>>& read_names() {
    static const std::set<std::string, std::less<>> names = {"w", "h", "f",   "v",   "a",   "b",   "c",
                                                             "d", "e", "g",   "t",   "y",   "p",   "r",
                                                             "S", "n", "TrX", "TrY", "TrZ", "Tpy", "Tpp"};
    return names;
}
/// What is about colours, and the value that changes none.
const std::map<std::string, double, std::less<>>& photometric_names() {
    static const std::map<std::string, double, std::less<>> names = {
        {"Er", 1}, {"Eb", 1}, {"Ra", 0}, {"Rb", 0}, {"Rc", 0}, {"Rd", 0},
        {"Re", 0}, {"Va", 1}, {"Vb", 0}, {"Vc", 0}, {"Vd", 0}};
    return names;
}
/// What says nothing of where things are: stacks, and where vignetting has its middle.
bool is_without_meaning(std::string_view name) {
    for (const std::string_view known : {"j", "Vx", "Vy", "Vm", "Eev", "Vf"})
        if (name == known) return true;
    return false;
}
std::string meaning_of(std::string_view name) {
    if (name.starts_with("Ti")) return "tilt";
    return "what it means is not known here";
}

/// Images of a project while it is read: their values may be those of others.
class Images {
  public:
    void add(Row row) {
        if (m_rows.size() >= kMostHuginImages)
            throw Error("must be one of at most " + std::to_string(kMostHuginImages) + " images");
        m_rows.push_back(std::move(row));
        // What is wrong with a row is said of that row.
        m_images.push_back(image(m_rows.size() - 1));
    }
    void add_mask(const Row& row) {
        const auto index =
            checked_whole("i", value_of_row(row, "i"), 0, static_cast<int>(kMostHuginImages) - 1);
        const int type = checked_whole("t", value_of_row(row, "t"), 0, 1000);
        if (++m_masks > kMostHuginMasks)
            throw Error("must be one of at most " + std::to_string(kMostHuginMasks) + " masks");
        m_found_masks.push_back(
            {static_cast<std::size_t>(index), type, row.label, corners_in(value_of_row(row, "p"))});
    }
    /// All images, with their masks.
    std::vector<HuginImage> take() {
        for (FoundMask& mask : m_found_masks) {
            if (mask.image >= m_images.size())
                throw Error(mask.row + ": i" + std::to_string(mask.image) +
                            ": must be the number of an image, 0 to " + std::to_string(m_images.size() - 1));
            HuginImage& image = m_images[mask.image];
            if (mask.type == 0)
                image.masks.push_back(std::move(mask.corners));
            else if (image.refused.empty())
                image.refused = mask.row + ": t" + std::to_string(mask.type) +
                                ": must be 0, a mask that cuts a part of its own image out";
        }
        return std::move(m_images);
    }
    std::string not_applied(std::optional<double> exposure) const {
        std::string names;
        const auto add = [&](std::string_view name) {
            names += (names.empty() ? "" : ", ") + std::string(name);
        };
        for (std::size_t i = 0; i < m_rows.size(); ++i)
            if (const std::optional<double> own = number_of(i, "Eev")) {
                if (!exposure) exposure = own;
                if (*own == *exposure) continue;
                add("Eev");
                break;
            }
        for (const auto& [name, neutral] : photometric_names())
            if (is_anywhere_other(name, neutral)) add(name);
        for (const Row& row : m_rows)
            if (const auto flat = row.values.find("Vf"); flat != row.values.end() && !flat->second.empty()) {
                add("Vf");
                break;
            }
        return names;
    }
    bool empty() const { return m_rows.empty(); }

  private:
    struct FoundMask {
        std::size_t image;
        int type;
        std::string row;
        std::vector<Point<double>> corners;
    };

    /// Has any image another number there?
    bool is_anywhere_other(std::string_view name, double than) const {
        for (std::size_t i = 0; i < m_rows.size(); ++i)
            if (number_of(i, name).value_or(than) != than) return true;
        return false;
    }
    static std::vector<Point<double>> corners_in(std::string_view text) {
        std::vector<double> numbers;
        while (!(text = text_file::trimmed(text)).empty()) {
            const std::string_view field = text.substr(0, text.find_first_of(" \t"));
            numbers.push_back(checked_number("p", field, -kMostNumber, kMostNumber));
            text.remove_prefix(field.size());
        }
        if (numbers.size() % 2 != 0 || numbers.size() < 6 || numbers.size() > 2 * kMostHuginCorners)
            throw Error("p: must be x y of each corner of a polygon, 3 to " +
                        std::to_string(kMostHuginCorners) + " of them");
        std::vector<Point<double>> corners;
        for (std::size_t i = 0; i < numbers.size(); i += 2) corners.push_back({numbers[i], numbers[i + 1]});
        return corners;
    }

    /// A value as it is written, where it belongs to another image there; none where it is not given.
    std::optional<std::string_view> value_of(std::size_t image, std::string_view name) const {
        for (;;) {
            const auto found = m_rows[image].values.find(name);
            if (found == m_rows[image].values.end()) return {};
            std::string_view value = found->second;
            if (!value.starts_with('=')) return value;
            const double other = number_in(value.substr(1));
            if (!(other >= 0 && other < static_cast<double>(image) && other == std::floor(other)))
                throw Error(written(name, value) + ": must be = and the number of an image before this one");
            image = static_cast<std::size_t>(other);
        }
    }
    std::optional<double> number_of(std::size_t image, std::string_view name) const {
        const std::optional<std::string_view> value = value_of(image, name);
        return value ? std::optional(number_in(*value)) : std::nullopt;
    }
    std::string_view needed(std::size_t image, std::string_view name) const {
        const std::optional<std::string_view> value = value_of(image, name);
        if (!value) throw Error(std::string(name) + " is missing: must be given");
        return *value;
    }
    double number_or_0(std::size_t i, std::string_view name) const {
        const std::optional<std::string_view> value = value_of(i, name);
        return value ? checked_number(name, *value, -kMostNumber, kMostNumber) : 0;
    }

    /// Hugin's camera is TrX to the right of the panorama's, TrY below and TrZ behind.
    std::optional<PlaneTransfer> transfer_of(std::size_t i) const {
        const PlaneTransfer transfer{{number_or_0(i, "TrX"), number_or_0(i, "TrY"), -number_or_0(i, "TrZ")},
                                     number_or_0(i, "Tpy"),
                                     number_or_0(i, "Tpp")};
        if (transfer.camera == std::array<double, 3>{}) return {};
        return transfer;
    }
    HuginImage image(std::size_t i) const {
        HuginImage image;
        // A name is a name, also one that begins as links do.
        image.file = value_of_row(m_rows[i], "n");
        if (image.file.empty()) throw Error("n\"\": must be the name of an image");
        image.size = {checked_whole("w", needed(i, "w"), 1, kMaxSide),
                      checked_whole("h", needed(i, "h"), 1, kMaxSide)};
        image.fov = checked_number("v", needed(i, "v"), 1e-6, 360);
        constexpr std::string_view kLens[] = {"a", "b", "c", "g", "t", "d", "e"};
        for (std::size_t k = 0; k < image.lens.size(); ++k) image.lens[k] = number_or_0(i, kLens[k]);
        image.yaw = number_or_0(i, "y");
        image.pitch = number_or_0(i, "p");
        image.roll = number_or_0(i, "r");
        image.transfer = transfer_of(i);
        if (const std::optional<std::string_view> crop = value_of(i, "S")) image.crop = checked_crop(*crop);
        const int format = checked_whole("f", needed(i, "f"), 0, 1000);
        image.is_round = image.crop && has_round_crop(format);
        if (const Format* const known = find_format(kImageFormats, format))
            image.projection = known->projection;
        else
            image.refused = refused_format(kImageFormats, m_rows[i], format);
        if (image.refused.empty()) image.refused = refused_value(i);
        return image;
    }
    /// The first value that would move something and is not drawn.
    std::string refused_value(std::size_t i) const {
        for (const auto& [name, as_written] : m_rows[i].values) {
            if (read_names().contains(name) || is_without_meaning(name)) continue;
            const double value = number_in(value_of(i, name).value_or(""));
            if (photometric_names().contains(name)) {
                if (std::isnan(value)) throw Error(written(name, as_written) + ": must be a number");
                continue;
            }
            if (value != 0)
                return m_rows[i].label + ": " + written(name, as_written) + ": must be 0 (" +
                       meaning_of(name) + ")";
        }
        return "";
    }

    std::vector<Row> m_rows;
    std::vector<HuginImage> m_images;
    std::vector<FoundMask> m_found_masks;
    std::size_t m_masks = 0;
};

// --- The panorama ------------------------------------------------------------------------------------------

/// The parameters of the general Pannini projection, P"compression tops bottoms", and the distance that a compression is, from 0 (0) by
/// 100 (1) to 150 (endless): as PanoTools computes it, a thousandth of a thousandth beside that. What squeezes its upper and lower half
/// is no Pannini's. Writes what is refused.
void read_pannini(const Row& row, HuginPanorama& panorama) {
    double values[] = {100, 0, 0};
    if (const auto found = row.values.find("P"); found != row.values.end()) {
        std::string_view text = text_file::trimmed(found->second);
        for (double& value : values) {
            const std::string_view field = text.substr(0, text.find_first_of(" \t"));
            if (field.empty()) break;
            value = checked_number("P", field, -kMostNumber, kMostNumber);
            text = text_file::trimmed(text.substr(field.size()));
        }
        if (!text.empty()) throw Error(written("P", found->second) + ": must be up to three numbers");
    }
    const double times = (150 - values[0]) / 50 + 0.0001;
    panorama.d = std::max(1.5 / times - 1.5 / 3.0001, 0.0);
    const bool is_known = values[0] >= 0 && values[0] <= 150 && panorama.d <= Chart::kMostDistance;
    if (!is_known || values[1] != 0 || values[2] != 0)
        panorama.refused = row.label + ": P" + brief(values[0]) + " " + brief(values[1]) + " " +
                           brief(values[2]) +
                           ": must be a compression from 0 to 149.9, and 0 for what squeezes its upper and "
                           "lower half";
}

HuginPanorama panorama_of(const Row& row) {
    const auto value = [&](std::string_view name) { return value_of_row(row, name); };
    HuginPanorama panorama;
    panorama.size = {checked_whole("w", value("w"), 1, kMaxSide),
                     checked_whole("h", value("h"), 1, kMaxSide)};
    panorama.fov = checked_number("v", value("v"), 1e-6, 360);
    if (row.values.contains("S"))
        if (const std::optional<Box> crop = checked_crop(value("S"))) {
            panorama.crop = intersection(*crop, {0, 0, panorama.size.width, panorama.size.height});
            if (panorama.crop->empty())
                throw Error(written("S", value("S")) + ": must have pixels of the panorama");
        }
    const int format = checked_whole("f", value("f"), 0, 1000);
    if (const Format* const known = find_format(kPanoramaFormats, format))
        panorama.projection = known->projection;
    else
        panorama.refused = refused_format(kPanoramaFormats, row, format);
    if (format == kGeneralPannini) read_pannini(row, panorama);
    return panorama;
}

/// Throws Error of what a project has that is refused.
void check_refused(std::string_view project, const std::string& refused) {
    if (!refused.empty()) text_file::fail(project, "", refused);
}

}  // namespace

void HuginImage::check(std::string_view project) const {
    check_refused(project, refused);
}
void HuginPanorama::check(std::string_view project) const {
    check_refused(project, refused);
}

HuginProject parse_hugin_project(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    HuginProject project;
    Images images;
    std::optional<double> exposure;
    bool has_ended = false;
    text_file::each_row(text, [&](std::string_view line, const std::string& label) {
        if (has_ended) return;
        text_file::in_entry(name, label, [&] {
            const char letter = line.front();
            const bool is_alone = line.size() == 1 || line[1] == ' ' || line[1] == '\t';
            const std::string_view values = line.substr(1);
            if (letter == '*' && is_alone)
                has_ended = true;
            else if (letter == 'i' && is_alone)
                images.add(row_of(values, label));
            else if (letter == 'k' && is_alone)
                images.add_mask(row_of(values, label));
            else if (letter == 'p' && is_alone) {
                if (project.panorama) throw Error("p: must be given once");
                const Row row = row_of(values, label);
                project.panorama = panorama_of(row);
                if (const auto found = row.values.find("E"); found != row.values.end())
                    exposure = number_in(found->second);
            } else if (letter == 'o' && is_alone)
                throw Error("o: must be a row i, as Hugin has written them since 2010");
            else if (!is_alone || std::string_view("mvcCtlz").find(letter) == std::string_view::npos)
                throw Error("\"" + excerpt(line.substr(0, 12)) +
                            "\": must be a row of a project, which begins with p, i, k, m, v, c or #");
        });
    });
    if (images.empty()) text_file::fail(name, "", "has no image: must have at least one row i");
    text_file::in_entry(name, "", [&] { project.not_applied = images.not_applied(exposure); });
    text_file::in_entry(name, "", [&] { project.images = images.take(); });
    return project;
}

}  // namespace anamorph
