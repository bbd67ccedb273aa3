#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What tests/run.sh leaves out because it takes hours: long tests, fuzzing, sanitizers through all hosts, clang, what the
# tests of the core cover, clang-tidy, and what became of the last version's binary interface. It says how long each step took; the
# last line is ctest's own summary.
. "$(dirname "$0")/steps.sh"
tests/install_packages.sh nightly arm64 avx512 farm i386 packages web

# Each file by itself, so that what it forgets to include is found, and clang-tidy has a command for each.
clang="build/clang"
build_clang() {
    cmake --preset release -B "$clang" -DCMAKE_CXX_COMPILER=clang++ -DANAMORPH_UNITY=OFF \
        -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping" && cmake --build "$clang" -j "$jobs"
}
test_clang() {
    LLVM_PROFILE_FILE="$PWD/$clang/profiles/%2m.profraw" \
        ctest --test-dir "$clang" -j "$jobs" --no-tests=error --no-label-summary -L core
}
# Lines and branches of each file of the core that its tests run; the log has the table.
coverage() {
    llvm-profdata merge -sparse "$clang"/profiles/*.profraw -o "$clang/coverage.profdata" &&
        llvm-cov report "$clang/tests/core/anamorph_core_tests" -instr-profile="$clang/coverage.profdata" core/anamorph
}
# The shared libraries beside those of the last version, where there is one: nothing of a version that differs in its patch alone may
# be gone.
abi() {
    local tag old library
    tag="$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null)" || return 0
    grep -q "project(Anamorph VERSION $(sed 's/^v//; s/\.[^.]*$//' <<<"$tag")\." CMakeLists.txt || return 0
    old="$PWD/build/abi"
    rm -rf "$old" && mkdir -p "$old" && git archive "$tag" | tar -x -C "$old" || return
    (cd "$old" && with_vtk cmake --preset vtk -DVTK_ROOT="$vtk_prefix/usr" -DPython3_EXECUTABLE=/usr/bin/python3 \
        -DANAMORPH_TESTS=OFF -DANAMORPH_SHARED=ON && cmake --build --preset vtk -j "$jobs") || return
    for library in "$old"/build/vtk/lib*/libAnamorph*.so; do
        abidiff --no-added-syms "$library" "build/vtk/${library#"$old/build/vtk/"}" || return
    done
    abidiff --no-added-syms "$old/build/vtk/core/libanamorph.so" build/release/core/libanamorph.so
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
step build-release build release -DANAMORPH_NIGHTLY=ON
step test-release-long run_tests release -L nightly
step build-vtk build_vtk
step test-vtk-long with_vtk run_tests vtk -L nightly
step abi abi
step build-paraview build_paraview -DANAMORPH_NIGHTLY=ON
step test-paraview-long run_tests paraview -L nightly
step farm tests/farm.sh build/release
step arm64 tests/cross.sh arm64 build/arm64
step arm64-vtk tests/cross.sh arm64 build/arm64 vtk
step avx512 tests/cross.sh avx512 build/avx512
step i386 tests/cross.sh i386 build/i386 all
step wasm tests/cross.sh wasm build/wasm
step web tests/web/web.sh build/release
step build-fuzz build fuzz
step test-fuzz run_tests fuzz
step fuzz-long fuzz 120
step build-asan build asan
step test-asan run_tests asan
step build-tsan build tsan
step test-tsan run_tests tsan
step build-clang build_clang
step test-clang test_clang
step coverage coverage
step clang-tidy tidy
tail -1 "$log_dir/coverage.txt"
print_summaries test-vtk-long test-paraview-long test-asan test-tsan test-release-long
