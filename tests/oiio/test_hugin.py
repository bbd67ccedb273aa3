# SPDX-License-Identifier: Apache-2.0
"""Projects of Hugin as sources: source points and layers against formulas written out here, and against hugin's nona
where it is installed.

The pixels of a "coordinate picture" are where they lie: red 1/4 + x/1024, green 1/4 + y/1024, in float. Bilinear
interpolation of it has no error, so that a pixel of whatever a program makes of it tells its source point, and only
what is left of nona's tables of colours, 0.0025 pixels at most, is counted as a difference of geometry. (nona's
interpolators of higher order are off by 0.07 pixels on such pictures: they are not used here.)
"""
import math
import os
import random
import shutil
import unittest

import numpy as np
import OpenImageIO as oiio

from test_peers import PictureTest, read, rotation, run

SEED = int(os.environ.get("ANAMORPH_SEED", "38"))
SCALE = 1024
NIGHT = "ANAMORPH_NIGHTLY" in os.environ
at_night = unittest.skipUnless(NIGHT, "takes long")

# ------------------------------------------------------------------------------------------------------------
# PanoTools' formulas: panoramas (p) and images (i) by their numbers f. Units of the plane are radians at the centre.

BY_ANGLE = {  # radius of an angle from the axis, and back
    "linear": (lambda t: t, lambda r: r),
    "stereographic": (lambda t: 2 * np.tan(t / 2), lambda r: 2 * np.arctan(r / 2)),
    "equisolid": (lambda t: 2 * np.sin(t / 2), lambda r: 2 * np.arcsin(r / 2)),
    "orthographic": (lambda t: np.sin(t), lambda r: np.arcsin(r)),
}
PANORAMA_BY_ANGLE = {3: "linear", 4: "stereographic", 9: "equisolid", 14: "orthographic", 15: "equisolid"}
IMAGE_BY_ANGLE = {2: "linear", 3: "linear", 8: "orthographic", 10: "stereographic", 21: "equisolid"}


def panorama_rays(f, width, height, fov):
    """x right, y down, z forward, of every pixel's middle; not finite where there is none."""
    a = math.radians(fov)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    if f == 0:
        s = 2 * math.tan(a / 2) / width
        return np.stack([x * s, y * s, np.ones_like(x)], -1)
    if f in PANORAMA_BY_ANGLE:
        to_radius, to_angle = BY_ANGLE[PANORAMA_BY_ANGLE[f]]
        s = 2 * to_radius(a / 2) / width
        r = np.hypot(x, y)
        with np.errstate(invalid="ignore"):
            t = to_angle(r * s)
        return np.stack([np.sin(t) * x / r, np.sin(t) * y / r, np.cos(t)], -1)
    if f == 21:  # Hammer and Aitoff: the width of half the longitude in Lambert's azimuthal projection, twice
        s = 2 * (2 * math.sqrt(2) * math.sin(a / 4) / math.sqrt(1 + math.cos(a / 4))) / width
        with np.errstate(invalid="ignore"):
            z = np.sqrt(1 - (x * s / 4) ** 2 - (y * s / 2) ** 2)
            longitude, latitude = 2 * np.arctan2(z * x * s, 2 * (2 * z * z - 1)), np.arcsin(z * y * s)
            longitude[2 * z * z < 1] = np.nan
    else:
        longitude, latitude = x * a / width, y * a / width
        if f == 1:
            latitude = np.arctan(latitude)
        elif f == 5:
            latitude = 2 * np.arctan(np.exp(latitude)) - math.pi / 2
        elif f == 7:
            longitude = longitude / np.cos(latitude)
        outside = (np.abs(longitude) > math.pi) | (np.abs(latitude) > math.pi / 2)
        longitude[outside] = np.nan
    return np.stack([np.sin(longitude) * np.cos(latitude), np.sin(latitude), np.cos(longitude) * np.cos(latitude)], -1)


def fold(image):
    """Where the radius of a lens no longer rises: beyond, the picture would be seen again, mirrored."""
    a, b, c = image["a"], image["b"], image["c"]
    roots = np.roots([4 * a, 3 * b, 2 * c, 1 - a - b - c])
    return min([root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0], default=math.inf)


