# SPDX-License-Identifier: Apache-2.0
"""Two fisheyes, each turned by itself and mixed where both see, and faces with padding: sampling points and weights against
NumPy's own words, padding also against ffmpeg's v360.

The colour of a source's pixel is its own place, so that what bilinear filtering makes of it tells where it was sampled.
"""
import json
import shutil
import subprocess
import unittest

import numpy as np
import OpenImageIO as oiio

TOL = 1e-4  # source pixels
SEED = 20260
SIDE = 256  # of one lens's picture, or of a face
# Float32 holds places up to 512 to 3e-5; the weights are float too.
ROUNDING = 2e-4


def write(name, pixels):
    pixels = np.ascontiguousarray(pixels.astype(np.float32))
    picture = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float"))
    assert picture.set_pixels(oiio.ROI(), pixels) and picture.write(name), picture.geterror()


def read(name, subimage=0):
    picture = oiio.ImageBuf(name, subimage, 0)
    pixels = picture.get_pixels("float")
    assert not picture.has_error, picture.geterror()
    return np.asarray(pixels, dtype=float)


def unit(x, y, z):
    rays = np.stack(np.broadcast_arrays(x, y, z), -1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def rotation(yaw, pitch, roll):
    """From camera to world: roll is applied first, then pitch, then yaw."""
    (sy, sp, sr), (cy, cp, cr) = np.sin(np.radians([yaw, pitch, roll])), np.cos(np.radians([yaw, pitch, roll]))
    return (np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
            @ np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]]))


def middles(width, height):
    return np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)


def panorama_rays(width, height):
    x, y = middles(width, height)
    a, e = (x / width - 0.5) * 2 * np.pi, (y / height - 0.5) * np.pi
    return unit(np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e))


def photo_rays(width, height, fov, beyond=0):
    x, y = middles(width + 2 * beyond, height + 2 * beyond)
    s = np.tan(np.radians(fov / 2)) * 2 / width
    return unit((x - beyond - width / 2) * s, (y - beyond - height / 2) * s, 1)


def faces_rays(x, y):
    """The rays of a face's points, from -1 to 1: right, left, up, down, front, back, each upright but for the poles, which are
    hinged to the front."""
    return [unit(1, y, -x), unit(-1, y, x), unit(x, -1, y), unit(x, 1, -y), unit(x, y, 1), unit(-x, y, -1)]


def grid_rays(side):
    """The rays of a layout of 3 x 2 faces, cubemap3x2."""
    x, y = middles(side, side)
    faces = faces_rays(2 * x / side - 1, 2 * y / side - 1)
    return np.vstack([np.hstack(faces[:3]), np.hstack(faces[3:])])


class Pair:
    """Two fisheyes of `fov` degrees, whose circles end `padding` pixels within their pictures."""

    def __init__(self, fov, padding=0, front=(0, 0, 0), back=(0, 0, 0), held=(0, 0, 0), seam=0):
        self.fov, self.padding, self.held, self.seam = fov, padding, held, seam
        self.turns = {"front": front, "back": back}

    def keys(self):
        keys = [f"srcfov={self.fov:.17g}", f"seam={self.seam:.17g}", f"srcpadding={self.padding}"]
        keys += ["src{}={:.17g}".format(*k) for k in zip(("yaw", "pitch", "roll"), self.held)]
        for lens, turn in self.turns.items():
            keys += [f"{lens}_{name}={angle:.17g}" for name, angle in zip(("yaw", "pitch", "roll"), turn)]
        return "&".join(keys)

    def seen(self, rays):
        """Of each lens the points on its picture, and its weights."""
        points, margins = [], []
        for lens, behind in (("front", 0), ("back", 180)):
            camera = rotation(*self.held) @ rotation(behind, 0, 0) @ rotation(*self.turns[lens])
            x, y, z = np.moveaxis(rays @ camera, -1, 0)  # the transposed matrix, from world to lens
            angle, away = np.arctan2(np.hypot(x, y), z), np.hypot(x, y)
            scale = np.degrees(angle) / (self.fov / 2) * (SIDE / 2 - self.padding) / np.maximum(away, 1e-300)
            points.append(np.stack([SIDE / 2 + x * scale, SIDE / 2 + y * scale], -1))
            margins.append(self.fov / 2 - np.degrees(angle))
        return points, self.weights(*margins)

    def weights(self, front, back):
        both = np.minimum(self.seam, front + back)
        with np.errstate(divide="ignore", invalid="ignore"):
            mixed = np.clip(0.5 + (front - back) / (2 * both), 0, 1)
        mixed = np.where(both > 0, mixed, front > back)
        first = np.where(front < 0, 0, np.where(back < 0, 1, mixed))
        second = np.where(back < 0, 0, np.where(front < 0, 1, 1 - mixed))
        return first, second


