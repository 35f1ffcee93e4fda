"""What the pictures say: read back from the figures, not how they look."""

import re
from io import BytesIO

import matplotlib.pyplot as plt
import nbformat
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from nbclient import NotebookClient

import z2r
from z2r.course import figures
from z2r.pusht import task

DATASET = z2r.load(z2r.STANDIN)
FIRST = DATASET.read(z2r.PUSHT.feature)[DATASET.episodes[0]]
SWAPPED = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)
SWAPPED_EVERYWHERE = z2r.break_mode("yaw-swap-everywhere").reading(z2r.PUSHT)


def read(state: np.ndarray, reading: z2r.Reading = z2r.PUSHT) -> z2r.Decoded:
    return z2r.decode(state, reading, DATASET.schema)


BOX_CORNERS = [
    np.add(center, np.multiply(half_size[:2], signs))
    for center, half_size in (
        (task.BAR_CENTER, task.BAR_HALF_SIZE),
        (task.STEM_CENTER, task.STEM_HALF_SIZE),
    )
    for signs in ((-1, -1), (-1, 1), (1, -1), (1, 1))
]
ERRORS = ("pos_err", "ang_err")
poses = st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-np.pi, np.pi))


def every_figure() -> dict[str, Figure]:
    """One of each, of both datasets that ship with the package."""
    drawn = {
        "yaw_circle": figures.yaw_circle(0.5, 0.75**0.5),
        "two_poses": figures.two_poses((0.1, 0.05, 0.5), (0.12, 0.04, 1.07)),
    }
    for name, root in (("standin", z2r.STANDIN), ("messy", z2r.MESSY)):
        dataset = z2r.load(root)
        first = dataset.read(z2r.PUSHT.feature)[dataset.episodes[0]]
        reached = z2r.inspect_dataset(dataset).outcome.reached
        drawn |= {
            f"{name} path": figures.episode_path(read(first)),
            f"{name} ribbon": figures.episode_ribbon(dataset.episodes, reached),
            f"{name} ribbon, not judged": figures.episode_ribbon(dataset.episodes),
            f"{name} traces": figures.error_traces(z2r.frame_errors(read(first)), z2r.PUSHT, 10),
            f"{name} final poses": figures.final_poses(dataset, z2r.PUSHT),
            f"{name} right and wrong": figures.right_and_wrong(read(first), read(first, SWAPPED)),
            f"{name} wrong everywhere": figures.right_and_wrong(read(first), read(first, SWAPPED_EVERYWHERE)),
        }
    return drawn


@pytest.fixture(scope="module")
def drawn() -> dict[str, Figure]:
    return every_figure()


def named(axes: Axes, gid: str) -> list:
    return [artist for artist in axes.get_children() if artist.get_gid() == gid]


def outlines(axes: Axes, gid: str) -> list[np.ndarray]:
    """The corners of every T of that name, (8, 2) each."""
    [collection] = named(axes, gid)
    return [path.vertices[:-1] for path in collection.get_paths()]


def segments(axes: Axes) -> list[tuple[float, float, float]]:
    """Left, right and lower end of every segment of a ribbon, from left to right."""
    paths = [path.vertices for collection in named(axes, "episodes") for path in collection.get_paths()]
    return sorted((path[:, 0].min(), path[:, 0].max(), path[:, 1].min()) for path in paths)


def png_size(figure: Figure) -> int:
    buffer = BytesIO()
    figure.savefig(buffer, bbox_inches="tight")
    return len(buffer.getvalue())


def bar_direction(outline: np.ndarray) -> float:
    """Which way the upper edge of the bar points, from its left end to its right one [rad]."""
    x, y = outline[1] - outline[0]
    return float(np.arctan2(y, x))


def test_the_outline_of_the_t_has_the_corners_of_its_boxes():
    [outline] = outlines(figures.two_poses((0, 0, 0), (0, 0, 0)).axes[0], "expected")
    found = {tuple(corner.round(6)) for corner in outline}
    assert found == {tuple(corner.round(6)) for corner in BOX_CORNERS}
    x, y = outline.T
    area = abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) / 2  # in the right order, too
    assert area == pytest.approx(sum(4 * half[0] * half[1] for half in (task.BAR_HALF_SIZE, task.STEM_HALF_SIZE)))


