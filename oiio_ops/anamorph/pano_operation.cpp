// SPDX-License-Identifier: Apache-2.0
// A panorama seen through another lens.
#include "anamorph/metadata.h"
#include "anamorph/operation.h"
#include "anamorph/render/reproject_parameters.h"

namespace anamorph {
namespace {

class PanoDrawing final : public Drawing {
  public:
    explicit PanoDrawing(const ReprojectRequest& request) : m_reprojection(request.map(), request.options) {}

    Facts reached(const ParallelFor& parallel_for) const override {
        const Reached reached = m_reprojection.reached(parallel_for);
        return {{"anamorph:max_error", reached.max_error},
                {"anamorph:exact_fraction", reached.exact_fraction}};
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_reprojection.draw(sources[0], box, view, parallel_for);
    }

  private:
    Reprojection m_reprojection;
};

class PanoOperation final : public Operation {
  public:
    explicit PanoOperation(const ReprojectRequest& request) : m_request(request) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        ReprojectRequest request = m_request;
        for (; level > 0; --level) {
            const std::optional<Chart> half = half_size(request.target);
            if (!half) return {};
            request.target = *half;
        }
        const Output output = request.options.output;
        PictureRequest picture;
        picture.width = request.target.width();
        picture.height = request.target.height();
        picture.pixels = output == Output::color   ? PixelKind::color
                         : output == Output::stmap ? PixelKind::point
                                                   : PixelKind::value;
        picture.facts = {{"anamorph:tol", request.options.tol}};
        picture.says = projection_attributes(request.target, picture.pixels == PixelKind::color);
        picture.says.attribute("anamorph:from", std::string(name_of(request.source.projection())) + " (" +
                                                    request.source_reason + ")");
        picture.solve = [request] { return std::make_unique<PanoDrawing>(request); };
        return picture;
    }

    Faces faces() const override {
        const Chart& source = m_request.source;
        const Box& face = source.pieces()[0].box;
        return {source.width() / face.width(), source.height() / face.height()};
    }

  private:
    ReprojectRequest m_request;
};

}  // namespace

const OperationKind& pano_kind() {
    static const OperationKind kind{
        "pano",
        &reproject_parameters(),
        {"src"},
        1,
        [](const ParameterValues& values, const std::vector<SourceImage>& images, const SideFiles&) {
            const ReprojectRequest request = read_reproject_request(values, images[0].facts);
            return std::unique_ptr<const Operation>(std::make_unique<PanoOperation>(request));
        }};
    return kind;
}

}  // namespace anamorph
