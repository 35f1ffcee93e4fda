"""How is a file read that is far away? Its size first, and then only the bytes that are used, some at the same time.

A small file, and one of the metadata, which is read again and again, comes whole and is kept for a while. Of another
one, whoever reads it names the ranges that are needed; they come in pieces, side by side. What else is read of it comes
when it is read. A store that is late, cuts its answer off or says that it failed is asked again.

Arrow's own file systems read S3 and GCS, and fsspec the rest. They look for credentials where the tools of each store
keep them: in the environment (``AWS_ACCESS_KEY_ID``, ``AWS_PROFILE``, ``AWS_ENDPOINT_URL``, ``HF_TOKEN`` ...) and in
files.
"""

import os
import re
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from functools import cache, partial
from typing import Any, NamedTuple, Self
from urllib.parse import urlsplit

import numpy as np
import pyarrow as pa
from pyarrow import fs

from z2r.data.urls import Url
from z2r.errors import DatasetError, Fault, MissingExtraError, Unreachable

type Range = tuple[int, int]
"""From which byte of a file on, and up to which."""

type _Part = tuple[int, memoryview]
"""Where in a file it begins, and its bytes."""

_OF_ARROW = ("s3", "gs")
_PATIENCE = 20.0  # s without a byte
_PAUSES = (0.2, 0.6, 1.8, 5.4)  # s, before a store that failed is asked again
_WHOLE = 2**16  # bytes: a file up to this size comes whole, as the end of a larger one does
_KEPT = 2**28  # bytes of files that came whole
_AT_ONCE = 2**30  # bytes of one file: LeRobot begins a new one every 100 MB
_PIECE = 2**23  # bytes in one request
_GAP = 2**12  # bytes between two ranges: less than this is fetched with them, for a request takes longer than that
_THREADS = 8  # for one file

_DENIED = re.compile(
    r"ACCESS_DENIED|SIGNATURE|ACCESS_KEY|TOKEN|credential|forbidden|unauthorized|permission|\b40[13]\b", re.IGNORECASE
)
_KEYS = {
    "s3": "Set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_PROFILE, to those of somebody who may read it",
    "gs": "Log in as somebody who may read it: gcloud auth application-default login",
    "hf": "Log in as somebody who may read it: hf auth login",
}
_AGAIN = {"s3": "Try again; AWS_ENDPOINT_URL says which store is asked"}


class _Opened(NamedTuple):
    """A file far away: how large it is, what is another where it is another, and what reads a range of it."""

    size: int
    version: str
    read: Callable[[int, int], bytes]


_kept: OrderedDict[tuple[Url, int, str], bytes] = OrderedDict()
_lock = threading.Lock()
_n_fetched = 0


def bytes_fetched() -> int:
    """Return how many bytes this process has fetched."""
    return _n_fetched


def forget() -> None:
    """Forget what was fetched, and who was asked: the environment may name others now."""
    for asked in (_arrow_files, _fsspec_files):
        asked.cache_clear()
    _kept.clear()


class FarFile(pa.PythonFile):  # type: ignore[misc]
    """A file as Arrow reads it, some of whose bytes are here.

    Raises
    ------
    FileNotFoundError
        If there is none.
    Unreachable
        Here, and wherever it is read, if it cannot be fetched.
    """

    far: "_Far"

    def __new__(cls, url: Url, ahead: int = 0) -> Self:
        """Open it; whenever something is read that is not here, fetch `ahead` bytes at least."""
        far = _Far(url, _open(url), ahead)
        file: Self = super().__new__(cls, far, "r")
        file.far = far
        return file

    def __init__(self, url: Url, ahead: int = 0) -> None: ...

    def fetch(self, ranges: Iterable[Range]) -> pa.NativeFile:
        """Fetch what will be read, in place of what was fetched before, and return a file to read it from.

        Ranges need not be in the file, nor apart: they are the claims of a footer. What is in none of them is 0 in the
        returned file: it lies in memory, for a file of ten thousand row groups is read in as many small pieces, and to
        ask Python for each takes longer than to decode them. One that is larger than what is fetched at once is not
        copied, and asks.
        """
        self.far.fetch(ranges)
        return self.far.in_memory() or self


