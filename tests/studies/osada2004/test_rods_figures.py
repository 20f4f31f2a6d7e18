"""Rods: marked grains at several moments, and how long rods are."""

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection
from matplotlib.colors import to_hex

from ryusa.figures import save
from ryusa.measure import Averages, Rods, Snapshot
from ryusa_studies.osada2004.figures import rod_lengths, rods
from ryusa_studies.osada2004.figures.rods import MARKED, MORE, OWN

D = 0.002


def moment(t, shift):
    """Five grains in a row over a bed of ten, at time t [s], moved by `shift` diameters."""
    x = np.zeros((5, 3))
    x[:, 0], x[:, 2] = (np.arange(5) + shift) * D, 2 * D
    bed = np.zeros((10, 3))
    bed[:, 0], bed[:, 2] = (np.arange(10) + 0.5) * D, 0.5 * D
    return Snapshot(
        t=t, grains=np.arange(5), x=x, d=np.full(5, D), speed=np.zeros(5), spin=np.zeros(5), bed_x=bed,
        bed_d=np.full(10, D), plane_point=np.zeros((0, 3)), plane_normal=np.zeros((0, 3)), period=10 * D,
        lane=0, lanes=1,
    )  # fmt: skip


def found(lengths, movers=40, null=4.0):
    bound = int(np.arange(len(lengths)) @ lengths)
    return Rods(
        begin=np.zeros(1), movers=np.array([movers]), touching=np.array([movers]), bound=np.array([bound]),
        lengths=np.array(lengths), null=np.array([null]), longest=None, window=0.07,
        averages=Averages("rods", (), ()),
    )  # fmt: skip


def test_a_rod_is_black_at_every_moment():
    figure = rods([moment(1.0, 1.0), moment(1.035, 2.0), moment(1.07, 3.0)], [1, 2, 3])
    figure.canvas.draw()
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "$t$ = 1 s", "$t$ = 1.035 s", "$t$ = 1.07 s",
    ]  # fmt: skip
    for axes in figure.axes:
        free = [one for one in axes.collections if isinstance(one, EllipseCollection)][-1]
        colours = [to_hex(one) for one in free.get_facecolor()]
        assert colours.count(MARKED) == 3


def test_lengths_are_shares_of_the_movers_and_the_longest_share_a_bar():
    figure = rod_lengths({"locked": found([0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 1]), "free": found([0, 0, 1])})
    bars, shares = figure.axes
    heights = [bar.get_height() for bar in bars.patches]
    assert heights[: MORE - OWN + 1] == pytest.approx([6 / 40, 0, 0, 0, 0, 0, 0, 21 / 40])
    assert [bar.get_height() for bar in shares.patches] == pytest.approx([27 / 40, 0.1, 2 / 40, 0.1])


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_a_run_without_rods_can_be_drawn(tmp_path, suffix):
    figure = rod_lengths({"locked": found([0, 0], movers=0, null=0.0)})
    assert save(figure, tmp_path / f"rods{suffix}").stat().st_size > 0
