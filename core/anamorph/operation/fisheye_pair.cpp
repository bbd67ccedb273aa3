// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/fisheye_pair.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <utility>

#include "anamorph/image/part_source.h"
#include "anamorph/number/hypot.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/sequence.h"

namespace anamorph {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array<const char*, 7> kKeys = {"front_yaw",  "front_pitch", "front_roll", "back_yaw",
                                              "back_pitch", "back_roll",   "seam"};

bool any_given(const ParameterValues& values) {
    return std::any_of(kKeys.begin(), kKeys.end(), [&](const char* key) { return values.given(key); });
}

/// How far within the rim of a lens a ray of it lies, in radians; below 0 where the lens does not see it.
double margin(const Ray<double>& ray, double half_fov) {
    return half_fov - std::atan2(hypot(ray.x, ray.y), ray.z);
}

/// The weight of a lens by its own margin and the other's.
double weight_of(double own, double other, double seam) {
    if (!(own >= 0)) return 0;
    if (!(other >= 0)) return 1;
    const double band = std::min(seam, own + other);
    if (!(band > 0)) return own > other ? 1 : own < other ? 0 : 0.5;
    return std::clamp(0.5 + (own - other) / (2 * band), 0.0, 1.0);
}

/// The weights of one of two lenses in a picture.
class LensWeights {
  public:
    LensWeights(const Panorama& own, const Panorama& other, double seam)
        : m_own(own),
          m_other(other),
          m_pieces(own.target_pieces()),
          m_half_fov(0.5 * own.source().fov() * kDegree),
          m_seam(seam) {}

    /// Layer::weights of a picture.
    bool operator()(const Box& box, float* weights) const {
        bool any = false;
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                *weights = static_cast<float>(at(x, y));
                any = any || *weights > 0;
                ++weights;
            }
        return any;
    }

  private:
    double at(int i, int j) const {
        const double x = i + 0.5, y = j + 0.5;
        const int piece = piece_at(i, j);
        if (!(m_own.target().inside(x, y, piece) >= 0)) return 0;
        return weight_of(margin(m_own.source_ray(x, y, piece), m_half_fov),
                         margin(m_other.source_ray(x, y, piece), m_half_fov), m_seam);
    }
    int piece_at(int x, int y) const {
        for (std::size_t k = 0; k < m_pieces.size(); ++k)
            if (m_pieces[k].x0 <= x && x < m_pieces[k].x1 && m_pieces[k].y0 <= y && y < m_pieces[k].y1)
                return static_cast<int>(k);
        return 0;  // beyond the edges of a picture in one piece
    }

    Panorama m_own, m_other;
    std::vector<Box> m_pieces;
    double m_half_fov, m_seam;
};

/// A picture of two sources that are parts of one.
class SolvedPair final : public SolvedPicture {
  public:
    SolvedPair(std::unique_ptr<const SolvedPicture> of_two, const std::array<Box, 2>& places)
        : m_of_two(std::move(of_two)), m_places(places) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        return m_of_two->reached(parallel_for);
    }
    bool reached_by_drawing() const override { return m_of_two->reached_by_drawing(); }
    Attributes known() const override { return m_of_two->known(); }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        std::unique_ptr<const SolvedPicture> moved = m_of_two->of_moved();
        return moved ? std::make_unique<SolvedPair>(std::move(moved), m_places) : nullptr;
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        std::deque<PartSource> parts;
        std::vector<const Source*> lenses(2);
        for (std::size_t i = 0; i < 2 && !sources.empty() && sources[0]; ++i)
            lenses[i] = &parts.emplace_back(*sources[0], m_places[i]);
        return m_of_two->draw(lenses, box, view, parallel_for);
    }

  private:
    std::unique_ptr<const SolvedPicture> m_of_two;
    std::array<Box, 2> m_places;
};

class PairPictures final : public Pictures {
  public:
    PairPictures(std::unique_ptr<const Pictures> of_two, const std::array<Box, 2>& places)
        : m_of_two(std::move(of_two)), m_places(places) {}

