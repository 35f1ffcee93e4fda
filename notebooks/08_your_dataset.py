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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/08_your_dataset.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # Is my data any good?
#
# Training takes hours, and it does not complain about bad data. It learns it. A look before takes minutes. In this
# notebook you look at a dataset that has the faults which real ones have. Then you change one line and look at your
# own.
#
# **By the end you can**
#
# - **sum up** any LeRobot v3 dataset: episodes, lengths, ranges;
# - **tell** whether a reading fits it, and what can be said where none does;
# - **write** a reading for a robot that this course has never seen;
# - **understand** the message about a damaged dataset: which file, what is wrong, what to do;
# - **decide** with a short checklist whether to train on it.
#
# It takes 20 minutes. You need nothing but this page. To record data of your own at the end, you need two more
# packages, and the page tells you which.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
import importlib.util
import json
import os
import shutil
from pathlib import Path

import numpy as np

import z2r
from z2r.course import figures
from z2r.course.exercises import your_dataset as practice
from z2r.course.source import show_source
from z2r.pusht.simulator.recorder import record_episode
from z2r.pusht.task import ACTION_LIMIT, WALL

# %% [markdown]
# ## Point at it
#
# A LeRobot v3 dataset is a folder with `meta/` and `data/` in it. `messy` ships with the course: a simulated robot, a
# disc called *the pusher*, shoves a T-shaped block onto a target, and does not always get it there. Each attempt is an
# *episode*, each moment of it a *frame*. To look at your own dataset, put its folder in place of `z2r.MESSY`, in
# quotation marks. Nothing is written to it, and nothing is sent anywhere. The sentences on this page are about
# `messy`.

# %%
DATASET = z2r.MESSY  # your own: "path/to/my_dataset"
dataset = z2r.load(DATASET)
print(len(dataset.episodes), "episodes,", dataset.episodes.n_frames, "frames,", dataset.schema.fps, "a second")

# %% [markdown]
# Is that what you recorded? Many faults show here: the number of episodes is not what you remember. Next come the
# *features*, the things that are stored for each frame. We leave out pictures, frame numbers and times, so that the
# numbers which the robot saw and did remain.

# %%
for name, feature in dataset.schema.signals().items():
    print(f"{name}: {feature.size} numbers of type {feature.dtype}")

# %% [markdown]
# The `observation.state` is what the robot saw, the `action` is what it then did.
#
# ## Lengths
#
# The strip below is the whole dataset, with one segment for each episode. Look for segments that are much shorter
# than the others, and for segments of one and the same length.

# %%
figures.episode_ribbon(dataset.episodes)

# %%
lengths = dataset.episodes.lengths
print("from the shortest to the longest:", *np.sort(lengths))
print(np.sum(lengths == lengths.max()), "have the greatest length,", lengths.max(), "frames")


# %% [markdown]
# Two things stand out. Four episodes are shorter than 2 seconds. Either the task was easy there, or somebody pressed
# a key too early; only a look tells which. And four have exactly 120 frames. Chance does not do that. It is a time
# limit: these episodes did not end, they were cut off, even if the block was on the target by then.
#
# Short and long episodes together set a trap for every average.
#
# ### Practice: the mean of a column
#
# **Bug hunt.** Before training, the mean of each column is needed, over all frames of the dataset. This function
# takes the mean of each episode, and then the mean of those. It gives another number. Find out why, and fix it in
# the cell. The function gets one column, with a value for each frame, and the episode index. It does not have to use
# both.


# %% tags=["exercise", "column-mean"]
def column_mean(values, episodes):
    return np.mean([values[episodes[i]].mean() for i in range(len(episodes))])


practice.check_column_mean(column_mean)

# %% [markdown]
# ## Ranges
#
# How far does each number go? `inspect_dataset` reads every frame and keeps the smallest and the largest value of
# each dimension in each episode. Merged over the episodes, they are the ranges of the dataset.

# %%
inspection = z2r.inspect_dataset(dataset)
for feature, ranges in inspection.ranges.items():
    names = dataset.schema.features[feature].dim_names or range(ranges.low.shape[1])
    for name, low, high in zip(names, ranges.low.min(axis=0), ranges.high.max(axis=0), strict=True):
        print(f"{feature:18} {name:15} {low:6.2f} to {high:6.2f}")
print(f"in this task, walls at {WALL:.2f} m, and no action beyond {ACTION_LIMIT:.2f} m/s")


