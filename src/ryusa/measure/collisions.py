"""Single contacts: duration, overlap, closing speed, and the restitution that resulted."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.collision import collision_time, contact_time, omega_natural
from ryusa.laws.families import ContactForce
from ryusa.laws.hertz import time_factor_hertz
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import Average, average
from ryusa.measure.table import Averaged, Averages, rows_of
from ryusa.model import Scene
from ryusa.model.contact_law import damping_ratio_of, hertz_stiffness_of

Partner = Literal["all", "bed", "free", "plane", "wall"]


CLOSING_LEAST = 20.0  # times g t_col: in slower contacts the weight changes the speed by 5 % or more


@dataclass(frozen=True)
class ContactTimes:
    """Closed forms of the contact time of one grain with one partner.

    Attributes
    ----------
    eq_8 : Eq. (8) with the mass of the grain alone [s] (of the pair, for a free partner).
    added : the same with the added mass of the water [s].
    damped : with added mass and the dashpot of the case, to the end of the normal force [s].
    """

    eq_8: float
    added: float
    damped: float


@dataclass(frozen=True, repr=False)
class Collisions(Averaged):
    """Contacts that ended within the window, one entry per contact in every array.

    Attributes
    ----------
    events : the records themselves, dtype model.EVENT.
    duration : from first touch to the end of the normal force [s]; nan where the partner was taken away.
    overlap : largest overlap over the smaller diameter [-].
    speed : closing speed at first touch [m/s].
    restitution : parting over closing speed of contacts that were alone, else nan [-].
    restitution_s : minus the slip at parting along that at first touch, over it; alone only [-]. Like the
        normal one it is positive where the motion turns round; it is negative where the slip goes on.
    expected : duration by Eq. (8) with the pair's mass, added mass included, and its dashpot [s]; of elastic
        spheres by Hertz, at the speed of each contact.
    turning : u**2 t / (r v), t the expected duration, r the distance of the centres at first touch, u and v
        the speeds of the grain's centre along and against a fixed grain: how much the normal turns [-]; nan
        where the partner is not a fixed grain. It shortens contacts (`turned_time`).
    averages : means with their errors.
    """

    events: NDArray[Any]
    duration: Floats
    overlap: Floats
    speed: Floats
    restitution: Floats
    restitution_s: Floats
    expected: Floats
    turning: Floats
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per contact."""
        return rows_of(self.events)


def _over(above: Floats, below: Floats) -> Floats:
    """Quotients; nan where nothing is below."""
    return np.divide(above, below, out=np.full(len(above), np.nan), where=below > 0.0)


def speed_of_weight(scene: Scene) -> float:
    """Speed that the heaviest grain gains by its weight within one contact [m/s]."""
    if scene.n_grain == 0:
        return 0.0
    k = int(np.argmax(scene.m))
    m = float(scene.m[k] + scene.m_added[k])  # that of a sphere of a clump, at most: contacts judged are more
    g = float(np.linalg.norm(scene.gravity)) * abs(float(scene.m_weight[k])) / m
    return g * collision_time(m, scene.contact.k_n)


def contact_times(scene: Scene, grain: int = 0, partner: int | None = None) -> ContactTimes:
    """Closed forms for `grain` against a fixed partner (None) or another free grain."""
    law = scene.contact
    m, added = float(scene.m[grain]), float(scene.m_added[grain])
    if partner is not None:
        other, other_added = float(scene.m[partner]), float(scene.m_added[partner])
        pair = 1.0 / (1.0 / m + 1.0 / other)
        heavy = 1.0 / (1.0 / (m + added) + 1.0 / (other + other_added))
    else:
        pair, heavy = m, m + added
    return ContactTimes(
        eq_8=collision_time(pair, law.k_n),
        added=collision_time(heavy, law.k_n),
        damped=_damped(scene, heavy),
    )