def places_of_pair(name, beside):
    """A source whose front has the channels x, y, 1 and whose back has x, y in two others."""
    x, y = middles(SIDE, SIDE)
    none, one = np.zeros_like(x), np.ones_like(x)
    front, back = np.stack([x, y, one, none, none, none], -1), np.stack([none, none, none, x, y, one], -1)
    write(name, np.hstack([back, front]) if beside else np.vstack([front, back]))


LOOKS = {"to=equirectangular&size=200x100": lambda: panorama_rays(200, 100),
         "to=rectilinear&fov=110&size=120x90": lambda: photo_rays(120, 90, 110),
         "to=rectilinear&fov=90&size=60x40&overscan=10": lambda: photo_rays(60, 40, 90, beyond=10),
         "to=cubemap3x2&size=120": lambda: grid_rays(40)}
PAIRS = [Pair(195), Pair(200, seam=8), Pair(200, seam=360), Pair(180, seam=10), Pair(170, front=(3, 2, 1)),
         Pair(210, 20, (2, -1, 90), (-3, 1.5, -90), (20, 10, -5), 12), Pair(190, 8, back=(4, 2, 1), seam=360)]


class FisheyePair(unittest.TestCase):

    def compare(self, name, projection, pair, look, rays, turn):
        keys = "&yaw={:.17g}&pitch={:.17g}&roll={:.17g}".format(*turn)
        seen = read(f"{name}.pano?from={projection}&{pair.keys()}&{look}{keys}&filter=bilinear&tol={TOL}")
        (front, back), (first, second) = pair.seen(rays @ rotation(*turn).T)
        self.assertEqual(seen.shape[:2], first.shape)
        # Filters reach beyond a lens's picture within half a pixel of its edges.
        inside = [np.all((p > 1) & (p < SIDE - 1), -1) | (w == 0) for p, w in ((front, first), (back, second))]
        where = inside[0] & inside[1]
        # Which lens counts alone is not known where both lie as far within their rims.
        if pair.seam == 0:
            where &= np.abs(np.linalg.norm(front - SIDE / 2, axis=-1) - np.linalg.norm(back - SIDE / 2, axis=-1)) > 1e-6
        self.assertGreater(where.mean(), 0.5)
        expected = np.concatenate([front * first[..., None], first[..., None], back * second[..., None],
                                   second[..., None]], -1)
        expected[np.concatenate([np.repeat(first[..., None] == 0, 3, -1), np.repeat(second[..., None] == 0, 3, -1)], -1)] = 0
        off = np.abs(seen[..., :6] - expected)[where]
        self.assertLess(off[:, [2, 5]].max(), 1e-6)
        self.assertLess(off.max(), 1.5 * TOL + ROUNDING)
        return first

    def test_points_and_weights(self):
        random = np.random.default_rng(SEED)
        print("seed", SEED)
        mixed = 0
        for beside, projection in ((True, "dual_fisheye"), (False, "dual_fisheye_tb")):
            places_of_pair(f"{projection}.exr", beside)
            for pair in PAIRS:
                for look, rays in LOOKS.items():
                    turn = random.uniform([-180, -90, -180], [180, 90, 180])
                    with self.subTest(pair=pair.keys(), look=look, projection=projection):
                        first = self.compare(f"{projection}.exr", projection, pair, look, rays(), turn)
                        mixed += np.count_nonzero((first > 0) & (first < 1))
        self.assertGreater(mixed, 3000)

    def test_what_is_said_holds(self):
        places_of_pair("said.exr", True)
        keys = PAIRS[5].keys() + "&from=dual_fisheye&to=equirectangular&size=300x150&yaw=33&pitch=21"
        for tol in ("0.3", "0.01", "0.00001"):
            name = f"said.exr.pano?{keys}&tol={tol}"
            picture = oiio.ImageBuf(name)
            bound = picture.spec().get_float_attribute("anamorph:max_error")
            self.assertLessEqual(bound, float(tol) * (1 + 1e-6))
            self.assertLessEqual(read(name + "&output=error").max(), bound * (1 + 1e-6))

    def test_unblended_is_what_it_was(self):
        """All angles 0 and seam=0: the same picture as without these keys, but for what is next to the seam."""
        random = np.random.default_rng(SEED + 1)
        write("plain.exr", random.uniform(0.2, 1, (SIDE, 2 * SIDE, 3)))
        x, _ = middles(200, 100)
        away = np.minimum(np.abs(x - 50), np.abs(x - 150)) > 2
        for keys in ("", "&pixels=centers", "&pixels=centers&srcpadding=7"):
            view = "plain.exr.pano?from=dual_fisheye&srcfov=200&to=equirectangular&size=200x100&filter=bilinear&tol=0.00001" + keys
            before, after = read(view), read(view + "&front_yaw=0")
            self.assertLess(np.abs(before - after)[away].max(), 2e-4, keys)

    def test_films_and_open_shutters(self):
        places_of_pair("film.exr", True)
        with open("turning.json", "w") as file:
            json.dump({"keys": {"front_yaw": [[0, 0], [1, 8]], "seam": [[0, 5], [1, 9]]}}, file)
        base = "film.exr.pano?from=dual_fisheye&srcfov=205&size=60x40&fov=120&yaw=80&filter=bilinear&tol=0.0001"
        # Of two key frames each number runs evenly.
        moments = [0.5 + 0.5 * ((k + 0.5) / 4 - 0.5) for k in range(4)]
        mean = np.mean([read(f"{base}&front_yaw={8 * t}&seam={5 + 4 * t}") for t in moments], 0)
        blurred = read(f"{base}&keys=turning.json&frame=0.5&shutter=0.5&samples=4")
        self.assertLess(np.abs(mean - blurred).max(), 1e-3)
        frames = [read(f"{base}&keys=turning.json", i) for i in (0, 1)]
        self.assertEqual(np.abs(frames[1] - read(f"{base}&front_yaw=8&seam=9")).max(), 0)
        self.assertEqual(np.abs(frames[0] - read(f"{base}&front_yaw=0&seam=5")).max(), 0)

    def test_two_eyes_and_coverage(self):
        random = np.random.default_rng(SEED + 2)
        left, right = (random.uniform(0, 1, (SIDE, 2 * SIDE, 3)) for _ in range(2))
        write("left.exr", left), write("both.exr", np.vstack([left, right]))
        view = "&from=dual_fisheye&srcfov=200&seam=10&back_roll=4&size=50x40&fov=130&yaw=70"
        np.testing.assert_array_equal(read("both.exr.pano?stereo=top-bottom&eye=left" + view),
                                      read("left.exr.pano?srcyaw=0" + view))
        # Where the lenses see all there is no hole; where one of 160 degrees does not, there is.
        whole = "left.exr.pano?from=dual_fisheye&to=equirectangular&size=100x50&output=coverage&seam=10"
        self.assertGreater(read(whole + "&srcfov=200").min(), 0.999)
        self.assertEqual(read(whole + "&srcfov=160").min(), 0)

    def test_chains_draw_it_first(self):
        random = np.random.default_rng(SEED + 4)
        write("chain.exr", random.uniform(0, 1, (SIDE, 2 * SIDE, 3)))
        inner = "chain.exr.pano?from=dual_fisheye&srcfov=200&seam=15&size=64x48&yaw=80"
        outer = oiio.ImageBuf(f"x.lens?lens=3de4:k1=0&filter=nearest&src=({inner})")
        self.assertEqual(outer.spec().get_string_attribute("anamorph:chain"),
                         "lens of a picture that is drawn first: its source is no picture of maps")
        np.testing.assert_array_equal(np.asarray(outer.get_pixels("float"), dtype=float), read(inner))

    def test_same_bits_for_parts(self):
        random = np.random.default_rng(SEED + 3)
        write("parts.exr", random.uniform(0, 1, (SIDE, 2 * SIDE, 3)))
        name = "parts.exr.pano?from=dual_fisheye&srcfov=200&seam=15&to=cubemap3x2&size=192x128&yaw=20&front_roll=3"
        whole = read(name)
        for tile in ("16", "0", "100x30"):
            np.testing.assert_array_equal(read(f"{name}&tile={tile}"), whole)


