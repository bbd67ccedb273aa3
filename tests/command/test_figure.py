# SPDX-License-Identifier: Apache-2.0
"""anamorph-figure: what it writes is read back and compared with what the scripts mean, worked out by hand."""
import json
import math
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree as xml
import zlib

PROGRAM = os.environ["ANAMORPH_FIGURE"]
CAIRO = os.environ["ANAMORPH_HAVE_CAIRO"] == "1"
WALKER = os.environ["ANAMORPH_EXAMPLES"] + "/walker.nudes"
SVG = "{http://www.w3.org/2000/svg}"


def scene(*bodies, extra=""):
    """A script of one frame: bodies are (name, half-axes, center), each a figure."""
    text = ""
    for name, axes, center in bodies:
        text += "figure f%s 1 %s\nellipsoid %s %s %s %s\n" % (name, name, name, *axes)
        text += "repeat 0 1 moveto f%s %s %s %s %s\n" % (name, name, *center)
    return text + extra + "stop\n"


NEAR_AND_FAR = scene(("near", (100, 100, 100), (500, 500, 200)), ("far", (100, 100, 100), (600, 500, 800)))


def pdf_objects(data):
    """A PDF with its object streams inflated: cairo 1.18 and newer put the pages into such."""
    streams = re.findall(rb"/Type /ObjStm.*?stream\r?\n(.*?)endstream", data, re.DOTALL)
    return data + b"".join(zlib.decompressobj().decompress(stream) for stream in streams)


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run_program(self, *arguments, text=None):
        data = text.encode() if isinstance(text, str) else text
        result = subprocess.run([PROGRAM, *arguments], input=data or b"", capture_output=True, timeout=100)
        self.assertIn(result.returncode, (0, 1), (arguments, result.stderr))
        return result

    def output(self, *arguments, text=None):
        result = self.run_program(*arguments, text=text)
        self.assertEqual((result.returncode, result.stderr), (0, b""), arguments)
        return result.stdout

    def error(self, *arguments, text=None):
        """Of a run that fails: its only line."""
        result = self.run_program(*arguments, text=text)
        self.assertEqual(result.returncode, 1, arguments)
        lines = result.stderr.decode(errors="replace").splitlines()
        self.assertEqual(len(lines), 1, (arguments, lines))
        self.assertTrue(lines[0].startswith("anamorph-figure: "), lines)
        return lines[0]

    def svg(self, text, *options):
        return xml.fromstring(self.output("svg", "-", *options, text=text))

    def paths(self, text, *options, kind="visible"):
        """(name, points, closed) of each path of a kind."""
        found = []
        for element in self.svg(text, *options).iter(SVG + "path"):
            if element.get("class") == kind:
                numbers = [float(n) for n in re.findall(r"-?[\d.]+", element.get("d"))]
                points = list(zip(numbers[::2], numbers[1::2]))
                closed = element.get("d").endswith("Z")
                found.append((element.get("data-body"), points + points[:1] * closed, closed))
        return found


class Check(Case):
    def test_a_score_of_labanotation_is_told_in_one_line(self):
        score = self.write("dance.lbn", "".join("Dirn 1 %d 2 3 4 L * #%d\n" % (n, n) for n in range(300)))
        for command in ("check", "frames"):
            result = self.run_program(command, score)
            self.assertEqual(result.returncode, 1)
            text = (result.stdout + result.stderr).decode()
            self.assertEqual(len(text.splitlines()), 1, text)
            self.assertIn("is a score in Labanotation (.lbn), not a script", text)

    def test_crystals_name_what_is_not_drawn_as_it_says(self):
        crystal = self.write("flat.cif", "data_x\n" + "".join(
            "_cell_%s %s\n" % pair for pair in [("length_a", 5), ("length_b", 5), ("length_c", 6), ("angle_alpha", 90),
                                                ("angle_beta", 90), ("angle_gamma", 90)]) +
            "_symmetry_space_group_name_H-M 'P 1 2 1 x'\nloop_\n_atom_site_label _atom_site_fract_x _atom_site_fract_y "
            "_atom_site_fract_z\nC7 0 0 0\nloop_\n_atom_site_aniso_label _atom_site_aniso_U_11 _atom_site_aniso_U_22 "
            "_atom_site_aniso_U_33 _atom_site_aniso_U_12 _atom_site_aniso_U_13 _atom_site_aniso_U_23\nC7 .02 .01 .01 .03 0 0\n")
        lines = self.output("check", crystal).decode().splitlines()
        self.assertEqual(len(lines), 2, lines)
        self.assertIn("P 1 2 1 x", lines[0])
        self.assertIn("flat.cif: C7: U11, U22, U33, U12, U13, U23 = 0.02, 0.01, 0.01, 0.03, 0, 0 is not positive definite", lines[1])
        self.assertEqual(self.run_program("svg", crystal).stderr.decode().splitlines(), lines)

    def test_silent_when_nothing_is_wrong(self):
        for dialect in ("classic", "strict"):
            self.assertEqual(self.output("check", WALKER, "--dialect", dialect), b"")

    def test_several_errors_with_line_and_column(self):
        path = self.write("bad.n", "figure f 1 a\nellipsoid a 1 2 x\nlinear 0 1\n  moveby f a 1 oops 3\nstop\n")
        result = self.run_program("check", path)
        self.assertEqual((result.returncode, result.stderr), (1, b""))
        lines = result.stdout.decode().splitlines()
        self.assertEqual(len(lines), 2, lines)
        self.assertRegex(lines[0], r"bad\.n:2:17: error: found \"x\", expected ")
        self.assertRegex(lines[1], r"bad\.n:4:16: error: found \"oops\", expected ")

    def test_what_is_an_error_in_strict_is_none_in_classic(self):
        text = "figure f 1 a\nellipsoid a -1 2 3\nlinear 0 1 moveby f a 1 2 3\nstop"
        self.assertEqual(self.run_program("check", "-", text=text).returncode, 0)
        result = self.run_program("check", "-", "--dialect=strict", text=text)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stdout.decode(), r"^stdin:2:\d+: error: ")

    def test_libraries_and_includes(self):
        library = self.write("lib.n", "figure f 1 a\nellipsoid a 1 2 3\n")
        text = "linear 0 1 moveby f a 1 2 3\nstop"
        self.assertEqual(self.run_program("check", "-", text=text).returncode, 1)
        self.assertEqual(self.output("check", "-", "--library", library, text=text), b"")
        # An include is looked for beside the script, wherever the program runs.
        self.assertEqual(self.output("check", self.write("inc.n", "include lib.n\n" + text)), b"")
        result = self.run_program("check", self.write("none.n", "include nowhere.n\nstop"))
        self.assertEqual(result.returncode, 1)
        self.assertIn(b"nowhere.n", result.stdout)


    def test_what_the_originals_pass_over_is_a_warning(self):
        text = "figure f 1 a\nellipsoid a 1 2 3 4\nlinear 0 1 moveby f a 1 2 3 linear 0 1 nothing\nstop"
        result = self.run_program("check", "-", text=text)
        self.assertEqual(result.returncode, 0)
        lines = result.stdout.decode().splitlines()
        self.assertEqual([line.split(" ")[:2] for line in lines],
                         [["stdin:2:19:", "warning:"], ["stdin:3:29:", "warning:"]])

    def test_files_that_are_no_scripts_stay_unseen(self):
        secret = self.write("secret", "key=hunter2\n")
        for options in ([self.write("s.n", "include secret\nstop")], ["-", "--library", secret]):
            result = self.run_program("check", *options, text="stop")
            self.assertEqual(result.returncode, 1)
            self.assertIn(b"it is not a script", result.stdout)
            self.assertNotIn(b"hunter2", result.stdout + result.stderr)
        # Nothing waits for a pipe that a script names.
        os.mkfifo(self.path("pipe"))
        result = self.run_program("check", self.write("p.n", "include pipe\nstop"))
        self.assertIn(b"there is no such file", result.stdout)

    def test_the_language_says_of_itself_what_runs(self):
        self.assertIn(b"bendby      ellipsoid joint ellipsoid angle axis\n", self.output("language"))
        page = self.output("language", "bendb").decode()
        self.assertIn("bendby ellipsoid joint", page)
        script = page[page.index("For example:") + len("For example:\n\n"):]
        self.assertEqual(self.output("check", "-", text=script), b"")
        self.assertIn("\"fly\" is not a word", self.error("language", "fly"))

    def test_the_help_says_where_classic_is_not_the_original(self):
        text = " ".join(self.output("frames", "--help").decode().split())
        self.assertRegex(text, "abut and touch end in exact contact")


