// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/ellipse_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/outline_arcs.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

constexpr double kDegreesOfTurn = 360, kTenthsOfDegree = 10;

/// Degrees from 0 on, below 360.
double within_turn(double degrees) {
    const double rest = degrees - kDegreesOfTurn * std::floor(degrees / kDegreesOfTurn);
    return rest < kDegreesOfTurn ? rest : 0;
}

/// Adds an arc, as two where it runs over a whole turn.
void add_hidden(FlatEllipse& ellipse, double begin, double length) {
    if (length >= kDegreesOfTurn) {
        ellipse.hidden = {{0, kDegreesOfTurn}};
        return;
    }
    begin = within_turn(begin);
    ellipse.hidden.push_back({begin, std::min(begin + length, kDegreesOfTurn)});
    if (begin + length > kDegreesOfTurn) ellipse.hidden.push_back({0, begin + length - kDegreesOfTurn});
}

/// An ellipse whose angle t is, on its axes, s = t - shift from the major one, towards the minor one a quarter of a turn
/// against the clock from it, or, mirrored, away from it. With u there and v against the major axis, a = s - 90 degrees.
FlatEllipse flat(const Outline& outline) {
    const PrincipalAxes axes = principal_axes(outline.screen);
    FlatEllipse ellipse{
        outline.screen.center, axes.minor, axes.major, axes.angle / kRadiansPerDegree + 90, {}};
    const double sign = axes.mirrored ? -1 : 1;
    for (const Arc& arc : outline.hidden) {
        const double s = sign * ((axes.mirrored ? arc.end : arc.begin) - axes.shift) / kRadiansPerDegree;
        add_hidden(ellipse, s - 180, arc.length() / kRadiansPerDegree);
    }
    std::sort(ellipse.hidden.begin(), ellipse.hidden.end(),
              [](const auto& a, const auto& b) { return a.begin < b.begin; });
    return ellipse;
}

int nearest_whole(double value) {
    const double rounded = std::round(value);
    if (!(std::fabs(rounded) <= std::numeric_limits<int>::max()))
        throw Error("file of ellipses: the number " + shortest(value) + " does not fit");
    return static_cast<int>(rounded);
}

/// Appends numbers as a row.
void add_row(std::initializer_list<int> numbers, std::string& text) {
    constexpr std::size_t kMostOfOne = 12;
    char row[6 * kMostOfOne];
    char* end = row;
    for (const int number : numbers) {
        end = std::to_chars(end, row + sizeof row, number).ptr;
        *end++ = ' ';
    }
    end[-1] = '\n';
    text.append(row, end);
}

/// The whole numbers of a text, whatever blanks and lines stand between them.
class EllipseNumbers {
  public:
    EllipseNumbers(std::string_view text, std::string_view name) : m_text(text), m_name(name) {}

    bool at_end() {
        while (!m_text.empty() && (m_text[0] == ' ' || (m_text[0] >= '\t' && m_text[0] <= '\r'))) {
            m_line += m_text[0] == '\n';
            m_text.remove_prefix(1);
        }
        return m_text.empty();
    }
    int next(const char* what, int least, int most) {
        if (at_end()) fail(std::string("the text ends, expected ") + what);
        const std::string_view word = m_text.substr(0, m_text.find_first_of(" \t\n\v\f\r"));
        int value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || value < least || value > most)
            fail("found \"" + text_file::excerpt(word) + "\", expected " + what + ", an integer from " +
                 std::to_string(least) + " to " + std::to_string(most));
        m_text.remove_prefix(word.size());
        return value;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        text_file::fail(m_name, "line " + std::to_string(m_line), what);
    }

    std::string_view m_text, m_name;
    int m_line = 1;
};

// Lengths of files are at most a thousand windows: so an ellipse has no more than some 100,000 chords.
constexpr int kMostCount = 1 << 20, kMost = 1'000'000'000, kFar = 1'000'000, kWholeTurn = 3600;