def refused(recipe):
    file = oiio.ImageInput.open(recipe)
    return "" if file else oiio.geterror()


class BadInput(unittest.TestCase):

    def test_keys(self):
        write("pair.exr", np.ones((32, 64, 3)))
        for key in ("front_yaw", "front_pitch", "front_roll", "back_yaw", "back_pitch", "back_roll", "seam"):
            for value in ("nan", "inf", "-inf", "", "left", "1,2", "1e999"):
                self.assertIn(f"{key}={value}", refused(f"pair.exr.pano?from=dual_fisheye&{key}={value}"))
            for source in ("latlong", "fisheye", "mercator"):
                self.assertIn("must be of from=dual_fisheye", refused(f"pair.exr.pano?from={source}&{key}=1"))
            self.assertIn("output=stmap: must not be given with " + key,
                          refused(f"pair.exr.pano?from=dual_fisheye&{key}=1&output=stmap"))
            self.assertIn("scheme=hardware", refused(f"pair.exr.pano?from=dual_fisheye&{key}=1&scheme=hardware"))
            self.assertIn("to=formula", refused(f"pair.exr.pano?from=dual_fisheye&{key}=1&to=formula&ray_x=px"))
        self.assertIn("seam=-1", refused("pair.exr.pano?from=dual_fisheye&seam=-1"))
        self.assertIn("seam=361", refused("pair.exr.pano?from=dual_fisheye&seam=361"))
        for value in ("1e308", "-1e308", "1e-308"):
            self.assertEqual("", refused(f"pair.exr.pano?from=dual_fisheye&front_yaw={value}&size=9"))
        write("cube.exr", np.ones((64, 96, 3)))
        for key in ("padding", "srcpadding"):
            for value in ("nan", "-1", "1.5", "2147483648", "", "1e3", "1x1", "9999999"):
                self.assertIn(f"{key}={value}", refused(f"cube.exr.pano?from=cubemap3x2&to=cubemap3x2&{key}={value}"))
        for keys, what in (("from=cubemap3x2&srcpadding=8", "srcpadding=8: must be 0 or more, and less than a quarter"),
                           ("from=cubemap3x2&to=cubemap3x2&size=96&padding=8", "padding=8: must be 0 or more"),
                           ("from=cubemap3x2&padding=8", "padding=8: must be of a layout of faces"),
                           ("from=rectilinear&srcpadding=2", "srcpadding=2: must be of a layout of faces"),
                           ("from=mercator&srcpadding=2", "srcpadding=2: must be of a layout of faces"),
                           ("from=fisheye&srcpadding=2&srclens=kb4:k1=0.1", "must not be given with srclens"),
                           ("from=cubemap3x2&to=cubemap3x2&padding=2&face=up", "must not be given with face"),
                           ("from=cubemap3x2&to=formula&ray_x=px&padding=2", "to=formula")):
            self.assertIn(what, refused("cube.exr.pano?" + keys))
        self.assertEqual("", refused("cube.exr.pano?from=cubemap3x2&srcpadding=7"))


