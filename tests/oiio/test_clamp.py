# SPDX-License-Identifier: Apache-2.0
"""clamp=1: what cubic filters overshoot is cut off at the least and the greatest of the 4x4 texels, as NumPy has them."""
import os
import unittest

import numpy as np
import OpenImageIO as oiio

SEED = 20261128
WIDTH, HEIGHT = 61, 47


def write(name, pixels, kind):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    spec.attribute("oiio:ColorSpace", "Linear")
    output = oiio.ImageOutput.create(name)
    assert output.open(name, spec) and output.write_image(pixels) and output.close()


def read(name):
    image = oiio.ImageInput.open(name)
    assert image, oiio.geterror()
    pixels = image.read_image(0, 0, 0, image.spec().nchannels, "float")
    assert pixels is not None, image.geterror()
    return pixels.astype(np.float64)


# The cubics by their a.
CUBICS = {"bicubic": -1 / 2, "sharp_bicubic": -2 / 3}


def cubic(a, t):
    """Weights of the texels at -1, 0, 1 and 2, t to the right of 0: Keys 1981 by its pieces."""
    def near(d):
        return (a + 2) * d**3 - (a + 3) * d**2 + 1

    def far(d):
        return a * d**3 - 5 * a * d**2 + 8 * a * d - 4 * a

    return np.array([far(1 + t), near(t), near(1 - t), far(2 - t)])


def by_definition(filter_, pixels, u, v):
    """The filtered value and the least and the greatest texel, at a point whose taps are all inside."""
    x, y = int(np.floor(u - 0.5)), int(np.floor(v - 0.5))
    taps = pixels[y - 1:y + 3, x - 1:x + 3]
    a = CUBICS[filter_]
    value = np.einsum("j,i,jic->c", cubic(a, v - 0.5 - y), cubic(a, u - 0.5 - x), taps)
    return value, taps.min(axis=(0, 1)), taps.max(axis=(0, 1))


