"""How long a run will take: its steps, and the wall time of a step as such runs took on this machine."""

import math
from dataclasses import dataclass, replace
from statistics import median

from ryusa import run_times
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import bed_thickness
from ryusa.casefile.column.checks import SPARE
from ryusa.casefile.column.schema import CELL
from ryusa.casefile.contact.values import timing
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.record.schema import RecordSection, StopSection
from ryusa.casefile.row.values import row_plan, segments_of, stream, water_alone
from ryusa.laws.families import ContactTiming, Pressure

# The rule of thumb, on one core of an ordinary machine; within a factor 1.5 for saltation, box, heap and
# dense flows:
SECONDS_PER_RUN = 0.3  # to begin and to end
SECONDS_PER_STEP = 4.0e-7  # of any step
SECONDS_PER_GRAIN = 6.5e-8  # and per grain in it, in a plane scene
SECONDS_PER_GRAIN_3D = 1.3e-7
SECONDS_PER_GRAIN_IN_WATER = 6.0e-8  # on top
# Within a factor 1.8 for columns of 36 to 600 cells, which add 0.15 us each:
SECONDS_PER_EXCHANGE = 2.0e-4  # of momentum with a column
SECONDS_PER_EXCHANGE_IN_ROW = 1.0e-3  # with a row of 1 to 8 segments, within a factor 1.4
SECONDS_PER_GRAIN_EXCHANGED = 2.5e-7
SECONDS_PER_ROW_CELL = 1.5e-7  # of a cell of a row of columns and step of the water
OF_PRESSURE = 2.7  # times that with a pressure of its own (benchmarks/row_pressure.py)
WITHIN = 2.0  # factor within which the rule of thumb holds on a machine that does nothing else
# From the 639 runs of the standard level of the paper's ledger, seeds 1 to 3, two at a time on two cores of
# an AMD EPYC: 43 core minutes in all, estimated as 46; for one set-up the estimate is right within a factor
# of 1.6. The shares are shares of steps and do not depend on the machine.
SHARE_TO_REST = 0.63  # share of the maximum time that a run takes which may end at rest
SHARE_TO_HOPS = 0.80  # the same for a run which may end after a number of hops
ROLLING = 1.8  # cost with rolling friction over that without, in the same heap; 1.5 to 2.1
SECONDS_PER_SALTATION = 0.15  # simulated, where only a number of saltations ends the run
SECONDS_TO_REST = 10.0  # simulated, where only rest ends it
HOUR = 3600.0  # [s]
LEAST = 3.0  # s of stepping from which a run tells how fast its kind is


@dataclass(frozen=True)
class WallTime:
    """Wall time that a run is expected to take, without compiling.

    Attributes
    ----------
    stepping : time to step and to record [s].
    low, high : shortest and longest time that such runs took over this one [-].
    runs : runs of the kind on this machine that it follows from; 0 where it is the rule of thumb.
    kind : what counts as the same kind, in words.
    """

    stepping: float
    low: float
    high: float
    runs: int
    kind: str

    @property
    def seconds(self) -> float:
        """Time with what it takes to begin and to end [s]."""
        return SECONDS_PER_RUN + self.stepping

    @property
    def basis(self) -> str:
        """What it follows from, in few words."""
        runs = f"{self.runs} run{'s' if self.runs > 1 else ''}"
        return f"from {runs} of this kind on this machine" if self.runs else "by a rule of thumb"

    @property
    def origin(self) -> str:
        """What it follows from, what counts as the same kind, and how far it may be wrong."""
        if not self.runs:
            return (
                f"{self.basis}, within a factor of {WITHIN:g} where nothing else runs: no run of this kind "
                f"yet on this machine ({self.kind})"
            )
        taken = f", which took {self.low:.2g} to {self.high:.2g} of it" if self.runs > 1 else ""
        return f"{self.basis} ({self.kind}){taken}"

    def __str__(self) -> str:
        unit, of = (
            (HOUR, "h") if self.seconds > HOUR else (60.0, "min") if self.seconds >= 120.0 else (1.0, "s")
        )
        return f"{self.seconds / unit:.3g} {of}"


def time_expected(stop: StopSection, record: RecordSection) -> tuple[float, str]:
    """Simulated time at most [s], and where that number comes from."""
    found: list[tuple[float, str]] = []
    if stop.time is not None:
        sooner = ", or sooner: when stop.precision is reached" if stop.precision else ""
        found.append((stop.time, f"stop.time{sooner}"))
    if stop.saltations is not None:
        guess = record.settle + stop.saltations * SECONDS_PER_SALTATION
        found.append((guess, f"guess: settle + {SECONDS_PER_SALTATION} s per saltation"))
    if not found:
        found.append((SECONDS_TO_REST, f"guess: at rest within {SECONDS_TO_REST:g} s"))
    return min(found)


def steps_expected(stop: StopSection, record: RecordSection, derived: Derived) -> int:
    """Steps of the run at most, or by guess where only events end it."""
    return math.ceil(time_expected(stop, record)[0] / derived.dt)


