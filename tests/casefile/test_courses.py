"""Quantities over time: hydrograph and stage at the ends of a row, sedigraph of a feed."""

import math

import numpy as np
import pytest
from tests.casefile.texts import FED, SAND

import ryusa
from ryusa.build import build
from ryusa.casefile import derive, read
from ryusa.casefile.feeds.values import fed_amount, fed_count, feed_end
from ryusa.casefile.read import read_text
from ryusa.casefile.row.ends import hydrograph_of, stage_of
from ryusa.casefile.row.values import row_plan
from ryusa.casefile.trial import read_shortened
from ryusa.errors import CaseError
from ryusa.model.course import Course
from ryusa.model.feeds import Feed

TRIANGLE = Course((0.0, 10.0, 20.0, 20.0, 30.0), (0.0, 1.0, 0.0, 0.5, 0.5))  # with a jump at 20 s

RIVER = (
    SAND
    + """
plane = true
[build]
kind = "empty"
[water]
profile = "column"
density = "1000 kg/m3"
viscosity = "1e-6 m2/s"
depth = "10 cm"
[water.column]
cell = "1 cm"
bed = "smooth"
[water.row]
bottom = [["0 m", "0 m"], ["2 m", "0 m"]]
segments = 20
{width}
upstream = {{ end = "discharge", {upstream} }}
downstream = {{ end = "level", {downstream} }}
[stop]
time = "12 s"
[record]
frames = "0.5 s"
{more}
"""
)


def river(upstream='discharge = "0.01 m2/s"', downstream='level = "10 cm"', width="", more=""):
    return RIVER.format(upstream=upstream, downstream=downstream, width=width, more=more)


def test_a_course_is_straight_between_its_points():
    assert [TRIANGLE.at(t) for t in (-1.0, 5.0, 10.0, 15.0, 20.0, 99.0)] == [0.0, 0.5, 1.0, 0.5, 0.5, 0.5]
    assert TRIANGLE.before(20.0) == 0.0
    assert [TRIANGLE.total(t) for t in (0.0, 10.0, 20.0, 24.0)] == [0.0, 5.0, 10.0, 12.0]
    assert TRIANGLE.mean(5.0, 10.0) == pytest.approx(0.75)
    assert TRIANGLE.extremes(5.0, 15.0) == (0.5, 1.0)
    for total in (0.0, 1.25, 5.0, 7.0, 10.0, 12.0):
        assert TRIANGLE.total(TRIANGLE.when(total)) == pytest.approx(total, abs=1e-12)
    assert TRIANGLE.when(1.25) == pytest.approx(5.0)  # t**2/20
    assert Course((0.0, 2.0, 4.0), (0.0, 0.0, 1.0)).when(0.0) == 2.0  # nothing comes before


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("t [s],q [m2/s]\n0,0.01\n10,0.02\n", ((0.0, 0.01), (10.0, 0.02))),
        ("# gauge\nt [min],q [L/s]\n0,5\n0.1,10\n", ((0.0, 0.01), (6.0, 0.02))),  # 0.5 m wide
        ("q [cm2/s];t [h]\n100;0\n200,5;0,01\n", ((0.0, 0.01), (36.0, 0.02005))),  # a decimal comma
        ("\ufefft [s]\tq [cfs]\n0\t0\n1\t1\n", ((0.0, 0.0), (1.0, 0.028316846592 / 0.5))),
    ],
)
def test_a_hydrograph_is_read_from_a_file_as_instruments_write_it(tmp_path, text, points):
    (tmp_path / "flood.csv").write_text(text, encoding="utf-8")
    file = tmp_path / "case.toml"
    file.write_text(river('hydrograph = "flood.csv"', width='width = "50 cm"'))
    course = hydrograph_of(read(file))
    assert course is not None
    found = np.array(list(zip(course.t, course.y, strict=True)))
    assert found == pytest.approx(np.array(points), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t [s],q\n0,1\n1,1\n", "'q' needs its unit"),
        ("t [s],q [kg]\n0,1\n1,1\n", "column 'q': needs a discharge"),
        ("t [s],z [m]\n0,1\n1,1\n", "unknown column 'z'"),
        ("t [s],q [m2/s]\n0,1\n", "has one point; expected at least two"),
        ("t [s],q [m2/s]\n0,1\n2,1\n1,1\n", "is the time of point 3, and the one before is at 2 s"),
        ("t [s],q [m2/s]\n0,1\n2,-1\n", "is at 2 s; must be 0 or above"),
        ("t [s],q [m2/s]\n0,0\n2,0\n", "brings no water"),
        ("t [s],q [m3/s]\n0,0\n2,1\n", "has discharges of the whole width"),
    ],
)
def test_a_hydrograph_that_cannot_be_is_refused_by_name(tmp_path, text, said):
    (tmp_path / "flood.csv").write_text(text)
    (tmp_path / "case.toml").write_text(river('hydrograph = "flood.csv"'))
    with pytest.raises(CaseError) as raised:
        read(tmp_path / "case.toml")
    assert said in str(raised.value)


