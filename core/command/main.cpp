// SPDX-License-Identifier: Apache-2.0
// anamorph-figure: scripts of NUDES checked, performed and drawn.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <thread>

#include "anamorph/figure/files/ellipse_file.h"
#include "anamorph/figure/files/frame_file.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/files/scene_file.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/figure/language/language.h"
#include "anamorph/figure/outline/drawing.h"
#include "anamorph/figure/outline/fit.h"
#include "anamorph/operation/figure_look.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"
#include "anamorph/version.h"
#include "film_writer.h"
#include "frame_range.h"
#include "input_file.h"
#include "misspelt_option.h"
#include "mrasel.h"
#include "picture_bytes.h"
#include "progress.h"
#include "script_source.h"
#include "texture_files.h"
#include "threads.h"
#include "writers.h"

namespace anamorph::command {
using namespace figure;
namespace {

constexpr NumberRow kThreadsRow{"threads", 0, 0, 1024, NumberRow::closed, true};
constexpr NumberRow kSizeRow{"size", 500, 1, 16384};
constexpr NumberRow kPerspectiveRow{"perspective", NAN, 1e-3, 1e9};
constexpr NumberRow kFramesPerSecondRow{"fps", NAN, 0.01, 1000};
constexpr NumberRow kSceneTolRow{"tol", NAN, 0, NumberRow::kNoEnd, NumberRow::above_least};
constexpr NumberRow kPerturbationRow{"perturbation", 0, 0, 1};
constexpr NumberRow kSeedRow{"seed", 0, 0, 1e9, NumberRow::closed, true};
constexpr NumberRow kColumnsRow{"width", 80, 1, 4096, NumberRow::closed, true};

/// What the command line says.
struct Settings {
    ScriptSource source;
    std::string output = "-", frames, word;
    DrawingOptions drawing;
    std::optional<Viewport> viewport;  ///< in shares of the picture
    double size = kSizeRow.standard;   ///< of the window of 1000 units, in pixels
    double perspective = 0;            ///< the distance from the eye to the middle of the window; 0: none
    bool fit = false;                  ///< the view
    FigureLook look;                   ///< of films
    ParameterValues own_look{
        figure_look_table()};      ///< of films: colors by formulas, heights, and what lines stand for
    double frames_per_second = 0;  ///< 0: the motion's own
    double scene_tol = 0;          ///< 0: spheres of the usual cells
    int threads = static_cast<int>(kThreadsRow.standard), columns = static_cast<int>(kColumnsRow.standard);
    Characters characters = Characters::braille;
};

std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    return text;
}

/// Reads --viewport.
Viewport viewport_from(const std::string& text) {
    std::vector<double> numbers;
    for (const char *at = text.data(), *stop = at + text.size(); at <= stop;) {
        double value = 0;
        const auto [end, error] = std::from_chars(at, stop, value);
        // What is no number is none of four.
        if (error != std::errc() || (end != stop && *end != ',')) return viewport_of("--viewport", text, {});
        numbers.push_back(value);
        at = end + 1;
    }
    return viewport_of("--viewport", text, numbers);
}

/// The numbers of a row, and no others (CLI11's own check lets NaN pass).
CLI::Validator number_of(const NumberRow& row) {
    return CLI::Validator(
        [row](std::string& text) -> std::string {
            double value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error == std::errc() && end == text.data() + text.size() && row.holds(value)) return {};
            return "\"" + text + "\": must be " + row.range();
        },
        "");
}

/// Takes a word for what it stands for.
template <class Value>
CLI::Validator one_of(const std::map<std::string, Value>& words) {
    return CLI::Validator(
        [words](std::string& text) -> std::string {
            if (const auto found = words.find(text); found != words.end()) {
                text = std::to_string(static_cast<int>(found->second));
                return {};
            }
            std::string all;
            for (const auto& [word, value] : words) all += (all.empty() ? "" : ", ") + word;
            return "\"" + printable(text) + "\": must be one of " + all;
        },
        "");
}

CLI::Validator frame_range() {
    return CLI::Validator(
        [](std::string& text) -> std::string {
            if (parse_frame_range(text)) return {};
            return "\"" + text + "\": must be N, N-M, N-MxSTEP or all";
        },
        "");
}

/// The option of a row of figures' looks.
std::string option_of(const std::string& row) {
    if (row == "outline_tol") return "--simple-tol";
    std::string name = "--" + row;
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

/// Runs `read`, whose errors then name the option in place of the row.
template <class Read>
void with_options(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        if (error.parameter().empty()) throw;
        throw Error(option_of(error.parameter()) +
                    std::string(error.what()).substr(error.parameter().size()));
    }
}

