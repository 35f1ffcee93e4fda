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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/05_rerun_replay.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # What did it look like?
#
# A number says that an episode reached the target. It does not say that the pusher slipped, or that it first pushed the
# block away from the target. You see that in a second when you watch it. There is no camera in this dataset, but it
# holds all positions, so the film can be made afterwards.
#
# **By the end you can**
#
# - **say** what a recording is made of: entities, components and timelines;
# - **write** a recording, by hand and with `z2r`;
# - **check** it, by reading it back and comparing it with the data;
# - **watch** an episode in the viewer and tell its story.
#
# It takes 15 minutes. You need nothing but this page. To move the film yourself, you also need a browser.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
from pathlib import Path

import numpy as np
import rerun as rr
from IPython.display import Image
from rerun.chunk import RrdReader

import z2r
from z2r.course import figures
from z2r.course.exercises import replay as practice
from z2r.data import REPLAY_STILL

# %% [markdown]
# ## What we need
#
# The dataset `standin` ships with the course. A robot, a disc called *the pusher*, shoves a T-shaped block onto a
# target. Each attempt is an *episode*. Each *frame* holds what the robot saw at one moment, ten times a second. We read
# the state of all frames, and cut out the first episode.

# %%
dataset = z2r.load(z2r.STANDIN)
state = dataset.read("observation.state")
first = state[dataset.episodes[0]]
print(len(state), "frames in all,", len(first), "in the first episode,", dataset.schema.fps, "a second")

# %% [markdown]
# A frame says where the block is: x and y in metres, and a *yaw*, the angle by which it is turned. The yaw is stored as
# its sine and cosine. `z2r.PUSHT` is the right *reading*: it says which columns those are, and that the block is called
# `tee`. `z2r.decode` reads the frames with it.

# %%
decoded = z2r.decode(first, z2r.PUSHT, dataset.schema)
block = decoded.pose("tee")
print(f"the block begins at ({block.x[0]:.3f}, {block.y[0]:.3f}) m, turned by {np.rad2deg(block.yaw[0]):.0f} degrees")

# %% [markdown]
# ## A recording by hand
#
# *Rerun* is a free viewer for robot data. It shows *recordings*, files that end in `.rrd`. Three words explain what is
# in one.
#
# An **entity** is a thing, and it has a name like a path: `world/objects/tee` is our block. A **component** is
# something that the thing has: a position, a colour, a size. A **timeline** says when: at which second the block had
# which position.
#
# So the path of the block becomes one entity with one component, a point for each frame, on one timeline. First the
# points and the seconds, as two arrays. The table is flat, so z is 0.

# %%
points = np.stack([block.x, block.y, np.zeros(len(first))], axis=1)
seconds = np.arange(len(first)) / dataset.schema.fps
print(points.shape, "points, from", seconds[0], "to", seconds[-1], "s")

# %% [markdown]
# Now the file. `save` says where it goes, `send_columns` sends the whole array in one call. There is also a way to send
# one frame at a time, `log`. It would take a loop with a call for each frame and each entity, and the file would say
# the same.

# %%
out = Path("z2r-out")
out.mkdir(exist_ok=True)
by_hand = rr.RecordingStream("by-hand")
by_hand.save(out / "by_hand.rrd")
time = rr.TimeColumn("sim_time", duration=seconds)
by_hand.send_columns("block", indexes=[time], columns=rr.Points3D.columns(positions=points))
by_hand.flush()
by_hand.disconnect()

# %% [markdown]
# Nothing opened, and nothing was printed. Is the path in the file? A recording is not only for watching: `RrdReader`
# reads it back. It comes in pieces called *chunks*, and each chunk is a small table of one entity. We skip the names
# that begin with `__`, which are rerun's own.

# %%
for chunk in RrdReader(out / "by_hand.rrd").stream():
    if not chunk.entity_path.startswith("/__"):
        table = chunk.to_record_batch()
        print(chunk.entity_path, "has", table.num_rows, "rows:", *table.schema.names[1:])


# %% [markdown]
# The entity, the timeline and the component, and as many rows as the episode has frames. In `Points3D:positions`, the
# part before the colon is the rerun type that the component belongs to. The first row on the timeline is 0 s. When is
# frame 67?
#
# ### Practice: when is it shown?
#
# **Complete the line.** All episodes lie one after another on the timeline `sim_time`. Given the number of a frame,
# counted from 0 over the whole dataset, and the frames a second, return its time in seconds. Replace the three dots.
# The check also tries datasets with other frame rates.


# %% tags=["exercise", "sim-time"]
def sim_time(frame, fps):
    return ...


practice.check_sim_time(sim_time)

