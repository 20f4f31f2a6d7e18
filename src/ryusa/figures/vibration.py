"""Grains that do not come to rest, in the form of the paper's fig10."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter

from ryusa.figures import style
from ryusa.measure import Vibration, vibrating_share

CM = 100.0  # centimetres in a metre
FEW = 100  # windows up to which each has a marker
THRESHOLDS = (1.0e-4, 1.0e-3, 1.0e-2)  # mean diameters


@style.house
def vibration(
    found: Vibration, grains: Sequence[int], thresholds: Sequence[float] = THRESHOLDS, title: str = ""
) -> Figure:
    """Draw the displacement in z per window of some grains, and the share of all grains that vibrate.

    Parameters
    ----------
    found : `measure.vibration`.
    grains : ids of the marked grains.
    thresholds : a grain vibrates if the range of z within a window is larger, in mean diameters.
    title : written above.

    Notes
    -----
    The displacement covers decades, so its axis is linear up to 0.001 mean diameters (the shaded band) and
    logarithmic beyond.
    """
    figure, (above, below) = style.new(2, height=4.0, sharex=True)
    edge = found.diameters(1.0e-3) * CM
    above.axhspan(-edge, edge, color=style.BAND, lw=0)
    above.annotate(
        "±0.001 $d$", (1, edge), (-3, 2), xycoords=("axes fraction", "data"), textcoords="offset points",
        ha="right", fontsize=6.0, color=style.FAINT, zorder=4,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
    )  # fmt: skip
    few = len(found.end) <= FEW
    for k, grain in enumerate(grains):
        column = int(np.flatnonzero(found.grains == grain)[0])
        above.plot(
            found.end, found.net[:, column] * CM, style.MARKERS[k % 7] * few + "-", ms=2.2, lw=0.8,
            mfc="white", mew=0.7, color=style.COLOURS[k % 7], label=f"grain {grain}",
        )  # fmt: skip
    above.set_yscale("symlog", linthresh=edge, linscale=0.8)
    low, high = above.get_ylim()
    above.yaxis.set_major_locator(FixedLocator(_decades(edge, low, high)))
    above.yaxis.set_major_formatter(FuncFormatter(_power))
    above.set_ylabel(f"rise in {found.window:g} s  (cm)")
    above.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncols=4, title=title or None,
        title_fontsize=7.0, alignment="left",
    )  # fmt: skip
    for k, threshold in enumerate(thresholds):
        share = vibrating_share(found, found.diameters(threshold))
        size = found.diameters(threshold) * 1.0e6
        below.step(
            np.append(found.begin, found.end[-1]), np.append(share, share[-1]), where="post",
            color=style.COLOURS[k % 7], ls=style.LINES[k % 4], lw=1.0,
            label=f"{threshold:g} $d$ ({size:.3g} µm)",
        )  # fmt: skip
    below.axhline(0.5, color=style.FAINT, lw=0.4, ls=":")
    below.set_ylim(-0.02, 1.05)
    below.set_ylabel("share that vibrates  (–)")
    below.set_xlabel("time  $t$  (s)")
    below.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncols=3, fontsize=5.8,
        title=f"range of $z$ in {found.window:g} s larger than", title_fontsize=6.5, alignment="left",
        columnspacing=0.7, handlelength=1.4, handletextpad=0.4,
    )  # fmt: skip
    below.set_xlim(float(found.begin[0]), float(found.end[-1]))
    return figure


def _decades(edge: float, low: float, high: float) -> list[float]:
    """Zero, and powers of ten beyond the linear part of the axis, of both signs."""
    powers = 10.0 ** np.arange(np.ceil(np.log10(1.2 * edge)), np.log10(max(high, -low, 10.0 * edge)) + 1.0)
    return [float(one) for one in (*-powers[::-1], 0.0, *powers) if low <= one <= high]


def _power(value: float, _place: int) -> str:
    if value == 0.0:
        return "0"
    exponent = round(float(np.log10(abs(value))))
    return f"${'-' if value < 0 else ''}10^{{{exponent}}}$"
