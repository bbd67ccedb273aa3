// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphBlendShapeReader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "anamorph/error.h"
#include "anamorph/parameter/json_file.h"
#include "anamorph/parameter/parameter.h"
#include "error_texts.h"
#include "execution.h"
#include "vtkAnamorphInbetween.h"
#include "vtkCompositeDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkGLTFDocumentLoader.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkOBJReader.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTransform.h"
#include "vtkTransformPolyDataFilter.h"

vtkObjectFactoryNewMacro(vtkAnamorphBlendShapeReader);

namespace {

using anamorph::Error;
using Executive = vtkStreamingDemandDrivenPipeline;
using Loader = vtkGLTFDocumentLoader;
using Blocks = vtkSmartPointer<vtkMultiBlockDataSet>;

constexpr int kMostWeights = 1 << 16;

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    if (!in) throw Error("FileName", path, "there is no such file that can be read");
    return bytes.str();
}

/// The JSON of a .gltf, or the first chunk of a .glb.
std::string json_of(const std::string& path) {
    const std::string bytes = bytes_of(path);
    if (bytes.compare(0, 4, "glTF") != 0) return bytes;
    std::uint32_t length = 0;
    if (bytes.size() < 20 || bytes.compare(16, 4, "JSON") != 0)
        throw Error("FileName", path, "it is cut off");
    std::memcpy(&length, bytes.data() + 12, 4);
    if (length > bytes.size() - 20) throw Error("FileName", path, "it is cut off");
    return bytes.substr(20, length);
}

using anamorph::text_file::Json;

/// A look at a document's indices and lengths: VTK's loader crashes on those that lead out of it.
class Document {
  public:
    Document(const Json& top, const std::string& path) : m_top(top), m_path(path) {}

    /// Throws Error where something leads nowhere.
    void check() const {
        if (!m_top.is_object()) fail("it is no object of JSON");
        for (const char* list :
             {"nodes", "meshes", "accessors", "bufferViews", "buffers", "animations", "scenes"})
            each(m_top, list, [&](const Json& one) {
                if (!one.is_object()) fail(std::string(list) + ": must be objects");
            });
        each(m_top, "nodes", [&](const Json& node) {
            index(node, "mesh", "meshes");
            indices(node, "children", "nodes");
        });
        each(m_top, "scenes", [&](const Json& scene) { indices(scene, "nodes", "nodes"); });
        index(m_top, "scene", "scenes");
        each(m_top, "buffers", [&](const Json& buffer) { check_buffer(buffer); });
        each(m_top, "bufferViews", [&](const Json& view) {
            index(view, "buffer", "buffers");
            const double end = number(view, "byteOffset") + number(view, "byteLength");
            if (end > number(entry("buffers", number(view, "buffer")), "byteLength"))
                fail("bufferViews: one ends beyond its buffer");
        });
        each(m_top, "accessors", [&](const Json& accessor) { check_accessor(accessor); });
        each(m_top, "meshes", [&](const Json& mesh) {
            each(mesh, "primitives", [&](const Json& primitive) {
                index(primitive, "indices", "accessors");
                attributes(primitive, "attributes");
                each(primitive, "targets", [&](const Json& target) { attributes_of(target); });
            });
        });
        each(m_top, "animations", [&](const Json& animation) {
            each(animation, "samplers", [&](const Json& sampler) {
                index(sampler, "input", "accessors");
                index(sampler, "output", "accessors");
            });
            each(animation, "channels", [&](const Json& channel) {
                if (!(number(channel, "sampler") < length(animation, "samplers")))
                    fail("channels: there is no such sampler");
                if (channel.contains("target")) index(channel.member("target"), "node", "nodes");
            });
        });
    }

