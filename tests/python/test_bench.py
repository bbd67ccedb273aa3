# SPDX-License-Identifier: Apache-2.0
"""anamorph bench: the table, the plot and the page, and that errors that are known are what it measures. Times are never asserted."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import numpy as np

import anamorph
from anamorph import bench, plot


class Bench(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        done = cls.run_bench("-o", cls.folder / "of", "--size", "96", "--rounds", "1")
        assert done.returncode == 0 and done.stderr == "", done.stderr
        cls.said = done.stdout
        with open(cls.folder / "of/table.csv", newline="", encoding="utf-8") as file:
            cls.rows = list(csv.DictReader(file))

    @staticmethod
    def run_bench(*arguments):
        program = os.environ.get("ANAMORPH_PROGRAM")
        command = [program, "bench"] if program else [sys.executable, "-m", "anamorph.bench"]
        return subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, timeout=200)

    def test_errors_are_within_tolerances(self):
        self.assertEqual(self.said, f"{self.folder / 'of/index.html'}\n")
        ours = [row for row in self.rows if row["what"] == "Anamorph"]
        self.assertEqual(len(ours), len(bench.TOLERANCES) * len(bench.cases(96)))
        for row in ours:
            self.assertLessEqual(float(row["max_error_px"]), float(row["tol_px"]) + bench.RESOLUTION, row)
            self.assertGreater(float(row["ns_per_px"]), 0)
        # Coarse ones are off by more than what is not measured.
        self.assertGreater(max(float(row["max_error_px"]) for row in ours), 0.01)
        for row in self.rows:
            if row["what"].startswith("SciPy"):
                self.assertLess(float(row["max_error_px"]), bench.RESOLUTION)
            if row["what"].startswith("OpenCV"):
                self.assertTrue(0.01 < float(row["max_error_px"]) < 0.05, row)  # steps of 1/32 of a pixel

    def test_numpy_writes_the_same_map(self):
        name, operation, (width, height), keys = bench.cases(64)[0]
        u, v = anamorph.Picture(operation, bench.ramp(width, height), **keys).source_points(*np.meshgrid(np.arange(64) + 0.5, np.arange(64) + 0.5))
        np.testing.assert_allclose(bench.numpy_view(64), (u, v), atol=1e-8)

    def test_long_tables_that_end_early_leave_what_was_measured(self):
        stub = self.folder / "speed_vs_error"
        stub.write_text("#!/bin/sh\n[ $2 = pano ] || exit 3\nfor file; do :; done\n"
                        "printf 'case,scheme,threads,max_error_px,ns_per_px\\nview,blocks,1,0.01,2.5\\nview,memory,1,nan,0.5\\n' > $file\n", encoding="utf-8")
        stub.chmod(0o755)
        os.environ["ANAMORPH_SPEED_VS_ERROR"] = str(stub)
        try:
            done = self.run_bench("-o", self.folder / "long", "--size", "64", "--rounds", "1", "--tables")
        finally:
            del os.environ["ANAMORPH_SPEED_VS_ERROR"]
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"^anamorph bench: .* --op warp ended with the status 3; what was measured before is in .*index.html\n$")
        self.assertTrue((self.folder / "long/table.csv").exists())
        page = (self.folder / "long/index.html").read_text(encoding="utf-8")
        self.assertIn("All schemes of pano", page)
        self.assertIn(">memory<", page)
        self.assertNotRegex(page, r"\bnan\b")
        self.assertNotIn("All schemes of warp", page)

    def test_page_and_plot_show_every_row(self):
        tree = xml.parse(self.folder / "of/plot.svg")
        marks = [node for node in tree.iter() if node.tag.endswith("circle")]
        self.assertEqual(len(marks), sum(row["max_error_px"] != "" for row in self.rows))
        box = [float(number) for number in tree.getroot().get("viewBox").split()]
        for mark in marks:
            self.assertTrue(0 <= float(mark.get("cx")) <= box[2] and 0 <= float(mark.get("cy")) <= box[3])
        text = (self.folder / "of/index.html").read_text()
        self.assertEqual(text.count("<tr>"), 1 + len(self.rows))
        self.assertEqual(sorted(path.name for path in (self.folder / "of").iterdir()), ["index.html", "plot.svg", "table.csv"])

    def test_a_plot_is_where_its_numbers_are(self):
        picture = plot.svg([plot.Point("a", "one & two", 0.01, 10), plot.Point("a", "one & two", 1, 1000)])
        marks = [node for node in xml.fromstring(picture).iter() if node.tag.endswith("circle")]
        self.assertEqual([mark.get("cx") for mark in marks], [f"{plot._LEFT:.1f}", f"{plot._WIDTH - plot._RIGHT:.1f}"])
        self.assertEqual([mark.get("cy") for mark in marks], [f"{plot._HEIGHT - plot._BOTTOM:.1f}", f"{plot._TOP:.1f}"])
        with self.assertRaises(ValueError):
            plot.svg([])

    def test_what_is_wrong_is_said(self):
        for arguments, message in ((["--size", "63"], "--size=63: must be from 64 to 8192"), (["--rounds", "0"], "--rounds=0: must be"), (["x"], "x: there is no such argument"),
                                   (["--tabels"], "--tabels: there is no such option, perhaps --tables is meant")):
            done = self.run_bench(*arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(message, done.stderr)


if __name__ == "__main__":
    unittest.main()
