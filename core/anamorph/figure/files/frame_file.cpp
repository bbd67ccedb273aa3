// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/frame_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "anamorph/error.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

using text_file::excerpt;

constexpr double kTenths = 10;

/// Rounded to a whole number of tenths.
std::string whole(double value) {
    if (!(std::abs(value) <= std::numeric_limits<int>::max()))
        throw Error("frame file: the number " + shortest(value) + " does not fit");
    return std::to_string(std::lround(value));
}

std::string tenths(const glm::dvec3& v) {
    return whole(kTenths * v.x) + " " + whole(kTenths * v.y) + " " + whole(kTenths * v.z) + " ";
}

std::string padded(const std::string& text, std::size_t width) {
    return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string head(std::size_t count, int number, const FigureFrame& frame) {
    return std::to_string(count) + " " + std::to_string(number) + " " + tenths(frame.place) +
           tenths(angles_of_rotation(frame.observer)) + "\n";
}

/// The words of a line.
class FrameWords {
  public:
    explicit FrameWords(std::string_view line) : m_line(line) {}

    std::string_view next() {
        const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
        while (!m_line.empty() && blank(m_line.front())) m_line.remove_prefix(1);
        std::size_t size = 0;
        while (size < m_line.size() && !blank(m_line[size])) ++size;
        const std::string_view word = m_line.substr(0, size);
        m_line.remove_prefix(size);
        return word;
    }

    int integer(const char* what) {
        const std::string_view word = next();
        int value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || word.empty())
            throw Error("found \"" + excerpt(word) + "\", expected " + what + ", an integer");
        return value;
    }

    glm::dvec3 vector(const char* what) {
        const double x = integer(what), y = integer(what), z = integer(what);
        return glm::dvec3(x, y, z) / kTenths;
    }

  private:
    std::string_view m_line;
};

std::string name_from(FrameWords& words, const char* what) {
    const std::string_view word = words.next();
    if (word.empty()) throw Error(std::string("found the end of the line, expected ") + what);
    return std::string(word);
}

Body read_body(FrameWords words) {
    Body body;
    body.shape.axes = words.vector("half an axis");
    if (body.shape.axes.x < 0 || body.shape.axes.y < 0 || body.shape.axes.z < 0)
        throw Error("an axis is negative");
    body.shape.center = words.vector("a coordinate");
    body.shape.rotation = glm::mat3_cast(turn_of_angles(words.vector("an angle")));
    const int red = words.integer("a colour"), green = words.integer("a colour"),
              blue = words.integer("a colour");
    body.name = name_from(words, "a name");
    if (red >= 0) {
        body.color = {red, green, blue};
    } else {
        body.texture_offset = {green, blue};
        body.texture = name_from(words, "a picture");
    }
    return body;
}

/// Gives bodies that joints connect one figure, named after the first of them.
void find_figures(FigureFrame& frame) {
    std::vector<int> root(frame.bodies.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
        while (root[static_cast<std::size_t>(i)] != i) {
            auto& parent = root[static_cast<std::size_t>(i)];
            parent = root[static_cast<std::size_t>(parent)];
            i = parent;
        }
        return i;
    };
    for (const Joint& joint : frame.joints) {
        const int a = find(joint.first), b = find(joint.second);
        root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const auto first = static_cast<std::size_t>(find(static_cast<int>(i)));
        if (first == i) {
            frame.bodies[i].figure = static_cast<int>(frame.figures.size());
            frame.figures.push_back(frame.bodies[i].name);
        } else {
            frame.bodies[i].figure = frame.bodies[first].figure;
        }
    }
}

}  // namespace

