// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/mrasel_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

constexpr double kScreenRows = 512, kUnitsOfPixel = 1000 / kScreenRows;
constexpr int kMostBodies = 100000;

class MraselWords {
  public:
    MraselWords(std::string_view text, std::string_view file) : m_text(text), m_file(file) {}

    /// Skips blanks. Whether that is all that is left.
    bool at_end() {
        while (!m_text.empty() && is_blank(m_text.front())) {
            m_line += m_text.front() == '\n';
            m_text.remove_prefix(1);
        }
        return m_text.empty();
    }
    std::string_view next(const char* what) {
        if (at_end()) fail(std::string("the text ends, expected ") + what);
        std::size_t size = 0;
        while (size < m_text.size() && !is_blank(m_text[size])) ++size;
        const std::string_view word = m_text.substr(0, size);
        m_text.remove_prefix(size);
        return word;
    }
    double number(const char* what, double least, double most) {
        const std::string_view word = next(what);
        double value = 0;
        std::string_view rest = word;
        if (!text_file::take_number(rest, value) || !rest.empty() || !(value >= least && value <= most))
            fail("found \"" + text_file::excerpt(word) + "\", expected " + what + ", a number from " +
                 shortest(least) + " to " + shortest(most));
        return value;
    }
    int count(const char* what) {
        const double value = number(what, 0, kMostBodies);
        if (value != std::floor(value)) fail(std::string("expected ") + what + ", an integer");
        return static_cast<int>(value);
    }
    glm::dvec3 vector(const char* what, double least, double most) {
        const double x = number(what, least, most), y = number(what, least, most),
                     z = number(what, least, most);
        return {x, y, z};
    }
    [[noreturn]] void fail(const std::string& what) const {
        text_file::fail(m_file, "line " + std::to_string(m_line), what);
    }

  private:
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

    std::string_view m_text, m_file;
    int m_line = 1;
};

}  // namespace

MraselInput mrasel_input(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    constexpr double kFar = 1e9, kPerUnit = 10;
    MraselWords words(text, name);
    MraselInput input;
    FigureFrame& frame = input.frame;
    frame.number = 1;
    const int bodies = words.count("the number of ellipsoids");
    input.debug = words.number("the flag of debugging", -kFar, kFar) == -1;
    const int bands = words.count("the number of bands");
    double above = 0;
    for (int i = 0; i < bands; ++i) {
        const double end = words.number("a band's last row", above, kScreenRows - 1);
        above = end;
        frame.bands.push_back({(end + 1) / kScreenRows, words.vector("a colour", 0, 255)});
    }
    if (bodies > 0) frame.figures = {"frame"};
    for (int i = 0; i < bodies; ++i) {
        Body body;
        body.shape.axes = words.vector("half an axis", 0, kFar) * kUnitsOfPixel;
        body.shape.center = words.vector("a coordinate", -kFar, kFar) * (kUnitsOfPixel / kPerUnit);
        body.shape.rotation =
            glm::mat3_cast(turn_of_angles(words.vector("an angle", -kFar, kFar) / kPerUnit));
        body.texture = body.name = words.next("the name of a map");
        frame.bodies.push_back(std::move(body));
    }
    if (!words.at_end())
        words.fail("found \"" + text_file::excerpt(words.next("nothing")) + "\" behind the last of " +
                   std::to_string(bodies) + " ellipsoids");
    return input;
}

FigureFrame mrasel_frame(std::string_view text, std::string_view name) {
    return mrasel_input(text, name).frame;
}

}  // namespace anamorph::figure
