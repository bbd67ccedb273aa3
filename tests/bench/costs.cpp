// SPDX-License-Identifier: Apache-2.0
// What the planner's costs are on this machine (speed_vs_error --calibrate), beside those that are in use: plan/costs.h, of which
// credit and bound_pixels say how much is ventured and are not measured.
//
// All in exact pixels of the map, on one thread. Pixels are drawn, from three channels of floats, by blocks that are there; what counts is
// what one costs beyond a polynomial's in float. Where a map has too few blocks of a kind, there is a dash.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "anamorph/chart/chart_jets.h"
#include "anamorph/formula/pushed_plan.h"
#include "anamorph/formula/text_plan.h"
#include "anamorph/lens/lens_plan.h"
#include "anamorph/panorama/panorama_plan.h"
#include "anamorph/plan/polynomial_strategy.h"
#include "bench.h"
#include "drawn_map.h"
#include "map_formulas.h"

namespace anamorph::bench {
namespace {

using namespace plan_detail;

/// A tolerance that quadratics in float hold, one that polynomials hold in double only; and the same of direct blocks.
constexpr double kCoarse = 1, kFine = 1e-6, kDirect = 0.01, kDirectFine = 1e-6;
/// Of the pixels, in blocks of the kind asked for.
constexpr double kMost = 0.9;

/// The share of pixels in blocks of a kind.
double share_of(const BlockMap& map, Block::Kind kind, bool precise) {
    double found = 0, all = 0;
    for (std::int64_t region = 0; region < map.regions(); ++region)
        for (const Block& block : map.blocks(region)) {
            const double pixels = double(block.box.width()) * block.box.height();
            all += pixels;
            // Quadratics and cubics in float are alike.
            const bool alike = kind == Block::Kind::polynomial && block.kind == Block::Kind::bicubic;
            if ((block.kind == kind || alike) && block.precise == precise) found += pixels;
        }
    return found / all;
}

/// What is drawn, and planned, of one map.
template <class Map, class Plan>
class Costs {
    /// What is timed, in the order in which print() adds it.
    enum What {
        exact_picture,
        float_picture,
        double_picture,
        direct_picture,
        direct_in_double_picture,
        bounds,
        bounds_four_at_once,
        four_polynomials,
        roundings,
        direct_trials
    };

  public:
    Costs(const Settings& settings, const char* name, const Map& map, const Chart& source)
        : m_settings(settings), m_name(name), m_map(map), m_source(source), m_drawing(settings) {
        place_boxes();
    }

    void print() {
        add_drawing(Scheme::exact, kCoarse, Block::Kind::exact, false);
        add_drawing(Scheme::blocks, kCoarse, Block::Kind::polynomial, false);
        add_drawing(Scheme::blocks, kFine, Block::Kind::bicubic, true);
        add_drawing(Scheme::direct, kDirect, Block::Kind::computed, false);
        add_drawing(Scheme::direct, kDirectFine, Block::Kind::computed, true);
        add_planning();
        const std::vector<Times> times = time_interleaved(m_timed, m_settings.rounds);
        const double pixels = double(m_settings.size) * m_settings.size;
        const auto ns = [&](What what) { return times[what].median; };
        const double unit = (ns(exact_picture) - ns(float_picture)) / pixels;
        const auto each = [&](What what) { return ns(what) / (unit * static_cast<double>(m_places.size())); };
        const auto beyond_polynomial = [&](What what) {
            return m_is_drawn[what] ? (ns(what) - ns(float_picture)) / (pixels * unit) : kNone;
        };
        const PlanCosts in_use = costs_of<Map>();
        std::printf("| %s | %.1f |", m_name, unit);
        print_cell(each(bounds), in_use.bound);
        print_cell((each(bounds_four_at_once) - each(bounds)) / 3, in_use.further_bound);
        print_cell(each(four_polynomials) / 4, in_use.polynomial);
        print_cell(each(roundings), in_use.rounding);
        print_cell(beyond_polynomial(double_picture), in_use.double_pixel);
        print_cell(DirectMap<Map> ? each(direct_trials) : kNone, in_use.direct_trial);
        print_cell(beyond_polynomial(direct_picture), in_use.direct_pixel);
        print_cell(beyond_polynomial(direct_in_double_picture), in_use.precise_pixel);
        std::printf("\n");
        std::fflush(stdout);
    }

  private:
    static void print_cell(double measured, double in_use) {
        std::isnan(measured) ? std::printf(" - (%.3g) |", in_use)
                             : std::printf(" %.3g (%.3g) |", measured, in_use);
    }

    /// Draws by blocks that are planned before.
    void add_drawing(Scheme scheme, double tol, Block::Kind kind, bool precise) {
        PlanOptions options;
        options.scheme = scheme;
        options.tol = tol;
        const auto blocks = std::make_shared<Plan>(m_map, options);
        m_is_drawn.push_back(share_of(*blocks, kind, precise) > kMost);
        const DrawnMap drawn{m_name, m_source, nullptr};
        m_timed.push_back({[this, drawn, blocks] { m_drawing.draw(drawn, blocks); }, 1});
    }

