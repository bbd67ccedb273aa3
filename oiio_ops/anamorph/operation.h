// SPDX-License-Identifier: Apache-2.0
// One face for all operations: what a picture will be like, before anything is solved, and what draws it
// then.
#pragma once

#include <OpenImageIO/imageio.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"
#include "anamorph/parameter.h"
#include "anamorph/render/reproject_parameters.h"
#include "anamorph/render/source.h"

namespace anamorph {

/// Attributes of a picture: "anamorph:max_error" and so on.
using Facts = std::vector<std::pair<std::string, double>>;

/// A picture, ready to draw any part of itself. Thread safe.
class Drawing {
  public:
    virtual ~Drawing() = default;
    /// What was reached over the whole picture.
    virtual Facts reached(const ParallelFor& parallel_for) const = 0;
    /// Fills `view` with the pixels of `box`; sources are read for colour only. False when one could not be
    /// read.
    virtual bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                      const ParallelFor& parallel_for) const = 0;
};

/// What the channels of a picture hold: colour, the source's channels and type; a source point (u, v); one
/// value.
enum class PixelKind { color, point, value };

/// A picture before it is solved.
struct PictureRequest {
    int width = 0, height = 0;
    PixelKind pixels = PixelKind::color;
    Facts facts;                ///< known beforehand: "anamorph:tol"
    OIIO::ParamValueList says;  ///< what the picture says of itself to those who read it: its projection
    std::function<std::unique_ptr<const Drawing>()> solve;
};

/// An operation whose parameters were read for sources of known size.
class Operation {
  public:
    virtual ~Operation() = default;
    /// Pictures that follow each other, as subimages of a file.
    virtual int frames() const { return 1; }
    /// A frame, or a coarser level of it; none past the last level.
    virtual std::optional<PictureRequest> picture(int frame, int level) const = 0;
    /// How the first source is divided into faces.
    struct Faces {
        int columns = 1, rows = 1;
    };
    virtual Faces faces() const { return {}; }
};

/// A file that an operation reads besides its sources. With an identity, which tells its states apart, what
/// was read of it is kept.
struct SideFile {
    std::string name, identity;
};
using SideFiles = std::map<std::string, SideFile>;  ///< by key; those that were given

/// All that an operation knows of a source before pixels are read.
struct SourceImage {
    SourceFacts facts;
    int channels = 0;
    std::string color_space;

    Size size() const { return {facts.width, facts.height}; }
};

/// An operation as hosts know it.
struct OperationKind {
    std::string name;                  ///< of its recipes: "pano"
    const ParameterTable* parameters;  ///< keys of type image and file are its sources and side files
    std::vector<std::string> sources;  ///< keys of the images it draws
    std::size_t least_sources;
    /// `images`: the sources given, in the order of their keys. Throws Error.
    std::unique_ptr<const Operation> (*read)(const ParameterValues& values,
                                             const std::vector<SourceImage>& images, const SideFiles& files);
};

/// Made of all that `read` is given: the same text, the same drawings. The sources' pixels are none of it.
std::string operation_key(const OperationKind& kind, const ParameterValues& values,
                          const std::vector<SourceImage>& images, const SideFiles& files);

const OperationKind& pano_kind();
const OperationKind& warp_kind();
const OperationKind& morph_kind();

}  // namespace anamorph
