"""Settings of a study: the levels of its free choices by a space-filling design."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from scipy.stats import qmc

SEED = 1  # of the scrambled sequence, so that a larger design contains a smaller one


@dataclass(frozen=True)
class Factor:
    """A free choice.

    Attributes
    ----------
    name : as it is named on the page.
    levels : keys of the case file that each level changes, with their values; the first is as shipped.
    """

    name: str
    levels: Mapping[str, Mapping[str, str]]

    @property
    def shipped(self) -> str:
        """Level of the case as it ships."""
        return next(iter(self.levels))

    def only(self, *levels: str) -> "Factor":
        """Return the factor with these levels alone, the one as shipped first."""
        kept = [self.shipped, *(one for one in levels if one != self.shipped)]
        return Factor(self.name, {one: self.levels[one] for one in kept})


@dataclass(frozen=True)
class Design:
    """The free choices that can touch a claim.

    Attributes
    ----------
    factors : choices, each with its levels.
    """

    factors: tuple[Factor, ...]

    @property
    def base(self) -> dict[str, str]:
        """The setting as shipped."""
        return {one.name: one.shipped for one in self.factors}

    @property
    def levels(self) -> dict[str, tuple[str, ...]]:
        """Levels of each factor, by its name."""
        return {one.name: tuple(one.levels) for one in self.factors}

    def settings(self, n: int) -> list[dict[str, str]]:
        """Return the setting as shipped, and n others that fill the space of the levels.

        Parameters
        ----------
        n : 0, or a power of two.

        Returns
        -------
        Settings without repetition: fewer than n + 1 if points of the sequence fall on the same levels, and
        every combination if there are at most n + 1.

        Raises
        ------
        ValueError : n is not a power of two.

        Notes
        -----
        Points of a scrambled Sobol sequence (Sobol 1967, USSR Comput. Math. Math. Phys. 7, 86; Owen 1998, ACM
        Trans. Model. Comput. Simul. 8, 71), each coordinate cut into as many equal parts as its factor has
        levels. The first n points of a power of two put the levels of each factor to use equally often (but
        for one), and those of most pairs of factors. A larger design contains a smaller one.

        >>> design = Design((Factor("slip", {"spring": {}, "total": {"contact.slip": "total"}}),))
        >>> design.settings(4)
        [{'slip': 'spring'}, {'slip': 'total'}]
        """
        if n == 0:
            return [self.base]
        power = round(math.log2(n))
        if n != 2**power:
            raise ValueError(f"n = {n} must be 0 or a power of two")
        names, levels = zip(*self.levels.items(), strict=True)
        if math.prod(map(len, levels)) <= n + 1:
            return [dict(zip(names, chosen, strict=True)) for chosen in product(*levels)]
        points = qmc.Sobol(len(levels), rng=SEED).random_base2(power)
        sets = [
            {name: values[int(u * len(values))] for name, values, u in zip(names, levels, point, strict=True)}
            for point in points
        ]
        return _distinct([self.base, *sets])

    def overrides(self, chosen: Mapping[str, str]) -> dict[str, str]:
        """Return the keys of the case file that a setting changes; names that are no factor are ignored."""
        return {
            key: value
            for one in self.factors
            if one.name in chosen
            for key, value in one.levels[chosen[one.name]].items()
        }


def _distinct(sets: Sequence[dict[str, str]]) -> list[dict[str, str]]:
    return list({tuple(one.items()): one for one in sets}.values())
