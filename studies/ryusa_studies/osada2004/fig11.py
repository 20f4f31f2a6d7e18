"""Fig. 11: the band 0.001 < overlap/d < 0.01 laid over the contact times of Fig. 4."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import collision_time
from ryusa.measure.stability import BAND
from ryusa.study import Band, Finding, Trial
from ryusa.units import quantity
from ryusa_studies.osada2004 import _drops, fig08
from ryusa_studies.osada2004._drops import DropRun, Setup
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan
from ryusa_studies.osada2004.figures import QuotedPoint, drop_chart

FIGURE = "fig11"
TITLE = "The stable band over the contact times"
CLAIMS = ("fig11",)
SPEED = "impact speed (fig11)"
TIME = "0.0001 s"  # the paper's contact time
INSIDE = Band(*BAND, "-", f"{BAND[0]:g} < overlap/d < {BAND[1]:g}, the band given by the paper")


def speeds(plan: Plan) -> tuple[str, ...]:
    """Impact speeds tried, the shipped one first."""
    more = ("0.03 m/s", "0.05 m/s", "0.1 m/s", "0.2 m/s", "0.5 m/s", "0.6 m/s", "0.7 m/s", "0.8 m/s", "1 m/s")
    return (_drops.SPEED, *plan.pick((), more))


def setups(plan: Plan) -> list[Setup]:
    """A contact of 0.0001 s at every speed, and the chart of fig8."""
    return [Setup(time=TIME, speed=speed) for speed in speeds(plan)] + fig08.chart(plan)


tasks, measure, rows = _drops.tasks_of(setups), _drops.measure, _drops.rows_of(setups)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """A contact of 0.0001 s lies in the band."""
    trials: list[Trial] = []
    for speed in speeds(plan):
        drop: DropRun = found[Setup(time=TIME, speed=speed).task]
        part = f"overlap/d of a contact of {TIME}, d = 0.2 cm"
        trials.append(Trial(part, {SPEED: speed}, drop.over_phases(drop.overlap, "-"), INSIDE))
    base, v = trials[0].found.value, quantity(_drops.SPEED, "m/s")
    edges = [quantity(TIME, "s") * level / base for level in BAND]
    at_fig8 = 0.01 * np.sqrt(Setup(k_n=fig08.K_N).stiffness / Setup(time=TIME).stiffness)
    return (
        finding(
            "fig11",
            trials,
            also=(
                f"at the speed that fig8 requires, with overlap/d 0.01 at 100 N/cm, it is {at_fig8:.4f}, "
                f"{'inside' if BAND[0] < at_fig8 < BAND[1] else 'outside'} the band",
            ),
            first=edges[0],
            last=edges[1],
            least=v * BAND[0] / base,
            most=v * BAND[1] / base,
        ),
    )


def band(sizes: Sequence[str], springs: Sequence[float], speed: str, found: Found) -> figures.StiffnessBand:
    """Edges of the band as runs have it: k_n and time where overlap/d is 0.01 and 0.001, between two runs."""
    edges: list[tuple[float, float, float, float]] = []
    for d in sizes:
        drops: list[DropRun] = [found[Setup(d=d, k_n=k_n, speed=speed).task] for k_n in springs]
        x = np.log([np.median(one.overlap) for one in drops][::-1])
        k, t = (
            np.log(values[::-1])
            for values in ([one.k_n for one in drops], [np.median(one.time) for one in drops])
        )
        soft, stiff = np.log(BAND[1]), np.log(BAND[0])
        edges.append(tuple(np.exp([np.interp(at, x, y) for at in (soft, stiff) for y in (k, t)])))
    k_soft, t_soft, k_stiff, t_stiff = np.array(edges).T
    return figures.StiffnessBand((f"{BAND[1]:g}", f"{BAND[0]:g}"), k_soft, t_soft, k_stiff, t_stiff)


def times(
    sizes: Sequence[str], springs: Sequence[float], speed: str, found: Found
) -> tuple[list[figures.StiffnessCurve], list[figures.StiffnessPoints]]:
    """Lines of Eq. (8) and contact times of runs, by diameter."""
    k = np.array(springs) * 100.0
    lines = [
        figures.StiffnessCurve(d, k, np.array([collision_time(Setup(d=d).m, s) for s in k])) for d in sizes
    ]
    runs = []
    for d in sizes:
        drops = [found[Setup(d=d, k_n=s, speed=speed).task] for s in springs]
        runs.append(
            figures.StiffnessPoints(
                f"run, d = {d}", k, np.array([np.median(one.time) for one in drops]), 0 * k
            )
        )
    return lines, runs


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact times with the band across them."""
    springs = fig08.stiffnesses(plan)
    lines, runs = times(_drops.SIZES, springs, _drops.SPEED, found)
    quote = QuotedPoint(Setup(time=TIME).stiffness, quantity(TIME, "s"), _drops.DIAMETER)
    words = ("Eq. (8)", f"e = 0.7, impact at {_drops.SPEED}; shaded: overlap/d 0.001 to 0.01")
    region = band(_drops.SIZES, springs, _drops.SPEED, found)
    return {"fig11": drop_chart("time", lines, runs, quoted=[quote], band=region, words=words)}
