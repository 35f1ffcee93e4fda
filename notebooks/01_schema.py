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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/01_schema.ipynb)
# About 15 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # What is a frame?
#
# A robot in a simulated kitchen is driven by twelve numbers. One program took the first four for the wheels. They
# belonged to the hand. [Nothing crashed](https://github.com/TensorAuto/OpenTau/pull/550): every episode ran to its
# end, and only the results were wrong. A network does not mind what it is fed.
#
# Which number is which is written down once: in the *schema* of the dataset. Here you take two of them apart.
#
# **By the end you can**
#
# - **find** the schema, the frames and the videos in the folder of a LeRobot dataset;
# - **read** the schema: every feature with its dtype, its shape and its names;
# - **name** every number of a frame, and say what the robot saw before it acted;
# - **pick** numbers by name, so that your code survives a dataset with another order.

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
import importlib.util
import json
import os
import warnings

import numpy as np
import pyarrow.parquet as pq

import z2r
from z2r.course import figures
from z2r.course.exercises import schema as practice

# %% [markdown]
# ## A dataset is a folder
#
# Two datasets come with the course. `standin` is the pusher and its T-shaped block, seen from above. `arm` is an
# SO-101, a small arm that many people have on their desk, with two cameras. It was recorded in simulation.

# %%
for root in (z2r.STANDIN, z2r.ARM):
    for path in sorted(root.rglob("*")):
        if path.is_file():
            print(path.relative_to(root.parent).as_posix())

# %% [markdown]
# `data` holds the frames, and `meta` says what they are. The arm has `videos` too, a file for each camera. The tables
# end in `.parquet`, and the library `pyarrow` opens them. The `.json` files are text.
#
# ## The schema
#
# Open `meta/info.json` first. Whatever is stored for a frame is a *feature*. Its *dtype* says what kind of number it
# is, and its *shape* says how many there are.


# %%
def read_info(root):
    return json.loads((root / "meta/info.json").read_text())


info = read_info(z2r.STANDIN)
print(info["fps"], "frames a second,", info["total_frames"], "frames")
for name, feature in info["features"].items():
    print(f"{name:18}{feature['dtype']:9}{feature['shape']}")

# %% [markdown]
# In every frame, `observation.state` is 10 numbers of type `float32`. The observation is what the robot saw, and the
# action is what it was told to do. The other five are bookkeeping.
#
# **Predict, then run.** All features together: how many numbers are in one frame?

# %% tags=["exercise", "numbers-in-a-frame"]
prediction = None
practice.check_numbers_in_a_frame(prediction)

# %% [markdown]
# <details><summary>Hint</summary>
#
# A shape of `[1]` is one number. Add up all seven lines.
#
# </details>

# %% [markdown]
# The arm has more to say.

# %%
arm_info = read_info(z2r.ARM)
print(arm_info["fps"], "frames a second,", arm_info["total_frames"], "frames")
for name, feature in arm_info["features"].items():
    if name not in info["features"] or feature["shape"] != [1]:
        print(f"{name:30}{feature['dtype']:9}{feature['shape']}")

# %% [markdown]
# Its pictures have 120 rows and 160 columns, in three colours, and are in the videos. The bookkeeping is the same,
# and left out here. Now the names: without them, nobody knows which of the ten numbers is which.

# %%
names = info["features"]["observation.state"]["names"]
print("pusher:", *names, sep="\n  ")
joints = arm_info["features"]["observation.state"]["names"]
print("arm:", *joints, sep="\n  ")

# %% [markdown]
# `tee` is the block, and *yaw* is the angle by which it is turned. The pusher is told where everything is. The arm is
# told how its own six joints stand, and no more: where the cube is, it must see. (This one was simulated, so
# `observation.environment_state` holds the place of the cube as well. A real arm has no such feature.)
#
# ## One row is one frame
#
# Take the first row of both tables, and put each number beside its name.


# %%
def read_rows(root, columns):
    file = pq.ParquetFile(root / "data/chunk-000/file-000.parquet")
    return file.read(columns=columns).to_pylist()


rows = read_rows(z2r.STANDIN, ["observation.state", "action"])
for name, number in zip(names, rows[0]["observation.state"], strict=True):
    print(f"{name:17}{number:8.3f}")

# %%
arm_row = read_rows(z2r.ARM, ["observation.state"])[0]
for name, number in zip(joints, arm_row["observation.state"], strict=True):
    print(f"{name:17}{number:8.3f}")

# %% [markdown]
# In which units? **The schema does not say.** You get a name, and the rest you learn from whoever made the recording.
# The pusher's positions are in metres. For the arm you can guess: no joint turns by 95 radians, so `wrist_flex` is in
# degrees. A guess is not a fact, and [notebook 03](03_atan2_decoding.ipynb) looks closer.
#
# Here is the pusher's frame as a picture: the pusher at x = -0.353 and y = 0.229, and the block almost upside down.

# %%
dataset = z2r.load(z2r.STANDIN)
state = dataset.read("observation.state")
figures.episode_path(z2r.decode(state[:1], z2r.PUSHT, dataset.schema))

# %% [markdown]
# And here is the arm's, which nobody has to draw. These two pictures are as much a part of the frame as the six
# joints.

# %%
arm = z2r.load(z2r.ARM)
figures.camera_pictures(arm, [0])

# %% [markdown]
# ## First it saw, then it acted
#
# A frame holds an observation and an action. Which came first? The pusher's action is a velocity, so in a tenth of a
# second it moves the pusher by a tenth of its value. Compare that with the move *until* the next frame, and with the
# move *since* the frame before. All along x, in millimetres.

