# SPDX-License-Identifier: Apache-2.0
"""The packages for ParaView: what they say, and that ParaView's programs load the plugin by themselves once they are unpacked."""
import os
import re
import shutil
import unittest

import debs
from debs import output

NAMES = ["paraview-anamorph", "python3-paraview-anamorph"]


def setUpModule():
    global ROOT, DEBS
    ROOT, DEBS = debs.make()


def field(package, name):
    return debs.field(DEBS[package], name)


class ParaViewPackages(unittest.TestCase):
    def test_names_and_what_they_need(self):
        self.assertEqual(sorted(DEBS), NAMES)
        version = field(NAMES[0], "Version")
        self.assertRegex(version, r"^%s(\+deb\d+)?$" % re.escape(os.environ["ANAMORPH_VERSION"]))
        self.assertRegex(field(NAMES[0], "Depends"), r"paraview \(>= ")
        for needed in (f"{NAMES[0]} (= {version})", f"python3-anamorph (= {version})", "python3-paraview"):
            self.assertIn(needed, field(NAMES[1], "Depends"))
        self.assertEqual(field(NAMES[1], "Conflicts"), "python3-vtk9-anamorph")

    def test_lintian_has_no_error(self):
        debs.check_by_lintian(self, DEBS.values())

    def test_no_file_is_that_of_another_package(self):
        files = {path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*") if not path.is_dir()}
        # Those of the operations and of the modules for VTK.
        self.assertFalse({"usr/lib/python3/dist-packages/anamorph/__init__.py", "usr/bin/anamorph"} & files)
        libraries = [path for path in files if re.match(r"usr/lib/libAnamorph", path)]
        self.assertGreaterEqual(len(libraries), 8)
        for path in libraries:
            self.assertRegex(path, r"-pv\d+\.\d+\.so\.\d+")

    def test_nothing_names_a_folder_of_the_build(self):
        for path in ROOT.rglob("*.so*"):
            for runpath in re.findall(r"(?:RPATH|RUNPATH).*\[(.*)\]", output("readelf", "-d", path)):
                for folder in filter(None, runpath.split(":")):
                    self.assertTrue(folder.startswith("$ORIGIN"), (path, runpath))

    def test_programs_load_the_plugin_by_themselves(self):
        plugins = (ROOT / "usr/bin/paraview.conf").read_text().strip()
        self.assertTrue((ROOT / plugins[1:]).exists(), plugins)
        # As it is with / in place of the folder.
        program = shutil.copy(shutil.which("pvpython"), ROOT.parent)
        (ROOT.parent / "paraview.conf").write_text(f"{ROOT}{plugins}\n")
        (ROOT.parent / "script.py").write_text(
            "from paraview.simple import *\n"
            "surface = AnamorphDeform(Input=Plane(XResolution=20, YResolution=20), Deformations=[0, 0, 1, 1, 0, 0, 1, 0, 1])\n"
            "surface.UpdatePipeline()\n"
            "print('top', surface.GetDataInformation().GetBounds()[5])\n"
            "from anamorph import AnamorphFilters\n"
            "print(AnamorphFilters.vtkAnamorphDeform().GetClassName())\n"
            "print(open('/proc/self/maps').read())\n")
        told = output(program, ROOT.parent / "script.py", env={
            **os.environ, "LD_LIBRARY_PATH": f"{ROOT}/usr/lib", "PYTHONPATH": f"{ROOT}/usr/lib/python3/dist-packages"})
        self.assertGreater(float(re.search(r"top (\S+)", told)[1]), 0.9)
        self.assertIn("vtkAnamorphDeform\n", told)
        loaded = set(re.findall(r"/\S*[Aa]namorph\S*\.so\S*", told))
        self.assertGreaterEqual(len(loaded), 5)
        for path in loaded:
            self.assertTrue(path.startswith(str(ROOT.parent)), path)


if __name__ == "__main__":
    unittest.main()
