# SPDX-License-Identifier: Apache-2.0
"""The Python module: pictures beside numpy's own formulas and beside recipes that stock OpenImageIO opens, arrays of every kind, and
what cannot be taken."""
import ast
import concurrent.futures
import enum
import fractions
import gc
import inspect
import json
import multiprocessing
import os
import pathlib
import pydoc
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
import OpenImageIO as oiio

import anamorph

SEED = 20261129
TYPES = ("uint8", "uint16", "float16", "float32")
SHEET = {"columns": 2, "rows": 2, "vertices": [[0, 0], [31, 3], [64, 0], [2, 20], [36, 27], [60, 22], [0, 48], [30, 46], [64, 48]]}


def setUpModule():
    print("seed", SEED)
    folder = tempfile.TemporaryDirectory(prefix="anamorph-python-")
    unittest.addModuleCleanup(folder.cleanup)
    os.chdir(folder.name)


def noise(height, width, channels=3, dtype="float32", seed=0):
    random = np.random.default_rng([SEED, seed])
    shape = (height, width) if channels == 0 else (height, width, channels)
    if np.dtype(dtype).kind in "ui":
        return random.integers(0, np.iinfo(dtype).max, shape, dtype=dtype, endpoint=True)
    return random.random(shape).astype(dtype)


def write(name, pixels, **attributes):
    pixels = np.atleast_3d(pixels)
    kind = {"float16": "half", "float32": "float"}.get(pixels.dtype.name, pixels.dtype.name)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    for key, value in attributes.items():
        spec.attribute(key, value)
    output = oiio.ImageOutput.create(name)
    assert output.open(name, spec) and output.write_image(np.ascontiguousarray(pixels)) and output.close()


def recipe(name):
    """The pixels of a recipe, by stock OpenImageIO."""
    file = oiio.ImageInput.open(name)
    assert file, oiio.geterror()
    spec = file.spec()
    pixels = file.read_image(0, 0, 0, spec.nchannels, spec.format)
    assert pixels is not None, file.geterror()
    return pixels


def view_of_sphere(width, height, fov, yaw, pitch, w, h):
    """The source points of a camera's pixels on an equirectangular image of w x h, by rotations written out."""
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    focal = width / 2 / np.tan(np.radians(fov) / 2)
    ray = np.stack([(x - width / 2) / focal, (y - height / 2) / focal, np.ones_like(x)], -1)
    p, t = np.radians(pitch), np.radians(yaw)
    up = np.array([[1, 0, 0], [0, np.cos(p), -np.sin(p)], [0, np.sin(p), np.cos(p)]])
    turn = np.array([[np.cos(t), 0, np.sin(t)], [0, 1, 0], [-np.sin(t), 0, np.cos(t)]])
    world = ray @ (turn @ up).T
    longitude = np.arctan2(world[..., 0], world[..., 2])
    latitude = np.arctan2(world[..., 1], np.hypot(world[..., 0], world[..., 2]))
    return (longitude / (2 * np.pi) + 0.5) * w, (latitude / np.pi + 0.5) * h


def bilinear(pixels, u, v):
    """Texels around points mixed by their distance, x around the seam."""
    height, width = pixels.shape[:2]
    x, y = np.floor(u - 0.5).astype(int), np.floor(v - 0.5).astype(int)
    s, t = (u - 0.5 - x)[..., None], (v - 0.5 - y)[..., None]
    y0, y1 = np.clip(y, 0, height - 1), np.clip(y + 1, 0, height - 1)
    at = lambda row, column: pixels[row, column % width].astype(float)
    return (1 - t) * ((1 - s) * at(y0, x) + s * at(y0, x + 1)) + t * ((1 - s) * at(y1, x) + s * at(y1, x + 1))


