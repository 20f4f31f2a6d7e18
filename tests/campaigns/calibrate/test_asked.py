"""The file of a calibration: what it says, and what is said of a bad one."""

import pytest

from ryusa.campaigns.calibrate.definition import ObservedValue
from ryusa.campaigns.calibrate.study_file import read_calibration
from ryusa.cases import case_path
from ryusa.errors import CaseError

GOOD = """
[calibrate]
points = 16
seeds = 1
set = { "stop.time" = "0.2 s" }

[[parameters]]
key = "contact.restitution"
low = 0.3
high = 0.95

[[parameters]]
key = "contact.friction_angle"
low = "10 deg"
high = "40 deg"
mean = "25 deg"
sd = "5 deg"

[[observations]]
case = "drop.toml"
measure = "collisions"
quantity = "restitution_alone"
value = 0.7
error = 0.01

[[predictions]]
case = "drop.toml"
measure = "collisions"
quantity = "closing_speed"
"""


def read(tmp_path, text):
    path = tmp_path / "study.toml"
    path.write_text(text)
    return read_calibration(path)


def test_a_calibration_is_read_with_its_priors_and_targets(tmp_path):
    found = read(tmp_path, GOOD)
    assert [one.words for one in found.priors] == [
        "uniform from 0.3 to 0.95", "normal, 25 ± 5, from 10 to 40 deg",
    ]  # fmt: skip
    assert [one.words for one in found.targets] == [
        "drop: collisions restitution_alone", "drop: collisions closing_speed",
    ]  # fmt: skip
    assert found.overrides == {"stop.time": "0.2 s"}
    assert found.observations[0].in_si("-") == ObservedValue(0.7, 0.01)


def test_a_quantity_over_height_is_a_target_at_each_height(tmp_path):
    profile = 'measure = "profile"\nquantity = "v_x"\nat = "{} mm"'
    text = GOOD.replace('measure = "collisions"\nquantity = "restitution_alone"', profile.format(12), 1)
    text = text.replace('measure = "collisions"\nquantity = "closing_speed"', profile.format(30), 1)
    found = read(tmp_path, text)
    assert [one.words for one in found.targets] == [
        "drop: profile v_x at 12 mm", "drop: profile v_x at 30 mm",
    ]  # fmt: skip
    assert [one.z for one in found.heights(tmp_path / "drop.toml")] == [0.012, 0.03]
    assert found.measures(tmp_path / "drop.toml") == ("profile",)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("points = 16", "points = 17", "calibrate.points = 17: must be a power of 2"),
        ("points = 16", "points = 4", "at least 4 for each of the 2 parameters, such as 16"),
        ("points = 16", "pionts = 16", "calibrate.pionts: unknown key; must be one of points"),
        ("seeds = 1", "seeds = 0", "calibrate.seeds = 0: must be 1 or more"),
        ('"contact.restitution"', '"contact.friction_angle"', "stands there twice"),
        ('"contact.restitution"', '"seed"', "is no parameter; calibrate.seeds says how many"),
        ("low = 0.3", "low = 0.99", "the low end must be less than the high end"),
        ('low = "10 deg"', 'low = "0.1 rad"', "both ends must have one unit"),
        ('sd = "5 deg"', 'sd = "0.1 rad"', "must be a number in the unit of low and high, 'deg'"),
        ('sd = "5 deg"', "", "a normal prior has mean and sd"),
        ('mean = "25 deg"', 'mean = "45 deg"', "must lie between low and high"),
        ('measure = "collisions"', 'measure = "colisions"', "Did you mean 'collisions'?"),
        ("value = 0.7", "", "observations.0.value: missing"),
        ("[[observations]]", "[[observation]]", "Did you mean 'observations'?"),
        ("value = 0.7", 'value = 0.7\nat = "1 cm"', "is for a quantity over height, of the measures profile"),
        (
            'measure = "collisions"\nquantity = "restitution_alone"',
            'measure = "profile"\nquantity = "v_y"\nat = "1 cm"',
            "at one height, must be one of phi, area_fraction, v_x, v_z",
        ),
        (
            'measure = "collisions"\nquantity = "restitution_alone"',
            'measure = "profile"\nquantity = "v_x"\nat = 1.0',
            "at = 1.0: missing unit",
        ),
        (
            'case = "drop.toml"\nmeasure = "collisions"\nquantity = "closing_speed"',
            'case = "other/drop.toml"\nmeasure = "collisions"\nquantity = "closing_speed"',
            "has the name of another case",
        ),
        (
            'measure = "collisions"\nquantity = "restitution_alone"',
            'measure = "discharge"\nquantity = "outlet"',
            "observations.0.quantity = 'outlet': discharge gives 'rate_in', 'rate_out', 'grains_in'",
        ),
        ("[calibrate]", "[calibrate", "is no TOML"),
        ("error = 0.01", "error = 0.01\ndiscrepancy = true", "observations.0.discrepancy = True: must be"),
        ("error = 0.01", 'error = 0.01\ntest = "other"', "is for observations of a heap"),
    ],
)
def test_a_fault_is_named_by_its_key(tmp_path, old, new, said):
    with pytest.raises(Exception, match=r"study\.toml") as caught:
        read(tmp_path, GOOD.replace(old, new, 1))
    assert said in str(caught.value)


def test_a_case_is_not_taken_for_a_calibration(tmp_path):
    with pytest.raises(CaseError, match="is a case; a calibration is a file of its own"):
        read(tmp_path, case_path("drop.toml").read_text())


def test_all_faults_of_a_file_are_named_together(tmp_path):
    with pytest.raises(CaseError, match="3 faults"):
        read(
            tmp_path, GOOD.replace("points = 16", "points = 16.5").replace("0.01", "true").replace("0.3", "2")
        )


@pytest.mark.parametrize(
    ("value", "error", "unit", "said"),
    [
        ("21 deg", "0.5", "rad", "error = '0.5': missing unit"),
        ("21 cm", "0.5 deg", "rad", "'cm' does not measure an angle"),
        ("0.7 m", "0.1", "-", "must be a number without a unit"),
        (0.7, 0.0, "-", "must be greater than 0"),
        (0.7, 0.1, "m", "value = 0.7: missing unit"),
    ],
)
def test_an_observation_in_another_unit_is_refused(tmp_path, value, error, unit, said):
    text = GOOD.replace("value = 0.7", f"value = {value!r}").replace("error = 0.01", f"error = {error!r}")
    with pytest.raises(CaseError, match=f"(?s).*{said}"):
        read(tmp_path, text).observations[0].in_si(unit)


def test_a_discrepancy_is_added_to_the_error(tmp_path):
    found = read(tmp_path, GOOD.replace("error = 0.01", "error = 0.03\ndiscrepancy = 0.04"))
    held = found.observations[0].in_si("-")
    assert held == ObservedValue(0.7, 0.03, 0.04)
    assert held.width == pytest.approx(0.05)
    below = read(tmp_path, GOOD.replace("error = 0.01", "error = 0.01\ndiscrepancy = -0.04"))
    with pytest.raises(CaseError, match=r"discrepancy = -0\.04: must be 0 or more"):
        below.observations[0].in_si("-")
