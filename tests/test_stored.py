"""Which episodes a dataset itself calls a success: read, counted, shown, compared with a reading, and audited."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import BASES, FAILED, LUCKY, relabel, true_from, wrong_in
from layouts import BOOKKEEPING, Layout, write_dataset
from stored import LENGTHS, SHAPES, SUCCESS, latched, record
from test_cli import run
from test_report import Elements, answers, data_of

import z2r
from z2r.format.episodes import EpisodeIndex
from z2r.reading.stored import StoredSuccess
from z2r.show import terminal

SOURCES = {"sparse": "next.reward with next.done", "lerobot/pusht": "next.success"}
COUNTED = [shape for shape in SHAPES if shape != "dense"]


@pytest.fixture(scope="module")
def datasets(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    roots = {shape: tmp_path_factory.mktemp("stored") / "dataset" for shape in SHAPES}
    for shape, root in roots.items():
        record(root, shape)
    return roots


@pytest.fixture
def labelled(tmp_path: Path) -> Path:
    BASES["labelled"](tmp_path / "labelled")
    return tmp_path / "labelled"


def printed(inspection: z2r.Inspection) -> str:
    screen = terminal.console()
    with screen.capture() as capture:
        screen.print(terminal.summary(inspection, "some"))
    return " ".join(capture.get().split())


def page_of(root: Path, tmp_path: Path, reading: z2r.Reading | None = None) -> str:
    z2r.write_report(root, tmp_path / "page.html", reading)
    return (tmp_path / "page.html").read_text()


# --- four shapes, and that of lerobot/pusht


@pytest.mark.parametrize("shape", COUNTED)
def test_every_shape_of_stored_success_is_counted(shape, datasets):
    inspection = z2r.inspect_dataset(datasets[shape])
    source = SOURCES.get(shape, shape)
    assert len(list(datasets[shape].glob("data/*/*.parquet"))) > 1
    assert inspection.stored.any_frame.tolist() == inspection.stored.last_frame.tolist() == list(SUCCESS)
    assert f"stored: 4 of 6 ({source})" in printed(inspection)
    assert "stored 4 of 6" in repr(inspection)
    metrics = inspection.metrics("some", None)
    assert metrics["stored_success"] == list(SUCCESS)
    assert (metrics["n_stored_success"], metrics["stored_success_source"]) == (4, source)


def test_a_dense_reward_is_no_count_but_a_sentence(datasets, tmp_path):
    inspection = z2r.inspect_dataset(datasets["dense"])
    assert inspection.stored is None
    assert "stored: next.reward is dense: it says how well, not whether" in printed(inspection)
    metrics = inspection.metrics("some", None)
    assert metrics["stored_success"] is metrics["n_stored_success"] is metrics["stored_success_source"] is None
    page = page_of(datasets["dense"], tmp_path)
    assert "next.reward is dense" in page
    assert "Reached or not: unknown" in page
    assert "stored" not in data_of(page)["readings"][0]


def test_what_stores_nothing_says_nothing():
    inspection = z2r.inspect_dataset("standin")
    assert inspection.stored is None
    assert inspection.metrics("standin", None)["stored_success"] is None
    assert "stored:" not in printed(inspection)


@pytest.mark.parametrize("shape", ["next.success", "success", "sparse"])
def test_where_nothing_else_is_known_the_page_is_headed_by_what_is_stored(shape, datasets, tmp_path):
    only = z2r.load(datasets[shape])
    page = page_of(only.root, tmp_path, z2r.Reading(name="mine"))
    assert answers(page) == {"right": ("4 of 6", "67%")}
    assert "called a success by the dataset" in page
    assert '<span class="tag">stored</span>' in page
    assert "Reached or not: unknown" not in page
    assert "How many does the dataset call a success?" in page
    assert data_of(page)["readings"][0]["stored"] == list(SUCCESS)
    assert "reached" not in data_of(page)["readings"][0]
    assert page.count("bar missed") == 2
    assert ["stored", *("yes" if each else "no" for each in SUCCESS)] == column_of(page)
    assert "stored: 4 of 6" in z2r.panel(only, z2r.Reading(name="mine")).title


def column_of(page: str) -> list[str]:
    """The last column of the table of episodes."""
    table = page.partition("Where episodes end")[2].partition("</table>")[0]
    return [row.rpartition("</")[0].rpartition(">")[2] for row in table.split("</tr>")[:-1]]


def test_the_layout_of_lerobot_pusht_is_read_by_the_reading_that_ships(datasets, tmp_path):
    root = datasets["lerobot/pusht"]
    inspection = z2r.inspect_dataset(root)
    assert inspection.reading.name == "lerobot_pusht"
    assert inspection.outcome.reached.tolist() == list(SUCCESS)
    assert inspection.agreement == ""  # one column is no two witnesses
    page = page_of(root, tmp_path)
    assert answers(page)["right"] == ("4 of 6", "67%")
    assert "reconstructed" not in page
    assert "4 of 6 (stored)" in z2r.panel(root).title


# --- a goal on a stored column


@pytest.mark.parametrize("column", ["next.success", "success"])
def test_a_goal_on_a_stored_column_works_from_end_to_end(column, datasets, tmp_path):
    path = tmp_path / "stored.toml"
    path.write_text(f'[[goal]]\nname = "success"\nstored = "{column}"\n')
    root, reading = datasets[column], z2r.read_reading(path)
    assert z2r.inspect_dataset(root, reading=reading).outcome.reached.tolist() == list(SUCCESS)
    assert answers(page_of(root, tmp_path, reading))["right"] == ("4 of 6", "67%")
    assert z2r.write_replay(root, tmp_path / "x.rrd", reading).n_episodes == len(SUCCESS)
    assert not wrong_in(z2r.audit(root, reading=reading))


def test_the_command_counts_what_is_stored(datasets, tmp_path):
    done = run("inspect", str(datasets["sparse"]), "--no-rerun", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "stored: 4 of 6 (next.reward with next.done)" in done.stdout
    metrics = json.loads((tmp_path / "z2r-out/metrics.json").read_text())
    assert metrics["stored_success"] == list(SUCCESS)


# --- labels of any kind, laid out by hand


def write_labels(root: Path, labels: dict[str, np.ndarray], lengths: tuple[int, ...] = LENGTHS) -> Path:
    n = sum(lengths)
    rng = np.random.default_rng(0)
    frames = {name: np.cumsum(rng.normal(size=(n, 2)), axis=0).astype("f4") for name in ("observation.state", "action")}
    features = {name: {"dtype": "float32", "shape": [2], "names": None} for name in frames}
    features |= {
        name: {"dtype": values.dtype.name, "shape": [values.size // n], "names": None}
        for name, values in labels.items()
    }
    files = [len(lengths) - 1, 1] if len(lengths) > 1 else [1]
    layout = Layout(files, [len(lengths)], episode_stats=True)
    write_dataset(root, frames | labels, lengths, layout, features=features | BOOKKEEPING)
    return root


def each(change: Callable[[int, bool], np.ndarray]) -> np.ndarray:
    return np.concatenate([change(n, success) for n, success in zip(LENGTHS, SUCCESS, strict=True)])


def rewarded(reward: np.ndarray) -> dict[str, np.ndarray]:
    return {"next.reward": reward, "next.done": each(lambda n, _: latched(n, True, 1))}


def test_a_label_in_some_frame_and_in_the_last_are_both_said(tmp_path):
    pulse = each(lambda n, success: (np.arange(n) == 4) & success)
    pulse[: LENGTHS[0]] = latched(LENGTHS[0], True)
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", {"next.success": pulse}))
    assert inspection.stored.any_frame.tolist() == list(SUCCESS)
    assert inspection.stored.last_frame.tolist() == [True] + [False] * 5
    assert "stored: 4 of 6 in some frame, 1 of 6 in the last (next.success)" in printed(inspection)


def test_a_reward_in_some_frame_and_in_the_last_are_both_said(tmp_path):
    pulse = each(lambda n, success: ((np.arange(n) == 4) & success) * 1.0)
    pulse[LENGTHS[0] - 1] = 1
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", rewarded(pulse)))
    assert "4 of 6 in some frame, 1 of 6 in the last (next.reward with next.done)" in printed(inspection)


@pytest.mark.parametrize(
    ("reward", "why"),
    [
        (lambda n, success: np.zeros(n), "is 0 in every frame"),
        (lambda n, success: np.where(latched(n, success), 0.0, -1.0), "is never above 0"),
        (lambda n, success: latched(n, success) * 1.0 + latched(n, True), "is dense"),
        (lambda n, success: np.where(np.arange(n) == 3, np.nan, latched(n, success)), "is no number"),
    ],
)
def test_a_reward_that_tells_no_success_says_why(reward, why, tmp_path):
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", rewarded(each(reward))))
    assert inspection.stored is None
    assert why in inspection.stored_note


def test_the_levels_of_a_reward_are_those_of_all_files(tmp_path):
    """Each file has two of them, and both together three."""
    reward = each(lambda n, success: latched(n, success) * 1.0)
    reward[-LENGTHS[-1] :] *= 2
    assert "is dense" in z2r.inspect_dataset(write_labels(tmp_path / "d", rewarded(reward))).stored_note


def test_a_reward_without_done_and_a_label_of_two_numbers_say_nothing(tmp_path):
    reward = {"next.reward": each(lambda n, success: latched(n, success) * 1.0)}
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", reward))
    assert (inspection.stored, inspection.stored_note) == (None, "")
    both = np.ones((sum(LENGTHS), 2), dtype="f4")
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "e", {"next.success": both}))
    assert (inspection.stored, inspection.stored_note) == (None, "")


def test_a_success_that_is_no_number_is_not_counted_and_said(tmp_path):
    success = each(lambda n, success: latched(n, success) * 1.0)
    success[3] = np.nan
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", {"success": success}))
    assert inspection.stored.any_frame.tolist() == [False, *SUCCESS[1:]]
    assert "1 of 6 episodes" in printed(inspection)


def test_numbers_above_0_say_yes(tmp_path):
    signs = each(lambda n, success: np.where(latched(n, success), 0.5, -1.0))
    inspection = z2r.inspect_dataset(write_labels(tmp_path / "d", {"success": signs}))
    assert inspection.stored.any_frame.tolist() == list(SUCCESS)


# --- against the reading


def test_a_reading_and_what_is_stored_are_compared(labelled, tmp_path):
    inspection = z2r.inspect_dataset(labelled)
    assert inspection.agreement == "the two agree in 14 of 14"
    relabel("next.success", true_from(-1), FAILED)(labelled)
    relabel("next.success", np.zeros_like, LUCKY)(labelled)
    inspection = z2r.inspect_dataset(labelled)
    said = f"the two agree in 12 of 14; they differ in episodes {FAILED}, {LUCKY}"
    assert inspection.agreement == said
    assert said in printed(inspection)
    page = page_of(labelled, tmp_path)
    assert said in page
    assert answers(page)["right"][0] == "11 of 14"
    assert "called a success by the dataset: 11 of 14 (next.success)" in Elements(page).text["page"]
    assert column_of(page)[0] == "stored"
    data = {each["name"]: each.get("stored") for each in data_of(page)["readings"]}
    assert data["right"] == data["yaw-swap"] == inspection.stored.any_frame.tolist()
    assert data["drop-boundaries"] is None


def test_at_most_eight_episodes_are_named():
    index = EpisodeIndex(np.arange(20), np.arange(1, 21), np.arange(100, 120))
    stored = StoredSuccess("success", np.zeros(20, bool), np.zeros(20, bool))
    said = stored.agreement(np.arange(20) > 5, index)
    assert said == (
        "the two agree in 6 of 20; they differ in episodes 106, 107, 108, 109, 110, 111, 112, 113 and 6 more"
    )


def test_a_success_that_was_lost_agrees_with_either_reading():
    stored = StoredSuccess("success", np.array([True] * 2), np.array([False] * 2))
    assert not stored.contradicts(np.array([True, False])).any()


# --- the audit


@pytest.mark.parametrize("shape", SHAPES)
def test_nothing_is_said_of_labels_that_lerobot_records(shape, datasets):
    audit = z2r.audit(datasets[shape])
    assert not wrong_in(audit), audit.findings
    assert any(line.startswith("success") for line in audit.not_checked) == (shape in ("sparse", "dense"))


def cut_off(labels: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Let some of the episodes time out: they are never done."""
    labels["next.done"] = each(lambda n, success: latched(n, success, 1))
    return labels


