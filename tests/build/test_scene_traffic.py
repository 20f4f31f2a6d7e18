"""Feeds, exits and materials in a scene that is built from arrays."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ryusa import build, run_scene
from ryusa.casefile.read import read_text
from ryusa.errors import CaseError
from ryusa.laws.families import Arm, DampingLaw, Rolling
from ryusa.model import RollingLaw
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.feeds import IN, OUT
from ryusa.model.scene import EventRule
from ryusa.results.scene_file import scene_digest
from ryusa.running.stops import Stop

D, G = 2.0e-3, 9.80665
CASE = """
seed = 5
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.2
mixture = { glass = 0.5 }
[materials.glass]
density = "2500 kg/m3"
friction = 0.3
MATERIAL
[materials.steel]
restitution = 0.6
[[pairs]]
materials = ["grains", "glass"]
friction = 0.4
[[pairs]]
materials = ["glass", "steel"]
friction = 0.2
restitution = 0.5
[[pairs]]
materials = ["grains", "steel"]
restitution = 0.8
rolling_coefficient = 0.05
[contact]
CONTACT
restitution = 0.7
friction = 0.5
[rolling]
model = "spring-dashpot-slider"
arm = "reduced radius"
coefficient = 0.1
[motion]
rotation = "free"
plane = false
[build]
kind = "fill"
low = ["0 cm", "0 cm", "0 cm"]
high = ["1 cm", "1 cm", "0.5 cm"]
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
material = "steel"
[[walls]]
name = "arm"
shape = "rectangle"
at = ["2 cm", "0 cm", "2 cm"]
sides = [["1 cm", "0 cm", "0 cm"], ["0 cm", "1 cm", "0 cm"]]
angular_velocity = ["0 rad/s", "0 rad/s", "3 rad/s"]
axis_point = ["2 cm", "0 cm", "2 cm"]
[[feeds]]
name = "hose"
centre = ["0 cm", "0 cm", "5 cm"]
radius = "1 cm"
normal = [1, 0, -2]
rate = "100 grains/s"
velocity = ["0 m/s", "0 m/s", "-1 m/s"]
material = "glass"
[[feeds]]
name = "tray"
low = ["2 cm", "0 cm", "3 cm"]
high = ["3 cm", "1 cm", "4 cm"]
rate = "1 g/s"
begin = "0.02 s"
moves_with = "arm"
[[exits]]
name = "rim"
point = ["8 cm", "0 cm", "-1 cm"]
normal = [3, 0, -3]
to = "hose"
[[exits]]
name = "sieve"
low = ["5 cm", "0 cm", "0 cm"]
high = ["6 cm", "1 cm", "1 cm"]
[stop]
time = "0.1 s"
"""
LINEAR = CASE.replace("CONTACT", 'stiffness = "1 N/mm"').replace("MATERIAL", 'stiffness = "2 N/mm"')
ELASTIC = CASE.replace(
    "CONTACT",
    'law = "Hertz-Mindlin"\nyoungs_modulus = "10 MPa"\npoisson_ratio = 0.3\nexpected_speed = "1 m/s"',
).replace("MATERIAL", 'youngs_modulus = "40 MPa"\npoisson_ratio = 0.2')
ARM = build.rectangle("arm", (0.02, 0, 0.02), (0.01, 0, 0), (0, 0.01, 0))
ARM = replace(ARM, motion=build.WallMotion(spin=(0, 0, 3.0), axis_point=(0.02, 0, 0.02)))


def hose(d=(D,) * 20, rate=100.0, **keys):
    plain = {"centre": (0, 0, 0.05), "radius": 0.01, "normal": (1, 0, -2), "velocity": (0, 0, -1.0)}
    return build.feed_disc("hose", d, rate, **plain | keys)


@pytest.mark.parametrize("elastic", [False, True])
def test_arrays_give_the_scene_of_the_same_case(elastic: bool) -> None:
    by_case = build.build(read_text(ELASTIC if elastic else LINEAR)).scene
    assert by_case.traffic is not None
    assert by_case.materials is not None
    first, (one, other) = by_case.traffic.n_first, by_case.traffic.feeds
    d = by_case.d
    state = build.build(read_text(ELASTIC if elastic else LINEAR)).state
    law = None
    if elastic:
        m = 2650.0 * math.pi / 6.0 * D**3
        law = elastic_spheres(
            m, 0.25 * D, youngs_modulus=1.0e7, poisson_ratio=0.3, speed=1.0, damping_law=DampingLaw.THORNTON
        )
    glass = {"youngs_modulus": 4.0e7, "poisson_ratio": 0.2} if elastic else {"stiffness": 2.0e3}
    names = np.array(by_case.materials.names)[by_case.materials.of[:first]]
    scene, begun = build.scene(
        state.x[:first], d[:first], stiffness=1.0e3, friction=0.5, contact=law, seed=5,
        planes=[("floor", (0, 0, 0), (0, 0, 1))], walls=[ARM], dt=by_case.dt,
        rolling=RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, coefficient=0.1),
        feeds=[
            hose(d[one.first : one.first + one.count]),
            build.feed_box(
                "tray", d[other.first :], 1.0e-3, (0.02, 0, 0.03), (0.03, 0.01, 0.04), by_mass=True,
                begin=0.02, moves_with="arm",
            ),
        ],
        exits=[
            build.exit_plane("rim", (0.08, 0, -0.01), (3, 0, -3), to="hose"),
            build.exit_box("sieve", (0.05, 0, 0), (0.06, 0.01, 0.01)),
        ],
        materials=[
            build.Material("glass", density=2500.0, friction=0.3, **glass),
            build.Material("steel", restitution=0.6),
        ],
        pairs=[
            build.MaterialPair(("grains", "glass"), friction=0.4),
            build.MaterialPair(("steel", "glass"), friction=0.2, restitution=0.5),
            build.MaterialPair(("grains", "steel"), restitution=0.8, rolling_coefficient=0.05),
        ],
        made_of={"grains": names.tolist(), "hose": "glass", "floor": "steel"},
    )  # fmt: skip
    assert np.array_equal(begun.present, state.present)
    assert scene.traffic is not None
    assert scene.materials is not None
    ends = tuple(
        replace(a, end=b.end) for a, b in zip(scene.traffic.feeds, by_case.traffic.feeds, strict=True)
    )
    scene = replace(scene, traffic=replace(scene.traffic, feeds=ends))  # arrays end where their grains do
    assert scene.traffic == by_case.traffic
    assert scene.m == pytest.approx(by_case.m, rel=1e-12)
    for mine, theirs in zip(scene.materials.contact, by_case.materials.contact, strict=True):
        for name, value in vars(theirs).items():
            close = 0.1 if elastic and name in {"k_n", "k_s"} else 1e-12  # of linear springs beside them
            assert getattr(mine, name) == pytest.approx(value, rel=close, nan_ok=True), name
    alike = replace(
        scene, materials=replace(scene.materials, contact=by_case.materials.contact),
        contact=by_case.contact, world_low=by_case.world_low, world_high=by_case.world_high,
        events=EventRule.ALL,
    )  # fmt: skip
    assert scene_digest(alike) == scene_digest(replace(by_case, events=EventRule.ALL))


def test_a_law_keeps_its_own_dashpots_where_materials_ask_for_no_other_restitution() -> None:
    """Dashpots that no restitution gives are kept; another restitution of a material makes its own."""
    law = elastic_spheres(1.0, 0.01, youngs_modulus=1.0e7, speed=0.1, restitution=0.7)
    own = replace(law, zeta_n=0.5 * law.zeta_n, zeta_s=0.0)
    made, _ = build.scene(
        [[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]], 0.02, contact=own, dt=1.0e-5,
        materials=[build.Material("light", density=1200.0), build.Material("dull", restitution=0.5)],
        pairs=[build.MaterialPair(("light", "dull"), restitution=0.7)],
        made_of={"grains": ["light", "dull"]},
    )  # fmt: skip
    assert made.materials is not None
    names, n = made.materials.names, len(made.materials.names)
    light, dull = names.index("light"), names.index("dull")
    both, other = made.materials.contact[light * n + dull], made.materials.contact[dull * n + dull]
    assert (both.zeta_n, both.zeta_s) == (own.zeta_n, own.zeta_s)
    assert other.zeta_n > law.zeta_n
    assert other.zeta_s > 0.0


def test_the_step_is_that_of_the_stiffest_pair_that_meets() -> None:
    keys = {"x": [[0, 0, 0.01], [0, 0, 0.02]], "d": D, "planes": [("floor", (0, 0, 0), (0, 0, 1))]}
    plain, _ = build.scene(**keys)
    assert build.scene(**keys, dt=None)[0].dt == plain.dt
    hard = [build.Material("hard", stiffness=4.0e4)]
    both, _ = build.scene(**keys, materials=hard, made_of={"grains": "hard"})
    assert both.dt == pytest.approx(0.5 * plain.dt, rel=1e-12)
    floor, _ = build.scene(**keys, materials=hard, made_of={"floor": "hard"})
    assert floor.dt == plain.dt  # a whole grain on springs in series is slower than two halves


@pytest.mark.full
def test_poured_grains_fall_leave_and_come_in_again(tmp_path: Path) -> None:
    feed = hose(rate=80.0, normal=(0, 0, -1), centre=(0, 0, 0.1), velocity=(0, 0, -0.5))
    out = build.exit_plane("below", (0, 0, 0), (0, 0, -1), to="hose")
    scene, state = build.scene((), D, feeds=[feed], exits=[out])
    run = run_scene(scene, state, tmp_path / "run", frames=0.02, stop=Stop(time=0.4), progress=False)
    rows = run.passages
    came, left = rows[rows["way"] == IN], rows[rows["way"] == OUT]
    first = came[np.unique(came["grain"], return_index=True)[1]]
    np.testing.assert_allclose(np.sort(first["t"]), np.arange(20) / 80.0, atol=1e-12)
    taken = (math.sqrt(0.25 + 2.0 * G * 0.1) - 0.5) / G
    assert left["t"][0] == pytest.approx(taken, rel=1e-9)
    assert len(came) > 20  # with those that came in again
    there = np.isfinite(run.frames.x[-1][:, 0]).sum()
    assert there == len(came) - len(left)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"x": ()}, "x: needs at least one grain, here or in a feed"),
        ({"feeds": [hose(rate=0.0)]}, "feeds.0.rate = 0.0: must be finite and greater than 0"),
        ({"feeds": [hose((), rate=0.0)]}, "feeds.0.d: brings no grain"),
        ({"feeds": [hose([[D]])]}, "feeds.0.d: must have shape (n,)"),
        ({"feeds": [hose(radius=0.4 * D)]}, "feeds.0.radius = 0.0008: must be finite and at least 0.001 m"),
        ({"feeds": [hose(rate=1.0e6)]}, "feeds.0.rate = 1000000.0: cannot fit"),
        ({"feeds": [hose(), hose()]}, "feeds.1.name = 'hose': is used twice"),
        ({"feeds": [hose(moves_with="drum")], "walls": [ARM]}, "must be one of the walls: arm"),
        (
            {"feeds": [hose()], "exits": [build.exit_plane("out", (0, 0, 0.06), (0, 0, -1))]},
            "exits.0 = 'out': holds a part of feed 'hose'",
        ),
        (
            {"feeds": [hose()], "exits": [build.exit_plane("out", (0, 0, 0), (0, 0, -1), to="hoze")]},
            "exits.0.to = 'hoze': must be a feed: hose. Did you mean 'hose'?",
        ),
        (
            {"exits": [build.exit_plane("out", (0.1, 0, 0), (1, 0, 0))], "period": (0.1, math.inf)},
            "exits.0.normal = (1.0, 0.0, 0.0): must have x = 0, because it is periodic",
        ),
        ({"exits": [build.exit_box("out", (0, 0, 0), (1, 0, 1))]}, "must lie below exits.0.high"),
        ({"made_of": {"grains": "steel"}}, "made_of: needs materials"),
        ({"materials": [build.Material("steel")]}, "materials = 'steel': is never used"),
        (
            {"materials": [build.Material("steel")], "made_of": {"flor": "steel"}},
            "must be a group, a plane or a wall: grains, floor. Did you mean 'floor'?",
        ),
        (
            {"materials": [build.Material("steel")], "made_of": {"floor": "stel"}},
            "must be a material: grains, steel. Did you mean 'steel'?",
        ),
        (
            {"materials": [build.Material("steel", friction=0.1)], "made_of": {"floor": "steel"}},
            "pairs (grains, steel): friction: missing; grains has 0.5774 and steel 0.1, and no law",
        ),
        (
            {"materials": [build.Material("steel", youngs_modulus=1e9)], "made_of": {"floor": "steel"}},
            "has no effect with the laws of the scene",
        ),
        (
            {"materials": [build.Material("steel", restitution=1.2)], "made_of": {"floor": "steel"}},
            "materials (steel).restitution = 1.2: must be greater than 0 and at most 1",
        ),
        ({"walls": [ARM, ARM]}, "walls = 'arm': is the name of another wall, plane or group already"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_named(keys, said) -> None:
    plain = {"x": [[0, 0, 0.01]], "d": D, "planes": [("floor", (0, 0, 0), (0, 0, 1))]}
    with pytest.raises(CaseError) as found:
        build.scene(**plain | keys)
    assert said in str(found.value)
