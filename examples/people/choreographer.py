# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A choreographer's figure
# A phrase for a figure of four ellipsoids, the paths of its limbs as arrays, and its outlines as lines.

# %%
import anamorph
import numpy as np

PHRASE = """* A doll that bows and waves.
figure doll 4 body head left right
ellipsoid body  130 190  90
ellipsoid head   85 100  85
ellipsoid left   45 150  45
ellipsoid right  45 150  45
joint neck   body    0 175 0   head   0 -90 0
joint lshldr body -120 130 0   left   0 140 0
joint rshldr body  120 130 0   right  0 140 0
view 0 24
repeat 0 1 moveto doll body 500 420 500
quadratic 0 12 bendby body neck world 25 x
quadratic 12 24 bendby body neck world -25 x
linear 0 24 bendby right rshldr body 150 z
stop
"""
motion = anamorph.figures.perform(PHRASE)
frames = list(motion)
print(f"{len(frames)} frames of {frames[0].names}")

# %% [markdown]
# Where the middle of each limb is, frame by frame: an array (frames, bodies, 3), from which speeds follow.

# %%
paths = np.stack([frame.centers for frame in frames])
speeds = np.linalg.norm(np.diff(paths, axis=0), axis=-1) * motion.rate
fastest = frames[0].names[int(speeds.max(0).argmax())]
print(f"the fastest limb is the {fastest}, at {speeds.max():.0f} units a second")

# %% [markdown]
# A moment as outlines, hidden lines removed: polylines for a plotter, or for this drawing.

# %%
lines = frames[len(frames) // 2].outlines((480, 480))
paths_of_svg = "".join('<polyline points="' + " ".join(f"{x:.2f},{y:.2f}" for x, y in line.points) + '" fill="none" stroke="black"/>' for line in lines)
with open("phrase.svg", "w", encoding="utf-8") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 480 480">{paths_of_svg}</svg>')

# %% [markdown]
# Shaded, as a picture: the script is a file, whose name is the recipe.

# %%
with open("phrase.nudes", "w", encoding="utf-8") as file:
    file.write(PHRASE)
shaded = anamorph.figure(script="phrase.nudes", frame=12, size=(480, 480))
print(shaded.shape)
