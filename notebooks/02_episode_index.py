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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/02_episode_index.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # Where does one demonstration end?
#
# You recorded six demonstrations, and the file is one long table. Between the end of one demonstration and the
# start of the next, the block was put back somewhere else, and nobody recorded that. A policy that is trained
# across such a gap learns that the block can leap. The *episode index* says where the gaps are. On this page you
# read it, check it, and then see what happens without it.
#
# **By the end you can**
#
# - **read** the episode index of a LeRobot dataset, and say how long each demonstration is;
# - **cut** one demonstration out of all the frames, without a frame too many;
# - **check** that the index and the frames tell the same story;
# - **recognise** what somebody sees who ignores the index.
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
import shutil
import warnings
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import z2r
from z2r.course import figures
from z2r.course.exercises import episodes as practice
from z2r.course.source import show_source

# %% [markdown]
# What you need to know: a *frame* is one moment, and holds what the robot saw and what it then did. An *episode* is
# one demonstration, from its first frame to its last. In `standin`, the dataset that comes with the package, a disc
# shoves a T-shaped block onto a target, six times. `tee_x` and `tee_y` say where the block is, in metres.
#
# ## All frames lie one after another
#
# Open the file of the frames, and count its rows.

# %%
frames = pq.ParquetFile(z2r.STANDIN / "data/chunk-000/file-000.parquet").read()
print(frames.num_rows, "frames")

# %% [markdown]
# Now look at five of them: their number in the dataset, their bookkeeping, and the block's y. The schema in
# `meta/info.json` says which of the ten numbers of the state `tee_y` is.

# %%
info = json.loads((z2r.STANDIN / "meta/info.json").read_text())
place = info["features"]["observation.state"]["names"].index("tee_y")
print("index  episode_index  frame_index  tee_y")
for row in frames.slice(64, 5).to_pylist():
    tee_y = row["observation.state"][place]
    print(f"{row['index']:5}{row['episode_index']:15}{row['frame_index']:13}{tee_y:7.3f}")

# %% [markdown]
# Nothing separates row 66 from row 67. But `frame_index` begins again at 0, and the block is somewhere else. One
# demonstration ended, and the next began.
#
# ## The index has one row for each episode
#
# The folder `meta/episodes` holds a second table. Four of its columns are the index.

# %%
columns = ["episode_index", "length", "dataset_from_index", "dataset_to_index"]
shard = pq.ParquetFile(z2r.STANDIN / "meta/episodes/chunk-000/file-000.parquet")
index = shard.read(columns=columns).to_pylist()
print(*columns)
for row in index:
    print(*(f"{row[name]:{len(name)}}" for name in columns))

# %% [markdown]
# Read the second row: episode 1 has 74 frames, from 67 to 141. Now count. From 67 to 141, both included, there
# would be 75. So one of the two does not belong to the episode.

# %%
start, stop = index[1]["dataset_from_index"], index[1]["dataset_to_index"]
print(f"first frame {start}, last frame {stop - 1}, {stop - start} frames")

# %% [markdown]
# **`from` is included, `to` is not.** The frame at `to` is already the first of the next episode. Such a range is
# called *half-open*, and it is practical: the end of one episode is the start of the next, nothing has to be added
# or taken away to get a length, and Python's slices work the same way.
#
# **Complete the line.** `episode_length` is given the two numbers of a range and should return how many frames it
# has. Replace the three dots. The check also tries it on whole columns of numbers, as numpy arrays.


# %% tags=["exercise", "episode-length"]
def episode_length(from_index, to_index):
    return ...


practice.check_episode_length(episode_length)

# %% [markdown]
# ## A slice cuts an episode out
#
# `z2r.load` reads the same rows into `dataset.episodes`. Ask it for an episode, and you get a slice.

# %%
dataset = z2r.load(z2r.STANDIN)
print(dataset.episodes[2])

# %% [markdown]
# A slice cuts any array that has a row for every frame. Here it cuts the states of episode 2 out of all states: 76
# rows of 427.

# %%
state = dataset.read("observation.state")
print(state.shape, "->", state[dataset.episodes[2]].shape)

# %% [markdown]
# The whole dataset as a ribbon: one piece for each episode, as wide as it is long. Look for the longest.

# %%
figures.episode_ribbon(dataset.episodes)

# %% [markdown]
# It is episode 3, with 86 frames, and the shortest has 58. That is a tidy dataset. The package has an untidy one
# too, called `messy`, recorded with more noise. Look for pieces that are very narrow, and for pieces that are
# equally wide.

