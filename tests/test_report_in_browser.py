"""The page that shows a dataset, in a browser: opened from disk, without a network."""

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from axe_playwright_python.sync_playwright import Axe
from damages import BASES
from playwright.sync_api import Browser, Locator, Page, expect
from robots import write_arm, write_hand
from test_report import HOSTILE, make_hostile

import z2r
from z2r.show.page.content import WRONG_READINGS

SHIPPED = {"standin": z2r.STANDIN, "messy": z2r.MESSY}
READINGS = ("right", *WRONG_READINGS)
FOCUSED = "(({ id, value, hash }) => id || value || hash)(document.activeElement)"
NOW = "window.requestAnimationFrame = (draw) => { draw(performance.now()); return 0; }"

type Open = Callable[..., Page]


@pytest.fixture
def open_file(browser: Browser) -> Iterator[Open]:
    """Open a file with no network; at the end, say that it asked for nothing and complained of nothing."""
    faults: list[str] = []
    contexts = []

    def open_file(path: Path, script: str = "", **options) -> Page:
        context = browser.new_context(offline=True, **({"viewport": {"width": 1280, "height": 900}} | options))
        contexts.append(context)
        page = context.new_page()
        page.on("request", lambda request: is_in_the_page(request.url, path) or faults.append(request.url))
        page.on("console", lambda message: faults.append(message.text))
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("dialog", lambda dialog: faults.append(dialog.message))
        page.add_init_script(script)
        page.goto(path.as_uri())
        return page

    yield open_file
    for context in contexts:
        context.close()
    assert not faults


def is_in_the_page(url: str, path: Path) -> bool:
    return url.partition("#")[0] == path.as_uri() or url.startswith("blob:")


@pytest.fixture
def open_report(open_file: Open, tmp_path: Path) -> Open:
    def open_report(root: Path | str, reading: z2r.Reading | None = None, **options) -> Page:
        z2r.write_report(z2r.load(root), tmp_path / "report.html", reading)
        return open_file(tmp_path / "report.html", **options)

    return open_report


@pytest.fixture
def other_robot(standin_copy: Path) -> Path:
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    return standin_copy


def read_as(page: Page, name: str) -> None:
    page.get_by_role("radio", name=name, exact=False).and_(page.locator(f"[value={name}]")).check()


def expect_frame(page: Page, frame: int) -> None:
    expect(page.get_by_role("slider", name="Frame")).to_have_value(f"{frame}")


def test_what_is_stored_of_an_episode_stands_beside_what_is_read(open_report, tmp_path):
    BASES["labelled"](tmp_path / "labelled")
    page = open_report(tmp_path / "labelled")
    expect(page.locator("#verdict")).to_have_text("85 frames, reached, stored: success")
    page.get_by_label("Episode", exact=True).select_option("2")
    expect(page.locator("#verdict")).to_have_text("120 frames, not reached, stored: no success")
    assert Axe().run(page).violations_count == 0
    read_as(page, "drop-boundaries")
    expect(page.locator("#verdict")).not_to_contain_text("stored")


def test_keys_scrub(open_report):
    page = open_report(z2r.STANDIN)
    last = int(z2r.load(z2r.STANDIN).episodes.lengths[0]) - 1
    expect_frame(page, 0)
    for key, frame in [
        ("ArrowRight", 1),
        ("ArrowRight", 2),
        ("Shift+ArrowRight", 12),
        ("ArrowLeft", 11),
        ("Shift+ArrowLeft", 1),
        ("End", last),
        ("ArrowRight", last),
        ("Home", 0),
        ("ArrowLeft", 0),
    ]:
        page.keyboard.press(key)
        expect_frame(page, frame)
        expect(page.locator("#clock")).to_contain_text(f"frame {frame} ")


def test_after_a_click_on_a_reading_the_arrow_keys_step_through_frames(open_report):
    page = open_report(z2r.STANDIN)
    page.locator("#switch label", has=page.locator("[value=yaw-swap]")).click()
    page.wait_for_function("document.activeElement === document.body")
    page.keyboard.press("ArrowRight")
    expect_frame(page, 1)
    expect(page.locator("[value=yaw-swap]")).to_be_checked()


