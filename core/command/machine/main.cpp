// SPDX-License-Identifier: Apache-2.0
// anamorph-machine: programs of pixel shaders assembled and run, and the schedule of the machine of 1987.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <set>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/machine/block_schedule.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/machine/machine_texture.h"
#include "anamorph/machine/shader_run.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"
#include "anamorph/version.h"
#include "misspelt_option.h"
#include "output_file.h"
#include "pfm.h"

namespace anamorph::command {
using namespace machine;
using namespace surface;
namespace {

/// What the command line says.
struct Settings {
    std::string program, output = "-", arithmetic = "float24", size = "512";
    std::vector<std::string> textures, constants;
    int weight_bits = 8;
    std::string machine = kBlockPreset, surface = "plane", picture = "512", deformations;
    bool frames = false;
};

/// At most kMostRead bytes.
std::string file_text(const std::string& name) {
    constexpr std::size_t kMostRead = std::size_t{1} << 28;
    std::error_code error;
    std::ifstream file;
    if (name != "-" && !std::filesystem::is_directory(name, error)) file.open(name, std::ios::binary);
    std::istream& in = name == "-" ? std::cin : file;
    if (name != "-" && !file.is_open()) throw Error(printable(name) + ": cannot be read");
    std::string text;
    char block[1 << 16];
    while (text.size() <= kMostRead && in.read(block, sizeof block).gcount() > 0)
        text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMostRead)
        throw Error(printable(name) + ": must be at most " + std::to_string(kMostRead >> 20) + " MB");
    return text;
}

/// The parts of "s0=FILE" or "c0=1,2,3,4": the register's number and `what` it is.
std::pair<int, std::string> assigned(const char* option, const std::string& text, char bank, int count,
                                     const char* what) {
    const std::size_t sign = text.find('=');
    std::string_view digits = std::string_view(text).substr(0, sign);
    double number = -1;
    const bool is_register = !digits.empty() && digits.front() == bank;
    if (is_register) digits.remove_prefix(1);
    if (!is_register || sign == std::string::npos || sign + 1 == text.size() ||
        !text_file::take_number(digits, number) || !digits.empty() || !(number >= 0 && number < count) ||
        number != static_cast<int>(number))
        throw Error(
            option, printable(text),
            std::string("must be ") + bank + "0 to " + bank + std::to_string(count - 1) + ", = and " + what);
    return {static_cast<int>(number), text.substr(sign + 1)};
}

/// "512" or "512x256".
Size size_of(const std::string& text, const char* option) {
    const std::size_t by = text.find('x');
    const auto side = [&](std::string_view part) {
        double value = 0;
        if (!text_file::take_number(part, value) || !part.empty() || !(value >= 1) ||
            value > FloatPicture::kMostSide || value != static_cast<int>(value))
            throw Error(option, printable(text),
                        "must be N or NxM, integers from 1 to " + std::to_string(FloatPicture::kMostSide));
        return static_cast<int>(value);
    };
    const std::string_view all = text;
    const int width = side(all.substr(0, by));
    return {width, by == std::string::npos ? width : side(all.substr(by + 1))};
}

/// Textures are as wide as high.
MachineTexture<4> read_texture(const std::string& name, int weight_bits) {
    const FloatPicture picture = parse_pfm(file_text(name), name);
    if (picture.width != picture.height)
        throw Error(printable(name) + ": is " + std::to_string(picture.width) + "x" +
                    std::to_string(picture.height) + ": a texture must be as wide as high");
    std::vector<MachineTexture<4>::Texel> texels;
    for (std::size_t i = 0; i < picture.values.size(); i += 3)
        texels.push_back({picture.values[i], picture.values[i + 1], picture.values[i + 2], 1});
    return {picture.width, weight_bits, std::move(texels)};
}

class Command {
  public:
    Command() {
        m_app.require_subcommand(1);
        m_app.set_version_flag("--version", "anamorph-machine " + std::string(version()));
        m_app.get_formatter()->column_width(34);
        CLI::App* assemble = add_subcommand("assemble", "Check a program, and write it as it was understood",
                                            [this] { this->assemble(); });
        assemble->add_option("PROGRAM", m_settings.program, "The program; - is the standard input")
            ->required();
        add_output(assemble);
        add_run();
        add_schedule();
    }

