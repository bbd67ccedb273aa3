// SPDX-License-Identifier: Apache-2.0
#include "draw.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "frame_range.h"
#include "part_file.h"
#include "picture_reader.h"
#include "progress.h"
#include "recipe.h"
#include "threads.h"

namespace anamorph::command {
namespace {

bool has_frame_word(const std::string& text) {
    return text.find(kFrameWord) != std::string::npos;
}

std::string with_number(std::string text, int number) {
    for (std::size_t at = 0; (at = text.find(kFrameWord, at)) != std::string::npos;)
        text.replace(at, kFrameWord.size(), std::to_string(number));
    return text;
}

/// The frames of a recipe, in the order in which they are drawn.
class Film {
  public:
    explicit Film(const Drawing& drawing) : m_drawing(drawing), m_by_text(has_frame_word(drawing.recipe)) {
        m_range = drawing.frames ? parse_frame_range(*drawing.frames) : FrameRange{true};
        if (!m_range)
            throw Error("--frames", printable(*drawing.frames),
                        "must be a number such as 7, a range such as 1-48 or 1-48x4, or all");
        if (m_by_text && m_range->all)
            throw Error(
                "--frames: must be given as numbers, such as 1-48, where the recipe has {frame} in it");
        if (m_by_text) return;
        const Operation* operation = operation_of(drawing.recipe);
        m_by_key = operation && !m_range->all && ParameterValues(*operation->parameters).knows("frame");
        if (m_by_key) return;
        m_all = drawing.open(drawing.recipe, {});
        for (int s = 0; s < m_all->subimages(); ++s) m_numbers.push_back(number_of(s));
        if (!m_range->all && m_numbers.size() == 1 && m_range->last > m_numbers[0])
            throw Error("--frames", *drawing.frames, "the recipe has one picture, without {frame} in it");
        if (!m_range->all && (m_range->first < m_numbers.front() || m_range->last > m_numbers.back()))
            throw Error("--frames", *drawing.frames,
                        "must be from " + std::to_string(m_numbers.front()) + " to " +
                            std::to_string(m_numbers.back()));
    }

    std::int64_t count() const {
        return m_range->all ? std::ssize(m_numbers) : (m_range->last - m_range->first) / m_range->step + 1;
    }

    /// Draws the i-th of count() frames.
    void draw(std::int64_t i) {
        const int number = m_range->all ? m_numbers[static_cast<std::size_t>(i)]
                                        : m_range->first + static_cast<int>(i) * m_range->step;
        try {
            const PictureFile output{numbered_name(m_drawing.output, number), m_drawing.compression,
                                     m_drawing.in_float};
            if (m_all) {
                const auto at = std::find(m_numbers.begin(), m_numbers.end(), number);
                if (at == m_numbers.end()) throw Error("there is none of that number");
                return draw_picture_file(*m_all, static_cast<int>(at - m_numbers.begin()), output,
                                         [](auto) {});
            }
            std::vector<Assignment> given;
            if (m_by_key) given.push_back({"frame", std::to_string(number)});
            const std::string recipe = with_number(m_drawing.recipe, number);
            const std::unique_ptr<PictureReader> picture = m_drawing.open(recipe, given);
            expect_one(*picture, recipe);
            draw_picture_file(*picture, 0, output, [](auto) {});
        } catch (const std::exception& e) {
            throw Error("frame " + std::to_string(number) + ": " + message_of(e, "the picture"));
        }
    }

    static void expect_one(PictureReader& picture, const std::string& recipe) {
        if (picture.subimages() != 1)
            throw Error(
                printable(recipe) + " has " + std::to_string(picture.subimages()) +
                " pictures: must be one (frame=, or subimage= of a source of several parts), or {frame} "
                "must be in the name of the file");
    }

  private:
    /// The number that a picture says it is, or, counted from 0, has.
    int number_of(int subimage) const {
        const double said =
            m_all->spec(subimage).get_float_attribute("anamorph:frame", static_cast<float>(subimage));
        return static_cast<int>(std::lround(said));
    }

    const Drawing& m_drawing;
    std::optional<FrameRange> m_range;
    bool m_by_text, m_by_key = false;
    std::unique_ptr<PictureReader> m_all;  ///< where frames are pictures of one recipe
    std::vector<int> m_numbers;            ///< theirs
};

void draw_film(const Drawing& drawing, int jobs) {
    Film film(drawing);
    const std::int64_t count = film.count();
    // Files that are no recipes are read by one thread.
    const int together =
        operation_of(drawing.recipe) ? static_cast<int>(std::min<std::int64_t>(jobs, count)) : 1;
    OIIO::attribute("threads", std::max(1, jobs / together));
    Progress progress([count] { return count; });
    std::atomic<bool> failed = false;
    threads_for(together)(count, [&](std::int64_t i) {
        if (failed) return;
        try {
            film.draw(i);
        } catch (...) {
            failed = true;
            throw;
        }
        progress.advance();
    });
}

void draw_one(const Drawing& drawing) {
    const std::unique_ptr<PictureReader> picture = drawing.open(drawing.recipe, {});
    Film::expect_one(*picture, drawing.recipe);
    Progress progress([&] { return tiles_of(picture->spec(0)).count(); }, "tiles");
    draw_picture_file(*picture, 0, {drawing.output, drawing.compression, drawing.in_float},
                      [&](std::int64_t tiles) { progress.advance(tiles); });
}

}  // namespace

int use_threads(int jobs) {
    if (jobs < 0 || jobs > kMostJobs)
        throw Error("--jobs", std::to_string(jobs), "must be from 0 to " + std::to_string(kMostJobs));
    const int processors =
        static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, unsigned{kMostJobs}));
    const int threads = jobs > 0 ? jobs : processors;
    OIIO::attribute("threads", threads);
    return threads;
}

void draw(const Drawing& drawing) {
    const int jobs = use_threads(drawing.jobs);
    if (drawing.frames || has_frame_word(drawing.output) || has_frame_word(drawing.recipe))
        draw_film(drawing, jobs);
    else
        draw_one(drawing);
}

}  // namespace anamorph::command
