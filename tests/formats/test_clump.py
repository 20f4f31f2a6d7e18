"""Clumps from strangers: read, or an error with line and column, and never a traceback."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.errors import ParseError
from ryusa.formats.clump import read_clump
from ryusa.model.clump import shape

SOUND = "# a pair\nd [mm],x [cm],y [m],z [mm]\n2,0,0,0\n2,0.2,0,0\n"
PIECES = [
    "x [mm]", "y [mm]", "z [mm]", "d [mm]", "[", "]", ",", ";", "\n", "\t", '"', "#", "nan", "1e999", "-1",
    "0", "1", "2", "1_0", "\u00b5m", "\0",
]  # fmt: skip


def test_columns_stand_in_any_order_with_any_length(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(SOUND, encoding="utf-8-sig")
    found = read_clump(tmp_path / "a.csv", "a.csv")
    assert found.d == pytest.approx([0.002, 0.002])
    assert found.inertia == pytest.approx(shape("dumbbell", found.d_volume).inertia, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.csv:1:1: expected a header such as"),
        ("x [mm],y [mm],z [mm],d [mm]\n", "expected at least one sphere below the header"),
        ("x [mm],y [mm],z [mm]\n0,0,0\n", "column 'd' is missing"),
        ("x,y [mm],z [mm],d [mm]\n0,0,0,1\n", "a.csv:1:1: column 'x' needs its unit"),
        ("x [s],y [mm],z [mm],d [mm]\n0,0,0,1\n", "a.csv:1:1: column 'x'"),
        ("x [mm],y [mm],z [mm],r [mm]\n0,0,0,1\n", "a.csv:1:22: unknown column 'r'; known are x, y, z, d"),
        ("x [mm],y [mm],z [mm],d [mm]\n0,0,0,-1\n", "a.csv:2:7: expected a diameter from 1e-07"),
        (
            "x [mm],y [mm],z [mm],d [mm]\n0,0,0,1\n3,0,0,1\n",
            "a.csv:3:1: sphere 1 is not joined to sphere 0, its gap to the spheres that are is 0.002 m",
        ),
        (
            "x [mm],y [mm],z [mm],d [mm]\n0,0,0,1\n0,0,0,3\n",
            "a.csv:2:1: sphere 0 lies wholly inside sphere 1",
        ),
    ],
)
def test_what_makes_no_clump_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ParseError) as error:
        read_clump(tmp_path / "a.csv", "a.csv")
    assert message in str(error.value)


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(at=st.integers(0, len(SOUND) - 1), piece=st.sampled_from(PIECES))
def test_a_sound_file_with_one_thing_changed_is_read_or_refused(tmp_path: Path, at: int, piece: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(SOUND[:at] + piece + SOUND[at + 1 :], encoding="utf-8")
    try:
        read_clump(path, "a.csv")
    except ParseError as error:
        assert str(error).startswith("a.csv:")
