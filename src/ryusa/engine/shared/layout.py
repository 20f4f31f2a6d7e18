"""Arrays of a scene and a state by id, in rows of four doubles: what engines start from."""

import math
from typing import NamedTuple

import numpy as np

from ryusa.engine.shared.variant import KernelVariant
from ryusa.laws.families import ContactForce, ContactTiming, Profile, Rebound
from ryusa.model import FluidAtGrains, Scene, State
from ryusa.model.scene import Damping, Floats

_CACHE_LINE = 64  # [B]


def aligned(*shape: int) -> Floats:
    """Zeros that begin at a cache line: rows of eight doubles then take one line each, not two."""
    size = 8 * math.prod(shape)
    raw = np.zeros(size + _CACHE_LINE, np.uint8)
    first = -raw.ctypes.data % _CACHE_LINE
    return raw[first : first + size].view(np.float64).reshape(shape)


class StateArrays(NamedTuple):
    """A state by id, ready to be put in the order of an engine. Rows have four columns."""

    x: Floats  # centres [m] and radius [m], (n_total, 4); inf the radius of planes
    v: Floats  # velocities [m/s] and 0, (n_total, 4); zero beyond n
    w: Floats  # spins [rad/s] and radius [m], (n_total, 4); beside `v` in one cache line
    image: np.ndarray  # periods crossed, int32, (n, 2)
    fluid: Floats  # sampled at each grain, columns of model.fluid, (n, N_SAMPLED); (0, 0) without a column
    impulse: Floats  # from the fluid [N s], and drag over slip, (n, N_IMPULSE); (0, 0) without


class Layout:
    """What engines need of a scene, by id: n free grains, n_solid with fixed ones, n_total with walls."""

    def __init__(self, scene: Scene, variant: KernelVariant) -> None:
        n, n_fixed, n_plane = scene.n_grain, scene.n_fixed, scene.n_plane + scene.n_face
        self.n, self.n_solid, self.variant = n, n + n_fixed, variant
        inf = np.full(n_fixed + n_plane, np.inf)
        self.r = np.concatenate([0.5 * scene.d, 0.5 * scene.d_fixed, np.full(n_plane, np.inf)])
        self.largest = 2.0 * float(self.r[: self.n_solid].max(initial=0.0))
        self.m = np.concatenate([scene.m + scene.m_added, inf])
        self.inertia = np.concatenate([scene.inertia, inf])
        if (bodies := scene.bodies) is not None:  # contacts see the body
            whole = bodies.m + bodies.sums(scene.m_added[bodies.members])
            self.m[bodies.members] = np.repeat(whole, bodies.count)
            self.inertia[bodies.members] = np.repeat(bodies.inertia.mean(axis=1), bodies.count)
        self.tracked = scene.tracked if len(scene.tracked) == n else np.zeros(n, np.bool_)
        law, water = scene.contact, scene.water
        constant = law.damping == Damping.CONSTANTS and law.timing == ContactTiming.AT_STEPS
        constant = constant and law.force == ContactForce.LINEAR
        self.many_dashpots = not constant or water.rebound != Rebound.DRY or scene.materials is not None
        self.period, self.scene = np.array(scene.period), scene
        self.low, self.high = np.array(scene.world_low), np.array(scene.world_high)
        self.plane_normals = np.ascontiguousarray(scene.plane_normal, dtype=np.float64).reshape(-1, 3)
        self.plane_points = np.ascontiguousarray(scene.plane_point, dtype=np.float64).reshape(-1, 3)
        # fixed grains are listed from where they stand inside the period
        self.x_fixed = np.array(scene.x_fixed, dtype=np.float64).reshape(-1, 3)
        for k in np.flatnonzero(np.isfinite(self.period)):
            self.x_fixed[:, k] %= self.period[k]
        self.standing = np.flatnonzero(scene.fixed_active)

    def by_id(self, state: State) -> StateArrays:
        """Arrays of a state, in the order of ids."""
        n, scene = self.n, self.scene
        still = np.zeros((len(self.r) - n, 3))
        image = np.array(state.image, dtype=np.int32) if len(state.image) == n else np.zeros((n, 2), np.int32)
        spin = state.omega if scene.rotation else np.zeros((n, 3))
        none = FluidAtGrains(np.zeros((0, 0)), np.zeros((0, 0)))
        if scene.water.profile == Profile.COLUMN:
            none = FluidAtGrains.at_rest(n)
        fluid = state.fluid or none
        both = aligned(len(self.r), 8)
        x, v, w = aligned(len(self.r), 4), both[:, :4], both[:, 4:]
        x[:, :3] = np.vstack([state.x, self.x_fixed, still[len(self.x_fixed) :]])
        v[:n, :3], w[:n, :3] = state.v, spin
        x[:, 3] = w[:, 3] = self.r
        return StateArrays(x, v, w, image, np.array(fluid.sampled), np.array(fluid.impulse))


def film_reach(scene: Scene) -> float:
    """Gap below which films resist [m]; 0 where there are none."""
    return 0.0 if scene.water.profile == Profile.NONE else scene.water.film_reach
