// SPDX-License-Identifier: Apache-2.0
#include "doctor.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anamorph/parameter/parameter.h"
#include "anamorph/version.h"
#include "plugin_place.h"
#include "program_run.h"

namespace anamorph::command {
namespace {

namespace fs = std::filesystem;

constexpr int kSeconds = 60;  // ParaView's Python takes some to start

/// A folder that is gone in the end, with a small picture and a recipe of it.
class Sample {
  public:
    Sample() {
        const char* given = std::getenv("TMPDIR");
        const std::string place = given && *given ? given : "/tmp";
        std::string name = place + "/anamorph-doctor-XXXXXX";
        if (!mkdtemp(name.data()))
            throw Error("TMPDIR=" + printable(place) + ": no folder can be made there");
        m_folder = name;
        std::ofstream picture(m_folder / "sky.ppm", std::ios::binary);
        picture << "P6\n8 4\n255\n" << std::string(8 * 4 * 3, 'a');
        std::ofstream recipe(m_folder / "view.pano");
        recipe << "src=sky.ppm\nto=rectilinear\nfov=90\nsize=6x5\n";
        if (!picture.flush() || !recipe.flush()) throw Error(printable(name) + ": cannot be written to");
    }
    ~Sample() {
        std::error_code error;
        fs::remove_all(m_folder, error);
    }
    Sample(const Sample&) = delete;
    Sample& operator=(const Sample&) = delete;

    std::string recipe() const { return (m_folder / "view.pano").string(); }

  private:
    fs::path m_folder;
};

/// One host at a time: a line that says how it is, and lines on what to do.
class Report {
  public:
    explicit Report(std::ostream& out) : m_out(out) {}

    void good(const std::string& line) { m_out << "ok    " << line << "\n"; }
    void none(const std::string& line) { m_out << "-     " << line << "\n"; }
    void fault(const std::string& line) {
        m_out << "FAULT " << line << "\n";
        m_all_good = false;
    }
    void more(const std::string& line) { m_out << "      " << line << "\n"; }
    bool all_good() const { return m_all_good; }

