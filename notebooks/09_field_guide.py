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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/09_field_guide.ipynb)
# About 25 minutes. That is an estimate, from words, cells and exercises.

# %% [markdown]
# # What is wrong with this dataset?
#
# `file-10` comes before `file-2`. So it does wherever names are sorted, letter by letter, and a [script that wrote
# robot datasets](https://github.com/NVlabs/MobilityGen/pull/54) sorted its frames that way. All frames were there.
# Nothing raised an error. They were in other people's episodes.
#
# A broken dataset seldom says so. This page is a field guide, as there are for birds: eighteen ways in which people
# have misread one, in four kinds, each with the mark by which you know it. Nearly all were met in real code, and
# there is a link to where. Skim the tables now, and come back when something looks odd.
#
# **By the end you can**
#
# - **tell** four kinds of mistakes apart by what they change;
# - **notice** a mistake that leaves every answer as it was;
# - **find** the frame in which an episode goes wrong;
# - **say** what no audit can find.

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
import shutil
from pathlib import Path

import numpy as np

import z2r
from z2r.course import figures, moving
from z2r.course.damage import split, turn_half
from z2r.course.exercises import field_guide as practice
from z2r.course.field_guide import guide, what_changes
from z2r.course.hunts.finale import SUSPECTS, Finale

# %% [markdown]
# To have something to misread, take `messy`, fourteen attempts of the pusher. Some mistakes need many files to show,
# so make a copy with a data file for each episode. `compare` reads it right and then under some break modes, each one
# wrong belief. Its last two numbers are what remains to the target, in the median.

# %%
root = Path("z2r-out/many-files")
shutil.rmtree(root, ignore_errors=True)
dataset = z2r.load(split(z2r.MESSY, root))


def compare(dataset, *names):
    for name in (None, *names):
        read = z2r.inspect_dataset(dataset, name and z2r.break_mode(name))
        ends = read.outcome
        far, turned = map(np.median, ends.final_errors.values())
        n, n_frames = len(read.episodes), read.episodes.n_frames
        print(f"{name or 'read right':22} {n:2} episodes", end="")
        print(f" {n_frames:5} frames {ends.n_reached:3} reached", end="")
        print(f" {1000 * far:4.0f} mm {turned:5.2f} rad")


# %% [markdown]
# ## First kind: what the numbers mean
#
# Frames, lengths and files are right. What is said of them is not.

# %%
guide("what the numbers mean")

# %%
compare(dataset, *practice.CHOICES, "no-wrap")

# %% [markdown]
# `wrong-reference-point` asks how far the *pusher* is from the target. Beside the block, it never gets there. That
# was real: [a simulator](https://github.com/huggingface/gym-xarm/pull/14) measured from the wrong point, and said
# *failed* while the cube was in the air. `degrees-for-radians` has the same errors to the last digit, and hardly
# anything is good enough. `joints-exchanged`, which was made for arms, gives the pusher its *y* for its *x*; where
# the block is stays right. The last two lines are those of the right reading.
#
# ### Practice: who notices? (about 2 min)
#
# **Predict, then run.** Each of the four wrong readings is audited. For three, some check finds something odd. For
# one, none does. Which? Put its name in place of `None`, in quotes: `wrong-reference-point`, `degrees-for-radians`,
# `first-frame-for-last` or `joints-exchanged`.

# %% tags=["exercise", "predict-unnoticed"]
prediction = None
practice.predict_unnoticed(root, prediction)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Which of them is about what *you* want, and not about what happened?
#
# </details>
# <details><summary>Solution</summary>
#
# `prediction = "degrees-for-radians"`
#
# </details>

# %% [markdown]
# And `no-wrap`? Its line is the right one. It subtracts two angles and never takes off a whole turn.
# While the target points to 0, that never matters. Walk around the table, so that it points to 180°. Nothing has
# happened to the block.

# %%
turned = Path("z2r-out/turned")
shutil.rmtree(turned, ignore_errors=True)
shutil.copytree(root, turned)
turn_half(turned)
compare(z2r.load(turned), "no-wrap")

# %% [markdown]
# Three fewer are *read* as reached, and no block has moved. The mistake was *dormant*: it slept, until the data gave
# it a chance. This is why code that worked on one dataset proves little about the next.
#
# ## Second kind: the index
#
# Every number is right. Where one episode ends is not.

# %%
guide("the index")

# %%
few_files = Path("z2r-out/few-files")
shutil.rmtree(few_files, ignore_errors=True)
few = z2r.load(split(z2r.MESSY, few_files, episodes_per_file=5))
compare(few, "inclusive-end", "first-shard-only", "stale-file-pointer")

