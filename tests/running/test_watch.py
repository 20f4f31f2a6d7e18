import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ryusa.build.array_materials import Material, MaterialPair
from ryusa.build.from_arrays import scene as scene_of_arrays
from ryusa.errors import CheckpointError
from ryusa.laws.collision import collision_time, contact_time_no_tension, omega_natural
from ryusa.laws.families import ContactTiming
from ryusa.model import State
from ryusa.model.contact_law import elastic_spheres, shortest_contact_of
from ryusa.model.tally import N_TERM
from ryusa.running.energy_terms import energy_lines
from ryusa.running.guards import SinceRest
from ryusa.running.stops import HOP_RISE, RestDetector, SaltationCounter, Stop
from ryusa.running.summary import summary_lines
from ryusa.running.watch import RunningMean, Watch, shortest_collision_time


def test_an_average_taken_in_pieces_is_that_of_all_samples() -> None:
    samples = np.random.default_rng(3).normal(0.7, 0.1, 1000)
    average = RunningMean()
    for piece in np.split(samples, [1, 1, 7, 400]):
        average.take(piece)
    found = average.as_dict()
    assert found["n"] == 1000
    assert found["mean"] == pytest.approx(samples.mean(), rel=1e-12)
    assert found["standard_error"] == pytest.approx(samples.std(ddof=1) / math.sqrt(1000), rel=1e-12)


def test_one_sample_has_no_standard_error_and_none_has_no_mean() -> None:
    average = RunningMean()
    assert average.as_dict() == {"n": 0, "mean": None, "standard_error": None}
    average.take(np.array([0.5]))
    assert average.as_dict() == {"n": 1, "mean": 0.5, "standard_error": None}


def test_the_shortest_contact_is_that_of_two_free_grains_where_they_can_meet(scene_with: Any) -> None:
    scene = scene_with(3)
    at = State.at_rest(np.zeros((3, 3)))
    law, m = scene.contact, float(scene.m[0])
    damped = contact_time_no_tension(law.zeta_n, omega_natural(law.k_n, m / 2))
    assert shortest_collision_time(scene, at) == pytest.approx(min(damped, collision_time(m / 2, law.k_n)))


def test_lanes_of_a_plane_scene_never_meet(scene_with: Any) -> None:
    scene = scene_with(3, plane_case=True)
    lanes, one = np.zeros((3, 3)), np.zeros((3, 3))
    lanes[:, 1] = [0.0, 0.01, 0.02]
    apart = shortest_collision_time(scene, State.at_rest(lanes))
    assert apart == pytest.approx(math.sqrt(2) * shortest_collision_time(scene, State.at_rest(one)))


def test_materials_that_never_meet_do_not_make_the_shortest_contact() -> None:
    """Walls of steel touch each other only in a drawing: no contact of a run is that of steel on steel."""
    law = elastic_spheres(
        1e-5, 5e-4, youngs_modulus=1e8, poisson_ratio=0.2, speed=1.0, restitution=0.5, friction=0.3
    )
    x = np.array([[0.0, 0.0, 0.002], [0.01, 0.0, 0.002]])
    made, state = scene_of_arrays(
        x, 0.002, contact=law, planes=[("floor", (0, 0, 0), (0, 0, 1))],
        materials=[Material("steel", youngs_modulus=210e9)], made_of={"floor": "steel"},
        pairs=[MaterialPair(("grains", "steel"), restitution=0.4, friction=0.2)],
    )  # fmt: skip
    assert made.materials is not None
    m, both, wall = float(made.m[0]), made.materials.contact[0], made.materials.contact[1]
    expected = min(shortest_contact_of(both, m / 2.0, 0.0005), shortest_contact_of(wall, m, 0.001))
    assert shortest_collision_time(made, state) == pytest.approx(expected)


def test_restitution_is_split_by_partner_and_only_of_isolated_pairs(
    scene: Any, state: Any, event: Any, tally: Any
) -> None:
    watch = Watch(scene, state)
    watch.contacts(
        np.concatenate(
            [
                event(0, 3, 0, 1e-4, closing_end=-0.6),
                event(0, 5, 0, 1e-4, closing_end=-0.8),  # a plane
                event(0, 1, 0, 1e-4, closing_end=-0.5),
                event(0, 1, 0, 1e-4, closing_end=-0.1, alone=0.0),
                event(0, 3, 0, 1e-4, closing_begin=1e-4, closing_end=0.0),  # a rest on the bed
            ]
        )
    )
    found = watch.summary(tally())["restitution"]
    assert found["asked"] == 0.7
    assert (found["fixed"]["n"], found["fixed"]["mean"]) == (2, pytest.approx(0.7))
    assert found["fixed"]["standard_error"] == pytest.approx(0.1)
    assert (found["free"]["n"], found["free"]["mean"]) == (1, 0.5)