def test_the_keyboard_alone_reaches_everything(open_report):
    page = open_report(z2r.STANDIN)
    for name in ("switch-title", "right", "#findings-title", "episode", "next", "filter", "play", "speed", "frame"):
        page.keyboard.press("Tab")
        assert page.evaluate(FOCUSED) == name
    page.keyboard.press("Shift+ArrowRight")
    expect_frame(page, 10)
    page.locator("[value=right]").focus()
    page.keyboard.press("ArrowRight")  # in a group of radio buttons, arrows choose
    expect(page.locator("[value=yaw-swap]")).to_be_checked()
    expect_frame(page, 10)


def test_it_plays_and_pauses(open_report):
    page = open_report(z2r.STANDIN)
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    expect(page.locator("#frame")).to_have_value(re.compile(r"^([3-9]|\d\d)$"))
    page.get_by_role("button", name="Pause").click()
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    page.keyboard.press("End")
    page.get_by_role("button", name="Play").click()  # at the end, it begins again
    expect(page.locator("#frame")).to_have_value(re.compile(r"^[1-3]?\d$"))


def test_it_goes_on_playing_in_another_reading(open_report):
    page = open_report(z2r.STANDIN)
    first = int(z2r.load(z2r.STANDIN).episodes.from_index[3])
    page.get_by_role("combobox", name="Episode").select_option("3")
    page.get_by_role("button", name="Play").click()
    read_as(page, "drop-boundaries")
    page.wait_for_timeout(100)
    assert int(page.locator("#frame").input_value()) >= first
    before = page.locator("#frame").input_value()
    expect(page.locator("#frame")).not_to_have_value(before)
    expect(page.get_by_role("button", name="Pause")).to_be_visible()


def test_the_mouse_scrubs_and_picks(open_report):
    page = open_report(z2r.STANDIN)
    episodes = z2r.load(z2r.STANDIN).episodes
    plot = page.get_by_role("img", name="Distance to the target over time")
    box = plot.bounding_box()
    plot.click(position={"x": box["width"] / 2, "y": 20})
    expect_frame(page, round((episodes.lengths[0] - 1) / 2))
    ribbon = page.get_by_role("img", name="Episodes by length")
    middle = (episodes.from_index[4] + episodes.to_index[4]) / 2 / episodes.n_frames
    ribbon.click(position={"x": middle * ribbon.bounding_box()["width"], "y": 15})
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("4")
    expect(page.locator("#verdict")).to_have_text(f"{episodes.lengths[4]} frames, reached")
    expect_frame(page, 0)
    page.get_by_role("button", name="Next episode").click()
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("5")
    expect(page.get_by_role("button", name="Next episode")).to_be_disabled()
    page.get_by_role("button", name="Previous episode").click()
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("4")


COUNT_SEARCHES = """
window.searches = 0;
for (const kind of [Document, Element])
  for (const name of ["querySelector", "querySelectorAll", "getElementsByClassName"]) {  // an id is looked up at once
    const search = kind.prototype[name];
    if (search) kind.prototype[name] = function (...what) { window.searches += 1; return search.apply(this, what); };
  }
"""


@pytest.mark.parametrize("name", SHIPPED)
def test_a_step_lays_the_page_out_once_and_searches_nothing_in_it(name, open_file, tmp_path):
    z2r.write_report(z2r.load(name), tmp_path / "report.html")
    page = open_file(tmp_path / "report.html", COUNT_SEARCHES)
    counts = page.context.new_cdp_session(page)
    counts.send("Performance.enable")

    def layouts() -> int:
        metrics = {each["name"]: each["value"] for each in counts.send("Performance.getMetrics")["metrics"]}
        return int(metrics["LayoutCount"])

    page.keyboard.press("ArrowRight")  # which stops what moves by itself, and decodes what is decoded once
    page.wait_for_timeout(300)
    assert page.evaluate("window.searches") > 0  # the page was made with some
    page.evaluate("window.searches = 0")
    counted = []
    for _ in range(9):
        before = layouts()
        page.evaluate(
            """() => { document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
            return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))); }"""
        )
        counted.append(layouts() - before)
    assert page.evaluate("window.searches") == 0
    assert sorted(counted)[4] == 1  # the browser itself may do one more now and then