/// Says what of a drawing's bodies its lines do not show.
void tell_left_out(int frame, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    std::cerr << "anamorph-figure: frame " << frame
              << ": cylinders before the near plane are left out: " << printable(all) << "\n";
}

class Command {
  public:
    Command() {
        m_app.require_subcommand(1);
        m_app.set_version_flag("--version", "anamorph-figure " + std::string(version()));
        m_app.get_formatter()->column_width(34);
        add_check();
        add_frames();
        add_picture("svg", "Draw outlines, hidden lines removed, as SVG");
        add_picture("pdf", "Draw outlines as PDF, a page for each frame");
        add_picture("png", "Draw outlines as PNG");
        add_text();
        add_film();
        add_scene("gltf", "Write the figures with their motion as glTF 2.0 (.glb)", " (the default)");
        add_scene("obj", "Write a frame's figures as Wavefront OBJ", "; by default the first of those");
        add_scene("vtp", "Write a frame's figures as points of VTK's XML (.vtp)",
                  "; by default the first of those");
        add_ellipses("hide", "Write outlines and their hidden arcs as HIDE does (.2)");
        add_ellipses("visib", "Write whole outlines as VISIB does (.2)");
        add_plotel();
        add_mrasel();
        add_mtexture();
        add_showmap();
        add_stats();
        add_language();
    }

    int run(int argc, char** argv) {
        // After the subcommands, which else would have it as well.
        m_app.set_help_all_flag("--help-all", "Print this help and that of every subcommand, and exit");
        try {
            m_app.parse(argc, argv);
            return m_run();
        } catch (const CLI::ParseError& e) {
            if (e.get_exit_code() == 0) return m_app.exit(e);  // --help and --version
            return fail(what_is_wrong(e, m_app, argc, argv));
        } catch (const std::bad_alloc&) {
            return fail("not enough memory");
        } catch (const std::exception& e) {
            return fail(e.what());
        }
    }

  private:
    static int fail(const std::string& what) {
        std::cerr << "anamorph-figure: " << one_line(what) << "\n";
        return 1;
    }

    CLI::App* add_subcommand(const char* name, const char* what, std::function<int()> run) {
        CLI::App* sub = m_app.add_subcommand(name, what);
        sub->add_option(
               "SCRIPT", m_settings.source.path,
               "The script, or a motion (.bvh), a crystal structure (.cif) or frames (.3, .mrasel); - is the "
               "standard input: a script")
            ->required();
        static const std::map<std::string, Dialect> dialects{{"classic", Dialect::classic},
                                                             {"strict", Dialect::strict}};
        sub->add_option("--dialect", m_settings.source.dialect,
                        "classic: as the programs of 2003 ran scripts, but abut and touch end in exact "
                        "contact; strict: as the language is documented")
            ->transform(one_of(dialects))
            ->option_text("classic|strict [classic]");
        sub->add_option("--library", m_settings.source.libraries,
                        "A file of figures without stop, included ahead of the script; may be repeated")
            ->option_text("FILE ...")
            ->expected(1);
        sub->callback([this, run = std::move(run)] { m_run = run; });
        return sub;
    }

    void add_output(CLI::App* sub, const char* what) {
        sub->add_option("-o,--output", m_settings.output, what)->option_text("FILE [-]");
    }

    void add_frame_range(CLI::App* sub, const char* standard) {
        sub->add_option("--frame", m_settings.frames,
                        std::string("Which: N, N-M, N-MxSTEP, or all that the script shows") + standard)
            ->check(frame_range())
            ->option_text("RANGE");
    }

    /// An option of a row. The help says its range and its default.
    template <class Number>
    void add_number(CLI::App* sub, const char* name, Number& value, const NumberRow& row,
                    const std::string& what) {
        const std::string standard = std::isnan(row.standard) ? "" : " [" + shortest(row.standard) + "]";
        sub->add_option(name, value, what + ": " + row.range())
            ->check(number_of(row))
            ->option_text("NUMBER" + standard);
    }

    void add_check() {
        add_subcommand("check", "Say what is wrong with a script; exit status 1 where there are errors",
                       [this] { return check(); });
    }

    void add_frames() {
        CLI::App* sub = add_subcommand("frames", "Perform, and write frames as the original programs do (.3)",
                                       [this] { return write_frames(); });
        add_output(sub, "Where to; - is the standard output");
        add_frame_range(sub, " (the default)");
    }

