"""Keys of a sieve curve: what is read, what is refused and how, and what `ryusa check` says."""

import json
from pathlib import Path

import jsonschema
import pytest

from ryusa.casefile import derive, explain, json_schema, read, read_text, resolved
from ryusa.errors import CaseError
from ryusa.model.grading import Grading

TEXT = """
[grains]
density = "2650 kg/m3"
sieve_curve = "gravel.csv"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
kind = "packing"
columns = 4
rows = 4
layers = 30
bed = "plane"
[stop]
time = "0.1 s"
"""
CSV = "# sieved wet\ndiameter [mm], finer [%]\n1, 0\n2, 20\n\n4, 70\n8, 100\n"
INLINE = "[['1 mm', 0], ['2 mm', 20], ['4 mm', 70], ['8 mm', 100]]"
CURVE = Grading.of([(0.001, 0.0), (0.002, 0.2), (0.004, 0.7), (0.008, 1.0)])


def with_file(folder: Path, csv: str = CSV, name: str = "gravel.csv", **keys: str):
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(csv, encoding="utf-8")
    path = folder / "case.toml"
    path.write_text(TEXT.replace("gravel.csv", name), encoding="utf-8")
    return read(path, {key.replace("__", "."): value for key, value in keys.items()})


def inline(curve: str = INLINE, **keys: str):
    given = {"grains.sieve_curve": curve, **{key.replace("__", "."): value for key, value in keys.items()}}
    return read_text(TEXT, given)


def fault(curve: str = INLINE, **keys: str) -> str:
    with pytest.raises(CaseError) as caught:
        inline(curve, **keys)
    return str(caught.value)


def test_a_file_beside_the_case_and_pairs_in_it_say_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")  # the path is relative to the case file, not to the current folder
    from_file, from_pairs = with_file(tmp_path, name="data/gravel.csv"), inline()
    assert derive(from_file) == derive(from_pairs)
    assert resolved(from_file) == resolved(from_pairs)
    assert resolved(from_file)["grains"]["sieve_curve"] == [
        [0.001, 0],
        [0.002, 20],
        [0.004, 70],
        [0.008, 100],
    ]
    assert resolved(from_file)["grains"]["diameter"] == pytest.approx(CURVE.diameter(0.5))


def test_a_curve_may_be_written_from_coarse_to_fine() -> None:
    backwards = "[['8 mm', 100], ['4 mm', 70], ['2 mm', 20], ['1 mm', 0]]"
    assert derive(inline(backwards)) == derive(inline())


@pytest.mark.parametrize(
    ("curve", "parts"),
    [
        ("[['1 mm', 0]]", ["grains.sieve_curve", "too few"]),
        ("[]", ["grains.sieve_curve", "too few"]),
        ("[[1, 0], ['2 mm', 100]]", ["grains.sieve_curve.0.0", "missing unit"]),
        ("[['1 kg', 0], ['2 mm', 100]]", ["grains.sieve_curve.0.0", "wrong unit"]),
        ("[['1 mm', -1], ['2 mm', 100]]", ["grains.sieve_curve.0.1", "at least 0"]),
        ("[['1 mm', 0], ['2 mm', 101]]", ["grains.sieve_curve.1.1", "at most 100"]),
        ("[['1 mm', 0], ['2 mm']]", ["grains.sieve_curve.1", "missing"]),
        ("[['1 mm', 0], ['1 mm', 100]]", ["grains.sieve_curve.1", "appears twice"]),
        ("[['1 mm', 0], ['3 mm', 9], ['2 mm', 100]]", ["grains.sieve_curve.2", "must rise"]),
        (
            "[['1 mm', 0], ['2 mm', 60], ['3 mm', 50], ['4 mm', 100]]",
            ["grains.sieve_curve.2", "must not fall"],
        ),
        ("[['1 mm', 4], ['2 mm', 100]]", ["begins at 4 % finer", "at 1 mm", "grains.finest = '1 mm'"]),
        ("[['1 mm', 0], ['2 mm', 96]]", ["ends at 96 % finer", "at 2 mm", "grains.coarsest = '2 mm'"]),
        ("[['1 mm', 0], ['2 mm', 1.0]]", ["percent, not a fraction"]),
        ("7", ["grains.sieve_curve", "a list"]),
        ("'none.csv'", ["grains.sieve_curve", "no such file"]),
        ("'../gravel.csv'", ["inside the folder"]),
    ],
)
def test_a_curve_that_cannot_be_is_refused_by_key_and_reason(curve: str, parts: list[str]) -> None:
    said = fault(curve)
    for part in parts:
        assert part in said


