import csv

import pytest
from typer.testing import CliRunner

from ryusa.cli import app

PAPER = [
    "design",
    "--diameter",
    "0.2cm",
    "--density",
    "2650kg/m3",
    "--restitution",
    "0.7",
    "--speed",
    "0.6m/s",
]


def test_the_paper_grain_gets_its_band_and_its_contact_times():
    result = CliRunner().invoke(app, PAPER)
    assert result.exit_code == 0, result.output
    assert "k_n = 6993 to 6.993e+05 N/m" in result.output


def test_charts_and_tables_are_written(tmp_path):
    result = CliRunner().invoke(app, [*PAPER, "--water", "-o", str(tmp_path / "design")])
    assert result.exit_code == 0, result.output
    names = {path.name for path in (tmp_path / "design").iterdir()}
    for name in ("contact-time", "overlap", "band", "band-large-grains"):
        assert {f"{name}.png", f"{name}.svg"} <= names
    with (tmp_path / "design" / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [round(float(row["overlap_fixed"]), 6) for row in rows] == [0.01, 0.003162, 0.001]


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--diameter", "0.2", "missing unit"),
        ("--diameter", "0.2 s", "wrong unit"),
        ("--speed", "-1 m/s", "above 0"),
        ("--restitution", "1.5", "at most 1"),
        ("--restitution", "nan", "at most 1"),
        ("--steps-per-contact", "2", "at least 10"),
        ("--steps-per-contact", "inf", "at least 10"),
    ],
)
def test_a_wrong_number_gives_one_message_and_exit_code_two(option, value, message):
    result = CliRunner().invoke(app, [*PAPER, option, value])
    assert result.exit_code == 2, result.output
    assert message in result.output
    assert "Traceback" not in result.output