def kind_of_run(case: Case, threads: int = 1, engine: str = "cpu") -> str:
    """Kind of a run, in words: runs of one kind take alike over the rule of thumb."""
    profile = None if case.water is None else case.water.profile
    water = "dry" if profile is None else f"{profile} water"
    if case.row is not None:
        water = "water alone, row of columns" if water_alone(case) else "row of columns"
    elif profile == "column":
        water = "column of water"
    own = case.row is not None and case.row.pressure != Pressure.HYDROSTATIC.word
    exact = "within steps" if timing(case) is ContactTiming.EXACT else "at steps"
    words = ["plane" if case.motion.plane else "3D", water, *(["fed"] if case.feeds else [])]
    words += [] if water_alone(case) else [f"{case.contact.law} contacts that begin {exact}"]
    words += [] if case.rolling.model == "none" else ["rolling friction"]
    words += ["a pressure of its own"] if own else []
    words += ["pressed walls"] if any(one.servo is not None for one in case.walls) else []
    return ", ".join([*words, engine, f"{threads} thread{'s' if threads > 1 else ''}"])


def seconds_per_step(case: Case, derived: Derived) -> float:
    """Wall time of a step by the rule of thumb [s], one core."""
    per_grain = SECONDS_PER_GRAIN if case.motion.plane else SECONDS_PER_GRAIN_3D
    if case.water is not None:
        per_grain += SECONDS_PER_GRAIN_IN_WATER
    steps = 1 if water_alone(case) or case.water is None else case.column.interval
    per_step = SECONDS_PER_STEP + per_grain * derived.n_sphere
    per_cell = SECONDS_PER_ROW_CELL
    if case.row is not None and case.row.pressure != Pressure.HYDROSTATIC.word:
        per_cell *= OF_PRESSURE
    per_step += per_cell * cells_of_row(case) / steps
    if case.water is not None and case.water.profile == "column" and not water_alone(case):
        exchange = SECONDS_PER_EXCHANGE if case.row is None else SECONDS_PER_EXCHANGE_IN_ROW
        per_step += (exchange + SECONDS_PER_GRAIN_EXCHANGED * derived.n_sphere) / steps
    return per_step * (1.0 if case.rolling.model == "none" else ROLLING)


def wall_time_by_rule(case: Case, derived: Derived) -> WallTime:
    """Wall time by the rule of thumb on one core: the same on every machine."""
    stop = case.stop
    share = SHARE_TO_HOPS if stop.saltations is not None else SHARE_TO_REST if stop.rest is not None else 1.0
    seconds = share * steps_expected(case.stop, case.record, derived) * seconds_per_step(case, derived)
    return WallTime(seconds, 1.0 / WITHIN, WITHIN, 0, kind_of_run(case))


def wall_time(case: Case, derived: Derived, *, threads: int = 1, engine: str = "cpu") -> WallTime:
    """Wall time that a run is expected to take on this machine.

    Parameters
    ----------
    case, derived : the case, and what follows from it.
    threads, engine : with which it is run.

    Notes
    -----
    The rule of thumb times the median, over the latest runs of the kind on this machine, of what they took
    over it; without such runs the rule of thumb, shared among the threads.
    """
    by_rule, kind = wall_time_by_rule(case, derived), kind_of_run(case, threads, engine)
    ratios = run_times.ratios_of(kind)
    if not ratios:
        return WallTime(by_rule.stepping / threads, by_rule.low, by_rule.high, 0, kind)
    usual = median(ratios)
    return WallTime(usual * by_rule.stepping, min(ratios) / usual, max(ratios) / usual, len(ratios), kind)


def keep_wall_time(
    case: Case, derived: Derived, steps: int, stepping: float, grains: float, *, threads: int, engine: str
) -> None:
    """Keep how long a complete run took, for the estimates of others of its kind.

    Parameters
    ----------
    steps : that it made.
    stepping : wall time of these and of the recording, without compiling [s]; of less than `LEAST` nothing
        is kept.
    grains : present on average, spheres of clumps counted one by one: a run that is fed may end long before
        it has as many as the case makes room for.
    """
    by_rule = steps * seconds_per_step(case, replace(derived, n_sphere=round(grains)))
    if stepping >= LEAST and by_rule > 0.0:
        run_times.add(kind_of_run(case, threads, engine), (stepping - SECONDS_PER_RUN) / by_rule)


def cells_of_row(case: Case) -> int:
    """Cells of a row of columns; 0 where there is none. Over a bed it is an estimate: grains decide."""
    if case.row is None:
        return 0
    if water_alone(case) or stream(case):
        plan = row_plan(case)
        return plan.n * plan.n_cell
    bed, depth = bed_thickness(case), 0.0 if case.water is None else case.water.depth or 0.0
    height = SPARE * depth + (bed if math.isfinite(bed) else 0.0)
    return segments_of(case)[2] * math.ceil(height / (case.column.cell or CELL * reference_diameter(case)))
