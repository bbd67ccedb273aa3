// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphEllipsoidMapper.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/body_mapping_glsl.h"
#include "anamorph/figure/body/displacement.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/image/occlusion.h"
#include "block_looks.h"
#include "ellipsoid_bodies.h"
#include "ellipsoid_shader.h"
#include "smp_for.h"
#include "vtkActor.h"
#include "vtkAnamorphEllipsoidLocator.h"
#include "vtkCamera.h"
#include "vtkCellPicker.h"
#include "vtkCommand.h"
#include "vtkCompositeDataDisplayAttributes.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkHardwareSelector.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLBufferObject.h"
#include "vtkOpenGLCamera.h"
#include "vtkOpenGLIndexBufferObject.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkOpenGLTexture.h"
#include "vtkOpenGLVertexArrayObject.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkScalarsToColors.h"
#include "vtkShaderProgram.h"
#include "vtkSmartPointer.h"
#include "vtkTexture.h"
#include "vtkTextureObject.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVersionMacros.h"
#include "vtkWeakPointer.h"
#if __has_include("vtk_glad.h")
#include "vtk_glad.h"
#else
#include "vtk_glew.h"
#endif

vtkObjectFactoryNewMacro(vtkAnamorphEllipsoidMapper);

using anamorph_vtk::BlockLook;
using anamorph_vtk::EllipsoidArrays;
using anamorph_vtk::EllipsoidBlock;
using anamorph_vtk::EllipsoidBodies;

namespace {

/// What the shaders depend on besides what VTK looks after.
struct Variant {
    bool cut = false, colored = false;
    int texture_components = 0;     ///< 0: no texture
    bool texture_is_moved = false;  ///< by the actor's matrix
    int mapping = -1;               ///< of the bodies' own textures; -1: none
    int style = 0;
    bool operator==(const Variant&) const = default;
};

}  // namespace

struct vtkAnamorphEllipsoidMapper::Drawing {
    EllipsoidBodies bodies;
    std::vector<vtkSmartPointer<vtkDataSet>> data;  ///< of the blocks
    vtkDataObject* input = nullptr;                 ///< that the bodies are of
    vtkMTimeType input_time = 0, mapper_time = 0, property_time = 0;
    vtkSmartPointer<vtkCompositeDataDisplayAttributes> attributes;
    bool valid = false;
    double box[6];  ///< of the bodies that are drawn, if there are any
    bool any = false;
    double unit = 1;
    bool fits = true;     ///< into a buffer of the graphics driver
    vtkIdType first = 0;  ///< of the block that is drawn
    bool far_side = false;
    Variant variant, built;
    vtkNew<vtkPolyData> no_data;  ///< for what VTK's mapper asks of its input
    vtkNew<vtkOpenGLBufferObject> buffer;
    vtkNew<vtkTextureObject> texture;
    vtkNew<vtkOpenGLBufferObject> chosen;  ///< corners of the bodies that are drawn, where not all are
    vtkMTimeType chosen_time = 0;  ///< of the bodies that the largest were chosen of; 0: these are others
    std::size_t chosen_count = 0;  ///< of bodies
    anamorph::figure::OccludedBodies occluded;
    vtkMTimeType occluded_time = 0;  ///< of the bodies that these are
    std::vector<std::uint32_t> seen;
    std::size_t drawn = 0;                         ///< bodies of the last picture
    vtkWeakPointer<vtkOpenGLRenderWindow> window;  ///< that these are in
    std::vector<vtkSmartPointer<vtkTexture>> textures;
    std::vector<std::string> texture_names;
    int texture_drawn = -1;  ///< 0: that of bodies without one; -1: all bodies at once
};

namespace {

/// What VTK keeps transposed.
glm::dmat4 matrix(vtkMatrix4x4* m) {
    return glm::make_mat4(m->GetData());
}

struct ViewMatrices {
    glm::dmat4 data_to_view, view_to_clip;