# %% [markdown]
# In this copy five episodes share a data file, and as many a file of the index. `inclusive-end` has 13 frames too
# many, one for each episode but the last. Harmless? *Reached* is read from the last frame, and that one now belongs
# to somebody else. The other two are worse: episodes are gone, and what is left is perfect. (A *shard* is one of
# several files that hold one table.) You only notice if you remember how many episodes there were.
#
# ### Practice: leaps inside episodes (about 2 min)
#
# **Bug hunt.** A block cannot leap. This function should return the longest step that it makes inside each episode.
# On a dataset that is whole, it reports a leap in every episode but the last. It is not the data.


# %% tags=["exercise", "longest-steps"]
def longest_steps(x, y, episodes):
    steps = np.hypot(np.diff(x), np.diff(y))
    parts = zip(episodes.from_index, episodes.to_index, strict=True)
    return [steps[start:stop].max() for start, stop in parts]


practice.check_longest_steps(longest_steps)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Step number *k* goes from frame *k* to frame *k + 1*. Where does the last one of the slice lead?
#
# </details>
# <details><summary>Solution</summary>
#
# ```python
# def longest_steps(x, y, episodes):
#     steps = np.hypot(np.diff(x), np.diff(y))
#     parts = zip(episodes.from_index, episodes.to_index, strict=True)
#     return [steps[start : stop - 1].max() for start, stop in parts]
# ```
#
# </details>

# %% [markdown]
# ## Third kind: the files
#
# The index is right, and the frames are put together in another order.

# %%
guide("the files")

# %%
compare(dataset, "name-sorted-files")
print(*sorted(file.path.stem for file in dataset.files))

# %% [markdown]
# Lengths and totals are right. Here is episode 4, for somebody who reads it so. A push changes an error little by
# little. Look for what no push can do.

# %%
mixed = z2r.break_mode("name-sorted-files").dataset(dataset)
frames = mixed.read("observation.state")[mixed.episodes[4]]
errors = z2r.frame_errors(z2r.decode(frames, z2r.PUSHT, mixed.schema))
figures.error_traces(errors, z2r.PUSHT, mixed.schema.fps)

# %% [markdown]
# At almost 6 seconds, another episode begins in the middle of this one. LeRobot 0.6.1 sorts by name as well, when it
# reads. What saves it are zeros: it writes `file-002`, which comes before `file-010`. If a tool of yours writes
# files, write the zeros.
#
# ## Fourth kind: time
#
# These two are quiet. Nothing is drawn elsewhere, nothing else is reached.

# %%
guide("time")

# %% [markdown]
# But an action is about time, and [you know how to ask it](06_what_is_an_action.ipynb).

# %%
for name in (None, "wrong-fps", "action-lag"):
    read = z2r.inspect_dataset(dataset, name and z2r.break_mode(name))
    print(f"{name or 'read right':10}", read.action[0].evidence)

# %% [markdown]
# Read right: a velocity, in the unit of the state, one frame ahead. With three times as many frames a second, there
# is no such answer: 10.12, its slope, is no factor between units. `action-lag` gives each frame the action of the
# next one, so that what it does is seen a frame later. One frame sounds like nothing. [The next
# page](10_cost_of_a_misreading.ipynb) has its price.
#
# ## All at once
#
# Now read `messy` in every wrong way that applies to it, and hold each against the right reading. A dot means: no
# change. The first three columns count episodes. The *final* ones are by how much an error at the end changes at
# most. *Picture* and *action* are shares of frames in which something else is drawn, or another action given. Click a
# row to see what gives it away.

# %%
changes = what_changes(root)
moving.changes_table(changes)

# %% [markdown]
# Look at which cells are filled. Mistakes about **meaning** leave lengths and actions alone. Mistakes about the
# **index** or the **files** change which frames belong together, so picture and action change by the same share.
# Mistakes about **time** change neither what is drawn nor what is reached.
#
# The last column says which checks of the audit notice; `z2r explain overlap` says what one of them asks. `NONE` is
# `degrees-for-radians`: no data can say how good is good enough. (`messy`
# has a second witness, the simulator's verdict beside it. The copy has not, and neither has your data.)
#
# And *reached is wrong*? Under these, it is right for every episode that is left:

# %%
right = [each for each in changes if not each.reached and not each.is_dormant]
print(len(right), "of", len(changes))
print(*(each.name for each in right), sep="\n")