class _Far:
    """What Arrow asks for the bytes of a file."""

    closed = False

    def __init__(self, url: Url, opened: _Opened, ahead: int) -> None:
        self._url, self._opened, self._ahead, self._at = url, opened, ahead, 0
        self._last: _Part = (0, memoryview(b""))
        self._parts: list[_Part] = []
        if _is_metadata(url) and opened.size <= _KEPT:
            self._last = (0, memoryview(_whole(url, opened)))
        elif 0 < opened.size <= _WHOLE:
            [self._last] = _fetch(url, opened, [(0, opened.size)])

    def close(self) -> None:
        self.closed = True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._opened.size}[whence]
        return self._at

    def read(self, n_bytes: int = -1) -> memoryview:
        size = self._opened.size
        begin = min(self._at, size)
        end = size if n_bytes < 0 else min(begin + n_bytes, size)
        self._at = end
        here = next((part for part in (self._last, *self._parts) if _holds(part, begin, end)), None)
        if here is None:
            here = self._last = self._fetch_before_last(begin, end)
        return here[1][begin - here[0] : end - here[0]]

    def _fetch_before_last(self, begin: int, end: int) -> _Part:
        """Fetch a range, but for what was read last, which a footer goes on in that is longer than Arrow thought."""
        start, last = self._last
        goes_on = begin < start < end <= start + len(last)
        stop = start if goes_on else max(end, min(begin + self._ahead, self._opened.size))
        [(_, read)] = _fetch(self._url, self._opened, [(begin, stop)])
        return begin, memoryview(b"".join((read, last))) if goes_on else read

    def fetch(self, ranges: Iterable[Range]) -> None:
        """Fetch ranges but for what was read last, which of a parquet file is its end."""
        start, last = self._last
        size = self._opened.size
        if _holds(self._last, 0, size):
            return
        known = start if start + len(last) == size else size
        merged = [(begin, end) for begin, end in _merged(ranges, size) if begin < known]
        parts = _fetch(self._url, self._opened, [(begin, min(end, known)) for begin, end in merged])
        self._parts = [
            (begin, memoryview(b"".join((part, last[: end - known]))) if end > known else part)
            for (begin, end), (_, part) in zip(merged, parts, strict=True)
        ]

    def in_memory(self) -> pa.NativeFile | None:
        """Return what was fetched as a file of the same size, unless that is too large; the parts go into it."""
        size = self._opened.size
        if size > _AT_ONCE:
            return None
        if _holds(self._last, 0, size):
            return pa.BufferReader(self._last[1])
        whole = np.zeros(size, np.uint8)  # of this, what is never written costs nothing: a bytearray writes all of it
        for begin, part in (*self._parts, self._last):
            whole[begin : begin + len(part)] = np.frombuffer(part, np.uint8)
        self._parts = []
        return pa.BufferReader(whole)


def read_far(url: Url, max_bytes: int) -> bytes:
    """Read a whole file.

    Raises
    ------
    FileNotFoundError
        If there is none.
    DatasetError
        If it is larger than `max_bytes`.
    Unreachable
        If it cannot be fetched.
    """
    opened = _open(url)
    if opened.size > max_bytes:
        raise DatasetError(Fault(url, "", f"{opened.size} bytes", f"at most {max_bytes}"))
    return _whole(url, opened)


def is_far_file(url: Url) -> bool:
    """Tell whether there is a file.

    Raises
    ------
    Unreachable
        If nobody can say.
    """
    try:
        return url.is_below_top and _open(url).size >= 0
    except FileNotFoundError:
        return False


def list_far(url: Url) -> list[Url]:
    """Return all files below a folder, sorted; there need not be one.

    Raises
    ------
    Unreachable
        If they cannot be listed.
    """
    try:
        keys = _ask(url, partial(_list, url))
    except FileNotFoundError:
        return []
    return sorted(Url(f"{url.scheme}://") / key.strip("/") for key in keys)


def _holds(part: _Part, begin: int, end: int) -> bool:
    return part[0] <= begin and end <= part[0] + len(part[1])


def _is_metadata(url: Url) -> bool:
    return url.parent.name == "meta" or url.parents[1].name == "episodes"


def _whole(url: Url, opened: _Opened) -> bytes:
    """Return all of a file, and keep it until others need the room."""
    name = (url, opened.size, opened.version)
    with _lock:
        if name in _kept:
            _kept.move_to_end(name)
            return _kept[name]
    contents = b"".join(part for _, part in _fetch(url, opened, [(0, opened.size)]))
    with _lock:
        _kept[name] = contents
        while sum(map(len, _kept.values())) > _KEPT:
            _kept.popitem(last=False)
    return contents


def _fetch(url: Url, opened: _Opened, ranges: Sequence[Range]) -> list[_Part]:
    """Fetch ranges of a file that are apart, in pieces, side by side."""
    if (n_bytes := sum(stop - start for start, stop in ranges)) > _AT_ONCE:
        found, mend = f"{n_bytes:,} bytes to fetch at once", "Download the dataset, and name its folder"
        raise Unreachable(Fault(url, "", found, f"at most {_AT_ONCE:,}", mend))
    pieces = [[(start, min(start + _PIECE, end)) for start in range(begin, end, _PIECE)] for begin, end in ranges]
    with ThreadPoolExecutor(_THREADS) as threads:  # it starts no more than there is work for
        fetched = [[threads.submit(_read, url, opened, *piece) for piece in each] for each in pieces]
        return [
            (begin, memoryview(b"".join(part.result() for part in parts)))
            for (begin, _), parts in zip(ranges, fetched, strict=True)
        ]