    ViewMatrices(vtkRenderer* renderer, vtkActor* actor) {
        vtkMatrix4x4 *world_to_view, *to_clip, *world_to_clip;
        vtkMatrix3x3* normals;
        vtkOpenGLCamera::SafeDownCast(renderer->GetActiveCamera())
            ->GetKeyMatrices(renderer, world_to_view, normals, to_clip, world_to_clip);
        vtkNew<vtkMatrix4x4> data_to_world;
        actor->GetMatrix(data_to_world);
        data_to_view = matrix(world_to_view) * glm::transpose(matrix(data_to_world));
        view_to_clip = matrix(to_clip);
    }
};

void set_uniform(vtkShaderProgram* program, const char* name, const glm::dmat4& m) {
    const glm::mat4 numbers(m);
    program->SetUniformMatrix4x4(name, const_cast<float*>(glm::value_ptr(numbers)));
}

void set_uniform(vtkShaderProgram* program, const char* name, const glm::dmat3& m) {
    const glm::mat3 numbers(m);
    program->SetUniformMatrix3x3(name, const_cast<float*>(glm::value_ptr(numbers)));
}

void set_uniform(vtkShaderProgram* program, const char* name, const glm::dvec3& v) {
    const glm::vec3 numbers(v);
    program->SetUniform3f(name, glm::value_ptr(numbers));
}

/// Of composite data, which does not count changes within its blocks, that of the block changed last.
vtkMTimeType time_of(vtkDataObject* data) {
    vtkMTimeType time = data ? data->GetMTime() : 0;
    if (auto* composite = vtkCompositeDataSet::SafeDownCast(data)) {
        const auto blocks = vtk::TakeSmartPointer(composite->NewIterator());
        for (blocks->InitTraversal(); !blocks->IsDoneWithTraversal(); blocks->GoToNextItem())
            time = std::max(time, blocks->GetCurrentDataObject()->GetMTime());
    }
    return time;
}

void substitute(vtkShader* shader, const char* place, const std::string& text) {
    std::string source = shader->GetSource();
    vtkShaderProgram::Substitute(source, place, text, false);
    shader->SetSource(source);
}

void add_body_textures(vtkShader* fragment, int mapping) {
    const auto flag = [&](const char* name, int which) {
        return std::string("#define ") + name + (mapping == which ? " 1\n" : " 0\n");
    };
    substitute(fragment, "//VTK::TMap::Dec",
               flag("LATLONG", vtkAnamorphEllipsoidMapper::LATLONG) +
                   flag("MIRRORED", vtkAnamorphEllipsoidMapper::MIRRORED) + anamorph_vtk::kBodyTexture +
                   anamorph::figure::body_mapping_glsl(static_cast<anamorph::figure::BodyMapping>(mapping),
                                                       "bodyMapping") +
                   "//VTK::TMap::Dec\n");
    substitute(fragment, "//VTK::UniformFlow::Impl",
               std::string(anamorph_vtk::kBodyTextureCoordinates) + "  //VTK::UniformFlow::Impl\n");
}

}  // namespace

vtkAnamorphEllipsoidMapper::vtkAnamorphEllipsoidMapper() : Current(std::make_unique<Drawing>()) {
    vtkNew<vtkPoints> none;
    this->Current->no_data->SetPoints(none);
}

vtkAnamorphEllipsoidMapper::~vtkAnamorphEllipsoidMapper() {
    this->LeaveWindow();
}

/// Releases what is in the window that was drawn in last, in its own context. VTK's mapper does not know of the window.
void vtkAnamorphEllipsoidMapper::LeaveWindow() {
    Drawing& current = *this->Current;
    vtkOpenGLRenderWindow* window = current.window;
    if (!window) return;
    current.window = nullptr;
    window->PushContext();
    current.texture->ReleaseGraphicsResources(window);
    current.buffer->ReleaseGraphicsResources();
    current.chosen->ReleaseGraphicsResources();
    current.chosen_time = 0;
    this->Primitives[PrimitiveTris].ReleaseGraphicsResources(window);
    window->PopContext();
}