def moves(image):
    return any(image[key] for key in ("TrX", "TrY", "TrZ"))


def seen_from_elsewhere(rays, image):
    """Rays from a camera elsewhere to what the panorama's sees on a plane 1 away, none where it sees none, and how far these look
    toward the plane. TrZ counts backward."""
    n, place = rotation(image["Tpy"], image["Tpp"], 0) @ (0, 0, 1), np.array((image["TrX"], image["TrY"], -image["TrZ"]))
    along = rays @ n
    with np.errstate(all="ignore"):
        seen = rays / along[..., None] - place
        toward = (rays - along[..., None] * place) @ n * np.sign(1 - n @ place)
        toward /= np.linalg.norm(rays - along[..., None] * place, axis=-1)
    seen[along <= 0] = np.nan
    return seen, toward


def far_from_horizon(rays, image):
    """Is it farther than a few pixels to where an image looks past its plane?"""
    return np.abs(seen_from_elsewhere(rays, image)[1]) > 0.05 if moves(image) else np.ones(rays.shape[:-1], bool)


def image_points(rays, image):
    """The source points of rays of the panorama, in pixels of an image; not finite where there is none."""
    q = (seen_from_elsewhere(rays, image)[0] if moves(image) else rays) @ rotation(image["y"], image["p"], image["r"])
    x, y, z = q[..., 0], q[..., 1], q[..., 2]
    a, width, height = math.radians(image["v"]), image["w"], image["h"]
    with np.errstate(all="ignore"):
        if image["f"] == 0:
            s = width / (2 * math.tan(a / 2))
            u, v = s * x / z, s * y / z
            u[z <= 0] = np.nan
        elif image["f"] in (1, 4):
            s, across = width / a, np.hypot(x, z)
            u = s * np.arctan2(x, z)
            v = s * (y / across if image["f"] == 1 else np.arctan2(y, across))
        else:
            to_radius = BY_ANGLE[IMAGE_BY_ANGLE[image["f"]]][0]
            across = np.hypot(x, y)
            r = width / 2 / to_radius(a / 2) * to_radius(np.arctan2(across, z)) / across
            u, v = x * r, y * r
            if image["f"] == 8:
                u[z <= 0] = np.nan
        r = np.hypot(u, v) / (min(width, height) / 2)
        u[r >= fold(image)] = np.nan
        k = image["a"] * r**3 + image["b"] * r**2 + image["c"] * r + 1 - image["a"] - image["b"] - image["c"]
        u, v = u * k + image["d"], v * k + image["e"]
        return u + image["g"] / height * v + width / 2, v + image["t"] / width * u + height / 2


def shown(image, x, y, margin=0.0):
    """Is a source point inside of the image and of its crop, by so many pixels?"""
    left, right, top, bottom = image.get("S") or (0, image["w"], 0, image["h"])
    left, right, top, bottom = max(left, 0), min(right, image["w"]), max(top, 0), min(bottom, image["h"])
    with np.errstate(invalid="ignore"):
        inside = (x > left + margin) & (x < right - margin) & (y > top + margin) & (y < bottom - margin)
        if image.get("S") and image["f"] in (2, 8):
            left, right, top, bottom = image["S"]
            inside &= np.hypot(x - (left + right) / 2, y - (top + bottom) / 2) < min(right - left, bottom - top) / 2 - margin
    return inside


# ------------------------------------------------------------------------------------------------------------


PLACE = ("TrX", "TrY", "TrZ", "Tpy", "Tpp")


def image(name, f, width, height, fov, y=0.0, p=0.0, r=0.0, lens=(0.0,) * 5, crop=None, links=None, shear=(0.0, 0.0),
          place=(0.0,) * 5):
    made = dict(zip("abcde", lens), n=name, f=f, w=width, h=height, v=fov, y=y, p=p, r=r, S=crop, g=shear[0], t=shear[1])
    made.update(zip(PLACE, place))
    made["links"] = links or {}
    return made


