"""The scene of docs/lids.md is built as it stands, and its lid presses with what is asked."""

import re
from pathlib import Path

import pytest

from ryusa.model.walls import ASKED

PAGE = Path(__file__).parents[2] / "docs" / "lids.md"


def test_the_lid_of_arrays_presses_on_the_area_of_the_sample() -> None:
    (text,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    made: dict[str, object] = {}
    exec(text.split("run = ")[0], made)
    scene = made["scene"]
    assert scene.n_grain == 400
    assert scene.walls.servo[1, ASKED] == pytest.approx(400.0 * scene.period[0] * scene.period[1], rel=1e-9)
