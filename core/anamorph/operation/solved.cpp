// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/solved.h"

#include <utility>

namespace anamorph {
namespace {

class Solved final : public SolvedPicture {
  public:
    Solved(Picture picture, Attributes known) : m_picture(std::move(picture)), m_known(std::move(known)) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        const Reached reached = m_picture.reached(parallel_for);
        Attributes all = {{"anamorph:max_error", reached.max_error},
                          {"anamorph:exact_fraction", reached.exact_fraction}};
        all.insert(all.end(), m_known.begin(), m_known.end());
        if (m_picture.says)
            for (Attribute& attribute : m_picture.says(parallel_for)) all.push_back(std::move(attribute));
        return all;
    }
    Attributes known() const override { return m_known; }
    const Picture* of_maps() const override { return &m_picture; }
    bool reached_by_drawing() const override { return m_picture.reached_by_drawing; }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        return moved_channels(m_picture.data).empty() ? nullptr : solved(m_picture.of_data());
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_picture.draw(sources, box, view, parallel_for);
    }

  private:
    Picture m_picture;
    Attributes m_known;
};

}  // namespace

PixelKind pixels_of(Output output) {
    switch (output) {
        case Output::stmap:
        case Output::stmap_up:
            return PixelKind::point;
        case Output::error:
        case Output::bound:
        case Output::coverage:
            return PixelKind::value;
        default:
            return PixelKind::color;
    }
}

std::vector<int> moved_channels(const DataChannels& data) {
    return data.filter == Filter::nearest ? data.channels : std::vector<int>{};
}

Attributes said_of_pixels(double aspect) {
    Attributes says;
    if (aspect != 1) says.push_back({"PixelAspectRatio", aspect});
    return says;
}

std::unique_ptr<const SolvedPicture> solved(Picture picture, Attributes known) {
    return std::make_unique<Solved>(std::move(picture), std::move(known));
}

}  // namespace anamorph
