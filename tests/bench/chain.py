#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A chain of three recipes, a lens taken off, a flat view turned, a mesh of 12 x 12 cells, beside each of them alone and beside the same chain
drawn picture by picture.

Each is opened and read once in a process of its own, planning and the source's decoding included; processor and wall time, the
least of the rounds, and by how much each is dearer than the dearest of the three alone. What is lost on the way is measured on waves of
five pixels, drawn through a chain of maps that undo each other.

Needs python3-openimageio and the plugin (OIIO_LIBRARY_PATH)."""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np
import OpenImageIO as oiio

READ = """
import sys, time
import OpenImageIO as oiio
wall, cpu = time.time(), time.process_time()
image = oiio.ImageInput.open(sys.argv[1])
if not image or image.read_image("half") is None:
    sys.exit(oiio.geterror())
print(time.process_time() - cpu, time.time() - wall, image.spec().getattribute("anamorph:chain"))
"""
MESH = 12


def write(name, pixels, kind):
    image = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind))
    image.set_pixels(image.roi, pixels.astype(np.float32))
    if not image.write(name):
        sys.exit(image.geterror())


def write_sources(side):
    y, x = np.mgrid[0:side, 0:side]
    write("plate.exr", np.stack([.5 + .3 * np.sin(x / 17) * np.cos(y / 23), .5 + .2 * np.sin((x + y) / 31),
                                 .5 + .2 * np.cos(x / 9)], -1), "half")
    write("waves.exr", (.5 + .4 * np.sin(2 * math.pi * (x[:256, :384] + .5) / 5))[..., None], "float")
    random = np.random.default_rng(1)
    vertices = np.stack(np.meshgrid(*[np.linspace(0, 1, MESH + 1)] * 2), -1)
    vertices[1:-1, 1:-1] += random.uniform(-.01, .01, (MESH - 1, MESH - 1, 2))
    with open("grid.json", "w", encoding="utf-8") as file:
        json.dump({"columns": MESH, "rows": MESH, "units": "fractions", "vertices": vertices.reshape(-1, 2).tolist()}, file)


def amplitude(name):
    pixels = oiio.ImageBuf(name).get_pixels(oiio.FLOAT)[64:192, 60:320, 0]
    at = np.exp(-2j * math.pi * (np.arange(60, 320) + .5) / 5)
    return 2 * abs((pixels * at).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--side", type=int, default=2048)
    options = parser.parse_args()

    def chain(lens, keys=""):
        pano = f"v.pano?from=rectilinear&srcfov=84&fov=76&yaw=6&pitch=3&size={options.side}x{options.side}{keys}&src="
        warp = f"v.warp?mesh=grid.json{keys}&src="
        return {"lens": lens, "pano": pano + "plate.exr", "warp": warp + "plate.exr", "all three": f"{warp}({pano}({lens}))"}

    lens = "plate.exr.lens?lens=brown:k1=-0.1,k2=0.02&fov=84"
    names = chain(lens)
    names["one by one"] = chain(lens, "&concatenate=0")["all three"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        write_sources(options.side)
        least = {}
        for _ in range(options.rounds):
            for what, name in names.items():
                cpu, wall, joined = subprocess.run([sys.executable, "-c", READ, name], check=True, capture_output=True,
                                                   text=True).stdout.split(maxsplit=2)
                old = least.get(what, (math.inf, math.inf))
                least[what] = (min(old[0], float(cpu)), min(old[1], float(wall)), joined.strip())
        dearest = [max(least[what][i] for what in ("lens", "pano", "warp")) for i in (0, 1)]
        print(f"{options.side} x {options.side}, half; ms of processor and wall, and times the dearest alone")
        for what, (cpu, wall, joined) in least.items():
            print(f"{what:10} {1000 * cpu:6.0f} {1000 * wall:6.0f}  {cpu / dearest[0]:5.2f} {wall / dearest[1]:5.2f}  {joined}")
        turn = "from=rectilinear&to=rectilinear&srcfov=84&fov=84&size=384x256"
        distortion = "brown:k1=-0.1,k2=0.02"
        for keys in ("", "&concatenate=0"):
            name = (f"c.pano?{turn}&srcpitch=0.4&lens={distortion}{keys}&src=(b.pano?{turn}&pitch=0.4{keys}"
                    f"&src=(waves.exr.lens?lens={distortion}&fov=84{keys}))")
            print(f"waves of five pixels, there and back{keys}: {100 * amplitude(name) / .4:.1f}% of them are left")


if __name__ == "__main__":
    main()
