"""grains.shape of the case file: what it becomes, and what bad ones get."""

from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile.derive import derive
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read, read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import CaseError
from ryusa.laws.families import ContactTiming, DragOfForm
from ryusa.model.clump import drag_form, shape
from ryusa.running.case_files import files_beside

PLAIN = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "1e4 N/m"
friction = 0.5
restitution = 0.7
[motion]
plane = false
rotation = "free"
[build]
kind = "box"
columns = 6
rows = 5
layers = 6
floor = "plane"
[stop]
time = "0.01 s"
[record]
frames = "1 ms"
"""
SPHERES = "x [mm],y [mm],z [mm],d [mm]\n0,0,0,1\n0.6,0,0,0.8\n"


def case_of(given, text=PLAIN, **more):
    return read_text(text.replace("spread = 0.2", f"spread = 0.2\nshape = {given}"), more)


def faults(given, **more):
    with pytest.raises(CaseError) as found:
        case_of(given, **more)
    return str(found.value)


def test_shares_are_by_number_and_the_rest_are_spheres():
    made = build(case_of("{ rod = 0.5, tetrahedron = 0.3 }"))
    bodies = made.scene.bodies
    assert bodies.names == ("rod", "tetrahedron")
    assert np.bincount(bodies.form).tolist() == [90, 54]
    assert made.scene.n_grain == 90 * 3 + 54 * 4 + 36
    d, m = made.scene.whole_grains()
    assert len(d) == 180
    assert m == pytest.approx(2650.0 * np.pi / 6.0 * d**3)
    assert 0.0016 <= d.min() < d.max() <= 0.0024
    again = build(case_of("{ rod = 0.5, tetrahedron = 0.3 }"))
    assert np.array_equal(again.state.x, made.state.x)
    other = build(case_of("{ rod = 0.5, tetrahedron = 0.3 }", seed=2))
    assert not np.array_equal(other.state.bodies.q, made.state.bodies.q)


def test_the_step_follows_the_least_effective_mass_and_contacts_are_at_steps():
    case, spheres = case_of('"rod"'), case_of('"sphere"', **{"contact.timing": "at steps"})
    assert build(case).scene.contact.timing is ContactTiming.AT_STEPS
    lighter = shape("rod").least_mass
    assert derive(case).shortest == pytest.approx(derive(spheres).shortest * lighter**0.5)
    assert derive(case).dt == pytest.approx(derive(spheres).dt * lighter**0.5)
    rows = {row.name: row for row in explain(case)}
    assert rows["shape 'rod'"].value == "100 %"
    assert "3 spheres" in rows["shape 'rod'"].origin
    assert rows["shape 'rod'"].origin.endswith(f"volume and inertia {shape('rod').precision}")
    assert rows["spheres to compute"].value == 540
    assert rows["least effective mass of a clump"].value == pytest.approx(lighter)
    elastic = PLAIN.replace(
        'stiffness = "1e4 N/m"',
        'law = "Hertz-Mindlin"\nyoungs_modulus = "1e8 Pa"\nexpected_speed = "0.2 m/s"',
    )
    assert derive(case_of('"rod"', elastic)).shortest == pytest.approx(
        derive(case_of('"sphere"', elastic)).shortest * lighter**0.4
    )
    assert CpuEngine().refuses(build(case_of('"rod"', elastic)).scene) == ()


def test_a_file_of_spheres_is_read_and_kept_beside_the_run(tmp_path: Path):
    (tmp_path / "flint.csv").write_text(SPHERES)
    path = tmp_path / "case.toml"
    path.write_text(PLAIN.replace("spread = 0.2", 'shape = { "flint.csv" = 0.5 }'))
    case = read(path)
    made = build(case)
    assert made.scene.bodies.count.tolist() == [2] * 90
    assert made.scene.bodies.d == pytest.approx(np.full(90, 0.002))
    assert files_beside(case) == {"flint.csv": tmp_path / "flint.csv"}
    (tmp_path / "flint.csv").write_text(SPHERES.replace("0.6,0", "6,0"))
    with pytest.raises(CaseError, match=r"flint\.csv.*not joined to sphere 0"):
        read(path)


BAD = [
    ('"rodd"', "Did you mean 'rod'"),
    ('"none.csv"', "no such file in the folder of the case"),
    ('"../flint.csv"', "inside the folder of the case"),
    ("{ rod = 0.8, disc = 0.4 }", "the shares add up to 1.2: at most 1"),
    ("{ rod = 0.0 }", "must be greater than 0"),
    ("{ rodd = 0.5 }", "Did you mean 'rod'"),
    ("3", "grains.shape"),
]


@pytest.mark.parametrize(("given", "part"), BAD)
def test_a_bad_shape_gets_one_message(given, part):
    assert part in faults(given)


@pytest.mark.parametrize(
    ("more", "part"),
    [
        ({"contact.timing": "exact"}, "must be 'at steps' (or left out) with clumps"),
        ({"motion.plane": True, "build.rows": 1}, "needs motion in space"),
        ({"motion.rotation": "locked"}, "needs motion.rotation = 'free'"),
        ({"grains.shape_volume": 0.5}, "excludes grains.shape"),
    ],
)
def test_what_excludes_clumps_is_said_with_its_key(more, part):
    assert part in faults('"rod"', **more)


WET = PLAIN + '[water]\nprofile = "uniform"\nspeed = "0.1 m/s"\ndrag = "Schiller-Naumann"\n'


def test_water_acts_on_clumps_by_their_form_and_check_says_how_fast_they_settle():
    case = case_of('{ rod = 0.5, "blade" = 0.5 }', WET)
    made = build(case)
    assert made.scene.water.drag_of_form is DragOfForm.BAGHERI_BONADONNA
    rows = drag_form(DragOfForm.BAGHERI_BONADONNA, shape("rod"), 2.65)
    assert made.scene.bodies.drag_form[made.scene.bodies.form == 0] == pytest.approx(np.tile(rows, (90, 1)))
    assert made.scene.m_weight.sum() == pytest.approx(made.scene.m.sum() * 1.65 / 2.65)
    assert CpuEngine().refuses(made.scene) == ()
    printed = {row.name: row for row in explain(case)}
    sphere, rod, blade = (
        printed[name].value
        for name in ("settling velocity", "settling velocity of 'rod'", "settling velocity of 'blade'")
    )
    assert sphere > rod > blade > 0.4 * sphere
    assert "Dietrich 1982" in printed["settling velocity of 'rod'"].origin
    as_sphere = case_of('"rod"', WET + 'drag_of_form = "sphere"\n')
    rows = {row.name: row for row in explain(as_sphere)}
    assert rows["settling velocity of 'rod'"].value == pytest.approx(sphere)
    assert build(case_of('"sphere"', WET)).scene.water.drag_of_form is DragOfForm.SPHERE


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ('rebound = "exponential"', "water.rebound"),
        ('film = "lubrication"\nasperity = "1 um"', "water.film"),
        ("shape_area = 0.7", "refers to pi/4 d^2"),
        ('drag_of_form = "Gansr"', "Did you mean 'Ganser'"),
    ],
)
def test_what_clumps_in_water_exclude_is_said_with_its_key(keys, part):
    with pytest.raises(CaseError) as found:
        case_of('"rod"', WET + keys + "\n")
    assert part in str(found.value)


def test_a_drag_of_form_needs_clumps():
    with pytest.raises(CaseError, match="has no effect without clumps"):
        case_of('"sphere"', WET + 'drag_of_form = "Ganser"\n')


FEED = """
[[feeds]]
name = "tap"
low = ["0 cm", "0 cm", "3 cm"]
high = ["1 cm", "1 cm", "4 cm"]
rate = "0.001 kg/s"
"""


def test_a_feed_brings_clumps_by_their_number_and_mass():
    case = case_of("{ rod = 0.5, tetrahedron = 0.25 }", PLAIN + FEED, **{"stop.time": "10 s"})
    scene = build(case).scene
    feed, heads = scene.traffic.feeds[0], scene.heads
    own = slice(feed.first, feed.first + feed.count)
    assert scene.traffic.n_first == feed.first
    assert heads[: feed.first].sum() == 180
    d, m = scene.of_heads()
    assert feed.first + feed.count == scene.n_grain
    fed = m[own][heads[own]]
    assert fed[:-1].sum() < 0.01 <= fed.sum()  # 0.001 kg/s in 10 s
    assert fed == pytest.approx(2650.0 * np.pi / 6.0 * d[own][heads[own]] ** 3)
    assert scene.groups["tap"] == (feed.first, feed.first + feed.count)
    state = build(case).state
    assert np.array_equal(state.present, np.arange(scene.n_grain) < feed.first)
    assert np.isnan(state.bodies.x[scene.bodies.first >= feed.first]).all()


def test_a_feed_leaves_room_for_clumps_however_they_are_turned():
    narrow = FEED.replace('"1 cm", "1 cm", "4 cm"', '"3 mm", "1 cm", "4 cm"')
    read_text(PLAIN + narrow, {"stop.time": "10 s"})
    with pytest.raises(CaseError, match="smaller than the largest grain"):
        case_of('"rod"', PLAIN + narrow, **{"stop.time": "10 s"})
