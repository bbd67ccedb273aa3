// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/inbetween.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/deform/deform_kernels.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

constexpr std::int64_t kChunk = 4096;  ///< points that are blended in one turn

void check_weights(std::span<const double> weights) {
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (!std::isfinite(weights[i]))
            throw Error("weights[" + std::to_string(i) + "]", shortest(weights[i]),
                        "must be a finite number");
}

void check_sizes(std::size_t shapes, std::size_t weights, std::int64_t points, int components) {
    if (shapes != weights)
        throw Error("weights", std::to_string(weights) + " numbers",
                    "must be one for each shape, " + std::to_string(shapes));
    if (points < 0) throw Error("points", std::to_string(points), "must be an integer of at least 0");
    if (components < 1)
        throw Error("components", std::to_string(components), "must be an integer of at least 1");
}

void check_mask(const float* mask, std::size_t shape, std::int64_t points) {
    for (std::int64_t p = 0; mask && p < points; ++p)
        if (!std::isfinite(mask[p]))
            throw Error("masks[" + std::to_string(shape) + "][" + std::to_string(p) + "]", shortest(mask[p]),
                        "must be a finite number");
}

/// Calls body(first, count) for stretches of points that make up all of them.
void each_chunk(std::int64_t points, const ParallelFor& parallel_for,
                const std::function<void(std::int64_t, std::int64_t)>& body) {
    parallel_for((points + kChunk - 1) / kChunk,
                 [&](std::int64_t i) { body(i * kChunk, std::min(kChunk, points - i * kChunk)); });
}

/// Shapes that count, with their weights.
template <class T>
struct Blend {
    std::vector<const T*> shapes;
    std::vector<double> weights;

    void add(const T* shape, double weight) {
        if (weight == 0) return;
        shapes.push_back(shape);
        weights.push_back(weight);
    }
    void run(std::int64_t points, int components, T* out, const ParallelFor& parallel_for) const {
        each_chunk(points, parallel_for, [&](std::int64_t first, std::int64_t count) {
            std::vector<const T*> from;
            for (const T* shape : shapes) from.push_back(shape + first * components);
            simd::blend(from.data(), weights.data(), from.size(),
                        static_cast<std::size_t>(count * components), out + first * components);
        });
    }
};

}  // namespace

std::vector<double> inbetween_weights(std::span<const double> weights, WeightSum rule) {
    check_weights(weights);
    double sum = 0, magnitudes = 0;
    for (const double w : weights) {
        sum += w;
        magnitudes += std::fabs(w);
    }
    std::vector<double> result(weights.begin(), weights.end());
    if (rule == WeightSum::checked) {
        if (!(std::fabs(sum - 1) <= kWeightSumError))
            throw Error("weights", "sum " + shortest(sum), "the sum must be 1, or be normalized");
        return result;
    }
    if (!(std::isfinite(magnitudes) && std::fabs(sum) > kLeastWeightSum * magnitudes))
        throw Error("weights", "sum " + shortest(sum),
                    "cannot be normalized: the sum must be finite and not 0 beside the weights");
    for (double& w : result) w /= sum;
    return result;
}

template <class T>
void inbetween(std::span<const T* const> shapes, std::span<const double> weights, WeightSum sum,
               std::int64_t points, int components, T* out, const ParallelFor& parallel_for) {
    check_sizes(shapes.size(), weights.size(), points, components);
    const std::vector<double> coefficients = inbetween_weights(weights, sum);
    Blend<T> blend;
    for (std::size_t i = 0; i < shapes.size(); ++i) blend.add(shapes[i], coefficients[i]);
    blend.run(points, components, out, parallel_for);
}

template <class T>
void inbetween_from_base(const T* base, std::span<const T* const> shapes, std::span<const double> weights,
                         std::span<const float* const> masks, std::int64_t points, int components, T* out,
                         const ParallelFor& parallel_for) {
    check_sizes(shapes.size(), weights.size(), points, components);
    check_weights(weights);
    if (!masks.empty() && masks.size() != shapes.size())
        throw Error("masks", std::to_string(masks.size()),
                    "must be none, or one for each shape, " + std::to_string(shapes.size()));
    for (std::size_t i = 0; i < masks.size(); ++i) check_mask(masks[i], i, points);

    Blend<T> active;
    std::vector<const float*> mask_of;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (weights[i] == 0) continue;
        active.add(shapes[i], weights[i]);
        mask_of.push_back(masks.empty() ? nullptr : masks[i]);
    }
    each_chunk(points, parallel_for, [&](std::int64_t first, std::int64_t count) {
        const std::size_t values = static_cast<std::size_t>(count * components);
        // Masks are per point: repeated for every component.
        std::vector<std::vector<float>> repeated(mask_of.size());
        std::vector<const float*> mask(mask_of.size(), nullptr);
        std::vector<const T*> from;
        for (std::size_t k = 0; k < mask_of.size(); ++k) {
            from.push_back(active.shapes[k] + first * components);
            if (!mask_of[k]) continue;
            repeated[k].resize(values);
            float* to = repeated[k].data();
            for (std::int64_t p = first; p < first + count; ++p, to += components)
                std::fill(to, to + components, mask_of[k][p]);
            mask[k] = repeated[k].data();
        }
        simd::blend_masked(from.data(), mask.data(), active.weights.data(), from.size(),
                           base + first * components, values, out + first * components);
    });
}

template void inbetween(std::span<const float* const>, std::span<const double>, WeightSum, std::int64_t, int,
                        float*, const ParallelFor&);
template void inbetween(std::span<const double* const>, std::span<const double>, WeightSum, std::int64_t, int,
                        double*, const ParallelFor&);
template void inbetween_from_base(const float*, std::span<const float* const>, std::span<const double>,
                                  std::span<const float* const>, std::int64_t, int, float*,
                                  const ParallelFor&);
template void inbetween_from_base(const double*, std::span<const double* const>, std::span<const double>,
                                  std::span<const float* const>, std::int64_t, int, double*,
                                  const ParallelFor&);

}  // namespace anamorph
