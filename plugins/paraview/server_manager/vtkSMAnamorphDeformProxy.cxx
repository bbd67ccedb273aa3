// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphDeformProxy.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "deformation_frame.h"
#include "session_views.h"
#include "vtkClientServerStream.h"
#include "vtkCommand.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkPVDataInformation.h"
#include "vtkRenderer.h"
#include "vtkSMOutputPort.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxySelectionModel.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMTrace.h"
#include "vtkSmartPointer.h"

using namespace anamorph_paraview;

vtkStandardNewMacro(vtkSMAnamorphDeformProxy);

namespace {

/// Holds a flag up.
struct WhileHeld {
    explicit WhileHeld(bool& held) : flag(held), before(held) { flag = true; }
    ~WhileHeld() { flag = before; }
    WhileHeld(const WhileHeld&) = delete;
    WhileHeld& operator=(const WhileHeld&) = delete;

    bool& flag;
    bool before;
};

}  // namespace

/// What was set since the last update.
struct vtkSMAnamorphDeformProxy::Edits {
    bool begun = false;
    std::vector<double> list;  ///< without what the handles do
    std::optional<Point> center, corner, vector, tip;
    std::optional<Frame> frame;  ///< that the handles are shown in
    bool depths = false;         ///< Depths is set
    bool frames = false;         ///< Frames is set
};

namespace {

std::vector<double> numbers_of(vtkSMProxy* proxy, const char* name) {
    return vtkSMPropertyHelper(proxy, name, true).GetDoubleArray();
}

/// `unchecked`: as a panel or a handle has it, before it is applied.
std::optional<Point> point_of(vtkSMProxy* proxy, const char* name, bool unchecked = false) {
    vtkSMPropertyHelper helper(proxy, name, true);
    helper.SetUseUnchecked(unchecked);
    const std::vector<double> numbers = helper.GetDoubleArray();
    if (numbers.size() != 3) return std::nullopt;
    return Point{numbers[0], numbers[1], numbers[2]};
}

/// Changes nothing where the numbers are the same.
void set_numbers(vtkSMProxy* proxy, const char* name, const double* numbers, std::size_t count) {
    vtkSMPropertyHelper(proxy, name, true).Set(numbers, static_cast<unsigned int>(count));
}

/// A row of the list, and the plane that its numbers are on.
struct Row {
    double* numbers;
    Frame frame;

    double center(unsigned int i) const { return numbers[kCenter + i]; }
    double corner(unsigned int i) const { return numbers[kCenter + i] + numbers[kExtent + i]; }

