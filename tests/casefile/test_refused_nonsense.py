"""What cannot be meant is refused before a run: wrong signs of weight, depths, slopes, units of a mesh."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from ryusa.casefile import explain
from ryusa.casefile.case import Case
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.errors import CaseError

BED, RIVER, DRY = (case_path(f"{name}.toml") for name in ("bedload_3d", "sabo_dam", "column_collapse"))
HOPS = case_path("saltation.toml")
PUMICE = {"grains.density": "500 kg/m3"}
MIXED = {"materials": "{ lead = { density = '113000 kg/m3' } }", "grains.mixture": "{ lead = 0.5 }"}
MESH = """
[[walls]]
name = "sill"
shape = "mesh"
file = "sill.stl"
unit = "{unit}"
at = [{x}, "0 cm", {z}]
"""


def said(path: Path, changes: dict[str, str]) -> str:
    with pytest.raises(CaseError) as found:
        read(path, changes)
    return str(found.value)


@pytest.mark.parametrize(
    "path, changes, words",
    [
        (BED, PUMICE, "grains.density = '500 kg/m3': is lighter than the water, 1000 kg/m3"),
        (RIVER, PUMICE, "grains.buoyant = true"),
        (BED, {"water.density": "2700 kg/m3"}, "lighter than the water, 2700 kg/m3"),
        (
            HOPS,
            PUMICE | {"grains.buoyant": "true"},
            "tau_star = 0.3: needs grains denser than water; give u_star",
        ),
        (HOPS, {"grains.density": "1 g/cm3"}, "needs grains denser than water; give u_star"),
        (BED, {"grains.buoyant": "true"}, "has no effect: no grain is lighter"),
        (DRY, {"grains.buoyant": "true"}, "has no effect without [water]"),
        (BED, {"water.depth": "2 mm"}, "covers no grain: at least their diameter, 4 mm"),
        (BED, {"motion.slope": "1.5"}, "Were 1.5 deg meant, or '1.5 %'"),
        (DRY, {"motion.slope": "-3"}, "motion.slope_angle = '-71.6 deg'"),
        (BED, {"contact.friction": "0.3", "contact.friction_angle": "20 deg"}, "excludes --set"),
        (BED, {"contact.friction_angle": "20 deg", "contact.friction": "0.3"}, "excludes --set"),
        (DRY, {"motion.slope": "0.1", "motion.slope_angle": "5 deg"}, "give only one of the two"),
    ],
)
def test_it_is_refused_with_what_to_do(path: Path, changes: dict[str, str], words: str) -> None:
    assert words in said(path, changes)


def test_what_is_asked_for_is_read() -> None:
    case = read(BED, PUMICE | {"grains.buoyant": "true", "water.column.drive": "slope"})
    assert case.grains.buoyant
    assert read(BED, {"motion.slope_angle": "50 deg"}).motion.slope_angle == pytest.approx(np.radians(50.0))
    assert read(BED, {"contact.friction": "0.3"}).contact.friction == 0.3  # in place of the angle of the file
    heavy = read(BED, {"grains.density": "1000 kg/m3"})  # neutral: it neither sinks nor rises
    assert heavy.grains.density == 1000.0


@pytest.mark.parametrize(
    "name, changes, words",
    [
        (
            "column_collapse",
            {"grains.density": "26500 kg/m3"},
            "grains.density = 2.65e+04 kg/m3: pumice has about 500",
        ),
        ("box", MIXED, "materials.lead.density = 1.13e+05 kg/m3"),
        ("bedload_3d", {"water.density": "1 kg/m3"}, "water.density = 1 kg/m3: fresh water has 1000"),
        ("movable_bed", {"water.viscosity": "1e-3 m2/s"}, "its dynamic viscosity 1e-3 Pa s"),
        ("sheet_flow", {"water.depth": "6 m"}, "water.depth = 6 m: 1.5e+03 diameters"),
        ("river", {"water.depth": "1 mm"}, "water.depth = 0.001 m: 0.1 diameters"),
        (
            "river",
            {"water.row.dams.0.height": "4.5 m"},
            "m: height over the bottom, in a row of 3 m",
        ),
    ],
)
def test_values_far_from_those_of_sediment_are_warned_of(name, changes, words) -> None:
    def said(case: Case) -> str:
        return "\n".join(
            f"{row.name} = {row.shown}: {row.origin}" for row in explain(case) if row.section == "unusual"
        )

    assert words in said(read(case_path(f"{name}.toml"), changes))
    assert said(read(case_path(f"{name}.toml"))) == ""


def river(folder: Path, long: float, high: float, x: str, z: str = "0", unit: str = "m") -> Case:
    """The packaged dam in a row of 1.3 m, with a box of a mesh, in metres, put to x."""
    trimesh.creation.box((long, 0.048, high)).export(folder / "sill.stl")
    text = RIVER.read_text(encoding="utf-8") + MESH.format(unit=unit, x=f'"{x} m"', z=f'"{z} m"')
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return read(folder / "case.toml")


@pytest.mark.parametrize(
    "long, x, z, unit, words",
    [
        (80.0, "0.8", "0.05", "m", "is 80 m long, where the row is 1.3 m: check unit, scale and place"),
        (80.0, "0.8", "0.05", "m", "It would be in mm 0.08 m, in cm 0.8 m long"),
        (0.08, "8", "0.05", "m", "beside the row, which reaches from 0 to 1.3 m"),
        (0.08, "0.8", "2", "m", "lies between z = 1.99"),
        (0.08, "0.8", "-1", "m", "lies between z = -1.01"),
    ],
)
def test_a_mesh_that_does_not_belong_to_the_river(tmp_path, long, x, z, unit, words) -> None:
    with pytest.raises(CaseError) as found:
        river(tmp_path, long, 0.028, x, z, unit)
    assert words in str(found.value)


@pytest.mark.parametrize("high, warned", [(0.028, False), (0.09, True), (0.006, True)])
def test_a_dam_that_differs_from_its_mesh_is_a_warning(tmp_path, high, warned) -> None:
    foot = 0.133 - 0.084 - 0.049 * 0.2375 / 0.7  # of the bottom in the middle of the dam
    case = river(tmp_path, 0.09, high, "0.8375", f"{foot + 0.5 * high:.4f}")
    rows = [row for row in explain(case) if "two structures" in row.origin]
    assert [row.flag for row in rows] == ["warning"] * warned
