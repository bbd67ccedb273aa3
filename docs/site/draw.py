#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of the documentation: draw.py SOURCES BUILD FOLDER

Runs the lines of the .md files that stock programs draw by the plugin, in their order, in FOLDER/tree, which has the names of the real tree and what
these lines read. What a line says that it makes is kept as FOLDER/pictures/NUMBER-NAME, and, small and as a browser shows it,
in FOLDER/shown; FOLDER/pictures.json lists it: [[file, line where its block begins, the line's text, name in shown], ...]. Of points, distances and
the like, which no screen shows, there is none.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

LENS = "lens=brown:k1=-0.21,k2=0.05&fov=84"
SOURCES = f"""
"$python" "$examples/make_panorama.py" panorama.exr 512
"$python" "$examples/make_faces.py" round.png long.png faces.csv
"$python" "$examples/make_cube.py" label_ .png
cp -r "$examples/maps" .
cp "$examples"/{{bulge.json,relief.csv,smile.csv,frown.csv,swirl.ps,figures/walker.nudes,figures/benzene.cif}} .
oiiotool "panorama.exr.pano?to=rectilinear&size=2048x1556&{LENS}" -o plate.exr
oiiotool "panorama.exr.pano?to=rectilinear&size=600x400&pitch=-3&{LENS}" -o photo.jpg
cp plate.exr taken.exr
oiiotool panorama.exr --cut 300x150+60+40 -o part.exr
oiiotool panorama.exr --resize 256x256 -o square.exr
oiiotool "panorama.exr.pano?to=cylindrical&fov=360&size=256x64" -o slits.exr
oiiotool $(for i in {{1..32}}; do echo slits.exr; done) --mosaic 1x32 -o room.exr
"""
# Of numbered frames the middle one.
KEEP = """
keep() {
    local files=($2)
    [ ! -e "${files[0]}" ] || cp -L -- "${files[${#files[@]} / 2]}" "$1"
}
"""
SHOWN = (".jpg", ".png", ".exr")
SIDE = 400  # of pictures in pages


def environment(sources, build):
    path = [f"{build}/core/command"] + os.environ["PATH"].split(os.pathsep)
    return {**os.environ, "PATH": os.pathsep.join(path), "ANAMORPH_SOURCE_DIR": str(sources), "OIIO_LIBRARY_PATH": f"{build}/plugins/imageio",
            "examples": f"{sources}/examples", "python": "/usr/bin/python3"}


def shell(script, folder, variables):
    subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, env=variables, check=True, stdin=subprocess.DEVNULL)


def make_sources(sources, build, folder):
    """What the lines read, in an empty folder."""
    folder.mkdir(parents=True)
    shell(SOURCES, folder, environment(sources, build))


def show(picture, shown):
    """Writes a picture as one that a browser shows; False where it is none of colours."""
    header = subprocess.run(["oiiotool", "--info", str(picture)], capture_output=True, text=True).stdout
    size = re.search(r": +(\d+) x +(\d+), (\d+) channel", header)
    if not size or int(size[3]) < 3:
        return False
    colour = ["--ch", "R,G,B", "--rangecompress", "--colorconvert", "linear", "sRGB"] if picture.suffix == ".exr" else []
    small = ["--resize", f"{SIDE}x0"] if int(size[1]) > SIDE else []
    subprocess.run(["oiiotool", str(picture), *colour, *small, "-d", "uint8", "-o", str(shown)], check=True)
    return True


def draw(sources, build, folder):
    sys.path.insert(0, str(sources / "tests/docs"))
    os.environ["ANAMORPH_SOURCE_DIR"] = str(sources)
    import blocks

    for part in ("tree", "pictures", "shown"):
        shutil.rmtree(folder / part, ignore_errors=True)
    tree, pictures = folder / "tree", folder / "pictures"
    place = tree / "build/demo/out"
    make_sources(sources, build, place)
    (tree / "build/release").symlink_to(build)
    pictures.mkdir()
    blocks.write_files("oiio", place)

    script, made = [KEEP], []
    for block, line in blocks.runs_of("oiio"):
        if line.startswith("ffmpeg ") and not shutil.which("ffmpeg"):
            continue
        script.append(line)
        for name in blocks.made_by([line]):
            if name.endswith(SHOWN):
                kept = f"{len(made):03}-{re.sub('[^A-Za-z0-9_.]', '', name)}"
                script.append(f"keep {shlex.quote(str(pictures / kept))} {shlex.quote(name)}")
                made.append([block.file, block.line, line, kept])
    script += blocks.lines_of("oiio")[len(blocks.runs_of("oiio")):]
    variables = environment(sources, build)
    del variables["OIIO_LIBRARY_PATH"]  # the lines say it
    shell("\n".join(script), tree, variables)
    (folder / "shown").mkdir()
    made = [[*entry, str(pathlib.Path(kept).with_suffix(".png"))] for *entry, kept in made
            if show(pictures / kept, (folder / "shown" / kept).with_suffix(".png"))]
    (folder / "pictures.json").write_text(json.dumps(made, indent=1), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    draw(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:]))
