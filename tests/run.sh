#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Builds and tests everything on Debian 12, from a fresh machine on. The last line is ctest's own summary.
# Logs are in build/log; the log of a step that fails is printed.
set -euo pipefail
cd "$(dirname "$0")/.."
tests/install_packages.sh build hosts tests bench peers plots vtk paraview
vtk_prefix="$PWD/build/vtk-9.1"
tests/unpack_vtk.sh "$vtk_prefix"

log_dir=build/log
mkdir -p "$log_dir"
jobs="$(nproc)"
fuzz_seconds=5
# The core is built with its hosts, for VTK and for ParaView: in folders that ccache is to take for one.
export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
export ANAMORPH_WERROR=ON                  # in the demo as well, so that the tests need not build it all again

# step NAME COMMAND...: quiet when it succeeds; prints its log and ends the run when it fails.
step() {
    local name="$1"
    shift
    local start=$SECONDS
    if ! "$@" >"$log_dir/$name.txt" 2>&1; then
        cat "$log_dir/$name.txt" >&2
        echo "run.sh: $name failed; its log is $log_dir/$name.txt" >&2
        exit 1
    fi
    echo "$name: ok, $((SECONDS - start)) s"
}

check_format() {
    find core oiio_ops plugins tests vtk_filters -name '*.h' -o -name '*.cpp' -o -name '*.cxx' | xargs clang-format --dry-run -Werror
}

# build PRESET [CMAKE ARGUMENT...]
build() {
    cmake --preset "$@" -DANAMORPH_WERROR=ON && cmake --build --preset "$1" -j "$jobs"
}

# with_vtk COMMAND...: where the libraries and tools of plain VTK find each other.
with_vtk() {
    LD_LIBRARY_PATH="$vtk_prefix/lib" "$@"
}

run_tests() {
    ctest --preset "$1" -j "$jobs" --no-tests=error --no-label-summary
}

fuzz_one() {
    build/fuzz/fuzz/"$1" -max_total_time="$fuzz_seconds" -timeout=10 -rss_limit_mb=2048 \
        -dict=tests/fuzz/fuzz.dict -artifact_prefix=build/fuzz/"$1"- -print_final_stats=1
}
export -f fuzz_one
export fuzz_seconds

run_fuzz_targets() {
    find build/fuzz/fuzz -maxdepth 1 -name 'fuzz_*' -executable -printf '%f\n' | sort |
        xargs -P "$jobs" -I TARGET bash -c 'fuzz_one TARGET || exit 255'
}

step format check_format
step build-fuzz build fuzz
step fuzz run_fuzz_targets
step build-asan build asan
step test-asan run_tests asan
step build-tsan build tsan
step test-tsan run_tests tsan
# The demo uses the same folder: whichever of the two comes first, the other must do.
step demo-before-tests examples/demo.sh --quick
step build-release build release
step test-release run_tests release
step demo-after-tests examples/demo.sh --quick
step build-vtk with_vtk build vtk "-DVTK_ROOT=$vtk_prefix/usr" -DPython3_EXECUTABLE=/usr/bin/python3
step test-vtk with_vtk run_tests vtk
step build-paraview build paraview -DPython3_EXECUTABLE=/usr/bin/python3
step test-paraview run_tests paraview
for preset in vtk paraview release; do
    sed -n '/tests passed/,$p' "$log_dir/test-$preset.txt"
done
