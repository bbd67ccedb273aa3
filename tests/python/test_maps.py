# SPDX-License-Identifier: Apache-2.0
"""Maps, figures and surfaces of the Python module: beside numpy's own formulas and the programs, there and back, and what cannot be taken."""
import gc
import os
import pathlib
import tempfile
import threading
import unittest

import numpy as np

import anamorph
from anamorph import figures, surfaces

WALKER = os.path.join(os.environ["ANAMORPH_SOURCE_DIR"], "examples/figures/walker.nudes")
SHEET = {"columns": 2, "rows": 2, "vertices": [[0, 0], [31, 3], [64, 0], [2, 20], [36, 27], [60, 22], [0, 48], [30, 46], [64, 48]]}
DOLL = """figure doll 2 body head
ellipsoid body 100 200 60
ellipsoid head 60 70 60
joint neck body 0 180 0 head 0 -60 0
view 1 10
linear 0 10 bendby head neck body 40 x
linear 0 1 moveto doll body 500 300 500
stop
"""


def brown(x, y, width, height, fov, k1):
    """Where a picture that is straight reads a lens of k1: by the formula of the radius, in double."""
    focal = width / 2 / np.tan(np.radians(fov) / 2)
    a, b = (x - width / 2) / focal, (y - height / 2) / focal
    scale = 1 + k1 * (a * a + b * b)
    return a * scale * focal + width / 2, b * scale * focal + height / 2


