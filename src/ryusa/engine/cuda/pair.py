"""One pair in touch: the law of contact, its memory and its books; every formula is a law.

The pair is seen from the grain with the lower id, a, whichever side reckons it. Books as in engine/batch.py.
"""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.dashpots import dashpot_immersed
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact import normal_force, shear_strength, slide
from ryusa.laws.geometry import arm, turn
from ryusa.laws.geometry import overlap as overlap_of
from ryusa.model.enums import Cap, Slip
from ryusa.model.tally import Book

B_DASH_N, B_DASH_S, B_SLIDE = int(Book.DASH_N), int(Book.DASH_S), int(Book.SLIDE)
B_RELEASED_N, B_RELEASED_S, B_STEP = int(Book.RELEASED_N), int(Book.RELEASED_S), int(Book.STEP)

Vector = tuple[float, float, float]
_dashpot_immersed = on_device(dashpot_immersed)


@device
def contact_kinematics(
    plane_case: int, d: Vector, r_a: float, r_b: float, u: Vector, w_a: Vector, w_b: Vector, dt: float
) -> tuple[Vector, float, float, float, float, Vector, float]:
    """How a pair meets.

    Parameters
    ----------
    d, u : way from a to b [m], and velocity of a against b [m/s].
    r_a, r_b : radii [m].
    w_a, w_b : spins [rad/s].

    Returns
    -------
    Normal from a to b, overlap and arms [m], closing speed and slip of a against b [m/s] (in a plane along
    (n_z, 0, -n_x), in the first place), and the angle the pair turned about its normal [rad].
    """
    square = d[0] * d[0] + d[2] * d[2]
    if not plane_case:
        square += d[1] * d[1]
    distance = math.sqrt(square)
    inverse = 1.0 / distance
    n_x, n_y, n_z = d[0] * inverse, 0.0, d[2] * inverse
    overlap = overlap_of(r_a, r_b, distance)
    arm_a = arm(r_a, overlap)
    arm_b = distance - arm_a
    s_y = s_z = twist = 0.0
    if plane_case:
        closing = u[0] * n_x + u[2] * n_z
        s_x = u[0] * n_z - u[2] * n_x
        s_x += arm_a * w_a[1] + arm_b * w_b[1]
    else:
        n_y = d[1] * inverse
        closing = u[0] * n_x + u[1] * n_y + u[2] * n_z
        s_x, s_y, s_z = u[0] - closing * n_x, u[1] - closing * n_y, u[2] - closing * n_z
        g_x = arm_a * w_a[0] + arm_b * w_b[0]
        g_y = arm_a * w_a[1] + arm_b * w_b[1]
        g_z = arm_a * w_a[2] + arm_b * w_b[2]
        s_x += g_y * n_z - g_z * n_y
        s_y += g_z * n_x - g_x * n_z
        s_z += g_x * n_y - g_y * n_x
        twist = 0.5 * dt * ((w_a[0] + w_b[0]) * n_x + (w_a[1] + w_b[1]) * n_y + (w_a[2] + w_b[2]) * n_z)
    return (n_x, n_y, n_z), overlap, arm_a, arm_b, closing, (s_x, s_y, s_z), twist


