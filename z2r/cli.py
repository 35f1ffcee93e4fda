"""The command line: `z2r inspect`, `z2r audit`, `z2r explain`, `z2r report`, `z2r reading`, `z2r ls`, `z2r record`.

What is slow to import is imported in the command that uses it, so that `--help` is there at once.
"""

import contextlib
import functools
import importlib.util
import io
import os
import re
import sys
from collections.abc import Callable, Iterator
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn

import rich_click as click

# Before numpy is there. Files are read by threads of our own; those of the linear algebra would wait for their small
# parts of it by turning in circles, which costs as much as half an audit.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from z2r.data import MESSY, STANDIN, find_dataset
from z2r.errors import DatasetError, MissingExtraError, count, one_error
from z2r.format.store import exists, folder_name, is_far, outside, write
from z2r.pusht.task import DEMO_NOISE, MAX_STEPS
from z2r.reading.breaks import BREAK_MODES, BreakMode

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from rich.console import Console

    from z2r.audits.audit import Audit
    from z2r.format.dataset import Dataset
    from z2r.format.schema import Schema
    from z2r.reading.inspection import Inspection
    from z2r.reading.reading import Reading
    from z2r.reading.verdict import Recording

_FORMATS = ("text", "json", "sarif", "junit", "github")
_SMOKE_STEPS = 40
_SHIPPED_EPISODES = 6
_NO_REPLAY = "no replay, which needs rerun. In a clone of the course: pip install '.[view]'"
_NO_REPLAY_FROM_FAR = "no replay, which would fetch pictures: --rerun writes one"
_MODES_HELP = "What each MODE believes:\n\n" + "\n\n".join(
    f"- `{mode.name}`: {mode.assumption}" for mode in BREAK_MODES.values()
)


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit code 2."""
    if sys.stdout is None:  # so Python says that whoever started it has closed it
        _stop("standard output is closed: send it to a file, or to /dev/null")
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a character that a terminal lacks is no reason to end
    try:
        with one_error():
            cli(prog_name="z2r")
    except (DatasetError, MissingExtraError) as error:
        _stop(f"{error}")
    except OSError as error:  # what has no name and is written to is a disk or a pipe behind the standard output
        _stop(f"standard output: {error.strerror.lower()}" if error.strerror and not error.filename else f"{error}")


def _stop(why: str) -> NoReturn:
    click.echo(f"z2r: {why}", err=True)
    sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.rich_config({"text_markup": "markdown"})
@click.version_option(package_name="z2r", prog_name="z2r", message="%(prog)s %(version)s")
def cli() -> None:
    """**Seeing Like a Robot**: read a robot dataset before you train on it.

    Start with `z2r inspect`: it reads six demonstrations that come with the package.
    """


def _names_a_dataset(command: Callable[..., None]) -> Callable[..., None]:
    """Take a dataset as an argument or by --dataset, and hand it to the command as its first argument."""

    @click.argument("dataset", type=click.Path(), required=False)
    @click.option("--dataset", "named", type=click.Path(), metavar="DATASET", help="The same as DATASET.")
    @functools.wraps(command)
    def with_dataset(dataset: str | None, named: str | None, **options: object) -> None:
        if dataset and named and dataset != named:
            raise click.UsageError(f"found two datasets, {dataset} and --dataset {named}, expected one: leave one out")
        command(dataset or named, **options)

    return with_dataset


def _runs_on(command: Callable[..., None]) -> Callable[..., None]:
    """Take the address of a cluster by --ray, and hand the command what runs it there; else None."""
    return click.option(
        "--ray",
        "executor",
        is_flag=False,
        flag_value="local",
        callback=lambda context, parameter, address: context.with_resource(_ray(address)),
        metavar="[ADDRESS]",
        help="Run it on a Ray cluster: the one at ADDRESS, or one of this machine alone. Needs the extra `ray`.",
    )(command)


@contextlib.contextmanager
def _ray(address: str | None) -> "Iterator[Executor | None]":
    if address is None:
        yield None
        return
    if address not in ("local", "auto") and not re.search(r":\d+$", address):
        raise click.UsageError(
            f"--ray: found {address}, expected an address such as ray://host:10001, or none; put DATASET before --ray"
        )
    from z2r.cluster import RayExecutor

    with RayExecutor(address) as executor:
        yield executor


def _reads_as(command: Callable[..., None]) -> Callable[..., None]:
    """Take a reading by --reading, and hand it to the command."""
    return click.option(
        "--reading",
        type=click.Path(),
        callback=lambda context, parameter, name: _reading(name),
        metavar="FILE|NAME",
        help="What the columns mean: a TOML file, or a reading that ships. [default: the one that ships and fits]",
    )(command)


def _reading(name: str | None) -> "Reading | None":
    if name is None:
        return None
    from z2r.api import find_reading

    return find_reading(name)


def _break_option(text: str, *more: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    return click.option(
        "--break",
        "mode",
        type=click.Choice(["none", *more, *BREAK_MODES]),
        callback=lambda context, parameter, name: name if name in more else BREAK_MODES.get(name),
        metavar="MODE",
        help=text,
    )


class _AuditCommand(click.RichCommand):
    """A command whose help lists the checks: they are loaded when somebody asks for it."""

    def get_help(self, ctx: click.Context) -> str:
        from z2r.api import CHECKS

        self.epilog = "What each check asks:\n\n" + "\n\n".join(f"- `{name}`: {asks}" for name, asks in CHECKS.items())
        return super().get_help(ctx)


@cli.command(epilog=_MODES_HELP)
@_names_a_dataset
@_runs_on
@click.option(
    "--episodes",
    type=click.IntRange(min=1),
    metavar="N",
    help="Read the first N episodes only; with `--seed` or `--smoke`, record N.",
)
@click.option(
    "--episode", type=click.IntRange(min=0), metavar="N", help="Show episode N in `inspect.rrd`, and no other."
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    metavar="S",
    help="Record afresh into `DIR/dataset`, from this seed on, and read that. Needs the extra `record`.",
)
@click.option(
    "--smoke",
    is_flag=True,
    help=f"Record afresh, with at most {_SMOKE_STEPS} frames an episode, and no `.rrd`. Needs the extra `record`.",
)
@_reads_as
@_break_option("Read it wrong on purpose, as one of the modes below; `none` reads it right.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("z2r-out"),
    show_default=True,
    metavar="DIR",
    help="Folder for `metrics.json` and `inspect.rrd`.",
)
@click.option(
    "--rerun/--no-rerun", default=None, help="Write `inspect.rrd`, or not. [default: if rerun is there, unless --json]"
)
@click.option("--salvage", is_flag=True, help="Of a dataset that was cut off, read the episodes that are whole.")
@click.option("--json", "as_json", is_flag=True, help="Print `metrics.json` and nothing else.")
def inspect(
    dataset: str | None,
    *,
    executor: "Executor | None",
    episodes: int | None,
    episode: int | None,
    seed: int | None,
    smoke: bool,
    reading: "Reading | None",
    mode: BreakMode | None,
    out: Path,
    rerun: bool | None,
    salvage: bool,
    as_json: bool,
) -> None:
    """Say what is in a dataset: what a frame is, where episodes end, how many reached the target.

    DATASET is the folder of a LeRobot v3 dataset, or the name of one that comes with the package: `standin` (read
    where none is named), `messy` or `arm`; or `user/name` as on the hub, where it was downloaded before: `z2r ls` lists
    them; or a URL: `s3://bucket/dataset`, `gs://...`, `hf://datasets/user/name`, `file://...`. It is never written to,
    and nothing is fetched unless a URL is named: then only what is needed, and no replay is written without `--rerun`.

    A dataset seldom stores success. It is reconstructed from the last stored frame of each episode, by a reading: which
    column means what, and what counts as reached.

    - `z2r inspect my_dataset --reading my.toml` reads yours; `z2r reading my_dataset` drafts such a file
    - `z2r inspect --break yaw-swap` reads it wrong, to show what that looks like
    - `rerun z2r-out/inspect.rrd` replays what was read: its cameras, its numbers, its tasks
    - `z2r inspect my_dataset --episode 7` puts that one into the replay
    """
    from z2r.show.terminal import console, graded

    wanted = _Wanted(episodes or _SHIPPED_EPISODES, seed or 0, _SMOKE_STEPS if smoke else MAX_STEPS)
    afresh = smoke or seed is not None
    if dataset and afresh:
        raise click.UsageError("--seed and --smoke record afresh: leave DATASET out, or leave them out")
    named = find_dataset(dataset)
    with_replay = _can_replay(rerun, otherwise=not (smoke or as_json or is_far(named)))
    root = _record_afresh(out, wanted, quiet=as_json) if afresh else named
    title = "recorded afresh" if afresh else folder_name(root)
    for name in ("metrics.json", "inspect.rrd"):
        outside(root, out / name)
    data, lost = _load(root, salvaged=salvage)
    screen = console(as_json)
    with _way_out(root, salvaged=salvage):
        inspection = _inspect(_first(data, episodes), reading, mode, screen, executor, episode, with_replay=with_replay)
    recording, no_verdict = _read_verdict(root)
    metrics = _write_metrics(inspection, title, recording, out, lost if salvage else None)
    _say_what_was_found(screen, inspection, title, lost if salvage else None, given=reading is not None)
    if recording:
        screen.print(graded(inspection, recording))
    if no_verdict:
        screen.print(no_verdict, style="yellow", soft_wrap=True)
    screen.print(f"wrote {out / 'metrics.json'}", soft_wrap=True)
    if with_replay:
        _write_replay(inspection, out / "inspect.rrd", screen, episode)
    elif rerun is None and not smoke:
        screen.print(_NO_REPLAY_FROM_FAR if is_far(root) else _NO_REPLAY, soft_wrap=True)
    if as_json:
        click.echo(metrics, nl=False)


def _inspect(
    dataset: "Dataset",
    reading: "Reading | None",
    mode: BreakMode | None,
    screen: "Console",
    executor: "Executor | None",
    episode: int | None,
    *,
    with_replay: bool,
) -> "Inspection":
    """Read a dataset; say before it how long that takes, and what is read wrong."""
    from z2r.api import MAX_REPLAY_FRAMES, choose_reading
    from z2r.reading.inspection import inspect_dataset
    from z2r.show.terminal import progress

    reading = _fitting(reading, dataset.schema) or choose_reading(dataset.schema)
    _check_episode(episode, mode.dataset(dataset) if mode else dataset)
    _announce(screen, "inspect" if with_replay else "inspect --no-rerun", dataset)
    if mode:
        _say_what_is_wrong(screen, mode, dataset, reading)
    with progress("reading", "frames", screen.quiet) as move:
        keep = MAX_REPLAY_FRAMES if with_replay else 0
        return inspect_dataset(dataset, mode, reading, move, keep, executor, episode)


def _check_episode(episode: int | None, dataset: "Dataset") -> None:
    try:
        if episode is not None:
            dataset.episodes.one(episode)
    except ValueError as error:
        raise click.UsageError(f"--episode: {error}") from None


def _say_what_was_found(
    screen: "Console", inspection: "Inspection", title: str, lost: tuple[str, ...] | None, *, given: bool
) -> None:
    from z2r.show.terminal import left_out, summary

    screen.print(summary(inspection, title, given))
    if lost is not None:
        screen.print(left_out(lost))


def _read_verdict(root: Path) -> "tuple[Recording | None, str]":
    """Read the verdict beside a dataset, or say why it cannot be read: who only wants the dataset needs none."""
    from z2r.reading.verdict import read_verdict

    try:
        return read_verdict(root), ""
    except DatasetError as error:
        return None, f"verdict: it cannot be read. {error}"


def _announce(screen: "Console", command: str, dataset: "Dataset") -> None:
    """Say how long it takes, before the work begins."""
    from z2r.show.terminal import expectation

    screen.print(expectation(command, dataset.episodes.n_frames), soft_wrap=True)


def _say_what_is_wrong(screen: "Console", mode: BreakMode, dataset: "Dataset", reading: "Reading | None") -> None:
    """Say what is believed under a break mode, of which columns, and whether there is anything here it is about."""
    from z2r.show.terminal import wrong_on_purpose

    applies, columns = mode.applies_to(dataset, reading), mode.columns(dataset.schema, reading)
    screen.print(wrong_on_purpose(mode, applies, columns))


def _fitting(reading: "Reading | None", schema: "Schema") -> "Reading | None":
    """Return a reading that somebody asked for, and refuse one that does not fit."""
    from z2r.reading.decode import features_of

    try:
        if reading:
            features_of(reading, schema)
    except ValueError as error:
        raise click.UsageError(f"--reading: {reading.name if reading else ''} does not fit: {error}") from None
    return reading


def _can_replay(asked: bool | None, *, otherwise: bool) -> bool:
    """Whether to write a replay: as it was asked for, or else if it is wanted and rerun is there."""
    installed = importlib.util.find_spec("rerun") is not None
    if asked and not installed:
        raise MissingExtraError(_NO_REPLAY)
    return installed and (otherwise if asked is None else asked)


def _load(root: Path, *, salvaged: bool) -> "tuple[Dataset, tuple[str, ...]]":
    """Load a dataset, and say what of it is left out."""
    if salvaged:
        from z2r.format.salvage import salvage

        found = salvage(root)
        return found.dataset, found.left_out
    from z2r.format.dataset import load

    with _way_out(root, salvaged=salvaged):
        return load(root), ()


@contextlib.contextmanager
def _way_out(root: Path, *, salvaged: bool) -> Iterator[None]:
    """Let an error say what can still be read, if anything."""
    try:
        yield
    except DatasetError as error:
        if salvaged or (error.fault.path.name == "info.json" and not error.fault.field.startswith("total_")):
            raise
        whole = _number_of_whole_episodes(root)
        if not whole:
            raise
        advice = f"--salvage reads the {count(whole, 'episode')} of which everything is there"
        mend = f"{error.fault.mend}. {advice}" if error.fault.mend else advice
        raise DatasetError(error.fault._replace(mend=mend)) from None


def _number_of_whole_episodes(root: Path) -> int:
    from z2r.format.salvage import salvage

    try:
        return len(salvage(root).dataset.episodes)
    except DatasetError:
        return 0


def _first(dataset: "Dataset", n_episodes: int | None) -> "Dataset":
    if n_episodes is None:
        return dataset
    if n_episodes > (there := len(dataset.episodes)):
        more = f". To record {n_episodes}: z2r inspect --seed 0 --episodes {n_episodes}"
        advice = more if dataset.root in (STANDIN, MESSY) else ""
        raise click.UsageError(f"--episodes: found {n_episodes} asked for, expected at most {there:,}{advice}")
    return dataset.first(n_episodes)


def _write_metrics(
    inspection: "Inspection", title: str, recording: "Recording | None", out: Path, left_out: tuple[str, ...] | None
) -> bytes:
    from z2r.reading.inspection import metrics_json

    numbers = inspection.metrics(title, recording.episodes[0].seed if recording else None)
    if left_out is not None:
        episodes_read = range(len(inspection.episodes))
        numbers |= {"episode_numbers": [inspection.episodes.number(i) for i in episodes_read], "left_out": left_out}
    metrics = metrics_json(numbers)
    write(out / "metrics.json", metrics, inspection.dataset.root)
    return metrics


class _NoPandas(MetaPathFinder):
    """pyarrow imports pandas for each list that rerun hands it, 0.2 s of CPU, and nothing here needs it."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        if name == "pandas":
            raise ModuleNotFoundError(name)


