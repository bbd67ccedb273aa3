# SPDX-License-Identifier: Apache-2.0
"""The programs of Chapman 1986: MTEXTURE, SHOWMAP and MRASEL as its Appendix I runs them, HIDE, VISIB and PLOTEL."""
import math
import os
import random
import re
import unittest

from test_figure import Case, PROGRAM, subprocess

SIDES = (512, 256, 128, 64, 32, 16, 8, 4, 2, 1)


def picture_of(ppm, width, height):
    """The triples of a PPM file of that size: a function of x and y."""
    header = b"P6\n%d %d\n255\n" % (width, height)
    assert ppm.startswith(header), ppm[:20]
    data = ppm[len(header):]
    assert len(data) == 3 * width * height
    return lambda x, y: tuple(data[3 * (y * width + x):3 * (y * width + x) + 3])


class Essay(Case):
    """In a folder of its own, as the essay has it: maps are in the working directory."""

    def run_here(self, *arguments, data=b""):
        return subprocess.run([PROGRAM, *arguments], input=data, capture_output=True, timeout=100, cwd=self.folder)

    def output_here(self, *arguments, data=b""):
        result = self.run_here(*arguments, data=data)
        self.assertEqual((result.returncode, result.stderr), (0, b""), arguments)
        return result.stdout

    def error_here(self, *arguments, data=b""):
        result = self.run_here(*arguments, data=data)
        self.assertEqual(result.returncode, 1, arguments)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr.decode()


