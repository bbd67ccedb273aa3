#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/packages.sh [SUITE [oiio|vtk|paraview]...]
# Makes the Debian packages of this working tree in clean roots of a release of Debian (SUITE: bookworm, trixie), lets lintian look at them, and
# tries them in other clean roots, a host each: installed by apt, one command for each program, upgraded, purged. Packages, the roots that make
# them and archives of clean ones stay in build/packaging, so that the next run compiles what changed. Needs root, and Debian's archive; from nothing an hour of two cores.
# PACKAGES_OPTIMIZE=-O1 in the environment takes half of that: packages of a trial, which are slower and have the same bits.
# tests/packages/test_packages.py does what can be done without.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ "$(id -u)" -ne 0 ]; then
    echo "packages.sh: needs root, for roots of its own" >&2
    exit 1
fi
suite="${1:-bookworm}"
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- oiio vtk paraview
tests/install_packages.sh packages
jobs="${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}"
optimize="${PACKAGES_OPTIMIZE:--O3}"
folder="$PWD/build/packaging/$suite"
packages="$folder/packages"
mkdir -p "$packages" "$folder/ccache"

# What is mounted in the root that is used now.
root="" mounted=() tried=""
leave() {
    local at
    # What an interrupted run began may still be using it.
    for at in "${mounted[@]}"; do umount "$at" 2>/dev/null || umount --lazy "$at" || return; done # or what is mounted would be removed
    mounted=()
    [ -z "$tried" ] || rm -rf "$tried"
    tried=""
}
trap leave EXIT
bind() {
    mkdir -p "$2"
    mount --bind "$1" "$2"
    mounted=("$2" "${mounted[@]}")
}
in_root() {
    chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 LIBGL_ALWAYS_SOFTWARE=1 OMPI_ALLOW_RUN_AS_ROOT=1 \
        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 DEBIAN_FRONTEND=noninteractive "$@"
}
apt() {
    in_root apt-get -q -y --no-install-recommends "$@"
}
# clean_root FOLDER [PACKAGE...]
clean_root() {
    local list
    list="$(IFS=,; echo "${*:2}")"
    mmdebstrap --quiet --variant=minbase --aptopt='APT::Install-Recommends "false"' --aptopt='Acquire::Check-Valid-Until "false"' \
        --dpkgopt=force-unsafe-io ${list:+--include="$list"} "$suite" "$1" || return
    [ ! -d "$1" ] || chmod 755 "$1" # as apt's own user finds it elsewhere
}
# clean_archive HOST [PACKAGE...]: a clean root for a host, which is made the first time.
clean_archive() {
    [ -e "$folder/clean-$1.tar" ] || { clean_root "$folder/new.tar" "${@:2}" && mv "$folder/new.tar" "$folder/clean-$1.tar"; }
}
section() {
    sed -n "/^\[$1\]$/,/^\[/{/^[a-z0-9]/p}" tests/packages.txt
}

