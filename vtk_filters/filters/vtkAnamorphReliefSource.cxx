// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphReliefSource.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "png_file.h"
#include "smp_for.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkArrayDispatch.h"
#include "vtkCommand.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkErrorCode.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Factory.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredGrid.h"

vtkObjectFactoryNewMacro(vtkAnamorphReliefSource);

namespace {

using anamorph::Error;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr std::int64_t kMostPixels = 1 << 30;  ///< along a side
constexpr std::int64_t kMostPoints = VTK_INT_MAX;
constexpr int kStrip = 64;    ///< rows between two reports of progress
constexpr double kReach = 3;  ///< of the smoothing Gaussian, in standard deviations

void check_finite(const char* name, double value) {
    if (!std::isfinite(value)) throw Error(name, anamorph::shortest(value), "must be a finite number");
}

/// Integers from begin up to, but not including, end.
struct Range {
    int begin, end;
    int size() const { return end - begin; }
    bool holds(Range other) const { return begin <= other.begin && other.end <= end; }
    Range grown(int by, int end_of_all) const {
        return {std::max(begin - by, 0), std::min(end + by, end_of_all)};
    }
};

/// Points evenly spread over the pixels of rows (or of columns), both counted from 0.
struct Axis {
    int pixels, points;

    double share(int point) const { return static_cast<double>(point) / (points - 1); }
    /// Whole where a point is on a pixel.
    double pixel(int point) const { return static_cast<double>(point) * (pixels - 1) / (points - 1); }
    double texture(int point) const { return (pixel(point) + 0.5) / pixels; }
    /// The pixels between which these points are.
    Range pixels_at(Range at) const {
        return {static_cast<int>(std::floor(pixel(at.begin))),
                static_cast<int>(std::ceil(pixel(at.end - 1))) + 1};
    }
};

Axis axis_of(const int* extent, int resolution, int sample_rate) {
    const std::int64_t size = std::int64_t{extent[1]} - extent[0] + 1;
    if (size > kMostPixels)
        throw Error("the picture is " + std::to_string(size) + " pixels wide or high, but must be at most " +
                    std::to_string(kMostPixels));
    const int pixels = static_cast<int>(size);
    if (resolution < 0 || resolution == 1)
        throw Error("Resolution", std::to_string(resolution), "must be 0 or an integer of at least 2");
    return {pixels, resolution ? resolution : std::max(2, (pixels - 1) / sample_rate + 1)};
}

struct Axes {
    Axis x, y;
};

bool is_empty(const int* extent) {
    return extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5];
}

Axes axes_of(const int* extent, const int* resolution, int sample_rate) {
    if (is_empty(extent)) throw Error("the picture has no pixels");
    if (extent[4] != extent[5])
        throw Error("the picture has " + std::to_string(std::int64_t{extent[5]} - extent[4] + 1) +
                    " slices, but must have 1");
    const Axes axes{axis_of(extent, resolution[0], sample_rate),
                    axis_of(extent + 2, resolution[1], sample_rate)};
    if (std::int64_t{axes.x.points} * axes.y.points > kMostPoints)
        throw Error("Resolution", std::to_string(axes.x.points) + " x " + std::to_string(axes.y.points),
                    "must be at most " + std::to_string(kMostPoints) + " points");
    return axes;
}

/// Numbers over columns and rows.
struct Field {
    Range columns, rows;
    std::vector<double> values;

    Field(Range of_columns, Range of_rows)
        : columns(of_columns),
          rows(of_rows),
          values(static_cast<std::size_t>(columns.size()) * static_cast<std::size_t>(rows.size())) {}
    double& at(int column, int row) {
        return values[static_cast<std::size_t>(row - rows.begin) * static_cast<std::size_t>(columns.size()) +
                      static_cast<std::size_t>(column - columns.begin)];
    }
    double at(int column, int row) const { return const_cast<Field*>(this)->at(column, row); }

