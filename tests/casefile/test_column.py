"""Water that feels its grains, as a case file says it: what is read, what follows, what is refused."""

import math
from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.casefile import Case, all_keys, derive, explain, resolved
from ryusa.casefile.water.values import hindrance_exponent, terminal_velocity, water_speed
from ryusa.errors import CaseError
from ryusa.laws import drag, hindrance

CaseOf = Callable[..., Case]
PACKING = "{ kind = 'packing', columns = 5, layers = 3 }"
SPACE = {"build": PACKING.replace("}", ", rows = 5 }"), "motion__plane": "false"}
NARROW = {
    "build": "{ kind = 'flume', length = '6 cm', width = '6.6 mm', layers = 6 }",
    "motion__plane": "false",
}
D, G = 0.002, 9.80665
U_STAR = math.sqrt(G * 0.02 * math.sin(math.atan(0.05)))


def wet(case: CaseOf, keys: str = "", column: str = "", **others: str) -> Case:
    """Read a case with water 2 cm deep on a slope of 1/20; keys of [water] and of [water.column] on top."""
    depth = "" if "depth" in keys else "depth = '2 cm', "
    water = f"{{ profile = 'column', {depth}{keys}{', ' if keys else ''}column = {{ {column} }} }}"
    given = {"build": PACKING, "motion.slope": "1/20", "water": water}
    return case(**(given | {key.replace("__", "."): value for key, value in others.items()}))


def test_a_column_needs_no_table_of_its_own(case: CaseOf) -> None:
    one = case(build=PACKING, water="{ profile = 'column', depth = '2 cm' }", **{"motion.slope": "1/20"})
    assert one.water is not None and one.water.column is None
    kept = resolved(one)["water"]
    assert kept["column"]["cell"] == pytest.approx(0.1 * D)
    assert (kept["column"]["mixing_length"], kept["column"]["interval"]) == ("Li-Sawamoto", 50)
    assert (kept["buoyancy"], kept["hindrance"]) == ("stress", "Di Felice")
    assert kept["u_star"] == pytest.approx(U_STAR)


def test_a_given_flow_has_no_column(case: CaseOf) -> None:
    kept = resolved(case(water="{ profile = 'still' }"))["water"]
    assert not {"column", "buoyancy", "hindrance", "lift", "magnus"} & set(kept)


@pytest.mark.parametrize(
    ("bed", "mixing"), [("moving", "Li-Sawamoto"), ("rough", "parabolic"), ("smooth", "parabolic")]
)
def test_the_bed_chooses_the_mixing_length(case: CaseOf, bed: str, mixing: str) -> None:
    water = wet(case, column=f"bed = '{bed}'").water
    assert water is not None and water.column is not None
    assert water.column.mixing == mixing


@pytest.mark.parametrize(
    ("keys", "column", "u_star"),
    [
        ("", "", U_STAR),
        ("tau_star = 0.3", "drive = 'tau_star'", math.sqrt(0.3 * 1.65 * G * D)),
        ("u_star = '7 cm/s'", "drive = 'tau_star'", 0.07),
        (
            "",
            "drive = 'pressure gradient', pressure_gradient = '100 Pa/m'",
            math.sqrt(U_STAR**2 + 0.1 * 0.02),
        ),
        # 0.02 m2/s over 2 cm is 1 m/s; Eq. (9) has the mean 8.5 - 5.75/ln 10 + 5.75 log10(h/k) = 11.753
        ("", "drive = 'discharge', discharge = '0.02 m2/s'", 1.0 / 11.753),
    ],
)
def test_the_driver_gives_the_friction_velocity(case: CaseOf, keys: str, column: str, u_star: float) -> None:
    found = derive(wet(case, keys, column))
    assert found.u_star == pytest.approx(u_star, rel=1e-4)
    assert found.tau_star == pytest.approx(u_star**2 / (1.65 * G * D), rel=2e-4)


def test_still_water_has_no_friction_velocity(case: CaseOf) -> None:
    still = wet(case, motion__slope="0")
    assert math.isnan(derive(still).u_star)
    assert water_speed(still, derive(still), 0.01) == 0.0


def test_a_slope_of_the_timeline_drives_the_water(case: CaseOf) -> None:
    keys = {"motion__slope": "0", "timeline": "[{ at = '0.01 s', slope = '1/20' }]"}
    assert derive(wet(case, **keys)).u_star == pytest.approx(U_STAR)
    wet(case, "tau_star = 0.3", **keys)


