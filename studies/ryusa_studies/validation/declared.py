"""Comparisons as comparisons/ declares them: all of a finding but its numbers and curves.

comparisons/silo.toml has a table for each finding of silo.py, by its id:

- `title`, `source` with how it is `known` (a word of `Known`, closed form if left out), `settings`, `said`;
- `x` and `y`: label of an axis, or label, unit and "log";
- `errors`: by a name of ours the `part` that the number has on the page, its `unit`, and what is asked of it:
  `at_most` for an error that cannot be negative, `low` and `high`, or `twice` the error of a prototype, each
  a number or a table of one by word; and `why`. A number, or a word, of which nothing is asked is shown; such
  a number may be its part alone.

Points that were read in a source stand in a table `read`, by their names.

What stands before the first table holds for every finding that does not say otherwise. Texts have words that
depend on a run in braces; {} in a part is the word by which a number is told from others of its name.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.figures.comparison import Axis, Curve
from ryusa.model.arrays import Floats
from ryusa.study import Band, Finding, Interval, Known, Source, Trial, at_most, comparison, misfit, over_seeds

FOLDER = Path(__file__).with_name("comparisons")
Number = float | Interval | Sequence[float] | Floats  # several are one of each seed: their mean is judged
Told = Number | Trial  # a trial stands as it is, where what is asked depends on what is measured
Settings = Mapping[str, str]  # of a run, by the keys of its case
NONE: Settings = {}
Numbers = Mapping[str, Told | Mapping[Any, Told] | None]  # by name, or by name and word; None is left out


@dataclass(frozen=True)
class Declared:
    """One finding without its numbers.

    Attributes
    ----------
    id : of the finding; it may have words in braces.
    given : its table.
    """

    id: str
    given: Mapping[str, Any]

    def band(self, name: str, word: object = "") -> Band | None:
        """What is asked of a number; None if it is shown alone."""
        given = self.given["errors"][name]
        if isinstance(given, str):
            return None
        low, high, twice, most = (
            one.get(str(word)) if isinstance(one := given.get(key), Mapping) else one
            for key in ("low", "high", "twice", "at_most")
        )
        unit: str = given.get("unit", "-")
        if twice is not None:
            return at_most(2.0 * twice, f"twice the error of the prototype, {twice:g}", unit)
        if most is not None:
            return at_most(most, given["why"], unit)
        if low is None and high is None:
            return None
        ends = -math.inf if low is None else float(low), math.inf if high is None else float(high)
        return Band(*ends, unit, given["why"])

    def trial(self, name: str, number: Number, word: object = "", /, **words: object) -> Trial:
        """One number with its part and what is asked of it."""
        given = self.given["errors"][name]
        part, unit = (given, "-") if isinstance(given, str) else (given["part"], given.get("unit", "-"))
        if not isinstance(number, Interval) and np.ndim(number):
            number = over_seeds([float(one) for one in np.asarray(number)], unit)
        assert isinstance(number, Interval | float)
        return misfit(part.format(word, **words), number, unit, self.band(name, word))

    def finding(
        self,
        ours: Sequence[Curve],
        references: Sequence[Curve],
        numbers: Numbers | Sequence[Trial],
        beside: Sequence[Curve] = (),
        /,
        **words: object,
    ) -> Finding:
        """The finding.

        Parameters
        ----------
        ours, references, beside : curves, as in `comparison`.
        numbers : every number that is declared, the most important first; or trials made of them.
        words : what texts have in braces.

        Raises
        ------
        ValueError : a number that is declared is missing.
        """
        given = self.given
        if isinstance(numbers, Mapping):
            if lacking := given.get("errors", {}).keys() - numbers.keys():
                raise ValueError(f"{self.id}: lacks {', '.join(sorted(lacking))}")
            numbers = [
                number if isinstance(number, Trial) else self.trial(name, number, word, **words)
                for name, every in numbers.items()
                if every is not None
                for word, number in (every if isinstance(every, Mapping) else {"": every}).items()
            ]
        return comparison(
            self.id.format(**words), given["title"].format(**words), self.source(**words),
            _axis(given["x"]), _axis(given["y"]), ours, references, numbers,
            {key: text.format(**words) for key, text in given.get("settings", {}).items()},
            given.get("said", "").format(**words), beside,
        )  # fmt: skip

    @property
    def points(self) -> dict[str, Floats]:
        """Published points under `read`, by their names, each of shape (n, 2)."""
        return {name: np.array(one, dtype=np.float64) for name, one in self.given["read"].items()}

    def source(self, **words: object) -> Source:
        """Its reference."""
        return Source(self.given["source"].format(**words), Known(self.given.get("known", Known.CLOSED)))


def _axis(given: str | Sequence[str]) -> Axis:
    label, unit, *log = (given, "-") if isinstance(given, str) else given
    return Axis(label, unit, bool(log))


def declared(file: str) -> dict[str, Declared]:
    """Findings of a module, by their ids; `file` is its __file__."""
    path = FOLDER / f"{Path(file).stem}.toml"
    given = tomllib.loads(path.read_text(encoding="utf-8"))
    common = {key: one for key, one in given.items() if key in _TEXTS}
    return {id: Declared(id, {**common, **one}) for id, one in given.items() if id not in _TEXTS}


_TEXTS = ("source", "known", "x", "y", "settings", "said")
