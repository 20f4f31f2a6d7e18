"""The known word that a misspelt one was probably meant to be."""

from collections.abc import Sequence

from ryusa.errors import CaseError


def known_word(word: str, words: Sequence[str], key: str) -> str:
    """Return a word of `words`.

    Raises
    ------
    CaseError : it is none of them; names `key`, which was to hold it, and the nearest.
    """
    if word not in words:
        raise CaseError(key, word, f"must be one of {', '.join(words)}", nearest_word(word, words))
    return word


def nearest_word(value: object, words: Sequence[str]) -> str | None:
    """Find the known word nearest to what was written; None where none is near.

    Near is a word within one edit per three letters, or one that the written word is a part of:

    >>> nearest_word("diametr", ["density", "diameter"]), nearest_word("tau", ["tau_star", "drag"])
    ('diameter', 'tau_star')
    >>> nearest_word("inflow", ["low", "high"]) is None
    True
    """
    if not isinstance(value, str):
        return None
    written = value.strip().lower()
    near = {word: edits(written, word.lower()) for word in words if is_near(written, word.lower())}
    return min(near, key=near.__getitem__) if near else None


def is_near(written: str, word: str) -> bool:
    """Whether one word may be a misspelling of the other."""
    if len(written) <= 2:  # one edit turns most words of two letters into one another
        return written == word
    if len(written) == len(word) <= 3:  # as one letter does to a word of three: "gpu" is not "cpu"
        return sorted(written) == sorted(word)
    if abs(len(written) - len(word)) <= 2 and edits(written, word) <= max(
        1, max(len(written), len(word)) // 3
    ):
        return True
    return written in word.replace("-", "_").replace(" ", "_").split("_")


def edits(one: str, other: str) -> int:
    """Fewest insertions, deletions, replacements and swaps of neighbours between two words.

    >>> edits("lenght", "length"), edits("sprng", "spring")
    (1, 1)
    """
    before: list[int] = []
    last = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        row = [i]
        for j, b in enumerate(other, 1):
            best = min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (a != b))
            if i > 1 and j > 1 and a == other[j - 2] and one[i - 2] == b:
                best = min(best, before[j - 2] + 1)
            row.append(best)
        before, last = last, row
    return last[-1]
