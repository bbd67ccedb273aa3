# SPDX-License-Identifier: Apache-2.0
"""scheme=exact of .drape against an independent ray tracer, POV-Ray, where it is installed.

POV-Ray renders its own sphere, torus and open cylinder before the same camera, a ray through the middle of each pixel. Their
colour is the point of the picture: red and green are u and v, formulas of the place in space written below, blue is 1
where the ray meets the body. 16 bits are 1/128 of a texel of a picture of 512 pixels.
"""
import os
import shutil
import subprocess
import unittest

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT, TEXELS = 320, 240, 512
MOST = WIDTH * HEIGHT // 1000  # pixels that may differ by more than a texel: 0.1 %

# u runs around the y axis, from behind; v down.
AROUND = "atan2(x, z) / (2 * pi) + 0.5"
BODIES = {
    "sphere": ("sphere { <0, 0, 0>, 0.5", "acos(min(1, max(-1, 2 * y))) / pi", "angle=360"),
    "torus": ("torus { 0.5, 0.2", "0.5 - atan2(y, sqrt(x * x + z * z) - 0.5) / (2 * pi)", "angle=360"),
    "cylinder": ("cylinder { <0, -0.5, 0>, <0, 0.5, 0>, 0.4 open", "0.5 - y", "angle=360&radius=0.4"),
}
CAMERAS = [((0.9, 0.8, 1.4), (0, 0, 0), 40), ((-0.3, 1.9, 0.6), (0.1, 0, -0.1), 35)]

SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 1 }}
camera {{ perspective location <{eye}> right -x * {width} / {height} up y sky y angle {fov} look_at <{target}> }}
{body}
  pigment {{ average pigment_map {{
    [1 function {{ {u} }} color_map {{ [0 rgb <0, 0, 1>] [1 rgb <2, 0, 1>] }}]
    [1 function {{ {v} }} color_map {{ [0 rgb <0, 0, 1>] [1 rgb <0, 2, 1>] }}] }} }}
  finish {{ ambient 0 diffuse 0 emission 1 }} }}
"""


def read(name):
    picture = oiio.ImageBuf(name)
    pixels = picture.get_pixels("float")
    assert not picture.has_error, picture.geterror()
    return np.asarray(pixels, dtype=float)


def numbers(values):
    return ",".join(str(value) for value in values)


@unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed (Debian package povray)")
class Povray(unittest.TestCase):
    def traced(self, name, camera):
        eye, target, fov = camera
        body, v, _ = BODIES[name]
        # A name each: a cache keeps what was written over within the same second.
        traced = f"traced_{name}_{CAMERAS.index(camera)}.png"
        with open("scene.pov", "w") as scene:
            scene.write(SCENE.format(eye=numbers(eye), target=numbers(target), fov=fov, width=WIDTH, height=HEIGHT,
                                     body=body, u=AROUND, v=v))
        environment = {k: v for k, v in os.environ.items() if k not in ("LD_PRELOAD", "ASAN_OPTIONS")}
        done = subprocess.run(["povray", "+Iscene.pov", f"+O{traced}", f"+W{WIDTH}", f"+H{HEIGHT}", "+FN16",
                               "File_Gamma=1.0", "-A", "-D", "+WT1", "-GA"], env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout)
        return read(traced)

    def ours(self, name, camera):
        eye, target, fov = camera
        return read(f"picture.tif.drape?surface={name}&{BODIES[name][2]}&scheme=exact&output=stmap&size={WIDTH}x{HEIGHT}"
                    f"&camera={numbers(eye)}&target={numbers(target)}&fov={fov}")

    @staticmethod
    def different(theirs, mine):
        """Pixels that only one of both shows, or that differ by more than a texel; and those that both show."""
        they_hit, we_hit = theirs[..., 2] > 0.5, mine[..., 0] >= 0
        across = np.abs(theirs[..., 0] - mine[..., 0])
        across = np.minimum(across, 1 - across)  # both ends of the picture are the same place
        off = TEXELS * np.hypot(across, theirs[..., 1] - mine[..., 1])
        return (they_hit != we_hit) | (they_hit & we_hit & (off > 1)), they_hit & we_hit

    def test_bodies(self):
        picture = oiio.ImageBuf(oiio.ImageSpec(TEXELS, TEXELS, 1, "uint8"))
        self.assertTrue(picture.write("picture.tif"), picture.geterror())
        for name in BODIES:
            for camera in CAMERAS:
                with self.subTest(body=name, camera=camera):
                    theirs, mine = self.traced(name, camera), self.ours(name, camera)
                    different, both = self.different(theirs, mine)
                    print(f"{name}: {different.sum()} of {both.sum()} pixels differ by more than a texel", flush=True)
                    self.assertGreater(both.sum(), WIDTH * HEIGHT // 10)
                    self.assertLessEqual(different.sum(), MOST)
                    # Half a pixel to the side would be seen.
                    self.assertGreater(self.different(theirs[:, 1:], mine[:, :-1])[0].sum(), 20 * MOST)


if __name__ == "__main__":
    unittest.main(verbosity=2)
