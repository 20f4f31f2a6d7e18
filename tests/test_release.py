"""What files tell about the package is the same everywhere, and the tools of a release do what they say."""

import importlib.util
import io
import json
import re
import tarfile
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

import ryusa

ROOT = Path(__file__).parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT: dict[str, Any] = PYPROJECT["project"]


def tool(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "release" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def metadata() -> ModuleType:
    return tool("metadata")


def loaded(name: str) -> Any:
    text = (ROOT / name).read_text(encoding="utf-8")
    return json.loads(text) if name.endswith(".json") else yaml.safe_load(text)


def test_the_version_is_the_same_everywhere(metadata: ModuleType) -> None:
    found = metadata.versions()
    assert len(found) == 8
    assert set(found.values()) == {ryusa.__version__}


def test_a_version_is_written_everywhere_at_once(
    metadata: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in metadata.PLACES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    monkeypatch.setattr(metadata, "ROOT", tmp_path)
    metadata.write_version("12.3.4rc1")
    assert set(metadata.versions().values()) == {"12.3.4rc1"}
    assert json.loads(metadata.written()[tmp_path / "codemeta.json"])["version"] == "12.3.4rc1"
    with pytest.raises(SystemExit, match="no version"):
        metadata.write_version("one")


def test_codemeta_and_zenodo_are_as_pyproject_has_them(metadata: ModuleType) -> None:
    stale = [file.name for file, text in metadata.written().items() if file.read_text("utf-8") != text]
    assert not stale, "python release/metadata.py"


def test_the_citation_says_what_the_package_says() -> None:
    cited = loaded("CITATION.cff")
    assert cited["license"] == PROJECT["license"]
    assert [one["name"] for one in cited["authors"]] == [one["name"] for one in PROJECT["authors"]]


def test_the_recipe_for_conda_needs_what_the_package_needs() -> None:
    recipe = loaded("packaging/conda/recipe.yaml")

    def plain(need: str) -> str:
        return need.replace(" ", "").replace("matplotlib-base", "matplotlib")

    asked = {plain(one) for one in recipe["requirements"]["run"]}
    assert asked == {*PROJECT["dependencies"], f"python{PROJECT['requires-python']}"}
    assert recipe["build"]["python"]["entry_points"] == [f"ryusa = {PROJECT['scripts']['ryusa']}"]
    assert recipe["about"]["license"] == PROJECT["license"]


def test_workflows_pin_what_they_use_and_run_what_exists() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text("utf-8"), flags=re.MULTILINE))
    for file in sorted((ROOT / ".github" / "workflows").glob("*.yml")):
        for job in loaded(str(file.relative_to(ROOT)))["jobs"].values():
            assert job["timeout-minutes"] <= 90
            for step in job["steps"]:
                assert re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", step.get("uses", f"a@{'0' * 40}"))
                words = step.get("run", "make").split()
                assert words[:2] == ["bash", ".ci/run"] or not set(words[1:]) - targets


def test_hooks_have_the_versions_that_the_environment_has() -> None:
    hooks = {one["repo"]: one.get("rev") for one in loaded(".pre-commit-config.yaml")["repos"]}
    pins = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    ruff = hooks["https://github.com/astral-sh/ruff-pre-commit"]
    assert f"ruff=={ruff.removeprefix('v')}\n" in pins


def test_every_package_comes_with_the_license() -> None:
    text = (ROOT / "LICENSE").read_bytes()
    assert [(ROOT / one / "LICENSE").read_bytes() for one in ("studies", "kernels")] == [text, text]


def test_containers_take_wheels_that_the_build_makes() -> None:
    for name in ("Dockerfile", "packaging/apptainer.def"):
        text = (ROOT / name).read_text(encoding="utf-8")
        minor = re.search(r"python:(3\.\d+)-slim", text)
        assert minor is not None
        assert f"Programming Language :: Python :: {minor[1]}" in PROJECT["classifiers"]
        assert {"ryusa-*.whl", "ryusa_studies-*.whl"} <= set(re.findall(r"ryusa[\w-]*\*\.whl", text))


def test_a_source_distribution_shows_nothing_of_the_machine(tmp_path: Path) -> None:
    written: list[bytes] = []
    for order, owner, at in ((("a", "b"), "one", 1.0), (("b", "a"), "other", 2.0)):
        file = tmp_path / f"{owner}.tar.gz"
        with tarfile.open(file, "w:gz") as archive:
            for name in order:
                member = tarfile.TarInfo(f"x/{name}")
                member.size, member.mtime, member.uname, member.mode = 1, at, owner, int(at)
                archive.addfile(member, io.BytesIO(name.encode()))
        tool("build").plain(file, 315532800)
        written.append(file.read_bytes())
        with tarfile.open(file) as archive:
            assert [one.name for one in archive] == ["x/a", "x/b"]
    assert written[0] == written[1]


def test_each_extra_is_asked_what_it_is_for() -> None:
    assert set(tool("install").EXTRAS) == set(PROJECT["optional-dependencies"])


def test_the_sixty_seconds_are_commands_of_ryusa() -> None:
    from ryusa.cli import app

    found = tool("install").sixty_seconds()
    names = {one.name or getattr(one.callback, "__name__", "") for one in app.registered_commands}
    assert len(found) == 7
    assert {words[0] for words in found} == {"ryusa"} and {words[1] for words in found} <= names


def test_the_paper_has_the_parts_that_are_asked_and_cites_what_it_lists() -> None:
    text = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    listed = re.findall(
        r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text("utf-8"), flags=re.MULTILINE
    )
    assert set(re.findall(r"@([a-z]+\d{4})", text)) == set(listed)
    parts = re.findall(r"^# (.+)$", text, flags=re.MULTILINE)
    asked = ["Summary", "Statement of need", "State of the field", "Software design"]
    assert parts == [
        *asked,
        "Research impact statement",
        "AI usage disclosure",
        "Acknowledgements",
        "References",
    ]
    assert 750 < len(text.split()) < 1750
