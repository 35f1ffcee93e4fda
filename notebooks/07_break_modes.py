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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/07_break_modes.ipynb)
# About 25 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # How do I know that I read it right?
#
# In a program for maps, somebody gave `atan2` its two arguments the wrong way round. Every direction came out wrong.
# The results came out right, and [somebody saw why](https://github.com/ngageoint/hootenanny/issues/2804): the program
# only ever used the difference of two angles, and both were wrong alike.
#
# Code that misreads a dataset does not crash. It prints numbers, and numbers look trustworthy. On this page you
# misread one on purpose, in three ways, and learn what each leaves behind. One of them leaves *nothing* in the
# numbers. You catch it all the same, for two solid bodies cannot be in one place. Then you turn to an arm, where
# people get other things wrong.
#
# **By the end you can**
#
# - **read** a dataset wrong on purpose;
# - **recognise** three wrong readings by what they leave behind;
# - **check** a reading without a label, by how far solid bodies overlap;
# - **say** which beliefs about a dataset its data refutes, and which it cannot.

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
import numpy as np

import z2r
from z2r.course import figures, moving
from z2r.course.exercises import breaks as practice
from z2r.course.hunts import beliefs as hunt
from z2r.course.source import show_source
from z2r.pusht.overlap import overlap
from z2r.pusht.task import PUSHER_RADIUS
from z2r.pusht.world import TEE_BOXES

# %% [markdown]
# ## A reading is a list of beliefs
#
# Take the first three episodes of `standin`, in which the pusher shoves its block onto the target. Which columns hold
# the block's direction? The dataset does not say. Somebody has to believe it, and a *reading* writes it down.

# %%
dataset = z2r.load(z2r.STANDIN).first(3)
print(dataset.episodes.n_frames, "frames, lengths", *dataset.episodes.lengths)


def tell(reading):
    for thing in ("tee", "target"):
        print(f"{thing:6} yaw = {reading.poses[thing].yaw.formula}")


tell(z2r.PUSHT)

# %% [markdown]
# `tee` is the block, and its *yaw* is the angle by which it is turned. A *break mode* is a reading with one belief
# wrong. The data stays as it is, down to the last bit. This one gives `atan2` the cosine first:

# %%
yaw_swap = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
tell(yaw_swap)

# %% [markdown]
# ### Practice: make the swap yourself (about 2 min)
#
# **Complete the line.** How is such a mistake made? By exchanging two names. The function takes a yaw, where
# `yaw.sin` and `yaw.cos` are names of columns. Return one in which they are exchanged. `z2r.YawColumns(sin="a",
# cos="b")` makes a yaw.


# %% tags=["exercise", "swap"]
def swap(yaw):
    return ...


practice.check_swap(swap)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Its `sin` is the name that `yaw.cos` holds.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def swap(yaw):
#     return z2r.YawColumns(sin=yaw.cos, cos=yaw.sin)
# ```
#
# </details>

# %% [markdown]
# ### Practice: what if there were no episodes? (about 2 min)
#
# Another break mode, `drop-boundaries`, believes that there are none: all frames are one long recording.
#
# **Predict, then run.** Read right, there are 217 frames, the longest episode has 76, and 3 of 3 reached the target,
# in their last frame. What are the three numbers under `drop-boundaries`? Put one in place of each `None`, before you
# scroll on.

# %% tags=["exercise", "predict-drop-boundaries"]
n_frames = None
longest = None
n_reached = None
practice.predict_drop_boundaries(n_frames, longest, n_reached)

# %% [markdown]
# <details><summary>Hint</summary>
#
# How many last frames are there now?
#
# </details>
# <details><summary>Solution</summary>
#
# `n_frames = 217`, `longest = 217`, `n_reached = 1`.
#
# </details>

# %% [markdown]
# ## Three signatures
#
# One more: `yaw-swap-everywhere` makes the swap for the block *and* for the target. The last column is the error in
# yaw at the end, in radians.

