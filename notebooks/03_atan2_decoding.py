# ---
# jupyter:
#   jupytext:
#     cell_metadata_filter: tags,-all
#     formats: ipynb,py:percent
#     notebook_metadata_filter: -jupytext.text_representation.jupytext_version
#     text_representation:
#       extension: .py
#       format_name: percent
#       format_version: '1.3'
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown] tags=["badge"]
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/03_atan2_decoding.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # Which way is the block pointing?
#
# Our dataset does not store the angle of the block. It stores the sine and the cosine of it, and you have to put the
# two together again. One function does that. It takes two arguments, and if you pass them in the wrong order, nothing
# complains. This page shows how to do it right, and what it looks like when somebody did not.
#
# **By the end you can**
#
# - **explain** why one angle is stored as two numbers;
# - **decode** a yaw with `atan2(sin, cos)`, and say why neither half is enough;
# - **compare** two yaws across the jump at 180°;
# - **recognise** swapped arguments by what they do to the block.
#
# 15 minutes. You need nothing but this page, and a little school trigonometry.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
import math

import numpy as np

import z2r
from z2r.course import figures
from z2r.course.exercises import angles as practice
from z2r.course.source import show_source

# %% [markdown]
# ## The two columns
#
# The data holds six recordings of a robot, called *episodes*. In each, a round *pusher* shoves a block in the shape
# of a T over a table and onto a target. Every tenth of a second is one *frame*, a row of the table. In each frame the
# robot's *observation* is ten numbers, and the dataset gives each a name.

# %%
dataset = z2r.load(z2r.STANDIN)
state = dataset.read("observation.state")
print(*dataset.schema.features["observation.state"].dim_names)

# %% [markdown]
# `tee` is the block. Its *yaw* is the angle by which it is turned, seen from above and counted counter-clockwise. A
# yaw of 0° means that the block is turned exactly as the target is: the bar of the T on top, the stem pointing down.
#
# There is no column `tee_yaw`. There are `sin_tee_yaw` and `cos_tee_yaw`. Do not count on your fingers where they
# are: ask by name.

# %%
names = ["sin_tee_yaw", "cos_tee_yaw"]
sin_column, cos_column = dataset.schema.columns("observation.state", names)
print("sine in column", sin_column, "and cosine in column", cos_column)

# %% [markdown]
# ## Why two numbers for one angle
#
# Because an angle jumps. Take two blocks, one turned to 179° and one to -179°. They look almost the same: turn the
# first by 2° more and you pass 180°, which is the same direction as -180°, and arrive at the second. But as numbers,
# they are far apart. Their sine and cosine are not.

# %%
print("apart, as numbers:", 179 - -179)
for degrees in (179, -179):
    yaw = math.radians(degrees)
    print(f"{degrees:4}°   sin {math.sin(yaw):+.3f}   cos {math.cos(yaw):+.3f}")

# %% [markdown]
# The two angles differ by 358. The sines differ by 0.035, and the cosines not at all in three digits. So sine and
# cosine change a little when the block turns a little, everywhere on the circle. The angle itself does not.
#
# Why does it matter? A policy is a neural network, and a network is a continuous function: inputs that are close give
# outputs that are close. Here the yaw is an *input*, a part of the observation. As one number, two blocks that point
# almost the same way would look to the network as different as two blocks can be.
#
# As an *output* it would be worse: the network would have to jump from one number to the other, and what it gives
# lies in between. A usual loss (the squared error) even asks for this: where two answers are equally likely, the best
# single answer is their mean. Here is the mean of both angles, and then the mean of both points.

# %%
two = np.deg2rad([179, -179])
print("mean of the angles:", np.rad2deg(two.mean()))
print(f"mean of sin and cos: {np.sin(two).mean():.3f} and {np.cos(two).mean():.3f}")

# %% [markdown]
# The mean of the angles is 0°: a block that points the other way. The mean of the sines and cosines is (0, -1),
# which is the direction 180°, right between the two.
#
# ## Decode one frame by hand
#
# Think of a circle with radius 1. The yaw is a direction from its centre, and meets the circle at one point. The
# **cosine** is how far this point is to the right. The **sine** is how far up it is. To find the direction of a
# point, Python has `math.atan2`. It wants *up* first and *right* second: `atan2(sin, cos)`.
#
# Here is the first frame of episode 0.

# %%
episode = state[dataset.episodes[0]]
sin_yaw, cos_yaw = episode[0, [sin_column, cos_column]].tolist()
print(f"sin {sin_yaw:+.3f}   cos {cos_yaw:+.3f}")

# %% [markdown]
# Both are negative: the point is down and to the left. So the direction must lie between -180° and -90°. `atan2` says
# where, in radians. 180 degrees are pi, or 3.142 radians.

