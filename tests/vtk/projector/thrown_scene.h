// SPDX-License-Identifier: Apache-2.0
// A room that a panorama is thrown onto, seen by a camera in it, and what each of its pixels ought to receive: in long double,
// by the room's walls and the core's formulas, with nothing of OpenGL.
#pragma once

#include <vtkActor.h>
#include <vtkAnamorphPanoramaProjector.h>
#include <vtkAnamorphProjectionShader.h>
#include <vtkCamera.h>
#include <vtkCubeSource.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "anamorph/panorama/panorama.h"
#include "anamorph/projector/projector.h"

/// The colour of a pixel: red, green and blue.
using Colour = std::array<unsigned char, 3>;

inline vtkSmartPointer<vtkTexture> texture_of(int width, int height,
                                              const std::function<Colour(int, int)>& at) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            auto* to = static_cast<unsigned char*>(image->GetScalarPointer(i, height - 1 - j, 0));
            const Colour c = at(i, j);
            std::copy(c.begin(), c.end(), to);
        }
    const auto texture = vtkSmartPointer<vtkTexture>::New();
    texture->SetInputData(image);
    texture->MipmapOff();
    return texture;
}

/// The colour that stands for the place (i, j) of a panorama of up to 3840 x 3840 pixels.
inline Colour colour_of_place(int i, int j) {
    return {static_cast<unsigned char>(i % 256), static_cast<unsigned char>(j % 256),
            static_cast<unsigned char>(i / 256 + j / 256 * 16)};
}
inline std::array<int, 2> place_of_colour(const Colour& c) {
    return {c[0] + c[2] % 16 * 256, c[1] + c[2] / 16 * 256};
}
/// The colour that stands for no place of a panorama of up to 3840 x 3840 pixels.
inline constexpr Colour kNoPlace{255, 255, 255};

/// A camera in a room.
class Room {
  public:
    static constexpr int kWidth = 240, kHeight = 180;
    static constexpr double kHalf = 2, kViewAngle = 100;

    explicit Room(const glm::dvec3& middle = glm::dvec3(0.0)) : m_middle(middle) {
        cube->SetXLength(2 * kHalf);
        cube->SetYLength(2 * kHalf);
        cube->SetZLength(2 * kHalf);
        cube->SetCenter(middle.x, middle.y, middle.z);
        cube->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        mapper->SetInputConnection(cube->GetOutputPort());
        actor->SetMapper(mapper);
        actor->GetProperty()->LightingOff();
        renderer->AddActor(actor);
        renderer->SetBackground(1, 1, 1);
        window->SetMultiSamples(0);
        window->SetOffScreenRendering(1);
        window->SetSize(kWidth, kHeight);
        window->AddRenderer(renderer);
        look({0, 0, 0});
    }

    /// Puts the camera at a place beside the middle, and turns it.
    void look(const anamorph::Orientation& orientation, const glm::dvec3& from = {0.4, 0.3, 0.7}) {
        const glm::dmat3 r = anamorph::rotation(orientation);
        m_eye = m_middle + from;
        for (int k = 0; k < 3; ++k)
            m_axes[static_cast<std::size_t>(k)] = glm::dvec3(r[k].x, -r[k].y, -r[k].z);
        vtkCamera* camera = renderer->GetActiveCamera();
        const glm::dvec3 at = m_eye + m_axes[2];
        camera->SetPosition(m_eye.x, m_eye.y, m_eye.z);
        camera->SetFocalPoint(at.x, at.y, at.z);
        camera->SetViewUp(-m_axes[1].x, -m_axes[1].y, -m_axes[1].z);
        camera->SetViewAngle(kViewAngle);
        camera->SetClippingRange(0.01, 20);
    }

    /// Draws the window, in rows from the top.
    std::vector<Colour> picture() {
        window->Render();
        vtkNew<vtkUnsignedCharArray> pixels;
        window->GetPixelData(0, 0, kWidth - 1, kHeight - 1, 0, pixels);
        std::vector<Colour> colours;
        for (int j = 0; j < kHeight; ++j)
            for (int i = 0; i < kWidth; ++i) {
                const unsigned char* from = pixels->GetPointer(3 * ((kHeight - 1 - j) * kWidth + i));
                colours.push_back({from[0], from[1], from[2]});
            }
        return colours;
    }

    /// The ray to what a pixel shows, in a projector's frame.
    anamorph::Ray<long double> ray(const anamorph::Projector& projector, int i, int j) const {
        const std::array<long double, 3> point = seen(i, j).first;
        long double part[3] = {0, 0, 0};
        for (int k = 0; k < 3; ++k) {
            const long double to =
                point[static_cast<std::size_t>(k)] - static_cast<long double>(projector.pose().position[k]);
            for (int axis = 0; axis < 3; ++axis) part[axis] += to * projector.frame()[axis][k];
        }
        return {part[0], part[1], part[2]};
    }

    /// The point of a wall that a pixel shows, and the wall's normal.
    struct Wall {
        glm::dvec3 point, normal;
    };
    Wall wall(int i, int j) const {
        const auto& [point, k] = seen(i, j);
        Wall wall{{point[0], point[1], point[2]}, glm::dvec3(0.0)};
        wall.normal[k] = 1;
        return wall;
    }

    vtkNew<vtkCubeSource> cube;
    vtkNew<vtkPolyDataMapper> mapper;
    vtkNew<vtkActor> actor;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;

  private:
    /// The point of a wall that a pixel shows, and the axis that the wall is at right angles to.
    std::pair<std::array<long double, 3>, int> seen(int i, int j) const {
        const long double scale = 2 * std::tan(kViewAngle / 360 * std::numbers::pi_v<long double>) / kHeight;
        const long double x = (i + 0.5L - kWidth / 2) * scale, y = (j + 0.5L - kHeight / 2) * scale;
        std::array<long double, 3> way{};
        long double nearest = HUGE_VALL;
        int across = 0;
        for (int k = 0; k < 3; ++k) {
            const long double w = x * m_axes[0][k] + y * m_axes[1][k] + m_axes[2][k];
            const long double wall =
                (w > 0 ? kHalf : -kHalf) - (static_cast<long double>(m_eye[k]) - m_middle[k]);
            if (w != 0 && wall / w < nearest) {
                nearest = wall / w;
                across = k;
            }
            way[static_cast<std::size_t>(k)] = w;
        }
        for (int k = 0; k < 3; ++k) {
            long double& at = way[static_cast<std::size_t>(k)];
            at = m_eye[k] + nearest * at;
        }
        return {way, across};
    }

    glm::dvec3 m_middle, m_eye{0.0};
    std::array<glm::dvec3, 3> m_axes{};
};