# %%
print("mode                 episodes  frames  reached  error in yaw")
for name in ("yaw-swap", "drop-boundaries", "yaw-swap-everywhere", None):
    read = z2r.inspect_dataset(dataset, name and z2r.break_mode(name))
    ends, n = read.outcome, read.episodes.n_frames
    off = ends.final_errors["ang_err"]
    print(f"{name or 'read right':20} {len(read.episodes):8}  {n:6}", end="")
    print(f"   {ends.tally}  {off.min():.2f} to {off.max():.2f}")

# %% [markdown]
# **yaw-swap**: nothing reached. And every error is close to 1.57, a quarter of a turn. One error, of just that size,
# in *every* episode: that is no accident, that is a signature.
#
# **drop-boundaries**: 1 of 1. The last frame of the last episode speaks for all. The number is not wrong by a little,
# it means nothing. Its signature is one long episode, with leaps in it.
#
# **yaw-swap-everywhere**: the line of the right reading, digit by digit.
#
# ## Two mistakes that cancel
#
# Why? By hand, at the end of the first episode, read right and then swapped everywhere:

# %%
everywhere = z2r.break_mode("yaw-swap-everywhere").reading(z2r.PUSHT)
last = dataset.read("observation.state")[dataset.episodes[0]][-1:]
for reading in (z2r.PUSHT, everywhere):
    decoded = z2r.decode(last, reading, dataset.schema)
    tee, target = decoded.yaw("tee")[0], decoded.yaw("target")[0]
    print(f"block {tee:5.2f}, target {target:4.2f},", end=" ")
    print(f"apart {abs(tee - target):.2f}")

# %% [markdown]
# Both yaws are mirrored alike, and a mirror keeps the angle between them. *Reached* looks only at that angle, and at
# the distance. **A number that looks right proves nothing.** So look, on the left read right, on the right swapped.

# %%
one = dataset.read("observation.state")[dataset.episodes[1]]
pair = (z2r.PUSHT, everywhere)
both = [z2r.decode(one, reading, dataset.schema) for reading in pair]
figures.right_and_wrong(*both)

# %% [markdown]
# Every **direction** is mirrored, and no **position** is. The target lies on its side, and the block still ends on
# it. Either picture could be true, if it were not for the pusher. It stayed where it was. Find its last ring: on the
# left it lies beside the block, on the right *inside*.
#
# ## Solid bodies do not overlap
#
# There is the check, and it needs no label. If a reading puts the pusher inside the block, the reading is wrong. Sit
# down on the block, in every frame of all six episodes, and mark where the pusher is, as seen from there. A right
# reading must leave the block empty.

# %%
whole = z2r.load(z2r.STANDIN)
frames = whole.read("observation.state")
pair = (z2r.PUSHT, yaw_swap)
right, wrong = (z2r.decode(frames, each, whole.schema) for each in pair)
figures.seen_from_block(right, wrong)

# %% [markdown]
# On the left there is a gap around the T, as wide as the pusher's radius. The dots along its edge are pushes. On the
# right they are all over the T.
#
# Take the pusher into your own hand. This is the frame in which the swapped block lies deepest under it. Push it in
# and pull it out, and read the number.

# %%
moving.push_in(whole)

# %% [markdown]
# `overlap` makes a number of it: how deep the pusher is in the block, in metres, and 0 where it is outside.

# %%
show_source(overlap)

# %%
parts = zip(("bar", "stem"), TEE_BOXES, strict=True)
for part, ((x, y), (half_x, half_y, _)) in parts:
    print(f"{part:4} {200 * half_x:2.0f} by {200 * half_y:.0f} cm,", end=" ")
    print(f"its middle at {100 * x:.0f}, {100 * y:.0f}")
print(f"pusher: a disc, {100 * PUSHER_RADIUS} cm from middle to edge")

# %% [markdown]
# Three readings, and two datasets. A contact in the simulator gives way by a few millimetres, as rubber would, so
# count only what is deeper than 5.

# %%
readings = {"read right": z2r.PUSHT, "yaw-swap": yaw_swap}
for name, reading in (readings | {"everywhere": everywhere}).items():
    for data in (whole, z2r.load(z2r.MESSY)):
        state = data.read("observation.state")
        depth = 1000 * overlap(z2r.decode(state, reading, data.schema))
        print(f"{name:10} {data.root.name:8} {depth.max():4.1f} mm", end="")
        print(f", over 5 mm in {np.sum(depth > 5)} of {len(depth)} frames")

