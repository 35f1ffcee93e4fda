"""What does a misreading cost? One recipe, trained on each of them, and judged by the simulator: the whole table.

    python -m z2r.pusht.cloning.experiment OUT [--smoke] [--row NAME] [--jobs N]

A policy is trained on demonstrations as somebody believes them to be, and played from starts that it has not seen. What
was measured stands in `OUT/results.csv`, a line for each policy and way to play it; what stands there is not measured
again. The demonstrations are recorded into `OUT/sets` first.
"""

import importlib.metadata
import os
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import rich_click as click
from rich.progress import track

from z2r.data import STANDIN
from z2r.format.dataset import Dataset, load
from z2r.format.schema import Schema
from z2r.pusht.cloning import sets
from z2r.pusht.cloning.data import Examples, Vantage, read_examples, scale_of
from z2r.pusht.cloning.model import Policy, train, use_one_thread
from z2r.pusht.cloning.results import SHOWN, Result, read_results, table_of, write_table
from z2r.pusht.cloning.rollout import roll_out, stand_still
from z2r.pusht.cloning.rows import ROWS, TRAININGS, Play, Training
from z2r.pusht.played import Rollout
from z2r.pusht.simulator.replayed import MODES, replay
from z2r.pusht.world import PUSHT
from z2r.reading.verdict import read_verdict

FIRST_START = 100_000  # far from the seeds of all demonstrations
SHARE_DAMAGED = 0.3
SAVED = 3  # rollouts of each row, of the first seed


class Size(NamedTuple):
    """How much work it is."""

    few: int  # demonstrations
    many: int
    batches: int  # on few; `many_batches` on many
    many_batches: int
    starts: int
    seeds: int


FULL = Size(few=400, many=2000, batches=5000, many_batches=15000, starts=100, seeds=3)
SMOKE = Size(few=8, many=10, batches=3, many_batches=3, starts=1, seeds=1)


