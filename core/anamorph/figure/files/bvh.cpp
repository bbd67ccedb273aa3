// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/body/window_fit.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

constexpr int kMostJoints = 10000;
constexpr int kMostFrames = 1'000'000;
constexpr double kMostPoses = 5e7;
/// Half the width of a bone: a share of its length, within shares of the skeleton's size.
constexpr double kWidth = 0.14, kLeastWidth = 0.008, kMostWidth = 0.05;
/// Half the length of a bone's ellipsoid, so that neighbours overlap at their joint.
constexpr double kHalfLength = 0.54;

enum class Channel { x, y, z, turn_x, turn_y, turn_z };

struct BvhJoint {
    std::string name;
    int parent = -1;
    glm::dvec3 offset{0.0};
    std::vector<Channel> channels;
    bool is_end = false;
};

/// Words with the lines that they stand in.
class BvhWords {
  public:
    BvhWords(std::string_view text, std::string_view file) : m_text(text), m_file(file) {}

    /// The next word; empty at the end.
    std::string_view next() {
        while (!m_text.empty() && is_blank(m_text.front())) {
            m_line += m_text.front() == '\n';
            m_text.remove_prefix(1);
        }
        std::size_t end = 0;
        while (end < m_text.size() && !is_blank(m_text[end]) && !is_brace(m_text[end])) ++end;
        if (end == 0 && !m_text.empty()) end = 1;  // a brace
        const std::string_view word = m_text.substr(0, end);
        m_text.remove_prefix(end);
        return word;
    }
    void expect(std::string_view wanted) {
        const std::string_view word = next();
        if (word != wanted) fail(found(word) + ", but " + std::string(wanted) + " must be here");
    }
    double number(const char* what) {
        const std::string_view word = next();
        std::string_view rest = word;
        double value = 0;
        constexpr double kMost = 1e9;
        if (!text_file::take_number(rest, value) || !rest.empty() || !(std::fabs(value) <= kMost))
            fail(found(word) + ", but " + what + " must be here, a number from -1e9 to 1e9");
        return value;
    }
    int whole(const char* what, double least, double most) {
        const double value = number(what);
        if (value != std::floor(value) || value < least || value > most)
            fail(std::string(what) + " must be an integer from " + std::to_string(static_cast<int>(least)) +
                 " to " + std::to_string(static_cast<int>(most)));
        return static_cast<int>(value);
    }
    /// A name, which may have blanks: up to the end of the line or a brace.
    std::string name() {
        const std::size_t end = std::min(m_text.find_first_of("\n{}"), m_text.size());
        std::string name(text_file::trimmed(m_text.substr(0, end)));
        m_text.remove_prefix(end);
        return name;
    }
    [[noreturn]] void fail(const std::string& what) const {
        text_file::fail(m_file, "line " + std::to_string(m_line), what);
    }
    static std::string found(std::string_view word) {
        return word.empty() ? "the file ends" : "\"" + text_file::excerpt(word) + "\" is here";
    }

  private:
    static bool is_brace(char c) { return c == '{' || c == '}'; }
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == '\0'; }

    std::string_view m_text, m_file;
    int m_line = 1;
};

std::vector<Channel> read_channels(BvhWords& words) {
    static constexpr std::pair<std::string_view, Channel> kNames[] = {
        {"Xposition", Channel::x},      {"Yposition", Channel::y},      {"Zposition", Channel::z},
        {"Xrotation", Channel::turn_x}, {"Yrotation", Channel::turn_y}, {"Zrotation", Channel::turn_z}};
    std::vector<Channel> channels(static_cast<std::size_t>(words.whole("a count of channels", 0, 6)));
    for (Channel& channel : channels) {
        const std::string_view word = words.next();
        const auto* known = std::find_if(std::begin(kNames), std::end(kNames),
                                         [&](const auto& name) { return name.first == word; });
        if (known == std::end(kNames))
            words.fail(BvhWords::found(word) +
                       ", but a channel must be here: Xposition, Yposition, Zposition, Xrotation, Yrotation "
                       "or Zrotation");
        channel = known->second;
    }
    return channels;
}

