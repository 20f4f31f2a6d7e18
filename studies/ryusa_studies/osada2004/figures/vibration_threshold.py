"""Share of grains that vibrate, over the threshold of their displacement."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ryusa.figures import style

Floats = NDArray[np.float64]


@style.house
def over_threshold(
    moved: Mapping[str, Mapping[str, Floats]], level: tuple[float, float], words: str, note: str = ""
) -> Figure:
    """Draw the share of grains that moved by more than a threshold, one colour per group of curves.

    Parameters
    ----------
    moved : name of a group -> name of a curve -> displacement of each grain in the window [mean diameters].
    level : range of shares that corresponds to the statement of the paper, shaded.
    words : label of the shaded range.
    note : a line of text above.
    """
    figure, (axes,) = style.new(height=2.9)
    axes.axhspan(*level, color=style.BAND, lw=0)
    for k, (group, curves) in enumerate(moved.items()):
        for s, (name, values) in enumerate(curves.items()):
            order = np.sort(np.maximum(values, 1.0e-12))
            x = np.concatenate([[1.0e-12], order])
            share = 1.0 - np.arange(len(x)) / len(values)
            axes.step(
                x, share, where="post", color=style.COLOURS[k % 7], ls=style.LINES[s % 4],
                label=f"{group}, {name}",
            )  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(1.0e-7, 1.0)
    axes.set_ylim(-0.02, 1.05)
    axes.annotate(words, (1, level[1]), (-3, -3), axes.get_yaxis_transform(), "offset points", ha="right",
                  va="top", fontsize=6.5, color="#4c6340")  # fmt: skip
    axes.set_xlabel("threshold of the displacement in a window, over mean $d$  (–)")
    axes.set_ylabel("share of grains beyond it  (–)")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2, fontsize=6.0,
                  title=note or None, title_fontsize=6.5)  # fmt: skip
    return figure