def seconds_of(plot: Locator) -> list[float]:
    """The seconds that stand at the axis of a chart."""
    return [float(each.removesuffix(" s")) for each in plot.locator(".tick").all_text_contents()]


IN_THE_MIDDLE = "() => Math.abs(parseFloat(document.querySelector('.trace .cursor').getAttribute('x1')) - 50) < 1"


def test_charts_come_closer_around_the_frame_and_follow_it(open_report):
    page = open_report(z2r.STANDIN)
    plot = page.get_by_role("img", name="Distance to the target over time")
    whole, lines = seconds_of(plot), plot.locator(".line").get_attribute("points")
    for _ in range(3):
        page.keyboard.press("Shift+ArrowRight")
    expect_frame(page, 30)
    for _ in range(2):
        page.keyboard.press("+")
    last = int(z2r.load(z2r.STANDIN).episodes.lengths[0]) - 1
    assert all(
        3 - last / 80 <= second <= 3 + last / 80 for second in seconds_of(plot)
    )  # a quarter, at 10 frames a second
    assert len(seconds_of(plot)) >= 3
    page.wait_for_function(IN_THE_MIDDLE)
    page.keyboard.press("Shift+ArrowRight")
    expect_frame(page, 40)
    page.wait_for_function(IN_THE_MIDDLE)
    assert max(seconds_of(plot)) > 4
    for _ in range(2):
        page.keyboard.press("-")
    assert (seconds_of(plot), plot.locator(".line").get_attribute("points")) == (whole, lines)


def test_a_double_click_brings_a_chart_closer_and_back(open_report):
    page = open_report(z2r.STANDIN)
    plot = page.get_by_role("img", name="Distance to the target over time")
    whole, last = seconds_of(plot), int(z2r.load(z2r.STANDIN).episodes.lengths[0]) - 1
    middle = {"x": plot.bounding_box()["width"] / 2, "y": 20}
    plot.dblclick(position=middle)
    expect_frame(page, round(last / 2))
    assert whole[0] < seconds_of(plot)[0]
    assert seconds_of(plot)[-1] < whole[-1]
    plot.click(position={"x": 1, "y": 20})
    expect_frame(page, round(last / 2 - last / 8))
    plot.dblclick(position=middle)
    assert seconds_of(plot) == whole
    page.get_by_role("combobox", name="Episode").select_option("2")
    expect(plot.locator(".cursor")).to_have_attribute("x1", "0%")


@pytest.mark.parametrize("name", SHIPPED)
def test_a_reading_changes_the_percentage_and_the_table(name, open_report):
    page = open_report(SHIPPED[name])
    dataset = z2r.load(SHIPPED[name])
    for reading in (*WRONG_READINGS, "right"):
        read_as(page, reading)
        outcome = z2r.inspect_dataset(dataset, None if reading == "right" else z2r.break_mode(reading)).outcome
        expect(page.locator(".percent:visible")).to_have_text(f"{outcome.share_reached:.0%}")
        expect(page.get_by_role("status")).to_contain_text(f"{outcome.n_reached} of {len(outcome.reached)}")
        rows = page.locator("table.numeric:visible tbody tr")
        expect(rows).to_have_count(len(outcome.reached))
        assert rows.locator("td:last-child").all_inner_texts() == ["yes" if yes else "no" for yes in outcome.reached]


EVERY_FRAME = """() => {
  const [episode, frame] = [document.getElementById("episode"), document.getElementById("frame")];
  const bodies = [...document.querySelectorAll("#scene .body")];
  const yaws = [...document.querySelectorAll("[data-yaw]")];
  const numbers = (body) => body.getAttribute("transform").match(/-?[\\d.]+(e-?\\d+)?/g).map(Number);
  const texts = (selector) => [...document.querySelectorAll(selector)].map((part) => part.textContent);
  // In the order of the columns: a joint and its command share a chart.
  const inOrder = (one, other) => one.dataset.place - other.dataset.place;
  const values = () => [...document.querySelectorAll("#plots .value")].sort(inOrder);
  const seen = [];
  for (let e = 0; e < episode.options.length; e++) {
    episode.value = e;
    episode.dispatchEvent(new Event("change"));
    for (let i = 0; i <= Number(frame.max); i++) {
      frame.value = i;
      frame.dispatchEvent(new Event("input"));
      seen.push({
        bodies: Object.fromEntries(bodies.map((body) => [body.dataset.pose, numbers(body)])),
        columns: texts("[data-column]").map(Number),
        plots: values().map((value) => Number(value.textContent)),
        yaws: Object.fromEntries(yaws.map((cell) => [cell.dataset.yaw, parseFloat(cell.textContent)])),
        goals: texts(".goal .value").map(parseFloat),
        holds: texts(".goal .mark").map((text) => text.startsWith("\\u2713")),
      });
    }
  }
  return seen;
}"""


