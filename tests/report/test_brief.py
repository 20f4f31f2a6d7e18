import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from ryusa.build import scene
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cases.questions import QUESTIONS
from ryusa.catalogue import MEASURES, PICTURES
from ryusa.cli import app
from ryusa.errors import CaseError, ResultsError
from ryusa.laws.families import Pressure
from ryusa.measure import surface
from ryusa.measure.pooled import mean_of_runs
from ryusa.measure.statistics import Average
from ryusa.report import brief
from ryusa.report.answer import _sentence, answer
from ryusa.report.brief import brief_page, write_pdf
from ryusa.report.contents import ExplainedValue
from ryusa.report.covered import _wall, not_covered
from ryusa.report.headlines import HEADLINES, Headline
from ryusa.report.question import question_of
from ryusa.results import Results
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop
from ryusa.study.interval import over_seeds

HEAP = {  # recorded contacts: a kernel that other tests compile too
    "build.columns": "12", "build.layers": "8", "contact.stiffness": "20 N/cm", "stop.time": "1.2 s",
    "record.events": "all",
}  # fmt: skip


def made(folder: Path, case: str, **changes: str) -> Results:
    changes = {name.replace("__", "."): value for name, value in changes.items()}
    return run(read(case_path(f"{case}.toml"), changes), folder, progress=False)


@pytest.fixture(scope="module")
def heaps(tmp_path_factory: pytest.TempPathFactory) -> list[Results]:
    folder = tmp_path_factory.mktemp("heaps")
    return [made(folder / f"seed{seed}", "heap", **HEAP, seed=str(seed)) for seed in (1, 2, 3)]