# %%
yaw = math.atan2(sin_yaw, cos_yaw)
print(f"{yaw:.3f} rad, or {math.degrees(yaw):.1f}°")

# %% [markdown]
# The block is almost upside down. `z2r.decode_yaw` does the same for all frames at once. Do they agree?

# %%
by_z2r = z2r.decode_yaw(episode[:, sin_column], episode[:, cos_column])
print(f"by hand, z2r: {yaw:.3f} {by_z2r[0]:.3f}")

# %% [markdown]
# Here is the function, read from the installed package at this moment. The line on top is its address: the file, the
# name, and a fingerprint that changes when the code does.

# %%
show_source(z2r.decode_yaw)

# %% [markdown]
# ## Why not one of them alone
#
# School knows two other ways from a sine or a cosine to an angle: `asin` (arcsine) and `acos` (arccosine). Each takes
# one number. Try both on the same frame. The right answer is -165.2°.

# %%
print(f"asin: {math.degrees(math.asin(sin_yaw)):.1f}°")
print(f"acos: {math.degrees(math.acos(cos_yaw)):.1f}°")

# %% [markdown]
# Both are wrong, in two ways. `asin` only ever answers between -90° and 90°: it cannot tell left from right. `acos`
# only answers between 0° and 180°: it cannot tell up from down. Each loses half of the circle, because two directions
# share each sine, and two share each cosine. Here are two with one sine.

# %%
for degrees in (30, 150):
    yaw = math.radians(degrees)
    print(f"{degrees:3}°   sin {math.sin(yaw):+.3f}   cos {math.cos(yaw):+.3f}")

# %% [markdown]
# The sine is the same, and only the sign of the cosine tells the two apart. That is why two numbers are stored, and
# why the decoding must use both.
#
# ## Compare two yaws
#
# `atan2` answers between -180° and 180°. So once decoded, the jump is back. Episode 4 runs into it. Here are three
# frames in a row, and the differences between them.

# %%
turning = state[dataset.episodes[4]]
yaws = np.rad2deg(z2r.decode_yaw(turning[:, sin_column], turning[:, cos_column]))[26:29]
print("yaw:       ", *yaws.round(1))
print("difference:", *np.diff(yaws).round(1))

# %% [markdown]
# In a tenth of a second the block seems to turn by -350°. It did not. It turned by 10° and passed the jump: 350° one
# way is 10° the other way. To repair it, *wrap* the difference: add or subtract whole turns until it lies between
# -180° and 180°. The remainder operator `%` does this in one line. `% 360` alone would give 0 to 360, so the line
# shifts by half a turn before, and back after.

# %%
by_hand = (np.diff(yaws) + 180) % 360 - 180
print("wrapped:", *by_hand.round(1))

# %% [markdown]
# Now both steps are small. `z2r.wrap_angle` does the same in radians.

# %%
by_z2r = np.rad2deg(z2r.wrap_angle(np.diff(np.deg2rad(yaws))))
print("by hand, z2r:", by_hand[0].round(1), by_z2r[0].round(1))
show_source(z2r.wrap_angle)

# %% [markdown]
# Remember what gets wrapped: the **difference**. The yaws themselves, 171.8° and -178.2°, were both in range already.
#
# ## What a swap does
#
# Most people think of a point as x, then y. A spreadsheet does too: its `ATAN2` wants the cosine first. So sooner or
# later somebody writes `atan2(cos, sin)` in Python. It runs. Each answer is a proper angle. What does it make of five
# yaws?

# %%
for degrees in (0, 30, 45, 60, 90):
    yaw = math.radians(degrees)
    swapped = math.atan2(math.cos(yaw), math.sin(yaw))
    print(f"{degrees:2}° is read as {math.degrees(swapped):2.0f}°")

# %% [markdown]
# It is tempting to say that a swap turns everything by 90°. Look again. 0° becomes 90°, and 30° becomes 60°. 45°
# stays as it is, and 90° goes **back** to 0°. A turn would add the same angle to each. This is a *reflection*: the
# swap makes `90° - yaw` of every yaw, so directions are mirrored about the line at 45°.
#
# The picture shows it for 30°. The solid blue ray is the right reading, and the orange ray is the swapped one. Each
# has a T at its tip: the bar lies along the ray, and the stem points a quarter turn clockwise from it. The long grey
# line through the centre is the mirror. The empty ring is where a turn by 90° would have gone.

# %%
figures.yaw_circle(sin_yaw=0.5, cos_yaw=0.866)

# %% [markdown]
# The two rays lie on both sides of the mirror, 15° from it each. Nothing went to the ring.
#
# A mirror also reverses every turn, like a clock seen in a mirror. Episode 1 shows it. Add up all the small turns of
# the block, each wrapped, once for the right reading and once for the swapped one.

