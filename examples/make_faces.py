#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Computes two faces, 480 x 480, and the lines that correspond to each other in them.

Usage: make_faces.py ROUND.png LONG.png FACES.csv
"""
import sys

import numpy as np
import OpenImageIO as oiio
from whole_file import whole_file

SIZE = 480
Y, X = np.mgrid[0:SIZE, 0:SIZE] + 0.5

# Centres and half axes in pixels; colours in linear light.
ROUND = dict(
    ground=(0.10, 0.22, 0.30), skin=(0.75, 0.42, 0.26), hair=(0.05, 0.03, 0.02), iris=(0.05, 0.12, 0.25), lip=(0.45, 0.08, 0.07),
    head=(240, 262, 150, 158), fringe=(240, 138, 148, 46), eyes=(178, 302, 236), eye=(27, 17), brow=(40, -34), nose=(240, 288, 20, 34),
    mouth=(240, 348, 56, 16))
LONG = dict(
    ground=(0.30, 0.22, 0.10), skin=(0.50, 0.32, 0.22), hair=(0.42, 0.20, 0.05), iris=(0.03, 0.15, 0.06), lip=(0.35, 0.12, 0.10),
    head=(250, 250, 108, 196), fringe=(250, 86, 118, 60), eyes=(208, 292, 206), eye=(20, 13), brow=(30, -28), nose=(250, 284, 15, 56),
    mouth=(250, 370, 36, 10))


def inside(x, y, a, b, soft=1.5):
    """1 within an ellipse, 0 outside, over an edge of some pixels; and its normal's (x, y, z)."""
    u, v = (X - x) / a, (Y - y) / b
    r = np.hypot(u, v)
    z = np.sqrt(np.clip(1 - r * r, 0, 1))
    return np.clip((1 - r) * min(a, b) / soft + 0.5, 0, 1)[..., None], (u, v, z)


def paint(picture, colour, x, y, a, b, light=0.0):
    """Lays an ellipse of one colour over a picture; `light` of it is shading by a lamp from above on the left."""
    mask, (u, v, z) = inside(x, y, a, b)
    shade = (1 - light) + light * np.clip(-0.4 * u - 0.5 * v + 0.77 * z, 0, 1)[..., None]
    picture += mask * (np.array(colour) * shade - picture)


def face(f):
    picture = np.array(f["ground"]) * (1.15 - 0.4 * (Y / SIZE))[..., None]
    x, y, a, b = f["head"]
    paint(picture, f["hair"], x, y - 28, a + 20, b + 12, 0.5)
    paint(picture, f["skin"], x, y, a, b, 0.7)
    paint(picture, f["hair"], *f["fringe"], 0.5)
    left, right, level = f["eyes"]
    width, height = f["eye"]
    brow_half, brow_up = f["brow"]
    for eye in (left, right):
        paint(picture, f["hair"], eye, level + brow_up, brow_half, 6, 0.3)
        paint(picture, (0.85, 0.85, 0.82), eye, level, width, height, 0.3)
        paint(picture, f["iris"], eye, level, height * 0.8, height * 0.8)
        paint(picture, (0.01, 0.01, 0.01), eye, level, height * 0.4, height * 0.4)
        paint(picture, (1, 1, 1), eye - height * 0.25, level - height * 0.3, 3, 3)
    x, y, a, b = f["nose"]
    paint(picture, np.array(f["skin"]) * 1.08, x, y, a, b, 0.75)
    x, y, a, b = f["mouth"]
    paint(picture, f["lip"], x, y, a, b, 0.5)
    paint(picture, np.array(f["lip"]) * 0.25, x, y, a * 0.92, 3)
    return picture


def lines(f):
    """Feature lines (x0, y0, x1, y1), the same ones in the same order for every face."""
    x, y, a, b = f["head"]
    left, right, level = f["eyes"]
    width, height = f["eye"]
    brow_half, brow_up = f["brow"]
    rim = [(x + a * np.sin(t), y - b * np.cos(t)) for t in np.linspace(0, 2 * np.pi, 9)]
    found = [(*p, *q) for p, q in zip(rim, rim[1:])]
    for eye in (left, right):
        found += [(eye - width, level, eye + width, level), (eye, level - height, eye, level + height),
                  (eye - brow_half, level + brow_up, eye + brow_half, level + brow_up)]
    x, y, a, b = f["nose"]
    found += [(x, y - b, x, y + b), (x - a, y + b / 2, x + a, y + b / 2)]
    x, y, a, b = f["mouth"]
    found += [(x - a, y, x + a, y), (x, y - b, x, y + b)]
    x, y, a, b = f["fringe"]
    found += [(x - a * 0.8, y + b * 0.6, x, y + b), (x, y + b, x + a * 0.8, y + b * 0.6)]
    return found


def write(name, picture):
    buf = oiio.ImageBuf(oiio.ImageSpec(SIZE, SIZE, 3, oiio.FLOAT))
    buf.set_pixels(oiio.ROI(), np.ascontiguousarray(picture, np.float32))
    buf = oiio.ImageBufAlgo.colorconvert(buf, "linear", "sRGB")
    buf.set_write_format(oiio.UINT8)
    with whole_file(name) as beside:
        if not buf.write(beside):
            sys.exit(buf.geterror())


if len(sys.argv) != 4:
    sys.exit(__doc__.strip().splitlines()[-1])
write(sys.argv[1], face(ROUND))
write(sys.argv[2], face(LONG))
with whole_file(sys.argv[3]) as beside, open(beside, "w", encoding="ascii") as table:
    table.write("ax0,ay0,ax1,ay1,bx0,by0,bx1,by1\n")
    for a, b in zip(lines(ROUND), lines(LONG)):
        table.write(",".join(f"{v:.1f}" for v in (*a, *b)) + "\n")