@pytest.fixture(scope="module")
def weir(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Water that still rises."""
    return made(tmp_path_factory.mktemp("weir") / "weir", "weir", stop__time="6 s")


def answered(runs: Sequence[Results]):
    return answer(runs, question_of(runs[0].case)[0])


@pytest.mark.parametrize("name", [case for one in QUESTIONS for case in one.cases])
def test_a_packaged_case_has_its_own_question(name: str) -> None:
    case = read(case_path(f"{name}.toml")).model_dump()
    assert name in question_of(case)[0].cases


def test_questions_name_measures_with_sentences_and_pictures_that_exist() -> None:
    for one in QUESTIONS:
        assert set(one.measures) <= set(HEADLINES)
        assert set(one.pictures) <= {picture.name for picture in PICTURES}
    assert set(HEADLINES) - {"levels", "filling"} <= {measure.name for measure in MEASURES}


def test_seeds_are_pooled_with_an_interval(heaps):
    slopes = [np.degrees(surface(one).angle) for one in heaps]
    found, expected = answered(heaps), over_seeds(slopes, "deg")
    assert found.supported and "differ in their random seed (1, 2, 3) alone" in found.verdict
    assert float(found.sentences[0].number.rstrip("°")) == pytest.approx(expected.value, rel=0.05)
    low, high = (float(one) for one in re.findall(r"[\d.]+", found.sentences[0].sure)[1:3])
    half = expected.high - expected.value
    assert (low, high) == pytest.approx((expected.low, expected.high), abs=0.1 * half)


def test_one_seed_has_no_interval_and_says_so_and_so_does_a_trial(heaps, monkeypatch):
    monkeypatch.setitem(heaps[0].provenance, "command", ["ryusa", "run", "heap.toml", "--try", "1s"])
    found = answered(heaps[:1])
    assert found.verdict.startswith("A trial alone")
    assert not found.supported and "No interval: one run was made (seed 1)" in found.verdict
    assert not any("interval" in one.sure for one in found.sentences)


def test_a_heap_that_moves_gives_no_answer(tmp_path):
    moving = made(tmp_path / "moving", "heap", **{**HEAP, "stop.time": "0.45 s"})
    found = answered([moving])
    assert found.verdict.startswith("No answer that the runs support")
    assert found.sentences[0].sure == "still changing at the end of the run"


def test_water_alone_has_one_run_and_an_answer_only_where_it_rests(weir):
    found = answered([weir])
    assert "Nothing is random in water alone" in found.verdict
    assert not found.supported and "not steady" in found.sentences[0].sure
    assert found.sentences[0].before == "Upstream of “weir” the water is "


def test_what_is_not_covered_follows_from_the_case(heaps, weir):
    dry, wet = " ".join(not_covered(heaps)), " ".join(not_covered([weir]))
    assert "Cohesion" in dry and "one plane" in dry and "jet" not in dry and "dam" not in dry
    assert "jet" in wet and "blow of a bore" in wet and "Cohesion" not in wet and "spheres" not in wet
    row = replace(weir.row.row, dams=tuple(replace(one, aerated=True) for one in weir.row.row.dams))
    own = replace(row, pressure=Pressure.FULL)
    grains = SimpleNamespace(
        n_grain=3, d=np.full(3, 0.01), d_mean=0.01, period=weir.scene.period, plane_case=False
    )
    over = SimpleNamespace(case=weir.case, scene=grains, row=SimpleNamespace(row=own), frames=weir.frames)
    said = " ".join(not_covered([over]))
    assert "a jet digs in the end" in said and "breakers" in said and "air under" not in said


def test_a_question_whose_measures_a_run_does_not_allow_has_no_answer(heaps):
    found = answer(heaps[:1], question_of({}, "hopper")[0])
    assert found.sentences == () and not found.supported
    assert found.verdict.startswith("None: these runs do not answer the question (discharge: the run has no")


def test_runs_of_one_seed_of_two_cases_or_of_a_script_are_refused(heaps, weir, tmp_path):
    with pytest.raises(ResultsError, match="runs of one seed are one run"):
        brief_page([heaps[0], heaps[0]])
    with pytest.raises(ResultsError, match="in more than its seed"):
        brief_page([heaps[0], weir])
    flying, state = scene(np.array([[0.0, 0.0, 0.01]]), 0.002, gravity=0.0)
    script = run_scene(flying, state, tmp_path / "script", frames=0.01, stop=Stop(time=0.02), progress=False)
    with pytest.raises(ResultsError, match="holds no case"):
        brief_page([script])
    with pytest.raises(CaseError, match="Did you mean 'hopper'"):
        brief_page(heaps[:1], like="hoper")


def test_the_page_loads_nothing_and_text_of_a_stranger_stays_text(heaps, monkeypatch):
    monkeypatch.setitem(heaps[0].case, "title", "</title><script>alert(1)</script>")
    page = brief_page(heaps[:1])
    assert "default-src 'none'" in page and "<script" not in page
    assert not re.search(r"(src|href)=[\"']?(https?:)?//", page)


@pytest.mark.full
def test_the_command_writes_a_brief_and_its_options_belong_to_it(heaps, tmp_path, monkeypatch):
    folders = [str(one.folder) for one in heaps]
    result = CliRunner().invoke(app, ["report", "--brief", *folders, "-o", str(tmp_path / "b.html")])
    assert result.exit_code == 0, result.output
    assert "What is the angle of repose of my material?" in (tmp_path / "b.html").read_text()
    result = CliRunner().invoke(app, ["report", folders[0], "--like", "heap"])
    assert "is an option of --brief" in result.stderr
    monkeypatch.setattr(brief, "BROWSERS", ("no-such-browser",))
    with pytest.raises(ResultsError, match=r"apt install chromium.*print it from any browser"):
        write_pdf("", tmp_path / "b.pdf")


def changing(value: float, drift: float, variation: float = 9.0) -> Average:
    return Average("q_mass", "kg/s/m", value, 0.01, 500, 1, 100.0, (2.0, 5.0), variation, drift, math.nan)


@pytest.mark.parametrize(
    "column, sure",
    [
        ([changing(11.4, 0.068)], "mean from 2 to 5 s, second half higher by 0.068 kg/s/m"),
        ([changing(11.4, 0.68)], "not steady from 2 to 5 s, second half higher by 0.68 kg/s/m"),
        (
            [changing(0.61, 0.0055), changing(0.62, -0.0448), changing(0.65, -0.0247, 1.0)],
            "95 % interval 0.575 to 0.678 kg/s/m, second half lower by 0.0213 kg/s/m",
        ),
        (
            [changing(0.61, -0.3), changing(0.62, -0.2), changing(0.65, -0.25)],
            "not steady from 2 to 5 s, second half lower by 0.25 kg/s/m",
        ),
        ([changing(0.61, math.nan, math.inf)], "not steady from 2 to 5 s"),
    ],
)
def test_a_change_that_is_small_beside_the_number_or_its_interval_is_said_and_changes_no_answer(column, sure):
    """The change of a mean over seeds is the mean of theirs, not that of the one that varies most."""
    said = _sentence(Headline("q_mass", "It is {}.", "kg/s/m"), column, alone=False)
    assert said.sure == sure
    if len(column) > 1:
        assert mean_of_runs(column).drift == pytest.approx(np.mean([one.drift for one in column]))


@pytest.mark.parametrize("shown, said", [("10 x 6 x 3 cm", "10 x 6 x 3 cm"), ("0 x 6 x 3 cm", "6 x 3 cm")])
def test_the_size_of_a_wall_keeps_its_sides(shown, said):
    assert (
        _wall(ExplainedValue("", "weir: size in x, y, z", shown, "mesh; of a file", ""))
        == f"weir, mesh {said}"
    )
