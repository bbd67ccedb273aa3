// SPDX-License-Identifier: Apache-2.0
// A view of a panorama drawn by the graphics card (Kim 2003, section 4.5): a rectangle that covers the window, and receives
// what a projector in the camera's place throws.
//
// Per fragment, every pixel evaluates the panorama's formula. Per vertex, as in section 4.5.1: the direction of projection
// is the level part of where the view looks; the rectangle's corners, projected onto the plane across it, are a trapezoid, on
// which texture coordinates are linear: those of the projection's linear part, and those of the table of what is left of it.
//
// Concentric mosaics are drawn per fragment: each mixes the columns of the two circles beside its line of sight.
#pragma once

#include <vtkActor.h>
#include <vtkAnamorphPanoramaProjector.h>
#include <vtkAnamorphProjectionShader.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkTexture.h>

#include <array>
#include <optional>

#include "anamorph/projector/projection_groups.h"
#include "viewed_panorama.h"

class vtkRenderer;

namespace anamorph_viewer {

class CardView {
  public:
    /// The largest bound in texels of a table that is read.
    static constexpr double kMostError = 0.25;

    /// Prepares the drawing of a panorama. Throws Error where a card cannot draw it.
    explicit CardView(const ViewedPanorama& panorama);

    vtkActor* actor() { return m_actor; }
    /// Turns the camera of a renderer, and draws a view of it; `gain` as shown() has it. Returns whether it is drawn per vertex:
    /// where that is asked for, but there is no trapezoid or no bound, it is drawn per fragment.
    /// `viewpoint`: that of mosaics.
    bool look(const View& view, const anamorph::Size& size, bool per_vertex, double gain,
              vtkRenderer* renderer, const glm::dvec2& viewpoint = glm::dvec2(0.0));
    /// The largest error of the texel of any pixel of the last view, in texels of the image that is thrown:
    /// that of tables, 0 per fragment.
    double bound() const { return m_bound; }
    const anamorph::Chart& chart() const { return m_chart; }

  private:
    using Corners = std::array<glm::dvec3, 4>;

    CardView(const CardPicture& picture, bool hdr);

    void set_picture(const CardPicture& picture);
    bool set_trapezoid(const Corners& rays, const glm::dvec3& ahead);
    void set_rectangle(const Corners& rays);
    void set_corners(const Corners& points, const std::array<std::array<double, 4>, 4>& places);
    const anamorph::ProjectionGroup& group_of(double azimuth, const anamorph::GroupOptions& field);
    void set_residuals();
    void be_per_vertex(bool per_vertex);
    void be_of_circles();
    void map_places(const std::string& functions, const std::string& code);
    void set_gain(double gain);

    anamorph::Chart m_chart;
    glm::dmat3 m_held;  ///< the turn from the panorama's frame of rays to that of views
    bool m_hdr;
    std::optional<anamorph::ConcentricStack> m_stack;
    double m_bound = 0;
    std::optional<bool> m_per_vertex;
    anamorph::GroupOptions m_field;
    double m_azimuth = 0;
    std::optional<anamorph::ProjectionGroup> m_group;

    vtkNew<vtkActor> m_actor;
    vtkNew<vtkPolyDataMapper> m_mapper;
    vtkNew<vtkPolyData> m_mesh;
    vtkNew<vtkTexture> m_texture, m_residuals;
    vtkNew<vtkAnamorphPanoramaProjector> m_projector;
    vtkNew<vtkAnamorphProjectionShader> m_shader;
};

}  // namespace anamorph_viewer