# %% [markdown]
# ## A recording with z2r
#
# One point is a thin film. `write_replay` writes all that there is to see: the block and the target as boxes, the
# pusher, the paths, the action, and how far the block is from the target. It takes a dataset, a file to write, and a
# reading. It sends its columns in the same way as you just did.

# %%
replay = z2r.write_replay(dataset, out / "replay.rrd", z2r.PUSHT)
print(replay.n_frames, "frames of", replay.n_episodes, "episodes")


# %% [markdown]
# We want to compare this file with the data, so we need the rows of one component of one entity. They may lie in
# several chunks. This function collects them and sorts them by time.


# %%
def rows(file, entity, component):
    found = []
    for chunk in RrdReader(out / file).stream():
        table = chunk.to_record_batch()
        if chunk.entity_path == entity and {"sim_time", component} <= set(table.schema.names):
            found += zip(table["sim_time"].cast("int64").to_pylist(), table[component].to_pylist(), strict=True)
    return [value[0] for _, value in sorted(found)]


# %% [markdown]
# First the count. The entity `eval/pos_err` holds the distance from the block to the target. It must have one row for
# each frame of the dataset: no more, no fewer.

# %%
pos_err = rows("replay.rrd", "/eval/pos_err", "Scalars:scalars")
print("eval/pos_err:", len(pos_err), "rows. The dataset:", len(state), "frames")

# %% [markdown]
# Then the positions. The recording keeps the block's x and y as a *translation* of three numbers, x, y and z.

# %%
translation = np.array(rows("replay.rrd", "/world/objects/tee", "Transform3D:translation"))
everywhere = z2r.decode(state, z2r.PUSHT, dataset.schema).pose("tee")
apart = np.hypot(translation[:, 0] - everywhere.x, translation[:, 1] - everywhere.y)
print(f"largest difference in position: {1000 * apart.max():.3f} mm")


# %% [markdown]
# Then the yaw. In three dimensions, a thing can be turned about any axis, and rerun stores this as a *quaternion*: four
# numbers x, y, z, w. Our block only turns about the vertical axis, so x and y are 0. Then `atan2(z, w)` is not the yaw
# but **half** of it, and the next cell doubles it.


# %%
def yaw_rows(file):
    _, _, z, w = np.array(rows(file, "/world/objects/tee", "Transform3D:quaternion")).T
    return 2 * np.arctan2(z, w)


apart = np.abs(z2r.wrap_angle(yaw_rows("replay.rrd") - everywhere.yaw))
print(f"largest difference in yaw: {np.rad2deg(apart).max():.3f} degrees")


# %% [markdown]
# The recording says what the data says, in every frame.
#
# ### Practice: a block that turns too far
#
# **Bug hunt.** Somebody wrote their own function that makes a quaternion of a yaw. In their viewer, the block turns
# twice as fast as it should. Find what is wrong and fix it in the cell.


# %% tags=["exercise", "quaternion"]
def quaternion(yaw):
    return 0, 0, np.sin(yaw), np.cos(yaw)


practice.check_quaternion(quaternion)

# %% [markdown]
# ## Open it
#
# On your own machine, type `rerun z2r-out/replay.rrd` in a terminal, in the folder of this notebook. The command came
# with the package `rerun-sdk`.
#
# Without a terminal, open [rerun.io/viewer](https://rerun.io/viewer) in a browser and drop the file onto the page. In
# Colab, the file is on Google's machine, so fetch it first: the folder symbol on the left, then `z2r-out`, then the
# three dots beside `replay.rrd`, then *Download*.
#
# Here is a still of the viewer, so that you can read on without it. Look at four things. On the left is the table: the
# block is violet, the target green, the pusher red. The red line is the whole path of the pusher in this episode, the
# thin blue one that of the block. On the right are three panels; the white line in each marks the moment that the left
# side shows. The action has two curves, one for each direction. In the upper two panels, the thin green line is the
# tolerance. Below lie the episodes in a row, and what the robot was told to do.

# %%
Image(REPLAY_STILL.read_bytes())

# %% [markdown]
# This is the file that you just wrote, at 4.4 s. The traces cover all six episodes, and each ends where its episode
# does: in the top panel there are five gaps. The small step at the white line is none: it lies within the first
# episode.
#
# ## Read it like a story
#
# Stay with the first episode. Its two errors are drawn below: the distance to the target, `pos_err`, and how far the
# block is turned away from it, `ang_err`. Look for the flat parts, and for a place where one error falls while the
# other rises.

# %%
errors = z2r.frame_errors(decoded)
figures.error_traces(errors, z2r.PUSHT, dataset.schema.fps)