@settings(max_examples=20)
@given(pose=poses)
def test_a_t_is_moved_and_turned_counter_clockwise_without_being_bent(pose):
    axes = figures.two_poses((0, 0, 0), pose).axes[0]
    [still], [moved] = outlines(axes, "expected"), outlines(axes, "got")
    distances = [np.hypot(*(outline[:, None] - outline).transpose(2, 0, 1)) for outline in (still, moved)]
    np.testing.assert_allclose(*distances, atol=1e-9)
    x, y, yaw = pose
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    np.testing.assert_allclose(moved, still @ turn.T + (x, y), atol=1e-9)


def test_a_quarter_turn_to_the_left_points_the_stem_to_the_right():
    [outline] = outlines(figures.two_poses((0, 0, 0), (0, 0, np.pi / 2)).axes[0], "got")
    assert outline[:, 0].max() == pytest.approx(0.105)


def test_feedback_says_how_far_off_an_answer_is():
    title = figures.two_poses((0, 0, np.pi), (0.03, 0.04, np.pi / 2), "my answer").axes[0].get_title(loc="left")
    assert title == "my answer: 0.050 m away and turned by -90.0°"


def test_maps_have_equal_axes_in_metres(drawn):
    for name in ("standin path", "messy final poses", "standin right and wrong", "two_poses"):
        for axes in drawn[name].axes:
            assert axes.get_aspect() == 1
            assert axes.get_xlabel() == "x [m]"
        assert drawn[name].axes[0].get_ylabel() == "y [m]"


def test_a_path_passes_through_every_frame_and_the_block_is_drawn_where_it_was(drawn):
    axes = drawn["standin path"].axes[0]
    for what, columns in (("block", slice(2, 4)), ("pusher", slice(0, 2))):
        [line], [start], [end] = (named(axes, f"{what} {part}") for part in ("path", "start", "end"))
        np.testing.assert_allclose(line.get_xydata(), FIRST[:, columns])
        np.testing.assert_allclose(start.get_xydata()[0], FIRST[0, columns])
        np.testing.assert_allclose(end.get_xydata()[0], FIRST[-1, columns])
    tees = outlines(axes, "block")
    assert 6 <= len(tees) <= 8
    for tee, frame in ((tees[0], FIRST[0]), (tees[-1], FIRST[-1])):
        assert bar_direction(tee) == pytest.approx(np.arctan2(frame[4], frame[5]), abs=1e-6)
        np.testing.assert_allclose(tee[[0, 1, 2, 7]].mean(axis=0), frame[2:4], atol=1e-6)  # the centre of the bar
    [walls] = named(axes, "walls")
    assert np.abs(walls.get_xydata()).min() == task.WALL
    assert min(axes.get_xlim()[1], axes.get_ylim()[1]) > task.WALL


@pytest.mark.parametrize("n_frames", [1, 2])
def test_the_shortest_episodes_can_be_drawn(n_frames):
    decoded = read(FIRST[:n_frames])
    assert png_size(figures.error_traces(z2r.frame_errors(decoded), z2r.PUSHT, 10)) > 0
    assert len(outlines(figures.episode_path(decoded).axes[0], "block")) == n_frames


def test_a_wrong_reading_mirrors_the_block_and_leaves_the_rest(drawn):
    left, right = drawn["standin right and wrong"].axes
    pairs = list(zip(outlines(left, "block"), outlines(right, "block"), strict=True))
    assert len(pairs) > 2
    for read_right, read_wrong in pairs:
        np.testing.assert_allclose(
            np.exp(1j * bar_direction(read_wrong)), np.exp(1j * (np.pi / 2 - bar_direction(read_right))), atol=1e-6
        )
    np.testing.assert_allclose(outlines(left, "target"), outlines(right, "target"))
    np.testing.assert_allclose(named(left, "block path")[0].get_xydata(), named(right, "block path")[0].get_xydata())
    assert left.get_xlim() == right.get_xlim()
    assert left.get_title(loc="left") == "read right\nblock: atan2(sin_tee_yaw, cos_tee_yaw)"
    assert right.get_title(loc="left") == "read wrong\nblock: atan2(cos_tee_yaw, sin_tee_yaw)"


