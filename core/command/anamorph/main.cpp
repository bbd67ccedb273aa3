// SPDX-License-Identifier: Apache-2.0
// anamorph: what operations there are, and their keys; hosts with the plugin, and what they see of it. What it does with pictures
// is in anamorph-pictures, which needs OpenImageIO.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/version.h"
#include "completion.h"
#include "doctor.h"
#include "pictures_program.h"
#include "plugin_place.h"
#include "reference.h"

namespace anamorph::command {
namespace {

/// Becomes the program beside this one that has these subcommands. Throws Error where it cannot.
void run_pictures(char** argv) {
    const std::string program = (own_folder() / "anamorph-pictures").string();
    execv(program.c_str(), argv);
    throw Error(printable(program) + ": " + std::strerror(errno) + " (" + argv[1] +
                " is there with OpenImageIO alone; Debian: anamorph-openimageio)");
}

void print_help(std::string name) {
    if (std::ranges::find(kOfPictures, name) != std::end(kOfPictures)) {
        std::string program = "anamorph", help = "--help";
        char* argv[] = {program.data(), name.data(), help.data(), nullptr};
        run_pictures(argv);
    }
    if (name.empty()) {
        std::cout << operations_page();
        return;
    }
    const Operation* operation = find_operation(name);
    if (!operation) throw Error("operation", printable(name), "must be one of " + operation_names());
    std::cout << operation_page(*operation);
}

int run(int argc, char** argv) {
    CLI::App app{"Image warping with a tolerance that holds", "anamorph"};
    app.require_subcommand(1);
    app.set_version_flag("--version", "anamorph " + std::string(version()));
    CLI::App* help = app.add_subcommand("help", "List the operations, or the keys of one");
    app.footer("hash, draw, join and explain: of pictures (anamorph hash --help)");
    std::string operation;
    help->add_option("OPERATION", operation, "Its name; without, all are listed");
    CLI::App* command = app.add_subcommand("run", "Run a command that finds the plugin for OpenImageIO");
    std::vector<std::string> words;
    command->add_option("COMMAND", words, "What to run, with its arguments")->required()->option_text("...");
    command->footer("anamorph run oiiotool view.pano -o view.jpg");
    // For shells, which nobody types it for.
    CLI::App* complete =
        app.add_subcommand("complete", "Print what a command line may go on with")->group("");
    std::vector<std::string> line;
    complete->add_option("WORD", line, "Its words, from the program to the cursor")->required();
    CLI::App* doctor = app.add_subcommand("doctor", "Say what the hosts of this machine see of Anamorph");
    doctor->footer("The status is 1 where a host cannot read recipes, or load the filters that it has.");
    try {
        if (argc > 2 && std::string_view(argv[1]) == "run" && argv[2][0] != '-')
            return run_with_plugin(argv + 2);
        if (argc > 1 && std::ranges::find(kOfPictures, argv[1]) != std::end(kOfPictures)) run_pictures(argv);
        app.parse(argc, argv);
        bool good = true;
        if (*doctor)
            good = examine_hosts(std::cout);
        else if (*complete)
            for (const std::string& word : completions(line)) std::cout << word << "\n";
        else
            print_help(operation);
        if (std::cout.flush()) return good ? 0 : 1;
        throw Error("the standard output cannot be written");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version
        std::cerr << "anamorph: " << message_of(e, "the page") << "\n";
    } catch (const std::exception& e) {
        std::cerr << "anamorph: " << message_of(e, "the page") << "\n";
    }
    return 1;
}

}  // namespace
}  // namespace anamorph::command

int main(int argc, char** argv) {
    return anamorph::command::run(argc, argv);
}
