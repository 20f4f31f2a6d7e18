"""Fig. 11: the band 0.001 < overlap/d < 0.01 laid over the contact times of Fig. 4."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa.experiments import _charts
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure.stability import Chart, choice, stable_range
from ryusa.results import Results

FIGURE = "fig11"
TITLE = "The stable band over the contact times"
SHOWN: tuple[str, ...] = ()


def cases() -> Sequence[Variant]:
    """No run is needed."""
    return ()


def measure(results: Mapping[str, Results]) -> Chart:
    """Contact times and band for five diameters."""
    del results
    return _charts.around(_charts.PAPER)


def expect(table: Chart) -> Sequence[Verdict]:
    """The paper: inside the band a grain of 0.2 cm stays in touch for about 1e-4 s."""
    del table
    soft, stiff = stable_range(_charts.PAPER)
    longest, shortest = choice(_charts.PAPER, soft).eq_8, choice(_charts.PAPER, stiff).eq_8
    says = "d = 0.2 cm: contact time about 1e-4 s in the band"
    found = f"{shortest:.2g} to {longest:.2g} s for k_n = {soft:.3g} to {stiff:.3g} N/m"
    return (Verdict("fig11", says, found, shortest < 1.05e-4 and longest > 0.95e-4),)


def draw(table: Chart) -> Mapping[str, Figure]:
    """The chart."""
    return {"fig11": _charts.times(table, _charts.PAPER, band=True)}