void vtkAnamorphEllipsoidMapper::ShallowCopy(vtkAbstractMapper* mapper) {
    auto* other = vtkAnamorphEllipsoidMapper::SafeDownCast(mapper);
    this->Superclass::ShallowCopy(mapper);
    if (!other || other == this) return;
    // VTK's mapper takes over an input of vtkPolyData alone.
    this->SetInputConnection(
        0, other->GetNumberOfInputConnections(0) > 0 ? other->GetInputConnection(0, 0) : nullptr);
    this->Shape = other->Shape;
    this->AxesArray = other->AxesArray;
    this->OrientationArray = other->OrientationArray;
    this->TensorArray = other->TensorArray;
    this->ScaleFactor = other->ScaleFactor;
    this->Probability = other->Probability;
    this->Style = other->Style;
    this->InteractiveBodies = other->InteractiveBodies;
    this->OcclusionCulling = other->OcclusionCulling;
    this->TextureArray = other->TextureArray;
    this->TextureOffsetArray = other->TextureOffsetArray;
    this->TextureMapping = other->TextureMapping;
    this->Current->attributes = other->Current->attributes;
    this->Current->textures = other->Current->textures;
    this->Current->texture_names = other->Current->texture_names;
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::SetAxesArray(const char* name) {
    if (this->AxesArray == (name ? name : "")) return;
    this->AxesArray = name ? name : "";
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::SetOrientationArray(const char* name) {
    if (this->OrientationArray == (name ? name : "")) return;
    this->OrientationArray = name ? name : "";
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::SetTensorArray(const char* name) {
    if (this->TensorArray == (name ? name : "")) return;
    this->TensorArray = name ? name : "";
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::SetTextureArray(const char* name) {
    if (this->TextureArray == (name ? name : "")) return;
    this->TextureArray = name ? name : "";
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::SetTextureOffsetArray(const char* name) {
    if (this->TextureOffsetArray == (name ? name : "")) return;
    this->TextureOffsetArray = name ? name : "";
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::AddTexture(vtkTexture* texture, const char* name) {
    if (!texture) return;
    this->Current->textures.push_back(texture);
    this->Current->texture_names.push_back(name ? name : "");
    this->Modified();
}

void vtkAnamorphEllipsoidMapper::RemoveAllTextures() {
    if (this->Current->textures.empty()) return;
    this->Current->textures.clear();
    this->Current->texture_names.clear();
    this->Modified();
}

int vtkAnamorphEllipsoidMapper::GetNumberOfTextures() {
    return static_cast<int>(this->Current->textures.size());
}

void vtkAnamorphEllipsoidMapper::SetCompositeDataDisplayAttributes(
    vtkCompositeDataDisplayAttributes* attributes) {
    if (this->Current->attributes == attributes) return;
    this->Current->attributes = attributes;
    this->Modified();
}

vtkCompositeDataDisplayAttributes* vtkAnamorphEllipsoidMapper::GetCompositeDataDisplayAttributes() {
    return this->Current->attributes;
}

vtkMTimeType vtkAnamorphEllipsoidMapper::GetMTime() {
    const vtkMTimeType own = this->Superclass::GetMTime();
    // While it is being made, there are none.
    if (!this->Current || !this->Current->attributes) return own;
    return std::max<vtkMTimeType>(own, this->Current->attributes->GetMTime());
}

/// Whether a block is seen through.
bool vtkAnamorphEllipsoidMapper::IsFaded() {
    if (!this->GatherBodies()) return false;
    const auto& blocks = this->Current->bodies.blocks;
    return std::any_of(blocks.begin(), blocks.end(),
                       [](const EllipsoidBlock& block) { return block.look.opacity < 1; });
}

bool vtkAnamorphEllipsoidMapper::HasOpaqueGeometry() {
    return !this->IsFaded() && this->Superclass::HasOpaqueGeometry();
}

bool vtkAnamorphEllipsoidMapper::HasTranslucentPolygonalGeometry() {
    return this->IsFaded() || this->Superclass::HasTranslucentPolygonalGeometry();
}

int vtkAnamorphEllipsoidMapper::FillInputPortInformation(int, vtkInformation* information) {
    information->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    information->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
    return 1;
}

vtkIdType vtkAnamorphEllipsoidMapper::GetNumberOfSkippedPoints() {
    return this->Current->bodies.skipped;
}

vtkIdType vtkAnamorphEllipsoidMapper::GetNumberOfDrawnBodies() {
    return static_cast<vtkIdType>(this->Current->drawn);
}

bool vtkAnamorphEllipsoidMapper::GatherBodies() {
    Drawing& current = *this->Current;
    vtkDataObject* input = this->GetInputDataObject(0, 0);
    const vtkMTimeType input_time = time_of(input);
    if (current.input == input && current.input_time == input_time && current.mapper_time == this->GetMTime())
        return current.valid;
    current.input = input;
    current.input_time = input_time;
    current.mapper_time = this->GetMTime();
    current.bodies = EllipsoidBodies();
    current.occluded_time = 0;
    current.data.clear();
    current.valid = false;
    try {
        if (!(this->ScaleFactor > 0 && this->ScaleFactor <= 1e300))
            throw anamorph::Error("ScaleFactor", std::to_string(this->ScaleFactor),
                                  "must be a positive number");
        double scale = this->ScaleFactor;
        if (this->Shape == COVARIANCE && this->Probability != 0) {
            anamorph::figure::kProbabilityRow.check(this->Probability, "Probability");
            scale *= anamorph::figure::displacement_scale(this->Probability);
        }
        const EllipsoidArrays arrays{this->Shape,
                                     this->AxesArray,
                                     this->OrientationArray,
                                     this->TensorArray,
                                     scale,
                                     this->TextureArray,
                                     this->TextureOffsetArray,
                                     current.textures.empty() ? nullptr : &current.texture_names};
        const auto looks = anamorph_vtk::block_looks(input, current.attributes);
        const auto add = [&](vtkDataObject* block, unsigned int index) {
            auto* data = vtkDataSet::SafeDownCast(block);
            const auto found = looks.find(block);
            const BlockLook look = found == looks.end() ? BlockLook() : found->second;
            if (!data || !look.visible) return;
            current.bodies.add(data, index, arrays);
            current.bodies.blocks.back().look = look;
            current.data.push_back(data);
        };
        if (auto* composite = vtkCompositeDataSet::SafeDownCast(input)) {
            const auto blocks = vtk::TakeSmartPointer(composite->NewIterator());
            for (blocks->InitTraversal(); !blocks->IsDoneWithTraversal(); blocks->GoToNextItem())
                add(blocks->GetCurrentDataObject(), blocks->GetCurrentFlatIndex());
        } else {
            add(input, 1);
        }
        current.any = current.bodies.bounds(current.box);
        current.valid = true;
    } catch (const anamorph::Error& error) {
        current.bodies = EllipsoidBodies();
        vtkErrorMacro(<< error.what());
    }
    return current.valid;
}

vtkIdType vtkAnamorphEllipsoidMapper::IntersectWithLine(vtkDataSet* block, const double from[3],
                                                        const double to[3], double& t, vtkIdType& cell) {
    cell = -1;
    if (!this->GatherBodies()) return -1;
    const Drawing& current = *this->Current;
    const auto found = std::find(current.data.begin(), current.data.end(), block);
    if (found == current.data.end()) return -1;
    const EllipsoidBlock& bodies =
        current.bodies.blocks[static_cast<std::size_t>(found - current.data.begin())];
    const auto hit = current.bodies.hit(bodies, {from[0], from[1], from[2]}, {to[0], to[1], to[2]});
    if (!hit) return -1;
    t = hit->t;
    cell = current.bodies.bodies[static_cast<std::size_t>(bodies.first + hit->body)].cell;
    return hit->body;
}

void vtkAnamorphEllipsoidMapper::AddLocators(vtkCellPicker* picker) {
    if (!picker || !this->GatherBodies()) return;
    for (vtkDataSet* block : this->Current->data) {
        vtkNew<vtkAnamorphEllipsoidLocator> locator;
        locator->SetMapper(this);
        locator->SetDataSet(block);
        picker->AddLocator(locator);
    }
}

void vtkAnamorphEllipsoidMapper::ColorBodies(vtkActor* actor) {
    Drawing& current = *this->Current;
    current.variant.colored = !current.textures.empty();
    for (std::size_t i = 0; i < current.data.size(); ++i) {
        const EllipsoidBlock& block = current.bodies.blocks[i];
        current.bodies.color(block,
                             block.look.color ? block.look.color->data() : actor->GetProperty()->GetColor());
        current.variant.colored = current.variant.colored || !block.look.is_plain();
        // VTK would take the colors of the block before for those of this one.
        if (this->Colors) this->Colors->UnRegister(this);
        this->Colors = nullptr;
        int of_cells = 0;
        vtkUnsignedCharArray* colors = this->MapScalars(current.data[i], 1.0, of_cells);
        if (!colors || of_cells > 1 || block.look.color) continue;
        current.bodies.color(block, colors, of_cells == 1);
        current.variant.colored = true;
    }
    current.property_time = actor->GetProperty()->GetMTime();
}

void vtkAnamorphEllipsoidMapper::ComputeBounds() {
    vtkMath::UninitializeBounds(this->Bounds);
    if (this->GatherBodies() && this->Current->any) std::copy_n(this->Current->box, 6, this->Bounds);
}

bool vtkAnamorphEllipsoidMapper::GetNeedToRebuildBufferObjects(vtkRenderer*, vtkActor* actor) {
    const vtkMTimeType time = this->VBOBuildTime;
    return time < this->Current->input_time || time < this->GetMTime() ||
           (this->Current->variant.colored &&
            this->Current->property_time != actor->GetProperty()->GetMTime()) ||
           (this->LookupTable && time < this->LookupTable->GetMTime()) ||
           !this->Current->texture->GetHandle();
}

void vtkAnamorphEllipsoidMapper::BuildBufferObjects(vtkRenderer* renderer, vtkActor* actor) {
    Drawing& current = *this->Current;
    this->ColorBodies(actor);
    current.unit = current.bodies.unit();
    const std::vector<float> texels = current.bodies.texels(current.unit);
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    current.fits = texels.size() / 4 <= static_cast<std::size_t>(most);
    if (!current.fits)
        vtkErrorMacro("the input has " << current.bodies.bodies.size()
                                       << " points: this graphics driver draws at most "
                                       << most / anamorph_vtk::kBodyTexels << " ellipsoids of one actor");
    this->VBOBuildTime.Modified();
    if (!current.fits) return;
    current.texture->SetContext(window);
    current.buffer->Upload(texels, vtkOpenGLBufferObject::TextureBuffer);
    current.texture->CreateTextureBuffer(static_cast<unsigned int>(texels.size() / 4), 4, VTK_FLOAT,
                                         current.buffer);
    this->Primitives[PrimitiveTris].IBO->IndexCount = 3 * current.bodies.bodies.size();
}

void vtkAnamorphEllipsoidMapper::UpdateMaximumPointCellIds(vtkRenderer* renderer, vtkActor*) {
    for (vtkDataSet* data : this->Current->data) {
        renderer->GetSelector()->UpdateMaximumPointId(data->GetNumberOfPoints());
        renderer->GetSelector()->UpdateMaximumCellId(data->GetNumberOfCells());
    }
}

void vtkAnamorphEllipsoidMapper::Render(vtkRenderer* renderer, vtkActor* actor) {
    // What is behind first, where both sides are seen.
    this->Current->far_side = !renderer->GetSelector() && (actor->GetProperty()->GetOpacity() < 1 ||
                                                           this->HasTranslucentPolygonalGeometry());
    if (this->Current->far_side) this->Superclass::Render(renderer, actor);
    this->Current->far_side = false;
    this->Superclass::Render(renderer, actor);
}

void vtkAnamorphEllipsoidMapper::RenderPiece(vtkRenderer* renderer, vtkActor* actor) {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    if (window->CheckAbortStatus()) return;
    if (this->Current->window != window) this->LeaveWindow();
    this->Current->window = window;
    this->CurrentInput = this->Current->no_data;
    this->InvokeEvent(vtkCommand::StartEvent, nullptr);
    if (!this->Static) this->GetInputAlgorithm()->Update();
    this->InvokeEvent(vtkCommand::EndEvent, nullptr);
    if (!this->GatherBodies() || !this->Current->any) return;
    this->RenderPieceStart(renderer, actor);
    this->RenderPieceDraw(renderer, actor);
    this->RenderPieceFinish(renderer, actor);
}

void vtkAnamorphEllipsoidMapper::RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) {
    Drawing& current = *this->Current;
    if (!current.fits) return;
    vtkHardwareSelector* selector = renderer->GetSelector();
    vtkOpenGLState* state = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())->GetState();
    const vtkOpenGLState::ScopedglEnableDisable culling(state, GL_CULL_FACE);
    state->vtkglDisable(GL_CULL_FACE);
    current.texture->Activate();
    this->FindVariant(renderer, actor);
    const bool chosen = !selector && this->ChooseBodies(renderer, actor);
    current.drawn = chosen ? current.chosen_count : current.bodies.bodies.size();
    const auto draw = [&](vtkIdType first, std::size_t count) {
        current.first = first;
        this->UpdateShaders(this->Primitives[PrimitiveTris], renderer, actor);
        if (chosen) {
            if (current.chosen_count == 0) return;
            current.chosen->Bind();
            glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * current.chosen_count), GL_UNSIGNED_INT,
                           nullptr);
            current.chosen->Release();
            return;
        }
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * count));
    };
    if (selector)
        for (const EllipsoidBlock& block : current.bodies.blocks) {
            if (selector->GetCurrentPass() == vtkHardwareSelector::COMPOSITE_INDEX_PASS)
                selector->RenderCompositeIndex(block.index);
            draw(block.first, static_cast<std::size_t>(block.count));
        }
    else
        this->DrawTextured(renderer, [&] { draw(0, current.bodies.bodies.size()); });
    current.texture->Deactivate();
}

