"""Style of all figures: column width, thin frame, colours distinct without colour vision or in grey."""

import io
import math
import re
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from textwrap import fill
from typing import Any, TypeVar, cast

import matplotlib as mpl
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.ticker import (
    LogLocator,
    MaxNLocator,
    NullFormatter,
    ScalarFormatter,
    StrMethodFormatter,
)

from ryusa.figures.fonts import families, signs_watched

Drawing = TypeVar("Drawing", bound=Callable[..., Figure])

COLUMN = 3.46  # one column of a journal page, 88 mm [inch]
PAGE = 7.09  # two columns, 180 mm [inch]
DPI = 300
SCREEN_DPI = 150  # in a notebook

# Okabe & Ito 2008, ordered so that neighbours differ in lightness too
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
LINES = ("-", "--", "-.", ":")
BED = "#b8b2a7"
BAND = "#dfe7d8"
FAINT = "#8a8a8a"
NOTE_SIZE, NOTE_WIDTH = 6.0, 19.0  # of a note below a figure: letters [point], and how many go in an inch
SMALL, LARGE = 0.01, 1.0e5  # largest number at an axis below and from which its label has a power of ten
FINE = 0.005  # step of such numbers below which it has one too, as 0.0025 and 0.0100 would
LETTERS = 15.0  # of a label of an axis that go in an inch
SHORT, SHORTEST = 200.0, 4.0  # ratios of the ends of a logarithmic axis, see `log_ticks`

HOUSE: Any = {
    "font.family": "sans-serif",
    "mathtext.fontset": "dejavusans",
    "font.size": 7.5,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "axes.axisbelow": True,
    "axes.prop_cycle": cycler(color=COLOURS),
    "lines.linewidth": 1.1,
    "lines.markersize": 4.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "svg.fonttype": "none",
    "svg.hashsalt": "ryusa",
    "pdf.fonttype": 42,
}


@contextmanager
def applied() -> Generator[None]:
    """Draw within this block in the common style; what no font has is noted (fonts.py)."""
    with mpl.rc_context(HOUSE | {"font.sans-serif": families()}), signs_watched():
        yield


def house(draw: Drawing) -> Drawing:
    """Decorator of all functions that make a figure: apply the common style."""

    @wraps(draw)
    def styled(*args: Any, **how: Any) -> Any:
        with applied():
            figure = draw(*args, **how)
            for axes in figure.axes:
                for one in (axes, *axes.child_axes):
                    _power_in_label(figure, one.xaxis)
                    _power_in_label(figure, one.yaxis)
            return figure

    return cast(Drawing, styled)


class _ShownFigure(Figure):
    """A figure that a notebook shows by itself, without pyplot."""

    notes: tuple[str, ...] = ()  # what is written below it

    def _repr_png_(self) -> bytes:
        held = io.BytesIO()
        with applied():
            self.savefig(held, format="png", dpi=SCREEN_DPI)
        return held.getvalue()


