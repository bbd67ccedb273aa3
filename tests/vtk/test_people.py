# SPDX-License-Identifier: Apache-2.0
"""The script and the notebook of examples/people for users of ParaView."""
import json
import pathlib
import unittest

PEOPLE = pathlib.Path(__file__).parents[2] / "examples/people"


class People(unittest.TestCase):
    def check(self, names):
        self.assertLess(names["difference"], 1e-7)  # points are floats
        self.assertGreater(names["points"][:, 2].max(), 0.19)
        self.assertLess(names["points"][:, 2].min(), -0.09)

    def test_script(self):
        names = {}
        exec(compile((PEOPLE / "paraview_user.py").read_text(encoding="utf-8"), "paraview_user.py", "exec"), names)
        self.check(names)

    def test_notebook(self):
        names = {}
        for cell in json.loads((PEOPLE / "paraview_user.ipynb").read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), "paraview_user.ipynb", "exec"), names)
        self.check(names)


if __name__ == "__main__":
    unittest.main()
