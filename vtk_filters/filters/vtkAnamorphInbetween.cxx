// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphInbetween.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "anamorph/deform/inbetween.h"
#include "anamorph/deform/key_frames.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "explicit_points.h"
#include "smp_for.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArrayRange.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVersionMacros.h"

vtkObjectFactoryNewMacro(vtkAnamorphInbetween);

namespace {

using anamorph::Error;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostEntries = 1 << 20;               ///< of weights, of masks and of keys
constexpr vtkIdType kStretch = vtkIdType{1} << 18;  ///< points between two reports of progress

std::string entry(const char* name, std::size_t i) {
    return std::string(name).append("[").append(std::to_string(i)).append("]");
}

// ---- Topology: a difference in words that follow the name of the input; none if there is none. ----

std::string counts_differ(const char* what, vtkIdType base, vtkIdType other) {
    if (base == other) return {};
    return "has " + std::to_string(other) + " " + what + ", not " + std::to_string(base);
}

std::string cells_differ(const char* what, vtkCellArray* base, vtkCellArray* other) {
    if (base == other) return {};
    const vtkIdType count = base ? base->GetNumberOfCells() : 0;
    const std::string counts = counts_differ(what, count, other ? other->GetNumberOfCells() : 0);
    if (!counts.empty() || count == 0) return counts;
    const auto a = vtk::TakeSmartPointer(base->NewIterator()),
               b = vtk::TakeSmartPointer(other->NewIterator());
    for (a->GoToFirstCell(), b->GoToFirstCell(); !a->IsDoneWithTraversal();
         a->GoToNextCell(), b->GoToNextCell()) {
        vtkIdType a_size, b_size;
        const vtkIdType *a_points, *b_points;
        a->GetCurrentCell(a_size, a_points);
        b->GetCurrentCell(b_size, b_points);
        if (!std::equal(a_points, a_points + a_size, b_points, b_points + b_size))
            return std::string("has other points in number ") + std::to_string(a->GetCurrentCellId()) +
                   " of its " + what;
    }
    return {};
}

std::string poly_data_differs(vtkPolyData* base, vtkPolyData* other) {
    std::string found = cells_differ("vertices", base->GetVerts(), other->GetVerts());
    if (found.empty()) found = cells_differ("lines", base->GetLines(), other->GetLines());
    if (found.empty()) found = cells_differ("polygons", base->GetPolys(), other->GetPolys());
    if (found.empty()) found = cells_differ("strips", base->GetStrips(), other->GetStrips());
    return found;
}

std::string structured_differs(vtkStructuredGrid* base, vtkStructuredGrid* other) {
    const int *a = base->GetExtent(), *b = other->GetExtent();
    if (std::equal(a, a + 6, b)) return {};
    const auto words = [](const int* e) {
        std::string text = std::to_string(e[0]);
        for (int i = 1; i < 6; ++i) text.append(" ").append(std::to_string(e[i]));
        return text;
    };
    return "has the extent " + words(b) + ", not " + words(a);
}

std::string unstructured_differs(vtkUnstructuredGrid* base, vtkUnstructuredGrid* other) {
    std::string found = cells_differ("cells", base->GetCells(), other->GetCells());
    vtkNew<vtkIdList> a, b;
    for (vtkIdType i = 0; found.empty() && i < base->GetNumberOfCells(); ++i) {
        if (base->GetCellType(i) != other->GetCellType(i))
            return "has another type of cell " + std::to_string(i);
        if (base->GetCellType(i) != VTK_POLYHEDRON) continue;
        base->GetFaceStream(i, a);
        other->GetFaceStream(i, b);
        if (!std::equal(a->begin(), a->end(), b->begin(), b->end()))
            return "has other faces at cell " + std::to_string(i);
    }
    return found;
}

std::string any_cells_differ(vtkPointSet* base, vtkPointSet* other) {
    std::string found = counts_differ("cells", base->GetNumberOfCells(), other->GetNumberOfCells());
    vtkNew<vtkIdList> a, b;
    for (vtkIdType i = 0; found.empty() && i < base->GetNumberOfCells(); ++i) {
        base->GetCellPoints(i, a);
        other->GetCellPoints(i, b);
        if (base->GetCellType(i) != other->GetCellType(i) ||
            !std::equal(a->begin(), a->end(), b->begin(), b->end()))
            found = "has another cell " + std::to_string(i);
    }
    return found;
}

std::string topology_differs(vtkPointSet* base, vtkPointSet* other) {
    const std::string found = counts_differ("points", base->GetNumberOfPoints(), other->GetNumberOfPoints());
    if (!found.empty()) return found;
    if (auto* poly_data = vtkPolyData::SafeDownCast(base))
        return poly_data_differs(poly_data, vtkPolyData::SafeDownCast(other));
    if (auto* structured = vtkStructuredGrid::SafeDownCast(base))
        return structured_differs(structured, vtkStructuredGrid::SafeDownCast(other));
    if (auto* unstructured = vtkUnstructuredGrid::SafeDownCast(base))
        return unstructured_differs(unstructured, vtkUnstructuredGrid::SafeDownCast(other));
    return any_cells_differ(base, other);
}

using Arrays = std::vector<vtkDataArray*>;

void append_cells(vtkCellArray* cells, Arrays& to) {
    if (!cells) return;
    to.push_back(cells->GetOffsetsArray());
    to.push_back(cells->GetConnectivityArray());
}

/// The arrays that, with the number of points, say all of a surface's topology; none where there is more to it.
Arrays topology_arrays(vtkPointSet* surface) {
    Arrays arrays;
    if (auto* poly_data = vtkPolyData::SafeDownCast(surface)) {
        append_cells(poly_data->GetVerts(), arrays);
        append_cells(poly_data->GetLines(), arrays);
        append_cells(poly_data->GetPolys(), arrays);
        append_cells(poly_data->GetStrips(), arrays);
    } else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(surface)) {
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
        auto* types = vtkUnsignedCharArray::SafeDownCast(grid->GetCellTypes());
#else
        vtkUnsignedCharArray* types = grid->GetCellTypesArray();
#endif
        if (!types || !grid->GetCells()) return {};
        const unsigned char* type = types->GetPointer(0);
        if (std::find(type, type + types->GetNumberOfValues(), VTK_POLYHEDRON) !=
            type + types->GetNumberOfValues())
            return {};
        arrays.push_back(types);
        append_cells(grid->GetCells(), arrays);
    }
    return arrays;
}