def row(made):
    text = "i" + "".join(f" {key}{made['links'].get(key, made[key])!s}" for key in [*"whfvabcdegtypr", *PLACE])
    text += " Ra0 Rb0 Rc0 Rd0 Re0 Eev0 Er1 Eb1 j0 Va1 Vb0 Vc0 Vd0 Vx0 Vy0 Vm5"
    if made["S"]:
        text += " S" + ",".join(map(str, made["S"]))
    return text + f' n"{made["n"]}"\n'


def new_name(suffix):
    """A name that was not read before: hosts keep pictures by their names."""
    PictureTest.jobs += 1
    return f"project{PictureTest.jobs}{suffix}"


def write_project(panorama, images, more="", crop=""):
    """The name of a new project."""
    f, width, height, fov = panorama
    name = new_name(".pto")
    with open(name, "w") as project:
        project.write("# hugin project file\n#hugin_ptoversion 2\n"
                      f'p f{f} w{width} h{height} v{fov} E0 R0 {crop} n"TIFF_m c:NONE"\nm i5\n\n')
        project.writelines(row(made) for made in images)
        project.write("\n" + more + "\n# control points\nv\n")
    return name


def write_coordinates(width, height, blue=0.5, alpha=None):
    """The name of a new coordinate picture."""
    name = new_name(".tif")
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    channels = [0.25 + x / SCALE, 0.25 + y / SCALE, np.full_like(x, blue)] + ([] if alpha is None else [alpha])
    if alpha is not None:
        channels[:3] = [channel * alpha for channel in channels[:3]]
    pixels = np.ascontiguousarray(np.stack(channels, -1).astype(np.float32))
    picture = oiio.ImageBuf(oiio.ImageSpec(width, height, len(channels), "float"))
    assert picture.set_pixels(oiio.ROI(), pixels) and picture.write(name), picture.geterror()
    return name


def points(pixels):
    return (pixels[..., 0] - 0.25) * SCALE, (pixels[..., 1] - 0.25) * SCALE


def distance(pixels, x, y):
    px, py = points(pixels)
    return np.hypot(px - x, py - y)


def ours(project, *arguments):
    """Our picture, with alpha."""
    keys = {"filter": "bilinear", "alpha": "1", "tol": "1e-5"} | dict(argument.split("=") for argument in arguments)
    return read(f"{project}.pano?" + "&".join(f"{key}={value}" for key, value in keys.items()))


def random_images(rng, name):
    """An image of each of PanoTools' projections, turned and through a lens."""
    for f, least, most in ((0, 30, 110), (1, 60, 300), (2, 90, 200), (3, 90, 330), (4, 60, 360), (8, 60, 170),
                           (10, 60, 250), (21, 60, 250)):
        lens = [rng.uniform(-0.02, 0.02), rng.uniform(-0.04, 0.04), rng.uniform(-0.02, 0.02), rng.uniform(-9, 9),
                rng.uniform(-9, 9)]
        # Whole turns have no lens here.
        most = 355 if f == 4 else most
        yield image(name, f, 400, 300, round(rng.uniform(least, most), 3), rng.uniform(-180, 180),
                    rng.uniform(-90, 90), rng.uniform(-180, 180), lens)


def moved_images(rng, name):
    """Images with shear, and of cameras that stand elsewhere; some look past the plane that they see."""
    for f, least, most in ((0, 30, 110), (3, 90, 200), (10, 60, 150), (1, 60, 200), (4, 60, 200)):
        lens = [rng.uniform(-0.01, 0.01) for _ in "abc"] + [rng.uniform(-9, 9), rng.uniform(-9, 9)]
        yield image(name, f, 400, 300, rng.uniform(least, most), rng.uniform(-30, 30), rng.uniform(-30, 30),
                    rng.uniform(-180, 180), lens, shear=(rng.uniform(-20, 20), rng.uniform(-20, 20)))
        near, far = ([rng.uniform(-size, size) for _ in "xyz"] for size in (0.3, 1.5))
        plane = [rng.uniform(-50, 50), rng.uniform(-30, 30)]
        for place in (near + [0, 0], near + plane, far + plane):
            yield image(name, f, 400, 300, rng.uniform(least, most), rng.uniform(-40, 40), rng.uniform(-40, 40),
                        rng.uniform(-180, 180), lens, shear=(rng.uniform(-9, 9), 0), place=place)


