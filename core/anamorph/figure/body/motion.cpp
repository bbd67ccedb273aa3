// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/motion.h"

namespace anamorph::figure {

int Motion::frame_count() {
    const long long first = first_frame(), last = last_frame();
    return last < first ? 0 : static_cast<int>((last - first) / frame_step() + 1);
}

void Motion::for_each_frame(const std::function<bool(const FigureFrame&)>& body) {
    const long long last = last_frame(), step = frame_step();
    for (long long f = first_frame(); f <= last; f += step)
        if (!body(frame(static_cast<int>(f)))) return;
}

namespace {

const std::vector<std::string>& none() {
    static const std::vector<std::string> texts;
    return texts;
}

}  // namespace

const std::vector<std::string>& Motion::warnings() const {
    return none();
}

const std::vector<std::string>& Motion::images() const {
    return none();
}

}  // namespace anamorph::figure
