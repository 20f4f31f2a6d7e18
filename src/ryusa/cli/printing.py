"""What `ryusa measure` prints: averages with their errors, or a table of the rows that --csv writes."""

import math
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from ryusa.errors import ResultsError
from ryusa.measure.energy import TERMS
from ryusa.measure.table import ROUND_OFF
from ryusa.measure.water_energy import WATER_TERMS

if TYPE_CHECKING:
    from ryusa.measure import (
        Averages,
        Energy,
        HeapSurface,
        KineticStress,
        LongSection,
        Saltation,
        Sizes,
        Tracks,
        Vibration,
        WaterEnergy,
    )
    from ryusa.results import Results

DIAMETERS = 1.0e-3  # default threshold, in mean diameters
WIDTH = 120  # columns where the output is no terminal
DENSE, FAST = 0.3, 10.0  # concentration of a discharge as dense as a bed, and a Froude number of no such flow
LINES = 12  # windows printed, and rows of a table that has no form of its own


def print_found(name: str, found: Any, results: "Results", **printing: Any) -> None:
    """Print what a measure found: in a form of its own, as averages, or as the first rows of its table."""
    if name == "saltation":
        _need_hops(found, results)
    if name in _OWN_FORM:
        _OWN_FORM[name](found, **printing)
    elif hasattr(found, "averages"):
        print_averages(found.averages)
    else:
        _print_rows(found.rows())


def _need_hops(found: "Saltation", results: "Results") -> None:
    if not len(found.hops):
        since = found.averages.items[0].window[0]
        raise ResultsError(f"{results.folder}: does not hold hops over fixed grains after t = {since:g} s")


def print_averages(averages: "Averages") -> None:
    """Print each average with standard error, number of samples, window and steadiness; then the notes."""
    names = ("quantity", "value", "± s.e.", "unit", "n", "window \\[s]", "steady?")
    table = _table(names, left=("quantity", "unit", "steady?"))
    for one in averages.items:
        if one.n == 0:
            table.add_row(one.name, "-", "-", one.unit, "0", "-", "-")
            continue
        window = f"{one.window[0]:.3g} .. {one.window[1]:.4g}"
        table.add_row(one.name, f"{one.value:.5g}", one.error_text, one.unit, str(one.n), window, one.verdict)
    _show(table, *averages.remarks)


def _print_rows(rows: list[dict[str, object]]) -> None:
    """Print the first rows of a table; numbers by four digits."""
    table = _table(tuple(rows[0]) if rows else ("no rows",))
    for row in rows[:LINES]:
        table.add_row(*(f"{value:.4g}" if isinstance(value, float) else str(value) for value in row.values()))
    more = (f"the first {LINES} of {len(rows)} rows; --csv FILE writes all",) * (len(rows) > LINES)
    _show(table, *more)


def _print_tracks(found: "Tracks") -> None:
    print(f"{len(found.t)} frames of {len(found.grains)} grains; --csv FILE writes them")


def _print_energy(found: "Energy") -> None:
    """Print every term of the account at the end of the run, by its name and by its column in the CSV."""
    held = ("held", "held", found.held)
    _print_account(found, held, TERMS, "J", "held - start - supplied + lost", "docs/glossary.md")


def _print_water_energy(found: "WaterEnergy") -> None:
    """Print every term of the account of the water in a row, as `_print_energy`."""
    changed = ("change", "changed", found.changed)
    _print_account(found, changed, WATER_TERMS, "J/m", "changes - supplied + lost", "docs/along-a-row.md")


