"""First grains from a CSV table."""

import numpy as np

from ryusa.build.placement import Placement
from ryusa.casefile.builders.schema import TableSection
from ryusa.casefile.builders.table import table_of
from ryusa.casefile.case import Case
from ryusa.casefile.derive import Derived
from ryusa.errors import CaseError
from ryusa.model.scene import Floats


def table(case: Case, _derived: Derived) -> Placement:
    """Grains of the table; ids follow its order, with the rows of one group together."""
    keys, grid = case.build, table_of(case)
    assert isinstance(keys, TableSection)
    assert grid is not None
    if case.motion.plane:
        for name in ("vy", "wx", "wz"):
            if np.any(grid.column(name)):
                raise CaseError("build.file", keys.file, f"column '{name}' must be zero in a plane scene")
    if case.motion.rotation == "locked" and np.any(grid.column("wy")):
        raise CaseError("build.file", keys.file, "column 'wy' must be zero while rotation is locked")
    firsts: dict[tuple[bool, str], int] = {}
    for fixed, group in zip(grid.fixed.tolist(), grid.group, strict=True):
        firsts.setdefault((fixed, group), len(firsts))
    places = [firsts[fixed, group] for fixed, group in zip(grid.fixed.tolist(), grid.group, strict=True)]
    order = np.argsort(places, kind="stable")
    free, fixed = order[~grid.fixed[order]], order[grid.fixed[order]]
    x, d = _columns(grid.column("x"), grid.column("y"), grid.column("z")), grid.column("d")
    labels = [grid.labels[row] for row in (*free, *fixed)]
    period = tuple(p if p is not None else float("inf") for p in (case.domain.period_x, case.domain.period_y))
    return Placement(
        d=d[free],
        x=x[free],
        v=_columns(grid.column("vx"), grid.column("vy"), grid.column("vz"))[free],
        omega=_columns(grid.column("wx"), grid.column("wy"), grid.column("wz"))[free],
        d_fixed=d[fixed],
        x_fixed=x[fixed],
        fixed_groups=_groups([grid.group[row] for row in fixed]),
        free_groups=_groups([grid.group[row] for row in free]),
        period=(period[0], period[1]),
        allow_overlap=keys.allow_overlap,
        names=tuple(labels),
        notes=("zero of the water profile at z = 0 (water.zero not given)",)
        if case.water is not None and case.water.zero is None
        else (),
    )


def _columns(*columns: Floats) -> Floats:
    return np.stack(columns, axis=1)


def _groups(names: list[str]) -> tuple[tuple[str, int, int], ...]:
    found: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        if name:
            found.setdefault(name, []).append(k)
    return tuple((name, ks[0], len(ks)) for name, ks in found.items())
