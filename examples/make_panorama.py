#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Computes an HDR equirectangular panorama: a tiled floor, a ring of coloured columns, sky and sun.

Usage: make_panorama.py PICTURE.exr [WIDTH]      (default 2048; the height is half the width)

Seen from 1.6 m above the floor. The picture's middle looks along +z; x is right, y is up.
"""
import sys

import numpy as np
import OpenImageIO as oiio
from whole_file import whole_file

EYE_HEIGHT = 1.6  # metres
COLUMNS, RING_RADIUS, COLUMN_RADIUS, COLUMN_HEIGHT = 12, 6.0, 0.5, 5.0  # metres
SUN = np.array([0.5, 0.45, 0.74])
SUPERSAMPLING = 3


def rays(width, height):
    """Unit directions of the pixel centres, (height, width, 3)."""
    yaw = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    pitch = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    cos_pitch = np.cos(pitch)[:, None]
    x, z = cos_pitch * np.sin(yaw), cos_pitch * np.cos(yaw)
    return np.stack([x, np.broadcast_to(np.sin(pitch)[:, None], x.shape), z], axis=-1)


def shade(direction):
    """Linear RGB seen along unit directions, (..., 3)."""
    x, y, z = np.moveaxis(direction, -1, 0)
    to_sun = direction @ (SUN / np.linalg.norm(SUN))

    # Sky: a gradient from the horizon up, and a sun much brighter than white.
    up = np.clip(y, 0, 1)[..., None] ** 0.5
    color = (1 - up) * [0.9, 0.85, 0.8] + up * [0.12, 0.3, 0.75]
    color += np.exp((to_sun - 1) * 400)[..., None] * [2.0, 1.6, 1.0]
    color = np.where((to_sun > np.cos(np.radians(1.5)))[..., None], [900.0, 800.0, 600.0], color)

    # Floor: metre tiles, fading into the haze far out.
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(y < 0, -EYE_HEIGHT / y, np.inf)
        odd = (np.floor(x * distance) + np.floor(z * distance)) % 2 == 1
    floor = np.where(odd[..., None], [0.5, 0.42, 0.33], [0.16, 0.17, 0.2])
    haze = np.exp(-np.minimum(distance, 1e6) / 25)[..., None]
    color = np.where((y < 0)[..., None], haze * floor + (1 - haze) * [0.9, 0.85, 0.8], color)

    # Columns: vertical cylinders, the nearest one hit counts.
    nearest = np.minimum(distance, 1e6)
    for k in range(COLUMNS):
        angle = 2 * np.pi * k / COLUMNS
        cx, cz = RING_RADIUS * np.sin(angle), RING_RADIUS * np.cos(angle)
        a, b = x * x + z * z, x * cx + z * cz
        inside = b * b - a * (RING_RADIUS**2 - COLUMN_RADIUS**2)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (b - np.sqrt(np.maximum(inside, 0))) / a
        hit = (inside > 0) & (t > 0) & (t < nearest) & (EYE_HEIGHT + y * t < COLUMN_HEIGHT)
        normal_x, normal_z = (x * t - cx) / COLUMN_RADIUS, (z * t - cz) / COLUMN_RADIUS
        light = 0.25 + np.clip(normal_x * SUN[0] + normal_z * SUN[2], 0, None)
        hue = 0.5 + 0.4 * np.cos(angle + np.array([0.0, 2.1, 4.2]))
        color = np.where(hit[..., None], light[..., None] * hue, color)
        nearest = np.where(hit, t, nearest)
    return color


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    width = int(sys.argv[2]) if len(sys.argv) == 3 else 2048
    height = width // 2
    n = SUPERSAMPLING
    picture = np.empty((height, width, 3), np.float32)
    directions = rays(width * n, height * n)
    for row in range(height):  # by rows, so that the supersampled picture is never held
        color = shade(directions[row * n:(row + 1) * n])
        picture[row] = color.reshape(n, width, n, 3).mean(axis=(0, 2))

    spec = oiio.ImageSpec(width, height, 3, oiio.FLOAT)
    spec.attribute("oiio:ColorSpace", "Linear")
    output = oiio.ImageOutput.create(sys.argv[1])
    if not output:
        sys.exit(f"{sys.argv[1]}: {oiio.geterror()}")
    with whole_file(sys.argv[1]) as name:
        if not output.open(name, spec) or not output.write_image(picture) or not output.close():
            sys.exit(f"{sys.argv[1]}: {output.geterror()}")


if __name__ == "__main__":
    main()
