import numpy as np

from ryusa import figures
from ryusa_studies.osada2004.figures import QuotedPoint, ReboundCurve, drop_chart, over_speed, rebounds

K = np.logspace(0, 6, 4)


def test_charts_of_drops_are_in_the_units_of_the_paper():
    line = figures.StiffnessCurve("Eq. (8)", K, 1 / np.sqrt(K))
    run = figures.StiffnessPoints("run", K, 1 / np.sqrt(K), 0 * K)
    region = figures.StiffnessBand(("0.01", "0.001"), K[:2], 1 / K[:2], K[2:], 1 / K[2:])
    figure = drop_chart("time", [line], [run], quoted=[QuotedPoint(1.0e4, 0.01, "0.2 cm")], band=region)
    (axes,) = figure.axes
    assert axes.get_xlabel().endswith("(N/cm)")
    assert axes.get_xscale() == axes.get_yscale() == "log"
    star = next(one for one in axes.lines if one.get_marker() == "*")
    assert star.get_xdata()[0] == 100.0
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "Osada et al. 2004, 0.2 cm" in words
    figure.canvas.draw()


def test_rebounds_show_the_range_over_phases_and_the_line_of_ten_steps():
    steps = np.array([5.0, 10.0, 50.0])
    one = ReboundCurve(steps, np.full(3, 0.7), np.full(3, 0.6), np.full(3, 0.8))
    figure = rebounds({"runs": one}, 0.7, 0.05, 10.0)
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.get_xticklabels()] == ["5", "10", "50"]
    assert any(np.allclose(line.get_xdata(), 10.0) for line in axes.lines)
    figure.canvas.draw()


def test_overlaps_over_speed_take_a_cloud_of_hits_or_none():
    v = np.array([0.1, 1.0])
    for cloud in ((v, v / 100), None):
        figure = over_speed([("run", v, v / 100)], cloud, levels=(0.001, 0.01), wanted=0.01)
        figure.canvas.draw()
        assert figure.axes[0].get_xlabel().endswith("(m/s)")
