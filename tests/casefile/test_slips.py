"""Slips of a stranger in packaged cases: the message names cause and remedy, and nothing false beside it."""

from pathlib import Path

import pytest

from ryusa.build import build
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read, read_text
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

SLIPS = [
    # case, key, value, what is said
    ("drop", "motion.plane", '"yes"', "motion.plane = 'yes': must be true or false"),
    ("drop", "motion.plane", "1", "motion.plane = 1: must be true or false"),
    ("sabo_dam", "build.walls", '"no"', "build.walls = 'no': must be true or false"),
    (
        "sabo_dam",
        "exits.0.point",
        '["1 m", "0 m"]',
        "exits.0.point = ['1 m', '0 m']: needs 3 entries such as '1 m'",
    ),
    ("sabo_dam", "feeds", '{ name = "a" }', "feeds: must be in double brackets, [[feeds]], once for each"),
    ("saltation", "water.torque", '"Deniss"', "Did you mean 'Dennis'?"),
    ("drop", "grains.d50", '"2 mm"', "grains.d50: unknown key. Did you mean 'grains.sieve_curve'?"),
    (
        "river",
        "water.row.dams.0.end",
        '"2.3 m"',
        "dams.0.end = '2.3 m': must lie downstream of its begin, 2.4 m",
    ),
    ("movable_bed", "grains.density", '"2.65 kg/m3"', "Did you mean '2.65 g/cm3'?"),
    ("river", "feeds.2.rate", '"1 kg/s"', "'2' is no entry: they count from 0 to 0 (feeder)"),
    ("river", "feeds.feeder.rate", '"1 kg/s"', "'feeder' is no entry: they count from 0 to 0 (feeder)"),
    ("river", "exits.5", "{}", "'5' is no entry: they count from 0 to 0 (outlet)"),
    ("sabo_dam", "exits.0.normal", "[0, 0, 0]", "exits.0.normal = [0, 0, 0]: must not be zero"),
]


@pytest.mark.parametrize("name, key, value, words", SLIPS)
def test_a_slip_is_answered_by_its_cause_alone(name: str, key: str, value: str, words: str) -> None:
    with pytest.raises(CaseError) as found:
        read(case_path(f"{name}.toml"), {key: value})
    assert words in str(found.value)
    assert not found.value.others


def test_an_exit_without_a_point_is_not_called_missing() -> None:
    text = case_path("sabo_dam.toml").read_text(encoding="utf-8").replace('point = ["1.3 m"', "#")
    with pytest.raises(CaseError) as found:
        read_text(text)
    assert found.value.key == "exits.0.point" and not found.value.others


def test_what_the_timeline_removes_is_sought_among_names(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_bytes(case_path("dam.toml").read_bytes())
    case = read(tmp_path / "own.toml", {"timeline": "[{ at = '0.1 s', remove = 'gaet' }]"})
    with pytest.raises(CaseError, match=r"own\.toml: timeline\.0\.remove = 'gaet'.*Did you mean 'gate'"):
        build(case)


def test_a_misspelt_file_is_sought_in_its_folder(tmp_path: Path) -> None:
    (tmp_path / "grains.csv").write_text("x [mm],z [mm],d [mm]\n0,5,2\n")
    (tmp_path / "own.toml").write_bytes(case_path("drop.toml").read_bytes())
    with pytest.raises(CaseError, match=r"Did you mean 'grains\.csv'"):
        read(tmp_path / "own.toml", {"build": "{ kind = 'table', file = 'grans.csv' }"})


def test_a_near_name_is_found_as_near() -> None:
    assert nearest_word("Deniss", ["none", "Stokes", "Dennis"]) == "Dennis"


def test_a_mesh_of_another_unit_is_named_with_its_size(tmp_path: Path) -> None:
    import trimesh

    trimesh.creation.box((10.0, 10.0, 10.0)).export(tmp_path / "thing.stl")
    mesh = '[[walls]]\nname = "thing"\nshape = "mesh"\nfile = "thing.stl"\nunit = "m"\n'
    mesh += 'at = ["0 m", "0 m", "5.02 m"]\n'
    text = case_path("column_collapse.toml").read_text(encoding="utf-8")
    (tmp_path / "own.toml").write_text(f"{text}\n{mesh}", encoding="utf-8")
    with pytest.raises(
        CaseError, match=r"own\.toml: build: first grains overlap: .*check its unit: it is 10 m long"
    ):
        build(read(tmp_path / "own.toml"))


def test_a_row_has_a_depth_and_its_mesh_a_dam(tmp_path: Path) -> None:
    import trimesh

    trimesh.creation.box((0.09, 0.048, 0.024)).export(tmp_path / "sill.stl")
    mesh = '[[walls]]\nname = "sill"\nshape = "mesh"\nfile = "sill.stl"\nunit = "m"\n'
    mesh += 'at = ["{} m", "0 m", "0.06 m"]\n'
    for x, without in ((0.8375, False), (0.3, True)):
        text = case_path("sabo_dam.toml").read_text(encoding="utf-8")
        (tmp_path / "own.toml").write_text(f"{text}\n{mesh.format(x)}", encoding="utf-8")
        case = read(tmp_path / "own.toml")
        assert any(row.name == "walls for grains alone" for row in explain(case)) is without
    assert not any("unlimited depth" in note for note in build(read(case_path("weir.toml"))).notes)
