"""Sizes measured of grains that are known, and of a run that lays a sieve curve."""

import csv
import json
import math
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

import ryusa
from ryusa import figures
from ryusa.casefile.read import read
from ryusa.cli import app
from ryusa.errors import ResultsError, RyusaError
from ryusa.measure import sizes
from ryusa.model.grading import Grading
from ryusa.results import Results, schema

TEXT = """
seed = 4
[grains]
density = "2650 kg/m3"
sieve_curve = "in/gravel.csv"
finest = "1.5 mm"
[contact]
stiffness = "10 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = true
[build]
kind = "packing"
columns = 5
layers = 30
bed = "plane"
[stop]
time = "4 ms"
[record]
frames = "1 ms"
events = "none"
"""
CSV = "d [mm],finer [%]\n1,0\n2,40\n4,100\n"
ASKED = Grading.of([(0.001, 0.0), (0.002, 0.4), (0.004, 1.0)]).cut(0.0015)


def stand_in(d, case=None):
    d = np.asarray(d, dtype=float)
    scene = SimpleNamespace(n_grain=len(d), n_fixed=0, d=d, m=2650.0 * np.pi / 6.0 * d**3)
    scene.heads, scene.of_heads = np.ones(len(d), np.bool_), lambda: (scene.d, scene.m)
    return SimpleNamespace(case=case or {}, scene=scene)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run of a case whose curve lies in a folder beside it."""
    home = tmp_path_factory.mktemp("home")
    (home / "in").mkdir()
    (home / "in" / "gravel.csv").write_text(CSV, encoding="utf-8")
    (home / "case.toml").write_text(TEXT, encoding="utf-8")
    ryusa.run(read(home / "case.toml"), home / "run", progress=False)
    return home / "run"


def call(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_grains_of_one_size_have_it_as_every_diameter() -> None:
    found = sizes(stand_in([0.002] * 5))
    laid = {name: there for name, _, there, _ in found.pairs()}
    assert [laid[name] for name in ("D10", "D16", "D50", "D84", "D90")] == pytest.approx([0.002] * 5)
    assert laid["sorting"] == pytest.approx(1.0)
    assert laid["sorting_phi"] == pytest.approx(0.0)
    assert found.grains.sum() == 5
    assert math.isnan(laid["largest_difference"])


def test_percentiles_of_a_lognormal_mass_are_those_of_its_law() -> None:
    # D84/D50 = D50/D16 = exp(sigma); Folk & Ward's sorting of a lognormal curve is sigma/ln 2 in phi
    sigma, d50, n = 0.4, 0.003, 200_000
    share = (np.arange(n) + 0.5) / n
    from scipy.stats import norm

    d = d50 * np.exp(sigma * norm.ppf(share))
    run = stand_in(d)
    run.scene.m = np.ones(n)
    laid = {name: there for name, _, there, _ in sizes(run).pairs()}
    assert laid["D50"] == pytest.approx(d50, rel=1e-3)
    assert laid["D84"] == pytest.approx(d50 * math.exp(sigma * norm.ppf(0.84)), rel=1e-3)
    assert laid["sorting"] == pytest.approx(math.exp(sigma * norm.ppf(0.84)), rel=1e-3)
    assert laid["sorting_phi"] == pytest.approx(sigma / math.log(2.0), rel=5e-3)


def test_classes_hold_every_grain_and_all_mass_whatever_the_sieves() -> None:
    rng = np.random.default_rng(3)
    d = np.exp(rng.uniform(math.log(0.0003), math.log(0.02), 500))
    found = sizes(stand_in(d))
    assert found.sieves[0] <= d.min() <= d.max() <= found.sieves[-1]
    assert found.sieves[1:] / found.sieves[:-1] == pytest.approx(math.sqrt(2.0))
    assert found.grains.sum() == len(d)
    assert found.mass.sum() == pytest.approx(found.m.sum())
    assert found.series()[-1]["finer_laid"] == pytest.approx(1.0)


@pytest.mark.full
def test_a_run_shows_what_was_laid_beside_what_was_asked(folder: Path, tmp_path: Path) -> None:
    found = sizes(Results.open(folder))
    assert found.asked is not None
    assert found.asked.finer == pytest.approx(ASKED.finer)
    within = float(found.m[-1] / found.m.sum())
    assert found.difference <= within * (1.0 + 1e-9)
    for name, _, there, asked in found.pairs()[:5]:
        share = float(name[1:]) / 100.0
        assert asked == pytest.approx(ASKED.diameter(share))
        assert abs(ASKED.share_below(there) - share) <= within
    for row in found.series():
        assert row["share_laid"] == pytest.approx(row["share_asked"], abs=within)
    result = call("measure", folder, "sizes", "--csv", tmp_path / "a.csv", "--series", tmp_path / "b.csv")
    assert result.exit_code == 0, result.output
    assert "D50" in result.output
    assert "1.5 .. 2" in result.output
    rows = list(csv.DictReader((tmp_path / "a.csv").open()))
    assert {row["quantity"] for row in rows} >= {"D10", "D50", "D90", "sorting", "grains"}
    assert [float(row["d_low_m"]) for row in csv.DictReader((tmp_path / "b.csv").open())] == [0.0015, 0.002]
    assert json.loads(call("measure", folder, "sizes", "--json").output)["rows"][2]["quantity"] == "D50"


@pytest.mark.full
def test_its_picture_has_both_curves(folder: Path, tmp_path: Path) -> None:
    result = call("draw", folder, "sizes", "-o", tmp_path / "sizes.png")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "sizes.png").stat().st_size > 1_000
    drawn = figures.sizes(sizes(Results.open(folder)))
    labels = [text.get_text() for text in drawn.axes[0].get_legend().get_texts()]
    assert labels == ["asked for", "laid, 150 grains"]
    assert drawn.axes[0].get_xscale() == "log"
    assert figures.sizes(sizes(stand_in([0.002] * 3))).axes[0].get_legend() is not None


@pytest.mark.full
def test_a_run_folder_keeps_its_curve_and_resumes_without_the_case(folder: Path, tmp_path: Path) -> None:
    assert (folder / schema.SIEVE).read_text(encoding="utf-8") == CSV
    moved = tmp_path / "elsewhere"
    shutil.copytree(folder, moved)
    case = read(moved / schema.CASE_TOML)
    whole = ryusa.run(
        read(moved / schema.CASE_TOML, {"stop.time": "8 ms"}), moved, progress=False, resume=True
    )
    assert case.grains.sieve_curve == "in/gravel.csv"
    other = tmp_path / "other"
    (other / "in").mkdir(parents=True)
    (other / "in" / "gravel.csv").write_text(CSV, encoding="utf-8")
    (other / "case.toml").write_text(TEXT, encoding="utf-8")
    once = ryusa.run(read(other / "case.toml", {"stop.time": "8 ms"}), other / "run", progress=False)
    assert np.array_equal(whole.frames[-1].x, once.frames[-1].x)
    assert np.array_equal(whole.frames[-1].v, once.frames[-1].v)


@pytest.mark.full
def test_a_run_is_not_resumed_with_another_curve(folder: Path, tmp_path: Path) -> None:
    home = tmp_path / "home"
    shutil.copytree(folder, home / "run")
    (home / "in").mkdir()
    (home / "in" / "gravel.csv").write_text(CSV.replace("40", "41"), encoding="utf-8")
    (home / "case.toml").write_text(TEXT, encoding="utf-8")
    with pytest.raises(RyusaError, match=r"grains\.sieve_curve"):
        ryusa.run(read(home / "case.toml"), home / "run", progress=False, resume=True)


@pytest.mark.parametrize(
    "curve", [[[0.001, 0.0]], "gravel.csv", [["x", 1], [2, 3]], [[0.001, 50], [0.002, 20]], 7]
)
def test_a_case_json_with_a_curve_that_cannot_be_is_refused(curve: object) -> None:
    with pytest.raises(ResultsError, match="sieve_curve"):
        sizes(stand_in([0.002], {"grains": {"sieve_curve": curve}}))