    void move_center(const Point& handle) const {
        if (frame.is_over(center(0), center(1), handle)) return;
        const Point at = frame.parameters(handle);
        for (unsigned int i = 0; i < 2; ++i) numbers[kCenter + i] = at[i];
    }
    /// A corner beside the centre tells no extent that way.
    void move_corner(const Point& handle) const {
        if (frame.is_over(corner(0), corner(1), handle)) return;
        const Point at = frame.parameters(handle);
        for (unsigned int i = 0; i < 2; ++i)
            if (const double extent = std::fabs(at[i] - center(i)); extent > 0) numbers[kExtent + i] = extent;
    }
    /// The vector from the centre's handle to that of the tip, unless it is where the row has it.
    void move_tip(const Point& tip, const Point& from) const {
        for (unsigned int c = 0; c < 3; ++c)
            if (tip[c] != from[c] + numbers[kVector + c]) numbers[kVector + c] = tip[c] - from[c];
    }
    void set_vector(const Point& vector) const { std::copy(vector.begin(), vector.end(), numbers + kVector); }
};

/// The row that is selected. None where there is none, or the plane is not known yet.
std::optional<Row> selected_row(vtkSMProxy* proxy, std::vector<double>& list) {
    const unsigned int columns = columns_of(proxy->GetProperty("Deformations"));
    const int selected = vtkSMPropertyHelper(proxy, "SelectedDeformation", true).GetAsInt();
    if (columns < kLeastColumns || selected < 0) return std::nullopt;
    const std::size_t first = static_cast<std::size_t>(selected) * columns;
    const std::optional<Frame> frame = frame_of(proxy);
    if (!frame || list.size() < first + columns) return std::nullopt;
    return Row{list.data() + first, *frame};
}

/// How far from the plane the centre's handle is: where it is, if it was put there, or as high as the surface.
double height_of_handles(vtkSMProxy* proxy, const Row& row, bool put, double surface) {
    const std::optional<Point> at = point_of(proxy, "SelectedCenter");
    return put && at ? row.frame.parameters(*at)[2] : surface;
}

constexpr const char* kHandles[3] = {"SelectedCenter", "SelectedCorner", "SelectedTip"};

// ---- The table ----

/// A column of the table: which property has it, and where.
struct Column {
    std::size_t part, at;
};
constexpr const char* kParts[3] = {"Deformations", "Depths", "Frames"};
constexpr std::size_t kPartColumns[3] = {9, 3, 7};
constexpr Column kTable[] = {{0, 0}, {0, 1}, {1, 0}, {0, 2}, {0, 3}, {1, 1}, {0, 4}, {0, 5}, {0, 6}, {0, 7},
                             {0, 8}, {1, 2}, {2, 0}, {2, 1}, {2, 2}, {2, 3}, {2, 4}, {2, 5}, {2, 6}};
/// The numbers of the default bump: those of Deformations, Depths and the turn of Frames, and Subdivisions; and the extent in depth among them.
constexpr std::size_t kDefaultNumbers = 17, kDefaultDepth = 10, kDefaultSubdivisions = 16;
constexpr std::size_t kTableColumns = sizeof(kTable) / sizeof(kTable[0]);

/// What rows that a part does not have are.
double standard_of(const Column& column) {
    return column.part == 2 && column.at == 0 ? 1 : 0;
}

/// Are all rows of Frames as those of new deformations?
bool is_plain(const std::vector<double>& frames) {
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (frames[i] != standard_of({2, i % kPartColumns[2]})) return false;
    return true;
}

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

vtkSMAnamorphDeformProxy::vtkSMAnamorphDeformProxy() : Pending(std::make_unique<Edits>()) {
    this->AddObserver(vtkCommand::UpdatePropertyEvent, this, &vtkSMAnamorphDeformProxy::PropertyPushed);
    this->Mouse =
        std::make_unique<ViewMouse>([this](vtkSMRenderViewProxy* view, const std::array<int, 2>& at,
                                           bool control) { this->ViewClicked(view, at[0], at[1], control); });
}
vtkSMAnamorphDeformProxy::~vtkSMAnamorphDeformProxy() = default;

void vtkSMAnamorphDeformProxy::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphDeformProxy::ReadXMLAttributes(vtkSMSessionProxyManager* manager, vtkPVXMLElement* element) {
    const int read = this->Superclass::ReadXMLAttributes(manager, element);
    this->InStep = false;
    for (const char* name : kHandles)
        if (vtkSMProperty* handle = this->GetProperty(name))
            handle->AddObserver(vtkCommand::UncheckedPropertyModifiedEvent, this,
                                &vtkSMAnamorphDeformProxy::HandleDragged);
    return read;
}

void vtkSMAnamorphDeformProxy::SetPropertyModifiedFlag(const char* name, int flag) {
    this->Superclass::SetPropertyModifiedFlag(name, flag);
    if (flag == 0 || this->InStep) return;
    const WhileHeld step(this->InStep);
    if (is_one_of(name, {"ImportFile", "ExportFile"})) this->FilesPending = true;
    // Where rows are set anew, so are their depths: the server then has those of the rows that there are.
    if (is_one_of(name, {"Deformations"})) {
        this->ForgetDefault(true);
        this->Superclass::SetPropertyModifiedFlag("Depths", 1);
        this->Superclass::SetPropertyModifiedFlag("Frames", 1);
        this->ListEdited = true;
    }
    if (is_one_of(name, {"Depths"})) this->Pending->depths = true;
    if (is_one_of(name, {"Frames"})) this->Pending->frames = true;
    if (is_one_of(name, {"Bumps"})) {
        // Rows may be set number by number.
        if (numbers_of(this, "Bumps").size() % kTableColumns != 0) return;
        this->SplitBumps();
        this->ForgetDefault(false);
        name = "Deformations";
    }
    if (is_one_of(name,
                  {"SelectedCenter", "SelectedCorner", "SelectedTip", "SelectedVector", "SelectedDeformation",
                   "Deformations", "Input", "ParameterMode", "AutomaticPlane", "Origin", "Axis1", "Axis2"}))
        this->Edited(name);
    this->ShowBumps();
}

int vtkSMAnamorphDeformProxy::LoadXMLState(vtkPVXMLElement* element, vtkSMProxyLocator* locator) {
    const WhileHeld loading(this->InStep);
    *this->Pending = Edits();
    const int loaded = this->Superclass::LoadXMLState(element, locator);
    this->ShowBumps();  // states from before there was the table have its parts
    return loaded;
}

void vtkSMAnamorphDeformProxy::LoadState(const vtkSMMessage* message, vtkSMProxyLocator* locator) {
    const WhileHeld loading(this->InStep);
    *this->Pending = Edits();
    this->Superclass::LoadState(message, locator);
}

void vtkSMAnamorphDeformProxy::UpdateVTKObjects() {
    if (this->GetProperty("Bumps") && numbers_of(this, "Bumps").size() % kTableColumns != 0) {
        // The superclass says that the last row is not whole; the others count.
        this->Superclass::UpdateVTKObjects();
        const WhileHeld step(this->InStep);
        this->SplitBumps();
        this->Edited("Deformations");
        this->ShowBumps();
    }
    this->DraggedRow.clear();  // what is applied is what the handles say, or they are put back
    // Not before: who sets a list may change its length first, and its numbers then.
    this->RemoveDepths();
    if (!this->FilesPending) {
        this->Superclass::UpdateVTKObjects();
        return;
    }
    this->FilesPending = false;
    // What is done once is not done again by a state or an undo.
    vtkSMPropertyHelper import_file(this, "ImportFile"), export_file(this, "ExportFile");
    const std::string file = import_file.GetAsString();
    import_file.Set("");
    if (!file.empty()) this->ImportDeformations(file.c_str());
    this->Superclass::UpdateVTKObjects();
    export_file.Set("");
    this->FilesPending = false;
    this->Superclass::UpdateVTKObjects();
}

/// Through a filter of its own: a trace would take what is asked of this one for what was set.
void vtkSMAnamorphDeformProxy::ImportDeformations(const char* file) {
    const auto reader = vtk::TakeSmartPointer(vtkSMAnamorphDeformProxy::SafeDownCast(
        this->GetSessionProxyManager()->NewProxy(this->GetXMLGroup(), this->GetXMLName())));
    if (!reader) return;
    reader->SetLocation(this->GetLocation());
    const WhileHeld step(reader->InStep);
    const std::vector<double> list = numbers_of(this, "Deformations");
    set_numbers(reader, "Deformations", list.data(), list.size());
    reader->UpdateProperty("Deformations");
    vtkSMPropertyHelper(reader, "ImportFile").Set(file);
    reader->UpdateProperty("ImportFile");
    reader->UpdatePropertyInformation(reader->GetProperty("DeformationsInfo"));
    const std::vector<double> read = numbers_of(reader, "DeformationsInfo");
    set_numbers(this, "Deformations", read.data(), read.size());
    reader->UpdatePropertyInformation(reader->GetProperty("DepthsInfo"));
    const std::vector<double> depths = numbers_of(reader, "DepthsInfo");
    const bool any = std::any_of(depths.begin(), depths.end(), [](double depth) { return depth != 0; });
    set_numbers(this, "Depths", depths.data(), any ? depths.size() : 0);
    reader->UpdatePropertyInformation(reader->GetProperty("FramesInfo"));
    const std::vector<double> frames = numbers_of(reader, "FramesInfo");
    set_numbers(this, "Frames", frames.data(), is_plain(frames) ? 0 : frames.size());
    reader->UpdatePropertyInformation(reader->GetProperty("NamesInfo"));
    vtkSMPropertyHelper names(this, "Names");
    const vtkSMPropertyHelper names_read(reader, "NamesInfo");
    names.SetNumberOfElements(names_read.GetNumberOfElements());
    for (unsigned int i = 0; i < names_read.GetNumberOfElements(); ++i)
        names.Set(i, names_read.GetAsString(i));
    this->ShowBumps();
}

// ---- The bump that a new list begins with ----

std::vector<double> vtkSMAnamorphDeformProxy::DefaultRow(vtkSMProperty* property) {
    const std::string name = this->GetPropertyName(property);
    if (name == "Deformations") this->FindDefault();
    std::size_t first = 0;
    for (std::size_t p = 0; p < 3 && !this->DefaultBump.empty(); first += kPartColumns[p++]) {
        // Frames are of 7 numbers, of which the bump has a turn; nothing else of them is not as in a new one.
        std::vector<double> part(kPartColumns[p], 0);
        const auto begin = this->DefaultBump.begin() + static_cast<std::ptrdiff_t>(first);
        std::copy_n(begin, std::min(part.size(), kDefaultSubdivisions - first), part.begin());
        if (p > 0 && this->DefaultBump[kDefaultDepth] == 0) return {};
        if (name == kParts[p]) return part;
        if (numbers_of(this, kParts[p]) != part) return {};
    }
    return {};
}

int vtkSMAnamorphDeformProxy::DefaultSubdivisions() {
    const std::vector<double> list = numbers_of(this, "Deformations");
    const bool is_default = !this->DefaultBump.empty() && list.size() == kPartColumns[0] &&
                            std::equal(list.begin(), list.end(), this->DefaultBump.begin());
    return is_default ? static_cast<int>(this->DefaultBump[kDefaultSubdivisions]) : 0;
}

void vtkSMAnamorphDeformProxy::SetDefault(const std::function<void()>& set) {
    const bool depths = this->Pending->depths, frames = this->Pending->frames;
    set();
    this->Pending->depths = depths;
    this->Pending->frames = frames;
}

/// Lets a filter of its own, with the same input, look for it.
void vtkSMAnamorphDeformProxy::FindDefault() {
    this->DefaultBump.clear();
    const char* file = vtkSMPropertyHelper(this, "FileName", true).GetAsString();
    if ((file && *file) || vtkSMPropertyHelper(this, "Table", true).GetNumberOfElements() > 0) return;
    double bounds[6];
    if (!input_bounds(this, bounds)) return;
    const auto seeker = vtk::TakeSmartPointer(vtkSMAnamorphDeformProxy::SafeDownCast(
        this->GetSessionProxyManager()->NewProxy(this->GetXMLGroup(), this->GetXMLName())));
    if (!seeker) return;
    seeker->SetLocation(this->GetLocation());
    const WhileHeld step(seeker->InStep);
    for (const char* name : {"Input", "ParameterMode", "AutomaticPlane", "Origin", "Axis1", "Axis2"})
        seeker->GetProperty(name)->Copy(this->GetProperty(name));
    vtkSMPropertyHelper(seeker, "ComputeNormals").Set(0);
    vtkSMPropertyHelper(seeker, "ComputeDisplacement").Set(0);
    seeker->UpdateVTKObjects();
    vtkSMOutputPort* port = vtkSMPropertyHelper(this, "Input", true).GetAsOutputPort();
    // At the time that the input is of, so that it does not execute again.
    vtkPVDataInformation* information = port->GetDataInformation();
    if (information->GetHasTime())
        seeker->UpdatePipeline(information->GetTime());
    else
        seeker->UpdatePipeline();
    seeker->Find("FindDefault");
    seeker->UpdatePropertyInformation(seeker->GetProperty("DefaultDeformation"));
    const std::vector<double> found = numbers_of(seeker, "DefaultDeformation");
    constexpr std::size_t kExtentAt = 2;  // 0 where there is nothing
    if (found.size() == kDefaultNumbers && found[kExtentAt] > 0) this->DefaultBump = found;
}

/// Another list than the default, or one made of it, has nothing else by it. alone: without depths, of which older scripts know nothing, so
/// that a bump that is elsewhere is another.
void vtkSMAnamorphDeformProxy::ForgetDefault(bool alone) {
    if (this->DefaultBump.empty()) return;
    std::vector<double>& bump = this->DefaultBump;
    const std::vector<double> list = numbers_of(this, "Deformations");
    std::size_t changed = 0;
    const bool whole = list.size() >= kPartColumns[0];
    for (std::size_t i = 0; whole && i < kPartColumns[0]; ++i) changed += list[i] != bump[i];
    const bool stands = whole && list[0] == bump[0] && list[1] == bump[1];
    if (whole && (stands || !alone) && changed <= kPartColumns[0] / 2) {
        std::copy_n(list.begin(), kPartColumns[0], bump.begin());  // the next edit is one of this
        return;
    }
    const auto is_default = [&](std::size_t part, std::size_t first, std::size_t count) {
        const std::vector<double> rows = numbers_of(this, kParts[part]);
        return rows.size() == kPartColumns[part] &&
               std::equal(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count),
                          bump.begin() + static_cast<std::ptrdiff_t>(first));
    };
    const bool set = this->Pending->depths || this->Pending->frames;
    if (!set && bump[kDefaultDepth] != 0 && is_default(1, kPartColumns[0], 3) &&
        is_default(2, kPartColumns[0] + kPartColumns[1], 4)) {
        set_numbers(this, "Depths", nullptr, 0);
        set_numbers(this, "Frames", nullptr, 0);
    }
    vtkSMPropertyHelper subdivisions(this, "Subdivisions");
    if (subdivisions.GetAsInt() == static_cast<int>(bump[kDefaultSubdivisions])) subdivisions.Set(0);
    this->DefaultBump.clear();
}

