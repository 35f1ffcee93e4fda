"""Where are the datasets that were downloaded? In LeRobot's cache and in that of the hub; nothing is fetched here.

Three places (lerobot 0.6.1, `lerobot/utils/constants.py`, `lerobot/datasets/dataset_metadata.py`; huggingface_hub,
`huggingface_hub/constants.py`):

    HF_LEROBOT_HOME/user/name                                       recorded here
    HF_LEROBOT_HOME/hub/datasets--user--name/snapshots/REVISION     downloaded by LeRobot
    HF_HUB_CACHE/datasets--user--name/snapshots/REVISION            downloaded by `hf download`

Without these variables they are in HF_HOME, which is ~/.cache/huggingface unless somebody says otherwise.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

_NAME = r"[A-Za-z0-9_][A-Za-z0-9_.-]*"


def looks_like_a_name(text: str) -> bool:
    """Tell whether a text may be the name of a dataset on the hub.

    >>> looks_like_a_name("lerobot/pusht"), looks_like_a_name("../pusht")
    (True, False)
    """
    return re.fullmatch(f"{_NAME}/{_NAME}", text) is not None and ".." not in text


def cached(name: str) -> Path | None:
    """Return the folder of a dataset in the first cache that has it; None where none has."""
    if not looks_like_a_name(name):
        return None
    return next((folder for found, folder, _ in in_caches() if found == name), None)


def cached_names() -> list[str]:
    """Return the names of all datasets that are in a cache."""
    return [name for name, _, _ in in_caches()]


def in_caches() -> Iterator[tuple[str, Path, str]]:
    """Yield each dataset in a cache: its name, its folder, and whose cache it is in."""
    own = _lerobot_home()
    for folder in _folders(own):
        yield from ((f"{folder.name}/{each.name}", each, "LeRobot") for each in _datasets(_folders(folder)))
    yield from ((name, folder, "LeRobot") for name, folder in _in_hub_cache(own / "hub"))
    yield from ((name, folder, "hub") for name, folder in _in_hub_cache(_hub_cache()))


def in_folder(folder: Path) -> list[Path]:
    """Return the datasets in a folder: itself, or those that are in it, one level down."""
    return _datasets([folder]) or _datasets(_folders(folder))


def _in_hub_cache(cache: Path) -> Iterator[tuple[str, Path]]:
    for repository in _folders(cache):
        kind, *name = repository.name.split("--")
        snapshot = _newest(repository) if kind == "datasets" else None
        if snapshot is not None and _datasets([snapshot]):
            yield "/".join(name), snapshot


def _newest(repository: Path) -> Path | None:
    """Return the snapshot that `main` means; where that is not there, the one that was changed last."""
    snapshots = _folders(repository / "snapshots")
    try:
        main = (repository / "refs/main").read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError):
        main = ""
    return next((each for each in snapshots if each.name == main), None) or max(snapshots, key=_changed, default=None)


def _changed(folder: Path) -> float:
    try:
        return folder.stat().st_mtime
    except OSError:
        return 0.0


def _datasets(folders: list[Path]) -> list[Path]:
    return [folder for folder in folders if _is_folder(folder / "meta")]


def _folders(where: Path) -> list[Path]:
    try:
        return sorted(path for path in where.iterdir() if _is_folder(path))
    except OSError:  # there is none, or it may not be looked into
        return []


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:
        return False


def _lerobot_home() -> Path:
    return _variable("HF_LEROBOT_HOME") or _home() / "lerobot"


def _hub_cache() -> Path:
    return _variable("HF_HUB_CACHE") or _variable("HUGGINGFACE_HUB_CACHE") or _home() / "hub"


def _home() -> Path:
    return _variable("HF_HOME") or (_variable("XDG_CACHE_HOME") or _expanded("~/.cache")) / "huggingface"


def _variable(name: str) -> Path | None:
    value = os.environ.get(name)
    return _expanded(os.path.expandvars(value)) if value else None


def _expanded(path: str) -> Path:
    try:
        return Path(path).expanduser()
    except RuntimeError:  # there is no home, and so nothing in it
        return Path(path)
