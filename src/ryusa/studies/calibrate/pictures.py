"""Pictures of a calibration from its posterior, emulators and runs."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.calibration import (
    CalibratedParameter,
    EmulatedTarget,
    PredictedTarget,
    emulators_picture,
    parameters_picture,
    predicted_picture,
)
from ryusa.studies.calibrate.carry import Calibration
from ryusa.studies.calibrate.design import filling_points
from ryusa.studies.sweep.part import short_names
from ryusa.studies.sweep.pictures import printed_unit

SAMPLE = 4000  # points of the posterior that are drawn
TURN = {"rad": ("deg", 180.0 / math.pi)}  # SI unit -> unit of pictures and pages, and factor


def shown(unit: str) -> tuple[str, float]:
    """Unit in which pages and pictures give a quantity, and the factor from its SI unit.

    >>> shown("rad")[0], shown("m")
    ('deg', ('m', 1.0))
    """
    return TURN.get(unit, (unit, 1.0))


def drawn_calibration(made: Calibration) -> dict[str, Figure]:
    """Pictures by name: parameters, emulators, predicted."""
    rng = np.random.default_rng(0)
    posterior, priors = made.posterior, made.asked.priors
    chosen = posterior.values[rng.choice(len(posterior.u), SAMPLE, p=posterior.weights)]
    names = short_names([one.key for one in priors])
    even = (np.arange(SAMPLE) + 0.5) / SAMPLE
    parameters = [
        CalibratedParameter(_label(names[k], one.unit), chosen[:, k], one.at(even), one.low, one.high)
        for k, one in enumerate(priors)
    ]
    targets = [(one, *shown(one.unit)) for one in made.predicted]
    emulated: list[EmulatedTarget] = []
    predicted: list[PredictedTarget] = []
    cube = filling_points(len(priors), SAMPLE // 2 + 48, 0)  # 2048 points
    for one, unit, factor in targets:
        emulator = made.emulators[one.target]
        label = _label(one.target.words, unit)
        _, values = made.runs.of(one.target, made.training)
        away, sd = emulator.left_out()
        emulated.append(EmulatedTarget(label, factor * values, factor * (values - away), factor * sd))
        _, _, sample = posterior.of(emulator)
        mean, width = emulator.at(cube)
        prior = mean + width * rng.standard_normal(len(mean))
        seen = None if one.observed is None else (factor * one.observed[0], factor * one.observed[1])
        predicted.append(PredictedTarget(label, factor * prior, factor * sample, seen))
    return {
        "parameters": parameters_picture(parameters),
        "predicted": predicted_picture(predicted),
        "emulators": emulators_picture(emulated),
    }


def _label(name: str, unit: str) -> str:
    words = name.replace("_", " ")
    return f"{words}  ({printed_unit(unit)})" if unit not in {"", "-"} else words
