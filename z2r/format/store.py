"""Where do the bytes come from, and where do they go? The one door to the file system, and to what is stored elsewhere.

No other module that reads a dataset opens a file, and none writes an output. A local file is mapped into memory. What
is at a URL is fetched (`z2r.format.remote`), and nothing is where none was named. A dataset is untrusted input: no path
leaves its folder, no size is believed, nothing that may never end is opened, and it is never written to. An output is
whole or not there: it is written under a hidden name beside its place, and renamed.
"""

import contextlib
import errno
import hashlib
import os
import shutil
import stat
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from z2r.data.urls import Url
from z2r.errors import DatasetError, Fault

if TYPE_CHECKING:
    import pyarrow as pa

_AGAIN = "Copy or download the dataset again"
_POINTER = b"version https://git-lfs"
_MAX_POINTER_BYTES = 1024  # by the specification of Git LFS
_RIGHTS = "Give yourself the right to read the dataset: chmod -R u+rX"
_BLOCK = 2**23  # bytes
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def inside(root: Path, relative: Path | str) -> Path:
    """Return a path below `root`, and refuse one that leads out of it.

    A dataset is untrusted input: neither ``..`` nor a symbolic link may make a reader open what lies elsewhere. The one
    exception is the Hugging Face cache, whose snapshots are links into the ``blobs`` folder of the same repository.

    Raises
    ------
    DatasetError
        If the path, links followed, is outside, or is neither a file nor a folder.
    """
    path = root / relative
    if isinstance(root, Url):
        return _inside_url(root, path)
    try:
        real = os.path.realpath(path)
        kind = _kind(path)
    except PermissionError as error:
        raise DatasetError(fault_of(error, path, "a file that can be read")) from None
    except (OSError, ValueError) as error:
        if getattr(error, "errno", None) == errno.ELOOP:
            raise DatasetError(Fault(path, "", "a link that leads to itself", "a file")) from None
        raise DatasetError(Fault(path, "", f"a path that cannot be ({error.args[-1]})", "a file")) from None
    if not _is_within(root, real):
        mend = "If you trust the link, copy the dataset with its links followed: cp -rL"
        raise DatasetError(Fault(path, "", "a path that leads out of the dataset", "a file inside the dataset", mend))
    if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        raise DatasetError(Fault(path, "", "a pipe or a device, which may never end", "a file"))
    return path


def all_inside(root: Path, relatives: Iterable[Path]) -> list[Path]:
    """Return paths below `root` as `inside` does, where there may be very many: each folder is followed once.

    Raises
    ------
    DatasetError
        As `inside`, of the first that is refused.
    """
    paths: list[Path] = []
    known: dict[Path, bool] = {}
    for relative in relatives:
        path = root / relative
        if path.parent not in known:
            known[path.parent] = _is_folder_inside(root, path.parent)
        paths.append(path if known[path.parent] and _is_plain_file(path) else inside(root, relative))
    return paths


def _is_folder_inside(root: Path, folder: Path) -> bool:
    try:
        return not isinstance(root, Url) and _is_within(root, os.path.realpath(folder))
    except (OSError, ValueError):
        return False


