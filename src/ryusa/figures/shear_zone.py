"""Shear zone over a split bottom: angular velocity over the radius, and the zone over height."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.laws.dense_flow import split_bottom_centre
from ryusa.measure.shear_zone import ShearZone, zone

CM = 100.0  # centimetres in a metre


@style.house
def shear_zone(found: ShearZone) -> Figure:
    """Draw the angular velocity with its fit, and centre and width of the zone over height."""
    figure, (left, right) = style.new(1, 2, width=1.6 * style.COLUMN, height=2.8)
    r, value = found.r * CM, found.turning.value
    left.errorbar(r, value, yerr=found.turning.error, fmt="o", ms=2.8, lw=0.7, color=style.COLOURS[0])
    fine = np.linspace(0.0, float(found.r[-1]), 200)
    curve = zone(fine, found.centre, found.width, found.share)
    left.plot(fine * CM, curve, color="black", label="error function")
    left.axvline(found.r_s * CM, color=style.FAINT, ls=":", lw=0.8, label="rim of the disc")
    left.set_ylim(-0.05, 1.05)
    left.set_xlabel("distance from the axis  (cm)")
    left.set_ylabel("angular velocity over that of the disc  (–)")
    style.legend_above(left, 1, fontsize=6.0)
    z = found.z * CM
    right.errorbar(
        found.centres * CM, z, xerr=found.widths * CM, fmt="s", ms=3.0, lw=0.8, color=style.COLOURS[1],
        label="in the grains",
    )  # fmt: skip
    right.errorbar(
        [found.centre * CM], [found.height * CM], xerr=[found.width * CM], fmt="o", ms=3.5, lw=0.8,
        color=style.COLOURS[0], label="surface",
    )  # fmt: skip
    right.plot(
        [split_bottom_centre(found.r_s, found.height) * CM], [found.height * CM], "k*", ms=6.0,
        label="5/2 power law (not verified)",
    )  # fmt: skip
    right.axvline(found.r_s * CM, color=style.FAINT, ls=":", lw=0.8)
    right.set_ylim(0.0, 1.15 * found.height * CM)
    right.set_xlim(0.0, float(r[-1]))
    right.set_xlabel("centre of the zone, bars: width  (cm)")
    right.set_ylabel("height above the disc  (cm)")
    style.legend_above(right, 2, fontsize=6.0)
    return figure