# %%
sines, cosines = state[dataset.episodes[1]][:, [sin_column, cos_column]].T
for name, first, second in (("right", sines, cosines), ("swapped", cosines, sines)):
    yaws = z2r.decode_yaw(first, second)
    turned = z2r.wrap_angle(np.diff(yaws)).sum()
    print(f"{name:8} turned by {np.rad2deg(turned):+.1f}°")

# %% [markdown]
# The block turned counter-clockwise, which is the plus sign. The swapped reading has it turn clockwise, by the same
# amount.
#
# Here is that episode in both readings. A *reading* says which column means what: `z2r.PUSHT` is the right one, and
# `yaw-swap` makes the wrong one of it. The positions are the same in both. Look at how the block is turned at the start
# and at the end.

# %%
swapped = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
one = state[dataset.episodes[1]]
both = [z2r.decode(one, reading, dataset.schema) for reading in (z2r.PUSHT, swapped)]
figures.right_and_wrong(*both)

# %% [markdown]
# On the left, the block comes to rest on the target. On the right, it ends in the same place, lying on its side. But
# at the start, the two readings look much alike. Print both.

# %%
right, wrong = (np.rad2deg(z2r.decode_yaw(*pair)) for pair in ((sines, cosines), (cosines, sines)))
for name, frame in (("start", 0), ("end", -1)):
    print(f"{name:6} right {right[frame]:6.1f}°   swapped {wrong[frame]:6.1f}°")

# %% [markdown]
# The mirror line has two ends, 45° and -135°. At the start the yaw is -128.1°, near the second of them. A direction
# close to the mirror hardly changes, and the readings differ by 14°. At the end the yaw is near 0°, and there the
# reflection looks like a turn by a quarter. An episode that reaches the target always ends near 0°. That is where the
# wrong idea of "90° off" comes from.
#
# How many of the six episodes reached the target, in each reading?

# %%
for name, reading in (("right", z2r.PUSHT), ("swapped", swapped)):
    outcome = z2r.inspect_dataset(dataset, reading=reading).outcome
    print(f"{name:8} {outcome.tally} reached")

# %% [markdown]
# Perfect data, and it looks worthless.
#
# ## A check that cannot see it
#
# A careful person might test that `sin² + cos² = 1` in every frame. It is a good test: it finds columns that are no
# sine and cosine at all. Does it find the swap?

# %%
sines, cosines = state[:, [sin_column, cos_column]].T
for name, first, second in (("right", sines, cosines), ("swapped", cosines, sines)):
    squares = first**2 + second**2
    print(f"{name:8} all within a millionth of 1: {np.allclose(squares, 1, rtol=0, atol=1e-6)}")

# %% [markdown]
# It cannot. A sum does not care about the order of its terms, and the order is all that was wrong. What did help was
# to look at a picture. [Notebook 06](07_break_modes.ipynb) has a check that needs no eyes.
#
# ## Practice
#
# **Predict, then run.** A block is turned by 120°. Somebody decodes it with swapped arguments. Which yaw do they get,
# in degrees between -180 and 180? Put the number in place of `None`. After your prediction you also see the picture.

# %% tags=["exercise", "swap"]
prediction = None
practice.check_swap(prediction)


# %% [markdown]
# **Complete the line.** The function takes the sine and the cosine of a yaw, and must return the yaw in radians.
# Replace the three dots. The check tries five yaws, from all around the circle. If one is wrong, it draws the block
# as it is turned and as you have it.


# %% tags=["exercise", "decode"]
def decode(sin_yaw, cos_yaw):
    return ...


practice.check_decode(decode)


# %% [markdown]
# **Bug hunt.** The function below should say how far apart two yaws are, in radians, from 0 to pi. Its author knew
# about the jump. From 10° to 40° it says 30°, which is right. From 179° to -179° it is wrong, though it does wrap.
# Find the mistake and fix it.


# %% tags=["exercise", "turn"]
def apart(before, after):
    before = z2r.wrap_angle(before)
    after = z2r.wrap_angle(after)
    return abs(after - before)


practice.check_turn(apart)

# %% [markdown]
# ## You can now
#
# - **explain** why an angle is stored as sine and cosine: they do not jump, and an angle does;
# - **decode** it with both: `z2r.decode_yaw(sin, cos)`, the sine first;
# - **compare** two yaws by their wrapped difference: `z2r.wrap_angle(after - before)`;
# - **recognise** a swap: `90° - yaw`, a reflection, so 45° stays, and every turn goes the other way.
#
# Next: [How many reached the target?](04_hidden_success.ipynb) uses the yaw to find what no column says.
