from pathlib import Path

import pytest

from ryusa.build import build
from ryusa.casefile import derive, explain, read
from ryusa.errors import CaseError

CSV = """# a line of remarks
x [cm], z [mm], d [cm], vx [cm/s], fixed, group
0, 1, 0.2, 0, 1, gate
1, 1, 0.2, 0, 1, bed2
0.5, 5, 0.2, 10, 0,
0, 3.1, 0.3, 0, 1, gate
"""


def write(folder: Path, text: str, table: str, name: str = "grains.csv") -> Path:
    (folder / "grains.csv").write_text(table, encoding="utf-8")
    path = folder / "case.toml"
    path.write_text(
        text.replace('kind = "drop"\nheight = "1 cm"', f'kind = "table"\nfile = "{name}"'), encoding="utf-8"
    )
    return path


def test_a_table_gives_grains_in_si_with_groups_contiguous(text: str, tmp_path: Path) -> None:
    case = read(write(tmp_path, text, CSV))
    assert (derive(case).n_grain, derive(case).n_fixed, derive(case).meet) == (1, 3, False)
    built = build(case)
    assert built.state.x.tolist() == [[0.005, 0.0, 0.005]]
    assert built.state.v[0, 0] == pytest.approx(0.1)
    assert built.scene.groups["gate"] == (1, 3)
    assert built.scene.groups["bed2"] == (3, 4)
    assert built.scene.d_fixed.tolist() == pytest.approx([0.002, 0.003, 0.002])


@pytest.mark.parametrize(
    ("table", "part"),
    [
        ("x,z [mm],d [cm]\n0,1,0.2\n", "needs its unit"),
        ("x [kg],z [mm],d [cm]\n0,1,0.2\n", "wrong unit"),
        ("x [cm],z [mm]\n0,1\n", "column 'd"),
        ("x [cm],z [mm],d [cm],q [m]\n0,1,0.2,1\n", "unknown column 'q'"),
        ("x [cm],z [mm],d [cm]\n0,1\n", "line 2 has 2 cells"),
        ("x [cm],z [mm],d [cm]\n0,nan,0.2\n", "grains.csv:2:3: expected column 'z'"),
        (
            "x [cm],z [mm],d [cm]\n0,1,-0.2\n",
            "grains.csv:2:5: expected a diameter from 1e-07 to 1000 m, found -0.002",
        ),
        ("x [cm],z [mm],d [cm],fixed\n0,1,0.2,maybe\n", "fixed must be 0 or 1"),
        ("x [cm],z [mm],d [cm],fixed\n0,1,0.2,1\n", "no free grain"),
        ("x [cm],z [mm],d [cm]\n", "at least one grain"),
        ("x [cm],z [mm],d [cm],x [m]\n0,1,0.2,0\n", "appears twice"),
        ("", "at least one grain"),
    ],
)
def test_a_bad_table_is_reported_with_its_line(text: str, tmp_path: Path, table: str, part: str) -> None:
    with pytest.raises(CaseError, match=r"build\.file") as caught:
        build(read(write(tmp_path, text, table)))
    assert part in str(caught.value)


def test_overlapping_first_grains_are_named_with_their_lines(text: str, tmp_path: Path) -> None:
    table = "x [cm],z [cm],d [cm],fixed\n0,0.1,0.2,1\n0.1,0.1,0.2,1\n0.5,0.25,0.2,0\n0.61,0.25,0.2,0\n"
    with pytest.raises(CaseError, match="overlap") as caught:
        build(read(write(tmp_path, text, table)))
    assert "line 4" in str(caught.value)
    assert "line 5" in str(caught.value)
    assert "0.45 d" in str(caught.value)
    allowed = {"build.allow_overlap": "true"}
    assert build(read(write(tmp_path, text, table), allowed)).scene.n_grain == 2


@pytest.mark.parametrize("name", ["/etc/hosts", "../grains.csv", "C:/grains.csv", "a/../../b.csv"])
def test_a_table_outside_the_cases_folder_is_refused(text: str, tmp_path: Path, name: str) -> None:
    with pytest.raises(CaseError, match="inside the folder"):
        read(write(tmp_path, text, CSV, name))


def test_a_link_out_of_the_cases_folder_is_refused(text: str, tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    path = write(inner, text, CSV, "link.csv")
    (tmp_path / "outer.csv").write_text(CSV, encoding="utf-8")
    (inner / "link.csv").symlink_to(tmp_path / "outer.csv")
    with pytest.raises(CaseError, match="outside the folder"):
        read(path)


def test_a_missing_table_is_refused(text: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="no such file"):
        read(write(tmp_path, text, CSV, "none.csv"))


def test_the_step_follows_the_smallest_free_grain_of_a_table(text: str, tmp_path: Path) -> None:
    table = "x [cm],z [cm],d [cm],fixed\n0,0.1,0.05,1\n1,1,0.1,0\n2,1,0.2,0\n"
    found = derive(read(write(tmp_path, text, table)))
    assert (found.d, found.d_min, found.d_max) == (0.002, 0.001, 0.002)
    assert found.dt == pytest.approx(found.free.t_col * 0.5**1.5 / 10, rel=1e-12)


def test_grains_of_a_plane_table_stay_in_their_lanes(text: str, tmp_path: Path) -> None:
    table = "x [cm],y [cm],z [cm],d [cm]\n0,0,1,0.2\n0,{y},1,0.2\n"
    with pytest.raises(CaseError, match="two lanes") as caught:
        build(read(write(tmp_path, text, table.format(y=0.15))))
    assert "line 2" in str(caught.value)
    assert "line 3" in str(caught.value)
    case = read(write(tmp_path, text, table.format(y=0.2)))
    assert not derive(case).meet
    assert build(case).scene.n_grain == 2
    assert derive(read(write(tmp_path, text, table.format(y=0)))).meet
    spatial = read(write(tmp_path, text, table.format(y=0.2)), {"motion.plane": "false"})
    assert derive(spatial).meet


def test_a_wall_may_not_cross_the_period_of_a_table(text: str, tmp_path: Path) -> None:
    gate = "[{ name = 'wall', point = ['5 cm', '0 cm', '0 cm'], normal = [-1, 0, 0] }]"
    path = write(tmp_path, text, CSV)
    assert build(read(path, {"planes": gate})).scene.n_plane == 1
    with pytest.raises(CaseError, match="x is periodic"):
        read(path, {"planes": gate, "domain.period_x": "10 cm"})


def test_a_fast_spin_in_a_table_gives_a_warning(text: str, tmp_path: Path) -> None:
    table = "x [cm],z [cm],d [cm],wy [rad/s]\n0,1,0.2,-1100\n1,1,0.1,2000\n"
    keys = {"water": "{ profile = 'still', torque = 'Dennis' }", "motion.rotation": "free"}
    rows = {row.name: row for row in explain(read(write(tmp_path, text, table), keys))}
    assert (rows["rotational Re"].value, rows["rotational Re"].flag) == (pytest.approx(4400.0), "warning")
