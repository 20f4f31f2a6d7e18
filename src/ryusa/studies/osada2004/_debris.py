"""What the experiments about Ito's debris flow (fig17, fig17-free, fig18) share: runs, choices, measures."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ryusa.laws.collision import damping_ratio, restitution_no_tension
from ryusa.measure import Profiles, Tracks, collisions, companions, contact_times, profiles, rods, tracks
from ryusa.measure.collisions import Partner
from ryusa.measure.entrainment import SPEED as MOVES
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Trial, over_seeds, pool

CASE = "fig17"
LOCKED, FREE = "locked", "free"
AMOUNT = "layers of grains put in"
WATER = "water and bed"
START = "grains begin"
AS_SHIPPED = "as shipped"
OTHERS: dict[str, dict[str, str]] = {
    "parabolic mixing length": {
        "water.column": '{ start = "rest", bed = "rough", mixing_length = "parabolic" }'
    },
    "no wall law, drag of the fixed grains": {
        "water.zero": "1.635 mm",
        "water.column": '{ start = "rest", bed = "moving", mixing_length = "Li-Sawamoto", packed = 0.5 }',
    },
    "eddies in pores, k_f 0.16": {"water.column.pore_eddies": "0.16"},
    "roughness 0.5 d": {"water.roughness": "1.09 mm"},
    "roughness 2 d": {"water.roughness": "4.36 mm", "water.column.cell": "0.436 mm"},
    "buoyancy by weight": {"water.buoyancy": "weight"},
    "hindrance Richardson-Zaki": {"water.hindrance": "Richardson-Zaki"},
    "bed of random height": {"build.bed": "random"},
    "sizes within 10 %": {"grains.spread": "0.1"},
}
STARTS = {"on their way": "1.8 m/s", "at rest": "0 m/s"}
SHIPPED = {PHI: "30 deg", SLIP: "spring", AMOUNT: "5", WATER: AS_SHIPPED, START: "on their way"}
KEYS = {PHI: "contact.friction_angle", SLIP: "contact.slip", AMOUNT: "build.layers"}
SETTLED = {
    "d": "0.218 cm",
    "tau_star": "1.08",
    "depth": "1.48 cm",
    "slope": "15.2 deg",
    "k_n, k_s": "200, 15 N/cm",
    "eta_n, eta_s": "0.001, 0.0001 N s/cm",
    "k_s/k_n": "0.075",
    "water": "column, rough bed, Li-Sawamoto",
    "window": "1 to 2 s",
}
UPPER = 2.0 / 3.0  # of the depth: near the surface is what lies above
LAYER = 0.5  # of profiles, in diameters
NEAR_BED = 1.0  # height above the mean crest of the fixed grains, in diameters, up to which is near the bed
PARTNERS: dict[str, Partner] = {"all contacts": "all", "two free grains": "free", "fixed grain": "bed"}
SHOWN = 0.2  # of the window, drawn as tracks [s]


@dataclass(frozen=True)
class DebrisContacts:
    """Contacts with one kind of partner in a run."""

    n: int
    time: float  # mean duration [s]; nan where there are none
    alone: float  # of those that no other contact of the two grains disturbed [s]
    e: float  # restitution of those alone, mean [-]


@dataclass(frozen=True)
class Debris:
    """One run, after it has settled.

    Attributes
    ----------
    profile : means over height, half a diameter a layer, from the mean crest of the fixed grains.
    water : heights above that crest [m] and mean speed of the water there [m/s].
    depth : surface of the water above that crest [m].
    thrown : highest less lowest centre of a grain that begins in the upper third, mean, in diameters.
    rms_z : root mean square of the vertical speed of all grains [m/s].
    rest : share of grains and frames slower than 0.1 sqrt(g d) [-].
    contacts : by name of the partner, `PARTNERS`.
    closed : contact time [s] and restitution [-] by the closed forms, for a free and a fixed partner.
    companions : correlation of the speeds of grains that touch [-].
    rods, null : movers in rods, and the same for shuffled ways [-].
    path : ways of two grains, one that begins near the bed and one near the surface.
    """

    profile: Profiles
    water: tuple[Floats, Floats]
    depth: float
    thrown: float
    rms_z: float
    rest: float
    contacts: Mapping[str, DebrisContacts]
    closed: Mapping[str, tuple[float, float]]
    companions: float
    rods: float
    null: float
    path: Tracks

    @property
    def near_surface(self) -> float:
        """Concentration in the upper third of the depth [-]."""
        return self._phi(UPPER * self.depth, self.depth)

    @property
    def topmost(self) -> float:
        """Concentration in the uppermost diameter of the depth [-]."""
        return self._phi(self.depth - self.profile.d, self.depth)

    def _phi(self, low: float, high: float) -> float:
        """Concentration between two heights [m]."""
        return float(np.nan_to_num(self.profile.phi.value) @ self._inside(low, high)) / (high - low)

    @property
    def near_bed(self) -> float:
        """Grain speed up to one diameter above the bed [m/s]."""
        phi = np.nan_to_num(self.profile.phi.value) * self._inside(0.0, NEAR_BED * self.profile.d)
        return float(phi @ np.nan_to_num(self.profile.v_x.value)) / float(phi.sum())

    def _inside(self, low: float, high: float) -> Floats:
        """How much of every layer lies between two heights [m]."""
        half = 0.5 * self.profile.thickness
        z = self.profile.z
        return np.maximum(np.minimum(z + half, high) - np.maximum(z - half, low), 0.0)

    @property
    def speed(self) -> float:
        """Speed of all grains, mean over time [m/s]."""
        return float(self.profile.speed.mean())

    @property
    def q(self) -> float:
        """Flux of grains over the whole depth per width [m2/s]."""
        return float(self.profile.q.mean())

    @property
    def steep(self) -> float:
        """Vertical speed over speed along the bed [-]: how steep the ways are."""
        return self.rms_z / self.speed if self.speed > 0.0 else math.nan

    @property
    def drift(self) -> float:
        """Speed in the second half of the window over that in the first [-]."""
        half = len(self.profile.speed) // 2
        return float(self.profile.speed[half:].mean() / self.profile.speed[:half].mean())


Numbers = Callable[[Sequence[Debris]], list[float]]  # of the runs of one setting: one per seed


def each(value: Callable[[Debris], float]) -> Numbers:
    """Take a number from every run."""
    return lambda found: [value(one) for one in found]


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices for locked grains, the shipped one first; one choice is changed at a time."""
    changes = plan.pick(
        (),
        (
            (AMOUNT, ("3", "4", "6")),
            (PHI, ("20 deg",)),
            (SLIP, ("total",)),
            (WATER, ("parabolic mixing length", "no wall law, drag of the fixed grains")),
            (START, ("at rest",)),
        ),
        (
            (AMOUNT, ("2", "3", "4", "6", "7")),
            (PHI, ("10 deg", "20 deg", "40 deg")),
            (SLIP, ("total", "spring-drop")),
            (WATER, tuple(OTHERS)),
            (START, ("at rest",)),
        ),
    )
    return [SHIPPED, *({**SHIPPED, name: value} for name, values in changes for value in values)]


