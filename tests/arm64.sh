#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/arm64.sh FOLDER
# Compiles the core for arm64 into FOLDER and draws the pictures of tests/core/test_picture_hash.cpp there, by qemu: they have the
# hashes of every other processor. Debian's libraries of arm64 are unpacked beside it; the machine gets none. Needs section [arm64] of
# packages.txt.
set -euo pipefail
if [ $# -ne 1 ]; then
    echo "usage: arm64.sh FOLDER" >&2
    exit 1
fi
source="$(cd "$(dirname "$0")/.." && pwd)"
mkdir -p "$1"
folder="$(cd "$1" && pwd)"
export ANAMORPH_ARM64_ROOT="$folder/root"

# With lists of its own, of both kinds of machine.
fetch() {
    local work="$folder/fetch" package packages=()
    for package in gemmi-dev libgmock-dev libgtest-dev libhwy-dev libhwy1 libpugixml-dev libpugixml1v5 libxxhash-dev; do
        packages+=("$package:arm64")
    done
    rm -rf "$work" && mkdir -p "$work"/{lists,cache/archives}/partial && cd "$work"
    local options=(-q -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o "APT::Sandbox::User="
        -o "APT::Architectures::=amd64" -o "APT::Architectures::=arm64")
    apt-get "${options[@]}" update
    apt-get "${options[@]}" download "${packages[@]}" libglm-dev nlohmann-json3-dev
    for package in *.deb; do dpkg-deb -x "$package" "$work/root"; done
    mv "$work/root" "$ANAMORPH_ARM64_ROOT"
    cd "$source" && rm -rf "$work"
}
[ -e "$ANAMORPH_ARM64_ROOT/usr" ] || fetch

cmake -S "$source" -B "$folder/build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$source/tests/arm64.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DANAMORPH_OIIO=OFF -DANAMORPH_COMMAND=OFF
cmake --build "$folder/build" -j "$(nproc)" --target anamorph_hash_tests
qemu-aarch64 -L /usr/aarch64-linux-gnu -E "LD_LIBRARY_PATH=$ANAMORPH_ARM64_ROOT/usr/lib/aarch64-linux-gnu" \
    "$folder/build/tests/core/anamorph_hash_tests"
