"""Settings of a sweep: every combination of some levels, a list, a Latin hypercube, or a Sobol sequence."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

GRID, LIST, HYPERCUBE, SOBOL = "grid", "list", "latin hypercube", "sobol"
KINDS = (GRID, LIST, HYPERCUBE, SOBOL)
SAMPLED = (HYPERCUBE, SOBOL)
MOST = 10_000  # settings
DIGITS = 6  # of a number within a range: a folder name holds it
SEED = "seed"
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(\S.*?)?\s*")

Setting = Mapping[str, str]  # keys of the case and their values, as `ryusa run --set` takes them


@dataclass(frozen=True)
class Span:
    """A range of numbers of which a sampled design takes some.

    Attributes
    ----------
    low, high : its ends, low < high [unit].
    unit : unit as written after both numbers; "" for none.
    log : whether equal ratios are equally likely; then low > 0.
    whole : whether only whole numbers are taken, both ends included.
    """

    low: float
    high: float
    unit: str = ""
    log: bool = False
    whole: bool = False

    def at(self, u: float) -> str:
        """Value at a share of the range, with six digits.

        >>> Span(2.0, 4.0, "mm").at(0.5), Span(1.0, 100.0, log=True).at(0.5), Span(1, 3, whole=True).at(0.99)
        ('3 mm', '10', '3')
        """
        if self.whole:
            return str(int(self.low) + min(int(u * (self.high - self.low + 1)), int(self.high - self.low)))
        value = self.low * (self.high / self.low) ** u if self.log else self.low + u * (self.high - self.low)
        return f"{value:.{DIGITS}g} {self.unit}".rstrip()


@dataclass(frozen=True)
class SweepAxis:
    """Keys that change together.

    Attributes
    ----------
    choices : by key its levels, as many for every key; or the range that a sampled design takes them from.
    """

    choices: Mapping[str, tuple[str, ...] | Span]

    @property
    def levels(self) -> list[dict[str, str]]:
        """Values of all keys, level by level; for lists alone."""
        lists = {key: one for key, one in self.choices.items() if isinstance(one, tuple)}
        return [dict(zip(lists, each, strict=True)) for each in zip(*lists.values(), strict=True)]

    def at(self, u: float) -> dict[str, str]:
        """Values of all keys at a share of their ranges, or of their levels, 0 <= u < 1."""
        return {
            key: one.at(u) if isinstance(one, Span) else one[int(u * len(one))]
            for key, one in self.choices.items()
        }


@dataclass(frozen=True)
class SweepDesign:
    """The settings of a sweep.

    Attributes
    ----------
    kind : one of `KINDS`.
    axes : what varies; in a list there is one axis.
    settings : keys and values of every setting; one without keys if nothing varies but the seed.
    dropped : points of a sampled design left out, since another gives the same values.
    """

    kind: str
    axes: tuple[SweepAxis, ...]
    settings: tuple[Setting, ...]
    dropped: int = 0

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the case that vary."""
        return tuple(key for axis in self.axes for key in axis.choices)


def design_of(
    kind: str, axes: Sequence[SweepAxis], *, points: int | None = None, seed: int = 1
) -> SweepDesign:
    """Return the settings of a design.

    Parameters
    ----------
    kind : "grid", every combination of the levels of all axes; "list", the levels of the one axis;
        "latin hypercube" or "sobol", `points` that fill the space of the ranges, a coordinate for each axis.
    axes : what varies; none for the case as it is.
    points : number of points of a sampled design; for "sobol" a power of 2.
    seed : seed of a sampled design, 0 or more.

    Raises
    ------
    CaseError : names the key, its value and what is allowed.

    Notes
    -----
    Latin hypercube: M. D. McKay, R. J. Beckman & W. J. Conover (1979), Technometrics 21, 239, of the least
    centred discrepancy found by exchanges of coordinates. Sobol: I. M. Sobol' (1967), USSR Comp. Math. 7, 86,
    scrambled after A. B. Owen (1998), J. Complexity 14, 466. Both by scipy.

    >>> axis = SweepAxis({"motion.slope": ("0.01", "0.02"), "water.depth": ("8 cm", "4 cm")})
    >>> [one["water.depth"] for one in design_of("grid", [axis]).settings]
    ['8 cm', '4 cm']
    """
    if kind not in KINDS:
        raise CaseError("design", kind, f"must be one of {', '.join(KINDS)}", nearest_word(kind, KINDS))
    _refuse_axes(kind, axes)
    if kind in SAMPLED:
        return _sampled(kind, tuple(axes), points, seed)
    if points is not None:
        raise CaseError("points", points, f"is for a design '{HYPERCUBE}' or '{SOBOL}'; this is '{kind}'")
    if kind == LIST and len(axes) > 1:
        raise CaseError("over", None, "in a list all keys change together; a grid combines axes")
    n = math.prod(len(axis.levels) for axis in axes)
    if n > MOST:
        raise CaseError("over", None, f"gives {n:,} settings; a sweep has at most {MOST:,}")
    settings = [
        {key: value for level in chosen for key, value in level.items()}
        for chosen in product(*(axis.levels for axis in axes))
    ]
    return SweepDesign(kind, tuple(axes), tuple(settings))


