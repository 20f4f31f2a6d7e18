"""What `print` shows of a case, a run and what is measured on it: a few lines, and no array."""

from dataclasses import fields, is_dataclass

import numpy as np
import pytest

import ryusa
from ryusa import build
from ryusa.cases import case_path
from ryusa.catalogue import MEASURES
from ryusa.errors import RyusaError
from ryusa.measure.table import Averaged

LONGEST = 4000  # characters: forty lines of a table of averages


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    case = ryusa.load(
        case_path("saltation.toml"),
        {"stop.saltations": "2", "record.settle": "0.05 s", "record.frames": "5 ms"},
    )
    return ryusa.run(case, tmp_path_factory.mktemp("printed") / "run", progress=False)


def readable(shown: str) -> bool:
    return (
        0 < len(shown) < LONGEST and "array(" not in shown and "object at" not in shown and "<" not in shown
    )


@pytest.mark.parametrize("name", [one.name for one in MEASURES])
def test_a_measure_prints_its_averages_and_names_its_arrays(run, name) -> None:
    try:
        found = run.measure(name)
    except RyusaError as refused:  # what this run has not: then the message is the answer
        assert readable(str(refused))
        return
    assert readable(repr(found)), repr(found)[:500]
    if isinstance(found, Averaged):
        assert all(one.name in repr(found) for one in found.averages.items if one.n)
        arrays = [one.name for one in fields(found) if isinstance(getattr(found, one.name), np.ndarray)]
        assert all(f"{one} " in repr(found) for one in arrays)


def test_an_average_is_one_line(run) -> None:
    hop = run.measure("saltation")["jump_height"]
    assert repr(hop).startswith(f"jump_height: {hop.value:.4g} ± ") and repr(hop).endswith(")")


def test_case_run_frames_scene_and_state_are_short(run) -> None:
    scene, state = build.scene(x=[[0, 0, 0.011], [0, 0, 0.014]], d=0.002)
    shown = [run, run.frames, run.frames[0], run.scene, scene, state, scene.contact, scene.water]
    case = ryusa.load(case_path("hopper.toml"), {"seed": "3"})
    for one in [case, *shown]:
        assert readable(repr(one)) and readable(str(one)), repr(one)
        assert is_dataclass(one) == repr(one).startswith(f"{type(one).__name__}(") or one in (run, run.frames)
    assert "hopper.toml" in str(case) and "changed: seed" in str(case) and "6 walls" in str(case)