class Frames(Case):
    # Two bodies joined at (0, 40, 0) of the first and (0, -20, 0) of the second, which so is at y = 60.
    SCRIPT = ("figure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 5 20 5\njoint j a 0 40 0 b 0 -20 0\n"
              "linear 0 2 moveby f a 100 10 -3\nrepeat 1 2 colour b 10 20 30\nstop")

    def test_the_originals_format(self):
        lines = self.output("frames", "-", text=self.SCRIPT).decode().splitlines()
        words = [line.split() for line in lines]
        frame = ["2", "1", "5000", "5000", "5000", "0", "0", "0"]
        self.assertEqual(words[0], frame)
        self.assertEqual(words[1], "100 400 200 500 50 -15 0 0 0 255 128 64 a 1".split())
        self.assertEqual(words[2], "50 200 50 500 650 -15 0 0 0 255 128 64 b 2".split())
        self.assertEqual(words[3], ["-1", "1"])
        self.assertEqual(words[4], "0 1 500 450 -15 j".split())
        self.assertEqual(words[6][3:6] + words[6][9:12], "1000 100 -30 255 128 64".split())
        self.assertEqual(words[7][3:6] + words[7][9:12], "1000 700 -30 10 20 30".split())
        self.assertEqual(words[10], "0 3 5000 5000 5000 0 0 0".split())
        self.assertEqual(len(words), 11)

    def test_files_ranges_and_the_standard_streams(self):
        path = self.write("s.n", self.SCRIPT)
        whole = self.output("frames", "-", text=self.SCRIPT)
        self.assertEqual(self.output("frames", path, "-o", self.path("out.3")), b"")
        self.assertEqual(self.read("out.3"), whole)
        second = self.output("frames", path, "--frame", "2").splitlines()
        self.assertEqual(second, whole.splitlines()[5:])
        self.assertIn("frame=3: must be an integer from 0 to 2", self.error("frames", path, "--frame", "3"))

    def test_what_scripts_print_goes_to_the_standard_error(self):
        result = self.run_program("frames", "-", text="variables 1 v\nrepeat 0 1 set v 7\nrepeat 0 2 print v\nstop")
        self.assertEqual(result.returncode, 0)
        self.assertEqual(len(result.stderr.splitlines()), 2)
        self.assertIn(b"7", result.stderr.splitlines()[0])


