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
# [![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/zero2robot/seeing-like-a-robot/blob/main/notebooks/09_field_guide.ipynb)
#
# The link opens this notebook in Colab as soon as the repository of the course is public.

# %% [markdown]
# # What is wrong with this dataset?
#
# A broken dataset seldom says so. It loads, a policy trains on it, and then the robot misses. On this page you read
# one dataset wrong in eleven ways. Most of them were found in real code, and there is a link to where. They are of four
# kinds: a mistake in what the numbers mean, in the index, in the files, or in time. At the end you get three
# datasets. Something is wrong with each, and nobody tells you what.
#
# **By the end you can**
#
# - **tell** the four kinds apart by what each of them changes;
# - **notice** a mistake that leaves every answer about the target as it was;
# - **audit** a dataset, and say what the audit did not check;
# - **find** what is wrong with a dataset that nobody labelled.
#
# It takes 25 minutes. You need nothing but this page.

# %% tags=["setup"]
import importlib.util
from pathlib import Path

# Where z2r is missing, as in Colab: from a wheel beside this page, or else from its repository
if importlib.util.find_spec("z2r") is None:
    wheels = [path.resolve().as_uri() for path in Path().glob("z2r-*.whl")]
    source = wheels[0] if wheels else "git+https://github.com/zero2robot/seeing-like-a-robot"
    get_ipython().run_line_magic("pip", f'install --quiet "z2r[notebook] @ {source}"')

# %%
import shutil
import textwrap
from pathlib import Path

import numpy as np

import z2r
from z2r.course import figures
from z2r.course.damage import split, turn_half
from z2r.course.exercises import field_guide as practice
from z2r.course.field_guide import what_changes

# %% [markdown]
# ## A dataset in many files
#
# The dataset `messy` ships with the course. A disc called *the pusher* shoves a T-shaped block onto a target, 14
# times. Each attempt is an *episode*, each moment of it a *frame*. A frame holds what the robot saw,
# `observation.state`, and what it then did, `action`. The *episode index* says where an episode begins and ends.
#
# `messy` is small enough for one file. A large recording has many, and some mistakes need many files to show. So we
# make a copy that has a data file for each episode, and three files of episode index, which are called *shards*.

# %%
root = Path("z2r-out/many-files")
shutil.rmtree(root, ignore_errors=True)
dataset = z2r.load(split(z2r.MESSY, root))
state = dataset.read("observation.state")
print(len(dataset.episodes), "episodes,", len(state), "frames,", len(dataset.files), "data files")

# %% [markdown]
# Is the copy whole? That is a question for an *audit*. It compares what a dataset says in one place with what it says
# in another, and lists what does not fit. In a terminal it is `z2r audit my_dataset`, which ends with exit code 1 if
# something is wrong, so that a script can stop before it trains. Each finding begins with the name of its check.
# `z2r audit --help` says what each check asks.


# %%
def tell(audit):
    for finding in audit.findings:
        if finding.severity != "note":
            print(textwrap.fill(f"[{finding.check}] {finding}", 100, subsequent_indent="    "))


tell(z2r.audit(root))

# %% [markdown]
# One warning, about the names of files. Keep it in mind, it comes back below. Everything else fits. (We left the notes
# out, which say what is good to know before training, such as which numbers never change.)
#
# An audit that finds nothing has not looked at everything. A good one says where it stopped. This one does:

# %%
for line in z2r.audit(root).not_checked:
    print(textwrap.fill(f"not checked: {line}", 100, subsequent_indent="    "))

# %% [markdown]
# For this robot the list is short. For one whose columns have other names it is longer: nobody knows then what the
# numbers mean, so nobody can check it.
#
# ## The first kind: what the numbers mean
#
# In `z2r` a *break mode* is one wrong belief. The files stay as they are. The first four are about what the numbers
# mean. An episode *reached* the target if, in its last stored frame, the block is within 0.03 m and 0.2 rad of it.
# These are the ten numbers of the state, by their names.

# %%
names = dataset.schema.features["observation.state"].dim_names
print(*names[:6])
print(*names[6:])

# %% [markdown]
# This function reads a dataset right, and then under each break mode. The last two numbers are the distance and the
# turn that remain at the end of an episode. They are medians: half of the episodes have less.


