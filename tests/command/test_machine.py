# SPDX-License-Identifier: Apache-2.0
"""anamorph-machine: programs are assembled and run, and what they draw is what they say, worked out by hand."""
import csv
import math
import os
import re
import struct
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

PROGRAM = os.environ["ANAMORPH_MACHINE"]
PAGE = os.path.join(os.environ["ANAMORPH_DOCS"], "machines.md")


def run(*arguments, text=""):
    result = subprocess.run([PROGRAM, *arguments], input=text.encode(), capture_output=True, timeout=100)
    return result.returncode, result.stdout, result.stderr.decode()


def pixels(data):
    """Rows from the top, of (r, g, b)."""
    header, size, scale, values = data.split(b"\n", 3)
    assert header == b"PF" and scale == b"-1"
    width, height = map(int, size.split())
    floats = struct.unpack("<%df" % (3 * width * height), values)
    rows = [[floats[3 * (y * width + x):][:3] for x in range(width)] for y in range(height)]
    return rows[::-1]


def picture(rows, scale=b"-1"):
    order = "<" if scale == b"-1" else ">"
    values = [v for row in rows[::-1] for pixel in row for v in pixel]
    return b"PF\n%d %d\n%s\n" % (len(rows[0]), len(rows), scale) + struct.pack("%s%df" % (order, len(values)), *values)


