"""The table of a sweep, from averages made by hand."""

import csv
import math

import pytest
from scipy import stats

from ryusa.campaigns.sweep.part import Measured, SweepRun, runs_of, short_names
from ryusa.campaigns.sweep.pictures import quantities_of
from ryusa.campaigns.sweep.table import (
    SweepColumn,
    column_of,
    pooled_over_seeds,
    rows_of_sweep,
    unmoved_by_seeds,
)
from ryusa.formats.parquet import write_rows_as_parquet
from ryusa.measure import write_csv
from ryusa.measure.statistics import average

CASE_RUNS = ("0.01", "0.02")


def measured(*values, name="q", n=100):
    """One run whose record of n samples has this mean."""
    items = tuple(
        average(f"{name}{k or ''}", "m2/s", [[value - 1.0, value + 1.0] * (n // 2)])
        for k, value in enumerate(values)
    )
    return Measured({"transport": items})


def three_seeds(tmp_path):
    settings = [{"motion.slope": one} for one in CASE_RUNS]
    return runs_of(tmp_path / "bed.toml", {"stop.time": "1 s"}, settings, (1, 2, 3))


def test_the_pooled_error_is_that_between_the_runs_widened_by_students_t():
    runs = [measured(1.0), measured(2.0), measured(6.0)]
    (found,) = pooled_over_seeds(["transport"], runs).values()
    spread = math.sqrt(((1 - 3) ** 2 + (2 - 3) ** 2 + (6 - 3) ** 2) / 2)
    one_sigma = stats.t.ppf(stats.norm.cdf(1.0), 2)  # of n - 1 = 2 degrees of freedom
    assert found.value == pytest.approx(3.0)
    assert found.error == pytest.approx(spread / math.sqrt(3) * one_sigma)
    assert found.n_series == 3


def test_a_run_counts_once_however_long_it_is():
    (found,) = pooled_over_seeds(["transport"], [measured(1.0, n=1000), measured(3.0, n=10)]).values()
    assert found.value == pytest.approx(2.0)


def test_a_quantity_is_pooled_over_the_runs_that_have_it_and_not_from_one_alone():
    runs = [measured(1.0, 5.0), measured(2.0), Measured(problems={"run": "grain 3 lost"})]
    found = pooled_over_seeds(["transport"], runs)
    assert set(found) == {("transport", "q")}
    assert found["transport", "q"].n_series == 2


def test_points_where_seeds_change_nothing_are_found(tmp_path):
    runs = three_seeds(tmp_path)
    found = {one: measured(1.0, math.nan) if one.setting else measured(0.1 * one.seed) for one in runs}
    same, n = unmoved_by_seeds(found)
    assert ([one.setting for one in same], n) == ([1], 2)
    found |= {one: Measured(problems={"run": "grain 3 lost"}) for one in runs[4:]}
    assert unmoved_by_seeds(found) == ([], 1)  # one seed alone says nothing
    found[runs[4]] = measured(1.0, 5.0)
    assert unmoved_by_seeds(found) == ([], 2)


def test_rows_hold_every_run_then_the_setting_and_a_failed_run_with_its_reason(tmp_path):
    runs = three_seeds(tmp_path)
    found = {one: measured(one.setting + 0.1 * one.seed) for one in runs}
    found[runs[1]] = Measured(problems={"run": "grain 3 lost"})
    columns = (SweepColumn("motion.slope", "", (0.01, 0.02), CASE_RUNS),)
    rows = rows_of_sweep(columns, runs, ["transport"], found)
    assert [(one["setting"], one["over"], one["seed"]) for one in rows] == [
        (1, "run", 1), (1, "run", 2), (1, "run", 3), (1, "seeds", None),
        (2, "run", 1), (2, "run", 2), (2, "run", 3), (2, "seeds", None),
    ]  # fmt: skip
    assert rows[1]["problem"] == "grain 3 lost"
    assert rows[1]["value"] is None
    assert rows[3]["value"] == pytest.approx(0.2)  # of seeds 1 and 3
    assert rows[3]["n_series"] == 2
    assert rows[7]["value"] == pytest.approx(1.2)
    assert [one["motion.slope"] for one in rows] == [0.01] * 4 + [0.02] * 4
    assert all(len(one) == len(rows[0]) for one in rows)


def test_csv_and_parquet_hold_the_same_numbers_to_the_last_digit(tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    runs = three_seeds(tmp_path)
    found = {one: measured(math.pi * one.seed) for one in runs}
    found[runs[0]] = Measured(problems={"transport": "no frame"})
    columns = (SweepColumn("grains.diameter", "m", (0.002, 0.004), ("2 mm", "4 mm")),)
    rows = rows_of_sweep(columns, runs, ["transport"], found)
    write_csv(tmp_path / "sweep.csv", rows)
    write_rows_as_parquet(tmp_path / "sweep.parquet", rows, {"grains.diameter_m": "m"})
    table = pq.read_table(tmp_path / "sweep.parquet")
    assert table.to_pylist() == rows
    assert table.schema.field("grains.diameter_m").metadata == {b"unit": b"m"}
    with (tmp_path / "sweep.csv").open() as file:
        read = list(csv.DictReader(file))
    assert [float(one["value"]) for one in read if one["value"]] == [
        one["value"] for one in rows if one["value"] is not None
    ]


def test_a_column_has_the_si_values_of_the_case_and_its_unit_in_its_name():
    cases = [{"grains": {"diameter": 0.002}}, {"grains": {"diameter": 0.004}}]
    found = column_of("grains.diameter", ["2 mm", "0.4 cm"], cases)
    assert (found.name, found.values) == ("grains.diameter_m", (0.002, 0.004))
    words = column_of("water.drag", ["constant", "24/Re+2"], [{"water": {"drag": "constant"}}] * 2)
    assert (words.name, words.values) == ("water.drag", ("constant", "24/Re+2"))
    entry = column_of("walls.0.speed", ["1 cm/s"], [{"walls": [{"speed": 0.01}]}])
    assert (entry.name, entry.values) == ("walls.0.speed_m_per_s", (0.01,))


def test_folders_differ_by_what_varies_alone(tmp_path):
    first, *_ = runs = three_seeds(tmp_path)
    assert len({one.folder for one in runs}) == 6
    other = runs_of(tmp_path / "bed.toml", {"stop.time": "2 s"}, [{"motion.slope": "0.01"}], (1,))
    assert other[0].folder == first.folder  # so that the change of the case is noticed there
    assert other[0] != first
    awkward = SweepRun("bed", varied=(("grains.file", "a b/$(x);'y'"), ("seed", "1")))
    assert awkward.folder.startswith("file-abxy_seed-1-")


def test_short_names_stay_apart():
    assert short_names(["grains.density", "water.density"]) == ["grains.density", "water.density"]


def test_a_quantity_of_one_seed_keeps_the_error_of_its_run():
    (one,) = quantities_of(["transport"], [[measured(2.0)]])
    (mean,) = one.pooled
    assert mean is not None
    assert mean.n_series == 1
    assert one.runs == ((2.0,),)
