"""The pictures of the course that move by hand: alone in their frame, small, and with the numbers of the package."""

import base64
import io
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from itertools import islice, pairwise
from pathlib import Path

import av
import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from IPython import display
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image
from playwright.sync_api import Page, expect
from test_report import Elements
from test_report_in_browser import open_file

import z2r
from z2r.course import animated, moving
from z2r.course.field_guide import what_changes
from z2r.course.moving.picture import MovingPicture
from z2r.pusht.overlap import LIMIT, overlap
from z2r.pusht.world import BODIES
from z2r.reading.breaks import BREAK_MODES

__all__ = ["open_file"]  # a fixture

PICTURES: dict[str, Callable[[], MovingPicture]] = {
    "yaw": moving.yaw_slider,
    "seam": moving.seam,
    "seam of an arm": lambda: moving.seam("arm"),
    "tolerance": moving.tolerance_box,
    "story": moving.story,
    "contact": moving.push_in,
    "changes": lambda: moving.changes_table(what_changes(z2r.MESSY)),
}
MOVE_BY_THEMSELVES = {"yaw", "seam", "tolerance", "story", "contact"}
DATASET, MESSY = z2r.load(z2r.STANDIN), z2r.load(z2r.MESSY)
STATES = DATASET.read(z2r.PUSHT.feature)
SWAPPED = z2r.break_mode("yaw-swap").reading(z2r.PUSHT)

each_picture = pytest.mark.parametrize("name", PICTURES)


@cache
def picture(name: str) -> MovingPicture:
    return PICTURES[name]()


@pytest.fixture
def open_picture(open_file, tmp_path) -> Callable[..., Page]:
    def open_picture(name: str, **options) -> Page:
        (tmp_path / "picture.html").write_text(picture(name).page)
        return open_file(tmp_path / "picture.html", **options)

    return open_picture


def data_of(name: str) -> dict:
    return json.loads(Elements(picture(name).page).text["script application/json"])


def outputs(name: str, monkeypatch: pytest.MonkeyPatch) -> list[dict[str, str]]:
    """What it gives a notebook to show."""
    shown: list[dict[str, str]] = []
    monkeypatch.setattr(display, "display", lambda data, **_: shown.append(data))
    picture(name)._ipython_display_()
    return shown


@each_picture
def test_it_is_the_same_each_time(name):
    assert PICTURES[name]() == picture(name)


@each_picture
def test_it_says_in_one_line_what_it_is_and_gives_a_still_and_a_page(name, monkeypatch):
    made = picture(name)
    assert re.fullmatch(r"Moving picture: \S.*", repr(made))
    still, page = outputs(name, monkeypatch)
    assert still == {"text/plain": repr(made), "image/png": base64.b64encode(made.still).decode()}
    assert list(page) == ["text/html"]
    [frame] = [attributes for tag, attributes in Elements(page["text/html"]).elements if tag == "iframe"]
    assert (frame["srcdoc"], frame["sandbox"]) == (made.page, "allow-scripts")
    assert len(made.still) <= 200_000
    assert sum(map(len, (*still.values(), *page.values()))) <= 250_000


@each_picture
def test_the_still_is_a_png_that_moves_and_stands_at_the_end_where_nothing_does(name):
    still = Image.open(io.BytesIO(picture(name).still))
    assert still.format == "PNG"
    assert 400 <= still.width <= 960
    assert still.is_animated == (name in MOVE_BY_THEMSELVES)
    if still.is_animated:
        shown = []
        for number in range(still.n_frames):
            still.seek(number)
            shown.append(np.asarray(still.convert("RGB")))
        assert np.array_equal(shown[0], shown[-1])
        assert not np.array_equal(shown[1], shown[-1])


@each_picture
def test_it_needs_nothing_but_itself(name):
    page = re.sub(r"http://www.w3.org/2000/svg|data:image/webp;base64,[\w+/=]+", "", picture(name).page)
    assert not re.search(r"https?:|//\w|@import|url\(|\bfetch\b|XMLHttpRequest|^import |^export |import\(", page, re.M)
    policy = next(each["content"] for tag, each in Elements(page).elements if each.get("http-equiv"))
    assert policy.startswith("default-src 'none';")