class Machine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, data):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    def test_assembles_and_counts(self):
        status, out, error = run("assemble", "-", text="ps.2.0\ndcl t0.rg ; where\nmov r0, t0.x\nmov oC0, r0\n")
        self.assertEqual((status, error), (0, ""))
        self.assertEqual(out.decode(), "ps_2_0\ndcl t0.xy\nmov r0, t0.x\nmov oC0, r0\n"
                         "; 2 of 64 slots of arithmetic instructions, 0 of 32 texture instructions\n")
        self.assertEqual(run("assemble", "-", text=out.decode())[1], out)

    def test_runs_for_every_pixel(self):
        text = "ps_2_0\ndcl t0\nmul r0, t0, c1\nadd r0, r0, c0\nmov oC0, r0\n"
        status, out, error = run("run", "-", "--size", "4x2", "--constant", "c1=2,4,1,1", "--constant",
                                 "c0=0,0,-0.5,0", text=text)
        self.assertEqual((status, error), (0, ""))
        self.assertEqual(pixels(out), [[((2 * x + 1) / 4, 4 * (y + 0.5) / 2, -0.5) for x in range(4)] for y in range(2)])

    def test_precision_is_that_of_the_registers(self):
        text = "ps_2_0\ndef c0, 0.1, 9, 1e-5, 0\nmov oC0, c0\n"
        for name, wanted in (("float32", (0.1, 9, 1e-5)), ("float24", (104858 / 1048576, 9, None)),
                             ("fixed16", (410 / 4096, 8 - 1 / 4096, 0)), ("float16", (0.0999755859375, 9, None))):
            _, out, _ = run("run", "-", "--size", "1", "--arithmetic", name, text=text)
            for got, value in zip(pixels(out)[0][0], wanted):
                if value is not None:
                    self.assertAlmostEqual(got, value, delta=1e-8)

    def test_reads_textures(self):
        text = "ps_2_0\ndcl t0.xy\ndcl_2d s2\ntexld r0, t0, s2\nmov oC0, r0\n"
        rows = [[(x, y, x * y) for x in range(4)] for y in range(4)]
        for scale in (b"-1", b"1"):
            path = self.write("t.pfm", picture(rows, scale))
            _, out, error = run("run", "-", "--size", "4", "--texture", "s2=" + path, text=text)
            self.assertEqual(error, "")
            self.assertEqual(pixels(out), rows)
        # Between texels, and as the outer ones beyond them.
        _, out, _ = run("run", "-", "--size", "8", "--texture", "s2=" + path, text=text)
        self.assertEqual([p[0] for p in pixels(out)[3]], [0, 0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3])

    def test_schedules(self):
        def schedule(*arguments):
            status, out, error = run("schedule", *arguments)
            self.assertEqual((status, error), (0, ""))
            rows = list(csv.DictReader(out.decode().splitlines()))
            self.assertEqual(list(rows[0]), ["stage", "cycles", "ms", "utilisation", "starved_ms", "blocked_ms",
                                             "bytes_read", "bytes_written", "buffer_bytes"])
            table = {row.pop("stage"): {name: float(cell) for name, cell in row.items()} for row in rows}
            # What is drawn is shown at ticks of 33 ms, what lies before it needs none.
            shown = max(table[stage]["ms"] for stage in ("address controller", "pixel processor", "output"))
            frame = max([33 * math.ceil(shown / 33)] + [row["ms"] for row in table.values()])
            for row in table.values():
                self.assertLessEqual(row["utilisation"], 1)
                self.assertAlmostEqual(row["ms"] + row["starved_ms"] + row["blocked_ms"], frame)
            self.assertEqual(table["address controller"]["bytes_read"], table["micro-coded processors"]["bytes_written"])
            return table
        table = schedule()
        self.assertEqual(table["micro-coded processors"]["cycles"], 2048 * (1 + 21 + 32) + 2 * 4096 + 256)
        drawing = table["pixel processor"]
        self.assertAlmostEqual(drawing["blocked_ms"], 33 - 26.2144)
        self.assertEqual([drawing[key] for key in ("cycles", "ms", "starved_ms", "bytes_read", "bytes_written", "buffer_bytes")],
                         [512 * 512, 26.2144, 0, 512 * 512 * 12, 512 * 512 * 3, 512 * 512 * 6])
        small = schedule("--machine", "oka-1987:block=4")
        self.assertEqual(small["micro-coded processors"]["utilisation"], 1)
        self.assertGreater(small["pixel processor"]["starved_ms"], 20)
        large = schedule("--picture", "1024", "--size", "1024")
        self.assertGreater(large["pixel processor"]["ms"], 100)
        self.assertAlmostEqual(large["output"]["ms"] + large["output"]["starved_ms"], 132)

    def test_frames_are_shown_at_ticks(self):
        status, out, error = run("schedule", "--frames", "--picture", "1024", "--size", "1024")
        self.assertEqual((status, error), (0, ""))
        rows = list(csv.DictReader(out.decode().splitlines()))
        self.assertEqual(list(rows[0]), ["frame", "drawn_ms", "shown_ms", "ticks_late"])
        for before, row in zip(rows, rows[1:]):
            shown = float(row["shown_ms"])
            self.assertAlmostEqual(shown / 33, round(shown / 33))
            self.assertLessEqual(0, shown - float(row["drawn_ms"]))
            self.assertEqual(int(row["ticks_late"]), round((shown - float(before["shown_ms"])) / 33) - 1)
        self.assertEqual(rows[-1]["ticks_late"], "3")

    def test_bumps_cost_products(self):
        def processors(*more):
            status, out, error = run("schedule", "--picture", "8", "--size", "8", "--machine",
                                     "oka-1987:buckets=1,sort_cycles=0,processors=1", *more)
            self.assertEqual((status, error), (0, ""))
            rows = {row["stage"]: row for row in csv.DictReader(out.decode().splitlines())}
            return float(rows["micro-coded processors"]["cycles"]), float(rows["host computer"]["bytes_written"])
        with tempfile.TemporaryDirectory() as folder:
            bumps = os.path.join(folder, "bumps.csv")
            with open(bumps, "w") as file:
                file.write("0.5,0.5,0.1,0.1,0,0,0.001\n" * 50)
            plain, bumpy = processors(), processors("--deformations", bumps)
            # Seven products, an exponential of four, and seven numbers of four bytes, for each of fifty.
            self.assertEqual(bumpy[0] - plain[0], 50 * (7 + 4))
            self.assertEqual(bumpy[1] - plain[1], 50 * 7 * 4)
            self.assertIn("bumps.none: cannot be read", run("schedule", "--deformations", "bumps.none")[2])

    def test_cycles_are_those_that_the_reference_says(self):
        """The formulas of the page's table, with the numbers of its defaults."""
        for keys, picture in [({}, 512), ({"block": 4}, 512), ({"processors": 3, "multipliers": 4, "buckets": 9, "sort_cycles": 3}, 300),
                              ({"surface_multiplies": 7, "division_cycles": 5, "pixel_units": 3, "block": 16}, 200),
                              ({"host_cycles": 123, "block_cycles": 11, "segment_cycles": 5, "segment": 16}, 256)]:
            value = dict({"processors": 2, "multipliers": 1, "surface_multiplies": 1, "division_cycles": 16,
                          "buckets": 256, "sort_cycles": 2,
                          "host_cycles": 20000, "block_cycles": 8, "segment_cycles": 4, "pixel_units": 1}, **keys)
            machine = ",".join("%s=%s" % item for item in keys.items())
            status, out, error = run("schedule", "--picture", str(picture), "--machine", "oka-1987" + (machine and ":") + machine)
            self.assertEqual((status, error), (0, ""))
            stages = {row["stage"]: {key: float(x) for key, x in row.items() if key != "stage"}
                      for row in csv.DictReader(out.decode().splitlines())}
            blocks = stages["micro-coded processors"]["bytes_written"] / 24
            pixels = stages["pixel processor"]["bytes_written"] / 3
            cycles = math.ceil((value["surface_multiplies"] + 21) / value["multipliers"]) + 2 * value["division_cycles"]
            if not keys:
                self.assertEqual((cycles, blocks), (54, (picture / 8) ** 2))
            self.assertEqual(stages["micro-coded processors"]["cycles"],
                             math.ceil(blocks / value["processors"]) * cycles + blocks * value["sort_cycles"] + value["buckets"])
            self.assertEqual(stages["host computer"]["cycles"], value["host_cycles"])
            self.assertEqual(stages["output"]["cycles"], 512 * 512)
            segments = (stages["address controller"]["cycles"] - blocks * value["block_cycles"]) / value["segment_cycles"]
            self.assertEqual(segments, int(segments))
            # The units share the pixels of a block in a segment; what is left of the last cycle is lost.
            drawing = stages["pixel processor"]["cycles"]
            self.assertGreaterEqual(drawing, pixels / value["pixel_units"])
            self.assertLessEqual(drawing, pixels / value["pixel_units"] + segments * (1 - 1 / value["pixel_units"]))
            self.assertGreaterEqual(segments, blocks)
        with open(PAGE) as file:
            text = file.read()
        for formula in ("(surface + 21) / `multipliers` + 2 `division_cycles`", "1 + 21 + 2 x 16 = 54",
                        "blocks times `block_cycles` + segments times `segment_cycles`", "pixels / `pixel_units`"):
            self.assertIn(formula, text)

    def test_the_timeline_says_what_frames_do_and_when(self):
        path = os.path.join(self.folder, "timeline.svg")
        self.assertEqual(run("schedule", "--surface", "sphere", "-o", path)[0], 0)
        svg = xml.parse(path).getroot()
        titles = [e.text for e in svg.iter() if e.tag.endswith("title")]
        for stage in ("host computer", "micro-coded processors", "address controller", "pixel processor", "output",
                      "programs", "block data memory", "output image memory"):
            for frame in range(1, 6):
                self.assertEqual(sum(t.startswith("%s: frame %d, " % (stage, frame)) for t in titles), 1, stage)
        self.assertTrue(any(t.startswith("micro-coded processors: waits for ") for t in titles))
        words = [e.text for e in svg.iter() if e.tag.endswith("text")]
        self.assertIn("time since the start, ms", words)
        ticks = [float(w) for w in words if re.fullmatch(r"[0-9.]+", w)]
        self.assertEqual(ticks[0], 0)
        self.assertGreater(len(ticks), 4)
        steps = {round(b - a, 6) for a, b in zip(ticks, ticks[1:])}
        self.assertEqual(len(steps), 1)
        # Nothing stands beside the picture.
        for rect in svg.iter("{http://www.w3.org/2000/svg}rect"):
            if rect.get("x"):
                self.assertLessEqual(float(rect.get("x")) + float(rect.get("width")), float(svg.get("width")))

    def test_what_is_wrong_is_one_line(self):
        good = self.write("good.ps", b"ps_2_0\ndcl t0\ndcl_2d s0\ntexld r0, t0, s0\nmov oC0, r0\n")
        defines = self.write("defines.ps", b"ps_2_0\ndef c1, 0, 0, 0, 0\nmov oC0, c1\n")
        bad = self.write("bad.ps", b"ps_2_0\nmov oC0, c0\nfrob r0\n")
        wide = self.write("wide.pfm", picture([[(0, 0, 0)] * 2]))
        square = self.write("square.pfm", picture([[(0, 0, 0)]]))
        short = self.write("short.pfm", picture([[(0, 0, 0)]])[:-1])
        for arguments, message in (
                ([], "A subcommand is required"),
                (["assemble", bad], "bad.ps: line 3: \"frob\": no such instruction"),
                (["assemble", self.folder], ": cannot be read"),
                (["assemble", os.path.join(self.folder, "none.ps")], "none.ps: cannot be read"),
                (["assemble", self.write("empty.ps", b"")], "empty.ps: line 1: is empty: the first line must be ps_2_0"),
                (["run", good], "--texture: s0 is declared and must be given"),
                (["run", good, "--texture", "s0=" + wide], "is 2x1: a texture must be as wide as high"),
                (["run", good, "--texture", "s0=" + short], "has 11 bytes of pixels: must have 12"),
                (["run", good, "--texture", "s0=" + good], "is no portable float map"),
                (["run", good, "--texture", "s0=" + self.write("nan.pfm", picture([[(0, 0, 0)]], b"nan"))],
                 "has no scale behind its size: must have a finite number"),
                (["run", good, "--texture", "s16=" + wide], "must be s0 to s15, = and the name of a file"),
                (["run", good, "--texture", "s0="], "--texture=s0=: must be s0 to s15, = and the name of a file"),
                (["run", good, "--constant", "c0="], "--constant=c0=: must be c0 to c31, = and four numbers"),
                (["run", good, "--size", "0"], "--size=0: must be N or NxM"),
                (["run", good, "--size", "nan"], "--size=nan: must be N or NxM"),
                (["run", good, "--constant", "c0=1,2"], "must have four numbers"),
                (["run", good, "--constant", "c0=1,2,nan,4"], "--constant=c0=1,2,nan,4: must be finite numbers"),
                (["run", good, "--constant", "c7=1,,2,3"], "--constant=c7=1,,2,3: must be finite numbers"),
                (["run", good, "--constant", "c0=1,2,3,4", "--constant", "c0=1,2,3,5"],
                 "--constant=c0=1,2,3,5: is given twice: must be given once"),
                (["run", good, "--texture", "s0=" + square, "--texture", "s0=" + square], "is given twice"),
                (["run", defines, "--constant", "c1=1,2,3,4"], "--constant=c1=1,2,3,4: must be none that the program defines"),
                (["run", good, "--arithmetic", "V8U8"], "--arithmetic=V8U8: must be one of float16"),
                (["run", good, "--arithmetic", "x"],
                 "--arithmetic=x: must be one of float16, float24, float32, fixed16, fixed32\n"),
                (["schedule", "--surface", "cube"], "--surface=cube: must be one of plane, "),
                (["schedule", "--machine", '{"block": 4, "block": 8}'], 'machine: "block" is given twice: must be given once'),
                (["schedule", "--machine", "oka"], "machine=oka: must be oka-1987, "),
                (["schedule", "--machine", "oka-1987:block=0.01"], "machine: block=0.01: must be a number from 0.25"),
                (["schedule", "--picture", "16384", "--machine", "oka-1987:block=0.25"],
                 "block=0.25: makes more than 4194304 blocks"),
                (["schedule", "--picture", "0"], "--picture=0: must be N or NxM"),
                (["run", good, "--weight-bits", "24"], "24")):
            if "--constant" in arguments or "--size" in arguments:
                arguments = arguments + ["--texture", "s0=" + self.write("one.pfm", picture([[(0, 0, 0)]]))]
            status, out, error = run(*arguments)
            self.assertEqual((status, out), (1, b""), arguments)
            self.assertTrue(error.startswith("anamorph-machine: ") and message in error, error)
            self.assertEqual(error.count("\n"), 1, error)

    def test_version(self):
        self.assertRegex(run("--version")[1].decode(), r"^anamorph-machine \d+\.\d+")


if __name__ == "__main__":
    unittest.main()