HEALTHY: dict[str, Callable[[], dict[str, np.ndarray]]] = {
    "some are cut off": lambda: cut_off(rewarded(each(lambda n, success: latched(n, success, 1) * 1.0))),
    "a cost for each step": lambda: rewarded(each(lambda n, success: np.where(latched(n, success), 0.0, -1.0))),
    "a cost for what goes wrong": lambda: (
        rewarded(-1.0 * each(lambda n, success: (np.arange(n) == 3) & (n > 20)))
        | {"next.success": each(lambda n, success: latched(n, success))}
    ),
    "true for a while, lost, and true at the end": lambda: {
        "success": each(lambda n, success: (np.arange(n) % 4 < 3) & success | latched(n, success, 1))
    },
    "neither success nor reward": dict,
}


@pytest.mark.parametrize("kind", HEALTHY)
def test_nothing_is_said_of_healthy_labels(kind, tmp_path):
    audit = z2r.audit(write_labels(tmp_path / "d", HEALTHY[kind]()))
    assert not wrong_in(audit), audit.findings


def test_one_failed_episode_is_no_label_that_was_never_filled_in(tmp_path):
    """Two of them may be; that is a note."""
    failed = {"success": np.zeros(40, dtype=bool)}
    assert not wrong_in(z2r.audit(write_labels(tmp_path / "one", failed, (40,))))
    audit = z2r.audit(write_labels(tmp_path / "two", failed, (25, 15)))
    assert [(finding.check, finding.severity) for finding in wrong_in(audit)] == [("label-constant", "note")]


