"""The page in a browser: what cameras saw, a joint and its command, what the audit found, and the address."""

import importlib.util
import io
import re
import shutil
from pathlib import Path

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from axe_playwright_python.sync_playwright import Axe
from filmed import CAMERAS, FPS, FRONT, LENGTHS, video, write_filmed, write_photographed, write_video
from framed import FRAMED, READ_AS
from msgspec.structs import replace
from playwright.sync_api import Page, expect
from robots import JOINTS, write_arm
from test_report import Elements, data_of, pictures_in
from test_report_in_browser import expect_frame, open_file, open_report

import z2r
from z2r.api import choose_reading
from z2r.audits.findings import Finding
from z2r.check import SEVERITIES
from z2r.pusht.task import ACTION_NAMES, STATE_NAMES
from z2r.reading.inspection import inspect_dataset
from z2r.show import report
from z2r.show.page.films import read_films

__all__ = ["open_file", "open_report"]  # fixtures

GREY_A_FRAME = 3


def clock(camera: str, episode: int, states: np.ndarray):
    """Film a wall that gets brighter in every frame, from a level that every episode and camera has for itself."""
    for frame in range(len(states)):
        yield np.full((72, 96, 3), level(camera, episode, frame), np.uint8)


def level(camera: str, episode: int, frame: int) -> int:
    return 20 + GREY_A_FRAME * frame + (camera != FRONT) - 2 * (episode % 2)


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("filmed") / "filmed"
    write_filmed(root, clock)
    return root


def greys(page: Page) -> list[float]:
    """How bright the picture is that each camera shows now."""
    return page.evaluate(
        """async () => {
          const isReady = (seen) => seen.complete ?? (!seen.seeking && seen.readyState > 1);
          const look = async (seen) => {
            while (!isReady(seen)) await new Promise((done) => setTimeout(done, 10));
            const canvas = new OffscreenCanvas(1, 1).getContext("2d");
            canvas.drawImage(seen, 0, 0, 1, 1);
            return canvas.getImageData(0, 0, 1, 1).data[1];
          };
          return Promise.all([...document.querySelectorAll(".screen :is(video, img)")].map(look));
        }"""
    )


def test_cameras_show_the_frame_that_is_looked_at(filmed, open_report):
    page = open_report(filmed)
    for episode, frame in [(0, 0), (0, 1), (0, 59), (3, 0), (3, 7), (7, 51), (1, 30)]:
        page.evaluate(f"location.hash = '#episode={episode}&frame={frame}'")
        expect_frame(page, frame)
        page.wait_for_timeout(50)
        expected = [level(camera, episode, frame) for camera in CAMERAS]
        np.testing.assert_allclose(greys(page), expected, atol=GREY_A_FRAME / 2 + 0.4)


def test_cameras_play_along_and_stop_at_the_end(filmed, open_report):
    page = open_report(filmed)
    page.get_by_label("Speed").select_option("4")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => [...document.querySelectorAll('video')].every((video) => video.currentTime > 0.5)")
    assert page.locator("video").first.evaluate("video => video.playbackRate") == 4
    expect_frame(page, LENGTHS[0] - 1)
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    page.wait_for_timeout(50)
    np.testing.assert_allclose(greys(page)[0], level(FRONT, 0, LENGTHS[0] - 1), atol=2)