def test_the_target_is_mirrored_too_where_every_yaw_is_swapped():
    left, right = figures.right_and_wrong(read(FIRST), read(FIRST, SWAPPED_EVERYWHERE)).axes
    assert bar_direction(outlines(left, "target")[0]) == pytest.approx(0)
    assert bar_direction(outlines(right, "target")[0]) == pytest.approx(np.pi / 2, abs=1e-3)
    assert "target: atan2(cos_target_yaw, sin_target_yaw)" in right.get_title(loc="left")


@pytest.mark.parametrize("n_episodes", [1, 3, 14, 3000])
@pytest.mark.parametrize("judged", [True, False])
def test_a_ribbon_has_a_segment_for_each_episode_as_long_as_it_is(n_episodes, judged):
    rng = np.random.default_rng(n_episodes)
    stops = np.cumsum(rng.integers(1, 300, n_episodes))
    episodes = z2r.EpisodeIndex(np.append(0, stops[:-1]), stops)
    reached = rng.random(n_episodes) < 0.7
    figure = figures.episode_ribbon(episodes, reached if judged else None)
    starts, ends, heights = np.transpose(segments(figure.axes[0]))
    np.testing.assert_array_equal(starts, episodes.from_index)
    np.testing.assert_array_equal(ends - starts, episodes.lengths)
    if judged:
        np.testing.assert_array_equal(heights > 0, reached)  # told apart by more than colour
    assert png_size(figure) < 60_000


def test_episodes_are_numbered_where_there_is_room():
    episodes = z2r.EpisodeIndex(np.array([0, 100, 103, 105]), np.array([100, 103, 105, 200]))
    texts = figures.episode_ribbon(episodes).axes[0].texts
    assert [(text.get_text(), text.get_rotation()) for text in texts] == [("0", 0), ("1", 90), ("3", 0)]


@given(yaw=st.floats(-np.pi, np.pi))
@settings(max_examples=20)
def test_the_two_readings_of_a_yaw_add_up_to_90_degrees(yaw):
    axes = figures.yaw_circle(np.sin(yaw), np.cos(yaw)).axes[0]
    right, wrong = (named(axes, name)[0].get_xydata()[-1] for name in ("right", "wrong"))
    np.testing.assert_allclose(right, [np.cos(yaw), np.sin(yaw)], atol=1e-9)
    np.testing.assert_allclose(wrong, right[::-1], atol=1e-9)  # mirrored about the line x = y
    written = [float(text.get_text().removesuffix("°")) for text in axes.texts]
    assert sum(written) % 360 == pytest.approx(90, abs=0.11)
    directions = [np.rad2deg(bar_direction(outlines(axes, f"{name} block")[0])) for name in ("right", "wrong")]
    assert np.abs(np.subtract(written, directions) + 180) % 360 == pytest.approx([180, 180], abs=0.06)


def test_the_mirror_stands_at_45_degrees():
    [mirror] = named(figures.yaw_circle(0.0, 1.0).axes[0], "mirror")
    np.testing.assert_allclose(*mirror.get_data())


