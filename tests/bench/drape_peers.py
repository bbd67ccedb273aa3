#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Pictures on surfaces beside what else draws them: vtkAnamorphDrape against VTK's own rendering in software (Mesa) of the
surface as triangles, and against POV-Ray.

Triangles are as many as the tolerance takes: of grids of several shapes the one with the fewest cells, of which no sampled
point of a triangle is seen further than the tolerance from where the surface has it. The mesh, and how fine it has to be, are
made before the clock starts; so are vtkAnamorphDrape's patches of the surface, which views share. Each frame has another camera.
All read the texture bilinearly, from 3 channels of 8 bits, without light. Errors are measured on what was drawn, where each
pixel's point of the texture belongs on the screen, by formulas of this file: VTK draws the points as colors of 16 bits (2^-16 of
the texture). POV-Ray is timed by what it says of tracing alone, in one round of three, and what it shows of a texture of
numbers is compared with what vtkAnamorphDrape shows at a tolerance of 0.005 pixels.

Times are of the processor, on one thread, the median over the rounds. Where a program is missing, it says so and goes on. Fails
if vtkAnamorphDrape breaks the tolerance or more than a thousandth of POV-Ray's pixels differ by more than a texel.

Needs plain VTK (not ParaView's, which is built for debugging), the module anamorph, and a screen, such as xvfb-run's."""
import argparse
import csv
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

# Before any of the libraries is there: one thread each.
os.environ.setdefault("LP_NUM_THREADS", "0")
os.environ.setdefault("VTK_SMP_BACKEND_IN_USE", "Sequential")

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkTable
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401: it is what draws

from anamorph import vtkAnamorphDrape

VIEW_ANGLE, UP, RADIUS, TUBE, MOST_WRONG = 36.0, (0.0, 1.0, 0.0), 0.35, 0.15, 0.001
# Pixels are compared with POV-Ray's at this tolerance: where a texel is small on the screen, 0.125 pixels are many.
COMPARED_AT = 0.005


# ---- The surfaces, written out once more: (u, v) with v up ----

def page_turn(u, v):
    """A sheet of 1 x 1 that rolls towards the right of 30 degrees round a cylinder of 0.1, half way."""
    angle, radius = math.radians(30), 0.1
    across = np.array([math.cos(angle), math.sin(angle)])
    x, y = u - 0.5, v - 0.5
    past = x * across[0] + y * across[1]  # the middle of the sheet is where the roll is
    arc = np.clip(past, 0, math.pi * radius) / radius
    flat = np.maximum(past - math.pi * radius, 0)
    along = np.where(past < 0, past, radius * np.sin(arc) - flat)
    return np.stack([x + (along - past) * across[0], y + (along - past) * across[1], radius * (1 - np.cos(arc))], -1)


def sphere(u, v, radius=0.5):
    a, b = (u - 0.5) * 2 * np.pi, (v - 0.5) * np.pi
    return np.stack([radius * np.cos(b) * np.sin(a), radius * np.sin(b), radius * np.cos(b) * np.cos(a)], -1)


def torus(u, v):
    a, b = (u - 0.5) * 2 * np.pi, (v - 0.5) * 2 * np.pi
    r = 0.5 + TUBE * np.cos(b)
    return np.stack([r * np.sin(a), TUBE * np.sin(b), r * np.cos(a)], -1)


def cylinder(u, v):
    a = (u - 0.5) * 2 * np.pi
    return np.stack([RADIUS * np.sin(a), v - 0.5, RADIUS * np.cos(a)], -1)


BUMPS = np.random.default_rng(7).uniform(size=(50, 4)) * [1, 1, 0.1, 0.1] + [0, 0, 0.03, -0.03]


def gaussians(u, v):
    """50 Gaussians on a plane: centre, extent and height."""
    z = sum(h * np.exp(-((u - cu) ** 2 + (v - cv) ** 2) / e ** 2) for cu, cv, e, h in BUMPS)
    return np.stack([u - 0.5, v - 0.5, z], -1)


def set_gaussians(drape):
    table = vtkTable()
    columns = {"center_u": BUMPS[:, 0], "center_v": BUMPS[:, 1], "extent_u": BUMPS[:, 2], "extent_v": BUMPS[:, 2],
               "x": 0 * BUMPS[:, 0], "y": 0 * BUMPS[:, 0], "z": BUMPS[:, 3]}
    for name, values in columns.items():
        column = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        column.SetName(name)
        table.AddColumn(column)
    drape.SetInputData(3, table)


def set_page(drape):
    drape.SetSurface(drape.PAGE_TURN)
    drape.SetDirection(30)


def set_round(surface):
    def setter(drape):
        drape.SetSurface(getattr(drape, surface))
        drape.SetAngle(360)
        drape.SetTube(TUBE)
        if surface == "CYLINDER":
            drape.SetRadius(RADIUS)
    return setter


SURFACES = {"page turn": (page_turn, set_page), "sphere": (sphere, set_round("SPHERE")),
            "50 Gaussians": (gaussians, set_gaussians)}
TRACED = {"sphere": (sphere, set_round("SPHERE")), "torus": (torus, set_round("TORUS")),
          "cylinder": (cylinder, set_round("CYLINDER"))}


# ---- The camera ----

def camera_at(turn):
    """A little to the side, by degrees."""
    a = math.radians(10 + turn)
    return (1.65 * math.sin(a), 0.5, 1.65 * math.cos(a))


def seen(points, position, size):
    """Where points of space are on a screen of size x size whose rows go up, in pixels."""
    eye = np.array(position)
    ahead = -eye / np.linalg.norm(eye)
    right = np.cross(ahead, UP)
    right /= np.linalg.norm(right)
    relative = points - eye
    scale = size / 2 / math.tan(math.radians(VIEW_ANGLE / 2)) / (relative @ ahead)
    return np.stack([relative @ right * scale, relative @ np.cross(right, ahead) * scale], -1) + size / 2


def errors_of(formula, uv, covered, position):
    """How far from each pixel's middle its point of the texture belongs, in pixels."""
    size = covered.shape[0]
    rows, columns = np.nonzero(covered)
    at = seen(formula(uv[rows, columns, 0], uv[rows, columns, 1]), position, size)
    return np.hypot(at[:, 0] - columns - 0.5, at[:, 1] - rows - 0.5)


# ---- VTK: triangles ----

def grid(formula, across, down):
    u, v = np.meshgrid(np.linspace(0, 1, across + 1), np.linspace(0, 1, down + 1))
    return u, v, formula(u, v)


def mesh_error(formula, across, down, position, size):
    """The largest distance on the screen at the middles of the sides and of the faces of a grid's triangles."""
    u, v, p = grid(formula, across, down)
    worst = 0
    corners = {"a": np.s_[:-1, :-1], "b": np.s_[:-1, 1:], "c": np.s_[1:, :-1], "d": np.s_[1:, 1:]}
    for names in ("ab", "ac", "ad", "bd", "cd", "abd", "acd"):
        mean = [sum(what[corners[n]] for n in names) / len(names) for what in (u, v, p)]
        off = seen(mean[2], position, size) - seen(formula(mean[0], mean[1]), position, size)
        worst = max(worst, float(np.hypot(off[..., 0], off[..., 1]).max()))
    return worst


def fewest_cells(formula, position, size, tol):
    """Columns and rows of a grid within the tolerance, with the fewest cells of several shapes."""
    best = None
    for shape in (0.25, 0.5, 1, 2, 4):
        def sides(n):
            return max(1, round(n * math.sqrt(shape))), max(1, round(n / math.sqrt(shape)))

        low, high = 2, 8
        while mesh_error(formula, *sides(high), position, size) > tol:
            low, high = high, 2 * high
        while high - low > max(1, high // 50):
            middle = (low + high) // 2
            if mesh_error(formula, *sides(middle), position, size) > tol:
                low = middle
            else:
                high = middle
        if best is None or math.prod(sides(high)) < math.prod(best):
            best = sides(high)
    return best


def mesh_of(formula, across, down):
    u, v, p = grid(formula, across, down)
    mesh, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(p.reshape(-1, 3).astype(np.float32), deep=True))
    mesh.SetPoints(points)
    a = (np.arange(down)[:, None] * (across + 1) + np.arange(across)[None, :]).ravel()
    b, c, d = a + 1, a + across + 1, a + across + 2
    triangles = np.concatenate([np.stack([a, b, d], -1), np.stack([a, d, c], -1)]).ravel()
    offsets = np.arange(0, triangles.size + 1, 3)
    cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(triangles, deep=True))
    mesh.SetPolys(cells)
    coordinates = numpy_to_vtk(np.stack([u, v], -1).reshape(-1, 2).astype(np.float32), deep=True)
    mesh.GetPointData().SetTCoords(coordinates)
    return mesh