    /// Sets each number to value(column, row).
    template <class Value>
    void fill(const Value& value) {
        anamorph::smp_for(rows.size(), [&](std::int64_t k) {
            const int row = rows.begin + static_cast<int>(k);
            for (int column = columns.begin; column < columns.end; ++column)
                at(column, row) = value(column, row);
        });
    }
};

/// Reads h from an array of these columns and rows of pixels.
struct ReadPixels {
    Field& field;
    Range columns, rows;
    int component;

    template <class Array>
    void operator()(Array* array) const {
        const auto pixels = vtk::DataArrayTupleRange(array);
        const int type = array->GetDataType();
        const double scale = type == VTK_FLOAT || type == VTK_DOUBLE ? 1 : 1 / array->GetDataTypeMax();
        const bool luminance = component < 0 && array->GetNumberOfComponents() >= 3;
        const int chosen = std::max(component, 0);
        field.fill([&](int column, int row) {
            const auto pixel = pixels[vtkIdType{row - rows.begin} * columns.size() + column - columns.begin];
            if (!luminance) return scale * static_cast<double>(pixel[chosen]);
            return scale * (0.2126 * static_cast<double>(pixel[0]) + 0.7152 * static_cast<double>(pixel[1]) +
                            0.0722 * static_cast<double>(pixel[2]));
        });
    }
};

/// The weights of a Gaussian, from its middle outwards.
std::vector<double> gaussian(double deviation, int radius) {
    std::vector<double> weights{1};
    for (int d = 1; d <= radius; ++d) weights.push_back(std::exp(-d * d / (2 * deviation * deviation)));
    return weights;
}

/// The mean of what is in `all` around a place.
template <class Value>
double weighted_mean(const std::vector<double>& weights, int place, int end_of_all, const Value& value) {
    const int radius = static_cast<int>(weights.size()) - 1;
    double sum = 0, total = 0;
    for (int k = std::max(place - radius, 0); k <= std::min(place + radius, end_of_all - 1); ++k) {
        const double weight = weights[static_cast<std::size_t>(std::abs(k - place))];
        sum += weight * value(k);
        total += weight;
    }
    return sum / total;
}

/// Linear interpolation; a number that does not count is not read.
template <class Value>
double interpolated(double place, const Value& value) {
    const double below = std::floor(place), part = place - below;
    const int k = static_cast<int>(below);
    return part == 0 ? value(k) : (1 - part) * value(k) + part * value(k + 1);
}

/// Position and derivatives of the plane by the shares of rows and columns.
struct Plane {
    glm::dvec3 origin, by_s, by_t, normal;
};

glm::dvec3 vector_of(const char* name, const double* v) {
    for (int c = 0; c < 3; ++c) check_finite(name, v[c]);
    return {v[0], v[1], v[2]};
}

/// aspect: width over height that the plane is to have, or 0.
Plane plane_of(glm::dvec3 origin, glm::dvec3 point1, glm::dvec3 point2, double aspect) {
    Plane plane{origin, point1 - origin, point2 - origin, {}};
    const double width = glm::length(plane.by_s), height = glm::length(plane.by_t);
    const glm::dvec3 across = glm::cross(plane.by_s / width, plane.by_t / height);
    if (!(std::isfinite(width) && std::isfinite(height) && glm::length(across) > 0))
        throw Error("Origin, Point1 and Point2 are on one line or too far apart: they span no plane");
    plane.normal = glm::normalize(across);
    const auto shorten = [&plane](glm::dvec3& edge, double by) {
        plane.origin += 0.5 * (1 - by) * edge;
        edge *= by;
    };
    if (aspect > 0 && width > aspect * height)
        shorten(plane.by_s, aspect * height / width);
    else if (aspect > 0)
        shorten(plane.by_t, width / (aspect * height));
    return plane;
}

/// Width over height of the picture, from the middle of the first pixel to that of the last; 0 where there
/// is none.
double aspect_of(vtkInformation* picture, const Axes& axes) {
    const double* spacing = picture->Get(vtkDataObject::SPACING());
    const double aspect =
        (axes.x.pixels - 1.0) / (axes.y.pixels - 1.0) * (spacing ? spacing[0] / spacing[1] : 1);
    return std::isfinite(aspect) && aspect > 0 ? aspect : 0;
}