// ---- The list and the handles ----

namespace {

/// Which rows of a list a shorter one has kept, some perhaps edited: of all ways to remove so many rows the one in which the others change
/// the fewest numbers, later rows removed where several do. None where a row would change by more than half.
std::vector<std::size_t> kept_rows(const std::vector<double>& before, const std::vector<double>& after,
                                   std::size_t columns) {
    const std::size_t rows = before.size() / columns, left = after.size() / columns, gone = rows - left;
    const auto changes = [&](std::size_t from, std::size_t to) {
        std::size_t sum = 0;
        for (std::size_t c = 0; c < columns; ++c)
            sum += before[from * columns + c] != after[to * columns + c];
        return sum > columns / 2 ? rows * columns : sum;
    };
    // least[i][k]: of the rows from i on, after k rows before it were removed.
    std::vector<std::size_t> least((rows + 1) * (gone + 1), rows * columns);
    const auto at = [&](std::size_t i, std::size_t k) -> std::size_t& { return least[i * (gone + 1) + k]; };
    at(rows, gone) = 0;
    for (std::size_t i = rows; i-- > 0;)
        for (std::size_t k = 0; k <= std::min(gone, i); ++k) {
            if (i - k < left) at(i, k) = std::min(at(i + 1, k) + changes(i, i - k), rows * columns);
            if (k < gone) at(i, k) = std::min(at(i, k), at(i + 1, k + 1));
        }
    std::vector<std::size_t> kept;
    if (at(0, 0) >= rows * columns) return kept;
    for (std::size_t i = 0, k = 0; i < rows; ++i)
        if (i - k < left && at(i, k) == at(i + 1, k) + changes(i, i - k))
            kept.push_back(i);
        else
            ++k;
    return kept;
}

}  // namespace