class Padding(unittest.TestCase):

    GRID = ((0, 1, 2), (3, 4, 5))  # right, left, up; down, front, back

    def layout(self, side, padding, angular=False):
        """The rays of a layout of 3 x 2 faces."""
        x, y = middles(side, side)
        x, y = ((p - side / 2) / (side / 2 - padding) for p in (x, y))
        if angular:
            x, y = np.tan(x * np.pi / 4), np.tan(y * np.pi / 4)
        faces = faces_rays(x, y)
        return np.vstack([np.hstack([faces[i] for i in row]) for row in self.GRID])

    def test_faces_show_what_goes_on(self):
        """A panorama of places, drawn as faces with padding."""
        x, y = middles(1024, 512)
        write("places.exr", np.stack([np.abs(x - 512), y, x * 0], -1))
        for side, padding in ((64, 0), (64, 8), (70, 17), (33, 3)):
            seen = read(f"places.exr.pano?from=latlong&to=cubemap3x2&size={3 * side}&padding={padding}"
                        f"&filter=bilinear&tol={TOL}")
            rays = self.layout(side, padding)
            a, e = np.arctan2(rays[..., 0], rays[..., 2]), np.arcsin(rays[..., 1])
            u, v = np.abs(a) / (2 * np.pi) * 1024, (e / np.pi + 0.5) * 512
            # Between texels of either side of the middle, the seam and the poles places do not run evenly.
            where = (u > 2) & (u < 510) & (v > 30) & (v < 482)
            self.assertGreater(where.mean(), 0.8)
            self.assertLess(np.abs(seen[..., 0] - u)[where].max(), 3e-4)
            self.assertLess(np.abs(seen[..., 1] - v)[where].max(), 3e-4)

    def test_and_back(self):
        """A layout whose pixels are their places, with padding and without, read as a panorama."""
        for name, kind in (("cubemap3x2", False), ("eac", True)):
            for side, padding in ((64, 8), (50, 12), (80, 1)):
                x, y = middles(3 * side, 2 * side)
                write("faces.exr", np.stack([x, y, x * 0], -1))
                rays = panorama_rays(200, 100)
                seen = read(f"faces.exr.pano?from={name}&srcpadding={padding}&to=equirectangular&size=200x100"
                            f"&filter=bilinear&tol={TOL}")
                inner = side / 2 - padding
                # The place within its face, whichever that is and however it is turned.
                local = np.stack([seen[..., 0] % side, seen[..., 1] % side], -1) - side / 2
                size = np.sort(np.abs(rays), axis=-1)
                small, middle = size[..., 0] / size[..., 2], size[..., 1] / size[..., 2]
                if kind:
                    small, middle = np.arctan(small) * 4 / np.pi, np.arctan(middle) * 4 / np.pi
                found = np.sort(np.abs(local), axis=-1)
                self.assertLess(np.abs(found[..., 0] - small * inner).max(), 3e-4)
                self.assertLess(np.abs(found[..., 1] - middle * inner).max(), 3e-4)
                self.assertLessEqual(found.max(), inner + 3e-4)

    def test_is_read_as_it_was_written(self):
        write("smooth.exr", 0.5 + 0.2 * np.sin(panorama_rays(1024, 512) @ np.array([[2, 1, -2], [2, -1, 3], [-3, 3, 1]])))
        view = "to=equirectangular&size=200x100&tol=0.001"
        for to in ("cubemap", "cubemap3x2", "cubecross", "eac"):
            name = f"padded_{to}.exr"
            subprocess.run(["oiiotool", f"smooth.exr.pano?from=latlong&to={to}&padding=10&tol=0.001", "-o", name], check=True)
            spec = oiio.ImageBuf(name).spec()
            self.assertTrue(spec.get_string_attribute("panoramaProjection").endswith(" padding=10"))
            self.assertEqual(spec.get_string_attribute("textureformat"), "")
            again = read(f"{name}.pano?{view}")
            self.assertLess(np.abs(again - read(f"smooth.exr.pano?from=latlong&{view}")).max(), 2e-3)
            np.testing.assert_array_equal(again, read(f"{name}.pano?from={to}&srcpadding=10&{view}"))

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed (Debian package ffmpeg)")
    def test_as_ffmpeg(self):
        """v360 counts the pixels of both sides together: fout_pad=12 is 6 at each. Limits as in test_peers.py."""
        rays = panorama_rays(1024, 512)
        pixels = np.round((0.5 + 0.4 * rays) * 65535).astype(np.uint16)
        picture = oiio.ImageBuf(oiio.ImageSpec(1024, 512, 3, "uint16"))
        assert picture.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels)) and picture.write("around.tif")

        def v360(source, arguments, target):
            subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", source, "-vf",
                            f"format=gbrp16le,v360={arguments}:interp=linear,format=rgb48be", "-frames:v", "1", target],
                           check=True, stdin=subprocess.DEVNULL)
            return (read(target)[..., :3] - 0.5) / 0.4

        def angle(a, b):
            return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))

        theirs = v360("around.tif", "e:c3x2:w=384:h=256:fout_pad=12", "padded.png")
        mine = (read("around.tif.pano?from=latlong&pixels=centers&to=cubemap3x2&size=384&padding=6&filter=bilinear")[..., :3] - 0.5) / 0.4
        pixel = 2 * np.pi / 1024
        self.assertLess(angle(theirs, mine).max() / pixel, 0.07)
        back = v360("padded.png", "c3x2:e:w=512:h=256:fin_pad=12", "back.png")
        ours = (read("padded.png.pano?from=cubemap3x2&srcpadding=6&to=equirectangular&size=512x256&filter=bilinear")[..., :3] - 0.5) / 0.4
        self.assertLess(np.median(angle(back, ours)) / (2 / 116), 0.02)
        # Read with another padding it is another picture.
        for wrong in (5, 7):
            other = (read(f"padded.png.pano?from=cubemap3x2&srcpadding={wrong}&to=equirectangular&size=512x256&filter=bilinear")[..., :3] - 0.5) / 0.4
            self.assertGreater(np.median(angle(back, other)) / (2 / 116), 0.2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