def _is_plain_file(path: Path) -> bool:
    """Tell whether a file is there that is no link."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except (OSError, ValueError):
        return False


def _inside_url(root: Url, path: Path) -> Path:
    """Object storage knows neither links nor devices, and ``..`` is a name there as any other: for some programs."""
    if ".." in path.parts or not path.is_relative_to(root) or "\0" in str(path):
        raise DatasetError(Fault(path, "", "a path that leads out of the dataset", "a file inside the dataset"))
    return path


def outside(root: Path, path: Path) -> Path:
    """Return where an output goes, links followed, and refuse a place that is a dataset's.

    Raises
    ------
    DatasetError
        If the path is in the dataset, or another name of a file of it, by a symbolic or a hard link.
    """
    try:
        real = path.resolve()
        if isinstance(root, Url):
            return real
        mine = _is_within(root, str(real)) or _is_hard_link_into(root, real)
    except (OSError, RuntimeError, ValueError) as error:
        raise DatasetError(
            Fault(path, "", f"a path that cannot be ({error.args[-1]})", "a place to write to")
        ) from None
    if mine:
        expected = f"a place outside of {root}, which is never written to"
        raise DatasetError(Fault(path, "", "a place in the dataset", expected, "Name another"))
    return real


def _kind(path: Path) -> int:
    """Return what sort of thing is there, links followed; 0 where nothing is."""
    try:
        return stat.S_IFMT(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return 0


def _is_within(root: Path, real: str) -> bool:
    """Tell whether a path, links followed, is where the files of a dataset are."""
    folder = os.path.realpath(root)  # as text: a dataset may have very many files
    if real == folder or real.startswith(f"{folder.rstrip(os.sep)}{os.sep}"):
        return True
    parent = Path(folder).parent
    return parent.name == "snapshots" and Path(real).is_relative_to(parent.parent / "blobs")


def _is_hard_link_into(root: Path, path: Path) -> bool:
    return (
        path.is_file() and path.stat().st_nlink > 1 and any(map(path.samefile, filter(Path.is_file, root.rglob("*"))))
    )


def write(path: Path, contents: bytes, dataset: Path | None = None) -> None:
    """Write a file whole or not at all: who looks sees what was there, or all of the new one.

    A run that is killed may leave a hidden file beside it, `.z2r-*.part`, and nothing under its name.

    Parameters
    ----------
    path : Path
        The file. One that is there is replaced; folders that are missing are made.
    contents : bytes
        All of it.
    dataset : Path, optional
        The dataset that the output is about, which it must lie outside of.

    Raises
    ------
    DatasetError
        If it is not `outside` of the dataset, is no file, or cannot be written, as where the disk is full.
    """
    with _written_to(path):
        real = outside(dataset, path) if dataset else path.resolve()
        if real.exists() and not real.is_file():
            raise DatasetError(Fault(path, "", "a folder, a pipe or a device", "a file, or nothing", "Name another"))
        real.parent.mkdir(parents=True, exist_ok=True)
        with _hidden(real.parent) as part:
            with part.open("xb") as file:
                file.write(contents)
                file.flush()
                os.fsync(file.fileno())  # some file systems say only here that they are full
            part.replace(real)


@contextlib.contextmanager
def folder_for(*paths: Path) -> Iterator[Path]:
    """Lend a hidden folder; what is in it at the end, under the names of these paths, takes their places together.

    What was in these places goes. It is still there, or comes back, where something fails. A run that is killed while
    the names change leaves each of them whole or absent, and never a new one beside an old one.

    Parameters
    ----------
    *paths : Path
        Files and folders, all in one folder.

    Raises
    ------
    DatasetError
        If they cannot be written, as where the disk is full.
    """
    parent = paths[0].parent
    with _written_to(paths[0]):
        parent.mkdir(parents=True, exist_ok=True)
        with _hidden(parent) as folder:
            aside = folder / "replaced"
            aside.mkdir(parents=True)
            yield folder
            _exchange(folder, aside, paths)


def _exchange(folder: Path, aside: Path, paths: tuple[Path, ...]) -> None:
    moves = [(path, aside / path.name) for path in paths if path.exists()]
    moves += [(folder / path.name, path) for path in paths]
    done = []
    try:
        for source, target in moves:
            source.rename(target)
            done.append((source, target))
    except BaseException:
        for source, target in reversed(done):
            target.rename(source)
        raise


@contextlib.contextmanager
def _hidden(parent: Path) -> Iterator[Path]:
    """Lend a name that nobody uses, and remove what has it at the end."""
    part = parent / f".z2r-{os.urandom(8).hex()}.part"
    try:
        yield part
    finally:
        with contextlib.suppress(OSError):  # what went wrong before is what to say
            shutil.rmtree(part) if part.is_dir() else part.unlink(missing_ok=True)


@contextlib.contextmanager
def _written_to(path: Path) -> Iterator[None]:
    """Say of a path what the system says while it is written."""
    try:
        yield
    except OSError as error:
        found, full = (error.strerror or str(error)).lower(), error.errno in _NO_ROOM
        mend = f"{'Make room there, or name' if full else 'Name'} another place. What was there before is as it was"
        raise DatasetError(Fault(path, "", found, "a place that can be written to", mend)) from None


def folder_name(root: Path) -> str:
    """Return what a dataset is called: as its folder, or in a cache of the hub as there.

    >>> folder_name(Path("hub/datasets--lerobot--pusht/snapshots/0123abcd"))
    'lerobot/pusht'
    """
    if isinstance(root, Url) and root.scheme == "hf":
        return "/".join(root.parts[2:])
    folder = in_full(root)  # the one that we stand in, ".", has a name too
    if folder.parent.name == "snapshots" and (of_hub := folder.parents[1].name.split("--"))[0] == "datasets":
        return "/".join(of_hub[1:])
    return folder.name


def in_full(path: Path) -> Path:
    """Return the path from the top, links followed: what another program needs that starts elsewhere.

    Of what is at a URL, no path but a name: that of its copy, once somebody has downloaded it.
    """
    return Path(path.name) if isinstance(path, Url) else path.resolve()


def check_folder(root: Path) -> None:
    """Check that there is a folder.

    Raises
    ------
    DatasetError
        If there is none, or it cannot be looked into.
    """
    if isinstance(root, Url):  # there are no folders, but files whose names begin alike
        return
    expected = "the folder of a LeRobot dataset"
    try:
        there = root.is_dir()
    except OSError as error:
        raise DatasetError(fault_of(error, root, expected)) from None
    if not there:
        raise DatasetError(Fault(root, "", "no such folder", expected))


def read_bytes(path: Path, max_bytes: int, expected: str, mend: str = _AGAIN) -> bytes:
    """Read a whole file.

    Parameters
    ----------
    path : Path
        From `inside`.
    max_bytes : int
        The size that is refused begins above.
    expected, mend : str
        What the file is, and what to do where it cannot be read.

    Raises
    ------
    DatasetError
        If it is missing, too large, a pointer of Git LFS, or cannot be read.
    """
    try:
        raw = _far().read_far(path, max_bytes) if isinstance(path, Url) else _read_local(path, max_bytes)
    except OSError as error:
        raise DatasetError(fault_of(error, path, expected, mend)) from error
    check_no_pointer(path, expected)
    return raw


def _read_local(path: Path, max_bytes: int) -> bytes:
    size = path.stat().st_size
    if size > max_bytes:
        raise DatasetError(Fault(path, "", f"{size} bytes", f"at most {max_bytes}"))
    return path.read_bytes()


def digest(path: Path) -> bytes:
    """Return the sha256 of a file, of which little is in memory at a time.

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    hashed = hashlib.sha256()
    try:
        with open_mapped(path) as file:
            while block := file.read(_BLOCK):
                hashed.update(block)
    except OSError as error:
        raise DatasetError(fault_of(error, path, "a file that can be read")) from None
    return hashed.digest()


