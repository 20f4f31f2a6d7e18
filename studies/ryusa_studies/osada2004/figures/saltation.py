"""Saltation in the form of the paper: over stiffness in N/cm, spin (clockwise negative) over cm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ryusa.figures import style
from ryusa.figures.contact import StiffnessCurve, StiffnessPoints
from ryusa.measure.spin import TURN

Floats = NDArray[np.float64]

QUOTED = "Osada et al. 2004"
_PER_CM = 0.01  # N/m in N/cm
_CM = 100.0  # cm in a metre
_RANGE = (15.0, 2.0e5)  # of stiffness shown [N/m]
_K_N = "normal stiffness  $k_n$  (N/cm)"


@dataclass(frozen=True)
class StiffnessSeries:
    """Values over stiffness.

    Attributes
    ----------
    label : in the legend.
    k_n : [N/m].
    y : in the unit of the panel.
    half : half of the interval [same].
    """

    label: str
    k_n: Floats
    y: Floats
    half: Floats


@dataclass(frozen=True)
class SpinPath:
    """Spin of one grain over distance.

    Attributes
    ----------
    label : in the legend.
    distance : [m].
    omega : spin, positive rolls downstream [rad/s].
    """

    label: str
    distance: Floats
    omega: Floats


@style.house
def contact_times_over_stiffness(
    curves: Sequence[StiffnessCurve], runs: StiffnessPoints, skim: float = 0.0
) -> Figure:
    """Draw mean contact times and closed forms, both axes logarithmic.

    Parameters
    ----------
    curves : closed forms, k_n in N/m.
    runs : measured means with half of their intervals.
    skim : stiffness [N/m] below which the grain skims the crests, shaded; 0 for none.
    """
    figure, (axes,) = style.new(height=2.75)
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = _RANGE
    for k, curve in enumerate(curves):
        axes.plot(curve.k_n * _PER_CM, curve.y, style.LINES[k], color="black", lw=0.9, label=curve.label)
    axes.errorbar(
        runs.k_n * _PER_CM, runs.y, yerr=runs.error, fmt="o", color=style.COLOURS[0], mfc="white", mew=1.0,
        capsize=1.8, elinewidth=0.8, lw=0, label=runs.label,
    )  # fmt: skip
    axes.set_xlim(low * _PER_CM, high * _PER_CM)
    axes.xaxis.set_major_formatter("{x:g}")
    inside = [one.y[(one.k_n >= low) & (one.k_n <= high)] for one in curves]
    axes.set_ylim(0.7 * min(float(y.min()) for y in inside), 1.4 * max(float(y.max()) for y in inside))
    _shade(axes, skim)
    axes.set_xlabel(_K_N)
    axes.set_ylabel("mean contact time  $t$  (s)")
    axes.legend(loc="upper right")
    return figure


@style.house
def over_stiffness_in_cm(
    panels: Mapping[str, Sequence[StiffnessSeries]],
    levels: Sequence[tuple[float, float]] = (),
    skim: float = 0.0,
    one: bool = False,
) -> Figure:
    """Draw values over stiffness, one panel each, with the range that counts as no change.

    Parameters
    ----------
    panels : axis label -> lines.
    levels : range of each panel that is shaded.
    skim : stiffness [N/m] below which the grain skims the crests, shaded; 0 for none.
    one : draw the line y = 1.
    """
    n = len(panels)
    figure, axes = style.new(1, n, width=style.COLUMN if n == 1 else style.PAGE, height=2.5)
    for k, (panel, (label, lines)) in enumerate(zip(axes, panels.items(), strict=True)):
        panel.set_xscale("log")
        if k < len(levels):
            panel.axhspan(*levels[k], color=style.BAND, lw=0)
        if one:
            panel.axhline(1.0, color="black", lw=0.8, ls="--", label="Eq. (8)")
        for s, line in enumerate(lines):
            panel.errorbar(
                line.k_n * _PER_CM, line.y, yerr=line.half, fmt=style.MARKERS[s], color=style.COLOURS[s],
                mfc="white", mew=1.0, capsize=1.8, elinewidth=0.8, lw=0, label=line.label,
            )  # fmt: skip
        panel.set_xlim(_RANGE[0] * _PER_CM, _RANGE[1] * _PER_CM)
        panel.xaxis.set_major_formatter("{x:g}")
        if not one:
            panel.set_ylim(0.0, None)
        _shade(panel, skim)
        panel.set_xlabel(_K_N)
        panel.set_ylabel(label)
    axes[0].legend(loc="lower right")
    return figure


def _shade(axes: Axes, skim: float) -> None:
    """Hatch the stiffnesses below that of the softest run without skimming."""
    low, _ = axes.get_xlim()
    if skim * _PER_CM <= 2.0 * low:
        return
    axes.axvspan(
        low, 0.55 * skim * _PER_CM, facecolor="none", edgecolor="#bbbbbb", hatch="////", lw=0, zorder=0
    )
    how: Any = {
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "fontsize": 6.3,
        "color": "#555555",
    }
    plain = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    # Below the measured values, so that no point is hidden.
    axes.annotate("skims the crests,\n$u t/d > 0.3$", (0, 0), (4, 4), bbox=plain, zorder=1, **how)


@style.house
def spin_over_way(ways: Sequence[SpinPath], quoted: float, until: float) -> Figure:
    """Draw spin over distance as the paper does, clockwise (rolling downstream) negative.

    Parameters
    ----------
    ways : paths, one per grain.
    quoted : magnitude of the spin given by the paper [rad/s].
    until : distance shown [m].
    """
    figure, (axes,) = style.new(height=2.9)
    axes.axhline(-quoted, color="black", lw=1.1, ls="--", zorder=4, label=f"{QUOTED}: {quoted:g} rad/s")
    for k, way in enumerate(ways):
        kept = way.distance <= until
        axes.plot(
            way.distance[kept] * _CM, -way.omega[kept], color=style.COLOURS[k], lw=1.0, label=way.label,
            zorder=3 - 0.1 * k,
        )  # fmt: skip
    axes.axhline(0.0, color=style.FAINT, lw=0.5)
    lowest = min(-quoted, *(float(-one.omega[one.distance <= until].max()) for one in ways))
    axes.set_ylim(1.08 * lowest, -0.03 * lowest)
    axes.set_xlim(0.0, until * _CM)
    axes.set_xlabel("distance along the bed  $x$  (cm)")
    axes.set_ylabel("spin, clockwise negative  $-\\omega_y$  (rad/s)")
    axes.tick_params(right=False, which="both")
    right = axes.secondary_yaxis("right", functions=(_turns, _spin))
    right.set_ylabel("turns per second  (1/s)", fontsize=8.0)
    right.tick_params(labelsize=7.0, width=0.6, size=3.0, direction="in")
    figure.legend(loc="outside upper left", ncols=2, fontsize=6.5)
    return figure


def _turns(omega: Any) -> Any:
    return omega / TURN


def _spin(turns: Any) -> Any:
    return turns * TURN
