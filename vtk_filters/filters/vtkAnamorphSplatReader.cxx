// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphSplatReader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parameter/text_file.h"
#include "execution.h"
#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

vtkObjectFactoryNewMacro(vtkAnamorphSplatReader);

namespace {

using anamorph::Error;
using anamorph::text_file::excerpt;

static_assert(std::endian::native == std::endian::little);

// The properties that are read, in the order of a splat's numbers.
constexpr const char* kNames[] = {"x",     "y",     "z",     "scale_0", "scale_1", "scale_2", "rot_0",
                                  "rot_1", "rot_2", "rot_3", "f_dc_0",  "f_dc_1",  "f_dc_2",  "opacity"};
constexpr std::size_t kCount = std::size(kNames), kNeeded = 10, kScale = 3, kTurn = 6, kColor = 10,
                      kOpacity = 13;

struct Head {
    std::int64_t count = 0;
    std::size_t stride = 0;
    std::array<std::int64_t, kCount> offset;  ///< of each property; -1: none
    std::array<bool, kCount> is_double{};
    bool has_color() const {
        return offset[kColor] >= 0 && offset[kColor + 1] >= 0 && offset[kColor + 2] >= 0;
    }
};

/// The bytes of a type of PLY; 0 of others.
std::size_t size_of(const std::string& type) {
    const auto is = [&](std::initializer_list<const char*> names) {
        return std::find(names.begin(), names.end(), type) != names.end();
    };
    if (is({"char", "uchar", "int8", "uint8"})) return 1;
    if (is({"short", "ushort", "int16", "uint16"})) return 2;
    if (is({"int", "uint", "int32", "uint32", "float", "float32"})) return 4;
    return is({"double", "float64"}) ? 8 : 0;
}

/// Reads up to and with end_header.
Head read_head(std::istream& file, const std::string& name) {
    constexpr int kMostLines = 10000;
    constexpr std::size_t kMostOfLine = 4096;
    const auto fail = [&](const std::string& what) { throw Error(name + ": " + what); };
    Head head;
    head.offset.fill(-1);
    std::string line, word;
    bool little = false, vertices = false, ended = false, after = false;
    const auto next_line = [&] {
        line.clear();
        for (char c; file.get(c) && c != '\n' && line.size() < kMostOfLine;) line += c;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        return static_cast<bool>(file);
    };
    if (!next_line() || line != "ply") fail("is no PLY file: must begin with a line ply");
    for (int k = 0; k < kMostLines && !ended; ++k) {
        if (!next_line()) fail("the head has no end_header");
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        words >> word;
        if (line.empty() || word == "comment" || word == "obj_info") continue;
        if (word == "format") {
            words >> word;
            if (word != "binary_little_endian")
                fail("format " + excerpt(word) + ": must be binary_little_endian");
            little = true;
        } else if (word == "element") {
            words >> word;
            after = vertices;
            if (!vertices && word != "vertex")
                fail("element " + excerpt(word) + ": vertex must be the first");
            if (!vertices &&
                (!(words >> head.count) || head.count < 0 || head.count > (std::int64_t{1} << 31)))
                fail(excerpt(line) + ": must have from 0 to 2^31 vertices");
            vertices = true;
        } else if (word == "property") {
            if (after) continue;
            std::string type;
            words >> type >> word;
            const std::size_t size = size_of(type);
            if (size == 0)
                fail("property " + excerpt(type + " " + word) + ": must be of a plain type of PLY");
            const auto found = std::find(std::begin(kNames), std::end(kNames), word);
            if (found != std::end(kNames)) {
                const auto at = static_cast<std::size_t>(found - std::begin(kNames));
                if (!type.starts_with("float") && type != "double")
                    fail("property " + word + ": must be float or double, not " + type);
                head.offset[at] = static_cast<std::int64_t>(head.stride);
                head.is_double[at] = size == 8;
            }
            head.stride += size;
        } else if (word == "end_header") {
            ended = true;
        } else {
            fail("the head's line " + excerpt(line) + " is not known");
        }
    }
    if (!ended || !little || !vertices) fail("the head lacks a format, vertices or end_header");
    for (std::size_t i = 0; i < kNeeded; ++i)
        if (head.offset[i] < 0)
            fail(std::string("has no property ") + kNames[i] + ", so it is no file of Gaussian splats");
    return head;
}

unsigned char byte_of(double value) {
    return static_cast<unsigned char>(
        std::isnan(value) ? 0 : std::clamp(std::floor(255 * value + 0.5), 0., 255.));
}

struct Arrays {
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> axes, turns;
    vtkNew<vtkUnsignedCharArray> colors;

    explicit Arrays(const Head& head) {
        points->SetDataTypeToFloat();
        points->SetNumberOfPoints(head.count);
        const auto make = [&](vtkDataArray* array, const char* name, int components) {
            array->SetName(name);
            array->SetNumberOfComponents(components);
            array->SetNumberOfTuples(head.count);
        };
        make(axes, "Axes", 3);
        make(turns, "Orientation", 4);
        make(colors, "Color", 4);
    }