    void add_picture(const std::string& format, const char* what) {
        CLI::App* sub = add_subcommand(format.c_str(), what, [this, format] { return draw_as(format); });
        if (format == "pdf")
            add_output(sub, "Where to; - is the standard output");
        else
            add_output(sub,
                       "Where to; - is the standard output. Of several frames: %04d or #### stands for the "
                       "number, which else goes before the ending");
        add_drawing(sub);
        DrawingOptions& d = m_settings.drawing;
        add_number(sub, "--size", m_settings.size, kSizeRow,
                   "Pixels (in PDF points) that the window of 1000 units is");
        add_number(sub, "--tol", d.tol, kDrawingTolRow, "Maximum chord error, in pixels");
        add_number(sub, "--line-width", d.line_width, kLineWidthRow, "Width of lines, in pixels");
        add_number(sub, "--halo", d.halo, kHaloRow,
                   "Gap on either side of a nearer line, in pixels; not at joints");
        sub->add_flag("--colors", d.colors, "Lines in the colors of the bodies");
        sub->add_flag("--fill", d.fill, "Bodies filled with their colors, from far to near");
    }

    void add_text() {
        CLI::App* sub = add_subcommand("text", "Draw outlines with characters, for a terminal", [this] {
            m_settings.size = text_size(m_settings.columns, m_settings.characters);
            m_settings.drawing.tol = 0.25;
            return draw_as("text");
        });
        add_output(sub, "Where to; - is the standard output");
        add_drawing(sub);
        add_number(sub, "--width", m_settings.columns, kColumnsRow, "Characters across the picture");
        static const std::map<std::string, Characters> characters{{"braille", Characters::braille},
                                                                  {"ascii", Characters::ascii}};
        sub->add_option("--characters", m_settings.characters, "Braille are 2 x 4 dots each, ascii 1 x 2")
            ->transform(one_of(characters))
            ->option_text("braille|ascii [braille]");
    }

    /// What all pictures have.
    void add_drawing(CLI::App* sub) {
        add_frame_range(sub, "; by default the first of those");
        add_view(sub);
        DrawingOptions& d = m_settings.drawing;
        static const std::map<std::string, HiddenLines> hidden{
            {"remove", HiddenLines::remove}, {"dash", HiddenLines::dash}, {"draw", HiddenLines::draw}};
        sub->add_option("--hidden", d.hidden, "What becomes of hidden lines; draw: bodies are transparent")
            ->transform(one_of(hidden))
            ->option_text("remove|dash|draw [remove]");
        static const std::map<std::string, Sticks> sticks{
            {"none", Sticks::none}, {"axes", Sticks::axes}, {"joints", Sticks::joints}};
        sub->add_option("--sticks", d.sticks,
                        "Instead of outlines: the longest axis of each body, or lines from joint to joint")
            ->transform(one_of(sticks))
            ->option_text("none|axes|joints [none]");
        static const std::map<std::string, OutlineStyle> styles(std::begin(kOutlineStyles),
                                                                std::end(kOutlineStyles));
        sub->add_option(
               "--outlines", d.style,
               "Instead of outlines: each figure as a dot, sticks, boxes or contours, the first that is "
               "within --simple-tol of these (Fetter); boxes; contours; elliptic cylinders (Willmert)")
            ->transform(one_of(styles))
            ->option_text("limbs|levels|boxes|contours|cylinders [limbs]");
        add_number(sub, "--simple-tol", d.simple_tol, kSimpleTolRow,
                   "How far levels and contours may be from outlines, in pixels");
        sub->add_flag("--crossings", d.crossings,
                      "Draw the curves, too, in which bodies pass through each other");
        add_number(sub, "--lod", d.lod, kLevelOfDetailRow,
                   "Bodies no wider, in pixels, are drawn as dots and lines");
        add_viewport(sub, "");
    }

    /// An option for each row of figures' looks.
    void add_look(CLI::App* sub) {
        for (const Parameter& row : figure_look_table()) {
            std::string what = row.documentation;
            const std::string row_name = "outline_tol";
            for (std::size_t at; (at = what.find(row_name)) != std::string::npos;)
                what.replace(at, row_name.size(), option_of(row_name));
            const bool is_number = row.type == ParameterType::number || row.type == ParameterType::whole;
            const bool is_file = row.type == ParameterType::file || row.type == ParameterType::image;
            std::string takes = is_number ? "NUMBER" : is_file ? "FILE" : "TEXT";
            if (row.type == ParameterType::choice) takes = row.accepted();
            if (!row.default_value.empty()) takes += " [" + row.default_value + "]";
            if (is_number) what += (row.unit.empty() ? "" : ", in " + row.unit) + ": " + row.accepted();
            sub->add_option_function<std::string>(
                   option_of(row.name),
                   [this, name = row.name](const std::string& text) {
                       with_options([&] { m_settings.own_look.set(name, text); });
                   },
                   what)
                ->option_text(takes);
        }
    }

