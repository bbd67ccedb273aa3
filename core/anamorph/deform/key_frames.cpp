// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/key_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

constexpr double kLargest = 1e300;

void check_number(const std::string& name, double value) {
    if (!(std::fabs(value) <= kLargest))
        throw Error(name, shortest(value), "must be a number from -1e300 to 1e300");
}

std::string entry(const char* name, std::size_t i) {
    return std::string(name).append("[").append(std::to_string(i)).append("]");
}

}  // namespace

ShapeFrames frames_of_keys(const std::vector<ShapeKey>& keys, int count, const std::string& column,
                           const std::string& one) {
    std::map<double, std::vector<double>> frames;
    std::set<std::pair<double, double>> seen;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const auto [time, shape, weight] = keys[i];
        if (!std::isfinite(time))
            throw Error(entry("Keys", i) + ".Time", shortest(time), "must be a finite number");
        if (!(shape >= 0 && shape < count) || shape != std::floor(shape))
            throw Error(entry("Keys", i) + "." + column, shortest(shape),
                        "must be " + one + " from 0 to " + std::to_string(count - 1));
        if (!seen.emplace(time, shape).second)
            throw Error(
                entry("Keys", i) + ".Time", shortest(time),
                one.substr(one.find(' ') + 1) + " " + shortest(shape) + " has a key at this time already");
        std::vector<double>& weights = frames[time];
        weights.resize(static_cast<std::size_t>(count));
        weights[static_cast<std::size_t>(shape)] = weight;
    }
    ShapeFrames result;
    for (const auto& [time, weights] : frames) {
        result.times.push_back(time);
        result.weights.push_back(weights);
    }
    return result;
}

KeyFrames::KeyFrames(std::vector<double> times, std::vector<std::vector<double>> values,
                     KeyInterpolation interpolation)
    : m_times(std::move(times)), m_values(std::move(values)), m_interpolation(interpolation) {
    if (m_times.empty()) throw Error("times", "no numbers", "there must be at least one key frame");
    if (m_values.size() != m_times.size())
        throw Error("values", std::to_string(m_values.size()) + " frames",
                    "must be as many as times, " + std::to_string(m_times.size()));
    for (std::size_t k = 0; k < m_times.size(); ++k) {
        check_number(entry("times", k), m_times[k]);
        if (k > 0 && !(m_times[k] > m_times[k - 1]))
            throw Error(entry("times", k), shortest(m_times[k]),
                        "times must ascend, and the one before is " + shortest(m_times[k - 1]));
        if (m_values[k].size() != size())
            throw Error(entry("values", k), std::to_string(m_values[k].size()) + " numbers",
                        "must be as many as in the first frame, " + std::to_string(size()));
        for (std::size_t i = 0; i < size(); ++i)
            check_number(entry("values", k) + "[" + std::to_string(i) + "]", m_values[k][i]);
    }
}

std::vector<double> KeyFrames::at(double time) const {
    if (std::isnan(time)) throw Error("time", "nan", "must be a number");
    // The last frame that is not later.
    const auto next = std::upper_bound(m_times.begin(), m_times.end(), time);
    if (next == m_times.begin()) return m_values.front();
    const auto frame = static_cast<std::size_t>(next - m_times.begin()) - 1;
    if (next == m_times.end() || m_interpolation == KeyInterpolation::step) return m_values[frame];
    const double s = (time - m_times[frame]) / (m_times[frame + 1] - m_times[frame]);
    std::vector<double> result(size());
    for (std::size_t i = 0; i < size(); ++i)
        result[i] = m_interpolation == KeyInterpolation::linear
                        ? (1 - s) * m_values[frame][i] + s * m_values[frame + 1][i]
                        : cubic(frame, i, s);
    return result;
}

std::vector<double> KeyFrames::slopes(std::size_t frame) const {
    std::vector<double> slopes(size(), 0.0);
    for (std::size_t i = 0; i < size() && m_times.size() > 1; ++i) slopes[i] = slope(frame, i, 1);
    return slopes;
}

/// Cubic Hermite interpolation from `frame` to the next, s in [0, 1).
double KeyFrames::cubic(std::size_t frame, std::size_t number, double s) const {
    const double length = m_times[frame + 1] - m_times[frame];
    const double rest = 1 - s;
    return rest * rest * (1 + 2 * s) * m_values[frame][number] +
           s * s * (3 - 2 * s) * m_values[frame + 1][number] +
           s * rest * (rest * slope(frame, number, length) - s * slope(frame + 1, number, length));
}

/// The change over `length` at a frame's slope. Lengths divide first: they may be very unequal.
double KeyFrames::slope(std::size_t frame, std::size_t number, double length) const {
    const auto value = [&](std::size_t k) { return m_values[k][number]; };
    const std::size_t last = m_times.size() - 1;
    if (frame == 0) return (value(1) - value(0)) * (length / (m_times[1] - m_times[0]));
    if (frame == last)
        return (value(last) - value(last - 1)) * (length / (m_times[last] - m_times[last - 1]));
    const double before = m_times[frame] - m_times[frame - 1], after = m_times[frame + 1] - m_times[frame];
    if (m_interpolation == KeyInterpolation::catmull_rom)
        return (value(frame + 1) - value(frame - 1)) * (length / (before + after));
    const double rise_before = (value(frame) - value(frame - 1)) * (length / before),
                 rise_after = (value(frame + 1) - value(frame)) * (length / after);
    if (!(rise_before != 0 && rise_after != 0 && (rise_before > 0) == (rise_after > 0))) return 0;
    // The mean weighs the shorter side more.
    const double share = (before + 2 * after) / (3 * (before + after));
    return 1 / (share / rise_before + (1 - share) / rise_after);
}

}  // namespace anamorph