# %%
def compare(dataset, *names):
    for name in ("read right", *names):
        read = z2r.inspect_dataset(dataset, z2r.BREAK_MODES.get(name))
        ends, lengths = read.outcome, read.episodes.lengths
        counts = f"{len(lengths):2} episodes, {sum(lengths):4} frames, {ends.n_reached:2} reached"
        distance, turn = (np.median(ends.final_errors[goal]) for goal in ("pos_err", "ang_err"))
        print(f"{name:22} {counts}, {1000 * distance:3.0f} mm, {turn:.2f} rad")


compare(dataset, "wrong-reference-point", "degrees-for-radians", "first-frame-for-last", "no-wrap")

# %% [markdown]
# **wrong-reference-point** measures the distance to the target from the pusher, and not from the block: it takes
# `pusher_x` and `pusher_y` for the place of the block. The pusher is beside the block, so some centimetres always
# remain, however good the demonstration is.
# [A simulator](https://github.com/huggingface/gym-xarm/pull/14) measured one position from the middle of the table and
# the other from the world's origin: success was false while the cube was lifted.
#
# **degrees-for-radians** takes the tolerance of 0.2 rad for 0.2 degrees. All errors are the same to the last digit,
# and almost nothing is good enough. [A simulated arm](https://github.com/strands-labs/robots/pull/693) that wanted
# radians was given degrees, went to the end of its range and froze.
#
# **first-frame-for-last** asks the first frame of an episode whether it reached the target. The errors are those of
# the start. We found no report of this one.
#
# **no-wrap** subtracts two angles and leaves it at that. Its line is that of the right reading. We come back to it.
#
# Which of the four changes a picture? Only the first moves a body. Here are the last 4 seconds of episode 1, so
# *block starts* is where it was 4 seconds before the end. Look at where the block is drawn, and at the rings, which are
# the pusher.

# %%
from_pusher = z2r.break_mode("wrong-reference-point").reading(z2r.PUSHT)
frames = state[dataset.episodes[1]][-40:]
both = [z2r.decode(frames, reading, dataset.schema) for reading in (z2r.PUSHT, from_pusher)]
figures.right_and_wrong(*both)

# %% [markdown]
# On the right every ring sits in the middle of the block's bar. Two solid bodies cannot be in one place.
#
# Would somebody notice without looking? The audit can take a break mode too, in a terminal with `--break`. It then
# checks the dataset as such a reader would see it. Here are the checks that find something, apart from the warning that
# we had before.


# %%
def noticed(dataset, *names):
    known = {finding.check for finding in z2r.audit(dataset.root).findings}
    for name in names:
        findings = z2r.audit(dataset.root, z2r.break_mode(name)).findings
        checks = dict.fromkeys(finding.check for finding in findings if finding.check not in known)
        print(f"{name:22}", *checks or ["nothing"])


noticed(dataset, "wrong-reference-point", "degrees-for-radians", "first-frame-for-last", "no-wrap")

# %% [markdown]
# `overlap` is the check that solid bodies stay apart. `decisive-frame` says that many episodes are in tolerance at
# some time, and few of them in the frame that decides, which is odd.
#
# For `degrees-for-radians` the audit finds **nothing**. No data can say how good is good enough. Only somebody who
# knows the task can, or a second witness. `messy` has one: the simulator's verdict is kept beside it. Our copy has
# none, and the audit said so above. Audit the original:

# %%
tell(z2r.audit(z2r.MESSY, z2r.break_mode("degrees-for-radians")))

# %% [markdown]
# The simulator calls ten episodes a success, and nine of them are lost. (Read right, eleven reached the target. The
# eleventh ended in tolerance, but had not stayed there for long enough. [Notebook 04](04_hidden_success.ipynb) has the
# story.)
#
# ### A mistake that sleeps
#
# And `no-wrap`? A yaw is decoded to an angle from -180° to 180°, and the target's is 0 in this dataset. So the two are
# at most half a turn apart, and there is nothing to wrap.
#
# Walk around the table to the other side. You walk around its middle, where x and y are 0, so from there every x and y
# has the other sign. So has every direction: half a turn more gives -sin and -cos. All ten numbers of the state change
# their sign, so the whole walk is `-state`. Nothing happened to the block, and no error may change.

# %%
last = state[dataset.episodes.to_index - 1]
unwrapped = z2r.break_mode("no-wrap").reading(z2r.PUSHT)
for side, frames in (("from here", last), ("from the other side", -last)):
    for name, reading in (("read right", z2r.PUSHT), ("no-wrap", unwrapped)):
        errors = z2r.frame_errors(z2r.decode(frames, reading, dataset.schema))
        reached = z2r.in_tolerance(errors, reading).sum()
        print(f"{side:20} {name:11} largest error {errors['ang_err'].max():.2f} rad, {reached:2} reached")

