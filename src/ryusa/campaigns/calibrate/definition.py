"""What a calibration is asked: parameters, observations and predictions."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.sweep.measures import AtHeight
from ryusa.errors import CaseError
from ryusa.units import UnitError, quantity


@dataclass(frozen=True)
class Target:
    """A quantity of a case that runs give.

    Attributes
    ----------
    case : case file.
    measure, quantity : as `ryusa measure` names them.
    at : height above datum of a quantity over height [m]; None for any other.
    """

    case: Path
    measure: str
    quantity: str
    at: float | None = None

    @property
    def height(self) -> AtHeight | None:
        """The same as a quantity over height, at one height; None for any other."""
        return None if self.at is None else AtHeight(self.measure, self.quantity, self.at)

    @property
    def name(self) -> str:
        """Name of the quantity among those that a run gives."""
        return self.quantity if self.height is None else self.height.name

    @property
    def words(self) -> str:
        """Case, measure and quantity."""
        return f"{self.case.stem}: {self.measure} {self.name}"


@dataclass(frozen=True)
class ObservedValue:
    """An observation in SI.

    Attributes
    ----------
    value, error : observed value and its standard error.
    discrepancy : standard deviation of what the model itself may be off by; 0 for a model without error.
    """

    value: float
    error: float
    discrepancy: float = 0.0

    @property
    def width(self) -> float:
        """Standard deviation of the observation about the mean of the model."""
        return math.hypot(self.error, self.discrepancy)


@dataclass(frozen=True)
class Observation:
    """What was observed of a target.

    Attributes
    ----------
    target : the quantity.
    value, error : observed value and its standard error, as written: text with a unit, or a number.
    discrepancy : standard deviation of what the model itself may be off by, as written; None for none.
    test : of a heap, by a word of `heaps.TESTS`; "" for any other measure.
    """

    target: Target
    value: str | float
    error: str | float
    discrepancy: str | float | None = None
    test: str = ""

    @property
    def words(self) -> str:
        """Target, and the test that was observed."""
        return f"{self.target.words} ({self.test})" if self.test else self.target.words

    def in_si(self, unit: str) -> ObservedValue:
        """Value, error and discrepancy in the SI unit of the quantity.

        Raises
        ------
        CaseError : another dimension, a unit too many or missing, or an error that is not positive.
        """
        where = f"observation of {self.target.words}"
        value, error = (
            _in_si(f"{where}: {name}", one, unit)
            for name, one in (("value", self.value), ("error", self.error))
        )
        if not error > 0.0:
            raise CaseError(f"{where}: error", self.error, "must be greater than 0")
        if self.discrepancy is None:
            return ObservedValue(value, error)
        discrepancy = _in_si(f"{where}: discrepancy", self.discrepancy, unit)
        if discrepancy < 0.0:
            raise CaseError(f"{where}: discrepancy", self.discrepancy, "must be 0 or more")
        return ObservedValue(value, error, discrepancy)


@dataclass(frozen=True)
class CalibrationAsked:
    """A calibration as it is asked.

    Attributes
    ----------
    name : of the study, for the folder.
    priors : parameters.
    observations : what was observed; one or more.
    predictions : quantities to be predicted.
    points : number of points of the space-filling design, a power of 2.
    seeds : number of seeds of each point.
    rounds, more : rounds of further points, and the points of each.
    design_seed : seed of the design.
    overrides : keys set in all runs.
    """

    name: str
    priors: tuple[Prior, ...]
    observations: tuple[Observation, ...]
    predictions: tuple[Target, ...] = ()
    points: int = 32
    seeds: int = 2
    rounds: int = 1
    more: int = 8
    design_seed: int = 1
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def targets(self) -> tuple[Target, ...]:
        """All quantities that runs must give, each once."""
        every = [*(one.target for one in self.observations), *self.predictions]
        return tuple(dict.fromkeys(every))

    @property
    def cases(self) -> tuple[Path, ...]:
        """All case files, each once."""
        return tuple(dict.fromkeys(one.case for one in self.targets))

    def measures(self, case: Path) -> tuple[str, ...]:
        """Names of the measures that are wanted of a case."""
        return tuple(dict.fromkeys(one.measure for one in self.targets if one.case == case))

    def heights(self, case: Path) -> tuple[AtHeight, ...]:
        """Quantities over height that are wanted of a case at one height."""
        return tuple(one.height for one in self.targets if one.case == case and one.height is not None)


def _in_si(at: str, value: str | float, unit: str) -> float:
    if unit in {"", "-"}:
        try:
            found = float(value)
        except ValueError:
            raise CaseError(at, value, "must be a number without a unit") from None
    else:
        try:
            found = quantity(value, unit)
        except UnitError as error:
            raise CaseError(at, value, str(error)) from None
    if not math.isfinite(found):
        raise CaseError(at, value, "must be finite")
    return found