def run(chosen: Mapping[str, str], seed: int, changed: Mapping[str, str] | None = None) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    keys = {KEYS[name]: value for name, value in chosen.items() if name in KEYS and SHIPPED[name] != value}
    if chosen[START] != SHIPPED[START]:
        keys["build.speed"] = STARTS[chosen[START]]
    return paper_run(CASE, {**keys, **OTHERS.get(chosen[WATER], {}), **(changed or {})}, seed)


def trials(
    found: Found,
    plan: Plan,
    part: str,
    numbers: Numbers,
    band: Band,
    sets: Sequence[Mapping[str, str]],
) -> list[Trial]:
    """One part of a claim under every setting; the spread between seeds is pooled over them."""
    groups = [numbers([found[run(one, seed)] for seed in plan.seeds]) for one in sets]
    spread = pool(groups)
    return [
        Trial(part, dict(one), over_seeds(values, band.unit, spread), band)
        for one, values in zip(sets, groups, strict=True)
    ]


def mean(found: Found, plan: Plan, value: Callable[[Debris], float], chosen: Mapping[str, str]) -> float:
    """Mean over seeds of a number that decides nothing."""
    return float(np.mean([value(found[run(chosen, seed)]) for seed in plan.seeds]))


@lru_cache(maxsize=2)
def measure(results: Results, one: CaseRun) -> Debris:
    """Everything the three experiments ask of one run."""
    del one
    profile = profiles(results, layer=LAYER, above="mean crest", bed=True)
    begin, end = float(profile.t[0]), float(profile.t[-1])
    rows = np.searchsorted(np.asarray(results.frames.t), (begin, end))
    x = np.asarray(results.frames.x[rows[0] : rows[1] + 1], dtype=np.float64)
    v = np.asarray(results.frames.v[rows[0] : rows[1] + 1], dtype=np.float64)
    water = results.water
    assert water is not None
    late = water.t >= begin
    depth = float(water.z_surface[late].mean()) - profile.origin
    high = x[0, :, 2] - profile.origin > UPPER * depth
    d, g = profile.d, float(np.linalg.norm(results.scene.gravity))
    still = np.linalg.norm(v, axis=2) < MOVES * math.sqrt(g * d)
    found = rods(results)
    order = np.argsort(x[0, :, 2], kind="stable")
    return Debris(
        profile=profile,
        water=(water.z - profile.origin, water.u[late].mean(axis=0)),
        depth=depth,
        thrown=float(np.ptp(x[:, high, 2], axis=0).mean()) / d if high.any() else math.nan,
        rms_z=float(np.sqrt((v[:, :, 2] ** 2).mean())),
        rest=float(still.mean()),
        contacts={name: _contacts(results, partner) for name, partner in PARTNERS.items()},
        closed=_closed(results),
        companions=companions(results),
        rods=found.share,
        null=found.null_share,
        path=_within(tracks(results, [int(order[0]), int(order[-1])], begin, begin + SHOWN)),
    )


