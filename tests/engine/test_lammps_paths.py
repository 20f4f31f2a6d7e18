"""Where LAMMPS has the law of the CPU engine to round-off, and the one place where its spring is another."""

import numpy as np
import pytest
from tests.engine.conftest import D
from tests.engine.test_lammps import ASKEW, CARRIED, NO_SPIN, needs_lammps, pair, sliding_block, stepped

from ryusa.build import scene

pytestmark = pytest.mark.full

FLOOR = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]


@needs_lammps
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
@pytest.mark.parametrize("e", [0.7, 1.0])
def test_an_oblique_collision_of_grains_that_do_not_turn_is_that_of_the_cpu_to_round_off(partner, e):
    made = pair(partner, ASKEW, NO_SPIN, restitution=e, rotation=False, stiffness=2e3, friction=0.5)
    mine, theirs = stepped(made, 70)
    assert theirs.v[0, 0] < 0.09 and abs(theirs.v[0, 2] + 0.08) > 0.01  # it has met, with friction
    assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=1e-14)


@needs_lammps
def test_a_crowd_with_friction_keeps_the_paths_of_the_cpu_across_periods_and_new_lists():
    # without dashpots and without turning both laws are the same; grains slide over a rough bed at 3 m/s
    x, v, bed = sliding_block()
    made = scene(
        x, D, v=v, x_fixed=bed, d_fixed=D,
        period=(5.1 * D, 5.1 * D), friction=0.5, restitution=1.0, rotation=False, stiffness=2e3,
        steps_per_contact=20.0, slope=0.4, **CARRIED,
    )  # fmt: skip
    mine, theirs = stepped(made, 600)
    assert np.abs(theirs.image[:, 0]).max() >= 2
    assert theirs.v[:, 0].mean() < 2.5
    assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=3e-8)  # 1e-16 has grown by collisions


@needs_lammps
@pytest.mark.parametrize("g, limited", [(100.0, False), (40.0, True)])
def test_only_a_contact_that_is_pressed_again_after_its_force_was_limited_has_another_spring(g, limited):
    # the weight presses on the grain as it rebounds: at 40 m/s2 after its force was 0 for a while
    made = scene(
        [[0.0, 0.0, 0.5001 * D]], D, v=[[0.1, 0.0, -0.1]], planes=FLOOR, gravity=g, friction=5.0,
        restitution=0.3, rotation=False, stiffness=100.0, **CARRIED,
    )  # fmt: skip
    mine, theirs = stepped(made, 110)
    apart = float(np.abs(mine.v - theirs.v).max())
    assert 1e-5 < apart < 3e-3 if limited else apart < 1e-14
