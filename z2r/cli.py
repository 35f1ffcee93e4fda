"""The command line: `z2r inspect` and `z2r record`.

Modules that are slow to import are imported where they are used, so that `--help` is there at once.
"""

import contextlib
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import rich_click as click

from z2r.breaks import BREAK_MODES, BreakMode, break_mode
from z2r.data import SHIPPED
from z2r.errors import DatasetError, MissingExtraError
from z2r.pusht.task import DEMO_NOISE, MAX_STEPS

if TYPE_CHECKING:
    from z2r.dataset import Dataset

_SMOKE_STEPS = 40
_SHIPPED_EPISODES = 6
_MODES_HELP = "; ".join(f"`{mode.name}`: {mode.assumption}" for mode in BREAK_MODES.values())


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit code 2."""
    try:
        cli(prog_name="z2r")
    except (DatasetError, MissingExtraError, OSError) as error:
        click.echo(f"z2r: {error}", err=True)
        sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.rich_config({"text_markup": "markdown"})
@click.version_option(package_name="z2r", prog_name="z2r", message="%(prog)s %(version)s")
def cli() -> None:
    """**Seeing Like a Robot**: read a robot dataset before you train on it.

    Start with `z2r inspect`: it reads six demonstrations that come with the package.
    """


@cli.command()
@click.argument("dataset", type=click.Path(path_type=Path), required=False)
@click.option("--episodes", type=click.IntRange(min=1), metavar="N", help="Read the first N episodes only.")
@click.option("--seed", type=click.IntRange(min=0), metavar="S", help="Record episodes afresh, from this seed on.")
@click.option("--smoke", is_flag=True, help=f"Record afresh, cut episodes at {_SMOKE_STEPS} frames, write no .rrd.")
@click.option(
    "--break",
    "break_name",
    type=click.Choice(list(BREAK_MODES)),
    metavar="MODE",
    help=f"Read it wrong on purpose. {_MODES_HELP}.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("z2r-out"),
    show_default=True,
    metavar="DIR",
    help="Folder for `metrics.json` and `inspect.rrd`.",
)
@click.option("--no-rerun", is_flag=True, help="Write no `inspect.rrd`.")
@click.option("--json", "as_json", is_flag=True, help="Print `metrics.json` and nothing else.")
def inspect(
    dataset: Path | None,
    episodes: int | None,
    seed: int | None,
    smoke: bool,
    break_name: str | None,
    out: Path,
    no_rerun: bool,
    as_json: bool,
) -> None:
    """Say what is in a dataset: what a frame is, where episodes end, how many reached the target.

    DATASET is the folder of a LeRobot v3 dataset, or the name of one that comes with the package: `standin` (read
    where none is named) or `messy`. It is never written to.

    A dataset stores no success. It is reconstructed: the block's last stored pose, held against the target.

    - `z2r inspect my_dataset` reads yours
    - `z2r inspect --break yaw-swap` reads it wrong, to show what that looks like
    - `rerun z2r-out/inspect.rrd` replays what was read
    """
    if dataset is not None and (smoke or seed is not None):
        raise click.UsageError("--seed and --smoke record afresh: leave DATASET out, or leave them out")
    afresh = dataset is None and (smoke or seed is not None or (episodes or 0) > _SHIPPED_EPISODES)
    mode = break_mode(break_name) if break_name else None
    with contextlib.ExitStack() as stack:
        if afresh:
            wanted = _Wanted(episodes or _SHIPPED_EPISODES, seed or 0, _SMOKE_STEPS if smoke else MAX_STEPS)
            root, title = stack.enter_context(_recorded_afresh(wanted, quiet=as_json)), "recorded afresh"
        else:
            root = _find(dataset)
            title = root.resolve().name
        _inspect(root, title, episodes, mode, out, no_rerun or smoke, as_json)


@cli.command()
@click.argument("out", type=click.Path(path_type=Path))
@click.option(
    "--episodes",
    type=click.IntRange(min=1),
    default=_SHIPPED_EPISODES,
    show_default=True,
    metavar="N",
    help="How many episodes.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    metavar="S",
    help="Seed of the first episode; each next one has the next.",
)
@click.option(
    "--noise",
    type=click.FloatRange(min=0),
    default=DEMO_NOISE,
    show_default=True,
    metavar="STD",
    help="Standard deviation of the noise on each action, in m/s.",
)
@click.option(
    "--max-steps",
    type=click.IntRange(min=1),
    default=MAX_STEPS,
    show_default=True,
    metavar="N",
    help="Frames after which an episode times out.",
)
def record(out: Path, episodes: int, seed: int, noise: float, max_steps: int) -> None:
    """Record demonstrations: a scripted expert pushes the block onto the target in the simulator.

    Writes a LeRobot v3 dataset to OUT, which must not exist, and beside it what the simulator said of every episode,
    to `OUT.verdict.json`. Needs the simulator and LeRobot: `pip install 'z2r[record]'`.
    """
    _record(out, _Wanted(episodes, seed, max_steps), noise, quiet=False)
    click.echo(f"wrote {out}, a LeRobot dataset, and {out}.verdict.json, what the simulator said of it")
    click.echo(f"next: z2r inspect {out}")


class _Wanted(NamedTuple):
    episodes: int
    seed: int
    max_steps: int


def _find(dataset: Path | None) -> Path:
    if dataset is None:
        return SHIPPED["standin"]
    return dataset if dataset.exists() else SHIPPED.get(str(dataset), dataset)


@contextlib.contextmanager
def _recorded_afresh(wanted: _Wanted, quiet: bool) -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "recorded"
        _record(root, wanted, DEMO_NOISE, quiet)
        yield root


def _record(out: Path, wanted: _Wanted, noise: float, quiet: bool) -> None:
    from z2r import recorder
    from z2r.terminal import console, expectation, progress
    from z2r.wallclock import nearest_run

    console(quiet).print(expectation(nearest_run("record", wanted.episodes), "episodes"), soft_wrap=True)
    seeds = range(wanted.seed, wanted.seed + wanted.episodes)
    with progress("recording", "episodes", quiet) as report:
        recorder.record(out, seeds, noise, wanted.max_steps, report)


def _inspect(
    root: Path, title: str, episodes: int | None, mode: BreakMode | None, out: Path, no_rerun: bool, as_json: bool
) -> None:
    from z2r.dataset import load
    from z2r.inspection import inspect_dataset, metrics_json
    from z2r.terminal import console, expectation, progress, summary, wrong_on_purpose
    from z2r.verdict import read_verdict
    from z2r.wallclock import nearest_run

    if out.resolve().is_relative_to(root.resolve()):
        raise click.UsageError(f"{out} is inside the dataset, which is never written to: name another --out")
    screen = console(as_json)
    dataset = load(root)
    if episodes is not None:
        dataset = _first(dataset, episodes)
    command = "inspect --no-rerun" if no_rerun else "inspect"
    screen.print(expectation(nearest_run(command, dataset.episodes.n_frames), "frames"), soft_wrap=True)
    if mode:
        screen.print(wrong_on_purpose(mode))
    with progress("reading", "frames", as_json) as report:
        inspection = inspect_dataset(dataset, mode, progress=report)
    recording = read_verdict(root)
    metrics = metrics_json(inspection.metrics(title, recording.episodes[0].seed if recording else None))
    out.mkdir(parents=True, exist_ok=True)
    (out / "metrics.json").write_bytes(metrics)
    screen.print(summary(inspection, title))
    say = partial(screen.print, soft_wrap=True)
    say(f"wrote {out / 'metrics.json'}")
    if not no_rerun:
        from z2r.replay import write_replay

        replay = write_replay(mode.dataset(dataset) if mode else dataset, out / "inspect.rrd", inspection.reading)
        say(f"wrote {replay.path}: look at it with `rerun {replay.path}`")
        if replay.n_frames < inspection.episodes.n_frames:
            say(
                f"it shows the first {replay.n_episodes:,} of {len(inspection.episodes):,} episodes"
                f" ({replay.n_frames:,} of {inspection.episodes.n_frames:,} frames); the others are left out"
            )
    if as_json:
        sys.stdout.buffer.write(metrics)


def _first(dataset: "Dataset", episodes: int) -> "Dataset":
    try:
        return dataset.first(episodes)
    except ValueError as error:
        raise click.UsageError(f"--episodes: {error}") from None