PANORAMAS = [(0, 400, 300, 110), (1, 500, 300, 200), (2, 512, 256, 360), (2, 300, 200, 150.5), (3, 300, 260, 210),
             (4, 300, 300, 220), (5, 400, 300, 250), (7, 512, 256, 360), (9, 300, 300, 250), (14, 300, 300, 180),
             (15, 300, 280, 250), (21, 512, 256, 360)]


class Source(PictureTest):
    """Source points of one image by formulas, at a tolerance of 1e-5 pixels; floats of the picture hold 1/16000 of one."""

    def setUp(self):
        self.at = write_coordinates(400, 300)

    def check(self, made, panorama, what):
        pixels = ours(write_project(panorama, [made]), "image=0")
        rays = panorama_rays(*panorama)
        x, y = image_points(rays, made)
        clear = far_from_horizon(rays, made)
        inside = shown(made, x, y, 1.5) & clear
        found = distance(pixels, x, y)[inside]
        if found.size:
            self.assertLess(found.max(), 4e-4, what)
            self.assertGreater(pixels[..., 3][inside].min(), 0.9999, what)
        # What lies beyond is not drawn.
        beyond = ~shown(made, x, y, -1.5) & clear
        if beyond.any():
            self.assertEqual(pixels[beyond].max(), 0, what)
        return found.size

    def test_every_projection(self):
        rng = random.Random(SEED)
        print("seed", SEED)
        compared = sum(self.check(made, panorama, f"seed {SEED}: {row(made)} in {panorama}")
                       for panorama in PANORAMAS for made in random_images(rng, self.at))
        self.assertGreater(compared, 500000)

    def test_shear_and_cameras_elsewhere(self):
        rng = random.Random(SEED + 2)
        print("seed", SEED)
        compared = sum(self.check(made, panorama, f"seed {SEED}: {row(made)} in {panorama}")
                       for panorama in PANORAMAS[::1 if NIGHT else 3] for made in moved_images(rng, self.at))
        self.assertGreater(compared, 500000 if NIGHT else 150000)

    def test_images_that_look_past_their_plane_have_no_stmap(self):
        ahead, past = (write_project(PANORAMAS[2], [image(self.at, 0, 400, 300, 60, y, place=(0.2, 0, 0, 0, 0))]) for y in (0, 70))
        self.assertGreater(np.isfinite(read(ahead + ".pano?image=0&output=stmap")[..., 0]).sum(), 1000)
        with self.assertRaisesRegex(Exception, "looks away from its plane"):
            read(past + ".pano?image=0&output=stmap")

    def test_upright_image(self):
        lens = (0.01, -0.03, 0.02, 5, -7)
        self.assertGreater(self.check(image(write_coordinates(300, 400), 0, 300, 400, 60, 20, 10, 5, lens), PANORAMAS[2], "upright"), 2000)

    def test_crops(self):
        for f in (0, 2, 3, 8, 21):
            for crop in ((60, 341, 10, 290), (-30, 271, 20, 321)):
                made = image(self.at, f, 400, 300, 100, 30, 20, 10, crop=crop)
                self.assertGreater(self.check(made, PANORAMAS[2], f"f{f} S{crop}"), 1000)

    def test_links_and_view(self):
        """Image 1 has the lens of image 0; the recipe's view is drawn as of any source."""
        first = image(self.at, 3, 400, 300, 140, 40, 0, 0, (0.01, -0.02, 0, 3, -4))
        second = dict(first, y=-20, links={key: "=0" for key in "fvabcde"})
        project = write_project(PANORAMAS[2], [first, second])
        pixels = ours(project, "image=1", "to=rectilinear", "fov=70", "size=300x200", "yaw=-20")
        x, y = image_points(panorama_rays(0, 300, 200, 70) @ rotation(-20, 0, 0).T, second)
        inside = shown(second, x, y, 1)
        self.assertGreater(inside.sum(), 50000)
        self.assertLess(distance(pixels, x, y)[inside].max(), 4e-4)
        # It is the picture that the same keys make of the image alone.
        alone = read(self.at + ".pano?filter=bilinear&alpha=1&tol=1e-5&from=fisheye&srcfov=140&srcyaw=-20&to=rectilinear&fov=70"
                     "&size=300x200&yaw=-20&srclens=ptlens:a=0.01,b=-0.02,d=3,e=-4")
        self.assertEqual(np.abs(pixels - alone).max(), 0)

    def test_crop_of_the_panorama_is_a_data_window(self):
        made = image(self.at, 0, 400, 300, 80, 10, 5)
        whole, cut = write_project(PANORAMAS[2], [made]), write_project(PANORAMAS[2], [made], crop="S200,330,60,190")
        spec = oiio.ImageBuf(cut + ".pano").spec()
        self.assertEqual((spec.x, spec.y, spec.width, spec.height), (200, 60, 130, 130))
        self.assertEqual((spec.full_x, spec.full_y, spec.full_width, spec.full_height), (0, 0, 512, 256))
        self.assertEqual(np.abs(read(cut + ".pano") - read(whole + ".pano")[60:190, 200:330]).max(), 0)
        # A project is drawn as it stands.
        self.assertEqual(np.abs(read(cut) - read(cut + ".pano")).max(), 0)