def new(
    rows: int = 1, columns: int = 1, *, width: float = COLUMN, height: float = 2.6, **how: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure and its axes, row by row.

    Parameters
    ----------
    rows, columns : panels.
    width, height : of the figure [inch].
    how : passed to `Figure.subplots` (sharex, sharey, ...).
    """
    figure = _ShownFigure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False, **how)
    return figure, list(axes.flat)


def over_time(figure: Figure, panels: Sequence[Axes]) -> None:
    """Finish panels over one axis of time: a line at zero, and legends beside them."""
    for one in panels:
        one.axhline(0.0, color=FAINT, lw=0.4, zorder=0)
        one.margins(x=0.0)
        if one.get_legend_handles_labels()[0]:
            one.legend(fontsize=6.0, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    panels[-1].set_xlabel("time  $t$  (s)")
    figure.align_ylabels(panels)


def save(figure: Figure, path: Path | str) -> Path:
    """Write a figure; the format follows from the suffix (.png at 300 dpi, .svg, .pdf)."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    still = {"Date": None} if path.suffix in {".svg"} else None  # the same picture gives the same bytes
    with applied():
        figure.savefig(path, dpi=DPI, metadata=still)
    return path


def save_both(figure: Figure, path: Path) -> Path:
    """Write a figure as SVG and PNG, and return the latter; `path` has no suffix, its name may hold dots."""
    save(figure, path.with_name(f"{path.name}.svg"))
    return save(figure, path.with_name(f"{path.name}.png"))


def height(unit: str, above: str = "datum") -> str:
    """Label of an axis of heights: "height above datum  $z$  (cm)"; `unit` "d" is diameters.

    The datum is z = 0 of the case.
    """
    return f"height above {above}  " + ("$z/d$  (–)" if unit == "d" else f"$z$  ({unit})")


def log_ticks(axis: Axis) -> None:
    """Name plain numbers on a logarithmic axis that spans few decades: 1, 2, 5; even steps on a short one.

    By default such an axis names minor ticks too, and its numbers overlap.
    """
    low, high = axis.get_view_interval()
    if high >= SHORT * low:
        return
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)) if high > SHORTEST * low else MaxNLocator(4))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _power_in_label(figure: Figure, axis: Axis) -> None:
    """Move the power of ten of small or large numbers to the unit: 0.00025 kg is then 2.5 at (10^-4 kg)."""
    label, shown = axis.get_label_text(), axis.get_major_formatter()
    if not label or type(shown) is not ScalarFormatter or not axis.get_offset_text().get_visible():
        return
    at = _numbers(axis)
    largest = max(map(abs, at), default=0.0)
    if SMALL <= largest < 10.0 * FINE:  # how many numbers there are depends on the room they have
        figure.draw_without_rendering()
        at = _numbers(axis)
    fine = len(at) > 1 and largest < 10.0 * FINE and at[1] - at[0] < FINE
    if largest == 0.0 or (SMALL <= largest < LARGE and not fine):
        return
    power = math.floor(math.log10(largest) + 1.0e-9)
    shown.set_powerlimits((power, power))
    axis.get_offset_text().set_visible(False)
    unit = re.search(r"\(([^()]*)\)$", label)
    named = unit[1] if unit and unit[1] != "–" else ""
    axis.set_label_text(
        f"{label[: unit.start()] if unit else label + '  '}($10^{{{power}}}${' ' if named else ''}{named})"
    )


def _numbers(axis: Axis) -> list[float]:
    """Places of the numbers beside an axis, ascending."""
    low, high = sorted(axis.get_view_interval())
    return [float(one) for one in axis.get_majorticklocs() if low <= one <= high]


def legend_above(axes: Axes, columns: int, **how: Any) -> Legend:
    """Set the legend above the panel, from its left edge, where it hides no data."""
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    return axes.legend(**(place | {"ncols": columns} | how))


def side_label(figure: Figure, text: str) -> None:
    """Label the left side of a figure, in two lines where it is too low for one."""
    fits = len(text.replace("$", "")) <= LETTERS * figure.get_figheight()
    figure.supylabel(text if fits else text.replace("above ", "above\n"), fontsize=8.0)


def note(figure: Figure, text: str) -> None:
    """Write a line below a figure, such as what it leaves out; `ryusa draw` prints it as well."""
    said = (*notes(figure), text)
    if isinstance(figure, _ShownFigure):
        figure.notes = said
    wide = int(NOTE_WIDTH * figure.get_size_inches()[0])
    figure.supxlabel("\n".join(fill(one, wide) for one in said), fontsize=NOTE_SIZE, x=0.01, ha="left")


def notes(figure: Figure) -> tuple[str, ...]:
    """What `note` wrote below a figure."""
    return figure.notes if isinstance(figure, _ShownFigure) else ()


def shade(value: float) -> tuple[float, float, float, float]:
    """A colour for an ordered quantity, value from 0 (dark) to 1 (light but still readable on white)."""
    return mpl.colormaps["viridis"](0.85 * value)
