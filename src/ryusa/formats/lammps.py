"""Text dumps as LAMMPS writes them: `dump custom` of spheres, in SI."""

import math

from ryusa.formats.grains import GrainTable

FREE_TYPE, FIXED_TYPE = 1, 2
COLUMNS = "id type x y z ix iy iz vx vy vz omegax omegay omegaz diameter mass"  # names of LAMMPS
_ROW = "%d %d %r %r %r %d %d 0 %r %r %r %r %r %r %r %r"


def dump_frame(table: GrainTable) -> bytes:
    """One frame. Ids are those of the run plus 1, since LAMMPS counts from 1; type 2 is fixed.

    The box is the period where there is one, and encloses the grains elsewhere.
    """
    period = (*(table.period or (math.inf, math.inf)), math.inf)
    radius = table.column("d") / 2.0
    sides, bounds = list[str](), list[str]()
    for axis, length in zip("xyz", period, strict=True):
        x = table.column(axis)
        shut = math.isfinite(length)
        low, high = (0.0, length) if shut else (float((x - radius).min()), float((x + radius).max()))
        sides.append("pp" if shut else "ss")
        bounds.append(f"{low!r} {high!r}")
    head = [
        "ITEM: UNITS", "si", "ITEM: TIME", repr(table.t), "ITEM: TIMESTEP", str(table.step),
        "ITEM: NUMBER OF ATOMS", str(table.n), f"ITEM: BOX BOUNDS {' '.join(sides)}", *bounds,
        f"ITEM: ATOMS {COLUMNS}",
    ]  # fmt: skip
    names = ("x", "y", "z"), ("vx", "vy", "vz", "wx", "wy", "wz", "d", "m")
    rows = zip(
        (table.ids + 1).tolist(),
        [FIXED_TYPE if fixed else FREE_TYPE for fixed in table.fixed.tolist()],
        *(table.column(name).tolist() for name in names[0]),
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in names[1]),
        strict=True,
    )
    return "\n".join([*head, *(_ROW % row for row in rows), ""]).encode("ascii")
