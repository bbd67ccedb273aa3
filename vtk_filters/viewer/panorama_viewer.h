// SPDX-License-Identifier: Apache-2.0
// A window onto a panorama, or a tour of several.
//
//     left button       turns the view; a click on a hot spot goes where it leads
//     wheel, right      field of view
//     arrows, + and -   the same by keys
//     [ and ]           exposure, by half a stop
//     w, a, s, d        move the viewpoint of concentric mosaics
//     v                 draws as a picture, per fragment, or per vertex (Drawing)
//     r                 the view as at the beginning
//     q                 ends
#pragma once

#include <vtkActor2D.h>
#include <vtkAnamorphPanoramaStyle.h>
#include <vtkCallbackCommand.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/projector/tour_file.h"
#include "card_view.h"
#include "shown.h"
#include "viewed_panorama.h"

namespace anamorph_viewer {

/// How a view is drawn.
enum class Drawing {
    picture,    ///< by the core, within its tolerance and from any size of image
    fragments,  ///< by the graphics card, every pixel by the panorama's formula (card_view.h)
    vertices    ///< by the graphics card, per vertex with the trapezoid, where there is one
};
/// The drawing that a name means: "picture" and so on. Throws Error where it means none.
Drawing drawing_from_name(const std::string& name);

class PanoramaViewer {
  public:
    /// Opens a tour. `tour`: at least one panorama; names of files are relative to `folder`. `options` hold
    /// for all of them, before their own. Throws Error where the first cannot be opened.
    PanoramaViewer(anamorph::Tour tour, const std::string& folder,
                   const std::vector<anamorph::Assignment>& options);
    ~PanoramaViewer();
    PanoramaViewer(const PanoramaViewer&) = delete;
    PanoramaViewer& operator=(const PanoramaViewer&) = delete;

    vtkRenderWindow* window() { return m_window; }
    vtkRenderWindowInteractor* interactor() { return m_interactor; }
    vtkAnamorphPanoramaStyle* style() { return m_style; }

    View view() const;
    void look(const View& view);
    /// Sets the exposure in stops; 1 is twice as bright.
    void set_exposure(double stops);
    double exposure() const { return m_exposure; }
    Drawing drawing() const { return m_drawing; }
    void set_drawing(Drawing drawing);
    /// The view that the card drew last; null where it draws none.
    const CardView* card() const { return m_card.get(); }
    /// Was that view drawn per vertex?
    bool by_vertices() const { return m_by_vertices; }
    /// The position in the tour of the panorama that is seen.
    std::size_t place() const { return m_place; }
    const ViewedPanorama& panorama() const { return *m_panorama; }
    /// Opens another panorama of the tour. Where it cannot be opened, all stays as it is, and error() says why.
    bool go_to(std::size_t place, const anamorph::TourView& view);
    /// The error that occurred last; empty where none did.
    const std::string& error() const { return m_error; }

  private:
    static void handle(vtkObject* caller, unsigned long event, void* viewer, void*);
    void update();
    void draw_picture(const anamorph::Size& size);
    void draw_by_card(const anamorph::Size& size);
    void let_card_draw(bool does);
    void forget_card();
    void pick();
    void key();
    void show_cursor();
    std::optional<anamorph::HotSpot> spot_at_mouse();
    std::unique_ptr<ViewedPanorama> opened(std::size_t place) const;

    anamorph::Tour m_tour;
    std::string m_folder, m_error;
    std::vector<anamorph::Assignment> m_options;
    std::size_t m_place = 0;
    std::unique_ptr<ViewedPanorama> m_panorama;
    double m_exposure = 0;
    bool m_stale = true, m_by_vertices = false;
    Drawing m_drawing = Drawing::picture;
    std::unique_ptr<CardView> m_card;
    anamorph::Size m_drawn;

    vtkNew<vtkCallbackCommand> m_observer;
    vtkNew<vtkImageData> m_image;
    vtkNew<vtkImageMapper> m_mapper;
    vtkNew<vtkActor2D> m_actor;
    vtkNew<vtkRenderer> m_renderer;
    vtkNew<vtkRenderWindow> m_window;
    vtkNew<vtkAnamorphPanoramaStyle> m_style;
    vtkNew<vtkRenderWindowInteractor> m_interactor;
};

}  // namespace anamorph_viewer
