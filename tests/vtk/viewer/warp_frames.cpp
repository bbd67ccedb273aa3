// SPDX-License-Identifier: Apache-2.0
// Frames a second of anamorph-warp while points are dragged: warp_frames RECIPE [FRAMES [fragments]]. Of a .morph, the first point of its
// first line. Each frame is an event of the mouse, and ends when the window shows what it did. Three times: without OpenGL, which leaves
// all that is not the graphics card's; with it; and, of a window of VTK that has nothing to show, what is left when ours is taken away.
#include <morph_window.h>
#include <sys/resource.h>
#include <vtkCommand.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <warp_window.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

namespace {

using anamorph_editor::EditWindow;

double processor_seconds() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void report(const std::string& what, int frames, double seconds, double processor) {
    std::printf("%s: %.1f frames a second, %.1f ms a frame, %.1f ms of processor time\n", what.c_str(),
                frames / seconds, 1e3 * seconds / frames, 1e3 * processor / frames);
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
        if (!with_opengl) window.window()->InvokeEvent(vtkCommand::StartEvent);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report(std::string(what) + (with_opengl ? ", with OpenGL" : ", without"), frames, seconds,
           processor_seconds() - processor);
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

constexpr int kWidth = 1600, kHeight = 860;

/// A window of VTK of the same size with nothing to show.
void measure_nothing(int frames) {
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
    window->SetMultiSamples(0);
    window->SetSize(kWidth, kHeight);
    window->AddRenderer(renderer);
    window->Render();
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < frames; ++i) window->Render();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report("a window with nothing to show", frames, seconds, processor_seconds() - processor);
}

void prepare(EditWindow& window, bool by_fragments) {
    window.draw_by_fragments(by_fragments);
    window.window()->SetSize(kWidth, kHeight);
    window.window()->Render();
    window.interactor()->Initialize();
}

void measure_warp(const std::string& recipe, int frames, bool by_fragments) {
    anamorph_editor::WarpWindow window(recipe);
    prepare(window, by_fragments);
    const auto at = middle_point(window);
    for (const bool with_opengl : {false, true}) {
        measure("one point", window, at.x, at.y, frames, with_opengl);
        event(window, vtkCommand::KeyPressEvent, at.x, at.y, "a");
        measure("all points", window, at.x, at.y, frames, with_opengl);
        event(window, vtkCommand::KeyPressEvent, at.x, at.y, "Escape");
    }
}

void measure_morph(const std::string& recipe, int frames, bool by_fragments) {
    anamorph_editor::MorphWindow window(recipe);
    prepare(window, by_fragments);
    anamorph_editor::Pane& pane = window.pane(0);
    const auto at = pane.to_renderer(window.editor().at({0, 0, 0}));
    const int* corner = pane.renderer()->GetOrigin();
    for (const bool with_opengl : {false, true})
        measure("one point", window, at.x + corner[0], at.y + corner[1], frames, with_opengl);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string recipe = argc > 1 ? argv[1] : "--help";
    if (recipe.starts_with("-")) {
        std::puts("warp_frames RECIPE [FRAMES [fragments]]");
        return recipe == "--help" && argc > 1 ? 0 : 1;
    }
    const int frames = argc > 2 ? std::atoi(argv[2]) : 200;
    const bool by_fragments = argc > 3 && std::string(argv[3]) == "fragments";
    try {
        if (recipe.find(".morph") != std::string::npos)
            measure_morph(recipe, frames, by_fragments);
        else
            measure_warp(recipe, frames, by_fragments);
        measure_nothing(frames);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "warp_frames: %s\n", error.what());
        return 1;
    }
}