/// A piece that is asked for, and what it needs.
struct Piece {
    Range columns, rows;              ///< its points
    Range grown_columns, grown_rows;  ///< with their neighbours
    Range pixel_columns, pixel_rows;  ///< the pixels around those
    Range read_columns, read_rows;    ///< the pixels that smoothing reaches from there

    Piece(const int* extent, const Axes& axes, int radius)
        : columns{extent[0], extent[1] + 1},
          rows{extent[2], extent[3] + 1},
          grown_columns(columns.grown(1, axes.x.points)),
          grown_rows(rows.grown(1, axes.y.points)),
          pixel_columns(axes.x.pixels_at(grown_columns)),
          pixel_rows(axes.y.pixels_at(grown_rows)),
          read_columns(pixel_columns.grown(radius, axes.x.pixels)),
          read_rows(pixel_rows.grown(radius, axes.y.pixels)) {}
};

/// What RequestData will be asked for: the pipeline cuts structured outputs just before.
void piece_extent(vtkInformation* output, int* extent) {
    output->Get(Executive::UPDATE_EXTENT(), extent);
    const int pieces = output->Get(Executive::UPDATE_NUMBER_OF_PIECES());
    if (pieces <= 1) return;
    const bool chosen = output->Has(vtkExtentTranslator::UPDATE_SPLIT_MODE());
    int whole[6];
    std::copy(extent, extent + 6, whole);
    vtkNew<vtkExtentTranslator> translator;
    translator->PieceToExtentThreadSafe(
        output->Get(Executive::UPDATE_PIECE_NUMBER()), pieces,
        output->Get(Executive::UPDATE_NUMBER_OF_GHOST_LEVELS()), whole, extent,
        chosen ? output->Get(vtkExtentTranslator::UPDATE_SPLIT_MODE()) : vtkExtentTranslator::BLOCK_MODE, 0);
}

int smoothing_radius(double deviation) {
    check_finite("Smoothing", deviation);
    return static_cast<int>(std::ceil(kReach * deviation));
}

/// h at the pixels that a piece needs.
Field read_pixels(vtkImageData* image, vtkDataArray* array, int component, const int* whole,
                  const Piece& piece) {
    if (!array || array->GetNumberOfTuples() != image->GetNumberOfPoints())
        throw Error("the picture has no such array of pixels");
    if (component >= array->GetNumberOfComponents())
        throw Error("Component", std::to_string(component),
                    "must be an integer from -1 (luminance) to " +
                        std::to_string(array->GetNumberOfComponents() - 1));
    const int* extent = image->GetExtent();
    const Range columns{extent[0] - whole[0], extent[1] - whole[0] + 1},
        rows{extent[2] - whole[2], extent[3] - whole[2] + 1};
    if (!columns.holds(piece.read_columns) || !rows.holds(piece.read_rows))
        throw Error("the picture came without some of the pixels that were asked for");
    Field field(piece.read_columns, piece.read_rows);
    const ReadPixels worker{field, columns, rows, component};
    if (!vtkArrayDispatch::Dispatch::Execute(array, worker)) worker(array);
    return field;
}

/// Along rows and then along columns.
Field smoothed(const Field& read, const Piece& piece, const Axes& axes, double deviation) {
    const std::vector<double> weights = gaussian(deviation, smoothing_radius(deviation));
    Field along_rows(piece.pixel_columns, piece.read_rows);
    along_rows.fill([&](int column, int row) {
        return weighted_mean(weights, column, axes.x.pixels, [&](int k) { return read.at(k, row); });
    });
    Field both(piece.pixel_columns, piece.pixel_rows);
    both.fill([&](int column, int row) {
        return weighted_mean(weights, row, axes.y.pixels, [&](int k) { return along_rows.at(column, k); });
    });
    return both;
}