/// Whether bodies that are hidden, and only these, may be left out.
bool vtkAnamorphEllipsoidMapper::IsCulled(vtkRenderer* renderer, vtkActor* actor) {
    constexpr std::size_t kFew = 20000;
    const Drawing& current = *this->Current;
    if (this->OcclusionCulling == NEVER || renderer->GetSelector() || current.variant.cut ||
        this->Style == OCTANT || actor->GetProperty()->GetOpacity() < 1 ||
        this->HasTranslucentPolygonalGeometry() ||
        (actor->GetTexture() && actor->GetTexture()->IsTranslucent()))
        return false;
    if (this->OcclusionCulling == ALWAYS) return true;
    const auto* const name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string driver = name ? name : "";
    return current.bodies.bodies.size() >= kFew &&
           (driver.find("llvmpipe") != std::string::npos || driver.find("softpipe") != std::string::npos);
}

/// Finds the bodies that the picture may show.
void vtkAnamorphEllipsoidMapper::CullBodies(vtkRenderer* renderer, vtkActor* actor) {
    constexpr double kOfSamples =
        0.75;  // pixels: all samples of a pixel are within half its diagonal of its middle
    Drawing& current = *this->Current;
    if (current.occluded_time != current.mapper_time) {
        current.occluded = anamorph::figure::OccludedBodies();
        current.occluded.reserve(current.bodies.bodies.size());
        for (const anamorph_vtk::EllipsoidBody& body : current.bodies.bodies)
            if (body.drawn)
                current.occluded.add(body.center, body.axes);
            else
                current.occluded.add_none();
        current.occluded_time = current.mapper_time;
    }
    const ViewMatrices matrices(renderer, actor);
    anamorph::figure::OcclusionView view;
    view.to_clip = matrices.view_to_clip * matrices.data_to_view;
    int left, bottom;
    renderer->GetTiledSizeAndOrigin(&view.width, &view.height, &left, &bottom);
    if (renderer->GetRenderWindow()->GetMultiSamples() > 1) view.reach = kOfSamples;
    current.seen = current.occluded.seen(view, anamorph::smp_for);
}