@pytest.mark.parametrize("options", [{"g": "2"}, {"g": "25", "bf": "2"}, {"g": "1000"}])
def test_a_clip_holds_the_pictures_of_its_episode_and_no_other_bytes(options, tmp_path):
    write_filmed(tmp_path / "filmed", clock)
    episodes = [list(clock(FRONT, number, np.empty(length))) for number, length in enumerate(LENGTHS)]
    # As one, so that an episode begins between two pictures that can be decoded alone.
    write_video(video(tmp_path / "filmed", FRONT), [[picture for own in episodes for picture in own]], **options)
    inspection = z2r.inspect_dataset(tmp_path / "filmed")
    film = read_films(inspection, inspection.episodes, 10**7)[0]
    assert not film.missing
    whole = video(tmp_path / "filmed", FRONT).read_bytes()
    for episode, clip in enumerate(film.clips):
        assert clip.n_frames == LENGTHS[episode]
        with av.open(io.BytesIO(clip.data)) as file:
            shown = {round(frame.time * FPS): frame.to_ndarray(format="gray").mean() for frame in file.decode(video=0)}
            first = round(clip.offset * FPS)
        expected = [level(FRONT, episode, frame) for frame in range(LENGTHS[episode])]
        greys = [shown[first + frame] for frame in range(LENGTHS[episode])]
        np.testing.assert_allclose(greys, expected, atol=GREY_A_FRAME / 2)
        with av.open(io.BytesIO(clip.data)) as file:
            assert all(bytes(packet) in whole for packet in file.demux(video=0) if packet.size)