# %% [markdown]
# Each number has a name. If yours show 0, 1, 2 in place of names, ask the person who recorded them what they are,
# while they still remember.
#
# Now read it line by line. The pusher stays within the walls. Sine and cosine lie between -1 and 1. The action stays
# within its limit, so the robot was never asked for more than it can do. A joint in degrees among joints in radians
# would show here, and so would a gripper that is always open.
#
# The target does not move at all. Here that is meant. In your data, a dimension that never moves may be a sensor that
# was not plugged in.
#
# ### Practice: what never moves?
#
# **Complete the line.** The function gets the values of a feature, one row for each frame and one column for each
# dimension. It should return one answer for each **column**: `True` if all its values are the same. Replace the three
# dots. In numpy, `axis=0` takes a minimum or a maximum down each column.


# %% tags=["exercise", "never-moves"]
def never_moves(values):
    return ...


practice.check_never_moves(never_moves)

# %% [markdown]
# ## Does a reading fit?
#
# The dataset does not store which episodes went well. To find out, somebody has to say which columns hold the block
# and the target, and how close is close enough. That is a *reading*. `z2r.PUSHT` is the reading of this task, and
# `inspect_dataset` took it because it fits. Does the dataset really have the columns that it needs?

# %%
missing = z2r.PUSHT.missing(dataset.schema)
print("missing columns:", *missing or ["none, the reading fits"])

# %% [markdown]
# So the question can be asked: in how many episodes is the block on the target in the last stored frame? We say
# *reached* for that. A share without its number of episodes is worth little, so we print both.

# %%
outcome = inspection.outcome
if outcome:
    print(f"reached: {outcome.tally}, {outcome.share_reached:.0%}")
else:
    print("no reading fits, so nothing about reached")

# %% [markdown]
# The picture below shows the last pose of the block in every episode. Look for the three dashed ones: how far were they
# from the target?

# %%
figures.final_poses(dataset, z2r.PUSHT) if outcome else print("no reading fits, so nothing about reached")

# %% [markdown]
# Here are the three in numbers. The tolerances are 30 mm and 0.2 rad.

# %%
if outcome:
    distance, angle = 1000 * outcome.final_errors["pos_err"], outcome.final_errors["ang_err"]
    for i in np.flatnonzero(~outcome.reached):
        print(f"episode {i}: {distance[i]:.0f} mm from the target, turned away by {angle[i]:.2f} rad")

# %% [markdown]
# Episodes 2 and 6 miss by less than a centimetre. Episode 4 is 59 mm off, and its angle is wrong too. A policy can
# still learn from most of a near miss. Whether you keep it is for you to decide, but now you decide.
#
# *Reached* is a reading of the last frame. The simulator has its own word, *success*: the block stayed on the target
# for five steps in a row. For the shipped datasets the simulator's verdict is kept in a file beside the folder. Your
# own data will hardly have one, so the cell asks first.

# %%
verdict = z2r.read_verdict(DATASET)
if verdict and outcome:
    success = np.array([episode.success for episode in verdict.episodes])
    print(f"success: {success.sum()} of {len(success)}")
    print("reached without success: episode", *np.flatnonzero(outcome.reached & ~success))
else:
    print("no verdict, or no reading that fits, so nothing to compare")

# %% [markdown]
# They differ by one. Episode 10 is one of the four that ran out of time. In its last frame the block was on the
# target, but it had not been there for five steps. The reading cannot know that. If you report a share of your
# episodes, say which of the two it is: *reached*, or *success*.
#
# ## Another robot
#
# What about a robot that has no pusher and no T? Say, a hand that brings a part to a slot. We make its dataset from
# `standin`, six demonstrations which all reached their goal: a copy in which every column gets another name. The names
# are in one file, `meta/info.json`, so it can be done by hand.

# %%
other = Path("z2r-out/other_robot")
shutil.copytree(z2r.STANDIN, other, dirs_exist_ok=True)
info = (other / "meta/info.json").read_text()
for old, new in (("pusher", "hand"), ("tee", "part"), ("target", "slot")):
    info = info.replace(old, new)
(other / "meta/info.json").write_text(info)
print(*z2r.load(other).schema.features["observation.state"].dim_names)

# %% [markdown]
# ### Practice: what will it say?
#
# **Predict, then run.** The numbers in the copy are the same as before, only their names are not. How many episodes
# reached their goal, says `z2r`? Put `"0 of 6"`, `"6 of 6"` or `"nothing"` in place of `None`.

# %% tags=["exercise", "other-robot"]
prediction = None
practice.predict_other_robot(prediction)

# %% [markdown]
# And here is what it says.

