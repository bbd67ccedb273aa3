// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/film.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "anamorph/image/picture.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

constexpr int kMostSamples = 256;
constexpr int kMostChecked = 1024;  // moments

struct Shutter {
    double open = 0;  ///< frames
    int samples = 1;

    /// The moments that are seen at a time, in the middles of as many equal parts of the shutter's.
    std::vector<double> moments(double time) const {
        std::vector<double> all;
        for (int k = 0; k < samples; ++k) all.push_back(time + open * ((k + 0.5) / samples - 0.5));
        return all;
    }
};

Shutter read_shutter(const ParameterValues& values) {
    const Shutter shutter{values.number("shutter"), values.whole("samples")};
    if (shutter.open == 0) {
        if (values.given("samples"))
            throw Error("samples", values.text("samples"), "must be given together with shutter");
        return {};
    }
    if (is_stmap(rows::chosen_output(values)))
        throw Error("output", values.text("output"),
                    "must not be given with shutter: a pixel then has several source points");
    return shutter;
}

/// The mean of pictures of the same sources.
Picture mean_of(std::vector<Picture> pictures) {
    Picture mean = pictures.front();
    mean.maps.clear();
    mean.says = {};
    for (Picture& picture : pictures)
        for (Picture::Map& map : picture.maps) {
            for (Picture::Layer& layer : map.layers) layer.weight /= static_cast<double>(pictures.size());
            mean.maps.push_back(std::move(map));
        }
    return mean;
}

class FilmPictures final : public Pictures {
  public:
    FilmPictures(Sequence sequence, const Shutter& shutter, MakePictures make)
        : m_sequence(std::move(sequence)), m_shutter(shutter), m_make(std::move(make)) {
        // What is wrong with a frame is said when the film is opened, of very many when it is read.
        const int checked = std::min(frames(), kMostChecked / m_shutter.samples);
        for (int i = 0; i < checked; ++i) check(m_sequence.time_of(i));
    }

    int frames() const override { return m_sequence.frames(); }
    std::optional<PictureRequest> picture(int frame, int level) const override {
        const double time = m_sequence.time_of(frame);
        std::optional<PictureRequest> request = at(time, level);
        if (!request) return {};
        if (m_sequence.is_film()) request->says.push_back({"anamorph:frame", time});
        if (m_shutter.samples == 1) return request;
        request->moves = {};
        // Shared, as requests are copied.
        const auto moments = std::make_shared<std::vector<PictureRequest>>();
        for (const double moment : m_shutter.moments(time)) moments->push_back(*at(moment, level));
        request->solve = [moments] {
            std::vector<Picture> pictures;
            for (const PictureRequest& moment : *moments) pictures.push_back(*moment.solve()->of_maps());
            return solved(mean_of(std::move(pictures)));
        };
        return request;
    }
    SourceFaces faces() const override { return pictures_at(m_sequence.time_of(0))->faces(); }
    std::unique_ptr<Source> over_source(std::size_t i, const Source& source) const override {
        return pictures_at(m_sequence.time_of(0))->over_source(i, source);
    }

  private:
    std::unique_ptr<const Pictures> pictures_at(double time) const {
        return m_make(m_sequence.values_at(time));
    }
    std::optional<PictureRequest> at(double time, int level) const {
        return pictures_at(time)->picture(0, level);
    }
    void check(double time) const {
        try {
            const Size size = at(time, 0)->size;
            if (m_shutter.samples == 1) return;
            for (const double moment : m_shutter.moments(time))
                if (!(at(moment, 0)->size == size))
                    throw Error("shutter", shortest(m_shutter.open),
                                "must be given together with size where the picture's own one changes");
        } catch (const Error& error) {
            if (!m_sequence.has_keys()) throw;
            throw Error("frame " + shortest(time) + ": " + error.what());
        }
    }

    Sequence m_sequence;
    Shutter m_shutter;
    MakePictures m_make;
};

}  // namespace

ParameterTable rows::shutter() {
    return {
        number(
            "shutter", "frames", "0", 0, 1000,
            "how long the shutter is open, about the frame's time: the picture is the mean of what is seen "
            "meanwhile; 0: it shows one moment"),
        whole("samples", "", "16", 2, kMostSamples,
              "of shutter: the number of moments, evenly spread, that are drawn and averaged"),
    };
}

std::unique_ptr<const Pictures> film_pictures(const OperationInput& input, MakePictures make) {
    const Shutter shutter = read_shutter(input.values);
    Sequence sequence(input);
    if (!sequence.is_film() && shutter.samples == 1) return make(input.values);
    if (kIsSmall) refuse_left_out("a film");
    return std::make_unique<FilmPictures>(std::move(sequence), shutter, std::move(make));
}

}  // namespace anamorph
