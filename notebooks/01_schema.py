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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/01_schema.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # What is a frame?
#
# A robot dataset is a table of numbers. A policy that is trained on it never asks what they mean. If you hand it
# the target's angle where the block's angle should be, it trains all the same, on the wrong thing. So somebody must
# know what each number is, and that is written down once, in the dataset's *schema*. This page takes it apart.
#
# **By the end you can**
#
# - **find** the schema and the frames in the folder of a LeRobot dataset;
# - **read** the schema: every feature with its dtype, its shape and its names;
# - **name** every number of one frame, and say which of them the robot saw before it acted;
# - **pick** numbers by name, so that your code survives a dataset with another order.
#
# It takes 15 minutes. You need nothing but this page and a little Python.

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
import warnings

import numpy as np
import pyarrow.parquet as pq

import z2r
from z2r.course import figures
from z2r.course.exercises import schema as practice
from z2r.course.source import show_source

# %% [markdown]
# The example comes with the package and is called `standin`. In it a disc, *the pusher*, shoves a T-shaped block
# over a table until the block lies on a *target*. Six demonstrations of this were recorded. Each of them is called
# an *episode*.
#
# ## A dataset is a folder
#
# Which files are in it?

# %%
for path in sorted(z2r.STANDIN.rglob("*.*")):
    print(path.relative_to(z2r.STANDIN).as_posix())

# %% [markdown]
# Two folders. `data` holds the frames, and `meta` says what they are. The files that end in `.parquet` are tables,
# which the library `pyarrow` opens. The files that end in `.json` are text, which Python opens by itself.
#
# ## The schema
#
# `meta/info.json` is the file to open first. Some of it is about the whole dataset.

# %%
info = json.loads((z2r.STANDIN / "meta/info.json").read_text())
for key in ("codebase_version", "fps", "total_episodes", "total_frames"):
    print(f"{key:17}{info[key]}")

# %% [markdown]
# The version is that of the format: this is LeRobot v3. `fps` means frames per second. 427 frames at 10 a second
# are a little less than 43 seconds, for all six episodes together.
#
# Then comes the schema itself. Everything that is stored for a frame is called a *feature*. Each feature has a
# *dtype*, which says what kind of number it is, and a *shape*, which says how many there are.

# %%
for name, feature in info["features"].items():
    print(f"{name:18}{feature['dtype']:9}{feature['shape']}")

# %% [markdown]
# Read the first line like this: for every frame, `observation.state` holds 10 numbers of type `float32`. The
# observation is what the robot saw. The action, 2 numbers, is what it was told to do. The other five are
# bookkeeping, and we come to them soon.
#
# **Predict, then run.** All features together: how many numbers does one frame hold? Put your number in place of
# `None`, and run the cell.

# %% tags=["exercise", "numbers-in-a-frame"]
prediction = None
practice.check_numbers_in_a_frame(prediction)

# %% [markdown]
# Ten numbers need ten names, or nobody knows which is which. The schema has them too. `tee` is the block.

# %%
names = info["features"]["observation.state"]["names"]
print(*names, sep="\n")

# %% [markdown]
# `yaw` is the angle by which something is turned, and it is stored as two numbers, its sine and its cosine. How to
# get the angle back is the question of [notebook 03](03_atan2_decoding.ipynb).
#
# ## One row is one frame
#
# Now open the frames. A parquet file stores its rows in *row groups*, pieces that can be read one by one. The first
# piece is enough here. Take its first row, and put each number beside its name.

# %%
file = pq.ParquetFile(z2r.STANDIN / "data/chunk-000/file-000.parquet")
rows = file.read_row_group(0).to_pylist()
for name, number in zip(names, rows[0]["observation.state"], strict=True):
    print(f"{name:15}{number:7.3f}")

