import math

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import Cap, ContactTiming, Slip
from ryusa.model import ContactLaw, Scene, State
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.scene import EventRule

D = 2.0e-3  # [m]


def run(made, n_steps, threads=1):
    """Load, step, and hand the engine back; a fault fails the test."""
    engine = CpuEngine(threads=threads)
    engine.load(*made)
    engine.advance(n_steps).raise_if_any()
    return engine


def momentum(scene, state):
    """Momentum [kg m/s] and angular momentum [kg m2/s] of all grains."""
    p = scene.m[:, None] * state.v
    return p.sum(axis=0), (np.cross(state.x, p) + scene.inertia[:, None] * state.omega).sum(axis=0)


def split_square(n, size, tilt=0.0, z=0.0):
    """Corners of 2 n**2 triangles over a square of a size, tilted about y."""
    g = np.linspace(-0.5 * size, 0.5 * size, n + 1)
    x, y = np.meshgrid(g, g, indexing="ij")
    p = np.stack([x * math.cos(tilt), y, z - x * math.sin(tilt)], axis=-1)
    a, b, c, e = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, e], axis=2)]).reshape(-1, 3, 3)


def bits(state: State) -> tuple[bytes, ...]:
    contacts = state.contacts
    return tuple(
        np.ascontiguousarray(a).tobytes()
        for a in (
            state.x,
            state.v,
            state.omega,
            state.image,
            *((state.engine.arrays[name] for name in sorted(state.engine.arrays)) if state.engine else ()),
            contacts.i,
            contacts.j,
            contacts.spring_s,
            contacts.dash_s,
            contacts.dash_n,
            contacts.overlap,
            contacts.spring_r,
            contacts.event,
        )
    )


def pile(
    n=400,
    plane_case=False,
    seed=3,
    spread=0.15,
    friction=0.5,
    events=EventRule.ALL,
    stir=0.4,
    timing=ContactTiming.AT_STEPS,
    **more,
) -> tuple[Scene, State]:
    """A loose block of mixed grains over a rough bed, periodic downslope, stirred and about to fall."""
    rng = np.random.default_rng(seed)
    pitch = 1.01 * D * (1.0 + spread)
    if plane_case:
        wide, deep, high = n // 8, 1, 8
    else:
        side = max(4, round((n / 6) ** 0.5))
        wide, deep, high = side, side, 6
    a, b, c = (
        g.ravel() for g in np.meshgrid(np.arange(wide), np.arange(deep), np.arange(high), indexing="ij")
    )
    x = np.column_stack([a * pitch, b * pitch, (c + 1.2) * pitch])
    d = D * (1.0 + spread * rng.uniform(-1.0, 1.0, len(x)))
    l_x, l_y = wide * pitch, deep * pitch
    m_x, m_y = int(l_x / D), max(1, int(l_y / D))
    p, q = (g.ravel() for g in np.meshgrid(np.arange(m_x), np.arange(m_y), indexing="ij"))
    bed = np.column_stack([p * l_x / m_x, q * l_y / m_y, rng.uniform(-0.2, 0.2, len(p)) * D])
    if plane_case:
        x[:, 1] = bed[:, 1] = 0.0
    v = rng.normal(0.0, stir, x.shape)
    if plane_case:
        v[:, 1] = 0.0
    return scene(
        x,
        d,
        v=v,
        x_fixed=bed,
        d_fixed=D,
        friction=friction,
        slope=math.radians(25.0),
        plane_case=plane_case,
        period=(l_x, math.inf if plane_case else l_y),
        allow_overlap=True,
        events=events,
        timing=timing,
        **more,
    )


def contact_law(
    k_n=1.0e4,
    ratio=2.0 / 7.0,
    mu=0.5,
    zeta_n=0.1,
    zeta_s=0.0,
    slip=Slip.SPRING,
    cap=None,
    tension=False,
    cohesion=0.0,
    timing=ContactTiming.AT_STEPS,
):
    cap = (Cap.TOTAL if slip == Slip.TOTAL else Cap.SPRING) if cap is None else cap
    return ContactLaw(
        k_n=k_n,
        k_s=ratio * k_n,
        mu=mu,
        zeta_n=zeta_n,
        zeta_s=zeta_s,
        slip=slip,
        cap=cap,
        tension=tension,
        cohesion=cohesion,
        timing=timing,
    )


M = 2650.0 * math.pi / 6.0 * D**3  # [kg]


def elastic_law(speed=0.5, youngs_modulus=1.0e8, m=M, r=0.25 * D, **more):
    """Elastic spheres of the size of this room: a grain on a fixed one, unless told otherwise."""
    return elastic_spheres(m, r, youngs_modulus=youngs_modulus, speed=speed, **more)


@pytest.fixture
def diameter() -> float:
    return D