POINTS = '[["0 s", "0.01 m2/s"], ["5 s", "0.02 m2/s"]]'


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            {"upstream": f'hydrograph = {POINTS}, discharge = "0.01 m2/s"'},
            "water.row.upstream.hydrograph: stands beside water.row.upstream.discharge",
        ),
        (
            {"upstream": f'hydrograph = {POINTS}, depth = "5 cm"'},
            "water.row.upstream.depth = '5 cm': would hold the depth",
        ),
        (
            {
                "upstream": f"hydrograph = {POINTS}",
                "more": '[[timeline]]\nat = "1 s"\ndischarge = "0.03 m2/s"',
            },
            "stands beside a discharge in [[timeline]]",
        ),
        (
            {"downstream": 'level = "10 cm", stage = [["0 s", "10 cm"], ["1 s", "11 cm"]]'},
            "water.row.downstream.stage: stands beside water.row.downstream.level",
        ),
        ({"upstream": "hydrograph = 'none.csv'"}, "no such file in the folder of the case"),
        (
            {"upstream": 'discharge = "0.01 m2/s", stage = [["0 s", "10 cm"], ["1 s", "11 cm"]]'},
            "water.row.upstream.stage: can only be given downstream",
        ),
    ],
)
def test_what_contradicts_a_hydrograph_or_stage_is_named(keys, said):
    with pytest.raises(CaseError) as raised:
        read_text(river(**keys))
    assert said in str(raised.value)


def test_check_says_what_enters_and_the_height_follows_from_the_peak():
    case = read_text(river('hydrograph = [["0 s", "0 m2/s"], ["6 s", "0.2 m2/s"], ["20 s", "0 m2/s"]]'))
    from ryusa.casefile.explain import explain

    rows = {row.name: row for row in explain(case, derive(case))}
    assert rows["water that enters"].value == pytest.approx(0.6 + 6.0 * 0.5 * (0.2 + 0.2 * 8.0 / 14.0))
    assert rows["hydrograph"].flag == "note" and "the run ends at 12 s" in rows["hydrograph"].origin
    least, peak = (read_text(river(f'discharge = "{q} m2/s"')) for q in (0.001, 0.2))
    assert row_plan(case).n_cell >= row_plan(peak).n_cell > row_plan(least).n_cell


@pytest.mark.full
@pytest.mark.parametrize(
    "points, volume",
    [
        (
            '[["0 s", "0.005 m2/s"], ["2 s", "0.005 m2/s"], ["6 s", "0.02 m2/s"], ["10 s", "0.005 m2/s"]]',
            0.12,
        ),
        ('[["0 s", "0 m2/s"], ["4 s", "0 m2/s"], ["4 s", "0.02 m2/s"], ["8 s", "0 m2/s"]]', 0.04),
        ('[["0 s", "0.03 m2/s"], ["12 s", "0 m2/s"]]', 0.18),
    ],
)
def test_the_water_of_a_hydrograph_enters(tmp_path, points, volume):
    (tmp_path / "case.toml").write_text(river(f"hydrograph = {points}"))
    results = ryusa.run(tmp_path / "case.toml", tmp_path / "run", progress=False)
    assert results.complete
    assert results.summary["water"]["entered"] == pytest.approx(volume, rel=1e-9)


@pytest.mark.full
def test_the_water_follows_the_stage_and_a_level_of_the_timeline(tmp_path):
    stage = 'stage = [["0 s", "10 cm"], ["8 s", "12 cm"]]'
    more = '[[timeline]]\nat = "1 s"\nlevel = "11 cm"'
    for name, text, level in (
        ("stage", river(downstream=stage), 0.12), ("level", river(more=more), 0.11),
    ):  # fmt: skip
        (tmp_path / f"{name}.toml").write_text(text)
        results = ryusa.run(tmp_path / f"{name}.toml", tmp_path / name, progress=False)
        surface = results.row.surface[-1]
        assert float(surface[-1]) == pytest.approx(level, abs=0.004)


@pytest.mark.full
def test_a_run_with_a_hydrograph_resumes_with_the_same_bits(tmp_path):
    text = river(
        f"hydrograph = {POINTS}", 'stage = [["0 s", "10 cm"], ["8 s", "12 cm"]]', 'height = "25 cm"',
        '[time]\nstep = "20 ms"',
    )  # fmt: skip
    whole, part = tmp_path / "whole.toml", tmp_path / "part.toml"
    whole.write_text(text)
    part.write_text(text.replace('time = "12 s"', 'time = "3.3 s"'))
    one = ryusa.run(whole, tmp_path / "one", progress=False)
    ryusa.run(part, tmp_path / "two", progress=False)
    two = ryusa.run(whole, tmp_path / "two", progress=False, resume=True)
    assert two.row.surface[-1].tobytes() == one.row.surface[-1].tobytes()
    assert two.summary["water"]["entered"] == one.summary["water"]["entered"]


