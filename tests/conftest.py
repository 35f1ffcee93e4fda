import os
import shutil
from pathlib import Path

import pytest
from hypothesis import settings
from layouts import record_with_lerobot

import z2r

os.environ["HF_HUB_OFFLINE"] = "1"

settings.register_profile("z2r", deadline=None)  # a busy machine is no fault of the code
settings.load_profile("z2r")

RECORDED_LENGTHS = (1, 40, 7, 1, 1, 25, 60, 3, 18, 1, 33, 12)


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
