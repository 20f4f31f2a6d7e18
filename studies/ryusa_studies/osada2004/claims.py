"""What the paper reports, as data: claims.toml."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Claim:
    """One thing the paper reports, under an id of ours."""

    id: str
    setup: str
    says: str
    figure: str = ""  # of the paper; "" where the text alone says it
    free: str = ""  # what the text does not fix
    caution: str = ""  # what we found about the claim itself
    words: tuple[str, ...] | None = None  # where it holds, where it fails; else those of its kind


def _claim(id: str, given: Mapping[str, Any], shared: Mapping[str, str]) -> Claim:
    """Claim of a table of the file, the shared texts in place of their names."""
    texts = {key: text.format_map(shared) for key, text in given.items() if isinstance(text, str)}
    return Claim(id, words=tuple(given["words"]) if "words" in given else None, **texts)


_GIVEN = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
CLAIMS = {id: _claim(id, one, _GIVEN["shared"]) for id, one in _GIVEN.items() if id != "shared"}
