"""Rigid bodies in water: each as one grain of its volume, with the drag of its form.

The water at a body is the mean over its members by volume under water, as each of them lies in cells of its
own in a column; what the body takes from the water goes back by the same shares.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.engine.cpu.body_lanes import BodyLanes
from ryusa.engine.cpu.fluid_forces import make_forces_in_column, make_forces_in_profile
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import FluidLaws
from ryusa.laws.rigid_body import spin
from ryusa.model.fluid import EXTRA_X, EXTRA_Z, N_IMPULSE, N_SAMPLED, SUBMERGED
from ryusa.model.rigid_bodies import N_DRAG_FORM


@cache
def make_forces_on_bodies(column: bool, laws: FluidLaws) -> Any:
    """Build forces_on_bodies(begin, end, c, fluid, bodies, lanes, batch) for the water that a scene has."""
    in_column: Any = make_forces_in_column(laws, True) if column else None
    in_profile: Any = None if column else make_forces_in_profile(laws, True)

    @inner(fastmath=FAST)
    def forces_on_bodies(
        begin: int, end: int, c: Any, fluid: Any, bodies: Any, lanes: BodyLanes, batch: Any
    ) -> None:
        """Coefficients and forces on bodies begin..end-1, in `BodyArrays.order`, at most LANES."""
        for k in range(begin, end):
            l, b = k - begin, bodies.order[k]
            q_w, q_x, q_y, q_z = bodies.q[b, 0], bodies.q[b, 1], bodies.q[b, 2], bodies.q[b, 3]
            w_x, w_y, w_z = spin(
                q_w, q_x, q_y, q_z, bodies.momentum[b, 0], bodies.momentum[b, 1], bodies.momentum[b, 2],
                bodies.over[b, 0], bodies.over[b, 1], bodies.over[b, 2],
            )  # fmt: skip
            lanes.w[l, 0], lanes.w[l, 1], lanes.w[l, 2], lanes.w[l, 3] = w_x, w_y, w_z, bodies.r[b]
            for a in range(3):
                lanes.x[l, a], lanes.v[l, a] = bodies.x[b, a], bodies.v[b, a]
            lanes.x[l, 3] = bodies.r[b]
            for a in range(N_DRAG_FORM):
                lanes.form[l, a] = bodies.drag_form[b, a]
            lanes.m_bare[l], lanes.m[l] = bodies.m[b], bodies.m[b] + bodies.m_added[b]
            for a in range(N_IMPULSE):
                lanes.impulse[l, a] = 0.0
            if column:
                mean_over_members(l, b, fluid, bodies, lanes)
        if column:
            in_column(
                0, end - begin, c, lanes.v, lanes.w, lanes.m, lanes.m_bare, lanes.fluid, batch, lanes.form
            )
        else:
            in_profile(0, end - begin, c, lanes.x, lanes.v, lanes.w, batch, lanes.form)

    return forces_on_bodies


@inner(fastmath=FAST)
def mean_over_members(l: int, b: int, fluid: Any, bodies: Any, lanes: BodyLanes) -> None:
    """Water at body b: means over what of its members is under water, their share, and sums of forces."""
    wet = 0.0
    for s in range(bodies.start[b], bodies.start[b + 1]):
        wet += bodies.share[s] * fluid[bodies.place[s], SUBMERGED]
    per = 1.0 / wet if wet > 0.0 else 0.0
    for a in range(N_SAMPLED):
        total = 0.0
        for s in range(bodies.start[b], bodies.start[b + 1]):
            i = bodies.place[s]
            part = 1.0 if EXTRA_X <= a <= EXTRA_Z else bodies.share[s]
            if a < EXTRA_X:
                part *= per * fluid[i, SUBMERGED]
            total += part * fluid[i, a]
        lanes.fluid[l, a] = total


@inner(fastmath=FAST)
def share_impulse(l: int, b: int, bodies: Any, lanes: BodyLanes, fluid: Any, impulse: Any) -> None:
    """Book what body b took from the water in this step to its members, by their volumes under water.

    A member above the surface lies in no cell: what is booked to it is lost.
    """
    wet = lanes.fluid[l, SUBMERGED]
    per = 1.0 / wet if wet > 0.0 else 0.0
    for s in range(bodies.start[b], bodies.start[b + 1]):
        i = bodies.place[s]
        part = per * bodies.share[s] * fluid[i, SUBMERGED]
        for a in range(3):
            impulse[i, a] += part * lanes.impulse[l, a]
        impulse[i, 3] = part * lanes.impulse[l, 3]