# %% [markdown]
# The right error stays. The other one goes to 6.25 rad, where a whole turn is 6.28, and three episodes are lost. The
# target now points to 180°. A block at 179° is near it, and one at -179° is just as near. But -179 less 180 is -359.
# [A planner](https://github.com/AtsushiSakai/PythonRobotics/pull/1422) would refuse its goal for that reason.
#
# Such a mistake is *dormant*: in this dataset it changes nothing, in the next one it may. `turn_half` takes the same
# walk in a copy of the files. What does the audit say there?

# %%
turned = Path(shutil.copytree(root, "z2r-out/turned", dirs_exist_ok=True))
turn_half(turned)
noticed(z2r.load(turned), "no-wrap")

# %% [markdown]
# `yaw-error` says that an error of more than half a turn, 3.14 rad, cannot be.
#
# ## The second kind: the index
#
# The next three read the index wrong. For `stale-file-pointer` it matters how many episodes a data file holds. We make
# one more copy, with five episodes in a data file, and again three shards.

# %%
few_files = Path("z2r-out/few-files")
shutil.rmtree(few_files, ignore_errors=True)
few = z2r.load(split(z2r.MESSY, few_files, episodes_per_file=5))
compare(few, "inclusive-end", "first-shard-only", "stale-file-pointer")

# %% [markdown]
# **inclusive-end** counts the end of a range as a frame of the episode. There are 13 frames too many, one for each
# episode but the last. That sounds harmless. But *reached* is read off the last frame, and the last frame now belongs
# to the next episode, where the block has just been put somewhere else. Whether an end is included is easily forgotten:
# [one loader](https://github.com/jayleicn/TVQA/issues/15) did it both ways.
#
# **first-shard-only** reads one file of the index, and there are three.
# [A viewer of datasets](https://github.com/huggingface/lerobot-dataset-visualizer/pull/11) did that.
#
# **stale-file-pointer** looks for the first episode of each data file in the file before it, and does not find it.
# [A converter](https://github.com/huggingface/lerobot/issues/2401) wrote such an index, with one wrong row for each
# new file.
#
# The last two are nasty: what is left looks perfect. Lengths, errors and pictures of the remaining episodes are
# right. The ribbon below has a piece for each episode that is left under `stale-file-pointer`. Look at the gaps.

# %%
stale = z2r.inspect_dataset(few, z2r.break_mode("stale-file-pointer"))
figures.episode_ribbon(stale.episodes, stale.outcome.reached)

# %% [markdown]
# Two gaps, where a file begins. (The pieces are numbered anew.) A list of lengths and errors would show no gap. But how
# many episodes there should be is written in `meta/info.json`.
#
# And what gives `inclusive-end` away? It is the step of the block from the last frame that belongs to the episode to
# the first that does not. This function returns all steps of the block inside each episode.


# %%
def block_steps(dataset):
    x_and_y = dataset.schema.columns("observation.state", ["tee_x", "tee_y"])
    block = dataset.read("observation.state")[:, x_and_y]
    parts = [block[dataset.episodes[i]] for i in range(len(dataset.episodes))]
    return [np.hypot(*np.diff(part, axis=0).T) for part in parts]


# %%
for name, read in (("read right", few), ("inclusive-end", z2r.break_mode("inclusive-end").dataset(few))):
    print(f"{name:14} longest steps [mm]:", *(f"{1000 * steps.max():3.0f}" for steps in block_steps(read)))

# %% [markdown]
# Read right, the block never moves more than 42 mm in a tenth of a second. With one foreign frame, every episode but
# the last has a leap of more than that, and most of more than 100 mm. And the audit?

# %%
noticed(few, "inclusive-end", "first-shard-only", "stale-file-pointer")

# %% [markdown]
# All three are found, because an index is stored in more than one place: in the shards, in columns of the frames, and
# in the totals of `meta/info.json`. Each of these readers trusted one place.
#
# ### Practice: leaps inside episodes
#
# **Bug hunt.** This function should return the longest step inside each episode. It takes x and y of the block in all
# frames, and the index. On a dataset that is whole it reports a leap in every episode but the last. It is not the
# data. Find the mistake and fix it. The check tries it on whole datasets, and on a tiny one.


# %% tags=["exercise", "longest-steps"]
def longest_steps(x, y, episodes):
    steps = np.hypot(np.diff(x), np.diff(y))
    parts = zip(episodes.from_index, episodes.to_index, strict=True)
    return [steps[start:stop].max() for start, stop in parts]