class Formulas(unittest.TestCase):
    def setUp(self):
        self.panorama = noise(128, 256)
        self.keys = dict(to="rectilinear", fov=80, yaw=35, pitch=12, size=(90, 60))
        self.u, self.v = view_of_sphere(90, 60, 80, 35, 12, 256, 128)

    def test_pixels(self):
        drawn = anamorph.pano(self.panorama, filter="bilinear", tol=0, **self.keys)
        np.testing.assert_allclose(drawn, bilinear(self.panorama, self.u, self.v), atol=2e-5)

    def test_source_points_and_derivatives(self):
        picture = anamorph.Picture("pano", self.panorama, **self.keys)
        x, y = np.meshgrid(np.arange(90) + 0.5, np.arange(60) + 0.5)
        u, v = picture.source_points(x, y)
        np.testing.assert_allclose(u, self.u, atol=1e-10)
        np.testing.assert_allclose(v, self.v, atol=1e-10)
        h = 1e-5
        across, down = (np.array(picture.source_points(x + dx, y + dy)) - picture.source_points(x - dx, y - dy)
                        for dx, dy in ((h, 0), (0, h)))
        derivatives = picture.jacobians(x, y)
        self.assertEqual(derivatives.shape, (60, 90, 2, 2))
        np.testing.assert_allclose(derivatives[..., 0], np.moveaxis(across, 0, -1) / (2 * h), atol=1e-5)
        np.testing.assert_allclose(derivatives[..., 1], np.moveaxis(down, 0, -1) / (2 * h), atol=1e-5)

    def test_points_beside_the_picture_and_that_are_no_numbers(self):
        picture = anamorph.Picture("pano", self.panorama, **self.keys)
        u, v = picture.source_points([-1, 45, np.nan, 1e300, np.inf], 30)
        np.testing.assert_array_equal(np.isfinite(u), [False, True, False, False, False])
        np.testing.assert_array_equal(np.isfinite(v), np.isfinite(u))
        self.assertEqual(picture.jacobians(45, 30).shape, (2, 2))
        self.assertTrue(np.isnan(picture.jacobians(-1, 30)).all())

    def test_points_of_overscan_and_of_pieces(self):
        wide = anamorph.Picture("pano", self.panorama, overscan=8, **self.keys)
        self.assertEqual(wide.window, (-8, -8, 98, 68))
        self.assertEqual(wide.display, (0, 0, 90, 60))
        inside = anamorph.Picture("pano", self.panorama, **self.keys)
        self.assertEqual(wide.source_points(3.5, 4.5), inside.source_points(3.5, 4.5))
        self.assertTrue(np.isfinite(wide.source_points(-7.5, -7.5)[0]))
        cube = anamorph.Picture("pano", self.panorama, to="cubemap", size=(32, 192))
        stmap = anamorph.pano(self.panorama, to="cubemap", size=(32, 192), output="stmap", tol=0)
        x, y = np.meshgrid(np.arange(32) + 0.5, np.arange(192) + 0.5)
        u, v = cube.source_points(x, y)
        np.testing.assert_allclose(u % 256, stmap[..., 0] * 256 % 256, atol=1e-4)
        np.testing.assert_allclose(v, stmap[..., 1] * 128, atol=1e-4)

    def test_points_of_warps_with_overscan(self):
        square = {"columns": 1, "rows": 1, "vertices": [[0, 0], [8, 0], [0, 8], [8, 8]]}
        x, y = np.meshgrid(np.arange(-1.5, 10), np.arange(-1.5, 10))
        for overscan in (0, 2):
            picture = anamorph.Picture("warp", noise(8, 8), mesh=square, size=(8, 8), overscan=overscan)
            u, v = picture.source_points(x, y)
            inside = (np.maximum(np.abs(x - 4), np.abs(y - 4)) < 4 + overscan)
            np.testing.assert_allclose(u[inside], x[inside], atol=1e-12)
            np.testing.assert_allclose(v[inside], y[inside], atol=1e-12)
            self.assertTrue(np.isnan(u[~inside]).all())

    def test_tolerance(self):
        picture = anamorph.Picture("pano", self.panorama, tol=1e-4, **self.keys)
        self.assertAlmostEqual(picture.said["anamorph:tol"], 1e-4)
        bound = picture.reached()["anamorph:max_error"]
        self.assertLessEqual(bound, 1e-4)
        drawn = anamorph.pano(self.panorama, tol=1e-4, output="stmap", **self.keys).astype(float)
        off = np.hypot(drawn[..., 0] * 256 - self.u, drawn[..., 1] * 128 - self.v)
        self.assertLessEqual(off.max(), bound + 256 * 2**-24)  # an ST-map is float

    def test_a_map_has_to_be_one(self):
        a, b = noise(40, 40), noise(40, 40, seed=1)
        lines = {"features": [{"line": [[5, 5, 30, 8], [6, 9, 31, 5]]}]}
        with self.assertRaisesRegex(anamorph.Error, "no single source point"):
            anamorph.Picture("morph", a, b, features=lines, t=0.5).source_points(3, 4)


