"""Priors extended beyond an edge at which a posterior lies, as far as the cases take the parameter."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.campaigns.calibrate.design import filling_points
from ryusa.campaigns.calibrate.prior import LOG, Prior
from ryusa.campaigns.calibrate.verdict import HIGH, PriorEdge

Floats = NDArray[np.float64]

SHARE = 0.5  # of its range by which a prior is extended
LEAST = 0.02  # of its range: less is not worth runs
HALVINGS = 12  # of the way to a value that the cases refuse


@dataclass(frozen=True)
class PriorExtension:
    """A prior that was extended because a posterior lay at its edge.

    Attributes
    ----------
    before, after : the prior before and after.
    end : "low" or "high".
    """

    before: Prior
    after: Prior
    end: str

    @property
    def words(self) -> str:
        """The two in words."""
        return (
            f"The prior of {self.before.key} was extended at its {self.end} edge: {self.after.words}, "
            f"instead of {self.before.words}."
        )


def extended_prior(prior: Prior, end: str, taken: Callable[[float], bool]) -> Prior | None:
    """Extend a prior by half of its range beyond an end; None where the cases take nothing there.

    Parameters
    ----------
    prior : the prior; a normal distribution keeps its mean and width and is cut further out.
    end : "low" or "high".
    taken : whether the cases take a value.
    """
    log = prior.kind == LOG
    low, high = (math.log(prior.low), math.log(prior.high)) if log else (prior.low, prior.high)
    edge, step = (high, SHARE * (high - low)) if end == HIGH else (low, -SHARE * (high - low))

    def value(share: float) -> float:
        along = edge + share * step
        return float(f"{math.exp(along) if log else along:.3g}")

    good, bad = 0.0, 1.0
    if taken(value(1.0)):
        good = 1.0
    else:
        for _ in range(HALVINGS):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if taken(value(middle)) else (good, middle)
    if good * SHARE < LEAST:
        return None
    return replace(prior, high=value(good)) if end == HIGH else replace(prior, low=value(good))


def points_beyond(extensions: Sequence[PriorExtension], priors: Sequence[Prior], n: int, seed: int) -> Floats:
    """Points that fill what was added to the unit cube, n for each extension, a power of 2."""
    keys = [one.key for one in priors]
    found: list[Floats] = []
    for j, one in enumerate(extensions):
        k = keys.index(one.after.key)
        u = filling_points(len(priors), n, seed + j)
        edge = float(one.after.share(one.before.high if one.end == HIGH else one.before.low))
        u[:, k] = edge + (1.0 - edge) * u[:, k] if one.end == HIGH else edge * u[:, k]
        found.append(u)
    return np.concatenate(found)


def mark_limits(
    priors: Sequence[Prior], edges: Sequence[PriorEdge | None], taken: Callable[[str, float], bool]
) -> tuple[PriorEdge | None, ...]:
    """Edges, with those marked beyond which the cases take no value."""
    found: list[PriorEdge | None] = []
    for prior, edge in zip(priors, edges, strict=True):
        if edge is None:
            found.append(None)
            continue
        wider = extended_prior(prior, edge.end, lambda value, key=prior.key: taken(key, value))
        found.append(replace(edge, limit=wider is None))
    return tuple(found)
