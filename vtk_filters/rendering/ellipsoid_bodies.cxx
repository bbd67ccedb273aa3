// SPDX-License-Identifier: Apache-2.0
#include "ellipsoid_bodies.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "anamorph/error.h"
#include "anamorph/figure/body/eigenvectors.h"
#include "ellipsoid_shader.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;

/// Of a body's longest axis; a shorter one makes none, since single precision could not tell its sides apart.
constexpr double kShortestAxis = 1e-10;

vtkDataArray* shape_array(vtkDataSet* data, const std::string& name, const char* parameter, int components,
                          int other_components = 0) {
    vtkDataArray* array = data->GetPointData()->GetArray(name.c_str());
    if (!array) throw Error(parameter, '"' + name + '"', "must be the name of an array of the points");
    const int has = array->GetNumberOfComponents();
    if (has != components && has != other_components)
        throw Error(parameter, '"' + name + '"',
                    "has " + std::to_string(has) + " components, but must have " +
                        std::to_string(components) +
                        (other_components ? " or " + std::to_string(other_components) : std::string()));
    if (array->GetNumberOfTuples() != data->GetNumberOfPoints())
        throw Error(parameter, '"' + name + '"',
                    "has " + std::to_string(array->GetNumberOfTuples()) + " tuples, but must have " +
                        std::to_string(data->GetNumberOfPoints()));
    return array;
}

/// A shape from its half axes and their directions, which are the columns of a rotation.
void set_shape(EllipsoidBody& body, const glm::dmat3& turn, const glm::dvec3& lengths) {
    const double longest = std::max({lengths.x, lengths.y, lengths.z});
    for (int k = 0; k < 3; ++k)
        if (!(lengths[k] > kShortestAxis * longest && std::isfinite(lengths[k]))) return;
    for (int k = 0; k < 3; ++k) {
        body.axes[k] = lengths[k] * turn[k];
        body.inverse[k] = turn[k] / lengths[k];
    }
    body.inverse = glm::transpose(body.inverse);
    body.drawn = std::isfinite(turn[0].x + turn[1].x + turn[2].x);
}

/// What says the shape of each point.
class Shapes {
  public:
    Shapes(vtkDataSet* data, const EllipsoidArrays& arrays) : m_arrays(arrays) {
        if (data->GetNumberOfPoints() == 0) return;
        if (arrays.shape != EllipsoidArrays::AXES) {
            m_tensor = shape_array(data, arrays.tensor, "TensorArray", 9, 6);
            return;
        }
        m_axes = shape_array(data, arrays.axes, "AxesArray", 3);
        if (!arrays.orientation.empty())
            m_orientation = shape_array(data, arrays.orientation, "OrientationArray", 4);
    }

    void set(EllipsoidBody& body, vtkIdType point) const {
        if (m_tensor)
            set_tensor(body, point);
        else
            set_axes(body, point);
    }

  private:
    void set_axes(EllipsoidBody& body, vtkIdType point) const {
        glm::dvec3 lengths;
        double q[4] = {1, 0, 0, 0};
        m_axes->GetTuple(point, &lengths.x);
        if (m_orientation) m_orientation->GetTuple(point, q);
        const glm::dquat turn(q[0], q[1], q[2], q[3]);
        const double length = glm::length(turn);
        if (length > 0 && std::isfinite(length))
            set_shape(body, glm::mat3_cast(turn / length), m_arrays.scale * glm::abs(lengths));
    }

    /// The unit sphere under the tensor's matrix M is the ellipsoid of the symmetric square root of M M^T; of a covariance C,
    /// it is that of the square root of C.
    void set_tensor(EllipsoidBody& body, vtkIdType point) const {
        double t[9];
        m_tensor->GetTuple(point, t);
        // VTK has six components as XX, YY, ZZ, XY, YZ, XZ.
        glm::dmat3 m = m_tensor->GetNumberOfComponents() == 6
                           ? glm::dmat3(t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2])
                           : glm::transpose(glm::dmat3(t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8]));
        double size = 0;
        for (int k = 0; k < 9; ++k) size = std::max(size, std::abs(m[k / 3][k % 3]));
        if (!(size > 0 && std::isfinite(glm::dot(m[0] + m[1] + m[2], glm::dvec3(1))))) return;
        m /= size;
        const bool covariance = m_arrays.shape == EllipsoidArrays::COVARIANCE;
        const glm::dmat3 square = covariance ? 0.5 * (m + glm::transpose(m)) : m * glm::transpose(m);
        const glm::dmat3 turn = anamorph::figure::eigenvectors(square);
        glm::dvec3 lengths;
        for (int k = 0; k < 3; ++k)
            lengths[k] = covariance ? std::sqrt(glm::dot(turn[k], square * turn[k]))
                                    : glm::length(glm::transpose(m) * turn[k]);
        set_shape(body, turn, m_arrays.scale * (covariance ? std::sqrt(size) : size) * lengths);
    }

    const EllipsoidArrays& m_arrays;
    vtkDataArray *m_axes = nullptr, *m_orientation = nullptr, *m_tensor = nullptr;
};

