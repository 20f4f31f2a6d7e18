"""What docs/many-runs.md shows is what the code does."""

import inspect
import re
import shutil
from pathlib import Path

import pytest

import ryusa
from ryusa.campaigns.sweep import plan_sweep, seeds_of
from ryusa.campaigns.sweep.definition import read_sweep
from ryusa.campaigns.sweep.part import Measured, runs_of
from ryusa.campaigns.sweep.table import RUN, SEEDS, rows_of_sweep
from ryusa.cases import case_path

PAGE = (Path(__file__).parents[2] / "docs" / "many-runs.md").read_text(encoding="utf-8")


def test_the_design_of_the_page_can_be_run(tmp_path: Path) -> None:
    (block,) = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    (tmp_path / "sweep.toml").write_text(block)
    shutil.copy(case_path("bedload_3d.toml"), tmp_path / "bedload_3d.toml")
    file = read_sweep(tmp_path / "sweep.toml")
    plan = plan_sweep(
        file.case, file.design, seeds_of(file.seeds)[:1], file.measures, overrides=file.overrides
    )
    assert len(plan.runs) == 32
    assert [one.name for one in plan.columns] == [
        "motion.slope", "grains.diameter_m", "build.length_m", "build.width_m"
    ]  # fmt: skip
    for one in plan.design.settings:  # keys of one table change together
        length, d = (float(one[key].split()[0]) for key in ("build.length", "grains.diameter"))
        assert length / d == pytest.approx(2.4, rel=1e-4)  # cm/mm: 24 grains


def test_every_column_of_the_table_is_explained(tmp_path: Path) -> None:
    run, *_ = runs_of(tmp_path / "bed.toml", {}, [{}], (1, 2))
    columns = rows_of_sweep((), (run,), ("transport",), {run: Measured()})[0]
    table = PAGE[PAGE.index("| column | meaning |") :].split("\n\n", 1)[0]
    explained = set(re.findall(r"`(\w+)`", "".join(line.split("|")[1] for line in table.splitlines())))
    assert set(columns) <= explained
    assert {f"`{one}`" for one in (RUN, SEEDS)} <= set(re.findall(r"`\w+`", table))


def test_the_call_of_the_page_takes_these_arguments() -> None:
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    asked = set(re.findall(r"^    (\w+)=", block, flags=re.MULTILINE))
    assert asked <= set(inspect.signature(ryusa.sweep).parameters)
