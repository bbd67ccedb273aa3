// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/elements.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace anamorph::figure {
namespace {

struct Named {
    std::string_view symbol;
    double radius;
};

// By atomic number, from 1.
constexpr Named kElements[] = {
    {"H", .31},   {"He", .28},  {"Li", 1.28}, {"Be", .96},  {"B", .84},   {"C", .76},   {"N", .71},
    {"O", .66},   {"F", .57},   {"Ne", .58},  {"Na", 1.66}, {"Mg", 1.41}, {"Al", 1.21}, {"Si", 1.11},
    {"P", 1.07},  {"S", 1.05},  {"Cl", 1.02}, {"Ar", 1.06}, {"K", 2.03},  {"Ca", 1.76}, {"Sc", 1.70},
    {"Ti", 1.60}, {"V", 1.53},  {"Cr", 1.39}, {"Mn", 1.39}, {"Fe", 1.32}, {"Co", 1.26}, {"Ni", 1.24},
    {"Cu", 1.32}, {"Zn", 1.22}, {"Ga", 1.22}, {"Ge", 1.20}, {"As", 1.19}, {"Se", 1.20}, {"Br", 1.20},
    {"Kr", 1.16}, {"Rb", 2.20}, {"Sr", 1.95}, {"Y", 1.90},  {"Zr", 1.75}, {"Nb", 1.64}, {"Mo", 1.54},
    {"Tc", 1.47}, {"Ru", 1.46}, {"Rh", 1.42}, {"Pd", 1.39}, {"Ag", 1.45}, {"Cd", 1.44}, {"In", 1.42},
    {"Sn", 1.39}, {"Sb", 1.39}, {"Te", 1.38}, {"I", 1.39},  {"Xe", 1.40}, {"Cs", 2.44}, {"Ba", 2.15},
    {"La", 2.07}, {"Ce", 2.04}, {"Pr", 2.03}, {"Nd", 2.01}, {"Pm", 1.99}, {"Sm", 1.98}, {"Eu", 1.98},
    {"Gd", 1.96}, {"Tb", 1.94}, {"Dy", 1.92}, {"Ho", 1.92}, {"Er", 1.89}, {"Tm", 1.90}, {"Yb", 1.87},
    {"Lu", 1.87}, {"Hf", 1.75}, {"Ta", 1.70}, {"W", 1.62},  {"Re", 1.51}, {"Os", 1.44}, {"Ir", 1.41},
    {"Pt", 1.36}, {"Au", 1.36}, {"Hg", 1.32}, {"Tl", 1.45}, {"Pb", 1.46}, {"Bi", 1.48}, {"Po", 1.40},
    {"At", 1.50}, {"Rn", 1.50}, {"Fr", 2.60}, {"Ra", 2.21}, {"Ac", 2.15}, {"Th", 2.06}, {"Pa", 2.00},
    {"U", 1.96},  {"Np", 1.90}, {"Pu", 1.87}, {"Am", 1.80}, {"Cm", 1.69}};

struct Colored {
    std::string_view symbol;
    glm::dvec3 color;
};
// What chemists expect (Corey, Pauling and Koltun).
constexpr Colored kUsual[] = {{"H", {235, 235, 235}}, {"C", {105, 105, 105}}, {"N", {50, 80, 230}},
                              {"O", {225, 30, 30}},   {"F", {130, 220, 80}},  {"Cl", {40, 200, 60}},
                              {"Br", {150, 50, 30}},  {"I", {130, 20, 150}},  {"S", {240, 210, 60}},
                              {"P", {250, 140, 20}}};

/// The others: hues as far apart as they can be for whatever elements are there.
glm::dvec3 color_of(std::size_t number) {
    const double golden = (std::sqrt(5) - 1) / 2;
    const double hue = 2 * std::numbers::pi * std::fmod(static_cast<double>(number) * golden, 1);
    const double third = 2 * std::numbers::pi / 3;
    return {160 + 70 * std::cos(hue), 160 + 70 * std::cos(hue - third), 160 + 70 * std::cos(hue + third)};
}

std::vector<ChemicalElement> make_elements() {
    std::vector<ChemicalElement> elements;
    for (std::size_t i = 0; i < std::size(kElements); ++i) {
        ChemicalElement element{kElements[i].radius, color_of(i + 1)};
        for (const Colored& usual : kUsual)
            if (usual.symbol == kElements[i].symbol) element.color = usual.color;
        elements.push_back(element);
    }
    return elements;
}

}  // namespace

const ChemicalElement* find_element(std::string_view symbol) {
    static const std::vector<ChemicalElement> elements = make_elements();
    if (symbol == "D") symbol = "H";
    for (std::size_t i = 0; i < std::size(kElements); ++i)
        if (kElements[i].symbol == symbol) return &elements[i];
    return nullptr;
}

}  // namespace anamorph::figure