template <class T>
T* add_array(vtkPointData* data, const char* name, int components, vtkIdType points) {
    const auto array = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(vtkTypeTraits<T>::VTK_TYPE_ID));
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(points);
    data->AddArray(array);
    return vtkAOSDataArrayTemplate<T>::FastDownCast(array)->GetPointer(0);
}

template <class T, class Vector>
void set_tuple(T* array, vtkIdType i, const Vector& value) {
    for (int c = 0; c < value.length(); ++c) array[i * value.length() + c] = static_cast<T>(value[c]);
}

/// The points of a piece over their heights, which are known of their neighbours too.
struct Relief {
    const Axes& axes;
    const Plane& plane;
    const Field& heights;

    template <class T>
    void write(const Piece& piece, bool with_normals, vtkStructuredGrid* output,
               anamorph_vtk::Execution& execution) const {
        const vtkIdType count = vtkIdType{piece.columns.size()} * piece.rows.size();
        vtkNew<vtkPoints> points;
        points->SetDataType(vtkTypeTraits<T>::VTK_TYPE_ID);
        points->SetNumberOfPoints(count);
        output->SetPoints(points);
        vtkPointData* data = output->GetPointData();
        T* const to = vtkAOSDataArrayTemplate<T>::FastDownCast(points->GetData())->GetPointer(0);
        T* const height = add_array<T>(data, "Height", 1, count);
        float* const texture = add_array<float>(data, "TextureCoordinates", 2, count);
        data->SetActiveTCoords("TextureCoordinates");
        float* const normals = with_normals ? add_array<float>(data, "Normals", 3, count) : nullptr;
        if (normals) data->SetActiveNormals("Normals");

        for (int first = piece.rows.begin; first < piece.rows.end; first += kStrip) {
            const int end = std::min(first + kStrip, piece.rows.end);
            anamorph::smp_for(end - first, [&](std::int64_t k) {
                const int row = first + static_cast<int>(k);
                vtkIdType i = vtkIdType{row - piece.rows.begin} * piece.columns.size();
                for (int column = piece.columns.begin; column < piece.columns.end; ++column, ++i) {
                    set_tuple(to, i, point(column, row));
                    height[i] = static_cast<T>(heights.at(column, row));
                    set_tuple(texture, i, glm::dvec2(axes.x.texture(column), axes.y.texture(row)));
                    if (normals) set_tuple(normals, i, normal(column, row));
                }
            });
            execution.progress(0.5 + 0.5 * (end - piece.rows.begin) / piece.rows.size());
        }
    }

    glm::dvec3 point(int column, int row) const {
        return plane.origin + axes.x.share(column) * plane.by_s + axes.y.share(row) * plane.by_t +
               heights.at(column, row) * plane.normal;
    }

    /// The normal of P = O + s P_s + t P_t + h N, with differences of neighbours for the derivatives of h.
    /// Where heights are not finite, the plane's.
    glm::dvec3 normal(int column, int row) const {
        const Range c = Range{column, column + 1}.grown(1, axes.x.points),
                    r = Range{row, row + 1}.grown(1, axes.y.points);
        const double h_s = (heights.at(c.end - 1, row) - heights.at(c.begin, row)) /
                           (axes.x.share(c.end - 1) - axes.x.share(c.begin)),
                     h_t = (heights.at(column, r.end - 1) - heights.at(column, r.begin)) /
                           (axes.y.share(r.end - 1) - axes.y.share(r.begin));
        const glm::dvec3 across =
            glm::cross(plane.by_s + h_s * plane.normal, plane.by_t + h_t * plane.normal);
        const double length = glm::length(across);
        return length > 0 && std::isfinite(length) ? across / length : plane.normal;
    }
};

}  // namespace

vtkAnamorphReliefSource::vtkAnamorphReliefSource() {
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}
vtkAnamorphReliefSource::~vtkAnamorphReliefSource() = default;

void vtkAnamorphReliefSource::SetFileName(const char* name) {
    const std::string wanted = name ? name : "";
    if (wanted == this->FileName) return;
    this->FileName = wanted;
    this->Reader = nullptr;
    this->Modified();
}

