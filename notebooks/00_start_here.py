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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/00_start_here.ipynb)
# About 15 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # What is in this robot dataset?
#
# A program learned to push a block, from 400 demonstrations. Another one learned from the same 400, with the same
# code, and both trainings ran to the end without a warning. One of the two succeeds nearly every time. The other
# hardly ever does.
#
# For the second, every action had been read half a second late. That was all.

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
import json

from IPython.display import Image

import z2r
from z2r.course import costs, figures, rollouts
from z2r.course.exercises import start_here as practice
from z2r.pusht.cloning.results import read_rollout

# %%
for row in ("right", "late-5"):
    cost = costs.cost_of(row)
    print(f"{row:6} {cost.n_successes:3} of {cost.n_rollouts} tries", end=" ")
    print("succeed, learned from", cost.demonstrations, "demonstrations")

# %%
both = {"read right": "right", "half a second late": "late-5"}
both = {title: read_rollout(row) for title, row in both.items()}
Image(rollouts.film(both, seconds=11), format="png")

# %% [markdown]
# Such a program is called a *policy*: it looks, and then it acts. `late-5` is late by five frames, of ten in a
# second. Both start from the same place. The one on the right circles the block as long as the film lasts.
#
# A dataset is full of numbers that mean something: an angle, a speed, the end of a demonstration. The file does not
# check what you take them for. This course teaches you to read them, and to prove that you read them right.
#
# **By the end you can**
#
# - **load** a robot dataset and say how many demonstrations it holds;
# - **inspect** it and say how many of them reached the goal, though no column says so;
# - **look** at one demonstration, moment by moment;
# - **read it wrong** on purpose, and recognise what that looks like.
#
# You need no robot, no simulator and no account: the data comes with the package.
#
# ## Load
#
# The robot is a disc, the *pusher*. It shoves a block in the shape of a T onto a target: to the right place, and
# turned the right way. Somebody recorded that six times, in the format of LeRobot, an open-source library for robot
# learning.
#
# A LeRobot dataset is a folder. One small file in it says what the rest holds, in plain JSON.

# %%
info = json.loads((z2r.STANDIN / "meta/info.json").read_text())
print(info["total_episodes"], "episodes,", info["total_frames"], "frames,")
print(info["fps"], "frames a second")

# %% [markdown]
# An *episode* is one demonstration, from start to end. A *frame* is one moment of it: what the robot saw (the
# *observation*), and what it was then told to do (the *action*). `z2r.load` reads the same file, and where each
# episode ends.

# %%
dataset = z2r.load(z2r.STANDIN)
print(dataset)
print("frames: ", *dataset.episodes.lengths)
print("seconds:", *dataset.episodes.lengths / info["fps"])

# %% [markdown]
# ## Look
#
# Here is one of them, seen from above. The dotted T is the target. Follow the pusher's line.

# %%
episode = dataset.read("observation.state")[dataset.episodes[1]]
right = z2r.decode(episode, z2r.PUSHT, dataset.schema)
figures.moments(right)

# %% [markdown]
# The pusher walks around the block, pushes, walks around again, pushes again. At the end, the block lies on the
# target.
#
# `z2r.PUSHT` is a *reading*. It says which named column means what, in which unit, and what counts as reached. The
# numbers are in the dataset. What they mean is in the reading, and a reading can be wrong.

# %%
print(z2r.PUSHT)

# %% [markdown]
# ## Inspect
#
# How many of the six reached the target? Ask the file for its columns.

# %%
print(*info["features"])

# %% [markdown]
# An observation, an action, and five columns of bookkeeping. No success, no reward. The observation, though, holds
# the pose of the block and of the target. If the block lies on the target in the **last** frame of an episode, within
# both limits of the reading, the episode *reached* it.

# %%
outcome = z2r.inspect_dataset(dataset).outcome
pos_err, ang_err = outcome.final_errors.values()
for i in range(len(dataset.episodes)):
    print(f"episode {i}: {100 * pos_err[i]:.1f} cm off,", end=" ")
    print(f"turned by {ang_err[i]:.2f} rad")
print("reached:", outcome.tally)

# %% [markdown]
# All six. That number was not in the file. It was *reconstructed*, and it is as good as the reading behind it.
#
# ## Read it wrong
#
# No column holds the angle of the block, its *yaw*. Two hold the sine and the cosine of it, and a function makes an
# angle of the two: `atan2(sin, cos)`, in that order. Swap them, and nothing complains.
#
# `z2r` can make such a mistake on purpose. It calls that a *break mode*: the data stays as it is, one belief about it
# is wrong. The one named `yaw-swap` swaps the two **for the block only**. The yaw of the target, which is 0, is still
# read right.
#
# **Predict, then run.** Episodes 0, 1 and 2 all reached the target. Read with `yaw-swap`, how many of these three
# seem to have reached it? Put 0, 1, 2 or 3 in place of `None`, and run the cell.

# %% tags=["exercise", "yaw-swap"]
prediction = None
practice.check_yaw_swap(prediction)

# %% [markdown]
# <details><summary>Hint</summary>
#
# The sine of 0 is 0, the cosine of 0 is 1. Swapped, which angle has sine 1 and cosine 0?
#
# </details>

# %% [markdown]
# Here are both readings. Compare the lengths first, then the last column.

# %%
for mode in (None, z2r.break_mode("yaw-swap")):
    read = z2r.inspect_dataset(dataset.first(3), mode)
    print(f"{read.break_mode or 'read right':10}", end="  ")
    print("lengths", *read.episodes.lengths, end="  ")
    print(f"reached {read.outcome.share_reached:.0%}")

# %% [markdown]
# Same frames, same lengths, and 100% became 0%. If you had seen only the second line, you might have thrown away
# perfect data. What does it look like?

# %%
yaw_swap = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
wrong = z2r.decode(episode, yaw_swap, dataset.schema)
figures.right_and_wrong(right, wrong)

# %% [markdown]
# The block ends in the right place, lying on its side, and the pusher is *inside* it. Remember that: solid bodies
# don't overlap. [A later notebook](07_break_modes.ipynb) turns it into a check that needs no eyes.
#
# Now take it into your own hands. Press *Play*, pick an episode, then open *How is it read?* and choose `yaw-swap`.

# %%
z2r.panel(dataset)

# %% [markdown]
# ## Practice (about 2 min)
#
# Exercises in this course answer you. They try your function on cases that the page does not show, and say what they
# expected. This is the reply to somebody who forgot to divide:

# %%
practice.check_share_reached(lambda reached: sum(reached))

# %% [markdown]
# **Complete the line.** Your function is called with a `reached` like `outcome.reached`, a `True` or a `False` for
# each episode, but of other datasets. Return the share of episodes that reached the target, a number from 0 to 1.


# %% tags=["exercise", "share-reached"]
def share_reached(reached):
    return ...


practice.check_share_reached(share_reached)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Python counts `True` as 1.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def share_reached(reached):
#     return sum(reached) / len(reached)
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **load** a dataset: `z2r.load(folder)`, then `dataset.episodes.lengths`;
# - **inspect** it: `z2r.inspect_dataset(dataset).outcome`, from the last frame of each episode;
# - **look** at it: `figures.moments` here, `z2r.panel` for all of it;
# - **read it wrong**: `yaw-swap` leaves every length alone and turns 100% into 0%.
#
# In a terminal, `z2r inspect` does all of this in one command.
#
# Next: [What is a frame?](01_schema.ipynb) opens the files one by one, and brings a second robot: an arm with six
# joints and two cameras.
