#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Formulas of .map beside what else draws a picture along a formula: ImageMagick's -fx and -distort, and NumPy with OpenCV's remap.

Whole commands, on one thread, less a command that copies the picture; processor time, the least of the rounds, of pictures of
8 bits with 3 channels. -fx, which takes minutes for a picture of 2048 x 2048, is timed on an eighth of the side. NumPy computes
the source points in double, which remap reads as floats, without a filter where texels lie closer than pixels; .map filters
(antialias) and holds its tolerance of 0.01 pixels. Fails where a peer draws another picture. What is missing is said and left out.

Needs oiiotool with the plugin (OIIO_LIBRARY_PATH), and for the peers imagemagick and python3-opencv."""
import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

try:
    import cv2
    cv2.setNumThreads(1)
except ImportError:
    cv2 = None

SWIRL = "let=b=a-2*exp(-4*r^2)&u=width/2*(1+r*cos(b))&v=height/2*(1-r*sin(b))"
SWIRL_FX = ("xx=(i+.5)-w/2;yy=h/2-(j+.5);rr=hypot(xx,yy)/(h/2);bb=atan2(yy,xx)-2*exp(-4*rr*rr);"
            "u.p{w/2*(1+rr*cos(bb))-.5,h/2*(1-rr*sin(bb))-.5}")
# r (A r^3 + B r^2 + C r + D) of ImageMagick, r in halves of the smaller side.
BARREL = "let=k=1+r^2*(-.2+.05*r)&u=width/2*(1+px*k)&v=height/2*(1-py*k)"
BARREL_DISTORT = "0.05 -0.2 0 1"
# Pictures are alike where at most so many pixels differ by more than a tenth: on the edges of a checkerboard.
MOST_DIFFERENT = 0.04


def seconds_of(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def least(rounds, measure):
    return min(measure() for _ in range(rounds))


def remap(picture, side):
    y, x = np.mgrid[0:side, 0:side] + 0.5
    px, py = x / (side / 2) - 1, 1 - y / (side / 2)
    r, a = np.hypot(px, py), np.arctan2(py, px)
    b = a - 2 * np.exp(-4 * r**2)
    u, v = side / 2 * (1 + r * np.cos(b)) - 0.5, side / 2 * (1 - r * np.sin(b)) - 0.5
    return cv2.remap(picture, u.astype(np.float32), v.astype(np.float32), cv2.INTER_LINEAR)


class Pictures:
    """A checkerboard of each side, and what it costs to read and to write it."""

    def __init__(self, rounds):
        self.rounds, self.copies = rounds, {}

    def of(self, side, program):
        name = f"checker{side}.ppm"
        if not os.path.exists(name):
            subprocess.run(["oiiotool", "--pattern", f"checker:width={side // 8}:height={side // 8}", f"{side}x{side}", "3",
                            "-d", "uint8", "-o", name], check=True)
        if (side, program[0]) not in self.copies:
            command = [program[0], *program[1:], name, *(["-o"] if program[0] == "oiiotool" else []), "copy.ppm"]
            self.copies[side, program[0]] = least(self.rounds, lambda: seconds_of(command))
        return name, self.copies[side, program[0]]


def drawn(pictures, side, recipe, to):
    name, copy = pictures.of(side, ["oiiotool", "--threads", "1"])
    command = ["oiiotool", "--threads", "1", f"{name}.map?{recipe}", "-o", to]
    return max(least(pictures.rounds, lambda: seconds_of(command)) - copy, 0.01) / side**2


def by_imagemagick(pictures, magick, side, operation, to):
    name, copy = pictures.of(side, [magick, "-limit", "thread", "1"])
    command = [magick, "-limit", "thread", "1", name, "-virtual-pixel", "black", *operation, to]
    return max(least(pictures.rounds, lambda: seconds_of(command)) - copy, 0.01) / side**2


def read(name):
    """Numbers of a binary PPM of 8 bits."""
    with open(name, "rb") as file:
        data = file.read()
    fields, at = [], 0
    while len(fields) < 4:
        end = at
        while not data[end:end + 1].isspace():
            end += 1
        fields.append(data[at:end])
        at = end + 1
    width, height = int(fields[1]), int(fields[2])
    return np.frombuffer(data[at:], np.uint8).reshape(height, width, 3)


def differ(a, b):
    return float(np.mean(np.abs(a.astype(int) - b.astype(int)).max(-1) > 25))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=2048, help="side of the pictures, pixels")
    parser.add_argument("--rounds", type=int, default=5)
    args = parser.parse_args()
    magick = shutil.which("convert-im6.q16") or shutil.which("magick")
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pictures = Pictures(args.rounds)
        ours = {name: drawn(pictures, args.size, recipe, f"{name}.ppm") for name, recipe in (("swirl", SWIRL), ("barrel", BARREL))}

        def say(what, case, seconds, other, mine):
            print(f"{case:8} {what:16} {1e9 * seconds:10.1f} ns/px   .map {1e9 * ours[case]:6.1f}   {seconds / ours[case]:8.1f} times")
            if differ(other, mine) > MOST_DIFFERENT:
                failures.append(f"{what} draws another picture of {case}: {100 * differ(other, mine):.1f} % of the pixels differ")

        if magick:
            few = max(args.size // 8, 64)
            seconds = by_imagemagick(pictures, magick, few, ["-fx", SWIRL_FX], "fx.ppm")
            drawn(pictures, few, SWIRL, "few.ppm")
            say("ImageMagick -fx", "swirl", seconds, read("fx.ppm"), read("few.ppm"))
            seconds = by_imagemagick(pictures, magick, args.size, ["-distort", "Barrel", BARREL_DISTORT], "distort.ppm")
            say("-distort Barrel", "barrel", seconds, read("distort.ppm"), read("barrel.ppm"))
        else:
            print("(ImageMagick is not installed: tests/install_packages.sh peers)")
        if cv2:
            picture = read(pictures.of(args.size, ["oiiotool", "--threads", "1"])[0])

            def measure():
                before = time.process_time()
                remap(picture, args.size)
                return time.process_time() - before

            say("NumPy and remap", "swirl", least(args.rounds, measure) / args.size**2, remap(picture, args.size), read("swirl.ppm"))
        else:
            print("(OpenCV for Python is not installed: apt-get install python3-opencv)")
    for failure in failures:
        print(failure)
    return 1 if failures else 0


sys.exit(main())
