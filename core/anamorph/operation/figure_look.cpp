// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/figure_look.h"

#include <string>
#include <utility>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/image/solid_texture.h"
#include "anamorph/formula/solid_program.h"
#include "anamorph/operation/rows.h"

namespace anamorph {
namespace {

std::vector<rows::Word> outline_words() {
    std::vector<rows::Word> words;
    for (const auto& [word, style] : figure::kOutlineStyles) words.emplace_back(word, style);
    return words;
}

/// Colors by formulas; of a text that is given for other values of solid nothing is kept in silence.
void read_solid(const ParameterValues& values, figure::FigureLook& look) {
    const std::string solid = values.text("solid");
    for (const char* name : {"red", "green", "blue", "let"})
        if (solid != "formula" && values.given(name))
            throw Error(name, printable(values.text(name)), "is of solid=formula alone");
    const bool shaded =
        look.style == figure::FigureStyle::shaded || look.style == figure::FigureStyle::textured;
    for (const char* name : {"solid", "bump"})
        if (!shaded && values.given(name))
            throw Error(name, printable(values.text(name)), "is of styles shaded and textured alone");
    for (const char* name : {"solid_scale", "solid_samples"})
        if (solid == "none" && values.given(name))
            throw Error(name, printable(values.text(name)), "must be given with solid");
    if (solid == "none") return;
    figure::SolidLook own;
    for (const figure::SolidPreset& preset : figure::solid_presets())
        if (preset.name == solid) own.text = preset.text;
    for (const auto& [name, to] : {std::pair{"red", &own.text.red}, std::pair{"green", &own.text.green},
                                   std::pair{"blue", &own.text.blue}, std::pair{"let", &own.text.let}})
        if (values.given(name)) *to = values.text(name);
    own.scale = values.number("solid_scale");
    own.samples = values.whole("solid_samples");
    if (!look.antialias) own.samples = 1;
    // What is wrong with a text is said before a frame is drawn.
    parse_solid(own.text, {});
    look.solid = own;
}

}  // namespace

ParameterTable figure_relief_rows() {
    using namespace rows;
    std::vector<std::string> names = {"none"};
    std::string what =
        "of styles shaded and textured, a color at every point of a body, as if it were cut out of a block: "
        "none";
    for (const figure::SolidPreset& preset : figure::solid_presets()) {
        names.push_back(preset.name);
        what += "; " + preset.name + ", " + preset.documentation;
    }
    names.push_back("formula");
    return {
        choice("solid", "none", names, what + "; formula, by red, green and blue"),
        number("solid_scale", "units", "100", 0.001, 1e6, "the length that formulas of solid call scale"),
        whole("solid_samples", "", "4", 1, figure::kMostSolidSamples,
              "of solid: a pixel's color is the mean at this number of points of it either way; what is "
              "finer is not "
              "averaged away"),
        text("red",
             "of solid=formula, a formula of x, y and z, the point in the body's own axes from its centre, "
             "in units, of "
             "own_red, own_green and own_blue, the body's color, from 0 to 1 as the result is, of scale and "
             "of frame; "
             "own_red by default"),
        text("green", "the same; own_green by default"),
        text("blue", "the same; own_blue by default"),
        text("let", "definitions before these, as in k=0.3;c=cos(k)"),
        image("bump",
              "of styles shaded and textured: a picture of heights around each body, by mapping: the "
              "brightness, the mean "
              "of up to three channels, turns normals (Blinn 1978)"),
        number("bump_scale", "units", "10", -1e6, 1e6, "how high brightness 1 is"),
    };
}

ParameterTable figure_outline_rows() {
    using namespace rows;
    return {
        enumeration("outlines", "limbs", outline_words(),
                    "of style outline: limbs, the outlines of bodies; levels, each figure as a dot, sticks, "
                    "boxes or contours, the "
                    "first that is within outline_tol of these (Fetter); boxes; contours, across each body's "
                    "longest axis, as few "
                    "as hold outline_tol; cylinders, with shadow lines, circular arcs, clip and crease, "
                    "nothing hidden (Willmert)"),
        number("outline_tol", "pixels", shortest(figure::kSimpleTolRow.standard), figure::kSimpleTolRow.least,
               figure::kSimpleTolRow.most,
               "of outlines=levels and contours: how far what stands for bodies may be from their outlines"),
    };
}

const ParameterTable& figure_look_table() {
    static const ParameterTable table = [] {
        ParameterTable rows = figure_relief_rows();
        const ParameterTable more = figure_outline_rows();
        rows.insert(rows.end(), more.begin(), more.end());
        return rows;
    }();
    return table;
}

void read_figure_relief(const ParameterValues& values, bool heights, figure::FigureLook& look) {
    read_solid(values, look);
    if (!heights && values.given("bump_scale"))
        throw Error("bump_scale", printable(values.text("bump_scale")), "must be given with bump");
    look.bumps = heights;
    look.bump_scale = values.number("bump_scale");
}

void read_figure_outlines(const ParameterValues& values, figure::FigureLook& look) {
    look.lines.style = rows::chosen<figure::OutlineStyle>(values, "outlines");
    look.lines.simple_tol = values.number("outline_tol");
    if (look.style != figure::FigureStyle::outline && values.given("outlines"))
        throw Error("outlines", values.text("outlines"), "is of style outline alone");
    if (!figure::holds_tolerance(look.lines.style) && values.given("outline_tol"))
        throw Error("outline_tol", printable(values.text("outline_tol")),
                    "must be given with outlines=levels or outlines=contours");
}

}  // namespace anamorph
