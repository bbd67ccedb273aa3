# SPDX-License-Identifier: Apache-2.0
"""anamorph-machine: programs are assembled and run, and what they draw is what they say, worked out by hand."""
import os
import struct
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

PROGRAM = os.environ["ANAMORPH_MACHINE"]


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
                         "; 2 of 64 arithmetic instructions, 0 of 32 texture instructions\n")
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
            rows = [line.split(",") for line in out.decode().split("\n")[1:-1]]
            return {row[0]: [float(cell) for cell in row[1:]] for row in rows}
        table = schedule()
        self.assertEqual(table["micro-coded processors"][0], 2048 * 73)
        self.assertEqual(table["pixel processor"], [512 * 512, 26.2144, 1, 512 * 512 * 15])
        self.assertEqual(max(row[2] for row in table.values()), 1)
        small = schedule("--machine", "oka-1987:block=4")
        self.assertEqual(small["micro-coded processors"][2], 1)
        large = schedule("--picture", "1024", "--size", "1024")
        self.assertEqual(large["pixel processor"][2], 1)
        self.assertGreater(large["pixel processor"][1], 100)
        path = os.path.join(self.folder, "timeline.svg")
        self.assertEqual(run("schedule", "--surface", "sphere", "-o", path)[0], 0)
        bars = [e for e in xml.parse(path).getroot() if e.tag.endswith("rect") and len(e) == 1]
        self.assertEqual(len(bars), 5 * 4)

    def test_what_is_wrong_is_one_line(self):
        good = self.write("good.ps", b"ps_2_0\ndcl t0\ndcl_2d s0\ntexld r0, t0, s0\nmov oC0, r0\n")
        bad = self.write("bad.ps", b"ps_2_0\nmov oC0, c0\nfrob r0\n")
        wide = self.write("wide.pfm", picture([[(0, 0, 0)] * 2]))
        short = self.write("short.pfm", picture([[(0, 0, 0)]])[:-1])
        for arguments, message in (
                ([], "A subcommand is required"),
                (["assemble", bad], "bad.ps: line 3: \"frob\": no such instruction"),
                (["assemble", self.folder], ": cannot be read"),
                (["assemble", os.path.join(self.folder, "none.ps")], "none.ps: cannot be read"),
                (["assemble", self.write("empty.ps", b"")], "empty.ps: is empty: the first line must be ps_2_0"),
                (["run", good], "--texture: s0 is declared and must be given"),
                (["run", good, "--texture", "s0=" + wide], "is 2x1: a texture must be as wide as high"),
                (["run", good, "--texture", "s0=" + short], "has 11 bytes of pixels: must have 12"),
                (["run", good, "--texture", "s0=" + good], "is no portable float map"),
                (["run", good, "--texture", "s16=" + wide], "must be s0 to s15, = and what it is"),
                (["run", good, "--size", "0"], "--size=0: must be N or NxM"),
                (["run", good, "--size", "nan"], "--size=nan: must be N or NxM"),
                (["run", good, "--constant", "c0=1,2"], "must have four numbers"),
                (["run", good, "--arithmetic", "V8U8"], "--arithmetic=V8U8: must be one of float16"),
                (["schedule", "--surface", "cube"], "--surface=cube: must be one of plane, "),
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