# %%
messy = z2r.load(z2r.MESSY)
figures.episode_ribbon(messy.episodes)

# %% [markdown]
# The same in numbers:

# %%
print(*messy.episodes.lengths)

# %% [markdown]
# Four episodes have fewer than 20 frames, which is less than 2 seconds. Four have exactly 120, and none has more. That
# looks like a time limit. The command that recorded `messy` is kept beside it. Does it set a limit?

# %%
command = z2r.read_verdict(z2r.MESSY).command
print(command[command.index("max_steps") :].strip(')"'))

# %% [markdown]
# It does: the recorder was told to stop after 120 frames, done or not. Lengths are the first thing to look at in a
# dataset, and they cost nothing.
#
# **Bug hunt.** `cut` should return the frames of one episode. It runs, it returns an array, and its length looks
# about right. Yet for most episodes, one frame in it is foreign. Find out which, and fix the function. `frames`
# can be any array with a row for every frame, and `index` is `dataset.episodes`. The check hands it the numbers 0
# to 426 as frames, so that you can read from the answer which ones you cut out. Where your answer ends in another
# episode, the check draws the block in its last frame.


# %% tags=["exercise", "cut"]
def cut(frames, index, episode):
    start, stop = index.from_index[episode], index.to_index[episode]
    return frames[start : stop + 1]


practice.check_cut(cut)

# %% [markdown]
# ## One story, told three times
#
# The ranges are one way to say where an episode begins. A dataset says it twice more. Every frame carries the
# number of its episode, so an episode begins where that number changes. And every episode has a length, so it
# begins where the lengths before it end. Do the three agree?

# %%
number = np.array(frames["episode_index"].to_pylist())
length = np.array([row["length"] for row in index])
print("the ranges say:   ", *(row["dataset_from_index"] for row in index[1:]))
print("the frames say:   ", *np.flatnonzero(np.diff(number)) + 1)
print("the lengths say:  ", *np.cumsum(length)[:-1])

# %% [markdown]
# They do. And the sum of all lengths is what the schema, `meta/info.json`, promises.

# %%
print(length.sum(), info["total_frames"])

# %% [markdown]
# Why store it three times? Because when they disagree, something is broken: a recording crashed, or somebody edited
# the dataset with a script of their own. `z2r.load` compares ranges, lengths and totals each time. It does not
# open the frames for that, so the second story is yours to check.
#
# Break a range and see. In this copy of the dataset, episode 1 ends at 142 in place of 141.

# %%
broken = Path(shutil.copytree(z2r.STANDIN, "z2r-out/broken", dirs_exist_ok=True))
rows = shard.read().to_pylist()
rows[1]["dataset_to_index"] = 142
table = pa.Table.from_pylist(rows, schema=shard.schema_arrow)
pq.write_table(table, broken / "meta/episodes/chunk-000/file-000.parquet")

# %%
try:
    z2r.load(broken)
except z2r.DatasetError as error:
    print(error)

# %% [markdown]
# One line that names the folder and the field, what was found, and what was expected. Episode 2 begins at 141, but
# episode 1 ends at 142 now: frame 141 would belong to both.
#
# LeRobot has a reader of its own, `LeRobotDataset`. It brings PyTorch and takes some seconds to load. If it is not
# installed where you are, the cell leaves it out. Does it have the same ends for the six episodes?

# %% tags=["record"]
by_hand = [row["dataset_to_index"] for row in index]
ends = {"by hand": by_hand, "z2r": dataset.episodes.to_index}
if importlib.util.find_spec("lerobot"):
    os.environ["HF_HUB_OFFLINE"] = "1"  # everything is here: ask no server
    warnings.filterwarnings("ignore", "IProgress")  # it draws no progress bars
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    other = LeRobotDataset("z2r/standin", root=z2r.STANDIN, video_backend="pyav")
    ends["LeRobotDataset"] = list(other.meta.episodes["dataset_to_index"])
for reader, numbers in ends.items():
    print(f"{reader:16}", *numbers)

# %% [markdown]
# ## Without the index
#
# What if somebody does not read the index, and takes all frames for one long demonstration? Measure how far the
# block moves from each frame to the next. Keep the steps inside an episode apart from those that cross from one
# episode into the next.


# %%
def block_steps(dataset):
    x_and_y = dataset.schema.columns("observation.state", ["tee_x", "tee_y"])
    moved = np.diff(dataset.read("observation.state")[:, x_and_y], axis=0)
    crossing = dataset.episodes.to_index[:-1] - 1
    steps = np.hypot(moved[:, 0], moved[:, 1])
    return np.delete(steps, crossing), steps[crossing]


