# SPDX-License-Identifier: Apache-2.0
# The programs of examples/cpp say what they are to, built here or against an installed Anamorph.
add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/../examples/cpp ${PROJECT_BINARY_DIR}/examples/cpp)

# example_says(NAME PATTERN)
function(example_says name pattern)
    add_test(NAME example_${name} COMMAND example_${name})
    set_tests_properties(example_${name} PROPERTIES PASS_REGULAR_EXPRESSION "${pattern}")
endfunction()
set(small "(0|0\\.0[0-9]+|[0-9.]+e-[0-9]+)")
# (960 - 540.5) / f on the plane, f = 960 / tan 30 degrees, and the cubic u (1 - r^2 / 10) solved; atan of that in 4096 / 360.
example_says(chart "along 0\\.330[0-9]*, -0\\.207[0-9]*, 1, at \\(2255\\.8[0-9]*, 897\\.2[0-9]*\\)")
# The mean of 0 to 63, over 255.
example_says(image "4x4 texels, the first row 0\\.12352?[0-9]* 0\\.37[0-9]* 0\\.62[0-9]* 0\\.87[0-9]*\n")
example_says(mesh "off by at most ${small}, middle 0\\.(60|599)[0-9]*\n")
example_says(morph "off by at most ${small}, middle 0\\.25\n")
# Yaw 160 is seen at 0.5 + 160 / 360 of the width.
example_says(panorama "off by at most ${small}, [0-9.]+ % computed exactly, middle 0\\.944[0-9]*\n")
example_says(projector "texel \\(1024, 512\\)\n[1-9][0-9]* pieces painted, [1-9][0-9]* in the .* at most 0\\.4[0-9]* .*GLSL: bool findTexel")
# Without its shadows, the scene would be seen by all 122022 rays that meet it.
example_says(scene "^1[01][0-9][0-9][0-9][0-9] rays see the panorama, 1[12][0-9][0-9][0-9] shadows\n")
example_says(deform "height 0\\.2, .*\nheight 0\\.1, columns [1-9][0-9]* to [1-4].*\nheight 0\\.025 .*\na point .* 3\\.1 and back to 3, nothing folds")
example_says(figure "^2 bodies, 1 joint\nbody: 1 visible arcs, 1 hidden\nhead: 1 visible arcs, 1 hidden\ncovers 11[0-9]* pixels")
example_says(operation "^middle 0\\.25\nanamorph:max_error ${small}\nanamorph:exact_fraction ${small}\nfov=400: must be")

# What docs/cpp.md shows is one of them.
file(READ ${CMAKE_CURRENT_LIST_DIR}/../docs/cpp.md page)
if(NOT page MATCHES "<!-- panorama.cpp: begin -->\n(.*)\n<!-- panorama.cpp: end -->")
    message(FATAL_ERROR "docs/cpp.md: no example")
endif()
string(REPLACE "\n    " "\n" shown "${CMAKE_MATCH_1}")
file(READ ${CMAKE_CURRENT_LIST_DIR}/../examples/cpp/panorama.cpp example)
string(FIND "${example}" "${shown}" at)
if(at EQUAL -1)
    message(FATAL_ERROR "docs/cpp.md shows another panorama.cpp:\n${shown}")
endif()
