"""One pair whose contact begins and ends within steps (design/0014), as `pair.py` for contacts at steps."""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import APART, BEGAN, ENDING, HELD, instant_step, may_end
from ryusa.engine.shared.dashpots import spring_immersed
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.collision import effective_mass, effective_mass_tangential
from ryusa.laws.contact import normal_force
from ryusa.laws.contact_step import contact_force, tangential_step
from ryusa.laws.families import Cap, Slip
from ryusa.laws.geometry import turn
from ryusa.model.tally import Term

B_DASH_N, B_DASH_S, B_SLIDE = int(Term.DASH_N), int(Term.DASH_S), int(Term.SLIDE)

Vector = tuple[float, float, float]
_spring_immersed, _instant_step = on_device(spring_immersed), on_device(instant_step)
_may_end = on_device(may_end)


@device
def _lost_in_slip(hdt: float, soft_s: float, s: Vector, t: Vector, q: Vector, e: Vector, b: Vector) -> float:
    """Work of the tangential force over an interval beyond the change of its spring [J].

    `t`, `q` are spring force and the rest at its beginning, `e`, `b` at its end [N], `s` the slip [m/s].
    """
    work = stored = 0.0
    for k in range(3):
        work += s[k] * (t[k] + q[k] + e[k] + b[k])
        stored += e[k] * e[k] - t[k] * t[k]
    return -hdt * work - (0.5 * soft_s * stored if hdt > 0.0 else 0.0)


@cache
def make_exact_contact(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the contact of one pair for one variant."""
    plane_case, rotation = variant.plane_case != 0, variant.rotation != 0
    total, drop = "total" in Slip(choice.slip).marks, "drop" in Slip(choice.slip).marks
    cap_total, rebound, tension = "total" in Cap(choice.cap).marks, choice.rebound, choice.tension != 0

    @device
    def contact(
        a: int, b: int, weight: float, was: int, hdt: float, c: Any, m: Any, inertia: Any, w: Any,
        normal: Vector, overlap: float, closing: float, curve: float, slip: Vector, twist: float,
        eta: Any, row: Any, totals: Any,
    ) -> tuple[int, float, float, bool, float, Vector, Vector]:  # fmt: skip
        """Forces of a pair in contact; parameters and results as those of `pair.make_contact`."""
        dt = c[P.DT]
        n_x, n_y, n_z = normal
        s_x, s_y, s_z = slip
        p_x = p_y = p_z = q_x = q_y = q_z = f_old = e_old = rest = 0.0
        if was != APART:
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            f_old, e_old = row[M.F_N], row[M.F_N] - row[M.DASH_N]
            if was == ENDING:
                rest = row[M.REST_OF_CLOSING]
            else:
                p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
        elif rebound:
            eta[M.ETA_N], eta[M.K_N] = _spring_immersed(choice, closing, a, b, c, m, w)
        k_n, k_s, eta_n, eta_s = eta[M.K_N], eta[M.K_S], eta[M.ETA_N], eta[M.ETA_S]
        t_x, t_y, t_z, r_x, r_y, r_z = p_x, p_y, p_z, q_x, q_y, q_z
        if not plane_case:
            t_x, t_y, t_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
            r_x, r_y, r_z = turn(q_x, q_y, q_z, n_x, n_y, n_z, twist)

        now, f_n, e_n, until = HELD, normal_force(overlap, closing, k_n, eta_n), k_n * overlap, math.inf
        push, given, slid = f_n, False, False
        g_x = g_y = g_z = h_x = h_y = h_z = 0.0
        if was != HELD or overlap <= 0.0 or _may_end(closing, f_n, k_n, c):
            m_n = effective_mass(m[a], m[b])
            m_t = effective_mass_tangential(m[a], w[a, 3], inertia[a], m[b], w[b, 3], inertia[b], rotation)
            if was == BEGAN:  # the overlap that the oscillator had is in its spring
                rest = (overlap - e_old / k_n) / dt - closing - 0.5 * dt * curve
            now, rest, f_n, e_n, push, given, (g_x, g_y, g_z), (h_x, h_y, h_z), slid, until = _instant_step(
                was, rest, overlap, closing, curve, m_n, k_n, eta_n, m_t, k_s, eta_s, (t_x, t_y, t_z),
                (t_x + r_x, t_y + r_y, t_z + r_z), slip, tension, (total, drop, cap_total),
                (c[P.K_N], c[P.K_S], c[P.COHESION], c[P.MU]), c,
            )  # fmt: skip
        soft_s = 1.0 / k_s if k_s > 0.0 else 0.0
        if given:
            e_x, e_y, e_z, b_x, b_y, b_z = g_x, g_y, g_z, h_x, h_y, h_z
            lost = _lost_in_slip(
                hdt, soft_s, slip, (t_x, t_y, t_z), (q_x, q_y, q_z), (e_x, e_y, e_z), (b_x, b_y, b_z)
            )
            dashpot_s, sliding = 0.0 if slid else lost, lost if slid else 0.0
        else:
            e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, _ = tangential_step(
                plane_case, total, drop, cap_total, n_x, n_y, n_z, twist, push, e_n, 1.0, s_x, s_y, s_z,
                p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, eta_s, c[P.COHESION], c[P.MU], dt, hdt,
            )  # fmt: skip
            slid = share < 1.0
        f_x, f_y, f_z, r_x, r_y, r_z = contact_force(
            plane_case, n_x, n_y, n_z, f_n, e_x + b_x, e_y + b_y, e_z + b_z
        )

        # springs held in the first step, before which no interval lies, belong to the start;
        # between two steps on the map the spring takes and gives what it holds; where a contact begins or
        # ends, what its force does beyond that is dissipated
        on_map = hdt == 0.0 or (was == HELD and now in (HELD, ENDING))
        beyond = hdt * closing * (e_old + e_n) - 0.5 * (e_n * e_n - e_old * e_old) / k_n
        dashpot_n = hdt * closing * (f_old - e_old + f_n - e_n) + (0.0 if on_map else beyond)
        totals[B_DASH_N] += weight * dashpot_n
        totals[B_DASH_S] += weight * dashpot_s
        totals[B_SLIDE] += weight * sliding
        row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2], row[M.F_N] = e_x, e_y, e_z, f_n
        row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2], row[M.DASH_N] = b_x, b_y, b_z, f_n - e_n
        if now == ENDING:
            row[M.REST_OF_CLOSING] = rest
        return now, f_n, push, slid, until, (f_x, f_y, f_z), (r_x, r_y, r_z)

    return contact
