"""Mean squared displacement over lag, with the straight lines whose slope gives the diffusivities."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.dispersion import Dispersion
from ryusa.measure.statistics import Average
from ryusa.model.scene import Floats

MM = 1.0e3  # millimetres in a metre
SYMBOLS = {"along": "x", "across": "y", "normal": "z"}


@style.house
def dispersion(found: Dispersion) -> Figure:
    """Draw the mean squared displacement about the mean motion, both axes logarithmic.

    Parameters
    ----------
    found : `measure.dispersion`. Lags of the fit are shaded; there the fitted line, straight on linear axes,
        is dashed.

    Notes
    -----
    Dotted lines from the first lag show how displacements grow in flight, with the square of the lag, and in
    diffusion, with the lag itself.
    """
    figure, (axes,) = style.new(width=4.4, height=3.4)
    axes.set_xscale("log")
    axes.set_yscale("log")
    fitted = (found.lag >= 0.999 * found.fit[0]) & (found.lag <= 1.001 * found.fit[1])
    axes.axvspan(*found.fit, color=style.BAND, lw=0.0, label="lags of the fit", zorder=0.1)
    squares: list[Floats] = []
    for k, one in enumerate(found.averages.items):
        name, colour = one.name.removeprefix("diffusivity_"), style.COLOURS[k]
        square = getattr(found, name) * MM**2
        axes.plot(found.lag, square, color=colour, label=_words(name, one))
        line = square[fitted].mean() + 2.0 * one.value * MM**2 * (found.lag - found.lag[fitted].mean())
        axes.plot(found.lag[fitted], line[fitted], color="black", lw=1.0, ls=(0, (3, 2)), zorder=3)
        squares.append(square)
    _growth(axes, found.lag, squares)
    axes.set_xlim(float(found.lag[0]), float(found.lag[-1]))
    style.log_ticks(axes.xaxis)
    axes.set_xlabel("lag  (s)")
    axes.set_ylabel("mean squared displacement  (mm$^2$)")
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, fontsize=6.3, title_fontsize=6.3,
        title="about the mean motion; dashed: fitted line, its slope is $2D$", alignment="left",
    )  # fmt: skip
    return figure


def _words(name: str, one: Average) -> str:
    """Direction and diffusivity of a curve, with its error and whether the record is steady."""
    factor = 10.0 ** np.floor(np.log10(abs(one.value))) if one.value else 1.0
    power = f"\\times 10^{{{round(np.log10(factor))}}}"
    star = "*" * (one.short and one.error > 0.0)
    error = "–" if np.isnan(one.error) else f"{one.error / factor:.2g}"
    value = rf"${one.value / factor:.3g} \pm {error}{star}$"
    return f"{name} (${SYMBOLS[name]}$): $D$ = ({value}) ${power}$ m$^2$/s, steady: {one.verdict}"


def _growth(axes: Axes, lag: Floats, squares: list[Floats]) -> None:
    """Dotted lines that grow with the lag and with its square from the largest value at the first lag."""
    first = max((one[0] for one in squares), default=0.0)
    low, high = min(one.min() for one in squares), max(one.max() for one in squares)
    if first <= 0.0 or low <= 0.0:
        return
    axes.set_ylim(0.7 * low, 2.0 * high)
    for power in (1.0, 2.0):
        label = (
            "growth with lag, as in diffusion, and with its square, as in flight" if power == 1.0 else None
        )
        axes.plot(lag, first * (lag / lag[0]) ** power, color=style.FAINT, lw=0.8, ls=":", label=label)
