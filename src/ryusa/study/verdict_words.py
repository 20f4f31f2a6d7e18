"""Verdicts in words: what the case as it ships gives, and in how many of all settings the finding holds."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ryusa.study.judge import Outcome
from ryusa.study.verdict import Count, Effect

SHARE = ("holds", "of", "undecided")
CHECK = " (check)"


@dataclass(frozen=True)
class SaidVerdict:
    """A verdict in words.

    Attributes
    ----------
    headline : what the case as it ships gives.
    share : in how many settings it holds, as it follows the headline; empty where no choice is varied.
    condition : the levels of the choice without which it holds in none, as it follows; else empty.
    check : beside the headline of a finding that is a check and no verdict; else empty.
    first : the verdict by the bands as they were registered first, as it follows, where that is another.
    """

    headline: str
    share: str = ""
    condition: str = ""
    check: str = ""
    first: str = ""

    def __str__(self) -> str:
        return f"{self.headline}{self.check}{self.share}{self.condition}{self.first}"


def said(entry: Mapping[str, Any], word: Callable[[Outcome], str], alone: str = "") -> SaidVerdict:
    """Words for the verdict on a finding.

    Parameters
    ----------
    entry : the finding as the JSON file has it.
    word : word for an outcome of the case as it ships.
    alone : said where the case as it ships is the only setting; if empty, the word then stands alone.

    >>> share = {"holds": 14, "of": 17, "undecided": 1}
    >>> str(said({"base_outcome": "fails", "robustness": share, "condition": ""}, str))
    'fails as shipped, though it holds in 14 of 17 settings (1 undecided)'
    """
    registered = entry.get("registered") or {}
    by_first = registered.get("first", "")
    other = by_first and by_first != entry["base_outcome"]
    first = f"; {_by_first(by_first, word)} as first registered" if other else ""
    check = CHECK if registered.get("check") else ""
    return replace(_by_settings(entry, word, alone), check=check, first=first)


def _by_first(outcome: str, word: Callable[[Outcome], str]) -> str:
    return word(Outcome(outcome)) if outcome in set(Outcome) else outcome


def _by_settings(entry: Mapping[str, Any], word: Callable[[Outcome], str], alone: str) -> SaidVerdict:
    base, count = Outcome(entry["base_outcome"]), count_of(entry["robustness"])
    if base is Outcome.SHOWN or (count.of <= 1 and not alone):
        return SaidVerdict(word(base))
    if count.of == 0:
        return SaidVerdict(word(base), ", no setting was judged")
    if base is Outcome.EXCLUDED:
        return SaidVerdict(word(base), f"; it holds in {count.in_words()}")
    headline = f"{word(base)} as shipped"
    if count.of == 1:
        return SaidVerdict(headline, f", {alone}")
    joined = {
        Outcome.HOLDS: ", in",
        Outcome.FAILS: ", though it holds in" if count.holds else ", and in",
        Outcome.UNDECIDED: "; it holds in",
    }
    condition = f", only if {entry['condition']}" if entry["condition"] else ""
    return SaidVerdict(headline, f"{joined[base]} {count.in_words()}", condition)


def count_of(plain: Mapping[str, Any]) -> Count:
    """Settings of a finding, as the JSON file has them."""
    return Count(*(plain[name] for name in SHARE))


def plain_count(count: Count) -> dict[str, int]:
    """Settings of a finding, for the JSON file."""
    return {name: getattr(count, name) for name in SHARE}


def tally(
    entries: Sequence[Mapping[str, Any]], said_of: Callable[[Mapping[str, Any]], SaidVerdict]
) -> list[tuple[Outcome, str, int, str]]:
    """Count findings by the verdict on the case as it ships, and how many of them hold in most settings.

    A check is no verdict and is not among them (`checks`).

    Returns
    -------
    Lines with outcome, headline, number, and words on the settings, which are empty where none is varied.
    """
    counts: Counter[tuple[str, str]] = Counter()
    varied: Counter[tuple[str, str]] = Counter()
    most: Counter[tuple[str, str]] = Counter()
    for one in entries:
        verdict, share = said_of(one), count_of(one["robustness"])
        if verdict.check:
            continue
        condition = ", holds only if one choice is as named" if verdict.condition else ""
        key = one["outcome"], verdict.headline + condition
        counts[key] += 1
        varied[key] += share.of > 1
        most[key] += share.of > 1 and 2 * share.holds > share.of
    return [
        (outcome, key[1], n, _most_in_words(most[key]) if varied[key] else "")
        for outcome in Outcome
        for key, n in counts.items()
        if key[0] == outcome
    ]


def checks(entries: Sequence[Mapping[str, Any]]) -> str:
    """How many findings are checks, and how many of these fail or are undecided; empty if none is.

    >>> checks([{"outcome": "holds", "registered": {"check": True}}, {"outcome": "holds"}])
    '1 check, which holds'
    """
    every = [one["outcome"] for one in entries if (one.get("registered") or {}).get("check")]
    if not every:
        return ""
    left = {what: every.count(what) for what in (Outcome.FAILS, Outcome.UNDECIDED) if what in every}
    n = len(every)
    if not left:
        return "1 check, which holds" if n == 1 else f"{n} checks, which all hold"
    words = {Outcome.FAILS: "fail", Outcome.UNDECIDED: "are undecided"}
    some = ", ".join(f"{k} {words[what]}" for what, k in left.items())
    return f"{n} check{'s' if n > 1 else ''}, of which {some}"


def _most_in_words(n: int) -> str:
    return f"{n or 'none'} {'hold' if n > 1 else 'holds'} in most settings"


def plain_effect(effect: Effect, tried: Sequence[str], halves_of: str) -> dict[str, Any]:
    """The choice that decides, for the JSON file: its levels, the settings with and without, how sure it is.

    Parameters
    ----------
    effect : the choice.
    tried : all its values.
    halves_of : of what the halves are that predicted and confirmed it.
    """
    return {
        "choice": effect.choice, "holds_at": list(effect.levels), "words": effect.in_words(tried),
        "p": effect.p, "confirmed": effect.confirmed, "halves_of": halves_of, "reading": effect.reading,
        "there": plain_count(effect.inside), "elsewhere": plain_count(effect.outside),
    }  # fmt: skip