@pytest.mark.parametrize(
    ("csv", "part"),
    [
        ("diameter,finer [%]\n1,0\n2,100\n", "gravel.csv:1:1: column 'diameter' needs its unit"),
        ("diameter [kg],finer [%]\n1,0\n2,100\n", "gravel.csv:1:1: column 'diameter': wrong unit"),
        ("diameter [mm],finer\n1,0\n2,100\n", "gravel.csv:1:15: column 'finer' needs its unit"),
        ("diameter [mm],finer [mm]\n1,0\n2,100\n", "in percent"),
        ("diameter [mm]\n1\n2\n", "column 'finer' is missing"),
        ("diameter [mm] finer [%]\n1 0\n2 100\n", "cannot read the unit"),
        ("diameter [mm];finer [%]\n1;0\n2\n", "gravel.csv:3:1: line 3 has 1 cells, the header has 2"),
        ("size [mm],finer [%]\n1,0\n2,100\n", "unknown column 'size'"),
        ("d [mm],diameter [mm],finer [%]\n1,1,0\n2,2,100\n", "appears twice"),
        ("# bed\ndiameter [mm],finer [%]\n1,0\n2\n", "gravel.csv:4:1: line 4 has 1 cells, the header has 2"),
        ("diameter [mm],finer [%]\n1,0\n2,much\n", "gravel.csv:3:3: expected percent finer, a finite number"),
        ("diameter [mm],finer [%]\n1,0\n-2,100\n", "gravel.csv:3:1: expected a diameter from"),
        ("diameter [mm],finer [%]\n1,0\n2,120\n", "gravel.csv:3:1: percent finer must be from 0 to 100"),
        (
            "diameter [mm],finer [%]\n1,0\n\n2,60\n4,50\n8,100\n",
            "gravel.csv:5:1: percent finer must not fall",
        ),
        ("diameter [mm],finer [%]\n1,0\n2,60\n2,100\n", "gravel.csv:4:1: the diameter 2 mm appears twice"),
        ("diameter [mm],finer [%]\n1,0\n", "gravel.csv:2:1: needs at least two points"),
        ("diameter [mm],finer [%]\n", "at least two sieves"),
        ("", "expected a header"),
        ("diameter [mm],finer [%]\n1,3\n2,100\n", "begins at 3 % finer"),
    ],
)
def test_a_bad_file_is_reported_with_its_line(tmp_path: Path, csv: str, part: str) -> None:
    with pytest.raises(CaseError, match=r"grains\.sieve_curve") as caught:
        with_file(tmp_path, csv)
    assert part in str(caught.value)


def test_a_file_that_is_no_text_or_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (inner / "gravel.csv").write_bytes(b"diameter [mm],finer [%]\n1,0\n\xff\x81,100\n")
    (inner / "case.toml").write_text(TEXT, encoding="utf-8")
    with pytest.raises(CaseError, match=r"gravel\.csv:\d+:1: expected text in UTF-8"):
        read(inner / "case.toml")
    (tmp_path / "outer.csv").write_text(CSV, encoding="utf-8")
    (inner / "gravel.csv").unlink()
    (inner / "gravel.csv").symlink_to(tmp_path / "outer.csv")
    with pytest.raises(CaseError, match="outside the folder"):
        read(inner / "case.toml")


def test_an_open_end_is_closed_by_a_cut_within_the_curve() -> None:
    open_ended = "[['1 mm', 4], ['2 mm', 20], ['4 mm', 70], ['8 mm', 97]]"
    found = derive(inline(open_ended, grains__finest="'1 mm'", grains__coarsest="'6 mm'"))
    assert (found.d_min, found.d_max) == (0.001, 0.006)
    said = fault(open_ended, grains__finest="'0.5 mm'", grains__coarsest="'9 mm'")
    assert "grains.finest = '0.5 mm'" in said
    assert "begins at 4 % finer" in said
    assert "ends at 97 % finer" in said


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ({"grains.finest": "'0.5 mm'"}, "has no effect: the curve ends at 1 mm"),
        ({"grains.coarsest": "'9 mm'"}, "has no effect: the curve ends at 8 mm"),
        ({"grains.finest": "'3 mm'", "grains.coarsest": "'2 mm'"}, "must be smaller than grains.coarsest"),
        ({"grains.finest": "'8 mm'"}, "no mass lies between"),
        ({"grains.finest": "1"}, "missing unit"),
        ({"build": "{ kind = 'drop', height = '1 cm' }"}, "has no effect with builder 'drop'"),
        ({"build": "{ kind = 'saltation' }"}, "has no effect with builder 'saltation'"),
        ({"build": "{ kind = 'table', file = 'grains.csv' }"}, "has no effect with builder 'table'"),
        ({"build": "{ kind = 'run', folder = 'runs/a' }"}, "has no effect with builder 'run'"),
        ({"build.bed": "'flat'"}, "slips through openings"),
        ({"grains.sieve_curv": "'x'"}, "Did you mean 'grains.sieve_curve'"),
    ],
)
def test_keys_that_contradict_the_curve_are_refused(keys: dict[str, str], part: str) -> None:
    with pytest.raises(CaseError) as caught:
        read_text(TEXT, {"grains.sieve_curve": INLINE, **keys})
    assert part in str(caught.value)