def test_traces_are_the_errors_over_seconds_with_their_tolerances():
    errors = z2r.frame_errors(read(FIRST))
    figure = figures.error_traces(errors, z2r.PUSHT, fps=20)
    for axes, name, values, tolerance, unit in (
        (figure.axes[0], "pos_err", errors["pos_err"], 0.03, "m"),
        (figure.axes[1], "ang_err", errors["ang_err"], 0.2, "rad"),
    ):
        [line], [last], [band] = (named(axes, gid) for gid in (name, "last stored frame", "tolerance"))
        np.testing.assert_allclose(line.get_xydata(), np.stack([np.arange(len(FIRST)) / 20, values], axis=1))
        np.testing.assert_allclose(last.get_xydata(), line.get_xydata()[-1:])
        assert (band.get_y(), band.get_height()) == (0, tolerance)
        assert axes.get_ylabel() == f"{name} [{unit}]"
        assert f"tolerance {tolerance} {unit}" in [text.get_text() for text in axes.texts]
    assert figure.axes[1].get_xlabel() == "time [s]"


@pytest.mark.parametrize(("n_frames", "title"), [(None, "in tolerance: reached"), (5, "out of tolerance: not reached")])
def test_traces_say_how_the_last_stored_frame_is_read(n_frames, title):
    errors = z2r.frame_errors(read(FIRST[:n_frames]))
    assert figures.error_traces(errors, z2r.PUSHT, 10).axes[0].get_title(loc="left").endswith(f"is {title}")


@pytest.mark.parametrize("mode", [None, "yaw-swap"])
@pytest.mark.parametrize("root", [z2r.STANDIN, z2r.MESSY])
def test_final_poses_are_counted_as_the_inspection_counts_them(root, mode):
    dataset = z2r.load(root)
    inspection = z2r.inspect_dataset(dataset, z2r.break_mode(mode) if mode else None)
    n_reached, n_episodes = inspection.outcome.n_reached, len(dataset.episodes)
    axes = figures.final_poses(dataset, inspection.reading).axes[0]
    counts = [int(number) for number in re.findall(r"\d+", axes.get_title(loc="left"))]
    assert counts == [n_episodes, n_reached, n_episodes - n_reached]
    assert len(outlines(axes, "reached")) == n_reached
    assert len(outlines(axes, "not reached")) == n_episodes - n_reached
    assert named(axes, "reached")[0].get_linestyle() != named(axes, "not reached")[0].get_linestyle()


def test_no_figure_stays_open_and_a_notebook_style_is_neither_used_nor_changed():
    plt.close("all")
    with plt.rc_context({"figure.facecolor": "black", "font.size": 30}):
        drawn = every_figure()
        assert plt.rcParams["font.size"] == 30
    assert plt.get_fignums() == []
    assert {figure.get_facecolor() for figure in drawn.values()} == {(250 / 255, 249 / 255, 246 / 255, 1)}


def test_pictures_are_small_enough_to_commit_in_a_notebook(drawn):
    sizes = {name: png_size(figure) for name, figure in drawn.items()}
    assert {name: size for name, size in sizes.items() if not 0 < size < 60_000} == {}


def test_a_notebook_shows_a_figure_once():
    source = "from z2r.course.figures import two_poses\ntwo_poses((0, 0, 0), (0.1, 0, 1))"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    NotebookClient(notebook, kernel_name="python3", timeout=120).execute()
    outputs = notebook.cells[0].outputs
    assert [list(output.get("data", output)) for output in outputs if "image/png" in output.get("data", {})] != []
    assert len(outputs) == 1


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda: figures.episode_path(read(FIRST[:0])), "found 0 frames"),
        (lambda: figures.episode_ribbon(DATASET.episodes, np.array([True])), "6 episodes and 1 values of reached"),
        (lambda: figures.yaw_circle(0.0, 0.0), "not both zero"),
        (lambda: figures.yaw_circle(np.nan, 1.0), "finite"),
        (
            lambda: figures.error_traces(dict.fromkeys(ERRORS, np.zeros(0)), z2r.PUSHT, 10),
            "found 0 frames",
        ),
        (lambda: figures.error_traces(dict.fromkeys(ERRORS, np.zeros(1)), z2r.PUSHT, 0), "0 fps"),
        (lambda: figures.two_poses((0, 0, 0), (0, 0, np.inf)), "finite"),
    ],
)
def test_what_cannot_be_drawn_is_refused(draw, message):
    with pytest.raises(ValueError, match=message):
        draw()
    assert plt.get_fignums() == []


