// SPDX-License-Identifier: Apache-2.0
// Six files, one a face of a cube, as the one picture of all faces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anamorph/image_source.h"
#include "anamorph/operation/face_files.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

/// The faces of a cube in their places in a layout: at one level, upright. Each shows its display window. Reading is thread safe.
class FaceSource final : public Source {
  public:
    /// `files`: those that `faces` names, in its order. Throws Error naming a file whose picture is not square, or differs from the
    /// first one's in size, channels, type of pixels or color space.
    FaceSource(std::vector<std::unique_ptr<CacheSource>> files, const FaceFiles& faces);
    ~FaceSource() override;

    /// The spec of the layout: its size, and all else as the first face has it.
    const OIIO::ImageSpec& spec() const { return m_spec; }
    /// What an operation may know of the layout.
    const SourceImage& known() const { return m_known; }
    /// The reason that the last failed read failed.
    std::string error() const;
    /// Hands out stored_pixels() from now on.
    void keep_stored();

    PixelType type() const noexcept override { return m_files.front()->type(); }
    int channels() const noexcept override { return m_files.front()->channels(); }
    int unassociated_alpha() const noexcept override { return m_files.front()->unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return {m_spec.width, m_spec.height}; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

  private:
    std::vector<std::unique_ptr<CacheSource>> m_files;
    std::vector<std::unique_ptr<Source>> m_upright;  ///< null where a file is upright itself
    std::vector<Box> m_places;                       ///< of the faces in the layout
    OIIO::ImageSpec m_spec;
    SourceImage m_known;
};

}  // namespace anamorph