  private:
    [[noreturn]] void fail(const std::string& words) const { throw Error("FileName", m_path, words); }
    /// A member that counts: a whole number from 0, or 0 where there is none.
    double number(const Json& object, const std::string& key) const {
        if (!object.is_object() || !object.contains(key)) return 0;
        const Json value = object.member(key);
        if (!value.is_number() || !(value.number() >= 0) || value.number() != std::floor(value.number()))
            fail(key + "=" + value.text() + ": must be an integer of at least 0");
        return value.number();
    }
    double length(const Json& object, const std::string& list) const {
        if (!object.contains(list)) return 0;
        if (!object.member(list).is_array()) fail(list + ": must be a list");
        return static_cast<double>(object.member(list).size());
    }
    template <class Call>
    void each(const Json& object, const std::string& list, const Call& call) const {
        if (!object.is_object()) fail(list + ": must be in an object");
        for (std::size_t i = 0; static_cast<double>(i) < length(object, list); ++i)
            call(object.member(list)[i]);
    }
    Json entry(const std::string& list, double at) const {
        if (!(at < length(m_top, list)))
            fail(list + ": there is none of the number " + anamorph::shortest(at));
        return m_top.member(list)[static_cast<std::size_t>(at)];
    }
    void index(const Json& object, const std::string& key, const std::string& list) const {
        if (object.is_object() && object.contains(key)) entry(list, number(object, key));
    }
    void indices(const Json& object, const std::string& key, const std::string& list) const {
        each(object, key, [&](const Json& at) {
            if (!at.is_number() || !(at.number() >= 0) || !(at.number() < length(m_top, list)))
                fail(key + ": there is none of the number " + at.text());
        });
    }
    void attributes(const Json& primitive, const std::string& key) const {
        if (primitive.contains(key)) attributes_of(primitive.member(key));
    }
    void attributes_of(const Json& object) const {
        if (!object.is_object()) fail("attributes: must be an object");
        for (const auto& [name, at] : object.members()) index(object, name, "accessors");
    }
    /// A buffer that is not in the document itself must be there, whole; VTK takes its name as it is written, and decodes no %20.
    void check_buffer(const Json& buffer) const {
        const double wanted = number(buffer, "byteLength");
        if (!buffer.contains("uri")) {
            if (ending_of(m_path) == ".gltf" && wanted > 0) fail("buffers: one has no uri");
            return;
        }
        if (!buffer.member("uri").is_string()) fail("buffers: uri: must be a text");
        const std::string uri = buffer.member("uri").string();
        double size = 0;
        if (uri.starts_with("data:")) {
            // Four digits of base64 are three bytes.
            constexpr const char* kDigits =
                "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
            const std::string kind = ";base64,";
            const std::size_t at = uri.find(kind);
            if (at == std::string::npos) fail("buffers: uri: data must be in base64");
            const std::size_t from = at + kind.size(),
                              end = std::min(uri.find_first_not_of(kDigits, from), uri.size());
            size = std::floor(static_cast<double>(end - from) * 3 / 4);
        } else {
            const std::filesystem::path file = std::filesystem::path(m_path).parent_path() / uri;
            std::error_code failure;
            const std::uintmax_t bytes = std::filesystem::file_size(file, failure);
            if (failure)
                fail("buffers: there is no file " + anamorph::text_file::excerpt(uri) + " beside it");
            size = static_cast<double>(bytes);
        }
        if (size < wanted) fail("buffers: one is cut off");
    }
    void check_accessor(const Json& accessor) const {
        if (!accessor.contains("bufferView")) return;
        const Json view = entry("bufferViews", number(accessor, "bufferView"));
        double bytes = 1;
        const double type = number(accessor, "componentType");
        if (type == 5122 || type == 5123) bytes = 2;
        if (type == 5125 || type == 5126) bytes = 4;
        const std::string kind = accessor.contains("type") && accessor.member("type").is_string()
                                     ? accessor.member("type").string()
                                     : "";
        static const std::map<std::string, double> components = {
            {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
        const auto found = components.find(kind);
        if (found == components.end()) fail("accessors: type=" + kind + ": must be one of glTF's");
        const double size = bytes * found->second, stride = std::max(number(view, "byteStride"), size);
        const double count = number(accessor, "count");
        if (count > 0 &&
            number(accessor, "byteOffset") + (count - 1) * stride + size > number(view, "byteLength"))
            fail("accessors: one ends beyond its bufferView");
    }

    Json m_top;
    std::string m_path;
};

/// The names that exporters give the targets of each mesh (extras.targetNames).
std::vector<std::vector<std::string>> target_names(const std::string& path) {
    const anamorph::text_file::JsonFile file(json_of(path), path);
    Document(file.top(), path).check();
    std::vector<std::vector<std::string>> all;
    if (!file.top().contains("meshes")) return all;
    for (const anamorph::text_file::Json& mesh : file.top().member("meshes").entries()) {
        std::vector<std::string>& names = all.emplace_back();
        if (!mesh.is_object() || !mesh.contains("extras") || !mesh.member("extras").is_object()) continue;
        const auto extras = mesh.member("extras");
        if (!extras.contains("targetNames") || !extras.member("targetNames").is_array()) continue;
        for (const auto& name : extras.member("targetNames").entries())
            names.push_back(name.is_string() ? name.string() : name.text());
    }
    return all;
}

vtkSmartPointer<vtkPolyData> transformed(vtkPolyData* mesh, vtkMatrix4x4* matrix) {
    if (!matrix || matrix->IsIdentity()) return mesh;
    vtkNew<vtkTransform> transform;
    transform->SetMatrix(matrix);
    vtkNew<vtkTransformPolyDataFilter> filter;
    filter->SetTransform(transform);
    filter->SetInputData(mesh);
    filter->Update();
    return filter->GetOutput();
}

/// glTF's v runs down, VTK's up.
void turn_texture(vtkPolyData* mesh) {
    vtkDataArray* texture = mesh ? mesh->GetPointData()->GetTCoords() : nullptr;
    if (!texture || texture->GetNumberOfComponents() < 2) return;
    const auto turned = vtkSmartPointer<vtkDataArray>::Take(texture->NewInstance());
    turned->DeepCopy(texture);
    for (vtkIdType i = 0; i < turned->GetNumberOfTuples(); ++i)
        turned->SetComponent(i, 1, 1 - turned->GetComponent(i, 1));
    mesh->GetPointData()->SetTCoords(turned);
}

/// A primitive with its points, and its normals, moved by one target; by none where that is null.
vtkSmartPointer<vtkPolyData> moved(vtkPolyData* mesh, const Loader::MorphTarget* target) {
    auto copy = vtkSmartPointer<vtkPolyData>::New();
    copy->ShallowCopy(mesh);
    if (!target) return copy;
    const auto added = [&](vtkDataArray* to, const char* attribute) -> vtkSmartPointer<vtkDataArray> {
        const auto found = target->AttributeValues.find(attribute);
        vtkFloatArray* offsets = found == target->AttributeValues.end() ? nullptr : found->second.Get();
        if (!to || !offsets || offsets->GetNumberOfTuples() != to->GetNumberOfTuples() ||
            offsets->GetNumberOfComponents() != 3)
            return nullptr;
        auto sum = vtkSmartPointer<vtkDataArray>::Take(to->NewInstance());
        sum->DeepCopy(to);
        for (vtkIdType i = 0; i < sum->GetNumberOfTuples(); ++i)
            for (int c = 0; c < 3; ++c)
                sum->SetComponent(i, c, to->GetComponent(i, c) + offsets->GetComponent(i, c));
        return sum;
    };
    if (mesh->GetPoints())
        if (const auto points = added(mesh->GetPoints()->GetData(), "POSITION")) {
            vtkNew<vtkPoints> own;
            own->SetData(points);
            copy->SetPoints(own);
        }
    if (const auto normals = added(mesh->GetPointData()->GetNormals(), "NORMAL"))
        copy->GetPointData()->SetNormals(normals);
    return copy;
}

void add_block(vtkMultiBlockDataSet* to, vtkDataObject* block, const std::string& name) {
    const unsigned int at = to->GetNumberOfBlocks();
    to->SetBlock(at, block);
    to->GetMetaData(at)->Set(vtkCompositeDataSet::NAME(), name.c_str());
}

}  // namespace

/// What files have: shapes, their names, and weights over time.
struct vtkAnamorphBlendShapeReader::File {
    struct Target {
        int node, index;
    };

