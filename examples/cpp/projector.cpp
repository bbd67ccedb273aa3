// SPDX-License-Identifier: Apache-2.0
// A panorama thrown onto a wall with a pillar before it: triangles to render, and a texture baked.
#include <anamorph/projector.h>

#include <array>
#include <iostream>
#include <vector>

using namespace anamorph;

int main() {
    const Projector projector(Chart(Projection::equirectangular, 2048, 1024),
                              {.position = {0, 0, 0}, .direction = {0, 0, -1}, .up = {0, 1, 0}});
    Point<double> texel{};
    if (projector.receive({0, 0, -4}, texel) == Received::texel)
        std::cout << "the wall's middle shows texel (" << texel.x << ", " << texel.y << ")\n";

    // What stands before the wall, three corners a triangle.
    const std::vector<glm::dvec3> pillar = {{0.2, -3, -2}, {0.6, -3, -2}, {0.6, 3, -2}};
    const Occluders occluders(pillar, projector.pose().position);

    // Cut so that texture coordinates that are linear on each piece are within half a texel of the formula.
    const ScenePainter painter(projector, {.tol = 0.5, .occluders = &occluders});
    const std::array<glm::dvec3, 3> wall = {{{-3, -2, -4}, {3, -2, -4}, {3, 2, -4}}};
    std::vector<PaintedTriangle> pieces;
    const PaintedCounts counts = painter.paint(wall, pieces);
    std::cout << counts.painted << " pieces painted, " << counts.hidden
              << " in the pillar's shadow, off by at most " << counts.max_error << " texels\n";

    // The same in the wall's own texture.
    const std::vector<float> panorama(std::size_t{2048} * 1024 * 3, 0.5f);
    const std::vector<BakedTriangle> mesh = {{wall, {{{0, 0}, {1, 0}, {1, 1}}}}};
    const BakedTexture texture = bake(mesh, {{projector, panorama.data(), &occluders}}, {.size = {256, 256}});
    std::cout << texture.painted << " texels baked, " << texture.unseen << " unseen\n";

    // And as a function of GLSL, once a fragment.
    const std::string shader =
        std::string(panorama_glsl_prelude()) + panorama_glsl(projector.panorama(), "findTexel");
    std::cout << "GLSL: " << (shader.find("bool findTexel(") != std::string::npos ? "bool findTexel" : "none")
              << "\n";
}