/// Finds the bodies that are drawn: those that are not hidden, or while the window is interacted with the largest. False
/// where all are drawn.
bool vtkAnamorphEllipsoidMapper::ChooseBodies(vtkRenderer* renderer, vtkActor* actor) {
    constexpr double kStill = 1;  // frames a second; windows that are interacted with ask for more
    Drawing& current = *this->Current;
    const auto most = static_cast<std::size_t>(this->InteractiveBodies);
    const bool all = most == 0 || renderer->GetRenderWindow()->GetDesiredUpdateRate() < kStill;
    const bool culled = this->IsCulled(renderer, actor);
    std::size_t left = current.bodies.bodies.size();
    if (culled) {
        this->CullBodies(renderer, actor);
        left = current.seen.size();
    }
    const bool largest = !all && left > most;
    if (!culled && !largest) return false;
    if (largest && current.chosen_time == this->VBOBuildTime) return true;
    if (largest) current.seen = current.bodies.largest(most);
    std::vector<unsigned int> corners;
    corners.reserve(3 * current.seen.size());
    for (const std::uint32_t body : current.seen)
        for (unsigned int corner = 0; corner < 3; ++corner) corners.push_back(3 * body + corner);
    if (!corners.empty()) current.chosen->Upload(corners, vtkOpenGLBufferObject::ElementArrayBuffer);
    current.chosen_count = current.seen.size();
    current.chosen_time = largest ? static_cast<vtkMTimeType>(this->VBOBuildTime) : 0;
    return true;
}