def check_no_pointer(path: Path, expected: str) -> None:
    """Check that a file is what it should be, and no pointer to it: that is what a clone without Git LFS leaves behind.

    Raises
    ------
    DatasetError
        If it is a pointer, or cannot be looked into.
    """
    try:
        if isinstance(path, Url):
            begins = _far().FarFile(path).read(len(_POINTER))
        elif path.stat().st_size > _MAX_POINTER_BYTES:
            return
        else:
            with path.open("rb") as file:
                begins = file.read(len(_POINTER))
    except OSError as error:
        raise DatasetError(fault_of(error, path, expected)) from None
    if begins == _POINTER:
        mend = "Fetch what it points at, in its folder: git lfs pull"
        raise DatasetError(Fault(path, "", "a pointer of Git LFS", expected, mend))


def open_mapped(path: Path, ahead: int = 0) -> "pa.NativeFile":
    """Open a file that is read in part; its bytes are read when they are used.

    Parameters
    ----------
    path : Path
        From `inside`.
    ahead : int, optional
        Of a file at a URL, how many bytes to fetch at least, whenever some are read.

    Raises
    ------
    OSError
        If it cannot be opened.
    """
    import pyarrow as pa  # here: what reads a schema need not wait for it

    return _far().FarFile(path, ahead) if isinstance(path, Url) else pa.memory_map(str(path))