def test_tangential_restitution_keeps_its_sign(scene: Any, state: Any, event: Any, tally: Any) -> None:
    watch = Watch(scene, state)
    watch.contacts(event(0, 3, 0, 1e-4, slip_begin=[0.5, 0, 0], slip_end=[-0.35, 0, 0]))
    watch.contacts(event(0, 3, 0, 1e-4, slip_begin=[0.5, 0, 0], slip_end=[0.2, 0, 0], t_slide=5e-5))
    watch.contacts(event(0, 3, 0, 1e-4, slip_begin=[0.01, 0, 0], slip_end=[0.2, 0, 0]))  # nearly central
    found = watch.summary(tally())["restitution_shear"]
    assert (found["sticking"]["fixed"]["n"], found["sticking"]["fixed"]["mean"]) == (1, pytest.approx(0.7))
    assert (found["sliding"]["fixed"]["n"], found["sliding"]["fixed"]["mean"]) == (1, pytest.approx(-0.4))


def test_steps_per_contact_are_observed_within_a_bin(scene: Any, state: Any, event: Any, tally: Any) -> None:
    watch = Watch(scene, state)
    steps = np.random.default_rng(1).uniform(40, 60, 5000)
    watch.contacts(np.concatenate([event(0, 3, 0.0, n * scene.dt) for n in steps]))
    found = watch.summary(tally())["steps_per_contact"]["observed"]
    assert found["n"] == 5000
    assert found["least"] == pytest.approx(steps.min())
    assert found["most"] == pytest.approx(steps.max())
    for name, quantile in (("q01", 0.01), ("q50", 0.5), ("q99", 0.99)):
        assert found[name] == pytest.approx(np.quantile(steps, quantile), rel=0.025)


@pytest.mark.parametrize(
    ("overlap", "word"), [(0.02, "so soft"), (0.0005, "stiffer"), (0.005, None), (0.001, None), (0.01, None)]
)
def test_the_stable_band_is_watched(
    scene: Any, state: Any, event: Any, tally: Any, overlap: float, word: str | None
) -> None:
    watch = Watch(scene, state)
    watch.contacts(event(0, 3, 0.0, 1e-4))
    said = [one for one in watch.warnings(tally(overlap_max=overlap)) if "overlap" in one]
    assert bool(said) == (word is not None)
    assert word is None or word in said[0]


def test_a_warning_names_the_key_that_makes_these_contacts_stiffer(
    scene: Any, state: Any, tally: Any
) -> None:
    law = elastic_spheres(float(scene.m[0]), 1e-3, youngs_modulus=1e7, speed=0.5)
    for contact, key in ((scene.contact, "contact.stiffness"), (law, "contact.youngs_modulus")):
        said = Watch(replace(scene, contact=contact), state).warnings(tally(overlap_max=0.05))
        assert any(f"raise {key}" in one for one in said)


def test_a_grain_that_skims_the_bed_gives_a_warning(scene: Any, state: Any, event: Any, tally: Any) -> None:
    watch = Watch(scene, state)
    t, d = watch.t_col_shortest, float(scene.d[0])
    watch.contacts(event(0, 3, 0.0, t, v_begin=[0.25 * d / t, 0.0, -0.2]))
    assert not any("along the bed" in one for one in watch.warnings(tally()))
    watch.contacts(event(0, 3, 0.0, t, v_begin=[0.35 * d / t, 0.0, -0.2]))
    assert any("0.35 d along the bed" in one for one in watch.warnings(tally()))


def test_a_grain_that_rolls_or_rests_does_not_skim_the_bed(
    scene: Any, state: Any, event: Any, tally: Any
) -> None:
    watch = Watch(scene, state)
    t, d = watch.t_col_shortest, float(scene.d[0])
    watch.contacts(event(0, 3, 0.0, 100.0 * t, v_begin=[0.35 * d / t, 0.0, 0.0]))  # stays on a fixed grain
    plane = scene.n_grain + scene.n_fixed
    watch.contacts(event(0, plane, 0.0, t, v_begin=[0.35 * d / t, 0.0, 0.0]))
    assert not any("along the bed" in one for one in watch.warnings(tally()))


def test_too_few_steps_and_an_unbalanced_account_give_warnings(
    scene_with: Any, state: Any, tally: Any
) -> None:
    said = " ".join(Watch(scene_with(3, dt=1e-4), state).warnings(tally()))
    assert "steps in the shortest contact" in said
    assert "imbalance of the energy account" in said