class Rendering:
    """A mesh with a texture in a window that is not shown."""

    def __init__(self, mesh, texture, size):
        mapper, actor, image, renderer = vtkPolyDataMapper(), vtkActor(), vtkTexture(), vtkRenderer()
        mapper.SetInputData(mesh)
        image.SetInputData(texture)
        image.InterpolateOn()
        image.MipmapOff()
        actor.SetMapper(mapper)
        actor.SetTexture(image)
        actor.GetProperty().LightingOff()
        renderer.AddActor(actor)
        self.actor, self.renderer, self.window = actor, renderer, vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(size, size)
        self.window.AddRenderer(renderer)

    def draw(self, position):
        """The pixels, with rows that go up."""
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(position)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(UP)
        camera.SetViewAngle(VIEW_ANGLE)
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        picture = grab.GetOutput()
        across, down, _ = picture.GetDimensions()
        return vtk_to_numpy(picture.GetPointData().GetScalars()).reshape(down, across, 3)

    def points(self, position):
        """The point of the texture that each pixel shows, and where there is one."""
        uv, covered = [], None
        for axis in "xy":
            shader = self.actor.GetShaderProperty()
            shader.ClearAllFragmentShaderReplacements()
            shader.AddFragmentShaderReplacement(
                "//VTK::TCoord::Impl", True,
                "//VTK::TCoord::Impl\n"
                f"  float place = clamp(tcoordVCVSOutput.{axis}, 0.0, 1.0) * 255.0;\n"
                "  gl_FragData[0] = vec4(floor(place) / 255.0, fract(place), 1.0, 1.0);\n", False)
            pixels = self.draw(position).astype(float)
            uv.append((pixels[..., 0] + pixels[..., 1] / 255) / 255)
            covered = pixels[..., 2] > 128
        self.actor.GetShaderProperty().ClearAllFragmentShaderReplacements()
        return np.stack(uv, -1), covered