/// Gives the parts their columns of the table.
void vtkSMAnamorphDeformProxy::SplitBumps() {
    const std::vector<double> table = numbers_of(this, "Bumps");
    const std::size_t rows = table.size() / kTableColumns;
    std::vector<double> parts[3];
    for (std::size_t p = 0; p < 3; ++p) parts[p].resize(rows * kPartColumns[p]);
    for (std::size_t i = 0; i < rows * kTableColumns; ++i) {
        const Column& column = kTable[i % kTableColumns];
        parts[column.part][i / kTableColumns * kPartColumns[column.part] + column.at] = table[i];
    }
    // Without depths, or frames, there are no rows of them, as in lists that never had any.
    if (std::all_of(parts[1].begin(), parts[1].end(), [](double x) { return x == 0; })) parts[1].clear();
    if (is_plain(parts[2])) parts[2].clear();
    for (std::size_t p = 0; p < 3; ++p) {
        set_numbers(this, kParts[p], parts[p].data(), parts[p].size());
        this->Superclass::SetPropertyModifiedFlag(kParts[p], 1);
    }
    this->Pending->depths = this->Pending->frames = true;
}

/// Makes the table of its parts.
void vtkSMAnamorphDeformProxy::ShowBumps() {
    if (!this->GetProperty("Bumps")) return;
    std::vector<double> parts[3];
    for (std::size_t p = 0; p < 3; ++p) parts[p] = numbers_of(this, kParts[p]);
    std::vector<double> table;
    for (std::size_t row = 0; row < parts[0].size() / kPartColumns[0]; ++row)
        for (const Column& column : kTable) {
            const std::size_t at = row * kPartColumns[column.part] + column.at;
            table.push_back(at < parts[column.part].size() ? parts[column.part][at] : standard_of(column));
        }
    if (numbers_of(this, "Bumps") != table) set_numbers(this, "Bumps", table.data(), table.size());
}