@each_picture
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_and_nothing_stands_in_the_way_of_assistive_technology(name, scheme, open_picture):
    page = open_picture(name, viewport={"width": 700, "height": 900}, color_scheme=scheme)
    results = Axe().run(page)
    assert results.response["passes"]
    assert not results.response["violations"], results.generate_report()
    root = page.evaluate("(({ scrollWidth, clientWidth }) => [scrollWidth, clientWidth])(document.documentElement)")
    assert root[0] == root[1]
    assert page.evaluate("[...document.querySelectorAll('button, input')].every((each) => each.tabIndex === 0)")


@each_picture
def test_where_scripts_run_the_page_takes_the_place_of_its_own_still(name, open_file, tmp_path, monkeypatch):
    still, page = outputs(name, monkeypatch)
    image = f'<img src="data:image/png;base64,{still["image/png"]}">'
    before = "".join(f'<div class="{which}">{image}</div>' for which in ("other", "own"))
    cell = f"<!doctype html><div>{before}<div><p></p><div>{{}}</div></div></div>"
    path = tmp_path / "notebook.html"
    path.write_text(cell.format(page["text/html"]))
    shown = open_file(path, viewport={"width": 720, "height": 900})
    expect(shown.locator(".own img")).to_be_hidden()
    expect(shown.locator(".other img")).to_be_visible()
    frame = shown.frames[1]
    spare = "innerHeight - document.documentElement.getBoundingClientRect().height"
    for _ in range(300):  # not by `wait_for_function`: it evaluates text later, which the page forbids
        if fits := frame.evaluate(f"innerHeight !== 420 && {spare} >= 0 && {spare} < 1"):
            break
        shown.wait_for_timeout(100)
    assert fits
    path.write_text(cell.format(page["text/html"].partition("<iframe")[0]))
    expect(open_file(path, java_script_enabled=False).locator(".own img")).to_be_visible()


def test_a_yaw_is_decoded_as_the_package_decodes_it(open_picture):
    page = open_picture("yaw")
    outline = np.array(data_of("yaw")["body"]["outline"])
    np.testing.assert_allclose(outline, BODIES["tee"].outline, atol=1e-5)
    for degrees in (-180, -135, -90, 0, 45, 120):
        page.get_by_role("slider").fill(f"{degrees}")
        sine, cosine = np.sin(np.deg2rad(degrees)), np.cos(np.deg2rad(degrees))
        for reading, pair in (("right", (sine, cosine)), ("wrong", (cosine, sine))):
            expected = np.rad2deg(z2r.decode_yaw(*pair))
            said = float(page.locator(f"#{reading}-yaw").inner_text().removesuffix("°"))
            drawn = float(re.search(r"rotate\((.*)\)", page.locator(f"#{reading} path").get_attribute("transform"))[1])
            for found in (said, drawn):
                assert z2r.wrap_angle(np.deg2rad(found - expected)) == pytest.approx(0, abs=1e-6)
        point = [float(page.locator("#point").get_attribute(end)) for end in ("cx", "cy")]
        np.testing.assert_allclose(point, (cosine, -sine), atol=1e-9)
    box = page.locator("#circle").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 5)
    page.mouse.down()
    page.mouse.up()
    expect(page.get_by_role("slider")).to_have_value("90")