std::int64_t bytes_of(vtkDataArray* array) {
    return std::int64_t{array->GetNumberOfValues()} * array->GetDataTypeSize();
}

/// May two arrays be compared byte by byte, and be alike?
bool are_comparable(vtkDataArray* a, vtkDataArray* b) {
    return a == b || (a->HasStandardMemoryLayout() && b->HasStandardMemoryLayout() &&
                      a->GetDataType() == b->GetDataType() && bytes_of(a) == bytes_of(b));
}

/// Which surfaces have the topology of the base for certain: those whose arrays have the same bytes. All are compared
/// together, a piece of the base with theirs, so that it is read once.
std::vector<bool> have_same_arrays(const std::vector<vtkSmartPointer<vtkPointSet>>& surfaces,
                                   const std::vector<bool>& asked, std::size_t base_index) {
    const Arrays base = topology_arrays(surfaces[base_index]);
    std::vector<Arrays> arrays(surfaces.size());
    std::vector<std::atomic<bool>> same(surfaces.size());
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (asked[i]) arrays[i] = topology_arrays(surfaces[i]);
        same[i] = asked[i] && !base.empty() && arrays[i].size() == base.size() &&
                  surfaces[i]->GetNumberOfPoints() == surfaces[base_index]->GetNumberOfPoints() &&
                  std::equal(base.begin(), base.end(), arrays[i].begin(), are_comparable);
    }
    constexpr std::int64_t kPiece = 1 << 16;
    for (std::size_t k = 0; k < base.size(); ++k) {
        std::vector<std::size_t> others;
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            if (same[i] && arrays[i][k] != base[k]) others.push_back(i);
        if (others.empty()) continue;
        const std::int64_t bytes = bytes_of(base[k]);
        const auto at = [](vtkDataArray* array) {
            return static_cast<const char*>(array->GetVoidPointer(0));
        };
        anamorph::smp_for((bytes + kPiece - 1) / kPiece, [&](std::int64_t piece) {
            const std::int64_t first = piece * kPiece;
            const auto count = static_cast<std::size_t>(std::min(kPiece, bytes - first));
            for (const std::size_t i : others)
                if (same[i] && std::memcmp(at(base[k]) + first, at(arrays[i][k]) + first, count) != 0)
                    same[i] = false;
        });
    }
    return {same.begin(), same.end()};
}

// ---- Blending ----