class Recipes(unittest.TestCase):
    """The same pixels as those of recipes."""

    def check(self, drawn, name):
        expected = recipe(name)
        self.assertEqual(drawn.dtype, expected.dtype)
        np.testing.assert_array_equal(np.atleast_3d(drawn), np.atleast_3d(expected))

    def test_types(self):
        for dtype in TYPES:
            pixels = noise(64, 128, 3, dtype)
            write(f"{dtype}.tif" if dtype != "float16" else "float16.exr", pixels)
            name = "float16.exr" if dtype == "float16" else f"{dtype}.tif"
            with self.subTest(dtype):
                self.check(anamorph.pano(pixels, fov=75, pitch=20, size=(70, 50)), f"{name}.pano?fov=75&pitch=20&size=70x50")

    def test_ids_are_moved(self):
        ids = np.array([[16777217, 4000000001], [7, 2**32 - 1]], "uint32").repeat(8, 0).repeat(8, 1)
        drawn = anamorph.warp(ids, mesh={"columns": 1, "rows": 1, "vertices": [[0, 0], [16, 1], [0, 16], [16, 15]]}, filter="nearest")
        self.assertEqual(drawn.dtype, np.uint32)
        self.assertEqual(set(np.unique(drawn)), set(np.unique(ids)))

    def test_every_operation(self):
        picture = noise(48, 64)
        write("a.tif", picture)
        write("b.tif", noise(48, 64, seed=2))
        write("pano.tif", noise(64, 128))
        pathlib.Path("sheet.json").write_text(json.dumps(SHEET))
        lines = {"features": [{"line": [[5, 5, 50, 8], [6, 9, 55, 5]]}]}
        pathlib.Path("lines.json").write_text(json.dumps(lines))
        bumps = {"deformations": [{"center": [0.4, 0.5], "vector": [0, 0, 0.3], "extent": [0.2, 0.2]}]}
        pathlib.Path("bumps.json").write_text(json.dumps(bumps))
        self.check(anamorph.lens(picture, lens="3de4:k1=-0.1"), "a.tif.lens?lens=3de4:k1=-0.1")
        self.check(anamorph.map(picture, let="w=2", u="x+w*sin(y/9)", v="y"), "a.tif.map?let=w=2&u=x+w*sin(y/9)&v=y")
        self.check(anamorph.warp(picture, mesh=SHEET, amount=0.5), "a.tif.warp?mesh=sheet.json&amount=0.5")
        self.check(anamorph.warp("a.tif", mesh=pathlib.Path("sheet.json")), "a.tif.warp?mesh=sheet.json")
        self.check(anamorph.morph(picture, noise(48, 64, seed=2), features=lines, t=0.25),
                   "a.tif.morph?b=b.tif&features=lines.json&t=0.25")
        self.check(anamorph.drape(picture, surface="cylinder", angle=200, rotate=(0, 30, 0), deform=bumps),
                   "a.tif.drape?surface=cylinder&angle=200&rotate=0,30,0&deform=bumps.json")
        script = [name for name in pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"], "examples/figures").iterdir() if name.suffix == ".nudes"][0]
        self.assertEqual(anamorph.figure(script=script, frame=0, size=(40, 30)).shape, (30, 40, 4))

    def test_pictures_that_are_no_sources(self):
        picture, other = noise(48, 64), noise(20, 30, seed=2)
        write("front.tif", picture)
        write("other.tif", other)
        around = "surface=cylinder&angle=200&rotate=0,100,0&size=50x40"
        with_back = f"front.tif.drape?{around}&back=other.tif"
        self.assertGreater(np.abs(recipe(with_back) - recipe(f"front.tif.drape?{around}")).max(), 0.1)
        for back in (other, "other.tif", anamorph.Image(other), oiio.ImageBuf("other.tif")):
            self.check(anamorph.drape(picture, surface="cylinder", angle=200, rotate=(0, 100, 0), size=(50, 40), back=back), with_back)
        with self.assertRaises(anamorph.Error) as caught:
            anamorph.drape(picture, back=other[..., :2])
        self.assertEqual(caught.exception.parameter, "back")
        script = pathlib.Path(os.environ["ANAMORPH_SOURCE_DIR"], "examples/figures/walker.nudes")
        shaded = f"f.figure?script={script}&frame=0&size=60x50&style=shaded"
        with_pictures = f"{shaded}&bump=other.tif&backdrop=front.tif"
        self.assertGreater(np.abs(recipe(with_pictures) - recipe(f"{shaded}&backdrop=front.tif")).max(), 0.01)
        self.check(anamorph.figure(script=script, frame=0, size=(60, 50), style="shaded", bump=other, backdrop=picture), with_pictures)

    def test_keywords_and_values(self):
        panorama = noise(32, 64)
        once = anamorph.pano(panorama, from_="equirectangular", fov=np.float32(70.1), size=np.array([30, 20]), alpha=True)
        write("k.tif", panorama)
        self.check(once, "k.tif.pano?from=equirectangular&fov=70.1&size=30x20&alpha=1")
        np.testing.assert_array_equal(anamorph.apply("pano", panorama, fov=None, size="30"), anamorph.pano(panorama, size=30))

    def test_numbers_of_all_kinds(self):
        panorama = noise(32, 64)
        expected = anamorph.pano(panorama, fov=70, size=(30, 20), yaw=1)
        Seventy = enum.IntEnum("Seventy", {"DEGREES": 70})
        for fov in (Seventy.DEGREES, np.int8(70), np.float64(70), np.float16(70), fractions.Fraction(140, 2), "70", np.str_("70")):
            for size in ([30, 20], (np.int64(30), 20), np.array([[30, 20]], np.uint16), (Seventy.DEGREES - 40, 20)):
                with self.subTest((fov, size)):
                    np.testing.assert_array_equal(anamorph.pano(panorama, fov=fov, size=size, yaw=True), expected)
        for keys, parameter in ((dict(fov=2**70), "fov"), (dict(size=(2**70, 1)), "size"), (dict(size=(30.5, 20)), "size"), (dict(size=()), "size"),
                                (dict(fov=(70, 70)), "fov"), ({"from": "equirectangular", "from_": "fisheye"}, "from")):
            with self.subTest(keys), self.assertRaises(anamorph.Error) as caught:
                anamorph.pano(panorama, **keys)
            self.assertEqual(caught.exception.parameter, parameter)
        with self.assertRaisesRegex(anamorph.Error, f"fov={2**70}: must be"):
            anamorph.pano(panorama, fov=2**70)

    def test_an_st_map_in_memory(self):
        picture = noise(48, 64)
        stmap = anamorph.warp(picture, mesh=SHEET, output="stmap")
        self.assertEqual((stmap.shape, stmap.dtype), ((48, 64, 2), np.float32))
        write("p.exr", picture)
        write("st.exr", stmap)
        self.check(anamorph.warp(picture, mesh=stmap), "p.exr.warp?mesh=st.exr")
        np.testing.assert_allclose(anamorph.warp(picture, mesh=stmap, filter="bilinear"),
                                   anamorph.warp(picture, mesh=SHEET, filter="bilinear"), atol=1e-2)

    def test_chains_are_sampled_once(self):
        panorama = noise(64, 128)
        write("c.tif", panorama)
        inner = anamorph.Picture("pano", panorama, fov=70, size=(64, 48))
        outer = anamorph.Picture("warp", inner, mesh=SHEET)
        self.assertEqual(outer.said["anamorph:chain"], "warp of pano")
        fine = anamorph.Picture("pano", panorama, fov=70, size=(64, 48), tol=0.001)
        self.assertEqual(anamorph.Picture("warp", fine, mesh=SHEET).said["anamorph:tol"], 0.001)
        pathlib.Path("sheet.json").write_text(json.dumps(SHEET))
        name = "c.tif.pano?fov=70&size=64x48"
        self.check(outer.draw(), f"sheet.warp?mesh=sheet.json&src=({name})")
        apart = anamorph.Picture("warp", inner, mesh=SHEET, concatenate=0)
        self.assertIn("drawn first", apart.said["anamorph:chain"])
        np.testing.assert_array_equal(apart.draw(), anamorph.warp(inner.draw(), mesh=SHEET))
        # Points go through both.
        u, v = outer.source_points(20.5, 30.5)
        np.testing.assert_allclose(inner.source_points(*anamorph.Picture("warp", inner, mesh=SHEET, concatenate=0)
                                                       .source_points(20.5, 30.5)), (u, v), rtol=1e-12)
        # A morph of pictures is drawn of what they draw.
        lines = {"features": [{"line": [[5, 5, 50, 8], [6, 9, 55, 5]]}]}
        np.testing.assert_array_equal(anamorph.morph(inner, outer, features=lines, t=0.5),
                                      anamorph.morph(inner.draw(), outer.draw(), features=lines, t=0.5))

    def test_chains_of_what_is_moved_and_what_is_mixed(self):
        ids = noise(64, 128, 0, "uint32")
        inner = anamorph.Picture("pano", ids, fov=70, size=(64, 48), filter="nearest")
        self.assertEqual(inner.dtype, np.uint32)
        mixed = anamorph.Picture("warp", inner, mesh=SHEET, filter="bilinear")
        self.assertIn("kept differently", mixed.said["anamorph:chain"])
        np.testing.assert_array_equal(mixed.draw(), anamorph.warp(inner.draw(), mesh=SHEET, filter="bilinear"))
        moved = anamorph.Picture("warp", inner, mesh=SHEET, filter="nearest")
        self.assertEqual((moved.said["anamorph:chain"], moved.dtype), ("warp of pano", np.uint32))
        self.assertLessEqual(set(np.unique(moved.draw())), {0, *np.unique(ids)})

    def test_windows_and_metadata(self):
        pixels = noise(40, 60, 4)
        file = oiio.ImageOutput.create("w.exr")
        spec = oiio.ImageSpec(60, 40, 4, "float")
        spec.x, spec.y, spec.full_x, spec.full_y, spec.full_width, spec.full_height = -10, -5, 0, 0, 40, 30
        assert file.open("w.exr", spec) and file.write_image(pixels) and file.close()
        image = anamorph.Image(pixels, corner=(-10, -5), display=(0, 0, 40, 30))
        self.check(anamorph.lens(image, lens="3de4:k1=-0.1"), "w.exr.lens?lens=3de4:k1=-0.1")
        for unassociated in (False, True):
            bright = noise(32, 64, 4, "uint8")
            write(f"u{unassociated}.tif", bright, **{"oiio:UnassociatedAlpha": int(unassociated)})
            drawn = anamorph.pano(anamorph.Image(bright, unassociated=unassociated), fov=60, size=(20, 20))
            config = oiio.ImageSpec()
            config.attribute("oiio:UnassociatedAlpha", 1)
            if not unassociated:
                self.check(drawn, "uFalse.tif.pano?fov=60&size=20x20")
        photo = anamorph.Image(noise(32, 64), metadata={"GPano:ProjectionType": "equirectangular"})
        self.assertIn("GPano", anamorph.Picture("pano", photo, fov=60).said["anamorph:from"])


class Arrays(unittest.TestCase):
    KEYS = dict(fov=70, size=(33, 21), yaw=10)

    def test_shapes(self):
        panorama = noise(32, 64, 1)
        self.assertEqual(anamorph.pano(panorama, **self.KEYS).shape, (21, 33, 1))
        flat = anamorph.pano(panorama[:, :, 0], **self.KEYS)
        self.assertEqual(flat.shape, (21, 33))
        np.testing.assert_array_equal(flat[:, :, None], anamorph.pano(panorama, **self.KEYS))
        self.assertEqual(anamorph.pano(panorama, output="bound", **self.KEYS).shape, (21, 33))
        self.assertEqual(anamorph.pano(noise(32, 64, 7), **self.KEYS).shape, (21, 33, 7))

    def test_layouts(self):
        panorama = noise(64, 128)
        expected = anamorph.pano(panorama, **self.KEYS)
        big = noise(200, 300, 5, seed=3)
        big[10:74, 20:148, 1:4] = panorama
        readonly = panorama.copy()
        readonly.flags.writeable = False
        unaligned = np.frombuffer(b"x" + panorama.tobytes(), np.uint8)[1:].view(np.float32).reshape(panorama.shape)
        for name, array in {"a part": big[10:74, 20:148, 1:4], "upside down": panorama[::-1].copy()[::-1],
                            "mirrored": panorama[:, ::-1].copy()[:, ::-1], "channels turned": panorama[..., ::-1].copy()[..., ::-1],
                            "by columns": np.asfortranarray(panorama), "planes": np.moveaxis(np.moveaxis(panorama, 2, 0).copy(), 0, 2),
                            "every other": big.repeat(2, 0)[20:148:2, 20:148, 1:4], "read-only": readonly,
                            "unaligned": unaligned, "a buffer": memoryview(panorama),
                            "one row for all": None}.items():
            with self.subTest(name):
                if array is None:
                    array = np.broadcast_to(panorama[:1], panorama.shape)
                    np.testing.assert_array_equal(anamorph.pano(array, **self.KEYS), anamorph.pano(array.copy(), **self.KEYS))
                else:
                    np.testing.assert_array_equal(anamorph.pano(array, **self.KEYS), expected)

    def test_layouts_of_two_axes(self):
        panorama = noise(64, 128, 0)
        expected = anamorph.pano(panorama, **self.KEYS)
        wide = np.zeros((70, 300), np.float32)
        wide[3:67, 5:261:2] = panorama
        unaligned = np.frombuffer(b"x" + panorama.tobytes(), np.uint8)[1:].view(np.float32).reshape(panorama.shape)
        for name, array in {"a part of every other": wide[3:67, 5:261:2], "upside down": panorama[::-1].copy()[::-1], "mirrored": panorama[:, ::-1].copy()[:, ::-1],
                            "by columns": np.asfortranarray(panorama), "unaligned": unaligned}.items():
            with self.subTest(name):
                np.testing.assert_array_equal(anamorph.pano(array, **self.KEYS), expected)
                out = np.zeros((21, 66), np.float32)[:, ::-2] if name == "mirrored" else np.zeros((21, 66), np.float32)[:, ::2]
                np.testing.assert_array_equal(anamorph.pano(array, out=out, **self.KEYS), expected)
        buffer = oiio.ImageBuf()
        anamorph.pano(panorama, out=buffer, **self.KEYS)
        np.testing.assert_array_equal(buffer.get_pixels("float")[:, :, 0], expected)

    def test_dlpack(self):
        panorama = noise(64, 128)

        class Tensor:
            def __dlpack__(self, **how):
                return panorama.__dlpack__(**how)

            def __dlpack_device__(self):
                return panorama.__dlpack_device__()

        np.testing.assert_array_equal(anamorph.pano(Tensor(), **self.KEYS), anamorph.pano(panorama, **self.KEYS))

    def test_parts_and_threads(self):
        panorama = noise(256, 512)
        for keys in (dict(fov=100, size=(300, 280), pitch=40), dict(to="fisheye", fov=170, size=300)):
            picture = anamorph.Picture("pano", panorama, **keys)
            whole = picture.draw()
            one = anamorph.Picture("pano", panorama, threads=1, **keys).draw()
            np.testing.assert_array_equal(whole, one)
            np.testing.assert_array_equal(picture.draw(roi=(31, 17, 290, 271)), whole[17:271, 31:290])
            around = picture.draw(roi=(-3, -2, 4, 5))
            np.testing.assert_array_equal(around[2:, 3:], whole[:5, :4])
            self.assertFalse(around[:2].any() or around[:, :3].any())

    def test_out(self):
        panorama = noise(64, 128)
        expected = anamorph.pano(panorama, **self.KEYS)
        out = np.empty((21, 33, 3), np.float32)
        self.assertIs(anamorph.pano(panorama, out=out, **self.KEYS), out)
        np.testing.assert_array_equal(out, expected)
        frame = np.full((50, 90, 4), 7, np.float32)
        anamorph.pano(panorama, out=frame[3:24, 5:71:2, 2::-1], **self.KEYS)
        np.testing.assert_array_equal(frame[3:24, 5:71:2, 2::-1], expected)
        frame[3:24, 5:71:2, :3] = 7
        self.assertTrue((frame == 7).all())
        bytes_ = anamorph.pano(panorama, out=np.empty((21, 33, 3), np.uint8), **self.KEYS)
        np.testing.assert_array_equal(bytes_, np.floor(np.clip(expected, 0, 1) * np.float32(255) + np.float32(0.5)))

    def test_out_may_be_the_source(self):
        picture = noise(64, 64)
        expected = anamorph.lens(picture, lens="3de4:k1=0.2")
        anamorph.lens(picture, lens="3de4:k1=0.2", out=picture)
        np.testing.assert_array_equal(picture, expected)
        inner = anamorph.Picture("lens", picture, lens="3de4:k1=0.1")
        expected = anamorph.lens(inner, lens="3de4:k1=0.2")
        np.testing.assert_array_equal(anamorph.lens(inner, lens="3de4:k1=0.2", out=picture[::-1]), expected)

    def test_unaligned_bytes_that_are_moved(self):
        ids = np.random.default_rng(SEED).integers(-128, 128, (24, 48, 4), np.int8)
        expected = anamorph.pano(ids, filter="nearest", fov=90, size=(32, 16))
        self.assertEqual(expected.dtype, np.int8)
        for offset in range(5):
            out = np.zeros(32 * 16 * 4 + offset, np.int8)[offset:].reshape(16, 32, 4)
            anamorph.pano(ids, filter="nearest", fov=90, size=(32, 16), out=out)
            np.testing.assert_array_equal(out, expected)
            moved = np.concatenate([np.zeros(offset, np.int8), ids.ravel()])[offset:].reshape(ids.shape)
            np.testing.assert_array_equal(anamorph.pano(moved, filter="nearest", fov=90, size=(32, 16)), expected)

    def test_image_bufs(self):
        panorama = noise(64, 128, 4, "float16")
        spec = oiio.ImageSpec(128, 64, 4, "half")
        buffer = oiio.ImageBuf(spec)
        buffer.set_pixels(oiio.ROI(), panorama)
        drawn = anamorph.pano(buffer, **self.KEYS)
        np.testing.assert_array_equal(drawn, anamorph.pano(panorama, **self.KEYS))
        out = oiio.ImageBuf()
        self.assertIs(anamorph.pano(buffer, out=out, overscan=2, **self.KEYS), out)
        self.assertEqual((out.spec().x, out.spec().width, out.spec().full_width), (-2, 37, 33))
        np.testing.assert_array_equal(out.get_pixels("half"), anamorph.pano(panorama, overscan=2, **self.KEYS))
        self.assertLessEqual(out.spec().get_float_attribute("anamorph:max_error", 9), 0.01)
        with self.assertRaisesRegex(anamorph.Error, "not initialised|cannot be read"):
            anamorph.pano(oiio.ImageBuf(), **self.KEYS)

    def test_image_bufs_without_pixels(self):
        nothing = oiio.ImageBuf(oiio.ImageSpec(12, 8, 3, "uint32"))  # which is no name of a type
        nothing.geterror()
        with self.assertRaisesRegex(anamorph.Error, "the source image cannot be read"):
            anamorph.pano(nothing, fov=60, size=(5, 5))

    def test_a_file_that_is_replaced_after_it_was_opened(self):
        def write(width, height, channels):
            file = oiio.ImageOutput.create("replaced.tif")
            file.open("replaced.tif", oiio.ImageSpec(width, height, channels, "uint8"))
            file.write_image(np.ones((height, width, channels), np.uint8))
            file.close()

        write(5, 6, 1)
        picture = anamorph.Picture("drape", "replaced.tif", surface="sphere", size=(20, 20))
        write(80, 80, 3)
        with self.assertRaisesRegex(anamorph.Error, "replaced.tif.* has changed since it was opened"):
            picture.draw()

    def test_numpy_takes_a_picture(self):
        picture = anamorph.Picture("pano", noise(64, 128), **self.KEYS)
        np.testing.assert_array_equal(np.asarray(picture), picture.draw())
        self.assertEqual(picture.shape, picture.draw().shape)
        self.assertIn("33x21", repr(picture))

    def test_special_numbers(self):
        picture = noise(16, 16)
        picture[4, 4] = np.nan
        picture[8, 8] = np.inf
        same = anamorph.lens(picture, lens="3de4:k1=0", filter="bilinear")
        np.testing.assert_array_equal(same, picture)

    def test_a_picture_keeps_what_it_reads(self):
        picture = anamorph.Picture("warp", anamorph.Picture("pano", noise(64, 128), **self.KEYS), mesh=anamorph.warp(
            noise(21, 33), mesh={"columns": 1, "rows": 1, "vertices": [[0, 0], [33, 1], [0, 21], [33, 20]]}, output="stmap"))
        expected = picture.draw()
        gc.collect()
        scratch = [noise(64, 128, seed=i) for i in range(20)]
        np.testing.assert_array_equal(picture.draw(), expected)
        del scratch


class BadInput(unittest.TestCase):
    def test_keys(self):
        panorama = noise(32, 64)
        for keys, parameter, words in ((dict(fov=2000), "fov", "must be a number above 0"), (dict(fov=float("nan")), "fov", "nan"),
                                       (dict(fov=float("inf")), "fov", "inf"), (dict(fovv=3), "fovv", "perhaps fov"),
                                       (dict(size=(0, 4)), "size", "1 to 1048576"), (dict(size=2**31), "size", "1048576"),
                                       (dict(tile=64), "tile", "in recipes only"), (dict(src="x.exr"), "src", "in recipes only"),
                                       (dict(concatenate=0), "concatenate", "in recipes only"), (dict(to="nowhere"), "to", "must be one of"),
                                       (dict(fov=""), "fov", "must"), (dict(subimage=1), "subimage", "from 0 to 0"),
                                       (dict(subimage=-1), "subimage", "from 0 to 0")):
            with self.subTest(keys), self.assertRaisesRegex(anamorph.Error, words) as caught:
                anamorph.pano(panorama, **keys)
            self.assertEqual(caught.exception.parameter, parameter)
            self.assertIsInstance(caught.exception, ValueError)
            self.assertLess(len(str(caught.exception)), 401)

    def test_keys_that_are_not_given(self):
        photo = noise(32, 40)
        for call, parameter in ((lambda: anamorph.pano(photo), "from"), (lambda: anamorph.lens(photo), "lens"),
                                (lambda: anamorph.lens(photo, lens="brown:k1=.1"), "fov"), (lambda: anamorph.warp(photo), "mesh"),
                                (lambda: anamorph.morph(photo, photo), "features"), (lambda: anamorph.drape(photo, surface="positions"), "positions")):
            with self.subTest(parameter), self.assertRaisesRegex(anamorph.Error, f"^{parameter} is not given") as caught:
                call()
            self.assertEqual(caught.exception.parameter, parameter)

    def test_values_that_are_none(self):
        for value in (object(), 3j, {1: 2}, b"bytes"):
            with self.subTest(value), self.assertRaises(TypeError):
                anamorph.pano(noise(32, 64), fov=value)
        for value in (float("nan"), object()):
            with self.assertRaisesRegex(anamorph.Error, "mesh: cannot be written as JSON") as caught:
                anamorph.warp(noise(32, 64), mesh={"columns": value})
            self.assertEqual(caught.exception.parameter, "mesh")
        for keys, parameter in ((dict(deform=[1]), "deform"), (dict(deform={"deformations": [{"center": [1]}]}), "deform"),
                                (dict(height="none.tif"), "height"), (dict(keys={"turn": [[0]]}), "keys")):
            with self.subTest(keys), self.assertRaises(anamorph.Error) as caught:
                anamorph.drape(noise(32, 64), **keys)
            self.assertEqual(caught.exception.parameter, parameter)
        pathlib.Path("no_mesh.json").write_text("{}")
        for mesh in ({"columns": 1}, {"columns": 1, "rows": 1, "vertices": [[0, 0]]}, "no_mesh.json", "none.json"):
            with self.subTest(mesh), self.assertRaises(anamorph.Error) as caught:
                anamorph.warp(noise(32, 64), mesh=mesh)
            self.assertEqual(caught.exception.parameter, "mesh")
        numbers = {**SHEET, "columns": np.int64(2), "vertices": np.array(SHEET["vertices"], np.float32)}
        np.testing.assert_array_equal(anamorph.warp(noise(48, 64), mesh=numbers), anamorph.warp(noise(48, 64), mesh=SHEET))
        for keys, words in ((dict(deform=[[1.0]]), "^deform: must be an object with nothing but a list, deformations$"),
                            (dict(deform={"deformations": [{"center": [1]}]}), "^deform: ")):
            with self.subTest(keys), self.assertRaisesRegex(anamorph.Error, words):
                anamorph.drape(noise(32, 64), **keys)
        for key in ("back", "positions", "height"):
            for value in ([[1.0]], {"a": 1}, 3, 0.5):
                with self.subTest((key, value)), self.assertRaisesRegex(TypeError, f"^{key} is a {type(value).__name__}: must be an image: the name of a file, an array"):
                    anamorph.drape(noise(32, 64), **{key: value})
        with self.assertRaisesRegex(TypeError, "^mesh is a int: must be an image"):
            anamorph.warp(noise(32, 64), mesh=3)
        with self.assertRaisesRegex(TypeError, "points is a ndarray"):
            anamorph.warp(noise(32, 64), points=np.zeros((3, 4)))
        for call in (lambda: anamorph.pano(src=noise(32, 64)), lambda: anamorph.morph(noise(4, 4), b=noise(4, 4))):
            with self.assertRaisesRegex(anamorph.Error, "must be given first"):
                call()

    def test_names_that_are_no_text(self):
        name = os.fsdecode(b"x\xff.exr")
        write("plain.exr", noise(32, 64))
        os.rename("plain.exr", name)
        self.assertEqual(anamorph.pano(name, fov=60, size=8).shape, (8, 8, 3))
        with self.assertRaises(anamorph.Error):
            anamorph.pano(os.fsdecode(b"y\xff.exr"))
        with self.assertRaises(anamorph.Error):
            anamorph.pano(noise(32, 64), fov="\udcff")
        for call in (lambda: anamorph.pano(name + "\0z"), lambda: anamorph.pano(noise(32, 64), srclens="9\0")):
            with self.assertRaisesRegex(anamorph.Error, "no NUL"):
                call()
        with self.assertRaisesRegex(anamorph.Error, "mesh"):
            anamorph.warp(noise(32, 64), mesh={"columns": 1})
        with self.assertRaisesRegex(anamorph.Error, "mesh"):
            anamorph.warp(noise(32, 64), mesh=noise(32, 64, 1))

    def test_arrays(self):
        for array, error in ((np.zeros((4, 4), complex), TypeError), (np.zeros((4, 4), ">f4"), TypeError), (np.zeros((4, 4), bool), TypeError),
                             (np.zeros((4, 4), "int64"), TypeError), (np.zeros((4, 4), object), TypeError), (np.zeros(4, "f4"), ValueError),
                             (np.zeros((2, 2, 2, 2), "f4"), ValueError), (np.zeros((0, 4), "f4"), ValueError),
                             (np.zeros((4, 4, 0), "f4"), ValueError), (None, TypeError), (3, TypeError), ("nothing.exr", anamorph.Error)):
            with self.subTest(repr(array)), self.assertRaises(error):
                anamorph.pano(array, fov=60)
        with self.assertRaisesRegex(anamorph.Error, "must be 1"):
            anamorph.pano()
        with self.assertRaisesRegex(anamorph.Error, "must be 1"):
            anamorph.pano(noise(4, 4), noise(4, 4))
        with self.assertRaisesRegex(anamorph.Error, "must be one of pano") as caught:
            anamorph.apply("panno", noise(4, 4))
        self.assertEqual((caught.exception.parameter, anamorph.Error("x").parameter), ("operation", ""))

    def test_images(self):
        pixels = noise(8, 8)
        for keys, error in ((dict(channels=("R",)), anamorph.Error), (dict(corner=(1,)), ValueError), (dict(corner=(2**31, 0)), ValueError),
                            (dict(display=(0, 0, 0, 8)), ValueError), (dict(display=(0, 0, 8)), ValueError), (dict(corner=(0.5, 0)), TypeError), (dict(channels=(1, 2, 3)), TypeError), (dict(metadata={1: 2}), TypeError),
                            (dict(metadata={"a": [1]}), TypeError), (dict(display=(-2**31, 0, 2**31 - 1, 8)), anamorph.Error)):
            with self.subTest(keys), self.assertRaises(error):
                anamorph.lens(anamorph.Image(pixels, **keys), lens="3de4:k1=0.1")

    def test_calls(self):
        picture = anamorph.Picture("pano", noise(32, 64), fov=60, size=(20, 10))
        for keys, error in ((dict(roi=(0, 0, 0, 5)), ValueError), (dict(roi=(0, 0, 5)), ValueError), (dict(roi=3), ValueError),
                            (dict(roi=(0, 0, 2**31, 1)), ValueError), (dict(roi=(2**31 - 2, 0, 2**31 - 1, 1)), anamorph.Error),
                            (dict(roi=(0, -2**31, 1, 1 - 2**31)), anamorph.Error), (dict(roi=(0.5, 0, 2, 2)), TypeError), (dict(out=[[0]]), TypeError),
                            (dict(out=np.empty((20, 10, 3), "f4")), ValueError), (dict(out=np.empty((10, 20, 3), complex)), TypeError),
                            (dict(progress=3), TypeError)):
            with self.subTest(keys), self.assertRaises(error):
                picture.draw(**keys)
        fixed = np.empty((10, 20, 3), "f4")
        fixed.flags.writeable = False
        with self.assertRaisesRegex(ValueError, "read-only"):
            picture.draw(out=fixed)
        for keys in (dict(threads=1.5), dict(subimage="0"), dict(threads=[])):
            with self.subTest(keys), self.assertRaisesRegex(TypeError, "must be an integer"):
                anamorph.pano(noise(32, 64), **keys)
        for operation in (3, None, b"pano"):
            for call in (anamorph.apply, anamorph.Picture):
                with self.subTest(operation), self.assertRaisesRegex(TypeError, f"^operation={operation!r}: must be a str, one of "):
                    call(operation, noise(32, 64))
        with self.assertRaisesRegex(anamorph.Error, "^operation=.*: must be one of "):
            anamorph.apply("\udcff", noise(32, 64))
        with self.assertRaises(UnicodeEncodeError):
            anamorph.pano(noise(32, 64), to="\ud800")
        path = type("Path", (), {"__fspath__": lambda self: b"/x.json"})()
        with self.assertRaisesRegex(TypeError, "mesh is a path of bytes"):
            anamorph.warp(noise(32, 64), mesh=path)
        named = anamorph.Image(noise(32, 64), metadata={"\udcff": "x"})
        self.assertEqual(anamorph.pano(named, size=4).shape, (4, 4, 3))
        with self.assertRaisesRegex(ValueError, "at least 0"):
            anamorph.pano(noise(32, 64), threads=-1)
        self.assertEqual(picture.draw().shape, (10, 20, 3))


class Calls(unittest.TestCase):
    def test_progress(self):
        rows = []
        drawn = anamorph.pano(noise(64, 128), fov=60, size=(40, 700), progress=rows.append)
        self.assertEqual(sum(rows), 700)
        self.assertGreater(len(rows), 1)
        np.testing.assert_array_equal(drawn, anamorph.pano(noise(64, 128), fov=60, size=(40, 700)))

        class Stop(Exception):
            pass

        def stop(_):
            raise Stop

        with self.assertRaises(Stop):
            anamorph.pano(noise(64, 128), fov=60, size=(40, 700), progress=stop)

    def test_keyboard_interrupt(self):
        code = ("import numpy, anamorph\nprint('ready', flush=True)\n"
                "try:\n"
                "    while True: anamorph.map(numpy.zeros((64, 64, 3), 'f4'), u='x+sin(y*x/7)', v='y+sin(x)', tol=0, size=(6000, 6000))\n"
                "except KeyboardInterrupt:\n    print('interrupted')\n")
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "ready\n")
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            try:
                self.assertEqual(process.communicate(timeout=100), ("interrupted\n", ""))
            finally:
                process.kill()
            self.assertEqual(process.returncode, 0)

    def test_daemon_threads_when_python_ends(self):
        code = ("import threading, time, numpy, anamorph\n"
                "def draw(progress):\n"
                "    while True: anamorph.map(numpy.zeros((64, 64, 3), 'f4'), u='x+1', v='y', size=(300, 300), progress=progress)\n"
                "for progress in (None, abs, None, lambda rows: None): threading.Thread(target=draw, args=[progress], daemon=True).start()\n"
                "time.sleep(0.3)\n")
        for _ in range(4):
            ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100)
            self.assertEqual((ended.returncode, ended.stderr), (0, ""))

    def test_threads_of_python(self):
        panorama = noise(128, 256)
        picture = anamorph.Picture("pano", panorama, fov=100, size=(200, 200))
        whole = picture.draw()
        boxes = [(x, y, x + 50, y + 50) for x in range(0, 200, 50) for y in range(0, 200, 50)]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for (x0, y0, x1, y1), part in zip(boxes * 4, pool.map(lambda box: picture.draw(roi=box), boxes * 4)):
                np.testing.assert_array_equal(part, whole[y0:y1, x0:x1])

    def test_fork(self):
        panorama = noise(128, 256)
        expected = anamorph.pano(panorama, fov=100, size=(300, 300))
        context = multiprocessing.get_context("fork")
        results = context.SimpleQueue()
        child = context.Process(target=lambda: results.put(np.array_equal(anamorph.pano(panorama, fov=100, size=(300, 300)), expected)),
                                daemon=True)
        child.start()
        child.join(60)
        self.assertEqual(child.exitcode, 0)
        self.assertTrue(results.get())

    def test_memory_and_files_stay(self):
        panorama = noise(32, 64)
        mesh = {"columns": 1, "rows": 1, "vertices": [[0, 0], [16, 1], [0, 16], [16, 15]]}

        def calls(count):
            for i in range(count):
                anamorph.pano(panorama, fov=60 + i % 7, size=(16, 16))
                anamorph.warp(anamorph.Picture("pano", panorama, fov=60, size=(16, 16)), mesh=mesh)
                try:
                    anamorph.pano(panorama, fov=-1)
                except anamorph.Error:
                    pass
            gc.collect()
            pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE"), len(os.listdir("/proc/self/fd"))

        before = calls(1000)
        after = calls(3000)
        self.assertEqual(after[1], before[1])
        # A thousand bytes a call would be twelve million.
        self.assertLess(after[0] - before[0], 4 << 20)


