// SPDX-License-Identifier: Apache-2.0
// Textured figures: frames of a script, and a texture's error by latitude.
//
// walker: frames of examples/figures/walker.nudes at 512^2, shaded and textured, each body with a texture of
// 512 x 512 texels; times are a frame's pixels'.
//
// latitude_L: a ball that fills the picture, seen from before its equator, its front under a texture of 512 x
// 512 texels of noise (mapping=mirrored, the essay's): errors are differences of colour, 0 to 1, from the mean of
// 16 x 16 samples of the texture, of the pixels from L to L + 15 degrees of latitude. mrasel: the essay's level
// and nearest texel; trilinear: the level by the footprint's longer side; summed_area: rectangles of a table of sums;
// footprint: taps along the footprint. Times are of the whole picture; ratio_to_exact is against the samples.
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>

#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "anamorph/image/pyramid.h"
#include "bench.h"

namespace anamorph::bench::op_figure_texture {
using namespace figure;
namespace {

constexpr int kTexture = 512, kFrames = 8, kBands = 6;

/// Noise of one channel, the same in every run.
class NoiseTexture {
  public:
    NoiseTexture() : m_base(view_of(m_texels)), m_pyramid(m_base) {}

    const Source& source() const { return m_pyramid; }
    double at(double u, double v) const {
        const auto texel = [](double t) {
            return std::clamp(static_cast<int>(t * kTexture), 0, kTexture - 1);
        };
        return static_cast<double>(m_texels[static_cast<std::size_t>(texel(v) * kTexture + texel(u))]);
    }

  private:
    static ConstImageView view_of(std::vector<float>& texels) {
        std::mt19937 random(1986);
        for (int i = 0; i < kTexture * kTexture; ++i)
            texels.push_back(std::uniform_real_distribution<float>()(random));
        return packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, kTexture,
                           kTexture, 1);
    }

    std::vector<float> m_texels;
    MemorySource m_base;
    Pyramid m_pyramid;
};

void draw(const FigureFrame& frame, const View& view, int size, const FigureLook& look,
          const std::vector<const Source*>& textures, std::vector<float>& pixels) {
    FigurePicture(frame, view, {size, size}, look)
        .draw({0, 0, size, size},
              packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, size, size, 4),
              serial_for, textures);
}

Row row_of(const std::string& case_name, const std::string& scheme, int size, const Times& times,
           double pixels) {
    Row row;
    row.op = "figure";
    row.case_name = case_name;
    row.scheme = scheme;
    row.size = size;
    row.ns_per_px = times.median / pixels;
    row.best_ns_per_px = times.best / pixels;
    row.ratio_to_exact = kNone;
    return row;
}

// --- Frames ------------------------------------------------------------------------------------------------

void run_frames(const Settings& settings, const NoiseTexture& texture, Report& report) {
    if (!settings.wants_case("walker")) return;
    const int size = std::min(512, settings.size);
    std::ifstream file(ANAMORPH_WALKER);
    Performance performance(
        parse_program(std::string{std::istreambuf_iterator<char>(file), {}}, "walker.nudes"));
    std::vector<FigureFrame> frames;
    for (int i = 0; i < kFrames; ++i) {
        frames.push_back(performance.frame(1 + 3 * i));
        for (Body& body : frames.back().bodies) body.texture = "map";
    }
    std::vector<float> pixels(static_cast<std::size_t>(4 * size * size));
    std::vector<Timed> timed;
    std::vector<std::string> schemes;
    for (const bool antialias : {false, true})
        for (const FigureStyle style : {FigureStyle::shaded, FigureStyle::textured}) {
            const std::string scheme =
                std::string(style == FigureStyle::shaded ? "shaded" : "textured") + (antialias ? "" : "_1");
            if (!settings.wants_scheme(scheme)) continue;
            schemes.push_back(scheme);
            timed.push_back({[&, style, antialias] {
                                 FigureLook look;
                                 look.style = style;
                                 look.antialias = antialias;
                                 look.textures = {"map"};
                                 for (const FigureFrame& frame : frames)
                                     draw(frame, view_in(frame, glm::dvec2(size)), size, look,
                                          {&texture.source()}, pixels);
                             },
                             1});
        }
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < schemes.size(); ++k)
        report.add(row_of("walker", schemes[k], size, times[k], 1.0 * kFrames * size * size));
}

