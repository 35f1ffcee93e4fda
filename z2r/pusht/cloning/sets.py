"""Which demonstrations are learned from? Sets that the scripted expert recorded, and copies that something happened to.

Each is a LeRobot v3 dataset on disk, read through `z2r` as any other: what is read wrong is read wrong there, and what
the audit says of it is what it would say of yours. A set that is there is not made again.
"""

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Progress, no_progress
from z2r.format.dataset import load
from z2r.format.schema import ACTION, STATE
from z2r.format.store import exists, folder_for, write
from z2r.pusht.cloning.results import Audited
from z2r.pusht.simulator.recorder import new_dataset, record
from z2r.pusht.task import DEMO_NOISE, MAX_STEPS, TASK

FIRST_SEED = 1000
FAILING_NOISE, FAILING_STEPS = 0.15, 120  # m/s, frames: as `messy` was recorded; about 3 in 10 fail
IDLE_FRAMES = 60
LATE = 5  # frames
LEAP = 0.1  # m
KIND_SEED = 7  # draws which episodes are damaged

type Numbers = NDArray[np.float32]
type Episode = tuple[Numbers, Numbers]
"""State, (n, 10), and action, (n, 2)."""
type Damage = Callable[[Episode, Episode], Episode]
"""Takes an episode, and another one; returns what becomes of the first."""


def actions_of_another(episode: Episode, other: Episode) -> Episode:
    """Put the actions of another episode in the place of its own, again from the start where they are too few."""
    state = episode[0]
    return state, np.resize(other[1], (len(state), 2))


def frozen(episode: Episode, _: Episode) -> Episode:
    """Let the observation stand still from a third of the episode on, as when a driver hangs; the actions go on."""
    state, action = episode
    stop = len(state) // 3
    return np.concatenate([state[:stop], np.repeat(state[stop : stop + 1], len(state) - stop, axis=0)]), action


def late(episode: Episode, _: Episode) -> Episode:
    """Store every action `LATE` frames late; the first ones are at rest."""
    state, action = episode
    return state, np.concatenate([np.zeros((LATE, 2), np.float32), action])[: len(action)]


def leaping(episode: Episode, _: Episode) -> Episode:
    """Let the block be seen `LEAP` away in every tenth frame, as when a marker is taken for another."""
    state, action = episode
    seen = state.copy()
    seen[5::10, 2] += LEAP
    return seen, action


def idle(episode: Episode, _: Episode) -> Episode:
    """Let nobody begin: the first observation, and no action, for `IDLE_FRAMES` frames."""
    state = episode[0]
    return np.repeat(state[:1], IDLE_FRAMES, axis=0), np.zeros((IDLE_FRAMES, 2), np.float32)


FAULTS: dict[str, Damage] = {
    "actions-of-another": actions_of_another,
    "frozen": frozen,
    "late": late,
    "leaping": leaping,
}


def record_set(out: Path, n_episodes: int, first_seed: int, *, failing: bool, progress: Progress = no_progress) -> None:
    """Record demonstrations, all of which succeed, or some of which run out of time."""
    noise, max_steps = (FAILING_NOISE, FAILING_STEPS) if failing else (DEMO_NOISE, MAX_STEPS)
    record(out, range(first_seed, first_seed + n_episodes), noise, max_steps, progress)


def damaged_episodes(n_episodes: int, share: float) -> list[int]:
    """Draw which episodes are damaged: the same ones, whatever is done to them."""
    drawn = np.random.default_rng(KIND_SEED).choice(n_episodes, round(share * n_episodes), replace=False)
    return sorted(drawn.tolist())


def write_damaged(
    out: Path, source: Path, n_episodes: int, share: float, damages: Sequence[Damage], progress: Progress = no_progress
) -> None:
    """Write the first episodes of a dataset again, a share of them damaged, in one way after the other."""
    dataset = load(source).first(n_episodes)
    state, action = (dataset.read(name).astype(np.float32) for name in (STATE, ACTION))
    episodes = [(state[dataset.episodes[each]], action[dataset.episodes[each]]) for each in range(n_episodes)]
    changed = list(episodes)
    for count, each in enumerate(damaged_episodes(n_episodes, share)):
        changed[each] = damages[count % len(damages)](episodes[each], episodes[(each + 1) % n_episodes])
    with folder_for(out) as folder, new_dataset(folder / out.name) as written:
        for done, (states, actions) in enumerate(changed, 1):
            for seen, acted in zip(states, actions, strict=True):
                written.add_frame({STATE: seen, ACTION: acted, "task": TASK})
            written.save_episode()
            progress(done, n_episodes)


def kept_by_audit(root: Path) -> list[int]:
    """Return the episodes that `z2r audit --keep` leaves: those that no error is about."""
    _audit(root)
    kept: list[int] = json.loads(root.with_name(f"{root.name}.kept.json").read_text())
    return kept


def named_by_none(root: Path) -> list[int]:
    """Return the episodes that no error and no warning of `z2r audit` names."""
    said = _audit(root)
    named = {number for each in said["findings"] if each["severity"] != "note" for number in each["episodes"]}
    return [number for number in range(said["n_episodes"]) if number not in named]


def audited(root: Path, share: float) -> Audited:
    """Hold what the audit says of a set against what was done to a share of it."""
    said = _audit(root)
    damaged = {*damaged_episodes(said["n_episodes"], share)}
    kept, unnamed = kept_by_audit(root), named_by_none(root)
    named: dict[str, set[int]] = {}
    for each in said["findings"]:
        if each["severity"] != "note":
            named.setdefault(each["check"], set()).update(each["episodes"])
    return Audited(
        source=root.name,
        episodes=said["n_episodes"],
        damaged=len(damaged),
        kept=len(kept),
        kept_damaged=len(damaged.intersection(kept)),
        unnamed=len(unnamed),
        unnamed_damaged=len(damaged.intersection(unnamed)),
        checks="; ".join(f"{check} {len(of & damaged)}+{len(of - damaged)}" for check, of in named.items()),
    )


def _audit(root: Path) -> dict[str, Any]:
    """Ask the command line, and keep what it said beside the dataset."""
    kept, said = root.with_name(f"{root.name}.kept.json"), root.with_name(f"{root.name}.audit.json")
    if not exists(said):
        command = [sys.executable, "-c", "from z2r.cli import main; main()", "audit", str(root), "--json"]
        done = subprocess.run([*command, "--keep", str(kept)], capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise RuntimeError(done.stderr)
        write(said, done.stdout.encode())
    audit: dict[str, Any] = json.loads(said.read_text())
    return audit