@pytest.mark.parametrize(("timing", "few"), [(ContactTiming.EXACT, 4.9), (ContactTiming.AT_STEPS, 9.9)])
def test_how_few_steps_are_too_few_depends_on_the_timing(
    timing: ContactTiming, few: float, scene_with: Any, state: Any, tally: Any
) -> None:
    for steps, warns in ((few, True), (few + 0.1, False)):
        made = scene_with(3)
        made = replace(made, contact=replace(made.contact, timing=timing))
        dt = Watch(made, state).t_col_shortest / steps
        said = " ".join(Watch(replace(made, dt=dt), state).warnings(tally()))
        assert ("steps in the shortest contact" in said) == warns


def test_the_energy_account_names_every_term(scene: Any, state: Any, tally: Any) -> None:
    from ryusa.model import Term

    account = Watch(scene, state).summary(tally())["energy"]
    assert {term.name.lower() for term in Term} <= set(account)
    assert account["kinetic"] == 1.0
    assert account["imbalance"] == 21.0


def test_summary_lines_exist_for_a_run_without_contacts(scene: Any, state: Any, tally: Any) -> None:
    numbers = Watch(scene, state).summary(tally())
    more = {"steps": 1, "frames": 2, "contacts": 0, "wall": 1.0, "particle_steps_per_second": 5e6}
    text = "\n".join(summary_lines({**numbers, **more}))
    assert "5.00 M particle-steps/s" in text
    assert "not at all (no contact between two isolated grains)" in text


def test_a_flight_counts_as_a_hop_when_it_can_rise_a_tenth_of_d(scene: Any, event: Any) -> None:
    flight = 2 * math.sqrt(2 * HOP_RISE * 2e-3 / 9.8)
    hops = SaltationCounter(scene, Stop(saltations=1, settle=1.0))
    hops.contacts(event(0, 3, 0.5, 0.6))
    hops.contacts(event(0, 3, 0.9, 1.0))  # began to fly before it settled
    hops.contacts(event(0, 3, 1.0 + 0.99 * flight, 1.02))  # too low
    hops.contacts(event(0, 1, 1.5, 1.6))  # no bed contact
    hops.contacts(event(0, 4, 1.02 + 1.01 * flight, 3.0))
    hops.contacts(event(0, 3, 2.9, 2.95))  # while on another bed grain
    assert hops.count.tolist() == [1, 0, 0]
    assert hops.least == 0
    assert not hops.reached()


def test_only_tracked_grains_decide_when_saltations_are_enough(scene_with: Any, event: Any) -> None:
    hops = SaltationCounter(scene_with(3, tracked=np.array([True, False, False])), Stop(saltations=1))
    hops.contacts(np.concatenate([event(0, 3, 0.0, 0.1), event(0, 3, 0.5, 0.6)]))
    assert hops.reached()


def test_rest_begins_anew_whenever_a_grain_is_fast() -> None:
    rest = RestDetector(Stop(rest_speed=0.1, rest_for=1.0))
    assert [
        rest.reached(t, v)
        for t, v in [(0.0, 0.0), (0.9, 0.05), (0.95, 0.1), (1.5, 0.0), (2.4, 0.0), (2.5, 0.0)]
    ] == [
        False,
        False,
        False,
        False,
        False,
        True,
    ]


def test_a_contact_ended_by_the_timeline_counts_but_not_in_the_restitution(
    scene: Any, state: Any, event: Any, tally: Any
) -> None:
    watch = Watch(scene, state)
    cut = event(0, 3, 0.0, 3e-5, closing_end=math.nan, slip_begin=[0.5, 0, 0], slip_end=[math.nan] * 3)
    watch.contacts(cut)
    whole = event(0, 3, 0.0, 1e-4, slip_begin=[0.5, 0, 0], slip_end=[-0.3, 0, 0])
    watch.contacts(np.concatenate([cut, whole]))
    found = watch.summary(tally())
    assert watch.n_contact == 3
    assert found["restitution"]["fixed"] == {"n": 1, "mean": 0.7, "standard_error": None}
    assert found["restitution_shear"]["sticking"]["fixed"]["mean"] == pytest.approx(0.6)
    assert found["steps_per_contact"]["observed"]["n"] == 1


def _dennis(scene_with: Any, **changes: Any) -> Any:
    from ryusa.laws.families import Profile, WaterTorque
    from ryusa.model import Water

    water = Water(profile=Profile.STILL, nu=1e-6, rho_w=1000.0, torque=WaterTorque.DENNIS)
    return scene_with(3, **{"water": water, "rotation": True, **changes})