    vtkSmartPointer<Loader> loader;  ///< of glTF
    std::vector<Target> targets;
    std::vector<std::string> names;
    std::vector<vtkSmartPointer<vtkPolyData>> surfaces;  ///< of OBJ files, the base first
    std::set<double> times;
    double duration = 0;
    bool skinned = false;
    int animation = -1;
    vtkMTimeType since = 0;

    void read_gltf(const std::string& path, int wanted);
    void read_obj(const std::vector<std::string>& paths);
    std::size_t count() const { return names.size(); }
    void go_to(double time) const;
    std::vector<double> weights() const;
    Blocks shape(int target) const;
};

void vtkAnamorphBlendShapeReader::File::read_gltf(const std::string& path, int wanted) {
    const std::vector<std::vector<std::string>> of_meshes = target_names(path);
    loader = vtkSmartPointer<Loader>::New();
    const anamorph_vtk::ErrorTexts errors(loader);
    std::vector<char> binary;
    const bool read = loader->LoadModelMetaDataFromFile(path) &&
                      (ending_of(path) != ".glb" || loader->LoadFileBuffer(path, binary)) &&
                      loader->LoadModelData(binary) && loader->BuildModelVTKGeometry();
    if (!read) throw Error("FileName", path, "it is no glTF that can be read" + errors.text());
    const Loader::Model& model = *loader->GetInternalModel();
    for (const Loader::Mesh& mesh : model.Meshes)
        for (const Loader::Primitive& primitive : mesh.Primitives) turn_texture(primitive.Geometry);
    skinned = !model.Skins.empty();
    int nodes_with_targets = 0;
    const auto targets_of = [&](const Loader::Node& node) {
        std::size_t most = 0;
        if (node.Mesh >= 0)
            for (const Loader::Primitive& primitive :
                 model.Meshes[static_cast<std::size_t>(node.Mesh)].Primitives)
                most = std::max(most, primitive.Targets.size());
        return most;
    };
    for (const Loader::Node& node : model.Nodes) nodes_with_targets += targets_of(node) > 0;
    for (std::size_t n = 0; n < model.Nodes.size(); ++n) {
        const Loader::Node& node = model.Nodes[n];
        for (std::size_t t = 0; t < targets_of(node); ++t) {
            const auto mesh = static_cast<std::size_t>(node.Mesh);
            std::string name = mesh < of_meshes.size() && t < of_meshes[mesh].size()
                                   ? of_meshes[mesh][t]
                                   : "target " + std::to_string(t);
            if (nodes_with_targets > 1)
                name = (node.Name.empty() ? "node " + std::to_string(n) : node.Name) + "/" + name;
            targets.push_back({static_cast<int>(n), static_cast<int>(t)});
            names.push_back(name);
        }
    }
    if (wanted < 0 || wanted >= static_cast<int>(model.Animations.size())) return;
    animation = wanted;
    const Loader::Animation& chosen = model.Animations[static_cast<std::size_t>(wanted)];
    duration = chosen.Duration;
    for (const Loader::Animation::Sampler& sampler : chosen.Samplers)
        for (vtkIdType i = 0; sampler.InputData && i < sampler.InputData->GetNumberOfTuples(); ++i)
            times.insert(sampler.InputData->GetValue(i));
}

void vtkAnamorphBlendShapeReader::File::read_obj(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
        if (!std::ifstream(path)) throw Error("FileName", path, "there is no such file that can be read");
        vtkNew<vtkOBJReader> reader;
        const anamorph_vtk::ErrorTexts errors(reader);
        reader->SetFileName(path.c_str());
        reader->Update();
        vtkPolyData* surface = reader->GetOutput();
        if (surface->GetNumberOfPoints() == 0)
            throw Error("FileName", path, "it has no points" + errors.text());
        if (!surfaces.empty()) names.push_back(std::filesystem::path(path).stem().string());
        surfaces.emplace_back(surface);
    }
}

