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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/02_episode_index.ipynb)
# About 25 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # Where does one demonstration end?
#
# A team trained the same network twice, on the same demonstrations. Once they were stored in version 2 of LeRobot's
# format, a file for each episode, and once in version 3, where many episodes share a file. The second policy was much
# worse. [The reason](https://github.com/starVLA/starVLA/pull/285) was one number: to find the film of an episode, the
# loader took the number of its data file. The numbers were fine, and the pictures were those of another
# demonstration.
#
# In version 3 all demonstrations lie one after another, in the table and in the film. The *episode index* says where
# each begins and ends.
#
# **By the end you can**
#
# - **read** the episode index, and say how long each demonstration is;
# - **cut** one demonstration out of the table, and find it in the film, without an extra frame;
# - **check** that the index and the frames tell the same story;
# - **recognise** what somebody sees who ignores the index.

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
import pyarrow.parquet as pq

import z2r
from z2r.course import figures, moving
from z2r.course.exercises import episodes as practice
from z2r.course.hunts import seams as hunt

# %% [markdown]
# ## The seam in the table
#
# Here are five rows of `standin`. `tee_y` is where the T-shaped block is, in metres.

# %%
dataset = z2r.load(z2r.STANDIN)
[tee_y] = dataset.schema.columns("observation.state", ["tee_y"])
path = z2r.STANDIN / "data/chunk-000/file-000.parquet"
frames = pq.ParquetFile(path).read()
print("index  episode_index  frame_index   tee_y")
for row in frames.slice(64, 5).to_pylist():
    print(f"{row['index']:5}{row['episode_index']:15}", end="")
    print(f"{row['frame_index']:13}{row['observation.state'][tee_y]:8.3f}")

# %% [markdown]
# Nothing separates row 66 from row 67. But `frame_index` begins again at 0, and the block is somewhere else. Between
# the two, somebody put it back, and nobody recorded that. This is a *seam*.
#
# ## The index has one row for each episode
#
# It is a table of its own, in `meta/episodes`.

# %%
columns = ["episode_index", "length", "dataset_from_index", "dataset_to_index"]
path = z2r.STANDIN / "meta/episodes/chunk-000/file-000.parquet"
index = pq.ParquetFile(path).read(columns=columns).to_pylist()
print(*columns)
for row in index:
    print(*(f"{row[name]:{len(name)}}" for name in columns))

# %% [markdown]
# Episode 1 has 74 frames, from 67 to 141. Count from 67 to 141, both included, and you get 75. So **`from` is
# included, `to` is not**: frame 141 is already the first of episode 2. Such a range is called *half-open*. Python's
# slices work the same way.
#
# **Complete the line.** Return how many frames a range has. It is also tried on whole columns, as numpy arrays.


# %% tags=["exercise", "episode-length"]
def episode_length(from_index, to_index):
    return ...


practice.check_episode_length(episode_length)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Try it on the first row: 0 and 67 should give 67.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def episode_length(from_index, to_index):
#     return to_index - from_index
# ```
#
# </details>

# %% [markdown]
# ## Cut one out
#
# `z2r.load` keeps the index in `dataset.episodes`. Ask it for an episode, and you get a slice. That cuts any array
# with a row for every frame.

# %%
state = dataset.read("observation.state")
print(dataset.episodes[2])
print(state.shape, "->", state[dataset.episodes[2]].shape)

# %% [markdown]
# **Bug hunt.** `cut` should return the frames of one episode. For most episodes, one frame in it belongs to another.
# Find out which, and mend it. Here `index` is `dataset.episodes`, not the list above. The check hands over the
# numbers 0 to 426 as frames, so you can read from the answer what was cut out.


# %% tags=["exercise", "cut"]
def cut(frames, index, episode):
    start, stop = index.from_index[episode], index.to_index[episode]
    return frames[start : stop + 1]


practice.check_cut(cut)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Whose frame is the one at `stop`?
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def cut(frames, index, episode):
#     start, stop = index.from_index[episode], index.to_index[episode]
#     return frames[start:stop]
# ```
#
# </details>

# %% [markdown]
# ## Lengths tell stories
#
# `messy` is a less tidy recording of the same task. Each piece is an episode, as wide as it is long. Which ones
# strike you?

# %%
messy = z2r.load(z2r.MESSY)
print(*messy.episodes.lengths)
figures.episode_ribbon(messy.episodes)