std::string frame_text(const FigureFrame& frame) {
    std::string text = head(frame.bodies.size(), frame.number, frame);
    std::vector<std::string> pictures;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const Body& body = frame.bodies[i];
        text += tenths(body.shape.axes) + tenths(body.shape.center) +
                tenths(angles_of_rotation(body.shape.rotation));
        if (body.texture.empty()) {
            // A negative red would mean a picture.
            text += padded(whole(std::max(body.color.x, 0.0)), 3) + " " + padded(whole(body.color.y), 3) +
                    " " + padded(whole(body.color.z), 3) + " " + body.name + " " + std::to_string(i + 1) +
                    "\n";
            continue;
        }
        auto picture = std::find(pictures.begin(), pictures.end(), body.texture);
        if (picture == pictures.end()) picture = pictures.insert(pictures.end(), body.texture);
        text += padded(std::to_string(pictures.begin() - picture - 1), 3) + " " +
                padded(whole(body.texture_offset.x), 3) + " " + padded(whole(body.texture_offset.y), 3) +
                " " + body.name + " " + body.texture + "\n";
    }
    text += "-1 " + std::to_string(frame.joints.size()) + "\n";
    for (const Joint& joint : frame.joints) {
        std::string position = tenths(joint.position);
        text += padded(std::to_string(joint.first), 3) + " " + padded(std::to_string(joint.second), 3) + " " +
                position + " " + joint.name + "\n";
    }
    return text;
}

std::string frames_end_text(const FigureFrame& last) {
    return head(0, last.number + 1, last);
}

FrameReader::FrameReader(std::string_view text, std::string_view name) : m_text(text), m_name(name) {}

bool FrameReader::read(FigureFrame& frame) {
    const auto next_line = [&] {
        if (m_text.empty()) throw Error("the text ends inside of a frame");
        const std::size_t end = m_text.find('\n');
        const std::string_view line = m_text.substr(0, end);
        m_text.remove_prefix(end == std::string_view::npos ? m_text.size() : end + 1);
        ++m_line;
        return line;
    };
    const auto blank = [](std::string_view line) {
        return line.find_first_not_of(" \t\r") == std::string_view::npos;
    };
    try {
        std::string_view line;
        do {
            if (m_ended || m_text.empty()) return false;
            line = next_line();
        } while (blank(line));
        frame = FigureFrame();
        FrameWords words(line);
        const int count = words.integer("a count of ellipsoids");
        frame.number = words.integer("a frame");
        if (count < 0) throw Error("a count is negative");
        frame.place = words.vector("a coordinate");
        frame.observer = glm::mat3_cast(turn_of_angles(words.vector("an angle")));
        frame.observe = xyz_of_rotation(frame.observer);
        if (count == 0) {
            m_ended = true;
            return false;
        }
        for (int i = 0; i < count; ++i) frame.bodies.push_back(read_body(FrameWords(next_line())));
        FrameWords joints(next_line());
        if (joints.integer("-1") != -1) throw Error("expected -1 and a count of joints");
        const int joint_count = joints.integer("a count of joints");
        if (joint_count < 0) throw Error("a count is negative");
        for (int i = 0; i < joint_count; ++i) {
            FrameWords row(next_line());
            Joint joint;
            joint.first = row.integer("an ellipsoid");
            joint.second = row.integer("an ellipsoid");
            if (std::min(joint.first, joint.second) < 0 || std::max(joint.first, joint.second) >= count)
                throw Error("an ellipsoid must be from 0 to " + std::to_string(count - 1));
            joint.position = row.vector("a coordinate");
            joint.name = name_from(row, "a name");
            frame.joints.push_back(joint);
        }
        find_figures(frame);
        return true;
    } catch (const Error& error) {
        throw Error(excerpt(m_name) + ":" + std::to_string(m_line) + ": " + error.what());
    }
}

std::vector<FigureFrame> parse_frames(std::string_view text, std::string_view name) {
    std::vector<FigureFrame> frames;
    FrameReader reader(text, name);
    for (FigureFrame frame; reader.read(frame);) frames.push_back(std::move(frame));
    return frames;
}

}  // namespace anamorph::figure