class Layers(PictureTest):
    """All images: each pixel is a mean of source points, by weights written out here."""

    PANORAMA = (2, 512, 256, 360)

    def project(self, crops=(None, None, None), alphas=(None, None, None), more="", kinds=((0, 80), (3, 130), (0, 70))):
        images = []
        for i, ((f, fov), (y, p, r)) in enumerate(zip(kinds, ((-20, 5, 3), (15, -10, -20), (40, 0, 0)))):
            name = write_coordinates(400, 300, 0.3 + 0.2 * i, alphas[i])
            images.append(image(name, f, 400, 300, fov, y, p, r, crop=crops[i]))
        return write_project(self.PANORAMA, images, more), images

    def places(self, images):
        rays = panorama_rays(*self.PANORAMA)
        return [image_points(rays, made) for made in images]

    def test_later_images_cover_those_before(self):
        for crops in ((None, None, None), ((10, 390, 20, 280), (50, 350, 0, 300), (-5, 222, 100, 290))):
            project, images = self.project(crops)
            pixels = ours(project)
            places = self.places(images)
            inside = [shown(made, x, y, 1) for made, (x, y) in zip(images, places)]
            out = [~shown(made, x, y, -1) for made, (x, y) in zip(images, places)]
            seen = 0
            for i, (x, y) in enumerate(places):
                above = np.all(out[i + 1:], axis=0) if i + 1 < len(images) else np.ones_like(inside[i])
                here = inside[i] & above
                seen += here.sum()
                self.assertLess(distance(pixels, x, y)[here].max(), 4e-4)
                self.assertLess(np.abs(pixels[..., 2][here] - (0.3 + 0.2 * i)).max(), 1e-6)
            self.assertGreater(seen, 20000)
            self.assertEqual(pixels[np.all(out, axis=0)].max(), 0)
            # Where an image is covered all is, whoever shows.
            self.assertGreater(pixels[..., 3][np.any(inside, axis=0)].min(), 0.9999)

    def edge_distance(self, made, x, y):
        """The distance from the edges of an image and of its crop, and that of their middle. A cylinder of 360 degrees has no sides."""
        left, right, top, bottom = made["S"] or (0, made["w"], 0, made["h"])
        circle = []
        if made["S"] and made["f"] == 2:
            circle = [min(right - left, bottom - top) / 2 - np.hypot(x - (left + right) / 2, y - (top + bottom) / 2)]
        left, right, top, bottom = max(left, 0), min(right, made["w"]), max(top, 0), min(bottom, made["h"])
        if made["f"] == 1 and made["v"] == 360:
            return np.minimum(y - top, bottom - y), (bottom - top) / 2
        return np.minimum.reduce(circle + [x - left, right - x, y - top, bottom - y]), min(right - left, bottom - top) / 2

    def test_blend_and_feather(self):
        self.check_weights(self.project((None, (20, 380, 10, 290), None)))
        # A circle that the image cuts, and an image that goes all around.
        self.check_weights(self.project((None, (-20, 380, -60, 340), None), kinds=((0, 80), (2, 130), (1, 360))))

    def check_weights(self, made_project):
        project, images = made_project
        places = self.places(images)
        # At the rim of a circle one of four texels may be cut that lies 1.42 pixels away, and beside straight edges 1.
        near = 1.5 if any(made["f"] == 2 for made in images) else 1
        clear = np.all([shown(made, x, y, near) | ~shown(made, x, y, -near) for made, (x, y) in zip(images, places)], axis=0)
        for layers, feather in (("blend", None), ("blend", 30), ("blend", 0), ("order", 40)):
            total, sums, through = 0.0, 0.0, 1.0
            for made, (x, y) in reversed(list(zip(images, places))):
                far, middle = self.edge_distance(made, x, y)
                width = feather if feather is not None else middle
                with np.errstate(invalid="ignore"):
                    weight = np.clip(far / width, 2.0**-20, 1) if width else np.ones_like(far)
                weight = np.where(shown(made, x, y), weight, 0)
                if layers == "order":
                    weight, through = weight * through, through * (1 - weight)
                values = np.stack([0.25 + x / SCALE, 0.25 + y / SCALE,
                                   np.full_like(x, 0.3 + 0.2 * images.index(made))], -1)
                total = total + weight
                sums = sums + np.where(weight[..., None] > 0, values * weight[..., None], 0)
            where = clear & (total > 0)
            self.assertGreater(where.sum(), 20000)
            pixels = ours(project, f"layers={layers}", *([] if feather is None else [f"feather={feather}"]))
            expected = sums[where] / total[where][..., None]
            self.assertLess(np.abs(pixels[where][..., :3] - expected).max(), 3e-6, f"{layers} {feather}")
            self.assertGreater(pixels[..., 3][where].min(), 0.9999)

    def test_weights_are_of_the_pixel_whatever_is_drawn_beside_it(self):
        """Faces of a layout are those that are drawn alone, and what overscan adds moves nothing."""
        project, _ = self.project()
        for keys, face, row, column in (("layers=blend", "front", 64, 64), ("layers=blend", "right", 0, 0), ("image=0", "front", 64, 64)):
            whole = ours(project, keys, "to=cubemap3x2", "size=192")
            alone = ours(project, keys, "to=cubemap3x2", "size=64", f"face={face}")
            self.assertGreater((alone[..., 3] > 0).sum(), 300, face)
            self.assertLess(np.abs(whole[row:row + 64, column:column + 64] - alone).max(), 1e-4, face)
        view = ("layers=blend", "to=rectilinear", "fov=70", "size=60x40")
        self.assertLess(np.abs(ours(project, *view, "overscan=9x5")[5:-5, 9:-9] - ours(project, *view)).max(), 1e-4)

    def test_images_of_one_file_are_cut_each_by_its_own(self):
        name = write_coordinates(400, 300)
        made = [image(name, 0, 400, 300, 80, crop=crop) for crop in ((0, 200, 0, 300), (200, 400, 0, 300))]
        project = write_project(self.PANORAMA, made)
        for number in (0, 1, 0):
            pixels = ours(project, f"image={number}")
            there = pixels[..., 3] > 0.999
            self.assertGreater(there.sum(), 1000)
            self.assertTrue(((points(pixels)[0][there] < 200) == (number == 0)).all(), number)

    def test_alpha_and_masks_show_what_is_below(self):
        hole = np.ones((300, 400))
        hole[100:200, 150:250] = 0
        project, images = self.project(alphas=(np.ones_like(hole), np.ones_like(hole), hole),
                                       more='k i1 t0 p"30 40 200 40 200 260 30 260"\n')
        pixels = read(project + ".pano?filter=bilinear&tol=1e-5")
        places = self.places(images)

        def states(made, i, x, y):
            inside, out = shown(made, x, y, 1), ~shown(made, x, y, -1)
            rectangle = {1: (30, 200, 40, 260), 2: (150, 250, 100, 200)}.get(i)
            if rectangle:
                left, right, top, bottom = rectangle
                in_hole = (x > left + 1) & (x < right - 1) & (y > top + 1) & (y < bottom - 1)
                near = (x > left - 1) & (x < right + 1) & (y > top - 1) & (y < bottom + 1)
                inside, out = inside & ~near, out | in_hole
            return inside, out

        with np.errstate(invalid="ignore"):
            known = [states(made, i, x, y) for i, (made, (x, y)) in enumerate(zip(images, places))]
        for i, (x, y) in enumerate(places):
            here = known[i][0]
            for _, out in known[i + 1:]:
                here = here & out
            self.assertGreater(here.sum(), 1000)
            self.assertLess(distance(pixels, x, y)[here].max(), 4e-4)
        self.assertEqual(pixels[np.all([out for _, out in known], axis=0)].max(), 0)
        # output=coverage is the alpha.
        self.assertLess(np.abs(read(project + ".pano?filter=bilinear&tol=1e-5&output=coverage")[..., 0] - pixels[..., 3]).max(), 1e-6)

    def test_bounds_are_the_largest(self):
        project, _ = self.project()
        largest = 0.0
        for i in range(3):
            largest = max(largest, oiio.ImageBuf(f"{project}.pano?image={i}").spec().get_float_attribute("anamorph:max_error"))
        spec = oiio.ImageBuf(project + ".pano").spec()
        self.assertAlmostEqual(spec.get_float_attribute("anamorph:max_error"), largest, delta=1e-9)
        self.assertLessEqual(largest, 0.01)
        errors, bounds = read(project + ".pano?output=error"), read(project + ".pano?output=bound")
        self.assertTrue((errors <= bounds).all())