# %%
x = names.index("pusher_x")
moved = np.diff([1000 * row["observation.state"][x] for row in rows])
print("         action   until the next   since the last")
for number in range(3, 8):
    asked = 1000 * rows[number]["action"][0] / info["fps"]
    until_next, since_last = moved[number], moved[number - 1]
    print(f"frame {number}: {asked:7.1f}{until_next:17.1f}{since_last:17.1f}")

# %% [markdown]
# The action fits the move until the next frame. Against the move since the last it is far off: in frame 4 it asks for
# -1.9 mm, and the pusher had just moved by 22.1. **A frame is what the robot saw before a step, and the action that
# it was then told.** What the last action of an episode did is stored nowhere, since no frame follows.
#
# The arm's action is no velocity. It has the names of the six joints, and asks each for a position. How to find out
# what an action is, of any robot, is [notebook 06](06_what_is_an_action.ipynb).
#
# ## Five columns for bookkeeping
#
# Every LeRobot dataset has these. Here is the last frame of episode 0, and the two after it.

# %%
columns = ["timestamp", "frame_index", "episode_index", "index", "task_index"]
print(*columns)
for row in read_rows(z2r.STANDIN, columns)[66:69]:
    print(*(f"{row[name]:{len(name)}.3g}" for name in columns))

# %% [markdown]
# `timestamp` counts seconds and `frame_index` counts frames, and both begin again with each episode. `index` counts
# on through the whole dataset. `task_index` is the number of a sentence, stored once, in a table of its own. The arm
# has two.

# %%
for row in pq.ParquetFile(z2r.ARM / "meta/tasks.parquet").read().to_pylist():
    print(row["task_index"], row["task"])

# %% [markdown]
# ## What is not there
#
# Did a demonstration succeed? Ask both schemas.

# %%
features = [*info["features"], *arm_info["features"]]
for word in ("success", "reward", "done"):
    found = [name for name in features if word in name]
    print(f"{word}: {found or 'nothing'}")

# %% [markdown]
# The format has room for such a feature and does not ask for one. [Notebook 04](04_hidden_success.ipynb) gets the
# answer out of the numbers that are there.
#
# ## Is that what LeRobot reads?
#
# LeRobot's own reader is made for training: it brings PyTorch, and takes some seconds to load. Where it is not
# installed, the cell says so.

# %% tags=["record"]
if importlib.util.find_spec("lerobot"):
    os.environ["HF_HUB_OFFLINE"] = "1"  # everything is here: ask no server
    warnings.filterwarnings("ignore", "IProgress")  # it draws no progress bars
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    other = LeRobotDataset("z2r/arm", root=z2r.ARM, video_backend="pyav")
    picture = other[0]["observation.images.front"]
    print("frames:  ", other.num_frames == arm.schema.total_frames)
    print("features:", [*other.features] == [*arm.schema.features])
    print("shape of a picture:", tuple(picture.shape))
else:
    print("LeRobot is not installed here")

# %% [markdown]
# It agrees with us. Only its pictures have another shape: the three colours come first.
#
# ## Names, not column numbers
#
# The block's sine is in column 4, counted from 0. So `state[:, 4]` gets it, and many people write just that. Now
# suppose that somebody records the same ten numbers, but sorts their names alphabetically. Who is in column 4 then?

# %%
for name in (names[4], sorted(names)[4]):
    values = state[:, names.index(name)]
    print(f"{name:15}from {values.min():5.2f} to {values.max():5.2f}")

# %% [markdown]
# The sine of the *target*. It is a `float32` between -1 and 1, as the other one is. But it is 0 in every frame, and
# so the block would never seem to turn. Ask the schema instead: you give names, and it gives their columns in this
# dataset. A name that is not there is an error. A wrong column number would have given numbers.

# %%
schema = dataset.schema
print(schema.columns("observation.state", ["tee_y"]))
print(schema.columns("observation.state", ["sin_tee_yaw", "cos_tee_yaw"]))
try:
    schema.columns("observation.state", ["tee_z"])
except ValueError as error:
    print(error)

# %% [markdown]
# ## Practice (about 4 min)
#
# **Complete the line.** `values_of` gets the state, a schema, and a name such as `"tee_x"`. Return the values of that
# dimension, one number for each frame. It is tried on this dataset, and on others with their columns in other places.


# %% tags=["exercise", "values-of"]
def values_of(state, schema, name):
    return ...


practice.check_values_of(values_of)

# %% [markdown]
# <details><summary>Hint</summary>
#
# `schema.columns` takes a list and returns a list. You want its one element, as a column of `state`.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def values_of(state, schema, name):
#     [column] = schema.columns("observation.state", [name])
#     return state[:, column]
# ```
#
# </details>

# %% [markdown]
# **Bug hunt.** This should return x and y of the block. A friend wrote it for another dataset, and there it was
# right. Here it runs too, and gives two numbers for each frame. Make it right for any dataset that has the names.


# %% tags=["exercise", "block-position"]
def block_position(state, schema):
    return state[:, 4:6]


practice.check_block_position(block_position)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Which two names does the block's position have? `schema.columns` takes both at once.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def block_position(state, schema):
#     x_and_y = schema.columns("observation.state", ["tee_x", "tee_y"])
#     return state[:, x_and_y]
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **find** the schema in `meta/info.json`, the frames in `data`, and what the cameras saw in `videos`;
# - **read** the schema: dtype, shape and names of each feature, and no units;
# - **name** every number of a frame: seen before the step, done in it, and five for bookkeeping. No success;
# - **pick** numbers by name: `schema.columns("observation.state", ["tee_x", "tee_y"])`.
#
# Next: [Where does one demonstration end?](02_episode_index.ipynb) finds the seams, in the table and in the film.
