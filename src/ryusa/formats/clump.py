"""A clump as CSV: the centre and diameter of each of its spheres, with their units, one row per sphere."""

from pathlib import Path

import numpy as np

from ryusa.formats.table import read_lengths
from ryusa.formats.text import D_HIGH, D_LOW
from ryusa.model.clump import Clump, ClumpFault

COLUMNS = ("x", "y", "z", "d")
_EXAMPLE = "'x [mm],y [mm],z [mm],d [mm]'"


def read_clump(path: Path, name: str) -> Clump:
    """Read the spheres of a clump.

    Parameters
    ----------
    path, name : the file, and what messages call it. Lines that are blank or begin with # are passed over;
        the first other line is the header, with the columns x, y, z (centre) and d (diameter) and their
        units, such as x [mm],y [mm],z [mm],d [mm].

    Raises
    ------
    ParseError : the file is no such table, or its spheres make no clump; names line and column.
    """
    called = {one: f"column '{one}'" for one in COLUMNS}
    rows, where, (x, y, z, d) = read_lengths(path, name, "sphere", "at least one sphere", _EXAMPLE, called)
    for row, one in enumerate(d.tolist()):
        if not D_LOW <= one <= D_HIGH:
            raise rows.error(
                row, where[3], f"expected a diameter from {D_LOW:g} to {D_HIGH:g} m, found {one:g} m"
            )
    try:
        return Clump.of(np.stack([x, y, z], axis=1), d)
    except ClumpFault as fault:
        raise rows.error(
            min(fault.sphere, len(rows.where) - 1), 0, f"{fault}; spheres count from 0"
        ) from None
