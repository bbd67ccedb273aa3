// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphInbetween
 * @brief   Blends any number of surfaces of the same topology by weights, or by key frames over time.
 *
 * Multiple inbetweening (Oka 1987, section 4.2, eq. 4.3): T = sum_i I_i S_i, point by point. The inputs S_i
 * are the connections of port 0: point sets, image data and rectilinear grids, which come out as structured
 * grids (an AMR as blocks of them), or composites of these with the same structure. Counts and connectivity have
 * to agree; an error names the input that differs, and where. Weights I_i outside [0, 1] extrapolate.
 *
 * What is blended. Points, and the arrays of points and cells that are floating point and that all inputs
 * have under the same name, with as many components. All else, connectivity too, is shared with the base
 * input. Sums are made in double and rounded once, so the result has the same bits for any number of threads
 * and any cut into pieces. Blended arrays are float where all of the inputs' are, else double. What all
 * inputs share stays shared.
 *
 * Weights. In mode WEIGHTED_SUM they have to sum to 1, or are divided by their sum if NormalizeWeights is on.
 * In mode DELTAS the result is base + sum_i I_i m_i (S_i - base): the base has the rest, its own weight is
 * not read, and m_i is 1 or an array of the points, a region in which the shape is seen. At cells, m_i is the
 * mean of the cell's points. Without any weights set, every input has the same, 1 / N (in mode DELTAS: 0).
 *
 * Key frames. If there are keys, they give the weights for the time that is asked for; at a time where an
 * input has no key while another has one, its weight is 0. Before the first and after the last time weights
 * stand still. TIME_STEPS are the times of the keys and of the inputs, TIME_RANGE is around all of them.
 * Inputs are asked for the same time. Weights are checked or normalized at the keys; MONOTONE_CUBIC does not
 * keep their sum in between, so there they are always normalized.
 */
#ifndef vtkAnamorphInbetween_h
#define vtkAnamorphInbetween_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPassInputTypeAlgorithm.h"

#include <set>     // for what was compared
#include <string>  // for the names of masks
#include <tuple>   // for what was compared
#include <vector>  // for weights and keys

#include "vtkPointSet.h"      // for what is compared
#include "vtkSmartPointer.h"  // for what is compared

class ANAMORPHFILTERS_EXPORT vtkAnamorphInbetween : public vtkPassInputTypeAlgorithm {
  public:
    static vtkAnamorphInbetween* New();
    vtkTypeMacro(vtkAnamorphInbetween, vtkPassInputTypeAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    enum Modes { WEIGHTED_SUM = 0, DELTAS = 1 };
    enum Interpolations { STEP = 0, LINEAR = 1, CATMULL_ROM = 2, MONOTONE_CUBIC = 3 };
    enum NormalsModes { DROP_NORMALS = 0, RENORMALIZE_NORMALS = 1 };

    ///@{
    /** How the weights are applied. WEIGHTED_SUM is the default. */
    vtkSetClampMacro(Mode, int, WEIGHTED_SUM, DELTAS);
    vtkGetMacro(Mode, int);
    void SetModeToWeightedSum() { this->SetMode(WEIGHTED_SUM); }
    void SetModeToDeltas() { this->SetMode(DELTAS); }
    ///@}

    ///@{
    /**
     * The input, counted from 0, against which the others are compared, from which all is passed that is not
     * blended, and which is the base of mode DELTAS. The default is 0.
     */
    vtkSetMacro(BaseIndex, int);
    vtkGetMacro(BaseIndex, int);
    ///@}

    ///@{
    /**
     * One weight for each input, in their order, or none. Setting the weight of a further index makes those
     * before it 0.
     */
    void SetNumberOfWeights(int count);
    int GetNumberOfWeights() { return static_cast<int>(this->Weights.size()); }
    void SetWeight(int index, double weight);
    /** The weight of the input `index`; 0 where none is set. */
    double GetWeight(int index);
    ///@}

    ///@{
    /** Whether weights are divided by their sum (mode WEIGHTED_SUM only). Off by default: a sum other than 1 is an error.
     */
    vtkSetMacro(NormalizeWeights, bool);
    vtkGetMacro(NormalizeWeights, bool);
    vtkBooleanMacro(NormalizeWeights, bool);
    ///@}

    ///@{
    /**
     * The name of the mask of the input `index` in mode DELTAS: an array of one number for each point, of the
     * base or, where that has none of the name, of the input. An empty name, the default, is no mask.
     */
    void SetNumberOfMasks(int count);
    int GetNumberOfMasks() { return static_cast<int>(this->Masks.size()); }
    void SetMaskArrayName(int index, const char* name);
    const char* GetMaskArrayName(int index);
    ///@}

    ///@{
    /** Keys: the weight of an input at a time, in any order. Keys with the same time make a key frame. */
    void SetNumberOfKeys(int count);
    int GetNumberOfKeys() { return static_cast<int>(this->Keys.size()); }
    void SetKey(int index, double time, int input, double weight);
    void AddKey(double time, int input, double weight);
    /** Sets a key from a row of a table of numbers. An input that is not an integer becomes -1, which no input has. */
    void SetKeyNumbers(int index, double time, double input, double weight);
    void ClearKeys() { this->SetNumberOfKeys(0); }
    double GetKeyTime(int index);
    int GetKeyInput(int index);
    double GetKeyWeight(int index);
    ///@}

    ///@{
    /** The interpolation between key frames. LINEAR is the default. */
    vtkSetClampMacro(Interpolation, int, STEP, MONOTONE_CUBIC);
    vtkGetMacro(Interpolation, int);
    ///@}

    ///@{
    /**
     * How arrays that are marked as normals are treated: dropped, or blended and made unit length again
     * (the default). The latter is not the normal of the blended surface, only near to it; a filter that
     * computes normals from the points gives that. Normals that not all inputs have are dropped.
     */
    vtkSetClampMacro(Normals, int, DROP_NORMALS, RENORMALIZE_NORMALS);
    vtkGetMacro(Normals, int);
    ///@}

    ///@{
    /**
     * The precision of points: vtkAlgorithm::SINGLE_PRECISION, DOUBLE_PRECISION or DEFAULT_PRECISION: float if
     * the points of all inputs are float, else double.
     */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphInbetween();
    ~vtkAnamorphInbetween() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphInbetween(const vtkAnamorphInbetween&) = delete;
    void operator=(const vtkAnamorphInbetween&) = delete;

    struct Key {
        double Time = 0;
        int Input = 0;
        double Weight = 0;
        bool operator==(const Key&) const = default;
    };

    void Inform(vtkInformationVector* inputs, vtkInformation* output) const;
    std::vector<double> WeightsAt(int inputs, double time) const;
    std::vector<double> WeightsOfKeysAt(int inputs, double time) const;
    std::vector<double> CheckedSum(const std::vector<double>& weights) const;

    int Mode = WEIGHTED_SUM;
    int BaseIndex = 0;
    std::vector<double> Weights;
    bool NormalizeWeights = false;
    std::vector<std::string> Masks;
    std::vector<Key> Keys;
    int Interpolation = LINEAR;
    int Normals = RENORMALIZE_NORMALS;
    int OutputPointsPrecision = DEFAULT_PRECISION;

    /// The pairs of data sets, with their modification times, whose topology was found to be the same.
    using Pair = std::tuple<vtkDataObject*, vtkMTimeType, vtkDataObject*, vtkMTimeType>;
    std::set<Pair> SameTopology;
    void CheckTopology(const std::vector<vtkSmartPointer<vtkPointSet>>& surfaces, const std::string& part,
                       std::set<Pair>& same) const;
};

#endif
