// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphBlendShapeWriter
 * @brief   Writes surfaces of the same topology as morph targets of a glTF file, with weights over time.
 *
 * The inputs of multiple inbetweening (Oka 1987, section 4.2) as other programs take them: a base with morph targets of glTF 2.0
 * (.glb, or .gltf with a .bin beside it), their names in extras.targetNames, and an animation of their weights, which
 * vtkAnamorphBlendShapeReader reads back.
 *
 * The shapes are the connections of port 0 in their order, or, if there is one, whose data is a multiblock, its blocks, as the
 * second output of vtkAnamorphBlendShapeReader has them. Shape 0 is the base, and the names are those of blocks. Each is a point set, or a composite
 * of these with the same structure, all with as many points. What is written is the base's surface in triangles,
 * lines and points; of all shapes the points and, where all have them, the normals; of the base texture coordinates. glTF has no place for other arrays.
 *
 * A target is an offset in float from the base in float. What a reader adds up is the shape, but where the shape is much
 * nearer to 0 than the base: GetMaxError() is the largest distance of a point from what was meant.
 *
 * Weights over time are keys of this class, as those of vtkAnamorphInbetween in its mode DELTAS; or, where there are none, the
 * field array "anamorph:weights" of a multiblock at each of its time steps. Those of the first time, or of this
 * array, are the weights that stand still. All is in one piece: data must not be spread over several ranks.
 */
#ifndef vtkAnamorphBlendShapeWriter_h
#define vtkAnamorphBlendShapeWriter_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkWriter.h"

#include <string>  // for names
#include <vector>  // for keys

class ANAMORPHFILTERS_EXPORT vtkAnamorphBlendShapeWriter : public vtkWriter {
  public:
    static vtkAnamorphBlendShapeWriter* New();
    vtkTypeMacro(vtkAnamorphBlendShapeWriter, vtkWriter);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    enum Interpolations { STEP = 0, LINEAR = 1, CATMULL_ROM = 2, MONOTONE_CUBIC = 3 };

    /** Adds a shape that no filter makes. */
    void AddInputData(vtkDataObject* shape) { this->AddInputDataInternal(0, shape); }

    ///@{
    /** The file: .glb, or .gltf, which gets a file .bin of the same name. */
    vtkSetFilePathMacro(FileName);
    vtkGetFilePathMacro(FileName);
    ///@}

    ///@{
    /** The name of a shape, in place of its block's. An empty one, the default, is none. */
    void SetShapeName(int index, const char* name);
    const char* GetShapeName(int index);
    void SetNumberOfShapeNames(int count);
    int GetNumberOfShapeNames() { return static_cast<int>(this->ShapeNames.size()); }
    ///@}

    ///@{
    /**
     * Keys: the weight of a shape at a time in seconds, in any order. Shapes are counted from the base, which is 0, whose weight is not
     * read. Keys with the same time make a key frame; a shape without a key there has the weight 0.
     */
    void SetNumberOfKeys(int count);
    int GetNumberOfKeys() { return static_cast<int>(this->Keys.size()); }
    void SetKeyNumbers(int index, double time, double shape, double weight);
    void AddKey(double time, int shape, double weight);
    void ClearKeys() { this->SetNumberOfKeys(0); }
    ///@}

    ///@{
    /** How weights run from key to key. LINEAR is the default; CATMULL_ROM and MONOTONE_CUBIC are written as glTF's splines. */
    vtkSetClampMacro(Interpolation, int, STEP, MONOTONE_CUBIC);
    vtkGetMacro(Interpolation, int);
    ///@}

    /** The largest distance of a point, in the last file, from what its floats add up to. */
    vtkGetMacro(MaxError, double);

    vtkTypeBool ProcessRequest(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  protected:
    vtkAnamorphBlendShapeWriter();
    ~vtkAnamorphBlendShapeWriter() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    void WriteData() override;

  private:
    vtkAnamorphBlendShapeWriter(const vtkAnamorphBlendShapeWriter&) = delete;
    void operator=(const vtkAnamorphBlendShapeWriter&) = delete;

    struct Key {
        double Time = 0, Shape = 0, Weight = 0;
        bool operator==(const Key&) const = default;
    };

    char* FileName = nullptr;
    std::vector<std::string> ShapeNames;
    std::vector<Key> Keys;
    int Interpolation = LINEAR;
    double MaxError = 0;

    /// While time steps are read: which one is next, and the weights at those before.
    std::vector<double> Times;
    std::vector<std::vector<double>> TimeWeights;
};

#endif