    int frames() const override { return m_of_two->frames(); }
    std::optional<PictureRequest> picture(int frame, int level) const override {
        std::optional<PictureRequest> request = m_of_two->picture(frame, level);
        if (request)
            request->solve = [solve = request->solve, places = m_places] {
                return std::make_unique<SolvedPair>(solve(), places);
            };
        return request;
    }
    SourceFaces faces() const override { return m_of_two->faces(); }

  private:
    std::unique_ptr<const Pictures> m_of_two;
    std::array<Box, 2> m_places;
};

}  // namespace

ParameterTable rows::fisheye_pair() {
    ParameterTable table;
    for (const std::string lens : {"front", "back"})
        for (const auto& [angle, sense] : {std::pair{"yaw", "turned to the right"},
                                           {"pitch", "tilted up"},
                                           {"roll", "turned about its axis, clockwise"}})
            table.push_back(
                number((lens + "_" + angle).c_str(), "degrees", "0", -kInfinity, kInfinity,
                       "of two fisheyes: how the " + lens + " lens is held, as it sees itself: " + sense +
                           ", from where it would look straight " + (lens == "front" ? "ahead" : "behind") +
                           "; in the order of roll, pitch, yaw, before srcyaw turns both"));
    table.push_back(
        number("seam", "degrees", "0", 0, 360,
               "of two fisheyes that see more than 180 degrees: how wide the band is in which "
               "both are mixed, in the middle of where both see, and at most all of that; 0: each "
               "direction is seen by the lens within whose rim it lies farther"));
    return table;
}

FisheyePair::FisheyePair(const ParameterValues& values, const Chart& source)
    : m_turns{}, m_seam(values.number("seam") * kDegree) {
    const auto given =
        std::find_if(kKeys.begin(), kKeys.end(), [&](const char* key) { return values.given(key); });
    const std::string key = given == kKeys.end() ? "seam" : *given, text = printable(values.text(key));
    if (source.projection() != Projection::dual_fisheye && source.projection() != Projection::dual_fisheye_tb)
        throw Error(key, text,
                    "must be of from=dual_fisheye or dual_fisheye_tb, not " +
                        std::string(name_of(source.projection())));
    if (values.text("scheme") == "hardware") throw Error(key, text, "must not be given with scheme=hardware");
    if (is_stmap(rows::chosen_output(values)))
        throw Error("output", values.text("output"),
                    "must not be given with " + key + ": a pixel may then have two source points");
    for (std::size_t i = 0; i < 6; ++i) m_turns[i / 3][i % 3] = values.number(kKeys[i]);
}

std::array<Box, 2> FisheyePair::places(const Chart& source) {
    std::array<Box, 2> places;
    for (const Piece& piece : source.pieces()) places[piece.toward.z > 0 ? 0 : 1] = piece.box;
    return places;
}

Picture FisheyePair::picture(const ReprojectRequest& request) const {
    const Chart& both = request.source.chart;
    const Box place = places(both)[0];
    const Chart lens(Projection::fisheye, place.width(), place.height(), both.fov(), both.spacing(), "src", 1,
                     {}, {}, both.padding());
    std::vector<Panorama> maps;
    for (const std::size_t i : {0, 1}) {
        Orientation held = request.held;
        held.ahead = i == 0 ? 0 : 180;
        held.lens = m_turns[i];
        maps.emplace_back(lens, request.target, request.orientation, held);
    }
    Picture picture = reprojected_picture(maps[0], request.options);
    picture.maps.push_back(reprojected_picture(maps[1], request.options).maps.front());
    for (const std::size_t i : {0, 1}) {
        Picture::Layer& layer = picture.maps[i].layers.front();
        layer.source = static_cast<int>(i);
        layer.weights = LensWeights(maps[i], maps[1 - i], m_seam);
    }
    picture.source_count = 2;
    return picture;
}

bool asks_for_fisheye_pair(const OperationInput& input) {
    if (any_given(input.values)) return true;
    if (!input.values.given("keys")) return false;
    const Sequence sequence(input);
    return any_given(sequence.values_at(sequence.time_of(0)));
}

std::unique_ptr<const Pictures> pictures_of_both(std::unique_ptr<const Pictures> of_two,
                                                 const Chart& source) {
    return std::make_unique<PairPictures>(std::move(of_two), FisheyePair::places(source));
}

}  // namespace anamorph