/// Draws all bodies at once, or where they have textures those of each by itself.
void vtkAnamorphEllipsoidMapper::DrawTextured(vtkRenderer* renderer, const std::function<void()>& draw) {
    Drawing& current = *this->Current;
    if (current.variant.mapping < 0) {
        draw();
        return;
    }
    std::vector<bool> used(current.textures.size() + 1);
    for (const anamorph_vtk::EllipsoidBody& body : current.bodies.bodies)
        if (body.drawn) used[static_cast<std::size_t>(body.texture + 1)] = true;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        current.texture_drawn = static_cast<int>(i);
        if (i > 0) current.textures[i - 1]->Render(renderer);
        draw();
        if (i > 0) current.textures[i - 1]->PostRender(renderer);
    }
    current.texture_drawn = -1;
}

/// Whether a corner of the bodies' box is not beyond the near plane.
bool vtkAnamorphEllipsoidMapper::IsNear(vtkRenderer* renderer, vtkActor* actor) {
    const ViewMatrices view(renderer, actor);
    const glm::dmat4 data_to_clip = view.view_to_clip * view.data_to_view;
    const double* box = this->Current->box;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 clip =
            data_to_clip * glm::dvec4(box[corner & 1], box[2 + (corner >> 1 & 1)], box[4 + (corner >> 2)], 1);
        if (!(clip.z >= -clip.w && clip.w > 0)) return true;
    }
    return false;
}

void vtkAnamorphEllipsoidMapper::FindVariant(vtkRenderer* renderer, vtkActor* actor) {
    Variant& variant = this->Current->variant;
    variant.cut = this->GetNumberOfClippingPlanes() > 0 || this->IsNear(renderer, actor);
    auto* texture = vtkOpenGLTexture::SafeDownCast(actor->GetTexture());
    variant.texture_components = texture && !texture->GetCubeMap() && texture->GetTextureObject()
                                     ? texture->GetTextureObject()->GetComponents()
                                     : 0;
    vtkInformation* keys = actor->GetPropertyKeys();
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
    variant.texture_is_moved = keys && keys->Has(vtkProp::GENERAL_TEXTURE_TRANSFORM());
#else
    variant.texture_is_moved = keys && keys->Has(vtkProp::GeneralTextureTransform());
#endif
    variant.style = this->Style;
    variant.mapping = this->Current->textures.empty() || renderer->GetSelector() ? -1 : this->TextureMapping;
}

bool vtkAnamorphEllipsoidMapper::GetNeedToRebuildShaders(vtkOpenGLHelper& helper, vtkRenderer* renderer,
                                                         vtkActor* actor) {
    const bool needed = this->Superclass::GetNeedToRebuildShaders(helper, renderer, actor);
    Drawing& current = *this->Current;
    if (!needed && current.built == current.variant) return false;
    current.built = current.variant;
    return true;
}

void vtkAnamorphEllipsoidMapper::GetShaderTemplate(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) {
    this->Superclass::GetShaderTemplate(shaders, renderer, actor);
    std::string source = anamorph_vtk::kEllipsoidVertexShader;
    vtkShaderProgram::Substitute(source, "BODY_TEXELS", std::to_string(anamorph_vtk::kBodyTexels));
    shaders[vtkShader::Vertex]->SetSource(source);
    shaders[vtkShader::Geometry]->SetSource("");
}

void vtkAnamorphEllipsoidMapper::ReplaceShaderPositionVC(Shaders shaders, vtkRenderer*, vtkActor*) {
    vtkShader* fragment = shaders[vtkShader::Fragment];
    substitute(fragment, "//VTK::Camera::Dec", "uniform int cameraParallel;\n");
    const Variant& variant = this->Current->variant;
    substitute(
        fragment, "//VTK::PositionVC::Dec",
        std::string("#define CUT ") + (variant.cut ? "1\n" : "0\n") + anamorph_vtk::kEllipsoidDeclarations);
    std::string position = anamorph_vtk::kEllipsoidPosition;
    vtkShaderProgram::Substitute(
        position, "//STYLE",
        variant.style == PLAIN
            ? std::string()
            : std::string(variant.style == OCTANT ? "#define OCTANT 1\n" : "#define OCTANT 0\n") +
                  anamorph_vtk::kEllipsoidStyle);
    substitute(fragment, "//VTK::PositionVC::Impl", position);
    substitute(fragment, "//VTK::Depth::Impl", anamorph_vtk::kEllipsoidDepth);
}

