"""Pages that promise to run do run: Python blocks in order, `$ ryusa` lines through the command line."""

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.full

ROOT = Path(__file__).parents[2]
RYUSA = Path(sys.executable).parent / "ryusa"
BLOCK = re.compile(r"^```(python|console)\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> Iterator[tuple[str, str, int]]:
    """Language, text and first line number of each block that runs."""
    text = page.read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        yield found[1], found[2], text.count("\n", 0, found.start()) + 2


def play(page: Path) -> None:
    """Run a page in the current folder."""
    names: dict[str, object] = {"__name__": "__page__"}
    for language, text, line in blocks(page):
        if language == "python":
            exec(compile("\n" * (line - 1) + text, page.name, "exec"), names)
            continue
        for command in re.findall(r"^\$ ryusa (.*)$", text, flags=re.MULTILINE):
            done = subprocess.run([RYUSA, *shlex.split(command)], capture_output=True, text=True, check=False)
            assert done.returncode == 0, f"{page.name}:{line}: ryusa {command}\n{done.stdout}{done.stderr}"


@pytest.mark.parametrize(
    "name", ["docs/getting-started.md", "docs/saltation.md", "docs/theory.md", "README.md"]
)
def test_a_page_runs_from_top_to_bottom(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = ROOT / name
    for extra, call in (("pandas", "to_pandas("), ("xarray", "to_xarray(")):
        if call in page.read_text(encoding="utf-8"):
            pytest.importorskip(extra)
    assert list(blocks(page)), "a page that promises to run has blocks"
    monkeypatch.chdir(tmp_path)
    play(page)
