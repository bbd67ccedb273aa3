// SPDX-License-Identifier: Apache-2.0
// The shaders' text that throws panoramas.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/machine/bump_table.h"
#include "anamorph/machine/bump_unit.h"
#include "anamorph/projector/projection_groups.h"
#include "anamorph/projector/projector_rows.h"

class vtkAnamorphPanoramaProjector;
class vtkAnamorphProjectionShader;

namespace anamorph_vtk {

/// The facts that the text depends on: of a projector, all but its pose; and how it is thrown.
struct ThrownPanorama {
    anamorph::ThrownChart chart;
    int width = 0, height = 0;
    int components = 4;  ///< components of the texture as it was loaded
    double fade = 0;
    int circles = 1;  ///< panoramas one above the other
    double circle_radius = 1;
    bool mipmaps = false;  ///< of concentric mosaics: are there levels to read?
    std::string machine;
    int mode = 0, directions = 0, plane_size = 0, table_size = 0;
    int shadow_size = 0;  ///< 0: nothing is hidden
    int most_rows = 0;    ///< of the window's textures; 0: not known
    double vertical_reach = 1;

    bool operator==(const ThrownPanorama&) const = default;
};

/// The facts of a projector as it is, but for the texture's components. Throws Error where it has no picture.
ThrownPanorama thrown_by(vtkAnamorphPanoramaProjector& projector, vtkAnamorphProjectionShader& shader);

/// The pose of a projector as the core has it.
anamorph::ProjectorPose pose_of(vtkAnamorphPanoramaProjector& projector);

/// A panorama with what its mode needs.
struct PreparedPanorama {
    ThrownPanorama thrown;
    anamorph::Chart chart;  ///< of one panorama
    /// The groups of projection planes; none in mode direct. In mode residual, only those whose bound is good
    /// enough.
    std::vector<anamorph::ProjectionGroup> groups;
    anamorph::GroupOptions field;
    /// The machine of mode residual whose bump maps the tables are, and these, one for each group.
    std::optional<anamorph::machine::BumpUnit> machine;
    std::vector<anamorph::machine::BumpTable> bumps;
    double bump_error = 0;  ///< what bump maps add to the bound of tables, in texels

    /// Prepares a panorama. Throws Error.
    explicit PreparedPanorama(const ThrownPanorama& panorama);
    /// The proven bound in texels where residuals are read; of mode residual.
    double bound() const;

  private:
    void make_bumps();
};
using PreparedPanoramas = std::vector<std::shared_ptr<const PreparedPanorama>>;

/// The text that the tags of VTK's shaders become. A tag is kept in front, but for that of texture
/// coordinates.
struct ProjectionText {
    std::string vertex_declarations, vertex_code, geometry_declarations, geometry_code;
    std::string fragment_declarations, fragment_functions, fragment_code;
};

/// The shaders' text for panoramas. `rays`: of each, are shadows those of rays, else of a map? `hide`: are
/// fragments left out that receive nothing?
ProjectionText projection_text(const PreparedPanoramas& panoramas, const std::vector<bool>& rays, bool hide);

/// The fragment shader that draws a panorama on its projection planes, one above the other: colours times the
/// share of them that counts, and that share.
std::string plane_text(const PreparedPanorama& panorama);

/// The names in the text of a projector's uniforms: its texture, its table or planes, its shadows, and a
/// matrix and a vector that make a ray in its frame of gl_Position.
std::string texture_name(std::size_t projector);
std::string table_name(std::size_t projector);
std::string shadow_name(std::size_t projector);
std::string matrix_name(std::size_t projector);
std::string origin_name(std::size_t projector);
std::string away_name(std::size_t projector);
/// The name of the vector that says from where concentric mosaics are seen (mosaic_text.h).
std::string viewer_name(std::size_t projector);
/// The name of a matrix that turns such rays into the scene's axes.
std::string frame_name(std::size_t projector);

}  // namespace anamorph_vtk