bool is_floating(vtkDataArray* array) {
    return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/// The numbers of an array without gaps: its own memory, or a copy.
template <class T>
class Values {
  public:
    explicit Values(vtkDataArray* array) {
        if (auto* dense = vtkAOSDataArrayTemplate<T>::FastDownCast(array)) {
            m_data = dense->GetPointer(0);
            return;
        }
        m_copy.reserve(static_cast<std::size_t>(array->GetNumberOfValues()));
        for (const double value : vtk::DataArrayValueRange(array)) m_copy.push_back(static_cast<T>(value));
        m_data = m_copy.data();
    }
    const T* data() const { return m_data; }

  private:
    std::vector<T> m_copy;
    const T* m_data;
};

/// Masks by input: one number for each point (or cell), or nothing.
using Masks = std::vector<std::vector<float>>;

/// One array to blend.
struct Job {
    std::vector<vtkSmartPointer<vtkDataArray>> from;  ///< one for each input
    vtkSmartPointer<vtkDataArray> to;
    std::shared_ptr<const Masks> masks;
    bool unit = false;  ///< vectors of length 1
};

/// Vectors made unit length; those without a length stay.
template <class T>
void renormalize(T* vectors, vtkIdType count, int components) {
    constexpr vtkIdType kTurn = 4096;
    const auto turn = [&](std::int64_t k) {
        T* const end = vectors + std::min((k + 1) * kTurn, count) * components;
        for (T* v = vectors + k * kTurn * components; v != end; v += components) {
            double squared = 0;
            for (int c = 0; c < components; ++c) squared += static_cast<double>(v[c]) * v[c];
            const double length = std::sqrt(squared);
            for (int c = 0; length > 0 && c < components; ++c) v[c] = static_cast<T>(v[c] / length);
        }
    };
    anamorph::smp_for((count + kTurn - 1) / kTurn, turn);
}

/// The mask at cells is the mean over the points.
std::vector<float> cell_mask(vtkPointSet* surface, const std::vector<float>& points) {
    if (points.empty()) return {};
    std::vector<float> cells(static_cast<std::size_t>(surface->GetNumberOfCells()));
    vtkNew<vtkIdList> ids;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        surface->GetCellPoints(static_cast<vtkIdType>(i), ids);
        double sum = 0;
        for (const vtkIdType id : *ids) sum += points[static_cast<std::size_t>(id)];
        cells[i] =
            ids->GetNumberOfIds() ? static_cast<float>(sum / static_cast<double>(ids->GetNumberOfIds())) : 0;
    }
    return cells;
}

/// What to blend is collected first, so that nothing is written before all is checked, and progress is known.
class Blend {
  public:
    struct Options {
        std::vector<double> weights;
        bool deltas;
        std::size_t base;
        std::vector<std::string> masks;
        bool drop_normals;
        int precision;
    };
    explicit Blend(Options options) : m_options(std::move(options)) {}

    /// `output` is a shallow copy of the base.
    void add(const std::vector<vtkSmartPointer<vtkPointSet>>& inputs, vtkPointSet* output) {
        const auto point_masks = std::make_shared<Masks>(masks_of(inputs));
        add_points(inputs, output, point_masks);
        std::vector<vtkDataSetAttributes*> point_data, cell_data;
        for (const auto& input : inputs) {
            point_data.push_back(input->GetPointData());
            cell_data.push_back(input->GetCellData());
        }
        add_arrays(point_data, output->GetNumberOfPoints(), output->GetPointData(), point_masks);
        const auto cell_masks = std::make_shared<Masks>();
        if (cell_data[m_options.base]->GetNumberOfArrays() > 0)
            for (const std::vector<float>& mask : *point_masks)
                cell_masks->push_back(cell_mask(inputs[m_options.base], mask));
        add_arrays(cell_data, output->GetNumberOfCells(), output->GetCellData(), cell_masks);
    }

    void run(anamorph_vtk::Execution& execution) {
        double total = 0, done = 0;
        for (const Job& job : m_jobs) total += static_cast<double>(job.to->GetNumberOfValues());
        for (const Job& job : m_jobs) {
            const auto advance = [&](vtkIdType values) {
                done += static_cast<double>(values);
                execution.progress(done / total);
            };
            if (job.to->GetDataType() == VTK_FLOAT)
                run_job<float>(job, advance);
            else
                run_job<double>(job, advance);
        }
        execution.progress(1);
    }

  private:
    void add_points(const std::vector<vtkSmartPointer<vtkPointSet>>& inputs, vtkPointSet* output,
                    const std::shared_ptr<const Masks>& masks) {
        if (output->GetNumberOfPoints() == 0) return;
        Job job;
        bool all_float = true;
        for (const auto& input : inputs) {
            job.from.push_back(input->GetPoints()->GetData());
            all_float = all_float && job.from.back()->GetDataType() == VTK_FLOAT;
        }
        const bool single = m_options.precision == vtkAlgorithm::SINGLE_PRECISION ||
                            (m_options.precision == vtkAlgorithm::DEFAULT_PRECISION && all_float);
        const int type = single ? VTK_FLOAT : VTK_DOUBLE;
        if (is_shared(job) && job.from.front()->GetDataType() == type) return;
        vtkNew<vtkPoints> points;
        points->SetDataType(type);
        points->SetNumberOfPoints(output->GetNumberOfPoints());
        output->SetPoints(points);
        job.to = points->GetData();
        job.masks = masks;
        m_jobs.push_back(job);
    }

