# SPDX-License-Identifier: Apache-2.0
"""What of a fine pattern is left: an undistorted, turned and warped plate, drawn by one resampling and by three.

The plate repeats every 5 pixels. NumPy knows its value at every source point, and finds by least squares how large the
wave still is in what was drawn. Its responses are those of the cubics, integrated here.
"""
import json
import math
import unittest

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 320, 240
FREQUENCY = 0.2
SWING = 0.4


def read(name):
    image = oiio.ImageInput.open(name)
    assert image, oiio.geterror()
    pixels = image.read_image(0, 0, 0, image.spec().nchannels, "float")
    assert pixels is not None, image.geterror()
    return pixels.astype(np.float64), image.spec()


def wave(direction, x, y):
    across, down = FREQUENCY * math.cos(direction), FREQUENCY * math.sin(direction)
    return 2 * np.pi * (across * x + down * y)


def kernel(filter_, x):
    """Mitchell and Netravali's cubics with B = 0, and the triangle."""
    x = np.abs(x)
    if filter_ == "bilinear":
        return np.clip(1 - x, 0, None)
    c = {"bicubic": 1 / 2, "sharp_bicubic": 2 / 3}[filter_]
    near = ((12 - 6 * c) * x**3 + (-18 + 6 * c) * x**2 + 6) / 6
    far = (-6 * c * x**3 + 30 * c * x**2 - 48 * c * x + 24 * c) / 6
    return np.where(x < 1, near, np.where(x < 2, far, 0))


def response(filter_, frequency):
    x = (np.arange(40000) + 0.5) / 10000 - 2
    return (kernel(filter_, x) * np.cos(2 * np.pi * frequency * x)).sum() / 10000


class Frequencies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
        cls.directions = [0, math.pi / 2, 0.6, -0.9]
        pixels = np.stack([0.5 + SWING * np.cos(wave(d, x, y)) for d in cls.directions], -1).astype(np.float32)
        spec = oiio.ImageSpec(WIDTH, HEIGHT, len(cls.directions), "float")
        spec.channelnames = ("R", "G", "B", "X")
        spec.attribute("oiio:ColorSpace", "Linear")
        output = oiio.ImageOutput.create("plate.exr")
        assert output.open("plate.exr", spec) and output.write_image(pixels) and output.close()
        with open("bulge.json", "w") as file:
            json.dump({"columns": 2, "rows": 2, "units": "fractions",
                       "vertices": [[0.02, 0.01], [0.5, 0], [0.99, 0.02], [0, 0.51], [0.512, 0.494], [1, 0.5],
                                    [0.01, 1], [0.49, 0.99], [0.98, 0.97]]}, file)

    def chain(self, keys, outer=""):
        undistorted = f"plate.exr.lens?lens=brown:k1=-0.04,k2=0.01&fov=70&{keys}"
        turned = f"x.pano?from=rectilinear&srcfov=70&fov=69&yaw=1.3&pitch=-0.9&roll=2&size={WIDTH}x{HEIGHT}&{keys}&src=({undistorted})"
        return f"x.warp?mesh=bulge.json&{keys}{outer}&src=({turned})"

    def loss(self, recipe):
        """Of each channel, how much smaller its wave is, and what else is in it, by the wave's own."""
        pixels, _ = read(recipe)
        points, _ = read(self.chain("tol=0.000001", "&output=stmap"))
        x, y = points[..., 0] * WIDTH, points[..., 1] * HEIGHT
        inside = (x > 12) & (x < WIDTH - 12) & (y > 12) & (y < HEIGHT - 12)
        inside[:12] = inside[-12:] = inside[:, :12] = inside[:, -12:] = False
        self.assertGreater(inside.sum(), 40000)
        losses = []
        for channel, direction in enumerate(self.directions):
            phase = wave(direction, x[inside], y[inside])
            terms = np.stack([np.cos(phase), np.sin(phase), np.ones_like(phase)], -1)
            found = np.linalg.lstsq(terms, pixels[..., channel][inside], rcond=None)[0]
            losses.append(1 - found[0] / SWING)
        return np.array(losses)

    def test_one_resampling_keeps_what_three_lose(self):
        _, spec = read(self.chain("filter=sharp_bicubic"))
        self.assertEqual(spec.get_string_attribute("anamorph:chain"), "warp of pano of lens")
        joined = {f: self.loss(self.chain(f"filter={f}")) for f in ("bilinear", "bicubic", "sharp_bicubic")}
        first = {f: self.loss(self.chain(f"filter={f}&concatenate=0")) for f in ("bilinear", "bicubic", "sharp_bicubic")}
        print("lost by one resampling", joined)
        print("lost by three", first)
        for name, losses in joined.items():
            for lost, direction in zip(losses, self.directions):
                kept = response(name, FREQUENCY * math.cos(direction)) * response(name, FREQUENCY * math.sin(direction))
                self.assertAlmostEqual(1 - lost, kept, delta=1e-3, msg=f"{name} {direction}")
        self.assertLess(joined["sharp_bicubic"].max(), 0.01)
        self.assertGreater(joined["sharp_bicubic"].min(), -0.0153)
        self.assertGreater(first["bilinear"].min(), 0.2)
        self.assertGreater(first["bicubic"][:2].min(), 0.06)
        self.assertTrue((first["bicubic"] > 1.5 * joined["bicubic"]).all())

    def test_responses(self):
        self.assertAlmostEqual(response("sharp_bicubic", 0.2), 0.9976, delta=5e-5)
        self.assertAlmostEqual(response("bicubic", 0.2), 0.973, delta=5e-4)
        self.assertAlmostEqual(response("bilinear", 0.2), 0.875, delta=5e-4)
        self.assertLess(max(response("sharp_bicubic", f) for f in np.linspace(0, 0.2, 101)), 1.0076)


if __name__ == "__main__":
    unittest.main()