def test_seen_from_the_block_the_right_reading_leaves_it_empty():
    state = DATASET.read(z2r.PUSHT.feature)
    panels = figures.seen_from_block(read(state), read(state, SWAPPED)).axes
    n_inside = []
    for axes in panels:
        [block] = [collection for collection in axes.collections if collection.get_gid() == "block"]
        [pushers] = [line for line in axes.lines if line.get_gid() == "pusher"]
        assert len(pushers.get_xydata()) == len(state)
        n_inside.append(int(block.get_paths()[0].contains_points(pushers.get_xydata()).sum()))
        assert axes.get_xlabel() == "across the block [m]"
        assert axes.get_aspect() == 1
    assert n_inside[0] == 0 < n_inside[1]


def test_the_fit_of_an_action_is_drawn_for_every_number_of_frames_ahead():
    axes = figures.action_fits(DATASET, 1).axes[0]
    as_target, as_change = (line.get_ydata() for line in axes.lines)
    assert len(as_target) == len(as_change) > 15
    assert int(np.argmax(as_change)) == z2r.infer_action(DATASET)[1].ahead == 1
    assert 99 < as_change[1] <= 100 * z2r.infer_action(DATASET)[1].explained
    with pytest.raises(ValueError, match="expected one of 2"):
        figures.action_fits(DATASET, 2)


def test_moments_show_the_block_where_it_was_and_the_way_of_the_pusher_up_to_then():
    figure = figures.moments(read(FIRST), n_moments=4)
    frames = [int(axes.get_title(loc="left").removeprefix("frame ")) for axes in figure.axes]
    assert frames[0] == 0
    assert frames[-1] == len(FIRST) - 1
    assert len(frames) == 4
    for axes, frame in zip(figure.axes, frames, strict=True):
        [outline] = outlines(axes, "block")
        np.testing.assert_allclose(outline[[0, 1, 2, 7]].mean(axis=0), FIRST[frame, 2:4], atol=1e-6)
        [path] = named(axes, "pusher path")
        np.testing.assert_allclose(path.get_xydata(), FIRST[: frame + 1, :2])
    assert png_size(figure) < 60_000


def test_seams_lead_from_the_last_frame_of_an_episode_to_the_first_of_the_next():
    state, episodes = DATASET.read(z2r.PUSHT.feature), DATASET.episodes
    axes = figures.seams(read(state), episodes).axes[0]
    drawn = [line.get_xydata() for line in named(axes, "seam")]
    expected = [state[[after - 1, after], 2:4] for after in episodes.from_index[1:]]
    np.testing.assert_allclose(drawn, expected)
    paths = [line.get_xydata() for line in named(axes, "block path")]
    np.testing.assert_allclose(np.concatenate(paths), state[:, 2:4])  # no path runs across a seam
    assert [len(path) for path in paths] == episodes.lengths.tolist()
    with pytest.raises(ValueError, match="expected two or more"):
        figures.seams(read(FIRST), DATASET.first(1).episodes)


def test_camera_pictures_are_those_of_the_video():
    import av

    arm, frames = z2r.load(z2r.ARM), [128, 129, 1880]  # on both sides of a seam, and the very last
    panels = figures.camera_pictures(arm, frames).axes
    titles = [axes.get_title(loc="left") for axes in panels]
    assert titles == [f"{camera}, frame {frame:,}" for frame in frames for camera in ("front", "side")]
    for column, camera in enumerate(("front", "side")):
        [path] = (z2r.ARM / f"videos/observation.images.{camera}").rglob("*.mp4")
        with av.open(str(path)) as video:
            every = [picture.to_ndarray(format="rgb24") for picture in video.decode(video=0)]
        for row, frame in enumerate(frames):
            shown = panels[2 * row + column].images[0].get_array()
            assert np.abs(shown.astype(int) - every[frame]).max() <= 2  # of 255: converted another way
    with pytest.raises(ValueError, match="0 cameras"):
        figures.camera_pictures(DATASET, [0])