    void add_arrays(const std::vector<vtkDataSetAttributes*>& inputs, vtkIdType tuples,
                    vtkDataSetAttributes* output, const std::shared_ptr<const Masks>& masks) {
        vtkDataSetAttributes* base = inputs[m_options.base];
        for (int i = 0; i < base->GetNumberOfArrays(); ++i) {
            vtkDataArray* array = base->GetArray(i);
            if (!array) continue;
            const bool normals = array == base->GetNormals();
            std::optional<Job> job = common_arrays(inputs, array, tuples);
            if (normals && (m_options.drop_normals || !job))
                output->SetNormals(nullptr);
            else if (job && !is_shared(*job)) {
                job->masks = masks;
                job->unit = normals;
                output->AddArray(job->to);
                m_jobs.push_back(*job);
            }
        }
    }

    /// The arrays of all inputs that are to be blended with one of the base; none if one is missing.
    static std::optional<Job> common_arrays(const std::vector<vtkDataSetAttributes*>& inputs,
                                            vtkDataArray* base, vtkIdType tuples) {
        if (!base->GetName() || base->GetNumberOfTuples() != tuples) return std::nullopt;
        Job job;
        bool all_float = true;
        for (vtkDataSetAttributes* input : inputs) {
            vtkDataArray* array = input->GetArray(base->GetName());
            if (!array || !is_floating(array) ||
                array->GetNumberOfComponents() != base->GetNumberOfComponents() ||
                array->GetNumberOfTuples() != tuples)
                return std::nullopt;
            job.from.push_back(array);
            all_float = all_float && array->GetDataType() == VTK_FLOAT;
        }
        job.to = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(all_float ? VTK_FLOAT : VTK_DOUBLE));
        job.to->SetName(base->GetName());
        job.to->SetNumberOfComponents(base->GetNumberOfComponents());
        job.to->CopyComponentNames(base);
        job.to->SetNumberOfTuples(base->GetNumberOfTuples());
        return job;
    }

    static bool is_shared(const Job& job) {
        return std::all_of(job.from.begin(), job.from.end(),
                           [&](const auto& array) { return array == job.from.front(); });
    }

    Masks masks_of(const std::vector<vtkSmartPointer<vtkPointSet>>& inputs) const {
        Masks masks(inputs.size());
        for (std::size_t i = 0; m_options.deltas && i < std::min(inputs.size(), m_options.masks.size()); ++i)
            if (!m_options.masks[i].empty() && i != m_options.base)
                masks[i] = mask_of(inputs, i, m_options.masks[i]);
        return masks;
    }

    std::vector<float> mask_of(const std::vector<vtkSmartPointer<vtkPointSet>>& inputs, std::size_t i,
                               const std::string& name) const {
        vtkDataArray* array = inputs[m_options.base]->GetPointData()->GetArray(name.c_str());
        if (!array) array = inputs[i]->GetPointData()->GetArray(name.c_str());
        const vtkIdType points = inputs[i]->GetNumberOfPoints();
        if (points == 0) return {};
        if (!array)
            throw Error(
                entry("Masks", i), name,
                "neither the base nor input " + std::to_string(i) + " has an array of points of this name");
        if (array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != points)
            throw Error(entry("Masks", i), name, "must be one number for each point");
        std::vector<float> mask;
        mask.reserve(static_cast<std::size_t>(points));
        for (const double value : vtk::DataArrayValueRange(array)) {
            if (!std::isfinite(static_cast<float>(value)))
                throw Error(entry("Masks", i), name,
                            "it is " + anamorph::shortest(value) + " at point " +
                                std::to_string(mask.size()) + ", but must be finite");
            mask.push_back(static_cast<float>(value));
        }
        return mask;
    }

    template <class T>
    void run_job(const Job& job, const std::function<void(vtkIdType)>& advance) const {
        const int components = job.to->GetNumberOfComponents();
        const vtkIdType points = job.to->GetNumberOfTuples();
        std::vector<Values<T>> from;
        for (const auto& array : job.from) from.emplace_back(array);
        T* to = vtkAOSDataArrayTemplate<T>::FastDownCast(job.to)->GetPointer(0);
        for (vtkIdType first = 0; first < points; first += kStretch) {
            const vtkIdType count = std::min(kStretch, points - first);
            T* out = to + first * components;
            if (m_options.deltas)
                run_deltas(job, from, first, count, components, out);
            else
                run_sum(from, first, count, components, out);
            if (job.unit) renormalize(out, count, components);
            advance(count * components);
        }
    }

    template <class T>
    void run_sum(const std::vector<Values<T>>& from, vtkIdType first, vtkIdType count, int components,
                 T* out) const {
        std::vector<const T*> shapes;
        for (const Values<T>& values : from) shapes.push_back(values.data() + first * components);
        anamorph::inbetween<T>(shapes, m_options.weights, anamorph::WeightSum::checked, count, components,
                               out, anamorph::smp_for);
    }

    template <class T>
    void run_deltas(const Job& job, const std::vector<Values<T>>& from, vtkIdType first, vtkIdType count,
                    int components, T* out) const {
        std::vector<const T*> shapes;
        std::vector<double> weights;
        std::vector<const float*> masks;
        for (std::size_t i = 0; i < from.size(); ++i) {
            if (i == m_options.base) continue;
            shapes.push_back(from[i].data() + first * components);
            weights.push_back(m_options.weights[i]);
            const bool masked = !(*job.masks)[i].empty();
            masks.push_back(masked ? (*job.masks)[i].data() + first : nullptr);
        }
        anamorph::inbetween_from_base<T>(from[m_options.base].data() + first * components, shapes, weights,
                                         masks, count, components, out, anamorph::smp_for);
    }

    Options m_options;
    std::vector<Job> m_jobs;
};