def test_labels_that_cannot_be_read_in_one_file_are_not_judged_by_the_others(tmp_path):
    lost = each(lambda n, success: ((np.arange(n) == 3) & success) * 1.0)
    checks = {finding.check for finding in wrong_in(z2r.audit(write_labels(tmp_path / "d", {"success": lost})))}
    assert checks == {"success-lost"}
    lost[-1] = np.nan
    checks = {finding.check for finding in z2r.audit(write_labels(tmp_path / "e", {"success": lost})).findings}
    assert "finite" in checks
    assert "success-lost" not in checks


def test_a_reward_that_cannot_be_read_in_one_file_is_not_judged_by_the_other(tmp_path):
    success = each(lambda n, success: latched(n, success))
    unpaid = {"next.success": success, "next.reward": success * 1.0}
    unpaid["next.reward"][: LENGTHS[0]] = 0
    checks = {finding.check for finding in wrong_in(z2r.audit(write_labels(tmp_path / "d", unpaid)))}
    assert checks == {"success-reward"}
    unpaid["next.reward"][-1] = np.nan
    checks = {finding.check for finding in z2r.audit(write_labels(tmp_path / "e", unpaid)).findings}
    assert "finite" in checks
    assert not checks & {"success-reward", "audit"}


@pytest.mark.parametrize("mode", ["yaw-swap", "first-frame-for-last"])
def test_a_wrong_reading_is_found_by_what_is_stored(mode, labelled):
    findings = z2r.audit(labelled, z2r.break_mode(mode)).findings
    assert ("stored-success", "warning") in {(finding.check, finding.severity) for finding in findings}


def test_an_episode_in_several_files_is_one(tmp_path):
    """Its last frame is that of its last part: there the success is true again."""
    success = each(lambda n, _: latched(n, True) | (np.arange(n) == 3))
    root = write_labels(tmp_path / "d", {"success": success})
    first, second = sorted(root.glob("data/*/*.parquet"))
    whole = pa.concat_tables([pq.read_table(first), pq.read_table(second)])
    cut = sum(LENGTHS[:5]) - 5
    pq.write_table(whole.slice(0, cut), first)
    pq.write_table(whole.slice(cut), second)
    findings = {finding.check for finding in z2r.audit(root).findings}
    assert "file-rows" in findings
    assert "success-lost" not in findings
