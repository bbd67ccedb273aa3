// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/cif_symmetry.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <string>
#include <utility>

#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

/// Images of an atom so close together are one, on a special position; Angstrom.
constexpr double kSamePlace = 0.1;
/// Bins of the cell along an axis, and how many bins away a neighbour may be.
constexpr int kMostBins = 64, kFarthestBin = 4;

// --- Operations as text ------------------------------------------------------------------------------------

/// Takes a term from the front of `rest`: a sign, a number or a fraction, a letter, or both of these. False
/// where there is none.
bool take_term(std::string_view& rest, int row, SymmetryOperation& operation) {
    double sign = 1;
    if (rest[0] == '+' || rest[0] == '-') {
        sign = rest[0] == '-' ? -1 : 1;
        rest.remove_prefix(1);
    }
    double number = 1, below = 1;
    const bool is_digit = !rest.empty() && (rest[0] == '.' || (rest[0] >= '0' && rest[0] <= '9'));
    if (is_digit && !text_file::take_number(rest, number)) return false;
    if (is_digit && !rest.empty() && rest[0] == '/') {
        rest.remove_prefix(1);
        if (!text_file::take_number(rest, below)) return false;
    }
    number = sign * number / below;
    if (!(std::fabs(number) <= 1e3)) return false;
    const bool times = is_digit && !rest.empty() && rest[0] == '*';
    if (times) rest.remove_prefix(1);
    const std::size_t letter = rest.empty() ? std::string_view::npos : std::string_view("xyz").find(rest[0]);
    if (letter == std::string_view::npos) {
        operation.shift[row] += number;
        return is_digit && !times;
    }
    operation.turn[static_cast<int>(letter)][row] += number;
    rest.remove_prefix(1);
    return true;
}

bool read_operation(std::string_view text, SymmetryOperation& operation) {
    operation.turn = glm::dmat3(0.0);
    std::string plain;
    for (const char c : text)
        if (!std::isspace(static_cast<unsigned char>(c)))
            plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const std::vector<std::string_view> sums = text_file::fields_of(plain);
    if (sums.size() != 3) return false;
    for (int row = 0; row < 3; ++row) {
        std::string_view rest = sums[static_cast<std::size_t>(row)];
        if (rest.empty()) return false;
        for (bool first = true; !rest.empty(); first = false) {
            if (!first && rest[0] != '+' && rest[0] != '-') return false;
            if (!take_term(rest, row, operation)) return false;
        }
    }
    return true;
}

// --- Sites -------------------------------------------------------------------------------------------------

glm::ivec3 cell_of(const glm::dvec3& place) {
    return glm::ivec3(glm::floor(place));
}

/// The sites of all images of each atom; those that differ by lattice vectors are one.
std::vector<CrystalSite> sites_of(const std::vector<glm::dvec3>& places,
                                  const std::vector<SymmetryOperation>& operations, const glm::dmat3& cell,
                                  std::size_t most) {
    std::vector<CrystalSite> sites;
    std::vector<std::vector<glm::dvec3>> images(places.size());
    for (std::size_t o = 0; o < operations.size(); ++o)
        for (std::size_t a = 0; a < places.size(); ++a) {
            const glm::dvec3 place = operations[o](places[a]);
            const bool is_known = std::any_of(images[a].begin(), images[a].end(), [&](const glm::dvec3& p) {
                const glm::dvec3 d = place - p;
                return glm::length(cell * (d - glm::round(d))) < kSamePlace;
            });
            if (is_known) continue;
            if (sites.size() == most)
                throw Error("symmetry makes more than " + std::to_string(most) + " atoms");
            images[a].push_back(place);
            sites.push_back({a, o, place});
        }
    return sites;
}

// --- Bonds -------------------------------------------------------------------------------------------------

/// A bond between images in the cell: the second one moved by `cells`.
struct LatticeBond {
    std::size_t to = 0;
    glm::ivec3 cells{0};
};

/// Bonds of all sites with all images of sites, by bins as wide as bonds may be long.
class LatticeBonds {
  public:
    LatticeBonds(const std::vector<CrystalSite>& sites, const std::vector<double>& radii,
                 const glm::dmat3& cell, std::size_t most)
        : m_bonds(sites.size()) {
        const double reach = std::max(1e-3, 2 * *std::max_element(radii.begin(), radii.end()));
        set_bins(cell, reach);
        std::vector<std::vector<std::size_t>> bins(static_cast<std::size_t>(m_bins.x * m_bins.y * m_bins.z));
        for (std::size_t i = 0; i < sites.size(); ++i) {
            m_inside.push_back(sites[i].place - glm::floor(sites[i].place));
            if (radii[sites[i].atom] > 0) bins[bin_at(bin_of(m_inside[i]))].push_back(i);
        }
        std::size_t count = 0;
        for (std::size_t i = 0; i < sites.size(); ++i) {
            const double own = radii[sites[i].atom];
            if (!(own > 0)) continue;
            each_bin_near(bin_of(m_inside[i]), [&](const glm::ivec3& bin, const glm::ivec3& cells) {
                for (const std::size_t j : bins[bin_at(bin)]) {
                    if (j == i && cells == glm::ivec3(0)) continue;
                    const double d = glm::length(cell * (m_inside[j] + glm::dvec3(cells) - m_inside[i]));
                    if (!(d < own + radii[sites[j].atom])) continue;
                    // Each is met from both ends.
                    if (++count > 2 * most)
                        throw Error("atoms lie so close together that there are over " +
                                    std::to_string(most) + " bonds");
                    m_bonds[i].push_back({j, cells});
                }
            });
        }
    }

