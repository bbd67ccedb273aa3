#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Shows what Anamorph does, on Debian 12 from a fresh machine on: builds it, and lets the stock oiiotool draw views of an
# HDR panorama, warp a picture, film a morph of two and draw a figure. Everything it makes is in build/demo/out.
set -euo pipefail
cd "$(dirname "$0")/.."
usage="usage: examples/demo.sh [--quick | --long]

Builds Anamorph and draws pictures, films, and tables and plots of speed against error into build/demo/out. The packages of
Debian that are missing are installed (as root or with sudo), and it says which.

  --long   long tables: all cases, pictures 1024 pixels wide, 15 rounds; a quarter of an hour more
  --quick  tables of small pictures in one round, for tests
  --help   prints this"
tables=short
case "${1:-}" in
    "") ;;
    --quick | --long) tables="${1#--}" ;;
    --help | -h) echo "$usage"; exit 0 ;;
    *) echo "demo.sh: $1: must be --quick, --long or --help" >&2; exit 1 ;;
esac
if [ $# -gt 1 ]; then
    echo "demo.sh: $2: one option at most" >&2
    exit 1
fi
tests/install_packages.sh build hosts bench plots vtk
tests/unpack_vtk.sh build/vtk-9.1 # a rival in the table of speed against error

demo="$PWD/build/demo"
out="$demo/out"
mkdir -p "$out"

# Reads what ninja prints and says how far it is: on a terminal in one line that changes, else a line for every tenth.
show_progress() {
    local line made all percent shown=-1 width=10 start=$SECONDS end=$'\n'
    [ ! -t 1 ] || width=1 end=$'\r'
    while IFS= read -r line; do
        [[ "$line" =~ ^\[([0-9]+)/([0-9]+)\]\ (Building|Linking) ]] || continue
        made="${BASH_REMATCH[1]}" all="${BASH_REMATCH[2]}"
        percent=$((100 * made / all / width * width))
        if [ "$percent" -gt "$shown" ]; then
            shown=$percent
            printf 'building: %d%% (%d of %d), %d s%s' "$percent" "$made" "$all" $((SECONDS - start)) "$end"
        fi
    done
    [ ! -t 1 ] || [ "$shown" -lt 0 ] || echo
}

build() {
    cmake --preset release -DVTK_ROOT="$PWD/build/vtk-9.1/usr" &&
        NINJA_STATUS="[%f/%t] " cmake --build --preset release --target anamorph.imageio anamorph_figure speed_vs_error
}

echo "building into build/release (the first time this takes about 6 minutes on 2 cores)"
build 2>&1 | tee "$demo/build.txt" | show_progress || { cat "$demo/build.txt" >&2; exit 1; }
export OIIO_LIBRARY_PATH="$PWD/build/release/plugins/imageio"

# A real HDR panorama: one of the studio lights that come with Blender (CC0). Only the package's file is
# fetched and unpacked; nothing of it is installed.
fetch_panorama() {
    local lights="$demo/blender/usr/share/blender/datafiles/studiolights/world"
    if [ ! -e "$lights/sunset.exr" ]; then
        echo "fetching Debian's blender-data (31 MB)"
        (cd "$demo" && rm -f blender-data_*.deb && apt-get -q download blender-data &&
            dpkg-deb -x blender-data_*.deb blender) >"$demo/fetch.txt" 2>&1 || return 1
        rm -f "$demo"/blender-data_*.deb
    fi
    cp "$lights/sunset.exr" "$out/panorama.exr"
}
if ! fetch_panorama; then
    echo "it cannot be had: computing a panorama instead"
    /usr/bin/python3 examples/make_panorama.py "$out/panorama.exr"
fi

cd "$out"
# Highlights compressed into what a screen shows, then as screens want it.
tone_map=(--ch R,G,B --rangecompress --colorconvert linear sRGB -d uint8)

# draw NAME ARGUMENTS: a picture out of the panorama, drawn by the stock oiiotool.
draw() {
    echo "$1.png: panorama.exr.pano?$2"
    oiiotool "panorama.exr.pano?$2" "${tone_map[@]}" -o "$1.png"
}
oiiotool panorama.exr "${tone_map[@]}" -o panorama.png
draw rectilinear "to=rectilinear&fov=100&yaw=160&pitch=5&size=480x360"
draw rolled "to=rectilinear&fov=80&yaw=-70&pitch=-15&roll=20&size=480x360"
draw fisheye "to=fisheye&fov=180&pitch=-20&yaw=140&size=480x480"
draw little_planet "to=stereographic&fov=240&pitch=-90&size=480x480"
draw cylindrical "to=cylindrical&fov=200&yaw=90&size=640x320"
draw mercator "to=mercator&fov=360&size=480x400"
draw cube_faces "to=cubecross&size=640x480"

# The same from a recipe on disk, which every program that reads files by OpenImageIO can open; as an OpenEXR cube map.
printf '%s\n' '# six faces as a vertical strip' 'src=panorama.exr' 'to=cubemap' 'size=256' >cube.pano
echo "cube.exr: cube.pano"
oiiotool cube.pano -o cube.exr

# How far every source point used is from the exact one, in source pixels: brightest where it is furthest.
echo "error.png: output=error"
oiiotool "panorama.exr.pano?to=rectilinear&fov=100&yaw=160&pitch=5&size=480x360&output=error" \
    --divc "{TOP.MAXCOLOR}" --colormap inferno -d uint8 -o error.png

# A picture through a control mesh, as it is and half as strong, and how far every source point is off.
/usr/bin/python3 ../../../examples/make_faces.py round.png long.png faces.csv
/usr/bin/python3 ../../../examples/make_cube.py label_ .png
cp -r ../../../examples/bulge.json ../../../examples/maps .
echo "warp.jpg: round.png.warp?mesh=bulge.json"
oiiotool "round.png.warp?mesh=bulge.json" -o warp.jpg
echo "half_warp.jpg: round.png.warp?mesh=bulge.json&amount=0.5"
oiiotool "round.png.warp?mesh=bulge.json&amount=0.5" -o half_warp.jpg
echo "warp_error.png: output=error"
oiiotool "round.png.warp?mesh=bulge.json&output=error" --divc "{TOP.MAXCOLOR}" --colormap inferno -d uint8 -o warp_error.png

# Two real pictures: a cat (CC0) and a raccoon (public domain) that come with scikit-image and SciPy.
fetch_animals() {
    local data="$demo/animals/usr/lib/python3/dist-packages"
    if [ ! -e "$data/scipy/misc/face.dat" ]; then
        echo "fetching Debian's python3-skimage and python3-scipy (36 MB)"
        (cd "$demo" && rm -f python3-*.deb && apt-get -q download python3-skimage python3-scipy &&
            for deb in python3-*.deb; do dpkg-deb -x "$deb" animals; done) >"$demo/fetch_animals.txt" 2>&1 || return 1
        rm -f "$demo"/python3-*.deb
    fi
    /usr/bin/python3 -c 'import bz2, sys; sys.stdout.buffer.write(b"P6 1024 768 255\n" + bz2.open(sys.argv[1]).read())' \
        "$data/scipy/misc/face.dat" >raccoon.ppm
    oiiotool raccoon.ppm --cut 540x540+400+20 --resize 480x480 -o raccoon.jpg
    oiiotool "$data/skimage/data/chelsea.png" --cut 300x300+85+0 --resize 480x480 -o cat.jpg
    cp ../../../examples/cat_raccoon.csv .
    a=cat.jpg morph="cat.jpg.morph?b=raccoon.jpg&features=cat_raccoon.csv"
}
if ! fetch_animals; then
    echo "they cannot be had: the film is one of the computed faces instead"
    a=round.png morph="round.png.morph?b=long.png&features=faces.csv"
fi

# film NAME LAST RECIPE: frames 0 to LAST, and a film of them.
film() {
    echo "$1.0000.jpg to $1.00$2.jpg: $3"
    oiiotool --frames "0-$2" "$3" -o "$1.%04d.jpg"
    if command -v ffmpeg >/dev/null; then
        echo "$1.mp4"
        ffmpeg -loglevel error -y -framerate 24 -i "$1.%04d.jpg" -pix_fmt yuv420p "$1.mp4"
    else
        echo "(no $1.mp4: ffmpeg is not installed)"
    fi
}

# From one picture to another along corresponding lines: a film, frame by frame.
echo "lines.jpg: $morph&output=lines"
oiiotool "$morph&output=lines" -o lines.jpg
film film 48 "$morph&t={FRAME_NUMBER/48}"

# The same picture as a page that is turned; a face that a list of deformations raises from its picture, turned before the
# camera (Oka 1987, section 4.1).
film page 24 "$a.drape?surface=page_turn&direction=-25&radius=0.12&shading=phong&light=0.3,0.4,1&fov=35&camera=0.3,-0.7,2&background=0.1,0.1,0.1&turn={FRAME_NUMBER/24}"
cp ../../../examples/{relief.csv,smile.csv,frown.csv,expressions.json} .
relief="round.png.drape?deform=relief.csv&shading=phong&light=-0.6,0.5,1&ambient=0.35&fov=40&camera=0,0.3,1.9"
film relief 24 "$relief&rotate=0,{-55+110*FRAME_NUMBER/24},0"
# Expressions of that face, mixed by weights that key frames give (section 4.2).
film expressions 40 "$relief&blend=smile.csv,frown.csv&weights=0,0&keys=expressions.json&frame={FRAME_NUMBER}"
echo "relief.jpg: $relief&rotate=0,-34,0"
oiiotool "$relief&rotate=0,-34,0" -o relief.jpg

# Ellipsoids that walk by a script of NUDES: outlines with hidden lines removed.
cp ../../../examples/figures/walker.nudes .
echo "walker.png, walker.pdf: walker.nudes"
../../release/core/command/anamorph-figure png walker.nudes --frame 24 -o walker.png
../../release/core/command/anamorph-figure pdf walker.nudes --frame all -o walker.pdf

# Speed against error of all operations: one table and one plot each. Of morphs, the long table has four weights a and three b
# of each family of lines, and the plot has the usual ones.
morph_cases=smooth_a1_b2,face_a1_b2,random_a1_b2,crossing_a1_b2,short_a1_b2,outside_a1_b2,paper
pano_cases=equirect,equirect_rotated,fisheye,planet,mercator,full_sphere
case "$tables" in
    long) size=1024 morph_size=600 rounds=15 ;;
    short) size=512 morph_size=300 rounds=3 ;;
    quick) size=128 morph_size=128 rounds=1 ;;