    int run(int argc, char** argv) {
        // After the subcommands, which else would have it as well.
        m_app.set_help_all_flag("--help-all", "Print this help and that of every subcommand, and exit");
        try {
            m_app.parse(argc, argv);
            m_run();
            return 0;
        } catch (const CLI::ParseError& e) {
            if (e.get_exit_code() == 0) return m_app.exit(e);  // --help and --version
            return fail(Error(what_is_wrong(e, m_app, argc, argv)));
        } catch (const std::exception& e) {
            return fail(e);
        }
    }

  private:
    static int fail(const std::exception& e) {
        std::cerr << "anamorph-machine: " << message_of(e, "the picture") << "\n";
        return 1;
    }

    CLI::App* add_subcommand(const char* name, const char* what, std::function<void()> run) {
        CLI::App* sub = m_app.add_subcommand(name, what);
        sub->callback([this, run = std::move(run)] { m_run = run; });
        return sub;
    }
    void add_output(CLI::App* sub) {
        sub->add_option("-o,--output", m_settings.output, "Where to; - is the standard output")
            ->option_text("FILE [-]");
    }

    void add_run() {
        CLI::App* sub =
            add_subcommand("run", "Run a program for every pixel, and write oC0 as a portable float map",
                           [this] { draw(); });
        sub->add_option("PROGRAM", m_settings.program, "The program; - is the standard input")->required();
        add_output(sub);
        sub->add_option("--size", m_settings.size, "Width and height, or both at once")
            ->option_text("NxM [512]");
        sub->add_option("--arithmetic", m_settings.arithmetic, "Numbers of all registers")
            ->option_text("float16|float24|float32|fixed16|fixed32 [float24]");
        sub->add_option("--weight-bits", m_settings.weight_bits, "Of textures: 0 to 23")
            ->check(CLI::Range(0, 23))
            ->option_text("NUMBER [8]");
        sub->add_option("--texture", m_settings.textures,
                        "s0=FILE and so on: a portable float map as wide as high; may be repeated")
            ->option_text("sN=FILE")
            ->expected(1)
            ->take_all();
        sub->add_option("--constant", m_settings.constants, "c0=1,2,3,4 and so on; may be repeated")
            ->option_text("cN=X,Y,Z,W")
            ->expected(1)
            ->take_all();
        sub->footer("t0 to t7 are (x, y, 0, 1), from 0 to 1 over the picture, x right, y down.");
    }

    void add_schedule() {
        CLI::App* sub = add_subcommand(
            "schedule",
            "What a frame of the machine of 1987 costs, stage by stage: a table, or a timeline (.svg)",
            [this] { schedule(); });
        add_output(sub);
        sub->add_flag("--frames", m_settings.frames,
                      "The first frames, a line each: when they are drawn and shown, and how late");
        sub->add_option("--machine", m_settings.machine, "Its parameters, as in recipes of .drape")
            ->option_text("TEXT [oka-1987]");
        sub->add_option("--surface", m_settings.surface, "That the picture lies on, in front of the camera")
            ->option_text("NAME [plane]");
        sub->add_option("--deformations", m_settings.deformations,
                        "A list of bumps that move the surface, as .drape reads it")
            ->option_text("FILE");
        sub->add_option("--picture", m_settings.picture, "Width and height of the picture")
            ->option_text("NxM [512]");
        sub->add_option("--size", m_settings.size, "Width and height of the screen")
            ->option_text("NxM [512]");
    }

