"""Run All in JupyterLab, by the menu, in a browser: what a learner does first."""

import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import nbformat
import pytest
from notebook_tools import STEMS, code_cells, committed, without_outputs
from playwright.sync_api import Browser, Locator, Page, expect

from z2r.course.build import ROOT, kernel_variables

STEM = "00_start_here"
OTHERS = STEMS[1:] if "Z2R_EVERY_PAGE" in os.environ else []  # they take two minutes
UNTRUSTED = "with_outputs.ipynb"
SECONDS = 1000  # of Playwright, which counts in milliseconds


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a JupyterLab that serves two copies of one notebook, to this machine only, and keeps no settings."""
    folder = tmp_path_factory.mktemp("lab")
    (folder / "notebooks").mkdir()
    for stem in (STEM, *OTHERS):
        nbformat.write(without_outputs(committed(stem)), folder / "notebooks" / f"{stem}.ipynb")
    nbformat.write(committed(STEM), folder / "notebooks" / UNTRUSTED)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"http://127.0.0.1:{port}"
    options = ["--no-browser", "--allow-root", "--IdentityProvider.token=", "--ServerApp.ip=127.0.0.1"]
    options += [f"--port={port}", "--ServerApp.port_retries=0", "--LabApp.news_url=None"]
    options += ["--LabApp.check_for_updates_class=jupyterlab.handlers.announcements.NeverCheckForUpdate"]
    state = {name: str(folder / name) for name in ("JUPYTER_CONFIG_DIR", "JUPYTERLAB_SETTINGS_DIR")}
    state |= {name: str(folder / name) for name in ("JUPYTER_RUNTIME_DIR", "JUPYTERLAB_WORKSPACES_DIR")}
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "jupyterlab", *options],
            cwd=folder / "notebooks",
            env=kernel_variables(folder / "profile", ROOT) | state,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            wait_for(address, process, folder / "log")
            yield address
        finally:
            process.terminate()
            process.wait(timeout=30)


def wait_for(address: str, process: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(300):
        try:
            urllib.request.urlopen(f"{address}/api", timeout=5).close()
            return
        except (urllib.error.URLError, TimeoutError):
            assert process.poll() is None, log.read_text()
            time.sleep(0.2)
    pytest.fail(log.read_text())


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    # As high as the whole notebook, since JupyterLab draws only the cells that are in view.
    page = browser.new_page(viewport={"width": 1440, "height": 9000})
    yield page
    page.close()


def run_all(page: Page, server: str, stem: str, picture: Path) -> Locator:
    """Open a page of the course, run all cells, and return the notebook once it shows what it should."""
    cells = code_cells(committed(stem))
    shown = [[output.get("data", {}) for output in cell.outputs] for cell in cells]
    moves = [any("<iframe" in data.get("text/html", "") for data in each) for each in shown]
    figures = sum("image/png" in data for each, moving in zip(shown, moves, strict=True) for data in each if not moving)
    # In a workspace of its own: another opens what was opened in it before, too, and every notebook is counted.
    page.goto(f"{server}/lab/workspaces/{stem}/tree/{stem}.ipynb")
    notebook = page.locator(".jp-Notebook")
    expect(notebook.locator(".jp-CodeCell")).to_have_count(len(cells), timeout=60 * SECONDS)
    kernel = page.locator(".jp-Notebook-ExecutionIndicator")
    expect(kernel).to_have_attribute("data-status", "idle", timeout=60 * SECONDS)
    prompts = notebook.locator(".jp-CodeCell .jp-InputPrompt")
    while prompts.last.text_content() == "[ ]:":  # JupyterLab may drop a command while its menu is still being made
        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        page.wait_for_timeout(2 * SECONDS)
    expect(prompts.last).to_have_text(f"[{len(cells)}]:", timeout=120 * SECONDS)
    expect(kernel).to_have_attribute("data-status", "idle")
    page.screenshot(path=picture, full_page=True)
    print(picture)
    expect(notebook.locator(".jp-InputPlaceholder")).to_contain_text("Set up")  # the one cell that is folded
    assert notebook.locator(".jp-OutputArea-output", has_text="Traceback (most recent call last)").count() == 0
    expect(notebook.locator(".jp-OutputArea-output img[src^='data:image/png']:visible")).to_have_count(figures)
    expect(notebook.locator("iframe")).to_have_count(sum(moves))
    for number in range(sum(moves)):
        frame = notebook.frame_locator("iframe").nth(number).locator("html")
        high = frame.evaluate("html => [innerHeight, html.getBoundingClientRect().height]")
        assert high[0] == pytest.approx(high[1], abs=1)
    return notebook


@pytest.mark.parametrize("stem", OTHERS)
def test_run_all_finishes_on_every_other_page(stem, page, server, tmp_path):
    run_all(page, server, stem, tmp_path / f"{stem}.png")


def test_run_all_finishes_and_draws_the_figures(page, server, tmp_path):
    notebook = run_all(page, server, STEM, tmp_path / "notebook.png")
    panel = notebook.frame_locator("iframe")
    expect(panel.locator(".percent:visible")).to_have_text("100%")
    panel.get_by_text("How is it read?").click()
    panel.locator("[value=yaw-swap]").check()
    expect(panel.locator(".percent:visible")).to_have_text("0%")


def test_before_anybody_trusts_the_notebook_the_panel_is_a_moving_picture(page, server):
    page.goto(f"{server}/lab/tree/{UNTRUSTED}")
    picture = page.locator(".jp-Notebook img[src^='data:image/webp']")
    expect(picture).to_be_visible(timeout=60 * SECONDS)
    assert picture.bounding_box()["height"] > 300
    expect(page.locator(".jp-Notebook iframe")).to_have_count(0)
