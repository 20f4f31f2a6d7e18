"""Closed forms of Egashira for Ito's case, the measure of parallel paths, and what is judged by them."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ryusa.errors import OverlapTooLarge, RunError, WaterError
from ryusa.laws import transport
from ryusa.laws.debris import equilibrium_concentration
from ryusa.study import Level, Outcome, Plan
from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import fig17_egashira as part
from ryusa_studies.osada2004._egashira import DebrisFlow
from ryusa_studies.osada2004._parallel import parallel
from ryusa_studies.osada2004.fig17_egashira import BesideClosedForms

QUICK, STANDARD = Plan(Level.QUICK, (1,)), Plan(Level.STANDARD, (1, 2))
ITO = DebrisFlow(math.radians(15.2), 0.0148, 0.00218, 2650.0, 1000.0, 9.8, math.radians(38.0))


def test_the_mean_of_the_speed_is_three_fifths_of_that_of_the_surface():
    z = np.linspace(0.0, ITO.depth, 4001)
    assert np.trapezoid(ITO.speed(z, 0.25), z) / ITO.depth == pytest.approx(ITO.mean_speed(0.25), rel=1e-5)


def test_without_grains_the_speed_is_that_of_water_with_a_mixing_length_in_pores():
    c = 1.0e-9
    k = math.sqrt(9.8 * math.sin(ITO.slope) / (0.16 * c ** (-2.0 / 3.0))) / ITO.d
    assert ITO.surface_speed(c) == pytest.approx(2.0 / 3.0 * k * ITO.depth**1.5, rel=1e-6)


@pytest.mark.parametrize("c", [0.05, 0.2, 0.3])
def test_a_stratified_flow_has_the_grains_asked_for_and_both_stresses_carry_their_weight(c):
    z, phi, u = ITO.stratified(c)
    assert np.trapezoid(phi, z) / ITO.depth == pytest.approx(c, rel=2e-4)
    assert u[0] == 0.0 and np.all(np.diff(u) >= 0.0)
    # weight above each level against the stresses there, up to where hardly a grain is left
    above = np.array([np.trapezoid(phi[k:], z[k:]) for k in range(len(z))])
    depth_above = ITO.depth - z
    shear = 9.8 * math.sin(ITO.slope) * (1650.0 * above + 1000.0 * depth_above)
    pressure = 9.8 * math.cos(ITO.slope) * 1650.0 * above
    rate = np.gradient(u, z)
    static = (phi / ITO.c_star) ** 0.2
    f = np.array([ITO.factor(float(one)) for one in phi])
    carried = static * pressure * math.tan(ITO.friction_angle) + 1000.0 * f * (ITO.d * rate) ** 2
    hit = 0.0828 * 0.85**2 * 2.65 * np.cbrt(phi) * 1000.0 * (ITO.d * rate) ** 2
    middle = (z > 0.02 * ITO.depth) & (z < 0.9 * ITO.depth)
    assert middle.sum() > 90
    assert carried[middle] == pytest.approx(shear[middle], rel=0.01)
    assert ((1.0 - static) * pressure)[middle] == pytest.approx(hit[middle], rel=0.02)


def test_where_the_closed_form_has_a_deposit_there_is_no_stratified_flow():
    most = equilibrium_concentration(ITO.slope, ITO.friction_angle, 2650.0, 1000.0)
    assert ITO.stratified(0.999 * most) is not None
    assert ITO.stratified(1.001 * most) is None


def test_a_layer_of_bed_load_has_the_flux_that_public_code_gives():
    """The same stresses in a layer of one concentration under clear water, over a bed that it could erode."""
    c, alpha, depth = 0.3, 0.25, 100.0
    slope, angle, tau = 0.02, math.atan(0.7), 0.3
    f = replace(ITO, e=0.85).factor(c)
    layer = transport.bedload_layer(tau, slope, angle, c, alpha)
    z = np.linspace(0.0, layer, 20001)  # in diameters; stress over (sigma - rho) g d
    above = c * (layer - z)
    weight = above * math.sin(slope)
    friction = above * math.cos(slope) * math.tan(angle) / (1.0 + alpha)
    driving = tau * (1.0 - z / depth) + weight - friction
    assert driving[0] == pytest.approx(0.0, abs=1e-12)
    rate = np.sqrt(np.maximum(driving, 0.0) / f)
    u = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(z) * (rate[1:] + rate[:-1]))])
    q_star = c * np.trapezoid(u, z)
    assert q_star == pytest.approx(transport.q_star_egashira(tau, slope, angle, c, alpha, f, depth), rel=1e-5)


def test_parallel_paths_have_no_change_of_height_whatever_the_frames():
    x = np.linspace(0.0, 100.0, 31)[:, None] * np.array([1.0, 0.7])
    z = np.ones_like(x) * np.array([1.0, 3.0])
    flat = parallel(x, z, 1.0)
    assert set(flat.change.values()) == {0.0} and flat.steep == 0.0
    assert math.isnan(parallel(x[:4], z[:4], 1.0).change[30.0])


@pytest.mark.parametrize("frames", [2001, 8001])
def test_a_wave_is_as_steep_at_any_speed_and_with_any_frames(frames):
    t = np.linspace(0.0, 1.0, frames)[:, None]
    for speed in (200.0, 400.0):
        x = speed * t
        found = parallel(x, 0.5 * np.sin(2.0 * math.pi * x / 20.0), 1.0)
        assert found.change[10.0] == pytest.approx(1.0 / math.sqrt(2.0), rel=0.02)  # from crest to trough: 1
        assert found.steep == pytest.approx(4 * 0.5 / 20.0, rel=0.02)


def test_a_grain_that_is_thrown_back_counts_no_place_twice():
    x = np.array([0.0, 1.0, 2.0, 1.5, 1.0, 2.0, 3.0, 4.0])[:, None]
    z = np.array([0.0, 0.0, 0.0, 5.0, 5.0, 1.0, 1.0, 1.0])[:, None]
    assert parallel(x, z, 1.0, (1.0,)).steep == pytest.approx(0.25)


def beside(c=0.25, factor=1.0, change=0.2, tilt=0.0):
    """A run whose profiles are the closed form's for 38 deg, its speed times a factor."""
    depth = ITO.depth
    z = (np.arange(14) + 0.5) * depth / 14.0
    v = factor * ITO.speed(z, c)
    phi = c * (1.0 + tilt * (1.0 - 2.0 * z / depth))
    return BesideClosedForms(
        flow=replace(ITO, friction_angle=math.radians(30.0)), c=c, speed=factor * ITO.mean_speed(c), q=1.0e-3,
        z=z, weight=np.full(14, depth / 14.0), phi=phi, v=v, upper=c,
        paths=parallel(
            np.linspace(0.0, 50.0, 501)[:, None] * ITO.d,
            change / 10.0 * np.linspace(0.0, 50.0, 501)[:, None] * ITO.d, ITO.d,
        ),
        overlap=0.01, along=0.05,
    )  # fmt: skip