class Clamp(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        print("seed", SEED)
        random = np.random.default_rng(SEED)
        cls.pixels = random.uniform(-1, 3, (HEIGHT, WIDTH, 3)).astype(np.float32)
        write("noise.exr", cls.pixels, "float")
        write("half.exr", cls.pixels, "half")
        cls.steps = np.where(random.uniform(size=(HEIGHT, WIDTH, 4)) < 0.5, 0.25, 0.75).astype(np.float32)
        write("steps.exr", cls.steps[:, :, :3], "float")
        write("bytes.png", cls.steps[:, :, :3], "uint8")
        write("shorts.tif", cls.steps[:, :, :3], "uint16")

    def test_is_within_the_taps(self):
        for filter_ in CUBICS:
            with self.subTest(filter_):
                self.is_within_the_taps(filter_)

    def is_within_the_taps(self, filter_):
        overshot = 0
        for name, least_off in (("noise.exr", 0), ("half.exr", 2e-3), ("bytes.png", 2e-3), ("shorts.tif", 1e-5)):
            pixels = read(name)
            for scale in (0.37, 1.0, 1.9):
                recipe = f"{name}.map?u=x*{scale}+5.21&v=y*{scale}+3.37&size=20x16&filter={filter_}"
                clamped, free = read(recipe + "&clamp=1"), read(recipe)
                for y in range(16):
                    for x in range(20):
                        value, least, most = by_definition(filter_, pixels, (x + 0.5) * scale + 5.21,
                                                           (y + 0.5) * scale + 3.37)
                        np.testing.assert_allclose(free[y, x], value, atol=1e-5 + least_off)
                        np.testing.assert_allclose(clamped[y, x], np.clip(value, least, most),
                                                   atol=1e-5 + least_off)
                        self.assertTrue(((clamped[y, x] >= least) & (clamped[y, x] <= most)).all())
                        overshot += np.count_nonzero((value < least) | (value > most))
        self.assertGreater(overshot, 50)

    def test_every_operation(self):
        with open("grid.json", "w") as file:
            file.write('{"columns": 1, "rows": 1, "units": "fractions", '
                       '"vertices": [[0.1, 0.05], [0.9, 0], [0, 1], [1, 0.9]]}')
        with open("lines.json", "w") as file:
            file.write('{"features": [{"line": [[10, 10, 40, 12], [12, 14, 38, 10]]}]}')
        with open("ball.n", "w") as file:
            file.write("figure ball\nellipsoid ball 300 300 300\nvariable\nstop\n")
        operations = [
            "{0}.pano?from=rectilinear&srcfov=60&fov=40&yaw=3&wrap=clamp",
            "{0}.pano?from=rectilinear&srcfov=60&to=formula&size=60x40&ray_z=2&wrap=clamp",
            "{0}.lens?lens=3de4:k1=0.1&wrap=clamp", "{0}.map?u=x*0.7+3&v=y*0.6+sin(x/5)&wrap=clamp",
            "{0}.warp?mesh=grid.json&wrap=clamp", "v.morph?a={0}&b={0}&features=lines.json&t=0.3",
            "{0}.mosaic?circles=1&fov=40&wrap=clamp", "{0}.drape?surface=plane&rotate=20,10,5&background=0.25,0.25,0.25"
        ]
        for operation, filter_ in ((o, f) for o in operations for f in CUBICS):
            for name in ("steps.exr", "bytes.png", "shorts.tif"):
                recipe = operation.format(name)
                recipe += ("&" if "?" in recipe else "?") + "filter=" + filter_
                free, clamped = read(recipe), read(recipe + "&clamp=1")
                with self.subTest(recipe):
                    low, high = read(name).min(), read(name).max()
                    slack = 0 if name == "steps.exr" and "morph" not in recipe and "drape" not in recipe else 2e-6
                    self.assertLess(free.min(), low - 0.02)
                    self.assertGreater(free.max(), high + 0.02)
                    self.assertGreaterEqual(clamped.min(), low - slack)
                    self.assertLessEqual(clamped.max(), high + slack)
                    # What does not overshoot is what it was.
                    inside = (free > low + 0.01) & (free < high - 0.01)
                    self.assertGreater(np.mean(np.isclose(free, clamped, atol=1e-6)[inside]), 0.5)

    def test_other_filters_have_nothing_to_cut_off(self):
        for filter_ in ("nearest", "bilinear", "antialias"):
            recipe = f"noise.exr.map?u=x*1.3&v=y*0.7&filter={filter_}"
            np.testing.assert_array_equal(read(recipe), read(recipe + "&clamp=1"))

    def test_infinite_texels_stay(self):
        pixels = self.pixels.copy()
        pixels[20, 30] = (np.inf, np.nan, 1000)
        write("sun.exr", pixels, "float")
        for filter_ in CUBICS:
            moved = read(f"sun.exr.map?u=x&v=y&filter={filter_}&clamp=1")
            np.testing.assert_array_equal(moved, pixels)
            between = read(f"sun.exr.map?u=x+0.25&v=y&filter={filter_}&clamp=1")
            self.assertFalse(np.isfinite(between[20, 29, 0]))
            self.assertTrue(np.isnan(between[20, 29, 1]))
            self.assertTrue(np.isfinite(between[20, :, 2]).all())
            # Where the sun's weight is negative.
            self.assertGreaterEqual(between[:, :, 0].min(), pixels[:, :, 0].min())
            self.assertLessEqual(between[:, :, 2].max(), 1000)

    def test_data_too(self):
        for filter_ in CUBICS:
            recipe = f"noise.exr.map?u=x*0.37+5.21&v=y*0.4+3&data_channels=R&data_filter={filter_}&clamp=1"
            all_by_it = read(f"noise.exr.map?u=x*0.37+5.21&v=y*0.4+3&filter={filter_}&clamp=1")
            np.testing.assert_array_equal(read(recipe)[:, :, 0], all_by_it[:, :, 0])

    def test_refuses_what_is_no_toggle(self):
        for value in ("2", "yes", "", "nan"):
            self.assertIsNone(oiio.ImageInput.open(f"noise.exr.lens?lens=3de4:k1=0&clamp={value}"))
            self.assertIn("clamp", oiio.geterror())


if __name__ == "__main__":
    unittest.main()