def make_sets(folder: Path, size: Size) -> None:
    """Record the demonstrations that are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    clean = folder / "clean"
    damages = {name: ([damage], SHARE_DAMAGED) for name, damage in sets.FAULTS.items()}
    damages |= {"mixture": ([*sets.FAULTS.values()], SHARE_DAMAGED)}
    damages |= {"idle": ([sets.idle], 0.1), "tenth": ([sets.actions_of_another], 0.1)}
    work: dict[str, Callable[[Path], object]] = {
        "clean": partial(sets.record_set, n_episodes=size.many, first_seed=sets.FIRST_SEED, failing=False),
        "failing": partial(sets.record_set, n_episodes=size.few, first_seed=sets.FIRST_SEED + 2000, failing=True),
    }
    for name, (done, share) in damages.items():
        work[name] = partial(sets.write_damaged, source=clean, n_episodes=size.few, share=share, damages=done)
    for name in track([name for name in work if not (folder / name).exists()], "recording", transient=True):
        work[name](folder / name)
    shares = {name: share for name, (_, share) in damages.items()}
    write_table(folder.parent / "audited.csv", [sets.audited(folder / name, share) for name, share in shares.items()])


def measure(folder: Path, size: Size, number: int, seed: int) -> list[Result]:
    """Train one policy, and play it in all the ways that its training names.

    Parameters
    ----------
    folder : Path
        OUT, with the sets in it.
    size : Size
        How much work it is.
    number : int
        Which of `TRAININGS`.
    seed : int
        Draws the first weights and the batches.
    """
    use_one_thread()  # two policies side by side are quicker than one after the other
    began, training = time.process_time(), TRAININGS[number]
    batches = size.many_batches if training.many else size.batches
    dataset = load(folder / "sets" / training.source).first(size.many if training.many else size.few)
    dataset = replace(dataset, episodes=dataset.episodes.only(training.select(dataset)))
    examples = _examples(dataset, training) if len(dataset.episodes) else None
    policy = _learn(examples, training, batches, seed, folder) if examples else None
    results = []
    for play in training.plays:
        rollouts = _play(policy, play, training.vantage, folder, dataset.schema, size.starts)
        if seed == 0:
            save_rollouts(folder / "rollouts" / f"{play.row}.npz", {play.row: rollouts[:SAVED]})
        now = time.process_time()
        results.append(
            Result(
                row=play.row,
                demonstrations=len(dataset.episodes),
                seed=seed,
                outcomes="".join(str(int(each.success)) for each in rollouts),
                seconds=round(float(np.mean([len(each.actions) for each in rollouts])) / play.fps, 2),
                frames=len(examples.inputs) if examples else 0,
                batches=batches,
                minutes=round((now - began) / 60, 2),
                stack=_stack(),
                command=f"python -m z2r.pusht.cloning.experiment OUT --row {play.row}",
                against=play.against,
            )
        )
        began = now  # the first row of a policy bears its training
    return results


def _examples(dataset: Dataset, training: Training) -> Examples:
    believed, reading = training.mode.believe(dataset, PUSHT) if training.mode else (dataset, PUSHT)
    assert reading is not None
    return read_examples(believed, reading, training.vantage)


def _learn(examples: Examples, training: Training, batches: int, seed: int, folder: Path) -> Policy:
    scale = scale_of(examples)
    scale = training.scale(scale, folder) if training.scale else scale
    return train(examples, batches, seed, scale, with_mirror=training.mirror)


def _play(
    policy: Policy | None, play: Play, vantage: Vantage, folder: Path, schema: Schema, n_starts: int
) -> list[Rollout]:
    """Play a policy; where nothing was left to learn from, stand still."""
    if policy and play.scale:
        policy = replace(policy, scale=play.scale(policy.scale, folder))
    starts = range(FIRST_START, FIRST_START + n_starts * play.more)
    reading = play.mode.reading(PUSHT) if play.mode else PUSHT
    return roll_out(policy or stand_still, starts, reading, schema, vantage, play.fps)


def save_rollouts(path: Path, rollouts: Mapping[str, Sequence[Rollout]], more: Mapping[str, Any] | None = None) -> None:
    """Write rollouts into one file, each part of the first one of a row as ``ROW/0/PART``; and `more`, as it is."""
    path.parent.mkdir(parents=True, exist_ok=True)
    each = {f"{row}/{number}": rollout for row, rows in rollouts.items() for number, rollout in enumerate(rows)}
    parts = {f"{name}/{part}": value for name, rollout in each.items() for part, value in rollout._asdict().items()}
    arrays: dict[str, Any] = {name: np.float32(value) for name, value in parts.items()} | dict(more or {})
    np.savez_compressed(path, **arrays)


def gather_rollouts(folder: Path) -> None:
    """Put the rollouts of the rows that are shown, as far as they are there, and replays into `OUT/rollouts.npz`."""
    paths = [folder / "rollouts" / f"{row}.npz" for row in SHOWN]
    shown = {name: value for path in paths if path.exists() for name, value in np.load(path).items()}
    standin, recording = load(STANDIN), read_verdict(STANDIN)
    seeds = [episode.seed or 0 for episode in recording.episodes] if recording else []
    replays = {f"replay/{name}": replay(standin, seeds, mode) for name, mode in MODES.items()}
    save_rollouts(folder / "rollouts.npz", replays, shown)


def _place(result: Result) -> tuple[int, int]:
    return list(ROWS).index(result.row), result.seed


def _stack() -> str:
    versions = [f"{name} {importlib.metadata.version(name)}" for name in ("torch", "mujoco", "numpy")]
    return "; ".join([f"{platform.system()} {platform.machine()}", f"Python {platform.python_version()}", *versions])


@click.command()
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@click.option("--smoke", is_flag=True, help="All rows, so small that they say nothing.")
@click.option("--row", type=click.Choice([*ROWS]), metavar="NAME", help="Measure this row alone.")
@click.option(
    "--jobs", type=click.IntRange(min=1), default=os.cpu_count() or 1, show_default=True, metavar="N", help="Processes."
)
def main(out: Path, *, smoke: bool, row: str | None, jobs: int) -> None:
    """Measure what each misreading costs, into `OUT/results.csv`; what stands there is not measured again."""
    size, table = SMOKE if smoke else FULL, out / "results.csv"
    done = read_results(table)
    if any(each.batches not in (size.batches, size.many_batches) for each in done):
        raise click.UsageError(f"{table} holds rows of another size: name another folder")
    make_sets(out / "sets", size)
    there = {(each.row, each.seed) for each in done}
    wanted = [
        (number, seed)
        for seed in range(size.seeds)
        for number, training in enumerate(TRAININGS)
        if any((play.row, seed) not in there and row in (None, play.row) for play in training.plays)
    ]
    click.echo(expectation(wanted, smoke=smoke))
    for results in track(_measured(out, size, wanted, jobs), "training", len(wanted)):
        done += [each for each in results if (each.row, each.seed) not in there]
        write_table(table, sorted(done, key=_place))
    gather_rollouts(out)
    click.echo(table_of([each for each in sorted(done, key=_place) if row in (None, each.row)]))


def _measured(out: Path, size: Size, wanted: Sequence[tuple[int, int]], jobs: int) -> Iterator[list[Result]]:
    """Measure policies, each as soon as there is a process for it; one at a time in this one."""
    if jobs == 1:
        yield from (measure(out, size, *each) for each in wanted)
        return
    processes = ProcessPoolExecutor(jobs, get_context("spawn"))
    try:
        for future in as_completed([processes.submit(measure, out, size, *each) for each in wanted]):
            yield future.result()
    finally:
        processes.shutdown(cancel_futures=True)  # who stops it does not want to wait for hours


def expectation(wanted: Sequence[tuple[int, int]], *, smoke: bool) -> str:
    """Say how long it takes, from what was measured before: minutes of one core."""
    measured = {(each.row, each.seed): each.minutes for each in read_results()}
    keys = [(play.row, seed) for number, seed in wanted for play in TRAININGS[number].plays]
    if smoke or not all(key in measured for key in keys):
        return f"{len(wanted)} policies to train; not yet measured at this size"
    minutes, stack = sum(measured[key] for key in keys), read_results()[0].stack
    return f"{len(wanted)} policies to train; measured: {minutes:.0f} minutes of one core ({stack})"


if __name__ == "__main__":
    main()
