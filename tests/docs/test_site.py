"""The documentation site: what would stop its build is found, and nothing of the kind is there."""

import ast
import doctest
import importlib
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest
from tests.accessible import Fault
from tests.docs.check_site import is_known, pictures_without_words

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module", autouse=True)
def on_the_path():
    before = list(sys.path)
    sys.path[:0] = [str(DOCS / "site"), str(DOCS)]
    yield
    sys.path[:] = before


def site(name: str) -> ModuleType:
    return importlib.import_module(name)


def test_every_public_module_function_and_method_has_a_docstring() -> None:
    assert not site("api").undocumented()


def test_a_method_without_a_docstring_is_found() -> None:
    tree = ast.parse('class Grain:\n    """A grain."""\n    def volume(self): ...\n    def _own(self): ...\n')
    assert site("api")._silent(tree.body, "") == ["Grain.volume"]


def test_every_case_key_command_and_option_has_a_description() -> None:
    assert not site("generate").undocumented()


def test_every_picture_is_in_the_gallery_with_commands_that_exist() -> None:
    assert not site("gallery").problems()


def test_an_unknown_option_beneath_a_picture_is_found() -> None:
    gallery, known = site("gallery"), site("generate").commands()
    assert gallery._unknown("ryusa draw runs/heap grains --colour spin", known) == []
    assert gallery._unknown("ryusa draw runs/heap grains --hue spin", known)
    assert gallery._unknown("ryusa paint runs/heap", known)


def test_links_of_all_pages_lead_to_files_and_a_broken_one_is_found(tmp_path: Path) -> None:
    stage = site("make").Stage(tmp_path / "stage")
    stage.gather()
    stage.changelog()
    assert not stage.problems
    stage.relinked("[nowhere](nowhere.md)", DOCS / "theory.md", "theory.md")
    assert len(stage.problems) == 1 and "nowhere.md" in stage.problems[0]


def test_the_front_page_has_every_question_with_what_to_type_and_read(tmp_path: Path) -> None:
    from ryusa.cases.questions import QUESTIONS

    stage = site("make").Stage(tmp_path / "stage")
    stage.gather()
    front = (stage.folder / "index.md").read_text(encoding="utf-8")
    for one in QUESTIONS:
        assert f"| [{one.asked}]({one.page}) |" in front
        assert not one.cases or f"`ryusa new {one.cases[0]}`" in front
    assert "](beside-other-programs.md)" in front and "@questions" not in front


def test_links_are_rewritten_for_the_place_of_a_page(tmp_path: Path) -> None:
    stage = site("make").Stage(tmp_path / "stage")
    note = DOCS.parent / "design" / "0003-readings-of-the-paper.md"
    said = stage.relinked("[keys](../docs/case-file.md#units) `[a](b)`", note, "design/0003.md")
    assert said.startswith("[keys](../case-file.md#units)")
    page = stage.relinked("[licence](../LICENSE)\n```\n[x](y.md)\n```\n", DOCS / "theory.md", "theory.md")
    assert "(files/LICENSE)" in page and "[x](y.md)" in page and not stage.problems[1:]
    assert (tmp_path / "stage" / "files" / "LICENSE").is_file()


def test_docstrings_are_rewritten_as_numpydoc_reads_them() -> None:
    found = doctest.testmod(site("docstrings"))
    assert found.attempted >= 2 and not found.failed


def test_comments_beside_fields_become_their_description() -> None:
    from ryusa.model.tally import Tally, Term

    docstrings = site("docstrings")
    assert docstrings.fields_of(Term)["DASH_N"] == "lost to normal dashpots"
    assert docstrings.fields_of(Tally)["overlap_max"].startswith("largest overlap over the smaller diameter")


def test_the_glossary_explains_every_term_of_the_energy_account() -> None:
    from ryusa.model.tally import HELD, Term

    terms = {*HELD, *(term.name.lower() for term in Term)}
    table = (DOCS / "glossary.md").read_text(encoding="utf-8").split("## Terms of the energy account")[1]
    explained = {
        name for row in re.findall(r"^\| (`.*?) \|", table, re.M) for name in re.findall(r"`(\w+)`", row)
    }
    assert explained == terms


def test_the_page_on_measuring_names_every_measure() -> None:
    from ryusa import measure
    from ryusa.catalogue import MEASURES

    rows = re.findall(
        r"^\| `(\w+)` \|.*`ryusa\.measure\.(\w+)\(run\)` \|$",
        (DOCS / "measuring.md").read_text(encoding="utf-8"),
        re.M,
    )
    assert sorted(word for word, _ in rows) == sorted(one.name for one in MEASURES)
    assert all(callable(getattr(measure, name)) for _, name in rows)


def test_a_picture_that_is_called_as_its_file_is_found(tmp_path: Path) -> None:
    (tmp_path / "ja").mkdir()
    (tmp_path / "ja" / "heap.html").write_text(
        '<img src="a.png" alt="a heap"><img alt="_images/09af.png" src="b.png">'
    )
    assert pictures_without_words(tmp_path) == ["ja/heap.html: a picture is called _images/09af.png"]


def test_of_faults_only_those_of_the_theme_are_let_through() -> None:
    fault = Fault("api.html", "light", "definition-list", "#ryusa\\.view > dl", "")
    assert is_known(fault)
    assert not is_known(fault._replace(place="main > dl"))
    assert not is_known(fault._replace(rule="color-contrast"))
