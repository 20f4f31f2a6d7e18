"""Clumps taken out of a snapshot and put into it: what they hold, and where their members are.

A clump holds 1/2 M V(n-1/2).V(n+1/2) + 1/2 L(n-1/2).w with w = I(q(n))^-1 L(n+1/2), at x(n) (design/0022),
and a snapshot has V(n+1/2), L(n+1/2) and q(n+1). The free step is reversible: q(n) is found by one back, and
V(n-1/2), L(n-1/2) by taking away what the contacts of that step gave.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.rigid_body import rotor_step
from ryusa.model import BodyState, RigidBodies, Scene, State
from ryusa.model.arrays import Floats
from ryusa.model.fluid import SUBMERGED

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Held:
    """Energy that some grains hold [J]."""

    kinetic: float = 0.0
    spin: float = 0.0
    potential: float = 0.0

    def __add__(self, other: "Held") -> "Held":
        return Held(self.kinetic + other.kinetic, self.spin + other.spin, self.potential + other.potential)


def split(scene: Scene, ids: Ints) -> tuple[Ints, Ints]:
    """Grains of some ids that belong to no clump, and the clumps of the rest."""
    if scene.bodies is None:
        return ids, np.zeros(0, np.int64)
    of = scene.bodies.of_grain(scene.n_grain)[ids]
    return ids[of < 0], np.unique(of[of >= 0])


def held_by_bodies(scene: Scene, state: State, which: Ints, force: Floats, torque: Floats) -> Held:
    """Energy that some clumps of a snapshot take along (`passages.py`).

    Parameters
    ----------
    which : clumps that are there.
    force, torque : on all spheres in the step of the snapshot [N, N m], shape (n_grain, 3).
    """
    if not len(which):
        return Held()
    some, moved = _some(scene, state, which)
    push, turn, w = _of_contacts(scene, some, moved, force, torque)
    m, weight, dt = _mass(scene, state, some), some.m_weight[:, None] * scene.gravity, scene.dt
    before = moved.v - dt * (weight + push) / m[:, None]
    kinetic = 0.5 * float(np.sum(m[:, None] * moved.v * before))
    spin = 0.5 * float(np.sum((moved.momentum - dt * turn) * w))
    return Held(kinetic, spin, _height(scene, some, replace(moved, x=moved.x - dt * moved.v)))


def held_at_entry(scene: Scene, state: State, which: Ints) -> Held:
    """Energy of some clumps that have just been put into a snapshot."""
    if not len(which):
        return Held()
    some, moved = _some(scene, state, which)
    m, weight = _mass(scene, state, some), some.m_weight[:, None] * scene.gravity
    kinetic = 0.5 * float(np.sum(m[:, None] * moved.v * (moved.v + scene.dt * weight / m[:, None])))
    spin = 0.5 * float(np.sum(moved.momentum * moved.spin(some)))
    return Held(kinetic, spin, _height(scene, some, moved))


def half_step_on_bodies(scene: Scene, state: State, which: Ints, force: Floats, torque: Floats) -> float:
    """Work of forces on some clumps in the second half of the step of a snapshot [J].

    `force` and `torque` as in `held_by_bodies`.
    """
    if not len(which):
        return 0.0
    some, moved = _some(scene, state, which)
    push, turn, w = _of_contacts(scene, some, moved, force, torque)
    return 0.5 * scene.dt * float(np.sum(push * moved.v) + np.sum(turn * w))


def with_bodies(moved: BodyState, which: Ints, put: BodyState | None) -> BodyState:
    """Motion of all clumps with that of some changed; nan where they are taken out (`put` is None)."""
    found = {name: getattr(moved, name).copy() for name in ("x", "v", "q", "momentum", "image")}
    for name, array in found.items():
        gone = 0 if name == "image" else np.nan
        array[which] = gone if put is None else getattr(put, name)
    return BodyState(**found)


def _some(scene: Scene, state: State, which: Ints) -> tuple[RigidBodies, BodyState]:
    bodies, moved = scene.bodies, state.bodies
    assert bodies is not None
    assert moved is not None
    return bodies.some(which, bodies.first[which]), moved.some(which)


def _of_contacts(
    scene: Scene, some: RigidBodies, moved: BodyState, force: Floats, torque: Floats
) -> tuple[Floats, Floats, Floats]:
    """Forces and torques on clumps [N, N m] in the step of a snapshot, and I(q(n))^-1 L(n+1/2) [rad/s]."""
    over = 1.0 / some.inertia
    back = np.zeros_like(moved.q)
    for row, q, momentum, one in zip(
        back, moved.q.tolist(), moved.momentum.tolist(), over.tolist(), strict=True
    ):
        (w, x, y, z), (l_x, l_y, l_z), (a, b, c) = q, momentum, one
        row[:] = rotor_step(w, x, y, z, l_x, l_y, l_z, a, b, c, -scene.dt)[:4]
    then = replace(moved, q=back)
    arms, f = then.arms(some), force[some.members]
    push, turn = some.sums(f), some.sums(torque[some.members] + np.cross(arms, f))
    return push, turn, then.spin(some)


def _mass(scene: Scene, state: State, some: RigidBodies) -> Floats:
    """Mass of clumps with that of the water that moves along [kg]; in a column with what of them is in it."""
    added = some.sums(scene.m_added[some.members])
    if state.fluid is None:
        return some.m + added
    share = scene.m[some.members] / np.repeat(some.m, some.count)
    return some.m + added * some.sums(share * state.fluid.sampled[some.members, SUBMERGED])


def _height(scene: Scene, some: RigidBodies, moved: BodyState) -> float:
    """Potential energy of clumps from the origin, periods crossed added [J]."""
    x = moved.x.copy()
    for axis in range(2):
        if np.isfinite(scene.period[axis]):
            x[:, axis] += moved.image[:, axis] * scene.period[axis]
    return -float(np.sum(some.m_weight[:, None] * x * scene.gravity))
