"""Materials with sizes of their own: what feeds bring, what builders lay, what a bad one gets."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import derive, read_text
from ryusa.casefile.explain import explain
from ryusa.casefile.resolved import resolved
from ryusa.errors import CaseError
from ryusa.measure import sizes
from ryusa.model.grading import Grading

SAND = '[["1 mm", 0], ["2 mm", 50], ["3 mm", 100]]'
ASKED = Grading.of([(0.001, 0.0), (0.002, 0.5), (0.003, 1.0)])
TEXT = f"""
seed = 2
[grains]
diameter = "8 mm"
density = "2650 kg/m3"
mixture = {{ pea = 0.5 }}
[materials.pea]
diameter = "3.5 mm"
spread = 0.1
[materials.sand]
sieve_curve = {SAND}
density = "2000 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "fill"
low = ["0 cm", "0 cm", "0 cm"]
high = ["4 cm", "4 cm", "4 cm"]
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
[[feeds]]
name = "hose"
centre = ["2 cm", "2 cm", "6 cm"]
radius = "3.5 mm"
rate = "0.01 kg/s"
velocity = ["0 m/s", "0 m/s", "-0.5 m/s"]
material = "sand"
[stop]
time = "0.2 s"
"""


def changed(*changes: tuple[str, str]) -> Any:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return read_text(text)


def test_a_feed_brings_the_curve_of_its_material_at_its_rate() -> None:
    scene = build(changed()).scene
    begin, end = scene.groups["hose"]
    d, m = scene.d[begin:end], scene.m[begin:end]
    assert m == pytest.approx(2000.0 * np.pi / 6.0 * d**3, rel=1e-12)
    assert m.sum() == pytest.approx(0.01 * 0.2, abs=m.max())
    share = d[d < 0.002] ** 3
    assert share.sum() / (d**3).sum() == pytest.approx(0.5, abs=0.02)
    assert 0.001 <= d.min() < d.max() <= 0.003


def test_the_builder_lays_each_material_in_its_size() -> None:
    made = build(changed())
    assert made.scene.traffic is not None
    assert made.scene.materials is not None
    n = made.scene.traffic.n_first
    d, of = made.scene.d[:n], made.scene.materials.of[:n]
    pea = of == made.scene.materials.names.index("pea")
    assert pea.sum() == round(0.5 * n)
    assert np.all(d[~pea] == 0.008)
    assert np.all((d[pea] >= 0.9 * 0.0035) & (d[pea] <= 1.1 * 0.0035))
    assert len(set(d[pea].tolist())) > 5
    assert n > 4**3  # eight small ones in the cell of a large one
    assert derive(changed()).n_grain == made.scene.n_grain
    assert np.all(made.state.x[:n] - 0.5 * d[:, None] >= -1e-12)
    assert np.all(made.state.x[:n] + 0.5 * d[:, None] <= 0.04 + 1e-12)


@pytest.mark.parametrize("kind", ["packing", "flume", "box"])
def test_every_builder_that_draws_sizes_lays_them(kind: str) -> None:
    block = {
        "packing": 'columns = 5\nrows = 4\nlayers = 6\nbed = "plane"',
        "flume": 'length = "5 cm"\nwidth = "4 cm"\nlayers = 4\nbed = "plane"',
        "box": 'columns = 5\nrows = 4\nlayers = 6\nfloor = "plane"',
    }[kind]
    old = TEXT[TEXT.index('kind = "fill"') : TEXT.index("[[planes]]")]
    floor = TEXT[TEXT.index("[[planes]]") : TEXT.index("[[feeds]]")]
    scene = build(changed((old, f'kind = "{kind}"\n{block}\n'), (floor, ""))).scene  # or it refuses overlaps
    assert scene.traffic is not None
    d = scene.d[: scene.traffic.n_first]
    small = d < 0.004
    assert small.sum() == pytest.approx(0.5 * len(d), abs=1)
    if kind == "flume":  # the volume of its layers of 8 mm
        assert (d**3).sum() == pytest.approx(4 * int(0.05 / 0.008) * int(0.04 / 0.008) * 0.008**3, rel=0.05)


def test_the_step_follows_the_smallest_grains_that_meet() -> None:
    one = derive(changed())
    assert (one.d, one.d_min, one.d_max) == (0.008, 0.001, 0.008)
    finer = derive(changed((SAND, '[["0.5 mm", 0], ["3 mm", 100]]')))
    assert finer.dt / one.dt == pytest.approx(0.5**1.5, rel=1e-9)
    coarse = derive(
        changed(
            ('material = "sand"', ""), (f"sieve_curve = {SAND}\n", ""),
            ('radius = "3.5 mm"', 'radius = "5 mm"'),
            ("[materials.sand]", "[materials.light]"), ("{ pea", "{ light = 0.1, pea"),
        )
    )  # fmt: skip
    # light grains of 8 mm meet peas of 3.15 mm: as two of 3.15 mm with the density of such a pair
    assert coarse.d_min == pytest.approx(0.9 * 0.0035)
    mean = 2.0 * 2000.0 * 2650.0 / 4650.0
    assert coarse.shortest / one.shortest == pytest.approx((mean / 2000.0) ** 0.5 * 3.15**1.5, rel=1e-9)


def test_a_hose_too_narrow_for_the_gravel_of_the_bed_brings_sand() -> None:
    with pytest.raises(CaseError, match=r"feeds.0.radius .*: is too small for the largest grain"):
        changed(
            ('material = "sand"', ""),
            ("[materials.sand]", ""),
            (f"sieve_curve = {SAND}\n", ""),
            ('density = "2000 kg/m3"\n', ""),
        )
    assert changed().feeds[0].radius == 0.0035


def test_check_says_what_is_laid_and_fed_and_the_case_is_read_again_from_its_values() -> None:
    rows = {row.name: row for row in explain(changed())}
    assert rows["diameters of pea"].shown == "0.315 to 0.385 cm"
    assert rows["D50 of sand"].value == pytest.approx(0.002)
    assert rows["feed 'hose'"].shown.endswith("0.01 kg/s")
    kept = resolved(changed())
    assert kept["materials"]["sand"]["sieve_curve"][1] == pytest.approx([0.002, 50.0])


def test_sizes_of_one_material_stand_beside_its_own_curve() -> None:
    case = changed()
    run: Any = SimpleNamespace(scene=build(case).scene, case=resolved(case))
    found = sizes(run, "sand")
    assert found.asked is not None
    assert found.asked.finer == pytest.approx(ASKED.finer)
    assert found.difference < 0.02
    assert sizes(run).asked is None  # all grains together have no one curve
    assert sizes(run, "grains").laid.diameter(0.5) == pytest.approx(0.008)
    with pytest.raises(CaseError, match=r"^material = 'sandd': must be a material .* Did you mean 'sand'"):
        sizes(run, "sandd")


SAID = "materials.sand.sieve_curve"
BAD = {
    "a curve and a diameter": (
        f"sieve_curve = {SAND}",
        f'sieve_curve = {SAND}\ndiameter = "2 mm"',
        f"materials.sand.diameter: excludes {SAID}",
    ),
    "a curve that falls": (SAND, '[["1 mm", 0], ["2 mm", 50], ["1.5 mm", 100]]', f"{SAID}.2: diameters must"),
    "an open end": (SAND, '[["1 mm", 10], ["2 mm", 100]]', f"{SAID}: goes from 10 to 100 % finer"),
    "sizes of no grain": ('material = "sand"', "", f"{SAID}: has no effect: no free grain"),
    "a bare number": ('diameter = "3.5 mm"', "diameter = 3.5", "materials.pea.diameter"),
    "a misspelt key": ('diameter = "3.5 mm"', 'diametre = "3.5 mm"', "Did you mean 'materials.pea.diameter'"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_sizes_of_a_material_are_named(name: str) -> None:
    old, new, fault = BAD[name]
    text = TEXT.replace(old, new)
    if name == "sizes of no grain":
        lid = '[[walls]]\nname = "lid"\nshape = "disc"\nat = ["2 cm", "2 cm", "9 cm"]\nnormal = [0, 0, 1]\n'
        lid += 'radius = "1 cm"\nmaterial = "sand"\n'
        text = text.replace("[[feeds]]", lid + "[[feeds]]").replace('radius = "3.5 mm"', 'radius = "5 mm"')
    with pytest.raises(CaseError) as caught:
        read_text(text)
    assert fault in str(caught.value)