    void add_viewport(CLI::App* sub, const std::string& of) {
        sub->add_option_function<std::string>(
               "--viewport", [this](const std::string& text) { m_settings.viewport = viewport_from(text); },
               of + "Draw within an ellipse only: its middle, from the upper left, and its half-axes in "
                    "shares of the picture's width and height, such as .5,.5,.5,.5")
            ->option_text("X,Y,A,B");
    }

    /// The viewport on a page; none where none was asked for.
    std::optional<Viewport> viewport_on(const glm::dvec2& page) const {
        if (!m_settings.viewport) return std::nullopt;
        return in_pixels(*m_settings.viewport, page, {0, 0});
    }

    /// How figures are seen, and on how many threads.
    void add_view(CLI::App* sub) {
        add_number(sub, "--perspective", m_settings.perspective, kPerspectiveRow,
                   "In perspective, seen from so many units before the middle of the window");
        sub->add_flag("--fit", m_settings.fit,
                      "The figures fill the picture; of several frames, those of all");
        add_number(sub, "--threads", m_settings.threads, kThreadsRow,
                   "Threads; 0 is as many as there are processors");
    }

    void add_film() {
        CLI::App* sub = add_subcommand("film", "Draw bodies in their colors, shaded, as a film by ffmpeg",
                                       [this] { return write_film(); });
        add_output(sub,
                   "Where to: a film by ffmpeg (.mp4, .mov, .mkv, .webm, .avi, .gif), or numbered pictures "
                   "(.png), which a film becomes where there is no ffmpeg");
        add_frame_range(sub, " (the default)");
        add_view(sub);
        add_number(sub, "--size", m_settings.size, kSizeRow, "Pixels that the window of 1000 units is");
        add_number(sub, "--fps", m_settings.frames_per_second, kFramesPerSecondRow,
                   "Frames a second; by default those of a .bvh file, 25 of scripts");
        static const std::map<std::string, FigureStyle> styles{{"shaded", FigureStyle::shaded},
                                                               {"outline", FigureStyle::outline},
                                                               {"stick", FigureStyle::stick},
                                                               {"textured", FigureStyle::textured}};
        sub->add_option(
               "--style", m_settings.look.style,
               "What is drawn; textured: shaded, with the pictures (.png, .ppm) beside the script that it "
               "names")
            ->transform(one_of(styles))
            ->option_text("shaded|textured|outline|stick [shaded]");
        add_viewport(sub, "Of styles outline and stick: ");
        static const std::map<std::string, Lighting> lightings{
            {"rasel", Lighting::rasel}, {"lambert", Lighting::lambert}, {"blinn", Lighting::blinn}};
        sub->add_option("--lighting", m_settings.look.light.lighting, "How bodies are shaded")
            ->transform(one_of(lightings))
            ->option_text("rasel|lambert|blinn [rasel]");
        add_look(sub);
        add_perturbation(sub);
    }

    void add_perturbation(CLI::App* sub) {
        add_number(sub, "--perturbation", m_settings.look.perturbation, kPerturbationRow,
                   "The most by which the light of a pixel is off at random, against contours");
        add_number(sub, "--seed", m_settings.look.seed, kSeedRow, "Seed of these random numbers");
    }

    void add_scene(const std::string& format, const char* what, const char* standard) {
        CLI::App* sub = add_subcommand(format.c_str(), what, [this, format] { return write_scene(format); });
        add_output(sub, "Where to; - is the standard output");
        add_frame_range(sub, standard);
        if (format != "vtp")
            add_number(sub, "--tol", m_settings.scene_tol, kSceneTolRow,
                       "Maximum distance of a body's triangles from its ellipsoid, in units of the window of "
                       "1000; by "
                       "default each has 2,208, within 0.5 % of its half-axes");
    }

