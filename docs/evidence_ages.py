"""When each kept table was made, and of which commit: `make ages` adds what has changed since.

python docs/evidence_ages.py
"""

import json
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ryusa.study.cost import code_in_words
from ryusa.study.ledger_file import read_ledger

FEW = 6  # parts that are named
ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Made:
    """When something was made.

    Attributes
    ----------
    day : as 2026-11-27.
    commit : of the code, as far as it is told; empty if it is not.
    parts : of it that were made then; empty for all.
    """

    day: str
    commit: str
    parts: str = ""

    def __str__(self) -> str:
        """In words."""
        code = f"commit {code_in_words(self.commit)}" if self.commit else "commit not kept"
        return f"{self.day}, {code}" + (f" ({self.parts})" if self.parts else "")


def tables() -> list[dict[str, str]]:
    """What docs/evidence.toml lists."""
    return tomllib.loads((ROOT / "docs" / "evidence.toml").read_text(encoding="utf-8"))["table"]


def made(kept: Path) -> list[Made]:
    """When a kept table, or each of its parts, was made; the newest first, parts of one commit together."""
    if kept.suffix == ".xz":
        whole = read_ledger(kept)["provenance"]
        told: Mapping[str, Any] = whole.get("parts", {})
        parts = defaultdict[str, list[str]](list)
        for name, one in sorted(told.items()):
            parts[one["commit"]].append(name)
        newest = {commit: max(told[name]["made"][:10] for name in names) for commit, names in parts.items()}
        every = [
            Made(newest[commit], commit, ", ".join(names) if len(names) < FEW else f"{len(names)} parts")
            for commit, names in parts.items()
        ]
        every.append(Made(whole["made"][:10], whole["commit"], "the rest" if parts else ""))
        return sorted(every, key=lambda one: one.day, reverse=True)
    table = json.loads(kept.read_text(encoding="utf-8"))
    days = [*_days(table), *re.findall(r"\d{4}-\d\d-\d\d", kept.name)]
    versions = " ".join(str(one) for one in table.get("versions", {}).values())
    commits = re.findall(r"\(([0-9a-f]{9})\)", versions)
    return [Made(max(days), commits[0] if commits else "")]


def _days(told: Mapping[str, Any]) -> Iterator[str]:
    for one in (told, told.get("machine", {}), *told.get("sittings", [])):
        if "date" in one:
            yield one["date"][:10]


def page_lines() -> str:
    """The table of docs/evidence-ages.md."""
    lines = ["| what | made | anew by | which takes |", "|---|---|---|---|"]
    for one in tables():
        when = "; ".join(map(str, made(ROOT / one["kept"])))
        lines.append(f"| [{one['name']}]({one['page']}) | {when} | `{one['command']}` | {one['takes']} |")
    return "\n".join(lines) + "\n"


def since(commit: str) -> str:
    """How many commits changed src/ since one, in words."""
    words = ["git", "-C", str(ROOT), "rev-list", "--count", f"{commit.removesuffix('+')}..HEAD", "--", "src"]
    done = subprocess.run(words, check=False, capture_output=True, text=True)
    return f"{done.stdout.strip()} commits in src/ since" if done.returncode == 0 else "not in this history"


def main() -> None:
    """Print each table with its ages."""
    for one in tables():
        print(f"{one['name']}  ({one['command']}; {one['takes']})")
        for when in made(ROOT / one["kept"]):
            print(f"  {when}" + (f": {since(when.commit)}" if when.commit else ""))


if __name__ == "__main__":
    main()