def _refuse_axes(kind: str, axes: Sequence[SweepAxis]) -> None:
    """Refuse keys that vary twice, lists that are empty, unequal or repeat a level, and ranges in a grid."""
    seen: set[str] = set()
    for axis in axes:
        lists = {key: one for key, one in axis.choices.items() if isinstance(one, tuple)}
        for key, one in axis.choices.items():
            if key == SEED:
                raise CaseError(f"over {key}", None, "is not varied by itself: seeds gives the seeds")
            if key in seen:
                raise CaseError(f"over {key}", None, "varies twice; each key belongs to one axis")
            seen.add(key)
            if isinstance(one, Span) and kind not in SAMPLED:
                raise CaseError(
                    f"over {key}", None,
                    f"is a range, from which '{HYPERCUBE}' and '{SOBOL}' take values; a {kind} needs a list",
                )  # fmt: skip
            if one == ():
                raise CaseError(f"over {key}", None, "has no value")
        if len({len(one) for one in lists.values()}) > 1:
            counts = ", ".join(f"{key} has {len(one)}" for key, one in lists.items())
            raise CaseError(
                f"over {next(iter(lists))}", None, f"keys that change together need as many values: {counts}"
            )
        if lists:
            _refuse_repeated(axis)


def _refuse_repeated(axis: SweepAxis) -> None:
    levels = axis.levels
    for k, level in enumerate(levels):
        if level in levels[:k]:
            key = next(iter(level))
            again = ", ".join(f"{name} = {value}" for name, value in level.items())
            raise CaseError(f"over {key}", level[key], f"the value stands there twice ({again})")


def _sampled(kind: str, axes: tuple[SweepAxis, ...], points: int | None, seed: int) -> SweepDesign:
    if not axes:
        raise CaseError("over", None, f"a design '{kind}' needs keys with ranges")
    if points is None:
        raise CaseError("points", None, f"missing; a design '{kind}' needs the number of its points")
    if not 1 <= points <= MOST:
        raise CaseError("points", points, f"must be 1 to {MOST:,}")
    if not 0 <= seed < 2**63:
        raise CaseError("design_seed", seed, "must be 0 or more")
    from scipy.stats import qmc  # half a second, in each process of a sweep

    rng = np.random.default_rng(seed)
    if kind == SOBOL:
        power = math.log2(points)
        if not power.is_integer():
            low = 2 ** math.floor(power)
            raise CaseError(
                "points", points, f"must be a power of 2 for '{SOBOL}', such as {low} or {2 * low}"
            )
        unit = qmc.Sobol(len(axes), scramble=True, rng=rng).random_base2(int(power))
    else:
        better = "random-cd" if len(axes) > 1 and points > 1 else None
        unit = qmc.LatinHypercube(len(axes), optimization=better, rng=rng).random(points)
    found = [
        {key: value for axis, u in zip(axes, row, strict=True) for key, value in axis.at(float(u)).items()}
        for row in unit
    ]
    distinct = list({tuple(one.items()): one for one in found}.values())
    return SweepDesign(kind, axes, tuple(distinct), len(found) - len(distinct))


def span_of(key: str, low: object, high: object, scale: str = "linear") -> Span:
    """Return a range from its ends as they are written.

    Parameters
    ----------
    key : key of the case, for messages.
    low, high : numbers, or quantities such as "2 mm" in one unit; two integers give whole numbers.
    scale : "linear" or "log".

    Raises
    ------
    CaseError : no such numbers, units that differ, or an empty range.

    >>> span_of("grains.diameter", "2 mm", "4 mm").unit
    'mm'
    """
    name, scales = f"over {key}", ("linear", "log")
    if scale not in scales:
        raise CaseError(name, scale, "scale must be linear or log", nearest_word(scale, scales))
    ends = [_NUMBER.fullmatch(str(one)) for one in (low, high)]
    for written, end in zip((low, high), ends, strict=True):
        if end is None or isinstance(written, bool):
            raise CaseError(name, written, "an end of a range must be a number, or a quantity such as '2 mm'")
    (a, unit), (b, other) = (
        (float(end.group(1)), (end.group(2) or "").strip()) for end in ends if end is not None
    )
    if unit != other:
        raise CaseError(name, f"{low} to {high}", f"both ends must have one unit, not '{unit}' and '{other}'")
    if not a < b:
        raise CaseError(name, f"{low} to {high}", "the low end must be less than the high end")
    if scale == "log" and a <= 0.0:
        raise CaseError(name, f"{low} to {high}", "a log scale needs a low end greater than 0")
    whole = isinstance(low, int) and isinstance(high, int)
    return Span(a, b, unit, scale == "log" and not whole, whole)
