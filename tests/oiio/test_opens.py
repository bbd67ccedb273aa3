# SPDX-License-Identifier: Apache-2.0
"""How often files are opened: the kernel (inotify) counts for what a recipe opens of its sources."""
import ctypes
import os
import struct
import unittest

import numpy as np
import OpenImageIO as oiio

IN_OPEN, IN_ALL_EVENTS = 0x20, 0xfff


class Counter:
    """Counts how often files are opened while it is entered."""

    def __init__(self, names):
        self.libc = ctypes.CDLL(None, use_errno=True)
        self.names, self.counts = names, dict.fromkeys(names, 0)

    def __enter__(self):
        self.queue = self.libc.inotify_init1(os.O_NONBLOCK)
        assert self.queue >= 0, os.strerror(ctypes.get_errno())
        self.watched = {self.libc.inotify_add_watch(self.queue, name.encode(), IN_ALL_EVENTS): name for name in self.names}
        return self

    def __exit__(self, *_):
        try:
            events = os.read(self.queue, 1 << 20)
        except BlockingIOError:
            events = b""
        at = 0
        while at < len(events):
            watch, mask, _, length = struct.unpack_from("iIII", events, at)
            at += 16 + length
            # What is done between two of them keeps the kernel from making one of both.
            self.counts[self.watched[watch]] += bool(mask & IN_OPEN)
        os.close(self.queue)


def write(name, seed):
    pixels = np.random.default_rng(seed).uniform(0, 1, (48, 64, 3)).astype(np.float32)
    output = oiio.ImageOutput.create(name)
    assert output.open(name, oiio.ImageSpec(64, 48, 3, "half" if name.endswith("exr") else "uint8"))
    assert output.write_image(pixels) and output.close()


def read(name):
    image = oiio.ImageInput.open(name)
    assert image, oiio.geterror()
    pixels = image.read_image(0, 0, 0, image.spec().nchannels, "float")
    assert pixels is not None, image.geterror()
    return pixels


class Opens(unittest.TestCase):
    def test_of_images_of_a_project(self):
        # Nothing of these is known of a picture that was read before: names are the test's own.
        for ending in ("exr", "png", "jpg"):
            names = [f"{ending}_{i}.{ending}" for i in range(3)]
            with open(f"{ending}.pto", "w") as project:
                project.write("p f2 w128 h64 v360\n")
                for i, name in enumerate(names):
                    write(name, i)
                    project.write(f'i w64 h48 f0 v80 y{30 * i} p0 r0 n"{name}"\n')
            with Counter(names) as first:
                pixels = read(f"{ending}.pto")
            with Counter(names) as second:
                read(f"{ending}.pto?fov=200")
            write(f"alone.{ending}", 9)
            with Counter([f"alone.{ending}"]) as alone:
                read(f"alone.{ending}")
            print(ending, alone.counts, first.counts, second.counts)
            self.assertGreater(pixels.max(), 0.1)
            # Hardly more often than OpenImageIO does for one reading; a JPEG's XMP is read from the file itself.
            most = max(alone.counts.values()) + 1 + (ending == "jpg")
            self.assertLessEqual(max(first.counts.values()), most, first.counts)
            self.assertGreaterEqual(min(first.counts.values()), 1, first.counts)
            self.assertEqual(max(second.counts.values()), 0, second.counts)

    def test_a_rewritten_image_is_read_again(self):
        write("again.exr", 1)
        with open("again.pto", "w") as project:
            project.write('p f0 w64 h48 v80\ni w64 h48 f0 v80 y0 p0 r0 n"again.exr"\n')
        before = read("again.pto")
        write("again.exr", 2)
        after = read("again.pto")
        self.assertGreater(np.abs(before - after).max(), 0.1)


if __name__ == "__main__":
    unittest.main()
