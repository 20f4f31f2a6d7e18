"""Settings of a sweep, from every way to ask for them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.campaigns.sweep.definition import axes_of, axes_of_words, is_sweep_file, read_sweep
from ryusa.campaigns.sweep.design import Span, SweepAxis, design_of, span_of
from ryusa.errors import CaseError

SLOPE = {"motion.slope": {"low": 0.01, "high": 0.02}}
DEPTH = {"water.depth": {"low": "4 cm", "high": "8 cm"}}


def test_a_grid_is_every_combination_and_keys_of_one_axis_change_together():
    axes = axes_of_words(["motion.slope=0.01,0.02", "grains.diameter='2 mm', 4 mm; build.layers=10,5"])
    found = design_of("grid", axes).settings
    assert [tuple(one.values()) for one in found] == [
        ("0.01", "2 mm", "10"), ("0.01", "4 mm", "5"), ("0.02", "2 mm", "10"), ("0.02", "4 mm", "5"),
    ]  # fmt: skip


def test_without_a_key_there_is_one_setting():
    assert design_of("grid", []).settings == ({},)


def test_every_stratum_of_a_latin_hypercube_holds_one_point():
    n = 16
    found = design_of("latin hypercube", axes_of({**SLOPE, **DEPTH}), points=n).settings
    for key, low, high in (("motion.slope", 0.01, 0.02), ("water.depth", 4.0, 8.0)):
        u = np.array([(float(one[key].split()[0]) - low) / (high - low) for one in found])
        assert sorted(np.floor(u * n).astype(int)) == list(range(n))
    assert all(one["water.depth"].endswith(" cm") for one in found)


def test_a_sobol_sequence_halves_each_range_evenly_and_repeats_with_its_seed():
    axes = axes_of({**SLOPE, **DEPTH})
    found = design_of("sobol", axes, points=8, seed=4).settings
    assert sum(float(one["motion.slope"]) < 0.015 for one in found) == 4
    assert found == design_of("sobol", axes, points=8, seed=4).settings
    assert found != design_of("sobol", axes, points=8, seed=5).settings


def test_levels_in_a_sampled_design_are_used_and_settings_alike_are_dropped():
    axes = axes_of({"motion.rotation": ["free", "locked"]})
    found = design_of("latin hypercube", axes, points=8)
    assert sorted(one["motion.rotation"] for one in found.settings) == ["free", "locked"]
    assert found.dropped == 6


@given(st.floats(0.0, 1.0, exclude_max=True), st.booleans())
def test_a_value_of_a_range_lies_in_it(u, log):
    assert 1.0 <= float(Span(1.0, 1000.0, log=log).at(u)) <= 1000.0
    assert 3 <= int(Span(3, 5, whole=True).at(u)) <= 5


def test_the_middle_of_a_log_range_is_the_geometric_mean():
    assert float(Span(2.0, 50.0, log=True).at(0.5)) == pytest.approx(math.sqrt(100.0))


SWEEP = """
[sweep]
case = "bed.toml"
design = "{design}"
{more}
seeds = 2
measure = ["transport", "water"]
set = {{ stop.time = "2 s" }}

