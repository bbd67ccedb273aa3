# SPDX-License-Identifier: Apache-2.0
"""The Debian packages of a build: what they say, what hosts see once they are unpacked, and that a purge leaves nothing."""
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import debs
from debs import BUILD, output

SERIES = ".".join(os.environ["ANAMORPH_VERSION"].split(".")[:2])
NAMES = ["anamorph", "anamorph-openimageio", "libanamorph-dev", f"libanamorph{SERIES}", "python3-anamorph"]


def setUpModule():
    global ROOT, DEBS
    ROOT, DEBS = debs.make()


def field(package, name):
    return debs.field(DEBS[package], name)


def files_of(package):
    """(permissions, owner, path) of what is in a package."""
    for line in output("dpkg-deb", "-c", DEBS[package]).splitlines():
        words = line.split(None, 5)
        yield words[0], words[1], words[5]


class Packages(unittest.TestCase):
    def test_names_and_versions(self):
        self.assertEqual(sorted(DEBS), NAMES)
        for name in NAMES:
            self.assertRegex(field(name, "Version"), r"^%s(\+deb\d+)?$" % re.escape(os.environ["ANAMORPH_VERSION"]))

    def test_documents_name_the_version(self):
        docs = ROOT / "usr/share/doc/anamorph"
        self.assertEqual(re.search(r"(?m)^## (.*)$", (docs / "CHANGELOG.md").read_text())[1], os.environ["ANAMORPH_VERSION"])
        for page in ("install.md", "cpp.md"):
            self.assertEqual(set(re.findall(r"libanamorph(?:\.so\.)?(\d+\.\d+)", (docs / "docs" / page).read_text())), {SERIES}, page)

    def test_depends(self):
        version = field("anamorph", "Version")
        self.assertIn(f"anamorph (= {version})", field("anamorph-openimageio", "Depends"))
        self.assertRegex(field("anamorph-openimageio", "Depends"), r"libopenimageio\d")
        # Programs start where there is no host.
        self.assertNotRegex(field("anamorph", "Depends"), "openimageio|vtk|paraview")
        self.assertIn("libc6", field("anamorph", "Depends"))
        self.assertIn("anamorph-openimageio", field("anamorph", "Recommends"))
        # Python's own version, since a part is C++.
        minor = sys.version_info.minor
        self.assertIn(f"python3 (>= 3.{minor}~), python3 (<< 3.{minor + 1}~)", field("python3-anamorph", "Depends"))
        for needed in ("libglm-dev", "libhwy-dev", "libpugixml-dev", "libopenimageio-dev (<< ", f"libanamorph{SERIES} (= {version})"):
            self.assertIn(needed, field("libanamorph-dev", "Depends"))

    def test_shared_library(self):
        library = next(ROOT.glob("usr/lib/**/libanamorph.so.*.*.*"))
        self.assertIn(f"Library soname: [libanamorph.so.{SERIES}]", output("readelf", "-d", library))
        names = {path.name for path in library.parent.glob("libanamorph.so*")}
        self.assertEqual(names, {"libanamorph.so", f"libanamorph.so.{SERIES}", library.name})
        of_runtime = " ".join(path for _, _, path in files_of(f"libanamorph{SERIES}"))
        self.assertNotRegex(of_runtime, r"libanamorph\.so( |$)|\.h |\.a ")
        # What Debian's tools find of it: how others depend on it, and that the loader's list is made anew.
        self.assertEqual(output("dpkg-deb", "-I", DEBS[f"libanamorph{SERIES}"], "shlibs").split()[:3],
                         ["libanamorph", SERIES, f"libanamorph{SERIES}"])
        self.assertIn("ldconfig", output("dpkg-deb", "-I", DEBS[f"libanamorph{SERIES}"], "triggers"))

    def test_what_every_package_has(self):
        for name in NAMES:
            files = list(files_of(name))
            paths = [path for _, _, path in files]
            self.assertEqual(len(paths), len(set(paths)))
            self.assertIn(f"./usr/share/doc/{name}/copyright", paths)
            changes = gzip.open(ROOT / f"usr/share/doc/{name}/changelog.gz", "rt").read()
            self.assertIn(f"anamorph ({field(name, 'Version')}) ", changes)
            for permissions, owner, path in files:
                self.assertEqual(owner, "root/root", path)
                if not permissions.startswith("l"):
                    self.assertIn(permissions[1:], ("rwxr-xr-x", "rw-r--r--"), path)
                self.assertRegex(path, r"^\./(usr/|etc/profile\.d/|etc/$|$)")
            self.assertNotIn(BUILD, " ".join(paths))

    def test_no_file_is_in_two(self):
        seen = {}
        for name in NAMES:
            for permissions, _, path in files_of(name):
                if not permissions.startswith("d"):
                    self.assertNotIn(path, seen, (name, seen.get(path)))
                    seen[path] = name

    def test_lintian_has_no_error(self):
        debs.check_by_lintian(self, DEBS.values())


