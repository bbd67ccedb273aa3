# SPDX-License-Identifier: Apache-2.0
"""anamorph run and anamorph doctor: of a program that lies where an installation puts it, with hosts that are scripts."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["ANAMORPH"]
VARIABLES = ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH")
READS = 'case ":$OIIO_LIBRARY_PATH:" in *oiio-2.4*) echo "$2 :    6 x    5, 3 channel" ;; *) echo "oiiotool ERROR: read : no reader"; echo "Full command"; exit 1 ;; esac'


class Hosts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()
        (self.folder / "usr/bin").mkdir(parents=True)
        self.program = shutil.copy(PROGRAM, self.folder / "usr/bin/anamorph")
        self.plugin = self.folder / "usr/lib/anamorph/oiio-2.4/anamorph_recipes.imageio.so"
        self.plugin.parent.mkdir(parents=True)
        self.plugin.touch()
        self.host("ldd", r"printf '\tlibOpenImageIO.so.2.4 => /usr/lib/libOpenImageIO.so.2.4 (0x1)\n'")

    def host(self, name, lines):
        file = self.folder / "hosts" / name
        file.parent.mkdir(exist_ok=True)
        file.write_text("#!/bin/sh\n" + lines + "\n")
        file.chmod(0o755)

    def run_program(self, *arguments, **environment):
        bare = {k: v for k, v in os.environ.items() if k not in (*VARIABLES, "PV_PLUGIN_PATH")}
        # None of the machine's own hosts, but for /usr/bin/python3, which doctor asks in any case.
        bare["PATH"] = environment.pop("PATH", f"{self.folder}/hosts")
        result = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=200, cwd=self.folder,
                                env={**bare, **environment})
        return result.returncode, result.stdout, result.stderr

    def line(self, page, words):
        found = [line for line in page.split("\n") if words in line]
        self.assertEqual(len(found), 1, page)
        return found[0]

    def test_run_sets_both_variables_and_keeps_what_is_there(self):
        self.host("show", 'echo "$OIIO_LIBRARY_PATH|$OPENIMAGEIO_PLUGIN_PATH"')
        ours = str(self.plugin.parent)
        for given, expected in (({}, f"{ours}|{ours}"), ({"OIIO_LIBRARY_PATH": "/a:/b"}, f"{ours}:/a:/b|{ours}"),
                                ({"OIIO_LIBRARY_PATH": f"/a:{ours}", "OPENIMAGEIO_PLUGIN_PATH": ""}, f"/a:{ours}|{ours}")):
            self.assertEqual(self.run_program("run", "show", **given), (0, expected + "\n", ""))

    def test_run_takes_every_version_that_is_there(self):
        other = self.folder / "usr/lib/anamorph/oiio-3.1"
        other.mkdir()
        shutil.copy(self.plugin, other)
        (self.folder / "usr/lib/anamorph/oiio-2.5").mkdir()  # with nothing in it
        self.host("show", 'echo "$OIIO_LIBRARY_PATH"')
        self.assertEqual(self.run_program("run", "show")[1], f"{self.plugin.parent}:{other}\n")

    def test_run_hands_on_words_and_status(self):
        self.host("count", 'echo "$#:$1:$2:$3"; exit 7')
        self.assertEqual(self.run_program("run", "count", "--help", "a b", "-o"), (7, "3:--help:a b:-o\n", ""))

    def test_run_says_what_is_wrong(self):
        (self.folder / "hosts/data").write_text("x")
        for arguments, expected, message in ((["run"], 1, "COMMAND is required"), (["run", "nonsuch"], 127, "nonsuch: there is no such command"),
                                             (["run", ""], 127, "there is no such command"), (["run", "a\nb"], 127, "a?b: "),
                                             (["run", "data"], 126, "data: Permission denied"), (["run", "--wibble", "x"], 1, "--wibble")):
            status, page, error = self.run_program(*arguments)
            self.assertEqual((status, page), (expected, ""), arguments)
            self.assertTrue(error.startswith("anamorph: ") and message in error and error.count("\n") == 1, error)
        self.plugin.unlink()
        status, page, error = self.run_program("run", "count")
        self.assertEqual((status, page), (1, ""))
        self.assertRegex(error, r"^anamorph: no plugin for OpenImageIO: .*/usr/lib/anamorph/oiio-2\.4 and .*Debian: anamorph-openimageio\)\n$")

    def test_doctor_finds_nothing_wrong(self):
        self.host("oiiotool", f'[ "$1" = --version ] && echo 2.4.7.1 && exit; {READS}')
        ours = {name: str(self.plugin.parent) for name in VARIABLES}
        status, page, error = self.run_program("doctor", **ours)
        self.assertEqual(error, "")
        self.assertEqual(self.line(page, "plugin for"), f"ok    plugin for OpenImageIO 2.4: {self.plugin}")
        self.assertEqual(self.line(page, "oiiotool 2"), f"ok    oiiotool 2.4.7.1 ({self.folder}/hosts/oiiotool): reads recipes")
        self.assertEqual(self.line(page, "ParaView"), "-     ParaView: not here, as far as PATH says")
        self.assertNotIn(str(os.getpid()), page)
        self.assertEqual(status, int("FAULT" in page))  # /usr/bin/python3 is what it is
        self.assertEqual(list(pathlib.Path(tempfile.gettempdir()).glob("anamorph-doctor-*")), [])

    def test_doctor_tells_of_missing_variables(self):
        self.host("oiiotool", f'[ "$1" = --version ] && echo 2.4.7.1 && exit; {READS}')
        status, page, _ = self.run_program("doctor", OPENIMAGEIO_PLUGIN_PATH=str(self.plugin.parent))
        self.assertEqual(status, 1)
        self.assertTrue(self.line(page, "hosts/oiiotool").startswith("FAULT oiiotool 2.4.7.1"), page)
        self.assertTrue(self.line(page, "hosts/oiiotool").endswith("reads no recipes: read : no reader"), page)
        after = page.split("hosts/oiiotool", 1)[1]
        self.assertIn('\n      it does by "anamorph run"; not naming the plugin\'s folder: OIIO_LIBRARY_PATH\n', after)
        self.assertIn("\n      for this shell: export" + "".join(f" {name}={self.plugin.parent}" for name in VARIABLES) + "\n", after)
        self.assertIn("-     OIIO_LIBRARY_PATH: not set\n", page)

    def test_doctor_tells_of_another_version(self):
        self.host("oiiotool", '[ "$1" = --version ] && echo 3.2.2.0 && exit; echo no; exit 1')
        status, page, _ = self.run_program("doctor")
        self.assertEqual(status, 1)
        self.assertIn("      it has OpenImageIO 3.2.2.0, and the plugin is for 2.4\n", page)

    def test_doctor_tells_of_a_plugin_that_lacks_a_library(self):
        self.host("ldd", r"printf '\tlibOpenImageIO.so.2.4 => not found\n\tlibc.so.6 => /lib/libc.so.6 (0x1)\n'")
        status, page, _ = self.run_program("doctor")
        self.assertEqual(status, 1)
        self.assertEqual(self.line(page, "plugin for"), f"FAULT plugin for OpenImageIO 2.4: {self.plugin} lacks libOpenImageIO.so.2.4")

    def test_doctor_tells_that_there_is_no_plugin(self):
        self.plugin.unlink()
        self.host("oiiotool", f'[ "$1" = --version ] && echo 2.4.7.1 && exit; {READS}')
        status, page, _ = self.run_program("doctor")
        self.assertEqual(status, 1)
        self.assertIn("no plugin for OpenImageIO (Debian: anamorph-openimageio)", page)
        self.assertIn("there is no plugin (Debian: anamorph-openimageio)", page)

    def test_doctor_asks_python_and_vtk(self):
        """A Python whose modules are ours: an OpenImageIO that cannot be loaded, filters that cannot."""
        modules = self.folder / "modules"
        for name, text in (("OpenImageIO", "raise ImportError('libfoo.so: no such file')"), ("vtkmodules/__init__", ""),
                           ("vtkmodules/vtkCommonCore", "class vtkVersion:\n    GetVTKVersion = staticmethod(lambda: '9.9.0')"),
                           ("anamorph/__init__", "raise ImportError('libvtk.so: no such file')"), ("anamorph/AnamorphFilters", "")):
            (modules / f"{name}.py").parent.mkdir(parents=True, exist_ok=True)
            (modules / f"{name}.py").write_text(text + "\n")
        self.host("python3", f'PYTHONPATH={modules} exec /usr/bin/python3 "$@"')
        status, page, _ = self.run_program("doctor")
        self.assertEqual(status, 1)
        python = f"({self.folder}/hosts/python3)"
        self.assertIn(f"FAULT python {python}: its OpenImageIO cannot be loaded: ImportError: libfoo.so: no such file\n", page)
        # The import of a package whose __init__ fails: found where its parts are looked for.
        self.assertIn(f"FAULT VTK 9.9.0 {python}: cannot load the filters: ImportError: libvtk.so: no such file\n", page)

    def test_doctor_asks_paraview(self):
        for says, expected in (("echo version 5.11.0; echo filters True", "ok    ParaView 5.11.0 "),
                               ("echo version 5.11.0; echo filters False", "-     ParaView 5.11.0 "),
                               ("echo no screen >&2; exit 1", "FAULT ParaView ("), ("kill -SEGV $$", "FAULT ParaView (")):
            self.host("pvpython", says)
            _, page, _ = self.run_program("doctor")
            self.assertTrue(self.line(page, "pvpython").startswith(expected), page)

    def test_doctor_does_not_wait_for_what_a_host_leaves_running(self):
        self.host("pvpython", "/bin/sleep 90 &\necho bad; exit 1")
        _, page, _ = self.run_program("doctor")
        self.assertTrue(self.line(page, "pvpython").endswith(": cannot be asked: bad"), page)  # not: within a minute

    def test_doctor_reads_no_more_than_it_needs(self):
        self.host("pvpython", "/usr/bin/yes | /usr/bin/head -c 3000000; exit 1")
        _, page, _ = self.run_program("doctor")
        self.assertTrue(self.line(page, "pvpython").endswith(": cannot be asked: y"), page)

    def test_doctor_prints_nothing_that_a_terminal_obeys(self):
        self.host("pvpython", r"printf '\033[2J\000\377bad'; exit 1")
        _, page, _ = self.run_program("doctor")
        self.assertRegex(self.line(page, "pvpython"), r"^FAULT ParaView \(.*\): cannot be asked: \?\[2J\?\?bad$")

    def test_doctor_says_where_it_cannot_write(self):
        status, _, error = self.run_program("doctor", TMPDIR=str(self.folder / "nowhere"))
        self.assertEqual(status, 1)
        self.assertEqual(error, f"anamorph: TMPDIR={self.folder}/nowhere: no folder can be made there\n")


if __name__ == "__main__":
    unittest.main()