def test_grains_of_a_sedigraph_are_due_as_their_number_has_been_fed():
    feed = Feed("sand", count=10, times=TRIANGLE.t, rates=TRIANGLE.y)
    due = feed.due(np.ones(10))
    assert due[:5] == pytest.approx(np.sqrt(20.0 * np.arange(5)))  # t**2/20 have been fed
    assert due[5:] == pytest.approx(20.0 - np.sqrt(20.0 * (10.0 - np.arange(5, 10))))


@pytest.mark.parametrize(
    ("keys", "amount", "end"),
    [
        ('sedigraph = [["0 s", "0 grains/s"], ["0.1 s", "400 grains/s"], ["0.2 s", "0 grains/s"]]', 40, 0.2),
        ('sedigraph = [["0 s", "100 grains/s"], ["9 s", "100 grains/s"]]', 30, 0.3),
        (
            'sedigraph = [["0 s", "100 grains/s"], ["9 s", "100 grains/s"]]\ntotal = "12 grains"',
            12, 0.12,
        ),
        ('sedigraph = [["0.1 s", "2 g/s"], ["0.2 s", "4 g/s"]]', 3e-4, 0.2),
    ],
)  # fmt: skip
def test_a_sedigraph_brings_its_area(keys, amount, end):
    case = read_text(FED.format(keys=keys))
    feed = case.feeds[0]
    assert fed_amount(case, feed) == pytest.approx(amount)
    assert feed_end(case, feed) == pytest.approx(end)
    made = build(case, derive(case))
    traffic = made.scene.traffic
    assert traffic is not None
    count = fed_count(case, feed)
    assert traffic.feeds[0].count == pytest.approx(count, abs=2)
    due = traffic.feeds[0].due(made.scene.m)
    assert (np.diff(due) >= 0.0).all() and due[-1] <= end


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            'sedigraph = [["0 s", "1 g/s"], ["1 s", "2 g/s"]]\nrate = "1 g/s"',
            "feeds.0.rate: stands beside feeds.0.sedigraph",
        ),
        ('sedigraph = [["0 s", "1 g/s"], ["1 s", "2 grains/s"]]', "mixes grains/s and kg/s"),
        ('sedigraph = [["0 s", "0 g/s"], ["1 s", "0 g/s"]]', "brings no grain: every rate is 0"),
        ('sedigraph = [["0 s", "1 g/s"], ["1 s", "-1 g/s"]]', "is at 1 s; must be 0 or above"),
        ('sedigraph = [["1 s", "1 g/s"], ["2 s", "1 g/s"]]', "leaves no time to feed"),
        ('sedigraph = [["0 s", "1 kg/s"], ["1 s", "9 kg/s"]]', "cannot fit"),
        ('sedigraph = [["0 s", "1 g/s"], ["1 s", "1 g/s"]]\ntotal = "1 kg"', "is not fed by 0.3 s"),
        ('sedigraph = [["0 s", "1 g/s"]]', "feeds.0.sedigraph"),
    ],
)
def test_a_sedigraph_that_cannot_be_is_refused_by_name(keys, said):
    with pytest.raises(CaseError) as raised:
        read_text(FED.format(keys=keys))
    assert said in str(raised.value)


def test_a_trial_shortens_courses_too(tmp_path):
    (tmp_path / "sand.csv").write_text("t [ms],rate [grains/s]\n0,0\n100,400\n300,0\n")
    file = tmp_path / "fed.toml"
    file.write_text(FED.format(keys='sedigraph = "sand.csv"'))
    case = read_shortened(file, {}, "30 ms")
    assert [t for t, _ in case.feeds[0].sedigraph] == pytest.approx([0.0, 0.01, 0.03])
    (tmp_path / "river.toml").write_text(
        river(f"hydrograph = {POINTS}", 'stage = [["0 s", "10 cm"], ["8 s", "12 cm"]]')
    )
    short = read_shortened(tmp_path / "river.toml", {}, "1.2 s")
    hydrograph, stage = hydrograph_of(short), stage_of(short)
    assert hydrograph is not None and stage is not None
    assert hydrograph.t == pytest.approx((0.0, 0.5)) and hydrograph.y == pytest.approx((0.01, 0.02))
    assert stage.t == pytest.approx((0.0, 0.8)) and math.isclose(stage.y[1], 0.12)


@pytest.mark.full
def test_a_run_feeds_its_sedigraph_and_keeps_the_file(tmp_path):
    (tmp_path / "sand.csv").write_text("t [ms],rate [grains/s]\n0,0\n100,400\n200,0\n")
    file = tmp_path / "fed.toml"
    file.write_text(FED.format(keys='sedigraph = "sand.csv"'))
    results = ryusa.run(file, tmp_path / "run", progress=False)
    assert results.complete and (tmp_path / "run" / "sand.csv").exists()
    there = [int(np.isfinite(x[:, 0]).sum()) for x in results.frames.x]
    assert there[-1] == 40
    k = int(np.argmin(np.abs(np.array(results.frames.t) - 0.1)))
    assert there[k] == pytest.approx(20, abs=2)