practice.check_longest_steps(longest_steps)

# %% [markdown]
# ## The third kind: the files
#
# Our copy has a file for each episode, with the names `file-0` to `file-13`. Sort the names.

# %%
print(*sorted(file.path.stem for file in dataset.files))

# %% [markdown]
# `file-10` comes before `file-2`: names are sorted letter by letter, and 1 comes before 2. **name-sorted-files** puts
# the frames together in this order. The index stays, and so does the number of frames.

# %%
compare(dataset, "name-sorted-files")

# %% [markdown]
# The lengths are right, the total is right, and the frames are in the wrong episodes. Here are the errors in episode
# 4 for somebody who reads it so. A push changes them little by little. Look for something that no push can do.

# %%
mixed = z2r.break_mode("name-sorted-files").dataset(dataset)
decoded = z2r.decode(mixed.read("observation.state")[mixed.episodes[4]], z2r.PUSHT, mixed.schema)
figures.error_traces(z2r.frame_errors(decoded), z2r.PUSHT, mixed.schema.fps)

# %% [markdown]
# After almost 6 seconds the block is at once more than 20 cm away from the target, and turned. One episode ends in
# the middle of this one, and another begins.
#
# [A script that writes LeRobot datasets](https://github.com/NVlabs/MobilityGen/pull/54) sorted its frames by name.
# LeRobot does it too when it reads: in version 0.6.1, `load_nested_dataset` in `lerobot/datasets/io_utils.py` sorts
# the paths of data files. Its own files have leading zeros, `file-002` before `file-010`, and all is well. Ours have
# none. That is what the warning `file-order` at the top of this page was about.

# %%
noticed(dataset, "name-sorted-files")

# %% [markdown]
# ## The fourth kind: time
#
# Two are left, and they are quiet.

# %%
compare(dataset, "wrong-fps", "action-lag")

# %% [markdown]
# Three equal lines. No body is drawn elsewhere, either. What changes is time.
#
# **wrong-fps** believes that 30 frames are taken in a second, but there are 10. Everything lasts a third as long.
# [A viewer](https://github.com/huggingface/lerobot/issues/336) began to play at 30 frames a second, whatever the
# dataset said.
#
# The action gives it away. It is a velocity: it says how fast the pusher is to move, in m/s. How fast did it move?
# That is its step from one frame to the next, times the frames in a second. How many times the action is that? The
# ratio below is the one that fits all frames of episode 0 best, along x.

# %%
first = dataset.episodes[0]
action, x = dataset.read("action")[first][:, 0], state[first][:, 0]
for fps in (10, 30):
    velocity = fps * np.diff(x)
    ratio = (action[:-1] @ velocity) / (action[:-1] @ action[:-1])
    print(f"{fps} frames a second: the pusher goes at {ratio:.2f} times the velocity that was asked for")

# %% [markdown]
# At 10 frames a second it does nearly what was asked. At 30 it would be almost three times as fast.
#
# **action-lag** believes that the action in a frame is the one that led to it. Here it is the one that was taken in
# it, and what it does shows in the next frame. People who get a dataset
# [ask which of the two it is](https://github.com/Lifelong-Robot-Learning/LIBERO/issues/54). Look at the first three
# seconds: is each cross in the ring of the same frame? (The last ring has no cross.)

# %%
velocity = dataset.schema.fps * np.diff(x)
figures.action_and_motion(action[:31], velocity[:30], dataset.schema.fps)

# %% [markdown]
# It is, or nearly. There is a number for that, the *correlation*: 1 if two rows of numbers go up and down together, -1
# if one goes up where the other goes down, and about 0 if they have nothing to do with each other. Take the velocity
# after each frame with the action of the same frame, and then with the action of the next one.

# %%
print(f"action of the same frame: {np.corrcoef(action[:-1], velocity)[0, 1]:.2f}")
print(f"action of the next frame: {np.corrcoef(action[1:], velocity)[0, 1]:.2f}")

# %% [markdown]
# The same frame wins, clearly. (The other number is not quite 0, since an action is like the one before it.) If your
# actions are velocities too and another frame wins, suspect a shift. The audit makes both tests:

# %%
noticed(dataset, "wrong-fps", "action-lag")

