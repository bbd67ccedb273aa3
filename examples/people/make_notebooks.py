#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a notebook of each script of this folder that has cells ("# %%"): make_notebooks.py [FOLDER]; by default into the scripts' own."""
import json
import pathlib
import re
import sys


def cells_of(text):
    """(kind, source) of the cells of a script; of words without their marks."""
    for head, body in re.findall(r"^# %%(.*)\n((?:(?!# %%).*\n?)*)", text, re.M):
        body = body.strip("\n")
        if "[markdown]" in head:
            yield "markdown", "\n".join(line.removeprefix("#").removeprefix(" ") for line in body.split("\n"))
        else:
            yield "code", body


def notebook(text):
    cells = []
    for number, (kind, source) in enumerate(cells_of(text)):
        cell = {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": source.splitlines(keepends=True)}
        cells.append(cell if kind == "markdown" else {**cell, "execution_count": None, "outputs": []})
    return {"cells": cells, "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}, "nbformat": 4, "nbformat_minor": 5}


def scripts(folder):
    return [path for path in sorted(folder.glob("*.py")) if path.name != "make_notebooks.py" and "\n# %%" in path.read_text(encoding="utf-8")]


if __name__ == "__main__":
    here = pathlib.Path(__file__).parent
    target = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here
    for script in scripts(here):
        text = json.dumps(notebook(script.read_text(encoding="utf-8")), indent=1, ensure_ascii=False) + "\n"
        (target / script.with_suffix(".ipynb").name).write_text(text, encoding="utf-8")