def _print_account(
    found: "Energy | WaterEnergy", first: tuple[str, str, Mapping[str, Any]], words: Mapping[str, str],
    unit: str, rest: str, where: str,
) -> None:  # fmt: skip
    """Print an account: `first` is what it holds (group, key of the column, terms), `rest` what must be 0."""
    table = _table(("term at the end of the run", f"energy [{unit}]", "column of the CSV"))
    table.columns[0].justify = table.columns[2].justify = "left"
    per = unit.replace("/", "_")
    for group, key, terms in (first, ("lost", "lost", found.lost), ("supplied", "given", found.given)):
        for name, values in terms.items():
            value = f"{values[-1]:.6g}" if len(values) else "-"
            table.add_row(f"{group}: {words[name]}", value, f"{key}_{name}_{per}")
    last = f"{found.imbalance[-1]:.3g}" if len(found.imbalance) else "-"
    table.add_row(f"imbalance: {rest}", last, f"imbalance_{per}")
    _show(
        table,
        f"largest imbalance over largest term: {found.residual:.2g}",
        f"{where} explains the terms",
    )


def _print_vibration(found: "Vibration", threshold: float | None = None) -> None:
    """Print the share of grains that vibrate over time, and when the last one rests; threshold in m."""
    from ryusa.measure import rest_time, vibrating_share
    from ryusa.units import format_quantity

    limit = found.diameters(DIAMETERS) if threshold is None else threshold
    given = f"{limit / found.d_mean:.3g} mean diameters" + ("" if threshold else ", the default")
    table = _table(
        ("end of window [s]", "share that vibrates", "largest range of z [µm]", "largest change of z [µm]")
    )
    share = vibrating_share(found, limit)
    n = len(found.end)
    for k in sorted({round((j + 1) * n / min(n, LINES)) - 1 for j in range(min(n, LINES))}):
        spans = found.span_z[k].max() * 1e6, abs(found.net[k]).max() * 1e6
        table.add_row(f"{found.end[k]:.4g}", f"{share[k]:.3g}", *(f"{one:.4g}" for one in spans))
    rest = rest_time(found, limit)
    _show(
        table,
        f"a grain vibrates if its height varies by more than {format_quantity(limit, 'um')} ({given}) "
        f"within {found.window:g} s",
        f"{len(found.grains)} grains, at least {int(found.n_frame.min())} frames in a window",
        f"at rest from t = {rest:.4g} s on" if math.isfinite(rest) else "not at rest in the last window",
    )


def _print_stress(found: "KineticStress") -> None:
    """Print granular temperature and the stress of the grains' motion, from the highest layer down."""
    names = ("z/d", "phi", "temperature [m2/s2]", "xx [Pa]", "yy [Pa]", "zz [Pa]", "xz [Pa]")
    table, one = _table(names), found.profiles
    columns = (found.temperature, found.xx, found.yy, found.zz, found.xz)
    for k in reversed(range(len(one.z))):
        if one.phi.value[k] > 0.0:
            cells = (one.z[k] / one.d, one.phi.value[k], *(layers.value[k] for layers in columns))
            table.add_row(*(f"{cell:.3g}" for cell in cells))
    _show(
        table,
        "kinetic stress rho_s phi <v'v'>, over height above datum, z = 0 of the case",
        "the CSV has the standard errors",
    )


def _print_surface(found: "HeapSurface") -> None:
    """Print slope, height and run-out of a heap, angles in degrees."""
    table = _table(("quantity", "value", "unit"), left=("quantity", "unit"))
    for name, value, unit in found.quantities():
        shown = f"{value:.1f}" if unit == "deg" else f"{value:.4g}"
        table.add_row(name, shown if math.isfinite(value) else "-", unit)
    state = (
        "at rest: no grain exceeds"
        if found.at_rest
        else f"in motion: {found.moving:.3g} of the grains exceed"
    )
    _show(
        table,
        f"{found.side} slope at t = {found.t:.4g} s, fitted to {int(found.inside.sum())} of {len(found.x)} "
        "bins",
        f"{state} {found.still:.3g} m/s (speed plus |omega| d/2)",
        f"{len(found.grains)} grains in the heap, {found.away} away from it",
        *(f"warning: {flag}" for flag in found.flags),
    )


