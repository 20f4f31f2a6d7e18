"""The table of grains that ryusa writes and reads: units in the header, one row per grain and frame."""

import json
import math

from ryusa.formats.grains import UNITS, GrainTable

MARK = "# ryusa "  # before the JSON object that states periods and planes
NUMBERS = ("x", "y", "z", "d", "vx", "vy", "vz", "wx", "wy", "wz", "m")
HEAD = ("t [s]", "step", "id", "fixed", "group", "ix", "iy", *(f"{one} [{UNITS[one]}]" for one in NUMBERS))
_ROW = "%r,%d,%d,%d,%s,%d,%d" + ",%r" * len(NUMBERS)


def csv_head(table: GrainTable) -> bytes:
    """First two lines: what holds for all rows, as JSON in a comment, and the names of the columns."""
    period = table.period or (math.inf, math.inf)
    about = {
        "period": [length if math.isfinite(length) else None for length in period],
        "planes": [[one.name, one.point, one.normal] for one in table.planes],
        "water_zero": table.z_zero,
    }
    return f"{MARK}{json.dumps(about)}\n{','.join(HEAD)}\n".encode()


def csv_frame(table: GrainTable) -> bytes:
    """Rows of one frame."""
    quoted = {name: _quoted(name) for name in set(table.group)}
    n = table.n
    rows = zip(
        [table.t] * n,
        [table.step] * n,
        table.ids.tolist(),
        table.fixed.tolist(),
        [quoted[name] for name in table.group],
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in NUMBERS),
        strict=True,
    )
    return "".join(_ROW % row + "\n" for row in rows).encode()


def _quoted(name: str) -> str:
    name = " ".join(name.split())
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"#') else name
