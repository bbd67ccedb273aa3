// SPDX-License-Identifier: Apache-2.0
#include "panorama_viewer.h"

#include <vtkCommand.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace anamorph_viewer {
namespace {

constexpr double kExposureStep = 0.5, kMostExposure = 32;
/// Radii of the outer circle.
constexpr double kMove = 0.05;

}  // namespace

Drawing drawing_from_name(const std::string& name) {
    if (name == "picture") return Drawing::picture;
    if (name == "fragments") return Drawing::fragments;
    if (name == "vertices") return Drawing::vertices;
    throw anamorph::Error("draw", name, "must be picture, fragments or vertices");
}

PanoramaViewer::PanoramaViewer(anamorph::Tour tour, const std::string& folder,
                               const std::vector<anamorph::Assignment>& options)
    : m_tour(std::move(tour)), m_folder(folder), m_options(options), m_panorama(this->opened(0)) {
    m_mapper->SetInputData(m_image);
    m_mapper->SetColorWindow(255);
    m_mapper->SetColorLevel(127.5);
    m_actor->SetMapper(m_mapper);
    m_renderer->AddActor2D(m_actor);
    m_window->AddRenderer(m_renderer);
    m_window->SetMultiSamples(0);
    m_window->SetWindowName("anamorph-view");
    m_style->MoveCameraOff();
    m_style->SetDefaultRenderer(m_renderer);
    m_interactor->SetRenderWindow(m_window);
    m_interactor->SetInteractorStyle(m_style);
    m_observer->SetCallback(&PanoramaViewer::handle);
    m_observer->SetClientData(this);
    m_style->AddObserver(vtkCommand::InteractionEvent, m_observer);
    m_renderer->AddObserver(vtkCommand::StartEvent, m_observer);
    m_style->AddObserver(vtkCommand::PickEvent, m_observer);
    m_interactor->AddObserver(vtkCommand::MouseMoveEvent, m_observer);
    m_interactor->AddObserver(vtkCommand::KeyPressEvent, m_observer);
    this->go_to(0, {});
}

PanoramaViewer::~PanoramaViewer() {
    m_interactor->RemoveObserver(m_observer);
    m_style->RemoveObserver(m_observer);
    m_renderer->RemoveObserver(m_observer);
}

std::unique_ptr<ViewedPanorama> PanoramaViewer::opened(std::size_t place) const {
    const anamorph::TourPanorama& of = m_tour[place];
    std::vector<anamorph::Assignment> options = m_options;
    for (const anamorph::Assignment& own : anamorph::parse_recipe_name("?" + of.options).assignments) {
        std::erase_if(options, [&](const anamorph::Assignment& a) { return a.key == own.key; });
        options.push_back(own);
    }
    return std::make_unique<ViewedPanorama>((std::filesystem::path(m_folder) / of.file).string(), options);
}

View PanoramaViewer::view() const {
    return {m_style->GetYaw(), m_style->GetPitch(), m_style->GetFieldOfView()};
}

void PanoramaViewer::look(const View& view) {
    m_style->SetYaw(view.yaw);
    m_style->SetPitch(view.pitch);
    m_style->SetFieldOfView(view.fov);
    m_stale = true;
}

void PanoramaViewer::set_exposure(double stops) {
    m_exposure = std::clamp(stops, -kMostExposure, kMostExposure);
    m_stale = true;
}

void PanoramaViewer::forget_card() {
    if (m_card) m_renderer->RemoveActor(m_card->actor());
    m_card.reset();
}

bool PanoramaViewer::go_to(std::size_t place, const anamorph::TourView& view) {
    try {
        if (place != m_place) {
            m_panorama = this->opened(place);
            this->forget_card();
        }
    } catch (const std::exception& e) {
        m_error = anamorph::message_of(e, "the panorama");
        return false;
    }
    m_place = place;
    const anamorph::TourView& own = m_tour[place].view;
    const View now = this->view();
    const auto of = [](const std::optional<double>& first, const std::optional<double>& second, double rest) {
        return first ? *first : second.value_or(rest);
    };
    this->look({of(view.yaw, own.yaw, now.yaw), of(view.pitch, own.pitch, now.pitch),
                of(view.fov, own.fov, now.fov)});
    return true;
}

void PanoramaViewer::set_drawing(Drawing drawing) {
    if (drawing == m_drawing) return;
    m_drawing = drawing;
    m_stale = true;
}

void PanoramaViewer::update() {
    const int* pixels = m_renderer->GetSize();
    const anamorph::Size size{std::max(1, pixels[0]), std::max(1, pixels[1])};
    if (!m_stale && size == m_drawn) return;
    m_stale = false;
    m_drawn = size;
    try {
        if (m_drawing == Drawing::picture)
            this->draw_picture(size);
        else
            this->draw_by_card(size);
        m_error.clear();
    } catch (const std::exception& e) {
        m_error = anamorph::message_of(e, "the view");
    }
}

