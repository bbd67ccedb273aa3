# SPDX-License-Identifier: Apache-2.0
"""A source that is rewritten is seen by the next who opens the recipe; how Python opens one anew."""
import os
import unittest

import numpy as np
import OpenImageIO as oiio

RECIPES = ["plate.exr.lens?lens=3de4:k1=0.1", "view.map",
           "v.map?u=x&v=y&src=(plate.exr.lens?lens=3de4:k1=0.1)",
           "v.map?u=x&v=y&concatenate=0&src=(plate.exr.lens?lens=3de4:k1=0.1)"]


def write(value, size=(64, 48)):
    """Writes the plate again, mostly in as many bytes, within the same second."""
    spec = oiio.ImageSpec(size[0], size[1], 3, "half")
    spec.attribute("compression", "none")
    output = oiio.ImageOutput.create("plate.exr")
    assert output.open("plate.exr", spec)
    assert output.write_image(np.full((size[1], size[0], 3), value, np.float32)) and output.close()


def value_of(image):
    return image.getpixel(image.spec().width // 2, image.spec().height // 2)[0]


class Stale(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open("view.map", "w") as file:
            file.write("src=plate.exr\nu=x+1\n")
        write(0.5)

    def test_what_is_opened_is_new(self):
        for recipe in RECIPES:
            for value in (0.25, 0.5, 0.75, 1.0):
                write(value)
                with self.subTest(recipe, value=value):
                    pixels = oiio.ImageInput.open(recipe).read_image("float")
                    self.assertEqual(pixels[24, 32, 0], value)

    def test_a_time_that_was_set_back_hides_nothing(self):
        for recipe in RECIPES:
            write(0.25)
            before = os.stat("plate.exr")
            self.assertEqual(oiio.ImageInput.open(recipe).read_image("float")[24, 32, 0], 0.25)
            write(0.75)
            os.utime("plate.exr", ns=(before.st_atime_ns, before.st_mtime_ns))
            self.assertEqual(oiio.ImageInput.open(recipe).read_image("float")[24, 32, 0], 0.75, recipe)

    def test_an_image_with_options_is_opened_anew(self):
        for recipe in RECIPES:
            write(0.125)
            first = value_of(oiio.ImageBuf(recipe, 0, 0, oiio.ImageSpec()))
            self.assertEqual(first, 0.125, recipe)
            for value in (0.25, 0.75):
                write(value)
                self.assertEqual(value_of(oiio.ImageBuf(recipe, 0, 0, oiio.ImageSpec())), value, recipe)
                # And the cache has it from then on.
                self.assertEqual(value_of(oiio.ImageBuf(recipe)), value, recipe)

    def test_the_cache_lets_go_of_a_name(self):
        for recipe in RECIPES:
            write(0.125)
            oiio.ImageCache().invalidate(recipe)
            value_of(oiio.ImageBuf(recipe))
            write(0.375)
            oiio.ImageCache().invalidate(recipe)
            self.assertEqual(value_of(oiio.ImageBuf(recipe)), 0.375, recipe)
            write(0.625)
            image = oiio.ImageBuf(recipe)
            self.assertTrue(image.read(force=True))
            self.assertEqual(value_of(image), 0.625, recipe)

    def test_another_size_is_seen_too(self):
        for size in ((80, 60), (64, 48), (32, 100)):
            write(0.5, size)
            for recipe in RECIPES:
                spec = oiio.ImageBuf(recipe, 0, 0, oiio.ImageSpec()).spec()
                self.assertEqual((spec.width, spec.height), size, recipe)


if __name__ == "__main__":
    unittest.main()