# %% [markdown]
# Half of them leave the answer of every episode that is left as it was. Of some, episodes are gone, so the share
# changes. Of the others it is the same to the digit. A share that looks right is no test of a reader.

# %% [markdown]
# ## Hunt: eight datasets (about 10 min)
#
# Eight datasets, drawn from a seed: four of the pusher, four of the arm. Some are healthy. Nobody measures anything
# for you.
#
# The numbers are free. Draw them, and paste in the checks that you wrote in the hunts before; how large the T is
# stands in [07](07_break_modes.ipynb). Instruments cost **one point** each: `finale.ask("a", "overlap")` asks one
# check of the audit (any other word costs nothing, and lists the names of all checks), `finale.infer_action("a")`,
# `finale.inspect("a")` and `finale.panel("a")` do what you know. A right answer brings **five**, a wrong one costs
# **two**. Forty is the most.

# %%
finale = Finale(seed=0)
for name in finale.names:
    it = finale[name]
    print(name, it.episodes, f"{it.fps} fps:", *[*it.columns][:3], "...")

# %% [markdown]
# What may be wrong, and what one would see of it:

# %%
for suspect, shows in SUSPECTS.items():
    print(f"{suspect:27}{shows}")

# %% [markdown]
# `finale["a"].columns["action/pusher_vx"]` is a column, and `finale["a"].episodes[0]` cuts out an episode. Put the
# name of a suspect in place of a `None`, as many as you like at once.

# %% tags=["exercise", "hunt"]
answers = {
    "a": None,
    "b": None,
    "c": None,
    "d": None,
    "e": None,
    "f": None,
    "g": None,
    "h": None,
}
finale.hand_in(answers)

# %% [markdown]
# <details><summary>Hint</summary>
#
# Where does something leap, and is that where an episode ends ([02](02_episode_index.ipynb))? Does each number follow
# what it is told, when, and how far ([06](06_what_is_an_action.ipynb))? Do solid things stay apart, and does what
# nobody holds stay where it is ([07](07_break_modes.ipynb))?
#
# </details>
#
# `print(finale)` is your score, in one line to share. `Finale(seed=1)` is another finale.

# %% [markdown]
# ## You can now
#
# - **tell** the kinds apart: meaning changes what is said of a frame, index and files change which frames belong
#   together, time changes neither;
# - **notice** what leaves answers alone: totals, overlap, and the action held against the motion;
# - **find** the place by the one thing that cannot happen: a leap, a step of no unit;
# - **say** what is yours to know: how good is good enough, and how many episodes there were.
#
# Next: [What does a misreading cost?](10_cost_of_a_misreading.ipynb) trains a policy on such mistakes, and counts.

# %% [markdown] tags=["replies"]
# <details><summary>One saved run: what the checkers reply</summary>
#
# **predict-unnoticed: a body elsewhere**
#
# ```text
# not yet: you said 'wrong-reference-point', it is degrees-for-radians. No data
#     can say how good is good enough. Somebody has to know the task, or there is
#     a second witness.
# Another one: Of the arm, which is not noticed: wrong-angle-unit,
#     delta-for-absolute, action-lag, wrong-fps? Add your answer to the call, as
#     again=..., and run the cell again.
# ```
#
# **predict-unnoticed: a right answer**
#
# ```text
# right: it is degrees-for-radians. No data can say how good is good enough.
#     Somebody has to know the task, or there is a second witness.
# ```
#
# **longest-steps: the other end moved**
#
# ```text
# not yet: for the episodes of messy, expected (0.02184, 0.02757, 0.01937,
#     0.04162, 0.03886, 0.03632, 0.02912, 0.03693, 0.0353, 0.009679, 0.02706,
#     0.02214, 0.02748, 0.03619) and got (0.2249, 0.1503, 0.2076, 0.1951, 0.2449,
#     0.177, 0.226, 0.1666, 0.05434, 0.1296, 0.05173, 0.1119, 0.1412, 0.03619).
#     Step number k goes from frame k to frame k + 1. Which steps of the slice
#     lead out of the episode?
# ```
#
# **longest-steps: a right answer**
#
# ```text
# right: all 3 trials agree with z2r.
# ```
#
# **hunt: the cube is not looked at**
#
# ```text
# not yet: z2r finale, seed 0: 33 of 40 points (7 of 8 right, instruments: 0,
#     wrong guesses: 1)
#     e is not healthy. Ask it something else
# ```
#
# **hunt: a right answer**
#
# ```text
# right: z2r finale, seed 0: 40 of 40 points (8 of 8 right, instruments: 0, wrong
#     guesses: 0)
# ```
#
# </details>
