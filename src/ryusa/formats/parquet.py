"""Parquet: tables of frames, one row group a frame, and of rows; needs pyarrow (`ryusa[parquet]`)."""

import importlib.util
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ryusa.errors import ResultsError
from ryusa.formats.csv import CLUMP_HEAD, NUMBERS, TURN
from ryusa.formats.grains import UNITS, GrainTable


def need_pyarrow(what: str = "--to parquet") -> None:
    """Raise an error that says how to install pyarrow where it is missing."""
    if importlib.util.find_spec("pyarrow") is None:
        raise ResultsError(f"{what} needs pyarrow: pip install 'ryusa[parquet]'")


def write_rows_as_parquet(path: Path, rows: Sequence[Mapping[str, object]], units: Mapping[str, str]) -> None:
    """Write rows that share their keys; None is null, and a column of numbers is one of float64 or int64.

    Parameters
    ----------
    path : the file.
    rows : lines of the table.
    units : SI unit of columns, for their metadata.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields: list[pa.Field] = []
    columns: list[pa.Array] = []
    for name in rows[0] if rows else ():
        values = [row[name] for row in rows]
        kinds = {type(one) for one in values if one is not None}
        kind = pa.string()
        if kinds and kinds <= {bool}:
            kind = pa.bool_()
        elif kinds and kinds <= {int}:
            kind = pa.int64()
        elif kinds <= {int, float}:
            kind = pa.float64()
        columns.append(
            pa.array([one if one is None or kind != pa.string() else str(one) for one in values], kind)
        )
        fields.append(pa.field(name, kind, metadata={"unit": units[name]} if name in units else None))
    pq.write_table(pa.Table.from_arrays(columns, schema=pa.schema(fields)), path)


def write_parquet(path: Path, frames: Iterable[GrainTable]) -> None:
    """Write frames to one file; every column names its unit in its metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    units = {"t": "s", **{name: UNITS[name] for name in NUMBERS}}
    kinds = {
        "t": pa.float64(), "step": pa.int64(), "id": pa.int64(), "fixed": pa.bool_(),
        "group": pa.dictionary(pa.int32(), pa.string()), "ix": pa.int64(), "iy": pa.int64(),
        **dict.fromkeys(NUMBERS, pa.float64()),
    }  # fmt: skip
    writer: pq.ParquetWriter | None = None
    try:
        for table in frames:
            n = table.n
            columns: dict[str, Any] = {
                "t": [table.t] * n, "step": [table.step] * n, "id": table.ids, "fixed": table.fixed,
                "group": list(table.group), "ix": table.image[:, 0], "iy": table.image[:, 1],
                **{name: table.column(name) for name in NUMBERS},
            }  # fmt: skip
            if table.clump is not None and table.orientation is not None:
                columns |= dict(zip(CLUMP_HEAD, (table.clump, *table.orientation.T), strict=True))
                kinds |= {"clump": pa.int64(), **dict.fromkeys(TURN, pa.float64())}
            if writer is None:
                period = [one if math.isfinite(one) else None for one in table.period or ()]
                fields = [
                    pa.field(name, kind, metadata={"unit": units[name]} if name in units else None)
                    for name, kind in kinds.items()
                ]
                schema = pa.schema(fields, metadata={"ryusa": json.dumps({"period": period})})
                writer = pq.ParquetWriter(path, schema)
            arrays = [
                pa.array(columns[name], type=pa.string()).dictionary_encode()
                if name == "group"
                else pa.array(columns[name], type=kind)
                for name, kind in kinds.items()
            ]
            writer.write_table(pa.Table.from_arrays(arrays, schema=writer.schema))
    finally:
        if writer is not None:
            writer.close()
