"""Findings of the paper's parts, with what findings.toml says of each: what decides it, and its settings."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ryusa.study import Finding, Trial

_GIVEN: Mapping[str, Any] = tomllib.loads(
    Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")
)


def finding(
    claim: str,
    trials: Sequence[Trial],
    *,
    also: Sequence[str] = (),
    beside: Sequence[Trial] = (),
    contradiction: str = "",
    **words: object,
) -> Finding:
    """Return the finding about a claim.

    Parameters
    ----------
    trials, also, beside, contradiction : as in `Finding`.
    words : what its texts have in braces.
    """
    given = _GIVEN[claim]
    settings = _GIVEN["shared"].get(given.get("of"), {}) | given.get("settings", {})
    return Finding(
        claim, tuple(trials), given["said"].format(**words),
        {name: text.format(**words) for name, text in settings.items()}, contradiction=contradiction,
        also=tuple(also), beside=tuple(beside), readings=tuple(given.get("readings", ())),
    )  # fmt: skip
