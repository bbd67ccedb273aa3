# SPDX-License-Identifier: Apache-2.0
"""The scripts of examples/people run and make what they say, and their notebooks have the same cells."""
import contextlib
import io
import json
import os
import pathlib
import runpy
import sys
import tempfile
import unittest

import numpy as np

PEOPLE = pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"], "examples/people")
sys.path.insert(0, str(PEOPLE))
import make_notebooks  # noqa: E402


class People(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def run_both(self, name):
        """The names that the script leaves and what it prints, which are those of its notebook."""
        script, notebook = PEOPLE / f"{name}.py", json.loads((PEOPLE / f"{name}.ipynb").read_text(encoding="utf-8"))
        self.assertEqual(notebook, make_notebooks.notebook(script.read_text(encoding="utf-8")), f"{name}.ipynb: make_notebooks.py makes it anew")
        with contextlib.redirect_stdout(io.StringIO()) as of_script:
            names = runpy.run_path(str(script))
        with contextlib.redirect_stdout(io.StringIO()) as of_notebook:
            cells = {}
            for cell in notebook["cells"]:
                if cell["cell_type"] == "code":
                    exec(compile("".join(cell["source"]), name, "exec"), cells)
        self.assertEqual(of_script.getvalue(), of_notebook.getvalue())
        return names, of_script.getvalue()

    def test_photographer(self):
        names, _ = self.run_both("photographer")
        self.assertTrue(0 < names["bound"] <= 0.01)
        for file in ("view.png", "planet.png", "straight.png"):
            self.assertGreater(os.path.getsize(file), 10000)
        # The middle of a picture that was bent and made straight is what it was, but for two interpolations.
        middle = np.s_[160:-160, 220:-220]
        self.assertLess(np.abs(names["straight"] - names["view"])[middle].mean(), 0.02)
        self.assertGreater(np.abs(names["bent"] - names["view"]).mean(), 0.03)

    def test_compositor(self):
        names, said = self.run_both("compositor")
        self.assertIn("warp of pano of lens", said)
        self.assertLess(np.abs(names["again"] - names["plate"])[names["middle"]].max(), 0.01)
        self.assertEqual(names["comp"].shape, (540, 960, 3))

    def test_choreographer(self):
        names, said = self.run_both("choreographer")
        self.assertIn("the fastest limb is the right", said)
        self.assertEqual(names["paths"].shape, (len(names["frames"]), 4, 3))
        self.assertTrue(os.path.getsize("phrase.svg") > 1000 and names["shaded"].any())

    def test_every_script_has_a_notebook(self):
        self.assertEqual([path.stem for path in make_notebooks.scripts(PEOPLE)], [path.stem for path in sorted(PEOPLE.glob("*.ipynb"))])
        self.assertEqual(len(make_notebooks.scripts(PEOPLE)), 4)


if __name__ == "__main__":
    unittest.main()