def _write_replay(inspection: "Inspection", path: Path, screen: "Console", episode: int | None) -> None:
    from z2r.api import scene_of

    sys.meta_path.insert(0, _NoPandas())
    from z2r.show.replay import write_replay

    replay = write_replay(inspection, path, scene_of(inspection.reading))
    screen.print(f"wrote {replay.path}: look at it with `rerun {replay.path}`", soft_wrap=True)
    episodes = inspection.episodes
    if replay.n_frames < episodes.n_frames:
        shown = f"the first {replay.n_episodes:,} of {len(episodes):,} episodes"
        if episode is not None:
            shown = f"episode {episode}, one of {len(episodes):,}"
        frames = f"{replay.n_frames:,} of {episodes.n_frames:,} frames"
        screen.print(f"it shows {shown} ({frames}); the others are left out", soft_wrap=True)
    for line in replay.left_out:
        screen.print(f"not in it: {line}", soft_wrap=True)


@cli.command()
@_names_a_dataset
@_runs_on
@_reads_as
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    default=Path("z2r-out/report.html"),
    show_default=True,
    metavar="FILE.html",
    help="The page to write.",
)
@click.option("--audit/--no-audit", "with_audit", default=True, help="Show what is wrong with it. [default: audit]")
def report(
    dataset: str | None, *, executor: "Executor | None", reading: "Reading | None", out: Path, with_audit: bool
) -> None:
    """Write a page that shows a dataset: play an episode, step through it, read it wrong and watch what happens.

    DATASET is named as for `z2r inspect`. It is never written to.

    The page is one file that any browser opens from disk. It needs no network and no server, so it can be mailed. It
    stays below 5 MB: of a large dataset, it holds the frames of the first episodes, and the sums of all. With the extra
    `video`, its cameras play, as far as there is room.
    """
    from z2r.api import load, write_report
    from z2r.show.terminal import console, progress

    screen = console()
    data = load(find_dataset(dataset))
    reading = _fitting(reading, data.schema)
    _announce(screen, "report" if with_audit else "report --no-audit", data)
    outside(data.root, out)  # before the work, which takes a while
    with progress("reading", "frames", quiet=False) as move:
        written = write_report(data, out, reading, move, executor, with_audit=with_audit)
    screen.print(f"wrote {written.path}: open it in a browser", soft_wrap=True)
    if written.left_out:
        screen.print(f"to keep the page small: {written.left_out}", soft_wrap=True)


