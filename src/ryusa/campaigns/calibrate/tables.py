"""The lines of parameters and observations, with the verdict before the numbers."""

import math
from collections.abc import Sequence

from ryusa.campaigns.calibrate.definition import Observation
from ryusa.campaigns.calibrate.posterior import ONE_SIGMA, TWO_SIGMA, Posterior
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.calibrate.sentences import status
from ryusa.campaigns.calibrate.verdict import CalibrationVerdict

ABSENT = "-"  # of a number that is not given


def parameter_rows(verdict: CalibrationVerdict, posterior: Posterior) -> list[dict[str, object]]:
    """A line for each parameter, in the unit of its prior; None for what the verdict does not allow.

    Where the model does not reach the observations there is no value, and from one seed no interval.
    """
    found: list[dict[str, object]] = []
    means, sds, narrow = posterior.mean(), posterior.sd(), posterior.narrowing()
    for k, prior in enumerate(posterior.priors):
        edge = verdict.edges[k]
        row: dict[str, object] = {
            "parameter": prior.key, "verdict": status(verdict, k), "determined": verdict.determined[k],
            "at_edge": "" if edge is None else edge.end, "unit": prior.unit or "-",
            "mean": float(means[k]) if verdict.reached else None,
        }  # fmt: skip
        intervals = [posterior.interval(k, share) for share in (ONE_SIGMA, TWO_SIGMA)]
        numbers = [float(sds[k]), *intervals[0], *intervals[1], float(narrow[k])]
        names = ("standard_deviation", "low_68", "high_68", "low_95", "high_95", "over_prior")
        row |= {
            name: number if verdict.has_intervals else None
            for name, number in zip(names, numbers, strict=True)
        }
        found.append({**row, "prior": prior.words})
    return found


def observation_rows(
    verdict: CalibrationVerdict,
    observations: Sequence[Observation],
    units: Sequence[str],
    priors: Sequence[Prior],
) -> list[dict[str, object]]:
    """A line for each observation, in SI but for the value to which a parameter would have to move."""
    found: list[dict[str, object]] = []
    for one, compared, unit in zip(observations, verdict.compared, units, strict=True):
        move = compared.move
        found.append(
            {
                "observation": one.target.words, "test": one.test, "reached": compared.reached, "unit": unit,
                "observed": compared.value, "error": compared.error, "discrepancy": compared.discrepancy,
                "posterior": compared.predicted, "runs_least": compared.least, "runs_most": compared.most,
                "misfit": compared.misfit, "outside_runs": compared.beyond,
                "would_move": None if move is None else priors[move.parameter].key,
                "to": None if move is None else move.to,
                "to_unit": None if move is None else priors[move.parameter].unit or "-",
                "taken_by_case": None if move is None else move.possible,
            }
        )  # fmt: skip
    return found


def printed_number(value: object, digits: int, factor: float = 1.0) -> str:
    """A number to so many digits; a dash where none is given.

    >>> printed_number(None, 3), printed_number(0.12345, 3)
    ('-', '0.123')
    """
    if not isinstance(value, (int, float)) or math.isnan(value):
        return ABSENT
    return f"{factor * value:.{digits}g}"


def printed_interval(low: object, high: object, factor: float = 1.0) -> str:
    """Two ends of an interval; a dash where none is given.

    >>> printed_interval(1.0, 2.5)
    '1 to 2.5'
    """
    ends = printed_number(low, 4, factor), printed_number(high, 4, factor)
    return ABSENT if ABSENT in ends else f"{ends[0]} to {ends[1]}"
