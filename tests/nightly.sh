#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What tests/run.sh leaves out because it takes hours: long tests, longer fuzzing, sanitizers through all hosts, clang and
# clang-tidy. It says how long each step took; the last line is ctest's own summary.
. "$(dirname "$0")/steps.sh"

# Each file by itself, so that what it forgets to include is found, and clang-tidy has a command for each.
clang="build/clang"
build_clang() {
    cmake --preset release -B "$clang" -DCMAKE_CXX_COMPILER=clang++ -DANAMORPH_UNITY=OFF && cmake --build "$clang" -j "$jobs"
}
test_clang() {
    ctest --test-dir "$clang" -j "$jobs" --no-tests=error --no-label-summary -L core
}
# Kernels are written as Highway is, whose macros and names clang-tidy does not know.
tidy() {
    git ls-files 'core/*.cpp' 'oiio_ops/*.cpp' 'plugins/imageio/*.cpp' ':!*_lanes.cpp' |
        xargs -P "$jobs" -n 1 clang-tidy --quiet --warnings-as-errors='*' -p "$clang"
}
# On a machine where nothing was built before.
demo_first() {
    rm -rf build/release && examples/demo.sh --quick
}

step demo-first demo_first
step build-release build release
step test-release-long run_tests release -L nightly
step build-vtk build_vtk
step test-vtk-long with_vtk run_tests vtk -L nightly
step build-paraview build_paraview
step test-paraview-long run_tests paraview -L nightly
step build-fuzz build fuzz
step fuzz-long fuzz 120
step build-asan build asan
step test-asan run_tests asan
step build-tsan build tsan
step test-tsan run_tests tsan
step build-clang build_clang
step test-clang test_clang
step clang-tidy tidy
print_summaries test-vtk-long test-paraview-long test-asan test-tsan test-release-long
