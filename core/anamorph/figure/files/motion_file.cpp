// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/motion_file.h"

#include <algorithm>

#include "anamorph/figure/files/frame_file.h"
#include "anamorph/figure/files/mrasel_file.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

/// Frames that are kept, in the order of the file.
class KeptFrames final : public Motion {
  public:
    explicit KeptFrames(std::vector<FigureFrame> frames) : m_frames(std::move(frames)) {
        for (std::size_t i = 0; i < m_frames.size(); ++i) {
            m_frames[i].number = static_cast<int>(i) + 1;
            for (const Body& body : m_frames[i].bodies)
                if (!body.texture.empty() &&
                    std::find(m_images.begin(), m_images.end(), body.texture) == m_images.end())
                    m_images.push_back(body.texture);
        }
    }

    int last_frame() override { return static_cast<int>(m_frames.size()); }
    FigureFrame frame(int number) override {
        if (number < 0 || number > last_frame())
            throw Error("frame", std::to_string(number),
                        "must be an integer from 0 to " + std::to_string(last_frame()));
        FigureFrame frame = m_frames[static_cast<std::size_t>(std::max(number, 1) - 1)];
        frame.number = number;
        return frame;
    }
    const std::vector<std::string>& images() const override { return m_images; }

  private:
    std::vector<FigureFrame> m_frames;
    std::vector<std::string> m_images;
};

}  // namespace

bool is_motion_file(std::string_view name) {
    for (const char* ending : {".bvh", ".cif", ".3", ".mrasel"})
        if (text_file::ends_with(name, ending)) return true;
    return false;
}

std::unique_ptr<Motion> read_motion(std::string_view text, std::string_view name, double probability) {
    if (text_file::ends_with(name, ".bvh")) return read_bvh(text, name);
    if (text_file::ends_with(name, ".cif")) return read_cif(text, name, probability);
    if (text_file::ends_with(name, ".mrasel"))
        return std::make_unique<KeptFrames>(std::vector{mrasel_frame(text, name)});
    std::vector<FigureFrame> frames = parse_frames(text, name);
    if (frames.empty()) text_file::fail(name, "", "has no frame");
    return std::make_unique<KeptFrames>(std::move(frames));
}

}  // namespace anamorph::figure