@cli.command(cls=_AuditCommand)
@_names_a_dataset
@_runs_on
@_reads_as
@_break_option(
    "Audit it as it is read under one of the mistakes that `z2r inspect --help` names: is it noticed? `all` tables"
    " which of them are, and by which check.",
    "all",
)
@click.option(
    "--keep",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Write the numbers of the episodes that no error is about, as `lerobot-train --dataset.episodes` takes them.",
)
@click.option(
    "--meta-only",
    is_flag=True,
    help="Read no frame, for a verdict before a download: metadata, the footers of data files, the indices of videos.",
)
@click.option("--pictures", is_flag=True, help="Decode some pictures of every episode, too. Needs the extra `video`.")
@click.option(
    "--baseline",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Leave out what `z2r audit --json` printed into FILE before: only what is new counts.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(_FORMATS),
    default="text",
    show_default=True,
    help="Print the findings for a program, and nothing else: SARIF 2.1.0, JUnit's XML, annotations of GitHub.",
)
@click.option("--json", "form", flag_value="json", help="The same as `--format json`.")
def audit(
    dataset: str | None,
    *,
    executor: "Executor | None",
    reading: "Reading | None",
    mode: BreakMode | str | None,
    keep: Path | None,
    meta_only: bool,
    pictures: bool,
    baseline: Path | None,
    form: str,
) -> None:
    """Say what is wrong with a dataset: each finding with what was found, what was expected, and how to mend it.

    DATASET is named as for `z2r inspect`. It is never written to.

    A dataset describes its episodes in three places: the metadata, the columns of its frames, and its totals. They are
    compared. So are its values with its statistics, and its reading with what its task allows. At the end it says what
    was not checked.

    The exit code is 0 where there is no error and no warning, 1 where there is one, 2 where the command cannot run as
    it stands, and 3 where nothing was audited: the schema or the episodes cannot be read. A note is good to know before
    training, and fails nothing. With `--break all` it is 0 whatever is refuted, and 2 where the dataset is not whole.

    - `z2r audit my_dataset && train my_dataset` trains on nothing that is broken
    - `z2r audit my_dataset --keep good.json`, and `lerobot-train --dataset.episodes="$(cat good.json)" ...` leaves the
      episodes out that have an error
    - `z2r audit s3://bucket/my_dataset --meta-only` says what can be said before a download
    - `z2r audit my_dataset --pictures` also sees a camera that is black or frozen, or films another episode
    - `z2r audit my_dataset --json > accepted.json`, and `z2r audit my_dataset --baseline accepted.json` tells and
      counts only what is new since then
    - `z2r audit my_dataset --format github` annotates a pull request; `sarif` and `junit` are for other services
    - `z2r explain late` says of a check why it is there, and how to mend what it finds
    - `z2r audit --break yaw-swap-everywhere` finds by a number what the share reached hides
    - `z2r audit my_dataset --break all` says which wrong beliefs about it the data refutes, and which it cannot
    """
    from z2r.api import ALL_CHECKS, load, reading_for
    from z2r.api import audit as audit_dataset
    from z2r.audits.baseline import read_baseline
    from z2r.format.schema import read_schema
    from z2r.show.terminal import audit_report, console, progress

    quiet = form != "text"
    accepted = read_baseline(baseline) if baseline else frozenset()
    root = find_dataset(dataset)
    title = folder_name(root)
    screen = console(quiet)
    if keep:
        outside(root, keep)
    with contextlib.suppress(DatasetError):  # of a schema that cannot be read, the audit says why
        _fitting(reading, read_schema(root))
    if meta_only and (mode or keep or pictures):
        raise click.UsageError("--meta-only reads no frame: it goes with neither --break, --keep nor --pictures")
    if isinstance(mode, str):
        if keep or pictures:
            raise click.UsageError("--break all audits what is believed: it goes with neither --keep nor --pictures")
        if baseline or form not in ("text", "json"):
            raise click.UsageError("--break all audits what is believed: it goes with no --baseline, and --format json")
        _audit_beliefs(root, reading, screen, executor)
        return
    if mode:
        _say_what_is_wrong(screen, mode, load(root), reading or reading_for(root))
    with progress("auditing", "data files, then episodes of cameras" if pictures else "data files", quiet) as move:
        found = audit_dataset(root, mode, reading, move, executor, pictures=pictures, meta_only=meta_only)
    told = found.without(accepted)
    screen.print(audit_report(told, title), crop=False)
    if keep:
        _write_kept(found, keep, screen, root)
    if quiet:
        from z2r.show.formats import FORMATS

        click.echo(FORMATS[form](told, root, ALL_CHECKS))
    sys.exit(told.exit_code)


