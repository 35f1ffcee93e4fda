# ---
# jupyter:
#   jupytext:
#     cell_metadata_filter: tags,jupyter,cellView,-all
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
# About 25 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # Which way is the block pointing?
#
# There is a tutorial in which you build a compass out of a small computer. In its first version north was up. In its
# second, north was to the right, and the compass [turned the wrong
# way](https://github.com/rust-embedded/discovery/pull/444). The code looked fine. It gave two arguments to one
# function in the wrong order.
#
# The same function decodes the angles of robots.
#
# **By the end you can**
#
# - **explain** why one angle is stored as two numbers, or as four;
# - **decode** a yaw with `atan2(sin, cos)`, and say why neither half is enough;
# - **compare** two yaws across the jump at 180°;
# - **convert** an angle between degrees, radians, sine and cosine, and a quaternion;
# - **recognise** swapped arguments by what they do.
#
# A little school trigonometry helps.

# %% jupyter={"source_hidden": true} cellView="form" tags=["setup"]
# @title Set up: installs z2r where it is missing, as in Colab
from importlib.util import find_spec
from pathlib import Path

if not find_spec("z2r"):  # from a wheel beside this page, or its repository
    source = "git+https://github.com/zero2robot/seeing-like-a-robot"
    for wheel in Path().glob("z2r-*.whl"):
        source = wheel.resolve().as_uri()
    get_ipython().run_line_magic("pip", f'install -q "z2r[notebook]@{source}"')

# %%
import math

import numpy as np

import z2r
from z2r.course import moving
from z2r.course.exercises import angles as practice
from z2r.course.hunts import headings as hunt
from z2r.course.source import show_source

# %% [markdown]
# ## Why two numbers for one angle
#
# The *yaw* of the block is the angle by which it is turned, counter-clockwise. At 0° it lies as the target does, bar
# on top. No column holds it. Two hold its sine and its cosine.

# %%
dataset = z2r.load(z2r.STANDIN)
state = dataset.read("observation.state")
names = ["sin_tee_yaw", "cos_tee_yaw"]
columns = dataset.schema.columns("observation.state", names)
sines, cosines = state[dataset.episodes[0]][:, columns].T
print(f"first frame: sin {sines[0]:+.3f}   cos {cosines[0]:+.3f}")

# %% [markdown]
# Why not the angle itself? Because it jumps. A block at 179° and one at -179° point almost the same way: 2° more, and
# the first is past 180°, where the second is. As numbers they are as far apart as can be.

# %%
print("apart, as numbers:", 179 - -179)
for degrees in (179, -179):
    yaw = math.radians(degrees)
    print(f"{degrees:4}°   sin {math.sin(yaw):+.3f}   cos {math.cos(yaw):+.3f}")

# %% [markdown]
# Sine and cosine hardly differ. A policy is a network, and a network is continuous: what is close should look close
# to it. And where it hesitates between two answers, it gives their mean.

# %%
two = np.deg2rad([179, -179])
print("mean of the angles:", np.rad2deg(two.mean()))
mean_sin, mean_cos = np.sin(two).mean(), np.cos(two).mean()
print(f"mean of sin and cos: {mean_sin:.3f}, {mean_cos:.3f}")

# %% [markdown]
# The mean of the angles points the other way. The mean of the points on the circle is right between the two, at 180°.
#
# ## Decode
#
# Draw a circle with radius 1. The yaw is a direction from its centre. The **cosine** is how far its point is to the
# right, the **sine** how far it is up. `atan2` finds the direction, and wants *up* first: `atan2(sin, cos)`.

# %%
yaw = math.atan2(sines[0], cosines[0])
print(f"{yaw:.3f} rad, or {math.degrees(yaw):.1f}°")
print(f"asin alone: {math.degrees(math.asin(sines[0])):.1f}°")
print(f"acos alone: {math.degrees(math.acos(cosines[0])):.1f}°")

# %% [markdown]
# The block is almost upside down. Each half alone is wrong: `asin` cannot tell left from right, and `acos` cannot
# tell up from down.
#
# `z2r.decode_yaw` does it for all frames at once. Here is its source, read from the package at this moment.