def _merged(ranges: Iterable[Range], size: int) -> list[Range]:
    """Sort ranges, cut them to the file, and put those together that are near: what is fetched is fetched once.

    >>> _merged([(9_000, 9_500), (0, 10), (5, 30), (-7, 5), (99_000, 10**12)], 100_000)
    [(0, 30), (9000, 9500), (99000, 100000)]
    """
    merged: list[Range] = []
    for start, stop in sorted((max(start, 0), min(stop, size)) for start, stop in ranges):
        if merged and start <= merged[-1][1] + _GAP:
            merged[-1] = (merged[-1][0], max(stop, merged[-1][1]))
        elif start < stop:
            merged.append((start, stop))
    return merged


def _read(url: Url, opened: _Opened, start: int, stop: int) -> bytes:
    global _n_fetched

    def ask() -> bytes:
        read = opened.read(start, stop)
        if len(read) != stop - start:
            raise OSError(f"{len(read):,} of {stop - start:,} bytes: it was cut off, or has another size now")
        return read

    read = _ask(url, ask)
    with _lock:
        _n_fetched += len(read)
    return read


def _ask[T](url: Url, question: Callable[[], T]) -> T:
    """Ask a store, and again where it fails; say what it says, whatever sort of error its library makes of that."""
    pauses = iter(_PAUSES)
    while True:
        try:
            return question()
        except (FileNotFoundError, MissingExtraError):
            raise
        except Exception as error:
            said = (str(error) or type(error).__name__).splitlines()[0]
        is_denied, pause = _DENIED.search(said), next(pauses, None)
        if is_denied or pause is None:
            mend = _KEYS.get(url.scheme, "") if is_denied else _AGAIN.get(url.scheme, "Try again")
            found = re.sub(r".*AWS Error ", "", said)
            raise Unreachable(Fault(url, "", found, "an answer from where it is stored", mend))
        time.sleep(pause)


def _open(url: Url) -> _Opened:
    return _ask(url, partial(_open_in_arrow if url.scheme in _OF_ARROW else _open_in_fsspec, url))


def _open_in_arrow(url: Url) -> _Opened:
    file = _arrow_files(url.scheme, os.getpid()).open_input_file(url.key)
    return _Opened(file.size(), str(file.metadata()), lambda start, stop: file.read_at(stop - start, start))


def _open_in_fsspec(url: Url) -> _Opened:
    files = _fsspec_files(url.scheme, os.getpid())
    info = files.info(url.key)
    if info["type"] != "file":
        raise FileNotFoundError(str(url))
    version = str([info.get(name) for name in ("blob_id", "created")])
    exact = {"cache_type": "none"}  # else fsspec reads megabytes more than it is asked for
    return _Opened(info["size"], version, lambda start, stop: files.cat_file(url.key, start, stop, **exact))


def _list(url: Url) -> list[str]:
    if url.scheme in _OF_ARROW:
        everything = fs.FileSelector(url.key, allow_not_found=True, recursive=True)
        found = _arrow_files(url.scheme, os.getpid()).get_file_info(everything)
        return [each.path for each in found if each.type == fs.FileType.File]
    keys: list[str] = _fsspec_files(url.scheme, os.getpid()).find(url.key)
    return keys


@cache
def _arrow_files(scheme: str, process: int) -> fs.FileSystem:
    """Return what speaks to a store; each process has its own, since none of them outlives a fork."""
    if scheme == "gs":
        return fs.GcsFileSystem(retry_time_limit=timedelta(seconds=_PATIENCE))
    endpoint = urlsplit(os.environ.get("AWS_ENDPOINT_URL_S3") or os.environ.get("AWS_ENDPOINT_URL") or "")
    return fs.S3FileSystem(
        endpoint_override=endpoint.netloc or None,
        scheme=endpoint.scheme or None,
        region=os.environ.get("AWS_REGION") or os.environ.get("AWS_DEFAULT_REGION"),
        connect_timeout=_PATIENCE,
        request_timeout=_PATIENCE,
        retry_strategy=fs.AwsStandardS3RetryStrategy(max_attempts=1),  # `_ask` asks again, and of more than these do
    )


@cache
def _fsspec_files(scheme: str, process: int) -> Any:
    try:
        if scheme == "memory":
            from fsspec.implementations.memory import MemoryFileSystem

            return MemoryFileSystem()
        from huggingface_hub import HfFileSystem

        return HfFileSystem()
    except ImportError:
        raise MissingExtraError(
            f"{scheme}:// needs fsspec. In a clone of the course: pip install '.[remote]'"
        ) from None
