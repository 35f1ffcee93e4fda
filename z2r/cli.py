"""The command line: `z2r inspect` and `z2r record`.

Modules that are slow to import are imported where they are used, so that `--help` is there at once.
"""

import contextlib
import importlib.metadata
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from z2r.breaks import BREAK_MODES, BreakMode, break_mode
from z2r.data import SHIPPED
from z2r.errors import DatasetError, MissingExtraError
from z2r.pusht.task import DEMO_NOISE, MAX_STEPS

if TYPE_CHECKING:
    from z2r.dataset import Dataset

OUT = Path("z2r-out")
SMOKE_STEPS = 40
_SHIPPED_EPISODES = 6

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode="markdown", pretty_exceptions_enable=False, add_completion=False
)


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit code 2."""
    try:
        app()
    except (DatasetError, MissingExtraError, OSError) as error:
        typer.echo(f"z2r: {error}", err=True)
        sys.exit(2)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"z2r {importlib.metadata.version('z2r')}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """**Seeing Like a Robot**: read a robot dataset before you train on it.

    Start with `z2r inspect`: it reads six demonstrations that come with the package.
    """


def _known_mode(name: str | None) -> str | None:
    if name is not None:
        try:
            break_mode(name)
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None
    return name


_MODES_HELP = "; ".join(f"`{mode.name}`: {mode.assumption}" for mode in BREAK_MODES.values())


@app.command()
def inspect(
    dataset: Annotated[
        Path | None,
        typer.Argument(
            help="Folder of a LeRobot v3 dataset, or the name of a shipped one: `standin`, `messy`.",
            show_default="standin",
        ),
    ] = None,
    episodes: Annotated[int | None, typer.Option(min=1, help="Read the first N episodes only.", metavar="N")] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Record episodes afresh, from this seed on.", metavar="S")
    ] = None,
    smoke: Annotated[
        bool, typer.Option("--smoke", help=f"Record afresh, cut episodes at {SMOKE_STEPS} frames, write no .rrd.")
    ] = False,
    break_name: Annotated[
        str | None,
        typer.Option("--break", callback=_known_mode, metavar="MODE", help=f"Read it wrong on purpose. {_MODES_HELP}."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for metrics.json and inspect.rrd.", metavar="DIR")] = OUT,
    no_rerun: Annotated[bool, typer.Option("--no-rerun", help="Write no inspect.rrd.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print metrics.json and nothing else.")] = False,
) -> None:
    """Say what is in a dataset: what a frame is, where episodes end, how many reached the target.

    A dataset stores no success. It is reconstructed: the block's last stored pose, held against the target.
    The dataset itself is never written to.

    - `z2r inspect` reads what comes with the package
    - `z2r inspect my_dataset` reads yours
    - `z2r inspect --break yaw-swap` reads it wrong, to show what that looks like
    - `rerun z2r-out/inspect.rrd` replays what was read
    """
    afresh = dataset is None and (smoke or seed is not None or (episodes or 0) > _SHIPPED_EPISODES)
    if dataset is not None and (smoke or seed is not None):
        raise typer.BadParameter("--seed and --smoke record afresh: leave DATASET out, or leave them out")
    mode = break_mode(break_name) if break_name else None
    with contextlib.ExitStack() as stack:
        if afresh:
            wanted = _Wanted(episodes or _SHIPPED_EPISODES, seed or 0, SMOKE_STEPS if smoke else MAX_STEPS)
            root = stack.enter_context(_recorded_afresh(wanted, quiet=as_json))
        else:
            root = _find(dataset)
        _inspect(root, "recorded afresh" if afresh else root.name, episodes, mode, out, no_rerun or smoke, as_json)


@app.command()
def record(
    out: Annotated[Path, typer.Argument(help="Folder to make. It must not exist.")],
    episodes: Annotated[int, typer.Option(min=1, help="How many episodes.", metavar="N")] = _SHIPPED_EPISODES,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first one; the next has the next.", metavar="S")] = 0,
    noise: Annotated[
        float, typer.Option(min=0.0, help="Standard deviation of the noise on each action [m/s].", metavar="STD")
    ] = DEMO_NOISE,
    max_steps: Annotated[
        int, typer.Option(min=1, help="Frames after which an episode times out.", metavar="N")
    ] = MAX_STEPS,
) -> None:
    """Record demonstrations: a scripted expert pushes the block onto the target in the simulator.

    Writes a LeRobot v3 dataset to OUT and the simulator's verdict on every episode beside it, to OUT.verdict.json.
    Needs the simulator and LeRobot: `pip install 'z2r[record]'`.
    """
    from z2r.terminal import console

    _record(out, _Wanted(episodes, seed, max_steps), noise, quiet=False)
    console().print(f"{out} holds the dataset, {out}.verdict.json what the simulator said. Next: z2r inspect {out}")


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

    console(quiet).print(expectation(nearest_run("record", wanted.episodes), "episodes"))
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

    screen = console(as_json)
    if out.resolve().is_relative_to(root.resolve()):
        raise typer.BadParameter(f"{out} is inside the dataset, which is never written to: name another --out")
    dataset = load(root)
    if episodes is not None:
        dataset = _first(dataset, episodes)
    command = "inspect --no-rerun" if no_rerun else "inspect"
    screen.print(expectation(nearest_run(command, dataset.episodes.n_frames), "frames"))
    if mode:
        screen.print(wrong_on_purpose(mode))
    with progress("reading", "frames", as_json) as report:
        inspection = inspect_dataset(dataset, mode, progress=report)
    recording = read_verdict(root)
    metrics = metrics_json(inspection.metrics(title, recording.episodes[0].seed if recording else None))
    out.mkdir(parents=True, exist_ok=True)
    (out / "metrics.json").write_bytes(metrics)
    screen.print(summary(inspection, title))
    screen.print(f"wrote {out / 'metrics.json'}")
    if not no_rerun:
        from z2r.replay import write_replay

        replay = write_replay(dataset, out / "inspect.rrd", inspection.reading, inspection.episodes)
        screen.print(f"wrote {replay.path}: look at it with `rerun {replay.path}`")
        if replay.n_frames < dataset.episodes.n_frames:
            screen.print(
                f"it shows the first {replay.n_episodes:,} of {len(inspection.episodes):,} episodes"
                f" ({replay.n_frames:,} of {dataset.episodes.n_frames:,} frames); the others are left out"
            )
    if as_json:
        sys.stdout.buffer.write(metrics)


def _first(dataset: "Dataset", episodes: int) -> "Dataset":
    try:
        return dataset.first(episodes)
    except ValueError as error:
        raise typer.BadParameter(f"--episodes: {error}") from None
