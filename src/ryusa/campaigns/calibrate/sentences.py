"""The verdict of a calibration in sentences, for terminal, tables, page and notebook."""

import math
from collections.abc import Sequence

from ryusa.campaigns.calibrate.definition import Observation
from ryusa.campaigns.calibrate.extend import PriorExtension
from ryusa.campaigns.calibrate.heaps import OTHER
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.calibrate.verdict import (
    FAR,
    CalibrationVerdict,
    ComparedObservation,
    ParameterMove,
)

TURN = {"rad": ("deg", 180.0 / math.pi)}  # SI unit -> unit of tables, pictures and pages, and factor


def shown(unit: str) -> tuple[str, float]:
    """Unit in which pages and pictures give a quantity, and the factor from its SI unit.

    >>> shown("rad")[0], shown("m")
    ('deg', ('m', 1.0))
    """
    return TURN.get(unit, (unit, 1.0))


def headline(verdict: CalibrationVerdict, priors: Sequence[Prior]) -> str:
    """The verdict in one sentence or two."""
    if verdict.refusal:
        return f"{verdict.refusal[0].upper()}{verdict.refusal[1:]}."
    found = [prior.key for prior, one in zip(priors, verdict.determined, strict=True) if one]
    lacking: dict[str, list[str]] = {}
    for k, prior in enumerate(priors):
        if verdict.reason(k):
            lacking.setdefault(verdict.reason(k), []).append(prior.key)
    said = [f"Determined: {', '.join(found)}."] if found else []
    if lacking:
        each = "; ".join(f"{', '.join(keys)} ({why})" for why, keys in lacking.items())
        said.append(f"Not determined: {each}.")
    return " ".join(said)


def status(verdict: CalibrationVerdict, k: int) -> str:
    """The verdict on parameter k, for a table."""
    if not verdict.reason(k):
        return "determined"
    return verdict.refusal or f"not determined: {verdict.reason(k)}"


def remarks(
    verdict: CalibrationVerdict,
    priors: Sequence[Prior],
    observations: Sequence[Observation],
    units: Sequence[str],
    extensions: Sequence[PriorExtension],
) -> list[str]:
    """What stands behind the verdict: observations that are not reached, edges, and what was assumed.

    Parameters
    ----------
    verdict : the verdict.
    priors, observations : as they are asked, after any extension.
    units : SI unit of each observation.
    extensions : of the priors.
    """
    said: list[str] = []
    for one, compared, unit in zip(observations, verdict.compared, units, strict=True):
        if not compared.reached:
            said.append(f"{one.words}: {_distance(compared, unit)}. {move_words(compared.move, priors)}.")
        if compared.untold:
            said.append(
                f"{one.words}: runs that are left out are not foreseen, so that this is no verdict on the "
                "model. More points (calibrate.points), more seeds or larger samples may reverse it."
            )
    for prior, edge in zip(priors, verdict.edges, strict=True):
        if edge is None:
            continue
        where = f"{prior.key} lies at the {edge.end} edge of its prior, {_with_unit(edge.value, prior.unit)}"
        beyond = (
            "the cases take nothing beyond, so that the observations only bound it"
            if edge.limit
            else "--extend 1 carries the prior and the runs beyond it"
        )
        said.append(f"{where}; {beyond}.")
    if verdict.seeds < 2:
        said.append("One seed gives no interval; calibrate.seeds must be 2 or more for one.")
    said += [
        f"{one.words}: {discrepancy_words(compared, unit)}."
        for one, compared, unit in zip(observations, verdict.compared, units, strict=True)
        if compared.discrepancy > 0.0
    ]
    said += [
        f"{one.target.words}: test = '{OTHER}', so that what the test of the case changes is taken for a "
        "change of the parameters."
        for one in observations
        if one.test == OTHER
    ]  # fmt: skip
    return [*said, *(one.words for one in extensions)]


def move_words(move: ParameterMove | None, priors: Sequence[Prior]) -> str:
    """Which parameter would have to move, and to what."""
    if move is None:
        return "No parameter moves it by more than the emulator is uncertain"
    prior = priors[move.parameter]
    to = f"By the emulator's slope, {prior.key} would have to be about {_with_unit(move.to, prior.unit)}"
    if not move.possible:
        return f"{to}, which the cases do not take"
    if prior.low <= move.to <= prior.high:
        return f"{to}, within its prior"
    return f"{to}, beyond its prior ({prior.words})"


def discrepancy_words(compared: ComparedObservation, unit: str) -> str:
    """What a discrepancy term does."""
    unit, factor = shown(unit)
    width = math.hypot(compared.error, compared.discrepancy)
    return (
        f"the discrepancy widens its error from {_with_unit(factor * compared.error, unit)} to "
        f"{_with_unit(factor * width, unit)}, and all intervals with it; it corrects no bias. Without it the "
        f"posterior would be {abs(compared.strict_misfit):.1f} standard deviations away"
    )


def _distance(compared: ComparedObservation, unit: str) -> str:
    unit, factor = shown(unit)
    observed = f"{factor * compared.value:.4g} ± {factor * compared.error:.2g}"
    ends = f"{factor * compared.least:.4g} to {factor * compared.most:.4g}"
    outside = f", and {compared.beyond:.1f} outside all runs" if compared.beyond > FAR else ""
    scatter = _with_unit(factor * compared.noise, unit)
    away = f"{abs(compared.misfit):.1f} standard deviations away{outside}"
    return (
        f"observed {_unit(observed, unit)}; all runs give {_unit(ends, unit)} (± {scatter} between seeds), "
        f"the posterior {_with_unit(factor * compared.predicted, unit)}: {away}"
    )


def _with_unit(value: float, unit: str) -> str:
    return _unit(f"{value:.3g}", unit)


def _unit(text: str, unit: str) -> str:
    return text if unit in {"", "-"} else f"{text} {unit}"
