"""The page in Chromium and in Firefox: it loads, moves by keys and clicks, plays, and reads in the dark and on a phone.

What is drawn is tested in one of them, in `test_report_in_browser.py` and `test_page.py`.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from time import sleep

import pytest
from conftest import skip_without
from firefox import FIREFOX, Firefox, Tab, open_tab, start_firefox
from test_page import damaged
from test_report_in_browser import is_in_the_page, open_file

import z2r

__all__ = ["damaged", "open_file"]  # fixtures

BROWSERS = ("chromium", "firefox")
NAMES = ("standin", "arm")

type OpenPage = Callable[..., Tab]


@pytest.fixture(scope="module")
def start() -> Iterator[Callable[[bool, bool], Firefox]]:
    """Start a Firefox, light or dark, with scripts or without; one of each is enough."""
    with ExitStack() as stack:

        @cache
        def start(dark: bool, scripts: bool) -> Firefox:
            preferences = {
                "layout.css.prefers-color-scheme.content-override": 0 if dark else 1,
                "javascript.enabled": scripts,
            }
            return stack.enter_context(start_firefox(**preferences))

        yield start


@pytest.fixture(params=BROWSERS)
def open_page(request) -> Iterator[OpenPage]:
    """Open a page in a browser; at the end, say that it asked for nothing and complained of nothing."""
    used: dict[Path, Firefox] = {}

    def in_chromium(path: Path, width: int = 1280, dark: bool = False, scripts: bool = True) -> Tab:
        look = {"viewport": {"width": width, "height": 844}, "color_scheme": "dark" if dark else "light"}
        page = request.getfixturevalue("open_file")(path, java_script_enabled=scripts, **look)
        return Tab(page.evaluate, page.keyboard.press, page.click)

    def in_firefox(path: Path, width: int = 1280, dark: bool = False, scripts: bool = True) -> Tab:
        skip_without(FIREFOX, "no Firefox: apt-get install firefox-esr")
        used[path] = request.getfixturevalue("start")(dark, scripts)
        return open_tab(used[path].send, path.as_uri(), width, 844)

    yield {"chromium": in_chromium, "firefox": in_firefox}[request.param]
    for path, firefox in used.items():
        said = [event["params"] for event in firefox.events]
        firefox.events.clear()
        urls = [each["request"]["url"] for each in said if "request" in each]
        assert not [url for url in urls if not url.startswith("data:") and not is_in_the_page(url, path)]
        assert not [each for each in said if "request" not in each]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Paths of the pages of what ships."""
    folder = tmp_path_factory.mktemp("pages")
    for name in NAMES:
        z2r.write_report(z2r.load(name), folder / f"{name}.html")
    return {name: folder / f"{name}.html" for name in NAMES}


def wait_for(tab: Tab, condition: str) -> None:
    """Wait until it holds, for ten seconds."""
    for _ in range(200):
        if tab.evaluate(condition):
            return
        sleep(0.05)
    pytest.fail(f"found not: {condition}")


def wait_for_place(tab: Tab, episode: int, frame: int) -> None:
    """Wait until a frame of an episode is shown: in the picker, in the slider and in words."""
    wait_for(tab, f"document.getElementById('clock').textContent.startsWith('frame {frame} ')")
    assert tab.evaluate("document.getElementById('frame').value") == f"{frame}"
    assert tab.evaluate("document.getElementById('episode').selectedOptions[0].textContent") == f"{episode}"


@pytest.mark.parametrize("name", NAMES)
def test_it_loads_and_keys_step_through_frames_and_episodes(name, open_page, pages):
    tab = open_page(pages[name])
    wait_for_place(tab, 0, 0)
    first, second = z2r.load(name).episodes.lengths[:2].tolist()
    for key, place in [
        ("ArrowRight", (0, 1)),
        ("Shift+ArrowRight", (0, 11)),
        ("ArrowLeft", (0, 10)),
        ("End", (0, first - 1)),
        ("ArrowDown", (1, 0)),
        ("End", (1, second - 1)),
        ("ArrowUp", (0, 0)),
    ]:
        tab.press(key)
        wait_for_place(tab, *place)
    drawn = tab.evaluate("[...document.querySelectorAll('#plots .line')].map((line) => line.points.numberOfItems)")
    assert len(drawn) == sum(feature.size for feature in z2r.load(name).schema.signals().values())
    assert {*drawn} == {first}


def test_a_click_on_a_finding_goes_to_its_frame(damaged, open_page, tmp_path):
    z2r.write_report(damaged, tmp_path / "page.html")
    tab = open_page(tmp_path / "page.html")
    tab.click(".finding.error a[href='#episode=3&frame=20']")
    wait_for_place(tab, 3, 20)
    wait_for(tab, "location.hash === '#episode=3&frame=20'")


def test_another_reading_is_a_click_away(open_page, pages):
    tab = open_page(pages["standin"])
    tab.click(".choice:has([value=yaw-swap])")
    assert tab.evaluate("document.querySelector('.answer:not([hidden]) .percent').textContent") == "0%"
    wait_for(tab, "document.activeElement === document.body")
    tab.press("ArrowRight")
    wait_for_place(tab, 0, 1)


def test_cameras_play_or_say_what_is_missing(open_page, pages):
    tab = open_page(pages["arm"])
    tab.press("Space")
    wait_for(tab, "document.getElementById('frame').valueAsNumber > 5")
    shown = tab.evaluate(
        """[...document.querySelectorAll('.camera')].map((camera) => {
          const [video, note] = [camera.querySelector('video'), camera.querySelector('.missing')];
          return [!video.hidden && video.videoWidth > 0 && video.currentTime > 0, note.hidden ? '' : note.textContent];
        })"""
    )
    assert len(shown) == len(z2r.inspect_dataset("arm").about.cameras)
    assert all(plays != ("cannot play" in missing) for plays, missing in shown), shown


@pytest.mark.parametrize("name", NAMES)
def test_a_phone_needs_no_scrolling_sideways(name, open_page, pages):
    assert open_page(pages[name], width=390).evaluate("document.documentElement.scrollWidth") <= 390


def test_in_the_dark_it_is_dark(open_page, pages):
    grounds = [
        open_page(pages["standin"], dark=dark).evaluate("getComputedStyle(document.body).backgroundColor")
        for dark in (False, True)
    ]
    assert grounds == ["rgb(244, 242, 236)", "rgb(18, 21, 26)"]


@pytest.mark.parametrize("name", NAMES)
def test_with_javascript_off_it_still_says_what_is_in_the_dataset(name, open_page, pages):
    tab = open_page(pages[name], scripts=False)
    text = tab.evaluate("document.body.innerText")
    assert "where scripts run" in text
    assert "Pause" not in text
    assert "Play" not in text
    features = z2r.load(name).schema.signals().values()
    assert all(label in text for feature in features for label in feature.labels)
    assert tab.evaluate("document.querySelectorAll('tbody tr[data-episode]').length") >= len(z2r.load(name).episodes)