# %% [markdown]
# ### Practice: any shift
#
# **Complete the line.** The function should return the correlation of the velocities with the actions that are stored
# `shift` frames later. `velocity[k]` belongs to `action[k + shift]`. There is one velocity fewer than there are
# actions: for a shift of 0 the last action has no partner, for a larger one the last velocities have none. The cell
# cuts the velocities to the number of your actions, so give it no more actions than there are velocities. Put them in
# place of the three dots. `shift` is 0 or more.


# %% tags=["exercise", "match"]
def match(action, velocity, shift):
    later = ...
    return None if later is ... else np.corrcoef(later, velocity[: len(later)])[0, 1]


practice.check_match(match)

# %% [markdown]
# ## Beliefs about an arm
#
# Most robots are arms, and what people get wrong about an arm is mostly what a column is. Five break modes take columns
# of any robot for something else:
#
# - `joints-exchanged`: two joints for each other. [A dataset of humanoids](https://github.com/physical-superintelligence-lab/Humanoid-Everyday/issues/10)
#   listed the joints of a hip in another order than they are stored in.
# - `wrong-angle-unit`: degrees for radians, or radians for degrees. ROS counts in the one, LeRobot's arms in the other,
#   and [somebody has to convert](https://github.com/iblnkn/rosetta/pull/7).
# - `quaternion-order`: the four numbers of an orientation, with the scalar first or last.
#   [A script that writes LeRobot datasets](https://github.com/isaac-sim/IsaacLab/pull/5754) took one for the other, and
#   policies twisted their arms.
# - `delta-for-absolute`: a place to be at for a step to take. A reader of
#   [a recording script](https://github.com/TEA-Lab/DemoGen/issues/4) expected steps in the dataset, and found places.
# - `gripper-inverted`: open for closed. By its description, [a dataset](https://github.com/OpenDriveLab/AgiBot-World/issues/133)
#   stores how wide the gripper is open. The number grows as it closes.
#
# A mode applies where a dataset has what it is about. Our robot has no gripper and no quaternion, it stores no angle in
# one number, and its action is a velocity. But it has two joints: the pusher is driven along x and along y.
#
# `z2r.audit_beliefs` audits a dataset as it is, and then under every mode that applies. A belief is *refuted* if some
# check finds more than before. In a terminal it is `z2r audit my_dataset --break all`.

# %%
for belief in z2r.audit_beliefs(root).beliefs:
    print(f"{belief.mode:22} {belief.verdict:15}", *belief.refuted_by)

# %% [markdown]
# The lines to remember are those that say *not refuted*. Whoever believes that is never told by the data. `no-wrap`
# sleeps here, and `degrees-for-radians` does not.
#
# ## All of them
#
# Three more break modes are the subject of [an earlier notebook](07_break_modes.ipynb): `yaw-swap`
# ([met](https://github.com/rust-embedded/discovery/pull/444) in a tutorial for a compass), `drop-boundaries`
# ([met](https://github.com/strands-labs/robots/issues/708) where 20 episodes became one) and `yaw-swap-everywhere`
# ([met](https://github.com/ngageoint/hootenanny/issues/2804) in a program for maps, with the remark that the
# difference of two angles is not affected). The last one leaves every length, every error and *reached* as they are.
# The audit has a number for it:

# %%
tell(z2r.audit(z2r.MESSY, z2r.break_mode("yaw-swap-everywhere")))

# %% [markdown]
# A contact lets the pusher in by a few millimetres, a wrong yaw by tens. The audit draws the line at 10 mm, the earlier
# notebook at 5 mm. It also shows that, read right, neither dataset of the course comes to 4 mm: both lines are safe
# here, and the audit's leaves room for softer contacts.
#
# The next cell reads `messy`, in its 14 files, in all fourteen wrong ways that apply, and compares each with the right
# reading. Nothing in the table is typed in. A dot means: no change. The first three columns count episodes. The errors
# are the largest change in a last frame. Picture and action are the share of frames in which something else is drawn,
# or which are given another action. There, a frame is known by its episode and its place in it: one that is missing
# counts, and so does one that has come to another episode. Speed is how many times as fast everything seems to go.
#
# Here each file holds one episode, so `stale-file-pointer` loses 13 of 14. In the other copy it lost two.

# %%
changes = what_changes(root)
figures.what_changes(changes)

# %% [markdown]
# Compare which cells are filled. The four kinds show in them. What is about meaning (the two yaw swaps are, too, and
# `joints-exchanged`) changes what is said of a frame, but no length, and no action. What is about the index
# (`drop-boundaries` is, too) or the files changes which frames belong together: picture and action change by the same
# share. What is about time changes neither what is drawn nor what is reached.
#
# `NONE` in the last column is what to remember of an audit: `degrees-for-radians` is an error that it cannot see.
#
# Now the column *reached is wrong*. Under which mistakes is it right for every episode that is left? (`no-wrap`, which
# changes nothing here, is left aside.)

