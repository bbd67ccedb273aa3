// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/stereo.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "anamorph/image/part_source.h"
#include "anamorph/operation/rows.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

/// How a source holds them.
enum class Stereo { none, top_bottom, side_by_side };

/// A picture for each eye that is drawn, which reads that eye's part of the sources.
class SolvedStereo final : public SolvedPicture {
  public:
    SolvedStereo(std::unique_ptr<const SolvedPicture> of_one, const Eyes& eyes, const Size& size)
        : m_of_one(std::move(of_one)), m_eyes(eyes), m_size(size) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        return m_of_one->reached(parallel_for);
    }
    bool reached_by_drawing() const override { return m_of_one->reached_by_drawing(); }
    Attributes known() const override { return m_of_one->known(); }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        std::unique_ptr<const SolvedPicture> moved = m_of_one->of_moved();
        return moved ? std::make_unique<SolvedStereo>(std::move(moved), m_eyes, m_size) : nullptr;
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        bool ok = true;
        for (int i = 0; i < m_eyes.count(); ++i) {
            const Box own = m_eyes.part(m_size, i, m_eyes.count()), part = reaching(own, box);
            if (part.empty()) continue;
            std::deque<PartSource> parts;
            std::vector<const Source*> seen;
            for (const Source* source : sources)
                seen.push_back(
                    source ? &parts.emplace_back(*source, m_eyes.part(source->size(0), m_eyes.first() + i, 2))
                           : nullptr);
            ImageView to = view;
            to.data = view.at(part.x0 - box.x0, part.y0 - box.y0);
            to.width = part.width();
            to.height = part.height();
            ok = m_of_one->draw(seen, moved(part, -own.x0, -own.y0), to, parallel_for) && ok;
        }
        return ok;
    }

  private:
    /// The pixels of a box that an eye's picture fills; beyond the edges of all, the one next to them.
    Box reaching(const Box& own, const Box& box) const {
        return {own.x0 == 0 ? box.x0 : std::max(box.x0, own.x0),
                own.y0 == 0 ? box.y0 : std::max(box.y0, own.y0),
                own.x1 == m_size.width ? box.x1 : std::min(box.x1, own.x1),
                own.y1 == m_size.height ? box.y1 : std::min(box.y1, own.y1)};
    }

    std::unique_ptr<const SolvedPicture> m_of_one;
    Eyes m_eyes;
    Size m_size;
};

class StereoPictures final : public Pictures {
  public:
    StereoPictures(std::unique_ptr<const Pictures> of_one, const Eyes& eyes)
        : m_of_one(std::move(of_one)), m_eyes(eyes) {}

    int frames() const override { return m_of_one->frames(); }
    std::optional<PictureRequest> picture(int frame, int level) const override {
        std::optional<PictureRequest> request = m_of_one->picture(frame, level);
        if (!request) return {};
        (m_eyes.are_above() ? request->size.height : request->size.width) *= m_eyes.count();
        // What is said of a panorama is not true of two of them in one picture.
        if (m_eyes.count() == 2)
            std::erase_if(request->says, [](const Attribute& a) { return !a.name.starts_with("anamorph:"); });
        request->solve = [solve = request->solve, eyes = m_eyes, size = request->size] {
            return std::make_unique<SolvedStereo>(solve(), eyes, size);
        };
        return request;
    }
    SourceFaces faces() const override {
        SourceFaces faces = m_of_one->faces();
        (m_eyes.are_above() ? faces.rows : faces.columns) *= 2;
        return faces;
    }

  private:
    std::unique_ptr<const Pictures> m_of_one;
    Eyes m_eyes;
};

}  // namespace

ParameterTable rows::stereo() {
    return {
        enumeration(
            "stereo", "none",
            {{"none", Stereo::none},
             {"top-bottom", Stereo::top_bottom},
             {"side-by-side", Stereo::side_by_side}},
            "the source holds a panorama for each eye: top-bottom, the left one's above; side-by-side, "
            "the left one's on the left"),
        choice("eye", "both", {"both", "left", "right"},
               "of stereo: the eye whose picture is drawn; both, as the source has them, size being that of "
               "one"),
    };
}

Eyes::Eyes(const ParameterValues& values, const SourceFacts& facts)
    : m_facts(facts),
      m_are_two(rows::chosen<Stereo>(values, "stereo") != Stereo::none),
      m_are_above(rows::chosen<Stereo>(values, "stereo") == Stereo::top_bottom) {
    const std::string &eye = values.text("eye"), &stereo = values.text("stereo");
    if (!m_are_two) {
        if (values.given("eye"))
            throw Error("eye", eye, "must be given together with stereo=top-bottom or side-by-side");
        return;
    }
    if (kIsSmall) refuse_left_out("stereo=" + stereo);
    if ((m_are_above ? facts.height : facts.width) % 2 != 0)
        throw Error("stereo", stereo,
                    std::string("must be of a source of even ") + (m_are_above ? "height" : "width") +
                        ", which " + std::to_string(facts.width) + "x" + std::to_string(facts.height) +
                        " is not");
    m_first = eye == "right" ? 1 : 0;
    m_count = eye == "both" ? 2 : 1;
    if (m_count == 2 && values.given("overscan"))
        throw Error("overscan", printable(values.text("overscan")), "must be of one eye, eye=left or right");
    if (is_stmap(rows::chosen_output(values)))
        throw Error("output", values.text("output"), "must not be given with stereo=" + stereo);
    const Box one = part({facts.width, facts.height}, 0, 2);
    m_facts.width = one.width();
    m_facts.height = one.height();
    m_facts.overscan = {};
}

SourceFacts Eyes::facts_of_one() const {
    return m_facts;
}

std::unique_ptr<const Pictures> Eyes::pictures(std::unique_ptr<const Pictures> of_one) const {
    if (kIsSmall || !m_are_two) return of_one;
    return std::make_unique<StereoPictures>(std::move(of_one), *this);
}

Box Eyes::part(const Size& size, int i, int count) const {
    const int w = m_are_above ? size.width : size.width / count,
              h = m_are_above ? size.height / count : size.height;
    return moved({0, 0, w, h}, m_are_above ? 0 : i * w, m_are_above ? i * h : 0);
}

}  // namespace anamorph
