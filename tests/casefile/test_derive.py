"""What follows from a case, against pocket-calculator numbers."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from ryusa.casefile import Case, derive, disk_needed, explain, frames_expected, read, resolved, steps_expected
from ryusa.casefile.estimate import BYTES_PER_GRAIN, disk_for_events, events_expected, memory_needed
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.values import water_alone
from ryusa.errors import CaseError
from ryusa.laws import collision
from ryusa.model.contacts import N_EVENT

CaseOf = Callable[..., Case]
WATER = "{ profile = 'log rough', tau_star = 0.3, depth = '2 cm' }"
PACKING = "{ kind = 'packing', columns = 10, layers = 4 }"
MASS = 2650.0 * math.pi / 6 * 0.002**3


def test_a_quartz_grain_weighs_as_a_sphere(case: CaseOf) -> None:
    found = derive(case())
    assert found.m == pytest.approx(MASS, rel=1e-14)
    assert found.m_added == 0.0
    assert found.m_weight == found.m
    assert found.inertia == pytest.approx(MASS * 0.002**2 / 10, rel=1e-14)


def test_water_adds_mass_to_the_inertia_and_takes_weight(case: CaseOf) -> None:
    found = derive(case(water=WATER))
    assert found.m_added == pytest.approx(MASS * 500 / 2650, rel=1e-12)
    assert found.m_weight == pytest.approx(MASS * 1650 / 2650, rel=1e-12)
    assert found.fixed.m == pytest.approx(found.m + found.m_added, rel=1e-14)
    assert found.u_star == pytest.approx(math.sqrt(0.3 * 1.65 * 9.80665 * 0.002), rel=1e-12)


def test_u_star_and_tau_star_give_each_other(case: CaseOf) -> None:
    found = derive(
        case(water="{ profile = 'log rough', u_star = '9.85 cm/s' }", **{"motion.gravity": "9.8 m/s2"})
    )
    assert found.tau_star == pytest.approx(0.3, abs=2e-4)


def test_the_contact_time_of_the_paper_comes_out(case: CaseOf) -> None:
    assert derive(case()).fixed.t_undamped == pytest.approx(1.05e-4, rel=5e-3)
    assert derive(case(**{"contact.stiffness": "0.01 N/cm"})).fixed.t_undamped == pytest.approx(
        1.05e-2, rel=5e-3
    )


@pytest.mark.parametrize("parting", ["tension", "no tension"])
@pytest.mark.parametrize("e", ["0.1", "0.7", "1.0"])
def test_the_restitution_of_the_case_is_that_of_both_pairs(case: CaseOf, parting: str, e: str) -> None:
    found = derive(case(**{"contact.parting": parting, "contact.restitution": e}))
    assert found.fixed.e == pytest.approx(float(e), rel=1e-9)
    assert found.free.e == pytest.approx(float(e), rel=1e-9)
    assert found.free.eta_n == pytest.approx(found.fixed.eta_n / math.sqrt(2), rel=1e-12)


def test_a_constant_dashpot_gives_two_restitutions(case: CaseOf) -> None:
    keys = {"grains.diameter": "2.18 mm", "contact.stiffness": "200 N/cm", "contact.damping": "0.001 N s/cm"}
    found = derive(case(**keys, **{"contact.parting": "tension"}))
    assert found.fixed.e == pytest.approx(0.745, abs=1e-3)
    assert found.free.e == pytest.approx(0.658, abs=1e-3)
    assert found.fixed.t_col == pytest.approx(8.46e-5, rel=2e-3)
    assert found.free.t_col == pytest.approx(6.0e-5, rel=5e-3)


def test_a_stiffness_given_by_overlap_gives_that_overlap(case: CaseOf) -> None:
    found = derive(case(**{"contact.stiffness": "{ overlap = 0.01, speed = '0.6 m/s' }"}))
    deepest = collision.overlap_max(0.6, found.fixed.m, found.k_n, found.fixed.zeta_n)
    assert deepest == pytest.approx(0.01 * 0.002, rel=1e-12)


def test_a_stiffness_given_by_time_gives_eq_8(case: CaseOf) -> None:
    found = derive(case(water=WATER, **{"contact.stiffness": "{ collision_time = '1e-4 s' }"}))
    assert found.fixed.t_undamped == pytest.approx(1e-4, rel=1e-12)


def test_k_s_is_two_sevenths_of_k_n_by_default(case: CaseOf) -> None:
    assert derive(case()).k_s == pytest.approx(1e4 * 2 / 7)
    assert derive(case(**{"contact.shear_ratio": "0.075"})).k_s == pytest.approx(750.0)
    assert derive(case(**{"contact.shear_stiffness": "15 N/cm"})).k_s == pytest.approx(1500.0)


def test_the_step_follows_the_lightest_pair_that_can_meet(case: CaseOf) -> None:
    fixed = derive(case())
    assert fixed.dt == pytest.approx(fixed.fixed.t_col / 10, rel=1e-12)
    meeting = derive(case(build="{ kind = 'drop', partner = 'free', height = '1 cm' }"))
    assert meeting.dt == pytest.approx(fixed.dt / math.sqrt(2), rel=1e-12)
    mixed = derive(case(build=PACKING, **{"grains.spread": "0.1"}))
    assert mixed.dt == pytest.approx(meeting.dt * 0.9**1.5, rel=1e-12)


def test_the_step_resolves_a_tangential_oscillation_that_is_faster_than_the_contact(case: CaseOf) -> None:
    stiff = {"contact.shear_ratio": "1", "motion.rotation": "free"}
    found = derive(case(**stiff))
    assert found.steps_per_contact > 15.0
    assert found.dt == pytest.approx(0.2 * found.step_limit_shear)
    assert derive(case(**stiff, **{"time.steps_per_contact": "10"})).steps_per_contact == pytest.approx(10.0)


def test_contacts_at_steps_take_fifty_and_refuse_less_than_ten(case: CaseOf) -> None:
    at_steps = {"contact.timing": "at steps"}
    assert derive(case(**at_steps)).steps_per_contact == pytest.approx(50.0)
    with pytest.raises(CaseError, match=r"must be at least 10 .*; 'exact' allows 5"):
        case(**at_steps, **{"time.steps_per_contact": "7"})


def test_many_starts_do_not_touch_each_other(case: CaseOf) -> None:
    found = derive(case(build="{ kind = 'saltation', starts = 5 }", water=WATER))
    assert (found.n_grain, found.n_fixed, found.meet) == (5, 100, False)
    assert found.dt == pytest.approx(found.fixed.t_col / 10)


def test_a_resolved_case_is_plain_json_in_si(case: CaseOf) -> None:
    plain = json.loads(json.dumps(resolved(case(water=WATER)), allow_nan=False))
    assert plain["grains"]["diameter"] == 0.002
    assert plain["contact"]["stiffness"] == 1.0e4
    assert plain["contact"]["friction"] == pytest.approx(math.tan(math.pi / 6))
    assert plain["time"]["step"] == plain["derived"]["dt"]
    assert plain["water"]["u_star"] > 0.0
    assert plain["stop"]["time"] == 0.1


def test_the_largest_stable_step_is_that_of_the_stiffer_motion(case: CaseOf) -> None:
    keys = {"contact.damping": "0 N s/m", "contact.shear_ratio": "10"}
    locked, free = derive(case(**keys)), derive(case(**keys, **{"motion.rotation": "free"}))
    later = derive(case(**keys, timeline="[{ at = '0.05 s', rotation = 'free' }]"))
    omega = math.sqrt(1e4 / MASS)
    assert locked.step_limit == pytest.approx(2.0 / omega / math.sqrt(10.0))
    assert free.step_limit == pytest.approx(2.0 / omega / math.sqrt(35.0))  # m_t = 2/7 m
    assert later.step_limit == free.step_limit
    assert derive(case(**{"contact.damping": "0 N s/m"})).step_limit == pytest.approx(2.0 / omega)


def test_contacts_to_record_are_counted_before_the_run(case: CaseOf) -> None:
    few = case(build=PACKING)
    many = case(build="{ kind = 'packing', columns = 101, layers = 10 }")
    assert (events_of(few), events_of(many)) == ("all", "none")
    assert many.record.events is None
    assert resolved(many)["record"]["events"] == "none"
    assert disk_for_events(many, derive(many)) == 0
    dense = case(build="{ kind = 'packing', columns = 101, layers = 10 }", **{"record.events": "all"})
    assert 1e5 < events_expected(dense, derive(dense)) < 1e6  # 1010 grains, 0.1 s
    assert disk_for_events(dense, derive(dense)) == 8 * N_EVENT * events_expected(dense, derive(dense))
    frames = 3.1 * BYTES_PER_GRAIN * 1010 * frames_expected(many)
    asked, events = memory_needed(dense, derive(dense)), 3.1 * disk_for_events(dense, derive(dense))
    assert 1.0 < asked - memory_needed(many, derive(many)) <= events + 1  # records that wait to be written
    assert 218e6 < memory_needed(many, derive(many)) < 218e6 + frames + 5000 * 1010


def test_frames_and_bytes_are_counted_before_the_run(case: CaseOf) -> None:
    one = case(**{"stop.time": "1 s", "record.frames": "1 ms"})
    assert frames_expected(one) in (1001, 1002)
    assert steps_expected(one.stop, one.record, derive(one)) == math.ceil(1.0 / derive(one).dt)
    long = case(**{"stop.time": "1e5 s", "record.frames": "10 us"})
    assert disk_needed(long, derive(long)) > 10e9


def test_every_shipped_case_is_good_and_stays_in_its_limits(packaged: list[Path]) -> None:
    assert len(packaged) >= 20
    for file in packaged:
        one = read(file)
        assert one.title
        assert water_alone(one) or derive(one).steps_per_contact >= 10.0 - 1e-9
        assert len(explain(one)) > 20
