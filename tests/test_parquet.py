"""Columns of every kind that a LeRobot dataset may hold, against pyarrow's own conversion to Python."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from z2r.errors import DatasetError
from z2r.format.parquet import integers, open_parquet, read_alike, read_columns, vectors

ROWS = 7
NUMBERS = np.arange(ROWS * 6, dtype=np.float32)
NESTED = NUMBERS.reshape(ROWS, 2, 3).tolist()

COLUMNS = {
    "fixed": (pa.FixedSizeListArray.from_arrays(NUMBERS, 6), (6,)),
    "list": (pa.array(NUMBERS.reshape(ROWS, 6).tolist(), pa.list_(pa.float64())), (6,)),
    "large list": (pa.array(NUMBERS.reshape(ROWS, 6).tolist(), pa.large_list(pa.float16())), (6,)),
    "nested": (pa.array(NESTED, pa.list_(pa.list_(pa.float32()))), (2, 3)),
    "nested fixed": (pa.array(NESTED, pa.list_(pa.list_(pa.float32(), 3), 2)), (2, 3)),
    "number": (pa.array(NUMBERS[:ROWS]), (1,)),
    "list of one": (pa.array([[x] for x in NUMBERS[:ROWS]]), (1,)),
    "scalar": (pa.array(NUMBERS[:ROWS]), ()),
    "bool": (pa.array([True, False] * 3 + [True]), (1,)),
    "uint8": (pa.array(range(ROWS), pa.uint8()), (1,)),
}


def write(path: Path, column: pa.Array, rows_per_group: int = 3) -> Path:
    pq.write_table(pa.table({"x": column}), path, row_group_size=rows_per_group)
    return path


def read(path: Path, n_rows: int | None = None) -> pa.Table:
    return read_columns(open_parquet(path), path, ["x"], n_rows)


@pytest.mark.parametrize("kind", COLUMNS)
def test_every_kind_of_column_becomes_a_matrix(kind, tmp_path):
    column, shape = COLUMNS[kind]
    path = write(tmp_path / "x.parquet", column)
    found = vectors(read(path), "x", shape, path)
    assert found.shape == (ROWS, int(np.prod(shape)))
    np.testing.assert_array_equal(found, np.array(column.to_pylist(), dtype=float).reshape(ROWS, -1))


@pytest.mark.parametrize("kind", ["fixed", "list", "nested fixed"])
def test_a_slice_of_a_table_is_read_where_it_begins(kind):
    column, shape = COLUMNS[kind]
    found = vectors(pa.table({"x": column}).slice(2, 3), "x", shape, Path("x"))
    np.testing.assert_array_equal(found, np.array(column.to_pylist()).reshape(ROWS, -1)[2:5])


@pytest.mark.parametrize(
    ("column", "shape"),
    [
        (pa.array(["a"] * ROWS), (1,)),
        (pa.array(NUMBERS[:ROWS]), (2,)),
        (pa.array([[1.0, 2.0]] * ROWS), (1,)),
        (pa.array([[1.0, None]] * ROWS), (2,)),
        (pa.array([[1.0, 2.0]] * (ROWS - 1) + [None]), (2,)),
        (pa.array([[1.0, 2.0]] * (ROWS - 2) + [[1.0], [1.0, 2.0, 3.0]]), (2,)),
        (pa.array(NESTED), (3, 2)),
        (pa.array([[["a"]]] * ROWS), (1, 1)),
    ],
)
def test_a_column_that_is_not_what_the_schema_says_is_named(column, shape, tmp_path):
    path = write(tmp_path / "x.parquet", column)
    with pytest.raises(DatasetError, match=r"x\.parquet: x: found"):
        vectors(read(path), "x", shape, path)


@pytest.mark.parametrize("n_rows", [1, 3, 4, 7, 99])
def test_no_more_row_groups_are_read_than_the_rows_need(n_rows, tmp_path):
    path = write(tmp_path / "x.parquet", pa.array(range(ROWS)))
    assert integers(read(path, n_rows), "x", path).tolist() == list(range(min(-(-n_rows // 3) * 3, ROWS)))


@pytest.mark.parametrize(
    ("second", "size"),
    [
        (pa.array([[1.0] * 70, [1.0]], pa.list_(pa.float64())), 2),
        (pa.array([[1.0, 2.0], [3.0, 4.0]], pa.list_(pa.float32())), 2),
        (pa.array(["long", "text"]), 1),
        (pa.array([[1.0, 2.0]], pa.list_(pa.float64())), 2),
    ],
    ids=["more numbers", "another type", "text", "a row less"],
)
def test_small_files_are_not_decoded_where_their_footers_are_not_alike(second, size, tmp_path, monkeypatch):
    """A few bytes may claim to be very many numbers."""
    decoded: list[int] = []
    monkeypatch.setattr(pq.ParquetFile, "read", lambda *_, **__: decoded.append(1))
    first = second if size == 1 else pa.array([[1.0, 2.0], [3.0, 4.0]], pa.list_(pa.float64()))
    for name, values in (("first", first), ("second", second)):
        pq.write_table(pa.table({"x": values}), tmp_path / name)
    assert read_alike([(tmp_path / "first", 2), (tmp_path / "second", 2)], {"x": size}) is None
    assert len(decoded) == (size != 1)
