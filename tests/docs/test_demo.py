# SPDX-License-Identifier: Apache-2.0
"""What examples/demo.sh says before it draws anything: its options, and how far the build is. (tests/run.sh runs all of it.)"""
import os
import pty
import re
import subprocess
import unittest

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


if __name__ == "__main__":
    unittest.main()