/// Rows of the list that were removed take theirs of Depths and Frames along.
void vtkSMAnamorphDeformProxy::RemoveDepths() {
    if (!this->GetProperty("Deformations")) return;
    constexpr std::size_t kMost = std::size_t{1} << 24;  // steps of the comparison
    const WhileHeld step(this->InStep);
    const std::vector<double> before = this->KnownList, after = numbers_of(this, "Deformations");
    this->KnownList = after;
    if (!this->ListEdited) return;
    this->ListEdited = false;
    const bool set[3] = {true, this->Pending->depths, this->Pending->frames};
    const auto stays = [&](std::size_t p) { return set[p] || numbers_of(this, kParts[p]).empty(); };
    const std::size_t columns = columns_of(this->GetProperty("Deformations"));
    if ((stays(1) && stays(2)) || columns == 0 || after.size() >= before.size() ||
        before.size() % columns != 0 || after.size() % columns != 0)
        return;
    if (before.size() * (before.size() - after.size()) / columns > kMost) return;
    const std::vector<std::size_t> kept = kept_rows(before, after, columns);
    if (kept.empty() && !after.empty()) return;
    for (std::size_t p = 1; p < 3; ++p) {
        if (stays(p)) continue;
        const std::vector<double> all = numbers_of(this, kParts[p]);
        const auto at = [&](std::size_t row) {
            return all.begin() + static_cast<std::ptrdiff_t>(row * kPartColumns[p]);
        };
        std::vector<double> left;
        for (const std::size_t row : kept)
            if ((row + 1) * kPartColumns[p] <= all.size()) left.insert(left.end(), at(row), at(row + 1));
        set_numbers(this, kParts[p], left.data(), left.size());
    }
    this->ShowBumps();
}

void vtkSMAnamorphDeformProxy::Edited(const char* name) {
    Edits& edits = *this->Pending;
    const std::string changed = name;
    if (!edits.begun || changed == "Deformations") edits.list = numbers_of(this, "Deformations");
    edits.begun = true;
    if (changed == "SelectedCenter") {
        edits.center = point_of(this, name);
        this->HandlesPut = true;
    }
    if (changed == "SelectedCorner") edits.corner = point_of(this, name);
    if (changed == "SelectedVector") {
        edits.vector = point_of(this, name);
        edits.tip.reset();
    }
    if (changed == "SelectedTip") edits.tip = point_of(this, name);
    if (changed == "Input") this->UsedPlaneKnown = false;
    this->Resolve();
}

void vtkSMAnamorphDeformProxy::Resolve() {
    const Edits& edits = *this->Pending;
    // Where the plane is not known handles say nothing: what they did on another one stays.
    std::vector<double> list = frame_of(this) ? edits.list : numbers_of(this, "Deformations");
    if (const std::optional<Row> row = selected_row(this, list)) {
        if (edits.center) row->move_center(*edits.center);
        if (edits.corner) row->move_corner(*edits.corner);
        if (edits.vector) row->set_vector(*edits.vector);
        if (edits.tip) {
            // From where the centre's handle is to be shown, whatever is set first.
            const double height = height_of_handles(this, *row, this->HandlesPut, this->Heights[0]);
            row->move_tip(*edits.tip,
                          edits.center.value_or(row->frame.point(row->center(0), row->center(1), height)));
        }
    }
    set_numbers(this, "Deformations", list.data(), list.size());
    this->ShowHandles(false);
}

