"""A case's column of water, as the scene holds it."""

import math
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build, change
from ryusa.casefile import Case, ChangeSection, read, read_text
from ryusa.casefile.water.values import terminal_velocity
from ryusa.errors import CaseError
from ryusa.laws.families import (
    BedKind,
    Buoyancy,
    Drive,
    Fluctuations,
    Hindrance,
    Lift,
    Magnus,
    Mixing,
    Profile,
    SideWalls,
    SurfaceRule,
)
from ryusa.model import Column
from ryusa.running.runner import run

D, G = 0.002, 9.80665
BASE = """
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
slope = "1/20"
[build]
kind = "packing"
columns = 20
layers = 10
[water]
profile = "column"
depth = "2 cm"
[stop]
time = "1 s"
"""
FLAT = "{ kind = 'packing', columns = 20, layers = 10, bed = 'flat' }"
FLOOR = "{ kind = 'packing', columns = 20, layers = 10, bed = 'plane' }"


@pytest.fixture
def shipped() -> Path:
    import ryusa.cases as _cases

    return Path(next(iter(_cases.__path__)))


def case(**keys: str) -> Case:
    return read_text(BASE, {key.replace("__", "."): value for key, value in keys.items()})


def column(**keys: str) -> Column:
    found = build(case(**keys)).scene.column
    assert found is not None
    return found


def test_water_of_a_column_carries_its_laws() -> None:
    keys = {
        "water__buoyancy": "pressure",
        "water__hindrance": "Richardson-Zaki",
        "water__lift": "Wiberg-Smith",
        "water__lift_coefficient": "0.3",
        "water__magnus": "Loth",
    }
    water = build(case(**keys)).scene.water
    assert (water.profile, water.buoyancy) == (Profile.COLUMN, Buoyancy.PRESSURE)
    assert (water.hindrance, water.lift) == (Hindrance.RICHARDSON_ZAKI, Lift.WIBERG_SMITH)
    assert (water.magnus, water.c_l) == (Magnus.LOTH, 0.3)
    assert 2.3 < water.hindrance_exponent < 2.6
    assert build(case()).scene.water.buoyancy == Buoyancy.STRESS


def test_the_random_walk_uses_the_seed_of_the_case() -> None:
    assert column().fluctuations is Fluctuations.NONE
    stirred = column(water__column__fluctuations="random walk", seed="42")
    assert (stirred.fluctuations, stirred.seed) == (Fluctuations.RANDOM_WALK, 42)


def test_a_scene_without_a_column_of_water_has_none() -> None:
    still = read_text(BASE.replace('"column"', '"still"'))
    assert build(still).scene.column is None


def test_cells_begin_below_the_grains_and_hold_depth_and_first_grains() -> None:
    for depth in ("2 cm", "0.2 cm", "20 cm"):
        built = build(case(water__depth=depth))
        scene, found = built.scene, built.scene.column
        assert found is not None
        assert found.dz == pytest.approx(0.1 * D)
        assert found.z_low == pytest.approx(float(scene.x_fixed[:, 2].min()) - D / 2)
        highest = float(built.state.x[:, 2].max()) + D / 2
        assert found.z_high >= max(found.origin + 1.2 * found.depth, highest) - 1e-12
        assert found.z_high < max(found.origin + 1.2 * found.depth, highest) + found.dz
        assert found.z_surface == pytest.approx(scene.water.z_zero + found.depth)
        assert found.refuses() == ()


@pytest.mark.parametrize("lanes", [1, 3])
def test_a_plane_scene_covers_a_slab_for_every_lane(lanes: int) -> None:
    keys = {"build": f"{{ kind = 'saltation', n_bed = 12, starts = {lanes} }}"}
    assert column(**keys).area == pytest.approx(12 * D * D * lanes)
    assert column(**keys, motion__slab_width="1 cm").area == pytest.approx(12 * D * 0.01 * lanes)


def test_three_dimensions_cover_both_periods() -> None:
    build_ = FLOOR.replace("layers", "rows = 5, layers")
    found = column(build=build_, motion__plane="false")
    assert found.area == pytest.approx(20 * 5 * (1.1 * D) ** 2)


@pytest.mark.parametrize("packed", [0.5, 0.61])
def test_the_bed_of_a_packing_is_where_its_settled_grains_will_end(packed: float) -> None:
    built = build(case(build=FLAT, water__column=f"{{ packed = {packed} }}"))
    scene, found = built.scene, built.scene.column
    assert found is not None
    solid = float(np.sum(scene.d**3)) * math.pi / 6
    assert (found.origin - D) * found.area * packed == pytest.approx(solid)
    assert any("settled to the concentration" in note for note in built.notes)


