"""Films of water between grains: the rebound each law names, and what a film takes before touch."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, bits, pile, run
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws import immersed
from ryusa.laws.families import Drag, Profile, Rebound
from ryusa.laws.reduced import reduced
from ryusa.model import ContactLaw, Term, Water
from ryusa.model.scene import Damping

NU, RHO, E_DRY, ROUGH = 1.0e-6, 1000.0, 0.9, 2.0e-5
STILL = Water(profile=Profile.STILL, drag=Drag.NONE, nu=NU, asperity=ROUGH)
LAWS = {
    Rebound.EXPONENTIAL: lambda st: immersed.restitution_exponential(E_DRY, st, 35.0),
    Rebound.DAVIS: lambda st: immersed.restitution_davis(E_DRY, st, ROUGH, D),
}
PARTNERS = ("wall", "fixed", "free")
NAMES = {"wall": (1.0, math.inf, math.inf), "fixed": (1.0, math.inf, 1.0), "free": (1.0, 1.0, 1.0)}


def meet(st, partner, water, per_contact=300.0, gap=1.0e-6, wide=False, e_dry=E_DRY, **more):
    """Two grains, or one and a wall, about to meet at a Stokes number; the scene, its state and the speed."""
    plane_case = not wide
    common = {"restitution": e_dry, "gravity": 0.0, "plane_case": plane_case, "water": water}
    common |= {"steps_per_contact": per_contact} | more
    probe, _ = scene([[0.0, 0.0, 1.0]], D, **common)
    _, other, size = NAMES[partner]
    m = reduced(float(probe.m[0] + probe.m_added[0]), float(probe.m[0] + probe.m_added[0]) * other)
    speed = st / immersed.stokes_number(1.0, m, reduced(0.5 * D, 0.5 * D * size), RHO, NU)
    n = np.array([0.6, 0.0, 0.8]) if plane_case else np.array([0.48, 0.6, 0.64])
    far = D + gap if partner != "wall" else 0.5 * D + gap
    if partner == "wall":
        made = scene([far * n], D, v=[-speed * n], planes=[("wall", (0, 0, 0), n)], **common)
    elif partner == "fixed":
        made = scene([far * n], D, v=[-speed * n], x_fixed=[[0.0, 0.0, 0.0]], d_fixed=D, **common)
    else:
        v = [-0.5 * speed * n, 0.5 * speed * n]
        made = scene([far * n, [0.0, 0.0, 0.0]], D, v=v, **common)
    return made, speed


def rebound(st, partner, water, per_contact=300.0, **more):
    """Restitution of one contact."""
    made, speed = meet(st, partner, water, per_contact, **more)
    engine = CpuEngine()
    engine.load(*made)
    wait = int(1.0e-6 / (speed * made[0].dt)) + 2
    for _ in range(60):
        engine.advance(wait + int(2.0 * per_contact)).raise_if_any()
        events = engine.events()
        if len(events):
            return -float(events["closing_end"][0] / events["closing_begin"][0]), engine
    raise AssertionError("still in touch")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("st", [5.0, 15.0, 50.0, 200.0, 1000.0])
@pytest.mark.parametrize("partner", PARTNERS)
def test_a_grain_rebounds_with_the_restitution_of_its_stokes_number(law, st, partner):
    expected = max(LAWS[law](st), 0.01)
    got, engine = rebound(st, partner, replace(STILL, rebound=law))
    assert got == pytest.approx(expected, rel=0.02, abs=1e-3)
    assert engine.tally().residual < 1e-3


@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize(
    "rotation, wide", full_but([(False, False), (True, False)], [(False, False), (True, False), (True, True)])
)
def test_the_rebound_is_the_same_however_contacts_part_and_grains_move(tension, rotation, wide):
    water = replace(STILL, rebound=Rebound.EXPONENTIAL)
    got, _ = rebound(40.0, "wall", water, tension=tension, rotation=rotation, wide=wide)
    assert got == pytest.approx(LAWS[Rebound.EXPONENTIAL](40.0), rel=0.02)


def test_a_step_of_fifty_to_a_contact_resolves_the_rebound():
    water = replace(STILL, rebound=Rebound.EXPONENTIAL)
    for st in (20.0, 50.0, 200.0):
        got, _ = rebound(st, "wall", water, per_contact=50.0)
        assert got == pytest.approx(LAWS[Rebound.EXPONENTIAL](st), rel=0.08)


@pytest.mark.full
@pytest.mark.parametrize("st", [20.0, 100.0])
@pytest.mark.parametrize("partner", PARTNERS)
def test_a_film_slows_the_approach_by_its_closed_form(st, partner):
    reach = 0.2 * D
    water = replace(STILL, film_reach=reach)
    made, speed = meet(st, partner, water, per_contact=1000.0, gap=1.2 * reach, stiffness=1.0e5, e_dry=0.99)
    engine = CpuEngine()
    engine.load(*made)
    first = np.zeros(0)
    while first.size == 0:
        engine.advance(200).raise_if_any()
        first = engine.events()["closing_begin"]
    # m dv = -6 pi mu r**2 (1/(gap + rough) - 1/(reach + rough)) dgap
    taken = (math.log((reach + ROUGH) / ROUGH) - reach / (reach + ROUGH)) / st
    assert first[0] / speed == pytest.approx(1.0 - taken, rel=0.01)
    engine.advance(2000).raise_if_any()
    account = engine.tally()
    assert account.terms[Term.FILM] > 0.0
    assert account.residual < 1e-3


@pytest.mark.full
def test_a_film_resists_separation_as_much_as_approach():
    reach = 0.2 * D
    water = replace(STILL, film_reach=reach)
    made, speed = meet(-100.0, "free", water, gap=0.0)
    engine = run(made, int(1.5 * reach / (abs(speed) * made[0].dt)))
    state = engine.state()
    apart = float(np.linalg.norm(state.v[0] - state.v[1]))
    taken = (math.log((reach + ROUGH) / ROUGH) - reach / (reach + ROUGH)) / 100.0
    assert apart / abs(speed) == pytest.approx(1.0 - taken, rel=0.01)


BOTH = {
    "films, 3D": ({}, replace(STILL, drag=Drag.RE_04, film_reach=0.1 * D)),
    "films, plane": ({"plane_case": True}, replace(STILL, drag=Drag.RE_04, film_reach=0.1 * D)),
    "rebound, 3D": ({}, replace(STILL, rebound=Rebound.EXPONENTIAL)),
    "rebound, plane": ({"plane_case": True}, replace(STILL, rebound=Rebound.DAVIS)),
}


@pytest.mark.full
@pytest.mark.parametrize("kind", BOTH)
def test_threads_calls_and_a_resume_do_not_change_a_bit(kind):
    more, water = BOTH[kind]
    made = pile(n=600, water=water, **more)
    whole = run(made, 900)
    split = CpuEngine(threads=2)
    split.load(*made)
    for n in (1, 7, 392, 500):
        split.advance(n).raise_if_any()
    resumed = CpuEngine()
    resumed.load(made[0], run(made, 555).state())
    resumed.advance(900 - 555).raise_if_any()
    for other in (split, resumed):
        assert bits(other.state()) == bits(whole.state())
        assert other.tally() == whole.tally()
    assert whole.tally().residual < 1e-3
    assert whole.tally().n_contact > 0


@pytest.mark.full
@pytest.mark.parametrize("wide", [False, True])
def test_films_between_free_grains_keep_their_momentum(wide):
    made = pile(n=400, plane_case=not wide, water=replace(STILL, film_reach=0.1 * D))
    bare = replace(
        made[0], x_fixed=np.zeros((0, 3)), d_fixed=np.zeros(0), fixed_active=np.zeros(0, dtype=np.bool_),
        gravity=np.zeros(3), m_added=np.zeros_like(made[0].m),
    )  # fmt: skip
    state = run((bare, made[1]), 400).state()
    assert (bare.m @ state.v) == pytest.approx(bare.m @ made[1].v, abs=1e-12 * float(bare.m.sum()))


def test_constant_dashpots_have_no_immersed_rebound():
    law = ContactLaw(1e4, 3e3, 0.5, damping=Damping.CONSTANTS, eta_n=0.1)
    water = replace(STILL, rebound=Rebound.EXPONENTIAL)
    made = scene([[0.0, 0.0, 1.0]], D, contact=law, water=water, dt=1e-6)
    with pytest.raises(ValueError, match="restitution in air"):
        CpuEngine().load(*made)
