"""A measure over stiffness: runs, the bracket of their extrapolation, and the tolerance."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.model.scene import Floats


@dataclass(frozen=True)
class StiffnessRun:
    """Runs at one stiffness.

    Attributes
    ----------
    k_n : stiffness [N/m].
    values : the measure, one number per seed.
    mean, half : its mean, and half of the 95 % interval of that.
    """

    k_n: float
    values: Sequence[float]
    mean: float
    half: float


@style.house
def softening(
    runs: Sequence[StiffnessRun],
    bracket: tuple[Floats, Floats, Floats] | None,
    reference: tuple[float, float, float] | None,
    case: float,
    label: str,
) -> Figure:
    """Draw a measure over the stiffness it was run with.

    Parameters
    ----------
    runs : what was run.
    bracket : stiffnesses [N/m], and the lower and the upper end of the extrapolation there; None without one.
    reference : the number that errors refer to, and the ends of the tolerance about it; None without one.
    case : stiffness of the case [N/m].
    label : axis label of the measure.
    """
    figure, (axes,) = style.new()
    if bracket is not None:
        k, low, high = bracket
        axes.fill_between(k, low, high, color=style.COLOURS[4], alpha=0.35, lw=0, label="95 % bracket")
    if reference is not None:
        middle, low, high = reference
        axes.axhspan(low, high, color=style.BAND, lw=0, zorder=0, label="tolerance")
        axes.axhline(middle, color=style.FAINT, lw=0.7, ls="--", zorder=1)
    for one in runs:
        axes.plot([one.k_n] * len(one.values), one.values, ".", color=style.FAINT, ms=3.0, zorder=3)
    axes.errorbar(
        [one.k_n for one in runs], [one.mean for one in runs], yerr=[one.half for one in runs], fmt="o",
        ms=3.4, lw=0, elinewidth=0.9, color=style.COLOURS[0], label="mean of the seeds, 95 %", zorder=4,
    )  # fmt: skip
    axes.axvline(case, color=style.FAINT, lw=0.7, ls=":", label="stiffness of the case")
    axes.set_xscale("log")
    axes.set_xlabel("normal stiffness  $k_n$  (N/m)")
    axes.set_ylabel(label)
    shown = [value for one in runs for value in one.values]
    if reference is not None:
        shown += list(reference)
    room = 0.6 * (max(shown) - min(shown)) or 1.0
    axes.set_ylim(min(shown) - room, max(shown) + room)
    axes.legend(fontsize=6.0)
    return figure
