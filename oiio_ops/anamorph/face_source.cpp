// SPDX-License-Identifier: Apache-2.0
#include "anamorph/face_source.h"

#include <cstddef>

#include "anamorph/error.h"
#include "anamorph/metadata.h"
#include "anamorph/orientation.h"

namespace anamorph {
namespace {

using OIIO::ImageSpec;

std::string text_of(const Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels";
}

std::string channels_of(const ImageSpec& spec) {
    std::string text = "the channels";
    for (int c = 0; c < spec.nchannels; ++c)
        text.append(" ")
            .append(spec.channel_name(c))
            .append(" (")
            .append(spec.channelformat(c).c_str())
            .append(")");
    return text;
}

std::string color_space_of(const ImageSpec& spec) {
    return "color space \"" + std::string(spec.get_string_attribute("oiio:ColorSpace")) + "\"";
}

/// Throws Error where a face is not like the first.
void check_alike(const CacheSource& face, const std::string& name, const CacheSource& first,
                 const std::string& first_name) {
    const ImageSpec own = upright(face.spec()), other = upright(first.spec());
    const Size size{own.full_width, own.full_height};
    const std::string file = "source \"" + printable(name) + "\" has ";
    if (const float aspect = own.get_float_attribute("PixelAspectRatio", 1); aspect != 1)
        throw Error(file + "PixelAspectRatio=" + shortest(aspect) +
                    ": must be 1, as a face of a cube is square");
    if (size.width != size.height)
        throw Error(file + text_of(size) + ": must be square, as a face of a cube is");
    const auto check = [&](const std::string& has, const std::string& wanted) {
        if (has != wanted)
            throw Error(file + printable(has) + ": must be as \"" + printable(first_name) + "\" has it, " +
                        printable(wanted));
    };
    check(text_of(size), text_of({other.full_width, other.full_height}));
    check(channels_of(own), channels_of(other));
    check(color_space_of(own), color_space_of(other));
    if (face.unassociated_alpha() != first.unassociated_alpha())
        throw Error(file + "alpha that is multiplied in, or not: must be as \"" + printable(first_name) +
                    "\" has it");
}

}  // namespace

FaceSource::FaceSource(std::vector<std::unique_ptr<CacheSource>> files, const FaceFiles& faces)
    : m_files(std::move(files)), m_spec(upright(m_files.front()->spec())) {
    for (std::size_t i = 0; i < m_files.size(); ++i) {
        check_alike(*m_files[i], faces.names[i], *m_files[0], faces.names[0]);
        const StoredOrder order(m_files[i]->spec());
        m_upright.push_back(order.is_upright() ? nullptr
                                               : std::make_unique<UprightSource>(*m_files[i], order));
    }
    const FaceGrid grid = faces_of(faces.layout);
    const int side = m_spec.full_width;
    const Chart layout(faces.layout, grid.columns * side, grid.rows * side, 0, PixelSpacing::edges, "src");
    for (const Piece& piece : layout.pieces()) m_places.push_back(piece.box);
    m_spec.x = m_spec.y = m_spec.full_x = m_spec.full_y = 0;
    m_spec.width = m_spec.full_width = layout.width();
    m_spec.height = m_spec.full_height = layout.height();
    m_spec.tile_width = m_spec.tile_height = 0;
    // What a face says of its projection and its camera is not true of all of them.
    m_known = source_image(m_spec);
    SourceFacts facts{layout.width(), layout.height()};
    facts.projection = faces.layout;
    facts.said_by = "{face}=" + faces.words;
    facts.has_alpha = m_known.facts.has_alpha;
    facts.channel_names = m_known.facts.channel_names;
    facts.data_channels = m_known.facts.data_channels;
    m_known.facts = facts;
}

FaceSource::~FaceSource() = default;

std::string FaceSource::error() const {
    for (const auto& file : m_files)
        if (std::string error = file->error(); !error.empty()) return error;
    return "";
}

void FaceSource::keep_stored() {
    for (const auto& file : m_files) file->keep_stored();
}

bool FaceSource::read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept {
    const std::ptrdiff_t pixel = std::ptrdiff_t{channels()} * size_of(type());
    for (std::size_t i = 0; i < m_files.size(); ++i) {
        const Box& place = m_places[i];
        const Box part = intersection(box, place);
        if (part.empty()) continue;
        const Source& face = m_upright[i] ? *m_upright[i] : *m_files[i];
        std::byte* const to = texels + (part.y0 - box.y0) * row_stride + (part.x0 - box.x0) * pixel;
        if (!face.read(0, moved(part, -place.x0, -place.y0), to, row_stride)) return false;
    }
    return true;
}

}  // namespace anamorph
