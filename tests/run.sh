#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Builds and tests on Debian 12, from a fresh machine on, what every change is to keep; tests/nightly.sh does the rest.
# The last line is ctest's own summary.
. "$(dirname "$0")/steps.sh"

check_format() {
    find core examples oiio_ops plugins tests vtk_filters -name '*.h' -o -name '*.cpp' -o -name '*.cxx' |
        xargs clang-format --dry-run -Werror
}

step format check_format
step build-release build release
step test-release run_tests release -LE nightly
# It uses the same folder.
step demo examples/demo.sh --quick
step build-vtk build_vtk
step test-vtk with_vtk run_tests vtk -LE nightly
step build-paraview build_paraview
step test-paraview run_tests paraview -LE nightly
print_summaries test-vtk test-paraview test-release