# ---- vtkAnamorphDrape ----

def drape_of(setter, texture, size, tol):
    drape = vtkAnamorphDrape()
    drape.SetInputData(texture)
    drape.SetViewSize(size, size)
    drape.SetCameraViewAngle(VIEW_ANGLE)
    drape.SetFilter(drape.BILINEAR)
    drape.SetTolerance(tol)
    setter(drape)
    return drape


def draped(drape, position):
    drape.SetCameraPosition(position)
    drape.Update()
    return vtk_to_numpy(drape.GetOutput().GetPointData().GetScalars())


def draped_points(drape, position, size):
    drape.SetStyle(drape.TEXTURE_COORDINATES)
    uv = draped(drape, position).reshape(size, size, 2).astype(float)
    drape.SetStyle(drape.COLOR)
    return uv, uv[..., 0] >= 0


# ---- POV-Ray ----

SHAPES = {
    "sphere": ("sphere { 0, 0.5", 1, "rotate y * -90"),
    "torus": (f"torus {{ 0.5, {TUBE}", 5, "scale 0.5 rotate y * -90"),
    "cylinder": (f"cylinder {{ <0, -0.5, 0>, <0, 0.5, 0>, {RADIUS} open", 2, "translate y * -0.5 rotate y * -90"),
}


def traced(name, position, size, texture, smooth):
    """POV-Ray's seconds of tracing, and its picture as 16 bit RGB with rows that go up. Its z is towards the back."""
    shape, mapping, move = SHAPES[name]
    with tempfile.TemporaryDirectory() as folder:
        def at(name):
            return os.path.join(folder, name)

        write_ppm(at("texture.ppm"), texture)
        x, y, z = position
        with open(at("scene.pov"), "w", encoding="ascii") as file:
            file.write(f"""#version 3.7;
global_settings {{ assumed_gamma 1.0 }}
camera {{ location <{x}, {y}, {-z}> right x up y angle {VIEW_ANGLE} look_at 0 }}
{shape} texture {{ pigment {{ image_map {{ ppm "{at("texture.ppm")}" gamma 1.0 map_type {mapping} {"interpolate 2" if smooth else ""} }} }}
finish {{ ambient 0 diffuse 0 emission 1 }} {move} }} }}
""")
        run = subprocess.run(["povray", "+I" + at("scene.pov"), "+O" + at("out.ppm"), "+FP16", "File_Gamma=1.0", "-A", "-D",
                              "+WT1", f"+W{size}", f"+H{size}"], capture_output=True, text=True, check=False)
        said = re.search(r"Trace Time:.*? with ([0-9.]+) CPU-seconds", run.stderr, re.S)
        if run.returncode or not said:
            raise SystemExit("drape_peers.py: povray failed:\n" + run.stderr)
        with open(at("out.ppm"), "rb") as file:
            picture = file.read()
    picture = np.frombuffer(picture[-6 * size * size:], ">u2").reshape(size, size, 3)
    return float(said[1]), picture[::-1]


