"""The 42 grains of fig9 by forward differences in time, Eqs. (1)-(7) as printed; fig10 alone uses this."""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from numba import njit

from ryusa.laws.collision import shortest_contact, zeta_no_tension, zeta_tension
from ryusa.measure import Vibration, vibration
from ryusa.measure.statistics import Floats
from ryusa.model import Scene
from ryusa.results import Results


def step(scene: Scene, steps: float, k_n: float = math.nan) -> float:
    """Time step with so many steps in the shortest contact, between two free grains [s]."""
    zeta = (zeta_tension if scene.contact.tension else zeta_no_tension)(scene.contact.e_n)
    stiffness = scene.contact.k_n if math.isnan(k_n) else k_n
    return shortest_contact(float(scene.m[0]) / 2.0, stiffness, zeta, scene.contact.tension) / steps


def again(run: Results, dt: float, *, summed: bool) -> Vibration:
    """Motion within windows of 0.01 s of the grains of a run, from the same first places on.

    Parameters
    ----------
    run : equal grains in a plane among fixed ones of the same size; dry, slip rule "spring", no cohesion.
    dt : time step [s].
    summed : the spring is the sum of k_n v dt, Eq. (1) as printed; else it is read from the overlap.
    """
    scene, frames = run.scene, run.frames
    every, end = float(np.median(np.diff(frames.t))), float(frames.t[-1])
    t, x = forward(scene, np.asarray(frames.x[0]), dt, end, every, summed=summed)
    moved = SimpleNamespace(t=t, x=x, omega=np.zeros_like(x))
    return vibration(cast(Any, SimpleNamespace(scene=scene, frames=moved)))


def forward(
    scene: Scene, x: Floats, dt: float, end: float, every: float, *, summed: bool
) -> tuple[Floats, Floats]:
    """Times of frames [s], shape (n_frame,), and centres [m], shape (n_frame, n_grain, 3).

    Notes
    -----
    Position moves with the velocity, and velocity with the force, of the beginning of the step. A contact
    begins and ends with the overlap, Eq. (12); its springs are forgotten at its end.
    """
    law, d, m = scene.contact, float(scene.d[0]), float(scene.m[0])
    zeta = (zeta_tension if law.tension else zeta_no_tension)(law.e_n)
    skip = max(round(every / dt), 1)
    frames = np.zeros((math.ceil(end / (skip * dt)) + 1, len(x), 3))
    places = np.concatenate([x[:, ::2], scene.x_fixed[:, ::2]])
    weight = m * float(-scene.gravity[2])
    _march(
        frames, places, d, m, law.k_n, law.k_s, zeta, law.zeta_s, law.mu, weight, dt, skip, summed,
        law.tension, scene.rotation,
    )  # fmt: skip
    return skip * dt * np.arange(len(frames), dtype=np.float64), frames


@njit(cache=True, error_model="numpy")
def _march(frames, x, d, m, k_n, k_s, zeta, zeta_s, mu, weight, dt, skip, summed, tension, free):  # type: ignore[no-untyped-def]
    """Fill the frames, shape (n_frame, n, 3); the first n rows of x, shape (n + n_fixed, 2), are free."""
    n, inertia = frames.shape[1], m * d * d / 10.0
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
                    m_n = 0.5 * m if j < n else m  # effective masses of the pair
                    m_s = m_n / 3.5 if free else m_n
                    u, w = v[i, 0] - v[j, 0], v[i, 1] - v[j, 1]
                    closing = u * a + w * b
                    slip = u * b - w * a + 0.5 * d * (omega[i] + omega[j])
                    spring_n[i, j] = spring_n[i, j] + k_n * closing * dt if summed else k_n * (d - distance)
                    f_n = spring_n[i, j] + 2.0 * zeta * math.sqrt(k_n * m_n) * closing
                    tau_c = max(mu * spring_n[i, j], 0.0)
                    spring_s[i, j] = min(max(spring_s[i, j] + k_s * slip * dt, -tau_c), tau_c)
                    f_s = spring_s[i, j] + 2.0 * zeta_s * math.sqrt(k_s * m_s) * slip
                    if f_n <= 0.0 and not tension:
                        f_n, f_s = 0.0, 0.0
                    f_x, f_z = f_n * a + f_s * b, f_n * b - f_s * a
                    force[i, 0] -= f_x
                    force[i, 1] -= f_z
                    force[j, 0] += f_x
                    force[j, 1] += f_z
                    torque[i] -= 0.5 * d * f_s
                    torque[j] -= 0.5 * d * f_s
            for i in range(n):
                for axis in range(2):
                    x[i, axis] += v[i, axis] * dt
                    v[i, axis] += force[i, axis] / m * dt
                if free:
                    omega[i] += torque[i] / inertia * dt
