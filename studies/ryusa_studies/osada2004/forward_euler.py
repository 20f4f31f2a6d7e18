"""Forward differences in time, Eqs. (1)-(7) as printed: not for runs, but what they are held against."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.shared.kernel import kernel
from ryusa.laws.collision import (
    effective_mass,
    effective_mass_tangential,
    shortest_contact,
    zeta_for_restitution,
)
from ryusa.laws.contact import damping, shear_strength, slide
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total
from ryusa.laws.motion import acceleration, acceleration_spin, forward_euler, inertia_sphere
from ryusa.model import Scene

Floats = NDArray[np.float64]


def step(scene: Scene, steps: float, k_n: float = math.nan) -> float:
    """Time step with so many steps in the shortest contact, between two free grains [s].

    Parameters
    ----------
    scene : equal grains.
    steps : steps in that contact [-].
    k_n : another stiffness than that of the scene [N/m].
    """
    law = scene.contact
    stiffness = law.k_n if math.isnan(k_n) else k_n
    return shortest_contact(float(scene.m[0]) / 2.0, stiffness, _zeta(scene), law.tension) / steps


def integrate(
    scene: Scene, x: Floats, dt: float, end: float, every: float, *, summed: bool
) -> tuple[Floats, Floats]:
    """Times of frames [s], shape (n_frame,), and centres [m], shape (n_frame, n_grain, 3).

    Parameters
    ----------
    scene : equal grains in a plane among fixed ones of the same size; dry, no cohesion.
    x : first centres [m], shape (n_grain, 3); the grains start at rest.
    dt, end, every : time step, time of the last frame, and between frames [s].
    summed : the spring is the sum of k_n v dt, Eq. (1) as printed; else it is read from the overlap.

    Notes
    -----
    Position moves with the velocity, and velocity with the force, of the beginning of the step. A contact
    begins and ends with the overlap, Eq. (12); its springs are forgotten at its end.
    """
    law, d, m = scene.contact, float(scene.d[0]), float(scene.m[0])
    skip = max(round(every / dt), 1)
    frames = np.zeros((math.ceil(end / (skip * dt)) + 1, len(x), 3))
    places = np.concatenate([x[:, ::2], scene.x_fixed[:, ::2]])
    weight = m * float(-scene.gravity[2])
    _fill(
        frames, places, d, m, law.k_n, law.k_s, _zeta(scene), law.zeta_s, law.mu, weight, dt, skip, summed,
        law.tension, scene.rotation,
        (slip_total(int(law.slip)), slip_drops(int(law.slip)), cap_total(int(law.cap))),
    )  # fmt: skip
    return skip * dt * np.arange(len(frames), dtype=np.float64), frames


def _zeta(scene: Scene) -> float:
    law = scene.contact
    return zeta_for_restitution(law.e_n, law.tension)


@kernel()
def restitution(overlap: float, zeta: float, dt: float, n_steps: int, summed: bool, tension: bool) -> float:
    """Restitution of one contact [-]; nan if it has not ended after so many steps.

    Parameters
    ----------
    overlap : at the start [-], at most 0; mass, natural frequency and closing speed are 1.
    zeta : damping ratio [-].
    dt : time step, in units of one over the natural frequency [-].
    summed : the spring is the sum of k_n v dt over the steps in touch; else it is read from the overlap.
    tension : whether the dashpot may pull.
    """
    closing, spring, touched = 1.0, 0.0, False
    for _ in range(n_steps):
        touch = overlap > 0.0
        if touched and not touch:
            return -closing
        force = 0.0
        if touch:
            touched = True
            spring = spring + closing * dt if summed else overlap
            force = spring + 2.0 * zeta * closing
            if not tension:
                force = max(force, 0.0)
        overlap, closing = forward_euler(overlap, closing, -force, dt)
    return math.nan


@kernel()
def _fill(
    frames: Any,
    x: Any,
    d: float,
    m: float,
    k_n: float,
    k_s: float,
    zeta: float,
    zeta_s: float,
    mu: float,
    weight: float,
    dt: float,
    skip: int,
    summed: bool,
    tension: bool,
    free: bool,
    rules: tuple[bool, bool, bool],
) -> None:
    """Fill the frames, shape (n_frame, n, 3); the first n rows of x, shape (n + n_fixed, 2), are free."""
    total, drop, whole = rules
    n, inertia, r = frames.shape[1], inertia_sphere(m, d), 0.5 * d
    spring_n, spring_s = np.zeros((n, len(x))), np.zeros((n, len(x)))
    v, force = np.zeros((len(x), 2)), np.zeros((len(x), 2))
    omega, torque = np.zeros(len(x)), np.zeros(len(x))
    for frame in range(len(frames)):
        frames[frame, :, 0], frames[frame, :, 2] = x[:n, 0], x[:n, 1]
        for _ in range(skip):
            force[:], torque[:] = 0.0, 0.0
            force[:n, 1] = -weight
            for i in range(n):
                for j in range(i + 1, len(x)):
                    a, b = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1]
                    square = a * a + b * b
                    if square >= d * d:
                        spring_n[i, j], spring_s[i, j] = 0.0, 0.0
                        continue
                    distance = math.sqrt(square)
                    a, b = a / distance, b / distance  # normal from i to j; (b, -a) is along the contact
                    m_j, inertia_j = (m, inertia) if j < n else (math.inf, math.inf)
                    m_n = m_t = effective_mass(m, m_j)
                    if free:
                        m_t = effective_mass_tangential(m, r, inertia, m_j, r, inertia_j, True)
                    eta_n, eta_s = damping(zeta, k_n, m_n), damping(zeta_s, k_s, m_t)
                    u, w = v[i, 0] - v[j, 0], v[i, 1] - v[j, 1]
                    closing = u * a + w * b
                    slip = u * b - w * a + r * (omega[i] + omega[j])
                    spring_n[i, j] = spring_n[i, j] + k_n * closing * dt if summed else k_n * (d - distance)
                    f_n = spring_n[i, j] + eta_n * closing
                    spring, dash = spring_s[i, j] + k_s * slip * dt, eta_s * slip
                    tau_c = shear_strength(f_n if whole else spring_n[i, j], 0.0, mu)
                    keep, give, rest = slide(abs(spring + dash) if total else abs(spring), tau_c, drop, total)
                    spring_s[i, j] = keep * spring + give * dash
                    f_s = spring_s[i, j] + rest * dash
                    if f_n <= 0.0 and not tension:
                        f_n, f_s = 0.0, 0.0
                    f_x, f_z = f_n * a + f_s * b, f_n * b - f_s * a
                    force[i, 0] -= f_x
                    force[i, 1] -= f_z
                    force[j, 0] += f_x
                    force[j, 1] += f_z
                    torque[i] -= r * f_s
                    torque[j] -= r * f_s
            for i in range(n):
                for axis in range(2):
                    a = acceleration(force[i, axis], 0.0, 0.0, 1.0 / m)
                    x[i, axis], v[i, axis] = forward_euler(x[i, axis], v[i, axis], a, dt)
                if free:
                    omega[i] += acceleration_spin(torque[i], 1.0 / inertia) * dt
