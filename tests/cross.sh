#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/cross.sh arm64|avx512|i386|wasm FOLDER [all|vtk]
# Compiles the core for arm64, for x86 with AVX-512 or of 32 bits, or as WebAssembly into FOLDER, and draws the pictures of
# tests/core/test_picture_hash.cpp there (by qemu, Bochs or node, where this machine cannot): they have the hashes of every other processor.
# With "all" all tests of the core are run on arm64 or 32 bits; with "vtk" VTK's filters compute on arm64 what
# tests/vtk/test_vtk_hashes.cpp has hashes of. Debian's libraries of that machine are unpacked beside it; this one gets
# none. Needs section [arm64], [avx512], [i386] or [web] of packages.txt, and for the last [build] and [tests], too.
set -euo pipefail
usage() {
    echo "usage: cross.sh arm64|avx512|i386|wasm FOLDER [all|vtk]" >&2
    exit 1
}
[ $# -eq 2 ] || { [ $# -eq 3 ] && [ "$3" = all ]; } || { [ $# -eq 3 ] && [ "$1" = arm64 ] && [ "$3" = vtk ]; } || usage
case "$1" in
    arm64) ANAMORPH_CROSS=aarch64-linux-gnu run=(qemu-aarch64) ;;
    i386) ANAMORPH_CROSS=i686-linux-gnu run=() ;;
    avx512 | wasm) [ $# -eq 2 ] || usage ;;
    *) usage ;;
esac
machine="$1"
source="$(cd "$(dirname "$0")/.." && pwd)"
mkdir -p "$2"
folder="$(cd "$2" && pwd)"
if [ "$machine" = wasm ]; then
    # Debian's emscripten finds Debian's acorn with Debian's node alone, and takes what that fetches for a web server's.
    export NODE_PATH=/usr/share/nodejs
    cmake -S "$source" -B "$folder/build" --preset web -DANAMORPH_TESTS=ON
    cmake --build "$folder/build" -j "$(nproc)" --target anamorph_hash_tests
    node --no-experimental-fetch "$folder/build/tests/web/hashes/anamorph_hash_tests.js"
    exit
fi
if [ "$machine" = avx512 ]; then
    # Bochs 2.7 refuses gathers whose indices lie in one of the upper sixteen registers, and rounds halves away from zero on ties.
    cmake -S "$source" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DANAMORPH_OIIO=OFF -DANAMORPH_COMMAND=OFF \
        -DCMAKE_CXX_FLAGS="-DHWY_DISABLE_F16C $(printf -- '-ffixed-xmm%d ' {16..31})"
    cmake --build "$folder/build" -j "$(nproc)" --target anamorph_hash_tests
    exec "$source/tests/emulate.sh" "$folder/emulated" "$folder/build/tests/core/anamorph_hash_tests"
fi
export ANAMORPH_CROSS ANAMORPH_CROSS_ROOT="$folder/root"

# With lists of its own, of both kinds of machine.
fetch() {
    local work="$folder/fetch" package packages=()
    for package in gemmi-dev libgmock-dev libgtest-dev libhwy-dev libhwy1 libpugixml-dev libpugixml1v5 libxxhash-dev; do
        packages+=("$package:$machine")
    done
    rm -rf "$work" && mkdir -p "$work"/{lists,cache/archives}/partial && cd "$work"
    local options=(-q -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o "APT::Sandbox::User="
        -o "APT::Architectures::=amd64" -o "APT::Architectures::=$machine")
    # A list that cannot be read is missed below, if one of the packages is in it.
    apt-get "${options[@]}" update || true
    apt-get "${options[@]}" download "${packages[@]}" libglm-dev nlohmann-json3-dev
    for package in *.deb; do dpkg-deb -x "$package" "$work/root"; done
    mv "$work/root" "$ANAMORPH_CROSS_ROOT"
    cd "$source" && rm -rf "$work"
}
[ -e "$folder/root/usr" ] || fetch

# VTK, with all that it needs, as if nothing were installed. Its CMake package looks for every file that VTK has, Java's and Qt's too, whose
# own libraries need not be there.
fetch_vtk() {
    local work="$folder/fetch" package packages
    packages="$(sed -n '/^\[vtk\]$/,/^$/{/-dev$/p}' "$source/tests/packages.txt")"
    rm -rf "$work" && mkdir -p "$work"/{lists,cache/archives}/partial && touch "$work/status" && cd "$work/cache/archives"
    local options=(-q -o "Dir::State::lists=$work/lists" -o "Dir::State::status=$work/status" -o "Dir::Cache=$work/cache"
        -o "APT::Sandbox::User=" -o "APT::Architecture=$machine" -o "APT::Architectures::=$machine")
    apt-get "${options[@]}" update || true
    # shellcheck disable=SC2086 # words
    apt-get "${options[@]}" -y --no-install-recommends --download-only install libvtk9.1 $packages
    apt-get "${options[@]}" download libvtk9-dev libvtk9-java libvtk9.1-qt python3-vtk9 vtk9
    for package in *.deb; do dpkg-deb -x "$package" "$work/root"; done
    mv "$work/root" "$folder/vtk-root"
    cd "$source" && rm -rf "$work"
}
if [ $# -eq 3 ] && [ "$3" = vtk ]; then
    [ -e "$folder/vtk-root/usr" ] || fetch_vtk
    # VTK's programs, which describe classes, and the tests find that machine's libraries there.
    export ANAMORPH_CROSS_ROOT="$folder/root;$folder/vtk-root" QEMU_LD_PREFIX="$folder/vtk-root"
    cmake -S "$source" -B "$folder/vtk" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$source/tests/cross.cmake" -DCMAKE_BUILD_TYPE=Release \
        -DANAMORPH_OIIO=OFF -DANAMORPH_COMMAND=OFF -DANAMORPH_TOOLKIT=VTK -DPython3_EXECUTABLE=/usr/bin/python3
    cmake --build "$folder/vtk" -j "$(nproc)" --target anamorph_vtk_hash_tests
    exec "${run[@]}" "$folder/vtk/bin/anamorph_vtk_hash_tests"
fi

cmake -S "$source" -B "$folder/build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$source/tests/cross.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DANAMORPH_OIIO=OFF -DANAMORPH_COMMAND=OFF
if [ $# -eq 2 ]; then
    cmake --build "$folder/build" -j "$(nproc)" --target anamorph_hash_tests
    "${run[@]}" "$folder/build/tests/core/anamorph_hash_tests"
else
    cmake --build "$folder/build" -j "$(nproc)" --target anamorph_core_tests
    ctest --test-dir "$folder/build" -j "$(nproc)" --no-tests=error -L core
fi