void vtkAnamorphEllipsoidMapper::ReplaceShaderNormal(Shaders shaders, vtkRenderer*, vtkActor*) {
    std::string normal = anamorph_vtk::kEllipsoidNormal;
    if (this->Current->variant.style == OCTANT) normal += anamorph_vtk::kEllipsoidFaceNormal;
    substitute(shaders[vtkShader::Fragment], "//VTK::Normal::Impl", normal);
}

void vtkAnamorphEllipsoidMapper::ReplaceShaderColor(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) {
    vtkShader* fragment = shaders[vtkShader::Fragment];
    if (this->Current->variant.colored)
        substitute(fragment, "//VTK::Color::Impl",
                   std::string("//VTK::Color::Impl\n"
                               "  ambientColor = ambientIntensity * bodyColor.rgb;\n"
                               "  diffuseColor = diffuseIntensity * bodyColor.rgb;\n"
                               "  opacity = opacityUniform * bodyColor.a;\n") +
                       (this->Current->variant.mapping < 0 ? "" : anamorph_vtk::kBodyTextureColor) +
                       "//STYLE\n");
    else
        substitute(fragment, "//VTK::Color::Impl", "//VTK::Color::Impl\n//STYLE\n");
    substitute(
        fragment, "//STYLE",
        this->Current->variant.style == PLAIN ? "" : "  ambientColor *= ink;\n  diffuseColor *= ink;\n");
    this->Superclass::ReplaceShaderColor(shaders, renderer, actor);
}

void vtkAnamorphEllipsoidMapper::ReplaceShaderTCoord(Shaders shaders, vtkRenderer*, vtkActor*) {
    const Variant& variant = this->Current->variant;
    if (variant.mapping >= 0) add_body_textures(shaders[vtkShader::Fragment], variant.mapping);
    if (variant.texture_components == 0) return;
    static const char* const components[] = {"rrra", "rrrg", "rgba", "rgba"};
    vtkShader* fragment = shaders[vtkShader::Fragment];
    substitute(fragment, "//VTK::TMap::Dec", "uniform sampler2D actortexture;\n");
    if (variant.texture_is_moved) substitute(fragment, "//VTK::TCoord::Dec", "uniform mat4 tcMatrix;\n");
    substitute(fragment, "//VTK::UniformFlow::Impl",
               std::string(anamorph_vtk::kEllipsoidTexture) +
                   (variant.texture_is_moved
                        ? "  vec4 moved = tcMatrix * vec4(uv, 0.0, 1.0);\n  uv = moved.xy / moved.w;\n"
                        : "") +
                   "  //VTK::UniformFlow::Impl\n");
    substitute(fragment, "//VTK::TCoord::Impl",
               std::string("  gl_FragData[0] *= textureGrad(actortexture, uv, uvAcross, uvUp).") +
                   components[std::min(variant.texture_components, 4) - 1] + ";\n");
}

void vtkAnamorphEllipsoidMapper::ReplaceShaderPicking(Shaders shaders, vtkRenderer* renderer,
                                                      vtkActor* actor) {
    vtkHardwareSelector* selector = renderer->GetSelector();
    if (!selector) return;
    const int pass = selector->GetCurrentPass();
    const bool low =
                   pass == vtkHardwareSelector::POINT_ID_LOW24 || pass == vtkHardwareSelector::CELL_ID_LOW24,
               high = pass == vtkHardwareSelector::POINT_ID_HIGH24 ||
                      pass == vtkHardwareSelector::CELL_ID_HIGH24;
    if (!low && !high) {
        this->Superclass::ReplaceShaderPicking(shaders, renderer, actor);
        return;
    }
    const bool of_points =
        pass == vtkHardwareSelector::POINT_ID_LOW24 || pass == vtkHardwareSelector::POINT_ID_HIGH24;
    substitute(
        shaders[vtkShader::Fragment], "//VTK::Picking::Impl",
        std::string("  int id = bodyIds.") + (of_points ? "x" : "y") + " >> " + (low ? "0" : "24") +
            ";\n"
            "  gl_FragData[0] = vec4(vec3(id & 255, (id >> 8) & 255, (id >> 16) & 255) / 255.0, 1.0);\n");
}

void vtkAnamorphEllipsoidMapper::SetMapperShaderParameters(vtkOpenGLHelper& helper, vtkRenderer* renderer,
                                                           vtkActor* actor) {
    this->Superclass::SetMapperShaderParameters(helper, renderer, actor);
    vtkShaderProgram* program = helper.Program;
    program->SetUniformi("bodies", this->Current->texture->GetTextureUnit());
    program->SetUniformi("firstBody", static_cast<int>(this->Current->first));
    this->SetTexture(program);
    program->SetUniformi("farSide", this->Current->far_side ? 1 : 0);
    // Points are selected before a picture of the same depths.
    vtkHardwareSelector* selector = renderer->GetSelector();
    program->SetUniformf("depthBias", selector ? 1e-6f : 0.0f);
}