class Pictures(Case):
    def assert_on_circle(self, points, center, radius, tol):
        """Points and the middles of chords."""
        middles = [((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in zip(points, points[1:])]
        for p in points + middles:
            self.assertLessEqual(abs(math.dist(p, center) - radius), tol)

    def test_a_nearer_sphere_hides_an_arc(self):
        paths = self.paths(NEAR_AND_FAR)
        self.assertEqual(sorted(name for name, _, _ in paths), ["far", "near"])
        shapes = {name: (points, closed) for name, points, closed in paths}
        points, closed = shapes["near"]
        self.assertTrue(closed)
        self.assert_on_circle(points, (250, 250), 50, 0.1)
        # Circles of 50 pixels about (250, 250) and (300, 250) cross at x = 275, y = 250 -+ sqrt(50^2 - 25^2).
        points, closed = shapes["far"]
        self.assertFalse(closed)
        self.assert_on_circle(points, (300, 250), 50, 0.1)
        crossing = math.sqrt(50**2 - 25**2)
        ends = sorted([points[0], points[-1]], key=lambda p: p[1])
        for (x, y), expected in zip(ends, (250 - crossing, 250 + crossing)):
            self.assertAlmostEqual(x, 275, delta=2e-4)
            self.assertAlmostEqual(y, expected, delta=2e-4)
        self.assertGreater(max(x for x, _ in points), 349.8)

    def test_hidden_arcs_are_removed_dashed_or_drawn(self):
        behind = scene(("big", (200, 200, 200), (500, 500, 300)), ("small", (50, 50, 50), (500, 500, 900)))
        self.assertEqual([name for name, _, _ in self.paths(behind)], ["big"])
        self.assertEqual(self.paths(behind, kind="hidden"), [])
        dashed = self.paths(behind, "--hidden=dash", kind="hidden")
        self.assertEqual([name for name, _, _ in dashed], ["small"])
        self.assert_on_circle(dashed[0][1], (250, 250), 25, 0.1)
        elements = list(self.svg(behind, "--hidden=dash").iter(SVG + "path"))
        self.assertEqual([bool(e.get("stroke-dasharray")) for e in elements], [True, False])
        drawn = self.paths(behind, "--hidden=draw")
        self.assertEqual(sorted(name for name, _, closed in drawn if closed), ["big", "small"])

    def test_the_tolerance_decides_the_chords(self):
        counts = []
        for tol in (0.01, 0.1, 1):
            paths = self.paths(NEAR_AND_FAR, "--tol=%g" % tol)
            for name, points, _ in paths:
                self.assert_on_circle(points, (250 if name == "near" else 300, 250), 50, tol)
            counts.append(sum(len(points) for _, points, _ in paths))
        self.assertGreater(counts[0], 2 * counts[1])
        self.assertGreater(counts[1], 2 * counts[2])

    def test_a_viewport_cuts_lines(self):
        ball = scene(("ball", (100, 100, 100), (500, 500, 500)))
        # Circles of 50 pixels, 30 apart, cross 15 pixels to the right of the middle.
        points = [p for _, points, _ in self.paths(ball, "--viewport=.56,.5,.1,.1", kind="visible") for p in points]
        self.assertAlmostEqual(min(x for x, _ in points), 265, delta=0.1)
        self.assertAlmostEqual(max(x for x, _ in points), 300, delta=0.1)
        height = math.sqrt(50 ** 2 - 15 ** 2)
        self.assertAlmostEqual(min(y for _, y in points), 250 - height, delta=0.1)
        self.assertAlmostEqual(max(y for _, y in points), 250 + height, delta=0.1)
        self.assertEqual(self.paths(ball, "--viewport=.9,.5,.1,.1", kind="visible"), [])

    def test_halo_lines_lie_under_nearer_ones(self):
        elements = list(self.svg(NEAR_AND_FAR, "--halo=3", "--line-width=2").iter(SVG + "path"))
        self.assertEqual([e.get("class") for e in elements], ["halo", "visible", "halo", "visible"])
        self.assertEqual([e.get("data-body") for e in elements], [None, "far", None, "near"])
        self.assertEqual(elements[0].get("stroke-width"), "8")
        self.assertEqual(elements[2].get("d"), elements[3].get("d"))

    def test_a_halo_leaves_joints_closed(self):
        # Circles of 50 pixels about (250, 250) and, behind, (310, 250): they meet at (280, 250 -+ 40).
        joined = ("figure f 2 near far\nellipsoid near 100 100 100\nellipsoid far 100 100 100\n"
                  "joint j near 60 0 60 far -60 0 -60\nrepeat 0 1 moveto f near 500 500 500\nstop\n")
        apart = scene(("near", (100, 100, 100), (500, 500, 500)), ("far", (100, 100, 100), (620, 500, 620)))
        ends = ((280, 210), (280, 290))
        for script, nearest in ((apart, 0), (joined, 4)):
            halos = self.paths(script, "--halo=3", "--line-width=1", kind="halo")
            of_near = [points for _, points, _ in halos if all(abs(math.dist(p, (250, 250)) - 50) < 0.2 for p in points)]
            distances = [min(math.dist(p, end) for points in of_near for p in points) for end in ends]
            for distance in distances:
                self.assertGreater(distance, nearest - 0.2)
                self.assertLess(distance, nearest + 4)  # from corner to corner
            # Beside the ends, halos are all around both.
            length = sum(math.dist(a, b) for _, points, _ in halos for a, b in zip(points, points[1:]))
            lines = self.paths(script, "--halo=3", "--line-width=1")
            whole = sum(math.dist(a, b) for _, points, _ in lines for a, b in zip(points, points[1:]))
            self.assertAlmostEqual(whole - length, 4 * nearest, delta=1)

    def test_bodies_are_filled_from_far_to_near(self):
        colored = NEAR_AND_FAR.replace("stop\n", "repeat 0 1 colour near 10 20 30\nrepeat 0 1 colour far 200 100 0\nstop\n")
        elements = list(self.svg(colored, "--fill", "--hidden=dash").iter(SVG + "path"))
        self.assertEqual([(e.get("class"), e.get("data-body"), e.get("fill")) for e in elements],
                         [("fill", "far", "rgb(200,100,0)"), ("fill", "near", "rgb(10,20,30)"), ("hidden", "far", None),
                          ("visible", "far", None), ("visible", "near", None)])
        for name, points, closed in self.paths(colored, "--fill", kind="fill"):
            self.assertTrue(closed)
            self.assert_on_circle(points, (250 if name == "near" else 300, 250), 50, 0.1)
        self.assertEqual(self.paths(colored, kind="fill"), [])

    def test_fills_are_painted(self):
        if not CAIRO:
            return self.skipTest("cairo is not there")
        colored = NEAR_AND_FAR.replace("stop\n", "repeat 0 1 colour near 10 20 30\nrepeat 0 1 colour far 200 100 0\nstop\n")
        for kind in ("png", "pdf"):
            sizes = []
            for options in ((), ("--fill",)):
                self.output(kind, "-", "-o", self.path("f." + kind), *options, text=colored)
                sizes.append(self.read("f." + kind))
            self.assertNotEqual(*sizes)
        page = re.search(rb"stream\r?\n(.*?)endstream", sizes[1], re.DOTALL)[1]
        self.assertIn(b"0.784314 0.392157 0 rg", zlib.decompressobj().decompress(page))

    def test_perspective(self):
        # Of a sphere of radius r about the middle of the window, the eye D before it: D r / sqrt(D^2 - r^2).
        sphere = scene(("s", (200, 200, 200), (500, 500, 500)))
        paths = self.paths(sphere, "--perspective=600", "--size=1000")
        self.assertEqual(len(paths), 1)
        self.assert_on_circle(paths[0][1], (500, 500), 600 * 200 / math.sqrt(600**2 - 200**2), 0.1)
        # Around the eye nothing is drawn.
        self.assertEqual(self.paths(sphere, "--perspective=100"), [])

    def test_curves_where_bodies_meet(self):
        # Spheres of radius 100 about x = 440 and 560 meet at x = 500 in a circle of radius 80, seen from its side.
        pair = scene(("a", (100, 100, 100), (440, 500, 500)), ("b", (100, 100, 100), (560, 500, 500)))
        without, crossed = self.paths(pair, "--size=1000"), self.paths(pair, "--size=1000", "--crossings")
        self.assertEqual(len(crossed), len(without) + 1)
        [curve] = [points for name, points, _ in crossed if all(abs(x - 500) < 0.1 for x, _ in points)]
        self.assertAlmostEqual(min(y for _, y in curve), 420, delta=0.1)
        self.assertAlmostEqual(max(y for _, y in curve), 580, delta=0.1)

    def test_sticks(self):
        bone = scene(("bone", (10, 100, 10), (500, 300, 500)))
        [(name, points, _)] = self.paths(bone, "--sticks=axes", "--size=1000", kind="stick")
        self.assertEqual((name, sorted(points)), ("bone", [(500, 600), (500, 800)]))
        limbs = ("figure f 3 a b c\nellipsoid a 1 9 1\nellipsoid b 1 9 1\nellipsoid c 1 9 1\n"
                 "joint j a 0 100 0 b 0 -100 0\njoint k b 0 100 0 c 0 -100 0\n"
                 "repeat 0 1 moveto f b 500 500 500\nstop")
        paths = self.paths(limbs, "--sticks=joints", "--size=1000", kind="stick")
        # a and c from their centres to their joints, b from joint to joint.
        self.assertEqual({name: sorted(points) for name, points, _ in paths},
                         {"a": [(500, 600), (500, 700)], "b": [(500, 400), (500, 600)],
                          "c": [(500, 300), (500, 400)]})

    def test_nothing_is_drawn_as_a_stroke_without_extent(self):
        # A joint in the middle of its body, a body that is a point, and bodies by chance.
        still = ("figure f 2 a b\nellipsoid a 9 9 9\nellipsoid b 9 9 9\njoint j a 0 0 0 b 0 30 0\n"
                 "repeat 0 1 moveto f a 500 500 500\n")
        self.assertEqual([name for name, _, _ in self.paths(still + "stop", "--sticks=joints", kind="stick")], ["b"])
        root = self.svg(scene(("point", (0, 0, 0), (500, 500, 500))))
        self.assertEqual([e.get("data-body") for e in root.iter(SVG + "circle")], ["point"])
        self.assertEqual(list(root.iter(SVG + "path")), [])
        chance = random.Random(20261)
        bodies = [("b%d" % k, [chance.randint(0, 120) for _ in "xyz"], [chance.randint(200, 800) for _ in "xyz"])
                  for k in range(60)]
        for options in ([], ["--hidden=dash"], ["--crossings"], ["--perspective=900"]):
            count = 0
            for kind in ("visible", "hidden"):
                for name, points, _ in self.paths(scene(*bodies), *options, kind=kind):
                    count += 1
                    self.assertGreater(max(math.dist(points[0], p) for p in points), 0, (name, options))
            self.assertGreater(count, 60)

    def test_level_of_detail(self):
        crowd = scene(("dot", (1, 1, 1), (100, 100, 100)), ("line", (1, 50, 1), (300, 500, 100)),
                      ("body", (50, 60, 50), (600, 600, 100)))
        root = self.svg(crowd, "--lod=4", "--size=1000")
        [dot] = root.iter(SVG + "circle")
        self.assertEqual((dot.get("data-body"), float(dot.get("cx")), float(dot.get("cy"))), ("dot", 100, 900))
        shapes = {name: points for name, points, _ in self.paths(crowd, "--lod=4", "--size=1000")}
        self.assertEqual(sorted(shapes), ["body", "line"])
        self.assertEqual(sorted(shapes["line"]), [(300, 450), (300, 550)])
        self.assertGreater(len(shapes["body"]), 8)

    def test_numbers_of_any_size_are_numbers(self):
        huge = scene(("ball", (10**21, 100, 100), (500, 500, 500)))
        for style in ("boxes", "cylinders"):
            for line in self.svg(huge, "--outlines=" + style, "--size=500").iter(SVG + "path"):
                numbers = re.split("[MLZ ]+", line.get("d").strip("MZ"))
                self.assertTrue(all(math.isfinite(float(n)) for n in numbers), line.get("d"))

    def test_fewer_lines_than_outlines(self):
        ball = scene(("ball", (101, 100, 100), (500, 500, 500)))
        points = {}
        for style in ("limbs", "levels", "boxes", "contours", "cylinders"):
            root = self.svg(ball, "--outlines=" + style, "--size=1000")
            points[style] = [p for _, line, _ in self.paths(ball, "--outlines=" + style, "--size=1000") for p in line]
            share = {"boxes": (3 ** .5 - 1) / (3 ** .5 + 1), "cylinders": (2 ** .5 - 1) / (2 ** .5 + 1)}.get(style)
            error = float(root.get("data-error", "0"))
            if share:
                self.assertAlmostEqual(error, 101 * share, delta=1.01)
            else:
                self.assertLessEqual(error, 0 if style == "limbs" else 1)
            # What is drawn is as far from the ball's outline as that says at most.
            reach = max(math.dist(p, (500, 500)) for p in points[style])
            self.assertLess(abs(reach - 101), error + 1.2)
        self.assertGreater(len(points["contours"]), len(points["boxes"]))
        self.assertEqual(points["levels"], points["contours"])
        # So small, it is a dot, a stick or a box.
        dot = self.svg(scene(("ball", (.5, .4, .4), (500, 500, 500))), "--outlines=levels", "--size=1000")
        self.assertEqual(len(list(dot.iter(SVG + "circle"))), 1)
        stick = self.paths(scene(("ball", (50, .4, .4), (500, 500, 500))), "--outlines=levels", "--size=1000")
        self.assertEqual([len(line) for _, line, _ in stick], [2])
        box = self.paths(scene(("ball", (3, 3, 3), (500, 500, 500))), "--outlines=levels", "--size=1000")
        self.assertLessEqual(len(box), 12)

    def test_colors_and_names(self):
        text = scene(("a_b", (50, 60, 70), (500, 500, 500)), extra="repeat 0 1 colour a_b 10 20.6 300\n")
        [path] = self.svg(text, "--dialect=strict", "--colors").iter(SVG + "path")
        self.assertEqual((path.get("data-body"), path.get("stroke")), ("a_b", "rgb(10,21,255)"))
        [path] = self.svg(text, "--dialect=strict").iter(SVG + "path")
        self.assertEqual(path.get("stroke"), "rgb(0,0,0)")

    def test_what_is_off_the_page_is_cut(self):
        for body in (("huge", (1000000, 1000000, 1000000), (1000500, 500, 500)), ("away", (10, 10, 10), (-900, 0, 0)),
                     ("far", (10, 10, 10), (1000000000, 1000000000, 0))):
            for name, points, _ in self.paths(scene(body)):
                self.assertEqual(name, "huge")
                self.assertTrue(all(-10 < c < 510 for p in points for c in p), points)

    def test_numbered_files(self):
        for pattern, name in (("a.%03d.svg", "a.007.svg"), ("b##.svg", "b07.svg"), ("c.svg", "c.0007.svg")):
            self.output("svg", WALKER, "--frame=7-11x4", "-o", self.path(pattern))
            self.assertEqual(self.read(name), self.output("svg", WALKER, "--frame=7"))
            self.assertTrue(os.path.exists(self.path(name.replace("07", "11"))))
        self.assertEqual(len(os.listdir(self.folder)), 6)
        self.assertIn("need the name of a file", self.error("svg", WALKER, "--frame=all"))

    def test_the_first_frame_shown_is_the_default(self):
        text = "view 2 4\n" + NEAR_AND_FAR.replace("stop", "linear 0 4 moveby fnear near 1 1 1\nstop")
        self.assertIn("frame 3", self.svg(text).find(SVG + "title").text)

    def test_the_same_for_any_number_of_threads(self):
        for frames in ("24", "1-20"):
            one = self.output("text", WALKER, "--frame", frames, "--threads=1")
            for threads in ("2", "5"):
                self.assertEqual(self.output("text", WALKER, "--frame", frames, "--threads", threads), one)

    def test_pdf(self):
        if not CAIRO:
            return self.assertIn("cairo", self.error("pdf", WALKER, "-o", self.path("w.pdf")))
        self.output("pdf", WALKER, "--frame=1-5x2", "-o", self.path("w.pdf"), "--hidden=dash", "--halo=2")
        data = self.read("w.pdf")
        self.assertTrue(data.startswith(b"%PDF-"))
        objects = pdf_objects(data)
        self.assertEqual(len(re.findall(rb"/Type\s*/Page\b", objects)), 3)
        self.assertRegex(objects, rb"/MediaBox \[ 0 0 500 500 \]")
        self.assertTrue(data.rstrip().endswith(b"%%EOF"))
        self.assertTrue(self.output("pdf", WALKER).startswith(b"%PDF-"))

    def test_png(self):
        if not CAIRO:
            return self.assertIn("cairo", self.error("png", WALKER, "-o", self.path("w.png")))
        self.output("png", WALKER, "--size=99.5", "-o", self.path("w.png"))
        data = self.read("w.png")
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", data[16:24]), (100, 100))

    def pixels_of_png(self, data):
        """Rows of bytes, three a pixel, of a PNG without filters, each of whose chunks is whole."""
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        at, chunks = 8, []
        while at < len(data):
            size, kind = struct.unpack_from(">I4s", data, at)
            self.assertEqual(zlib.crc32(data[at + 4:at + 8 + size]), struct.unpack_from(">I", data, at + 8 + size)[0], kind)
            chunks.append((kind, data[at + 8:at + 8 + size]))
            at += 12 + size
        kinds = [kind for kind, _ in chunks]
        self.assertEqual((kinds[0], kinds[-1]), (b"IHDR", b"IEND"))
        width, height, *how = struct.unpack(">IIBBBBB", chunks[0][1])
        self.assertEqual(how, [8, 2, 0, 0, 0])
        raw = zlib.decompress(b"".join(part for kind, part in chunks if kind == b"IDAT"))
        self.assertEqual(len(raw), height * (1 + 3 * width))
        rows = [raw[k:k + 1 + 3 * width] for k in range(0, len(raw), 1 + 3 * width)]
        self.assertEqual({row[0] for row in rows}, {0})
        return [row[1:] for row in rows]

    @unittest.skipUnless(CAIRO, "built without cairo")
    def test_png_has_the_pixels_that_are_drawn(self):
        # A sphere of red, filled, on white.
        script = self.write("s.n", scene(("e", (200, 200, 200), (500, 500, 500)), extra="repeat 0 1 colour e 255 0 0\n"))
        self.output("png", script, "--size", "50", "--fill", "-o", self.path("s.png"))
        rows = self.pixels_of_png(self.read("s.png"))
        pixel = lambda x, y: tuple(rows[y][3 * x:3 * x + 3])
        self.assertEqual(pixel(0, 0), (255, 255, 255))
        self.assertEqual(pixel(49, 49), (255, 255, 255))
        self.assertEqual(pixel(25, 25), (255, 0, 0))
        self.output("film", script, "--size", "50", "--frame", "1", "-o", self.path("f.png"))
        rows = self.pixels_of_png(self.read("f.0001.png"))
        red, green, blue = pixel(25, 25)
        self.assertGreater(red, 100)
        self.assertEqual((green, blue), (0, 0))
        # A large picture, and a single pixel.
        self.output("png", WALKER, "--size", "8000", "-o", self.path("big.png"))
        rows = self.pixels_of_png(self.read("big.png"))
        self.assertEqual((len(rows), len(rows[0])), (8000, 24000))
        self.output("png", WALKER, "--size", "1", "-o", self.path("dot.png"))
        self.assertEqual(len(self.pixels_of_png(self.read("dot.png"))), 1)

    def test_fit_fills_the_page_but_for_its_margin(self):
        for options in ((), ("--perspective", "3000")):
            points = [p for _, path, _ in self.paths(NEAR_AND_FAR, "--fit", "--size", "400", "--tol", "0.01", *options)
                      for p in path]
            x, y = zip(*points)
            self.assertAlmostEqual(min(x), 20, delta=0.02)
            self.assertAlmostEqual(max(x), 380, delta=0.02)
            self.assertAlmostEqual(min(y) + max(y), 400, delta=0.04)
        # Of several frames, those of all.
        moving = ("figure f 1 b\nellipsoid b 10 10 10\nrepeat 0 1 moveto f b 100 500 500\n"
                  "linear 1 3 moveto f b 300 500 500\nstop\n")
        self.output("svg", "-", "--fit", "--frame", "all", "-o", self.path("m.svg"), text=moving)
        seen = []
        for frame in (1, 3):
            text = self.read("m.%04d.svg" % frame).decode()
            seen += [float(n) for d in re.findall(r' d="([^"]*)"', text) for n in re.findall(r"-?[\d.]+", d)[::2]]
        self.assertAlmostEqual(min(seen), 25, delta=0.3)
        self.assertAlmostEqual(max(seen), 475, delta=0.3)


class Scenes(Case):
    """Figures for other programs, read back with nothing but the formats' definitions."""

    def glb(self, *arguments, text=None):
        data = self.output("gltf", *arguments, text=text)
        magic, version, size, json_size, json_kind = struct.unpack_from("<4sIII4s", data)
        self.assertEqual((magic, version, size, json_kind), (b"glTF", 2, len(data), b"JSON"))
        scene = json.loads(data[20:20 + json_size])
        binary_size, binary_kind = struct.unpack_from("<I4s", data, 20 + json_size)
        self.assertEqual((binary_kind, binary_size), (b"BIN\0", len(data) - 28 - json_size))
        return scene, data[28 + json_size:]

    def numbers(self, scene, binary, accessor):
        accessor = scene["accessors"][accessor]
        view = scene["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        kind = {5126: "f", 5123: "H", 5125: "I"}[accessor["componentType"]]
        flat = struct.unpack_from("<%d%s" % (width * accessor["count"], kind), binary, view["byteOffset"])
        rows = [flat[i:i + width] for i in range(0, len(flat), width)]
        for c, (low, high) in enumerate(zip(accessor.get("min", ()), accessor.get("max", ()))):
            self.assertEqual((low, high), (min(r[c] for r in rows), max(r[c] for r in rows)))
        return rows

    def test_gltf_has_the_frames(self):
        script = ("figure f 2 a b\nellipsoid a 50 100 25\nellipsoid b 10 10 10\njoint j a 0 100 0 b 0 -10 0\n"
                  "repeat 0 1 moveto f a 500 250 100\nlinear 1 3 moveby f world 0 0 200\n"
                  "repeat 0 3 bendby b j world 90 z\nrepeat 0 1 colour a 255 0 0\nstop\n")
        scene, binary = self.glb("-", text=script)
        nodes = {node["name"]: node for node in scene["nodes"]}
        # In metres, right-handed: z is turned round.
        for got, wanted in zip(nodes["a"]["translation"], (1, 0.5, -0.2)):
            self.assertAlmostEqual(got, wanted, places=6)
        for got, wanted in zip(nodes["a"]["scale"], (0.1, 0.2, 0.05)):
            self.assertAlmostEqual(got, wanted, places=6)
        self.assertEqual(nodes["f"]["children"], [scene["nodes"].index(nodes["a"]), scene["nodes"].index(nodes["b"])])
        tracks = {}
        animation = scene["animations"][0]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times = [t for t, in self.numbers(scene, binary, sampler["input"])]
            self.assertEqual(len(times), 3)
            self.assertAlmostEqual(times[2], 2 / 25, places=6)
            name = scene["nodes"][channel["target"]["node"]]["name"]
            tracks[name, channel["target"]["path"]] = self.numbers(scene, binary, sampler["output"])
        self.assertEqual(set(tracks), {("a", "translation"), ("b", "translation"), ("b", "rotation")})
        self.assertAlmostEqual(tracks["a", "translation"][2][2], -0.6, places=6)
        # b turns by 90 degrees a frame; q and the next one are on one side, and |q| is 1.
        turns = tracks["b", "rotation"]
        for q, r in zip(turns, turns[1:]):
            self.assertAlmostEqual(sum(a * b for a, b in zip(q, r)), math.sqrt(0.5), places=6)
        # The mesh is the unit sphere, its corners against the clock from outside.
        primitive = scene["meshes"][nodes["a"]["mesh"]]["primitives"][0]
        points = self.numbers(scene, binary, primitive["attributes"]["POSITION"])
        corners = [i for i, in self.numbers(scene, binary, primitive["indices"])]
        for point in points:
            self.assertAlmostEqual(math.hypot(*point), 1, places=6)
        volume = 0
        for k in range(0, len(corners), 3):
            (a, b, c), (d, e, f), (g, h, i) = (points[corner] for corner in corners[k:k + 3])
            signed = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
            self.assertGreater(signed, 0)
            volume += signed / 6
        self.assertAlmostEqual(volume, 4 / 3 * math.pi, delta=0.05)
        color = scene["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        self.assertEqual(color, [1, 0, 0, 1])

    def test_obj_has_the_bodies(self):
        text = self.output("obj", "-", text=NEAR_AND_FAR).decode()
        objects = text.split("\no ")[1:]
        self.assertEqual([o.split("\n", 1)[0] for o in objects], ["near", "far"])
        first = 1
        for part, center in zip(objects, ((500, 500, -200), (600, 500, -800))):
            rows = [line.split() for line in part.splitlines()]
            points = [tuple(map(float, r[1:4])) for r in rows if r[0] == "v"]
            normals = [tuple(map(float, r[1:])) for r in rows if r[0] == "vn"]
            for point, normal in zip(points, normals):
                self.assertAlmostEqual(math.dist(point, center), 100, places=9)
                for p, n, c in zip(point, normal, center):
                    self.assertAlmostEqual(p, c + 100 * n, places=9)
            corners = [int(c.split("//")[0]) for r in rows if r[0] == "f" for c in r[1:]]
            self.assertEqual((min(corners), max(corners)), (first, first + len(points) - 1))
            first += len(points)

    @staticmethod
    def off(axes, point):
        """How far a point is from an ellipsoid about the origin: at its nearest point a^2 p / (a^2 + t), by bisection for t."""
        def value(t):
            return sum((a * p / (a * a + t)) ** 2 for a, p in zip(axes, point)) - 1
        low, high = -min(axes) ** 2 * (1 - 1e-12), sum(a * abs(p) for a, p in zip(axes, point)) + 1
        for _ in range(200):
            t = .5 * (low + high)
            low, high = (t, high) if value(t) > 0 else (low, t)
        return math.dist(point, [a * a * p / (a * a + t) for a, p in zip(axes, point)])

    def test_a_tolerance_decides_the_triangles(self):
        shapes = (("ball", (100, 100, 100), (500, 500, 200)), ("limb", (40, 200, 90), (600, 500, 800)), ("dot", (2, 2, 2), (9, 9, 9)))
        counts = {}
        for tol in (0.1, 1, 5, None):
            options = () if tol is None else ("--tol", str(tol))
            text = self.output("obj", "-", *options, text=scene(*shapes)).decode()
            points, counts[tol] = [], []
            for part, (name, axes, center) in zip(text.split("\no ")[1:], shapes):
                rows = [line.split() for line in part.splitlines()]
                points += [[float(v) for v in r[1:4]] for r in rows if r[0] == "v"]
                triangles = [[points[int(c.split("//")[0]) - 1] for c in r[1:]] for r in rows if r[0] == "f"]
                counts[tol].append(len(triangles))
                for triangle in triangles[::max(1, len(triangles) // 400)]:
                    for weights in ((1 / 3, 1 / 3, 1 / 3), (.5, .5, 0), (0, .5, .5), (.5, 0, .5), (1, 0, 0)):
                        at = [sum(w * corner[k] for w, corner in zip(weights, triangle)) - (center[k] if k < 2 else -center[k])
                              for k in range(3)]
                        most = {1: 1e-9}.get(max(weights), tol if tol else .005 * max(axes))
                        self.assertLessEqual(self.off(axes, at), most * (1 + 1e-9), (name, tol, weights))
            # Without it, 24 x 48 cells; with it, small bodies have fewer triangles than large ones.
        self.assertEqual(counts[None], [2208] * 3)
        for k in range(2):
            self.assertGreater(counts[.1][k], counts[1][k])
            self.assertGreater(counts[1][k], counts[5][k])
        self.assertEqual(counts[5][2], 2 * 3 * 6)
        self.assertEqual(counts[5][0], 2 * 9 * 20)

    def test_the_tolerance_of_gltf_holds_in_all_frames(self):
        script = ("figure f 2 a b\nellipsoid a 10 10 10\nellipsoid b 10 10 10\njoint j a 0 10 0 b 0 -10 0\n"
                  "linear 0 4 groell a 10 10 10\nrepeat 0 1 colour a 255 0 0\nrepeat 0 1 colour b 255 0 0\nstop\n")
        loose, _ = self.glb("-", text=script)
        self.assertEqual(len(loose["meshes"]), 1)
        self.assertEqual(loose["accessors"][1]["count"], 3 * 2208)
        scene_, binary = self.glb("-", "--tol", "0.5", text=script)
        self.assertEqual((len(scene_["meshes"]), len(scene_["materials"])), (2, 1))
        nodes = {node["name"]: node for node in scene_["nodes"]}
        for name, radius in (("a", 100), ("b", 10)):
            primitive = scene_["meshes"][nodes[name]["mesh"]]["primitives"][0]
            points = self.numbers(scene_, binary, primitive["attributes"]["POSITION"])
            corners = [i for i, in self.numbers(scene_, binary, primitive["indices"])]
            worst = 0
            for k in range(0, len(corners), 3):
                middle = [sum(points[c][i] for c in corners[k:k + 3]) / 3 for i in range(3)]
                worst = max(worst, radius * (1 - math.hypot(*middle)))
            self.assertLessEqual(worst, .5)
            self.assertGreater(worst, .1)
        # More points than two bytes count.
        fine, binary = self.glb("-", "--tol", "0.003", text=script)
        kinds = {fine["accessors"][mesh["primitives"][0]["indices"]]["componentType"] for mesh in fine["meshes"]}
        self.assertEqual(kinds, {5123, 5125})

    def test_a_tolerance_that_is_none(self):
        for format in ("obj", "gltf"):
            for value in ("0", "-1", "nan", "inf", "x"):
                self.assertIn("must be a number above 0", self.error(format, "-", "--tol", value, text=NEAR_AND_FAR))
            self.assertIn("tol=1e-09: is too small for near: must take at most 4096 steps around a body",
                          self.error(format, "-", "--tol", "1e-9", text=NEAR_AND_FAR))
        self.assertIn("--tol", self.error("vtp", "-", "--tol", "1", text=NEAR_AND_FAR))

    def test_other_programs_read_them(self):
        if not shutil.which("assimp"):
            self.skipTest("assimp is not there")
        self.output("gltf", WALKER, "-o", self.path("walk.glb"))
        self.output("obj", WALKER, "-o", self.path("walk.obj"))
        for name, wanted in (("walk.glb", ("Animations:           1", "Meshes:               4")), ("walk.obj", ("Meshes:               17",))):
            result = subprocess.run(["assimp", "info", self.path(name)], capture_output=True, timeout=100, text=True)
            self.assertEqual(result.returncode, 0, result.stdout)
            for line in wanted:
                self.assertIn(line.split(), [row.split() for row in result.stdout.splitlines()])


class Film(Case):
    def test_ffmpeg_makes_a_film_of_all_frames(self):
        if not shutil.which("ffprobe"):
            self.skipTest("ffmpeg is not there")
        self.output("film", WALKER, "-o", self.path("walk.mp4"), "--size", "101", "--frame", "1-12", "--fps", "12.5")
        said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                               "stream=width,height,nb_read_frames,r_frame_rate", "-of", "default=nw=1", self.path("walk.mp4")],
                              capture_output=True, text=True, timeout=100).stdout.split()
        self.assertEqual(sorted(said), ["height=102", "nb_read_frames=12", "r_frame_rate=25/2", "width=102"])
        self.assertEqual(os.listdir(self.folder), ["walk.mp4"])

    @unittest.skipUnless(CAIRO, "built without cairo")
    def test_without_ffmpeg_frames_are_pictures(self):
        empty = self.path("empty")
        os.mkdir(empty)
        result = subprocess.run([PROGRAM, "film", WALKER, "-o", self.path("walk.mp4"), "--size", "40", "--frame", "3-4"],
                                capture_output=True, timeout=100, env={"PATH": empty})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(b"ffmpeg is not there", result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), ["empty", "walk.0003.png", "walk.0004.png"])
        self.output("film", WALKER, "-o", self.path("p.png"), "--size", "40", "--frame", "3")
        self.assertEqual(self.read("p.0003.png"), self.read("walk.0003.png"))

    @unittest.skipUnless(CAIRO, "built without cairo")
    def test_textures_lie_beside_the_script(self):
        script = self.write("s.n", scene(("e", (400, 400, 400), (500, 500, 500)), extra="repeat 0 1 texture e map 0 0\n"))
        film = ("film", script, "-o", self.path("f.png"), "--size", "20", "--frame", "1", "--style")
        self.output(*film, "shaded")
        plain = self.read("f.0001.png")
        result = subprocess.run([PROGRAM, *film, "textured"], capture_output=True, timeout=100, text=True)
        self.assertEqual((result.returncode, self.read("f.0001.png")), (0, plain))
        self.assertIn("the texture map is not there", result.stderr)
        # Green on the left, blue on the right; as PPM and as PNG.
        rows = [b"\x00\xff\x00" * 8 + b"\x00\x00\xff" * 8] * 8
        chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16, 8, 8, 2, 0, 0, 0)) +
               chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
        pictures = []
        for name, data in (("map.ppm", b"P6\n# a comment\n16 8\n255\n" + b"".join(rows)), ("map.png", png)):
            self.write(name, data)
            self.output(*film, "textured")
            pictures.append(self.read("f.0001.png"))
            os.remove(self.path(name))
        self.assertEqual(*pictures)
        self.write("map.ppm", b"P6 16 8 255\n" + b"".join(row[24:] + row[:24] for row in rows))
        self.output(*film, "textured")
        self.assertNotEqual(self.read("f.0001.png"), pictures[0])
        os.remove(self.path("map.ppm"))
        self.assertNotEqual(pictures[0], plain)
        for wrong in (b"P6 16 8 255 ", b"P6 16", b"P5 1 1 255 a", b"P6 99999999 9 255 ", b"P6 1 1 65535 aaaaaa", b"", png[:60], b"P6 #"):
            self.write("map", wrong)
            result = subprocess.run([PROGRAM, *film, "textured"], capture_output=True, timeout=100, text=True)
            self.assertEqual((result.returncode, self.read("f.0001.png")), (0, plain), wrong)
            self.assertIn("cannot be read", result.stderr)

    @unittest.skipUnless(CAIRO, "built without cairo")
    def test_solids_heights_and_levels_are_drawn(self):
        script = self.write("s.n", scene(("e", (400, 300, 200), (500, 500, 500))))
        ppm = lambda brightness: b"P6 64 32 255\n" + b"".join(bytes([brightness(x)] * 3) for _ in range(32) for x in range(64))
        self.write("waves.ppm", ppm(lambda x: 60 * (x % 4)))
        self.write("level.ppm", ppm(lambda x: 100))

        def frame(*options):
            self.output("film", script, "-o", self.path("f.png"), "--size", "60", "--frame", "1", *options)
            return self.read("f.0001.png")

        plain = frame()
        solids = [frame("--solid", word) for word in ("wood", "marble", "checker")]
        self.assertEqual(len({plain, *solids}), 4)
        self.assertEqual(frame("--solid", "none"), plain)
        # Eight rings to a scale, as the presets are.
        self.assertNotEqual(frame("--solid", "wood", "--solid-scale", "50"), solids[0])
        self.assertNotEqual(frame("--solid", "wood", "--solid-samples", "1"), solids[0])
        own = ("--solid", "formula", "--red", "own_red", "--green", "own_green")
        self.assertEqual(frame(*own), plain)
        self.assertNotEqual(frame(*own, "--blue", "k+x/scale", "--let", "k=0.5"), plain)
        lit = frame("--lighting", "blinn")
        waves = ("--lighting", "blinn", "--bump", self.path("waves.ppm"))
        self.assertEqual(frame(*waves[:3], self.path("level.ppm")), lit)
        self.assertEqual(frame(*waves, "--bump-scale", "0"), lit)
        self.assertNotEqual(frame(*waves), lit)
        outline = ("--style", "outline", "--outlines")
        lines = {word: frame(*outline, word) for word in ("limbs", "boxes", "contours", "cylinders")}
        self.assertEqual(len(set(lines.values())), 4)
        self.assertEqual(frame("--style", "outline"), lines["limbs"])
        # An error of .268 of 24 pixels is that of a box.
        self.assertEqual(frame(*outline, "levels", "--simple-tol", "7"), lines["boxes"])
        self.assertEqual(frame(*outline, "levels", "--simple-tol", "1"), lines["contours"])

    @unittest.skipUnless(CAIRO, "built without cairo")
    def test_bodies_that_cylinders_leave_out_are_named(self):
        script = self.write("s.n", scene(("far", (40, 30, 20), (500, 500, 500)), ("near", (40, 30, 20), (500, 500, 100))))
        for command in (["film", "--style", "outline"], ["svg"]):
            result = subprocess.run([PROGRAM, command[0], script, "-o", self.path("f.png"), "--frame", "1", "--outlines",
                                     "cylinders", "--perspective", "400", *command[1:]], capture_output=True, timeout=100, text=True)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("frame 1: cylinders before the near plane are left out: near", result.stderr, command)

    def test_looks_that_mean_nothing_are_refused(self):
        bad = self.write("bad.ppm", b"P6 9")
        for options, said in ((["--solid", "iron"], "--solid=iron: must be one of"), (["--solid-scale", "9"], "--solid-scale=9: must be given with solid"),
                              (["--solid", "wood", "--solid-scale", "nan"], "--solid-scale=nan: must be a number from 0.001 to 1e+06"),
                              (["--solid", "wood", "--solid-samples", "17"], "--solid-samples=17: must be an integer from 1 to 16"),
                              (["--solid", "wood", "--solid-samples", "2147483648"], "--solid-samples"),
                              (["--red", "x"], "--red=x: is of solid=formula alone"), (["--solid", "formula", "--let", "k="], "--let"),
                              (["--solid", "formula", "--green", "x+"], "--green=x+: column 3"),
                              (["--solid", "formula", "--blue", "nothing"], "--blue"),
                              (["--bump-scale", "3"], "--bump-scale=3: must be given with bump"),
                              (["--bump", self.path("none.ppm")], "there is no such file"), (["--bump", bad], "is cut off"),
                              (["--bump", bad, "--bump-scale", "inf"], "--bump-scale=inf"),
                              (["--style", "stick", "--solid", "wood"], "--solid=wood: is of styles shaded and textured alone"),
                              (["--outlines", "boxes"], "--outlines=boxes: is of style outline alone"),
                              (["--style", "outline", "--simple-tol", "3"], "--simple-tol=3: must be given with"),
                              (["--style", "outline", "--outlines", "levels", "--simple-tol", "0"], "--simple-tol=0: must be a number")):
            said_here = self.error("film", WALKER, "--frame", "1", "-o", self.path("x.png"), *options)
            self.assertIn(said, said_here)
            self.assertLessEqual(len(said_here), 500)
        self.assertEqual(os.listdir(self.folder), ["bad.ppm"])

    def test_what_cannot_be_written_is_said(self):
        self.assertIn("--output", self.error("film", WALKER))
        if shutil.which("ffmpeg"):
            self.assertIn("must end in .mp4", self.error("film", WALKER, "-o", self.path("walk.txt")))
        self.assertEqual(os.listdir(self.folder), [])


class Motions(Case):
    ARM = ("HIERARCHY ROOT arm { OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation\n"
           "End Site { OFFSET 0 10 0 } } MOTION Frames: 2 Frame Time: 0.1\n0 0 0\n90 0 0\n")

    def test_a_motion_goes_wherever_scripts_go(self):
        path = self.write("arm.bvh", self.ARM)
        self.assertEqual(self.output("check", path), b"")
        self.assertIn(b"ellipsoids     1\n", self.output("stats", path))
        frames = self.output("frames", path).decode().splitlines()
        self.assertEqual(len([line for line in frames if "arm" in line]), 2)
        again = self.write("arm.3", "\n".join(frames) + "\n")
        self.assertEqual(self.output("frames", again).decode().splitlines(), frames)
        self.output("svg", path, "--frame", "2", "-o", self.path("arm.svg"))
        self.assertIn("line 2", self.error("check", self.write("bad.bvh", self.ARM.replace("End Site", "Nob"))))
        self.assertIn("cannot read", self.error("check", self.path("none.cif")))

    def test_every_script_of_the_tutorial_runs(self):
        with open(os.path.dirname(WALKER) + "/README.md", encoding="utf-8") as file:
            scripts = re.findall(r"```nudes\n(.*?)```", file.read(), re.DOTALL)
        self.assertEqual(len(scripts), 5)
        for script in scripts:
            for dialect in ("classic", "strict"):
                self.assertEqual(self.output("check", "-", "--dialect", dialect, text=script), b"")
                self.output("svg", "-", "--dialect", dialect, "--frame", "1", text=script)
        # The walker of the fourth goes 4 times 70 units ahead, standing on the ground.
        frames = self.output("frames", "-", text=scripts[3]).decode().split("\n")
        bodies = [line.split() for line in frames if " body " in line + " "]
        self.assertEqual(int(bodies[-1][3]) - int(bodies[0][3]), 2800)


class WholeFiles(Case):
    """A file is there in full, or as it was before."""
    FAILS_LATE = "figure f 1 a\nellipsoid a 9 9 9\nlinear 0 9 moveby f a 1 0 0\nrepeat 7 8 grofig f a 0 1 1\nstop"
    ENDLESS = "figure f 1 a\nellipsoid a 9 9 9\nlinear 0 900000000 moveby f a 1 0 0\nstop"
    COMMANDS = ("frames", "text") + (("pdf",) if CAIRO else ())

    def test_a_script_that_fails_late_leaves_the_old_file(self):
        for command in self.COMMANDS:
            self.write("out", "old")
            self.assertIn("a factor is zero",
                          self.error(command, "-", "-o", self.path("out"), "--frame=all", text=self.FAILS_LATE))
            self.assertEqual(self.read("out"), b"old", command)
            self.assertEqual(os.listdir(self.folder), ["out"], command)
            os.remove(self.path("out"))
            self.error(command, "-", "-o", self.path("out"), "--frame=all", text=self.FAILS_LATE)
            self.assertEqual(os.listdir(self.folder), [], command)

    def test_interrupted_it_leaves_the_old_file_and_nothing_else(self):
        script = self.write("endless.n", self.ENDLESS)
        for command in self.COMMANDS:
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                self.write("out", "old")
                process = subprocess.Popen([PROGRAM, command, script, "-o", self.path("out"), "--frame=all"],
                                           stderr=subprocess.DEVNULL)
                # It is at work when something is in the folder that grows.
                deadline = time.monotonic() + 60
                while time.monotonic() < deadline and all(
                        os.path.getsize(self.path(name)) == 0 for name in os.listdir(self.folder)
                        if name not in ("out", "endless.n")):
                    self.assertIsNone(process.poll())
                    time.sleep(0.01)
                process.send_signal(number)
                self.assertEqual(process.wait(60), -number)
                self.assertEqual(self.read("out"), b"old", (command, number))
                self.assertEqual(sorted(os.listdir(self.folder)), ["endless.n", "out"], (command, number))

    def test_what_is_replaced_keeps_its_rights_and_links_lead_where_they_did(self):
        self.write("real", "old")
        os.chmod(self.path("real"), 0o640)
        os.symlink("real", self.path("link"))
        self.output("frames", WALKER, "-o", self.path("link"))
        self.assertTrue(os.path.islink(self.path("link")))
        self.assertEqual(self.read("real"), self.output("frames", WALKER))
        self.assertEqual(os.stat(self.path("real")).st_mode & 0o777, 0o640)
        self.assertEqual(sorted(os.listdir(self.folder)), ["link", "real"])


class Text(Case):
    SPHERE = scene(("s", (400, 400, 400), (500, 500, 500)))

    def assert_circle(self, dots, size):
        self.assertGreater(len(dots), 2 * size)
        for x, y in dots:
            distance = math.dist((x + 0.5, y + 0.5), (size / 2, size / 2))
            self.assertLess(abs(distance - 0.4 * size), 1.2)

    def test_braille(self):
        lines = self.output("text", "-", "--width=30", text=self.SPHERE).decode().splitlines()
        self.assertEqual(lines[0], "frame 1")
        self.assertEqual(len(lines), 1 + 15)
        # Unicode's numbering: dots 1 to 3 and 7 are the left column, 4 to 6 and 8 the right one.
        place = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)]
        dots = []
        for row, line in enumerate(lines[1:]):
            self.assertLessEqual(len(line), 30)
            for column, character in enumerate(line):
                bits = 0 if character == " " else ord(character) - 0x2800
                self.assertTrue(0 <= bits < 256)
                dots += [(2 * column + x, 4 * row + y) for k, (x, y) in enumerate(place) if bits >> k & 1]
        self.assert_circle(dots, 60)

    def test_ascii(self):
        lines = self.output("text", "-", "--characters=ascii", text=self.SPHERE).decode("ascii").splitlines()
        self.assertEqual(len(lines), 1 + 40)
        dots = []
        for row, line in enumerate(lines[1:]):
            for column, character in enumerate(line):
                dots += [(column, 2 * row)] * (character in "':") + [(column, 2 * row + 1)] * (character in ".:")
        self.assert_circle(dots, 80)