# %%
show_source(z2r.decode_yaw)

# %% [markdown]
# **Complete the line.** Return the yaw in radians. It is tried on five yaws from all around the circle.


# %% tags=["exercise", "decode"]
def decode(sin_yaw, cos_yaw):
    return ...


practice.check_decode(decode)

# %% [markdown]
# <details><summary>Hint</summary>
#
# `math.atan2` wants how far up first.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def decode(sin_yaw, cos_yaw):
#     return math.atan2(sin_yaw, cos_yaw)
# ```
#
# </details>

# %% [markdown]
# ## Compare
#
# `atan2` answers between -180° and 180°, so the jump is back once an angle is decoded. Episode 4 runs into it.

# %%
turning = state[dataset.episodes[4]][:, columns].T
yaws = np.rad2deg(z2r.decode_yaw(*turning))[26:29]
print("yaw:       ", *yaws.round(1))
print("difference:", *np.diff(yaws).round(1))
print("wrapped:   ", *((np.diff(yaws) + 180) % 360 - 180).round(1))

# %% [markdown]
# No block turns by -350° in a tenth of a second. It turned by 10° and passed the jump. *Wrap* the difference: shift
# it by half a turn, take the remainder, shift it back. `z2r.wrap_angle` does it in radians.
#
# **Bug hunt.** How far apart are two yaws, in radians, from 0 to pi? From 10° to 40° the function is right. From 179°
# to -179° it is wrong, though it does wrap.


# %% tags=["exercise", "turn"]
def apart(before, after):
    before = z2r.wrap_angle(before)
    after = z2r.wrap_angle(after)
    return abs(after - before)


practice.check_turn(apart)

# %% [markdown]
# <details><summary>Hint</summary>
#
# 179° and -179° are both in range already. Which number is not?
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def apart(before, after):
#     return abs(z2r.wrap_angle(after - before))
# ```
#
# </details>

# %% [markdown]
# ## One angle, four ways to write it
#
# The arm's joints are angles too. In which unit? Nobody says, but a joint turns by less than a whole turn, which is
# 2π, or 6.28 radians.

# %%
arm = z2r.load(z2r.ARM)
joints = arm.read("observation.state")
joint_names = arm.schema.features["observation.state"].dim_names
for name, values in zip(joint_names, joints.T, strict=True):
    print(f"{name:18}{values.min():7.1f} to {values.max():6.1f}")

# %% [markdown]
# None of them can be radians. LeRobot also knows joints in percent of their range, from -100 to 100, but `wrist_roll`
# goes beyond. That leaves degrees. The gripper is no angle at all: it is in percent, and 0 is closed. So says whoever
# recorded it. The dataset does not.
#
# The other way round is harder: an elbow in radians looks just like a joint in degrees that hardly moves. [Your
# dataset](08_your_dataset.ipynb) may hold one.
#
# Here is the elbow where it bends most, in the four ways that you will meet.

# %%
degrees = joints[:, joint_names.index("elbow_flex.pos")].max()
angle = math.radians(degrees)
print(f"degrees         {degrees:.1f}")
print(f"radians         {angle:.3f}")
print(f"sin, cos        {math.sin(angle):.3f} {math.cos(angle):.3f}")
half = angle / 2
print(f"quaternion xyzw 0 0 {math.sin(half):.3f} {math.cos(half):.3f}")

# %% [markdown]
# In space a body can turn about any axis, and a *quaternion* says how: x, y, z hold the axis, times the sine of
# **half** the angle, and w the cosine of half of it. Its
# order is a trap: some write x, y, z, w and others w, x, y, z. [A large
# dataset](https://github.com/facebookresearch/projectaria_tools/issues/7) had w in the column named `qx`. Its own
# reader had the order wrong as well, and so came out right.
#
# **Bug hunt.** Somebody's film shows the block turning twice as fast as it should. This function made the
# quaternions.


# %% tags=["exercise", "quaternion"]
def quaternion(yaw):
    return 0, 0, np.sin(yaw), np.cos(yaw)