def test_spin_beyond_the_range_of_the_water_torque_gives_a_warning(
    scene_with: Any, state: Any, event: Any, tally: Any
) -> None:
    def said(scene: Any, spin: float, frame: bool) -> list[str]:
        watch = Watch(scene, state)
        if frame:
            watch.frame(replace(tally(), spin_max=spin))
        else:
            watch.contacts(event(0, 3, 0.0, 1e-4, omega_end=[0.0, -spin, 0.0]))
        return [one for one in watch.warnings(tally()) if "Re_r" in one]

    for frame in (True, False):
        assert not said(_dennis(scene_with), 999.0, frame)  # R^2 omega/nu = 1000 at 1000 rad/s
        assert "4.04e+03" in said(_dennis(scene_with), 1010.0, frame)[0]
        assert not said(_dennis(scene_with, rotation=False), 1010.0, frame)
        assert not said(scene_with(3, rotation=True), 1010.0, frame)


def test_constant_dashpots_print_the_restitution_that_follows(
    scene_with: Any, state: Any, tally: Any
) -> None:
    from ryusa.laws.collision import restitution_no_tension, restitution_tension
    from ryusa.model import ContactLaw
    from ryusa.model.scene import Damping

    law = ContactLaw(1e4, 2857.0, 0.5, damping=Damping.CONSTANTS, eta_n=0.1, eta_s=0.05)
    scene = scene_with(3, rotation=False, contact=law)
    numbers = Watch(scene, state).summary(tally())
    m = float(scene.m[0])
    e_fixed = restitution_no_tension(0.05 / math.sqrt(1e4 * m))
    e_free = restitution_no_tension(0.05 / math.sqrt(1e4 * m / 2))
    assert numbers["restitution"]["follows"] == {
        "fixed": pytest.approx(e_fixed),
        "free": pytest.approx(e_free),
    }
    e_s = restitution_tension(0.025 / math.sqrt(2857.0 * m))
    assert numbers["restitution_shear"]["follows"]["fixed"] == pytest.approx(e_s)
    more = {"steps": 1, "frames": 2, "contacts": 0, "wall": 1.0, "particle_steps_per_second": 5e6}
    text = "\n".join(summary_lines({**numbers, **more}))
    follows = f"{e_fixed:.4f} against fixed, {e_free:.4f} against free grains from constant dashpots"
    assert f"restitution: {follows}" in text
    assert "not set" not in text


def test_energy_lines_name_every_term_that_is_not_zero() -> None:
    from ryusa.model import Term
    from ryusa.model.tally import HELD

    names = [*HELD, *(term.name.lower() for term in Term)]
    terms = {**dict.fromkeys(names, 1.0), "imbalance": 0.25, "residual": 0.5}
    lines = dict(energy_lines(terms))
    shown = [term for text in lines.values() for term in re.findall(r"[a-z -]+ 1(?=[,;]|$)", text)]
    assert len(set(shown)) == len(names) - 1  # the energy at the start has a place of its own
    assert "at the start 1 J" in lines["energy now"]
    assert lines["imbalance"].startswith("0.25 J, 5.0e-01")
    without = dict(energy_lines({**terms, "slide": 0.0}))
    assert "sliding friction" not in without["dissipated"]
    assert "sliding friction" in lines["dissipated"]


@pytest.mark.parametrize(
    ("key", "value"),
    [("n", 2), ("n", 10**400), ("n", -1), ("mean", math.nan), ("spread", math.inf)],
    ids=["more", "huge", "negative", "nan", "inf"],
)
def test_a_checkpoint_with_impossible_averages_is_refused(
    scene: Any, state: Any, event: Any, key: str, value: float
) -> None:
    watch = Watch(scene, state)
    watch.contacts(event(0, 3, 0, 1e-4))
    kept = watch.to_block()
    Watch(scene, state).restore(kept)
    kept.values["averages"][0] = {**kept.values["averages"][0], key: value}
    with pytest.raises(CheckpointError, match="impossible mean"):
        Watch(scene, state).restore(kept)


def test_the_account_of_the_last_rest_outlasts_a_checkpoint(scene: Any, state: Any) -> None:
    watch, again = Watch(scene, state), Watch(scene, state)
    watch.rest = SinceRest(0.25, 1.5, tuple(0.1 * k for k in range(N_TERM)))
    again.restore(watch.to_block())
    assert again.rest == watch.rest
    lacking = watch.to_block()
    del lacking.values["rest"]
    with pytest.raises(CheckpointError, match="rest"):
        again.restore(lacking)
