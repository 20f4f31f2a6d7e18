"""Parquet: the columns of the CSV table, one row group a frame; needs pyarrow (`ryusa[parquet]`)."""

import importlib.util
import json
import math
from collections.abc import Iterable
from pathlib import Path

from ryusa.errors import ResultsError
from ryusa.formats.csv import NUMBERS
from ryusa.formats.grains import UNITS, GrainTable


def need_pyarrow() -> None:
    """Raise an error that says how to install pyarrow where it is missing."""
    if importlib.util.find_spec("pyarrow") is None:
        raise ResultsError("--to parquet needs pyarrow: pip install 'ryusa[parquet]'")


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
            columns = {
                "t": [table.t] * n, "step": [table.step] * n, "id": table.ids, "fixed": table.fixed,
                "group": list(table.group), "ix": table.image[:, 0], "iy": table.image[:, 1],
                **{name: table.column(name) for name in NUMBERS},
            }  # fmt: skip
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
