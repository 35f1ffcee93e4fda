"""What the page about costs shows: its words, bars and films are those of the table, whatever the table holds."""

import io
import re
from itertools import pairwise, permutations

import numpy as np
import pytest
from notebook_tools import ROOT
from PIL import Image, ImageSequence
from test_package import loaded_by

import z2r
from z2r.course import costs, rollouts
from z2r.course.exercises import cost as practice
from z2r.pusht.cloning.results import Result, read_rollout
from z2r.pusht.cloning.rows import ROWS
from z2r.pusht.simulator.replayed import MODES, replay

ALL = costs.MISREADINGS | costs.DEMONSTRATIONS | costs.DROPPED


def line(row, seed, outcomes, against="right"):
    return Result(row, 400, seed, outcomes, 9.5, 27000, 5000, 0.7, "a machine", "python -m x", against)


@pytest.fixture
def table(monkeypatch):
    """A small table of which everything is known: one row costs all, one nothing, one cannot be told."""
    rows = {
        "right": "1" * 90 + "0" * 10,
        "drop-boundaries": "1" * 90 + "0" * 10,
        "late-5": "0" * 100,
        "late-2": "1" * 40,
    }
    lines = [line(row, seed, outcomes.ljust(100, "0")) for row, outcomes in rows.items() for seed in range(2)]
    lines += [line("yaw-swap-throughout", seed, "1" * 88 + "0" * 12) for seed in range(2)]
    for module in ("z2r.course.costs", "z2r.course.exercises.cost", "z2r.pusht.cloning.results"):
        monkeypatch.setattr(f"{module}.read_results", lambda: lines)
    costs.cost_of.cache_clear()
    yield
    costs.cost_of.cache_clear()


def test_every_row_of_the_table_stands_in_one_place():
    placed = [row for rows in ALL.values() for row in rows]
    placed += [*costs.RECIPE, *costs.PLAIN, *(f"{row}-2000" for row in costs.TELLING)]
    assert sorted(placed) == sorted(ROWS)


def test_it_says_no_more_than_the_interval_allows(table, capsys):
    costs.tell("right", "drop-boundaries", "yaw-swap-throughout", "late-2", "late-5", "plain")
    right, same, few, half, none, missing = capsys.readouterr().out.splitlines()
    assert right.split() == ["right", "180", "of", "200", "(85%", "to", "93%)"]
    assert "no difference seen, +0 to +0 points against right" in same
    assert "no difference seen, -5 to +0 points" in few
    assert re.search(r"costs \d\d to \d\d points against right$", half)
    assert "0 of 200 (0% to 2%)" in none
    assert missing.split() == ["plain", "not", "yet", "measured"]


def test_bars_and_their_lines_are_as_long_as_the_table_says(table):
    [axes] = costs.bars(costs.MISREADINGS).axes
    bars = {bar.get_gid(): bar for bar in axes.patches}
    assert {row: round(bar.get_width(), 2) for row, bar in bars.items()} == {
        "right": 0.9, "drop-boundaries": 0.9, "late-2": 0.4, "late-5": 0, "yaw-swap-throughout": 0.88,
    }  # fmt: skip
    assert {row for row, bar in bars.items() if bar.get_hatch()} == {"late-2", "late-5"}
    [interval] = [each for each in axes.lines if each.get_gid() == "late-5 interval"]
    np.testing.assert_allclose(interval.get_xdata(), (0, 0.0188), atol=1e-4)
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["right", "drop-boundaries", "late-2", "late-5", "yaw-swap-throughout"]


def test_differences_are_marked_by_more_than_their_colour(table):
    [axes] = costs.differences(costs.MISREADINGS).axes
    markers = {each.get_gid(): each.get_marker() for each in axes.lines}
    assert [markers[row] for row in ("drop-boundaries", "yaw-swap-throughout", "late-5")] == ["o", "o", "<"]


def test_where_nothing_was_measured_nothing_is_drawn(table):
    with pytest.raises(ValueError, match="found no row"):
        costs.bars(costs.DROPPED)


def test_rows_that_cannot_be_told_apart_may_stand_either_way(table, capsys):
    rows = ["yaw-swap-throughout", "drop-boundaries", "late-2", "late-5"]
    right = set()
    for order in permutations(rows):
        practice.check_order(order, rows)
        right |= {order} if capsys.readouterr().out.startswith("right") else set()
    assert right == {
        ("yaw-swap-throughout", "drop-boundaries", "late-2", "late-5"),
        ("drop-boundaries", "yaw-swap-throughout", "late-2", "late-5"),
    }


def test_what_was_recorded_is_what_the_simulator_says():
    dataset = z2r.load(z2r.STANDIN)
    seeds = [episode.seed for episode in z2r.read_verdict(z2r.STANDIN).episodes]
    for name in ("as-recorded", "exchanged", "step-for-velocity", "wrong-fps", "late-2", "late-5", "action-lag"):
        recorded = [read_rollout(f"replay/{name}", number).success for number in range(len(seeds))]
        assert [each.success for each in replay(dataset, seeds, MODES[name])] == recorded


def test_a_film_moves_until_the_end_and_is_small():
    made = rollouts.film({name: read_rollout(name) for name in ("right", "late-5")}, seconds=11)
    assert len(made) < 200_000
    film = Image.open(io.BytesIO(made))
    assert film.n_frames == 1 + 55  # and what is shown where nothing moves
    pictures = []
    for number in range(film.n_frames):
        film.seek(number)
        pictures.append(np.asarray(film.convert("RGBA")))
    assert (pictures[0] == pictures[-1]).all()
    middle = pictures[0].shape[1] // 2
    left, right = ([each[:, part] for each in pictures] for part in (slice(0, middle), slice(middle, None)))
    assert all((one != other).any() for one, other in pairwise(right[1:]))
    assert (left[1] != left[-1]).any()


def test_the_readme_opens_with_what_was_measured():
    """To write the picture anew, write the bytes of this film."""
    made = rollouts.film({title: read_rollout(row) for title, row in rollouts.WALL.items()}, seconds=11)
    pictures = [Image.open(file) for file in (io.BytesIO(made), ROOT / ".github/cost.png")]
    new, shipped = ([np.asarray(each.convert("RGB"), int) for each in ImageSequence.Iterator(one)] for one in pictures)
    assert len(new) == len(shipped)
    assert all(np.abs(one - other).mean() < 1 for one, other in zip(new, shipped, strict=True))
    [opening] = re.findall(r"while\nthe policy learned: (.*?)\n\n", (ROOT / "README.md").read_text(), re.DOTALL)
    costs_of_all = [costs.cost_of(row) for row in rollouts.WALL.values()]
    expected = [number for cost in costs_of_all for number in (cost.n_successes, cost.n_rollouts)]
    assert [int(number) for number in re.findall(r"\d+", re.sub("`.*?`", "", opening))] == expected


def test_paths_begin_and_end_where_the_rollout_did():
    rollout = read_rollout("late-5")
    figure = rollouts.paths({"one": rollout, "other": read_rollout("right")})
    axes = figure.axes[0]
    [path] = [each for each in axes.lines if each.get_gid() == "pusher path"]
    np.testing.assert_array_equal(path.get_xydata()[[0, -1]], rollout.states[[0, -1], :2])
    assert [each.get_xlabel() for each in figure.axes] == ["no success in 30 s", "success after 10.7 s"]


def test_the_page_needs_neither_torch_nor_the_simulator():
    loaded = loaded_by("from z2r.course import costs, rollouts; from z2r.pusht.cloning import rows, data")
    assert not loaded & {"torch", "mujoco", "lerobot"}
