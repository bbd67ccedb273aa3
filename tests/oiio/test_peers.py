# SPDX-License-Identifier: Apache-2.0
"""Geometry and colour against other programs: ffmpeg's v360 filter and hugin's nona, each where it is installed.

How geometry is measured. The colour of a "direction picture" is the direction that each pixel looks in (x right,
y down, z forward, a unit vector). Whatever a program makes of it can be read back as directions, so the angle
between the answers of two programs is known at every pixel, and so is the angle to the direction that the
formulas below ask for. Angles are given in source pixels: one is what a pixel of the source spans at its centre.
Storing directions in 16 bits and bilinear interpolation between them cost 0.01 source pixels at the sizes used
here; our own tolerance, the default, is another 0.01.

Where pixels lie, found by trying both conventions (the wrong one is off by 0.15 to 0.4 pixels in the median):
  nona   source and target  field of view from edge to edge, as here by default
  v360   target             from edge to edge, every projection
         source             cube faces from edge to edge; equirectangular, rectilinear and fisheye between the
                            centres of the outer pixels, which is pixels=centers here

Angles: both peers and we turn right with yaw, up with pitch, clockwise with roll, and apply roll, pitch, yaw
(v360's default rorder=ypr names them from the outermost). In v360 they turn the target's camera, as here. In
nona they turn the camera that took the source: its y, p, r put a photo into a panorama from where our yaw,
pitch, roll take it out.

All resample bilinearly.
"""
import os
import shutil
import subprocess
import unittest

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 1024, 512  # of the panorama
PANORAMA_PIXEL = 2 * np.pi / WIDTH
FACE = 256
FACE_PIXEL = 2 / FACE

ORIENTATIONS = [(0, 0, 0), (40, 0, 0), (0, 30, 0), (0, 0, 20), (40, 30, 20), (-120, -50, 70)]

# ------------------------------------------------------------------------------------------------------------
# Directions by formulas of this file's own.


def unit(x, y, z):
    rays = np.stack(np.broadcast_arrays(x, y, z), -1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def panorama_rays(spacing="edges"):
    if spacing == "edges":
        u, v = (np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT) + 0.5) / HEIGHT
    else:
        u, v = np.arange(WIDTH) / (WIDTH - 1), np.arange(HEIGHT) / (HEIGHT - 1)
    a, e = np.meshgrid((u - 0.5) * 2 * np.pi, (v - 0.5) * np.pi)
    return unit(np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e))


def plane(width, height, spacing="edges"):
    """Points of a picture whose width spans -1 to 1."""
    n = width if spacing == "edges" else width - 1
    return np.meshgrid((2 * np.arange(width) + 1 - width) / n, (2 * np.arange(height) + 1 - height) / n)


def photo_rays(width, height, fov, spacing="edges"):
    x, y = plane(width, height, spacing)
    s = np.tan(np.radians(fov / 2))
    return unit(x * s, y * s, 1)


def fisheye_rays(size, fov, spacing):
    x, y = plane(size, size, spacing)
    r = np.hypot(x, y)
    t = r * np.radians(fov / 2)
    k = np.sin(t) / np.maximum(r, 1e-12)
    return unit(x * k, y * k, np.cos(t))


def cube3x2_rays():
    """v360's c3x2 in its default order: right left up / down front back."""
    x, y = plane(FACE, FACE)
    right, left = unit(1, y, -x), unit(-1, y, x)
    up, down = unit(x, -1, y), unit(x, 1, -y)
    front, back = unit(x, y, 1), unit(-x, y, -1)
    return np.vstack([np.hstack([right, left, up]), np.hstack([down, front, back])])


def off_cube_edges(rays, pixels):
    """Where rays hit a face at least so many of its pixels from its edges."""
    size = np.sort(np.abs(rays), axis=-1)
    return size[..., 1] / size[..., 2] < 1 - 2 * pixels / FACE


def rotation(yaw, pitch, roll):
    """From camera to world: roll is applied first, then pitch, then yaw."""
    (sy, sp, sr), (cy, cp, cr) = np.sin(np.radians([yaw, pitch, roll])), np.cos(np.radians([yaw, pitch, roll]))
    return (np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
            @ np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]]))


