# SPDX-License-Identifier: Apache-2.0
"""The Python of docs/python.md, block after block, and what it made."""
import os
import sys
import unittest

import numpy as np

sys.path.insert(0, os.path.join(os.environ["ANAMORPH_SOURCE_DIR"], "tests/docs"))
import blocks  # noqa: E402


class Page(unittest.TestCase):
    def test_blocks(self):
        names = {}
        for name, text in blocks.python_of("python_page").items():
            exec(compile(text, "docs/python.md, " + name, "exec"), names)
        self.assertEqual((names["view"].shape, names["view"].dtype), ((480, 640, 3), np.float32))
        self.assertEqual(names["stmap"].shape, (480, 640, 2))
        # A map that was stored in float, and read in cubics through its pixels, is off by a few thousandths of a pixel.
        np.testing.assert_allclose(names["the_same"][2:-2, 2:-2], names["warped"][2:-2, 2:-2], atol=0.02)
        self.assertEqual(names["bent"].shape, (480, 640, 4))
        self.assertLessEqual(names["picture"].reached()["anamorph:max_error"], 0.001)
        np.testing.assert_array_equal(names["tile"], names["picture"].draw()[128:256, 128:256])
        self.assertEqual(names["paths"].shape, (9, 2, 3))
        self.assertTrue(names["lines"])
        np.testing.assert_allclose(names["half"][:, 2].max(), 0.1, atol=0.005)
        inner = np.s_[100:-100, 100:-100]
        np.testing.assert_allclose(names["kept"].points(*names["both"].centers())[0][inner], names["both"].points(*names["both"].centers())[0][inner], atol=0.01)
        self.assertEqual((round(float(names["x"]), 3), names["straight"].shape), (320, (480, 640, 3)))


if __name__ == "__main__":
    unittest.main()
