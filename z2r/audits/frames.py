"""The frames of one data file, as far as they can be read."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from z2r.arrays import Array, Columns
from z2r.audits.findings import Finding, error, from_fault, note, warning
from z2r.audits.index import and_more
from z2r.errors import DatasetError
from z2r.format.parquet import has_gaps, open_parquet, read_columns, vectors, width
from z2r.format.schema import BOOKKEEPING, MAX_SIGNAL_SIZE, Schema, inside


class File(NamedTuple):
    """One data file: the columns that can be read, and how many rows it has; None where it cannot be opened."""

    frames: Columns
    n_rows: int | None
    findings: list[Finding]


def read_file(root: Path, schema: Schema, path: Path) -> File:
    """Read the numeric columns of a data file; `path` is relative to `root`."""
    try:
        real = inside(root, path)
        parquet = open_parquet(real)
        present = parquet.schema_arrow.names
        findings = [*_check_names(schema, present, path), *_check_wide(schema, parquet.schema_arrow, path)]
        wanted = [name for name in (*schema.signals(), *BOOKKEEPING) if name in present and name in schema.features]
        table = read_columns(parquet, real, wanted)
    except DatasetError as fault:
        return File({}, None, [from_fault("data-file", fault, root)])
    frames: Columns = {}
    for name in wanted:
        values, faults = _read_column(table, name, schema, real, root)
        findings += faults
        if values is not None:
            frames[name] = values
    return File(frames, len(table), findings)


def _read_column(
    table: pa.Table, name: str, schema: Schema, path: Path, root: Path
) -> tuple[Array | None, list[Finding]]:
    feature, inner = schema.features[name], path.relative_to(root)
    try:
        values = vectors(table, name, feature.shape, path)
    except DatasetError as fault:
        return None, [from_fault("finite" if has_gaps(table, name) else "column-type", fault, root)]
    kinds = "iu" if name in BOOKKEEPING and name != "timestamp" else "biuf"
    if values.dtype.kind not in kinds:
        return None, [error("column-type", inner, name, f"values of type {values.dtype}", "whole numbers")]
    findings = list(_check_dtype(feature.dtype, values, name, inner))
    finite = np.isfinite(values)
    if finite.all():
        return values, findings
    row, column = np.argwhere(~finite)[0].tolist()
    place = f"{name}[{feature.dim_names[column]}]" if feature.dim_names else f"{name}[{column}]"
    found = f"{values[row, column]}{and_more(~finite)}"
    findings.append(error("finite", inner, f"{place} in row {row}", found, "a finite number"))
    return None, findings


def _check_names(schema: Schema, present: list[str], path: Path) -> Iterator[Finding]:
    """Videos are files of their own; every other feature is a column."""
    stored = [name for name, feature in schema.features.items() if feature.dtype != "video"]
    for name in [name for name in stored if name not in present]:
        yield error("columns", path, name, "no such column", "one for each feature in meta/info.json")
    for name in [name for name in present if name not in schema.features]:
        mend = "LeRobot refuses such a file: name it in the features, or drop it"
        yield error("columns", path, name, "a column", "only features that meta/info.json names", mend)


def _check_wide(schema: Schema, stored: pa.Schema, path: Path) -> Iterator[Finding]:
    """Hold the width of what is too wide to be read against the schema."""
    for name, feature in schema.features.items():
        if feature.size > MAX_SIGNAL_SIZE and feature.is_numeric and name in stored.names:
            found = width(stored.field(name).type)
            if found not in (None, feature.size):
                expected = f"{feature.size:,}, as its shape in meta/info.json says"
                yield error("column-type", path, name, f"{found:,} numbers in each row", expected)


def _check_dtype(dtype: str, values: Array, name: str, path: Path) -> Iterator[Finding]:
    stored = values.dtype.name
    if dtype == stored or (dtype == "bool" and stored == "uint8"):  # as booleans are read
        return
    tell = note if values.dtype.kind == "f" and dtype.startswith("float") else warning
    yield tell("column-type", path, name, f"values of type {stored}", f"{dtype}, as meta/info.json says")