def inverse_orientation(orientation):
    """The yaw, pitch and roll that undo these."""
    m = rotation(*orientation).T
    return tuple(np.degrees([np.arctan2(m[0, 2], m[2, 2]), np.arcsin(-m[1, 2]), np.arctan2(m[1, 0], m[1, 1])]))


# ------------------------------------------------------------------------------------------------------------
# Pictures of directions and of smooth colours, and their comparison.


def write(name, values):
    """Values in 0 to 1, as 16 bits."""
    pixels = np.ascontiguousarray(np.round(values * 65535).astype(np.uint16))
    picture = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint16"))
    assert picture.set_pixels(oiio.ROI(), pixels) and picture.write(name), picture.geterror()


def read(name):
    picture = oiio.ImageBuf(name)
    pixels = picture.get_pixels("float")
    assert not picture.has_error, picture.geterror()
    return np.asarray(pixels, dtype=float)


def waves(rays):
    """Smooth colours: 0.2 either side of 0.5, at most 0.0072 from one panorama pixel to the next (0.2 |gradient|
    2 pi / 1024, with |gradient| up to sqrt(34))."""
    return 0.5 + 0.2 * np.sin(rays @ np.array([[5, 1, -2], [2, -4, 3], [-3, 3, 4]]).T)


def save_pictures(name, rays):
    """NAME.tif shows the directions, NAME_waves.tif the waves."""
    write(name + ".tif", 0.5 + 0.4 * rays)
    write(name + "_waves.tif", waves(rays))


def directions(pixels):
    return (pixels[..., :3] - 0.5) / 0.4


def angles(a, b, pixel):
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1)) / pixel


def recipe(name, arguments):
    """Our picture, with the source resampled as the peers do."""
    return read(f"{name}.pano?filter=bilinear&{arguments}")


def turned(orientation):
    return "yaw={:.12g}&pitch={:.12g}&roll={:.12g}".format(*orientation)


def run(*command):
    environment = {k: v for k, v in os.environ.items() if k not in ("LD_PRELOAD", "ASAN_OPTIONS")}
    environment["LC_ALL"] = "C"
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=120)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}"


class PictureTest(unittest.TestCase):
    jobs = 0

    def new_name(self, suffix):
        PictureTest.jobs += 1
        return f"job{PictureTest.jobs}{suffix}"

    def assert_close(self, differences, median, largest, what):
        """Differences of at most `largest` everywhere, and of at most `median` at half of the pixels."""
        found = f"{what}: median {np.median(differences):.2g}, largest {differences.max():.2g}"
        print(found, flush=True)
        self.assertGreater(differences.size, 1000, what)
        self.assertLessEqual(np.median(differences), median, found)
        self.assertLessEqual(differences.max(), largest, found)

    def assert_unlike(self, differences, median, what):
        """What a wrong sign or convention does, to show that the comparison sees it."""
        self.assertGreaterEqual(np.median(differences), median, what)


# ------------------------------------------------------------------------------------------------------------


class RoundTrip(PictureTest):
    """Panorama -> cube -> panorama gives the panorama back.

    Off the edges of faces: 0.03 panorama pixels, what two tolerances of 0.01 and storing directions in 16 bits
    make. Across an edge, bilinear interpolation between two faces meets a kink in the picture and cuts it by a
    tenth of a face's pixel: 0.2. Half a pixel from a wrong edge or convention would show. Colour: 1/1000 of full
    scale, a seventh of the waves' largest step.
    """

    def test_cubes(self):
        rays = panorama_rays()
        inner = off_cube_edges(rays, 1)
        save_pictures("around", rays)
        for layout, size in (("cubemap", "256x1536"), ("cubemap3x2", "768x512"), ("cubecross", "1024x768")):
            results = {}
            for picture in ("around", "around_waves"):
                cube = f"{layout}_{picture}.tif"
                pixels = read(f"{picture}.tif.pano?to={layout}&size={size}")
                write(cube, np.clip(pixels[..., :3], 0, 1))
                results[picture] = read(f"{cube}.pano?from={layout}&to=equirectangular&size={WIDTH}x{HEIGHT}")
            with self.subTest(layout=layout):
                difference = angles(directions(results["around"]), rays, PANORAMA_PIXEL)
                self.assert_close(difference, 0.01, 0.2, f"{layout} and back, panorama pixels")
                self.assert_close(difference[inner], 0.01, 0.03, f"{layout} and back off the edges, panorama pixels")
                self.assert_close(np.abs(results["around_waves"][..., :3] - waves(rays)), 1 / 4000, 1 / 1000,
                                  f"{layout} and back, colour")


