import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.measure.stability import Grain, chart, chart_around, choice, stable_range

SAND = Grain(d=0.002, rho_s=2650.0, e=0.7, speed=0.6)


def test_the_papers_soft_contact_lasts_a_hundredth_of_a_second():
    assert choice(SAND, 1.0).eq_8 == pytest.approx(0.0105, rel=0.01)


def test_a_free_partner_shortens_contact_by_the_root_of_two():
    found = choice(SAND, 1.0e4)
    assert found.time_fixed / found.time_free == pytest.approx(math.sqrt(2))
    assert found.eta_fixed / found.eta_free == pytest.approx(math.sqrt(2))
    assert found.overlap_fixed / found.overlap_free == pytest.approx(math.sqrt(2))


def test_the_step_divides_the_shortest_contact():
    found = choice(SAND, 1.0e4, steps_per_contact=50)
    assert found.dt * 50 == pytest.approx(found.time_free)  # damping makes it shorter than Eq. (8) / sqrt(2)
    assert found.time_free < found.eq_8 / math.sqrt(2)
    assert found.cost == pytest.approx(1000 / found.dt / 5e6)


def test_added_mass_lengthens_contact_by_about_nine_per_cent_for_quartz():
    wet = choice(replace(SAND, water=True), 1.0e4)
    dry = choice(SAND, 1.0e4)
    assert wet.time_fixed / dry.time_fixed == pytest.approx(math.sqrt(1 + 0.5 / 2.65))


@given(d=st.floats(1e-4, 1.0), e=st.floats(0.1, 1.0), speed=st.floats(0.01, 10.0), water=st.booleans())
def test_the_edges_of_the_band_have_the_overlaps_they_are_named_after(d, e, speed, water):
    grain = Grain(d=d, rho_s=2650.0, e=e, speed=speed, water=water)
    soft, stiff = stable_range(grain)
    assert choice(grain, soft).overlap_fixed == pytest.approx(0.01, rel=1e-9)
    assert choice(grain, stiff).overlap_fixed == pytest.approx(0.001, rel=1e-9)


def test_a_chart_has_one_line_per_diameter():
    found = chart(SAND, np.array([0.001, 0.002]), np.logspace(2, 4, 5))
    assert found.time.shape == found.overlap.shape == (2, 5)
    assert found.band_k.shape == (2, 2)
    assert len(found.rows()) == 10
    assert found.time[1, -1] == pytest.approx(choice(SAND, 1.0e4).eq_8)


def test_a_chart_around_grains_holds_the_whole_band_of_all_of_them():
    found = chart_around(SAND, np.array([0.0005, 0.01]))
    assert found.k_n[0] < 0.5 * found.band_k.min()
    assert found.k_n[-1] > 2.0 * found.band_k.max()
