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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/00_start_here.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # What is in this robot dataset?
#
# Somebody recorded a robot while it did a task. You want a program to learn the task from the recording. Before that,
# you want to know four things: how many demonstrations there are, how long they are, what each number means, and how
# many of them reached the goal. The dataset answers the first three if you ask. The fourth it does not store. You will
# get it all the same, and then you will see how easily one gets it wrong.
#
# The recording is in the format of LeRobot, an open-source library that many people use for robot learning.
#
# **By the end you can**
#
# - **load** a LeRobot dataset and say how many episodes and frames it has;
# - **inspect** it and say how many episodes reached the target;
# - **look** at an episode and at where all of them end;
# - **read it wrong** on purpose and recognise what that looks like.
#
# It takes 15 minutes. You need no robot, no simulator and no account: the data comes with the package.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
import json

from IPython.display import Image

import z2r
from z2r.course import costs, figures, rollouts
from z2r.course.exercises import start_here as practice
from z2r.pusht.cloning.results import read_rollout

# %% [markdown]
# ## Why bother?
#
# A small program, a *policy*, learned from 400 demonstrations to shove a block onto a target. Then another one learned
# from the same demonstrations, with one thing wrong: each action stood half a second late, and nobody noticed. Nothing
# crashed. Both had to do the task in a simulator, from the same starts.

# %%
for row in ("right", "late-5"):
    cost = costs.cost_of(row)
    print(f"{row:6}  {cost.n_successes} of {cost.n_rollouts} tries succeed,", end=" ")
    print("learned from", cost.demonstrations, "demonstrations")

# %% [markdown]
# Here is one start, with both.

# %%
both = {"read right": "right", "read half a second late": "late-5"}
both = {title: read_rollout(row) for title, row in both.items()}
Image(rollouts.film(both, seconds=11), format="png")

# %% [markdown]
# The one on the right has learned to be late. It circles the block and never arrives. What each misreading costs, and
# which cost nothing, is in [the last notebook](10_cost_of_a_misreading.ipynb). First, learn to read.
#
# ## The task
#
# The robot is a disc, *the pusher*. On a table in front of it lies a block in the shape of a T. The pusher has to shove
# the block onto a target: the right place, turned the right way. The task is known as PushT. It is planar, so three
# numbers say where the block is: x and y in metres, and a *yaw*, the angle by which it is turned.
#
# Here is the recording, seen from above. `z2r.STANDIN` is the folder of the dataset that comes with the package. Press
# *Play*, or step through the frames with the arrow keys, and watch the two errors fall. Then pick another episode. The
# question at the top, *How is it read?*, can stay closed: you will come back to it.

# %%
dataset = z2r.load(z2r.STANDIN)
z2r.panel(dataset)

# %% [markdown]
# The same as a still picture: all of one demonstration. `z2r.PUSHT` is a *reading*: it says which named column means
# what, and what counts as reached. `z2r.decode` applies it to some frames. Look at three things: where the block
# starts, how the orange line of the pusher leads around it before it pushes, and where the block ends.

# %%
episode = dataset.read("observation.state")[dataset.episodes[1]]
right = z2r.decode(episode, z2r.PUSHT, dataset.schema)
figures.episode_path(right)

# %% [markdown]
# The block begins far from the target and turned away from it, and ends on it. You just read a dataset. The next three
# sections do it again, slowly.
#
# ## Load
#
# A LeRobot dataset is a folder. One small file in it, `meta/info.json`, says what the rest holds. It is plain JSON, so
# nothing but Python is needed to open it.

# %%
info = json.loads((z2r.STANDIN / "meta/info.json").read_text())
print(info["total_episodes"], "episodes,", info["total_frames"], "frames,", info["fps"], "frames a second")

# %% [markdown]
# An *episode* is one demonstration, from start to end. A *frame* is one moment of it: what the robot saw (the
# *observation*) and what it then did (the *action*). Ten frames make a second.
#
# `z2r.load` reads the same file, and the list of episodes with it. `dataset` already holds both.

# %%
lengths = dataset.episodes.lengths
print(len(dataset.episodes), "episodes,", dataset.episodes.n_frames, "frames")
print("lengths:", *lengths)

# %% [markdown]
# The numbers agree. The lengths are frames, so dividing one by 10 gives seconds: every demonstration here takes between
# 5 and 9 seconds. A strip with one piece for each episode shows the whole dataset at a glance.

# %%
figures.episode_ribbon(dataset.episodes)

# %% [markdown]
# ## Inspect
#
# How many of the six reached the target? Search the file for an answer.

# %%
print(*info["features"])