esac

# table OP SIZE MEASURED PLOTTED: both are cases, or nothing for all.
table() {
    local name="speed_vs_error_$1"
    echo "$name.csv, .png, .svg"
    ../../release/tests/bench/speed_vs_error --op "$1" --size "$2" --rounds "$rounds" --case "$3" --csv "$name.csv" >"$name.txt"
    /usr/bin/python3 ../../../examples/plot_speed_vs_error.py --cases "$4" "$name.csv" "$name.png" "$name.svg"
}
echo "tables and plots of speed against error, pictures $size pixels wide, rounds: $rounds"
if [ "$tables" = short ]; then
    table pano "$size" "$pano_cases" ""
    table morph "$morph_size" "$morph_cases" ""
else
    table pano "$size" "" ""
    table morph "$morph_size" "" "$morph_cases"
fi
table warp "$size" "" ""
table drape "$size" "" ""

/usr/bin/python3 ../../../examples/contact_sheet.py contact_sheet.png panorama.png rectilinear.png rolled.png fisheye.png \
    little_planet.png cylindrical.png mercator.png cube_faces.png error.png round.png warp.jpg \
    warp_error.png "$a" lines.jpg film.0024.jpg page.0012.jpg relief.jpg expressions.0010.jpg walker.png
echo "done: $out"