    void add_ellipses(const std::string& format, const char* what) {
        CLI::App* sub = add_subcommand(format.c_str(), what, [this, format] {
            std::unique_ptr<Motion> motion;
            const FrameRange range = range_or("all");
            Progress progress([&] { return count_of(range, *motion); });
            motion = perform(progress);
            OutputFile file(m_settings.output);
            const ParallelFor parallel_for = threads_for(thread_count());
            range.for_each(*motion, [&](const FigureFrame& frame) {
                file.write(ellipse_text(ellipses_of(frame, format == "hide", parallel_for)));
                progress.advance();
            });
            file.close();
            return 0;
        });
        add_output(sub, "Where to; - is the standard output");
        add_frame_range(sub, " (the default)");
        add_number(sub, "--threads", m_settings.threads, kThreadsRow,
                   "Threads; 0 is as many as there are processors");
    }

    void add_plotel() {
        CLI::App* sub =
            m_app.add_subcommand("plotel", "Draw outlines as HIDE and VISIB write them (.2) as SVG");
        sub->add_option("FILE", m_settings.source.path, "Outlines; - is the standard input")->required();
        add_output(
            sub,
            "Where to; - is the standard output. Of several frames: %04d or #### stands for the number, "
            "which else goes before the ending");
        sub->add_option("--frame", m_settings.frames, "Which: N, N-M, N-MxSTEP, or all; by default the first")
            ->check(frame_range())
            ->option_text("RANGE");
        add_number(sub, "--size", m_settings.size, kSizeRow, "Pixels that the window of 1000 units is");
        add_number(sub, "--tol", m_settings.drawing.tol, kDrawingTolRow, "Maximum chord error, in pixels");
        sub->callback([this] { m_run = [this] { return plot(); }; });
    }

    int plot() const {
        const std::string& path = m_settings.source.path;
        const bool standard = path == "-";
        const std::optional<std::string> text =
            standard ? read_all(std::cin, "the standard input", text_file::kMostBytes)
                     : read_file(path, true, text_file::kMostBytes);
        if (!text) throw Error("cannot read " + path);
        const std::vector<EllipseFrame> frames = parse_ellipses(*text, standard ? "stdin" : path);
        if (frames.empty()) throw Error(path + " has no frame");
        // The first, whatever its number is.
        const int first = frames[0].number;
        const FrameRange range =
            m_settings.frames.empty() ? FrameRange{false, first, first} : range_or("all");
        const std::unique_ptr<DrawingWriter> out = writer("svg", range.several());
        bool any = false;
        for (const EllipseFrame& frame : frames) {
            if (!range.has(frame.number)) continue;
            if (any && !range.several()) break;  // one page has one frame
            out->add(plotted(frame, m_settings.size, m_settings.drawing.tol));
            any = true;
        }
        if (!any) throw Error("--frame", m_settings.frames, "must be a frame that " + path + " has");
        out->finish();
        return 0;
    }

    void add_picture_output(CLI::App* sub) {
        sub->add_option("-o,--output", m_picture.name, "Where to; - is the standard output")
            ->option_text("FILE [-]");
        sub->add_flag("--raw", m_picture.raw,
                      "Without the header of PPM: triples of bytes, row by row from the upper left");
    }

    void add_mrasel() {
        CLI::App* sub = m_app.add_subcommand(
            "mrasel",
            "Draw a frame of MRASEL from the standard input, 512 x 512 pixels, with the maps in this folder");
        add_picture_output(sub);
        sub->add_flag_callback(
            "--linear", [this] { m_settings.look.mapping = BodyMapping::linear; },
            "The linear mapping: stripes stay straight");
        static const std::map<std::string, TextureAverage> averages{
            {"mrasel", TextureAverage::mrasel},
            {"trilinear", TextureAverage::trilinear},
            {"summed_area", TextureAverage::summed_area},
            {"antialias", TextureAverage::footprint}};
        sub->add_option("--filter", m_average, "How maps are averaged")
            ->transform(one_of(averages))
            ->option_text("mrasel|trilinear|summed_area|antialias [mrasel]");
        add_perturbation(sub);
        add_number(sub, "--threads", m_settings.threads, kThreadsRow,
                   "Threads; 0 is as many as there are processors");
        sub->callback([this] {
            m_run = [this] {
                FigureLook look = m_settings.look;
                if (look.mapping != BodyMapping::linear) look.mapping = BodyMapping::mirrored;
                look.average = m_average;
                draw_mrasel(std::cin, look, m_picture, threads_for(thread_count()),
                            [](const std::string& what) {
                                std::cerr << "anamorph-figure: " << one_line(what) << "\n";
                            });
                return 0;
            };
        });
    }

