"""What docs/calibration.md shows is what the code does."""

import re
import shutil
from pathlib import Path

from ryusa.campaigns.calibrate.design import filling_points
from ryusa.campaigns.calibrate.runs import CaseRuns
from ryusa.campaigns.calibrate.study_file import read_calibration
from ryusa.cases import case_path
from ryusa.study.executors import Processes

PAGE = (Path(__file__).parents[2] / "docs" / "calibration.md").read_text(encoding="utf-8")


def test_the_study_of_the_page_can_be_run(tmp_path: Path) -> None:
    (block,) = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    (tmp_path / "heap-study.toml").write_text(block)
    shutil.copy(case_path("heap.toml"), tmp_path / "heap.toml")
    asked = read_calibration(tmp_path / "heap-study.toml")
    runs = CaseRuns(asked, tmp_path / "out", Processes(1))
    (plan,) = runs.plans(filling_points(2, asked.points, asked.design_seed), (1, 2)).values()
    assert len(plan.runs) == 64
    assert plan.measures == ("surface",)