// ---- Composites ----

struct Leaf {
    unsigned int flat_index;
    vtkDataObject* data;  ///< may be null
};

std::vector<Leaf> leaves_of(vtkDataObject* object) {
    auto* composite = vtkCompositeDataSet::SafeDownCast(object);
    if (!composite) return {{0, object}};
    std::vector<Leaf> leaves;
    const auto iterator = vtk::TakeSmartPointer(composite->NewIterator());
    iterator->SkipEmptyNodesOff();
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
        leaves.push_back({iterator->GetCurrentFlatIndex(), iterator->GetCurrentDataObject()});
    return leaves;
}

using LeavesByInput = std::vector<std::vector<Leaf>>;

std::string part_of(const Leaf& leaf) {
    return leaf.flat_index ? "block " + std::to_string(leaf.flat_index) + " of " : "";
}

const char* class_of(vtkDataObject* object) {
    return object ? object->GetClassName() : "missing piece";
}

std::string named(const std::string& part, std::size_t input, const std::string& words, std::size_t base) {
    return part + "input " + std::to_string(input) + " " + words + " (compared with input " +
           std::to_string(base) + ")";
}

void check_class(const std::string& part, std::size_t i, vtkDataObject* object, std::size_t base,
                 vtkDataObject* wanted) {
    if (std::string(class_of(object)) != class_of(wanted))
        throw Error(
            named(part, i, std::string("is a ") + class_of(object) + ", not a " + class_of(wanted), base));
}

/// The leaves of all inputs; the same ones, or an Error.
LeavesByInput matching_leaves(const std::vector<vtkSmartPointer<vtkDataObject>>& inputs, std::size_t base) {
    LeavesByInput leaves;
    for (vtkDataObject* input : inputs) leaves.push_back(leaves_of(input));
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        check_class("", i, inputs[i], base, inputs[base]);
        const auto same = [](const Leaf& a, const Leaf& b) { return a.flat_index == b.flat_index; };
        if (!std::equal(leaves[i].begin(), leaves[i].end(), leaves[base].begin(), leaves[base].end(), same))
            throw Error(named("", i, "has other blocks", base));
    }
    return leaves;
}

/// Do two data sets have the same points, to the bit?
bool have_same_points(vtkPointSet* a, vtkPointSet* b) {
    vtkDataArray *x = a->GetPoints()->GetData(), *y = b->GetPoints()->GetData();
    return x->GetDataType() == y->GetDataType() && x->GetNumberOfValues() == y->GetNumberOfValues() &&
           std::memcmp(x->GetVoidPointer(0), y->GetVoidPointer(0),
                       static_cast<std::size_t>(x->GetNumberOfValues()) *
                           static_cast<std::size_t>(x->GetDataTypeSize())) == 0;
}

/// One leaf of all inputs; nothing if it is missing in all of them. Grids with the same axes share their points.
std::vector<vtkSmartPointer<vtkPointSet>> point_sets(const LeavesByInput& leaves, std::size_t leaf,
                                                     std::size_t base) {
    vtkDataObject* wanted = leaves[base][leaf].data;
    const std::string part = part_of(leaves[base][leaf]);
    for (std::size_t i = 0; i < leaves.size(); ++i) check_class(part, i, leaves[i][leaf].data, base, wanted);
    if (!wanted) return {};
    std::vector<vtkSmartPointer<vtkPointSet>> result;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        vtkDataObject* data = leaves[i][leaf].data;
        result.push_back(anamorph_vtk::with_explicit_points(data));
        if (!result.back())
            throw Error(named(part, base,
                              std::string("is a ") + class_of(wanted) +
                                  ", not a point set, image data or a rectilinear grid",
                              base));
        if (result.back() != data && have_same_points(result.back(), result.front()))
            result.back()->SetPoints(result.front()->GetPoints());
    }
    return result;
}

}  // namespace

