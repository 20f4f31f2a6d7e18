"""What `ryusa measure` prints in tables of their own: trembling, the surface of a heap, stresses."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from ryusa.measure import HeapSurface, KineticStress, Vibration

DIAMETERS = 1.0e-3  # default threshold, in mean diameters
LINES = 12  # windows printed


def print_vibration(found: "Vibration", threshold: float | None) -> None:
    """Print the share of grains that tremble over time, and when the last one rests; threshold in m."""
    from ryusa.measure import rest_time, trembling_share
    from ryusa.units import format_quantity

    limit = found.diameters(DIAMETERS) if threshold is None else threshold
    given = f"{limit / found.d_mean:.3g} mean diameters" + ("" if threshold else ", --threshold not given")
    table = _table(
        ("window ends [s]", "share that tremble", "largest span in z [µm]", "largest net in z [µm]")
    )
    share = trembling_share(found, limit)
    n = len(found.end)
    for k in sorted({round((j + 1) * n / min(n, LINES)) - 1 for j in range(min(n, LINES))}):
        spans = found.span_z[k].max() * 1e6, abs(found.net[k]).max() * 1e6
        table.add_row(f"{found.end[k]:.4g}", f"{share[k]:.3g}", *(f"{one:.4g}" for one in spans))
    rest = rest_time(found, limit)
    _say(
        table,
        f"a grain trembles where z spans more than {format_quantity(limit, 'um')} ({given}) "
        f"within {found.window:g} s",
        f"{len(found.grains)} grains, {int(found.n_frame.min())} frames in a window",
        f"at rest from t = {rest:.4g} s on" if math.isfinite(rest) else "not at rest by the last window",
    )


def print_stress(found: "KineticStress") -> None:
    """Print granular temperature and the stress of the grains' motion, from the highest layer down."""
    names = ("z/d", "phi", "temperature [m2/s2]", "xx [Pa]", "yy [Pa]", "zz [Pa]", "xz [Pa]")
    table, one = _table(names), found.profiles
    columns = (found.temperature, found.xx, found.yy, found.zz, found.xz)
    for k in reversed(range(len(one.z))):
        if one.phi.value[k] > 0.0:
            cells = (one.z[k] / one.d, one.phi.value[k], *(layers.value[k] for layers in columns))
            table.add_row(*(f"{cell:.3g}" for cell in cells))
    _say(
        table,
        "stress that the motion of grains carries, sigma phi <v'v'>, by height above the bed's crest",
        "errors are in the CSV",
    )


def print_surface(found: "HeapSurface") -> None:
    """Print slope, height and run-out of a heap, angles in degrees."""
    table = _table(("quantity", "value", "unit"))
    table.columns[0].justify = "left"
    low, high = found.fit
    table.add_row(f"slope, {low:g} to {high:g} of the height", _degrees(found.angle), "deg")
    table.add_row("± s.e. of the fit", _degrees(found.error), "deg")
    for name, angle in found.angles.items():
        table.add_row(f"slope, {name}", _degrees(angle), "deg")
    table.add_row("spread over these", _degrees(found.spread), "deg")
    rows = (("crest above the floor", found.crest - found.floor), ("toe at x", found.toe))
    for name, value in (*rows, ("run-out", found.run_out)):
        table.add_row(name, f"{100.0 * value:.4g}", "cm")
    table.add_row("largest speed", f"{found.speed:.3g}", "m/s")
    table.add_row("largest speed of a spinning surface", f"{found.surface_speed:.3g}", "m/s")
    state = "at rest" if found.at_rest else f"{found.moving:.3g} of its grains move"
    _say(
        table,
        f"{found.side} slope at t = {found.t:.4g} s, fitted through {int(found.inside.sum())} bins "
        f"of {len(found.x)}",
        f"{state} (faster than {found.still:.3g} m/s, spin included)",
        f"{len(found.grains)} grains in the heap, {found.away} away from it",
        *(f"warning: {flag}" for flag in found.flags),
    )


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f}" if math.isfinite(angle) else "-"


def _table(names: tuple[str, ...]) -> "Table":
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in names:
        table.add_column(name, justify="left" if name == "unit" else "right")
    return table


def _say(table: "Table", *lines: str) -> None:
    from rich.console import Console

    console = Console()
    console.print(table)
    for line in lines:
        console.print(line, highlight=False, soft_wrap=True)
