#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What tests/run.sh leaves out because it takes hours: long tests, longer fuzzing, sanitizers through all hosts, clang and
# clang-tidy. In the end it prints how long each took; the last line is ctest's own summary.
. "$(dirname "$0")/steps.sh"

# Other folders than presets have are below build/nightly.
build_with_clang() {
    cmake --preset release -B build/nightly/clang -DCMAKE_CXX_COMPILER=clang++ -DANAMORPH_WERROR=ON &&
        cmake --build build/nightly/clang -j "$jobs" &&
        ctest --test-dir build/nightly/clang -j "$jobs" --no-tests=error --no-label-summary -L core -LE nightly
}
tidy() {
    git ls-files 'core/*.cpp' 'oiio_ops/*.cpp' 'plugins/imageio/*.cpp' |
        xargs -P "$jobs" -n 1 clang-tidy --quiet --warnings-as-errors='*' -p build/nightly/each
}
# Each file by itself: what it forgets to include is found, and clang-tidy has a command for each.
build_each() {
    cmake --preset release -B build/nightly/each -DANAMORPH_UNITY=OFF -DCMAKE_CXX_COMPILER=clang++ -DANAMORPH_TESTS=OFF &&
        cmake --build build/nightly/each -j "$jobs"
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
step build-each build_each
step clang-tidy tidy
step clang build_with_clang
print_summaries test-vtk-long test-paraview-long test-asan test-tsan test-release-long