    void add_mtexture() {
        CLI::App* sub = m_app.add_subcommand("mtexture",
                                             "Make MRASEL's maps NAME.512, NAME.256, ..., NAME.1 of 512 x "
                                             "512 triples of bytes, red, green and "
                                             "blue, from the standard input");
        sub->add_option("NAME", m_settings.word, "The maps' name")->required();
        sub->callback([this] {
            m_run = [this] {
                make_maps(std::cin, m_settings.word);
                return 0;
            };
        });
    }

    void add_showmap() {
        CLI::App* sub = m_app.add_subcommand(
            "showmap", "Show the maps NAME.256, ..., NAME.1 in one picture of 512 x 256 pixels");
        sub->add_option("NAME", m_settings.word, "The maps' name")->required();
        add_picture_output(sub);
        sub->callback([this] {
            m_run = [this] {
                show_maps(m_settings.word, m_picture);
                return 0;
            };
        });
    }

    void add_stats() {
        add_subcommand("stats", "Count what is in a script, and time its performance",
                       [this] { return write_stats(); });
    }

    void add_language() {
        CLI::App* sub =
            m_app.add_subcommand("language", "The words of the language: their operands, meanings, examples");
        sub->add_option("WORD", m_settings.word,
                        "One of them, which may be shortened; by default a list of all");
        sub->callback([this] {
            m_run = [this] {
                std::cout << language_page(m_settings.word);
                return 0;
            };
        });
    }

    /// Prints what the script prints, out of the progress bar's way.
    std::unique_ptr<Motion> perform(Progress& progress) const {
        PerformanceOptions options;
        options.message = [&progress](const std::string& line) {
            progress.clear();
            std::cerr << one_line(line) << "\n";
        };
        std::unique_ptr<Motion> motion = open_motion(m_settings.source, options);
        for (const std::string& warning : motion->warnings()) options.message(warning);
        return motion;
    }

    FrameRange range_or(const char* standard) const {
        return *parse_frame_range(m_settings.frames.empty() ? standard : m_settings.frames);
    }

    static int count_of(const FrameRange& range, Motion& motion) {
        try {
            return range.count(motion);
        } catch (const std::exception&) {
            return 0;  // what is wrong is told when the frame's turn comes
        }
    }

    int thread_count() const {
        return m_settings.threads > 0 ? m_settings.threads
                                      : std::max<int>(std::thread::hardware_concurrency(), 1);
    }

    int check() const {
        if (is_motion_file(m_settings.source.path)) {
            const std::unique_ptr<Motion> motion = open_motion(m_settings.source, {});
            for (const std::string& warning : motion->warnings()) std::cout << warning << "\n";
            return 0;
        }
        const Script script = read_script(m_settings.source);
        for (const Diagnostic& d : script.diagnostics) std::cout << d.text() << "\n";
        return script.ok() ? 0 : 1;
    }

    int write_frames() const {
        const FrameRange range = range_or("all");
        std::unique_ptr<Motion> motion;
        Progress progress([&] { return count_of(range, *motion); });
        motion = perform(progress);
        OutputFile file(m_settings.output);
        FigureFrame last;
        range.for_each(*motion, [&](const FigureFrame& frame) {
            file.write(frame_text(frame));
            last = frame;
            progress.advance();
        });
        file.write(frames_end_text(last));
        file.close();
        return 0;
    }

    std::unique_ptr<DrawingWriter> writer(const std::string& format, bool several) const {
        if (format == "pdf") return pdf_writer(m_settings.output);
        if (format == "text")
            return text_writer(m_settings.output, m_settings.columns, m_settings.characters);
        if (several && m_settings.output == "-")
            throw Error("--output=-: several frames as " + format + " need the name of a file");
        return format == "svg" ? svg_writer(m_settings.output, several)
                               : png_writer(m_settings.output, several);
    }

    View view_for(const FigureFrame& frame, const glm::dvec2& page) const {
        View view = view_in(frame, page);
        if (m_settings.perspective > 0) view.eye_distance = m_settings.perspective;
        return view;
    }

    /// What all frames of a range are in, where it is to be known.
    SeenExtent extent_of(const FrameRange& range, Motion& motion) const {
        SeenExtent extent;
        const glm::dvec2 page(m_settings.size);
        if (m_settings.fit)
            range.for_each(motion, [&](const FigureFrame& frame) {
                add_seen_extent(frame, view_for(frame, page), extent);
            });
        return extent;
    }