    /// Boxes on one branch of the map, of 4 x 4 blocks or, where there are none, of one.
    void place_boxes() {
        const BoxBounds<Map> over(m_map, m_options, 0);
        for (const int blocks : {4, 1}) {
            const auto add_box = [&](const Box& box) {
                const auto place = over.place_about(box);
                if (over.cover(box, place.local) == Cover::inside) m_places.push_back(place);
            };
            if (m_places.empty())
                for_boxes({0, 0, m_settings.size, m_settings.size}, blocks * kBlockWidth,
                          blocks * kBlockHeight, add_box);
        }
        if (m_places.empty())
            throw std::invalid_argument(std::string("--calibrate: ") + m_name +
                                        " has no box on one branch at this --size");
    }
    template <class Body>
    void add(const Body& body) {
        const auto all = [this, body] {
            const BoxBounds<Map> over(m_map, m_options, 0);
            CostModel account({}, true, {});
            PolynomialStrategy<Map> polynomials(over, m_options.tol, account);
            for (const auto& place : m_places) body(over, polynomials, place);
        };
        m_timed.push_back({all, 1});
    }
    void add_planning() {
        using Polynomials = PolynomialStrategy<Map>;
        using Known = typename Polynomials::Known;
        // A bound, and four at once.
        add([](const auto&, Polynomials& polynomials, const auto& place) {
            Known known;
            polynomials.know({&place.box, 1}, place.local, &known);
            keep(known.enclosed.x.c[0].lo);
        });
        add([](const auto&, Polynomials& polynomials, const auto& place) {
            Known known[4];
            polynomials.know(Quarters(place.box), place.local, known);
            keep(known[3].enclosed.x.c[0].lo);
        });
        // Four polynomials.
        add([this](const auto& over, Polynomials& polynomials, const auto& place) {
            const Known& known = m_known;
            const auto bound = polynomials.bound_of(known);
            const Quarters boxes(place.box);
            typename BoxBounds<Map>::Taylor taylors[4];
            over.taylors_of(boxes, place.local, taylors);
            Blocks blocks;
            Records<typename Map::Local> records;
            CostModel account({}, true, {});
            BlockEmitter<Map> emitter(m_map, HUGE_VAL, 0, account, blocks, records);
            const std::span<const Box> all = boxes;
            for (std::size_t i = 0; i < all.size(); ++i) {
                auto with_rounding = bound;
                with_rounding.rounding = 0;
                const auto expansion = polynomials.expand(all[i], place.local, with_rounding, taylors[i]);
                emitter.fit(all[i], place.local, Polynomials::fit_on(expansion, all[i]), 0);
            }
            keep(blocks.back().bound);
        });
        add([](const auto& over, Polynomials&, const auto& place) {
            const Box block = middle_of(place.box);
            keep(over.rounding_over(block, half(block.width()), half(block.height()), place.local));
        });
        if constexpr (DirectMap<Map>)
            add([this](const auto& over, Polynomials&, const auto& place) {
                const Box block = middle_of(place.box);
                Bases bases;
                keep(m_map
                         .template direct<float>(0.5 * (block.x0 + block.x1), 0.5 * (block.y0 + block.y1),
                                                 half(block.width()), half(block.height()),
                                                 over.place_about(block).local, bases)
                         .error);
            });
        else
            add([](const auto&, Polynomials&, const auto&) {});
        const BoxBounds<Map> over(m_map, m_options, 0);
        CostModel account({}, true, {});
        PolynomialStrategy<Map>(over, m_options.tol, account)
            .know({&m_places[0].box, 1}, m_places[0].local, &m_known);
    }
    /// What is computed must not be left out.
    static void keep(double value) { s_kept = s_kept + value; }

    const Settings& m_settings;
    const char* m_name;
    Map m_map;
    Chart m_source;
    MapDrawing m_drawing;
    PlanOptions m_options;
    std::vector<typename BoxBounds<Map>::Place> m_places;
    typename PolynomialStrategy<Map>::Known m_known{};
    std::vector<Timed> m_timed;
    std::vector<bool> m_is_drawn;
    static inline volatile double s_kept = 0;
};

template <class Plan, class Map>
void print_costs(const Settings& settings, const char* name, const Map& map, const Chart& source) {
    if (settings.wants_case(name)) Costs<Map, Plan>(settings, name, map, source).print();
}

}  // namespace

void print_costs(const Settings& given) {
    Settings settings = given;
    settings.threads = 1;
    std::printf("| map | exact pixel, ns | bound | further bound | polynomial | rounding | pixel in double ");
    std::printf(
        "| direct trial | direct pixel | direct in double |\n|---|---|---|---|---|---|---|---|---|---|\n");
    const int side = settings.size;
    const SphereView straight = straight_view(side), fisheye = fisheye_view(side);
    const LensView lens = lens_view(side);
    const TextOf swirl = swirl_view(side);
    print_costs<PanoramaPlan>(settings, "straight", straight.map, straight.text.source);
    print_costs<PanoramaPlan>(settings, "fisheye", fisheye.map, fisheye.text.source);
    print_costs<LensPlan>(settings, "lens", lens.map, lens.text.source);
    print_costs<TextPlan>(settings, "straight text", straight.text.map(side), straight.text.source);
    print_costs<TextPlan>(settings, "fisheye text", fisheye.text.map(side), fisheye.text.source);
    print_costs<TextPlan>(settings, "lens text", lens.text.map(side), lens.text.source);
    print_costs<TextPlan>(settings, "swirl text", swirl.map(side), swirl.source);
    print_costs<PushedPlan>(settings, "swirl pushed", pushed_swirl(side), swirl.source);
}

}  // namespace anamorph::bench