# %%
found = z2r.inspect_dataset(other)
print(len(found.episodes), "episodes,", found.episodes.n_frames, "frames. Reached:", found.outcome)
missing = z2r.PUSHT.missing(found.schema)
print(len(missing), "columns of z2r.PUSHT are missing, the first is", missing[0])

# %% [markdown]
# Episodes and frames are counted as ever, and the ranges are there too. Of reached it says `None`, which is Python
# for "nothing". It could have guessed that the third column is still an x of something. A guess that looks like a
# number is worse than no number.
#
# ## A reading of your own
#
# `z2r` does not know this robot. You do, so tell it. A reading is a small file in a format called TOML: which columns
# say where a thing is, and what has to be true at the end.


# %%
text = """
[poses]
part = { x = "part_x", y = "part_y", yaw = { sin = "sin_part_yaw", cos = "cos_part_yaw" } }
slot = { x = "slot_x", y = "slot_y", yaw = { sin = "sin_slot_yaw", cos = "cos_slot_yaw" } }

[[goal]]
name = "gap"
distance = ["part", "slot"]
within = 0.03

[[goal]]
name = "skew"
turn = ["part", "slot"]
within = 0.2
"""

# %% [markdown]
# Eleven lines. Two *poses*, and two *goals*: the distance from the part to the slot must be less than 0.03 m (a pose
# can name another `unit`), and the turn from one to the other less than 0.2 radians. What you call a thing, or a goal,
# is up to you. What is in quotation marks after `x`, `y`, `sin` and `cos` must be names of columns.
#
# A thing in space has a `z` too, and a `quaternion` in place of the yaw. A goal need not be about two poses. It can be
# a limit on one column, or a column that says it outright, as in `stored = "next.success"`.
#
# Write the file, and read it.

# %%
my_file = Path("z2r-out/my.toml")
my_file.write_text(text)
my_reading = z2r.read_reading(my_file)
print(my_reading)

# %% [markdown]
# It understood. Now inspect the dataset with this reading, once right, and once with the two columns of the part's yaw
# swapped. The break modes of [the notebook before](07_break_modes.ipynb) work on any reading that has what they get
# wrong.

# %%
for mode in (None, z2r.break_mode("yaw-swap")):
    found = z2r.inspect_dataset(other, mode, my_reading)
    print(f"{found.break_mode or 'read right':10} reached {found.outcome.tally}, gaps", end=" ")
    print(*(f"{1000 * gap:.0f}" for gap in found.outcome.final_errors["gap"]), "mm")

# %% [markdown]
# Six of six, as it should be: the numbers are those of `standin`. Swapped, none of six, with the same gaps. And a
# picture? Nobody said what the part looks like, so it is drawn as an arrow that points where the yaw points.

# %%
figures.final_poses(z2r.load(other), my_reading)

# %% [markdown]
# Six arrows near the dotted one, all nearly parallel to it: that is what reached looks like here.
#
# What if you make a typo? There are two kinds. A key that means nothing is an error, in one line.

# %%
typo = Path("z2r-out/typo.toml")
typo.write_text(text.replace("within = 0.03", "witin = 0.03"))
try:
    z2r.read_reading(typo)
except z2r.DatasetError as error:
    print(error)

# %% [markdown]
# `goal[0]` is the first goal, for Python counts from 0. The other kind is a column that the dataset does not have. The
# file is fine then, but it does not fit, and `missing` says why.

# %%
typo.write_text(text.replace('"part_x"', '"prt_x"'))
print("missing columns:", *z2r.read_reading(typo).missing(z2r.load(other).schema))

# %% [markdown]
# ## A damaged one
#
# Recorders crash, disks fill up, downloads stop halfway. We copy the dataset once more and cut its data file in half.
# What does it look like then?

# %%
damaged = Path("z2r-out/damaged")
shutil.copytree(z2r.STANDIN, damaged, dirs_exist_ok=True)
file = damaged / "data/chunk-000/file-000.parquet"
file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
print(len(z2r.load(damaged).episodes), "episodes")

# %% [markdown]
# It looks fine. `load` reads the schema and the episode index, and those are whole. The frames are read when they are
# needed, and that is where it shows. Every fault in a dataset is the same kind of error as your typo was, a
# `DatasetError`, so it can be caught and taken apart.

# %%
try:
    z2r.inspect_dataset(z2r.load(damaged))
except z2r.DatasetError as error:
    print("file:", error.fault.path.as_posix())
    print("found:", error.fault.found)
    print("expected:", error.fault.expected)
    print("what to do:", error.fault.mend)