void vtkAnamorphReliefSource::SetSize(double width, double height) {
    this->SetOrigin(-0.5 * width, -0.5 * height, 0);
    this->SetPoint1(0.5 * width, -0.5 * height, 0);
    this->SetPoint2(-0.5 * width, 0.5 * height, 0);
}

int vtkAnamorphReliefSource::FillInputPortInformation(int, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    info->Set(INPUT_IS_OPTIONAL(), 1);
    return 1;
}

vtkInformation* vtkAnamorphReliefSource::PictureInformation(vtkInformationVector** inputs) {
    vtkInformation* info = inputs[0]->GetInformationObject(0);
    if (!info) {
        if (this->FileName.empty()) throw Error("there is no picture: neither an input nor FileName");
        if (!this->Reader) {
            std::error_code ignored;
            if (!std::filesystem::exists(this->FileName, ignored))
                throw Error("FileName", this->FileName, "there is no such file");
            anamorph_vtk::check_png(this->FileName);
            vtkImageReader2* reader = vtkImageReader2Factory::CreateImageReader2(this->FileName.c_str());
            if (!reader)
                throw Error("FileName", this->FileName, "must be a picture that VTK's image readers know");
            reader->SetFileName(this->FileName.c_str());
            reader->AddObserver(vtkCommand::ErrorEvent, this, &vtkAnamorphReliefSource::ReaderFails);
            this->Reader = vtk::TakeSmartPointer<vtkAlgorithm>(reader);
            this->ReaderFailed = false;
        }
        this->Reader->UpdateInformation();
        this->CheckReader();
        info = this->Reader->GetOutputInformation(0);
    }
    if (!info->Has(Executive::WHOLE_EXTENT())) throw Error("the picture has no extent");
    return info;
}

void vtkAnamorphReliefSource::ReaderFails() {
    this->ReaderFailed = true;
}

/// Throws Error if the reader has failed, and lets it go: the file is read again next time.
void vtkAnamorphReliefSource::CheckReader() {
    const unsigned long code = this->Reader->GetErrorCode();
    if (code == vtkErrorCode::NoError && !this->ReaderFailed) return;
    this->Reader = nullptr;
    throw Error(
        "FileName", this->FileName,
        code == vtkErrorCode::NoError ? "it cannot be read" : vtkErrorCode::GetStringFromErrorCode(code));
}

/// The input or what is in the file, with the extent that RequestUpdateExtent has asked for.
vtkImageData* vtkAnamorphReliefSource::Picture(vtkInformationVector** inputs) {
    if (inputs[0]->GetNumberOfInformationObjects() > 0) return vtkImageData::GetData(inputs[0]);
    this->Reader->UpdateExtent(this->Reader->GetOutputInformation(0)->Get(Executive::UPDATE_EXTENT()));
    this->CheckReader();
    return vtkImageData::SafeDownCast(this->Reader->GetOutputDataObject(0));
}

