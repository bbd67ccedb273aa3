// SPDX-License-Identifier: Apache-2.0
// A part of a window that shows a picture, smaller or larger, and lines and points over it.
//
// Frames. "Picture" is pixels of the whole picture in its own size; "drawn" pixels of the size that it is drawn in, which is the
// same where the pane magnifies (each pixel is then a square of several), else smaller; "display" pixels of the window, y up from
// its lower edge, as VTK's events have them.
#pragma once

#include <vtkActor2D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProp.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkTexturedActor2D.h>

#include <array>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/bounds_tree.h"
#include "drawn_recipe.h"

namespace anamorph_editor {

using anamorph::Point;
using Polyline = std::vector<Point<double>>;

/// What of a renderer is to be drawn again, in its pixels from its lower left corner.
class Damage {
  public:
    void add_all() { m_all = true; }
    void add(const anamorph::Bounds& box);
    bool is_empty() const { return !m_all && !(m_box.x0 < m_box.x1 && m_box.y0 < m_box.y1); }
    /// The pixels that it touches of a renderer of this size.
    anamorph::Box pixels(const anamorph::Size& size) const;
    void clear() { *this = {}; }

  private:
    bool m_all = false;
    anamorph::Bounds m_box{1e300, 1e300, -1e300, -1e300};
};

/// Confines what a renderer draws after it to a box of its pixels, which it clears.
class ClipToDamage : public vtkProp {
  public:
    static ClipToDamage* New();
    vtkTypeMacro(ClipToDamage, vtkProp);
    void set(const anamorph::Box& pixels) { m_pixels = pixels; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override;

  private:
    anamorph::Box m_pixels;
};

/// Lines or points of one colour on a dark edge, in pixels of a renderer from its lower left corner.
class Overlay {
  public:
    /// `size`: the width of lines and points, in pixels. `damage`: of the renderer, to which is added what changes.
    Overlay(vtkRenderer* renderer, Damage& damage, const std::array<double, 3>& color, float size);
    void set_lines(const std::vector<Polyline>& lines);
    void set_points(const Polyline& points);

  private:
    /// Takes other lines or points than before. False where they are the same.
    bool take(const std::vector<Polyline>& shapes);
    void damage(const Polyline& shape);
    void show(bool visible);

    Damage& m_damage;
    float m_reach;  ///< how far it reaches beyond its points
    std::vector<Polyline> m_shapes;
    vtkNew<vtkPolyData> m_data;
    vtkNew<vtkPolyDataMapper2D> m_mapper;
    vtkNew<vtkActor2D> m_edge, m_actor;
};

class Pane {
  public:
    /// `viewport`: its left, lower, right and upper edge, 0 to 1 of the window.
    explicit Pane(const std::array<double, 4>& viewport);
    Pane(const Pane&) = delete;
    Pane& operator=(const Pane&) = delete;

    vtkRenderer* renderer() { return m_renderer; }
    /// The size of the picture. It is shown whole at first.
    void set_picture(const anamorph::Size& size);

    bool has(const std::array<int, 2>& display);
    Point<double> to_picture(const std::array<int, 2>& display);
    /// Where in the renderer a position of the picture is, for overlays.
    Point<double> to_renderer(const Point<double>& picture) const;
    std::vector<Polyline> to_renderer(const std::vector<Polyline>& lines) const;
    /// Pixels of the picture that a pixel of the window is wide.
    double pixel() const { return double(m_picture.width) / (m_drawn.width * m_magnified); }

    /// Shows the picture larger or smaller about a place, which stays where it is: by one step up or down.
    void zoom(const std::array<int, 2>& about, bool larger);
    /// Moves the picture by pixels of the window.
    void pan(int right, int up);
    void fit();

    /// Takes the renderer's size as it is now. Returns whether other pixels than before are to be drawn: pixels() are then new.
    bool update();
    const anamorph::Size& picture() const { return m_picture; }
    anamorph::Size drawn_size() const { return m_drawn; }
    /// The drawn pixels that are seen.
    ScreenPixels& pixels() { return m_pixels; }
    /// Takes over pixels() of a box of them.
    void show(const anamorph::Box& box);
    /// What is to be drawn again, of the renderer and of a box of drawn pixels.
    Damage& damage() { return m_damage; }
    void damage(const anamorph::Box& drawn);
    /// Has the renderer draw what is damaged, which it is no more then, or nothing. Returns the pixels of the renderer that it draws.
    anamorph::Box draw_damage();
    /// Shows them, or leaves the pane to others.
    void show_pixels(bool visible) { m_actor->SetVisibility(visible); }
    /// The drawn pixel in the pane's upper left corner, and pixels of the window that each is wide.
    std::array<int, 2> first_pixel() const { return {m_left, m_top}; }
    int magnified() const { return m_magnified; }

  private:
    Point<double> to_pane(const std::array<int, 2>& display);
    void set_scale(double scale);
    void keep_in_sight();
    void make_image();

    anamorph::Size m_picture{1, 1}, m_drawn{1, 1}, m_size;
    double m_scale = 1;
    int m_magnified = 1;
    bool m_fits = true, m_stale = true;
    int m_left = 0, m_top = 0;  ///< the drawn pixel in the pane's upper left corner
    int m_rest_right = 0,
        m_rest_up = 0;  ///< pixels of the window by which it is to be moved still, fewer than one drawn
    ScreenPixels m_pixels;
    Damage m_damage;
    vtkNew<ClipToDamage> m_clip;
    vtkNew<vtkRenderer> m_renderer;
    vtkNew<vtkImageData> m_image;
    vtkNew<vtkPolyData> m_rectangle;
    vtkNew<vtkPolyDataMapper2D> m_mapper;
    vtkNew<vtkTexture> m_texture;
    vtkNew<vtkTexturedActor2D> m_actor;
};

}  // namespace anamorph_editor
