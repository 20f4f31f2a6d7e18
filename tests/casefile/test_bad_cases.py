"""A bad case file gives one clear message: key path, value, what is allowed, nearest known key."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.casefile import Case, all_keys, derive, explain, read, read_text
from ryusa.errors import CaseError

BAD = [
    # key, value, part of the message
    ("grains.diametr", "'0.2 cm'", "Did you mean 'grains.diameter'"),
    ("contakt", "1", "Did you mean 'contact'"),
    ("diameter", "'1 cm'", "Did you mean 'grains.diameter'"),
    ("grains.diameter", "'0.2 kg'", "wrong unit"),
    ("grains.diameter", "0.2", "missing unit"),
    ("grains.diameter", "'0.2'", "missing unit"),
    ("grains.diameter", "'-0.2 cm'", "must be at least"),
    ("grains.diameter", "'0 cm'", "must be at least"),
    ("grains.diameter", "nan", "missing unit"),
    ("grains.diameter", "'nan cm'", "finite number"),
    ("grains.diameter", "'1e-300 m'", "must be at least"),
    ("grains.diameter", "[1]", "written as text"),
    ("contact.restitution", "nan", "must be finite"),
    ("contact.restitution", "inf", "must be finite"),
    ("contact.restitution", "0.0", "must be greater than 0"),
    ("contact.restitution", "1.2", "must be at most 1"),
    ("contact.restitution", "'0.7'", "without quotes"),
    ("contact.restitution", "true", "must be a number"),
    ("contact.stiffness", "'-100 N/cm'", "must be at least"),
    ("contact.stiffness", "{ overlap = 0.01 }", "contact.stiffness.speed: missing"),
    ("contact.stiffness", "{ collision_time = '1 cm' }", "wrong unit"),
    ("contact.stiffness", "{ overlap = 0.01, sped = '1 m/s' }", "contact.stiffness.speed"),
    ("contact.slip", "'sprng'", "Did you mean 'spring'"),
    ("contact.cohesion", "'-1 N'", "must be at least 0"),
    ("grains.spread", "0.95", "must be less than 0.9"),
    ("grains.spread", "{ kind = 'gauss', ratio = 0.1 }", "must be one of 'uniform', 'normal', 'lognormal'"),
    ("motion.rotation", "'lockd'", "Did you mean 'locked'"),
    ("motion.slope", "'1/0'", "finite ratio"),
    ("motion.slope", "'steep'", "ratio such as '1/20'"),
    ("motion.slope", "nan", "must be finite"),
    ("time.steps_per_contact", "4", "must be at least 5"),
    ("time.step", "'1 ms'", "must be below"),
    ("time.step", "'1e-12 s'", "must be above"),
    ("time.step", "'0 s'", "must be greater than 0"),
    ("build.kind", "'drops'", "Did you mean 'drop'"),
    ("build.kind", "5", "must be one of drop"),
    ("build.offset", "'0.3 cm'", "smaller than the diameter"),
    ("build.n_bed", "20", "unknown key; builder 'drop' has none, 'saltation' has"),
    ("stop.saltations", "0", "must be at least 1"),
    ("stop.saltations", "3.5", "must be a whole number"),
    ("stop.saltations", "3", "needs a bed"),
    ("stop.rest", "{ speed = '1 mm/s' }", "stop.rest.for: missing"),
    ("seed", "-1", "must be at least 0"),
    ("record.tracked", "[7]", "must be below 1"),
    ("record.events", "'tracked'", "needs the numbers of grains"),
    ("record.settle", "'1 s'", "shorter than stop.time"),
    ("record.settle", "'1 s'", "--set record.settle="),
    ("timeline", "[{ at = '0.01 s' }]", "exactly one of"),
    ("timeline", "[{ at = '0.05 s', friction = 1 }, { at = '0.01 s', friction = 0 }]", "in order of time"),
    ("timeline", "[{ at = '5 s', friction = 1 }]", "timeline.0.at = '5 s': comes after stop.time, 0.1 s"),
    ("record.frames", "'1 ns'", "record.frames = '1 ns': must be at least one step"),
    (
        "record.frames",
        "'10 s'",
        "record.frames = '10 s': must be at most stop.time, 0.1 s: the run would keep",
    ),
    ("planes", "[{ name = 'a', point = ['0 m', '0 m', '0 m'], normal = [0, 0, 0] }]", "must not be zero"),
    ("planes", "5", "must be a list"),
    ("domain.period_y", "'10 cm'", "no effect in a plane scene"),
    ("grains", "5", "must be a table"),
    ("domain.period_x", "'0.1 cm'", "at least 3 largest diameters"),
    ("rolling.model", "'constant'", "needs motion.rotation"),
    ("rolling.coefficient", "0.1", "has no effect"),
    ("rolling.twisting_coefficient", "0.1", "needs motion"),
    ("rolling.twisting_coefficient", "-0.1", "must be at least 0"),
    ("water", "{ profile = 'log rough' }", "needs tau_star or u_star"),
    ("water", "{ profile = 'still', u_star = '1 m/s' }", "has no effect"),
    ("water", "{ profile = 'uniform' }", "needs it"),
    ("water", "{ profile = 'still', torque = 'Stokes' }", "needs motion.rotation"),
    ("water", "{ profile = 'still', drag_coefficient = 1.0 }", "has no effect"),
    ("water", "{ profile = 'log rough', tau_star = 0.3, density = '2.65 g/cm3' }", "denser than water"),
]


@pytest.mark.parametrize(("key", "value", "part"), BAD)
def test_a_bad_value_is_named_with_its_key_and_what_is_allowed(
    case: Callable[..., Case], key: str, value: str, part: str
) -> None:
    with pytest.raises(CaseError) as caught:
        case(**{key: value})
    message = str(caught.value)
    assert part in message
    assert caught.value.key.startswith((key.split(".", maxsplit=1)[0], "--set"))
    assert "pydantic" not in message and "Input should" not in message
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("build", "plane", "normal", "part"),
    [
        ("{ kind = 'saltation' }", "true", "[-1, 0, 0]", "must have x = 0, because x is periodic"),
        (
            "{ kind = 'packing', columns = 4, layers = 1 }",
            "true",
            "[-1, 0, 1]",
            "build.periodic = false opens the ends",
        ),
        ("{ kind = 'packing', columns = 4, rows = 4, layers = 1 }", "false", "[0, 1, 0]", "must have y = 0"),
    ],
)
def test_a_wall_across_a_period_is_refused(
    case: Callable[..., Case], build: str, plane: str, normal: str, part: str
) -> None:
    gate = f"[{{ name = 'gate', point = ['5 cm', '0 cm', '0 cm'], normal = {normal} }}]"
    with pytest.raises(CaseError, match=r"planes\.0\.normal") as caught:
        case(build=build, planes=gate, **{"motion.plane": plane})
    assert part in str(caught.value)
    case(build=build, planes=gate.replace(normal, "[0, 0, 1]"), **{"motion.plane": plane})


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ({"contact.shear_ratio": "10", "time.step": "1.3e-5 s"}, "tangential motion"),
        ({"contact.damping": "1000 N s/m", "contact.parting": "tension"}, "normal motion"),
        ({"contact.damping": "0 N s/m", "contact.shear_damping": "1000 N s/m"}, "tangential motion"),
        (
            {"contact.damping": "0 N s/m", "contact.shear_damping": "1e3 N s/m", "contact.shear_ratio": "0"},
            "tang",
        ),
    ],
)
def test_a_step_beyond_the_stable_one_is_refused(
    case: Callable[..., Case], keys: dict[str, str], part: str
) -> None:
    with pytest.raises(CaseError, match="the largest step at which") as caught:
        case(**{"motion.rotation": "free", **keys})
    assert part in str(caught.value)
    assert caught.value.key.startswith("time.")


@pytest.mark.parametrize(
    ("line", "part"),
    [
        ('friction = 0.5\nfriction_angle = "30 deg"', "give only one of the two"),
        ("friction_angle = '30 deg'\ndamping = '1 N s/m'", "give only one of the two"),
        (
            "friction_angle = '30 deg'\nshear_ratio = 0.3\nshear_stiffness = '1 N/m'",
            "give only one of the two",
        ),
        ("restitution_shear = 0.7", "contact.friction_angle: missing"),
    ],
)
def test_contradicting_and_missing_keys_are_reported(text: str, line: str, part: str) -> None:
    with pytest.raises(CaseError, match=part):
        read_text(text.replace('friction_angle = "30 deg"', line))


def test_all_missing_required_keys_are_reported_together() -> None:
    with pytest.raises(CaseError) as caught:
        read_text("")
    message = str(caught.value)
    for key in ("grains", "contact", "motion", "build", "stop"):
        assert f"  {key}: missing" in message
    assert len(caught.value.others) == 4


def test_several_errors_of_a_file_are_reported_together(text: str) -> None:
    broken = text.replace('"0.2 cm"', '"0.2 kg"').replace("0.7", "7").replace("rotation", "rotaton")
    with pytest.raises(CaseError) as caught:
        read_text(broken)
    message = str(caught.value)
    assert message.startswith("4 faults\n")
    assert "grains.diameter = '0.2 kg'" in message
    assert "contact.restitution = 7" in message
    assert "Did you mean 'motion.rotation'" in message


def test_invalid_toml_is_reported_with_its_line(text: str) -> None:
    with pytest.raises(CaseError, match="line 3"):
        read_text(text.replace('diameter = "0.2 cm"', "diameter = 0.2 cm"))


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ('rotation = "free"', 'line 11, column 18), rotation = "free": rotation stands twice in its section'),
        ("[grains]", "[grains]: this section stands twice"),
        ('file = "a.csv', 'file = "a.csv: a quote is missing'),
        ("plane = True", "plane = True: write true or false"),
        ("file = \u201ca.csv\u201d", "write plain quotes"),
        ("gravity = 0,7", "decimals stand behind a point: gravity = 0.7"),
        ("gravity = 9.81 m/s2  # here", 'write it in quotes: gravity = "9.81 m/s2"'),
        ("file = beds", 'write it in quotes: file = "beds"'),
    ],
)
def test_invalid_toml_is_answered_by_its_line_and_a_remedy(text: str, line: str, remedy: str) -> None:
    with pytest.raises(CaseError) as found:
        read_text(text.replace('rotation = "locked"', f'rotation = "locked"\n{line}'))
    assert remedy in str(found.value)


def test_a_missing_file_a_folder_and_a_binary_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="file not found"):
        read(tmp_path / "none.toml")
    with pytest.raises(CaseError, match="is a folder"):
        read(tmp_path)
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CaseError, match="not UTF-8"):
        read(tmp_path / "bytes.toml")
    (tmp_path / "latin.toml").write_bytes("[grains]\n# gro\u00df\n".encode("latin-1"))
    with pytest.raises(CaseError, match=r"line 2 holds .* \(byte 14\); save the file as UTF-8"):
        read(tmp_path / "latin.toml")
    with pytest.raises(CaseError, match="cannot be read"):
        read("a\0b.toml")


def test_too_many_grains_are_refused_before_they_are_placed(case: Callable[..., Case]) -> None:
    keys = {"build": "{ kind = 'packing', columns = 100000, rows = 1, layers = 100000 }"}
    with pytest.raises(CaseError, match="grains; at most"):
        case(**keys)


@pytest.mark.parametrize("key", ["", ".", "a..b", "seed.x", "grains.diameter.deep", "a.b.c.d.e.f.g.h.i.j"])
def test_an_unknown_key_in_set_is_refused(case: Callable[..., Case], key: str) -> None:
    with pytest.raises(CaseError):
        case(**({"seed": "1"} if key == "seed.x" else {}), **{key: "1"})


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    key=st.sampled_from(all_keys()),
    value=st.one_of(
        st.text(max_size=12),
        st.integers().map(str),
        st.floats().map(str),
        st.sampled_from(
            [
                "''",
                "[]",
                "{}",
                "[[]]",
                "true",
                "nan",
                "'1 m'",
                "'1 s'",
                "'1e300 N/m'",
                "'1e-300 m'",
                "9" * 400,
            ]
        ),
        st.sampled_from(
            ["'1e6 s'", "'1e-290 s'", "'1e99 m/s'", "2020-01-01", "'1/3'", "1e300", "-0.0", "[1, 2, 3]"]
        ),
    ),
)
def test_any_value_of_any_key_is_read_or_refused_with_a_case_error(
    case: Callable[..., Case], key: str, value: str
) -> None:
    try:
        found = case(**{key: value})
    except CaseError as error:
        assert str(error)
        return
    assert derive(found).dt > 0.0
    assert explain(found)


@settings(max_examples=100)
@given(st.text(max_size=60))
def test_any_text_is_refused_with_a_case_error(text: str) -> None:
    with pytest.raises(CaseError):
        read_text(text)