def shown(seen: list[dict], field: str) -> np.ndarray:
    return np.array([frame[field] for frame in seen])


def assert_drawn_as_read(seen: list[dict], dataset: z2r.Dataset, reading: z2r.Reading) -> None:
    """Every body in its place, every yaw, every error, and whether each goal holds, in every frame of the dataset."""
    assert len(seen) == dataset.episodes.n_frames
    decoded = z2r.decode({name: dataset.read(name) for name in dataset.schema.signals()}, reading, dataset.schema)
    errors = z2r.frame_errors(decoded)
    for name in reading.poses:
        pose = decoded.pose(name)
        x, y, turn = np.array([frame["bodies"][name] for frame in seen]).T
        np.testing.assert_array_equal([x, y], [pose.x, pose.y])
        # In the page, numbers are as wide as the data, which is float32.
        np.testing.assert_allclose(turn, 0 if pose.yaw is None else np.rad2deg(pose.yaw), atol=2e-5)
        if pose.yaw is not None:
            np.testing.assert_allclose([frame["yaws"][name] for frame in seen], pose.yaw, atol=5.1e-5)
    np.testing.assert_allclose(shown(seen, "goals").T, list(errors.values()), atol=5.1e-5)
    holds = shown(seen, "holds").T
    np.testing.assert_array_equal(holds, [goal.holds(errors[goal.name]) for goal in reading.goal])
    np.testing.assert_array_equal(holds.all(axis=0), z2r.in_tolerance(errors, reading))


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name", SHIPPED)
def test_every_frame_is_drawn_as_the_package_reads_it(name, reading, open_report):
    page = open_report(SHIPPED[name], script=NOW)
    read_as(page, reading)
    seen = page.evaluate(EVERY_FRAME)
    dataset = z2r.load(SHIPPED[name])
    rule = z2r.PUSHT if reading == "right" else z2r.break_mode(reading).reading(z2r.PUSHT)
    assert_drawn_as_read(seen, dataset, rule)
    state, action = dataset.read("observation.state"), dataset.read("action")
    np.testing.assert_allclose(shown(seen, "columns"), np.concatenate([state, action], axis=1), atol=5.1e-5)


def test_the_formula_that_is_wrong_is_marked_and_the_other_is_not(open_report):
    page = open_report(z2r.STANDIN)
    changed = page.locator("code.changed")
    expect(changed).to_have_count(0)
    read_as(page, "yaw-swap")
    expect(changed).to_have_text(["atan2(cos_tee_yaw, sin_tee_yaw)"])
    read_as(page, "yaw-swap-everywhere")
    expect(changed).to_have_count(2)


def test_a_reading_keeps_the_frame_of_the_dataset_that_is_looked_at(open_report):
    page = open_report(z2r.STANDIN)
    episodes = z2r.load(z2r.STANDIN).episodes
    page.get_by_role("combobox", name="Episode").select_option("3")
    page.locator("#frame").focus()
    page.keyboard.press("Shift+ArrowRight")
    read_as(page, "drop-boundaries")
    expect_frame(page, int(episodes.from_index[3]) + 10)
    expect(page.locator("#verdict")).to_have_text(f"{episodes.n_frames} frames, reached")
    read_as(page, "right")
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("3")
    expect_frame(page, 10)


