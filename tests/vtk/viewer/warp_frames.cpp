// SPDX-License-Identifier: Apache-2.0
// Frames a second of anamorph-warp while points are dragged: warp_frames RECIPE [FRAMES]. Of a .morph, the first point of its first line. Each frame is an event of the mouse, and ends
// when the window shows what it did. Twice: with OpenGL, and without, which leaves all that is not the graphics card's.
#include <morph_window.h>
#include <sys/resource.h>
#include <vtkCommand.h>
#include <warp_window.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using anamorph_editor::EditWindow;

double processor_seconds() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void event(EditWindow& window, unsigned long id, double x, double y, const char* key = nullptr) {
    window.interactor()->SetEventInformation(int(x), int(y), 0, 0, 0, 0, key);
    window.interactor()->InvokeEvent(id);
}

/// Drags what is at a place of the window around in a circle.
void measure(const char* what, EditWindow& window, double x, double y, int frames, bool with_opengl) {
    event(window, vtkCommand::LeftButtonPressEvent, x, y);
    window.interactor()->SetEnableRender(with_opengl);
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    for (int i = 1; i <= frames; ++i) {
        const double turn = 2 * M_PI * i / 40;
        event(window, vtkCommand::MouseMoveEvent, x + 25 * std::sin(turn), y + 25 * std::cos(turn));
        if (!with_opengl) window.pane(0).renderer()->InvokeEvent(vtkCommand::StartEvent);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%s, %s OpenGL: %.1f frames a second, %.1f ms of processor time a frame\n", what,
                with_opengl ? "with" : "without", frames / seconds,
                1e3 * (processor_seconds() - processor) / frames);
    window.interactor()->SetEnableRender(true);
    event(window, vtkCommand::KeyPressEvent, x, y, "Escape");
}

/// Where the point is that lies nearest to a pane's middle.
anamorph::Point<double> middle_point(anamorph_editor::WarpWindow& window) {
    anamorph_editor::Pane& pane = window.pane(window.edited_pane());
    const int *corner = pane.renderer()->GetOrigin(), *size = pane.renderer()->GetSize();
    anamorph::Point<double> at{0, 0};
    double nearest = HUGE_VAL;
    for (const auto& point : window.editor().points()) {
        const anamorph::Point<double> p = pane.to_renderer(point.at);
        const double far = std::hypot(p.x - size[0] / 2, p.y - size[1] / 2);
        if (point.is_fixed || far > nearest) continue;
        nearest = far;
        at = {p.x + corner[0], p.y + corner[1]};
    }
    return at;
}

void prepare(EditWindow& window) {
    window.window()->SetSize(1600, 860);
    window.window()->Render();
    window.interactor()->Initialize();
}

void measure_warp(const char* recipe, int frames) {
    anamorph_editor::WarpWindow window(recipe);
    prepare(window);
    const auto at = middle_point(window);
    for (const bool with_opengl : {false, true}) {
        measure("one point", window, at.x, at.y, frames, with_opengl);
        event(window, vtkCommand::KeyPressEvent, at.x, at.y, "a");
        measure("all points", window, at.x, at.y, frames, with_opengl);
        event(window, vtkCommand::KeyPressEvent, at.x, at.y, "Escape");
    }
}

void measure_morph(const char* recipe, int frames) {
    anamorph_editor::MorphWindow window(recipe);
    prepare(window);
    anamorph_editor::Pane& pane = window.pane(0);
    const auto at = pane.to_renderer(window.editor().at({0, 0, 0}));
    const int* corner = pane.renderer()->GetOrigin();
    for (const bool with_opengl : {false, true})
        measure("one point", window, at.x + corner[0], at.y + corner[1], frames, with_opengl);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 1;
    const int frames = argc > 2 ? std::atoi(argv[2]) : 200;
    std::string(argv[1]).find(".morph") != std::string::npos ? measure_morph(argv[1], frames)
                                                             : measure_warp(argv[1], frames);
}