  private:
    std::ostream& m_out;
    bool m_all_good = true;
};

/// What is known of the plugins before any host is asked.
struct Plugins {
    std::vector<fs::path> files;
    std::string made_for;  // OpenImageIO's versions, "2.4", by the library that each asks for
};

/// The words behind `word` in `text`, up to what cannot belong to a version.
std::vector<std::string> versions_after(const std::string& text, const std::string& word) {
    std::vector<std::string> found;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const std::size_t begin = at + word.size();
        const std::string version = text.substr(begin, text.find_first_not_of("0123456789.", begin) - begin);
        if (!version.empty() && std::ranges::find(found, version) == found.end()) found.push_back(version);
    }
    return found;
}

Plugins examine_plugins(Report& report) {
    Plugins result{plugins(), ""};
    if (result.files.empty()) {
        report.none("no plugin for OpenImageIO (Debian: anamorph-openimageio); looked for in");
        for (const fs::path& place : plugin_places()) report.more(printable(place.string()));
    }
    const std::string ldd = find_program("ldd");
    for (const fs::path& file : result.files) {
        const std::string name = printable(file.string());
        const ProgramRun needs = ldd.empty() ? ProgramRun{} : run_program({ldd, file.string()}, kSeconds);
        std::string made_for, missing;
        for (const std::string& version : versions_after(needs.text, "libOpenImageIO.so."))
            made_for = version;
        std::istringstream lines(needs.text);
        for (std::string line; std::getline(lines, line);)
            if (line.ends_with("=> not found"))
                missing += (missing.empty() ? "" : ", ") +
                           line.substr(line.find_first_not_of(" \t"),
                                       line.find(" =>") - line.find_first_not_of(" \t"));
        const std::string what =
            "plugin" + (made_for.empty() ? "" : " for OpenImageIO " + made_for) + ": " + name;
        if (!missing.empty())
            report.fault(what + " lacks " + printable(missing));
        else if (!needs.ok())
            report.fault(what + ": " + needs.last_line());
        else
            report.good(what);
        if (!made_for.empty()) result.made_for += (result.made_for.empty() ? "" : " and ") + made_for;
    }
    return result;
}

/// Which of OpenImageIO's variables names the plugins. Returns the names of those that do not.
std::string examine_variables(const Plugins& plugins, Report& report) {
    std::string lacking;
    for (const char* variable : kPluginVariables) {
        const char* value = std::getenv(variable);
        const std::string is = value ? value : "";
        const bool names = !plugins.files.empty() && with_folders(is, plugins.files) == is;
        if (!names) lacking += (lacking.empty() ? "" : ", ") + std::string(variable);
        const std::string shown = std::string(variable) + (value ? "=" + printable(is) : ": not set");
        if (plugins.files.empty() || names)
            report.none(shown);
        else
            report.none(shown + (value ? ": does not name the plugin's folder" : ""));
    }
    return lacking;
}

/// What a host of OpenImageIO says, asked as it is and by anamorph run.
struct Asked {
    std::string name;  // with its version
    std::vector<std::string> draws;
    std::string version;
};

/// A host's words for the recipe it is to draw, run with the variables that anamorph run sets.
ProgramRun by_anamorph_run(const std::vector<std::string>& words) {
    std::vector<std::string> with = {(own_folder() / "anamorph").string(), "run"};
    with.insert(with.end(), words.begin(), words.end());
    return run_program(with, kSeconds);
}

/// Why a program failed, in a line: oiiotool writes what it was called with behind that.
std::string why(const ProgramRun& run) {
    if (run.status < 0) return "it did not end within a minute";
    const std::string error = run.after("oiiotool ERROR: ");
    return error.empty() ? run.last_line() : error;
}

void examine_reader(const Asked& host, const Plugins& plugins, const std::string& lacking, Report& report) {
    const auto draws = [](const ProgramRun& run) {
        return run.ok() && run.text.find("6 x    5") != std::string::npos;
    };
    const ProgramRun as_it_is = run_program(host.draws, kSeconds);
    if (draws(as_it_is)) {
        report.good(host.name + ": reads recipes");
        return;
    }
    report.fault(host.name + ": reads no recipes: " + why(as_it_is));
    if (plugins.files.empty()) {
        report.more("there is no plugin (Debian: anamorph-openimageio)");
    } else if (!plugins.made_for.empty() && !host.version.starts_with(plugins.made_for + ".") &&
               plugins.made_for.find(" and ") == std::string::npos) {
        report.more("it has OpenImageIO " + host.version + ", and the plugin is for " + plugins.made_for);
    } else if (const ProgramRun helped = by_anamorph_run(host.draws); draws(helped)) {
        report.more("it does by \"anamorph run\"; not naming the plugin's folder: " + lacking);
        std::string set;
        for (const char* variable : kPluginVariables)
            set += " " + std::string(variable) + "=" + printable(with_folders("", plugins.files));
        report.more("for this shell: export" + set);
        report.more("(the package's /etc/profile.d/anamorph.sh sets them at the next login)");
    } else {
        report.more("nor by \"anamorph run\": " + why(helped));
    }
}

void examine_oiiotool(const Plugins& plugins, const std::string& recipe, const std::string& lacking,
                      Report& report) {
    const std::string file = find_program("oiiotool");
    if (file.empty()) {
        report.none("oiiotool: not here (Debian: openimageio-tools)");
        return;
    }
    const std::string version = run_program({file, "--version"}, kSeconds).last_line();
    examine_reader({"oiiotool " + version + " (" + printable(file) + ")", {file, "--info", recipe}, version},
                   plugins, lacking, report);
}

/// The Python programs that users start: the one that PATH has, and Debian's.
std::vector<std::string> pythons() {
    std::vector<std::string> files;
    for (const std::string& file : {find_program("python3"), std::string("/usr/bin/python3")}) {
        std::error_code error;
        if (file.empty() || !fs::exists(file, error)) continue;
        if (files.empty() || !fs::equivalent(file, files.front(), error)) files.push_back(file);
    }
    return files;
}

/// Runs `lines` of Python, which print what they find behind marks. Modules of the folder that we are in do not count.
ProgramRun run_python(const std::string& python, const std::string& lines,
                      const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {python, "-c",
                                      "import sys\nsys.path = [p for p in sys.path if p]\n" + lines};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, kSeconds);
}

