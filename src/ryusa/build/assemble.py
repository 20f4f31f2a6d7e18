"""Assembles the scene and the initial state from placement and laws."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ryusa.build.placement import Placement, mask, unit_normal
from ryusa.laws import drag, motion
from ryusa.laws.families import Profile
from ryusa.model import ContactLaw, Flow, RollingLaw, Scene, State, Water
from ryusa.model.scene import EventRule, Floats

_AT_ONCE = 1 << 14  # grains


@dataclass(frozen=True)
class Laws:
    """Parameters of a scene beyond the placement of its grains, SI."""

    density: float | Floats  # of grains, or of each of them [kg/m3]
    contact: ContactLaw
    dt: float  # [s]
    a_3: float = math.pi / 6  # volume over d cubed [-]
    rolling: RollingLaw = field(default_factory=RollingLaw)
    water: Water = field(default_factory=Water)
    flow: Flow | None = None  # where the profile is COLUMN
    g: float = 9.80665  # [m/s2]
    slope: float = 0.0  # [rad], down towards +x
    rotation: bool = True
    plane_case: bool = False
    slab_width: float = math.nan  # [m]
    overlap_limit: float = 0.5
    events: EventRule = EventRule.ALL
    forces: bool = False
    tracked: tuple[int, ...] = ()
    low: tuple[float, float, float] | None = None  # [m]; None takes the default box
    high: tuple[float, float, float] | None = None


def gravity(g: float, slope: float) -> Floats:
    """Gravity on a bed of slope [rad], down towards +x [m/s2]."""
    return np.array([g * math.sin(slope), 0.0, -g * math.cos(slope)])


def masses(
    d: Floats, density: float | Floats, a_3: float, water: Water
) -> tuple[Floats, Floats, Floats, Floats]:
    """Mass, added mass, submerged mass [kg] and moment of inertia [kg m2] for diameters d [m].

    All are read-only. Where grains are dry their submerged mass is their mass, in one array.
    """
    volume = _by_grain(lambda one: drag.volume(one, a_3), d)
    m = _frozen(density * volume)
    inertia = _by_grain(motion.inertia_sphere, m, d)
    if water.profile == Profile.NONE:
        return m, _frozen(np.zeros_like(d)), m, inertia
    m_added = _by_grain(lambda one: drag.added_mass(water.rho_w, water.c_m, one), volume)
    return m, m_added, _frozen(m - water.rho_w * volume), inertia


def _by_grain(law: Callable[..., float], *columns: Floats) -> Floats:
    """A scalar law for every grain, read-only; some at a time, since a number of Python takes 32 bytes."""
    n = len(columns[0])
    found = np.empty(n)
    for k in range(0, n, _AT_ONCE):
        rows = zip(*(one[k : k + _AT_ONCE].tolist() for one in columns), strict=True)
        found[k : k + _AT_ONCE] = [law(*row) for row in rows]
    return _frozen(found)


def _frozen(array: Floats) -> Floats:
    """The same array, which nobody can write to from now on."""
    array.flags.writeable = False
    return array


def assemble(placement: Placement, laws: Laws) -> tuple[Scene, State]:
    """Assemble scene and initial state from placement and laws; every array is read-only."""
    n = len(placement.d)
    m, m_added, m_weight, inertia = masses(placement.d, laws.density, laws.a_3, laws.water)
    low, high = placement.box()
    walls = placement.walls
    scene = Scene(
        d=read_only(placement.d),
        m=m,
        m_added=m_added,
        m_weight=m_weight,
        inertia=inertia,
        x_fixed=read_only(placement.x_fixed.reshape(-1, 3)),
        d_fixed=read_only(placement.d_fixed),
        fixed_active=read_only(np.ones(len(placement.d_fixed), dtype=np.bool_)),
        plane_normal=read_only(
            np.array([unit_normal(wall) for wall in walls], dtype=np.float64).reshape(-1, 3)
        ),
        plane_point=read_only(np.array([wall.point for wall in walls], dtype=np.float64).reshape(-1, 3)),
        plane_active=read_only(np.ones(len(walls), dtype=np.bool_)),
        contact=laws.contact,
        dt=laws.dt,
        gravity=read_only(gravity(laws.g, laws.slope)),
        rolling=laws.rolling,
        rotation=laws.rotation,
        water=laws.water,
        flow=laws.flow,
        plane_case=laws.plane_case,
        period=placement.period,
        world_low=laws.low or low,
        world_high=laws.high or high,
        slab_width=laws.slab_width,
        overlap_limit=laws.overlap_limit,
        events=laws.events,
        forces=laws.forces,
        tracked=read_only(mask(n, laws.tracked)),
        groups=placement.groups(),
    )
    x = placement.x.astype(np.float64, copy=True)
    image = np.zeros((n, 2), dtype=np.int32)
    for axis in (0, 1):
        period = placement.period[axis]
        if math.isfinite(period):
            turns = np.floor(x[:, axis] / period)
            x[:, axis] -= turns * period
            image[:, axis] = turns
    state = State.at_rest(x)
    state = replace(
        state,
        x=read_only(state.x),
        v=read_only(placement.v),
        omega=read_only(placement.omega),
        image=read_only(image),
    )
    return scene, state


def read_only(array: np.ndarray) -> np.ndarray:
    """A copy that cannot be written to."""
    array = np.ascontiguousarray(array).copy()
    array.flags.writeable = False
    return array
