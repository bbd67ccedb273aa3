// SPDX-License-Identifier: Apache-2.0
// Surfaces before a camera, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/surface/drape.h"

namespace anamorph::test {

inline std::size_t number_of(const std::string& surface) {
    const auto& names = surface::surface_names();
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), surface) - names.begin());
}

/// A surface, and the camera that sees it.
struct Scene {
    std::string surface = "plane";
    surface::SurfaceShape shape = {};
    surface::CameraPose pose = {};
    Size screen = {160, 120};
    std::vector<Deformation> deformations = {};
    Size picture = {64, 64};
    std::shared_ptr<const surface::DrapedSurface> own = {};  ///< a surface in place of `surface`
};

/// Draws what a scene shows.
class Shown {
  public:
    explicit Shown(const Scene& scene, surface::DrapeOptions options = {})
        : m_scene(scene), m_options(options) {
        m_tree = std::make_shared<surface::SharedTree>(
            scene.own ? scene.own
                      : surface::make_surface(number_of(scene.surface), scene.shape, scene.deformations));
    }
    std::vector<float> values(Output output, surface::DrapeOutput own = surface::DrapeOutput::shared) {
        m_options.output = output;
        m_options.own = own;
        const int channels = own == surface::DrapeOutput::normal                              ? 3
                             : output == Output::stmap && own == surface::DrapeOutput::shared ? 2
                                                                                              : 1;
        return draw(nullptr, channels);
    }
    std::vector<float> seen() { return values(Output::color, surface::DrapeOutput::seen); }
    std::vector<float> coverage() { return values(Output::color, surface::DrapeOutput::coverage); }
    std::vector<float> draw(const Source* source, int channels, const Source* backdrop = nullptr) {
        const Size& s = m_scene.screen;
        std::vector<float> pixels(static_cast<std::size_t>(s.width * s.height * channels));
        const surface::Drape drape(m_tree, camera(), m_scene.picture, m_options);
        EXPECT_TRUE(drape.draw(source, {0, 0, s.width, s.height},
                               packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32,
                                           s.width, s.height, channels),
                               serial_for, backdrop));
        return pixels;
    }
    surface::Camera camera() const {
        return {m_scene.pose, glm::dmat3(1.0), glm::dvec3(0.0), m_scene.screen};
    }
    const std::shared_ptr<surface::SharedTree>& tree() const { return m_tree; }

  private:
    Scene m_scene;
    surface::DrapeOptions m_options;
    std::shared_ptr<surface::SharedTree> m_tree;
};

/// A picture of one colour.
class Plain {
  public:
    Plain(const Size& size, const std::vector<float>& color, int straight_alpha = -1) {
        for (int i = 0; i < size.width * size.height; ++i)
            m_texels.insert(m_texels.end(), color.begin(), color.end());
        m_source = std::make_unique<MemorySource>(
            packed_view(reinterpret_cast<const std::byte*>(m_texels.data()), PixelType::float32, size.width,
                        size.height, static_cast<int>(color.size())),
            straight_alpha);
    }
    const Source* source() const { return m_source.get(); }

  private:
    std::vector<float> m_texels;
    std::unique_ptr<MemorySource> m_source;
};

}  // namespace anamorph::test
