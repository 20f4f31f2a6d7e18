"""Fig. 4: contact time of Eq. (8) against stiffness, for grains of 0.05 to 1 cm."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa.experiments import _charts
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure.stability import Chart, choice
from ryusa.results import Results

FIGURE = "fig4"
TITLE = "Contact time against stiffness, Eq. (8)"
SHOWN: tuple[str, ...] = ()


def cases() -> Sequence[Variant]:
    """No run is needed."""
    return ()


def measure(results: Mapping[str, Results]) -> Chart:
    """Eq. (8) for five diameters."""
    del results
    return _charts.around(_charts.PAPER, softest=1.0)


def expect(table: Chart) -> Sequence[Verdict]:
    """The paper: d = 0.2 cm at 0.01 N/cm stays in touch for about 0.01 s."""
    del table
    time = choice(_charts.PAPER, 1.0).eq_8
    says = "d = 0.2 cm, k_n = 0.01 N/cm: about 0.01 s"
    return (Verdict("fig4", says, f"{time:.4f} s at 2650 kg/m3", abs(time / 0.01 - 1.0) < 0.1),)


def draw(table: Chart) -> Mapping[str, Figure]:
    """The chart."""
    return {"fig04": _charts.times(table, _charts.PAPER, band=False)}