def _print_sizes(found: "Sizes") -> None:
    """Print diameters and sorting laid and asked for, then grains and mass by class."""
    table = _table(("quantity", "laid", "asked", "unit"), left=("quantity", "unit"))
    for name, unit, laid, asked in found.pairs():
        scale, shown = (1.0e3, "mm") if unit == "m" else (1.0, unit)
        cells = ("-" if math.isnan(one) else f"{one * scale:.5g}" for one in (laid, asked))
        table.add_row(name.replace("_", " "), *cells, shown)
    classes = _table(("class [mm]", "grains", "mass [kg]", "laid [%]", "asked [%]"), left=())
    for row in found.series():
        low, high, grains, mass, laid, asked, *_ = (float(str(one)) for one in row.values())
        shares = ("-" if math.isnan(one) else f"{100.0 * one:.4g}" for one in (laid, asked))
        limits = f"{1.0e3 * low:.4g} .. {1.0e3 * high:.4g}"
        classes.add_row(limits, f"{grains:,.0f}", f"{mass:.4g}", *shares)
    _show(table)
    _show(classes, "--csv FILE writes the first table, --series FILE the second")


def _print_long_section(found: "LongSection") -> None:
    """Print a row with grains in few columns; one without has few."""
    if not found.grains:
        _print_rows(found.rows())
        return
    heads = {
        "x": "x [m]", "bed": "bed [m]", "surface": "surface [m]", "depth": "depth [m]",
        "speed": "speed [m/s]", "froude": "Froude", "discharge": "q_w [m2/s]",
        "solid_discharge": "q_s [m2/s]",
        "transport_concentration": "q_s/q", "concentration": "c",
    }  # fmt: skip
    table, many = _table(tuple(one.replace("[", "\\[") for one in heads.values())), len(found.x)
    least = {name: ROUND_OFF * float(np.nanmax(np.abs(getattr(found, name)), initial=0.0)) for name in heads}
    for k in range(min(many, LINES)):
        values = {name: float(getattr(found, name)[k]) for name in heads}
        table.add_row(*(f"{0.0 if abs(one) < least[name] else one:.4g}" for name, one in values.items()))
    more = (f"the first {LINES} of {many} segments",) * (many > LINES)
    errors = ", with standard errors" if found.error else ""
    _show(
        table, *more, f"--csv FILE writes all segments and columns{errors}",
        "q_s: volume of grains per width and time; q = q_s + q_w; c: concentration between bed and surface",
        *_of_flowing_bed(found),
    )  # fmt: skip


def _of_flowing_bed(found: "LongSection") -> list[str]:
    """Where what flows is so dense that the rule for a packed bed takes it for the bed."""
    carried, froude = np.nan_to_num(found.transport_concentration), np.nan_to_num(found.froude)
    flows = (carried > DENSE) & (froude > FAST)
    if not flows.any():
        return []
    return [
        f"in {flows.sum()} of {len(flows)} segments most grains flow below the line of the bed, as dense as "
        "a bed: speed, Froude number and energy there are those of the thin layer above it. --bed rest ends "
        "the bed where grains rest, as a debris flow needs it"
    ]


def _table(names: tuple[str, ...], left: tuple[str, ...] = ("unit",)) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in names:
        table.add_column(name, justify="left" if name in left else "right")
    return table


def _show(table: Table, *lines: str) -> None:
    console = Console(width=None if sys.stdout.isatty() else WIDTH)
    console.print(table)
    for line in lines:
        console.print(line, highlight=False, soft_wrap=True)


_OWN_FORM: dict[str, Callable[..., None]] = {
    "energy": _print_energy,
    "long_section": _print_long_section,
    "sizes": _print_sizes,
    "stress": _print_stress,
    "surface": _print_surface,
    "tracks": _print_tracks,
    "vibration": _print_vibration,
    "water_energy": _print_water_energy,
}