# %% [markdown]
# `crossing` holds the last frame of every episode but the last one: the steps that begin there lead into another
# episode. `np.delete` returns all other steps.

# %%
inside, across = block_steps(dataset)
print(f"inside an episode, at most {inside.max():.3f} m")
print("from one to the next:     ", *(f"{step:.3f}" for step in across))

# %% [markdown]
# Inside an episode the block never moves more than 3 cm in a tenth of a second. From frame 66 to frame 67 it leaps
# by 20 cm. No block does that, and no policy should learn it.
#
# Then the leaps give the ends away, one could say, and the index is not needed. Here they do. Try the untidy
# dataset, and look at its three smallest leaps.

# %%
inside, across = block_steps(messy)
print(f"inside an episode, at most {inside.max():.3f} m")
print("from one to the next:     ", *(f"{step:.3f}" for step in sorted(across)[:3]), "and more")

# %% [markdown]
# The largest honest step is 4.2 cm, and the smallest leap is 5.2 cm. A limit of 10 cm, which is safe in the first
# dataset, misses two of the 13 ends. Do not guess where an episode ends. The index knows.
#
# **Predict, then run.** The last frame of an episode shows whether the block has *reached* the target. Here is how
# `messy` ended, read with the index. (How this is read is the question of [notebook 04](04_hidden_success.ipynb).)

# %%
reached = z2r.inspect_dataset(messy).outcome.reached
figures.episode_ribbon(messy.episodes, reached)

# %% [markdown]
# 11 of 14 reached it, which is a share of 0.79. (Pieces 11, 12 and 13, at the right end, are too narrow for their
# numbers. All three are in the upper row.) Now suppose that somebody ignores the index and takes all 1,108 frames for
# one recording. Write two numbers in brackets: how many episodes there are for them, and which share of these they
# read as reached, from 0 to 1. For somebody who reads the index, it would be `prediction = (14, 0.79)`. Put your two
# numbers in place of `None`.

# %% tags=["exercise", "without-the-index"]
prediction = None
practice.check_without_index(prediction, messy)

# %% [markdown]
# `z2r` can ignore the index on purpose. It calls such a wrong assumption a *break mode*, and this one
# `drop-boundaries`. [Notebook 06](07_break_modes.ipynb) has more of them.

# %%
wrong = z2r.break_mode("drop-boundaries").dataset(dataset).episodes
print(len(dataset.episodes), "episodes read right,", len(wrong), "read wrong:", wrong[0])

# %% [markdown]
# This is the class behind `dataset.episodes`. You know most of it by now: two columns of numbers, and what follows
# from them. (The third, `numbers`, is there for a dataset of which some episodes are left out.) Its last function,
# `merged`, is what `drop-boundaries` uses. The line above the source is its address
# in the package and its fingerprint.

# %%
show_source(z2r.EpisodeIndex)

# %% [markdown]
# ## Many files
#
# Six episodes fit into one file. A large dataset has many, for its frames and for its index. So each row of the
# index also says in which file the frames of its episode are. `z2r` has put that together.

# %%
for file in dataset.files:
    print(file.path.name, "holds the frames from", file.from_index, "to", file.to_index)

# %% [markdown]
# Half-open again. Where there are many files, they have to be read in their order. Their numbers are padded with
# zeros to three digits, so sorting by name works, up to a point.

# %%
files = [f"file-{number:03d}.parquet" for number in (8, 999, 1000)]
print("by name:  ", *sorted(files))
print("by number:", *sorted(files, key=lambda name: int(Path(name).stem.split("-")[1])))

# %% [markdown]
# By name, file 1000 comes before file 999. It takes more than a thousand files in one folder to see that, so a
# script with this mistake works for a long time. `z2r` sorts by number.
#
# ## You can now
#
# - **read** the episode index: one row for each episode, `dataset_from_index` included, `dataset_to_index` not;
# - **cut** one demonstration out of all the frames: `state[dataset.episodes[2]]`;
# - **check** that ranges, frames and lengths tell the same story, as `z2r.load` does for ranges, lengths and
#   totals;
# - **recognise** what somebody sees who ignores the index: one episode, a block that leaps, and a share of 0 or 1.
#
# Next: [Which way is the block pointing?](03_atan2_decoding.ipynb) turns a sine and a cosine back into an angle.
