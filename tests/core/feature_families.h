// SPDX-License-Identifier: Apache-2.0
// Six families of feature lines, seeded, for tests and the benchmark.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "anamorph/morph/feature_lines.h"

namespace anamorph::families {

/// The names of the families. smooth: lines of B are A's moved by a smooth field. random: each line moved and
/// turned at will. face: the outlines of two faces (32 lines whatever `count`). crossing: pairs of lines that
/// cross at their middles. short: lines of a few pixels. outside: many lines beyond the frame.
inline const std::vector<std::string>& names() {
    static const std::vector<std::string> all{"smooth", "face", "random", "crossing", "short", "outside"};
    return all;
}

class Maker {
  public:
    Maker(int size, unsigned seed) : m_size(size), m_random(seed) {
        for (Wave& w : m_waves)
            w = {between(-1, 1) * 3 * std::numbers::pi / size, between(-1, 1) * 3 * std::numbers::pi / size,
                 between(-3.2, 3.2), between(-0.03, 0.03) * size, between(-0.03, 0.03) * size};
    }

    std::shared_ptr<const Features> make(const std::string& family, int count) {
        auto features = std::make_shared<Features>();
        if (family == "face") return add_face(*features), features;
        Line last{};
        for (int i = 0; i < count; ++i) {
            Line a;
            if (family == "short")
                a = line(0.05, 0.95, 0.002, 0.005);
            else if (family == "outside")
                a = line(-0.5, 1.5, 0.05, 0.3);
            else if (family == "crossing" && i % 2)
                a = crossed(last);
            else
                a = line(0.05, 0.95, 0.05, 0.2);
            last = a;
            Line b = a;
            if (family == "smooth" || family == "outside") {
                b.p = moved(b.p);
                b.q = moved(b.q);
            } else if (family == "short") {
                const Point<double> to = moved(a.p);
                b = {to, {a.q.x + to.x - a.p.x, a.q.y + to.y - a.p.y}};
            } else {
                const double dx = between(-0.05, 0.05) * m_size, dy = between(-0.05, 0.05) * m_size;
                b.p = {a.p.x + dx, a.p.y + dy};
                b.q = {a.q.x + dx + between(-0.0125, 0.0125) * m_size,
                       a.q.y + dy + between(-0.0125, 0.0125) * m_size};
            }
            features->add_line({a, b});
        }
        return features;
    }

  private:
    struct Wave {
        double kx, ky, phase, x, y;
    };
    using Points = std::vector<Point<double>>;

    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_random);
    }
    Line line(double low, double high, double shortest, double longest) {
        const double x = between(low, high) * m_size, y = between(low, high) * m_size;
        const double angle = between(0, 2 * std::numbers::pi);
        const double half = 0.5 * between(shortest, longest) * m_size;
        const double c = half * std::cos(angle), s = half * std::sin(angle);
        return {{x - c, y - s}, {x + c, y + s}};
    }
    static Line crossed(const Line& l) {
        const double x = 0.5 * (l.p.x + l.q.x), y = 0.5 * (l.p.y + l.q.y);
        const double dx = 0.5 * (l.q.x - l.p.x), dy = 0.5 * (l.q.y - l.p.y);
        return {{x - dy, y + dx}, {x + dy, y - dx}};
    }
    Point<double> moved(const Point<double>& p) const {
        Point<double> to = p;
        for (const Wave& w : m_waves) {
            const double s = std::sin(w.kx * p.x + w.ky * p.y + w.phase);
            to = {to.x + w.x * s, to.y + w.y * s};
        }
        return to;
    }
    void add_chain(Features& features, const Points& a, const Points& b, bool closed) const {
        const double k = m_size / 600.0;
        for (std::size_t i = 0; i + (closed ? 0 : 1) < a.size(); ++i) {
            const std::size_t j = (i + 1) % a.size();
            const auto scaled = [&](const Point<double>& p) { return Point<double>{p.x * k, p.y * k}; };
            features.add_line({{scaled(a[i]), scaled(a[j])}, {scaled(b[i]), scaled(b[j])}});
        }
    }
    void add_face(Features& f) const {
        // Jaw, hair, brows, eyes, nose and mouth of two faces in a frame of 600 pixels.
        add_chain(f, {{150, 220}, {165, 400}, {230, 500}, {300, 530}, {370, 500}, {435, 400}, {450, 220}},
                  {{170, 240}, {190, 410}, {245, 490}, {305, 510}, {365, 488}, {420, 405}, {432, 236}},
                  false);
        add_chain(f, {{150, 220}, {200, 110}, {300, 75}, {400, 110}, {450, 220}},
                  {{170, 240}, {205, 140}, {300, 100}, {395, 138}, {432, 236}}, false);
        add_chain(f, {{190, 235}, {225, 215}, {265, 230}}, {{200, 255}, {232, 240}, {268, 250}}, false);
        add_chain(f, {{335, 230}, {375, 215}, {410, 235}}, {{335, 250}, {370, 238}, {402, 253}}, false);
        add_chain(f, {{200, 265}, {230, 252}, {260, 268}, {230, 280}},
                  {{206, 280}, {234, 270}, {262, 284}, {233, 293}}, true);
        add_chain(f, {{340, 268}, {370, 252}, {400, 265}, {370, 280}},
                  {{338, 284}, {367, 270}, {394, 280}, {367, 292}}, true);
        add_chain(f, {{290, 270}, {275, 360}, {300, 380}, {325, 360}, {310, 270}},
                  {{292, 285}, {280, 352}, {302, 368}, {322, 352}, {309, 284}}, false);
        add_chain(f, {{240, 430}, {280, 418}, {300, 424}, {320, 418}, {360, 430}, {300, 462}},
                  {{248, 415}, {282, 408}, {301, 412}, {320, 408}, {352, 416}, {301, 440}}, true);
    }

    int m_size;
    std::mt19937 m_random;
    Wave m_waves[6];
};

}  // namespace anamorph::families