{over}
"""


def write(tmp_path, over, design="grid", more=""):
    path = tmp_path / "sweep.toml"
    path.write_text(SWEEP.format(design=design, more=more, over=over))
    return path


def test_a_file_gives_the_same_settings_with_quoted_and_with_dotted_keys(tmp_path):
    quoted = '[[sweep.over]]\n"motion.slope" = [0.01, 0.02]\n"water.depth" = ["8 cm", "4 cm"]'
    path = write(tmp_path, quoted)
    assert is_sweep_file(path)
    found = read_sweep(path)
    assert found.case == tmp_path / "bed.toml"
    assert (found.seeds, found.measures) == (2, ("transport", "water"))
    assert found.overrides == {"stop.time": "2 s"}
    assert [dict(one) for one in found.design.settings] == [
        {"motion.slope": "0.01", "water.depth": "8 cm"},
        {"motion.slope": "0.02", "water.depth": "4 cm"},
    ]
    dotted = quoted.replace('"motion.slope"', "motion.slope").replace('"water.depth"', "water.depth")
    assert read_sweep(write(tmp_path, dotted)).design == found.design


def test_a_list_in_a_file_is_one_table_for_each_setting(tmp_path):
    over = "\n".join(
        f"[[sweep.over]]\nmotion.slope = {s}\nwater.depth = '{d}'"
        for s, d in ((0.01, "8 cm"), (0.03, "2 cm"))
    )
    found = read_sweep(write(tmp_path, over, "list")).design
    assert [tuple(one.values()) for one in found.settings] == [("0.01", "8 cm"), ("0.03", "2 cm")]


def test_a_hypercube_in_a_file(tmp_path):
    over = '[[sweep.over]]\nmotion.slope = { low = 0.01, high = 0.04, scale = "log" }'
    found = read_sweep(write(tmp_path, over, "latin hypercube", "points = 4")).design
    assert len(found.settings) == 4
    assert all(0.01 <= float(one["motion.slope"]) <= 0.04 for one in found.settings)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["motion.slope"], r"--over = 'motion.slope': needs KEY=VALUE"),
        (["motion.slope="], r"needs KEY=VALUE"),
        (["motion.slope=0.01,,0.02"], r"a value is empty"),
        (["motion.slope=0.01,0.01"], r"over motion.slope = '0.01': the value stands there twice"),
        (["motion.slope=0.01,0.02", "motion.slope=0.03"], r"over motion.slope: varies twice"),
        (["motion.slope=0.01,0.02; water.depth=1 cm"], r"motion.slope has 2, water.depth has 1"),
        (["seed=1,2"], r"over seed: is not varied by itself"),
    ],
)
def test_what_cannot_be_varied_is_refused_with_what_is_allowed(words, said):
    with pytest.raises(CaseError, match=said):
        design_of("grid", axes_of_words(words))


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"kind": "sobel"}, r"design = 'sobel'.*Did you mean 'sobol'"),
        ({"kind": "sobol"}, r"points: missing"),
        ({"kind": "sobol", "points": 6}, r"points = 6: must be a power of 2.*such as 4 or 8"),
        ({"kind": "latin hypercube", "points": 0}, r"points = 0: must be 1 to"),
        ({"kind": "grid"}, r"over motion.slope: is a range"),
        ({"kind": "sobol", "points": 4, "axes": []}, r"needs keys with ranges"),
        ({"kind": "grid", "points": 4, "axes": []}, r"points = 4: is for a design"),
        pytest.param(
            {"kind": "grid", "axes": [SweepAxis({"a": tuple(map(str, range(20_000)))})]},
            r"20,000 settings",
            marks=pytest.mark.full,
        ),
    ],
)
def test_designs_that_cannot_be_are_refused(how, said):
    with pytest.raises(CaseError, match=said):
        design_of(**{"axes": axes_of(SLOPE), **how})


@pytest.mark.parametrize(
    ("low", "high", "scale", "said"),
    [
        ("2 mm", "4 cm", "linear", r"must have one unit, not 'mm' and 'cm'"),
        ("4 mm", "2 mm", "linear", r"must be less than the high end"),
        (0.0, 1.0, "log", r"greater than 0"),
        ("wide", 1.0, "linear", r"must be a number"),
        (0.0, 1.0, "logarithmic", r"must be linear or log"),
    ],
)
def test_ranges_that_cannot_be_are_refused(low, high, scale, said):
    with pytest.raises(CaseError, match=said):
        span_of("key", low, high, scale)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[sweep]\ncase = 3", r"sweep.case = 3: must name a case file"),
        ("[sweep]\ncase = 'a.toml'\nmeasures = 'water'", r"sweep.measures: unknown key.*'measure'"),
        ("[sweep]\ncase = 'a.toml'\n[grains]\nspread = 0.1", r"grains: a sweep file has the table"),
        ("[sweep]\ncase = 'a.toml'\nseeds = 'two'", r"sweep.seeds = 'two': must be a number"),
        ("[sweep]\ncase = 'a.toml'\npoints = 1.5\ndesign = 'sobol'", r"sweep.points = 1.5: must be a whole"),
        ("[sweep]\ncase = 'a.toml'\ndesign_seed = 2", r"sweep.design_seed = 2: is for a sampled"),
        ("[sweep]\ncase = 'a.toml'\ndesign = 'list'\nover = [{a = 1}, {b = 2}]", r"same keys"),
        ("[sweep]\ncase = 'a.toml'\n[[sweep.over]]\na = {low = 1, hihg = 2}", r"a range has.*'high'"),
    ],
)  # fmt: skip
def test_faults_of_a_file_name_the_key(tmp_path, text, said):
    path = tmp_path / "sweep.toml"
    path.write_text(text)
    with pytest.raises(CaseError, match=said):
        read_sweep(path)
