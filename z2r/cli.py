"""The command line: `z2r inspect`, `z2r audit`, `z2r report` and `z2r record`.

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

from z2r.data import SHIPPED
from z2r.errors import DatasetError, MissingExtraError
from z2r.pusht.task import DEMO_NOISE, MAX_STEPS
from z2r.reading.breaks import BREAK_MODES, BreakMode, break_mode

if TYPE_CHECKING:
    from z2r.format.dataset import Dataset

_SMOKE_STEPS = 40
_SHIPPED_EPISODES = 6
_MODES_HELP = "What each MODE believes:\n\n" + "\n\n".join(
    f"- `{mode.name}`: {mode.assumption}" for mode in BREAK_MODES.values()
)


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


class _AuditCommand(click.RichCommand):
    """A command whose help lists the checks: they are loaded when somebody asks for it."""

    def get_help(self, ctx: click.Context) -> str:
        from z2r.api import CHECKS

        self.epilog = "What each check asks:\n\n" + "\n\n".join(f"- `{name}`: {asks}" for name, asks in CHECKS.items())
        return super().get_help(ctx)


@cli.command(epilog=_MODES_HELP)
@click.argument("dataset", type=click.Path(path_type=Path), required=False)
@click.option("--episodes", type=click.IntRange(min=1), metavar="N", help="Read the first N episodes only.")
@click.option(
    "--seed", type=click.IntRange(min=0), metavar="S", help="Record afresh, from this seed on. Needs `z2r[record]`."
)
@click.option(
    "--smoke",
    is_flag=True,
    help=f"Record afresh, with at most {_SMOKE_STEPS} frames an episode, and no .rrd. Needs `z2r[record]`.",
)
@click.option(
    "--break",
    "break_name",
    type=click.Choice(list(BREAK_MODES)),
    metavar="MODE",
    help="Read it wrong on purpose, as one of the modes below.",
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
@click.option("--salvage", is_flag=True, help="Of a dataset that was cut off, read the episodes that are whole.")
@click.option("--json", "as_json", is_flag=True, help="Print `metrics.json` and nothing else.")
def inspect(
    dataset: Path | None,
    episodes: int | None,
    seed: int | None,
    smoke: bool,
    break_name: str | None,
    out: Path,
    no_rerun: bool,
    salvage: bool,
    as_json: bool,
) -> None:
    """Say what is in a dataset: what a frame is, where episodes end, how many reached the target.

    DATASET is the folder of a LeRobot v3 dataset, or the name of one that comes with the package: `standin` (read
    where none is named) or `messy`. It is never written to.

    A dataset seldom stores success. It is reconstructed: the block's last stored pose, held against the target.

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
        _inspect(root, title, episodes, mode, out, no_rerun or smoke, salvage, as_json)


@cli.command()
@click.argument("dataset", type=click.Path(path_type=Path), required=False)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    default=Path("z2r-out/report.html"),
    show_default=True,
    metavar="FILE.html",
    help="The page to write.",
)
def report(dataset: Path | None, out: Path) -> None:
    """Write a page that shows a dataset: play an episode, step through it, read it wrong and watch what happens.

    DATASET is named as for `z2r inspect`. It is never written to.

    The page is one file that any browser opens from disk. It needs no network and no server, so it can be mailed. It
    stays below 5 MB: of a large dataset, it holds the frames of the first episodes, and the sums of all.
    """
    _report(_find(dataset), out)


@cli.command(cls=_AuditCommand)
@click.argument("dataset", type=click.Path(path_type=Path), required=False)
@click.option(
    "--break",
    "break_name",
    type=click.Choice(list(BREAK_MODES)),
    metavar="MODE",
    help="Audit it as it is read under one of the mistakes that `z2r inspect --help` names: is it noticed?",
)
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON and nothing else.")
def audit(dataset: Path | None, break_name: str | None, as_json: bool) -> None:
    """Say what is wrong with a dataset: each finding with what was found, what was expected, and how to mend it.

    DATASET is named as for `z2r inspect`. It is never written to.

    A dataset describes its episodes in three places: the metadata, the columns of its frames, and its totals. They are
    compared. So are its values with its statistics, and its reading with what solid bodies can do. At the end it says
    what was not checked.

    The exit code is 0 where there is no error and no warning, 1 where there is one, and 2 where the dataset cannot be
    read.

    - `z2r audit my_dataset && train my_dataset` trains on nothing that is broken
    - `z2r audit my_dataset --json` is for scripts
    - `z2r audit --break yaw-swap-everywhere` finds by a number what the success rate hides
    """
    sys.exit(_audit(_find(dataset), break_mode(break_name) if break_name else None, as_json))


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
    from z2r.pusht.simulator import recorder
    from z2r.show.terminal import console, expectation, progress
    from z2r.show.wallclock import nearest_run

    console(quiet).print(expectation(nearest_run("record", wanted.episodes), "episodes"), soft_wrap=True)
    seeds = range(wanted.seed, wanted.seed + wanted.episodes)
    with progress("recording", "episodes", quiet) as report:
        recorder.record(out, seeds, noise, wanted.max_steps, report)


