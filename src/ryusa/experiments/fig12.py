"""Fig. 12: the same band for large grains."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from matplotlib.figure import Figure

from ryusa.experiments import _charts
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure.stability import BAND, Chart, choice, stable_range
from ryusa.results import Results

FIGURE = "fig12"
TITLE = "The stable band for large grains"
SHOWN: tuple[str, ...] = ()
LARGE = replace(_charts.PAPER, d=0.2)


def cases() -> Sequence[Variant]:
    """No run is needed."""
    return ()


def measure(results: Mapping[str, Results]) -> Chart:
    """Contact times and band for diameters of 5 cm to 1 m."""
    del results
    return _charts.around(LARGE, _charts.LARGE)


def expect(table: Chart) -> Sequence[Verdict]:
    """The paper: for 20 cm both 0.01 s and 0.0001 s lie in the band.

    Overlap/d is proportional to the contact time; the two differ by 100 and the band is a factor 10 wide, so
    no impact speed can hold both.
    """
    del table
    soft, stiff = stable_range(LARGE)
    longest, shortest = choice(LARGE, soft).eq_8, choice(LARGE, stiff).eq_8
    says = "d = 20 cm: both 0.01 s and 0.0001 s lie in the band"
    found = f"{shortest:.2g} to {longest:.2g} s; a band of a factor {BAND[1] / BAND[0]:g} cannot hold both"
    return (Verdict("fig12", says, found, shortest <= 1.0e-4 and longest >= 1.0e-2),)


def draw(table: Chart) -> Mapping[str, Figure]:
    """The chart."""
    return {"fig12": _charts.times(table, LARGE, band=True)}