def write_ppm(name, texture):
    """Of rows that go up: 16 bit where they have that."""
    with open(name, "wb") as file:
        most = 65535 if texture.dtype == np.uint16 else 255
        file.write(b"P6\n%d %d\n%d\n" % (texture.shape[1], texture.shape[0], most))
        file.write(texture[::-1].astype(">u2" if most > 255 else np.uint8).tobytes())


def numbered(side):
    """A texture that says where its texels are."""
    place = (np.arange(side) * (65536 // side) + 32768 // side).astype(np.uint16)  # the middle of its share
    texture = np.full((side, side, 3), 65535, np.uint16)
    texture[..., 0], texture[..., 1] = place[None, :], place[:, None]
    return texture


def wrong_share(name, picture, uv, covered, side):
    """The share of pixels that show another texel than POV-Ray's, by more than one, or that only one of both shows."""
    known = picture[..., 2] > 32768
    texel = picture[..., :2].astype(float) / (65536 // side) - 0.5
    off = np.abs(uv * side - 0.5 - texel)
    off = np.minimum(off, side - off) if name != "sphere" else np.stack([np.minimum(off[..., 0], side - off[..., 0]), off[..., 1]], -1)
    # A texel is read as a whole: its middle is up to half of it off.
    wrong = (known != covered) | (known & covered & (off.max(-1) > 1.5))
    return float(wrong.mean())


# ---- The table ----

def cpu_seconds(draw):
    begin = time.process_time()
    draw()
    return time.process_time() - begin


def image_of(texture):
    image = vtkImageData()
    image.SetDimensions(texture.shape[1], texture.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(texture.reshape(-1, texture.shape[2]), deep=True))
    return image


class Table:
    FIELDS = ["surface", "by", "triangles", "ms", "mean_error_px", "max_error_px", "wrong"]

    def __init__(self):
        self.rows = []

    def add(self, surface, by, seconds, errors=None, triangles="", wrong=""):
        row = {"surface": surface, "by": by, "triangles": triangles, "ms": f"{1000 * seconds:.1f}", "wrong": wrong,
               "mean_error_px": "" if errors is None else f"{errors.mean():.4f}",
               "max_error_px": "" if errors is None else f"{errors.max():.4f}"}
        self.rows.append(row)
        print("| " + " | ".join(str(row[field]) for field in self.FIELDS) + " |", flush=True)

    def begin(self):
        print("| " + " | ".join(self.FIELDS) + " |\n|" + "---|" * len(self.FIELDS))

    def write(self, name):
        with open(name, "w", newline="", encoding="ascii") as file:
            writer = csv.DictWriter(file, self.FIELDS)
            writer.writeheader()
            writer.writerows(self.rows)


def compare_with_vtk(table, args, pixels):
    failures, first = [], camera_at(0)
    texture = image_of(pixels)
    for name, (formula, setter) in SURFACES.items():
        across, down = fewest_cells(formula, first, args.size, args.tol)
        rendering = Rendering(mesh_of(formula, across, down), texture, args.size)
        drape = drape_of(setter, texture, args.size, args.tol)
        draws = {"VTK": lambda p, r=rendering: r.draw(p), "vtkAnamorphDrape": lambda p, d=drape: draped(d, p)}
        times = {by: [] for by in draws}
        for turn in range(args.rounds + 1):
            for by, draw in draws.items():
                times[by].append(cpu_seconds(lambda: draw(camera_at(turn / 4))))
        errors = errors_of(formula, *rendering.points(first), first)
        table.add(name, "VTK", statistics.median(times["VTK"][1:]), errors, 2 * across * down)
        errors = errors_of(formula, *draped_points(drape, first, args.size), first)
        table.add(name, "vtkAnamorphDrape", statistics.median(times["vtkAnamorphDrape"][1:]), errors)
        if not errors.size or errors.max() > args.tol:
            failures.append(f"{name}: a point is off by {errors.max() if errors.size else 'nothing'} pixels")
    return failures


def compare_with_povray(table, args, pixels):
    if not shutil.which("povray"):
        print("(POV-Ray is not installed: tests/install_packages.sh peers)")
        return []
    failures, first, side = [], camera_at(0), args.size
    for name, (formula, setter) in TRACED.items():
        drape = drape_of(setter, image_of(pixels), args.size, args.tol)
        times = {"POV-Ray": [], "vtkAnamorphDrape": []}
        for turn in range(args.rounds + 1):
            position = camera_at(turn / 4)
            if turn % 3 == 1:
                times["POV-Ray"].append(traced(name, position, args.size, pixels, True)[0])
            times["vtkAnamorphDrape"].append(cpu_seconds(lambda p=position: draped(drape, p)))
        errors = errors_of(formula, *draped_points(drape, first, args.size), first)
        drape.SetTolerance(COMPARED_AT)
        uv, covered = draped_points(drape, first, args.size)
        wrong = wrong_share(name, traced(name, first, args.size, numbered(side), False)[1], uv, covered, side)
        table.add(name, "POV-Ray", statistics.median(times["POV-Ray"]), wrong=f"{100 * wrong:.3f} %")
        table.add(name, "vtkAnamorphDrape", statistics.median(times["vtkAnamorphDrape"][1:]), errors)
        if wrong > MOST_WRONG:
            failures.append(f"{name}: {100 * wrong:.3f} % of the pixels are not POV-Ray's")
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=1024, help="width and height of screen and texture, pixels")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--tol", type=float, default=0.125, help="pixels of the screen")
    parser.add_argument("--csv", help="writes the table there")
    args = parser.parse_args()
    pixels = np.random.default_rng(1).integers(0, 256, (args.size, args.size, 3), dtype=np.uint8)
    table = Table()
    table.begin()
    failures = compare_with_vtk(table, args, pixels) + compare_with_povray(table, args, pixels)
    if args.csv:
        table.write(args.csv)
    sys.exit("\n".join(failures) if failures else 0)


if __name__ == "__main__":
    main()