    Drawing drawing_of(const FigureFrame& frame, const SeenExtent& extent,
                       const ParallelFor& parallel_for) const {
        const glm::dvec2 page(m_settings.size);
        View view = view_for(frame, page);
        fit_view(view, extent, page);
        DrawingOptions options = m_settings.drawing;
        options.viewport = viewport_on(page);
        return draw(frame, view, page, options, parallel_for);
    }

    int draw_as(const std::string& format) {
        std::unique_ptr<Motion> motion;
        FrameRange range;
        Progress progress([&] { return count_of(range, *motion); });
        motion = perform(progress);
        range = range_or(std::to_string(motion->first_frame()).c_str());
        const std::unique_ptr<DrawingWriter> out = writer(format, range.several());
        const int threads = thread_count();
        const ParallelFor parallel_for = threads_for(threads);
        const SeenExtent extent = extent_of(range, *motion);
        std::vector<FigureFrame> batch;
        const auto draw_batch = [&] {
            std::vector<Drawing> drawings(batch.size());
            if (batch.size() == 1)
                drawings[0] = drawing_of(batch[0], extent, parallel_for);
            else
                parallel_for(static_cast<std::int64_t>(batch.size()), [&](std::int64_t i) {
                    const auto k = static_cast<std::size_t>(i);
                    drawings[k] = drawing_of(batch[k], extent, serial_for);
                });
            for (std::size_t i = 0; i < batch.size(); ++i) {
                std::vector<std::string> left_out;
                for (const int body : drawings[i].left_out)
                    left_out.push_back(batch[i].bodies[static_cast<std::size_t>(body)].name);
                tell_left_out(batch[i].number, left_out);
                out->add(drawings[i]);
                progress.advance();
            }
            batch.clear();
        };
        bool any = false;
        range.for_each(*motion, [&](const FigureFrame& frame) {
            any = true;
            batch.push_back(frame);
            if (batch.size() == 4 * static_cast<std::size_t>(threads)) draw_batch();
        });
        draw_batch();
        if (!any) throw Error(m_settings.source.path + " shows no frame");
        out->finish();
        return 0;
    }

    std::unique_ptr<FilmWriter> film_writer(int side, double frames_per_second) const {
        const std::string& name = m_settings.output;
        if (name == "-") throw Error("--output must be the name of a file");
        const std::filesystem::path path(name);
        if (path.extension() == ".png") return png_frames_writer(name, side, side);
        if (has_ffmpeg()) return ffmpeg_writer(name, side, side, frames_per_second);
        const std::string pictures = (path.parent_path() / path.stem()).string() + ".png";
        std::cerr << "anamorph-figure: ffmpeg is not there: frames become pictures, "
                  << numbered_name(pictures, 1) << " and so on\n";
        return png_frames_writer(pictures, side, side);
    }

    FilmFrame film_frame(const FigureFrame& frame, const SeenExtent& extent, int side,
                         const TextureFiles& textures, const ParallelFor& parallel_for) const {
        const glm::dvec2 page(side);
        View view = view_for(frame, page);
        fit_view(view, extent, page);
        FigureLook look = m_settings.look;
        look.lines.viewport = viewport_on(page);
        if (frame.bands.empty()) look.background = glm::dvec3(1.0);
        const FigurePicture picture(frame, view, {side, side}, look, parallel_for);
        tell_left_out(frame.number, picture.left_out());
        return {frame.number, picture_bytes(picture, look, {side, side}, textures.sources(), parallel_for)};
    }

    /// Heights that are asked for are there.
    static void add_heights(const std::string& file, TextureFiles& textures) {
        try {
            textures.add(file);
        } catch (const Error& error) {
            throw Error("--bump", printable(file),
                        "must be an image, .png or .ppm, that can be opened: " + std::string(error.what()));
        }
    }