/// The texture of each point, where there is one.
class Textures {
  public:
    Textures(vtkDataSet* data, const EllipsoidArrays& arrays) {
        if (!arrays.textures) return;
        m_names = arrays.textures;
        m_array = data->GetPointData()->GetAbstractArray(arrays.texture.c_str());
        m_offset = data->GetPointData()->GetArray(arrays.offset.c_str());
        if (m_array && m_array->GetNumberOfTuples() != data->GetNumberOfPoints()) m_array = nullptr;
        if (m_offset && (m_offset->GetNumberOfTuples() != data->GetNumberOfPoints() ||
                         m_offset->GetNumberOfComponents() != 2))
            m_offset = nullptr;
    }

    void set(EllipsoidBody& body, vtkIdType point) const {
        if (!m_array) return;
        if (auto* names = vtkStringArray::SafeDownCast(m_array))
            body.texture = numbered(names->GetValue(point));
        else if (auto* numbers = vtkDataArray::SafeDownCast(m_array))
            body.texture = numbered(numbers->GetComponent(point, 0));
        if (m_offset) m_offset->GetTuple(point, body.offset);
    }

  private:
    int numbered(const std::string& name) const {
        const auto found = std::find(m_names->begin(), m_names->end(), name);
        return name.empty() || found == m_names->end() ? -1 : static_cast<int>(found - m_names->begin());
    }
    int numbered(double number) const {
        return number >= 0 && number < static_cast<double>(m_names->size()) ? static_cast<int>(number) : -1;
    }

    const std::vector<std::string>* m_names = nullptr;
    vtkAbstractArray* m_array = nullptr;
    vtkDataArray* m_offset = nullptr;
};

/// The cell that each point is in first; -1: none.
std::vector<vtkIdType> cells_of_points(vtkDataSet* data) {
    std::vector<vtkIdType> cells(static_cast<std::size_t>(data->GetNumberOfPoints()), -1);
    vtkNew<vtkIdList> points;
    for (vtkIdType cell = data->GetNumberOfCells(); cell-- > 0;) {
        data->GetCellPoints(cell, points);
        for (vtkIdType k = 0; k < points->GetNumberOfIds(); ++k)
            cells[static_cast<std::size_t>(points->GetId(k))] = cell;
    }
    return cells;
}

}  // namespace

void EllipsoidBodies::add(vtkDataSet* data, unsigned int index, const EllipsoidArrays& arrays) {
    const Shapes shapes(data, arrays);
    const Textures textures(data, arrays);
    const std::vector<vtkIdType> cells = cells_of_points(data);
    vtkUnsignedCharArray* ghosts = data->GetPointGhostArray();
    if (ghosts && ghosts->GetNumberOfTuples() != data->GetNumberOfPoints()) ghosts = nullptr;
    constexpr int hidden = vtkDataSetAttributes::HIDDENPOINT | vtkDataSetAttributes::DUPLICATEPOINT;
    blocks.push_back({index, static_cast<vtkIdType>(bodies.size()), data->GetNumberOfPoints(), {}});
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        EllipsoidBody& body = bodies.emplace_back();
        data->GetPoint(i, &body.center.x);
        body.cell = cells[static_cast<std::size_t>(i)];
        body.picked = body.cell < 0 ? i : body.cell;
        textures.set(body, i);
        if (ghosts && (ghosts->GetValue(i) & hidden) != 0) continue;
        if (std::isfinite(body.center.x) && std::isfinite(body.center.y) && std::isfinite(body.center.z))
            shapes.set(body, i);
        if (!body.drawn) ++skipped;
    }
}

void EllipsoidBodies::color(const EllipsoidBlock& block, vtkUnsignedCharArray* colors, bool of_cells) {
    for (vtkIdType i = 0; i < block.count; ++i) {
        EllipsoidBody& body = bodies[static_cast<std::size_t>(block.first + i)];
        const vtkIdType tuple = of_cells ? body.cell : i;
        if (tuple < 0 || tuple >= colors->GetNumberOfTuples()) continue;
        for (int k = 0; k < 4; ++k)
            body.color[k] = static_cast<float>(colors->GetTypedComponent(tuple, k)) / 255;
        body.color[3] *= static_cast<float>(block.look.opacity);
    }
}

