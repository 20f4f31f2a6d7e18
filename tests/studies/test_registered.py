"""A band or a text that is registered is not edited in place: what changes is a further entry with its date.

registered.txt has a line for each; `python tests/studies/test_registered.py` adds new ones and takes none
away, so that an edit shows. It does not see what a number is measured from, such as a window of time: where
that changes, the first entry of its band names the number that it judged.
"""

import ast
import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import pytest

from ryusa.study import Band
from ryusa.study.registration import TEXTS, RegisteredClaim, limits_of
from ryusa_studies import validation
from ryusa_studies.osada2004.study import PAPER
from ryusa_studies.validation.declared import FOLDER, Declared, declared
from ryusa_studies.validation.study import VALIDATION

LISTED = Path(__file__).with_name("registered.txt")
STUDIES = {one.name: one.registration for one in (PAPER, VALIDATION) if one.registration is not None}
MAKES_A_BAND = {"Band", "at_most", "_twice"}
ADD = f"python tests/studies/{Path(__file__).name}"
GONE = """
{lines}

No longer so, but listed in registered.txt: an entry was edited in place or taken away. Put it back as it was,
and write the change as a further entry beside it: [[claim.band]] with its date and `change`, or for a text
[[claim.changed]] with its wording before. A band that only comparisons/ or the code of a validation had goes
into its registration as the first of two entries, in the file named after the module; its reason stays as it
was, or is the expression that made it, where the limits depend on what is measured. Then: {add}
"""
NEW = "\n{lines}\n\nNew, and not yet listed in registered.txt. Add it: {add}"


def _digest(*texts: str) -> str:
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:10]


def of_claim(study: str, claim: RegisteredClaim) -> Iterator[str]:
    """Id, part, limits and date of each entry, a digest of what else it says; each text, now and before."""
    for one in claim.bands:
        rest = _digest("" if one.band is None else one.band.says, one.number, one.change)
        yield f"band | {study} {claim.id} | {one.part} | {limits_of(one.band)} | {one.date} | {rest}"
    now = [(key, getattr(claim, key)) for key in TEXTS]
    for key, text in [*now, *((one.text, one.was) for one in claim.changed)]:
        if text:
            whole = text if isinstance(text, str) else repr(text)
            yield f"text | {study} {claim.id} | {key} | {_digest(whole)}"


def in_data() -> Iterator[tuple[str, str, str, Band]]:
    """Each band that comparisons/ states: module, finding, part with its word, band."""
    for path in sorted(FOLDER.glob("*.toml")):
        for one in declared(str(path)).values():
            for name, given in one.given.get("errors", {}).items():
                part = given if isinstance(given, str) else given["part"]
                for word in _words(given):
                    band = one.band(name, word)
                    if band is not None:
                        yield path.stem, one.id, part.replace("{}", word or "{}"), band


def _words(given: str | Mapping[str, object]) -> list[str]:
    """Words by which limits differ; an empty one where they do not."""
    tables = [] if isinstance(given, str) else [one for one in given.values() if isinstance(one, Mapping)]
    return list(dict.fromkeys(str(word) for one in tables for word in one)) or [""]


def in_code() -> Iterator[str]:
    """Each band that a part of the validation states in its code."""
    own = Path(validation.__file__).parent.glob("*.py")
    for path in sorted(one for one in own if one.stem != Declared.__module__.rpartition(".")[2]):
        names = vars(import_module(f"{validation.__name__}.{path.stem}"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in MAKES_A_BAND
            ):
                yield _in_code(path.stem, node, names)


def _in_code(stem: str, node: ast.Call, names: Mapping[str, object]) -> str:
    try:
        return _stated(stem, eval(ast.unparse(node), dict(names)))
    except NameError:  # its limits depend on what is measured, or on the level
        return f"code | {stem} | {ast.unparse(node)}"


def _stated(stem: str, band: Band) -> str:
    return f"code | {stem} | {limits_of(band)} | {band.says}"


def registered() -> set[str]:
    """Lines of today."""
    claims = [(name, claim) for name, whole in STUDIES.items() for claim in whole.claims.values()]
    data = (f"data | {' | '.join(at)} | {limits_of(band)} | {band.says}" for *at, band in in_data())
    return {*data, *in_code(), *(line for name, claim in claims for line in of_claim(name, claim))}


def moved() -> set[str]:
    """Bands that code may have had before: what stands registered, or as data, has their limits and reason.

    Of one whose limits depend on what is measured the reason is the expression that made it. Code left the
    unit to the number that is judged, and river_bands.py had the bands of all parts of the river.
    """
    whole, found = STUDIES[VALIDATION.name], set[str]()
    for claim in whole.claims.values():
        stem = whole.paths[claim.id].stem
        bands = [one.band for one in claim.bands if one.band is not None]
        found |= {line for band in bands for line in (_stated(stem, band), f"code | {stem} | {band.says}")}
    for stem, _, _, band in in_data():
        for stem_then in (stem, *(("river_bands",) if stem.startswith("river") else ())):
            found |= {_stated(stem_then, one) for one in (band, replace(band, unit="-"))}
    return found


def listed() -> set[str]:
    """Lines of the file."""
    return set(LISTED.read_text(encoding="utf-8").splitlines()) if LISTED.exists() else set()


def test_what_was_registered_stands_as_it_was() -> None:
    if gone := sorted(listed() - registered() - moved()):
        pytest.fail(GONE.format(lines="\n".join(gone), add=ADD), pytrace=False)


def test_what_is_registered_is_listed() -> None:
    if new := sorted(registered() - listed()):
        pytest.fail(NEW.format(lines="\n".join(new), add=ADD), pytrace=False)


@pytest.mark.parametrize("study", STUDIES)
def test_entries_stand_in_the_order_of_their_dates_and_a_later_one_says_what_changed(study: str) -> None:
    for claim in STUDIES[study].claims.values():
        for part in {one.part for one in claim.bands}:
            entries = [one for one in claim.bands if one.part == part]
            assert [one.date for one in entries] == sorted(one.date for one in entries), (claim.id, part)
            assert all(one.change for one in entries[1:]), (claim.id, part)


if __name__ == "__main__":
    LISTED.write_text("\n".join(sorted(listed() | registered())) + "\n", encoding="utf-8")