vtkAnamorphInbetween::vtkAnamorphInbetween() = default;
vtkAnamorphInbetween::~vtkAnamorphInbetween() = default;

// ---- Properties ----

namespace {

/// Lists grow to the index that is set. True if something changed.
template <class T>
bool set_entry(vtkObject* object, std::vector<T>& list, int index, const T& value) {
    if (index < 0 || index >= kMostEntries) {
        vtkErrorWithObjectMacro(
            object, << "index=" << index << ": must be an integer from 0 to " << kMostEntries - 1);
        return false;
    }
    const auto i = static_cast<std::size_t>(index);
    if (i < list.size() && list[i] == value) return false;
    if (i >= list.size()) list.resize(i + 1);
    list[i] = value;
    return true;
}

template <class T>
bool set_size(vtkObject* object, std::vector<T>& list, int count) {
    if (count < 0 || count > kMostEntries) {
        vtkErrorWithObjectMacro(object,
                                << "count=" << count << ": must be an integer from 0 to " << kMostEntries);
        return false;
    }
    if (static_cast<std::size_t>(count) == list.size()) return false;
    list.resize(static_cast<std::size_t>(count));
    return true;
}

template <class T>
T get_entry(const std::vector<T>& list, int index) {
    return index >= 0 && static_cast<std::size_t>(index) < list.size() ? list[static_cast<std::size_t>(index)]
                                                                       : T{};
}

}  // namespace

void vtkAnamorphInbetween::SetNumberOfWeights(int count) {
    if (set_size(this, this->Weights, count)) this->Modified();
}

void vtkAnamorphInbetween::SetWeight(int index, double weight) {
    if (set_entry(this, this->Weights, index, weight)) this->Modified();
}

double vtkAnamorphInbetween::GetWeight(int index) {
    return get_entry(this->Weights, index);
}

void vtkAnamorphInbetween::SetNumberOfMasks(int count) {
    if (set_size(this, this->Masks, count)) this->Modified();
}

void vtkAnamorphInbetween::SetMaskArrayName(int index, const char* name) {
    if (set_entry(this, this->Masks, index, std::string(name ? name : ""))) this->Modified();
}

const char* vtkAnamorphInbetween::GetMaskArrayName(int index) {
    return index >= 0 && index < this->GetNumberOfMasks()
               ? this->Masks[static_cast<std::size_t>(index)].c_str()
               : "";
}

void vtkAnamorphInbetween::SetNumberOfKeys(int count) {
    if (set_size(this, this->Keys, count)) this->Modified();
}

void vtkAnamorphInbetween::SetKey(int index, double time, int input, double weight) {
    if (set_entry(this, this->Keys, index, Key{time, input, weight})) this->Modified();
}

void vtkAnamorphInbetween::AddKey(double time, int input, double weight) {
    this->SetKey(this->GetNumberOfKeys(), time, input, weight);
}

void vtkAnamorphInbetween::SetKeyNumbers(int index, double time, double input, double weight) {
    const bool whole = input >= 0 && input <= VTK_INT_MAX && input == std::floor(input);
    this->SetKey(index, time, whole ? static_cast<int>(input) : -1, weight);
}

double vtkAnamorphInbetween::GetKeyTime(int index) {
    return get_entry(this->Keys, index).Time;
}
int vtkAnamorphInbetween::GetKeyInput(int index) {
    return get_entry(this->Keys, index).Input;
}
double vtkAnamorphInbetween::GetKeyWeight(int index) {
    return get_entry(this->Keys, index).Weight;
}

// ---- Weights ----

std::vector<double> vtkAnamorphInbetween::CheckedSum(const std::vector<double>& weights) const {
    if (this->Mode == DELTAS) return weights;
    return anamorph::inbetween_weights(
        weights, this->NormalizeWeights ? anamorph::WeightSum::normalized : anamorph::WeightSum::checked);
}

std::vector<double> vtkAnamorphInbetween::WeightsAt(int inputs, double time) const {
    if (!this->Keys.empty()) return this->WeightsOfKeysAt(inputs, time);
    const auto count = static_cast<std::size_t>(inputs);
    std::vector<double> weights = this->Weights;
    if (weights.empty()) weights.assign(count, this->Mode == DELTAS ? 0 : 1.0 / inputs);
    if (weights.size() != count)
        throw Error("Weights", std::to_string(weights.size()) + " numbers",
                    "must be none, or one for each input, " + std::to_string(count));
    return this->CheckedSum(weights);
}

