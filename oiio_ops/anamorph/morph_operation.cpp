// SPDX-License-Identifier: Apache-2.0
// Pictures that turn into each other along corresponding lines.
#include "anamorph/operation.h"
#include "anamorph/render/morph_parameters.h"
#include "anamorph/side_files.h"

namespace anamorph {
namespace {

class MorphDrawing final : public Drawing {
  public:
    MorphDrawing(std::shared_ptr<const Features> features, const MorphRequest& r, const MorphOptions& options)
        : m_morph(std::move(features), r.pictures, r.width, r.height, options) {}

    Facts reached(const ParallelFor& parallel_for) const override {
        const Reached reached = m_morph.reached(parallel_for);
        return {{"anamorph:max_error", reached.max_error},
                {"anamorph:exact_fraction", reached.exact_fraction}};
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_morph.draw(sources, box, view, parallel_for);
    }

  private:
    Morph m_morph;
};

class MorphOperation final : public Operation {
  public:
    MorphOperation(const MorphRequest& request, std::shared_ptr<const Features> features)
        : m_request(request), m_features(std::move(features)) {}

    int frames() const override { return m_request.frames; }

    std::optional<PictureRequest> picture(int frame, int level) const override {
        MorphRequest request = m_request;
        if (level > 0 && std::max(request.width, request.height) >> level < 1) return {};
        request.width = std::max(1, request.width >> level);
        request.height = std::max(1, request.height >> level);
        const MorphOptions options = request.frame_options(frame);
        PictureRequest picture;
        picture.width = request.width;
        picture.height = request.height;
        picture.pixels = pixels_of(options.output);
        picture.facts = {{"anamorph:tol", options.tol}};
        if (options.shape_weights.empty()) picture.facts.push_back({"anamorph:t", options.t});
        picture.solve = [request, options, features = m_features] {
            return std::make_unique<MorphDrawing>(features, request, options);
        };
        return picture;
    }

  private:
    static PixelKind pixels_of(MorphOutput output) {
        switch (output) {
            case MorphOutput::stmap_a:
            case MorphOutput::stmap_b:
                return PixelKind::point;
            case MorphOutput::error:
            case MorphOutput::bound:
                return PixelKind::value;
            default:
                return PixelKind::color;
        }
    }

    MorphRequest m_request;
    std::shared_ptr<const Features> m_features;
};

/// What a blend needs: as many channels of the same meaning, colour in one space.
void check_alike(const std::vector<SourceImage>& images, const ParameterValues& values) {
    for (std::size_t i = 1; i < images.size(); ++i) {
        const SourceImage &a = images[0], &other = images[i];
        const std::string& key = morph_pictures()[i];
        if (other.channels != a.channels)
            throw Error("picture " + key + " has " + std::to_string(other.channels) + " channels and a has " +
                        std::to_string(a.channels) + ": must have as many");
        const std::string &space = other.color_space, &space_a = a.color_space;
        if (!values.given("colorspace") && !space.empty() && !space_a.empty() && space != space_a)
            throw Error("picture " + key + " is in color space \"" + printable(space) + "\" and a in \"" +
                        printable(space_a) + "\": must be the same, or colorspace be given");
    }
}

}  // namespace

const OperationKind& morph_kind() {
    static const OperationKind kind{
        "morph", &morph_parameters(), morph_pictures(), 2,
        [](const ParameterValues& values, const std::vector<SourceImage>& images, const SideFiles& files) {
            std::vector<Size> sizes;
            for (const SourceImage& image : images) sizes.push_back(image.size());
            check_alike(images, values);
            const MorphRequest request = read_morph_request(values, sizes);
            const auto file = files.find("features");
            if (file == files.end())
                throw Error("features is not given: must be the name of a .json, .csv or .svg file");
            std::shared_ptr<const Features> features = read_features(file->second);
            if (static_cast<std::size_t>(features->shapes()) != images.size())
                throw Error("features", printable(file->second.name),
                            "the file has " + std::to_string(features->shapes()) + " shapes: must have " +
                                std::to_string(images.size()) + ", as many as pictures are given");
            if (request.pin_border) {
                auto pinned = std::make_shared<Features>(*features);
                pinned->pin_border(*request.pin_border);
                features = pinned;
            }
            return std::unique_ptr<const Operation>(std::make_unique<MorphOperation>(request, features));
        }};
    return kind;
}

}  // namespace anamorph