class Maps(unittest.TestCase):
    def test_is_the_formula(self):
        lens = anamorph.Map("lens", (96, 64), lens="brown:k1=-0.1", fov=70)
        self.assertEqual((lens.size, lens.source_size), ((96, 64), (96, 64)))
        x, y = lens.centers()
        np.testing.assert_allclose(lens.points(x, y), brown(x, y, 96, 64, 70, -0.1), atol=1e-9)
        step = 1e-5
        for axis, (dx, dy) in enumerate(((step, 0), (0, step))):
            slope = (np.stack(lens.points(x + dx, y + dy), -1) - np.stack(lens.points(x - dx, y - dy), -1)) / (2 * step)
            np.testing.assert_allclose(lens.jacobians(x, y)[..., axis], slope, atol=1e-6)

    def inverse_is_the_inverse(self, made, least=0.999):
        """Of points of the picture: the inverse of where they lead leads back to a point that leads there."""
        random = np.random.default_rng(5)
        x, y = random.uniform(0.02, 0.98, (2, 1000)) * np.array(made.size)[:, None]
        u, v = made.points(x, y)
        known = np.isfinite(u)
        back = made.inverse()
        self.assertEqual((back.size, back.source_size), (made.source_size, made.size))
        found = np.stack(back.points(u, v))
        self.assertTrue(np.isnan(found[:, ~known]).all())
        met = np.isfinite(found).all(0)
        self.assertGreaterEqual(met[known].mean(), least, made)
        again = np.stack(made.points(*found[:, met]))
        np.testing.assert_allclose(again, np.stack([u, v])[:, met], atol=1e-7)
        product = back.jacobians(u[met], v[met]) @ made.jacobians(*found[:, met])
        np.testing.assert_allclose(product, np.broadcast_to(np.eye(2), product.shape), atol=1e-6)
        return np.stack([x, y])[:, met], found[:, met]

    def test_inverses_of_operations(self):
        for made in (anamorph.Map("lens", (96, 64), lens="brown:k1=-0.1", fov=70), anamorph.Map("warp", (64, 48), mesh=SHEET),
                     anamorph.Map("pano", (256, 128), from_="equirectangular", to="rectilinear", fov=80, yaw=60, pitch=20, size=(120, 90)),
                     anamorph.Map("map", (64, 48), u="width/2+(x-width/2)*1.1+2*sin(y/9)", v="y+3*cos(x/11)")):
            wanted, found = self.inverse_is_the_inverse(made)
            np.testing.assert_allclose(found, wanted, atol=1e-6)  # one to one
        # All of a panorama is found, though it is cut open, and no point has a place where the picture shows none.
        whole = anamorph.Map("pano", (256, 128), from_="equirectangular", to="equirectangular", yaw=100, pitch=30, size=(256, 128))
        self.inverse_is_the_inverse(whole, 0.99)
        x, y = anamorph.Map("lens", (96, 64), lens="brown:k1=0.2", fov=70).inverse().points([-500.0, np.nan, np.inf], [10.0, 3.0, 2.0])
        self.assertTrue(np.isnan(x).all() and np.isnan(y).all())

    def test_a_picture_there_and_back(self):
        """Drawn through a map and through its inverse a smooth picture is itself, but for two interpolations."""
        x, y = np.meshgrid(np.arange(80) + 0.5, np.arange(60) + 0.5)
        source = np.float32(np.stack([x, y], -1))
        lens = anamorph.Map("lens", (80, 60), lens="brown:k1=-0.08", fov=70)
        back = lens.inverse().draw(lens.draw(source, filter="bilinear"), filter="bilinear")
        np.testing.assert_allclose(back[15:-15, 15:-15], source[15:-15, 15:-15], atol=0.01)

    def test_stmaps(self):
        made = anamorph.Map("lens", (96, 64), lens="brown:k1=-0.1", fov=70)
        expected = anamorph.lens(np.zeros((64, 96), np.uint8), lens="brown:k1=-0.1", fov=70, output="stmap", tol=0)
        np.testing.assert_allclose(made.to_stmap(), expected, atol=1e-6)
        again = anamorph.Map.from_stmap(made.to_stmap(), (96, 64))
        x, y = made.centers()
        np.testing.assert_allclose(np.stack(again.points(x, y))[:, 1:-1, 1:-1], np.stack(made.points(x, y))[:, 1:-1, 1:-1], atol=1e-4)

    def test_overscan(self):
        """What lies around the display window is a part of all that is drawn, there and back."""
        x, y = np.meshgrid(np.arange(80) + 0.5, np.arange(60) + 0.5)
        source = np.float32(np.stack([x, y], -1))
        lens = anamorph.Map("lens", (80, 60), lens="brown:k1=-0.15", fov=70, size="all", filter="bilinear")
        whole = anamorph.Picture("lens", source, lens="brown:k1=-0.15", fov=70, size="all")
        x0, y0, x1, y1 = whole.window
        self.assertLess(x0, 0)
        self.assertEqual((lens.size, lens.window), ((80, 60), (x0, y0, x1, y1)))
        shape = (y1 - y0, x1 - x0)
        drawn = lens.draw(source)
        for array in (drawn, lens.bounds(), lens.coverage(), lens.to_stmap(), lens.centers()[0]):
            self.assertEqual(array.shape[:2], shape)
        self.assertEqual((lens.centers()[0][0, 0], lens.centers()[1][0, 0]), (x0 + 0.5, y0 + 0.5))
        expected = anamorph.lens(source, lens="brown:k1=-0.15", fov=70, size="all", output="stmap", tol=0)
        covered = lens.coverage() > 0.999
        np.testing.assert_allclose(lens.to_stmap()[covered], expected[covered], atol=1e-6)
        # The other way all of the source is seen, of the picture's pixels by themselves and by their windows.
        back = lens.inverse()
        self.assertEqual((back.size, back.source_size, back.source_window), ((80, 60), (80, 60), lens.window))
        again = back.draw(drawn, filter="bilinear")
        self.assertEqual(again.shape, source.shape)
        np.testing.assert_allclose(again[2:-2, 2:-2], source[2:-2, 2:-2], atol=0.01)
        image = anamorph.Image(drawn, corner=(x0, y0), display=(0, 0, 80, 60))
        np.testing.assert_array_equal(back.draw(image, filter="bilinear"), again)
        for wrong in (drawn[1:], anamorph.Image(drawn, corner=(x0, y0), display=(0, 0, 81, 60))):
            with self.assertRaisesRegex(ValueError, r"must be \(80, 60\)"):
                back.draw(wrong)

    def test_compositions(self):
        outer = anamorph.Map("warp", (96, 64), mesh={**SHEET, "vertices": (np.array(SHEET["vertices"]) * [1.5, 4 / 3]).tolist()})
        inner = anamorph.Map("lens", (96, 64), lens="brown:k1=-0.05", fov=60)
        both = outer.compose(inner)
        self.assertEqual(both.explain()["anamorph:chain"], "warp of lens")
        apart = anamorph.Map.from_functions(lambda x, y: inner.points(*outer.points(x, y)), None, outer.size, inner.source_size)
        x, y = (grid[8:-8, 8:-8] for grid in outer.centers())
        np.testing.assert_allclose(both.points(x, y), apart.points(x, y), atol=1e-8)
        # Not joined: one after the other.
        functions = anamorph.Map.from_functions(inner.points, inner.jacobians, inner.size, inner.source_size)
        np.testing.assert_array_equal(outer.compose(functions).points(x, y), inner.points(*outer.points(x, y)))
        np.testing.assert_allclose(outer.compose(functions).jacobians(x, y), both.jacobians(x, y), atol=1e-7)
        # With an inverse in it: by functions, and all of it undone.
        none = inner.inverse().compose(inner)
        np.testing.assert_allclose(none.points(x, y), (x, y), atol=1e-7)
        np.testing.assert_allclose(none.jacobians(x, y), np.broadcast_to(np.eye(2), x.shape + (2, 2)), atol=1e-6)
        self.inverse_is_the_inverse(both)

    def test_bounds_and_coverage(self):
        made = anamorph.Map("lens", (96, 64), lens="brown:k1=-0.1", fov=70, tol=0.01)
        self.assertEqual(made.bounds().shape, (64, 96))
        self.assertAlmostEqual(float(made.bounds().max()), made.explain()["anamorph:max_error"], delta=1e-6)
        self.assertLessEqual(float(made.bounds().max()), 0.01)
        self.assertTrue((made.coverage() > 0.99).mean() > 0.9)

    def test_what_cannot_be_taken(self):
        made = anamorph.Map("lens", (96, 64), lens="brown:k1=-0.1", fov=70)
        for call in (lambda: anamorph.Map("lens", (0, 64)), lambda: anamorph.Map("lens", (1.5, 64)), lambda: anamorph.Map("twist", (9, 9)),
                     lambda: made.compose(anamorph.Map("lens", (95, 64), fov=50)), lambda: made.inverse().bounds(), lambda: made.inverse().explain(),
                     lambda: made.draw(np.zeros((9, 9))), lambda: anamorph.Map.from_stmap(np.zeros((4, 4, 7)), (9, 9)),
                     lambda: anamorph.Map("lens", (9, 9), k1=3), lambda: anamorph.Map("lens", 640), lambda: made.draw(np.zeros(9))):
            with self.assertRaises((ValueError, TypeError)):
                call()


