"""Assembles the scene and the initial state from placement and laws."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from ryusa.build.placement import Placement, mask, unit_normal
from ryusa.laws import drag, motion
from ryusa.laws.families import Profile
from ryusa.model import Column, ColumnRow, ContactLaw, RollingLaw, Scene, State, Water
from ryusa.model.scene import EventRule, Floats


@dataclass(frozen=True)
class Laws:
    """Parameters of a scene beyond the placement of its grains, SI."""

    density: float | Floats  # of grains, or of each of them [kg/m3]
    contact: ContactLaw
    dt: float  # [s]
    a_3: float = math.pi / 6  # volume over d cubed [-]
    rolling: RollingLaw = field(default_factory=RollingLaw)
    water: Water = field(default_factory=Water)
    column: Column | None = None  # where the profile is COLUMN
    row: ColumnRow | None = None  # columns in a row instead
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
    """Mass, added mass, submerged mass [kg] and moment of inertia [kg m2] for diameters d [m]."""
    volume = np.array([drag.volume(one, a_3) for one in d.tolist()])
    m = density * volume
    inertia = np.array([motion.inertia_sphere(*one) for one in zip(m.tolist(), d.tolist(), strict=True)])
    if water.profile == Profile.NONE:
        return m, np.zeros_like(d), m.copy(), inertia
    m_added = np.array([drag.added_mass(water.rho_w, water.c_m, one) for one in volume.tolist()])
    return m, m_added, m - water.rho_w * volume, inertia


def assemble(placement: Placement, laws: Laws) -> tuple[Scene, State]:
    """Assemble scene and initial state from placement and laws; every array is read-only."""
    n = len(placement.d)
    m, m_added, m_weight, inertia = masses(placement.d, laws.density, laws.a_3, laws.water)
    low, high = placement.box()
    walls = placement.walls
    scene = Scene(
        d=read_only(placement.d),
        m=read_only(m),
        m_added=read_only(m_added),
        m_weight=read_only(m_weight),
        inertia=read_only(inertia),
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
        column=laws.column,
        row=laws.row,
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
