// SPDX-License-Identifier: Apache-2.0
// Key frames: numbers over time (weights of inbetweening, parameters of deformations), given at some times
// and interpolated in between (Oka 1987, section 4.2). Before the first and after the last time they stand
// still.
#pragma once

#include <string>
#include <vector>

#include "anamorph/error.h"

namespace anamorph {

/// How numbers are interpolated between two key frames.
enum class KeyInterpolation {
    step,  ///< the numbers of the last frame, up to the next
    linear,
    catmull_rom,    ///< cubic Hermite with slopes (v_(i+1) - v_(i-1)) / (t_(i+1) - t_(i-1)) (Catmull and Rom
                    ///< 1974, for any times); it overshoots
    monotone_cubic  ///< cubic Hermite whose slopes, harmonic means of the secants weighted by Brodlie's
                    ///< formula (Fritsch and Butland 1984), never overshoot. Not linear in the values:
                    ///< weights that sum to 1 at the frames need not in between, so normalize them. The other
                    ///< ways keep the sum.
};

/// A row of a list of keys: the weight of a shape at a time.
struct ShapeKey {
    double time = 0;
    double shape = 0;  ///< its number
    double weight = 0;
};

/// Frames, in the order of their times.
struct ShapeFrames {
    std::vector<double> times;
    std::vector<std::vector<double>> weights;  ///< of all shapes, in each
};

/// The frames of a list of keys in any order: at each time that has some the weights of `count` shapes, 0 where no key says one. Throws Error
/// naming Keys[i] unless times are finite, shapes are integers from 0 to count - 1, and a shape has one key at a time. `column`: what
/// messages call the shape's column, "Input", and `one` one of them, "an input".
ShapeFrames frames_of_keys(const std::vector<ShapeKey>& keys, int count, const std::string& column,
                           const std::string& one);

/// Numbers given at some times, and interpolated at all others.
class KeyFrames {
  public:
    /// values[k] are the numbers at times[k]. Throws Error, naming the entry, unless there is at least one frame, times
    /// ascend, all frames have as many numbers as the first, and all numbers are between -1e300 and 1e300.
    KeyFrames(std::vector<double> times, std::vector<std::vector<double>> values,
              KeyInterpolation interpolation);

    /// The numbers at a time; before the first frame and after the last one, those of that frame. Throws Error on NaN.
    std::vector<double> at(double time) const;

    /// The slopes of the numbers at a frame, of catmull_rom and monotone_cubic; those of the secants beside it at the ends.
    std::vector<double> slopes(std::size_t frame) const;
    const std::vector<std::vector<double>>& values() const { return m_values; }
    const std::vector<double>& times() const { return m_times; }
    /// The number of numbers in a frame.
    std::size_t size() const { return m_values.front().size(); }

  private:
    double cubic(std::size_t frame, std::size_t number, double s) const;
    double slope(std::size_t frame, std::size_t number, double length) const;

    std::vector<double> m_times;
    std::vector<std::vector<double>> m_values;
    KeyInterpolation m_interpolation;
};

}  // namespace anamorph
