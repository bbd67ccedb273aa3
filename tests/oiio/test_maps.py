# SPDX-License-Identifier: Apache-2.0
"""The maps of examples/maps, each against its formula in NumPy's own words: source points hold the tolerance."""
import os
import pathlib
import subprocess
import unittest

import numpy as np
import OpenImageIO as oiio

MAPS = pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"]) / "examples/maps"
SOURCE = (600, 400)
TOL = 0.01  # source pixels, the default
SIZES = ((480, 320), (300, 300), (101, 77))
NIGHT = "ANAMORPH_NIGHTLY" in os.environ


class Places:
    """The pixels of a picture, in the words of Keys of .map."""

    def __init__(self, width, height):
        self.width, self.height = width, height
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        self.s, self.t = x / width, y / height
        half = min(width, height) / 2
        self.right, self.up = (x - width / 2) / half, (height / 2 - y) / half
        self.across, self.down = x - width / 2, y - height / 2
        self.away = np.hypot(self.right, self.up)
        self.turned = np.arctan2(self.up, self.right)


def about_the_middle(right, up):
    """Source pixels of a place about the source's middle, in halves of its smaller side."""
    half = min(SOURCE) / 2
    return SOURCE[0] / 2 + half * right, SOURCE[1] / 2 - half * up


def by_angle(away, turned):
    return about_the_middle(away * np.cos(turned), away * np.sin(turned))


def of_longitude(longitude, latitude, seen):
    """Source pixels of a place on the globe, in radians, in an equirectangular source."""
    u = np.mod(longitude / (2 * np.pi) + 0.5, 1) * SOURCE[0]
    v = (0.5 - latitude / np.pi) * SOURCE[1]
    return np.where(seen, u, np.nan), np.where(seen, v, np.nan)


def swirl(p, turn=2, reach=0.5):
    return by_angle(p.away, p.turned - turn * np.exp(-(p.away / reach) ** 2))


def pinch(p, amount=0.5):
    scale = 1 + amount * np.where(p.away < 1, (1 - p.away**2) ** 2, 0)
    return about_the_middle(p.right * scale, p.up * scale)


def spherize(p):
    return by_angle(np.where(p.away < 1, np.arcsin(np.minimum(p.away, 1)) * 2 / np.pi, p.away), p.turned)


def barrel(p, k1=0.2, k2=0):
    scale = 1 + p.away**2 * (k1 + p.away**2 * k2)
    return about_the_middle(p.right * scale, p.up * scale)


def polar(p):
    clockwise_from_top = np.mod(np.pi / 2 - p.turned, 2 * np.pi)
    return clockwise_from_top / (2 * np.pi) * SOURCE[0], np.where(p.away < 1, p.away, np.nan) * SOURCE[1]


def depolar(p):
    return by_angle(p.t, np.pi / 2 - 2 * np.pi * p.s)


def arc(p, degrees=90, zoom=0.7):
    bend = np.radians(degrees)
    radius = SOURCE[0] / bend
    center = radius * (1 + np.cos(bend / 2)) / 2  # below the middle of the picture, before zooming
    right, up = p.across / zoom, center - p.down / zoom
    return SOURCE[0] / 2 + radius * np.arctan2(right, up), SOURCE[1] / 2 + radius - np.hypot(right, up)


def shear(p, across=0.3, down=0):
    return about_the_middle(p.right - across * p.up, p.up - down * p.right)


def perspective(p, corners=((0.2, 0.1), (0.9, 0.25), (0.8, 0.9), (0.1, 0.75))):
    # The homography of four pairs of points, by its eight linear equations, and its inverse.
    rows, values = [], []
    for (a, b), (x, y) in zip(((0, 0), (1, 0), (1, 1), (0, 1)), corners):
        rows += [[a, b, 1, 0, 0, 0, -a * x, -b * x], [0, 0, 0, a, b, 1, -a * y, -b * y]]
        values += [x, y]
    forwards = np.append(np.linalg.solve(np.array(rows), np.array(values)), 1).reshape(3, 3)
    back = np.linalg.inv(forwards) @ np.stack([p.s, p.t, np.ones_like(p.s)]).reshape(3, -1)
    u, v, w = back.reshape(3, *p.s.shape)
    seen = w > 0
    w = np.where(seen, w, np.nan)
    return u / w * SOURCE[0], v / w * SOURCE[1]


