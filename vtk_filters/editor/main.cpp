// SPDX-License-Identifier: Apache-2.0
// anamorph-warp: edits the control meshes of warps.
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "warp_window.h"

namespace {

using anamorph::Error;
using anamorph_editor::EditWindow;

struct Arguments {
    std::string recipe, save_as, picture;
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

void run(const Arguments& arguments) {
    const std::unique_ptr<EditWindow> window = std::make_unique<anamorph_editor::WarpWindow>(
        arguments.recipe, anamorph::Size{arguments.cells[0], arguments.cells[1]}, arguments.save_as);
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
    CLI::App app("Edits the control mesh of a warp, and shows the picture meanwhile.", "anamorph-warp");
    app.footer(
        "Left button: selects a point and drags what is selected; elsewhere a rectangle of points. With "
        "shift: "
        "these too,\n"
        "with ctrl: each as it was not. Double click or c: cuts a cell into four. Wheel: larger, smaller. "
        "Middle or right\n"
        "button: moves the picture. ctrl+z, ctrl+y: a step back, and again. ctrl+s: saves. g: mesh shown or "
        "not. f: whole\n"
        "picture. a: selects all. Escape: gives a drag up. q: end.");
    app.add_option("RECIPE", arguments.recipe,
                   "A recipe of .warp with a mesh, as in photo.png.warp?mesh=bulge.json")
        ->required();
    app.add_option("--cells", arguments.cells,
                   "Starts a mesh of so many cells across and down, whose file is not there yet")
        ->expected(2)
        ->check(CLI::Range(1, anamorph::ControlMesh::kMaxCells));
    app.add_option("--save", arguments.save_as, "The file that is saved to; by default the recipe's mesh");
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
