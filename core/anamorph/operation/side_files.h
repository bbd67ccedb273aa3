// SPDX-License-Identifier: Apache-2.0
// The files that an operation reads besides its sources: meshes, ST-maps, points, features. Hosts open them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/size.h"

namespace anamorph {

struct FaceFiles;

/// A file. With an identity, which tells its states apart, what was read of it is kept.
struct SideFile {
    std::string name, identity;
    bool image = false;  ///< the file is opened as an image, and so may be a recipe
    /// The six files that the name stands for (operation/face_files.h), where it is not that of one.
    std::shared_ptr<const FaceFiles> faces = {};
};
using SideFiles = std::map<std::string, SideFile>;  ///< the side files that were given, by parameter

/// An open image whose pixels are numbers.
class SideImage {
  public:
    virtual ~SideImage() = default;
    /// The size of the image as it is seen upright: of its data window.
    virtual Size size() const = 0;
    /// The display window, counted from the data window's corner.
    virtual Box display() const { return {0, 0, size().width, size().height}; }
    virtual int channels() const = 0;
    /// The channel of alpha; -1 where there is none.
    virtual int alpha() const { return -1; }
    /// Reads the first `count` channels of all pixels, row by row, packed. Throws Error where they cannot be read.
    virtual std::vector<float> read(int count) = 0;
};

/// Reads the first `count` channels of an image's display window, as read() does. Throws Error, which calls the image `what`,
/// where a part of the window has no pixels.
std::vector<float> read_display(SideImage& image, int count, const std::string& what);

/// How a host opens side files.
class SideFileReader {
  public:
    virtual ~SideFileReader() = default;
    /// Reads the whole of a text file. Throws Error where it cannot be read or is longer than text_file::kMostBytes.
    virtual std::string text(const std::string& name) const = 0;
    /// Is there a file of that name?
    virtual bool exists(const std::string& name) const {
        static_cast<void>(name);
        return false;
    }
    /// Opens an image. `key`: the parameter that names it, for messages. Throws Error where it cannot be opened or is not a
    /// flat image.
    virtual std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const = 0;
};

}  // namespace anamorph
