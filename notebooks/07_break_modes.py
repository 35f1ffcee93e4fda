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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/07_break_modes.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # How do I know that I read it right?
#
# Code that misreads a dataset does not crash. It prints numbers, and numbers look trustworthy. In this notebook you
# misread a dataset in three ways, on purpose, and learn what each looks like. Under one of them, exactly the right
# episodes seem to reach the target. You find it out all the same, with a check that needs no label: two solid bodies
# cannot be in the same place.
#
# **By the end you can**
#
# - **build** a reading from a file, and a wrong one on purpose;
# - **recognise** three wrong readings by what they leave behind;
# - **check** a reading without a label, by how far solid bodies overlap;
# - **avoid** a file name that breaks Python itself.
#
# It takes 20 minutes. You need nothing but this page.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
import subprocess
import sys
from pathlib import Path

import numpy as np

import z2r
from z2r.course import figures
from z2r.course.exercises import breaks as practice
from z2r.course.source import show_source
from z2r.pusht.overlap import overlap, pusher_in_block

# %% [markdown]
# ## A reading is a list of beliefs
#
# The dataset `standin` ships with the course. A robot, a disc called *the pusher*, shoves a T-shaped block onto a
# target. Each attempt is an *episode*, each moment of it a *frame*. We take the first three episodes. A frame holds ten
# numbers, and the schema gives them names.

# %%
dataset = z2r.load(z2r.STANDIN).first(3)
state = dataset.read("observation.state")
print(dataset.episodes.n_frames, "frames, lengths", *dataset.episodes.lengths)
names = dataset.schema.features["observation.state"].dim_names
print(*names[:6])
print(*names[6:])


# %% [markdown]
# What do the names mean? The dataset does not say. Somebody has to believe it, and a *reading* writes the beliefs down.
# `tee` is the block. A *yaw*, the angle by which a thing is turned, is stored as its sine and its cosine. The right
# reading of this task is `z2r.PUSHT`. Here is what it believes of the two things that can be turned.


# %%
def tell(reading):
    for thing in ("tee", "target"):
        pose = reading.poses[thing]
        print(f"{thing:6}  at ({pose.x}, {pose.y}), yaw = {pose.yaw.formula}")


tell(z2r.PUSHT)

# %% [markdown]
# It also says what counts. An episode *reached* the target if, in its last stored frame, the block is close enough to
# it and turned little enough away from it. Each of the two is a *goal*.

# %%
for goal in z2r.PUSHT.goal:
    print(goal.says(z2r.PUSHT.unit(goal)))

# %% [markdown]
# ## One wrong belief
#
# `atan2` wants the sine first. It is easy to give it the cosine first. By hand, for the block in the last frame of the
# first episode:

# %%
last = z2r.named_columns(state[dataset.episodes[0]][-1:], z2r.PUSHT, dataset.schema)
sine, cosine = last["sin_tee_yaw"][0], last["cos_tee_yaw"][0]
print(f"right: {np.arctan2(sine, cosine):.2f} rad, wrong: {np.arctan2(cosine, sine):.2f} rad")

# %% [markdown]
# The two make 1.57, a quarter of a turn: the swap reads a yaw of *a* as a quarter turn less *a*. In `z2r` this mistake
# is a *break mode*, a reading with one belief wrong. Its name is `yaw-swap`. The data is the same, down to the last
# bit. Compare these lines with the ones above.

# %%
yaw_swap = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
tell(yaw_swap)

# %% [markdown]
# ### Practice: what does yaw-swap do to the metrics?
#
# **Predict, then run.** Read right, the three episodes have 217 frames, the longest has 76, and 3 of 3 reached the
# target. What are the three numbers under `yaw-swap`? And how many reach it under `yaw-swap-everywhere`, which makes
# the same swap for the target too? Put a number in place of each `None`, then run the cell. Do it before you scroll on.

# %% tags=["exercise", "predict-yaw-swap"]
n_frames = None
longest = None
n_reached = None
n_reached_everywhere = None
practice.predict_yaw_swap(n_frames, longest, n_reached, n_reached_everywhere)