void vtkAnamorphBlendShapeReader::File::go_to(double time) const {
    if (!loader) return;
    if (animation >= 0) {
        // At a key VTK's steps have the value before it; one float later all are at the key's, but for rounding.
        const auto at = static_cast<float>(std::clamp(time, 0.0, duration));
        loader->ApplyAnimation(std::nextafter(at, at + 1), animation);
    }
    loader->BuildGlobalTransforms();
}

std::vector<double> vtkAnamorphBlendShapeReader::File::weights() const {
    std::vector<double> all(count(), 0.0);
    if (!loader) return all;
    const Loader::Model& model = *loader->GetInternalModel();
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const Loader::Node& node = model.Nodes[static_cast<std::size_t>(targets[i].node)];
        const auto at = static_cast<std::size_t>(targets[i].index);
        // Those of an animation, of the node, or of its mesh.
        for (const std::vector<float>* from : {&node.Weights, &node.InitialWeights,
                                               &model.Meshes[static_cast<std::size_t>(node.Mesh)].Weights})
            if (at < from->size()) {
                all[i] = (*from)[at];
                break;
            }
    }
    return all;
}

/// All with one target in full; with none for -1.
Blocks vtkAnamorphBlendShapeReader::File::shape(int target) const {
    auto blocks = Blocks::New();
    if (!loader) {
        add_block(blocks, surfaces[static_cast<std::size_t>(target + 1)], "surface");
        return blocks;
    }
    const Loader::Model& model = *loader->GetInternalModel();
    for (std::size_t n = 0; n < model.Nodes.size(); ++n) {
        const Loader::Node& node = model.Nodes[n];
        if (node.Mesh < 0) continue;
        const Loader::Mesh& mesh = model.Meshes[static_cast<std::size_t>(node.Mesh)];
        for (std::size_t p = 0; p < mesh.Primitives.size(); ++p) {
            const Loader::Primitive& primitive = mesh.Primitives[p];
            if (!primitive.Geometry) continue;
            const Target* at = target < 0 ? nullptr : &targets[static_cast<std::size_t>(target)];
            const bool moves = at && at->node == static_cast<int>(n) &&
                               static_cast<std::size_t>(at->index) < primitive.Targets.size();
            const auto surface =
                moved(primitive.Geometry,
                      moves ? &primitive.Targets[static_cast<std::size_t>(at->index)] : nullptr);
            const std::string name = !node.Name.empty()   ? node.Name
                                     : !mesh.Name.empty() ? mesh.Name
                                                          : "node " + std::to_string(n);
            add_block(blocks, transformed(surface, node.GlobalTransform),
                      mesh.Primitives.size() > 1 ? name + "/" + std::to_string(p) : name);
        }
    }
    return blocks;
}

