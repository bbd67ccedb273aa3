// SPDX-License-Identifier: Apache-2.0
#include "pane.h"

#include <vtkCellArray.h>
#include <vtkCullerCollection.h>
#include <vtkFloatArray.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkProperty2D.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>

#include "anamorph/parallel.h"

namespace anamorph_editor {

using anamorph::Box;
using anamorph::Size;

namespace {

constexpr double kZoomStep = 1.25, kLeastScale = 1e-3;
constexpr int kMostMagnified = 32;
constexpr unsigned char kBackground = 40;
constexpr std::array<double, 3> kEdge{0.1, 0.1, 0.1};
/// Pixels of the window around a picture that is shown whole.
constexpr int kMargin = 6;

Size scaled(const Size& size, double scale) {
    const auto side = [&](int n) { return std::max(1, static_cast<int>(std::lround(n * scale))); };
    return scale < 1 ? Size{side(size.width), side(size.height)} : size;
}

/// The scale that is one step larger or smaller: whole from 1 on, and 1 is none that is passed by.
double next_scale(double scale, bool larger) {
    if (scale > 1 || (scale == 1 && larger))
        return std::min<double>(kMostMagnified, scale + (larger ? 1 : -1));
    const double next = larger ? scale * kZoomStep : scale / kZoomStep;
    return larger && next > 1 ? 1 : std::max(next, kLeastScale);
}

}  // namespace

void Damage::add(const anamorph::Bounds& box) {
    m_box = {std::min(m_box.x0, box.x0), std::min(m_box.y0, box.y0), std::max(m_box.x1, box.x1),
             std::max(m_box.y1, box.y1)};
}

Box Damage::pixels(const Size& size) const {
    const Box whole{0, 0, size.width, size.height};
    if (m_all) return whole;
    if (this->is_empty()) return {};
    const auto edge = [](double at, int most) { return static_cast<int>(std::clamp<double>(at, 0, most)); };
    return {edge(std::floor(m_box.x0), size.width), edge(std::floor(m_box.y0), size.height),
            edge(std::ceil(m_box.x1), size.width), edge(std::ceil(m_box.y1), size.height)};
}

vtkStandardNewMacro(ClipToDamage);

int ClipToDamage::RenderOpaqueGeometry(vtkViewport* viewport) {
    auto* const window = vtkOpenGLRenderWindow::SafeDownCast(viewport->GetVTKWindow());
    if (!window) return 0;
    const int* const corner = viewport->GetOrigin();
    vtkOpenGLState* const state = window->GetState();
    state->vtkglScissor(corner[0] + m_pixels.x0, corner[1] + m_pixels.y0, m_pixels.width(),
                        m_pixels.height());
    constexpr float kGrey = kBackground / 255.0F;
    state->vtkglClearColor(kGrey, kGrey, kGrey, 1);
    state->vtkglDepthMask(GL_TRUE);
    state->vtkglClearDepth(1);
    state->vtkglClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    return 0;
}

Overlay::Overlay(vtkRenderer* renderer, Damage& damage, const std::array<double, 3>& color, float size)
    : m_damage(damage), m_reach(size / 2 + 2) {
    m_mapper->SetInputData(m_data);
    const auto add = [&](vtkActor2D* actor, const std::array<double, 3>& of, float wide) {
        actor->SetMapper(m_mapper);
        actor->GetProperty()->SetColor(of[0], of[1], of[2]);
        actor->GetProperty()->SetLineWidth(wide);
        actor->GetProperty()->SetPointSize(wide);
        renderer->AddActor2D(actor);
    };
    add(m_edge, kEdge, size + 2);
    add(m_actor, color, size);
    this->show(false);
}

void Overlay::damage(const Polyline& shape) {
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const Point<double>&p = shape[i], &q = shape[i > 0 ? i - 1 : 0];
        m_damage.add({std::min(p.x, q.x) - m_reach, std::min(p.y, q.y) - m_reach,
                      std::max(p.x, q.x) + m_reach, std::max(p.y, q.y) + m_reach});
    }
}

bool Overlay::take(const std::vector<Polyline>& shapes) {
    const auto is_same = [](const Polyline& a, const Polyline& b) {
        return std::equal(
            a.begin(), a.end(), b.begin(), b.end(),
            [](const Point<double>& p, const Point<double>& q) { return p.x == q.x && p.y == q.y; });
    };
    bool changes = false;
    const Polyline none;
    for (std::size_t i = 0; i < std::max(shapes.size(), m_shapes.size()); ++i) {
        const Polyline &before = i < m_shapes.size() ? m_shapes[i] : none,
                       &now = i < shapes.size() ? shapes[i] : none;
        if (is_same(before, now)) continue;
        changes = true;
        this->damage(before);
        this->damage(now);
    }
    if (changes) m_shapes = shapes;
    return changes;
}

