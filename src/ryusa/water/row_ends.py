"""Ends of a row: an inlet as steady flow has it, and discharge and level over time."""

from dataclasses import dataclass, field, replace

import numpy as np

from ryusa.laws.families import Drive
from ryusa.model import ColumnRow
from ryusa.model.row import EndKind, RowEnd
from ryusa.water.row import ends_of
from ryusa.water.row_layout import RowEnds
from ryusa.water.steady import steady

ALIKE = 0.01  # of the range of a hydrograph: profile and depth of an inlet are found anew for such a change


@dataclass
class EndsOverTime:
    """The ends of a row whose discharge or level changes over time.

    Attributes
    ----------
    row : without what `with_inlet` finds.
    """

    row: ColumnRow
    _inlets: dict[int, RowEnd] = field(default_factory=dict[int, RowEnd])

    @staticmethod
    def of(row: ColumnRow) -> "EndsOverTime | None":
        """The ends of a row; None where they do not change."""
        changes = any(end is not None and end.course is not None for end in (row.upstream, row.downstream))
        return EndsOverTime(row) if changes else None

    def over(self, begin: float, end: float) -> RowEnds:
        """Ends whose discharge and level are the means from begin to end [s]."""
        up, down = self.row.upstream, self.row.downstream
        if up is not None:
            q = up.discharge if up.course is None else up.course.mean(begin, end)
            up = replace(self._inlet(up, q), discharge=q)
        if down is not None and down.course is not None:
            down = replace(down, level=down.course.mean(begin, end))
        return ends_of(replace(self.row, upstream=up, downstream=down))

    def _inlet(self, up: RowEnd, q: float) -> RowEnd:
        """The upper end with depth and profile of a discharge near this one [m2/s]; found once for each."""
        if not q > 0.0:
            return up
        apart = (ALIKE * (max(up.course.y) - min(up.course.y)) if up.course else 0.0) or q
        k = max(round(q / apart), 1)
        if k not in self._inlets:
            near = with_inlet(replace(self.row, upstream=replace(up, discharge=k * apart))).upstream
            assert near is not None
            self._inlets[k] = near
        return self._inlets[k]


def with_inlet(row: ColumnRow) -> ColumnRow:
    """The row with depth and profile of its inlet as steady flow over the bottom there has them.

    Notes
    -----
    Where the bottom falls and normal flow is supercritical, water enters at normal depth unless a depth
    is given; else the row finds the depth. A developed profile is that of steady flow as deep as this, as
    normal flow, or as the row at its start. Depth and profile count from the dam or the bed of grains where
    one lies.
    """
    end = row.upstream
    if end is None or end.kind is not EndKind.DISCHARGE or end.discharge == 0.0:
        return row
    if not end.developed and (end.profile is not None or not np.isnan(end.depth)):
        return row
    b = row.bottom_with_ends()
    tilt = (b[1] - b[0]) / row.dx  # the bottom falls where it is negative
    along = (row.column.g_x - row.g_z * tilt) / np.hypot(1.0, tilt)
    normal = _normal_depth(row, float(along), end.discharge)
    depth = end.depth
    if np.isnan(depth) and end.discharge > normal * np.sqrt(row.g_z * normal):
        depth = normal * np.hypot(1.0, tilt)  # normal to the x axis
    if not end.developed:
        return replace(row, upstream=replace(end, depth=float(depth)))
    assert row.start is not None
    first = float(row.start[0] - row.bottom[0]) - _dam(row)
    there = next((h for h in (depth, normal, first) if row.column.dz < h < _room(row)), 0.5 * _room(row))
    flow, _ = steady(
        replace(row.column, g_x=0.0, depth=there, drive=Drive.DISCHARGE, discharge=end.discharge)
    )
    profile = np.array(flow.u)
    return replace(row, upstream=replace(end, depth=float(depth), profile=profile, developed=False))


def _normal_depth(row: ColumnRow, along: float, q: float) -> float:
    """Depth of uniform flow by the column itself [m]; nan where there is none in the cells."""
    if not along > 0.0:
        return float("nan")
    column, low, high = replace(row.column, g_x=along), 1.01 * row.column.dz, _room(row)

    def passes(depth: float) -> float:
        flow, _ = steady(replace(column, depth=depth))
        return float(flow.content @ flow.u)

    if not passes(low) < q < passes(high):
        return float("nan")
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if passes(middle) < q else (low, middle)
    return 0.5 * (low + high)


def _dam(row: ColumnRow) -> float:
    """Height over the bottom of the dam over which water enters [m]; 0 without one."""
    return float(row.solid_cells()[0] * row.column.dz)


def _room(row: ColumnRow) -> float:
    """Largest depth that the cells hold at the inlet [m]."""
    return row.column.n * row.column.dz - _dam(row)