def _inspect(
    root: Path,
    title: str,
    episodes: int | None,
    mode: BreakMode | None,
    out: Path,
    no_rerun: bool,
    salvage: bool,
    as_json: bool,
) -> None:
    from z2r.pusht.verdict import read_verdict
    from z2r.reading.inspection import inspect_dataset, metrics_json
    from z2r.show.terminal import console, expectation, left_out, progress, summary, wrong_on_purpose
    from z2r.show.wallclock import nearest_run

    if out.resolve().is_relative_to(root.resolve()):
        raise click.UsageError(f"{out} is inside the dataset, which is never written to: name another --out")
    screen = console(as_json)
    dataset, lost = _load(root, salvage)
    if episodes is not None:
        dataset = _first(dataset, episodes)
    command = "inspect --no-rerun" if no_rerun else "inspect"
    screen.print(expectation(nearest_run(command, dataset.episodes.n_frames), "frames"), soft_wrap=True)
    if mode:
        screen.print(wrong_on_purpose(mode))
    with progress("reading", "frames", as_json) as report, _way_out(root, salvage):
        inspection = inspect_dataset(dataset, mode, progress=report)
    recording = read_verdict(root)
    numbers = inspection.metrics(title, recording.episodes[0].seed if recording else None)
    if salvage:
        episodes_read = range(len(inspection.episodes))
        numbers |= {"episode_numbers": [inspection.episodes.number(i) for i in episodes_read], "left_out": lost}
    metrics = metrics_json(numbers)
    out.mkdir(parents=True, exist_ok=True)
    (out / "metrics.json").write_bytes(metrics)
    screen.print(summary(inspection, title))
    if salvage:
        screen.print(left_out(lost))
    say = partial(screen.print, soft_wrap=True)
    say(f"wrote {out / 'metrics.json'}")
    if not no_rerun:
        from z2r.show.replay import write_replay

        replay = write_replay(mode.dataset(dataset) if mode else dataset, out / "inspect.rrd", inspection.reading)
        say(f"wrote {replay.path}: look at it with `rerun {replay.path}`")
        if replay.n_frames < inspection.episodes.n_frames:
            say(
                f"it shows the first {replay.n_episodes:,} of {len(inspection.episodes):,} episodes"
                f" ({replay.n_frames:,} of {inspection.episodes.n_frames:,} frames); the others are left out"
            )
    if as_json:
        sys.stdout.buffer.write(metrics)


def _load(root: Path, salvaged: bool) -> "tuple[Dataset, tuple[str, ...]]":
    """Load a dataset, and say what of it is left out."""
    if salvaged:
        from z2r.format.salvage import salvage

        found = salvage(root)
        return found.dataset, found.left_out
    from z2r.format.dataset import load

    with _way_out(root, salvaged):
        return load(root), ()


@contextlib.contextmanager
def _way_out(root: Path, salvaged: bool) -> Iterator[None]:
    """Let an error say what can still be read, if anything."""
    try:
        yield
    except DatasetError as error:
        if salvaged or (error.fault.path.name == "info.json" and not error.fault.field.startswith("total_")):
            raise
        from z2r.format.salvage import salvage

        try:
            whole = len(salvage(root).dataset.episodes)
        except DatasetError:
            whole = 0
        if not whole:
            raise error from None
        advice = f"--salvage reads the {whole:,} episode{'s' * (whole > 1)} of which everything is there"
        mend = f"{error.fault.mend}. {advice}" if error.fault.mend else advice
        raise DatasetError(error.fault._replace(mend=mend)) from None


def _audit(root: Path, mode: BreakMode | None, as_json: bool) -> int:
    import msgspec

    from z2r.api import audit
    from z2r.show.terminal import audit_report, console, progress, wrong_on_purpose

    screen = console(as_json)
    if mode:
        screen.print(wrong_on_purpose(mode))
    with progress("auditing", "data files", as_json) as report:
        found = audit(root, mode, progress=report)
    title = root.resolve().name
    screen.print(audit_report(found, title))
    if as_json:
        click.echo(msgspec.json.format(msgspec.json.encode(found.to_dict(title)), indent=2))
    return found.exit_code


def _report(root: Path, out: Path) -> None:
    from z2r.format.dataset import load
    from z2r.show.report import write_report
    from z2r.show.terminal import console, expectation, progress
    from z2r.show.wallclock import nearest_run

    screen = console()
    dataset = load(root)
    screen.print(expectation(nearest_run("report", dataset.episodes.n_frames), "frames"), soft_wrap=True)
    try:
        with progress("reading", "frames", quiet=False) as move:
            written = write_report(dataset, out, move)
    except ValueError as error:
        raise click.UsageError(f"--out: {error}") from None
    screen.print(f"wrote {written.path}: open it in a browser", soft_wrap=True)
    if written.left_out:
        screen.print(f"to keep the page small: {written.left_out}", soft_wrap=True)


def _first(dataset: "Dataset", episodes: int) -> "Dataset":
    try:
        return dataset.first(episodes)
    except ValueError as error:
        raise click.UsageError(f"--episodes: {error}") from None
