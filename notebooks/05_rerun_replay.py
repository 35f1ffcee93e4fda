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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/05_rerun_replay.ipynb)
# About 20 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # What did it look like?
#
# Somebody collected demonstrations with two simulated arms, and converted them to LeRobot's format. All numbers were
# right, and so was the film of the camera on the head. The camera on the wrist [looked the wrong
# way](https://github.com/RoboTwin-Platform/RoboTwin/issues/104). No number says such a thing. They saw it because
# they looked, and it was mended on the same day.
#
# So look. For this there is *Rerun*, a free viewer for robot data.
#
# **By the end you can**
#
# - **say** what a recording is made of: entities, components and timelines;
# - **write** one, by hand and with `z2r`;
# - **find** the picture that belongs to a frame;
# - **watch** an episode and tell its story.
#
# To move the film yourself, you also need a browser.

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
from collections import Counter
from pathlib import Path

import numpy as np
import rerun as rr
from IPython.display import Image
from rerun.chunk import RrdReader

import z2r
from z2r.course import moving
from z2r.course.exercises import replay as practice
from z2r.course.hunts import grip as hunt
from z2r.data import ARM_STILL

# %% [markdown]
# ## By hand
#
# The viewer shows *recordings*, files that end in `.rrd`. An **entity** is a thing, with a name like a path. A
# **component** is something that it has: a position, a colour. A **timeline** says when.
#
# The path of the block is one entity with one component, a point for each frame. The table is flat, so z is 0.

# %%
dataset = z2r.load(z2r.STANDIN)
first = dataset.read("observation.state")[dataset.episodes[0]]
decoded = z2r.decode(first, z2r.PUSHT, dataset.schema)
block = decoded.pose("tee")
points = np.stack([block.x, block.y, np.zeros(len(first))], axis=1)
seconds = np.arange(len(first)) / dataset.schema.fps
print(points.shape, "points, from", seconds[0], "to", seconds[-1], "s")

# %%
out = Path("z2r-out")
out.mkdir(exist_ok=True)
by_hand = rr.RecordingStream("by-hand")
by_hand.save(out / "by_hand.rrd")
time = rr.TimeColumn("sim_time", duration=seconds)
positions = rr.Points3D.columns(positions=points)
by_hand.send_columns("block", indexes=[time], columns=positions)
by_hand.flush()
by_hand.disconnect()

# %% [markdown]
# `send_columns` sends the whole array at once. A recording is not only for watching: it can be read back, in tables
# that are called *chunks*. Names that begin with `__` are rerun's own.


# %%
def rows_of(file):
    rows = Counter()
    for chunk in RrdReader(out / file).stream():
        if not chunk.entity_path.startswith("/__"):
            rows[chunk.entity_path] += chunk.to_record_batch().num_rows
    return rows


print(dict(rows_of("by_hand.rrd")))

# %% [markdown]
# **Complete the line.** On the timeline `sim_time`, all episodes lie one after another. Given the number of a frame,
# from 0 over the whole dataset, and the frames a second: at which second is it shown?


# %% tags=["exercise", "sim-time"]
def sim_time(frame, fps):
    return ...


practice.check_sim_time(sim_time)

# %% [markdown]
# <details><summary>Hint</summary>
#
# At 10 frames a second, frame 10 is shown at 1 s.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def sim_time(frame, fps):
#     return frame / fps
# ```
#
# </details>

# %% [markdown]
# ## The arm, with its cameras
#
# `z2r.write_replay` sends everything there is to see. Of the arm, that is the film of two cameras, each joint with
# its command, and the task in words. Here is its first episode.

# %%
arm = z2r.load(z2r.ARM)
replay = z2r.write_replay(arm, out / "arm.rrd", episode=0)
print(replay.n_frames, "frames of", replay.n_episodes, "episode")
rows = rows_of("arm.rrd")
for entity in ("/cameras/front", "/cameras/side"):
    print(f"{entity:15} {rows[entity]} rows")