def test_with_javascript_off_it_still_says_and_shows_what_is_in_the_dataset(open_report):
    page = open_report(z2r.STANDIN, java_script_enabled=False)
    expect(page.locator(".percent:visible")).to_have_text("100%")
    expect(page.locator(".tally:visible")).to_contain_text("6 of 6 reached the target")
    expect(page.get_by_role("cell", name="cos_target_yaw", exact=True)).to_be_visible()
    expect(page.locator("table.numeric:visible tbody tr")).to_have_count(6)
    expect(page.locator("#scene [data-pose=tee].body")).to_be_visible()
    expect(page.locator("#transport")).to_be_hidden()
    expect(page.locator("#switch")).to_be_hidden()
    dataset = z2r.load(z2r.STANDIN)
    last = dataset.read("observation.state")[dataset.episodes[0]][-1:]
    [distance] = z2r.frame_errors(z2r.decode(last, z2r.PUSHT, dataset.schema))["pos_err"]
    expect(page.locator(".goal .value").first).to_have_text(f"{distance:.4f} m")
    expect(page.locator(".mark")).to_have_text(["✓ within 0.03 m", "✓ within 0.2 rad"])


@pytest.mark.parametrize("kind", ["standin", "other robot", "hostile"])
def test_a_phone_needs_no_scrolling_sideways(kind, open_report, standin_copy):
    if kind == "hostile":
        standin_copy = make_hostile(standin_copy)
    if kind == "other robot":
        path = standin_copy / "meta/info.json"
        path.write_text(path.read_text().replace("tee_x", "cube_x" * 100))
    page = open_report(standin_copy, viewport={"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert (
        page.evaluate(
            "Math.max(...[...document.querySelectorAll('body *')].map((e) => e.getBoundingClientRect().right))"
        )
        <= 390
    )


def test_names_of_a_dataset_are_shown_and_never_run(open_report, standin_copy, other_robot):
    page = open_report(make_hostile(other_robot))
    assert page.locator("img[src], iframe").count() == 0
    expect(page.get_by_role("heading", level=1)).to_contain_text("<img src=x")
    expect(page.locator("figure", has_text=HOSTILE)).to_have_count(1)
    expect(page.get_by_role("cell", name=HOSTILE)).to_have_count(1)


def test_another_robot_gets_a_trace_for_every_dimension(open_report, standin_copy, other_robot):
    page = open_report(other_robot)
    dataset = z2r.load(other_robot)
    expect(page.locator("#switch").get_by_role("radio")).to_have_count(0)
    expect(page.locator(".percent")).to_have_count(0)
    values = np.concatenate([dataset.read("observation.state"), dataset.read("action")], axis=1)
    expect(page.locator("#plots figure")).to_have_count(values.shape[1])
    expect(page.get_by_text("charts 1 to")).to_be_hidden()
    page.get_by_role("combobox", name="Episode").select_option("2")
    page.locator("#frame").focus()
    page.keyboard.press("ArrowRight")
    expect_frame(page, 1)
    shown = [float(text) for text in page.locator("#plots .value").all_inner_texts()]
    np.testing.assert_allclose(shown, values[dataset.episodes.from_index[2] + 1], atol=5e-4)


def test_an_episode_without_a_goal_is_not_drawn_as_if_it_had_reached_one(open_report, standin_copy, other_robot):
    def fill(page: Page, what: str) -> str:
        return page.locator(f".ribbon .{what}").first.evaluate("bar => getComputedStyle(bar).fill")

    assert fill(open_report(other_robot), "episode") != fill(open_report(z2r.STANDIN), "reached")


def test_many_dimensions_are_drawn_some_at_a_time(open_report, standin_copy):
    path = next(standin_copy.glob("data/*/*.parquet"))
    table = pq.read_table(path)
    force = np.tile(np.arange(30.0), (len(table), 1))
    force[3, 1] = np.nan
    pq.write_table(table.append_column("observation.force", pa.array(list(force))), path)
    info = json.loads((standin_copy / "meta/info.json").read_text())
    info["features"]["observation.state"]["names"] = None
    info["features"]["observation.force"] = {"dtype": "float64", "shape": [30], "names": None}
    (standin_copy / "meta/info.json").write_text(json.dumps(info))
    page = open_report(standin_copy)
    expect(page.locator("#which")).to_have_text("charts 1 to 24 of 42")
    page.get_by_role("button", name="Charts after").click()
    expect(page.locator("#which")).to_have_text("charts 25 to 42 of 42")
    expect(page.locator("#plots h4").last).to_have_text("observation.force")
    expect(page.locator("#plots figcaption").last).to_contain_text("[29] 29")
    expect(page.get_by_role("button", name="Charts after")).to_be_disabled()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["standin", "yaw-swap", "other robot", "phone"])
