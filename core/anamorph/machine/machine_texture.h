// SPDX-License-Identifier: Apache-2.0
// A texture of numbers that is read bilinearly, with weights of few bits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace anamorph::machine {

/// A texture of size x size texels of N numbers.
template <std::size_t N>
class MachineTexture {
  public:
    using Texel = std::array<double, N>;

    /// `texels`: size x size, row by row. Weights are multiples of 2^-weight_bits.
    MachineTexture(int size, int weight_bits, std::vector<Texel> texels)
        : m_size(size), m_weight_unit(std::ldexp(1.0, weight_bits)), m_texels(std::move(texels)) {}

    int size() const { return m_size; }
    /// All texels, row by row.
    const std::vector<Texel>& texels() const { return m_texels; }

    /// Reads the texture at a position in texels, centres at + 0.5; beyond the centres of the outer texels as
    /// there, where it is NaN as at 0. Interpolated with numbers T, along rows first.
    template <class T>
    std::array<T, N> read(double x, double y) const {
        const Place column = place(x), row = place(y);
        std::array<T, N> result;
        for (std::size_t c = 0; c < N; ++c) {
            const auto along = [&](int j) {
                return mixed(T(texel(column.first, j)[c]), T(texel(column.second, j)[c]), column.weight);
            };
            result[c] = mixed(along(row.first), along(row.second), row.weight);
        }
        return result;
    }

  private:
    /// Two neighbours, and the weight of the second.
    struct Place {
        int first, second;
        double weight;
    };
    Place place(double at) const {
        const double inside = at >= 0.5 ? std::min(at - 0.5, m_size - 1.0) : 0;
        const int first = static_cast<int>(inside);
        return {first, std::min(first + 1, m_size - 1),
                std::nearbyint((inside - first) * m_weight_unit) / m_weight_unit};
    }
    template <class T>
    static T mixed(const T& a, const T& b, double weight) {
        return a + (b - a) * T(weight);
    }
    const Texel& texel(int i, int j) const {
        return m_texels[static_cast<std::size_t>(j) * static_cast<std::size_t>(m_size) +
                        static_cast<std::size_t>(i)];
    }

    int m_size;
    double m_weight_unit;
    std::vector<Texel> m_texels;
};

}  // namespace anamorph::machine
