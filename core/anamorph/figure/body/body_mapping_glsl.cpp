// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/body_mapping_glsl.h"

#include "anamorph/number/glsl_number.h"

namespace anamorph::figure {

std::string body_mapping_glsl(BodyMapping mapping, const std::string& name) {
    using Number = Jet1<GlslNumber>;
    GlslText text;
    const auto part = [&](const std::string& i) {
        return Number::variable(text.input("p." + i), text.input("a." + i), text.input("b." + i));
    };
    Number u, v;
    texture_point(mapping, part("x"), part("y"), part("z"), u, v);
    const auto vec2 = [&](int c) { return "vec2(" + u.c[c].written() + ", " + v.c[c].written() + ");\n"; };
    const std::string values = "  uv = " + vec2(0) + "  alongA = " + vec2(1) + "  alongB = " + vec2(2);
    return std::string(GlslText::prelude()) + "void " + name +
           "(vec3 p, vec3 a, vec3 b, out vec2 uv, out vec2 alongA, out vec2 alongB) {\n" + text.lines() +
           values + "}\n";
}

}  // namespace anamorph::figure
