# SPDX-License-Identifier: Apache-2.0
"""anamorph help: what it prints is what the tables of keys in docs/ say."""
import os
import pathlib
import re
import subprocess
import unittest

PROGRAM = os.environ["ANAMORPH"]
PAGES = "".join(path.read_text(encoding="utf-8") for path in sorted(pathlib.Path(os.environ["ANAMORPH_DOCS"]).glob("*.md")))


def run(*arguments):
    result = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=50)
    return result.returncode, result.stdout, result.stderr


def tables():
    """Of each operation its rows: key, default, unit, allowed, meaning."""
    for name, table in re.findall(r"<!-- keys of (\w+): begin -->(.*?)<!-- keys of \1: end -->", PAGES, re.DOTALL):
        yield name, [[cell.strip().replace("`", "") for cell in line.split("|")[1:-1]]
                     for line in table.strip().split("\n")[2:]]


class Help(unittest.TestCase):
    def test_lists_every_operation(self):
        status, page, error = run("help")
        self.assertEqual((status, error), (0, ""))
        listed = re.findall(r"^  (\w+)  +\S", page, re.MULTILINE)
        self.assertGreaterEqual(len(listed), 3)
        for name, _ in tables():
            self.assertIn(name, listed)
        for name in listed:
            status, page, _ = run("help", name)
            self.assertEqual(status, 0)
            self.assertTrue(page.startswith(name + ": "))
            self.assertLessEqual(max(len(line) for line in page.split("\n") if " " in line.strip()), 80)

    def test_says_what_the_tables_say(self):
        toys = "  toy " in run("help")[1]
        for name, rows in tables():
            if toys and name in ("pano", "mosaic", "drape"):
                continue  # the pages' lists of projections and surfaces have no toys
            page = " ".join(run("help", name)[1].split("defaults]:", 1)[1].split())
            expected = ""
            for key, default, unit, allowed, meaning in rows:
                expected += " %s: %s%s%s %s" % (key, allowed, unit and " (%s)" % unit,
                                                default and " [%s]" % default, meaning)
            self.assertEqual(page, expected.strip())

    def test_pages_of_what_is_done_with_pictures(self):
        if not os.path.exists(os.path.join(os.path.dirname(PROGRAM), "anamorph-pictures")):
            self.skipTest("this build has no OpenImageIO")
        for name in ("hash", "draw", "join", "explain"):
            self.assertEqual(run("help", name), run(name, "--help"))
            self.assertIn("Usage: anamorph " + name, run("help", name)[1])

    def test_what_is_wrong_is_one_line(self):
        for arguments, message in (
                (["help", "twist"], 'operation=twist: must be one of pano, '),
                (["help", "a\nb\x1b"], "operation=a?b?: must be one of"),
                ([], "A subcommand is required"),
                (["help", "pano", "warp"], "warp")):
            status, page, error = run(*arguments)
            self.assertEqual((status, page), (1, ""), arguments)
            self.assertTrue(error.startswith("anamorph: ") and message in error, error)
            self.assertEqual(error.count("\n"), 1)

    def test_output_that_cannot_be_written_is_told(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([PROGRAM, "help", "pano"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=50)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "anamorph: the standard output cannot be written\n")

    def test_version(self):
        self.assertRegex(run("--version")[1], r"^anamorph \d+\.\d+")


if __name__ == "__main__":
    unittest.main()