def test_the_expected_speed_is_that_of_the_log_law_at_the_surface(case: CaseOf) -> None:
    rough, smooth = wet(case, column="bed = 'rough'"), wet(case, column="bed = 'smooth'")
    at = derive(rough)
    assert water_speed(rough, at, 0.02) == pytest.approx(U_STAR * (8.5 + 5.75))
    assert water_speed(rough, at, 0.05) == water_speed(rough, at, 0.02)
    assert water_speed(smooth, derive(smooth), 0.02) > water_speed(rough, at, 0.02)


def test_the_exponent_of_richardson_and_zaki_is_that_of_a_single_grain(case: CaseOf) -> None:
    one = wet(case, "hindrance = 'Richardson-Zaki'")
    re = drag.reynolds(terminal_velocity(one), D, 1e-6)
    assert hindrance_exponent(one) == hindrance.exponent_rowe(re)
    assert 2.3 < hindrance_exponent(one) < 2.6  # coarse grains
    assert hindrance_exponent(wet(case, "hindrance = 'Richardson-Zaki', hindrance_exponent = 3.1")) == 3.1
    light = {"grains.buoyant": "true"}
    floating = wet(case, "hindrance = 'Richardson-Zaki', density = '3 g/cm3'", **light)
    assert hindrance_exponent(floating) == hindrance.exponent_rowe(0.0)


@pytest.mark.parametrize(
    ("keys", "column", "others", "key", "part"),
    [
        ("above = 'hold'", "", {}, "water.above", "has no effect with profile 'column'"),
        ("depth = '-2 cm'", "", {}, "water.depth", "greater than 0"),
        ("speed = '1 m/s'", "", {}, "water.speed", "no effect with profile 'column'"),
        ("roughness = '1 mm'", "", {}, "water.roughness", "has no effect with bed 'moving'"),
        ("roughness = '1 mm'", "bed = 'smooth'", {}, "water.roughness", "has no effect with bed 'smooth'"),
        ("hindrance = 'power'", "", {}, "water.hindrance_exponent", "missing"),
        ("hindrance_exponent = 3.0", "", {}, "water.hindrance_exponent", "with hindrance 'Di Felice'"),
        ("hindrance = 'Wen-Yu', drag = 'none'", "", {}, "water.hindrance", "with drag 'none'"),
        ("hindrance = 'Wen-Yo'", "", {}, "water.hindrance", "Did you mean 'Wen-Yu'"),
        ("lift_coefficient = 0.3", "", {}, "water.lift_coefficient", "with lift 'none'"),
        ("", "drive = 'tau_star'", {}, "water.tau_star", "missing"),
        ("tau_star = 0.3", "", {"motion__slope": "0"}, "water.tau_star", "nothing drives"),
        ("tau_star = 0.1", "", {}, "water.tau_star", "contradict each other"),
        ("u_star = '0.2 m/s'", "", {}, "water.u_star", "a depth of"),
        ("tau_star = 0.3", "", {"motion__slope": "-0.05"}, "water.tau_star", "rises downstream"),
        ("", "drive = 'discharge'", {}, "water.column.discharge", "missing"),
        ("", "discharge = '1 m2/s'", {}, "water.column.discharge", "with drive 'slope'"),
        ("", "drive = 'discharge', discharge = '1 m/s'", {}, "water.column.discharge", "wrong unit"),
        ("", "drive = 'pressure gradient'", {}, "water.column.pressure_gradient", "missing"),
        ("", "pressure_gradient = '1 Pa/m'", {}, "water.column.pressure_gradient", "with drive 'slope'"),
        ("tau_star = 1.0", "drive = 'discharge', discharge = '1 m2/s'", {}, "water.tau_star", "'discharge'"),
        ("", "mixing_length = 'van Driest'", {}, "water.column.mixing_length", "needs a wall"),
        ("", "mixing_length = 'Prandtl', packed = 0.5", {}, "water.column.packed", "with mixing_length"),
        ("", "mixing_length = 'none', kappa = 0.4", {}, "water.column.kappa", "with mixing_length"),
        (
            "",
            "mixing_length = 'none', fluctuations = 'random walk'",
            {},
            "water.column.fluctuations",
            "with mixing_length",
        ),
        ("", "side_friction = 'Blasius'", {}, "water.column.side_friction", "side_walls"),
        ("", "cel = '1 mm'", {}, "water.column.cel", "Did you mean 'water.column.cell'"),
        ("", "cell = '1 nm'", {}, "water.column.cell", "more than 20,000 cells"),
        ("", "cell = '0.1 mm', bed = 'rough'", {}, "water.column.cell", "1/15 of the roughness"),
        ("", "cell = '2 cm'", {}, "water.column.cell", "at most half of water.depth"),
        ("", "packed = 0.8", SPACE, "water.column.packed", "at most 0.7405"),
        ("", "side_walls = '1 mm'", {}, "water.column.side_walls", "at least 2 mm, the largest diameter"),
        ("", "side_walls = '6 mm'", NARROW, "water.column.side_walls", "at least build.width, 6.6 mm"),
        ("", "drive = 'discharge', discharge = '-1 m2/s'", {}, "water.column.discharge", "above 0 m2/s"),
        (
            "",
            "drive = 'pressure gradient', pressure_gradient = '0 Pa/m'",
            {"motion__slope": "0"},
            "water.column.pressure_gradient",
            "nothing drives",
        ),
        ("zero = '-2 cm'", "", {}, "water.depth", "puts the surface into the bed"),
        ("zero = '0 cm', depth = '0.9 cm'", "", NARROW, "water.depth", "must be above 0.9364 cm"),
        ("", "interval = 0", {}, "water.column.interval", "at least 1"),
        ("zero = '1 cm'", "bottom = '2 cm'", {}, "water.column.bottom", "must be at most water.zero, 1 cm"),
        ("zero = '1 cm'", "bottom = '0 cm', bed = 'rough'", {}, "water.column.bottom", "a fixed bed"),
        ("", "", {"build": "{ kind = 'drop', height = '1 cm' }"}, "water.profile", "periodic in x"),
        ("", "", {"build": "{ kind = 'box', columns = 3, layers = 2 }"}, "water.profile", "periodic in x"),
        (
            "",
            "",
            {"build": PACKING.replace("}", ", periodic = false }")},
            "water.profile",
            "give build.periodic = true",
        ),
    ],
)
def test_a_column_that_cannot_be_is_refused(
    case: CaseOf, keys: str, column: str, others: dict[str, str], key: str, part: str
) -> None:
    with pytest.raises(CaseError) as caught:
        wet(case, keys, column, **others)
    assert caught.value.key == key
    assert part in str(caught.value)
    assert not caught.value.others


