import numpy as np

from ryusa.figures.discharge import discharge
from ryusa.measure.discharge import Discharge
from ryusa.measure.table import Averages


def passed(rate: float) -> Discharge:
    t = np.linspace(0.0, 1.0, 5)
    none, mass = np.zeros(5, dtype=np.int64), rate * t
    return Discharge(
        t, none, 1.0 + mass, none, none, mass, 0.0 * t, {"feeder": mass}, {"outlet": 0.0 * t},
        Averages("discharge", ()),
    )  # fmt: skip


def names(found: Discharge) -> list[str]:
    return discharge(found).axes[0].get_legend_handles_labels()[1]


def test_each_line_of_the_discharge_is_named():
    assert names(passed(0.5)) == ["in by feeder", "out by outlet", "mean rate"]
    assert names(passed(0.0)) == ["in by feeder", "out by outlet"]
