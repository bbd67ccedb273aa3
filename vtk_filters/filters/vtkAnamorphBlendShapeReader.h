// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphBlendShapeReader
 * @brief   Reads surfaces with morph targets from glTF files, or from several OBJ files, and blends them.
 *
 * Shapes for multiple inbetweening (Oka 1987, section 4.2), as files have them: morph targets of glTF 2.0 (.gltf, .glb), or OBJ files
 * of the same topology, of which the first is the base.
 *
 * Output 0 is base + sum_i w_i (S_i - base) as vtkAnamorphInbetween makes it in its mode DELTAS: a multiblock of one block for
 * each primitive of each node that has a mesh, or one for OBJ files. Weights are those that are set here; without any, those of the file's animation
 * Animation at the time that is asked for, with its interpolation; without one, the file's own. Nodes are where the
 * animation has them. Skins are not applied: a warning says so.
 *
 * Output 1 are the shapes as vtkAnamorphInbetween takes them: a multiblock whose block 0 is the base ("base"), and block i target i under its name,
 * each built as output 0. A target of one node leaves the others as they are.
 *
 * TIME_STEPS are the times of the animation's keys, in seconds. Field arrays on both outputs: "anamorph:shapes", the names, and
 * "anamorph:weights", so that vtkAnamorphBlendShapeWriter writes them again. All is in the first piece.
 */
#ifndef vtkAnamorphBlendShapeReader_h
#define vtkAnamorphBlendShapeReader_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkMultiBlockDataSetAlgorithm.h"

#include <memory>  // for what was read
#include <string>  // for names
#include <vector>  // for weights

#include "vtkNew.h"          // for the names
#include "vtkStringArray.h"  // for the names

class ANAMORPHFILTERS_EXPORT vtkAnamorphBlendShapeReader : public vtkMultiBlockDataSetAlgorithm {
  public:
    static vtkAnamorphBlendShapeReader* New();
    vtkTypeMacro(vtkAnamorphBlendShapeReader, vtkMultiBlockDataSetAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /** The files: one .gltf or .glb, or some .obj. Setting a name replaces all. */
    void SetFileName(const char* name);
    const char* GetFileName();
    void AddFileName(const char* name);
    void RemoveAllFileNames();
    int GetNumberOfFileNames() { return static_cast<int>(this->FileNames.size()); }
    const char* GetFileName(int index);
    ///@}

    ///@{
    /** The weights of the targets, in their order, or none: those of the file. Those beyond are 0, and more than there are targets an error. */
    void SetNumberOfWeights(int count);
    int GetNumberOfWeights() { return static_cast<int>(this->Weights.size()); }
    void SetWeight(int index, double weight);
    double GetWeight(int index);
    ///@}

    ///@{
    /** The animation that gives weights and places over time, from 0; -1: none. One that the file does not have is none. Default: 0. */
    void SetAnimation(int index);
    vtkGetMacro(Animation, int);
    ///@}

    /** The names of the targets, of the file as it was read last. */
    vtkStringArray* GetShapeNames();

    /** Returns 1 for a .gltf or .glb with morph targets, and for .obj. */
    virtual int CanReadFile(const char* name);

  protected:
    vtkAnamorphBlendShapeReader();
    ~vtkAnamorphBlendShapeReader() override;

    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphBlendShapeReader(const vtkAnamorphBlendShapeReader&) = delete;
    void operator=(const vtkAnamorphBlendShapeReader&) = delete;

    struct File;
    void Prepare();

    std::vector<std::string> FileNames;
    std::vector<double> Weights;
    int Animation = 0;
    std::unique_ptr<File> Current;
    vtkNew<vtkStringArray> Names;
};

#endif
