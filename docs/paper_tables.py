"""Tables of docs/paper.md, from the kept ledgers."""

import re
from collections.abc import Callable, Mapping
from typing import Any

from cited import kept, lookup
from cited_number import UnknownNumber, nearest
from registered_tables import changed_bands, changed_texts

TABLE = re.compile(r"<!-- table (?P<name>[^>]+?) -->.*?<!-- end of table -->", re.DOTALL)
FILMED = {"saltation": "film-saltation", "dry avalanche": "film-avalanche", "debris flow": "film-debris"}
SOFTENED = (
    "Li-Sawamoto over a rough bed",
    "eddies in pores, k_f 0.16",
    "parabolic mixing length",
    "no wall law, drag of the fixed grains",
    "dry avalanche",
)


def paper_table() -> str:
    """Every claim of the kept ledger of `ryusa paper`, and what was changed in their registration."""
    from ryusa_studies.osada2004.study import PAPER, table

    standard, full = kept("paper"), kept("paper-full")
    parts = [
        table(standard),
        robustness_table(standard, full),
        "## Bands and texts that were changed",
        "Every entry of a band that a later one replaced, with the verdict of the kept standard ledger on "
        "the case as it ships by both; what no run has a number for is *not judged*.",
        changed_bands(PAPER, standard),
        "Texts of the registration that were changed after they were committed; the earlier wording stands "
        "beside the later one in the [files](../studies/ryusa_studies/osada2004/registration) and on the "
        "page that `ryusa paper` writes.",
        changed_texts(PAPER),
    ]
    return "\n\n".join(parts) + "\n"


def robustness_table(standard: Mapping[str, Any], full: Mapping[str, Any]) -> str:
    """In how many settings each claim holds at the standard and at the full level."""
    from ryusa.study.verdict_words import count_of
    from ryusa_studies.osada2004.study import PAPER

    more = {one["id"]: one for one in full["findings"]}
    both = [
        (one, more[one["id"]]) for one in standard["findings"] if one["id"] in more
    ]  # later claims are not
    rows = [
        (one["id"], *(count_of(each["robustness"]) for each in (one, new)))
        for one, new in both
        if new["robustness"]["of"]
    ]
    unlike = [
        f"- {one['id']}: {PAPER.said(one)}; at the full level {PAPER.said(new)}"
        for one, new in both
        if (one["base_outcome"], one["outcome"]) != (new["base_outcome"], new["outcome"])
    ]
    lines = [
        "## Twice as many settings",
        "",
        f"The full level has {lookup('paper-full: settings')} settings instead of "
        f"{lookup('paper: settings')}, with the standard ones among them "
        f"({lookup('paper-full: runs')} runs of one commit, "
        "[ledgers/paper-full.json.xz](ledgers/paper-full.json.xz)). The case as it ships is the same. "
        "Verdicts on it, and what holds only with some levels of a choice, that differ between the levels: "
        + ("none." if not unlike else ""),
        "",
        *([*unlike, ""] if unlike else []),
        "| claim | holds at the standard level | at the full level |",
        "|---|---|---|",
    ]
    lines += [f"| {name} | {fewer.in_words()} | {many.in_words()} |" for name, fewer, many in rows]
    return "\n".join(lines)


def films() -> str:
    """Time in contact on a film, in ms, by flow, resolution and frames per second."""
    lines = [
        "| flow | collisions | on the film at 0.05 d | at 0.02 d | at 0.1 d | range at 0.05 d (settings) "
        "| at 250; 100 frames per second | verdict |",
        "|" + "---|" * 8,
    ]
    for flow, claim in FILMED.items():

        def ms(number: str, claim: str = claim, form: str = "2 digits, no unit") -> str:
            return str(lookup(f"paper {claim}: {number}; as ms, {form}"))

        film, whole = "mean time in contact on a film", "value, 2 digits, no unit"
        settings = lookup(f"paper {claim}: {film}; over settings").n
        cells = [
            flow,
            ms("mean collision time", form=whole),
            ms(film),
            ms(f"{film}; resolution = 0.02 d"),
            ms(f"{film}; resolution = 0.1 d"),
            f"{ms(f'{film}; over settings')} ({settings})",
            "; ".join(ms(f"the same on a film of {rate}", form=whole) for rate in (250, 100)),
            str(lookup(f"paper {claim}: verdict")),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def long_contacts() -> str:
    """What the longest contacts do to the paths, and what contacts within the paper's band do."""
    lines = [
        "| flow | overlap/d of the longest | u t/d | paths as steep, times | speed, times "
        "| u t/d at an overlap up to 0.01 d | there as steep, times |",
        "|" + "---|" * 7,
    ]
    told = (
        "longest contacts (overlap #",
        "u t/d #) paths",
        "paths are # times",
        "grains go # times",
        "up to an overlap of 0.01 d (u t/d #",
        "they are # times",
    )
    for flow in SOFTENED:
        numbers = [lookup(f'paper long-contacts: "{flow}: ...{words}"; as no unit') for words in told]
        lines.append(f"| {' | '.join([flow, *map(str, numbers)])} |")
    return "\n".join(lines)


TABLES: Mapping[str, Callable[[], str]] = {"films": films, "long contacts": long_contacts}


def with_tables(text: str) -> str:
    """The text with each of these tables as the ledgers have it.

    Raises
    ------
    UnknownNumber : no table has that name.
    """

    def written(found: re.Match[str]) -> str:
        name = found["name"]
        if name not in TABLES:
            raise UnknownNumber(f"no table {name!r}; {nearest(name, list(TABLES))}")
        return f"<!-- table {name} -->\n\n{TABLES[name]()}\n\n<!-- end of table -->"

    return TABLE.sub(written, text)
