"""Live numbers of a run: overlap, steps per contact, measured restitution, energy account, warnings."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CheckpointError
from ryusa.laws.collision import (
    damping_ratio,
    effective_mass,
    effective_mass_tangential,
    restitution_for_zeta,
    restitution_tension,
)
from ryusa.laws.families import Adhesion, ContactTiming, WaterTorque
from ryusa.laws.rolling import reduced_radius
from ryusa.laws.torque import reynolds_spin, torque_in_range
from ryusa.measure.collisions import CLOSING_LEAST, speed_of_weight
from ryusa.model import Scene, State, Tally, Term
from ryusa.model.contact_law import ContactLaw, shortest_contact_of, stiffness_key
from ryusa.model.scene import Damping
from ryusa.model.tally import HELD, N_TERM
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.guards import NO_REST, SinceRest

BAND = (0.001, 0.01)  # stable range of overlap/d, fig11 of the paper
TRAVEL_LIMIT = 0.3  # of d along the bed within one contact; beyond it geometry ends contacts, not Eq. (8)
PASSED = 0.64  # overlap/d below which no grain passes through another (design/0008)
# steps per contact below which rebounds are inaccurate; for exact timing see design/0014
STEPS_LEAST = {ContactTiming.EXACT: 5.0, ContactTiming.AT_STEPS: 10.0}
RESIDUAL_LIMIT = 1e-3  # of the energy account
QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
_BOUNCE_LONGEST = 3.0  # times the shortest contact: in longer contacts a grain rolls or rests
_SLIP_LEAST = 0.1  # of the closing speed: with less slip tangential restitution is not measured
_MOST = np.iinfo(np.int64).max  # upper limit of the number of contacts
_DECADES, _BINS = (-1, 8), 100  # histogram of steps per contact: range of powers of ten, bins in each


@dataclass
class RunningMean:
    """Running mean and its standard error."""

    n: int = 0
    mean: float = 0.0
    spread: float = 0.0  # sum of squared differences from the mean

    def take(self, values: NDArray[np.float64]) -> None:
        """Add samples."""
        if len(values) == 0:
            return
        n, mean = len(values), float(values.mean())
        shift = mean - self.mean
        total = self.n + n
        self.spread += float(((values - mean) ** 2).sum()) + shift * shift * self.n * n / total
        self.mean += shift * n / total
        self.n = total

    def is_valid(self, most: int) -> bool:
        """True if at most `most` samples can have given these numbers."""
        return 0 <= self.n <= most and math.isfinite(self.mean) and 0.0 <= self.spread < math.inf

    def as_dict(self) -> dict[str, float | int | None]:
        """Number, mean and standard error; None if there are too few samples."""
        error = math.sqrt(self.spread / (self.n - 1) / self.n) if self.n > 1 else None
        return {"n": self.n, "mean": self.mean if self.n else None, "standard_error": error}


class Watch:
    """Live numbers of one run."""

    def __init__(self, scene: Scene, state: State) -> None:
        self.scene = scene
        self.rest = NO_REST  # the account when the grains last rested
        self.n_contact = 0
        self.t_col_shortest = shortest_collision_time(scene, state)
        self._g_t_col = speed_of_weight(scene)
        low, high = _DECADES
        self._edges = np.logspace(low, high, (high - low) * _BINS + 1)
        self._histogram = np.zeros(len(self._edges) - 1, dtype=np.int64)
        self._range = (math.inf, 0.0)  # of steps per contact
        self._normal = {"fixed": RunningMean(), "free": RunningMean()}
        self._stuck = {"fixed": RunningMean(), "free": RunningMean()}
        self._slid = {"fixed": RunningMean(), "free": RunningMean()}
        self._travel = RunningMean()
        self._travel_most = 0.0
        self._re_spin = 0.0  # largest rotational Reynolds number beyond the range of the water's torque
        self._follows = _follows(scene, _free_pairs(scene, state))

    def contacts(self, events: NDArray[np.void]) -> None:
        """Update with contacts that ended, dtype model.EVENT."""
        if len(events) == 0:
            return
        self.n_contact += len(events)
        if self._turned_by_water:
            sizes = self.scene.d[events["i"]]
            for name in ("omega_begin", "omega_end"):
                self._spins(np.linalg.norm(events[name], axis=1), sizes)
        whole = np.isfinite(events["closing_end"])  # in the others the partner was removed
        events = events if whole.all() else events[whole]
        if len(events) == 0:
            return
        duration = events["t_end"] - events["t_begin"]
        self._steps(duration / self.scene.dt)
        bed = events["j"] >= self.scene.n_grain
        # impacts on fixed grains; a grain that rolls or rests stays in contact for longer
        bounce = bed & (events["j"] < self.scene.n_grain + self.scene.n_fixed)
        bounce &= duration < _BOUNCE_LONGEST * self.t_col_shortest
        self._along_bed(events[bounce], duration[bounce])
        lonely = (events["alone"] == 1.0) & (events["closing_begin"] > CLOSING_LEAST * self._g_t_col)
        for name, partner in (("fixed", bed), ("free", ~bed)):
            self._restitution(events[lonely & partner], name)

    @property
    def _turned_by_water(self) -> bool:
        """Whether water turns grains by a law that holds up to some rotational Reynolds number."""
        return bool(self.scene.rotation) and self.scene.water.torque == WaterTorque.DENNIS

    def frame(self, tally: Tally) -> None:
        """Update with the account at a recorded frame."""
        self.rest = self.rest.after(tally)
        if self.scene.n_grain and self._turned_by_water:
            # the grain is not known; the largest one gives an upper bound
            self._spins(np.array([tally.spin_max]), self.scene.d.max(keepdims=True))

    def _spins(self, spin: NDArray[np.float64], d: NDArray[np.float64]) -> None:
        water = self.scene.water
        k = int(np.argmax(d * d * spin))
        if not torque_in_range(float(spin[k]), float(d[k]), water.nu):
            self._re_spin = max(self._re_spin, reynolds_spin(float(spin[k]), float(d[k]), water.nu))

    def _steps(self, steps: NDArray[np.float64]) -> None:
        self._histogram += np.histogram(np.clip(steps, self._edges[0], self._edges[-1]), self._edges)[0]
        self._range = (min(self._range[0], float(steps.min())), max(self._range[1], float(steps.max())))

    def _along_bed(self, events: NDArray[np.void], duration: NDArray[np.float64]) -> None:
        if len(events) == 0:
            return
        v = events["v_begin"]
        travel = np.hypot(v[:, 0], v[:, 1]) * duration / self.scene.d[events["i"]]
        self._travel.take(travel)
        self._travel_most = max(self._travel_most, float(travel.max()))

    def _restitution(self, events: NDArray[np.void], name: str) -> None:
        closing = events["closing_begin"]
        self._normal[name].take(-events["closing_end"] / closing)
        before, after = events["slip_begin"], events["slip_end"]
        square = np.einsum("ij,ij->i", before, before)
        oblique = np.sqrt(square) > _SLIP_LEAST * closing
        got = -np.einsum("ij,ij->i", before, after)[oblique] / square[oblique]
        slid = events["t_slide"][oblique] > 0.0
        self._stuck[name].take(got[~slid])
        self._slid[name].take(got[slid])

    def summary(self, tally: Tally) -> dict[str, Any]:
        """All live numbers as plain data, for summary.json."""
        scene = self.scene
        return {
            "overlap": {
                "largest_over_d": tally.overlap_max,
                "grain": tally.overlap_grain,
                "step": tally.overlap_step,
                "band": list(BAND),
            },
            "steps_per_contact": {"shortest": self.t_col_shortest / scene.dt, "observed": self._observed()},
            "restitution": {
                "asked": _common(scene, "e_n"),
                **({} if scene.materials is None else {"by_pair": True}),
                **({} if scene.bodies is None else {"clumps": True}),
                **({} if scene.contact.adhesion == Adhesion.NONE else {"adhesion": True}),
                "follows": {name: e_n for name, (e_n, _) in self._follows.items()},
                **{name: average.as_dict() for name, average in self._normal.items()},
            },
            "restitution_shear": {
                "asked": _common(scene, "e_s"),
                "follows": {name: e_s for name, (_, e_s) in self._follows.items()},
                "sticking": {name: average.as_dict() for name, average in self._stuck.items()},
                "sliding": {name: average.as_dict() for name, average in self._slid.items()},
            },
            "travel_over_d": {**self._travel.as_dict(), "most": self._travel_most, "limit": TRAVEL_LIMIT},
            "energy": energy(tally),
            "warnings": self.warnings(tally),
        }

    def warnings(self, tally: Tally) -> list[str]:
        """Warnings about the run, one sentence each."""
        found: list[str] = []
        largest, key = tally.overlap_max, stiffness_key(self.scene.contact)
        if largest > PASSED:
            found.append(
                f"largest overlap/d {largest:.3g} is above {PASSED}: grains may have passed through "
                f"each other; raise {key}"
            )
        touched = self.n_contact > 0 or tally.n_contact > 0
        if largest > BAND[1]:
            found.append(
                f"largest overlap/d {largest:.3g} is above {BAND[1]}: contacts so soft that grains at rest "
                f"may vibrate; raise {key}"
            )
        elif touched and largest < BAND[0]:
            found.append(
                f"largest overlap/d {largest:.3g} is below {BAND[0]}: contacts are stiffer than needed, "
                "which costs computing time"
            )
        steps = self.t_col_shortest / self.scene.dt
        if steps < (least := STEPS_LEAST[self.scene.contact.timing]) * (1.0 - 1e-9):
            found.append(
                f"{steps:.1f} steps in the shortest contact, below {least:g}: rebounds are inaccurate; "
                "raise time.steps_per_contact"
            )
        if self._travel_most > TRAVEL_LIMIT:
            found.append(
                f"a grain moved {self._travel_most:.2g} d along the bed within one contact "
                f"(mean {self._travel.mean:.2g} d, limit {TRAVEL_LIMIT}): geometry ends contacts before the "
                f"rebound; raise {key}"
            )
        if self._re_spin:
            found.append(
                f"a grain rotated at Re_r = d^2 omega/nu up to {self._re_spin:.3g}, above the fitted range "
                "of water.torque = 'Dennis': its torque is extrapolated"
            )
        if tally.residual > RESIDUAL_LIMIT and not self._empty(tally):
            found.append(
                f"the imbalance of the energy account is {tally.residual:.1e} of its largest term, "
                f"above {RESIDUAL_LIMIT:g}; raise time.steps_per_contact"
            )
        return found

    def _empty(self, tally: Tally) -> bool:
        """Whether grains have all left, and what is left in the account is round-off."""
        weight = float(np.linalg.norm(self.scene.gravity)) * float(np.abs(self.scene.m_weight).sum())
        round_off = 1e-9 * weight * float(self.scene.d.max(initial=0.0))
        return self.scene.traffic is not None and abs(tally.imbalance) < round_off

    def to_block(self) -> CheckpointBlock:
        """All numbers so far, for a checkpoint."""
        values = {"n_contact": self.n_contact, "range": self._range, "re_spin": self._re_spin}
        values |= {"rest": [self.rest.created, self.rest.held, *self.rest.terms]}
        values |= {"travel_most": self._travel_most, "averages": [vars(one) for one in self._averages()]}
        return CheckpointBlock(values, {"histogram": self._histogram})

    def restore(self, block: CheckpointBlock) -> None:
        """Take over the numbers of a checkpoint.

        Raises
        ------
        CheckpointError : the numbers are missing or not valid.
        """
        try:
            values, histogram = block.values, block.arrays["histogram"]
            low, high = (float(one) for one in values["range"])
            if histogram.shape != self._histogram.shape or histogram.dtype != np.int64 or histogram.min() < 0:
                raise ValueError(f"a histogram of shape {histogram.shape}")
            for one, seen in zip(self._averages(), values["averages"], strict=True):
                one.n, one.mean, one.spread = int(seen["n"]), float(seen["mean"]), float(seen["spread"])
            self.n_contact, self._re_spin = int(values["n_contact"]), float(values["re_spin"])
            self._travel_most = float(values["travel_most"])
            created, held, *terms = (float(one) for one in values["rest"])
            self.rest = SinceRest(created, held, tuple(terms))
            if len(terms) != N_TERM:
                raise ValueError(f"{len(terms)} terms of the account at rest")
            if not 0 <= self.n_contact <= _MOST:
                raise ValueError("an impossible number of contacts")
            if not all(one.is_valid(self.n_contact) for one in self._averages()):
                raise ValueError("an impossible mean or spread")
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise CheckpointError(f"the live numbers in the checkpoint are not valid ({error})") from error
        self._histogram, self._range = histogram, (low, high)

    def _averages(self) -> list[RunningMean]:
        kinds = (self._normal, self._stuck, self._slid)
        return [*(one for kind in kinds for one in kind.values()), self._travel]

    def _observed(self) -> dict[str, float | int | None]:
        """Observed steps per contact: number, minimum, quantiles to 2.3 %, maximum."""
        total = int(self._histogram.sum())
        if total == 0:
            return {"n": 0}
        below = np.cumsum(self._histogram)
        middle = np.sqrt(self._edges[:-1] * self._edges[1:])
        found: dict[str, float | int | None] = {"n": total, "least": self._range[0]}
        for quantile in QUANTILES:
            value = float(middle[np.searchsorted(below, quantile * total)])
            found[f"q{round(100 * quantile):02d}"] = min(max(value, self._range[0]), self._range[1])
        found["most"] = self._range[1]
        return found


def energy(tally: Tally) -> dict[str, float]:
    """The energy account [J], each term summed separately, with imbalance and residual."""
    account = {name: float(getattr(tally, name)) for name in HELD}
    account |= {term.name.lower(): float(tally.terms[term]) for term in Term}
    return {**account, "imbalance": tally.imbalance, "residual": tally.residual}


def shortest_collision_time(scene: Scene, state: State) -> float:
    """Contact time of the lightest pair that can collide, damped or undamped [s]; inf without grains.

    With materials the shortest of those that can meet, each with its lightest grains.
    """
    if scene.n_grain == 0:
        return math.inf
    m, d, free, made = scene.m + scene.m_added, scene.d, _free_pairs(scene, state), scene.materials
    of = np.zeros(len(m), np.int8) if made is None else made.of[: scene.n_grain]
    if (bodies := scene.bodies) is not None:  # its largest sphere, where it gives way most
        alone = bodies.of_grain(scene.n_grain) < 0
        of_bodies = np.maximum.reduceat(d[bodies.members], np.cumsum(bodies.count) - bodies.count)
        m, d = np.concatenate([m[alone], bodies.least_mass]), np.concatenate([d[alone], of_bodies])
        of = np.concatenate([of[alone], of[bodies.members[np.cumsum(bodies.count) - bodies.count]]])
        free = len(m) > 1
    order = np.argsort(m, kind="stable")

    def shortest(law: ContactLaw, i: int, j: int | None) -> float:
        m_j, r_j = (math.inf, math.inf) if j is None else (float(m[j]), 0.5 * float(d[j]))
        radius = reduced_radius(0.5 * float(d[i]), r_j)
        return shortest_contact_of(law, effective_mass(float(m[i]), m_j), radius)

    if made is None:
        return shortest(scene.contact, int(order[0]), int(order[1]) if free else None)
    light = [(kind, order[of[order] == kind].tolist()) for kind in np.unique(of).tolist()]
    still = np.unique(made.of[scene.n_grain :]).tolist()
    times = [shortest(made.contact[a * made.n + b], grains[0], None) for a, grains in light for b in still]
    for a, (i, *_) in light if free else ():
        for b, grains in light:
            partners = [one for one in grains if one != i]
            times += [shortest(made.contact[a * made.n + b], i, one) for one in partners[:1]]
    return min(times, default=math.inf)


def _follows(scene: Scene, free_pairs: bool) -> dict[str, tuple[float, float | None]]:
    """Normal and tangential restitution of the mean grain that constant dashpots give, by partner.

    Empty if the case sets the restitution; no tangential one without a tangential spring.
    """
    law = scene.contact
    if law.damping == Damping.RESTITUTION or scene.n_grain == 0:
        return {}
    m, r = float((scene.m + scene.m_added).mean()), float(scene.d.mean()) / 2
    inertia, spins = float(scene.inertia.mean()), bool(scene.rotation)
    others = {"fixed": (math.inf, math.inf)} if scene.n_fixed + scene.n_plane else {}
    others |= {"free": (m, inertia)} if free_pairs else {}
    found: dict[str, tuple[float, float | None]] = {}
    for name, (m_j, inertia_j) in others.items():
        m_t = effective_mass_tangential(m, r, inertia, m_j, r, inertia_j, spins)
        e_n = restitution_for_zeta(damping_ratio(law.eta_n, law.k_n, effective_mass(m, m_j)), law.tension)
        e_s = restitution_tension(damping_ratio(law.eta_s, law.k_s, m_t)) if law.k_s > 0.0 else None
        found[name] = (e_n, e_s)
    return found


def _free_pairs(scene: Scene, state: State) -> bool:
    """True if two free grains can collide; false if each has its own lane in a plane scene."""
    if scene.n_grain < 2:
        return False
    if not scene.plane_case or scene.traffic is not None:
        return True
    order = np.argsort(state.x[:, 1])
    y, r = state.x[order, 1], scene.d[order] / 2
    return bool(np.any(np.diff(y) < r[1:] + r[:-1]))


def _common(scene: Scene, name: str) -> float | None:
    """Value of a contact law that is the same for all pairs of materials; None where there is none."""
    laws = (scene.contact,) if scene.materials is None else scene.materials.contact
    values = {getattr(law, name) for law in laws}
    return _or_none(float(values.pop())) if len(values) == 1 else None


def _or_none(value: float) -> float | None:
    return None if math.isnan(value) else value