/// Samplers of different types must not share a unit, whether they are read or not.
void vtkAnamorphEllipsoidMapper::SetTexture(vtkShaderProgram* program) {
    const Drawing& current = *this->Current;
    program->SetUniformi("textureDrawn", current.texture_drawn);
    if (current.variant.mapping < 0) return;
    auto* texture = current.texture_drawn > 0
                        ? vtkOpenGLTexture::SafeDownCast(
                              current.textures[static_cast<std::size_t>(current.texture_drawn - 1)])
                        : nullptr;
    vtkTextureObject* object = texture ? texture->GetTextureObject() : nullptr;
    program->SetUniformi("bodyTexture",
                         object ? texture->GetTextureUnit() : current.texture->GetTextureUnit() + 1);
    program->SetUniformi("bodyTextureChannels", object ? object->GetComponents() : 0);
    program->SetUniformi("bodyTextureMultiplied", texture && texture->GetPremultipliedAlpha() ? 1 : 0);
}

void vtkAnamorphEllipsoidMapper::SetCameraShaderParameters(vtkOpenGLHelper& helper, vtkRenderer* renderer,
                                                           vtkActor* actor) {
    vtkShaderProgram* program = helper.Program;
    const ViewMatrices view(renderer, actor);
    const glm::dmat4 view_to_data = glm::inverse(view.data_to_view);
    const int parallel = renderer->GetActiveCamera()->GetParallelProjection() ? 1 : 0;
    const double unit = this->Current->unit;
    const anamorph_vtk::FloatPair eye(glm::dvec3(view_to_data[3]) / unit);
    program->SetUniform3f("eyeHigh", eye.high);
    program->SetUniform3f("eyeLow", eye.low);
    set_uniform(program, "towardEye", glm::dvec3(view_to_data[2]) / unit);
    set_uniform(program, "bodyToView", glm::dmat3(view.data_to_view) * unit);
    set_uniform(program, "viewToBody", glm::dmat3(view_to_data) / unit);
    set_uniform(program, "viewToClip", view.view_to_clip);
    set_uniform(program, "clipToView", glm::inverse(view.view_to_clip));
    program->SetUniformi("eyeInPerspective", 1 - parallel);
    program->SetUniformi("cameraParallel", parallel);
    this->SetClips(helper, actor, glm::value_ptr(view_to_data));
}

void vtkAnamorphEllipsoidMapper::SetClips(vtkOpenGLHelper& helper, vtkActor* actor,
                                          const double* view_to_data) {
    const int count = std::min(this->GetNumberOfClippingPlanes(), 6);
    float clips[6][4] = {};
    vtkNew<vtkMatrix4x4> data_to_world;
    actor->GetMatrix(data_to_world);
    for (int i = 0; i < count; ++i) {
        glm::dvec4 plane;
        this->GetClippingPlaneInDataCoords(data_to_world, i, &plane.x);
        const glm::dvec4 in_view = plane * glm::make_mat4(view_to_data);
        for (int k = 0; k < 4; ++k) clips[i][k] = static_cast<float>(in_view[k]);
    }
    helper.Program->SetUniformi("numberOfClips", count);
    if (count > 0) helper.Program->SetUniform4fv("clips", 6, clips);
}

void vtkAnamorphEllipsoidMapper::ReleaseGraphicsResources(vtkWindow* window) {
    if (window == this->Current->window) this->LeaveWindow();
    for (const auto& texture : this->Current->textures) texture->ReleaseGraphicsResources(window);
    this->Superclass::ReleaseGraphicsResources(window);
}

void vtkAnamorphEllipsoidMapper::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    static const char* const shapes[] = {"axes", "tensor", "covariance"};
    static const char* const styles[] = {"plain", "principal ellipses", "octant"};
    static const char* const culls[] = {"automatic", "never", "always"};
    static const char* const mappings[] = {"latlong", "mirrored", "linear", "octahedral"};
    os << indent << "Shape: " << shapes[this->Shape] << "\n"
       << indent << "AxesArray: " << this->AxesArray << "\n"
       << indent << "OrientationArray: " << this->OrientationArray << "\n"
       << indent << "TensorArray: " << this->TensorArray << "\n"
       << indent << "ScaleFactor: " << this->ScaleFactor << "\n"
       << indent << "Probability: " << this->Probability << "\n"
       << indent << "Style: " << styles[this->Style] << "\n"
       << indent << "InteractiveBodies: " << this->InteractiveBodies << "\n"
       << indent << "OcclusionCulling: " << culls[this->OcclusionCulling] << "\n"
       << indent << "NumberOfTextures: " << this->GetNumberOfTextures() << "\n"
       << indent << "TextureArray: " << this->TextureArray << "\n"
       << indent << "TextureOffsetArray: " << this->TextureOffsetArray << "\n"
       << indent << "TextureMapping: " << mappings[this->TextureMapping] << "\n";
}
