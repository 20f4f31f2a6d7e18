"""Schema of case files: later ones are refused, older ones rewritten with their comments."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from ryusa.casefile import read, read_text, resolved
from ryusa.casefile.case import SCHEMA
from ryusa.casefile.upgrade import upgrade
from ryusa.cases import FOLDERS, case_files, case_path
from ryusa.cli import app
from ryusa.errors import CaseError
from ryusa.version import __version__

OLD = """\
# a heap of my own

title = "Old"  # of 2026
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]   # soft
stiffness = "100 N/cm"
restitution = 0.7
friction = 0.5
[motion]
plane = true
rotation = "free"
[build]
kind = "box"
columns = 4
layers = 3
[stop]
time = "0.1 s"
"""


def test_every_packaged_case_says_the_present_schema() -> None:
    for folder in FOLDERS:
        for file in case_files(folder).values():
            assert f"\nschema = {SCHEMA}\n" in file.read_text(encoding="utf-8"), file


def test_a_case_of_a_later_schema_is_refused_in_a_line_that_names_the_version_to_install() -> None:
    with pytest.raises(CaseError) as error:
        read_text(f"schema = {SCHEMA + 1}\nword_of_later = 1\n{OLD}")
    assert f"needs ryusa {SCHEMA + 1}.0 or later; this is ryusa {__version__}" in str(error.value)
    assert "word_of_later" not in str(error.value)


@pytest.mark.parametrize("schema", ["0", "-1", "'1'", "1.5", "123456789"])
def test_what_is_no_schema_is_refused_as_any_value_of_a_key(schema: str) -> None:
    with pytest.raises(CaseError) as error:
        read_text(f"schema = {schema}\n{OLD}")
    assert error.value.key == "schema"
    assert "needs ryusa" not in str(error.value)


def test_the_schema_is_of_the_file_and_not_of_what_is_computed() -> None:
    assert "schema" not in resolved(read_text(f"schema = {SCHEMA}\n{OLD}"))


def test_an_older_file_gets_its_schema_and_keeps_its_comments() -> None:
    found = upgrade(OLD)
    assert found.text == OLD.replace("title", f"schema = {SCHEMA}\ntitle")
    assert found.written == {"schema": str(SCHEMA)}
    assert found.open == {
        "contact.slip": '"spring"', "time.steps_per_contact": "50", "contact.timing": '"at steps"'
    }  # fmt: skip
    assert upgrade(found.text).written == {}


def test_the_values_of_before_stand_in_their_sections_on_request() -> None:
    found = upgrade(OLD, as_before=True)
    assert '[contact]   # soft\ntiming = "at steps"\nslip = "spring"\nstiffness' in found.text
    assert found.text.endswith("\n[time]\nsteps_per_contact = 50\n")
    case = read_text(found.text)
    assert (case.contact.slip, case.contact.timing) == ("spring", "at steps")
    assert not found.open


def test_what_a_file_says_or_cannot_take_is_left_alone() -> None:
    text = case_path("saltation.toml").read_text(encoding="utf-8").replace("schema = 1\n", "")
    assert set(upgrade(text).open) == {"contact.timing"}
    assert not upgrade(OLD + '[time]\nstep = "1e-6 s"\n').open.keys() & {"time.steps_per_contact"}


def test_line_ends_of_windows_stay() -> None:
    text = upgrade(OLD.replace("\n", "\r\n"), as_before=True).text
    assert text.count("\n") == text.count("\r\n")


def test_a_section_that_is_no_table_of_lines_is_left_to_the_user() -> None:
    head, rest = OLD.split("[contact]")
    contact = 'contact = { stiffness = "100 N/cm", restitution = 0.7, friction = 0.5 }\n'
    text = f"{contact}{head}{rest[rest.index('[motion]') :]}"
    assert set(upgrade(text).written) == {"schema"}
    with pytest.raises(CaseError, match=r"contact\.slip: .* write slip = "):
        upgrade(text, as_before=True)


def test_the_command_rewrites_the_file_or_writes_another(tmp_path: Path) -> None:
    case, other = tmp_path / "old.toml", tmp_path / "new.toml"
    case.write_text(OLD)
    said = CliRunner().invoke(app, ["upgrade", str(case), "-o", str(other)]).output
    assert f"{other}: written schema = {SCHEMA}\n" in said
    assert 'leaves out contact.slip, which was "spring" before ryusa 1' in said
    assert case.read_text() == OLD
    assert CliRunner().invoke(app, ["upgrade", str(case)]).exit_code == 0
    assert case.read_text() == other.read_text()
    assert "is in the words of this version" in CliRunner().invoke(app, ["upgrade", str(case)]).output
    assert read(case).title == "Old"
    failed = CliRunner().invoke(app, ["upgrade", str(case), "-o", str(tmp_path / "none" / "x.toml")])
    assert failed.exit_code == 2 and "cannot be written" in failed.output