    void schedule() const {
        const BlockMachine machine = block_machine_from_text(m_settings.machine);
        const auto& names = surface_names();
        const auto found = std::find(names.begin(), names.end(), m_settings.surface);
        if (found == names.end()) {
            std::string known;
            for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
            throw Error("--surface", printable(m_settings.surface), "must be one of " + known);
        }
        const Size screen = size_of(m_settings.size, "--size"),
                   picture = size_of(m_settings.picture, "--picture");
        SurfaceShape shape;
        shape.aspect = double(picture.width) / picture.height;
        // The flat picture fills the width, as it does by default in .drape.
        CameraPose pose;
        pose.position = {0, 0, shape.aspect / (2 * std::tan(pose.fov * (kPi / 360)))};
        const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), screen);
        SurfaceSum sum{.parts = {{static_cast<std::size_t>(found - names.begin())}}, .shape = shape};
        if (!m_settings.deformations.empty())
            sum.deformations =
                parse_deformations_file(file_text(m_settings.deformations), m_settings.deformations);
        const BlockFrame frame =
            MachineBlocks(machine, make_surface(sum), camera, picture).draw_all(serial_for);
        const MachineSchedule made = schedule_of(machine, frame.counts, cost_of(sum), picture, screen);
        write(text_file::ends_with(m_settings.output, ".svg") ? schedule_svg(made)
              : m_settings.frames                             ? schedule_frames_csv(made)
                                                              : schedule_csv(made));
    }

    void write(const std::string& text) const {
        OutputFile file(m_settings.output);
        file.write(text);
        file.close();
    }
    ShaderProgram read_program() const {
        return assemble_shader(file_text(m_settings.program), m_settings.program);
    }

    void assemble() const {
        const ShaderProgram program = read_program();
        write(shader_listing(program) + "; " + std::to_string(program.arithmetic) + " of " +
              std::to_string(ShaderProgram::kMostArithmetic) + " slots of arithmetic instructions, " +
              std::to_string(program.texture) + " of " + std::to_string(ShaderProgram::kMostTexture) +
              " texture instructions\n");
    }

    void draw() const {
        const NumberFormat format = number_format_from_name(
            m_settings.arithmetic, "--arithmetic", {kFloat16, kFloat24, kFloat32, kFixed16, kFixed32});
        const ShaderProgram program = read_program();
        std::map<int, MachineTexture<4>> textures;
        for (const std::string& text : m_settings.textures) {
            const auto [number, name] =
                assigned("--texture", text, 's', ShaderProgram::kSamplers, "the name of a file");
            if (!textures.emplace(number, read_texture(name, m_settings.weight_bits)).second)
                throw Error("--texture", printable(text), "is given twice: must be given once");
        }
        for (int n = 0; n < ShaderProgram::kSamplers; ++n)
            if ((program.samplers >> n & 1) && !textures.count(n))
                throw Error("--texture: s" + std::to_string(n) + " is declared and must be given");
        const FloatPicture picture =
            with_format(format, [&](auto number) { return drawn<decltype(number)>(program, textures); });
        write(pfm_of(picture));
    }

    template <class T>
    ShaderInputs<T> inputs_of(const ShaderProgram& program) const {
        ShaderInputs<T> inputs(program);
        std::set<int> given;
        for (const std::string& text : m_settings.constants) {
            const auto [number, list] =
                assigned("--constant", text, 'c', ShaderProgram::kConstants, "four numbers");
            const std::vector<std::string_view> fields = text_file::fields_of(list);
            if (fields.size() != 4) throw Error("--constant", printable(text), "must have four numbers");
            const auto n = static_cast<std::size_t>(number);
            if (inputs.defines(n))
                throw Error("--constant", printable(text), "must be none that the program defines");
            if (!given.insert(number).second)
                throw Error("--constant", printable(text), "is given twice: must be given once");
            std::array<double, 4> value{};
            for (std::size_t i = 0; i < 4; ++i) {
                std::string_view field = fields[i];
                if (!text_file::take_number(field, value[i]) || !field.empty() || !std::isfinite(value[i]))
                    throw Error("--constant", printable(text), "must be finite numbers");
            }
            inputs.give(n, value);
        }
        return inputs;
    }

    template <class T>
    FloatPicture drawn(const ShaderProgram& program, const std::map<int, MachineTexture<4>>& textures) const {
        const Size size = size_of(m_settings.size, "--size");
        FloatPicture picture{size.width, size.height, {}};
        ShaderInputs<T> inputs = inputs_of<T>(program);
        const auto sample = [&](int number, const T& u, const T& v) {
            const MachineTexture<4>& texture = textures.at(number);
            return texture.read<T>(u.value * texture.size(), v.value * texture.size());
        };
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) {
                inputs.coordinates.fill(
                    {T((x + 0.5) / size.width), T((y + 0.5) / size.height), T(0.0), T(1.0)});
                const ShaderVector<T> color = ShaderMachine<T>(program, inputs).run(sample);
                for (std::size_t c = 0; c < 3; ++c)
                    picture.values.push_back(static_cast<float>(color[c].value));
            }
        return picture;
    }

    CLI::App m_app{"The hardware of 2003: programs of pixel shaders 2.0, assembled and run",
                   "anamorph-machine"};
    Settings m_settings;
    std::function<void()> m_run;
};

}  // namespace
}  // namespace anamorph::command

int main(int argc, char** argv) {
    return anamorph::command::Command().run(argc, argv);
}
