"""Concentration and speed over height, runs side by side: the form of the paper's fig14, fig15 and fig17."""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Layers, Profiles

CM = 100.0  # centimetres in a metre
LEAST = 0.01  # share of the largest concentration; below, the mean speed is that of few grains

Height = Literal["cm", "d"]
Shown = Literal["phi", "area_fraction", "v_x", "v_z", "spin", "temperature_x", "temperature_z", "flux"]
LABELS: dict[str, tuple[float, str]] = {
    "phi": (1.0, r"concentration  $\phi$  (–)"),
    "area_fraction": (1.0, "area fraction  (–)"),
    "v_x": (CM, "grain speed  $v_x$  (cm/s)"),
    "v_z": (CM, "grain speed  $v_z$  (cm/s)"),
    "spin": (1.0, r"spin  $\omega_y$  (rad/s)"),
    "temperature_x": (CM**2, r"variance of $v_x$  (cm$^2$/s$^2$)"),
    "temperature_z": (CM**2, r"variance of $v_z$  (cm$^2$/s$^2$)"),
    "flux": (CM, r"flux  $\phi\, v_x$  (cm/s)"),
}


@style.house
def profiles(
    found: Mapping[str, Profiles],
    shown: tuple[Shown, ...] = ("phi", "v_x"),
    height: Height = "cm",
    area: bool = False,
) -> Figure:
    """Draw quantities over height with bands of one standard error; one colour and line per run.

    Parameters
    ----------
    found : name of the run -> its profiles (`measure.profiles`).
    shown : quantities, one panel each.
    height : unit of z, centimetres or mean diameters of each run.
    area : draw the area fraction of plane scenes over the concentration, as a thin line.
    """
    figure, axes = style.new(
        1, len(shown), width=min(style.PAGE, 0.3 + 1.75 * len(shown) + 1.1), height=2.7, sharey=True
    )
    for k, (panel, what) in enumerate(zip(axes, shown, strict=True)):
        for s, (name, one) in enumerate(found.items()):
            z = one.z / one.d if height == "d" else one.z * CM
            _line(panel, one, getattr(one, what), z, s, name)
            if what == "phi" and area:
                colour = style.COLOURS[s % len(style.COLOURS)]
                panel.plot(one.area_fraction.value, z, color=colour, lw=0.6, ls=":")
        panel.set_xlabel(LABELS[what][1] + ("\ndotted: area fraction" if what == "phi" and area else ""))
        panel.axhline(0.0, color=style.FAINT, lw=0.5, zorder=0)
        values = np.concatenate([getattr(one, what).value for one in found.values()])
        if np.nanmin(values) >= 0.0 or panel.get_xlim()[0] > 0.0:
            panel.set_xlim(left=0.0)
        panel.locator_params(axis="x", nbins=5)
        if what == "phi":
            first = next(iter(found.values()))
            _bed(panel, first, 1.0 / first.d if height == "d" else CM)
        if len(shown) > 1:
            _letter(panel, f"({'abcdefgh'[k]})")
    axes[0].set_ylabel(style.height(height, next(iter(found.values())).above))
    tops = [one.top(0.999) / one.d if height == "d" else one.top(0.999) * CM for one in found.values()]
    feet = [_foot(one) / one.d if height == "d" else _foot(one) * CM for one in found.values()]
    axes[0].set_ylim(min(*feet, 0.0), 1.12 * max(tops))
    if len(found) > 1:
        handles, labels = axes[-1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _line(axes: Axes, one: Profiles, layers: Layers, z: np.ndarray, s: int, name: str) -> None:
    scale = LABELS[layers.name][0]
    thin = one.phi.value < LEAST * np.nanmax(one.phi.value)
    by_volume = layers.name in {"phi", "area_fraction", "flux"}
    value = layers.value if by_volume else np.where(thin, np.nan, layers.value)
    colour, line = style.COLOURS[s % len(style.COLOURS)], style.LINES[s % len(style.LINES)]
    low, high = (value - layers.error) * scale, (value + layers.error) * scale
    axes.fill_betweenx(z, low, high, color=colour, alpha=0.22, lw=0.0)
    axes.plot(value * scale, z, color=colour, ls=line, label=name)


def _bed(axes: Axes, one: Profiles, scale: float) -> None:
    """Shade the concentration of the fixed grains, if it was measured; all runs have the same bed.

    The axis stays that of the moving grains, which may be few: the bed then ends at its right edge.
    """
    if np.nan_to_num(one.bed).any():
        right = axes.get_xlim()[1]
        edges = np.append(one.z - 0.5 * one.thickness, one.z[-1] + 0.5 * one.thickness) * scale
        axes.stairs(one.bed, edges, orientation="horizontal", fill=True, color=style.BED, alpha=0.6, zorder=0)
        axes.set_xlim(right=right)
        axes.annotate("shaded: fixed grains", (1, 0), (-3, 4), "axes fraction", textcoords="offset points",
                      ha="right", fontsize=6.0, color="#444444")  # fmt: skip


def _foot(one: Profiles) -> float:
    """Lower edge of the lowest layer with grains or bed in it [m]."""
    there = (one.phi.value > 0.0) | (np.nan_to_num(one.bed) > 0.0)
    return float(one.z[there][0]) - 0.5 * one.thickness if there.any() else 0.0


def _letter(axes: Axes, text: str) -> None:
    """Write the letter of a panel into its upper right corner, which is empty in a profile."""
    axes.annotate(
        text, (1, 1), xytext=(-5, -4), xycoords="axes fraction", textcoords="offset points", va="top",
        ha="right", weight="bold",
    )  # fmt: skip
