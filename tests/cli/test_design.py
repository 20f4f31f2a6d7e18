import csv
import math

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.laws.adhesion import sticking_speed
from ryusa.laws.collision import zeta_no_tension

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


@pytest.mark.parametrize(
    ("more", "steps"),
    [
        ((), 10),
        (("--restitution", "1"), 16),
        (("--pull-off-force", "0.1 mN"), 50),
        (("--steps-per-contact", "20"), 20),
    ],
)
def test_the_step_is_that_of_a_case_which_gives_none(more, steps):
    result = CliRunner().invoke(app, [*PAPER, *more])
    assert result.exit_code == 0, result.output
    assert f"step dt at {steps} steps per contact" in result.output


@pytest.mark.full
def test_charts_and_tables_are_written(tmp_path):
    result = CliRunner().invoke(app, [*PAPER, "--water", "-o", str(tmp_path / "design")])
    assert result.exit_code == 0, result.output
    names = {path.name for path in (tmp_path / "design").iterdir()}
    for name in ("contact-time", "overlap", "band", "band-large-grains"):
        assert {f"{name}.png", f"{name}.svg"} <= names
    with (tmp_path / "design" / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [round(float(row["overlap_fixed"]), 6) for row in rows] == [0.01, 0.003162, 0.001]


def test_adhesion_adds_the_bond_number_and_the_sticking_speed():
    result = CliRunner().invoke(app, [*PAPER, "--pull-off-force", "0.1 mN"])
    assert result.exit_code == 0, result.output
    bond = 1.0e-4 / (2650.0 * math.pi / 6.0 * 0.002**3 * 9.80665)
    assert f"(Bond number): {bond:.4g}" in result.output
    zeta = zeta_no_tension(0.7)
    k_n, m = 6993.0, 2650.0 * math.pi / 6.0 * 0.002**3
    (line,) = [one for one in result.output.splitlines() if "sticking speed" in one]
    assert float(line.split()[-3]) == pytest.approx(sticking_speed(1.0e-4, m, k_n, zeta, False), rel=1e-3)
    (line,) = [one for one in result.output.splitlines() if "pull-off force alone" in one]
    assert float(line.split()[-3]) == pytest.approx(1.0e-4 / k_n / 0.002, rel=1e-3)
    assert "sticking" not in CliRunner().invoke(app, PAPER).output


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--diameter", "0.2", "missing unit"),
        ("--diameter", "0.2 s", "wrong unit"),
        ("--speed", "-1 m/s", "above 0"),
        ("--pull-off-force", "-1 N", "at least 0"),
        ("--pull-off-force", "1 m", "wrong unit"),
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
