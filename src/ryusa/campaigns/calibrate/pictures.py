"""Pictures of a calibration from its posterior, emulators and runs."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.campaigns.calibrate.design import filling_points
from ryusa.campaigns.calibrate.execution import Calibration
from ryusa.campaigns.calibrate.sentences import shown
from ryusa.campaigns.sweep.part import short_names
from ryusa.campaigns.sweep.pictures import printed_unit
from ryusa.figures.calibration import (
    CalibratedParameter,
    EmulatedTarget,
    PredictedTarget,
    emulators_picture,
    parameters_picture,
    predicted_picture,
)

PARTS = ("parameters", "predicted", "emulators")
SAMPLE = 4000  # points of the posterior that are drawn


def drawn_calibration(made: Calibration) -> dict[str, Figure]:
    """Pictures by name, of `PARTS`.

    The distribution of the parameters is drawn where the verdict allows an interval, that of the quantities
    from two seeds on.
    """
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
    drawn = {"emulators": emulators_picture(emulated)}
    if made.verdict.seeds > 1:
        drawn = {"predicted": predicted_picture(predicted), **drawn}
    if made.verdict.has_intervals:
        drawn = {"parameters": parameters_picture(parameters), **drawn}
    return drawn


def _label(name: str, unit: str) -> str:
    words = name.replace("_", " ")
    return f"{words}  ({printed_unit(unit)})" if unit not in {"", "-"} else words