def test_a_spread_and_a_curve_exclude_each_other_and_an_override_displaces_the_other() -> None:
    text = TEXT.replace('"gravel.csv"', INLINE).replace("[contact]", "spread = 0.1\n[contact]")
    with pytest.raises(CaseError, match=r"grains\.spread: excludes grains\.sieve_curve"):
        read_text(text)
    assert read_text(text, {"grains.sieve_curve": INLINE}).grains.spread == 0.0


def test_without_a_curve_the_diameter_is_missed_and_the_cuts_have_no_effect() -> None:
    text = TEXT.replace('sieve_curve = "gravel.csv"\n', "")
    with pytest.raises(CaseError, match=r"grains\.diameter: missing; mean diameter"):
        read_text(text)
    with pytest.raises(CaseError, match=r"grains\.finest = '1 mm': has no effect without"):
        read_text(text, {"grains.diameter": "2 mm", "grains.finest": "1 mm"})


def test_a_bed_of_fixed_grains_takes_a_curve_that_it_holds() -> None:
    derive(inline(build__bed="'flat'", grains__finest="'2 mm'"))
    floor = "[{ name = 'net', point = ['0 m', '0 m', '-1 cm'], normal = [0, 0, 1] }]"
    derive(inline(build__bed="'flat'", planes=floor))


def test_check_says_what_is_cut_and_what_the_finest_grains_cost() -> None:
    rows = {row.name: row for row in explain(inline(grains__finest="'2 mm'", grains__coarsest="'6 mm'"))}
    cut = rows["mass finer than finest, left out"]
    assert (cut.flag, cut.shown) == ("warning", "20 %")
    # down to 1 mm: a step shorter by 2^1.5; grains for the same mass between 2 and 6 mm
    kept = CURVE.share_below(0.006) - 0.2
    grains = CURVE.cut(0.002, 0.006).mean_cube / CURVE.cut(0.0, 0.006).mean_cube * (kept + 0.2) / kept
    assert f"{2.0**1.5:.3g} times as many steps and {grains:.3g} times as many grains" in cut.origin
    finer = rows["D10"]
    assert (
        finer.flag == "warning" and f"of the whole curve {100 * CURVE.diameter(0.1):.3g} cm" in finer.origin
    )
    assert all(row.flag == "" for row in explain(inline()) if row.name in {"D10", "D50", "D90"})
    coarse = rows["mass coarser than coarsest, left out"]
    assert coarse.flag == "warning"
    assert coarse.value == pytest.approx(1.0 - CURVE.share_below(0.006))
    more = CURVE.cut(0.002, 0.006).mean_cube / CURVE.cut(0.002).mean_cube * 0.8 / kept
    assert more > 1.0
    assert f"up to {1e3 * CURVE.d[-1]:.3g} mm, no more steps at the same stiffness" in coarse.origin
    assert f"{more:.3g} times as many grains for the same mass of the others" in coarse.origin
    assert f"{CURVE.d[-1] / 0.006:.3g} times as wide" in coarse.origin
    both, fine = (
        derive(inline(grains__finest="'2 mm'", **one)) for one in ({"grains__coarsest": "'6 mm'"}, {})
    )
    assert both.shortest == fine.shortest
    cost = rows["cost of the finest grains"]
    laid = CURVE.cut(0.002, 0.006)
    d = laid.diameter(0.5)
    assert cost.value == pytest.approx((d / 0.002) ** 1.5 * d**3 / laid.mean_cube)
    assert rows["D50"].value == pytest.approx(d)
    assert rows["sorting"].value == pytest.approx(laid.sorting)
    assert "warning" not in {row.flag for row in explain(inline()) if row.name.startswith("mass ")}


def test_check_warns_of_grains_too_few_to_lay_the_curve() -> None:
    few = {row.name: row for row in explain(inline(build__layers="2"))}["curve met within"]
    many = {row.name: row for row in explain(inline(build__layers="500"))}["curve met within"]
    assert (few.flag, many.flag) == ("warning", "")
    assert few.value == pytest.approx(CURVE.largest_share(32))
    assert many.value < few.value


def test_the_schema_takes_both_forms() -> None:
    schema = json_schema()
    grains = {"density": "2650 kg/m3"}
    rest = {"contact": {"stiffness": "1 N/cm"}, "motion": {"rotation": "free"}, "stop": {"time": "1 s"}}
    build = {"kind": "packing", "columns": 4, "layers": 2}
    for curve in ("gravel.csv", [["1 mm", 0], ["2 mm", 100]]):
        jsonschema.validate({"grains": {**grains, "sieve_curve": curve}, "build": build, **rest}, schema)
    for curve in (7, [["1 mm", 0]], [["1 mm", 101], ["2 mm", 100]]):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({"grains": {**grains, "sieve_curve": curve}, "build": build, **rest}, schema)
    assert json.dumps(schema)
