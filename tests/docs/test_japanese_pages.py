"""The Japanese pages say what the English ones say, are found from these, and are marked as Japanese."""

import doctest
import importlib
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
ENGLISH, JAPANESE = DOCS / "getting-started.md", DOCS / "ja" / "getting-started.md"
FRONT = DOCS / "ja" / "index.md"
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)]*)?\)")
CODE = re.compile(r"`([^`]+)`")
KANA = re.compile(r"[ぁ-ゖァ-ヺ]")


@dataclass
class Section:
    """A heading of a page with what stands below it, blocks of code apart."""

    level: int
    blocks: list[str] = field(default_factory=list)
    prose: str = ""

    def words(self) -> set[str]:
        """What is set as code in the prose: commands, options, keys, names of files."""
        return set(CODE.findall(self.prose))

    def numbers(self) -> set[str]:
        return set(re.findall(r"\d+(?:[./]\d+)*", CODE.sub("", LINK.sub("", self.prose))))


def sections(text: str) -> list[Section]:
    """Sections of a page, in order; comments beside commands are left out."""
    found: list[Section] = [Section(0)]
    for part in re.split(r"(^```.*?^```$)", text, flags=re.MULTILINE | re.DOTALL):
        if part.startswith("```"):
            found[-1].blocks.append(re.sub(r"\s+# .*$", "", part, flags=re.MULTILINE))
            continue
        for line in part.splitlines():
            if heading := re.match(r"(#+) ", line):
                found.append(Section(len(heading[1])))
            else:
                found[-1].prose += f"{line}\n"
    return found


def aims(page: Path) -> set[Path]:
    """Files to which a page links, those of the Japanese pages and its own translation apart."""
    links = LINK.findall(page.read_text(encoding="utf-8"))
    files = {(page.parent / link).resolve() for link in links if not re.match(r"[a-z]+:", link)}
    return {one for one in files if one.parent != FRONT.parent} - {ENGLISH, JAPANESE}


def pairs() -> list[tuple[Section, Section]]:
    both = [sections(page.read_text(encoding="utf-8")) for page in (ENGLISH, JAPANESE)]
    assert [one.level for one in both[0]] == [one.level for one in both[1]]
    return list(zip(*both, strict=True))


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(DOCS))
    monkeypatch.syspath_prepend(str(DOCS / "site"))
    return importlib.import_module("make")


def test_getting_started_has_the_same_headings_commands_and_code_in_both_languages() -> None:
    for english, japanese in pairs():
        assert english.blocks == japanese.blocks
    assert sum(len(english.blocks) for english, _ in pairs()) > 8


def test_getting_started_names_the_same_options_files_and_numbers_in_both_languages() -> None:
    for english, japanese in pairs():
        assert english.words() == japanese.words()
        assert english.numbers() <= japanese.numbers()
    assert aims(ENGLISH) == aims(JAPANESE)


def test_a_command_an_option_or_a_number_that_differs_is_found() -> None:
    before = sections("# a\n```\nrun x   # one\n```\n`--set` took 1.5 s, [b](c.md#d2)\n")[1]
    assert before.blocks == ["```\nrun x\n```"]
    assert before.words() == {"--set"} and before.numbers() == {"1.5"}
    assert LINK.findall(before.prose) == ["c.md"]


def test_the_japanese_front_page_answers_every_question_of_ryusa_new() -> None:
    from ryusa.cases.questions import QUESTIONS

    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in FRONT.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ") and not line.startswith("| 問い")
    ]
    told = {tuple(CODE.findall(cases)): CODE.findall(typed) for _, cases, typed, _ in rows if "`" in cases}
    asked = {one.cases: [*one.commands] for one in QUESTIONS if one.cases}
    assert told == asked
    without = [CODE.findall(typed) for _, cases, typed, _ in rows if "`" not in cases]
    words = [[command.partition(" in the case")[0] for command in one.commands] for one in QUESTIONS]
    assert without == [typed for one, typed in zip(QUESTIONS, words, strict=True) if not one.cases]
    assert all(KANA.search(question) and KANA.search(answer) for question, _, _, answer in rows)


def test_keys_of_a_case_that_the_japanese_front_page_names_exist() -> None:
    keys = set(re.findall(r"\uff08`(\w+\.\w+)`\uff09", FRONT.read_text(encoding="utf-8")))
    reference = (DOCS / "case-file.md").read_text(encoding="utf-8")
    assert len(keys) > 5
    assert not {key for key in keys if f"| `{key}` |" not in reference}


def test_both_languages_lead_to_each_other() -> None:
    for english, japanese in (
        (ROOT / "README.md", FRONT), (DOCS / "site" / "pages" / "index.md", FRONT), (ENGLISH, JAPANESE)
    ):  # fmt: skip
        here = DOCS if "pages" in english.parts else english.parent  # pages of the site link as from docs
        assert f"English / [日本語]({japanese.relative_to(here)})" in english.read_text(encoding="utf-8")
    assert "[English](../../README.md) / 日本語" in FRONT.read_text(encoding="utf-8")
    assert "[English](../getting-started.md) / 日本語" in JAPANESE.read_text(encoding="utf-8")


def test_the_japanese_pages_have_their_place_in_the_site(site: ModuleType, tmp_path: Path) -> None:
    stage = site.Stage(tmp_path / "stage")
    stage.gather()
    front = (stage.folder / "ja" / "index.md").read_text(encoding="utf-8")
    assert "[English](../index.md)" in front  # the front page of the site stands for the README
    assert "```{toctree}\n:hidden:\n\ngetting-started\n```" in front
    assert (stage.folder / "ja" / "getting-started.md").is_file()
    assert "ja/index" in (stage.folder / "index.md").read_text(encoding="utf-8")


@pytest.mark.usefixtures("site")
def test_the_language_of_a_page_follows_from_its_folder() -> None:
    found = doctest.testmod(importlib.import_module("languages"))
    assert found.attempted and not found.failed


def test_a_japanese_page_says_so_in_its_html_and_an_english_one_that_it_is_english(tmp_path: Path) -> None:
    for needed in ("sphinx", "myst_parser", "pydata_sphinx_theme"):
        pytest.importorskip(needed)
    source, out = tmp_path / "source", tmp_path / "out"
    (source / "ja").mkdir(parents=True)
    (source / "conf.py").write_text(
        f"import sys\nsys.path.insert(0, {str(DOCS / 'site')!r})\n"
        "extensions = ['myst_parser', 'languages']\nhtml_theme = 'pydata_sphinx_theme'\n",
        encoding="utf-8",
    )
    (source / "index.md").write_text("# Grains\n\n```{toctree}\nja/index\n```\n", encoding="utf-8")
    (source / "ja" / "index.md").write_text("# 粒子\n", encoding="utf-8")
    build = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", source, out]
    done = subprocess.run(build, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for page, language in (("index.html", "en"), ("ja/index.html", "ja"), ("search.html", "en")):
        head = re.search(r"<html[^>]*>", (out / page).read_text(encoding="utf-8"))
        assert head and f'lang="{language}"' in head[0], page
