// SPDX-License-Identifier: Apache-2.0
// Pictures for a text terminal, of characters that are a few dots each.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "writers.h"

namespace anamorph::command {
using namespace figure;
namespace {

class Dots {
  public:
    explicit Dots(int size)
        : m_size(size), m_dots(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {}

    bool at(int x, int y) const { return x < m_size && y < m_size && m_dots[index(x, y)]; }

    /// Every dot on the way, `skip` of which are left out after as many that are not.
    void line(const glm::dvec2& a, const glm::dvec2& b, int skip) {
        const double longest = std::max(std::fabs(b.x - a.x), std::fabs(b.y - a.y));
        const int steps = static_cast<int>(std::ceil(longest)) + 1;
        for (int k = 0; k <= steps; ++k) {
            const glm::dvec2 p = a + (b - a) * (static_cast<double>(k) / steps);
            if (skip == 0 || m_drawn++ / skip % 2 == 0) set(p);
        }
    }

    void set(const glm::dvec2& p) {
        const double x = std::floor(p.x), y = std::floor(p.y);
        if (x >= 0 && x < m_size && y >= 0 && y < m_size)
            m_dots[index(static_cast<int>(x), static_cast<int>(y))] = true;
    }

  private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(m_size) + static_cast<std::size_t>(x);
    }

    int m_size, m_drawn = 0;
    std::vector<bool> m_dots;
};

/// The character U+2800 + bits in UTF-8. Its dots 1 to 8 are bits 0 to 7: 1 2 3 down the left column, 4 5 6
/// down the right one, 7 and 8 below.
std::string braille(const Dots& dots, int x, int y) {
    static constexpr int bit[4][2] = {{0, 3}, {1, 4}, {2, 5}, {6, 7}};
    int bits = 0;
    for (int dy = 0; dy < 4; ++dy)
        for (int dx = 0; dx < 2; ++dx)
            if (dots.at(x + dx, y + dy)) bits |= 1 << bit[dy][dx];
    if (bits == 0) return " ";
    return {static_cast<char>(0xE2), static_cast<char>(0xA0 | bits >> 6),
            static_cast<char>(0x80 | (bits & 0x3F))};
}

std::string ascii(const Dots& dots, int x, int y) {
    static constexpr char sign[] = {' ', '\'', '.', ':'};
    return {sign[(dots.at(x, y) ? 1 : 0) + (dots.at(x, y + 1) ? 2 : 0)]};
}

class TextWriter : public DrawingWriter {
  public:
    TextWriter(const std::string& name, int columns, Characters characters)
        : m_file(name), m_columns(columns), m_characters(characters) {}

    void add(const Drawing& drawing) override {
        const int size = text_size(m_columns, m_characters);
        Dots dots(size);
        for (const Stroke& stroke : drawing.strokes) {
            if (stroke.kind == StrokeKind::dot) dots.set(stroke.points[0]);
            for (std::size_t k = 0; k + 1 < stroke.points.size(); ++k)
                dots.line(stroke.points[k], stroke.points[k + 1], stroke.kind == StrokeKind::hidden ? 2 : 0);
        }
        const bool fine = m_characters == Characters::braille;
        std::string text = "frame " + std::to_string(drawing.frame) + "\n";
        for (int y = 0; y < size; y += fine ? 4 : 2) {
            std::string row;
            for (int x = 0; x < size; x += fine ? 2 : 1)
                row += fine ? braille(dots, x, y) : ascii(dots, x, y);
            row.erase(row.find_last_not_of(' ') + 1);
            text += row + "\n";
        }
        m_file.write(text);
    }
    void finish() override { m_file.close(); }

  private:
    OutputFile m_file;
    int m_columns;
    Characters m_characters;
};

}  // namespace

int text_size(int columns, Characters characters) {
    return characters == Characters::braille ? 2 * columns : columns;
}

std::unique_ptr<DrawingWriter> text_writer(const std::string& name, int columns, Characters characters) {
    return std::make_unique<TextWriter>(name, columns, characters);
}

}  // namespace anamorph::command
