"""Case files from strangers: explained, laid out, or refused by name; never a traceback, never a hang.

Short here; `make fuzz` is the long form, and tells its figures.
"""

import math
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

sys.path.insert(0, str(Path(__file__).parent))

from fuzz import Tally, cli, judged
from strange_cases import bases, rich, strange_cases, strange_files, toml_of

from ryusa.build import build
from ryusa.casefile.read import read_text
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
