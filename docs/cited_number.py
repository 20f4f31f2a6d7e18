"""A number or words of a ledger, and how a page writes them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher

from ryusa.study.verdict import Count

SCALES = {("-", "%"): 100.0, ("s", "ms"): 1e3, ("s", "µs"): 1e6, ("s", "minutes"): 1 / 60}


class UnknownNumber(Exception):
    """A comment names what no ledger holds, or what stands more than once in it."""


@dataclass(frozen=True)
class Number:
    """One number of a ledger.

    Attributes
    ----------
    value : the number; None for words, and for a range without a middle.
    low, high : its interval.
    unit : its unit.
    n : seeds or runs behind it.
    words : what is shown instead of the number.
    digits : significant digits that are shown.
    """

    value: float | None
    low: float
    high: float
    unit: str = "-"
    n: int = 1
    words: str = ""
    digits: int = 3

    def __str__(self) -> str:
        if self.words:
            return self.words
        unit = "" if self.unit == "-" else f" {self.unit}"
        low, high = self._short(self.low), self._short(self.high)
        if self.value is None:
            return f"{low} to {high}{unit}"
        middle = f"{self._short(self.value)}{unit}"
        return middle if low == high else f"{middle} ({low} to {high})"

    def _short(self, value: float) -> str:
        """The number with its digits, without an exponent from 0.0001 to 1e6."""
        whole = abs(value) >= 10 ** (self.digits - 1)
        rounded = float(f"{value:.{self.digits}g}") if self.digits < 3 or not whole else value
        return f"{rounded:.0f}" if whole else f"{rounded:.{self.digits}g}"

    def formatted(self, form: str) -> "Number":
        """The number in a format: `value`, `count`, `no unit`, a unit or `N digits`."""
        if self.words and self.value is not None and form == "count":
            return replace(self, words=re.sub(r" settings?\b", "", self.words))
        if self.words and form != "value":
            raise UnknownNumber(f"{form!r} is no format of {self.words!r}")
        if form == "value":
            middle = self._middle()
            return replace(self, low=middle, high=middle)
        if form == "count":
            return share(round(self._middle() * self.n), self.n)
        if form == "no unit":
            return replace(self, unit="-")
        if found := re.fullmatch(r"(\d) digits?", form):
            return replace(self, digits=int(found[1]))
        if scale := SCALES.get((self.unit, form)):
            scaled = [None if one is None else one * scale for one in (self.value, self.low, self.high)]
            return replace(self, value=scaled[0], low=scaled[1], high=scaled[2], unit=form)
        known = ["value", "count", "no unit", "2 digits", *(to for unit, to in SCALES if unit == self.unit)]
        raise UnknownNumber(f"no format {form!r} of a number in {self.unit!r}; {nearest(form, known)}")

    def _middle(self) -> float:
        if self.value is None:
            raise UnknownNumber(f"{self} has no value")
        return self.value

    def is_so(self, said: str) -> bool:
        """Whether "above 0.9", "below 0.9" or, word for word, another text is true of it."""
        found = re.fullmatch(r"(above|below) (-?[\d.e-]+)", said)
        if found is None:
            return str(self) == said
        limit = float(found[2])
        return self.low > limit if found[1] == "above" else self.high < limit


def share(holds: int, of: int) -> Number:
    """Cases of all cases, as "6 of 15"; compared with a limit it is their share."""
    part = holds / of if of else 0.0
    return Number(part, part, part, n=of, words=f"{holds or 'none'} of {of}")


def settings(count: Count) -> Number:
    """Settings of all that were run; compared with a limit, an undecided one may hold or fail."""
    of = count.of or 1
    least, most = count.holds / of, (count.holds + count.undecided) / of
    return Number(least, least, most, n=count.of, words=count.in_words())


def plain(count: float, unit: str = "-") -> Number:
    """A number without an interval."""
    return Number(count, count, count, unit)


def nearest(written: str, known: Sequence[str]) -> str:
    """The known word that a wrong one was probably meant to be, as the end of a message."""
    if not known:
        return "nothing is known"

    def alike(one: str) -> tuple[float, float]:  # first by its beginning, which is enough to name a number
        words = (one[: max(len(written), 4)], one)
        begun, whole = (SequenceMatcher(None, written.lower(), word.lower()).ratio() for word in words)
        return begun, whole

    return f"nearest: {max(known, key=alike)[:120]!r}"


def worded(words: str) -> Number:
    """Words instead of a number."""
    return Number(None, 0.0, 0.0, words=words)
