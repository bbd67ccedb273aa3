#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The blocks of code of every .md file of the tree, and which test runs each.

Usage: blocks.py RUN         prints the shell lines that the test RUN runs, in their order, with what it adds to them
       blocks.py RUN FOLDER  the same, and writes into FOLDER the files that blocks show and these lines read

RUN is one of those that the tables below name. ANAMORPH_SOURCE_DIR is the tree.
"""
import os
import pathlib
import re
import sys
from typing import NamedTuple


class Block(NamedTuple):
    file: str  # relative to the tree
    line: int  # of its first line, from 1
    language: str
    text: str

    def __str__(self):
        return f"{self.file}:{self.line}"


class Line(NamedTuple):
    """What is done with the lines of shell blocks that begin so."""
    start: str       # a regular expression
    runs: tuple      # the tests that run it; none of them: `why` says why not, or which test runs it in another way
    more: str = ""   # goes to its end, so that it is cheap, or ends by itself
    why: str = ""


class Other(NamedTuple):
    """What is done with the blocks of another language that have these words in them."""
    language: str
    words: str
    run: str         # the test that runs it
    name: str = ""   # of the file that the test gets the block in
    line: str = ""   # of the shell, which reads it


XVFB = r'xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" '
LINES = [
    # What stock programs draw by the plugin, and ours without a host: the release build.
    Line(r"export OIIO_LIBRARY_PATH=", ("oiio",)),
    Line(r"cd build/demo/out$", ("oiio",)),
    Line(r"export PATH=DIR/bin:", (), why="tests/consumer/consumer_test.cmake loads what is installed by these variables"),
    Line(r"oiiotool ", ("oiio",)),
    Line(r"for face in .*oiiotool ", ("oiio",)),
    Line(r"ffmpeg -pattern_type ", (), why="tests/command/test_pictures.py makes a film of frames by it"),
    Line(r"ffmpeg (?!-pattern_type )", ("oiio",)),
    Line(r"anamorph-figure ", ("command",)),
    Line(r"anamorph-machine ", ("command",)),
    Line(r"(parallel )?anamorph (hash|draw|stmap|join|explain) ", (),
         why="tests/command/test_pictures.py draws, joins and explains, and runs these of parallel; test_stmap.py draws maps"),
    Line(r"anamorph figure ", (), why="tests/command/test_help.py runs it, and docs_command the same of anamorph-figure"),
    Line(r"anamorph bench ", (), why="tests/python/test_bench.py runs it"),
    Line(r"anamorph new ", (), why="tests/command/test_help.py writes and draws such recipes of every operation"),
    Line(r"sbatch ", (), why="tests/farm.sh submits such an array, in the nightly run: Slurm's daemons are not for every machine"),
    Line(r"build/release/tests/core/anamorph_core_tests ", (),
         why="its tests are run one by one; test_blocks.py looks whether the filter finds some"),
    Line(r"ctest --preset ", (), why="this test is one of them; test_blocks.py looks for the presets and the tests' names"),
    Line(r"examples/demo\.sh ", (), why="tests/run.sh runs it"),
    Line(r"tests/run\.sh ", (), why="it runs this test, among others"),
    Line(r"tests/nightly\.sh ", (), why="it takes hours, and runs this test before them"),
    Line(r"cmake --preset release -DANAMORPH_TESTS=OFF && ", (), why="tests/packages/test_packages.py makes the packages of the build"),
    Line(r"sudo apt install \./", (), why="tests/packages.sh installs them in a clean Debian"),
    Line(r"docker (build|run) ", (), why="tests/packages.sh does what they do, by Buildah"),
    Line(r"anamorph (run|doctor)", (), why="tests/command/test_hosts.py runs both"),
    Line(r"sudo apt-get install ", (), why="these packages conflict with ParaView's; test_blocks.py looks for their names"),
    Line(r"tests/install_packages\.sh ", (), why="tests install nothing; test_blocks.py looks for the sections"),
    # Builds: configured in a fresh folder; of building, ninja says what it would do.
    Line(r"cmake --preset release (?!-DANAMORPH_TESTS)", ("configure.release",)),
    Line(r"cmake (--build )?--preset vtk\b", ("configure.vtk",)),
    Line(r"cmake (--build )?--preset paraview\b", ("configure.paraview",)),
    # VTK.
    Line(r"tests/unpack_vtk\.sh build/vtk-9\.1", ("configure.vtk", "vtk")),
    Line(r"export LD_LIBRARY_PATH=\$PWD/build/vtk-9\.1", ("configure.vtk", "vtk")),
    Line(r"export PYTHONPATH=\$PWD/build/vtk/", ("vtk",)),
    Line(r"export PYTHONPATH=\$PWD/build/release/python$", (), why="tests/python/CMakeLists.txt sets it"),
    Line(XVFB + r"/usr/bin/python3 examples/vtk/expressions\.py ", ("vtk",), more=" --size 60"),
    Line(XVFB + r"/usr/bin/python3 tests/bench/drape_peers\.py ", ("vtk",), more=" --size 64 --rounds 1"),
    Line(XVFB + r"/usr/bin/python3 tests/bench/ellipsoid_mapper\.py", ("vtk",), more=" --count 50 --size 64 --frames 1"),
    Line(r"build/vtk/bin/anamorph-view .* --picture ", ("vtk",)),
    Line(r"build/vtk/bin/anamorph-view (?!.*--picture)", ("vtk",), more=" --picture seen.png"),
    Line(r"build/vtk/bin/anamorph-warp .* --picture ", ("vtk",)),
    Line(r"build/vtk/bin/anamorph-warp (?!.*--picture)", ("vtk",), more=" --picture seen.png"),
    # ParaView.
    Line(r"export PV_PLUGIN_PATH=", ("paraview",)),
    Line(r"paraview$", (), why="its window waits for a user; test_gui.py opens it, and closes it again"),
    Line(XVFB + r"pvbatch examples/paraview/face\.py ", ("paraview",), more=" --frames 2 --points 65"),
    Line(XVFB + r"pvbatch examples/paraview/figures\.py ", ("paraview",)),
]
OTHERS = [
    Other("recipe", "src=panorama.exr", "oiio", "view.pano", "oiiotool view.pano -o from_a_file.png"),
    Other("pto", 'n"photo.jpg"', "oiio", "hugin.pto", "oiiotool hugin.pto.pano -o of_project.exr"),
    Other("json", '"deformations"', "oiio", "raised.json", 'oiiotool "round.png.drape?deform=raised.json" -o raised.png'),
    Other("json", '"keys"', "oiio", "turning.json",
          'oiiotool "round.png.drape?surface=page_turn&keys=turning.json&frame=12" -o turning.png'),
    Other("json", '"columns"', "core: Docs.ItsFilesCanBeRead"),
    Other("json", '"features"', "core: Docs.ItsFilesCanBeRead"),
    Other("json", '"panoramas"', "core: Docs.ItsFilesCanBeRead"),
    Other("c++", "#include <anamorph/panorama.h>", "example_panorama"),
    Other("cmake", "project(Mine", "consumer: the page's project"),
    Other("c++", "#include <anamorph/oiio_ops.h>", "consumer: page_view"),
    Other("c++", "anamorph::mesh_warp(dst", "consumer: page_calls"),
    Other("nudes", "* What is behind a star", "command", "one.nudes"),
    Other("nudes", "subroutine wave 3 limb at angle", "command", "wave.nudes",
          "anamorph-figure frames --dialect strict wave.nudes -o wave.3"),
    Other("nudes", "quadratic 25 49 moveby ball", "command: test_every_script_of_the_tutorial_runs"),
    Other("nudes", "joint ankle foot", "command: test_every_script_of_the_tutorial_runs"),
    Other("nudes", "figure pip 5", "command: test_every_script_of_the_tutorial_runs"),
    Other("nudes", "figure pair 2", "command: test_every_script_of_the_tutorial_runs"),
    Other("python", "view = anamorph.pano(", "python_page", "view"),
    Other("python", "the_same = anamorph.warp(", "python_page", "warp"),
    Other("python", "image = anamorph.Image(", "python_page", "image"),
    Other("python", "tile = picture.draw(", "python_page", "picture"),
    Other("python", "joined = anamorph.Picture(", "python_page", "chain"),
    Other("python", "there_and_back = ", "python_page", "maps"),
    Other("python", "paths = np.stack(", "python_page", "figures"),
    Other("python", "straight = lens.draw(photo)", "python_page", "start"),
    Other("python", "print(vtkAnamorphReliefSource())", "vtk", "start"),
    # In the order in which python_blocks.py and paraview_blocks.py run them.
    Other("python", "import vtkAnamorphDeform\n", "vtk", "deform"),
    Other("python", "deform.SetDepth(", "vtk", "depths"),
    Other("python", "deform.AnchorDeformation(", "vtk", "anchor"),
    Other("python", "deform.AddDefaultDeformation(", "vtk", "first bump"),
    Other("python", "import vtkAnamorphDeformImage\n", "vtk", "image"),
    Other("python", "import vtkAnamorphNonlinearTexture\n", "vtk", "bent"),
    Other("python", "import vtkAnamorphBlendShapeWriter\n", "vtk", "writer"),
    Other("python", "import vtkAnamorphImageWarp\n", "vtk", "warp"),
    Other("python", "import vtkAnamorphImageMorph\n", "vtk", "morph"),
    Other("python", "import vtkAnamorphPanoramaProjection\n", "vtk", "project"),
    Other("python", "vtkAnamorphProjectionShader()", "vtk", "shader"),
    Other("python", "projector.SetCircles(", "vtk", "mosaics"),
    Other("python", "import vtkAnamorphPanoramaView\n", "vtk", "view"),
    Other("python", "vtkAnamorphEllipsoidMapper()", "vtk", "mapper"),
    Other("python", "vtkLabeledDataMapper()", "vtk", "labels"),
    Other("python", "mapper.AddTexture(", "vtk", "textures"),
    Other("python", 'SetRepresentationType("Ellipsoids")', "paraview", "ellipsoids"),
    Other("python", "EllipsoidTextures, ", "paraview", "textures"),
    Other("python", 'SetRepresentationType("Panorama")', "paraview", "panorama"),
    Other("python", 'SaveData("face.glb"', "paraview", "save"),
    Other("python", "LoadState(", "paraview", "state"),
]
FIRST_LINES = [  # of blocks without a word about their language
    ("json", r"\{"),
    ("c++", r"#include |anamorph::"),
    ("pto", r"p f\d"),
    ("recipe", r"# \w+\.(pano|mosaic|lens|warp|morph|drape|figure)$"),
    ("python", r"(import|from) \w|[\w.]+(, [\w.]+)* = |[\w.]+\("),
]


def source_dir():
    return pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"])


def documents():
    """All .md files of the tree but for what builds leave there."""
    for folder, folders, files in os.walk(source_dir()):
        folders[:] = sorted(f for f in folders if not f.startswith((".", "build")) and not os.path.islink(f"{folder}/{f}"))
        yield from (pathlib.Path(folder, file) for file in sorted(files) if file.endswith(".md"))


def language_of(text):
    return next((language for language, start in FIRST_LINES if re.match(start, text.split("\n")[0])), "shell")


def blocks_of(path):
    """Fenced blocks, and what is indented by four after an empty line, as Markdown has it."""
    name, lines = str(path.relative_to(source_dir())), path.read_text(encoding="utf-8").split("\n")
    at = 0
    while at < len(lines):
        first = at
        if lines[at].startswith("```"):
            at = lines.index("```", at + 1)
            text = "\n".join(lines[first + 1:at])
            yield Block(name, first + 2, lines[first][3:] or language_of(text), text)
        elif lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            while at + 1 < len(lines) and (lines[at + 1].startswith("    ") or not lines[at + 1].strip()):
                at += 1
            text = "\n".join(line[4:] for line in lines[first:at + 1]).rstrip("\n")
            yield Block(name, first + 1, language_of(text), text)
        at += 1


def all_blocks():
    return [block for path in documents() for block in blocks_of(path)]


def shell_lines(blocks):
    """(block, line), of lines that end in a backslash the whole."""
    for block in blocks:
        if block.language == "shell":
            for line in block.text.replace("\\\n", "").split("\n"):
                if line.strip():
                    yield block, line


def with_more(line, more):
    """The line without its comment, and `more` behind its command."""
    return re.sub(r"\s+# .*$", "", line) + more


def runs_of(run):
    """(block, line) of what the test `run` gives to a shell, but for lines that read files shown in blocks of other languages."""
    return [(block, with_more(line, rule.more)) for block, line in shell_lines(all_blocks()) for rule in LINES
            if run in rule.runs and re.match(rule.start, line)]


def lines_of(run):
    """What the test `run` gives to a shell."""
    return [line for _, line in runs_of(run)] + [other.line for other in OTHERS if other.run == run and other.line]


def block_with(language, words):
    return next(block for block in all_blocks() if block.language == language and words in block.text)


def write_files(run, folder):
    for other in OTHERS:
        if other.run == run and other.name and other.language != "python":
            pathlib.Path(folder, other.name).write_text(block_with(other.language, other.words).text + "\n", encoding="utf-8")


def python_of(run):
    """{name: source} of the Python blocks that the test `run` runs, in the order of the documents."""
    return {other.name: block_with("python", other.words).text for other in OTHERS
            if other.language == "python" and other.run == run}


def made_by(lines):
    """The files that these lines say they write (-o NAME.png, --picture NAME.png), numbered ones as patterns."""
    for line in lines:
        for name in re.findall(r" (?:-o(?::\S+)?|--picture) (\S+\.\w+)", line):
            yield re.sub(r"%0\dd", "*", name)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    if len(sys.argv) == 3:
        write_files(sys.argv[1], sys.argv[2])
    print("\n".join(lines_of(sys.argv[1])))
