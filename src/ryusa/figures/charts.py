"""Charts of the closed forms for grains: contact time, overlap and the stable band over stiffness."""

from matplotlib.figure import Figure

from ryusa.figures.contact import StiffnessBand, StiffnessCurve, over_stiffness
from ryusa.measure.stability import BAND, Chart, Grain


def times(found: Chart, grain: Grain, band: bool) -> Figure:
    """Eq. (8) over stiffness, with the stable band or without."""
    curves = [StiffnessCurve(_length(d), found.k_n, t) for d, t in zip(found.d, found.time, strict=True)]
    soft, stiff = found.band_k
    t_soft, t_stiff = found.band_time
    words = (f"{BAND[1]:g}", f"{BAND[0]:g}")
    region = StiffnessBand(words, soft, t_soft, stiff, t_stiff) if band else None
    text = _note(grain, band)
    return over_stiffness("time", curves, band=region, note=f"shaded: overlap/d\n{text}" if band else text)


def overlaps(found: Chart, grain: Grain) -> Figure:
    """Largest overlap over stiffness."""
    curves = [StiffnessCurve(_length(d), found.k_n, t) for d, t in zip(found.d, found.overlap, strict=True)]
    return over_stiffness("overlap", curves, levels=BAND, note=_note(grain))


def _length(value: float) -> str:
    """A diameter in a suitable unit."""
    if value < 0.01:
        return f"{1e3 * value:g} mm"
    return f"{1e2 * value:g} cm" if value < 1.0 else f"{value:g} m"


def _note(grain: Grain, speed: bool = True) -> str:
    """The line of input values in the corner of a chart."""
    inside = f"{grain.rho_s:g} kg/m³"
    return f"{inside}, e = {grain.e:g}, impact at {grain.speed:g} m/s" if speed else inside
