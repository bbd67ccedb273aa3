// SPDX-License-Identifier: Apache-2.0
// anamorph-warp: edits the control meshes of warps and the features of morphs.
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "morph_window.h"
#include "recipe.h"
#include "warp_window.h"

namespace {

using anamorph::Error;
using anamorph_editor::EditWindow;

struct Arguments {
    std::string recipe, save_as, picture, drawing = "picture";
    bool starts_empty = false;
    std::vector<int> cells = {0, 0}, size = {1600, 860};
};

void write_picture(vtkRenderWindow* window, const std::string& file) {
    if (!std::ofstream(file, std::ios::app)) throw Error(anamorph::printable(file) + " cannot be written");
    vtkNew<vtkWindowToImageFilter> picture;
    picture->SetInput(window);
    picture->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(picture->GetOutputPort());
    writer->SetFileName(file.c_str());
    writer->Write();
    if (writer->GetErrorCode() != 0) throw Error(anamorph::printable(file) + " cannot be written");
}

std::unique_ptr<EditWindow> open(const Arguments& arguments) {
    if (anamorph::has_extension(arguments.recipe, ".morph"))
        return std::make_unique<anamorph_editor::MorphWindow>(arguments.recipe, arguments.starts_empty,
                                                              arguments.save_as);
    return std::make_unique<anamorph_editor::WarpWindow>(
        arguments.recipe, anamorph::Size{arguments.cells[0], arguments.cells[1]}, arguments.save_as);
}

void run(const Arguments& arguments) {
    const std::unique_ptr<EditWindow> window = open(arguments);
    if (arguments.drawing != "picture" && arguments.drawing != "fragments")
        throw Error("draw", anamorph::printable(arguments.drawing), "must be picture or fragments");
    window->draw_by_fragments(arguments.drawing == "fragments");
    window->window()->SetSize(arguments.size[0], arguments.size[1]);
    if (!arguments.picture.empty()) window->window()->OffScreenRenderingOn();
    window->window()->Render();
    if (!window->error().empty()) throw Error(window->error());
    if (!arguments.picture.empty()) return write_picture(window->window(), arguments.picture);
    window->interactor()->Initialize();
    window->interactor()->Start();
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app(
        "Edits the control mesh of a warp or the features of a morph, and shows the picture meanwhile.",
        "anamorph-warp");
    app.footer(
        "Left button: selects a point and drags what is selected; elsewhere a rectangle of points. With "
        "shift: "
        "these too,\n"
        "with ctrl: each as it was not. Double click or c: cuts a cell into four. Wheel: larger, smaller. "
        "Middle or right\n"
        "button: moves the picture. ctrl+z, ctrl+y: a step back, and again. ctrl+s: saves. g: mesh shown or "
        "not. f: whole\n"
        "picture. v: drawn by the core, or by the graphics card. a: selects all. Escape: gives a drag up. q: "
        "end. Of morphs, n: lines are drawn, or no "
        "more. "
        "Delete: features are\n"
        "taken away. Space: play, or stop. Comma, period: a step of t.");
    app.add_option("RECIPE", arguments.recipe,
                   "A recipe of .warp with a mesh, as in photo.png.warp?mesh=bulge.json, or of .morph with "
                   "two pictures")
        ->required();
    app.add_option("--cells", arguments.cells,
                   "Starts a mesh of so many cells across and down, whose file is not there yet")
        ->expected(2)
        ->check(CLI::Range(1, anamorph::ControlMesh::kMaxCells));
    app.add_flag("--new", arguments.starts_empty,
                 "Starts a morph without features, whose file is not there yet");
    app.add_option("--save", arguments.save_as, "The file that is saved to; by default the recipe's own");
    app.add_option(
        "--draw", arguments.drawing,
        "How: picture, by the core within tol; or fragments, by the graphics card, every pixel by the "
        "formula in floats");
    app.add_option("--size", arguments.size, "Width and height of the window")
        ->expected(2)
        ->check(CLI::Range(1, 16384));
    app.add_option("--picture", arguments.picture, "Writes what the window shows to a PNG file, and ends");
    CLI11_PARSE(app, argc, argv);
    try {
        run(arguments);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "anamorph-warp: " << anamorph::message_of(e, "the picture") << "\n";
        return 1;
    }
}