# %% [markdown]
# Four parts: the file, what was found in it, what was expected, and what you can do about it. Printed whole, the
# error is one line with these parts, as far as they are known. Now a fault that most programs would not notice. The
# data is whole, but `info.json` claims one frame too many.

# %%
claim = json.loads(info)
claim["total_frames"] += 1
(other / "meta/info.json").write_text(json.dumps(claim))
try:
    z2r.load(other)
except z2r.DatasetError as error:
    print(error)

# %% [markdown]
# This time the message also names the field in the file. Two parts of the dataset contradict each other. One of them
# is wrong, and it is better to know before training than after.
#
# ## Before you train
#
# Here is the checklist. Each point is something that you have done in this course.
#
# 1. Does `z2r.inspect_dataset` run without a `DatasetError`? It reads every frame of the state and the action.
# 2. Is the number of episodes what you recorded?
# 3. Which episodes are very short, which have exactly the length of the time limit? Watch one of each kind.
# 4. Does any dimension never move, or go further than the robot can?
# 5. How many episodes reached the goal? Say the number of episodes with it, and whether it is a reading or a verdict.
# 6. Do the bodies overlap where they cannot? That is the check of [the notebook before](07_break_modes.ipynb). Its
#    `overlap` knows only this task. For another robot, find such a fact of your own.
# 7. Have you watched three whole episodes as [a replay](05_rerun_replay.ipynb)? Not the first three: some from the
#    middle.
#
# In a terminal, `z2r inspect my_dataset` prints the numbers for the first five.
#
# ## Record your own
#
# With the simulator you can record as much as you like. A scripted expert drives, and LeRobot itself writes the
# dataset. This is the loop that records one episode. Look at the order of the last lines in it: a frame is the
# observation **before** the step, and the action.

# %%
show_source(record_episode)

# %% [markdown]
# So the observation after the last action is never stored. That is the reason why a reading and the verdict can
# differ.
#
# Recording needs two packages more, `mujoco` and `lerobot`. This cell records two episodes of at most 40 frames if
# both are there. If not, it says so, and takes the first two episodes that ship with the course instead.

# %% tags=["record"]
mine = Path("z2r-out/mine")
if importlib.util.find_spec("mujoco") and importlib.util.find_spec("lerobot"):
    os.environ["HF_HUB_OFFLINE"] = "1"
    shutil.rmtree(mine, ignore_errors=True)
    z2r.record(mine, seeds=[0, 1], max_steps=40)
    recorded = z2r.load(mine)
else:
    print("No simulator here. In a clone of the course: pip install '.[record]'")
    recorded = z2r.load(z2r.STANDIN).first(2)
print(len(recorded.episodes), "episodes, lengths", *recorded.episodes.lengths)

# %% [markdown]
# With the simulator, both episodes have 40 frames, exactly the limit. You know what that means: they were cut off.
# `standin` was recorded from the same two seeds with a limit of 300. Here is how long they take if one lets them, and
# what the reading and the verdict say of the two that you have now.

# %% tags=["record"]
print("in standin, lengths", *z2r.load(z2r.STANDIN).first(2).episodes.lengths)
reached = z2r.inspect_dataset(recorded).outcome.reached
success = [episode.success for episode in z2r.read_verdict(recorded.root).episodes[:2]]
print(f"reached: {sum(reached)} of {len(reached)}, success: {sum(success)} of {len(success)}")

# %% [markdown]
# The recorder writes the verdict beside the dataset, and never into it. Record the same seeds on another computer,
# and the frames may differ: a physics simulator does not give the same digits everywhere. That is why the numbers on
# these pages come from shipped data. For a recording worth training on, leave out `max_steps` and take more seeds.
#
# ## You can now
#
# - **sum up** any LeRobot v3 dataset: `z2r.load`, the strip of episodes, the ranges;
# - **tell** whether a reading fits: `z2r.PUSHT.missing(schema)`, and where it does not, expect nothing about reached;
# - **write** a reading of your own: poses and goals in a file, then
#   `z2r.inspect_dataset(dataset, reading=z2r.read_reading("my.toml"))`;
# - **understand** a `DatasetError`: the file, what was found, what was expected, what to do;
# - **decide** with seven questions whether to train.
#
# Next: take a dataset of your own, change one line, `DATASET`, and write its reading. Then
# [What is wrong with this dataset?](09_field_guide.ipynb) shows ten ways in which one can be wrong, and how to notice.
# If you came here first, begin with [What is in this robot dataset?](00_start_here.ipynb)
