import numpy as np
import pytest

from ryusa.figures import charts
from ryusa.measure.stability import Grain, chart_around

SAND = Grain(d=0.002, rho_s=2650.0, e=0.7, speed=0.6)


@pytest.mark.parametrize("large", [False, True])
def test_diameters_are_printed_in_a_suitable_unit(large):
    found = chart_around(SAND, np.array([0.002, 0.05]) * (100.0 if large else 1.0))
    for figure in (charts.times(found, SAND, band=True), charts.overlaps(found, SAND)):
        words = [text.get_text() for text in figure.axes[0].texts]
        assert set(words) >= ({"20 cm", "5 m"} if large else {"2 mm", "5 cm"})
