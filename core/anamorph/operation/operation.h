// SPDX-License-Identifier: Apache-2.0
// What an operation is to its hosts: a table of parameters, and what it makes of checked values, of what is
// known of its sources, and of the files beside them: pictures, to be solved and drawn.
//
// An operation is one file, which defines `const Operation& NAME_operation()`, and one line in list.h. All
// hosts find it by the registry: recipes `x.NAME`, functions on image buffers, reference pages and tests.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/error.h"
#include "anamorph/geometry/box.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/attribute.h"
#include "anamorph/image/source.h"
#include "anamorph/operation/side_files.h"
#include "anamorph/parallel_for.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

struct Picture;

/// A part of a panorama, in pixels of the whole one, whatever size it was brought to since.
struct PanoramaCrop {
    double width = 0, height = 0;       ///< of the whole panorama
    double x = 0, y = 0, w = 0, h = 0;  ///< corner and size of the part, which may lie across the seam
};

/// The facts of a source that are known before a pixel is read.
struct SourceFacts {
    int width = 0, height = 0;
    /// The projection that the image says it has, if it does, where it says so, its horizontal field of view
    /// in degrees, and its lens.
    std::optional<Projection> projection = {};
    std::string said_by = {};
    std::optional<double> fov = {}, vfov = {}, distance = {}, second = {};  ///< its numbers d and e
    std::optional<Padding> padding = {};
    std::optional<LensModel> lens = {};
    /// The part of a panorama that it says it is, of an equirectangular one of 180 degrees from top to bottom.
    std::optional<PanoramaCrop> crop = {};
    /// Does its metadata say a part that cannot be one (GPano:CroppedArea...)? Then it is not used.
    bool has_impossible_crop = false;
    /// How it says that its camera was held, in degrees.
    std::optional<double> yaw = {}, pitch = {}, roll = {};
    /// The focal length of the camera it was taken with, in pixels, and what says so.
    std::optional<double> focal_length = {};
    std::string focal_length_said_by = {};
    /// The width of a pixel over its height.
    double pixel_aspect = 1;
    /// The rectangle around all of its pixels, where some lie beyond the edges of its picture (Source::extent).
    std::optional<Box> overscan = {};
    /// Has it a channel of alpha?
    bool has_alpha = false;
    /// The names of its channels, and the numbers of those that it says or that are known to hold no colour: ids and depth.
    std::vector<std::string> channel_names = {};
    std::vector<int> data_channels = {};
};

/// A source as its host has opened it.
struct SourceImage {
    SourceFacts facts;
    int channels = 0;
    std::string color_space = {};
    int alpha = -1;  ///< the channel of alpha, whether colours are multiplied with it or not

    Size size() const { return {facts.width, facts.height}; }
};

/// A picture, ready to draw any part of itself. Thread safe.
class SolvedPicture {
  public:
    virtual ~SolvedPicture() = default;
    /// The attributes that tell what was reached over the whole picture.
    virtual Attributes reached(const ParallelFor& parallel_for) const = 0;
    /// Does reached() compute every pixel, so that it takes as long as drawing all of them? Hosts that open a picture to
    /// read a part of it go without, unless they are asked for it (rows::reached).
    virtual bool reached_by_drawing() const { return false; }
    /// What of reached() is known where the rest is not.
    virtual Attributes known() const { return {}; }
    /// The picture, where it is one of maps (image/picture.h): it may be joined with another (chain/joined.h).
    virtual const Picture* of_maps() const { return nullptr; }
    /// The picture of the channels that are only moved (PictureRequest::moved_channels), bit for bit; what it shows in others
    /// does not count. Null where there are none.
    virtual std::unique_ptr<const SolvedPicture> of_moved() const { return nullptr; }
    /// Fills `view` with the pixels of `box`; sources are read for colour only. The sources are followed by
    /// linked images, null where one is missing. False when a source could not be read.
    virtual bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                      const ParallelFor& parallel_for) const = 0;
};

/// What the channels of a picture hold: colour, the first source's channels and type; a source point (u, v);
/// a vector of space (x, y, z); one value.
enum class PixelKind { color, point, vector, value };

/// A picture before it is solved.
struct PictureRequest {
    Size size;
    /// The display window, in pixels of the picture, which is then the data window; where there is none they are the same.
    /// Such a picture has one level: on coarser ones its windows would not lie on pixels.
    std::optional<Box> display = {};
    /// Is the display window that of the first source, so that it is to stand where that one's does?
    bool keeps_format = false;
    PixelKind pixels = PixelKind::color;
    std::vector<std::string> channels;  ///< names of the channels of colour that no source says: as float
    Attributes says;                    ///< attributes known beforehand: "anamorph:tol", the projection
    /// The source whose pixels the picture shows as they are, moved and never computed with: a host may have it move what
    /// the core has no numbers for.
    std::optional<std::size_t> moves = {};
    /// Channels of colour that are only moved where others are computed with (SolvedPicture::of_moved): a host may do the same
    /// with them.
    std::vector<int> moved_channels = {};
    /// Has colour one channel more than the first source, the last, of alpha?
    bool adds_alpha = false;
    std::function<std::unique_ptr<const SolvedPicture>()> solve;

