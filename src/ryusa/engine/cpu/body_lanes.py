"""Workspace for the water on a batch of rigid bodies, which its laws see as grains."""

from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.shared.array_memory import zeros
from ryusa.model.fluid import N_IMPULSE, N_SAMPLED
from ryusa.model.rigid_bodies import N_DRAG_FORM


class BodyLanes(NamedTuple):
    """A batch of bodies as the laws of water see grains; workspace of one thread."""

    x: Any  # centres and radius of the sphere of the same volume [m], (LANES, 4)
    v: Any  # velocities [m/s], and 0, (LANES, 4)
    w: Any  # spins [rad/s], and the radius [m], (LANES, 4); beside v
    m: Any  # mass with added mass [kg], (LANES,)
    m_bare: Any  # [kg], (LANES,)
    fluid: Any  # water, columns of model.fluid, (LANES, N_SAMPLED)
    impulse: Any  # from the water in this step [N s], and drag over slip [N s/m], (LANES, N_IMPULSE)
    form: Any  # columns of `RigidBodies.drag_form`, (LANES, N_DRAG_FORM)
    film: Any  # none: (0, 0)


def body_lanes() -> BodyLanes:
    """Room for one thread."""
    both = zeros(np.float64, W.LANES, 8)
    return BodyLanes(
        zeros(np.float64, W.LANES, 4), both[:, :4], both[:, 4:], np.ones(W.LANES), np.ones(W.LANES),
        zeros(np.float64, W.LANES, N_SAMPLED), zeros(np.float64, W.LANES, N_IMPULSE),
        np.ones((W.LANES, N_DRAG_FORM)),
        np.zeros((0, 0)),
    )  # fmt: skip