class Hosts(unittest.TestCase):
    """Stock programs of this machine, and the plugin of the packages."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "sky.ppm").write_bytes(b"P6\n16 8\n255\n" + bytes(range(128)) * 3)
        (self.folder / "view.pano").write_text("src=sky.ppm\nto=rectilinear\nfov=95\nyaw=30\nsize=40x30\n")
        self.program = str(ROOT / "usr/bin/anamorph")
        self.plugin = next(ROOT.glob("usr/lib/anamorph/oiio-*/*.so"))
        self.bare = {k: v for k, v in os.environ.items() if k not in ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH")}

    def run_bare(self, *command):
        return output(*command, cwd=self.folder, env=self.bare)

    def test_oiiotool_draws_by_the_variable_and_by_anamorph_run(self):
        first = output("oiiotool", "view.pano", "-o", "one.png", cwd=self.folder,
                       env={**self.bare, "OIIO_LIBRARY_PATH": str(self.plugin.parent)})
        self.assertEqual(first, "")
        self.run_bare(self.program, "run", "oiiotool", "view.pano", "-o", "two.png")
        self.run_bare(self.program, "draw", "view.pano", "-o", "three.png")
        hashes = self.run_bare(self.program, "hash", "view.pano", "one.png", "two.png", "three.png").split()[::2]
        self.assertEqual(len(hashes), 4)
        self.assertEqual(len(set(hashes)), 1)

    def test_python_draws(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import OpenImageIO"], capture_output=True).returncode:
            self.skipTest("python3-openimageio is not there")
        lines = "import OpenImageIO as o; b = o.ImageBuf('view.pano'); b.read(); print(b.spec().width, b.geterror())"
        self.assertEqual(self.run_bare(self.program, "run", "/usr/bin/python3", "-c", lines).split(), ["40"])

    def test_the_plugin_and_programs_name_no_folder_of_the_build(self):
        for file in [self.plugin, *ROOT.glob("usr/bin/*")]:
            self.assertNotIn(BUILD.encode(), file.read_bytes(), file)
            self.assertNotRegex(output("readelf", "-d", file), "RPATH|RUNPATH")

    def test_login_shells_get_both_variables_once(self):
        script = (ROOT / "etc/profile.d/anamorph.sh").read_text()
        folder = re.search(r'\[ -d "(/usr/[^"]*)" \]', script)[1]
        self.assertEqual(ROOT / folder[1:], self.plugin.parent)
        lines = 'set -eu\n%s\n%s\necho "$OIIO_LIBRARY_PATH $OPENIMAGEIO_PLUGIN_PATH"\n'
        here = script.replace(folder, str(self.plugin.parent))
        self.assertEqual(output("sh", "-c", lines % (here, here), env={}).split(), 2 * [str(self.plugin.parent)])
        self.assertEqual(output("sh", "-c", lines % (here, here), env={"OIIO_LIBRARY_PATH": "/mine"}).split(),
                         [f"{self.plugin.parent}:/mine", str(self.plugin.parent)])
        # Of a package that is removed and not purged the file stays, and is to do nothing.
        gone = lines.replace("$OIIO_LIBRARY_PATH $OPENIMAGEIO_PLUGIN_PATH", "${OIIO_LIBRARY_PATH-none}")
        nowhere = script.replace(folder, "/nowhere")
        self.assertEqual(output("sh", "-c", gone % (nowhere, ""), env={}), "none\n")

    def test_sessions_get_both_variables(self):
        lines = (ROOT / "usr/lib/environment.d/90-anamorph.conf").read_text().splitlines()[1:]
        folder = "/" + str(self.plugin.parent.relative_to(ROOT))
        self.assertEqual(lines, [f"{name}={folder}${{{name}:+:${name}}}" for name in ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH")])


class Purge(unittest.TestCase):
    def test_leaves_nothing(self):
        as_root = [] if os.getuid() == 0 else ["fakeroot"]
        if as_root and not shutil.which("fakeroot"):
            self.skipTest("fakeroot is not there")
        root = ROOT.parent / "installed"
        (root / "var/lib/dpkg/info").mkdir(parents=True)
        (root / "var/lib/dpkg/updates").mkdir()
        (root / "var/lib/dpkg/status").touch()
        dpkg = [*as_root, "dpkg", f"--root={root}", "--force-depends", "--force-script-chrootless", "--log=/dev/null"]
        output(*dpkg, "-i", *DEBS.values())
        # Again, as an upgrade does it: what the user changed in /etc stays.
        profile = root / "etc/profile.d/anamorph.sh"
        profile.write_text("# mine\n")
        output(*dpkg, "--force-confold", "-i", *DEBS.values())
        self.assertEqual(profile.read_text(), "# mine\n")
        output(*dpkg, "--purge", *NAMES)
        left = [path for path in root.rglob("*") if not path.is_relative_to(root / "var/lib/dpkg") and path != root / "var"
                and path != root / "var/lib"]
        self.assertEqual(left, [])


if __name__ == "__main__":
    unittest.main()
