# SPDX-License-Identifier: Apache-2.0
"""anamorph help and completion: what they print is what the tables of keys in docs/ say."""
import os
import pathlib
import re
import subprocess
import tempfile
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
        for name in ("hash", "draw", "stmap", "join", "explain"):
            self.assertEqual(run("help", name), run(name, "--help"))
            self.assertIn("Usage: anamorph " + name, run("help", name)[1])

    def completed(self, *words):
        status, page, error = run("complete", "--", *words)
        self.assertEqual((status, error), (0, ""), words)
        return page.split()

    def test_programs_beside_it(self):
        for name in ("figure", "machine"):
            alone = subprocess.run([f"{PROGRAM}-{name}", "--help"], capture_output=True, text=True, timeout=50)
            self.assertEqual(run(name, "--help"), (0, alone.stdout, ""))

    def test_all_help_has_the_options_of_every_subcommand(self):
        # Manual pages are made of it.
        for words in ([], ["figure"], ["machine"]):
            status, whole, error = run(*words, "--help-all")
            self.assertEqual((status, error), (0, ""))
            subcommands = re.findall(r"(?m)^  (\w+) +[A-Z]", run(*words, "--help")[1].split("Subcommands:")[1])
            self.assertGreater(len(subcommands), 2)
            for name in subcommands:
                of_it = re.search(rf"(?ms)^{name}\n(.*?)(?=^\w|\Z)", whole)[1]
                for option in re.findall(r"(?m)^ +(--?[\w-]+)", run(*words, name, "--help")[1]):
                    self.assertTrue(option in ("-h", "--help") or option in of_it, (name, option))

    def test_new_recipes_have_every_key(self):
        toys = "  toy " in run("help")[1]
        for name, rows in tables():
            if toys and name in ("pano", "mosaic", "drape"):
                continue
            status, text, error = run("new", name, "a picture #1.tif")
            self.assertEqual((status, error), (0, ""), name)
            self.assertLessEqual(max(len(line) for line in text.split("\n") if "=" not in line), 80)
            paragraphs = text.strip().split("\n\n")[1:]
            self.assertEqual([p.split("\n")[-1].lstrip("#").split("=")[0] for p in paragraphs], [row[0] for row in rows])
            for paragraph, (key, default, unit, allowed, meaning) in zip(paragraphs, rows):
                *comment, line = paragraph.split("\n")
                self.assertEqual(" ".join(" ".join(c[2:] for c in comment).split()), " ".join(f"{meaning} {allowed}{unit and f' ({unit})'}".split()))
                self.assertIn(line, ("#%s=%s" % (key, default), '%s="a picture #1.tif"' % key))
            self.assertEqual(len(re.findall(r"(?m)^[^#\n]", text)), 1)

    def test_new_recipes_are_drawn(self):
        if not os.path.exists(os.path.join(os.path.dirname(PROGRAM), "anamorph-pictures")):
            self.skipTest("this build has no OpenImageIO")
        with tempfile.TemporaryDirectory() as folder:
            def ok(*words):
                result = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=100)
                self.assertEqual((result.returncode, result.stderr), (0, ""), words)
                return result.stdout

            pathlib.Path(folder, "a.ppm").write_bytes(b"P6\n96 64\n255\n" + bytes(range(256)) * 72)
            os.mkdir(os.path.join(folder, "sub"))
            for name in re.findall(r"^  (\w+)  +\S", run("help")[1], re.MULTILINE):
                needs = {"morph": ["a.ppm", "a.ppm"], "figure": []}.get(name, ["a.ppm"])
                for recipe in ("x." + name, "sub/y." + name):
                    ok("new", name, *needs, "-o", recipe)
                    ok("draw", recipe, "-o", recipe.replace("/", "_") + ".{frame}.png")
                    self.assertTrue(list(pathlib.Path(folder).glob(recipe.replace("/", "_") + ".*.png")), recipe)
                again = subprocess.run([PROGRAM, "new", name, *needs, "-o", "x." + name], cwd=folder, capture_output=True, text=True, timeout=50)
                self.assertEqual(again.returncode, 1)
                self.assertRegex(again.stderr, r"^anamorph: x\.\w+ is there already, and nothing was written: give another -o\n$")
            # What the example reads is there from the first, and serves a second recipe; another file of the name does not.
            ok("new", "warp", "a.ppm", "-o", "second.warp")
            pathlib.Path(folder, "grid.json").write_text("mine")
            refused = subprocess.run([PROGRAM, "new", "warp", "a.ppm", "-o", "third.warp"], cwd=folder, capture_output=True, text=True, timeout=50)
            self.assertEqual((refused.returncode, refused.stderr), (
                1, "anamorph: grid.json, which the recipe would read, is there already, and nothing was written: give another -o\n"))
            self.assertFalse(os.path.exists(os.path.join(folder, "third.warp")))
            self.assertEqual(pathlib.Path(folder, "grid.json").read_text(), "mine")
            early = subprocess.run([PROGRAM, "new", "pano", "later.jpg", "-o", "early.pano"], cwd=folder, capture_output=True, text=True, timeout=50)
            self.assertEqual((early.returncode, early.stderr), (0, "anamorph: there is no file later.jpg yet, which the recipe reads\n"))
            self.assertEqual([p for p in pathlib.Path(folder).rglob(".*")], [])

    def test_completes_command_lines(self):
        self.assertEqual(self.completed("anamorph", ""), sorted("help new run doctor hash draw stmap join explain figure machine bench".split()))
        self.assertEqual(self.completed("/usr/bin/anamorph", "d"), ["doctor", "draw"])
        self.assertEqual(self.completed("anamorph", "--v"), ["--version"])
        self.assertEqual(self.completed("anamorph", "help", "m"), ["map", "morph", "mosaic"])
        self.assertIn("--help", self.completed("anamorph-machine", "--"))
        self.assertEqual(self.completed("anamorph", "new", "m"), ["map", "morph", "mosaic"])
        self.assertIn("svg", self.completed("anamorph-figure", ""))
        self.assertEqual(self.completed("anamorph", "figure", "film", "--fp"), ["--fps"])
        self.assertIn("--fps", self.completed("anamorph-figure", "film", "--f"))
        for words in (["anamorph"], ["oiiotool", ""], ["anamorph", "draw", ""], ["anamorph", "draw", "a.nothing?"], ["anamorph", "x"]):
            self.assertEqual(self.completed(*words), [], words)
        self.assertEqual(run("complete")[0], 1)

    def test_completes_recipes_by_the_tables(self):
        for name, rows in tables():
            keys = sorted("%s.%s?%s=" % ("x", name, key) for key, *_ in rows)
            found = self.completed("anamorph", "draw", "x.%s?" % name)
            self.assertEqual(sorted(set(keys) - set(found)), [], name)
        self.assertEqual(self.completed("anamorph", "draw", "v.pano?yaw=3&to=pan"), ["v.pano?yaw=3&to=pannini"])
        self.assertEqual(self.completed("anamorph", "hash", "w.warp?mesh=m.json&src=(v.pano?filter=nea"),
                         ["w.warp?mesh=m.json&src=(v.pano?filter=nearest"])
        self.assertEqual(self.completed("anamorph", "hash", "w.warp?src=(v.pano?to=cubemap)&mes"), ["w.warp?src=(v.pano?to=cubemap)&mesh="])
        self.assertEqual(self.completed("anamorph", "hash", "v.pano?yaw="), [])

    def test_shells_complete(self):
        folder = os.path.join(os.environ["ANAMORPH_DOCS"], "..", "core", "command", "completions")
        environment = dict(os.environ, PATH=os.path.dirname(PROGRAM) + ":" + os.environ["PATH"])
        lines = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _anamorph 2>/dev/null; printf "%s\\n" "${COMPREPLY[@]}"'
        for words, expected in ((["anamorph", "dr"], ["draw"]), (["anamorph", "hash", "'v.pano?to=pan"], ["v.pano?to=pannini"])):
            result = subprocess.run(["bash", "-c", lines, os.path.join(folder, "anamorph.bash"), *words], env=environment, capture_output=True,
                                    text=True, timeout=50)
            self.assertEqual(result.stdout.split(), expected, result.stderr)
        lines = 'source $argv[1]; complete -C "anamorph dr"; complete -C "anamorph hash \\"v.pano?to=pan"; complete -C "anamorph-figure fi"'
        result = subprocess.run(["fish", "-c", lines, os.path.join(folder, "anamorph.fish")], env=environment, capture_output=True, text=True,
                                timeout=50)
        self.assertEqual(result.stdout.split(), ["draw", "v.pano?to=pannini", "film"], result.stderr)

    def test_what_is_wrong_is_one_line(self):
        for arguments, message in (
                (["help", "twist"], 'operation=twist: there is none of that name: must be one of pano, '),
                (["help", "pana"], 'operation=pana: there is none of that name, perhaps pano is meant: must be one of pano, '),
                (["new", "warpp"], ", perhaps warp is meant: must be"),
                (["new", "pano", "a", "b"], "SOURCE=b: pano has 1 source at most"),
                (["new", "pano", "-o", "view.warp"], "--output=view.warp: must end in .pano"),
                (["new", "morph", "one.jpg", "-o", "nowhere/m.morph"], "SOURCE=one.jpg: morph needs 2 images, one after the other, for a and b"),
                (["drew"], "command=drew: there is none of that name, perhaps draw is meant: must be one of hash, "),
                (["doctor", "--halp"], "--halp: there is no such option, perhaps --help is meant"),
                (["new", "--out", "x.pano", "pano"], "--out: there is no such option, perhaps --output is meant"),
                (["help", "a\nb\x1b"], "operation=a?b?: there is none of that name: must be one of"),
                ([], "A subcommand is required"),
                (["help", "pano", "warp"], "warp")):
            status, page, error = run(*arguments)
            self.assertEqual((status, page), (1, ""), arguments)
            self.assertTrue(error.startswith("anamorph: ") and message in error, error)
            self.assertEqual(error.count("\n"), 1)

    def test_misspelt_options_of_all_programs(self):
        folder = os.path.dirname(PROGRAM)
        for program, arguments, meant in (("anamorph-figure", ["svg", "--hiden=dash", "x.nudes"], "--hidden"),
                                          ("anamorph-figure", ["film", "x.nudes", "--fsp", "12", "-o", "x.mp4"], "--fps"),
                                          ("anamorph-machine", ["--verison"], "--version"),
                                          ("anamorph-pictures", ["draw", "v.pano", "--jbos", "4", "-o", "v.exr"], "--jobs"),
                                          ("anamorph-pictures", ["draw", "v.pano", "--otput", "v.exr"], "--output"),
                                          ("anamorph-pictures", ["stmap", "v.pano", "--flip_v", "-o", "v.exr"], "--flip-v")):
            if not os.path.exists(os.path.join(folder, program)):
                continue  # this build has no OpenImageIO
            result = subprocess.run([os.path.join(folder, program), *arguments], capture_output=True, text=True, timeout=50)
            misspelt = next(word for word in arguments if word.startswith("--")).split("=")[0]
            self.assertEqual((result.returncode, result.stdout, result.stderr.split(": ", 1)[1]),
                             (1, "", f"{misspelt}: there is no such option, perhaps {meant} is meant\n"), arguments)

    def test_output_that_cannot_be_written_is_told(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([PROGRAM, "help", "pano"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=50)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "anamorph: the standard output cannot be written\n")

    def test_version(self):
        self.assertRegex(run("--version")[1], r"^anamorph \d+\.\d+")


if __name__ == "__main__":
    unittest.main()