def _write_kept(found: "Audit", path: Path, screen: "Console", root: Path) -> None:
    """Write the episodes that no error is about, and say of which errors that tells nothing."""
    if not found.readable:
        screen.print(f"did not write {path}: nobody knows what an episode is", soft_wrap=True)
        return
    write(path, f"{[*found.kept]}\n".encode(), root)
    screen.print(f"wrote {path}: {len(found.kept):,} of {count(found.n_episodes, 'episode')}", soft_wrap=True)
    if found.of_all:
        screen.print(
            f"errors that are about no episode in particular keep none out: {', '.join(found.of_all)}", soft_wrap=True
        )


def _audit_beliefs(root: Path, reading: "Reading | None", screen: "Console", executor: "Executor | None") -> None:
    """Say which wrong beliefs a dataset refutes; as JSON where the screen is quiet."""
    import msgspec

    from z2r.api import audit_beliefs
    from z2r.show.terminal import beliefs_report, progress

    with progress("auditing", "beliefs", screen.quiet) as move:
        found = audit_beliefs(root, reading, move, executor)
    title = folder_name(root)
    screen.print(beliefs_report(found, title))
    if screen.quiet:
        click.echo(msgspec.json.format(msgspec.json.encode(found.to_dict(title)), indent=2))


@cli.command()
@click.argument("check", required=False)
def explain(check: str | None) -> None:
    """Say what a check asks, why, where it happened, and how to mend what it finds; without CHECK, list them all."""
    from z2r.api import ALL_CHECKS
    from z2r.api import explain as explain_check
    from z2r.show.terminal import check_list, console, explained

    screen = console()
    if check is None:
        screen.print(check_list(ALL_CHECKS))
        return
    try:
        why = explain_check(check)
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    [asked] = [each for each in ALL_CHECKS if each.name == check]
    screen.print(explained(asked, why))