void examine_python(const std::string& python, const Plugins& plugins, const std::string& recipe,
                    const std::string& lacking, Report& report) {
    const std::string name = "python (" + printable(python) + ")";
    const ProgramRun has = run_python(python,
                                      "import importlib.util\n"
                                      "print('there', importlib.util.find_spec('OpenImageIO') is not None)\n"
                                      "import OpenImageIO\nprint('version', OpenImageIO.__version__)\n");
    if (has.after("there ") == "False") {
        report.none(name + ": has no OpenImageIO (Debian: python3-openimageio)");
        return;
    }
    const std::string version = has.after("version ");
    if (version.empty()) {
        report.fault(name + ": its OpenImageIO cannot be loaded: " + has.last_line());
        return;
    }
    const std::string draw =
        "import sys, OpenImageIO as oiio\npicture = oiio.ImageBuf(sys.argv[1])\n"
        "if not picture.read(): sys.exit(picture.geterror())\n"
        "print('%4d x %4d' % (picture.spec().width, picture.spec().height))\n";
    examine_reader({name + " with OpenImageIO " + version, {python, "-c", draw, recipe}, version}, plugins,
                   lacking, report);
}

void examine_vtk(const std::string& python, Report& report) {
    const ProgramRun has = run_python(
        python,
        "import importlib.util\nfind = importlib.util.find_spec\n"
        "print('there', find('vtkmodules') is not None)\n"
        "from vtkmodules.vtkCommonCore import vtkVersion\nprint('version', vtkVersion.GetVTKVersion())\n"
        "there = find('anamorph') is not None and find('anamorph.AnamorphFilters') is not None\n"
        "print('filters', there)\n"
        "if there:\n    import anamorph\n    anamorph.vtkAnamorphDeform()\n    print('at', "
        "anamorph.__file__)\n");
    if (has.after("there ") == "False") return;
    const std::string version = has.after("version ");
    if (version.empty()) {
        report.fault("VTK (" + printable(python) + "): cannot be loaded: " + has.last_line());
        return;
    }
    const std::string name = "VTK " + version + " (" + printable(python) + ")";
    if (has.after("filters ") == "False")
        report.none(name + ": has no filters of Anamorph (Debian: python3-vtk9-anamorph)");
    else if (has.ok())
        report.good(name + ": loads the filters, " + has.after("at "));
    else
        report.fault(name + ": cannot load the filters: " + has.last_line());
}

void examine_paraview(Report& report) {
    const std::string file = find_program("pvpython");
    if (file.empty()) {
        report.none("ParaView: not here, as far as PATH says");
        return;
    }
    const ProgramRun has = run_python(file,
                                      "import paraview.simple as simple\nimport paraview\n"
                                      "print('version', simple.GetParaViewSourceVersion().split()[-1])\n"
                                      "print('filters', hasattr(simple, 'AnamorphDeform'))\n");
    const char* path = std::getenv("PV_PLUGIN_PATH");
    const std::string version = has.after("version ");
    const std::string name = "ParaView " + version + (version.empty() ? "(" : " (") + printable(file) + ")";
    if (has.after("filters ") == "True")
        report.good(name + ": has loaded the plugin");
    else if (has.after("filters ") == "False")
        report.none(
            name +
            ": has not loaded the plugin (Debian: paraview-anamorph; in a build PV_PLUGIN_PATH, which is " +
            (path ? printable(path) : "not set") + ")");
    else
        report.fault(name + ": cannot be asked: " + why(has));
}

}  // namespace

bool examine_hosts(std::ostream& out) {
    Report report(out);
    out << "anamorph " << version() << " (" << printable(own_folder().string()) << ")\n";
    const Plugins found = examine_plugins(report);
    const std::string lacking = examine_variables(found, report);
    const Sample sample;
    examine_oiiotool(found, sample.recipe(), lacking, report);
    const std::vector<std::string> interpreters = pythons();
    for (const std::string& python : interpreters)
        examine_python(python, found, sample.recipe(), lacking, report);
    for (const std::string& python : interpreters) examine_vtk(python, report);
    examine_paraview(report);
    return report.all_good();
}

}  // namespace anamorph::command