# make_packages HOST TOOLKIT VIEWER DEBIAN_PACKAGE...: in a root that has these.
make_packages() {
    local host="$1" toolkit="$2" viewer="$3" log="$folder/$1.txt" oiio=OFF
    [ "$host" != oiio ] || oiio=ON
    root="$folder/make-$host"
    if [ ! -d "$root" ]; then
        echo "$suite: a root that makes the packages for $host"
        rm -rf "$root.new"
        # shellcheck disable=SC2046 # words
        clean_root "$root.new" ca-certificates ccache dpkg-dev file $(section build) $(section hosts) "${@:4}" >"$log" 2>&1 || fail "$log"
        [ "$suite" = bookworm ] || tests/link_python_modules.sh "$root.new"
        mv "$root.new" "$root"
    fi
    bind "$PWD" "$root/anamorph"
    mount -o remount,bind,ro "$root/anamorph"
    bind "$folder/ccache" "$root/ccache"
    bind /proc "$root/proc"
    rm -f "$root"/build/packages/*.deb
    in_root env CCACHE_DIR=/ccache CCACHE_SLOPPINESS=pch_defines,time_macros CMAKE_CXX_COMPILER_LAUNCHER=ccache sh -c "
        cmake -S /anamorph -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE='$optimize -DNDEBUG' -DANAMORPH_TESTS=OFF -DANAMORPH_OIIO=$oiio \
            -DANAMORPH_SHARED=$oiio -DANAMORPH_TOOLKIT=$toolkit -DANAMORPH_VIEWER=$viewer -DPython3_EXECUTABLE=/usr/bin/python3 &&
        cmake --build /build -j $jobs --target packages" >"$log" 2>&1 || fail "$log"
    local deb
    for deb in "$root"/build/packages/*.deb; do
        rm -f "$packages/$(dpkg-deb -f "$deb" Package)"_*.deb # of another version
        cp "$deb" "$packages"
    done
    leave
}
fail() {
    tail -n 40 "$1" >&2
    echo "packages.sh: failed; the log is $1" >&2
    exit 1
}

files() {
    (cd "$root" && find . -xdev \( -path ./proc -o -path ./tmp -o -path ./var -o -path ./root -o -path ./etc/ssl -o -path ./etc/alternatives \) \
        -prune -o -print | grep -v __pycache__ | sort)
}
# try_packages HOST OTHERS COMMANDS DEBIAN_PACKAGE...: in a clean root with these, which need nothing of ours; OTHERS are packages that are not for it.
try_packages() {
    local host="$1" others="$2" commands="$3" deb names=() log="$folder/try-$1.txt"
    tried="$(mktemp -d)"
    root="$tried"
    echo "$host: a clean root of $suite"
    clean_archive "$host" "${@:4}" >"$log" 2>&1 || fail "$log"
    tar -C "$root" -xf "$folder/clean-$host.tar"
    chmod 755 "$root" # as apt's own user finds it elsewhere
    bind /proc "$root/proc" # anamorph finds the plugin by what it says
    mkdir -p "$root/dev/shm" "$root/tmp/packages"
    bind /dev/shm "$root/dev/shm"
    for deb in "$packages"/*.deb; do
        if [[ "$(basename "$deb")" =~ ^($others)_ ]]; then continue; fi
        cp "$deb" "$root/tmp/packages"
        names+=("$(dpkg-deb -f "$deb" Package)")
    done
    files >"$root/tmp/before"
    apt update >"$log" 2>&1 || true
    in_root sh -c "apt-get -q -y --no-install-recommends install /tmp/packages/*.deb" >"$log" 2>&1 || fail "$log"
    in_root sh -ec "cd /tmp; $commands" || fail "$log"
    echo "$host: ${names[*]}: installed, tried"
    in_root sh -c "apt-get -q -y --no-install-recommends --reinstall install /tmp/packages/*.deb" >"$log" 2>&1 || fail "$log"
    apt purge "${names[@]}" >"$log" 2>&1 || fail "$log"
    # What a package of the host recommends came with ours all the same.
    apt -o APT::AutoRemove::RecommendsImportant=false -o APT::AutoRemove::SuggestsImportant=false autoremove --purge >"$log" 2>&1 || fail "$log"
    files >"$root/tmp/after"
    if ! diff "$root/tmp/before" "$root/tmp/after"; then
        echo "packages.sh: the purge left something, or took too much" >&2
        exit 1
    fi
    echo "$host: upgraded, purged"
    leave
}

# try_image: the Dockerfile, on an image of this Debian that is made here.
image() {
    buildah --root "$tried/images" --runroot "$tried/run" --storage-driver vfs "$@"
}
try_image() {
    local log="$folder/try-image.txt" container
    export BUILDAH_ISOLATION=chroot
    tried="$(mktemp -d)"
    echo "image: Dockerfile with packages of $suite"
    clean_archive image >"$log" 2>&1 || fail "$log"
    container="$(image from scratch)"
    image add "$container" "$folder/clean-image.tar" / >"$log" 2>&1 || fail "$log"
    image config --env PATH=/usr/sbin:/usr/bin:/sbin:/bin "$container"
    image commit -q "$container" "docker.io/library/debian:$suite-slim" >"$log" 2>&1 || fail "$log"
    image build -t tried --build-arg "DEBIAN=$suite" -f plugins/packages/Dockerfile "$packages" >"$log" 2>&1 || fail "$log"
    container="$(image from --pull-never tried)"
    [ "$(image inspect --format '{{.OCIv1.Config.Entrypoint}}' "$container")" = "[anamorph run]" ]
    image run "$container" -- anamorph run oiiotool --pattern fill:color=.25,.5,.75 64x32 3 -o sky.exr >"$log" 2>&1 || fail "$log"
    image run "$container" -- anamorph run oiiotool "sky.exr.pano?to=rectilinear&size=32x24" -o view.exr >"$log" 2>&1 || fail "$log"
    echo "image: $(image run "$container" -- anamorph hash view.exr)"
    leave
}

oiio_commands='
    oiiotool --pattern fill:color=.25,.5,.75 64x32 3 -o sky.exr
    anamorph run oiiotool "sky.exr.pano?to=rectilinear&size=32x24" -o run.exr
    bash -lc "oiiotool \"sky.exr.pano?to=rectilinear&size=32x24\" -o login.exr"
    bash -lc "python3 -c \"import OpenImageIO as o; assert o.ImageBuf(\\\"sky.exr.pano?to=rectilinear&size=32x24\\\").spec().width == 32\""
    anamorph draw "sky.exr.pano?to=rectilinear&size=32x24" -o drawn.exr
    test "$(anamorph hash run.exr login.exr drawn.exr | cut -c1-32 | uniq | wc -l)" = 1
    python3 -c "import anamorph, numpy as n; assert anamorph.pano(n.ones((32, 64), n.float32), size=(8, 8)).shape == (8, 8)"
    anamorph --version
    anamorph help pano >help.txt
    anamorph-figure --help >help.txt
    anamorph-machine --help >help.txt
    bash -lc "anamorph doctor"
    if anamorph doctor >/dev/null; then echo "doctor sees no missing variable" >&2; exit 1; fi
    mkdir user
    printf "%s\n" "cmake_minimum_required(VERSION 3.25)" "project(User CXX)" "find_package(Anamorph REQUIRED)" "add_executable(user user.cpp)" \
        "target_link_libraries(user Anamorph::oiio_ops)" >user/CMakeLists.txt
    printf "%s\n" "#include <anamorph/version.h>" "#include <anamorph/oiio_ops.h>" "int main() { return *anamorph::version() == 0; }" >user/user.cpp
    cmake -S user -B user/build >cmake.txt && cmake --build user/build >cmake.txt && user/build/user
    sed -i s/Anamorph::oiio_ops/Anamorph::shared/ user/CMakeLists.txt && sed -i /oiio_ops/d user/user.cpp
    cmake --build user/build >cmake.txt && user/build/user && ldd user/build/user | grep -q libanamorph.so'
deform='
    printf "%s\n" "from anamorph.vtk import vtkAnamorphDeform, vtkAnamorphEllipsoidMapper" "from vtkmodules.vtkFiltersSources import vtkPlaneSource" \
        "plane = vtkPlaneSource()" "plane.SetResolution(20, 20)" "deform = vtkAnamorphDeform()" \
        "deform.SetInputConnection(plane.GetOutputPort())" "deform.AddDeformation(0, 0, 1, 1, 0, 0, 1)" "deform.Update()" \
        "assert deform.GetOutput().GetBounds()[5] > .5" >classes.py'
vtk_commands="$deform"'
    python3 classes.py
    anamorph-view --help >help.txt
    anamorph-warp --help >help.txt'
# Nothing is told of a plugin.
paraview_commands="$deform"'
    printf "%s\n" "from paraview.simple import *" "surface = AnamorphDeform(Input=Plane(XResolution=20, YResolution=20), Deformations=[0, 0, 1, 1, 0, 0, 1, 0, 1])" \
        "surface.UpdatePipeline()" "assert surface.GetDataInformation().GetBounds()[5] > .5" "import anamorph" >plugin.py
    pvpython plugin.py
    mpiexec -n 2 pvbatch plugin.py
    pvpython classes.py'

# ParaView's windows are made with Qt 6 from Debian 13 on.
qt=()
[ "$suite" = bookworm ] || qt=(qt6-base-dev)
of_vtk='libvtk9-anamorph|python3-vtk9-anamorph|anamorph-view' of_paraview='paraview-anamorph|python3-paraview-anamorph'
# shellcheck disable=SC2046 # words
for host in "$@"; do
    case "$host" in
        oiio) make_packages oiio NONE OFF help2man mkdocs mkdocs-material ;;
        vtk) make_packages vtk VTK ON libvtk9-dev python3-vtk9 $(section vtk) ;;
        paraview) make_packages paraview PARAVIEW OFF "${qt[@]}" $(section paraview) ;;
        *)
            echo "packages.sh: $host: must be oiio, vtk or paraview" >&2
            exit 1
            ;;
    esac
done
echo "lintian:"
if ! lintian --allow-root --fail-on error "$packages"/*.deb; then
    echo "packages.sh: lintian found errors" >&2
    exit 1
fi
for host in "$@"; do
    case "$host" in
        oiio)
            try_packages oiio "$of_vtk|$of_paraview" "$oiio_commands" openimageio-tools python3-openimageio cmake make g++
            try_image
            ;;
        vtk) try_packages vtk "$of_paraview|libanamorph-dev" "$vtk_commands" python3-vtk9 ;;
        paraview) try_packages paraview "$of_vtk|libanamorph-dev" "$paraview_commands" python3-paraview paraview openmpi-bin ;;
    esac
done