/// Joints in the order of the file, parents before their children.
std::vector<BvhJoint> read_hierarchy(BvhWords& words) {
    words.expect("HIERARCHY");
    std::vector<BvhJoint> joints;
    int parent = -1;
    std::string_view word = words.next();
    while (word != "MOTION") {
        if (word == "}" && parent >= 0) {
            parent = joints[static_cast<std::size_t>(parent)].parent;
        } else if (word == "OFFSET" && parent >= 0) {
            for (int c = 0; c < 3; ++c)
                joints[static_cast<std::size_t>(parent)].offset[c] = words.number("an offset");
        } else if (word == "CHANNELS" && parent >= 0) {
            joints[static_cast<std::size_t>(parent)].channels = read_channels(words);
        } else if ((word == "ROOT" && parent < 0) || ((word == "JOINT" || word == "End") && parent >= 0)) {
            if (joints.size() == kMostJoints) words.fail("a skeleton may have at most 10000 joints");
            BvhJoint joint;
            joint.is_end = word == "End";
            joint.name = words.name();
            joint.parent = parent;
            words.expect("{");
            parent = static_cast<int>(joints.size());
            joints.push_back(std::move(joint));
        } else {
            words.fail(BvhWords::found(word) +
                       (parent < 0 ? ", but ROOT or MOTION must be here"
                                   : ", but OFFSET, CHANNELS, JOINT, End Site or } must be here"));
        }
        word = words.next();
    }
    if (parent >= 0) words.fail("a } is missing before MOTION");
    if (joints.empty()) words.fail("there is no ROOT");
    return joints;
}

/// Where a joint is and how it is turned, in the file's coordinates.
struct Posed {
    glm::dvec3 position{0.0};
    glm::dquat turn{1, 0, 0, 0};
};

/// A bone between two joints.
struct Bone {
    int from, to;
    double half_length, half_width;
    glm::dquat along;  ///< takes y to the bone's direction at rest
    std::string name;
    int before;  ///< the bone that it hangs on; -1: none
};

class BvhMotion final : public Motion {
  public:
    BvhMotion(std::string_view text, std::string_view name) {
        text_file::check_size(text, name);
        BvhWords words(text, name);
        m_joints = read_hierarchy(words);
        for (const BvhJoint& joint : m_joints) m_channels += joint.channels.size();
        words.expect("Frames:");
        m_frames = words.whole("the number of frames", 0, kMostFrames);
        words.expect("Frame");
        words.expect("Time:");
        if (static_cast<double>(m_frames) * static_cast<double>(m_joints.size()) > kMostPoses)
            words.fail("frames times joints must be at most 5e7");
        m_frame_time = words.number("the time of a frame");
        if (!(m_frame_time >= 1e-6)) words.fail("the time of a frame must be at least 1e-6 seconds");
        // Some programs write a frame more than they say; it is passed over.
        for (std::size_t i = 0; i < static_cast<std::size_t>(m_frames) * m_channels; ++i)
            m_values.push_back(words.number("the value of a channel"));
        make_bones(words);
        fit_into_window();
    }

    int last_frame() override { return m_frames; }
    double frames_per_second() const override { return 1 / m_frame_time; }

    FigureFrame frame(int number) override {
        if (number < 0 || number > m_frames)
            throw Error("frame", std::to_string(number),
                        "must be an integer from 0 to " + std::to_string(m_frames));
        const std::vector<Posed> posed = pose(number);
        FigureFrame frame;
        frame.number = number;
        frame.figures = {m_joints[0].name.empty() ? "figure" : m_joints[0].name};
        for (const Bone& bone : m_bones) {
            Body body;
            body.name = bone.name;
            body.shape = ellipsoid_of(bone, posed);
            if (bone.before >= 0) {
                const auto at = static_cast<std::size_t>(bone.from);
                frame.joints.push_back({m_joints[at].name, bone.before, static_cast<int>(frame.bodies.size()),
                                        m_window.point(posed[at].position)});
            }
            frame.bodies.push_back(std::move(body));
        }
        return frame;
    }