def is_far(path: Path) -> bool:
    """Tell whether a file is at a URL, so that what is read of it should be fetched before."""
    return isinstance(path, Url)


def fetch(file: "pa.NativeFile", ranges: Iterable[tuple[int, int]]) -> "pa.NativeFile":
    """Fetch what will be read of a file that is far away, from one byte on and up to another; they need not be apart.

    Returns
    -------
    NativeFile
        To read just that from.

    Raises
    ------
    Unreachable
        If it cannot be fetched.
    """
    return file.fetch(ranges)


def bytes_fetched() -> int:
    """Return how many bytes of files at URLs this process has fetched."""
    far = sys.modules.get("z2r.format.remote")
    return far.bytes_fetched() if far else 0


def _far() -> ModuleType:
    from z2r.format import remote  # here: it costs some time, and few need it

    return remote


def open_streamed(path: Path) -> "pa.NativeFile":
    """Open a file that is read from its beginning to its end: what was read of a mapped one would stay in memory.

    Raises
    ------
    OSError
        If it cannot be opened.
    """
    import pyarrow as pa  # here: what reads a schema need not wait for it

    return pa.OSFile(str(path))


def is_file(path: Path) -> bool:
    """Tell whether a file is there.

    Raises
    ------
    DatasetError
        If nobody may look.
    """
    try:
        return _far().is_far_file(path) if isinstance(path, Url) else path.is_file()
    except OSError as error:
        raise DatasetError(fault_of(error, path, "a file that can be read")) from None


def exists(path: Path) -> bool:
    """Tell whether there is anything of this name; nothing of it is read."""
    try:
        return path.exists()
    except OSError:
        return False


def find(root: Path, folder: Path | str, pattern: str) -> list[Path]:
    """Find files and folders below a folder of a dataset.

    Parameters
    ----------
    root : Path
        The dataset.
    folder : str or path
        Relative to it; there need not be one.
    pattern : str
        Such as ``chunk-*/file-*.parquet`` or ``**/*.mp4``: a folder, and files in it.

    Returns
    -------
    list of Path
        Relative to `root`, sorted.

    Raises
    ------
    DatasetError
        If nobody may look, or the folder leads out of the dataset.
    """
    where = inside(root, folder)
    if isinstance(where, Url):
        name, deep = pattern.removeprefix("**/"), pattern.startswith("**/")
        below = [(path.relative_to(root), len(path.relative_to(where).parts)) for path in _far().list_far(where)]
        return [path for path, depth in below if path.match(name) and (deep or depth == len(Path(pattern).parts))]
    try:
        for each in (where, *where.glob(str(Path(pattern).parent))):
            if each.is_dir():
                next(each.iterdir(), None)  # `glob` takes a folder that is closed for an empty one
        return sorted(path.relative_to(root) for path in where.glob(pattern))
    except OSError as error:
        raise DatasetError(fault_of(error, Path(error.filename or where), "a folder that can be read")) from None


def fault_of(error: OSError, path: Path, expected: str, mend: str = _AGAIN) -> Fault:
    """Say what the system said of a path."""
    if isinstance(error, PermissionError):
        return Fault(path, "", "permission denied", expected, _RIGHTS)
    if isinstance(error, FileNotFoundError):
        return Fault(path, "", "no such file", expected, mend)
    return Fault(path, "", (error.strerror or str(error)).lower(), expected, mend)
