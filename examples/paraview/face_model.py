# SPDX-License-Identifier: Apache-2.0
"""A face as a picture and as deformations of it: what Figures 4.4 to 4.6 of Oka 1987 are made of, in our own pictures.

A deformation is a row c_u, c_v, a_u, a_v, V_x, V_y, V_z, kernel, enabled. The face lies in the unit square around the
origin, y up.
"""
import numpy as np


def bump(u, v, extent_u, extent_v, *vector):
    """One deformation; a vector of one number rises from the plane."""
    x, y, z = vector if len(vector) == 3 else (0, 0, *vector)
    return [(u, v, extent_u, extent_v, x, y, z, 0, 1)]


def pair(u, v, extent_u, extent_v, *vector):
    """The same on the left and on the right."""
    x, y, z = vector if len(vector) == 3 else (0, 0, *vector)
    return bump(u, v, extent_u, extent_v, x, y, z) + bump(-u, v, extent_u, extent_v, -x, y, z)


# 50 deformations that raise a face, by part.
PARTS = {
    "head": bump(0, 0, 0.30, 0.42, 0.22),
    "forehead": pair(0.10, 0.22, 0.12, 0.10, 0.04) + bump(0, 0.26, 0.14, 0.10, 0.03),
    "brows": pair(0.12, 0.135, 0.09, 0.03, 0.03) + pair(0.20, 0.12, 0.05, 0.03, 0.015) + bump(0, 0.12, 0.04, 0.04, 0.02),
    "eyes": pair(0.125, 0.07, 0.06, 0.04, -0.045) + pair(0.06, 0.07, 0.03, 0.03, -0.03)
            + pair(0.125, 0.072, 0.04, 0.028, 0.028) + pair(0.125, 0.098, 0.05, 0.012, 0.010)
            + pair(0.125, 0.045, 0.05, 0.012, 0.006),
    "nose": bump(0, 0.07, 0.028, 0.06, 0.04) + bump(0, 0.01, 0.03, 0.05, 0.05) + bump(0, -0.04, 0.032, 0.04, 0.05)
            + bump(0, -0.075, 0.03, 0.03, 0.05) + pair(0.04, -0.085, 0.022, 0.022, 0.028)
            + pair(0.02, -0.108, 0.012, 0.010, -0.02) + pair(0.065, -0.06, 0.02, 0.04, -0.012),
    "cheeks": pair(0.20, 0.0, 0.08, 0.06, 0.035) + pair(0.15, -0.12, 0.08, 0.09, 0.03)
              + pair(0.24, -0.12, 0.06, 0.08, -0.02),
    "lips": bump(0, -0.14, 0.014, 0.03, -0.01) + pair(0.016, -0.14, 0.010, 0.03, 0.006)
            + pair(0.025, -0.175, 0.03, 0.014, 0.022) + bump(0, -0.195, 0.075, 0.008, -0.02)
            + bump(0, -0.212, 0.05, 0.016, 0.026) + pair(0.085, -0.192, 0.018, 0.018, -0.015),
    "chin": bump(0, -0.245, 0.05, 0.016, -0.02) + bump(0, -0.29, 0.06, 0.05, 0.05),
    "jaw": pair(0.17, -0.27, 0.07, 0.07, 0.02) + pair(0.27, 0.14, 0.05, 0.10, -0.02),
}

# What an expression adds to the face: the texture moves with the points.
EXPRESSIONS = {
    "smile": pair(0.085, -0.192, 0.05, 0.045, 0.018, 0.03, -0.012) + pair(0.16, -0.08, 0.07, 0.06, 0.004, 0.012, 0.02)
             + pair(0.125, 0.045, 0.06, 0.02, 0, 0.008, 0.006),
    "surprise": pair(0.14, 0.16, 0.10, 0.06, 0, 0.035, 0.008) + bump(0, -0.27, 0.16, 0.09, 0, -0.06, -0.015)
                + bump(0, -0.225, 0.07, 0.03, 0, -0.025, -0.01) + pair(0.125, 0.098, 0.05, 0.02, 0, 0.014, 0.004),
    "anger": pair(0.07, 0.14, 0.06, 0.05, -0.015, -0.03, 0.012) + pair(0.20, 0.15, 0.06, 0.05, 0, 0.012, 0)
             + pair(0.085, -0.192, 0.05, 0.04, -0.014, -0.02, 0.004) + bump(0, -0.08, 0.05, 0.04, 0, 0.006, 0.01),
}