# %% [markdown]
# A few millimetres, or thirty. Here is the number that tells the two readings apart, where *reached* could not. `z2r
# audit` makes this check for you. Its limit is 10 mm, for another simulator may be softer.
#
# And what does it not see? A target that is read wrong: both swaps give the same lines. And `drop-boundaries`, for it
# takes each frame alone. No single check is enough.
#
# ### Practice: as seen from the block (about 2 min)
#
# **Bug hunt.** The function should say where the pusher is, as seen from the block. It takes x and y of both, in
# metres, and the block's yaw in radians. For a yaw of 0 it is right, for any other it is not.


# %% tags=["exercise", "seen-from-block"]
def seen_from_block(pusher_x, pusher_y, x, y, yaw):
    dx, dy = pusher_x - x, pusher_y - y
    across = np.cos(yaw) * dx - np.sin(yaw) * dy
    along = np.sin(yaw) * dx + np.cos(yaw) * dy
    return across, along


practice.check_seen_from_block(seen_from_block)

# %% [markdown]
# <details><summary>Hint</summary>
#
# If the block turns to the left, the pusher goes to the right, as seen from it.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def seen_from_block(pusher_x, pusher_y, x, y, yaw):
#     dx, dy = pusher_x - x, pusher_y - y
#     across = np.cos(yaw) * dx + np.sin(yaw) * dy
#     along = np.cos(yaw) * dy - np.sin(yaw) * dx
#     return across, along
# ```
#
# </details>

# %% [markdown]
# ## And an arm?
#
# An arm has no block and no yaw, so what do people get wrong about it? The unit, above all: [ROS counts in radians,
# LeRobot's arms in degrees](https://github.com/iblnkn/rosetta/pull/7), and somebody has to convert. Then the order:
# in [a dataset of humanoids](https://github.com/physical-superintelligence-lab/Humanoid-Everyday/issues/10), the
# joints of a hip are listed in another order than they are stored in.
#
# A break mode applies wherever a dataset has what it is about. How many of them can happen to the arm?

# %%
beliefs = z2r.audit_beliefs(z2r.ARM).beliefs
apply = [each for each in beliefs if each.verdict != "does not apply"]
print(len(beliefs), "break modes, of which", len(apply), "apply to the arm")

# %% [markdown]
# Now the question turns round. Not: *is my reading right?* But: **if it were wrong, would the data tell me?** Believe
# each of these in turn, and run every check that there is. If one of them finds something new, the belief is
# *refuted*. In a terminal this is `z2r audit arm --break all`.

# %%
for each in apply:
    print(f"{each.mode:19} {each.verdict:12}", *each.refuted_by)

# %% [markdown]
# `wrong-angle-unit` takes the degrees of the state for radians, or the other way round. The check `unit` refutes it
# (`z2r explain unit` says more): a joint would move 57 times as far as it is told. `joints-exchanged` is refuted
# because each of two joints does what the *other* one is told. Both rest on one fact: **a joint goes where it is
# told**. It is to the arm what solid bodies are to the pusher.
#
# Remember the lines that say *not refuted*. `gripper-inverted` takes open for closed, in [one
# dataset](https://github.com/OpenDriveLab/AgiBot-World/issues/133) against what its own description says. A gripper
# that obeys looks the same either way. `action-lag` shifts the commands by a single frame, and an arm is two
# behind anyhow: three would do as well. No data will tell you. **You have to know it.**
#
# (One more thing that is easily read wrong, by Python itself: a script called `inspect.py`. It hides the module of
# that name, on which half of the standard library depends. Call yours something else.)

