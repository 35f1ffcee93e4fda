"""Which dataset does a URL name? One in object storage, on the hub, in memory, or in a folder of this machine."""

import os
import re
from pathlib import Path
from typing import NoReturn
from urllib.parse import urlsplit
from urllib.request import url2pathname

from z2r.errors import DatasetError, Fault

# How many parts after the scheme no dataset goes above: a bucket; `datasets`, a user and a name; nothing.
TOPS = {"s3": 1, "gs": 1, "hf": 3, "memory": 0}
_EXAMPLES = "s3://bucket/dataset, gs://bucket/dataset, hf://datasets/user/name, file:///folder or memory://dataset"


class Url(Path):
    """The place of something that is far away. It is joined as any path, and no file system of this machine knows it.

    Examples
    --------
    >>> Url("s3://bucket/dataset") / "meta/info.json"
    Url('s3://bucket/dataset/meta/info.json')
    """

    def with_segments(self, *segments: str | os.PathLike[str]) -> "Url":
        """Return what joining these makes: a URL begins anew, as a path from the top does."""
        begins = [place for place, segment in enumerate(segments) if isinstance(segment, Url)]
        return Url(*segments[begins[-1] if begins else 0 :])

    def __str__(self) -> str:
        scheme, *parts = self.parts
        return f"{scheme}//{'/'.join(parts)}"

    def __fspath__(self) -> NoReturn:
        raise TypeError(f"{self} is no path of this machine")

    def as_posix(self) -> str:
        """Return it as it is written."""
        return str(self)

    def relative_to(self, *others: str | os.PathLike[str], walk_up: bool = False) -> Path:  # type: ignore[override]
        """Return the path from another one to it, which is no URL."""
        return Path(*super().relative_to(*others, walk_up=walk_up).parts)

    @property
    def scheme(self) -> str:
        """Such as ``s3``."""
        return self.parts[0].rstrip(":")

    @property
    def key(self) -> str:
        """What the storage calls it, such as ``bucket/dataset/meta/info.json``."""
        return "/".join(self.parts[1:])

    @property
    def is_below_top(self) -> bool:
        """Whether it is in a bucket, or in a dataset of the hub, and not one of them itself."""
        return len(self.parts) - 1 > TOPS[self.scheme]


def place_of(dataset: str | os.PathLike[str]) -> Path:
    """Return the path of a dataset: a `Url` where it is one, unless that begins with ``file://``.

    Raises
    ------
    DatasetError
        If it is a URL that none is read from.

    Examples
    --------
    >>> place_of("s3://bucket/dataset"), place_of("file:///dataset"), place_of("lerobot/pusht")
    (Url('s3://bucket/dataset'), PosixPath('/dataset'), PosixPath('lerobot/pusht'))
    """
    text = dataset if isinstance(dataset, str) else ""
    if isinstance(dataset, Url) or not re.match(r"[A-Za-z][A-Za-z0-9+.-]*://", text):
        return dataset if isinstance(dataset, Url) else Path(dataset)
    if text.startswith("file://"):
        return Path(url2pathname(urlsplit(text).path))
    url = Url(text)
    known = url.scheme in TOPS and len(url.parts) > max(TOPS[url.scheme], 1)
    if not known or ".." in url.parts or "\0" in text or (url.scheme == "hf" and url.parts[1] != "datasets"):
        raise DatasetError(Fault(url, "", "a URL that no dataset is read from", f"one such as {_EXAMPLES}"))
    return url
