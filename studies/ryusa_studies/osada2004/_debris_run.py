"""Numbers of one run of Ito's debris flow."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.collision import damping_ratio, restitution_for_zeta
from ryusa.measure import Profiles, Tracks, collisions, companions, contact_times, profiles, rods, tracks
from ryusa.measure.collisions import Partner
from ryusa.measure.entrainment import SPEED as MOVES
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.results.touching import contacts_per_grain
from ryusa_studies.osada2004._parts import CaseRun

LAYER = 0.5  # of profiles, in diameters
NEAR_BED = 1.0  # height above the mean crest of the fixed grains, in diameters, up to which is near the bed
NEAR_SURFACE = ("upper third", "upper quarter", "uppermost diameter")  # of the depth, the first as shipped
PARTNERS: dict[str, Partner] = {"all contacts": "all", "two free grains": "free", "fixed grain": "bed"}
SHOWN = 0.2  # of the window, drawn as tracks [s]


@dataclass(frozen=True)
class DebrisContacts:
    """Contacts with one kind of partner in a run."""

    n: int
    time: float  # mean duration [s]; nan where there are none
    alone: float  # of those that no other contact of the two grains disturbed [s]
    e: float  # restitution of those alone, mean [-]
    closing: float = math.nan  # closing speed at first touch, mean [m/s]
    overlap: float = math.nan  # largest overlap over d, mean [-]
    overlap_largest: float = math.nan  # of all contacts [-]


@dataclass(frozen=True)
class NearSurface:
    """A layer below the surface of the water.

    Attributes
    ----------
    phi : concentration [-].
    thrown : highest less lowest centre of a grain that begins there, mean, in diameters; nan without any.
    between : mean time between two collisions of a grain there [s]; without any, the length of the window.
    """

    phi: float
    thrown: float
    between: float


@dataclass(frozen=True)
class Debris:
    """One run, after it has settled.

    Attributes
    ----------
    profile : means over height, half a diameter a layer, from the mean crest of the fixed grains.
    water : heights above that crest [m] and mean speed of the water there [m/s].
    depth : surface of the water above that crest [m].
    near_surface : layers below it, by `NEAR_SURFACE`.
    thirds : concentration in the lower, middle and upper third of the depth [-].
    rms_z : root mean square of the vertical speed of all grains [m/s].
    rest : share of grains and frames slower than 0.1 sqrt(g d) [-].
    touching : share of grains and frames in contact [-].
    contacts : by name of the partner, `PARTNERS`.
    closed : contact time [s] and restitution [-] by the closed forms, for a free and a fixed partner.
    companions : correlation of the speeds of grains that touch [-].
    rods, null : movers in rods, and the same for shuffled ways; 0 where nothing moves [-].
    spin : what a twentieth of the spins exceeds [rad/s].
    path : ways of two grains, one that begins near the bed and one near the surface.
    """

    profile: Profiles
    water: tuple[Floats, Floats]
    depth: float
    near_surface: Mapping[str, NearSurface]
    thirds: tuple[float, float, float]
    rms_z: float
    rest: float
    touching: float
    contacts: Mapping[str, DebrisContacts]
    closed: Mapping[str, tuple[float, float]]
    companions: float
    rods: float
    null: float
    spin: float
    path: Tracks

    @property
    def near_bed(self) -> float:
        """Grain speed up to one diameter above the bed [m/s]."""
        phi = np.nan_to_num(self.profile.phi.value) * inside(self.profile, 0.0, NEAR_BED * self.profile.d)
        return float(phi @ np.nan_to_num(self.profile.v_x.value)) / float(phi.sum())

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

    @property
    def along(self) -> float:
        """Way of a grain along the bed during a contact, in diameters: u t/d."""
        return self.speed * self.contacts["all contacts"].time / self.profile.d


def inside(profile: Profiles, low: float, high: float) -> Floats:
    """How much of every layer of a profile lies between two heights [m]."""
    half = 0.5 * profile.thickness
    return np.maximum(np.minimum(profile.z + half, high) - np.maximum(profile.z - half, low), 0.0)


def concentration(profile: Profiles, low: float, high: float) -> float:
    """Concentration between two heights [m]."""
    return float(np.nan_to_num(profile.phi.value) @ inside(profile, low, high)) / (high - low)


@lru_cache(maxsize=2)
def measure(results: Results, one: CaseRun) -> Debris:
    """Everything the experiments about the debris flow ask of one run."""
    del one
    profile = profiles(results, layer=LAYER, above="mean crest", bed=True)
    begin, end = float(profile.t[0]), float(profile.t[-1])
    rows = np.searchsorted(np.asarray(results.frames.t), (begin, end))
    kept = slice(int(rows[0]), int(rows[1]) + 1)
    t = np.asarray(results.frames.t[kept], dtype=np.float64)
    x = np.asarray(results.frames.x[kept], dtype=np.float64)
    v = np.asarray(results.frames.v[kept], dtype=np.float64)
    spin = np.asarray(results.frames.omega[kept], dtype=np.float64)[:, :, 1]
    water = results.water
    assert water is not None
    late = water.t >= begin
    depth = float(water.z_surface[late].mean()) - profile.origin
    d, g = profile.d, float(np.linalg.norm(results.scene.gravity))
    still = np.linalg.norm(v, axis=2) < MOVES * math.sqrt(g * d)
    found = rods(results)
    order = np.argsort(x[0, :, 2], kind="stable")
    heights = x[:, :, 2] - profile.origin
    bounds = dict(zip(NEAR_SURFACE, (2.0 / 3.0 * depth, 0.75 * depth, depth - d), strict=True))
    met = _meetings(results, t, heights)
    cuts = np.linspace(0.0, depth, 4)
    lower, middle, upper = (concentration(profile, float(low), float(high)) for low, high in pairwise(cuts))
    return Debris(
        profile=profile,
        water=(water.z - profile.origin, water.u[late].mean(axis=0)),
        depth=depth,
        near_surface={
            name: _near_surface(profile, heights, met, end - begin, bound, depth)
            for name, bound in bounds.items()
        },
        thirds=(lower, middle, upper),
        rms_z=float(np.sqrt((v[:, :, 2] ** 2).mean())),
        rest=float(still.mean()),
        touching=float(np.mean([contacts_per_grain(here, results.scene) > 0 for here in x])),
        contacts={name: _contacts(results, partner) for name, partner in PARTNERS.items()},
        closed=_closed(results),
        companions=companions(results),
        rods=float(np.nan_to_num(found.share)),
        null=float(np.nan_to_num(found.null_share)),
        spin=float(np.quantile(np.abs(spin), 0.95)),
        path=_within(tracks(results, [int(order[0]), int(order[-1])], begin, begin + SHOWN)),
    )


def _meetings(results: Results, t: Floats, heights: Floats) -> Floats:
    """Height of a free grain at the first touch of each of its contacts [m]: two of each pair of free grains.

    Heights are those of the frame before, which moves a grain by a small part of its diameter.
    """
    events = collisions(results).events
    frame = np.clip(np.searchsorted(t, events["t_begin"], side="right") - 1, 0, len(t) - 1)
    free = events["j"] < results.scene.n_grain
    return np.concatenate([heights[frame, events["i"]], heights[frame[free], events["j"][free]]])


def _near_surface(
    profile: Profiles, heights: Floats, met: Floats, span: float, bound: float, depth: float
) -> NearSurface:
    """Numbers of the layer from a height up to the surface, and of what lies above it."""
    there: NDArray[np.bool_] = heights > bound
    first = there[0]
    collided = int((met > bound).sum())
    return NearSurface(
        phi=concentration(profile, bound, depth),
        thrown=float(np.ptp(heights[:, first], axis=0).mean()) / profile.d if first.any() else math.nan,
        between=float(there.mean(axis=0).sum()) * span / collided if collided else span,
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
        averages["closing_speed"].value,
        averages["overlap_over_d"].value,
        float(found.overlap.max()),
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
            restitution_for_zeta(damping_ratio(law.eta_n, law.k_n, mass), law.tension),
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
        **{
            f"{what}_{name.replace(' ', '_')}": getattr(layer, what)
            for name, layer in one.near_surface.items()
            for what in ("phi", "thrown", "between")
        },
        **dict(zip(("phi_lower", "phi_middle", "phi_upper"), one.thirds, strict=True)),
        "speed_m_per_s": one.speed,
        "speed_near_bed_m_per_s": one.near_bed,
        "q_m2_per_s": one.q,
        "drift": one.drift,
        "rms_z_m_per_s": one.rms_z,
        "at_rest": one.rest,
        "in_contact": one.touching,
        "companions": one.companions,
        "rods": one.rods,
        "rods_null": one.null,
        "spin_95_rad_per_s": one.spin,
        "along_in_a_contact_d": one.along,
        **{
            f"{what}_{name.replace(' ', '_')}": getattr(contacts, what)
            for name, contacts in one.contacts.items()
            for what in ("n", "time", "alone", "e", "closing", "overlap", "overlap_largest")
        },
    }
