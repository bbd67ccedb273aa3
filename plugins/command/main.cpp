// SPDX-License-Identifier: Apache-2.0
// anamorph-pictures, which anamorph runs: hash, draw, stmap, join and explain.
#include <OpenImageIO/imageio.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/operation/operation.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/version.h"
#include "draw.h"
#include "explain.h"
#include "misspelt_option.h"
#include "part_file.h"
#include "picture_reader.h"
#include "stmap.h"

extern "C" OIIO::ImageInput* anamorph_recipes_input_imageio_create();

namespace anamorph::command {
namespace {

/// Recipes that read from recipes find them as the plugin's, with no plugin installed.
void declare_recipes() {
    static const char* const kFormat = "anamorph_recipes";
    if (OIIO::is_imageio_format_name(kFormat)) return;
    static std::vector<const char*> endings;
    for (const Operation* operation : operations()) {
        endings.push_back(operation->name.c_str());
        for (const std::string& ending : operation->endings) endings.push_back(ending.c_str());
    }
    endings.push_back(nullptr);
    OIIO::declare_imageio_format(kFormat, anamorph_recipes_input_imageio_create, endings.data(), nullptr,
                                 nullptr, version());
}

/// Adds the subcommands; `run` is then what is to be done.
void add_picture_commands(CLI::App& app, std::function<void()>& run) {
    struct Given {
        std::string recipe, output;
        std::optional<std::string> part, crop, frames, compression;
        StMapKind stmap;
        int jobs = 0;
        std::vector<std::string> names;
        int subimage = 0;
        bool timed = false;
    };
    const auto given = std::make_shared<Given>();

    const auto add_compression = [given](CLI::App& command, const std::string& words, const char* text) {
        return command
            .add_option("--compression", given->compression,
                        "How FILE is packed, in its format's words: " + words)
            ->option_text(text);
    };
    const std::string of_pictures =
        "zip, filtered, huffman, rle or fixed of a PNG, maybe with a level, such as zip:9; piz, zip, dwaa:45 "
        "of an EXR, jpeg:90";
    const char* const png = "NAME [rle for PNG]";

    const auto add_jobs = [given](CLI::App& command) {
        command
            .add_option("--jobs", given->jobs,
                        "Threads that draw, each a frame where there are several; 0 is one a processor")
            ->option_text("N [0]");
    };

    CLI::App* hash = app.add_subcommand("hash", "Print the hash of pictures: of recipes and files");
    hash->add_option("PICTURE", given->names, "A recipe, or a file that OpenImageIO reads")->required();
    hash->callback([=, &run] {
        run = [=] {
            declare_recipes();
            for (const std::string& name : given->names)
                std::cout << hash_digits(hash_of(*open_picture(name))) << "  " << name << std::endl;
        };
    });

    CLI::App* draw_command = app.add_subcommand(
        "draw", "Draw a recipe's picture into a file, or a part of it, or frames of a film");
    draw_command
        ->add_option("RECIPE", given->recipe,
                     "view.pano, or pano.exr.pano?to=rectilinear&fov=90; {frame} in it is the frame's number")
        ->required();
    draw_command
        ->add_option("-o,--output", given->output,
                     "The file; its ending says the format. Of frames, {frame} stands for the number in four "
                     "digits, which else goes before the ending")
        ->required()
        ->option_text("FILE");
    CLI::Option* part =
        draw_command
            ->add_option(
                "--part", given->part,
                "A share of the picture's tiles, 3/8 the third of eight, for anamorph join; what FILE "
                "has of it already is not drawn again")
            ->option_text("I/N");
    draw_command
        ->add_option("--frames", given->frames,
                     "The frames, with {frame} in RECIPE, by its key frame, or of its pictures from 0 on; by "
                     "default all of these if FILE has {frame}")
        ->option_text("A-B[xS]")
        ->excludes(part);
    add_compression(*draw_command, of_pictures, png)->excludes(part);
    add_jobs(*draw_command);
    draw_command->callback([=, &run] {
        run = [=] {
            declare_recipes();
            if (!given->part)
                return draw({given->recipe, given->output, given->frames, given->compression, given->jobs});
            use_threads(given->jobs);
            draw_part(given->recipe, share_of(*given->part), given->output);
        };
    });

    CLI::App* stmap = app.add_subcommand(
        "stmap", "Draw a recipe's map as an ST-map: where in the source each pixel comes from");
    stmap
        ->add_option("RECIPE", given->recipe,
                     "view.pano, or plate.exr.lens?lens=3de4:k1=0.05; {frame} in it is the frame's number")
        ->required();
    stmap
        ->add_option("-o,--output", given->output,
                     "The file, .exr or another that holds float: u and v, 0 to 1 on the source, as R and G. "
                     "Of frames, {frame} stands for the number in four digits, which else goes before the "
                     "ending")
        ->required()
        ->option_text("FILE");
    stmap->add_flag("--flip-v", given->stmap.up,
                    "v goes up, 0 at the lower edge, as Nuke, Gaffer and Natron have it; without, down");
    stmap->add_flag("--inverse", given->stmap.inverse,
                    "The other way: where in the picture each pixel of the source goes, found by Newton's "
                    "iteration, without a bound");
    stmap
        ->add_option("--frames", given->frames,
                     "The frames, with {frame} in RECIPE, by its key frame, or of its pictures from 0 on")
        ->option_text("A-B[xS]");
    add_compression(*stmap, "zip, piz or none of an EXR, zip, lzw or none of a TIFF", "NAME");
    add_jobs(*stmap);
    stmap->footer(
        "anamorph draw \"plate.exr.warp?mesh=map.exr\" -o flat.exr draws a picture through an ST-map, with "
        "&flip_v=1 one of --flip-v");
    stmap->callback([=, &run] {
        run = [=] {
            declare_recipes();
            Drawing drawing{given->recipe, given->output, given->frames, given->compression, given->jobs};
            drawing.in_float = true;
            drawing.open = [kind = given->stmap](const std::string& recipe,
                                                 const std::vector<Assignment>& keys) {
                return open_stmap(recipe, keys, kind);
            };
            draw(drawing);
        };
    });

    CLI::App* join =
        app.add_subcommand("join", "Put parts of a picture together, check them and print its hash");
    join->add_option("PART", given->names, "All files of anamorph draw --part, in any order")->required();
    join->add_option("-o,--output", given->output, "The picture; without, parts are only checked")
        ->option_text("FILE");
    add_compression(*join, of_pictures, png);
    join->callback([=, &run] {
        run = [=] {
            std::cout << hash_digits(join_parts(given->names, {given->output, given->compression}))
                      << std::endl;
        };
    });

    CLI::App* explained = app.add_subcommand(
        "explain", "Say by what a recipe's picture is drawn, how exactly, and what that reads");
    explained->add_option("RECIPE", given->recipe, "view.pano, or pano.exr.pano?to=rectilinear&fov=90")
        ->required();
    explained->add_option("--crop", given->crop, "The part of the picture that is meant")
        ->option_text("WxH+X+Y");
    explained->add_option("--subimage", given->subimage, "The frame of a film, or the part, from 0 on")
        ->option_text("N");
    explained->add_flag("--time", given->timed, "Draw it as well, and say how long that takes");
    explained->callback([=, &run] {
        run = [=] {
            declare_recipes();
            explain(given->recipe, given->crop, given->subimage, given->timed, std::cout);
        };
    });
}

int run(int argc, char** argv) {
    CLI::App app{"Pictures of recipes", "anamorph"};
    app.require_subcommand(1);
    app.set_version_flag("--version", "anamorph " + std::string(version()));
    std::function<void()> run;
    add_picture_commands(app, run);
    // After the subcommands, which else would have it as well.
    app.set_help_all_flag("--help-all", "Print this help and that of every subcommand, and exit");
    try {
        app.parse(argc, argv);
        run();
        if (std::cout.flush()) return 0;
        throw Error("the standard output cannot be written");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version
        std::cerr << "anamorph: " << message_of(Error(what_is_wrong(e, app, argc, argv)), "the picture")
                  << "\n";
    } catch (const std::exception& e) {
        std::cerr << "anamorph: " << message_of(e, "the picture") << "\n";
    }
    return 1;
}

}  // namespace
}  // namespace anamorph::command

int main(int argc, char** argv) {
    return anamorph::command::run(argc, argv);
}
