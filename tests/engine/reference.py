"""The step again, written plainly: every pair, no list, numpy vectors. Slow and independent of the engine."""

import math

import numpy as np

from ryusa.laws import drag, torque, water
from ryusa.laws.families import Slip
from ryusa.model import Scene, State


def accelerations(fixed: Scene, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations [m/s2] and angular ones [rad/s2] at a snapshot, to the letter of the paper."""
    law, n, dt = fixed.contact, fixed.n_grain, fixed.dt
    x = np.vstack([state.x, fixed.x_fixed])
    v = np.vstack([state.v, np.zeros_like(fixed.x_fixed)])
    w = np.vstack([state.omega, np.zeros_like(fixed.x_fixed)])
    r = 0.5 * np.concatenate([fixed.d, fixed.d_fixed])
    m = np.concatenate([fixed.m + fixed.m_added, np.full(fixed.n_fixed, np.inf)])
    inertia = np.concatenate([fixed.inertia, np.full(fixed.n_fixed, np.inf)])
    force, moment = np.zeros((n, 3)), np.zeros((n, 3))
    known = {(i, j): k for k, (i, j) in enumerate(zip(state.contacts.i, state.contacts.j, strict=True))}
    for i in range(n):
        for j in range(i + 1, len(x)):
            apart = x[j] - x[i]
            for axis, period in enumerate(fixed.period):
                if math.isfinite(period):
                    apart[axis] -= period * round(apart[axis] / period)
            distance = float(np.linalg.norm(apart))
            overlap = r[i] + r[j] - distance
            if overlap <= 0.0:
                continue
            normal = apart / distance
            arm_i, arm_j = r[i] - 0.5 * overlap, distance - r[i] + 0.5 * overlap
            u = v[i] - v[j] + np.cross(arm_i * w[i] + arm_j * w[j], normal)
            closing = float((v[i] - v[j]) @ normal)
            slip = u - closing * normal
            m_n = 1.0 / (1.0 / m[i] + 1.0 / m[j])
            m_t = 1.0 / (1.0 / m[i] + 1.0 / m[j] + r[i] ** 2 / inertia[i] + r[j] ** 2 / inertia[j])
            eta_n = lagged(2.0 * law.zeta_n * math.sqrt(law.k_n * m_n), m_n, dt)
            eta_s = lagged(2.0 * law.zeta_s * math.sqrt(law.k_s * m_t), m_t, dt)
            spring_n = law.k_n * overlap
            f_n = max(0.0, spring_n + eta_n * closing)
            spring = np.zeros(3)
            if (i, j) in known:
                kept = state.contacts.spring_s[known[i, j]]
                if fixed.plane_case:  # one component along (n_z, 0, -n_x)
                    spring = kept[0] * np.array([normal[2], 0.0, -normal[0]])
                else:
                    spring = carried(kept, normal, 0.5 * dt * float((w[i] + w[j]) @ normal))
            spring = spring - law.k_s * slip * dt
            dash = -eta_s * slip
            tau_c = law.cohesion + law.mu * (f_n if law.slip == Slip.TOTAL else spring_n)
            if law.slip == Slip.TOTAL:
                total = spring + dash
                size = float(np.linalg.norm(total))
                tangential = total * (tau_c / size) if size > tau_c else total
            else:
                size = float(np.linalg.norm(spring))
                if size > tau_c:
                    spring = spring * (tau_c / size)
                    if law.slip == Slip.SPRING_DROP:
                        dash = np.zeros(3)
                tangential = spring + dash
            if f_n == 0.0:
                tangential = np.zeros(3)
            pair = tangential - f_n * normal
            turning = np.cross(normal, tangential)
            force[i] += pair
            moment[i] += arm_i * turning
            if j < n:
                force[j] -= pair
                moment[j] += arm_j * turning
    for i in range(n):
        wet = fixed.water
        if wet.profile:
            speed = water.log_law_rough(state.x[i, 2] - wet.z_zero, wet.u_star, wet.k_rough)
            u = np.array([speed, 0.0, 0.0]) - state.v[i]
            size = float(np.linalg.norm(u))
            c_d = drag.c_d_re_04(drag.reynolds(size, fixed.d[i], wet.nu))
            force[i] += 0.5 * wet.rho_w * c_d * wet.a_2 * fixed.d[i] ** 2 * size * u
            spin = float(np.linalg.norm(state.omega[i]))
            moment[i] -= torque.torque_dennis(spin, fixed.d[i], wet.nu, wet.rho_w) * state.omega[i]
    force += fixed.m_weight[:, None] * fixed.gravity
    return force / (fixed.m + fixed.m_added)[:, None], moment / fixed.inertia[:, None]


def lagged(eta: float, m: float, dt: float) -> float:
    """Dashpot that damps like eta when it sees a velocity half a step old, to second order."""
    eps = eta * dt / m
    return eta * (1.0 - 0.25 * eps + 5.0 / 32.0 * eps * eps)


def carried(spring: np.ndarray, normal: np.ndarray, twist: float) -> np.ndarray:
    """A tangential vector laid into the new tangent plane, its length kept."""
    size = float(np.linalg.norm(spring))
    if size == 0.0:
        return spring
    turned = spring + twist * np.cross(normal, spring)
    turned = turned - float(turned @ normal) * normal
    return turned * (size / float(np.linalg.norm(turned)))


def touching_pairs(fixed: Scene, state: State) -> set[tuple[int, int]]:
    """Pairs (i, j) in touch, i a free grain and the lower id, by a search of all pairs; no planes."""
    x, r = np.vstack([state.x, fixed.x_fixed]), 0.5 * np.concatenate([fixed.d, fixed.d_fixed])
    apart = x[:, None] - x[None]
    for axis, period in enumerate(fixed.period):
        if math.isfinite(period):
            apart[..., axis] -= period * np.round(apart[..., axis] / period)
    touching = np.linalg.norm(apart, axis=2) < r[:, None] + r[None]
    return {(i, j) for i, j in zip(*np.nonzero(np.triu(touching, 1)), strict=True) if i < fixed.n_grain}
