"""Discharge of a silo through openings of several widths: Beverloo's law."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.measure import discharge
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Discharge of a silo"
DECLARED = declared(__file__)
WIDTHS = (1.6, 2.0, 2.4, 2.8)  # of the square opening [cm]: 4 to 7 diameters
D, G, RADIUS = 4.0e-3, 9.81, 0.036  # of the case file [m], [m/s2], [m]
OPENED, STEADY = 0.4, 0.55  # shutter away, and flow steady [s]
SHARE = 0.45  # of the grains that may have left at the end of a run
K = 1.4  # of Beverloo; where the exponent is fitted
PER_SQUARE = 4.0 / math.pi  # a square of side a to a circle of diameter a, which have one hydraulic diameter


def walls(width: float) -> str:
    """The walls of the case with another opening [cm], as TOML."""
    half, out = 0.5 * width, 3.8
    floor = {
        "floor left": (-out, -out, out - half, 2.0 * out), "floor right": (half, -out, out - half, 2.0 * out),
        "floor front": (-half, -out, width, out - half), "floor back": (-half, half, width, out - half),
        "shutter": (-half, -half, width, width),
    }  # fmt: skip
    found = [
        '{ name = "silo", shape = "cylinder", at = ["0 cm", "0 cm", "0 cm"], '
        'axis = ["0 cm", "0 cm", "22 cm"], radius = "3.6 cm" }'
    ]
    for name, (x, y, b, c) in floor.items():
        found.append(
            f'{{ name = "{name}", shape = "rectangle", at = ["{x:g} cm", "{y:g} cm", "0 cm"], '
            f'sides = [["{b:g} cm", "0 cm", "0 cm"], ["0 cm", "{c:g} cm", "0 cm"]] }}'
        )
    return f"[{', '.join(found)}]"


def _length(width: float) -> float:
    """Time of a run [s]: until a part of the grains has left at the rate of Beverloo's law."""
    rate = 0.58 * PER_SQUARE * 1500.0 * math.sqrt(G) * (0.01 * width - K * D) ** 2.5
    return OPENED + min(SHARE * 0.36 / rate, 1.6)


# a quarter of the stiffness of the case: half the steps, overlaps of 0.01 d while the grains flow
RUNS = SampledRuns(
    "silo", "hopper.toml",
    {
        one: {"walls": walls(one), "stop.time": f"{_length(one):.2f} s", "contact.stiffness": "100 N/cm"}
        for one in WIDTHS
    },
)  # fmt: skip
tasks = RUNS.tasks


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Rate of discharge [kg/s] in two halves of the window, and bulk density before the opening [kg/m3]."""
    del one
    flow = discharge(run, begin=STEADY)
    out, t, half = flow.m_out, flow.t, len(flow.t) // 2
    k = int(np.searchsorted(run.frames.t[:], OPENED, "right")) - 1
    z = run.frames.x[k][:, 2]
    low, high = 2.0 * D, 2.0 * D + 0.03
    packed = float(run.scene.m[(z > low) & (z < high)].sum()) / (math.pi * RADIUS**2 * (high - low))
    return {
        "rate": float((out[-1] - out[0]) / (t[-1] - t[0])),
        "halves": np.array([
            (out[half] - out[0]) / (t[half] - t[0]), (out[-1] - out[half]) / (t[-1] - t[half]),
        ]),
        "density": packed,
    }  # fmt: skip


def fitted(width: Floats, rate: Floats, density: float) -> tuple[float, float, float]:
    """Constants C and k of Beverloo's law with the power 5/2, and the power with k = 1.4 [-].

    Parameters
    ----------
    width : of the openings [m], shape (n,).
    rate : of discharge [kg/s], shape (n,).
    density : of the bulk at rest [kg/m3].

    >>> width = np.array([0.016, 0.02, 0.024, 0.028])
    >>> rate = 0.58 * PER_SQUARE * 1500.0 * math.sqrt(G) * (width - 1.4 * D) ** 2.5
    >>> [round(one, 6) for one in fitted(width, rate, 1500.0)]
    [0.58, 1.4, 2.5]
    """
    slope, at_zero = np.polyfit(width, rate**0.4, 1)
    c = float(slope) ** 2.5 / (PER_SQUARE * density * math.sqrt(G))
    power, _ = np.polyfit(np.log(width - K * D), np.log(rate), 1)
    return c, float(-at_zero / slope) / D, float(power)


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Power and constants of Beverloo's law."""
    width = 0.01 * np.array(WIDTHS)
    rates = np.array([runs("rate", one) for one in WIDTHS]).T  # seed, width
    density = np.mean([runs("density", one) for one in WIDTHS], axis=0)
    fits = np.array([fitted(width, rate, rho) for rate, rho in zip(rates, density, strict=True)])
    halves = np.array([[one["halves"][1] / one["halves"][0] for one in runs.of[width]] for width in WIDTHS])
    fine = np.linspace(width[0], width[-1], 50)
    law = 0.58 * PER_SQUARE * float(np.mean(density)) * math.sqrt(G) * (fine - K * D) ** 2.5
    return [
        DECLARED["beverloo"].finding(
            [Curve("grains", width, rates.mean(axis=0))], [Curve("C = 0.58, k = 1.4", fine, law)],
            {"power": fits[:, 2], "C": fits[:, 0], "k": fits[:, 1], "rate": halves.mean(axis=0)},
            density=np.mean(density),
        ),
    ]  # fmt: skip
