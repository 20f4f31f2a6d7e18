"""One pair in touch: numbers gathered for the step of a contact (laws/contact_step.py), and put back.

The pair is seen from the grain with the lower id, a, whichever side computes it.
"""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.arrays import DeviceWallArrays
from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.cuda.exact_pair import make_kick
from ryusa.engine.cuda.hertz_pair import make_hertz_contact
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import HELD, is_held
from ryusa.engine.shared.dashpots import dashpot_immersed
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact import normal_force
from ryusa.laws.contact_step import contact_force, normal_step, normal_work_of_last_force, tangential_step
from ryusa.laws.families import Cap, Slip
from ryusa.laws.geometry import wrap
from ryusa.laws.hertz import hertz_energy
from ryusa.model.tally import Term

B_DASH_N, B_DASH_S, B_SLIDE = int(Term.DASH_N), int(Term.DASH_S), int(Term.SLIDE)
B_RELEASED_N, B_RELEASED_S, B_STEP = int(Term.RELEASED_N), int(Term.RELEASED_S), int(Term.STEP)

Vector = tuple[float, float, float]
_dashpot_immersed, _is_held = on_device(dashpot_immersed), on_device(is_held)


@cache
def make_contact(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the contact of one pair for one variant."""
    if variant.exact:
        return make_kick(variant, choice)
    if variant.hertz:
        return make_hertz_contact(variant, choice)
    plane_case = variant.plane_case != 0
    least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
    total, drop = "total" in Slip(choice.slip).marks, "drop" in Slip(choice.slip).marks
    cap_total, rebound = "total" in Cap(choice.cap).marks, choice.rebound

    @device
    def contact(
        a: int,
        b: int,
        weight: float,
        was: int,
        hdt: float,
        c: Any,
        m: Any,
        inertia: Any,
        w: Any,
        normal: Vector,
        overlap: float,
        closing: float,
        slip: Vector,
        twist: float,
        eta: Any,
        row: Any,
        totals: Any,
    ) -> tuple[int, float, float, bool, Vector, Vector]:
        """Forces of a pair in contact, now or in the last step; its row goes on by one step.

        Parameters
        ----------
        a, b : places; b may be fixed or a plane.
        weight : of its work in `totals`: 1 for the side that accounts for the pair, 0 for the other.
        was : state after the last step (shared/contact_instants.py); if 0 the row holds nothing.
        hdt : half a step, 0 in the first [s].
        normal, overlap, closing, slip, twist : from `contact_kinematics` [-], [m], [m/s], [m/s], [rad].
        eta, row : dashpots and memory of the pair.

        Returns
        -------
        State after this step, normal force [N] and what it was before it was cut, or with exact timing that
        of the kick, whether they slide, force on a [N], and normal times tangential force [N].
        """
        dt, k_n, k_s = c[P.DT], c[P.K_N], c[P.K_S]
        soft_n, soft_s = 1.0 / k_n if k_n > 0.0 else 0.0, 1.0 / k_s if k_s > 0.0 else 0.0
        n_x, n_y, n_z = normal
        s_x, s_y, s_z = slip
        p_x = p_y = p_z = q_x = q_y = q_z = f_old = d_old = 0.0
        was_touching = was != 0
        if was_touching:
            p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            f_old, d_old = row[M.F_N], row[M.DASH_N]
        elif rebound and overlap > 0.0:
            eta[M.ETA_N] = _dashpot_immersed(choice, closing, a, b, c, m, w)

        raw = normal_force(overlap, closing, k_n, eta[M.ETA_N])
        f_n, e_n, held, touching, dashpot_n, released_n, begun = normal_step(
            overlap, closing, raw, was_touching, least, k_n, hdt
        )
        dashpot_old, released_old, ended = normal_work_of_last_force(
            closing, f_old, d_old, was_touching and touching == 0.0, least, soft_n, hdt
        )
        e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, released_s = tangential_step(
            plane_case, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, held, s_x, s_y, s_z,
            p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, eta[M.ETA_S], c[P.COHESION], c[P.MU], dt, hdt,
        )  # fmt: skip
        f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
            plane_case, n_x, n_y, n_z, f_n, e_x + b_x, e_y + b_y, e_z + b_z
        )

        totals[B_DASH_N] += weight * (dashpot_n + dashpot_old)
        totals[B_RELEASED_N] += weight * (released_n + released_old)
        totals[B_STEP] += weight * (begun + ended)
        totals[B_DASH_S] += weight * dashpot_s
        totals[B_SLIDE] += weight * sliding
        totals[B_RELEASED_S] += weight * released_s
        row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2], row[M.F_N] = e_x, e_y, e_z, f_n
        row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2], row[M.DASH_N] = b_x, b_y, b_z, f_n - e_n
        return int(touching), f_n, raw, share < 1.0, (f_x, f_y, f_z), (t_x, t_y, t_z)

    return contact


@cache
def make_spring_energy(variant: KernelVariant) -> Any:
    """Build what adds up the energy in the springs of a pair in contact, and counts it."""
    if variant.hertz:
        return _make_hertz_energy()
    if variant.exact:
        return _make_energy_of_kicks()

    @device
    def add_spring_energy(now: int, c: Any, eta: Any, row: Any, totals: Any) -> None:
        """Add what the springs of a pair in state `now` hold [J]."""
        k_n, k_s, e_n = c[P.K_N], c[P.K_S], row[M.F_N] - row[M.DASH_N]
        if k_n > 0.0:
            totals[T.SPRING_N] += 0.5 * e_n * e_n / k_n
        if now == HELD:
            if k_s > 0.0:
                for s in range(3):
                    totals[T.SPRING_S] += 0.5 * row[M.SPRING_S + s] ** 2 / k_s
            totals[T.N_CONTACT] += 1.0

    return add_spring_energy


@cache
def _make_energy_of_kicks() -> Any:
    @device
    def add_spring_energy(now: int, c: Any, eta: Any, row: Any, totals: Any) -> None:
        """Add what the springs of a pair with exact timing hold in state `now` [J]."""
        if _is_held(now):
            e_n = row[M.F_N] - row[M.DASH_N]
            totals[T.SPRING_N] += 0.5 * e_n * e_n * eta[M.STORED] / eta[M.K_N] ** 2
            if eta[M.K_S] > 0.0:
                for s in range(3):
                    totals[T.SPRING_S] += 0.5 * row[M.SPRING_S + s] ** 2 / eta[M.K_S]
            totals[T.N_CONTACT] += 1.0

    return add_spring_energy


@cache
def _make_hertz_energy() -> Any:
    @device
    def add_spring_energy(now: int, c: Any, eta: Any, row: Any, totals: Any) -> None:
        """Add what the springs of two elastic spheres in state `now` hold [J]."""
        if now == HELD:
            totals[T.SPRING_N] += hertz_energy(row[M.OVERLAP], eta[M.K_HERTZ])
            k_s = c[P.MINDLIN] * eta[M.K_HERTZ] * math.sqrt(row[M.OVERLAP])
            if k_s > 0.0:
                for s in range(3):
                    totals[T.SPRING_S] += 0.5 * row[M.SPRING_S + s] ** 2 / k_s
            totals[T.N_CONTACT] += 1.0

    return add_spring_energy


@device
def separation(
    i: int, j: int, sign: float, n_solid: int, l_x: float, l_y: float, x: Any, walls: DeviceWallArrays
) -> tuple[float, float, float, float]:
    """Vector between the centres of i and j, `sign` 1 if from i to j [m], and the radius of j [m]."""
    r_j = x[i, 3]
    if j >= n_solid:  # a plane is met as a grain of the same size that touches it from behind
        gap = 0.0
        for a in range(3):
            gap += (x[i, a] - walls.points[j - n_solid, a]) * walls.normals[j - n_solid, a]
        away = -(gap + r_j)
        d_x = away * walls.normals[j - n_solid, 0]
        d_y = away * walls.normals[j - n_solid, 1]
        d_z = away * walls.normals[j - n_solid, 2]
    else:
        d_x, d_y, d_z = sign * (x[j, 0] - x[i, 0]), sign * (x[j, 1] - x[i, 1]), sign * (x[j, 2] - x[i, 2])
        r_j = x[j, 3]
    return wrap(d_x, l_x), wrap(d_y, l_y), d_z, r_j


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