def kaleidoscope(p, sectors=6, turn=0):
    sector = 2 * np.pi / sectors
    inside = np.mod(p.turned, sector)
    return by_angle(p.away, turn + np.maximum(inside - sector / 2, sector / 2 - inside))


def ripple(p, amount=0.02, length=0.2, frame=0):
    return by_angle(p.away + amount * np.sin(2 * np.pi * (p.away / length - frame / 24)), p.turned)


def mollweide(p, lon0=0):
    # On the ellipse of half axes 2 sqrt(2) and sqrt(2).
    x, y = 2 * np.sqrt(2) * (2 * p.s - 1), np.sqrt(2) * (1 - 2 * p.t)
    theta = np.arcsin(y / np.sqrt(2))
    latitude = np.arcsin((2 * theta + np.sin(2 * theta)) / np.pi)
    longitude = np.pi * x / (2 * np.sqrt(2) * np.cos(theta))
    return of_longitude(longitude + np.radians(lon0), latitude, np.abs(longitude) < np.pi)


def albers(p, lat1=29.5, lat2=45.5, lat0=38, lon0=-96, zoom=2):
    lat1, lat2, lat0, lon0 = np.radians([lat1, lat2, lat0, lon0])
    n = (np.sin(lat1) + np.sin(lat2)) / 2
    c = np.cos(lat1) ** 2 + 2 * n * np.sin(lat1)
    rho0 = np.sqrt(c - 2 * n * np.sin(lat0)) / n
    x, y = p.right / zoom, p.up / zoom
    if n < 0:  # the cone stands on its tip
        x, y, rho0 = -x, -y, -rho0
    rho, theta = np.hypot(x, rho0 - y), np.arctan2(x, rho0 - y)
    sine = (c - (rho * n) ** 2) / (2 * n)
    seen = (np.abs(theta / n) < np.pi) & (np.abs(sine) < 1)
    return of_longitude(lon0 + theta / n, np.arcsin(np.clip(sine, -1, 1)), seen)


def solved(function, target, low, high):
    """Where a rising function has a value, by halving."""
    low, high = np.full_like(target, low), np.full_like(target, high)
    for _ in range(60):
        middle = (low + high) / 2
        below = function(middle) < target
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2


# Robinson's own table, every 5 degrees: the length of a parallel, and its distance from the equator.
ROBINSON = np.array([
    (1, 0), (0.9986, 0.062), (0.9954, 0.124), (0.99, 0.186), (0.9822, 0.248), (0.973, 0.31), (0.96, 0.372),
    (0.9427, 0.434), (0.9216, 0.4958), (0.8962, 0.5571), (0.8679, 0.6176), (0.835, 0.6769), (0.7986, 0.7346),
    (0.7597, 0.7903), (0.7186, 0.8435), (0.6732, 0.8936), (0.6213, 0.9394), (0.5722, 0.9761), (0.5322, 1)])


def robinson_parallel(sine_of_place):
    """Length and height of the parallel at so many parts of 90 degrees, by the file's polynomials."""
    even = sine_of_place**2
    length = np.polynomial.polynomial.polyval(
        even, [1, -0.358, 0.312, -4.844, 15.664, -22.921, 15.814, -4.135])
    height = sine_of_place * np.polynomial.polynomial.polyval(even, [1.1123, 0.0762, -0.3584, 0.4001, -0.23])
    return length, height