# %% [markdown]
# These are all the columns there are. There is an observation and an action. The other five are bookkeeping: which
# frame, which episode, at what time. There is no success and no reward.
#
# But the observation holds the block's pose and the target's. So look at the **last** frame of each episode: if the
# block is on the target there, the episode *reached* it. "On" means less than 3 cm off and turned by less than 0.2
# radians (about 11 degrees), the tolerances of the task itself. That is what `inspect_dataset` does, for every episode.

# %%
outcome = z2r.inspect_dataset(dataset).outcome
pos_err, ang_err = outcome.final_errors["pos_err"], outcome.final_errors["ang_err"]
for i in range(len(dataset.episodes)):
    print(f"episode {i}: {100 * pos_err[i]:.1f} cm off, turned by {ang_err[i]:.2f} rad")
print("reached:", outcome.tally)

# %% [markdown]
# All six are within the tolerances. This number was not in the file. It was *reconstructed*, and it is as good as the
# reading behind it.
#
# ## Look
#
# A number can be right by accident. A picture is harder to fool. Here is the block's last pose in each of the six
# episodes. If the reading is right, the six outlines lie near the dotted one, which is the target.

# %%
figures.final_poses(dataset, z2r.PUSHT)

# %% [markdown]
# They lie close to it, each within 3 cm. The number and the picture say the same.
#
# ## Read it wrong
#
# Here are the ten numbers of an observation. `tee` is the block.

# %%
print(*dataset.schema.features["observation.state"].dim_names)

# %% [markdown]
# No column holds the block's yaw. There is its sine and its cosine, and one function turns the two into an angle:
# `atan2(sin, cos)`, in that order. It is easy to swap them, and nothing warns you: the code runs, and what comes out is
# still an angle. The swap makes 90 degrees of 0, and 0 of 90.
#
# `z2r` can make that mistake on purpose. It is called a *break mode*: the data stays the same, one assumption about it
# is wrong. This one is named `yaw-swap`. It swaps the two **for the block only**. The yaw of the target, which is 0, is
# still read right.
#
# **Predict, then run.** Episodes 0, 1 and 2 all reached the target. Read with `yaw-swap`, how many of these three will
# seem to have reached it? Put 0, 1, 2 or 3 in place of `None`, and run the cell. The answer comes with the first try.

# %% tags=["exercise", "yaw-swap"]
prediction = None
practice.check_yaw_swap(prediction)

# %% [markdown]
# Here are both readings of the three episodes, side by side. The data is the same. Compare the lengths first, then the
# last column.

# %%
for mode in (None, z2r.break_mode("yaw-swap")):
    read = z2r.inspect_dataset(dataset.first(3), mode)
    share = f"{read.outcome.share_reached:.0%}"
    print(f"{read.break_mode or 'read right':10}  lengths {read.episodes.lengths}  reached {share}")

# %% [markdown]
# Same episodes, same lengths, and 100% became 0%. If you had only seen the second line, you might have thrown away
# perfect data. Here is the episode from the first picture, decoded a second time with the wrong reading. On the right,
# where does the block end?

# %%
yaw_swap = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
wrong = z2r.decode(episode, yaw_swap, dataset.schema)
figures.right_and_wrong(right, wrong)


# %% [markdown]
# It ends in the right place, lying on its side, and the pusher is inside it. That is the signature of `yaw-swap`:
# the positions are right, the angles are not. Now go back to the panel at the top, open *How is it read?*, choose
# `yaw-swap` there, and watch all six collapse to 0%.
#
# ## Practice
#
# **Complete the line.** `outcome.reached` holds one `True` or `False` for each episode. The function below should
# return the share of episodes that reached the target, a number between 0 and 1. Replace the three dots. The check
# tries your function on more than these six episodes.


# %% tags=["exercise", "share-reached"]
def share_reached(reached):
    return ...


practice.check_share_reached(share_reached)

# %% [markdown]
# ## You can now
#
# - **load** a dataset: `z2r.load(folder)`, then `len(dataset.episodes)` and `dataset.episodes.lengths`;
# - **inspect** it: `z2r.inspect_dataset(dataset).outcome`, reconstructed from the last frame of each episode;
# - **look** at it: the path of one episode, and the last poses of all;
# - **read it wrong**: `yaw-swap` leaves every length as it was and turns 100% into 0%.
#
# In a terminal, `z2r inspect` does all of this in one command, and `z2r report` writes the panel as a page that you can
# mail to somebody.
#
# Next: [What is a frame?](01_schema.ipynb) takes apart what you just loaded, one file at a time.