    const std::vector<LatticeBond>& of(std::size_t site) const { return m_bonds[site]; }
    /// The image of a site in the cell.
    const glm::dvec3& inside(std::size_t site) const { return m_inside[site]; }

  private:
    void set_bins(const glm::dmat3& cell, double reach) {
        const glm::dmat3 reciprocal = glm::transpose(glm::inverse(cell));
        for (int c = 0; c < 3; ++c) {
            const double height = 1 / glm::length(reciprocal[c]);
            m_bins[c] = static_cast<int>(std::clamp(std::floor(height / reach), 1.0, double{kMostBins}));
            m_far[c] = static_cast<int>(
                std::clamp(std::ceil(reach * m_bins[c] / height), 1.0, double{kFarthestBin}));
        }
    }
    glm::ivec3 bin_of(const glm::dvec3& inside) const {
        return glm::min(glm::ivec3(inside * glm::dvec3(m_bins)), m_bins - 1);
    }
    std::size_t bin_at(const glm::ivec3& bin) const {
        return static_cast<std::size_t>((bin.x * m_bins.y + bin.y) * m_bins.z + bin.z);
    }
    /// body(bin, cells): the bin is that many cells away.
    template <class Body>
    void each_bin_near(const glm::ivec3& from, const Body& body) const {
        glm::ivec3 by;
        for (by.x = -m_far.x; by.x <= m_far.x; ++by.x)
            for (by.y = -m_far.y; by.y <= m_far.y; ++by.y)
                for (by.z = -m_far.z; by.z <= m_far.z; ++by.z) {
                    const glm::ivec3 cells = cell_of(glm::dvec3(from + by) / glm::dvec3(m_bins));
                    body(from + by - cells * m_bins, cells);
                }
    }

    glm::ivec3 m_bins{1}, m_far{1};
    std::vector<glm::dvec3> m_inside;
    std::vector<std::vector<LatticeBond>> m_bonds;
};

// --- Molecules ---------------------------------------------------------------------------------------------

/// Says which image of every site is shown, as a number of cells from the one in the cell.
class Molecules {
  public:
    Molecules(const std::vector<CrystalSite>& sites, const LatticeBonds& bonds)
        : m_sites(sites), m_bonds(bonds), m_cells(sites.size(), glm::ivec3(0)), m_known(sites.size(), 0) {
        for (std::size_t i = 0; i < sites.size(); ++i)
            if (!m_known[i]) gather(i);
    }

    const glm::ivec3& cells(std::size_t site) const { return m_cells[site]; }

  private:
    /// The molecule of a site, which is the first of it: one that is listed, if it has such.
    void gather(std::size_t root) {
        const bool listed = m_sites[root].operation == 0;
        if (listed) m_cells[root] = cell_of(m_sites[root].place);
        std::vector<std::size_t> reached{root};
        m_known[root] = 1;
        bool ends = true;
        for (std::size_t next = 0; next < reached.size(); ++next) {
            const std::size_t i = reached[next];
            for (const LatticeBond& bond : m_bonds.of(i)) {
                const glm::ivec3 there = m_cells[i] + bond.cells;
                if (m_known[bond.to]) {
                    ends = ends && there == m_cells[bond.to];
                    continue;
                }
                m_known[bond.to] = 1;
                m_cells[bond.to] = there;
                reached.push_back(bond.to);
            }
        }
        if (ends && listed) return;
        glm::dvec3 middle(0.0);
        for (const std::size_t i : reached)
            middle += (m_bonds.inside(i) + glm::dvec3(m_cells[i])) / static_cast<double>(reached.size());
        for (const std::size_t i : reached) m_cells[i] = ends ? m_cells[i] - cell_of(middle) : glm::ivec3(0);
    }

    const std::vector<CrystalSite>& m_sites;
    const LatticeBonds& m_bonds;
    std::vector<glm::ivec3> m_cells;
    std::vector<char> m_known;
};

}  // namespace

SymmetryOperation symmetry_operation(std::string_view text) {
    SymmetryOperation operation;
    const bool read = read_operation(text, operation);
    const double volume = std::fabs(glm::determinant(operation.turn));
    if (!read || !(std::fabs(volume - 1) < 1e-9))
        throw Error("\"" + text_file::excerpt(text) +
                    "\": must be three sums of x, y, z and numbers that keep volumes, such as -x,1/2+y,-z");
    return operation;
}

Crystal crystal_of(const std::vector<glm::dvec3>& places, const std::vector<double>& radii,
                   const std::vector<SymmetryOperation>& operations, const glm::dmat3& cell,
                   const CrystalLimits& limits) {
    Crystal crystal;
    crystal.sites = sites_of(places, operations, cell, limits.sites);
    const LatticeBonds bonds(crystal.sites, radii, cell, limits.bonds);
    const Molecules molecules(crystal.sites, bonds);
    for (std::size_t i = 0; i < crystal.sites.size(); ++i) {
        crystal.sites[i].place = bonds.inside(i) + glm::dvec3(molecules.cells(i));
        for (const LatticeBond& bond : bonds.of(i))
            if (i < bond.to && molecules.cells(bond.to) == molecules.cells(i) + bond.cells)
                crystal.bonds.push_back({i, bond.to});
    }
    std::sort(crystal.bonds.begin(), crystal.bonds.end(), [](const CrystalBond& a, const CrystalBond& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    return crystal;
}

}  // namespace anamorph::figure