@cli.command()
@_names_a_dataset
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.toml",
    help="The file to write. [default: the terminal]",
)
def reading(dataset: str | None, *, out: Path | None) -> None:
    """Draft a reading: what the columns of a dataset mean, as far as its data tells, and what is left to fill in.

    A reading says which column means what, and what counts as reached. Other commands take it with `--reading`.

    - `z2r reading my_dataset --out my.toml` writes a draft; then fill in units and a goal
    - `z2r inspect my_dataset --reading my.toml` counts by it
    """
    from z2r.api import inspect_dataset, load
    from z2r.show.draft import draft_reading
    from z2r.show.terminal import progress

    data = load(find_dataset(dataset))
    with progress("reading", "frames", quiet=False) as move:
        inspection = inspect_dataset(data, progress=move)
    draft = draft_reading(inspection, folder_name(data.root))
    if out is None:
        click.echo(draft, nl=False)
        return
    if exists(out):
        raise click.UsageError(f"--out: {out} exists, and you may have filled it in: name another file")
    write(out, draft.encode(), data.root)
    click.echo(f"wrote {out}: fill in what is unknown, then z2r inspect {data.root} --reading {out}")


@cli.command()
@click.option("--json", "as_json", is_flag=True, help="Print the list as JSON and nothing else.")
def ls(*, as_json: bool) -> None:
    """List the datasets that are there: those that ship, in this folder, in LeRobot's cache and in the hub's.

    Only `meta/info.json` of each is read. What stands under `name` is what the other commands take for DATASET. The
    caches are where `HF_LEROBOT_HOME`, `HF_HUB_CACHE` and `HF_HOME` say; nothing is fetched.
    """
    import msgspec

    from z2r.show.listing import list_datasets
    from z2r.show.terminal import console, listing

    found = list_datasets(Path())
    if as_json:
        click.echo(msgspec.json.format(msgspec.json.encode(found), indent=2))
    console(as_json).print(listing(found))


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
    to `OUT.verdict.json`. Needs the simulator and LeRobot, in a clone of the course: `pip install '.[record]'`.
    """
    _record(out, _Wanted(episodes, seed, max_steps), noise, quiet=False)
    click.echo(f"wrote {out}, a LeRobot dataset, and {out}.verdict.json, what the simulator said of it")
    click.echo(f"next: z2r inspect {out}")


class _Wanted(NamedTuple):
    episodes: int
    seed: int
    max_steps: int


def _record(out: Path, wanted: _Wanted, noise: float, *, quiet: bool, replace: bool = False) -> None:
    from z2r.pusht.simulator import recorder
    from z2r.show.terminal import console, expectation, progress

    screen = console(quiet)
    screen.print(f"recording {count(wanted.episodes, 'episode')} into {out}", soft_wrap=True)
    screen.print(expectation("record", wanted.episodes), soft_wrap=True)
    seeds = range(wanted.seed, wanted.seed + wanted.episodes)
    with progress("recording", "episodes", quiet) as move:
        recorder.record(out, seeds, noise, wanted.max_steps, move, replace=replace)


def _record_afresh(out: Path, wanted: _Wanted, *, quiet: bool) -> Path:
    """Record into `out`, in place of what an earlier run recorded there, and return the dataset."""
    root = out / "dataset"
    _record(root, wanted, DEMO_NOISE, quiet=quiet, replace=True)
    return root