practice.check_quaternion(quaternion)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Compare it with the last two lines of the cell above.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def quaternion(yaw):
#     return 0, 0, np.sin(yaw / 2), np.cos(yaw / 2)
# ```
#
# </details>

# %% [markdown]
# ## What a swap does
#
# Most people think of a point as x, then y. A spreadsheet does, too: its `ATAN2` wants the cosine first. So sooner or
# later somebody writes `atan2(cos, sin)` in Python. It runs.

# %%
for degrees in (-135, 0, 30, 45, 60, 90):
    yaw = math.radians(degrees)
    swapped = math.atan2(math.cos(yaw), math.sin(yaw))
    print(f"{degrees:4}° is read as {math.degrees(swapped):4.0f}°")

# %% [markdown]
# It looks like a turn by 90°, but a turn would add the same angle to each. 45° stays, and 90° goes **back** to 0°.
# This is a *reflection*: the swap makes `90° - yaw` of every yaw.
#
# Turn the block. Blue is its yaw read right, orange is the same two numbers swapped, and the dashed line is the
# mirror. At which yaws do the two agree?

# %%
moving.yaw_slider()

# %% [markdown]
# They agree on the mirror, at 45° and at -135°, and everywhere else they turn in opposite ways. In a mirror a clock
# runs backwards. So does the block of episode 1. Add up all its small turns.

# %%
pair = state[dataset.episodes[1]][:, columns].T
for name, first, second in (("right", *pair), ("swapped", *pair[::-1])):
    yaws = z2r.decode_yaw(first, second)
    turned = z2r.wrap_angle(np.diff(yaws)).sum()
    print(f"{name:8} turned by {np.rad2deg(turned):+6.1f}°,", end=" ")
    print(f"from {np.rad2deg(yaws[0]):6.1f}° to {np.rad2deg(yaws[-1]):4.1f}°")

# %% [markdown]
# The block turned counter-clockwise; swapped, it turns clockwise by as much. At the start the two readings differ by
# 14°, since -128° is close to the mirror's other end, -135°. At the end, near 0°, they differ by a quarter turn.
# Every episode that reaches the target ends near 0°. That is where the wrong idea of "90° off" comes from.
#
# **Predict, then run.** A block at 120° is decoded with swapped arguments. Which yaw comes out, between -180 and 180
# degrees?

# %% tags=["exercise", "swap"]
prediction = None
practice.check_swap(prediction)

# %% [markdown]
# <details><summary>Hint</summary>
#
# A turn would make 210 of it, which is -150. The swap is no turn.
#
# </details>

# %% [markdown]
# ## A check that cannot see it
#
# A careful person tests that sin² + cos² = 1. It is a good test: it finds columns that are no sine and cosine at all.

# %%
for name, first, second in (("right", *pair), ("swapped", *pair[::-1])):
    squares = first**2 + second**2
    print(f"{name:8}", np.allclose(squares, 1, rtol=0, atol=1e-6))

# %% [markdown]
# A sum does not care about the order of its terms, and the order was all that was wrong.

# %% [markdown]
# ### Hunt: what is this column? (about 9 min)
#
# A cart drove across a yard. Its `x` and `y` have names. The other columns, one or two or four of them, have none.
# Are they its heading? In degrees, in radians, sine first or cosine first, a quaternion with its w last or first?
# From the numbers alone, nobody can tell sine and cosine from cosine and sine. But there is a witness: **a cart
# drives where it points.**
#
# **Write it.** `encoding` gets x and y in metres and the columns, `(n_frames, 1)`, `(n_frames, 2)` or `(n_frames,
# 4)`. It returns `"degrees"`, `"radians"`, `"sin cos"`, `"cos sin"`, `"x y z w"`, `"w x y z"` or `"no heading"`. It
# is tried on 21 carts. `hunt.examples()` has others: `.args` is what your function gets, `.truth` what it should say.


# %% tags=["exercise", "hunt"]
def encoding(x, y, columns):
    return ...


hunt.score(encoding)