void EllipsoidBodies::color(const EllipsoidBlock& block, const double* color) {
    for (vtkIdType i = 0; i < block.count; ++i) {
        EllipsoidBody& body = bodies[static_cast<std::size_t>(block.first + i)];
        for (int k = 0; k < 3; ++k) body.color[k] = static_cast<float>(color[k]);
        body.color[3] = static_cast<float>(block.look.opacity);
    }
}

bool EllipsoidBodies::bounds(double box[6]) const {
    bool any = false;
    for (int k = 0; k < 3; ++k) {
        box[2 * k] = std::numeric_limits<double>::max();
        box[2 * k + 1] = std::numeric_limits<double>::lowest();
    }
    for (const EllipsoidBody& body : bodies) {
        if (!body.drawn) continue;
        any = true;
        const glm::dmat3 rows = glm::transpose(body.axes);
        for (int k = 0; k < 3; ++k) {
            const double reach = glm::length(rows[k]);
            box[2 * k] = std::min(box[2 * k], body.center[k] - reach);
            box[2 * k + 1] = std::max(box[2 * k + 1], body.center[k] + reach);
        }
    }
    return any;
}

std::vector<std::uint32_t> EllipsoidBodies::largest(std::size_t count) const {
    struct Size {
        float square;          ///< of the longest half axis
        std::uint32_t spread;  ///< in no order
        std::uint32_t body;
    };
    std::vector<Size> sizes;
    sizes.reserve(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const EllipsoidBody& body = bodies[i];
        if (!body.drawn) continue;
        double square = 0;
        for (int k = 0; k < 3; ++k) square = std::max(square, glm::dot(body.axes[k], body.axes[k]));
        // A multiplication by an odd number takes each number to another one (Knuth 1998, section 6.4).
        const auto number = static_cast<std::uint32_t>(i);
        sizes.push_back({static_cast<float>(square), number * 2654435769u, number});
    }
    count = std::min(count, sizes.size());
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(count), sizes.end(),
                     [](const Size& a, const Size& b) {
                         return a.square != b.square ? a.square > b.square : a.spread < b.spread;
                     });
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(sizes[i].body);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

std::optional<LineHit> EllipsoidBodies::hit(const EllipsoidBlock& block, const glm::dvec3& from,
                                            const glm::dvec3& to) const {
    std::optional<LineHit> first;
    for (vtkIdType i = 0; i < block.count; ++i) {
        const EllipsoidBody& body = bodies[static_cast<std::size_t>(block.first + i)];
        if (!body.drawn) continue;
        // In the space of the unit sphere: from the point of the line that is next to its centre, both ways.
        const glm::dvec3 start = body.inverse * (from - body.center), way = body.inverse * (to - from);
        const double square = glm::dot(way, way), middle = -glm::dot(start, way) / square;
        const glm::dvec3 nearest = start + middle * way;
        const double half = std::sqrt((1 - glm::dot(nearest, nearest)) / square);  // not a number: it misses
        const double t = middle - half >= 0 ? middle - half : middle + half;
        if (t >= 0 && t <= 1 && (!first || t < first->t)) first = LineHit{t, i};
    }
    return first;
}

double EllipsoidBodies::unit() const {
    double box[6];
    if (!bounds(box)) return 1;
    const double size = std::max({box[1] - box[0], box[3] - box[2], box[5] - box[4]});
    return std::isfinite(size) && size > 0 ? std::exp2(std::floor(std::log2(size))) : 1;
}

std::vector<float> EllipsoidBodies::texels(double unit) const {
    std::vector<float> numbers(bodies.size() * kBodyTexels * 4);
    float* to = numbers.data();
    const auto put = [&to](const auto& v, double w) {
        for (int k = 0; k < 3; ++k) *to++ = static_cast<float>(v[k]);
        *to++ = static_cast<float>(w);
    };
    for (const EllipsoidBody& body : bodies) {
        const FloatPair center(body.drawn ? body.center / unit : glm::dvec3(0));
        put(center.high, body.drawn ? 1 : 0);
        put(center.low, 1 + body.texture);
        const double ids[3] = {static_cast<double>(body.picked % (1 << 24)),
                               static_cast<double>(body.picked >> 24), 0};
        for (int k = 0; k < 3; ++k) put(body.axes[k] / unit, ids[k]);
        const glm::dmat3 rows = glm::transpose(body.inverse);
        for (int k = 0; k < 3; ++k) put(rows[k] * unit, k < 2 ? body.offset[k] : 0);
        for (const float c : body.color) *to++ = c;
    }
    return numbers;
}

}  // namespace anamorph_vtk
