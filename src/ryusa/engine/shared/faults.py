"""From what a kernel flagged to an error that names grain, partner, step and remedy."""

import math
from typing import Any

import numpy as np

from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.status import FAULT_CROSSED, FAULT_NOT_A_NUMBER, FAULT_OVERLAP
from ryusa.errors import (
    ContactSlotsFull,
    GrainLost,
    GrainThroughWall,
    ListUnsafe,
    NotANumber,
    OverlapTooLarge,
    RunError,
)
from ryusa.model import ContactLaw, Scene
from ryusa.model.contact_law import stiffness_key
from ryusa.model.scene import Floats

FEW = 8.0  # steps in a contact below which the step, not the spring, lets a grain go deep


def fault_of(stats: Floats, parameters: Floats, scene: Scene, grains: Any, step: int) -> RunError:
    """The first fault that a block flagged in this step; `grains` of the engine have `v` and `ids`."""
    block = int(np.argmax(stats[:, S.FAULT] != 0))
    fault, grain, partner = (int(stats[block, k]) for k in (S.FAULT, S.FAULT_GRAIN, S.FAULT_PARTNER))
    t = float(parameters[P.T_ZERO] + step * parameters[P.DT])
    where: dict[str, Any] = {
        "grain": grain,
        "step": step,
        "t": t,
        "partner": None if partner < 0 else partner,
        "surface": surface_name(scene, partner),
    }
    if fault == FAULT_NOT_A_NUMBER:
        hint = (
            "Forces grew without bound, most likely because the step is too long for the springs: raise "
            "time.steps_per_contact, which shortens the step, and inspect the frames before."
        )
        return NotANumber("velocity is not finite", **where, hint=hint)
    if fault == FAULT_OVERLAP:
        found = f"overlap is {stats[block, S.OVERLAP_MAX]:.3g} of the smaller diameter, more than the limit"
        hint = _of_depth(scene, grains, grain, float(parameters[P.DT]))
        hint += ", or raise domain.overlap_limit if this is meant."
        return OverlapTooLarge(f"{found} {parameters[P.OVERLAP_LIMIT]:g}", **where, hint=hint)
    if fault == FAULT_CROSSED:
        hint = _of_depth(scene, grains, grain, float(parameters[P.DT]))
        hint += "; the frames before show how it came."
        return GrainThroughWall("the centre of a grain went through a wall", **where, hint=hint)
    hint = "Record fewer of them: record.events = 'tracked' or 'none'."
    return ContactSlotsFull("more contacts ended in one step than the record holds", **where, hint=hint)


def _of_depth(scene: Scene, grains: Any, grain: int, dt: float) -> str:
    """What keeps a grain from going so deep: a shorter step or a stiffer spring."""
    place = int(np.flatnonzero(np.asarray(grains.ids) == grain)[0])
    speed, law = float(np.linalg.norm(grains.v[place, :3])), scene.contact
    steps = math.pi * math.sqrt(float(scene.m[grain]) / law.k_n) / dt
    if steps < FEW:
        return (
            f"Its contacts last {steps:.2g} steps only: shorten the step (raise time.steps_per_contact, or "
            "lower time.step)"
        )
    return f"It moves at {speed:.3g} m/s: use stiffer contacts ({stiffness_key(law)})"


def surface_name(scene: Scene, partner: int) -> str:
    """Name of the plane or wall with this id, as "wall 'chute'"; "" for a grain."""
    first = scene.n_grain + scene.n_fixed
    if partner >= first + scene.n_plane and scene.walls is not None:
        return f"wall '{scene.walls.names[int(scene.walls.wall[partner - first - scene.n_plane])]}'"
    if partner >= first:
        for name, ids in scene.groups.items():
            if ids == (partner, partner + 1):
                return f"plane '{name}'"
    return ""


def unsafe_of(grains: Any, n: int, parameters: Floats, smallest: float, step: int, t: float) -> ListUnsafe:
    """The fastest grain, which went too far in one step."""
    speed = np.linalg.norm(grains.v[:n, :3], axis=1)
    place = int(speed.argmax())
    way, own = speed[place] * parameters[P.DT], 2.0 * grains.x[place, 3]
    found = f"a grain moves {way / own:.2g} diameters in one step ({speed[place]:.3g} m/s)"
    if own > 1.001 * smallest:
        found += f", {way / smallest:.2g} diameters of the smallest grain of the scene ({smallest:.3g} m)"
    return ListUnsafe(
        found,
        grain=int(grains.ids[place]),
        step=step,
        t=t,
        hint="At this speed it could pass through another grain between two steps. Most likely the step "
        "is too long for a contact that accelerated it: raise time.steps_per_contact, which shortens the "
        "step, and inspect the frames before.",
    )


def lost_of(grains: Any, law: ContactLaw, grain: int, step: int, t: float) -> GrainLost:
    """Error of a grain that has left the domain."""
    place = int(np.flatnonzero(grains.ids == grain)[0])
    where = ", ".join(f"{a:.4g}" for a in grains.x[place, :3])
    hint = (
        "It flew, rolled or fell out, through a gap or a bed too soft to hold it: close the gap, increase "
        f"{stiffness_key(law)}, or widen domain.low and domain.high."
    )
    return GrainLost(f"a grain left the world at ({where}) m", grain=grain, step=step, t=t, hint=hint)
