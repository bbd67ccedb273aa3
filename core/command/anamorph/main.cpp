// SPDX-License-Identifier: Apache-2.0
// anamorph: what operations there are, and their keys; hosts with the plugin, and what they see of it. What it does with pictures
// is in anamorph-pictures, which needs OpenImageIO.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "anamorph/parameter/suggestion.h"
#include "anamorph/version.h"
#include "completion.h"
#include "doctor.h"
#include "misspelt_option.h"
#include "pictures_program.h"
#include "plugin_place.h"
#include "recipe_template.h"
#include "reference.h"

namespace anamorph::command {
namespace {

/// Becomes another program beside this one. Throws Error where it cannot; `where` says where it is to be had.
void run_beside(const std::string& name, char** argv, const std::string& where) {
    const std::string program = (own_folder() / name).string();
    execv(program.c_str(), argv);
    throw Error(printable(program) + ": " + std::strerror(errno) + " (" + where + ")");
}

void run_pictures(char** argv) {
    run_beside("anamorph-pictures", argv,
               std::string(argv[1]) + " is there with OpenImageIO alone; Debian: anamorph-openimageio");
}

/// Becomes the program whose name follows anamorph.
void run_program(char** argv) {
    const std::string name = std::string("anamorph-") + argv[1];
    run_beside(name, argv + 1, "Debian: anamorph");
}

/// Becomes the benchmark of the Python module: of that of this build, if there is one.
void run_bench(char** argv) {
    const char* const kLines =
        "import sys\n"
        "try:\n"
        "    from anamorph.bench import main\n"
        "except ImportError as missing:\n"
        "    sys.exit(f'anamorph: bench needs the Python module: {missing} (Debian: python3-anamorph)')\n"
        "main()\n";
    const std::filesystem::path module = own_folder() / "../../python";
    std::error_code none;
    if (std::filesystem::exists(module / "anamorph", none)) {
        const char* others = std::getenv("PYTHONPATH");
        setenv("PYTHONPATH", (module.string() + (others ? std::string(":") + others : "")).c_str(), 1);
    }
    std::string python = "/usr/bin/python3", option = "-c", lines = kLines;
    std::vector<char*> words{python.data(), option.data(), lines.data()};
    for (char** word = argv + 2; *word; ++word) words.push_back(*word);
    words.push_back(nullptr);
    execv(python.c_str(), words.data());
    throw Error(python + ": " + std::strerror(errno));
}

template <std::size_t N>
bool has(const std::string_view (&words)[N], std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

/// Throws Error of a first word that is no subcommand.
void check_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> all(std::begin(kOfPictures), std::end(kOfPictures));
    all.insert(all.end(), std::begin(kPrograms), std::end(kPrograms));
    all.emplace_back(kBench);
    for (const CLI::App* command : app.get_subcommands({}))
        if (!command->get_group().empty()) all.push_back(command->get_name());
    if (word.starts_with("-") || word == "complete" || std::ranges::find(all, word) != all.end()) return;
    std::string list;
    for (const std::string& name : all) list += (list.empty() ? "" : ", ") + name;
    throw Error("command", printable(word),
                "there is none of that name" + perhaps(word, all) + ": must be one of " + list);
}

const Operation& operation_named(const std::string& name) {
    if (const Operation* operation = find_operation(name)) return *operation;
    std::vector<std::string> names;
    for (const Operation* operation : operations()) names.push_back(operation->name);
    throw Error(
        "operation", printable(name),
        "there is none of that name" + perhaps(name, names) + ": must be one of " + operation_names());
}

void print_help(std::string name) {
    if (has(kOfPictures, name)) {
        std::string program = "anamorph", help = "--help";
        char* argv[] = {program.data(), name.data(), help.data(), nullptr};
        run_pictures(argv);
    }
    if (name.empty()) {
        std::cout << operations_page();
        return;
    }
    std::cout << operation_page(operation_named(name));
}

int run(int argc, char** argv) {
    CLI::App app{"Image warping with a tolerance that holds", "anamorph"};
    app.require_subcommand(1);
    app.set_version_flag("--version", "anamorph " + std::string(version()));
    CLI::App* help = app.add_subcommand("help", "List the operations, or the keys of one");
    app.footer(
        "hash, draw, stmap, join and explain: of pictures (anamorph hash --help)\n"
        "figure and machine: programs (anamorph figure --help)\n"
        "bench: speed against error on this machine (anamorph bench --help)");
    std::string operation;
    help->add_option("OPERATION", operation, "Its name; without, all are listed");
    CLI::App* command = app.add_subcommand("run", "Run a command that finds the plugin for OpenImageIO");
    std::vector<std::string> words;
    command->add_option("COMMAND", words, "What to run, with its arguments")->required()->option_text("...");
    command->footer("anamorph run oiiotool view.pano -o view.jpg");
    CLI::App* created =
        app.add_subcommand("new", "Write a recipe to begin with, which has every key as a comment");
    std::string new_operation, new_output;
    std::vector<std::string> new_sources;
    created->add_option("OPERATION", new_operation, "What it draws: pano, warp, morph ...")->required();
    created->add_option("SOURCE", new_sources, "Its images")->option_text("...");
    created
        ->add_option("-o,--output", new_output,
                     "The recipe, NAME.OPERATION, in which the example of the operation is set, with the "
                     "files that this "
                     "needs beside it; by default the recipe is printed")
        ->option_text("FILE");
    created->footer("anamorph new warp photo.jpg -o bent.warp && anamorph draw bent.warp -o bent.png");
    // For shells, which nobody types it for.
    CLI::App* complete =
        app.add_subcommand("complete", "Print what a command line may go on with")->group("");
    std::vector<std::string> line;
    complete->add_option("WORD", line, "Its words, from the program to the cursor")->required();
    CLI::App* doctor = app.add_subcommand("doctor", "Say what the hosts of this machine see of Anamorph");
    doctor->footer("The status is 1 where a host cannot read recipes, or load the filters that it has.");
    // After the subcommands, which else would have it as well.
    app.set_help_all_flag("--help-all", "Print this help and that of every subcommand, and exit");
    try {
        if (argc > 2 && std::string_view(argv[1]) == "run" && argv[2][0] != '-')
            return run_with_plugin(argv + 2);
        if (argc > 1 && has(kOfPictures, argv[1])) run_pictures(argv);
        if (argc > 1 && has(kPrograms, argv[1])) run_program(argv);
        if (argc > 1 && argv[1] == kBench) run_bench(argv);
        if (argc > 1) check_command(app, argv[1]);
        app.parse(argc, argv);
        bool good = true;
        if (*doctor)
            good = examine_hosts(std::cout);
        else if (*complete)
            for (const std::string& word : completions(line)) std::cout << word << "\n";
        else if (*created && new_output.empty())
            std::cout << recipe_template(operation_named(new_operation), new_sources, false);
        else if (*created)
            write_recipe_template(operation_named(new_operation), new_sources, new_output);
        else
            print_help(operation);
        for (const std::string& name : missing_files(new_sources))
            std::cerr << "anamorph: there is no file " << printable(name) << " yet, which the recipe reads\n";
        if (std::cout.flush()) return good ? 0 : 1;
        throw Error("the standard output cannot be written");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version
        std::cerr << "anamorph: " << message_of(Error(what_is_wrong(e, app, argc, argv)), "the page") << "\n";
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