def test_where_there_is_no_room_for_all_clips_the_first_are_there_and_the_page_says_so(filmed, tmp_path, monkeypatch):
    dataset = z2r.load(filmed)
    everything = z2r.inspect_dataset(dataset)
    full = read_films(everything, everything.episodes, 10**7)
    monkeypatch.setattr(report, "_MAX_BYTES", 3 * len(full[0].clips[0].data))
    z2r.write_report(dataset, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    cameras = data_of(text)["cameras"]
    assert 0 < len(cameras[0]["clips"]) == len(cameras[1]["clips"]) < len(LENGTHS)
    assert {camera["missing"] for camera in cameras} == {"The page has no room for a clip of this episode."}


def test_of_a_first_clip_that_is_too_large_the_beginning_is_there(filmed):
    inspection = z2r.inspect_dataset(filmed)
    whole = read_films(inspection, inspection.episodes, 10**7)
    n_bytes = sum(len(film.clips[0].data) for film in whole)
    for film in read_films(inspection, inspection.episodes, n_bytes // 2):
        [clip] = film.clips
        assert 0 < clip.n_frames < LENGTHS[0]


def test_a_page_without_the_extra_says_what_is_missing(filmed, tmp_path, monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "av" else find(name))
    z2r.write_report(z2r.load(filmed), tmp_path / "page.html")
    assert Elements((tmp_path / "page.html").read_text()).text["page"].count("pip install '.[video]'") == len(CAMERAS)


@pytest.fixture(scope="module")
def photographed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("photographed") / "photographed"
    write_photographed(root, clock)
    return root


def test_pictures_of_the_data_files_follow_the_frame_that_is_looked_at(photographed, open_report):
    page = open_report(photographed)
    for episode, frame in [(0, 0), (0, 1), (3, 7), (7, 51), (7, 50)]:
        page.evaluate(f"location.hash = '#episode={episode}&frame={frame}'")
        expect_frame(page, frame)
        expect(page.locator(".which")).to_have_text([f", frame {frame}"] * len(CAMERAS))
        assert greys(page) == [level(camera, episode, frame) for camera in CAMERAS]


def test_of_pictures_as_many_are_there_as_there_is_room_for(photographed, open_report, monkeypatch):
    inspection = z2r.inspect_dataset(photographed)
    stored = [row["bytes"] for row in pq.read_table(next(photographed.rglob("data/*/*.parquet")))[FRONT].to_pylist()]
    for n_wanted, n_episodes in [(40, 3), (24, 2), (23, 1), (3, 1), (1, 1)]:
        room = 2 * n_wanted * max(map(len, stored))
        front, side = read_films(inspection, inspection.episodes, room)
        assert 0 < len(front.pictures) <= n_wanted
        assert sum(len(each.data) for film in (front, side) for each in film.pictures) <= room
        assert all(each.data == stored[each.at] for each in front.pictures)
        assert front.pictures[0].at == 0
        ends = inspection.episodes.to_index
        assert {int(np.sum(ends <= each.at)) for each in front.pictures} == set(range(n_episodes))
    assert read_films(inspection, inspection.episodes, 10)[0] == front._replace(pictures=())
    monkeypatch.setattr(report, "_MAX_BYTES", 48 * max(map(len, stored)) + 10_000)
    page = open_report(photographed)
    page.evaluate("location.hash = '#episode=0&frame=8'")
    expect_frame(page, 8)
    expect(page.locator(".which").first).to_have_text(re.compile("^, frame [5-8]$"))
    page.evaluate("location.hash = '#episode=7&frame=4'")
    expect(page.get_by_text("no room for a picture of this episode")).to_have_count(len(CAMERAS))
    expect(page.locator(".screen img:visible")).to_have_count(0)


def test_a_page_says_which_video_or_picture_is_broken(tmp_path, filmed, photographed, open_report):
    shutil.copytree(photographed, tmp_path / "photographed")
    [path] = (tmp_path / "photographed").rglob("data/*/*.parquet")
    table = pq.read_table(path)
    rows = pa.array([row | {"bytes": row["bytes"][:26]} for row in table[FRONT].to_pylist()], table[FRONT].type)
    pq.write_table(table.set_column(table.column_names.index(FRONT), FRONT, rows), path)
    page = open_report(tmp_path / "photographed")
    expect(page.get_by_text("This browser cannot show the picture.")).to_have_count(1)
    expect(page.locator(".screen img:visible")).to_have_count(1)
    write_filmed(tmp_path / "filmed", clock)
    video(tmp_path / "filmed", FRONT).write_bytes(b"version https://git-lfs.github.com/spec/v1\n")
    z2r.write_report(z2r.load(tmp_path / "filmed"), tmp_path / "page.html")
    written = (tmp_path / "page.html").read_text()
    first, second = data_of(written)["cameras"]
    assert first["missing"].startswith("videos/")
    assert "Git LFS" in first["missing"]
    assert str(tmp_path) not in written  # a page goes to people who have the dataset elsewhere
    assert (len(first["clips"]), len(second["clips"])) == (0, len(LENGTHS))


@pytest.mark.parametrize("kind", ["filmed", "photographed"])
def test_where_no_script_runs_the_cameras_play_side_by_side(kind, request):
    seen = pictures_in(z2r.panel(request.getfixturevalue(kind)))
    frames = range(0, LENGTHS[0], 2)
    assert len(seen) == len(frames)
    for picture, frame in zip(seen, frames, strict=True):
        halves = [half.mean() for half in np.split(picture, len(CAMERAS), axis=1)]
        np.testing.assert_allclose(halves, [level(camera, 0, frame) for camera in CAMERAS], atol=GREY_A_FRAME)


def test_what_a_browser_cannot_play_it_says(filmed, open_file, tmp_path):
    z2r.write_report(z2r.load(filmed), tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    clip = data_of(text)["cameras"][0]["clips"][0][0]
    (tmp_path / "page.html").write_text(text.replace(clip, clip[:40] + "AAAA" * 20))
    page = open_file(tmp_path / "page.html")
    expect(page.get_by_text("This browser cannot play the clip")).to_have_count(1)
    page.keyboard.press("ArrowDown")
    expect(page.get_by_text("This browser cannot play the clip")).to_have_count(0)


def test_a_joint_and_its_command_are_in_one_chart(open_report, tmp_path):
    dataset, reading = write_arm(tmp_path / "robot")
    page = open_report(dataset.root, reading)
    charts = page.locator("#plots figure")
    expect(charts).to_have_count(len(JOINTS))
    page.evaluate("location.hash = '#episode=2&frame=3'")
    expect_frame(page, 3)
    row = int(dataset.episodes.from_index[2]) + 3
    for place, name in enumerate(JOINTS):
        chart = charts.filter(has_text=name)
        for kind, feature in (("measured", "observation.state"), ("command", "action")):
            said = float(chart.locator(f".value.{kind}").inner_text())
            assert said == pytest.approx(dataset.read(feature)[row, place], abs=0.06)
            drawn = heights(chart, kind)
            values = dataset.read(feature)[dataset.episodes[2], place]
            both = np.concatenate([dataset.read(each)[:, place] for each in ("observation.state", "action")])
            np.testing.assert_allclose(drawn, 94 - 88 * (values - both.min()) / np.ptp(both), atol=1e-3)


def heights(chart, kind: str) -> np.ndarray:
    points = chart.locator(f".line.{kind}").get_attribute("points")
    return np.array([float(point.split(",")[1]) for point in points.split()])


def test_a_chart_can_have_the_scale_of_its_episode_and_says_what_is_under_the_cursor(open_report, tmp_path):
    dataset, reading = write_arm(tmp_path / "robot")
    page = open_report(dataset.root, reading)
    chart = page.locator("#plots figure").first
    assert np.ptp(heights(chart, "measured")) < 80
    page.get_by_label("the episode").check()
    both = np.concatenate([heights(chart, kind) for kind in ("measured", "command")])
    np.testing.assert_allclose([both.min(), both.max()], [6, 94], atol=1e-6)
    plot = chart.locator(".plot").first
    last = int(dataset.episodes.lengths[0]) - 1
    plot.hover(position={"x": plot.bounding_box()["width"] * 4 / last, "y": 20})
    at = f"{4 / dataset.schema.fps:.2f} s: {dataset.read('observation.state')[4, 0]:.3g}"
    expect(chart.locator("output")).to_contain_text(at)
    expect_frame(page, 0)


@pytest.fixture
def damaged(standin_copy: Path) -> Path:
    """A dataset whose yaw is no angle in one frame, the 20th of episode 3."""
    [path] = standin_copy.glob("data/*/*.parquet")
    table, row = pq.read_table(path), int(z2r.load(standin_copy).episodes.from_index[3]) + 20
    values = np.stack(table["observation.state"].to_numpy()).copy()
    values[row, 4:6] = 0.1
    column = pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
    place = table.schema.get_field_index("observation.state")
    pq.write_table(table.set_column(place, table.schema.field(place), column), path)
    return standin_copy


def test_a_click_on_a_finding_goes_to_its_frame(damaged, open_report):
    page = open_report(damaged)
    finding = page.locator(".finding.error", has_text="unit-circle")
    finding.get_by_role("link", name="3, frame 20").click()
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("3")
    expect_frame(page, 20)
    chart = page.locator("#plots figure", has_text="sin_tee_yaw")
    cursor, mark = (chart.locator(part).get_attribute("x1") for part in (".cursor", ".found.error"))
    assert cursor == mark
    ribbon = page.get_by_role("img", name="Episodes by length")
    share = z2r.load(damaged).episodes.from_index[3] / z2r.load(damaged).episodes.n_frames
    expect(ribbon.locator(".flag.error")).to_have_attribute("x", f"{100 * share:.3f}%")
    expect(page.locator(".audited")).to_contain_text("error")
    assert Axe().run(page).violations_count == 0


def write_framed(check: str, folder: Path) -> tuple[z2r.Dataset, list[Finding]]:
    """Write a page with the findings of one check that name a frame, and no others; return them as they stand there."""
    FRAMED[check](folder / "dataset")
    dataset = z2r.load(folder / "dataset")
    audit = z2r.audit(dataset, z2r.break_mode(READ_AS[check]) if check in READ_AS else None)
    said = [each for each in audit.findings if each.check == check and each.frame is not None]
    inspection = inspect_dataset(dataset, reading=choose_reading(dataset.schema), keep=dataset.episodes.n_frames)
    report.write_report(inspection, folder / "page.html", audit=replace(audit, findings=tuple(said)))
    return dataset, sorted(said, key=lambda each: SEVERITIES.index(each.severity))


@pytest.mark.parametrize("check", FRAMED)
def test_a_click_on_a_finding_lands_on_its_frame(check, open_file, tmp_path):
    dataset, findings = write_framed(check, tmp_path)
    assert findings
    page = open_file(tmp_path / "page.html")
    links = page.locator(".finding a[href*=frame]")
    expect(links).to_have_count(len(findings))
    for finding, link in zip(findings, links.all(), strict=True):
        page.evaluate("go('#episode=1&frame=7')")  # from elsewhere
        expect_frame(page, 7)
        link.click()
        episode = int(np.sum(dataset.episodes.to_index <= finding.frame))
        expect(page.get_by_role("combobox", name="Episode")).to_have_value(f"{episode}")
        expect_frame(page, finding.frame - int(dataset.episodes.from_index[episode]))
        for place in re.findall(r"episode (\d+), frame (\d+)", finding.field):  # which some say themselves
            expect(link).to_have_text(", frame ".join(place))


MARKED = {
    "unit-circle": {"sin_tee_yaw", "cos_tee_yaw"},
    "unit-quaternion": {"qx", "qy", "qz", "qw"},
    "jump": {"tee_x"},
    "action-range": {"pusher_vx", "pusher_vy"},
    "overlap": {*STATE_NAMES, *ACTION_NAMES, "Distance to the target", "Turned away from the target"},
}


@pytest.mark.parametrize("check", MARKED)
def test_a_finding_marks_the_traces_that_it_is_about(check, open_file, tmp_path):
    write_framed(check, tmp_path)
    page = open_file(tmp_path / "page.html")
    page.locator(".finding a[href*=frame]").first.click()
    expect(page.locator(".found").first).to_be_attached()
    assert (
        set(page.locator(".trace", has=page.locator(".found")).locator("figcaption b").all_inner_texts())
        == MARKED[check]
    )


def test_the_keyboard_alone_goes_to_the_frame_of_a_finding_and_on_from_there(damaged, open_report):
    page = open_report(damaged)
    page.locator("#findings-title").evaluate("title => title.scrollIntoView()")
    page.get_by_role("link", name="What the audit found").focus()
    for _ in range(20):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.textContent") == "3, frame 20":
            break
    page.keyboard.press("Enter")
    expect_frame(page, 20)
    page.keyboard.press("ArrowRight")
    expect_frame(page, 21)


def test_all_that_the_audit_found_is_there_and_what_it_did_not_check(damaged, tmp_path):
    z2r.write_report(damaged, tmp_path / "page.html")
    text, audit = Elements((tmp_path / "page.html").read_text()).text["page"], z2r.audit(damaged)
    for finding in audit.findings:
        assert all(part in text for part in (finding.check, finding.found, finding.expected, finding.mend))
    assert all(each in text for each in audit.not_checked)
    severities = re.findall('class="finding (.*?)"', (tmp_path / "page.html").read_text())
    assert severities == sorted(severities, key=["error", "warning", "note"].index)
    z2r.write_report(damaged, tmp_path / "page.html", with_audit=False)
    assert "Nobody has looked for faults here" in (tmp_path / "page.html").read_text()


def test_a_filter_leaves_those_that_did_not_reach_and_those_with_findings(damaged, open_report):
    page = open_report(z2r.MESSY)
    missed = np.flatnonzero(~z2r.inspect_dataset(z2r.MESSY).outcome.reached)
    page.get_by_label("Filter").select_option("missed")
    assert page.locator("#episode option").all_inner_texts() == [f"{number}" for number in missed]
    expect(page.get_by_role("combobox", name="Episode")).to_have_value(f"{missed[0]}")
    expect(page.locator("tr[data-episode]:visible")).to_have_count(len(missed))
    page.keyboard.press("Escape")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("ArrowDown")
    expect(page.get_by_role("combobox", name="Episode")).to_have_value(f"{missed[1]}")
    page = open_report(damaged)
    page.get_by_label("Filter").select_option("found")
    expected = {number for finding in z2r.audit(damaged).findings for number in finding.episodes}
    assert {int(text) for text in page.locator("#episode option").all_inner_texts()} == expected


def test_an_address_holds_episode_frame_and_reading(open_report, open_file, tmp_path):
    page = open_report(z2r.STANDIN)
    page.evaluate("location.hash = '#episode=3&frame=20&reading=yaw-swap'")
    expect(page.locator(".percent:visible")).to_have_text("0%")
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("3")
    expect_frame(page, 20)
    page.keyboard.press("ArrowRight")
    page.wait_for_function("() => location.hash === '#episode=3&frame=21&reading=yaw-swap'")
    page.reload()
    expect_frame(page, 21)
    expect(page.locator("[value=yaw-swap]")).to_be_checked()
    for wrong in ("#episode=77", "#episode=x&frame=y", "#episode=2&frame=99999", "#reading=<b>"):
        page.evaluate(f"location.hash = '{wrong}'")
    expect_frame(page, int(z2r.load(z2r.STANDIN).episodes.lengths[2]) - 1)


def test_an_address_that_is_asked_for_as_another_is_written_holds(open_report):
    page = open_report(z2r.STANDIN)
    # The page writes where it is a moment after it was drawn: here, just after somebody asked for another place.
    page.evaluate("location.hash = '#episode=3&frame=20'; history.replaceState(null, '', '#episode=0&frame=0')")
    expect_frame(page, 20)
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("3")


def test_a_click_on_a_row_goes_to_its_episode_and_arrows_go_on_from_there(open_report):
    page = open_report(z2r.STANDIN)
    page.locator("tr[data-episode='2'] td").first.click()
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("2")
    for key, episode in (("ArrowDown", 3), ("ArrowUp", 2), ("ArrowUp", 1)):
        page.keyboard.press(key)
        expect(page.get_by_role("combobox", name="Episode")).to_have_value(f"{episode}")


def test_a_page_is_as_small_as_it_says(filmed, tmp_path):
    z2r.write_report(z2r.STANDIN, tmp_path / "page.html")
    assert len((tmp_path / "page.html").read_bytes()) < 150_000


def test_the_header_says_robot_tasks_and_cameras(filmed, tmp_path):
    z2r.write_report(filmed, tmp_path / "page.html")
    header = re.search("<header>.*</header>", (tmp_path / "page.html").read_text(), re.DOTALL)[0]
    assert all(line in header for lines in z2r.inspect_dataset(filmed).about.lines.values() for line in lines)


DARK_GROUNDS = """[...document.querySelectorAll("body, body *")].filter((part) => {
  const [r, g, b, alpha = 1] = getComputedStyle(part).backgroundColor.match(/[\\d.]+/g).map(Number);
  return part.checkVisibility() && part.tagName !== "I" && alpha > 0 && r + g + b < 600;
}).map((part) => part.outerHTML.slice(0, 80))"""


@pytest.mark.parametrize("name", ["standin", "arm"])
def test_on_paper_it_is_light_has_no_controls_and_says_which_frame_it_shows(name, open_report):
    page = open_report(name, color_scheme="dark")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Shift+ArrowRight")
    expect_frame(page, 10)
    page.emulate_media(media="print")
    expect(page.locator("body")).to_have_css("color", "rgb(32, 36, 42)")
    assert page.evaluate(DARK_GROUNDS) == []
    for control in page.locator("button, input, select:not(#episode), footer").all():
        expect(control).to_be_hidden()
    expect(page.get_by_role("combobox", name="Episode")).to_have_value("1")
    expect(page.locator("#clock")).to_contain_text("frame 10 ")
    expect(page.locator("details li").first).to_be_visible()
    expect(page.locator(".stage")).to_be_visible()
    expect(page.locator("#plots .trace").last).to_be_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_cameras_are_there_for_assistive_technology_and_on_a_phone(scheme, filmed, open_report):
    page = open_report(filmed, viewport={"width": 390, "height": 844}, color_scheme=scheme, reduced_motion="reduce")
    results = Axe().run(page)
    assert not results.response["violations"], results.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth") == 390
