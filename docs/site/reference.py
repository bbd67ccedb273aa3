#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the reference of all operations, their words and those of the figure language, with pictures: reference.py SOURCES BUILD FOLDER

From what `anamorph help` and `anamorph figure language` say of themselves: FOLDER/reference.md, and the pictures that it shows in FOLDER/words.
"""
import html
import os
import pathlib
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import draw
import make_site

SIDE = 160
# A picture of each operation.
OPERATIONS = {
    "pano": "panorama.exr.pano?to=stereographic&fov=240&pitch=-90", "mosaic": "panorama.exr.mosaic?from=equirectangular&x=0.4&z=0.3&depth=4&fov=100&yaw=160",
    "lens": "label_px.png.lens?lens=brown:k1=-0.1&fov=90", "map": "round.png.map?u=x+16*sin(y/40)&v=y+16*sin(x/40)", "warp": "round.png.warp?mesh=bulge.json",
    "morph": "round.png.morph?b=long.png&features=faces.csv", "drape": "round.png.drape?surface=page_turn&turn=0.6&direction=-20&camera=0.4,-0.9,1.6&shading=phong",
    "figure": "walker.nudes.figure?frame=24&fit=1",
}
# Keys whose words have pictures: the operation, the key, and a recipe that any of them goes into.
WORDS = [
    ("Projections", "pano", "to", "panorama.exr.pano?to={}&yaw=160"),
    ("Filters", "pano", "filter", "label_px.png.pano?from=rectilinear&srcfov=90&fov=8&yaw=4&pitch=2&filter={}"),
    ("Filters of drapes", "drape", "filter", "label_px.png.drape?surface=cylinder&filter={}&camera=0,0,1.6"),
    ("What is beyond a picture's edge", "map", "wrap", "round.png.map?u=1.5*x-width/4&v=1.5*y-height/4&wrap={}"),
    ("What a warp can show", "warp", "output", "round.png.warp?mesh=bulge.json&output={}"),
    ("What a morph can show", "morph", "output", "round.png.morph?b=long.png&features=faces.csv&output={}"),
    ("Surfaces", "drape", "surface", "round.png.drape?surface={}&shading=phong&light=-0.6,0.5,1&camera=0.6,-0.7,1.4"),
    ("Shading of surfaces", "drape", "shading", "round.png.drape?surface=cylinder&shading={}&light=-1,0.5,1&camera=0.2,0.4,1.5"),
    ("What a drape can show", "drape", "output", "round.png.drape?surface=torus&output={}&camera=0.3,0.8,1.6"),
    ("Styles of figures", "figure", "style", "walker.nudes.figure?frame=24&fit=1&background=255,255,255&style={}"),
    ("Lighting of figures", "figure", "lighting", "walker.nudes.figure?frame=24&fit=1&lighting={}"),
    ("Solid textures of figures", "figure", "solid", "walker.nudes.figure?frame=24&fit=1&solid={}"),
    ("How a texture lies on a body", "figure", "mapping", "clad.nudes.figure?frame=1&zoom=2&style=textured&mapping={}"),
    ("Filters of textures on bodies", "figure", "filter", "clad.nudes.figure?frame=1&zoom=2&style=textured&filter={}"),
    ("Outlines of figures", "figure", "outlines", "walker.nudes.figure?frame=24&fit=1&style=outline&background=255,255,255&outlines={}"),
]
# What a word needs beside it.
NEEDS = {
    ("to", "formula"): "&ray_x=px*(1+0.3*py)", ("surface", "formula"): "&pz=0.3*sin(6*u)*v", ("solid", "formula"): "&red=0.5+0.5*sin(y/4)&green=own_green&blue=own_blue",
    ("surface", "positions"): "&positions=positions.exr", ("to", "cubemap3x2"): "&size=144", ("to", "eac"): "&size=144", ("to", "cubecross"): "&size=144",
    ("to", "cubemap"): "&size=48", ("output", "folds"): "&amount=3",
}
# A body with a texture.
CLAD = """figure ball 1 body
ellipsoid body 240 180 240
repeat 0 1 moveto ball body 500 500 500
repeat 0 1 texture body label_px.png 0 0
stop
"""
LENSES = {"ptlens": "a=0.02,b=-0.08,c=0", "brown": "k1=-0.1", "3de4": "k1=0.08", "kb4": "k1=0.1,k2=0.02", "division": "k1=-0.2", "poly": "k0=1,k1=0.2",
          "ocam": "a0=-134.6,a2=1.9e-3,a3=-8.4e-7,a4=7.6e-9,affine_c=1.0004,affine_d=2e-4"}
MACHINES = {
    "oka-1987": "round.png.drape?surface=waves&scheme=hardware&machine=oka-1987:block=16,fraction_bits=3",
    "embm-2003": "panorama.exr.pano?fov=100&yaw=160&scheme=hardware&machine=embm-2003:size=8,texel=V8U8",
    "ps20": "round.png.warp?mesh=bulge.json&scheme=hardware&machine=ps20:table_size=16",
    "kim-2003": "round.png.warp?mesh=bulge.json&scheme=hardware&machine=kim-2003",
}


def escaped(text):
    return html.escape(text).replace("|", "&#124;")


def keys_of(text):
    """[(name, what it may be, its default, what it means)] of a page of `anamorph help OPERATION`."""
    keys = []
    for line in text.split("[their defaults]:")[1].split("\n"):
        if re.match(r"  \w+: ", line):
            keys.append([line.strip(), ""])
        elif line.startswith("      ") or line.startswith("  ") and keys and not keys[-1][1]:
            keys[-1][1 if line.startswith("      ") else 0] += " " + line.strip()
    rows = []
    for head, meaning in keys:
        name, accepted, default = re.fullmatch(r"(\w+): (.*?)(?: \[(.*)\])?", head).groups()
        rows.append((name, accepted, default or "", meaning.strip()))
    return rows


class Reference:
    def __init__(self, sources, build, folder):
        self.variables, self.folder, self.work = draw.environment(sources, build), folder, folder / "reference"
        for part in (self.work, folder / "words"):
            shutil.rmtree(part, ignore_errors=True)
        (folder / "words").mkdir(parents=True)
        draw.make_sources(sources, build, self.work)
        self.run("oiiotool", "round.png.map?u=x&v=y&output=stmap", "--ch", "0,1,=0.1", "--subc", "0.5,0.5,0", "--mulc", "1,-1,1", "-o", "positions.exr")
        (self.work / "clad.nudes").write_text(CLAD, encoding="utf-8")
        self.operations = dict(re.findall(r"^  (\w+) +(.+)$", self.run("anamorph", "help"), re.M))
        self.keys = {name: keys_of(self.run("anamorph", "help", name)) for name in self.operations}
        self.threads, self.pending = ThreadPoolExecutor(max_workers=len(os.sched_getaffinity(0))), []

    def run(self, *command):
        done = subprocess.run(command, cwd=self.work, env=self.variables, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stderr or done.stdout}")
        return done.stdout

    def figure(self, name, make, *arguments, caption):
        """How the page shows a picture that make(file, *arguments) draws while the page is written."""
        file = re.sub(r"[^A-Za-z0-9_.-]", "_", name) + ".png"
        self.pending.append(self.threads.submit(make, self.folder / "words" / file, *arguments))
        return make_site.figure(f"../words/{file}", caption)

    @staticmethod
    def small(operation, recipe):
        """A recipe with the size of the page's pictures, but of a formula, which counts pixels of its own size."""
        return recipe if operation == "map" or "size=" in recipe else f"{recipe}&size={SIDE}"

    def draw(self, shown, recipe):
        """A recipe's picture: colours as they are, of light compressed, numbers from the least, black, to the greatest, white."""
        pixels = self.work / (shown.stem + ".exr")
        self.run("oiiotool", recipe, "-d", "float", "-o", str(pixels))
        channels = int(re.search(r", (\d+) channel", self.run("oiiotool", "--info", str(pixels)))[1])
        pick = ["--ch", "0,1,2" if channels >= 3 else "0,1,=0" if channels == 2 else "0,0,0"]
        tone = ["--rangecompress", "--colorconvert", "linear", "sRGB"] if recipe.startswith("panorama") else []
        if re.search(r"(output|style)=(?!color|lines|mesh|shaded|outline|stick|textured)", recipe):
            tone = ["--contrast:black={TOP.MINCOLOR}:white={TOP.MAXCOLOR}"]
        self.run("oiiotool", str(pixels), *pick, *tone, "--resize", f"{SIDE}x0", "--attrib", "oiio:ColorSpace", "sRGB", "-d", "uint8", "-o", str(shown))

    def perform(self, shown, word, script):
        """The first frame of a script, and its last."""
        name = f"action_{word}"
        (self.work / f"{name}.nudes").write_text(script, encoding="utf-8")
        self.run("anamorph", "draw", f"{name}.nudes?style=outline&zoom=2&size={SIDE}&background=255,255,255", "--frames", "all", "-o", f"{name}.{{frame}}.png")
        frames = sorted(self.work.glob(f"{name}.*.png"))
        self.run("oiiotool", str(frames[0]), "--ch", "0,1,2", str(frames[-1]), "--ch", "0,1,2", "--mosaic:pad=4", "2x1", "-o", str(shown))

    def words(self, title, operation, key, recipe):
        """Every word of a key, with its picture."""
        accepted = next(row[1] for row in self.keys[operation] if row[0] == key)
        lines = [f"## {title}", "", f"`{key}` of [.{operation}](#{operation}):", ""]
        for word in accepted.split(", "):
            filled = self.small(operation, recipe.format(word) + NEEDS.get((key, word), ""))
            lines.append(self.figure(f"{operation}_{key}_{word}", self.draw, filled, caption=f"<code>{word}</code>"))
        return lines + [""]

    def named(self, title, text, entries):
        lines = [f"## {title}", "", text, ""]
        for name, recipe in entries:
            lines.append(self.figure(f"{title}_{name}", self.draw, f"{recipe}&size={SIDE}", caption=f"<b>{name}</b><br><code>{escaped(recipe)}</code>"))
        return lines + [""]

    def operation(self, name):
        lines = [f"## {name}", "", self.operations[name] + f" ([more]({name}.md)).", "",
                 self.figure(f"operation_{name}", self.draw, self.small(name, OPERATIONS[name]), caption=f"<code>{escaped(OPERATIONS[name])}</code>"), "",
                 "| key | may be | default | meaning |", "|---|---|---|---|"]
        return lines + [f"| `{key}` | {escaped(accepted)} | {escaped(default)} | {escaped(meaning)} |" for key, accepted, default, meaning in self.keys[name]] + [""]

    def actions(self):
        lines = ["## The language of figures", "", "Words of NUDES ([how one writes scripts](figures.md)): the first frame of an example and its last. "
                 "`anamorph figure language WORD` prints the example.", ""]
        for word in re.findall(r"^(\w+) {2,}", self.run("anamorph", "figure", "language"), re.M):
            usage, meaning, script = re.fullmatch(r"(.*?)\n\n *(.*?)\n\nFor example:\n\n(.*)", self.run("anamorph", "figure", "language", word), re.S).groups()
            lines.append(self.figure(f"action_{word}", self.perform, word, script, caption=f"<code>{escaped(usage)}</code><br>{escaped(meaning)}"))
        return lines + [""]

    def write(self):
        lens = next(row[3] for row in self.keys["lens"] if row[0] == "lens")
        models = re.findall(r"(\w+) \(", lens.split("; or")[0])
        lines = ["[Anamorph](../README.md)", "", "# Reference", "", "Every operation, its keys, and the words that they take, as `anamorph help` has them.", ""]
        for name in self.operations:
            lines += self.operation(name)
        for row in WORDS:
            lines += self.words(*row)
        lines += self.named("Lenses", "`lens` of [.lens](#lens).", [(model, f"label_px.png.lens?lens={model}:{LENSES[model]}&fov=90") for model in models])
        lines += self.named("Machines", "`machine`, with `scheme=hardware` ([machines](machines.md)).", MACHINES.items())
        lines += self.actions()
        for drawn in self.pending:
            drawn.result()
        (self.folder / "reference.md").write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    Reference(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:])).write()