# %% [markdown]
# That is a whole observation: where the pusher is, where the block is and how it is turned, and the same for the
# target. The target is at (0, 0). It is not turned, for the sine of 0 is 0 and the cosine of 0 is 1.
#
# In which units? **The schema does not say.** A name is all you get, and the units you must learn from whoever made
# the recording. Here positions are in metres and actions are velocities in metres per second. So says its maker, and
# a check below bears it out. Sines and cosines have no unit. If you record data of your own, write this down.
#
# For this task somebody did. `z2r.PUSHT` is a *reading*: it says what each name means, units included. With its help,
# the same ten numbers become a picture. Look for the pusher at x = -0.353 and y = 0.229.

# %%
dataset = z2r.load(z2r.STANDIN)
state = dataset.read("observation.state")
figures.episode_path(z2r.decode(state[:1], z2r.PUSHT, dataset.schema))

# %% [markdown]
# One frame is one moment. The pusher is far away, at the upper left, and the block lies almost upside down.
#
# ## First it saw, then it acted
#
# A frame holds an observation and an action. Which came first? You can find out. The action is a velocity, so in a
# tenth of a second it moves the pusher by a tenth of its value. Compare what the pusher was told in a frame with two
# things: how far it moved until the next frame, and how far it had moved since the frame before. All along x, in
# millimetres. Which of the two fits?

# %%
x = names.index("pusher_x")
moved = np.diff([1000 * row["observation.state"][x] for row in rows])
print("          told  until the next  since the one before")
for number in range(3, 8):
    told = 1000 * rows[number]["action"][0] / info["fps"]
    print(f"frame {number}: {told:5.1f}{moved[number]:16.1f}{moved[number - 1]:22.1f}")

# %% [markdown]
# What was told and the move until the next frame differ by no more than a millimetre. The move since the frame before
# is far off: in frame 4 it is 22.1 mm, and told was -1.9 mm. So the action of frame 4 moves the pusher from where
# frame 4 saw it to where frame 5 sees it. **A frame is what the robot saw before a step, and the action that it
# then took.**
#
# This has a consequence that is easy to miss. What the last action of an episode did is stored nowhere, for there
# is no next frame that could show it.
#
# ## Five columns for bookkeeping
#
# Every LeRobot dataset has these five. Here they are, for the last frame of the first episode and the two after it.

# %%
columns = ["timestamp", "frame_index", "episode_index", "index", "task_index"]
print(*columns)
for row in file.read(columns=columns).slice(66, 3).to_pylist():
    print(*(f"{row[name]:{len(name)}.3g}" for name in columns))

# %% [markdown]
# `timestamp` counts seconds and `frame_index` counts frames, and both begin again at 0 with each episode.
# `episode_index` is the number of the episode. `index` counts on through the whole dataset. `task_index` is the
# number of a sentence, which is stored once, in a table of its own.

# %%
tasks = pq.ParquetFile(z2r.STANDIN / "meta/tasks.parquet").read().to_pylist()
print(tasks[0]["task_index"], tasks[0]["task"])

# %% [markdown]
# ## What is not there
#
# Did a demonstration succeed? Was a frame a good one? Ask the schema.

# %%
for word in ("success", "reward", "done"):
    found = [name for name in info["features"] if word in name]
    print(f"{word}: {found or 'nothing'}")

# %% [markdown]
# Nothing. The format has room for such a feature, but it does not ask for one, and this recorder did not write any.
# That all six demonstrations reached the target is not in the file. [Notebook 04](04_hidden_success.ipynb) gets it
# out of the numbers that are.
#
# ## The same with z2r, and with LeRobot
#
# You opened two files by hand. `z2r.load` opened the same ones when we drew the picture, and keeps what it found in
# `dataset.schema`. LeRobot has a reader of its own, `LeRobotDataset`. It is made for training, brings PyTorch and
# takes some seconds to load. If it is not installed where you are, the cell leaves it out.

