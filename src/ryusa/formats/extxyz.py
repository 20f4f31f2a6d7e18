"""Extended XYZ, which OVITO and ASE open: a line that names the columns, then one line per grain, in SI."""

import math

from ryusa.formats.grains import GrainTable

PROPERTIES = "species:S:1:pos:R:3:id:I:1:fixed:I:1:image:I:3:velo:R:3:omega:R:3:radius:R:1:mass:R:1"
SPECIES = "X"  # neither program knows gravel; X is what ASE calls an unknown element
_ROW = SPECIES + " %r %r %r %d %d %d %d 0 %r %r %r %r %r %r %r %r"


def xyz_frame(table: GrainTable) -> bytes:
    """One frame; the box encloses the grains where there is no period."""
    period = (*(table.period or (math.inf, math.inf)), math.inf)
    radius = table.column("d") / 2.0
    shut = [math.isfinite(length) for length in period]
    low = [
        0.0 if periodic else float((table.column(axis) - radius).min())
        for axis, periodic in zip("xyz", shut, strict=True)
    ]
    sides = [
        length if periodic else float((table.column(axis) + radius).max()) - begin
        for axis, periodic, length, begin in zip("xyz", shut, period, low, strict=True)
    ]
    a, b, c = sides
    about = [
        f'Lattice="{a!r} 0.0 0.0 0.0 {b!r} 0.0 0.0 0.0 {c!r}"',
        f'Origin="{" ".join(map(repr, low))}"',
        f"Properties={PROPERTIES}",
        f'pbc="{" ".join("T" if periodic else "F" for periodic in shut)}"',
        f"Time={table.t!r}",
        f"Step={table.step}",
        'units="SI: m s kg rad"',
    ]
    rows = zip(
        *(table.column(name).tolist() for name in ("x", "y", "z")),
        table.ids.tolist(),
        table.fixed.tolist(),
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in ("vx", "vy", "vz", "wx", "wy", "wz")),
        radius.tolist(),
        table.column("m").tolist(),
        strict=True,
    )
    return "\n".join([str(table.n), " ".join(about), *(_ROW % row for row in rows), ""]).encode("ascii")