class Maps(Essay):
    def test_ten_files_each_of_them_means(self):
        base = random.Random(20).randbytes(3 * 512 * 512)
        self.assertEqual(self.output_here("mtexture", "face", data=base), b"")
        self.assertEqual(sorted(os.listdir(self.folder)), sorted("face.%d" % side for side in SIDES))
        self.assertEqual(self.read("face.512"), base)
        for side in SIDES[1:]:
            data, of = self.read("face.%d" % side), 512 // side
            self.assertEqual(len(data), 3 * side * side)
            for x, y, c in ((0, 0, 0), (side - 1, 0, 1), (side // 3, side - 1, 2)):
                total = sum(base[3 * ((y * of + j) * 512 + x * of + i) + c] for j in range(of) for i in range(of))
                self.assertEqual(data[3 * (y * side + x) + c], (2 * total + of * of) // (2 * of * of))
        # SHOWMAP has the nine smallest beside each other.
        shown = self.output_here("showmap", "face")
        at = picture_of(shown, 512, 256)
        left = 0
        for side in SIDES[1:]:
            data = self.read("face.%d" % side)
            for x, y in ((0, 0), (side - 1, side - 1), (side // 2, side // 3)):
                self.assertEqual(at(left + x, y), tuple(data[3 * (y * side + x):3 * (y * side + x) + 3]))
            if side < 256:
                self.assertEqual(at(left, side), (0, 0, 0))
            left += side
        self.assertEqual(at(511, 0), (0, 0, 0))
        self.assertEqual(self.output_here("showmap", "face", "--raw"), shown[15:])

    def test_what_is_wrong_is_said(self):
        for data in (b"", bytes(3 * 512 * 512 - 1), bytes(3 * 512 * 512 + 1)):
            message = self.error_here("mtexture", "face", data=data)
            self.assertIn("the standard input: has %d bytes: must have 786432" % len(data), message)
        self.assertEqual(os.listdir(self.folder), [])
        self.assertIn("NAME is required", self.error_here("mtexture"))
        self.assertIn("cannot read none.512", self.error_here("showmap", "none"))
        self.output_here("mtexture", "face", data=bytes(3 * 512 * 512))
        os.truncate(self.path("face.16"), 767)
        self.assertIn("face.16: has 767 bytes: must have 768, a map of 16 by 16", self.error_here("showmap", "face"))
        os.remove(self.path("face.16"))
        self.assertIn("cannot read face.16", self.error_here("showmap", "face"))


class Mrasel(Essay):
    BANDS = "255 0 0 90\n511 0 50 150\n"

    def maps(self, name, color_of):
        rows = [b"".join(bytes(color_of(x, y)) for x in range(512)) for y in range(512)]
        self.output_here("mtexture", name, data=b"".join(rows))

    def test_the_example_of_the_appendix(self):
        frame = ("3 0 2\n" + self.BANDS + "250 250 250 3500 6050 0 0 0 0 face\n"
                 "125 375 375 4575 4553 107 1800 0 230 bars\n250 50 125 3875 2050 -200 0 0 0 stripes\n").encode()
        for name, color in (("face", (250, 200, 150)), ("bars", (10, 240, 20)), ("stripes", (90, 90, 230))):
            self.maps(name, lambda x, y, color=color: color)
        at = picture_of(self.output_here("mrasel", data=frame), 512, 512)
        # A dark blue band in the top half of the screen, a greenish one in the bottom half.
        self.assertEqual([at(2, 100), at(2, 255), at(2, 256), at(2, 511)],
                         [at(2, 100), (0, 0, 90), (0, 50, 150), (0, 50, 150)])
        # Of the third, alone there, the row of its middle, 205 pixels from the bottom: the light is A + (1 - A) / 2 = .65.
        for got, color in zip(at(220, 512 - 205), (90, 90, 230)):
            self.assertLessEqual(abs(got - .65 * color), 3)
        # There it reaches 50 (1 - (167 / 250)^2)^(1/2) = 37 pixels up and down: half axes are in pixels.
        self.assertEqual(at(220, 512 - 205 + 45), (0, 50, 150))
        self.assertNotEqual(at(220, 512 - 205 + 30), (0, 50, 150))
        self.assertEqual(self.output_here("mrasel", "--raw", data=frame),
                         self.output_here("mrasel", "--threads", "2", data=frame)[15:])

    def test_maps_lie_as_in_the_essay(self):
        # Left half red, right half blue; the upper half darker.
        self.maps("map", lambda x, y: ((200 if x < 256 else 0), 100 if y < 256 else 0, (200 if x >= 256 else 0)))
        frame = b"1 0 1\n511 0 0 0\n150 150 150 2560 2560 0 0 0 0 map\n"
        for options in ((), ("--linear",), ("--filter", "antialias")):
            at = picture_of(self.output_here("mrasel", *options, data=frame), 512, 512)
            for x, y in ((180, 180), (330, 180), (180, 330), (330, 330)):
                red, green, blue = at(x, y)
                # On a ball of 150 pixels about the middle: the normal's y is (255.5 - y) / 150.
                light = .3 + .35 * (1 + (255.5 - y) / 150)
                expected = (200 if x < 256 else 0, 100 if y < 256 else 0, 200 if x > 256 else 0)
                if options:
                    for got, color in zip((red, green, blue), expected):
                        self.assertLessEqual(abs(got - light * color), 1.5, (options, x, y))
                # MRASEL's own level may blur all of it, but left is redder than right.
                self.assertEqual(red > blue, x < 256)
            self.assertEqual(at(2, 2), (0, 0, 0))

    def test_the_turn_is_in_tenths_of_degrees(self):
        # Half turned about y, the side that is seen shows the same map, mirrored on the far half: MRASEL has no back.
        self.maps("map", lambda x, y: (x // 2, y // 2, 0))
        frame = "1 0 0\n150 150 150 2560 2560 0 %s map\n"
        straight = self.output_here("mrasel", "--filter", "antialias", data=(frame % "0 0 0").encode())
        turned = self.output_here("mrasel", "--filter", "antialias", data=(frame % "0 0 3600").encode())
        for x, y in ((200, 200), (300, 220)):
            for a, b in zip(picture_of(straight, 512, 512)(x, y), picture_of(turned, 512, 512)(x, y)):
                self.assertLessEqual(abs(a - b), 1)

    def test_debugging_perturbation_and_what_is_missing(self):
        frame = "1 %d 0\n150 60 150 2560 2560 0 0 0 0 face\n"
        result = self.run_here("mrasel", data=(frame % 0).encode())
        self.assertEqual(result.returncode, 0)
        self.assertEqual(result.stderr.decode().splitlines(),
                         ["anamorph-figure: the texture face is not there: bodies have their own color"])
        self.maps("face", lambda x, y: (100, 100, 100))
        quiet = self.run_here("mrasel", data=(frame % 1).encode())
        debug = self.run_here("mrasel", data=(frame % -1).encode())
        self.assertEqual(quiet.stderr, b"")
        self.assertEqual(debug.stderr.decode().splitlines(),
                         ["anamorph-figure: ellipsoids 1, bands 0, maps 1",
                          "anamorph-figure: ellipsoid face: half its longest axis is 150 pixels"])
        self.assertEqual(quiet.stdout, debug.stdout)
        noisy = [self.output_here("mrasel", "--perturbation", "0.1", "--seed", seed, data=(frame % 0).encode())
                 for seed in ("1", "1", "2")]
        self.assertEqual(noisy[0], noisy[1])
        self.assertNotEqual(noisy[0], noisy[2])
        self.assertNotEqual(noisy[0], quiet.stdout)
        self.assertEqual(max(abs(a - b) for a, b in zip(noisy[0], quiet.stdout)), 10)

    def test_what_is_wrong_is_said(self):
        self.assertIn("stdin: line 1: the text ends", self.error_here("mrasel"))
        self.assertIn("found \"nan\"", self.error_here("mrasel", data=b"1 0 0\nnan 1 1 0 0 0 0 0 0 a\n"))
        for value in ("-0.1", "1.1", "nan", "inf", "2147483648"):
            self.assertIn("must be a number from 0 to 1", self.error_here("mrasel", "--perturbation", value))
        for value in ("-1", "0.5", "nan", "2147483648"):
            self.assertIn("must be an integer from 0 to 1e+09", self.error_here("mrasel", "--seed", value))


class Outlines(Essay):
    SCRIPT = ("figure f 1 a\nellipsoid a 100 100 100\nfigure g 1 b\nellipsoid b 100 100 100\nrepeat 0 2 moveto f a 500 500 200\n"
              "repeat 0 2 moveto g b 600 500 800\nstop\n")

    def test_hide_visib_and_plotel(self):
        self.write("two.n", self.SCRIPT)
        hide = self.output_here("hide", "two.n").decode().splitlines()
        self.assertEqual(len(hide), 2 * 5)
        self.assertEqual((hide[0], hide[5]), ("2 1", "2 2"))
        x, y, minor, major, phi, arcs = map(int, hide[2].split())
        self.assertEqual((x, y, minor, major, arcs), (600, 500, 100, 100, 2))
        self.assertEqual(hide[1].split()[:4] + hide[1].split()[5:], ["500", "500", "100", "100", "0"])
        # A third of it is hidden, about the angle 0: in two arcs.
        (zero, end), (begin, whole) = (map(int, line.split()) for line in hide[3:5])
        self.assertEqual((zero, whole), (0, 3600))
        self.assertEqual(end + whole - begin, 1200)

        def at(p):
            a, u = math.radians(p / 10 + 90), math.radians(phi / 10)
            c, s = minor * math.cos(a), major * math.sin(a)
            return x + c * math.cos(u) - s * math.sin(u), y + c * math.sin(u) + s * math.cos(u)

        # Where the circles cut each other, x is 550.
        for p, height in zip(sorted((begin, end), key=lambda p: at(p)[1]), (500 - 50 * 3 ** .5, 500 + 50 * 3 ** .5)):
            self.assertAlmostEqual(at(p)[0], 550, delta=.2)
            self.assertAlmostEqual(at(p)[1], height, delta=.2)
        self.assertAlmostEqual(at(0)[0], 500, delta=.2)
        visib = self.output_here("visib", "two.n", "--frame", "2").decode().splitlines()
        self.assertEqual(visib, ["2 2", hide[1], hide[2][:-1] + "0"])
        # PLOTEL reads what they write, and draws what is seen.
        self.write("two.2", "\n".join(hide) + "\n")
        svg = self.output_here("plotel", "two.2").decode()
        paths = re.findall(r'<path class="visible" data-body="(\d)" d="([^"]*)"', svg)
        self.assertEqual([name for name, _ in paths], ["1", "2"])
        self.assertTrue(paths[0][1].endswith("Z") and not paths[1][1].endswith("Z"))
        numbers = [float(n) for n in re.findall(r"-?[\d.]+", paths[1][1])]
        for px, py in zip(numbers[::2], numbers[1::2]):
            self.assertAlmostEqual(math.hypot(px - 300, py - 250), 50, delta=.01)
            self.assertGreaterEqual(px, 275 - .1)
        result = self.run_here("hide", "two.n", "--frame", "2")
        self.assertEqual(self.run_here("plotel", "-", data=result.stdout).stdout, svg.replace("frame 1", "frame 2").encode())
        self.output_here("plotel", "two.2", "--frame", "all", "-o", "plot.svg")
        self.assertEqual(sorted(n for n in os.listdir(self.folder) if n.startswith("plot")), ["plot.0001.svg", "plot.0002.svg"])
        # Of two records with one number the first is drawn.
        self.write("twice.2", "1 1\n500 500 40 200 300 0\n1 1\n300 300 40 200 300 0\n")
        self.assertEqual(self.output_here("plotel", "twice.2").count(b"<path"), 1)
        # Frames of a range with a step.
        self.write("many.2", "".join("1 %d\n500 500 40 200 300 0\n" % number for number in range(1, 7)))
        self.output_here("plotel", "many.2", "--frame", "2-5x2", "-o", "step.svg")
        self.assertEqual(sorted(n for n in os.listdir(self.folder) if n.startswith("step")), ["step.0002.svg", "step.0004.svg"])

    def test_a_script_of_the_examples(self):
        walker = os.environ["ANAMORPH_EXAMPLES"] + "/walker.nudes"
        one, four = (self.output_here("hide", walker, "--frame", "1-3", "--threads", n) for n in ("1", "4"))
        self.assertEqual(one, four)
        self.assertEqual(len(one.decode().split("\n17 ")), 3)

    def test_what_is_wrong_is_said(self):
        self.assertIn("two.2 has no frame", self.error_here("plotel", self.write("two.2", "")))
        self.assertIn("cannot read none.2", self.error_here("plotel", "none.2"))
        self.write("one.2", "0 4\n")
        self.assertIn("--frame=5: must be a frame that one.2 has", self.error_here("plotel", "one.2", "--frame", "5"))
        for value in ("0", "nan", "-1"):
            self.assertIn("must be a number", self.error_here("plotel", "one.2", "--tol", value))
        self.assertIn("FILE is required", self.error_here("plotel"))


if __name__ == "__main__":
    unittest.main()
