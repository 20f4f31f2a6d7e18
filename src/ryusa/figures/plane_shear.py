"""Plane shear: profiles between base and lid, and friction over the inertial number."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.laws.dense_flow import mu_of_inertial_number
from ryusa.measure.plane_shear import PlaneShear

CM = 100.0  # centimetres in a metre
GLASS_BEADS = (math.tan(math.radians(20.9)), math.tan(math.radians(32.76)), 0.279)  # Jop et al. 2006
RANGE = (2e-3, 0.6)  # of inertial numbers drawn


@style.house
def plane_shear(found: PlaneShear) -> Figure:
    """Draw velocity with the line fitted to it, concentration, and mu at I beside the law of glass beads."""
    figure, (left, middle, right) = style.new(
        1, 3, width=style.PAGE, height=2.4, gridspec_kw={"width_ratios": (1.0, 0.8, 1.3)}
    )
    z, core = found.z * CM, np.array(found.core)
    there = found.phi.value > 0.0
    left.errorbar(
        found.v_x.value[there], z[there], xerr=found.v_x.error[there], fmt="o", ms=2.5, lw=0.7,
        color=style.COLOURS[0],
    )  # fmt: skip
    left.plot(found.at_datum + found.shear_rate * core, core * CM, color="black", label="line, middle 60 %")
    left.axvline(found.speed, color=style.FAINT, ls="--", lw=0.8, label="lid")
    left.set_xlabel("velocity  (m/s)")
    left.set_ylabel(style.height("cm"))
    left.legend(fontsize=6.0, loc="upper left")
    middle.plot(found.phi.value[there], z[there], "o-", ms=2.5, lw=0.7, color=style.COLOURS[2])
    middle.set_xlim(left=0.0)
    middle.set_xlabel(r"concentration  $\phi$  (–)")
    drawn = np.geomspace(min(RANGE[0], 0.5 * found.inertial), max(RANGE[1], 2.0 * found.inertial), 200)
    law = [mu_of_inertial_number(float(one), *GLASS_BEADS) for one in drawn]
    right.plot(drawn, law, color="black", label="glass beads, Jop et al. 2006")
    right.errorbar(
        [found.inertial], [found.mu], xerr=[found["inertial_number"].error], yerr=[found["mu"].error],
        fmt="o", ms=4.0, color=style.COLOURS[1], label="this run",
    )  # fmt: skip
    right.set_xscale("log")
    right.set_ylim(0.0, max(0.7, 1.1 * found.mu))
    right.set_xlabel("inertial number  $I$  (–)")
    right.set_ylabel(r"friction  $\mu$  (–)")
    right.legend(fontsize=6.0, loc="lower right")
    return figure
