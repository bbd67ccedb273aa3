#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/unpack_vtk.sh PREFIX
# Puts Debian's plain VTK 9.1 into PREFIX (200 MB), since its packages conflict with ParaView's. Needs no root;
# says and does nothing when it is there already. What VTK itself needs is in section [vtk] of packages.txt.
# To build and to run: export LD_LIBRARY_PATH=PREFIX/lib, where its libraries and tools find each other.
# For CMake:           -DVTK_ROOT=PREFIX/usr -DPython3_EXECUTABLE=/usr/bin/python3
# For Python:          PYTHONPATH=PREFIX/usr/lib/python3/dist-packages /usr/bin/python3
set -euo pipefail
if [ $# -ne 1 ]; then
    echo "usage: unpack_vtk.sh PREFIX" >&2
    exit 1
fi
[ ! -e "$1/usr" ] || exit 0
# VTK's CMake package looks for every file that VTK has, Java's and Qt's too.
packages=(libvtk9-dev libvtk9-java libvtk9.1 libvtk9.1-qt python3-vtk9 vtk9)

echo "fetching Debian's VTK 9.1 (34 MB)"
mkdir -p "$1"
prefix="$(cd "$1" && pwd)"
work="$(mktemp -d "$prefix/fetch.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work"

# With lists of its own: the machine's may be missing or old, and only root may update them.
download_with_lists() {
    local options=(-o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o "APT::Sandbox::User=")
    mkdir -p lists/partial cache/archives/partial
    apt-get -q "${options[@]}" update && apt-get -q "${options[@]}" download "${packages[@]}"
}

unpack() {
    local package
    for package in *.deb; do
        dpkg-deb -x "$package" root || return 1
    done
    ln -sfn "$(cd root && echo usr/lib/*-linux-gnu)" "$prefix/lib"
    mv root/usr "$prefix/usr"
}

if ! { apt-get -q download "${packages[@]}" || download_with_lists; } >log 2>&1 || ! unpack >>log 2>&1; then
    cat log >&2
    exit 1
fi
