// SPDX-License-Identifier: Apache-2.0
#include "warp_rivals.h"

#include <cmath>
#include <cstring>

#ifdef ANAMORPH_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif
#ifdef ANAMORPH_HAVE_OIIO
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#endif
#ifdef ANAMORPH_HAVE_VTK
#include <vtkGridTransform.h>
#include <vtkImageData.h>
#include <vtkImageReslice.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#endif

namespace anamorph::bench {
namespace {

#ifdef ANAMORPH_HAVE_VTK
/// The grid holds displacements at the mesh's vertices and one ring beyond, where they go on linearly: its
/// cubic is then the mesh's own everywhere. VTK counts pixels from their centres.
Rival vtk_reslice(const RivalTask& task) {
    const Mesh& mesh = *task.mesh;
    const double dx = double(mesh.from().width) / mesh.columns(),
                 dy = double(mesh.from().height) / mesh.rows();
    const int columns = mesh.columns() + 3, rows = mesh.rows() + 3;
    vtkNew<vtkImageData> grid;
    grid->SetDimensions(columns, rows, 1);
    grid->SetSpacing(dx, dy, 1);
    grid->SetOrigin(-dx - 0.5, -dy - 0.5, 0);
    grid->AllocateScalars(VTK_DOUBLE, 3);
    const auto displacement = [&](int c, int r) {
        const Point<double> p = mesh.at(dx * c, dy * r);
        return Point<double>{p.x - dx * c, p.y - dy * r};
    };
    // 2 edge - inner, first along rows, then along columns.
    const auto extended = [](int i, int cells, const auto& at) {
        const auto beyond = [&](int edge, int inner) {
            const Point<double> a = at(edge), b = at(inner);
            return Point<double>{2 * a.x - b.x, 2 * a.y - b.y};
        };
        return i < 0 ? beyond(0, 1) : i > cells ? beyond(cells, cells - 1) : at(i);
    };
    auto* to = static_cast<double*>(grid->GetScalarPointer());
    for (int r = -1; r <= mesh.rows() + 1; ++r)
        for (int c = -1; c <= mesh.columns() + 1; ++c, to += 3) {
            const Point<double> d = extended(r, mesh.rows(), [&](int row) {
                return extended(c, mesh.columns(), [&](int column) { return displacement(column, row); });
            });
            to[0] = d.x;
            to[1] = d.y;
            to[2] = 0;
        }
    const auto transform = vtkSmartPointer<vtkGridTransform>::New();
    transform->SetDisplacementGridData(grid);
    transform->SetInterpolationModeToCubic();
    transform->Update();

    vtkNew<vtkImageData> image;
    image->SetDimensions(task.source.width, task.source.height, 1);
    image->AllocateScalars(task.source.type == PixelType::float32 ? VTK_FLOAT : VTK_UNSIGNED_CHAR, 3);
    std::memcpy(
        image->GetScalarPointer(), task.source.data,
        static_cast<std::size_t>(task.source.row_stride) * static_cast<std::size_t>(task.source.height));
    const auto reslice = vtkSmartPointer<vtkImageReslice>::New();
    reslice->SetInputData(image);
    reslice->SetResliceTransform(transform);
    reslice->SetInterpolationModeToLinear();
    reslice->SetOutputDimensionality(2);
    reslice->SetOutputOrigin(0, 0, 0);
    reslice->SetOutputSpacing(1, 1, 1);
    reslice->SetOutputExtent(0, task.picture.width - 1, 0, task.picture.height - 1, 0, 0);
    reslice->SetEnableSMP(task.threads > 1);
    reslice->SetNumberOfThreads(task.threads);
    return {"vtk_reslice",
            [reslice] {
                reslice->Modified();
                reslice->Update();
            },
            [transform](int x, int y) {
                double in[3] = {double(x), double(y), 0}, out[3];
                transform->TransformPoint(in, out);
                return Point<double>{out[0] + 0.5, out[1] + 0.5};
            }};
}
#endif

#ifdef ANAMORPH_HAVE_OIIO
Rival oiio_st_warp(const RivalTask& task) {
    const auto type = task.source.type == PixelType::float32 ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8;
    const int width = task.picture.width, height = task.picture.height;
    const auto st = std::make_shared<std::vector<float>>();
    for (const Point<double>& p : *task.map) {
        st->push_back(static_cast<float>(p.x / task.source.width));
        st->push_back(static_cast<float>(p.y / task.source.height));
    }
    // The buffers stand for memory that belongs to others.
    const auto source =
        std::make_shared<OIIO::ImageBuf>(OIIO::ImageSpec(task.source.width, task.source.height, 3, type),
                                         const_cast<std::byte*>(task.source.data));
    const auto map = std::make_shared<OIIO::ImageBuf>(
        OIIO::ImageSpec(width, height, 2, OIIO::TypeDesc::FLOAT), st->data());
    const auto picture =
        std::make_shared<OIIO::ImageBuf>(OIIO::ImageSpec(width, height, 3, type), task.picture.data);
    const int threads = task.threads;
    return {"oiio_st_warp",
            [st, source, map, picture, threads] {
                OIIO::ImageBufAlgo::st_warp(*picture, *source, *map, "triangle", 0.0f, 0, 1, false, false, {},
                                            threads);
            },
            [st, width, w = task.source.width, h = task.source.height](int x, int y) {
                const std::size_t i = 2 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                           static_cast<std::size_t>(x));
                return Point<double>{double((*st)[i]) * w, double((*st)[i + 1]) * h};
            }};
}
#endif

#ifdef ANAMORPH_HAVE_OPENCV
Rival opencv_remap(const RivalTask& task) {
    const int type = task.source.type == PixelType::float32 ? CV_32FC3 : CV_8UC3;
    const cv::Mat from(task.source.height, task.source.width, type, const_cast<std::byte*>(task.source.data));
    const cv::Mat to(task.picture.height, task.picture.width, type, task.picture.data);
    cv::Mat x(to.rows, to.cols, CV_32FC1), y(to.rows, to.cols, CV_32FC1);
    for (int j = 0; j < to.rows; ++j)
        for (int i = 0; i < to.cols; ++i) {
            const Point<double>& p =
                (*task.map)[static_cast<std::size_t>(j) * static_cast<std::size_t>(to.cols) +
                            static_cast<std::size_t>(i)];
            x.at<float>(j, i) = static_cast<float>(p.x - 0.5);
            y.at<float>(j, i) = static_cast<float>(p.y - 0.5);
        }
    const int threads = task.threads;
    return {"opencv_remap",
            [from, to, x, y, threads] {
                cv::setNumThreads(threads);
                cv::Mat out = to;
                cv::remap(from, out, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
            },
            // It rounds its map to 1/32 pixel (INTER_BITS = 5).
            [x, y](int i, int j) {
                const auto rounded = [](float c) { return std::nearbyint(double{c} * 32) / 32 + 0.5; };
                return Point<double>{rounded(x.at<float>(j, i)), rounded(y.at<float>(j, i))};
            }};
}
#endif

}  // namespace

std::vector<Rival> warp_rivals(const RivalTask& task) {
    std::vector<Rival> rivals;
    static_cast<void>(task);
#ifdef ANAMORPH_HAVE_VTK
    rivals.push_back(vtk_reslice(task));
#endif
#ifdef ANAMORPH_HAVE_OIIO
    rivals.push_back(oiio_st_warp(task));
#endif
#ifdef ANAMORPH_HAVE_OPENCV
    rivals.push_back(opencv_remap(task));
#endif
    return rivals;
}

}  // namespace anamorph::bench