// --- Latitudes ---------------------------------------------------------------------------------------------

/// The mean of 16 x 16 samples of each pixel that the ball covers, else NaN.
std::vector<double> reference_of(const NoiseTexture& texture, int size, double radius) {
    std::vector<double> means;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            double sum = 0;
            for (int i = 0; i < 256; ++i) {
                const double px = (x + (i % 16 + 0.5) / 16 - 0.5 * size) / radius,
                             py = (0.5 * size - y - (i / 16 + 0.5) / 16) / radius,
                             cosine = std::sqrt(1 - py * py);
                const double inside = px * px + py * py < 1 ? 0 : kNone;
                sum += inside +
                       texture.at(0.5 + std::asin(std::clamp(px / cosine, -1.0, 1.0)) / std::numbers::pi,
                                  0.5 - std::asin(std::clamp(py, -1.0, 1.0)) / std::numbers::pi);
            }
            means.push_back(sum / 256);
        }
    return means;
}

struct Average {
    const char* scheme;
    TextureAverage average;
};
constexpr Average kAverages[] = {{"mrasel", TextureAverage::mrasel},
                                 {"trilinear", TextureAverage::trilinear},
                                 {"summed_area", TextureAverage::summed_area},
                                 {"footprint", TextureAverage::footprint}};

void run_latitudes(const Settings& settings, const NoiseTexture& texture, Report& report) {
    const int size = std::min(512, settings.size);
    const double radius = 0.48 * size;
    FigureFrame frame;
    frame.bodies.resize(1);
    frame.bodies[0].shape = {{0, 0, 0}, glm::dvec3(radius), glm::dmat3(1.0)};
    frame.bodies[0].texture = "map";
    View view;
    view.middle = glm::dvec2(0.5 * size);
    std::vector<std::vector<float>> pixels(std::size(kAverages),
                                           std::vector<float>(static_cast<std::size_t>(4 * size * size)));
    std::vector<Timed> timed;
    std::vector<double> means;
    timed.push_back({[&] { means = reference_of(texture, size, radius); }, 1});
    for (std::size_t k = 0; k < std::size(kAverages); ++k)
        timed.push_back({[&, k] {
                             FigureLook look;
                             look.style = FigureStyle::textured;
                             look.light.ambient = 1;
                             look.mapping = BodyMapping::mirrored;
                             look.textures = {"map"};
                             look.average = kAverages[k].average;
                             draw(frame, view, size, look, {&texture.source()}, pixels[k]);
                         },
                         1});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (int band = 0; band < kBands; ++band)
        for (std::size_t k = 0; k < std::size(kAverages); ++k) {
            const std::string name = "latitude_" + std::to_string(90 / kBands * band);
            if (!settings.wants_case(name) || !settings.wants_scheme(kAverages[k].scheme)) continue;
            std::vector<float> errors;
            for (int y = 0; y < size; ++y) {
                const double sine = std::fabs(0.5 * size - y - 0.5) / radius;
                if (!(sine < 1) || static_cast<int>(std::asin(sine) * 2 * kBands / std::numbers::pi) != band)
                    continue;
                for (int x = 0; x < size; ++x) {
                    const auto i = static_cast<std::size_t>(y * size + x);
                    if (std::isnan(means[i])) continue;
                    errors.push_back(
                        static_cast<float>(std::fabs(static_cast<double>(pixels[k][4 * i]) - means[i])));
                }
            }
            Row row = row_of(name, kAverages[k].scheme, size, times[k + 1], 1.0 * size * size);
            row.ratio_to_exact = times[0].median / times[k + 1].median;
            row.error = accuracy_of(errors);
            report.add(row);
        }
}

void run(const Settings& settings, Report& report) {
    const NoiseTexture texture;
    run_frames(settings, texture, report);
    bool wanted = false;
    for (int band = 0; band < kBands; ++band)
        wanted = wanted || settings.wants_case("latitude_" + std::to_string(90 / kBands * band));
    if (wanted) run_latitudes(settings, texture, report);
}

const RegisterOp registered({"figure", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_figure_texture
