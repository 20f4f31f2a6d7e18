"""How often and for how long each comparison with random draws is run, and why: the one table of it.

Verdicts of single runs do not repeat (design/0015). A number is the mean over independent runs with its 95 %
interval between runs; block means within a run are not enough where the flow stops and starts.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ryusa.study import Level, Plan

STRIDE = 1000  # between the seeds of runs that belong to one seed of the study


@dataclass(frozen=True)
class Sampling:
    """Runs of one comparison.

    Attributes
    ----------
    runs : independent runs for each seed of the study, at the standard and at the full level.
    time : length of a run at the quick, standard and full level, in `unit`; from the case file where None.
    unit : what `time` counts.
    why : reason of both.
    """

    runs: tuple[int, int]
    time: tuple[float, float, float] | None
    unit: str
    why: str

    def length(self, level: Level) -> float:
        """Length of a run; nan for that of the case file."""
        return math.nan if self.time is None else self.time[list(Level).index(level)]

    def seeds(self, plan: Plan) -> tuple[int, ...]:
        """Seeds of all runs; those of disjoint seeds of the study, up to STRIDE, are disjoint.

        >>> SAMPLING["equilibrium"].seeds(Plan(Level.STANDARD, (1, 2)))
        (1, 1001, 2, 1002)
        """
        n = 1 if plan.level is Level.QUICK else self.runs[plan.level is Level.FULL]
        return tuple(seed + STRIDE * k for seed in plan.seeds for k in range(n))


SAMPLING: Mapping[str, Sampling] = {
    "balance": Sampling(
        (1, 2), (2.5, 5.0, 10.0), "s",
        "the momentum stored is bounded, so the error falls as 1/time: 0.4 % after 5 s",
    ),
    "gas": Sampling(
        (4, 8), (0.1, 2.0, 2.0), "tau_0",
        "single gases scatter by 0.8 % about a mean that is nearly 2 % off, and 3 % is the limit",
    ),
    "incline": Sampling(
        (2, 4), (0.0, 6.0, 8.0), "s",
        "steady after 2.5 s; the exponent scatters by 0.14 between runs of 5 s, and the band is 0.1 wide on "
        "each side",
    ),
    "silo": Sampling(
        (0, 1), None, "s",
        "each seed gives one fit of four openings; the number of grains that leave, some hundred to two "
        "thousand, scatters little",
    ),
    "collapse": Sampling(
        (0, 1), None, "s",
        "the foot is a mean over twelve sectors of one heap; between seeds it scatters by some per cent",
    ),
    "channel_collapse": Sampling(
        (0, 1), None, "s",
        "the foot is the outermost grain of one heap; between seeds it scatters by some per cent",
    ),
    "gravel_heap": Sampling(
        (0, 1), None, "s",
        "the angle is that of all sides of one heap; between seeds it scatters by some tenths of a degree",
    ),
    "drum": Sampling(
        (0, 1), None, "s",
        "the angle is a mean over half a turn or more; between seeds it scatters by some tenths of a degree",
    ),
    "plane_shear": Sampling(
        (0, 1), None, "s",
        "friction is a mean over some 10 to 50 shear strains, and scatters by some per cent between seeds",
    ),
    "split_bottom": Sampling(
        (0, 1), None, "s",
        "each run gives one fit, to the mean of a sixth of a turn; between seeds its centre scatters by "
        "a part of a diameter",
    ),
    "transport": Sampling(
        (1, 2), (2.0, 5.0, 8.0), "s",
        "rates scatter by 5 to 10 % between runs, a tenth of what separates them from a limit; a spread "
        "pooled over the slopes has twelve degrees of freedom",
    ),
    "equilibrium": Sampling(
        (2, 4), None, "s",
        "the largest difference lies near its limit, and the error of the friction angle of one dry flow "
        "is that of all slopes",
    ),
    "frey/published": Sampling(
        (1, 2), (0.0, 25.0, 125.0), "s",
        "nearly at rest: whether the bed stops after 10 or 60 s, the rate is a fraction of that measured",
    ),
    "frey/peer": Sampling(
        (2, 4), (0.0, 55.0, 125.0), "s",
        "while in motion the rate is correlated over 2 s, so 40 s leave a third of its scatter or less, but "
        "the flow may stop for longer than a run: several runs show how often",
    ),
    "maurin": Sampling(
        (1, 2), (0.0, 45.0, 75.0), "s",
        "the water finds its speed in 15 s; the rate of a cell of 12 d by 12 d is then steady within some "
        "per cent over 30 s, and 10 % is the limit",
    ),
    "frey/walls": Sampling(
        (0, 2), (0.0, 0.0, 65.0), "s",
        "other distances between the walls, to bracket that of the measured rate",
    ),
}  # fmt: skip
# The other parts repeat to the last bit: nothing in them is drawn at random.
CLOSED: Mapping[str, str] = {
    "water_alone": "a column of water, solved for its steady state",
    "river": "a row of columns of water; with grains, the seeds that were registered",
    "river_pressure": "a row of columns of water alone",
    "river_pressure_grains": "a row of columns, and a lattice of grains in it",
    "river_debris": "debris flows in a row of columns, with the seeds that were registered",
    "terminal_velocity": "one grain",
    "suspension": "a lattice of grains that do not touch",
    "impact": "one grain, at twenty given phases of the time step",
    "hertz": "one grain or two, at twenty given phases of the time step",
    "hertz_oblique": "one grain",
    "hertz_pairs": "two grains",
    "rebound": "one grain",
    "rolling": "one grain",
}


def sampling_lines(level: Level) -> list[dict[str, str]]:
    """Runs of each comparison at one level, in words."""
    if level is Level.QUICK:
        return []
    return [
        {
            "name": name,
            "runs": f"{one.runs[level is Level.FULL]}",
            "length": "as in the case file" if one.time is None else f"{one.length(level):g} {one.unit}",
            "why": one.why,
        }
        for name, one in SAMPLING.items()
        if one.runs[level is Level.FULL]
    ]


def sampling_table() -> str:
    """Runs of each comparison at the standard and at the full level, in Markdown."""
    lines = ["| comparison | runs for each seed, length of a run | full level | why |", "|---|---|---|---|"]
    standard = {one["name"]: one for one in sampling_lines(Level.STANDARD)}
    for one in sampling_lines(Level.FULL):
        first = standard.get(one["name"])
        cells = ["none" if each is None else f"{each['runs']}, {each['length']}" for each in (first, one)]
        lines.append("| " + " | ".join([one["name"], *cells, one["why"]]) + " |")
    return "\n".join(lines)
