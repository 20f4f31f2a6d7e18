"""A quantity over each of the keys that a sweep varies: every run, and the mean of each setting."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ryusa.figures import style

PANELS = 3  # side by side
TICKS = 5  # intervals along an axis of numbers
LONG = 36  # letters of all words of an axis from which they are slanted
ASIDE = 0.12  # of the distance between two words, between groups


@dataclass(frozen=True)
class EffectAxis:
    """What a panel has along its horizontal axis.

    Attributes
    ----------
    label : axis label with its unit.
    words : by place what stands there instead of a number; empty for numbers.
    log : whether the axis is logarithmic.
    legend : what the groups of the panel are; "" without groups.
    """

    label: str
    words: tuple[str, ...] = ()
    log: bool = False
    legend: str = ""


@dataclass(frozen=True)
class EffectPoint:
    """One setting.

    Attributes
    ----------
    x : by panel its place along the horizontal axis, in the unit of its label.
    groups : by panel the group it belongs to, in words; "" without groups.
    runs : the quantity of each run.
    mean, error : its mean with the standard error of that; nan where unknown.
    """

    x: tuple[float, ...]
    groups: tuple[str, ...]
    runs: tuple[float, ...]
    mean: float
    error: float


@style.house
def effects(
    axes: Sequence[EffectAxis], points: Sequence[EffectPoint], label: str, *, joined: bool, error: str
) -> Figure:
    """Draw a quantity over each key that varies, one panel a key.

    Parameters
    ----------
    axes : panels.
    points : settings.
    label : label of the vertical axis, with its unit.
    joined : whether the means of a group are joined by lines, as they are at the levels of a grid.
    error : what the bars are, in words.
    """
    columns = 2 if len(axes) == 4 else min(len(axes), PANELS)
    rows = math.ceil(len(axes) / columns)
    width = style.COLUMN if columns == 1 else style.PAGE
    figure, panels = style.new(rows, columns, width=width, height=2.6 * rows, sharey=True)
    for k, (panel, axis) in enumerate(zip(panels, axes, strict=False)):
        _panel(panel, axis, k, points, joined, error if k == 0 else "")
        if k % columns == 0:
            panel.set_ylabel(label)
    for panel in panels[len(axes) :]:
        panel.set_visible(False)
    return figure


def _panel(
    panel: Axes, axis: EffectAxis, k: int, points: Sequence[EffectPoint], joined: bool, error: str
) -> None:
    groups = list(dict.fromkeys(one.groups[k] for one in points))
    for g, group in enumerate(groups):
        mine = sorted((one for one in points if one.groups[k] == group), key=lambda one: one.x[k])
        aside = ASIDE * (g - 0.5 * (len(groups) - 1)) if axis.words else 0.0
        colour, marker = style.COLOURS[g % len(style.COLOURS)], style.MARKERS[g % len(style.MARKERS)]
        for n, one in enumerate(mine):
            panel.plot(
                [one.x[k] + aside] * len(one.runs), one.runs, "o", color=colour, mfc="none", ms=3.6, mew=0.6,
                zorder=4, label="run" if error and groups == [""] and n == 0 else None,
            )  # fmt: skip
        known = [one for one in mine if math.isfinite(one.mean)]
        single = len({one.x[k] for one in known}) == len(known)
        panel.errorbar(
            [one.x[k] + aside for one in known], [one.mean for one in known],
            yerr=[one.error if math.isfinite(one.error) else 0.0 for one in known], fmt=marker, ms=3.4,
            lw=0.8 if joined and single and not axis.words else 0.0,
            ls=style.LINES[g % len(style.LINES)] if joined and single and not axis.words else "none",
            elinewidth=0.9, capsize=1.8, capthick=0.9, color=colour, label=group or error, zorder=3,
        )  # fmt: skip
    if axis.words:
        slanted = sum(map(len, axis.words)) > LONG
        panel.set_xticks(
            range(len(axis.words)),
            axis.words,
            rotation=20 if slanted else 0,
            ha="right" if slanted else "center",
        )
        panel.set_xlim(-0.5, len(axis.words) - 0.5)
        panel.tick_params(axis="x", which="minor", bottom=False, top=False)
    elif axis.log:
        panel.set_xscale("log")
        style.log_ticks(panel.xaxis)
    else:
        panel.xaxis.set_major_locator(MaxNLocator(TICKS))
    panel.set_xlabel(axis.label)
    if groups != [""]:
        panel.legend(title=axis.legend, title_fontsize=6.5, fontsize=6.5)
    elif error:
        panel.legend(fontsize=6.5)
