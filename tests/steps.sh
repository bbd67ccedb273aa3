# SPDX-License-Identifier: Apache-2.0
# What run.sh and nightly.sh are made of. Logs are in build/log; the log of a step that fails is printed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tests/install_packages.sh build hosts tests bench peers plots vtk paraview
vtk_prefix="$PWD/build/vtk-9.1"
tests/unpack_vtk.sh "$vtk_prefix"

log_dir=build/log
mkdir -p "$log_dir"
jobs="$(nproc)"
# The core is built with its hosts, for VTK and for ParaView: in folders that ccache is to take for one.
export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
export ANAMORPH_WERROR=ON                  # in the demo as well, so that the tests need not build it all again

# step NAME COMMAND...: quiet when it succeeds; prints its log and ends the run when it fails.
step() {
    local name="$1"
    shift
    local start=$SECONDS
    if ! "$@" >"$log_dir/$name.txt" 2>&1; then
        cat "$log_dir/$name.txt" >&2
        echo "$(basename "$0"): $name failed; its log is $log_dir/$name.txt" >&2
        exit 1
    fi
    echo "$name: ok, $((SECONDS - start)) s"
}

# build PRESET [CMAKE ARGUMENT...]
build() {
    cmake --preset "$@" -DANAMORPH_WERROR=ON && cmake --build --preset "$1" -j "$jobs"
}
build_vtk() {
    with_vtk build vtk "-DVTK_ROOT=$vtk_prefix/usr" -DPython3_EXECUTABLE=/usr/bin/python3
}
build_paraview() {
    build paraview -DPython3_EXECUTABLE=/usr/bin/python3 "$@"
}

# with_vtk COMMAND...: where the libraries and tools of plain VTK find each other.
with_vtk() {
    LD_LIBRARY_PATH="$vtk_prefix/lib" "$@"
}

# run_tests PRESET [CTEST ARGUMENT...]
run_tests() {
    ctest --preset "$1" -j "$jobs" --no-tests=error --no-label-summary "${@:2}"
}

# fuzz SECONDS: each target for so long, from what tests/fuzz/corpus has of it. What it finds is not kept there.
fuzz_one() {
    local corpus="tests/fuzz/corpus/$1" found="build/fuzz/found/$1"
    mkdir -p "$found"
    build/fuzz/fuzz/"$1" -max_total_time="$fuzz_seconds" -timeout=10 -rss_limit_mb=2048 \
        -dict=tests/fuzz/fuzz.dict -artifact_prefix=build/fuzz/"$1"- -print_final_stats=1 "$found" "$corpus"
}
export -f fuzz_one
fuzz() {
    export fuzz_seconds="$1"
    find tests/fuzz -name 'fuzz_*.cpp' -printf '%f\n' | sed 's/\.cpp$//' | sort |
        xargs -P "$jobs" -I TARGET bash -c 'fuzz_one TARGET || exit 255'
}

# Prints ctest's summaries of test logs; the last line is ctest's own.
print_summaries() {
    local name
    for name in "$@"; do
        sed -n '/tests passed/,$p' "$log_dir/$name.txt"
    done
}
