"""Our curves together with reference curves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.style import COLOURS, FAINT, LINES, MARKERS, house, log_ticks, new
from ryusa.model.scene import Floats

_FEW = 25  # points of a curve that are shown one by one


@dataclass(frozen=True)
class Axis:
    """One axis of a picture."""

    label: str
    unit: str = "-"
    log: bool = False

    def __str__(self) -> str:
        return f"{self.label}  ({'–' if self.unit == '-' else self.unit})"


@dataclass(frozen=True)
class Curve:
    """One curve; values that are not finite are omitted."""

    name: str
    x: Floats
    y: Floats


@house
def compared(
    x: Axis, y: Axis, ours: Sequence[Curve], references: Sequence[Curve], beside: Sequence[Curve] = ()
) -> Figure:
    """Draw our curves as coloured symbols (many points: lines), references in black, others grey.

    A reference with the name of one of our curves has its colour.
    """
    figure, (axes,) = new(height=2.9)
    colours = {one.name: COLOURS[k % (len(COLOURS) - 1)] for k, one in enumerate(ours)}
    for k, one in enumerate(beside):
        axes.plot(one.x, one.y, color=FAINT, linestyle=LINES[k % len(LINES)], lw=0.8, label=one.name)
    for k, one in enumerate(references):
        colour = colours.get(one.name, COLOURS[-1])
        label = None if one.name in colours else one.name
        if _few(one) and not _few_all(ours):
            marker = MARKERS[k % len(MARKERS)]
            axes.plot(one.x, one.y, marker, color=colour, mfc="none", label=label)
        else:
            axes.plot(one.x, one.y, color=colour, linestyle=LINES[k % len(LINES)], label=label)
    for k, one in enumerate(ours):
        few = _few(one)
        axes.plot(
            one.x, one.y, MARKERS[k % len(MARKERS)] if few else "-", color=colours[one.name],
            ms=3.4 if few else None, label=one.name, zorder=3,
        )  # fmt: skip
    for name, axis in (("x", x), ("y", y)):
        shown = np.concatenate([np.ravel(getattr(one, name)) for one in ours])
        if axis.log and len(shown) and np.all(shown > 0.0):
            axes.set(**{f"{name}scale": "log"})
            low, _ = axes.get_xlim() if name == "x" else axes.get_ylim()
            # a formula that ends at its threshold would stretch the axis without end
            axes.set(**{f"{name}lim": (max(low, float(shown.min()) / 10.0), None)})
            log_ticks(axes.xaxis if name == "x" else axes.yaxis)
    axes.set_xlabel(str(x))
    axes.set_ylabel(str(y))
    axes.legend(fontsize=6.0)
    return figure


def _few(one: Curve) -> bool:
    return len(one.x) <= _FEW


def _few_all(lines: Sequence[Curve]) -> bool:
    return all(_few(one) for one in lines)
