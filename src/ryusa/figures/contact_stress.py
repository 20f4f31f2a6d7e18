"""Stress over height beside the weight above, and mu over the inertial number."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.contact_stress import ContactStress

CM = 100.0  # centimetres in a metre
LEAST = 0.5  # share of the largest concentration; below, mu and I are those of few grains


@style.house
def contact_stress(found: ContactStress) -> Figure:
    """Draw normal and shear stress and the weight above over height, and mu over I where grains are dense."""
    figure, (left, right) = style.new(1, 2, width=1.5 * style.COLUMN, height=3.1)
    z = found.z * CM
    dry = np.isfinite(found.deviation)
    for k, (one, sign, above, label) in enumerate((
        (found.zz, 1.0, found.weight, r"$\sigma_{zz}$"),
        (found.xz, -1.0, found.weight_along, r"$-\sigma_{xz}$"),
    )):  # fmt: skip
        value, colour = sign * one.value, style.COLOURS[k]
        left.fill_betweenx(z, value - one.error, value + one.error, color=colour, alpha=0.22, lw=0.0)
        left.plot(value, z, color=colour, label=label)
        if dry:
            left.plot(above, z, color=colour, ls=":", lw=1.6, label="weight above" + (", along" if k else ""))
    left.axvline(0.0, color=style.FAINT, lw=0.5, zorder=0)
    if np.isfinite(found.crest):
        left.axhline(found.crest * CM, color=style.FAINT, lw=0.7, ls="--", zorder=0, label="crest of the bed")
    left.set_xlabel("stress  (Pa)")
    left.set_ylabel(style.height("cm"))
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    dense = (found.phi.value > LEAST * np.nanmax(found.phi.value)) & ~(found.z <= found.crest)
    right.errorbar(
        found.inertial_number[dense], found.mu.value[dense], found.mu.error[dense], fmt="o",
        ms=3.0, lw=0.7, color=style.COLOURS[0],
    )  # fmt: skip
    right.locator_params(axis="x", nbins=5)
    right.set_xlabel("inertial number  $I$  (–)")
    right.set_ylabel(r"$\mu = |\sigma_{xz}|/p$  (–)")
    return figure
