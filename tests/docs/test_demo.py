# SPDX-License-Identifier: Apache-2.0
"""What examples/demo.sh says before it draws anything: its options, and how far the build is. (tests/run.sh runs all of it.)"""
import os
import pty
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.environ["ANAMORPH_SOURCE_DIR"], "examples"))
import demo_page  # noqa: E402

DEMO = os.path.join(os.environ["ANAMORPH_SOURCE_DIR"], "examples/demo.sh")
with open(DEMO, encoding="utf-8") as file:
    PROGRESS = re.search(r"^show_progress\(\) \{\n.*?^\}\n", file.read(), re.M | re.S)[0]
# As ninja prints a build of 230 steps: the first line is CMake's, and one step links.
NINJA = "-- Configuring done\n[0/2] Re-checking globbed directories...\n" + "".join(
    f"[{i}/230] {'Linking CXX executable a' if i == 230 else 'Building CXX object a.o'}\n" for i in range(1, 231))
TEXT = re.compile(r"building: (\d+)% \((\d+) of 230\), \d+ s")


def demo(*options):
    return subprocess.run(["bash", DEMO, *options], capture_output=True, text=True, timeout=60)


class Options(unittest.TestCase):
    def test_help_names_all_options(self):
        done = demo("--help")
        self.assertEqual(done.returncode, 0, done.stderr)
        for option in ("--long", "--quick", "--help"):
            self.assertIn(f"  {option} ", done.stdout)
        self.assertIn("build/demo/out", done.stdout)
        self.assertIn("installed", done.stdout)

    def test_what_is_no_option_is_refused(self):
        for options, name in ((["--slow"], "--slow"), (["--quick", "--long"], "--long"), (["x"], "x")):
            done = demo(*options)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"demo.sh: {name}: ", done.stderr)
            self.assertEqual(done.stdout, "")


class Progress(unittest.TestCase):
    def shares(self, text):
        found = [(int(share), int(step)) for share, step in TEXT.findall(text)]
        self.assertEqual(found, sorted(found))
        self.assertEqual(found[-1], (100, 230))
        return found

    def test_a_pipe_gets_a_line_for_every_tenth(self):
        text = subprocess.run(["bash", "-c", PROGRESS + "show_progress"], input=NINJA, capture_output=True, text=True,
                              check=True, timeout=60).stdout
        self.assertEqual([share for share, _ in self.shares(text)], list(range(0, 101, 10)))
        self.assertEqual(text.count("\n"), 11)

    def test_a_terminal_gets_one_line_that_changes(self):
        ours, theirs = pty.openpty()
        with subprocess.Popen(["bash", "-c", PROGRESS + "show_progress"], stdin=subprocess.PIPE, stdout=theirs) as process:
            process.communicate(NINJA.encode(), timeout=60)
        self.assertEqual(process.returncode, 0)
        os.close(theirs)
        text = b""
        try:
            while piece := os.read(ours, 65536):
                text += piece
        except OSError:  # the terminal is closed
            pass
        text = text.decode()
        self.assertGreater(len(self.shares(text)), 50)
        self.assertEqual(text.count("\n"), 1)

    def test_nothing_to_build_says_nothing(self):
        done = subprocess.run(["bash", "-c", PROGRESS + "show_progress"], input="ninja: no work to do.\n", capture_output=True,
                              text=True, check=True, timeout=60)
        self.assertEqual(done.stdout, "")


class Page(unittest.TestCase):
    def test_shows_what_was_drawn_with_its_line(self):
        text = demo_page.page([["a.png", "anamorph draw 'x?y=1&z=2' -o a.png"], ["b.exr", "c"], ["d.mp4", "e"]], "<svg>plotted</svg>")
        self.assertIn('<img src="a.png"', text)
        self.assertIn("anamorph draw &#x27;x?y=1&amp;z=2&#x27; -o a.png", text)
        self.assertIn('<a href="b.exr"', text)
        self.assertIn('<video src="d.mp4"', text)
        self.assertIn("<svg>plotted</svg>", text)

    def test_pictures_that_are_not_there_are_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "lines"), "w", encoding="utf-8") as file:
                file.write("gone.png\tanamorph draw\n")
            done = subprocess.run(["/usr/bin/python3", demo_page.__file__, "anamorph", file.name, folder], capture_output=True, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (1, "gone.png: not there\n"))
            self.assertEqual(os.listdir(folder), ["lines"])

    def test_says_how_many_pictures_there_are(self):
        with open(DEMO, encoding="utf-8") as file:
            text = file.read()
        made = re.findall(r"^(?:show|view|film) ", text, re.M)
        self.assertEqual(int(re.search(r"all=(\d+)", text)[1]), len(made))


if __name__ == "__main__":
    unittest.main()