FlatEllipse read_ellipse(EllipseNumbers& numbers) {
    FlatEllipse ellipse;
    ellipse.center.x = numbers.next("a coordinate", -kFar, kFar);
    ellipse.center.y = numbers.next("a coordinate", -kFar, kFar);
    ellipse.minor = numbers.next("half an axis", 0, kFar);
    ellipse.major = numbers.next("half an axis", 0, kFar);
    ellipse.phi = numbers.next("an angle", -kMost, kMost) / kTenthsOfDegree;
    const int arcs = numbers.next("a count of arcs", 0, kMostCount);
    for (int i = 0; i < arcs; ++i) {
        const int begin = numbers.next("an arc's beginning", -kMost, kMost);
        const int end = numbers.next("an arc's end", begin, begin + kWholeTurn);
        ellipse.hidden.push_back({begin / kTenthsOfDegree, end / kTenthsOfDegree});
    }
    return ellipse;
}

}  // namespace

glm::dvec2 FlatEllipse::at(double angle) const {
    const double a = (angle + 90) * kRadiansPerDegree, c = std::cos(phi * kRadiansPerDegree),
                 s = std::sin(phi * kRadiansPerDegree);
    return center + minor * std::cos(a) * glm::dvec2(c, s) + major * std::sin(a) * glm::dvec2(-s, c);
}

EllipseFrame ellipses_of(const FigureFrame& frame, bool hide, const ParallelFor& parallel_for) {
    OutlineOptions options;
    options.hide = hide;
    EllipseFrame flat_frame{frame.number, {}};
    for (const Outline& outline : outlines(frame, view_of(frame), options, parallel_for).bodies)
        flat_frame.ellipses.push_back(flat(outline));
    return flat_frame;
}

std::string ellipse_text(const EllipseFrame& frame) {
    std::string text;
    add_row({static_cast<int>(frame.ellipses.size()), frame.number}, text);
    std::vector<std::pair<int, int>> arcs;
    for (const FlatEllipse& e : frame.ellipses) {
        arcs.clear();
        for (const auto& [begin, end] : e.hidden) {
            const int from = nearest_whole(kTenthsOfDegree * begin),
                      to = nearest_whole(kTenthsOfDegree * end);
            if (from != to) arcs.emplace_back(from, to);
        }
        add_row(
            {nearest_whole(e.center.x), nearest_whole(e.center.y), nearest_whole(e.minor),
             nearest_whole(e.major), nearest_whole(kTenthsOfDegree * e.phi), static_cast<int>(arcs.size())},
            text);
        for (const auto& [from, to] : arcs) add_row({from, to}, text);
    }
    return text;
}

std::vector<EllipseFrame> parse_ellipses(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    EllipseNumbers numbers(text, name);
    std::vector<EllipseFrame> frames;
    while (!numbers.at_end()) {
        const int count = numbers.next("a count of ellipses", 0, kMostCount);
        EllipseFrame frame{numbers.next("a frame", -kMost, kMost), {}};
        for (int i = 0; i < count; ++i) frame.ellipses.push_back(read_ellipse(numbers));
        frames.push_back(std::move(frame));
    }
    return frames;
}

Drawing plotted(const EllipseFrame& frame, double size, double tol) {
    const double scale = size / 1000;
    Drawing drawing;
    drawing.frame = frame.number;
    drawing.size = glm::dvec2(size);
    for (std::size_t i = 0; i < frame.ellipses.size(); ++i) {
        const FlatEllipse& e = frame.ellipses[i];
        std::vector<Arc> hidden;
        for (const auto& [begin, end] : e.hidden) {
            const double from = within_turn(begin);
            hidden.push_back({from, from + end - begin});
        }
        // The chord over an angle d is within r (1 - cos(d / 2)) <= r d^2 / 8 of a circle of radius r, and the ellipse is that of its
        // longer axis, pressed together.
        const double radius = scale * std::max(e.minor, e.major);
        const double longest = std::sqrt(8 * tol / std::max(radius, tol)) / kRadiansPerDegree;
        for (const Arc& arc : complement_of(hidden, kDegreesOfTurn)) {
            Stroke stroke;
            stroke.body = std::to_string(i + 1);
            stroke.position = static_cast<int>(i);
            const auto chords = static_cast<int>(std::ceil(std::max(arc.length() / longest, 1.0)));
            for (int k = 0; k <= chords; ++k) {
                const glm::dvec2 p = scale * e.at(arc.begin + arc.length() * k / chords);
                stroke.points.push_back({p.x, size - p.y});
            }
            if (arc.length() >= kDegreesOfTurn) stroke.points.back() = stroke.points.front();
            drawing.strokes.push_back(std::move(stroke));
        }
    }
    return drawing;
}

}  // namespace anamorph::figure
