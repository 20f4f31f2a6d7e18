"""A flume holds as many layers as asked for, between its walls, over a base about z = 0."""

import math

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import Case, derive, read_text
from ryusa.casefile.builders.values import bed_area
from ryusa.casefile.column.bed import bed_thickness
from ryusa.errors import CaseError

D = 0.006
BASE = """
[grains]
diameter = "6 mm"
density = "2500 kg/m3"
[contact]
stiffness = "190 N/cm"
restitution = 0.5
friction = 0.4
[motion]
rotation = "free"
plane = false
slope_angle = "0.1 rad"
[build]
kind = "flume"
length = "30 cm"
width = "6.5 mm"
layers = 7.08
[stop]
time = "1 s"
"""
WATER = "{ profile = 'column', depth = '1 cm' }"


def case(build: str = "", **others: str) -> Case:
    said = [one.split("=") for one in build.split(";") if one]
    keys = {f"build.{key.strip()}": value.strip() for key, value in said}
    return read_text(BASE, {**keys, **{key.replace("__", "."): value for key, value in others.items()}})


def test_a_flume_one_grain_wide_contains_layers_times_length_over_d_grains() -> None:
    built = build(case())
    assert built.scene.n_grain == round(7.08 * 50)
    assert built.scene.n_fixed == 50
    assert built.scene.period[0] == pytest.approx(0.3)
    assert math.isinf(built.scene.period[1])


@pytest.mark.parametrize("build_keys", ["", "width='3.1 cm'", "width='3.1 cm'; walls=false", "bed='plane'"])
@pytest.mark.parametrize("spread", ["0.0", "0.08"])
def test_no_first_grain_touches_another_or_a_wall(build_keys: str, spread: str) -> None:
    # overlaps between grains are refused by the builder itself
    built = build(case(build_keys, grains__spread=spread))
    scene, x = built.scene, built.state.x
    for normal, point in zip(scene.plane_normal, scene.plane_point, strict=True):
        assert np.min((x - point) @ normal - 0.5 * scene.d) >= -1e-12
    assert scene.n_plane == 2 * ("false" not in build_keys) + ("plane" in build_keys)


def test_the_base_lies_at_zero_on_average_over_eleven_twelfths_of_a_grain() -> None:
    scene = build(case("length='300 cm'")).scene
    z = scene.x_fixed[:, 2]
    assert abs(z.mean()) < 1e-12
    assert np.ptp(z) == pytest.approx(11 / 12 * D, rel=0.02)
    assert np.ptp(build(case("bed='flat'")).scene.x_fixed[:, 2]) == 0.0


def test_the_zero_of_the_water_is_the_top_of_the_loose_bed_once_packed() -> None:
    one = case(water=WATER)
    built = build(one)
    height = derive(one).n_grain * math.pi / 6 * D**3 / (0.3 * 0.0065 * 0.61)
    assert built.scene.water.z_zero == pytest.approx(height, rel=1e-12)
    assert bed_thickness(one) == pytest.approx(height, rel=1e-12)
    assert built.scene.column is not None
    assert built.scene.column.area == pytest.approx(0.3 * 0.0065)
    assert any("settled to the concentration 0.61" in note for note in built.notes)


def test_a_plane_flume_is_one_slab_wide() -> None:
    one = read_text(BASE.replace('width = "6.5 mm"\n', ""), {"motion.plane": "true"})
    built = build(one)
    assert np.all(built.state.x[:, 1] == 0.0)
    assert built.scene.n_plane == 0
    assert bed_area(one) == pytest.approx(0.3 * D)


@pytest.mark.parametrize(
    ("keys", "others", "key", "says"),
    [
        ("width='5 mm'", {}, "build.width", "at least 6 mm"),
        ("walls=false; width='1 cm'", {}, "build.width", "at least 1.8 cm"),
        ("length='1 cm'", {}, "build.length", "at least 1.8 cm"),
        ("", {"motion.plane": "true"}, "build.width", "plane scene"),
        ("layers=0.001", {}, "build.layers", "no grain"),
        ("waves=1", {}, "build.wave_height", "missing"),
        ("wave_height='1 cm'", {}, "build.waves", "missing"),
        ("waves=7; wave_height='1 cm'", {}, "build.waves", "at most 6: a wave must be 8 grains long"),
        ("waves=1; wave_height='5.6 cm'", {}, "build.wave_height", "at most 5.532 cm"),
        ("waves=1; wave_height='1 cm'; layers=1", {}, "build.wave_height", "at most 0 cm"),
        ("waves=-1; wave_height='1 cm'", {}, "build.waves", "at least 0"),
    ],
)
def test_a_flume_that_cannot_be_is_refused(keys: str, others: dict[str, str], key: str, says: str) -> None:
    with pytest.raises(CaseError, match=says) as caught:
        case(keys, **others)
    assert caught.value.key == key


@pytest.mark.parametrize("spread", ["0.0", "0.08"])
@pytest.mark.parametrize("keys", ["width='3.1 cm'; walls=false", "width='3.1 cm'", "bed='plane'"])
def test_waves_of_the_bed_have_their_height_and_a_crest_at_the_beginning(keys: str, spread: str) -> None:
    one = case(f"{keys}; length='120 cm'; layers=8; waves=2; wave_height='3 cm'", grains__spread=spread)
    even = case(f"{keys}; length='120 cm'; layers=8", grains__spread=spread)
    built = build(one)
    assert built.scene.n_grain == build(even).scene.n_grain  # waves move grains, and add none
    width = bed_area(one) / 1.2
    phase = 2.0 * np.pi * 2.0 * built.state.x[:, 0] / 1.2
    volume = np.pi / 6.0 * built.scene.d**3
    # thickness = mean + height/2 cos: twice the mean of the volume times cos is that half height, settled
    half = 2.0 * (volume * np.cos(phase)).sum() / (1.2 * width * 0.61)
    assert half == pytest.approx(0.015, rel=0.06)
    assert abs(2.0 * (volume * np.sin(phase)).sum() / (1.2 * width * 0.61)) < 0.06 * 0.015


def test_waves_without_a_height_are_an_even_bed() -> None:
    assert np.array_equal(build(case("waves=0")).state.x, build(case()).state.x)


def test_waves_in_a_plane_flume() -> None:
    text = BASE.replace('width = "6.5 mm"\n', "")
    keys = {"motion.plane": "true", "build.length": "'120 cm'", "build.waves": "1"}
    x = build(read_text(text, {**keys, "build.wave_height": "'2 cm'"})).state.x
    assert np.all(x[:, 1] == 0.0)
    ends, middle = x[np.abs(x[:, 0] - 0.6) > 0.5], x[np.abs(x[:, 0] - 0.6) < 0.1]
    assert np.ptp(ends[:, 2]) > np.ptp(middle[:, 2]) + 1.5 * D


def test_a_flume_without_width_in_three_dimensions_is_refused() -> None:
    with pytest.raises(CaseError, match="needs a width"):
        read_text(BASE.replace('width = "6.5 mm"\n', ""))