def collisions(
    run: Run,
    partner: Partner = "all",
    settle: float | None = None,
    end: float = math.inf,
    slowest: float = 0.0,
) -> Collisions:
    """Contacts of a run.

    Parameters
    ----------
    run : a run folder.
    partner : which partners count: "all", "bed" (fixed grains), "free", "plane" or "wall".
    settle : contacts that began before are left out [s]; default the case's `record.settle`.
    end : contacts that parted after are left out [s].
    slowest : contacts that closed more slowly are left out [m/s].
    """
    scene = run.scene
    begin = settle_time(run) if settle is None else settle
    events = run.contacts
    keep = (events["t_begin"] >= begin) & (events["t_part"] <= end) & (events["closing_begin"] >= slowest)
    events = events[keep & _of_kind(events["j"], scene, partner)]
    mass = scene.m + scene.m_added
    i, j = events["i"], events["j"]
    free = j < scene.n_grain
    other = np.where(free, mass[np.where(free, j, 0)], np.inf) if scene.n_grain else np.zeros(0)
    pair = 1.0 / (1.0 / mass[i] + 1.0 / other)
    sizes = np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane + scene.n_face, np.inf)])
    whole = np.isfinite(events["closing_end"])  # of the others the partner was taken away
    duration = np.where(whole, events["t_end"] - events["t_begin"], np.nan)
    overlap = events["overlap_max"] / np.minimum(sizes[i], sizes[j])
    speed = events["closing_begin"]
    alone = whole & (events["alone"] > 0.0) & (speed > 0.0)
    e = _over(-events["closing_end"], np.where(alone, speed, 0.0))
    slip = np.linalg.norm(events["slip_begin"], axis=1)
    along = -np.einsum("ij,ij->i", events["slip_begin"], events["slip_end"])
    e_s = _over(along, np.where(alone, slip * slip, 0.0))
    radii = 0.5 * sizes
    reduced, expected = 1.0 / (1.0 / radii[i] + 1.0 / radii[j]), np.empty(len(events))
    for one, some in scene.by_pair(i, j):
        expected[some] = _expected(one, pair[some], reduced[some], speed[some])
    window = (begin, float(events["t_part"].max()) if len(events) else math.nan)

    def mean(name: str, unit: str, values: Floats) -> Average:
        return average(name, unit, [values], window)

    lone = np.where(events["alone"] > 0.0, duration, np.nan)
    averages = Averages(
        "collisions",
        (
            mean("duration", "s", duration),
            mean("duration_alone", "s", lone),
            mean("duration_over_expected_alone", "-", lone / expected),
            mean("overlap_over_d", "-", overlap),
            mean("closing_speed", "m/s", speed),
            mean("restitution_alone", "-", e),
            mean("restitution_shear_alone", "-", e_s),
            mean("slide_share", "-", _over(events["t_slide"], events["t_part"] - events["t_begin"])),
        ),
        (
            f"{len(events)} contacts with partner '{partner}', {int(alone.sum())} of them alone",
            f"largest overlap/d {overlap.max():.4g}" if len(events) else "no contact in the window",
            *_by_speed(e, speed, CLOSING_LEAST * speed_of_weight(scene)),
        ),
    )
    turning = _turning(events, scene, expected)
    return Collisions(events, duration, overlap, speed, e, e_s, expected, turning, averages)


def turned_time(turning: Floats) -> Floats:
    """Contact time over that of a straight impact, for a smooth grain that passes over a fixed one.

    The line of centres turns, so that in its frame the centrifugal acceleration u**2/r opens the contact. For
    a spring alone and a constant u the contact lasts 1 - (2/pi) atan(turning/pi) of Eq. (8).

    >>> turned_time(np.array([0.0, 1.0])).round(4).tolist()
    [1.0, 0.8038]
    """
    return 1.0 - (2.0 / math.pi) * np.arctan(turning / math.pi)


def _turning(events: NDArray[Any], scene: Scene, expected: Floats) -> Floats:
    speed = events["closing_begin"]
    along = np.einsum("ij,ij->i", events["v_begin"], events["v_begin"]) - speed**2
    fixed = _of_kind(events["j"], scene, "bed")
    which = np.where(fixed, events["j"] - scene.n_grain, 0)
    sizes = scene.d_fixed[which] if scene.n_fixed else np.zeros(len(events))
    below = 0.5 * (scene.d[events["i"]] + sizes) * speed
    found = np.full(len(events), np.nan)
    return np.divide(np.maximum(along, 0.0) * expected, below, out=found, where=fixed & (speed > 0.0))


def _of_kind(j: NDArray[np.int64], scene: Scene, partner: Partner) -> NDArray[np.bool_]:
    bed, planes, walls = scene.n_grain, scene.n_grain + scene.n_fixed, scene.n_partner - scene.n_face
    kinds: dict[str, NDArray[np.bool_]] = {
        "all": np.ones(len(j), dtype=np.bool_),
        "free": j < bed,
        "bed": (j >= bed) & (j < planes),
        "plane": (j >= planes) & (j < walls),
        "wall": j >= walls,
    }
    return kinds[partner]


def _by_speed(e: Floats, speed: Floats, least: float) -> list[str]:
    """How the restitution of contacts that close slowly differs from that of the others, in words."""
    alone = np.isfinite(e)
    fast = alone & (speed > least)
    if not fast.any() or fast.sum() == alone.sum():
        return []
    return [
        f"restitution_alone is {np.mean(e[fast]):.3g} of the {fast.sum()} that closed faster than "
        f"{least:.2g} m/s, which the summary of a run states; the weight of a grain changes that of the "
        "others"
    ]


def _damped(scene: Scene, mass: float) -> float:
    law = scene.contact
    return contact_time(damping_ratio_of(law, mass), omega_natural(law.k_n, mass), law.tension)


def _expected(scene: Scene, pair: Floats, r: Floats, speed: Floats) -> Floats:
    law = scene.contact
    if law.force == ContactForce.HERTZ_MINDLIN:
        factor = time_factor_hertz(law.zeta_n, law.tension)
        square = hertz_stiffness_of(law, 1.0) ** 2 * r * np.where(speed > 0.0, speed, np.nan)
        return factor * (pair * pair / square) ** 0.2
    values, which = np.unique(pair, return_inverse=True)
    return np.array([_damped(scene, float(one)) for one in values], dtype=np.float64)[which]