class Figures(unittest.TestCase):
    def test_a_script_is_performed(self):
        motion = figures.perform(DOLL)
        self.assertEqual((list(motion.numbers), len(motion), motion.rate), (list(range(2, 11)), 9, 25))
        frame = motion[0]
        self.assertEqual((frame.names, frame.figures, frame.figure_of), (["body", "head"], ["doll"], [0, 0]))
        np.testing.assert_array_equal(frame.axes, [[100, 200, 60], [60, 70, 60]])
        last = motion[10]
        # The joint holds: seen from either body it is one point.
        for body, at in ((0, (0, 180, 0)), (1, (0, -60, 0))):
            np.testing.assert_allclose(last.centers[body] + last.rotations[body] @ at, last.joints[0][3], atol=1e-9)
        np.testing.assert_allclose(last.centers[0], [500, 300, 500], atol=1e-9)
        turned = last.rotations[1] @ last.rotations[0].T
        self.assertAlmostEqual(np.degrees(np.arccos((np.trace(turned) - 1) / 2)), 40, places=6)
        self.assertEqual([frame.number for frame in motion], list(range(2, 11)))

    def test_frames_have_the_same_bits_in_any_order(self):
        motion = figures.perform(WALKER)
        forwards = [motion[n].centers for n in range(1, 7)]
        backwards = [figures.perform(WALKER)[n].centers for n in range(6, 0, -1)][::-1]
        np.testing.assert_array_equal(forwards, backwards)
        found = {}
        threads = [threading.Thread(target=lambda n=n: found.update({n: motion[n].centers})) for n in range(1, 7)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        np.testing.assert_array_equal(forwards, [found[n] for n in range(1, 7)])

    def test_outlines_are_on_the_ellipses(self):
        # One sphere before the observer: a circle of known middle and radius.
        frame = figures.perform("figure ball 1 b\nellipsoid b 100 100 100\nrepeat 0 1 moveto ball b 500 500 500\nstop\n")[1]
        lines = frame.outlines((500, 500), tol=0.01)
        points = np.concatenate([line.points for line in lines])
        np.testing.assert_allclose(np.hypot(points[:, 0] - 250, points[:, 1] - 250), 50, atol=0.02)
        self.assertEqual({(line.body, line.kind) for line in lines}, {(0, "visible")})
        doll = figures.perform(DOLL)[10]
        seen, all_of_it = doll.outlines((400, 400)), doll.outlines((400, 400), hidden="keep")
        self.assertEqual({line.kind for line in seen}, {"visible"})
        self.assertEqual({line.kind for line in all_of_it}, {"visible", "hidden"})

    def test_what_cannot_be_taken(self):
        motion = figures.perform(DOLL)
        for call in (lambda: figures.perform("nonsense\n"), lambda: figures.perform("no/file.nudes"), lambda: figures.read("-"),
                     lambda: motion[-1], lambda: motion[10**9], lambda: motion[0].outlines((0, 5)), lambda: motion[0].outlines((5, 5), tol=-1),
                     lambda: motion[0].outlines((5, 5), hidden="maybe"), lambda: motion[1.5], lambda: figures.perform("a\0\n"),
                     lambda: motion[0].outlines((float("nan"), 5))):
            with self.assertRaises((ValueError, TypeError)):
                call()


class Surfaces(unittest.TestCase):
    def setUp(self):
        self.uv = np.stack(np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 31)), -1).reshape(-1, 2)
        self.plane = np.column_stack([self.uv, np.zeros(len(self.uv))])
        self.bump = {"vector": [0.01, 0, 0.2], "center": [0.5, 0.4], "extent": [0.1, 0.2]}

    def test_bumps_are_gaussians(self):
        moved, bound = surfaces.deform(self.uv, self.plane, [self.bump])
        # Oka 1987, eq. (4.1) and (4.2), with e^-1 at the extent.
        du, dv = (self.uv - self.bump["center"]).T / np.array(self.bump["extent"])[:, None]
        expected = self.plane + np.exp(-(du * du + dv * dv))[:, None] * self.bump["vector"]
        self.assertLess(bound, 1e-3)
        self.assertLessEqual(np.abs(moved - expected).max(), bound + 1e-15)
        again, _ = surfaces.deform(self.uv, self.plane, {"deformations": [self.bump]})
        np.testing.assert_array_equal(moved, again)

    def test_inbetweens(self):
        moved, _ = surfaces.deform(self.uv, self.plane, [self.bump])
        np.testing.assert_allclose(surfaces.inbetween([self.plane, moved], [0.25, 0.75]), 0.25 * self.plane + 0.75 * moved, atol=1e-15)
        np.testing.assert_allclose(surfaces.inbetween([self.plane, moved], [1, 3], normalize=True), 0.25 * self.plane + 0.75 * moved, atol=1e-15)

    def test_what_cannot_be_taken(self):
        for call in (lambda: surfaces.deform(self.uv[:3], self.plane, []), lambda: surfaces.deform(self.plane, self.plane, []),
                     lambda: surfaces.deform(self.uv, self.plane, [{"vector": [0, 0, float("nan")], "center": [0, 0], "extent": [1, 1]}]),
                     lambda: surfaces.deform(self.uv, self.plane, [{"center": [0, 0], "extent": [1, 1], "twist": 3}]),
                     lambda: surfaces.deform(self.uv * np.nan, self.plane, [self.bump]), lambda: surfaces.inbetween([], []),
                     lambda: surfaces.inbetween([self.plane], [0.5]), lambda: surfaces.inbetween([self.plane, self.uv], [0.5, 0.5]),
                     lambda: surfaces.inbetween([self.plane], [1, 0]), lambda: surfaces.deform(self.uv, self.plane, "x")):
            with self.assertRaises((ValueError, TypeError)):
                call()
        empty, _ = surfaces.deform(np.zeros((0, 2)), np.zeros((0, 3)), [self.bump])
        self.assertEqual(empty.shape, (0, 3))


