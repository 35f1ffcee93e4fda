"""Parquet columns as numpy arrays: checked, read-only, and without pandas.

Two costs are avoided on purpose. `pyarrow.parquet.read_table` imports the whole dataset machinery (about 0.4 s), and
`to_numpy` on an Arrow array imports pandas where it is installed (0.3 to 0.6 s); `ParquetFile` and DLPack need neither.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Ints
from z2r.errors import DatasetError, Fault, some
from z2r.format.store import check_no_pointer, fault_of, fetch, is_far, open_mapped, open_streamed

# The last one: pyarrow meets a damaged column name.
_UNREADABLE = (pa.ArrowException, OSError, UnicodeDecodeError)
NUMERIC = "numbers, one for each frame"
_MAX_NUMBERS = 2**28  # at a time: 1 GiB of float32
_MAX_NUMBERS_OF_A_SHARD = 2**29  # of metadata, of which all are decoded
_MAX_NUMBERS_OF_A_FILE = 2**32  # in blocks: what a footer claims beyond that is no recording
_BLOCK = 2**21  # numbers: 8 MiB of float32
_SMALL = 2**16  # numbers: they are read at once by one thread
_BUFFER = 2**20  # bytes of a column of a row group that is larger than a block
_MAX_BLOBS, _MAX_BLOB_BYTES = 64, 2**27  # at a time
_MAX_NUMBERS_OF_A_ROW = 2**22
_PLAIN = ("BOOLEAN", "INT32", "INT64", "FLOAT", "DOUBLE")  # how numbers are stored: never larger than they seem
_MAX_TEXT_BYTES = 2**26  # in one column of a row group
_MAX_TEXT = 2**16  # characters
_TEXT_BYTES_AT_ONCE = 2**24


def open_parquet(path: Path) -> pq.ParquetFile:
    """Open a parquet file and read its footer.

    Raises
    ------
    DatasetError
        If the file is missing, a pointer of Git LFS, or no whole parquet file.
    """
    try:
        return _opened(open_mapped(path))
    except (FileNotFoundError, PermissionError) as error:
        raise DatasetError(fault_of(error, path, "a parquet file")) from None
    except _UNREADABLE as error:
        check_no_pointer(path, "a parquet file")
        raise _unreadable(path, error) from error


def _opened(source: pa.NativeFile, **options: Any) -> pq.ParquetFile:
    file = pq.ParquetFile(source, **options)
    file.source, file.counted = source, {}
    return file


def _fetched(file: pq.ParquetFile, columns: Sequence[str], groups: Sequence[int]) -> pq.ParquetFile:
    """Fetch the columns of some row groups at once, of a file that is far away; return the file to read them from."""
    names = tuple(f"{column}." for column in columns)  # a leaf is `observation.state.list.element`
    leaves = [place for place, leaf in enumerate(file.schema) if f"{leaf.path}.".startswith(names)]
    chunks = (group.column(leaf) for group in map(file.metadata.row_group, groups) for leaf in leaves)
    return _opened(fetch(file.source, map(_range, chunks)), metadata=file.metadata, pre_buffer=False)


def _range(chunk: pq.ColumnChunkMetaData) -> tuple[int, int]:
    start = chunk.dictionary_page_offset if chunk.has_dictionary_page else chunk.data_page_offset
    return start, start + chunk.total_compressed_size


def read_columns(
    file: pq.ParquetFile, path: Path, columns: Sequence[str], n_rows: int | None = None, *, alone: bool = True
) -> pa.Table:
    """Read columns of an open parquet file.

    Parameters
    ----------
    file : ParquetFile
        From `open_parquet`.
    path : Path
        Where it was opened, for the error messages.
    columns : sequence of str
        Names of top-level columns.
    n_rows : int, optional
        Read no more row groups than the first `n_rows` rows need. All rows unless given.
    alone : bool, optional
        Whether no other file is read beside this one: if one is, threads for each column get in its way.

    Returns
    -------
    Table
        The columns, at least `n_rows` rows of them where the file has as many.

    Raises
    ------
    DatasetError
        If a column is missing or comes twice, or the bytes cannot be decoded, or the file has fewer rows than it says,
        or more than fit into memory: a small file can claim a billion.
    """
    claimed, a_row = _check_claims(file, path, columns, n_rows, _MAX_NUMBERS)
    groups = _leading_row_groups(file, n_rows)
    try:
        if is_far(path):
            file = _fetched(file, columns, groups)
        # To hand a small file over to other threads costs more than to read it.
        table = file.read_row_groups(groups, columns=list(columns), use_threads=alone and claimed * a_row > _SMALL)
    except _UNREADABLE as error:
        raise _unreadable(path, error) from error
    _check_rows(path, len(table), claimed)
    return table


def read_alike(files: Sequence[tuple[Path, int]], sizes: Mapping[str, int]) -> pa.Table | None:
    """Read columns of numbers of small files that are alike, one after another, as one table.

    Types are looked at in the first file only: where there are thousands, to look at all costs more than to read.

    Parameters
    ----------
    files : sequence of Path and int
        Each file, and how many rows it should have.
    sizes : mapping of str to int
        The columns, and how many numbers each row should have.

    Returns
    -------
    Table or None
        None where a file is missing, damaged, unlike the first, or has not what it should have: who reads each by
        itself learns which one, and why.
    """
    try:
        opened = (_opened(open_mapped(path)) for path, _ in files)
        first = next(opened)
        counts, tables = _leaves_of_numbers(first, sizes), []
        for file, (_, n_rows) in zip(itertools.chain([first], opened), files, strict=True) if counts else ():
            if not (file.schema.equals(first.schema) and _holds(file, n_rows, counts)):
                return None
            tables.append(file.read(list(sizes), use_threads=False))
        table = pa.concat_tables(tables) if tables else None
    except _UNREADABLE:
        return None
    return table if table is not None and len(table) == sum(n_rows for _, n_rows in files) else None


def _leaves_of_numbers(file: pq.ParquetFile, sizes: Mapping[str, int]) -> dict[int, int]:
    """Return the one leaf of each column, and how many numbers it has for each row; nothing if one has no numbers."""
    names, leaves, counts = file.schema_arrow.names, _leaves(file.schema_arrow), {}
    for column, size in sizes.items():
        own = leaves.get(column, range(0))
        if names.count(column) != 1 or len(own) != 1 or file.schema.column(own[0]).physical_type not in _PLAIN:
            return {}
        counts[own[0]] = size
    return counts


def _holds(file: pq.ParquetFile, n_rows: int, counts: Mapping[int, int]) -> bool:
    """Tell whether a file claims to have so many rows, and so many numbers for each in some leaves."""
    groups = [file.metadata.row_group(group) for group in range(file.num_row_groups)]
    return file.metadata.num_rows == n_rows and all(
        sum(group.column(leaf).num_values for group in groups) == n_rows * size for leaf, size in counts.items()
    )


def read_blocks(
    file: pq.ParquetFile, path: Path, columns: Sequence[str], n_rows: int | None = None, *, alone: bool = True
) -> Iterator[pa.Table]:
    """Read columns as `read_columns` does, so many rows at a time that memory does not grow with the file.

    Parameters
    ----------
    file, path, columns, n_rows, alone
        As for `read_columns`.

    Yields
    ------
    Table
        Rows that follow each other: of a file that is not large all of them, else those of some row groups, or of a
        part of one that is large by itself. None is empty, but that of an empty file.

    Raises
    ------
    DatasetError
        As `read_columns`.
    """
    claimed, a_row = _check_claims(file, path, columns, n_rows, _MAX_NUMBERS_OF_A_FILE)
    at_once, n_read = max(1, _BLOCK // a_row), 0
    if claimed <= at_once:
        yield read_columns(file, path, columns, n_rows, alone=alone)
        return
    for groups in _blocks_of_row_groups(file, _leading_row_groups(file, n_rows), at_once):
        try:  # opened anew: what was read of the file before need not stay in memory
            far, is_large = is_far(path), file.metadata.row_group(groups[0]).num_rows > at_once
            opened, buffer = (open_streamed(path), _BUFFER) if is_large and not far else (open_mapped(path), 0)
            part = _opened(opened, metadata=file.metadata, buffer_size=buffer, pre_buffer=False)
            if far:
                part = _fetched(part, columns, groups)
            for batch in part.iter_batches(at_once, row_groups=groups, columns=list(columns), use_threads=alone):
                n_read += len(batch)
                yield pa.Table.from_batches([batch])
        except _UNREADABLE as error:
            raise _unreadable(path, error) from error
    _check_rows(path, n_read, claimed)


def _check_claims(
    file: pq.ParquetFile, path: Path, columns: Sequence[str], n_rows: int | None, most: int
) -> tuple[int, int]:
    """Check that columns can be read, by the footer; return how many rows it claims, and how many numbers each has."""
    stored = file.schema_arrow  # made anew at each call
    present = stored.names
    for column in columns:
        if column not in present:
            raise DatasetError(Fault(path, column, "no such column", f"it among {some(present)}"))
        if present.count(column) > 1:
            raise DatasetError(Fault(path, column, f"{present.count(column)} columns of this name", "one"))
    claimed = file.metadata.num_rows if n_rows is None else min(n_rows, file.metadata.num_rows)
    groups = _leading_row_groups(file, n_rows)
    leaves = _leaves(stored)
    n_values = [_n_values(file, leaves[column], groups) or claimed for column in columns]
    a_row = max(1, sum(-(-each // max(claimed, 1)) for each in n_values))
    mend = "LeRobot begins a new file every 100 MB: it is damaged, or wants to be split"
    if claimed * a_row > most or a_row > _MAX_NUMBERS_OF_A_ROW:
        found = f"{claimed:,} rows of {a_row:,} numbers"
        expected = f"at most {most:,} numbers in one file, and {_MAX_NUMBERS_OF_A_ROW:,} in a row"
        raise DatasetError(Fault(path, "rows", found, expected, mend))
    for column in columns:
        if (size := _text_bytes(file, leaves[column], groups)) > _MAX_TEXT_BYTES:
            expected = f"at most {_MAX_TEXT_BYTES:,} in a row group"
            raise DatasetError(Fault(path, column, f"{size:,} bytes of text", expected, mend))
    return claimed, a_row


def count_values(file: pq.ParquetFile, columns: Sequence[str]) -> dict[str, int]:
    """Return how many numbers the lists in some columns hold, by the footer; 0 for a column without lists.

    Nothing is decoded: a few bytes may hold very many.
    """
    leaves, groups = _leaves(file.schema_arrow), range(file.num_row_groups)
    return {column: _n_values(file, leaves[column], groups) for column in columns}


def _n_values(file: pq.ParquetFile, leaves: range, groups: Sequence[int]) -> int:
    """Count the values of lists in the first row groups; once, for a file may have very many of these."""
    if (leaves, len(groups)) not in file.counted:
        metadata, lists = file.metadata, [leaf for leaf in leaves if file.schema.column(leaf).max_repetition_level]
        n = sum(metadata.row_group(group).column(leaf).num_values for leaf in lists for group in groups)
        file.counted[leaves, len(groups)] = n
    n_values: int = file.counted[leaves, len(groups)]
    return n_values


def _text_bytes(file: pq.ParquetFile, leaves: range, groups: Sequence[int]) -> int:
    """Say how much text a row group holds at most, each once where it knows that it repeats it; 0 if it holds none."""
    texts = [leaf for leaf in leaves if file.schema.column(leaf).physical_type == "BYTE_ARRAY"]
    chunks = (file.metadata.row_group(group).column(leaf) for leaf in texts for group in groups)
    return max((chunk.total_uncompressed_size for chunk in chunks), default=0)


def _leaves(stored: pa.Schema) -> dict[str, range]:
    """Return which leaves of a file each column is: a name may hold dots, so that a path does not tell."""
    leaves, first = {}, 0
    for field in stored:
        leaves[field.name] = range(first, first + _n_leaves(field.type))
        first = leaves[field.name].stop
    return leaves


def _n_leaves(kind: pa.DataType) -> int:
    kind = kind.storage_type if isinstance(kind, pa.ExtensionType) else kind
    if pa.types.is_struct(kind) or _is_list(kind) or pa.types.is_map(kind):
        return sum(_n_leaves(kind.field(place).type) for place in range(kind.num_fields))
    return 1


def check_readable(file: pq.ParquetFile, path: Path) -> None:
    """Decode all columns of an open parquet file, some rows at a time, and keep nothing.

    Raises
    ------
    DatasetError
        As `read_columns`.
    """
    n_read, claimed = 0, file.metadata.num_rows
    for batch in _batches(file, path, file.schema_arrow.names):
        n_read += len(batch)
    _check_rows(path, n_read, claimed)


def _batches(file: pq.ParquetFile, path: Path, columns: Sequence[str]) -> Iterator[pa.RecordBatch]:
    """Read columns, among them such of text, of so many rows at a time that they fit were each text the longest."""
    claimed, a_row = _check_claims(file, path, columns, None, _MAX_NUMBERS_OF_A_SHARD)
    leaves, n_values = _leaves(file.schema_arrow), count_values(file, columns)
    longest = (  # in each row, were each of its texts all that a row group holds
        _text_bytes(file, leaves[column], range(file.num_row_groups)) * -(-max(n_values[column], 1) // max(claimed, 1))
        for column in columns
    )
    a_text = max([*longest, 1])
    try:
        yield from file.iter_batches(max(1, min(_BLOCK // a_row, _TEXT_BYTES_AT_ONCE // a_text)), columns=list(columns))
    except _UNREADABLE as error:
        raise _unreadable(path, error) from error


def _check_rows(path: Path, n_read: int, claimed: int) -> None:
    if n_read < claimed:
        expected = f"{claimed}, as its footer says"
        raise DatasetError(Fault(path, "rows", f"{n_read}", expected, mend="It is damaged: copy or record it again"))


def _blocks_of_row_groups(file: pq.ParquetFile, groups: Sequence[int], at_once: int) -> Iterator[list[int]]:
    """Put row groups together that have so many rows at most, or one that has more."""
    block: list[int] = []
    n_rows, metadata = 0, file.metadata
    for group in groups:
        own = metadata.row_group(group).num_rows
        if block and n_rows + own > at_once:
            yield block
            block, n_rows = [], 0
        block.append(group)
        n_rows += own
    yield block


def width(kind: pa.DataType) -> int | None:
    """Return how many numbers a value of an Arrow type holds; None where that differs from row to row.

    >>> width(pa.float32()), width(pa.list_(pa.float32(), 10)), width(pa.list_(pa.float32()))
    (1, 10, None)
    """
    kind = kind.storage_type if isinstance(kind, pa.ExtensionType) else kind
    if pa.types.is_fixed_size_list(kind):
        inner = width(kind.value_type)
        return None if inner is None else kind.list_size * inner
    return None if _is_list(kind) else 1


def dtype_of(kind: pa.DataType) -> str | None:
    """Return which dtype of numpy the numbers in a value of an Arrow type have; None where they are no numbers.

    >>> dtype_of(pa.list_(pa.float32(), 10)), dtype_of(pa.bool_()), dtype_of(pa.string())
    ('float32', 'bool', None)
    """
    kind = kind.storage_type if isinstance(kind, pa.ExtensionType) else kind
    if _is_list(kind):
        return dtype_of(kind.value_type)
    is_number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind)
    return np.dtype(kind.to_pandas_dtype()).name if is_number else None


def gap_rows(table: pa.Table, column: str) -> Bools:
    """Tell of each row whether a value, or a number in one, is missing: of numbers, or (nested) lists of numbers.

    >>> gap_rows(pa.table({"state": [[1.0, 2.0], [3.0, None], None]}), "state")
    array([False,  True,  True])
    """
    array, row = _one_array(table, column), np.arange(len(table))
    wrong = np.zeros(len(table), dtype=bool)
    while True:
        missing = np.array(array.is_null(), dtype=bool)
        wrong[row[missing]] = True
        if not _is_list(array.type):
            return wrong
        sizes = np.array(array.value_lengths().fill_null(0), dtype=np.int64)
        array, row = array.flatten(), np.repeat(row, sizes)


def integers(table: pa.Table, column: str, path: Path) -> Ints:
    """Return one integer column as a read-only array, int64[n_rows].

    Raises
    ------
    DatasetError
        If the column holds anything but whole numbers, or has gaps.
    """
    array = _one_array(table, column)
    if not pa.types.is_integer(array.type):
        raise DatasetError(Fault(path, column, f"type {array.type}", "whole numbers"))
    _check_no_gaps(array, path, column)
    return np.from_dlpack(array).astype(np.int64, copy=False)


def texts(file: pq.ParquetFile, column: str, path: Path) -> list[str | None]:
    """Return a column of text; where one is repeated, it is held once.

    Raises
    ------
    DatasetError
        If a text is not UTF-8, or is no text that anybody wrote: a small file may repeat a long one very often.
    """
    known: dict[str, str] = {}
    said: list[str | None] = []
    for batch in _batches(file, path, [column]):
        for text in _decoded(batch.column(0), column, path):
            if text is not None and len(text) > _MAX_TEXT:
                expected = f"at most {_MAX_TEXT:,}"
                raise DatasetError(Fault(path, column, f"a text of {len(text):,} characters", expected))
            said.append(text and known.setdefault(text, text))
    return said


def text_sets(file: pq.ParquetFile, column: str, path: Path) -> Iterator[frozenset[str]]:
    """Yield the texts in each row of a column of lists of text.

    Each text and set is held once in a row group, however often it stands there: a small file may repeat a long one.

    Raises
    ------
    DatasetError
        If the column is missing or of another kind, or cannot be decoded.
    """
    leaves = [leaf for leaf in (each.path for each in file.schema) if leaf.partition(".")[0] == column]
    try:
        file = _opened(open_mapped(path), metadata=file.metadata, read_dictionary=leaves)
        for number in range(file.num_row_groups):  # pyarrow cannot put the dictionaries of several together
            for chunk in file.read_row_group(number, columns=[column], use_threads=False)[column].chunks:
                yield from _text_sets(chunk, column, path)
    except KeyError:
        raise DatasetError(Fault(path, column, "no such column", "lists of text")) from None
    except _UNREADABLE as error:
        raise _unreadable(path, error) from error


def _text_sets(lists: pa.Array, column: str, path: Path) -> Iterator[frozenset[str]]:
    if not _is_lists_of_known_texts(lists.type):
        raise DatasetError(Fault(path, column, f"values of type {lists.type}", "lists of text"))
    known, places = _decoded(lists.values.dictionary, column, path), lists.values.indices.to_pylist()
    said: dict[tuple[int | None, ...], frozenset[str]] = {}
    for start, stop in itertools.pairwise(lists.offsets.to_pylist()):
        those = tuple(places[start:stop])
        if those not in said:
            said[those] = frozenset(known[place] for place in those if place is not None)
        yield said[those]


def blobs(file: pq.ParquetFile, column: str, field: str, path: Path) -> Iterator[tuple[NDArray[np.uint8], Ints]]:
    """Yield the bytes in one field of a column of structs, for some rows at a time: fewer, where they may be large.

    Yields
    ------
    data : ndarray, uint8[n_bytes]
    offsets : ndarray, int64[n + 1]
        Where in `data` each row begins and ends: nowhere, where nothing is stored.

    Raises
    ------
    DatasetError
        If the column is missing or of another type, or cannot be decoded.
    """
    stored, expected = file.schema_arrow, f"bytes in a field {field}"
    if stored.names.count(column) != 1:
        raise DatasetError(Fault(path, column, "no such column", expected))
    kind = stored.field(column).type
    place = kind.get_field_index(field) if pa.types.is_struct(kind) else -1
    if place < 0 or kind.field(place).type not in (pa.binary(), pa.large_binary()):
        raise DatasetError(Fault(path, column, f"values of type {kind}", expected))
    leaf, dtype = f"{column}.{field}", np.int32 if kind.field(place).type == pa.binary() else np.int64
    try:
        for batch in file.iter_batches(_rows_at_a_time(file, leaf), columns=[leaf], use_threads=False):
            [array] = batch.column(0).flatten()
            _, offsets, data = array.buffers()
            places = np.frombuffer(offsets, dtype)[array.offset :][: len(array) + 1].astype(np.int64)
            yield np.frombuffer(data or b"", np.uint8), places
    except _UNREADABLE as error:
        raise _unreadable(path, error) from error


def _rows_at_a_time(file: pq.ParquetFile, leaf: str) -> int:
    """Say how many rows to read at a time, so that they fit, were each of them as large as all of a row group."""
    groups = (file.metadata.row_group(number) for number in range(file.metadata.num_row_groups))
    chunks = (group.column(place) for group in groups for place in range(group.num_columns))
    largest = max((chunk.total_uncompressed_size for chunk in chunks if chunk.path_in_schema == leaf), default=1)
    return max(1, min(_MAX_BLOBS, _MAX_BLOB_BYTES // max(largest, 1)))


def vectors(table: pa.Table, column: str, shape: Sequence[int], path: Path, first: int = 0) -> Array:
    """Return one numeric column as a read-only array, one flattened vector for each row.

    Parameters
    ----------
    table : Table
        From `read_columns`.
    column : str
        Name of a column of numbers, or of (nested) lists of numbers.
    shape : sequence of int
        The shape that the schema declares for one row. ``(1,)`` also stands for a plain number.
    path : Path
        For the error messages.
    first : int
        And for these, which row of the file the table begins with.

    Returns
    -------
    ndarray, (n_rows, prod(shape)), of the column's own dtype
        Booleans are returned as uint8.

    Raises
    ------
    DatasetError
        If a row has another shape, is missing, or is not numeric.
    """
    array = _one_array(table, column)
    n_rows = len(array)
    for size in () if tuple(shape) == (1,) and not _is_list(array.type) else shape:
        _check_no_gaps(array, path, column)
        array = _flatten_lists(array, size, shape, path, column, n_rows, first)
    _check_no_gaps(array, path, column)
    if pa.types.is_boolean(array.type):
        array = array.cast(pa.uint8())
    if not (pa.types.is_integer(array.type) or pa.types.is_floating(array.type)):
        raise DatasetError(Fault(path, column, f"values of type {array.type}", NUMERIC))
    return np.from_dlpack(array).reshape(n_rows, math.prod(shape))


def _leading_row_groups(file: pq.ParquetFile, n_rows: int | None) -> list[int]:
    n_groups = file.metadata.num_row_groups
    if n_rows is None or n_rows >= file.metadata.num_rows:
        return list(range(n_groups))
    ends = itertools.accumulate(file.metadata.row_group(i).num_rows for i in range(n_groups))
    needed = next((i + 1 for i, end in enumerate(ends) if end >= n_rows), n_groups)
    return list(range(needed))


def _one_array(table: pa.Table, column: str) -> pa.Array:
    chunks = table.column(column)
    array = chunks.chunk(0) if chunks.num_chunks == 1 else chunks.combine_chunks()  # which would copy a single one
    # Two-dimensional features are stored as an extension type of the `datasets` library, around plain nested lists.
    return array.storage if isinstance(array, pa.ExtensionArray) else array


def _flatten_lists(
    array: pa.Array, size: int, shape: Sequence[int], path: Path, column: str, n_rows: int, first: int
) -> pa.Array:
    expected = f"{size} numbers in each row, as its shape {tuple(shape)} in meta/info.json says"
    # `array.flatten()` would do, but imports pyarrow.compute, which costs more than reading a small dataset.
    if pa.types.is_fixed_size_list(array.type):
        if array.type.list_size != size:
            raise DatasetError(Fault(path, column, f"{array.type.list_size} in each row", expected))
        return array.values.slice(array.offset * size, len(array) * size)
    if _is_list(array.type):
        offsets = np.from_dlpack(array.offsets)
        sizes = np.diff(offsets)
        if np.any(sizes != size):
            row = int(np.argmax(sizes != size))
            found = f"{sizes[row]} in row {first + row * n_rows // len(sizes)}"  # each row holds as many lists
            raise DatasetError(Fault(path, column, found, expected))
        return array.values.slice(offsets[0], len(array) * size)
    raise DatasetError(Fault(path, column, f"values of type {array.type}", expected))


def _decoded(array: pa.Array | pa.ChunkedArray, column: str, path: Path) -> list[str]:
    try:
        decoded: list[str] = array.to_pylist()
    except UnicodeDecodeError as error:
        raise DatasetError(Fault(path, column, f"bytes that are no text ({error.reason})", "text in UTF-8")) from None
    return decoded


def _is_lists_of_known_texts(kind: pa.DataType) -> bool:
    if not (pa.types.is_list(kind) or pa.types.is_large_list(kind)) or not pa.types.is_dictionary(kind.value_type):
        return False
    text = kind.value_type.value_type
    return bool(pa.types.is_string(text) or pa.types.is_large_string(text))


def _is_list(kind: pa.DataType) -> bool:
    return bool(pa.types.is_fixed_size_list(kind) or pa.types.is_list(kind) or pa.types.is_large_list(kind))


def _check_no_gaps(array: pa.Array, path: Path, column: str) -> None:
    if array.null_count:
        found = f"no value in {array.null_count} of {len(array)} rows"
        raise DatasetError(Fault(path, column, found, NUMERIC))


def _said(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _unreadable(path: Path, error: Exception) -> DatasetError:
    return DatasetError(
        Fault(
            path,
            "",
            f"bytes that pyarrow cannot read ({_said(error).replace(str(path), path.name)})",
            "a whole parquet file",
            mend="It was cut off or damaged: copy or record it again",
        )
    )
