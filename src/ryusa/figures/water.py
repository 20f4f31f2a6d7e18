"""Profiles over height with water: speeds of water and grains, concentration, shear stress."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Layers
from ryusa.measure.water import WaterProfile

CM = 100.0  # centimetres in a metre
STRAY = 0.01  # concentration below which few grains make the mean speed
WATER, GRAINS, SAND = "#0072B2", "#D55E00", "#8c6d3f"


@style.house
def water(found: WaterProfile) -> Figure:
    """Draw speeds, concentration and stress over height, each with a band of one standard error.

    Parameters
    ----------
    found : `measure.water`. A line marks the surface, another the bed; the stress of the clear water,
        extrapolated to the bed, is dashed.
    """
    figure, axes = style.new(1, 3, width=style.PAGE, height=2.9, sharey=True)
    z, faces, top = found.z * CM, found.faces * CM, found.surface * CM
    base = _base(found)
    wet = (found.z < found.surface) & (found.z > base)
    through = (found.faces < found.surface) & (found.faces > base)
    speeds, amount, stress = axes
    _band(speeds, found.u, z, CM, wet, WATER, "water", "-")
    at, thin = found.grains.z * CM, found.grains.phi.value < STRAY
    _band(speeds, found.grains.v_x, at, CM, ~thin, GRAINS, "grains", "--")
    speeds.set_xlabel("speed along the bed  $U, v_x$  (cm/s)")
    _band(amount, found.phi, z, 1.0, z > -np.inf, SAND, "", "-")
    amount.set_xlabel(r"concentration  $\phi$  (–)")
    _band(stress, found.tau, faces, 1.0, through, WATER, "water", "-")
    if np.isfinite(found.tau_bed):
        stress.plot(
            [0.0, found.tau_bed], [top, found.bed * CM], color="#444444", lw=0.9, ls=(0, (4, 2)),
            label=rf"extrapolated, $\tau_b$ = {found.tau_bed:.3g} Pa",
        )  # fmt: skip
        stress.plot([found.tau_bed], [found.bed * CM], "o", ms=3.2, mfc="white", color="#444444")
    stress.set_xlabel(r"shear stress  $\tau$  (Pa)")
    axes[0].set_ylabel(style.height("cm"))
    lowest = float(min(faces[0], top))
    axes[0].set_ylim(lowest, top + 0.06 * (top - lowest))
    flows = np.nanmin(found.u.value[wet]) >= 0.0  # swift below the surface, and without stress at the bottom
    for k, panel in enumerate(axes):
        if panel is amount or (flows and panel is speeds):
            panel.set_xlim(left=0.0)
        panel.axhline(top, color=WATER, lw=0.7, zorder=1)
        if np.isfinite(found.bed):
            panel.axhline(found.bed * CM, color=SAND, lw=0.7, ls=(0, (5, 2)), zorder=1)
            panel.axhspan(lowest, found.bed * CM, color=style.BED, alpha=0.22, lw=0.0, zorder=0)
        panel.annotate(
            f"({'abc'[k]})", (0, 1), (0, 3), xycoords="axes fraction", textcoords="offset points",
            weight="bold",
        )  # fmt: skip
        panel.locator_params(axis="x", nbins=5)
    if np.isfinite(base):
        figure.supxlabel(
            f"Not shown: water below z = {base * CM:.3g} cm, in empty pores among the fixed grains under the "
            "packed bed.", fontsize=6.3,
        )  # fmt: skip
    for panel, columns in ((speeds, 2), (stress, 1)):
        style.legend_above(panel, columns, loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=6.2)
    _name(amount, "surface", top, WATER, -3)
    if np.isfinite(found.bed):
        _name(amount, "bed", found.bed * CM, SAND, 3)
    return figure


def _base(found: WaterProfile) -> float:
    """Height below which the water is not drawn [m]; -inf where it is drawn down to the bottom.

    Under a packed bed, where phi falls below half of its largest value, the water runs in empty pores.
    """
    half = 0.5 * float(np.nanmax(found.phi.value, initial=0.0))
    dense = (
        np.flatnonzero((found.phi.value >= half) & (found.z < found.bed)) if half > 0.0 else np.zeros(0, int)
    )
    return float(found.z[dense[0]]) if len(dense) and dense[0] > 0 else -np.inf


def _band(
    axes: Axes,
    layers: Layers,
    z: np.ndarray,
    scale: float,
    shown: np.ndarray,
    colour: str,
    label: str,
    line: str,
) -> None:
    value, error = layers.value * scale, np.nan_to_num(layers.error) * scale
    value = np.where(shown, value, np.nan)
    axes.fill_betweenx(z, value - error, value + error, color=colour, alpha=0.22, lw=0.0)
    axes.plot(value, z, color=colour, ls=line, label=label or None)


def _name(axes: Axes, text: str, z: float, colour: str, off: float) -> None:
    """Label a level at the right edge."""
    axes.annotate(
        text, (1, z), (-3, off), xycoords=("axes fraction", "data"), textcoords="offset points", ha="right",
        va="bottom" if off > 0.0 else "top", fontsize=6.5, color=colour,
    )  # fmt: skip
