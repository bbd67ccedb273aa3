// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureReader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "anamorph/error.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "anamorph/parameter/text_file.h"
#include "execution.h"
#include "figure_data.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureReader);

namespace {

using anamorph::Error;
using anamorph::figure::Motion;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostLibraries = 1 << 16;
constexpr int kMostSteps = 1000000;  ///< that are listed one by one

/// A text of up to the size that a file may have, and a byte: the parser says what is wrong with more.
std::optional<std::string> read_text(const std::string& path,
                                     std::size_t most = anamorph::figure::kMaxScriptText) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) return std::nullopt;
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    std::string text;
    char block[1 << 16];
    while (text.size() <= most && in.read(block, sizeof block).gcount() > 0)
        text.append(block, static_cast<std::size_t>(in.gcount()));
    return text;
}

anamorph::figure::Script read_script(const std::string& path, const std::vector<std::string>& libraries,
                                     anamorph::figure::Dialect dialect) {
    const std::optional<std::string> text = read_text(path);
    if (!text) throw Error("FileName", path, "there is no such file that can be read");
    anamorph::figure::ScriptOptions options;
    options.dialect = dialect;
    options.libraries = libraries;
    options.include = [&](const std::string& name) {
        const bool library = std::find(libraries.begin(), libraries.end(), name) != libraries.end();
        return read_text(library ? name : (std::filesystem::path(path).parent_path() / name).string());
    };
    return anamorph::figure::parse_script(*text, path, options);
}

/// The first error, and how many there are.
std::string errors_of(const anamorph::figure::Script& script) {
    std::string first;
    int others = -1;
    for (const anamorph::figure::Diagnostic& d : script.diagnostics) {
        if (d.severity != anamorph::figure::Severity::error) continue;
        if (first.empty()) first = d.text();
        ++others;
    }
    return others > 0 ? first + " (and " + std::to_string(others) + " more)" : first;
}

/// A motion from a file that is no script. Throws Error.
std::unique_ptr<Motion> read_motion_file(const std::string& path, double probability = 0.5) {
    const std::optional<std::string> text = read_text(path, anamorph::text_file::kMostBytes);
    if (!text) throw Error("FileName", path, "there is no such file that can be read");
    return anamorph::figure::read_motion(*text, path, probability);
}

/// The script that a file is, performed, or its motion. Throws Error.
std::unique_ptr<Motion> open_motion(const std::string& path, const std::vector<std::string>& libraries,
                                    anamorph::figure::Dialect dialect, double probability) {
    anamorph::figure::kProbabilityRow.check(probability, "Probability");
    if (path.empty()) throw Error("FileName", "", "must be the name of a script");
    if (anamorph::figure::is_motion_file(path)) return read_motion_file(path, probability);
    std::vector<std::string> named;
    std::copy_if(libraries.begin(), libraries.end(), std::back_inserter(named),
                 [](const std::string& name) { return !name.empty(); });
    anamorph::figure::Script script = read_script(path, named, dialect);
    if (!script.ok()) throw Error(errors_of(script));
    return std::make_unique<anamorph::figure::Performance>(std::move(script.program));
}

}  // namespace

struct vtkAnamorphFigureReader::Play {
    explicit Play(std::unique_ptr<Motion> from) : motion(std::move(from)) {
        first = motion->first_frame();
        step = motion->frame_step();
        count = motion->frame_count();
    }

    /// The last frame shown at or before a time; 0 where none is shown.
    int frame_at(double time) const {
        if (count == 0) return 0;
        const double index = std::floor((time - first) / step);
        return first + step * static_cast<int>(index > 0 ? std::min(index, count - 1.0) : 0.0);
    }

    std::unique_ptr<Motion> motion;
    int first = 0, step = 1, count = 0;
    vtkMTimeType since = 0;
};

vtkAnamorphFigureReader::vtkAnamorphFigureReader() {
    this->SetNumberOfInputPorts(0);
}
vtkAnamorphFigureReader::~vtkAnamorphFigureReader() = default;

void vtkAnamorphFigureReader::SetFileName(const char* name) {
    const std::string wanted = name ? name : "";
    if (wanted == this->FileName) return;
    this->FileName = wanted;
    this->Modified();
}