void Overlay::show(bool visible) {
    m_edge->SetVisibility(visible);
    m_actor->SetVisibility(visible);
}

void Overlay::set_lines(const std::vector<Polyline>& lines) {
    if (!this->take(lines)) return;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const Polyline& line : lines) {
        cells->InsertNextCell(static_cast<int>(line.size()));
        for (const Point<double>& p : line) cells->InsertCellPoint(points->InsertNextPoint(p.x, p.y, 0));
    }
    m_data->SetPoints(points);
    m_data->SetLines(cells);
    this->show(!lines.empty());
}

void Overlay::set_points(const Polyline& at) {
    std::vector<Polyline> shapes;
    for (const Point<double>& p : at) shapes.push_back({p});
    if (!this->take(shapes)) return;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const Point<double>& p : at) {
        const vtkIdType id = points->InsertNextPoint(p.x, p.y, 0);
        cells->InsertNextCell(1, &id);
    }
    m_data->SetPoints(points);
    m_data->SetVerts(cells);
    this->show(!at.empty());
}

Pane::Pane(const std::array<double, 4>& viewport) {
    m_renderer->SetViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
    m_renderer->SetBackground(kBackground / 255.0, kBackground / 255.0, kBackground / 255.0);
    m_texture->SetInputData(m_image);
    m_texture->InterpolateOff();
    m_mapper->SetInputData(m_rectangle);
    m_actor->SetMapper(m_mapper);
    m_actor->SetTexture(m_texture);
    // It keeps what was drawn before, but for what m_clip clears, which comes first.
    m_renderer->EraseOff();
    m_renderer->GetCullers()->RemoveAllItems();
    m_renderer->AddViewProp(m_clip);
    m_renderer->AddActor2D(m_actor);
}

void Pane::set_picture(const Size& size) {
    m_picture = size;
    this->fit();
}

bool Pane::has(const std::array<int, 2>& display) {
    const int *corner = m_renderer->GetOrigin(), *size = m_renderer->GetSize();
    return display[0] >= corner[0] && display[1] >= corner[1] && display[0] < corner[0] + size[0] &&
           display[1] < corner[1] + size[1];
}

/// The centre of a pixel of the window, from the pane's upper left corner.
Point<double> Pane::to_pane(const std::array<int, 2>& display) {
    const int* corner = m_renderer->GetOrigin();
    return {display[0] - corner[0] + 0.5, m_size.height - 1 - (display[1] - corner[1]) + 0.5};
}

Point<double> Pane::to_picture(const std::array<int, 2>& display) {
    const Point<double> at = this->to_pane(display);
    return {(m_left + at.x / m_magnified) * m_picture.width / m_drawn.width,
            (m_top + at.y / m_magnified) * m_picture.height / m_drawn.height};
}

Point<double> Pane::to_renderer(const Point<double>& picture) const {
    return {(picture.x * m_drawn.width / m_picture.width - m_left) * m_magnified,
            m_size.height - (picture.y * m_drawn.height / m_picture.height - m_top) * m_magnified};
}

std::vector<Polyline> Pane::to_renderer(const std::vector<Polyline>& lines) const {
    std::vector<Polyline> out = lines;
    for (Polyline& line : out)
        for (Point<double>& p : line) p = this->to_renderer(p);
    return out;
}

void Pane::set_scale(double scale) {
    m_scale = scale;
    m_drawn = scaled(m_picture, scale);
    m_magnified = scale < 1 ? 1 : static_cast<int>(scale);
    m_stale = true;
}

void Pane::fit() {
    m_fits = true;
    m_stale = true;
    const double scale = std::min(double(m_size.width - 2 * kMargin) / m_picture.width,
                                  double(m_size.height - 2 * kMargin) / m_picture.height);
    this->set_scale(scale < 1 ? std::max(scale, kLeastScale)
                              : std::min<double>(std::floor(scale), kMostMagnified));
    m_left = -(m_size.width / m_magnified - m_drawn.width) / 2;
    m_top = -(m_size.height / m_magnified - m_drawn.height) / 2;
}

/// Some of the picture is always seen.
void Pane::keep_in_sight() {
    m_left = std::clamp(m_left, 1 - m_size.width / m_magnified, m_drawn.width - 1);
    m_top = std::clamp(m_top, 1 - m_size.height / m_magnified, m_drawn.height - 1);
    m_stale = true;
}