# %% [markdown]
# Where a trace is flat, the block rests: the pusher is on its way around it. Where it is steep, the pusher pushes. So
# each push is a run of frames in which the block moves. This cell finds the runs, and prints when each began and ended,
# and what it did.

# %%
pos_err, ang_err = errors["pos_err"], errors["ang_err"]
moving = np.hypot(np.diff(block.x), np.diff(block.y)) > 0.001  # more than 1 mm from this frame to the next
edges = np.flatnonzero(np.diff(np.concatenate([[False], moving, [False]]).astype(int)))
for start, stop in edges.reshape(-1, 2):
    print(f"{start / 10:.1f} to {stop / 10:.1f} s:", end=" ")
    print(f"distance {1000 * pos_err[start]:3.0f} to {1000 * pos_err[stop]:3.0f} mm,", end=" ")
    print(f"turned by {ang_err[start]:.2f} to {ang_err[stop]:.2f} rad")

# %% [markdown]
# Three pushes, and a story. For 2.4 s nothing happens: the pusher walks around the block to the side where it can push.
# The first push brings the block from 118 to 48 mm and turns it the right way. The second turns it further, but pushes
# it **away** from the target, back to 80 mm. That is the moment of the still. The third push does both, and ends at
# 15 mm and 0.10 rad, within the tolerances of 30 mm and 0.2 rad. The second push lost distance while it won angle. The
# final number alone would never have told you.
#
# ## Replay it wrong
#
# A recording shows the dataset *as the reading has it*. A wrong reading draws a wrong film, and often you see at once
# that it is wrong. Take `yaw-swap`: the sine and the cosine of the block's yaw are taken for each other. We write the
# same episodes again, with that reading.

# %%
swapped = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
replay = z2r.write_replay(dataset, out / "yaw_swap.rrd", swapped)
print(replay.n_frames, "frames of", replay.n_episodes, "episodes")

# %% [markdown]
# ### Practice: what stays the same?
#
# **Predict, then run.** Compare the rows of the block in the two recordings, `replay.rrd` and `yaw_swap.rrd`. What is
# the same in both? Put `"position"`, `"yaw"`, `"both"` or `"neither"` in place of `None`.

# %% tags=["exercise", "same-rows"]
prediction = None
practice.predict_same_rows(prediction)

# %% [markdown]
# Here are the yaws of four frames from both files, in degrees. Add the two in each line.

# %%
right_yaw, wrong_yaw = np.rad2deg(yaw_rows("replay.rrd")), np.rad2deg(yaw_rows("yaw_swap.rrd"))
for frame in (0, 30, 45, 66):
    print(f"frame {frame:2}: right {right_yaw[frame]:7.1f}, swapped {wrong_yaw[frame]:7.1f}")

# %% [markdown]
# The two always make 90, or 90 less a whole turn of 360. So the wrong block is not simply turned by 90 degrees. It is
# *mirrored* about the direction of 45 degrees. When the real block turns to the left, the one in the film turns to the
# right. That is what to look for.
#
# The other mistake is to forget where episodes end. `drop-boundaries` takes all frames for one episode. In the right
# recording the block has one path for each episode. How many has it now?

# %%
merged = z2r.break_mode("drop-boundaries").dataset(dataset)
z2r.write_replay(merged, out / "no_episodes.rrd", z2r.PUSHT)
for file in ("replay.rrd", "no_episodes.rrd"):
    paths = rows(file, "/world/paths/tee", "LineStrips3D:strips")
    longest = max(np.linalg.norm(np.diff(path, axis=0), axis=1).max() for path in paths)
    print(f"{file}: number of paths {len(paths)}, longest step {1000 * longest:.0f} mm")

# %% [markdown]
# One path, and a step that no block can make in a tenth of a second. Drawn from above, it is a tangle. The real path of
# the pusher wobbles. Look for five lines of it that lead straight from the middle far out, one for each seam between
# two episodes.

# %%
figures.episode_path(z2r.decode(state, z2r.PUSHT, dataset.schema))

# %% [markdown]
# Each straight line of the pusher leads from the end of an episode to the start of the next. Nothing moved along it:
# between two episodes the world was set up anew. In the viewer you would see the pusher and the block jump.
#
# ## You can now
#
# - **say** what a recording is made of: entities such as `world/objects/tee`, their components, and a timeline;
# - **write** one: `send_columns` by hand, or `z2r.write_replay`;
# - **check** it: `RrdReader` gives the rows back, one for each frame;
# - **watch** an episode: flat traces mean that the pusher walks, steep ones that it pushes.
#
# Next: [How do I know that I read it right?](07_break_modes.ipynb) shows a mistake that the share of episodes that
# reached the target does not give away, and a check that does.