# ------------------------------------------------------------------------------------------------------------


@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed (Debian package ffmpeg)")
class Ffmpeg(PictureTest):
    """v360's own rounding is some 0.014 source pixels in the median and 0.05 at most; the limits, 0.02 and 0.07,
    leave little more. Colour: 1/4000 of full scale, what the waves change by over 0.035 panorama pixels."""

    MEDIAN, LARGEST, COLOUR = 0.02, 0.07, 1 / 4000

    def v360(self, source, arguments):
        target = self.new_name(".png")
        run("ffmpeg", "-v", "error", "-y", "-i", source, "-vf",
            f"format=gbrp16le,v360={arguments}:interp=linear,format=rgb48be", "-frames:v", "1", target)
        return read(target)

    def compare(self, source, peer, ours, pixel, where=None):
        """Differences in source pixels; fails if they, or those of colour, are over the limits."""
        with self.subTest(peer=peer, ours=ours):
            theirs = self.v360(source + ".tif", peer)
            mine = recipe(source + ".tif", ours)
            where = np.ones(theirs.shape[:2], bool) if where is None else where
            self.assertEqual(theirs.shape[:2], mine.shape[:2])
            difference = angles(directions(theirs), directions(mine), pixel)[where]
            self.assert_close(difference, self.MEDIAN, self.LARGEST, f"v360={peer}, source pixels")
            colour = np.abs(self.v360(source + "_waves.tif", peer)[..., :3]
                            - recipe(source + "_waves.tif", ours)[..., :3])[where]
            self.assert_close(colour, self.COLOUR / 4, self.COLOUR, f"v360={peer}, colour")

    def test_from_panorama(self):
        save_pictures("centers", panorama_rays("centers"))
        cylinder_height = 2 * np.degrees(np.arctan(200 / 314 * np.pi / 2))
        for peer, ours in (
                ("e:c3x2:w=384:h=256", "to=cubemap3x2&size=384x256"),
                # OpenEXR's order and turns of the faces
                ("e:c1x6:w=128:h=768:out_forder=lrudfb:out_frot=002200", "to=cubemap&size=128x768"),
                ("e:flat:h_fov=90:v_fov=90:w=256:h=256", "to=rectilinear&fov=90&size=256"),
                ("e:fisheye:h_fov=180:v_fov=180:w=256:h=256", "to=fisheye&fov=180&size=256"),
                ("e:equisolid:h_fov=180:v_fov=180:w=256:h=256", "to=equisolid&fov=180&size=256"),
                ("e:sg:h_fov=180:v_fov=180:w=256:h=256", "to=stereographic&fov=180&size=256"),
                (f"e:cylindrical:h_fov=180:v_fov={cylinder_height}:w=314:h=200",
                 "to=cylindrical&fov=180&size=314x200"),
                ("e:mercator:w=512:h=512", "to=mercator&size=512x512"),
                ("e:e:yaw=50:pitch=40:roll=30:w=512:h=256", "to=equirectangular&size=512x256&yaw=50&pitch=40&roll=30"),
        ):
            self.compare("centers", peer, ours + "&from=equirectangular&pixels=centers", PANORAMA_PIXEL)

    def test_from_panorama_where_there_is_a_picture(self):
        """ffmpeg goes on beyond the outlines of these, where we have nothing."""
        save_pictures("centers", panorama_rays("centers"))
        for peer, ours in (
                ("e:octahedron:w=256:h=256", "to=octahedral&size=256"),
                ("e:hammer:w=512:h=256", "to=hammer&size=512x256"),
                ("e:sinusoidal:w=512:h=256", "to=sinusoidal&size=512x256"),
                ("e:og:h_fov=180:v_fov=180:w=256:h=256", "to=orthographic&size=256"),
                ("e:dfisheye:h_fov=180:v_fov=180:w=512:h=256", "to=dual_fisheye&size=512x256"),
        ):
            ours += "&from=equirectangular&pixels=centers"
            inside = recipe("centers.tif", ours)[..., :3].any(axis=-1)
            self.assertGreater(inside.mean(), 0.5)
            self.compare("centers", peer, ours, PANORAMA_PIXEL, inside)

    def test_equi_angular_cube(self):
        """v360 leaves a margin of two pixels around the faces of its eac, which is up to 4 pixels of the source each way;
        faces in other places or turns would be off by hundreds."""
        save_pictures("centers", panorama_rays("centers"))
        theirs = directions(self.v360("centers.tif", "e:eac:w=384:h=256"))
        mine = directions(recipe("centers.tif", "to=eac&size=384x256&from=equirectangular&pixels=centers"))
        difference = angles(theirs, mine, PANORAMA_PIXEL)
        self.assert_close(difference, 4, 6, "v360's eac, source pixels")

    def test_equi_angular_films(self):
        """The margin of v360's eac is that of padding=rows:2, also where faces are no whole pixels wide; in the margin its plane goes on
        otherwise. Back again, what it drew is read as its own."""
        save_pictures("centers", panorama_rays("centers"))
        for width, height in ((640, 360), (400, 240), (1280, 720), (384, 256)):
            size = f"{width}x{height}"
            where = np.zeros((height, width), bool)
            for row in (0, height // 2):
                where[row + 2:row + height // 2 - 2, 2:width - 2] = True
            self.compare("centers", f"e:eac:w={width}:h={height}",
                         f"to=eac&size={size}&padding=rows:2&from=equirectangular&pixels=centers", PANORAMA_PIXEL, where)
            film = self.v360("centers.tif", f"e:eac:w={width}:h={height}")
            name = self.new_name(".exr")
            write(name, film)
            view = "&to=equirectangular&size=256x128"
            mine = directions(recipe(name, "from=eac&srcpadding=rows:2" + view))
            rays = unit(*[np.ascontiguousarray(c) for c in np.moveaxis(directions(
                recipe("centers.tif", "from=equirectangular&pixels=centers" + view)), -1, 0)])
            # Where faces meet each program mixes neighbors its own way.
            found = angles(mine, rays, PANORAMA_PIXEL)
            self.assert_close(found, 0.15, 1, f"{size} of v360 back, source pixels")
            wrong = angles(directions(recipe(name, "from=eac" + view)), rays, PANORAMA_PIXEL)
            self.assert_unlike(wrong, 0.2, size + " without its margin")

    def test_orientation(self):
        save_pictures("turned", panorama_rays("centers"))
        v_fov = 2 * np.degrees(np.arctan(0.75))  # 3:4 in the plane, not in degrees
        for orientation in ORIENTATIONS:
            peer = f"e:flat:h_fov=90:v_fov={v_fov}:w=320:h=240:" + "yaw={}:pitch={}:roll={}".format(*orientation)
            ours = "from=equirectangular&pixels=centers&to=rectilinear&fov=90&size=320x240&"
            self.compare("turned", peer, ours + turned(orientation), PANORAMA_PIXEL)
            theirs = directions(self.v360("turned.tif", peer))
            for axis in np.flatnonzero(orientation):
                wrong = [-angle if i == axis else angle for i, angle in enumerate(orientation)]
                flipped = directions(recipe("turned.tif", ours + turned(wrong)))
                self.assert_unlike(angles(theirs, flipped, PANORAMA_PIXEL), 20,
                                   f"{orientation} with one sign flipped")

    def test_pixel_convention_shows(self):
        save_pictures("spaced", panorama_rays("centers"))
        theirs = directions(self.v360("spaced.tif", "e:flat:h_fov=90:v_fov=90:w=256:h=256"))
        edges = directions(recipe("spaced.tif", "to=rectilinear&fov=90&size=256&pixels=edges"))
        self.assert_unlike(angles(theirs, edges, PANORAMA_PIXEL), 0.1, "pixels=edges")

    def test_from_cube(self):
        save_pictures("cube", cube3x2_rays())
        rays = panorama_rays()
        # v360 does not interpolate across the edges of faces; we do.
        where = off_cube_edges(rays, 1)
        ours = f"from=cubemap3x2&to=equirectangular&size={WIDTH}x{HEIGHT}"
        self.compare("cube", f"c3x2:e:w={WIDTH}:h={HEIGHT}", ours, FACE_PIXEL, where)
        # Bilinear interpolation over the kink of an edge costs us a tenth of a pixel there.
        self.assert_close(angles(directions(recipe("cube.tif", ours)), rays, FACE_PIXEL), 0.01, 0.15,
                          "c3x2 by formula, source pixels, edges included")

    def test_from_photo_and_fisheye(self):
        rays = panorama_rays()
        x, y, z = rays[..., 0], rays[..., 1], rays[..., 2]
        # A pixel inside of the edge: what lies beyond it is each program's own affair.
        inner = 1 - 2.5 / 256
        save_pictures("photo", photo_rays(256, 256, 90, "centers"))
        self.compare("photo", f"flat:e:ih_fov=90:iv_fov=90:w={WIDTH}:h={HEIGHT}",
                     f"from=rectilinear&srcfov=90&pixels=centers&to=equirectangular&size={WIDTH}x{HEIGHT}", 2 / 256,
                     (z > 0) & (np.maximum(np.abs(x), np.abs(y)) < z * inner))
        save_pictures("fish", fisheye_rays(256, 180, "centers"))
        self.compare("fish", f"fisheye:e:ih_fov=180:iv_fov=180:w={WIDTH}:h={HEIGHT}",
                     f"from=fisheye&srcfov=180&pixels=centers&to=equirectangular&size={WIDTH}x{HEIGHT}", np.pi / 256,
                     np.arctan2(np.hypot(x, y), z) < np.pi / 2 * inner)


# ------------------------------------------------------------------------------------------------------------


@unittest.skipUnless(shutil.which("nona"), "nona is not installed (Debian package hugin-tools)")
class Nona(PictureTest):
    """nona is as exact as 16 bits, so what may differ is our tolerance of 0.01 source pixels and one step of the
    16 bits: 0.02 for a panorama as the source, 0.025 for a photo, whose pixels are smaller. Seams are no exception;
    half of the pixels are the same to within 0.005. Colour: 1/4000 of full scale, what the waves change by over
    0.035 panorama pixels."""

    PHOTO = (400, 300, 80)  # width, height, field of view
    PHOTO_PIXEL = 2 * np.tan(np.radians(PHOTO[2] / 2)) / PHOTO[0]

    def nona(self, target, source):
        """One image through a project of panorama line `target` and image line `source`; the name of its TIFF."""
        name = self.new_name("")
        with open(name + ".pto", "w") as project:
            project.write(f'p {target} n"TIFF_m c:NONE"\nm i5\ni {source}\n')
        run("nona", "-o", name + "_", name + ".pto")
        result = name + "_0000.tif"
        self.assertTrue(os.path.exists(result), "nona wrote no picture")
        return result

    def panorama_from_photo(self, photo, orientation, lens=""):
        width, height, fov = self.PHOTO
        return self.nona(f"f2 w{WIDTH} h{HEIGHT} v360",
                         'w{} h{} f0 v{} y{} p{} r{} {} n"{}"'.format(width, height, fov, *orientation, lens, photo))

    def view_of_panorama(self, panorama, lens, size, fov, orientation):
        """nona turns the panorama under a fixed camera, so it is told the inverse."""
        return read(self.nona(f"f{lens} w{size[0]} h{size[1]} v{fov}",
                              'w{} h{} f4 v360 y{:.10f} p{:.10f} r{:.10f} n"{}"'.format(
                                  WIDTH, HEIGHT, *inverse_orientation(orientation), panorama)))

    def test_photo_to_panorama_and_back(self):
        """nona puts a photo into a panorama at y, p, r; our view at that yaw, pitch, roll is the photo.

        To 0.05 photo pixels: 16 bits twice, and interpolation in the panorama, whose pixels are 1.5 times a photo's.
        """
        width, height, fov = self.PHOTO
        rays = photo_rays(*self.PHOTO)
        save_pictures("shot", rays)
        inner = (slice(8, -8), slice(8, -8))  # the panorama is transparent beyond the photo
        view = f"from=equirectangular&to=rectilinear&fov={fov}&size={width}x{height}&"
        for orientation in ORIENTATIONS:
            with self.subTest(orientation=orientation):
                panorama = self.panorama_from_photo("shot.tif", orientation)
                back = directions(recipe(panorama, view + turned(orientation)))[inner]
                self.assert_close(angles(back, rays[inner], self.PHOTO_PIXEL), 0.01, 0.05,
                                  f"nona and back {orientation}, photo pixels")
                for axis in np.flatnonzero(orientation):
                    wrong = [-angle if i == axis else angle for i, angle in enumerate(orientation)]
                    flipped = recipe(panorama, view + turned(wrong))[inner]
                    seen = flipped[..., 3] > 0.99
                    difference = angles(directions(flipped), rays[inner], self.PHOTO_PIXEL)[seen]
                    if difference.size:  # else the wrong view looks past the photo
                        self.assert_unlike(difference, 20, f"{orientation} with one sign flipped")
                panorama = self.panorama_from_photo("shot_waves.tif", orientation)
                colour = recipe(panorama, view + turned(orientation))[inner][..., :3]
                self.assert_close(np.abs(colour - waves(rays)[inner]), 1 / 8000, 1 / 2000,
                                  f"nona and back {orientation}, colour")

    def test_photo_to_panorama(self):
        """nona's panorama of a photo is ours at the inverse orientation."""
        save_pictures("camera", photo_rays(*self.PHOTO))
        for orientation in ORIENTATIONS:
            with self.subTest(orientation=orientation):
                theirs = read(self.panorama_from_photo("camera.tif", orientation))
                ours = recipe("camera.tif", f"from=rectilinear&srcfov={self.PHOTO[2]}&to=equirectangular"
                              f"&size={WIDTH}x{HEIGHT}&wrap=black&" + turned(inverse_orientation(orientation)))
                local = panorama_rays() @ rotation(*orientation)
                # Two pixels inside of the photo: what lies beyond its edge is each program's own affair.
                z = local[..., 2] * np.tan(np.radians(self.PHOTO[2] / 2))
                where = ((z > 0) & (np.abs(local[..., 0]) < z * (1 - 4 / 400))
                         & (np.abs(local[..., 1]) < z * (0.75 - 4 / 400)))
                self.assertTrue((theirs[where][:, 3] > 0.99).all(), "nona left a part of the photo out")
                self.assert_close(angles(directions(theirs), directions(ours), self.PHOTO_PIXEL)[where], 0.005, 0.025,
                                  f"photo to panorama {orientation}, photo pixels")

    # Barrel, pincushion with a shifted centre, and a mixture.
    LENSES = [(0, -0.06, 0, 0, 0), (0.01, 0.02, -0.015, 0, 0), (0.02, -0.05, 0.01, 12, -7)]

    def test_lens_of_a_photo(self):
        """nona's a, b, c, d, e and its y, p, r are our srclens and srcyaw, srcpitch, srcroll."""
        save_pictures("lensed", photo_rays(*self.PHOTO))
        for values, orientation in zip(self.LENSES, ORIENTATIONS[1:2] + ORIENTATIONS[4:]):
            with self.subTest(lens=values, orientation=orientation):
                text = dict(zip("abcde", values))
                theirs = read(self.panorama_from_photo("lensed.tif", orientation,
                                                       " ".join(f"{k}{v}" for k, v in text.items())))
                ours = "from=rectilinear&srcfov={}&to=equirectangular&size={}x{}&wrap=black&{}".format(
                    self.PHOTO[2], WIDTH, HEIGHT, "&".join("src" + part for part in turned(orientation).split("&")))
                lens = "&srclens=ptlens:" + ",".join(f"{k}={v}" for k, v in text.items())
                mine = recipe("lensed.tif", ours + lens)
                # Three pixels inside of the photo: what lies beyond its edge is each program's own affair.
                seen = theirs[..., 3] > 0.99
                where = np.all([np.roll(seen, (i, j), (0, 1)) for i in (-3, 0, 3) for j in (-3, 0, 3)], axis=0)
                self.assertGreater(where.sum(), 15000)
                self.assert_close(angles(directions(theirs), directions(mine), self.PHOTO_PIXEL)[where], 0.005, 0.025,
                                  f"ptlens {values}, photo pixels")
                without = angles(directions(theirs), directions(recipe("lensed.tif", ours)), self.PHOTO_PIXEL)[where]
                self.assert_unlike(without, 0.5, "without the lens")

    def test_lens_of_a_picture(self):
        """nona takes the distortion out of a photo, and our lens puts it in again."""
        rays = photo_rays(*self.PHOTO)
        save_pictures("distorted", rays)
        width, height, fov = self.PHOTO
        inner = (slice(12, -12), slice(12, -12))  # the panorama is transparent beyond the photo
        for values, orientation in zip(self.LENSES, ORIENTATIONS[1:2] + ORIENTATIONS[4:]):
            with self.subTest(lens=values, orientation=orientation):
                text = dict(zip("abcde", values))
                panorama = self.panorama_from_photo("distorted.tif", orientation,
                                                    " ".join(f"{k}{v}" for k, v in text.items()))
                back = recipe(panorama, f"from=equirectangular&to=rectilinear&fov={fov}&size={width}x{height}&"
                              + turned(orientation) + "&lens=ptlens:" + ",".join(f"{k}={v}" for k, v in text.items()))
                self.assert_close(angles(directions(back[inner]), rays[inner], self.PHOTO_PIXEL), 0.02, 0.1,
                                  f"nona and back through ptlens {values}, photo pixels")

    def test_panorama_to_views(self):
        """Every lens that both have."""
        save_pictures("sphere", panorama_rays())
        for lens, projection, size, fov in (
                (0, "rectilinear", (400, 300), 80),
                (1, "cylindrical", (400, 300), 180),
                (2, "equirectangular", (512, 256), 360),
                (3, "fisheye", (300, 300), 180),
                (4, "stereographic", (300, 300), 200),
                (5, "mercator", (400, 300), 250),
                (9, "equisolid", (300, 300), 180),
        ):
            for orientation in ORIENTATIONS:
                with self.subTest(projection=projection, orientation=orientation):
                    ours = (f"from=equirectangular&to={projection}&fov={fov}&size={size[0]}x{size[1]}&"
                            + turned(orientation))
                    theirs = self.view_of_panorama("sphere.tif", lens, size, fov, orientation)
                    mine = recipe("sphere.tif", ours)
                    seen = theirs[..., 3] > 0.99
                    self.assertTrue(seen.all(), "nona left a part of the view out")
                    # Between the last row's centres and the pole nona repeats that row; we go on across the pole.
                    rows = np.hypot(directions(mine)[..., 0], directions(mine)[..., 2]) > np.sin(0.52 * PANORAMA_PIXEL)
                    self.assert_close(angles(directions(theirs), directions(mine), PANORAMA_PIXEL)[rows],
                                      0.005, 0.02, f"{projection} {orientation}, source pixels")
                    colour = np.abs(self.view_of_panorama("sphere_waves.tif", lens, size, fov, orientation)[..., :3]
                                    - recipe("sphere_waves.tif", ours)[..., :3])[rows]
                    self.assert_close(colour, 1 / 16000, 1 / 4000, f"{projection} {orientation}, colour")


if __name__ == "__main__":
    unittest.main(verbosity=2)
