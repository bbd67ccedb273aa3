#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Shows what Anamorph does, on Debian 12 from a fresh machine on: builds the plugin and the programs, draws each kind of picture once, and ends with
# a page of them. Everything it makes is in build/demo/out.
set -euo pipefail
cd "$(dirname "$0")/.."
usage="usage: examples/demo.sh [--quick | --long]

Builds Anamorph, and draws pictures and films and a page of them, index.html, into build/demo/out. The packages of Debian that are missing are
installed (as root or with sudo), and it says which.

  --long   also builds the Python module and measures speed against error beside other programs; some minutes more
  --quick  short films of small frames, for tests
  --help   prints this"
kind=usual
case "${1:-}" in
    "") ;;
    --quick | --long) kind="${1#--}" ;;
    --help | -h) echo "$usage"; exit 0 ;;
    *) echo "demo.sh: $1: must be --quick, --long or --help" >&2; exit 1 ;;
esac
if [ $# -gt 1 ]; then
    echo "demo.sh: $2: one option at most" >&2
    exit 1
fi
tests/install_packages.sh build hosts

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

targets=(anamorph.imageio anamorph_program anamorph_pictures anamorph_figure example_scene)
[ "$kind" != long ] || targets+=(anamorph_python)
build() {
    # What is built already stays as it is; what is measured is built as it is meant to be.
    if [ "$kind" = long ]; then
        grep -qs "^ANAMORPH_NATIVE:BOOL=OFF" build/release/CMakeCache.txt || cmake --preset release -DANAMORPH_TESTS=OFF || return
    elif [ ! -e build/release/CMakeCache.txt ]; then
        cmake --preset demo || return
    fi
    NINJA_STATUS="[%f/%t] " cmake --build --preset release --target "${targets[@]}"
}

echo "building into build/release (the first time this takes about 5 minutes on 2 cores)"
build 2>&1 | tee "$demo/build.txt" | show_progress || { cat "$demo/build.txt" >&2; exit 1; }
export OIIO_LIBRARY_PATH="$PWD/build/release/plugins/imageio" PATH="$PWD/build/release/core/command:$PWD/build/release/examples/cpp:$PATH"

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
lines="$demo/lines.txt" # of the page: names, tabs, commands
: >"$lines"
shown=0 all=22
# show NAME COMMAND...: runs a command that makes a picture, and says how far the demo is.
show() {
    local name="$1" text="" word
    shift
    for word in "$@"; do
        [[ "$word" =~ ^[A-Za-z0-9_./:=+-]+$ ]] || word="${word@Q}"
        text+="$word "
    done
    shown=$((shown + 1))
    printf '(%d of %d, %d s) %s\n' "$shown" "$all" "$SECONDS" "$name"
    "$@"
    printf '%s\t%s\n' "$name" "$text" >>"$lines"
}
# Highlights compressed into what a screen shows, then as screens want it.
tone_map=(--ch R,G,B --rangecompress --colorconvert linear sRGB -d uint8)

# Out of the panorama, by the stock oiiotool.
view() {
    show "$1.png" oiiotool "panorama.exr.$2" "${tone_map[@]}" -o "$1.png"
}
view rectilinear "pano?to=rectilinear&fov=100&yaw=160&pitch=5&size=480x360"
view fisheye "pano?to=fisheye&fov=180&pitch=-20&yaw=140&size=480x480"
view little_planet "pano?to=stereographic&fov=240&pitch=-90&size=480x480"
view mercator "pano?to=mercator&fov=360&size=480x400"
view cube_faces "pano?to=cubecross&size=640x480"
# From another place than the panorama was taken at, as if all were 4 radii away; a bump unit of 2003, with its number formats.
view from_elsewhere "mosaic?from=equirectangular&to=rectilinear&fov=100&x=0.4&z=0.3&depth=4&yaw=160&size=480x360"
view hardware_2003 "pano?to=rectilinear&fov=100&yaw=160&size=480x360&scheme=hardware&machine=embm-2003"

# Thrown onto walls, a floor, pillars and a block from where it was taken, with their shadows, as a camera sees them from elsewhere.
oiiotool panorama.exr "${tone_map[@]}" -o panorama.ppm
show scene.png sh -c "example_scene panorama.ppm scene.ppm && oiiotool scene.ppm -o scene.png"

# The same panorama from a recipe on disk, which every program that reads files by OpenImageIO can open; as an OpenEXR cube map.
printf '%s\n' '# six faces as a vertical strip' 'src=panorama.exr' 'to=cubemap' 'size=256' >cube.pano
show cube.exr anamorph draw cube.pano -o cube.exr

# How far every source point used is from the exact one, in source pixels: brightest where it is furthest.
show error.png oiiotool "panorama.exr.pano?to=rectilinear&fov=100&yaw=160&pitch=5&size=480x360&output=error" \
    --divc "{TOP.MAXCOLOR}" --colormap inferno -d uint8 -o error.png

# A photo bent by a lens, and made straight again.
/usr/bin/python3 ../../../examples/make_faces.py round.png long.png faces.csv
/usr/bin/python3 ../../../examples/make_cube.py label_ .png # for the pages of docs/
cp -r ../../../examples/{bulge.json,maps,relief.csv,smile.csv,frown.csv,expressions.json,figures/walker.nudes} .
show bent.png anamorph draw "rectilinear.png.lens?lens=brown:k1=-0.15&fov=100&mode=distort" -o bent.png
show straight.png anamorph draw "bent.png.lens?lens=brown:k1=-0.15&fov=100" -o straight.png

# Through a control mesh, and along a formula.
show warp.jpg anamorph draw "round.png.warp?mesh=bulge.json" -o warp.jpg
show swirl.jpg anamorph draw "round.png.map?let=w=3*exp(-4*r^2)&u=width/2+height/2*r*cos(a+w)&v=height/2-height/2*r*sin(a+w)" -o swirl.jpg

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

# Films: frames, each as numbered pictures, and, where ffmpeg is installed, a film of them.
frames=48 last=24
[ "$kind" != quick ] || frames=4 last=2
# film NAME LAST RECIPE: frames 0 to LAST.
film() {
    show "$1.0000.jpg" anamorph draw "$3" --frames "0-$2" -o "$1.{frame}.jpg"
    if command -v ffmpeg >/dev/null; then
        ffmpeg -loglevel error -y -framerate 24 -i "$1.%04d.jpg" -pix_fmt yuv420p "$1.mp4"
    fi
}
# From one picture to another along corresponding lines.
show lines.jpg anamorph draw "$morph&output=lines" -o lines.jpg
film film "$frames" "$morph&frames=$((frames + 1))"
show half.jpg anamorph draw "$morph&t=0.5" -o half.jpg

# A page that is turned; a face that a list of deformations raises from its picture (Oka 1987, section 4.1), and expressions of it, mixed by weights
# that key frames give (section 4.2).
printf '{"keys": {"turn": [[0, 0], [%d, 1]]}}\n' "$last" >turn.json
film page "$last" "$a.drape?surface=page_turn&direction=-25&radius=0.12&shading=phong&light=0.3,0.4,1&fov=35&camera=0.3,-0.7,2&background=0.1,0.1,0.1&keys=turn.json"
relief="round.png.drape?deform=relief.csv&shading=phong&light=-0.6,0.5,1&ambient=0.35&fov=40&camera=0,0.3,1.9"
show relief.jpg anamorph draw "$relief&rotate=0,-34,0" -o relief.jpg
film expressions "$last" "$relief&blend=smile.csv,frown.csv&weights=0,0&keys=expressions.json"

# Ellipsoids that walk by a script of NUDES: outlines with hidden lines removed, and as wood, shaded.
show walker.png anamorph figure png walker.nudes --frame 24 --fit -o walker.png
show wooden.png anamorph draw "walker.nudes?frame=24&fit=1&solid=wood&lighting=blinn&size=480x480" -o wooden.png

if [ "$kind" = long ]; then
    echo "measuring speed against error, beside what Python has"
    anamorph bench -o bench
fi
echo "measuring, for the page's plot"
/usr/bin/python3 ../../../examples/demo_page.py "$(command -v anamorph)" "$lines" .
echo "done, $SECONDS s: $out/index.html"