# %% [markdown]
# Four have exactly 120 frames, and none has more, which looks like a time limit. Four have fewer than 20: less than
# two seconds. Did somebody press a key too early? Look at where the block was when they began, and by how much it had
# to turn.

# %%
short = np.flatnonzero(messy.episodes.lengths < 20)
first = messy.read("observation.state")[messy.episodes.from_index[short]]
errors = z2r.frame_errors(z2r.decode(first, z2r.PUSHT, messy.schema))
for i, pos_err, ang_err in zip(short, *errors.values(), strict=True):
    print(f"episode {i:2}: {100 * pos_err:4.1f} cm off,", end=" ")
    print(f"turned by {np.rad2deg(ang_err):3.0f} degrees")

# %% [markdown]
# Two of them began within 6 cm of the target. And all four reached it, as a picture further down shows. Nobody
# pressed a key. A short episode is a reason to look, and no reason to throw it away.
#
# ## One story, told three times
#
# Where does an episode begin? The ranges say it. So does the number in each frame, and so do the lengths, added up.

# %%
number = np.array(frames["episode_index"].to_pylist())
length = np.array([row["length"] for row in index])
print("the ranges:  ", *(row["dataset_from_index"] for row in index[1:]))
print("the frames:  ", *np.flatnonzero(np.diff(number)) + 1)
print("the lengths: ", *np.cumsum(length)[:-1])

# %% [markdown]
# Where they disagree, a recording crashed, or somebody edited the dataset with a script of their own. `z2r.load`
# compares ranges and lengths every time.
#
# ## The seam in the film
#
# The arm has two cameras, and each has one film for all 13 episodes. The index says from when to when.

# %%
arm = z2r.load(z2r.ARM)
camera = "videos/observation.images.front"
times = [f"{camera}/from_timestamp", f"{camera}/to_timestamp"]
path = z2r.ARM / "meta/episodes/chunk-000/file-000.parquet"
film = pq.ParquetFile(path).read(columns=["length", *times])
for row in film.to_pylist()[:3]:
    start, stop = row[times[0]], row[times[1]]
    print(f"{row['length']} frames, from {start:6.3f} to {stop:6.3f} s")

# %% [markdown]
# Half-open again: at 30 frames a second, 129 frames take 4.3 s, and the picture at 4.3 s belongs to the next episode.
# Here is the last frame of episode 0 and the first of episode 1, from both cameras.

# %%
figures.camera_pictures(arm, [128, 129])

# %% [markdown]
# The cube lay on the disc. A thirtieth of a second later both are somewhere else, and the arm is back where it waits.
#
# ## Without the index
#
# What if somebody takes all frames for one long demonstration? This is what the block would have done.

# %%
decoded = z2r.decode(state, z2r.PUSHT, dataset.schema)
figures.seams(decoded, dataset.episodes)

# %% [markdown]
# Five leaps. Here is the first of them, frame by frame. Drag the slider across it, to and fro.

# %%
moving.seam(dataset, 0)


# %% [markdown]
# Each leap takes a tenth of a second. Could one find the seams by their leaps, then, and do without the index?
# Keep the steps inside an episode apart from those across a seam.


# %%
def block_steps(dataset):
    state = dataset.read("observation.state")
    block = z2r.decode(state, z2r.PUSHT, dataset.schema).pose("tee")
    steps = np.hypot(np.diff(block.x), np.diff(block.y))
    seams = dataset.episodes.to_index[:-1] - 1  # the last frame before each
    return np.delete(steps, seams), steps[seams]


for name, each in (("standin", dataset), ("messy", messy)):
    inside, across = block_steps(each)
    print(f"{name:8} inside at most {inside.max():.3f} m,", end=" ")
    smallest = np.sort(across)[:3].round(3)
    print("across", *smallest, "m and more")

# %% [markdown]
# In `standin`, a limit of 10 cm finds every seam. In `messy` it misses two of 13: the block was put back 5.2 cm from
# where it lay, and a push moves it by up to 4.2. Do not guess where an episode ends. The index knows.
#
# **Predict, then run.** The last frame of an episode shows whether the block *reached* the target. Read with the
# index, it looks like this.

# %%
reached = z2r.inspect_dataset(messy).outcome.reached
figures.episode_ribbon(messy.episodes, reached)

# %% [markdown]
# Now somebody ignores the index. How many episodes do they see, and which share of them reached the target, from 0 to
# 1? Put both in place of `None`. Whoever reads the index would write `(14, 0.79)`.

# %% tags=["exercise", "without-the-index"]
prediction = None
practice.check_without_index(prediction, messy)

