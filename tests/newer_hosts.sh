#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/newer_hosts.sh SUITE [vtk|paraview]...
# Tries the VTK modules with the VTK of a newer Debian (SUITE: trixie, sid), and the plugin with its ParaView, each in a clean root of
# its own: builds them there from this working tree, and runs the scripts of tests/vtk and tests/paraview, which draw and compare
# pictures; at -O1, which compiles in half the time and draws the same. Prints a row of the table in docs/building.md for each, and what failed. Needs root, mmdebstrap, and Debian's archive; an hour
# or more of two cores. Roots stay in build/hosts, so that the next run compiles what changed; remove those for clean ones.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -lt 1 ] || [ "$(id -u)" -ne 0 ]; then
    echo "usage, as root: newer_hosts.sh SUITE [vtk|paraview]..." >&2
    exit 1
fi
suite="$1"
shift
[ $# -gt 0 ] || set -- vtk paraview
roots="$PWD/build/hosts"
jobs="${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}"
mkdir -p "$roots/$suite-ccache"

common=(ca-certificates ccache cmake fonts-dejavu-core g++ gemmi-dev libboost-dev libfreetype-dev libgl-dev libgl1-mesa-dri libglew-dev
    libglm-dev libgmock-dev libgtest-dev libhwy-dev libopenmpi-dev libpugixml-dev libpython3-dev libx11-dev libxxhash-dev ninja-build
    nlohmann-json3-dev openmpi-bin python3-numpy xauth xvfb)
declare -A packages=(
    [vtk]="libvtk9-dev python3-vtk9"
    [paraview]="paraview-dev python3-paraview libdouble-conversion-dev libxtst6 qt6-base-dev"
)
if [ "$suite" != trixie ]; then
    common=("${common[@]/#gemmi-dev/libgemmi-dev}")     # as it is called from then on
    packages[paraview]+=" libvtk9-dev libvtk9-qt-dev" # which ParaView is made with from then on, and paraview-dev does not bring
fi
declare -A names=([vtk]=VTK [paraview]=ParaView)
# What is built: the modules, and for ParaView the plugin with what its tests ask for values. Their own tests in C++ are not.
declare -A targets=(
    [vtk]="AnamorphFiltersPython AnamorphRenderingPython"
    [paraview]="AnamorphFiltersPython AnamorphRenderingPython Anamorph anamorph_print_rows"
)
declare -A tests=(
    [vtk]="-R ^vtk_python|^vtk_example.(expressions|look_around)|^vtk_round_trip|^vtk_splat|^vtk_ellipsoid_[^b]"
    [paraview]="-R ^paraview|^vtk_python|^vtk_example|^vtk_round_trip|^vtk_splat|^vtk_ellipsoid -E test_(tables|installed|examples|figure_memory)"
)

mounted=()
leave() {
    local at
    for at in "${mounted[@]}"; do umount "$at"; done
    mounted=()
}
trap leave EXIT

# bind FROM TO [OPTION]: shows a folder in a root until we leave.
bind() {
    mkdir -p "$2"
    mount --bind "$1" "$2"
    mounted=("$2" "${mounted[@]}")
    if [ $# -gt 2 ]; then mount -o "remount,bind,$3" "$2"; fi
}

make_root() {
    local list
    list="$(tr ' ' , <<<"${common[*]} ${packages[$host]}")"
    echo "$suite: a clean root with $host"
    rm -rf "$root.new"
    # Of mirrors that lag behind, too; and what is unpacked need not outlive a power cut.
    mmdebstrap --quiet --variant=minbase --aptopt='APT::Install-Recommends "false"' --aptopt='Acquire::Check-Valid-Until "false"' \
        --dpkgopt=force-unsafe-io --include="$list" "$suite" "$root.new" || exit 1
    mv "$root.new" "$root"
    tests/link_python_modules.sh "$root"
}

in_root() {
    chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 LIBGL_ALWAYS_SOFTWARE=1 CCACHE_DIR=/ccache \
        CCACHE_SLOPPINESS=pch_defines,time_macros CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER:-ccache}" OMPI_ALLOW_RUN_AS_ROOT=1 \
        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "$@"
}

# stop LOG: of what cannot be built.
stop() {
    tail -n 40 "$1" >&2
    echo "newer_hosts.sh: failed; the log is $1" >&2
    exit 1
}

version() {
    in_root dpkg-query -W -f='${Version}' "$1" 2>/dev/null | sed -E 's/^[0-9]+://; s/([0-9]+\.[0-9]+(\.[0-9]+)?).*/\1/'
}

try_host() {
    local host="$1" root="$roots/$suite-$1" log="$roots/$suite-$1" failed=0 package row
    [ -d "$root" ] || make_root
    bind "$PWD" "$root/anamorph" ro
    bind "$roots/$suite-ccache" "$root/ccache"
    bind /proc "$root/proc"
    bind /dev/shm "$root/dev/shm"
    bind /sys "$root/sys" ro # MPI reads what network there is
    in_root cmake -S /anamorph -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DANAMORPH_OIIO=OFF -DANAMORPH_COMMAND=OFF \
        -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DANAMORPH_TOOLKIT="${host^^}" -DANAMORPH_TESTS=ON -DPython3_EXECUTABLE=/usr/bin/python3 >"$log.configure.txt" 2>&1 ||
        stop "$log.configure.txt"
    # shellcheck disable=SC2086 # words
    in_root cmake --build /build -j "$jobs" --target ${targets[$host]} >"$log.build.txt" 2>&1 || stop "$log.build.txt"
    # shellcheck disable=SC2086
    in_root ctest --test-dir /build --output-on-failure --no-tests=error ${tests[$host]} >"$log.tests.txt" 2>&1 || failed=1
    sed -n '/The following tests FAILED/,$p' "$log.tests.txt"
    row="| $suite, $(date +%Y-%m-%d) | ${names[$host]} $(version "${packages[$host]%% *}")"
    for package in g++ cmake python3 libhwy-dev libglm-dev; do row+=" | $(version "$package")"; done
    echo "$row | $(grep -c 'warning:' "$log.build.txt") | $(grep -c ' Passed ' "$log.tests.txt") of $(grep -c ' Test  *#' "$log.tests.txt") |"
    leave
    return "$failed"
}

echo "| | VTK or ParaView | g++ | CMake | Python | Highway | GLM | warnings | scripts that pass |"
failed=0
for host in "$@"; do try_host "$host" || failed=1; done
exit "$failed"