class Words(unittest.TestCase):
    def test_help_and_signatures(self):
        for name in anamorph.operations:
            function = getattr(anamorph, name)
            text = pydoc.render_doc(function)
            names = list(inspect.signature(function).parameters)
            self.assertIn("roi", names)
            self.assertNotIn("from", names)
            for key in names:
                if key not in ("sources", "definitions"):
                    self.assertIn(f"{key}:", text)
            self.assertNotIn("tile", names)
        self.assertIn("from_", inspect.signature(anamorph.pano).parameters)

    def test_stubs_say_what_is_there(self):
        package = pathlib.Path(anamorph.__file__).parent
        self.assertTrue((package / "py.typed").exists())
        tree = ast.parse((package / "__init__.pyi").read_text())
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        self.assertEqual(set(functions), {"apply", *anamorph.operations})
        for name in anamorph.operations:
            stub, real = functions[name].args, inspect.signature(getattr(anamorph, name)).parameters
            names = [stub.vararg.arg, *(a.arg for a in stub.kwonlyargs), *([stub.kwarg.arg] if stub.kwarg else [])]
            self.assertEqual(names, list(real))
        classes = {node.name: {n.name for n in node.body if isinstance(n, ast.FunctionDef)} for node in tree.body
                   if isinstance(node, ast.ClassDef)}
        for of in (anamorph.Picture, anamorph.Map):
            public = {name for name in vars(of) if not name.startswith("_")}
            self.assertEqual(public, {name for name in classes[of.__name__] if not name.startswith("_")})


if __name__ == "__main__":
    unittest.main()