# %% [markdown]
# A row for each frame, and nothing was decoded: the mp4 went into the recording as it lies on disk, and each row
# names a moment of it.
#
# To open it on your own machine, type `rerun z2r-out/arm.rrd` in a terminal. If you have none, drop the file onto
# [rerun.io/viewer](https://rerun.io/viewer). In Colab, download it first: the folder symbol on the left, then
# `z2r-out`. This is what you see.

# %%
Image(ARM_STILL.read_bytes())

# %% [markdown]
# The white lines mark 2.2 s. Each joint has a plot: the thin line is what it was told, the thick one is where it was.
# Look at the gripper, at the bottom right. It was told to close to 20 percent, and it stays at 30. There is a cube
# between its jaws.
#
# **Bug hunt.** All episodes of a camera lie in one film, and the index says at which second an episode begins there.
# Somebody's viewer shows the arm of episode 0, whichever episode you pick. This is how it finds the picture of a
# frame, which is counted from the start of its episode.


# %% tags=["exercise", "video-time"]
def video_time(frame_index, from_timestamp, fps):
    return frame_index / fps


practice.check_video_time(video_time)

# %% [markdown]
# <details><summary>Hint</summary>
#
# One of the three arguments is never used.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def video_time(frame_index, from_timestamp, fps):
#     return from_timestamp + frame_index / fps
# ```
#
# </details>

# %% [markdown]
# ## Read it like a story
#
# The pusher has no camera. But its dataset holds all positions, so the film can be made afterwards: the block and the
# target as boxes, the pusher, their paths, and how far the block is from the target.

# %%
replay = z2r.write_replay(dataset, out / "replay.rrd", z2r.PUSHT)
print(replay.n_frames, "frames of", replay.n_episodes, "episodes")

# %% [markdown]
# What happens in episode 0? The pusher pushes whenever the block moves, so find when moving begins and when it ends.

# %%
moves = np.hypot(np.diff(block.x), np.diff(block.y)) > 0.001  # 1 mm
begins = np.flatnonzero(~moves[:-1] & moves[1:]) + 1
ends = np.flatnonzero(moves[:-1] & ~moves[1:]) + 1
errors = z2r.frame_errors(decoded)
distance, turn = 1000 * errors["pos_err"], errors["ang_err"]
for a, b in zip(begins, ends, strict=True):
    print(f"{a / 10:.1f} to {b / 10:.1f} s:", end=" ")
    print(f"{distance[a]:3.0f} to {distance[b]:2.0f} mm,", end=" ")
    print(f"{turn[a]:.2f} to {turn[b]:.2f} rad")

# %% [markdown]
# Three pushes, and a story. For 2.4 s nothing happens: the pusher walks around the block to a side where it can push.
# The first push brings the block near, and turns it. The second turns it further, but pushes it **away**, from 48 to
# 80 mm. It gave up distance to win angle. The third does both, and ends at 15 mm and 0.10 rad, in tolerance. The last
# frame alone would never have told you.
#
# Here it is as a film, with its captions.

# %%
moving.story(dataset, 0)

# %% [markdown]
# ## Replay it wrong
#
# A recording shows the dataset *as a reading has it*. A wrong reading makes a wrong film, and often you see at once
# that it is wrong. Write the same episodes again, with the sine and the cosine of the block's yaw swapped.

# %%
swapped = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
replay = z2r.write_replay(dataset, out / "yaw_swap.rrd", swapped)
print(replay.n_frames, "frames of", replay.n_episodes, "episodes")

# %% [markdown]
# **Predict, then run.** What is the same for the block in both recordings? Put `"position"`, `"yaw"`, `"both"` or
# `"neither"` in place of `None`.

# %% tags=["exercise", "same-rows"]
prediction = None
practice.predict_same_rows(prediction)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Which columns does the swap touch?
#
# </details>