void Pane::zoom(const std::array<int, 2>& about, bool larger) {
    const Point<double> place = this->to_picture(about), at = this->to_pane(about);
    this->set_scale(next_scale(m_scale, larger));
    m_fits = false;
    m_left = static_cast<int>(std::lround(place.x * m_drawn.width / m_picture.width - at.x / m_magnified));
    m_top = static_cast<int>(std::lround(place.y * m_drawn.height / m_picture.height - at.y / m_magnified));
    this->keep_in_sight();
}

void Pane::pan(int right, int up) {
    m_fits = false;
    m_rest_right += right;
    m_rest_up += up;
    m_left -= m_rest_right / m_magnified;
    m_top += m_rest_up / m_magnified;
    m_rest_right %= m_magnified;
    m_rest_up %= m_magnified;
    this->keep_in_sight();
}

bool Pane::update() {
    const int* size = m_renderer->GetSize();
    const Size now{std::max(1, size[0]), std::max(1, size[1])};
    if (!(now == m_size)) {
        m_size = now;
        m_fits ? this->fit() : this->keep_in_sight();
    }
    if (!m_stale) return false;
    m_stale = false;
    m_damage.add_all();
    const auto seen = [&](int from, int side) { return from + (side + m_magnified - 1) / m_magnified; };
    m_pixels.box =
        anamorph::intersection({m_left, m_top, seen(m_left, m_size.width), seen(m_top, m_size.height)},
                               {0, 0, m_drawn.width, m_drawn.height});
    const Box& box = m_pixels.box;
    m_pixels.rgb.assign(
        box.empty() ? 0 : 3 * static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()),
        0);
    this->make_image();
    return true;
}

/// An image as large as the renderer, pixel for pixel; four channels, which a card takes as they are.
void Pane::make_image() {
    m_image->SetDimensions(m_size.width, m_size.height, 1);
    m_image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
    auto* to = static_cast<unsigned char*>(m_image->GetScalarPointer());
    for (vtkIdType i = m_image->GetNumberOfPoints(); i > 0; --i, to += 4) {
        std::fill_n(to, 3, kBackground);
        to[3] = 255;
    }
    m_image->Modified();
    vtkNew<vtkPoints> corners;
    vtkNew<vtkFloatArray> places;
    vtkNew<vtkCellArray> cells;
    places->SetNumberOfComponents(2);
    cells->InsertNextCell(4);
    for (const auto& [right, up] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        cells->InsertCellPoint(corners->InsertNextPoint(right * m_size.width, up * m_size.height, 0));
        places->InsertNextTuple2(right, up);
    }
    m_rectangle->SetPoints(corners);
    m_rectangle->SetPolys(cells);
    m_rectangle->GetPointData()->SetTCoords(places);
}

void Pane::show(const Box& of) {
    const Box box = anamorph::intersection(of, m_pixels.box);
    if (box.empty()) return;
    auto* const image = static_cast<unsigned char*>(m_image->GetScalarPointer());
    const Box pane = anamorph::intersection({(box.x0 - m_left) * m_magnified, (box.y0 - m_top) * m_magnified,
                                             (box.x1 - m_left) * m_magnified, (box.y1 - m_top) * m_magnified},
                                            {0, 0, m_size.width, m_size.height});
    anamorph::default_parallel_for()(std::max(pane.height(), 0), [&](std::int64_t down) {
        const int y = pane.y0 + static_cast<int>(down);
        unsigned char* to = image + 4 * (std::ptrdiff_t{m_size.height - 1 - y} * m_size.width + pane.x0);
        const int row = m_top + y / m_magnified;
        for (int x = pane.x0; x < pane.x1; ++x, to += 4)
            std::copy_n(m_pixels.at(m_left + x / m_magnified, row), 3, to);
    });
    m_image->Modified();
    this->damage(of);
}

void Pane::damage(const Box& drawn) {
    const double left = (drawn.x0 - m_left) * m_magnified, right = (drawn.x1 - m_left) * m_magnified,
                 top = (drawn.y0 - m_top) * m_magnified, bottom = (drawn.y1 - m_top) * m_magnified;
    m_damage.add({left, m_size.height - bottom, right, m_size.height - top});
}

Box Pane::draw_damage() {
    const Box pixels = m_damage.pixels(m_size);
    m_renderer->SetDraw(!m_damage.is_empty());
    m_clip->set(pixels);
    m_damage.clear();
    return pixels;
}

}  // namespace anamorph_editor