def scaled(part, by, extent=1.0):
    """The face with a part's vectors and extents changed."""
    parts = dict(PARTS)
    parts[part] = [(u, v, a * extent, b * extent, x * by, y * by, z * by, kernel, on)
                   for u, v, a, b, x, y, z, kernel, on in PARTS[part]]
    return rows(parts)


def rows(parts=None, added=()):
    return [row for part in (parts or PARTS).values() for row in part] + list(added)


# Nine faces out of one: parts edited, added and moved.
VARIANTS = {
    "as raised": rows(),
    "large nose": scaled("nose", 1.7, 1.15),
    "flat nose": scaled("nose", 0.4, 1.2),
    "full lips": scaled("lips", 2.0, 1.15),
    "deep eyes": scaled("eyes", 1.8),
    "strong chin": scaled("chin", 2.2, 1.2),
    "round cheeks": rows(added=pair(0.19, -0.1, 0.09, 0.10, 0.02, 0, 0.06)),
    "narrow face": rows(added=pair(0.25, -0.05, 0.12, 0.4, -0.06, 0, 0)),
    "high forehead": rows(added=bump(0, 0.30, 0.25, 0.12, 0, 0.06, 0.05)),
}


def flat(list_of_rows):
    """As the plugin's property takes it."""
    return [float(number) for row in list_of_rows for number in row]


def picture(size=256):
    """The face as a picture, RGB in 8 bits, first row at the bottom: what is raised, and what is laid on it."""
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / size - 0.5
    rgb = np.empty((size, size, 3))
    rgb[:] = 0.10, 0.13, 0.18

    def paint(colour, u, v, a, b, soft=0.012, light=0.0):
        r = np.hypot((x - u) / a, (y - v) / b)
        mask = np.clip((1 - r) * min(a, b) / soft + 0.5, 0, 1)[..., None]
        shade = (1 - light) + light * np.sqrt(np.clip(1 - r * r, 0, 1))[..., None]
        rgb[:] += mask * (np.array(colour) * shade - rgb)

    paint((0.25, 0.15, 0.10), 0, 0.05, 0.37, 0.44, light=0.3)
    paint((0.88, 0.66, 0.52), 0, -0.02, 0.31, 0.40, light=0.35)
    for side in (-1, 1):
        paint((0.93, 0.50, 0.45), side * 0.19, -0.10, 0.06, 0.05, soft=0.06)
        paint((0.25, 0.15, 0.10), side * 0.125, 0.135, 0.075, 0.014)
        paint((0.95, 0.94, 0.92), side * 0.125, 0.07, 0.045, 0.022)
        paint((0.15, 0.30, 0.45), side * 0.125, 0.07, 0.019, 0.019)
        paint((0.02, 0.02, 0.02), side * 0.125, 0.07, 0.009, 0.009)
        paint((0.45, 0.25, 0.20), side * 0.02, -0.108, 0.010, 0.008)
    paint((0.95, 0.74, 0.60), 0, -0.03, 0.022, 0.09, soft=0.03)
    paint((0.75, 0.28, 0.27), 0, -0.195, 0.085, 0.032)
    paint((0.40, 0.12, 0.12), 0, -0.195, 0.080, 0.005)
    return np.round(np.clip(rgb, 0, 1) * 255).astype(np.uint8)


def first_of(part):
    """The position in the list of a part's first deformation."""
    names = list(PARTS)
    return sum(len(PARTS[name]) for name in names[:names.index(part)])