def judged(plan=STANDARD, **more):
    found = {one: beside(**more) for one in part.tasks(plan)}
    return {one.id: one for one in part.judge(found, plan)}


@pytest.mark.parametrize(
    ("more", "outcome"),
    [({}, Outcome.HOLDS), ({"factor": 2.0}, Outcome.FAILS), ({"tilt": 0.8}, Outcome.FAILS)],
)
def test_profiles_must_be_those_of_the_closed_form(more, outcome):
    one = judged(**more)["fig17-egashira"]
    assert one.base_outcome is outcome
    assert {trial.choices[part.TIME] for trial in one.beside} == set(part.TIMES[1:])
    assert not any(trial.judged for trial in one.beside)


def test_of_as_many_grains_as_the_closed_form_has_in_a_deposit_nothing_flows():
    one = judged(c=0.42)["fig17-egashira"]  # by the closed form 38 deg holds this
    assert one.base_outcome is Outcome.FAILS
    assert part.STANDS in {trial.note for trial in one.trials}


@pytest.mark.parametrize(("change", "outcome"), [(0.3, Outcome.HOLDS), (0.8, Outcome.FAILS)])
def test_paths_are_nearly_parallel_within_half_a_diameter(change, outcome):
    assert judged(change=change)["fig17-parallel"].base_outcome is outcome


def test_grains_that_pass_through_each_other_fail_a_setting():
    about = {"grain": 4, "step": 100, "t": 0.1, "hint": ""}
    error = OverlapTooLarge("overlap is 0.5 of the smaller diameter", **about)
    assert part.failed(error) is not None
    assert part.failed(WaterError("drag", step=600, t=0.18, hint="")) is not None
    assert part.failed(RunError("another", **about)) is None
    found = {one: beside() for one in part.tasks(STANDARD)}
    found |= {one: part.failed(error) for one in found if "0.0010641 N/cm" in str(one.overrides)}
    for one in part.judge(found, STANDARD):
        long = [trial for trial in one.trials if trial.choices[part.TIME] == "1e-2 s"]
        assert long and all(trial.holds is False and "pass through" in trial.note for trial in long)
        assert one.base_outcome is Outcome.HOLDS
    assert part.rows(found, STANDARD) and part.draw(found, STANDARD)


def test_every_collision_time_keeps_the_restitution_and_names_its_steps():
    for time in part.TIMES:
        case = part.run({**part.SHIPPED, part.TIME: time}, 1).read()
        k, eta = (float(str(getattr(case.contact, name))) for name in ("stiffness", "damping"))
        assert eta / math.sqrt(k) == pytest.approx(0.1 / math.sqrt(2.0e4), rel=1e-4)
        m = 2650.0 * math.pi / 6.0 * 0.00218**3
        assert math.pi * math.sqrt(m / k) == pytest.approx(float(time.removesuffix(" s")), rel=0.01)


def test_bands_and_factors_are_registered():
    registered = Registration.read(Path(osada2004.__file__).parent / "registration")
    for one in judged().values():
        registered.check(one)
        assert set(registered.claims[one.id].factors) == set(one.trials[0].choices)
    assert len(part.tasks(QUICK)) == 1


def test_rows_and_pictures_are_made_from_what_was_found():
    found = {one: beside() for one in part.tasks(STANDARD)}
    assert len(part.rows(found, STANDARD)) == len(part.tasks(STANDARD))
    assert set(part.draw(found, STANDARD)) == {"fig17-egashira-speed", "fig17-egashira-concentration"}