def robinson(p, lon0=0):
    scale = min(p.width / (2 * np.pi * 0.8487), p.height / (2 * 1.3523))
    place = solved(lambda q: robinson_parallel(q)[1], -p.down / scale / 1.3523, -1.0, 1.0)
    length, height = robinson_parallel(place)
    longitude = p.across / scale / 0.8487 / length
    seen = (np.abs(longitude) < np.pi) & (np.abs(height + p.down / scale / 1.3523) < 1e-9)
    return of_longitude(longitude + np.radians(lon0), place * np.pi / 2, seen)


def winkel_place(longitude, latitude, lat1):
    """Where a place on the globe goes, with the globe's radius 1."""
    arc = np.arccos(np.cos(latitude) * np.cos(longitude / 2))
    over = np.where(arc > 1e-4, arc / np.sin(np.maximum(arc, 1e-4)), 1 + arc**2 / 6)
    return ((longitude * np.cos(lat1) + 2 * np.cos(latitude) * np.sin(longitude / 2) * over) / 2,
            (latitude + np.sin(latitude) * over) / 2)


def winkel_tripel(p, lon0=0, lat1=50.459776):
    lat1 = np.radians(lat1)
    scale = min(p.width / (np.pi * (1 + np.cos(lat1))), p.height / np.pi)
    x, y = p.across / scale, -p.down / scale
    # By Newton's method with differences, over and over, from a sinusoidal guess.
    latitude = np.clip(y, -1.5, 1.5)
    longitude = np.clip(x / (0.3 + 0.5 * np.cos(latitude)), -3.1, 3.1)
    step = 1e-6
    for _ in range(60):
        at = winkel_place(longitude, latitude, lat1)
        east = winkel_place(longitude + step, latitude, lat1)
        north = winkel_place(longitude, latitude + step, lat1)
        a, b = (east[0] - at[0]) / step, (north[0] - at[0]) / step
        c, d = (east[1] - at[1]) / step, (north[1] - at[1]) / step
        right, up = x - at[0], y - at[1]
        longitude = np.clip(longitude + (d * right - b * up) / (a * d - b * c), -3.4, 3.4)
        latitude = np.clip(latitude + (a * up - c * right) / (a * d - b * c), -np.pi / 2, np.pi / 2)
    at = winkel_place(longitude, latitude, lat1)
    seen = (np.hypot(at[0] - x, at[1] - y) < 1e-9) & (np.abs(longitude) < np.pi)
    return of_longitude(longitude + np.radians(lon0), latitude, seen)


def dome(p, fov=40, tilt=8, projector=(0, 0.2, -0.1), mirror=(0, 0.8, -0.15), radius=0.25):
    side = np.tan(np.radians(fov / 2)) * min(p.width, p.height) / p.width
    light = np.stack([side * p.right, np.ones_like(p.right), side * p.up], axis=-1)
    light /= np.linalg.norm(light, axis=-1, keepdims=True)
    up = np.radians(tilt)
    light = light @ np.array([[1, 0, 0], [0, np.cos(up), np.sin(up)], [0, -np.sin(up), np.cos(up)]])

    def meet(start, direction, center, size, far):
        """Where a line of light meets a sphere: the near side, or the far one."""
        away = start - center
        b, c = (away * direction).sum(-1), (away * away).sum(-1) - size**2
        with np.errstate(invalid="ignore"):
            root = np.sqrt(b * b - c)
        return start + (-b + (root if far else -root))[..., None] * direction

    mirror = np.array(mirror)
    at = meet(np.array(projector), light, mirror, radius, False)
    normal = (at - mirror) / radius
    light = light - 2 * (light * normal).sum(-1, keepdims=True) * normal
    seen = meet(at, light, np.zeros(3), 1, True)
    flat = np.hypot(seen[..., 0], seen[..., 1])
    # The angle from the zenith, 90 degrees at the rim.
    away = np.arccos(np.clip(seen[..., 2], -1, 1)) / (np.pi / 2)
    away = np.where(seen[..., 2] > 0, away, np.nan)
    return about_the_middle(away * seen[..., 0] / flat, away * seen[..., 1] / flat)