vtkAnamorphBlendShapeReader::vtkAnamorphBlendShapeReader() {
    this->SetNumberOfInputPorts(0);
    this->SetNumberOfOutputPorts(2);
}
vtkAnamorphBlendShapeReader::~vtkAnamorphBlendShapeReader() = default;

void vtkAnamorphBlendShapeReader::SetFileName(const char* name) {
    std::vector<std::string> wanted;
    if (name && *name) wanted.emplace_back(name);
    if (wanted == this->FileNames) return;
    this->FileNames = wanted;
    this->Modified();
}

const char* vtkAnamorphBlendShapeReader::GetFileName() {
    return this->FileNames.empty() ? "" : this->FileNames[0].c_str();
}

void vtkAnamorphBlendShapeReader::AddFileName(const char* name) {
    if (!name || !*name) return;
    this->FileNames.emplace_back(name);
    this->Modified();
}

void vtkAnamorphBlendShapeReader::RemoveAllFileNames() {
    this->SetFileName(nullptr);
}

const char* vtkAnamorphBlendShapeReader::GetFileName(int index) {
    return index < 0 || index >= this->GetNumberOfFileNames()
               ? nullptr
               : this->FileNames[static_cast<std::size_t>(index)].c_str();
}

void vtkAnamorphBlendShapeReader::SetNumberOfWeights(int count) {
    const auto size = static_cast<std::size_t>(std::clamp(count, 0, kMostWeights));
    if (size == this->Weights.size()) return;
    this->Weights.resize(size, 0.0);
    this->Modified();
}

