#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/packages.sh [SUITE]
# Makes the Debian packages of the release build, lets lintian look at them, and tries them in a clean root of Debian (SUITE: bookworm),
# which is to be the release of this machine: installed by apt, one command for each host, upgraded, purged. Needs root, and Debian's
# archive; takes a quarter of an hour where the build is there. tests/packages/test_packages.py does what can be done without.
set -euo pipefail
cd "$(dirname "$0")/.."
suite="${1:-bookworm}"
if [ "$(id -u)" -ne 0 ]; then
    echo "packages.sh: needs root, for a root of its own" >&2
    exit 1
fi
tests/install_packages.sh build hosts packages
cmake --preset release >/dev/null
cmake --build build/release --target packages

echo "lintian:"
if ! lintian --allow-root --fail-on error build/release/packages/*.deb; then
    echo "packages.sh: lintian found errors" >&2
    exit 1
fi

root="$(mktemp -d)"
mounted=()
leave() {
    local at
    for at in "${mounted[@]}"; do umount "$at" || return; done # or what is mounted would be removed
    rm -rf "$root"
}
trap leave EXIT
echo "a clean root of $suite:"
mmdebstrap --quiet --variant=minbase "$suite" "$root"
chmod 755 "$root" # as apt's own user finds it elsewhere
if mount -t proc proc "$root/proc" 2>/dev/null; then
    mounted+=("$root/proc")
else
    # anamorph finds the plugin by what /proc says of it.
    echo "packages.sh: /proc cannot be mounted here" >&2
    exit 1
fi
in_root() {
    chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
}
apt() {
    in_root apt-get -q -y --no-install-recommends "$@"
}
files() {
    (cd "$root" && find . -xdev \( -path ./proc -o -path ./tmp -o -path ./var -o -path ./root -o -path ./etc/ssl -o -path ./etc/alternatives \) \
        -prune -o -print | sort)
}

echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io" # the root is gone soon
apt update >/dev/null
# What the hosts need, before and after: nothing of ours is to be left.
apt install openimageio-tools python3-openimageio cmake make g++ >/dev/null
mkdir "$root/tmp/packages"
cp build/release/packages/*.deb "$root/tmp/packages"
files >"$root/tmp/before"

echo "install:"
in_root sh -c "apt-get -q -y --no-install-recommends install /tmp/packages/*.deb" >/dev/null
in_root sh -c '
    set -eu
    cd /tmp
    oiiotool --pattern fill:color=.25,.5,.75 64x32 3 -o sky.exr
    anamorph run oiiotool "sky.exr.pano?to=rectilinear&size=32x24" -o run.exr
    bash -lc "oiiotool \"sky.exr.pano?to=rectilinear&size=32x24\" -o login.exr"
    bash -lc "python3 -c \"import OpenImageIO as o; assert o.ImageBuf(\\\"sky.exr.pano?to=rectilinear&size=32x24\\\").spec().width == 32\""
    anamorph draw "sky.exr.pano?to=rectilinear&size=32x24" -o drawn.exr
    test "$(anamorph hash run.exr login.exr drawn.exr | cut -c1-32 | uniq | wc -l)" = 1
    anamorph help pano >/dev/null
    anamorph-figure --help >/dev/null
    anamorph-machine --help >/dev/null
    bash -lc "anamorph doctor"
    if anamorph doctor >/dev/null; then echo "doctor sees no missing variable" >&2; exit 1; fi
    mkdir user && cd user
    printf "%s\n" "cmake_minimum_required(VERSION 3.25)" "project(User CXX)" "find_package(Anamorph REQUIRED)" "add_executable(user user.cpp)" \
        "target_link_libraries(user Anamorph::oiio_ops)" >CMakeLists.txt
    printf "%s\n" "#include <anamorph/version.h>" "#include <anamorph/oiio_ops.h>" "int main() { return *anamorph::version() == 0; }" >user.cpp
    cmake -B build . >/dev/null && cmake --build build >/dev/null && build/user
'
echo "install: ok"
in_root sh -c "apt-get -q -y --no-install-recommends --reinstall install /tmp/packages/*.deb" >/dev/null
in_root anamorph --version
echo "again, as an upgrade: ok"
apt purge anamorph anamorph-openimageio libanamorph-dev >/dev/null
apt autoremove --purge >/dev/null
files >"$root/tmp/after"
if ! diff <(grep -v __pycache__ "$root/tmp/before") <(grep -v __pycache__ "$root/tmp/after"); then
    echo "packages.sh: the purge left something, or took too much" >&2
    exit 1
fi
echo "purge: ok"
