// SPDX-License-Identifier: Apache-2.0
// Frames a second of anamorph-warp while a point is dragged: warp_frames RECIPE [FRAMES]. Each frame is an event of the mouse, and ends when
// the window shows what it did.
#include <sys/resource.h>
#include <vtkActor2DCollection.h>
#include <vtkActor2D.h>
#include <vtkCommand.h>
#include <warp_window.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

double processor_seconds() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void event(anamorph_editor::EditWindow& window, unsigned long id, double x, double y) {
    window.interactor()->SetEventInformation(int(x), int(y));
    window.interactor()->InvokeEvent(id);
}

/// Drags what is in the middle of a pane around in a circle.
void measure(anamorph_editor::EditWindow& window, double x, double y, int frames) {
    event(window, vtkCommand::LeftButtonPressEvent, x, y);
    double drawing = 0;
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    for (int i = 1; i <= frames; ++i) {
        const double turn = 2 * M_PI * i / 40;
        event(window, vtkCommand::MouseMoveEvent, x + 25 * std::sin(turn), y + 25 * std::cos(turn));
        drawing += window.milliseconds();
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf(
        "%.1f frames a second; a frame: %.1f ms, %.1f ms of processor time, %.2f ms of it drawing the "
        "picture\n",
        frames / seconds, 1e3 * seconds / frames, 1e3 * (processor_seconds() - processor) / frames,
        drawing / frames);
    event(window, vtkCommand::LeftButtonReleaseEvent, x, y);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 1;
    anamorph_editor::WarpWindow window(argv[1]);
    window.window()->SetSize(1600, 860); if (getenv("OFF")) window.window()->OffScreenRenderingOn();
    window.window()->Render();
    window.interactor()->Initialize();
    // The point nearest to the middle, and then all points.
    anamorph_editor::Pane& pane = window.pane(window.edited_pane());
    const int* corner = pane.renderer()->GetOrigin();
    anamorph::Point<double> at{-1, -1};
    double nearest = 1e9;
    for (const auto& point : window.editor().points()) {
        const auto p = pane.to_renderer(point.at);
        const double far = std::hypot(p.x - 400, p.y - 400);
        if (point.is_fixed || far > nearest) continue;
        nearest = far;
        at = p;
    }
    if (getenv("NOMESH")) { window.interactor()->SetEventInformation(0,0,0,0,0,0,"g"); window.interactor()->InvokeEvent(vtkCommand::KeyPressEvent); }
    if (getenv("NOIMG")) for (int i : {0, 1}) { auto* as = window.pane(i).renderer()->GetActors2D(); as->InitTraversal(); as->GetNextActor2D()->VisibilityOff(); }
    if (getenv("RENDER")) { auto t=std::chrono::steady_clock::now(); double c=processor_seconds(); for(int i=0;i<50;i++) window.window()->Render(); std::printf("pure render %.1f ms, cpu %.1f\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count()*20, (processor_seconds()-c)*20);}
    const int frames = argc > 2 ? std::atoi(argv[2]) : 200;
    std::printf("one point: ");
    measure(window, at.x + corner[0], at.y + corner[1], frames);
    window.interactor()->SetEventInformation(int(at.x) + corner[0], int(at.y) + corner[1], 0, 0, 0, 0, "a");
    window.interactor()->InvokeEvent(vtkCommand::KeyPressEvent);
    std::printf("all points: ");
    measure(window, at.x + corner[0], at.y + corner[1], frames);
    return window.error().empty() ? 0 : 1;
}
