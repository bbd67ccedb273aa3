// SPDX-License-Identifier: Apache-2.0
// The picture of a pane drawn by the graphics card, fragment by fragment: each evaluates the warp's Hermite patch (mesh/mesh_glsl.h)
// or the morph's sum over lines (morph/feature_glsl.h), and reads the images there.
//
// Filters nearest and bilinear are computed as the core has them; those that average read the card's own levels of detail.
#pragma once

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkTexture.h>

#include <array>
#include <string>
#include <vector>

#include "anamorph/image/border.h"
#include "anamorph/image/filter.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/morph/feature_lines.h"
#include "drawn_recipe.h"
#include "pane.h"

namespace anamorph_editor {

class FragmentPicture {
  public:
    /// Loads the images of a recipe, one of a warp and two of a morph, to be drawn in a pane. Throws Error where a card does not draw it:
    /// in another colour space, by another filter, or another output than colour.
    FragmentPicture(Pane& pane, const DrawnRecipe& recipe);
    ~FragmentPicture();
    FragmentPicture(const FragmentPicture&) = delete;
    FragmentPicture& operator=(const FragmentPicture&) = delete;

    void show(bool visible) { m_actor->SetVisibility(visible); }
    /// Draws a mesh that lies in the picture in the size that the pane draws it in. Throws Error where it has too many cells.
    void draw(const anamorph::Mesh& mesh);
    /// Draws a morph of two shapes, whose colours are mixed by `second`, the share of the second. `is_quick`: with a bound that is found in
    /// a millisecond or so, and may be much larger. Throws Error where it has too many lines.
    void draw(const anamorph::FeatureMap& map, double second, bool is_quick);
    /// How far the source point of any pixel was off at most in the last drawing, by what floats do, in source pixels.
    double bound() const { return m_bound; }

  private:
    void load(const DrawnRecipe& recipe);
    /// Replaces the shaders where they are others than before.
    void set_shaders(const std::string& vertex_declarations, const std::string& vertex_code,
                     const std::string& fragment_declarations, const std::string& functions,
                     const std::string& code);
    void set_frame();
    /// Rectangles of drawn pixels, with `components` numbers for each of the arrays, of each rectangle in turn.
    struct Rectangles {
        std::vector<anamorph::Box> boxes;
        std::vector<std::pair<std::string, std::vector<std::array<float, 4>>>> arrays;
    };
    void set_rectangles(const Rectangles& rectangles);

    Pane& m_pane;
    anamorph::Filter m_filter;
    anamorph::Wrap m_wrap;
    std::vector<anamorph::Size> m_images, m_texels;
    double m_bound = 0;
    std::string m_shaders;
    vtkNew<vtkActor> m_actor;
    vtkNew<vtkPolyDataMapper> m_mapper;
    vtkNew<vtkPolyData> m_data;
    std::array<vtkNew<vtkTexture>, 2> m_textures;
};

}  // namespace anamorph_editor