# %% tags=["record"]
schema = dataset.schema
by_hand = info["fps"], info["total_frames"], info["total_episodes"], list(info["features"])
by_z2r = schema.fps, schema.total_frames, schema.total_episodes, list(schema.features)
facts = {"by hand": by_hand, "z2r": by_z2r}
if importlib.util.find_spec("lerobot"):
    os.environ["HF_HUB_OFFLINE"] = "1"  # everything is here: ask no server
    warnings.filterwarnings("ignore", "IProgress")  # it draws no progress bars
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    other = LeRobotDataset("z2r/standin", root=z2r.STANDIN, video_backend="pyav")
    totals = other.fps, other.num_frames, other.num_episodes
    facts["LeRobotDataset"] = (*totals, list(other.features))

# %% [markdown]
# Each reader has said its frames per second, its totals and its features. Do all of them say the same?

# %% tags=["record"]
for reader, (fps, frames, episodes, features) in facts.items():
    same = "same features" if features == list(info["features"]) else "other features"
    print(f"{reader:15}{fps} fps, {frames} frames, {episodes} episodes, {same}")

# %% [markdown]
# They do. And the frame that you read by hand is the first row of the array that `z2r` reads.

# %%
print(state.shape, np.array_equal(state[0], rows[0]["observation.state"]))

# %% [markdown]
# ## Names, not column numbers
#
# The block's sine is in column 4, counted from 0. So `state[:, 4]` gets it, and many people write just that. Now
# suppose that somebody records the same ten numbers and sorts the names alphabetically. What is in column 4 then?
# Here are both names, each with its smallest and its largest value in the 427 frames.

# %%
for name in (names[4], sorted(names)[4]):
    values = state[:, names.index(name)]
    print(f"{name:15}from {values.min():5.2f} to {values.max():5.2f}")

# %% [markdown]
# It is the sine of the *target*. Nothing would warn you: it is a `float32` between -1 and 1, as the other one is.
# But it is 0 in every frame, and the block would seem never to turn.
#
# So ask the schema. You give a list of names, and it gives a list of the column numbers that they have in this
# dataset.

# %%
print(schema.columns("observation.state", ["sin_tee_yaw", "cos_tee_yaw"]))

# %% [markdown]
# A name that is not there is an error, and the error says which names are. A wrong column number would have given
# numbers, and no error.

# %%
try:
    schema.columns("observation.state", ["tee_z"])
except ValueError as error:
    print(error)

# %% [markdown]
# This is all that the function does: it looks for each name, and stops where one is missing. The line above the
# source is its address in the package and its fingerprint.

# %%
show_source(z2r.Schema.columns)

# %% [markdown]
# ## Practice
#
# **Complete the line.** `values_of` should return all values of one dimension, one number for each frame. It is
# given the state, a schema, and a name such as `"tee_x"`. Replace the three dots. The check tries your function on
# this dataset, and on others where the same names have other columns.


# %% tags=["exercise", "values-of"]
def values_of(state, schema, name):
    return ...


practice.check_values_of(values_of)

# %% [markdown]
# **Bug hunt.** This function should return x and y of the block in each frame. A friend wrote it for another
# dataset, and there it was right. Here it runs as well, and gives two numbers for each frame, but not those of the
# block's position. Change it so that it is right on any dataset that has the names. Where your answer is wrong, the
# check draws where it puts the block.


# %% tags=["exercise", "block-position"]
def block_position(state, schema):
    return state[:, 4:6]


practice.check_block_position(block_position)

# %% [markdown]
# ## You can now
#
# - **find** the schema in `meta/info.json`, and the frames in `data/chunk-000/file-000.parquet`;
# - **read** the schema: seven features here, each with a dtype and a shape, and names for the state and the action;
# - **name** every number of a frame: an observation from before the step, the action that followed, five columns of
#   bookkeeping, and no success;
# - **pick** numbers by name: `schema.columns("observation.state", ["tee_x", "tee_y"])`.
#
# Next: [Where does one demonstration end?](02_episode_index.ipynb) cuts the 427 frames into six episodes.
