// SPDX-License-Identifier: Apache-2.0
// Crystals expanded by the operations of symmetry that a file lists.
#include "anamorph/figure/files/cif_symmetry.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <set>

#include "anamorph/error.h"
#include "anamorph/figure/files/motion_file.h"

namespace anamorph::test_cif_symmetry {
using namespace figure;
namespace {

using testing::HasSubstr;

std::string cell_text(double a, double b, double c, double alpha, double beta, double gamma) {
    std::string text = "data_x\n";
    const char* names[] = {"length_a", "length_b", "length_c", "angle_alpha", "angle_beta", "angle_gamma"};
    const double values[] = {a, b, c, alpha, beta, gamma};
    for (int i = 0; i < 6; ++i)
        text += std::string("_cell_") + names[i] + " " + std::to_string(values[i]) + "\n";
    return text;
}

std::string operations_text(const std::vector<std::string>& operations,
                            const std::string& tag = "_symmetry_equiv_pos_as_xyz") {
    std::string text = "loop_\n" + tag + "\n";
    for (const std::string& operation : operations) text += "'" + operation + "'\n";
    return text;
}

std::string atoms_text(const std::string& rows) {
    return "loop_\n_atom_site_label _atom_site_fract_x _atom_site_fract_y _atom_site_fract_z\n" + rows;
}

FigureFrame frame_of(const std::string& text) {
    return read_motion(text, "test.cif")->frame(1);
}

/// Where bodies are, in units of the file: frames are scaled by one number, moved, and have z turned around.
std::vector<glm::dvec3> places_of(const FigureFrame& frame, double scale) {
    std::vector<glm::dvec3> places;
    for (const Body& body : frame.bodies) {
        const glm::dvec3 p = (body.shape.center - frame.bodies[0].shape.center) / scale;
        places.push_back({p.x, p.y, -p.z});
    }
    return places;
}

std::string error_of(const std::string& text) {
    try {
        frame_of(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(CrystalSymmetry, OperationsAreRead) {
    const glm::dvec3 p(.1, .22, .37);
    const auto at = [&](const char* text) { return symmetry_operation(text)(p); };
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-15; };
    EXPECT_TRUE(near(at("x,y,z"), p));
    EXPECT_TRUE(near(at(" -X , 1/2+Y, -z "), {-.1, .72, -.37}));
    EXPECT_TRUE(near(at("-y,x-y,z+1/3"), {-.22, .1 - .22, .37 + 1. / 3}));
    EXPECT_TRUE(near(at("+x-1/4,.5-y,z+0.75"), {.1 - .25, .5 - .22, 1.12}));
    EXPECT_TRUE(near(at("y+x+1/6-1,-1*x,1z"), {.32 + 1. / 6 - 1, -.1, .37}));
    for (const char* text :
         {"", "x", "x,y", "x,y,", "x,y,z,x", "x,y,q", "x,y,z+", "x,y,1/", "x,y,1/0+z", "x,y,2*", "x,y,x",
          "2x,y,z", "x,y,zz", "x,y,z1/2", "x,y,--z", "x,y,nan", "x,y,1e999+z", "x,,z"})
        EXPECT_THROW(symmetry_operation(text), Error) << text;
}

TEST(CrystalSymmetry, FillsTheCell) {
    // P 21/c: what its four operations make of random atoms, in whichever cell.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> part;
    const std::vector<std::string> operations = {"x,y,z", "-x,y+1/2,-z+1/2", "-x,-y,-z", "x,-y+1/2,z+1/2"};
    const double a = 31, b = 37, c = 41, beta = 103 * std::numbers::pi / 180;
    const auto angstrom = [&](const glm::dvec3& p) {
        return glm::dvec3(a * p.x + c * std::cos(beta) * p.z, b * p.y, c * std::sin(beta) * p.z);
    };
    std::vector<glm::dvec3> atoms;
    std::string rows;
    for (int i = 0; i < 5; ++i) {
        atoms.push_back({part(random), part(random), part(random)});
        // No element: no bonds.
        rows += "Q" + std::to_string(i) + " " + std::to_string(atoms[i].x) + " " +
                std::to_string(atoms[i].y) + " " + std::to_string(atoms[i].z) + "\n";
    }
    const FigureFrame frame =
        frame_of(cell_text(a, b, c, 90, 103, 90) + operations_text(operations) + atoms_text(rows));
    ASSERT_EQ(frame.bodies.size(), 20u);
    EXPECT_TRUE(frame.joints.empty());
    const double scale = glm::distance(frame.bodies[0].shape.center, frame.bodies[1].shape.center) /
                         glm::distance(angstrom(atoms[0]), angstrom(atoms[1]));
    const std::vector<glm::dvec3> places = places_of(frame, scale);
    std::set<std::size_t> found;
    for (const glm::dvec3& p : atoms)
        for (const glm::dvec3& q :
             {p, glm::dvec3(-p.x, p.y + .5, .5 - p.z), -p, glm::dvec3(p.x, .5 - p.y, p.z + .5)}) {
            const glm::dvec3 wanted = angstrom(q - glm::floor(q)) - angstrom(atoms[0]);
            for (std::size_t i = 0; i < places.size(); ++i)
                if (glm::distance(places[i], wanted) < 1e-3) found.insert(i);
        }
    EXPECT_EQ(found.size(), 20u);
    EXPECT_EQ(frame.bodies[0].name, "Q0");
    EXPECT_EQ(frame.bodies[5].name, "Q0_2");
    // All of it is in the window.
    for (const Body& body : frame.bodies)
        for (int k = 0; k < 2; ++k) {
            EXPECT_GE(body.shape.center[k], 50);
            EXPECT_LE(body.shape.center[k], 950);
        }
}

TEST(CrystalSymmetry, DisplacementsTurnWithTheAtoms) {
    // A fourfold axis along c takes (x, y, z) to (-y, x, z): U11 and U22 change places, U13 becomes U23.
    const std::string text = cell_text(10, 10, 12, 90, 90, 90) + operations_text({"x,y,z", "-y,x,z"}) +
                             atoms_text("Q .2 .1 .3\n") +
                             "loop_\n_atom_site_aniso_label\n_atom_site_aniso_U_11\n_atom_site_aniso_U_22\n"
                             "_atom_site_aniso_U_33\n_atom_site_aniso_U_12\n_atom_site_aniso_U_13\n"
                             "_atom_site_aniso_U_23\nQ .02 .05 .03 .004 .006 -.003\n";
    const FigureFrame frame = frame_of(text);
    ASSERT_EQ(frame.bodies.size(), 2u);
    const auto tensor = [&](int body) {
        const Ellipsoid& e = frame.bodies[static_cast<std::size_t>(body)].shape;
        const glm::dmat3 axes(e.axes.x, 0, 0, 0, e.axes.y, 0, 0, 0, e.axes.z), half = e.rotation * axes;
        return half * glm::transpose(half);
    };
    const glm::dmat3 first = tensor(0), second = tensor(1);
    const double unit = first[0][0] / .02;
    EXPECT_NEAR(second[0][0] / unit, .05, 1e-9);
    EXPECT_NEAR(second[1][1] / unit, .02, 1e-9);
    EXPECT_NEAR(second[2][2] / unit, .03, 1e-9);
    // Of what is seen in the mirror along z.
    EXPECT_NEAR(second[0][1] / unit, -.004, 1e-9);
    EXPECT_NEAR(second[1][2] / unit, -.006, 1e-9);
    EXPECT_NEAR(second[0][2] / unit, -.003, 1e-9);
    for (const Body& body : frame.bodies) EXPECT_NEAR(glm::determinant(body.shape.rotation), 1, 1e-12);
}

TEST(CrystalSymmetry, MoleculesAreWhole) {
    // Half of a ring of six about an inversion in the corner of the cell, which cuts it into eight.
    const double r = 1.4;
    std::string rows;
    for (int i = 0; i < 3; ++i)
        rows += "C" + std::to_string(i + 1) + " " +
                std::to_string(r * std::cos(i * std::numbers::pi / 3) / 9) + " " +
                std::to_string(r * std::sin(i * std::numbers::pi / 3) / 9) + " 0\n";
    for (const char* const other : {"-x,-y,-z", "1-x,1-y,-z", "2-x,-y-3,4-z"}) {
        const FigureFrame frame =
            frame_of(cell_text(9, 9, 9, 90, 90, 90) + operations_text({"x,y,z", other}) + atoms_text(rows));
        ASSERT_EQ(frame.bodies.size(), 6u);
        EXPECT_EQ(frame.joints.size(), 6u);
        const std::vector<glm::dvec3> places = places_of(frame, 1);
        const double side = glm::length(places[1]);
        for (const Joint& joint : frame.joints)
            EXPECT_NEAR(glm::distance(places[static_cast<std::size_t>(joint.first)],
                                      places[static_cast<std::size_t>(joint.second)]),
                        side, 1e-4 * side);
    }
}

TEST(CrystalSymmetry, AtomsInSpecialPositionsAreThereOnce) {
    const auto count = [](const std::string& rows, const std::vector<std::string>& operations) {
        return frame_of(cell_text(20, 20, 20, 90, 90, 90) + operations_text(operations) + atoms_text(rows))
            .bodies.size();
    };
    EXPECT_EQ(count("Q 0 0 0\n", {"x,y,z", "-x,-y,-z"}), 1u);
    EXPECT_EQ(count("Q .5 0 .5\n", {"x,y,z", "-x,-y,-z"}), 1u);
    // As files round it.
    EXPECT_EQ(count("Q .3333 .6667 0\n", {"x,y,z", "-y,x-y,z", "y-x,-x,z"}), 1u);
    EXPECT_EQ(count("Q .5 .1 .5\n", {"x,y,z", "-x,-y,-z"}), 2u);
    // The identity may be left out, or stand anywhere.
    EXPECT_EQ(count("Q .1 .1 .5\n", {"-x,-y,-z"}), 2u);
    EXPECT_EQ(count("Q .1 .1 .5\n", {"-x,-y,-z", "x,y,z"}), 2u);
}

TEST(CrystalSymmetry, NetworksFillTheCell) {
    // Diamond: every atom is bonded to four, without end.
    std::vector<std::string> operations;
    for (const char* rest : {"", "+1/4"})
        for (const char* by : {"x,y,z", "x,y+1/2,z+1/2", "x+1/2,y,z+1/2", "x+1/2,y+1/2,z"}) {
            std::string operation = by;
            for (std::size_t at = operation.find(','); at != std::string::npos;
                 at = operation.find(',', at + 1)) {
                operation.insert(at, rest);
                at += std::string(rest).size();
            }
            operations.push_back(operation + rest);
        }
    const FigureFrame frame =
        frame_of(cell_text(3.567, 3.567, 3.567, 90, 90, 90) +
                 operations_text(operations, "_space_group_symop_operation_xyz") + atoms_text("C 1 -2 0\n"));
    ASSERT_EQ(frame.bodies.size(), 8u);
    glm::dvec3 least(HUGE_VAL), most(-HUGE_VAL);
    for (const Body& body : frame.bodies) {
        least = glm::min(least, body.shape.center);
        most = glm::max(most, body.shape.center);
    }
    // From 0 to 3/4 of the cell each way.
    const double edge = (most.x - least.x) / .75;
    EXPECT_NEAR((most.y - least.y) / .75, edge, 1e-6 * edge);
    EXPECT_NEAR((most.z - least.z) / .75, edge, 1e-6 * edge);
    // Bonds that do not leave the cell: four of the atom at 1/4,1/4,1/4, and one of each other with 3/4.
    EXPECT_EQ(frame.joints.size(), 7u);
}

TEST(CrystalSymmetry, AFileWithoutOperationsIsAsItIs) {
    const std::string cell = cell_text(9, 9, 9, 90, 90, 90),
                      atoms = atoms_text("C1 .01 .5 .5\nC2 .99 .5 .5\n");
    EXPECT_TRUE(frame_of(cell + atoms).joints.empty());
    EXPECT_TRUE(frame_of(cell + operations_text({"x,y,z"}) + atoms).joints.empty());
    EXPECT_EQ(frame_of(cell + "_symmetry_equiv_pos_as_xyz ?\n" + atoms).bodies.size(), 2u);
}

TEST(CrystalSymmetry, OfAModulatedStructureTheAverageIsShown) {
    // The operations of CeSi2, I2/b(a b 0)00, as drawxtl's cesi182.cif lists them, and without the fourth dimension.
    const std::string cell = cell_text(4.18, 4.19, 13.85, 90, 90, 90),
                      atoms = atoms_text("Ce .1 .2 .1067\nSi1 .05 .25 .2925\n"),
                      modulated = operations_text(
                          {"x1,x2,x3,x4", "-x1,1/2-x2,x3,-x4", "-x1,-x2,-x3,-x4", "x1,1/2+x2,-x3,x4",
                           "1/2+x1,1/2+x2,1/2+x3,x4", "1/2-x1,-x2,1/2+x3,-x4", "1/2-x1,1/2-x2,1/2-x3,-x4",
                           "1/2+x1,x2,1/2-x3,x4"},
                          "_space_group_symop_ssg_operation_algebraic"),
                      average = operations_text({"x,y,z", "-x,1/2-y,z", "-x,-y,-z", "x,1/2+y,-z",
                                                 "1/2+x,1/2+y,1/2+z", "1/2-x,-y,1/2+z", "1/2-x,1/2-y,1/2-z",
                                                 "1/2+x,y,1/2-z"});
    const FigureFrame frame = frame_of(cell + modulated + atoms), wanted = frame_of(cell + average + atoms);
    ASSERT_EQ(frame.bodies.size(), 16u);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(frame.bodies[i].shape, wanted.bodies[i].shape) << i;
    EXPECT_THAT(
        error_of(cell + operations_text({"x4,x2,x3,x1"}, "_space_group_symop_ssg_operation_algebraic") +
                 atoms),
        HasSubstr("must be three sums"));
}

TEST(CrystalSymmetry, SaysWhatIsWrong) {
    const std::string cell = cell_text(9, 9, 9, 90, 90, 90), atoms = atoms_text("C1 .01 .5 .5\n");
    EXPECT_EQ(
        error_of(cell + operations_text({"x,y,z", "x,y,q"}) + atoms),
        "test.cif: line 11: _symmetry_equiv_pos_as_xyz: \"x,y,q\": must be three sums of x, y, z and numbers "
        "that keep volumes, such as -x,1/2+y,-z");
    std::vector<std::string> many(1001, "x,y,z");
    EXPECT_THAT(error_of(cell + operations_text(many) + atoms), HasSubstr("must have up to 1000 values"));
    // Many in one place, and more than are drawn.
    many.clear();
    for (int i = 0; i < 1000; ++i) many.push_back("x+" + std::to_string(i) + "/1000,y,z");
    std::string rows;
    for (int i = 0; i < 21; ++i) rows += "Q .5 ." + std::to_string(10 + i) + " .5\n";
    EXPECT_THAT(error_of(cell_text(1e6, 9, 9, 90, 90, 90) + operations_text(many) + atoms_text(rows)),
                HasSubstr("symmetry makes more than 20000 atoms"));
    rows.clear();
    for (int i = 0; i < 1500; ++i) rows += "U 0 0 0\n";
    EXPECT_THAT(error_of(cell_text(.1, .1, .1, 90, 90, 90) + operations_text({"x,y,z", "-x,y,z+1/3"}) +
                         atoms_text(rows)),
                HasSubstr("over 500000 bonds"));
}

// --- Groups that are named alone -----------------------------------------------------------------------------

/// Places of bodies in fractions of a cell, from 0 to 1, sorted.
std::vector<std::string> places_text(const std::string& text) {
    std::vector<std::string> names;
    for (const Body& body : frame_of(text).bodies) {
        const auto& c = body.shape.center;
        char line[100];
        std::snprintf(line, sizeof line, "%.6f %.6f %.6f", c.x, c.y, c.z);
        names.push_back(line);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> warnings_of(const std::string& text) {
    return read_motion(text, "test.cif")->warnings();
}

const std::string kQuartzCell = cell_text(4.9134, 4.9134, 5.4052, 90, 90, 120);
const std::string kQuartzAtoms = atoms_text("Si .4697 0 .6666667\nO .4135 .2669 .7858\n");

TEST(CrystalSymmetry, GroupsAreExpandedByTheirNames) {
    // Quartz, with the operations of P 32 2 1 as the International Tables list them.
    const std::vector<std::string> listed =
        places_text(kQuartzCell +
                    operations_text({"x,y,z", "-y,x-y,z+2/3", "-x+y,-x,z+1/3", "y,x,-z", "x-y,-y,-z+1/3",
                                     "-x,-x+y,-z+2/3"}) +
                    kQuartzAtoms);
    ASSERT_EQ(listed.size(), 9u);
    for (const char* name :
         {"_symmetry_space_group_name_H-M 'P 32 2 1'", "_space_group_name_H-M_alt 'P3221'",
          "_symmetry_space_group_name_H-M 'P 3_2 2 1'", "_space_group_name_Hall 'P 32 2\"'",
          "_symmetry_Int_Tables_number 154", "_space_group_IT_number 154",
          "_symmetry_space_group_name_H-M 'P 32 2 1'\n_symmetry_Int_Tables_number 154\nloop_\n"
          "_symmetry_equiv_pos_as_xyz\n?"}) {
        const std::string text = kQuartzCell + std::string(name) + "\n" + kQuartzAtoms;
        EXPECT_EQ(places_text(text), listed) << name;
        EXPECT_TRUE(warnings_of(text).empty()) << name;
    }
    // Operations that are listed come first.
    EXPECT_EQ(frame_of(kQuartzCell + "_symmetry_space_group_name_H-M 'P 32 2 1'\n" +
                       operations_text({"x,y,z", "-x,-y,-z"}) + kQuartzAtoms)
                  .bodies.size(),
              4u);
}

TEST(CrystalSymmetry, BlanksOfHallSymbolsCount) {
    const auto bodies = [](const std::string& hall) {
        return frame_of(cell_text(15, 15, 21, 90, 90, 120) + "_space_group_name_Hall '" + hall + "'\n" +
                        atoms_text("Q .11 .23 .37\n"))
            .bodies.size();
    };
    EXPECT_EQ(bodies("P 3 2"), 6u);  // P 3 1 2
    EXPECT_EQ(bodies("P 32"), 3u);
    EXPECT_EQ(bodies("P 6 2"), 12u);  // P 6 2 2
    EXPECT_EQ(bodies("P_3_2"), 6u);
    EXPECT_EQ(bodies("-P2ybc"), 4u);  // only one group is meant
}

TEST(CrystalSymmetry, SettingsAreTold) {
    const auto bodies = [](const std::string& cell, const std::string& name) {
        return frame_of(cell + "_symmetry_space_group_name_H-M '" + name + "'\n" +
                        atoms_text("Q .11 .23 .37\n"))
            .bodies.size();
    };
    const std::string hexagonal = cell_text(15, 15, 21, 90, 90, 120),
                      cubic = cell_text(20, 20, 20, 90, 90, 90);
    EXPECT_EQ(bodies(hexagonal, "R -3 m"), 36u);
    EXPECT_EQ(bodies(hexagonal, "R -3 m H"), 36u);
    EXPECT_EQ(bodies(cell_text(15, 15, 15, 70, 70, 70), "R -3 m"), 12u);
    EXPECT_EQ(bodies(cubic, "F m -3 m"), 192u);
    // Diamond's two origins: an atom at 1/8 1/8 1/8 has 8 images about the second, 16 about the first.
    const auto carbon = [&](const std::string& name) {
        return cubic + "_symmetry_space_group_name_H-M '" + name + "'\n" + atoms_text("Q .125 .125 .125\n");
    };
    for (const char* second : {"F d -3 m :2", "F d -3 m Z", "Fd-3m:2"}) {
        EXPECT_EQ(frame_of(carbon(second)).bodies.size(), 8u) << second;
        EXPECT_TRUE(warnings_of(carbon(second)).empty());
    }
    EXPECT_EQ(frame_of(carbon("F d -3 m S")).bodies.size(), 16u);
    EXPECT_EQ(frame_of(carbon("F d -3 m")).bodies.size(), 16u);
    EXPECT_THAT(
        warnings_of(carbon("F d -3 m")),
        testing::ElementsAre("test.cif: line 8: _symmetry_space_group_name_h-m=F d -3 m: has two origins, "
                             "and no operations are listed: F d -3 m:1 is taken"));
}

TEST(CrystalSymmetry, UnknownGroupsAreNamed) {
    for (const char* name : {"'P 99'", "154x", "'?'", "'::'", "'12'"}) {
        const std::string text = kQuartzCell + "_symmetry_space_group_name_H-M " + name + "\n" + kQuartzAtoms;
        EXPECT_EQ(frame_of(text).bodies.size(), 2u);
        EXPECT_THAT(
            warnings_of(text),
            testing::ElementsAre(HasSubstr("is no space group that is known, and no operations are listed")))
            << name;
    }
    for (const char* number : {"0", "231", "1.5", "nan"})
        EXPECT_EQ(
            warnings_of(kQuartzCell + "_symmetry_Int_Tables_number " + number + "\n" + kQuartzAtoms).size(),
            1u);
    EXPECT_TRUE(warnings_of(kQuartzCell + kQuartzAtoms).empty());
    EXPECT_TRUE(warnings_of(kQuartzCell + "_symmetry_space_group_name_H-M ?\n" + kQuartzAtoms).empty());
}

TEST(CrystalSymmetry, AtomsWhoseTensorIsNotPositiveDefiniteAreNamed) {
    const std::string ahead = kQuartzCell +
                              "loop_\n_atom_site_label _atom_site_fract_x _atom_site_fract_y "
                              "_atom_site_fract_z _atom_site_U_iso_or_equiv\n"
                              "Si1 .4697 0 0 .01\nO1 .4135 .2669 .1191 .02\nO2 .1 .2 .3 -.005\n"
                              "loop_\n_atom_site_aniso_label\n_atom_site_aniso_U_11\n"
                              "_atom_site_aniso_U_22\n_atom_site_aniso_U_33\n_atom_site_aniso_U_12\n"
                              "_atom_site_aniso_U_13\n_atom_site_aniso_U_23\nSi1 .01 .01 .01 .005 0 0\n";
    EXPECT_THAT(warnings_of(ahead),
                testing::ElementsAre("test.cif: O2: U = -0.005 is negative: the atom is drawn as a "
                                     "small sphere"));
    EXPECT_THAT(warnings_of(ahead + "O1 .02 .01 -.004 0 0 0\n"),
                testing::ElementsAre(
                    "test.cif: O1: U11, U22, U33, U12, U13, U23 = 0.02, 0.01, -0.004, 0, 0, 0 is not "
                    "positive definite (the least of its principal values is -0.004): the ellipsoid is "
                    "drawn flat",
                    HasSubstr("O2")));
    // One principal value of three is not 0, but for rounding.
    EXPECT_THAT(warnings_of(ahead + "O1 .05 .05 .05 .05 .05 .05\n"),
                testing::ElementsAre(HasSubstr("O1: U11, U22, U33, U12, U13, U23 = 0.05, 0.05, 0.05"),
                                     HasSubstr("O2")));
}

}  // namespace
}  // namespace anamorph::test_cif_symmetry
