# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A compositor's plate
# The lens taken off a plate and put on again, ST-maps both ways for other programs, and three operations by one resampling.

# %%
import anamorph
import numpy as np

x, y = np.meshgrid(np.arange(960) + 0.5, np.arange(540) + 0.5)
plate = np.float32(np.stack([0.5 + 0.5 * np.sin(x / 25), 0.5 + 0.5 * np.sin(y / 25), x / 960], -1))

# %% [markdown]
# The map of a lens of 3DE4: what it does to points, without pixels.

# %%
lens = anamorph.Map("lens", (960, 540), lens="3de4:k1=0.04", fov=60)
u, v = lens.points(12.5, 20.5)
print(f"the pixel (12.5, 20.5) comes from ({u:.3f}, {v:.3f})")

# %% [markdown]
# ST-maps: to take it off, and, from the inverse, to put it on again. For Nuke v goes up: `1 - stmap[..., 1]`.

# %%
off = lens.to_stmap()
on = lens.inverse().to_stmap()
flat = anamorph.warp(plate, mesh=off)
again = anamorph.warp(flat, mesh=on)
middle = np.s_[100:-100, 100:-100]
print(f"there and back: {np.abs(again - plate)[middle].max():.4f} of full white")

# %% [markdown]
# Undistorted, turned and bulged: joined into one map, sampled once.

# %%
grid = np.stack(np.meshgrid(np.linspace(0, 960, 4), np.linspace(0, 540, 4)), -1)
grid[1:3, 1:3] += [[[9, 4], [-5, 6]], [[7, -8], [-3, -6]]]
mesh = {"columns": 3, "rows": 3, "vertices": grid.reshape(-1, 2)}
undistorted = anamorph.Picture("lens", plate, lens="3de4:k1=0.04", fov=60)
turned = anamorph.Picture("pano", undistorted, from_="rectilinear", srcfov=60, to="rectilinear", fov=50, yaw=4, size=(960, 540))
joined = anamorph.Picture("warp", turned, mesh=mesh)
print(joined.said["anamorph:chain"], joined.reached()["anamorph:max_error"])
comp = joined.draw()