  private:
    /// A joint's turn is its parent's times its own, its position the parent's plus the
    /// turned offset, in place of which position channels come.
    std::vector<Posed> pose(int number) const {
        static constexpr glm::dvec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        std::vector<Posed> posed(m_joints.size());
        const double* value =
            number > 0 ? &m_values[static_cast<std::size_t>(number - 1) * m_channels] : nullptr;
        for (std::size_t j = 0; j < m_joints.size(); ++j) {
            const BvhJoint& joint = m_joints[j];
            glm::dvec3 offset = joint.offset;
            glm::dquat turn(1, 0, 0, 0);
            if (value)
                for (const Channel channel : joint.channels) {
                    const int c = static_cast<int>(channel);
                    if (c < 3)
                        offset[c] = *value;
                    else
                        turn = turn * turn_about(kAxes[c - 3], *value);
                    ++value;
                }
            const Posed parent = joint.parent < 0 ? Posed() : posed[static_cast<std::size_t>(joint.parent)];
            posed[j] = {parent.position + parent.turn * offset, glm::normalize(parent.turn * turn)};
        }
        return posed;
    }

    void make_bones(const BvhWords& words) {
        const std::vector<Posed> rest = pose(0);
        glm::dvec3 least = rest[0].position, most = least;
        for (const Posed& p : rest) {
            least = glm::min(least, p.position);
            most = glm::max(most, p.position);
        }
        const glm::dvec3 extent = most - least;
        const double size = std::max({extent.x, extent.y, extent.z});
        std::vector<int> children(m_joints.size());
        for (const BvhJoint& joint : m_joints)
            if (joint.parent >= 0) ++children[static_cast<std::size_t>(joint.parent)];
        // The bone that what begins at a joint hangs on: one that ends there, or the first that begins there.
        std::vector<int> holder(m_joints.size(), -1);
        for (std::size_t j = 0; j < m_joints.size(); ++j) {
            const BvhJoint& joint = m_joints[j];
            if (joint.parent < 0) continue;
            const auto parent = static_cast<std::size_t>(joint.parent);
            const double length = glm::length(joint.offset);
            if (!(length > 1e-6 * size)) {
                holder[j] = holder[parent];
                continue;
            }
            const double width = std::clamp(kWidth * length, kLeastWidth * size, kMostWidth * size);
            std::string name = m_joints[parent].name;
            if (children[parent] > 1 && !joint.is_end) name += "-" + joint.name;
            m_bones.push_back({joint.parent, static_cast<int>(j), kHalfLength * length, width,
                               from_y_to(joint.offset / length), std::move(name), holder[parent]});
            holder[j] = static_cast<int>(m_bones.size()) - 1;
            if (holder[parent] < 0) holder[parent] = holder[j];
        }
        if (m_bones.empty()) words.fail("the skeleton has no bone of a length above 0");
    }

    /// The shortest turn that takes y to a direction.
    static glm::dquat from_y_to(const glm::dvec3& d) {
        const glm::dquat q(1 + d.y, glm::cross(glm::dvec3(0, 1, 0), d));
        return glm::length(q) > 1e-9 ? glm::normalize(q) : glm::dquat(0, 1, 0, 0);
    }

    void fit_into_window() {
        glm::dvec3 least(HUGE_VAL), most(-HUGE_VAL);
        for (int f = m_frames > 0 ? 1 : 0; f <= m_frames; ++f)
            for (const Posed& p : pose(f)) {
                least = glm::min(least, p.position);
                most = glm::max(most, p.position);
            }
        m_window = WindowFit(least, most);
    }
    Ellipsoid ellipsoid_of(const Bone& bone, const std::vector<Posed>& posed) const {
        const Posed &from = posed[static_cast<std::size_t>(bone.from)],
                    &to = posed[static_cast<std::size_t>(bone.to)];
        return m_window.ellipsoid({0.5 * (from.position + to.position),
                                   {bone.half_width, bone.half_length, bone.half_width},
                                   glm::mat3_cast(from.turn * bone.along)});
    }

    std::vector<BvhJoint> m_joints;
    std::vector<Bone> m_bones;
    std::size_t m_channels = 0;  ///< of a frame
    int m_frames = 0;
    double m_frame_time = 0;
    std::vector<double> m_values;
    WindowFit m_window;
};

}  // namespace

std::unique_ptr<Motion> read_bvh(std::string_view text, std::string_view name) {
    return std::make_unique<BvhMotion>(text, name);
}

}  // namespace anamorph::figure