    int write_film() {
        const FigureStyle style = m_settings.look.style;
        if (m_settings.viewport && style != FigureStyle::outline && style != FigureStyle::stick)
            throw Error("--viewport is of --style outline and stick alone");
        const ParameterValues& own = m_settings.own_look;
        with_options([&] {
            read_figure_relief(own, own.given("bump"), m_settings.look);
            read_figure_outlines(own, m_settings.look);
        });
        std::unique_ptr<Motion> motion;
        const FrameRange range = range_or("all");
        Progress progress([&] { return count_of(range, *motion); });
        motion = perform(progress);
        m_settings.look.light.toward = usual_light(m_settings.look.light.lighting);
        const int side = static_cast<int>(std::lround(m_settings.size));
        const double rate =
            m_settings.frames_per_second > 0 ? m_settings.frames_per_second : motion->frames_per_second();
        const SeenExtent extent = extent_of(range, *motion);
        const ParallelFor parallel_for = threads_for(thread_count());
        if (m_settings.look.style == FigureStyle::textured) m_settings.look.textures = motion->images();
        TextureFiles textures(m_settings.source.path, m_settings.look.textures, [](const std::string& what) {
            std::cerr << "anamorph-figure: " << one_line(what) << "\n";
        });
        if (own.given("bump")) add_heights(own.text("bump"), textures);
        std::unique_ptr<FilmWriter> out;
        range.for_each(*motion, [&](const FigureFrame& frame) {
            if (!out) out = film_writer(side, rate);
            out->add(film_frame(frame, extent, side, textures, parallel_for));
            progress.advance();
        });
        if (!out) throw Error(m_settings.source.path + " shows no frame");
        out->finish();
        return 0;
    }

    int write_scene(const std::string& format) const {
        const bool is_one = format != "gltf";
        std::unique_ptr<Motion> motion;
        FrameRange range;
        Progress progress([&] { return count_of(range, *motion); });
        motion = perform(progress);
        range = range_or(is_one ? std::to_string(motion->first_frame()).c_str() : "all");
        if (is_one && range.several())
            throw Error("--frame", m_settings.frames,
                        "must be one frame for " + std::string(format == "obj" ? "OBJ" : ".vtp"));
        std::vector<FigureFrame> frames;
        range.for_each(*motion, [&](const FigureFrame& frame) {
            frames.push_back(frame);
            progress.advance();
        });
        if (frames.empty()) throw Error(m_settings.source.path + " shows no frame");
        OutputFile file(m_settings.output);
        std::optional<double> tolerance;
        if (m_settings.scene_tol > 0) tolerance = m_settings.scene_tol;
        file.write(format == "obj"   ? obj_file(frames[0], tolerance)
                   : format == "vtp" ? vtp_file(frames[0])
                                     : glb_file(frames, motion->frames_per_second(), tolerance));
        file.close();
        return 0;
    }

    int write_stats() const {
        using Clock = std::chrono::steady_clock;
        const auto start = Clock::now();
        std::unique_ptr<Motion> motion;
        Progress progress([&] { return count_of(FrameRange{true}, *motion); });
        motion = perform(progress);
        const auto parsed = Clock::now();
        int frames = 0;
        motion->for_each_frame([&](const FigureFrame&) {
            ++frames;
            progress.advance();
            return true;
        });
        const auto performed = Clock::now();
        progress.clear();
        const auto say = [](const char* name, const std::string& value) {
            std::cout << name << std::string(15 - std::string_view(name).size(), ' ') << value << "\n";
        };
        const auto milliseconds = [](Clock::duration d) {
            return shortest(std::round(std::chrono::duration<double, std::micro>(d).count()) / 1000);
        };
        say("frames", std::to_string(frames));
        if (const auto* performance = dynamic_cast<const Performance*>(motion.get())) {
            const Program& p = performance->program();
            std::size_t actions = 0;
            for (const Subroutine& subroutine : p.subroutines) actions += subroutine.movements.size();
            say("figures", std::to_string(p.figures.size() - 2));  // without `every` and `world`
            say("ellipsoids", std::to_string(p.ellipsoids.size() - 1));
            say("joints", std::to_string(p.joints.size()));
            say("subroutines", std::to_string(p.subroutines.size() - 1));
            say("actions", std::to_string(actions));
        } else {
            const FigureFrame frame = motion->frame(0);
            say("figures", std::to_string(frame.figures.size()));
            say("ellipsoids", std::to_string(frame.bodies.size()));
            say("joints", std::to_string(frame.joints.size()));
        }
        say("parsed in", milliseconds(parsed - start) + " ms");
        say("performed in", milliseconds(performed - parsed) + " ms");
        return 0;
    }

    CLI::App m_app{"Scripts of NUDES, the animation language for figures of ellipsoids (Chapman 1986)",
                   "anamorph-figure"};
    Settings m_settings;
    PictureOutput m_picture;                            ///< of mrasel and showmap
    TextureAverage m_average = TextureAverage::mrasel;  ///< of mrasel
    std::function<int()> m_run;
};

int run(int argc, char** argv) {
    try {
        return Command().run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << "anamorph-figure: " << e.what() << "\n";
        return 1;
    }
}

}  // namespace
}  // namespace anamorph::command

int main(int argc, char** argv) {
    return anamorph::command::run(argc, argv);
}