int vtkAnamorphReliefSource::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                                vtkInformationVector* outputs) {
    const auto tell_extent = [&] {
        std::error_code ignored;
        const auto written = std::filesystem::last_write_time(this->FileName, ignored);
        const auto file_time = static_cast<long long>(written.time_since_epoch().count());
        if (file_time != this->FileTime) this->Reader = nullptr;
        this->FileTime = file_time;
        vtkInformation* picture = this->PictureInformation(inputs);
        const Axes axes =
            axes_of(picture->Get(Executive::WHOLE_EXTENT()), this->Resolution, this->SampleRate);
        vtkInformation* output = outputs->GetInformationObject(0);
        output->Set(Executive::WHOLE_EXTENT(), 0, axes.x.points - 1, 0, axes.y.points - 1, 0, 0);
        output->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
    };
    return anamorph_vtk::guarded(this, tell_extent, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphReliefSource::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                 vtkInformationVector* outputs) {
    const auto ask = [&] {
        vtkInformation* picture = this->PictureInformation(inputs);
        int whole[6];
        picture->Get(Executive::WHOLE_EXTENT(), whole);
        const Axes axes = axes_of(whole, this->Resolution, this->SampleRate);
        int asked[6];
        piece_extent(outputs->GetInformationObject(0), asked);
        int needed[6] = {whole[0], whole[0], whole[2], whole[2], whole[4], whole[4]};
        if (!is_empty(asked)) {
            const Piece piece(asked, axes, smoothing_radius(this->Smoothing));
            needed[0] = whole[0] + piece.read_columns.begin;
            needed[1] = whole[0] + piece.read_columns.end - 1;
            needed[2] = whole[2] + piece.read_rows.begin;
            needed[3] = whole[2] + piece.read_rows.end - 1;
        }
        // This part of the picture, which is no piece of it as the pipeline would cut it.
        picture->Set(Executive::UPDATE_PIECE_NUMBER(), 0);
        picture->Set(Executive::UPDATE_NUMBER_OF_PIECES(), 1);
        picture->Set(Executive::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
        picture->Set(Executive::UPDATE_EXTENT(), needed, 6);
    };
    return anamorph_vtk::guarded(this, ask, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphReliefSource::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    auto* output = vtkStructuredGrid::GetData(outputs);
    output->Initialize();
    const auto raise = [&] {
        int asked[6];
        outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
        if (is_empty(asked)) return;
        vtkInformation* information = this->PictureInformation(inputs);
        int whole[6];
        information->Get(Executive::WHOLE_EXTENT(), whole);
        const Axes axes = axes_of(whole, this->Resolution, this->SampleRate);
        const Piece piece(asked, axes, smoothing_radius(this->Smoothing));
        const Plane plane =
            plane_of(vector_of("Origin", this->Origin), vector_of("Point1", this->Point1),
                     vector_of("Point2", this->Point2), this->KeepAspect ? aspect_of(information, axes) : 0);
        check_finite("HeightScale", this->HeightScale);
        check_finite("HeightOffset", this->HeightOffset);

        vtkImageData* image = this->Picture(inputs);
        Field pixels =
            read_pixels(image, this->GetInputArrayToProcess(0, image), this->Component, whole, piece);
        if (this->Smoothing > 0) pixels = smoothed(pixels, piece, axes, this->Smoothing);
        Field heights(piece.grown_columns, piece.grown_rows);
        heights.fill([&](int column, int row) {
            const double h = interpolated(axes.y.pixel(row), [&](int y) {
                return interpolated(axes.x.pixel(column), [&](int x) { return pixels.at(x, y); });
            });
            return this->HeightScale * h + this->HeightOffset;
        });
        anamorph_vtk::Execution execution(this);
        execution.progress(0.5);
        output->SetExtent(asked);
        output->GetFieldData()->PassData(image->GetFieldData());
        const Relief relief{axes, plane, heights};
        if (this->OutputPointsPrecision == DOUBLE_PRECISION)
            relief.write<double>(piece, this->GenerateNormals, output, execution);
        else
            relief.write<float>(piece, this->GenerateNormals, output, execution);
    };
    return anamorph_vtk::guarded(this, raise, {output});
}

void vtkAnamorphReliefSource::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto print = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "FileName: " << this->FileName << "\n";
    print("Origin", this->Origin);
    print("Point1", this->Point1);
    print("Point2", this->Point2);
    os << indent << "KeepAspect: " << this->KeepAspect << "\n"
       << indent << "HeightScale: " << this->HeightScale << "\n"
       << indent << "HeightOffset: " << this->HeightOffset << "\n"
       << indent << "Component: " << this->Component << "\n"
       << indent << "SampleRate: " << this->SampleRate << "\n"
       << indent << "Resolution: " << this->Resolution[0] << " " << this->Resolution[1] << "\n"
       << indent << "Smoothing: " << this->Smoothing << "\n"
       << indent << "GenerateNormals: " << this->GenerateNormals << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
