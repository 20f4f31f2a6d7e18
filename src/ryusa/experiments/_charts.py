"""What the four charts of closed forms (fig4, fig8, fig11, fig12) share."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import Band, Curve, over_stiffness
from ryusa.measure.stability import BAND, Chart, Grain, chart
from ryusa.measure.statistics import Floats

PAPER = Grain(d=0.002, rho_s=2650.0, e=0.7, speed=0.6)
SMALL = np.array([0.0005, 0.001, 0.002, 0.005, 0.01])  # diameters of Fig. 4 [m]
LARGE = np.array([0.05, 0.1, 0.2, 0.5, 1.0])  # diameters of Fig. 12 [m]


def around(grain: Grain, sizes: Floats = SMALL, softest: float = math.inf) -> Chart:
    """Chart that holds the sizes, the whole band of all of them, and the stiffness `softest` [N/m]."""
    edges = chart(grain, sizes, np.ones(1)).band_k
    middle = float(np.sqrt(edges.min() * edges.max()))
    half = max(100.0, 3.0 * float(np.sqrt(edges.max() / edges.min())))
    low, high = np.floor(np.log10(min(middle / half, softest))), np.ceil(np.log10(middle * half))
    return chart(grain, sizes, np.logspace(low, high, 81))


def length(value: float) -> str:
    """A diameter in the unit one would say it in."""
    if value < 0.01:
        return f"{1e3 * value:g} mm"
    return f"{1e2 * value:g} cm" if value < 1.0 else f"{value:g} m"


def note(grain: Grain, speed: bool = True) -> str:
    """The line of inputs in the corner of a chart."""
    inside = f"{grain.rho_s:g} kg/m³"
    return f"{inside}, e = {grain.e:g}, impact at {grain.speed:g} m/s" if speed else inside


def times(found: Chart, grain: Grain, band: bool) -> Figure:
    """Eq. (8) over stiffness, with the stable band or without."""
    curves = [Curve(length(d), found.k_n, t) for d, t in zip(found.d, found.time, strict=True)]
    soft, stiff = found.band_k
    t_soft, t_stiff = found.band_time
    words = (f"{BAND[1]:g}", f"{BAND[0]:g}")
    region = Band(words, soft, t_soft, stiff, t_stiff) if band else None
    text = note(grain, band)
    return over_stiffness("time", curves, band=region, note=f"shaded: overlap/d\n{text}" if band else text)


def overlaps(found: Chart, grain: Grain) -> Figure:
    """Largest overlap over stiffness."""
    curves = [Curve(length(d), found.k_n, t) for d, t in zip(found.d, found.overlap, strict=True)]
    return over_stiffness("overlap", curves, levels=BAND, note=note(grain))