# %% [markdown]
# <details><summary>Hint</summary>
#
# They ask the last frame, and there is only one last frame left. Is the last piece in the picture in the upper row?
#
# </details>

# %% [markdown]
# `z2r` can ignore the index on purpose. This break mode is called `drop-boundaries`.

# %%
wrong = z2r.break_mode("drop-boundaries").dataset(messy).episodes
print(len(messy.episodes), "episodes read right")
print(len(wrong), "read wrong:", wrong[0])

# %% [markdown]
# ### Hunt: the index is lost (about 9 min)
#
# The index knows where an episode ends. And if the index is gone? Eight recordings lie before you without one:
# pushers and arms, in metres, millimetres, degrees and radians. Now and then an encoder, the sensor of a joint, drops
# out for a frame. Each seam is a clear one: some number leaps four times as far as it ever goes in a step, drop-outs
# apart.
#
# **Write a check.** `find_starts` gets the state, a row for each frame, and returns the numbers of the frames with
# which an episode begins, all but the first. It is scored on recordings that are not on this page. What you miss
# costs, and so does a false seam. `hunt.examples()` returns others of the same kinds, to look at: `.args[0]` is
# the state, `.truth` what is right.


# %% tags=["exercise", "hunt"]
def find_starts(state):
    return ...


hunt.score(find_starts)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Ten centimetres are a long way for a block, and nothing for a joint in degrees. What is a long way for *this*
# column? And a drop-out leaps twice: there and back.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def find_starts(state):
#     steps = np.abs(np.diff(state, axis=0))
#     usual = np.quantile(steps, 0.99, axis=0)  # of each column
#     far = (steps > 3 * usual).any(axis=1)  # step k leads to frame k + 1
#     alone = far[1:-1] & ~far[:-2] & ~far[2:]  # a drop-out leaps there and back
#     return np.flatnonzero(alone) + 2
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **read** the index: a row for each episode, `from` included, `to` not;
# - **cut** an episode out: `state[dataset.episodes[2]]`, and in the film from `from_timestamp` to `to_timestamp`;
# - **check** that ranges, frames and lengths agree, as `z2r.load` does for ranges and lengths;
# - **recognise** a missing index: one episode, a block that leaps, and a share of 0 or 1.
#
# Next: [Which way is the block pointing?](03_atan2_decoding.ipynb) makes an angle of a sine and a cosine.

# %% [markdown] tags=["replies"]
# <details><summary>One saved run: what the checkers reply</summary>
#
# **episode-length: both ends counted**
#
# ```text
# not yet: for the range from 67 to 141, expected 74 and got 75. The first number
#     is the first frame of the episode; the second is not a frame of it any more.
# ```
#
# **episode-length: a right answer**
#
# ```text
# right: all 3 trials agree with z2r.
# ```
#
# **cut: the other end moved**
#
# ```text
# not yet: for the frames of episode 1, expected [ 67  68  69 ... 138 139 140] and
#     got [ 68  69  70 ... 139 140 141]. Compare your first and your last frame
#     with the range of the episode.
# ```
#
# **cut: a right answer**
#
# ```text
# right: all 4 trials agree with z2r.
# ```
#
# **without-the-index: as with the index**
#
# ```text
# not yet: you said (14, 0.79), it is (1, 1.0). All frames have become one
#     episode, and only the last frame of the dataset is asked. Read with the
#     index, 11 of 14 reached the target: 0.79.
# Another one: In a dataset of 20 episodes, 19 reached the target, and the last
#     did not. What does somebody see who ignores its index? Add your answer to
#     the call, as again=..., and run the cell again.
# ```
#
# **without-the-index: a right answer**
#
# ```text
# right: it is (1, 1.0). All frames have become one episode, and only the last
#     frame of the dataset is asked. Read with the index, 11 of 14 reached the
#     target: 0.79.
# ```
#
# **hunt: metres for everybody**
#
# ```text
# not yet: 22 of 100 points. Right: 13, missed: 14, false alarms: 31.
#     six demonstrations of pushing: 12 false
#     pushing, in millimetres: 4 missed
#     an unsteady pusher: 13 false
#     an arm, in degrees: 5 missed, 4 false
#     and 3 kinds more
#     A robot comes from somewhere. What is a long way for one column of one
#         robot, and does it stay there?
# ```
#
# **hunt: a right answer**
#
# ```text
# right: 28 of 28, nothing missed, no false alarm. For another hunt, add seed=1 to
#     the call.
# ```
#
# </details>
