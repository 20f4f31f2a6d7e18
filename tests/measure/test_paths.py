from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import energy, farthest, rows_of, spin, tracks, write_csv
from ryusa.model import Tally, Term
from ryusa.model.tally import HELD
from ryusa.results.schema import TALLY, tally_row


def test_spin_is_averaged_after_settling_and_set_against_distance(make):
    t = np.linspace(0, 1, 1001)
    x = np.zeros((1001, 2, 3))
    x[:, :, 0] = 0.01 + 0.5 * t[:, None]
    omega = np.zeros_like(x)
    omega[:, 0, 1], omega[:, 1, 1] = 100.0, -300.0
    omega[:500] = 7.0e6
    found = spin(
        make.run_of(t, x, x, np.zeros(0, dtype=make.event(0, 0, 0, (0, 0), (0, 0), (0, 0)).dtype), omega),
        settle=0.5,
    )
    assert found.averages["spin"].value == pytest.approx(-100.0)
    assert found.largest == pytest.approx(300.0)
    assert found.distance[-1, 0] == pytest.approx(0.5)
    assert found.series()[0]["x_m"] == 0.0


def test_tracks_show_only_the_bed_of_their_own_lane(make):
    t, x, _, events = make.hopping([2.0e-3] * 3, grain=1, n_grain=2)
    both = np.stack([x - [0, 0.008, 0], x], axis=1)
    found = tracks(make.run_of(t, both, both, events), grains=[1], begin=0.01, end=0.03)
    assert len(found.bed_x) == 20
    assert found.t.min() >= 0.01
    assert found.t.max() <= 0.03
    assert len(found.rows()) == len(found.t)


def test_tracks_show_the_free_grains_of_the_lane_that_lie_still(make):
    x = np.zeros((30, 5, 3))
    x[:, :, 0] = 4 * make.d * np.arange(5)
    x[:, 0, 0] += np.linspace(0.0, 9 * make.d, 30)  # the grain to follow
    x[:, 1, 0] += np.linspace(0.0, 0.9 * make.d, 30)
    x[:, 2, 0] += np.linspace(0.0, 1.1 * make.d, 30)  # moves
    x[:, 3, 1] = 4 * make.d  # in another lane
    run = make.run_of(np.arange(30.0), x, 0 * x, make.hopping([2.0e-3])[3])
    found = tracks(run, grains=[0])
    assert found.loose_x == pytest.approx([4.9 * make.d, 16 * make.d])
    assert found.loose_d == pytest.approx(make.d)
    run.scene = replace(run.scene, plane_case=False)
    assert found.loose_x[0] in tracks(run, grains=[0]).loose_x
    assert len(tracks(run, grains=[0]).loose_x) == 3


def test_tracks_leave_out_fixed_grains_that_were_taken_away(make):
    t, x, v, events = make.hopping([2.0e-3] * 3)
    run = make.run_of(t, x[:, None], v[:, None], events)
    run.scene = replace(run.scene, fixed_active=np.arange(20) < 12)
    assert len(tracks(run).bed_x) == 12


def test_the_grain_that_goes_farthest_is_found_within_the_window(make):
    t, x, _, events = make.hopping([2.0e-3] * 3, grain=1, n_grain=2)
    still = np.broadcast_to(x[:1], x.shape)
    run = make.run_of(t, np.stack([still, x], axis=1), np.stack([x, x], axis=1), events)
    assert farthest(run) == 1
    assert farthest(run, begin=t[-1]) == 0  # one frame alone says nothing


def accounted(tally):
    """A run of one grain of which the account of energy alone is known."""
    return SimpleNamespace(scene=SimpleNamespace(n_grain=1, n_fixed=0), tally=tally)


def test_the_energy_account_closes_where_its_terms_say_so():
    tally = {name: np.zeros(3) for name in TALLY.names}
    tally["t"] = np.arange(3.0)
    tally["kinetic"] = np.array([1.0, 0.7, 0.9])
    tally[Term.START.name.lower()] = np.ones(3)
    tally["dash_n"] = np.array([0.0, 0.3, 0.3])
    tally["drag"] = np.array([0.0, 0.0, 0.2])
    found = energy(accounted(tally))
    np.testing.assert_allclose(found.imbalance, 0.0, atol=1e-15)
    tally["slide"] = np.array([0.0, 0.0, 0.05])
    assert energy(accounted(tally)).residual == pytest.approx(0.05)
    assert found.rows()[2]["given_drag_J"] == 0.2


def test_the_frame_before_the_first_step_is_not_part_of_the_account():
    tally = {name: np.zeros(3) for name in TALLY.names}
    tally["t"] = np.arange(3.0)
    tally["kinetic"] = np.array([1.3, 1.0, 0.7])  # before the first step nothing is booked
    tally[Term.START.name.lower()] = np.array([0.0, 1.0, 1.0])
    tally["dash_n"] = np.array([0.0, 0.0, 0.3])
    found = energy(accounted(tally))
    assert found.t.tolist() == [1.0, 2.0]
    assert found.residual == pytest.approx(0.0, abs=1e-15)


def test_the_residual_is_that_of_the_tally_wherever_heights_begin():
    values = {"kinetic": 0.5, "potential": 0.4, "dash_n": 0.3, "switch": 0.1, "step": 0.02, "start": 1.0}
    for height in (0.0, 1.0e3):
        lifted = {**values, "potential": values["potential"] + height, "start": values["start"] + height}
        one = Tally(
            t=0.0, **{name: lifted.get(name, 0.0) for name in HELD},
            terms=tuple(lifted.get(term.name.lower(), 0.0) for term in Term),
            overlap_max=0.0, overlap_grain=0, overlap_step=0, speed_max=0.0, spin_max=0.0, n_contact=0,
        )  # fmt: skip
        rows = np.array([tally_row(one)], dtype=TALLY)
        found = energy(accounted({name: rows[name] for name in TALLY.names}))
        assert found.residual == pytest.approx(one.residual, rel=1e-9)
        assert one.residual == pytest.approx(0.08 / 0.5, rel=1e-9)
        assert found.rows()[0]["given_step_J"] == 0.02


def test_csv_reads_back_without_loss(make, tmp_path):
    rows = rows_of(np.array([make.event(0, 1, 1 / 3, (0.1, 0.2), (1, 2), (3, 4))]))
    path = write_csv(tmp_path / "deep" / "events.csv", rows)
    head, line = path.read_text().splitlines()
    values = dict(zip(head.split(","), line.split(","), strict=True))
    assert float(values["t_begin"]) == 1 / 3
    assert float(values["v_begin_z"]) == 2


def test_a_run_of_an_engine_without_an_account_has_none_to_measure():
    tally = {name: np.full(3, np.nan) for name in TALLY.names}
    with pytest.raises(ResultsError, match="keeps no account of energy"):
        energy(accounted(tally))
