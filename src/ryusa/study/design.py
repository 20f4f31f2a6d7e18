"""Settings of a study: the levels of its free choices by a space-filling design."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

BLOCK = 16  # points of a hypercube


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
        n : at most `BLOCK`, or a multiple of it.

        Returns
        -------
        Settings without repetition: fewer than n + 1 if points fall on the same levels, and every combination
        if there are at most n + 1.

        Raises
        ------
        ValueError : n is no such number.

        Notes
        -----
        Latin hypercubes of `BLOCK` points (McKay, Beckman & Conover 1979, Technometrics 21, 239), each of the
        least centred discrepancy found by exchanges of coordinates. A coordinate is cut into as many equal
        parts as its factor has levels. So each level of a factor is used equally often, but for one, in every
        block, and pairs of levels nearly so. A larger design
        contains a smaller one; one of less than a block has its first points.

        >>> design = Design((Factor("slip", {"spring": {}, "total": {"contact.slip": "total"}}),))
        >>> design.settings(16)
        [{'slip': 'spring'}, {'slip': 'total'}]
        """
        if n < 0 or (n > BLOCK and n % BLOCK != 0):
            raise ValueError(f"n = {n} must be at most {BLOCK} or a multiple of it")
        names, levels = zip(*self.levels.items(), strict=True)
        if n > 0 and math.prod(map(len, levels)) <= n + 1:
            return [dict(zip(names, chosen, strict=True)) for chosen in product(*levels)]
        sets = [
            {name: values[int(u * len(values))] for name, values, u in zip(names, levels, point, strict=True)}
            for block in range(-(-n // BLOCK))
            for point in _points(len(levels), block)[: min(n, BLOCK)]
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


@cache
def _points(factors: int, block: int) -> tuple[tuple[float, ...], ...]:
    """Points of one block in the unit cube."""
    from scipy.stats import qmc

    cube = qmc.LatinHypercube(factors, rng=block + 1, scramble=False, optimization="random-cd")
    return tuple(tuple(float(u) for u in one) for one in cube.random(BLOCK))


def _distinct(sets: Sequence[dict[str, str]]) -> list[dict[str, str]]:
    return list({tuple(one.items()): one for one in sets}.values())