def test_a_column_without_a_depth_is_refused(case: CaseOf) -> None:
    with pytest.raises(CaseError, match=r"water\.depth: missing"):
        case(build=PACKING, water="{ profile = 'column' }")


@pytest.mark.parametrize(
    "keys",
    [
        "buoyancy = 'stress'",
        "hindrance = 'none'",
        "lift = 'none'",
        "lift_coefficient = 0.2",
        "magnus = 'Loth'",
        "column = {}",
        "column = { cell = '1 mm' }",
    ],
)
def test_keys_of_a_column_have_no_effect_elsewhere(case: CaseOf, keys: str) -> None:
    with pytest.raises(CaseError, match="has no effect with profile 'log rough'") as caught:
        case(water=f"{{ profile = 'log rough', tau_star = 0.3, {keys} }}")
    assert caught.value.key == f"water.{keys.split(maxsplit=1)[0]}"


def test_three_dimensions_need_a_period_across(case: CaseOf, tmp_path) -> None:
    build = "{ kind = 'saltation' }"
    with pytest.raises(CaseError, match="periodic in y"):
        wet(case, build=build, motion__plane="false")
    wet(case, build=build)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    key=st.sampled_from([key for key in all_keys() if key.startswith(("water.", "motion.", "grains."))]),
    value=st.one_of(
        st.floats().map(str),
        st.sampled_from(["'1e-290 m'", "'1e99 m'", "'1e99 m2/s'", "'-1 m'", "'0 m/s2'", "'1e-9 Pa/m'"]),
        st.sampled_from(["'tau_star'", "'discharge'", "'rough'", "'none'", "{}", "true", "1", "-1", "'1/3'"]),
    ),
    rough=st.booleans(),
)
def test_any_value_of_any_key_is_read_or_refused_with_a_case_error(
    case: CaseOf, key: str, value: str, rough: bool
) -> None:
    try:
        found = wet(case, column="bed = 'rough'" if rough else "", **{key.replace(".", "__"): value})
    except CaseError as error:
        assert str(error)
        return
    assert explain(found)
    assert resolved(found)


def test_a_stress_on_the_rigid_bed_under_grains_that_all_move_does_not_contradict(case: CaseOf) -> None:
    # fig17: no deposit; the stress of slope and whole depth, though loose grains take up half of it at rest
    tau_star = 0.02 * math.sin(math.atan(0.05)) / (1.65 * D)
    loose = "{ kind = 'packing', columns = 20, layers = 6, bed = 'flat' }"
    one = wet(case, f"tau_star = {tau_star:.6g}, zero = '0.2 cm'", build=loose)
    assert derive(one).tau_star == pytest.approx(tau_star, rel=1e-5)
    with pytest.raises(CaseError, match="contradict"):
        wet(case, f"tau_star = {2.0 * tau_star:.6g}, zero = '0.2 cm'", build=loose)
