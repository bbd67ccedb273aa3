// SPDX-License-Identifier: Apache-2.0
// anamorph-view: looks around in panoramas.
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "anamorph/side_files.h"
#include "panorama_viewer.h"

namespace {

using anamorph::Error;

struct Arguments {
    std::string panorama, picture, drawing = "picture";
    std::vector<std::string> options;
    anamorph_viewer::View view{NAN, NAN, NAN};
    double exposure = 0;
    std::vector<int> size = {1024, 768};
};

std::vector<anamorph::Assignment> assignments_of(const std::vector<std::string>& options) {
    std::vector<anamorph::Assignment> assignments;
    for (const std::string& option : options) {
        const std::size_t equals = option.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error("\"" + anamorph::printable(option) + "\": must be key=value, as in from=cylindrical");
        assignments.push_back({option.substr(0, equals), option.substr(equals + 1)});
    }
    return assignments;
}

/// Of one panorama where the file is none of a tour.
anamorph::Tour tour_of(const std::string& file) {
    if (!file.ends_with(".json")) return {{std::filesystem::absolute(file).string()}};
    return anamorph::parse_tour_json(anamorph::side_file_reader().text(file), file);
}

void write_picture(vtkRenderWindow* window, const std::string& file) {
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
    using anamorph_viewer::View;
    anamorph_viewer::PanoramaViewer viewer(
        tour_of(arguments.panorama), std::filesystem::absolute(arguments.panorama).parent_path().string(),
        assignments_of(arguments.options));
    const View own = viewer.view();
    const auto of = [](double asked, double otherwise) { return std::isnan(asked) ? otherwise : asked; };
    viewer.look({of(arguments.view.yaw, own.yaw), of(arguments.view.pitch, own.pitch),
                 of(arguments.view.fov, own.fov)});
    viewer.set_exposure(arguments.exposure);
    viewer.set_drawing(anamorph_viewer::drawing_from_name(arguments.drawing));
    viewer.window()->SetSize(arguments.size[0], arguments.size[1]);
    if (!arguments.picture.empty()) viewer.window()->OffScreenRenderingOn();
    viewer.window()->Render();
    if (!viewer.error().empty()) throw Error(viewer.error());
    if (!arguments.picture.empty()) return write_picture(viewer.window(), arguments.picture);
    viewer.interactor()->Initialize();
    viewer.interactor()->Start();
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app("Looks around in a panorama, or in a tour of several.", "anamorph-view");
    app.footer(
        "Left button, arrows: turn. Wheel, right button, + and -: field of view. [ and ]: exposure. w, a, s, "
        "d: move in\n"
        "concentric mosaics. v: drawn as a picture, per fragment or per vertex. r: as at the beginning. q: "
        "end.\n"
        "A click on a hot spot goes where it leads.");
    app.add_option("PANORAMA", arguments.panorama, "An image, or a tour: a .json of panoramas and hot spots")
        ->required();
    app.add_option("SETTING", arguments.options,
                   "What the image is, as in recipes of .pano (from, srcfov, srclens, srcyaw, tol ...) or, "
                   "with circles, of .mosaic")
        ->option_text("KEY=VALUE ...");
    app.add_option("--yaw", arguments.view.yaw, "Where to look: degrees to the right");
    app.add_option("--pitch", arguments.view.pitch, "Degrees up");
    app.add_option("--fov", arguments.view.fov, "Degrees that the window's width covers");
    app.add_option("--exposure", arguments.exposure, "Stops: 1 is twice as bright")
        ->check(CLI::Range(-32.0, 32.0));
    app.add_option("--draw", arguments.drawing,
                   "How: picture, by the core within tol and from images larger than memory; or by the "
                   "graphics card, fragments, "
                   "every pixel by the formula, or vertices, the corners of the view and a table");
    app.add_option("--size", arguments.size, "Width and height of the window")
        ->expected(2)
        ->check(CLI::Range(1, 16384));
    app.add_option("--picture", arguments.picture, "Writes what the window shows to a PNG file, and ends");
    CLI11_PARSE(app, argc, argv);
    try {
        run(arguments);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "anamorph-view: " << anamorph::message_of(e, "the panorama") << "\n";
        return 1;
    }
}