# Each map with the settings that it is tried with, besides its own.
TRIED = {
    swirl: [{}, {"turn": -1, "reach": 0.8}],
    pinch: [{}, {"amount": -0.5}],
    spherize: [{}],
    barrel: [{}, {"k1": -0.1, "k2": 0.02}],
    polar: [{}],
    depolar: [{}],
    arc: [{}, {"degrees": 180, "zoom": 0.5}],
    shear: [{}, {"across": -0.2, "down": 0.4}],
    perspective: [{}],
    kaleidoscope: [{}, {"sectors": 5, "turn": 1}],
    ripple: [{}, {"frame": 7}],
    mollweide: [{}, {"lon0": 100}],
    albers: [{}, {"zoom": 0.5}, {"lat1": -20, "lat2": -40, "lat0": -30, "lon0": 135}],
    robinson: [{}, {"lon0": 100}],
    winkel_tripel: [{}, {"lon0": -70, "lat1": 30}],
    dome: [{}, {"fov": 30, "tilt": 0}],
}


def source_points(name, size, settings):
    """What the plugin says, in source pixels; NaN where there is none."""
    keys = "".join(f"&{key}={value}" for key, value in settings.items())
    recipe = f"{MAPS}/{name}.map?src=source.tif&size={size[0]}x{size[1]}&output=stmap{keys}"
    buffer = oiio.ImageBuf(recipe)
    pixels = buffer.get_pixels(oiio.FLOAT)
    if buffer.has_error:
        raise AssertionError(f"{recipe}: {buffer.geterror()}")
    u, v = pixels[..., 0].astype(float), pixels[..., 1].astype(float)
    none = (u == -1) & (v == -1)
    return np.where(none, np.nan, u * SOURCE[0]), np.where(none, np.nan, v * SOURCE[1])


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        subprocess.run(["oiiotool", "--create", f"{SOURCE[0]}x{SOURCE[1]}", "3", "-o", "source.tif"], check=True)

    def test_every_map_is_tried(self):
        self.assertEqual({path.stem for path in MAPS.glob("*.map")}, {function.__name__ for function in TRIED})

    def test_source_points(self):
        for function, tries in TRIED.items():
            for settings in tries:
                for size in SIZES if NIGHT or not settings else SIZES[:1]:
                    with self.subTest(map=function.__name__, **settings, size=size):
                        with np.errstate(invalid="ignore", divide="ignore"):
                            self.compare(function, size, settings)

    def test_robinson_keeps_to_his_table(self):
        length, height = robinson_parallel(np.arange(19) / 18)
        self.assertLess(np.abs(length - ROBINSON[:, 0]).max(), 0.001)
        self.assertLess(np.abs(height - ROBINSON[:, 1]).max(), 0.001)

    def compare(self, function, size, settings):
        wanted = function(Places(*size), **settings)
        u, v = source_points(function.__name__, size, settings)
        there = np.isfinite(wanted[0]) & np.isfinite(wanted[1])
        differing = np.isnan(u) == there
        # This file's own rounding decides at the rim of what is seen.
        self.assertLessEqual(differing.sum(), 2, "points are there or not")
        both = there & ~np.isnan(u)
        self.assertGreater(both.sum(), 0.1 * both.size)
        across = np.abs(u - wanted[0])[both]
        # A seam is at both edges of a source that goes around.
        across = np.minimum(across, np.abs(across - SOURCE[0]))
        # An ST-map's numbers are floats.
        hair = 1e-4 * max(1, np.abs(u[both]).max() / 1000, np.abs(v[both]).max() / 1000)
        self.assertLessEqual(across.max(), TOL + hair)
        self.assertLessEqual(np.abs(v - wanted[1])[both].max(), TOL + hair)


if __name__ == "__main__":
    unittest.main()
