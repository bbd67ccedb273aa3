#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the six faces of a cube that say which they are, as seen from inside: an arrow points to each one's upper edge.

Usage: make_cube.py BEFORE AFTER      (label_ .png: label_px.png, label_nx.png and so on, 256 x 256)

The large word is where the face lies; below it are its names in OpenGL, Direct3D, Unity and three.js (px), and in OpenEXR (-x).
"""
import sys

import numpy as np
import OpenImageIO as oiio
from whole_file import whole_file

SIZE = 256
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"  # OpenImageIO 2.5 does not look for its name there
FACES = {"px": ("right", "-x", (0.85, 0.35, 0.30)), "nx": ("left", "+x", (0.35, 0.70, 0.75)),
         "py": ("up", "+y", (0.45, 0.55, 0.90)), "ny": ("down", "-y", (0.60, 0.45, 0.30)),
         "pz": ("front", "+z", (0.40, 0.70, 0.40)), "nz": ("back", "-z", (0.70, 0.45, 0.70))}


def face(word, opengl, openexr, color):
    y, x = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    pixels = np.empty((SIZE, SIZE, 3), np.float32)
    pixels[:] = color
    # Lines of 15 degrees, where the tangents are: great circles, which go on straight across the edges of faces.
    for degrees in (-30, -15, 0, 15, 30):
        at = SIZE / 2 * (1 + np.tan(np.radians(degrees)))
        pixels[(abs(x - at) < 0.8) | (abs(y - at) < 0.8)] *= 1.25
    pixels[np.minimum.reduce([x, y, SIZE - x, SIZE - y]) < 2] = 0.1
    tip, half = 12, SIZE / 2
    arrow = (abs(x - half) < 0.8 * (y - tip)) & (y < tip + 22) | (abs(x - half) < 6) & (y >= tip + 22) & (y < tip + 48)
    pixels[arrow] = 1
    picture = oiio.ImageBuf(oiio.ImageSpec(SIZE, SIZE, 3, "uint8"))
    picture.set_pixels(oiio.ROI(), np.ascontiguousarray(np.minimum(pixels, 1)))
    for text, down, high in ((word, 150, 58), (f"{opengl}   OpenEXR {openexr}", 200, 24)):
        box = oiio.ImageBufAlgo.text_size(text, high, FONT)
        if not box.defined or not oiio.ImageBufAlgo.render_text(picture, (SIZE - box.width) // 2 - box.xbegin, down, text, high, FONT, (1, 1, 1)):
            sys.exit(f"make_cube.py: {picture.geterror()} (Debian package fonts-dejavu-core)")
    return picture


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    for name, (word, openexr, color) in FACES.items():
        with whole_file(sys.argv[1] + name + sys.argv[2]) as file:
            picture = face(word, name, openexr, color)
            if not picture.write(file):
                sys.exit(f"make_cube.py: {picture.geterror()}")


if __name__ == "__main__":
    main()