# %% [markdown]
# ## A reading is a file
#
# How is such a reading made? By writing it down. There is no code in a reading, only names and numbers, so it fits into
# a small text file. This is all of `z2r.PUSHT`. Find the two lines with `sin` and `cos`, and the two with `within`.

# %%
file = Path(z2r.__file__).parent / "pusht/pusht.toml"
print(file.read_text())

# %% [markdown]
# The format is TOML: a name in brackets opens a section, and each line in it gives a value to a key. The three *poses*
# are the things that have a place. Every `[[goal]]` must hold in the last stored frame. `[action]` says what the action
# does, `[columns]` gives units and limits, and `scene` names the task whose bodies and walls `z2r` knows.
#
# `read_reading` reads such a file, and nothing else makes `z2r.PUSHT`. A reading cannot be changed, but you can have a
# copy in which one thing is different. Here is one with a stricter goal.

# %%
print("the file is z2r.PUSHT:", z2r.read_reading(file) == z2r.PUSHT)
stricter = z2r.PUSHT.with_goal("pos_err", within=0.01)
print("the copy:", stricter.goal[0].says("m"), "  the original:", z2r.PUSHT.goal[0].says("m"))


# %% [markdown]
# ### Practice: make the swap yourself
#
# **Complete the line.** So `yaw-swap` is two names exchanged in one line of a file. The function takes a yaw with two
# fields, `yaw.sin` and `yaw.cos`, each the name of a column. It should return a yaw in which the two names are
# exchanged. `z2r.YawColumns(sin="a", cos="b")` makes one. Put yours in place of the three dots.


# %% tags=["exercise", "swap"]
def swap(yaw):
    return ...


practice.check_swap(swap)

# %% [markdown]
# ## Three signatures
#
# Three break modes are enough to begin with; [a later notebook](09_field_guide.ipynb) has the others. `yaw-swap` you
# know. `drop-boundaries` believes that there are no episodes. `yaw-swap-everywhere` makes the swap twice, for the block
# and for the target. Here they are beside the right reading. The last column is the error in yaw at the ends of the
# episodes, from the smallest to the largest.

# %%
print("mode                 episodes  frames  reached  ang_err")
for name in ("read right", "yaw-swap", "drop-boundaries", "yaw-swap-everywhere"):
    mode = None if name == "read right" else z2r.break_mode(name)
    read = z2r.inspect_dataset(dataset, mode)
    ends, n = read.outcome, len(read.episodes)
    ang_err = ends.final_errors["ang_err"]
    reached = f"{ends.n_reached} of {n}  {ang_err.min():.2f} to {ang_err.max():.2f} rad"
    print(f"{name:20} {n:8}  {read.episodes.n_frames:6}   {reached}")

# %% [markdown]
# Take the lines one by one.
#
# **yaw-swap**: as many frames, as many episodes, and none of them reached the target. The errors in yaw are close to
# 1.57 rad, a quarter of a turn. An error of just that size in *every* episode is no accident. It is a signature.
#
# **drop-boundaries**: one episode, and it "reached" the target, 1 of 1. That is the last frame of the last episode. The
# first two have no say any more. The number is not wrong by a little, it means nothing.
#
# **yaw-swap-everywhere**: the same line as the right reading, digit by digit.
#
# ## Where drop-boundaries shows
#
# Length gives it away: one episode of 217 frames, where you recorded three. So does motion. Take the longest step of
# the block from one frame to the next, once within the episodes and once over all frames.

# %%
block = z2r.decode(state, z2r.PUSHT, dataset.schema).pose("tee")
step = np.hypot(np.diff(block.x), np.diff(block.y))
joints = dataset.episodes.from_index[1:] - 1
print(f"within the episodes: {1000 * np.delete(step, joints).max():.0f} mm, over all: {1000 * step.max():.0f} mm")

# %% [markdown]
# Between two frames lies a tenth of a second. The long step is a *leap*: it lies where one episode ends and the next
# begins.
#
# ## Two mistakes that cancel
#
# Now the dangerous one. Why is its number right? By hand, for the last frame of the first episode: the block's yaw and
# the target's, and how far they are apart, first read right and then swapped. `z2r.decode` applies a reading to frames.

