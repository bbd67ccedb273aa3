# SPDX-License-Identifier: Apache-2.0
"""anamorph stmap: what output=stmap draws, v up or down, and the inverse, against closed formulas."""
import math
import struct
import unittest

from program_test import ProgramTest


def read_tiff(path):
    """The numbers of a TIFF of two channels of float, packed by nothing: [row][column] -> (u, v)."""
    data = path.read_bytes()
    at = struct.unpack_from("<I", data, 4)[0]
    tags = {}
    for i in range(struct.unpack_from("<H", data, at)[0]):
        tag, kind, count, value = struct.unpack_from("<HHII", data, at + 2 + 12 * i)
        letter = {3: "H", 4: "I"}.get(kind)
        if letter:
            small = count * struct.calcsize(letter) <= 4
            tags[tag] = struct.unpack_from(f"<{count}{letter}", data, at + 2 + 12 * i + 8 if small else value)
    width, height = tags[256][0], tags[257][0]
    numbers = b"".join(data[offset:offset + size] for offset, size in zip(tags[273], tags[279]))
    uv = list(struct.iter_unpack("<2f", numbers))
    return [uv[y * width:(y + 1) * width] for y in range(height)]


class StMaps(ProgramTest):
    def stmap(self, *arguments):
        self.assertEqual(self.ok("stmap", *arguments, "-o", "map.tif", "--compression", "none"), "")
        return read_tiff(self.folder / "map.tif")

    def test_stmaps_are_what_output_stmap_draws(self):
        view = "sky.pano?size=90x70"
        self.stmap(view + "&filter=nearest&output=bound")
        self.assertEqual(self.hash("map.tif"), self.hash(view + "&output=stmap"))
        up = self.stmap(view, "--flip-v")
        self.assertEqual(self.hash("map.tif"), self.hash(view + "&output=stmap&flip_v=1"))
        self.assertEqual(up, self.stmap(view + "&flip_v=1"))
        # A warp reads its map as before.
        self.ok("stmap", view, "-o", "view.exr")
        warp = "noise.ppm.warp?mesh=view.exr"
        down, up = self.stmap(warp), self.stmap(warp, "--flip-v")
        for row, turned in zip(down, up):
            for (u, v), (same, w) in zip(row, turned):
                self.assertEqual(u, same)
                self.assertAlmostEqual(w, 1 - v, delta=1e-7)
        self.stmap(view + "&yaw={frame}", "--frames", "3")
        self.assertEqual(self.hash("map.0003.tif"), self.hash(view + "&yaw=3&output=stmap"))

    def test_inverse_stmaps_are_the_formula_the_other_way(self):
        """The inverse of taking a lens of 3DEqualizer off is its polynomial, which leads from the observed to the ideal."""
        width, height, k1 = 256, 128, 0.06
        half = math.hypot(width, height) / 2
        for size in ("", "&size=all", "&overscan=30"):
            for flip in ((), ("--flip-v",)):
                rows = self.stmap(f"noise.ppm.lens?lens=3de4:k1={k1}&tol=0{size}", "--inverse", *flip)
                self.assertEqual((len(rows), len(rows[0])), (height, width))
                none = 0
                for y, row in enumerate(rows):
                    for x, (u, v) in enumerate(row):
                        px, py = x + 0.5 - width / 2, y + 0.5 - height / 2
                        scale = 1 + k1 * (px * px + py * py) / half**2
                        ideal = px * scale + width / 2, py * scale + height / 2
                        if (u, v) == (-1, -1):
                            none += 1
                            self.assertTrue(not size and not (0 < ideal[0] < width and 0 < ideal[1] < height), (x, y))
                        else:
                            self.assertAlmostEqual(u * width, ideal[0], delta=2e-5)
                            self.assertAlmostEqual((1 - v if flip else v) * height, ideal[1], delta=2e-5)
                self.assertEqual(none > 0, not size)
        # There and back, of a picture with a seam and without all of its source.
        view = "sky.pano?to=fisheye&fov=200&size=120&tol=0"
        there = self.stmap(view, "--inverse")
        found = [(x, y, *uv) for y, row in enumerate(there) for x, uv in enumerate(row) if uv != (-1, -1)]
        self.assertGreater(len(found), 0.5 * 256 * 128)
        for x, y, u, v in found[::37]:
            # The source point of the picture's point, by the sky in closed form: a fisheye about yaw 30.
            right, down = (u * 2 - 1), (v * 2 - 1)
            r, t = math.hypot(right, down), math.hypot(right, down) * math.radians(100)
            ray = (math.sin(t) * right / r, math.sin(t) * down / r, math.cos(t)) if r > 0 else (0, 0, 1)
            azimuth = math.atan2(ray[0], ray[2]) + math.radians(30)
            column = (azimuth / (2 * math.pi) % 1 + 0.5) % 1 * 256
            self.assertAlmostEqual(abs((column - x - 0.5 + 128) % 256 - 128) * math.cos(math.asin(ray[1])), 0, delta=1e-3)
            self.assertAlmostEqual((math.asin(ray[1]) / math.pi + 0.5) * 128, y + 0.5, delta=1e-3)

    def test_refuses_what_has_no_stmap(self):
        for name in ("map.png", "map.jpg", "map.hdr"):
            self.refused(f"--output={name}: must be of a format that holds float", "stmap", "sky.pano", "-o", name)
            self.assertFalse((self.folder / name).exists())
        self.refused("RECIPE=noise.ppm: must be the name of a recipe", "stmap", "noise.ppm", "-o", "map.exr")
        self.refused(".figure has none", "stmap", "x.nudes", "-o", "map.exr")
        self.refused("its picture has no single source point", "stmap", "noise.ppm.drape?surface=cylinder", "--inverse", "-o", "map.exr")
        self.refused("fov=0", "stmap", "sky.pano?fov=0", "-o", "map.exr")


if __name__ == "__main__":
    unittest.main()
