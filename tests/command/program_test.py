# SPDX-License-Identifier: Apache-2.0
"""What tests of the program's pictures share."""
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["ANAMORPH"]
VIEW = "src=noise.ppm\nto=rectilinear\nfov=95\nyaw=30\nsize=900x700\n"


def noise_ppm(width, height):
    """An image of noise, in the simplest of formats."""
    state, data = 1, bytearray()
    for _ in range(3 * width * height):
        state = (state * 1664525 + 1013904223) % 2**32
        data.append(state >> 24)
    return b"P6\n%d %d\n255\n" % (width, height) + bytes(data)


class ProgramTest(unittest.TestCase):
    """Runs the program in a folder of its own, which has an image and a recipe, sky.pano."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "noise.ppm").write_bytes(noise_ppm(256, 128))
        (self.folder / "sky.pano").write_text(VIEW)

    def run_program(self, *arguments, **more):
        result = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=100, **more)
        return result.returncode, result.stdout, result.stderr

    def ok(self, *arguments):
        status, out, error = self.run_program(*arguments)
        self.assertEqual((status, error), (0, ""), arguments)
        return out

    def hash(self, *names):
        lines = self.ok("hash", *names).splitlines()
        self.assertEqual([line[32:] for line in lines], ["  " + str(name) for name in names])
        return [line[:32] for line in lines]

    def refused(self, message, *arguments):
        status, out, error = self.run_program(*arguments)
        self.assertEqual((status, out), (1, ""), arguments)
        self.assertIn(message, error)
        self.assertTrue(error.startswith("anamorph: ") and error.count("\n") == 1 and len(error) < 400, error)
