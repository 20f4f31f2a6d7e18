"""Reference pages are as the code is."""

import importlib
import re
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def generate() -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(DOCS)
        return importlib.import_module("generate")


def test_reference_pages_are_current(generate: ModuleType) -> None:
    stale = [page.name for page, text in generate.pages().items() if page.read_text(encoding="utf-8") != text]
    assert not stale, "run `make docs`"


def test_every_key_of_the_case_file_is_documented() -> None:
    from ryusa.casefile.keys import all_keys

    text = (DOCS / "case-file.md").read_text(encoding="utf-8")
    missing = [key for key in all_keys() if f"`{key}`" not in text and f"[{key}]" not in text]
    assert not missing


def test_every_command_is_documented_and_explains_itself(generate: ModuleType) -> None:
    text = (DOCS / "commands.md").read_text(encoding="utf-8")
    for name, command in generate.commands().items():
        assert f"## ryusa {name}" in text
        assert command.help, name


def test_the_readme_shows_every_command(generate: ModuleType) -> None:
    readme = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    missing = [name for name in generate.commands() if f"ryusa {name}" not in readme]
    assert not missing


def test_the_readme_names_every_choice_of_contact_and_water() -> None:
    from ryusa.laws.families import (
        ContactForce,
        DampingLaw,
        Drag,
        Film,
        Hindrance,
        Lift,
        Magnus,
        Mixing,
        Parting,
        Profile,
        Rebound,
        Rolling,
        SideWalls,
        Slip,
        Unloading,
        WaterTorque,
    )

    laws = (DOCS.parent / "README.md").read_text(encoding="utf-8").split("## Laws")[1].split("## Speed")[0]
    families = (
        DampingLaw,
        Unloading,
        Parting,
        Slip,
        Rolling,
        Profile,
        Drag,
        Hindrance,
        Lift,
        Magnus,
        WaterTorque,
        Mixing,
        SideWalls,
    )
    words = {word for family in (*families, Rebound, Film) for word in family.words()} - {"none", "dry"}
    words.add(ContactForce.HERTZ_MINDLIN.word)
    missing = [word for word in sorted(words) if f"`{word}`" not in laws]
    assert not missing, f"README.md, table of '## Laws': add {missing}"


def test_every_dataset_of_a_contact_is_documented() -> None:
    from ryusa.model import EVENT

    text = (DOCS / "run-folder.md").read_text(encoding="utf-8")
    assert not [name for name in EVENT.names or () if f"`{name}`" not in text]


def test_links_between_pages_lead_somewhere() -> None:
    root = DOCS.parent
    broken: list[str] = []
    for page in [
        root / "README.md",
        root / "CONTRIBUTING.md",
        *DOCS.glob("*.md"),
        *(root / "design").glob("*.md"),
    ]:
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target and not (page.parent / target).exists():
                broken.append(f"{page.relative_to(root)}: {target}")
    assert not broken


def test_the_reasons_for_defaults_name_the_defaults_of_the_reference() -> None:
    text = (DOCS / "case-file.md").read_text(encoding="utf-8")
    reasons, reference = text.split("**Defaults.**")[1].split("<!-- generated")
    kept = {}
    for line in reference.splitlines():
        if line.startswith("| `"):
            key, _, default, _ = (cell.strip(' `"') for cell in re.split(r"(?<!\\) \| ", line[2:-2]))
            kept[key] = default
    rows = [line[2:-2].split(" | ") for line in reasons.splitlines() if line.startswith("| `")]
    assert len(rows) > 20
    for keys, said, *_ in rows:
        key = keys.split(",")[0].strip("` ")
        word = re.split(r'[,"]|(?<=\d) ', said.strip('`" '))[0].strip("` ")
        if kept[key] and not (word == "none" and kept[key] in ("0", "none")):
            assert word and kept[key].startswith(word), key
