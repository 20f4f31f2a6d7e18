"""The measured profiles are those of the flume, and ours are set against them as said."""

import numpy as np
import pytest

from ryusa.casefile import derive, read
from ryusa.cases import case_path
from ryusa.studies.validation import frey
from ryusa.study import Level, Outcome, Plan


def test_the_flux_of_the_measured_profiles_is_that_of_the_flume() -> None:
    flume = frey.measured()
    # the two rates that the literature quotes for runs 6 and 20, with g cos(slope)
    assert frey.rate(*flume[6]) == pytest.approx(0.066, abs=0.001)
    assert frey.rate(*flume[14]) == pytest.approx(0.136, abs=0.001)  # between them, as its depth is
    assert frey.rate(*flume[20]) == pytest.approx(0.194, abs=0.001)
    for z, phi, u in flume.values():
        assert np.all(np.diff(z) > 0.0)
        assert 0.4 < phi[z < 6.0].mean() < 0.6
        assert np.all(np.diff(u[z > 6.0]) > 0.0)


def test_profiles_equal_to_the_flumes_have_no_error() -> None:
    flume = frey.measured()
    found = {}
    for work in frey.tasks(Plan(Level.FULL, ())):
        depth = dict(work.overrides)["water.depth"]
        run = next(run for run, one in frey.FLUME.items() if one.depth == depth)
        z, phi, u = flume[run]
        found[work] = {
            "z": z, "phi": phi, "u": u, "z_water": z, "u_water": 2.0 * u,
            "q_star": frey.rate(z, phi, u), "q_error": 0.0, "time": 60.0,
        }  # fmt: skip
    for one in frey.judge(found, Plan(Level.FULL, ())):
        assert one.outcome is Outcome.HOLDS
        assert [each.found.value for each in one.trials if "rms" in each.part] == [0.0]
    assert frey.tasks(Plan(Level.QUICK, ())) == []


def test_every_run_is_of_the_published_flume() -> None:
    for work in frey.tasks(Plan(Level.FULL, ())):
        case = read(case_path("validation/frey.toml"), dict(work.overrides))
        assert case.stop.time is not None
        assert case.stop.time - case.record.settle >= 60.0
        assert derive(case).n_grain in {354, 365, 368}
