// SPDX-License-Identifier: Apache-2.0
// anamorph: what operations there are, and their keys; with OpenImageIO, pictures' hashes, and pictures drawn.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>

#include "anamorph/version.h"
#include "reference.h"
#ifdef ANAMORPH_HAVE_PICTURES
#include "picture_commands.h"
#endif

namespace anamorph::command {
namespace {

void print_help(const std::string& name) {
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
    std::string operation;
    help->add_option("OPERATION", operation, "Its name; without, all are listed");
    std::function<void()> run = [&] { print_help(operation); };
#ifdef ANAMORPH_HAVE_PICTURES
    add_picture_commands(app, run);
#endif
    std::string what = "the page";
    try {
        app.parse(argc, argv);
        if (!help->parsed()) what = "the picture";
        run();
        if (std::cout.flush()) return 0;
        throw Error("the standard output cannot be written");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version
        std::cerr << "anamorph: " << message_of(e, what) << "\n";
    } catch (const std::exception& e) {
        std::cerr << "anamorph: " << message_of(e, what) << "\n";
    }
    return 1;
}

}  // namespace
}  // namespace anamorph::command

int main(int argc, char** argv) {
    return anamorph::command::run(argc, argv);
}