@pytest.mark.parametrize(("build_", "zero"), [(FLAT, 0.75 * D), (FLOOR, 0.0)])
def test_over_a_fixed_bed_the_column_begins_at_its_zero(build_: str, zero: float) -> None:
    for keys, z_low in (
        ({}, zero),
        ({"water__zero": "0.1 cm"}, 0.001),
        ({"water__column__bottom": "0.1 cm"}, 0.001),
    ):
        found = column(build=build_, **{"water__column__bed": "rough"} | keys)
        assert (found.z_low, found.origin) == (pytest.approx(z_low), pytest.approx(z_low))
        assert (found.bed, found.k_rough, found.mixing) == (BedKind.ROUGH, D, Mixing.PARABOLIC)


def test_a_floor_is_the_bottom_and_a_bottom_given_is_taken() -> None:
    assert column(build=FLOOR).z_low == 0.0
    assert column(water__column__bottom="-1 cm").z_low == -0.01
    assert column(water__zero="-1 cm", water__depth="6 cm").z_low == -0.01  # never above the zero
    with pytest.raises(CaseError, match="above the bed") as caught:
        build(case(water__column__bottom="9 cm"))
    assert caught.value.key == "water.column.bottom"


def test_every_key_of_the_case_reaches_the_column() -> None:
    keys = "surface = 'volume', drive = 'discharge', discharge = '200 cm2/s', mixing_length = 'Prandtl',"
    keys += " kappa = 0.4, pore_eddies = 0.16, side_walls = '10 cm', side_friction = 'Karman-Prandtl',"
    keys += " interval = 10, cell = '1 mm'"
    found = column(water__column=f"{{ {keys} }}")
    assert (found.surface, found.drive, found.discharge) == (SurfaceRule.VOLUME, Drive.DISCHARGE, 0.02)
    assert (found.mixing, found.kappa, found.k_f, found.d) == (Mixing.PRANDTL, 0.4, 0.16, D)
    assert (found.side, found.width, found.interval) == (SideWalls.KARMAN_PRANDTL, 0.1, 10)
    assert found.dz == 0.001
    assert found.g_x == pytest.approx(G * math.sin(math.atan(0.05)))
    plain = column()
    assert (plain.side, plain.drive, plain.bed) == (SideWalls.NONE, Drive.GRAVITY, BedKind.MOVING)
    assert column(water__column="{ drive = 'tau_star' }", water__tau_star="0.3").tau == pytest.approx(
        0.3 * 1650 * G * D
    )
    asked = column(water__column="{ drive = 'pressure gradient', pressure_gradient = '50 Pa/m' }")
    assert (asked.drive, asked.gradient) == (Drive.GRADIENT, 50.0)


def test_a_new_slope_drives_the_water_too() -> None:
    one = case()
    before = build(one).scene
    tilted = change(one, before, ChangeSection.model_validate({"at": "0 s", "slope_angle": "30 deg"}))
    assert tilted.column is not None and before.column is not None
    assert tilted.column.g_x == pytest.approx(G / 2)
    assert tilted.column.g_x == tilted.gravity[0]
    assert before.column.g_x < tilted.column.g_x


def test_the_notes_list_the_free_choices_of_a_column() -> None:
    notes = " ".join(build(case()).notes)
    for part in ("water.buoyancy", "water.hindrance", "water.column.bed", "mixing length", "water.zero"):
        assert part in notes, part
    assert "water.above" not in notes
    one_way = " ".join(build(read_text(BASE.replace('"column"', '"still"'))).notes)
    assert "water.buoyancy" not in one_way


@pytest.mark.parametrize("name", ["settling_column", "movable_bed"])
def test_the_packaged_columns_contain_their_grains(name: str, shipped: Path) -> None:
    built = build(read(shipped / f"{name}.toml"))
    found = built.scene.column
    assert found is not None
    assert found.refuses() == ()
    assert (built.state.x[:, 2] - built.scene.d / 2 >= found.z_low - 1e-3).all()
    assert (built.state.x[:, 2] + built.scene.d / 2 <= found.z_high).all()


def test_the_packaged_suspension_settles_after_richardson_and_zaki(shipped: Path, tmp_path: Path) -> None:
    small = {"build.columns": "4", "build.rows": "4", "build.layers": "20", "water.depth": "2 cm"}
    one = read(shipped / "settling_column.toml", {**small, "stop.time": "0.12 s", "record.frames": "20 ms"})
    results = run(one, tmp_path / "run", progress=False)
    scene, frames = build(one).scene, results.frames
    amid = slice(16 * 8, 16 * 18)  # neither at the floor nor at the clear water
    fallen = np.asarray(frames[3].x)[amid, 2] - np.asarray(frames[6].x)[amid, 2]
    phi = 0.5236 / 1.8**3
    expected = terminal_velocity(one) * (1.0 - phi) ** scene.water.hindrance_exponent
    assert fallen.mean() / 0.06 == pytest.approx(expected, rel=0.02)