void vtkAnamorphBlendShapeReader::SetWeight(int index, double weight) {
    if (index < 0 || index >= kMostWeights) {
        vtkErrorMacro(<< "Weight index=" << index << ": must be an integer from 0 to " << kMostWeights - 1);
        return;
    }
    if (index >= this->GetNumberOfWeights()) this->SetNumberOfWeights(index + 1);
    double& at = this->Weights[static_cast<std::size_t>(index)];
    if (at == weight) return;
    at = weight;
    this->Modified();
}

double vtkAnamorphBlendShapeReader::GetWeight(int index) {
    return index < 0 || index >= this->GetNumberOfWeights() ? 0
                                                            : this->Weights[static_cast<std::size_t>(index)];
}

void vtkAnamorphBlendShapeReader::SetAnimation(int index) {
    index = std::max(index, -1);
    if (index == this->Animation) return;
    this->Animation = index;
    this->Modified();
}

vtkStringArray* vtkAnamorphBlendShapeReader::GetShapeNames() {
    this->Names->Initialize();
    anamorph_vtk::guarded(this, [&] {
        this->Prepare();
        for (const std::string& name : this->Current->names) this->Names->InsertNextValue(name);
    });
    return this->Names;
}

int vtkAnamorphBlendShapeReader::CanReadFile(const char* name) {
    if (!name) return 0;
    try {
        if (ending_of(name) == ".obj") return 1;
        const anamorph::text_file::JsonFile file(json_of(name), name);
        Document(file.top(), name).check();
        if (!file.top().contains("meshes")) return 0;
        for (const auto& mesh : file.top().member("meshes").entries())
            for (const auto& primitive :
                 mesh.contains("primitives") ? mesh.member("primitives").entries() : std::vector<Json>())
                if (primitive.contains("targets")) return 1;
    } catch (const std::exception&) {
        return 0;
    }
    return 0;
}

/// Reads the files if that has not been done since the last change of their names. Throws Error.
void vtkAnamorphBlendShapeReader::Prepare() {
    if (this->Current && this->Current->since == this->GetMTime()) return;
    this->Current = nullptr;
    if (this->FileNames.empty()) throw Error("FileName", "", "must be the name of a file");
    auto file = std::make_unique<File>();
    const auto is_obj = [](const std::string& path) { return ending_of(path) == ".obj"; };
    if (std::all_of(this->FileNames.begin(), this->FileNames.end(), is_obj))
        file->read_obj(this->FileNames);
    else if (this->FileNames.size() == 1)
        file->read_gltf(this->FileNames[0], this->Animation);
    else
        throw Error("FileName", this->FileNames[1], "several files must all be .obj");
    if (file->skinned) vtkWarningMacro(<< "FileName=" << this->FileNames[0] << ": its skins are not applied");
    file->since = this->GetMTime();
    this->Current = std::move(file);
}

