"""Case files from strangers: explained, laid out, or refused by name; never a traceback, never a hang.

Short here; `make fuzz` is the long form, and tells its figures.
"""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

sys.path.insert(0, str(Path(__file__).parent))

from fuzz import Tally, alarm, cli, judged
from strange_cases import bases, rich, strange_cases, strange_files, toml_of

import ryusa
from ryusa.build import build
from ryusa.casefile.builders.values import plate_count, plate_of
from ryusa.casefile.read import read, read_text
from ryusa.errors import CaseError
from ryusa.units import UnitError, quantity

MANY = settings(max_examples=400, suppress_health_check=list(HealthCheck))


@MANY
@given(text=strange_cases(), files=strange_files())
def test_a_manipulated_case_file_is_used_or_refused_by_name(
    tmp_path_factory: pytest.TempPathFactory, text: str, files: dict[str, str]
) -> None:
    tally = Tally()
    judged(tmp_path_factory.getbasetemp(), text, files, tally)
    assert tally.outcomes["wrong"] == 0, tally.wrong[0]


@pytest.mark.full
def test_manipulated_case_files_get_an_answer_from_the_command_line(tmp_path: Path) -> None:
    tally = cli(tmp_path, 4, 5)
    assert tally.outcomes["wrong"] == 0, tally.wrong[0]
    assert sum(tally.outcomes.values()) == 4


def test_the_fuzzer_has_cases_with_every_part_of_walls_and_traffic() -> None:
    words = " ".join(toml_of(base) for base in rich())
    for part in ("walls", "mesh", "servo", "feeds", "exits", "materials", "pairs", "mixture", "stones.csv"):
        assert part in words, part


# what fuzzing found


@pytest.mark.parametrize("key", ["<", "'<number>'", "'<table>'"])
def test_an_unknown_key_that_resembles_a_known_one_is_refused_by_name(key: str) -> None:
    name = key.strip("'")
    with pytest.raises(CaseError, match=f"{name}: unknown key"):
        read_text(f'"{name}" = 1\n')


def test_a_unit_too_large_for_a_number_is_refused() -> None:
    with pytest.raises(UnitError, match="too large a unit"):
        quantity("1 Ylightyear^9", "m")


def test_a_number_that_would_underflow_is_refused() -> None:
    with pytest.raises(UnitError, match="too small"):
        quantity("1e-400 m", "m")
    assert quantity("0e-400 m", "m") == 0.0


def test_minus_zero_is_read_as_zero() -> None:
    text = toml_of(next(base for base in bases() if base["build"]["kind"] == "packing"))
    for gap in ("-0.0", "0.0"):
        case = read_text(text, {"build.gap": gap})
        assert math.copysign(1.0, case.build.gap) == 1.0
        build(case)
    assert math.copysign(1.0, quantity("-0 m", "m")) == 1.0


def test_an_integer_too_long_to_be_printed_is_refused() -> None:
    with pytest.raises(CaseError, match=r"grains\.spread"):
        read_text(f"[grains]\nspread = 0x{'f' * 9_000}\n")


@pytest.mark.parametrize("d", ["4 um", "1e-7 m"])
def test_a_plate_of_grains_too_fine_to_lay_is_refused_at_once(d: str) -> None:
    case = Path(__file__).parent / "cases" / "clumps-fed.toml"
    with alarm(5), pytest.raises(CaseError, match="at most 20,000,000"):
        read(case, {"grains.diameter": d})


@pytest.mark.parametrize("diameter", ["1 mm", "2 mm", "3.3 mm", "1.5 cm", "4 cm"])
@pytest.mark.parametrize("plane", [True, False])
def test_the_grains_of_a_plate_are_counted_as_they_are_laid(diameter: str, plane: bool) -> None:
    case = read(
        Path(ryusa.__file__).parent / "cases" / "drop.toml",
        {"grains.diameter": diameter, "motion.plane": plane},
    )
    d = quantity(diameter, "m")
    for radius in (d, 1.5e-2):
        laid = plate_of(case, radius)
        assert len(laid) == plate_count(case, radius)
        i = np.arange(-40, 41)
        i, j = (i, 0 * i) if plane else np.meshgrid(i, i)
        far = d * np.hypot(i + 0.5 * j, math.sqrt(0.75) * j)
        assert len(laid) == (far <= radius * (1.0 + 1e-9)).sum()