# %% [markdown]
# In the viewer, watch the block while the pusher shoves it. Where the real one turns to the left, the swapped one
# turns to the right, and the pusher goes through it.

# %% [markdown]
# ### Hunt: did it grip? (about 9 min)
#
# On a real desk, nobody records where the cube is. But the gripper knows. Told to close, it stops on what is between
# its jaws, and the joint stays away from its command.
#
# **Write it.** `gripped` gets both, in percent open, 30 frames a second. It returns the frame in which the jaws first
# had something between them that they kept, or `None`. Up to four frames off is right. Beware: a motion comes later
# than its command, some jaws never close all the way, some things are thin, and some slip out at once. It is tried on
# 18 episodes. `hunt.examples()` has others: `told, seen = hunt.examples()[0].args`.


# %% tags=["exercise", "hunt"]
def gripped(told, seen):
    return ...


hunt.score(gripped)

# %% [markdown]
# <details><summary>Hint</summary>
#
# While they close, `seen` is above `told` as well, for it is late. What is different once they hold something? They
# stand still, and go on standing still.
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def gripped(told, seen):
#     wider = seen > told + 5  # percent: more than jaws that are never exact
#     for frame in range(len(seen) - 12):
#         soon = slice(frame, frame + 12)  # 0.4 s: longer than any delay
#         if wider[soon].all() and np.ptp(seen[soon]) < 2:
#             return frame
#     return None
# ```
#
# </details>

# %% [markdown]
# ## You can now
#
# - **say** what a recording is made of: entities such as `/cameras/front`, their components, and a timeline;
# - **write** one: `send_columns` by hand, or `z2r.write_replay`;
# - **find** a picture: `from_timestamp + frame_index / fps` in the film of the camera;
# - **watch** an episode: where the block moves, the pusher pushes.
#
# Next: [What is an action?](06_what_is_an_action.ipynb) In the plots of the arm, its joints follow their commands. It
# asks how late, and finds out what was commanded.

# %% [markdown] tags=["replies"]
# <details><summary>One saved run: what the checkers reply</summary>
#
# **sim-time: ten is typed in**
#
# ```text
# not yet: for frame 90 at 30 frames a second, expected 3 and got 9. Frame 0 is
#     shown at 0 s. At 10 frames a second, how many seconds is one frame?
# ```
#
# **sim-time: a right answer**
#
# ```text
# right: all 5 trials agree with z2r.
# ```
#
# **video-time: the start alone**
#
# ```text
# not yet: for frame 100 of episode 1 at 30 frames a second, expected 7.633 and
#     got 4.3. Count from where the episode begins in the film.
# ```
#
# **video-time: a right answer**
#
# ```text
# right: all 5 trials agree with z2r.
# ```
#
# **same-rows: the yaw**
#
# ```text
# not yet: you said 'yaw', it is position. The swap exchanges the sine and the
#     cosine of the yaw. It does not touch x and y.
# Another one: Somebody ignores where episodes end, which is drop-boundaries, and
#     writes the replay. What of the block is the same, frame by frame? Add your
#     answer to the call, as again=..., and run the cell again.
# ```
#
# **same-rows: a right answer**
#
# ```text
# right: it is position. The swap exchanges the sine and the cosine of the yaw. It
#     does not touch x and y.
# ```
#
# **hunt: as soon as it is beside**
#
# ```text
# not yet: 77 of 100 points. Right: 14, missed: 2, false alarms: 2.
#     nothing, with jaws that always stop a little too wide (2 of 2): you said 0,
#         it is None
#     a cube, with jaws that always stop a little too wide (2 of 2): you said 0,
#         it is 70
#     Jaws that stop before the place where they are sent are held open. A command
#         also takes time to arrive.
# ```
#
# **hunt: a right answer**
#
# ```text
# right: 18 of 18, nothing missed, no false alarm. For another hunt, add seed=1 to
#     the call.
# ```
#
# </details>