/// Where the row is, but for those that were put somewhere since the last update, unless all.
void vtkSMAnamorphDeformProxy::ShowHandles(bool all) {
    Edits& edits = *this->Pending;
    std::vector<double> list = numbers_of(this, "Deformations");
    const std::optional<Row> row = selected_row(this, list);
    const std::optional<Point> at = point_of(this, "SelectedCenter");
    if (!row || !at) return;
    edits.frame = row->frame;
    // They are on the deformed surface of the last update, or where they have been put across the plane since.
    const bool lifted = edits.center.has_value() || (this->HandlesPut && !all);
    const double height = height_of_handles(this, *row, lifted, this->Heights[0]),
                 corner_height = lifted ? height : this->Heights[1];
    if (all) this->HandlesPut = false;
    const auto show = [&](const char* name, bool put, const double* numbers) {
        if (all || !put) set_numbers(this, name, numbers, 3);
    };
    show("SelectedCenter", edits.center.has_value(),
         row->frame.point(row->center(0), row->center(1), height).data());
    show("SelectedCorner", edits.corner.has_value(),
         row->frame.point(row->corner(0), row->corner(1), corner_height).data());
    Point tip = point_of(this, "SelectedCenter").value_or(*at);
    for (unsigned int c = 0; c < 3; ++c) tip[c] += row->numbers[kVector + c];
    show("SelectedTip", edits.tip.has_value(), tip.data());
    show("SelectedVector", edits.vector.has_value() && !edits.tip, row->numbers + kVector);
}

// ---- The plane ----

void vtkSMAnamorphDeformProxy::PostUpdateData(bool using_cache) {
    const bool updated = this->NeedsUpdate;
    this->Superclass::PostUpdateData(using_cache);
    this->Mouse->watch(this);
    if (!updated || !this->DraggedRow.empty()) return;
    const WhileHeld step(this->InStep);
    this->Find("FindSelected");
    this->TakeUsedPlane();
    const bool moved = this->TakeHeights();
    const std::optional<Frame> shown = this->Pending->frame;
    *this->Pending = Edits();
    this->Pending->frame = shown;
    if (moved || frame_of(this) != shown || !this->TipIsShown()) this->ShowHandles(true);
}

const double* vtkSMAnamorphDeformProxy::GetUsedPlane() {
    const int mode = vtkSMPropertyHelper(this, "ParameterMode", true).GetAsInt();
    return this->UsedPlaneKnown && mode == this->UsedMode ? this->UsedPlane : nullptr;
}

void vtkSMAnamorphDeformProxy::TakeUsedPlane() {
    this->UsedMode = vtkSMPropertyHelper(this, "ParameterMode").GetAsInt();
    if (this->UsedMode != 0) {
        this->UpdatePropertyInformation(this->GetProperty("SelectedFrame"));
        vtkSMPropertyHelper(this, "SelectedFrame").Get(this->UsedPlane, 9);
        this->UsedPlaneKnown =
            std::any_of(this->UsedPlane + 3, this->UsedPlane + 9, [](double x) { return x != 0; });
        return;
    }
    this->UsedPlaneKnown = vtkSMPropertyHelper(this, "AutomaticPlane").GetAsInt() != 0;
    if (!this->UsedPlaneKnown) return;
    double* to = this->UsedPlane;
    for (const char* name : {"UsedOrigin", "UsedAxis1", "UsedAxis2"}) {
        this->UpdatePropertyInformation(this->GetProperty(name));
        vtkSMPropertyHelper(this, name).Get(to, 3);
        to += 3;
    }
}

/// Is the tip's handle where it belongs? A state from before there was one has it elsewhere.
bool vtkSMAnamorphDeformProxy::TipIsShown() {
    const std::optional<Point> center = point_of(this, "SelectedCenter"), tip = point_of(this, "SelectedTip"),
                               vector = point_of(this, "SelectedVector");
    if (!center || !tip || !vector) return true;
    for (unsigned int c = 0; c < 3; ++c)
        if ((*tip)[c] != (*center)[c] + (*vector)[c]) return false;
    return true;
}

/// Lets all ranks of the server find together what is then told of the selected deformation.
void vtkSMAnamorphDeformProxy::Find(const char* what) {
    vtkClientServerStream stream;
    stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << what << vtkClientServerStream::End;
    this->ExecuteStream(stream);
}

/// The heights of the handles of the last update. True if they are others than before.
bool vtkSMAnamorphDeformProxy::TakeHeights() {
    this->UpdatePropertyInformation(this->GetProperty("SelectedHeights"));
    const std::vector<double> heights = numbers_of(this, "SelectedHeights");
    const Point before = {this->Heights[0], this->Heights[1], 0};
    for (std::size_t i = 0; i < 2; ++i)
        this->Heights[i] = i < heights.size() && std::isfinite(heights[i]) ? heights[i] : 0;
    return before != Point{this->Heights[0], this->Heights[1], 0};
}

// ---- The mouse ----

/// Past the properties. A handle that is put back brings the row back.
void vtkSMAnamorphDeformProxy::HandleDragged() {
    if (this->InStep || !this->ObjectsCreated || (!this->Mouse->is_down() && this->DraggedRow.empty()))
        return;
    std::vector<double> list = numbers_of(this, "Deformations");
    const std::optional<Row> row = selected_row(this, list);
    if (!row) return;
    const std::vector<double> before(row->numbers, row->numbers + kPartColumns[0]);
    const std::optional<Point> center = point_of(this, "SelectedCenter", true),
                               corner = point_of(this, "SelectedCorner", true),
                               tip = point_of(this, "SelectedTip", true);
    if (center != point_of(this, "SelectedCenter")) row->move_center(*center);
    if (corner != point_of(this, "SelectedCorner")) row->move_corner(*corner);
    if (tip != point_of(this, "SelectedTip")) row->move_tip(*tip, *center);
    const std::vector<double> now(row->numbers, row->numbers + kPartColumns[0]);
    if (now == (this->DraggedRow.empty() ? before : this->DraggedRow)) return;
    vtkClientServerStream stream;
    stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "SetDeformation"
           << vtkSMPropertyHelper(this, "SelectedDeformation").GetAsInt();
    for (const double number : now) stream << number;
    stream << vtkClientServerStream::End;
    this->ExecuteStream(stream);
    this->DraggedRow = now;
    this->MarkDirty(this);
    draw_views(this);
    if (now == before) this->DraggedRow.clear();
}