    /// The display window, whether it is another or not.
    Box shown() const { return display.value_or(Box{0, 0, size.width, size.height}); }
    /// Is the display window of this size?
    bool shows(const Size& of) const { return shown().width() == of.width && shown().height() == of.height; }
    /// The key that made the picture larger than its display window, or its size.
    std::string sized_by = "size";

    /// Adds so many pixels beyond the edges of a picture of `size`, across and down, on either side.
    void add_overscan(const Size& overscan);
};

/// How a source is divided into faces.
struct SourceFaces {
    int columns = 1, rows = 1;
};

/// What an operation makes of its values: a picture, or several that follow each other, as subimages of a
/// file; each at all its levels.
class Pictures {
  public:
    virtual ~Pictures() = default;
    virtual int frames() const { return 1; }
    /// A frame, or a coarser level of it; none past the last level.
    virtual std::optional<PictureRequest> picture(int frame, int level) const = 0;
    /// How the first source is divided.
    virtual SourceFaces faces() const { return {}; }
    /// What the pictures read in place of their i-th source, upright and in the colour space that they are filtered in, before
    /// coarser levels are made of it; null where they read the source itself. It keeps a reference to the source.
    virtual std::unique_ptr<Source> over_source(std::size_t, const Source&) const { return nullptr; }
};

/// All that an operation is given.
struct OperationInput {
    const ParameterValues& values;
    const std::vector<SourceImage>& sources;  ///< the sources that are given, in the order of their keys
    const SideFiles& files;
    const SideFileReader& reader;
    std::vector<std::string> missing = {};  ///< keys of linked images that cannot be opened
};

/// A small recipe: its arguments besides the sources, and the text of the files that they name.
struct Example {
    std::string arguments;
    std::vector<std::pair<std::string, std::string>> files;
};

/// A file that is known of once others are read.
struct LinkedFile {
    std::string key;  ///< key among the side files; the name of a parameter where that alone names the file
    std::string name;
    bool image = false;  ///< is it drawn? The picture's sources go on with it
};
/// Linked files, in the order in which they are named.
using LinkedFiles = std::vector<LinkedFile>;

/// An entry of the registry.
struct Operation {
    std::string name;                  ///< name of its recipes: "pano"
    std::string title;                 ///< the picture it draws, in a few words
    const ParameterTable* parameters;  ///< keys of type image and file are its sources and side files
    std::vector<std::string> sources;  ///< keys of the images it draws; may be none
    std::size_t least_sources;
    Example example;  ///< for sources of any kind that are as large
    /// The function that read() calls.
    std::unique_ptr<const Pictures> (*make)(const OperationInput& input);

    /// The key of the side file that is by default the recipe's name without its ending; may be none. Where it is that of the first
    /// source, a file with one of `endings` names images (`linked`), which are then the sources, as they are stored.
    std::string main_file = {};
    /// The endings of files that are drawn as they stand, as that side file: "n" of walk.n?frame=3.
    std::vector<std::string> endings = {};
    /// Finds the files that are named among other words in a value, for named_files(). May be null.
    LinkedFiles (*named)(const ParameterValues& values) = nullptr;
    /// Finds the files that the side files name; the picture changes with them. May be null. Throws Error.
    LinkedFiles (*linked)(const ParameterValues& values, const SideFiles& files,
                          const SideFileReader& reader) = nullptr;
    /// May the first source be six files, one a face of a cube (operation/face_files.h)?
    bool reads_faces = false;

    /// The files that values name: those of keys of type file and image that are given, and those that `named` finds.
    LinkedFiles named_files(const ParameterValues& values) const;
    /// Is it the name of a file that stands for the first source, and names images that are the sources?
    bool gathers(std::string_view file) const;
    /// The name of such a file among the side files; empty where there is none.
    std::string gathering_file(const SideFiles& files) const;

    /// Makes pictures of what it is given: of `least_sources` sources or more, up to one for each of its keys, or of all that a file gathers, and of
    /// the side files that the values of keys of type file and image name, which the host has entered by these keys. Throws Error.
    std::unique_ptr<const Pictures> read(const OperationInput& input) const;
};

/// All operations, in the order of list.h.
const std::vector<const Operation*>& operations();

/// The operation that has a name; null where there is none.
const Operation* find_operation(std::string_view name);

/// The names of all operations, "pano, warp, morph", for messages.
std::string operation_names();

/// A text made of all that `read` is given: where it is the same, pictures are. The sources' pixels are none
/// of it.
std::string operation_key(const Operation& operation, const ParameterValues& values,
                          const std::vector<SourceImage>& sources, const SideFiles& files);

/// Checks that what is mixed with colours of `first` is in their colour space, unless another is asked for.
/// `name`: of the image, for messages. Throws Error.
void check_color_space(const SourceImage& image, const std::string& name, const SourceImage& first,
                       const std::string& first_name, const ParameterValues& values);

/// A size halved each way, `level` times, rounded down, at least 1; none past the level of one pixel.
std::optional<Size> level_size(const Size& size, int level);

}  // namespace anamorph