@unittest.skipUnless(shutil.which("nona"), "nona is not installed (Debian package hugin-tools)")
class Nona(PictureTest):
    """Source points of one image, pixel by pixel: at most 0.003 pixels apart."""

    LARGEST = 0.003

    def setUp(self):
        self.at = write_coordinates(400, 300)

    def nona(self, panorama, made, more="", crop=""):
        """What nona draws, whole, and the project."""
        project = write_project(panorama, [made], more, crop)
        name = project[:-4]
        run("nona", "-o", name + "_", project)
        whole = np.zeros((panorama[2], panorama[1], 4))
        if not os.path.exists(name + "_0000.tif"):
            return whole, project  # nothing is seen
        # What libtiff has to say against nona's files, OpenImageIO 2.4 would say of the next file that this process reads.
        run("oiiotool", name + "_0000.tif", "-o", name + ".exr")
        spec = oiio.ImageBuf(name + ".exr").spec()
        whole[spec.y:spec.y + spec.height, spec.x:spec.x + spec.width] = read(name + ".exr")
        return whole, project

    def check(self, made, panorama):
        """The number of pixels compared, and the largest distance."""
        theirs, project = self.nona(panorama, made)
        mine = ours(project, "image=0")
        rays = panorama_rays(*panorama)
        x, y = image_points(rays, made)
        clear = far_from_horizon(rays, made)
        # Two pixels inside: what lies at the edge is each program's own affair.
        inside = shown(made, x, y, 2) & clear
        # Some pixels nona leaves out where its picture comes back to itself.
        seen = theirs[..., 3] > 0.99
        self.assertLessEqual((inside & ~seen).sum(), 0.01 * inside.sum(), f"nona left a part out: {row(made)}")
        inside &= seen
        found = distance(theirs, *points(mine))[inside]
        beyond = ~shown(made, x, y, -2) & clear
        self.assertEqual(theirs[..., 3][beyond].max() if beyond.any() else 0, 0, row(made))
        return found.size, found.max() if found.size else 0.0

    @at_night
    def test_every_projection(self):
        rng = random.Random(SEED + 1)
        largest, pixels = 0.0, 0
        for i, panorama in enumerate(PANORAMAS):
            of_panorama = 0.0
            # Each projection of images in every third panorama.
            for made in list(random_images(rng, self.at))[i % 3::3]:
                with self.subTest(seed=SEED, panorama=panorama, image=row(made)):
                    count, found = self.check(made, panorama)
                    pixels, of_panorama = pixels + count, max(of_panorama, found)
                    self.assertLess(found, self.LARGEST)
            print(f"nona p f{panorama[0]}: largest distance {of_panorama:.2g} source pixels", flush=True)
            largest = max(largest, of_panorama)
        print(f"seed {SEED}: {pixels} pixels, largest distance {largest:.2g} source pixels", flush=True)
        self.assertGreater(pixels, 500000)

    @at_night
    def test_shear_and_cameras_elsewhere(self):
        rng = random.Random(SEED + 3)
        largest, pixels = 0.0, 0
        for panorama in PANORAMAS[::3]:
            for made in moved_images(rng, self.at):
                # nona 2021 fails where it finds no part of an image.
                if not shown(made, *image_points(panorama_rays(*panorama), made), 2).any():
                    continue
                with self.subTest(seed=SEED, panorama=panorama, image=row(made)):
                    count, found = self.check(made, panorama)
                    pixels, largest = pixels + count, max(largest, found)
                    self.assertLess(found, self.LARGEST)
        print(f"seed {SEED}: {pixels} pixels, largest distance {largest:.2g} source pixels", flush=True)
        self.assertGreater(pixels, 100000)

    def test_shifts_of_cylinders_and_panoramas(self):
        for f, fov in ((1, 140), (4, 100), (4, 360)):
            for d, e in ((25.5, 0), (0, -17), (-60, 31.25)):
                with self.subTest(f=f, fov=fov, d=d, e=e):
                    made = image(self.at, f, 400, 300 if fov < 360 else 200, fov, 20, -10, 15)
                    made["n"] = self.at if fov < 360 else write_coordinates(400, 200)
                    made["d"], made["e"] = d, e
                    theirs, project = self.nona((0, 300, 220, 90), made)
                    mine = ours(project, "image=0")
                    # Where alpha is less, black is mixed in.
                    seen = (theirs[..., 3] > 0.99) & (mine[..., 3] > 0.99999)
                    self.assertGreater(seen.sum(), 20000)
                    x, y = points(mine)
                    # Beside the seam each program mixes both ends.
                    inside = seen & (x > 2) & (x < 398) & (y > 2) & (y < made["h"] - 2)
                    self.assertLess(distance(theirs, x, y)[inside].max(), self.LARGEST)

    @at_night
    def test_general_pannini(self):
        """By its compression, of which 100 is the default; against nona alone, whose numbers are these."""
        made = image(self.at, 0, 400, 300, 80, 12, 7, 5)
        for compression in (None, 0, 40, 100, 125, 148):
            for fov in (70, 150):
                with self.subTest(compression=compression, fov=fov):
                    written = "" if compression is None else f'P"{compression} 0 0"'
                    theirs, project = self.nona((19, 360, 240, fov), made, crop=written)
                    mine = ours(project, "image=0")
                    # Where alpha is less, black is mixed in.
                    seen = (theirs[..., 3] > 0.99) & (mine[..., 3] > 0.99999)
                    self.assertGreater(seen.sum(), 5000)
                    # Their pictures end alike, within a pixel on either side.
                    self.assertLess(((theirs[..., 3] > 0.99) != (mine[..., 3] > 0.99)).sum(), 1500)
                    x, y = points(mine)
                    inside = seen & (x > 2) & (x < 398) & (y > 2) & (y < 298)
                    self.assertLess(distance(theirs, x, y)[inside].max(), self.LARGEST)

    def test_crops(self):
        for f in (0, 1, 2, 3, 8, 10, 21):
            made = image(self.at, f, 400, 300, 110, 30, 20, 10, crop=(60, 341, 10, 270))
            with self.subTest(f=f):
                count, found = self.check(made, PANORAMAS[2])
                self.assertGreater(count, 1000)
                self.assertLess(found, self.LARGEST)

    def test_masks(self):
        made = image(self.at, 0, 400, 300, 80, 20, 10)
        more = 'k i0 t0 p"100 90 310 100 205 240 120.5 150"\n'
        theirs, project = self.nona(PANORAMAS[2], made, more)
        theirs, mine = theirs[..., 3] > 0.5, ours(project, "filter=nearest")[..., 3] > 0.5
        self.assertGreater((~theirs & shown(made, *image_points(panorama_rays(*PANORAMAS[2]), made), 2)).sum(), 1000)
        # A pixel of the panorama is 1.5 of the image's: they differ along outlines alone.
        self.assertLess((theirs != mine).sum(), 120)


if __name__ == "__main__":
    unittest.main(verbosity=2)