/// Is this the source that the panel shows?
bool vtkSMAnamorphDeformProxy::IsActive() {
    vtkSMProxySelectionModel* sources = this->GetSessionProxyManager()->GetSelectionModel("ActiveSources");
    vtkSMProxy* active = sources ? sources->GetCurrentProxy() : nullptr;
    if (auto* port = vtkSMOutputPort::SafeDownCast(active)) active = port->GetSourceProxy();
    return active == this;
}

void vtkSMAnamorphDeformProxy::ViewClicked(vtkSMProxy* proxy, double x, double y, bool control) {
    auto* view = vtkSMRenderViewProxy::SafeDownCast(proxy);
    if (!view || !this->ObjectsCreated || !this->DraggedRow.empty() || !this->IsActive()) return;
    // The ray of the pixel, of parallel views too (ParaView's own ConvertDisplayToPointOnSurface has all rays begin at the camera).
    vtkClientServerStream stream;
    stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "PickOnLine";
    vtkRenderer* renderer = view->GetRenderer();
    Point away{};  // from the eye
    for (const double depth : {0.0, 1.0}) {
        renderer->SetDisplayPoint(x, y, depth);
        renderer->DisplayToWorld();
        const double* const world = renderer->GetWorldPoint();
        for (unsigned int c = 0; c < 3; ++c) {
            stream << world[c] / world[3];
            away[c] = world[c] / world[3] - away[c];
        }
    }
    stream << vtkClientServerStream::End;
    this->ExecuteStream(stream);
    this->UpdatePropertyInformation(this->GetProperty("PickedParameters"));
    const std::vector<double> place = numbers_of(this, "PickedParameters");
    if (place.size() != 4 || place[3] == 0) return;
    if (control) {
        this->AddBump(place[0], place[1], place[2], away);
    } else if (const int bump = this->FindBump(place[0], place[1]); bump >= 0) {
        this->SelectBump(bump);
    }
}

/// The bump of whose middle a place is nearest, in extents; -1 if it is within none.
int vtkSMAnamorphDeformProxy::FindBump(double u, double v) {
    const std::vector<double> list = numbers_of(this, "Deformations");
    int found = -1;
    double nearest = 1;
    for (std::size_t i = 0; (i + 1) * kPartColumns[0] <= list.size(); ++i) {
        const double* row = list.data() + i * kPartColumns[0];
        const double across = (u - row[kCenter]) / row[kExtent],
                     up = (v - row[kCenter + 1]) / row[kExtent + 1];
        if (const double apart = std::hypot(across, up); apart <= nearest) {
            nearest = apart;
            found = static_cast<int>(i);
        }
    }
    return found;
}

void vtkSMAnamorphDeformProxy::SelectBump(int position) {
    if (position == vtkSMPropertyHelper(this, "SelectedDeformation").GetAsInt()) return;
    {
        SM_SCOPED_TRACE(PropertiesModified).arg("proxy", this);
        const WhileHeld step(this->InStep);
        // The server has it before the properties do, so that a click is one step of undo.
        vtkClientServerStream stream;
        stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "SetSelectedDeformation" << position
               << vtkClientServerStream::End;
        this->ExecuteStream(stream);
        this->Find("FindSelected");
        vtkSMPropertyHelper(this, "SelectedDeformation").Set(position);
        if (this->UsedMode != 0) this->TakeUsedPlane();  // that at the bump
        this->TakeHeights();
        *this->Pending = Edits();
        this->ShowHandles(true);
        this->UpdateVTKObjects();
    }
    draw_views(this);
}

namespace {

/// How far V of a row of the table goes along the third direction of its own frame: what of the surface's normal, as its cells turn, an anchored bump has.
double along_own_normal(const Frame& plane, const double* row) {
    double turn[3][3], sum = 0;
    vtkMath::QuaternionToMatrix3x3(row + 12, turn);
    for (std::size_t k = 0; k < 3; ++k) sum += turn[k][2] * vtkMath::Dot(row + 6, plane.axes[k].data());
    return sum;
}

}  // namespace