int vtkAnamorphBlendShapeReader::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                    vtkInformationVector* outputs) {
    return anamorph_vtk::guarded(this, [&] {
        this->Prepare();
        const std::vector<double> times(this->Current->times.begin(), this->Current->times.end());
        for (int port = 0; port < 2; ++port) {
            vtkInformation* output = outputs->GetInformationObject(port);
            output->Set(CAN_HANDLE_PIECE_REQUEST(), 1);
            output->Remove(Executive::TIME_STEPS());
            output->Remove(Executive::TIME_RANGE());
            if (times.empty()) continue;
            const double range[2] = {times.front(), times.back()};
            output->Set(Executive::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
            output->Set(Executive::TIME_RANGE(), range, 2);
        }
    });
}

int vtkAnamorphBlendShapeReader::RequestData(vtkInformation* request, vtkInformationVector**,
                                             vtkInformationVector* outputs) {
    const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
    vtkInformation* information = outputs->GetInformationObject(port);
    auto* blended = vtkMultiBlockDataSet::GetData(outputs, 0);
    auto* shapes = vtkMultiBlockDataSet::GetData(outputs, 1);
    const auto read = [&] {
        this->Prepare();
        const File& file = *this->Current;
        if (this->Weights.size() > file.count())
            throw Error("Weights", std::to_string(this->Weights.size()) + " numbers",
                        "must be at most " + std::to_string(file.count()) + ", one for each target");
        if (information->Get(Executive::UPDATE_PIECE_NUMBER()) > 0) return;
        const bool has_time = information->Has(Executive::UPDATE_TIME_STEP()) && !file.times.empty();
        const double time = has_time             ? information->Get(Executive::UPDATE_TIME_STEP())
                            : file.times.empty() ? 0
                                                 : *file.times.begin();
        file.go_to(time);
        std::vector<double> weights = file.weights();
        if (!this->Weights.empty()) {
            std::fill(weights.begin(), weights.end(), 0.0);
            std::copy(this->Weights.begin(), this->Weights.end(), weights.begin());
        }
        vtkNew<vtkAnamorphInbetween> inbetween;
        const anamorph_vtk::ErrorTexts errors(inbetween);
        inbetween->SetModeToDeltas();
        for (int i = -1; i < static_cast<int>(file.count()); ++i) {
            const Blocks shape = file.shape(i);
            inbetween->AddInputDataObject(shape);
            inbetween->SetWeight(i + 1, i < 0 ? 0 : weights[static_cast<std::size_t>(i)]);
            add_block(shapes, shape, i < 0 ? "base" : file.names[static_cast<std::size_t>(i)]);
        }
        inbetween->Update();
        if (!errors.text().empty())
            throw Error("FileName", this->FileNames[0], "its shapes cannot be blended" + errors.text());
        blended->ShallowCopy(inbetween->GetOutputDataObject(0));
        vtkNew<vtkStringArray> names;
        names->SetName("anamorph:shapes");
        vtkNew<vtkDoubleArray> numbers;
        numbers->SetName("anamorph:weights");
        for (std::size_t i = 0; i < weights.size(); ++i) {
            names->InsertNextValue(file.names[i]);
            numbers->InsertNextValue(weights[i]);
        }
        for (vtkMultiBlockDataSet* output : {blended, shapes}) {
            output->GetFieldData()->AddArray(names);
            output->GetFieldData()->AddArray(numbers);
        }
        if (!file.times.empty())
            for (vtkMultiBlockDataSet* output : {blended, shapes})
                output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    };
    return anamorph_vtk::guarded(this, read, {blended, shapes});
}

void vtkAnamorphBlendShapeReader::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "FileNames:";
    for (const std::string& name : this->FileNames) os << " " << name;
    os << "\n" << indent << "Weights:";
    for (const double weight : this->Weights) os << " " << weight;
    os << "\n" << indent << "Animation: " << this->Animation << "\n";
}
