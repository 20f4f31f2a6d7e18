"""Sieve curves from strangers: read, or an error with line and column, and never a traceback."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.errors import ParseError
from ryusa.formats.sieve import read_sieve_curve
from ryusa.formats.table import LARGEST_FILE

SOUND = 'passing [%],"d [um]"\n100,4000\n"60",2000\n0,1000\n'
PIECES = [
    "diameter [mm]", "finer [%]", "d", "[", "]", "%", ",", ";", "\n", "\t", '"', "#", "nan", "1e999", "-1",
    "0", "1", "2", "100", "1_0", "\u00b5m", "\0",
]  # fmt: skip


def test_columns_stand_in_any_order_with_any_length_and_rows_from_either_end(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(SOUND, encoding="utf-8-sig")
    found = read_sieve_curve(tmp_path / "a.csv", "a.csv")
    assert [round(d, 9) for d, _ in found] == [0.004, 0.002, 0.001]
    assert [finer for _, finer in found] == [100.0, 60.0, 0.0]


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.lists(st.sampled_from(PIECES) | st.text(max_size=3), max_size=25).map("".join))
def test_any_text_is_read_or_refused_with_its_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        found = read_sieve_curve(path, "a.csv")
    except ParseError as error:
        assert error.line >= 1
        assert error.column >= 1
    else:
        assert len(found) >= 2


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(at=st.integers(0, len(SOUND) - 1), piece=st.sampled_from(PIECES))
def test_a_sound_file_with_one_thing_changed_is_read_or_refused(tmp_path: Path, at: int, piece: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(SOUND[:at] + piece + SOUND[at + 1 :], encoding="utf-8")
    try:
        read_sieve_curve(path, "a.csv")
    except ParseError as error:
        assert str(error).startswith("a.csv:")


def test_a_file_too_large_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"#" * (LARGEST_FILE + 1))
    with pytest.raises(ParseError, match="1 MiB"):
        read_sieve_curve(path, "a.csv")
