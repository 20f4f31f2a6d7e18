"""Arrays of a scene and a state by id, in rows of four doubles: what engines start from."""

from typing import NamedTuple

import numpy as np

from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.variant import KernelVariant
from ryusa.laws.families import ContactForce, ContactTiming, Profile, Rebound
from ryusa.model import FluidAtGrains, Scene, State
from ryusa.model.arrays import Bools
from ryusa.model.scene import Damping, Floats


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
        self.n, self.n_solid, self.variant = scene.n_grain, scene.n_grain + scene.n_fixed, variant
        self.n_total = scene.n_partner
        self.largest = float(max(scene.d.max(initial=0.0), scene.d_fixed.max(initial=0.0)))
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
        self.active_fixed = np.flatnonzero(scene.fixed_active).astype(np.int32)

    # Arrays by id are made when they are asked for: an engine keeps its own, in its own order.

    @property
    def r(self) -> Floats:
        """Radii [m], inf of planes and faces, (n_total,)."""
        scene = self.scene
        return np.concatenate([0.5 * scene.d, 0.5 * scene.d_fixed, self._infinite(self.n_solid)])

    @property
    def m(self) -> Floats:
        """Masses with added mass that contacts see, of members those of their body [kg], (n_total,)."""
        scene = self.scene
        m = np.concatenate([scene.m + scene.m_added, self._infinite(self.n)])
        if (bodies := scene.bodies) is not None:
            whole = bodies.m + bodies.sums(scene.m_added[bodies.members])
            m[bodies.members] = np.repeat(whole, bodies.count)
        return m

    @property
    def inertia(self) -> Floats:
        """Moments of inertia that contacts see [kg m2], (n_total,)."""
        inertia = np.concatenate([self.scene.inertia, self._infinite(self.n)])
        if (bodies := self.scene.bodies) is not None:
            inertia[bodies.members] = np.repeat(bodies.inertia.mean(axis=1), bodies.count)
        return inertia

    @property
    def tracked(self) -> Bools:
        """Whether contacts of a grain are recorded where not all are, (n,)."""
        kept = self.scene.tracked
        return kept if len(kept) == self.n else np.zeros(self.n, np.bool_)

    def _infinite(self, first: int) -> Floats:
        return np.full(self.n_total - first, np.inf)

    def by_id(self, state: State) -> StateArrays:
        """Arrays of a state, in the order of ids."""
        n, scene, r = self.n, self.scene, self.r
        still = np.zeros((len(r) - n, 3))
        image = np.array(state.image, dtype=np.int32) if len(state.image) == n else np.zeros((n, 2), np.int32)
        spin = state.omega if scene.rotation else np.zeros((n, 3))
        none = FluidAtGrains(np.zeros((0, 0)), np.zeros((0, 0)))
        if scene.water.profile == Profile.COLUMN:
            none = FluidAtGrains.at_rest(n)
        fluid = state.fluid or none
        both = zeros(np.float64, len(r), 8)
        x, v, w = zeros(np.float64, len(r), 4), both[:, :4], both[:, 4:]
        x[:, :3] = np.vstack([state.x, self.x_fixed, still[len(self.x_fixed) :]])
        v[:n, :3], w[:n, :3] = state.v, spin
        x[:, 3] = w[:, 3] = r
        return StateArrays(x, v, w, image, np.array(fluid.sampled), np.array(fluid.impulse))


def film_reach(scene: Scene) -> float:
    """Gap below which films resist [m]; 0 where there are none."""
    return 0.0 if scene.water.profile == Profile.NONE else scene.water.film_reach