    void write(vtkIdType i, const std::array<double, kCount>& splat, const Head& head) {
        float* const at = static_cast<float*>(points->GetVoidPointer(3 * i));
        double length = 0;
        for (std::size_t k = 0; k < 4; ++k) length += splat[kTurn + k] * splat[kTurn + k];
        length = std::sqrt(length);
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            at[c] = static_cast<float>(splat[k]);
            axes->SetTypedComponent(i, c, static_cast<float>(std::exp(splat[kScale + k])));
            // The constant spherical harmonic is 1 / (2 pi^(1/2)).
            constexpr double kHarmonic = 0.28209479177387814;
            colors->SetTypedComponent(i, c,
                                      head.has_color() ? byte_of(0.5 + kHarmonic * splat[kColor + k]) : 255);
        }
        for (int c = 0; c < 4; ++c)
            turns->SetTypedComponent(i, c,
                                     static_cast<float>(splat[kTurn + static_cast<std::size_t>(c)] / length));
        colors->SetTypedComponent(
            i, 3, head.offset[kOpacity] < 0 ? 255 : byte_of(1 / (1 + std::exp(-splat[kOpacity]))));
    }
};

void read_splats(std::istream& file, const Head& head, const std::string& name,
                 anamorph_vtk::Execution& execution, vtkPolyData* output) {
    // What the file does not have is not allocated.
    const std::streamoff begin = file.tellg();
    file.seekg(0, std::ios::end);
    const std::streamoff rest = file.tellg() - begin;
    file.seekg(begin);
    if (!file || static_cast<std::uint64_t>(rest) / head.stride < static_cast<std::uint64_t>(head.count))
        throw Error(name + ": ends before its " + std::to_string(head.count) + " vertices do");
    Arrays arrays(head);
    constexpr std::int64_t kAtOnce = 4096;
    std::vector<char> block(static_cast<std::size_t>(kAtOnce) * head.stride);
    std::array<double, kCount> splat{};
    for (std::int64_t first = 0; first < head.count; first += kAtOnce) {
        const std::int64_t count = std::min(kAtOnce, head.count - first);
        if (!file.read(block.data(),
                       static_cast<std::streamsize>(count * static_cast<std::int64_t>(head.stride))))
            throw Error(name + ": cannot be read");
        for (std::int64_t i = 0; i < count; ++i) {
            const char* const from = block.data() + static_cast<std::size_t>(i) * head.stride;
            for (std::size_t k = 0; k < kCount; ++k) {
                if (head.offset[k] < 0) continue;
                float single;
                if (head.is_double[k])
                    std::memcpy(&splat[k], from + head.offset[k], sizeof(double));
                else {
                    std::memcpy(&single, from + head.offset[k], sizeof single);
                    splat[k] = static_cast<double>(single);
                }
            }
            arrays.write(first + i, splat, head);
        }
        execution.progress(static_cast<double>(first + count) / static_cast<double>(head.count));
    }
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact(head.count, head.count);
    for (vtkIdType i = 0; i < head.count; ++i) cells->InsertNextCell(1, &i);
    output->SetPoints(arrays.points);
    output->SetVerts(cells);
    output->GetPointData()->AddArray(arrays.axes);
    output->GetPointData()->AddArray(arrays.turns);
    output->GetPointData()->SetScalars(arrays.colors);
}

}  // namespace

vtkAnamorphSplatReader::vtkAnamorphSplatReader() {
    this->SetNumberOfInputPorts(0);
}

vtkAnamorphSplatReader::~vtkAnamorphSplatReader() {
    this->SetFileName(nullptr);
}

void vtkAnamorphSplatReader::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}

int vtkAnamorphSplatReader::CanReadFile(const char* name) {
    std::ifstream file(name ? name : "", std::ios::binary);
    if (!file) return 0;
    try {
        read_head(file, name);
        return 1;
    } catch (const Error&) {
        return 0;
    }
}

int vtkAnamorphSplatReader::RequestData(vtkInformation*, vtkInformationVector**,
                                        vtkInformationVector* outputs) {
    vtkPolyData* output = vtkPolyData::GetData(outputs);
    output->Initialize();
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    vtkInformation* info = outputs->GetInformationObject(0);
    if (info->Has(Pipeline::UPDATE_PIECE_NUMBER()) && info->Get(Pipeline::UPDATE_PIECE_NUMBER()) > 0)
        return 1;
    return anamorph_vtk::guarded(this,
                                 [&] {
                                     const std::string name = this->FileName ? this->FileName : "";
                                     std::ifstream file(name, std::ios::binary);
                                     if (!file)
                                         throw Error("FileName", name,
                                                     "there is no such file that can be read");
                                     anamorph_vtk::Execution execution(this);
                                     const Head head = read_head(file, name);
                                     read_splats(file, head, name, execution, output);
                                 },
                                 {output});
}