class Stats(Case):
    def test_counts(self):
        lines = dict(re.split(r"  +", line) for line in self.output("stats", WALKER).decode().splitlines())
        counts = {name: int(lines[name]) for name in ("frames", "figures", "ellipsoids", "joints", "subroutines")}
        self.assertEqual(counts, {"frames": 49, "figures": 1, "ellipsoids": 17, "joints": 16, "subroutines": 3})
        self.assertGreater(int(lines["actions"]), 40)
        self.assertRegex(lines["performed in"], r"^[\d.e-]+ ms$")


class BadInput(Case):
    def test_options(self):
        for options, said in (
                ([], "subcommand"), (["draw", WALKER], "subcommand"), (["svg"], "SCRIPT"),
                (["svg", WALKER, "--frame=0x"], "must be N"), (["svg", WALKER, "--frame=5-1"], "must be N"),
                (["svg", WALKER, "--frame=-1"], "must be N"),
                (["svg", WALKER, "--frame=9999999999"], "must be N"),
                (["svg", WALKER, "--frame=1-4x0"], "must be N"), (["svg", WALKER, "--frame=900"], "0 to 49"),
                (["svg", WALKER, "--tol=0"], "--tol"), (["svg", WALKER, "--tol=nan"], "--tol"),
                (["svg", WALKER, "--tol="], "--tol"), (["svg", WALKER, "--size=20000"], "--size"),
                (["svg", WALKER, "--size=inf"], "--size"), (["svg", WALKER, "--perspective=0"], "--perspective"),
                (["svg", WALKER, "--threads=-1"], "--threads"), (["text", WALKER, "--width=0"], "--width"),
                (["svg", WALKER, "--threads=1.5"], "--threads"),
                (["svg", WALKER, "--hidden=maybe"], "--hidden"), (["check", WALKER, "--dialect=new"], "--dialect"),
                (["svg", WALKER, "--viewport=1,2,3"], "--viewport=1,2,3: must be x,y,a,b"),
                (["svg", WALKER, "--viewport="], "--viewport"),
                (["text", WALKER, "--viewport=.5,.5,nan,.5"], "must be x,y,a,b"),
                (["png", WALKER, "--viewport=.5,.5,.5,0"], "the half-axes, from 1e-04 to 10"),
                (["film", WALKER, "--viewport=.5,.5,.5,.5", "-o", "x.png"], "--style outline and stick"),
                (["svg", WALKER, "--outlines=men"], '--outlines: "men": must be one of boxes, contours, cylinders, levels, limbs'), (["svg", WALKER, "--simple-tol=0"], "--simple-tol"),
                (["svg", WALKER, "--simple-tol=nan"], "--simple-tol"), (["svg", WALKER, "--simple-tol=1e7"], "--simple-tol"),
                (["svg", WALKER, "--nothing"], "--nothing")):
            self.assertIn(said, self.error(*options), options)

    def test_numbers_are_what_the_help_says(self):
        """Both ends of every range are taken, and one step beyond is refused in the words of the help; what it shows as
        the default draws the same."""
        ball = self.write("ball.n", scene(("ball", (100, 100, 100), (500, 500, 500))))
        row = re.compile(r"--([a-z-]+) NUMBER(?: \[(.*)\])? +(.*)")
        compared = 0
        for command in ("svg", "text"):
            plain = self.output(command, ball)
            # An option may stand on one line and what it does on the next; long ones go on below.
            text = re.sub(r"\n {10,}", " ", self.output(command, "--help").decode())
            for name, standard, what in row.findall(text):
                what = re.sub(" +", " ", what)
                found = re.search(r": an? (number|integer) (?:(above)|of at least|from) ([\d.e+-]+)(?: to ([\d.e+-]+))?$", what)
                self.assertIsNotNone(found, (name, what))
                kind, above, least, most = found.groups()
                step = 1 if kind == "integer" else 1e-6
                for end, outwards in ((least, -1), (most, 1)):
                    if end is None:
                        continue
                    if name not in ("size", "threads", "width") or outwards < 0:
                        result = self.run_program(command, ball, "--%s=%s" % (name, end))
                        self.assertEqual(result.returncode == 0, not above, (name, end))
                    beyond = "--%s=%r" % (name, float(end) + outwards * step * max(1, abs(float(end))))
                    self.assertIn("must be " + what.rpartition(": ")[2], self.error(command, ball, beyond))
                for none in ("nan", "inf", "-inf", ""):
                    self.error(command, ball, "--%s=%s" % (name, none))
                if standard and (command, name) != ("text", "tol"):
                    self.assertEqual(self.output(command, ball, "--%s=%s" % (name, standard)), plain, name)
                compared += 1
        self.assertEqual(compared, 8 + 5)

    def test_files(self):
        self.assertIn("cannot read", self.error("check", self.path("none.n")))
        self.assertIn("cannot read", self.error("svg", self.folder))
        self.assertIn("none.n", self.error("svg", WALKER, "--library", self.path("none.n")))
        for command in ("frames", "svg", "text") + (("pdf", "png") if CAIRO else ()):
            self.assertIn("cannot write", self.error(command, WALKER, "-o", self.path("no/folder/out")))
            if os.path.exists("/dev/full"):
                self.assertRegex(self.error(command, WALKER, "-o", "/dev/full"), "cannot write|writing")

    def test_scripts(self):
        self.assertIn("shows no frame", self.error("text", "-", "--frame=all", text="stop"))
        self.assertIn("stdin:1:1", self.error("frames", "-", text="nonsense\nstop"))
        self.assertIn("divi", self.error("frames", "-", text="variables 1 v\nrepeat 0 1 divide v 1 0\nstop"))
        line = "subroutine s\nrepeat 0 1 call s\nendsub s\ncall 0 1 s\nstop"
        self.assertIn("call each other", self.error("frames", "-", text=line))
        self.run_program("svg", "-", text=scene(("z", (0, 0, 0), (500, 500, 500))))
        self.run_program("svg", "-", text=scene(("n", (1000000, "0.000001", 1), (500, 500, 500))))

    def test_scripts_cut_short_and_spoiled(self):
        with open(WALKER, "rb") as file:
            script = file.read()
        seed = 20260
        chance = random.Random(seed)
        for k in range(40):
            spoiled = bytearray(script)
            for _ in range(chance.randint(1, 4)):
                spoiled[chance.randrange(len(spoiled))] = chance.randrange(256)
            text = bytes(spoiled) if k % 2 else script[:chance.randrange(len(script))]
            result = self.run_program("text", "-", "--frame=all", "--width=10", text=text)
            if result.returncode:
                self.assertTrue(result.stderr.splitlines()[-1].startswith(b"anamorph-figure: "), (seed, k))


if __name__ == "__main__":
    unittest.main(verbosity=1)
