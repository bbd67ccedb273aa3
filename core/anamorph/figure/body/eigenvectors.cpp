// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/eigenvectors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>

namespace anamorph::figure {

glm::dmat3 eigenvectors(glm::dmat3 a) {
    glm::dmat3 v(1.0);
    for (int sweep = 0; sweep < 30; ++sweep)
        for (const auto& [i, j] : {std::array{0, 1}, std::array{0, 2}, std::array{1, 2}}) {
            if (a[i][j] == 0) continue;
            const double t = 0.5 * std::atan2(2 * a[i][j], a[i][i] - a[j][j]);
            glm::dmat3 turn(1.0);
            turn[i][i] = turn[j][j] = std::cos(t);
            turn[i][j] = std::sin(t);
            turn[j][i] = -turn[i][j];
            a = glm::transpose(turn) * a * turn;
            v = v * turn;
        }
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int i, int j) { return a[i][i] > a[j][j]; });
    return {v[order[0]], v[order[1]], v[order[2]]};
}

}  // namespace anamorph::figure