# %%
everywhere = z2r.break_mode("yaw-swap-everywhere").reading(z2r.PUSHT)
for reading in (z2r.PUSHT, everywhere):
    decoded = z2r.decode(state[dataset.episodes[0]][-1:], reading, dataset.schema)
    tee, target = decoded.yaw("tee")[0], decoded.yaw("target")[0]
    print(f"block {tee:5.2f}, target {target:4.2f}, apart {abs(tee - target):.2f} rad")

# %% [markdown]
# Both yaws are wrong, and both are mirrored in the same way. The angle *between* them is not touched: a mirror keeps
# angles. *Reached* looks only at this angle and at the distance, so it cannot show the mistake.
#
# **A number that looks right proves nothing.** So look. On the left is the second episode read right, on the right with
# `yaw-swap-everywhere`. Compare the dotted outline of the target, how the block comes to lie on it, and where the last
# ring of the pusher is.

# %%
one = state[dataset.episodes[1]]
both = [z2r.decode(one, reading, dataset.schema) for reading in (z2r.PUSHT, everywhere)]
figures.right_and_wrong(*both)

# %% [markdown]
# On the right every **direction** is mirrored, but no **position** is. The target lies on its side, and the block still
# ends on it: of these two alone, either picture could be the true one. But the pusher stayed where it was, and a block
# that is turned the wrong way leaves it no room. On the left its last ring lies beside the block, on the right inside.
#
# ## Solid bodies do not overlap
#
# The pusher is a disc with a radius of 15 mm. The block is two boxes: a *bar* and a *stem*. Both are solid. If a
# reading puts the disc inside a box, the reading is wrong. No label is needed for that.
#
# We need to know where the pusher is *as seen from the block*. Take the way from the block to the pusher, (x, y), and
# turn it **back** by the block's yaw. Turning it forward by an angle *a* would make (cos *a* · x - sin *a* · y,
# sin *a* · x + cos *a* · y). Turning back is turning by -*a*. The function `pusher_in_block` does it for every frame.
#
# If we draw all these places around the block, the right reading must leave the block empty. We take all six episodes.

# %%
whole = z2r.load(z2r.STANDIN)
frames = whole.read("observation.state")
right, wrong = (z2r.decode(frames, reading, whole.schema) for reading in (z2r.PUSHT, yaw_swap))
figures.seen_from_block(right, wrong)

# %% [markdown]
# Each dot is the centre of the pusher in one frame. On the left there is a gap around the T, as wide as the pusher's
# radius. Many dots lie in rows along the edge of the gap: that is the pusher, pushing. On the right there are dots all
# over the T.
#
# Now the depth. Take one frame, the one in which the swapped pusher is deepest. It is in the bar, which reaches 15 mm
# up and down from its middle, and the pusher reaches 15 mm further than its centre. So the two overlap by 15 + 15 mm,
# less how far up the centre is.

# %%
deepest = overlap(wrong).argmax()
for name, decoded in (("read right", right), ("yaw-swap", wrong)):
    across, along = pusher_in_block(decoded)
    up = 1000 * along[deepest]
    print(f"{name:10}  {up:4.1f} mm up, so {15 + 15 - up:4.1f} mm inside the bar")

# %% [markdown]
# Read right, the pusher touches the bar: that is the frame of a push. Read wrong, its centre is almost in the middle of
# the bar, which is as deep as it gets. The function `overlap` does this for both boxes and for every frame. It returns
# metres, and 0 where the pusher is outside.

# %%
show_source(overlap)

# %% [markdown]
# Here is the check, for each reading: the deepest overlap, and the number of frames in which it is more than 5 mm.
# Why 5 and not 0? In the simulator a contact gives way by a few mm, as rubber would. To see that the limit holds
# elsewhere, we take a second dataset of the same robot, `messy`, which ships with the course too.