std::vector<double> vtkAnamorphInbetween::WeightsOfKeysAt(int inputs, double time) const {
    std::vector<anamorph::ShapeKey> keys;
    for (const Key& key : this->Keys) keys.push_back({key.Time, static_cast<double>(key.Input), key.Weight});
    anamorph::ShapeFrames frames = anamorph::frames_of_keys(keys, inputs, "Input", "an input");
    for (std::size_t k = 0; k < frames.times.size(); ++k) {
        try {
            frames.weights[k] = this->CheckedSum(frames.weights[k]);
        } catch (const Error& error) {
            throw Error("Keys at time " + anamorph::shortest(frames.times[k]) + ": " + error.what());
        }
    }
    using anamorph::KeyInterpolation;
    static_assert(STEP == static_cast<int>(KeyInterpolation::step) &&
                  LINEAR == static_cast<int>(KeyInterpolation::linear) &&
                  CATMULL_ROM == static_cast<int>(KeyInterpolation::catmull_rom) &&
                  MONOTONE_CUBIC == static_cast<int>(KeyInterpolation::monotone_cubic));
    const auto interpolation = static_cast<KeyInterpolation>(this->Interpolation);
    const std::vector<double> weights =
        anamorph::KeyFrames(frames.times, frames.weights, interpolation).at(time);
    if (this->Mode == DELTAS || this->Interpolation != MONOTONE_CUBIC) return weights;
    return anamorph::inbetween_weights(weights, anamorph::WeightSum::normalized);
}

// ---- The pipeline ----

/// Throws Error unless all have the topology of the base. What was compared before is not compared again.
void vtkAnamorphInbetween::CheckTopology(const std::vector<vtkSmartPointer<vtkPointSet>>& surfaces,
                                         const std::string& part, std::set<Pair>& same) const {
    const auto base_index = static_cast<std::size_t>(this->BaseIndex);
    vtkPointSet* base = surfaces[base_index];
    std::vector<bool> unknown;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const Pair pair(base, base->GetMTime(), surfaces[i], surfaces[i]->GetMTime());
        unknown.push_back(i != base_index && !this->SameTopology.count(pair));
        same.insert(pair);
    }
    const std::vector<bool> alike = have_same_arrays(surfaces, unknown, base_index);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!unknown[i] || alike[i]) continue;
        const std::string words = topology_differs(base, surfaces[i]);
        if (!words.empty()) throw Error(named(part, i, words, base_index));
    }
}

int vtkAnamorphInbetween::FillInputPortInformation(int, vtkInformation* info) {
    anamorph_vtk::require_points(info);
    info->Set(INPUT_IS_REPEATABLE(), 1);
    return 1;
}

int vtkAnamorphInbetween::RequestDataObject(vtkInformation*, vtkInformationVector** inputs,
                                            vtkInformationVector* outputs) {
    const int count = inputs[0]->GetNumberOfInformationObjects();
    if (count == 0) return 1;
    const int base = std::clamp(this->BaseIndex, 0, count - 1);
    return anamorph_vtk::guarded(this, [&] {
        anamorph_vtk::make_output_of_points(outputs->GetInformationObject(0),
                                            vtkDataObject::GetData(inputs[0], base),
                                            ("input " + std::to_string(base)).c_str());
    });
}

int vtkAnamorphInbetween::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                             vtkInformationVector* outputs) {
    const auto inform = [&] { this->Inform(inputs[0], outputs->GetInformationObject(0)); };
    return anamorph_vtk::guarded(this, inform, {vtkDataObject::GetData(outputs)});
}

/// The times of the output. Throws Error.
void vtkAnamorphInbetween::Inform(vtkInformationVector* inputs, vtkInformation* output) const {
    const int count = inputs->GetNumberOfInformationObjects();
    const int base = std::clamp(this->BaseIndex, 0, std::max(count - 1, 0));
    std::set<double> steps;
    double range[2] = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto widen = [&](double time) {
        range[0] = std::min(range[0], time);
        range[1] = std::max(range[1], time);
    };
    for (const Key& key : this->Keys)
        if (std::isfinite(key.Time)) steps.insert(key.Time);
    for (int i = 0; i < count; ++i) {
        vtkInformation* info = inputs->GetInformationObject(i);
        const double* input_steps = info->Get(Executive::TIME_STEPS());
        for (int k = 0; k < info->Length(Executive::TIME_STEPS()); ++k) steps.insert(input_steps[k]);
        if (const double* input_range = info->Get(Executive::TIME_RANGE())) {
            widen(input_range[0]);
            widen(input_range[1]);
        }
        // Pieces of structured inputs are extents, so the whole has to agree before they are asked for.
        const int *extent = info->Get(Executive::WHOLE_EXTENT()),
                  *base_extent = inputs->GetInformationObject(base)->Get(Executive::WHOLE_EXTENT());
        if (extent && base_extent && !std::equal(extent, extent + 6, base_extent))
            throw Error("input " + std::to_string(i) + " is a grid of another extent than input " +
                        std::to_string(base));
    }
    for (const double step : steps) widen(step);

    output->Remove(Executive::TIME_STEPS());
    output->Remove(Executive::TIME_RANGE());
    const std::vector<double> list(steps.begin(), steps.end());
    if (!list.empty()) output->Set(Executive::TIME_STEPS(), list.data(), static_cast<int>(list.size()));
    if (range[0] <= range[1]) output->Set(Executive::TIME_RANGE(), range, 2);
}