int vtkAnamorphFigureReader::CanReadFile(const char* name) {
    try {
        if (!name) return 0;
        std::ifstream in(name, std::ios::binary);
        char head[4096];
        in.read(head, sizeof head);
        if (std::find(head, head + in.gcount(), '\0') != head + in.gcount()) return 0;
        if (anamorph::figure::is_motion_file(name)) return read_motion_file(name) != nullptr;
        const anamorph::figure::Script script = read_script(name, {}, anamorph::figure::Dialect::classic);
        return script.ok() || script.program.ellipsoids.size() > 1;
    } catch (const std::exception&) {
        return 0;
    }
}

void vtkAnamorphFigureReader::SetNumberOfLibraries(int count) {
    const auto size = static_cast<std::size_t>(std::clamp(count, 0, kMostLibraries));
    if (size == this->Libraries.size()) return;
    this->Libraries.resize(size);
    this->Modified();
}

void vtkAnamorphFigureReader::SetLibrary(int index, const char* name) {
    if (index < 0 || index >= kMostLibraries) {
        vtkErrorMacro(<< "Library index=" << index << ": must be an integer from 0 to "
                      << kMostLibraries - 1);
        return;
    }
    if (index >= this->GetNumberOfLibraries()) this->SetNumberOfLibraries(index + 1);
    std::string& library = this->Libraries[static_cast<std::size_t>(index)];
    const std::string wanted = name ? name : "";
    if (library == wanted) return;
    library = wanted;
    this->Modified();
}

const char* vtkAnamorphFigureReader::GetLibrary(int index) {
    if (index < 0 || index >= this->GetNumberOfLibraries()) return nullptr;
    return this->Libraries[static_cast<std::size_t>(index)].c_str();
}

void vtkAnamorphFigureReader::AddLibrary(const char* name) {
    this->SetLibrary(this->GetNumberOfLibraries(), name);
}

/// Reads the file if that has not been done since the last change. Throws Error.
void vtkAnamorphFigureReader::Prepare() {
    if (this->Current && this->Current->since == this->GetMTime()) return;
    this->Current = nullptr;
    this->Current = std::make_unique<Play>(open_motion(
        this->FileName, this->Libraries,
        this->Dialect == STRICT ? anamorph::figure::Dialect::strict : anamorph::figure::Dialect::classic,
        this->Probability));
    this->Current->since = this->GetMTime();
    for (const std::string& warning : this->Current->motion->warnings()) vtkWarningMacro(<< warning);
}

int vtkAnamorphFigureReader::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                vtkInformationVector* outputs) {
    vtkInformation* output = outputs->GetInformationObject(0);
    output->Set(CAN_HANDLE_PIECE_REQUEST(), 1);
    output->Remove(Executive::TIME_STEPS());
    output->Remove(Executive::TIME_RANGE());
    const auto list_times = [&] {
        this->Prepare();
        const Play& play = *this->Current;
        if (play.count == 0) return;
        const double range[2] = {1.0 * play.first, play.first + (play.count - 1.0) * play.step};
        output->Set(Executive::TIME_RANGE(), range, 2);
        if (play.count > kMostSteps) return;
        std::vector<double> steps;
        for (int i = 0; i < play.count; ++i) steps.push_back(play.first + 1.0 * i * play.step);
        output->Set(Executive::TIME_STEPS(), steps.data(), play.count);
    };
    return anamorph_vtk::guarded(this, list_times, {vtkDataObject::GetData(output)});
}

int vtkAnamorphFigureReader::RequestData(vtkInformation*, vtkInformationVector**,
                                         vtkInformationVector* outputs) {
    vtkInformation* information = outputs->GetInformationObject(0);
    vtkPolyData* output = vtkPolyData::GetData(outputs);
    output->Initialize();
    const auto perform = [&] {
        this->Prepare();
        Play& play = *this->Current;
        const int frame = play.frame_at(information->Has(Executive::UPDATE_TIME_STEP())
                                            ? information->Get(Executive::UPDATE_TIME_STEP())
                                            : play.first);
        if (information->Get(Executive::UPDATE_PIECE_NUMBER()) <= 0)
            anamorph_vtk::write_figures(play.motion->frame(frame), this->Joints, this->OutputPointsPrecision,
                                        output);
        if (play.count > 0) output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), frame);
    };
    return anamorph_vtk::guarded(this, perform, {output});
}

void vtkAnamorphFigureReader::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << this->FileName << "\n"
       << indent << "Dialect: " << (this->Dialect == STRICT ? "strict" : "classic") << "\n"
       << indent << "Libraries:";
    for (const std::string& name : this->Libraries) os << " " << name;
    os << "\n"
       << indent << "Joints: " << this->Joints << "\n"
       << indent << "Probability: " << this->Probability << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
