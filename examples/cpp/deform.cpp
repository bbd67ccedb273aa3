// SPDX-License-Identifier: Apache-2.0
// A surface with a bump that is edited: only what it reaches is computed again.
#include <anamorph/deform.h>

#include <iostream>
#include <vector>

using namespace anamorph;

int main() {
    // A plane of 501 x 501 points over u and v from 0 to 1.
    std::vector<double> steps;
    for (int i = 0; i <= 500; ++i) steps.push_back(i / 500.0);
    std::vector<double> plane, surface(3 * 501 * 501);
    for (const double v : steps)
        for (const double u : steps) plane.insert(plane.end(), {u, v, 0});

    DeformationList list;
    DeformedGrid grid(steps, steps);
    grid.apply(list.add({.vector = {0, 0, 0.2}, .center = {0.5, 0.5}, .extent = {0.05, 0.05}}));
    grid.write(plane.data(), surface.data());
    const std::size_t middle = 3 * (250 * 501 + 250);
    std::cout << "height " << surface[middle + 2] << ", off by at most " << grid.error_bound() << "\n";

    // One more edit, and its part of the surface.
    const DeformationChange lower =
        list.change(0, {.vector = {0, 0, 0.1}, .center = {0.5, 0.5}, .extent = {0.05, 0.05}});
    grid.apply(lower);
    const GridPart part = grid.update(plane.data(), surface.data());
    std::cout << "height " << surface[middle + 2] << ", columns " << part.column_begin << " to "
              << part.column_end << " of 501 computed again\n";

    // Key frames of the weights of several surfaces, here of the plane and of the bump, and what they have at time 0.25.
    const KeyFrames keys({0, 1}, {{1, 0}, {0, 1}}, KeyInterpolation::linear);
    const std::vector<double> weights = keys.at(0.25);
    const double* shapes[] = {plane.data(), surface.data()};
    std::vector<double> between(surface.size());
    inbetween<double>(shapes, weights, WeightSum::checked, 501 * 501, 3, between.data());
    std::cout << "height " << between[middle + 2] << " at a quarter\n";

    // The same list moves points of space, and back, unless it folds.
    const PlaneWarp warp(ParameterPlane(), list.entries());
    const glm::dvec3 moved = warp.forward({0.5, 0.5, 3});
    std::cout << "a point 3 above moves to " << moved.z << " and back to " << warp.inverse(moved).point.z
              << (warp.find_fold().answer == FoldAnswer::none ? ", nothing folds" : "") << "\n";
}