int vtkAnamorphInbetween::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                              vtkInformationVector* outputs) {
    vtkInformation* output = outputs->GetInformationObject(0);
    for (int i = 0; i < inputs[0]->GetNumberOfInformationObjects(); ++i)
        inputs[0]->GetInformationObject(i)->CopyEntry(output, Executive::UPDATE_TIME_STEP());
    return 1;
}

int vtkAnamorphInbetween::RequestData(vtkInformation*, vtkInformationVector** input_vector,
                                      vtkInformationVector* output_vector) {
    vtkInformation* output_info = output_vector->GetInformationObject(0);
    vtkDataObject* output = vtkDataObject::GetData(output_info);
    const int count = input_vector[0]->GetNumberOfInformationObjects();
    if (!output || count == 0) return 1;
    output->Initialize();
    const auto execute = [&] {
        if (this->BaseIndex < 0 || this->BaseIndex >= count)
            throw Error("BaseIndex", std::to_string(this->BaseIndex),
                        "must be an input from 0 to " + std::to_string(count - 1));
        const auto base = static_cast<std::size_t>(this->BaseIndex);
        double time =
            this->Keys.empty()
                ? 0
                : std::min_element(this->Keys.begin(), this->Keys.end(), [](const Key& a, const Key& b) {
                      return a.Time < b.Time;
                  })->Time;
        if (output_info->Has(Executive::UPDATE_TIME_STEP()))
            time = output_info->Get(Executive::UPDATE_TIME_STEP());
        Blend blend({this->WeightsAt(count, time), this->Mode == DELTAS, base, this->Masks,
                     this->Normals == DROP_NORMALS, this->OutputPointsPrecision});

        std::vector<vtkSmartPointer<vtkDataObject>> inputs;
        for (int i = 0; i < count; ++i)
            inputs.push_back(anamorph_vtk::without_levels(vtkDataObject::GetData(input_vector[0], i)));
        const LeavesByInput leaves = matching_leaves(inputs, base);
        auto* composite = vtkCompositeDataSet::SafeDownCast(inputs[base]);
        vtkSmartPointer<vtkCompositeDataIterator> at;
        if (composite) {
            vtkCompositeDataSet::SafeDownCast(output)->CopyStructure(composite);
            output->GetFieldData()->PassData(composite->GetFieldData());
            at = vtk::TakeSmartPointer(composite->NewIterator());
            at->SkipEmptyNodesOff();
            at->InitTraversal();
        }
        std::set<Pair> same_topology;
        for (std::size_t leaf = 0; leaf < leaves[base].size(); ++leaf) {
            const std::vector<vtkSmartPointer<vtkPointSet>> surfaces = point_sets(leaves, leaf, base);
            if (!surfaces.empty()) {
                this->CheckTopology(surfaces, part_of(leaves[base][leaf]), same_topology);
                vtkSmartPointer<vtkPointSet> result = vtkPointSet::SafeDownCast(output);
                if (composite) result = vtk::TakeSmartPointer(surfaces[base]->NewInstance());
                result->ShallowCopy(surfaces[base]);
                blend.add(surfaces, result);
                if (composite) vtkCompositeDataSet::SafeDownCast(output)->SetDataSet(at, result);
            }
            if (composite) at->GoToNextItem();
        }
        this->SameTopology = std::move(same_topology);
        anamorph_vtk::Execution execution(this);
        blend.run(execution);
        if (!this->Keys.empty()) output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    };
    return anamorph_vtk::guarded(this, execute, {output});
}

void vtkAnamorphInbetween::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Mode: " << (this->Mode == DELTAS ? "deltas" : "weighted sum") << "\n"
       << indent << "BaseIndex: " << this->BaseIndex << "\n"
       << indent << "NormalizeWeights: " << this->NormalizeWeights << "\n"
       << indent << "Interpolation: " << this->Interpolation << "\n"
       << indent << "Normals: " << this->Normals << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n"
       << indent << "Weights:";
    for (const double weight : this->Weights) os << " " << weight;
    os << "\n" << indent << "Masks:";
    for (const std::string& mask : this->Masks) os << " \"" << mask << "\"";
    os << "\n" << indent << "Keys (time, input, weight):";
    for (const Key& key : this->Keys)
        os << " (" << key.Time << ", " << key.Input << ", " << key.Weight << ")";
    os << "\n";
}