void PanoramaViewer::draw_picture(const anamorph::Size& size) {
    this->let_card_draw(false);
    m_image->SetDimensions(size.width, size.height, 1);
    m_image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    m_image->Modified();
    auto* const to = static_cast<unsigned char*>(m_image->GetScalarPointer());
    std::fill_n(to, std::size_t{3} * static_cast<std::size_t>(size.width * size.height), 0);
    const std::vector<float> drawn = m_panorama->draw(this->view(), size);
    const int channels = m_panorama->channels();
    const double gain = std::exp2(m_exposure);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const float* from = &drawn[static_cast<std::size_t>((y * size.width + x) * channels)];
            unsigned char* pixel = to + std::ptrdiff_t{(size.height - 1 - y) * size.width + x} * 3;
            for (int c = 0; c < 3; ++c)
                pixel[c] = shown(from[channels < 3 ? 0 : c], m_panorama->is_hdr(), gain);
        }
}

void PanoramaViewer::draw_by_card(const anamorph::Size& size) {
    if (!m_card) {
        m_actor->VisibilityOff();
        m_card = std::make_unique<CardView>(*m_panorama);
    }
    this->let_card_draw(true);
    m_by_vertices = m_card->look(this->view(), size, m_drawing == Drawing::vertices, std::exp2(m_exposure),
                                 m_renderer, m_panorama->viewpoint());
}

/// What it has is kept for the next time.
void PanoramaViewer::let_card_draw(bool does) {
    m_actor->SetVisibility(!does);
    if (!m_card) return;
    m_card->actor()->SetVisibility(does);
    m_renderer->AddActor(m_card->actor());
}

std::optional<anamorph::HotSpot> PanoramaViewer::spot_at_mouse() {
    const int* at = m_interactor->GetEventPosition();
    const int* size = m_renderer->GetSize();
    if (m_tour[m_place].spots.empty() || size[0] < 1 || size[1] < 1) return {};
    const Direction d =
        m_panorama->direction(this->view(), {size[0], size[1]}, at[0] + 0.5, size[1] - 1 - at[1] + 0.5);
    const int spot = m_tour[m_place].spot_at(d.yaw, d.pitch);
    if (spot < 0) return {};
    return m_tour[m_place].spots[static_cast<std::size_t>(spot)];
}

void PanoramaViewer::pick() {
    const std::optional<anamorph::HotSpot> spot = this->spot_at_mouse();
    if (!spot) return;
    if (!this->go_to(spot->target, spot->view)) vtkGenericWarningMacro(<< m_error);
    m_interactor->Render();
}

void PanoramaViewer::show_cursor() {
    m_window->SetCurrentCursor(this->spot_at_mouse() ? VTK_CURSOR_HAND : VTK_CURSOR_DEFAULT);
}

void PanoramaViewer::key() {
    const char* name = m_interactor->GetKeySym();
    if (!name) return;
    const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
    const double yaw = m_style->GetYaw() * std::acos(-1.0) / 180;
    const auto move = [&](double right, double ahead) {
        m_panorama->move(right * std::cos(yaw) + ahead * std::sin(yaw),
                         ahead * std::cos(yaw) - right * std::sin(yaw));
        m_stale = true;
    };
    if (is("bracketleft")) this->set_exposure(m_exposure - kExposureStep);
    if (is("bracketright")) this->set_exposure(m_exposure + kExposureStep);
    if (is("w")) move(0, kMove);
    if (is("s")) move(0, -kMove);
    if (is("a")) move(-kMove, 0);
    if (is("d")) move(kMove, 0);
    if (is("v")) this->set_drawing(static_cast<Drawing>((static_cast<int>(m_drawing) + 1) % 3));
    if (is("r")) {
        this->look({0, 0, 90});
        this->go_to(m_place, {});
    }
    if (m_stale) m_interactor->Render();
}

void PanoramaViewer::handle(vtkObject*, unsigned long event, void* data, void*) {
    auto* viewer = static_cast<PanoramaViewer*>(data);
    switch (event) {
        case vtkCommand::InteractionEvent:
            viewer->m_stale = true;
            break;
        case vtkCommand::StartEvent:
            viewer->update();
            break;
        case vtkCommand::PickEvent:
            viewer->pick();
            break;
        case vtkCommand::MouseMoveEvent:
            viewer->show_cursor();
            break;
        default:
            viewer->key();
    }
}

}  // namespace anamorph_viewer