# %%
print(*(change.name for change in changes if not change.reached and not change.is_dormant), sep="\n")

# %% [markdown]
# Seven of fourteen. Ask any episode that is left, and it gives the right answer. (The one of `drop-boundaries` is right
# by luck: its last frame is the last of all, and episode 0 reached the target too.) Under `yaw-swap-everywhere`,
# `wrong-fps`, `action-lag` and `joints-exchanged` even the number of episodes stays.
#
# ## Practice: three datasets
#
# In the next three datasets something really is wrong: the files are damaged, and z2r reads them as they are. You are
# the one who says what it is. These are the suspects. *Late* means: stored one frame after the one in which the action
# was taken.

# %%
print(*practice.SUSPECTS, sep="\n")

# %% [markdown]
# And these are your instruments. For each episode: its length, the longest step of the block, and after which frame
# it comes. The frames of an episode count from 0.


# %%
def examine(dataset):
    steps = block_steps(dataset)
    reached = z2r.inspect_dataset(dataset).outcome.n_reached
    print(len(steps), "episodes,", reached, "reached")
    print("frames:           ", *(f"{n:4}" for n in dataset.episodes.lengths))
    print("longest step [mm]:", *(f"{1000 * step.max():4.0f}" for step in steps))
    print("after frame:      ", *(f"{step.argmax():4}" for step in steps))


# %% [markdown]
# **Level 1: the numbers are enough.**

# %%
a = z2r.load(practice.make_dataset("a"))
examine(a)

# %% [markdown]
# How far does the block move in a tenth of a second, and where in the episode is that? Put the name of the suspect in
# place of `None`, in quotation marks.

# %% tags=["exercise", "dataset-a"]
answer = None
practice.check_diagnosis("a", answer)

# %% [markdown]
# **Level 2: these numbers show nothing. Look.**

# %%
b = z2r.load(practice.make_dataset("b"))
examine(b)

# %%
figures.episode_path(z2r.decode(b.read("observation.state")[b.episodes[0]], z2r.PUSHT, b.schema))

# %% [markdown]
# The target of this task has a yaw of 0: its bar lies across, and its stem hangs down from it.

# %% tags=["exercise", "dataset-b"]
answer = None
practice.check_diagnosis("b", answer)

# %% [markdown]
# **Level 3: look again, and then take a number.**

# %%
c = z2r.load(practice.make_dataset("c"))
examine(c)

# %% [markdown]
# No leap, and 11 reached. Compare action and motion, as above, in the first three seconds of episode 0. If you see
# something, a number has to say which way it goes.

# %%
action, x = c.read("action")[c.episodes[0]][:, 0], c.read("observation.state")[c.episodes[0]][:, 0]
velocity = c.schema.fps * np.diff(x)
figures.action_and_motion(action[:31], velocity[:30], c.schema.fps)

# %%
print(f"velocity and the action of the frame before: {np.corrcoef(action[:-2], velocity[1:])[0, 1]:.2f}")
print(f"velocity and the action of the same frame:   {np.corrcoef(action[:-1], velocity)[0, 1]:.2f}")
print(f"velocity and the action of the next frame:   {np.corrcoef(action[1:], velocity)[0, 1]:.2f}")

# %% tags=["exercise", "dataset-c"]
answer = None
practice.check_diagnosis("c", answer)

# %% [markdown]
# If your three answers are right, you have also read what the audit says of each. It finds all three. It cannot find a
# mistake that nobody thought of when it was written. That is what the pictures are for.
#
# ## You can now
#
# - **tell** the four kinds apart: meaning changes what is said of a frame, index and files change which frames belong
#   together, time changes neither;
# - **notice** what leaves every answer as it was: totals for lost episodes, overlap for a mirrored yaw, action against
#   motion for time;
# - **audit** a dataset: `z2r audit my_dataset`, and read the last lines, which say what was not checked;
# - **find** what is wrong with a dataset, first from the numbers, then from the picture, then from both.
#
# Next: [What does a misreading cost?](10_cost_of_a_misreading.ipynb) trains a policy on such mistakes, and counts. And
# run `z2r audit` on a dataset of your own, before you train on it. How to read one is in
# [Is my data any good?](08_your_dataset.ipynb)