# %%
for name, reading in (("read right", z2r.PUSHT), ("yaw-swap", yaw_swap), ("yaw-swap-everywhere", everywhere)):
    for data in (whole, z2r.load(z2r.MESSY)):
        depth = 1000 * overlap(z2r.decode(data.read("observation.state"), reading, data.schema))
        print(f"{name:20} {data.root.name:8} deepest {depth.max():4.1f} mm,", end=" ")
        print(f"more than 5 mm in {np.sum(depth > 5):3} of {len(depth):4} frames")


# %% [markdown]
# A few mm, or 30 mm: here is a number that tells the wrong reading from the right one, where the number of episodes
# that reached the target did not. The gap is wide, so the exact limit does not matter much: the command `z2r audit`,
# which makes this check for you, allows 10 mm, as other simulators may have softer contacts. Many datasets have such a
# fact. Find it before you trust a number.
#
# Be fair about what it does not see. It knows only the pusher and the block, so a target that is read wrong does not
# matter to it: that is why both swaps give the same line. And it takes every frame alone, so it cannot see
# `drop-boundaries`. Lengths and leaps show that one. No single check is enough.
#
# ### Practice: as seen from the block
#
# **Bug hunt.** This function should say where the pusher is as seen from the block. It takes the pusher's x and y, the
# block's x and y, all in metres, and the block's yaw in radians. For a yaw of 0 it is right, for any other it is not.
# Find what is wrong and fix it in the cell.


# %% tags=["exercise", "seen-from-block"]
def seen_from_block(pusher_x, pusher_y, x, y, yaw):
    dx, dy = pusher_x - x, pusher_y - y
    return np.cos(yaw) * dx - np.sin(yaw) * dy, np.sin(yaw) * dx + np.cos(yaw) * dy


practice.check_seen_from_block(seen_from_block)

# %% [markdown]
# ## A file that reads Python wrong
#
# There is one more way to be wrong about what a name means. Somebody writes a script that looks into a dataset, and
# calls it `inspect.py`. Python has a module of that name too. When a script runs, Python looks for
# modules in the script's own folder **first**.
#
# We make such a file in a folder of its own, run it, and print the beginning of the last line that it prints. The
# script does nothing but import something from Python's own library.

# %%
trap = Path("z2r-out/trap")
trap.mkdir(parents=True, exist_ok=True)
(trap / "inspect.py").write_text("from dataclasses import dataclass\nprint('all is well')\n")
run = subprocess.run([sys.executable, "inspect.py"], cwd=trap, capture_output=True, text=True)
print(run.stderr.splitlines()[-1].split(" (")[0])

# %% [markdown]
# The script asks for `dataclasses`. `dataclasses` asks for `inspect`, and gets our script instead of Python's module.
# The script asks for `dataclasses` again, which is only half loaded. Our file is at fault, and the last line does not
# name it. The lines above it do, so read the whole traceback. Give the same file another name:

# %%
(trap / "inspect.py").replace(trap / "look.py")
run = subprocess.run([sys.executable, "look.py"], cwd=trap, capture_output=True, text=True)
print(run.stdout.strip())

# %% [markdown]
# A package does not fall into this trap. Its modules have a family name: the module that sums up a dataset is
# `z2r.reading.inspection`, and the folder in which it lies is never searched for `inspect`. Even a file `inspect.py`
# *inside* the package would be `z2r.inspect`, another name. Both modules, side by side:

# %%
import inspect

import z2r.reading.inspection

print(inspect.__name__, "and", z2r.reading.inspection.__name__)
print("Python's own is still itself:", inspect.isfunction(inspect.signature))

# %% [markdown]
# ## You can now
#
# - **build** a reading: write a file and call `z2r.read_reading`. A wrong one:
#   `z2r.break_mode("yaw-swap").reading(z2r.PUSHT)`;
# - **recognise** three: a quarter turn in every episode, one long episode with leaps, or a right number with mirrored
#   directions;
# - **check** a reading by `overlap`: a few mm read right, 30 mm with a swapped yaw;
# - **avoid** calling a script `inspect.py`, or by the name of any other module.
#
# Next: [Is my data any good?](08_your_dataset.ipynb) points all of this at a dataset of your own. Ten more wrong
# readings are in [What is wrong with this dataset?](09_field_guide.ipynb)
