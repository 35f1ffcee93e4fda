"""How fast is the page in a browser? Medians in headless Chromium, of the page of `arm` and its two cameras.

    python tests/benchmarks/page.py [--runs 9]

First paint counts from the moment that the page is asked for; the work for a frame, while a key is held, is to draw it
and to lay it out. Exit code 1 where a target is missed.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright
from run import Row, print_rows

import z2r

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from conftest import CHROMIUM, CHROMIUM_FLAGS

N_KEYS = 120
PAINTED = "() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime"
# To ask for a height makes the browser lay out what was drawn, which it would do next.
TIME_FRAMES = """
const ask = window.requestAnimationFrame.bind(window);
window.spent = [];
window.requestAnimationFrame = (draw) => ask((time) => {
  const start = performance.now();
  draw(time);
  document.body.offsetHeight;
  spent.push(performance.now() - start);
});
"""


def first_paint(browser: Browser, path: Path) -> float:
    """Return how long it takes until something of the page is seen [ms]."""
    with browser.new_context(offline=True) as context:
        page = context.new_page()
        page.goto(path.as_uri())
        return float(page.wait_for_function(PAINTED).json_value())


def frame_work(browser: Browser, path: Path) -> float:
    """Return the median work for a frame while a key is held [ms]."""
    with browser.new_context(offline=True) as context:
        page = context.new_page()
        page.add_init_script(TIME_FRAMES)
        page.goto(path.as_uri())
        page.wait_for_timeout(500)  # the clips are decoded
        page.evaluate("spent.length = 0")
        for _ in range(N_KEYS):
            page.keyboard.down("ArrowRight")
        return statistics.median(page.evaluate("spent"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=9)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder, "arm.html")
        z2r.write_report("arm", path)
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_FLAGS)
        rows = []
        for measure, work, most in (("first paint", first_paint, 1000), ("work for a frame", frame_work, 8)):
            took = statistics.median([work(browser, path) for _ in range(runs + 1)][1:])
            said = f"page of arm: {measure}", f"{took:.1f} ms", f"{most} ms (limit)"
            rows.append(Row(*said, took / most, "<= 1", took <= most))
        browser.close()
    print_rows(rows)


if __name__ == "__main__":
    main()
