# SPDX-License-Identifier: Apache-2.0
"""Every block of code of every .md can be read by what it is for, names only what there is, and is run by a test, or the
table says why not."""
import json
import os
import re
import shlex
import subprocess
import sys
import unittest

import blocks as tree

SOURCE = tree.source_dir()
BUILD = os.environ["ANAMORPH_BUILD_DIR"]
CMAKE, CTEST = os.environ["ANAMORPH_CMAKE"], os.environ["ANAMORPH_CTEST"]
BLOCKS = tree.all_blocks()


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=250).stdout


def read(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def commands(line):
    """The words of each command of a line of the shell."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=";&|")
    lexer.whitespace_split = True
    words = list(lexer)
    while words:
        end = next((i for i, word in enumerate(words) if word in (";", "&&", "||", "|")), len(words))
        yield words[:end]
        words = words[end + 1:]


def inline_commands():
    """(file, words) of commands within sentences, which are in backticks."""
    for path in tree.documents():
        for text in re.findall(r"`((?:cmake|ctest) [^`]*)`", path.read_text(encoding="utf-8")):
            yield from ((path.name, words) for words in commands(" ".join(text.split())))


def all_commands():
    """(where, words) of all commands, each within backticks or in a block."""
    for block, line in tree.shell_lines(BLOCKS):
        yield from ((str(block), words) for words in commands(line))
    yield from inline_commands()


class Blocks(unittest.TestCase):
    def test_each_is_run_by_a_test_or_says_why_not(self):
        for block, line in tree.shell_lines(BLOCKS):
            with self.subTest(str(block)):
                rules = [rule for rule in tree.LINES if re.match(rule.start, line)]
                self.assertEqual(len(rules), 1, f"tests/docs/blocks.py is to have one rule for: {line}")
        for block in BLOCKS:
            with self.subTest(str(block)):
                others = [o for o in tree.OTHERS if o.language == block.language and o.words in block.text]
                self.assertEqual(len(others), int(block.language != "shell"),
                                 f"tests/docs/blocks.py is to have one rule for:\n{block.text}")

    def test_the_tables_have_nothing_that_is_gone(self):
        for rule in tree.LINES:
            self.assertTrue(any(re.match(rule.start, line) for _, line in tree.shell_lines(BLOCKS)), rule)
            self.assertNotEqual(bool(rule.runs), bool(rule.why), rule)
        for other in tree.OTHERS:
            found = [b for b in BLOCKS if b.language == other.language and other.words in b.text]
            self.assertEqual(len(found), 1, (other, [str(b) for b in found]))

    def test_markdown_sees_them_as_blocks(self):
        """What is indented right behind a sentence or a table is no block, but goes on with it."""
        for path in tree.documents():
            lines = path.read_text(encoding="utf-8").split("\n")
            for number, (before, line) in enumerate(zip(lines, lines[1:]), 2):
                if line.startswith("    ") and before.strip() and not before.startswith((" ", "```")):
                    fences = sum(l.startswith("```") for l in lines[:number - 1])
                    self.assertEqual(fences % 2, 1, f"{path}:{number}: {line}")


class Shell(unittest.TestCase):
    def test_it_is_shell(self):
        for block in BLOCKS:
            with self.subTest(str(block)):
                if block.language == "shell":
                    done = subprocess.run(["bash", "-n"], input=block.text + "\n", capture_output=True, text=True, timeout=60)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    words = [word for line in block.text.replace("\\\n", " ").split("\n") for word in shlex.split(line, comments=True)]
                    self.assertNotIn("|", words, "no command has a pipe, so this is a part of a table")

    def test_presets_exist(self):
        presets = json.loads(read("CMakePresets.json"))
        for where, words in all_commands():
            if words[0] in ("cmake", "ctest") and "--preset" in words:
                kind = "test" if words[0] == "ctest" else "build" if "--build" in words else "configure"
                names = [preset["name"] for preset in presets[kind + "Presets"] if not preset.get("hidden")]
                self.assertIn(words[words.index("--preset") + 1], names, f"{where}: {words}")

    def test_options_of_cmake_exist(self):
        lists = read("CMakeLists.txt")
        ours = re.findall(r"^ *option\((\w+)", lists, re.M) + re.findall(r"^ *set\((\w+) .* CACHE ", lists, re.M)
        python = output(CMAKE, "--help-module", "FindPython3")
        for where, words in all_commands():
            for option in re.findall(r"^-D(\w+)", "\n".join(words), re.M) if words[0] == "cmake" else []:
                if option.endswith("_ROOT"):  # of any package
                    self.assertIn(f"find_package({option[:-5]} ", read("vtk_filters/modules.cmake"), where)
                else:
                    self.assertTrue(option in ours or f"``{option}``" in python, f"{where}: neither we nor FindPython3 have {option}")

    def test_targets_of_cmake_exist(self):
        for where, words in all_commands():
            if words[0] == "cmake" and "--target" in words:
                target = words[words.index("--target") + 1]
                found = output("grep", "-rEl", "--include=CMakeLists.txt", rf"add_(custom_target|library|executable)\({target}\b",
                               str(SOURCE / "core"), str(SOURCE / "docs"), str(SOURCE / "plugins"), str(SOURCE / "tests"))
                self.assertTrue(found, f"{where}: {target}")

    def test_files_exist(self):
        for where, words in all_commands():
            for word in words:
                if re.match(r"(examples|tests|core|plugins|vtk_filters)/", word):
                    self.assertTrue((SOURCE / word).exists(), f"{where}: {word}")

    def test_options_in_tables_exist(self):
        options = re.findall(r"^\| `(ANAMORPH_\w+)` \|", read("docs/building.md"), re.M)
        self.assertGreater(len(options), 5)
        for option in options:
            self.assertRegex(read("CMakeLists.txt"), rf"(?m)^ *(option|set)\({option} ")

    def test_packages_and_sections_exist(self):
        packages = read("tests/packages.txt")
        for where, words in all_commands():
            if words[0] == "tests/install_packages.sh":
                for section in words[1:]:
                    self.assertIn(f"\n[{section}]\n", packages, where)
            if "apt-get" in words:
                unpacked = re.search(r"packages=\((.*)\)", read("tests/unpack_vtk.sh"))[1].split()
                for package in words[words.index("install") + 1:]:
                    self.assertTrue(package in unpacked or f"\n{package}\n" in packages, f"{where}: {package}")

    def test_tests_that_are_named_exist(self):
        for where, words in all_commands():
            if words[0] == "ctest" and "-R" in words:
                for name in words[words.index("-R") + 1].split("|"):
                    listed = output(CTEST, "--test-dir", BUILD, "-N", "-R", name)
                    self.assertRegex(listed, "Total Tests: [1-9]", f"{where}: {name}")
            for filters in re.findall("^--gtest_filter=(.*)", "\n".join(words), re.M):
                for name in filters.split(":"):
                    listed = output(os.environ["ANAMORPH_CORE_TESTS"], "--gtest_list_tests", "--gtest_filter=" + name)
                    self.assertIn("\n  ", listed, f"{where}: {name}")


class Others(unittest.TestCase):
    def test_python_compiles(self):
        for block in BLOCKS:
            if block.language == "python":
                compile(block.text, str(block), "exec")

    def test_json_can_be_read(self):
        for block in BLOCKS:
            if block.language == "json":
                try:
                    json.loads(block.text)
                except ValueError as error:
                    self.fail(f"{block}: {error}")

    def test_links_to_files_exist(self):
        for path in tree.documents():
            text = path.read_text(encoding="utf-8")
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                self.assertTrue((path.parent / link).exists(), f"{path}: {link}")
            headings = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
                        for heading in re.findall(r"^#+ (.*)$", text, re.M)}
            for anchor in re.findall(r"\]\(#([^)]+)\)", text):
                self.assertIn(anchor, headings, path)


class Proofs(unittest.TestCase):
    """What docs/proofs.md names: its files are there, and the tests that hold a chapter to an oracle."""
    @classmethod
    def setUpClass(cls):
        cls.chapters = read("docs/proofs.md").split("\n## ")[1:]
        cls.sources = "\n".join(path.read_text(encoding="utf-8") for path in (SOURCE / "tests/core").glob("*.cpp"))

    def test_every_chapter_names_files_and_tests_that_are_there(self):
        tests = {f"{suite}.{name}" for suite, name in re.findall(r"\b(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", self.sources)}
        for chapter in self.chapters:
            title, words = chapter.split("\n")[0], re.findall(r"`([^`]+)`", " ".join(chapter.split()))
            files = [word for word in words if re.fullmatch(r"([\w-]+/)+[\w-]+\.(h|cpp)", word)]
            held = [word for word in words if re.fullmatch(r"[A-Z]\w+\.[A-Z]\w+", word)]
            with self.subTest(title):
                self.assertGreater(len(files), 2)
                self.assertGreater(len(held), 2)
            for file in files:
                self.assertTrue((SOURCE / "core/anamorph" / file).exists(), f"{title}: {file}")
            for name in held:
                self.assertTrue(name in tests, f"{title}: no test {name}")


class Architecture(unittest.TestCase):
    def test_the_drawing_shows_the_includes_that_there_are(self):
        drawn = output(sys.executable, str(SOURCE / "docs/site/architecture.py"), str(SOURCE), "/dev/stdout")
        self.assertTrue(drawn == read("docs/architecture.svg"), "docs/site/architecture.py draws docs/architecture.svg anew")

    def test_files_that_are_named_are_there(self):
        names = re.findall(r"`([\w/]+/[\w-]+\.(?:h|cpp|py))`", read("docs/architecture.md"))
        self.assertGreater(len(names), 15)
        for name in names:
            self.assertTrue((SOURCE / name).exists() or (SOURCE / "core/anamorph" / name).exists(), name)


if __name__ == "__main__":
    unittest.main()
