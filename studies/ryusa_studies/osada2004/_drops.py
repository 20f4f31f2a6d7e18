"""What the experiments about one contact share: the drop, its phases of first touch, what is kept of it."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.laws.collision import (
    collision_time,
    damping_ratio,
    omega_natural,
    overlap_max,
    shortest_contact,
    stiffness_for_time,
    zeta_for_restitution,
)
from ryusa.laws.contact import damping
from ryusa.laws.drag import volume
from ryusa.measure import collisions, contact_times
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Band, Interval, over_range
from ryusa.units import quantity
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

CASE = "drop"
COPIES = 20  # phases of first touch
DIAMETER, SPEED, DENSITY = "0.2 cm", "0.3 m/s", "2650 kg/m3"  # as the case ships
NO_TENSION, TENSION = "no tension", "tension"
EXACT, AT_STEPS = "exact", "at steps"
STEPS = 10.0  # of the case file
FARTHEST = 0.1  # diameters that a grain may move in a step, on springs so soft that a contact is long
SIZES = ("0.05 cm", "0.1 cm", "0.2 cm", "0.5 cm", "1 cm")  # of fig4, fig8, fig11
LARGE = ("5 cm", "10 cm", "20 cm", "50 cm", "100 cm")  # of fig12
A_3 = math.pi / 6.0
FALL = 8.0  # diameters that a grain which passes may fall on; the world ends ten below
LATE = 4.0  # contact times after which a grain that still touches counts as one that stays
ABOUT = "within 10 %, the accuracy of reading a chart whose axes span decades"

_SHIPPED = {  # what the case file says already
    "grains.diameter": DIAMETER,
    "grains.density": DENSITY,
    "contact.restitution": "0.7",
    "contact.parting": NO_TENSION,
    "contact.timing": EXACT,
    "motion.gravity": "9.8 m/s2",
    "build.partner": "fixed",
    "build.speed": SPEED,
}


@dataclass(frozen=True)
class DropRun:
    """A drop; arrays have one entry per copy whose contact ended (fewer than `copies`: it stays)."""

    d: float  # [m]
    k_n: float  # [N/m]
    eq_8: float  # Eq. (8) with the mass of the pair [s]
    copies: int
    time: Floats  # first touch to the end of the normal force [s]
    overlap: Floats  # largest overlap over d [-]
    speed: Floats  # closing speed at first touch [m/s]
    e: Floats  # parting over closing speed [-]
    passed: int = 0  # copies whose centre ends below that of a fixed partner

    @property
    def parts(self) -> bool:
        """Whether every copy came off again."""
        return len(self.time) == self.copies

    def over_phases(self, values: Floats, unit: str) -> Interval:
        """Middle and range of one number per copy; no number where a grain stays."""
        return over_range(list(values) if self.parts else [math.nan], unit, f"{COPIES} phases of first touch")


@dataclass(frozen=True)
class Setup:
    """One drop; texts as a case file takes them.

    Attributes
    ----------
    k_n : stiffness [N/cm]; nan where `time` is given.
    time : asked of Eq. (8) with the dry mass, instead of a stiffness.
    steps : steps in the shortest contact of this case, more where a grain would move beyond FARTHEST in one.
    timing : when a contact begins and ends.
    one_dashpot : a free partner keeps the dashpot that gives e on a fixed one.
    """

    d: str = DIAMETER
    k_n: float = 100.0
    time: str = ""
    speed: str = SPEED
    e: float = 0.7
    parting: str = NO_TENSION
    partner: str = "fixed"
    weight: bool = True
    density: str = DENSITY
    steps: float = STEPS
    timing: str = EXACT
    one_dashpot: bool = False

    @property
    def m(self) -> float:
        """Mass of the grain [kg]."""
        return quantity(self.density, "kg/m3") * volume(quantity(self.d, "m"), A_3)

    @property
    def stiffness(self) -> float:
        """k_n [N/m]."""
        if self.time:
            return stiffness_for_time(quantity(self.time, "s"), self.m, 0.0, False)
        return 100.0 * self.k_n

    @property
    def zeta(self) -> float:
        """Damping ratio that gives e [-]."""
        return zeta_for_restitution(self.e, self.parting == TENSION)

    @property
    def shortest(self) -> float:
        """Shortest contact that the case reader sees [s]; the time step is a part of it."""
        free = self.partner == "free"
        m_eff, zeta = self.m / 2.0 if free else self.m, self.zeta
        if self.one_dashpot:
            zeta = damping_ratio(damping(zeta, self.stiffness, self.m), self.stiffness, m_eff)
        return shortest_contact(m_eff, self.stiffness, zeta, self.parting == TENSION)

    @property
    def deepest(self) -> float:
        """Largest overlap over d on a fixed grain that the spring alone allows [-], weight left out."""
        d, speed = quantity(self.d, "m"), quantity(self.speed, "m/s")
        return overlap_max(speed, self.m, self.stiffness, self.zeta) / d

    @property
    def heaviness(self) -> float:
        """Weight against impact, g/(speed omega_0) [-]."""
        return 9.8 / (quantity(self.speed, "m/s") * omega_natural(self.stiffness, self.m))

    @property
    def may_pass(self) -> bool:
        """Whether the spring alone lets the grain half a diameter into its partner, or more."""
        d, g = quantity(self.d, "m"), 9.8 if self.weight else 0.0
        return self.deepest + 2.0 * g * self.m / (self.stiffness * d) >= 0.5

    @property
    def fastest(self) -> float:
        """Speed that the step must follow [m/s]: of the impact, or after the fall of a grain that passes."""
        speed, g = quantity(self.speed, "m/s"), 9.8 if self.weight else 0.0
        return math.sqrt(speed**2 + 2.0 * g * FALL * quantity(self.d, "m")) if self.may_pass else speed

    @property
    def stop(self) -> float:
        """End of the run [s]: late for a contact, but a grain that passes is still in the world."""
        late = LATE * collision_time(self.m, self.stiffness) + 2.0 * self.step
        fall = 2.0 * FALL * quantity(self.d, "m") / (quantity(self.speed, "m/s") + self.fastest)
        return min(late, fall) if self.may_pass else late

    @property
    def step(self) -> float:
        """Time step [s]."""
        in_contact = self.shortest / self.steps * (1.0 - 1.0e-9)  # the case reader compares with its own
        return min(in_contact, FARTHEST * quantity(self.d, "m") / self.fastest)

    @property
    def task(self) -> CaseRun:
        """The run."""
        dt = self.step
        way = quantity(self.speed, "m/s") * dt
        asked = {
            "grains.diameter": self.d,
            "grains.density": self.density,
            "contact.stiffness": f'{{ collision_time = "{self.time}" }}'
            if self.time
            else f"{self.k_n:g} N/cm",
            "contact.restitution": f"{self.e:g}",
            "contact.parting": self.parting,
            "contact.timing": self.timing,
            "motion.gravity": "9.8 m/s2" if self.weight else "0 m/s2",
            "build.partner": self.partner,
            "build.speed": self.speed,
            "build.height": f"{way:.6g} m",
            "build.height_step": f"{way / COPIES:.6g} m",
            "stop.time": f"{self.stop:.6g} s",
            "record.frames": f"{self.stop:.6g} s",
        }
        changed = {key: text for key, text in asked.items() if _SHIPPED.get(key) != text}
        if self.one_dashpot:
            changed.pop("contact.restitution", None)
            changed["contact.damping"] = f"{damping(self.zeta, self.stiffness, self.m):.9g} N s/m"
        if self.steps != STEPS or dt < self.shortest / STEPS * (1.0 - 2.0e-9):
            changed["time.step"] = f"{dt:.12g} s"
        return paper_run(CASE, changed)


def measure(run: Results, one: CaseRun) -> DropRun:
    """Keep the first contact of every copy."""
    del one
    copies = int(run.case["build"]["copies"])
    found, scene = collisions(run), run.scene
    first = [int(np.flatnonzero(found.events["i"] == i)[0]) for i in range(copies) if i in found.events["i"]]
    partner = copies if run.case["build"]["partner"] == "free" else None
    return DropRun(
        d=float(scene.d[0]),
        k_n=float(scene.contact.k_n),
        eq_8=contact_times(scene, 0, partner).eq_8,
        copies=copies,
        time=found.duration[first],
        overlap=found.overlap[first],
        speed=found.speed[first],
        e=found.restitution[first],
        passed=0 if partner is not None else _passed(run, copies),
    )


def _passed(run: Results, copies: int) -> int:
    """Copies that end below the centres of the fixed grains."""
    return int(np.sum(run.frames[-1].x[:copies, 2] < 0.5 * run.scene.d[:copies]))


def near(value: float, unit: str, says: str) -> Band:
    """Within 10 % of a number that the paper gives as "about"."""
    return Band(
        0.9 * value, 1.1 * value, unit, f"{says}: {0.9 * value:.4g} to {1.1 * value:.4g} {unit}, {ABOUT}"
    )


Setups = Callable[[Plan], Sequence[Setup]]


def tasks_of(setups: Setups) -> Callable[[Plan], Sequence[CaseRun]]:
    """The tasks of a part: one run per setup; there is no chance in them, so every seed gives the same."""
    return lambda plan: [one.task for one in setups(plan)]


def rows_of(setups: Setups) -> Callable[[Found, Plan], list[dict[str, object]]]:
    """The table of a part, one line per drop."""
    return lambda found, plan: _rows(setups(plan), found)


def _rows(setups: Sequence[Setup], found: Found) -> list[dict[str, object]]:
    """The middle of each drop over its phases, and the extremes of e."""
    lines: list[dict[str, object]] = []
    for one in setups:
        drop: DropRun = found[one.task]
        middle = {name: float(np.median(getattr(drop, name))) if drop.parts else math.nan for name in _KEPT}
        low, high = (float(drop.e.min()), float(drop.e.max())) if drop.parts else (math.nan, math.nan)
        lines.append(
            {
                "d_m": drop.d,
                "k_n_N_per_m": drop.k_n,
                "density": one.density,
                "asked_speed": one.speed,
                "asked_e": one.e,
                "parting": one.parting,
                "partner": one.partner,
                "weight": one.weight,
                "steps_per_contact": one.steps,
                "one_dashpot": one.one_dashpot,
                "eq_8_s": drop.eq_8,
                "time_s": middle["time"],
                "overlap_over_d": middle["overlap"],
                "speed_m_per_s": middle["speed"],
                "e": middle["e"],
                "e_lowest": low,
                "e_highest": high,
            }
        )
    return lines


_KEPT = ("time", "overlap", "speed", "e")