@cache
def make_contact_force(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the contact of one pair for one variant."""
    plane_case = variant.plane_case
    least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
    total, drop = choice.slip == int(Slip.TOTAL), choice.slip == int(Slip.SPRING_DROP)
    cap_total, rebound = choice.cap == int(Cap.TOTAL), choice.rebound

    @device
    def contact_force(
        a: int,
        b: int,
        weight: float,
        was: bool,
        hdt: float,
        c: Any,
        m: Any,
        w: Any,
        kinematics: tuple[Vector, float, float, float, float, Vector, float],
        eta: Any,
        row: Any,
        totals: Any,
    ) -> tuple[bool, float, float, bool, Vector, Vector]:
        """Forces of a pair that touches or did so in the last step; its row goes on by one step.

        Parameters
        ----------
        a, b : places; b may be fixed or a plane.
        weight : of its books in `account`: 1 for the side that keeps them, 0 for the other.
        was : whether they touched in the last step; else the row holds nothing.
        hdt : half a step, 0 in the first [s].
        met : from `meet`.
        eta, row : dashpots and memory of the pair.

        Returns
        -------
        Whether they touch, normal force [N] and what it was before it was cut, whether they slide, tangential
        force on a [N] and normal times that force [N].
        """
        normal, overlap, _, _, closing, slip, twist = kinematics
        dt, k_n, k_s = c[P.DT], c[P.K_N], c[P.K_S]
        soft_n, soft_s = 1.0 / k_n if k_n > 0.0 else 0.0, 1.0 / k_s if k_s > 0.0 else 0.0
        n_x, n_y, n_z = normal
        s_x, s_y, s_z = slip
        live = overlap > 0.0
        p_x = p_y = p_z = q_x = q_y = q_z = f_old = d_old = 0.0
        if was:
            p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            f_old, d_old = row[M.F_N], row[M.DASH_N]
        elif rebound and live:
            eta[M.ETA_N] = _dashpot_immersed(choice, closing, a, b, c, m, w)

        # along the normal; work of the half interval after and the one before
        raw = normal_force(overlap, closing, k_n, eta[M.ETA_N])
        e_n = k_n * overlap if live else 0.0
        f_n = max(raw, least) if live else 0.0
        held = 1.0 if live and f_n > least else 0.0
        work = hdt * closing * (f_n - e_n)
        before = hdt * closing * d_old
        e_old = f_old - d_old
        drawn = 1.0 if f_old > least else 0.0
        totals[B_DASH_N] += weight * (held * work + drawn * before)
        totals[B_RELEASED_N] += weight * ((1.0 - held) * work + (1.0 - drawn) * before)
        if live and not was and hdt > 0.0:
            totals[B_STEP] -= weight * 0.5 * e_n * (2.0 * hdt * closing - overlap)
        if was and not live:
            totals[B_STEP] += weight * 0.5 * e_old * (-2.0 * hdt * closing - e_old * soft_n)

        # along the tangent
        eta_s = eta[M.ETA_S]
        if not plane_case:
            p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
        tau_c = shear_strength(f_n if cap_total else e_n, c[P.COHESION], c[P.MU])
        e_x, e_y, e_z = p_x - k_s * s_x * dt, 0.0, 0.0
        b_x, b_y, b_z = -eta_s * s_x, 0.0, 0.0
        g_x, g_y, g_z = e_x, 0.0, 0.0
        if not plane_case:
            e_y, e_z = p_y - k_s * s_y * dt, p_z - k_s * s_z * dt
            b_y, b_z = -eta_s * s_y, -eta_s * s_z
            g_y, g_z = e_y, e_z
        if total:
            g_x, g_y, g_z = e_x + b_x, e_y + b_y, e_z + b_z
        size = math.fabs(g_x) if plane_case else math.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
        share, swap, keep = slide(size, tau_c, drop, total)
        share, swap, keep = held * share, held * swap, held * keep
        e_x, e_y, e_z = share * e_x + swap * b_x, share * e_y + swap * b_y, share * e_z + swap * b_z
        b_x, b_y, b_z = keep * b_x, keep * b_y, keep * b_z
        lost = s_x * (q_x + b_x) + s_y * (q_y + b_y) + s_z * (q_z + b_z)
        totals[B_DASH_S] -= weight * hdt * lost
        slides = share < 1.0
        if slides:
            spent = p_x * p_x - e_x * e_x + (p_y * p_y - e_y * e_y) + (p_z * p_z - e_z * e_z)
            taken = s_x * (p_x + e_x) + s_y * (p_y + e_y) + s_z * (p_z + e_z)
            taken = weight * (0.5 * spent * soft_s - hdt * taken)
            totals[B_SLIDE] += held * taken
            totals[B_RELEASED_S] += taken - held * taken

        row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2], row[M.F_N] = e_x, e_y, e_z, f_n
        row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2], row[M.DASH_N] = b_x, b_y, b_z, f_n - e_n
        if plane_case:
            h = e_x + b_x
            return live, f_n, raw, slides, (h * n_z, 0.0, -h * n_x), (0.0, h, 0.0)
        h_x, h_y, h_z = e_x + b_x, e_y + b_y, e_z + b_z
        turned = (n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x)
        return live, f_n, raw, slides, (h_x, h_y, h_z), turned

    return contact_force


@device
def track_overlap(ratio: float, id_a: float, id_b: float, totals: Any) -> None:
    """Keep the largest overlap over diameter that this thread has seen, of several the lowest ids."""
    if ratio < totals[T.OVERLAP]:
        return
    grain, partner = totals[T.OVERLAP_GRAIN], totals[T.OVERLAP_PARTNER]
    if ratio == totals[T.OVERLAP] and (id_a > grain or (id_a == grain and id_b >= partner)):
        return
    totals[T.OVERLAP] = ratio
    totals[T.OVERLAP_GRAIN] = id_a
    totals[T.OVERLAP_PARTNER] = id_b
