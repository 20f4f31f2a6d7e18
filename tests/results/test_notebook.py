"""What a notebook shows, and the tables that a run gives."""

import base64
import builtins
import html
import io
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

import ryusa
from ryusa.cases import case_path
from ryusa.errors import CaseError, ResultsError
from ryusa.results import Results, presentation

pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Results:
    changes = {"build.starts": "3", "stop.time": "0.5 s", "record.settle": "0 s"}
    case = ryusa.load(case_path("saltation.toml"), changes)
    return ryusa.run(case, tmp_path_factory.mktemp("notebook") / "run", progress=False)


def test_a_case_is_shown_as_ryusa_check_prints_it():
    shown = ryusa.load(case_path("saltation.toml"))._repr_html_()
    assert "0.2 cm" in shown
    assert "where it comes from" in shown


def test_a_run_is_shown_by_its_state(run):
    assert "complete: reached 0.5 s" in run._repr_html_()
    run.case["title"] = "<b>bold"
    assert "<b>" not in run._repr_html_()


def test_averages_have_one_grammar_and_are_shown_as_a_table(run):
    for name, quantity in (("saltation", "jump_height"), ("spin", "turns"), ("transport", "q_star")):
        one = run.measure(name)[quantity]
        assert np.isfinite(one.value)
        assert one.error >= 0.0
        assert one.unit
        assert one.steady in (True, False)
        assert f"{one.value:.4g}" in run.measure(name)._repr_html_()
        assert all(
            html.escape(text) in run.measure(name)._repr_html_()
            for text in run.measure(name).averages.remarks
        )
    with pytest.raises(KeyError, match="there are"):
        run.measure("saltation")["jump"]


def test_a_figure_is_shown_as_a_picture(run):
    picture = Image.open(io.BytesIO(run.draw("tracks")._repr_png_()))
    assert picture.format == "PNG"
    assert picture.width > 400
    assert np.asarray(picture.convert("L")).std() > 5.0


def test_pages_are_shown_within_a_frame_and_saved(run, tmp_path):
    page = run.view()
    assert page._repr_html_().startswith("<iframe srcdoc=")
    assert f' title="{html.escape(run.case["title"])}"' in page._repr_html_()
    assert "<script" not in page._repr_html_()  # escaped, for the frame
    assert page.save(tmp_path / "new" / "view.html").read_text() == page.text
    assert "2 runs side by side" in run.report(run).text


@pytest.mark.parametrize(("kind", "tag"), [("webp", "<img src"), ("gif", "<img src"), ("mp4", "<video src")])
def test_a_film_is_shown_by_its_kind_and_saved(run, tmp_path, kind, tag):
    av = pytest.importorskip("av") if kind == "mp4" else None
    film = run.film(kind, size=(480, 270), frames=3)
    shown = film._repr_html_()
    assert '"film of the run"' in shown  # for who cannot see it
    assert shown.startswith(tag)
    held = base64.b64decode(re.search('base64,([^"]+)"', shown)[1])
    assert film.save(tmp_path / "new" / f"film.{kind}").read_bytes() == held
    if av is not None:
        with av.open(io.BytesIO(held)) as file:
            pictures = [one.to_image() for one in file.decode(video=0)]
    else:
        pictures = [one.convert("RGB") for one in ImageSequence.Iterator(Image.open(io.BytesIO(held)))]
    assert [one.size for one in pictures] == [(480, 270)] * 3
    assert np.abs(np.asarray(pictures[0], dtype=float) - np.asarray(pictures[2])).max() > 50.0  # it moves
    with pytest.raises(CaseError, match=f"must end in .{kind}"):
        film.save(tmp_path / "film.png")


def test_a_kind_of_film_that_is_none_is_refused(run):
    with pytest.raises(CaseError, match=r"kind = 'mpg': must end in .webp"):
        run.film("mpg")
    with pytest.raises(CaseError, match="view"):
        run.film(view="sideways")


def test_a_name_that_is_none_is_refused_with_the_nearest(run):
    with pytest.raises(ResultsError, match="did you mean 'transport'"):
        run.measure("trasport")
    with pytest.raises(ResultsError, match="no picture 'tracs'"):
        run.draw("tracs")


def test_options_are_taken_as_on_the_command_line(run):
    assert run.measure("tracks", begin="1 ms").rows() == run.measure("tracks", begin=1.0e-3).rows()
    assert run.draw("grains", at="1 ms") is not None
    assert presentation._in_si({"reach": "0.95 m to 1375 mm", "at": "5 ms"}) == {
        "reach": (0.95, 1.375),
        "t": 0.005,
    }
    with pytest.raises(CaseError, match="begin = '1': missing unit"):
        run.measure("tracks", begin="1")
    with pytest.raises(CaseError, match=r"begn: tracks does not take it; .* Did you mean 'begin'"):
        run.measure("tracks", begn=0.0)


def test_contacts_and_averages_are_data_frames(run):
    pytest.importorskip("pandas")
    contacts = run.to_pandas()
    assert len(contacts) == len(run.contacts)
    assert (contacts["overlap_max"].to_numpy() == run.contacts["overlap_max"]).all()
    averages = run.to_pandas("saltation").set_index("quantity")
    assert averages.loc["jump_height", "value"] == run.measure("saltation")["jump_height"].value


def test_frames_are_a_dataset_with_units(run):
    pytest.importorskip("xarray")
    found = run.to_xarray(slice(0, 10))
    assert found["x"].dims == ("t", "grain", "axis")
    assert found["v"].attrs["units"] == "m/s"
    assert (found["x"].to_numpy() == run.frames.x[0:10]).all()
    assert float(found["x"].sel(axis="z").isel(t=3, grain=1)) == run.frames.x[3][1, 2]


def test_without_pandas_the_error_says_what_to_install(run, monkeypatch):
    def refuse(name, *rest, **how):
        if name.startswith("pandas"):
            raise ImportError(name)
        return real(name, *rest, **how)

    real = builtins.__import__
    monkeypatch.setattr("importlib.import_module", refuse)
    with pytest.raises(ResultsError, match=r"pip install 'ryusa\[notebook\]'"):
        run.to_pandas()


def test_a_case_is_run_by_its_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    text = case_path("saltation.toml").read_text().replace('time = "20 s"', 'time = "10 ms"')
    (tmp_path / "short.toml").write_text(text.replace('settle = "', 'settle = "0 s" # "'))
    monkeypatch.chdir(tmp_path)
    assert ryusa.run("short.toml", progress=False).folder == Path("runs/short")
