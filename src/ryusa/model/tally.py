"""The energy account; every term is summed separately, none is found as a difference."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np


class Term(IntEnum):
    """Terms of the energy account, summed while stepping [J]; energy lost and energy given are positive."""

    DASH_N = 0  # lost to normal dashpots
    DASH_S = 1  # lost to tangential dashpots
    SLIDE = 2  # lost to sliding
    ROLL = 3  # lost to rolling friction (slider and dashpot)
    RELEASED_N = 4  # lost: left in normal springs whose force ended before the overlap did
    # lost: left in tangential springs when a contact ended, or as the contact of elastic spheres changes
    RELEASED_S = 5
    RELEASED_R = 6  # lost: left in rolling springs when a contact ended
    DRAG = 7  # given by drag
    TORQUE = 8  # given by the water torque
    LIFT = 9  # given by lift and the Magnus force
    SWITCH = 10  # given by a change of the timeline (gravity, a gate), by grains that enter or leave
    # given by the finite step where contacts begin and end, (1/2) k overlap (closing dt - overlap), where the
    # spring of elastic spheres is curved, and with exact timing where grains have several partners
    STEP = 11
    START = 12  # energy at the first step: kinetic + spin + potential + springs
    FLOW = 13  # given by pressure, stress and acceleration of the water, beyond buoyancy in still water
    FILM = 14  # lost to films of water between grains that do not touch
    WALL = 15  # given by moving walls


N_TERM = len(Term)
# Terms whose work of the second half step is still to be added.
PENDING = (
    Term.DRAG, Term.TORQUE, Term.LIFT, Term.FLOW, Term.FILM, Term.WALL, Term.STEP, Term.DASH_N, Term.DASH_S,
    Term.SLIDE,
)  # fmt: skip
LOSSES = (
    Term.DASH_N, Term.DASH_S, Term.SLIDE, Term.ROLL, Term.RELEASED_N, Term.RELEASED_S, Term.RELEASED_R,
    Term.FILM,
)  # fmt: skip
GIFTS = (Term.DRAG, Term.TORQUE, Term.LIFT, Term.FLOW, Term.WALL, Term.SWITCH, Term.STEP)
# Terms for the size of the account; START and SWITCH depend on the origin of heights.
SIZES = tuple(term for term in Term if term not in {Term.START, Term.SWITCH})
HELD = ("kinetic", "spin", "potential", "spring_n", "spring_s", "spring_r")


def residual_of(imbalance: Any, held: Mapping[str, Any], work: Mapping[Term, Any]) -> float:
    """Largest imbalance over the largest term of an account [-], at one moment or over arrays of moments.

    nan where an engine keeps no account.

    The terms are the energies of motion and springs, the terms of `SIZES`, and the change of held energy
    without the energy given by the timeline; none depends on the origin of heights.

    Parameters
    ----------
    imbalance : energy that the terms do not explain [J].
    held : energies by name, those of `HELD` [J].
    work : summed terms [J]; a missing one counts as zero.
    """
    change = sum(held.values()) - work.get(Term.START, 0.0) - work.get(Term.SWITCH, 0.0)
    sizes = [change, *(one for name, one in held.items() if name != "potential")]
    sizes += [work[term] for term in SIZES if term in work]
    largest = max(map(_largest, sizes))
    if math.isnan(largest):
        return largest
    return _largest(imbalance) / largest if largest > 0.0 else 0.0


def _largest(size: Any) -> float:
    """Largest magnitude of a number or of an array, 0 of an empty one."""
    if isinstance(size, float):  # of one moment; numpy would take longer than a step of the grains
        return float(abs(size))
    return float(np.abs(np.asarray(size)).max(initial=0.0))


@dataclass(frozen=True)
class Tally:
    """Energy account [J] and extremes at the time of the last force evaluation."""

    t: float  # [s]
    kinetic: float  # translation, added mass included
    spin: float
    potential: float  # weight and buoyancy, measured from z = 0 (and x = 0 on a slope)
    spring_n: float  # less the energy that adhesion has released
    spring_s: float
    spring_r: float
    terms: tuple[float, ...]  # indexed by Term
    overlap_max: float  # largest overlap over the smaller diameter so far [-]
    overlap_grain: int  # grain with that overlap
    overlap_step: int  # step of that overlap
    speed_max: float  # largest grain speed in the last step [m/s]
    spin_max: float  # largest spin in the last step [rad/s]
    n_contact: int  # number of touching pairs
    pending: tuple[float, ...] = (0.0,) * len(PENDING)  # work of the second half of the present step [J]
    walls: tuple[float, ...] = ()  # impulses and work of each wall since the start (model.walls)

    @property
    def held(self) -> float:
        """Present energy of motion, height and springs [J]."""
        return self.kinetic + self.spin + self.potential + self.spring_n + self.spring_s + self.spring_r

    @property
    def imbalance(self) -> float:
        """Energy that the terms do not explain [J]: held - start - given + lost."""
        gifts = sum(self.terms[term] for term in GIFTS)
        losses = sum(self.terms[term] for term in LOSSES)
        return self.held - self.terms[Term.START] - gifts + losses

    @property
    def residual(self) -> float:
        """Imbalance over the largest term of the account [-], as in `residual_of`."""
        held = {name: getattr(self, name) for name in HELD}
        return residual_of(self.imbalance, held, dict(zip(Term, self.terms, strict=True)))