# %% [markdown]
# <details><summary>Hint</summary>
#
# `np.arctan2(np.gradient(y), np.gradient(x))` is which way it goes. Decode the columns in every way that they may be
# meant. The cosine of a difference of two angles is 1 where they agree, however often somebody turned round.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def encoding(x, y, columns):
#     way = np.arctan2(np.gradient(y), np.gradient(x))
#     c = columns.T
#     if len(c) == 1:
#         yaws = {"degrees": np.deg2rad(c[0]), "radians": c[0]}
#     elif len(c) == 2:
#         yaws = {"sin cos": np.arctan2(*c), "cos sin": np.arctan2(*c[::-1])}
#     else:
#         yaws = {
#             "x y z w": 2 * np.arctan2(c[2], c[3]),
#             "w x y z": 2 * np.arctan2(c[3], c[0]),
#         }
#     fits = {name: np.cos(yaw - way).mean() for name, yaw in yaws.items()}
#     best = max(fits, key=fits.get)
#     return best if fits[best] > 0.9 else "no heading"
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **explain** why an angle is stored as sine and cosine: they do not jump, and an angle does;
# - **decode** it with both: `z2r.decode_yaw(sin, cos)`, the sine first;
# - **compare** two yaws by their wrapped difference: `z2r.wrap_angle(after - before)`;
# - **convert** it: 180 degrees are pi radians, and a quaternion holds the half;
# - **recognise** a swap: `90° - yaw`, so 45° stays, and every turn goes the other way.
#
# Next: [How many reached the target?](04_hidden_success.ipynb) uses the yaw to find what no column says.

# %% [markdown] tags=["replies"]
# <details><summary>One saved run: what the checkers reply</summary>
#
# **decode: swapped arguments**
#
# ```text
# not yet: for a yaw of 30 degrees, expected 0.5236 and got 1.047. The answer is
#     in radians. The sine is how far up the point is, the cosine how far to the
#     right: which of the two does atan2 want first?
# ```
#
# **decode: a right answer**
#
# ```text
# right: all 5 trials agree with z2r.
# ```
#
# **turn: nothing wrapped, degrees**
#
# ```text
# not yet: for the yaws 10 and 40 degrees, expected 0.5236 and got 30. Two
#     directions are never more than pi apart. Which of the numbers has to be
#     wrapped?
# ```
#
# **turn: a right answer**
#
# ```text
# right: all 6 trials agree with z2r.
# ```
#
# **quaternion: half of one**
#
# ```text
# not yet: for a yaw of 60 degrees, expected (0, 0, 0.5, 0.866) and got (0, 0,
#     0.5, 0.5). A quaternion does not hold the sine and the cosine of the yaw
#     itself. Of which angle, then?
# ```
#
# **quaternion: a right answer**
#
# ```text
# right: all 5 trials agree with z2r.
# ```
#
# **swap: a turn by 90 degrees**
#
# ```text
# not yet: you said 210, it is -30.0. The swap makes 90 - yaw of every yaw, and 90
#     - 120 = -30.
# Another one: And a block at -135 degrees? Add your answer to the call, as
#     again=..., and run the cell again.
# ```
#
# **swap: a right answer**
#
# ```text
# right: it is -30.0. The swap makes 90 - yaw of every yaw, and 90 - 120 = -30.
# ```
#
# **hunt: every column is a heading**
#
# ```text
# not yet: 85 of 100 points. Right: 18, missed: 0, false alarms: 3.
#     sine and cosine of a mast that turns by itself: you said 'cos sin', it is
#         'no heading'
#     how much charge the battery has: you said 'degrees', it is 'no heading'
#     the angle of a mast that turns by itself: you said 'radians', it is 'no
#         heading'
#     A cart drives where it points. Decode the columns in every way there is, and
#         ask the wheels.
# ```
#
# **hunt: a right answer**
#
# ```text
# right: 21 of 21, nothing missed, no false alarm. For another hunt, add seed=1 to
#     the call.
# ```
#
# </details>

# %% tags=["colophon"]
from z2r.course.source import colophon

colophon()
