// SPDX-License-Identifier: Apache-2.0
// A figure of two ellipsoids that nods: performed, outlined, drawn.
#include <anamorph/figure.h>

#include <iostream>
#include <span>
#include <vector>

using namespace anamorph::figure;

int main() {
    const char* text = R"(
        figure doll 2 body head
        ellipsoid body 100 200 60
        ellipsoid head 60 70 60
        joint neck body 0 180 0 head 0 -60 0
        view 1 10
        linear 0 10 bendby head neck body 40 x
        linear 0 1 moveto doll body 500 300 500
        stop
    )";
    const Script script = parse_script(text, "doll.n");
    for (const Diagnostic& diagnostic : script.diagnostics) std::cout << diagnostic.text() << "\n";
    if (!script.ok()) return 1;

    Performance performance(script.program);
    const FigureFrame frame = performance.frame(10);
    std::cout << frame.bodies.size() << " bodies, " << frame.joints.size() << " joint\n";

    // In outline, hidden lines removed.
    const View view = view_in(frame, {400, 400});
    const Outlines seen = outlines(frame, view);
    for (std::size_t i = 0; i < seen.bodies.size(); ++i)
        std::cout << frame.bodies[i].name << ": " << seen.bodies[i].visible.size() << " visible arcs, "
                  << seen.bodies[i].hidden.size() << " hidden\n";

    // And as pixels: red, green, blue, alpha.
    const FigurePicture picture(frame, view, {400, 400}, {});
    std::vector<float> pixels(std::size_t{400} * 400 * 4);
    picture.draw({0, 0, 400, 400}, anamorph::packed_view(std::as_writable_bytes(std::span(pixels)).data(),
                                                         anamorph::PixelType::float32, 400, 400, 4));
    double covered = 0;
    for (std::size_t i = 3; i < pixels.size(); i += 4) covered += pixels[i];
    std::cout << "covers " << int(covered) << " pixels\n";
}