def handles_and_memory():
    with open("/proc/self/status", encoding="ascii") as status:
        memory = next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
    return len(os.listdir("/proc/self/fd")), memory


@unittest.skipUnless(os.environ.get("ANAMORPH_NIGHTLY"), "10^4 calls are for the night")
class TenThousandCalls(unittest.TestCase):
    """Memory (KiB) and handles stay flat."""

    def stays_flat(self, call):
        for _ in range(1000):
            call()
        gc.collect()
        handles, memory = handles_and_memory()
        for _ in range(10000):
            call()
        gc.collect()
        after = handles_and_memory()
        self.assertEqual(after[0], handles)
        self.assertLess(after[1] - memory, 4000)

    def test_pictures(self):
        source = np.zeros((32, 64, 3), np.float32)
        self.stays_flat(lambda: anamorph.pano(source, to="rectilinear", fov=90, size=(16, 12)))

    def test_warps_of_meshes(self):
        source = np.zeros((48, 64), np.uint8)
        self.stays_flat(lambda: anamorph.warp(source, mesh=SHEET))

    def test_errors(self):
        source = np.zeros((32, 64), np.uint8)

        def call():
            try:
                anamorph.pano(source, fov=-1)
            except anamorph.Error:
                pass

        self.stays_flat(call)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "a.ppm")
            pathlib.Path(name).write_bytes(b"P6\n64 32\n255\n" + bytes(64 * 32 * 3))
            self.stays_flat(lambda: anamorph.pano(name, to="rectilinear", fov=90, size=(16, 12)))

    def test_figures_and_surfaces(self):
        uv, points = np.zeros((9, 2)), np.zeros((9, 3))
        bump = [{"vector": [0, 0, 1], "center": [0, 0], "extent": [1, 1]}]
        self.stays_flat(lambda: (figures.perform(DOLL)[3].outlines((50, 50)), surfaces.deform(uv, points, bump)))


if __name__ == "__main__":
    unittest.main()