def place_of(page: Page, role: str) -> list[float]:
    """Where a body is drawn: x and y in metres, and its yaw in degrees."""
    transform = page.locator(f"#scene .{role}").last.get_attribute("transform")
    return [float(number) for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", transform)]


def test_across_a_seam_the_block_leaps_as_it_does_in_the_data(open_picture):
    page = open_picture("seam")
    end = int(DATASET.episodes.to_index[0])
    block = z2r.decode(STATES, z2r.PUSHT, DATASET.schema).pose("tee")
    expect(page.locator("#frame")).to_have_text(f"frame {end - 1}")
    expect(page.locator("#which")).to_have_text("the last of episode 0")
    page.get_by_role("slider").focus()
    for frame, which in ((end, "the first of episode 1"), (end + 1, "in episode 1")):
        page.keyboard.press("ArrowRight")
        expect(page.locator("#which")).to_have_text(which)
        moved = np.hypot(*(values[frame] - values[frame - 1] for values in (block.x, block.y)))
        expect(page.locator("#moved")).to_contain_text(f"block moved by {moved:.3f} m")
        expected = block.x[frame], block.y[frame], np.rad2deg(block.yaw[frame])
        np.testing.assert_allclose(place_of(page, "object"), expected, atol=1e-3)
    expect(page.locator("#chart .leap")).to_have_count(1)
    page.get_by_role("img", name="How far").click(position={"x": 2, "y": 30})
    expect(page.get_by_role("slider")).to_have_value("0")


def decoded_from(folder: Path) -> Iterator[np.ndarray]:
    [path] = folder.rglob("*.mp4")
    with av.open(path) as file:
        yield from (frame.to_ndarray(format="rgb24") for frame in file.decode(video=0))


def test_the_cameras_of_an_arm_show_the_frame_that_is_looked_at(open_picture):
    dataset, data = z2r.load("arm"), data_of("seam of an arm")
    frames = slice(data["first"], data["first"] + len(data["pictures"]))
    assert (frames.start, frames.stop, data["end"]) == (123, 135, dataset.episodes.to_index[0])
    changes = np.abs(np.diff(dataset.read("observation.state")[frames].astype(float), axis=0)).max(axis=1)
    np.testing.assert_allclose(data["steps"], changes, atol=1e-5)
    seen = [np.asarray(Image.open(io.BytesIO(base64.b64decode(each.partition(",")[2])))) for each in data["pictures"]]
    differences = [np.abs(now.astype(float) - before).mean() for before, now in pairwise(seen)]
    assert np.argmax(differences) == np.argmax(changes) == data["end"] - data["first"] - 1
    filmed = list(islice(decoded_from(dataset.root / "videos/observation.images.front"), frames.stop))
    for frame, shown in zip(range(frames.start, frames.stop), seen, strict=True):
        front = shown[:, : shown.shape[1] // 2].astype(float)
        apart = [np.abs(front - other).mean() for other in filmed[frames]]
        assert np.argmin(apart) == frame - frames.start
    page = open_picture("seam of an arm")
    expect(page.locator("#camera")).to_have_attribute("src", data["pictures"][5])
    page.get_by_role("slider").fill("6")
    expect(page.locator("#camera")).to_have_attribute("src", data["pictures"][6])


def test_a_seam_needs_two_episodes_and_something_to_show(standin_copy):
    with pytest.raises(ValueError, match="found episode 5, expected one of 6 that is not the last"):
        moving.seam("standin", 5)
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    with pytest.raises(ValueError, match="neither poses in a reading nor a video"):
        moving.seam(standin_copy)


def test_as_many_are_within_limits_as_the_reading_counts(open_picture):
    page = open_picture("tolerance")
    errors = z2r.inspect_dataset(MESSY).outcome.final_errors
    for pos_tol, ang_tol in ((0.03, 0.2), (0.04, 0.2), (0.04, 0.06), (0.06, 0.4), (0.001, 0.2)):
        page.get_by_label("pos_err").fill(f"{pos_tol}")
        page.get_by_label("ang_err").fill(f"{ang_tol}")
        reading = z2r.PUSHT.with_goal("pos_err", within=pos_tol).with_goal("ang_err", within=ang_tol)
        inside = z2r.in_tolerance(errors, reading)
        expect(page.locator("#count")).to_have_text(f"{inside.sum()} of 14 reached")
        expect(page.locator("#plot .cross")).to_have_count(int((~inside).sum()))
    page.get_by_role("button").click()
    expect(page.locator("#count")).to_have_text("11 of 14 reached")
    corner, plot = (page.locator(f"#plot{part}").bounding_box() for part in (" .corner", ""))
    page.mouse.move(corner["x"] + corner["width"] / 2, corner["y"] + corner["height"] / 2)
    page.mouse.down()
    page.mouse.move(corner["x"] + 0.15 * plot["width"], corner["y"] + corner["height"] / 2)
    expect(page.locator("#count")).to_have_text("13 of 14 reached")


def test_the_story_is_that_of_the_errors(open_picture):
    page, data = open_picture("story"), data_of("story")
    errors = z2r.frame_errors(z2r.decode(STATES[DATASET.episodes[0]], z2r.PUSHT, DATASET.schema))
    for trace in data["traces"]:
        np.testing.assert_allclose(trace["values"], errors[trace["name"]], atol=1e-5)
    told = {what: says for _, _, what, says in data["parts"]}
    assert [what for _, _, what, _ in data["parts"]] == ["Walk", "Push 1", "Walk", "Push 2", "Walk", "Push 3", "End"]
    assert "nearer, 118 to 48 mm, and turns it the right way" in told["Push 1"]
    assert "away, 48 to 80 mm, and turns it the right way" in told["Push 2"]
    assert "nearer, 80 to 15 mm" in told["Push 3"]
    for start, stop, what, says in data["parts"]:
        page.get_by_role("button", name=what, exact=True).and_(page.locator(f"[title='{says}']")).last.click()
        assert int(page.get_by_role("slider").input_value()) >= start
        expect(page.locator("#says")).to_have_text(says)
        assert stop - start > 0
    page.get_by_role("button", name="Walk").first.click()
    page.get_by_role("button", name="Play").click()
    expect(page.get_by_role("slider")).to_have_value(re.compile(r"^([2-9]|1\d)$"))
    page.get_by_role("button", name="Pause").click()
    expect(page.get_by_role("button", name="Play")).to_be_visible()


def test_the_overlap_is_that_of_the_package_wherever_the_pusher_is(open_picture):
    page, frame = open_picture("contact"), data_of("contact")["frame"]
    whole = [overlap(z2r.decode(STATES, reading, DATASET.schema)) for reading in (z2r.PUSHT, SWAPPED)]
    assert frame == whole[1].argmax()
    for number, name in enumerate(("read right", "yaw-swap")):
        page.get_by_role("button", name=name).click()
        expect(page.locator("#overlap")).to_have_text(f"{1000 * whole[number][frame]:.1f} mm")
    # By a script, since there are many.
    measured = page.evaluate(
        """(places) => [0, 1].map((reading) => {
          document.getElementById(`read-${reading}`).click();
          return places.map((place) => {
            for (const [i, axis] of ["x", "y"].entries()) {
              const range = document.getElementById(axis);
              range.value = place[i];
              range.dispatchEvent(new Event("input"));
            }
            const said = parseFloat(document.getElementById("overlap").textContent);
            return [said, document.querySelectorAll(".deep").length];
          });
        })""",
        places := [(x, y) for x in range(-150, 151, 12) for y in range(-150, 151, 12)],
    )
    columns = DATASET.schema.columns(z2r.PUSHT.feature, ["pusher_x", "pusher_y", "tee_x", "tee_y"])
    rows = np.repeat(STATES[frame : frame + 1].astype(np.float64), len(places), axis=0)
    rows[:, columns[:2]] = rows[:, columns[2:]] + np.array(places) / 1000
    for reading, found in zip((z2r.PUSHT, SWAPPED), np.array(measured), strict=True):
        expected = overlap(z2r.decode(rows, reading, DATASET.schema))
        np.testing.assert_allclose(found[:, 0], 1000 * expected, atol=0.051)
        assert (found[:, 1] > 0).tolist() == (expected > LIMIT).tolist()
        assert 0 < (expected > 0).sum() < len(places)


def test_the_table_says_of_each_mistake_what_the_package_says(open_picture):
    page, changes = open_picture("changes"), what_changes(z2r.MESSY)
    for change in changes:
        row = page.locator(f"tr[data-name='{change.name}']")
        shown = ["" if text == "·" else text for text in row.locator("td").all_inner_texts()]
        found_by = len(change.checks) or ("" if change.is_dormant else "none")
        assert shown == [*change.marks.values(), f"{found_by}"]
        page.get_by_role("button", name=change.name, exact=True).click()
        expect(page.locator("#first")).to_contain_text(BREAK_MODES[change.name].assumption)
        expect(page.locator("#second")).to_contain_text(BREAK_MODES[change.name].signature)
        expect(page.locator("#third")).to_contain_text(", ".join(change.checks))
        expect(page.locator("tr.chosen")).to_have_count(1)
    page.get_by_role("button", name="action", exact=True).click()
    expect(page.locator("#first")).to_contain_text(", ".join(change.name for change in changes if change.action))
    page.get_by_role("button", name="time", exact=True).focus()
    page.keyboard.press("Enter")
    expect(page.locator("#first")).to_have_text("They change: action, speed.")
    expect(page.locator("tr.chosen")).to_have_count(2)


def test_a_label_of_an_axis_stands_in_a_film_once():
    figure = Figure(figsize=(2, 2), layout="constrained")
    axes = figure.subplots()
    [line], label = axes.plot([0, 1], [0, 1]), axes.set_xlabel("at first")

    def move(frame):
        line.set_ydata([frame, 1])
        label.set_text(f"frame {frame}")
        return [line, label]

    film = Image.open(io.BytesIO(animated.film(figure, move, range(3), 100)))
    canvas = FigureCanvasAgg(figure)
    for frame in range(3):
        move(frame)
        canvas.draw()
        film.seek(frame + 1)
        shown, anew = np.asarray(film.convert("RGB"), int), np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
        below = slice(int(figure.bbox.height - axes.bbox.y0) + 2, None)  # where the ticks and the label are
        assert np.abs(shown[below] - anew[below]).max() < 60