# %% [markdown]
# ### Hunt: what nobody holds stays (about 9 min)
#
# No check refuted `gripper-inverted`: a gripper that obeys looks the same either way. But there is a cube in this
# dataset, and *what nobody holds stays where it is*. With that, and a few more facts about cubes and tables, five
# wrong beliefs can be refuted, and no label is needed.
#
# **Write a check.** `is_refuted` gets a dict: the columns of an episode, by the names that somebody believes they
# have. `block_x` to `goal_z` are in metres, `gripper.pos` goes from 0, closed, to 100, the other joints are in
# degrees, and each has its command, as in `action/gripper.pos`. There are 30 frames a second. It returns `True` where
# that cannot be. Ten of twenty episodes are read right, three of them failures. Ten are read wrong, in five ways.
# `hunt.examples()` has others of the same kinds: `(frames,) = hunt.examples()[0].args`, and `.truth` says whether it
# is read wrong.


# %% tags=["exercise", "hunt"]
def is_refuted(frames):
    return ...


hunt.score(is_refuted)

# %% [markdown]
# <details><summary>Hint</summary>
#
# What can a cube not do while the jaws are open? What lies under it? How fast is an arm? And of cube and goal, which
# one never moves?
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def is_refuted(frames):
#     cube, goal = (
#         np.stack([frames[f"{body}_{axis}"] for axis in "xyz"])
#         for body in ("block", "goal")
#     )
#     steps = np.linalg.norm(np.diff(cube, axis=1), axis=0)
#     jaws_open = frames["gripper.pos"][1:] > 50
#     flies = steps[jaws_open].sum() > 0.02  # m, and nobody holds it
#     sinks = cube[2].min() < cube[2, 0] - 0.01  # into the table
#     rushes = steps.max() > 0.2  # m in a 30th of a second
#     strays = np.ptp(goal, axis=1).max() > 0.001
#     return bool(flies or sinks or rushes or strays)
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **read** wrong on purpose: `z2r.break_mode("yaw-swap").reading(z2r.PUSHT)`;
# - **recognise** a quarter turn in every episode, one long episode with leaps, and a right number with mirrored
#   directions;
# - **check** a reading by `overlap`: a few millimetres, or thirty;
# - **say** what the data refutes with `z2r audit my_dataset --break all`, and know the rest yourself.
#
# Next: somebody sends you a recording of an arm. [Is my data any good?](08_your_dataset.ipynb)

# %% [markdown] tags=["replies"]
# <details><summary>One saved run: what the checkers reply</summary>
#
# **swap: nothing swapped**
#
# ```text
# not yet: for the yaw of the block, expected sin=cos_tee_yaw, cos=sin_tee_yaw and
#     got sin=sin_tee_yaw, cos=cos_tee_yaw. A YawColumns, whose sin is the name
#     that yaw.cos holds. And the other one?
# ```
#
# **swap: a right answer**
#
# ```text
# right: all 3 trials agree with z2r.
# ```
#
# **predict-drop-boundaries: all three reach it**
#
# ```text
# not yet: you said (217, 217, 3), it is (217, 217, 1). No frame is lost, and all
#     are in one episode. It has one last frame, the last of all, which is on the
#     target.
# Another one: In three other episodes, the first two reached the target and the
#     third did not. How many reached it, under drop-boundaries? Add your answer
#     to the call, as again=..., and run the cell again.
# ```
#
# **predict-drop-boundaries: a right answer**
#
# ```text
# right: it is (217, 217, 1). No frame is lost, and all are in one episode. It has
#     one last frame, the last of all, which is on the target.
# ```
#
# **seen-from-block: half mended**
#
# ```text
# not yet: for a pusher at (0.05, 0.1) and a block at (0.02, 0), turned by 90
#     degrees, expected (0.1, -0.03) and got (0.1, 0.03). Turn the block back to
#     yaw 0, and the pusher with it. Which way is back?
# ```
#
# **seen-from-block: a right answer**
#
# ```text
# right: all 4 trials agree with z2r.
# ```
#
# **hunt: nothing sinks**
#
# ```text
# not yet: 90 of 100 points. Right: 18, missed: 2, false alarms: 0.
#     up taken for down (2 of 2): missed
#     What can a cube not do that nobody holds? What can a table not let through,
#         and what never moves?
# ```
#
# **hunt: a right answer**
#
# ```text
# right: 20 of 20, nothing missed, no false alarm. For another hunt, add seed=1 to
#     the call.
# ```
#
# </details>

# %% tags=["colophon"]
from z2r.course.source import colophon

colophon()
