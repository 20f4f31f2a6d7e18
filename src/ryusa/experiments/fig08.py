"""Fig. 8: largest overlap over diameter against stiffness."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa.experiments import _charts
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure.stability import Chart, choice
from ryusa.results import Results

FIGURE = "fig8"
TITLE = "Largest overlap against stiffness"
SHOWN: tuple[str, ...] = ()


def cases() -> Sequence[Variant]:
    """No run is needed."""
    return ()


def measure(results: Mapping[str, Results]) -> Chart:
    """Damped overlap at the impact speed, for five diameters."""
    del results
    return _charts.around(_charts.PAPER)


def expect(table: Chart) -> Sequence[Verdict]:
    """The paper: 0.01 at about 100 N/cm for d = 0.2 cm; the speed is not given, 0.6 m/s is our reading."""
    del table
    overlap = choice(_charts.PAPER, 1.0e4).overlap_fixed
    says = "d = 0.2 cm: overlap/d = 0.01 at about 100 N/cm"
    found = f"{overlap:.4f} at {_charts.PAPER.speed:g} m/s (impact speed free)"
    return (Verdict("fig8", says, found, 0.005 < overlap < 0.02),)


def draw(table: Chart) -> Mapping[str, Figure]:
    """The chart with the stable band."""
    return {"fig08": _charts.overlaps(table, _charts.PAPER)}