def test_nothing_stands_in_the_way_of_assistive_technology(kind, scheme, open_report, standin_copy):
    if kind == "other robot":
        path = standin_copy / "meta/info.json"
        path.write_text(path.read_text().replace("tee_x", "cube_x"))
    size = {"width": 390, "height": 844} if kind == "phone" else {"width": 1280, "height": 900}
    page = open_report(standin_copy, viewport=size, color_scheme=scheme, reduced_motion="reduce")
    if kind == "yaw-swap":
        read_as(page, "yaw-swap")
    page.keyboard.press("ArrowRight")
    results = Axe().run(page)
    assert results.response["passes"]
    assert not results.response["violations"], results.generate_report()


def test_the_panel_of_a_notebook_works_and_cannot_reach_out_of_its_frame(open_file, tmp_path):
    panel = z2r.panel(z2r.load(z2r.STANDIN))
    (tmp_path / "notebook.html").write_text(f"<!doctype html><p id=here>text</p>{panel._repr_html_()}")
    page = open_file(tmp_path / "notebook.html")
    frame = page.frame_locator("iframe")
    expect(frame.locator(".percent:visible")).to_have_text("100%")
    expect(frame.locator("[value=yaw-swap]")).to_be_hidden()  # whoever is asked to predict it has not seen it
    frame.get_by_text("How is it read?").click()
    frame.locator("[value=yaw-swap]").check()
    expect(frame.locator(".percent:visible")).to_have_text("0%")
    assert (
        page.frames[1].evaluate("(() => { try { return parent.document.title } catch (e) { return e.name } })()")
        == "SecurityError"
    )


BROKEN_WORDS = """() => {
  const isBroken = (node, { 0: word, index }) => {
    const range = document.createRange();
    range.setStart(node, index);
    range.setEnd(node, index + word.length);
    return new Set([...range.getClientRects()].filter((box) => box.width).map((box) => Math.round(box.top))).size > 1;
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const broken = [];
  while (walker.nextNode()) {
    const node = walker.currentNode;
    if (!node.parentElement.checkVisibility()) continue;
    const words = [...node.data.matchAll(/[^\\s-]+/g)];
    broken.push(...words.filter((word) => isBroken(node, word)).map(([word]) => word));
  }
  return broken;
}"""


@pytest.mark.parametrize("width", [700, 820, 960, 1100])
def test_the_panel_is_as_high_as_what_it_shows_and_breaks_no_word(width, open_file, tmp_path):
    (tmp_path / "notebook.html").write_text(f"<!doctype html>{z2r.panel(z2r.STANDIN)._repr_html_()}")
    page = open_file(tmp_path / "notebook.html", viewport={"width": width, "height": 900})
    frame = page.frames[1]
    for _ in range(2):  # with the wrong readings closed, and open
        page.wait_for_function("(frame) => frame.clientHeight !== 1180", arg=page.locator("iframe").element_handle())
        page.wait_for_timeout(100)
        below = frame.evaluate("innerHeight - document.documentElement.getBoundingClientRect().height")
        assert 0 <= below < 1
        assert frame.evaluate(BROKEN_WORDS) == []
        frame.get_by_text("How is it read?").click()


def test_where_frames_are_taken_out_of_a_notebook_a_picture_is_there(open_file, tmp_path):
    html = z2r.panel(z2r.load(z2r.STANDIN))._repr_html_()
    (tmp_path / "notebook.html").write_text(f"<!doctype html>{html.partition('<iframe')[0]}")
    page = open_file(tmp_path / "notebook.html", java_script_enabled=False)
    expect(page.get_by_text("6 of 6")).to_be_visible()
    box = page.locator("img").bounding_box()
    assert box["height"] == pytest.approx(box["width"], rel=0.05)
    expect(page.get_by_text("to look at every frame")).to_be_visible()


