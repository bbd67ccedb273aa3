# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A photographer's panorama
# A view and a little planet cut from a panorama, and a photo whose lens bends lines, made straight. Arrays go in and come out; here the panorama is
# computed, yours comes from `imageio`, PIL or OpenCV.

# %%
import anamorph
import numpy as np
import OpenImageIO as oiio


def save(name, pixels):
    image = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float"))
    image.set_pixels(oiio.ROI(), np.float32(pixels))
    assert image.write(name, "uint8"), image.geterror()


# %% [markdown]
# An evening sky over a chequered ground, 2:1, as equirectangular images are.

# %%
longitude, latitude = np.meshgrid(np.linspace(-np.pi, np.pi, 1024), np.linspace(np.pi / 2, -np.pi / 2, 512))
distance = 1 / np.tan(np.clip(-latitude, 1e-3, None))
squares = np.floor(distance * np.sin(longitude)) + np.floor(distance * np.cos(longitude))
ground = np.where(squares % 2 == 0, 0.35, 0.2)
up = np.clip(latitude / (np.pi / 2), 0, 1)
sky = np.stack([0.9 - 0.6 * up, 0.55 - 0.2 * up, 0.35 + 0.3 * up], -1)
panorama = np.float32(np.where((latitude > 0)[..., None], sky, ground[..., None]))

# %% [markdown]
# A camera's view, 100 degrees wide, and everything seen from above.

# %%
view = anamorph.pano(panorama, to="rectilinear", fov=100, yaw=40, pitch=-10, size=(640, 480))
planet = anamorph.pano(panorama, to="stereographic", fov=240, pitch=-90, size=(480, 480))
save("view.png", view)
save("planet.png", planet)

# %% [markdown]
# How far any pixel is from the exact view, proven, in pixels of the panorama:

# %%
picture = anamorph.Picture("pano", panorama, to="rectilinear", fov=100, yaw=40, pitch=-10, size=(640, 480))
bound = picture.reached()["anamorph:max_error"]
print(f"at most {bound:.4f} pixels")

# %% [markdown]
# A wide lens bends what is straight; its coefficients undo that.

# %%
lens = {"lens": "brown:k1=-0.1", "fov": 100}
bent = anamorph.lens(view, mode="distort", **lens)
straight = anamorph.lens(bent, **lens)
save("straight.png", straight)