def _contacts(results: Results, partner: Partner) -> DebrisContacts:
    found = collisions(results, partner)
    if not len(found.events):
        return DebrisContacts(0, math.nan, math.nan, math.nan)
    averages = found.averages
    return DebrisContacts(
        len(found.events),
        averages["duration"].value,
        averages["duration_alone"].value,
        averages["restitution_alone"].value,
    )


def _closed(results: Results) -> dict[str, tuple[float, float]]:
    """Contact time and restitution of the paper's constants, by the mass that the dashpot acts on."""
    scene = results.scene
    whole = float(scene.m[0] + scene.m_added[0])
    masses = {"two free grains": (1, 0.5 * whole), "fixed grain": (None, whole)}
    law = scene.contact
    return {
        name: (
            contact_times(scene, 0, other).damped,
            restitution_no_tension(damping_ratio(law.eta_n, law.k_n, mass)),
        )
        for name, (other, mass) in masses.items()
    }


def _within(path: Tracks) -> Tracks:
    """Shift ways by whole periods, so that all start within the first one."""
    return replace(path, x=path.x - np.floor(path.x[:1] / path.period) * path.period)


def row(one: Debris) -> dict[str, object]:
    """Numbers of one run for the CSV table."""
    return {
        "n_per_depth": float(one.profile.volume.mean()) / one.depth,
        "phi_near_surface": one.near_surface,
        "phi_topmost": one.topmost,
        "speed_m_per_s": one.speed,
        "speed_near_bed_m_per_s": one.near_bed,
        "q_m2_per_s": one.q,
        "drift": one.drift,
        "thrown_d": one.thrown,
        "rms_z_m_per_s": one.rms_z,
        "at_rest": one.rest,
        "companions": one.companions,
        "rods": one.rods,
        "rods_null": one.null,
        **{
            f"{what}_{name.replace(' ', '_')}": getattr(contacts, what)
            for name, contacts in one.contacts.items()
            for what in ("n", "time", "alone", "e")
        },
    }