ROBOTS = {"hand": write_hand, "arm": write_arm}


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name", ROBOTS)
def test_every_frame_of_another_robot_is_drawn_as_the_package_reads_it(name, reading, open_report, tmp_path):
    dataset, right = ROBOTS[name](tmp_path / "robot")
    page = open_report(dataset.root, right, script=NOW)
    mode = None if reading == "right" else z2r.break_mode(reading)
    if mode and not mode.applies_to(dataset, right):
        expect(page.locator(f"[value={reading}]")).to_have_count(0)
        return
    read_as(page, reading)
    seen = page.evaluate(EVERY_FRAME)
    assert_drawn_as_read(seen, dataset, mode.reading(right) if mode else right)
    columns = np.concatenate([dataset.read("observation.state"), dataset.read("action")], axis=1)
    if right.poses:
        np.testing.assert_allclose(shown(seen, "columns"), columns, atol=5.1e-5)
    else:
        np.testing.assert_allclose(shown(seen, "plots"), columns, atol=6e-4 * np.abs(columns).max())
    outcome = z2r.inspect_dataset(dataset, mode, right).outcome
    expect(page.locator(".tally:visible")).to_contain_text(outcome.tally)


@pytest.mark.parametrize("name", ROBOTS)
def test_keys_scrub_through_another_robot(name, open_report, tmp_path):
    dataset, reading = ROBOTS[name](tmp_path / "robot")
    page = open_report(dataset.root, reading)
    last = int(dataset.episodes.lengths[0]) - 1
    for key, frame in [("ArrowRight", 1), ("Shift+ArrowRight", 11), ("ArrowLeft", 10), ("End", last), ("Home", 0)]:
        page.keyboard.press(key)
        expect_frame(page, frame)
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()


@pytest.mark.parametrize("name", ROBOTS)
def test_a_phone_shows_another_robot_without_scrolling_sideways(name, open_report, tmp_path):
    dataset, reading = ROBOTS[name](tmp_path / "robot")
    page = open_report(dataset.root, reading, viewport={"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ROBOTS)
def test_another_robot_is_there_for_assistive_technology(name, scheme, open_report, tmp_path):
    dataset, reading = ROBOTS[name](tmp_path / "robot")
    page = open_report(dataset.root, reading, color_scheme=scheme, reduced_motion="reduce")
    page.keyboard.press("ArrowRight")
    results = Axe().run(page)
    assert results.response["passes"]
    assert not results.response["violations"], results.generate_report()


def test_a_hand_is_drawn_with_a_line_that_shows_how_it_is_turned(open_report, tmp_path):
    dataset, reading = write_hand(tmp_path / "robot")
    page = open_report(dataset.root, reading)
    seen = page.locator("#scene [data-pose=hand] .heading").evaluate(
        "(line) => [getComputedStyle(line).stroke, getComputedStyle(document.querySelector('.scene .floor')).fill]"
    )
    assert seen[0] != seen[1]


GOALS = {
    "at most": 'value = "gripper.pos"\nat_most = 40',
    "at least": 'value = "shoulder_pan.pos"\nat_least = -1',
    "between": 'value = "shoulder_pan.pos"\nat_most = 2\nat_least = -2',
    "within": 'value = "shoulder_pan.pos"\nwithin = 2',
    "stored": 'stored = "gripper.pos"',
}


@pytest.mark.parametrize("goal", GOALS)
def test_a_trace_is_shaded_where_its_goal_holds(goal, open_report, tmp_path):
    dataset, _ = write_arm(tmp_path / "robot")
    (tmp_path / "mine.toml").write_text(f'[[goal]]\nname = "mine"\n{GOALS[goal]}')
    page = open_report(dataset.root, z2r.read_reading(tmp_path / "mine.toml"))
    for _ in range(3):
        page.keyboard.press("Shift+ArrowRight")
        page.keyboard.press("ArrowRight")
        expect(page.locator(".goal .value")).not_to_have_text("")
        page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
        dot, shade = (
            page.locator(f".goal {part}").evaluate(
                "(part) => ['cy', 'y', 'height'].map((name) => parseFloat(part.getAttribute(name)))"
            )
            for part in (".dot", ".band")
        )
        inside = shade[1] <= dot[0] <= shade[1] + shade[2]
        holds = page.locator(".goal .mark").inner_text().startswith("✓")
        assert inside == holds or goal == "stored"
    limit = page.locator(".goal .mark").inner_text()
    assert limit.endswith("above 0" if goal == "stored" else ("-1", "2", "-2", "40"))