/// A bump of the size of the selected one, or of a new list's, becomes the selected one. It stands out of the surface, or into it, as the
/// selected one does if that is anchored, too, and the first one out; `away` is from the eye.
void vtkSMAnamorphDeformProxy::AddBump(double u, double v, double w, const std::array<double, 3>& away) {
    {
        SM_SCOPED_TRACE(PropertiesModified).arg("proxy", this);
        std::vector<double> table = numbers_of(this, "Bumps");
        const std::size_t rows = table.size() / kTableColumns;
        const int selected = vtkSMPropertyHelper(this, "SelectedDeformation").GetAsInt();
        const std::optional<Frame> plane = frame_of(this);
        std::optional<double> out;  // of the one that it is like
        if (rows == 0) {
            this->GetProperty("Deformations")->ResetToDomainDefaults();
            table = numbers_of(this, "Bumps");
            table.resize(kTableColumns, 1);
        } else {
            const std::size_t like = std::min(static_cast<std::size_t>(std::max(selected, 0)), rows - 1);
            const std::vector<double> row(
                table.begin() + static_cast<std::ptrdiff_t>(like * kTableColumns),
                table.begin() + static_cast<std::ptrdiff_t>((like + 1) * kTableColumns));
            table.insert(table.end(), row.begin(), row.end());
            constexpr std::size_t kExtentW = 5;
            if (plane && row[kExtentW] != 0) out = along_own_normal(*plane, row.data());
        }
        double* const added = table.data() + rows * kTableColumns;
        added[0] = u, added[1] = v;
        const bool on_plane = vtkSMPropertyHelper(this, "ParameterMode").GetAsInt() == 0;
        // Its own in depth and turn, and neither an image nor a name.
        added[2] = w, added[5] = on_plane ? std::min(added[3], added[4]) : 0;
        added[10] = 1, added[11] = 0;
        const double plain[7] = {1, 0, 0, 0, 0, 0, 0};
        std::copy_n(plain, 7, added + 12);
        if (on_plane) {
            // The server has the row before the properties do, so that a click is one step of undo.
            const auto position = static_cast<int>(rows);
            vtkClientServerStream stream;
            const auto invoke = [&](const char* method, int number) {
                stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << method << number;
            };
            const auto give_part = [&](const char* method, std::size_t part) {
                invoke(method, position);
                for (std::size_t i = 0; i < kTableColumns; ++i)
                    if (kTable[i].part == part) stream << added[i];
                stream << vtkClientServerStream::End;
            };
            invoke("SetNumberOfDeformations", position + 1);
            stream << vtkClientServerStream::End;
            give_part("SetDeformation", 0);
            give_part("SetDepth", 1);
            invoke("SetSelectedDeformation", position);
            stream << vtkClientServerStream::End;
            this->ExecuteStream(stream);
            this->TakeAnchor(added);
            const bool turned = rows == 0 ? vtkMath::Dot(added + 6, away.data()) > 0
                                          : out && plane && *out * along_own_normal(*plane, added) < 0;
            if (turned)
                for (std::size_t c = 6; c < 9; ++c) added[c] = -added[c];
        }
        set_numbers(this, "Bumps", table.data(), table.size());
        vtkSMPropertyHelper(this, "SelectedDeformation").Set(static_cast<int>(rows));
        this->UpdateVTKObjects();
    }
    draw_views(this);
}

void vtkSMAnamorphDeformProxy::PropertyPushed(vtkObject*, unsigned long, void* name) {
    if (name && std::string(static_cast<const char*>(name)) == "FreezePlane") this->FreezePlane();
    if (name && std::string(static_cast<const char*>(name)) == "AnchorSelected") this->AnchorSelected();
}

/// Gives a row of the table, which the server has as the selected one, what its anchor makes of it. False where there is no surface over it.
bool vtkSMAnamorphDeformProxy::TakeAnchor(double* row) {
    this->Find("FindAnchor");
    this->UpdatePropertyInformation(this->GetProperty("SelectedAnchor"));
    const std::vector<double> anchor = numbers_of(this, "SelectedAnchor");
    if (anchor.size() != 9 || anchor[1] == 0) return false;
    constexpr std::size_t kColumns[9] = {2, 5, 12, 13, 14, 15, 6, 7, 8};  // c_w, a_w, q, V
    for (std::size_t i = 0; i < 9; ++i) row[kColumns[i]] = anchor[i];
    return true;
}

void vtkSMAnamorphDeformProxy::AnchorSelected() {
    this->UpdatePipeline();
    std::vector<double> table = numbers_of(this, "Bumps");
    const int selected = vtkSMPropertyHelper(this, "SelectedDeformation").GetAsInt();
    const std::size_t first = static_cast<std::size_t>(std::max(selected, 0)) * kTableColumns;
    if (table.size() < first + kTableColumns || !this->TakeAnchor(table.data() + first)) {
        vtkErrorMacro(
            "no part of the surface is over the centre of the selected deformation; there must be one, and "
            "the "
            "parameters be those of a plane");
        return;
    }
    set_numbers(this, "Bumps", table.data(), table.size());
    this->UpdateVTKObjects();
}

void vtkSMAnamorphDeformProxy::FreezePlane() {
    this->UpdatePipeline();
    const double* plane = this->GetUsedPlane();
    if (!plane || this->UsedMode != 0) return;
    const std::vector<double> kept(plane, plane + 9);
    set_numbers(this, "Origin", kept.data(), 3);
    set_numbers(this, "Axis1", kept.data() + 3, 3);
    set_numbers(this, "Axis2", kept.data() + 6, 3);
    vtkSMPropertyHelper(this, "AutomaticPlane").Set(0);
    this->UpdateVTKObjects();
}
