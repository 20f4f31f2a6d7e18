"""One pair whose contact begins and ends within steps (design/0014): its kick, and what follows the kick."""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import APART, HELD, SLID, bounding, is_held, middle_of_pair
from ryusa.engine.shared.contact_kicks import kick_across, kick_along
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact_step import contact_force
from ryusa.laws.families import Cap, Slip
from ryusa.model.tally import Term

B_DASH_S, B_SLIDE, B_STEP = int(Term.DASH_S), int(Term.SLIDE), int(Term.STEP)

Vector = tuple[float, float, float]
_kick_along, _kick_across = on_device(kick_along), on_device(kick_across)
_is_held, _bounding = on_device(is_held), on_device(bounding)
_middle_of_pair = on_device(middle_of_pair)


@cache
def make_kick(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the kick of one pair for one variant."""
    plane_case = variant.plane_case != 0
    total, drop = "total" in Slip(choice.slip).marks, "drop" in Slip(choice.slip).marks
    cap_total = "total" in Cap(choice.cap).marks

    @device
    def contact(
        a: int, b: int, weight: float, was: int, hdt: float, c: Any, m: Any, inertia: Any, w: Any,
        normal: Vector, overlap: float, closing: float, slip: Vector, twist: float, eta: Any, row: Any,
        totals: Any,
    ) -> tuple[int, float, float, bool, Vector, Vector]:  # fmt: skip
        """Forces of a pair at its kick; parameters and results as those of `pair.make_contact`."""
        n_x, n_y, n_z = normal
        p_x = p_y = p_z = q_x = q_y = q_z = e_old = 0.0
        if was != APART:
            p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            e_old = row[M.F_N] - row[M.DASH_N]
        k_n, was_state = eta[M.K_N], float(was)
        now, kick, e_n, f_n = _kick_along(was_state, overlap, closing, k_n, eta[M.ETA_N])
        (e_x, e_y, e_z), (b_x, b_y, b_z), h, taken, dashpot_s, sliding, slides = _kick_across(
            plane_case, total, drop, cap_total, was_state, now == HELD, normal, twist, kick, f_n, e_n, slip,
            (p_x, p_y, p_z), (q_x, q_y, q_z), eta[M.K_S], eta[M.ETA_S], eta[M.MASS_S], c[P.COHESION],
            c[P.MU], c[P.DT], hdt,
        )  # fmt: skip
        f_x, f_y, f_z, t_x, t_y, t_z = contact_force(plane_case, n_x, n_y, n_z, kick, h[0], h[1], h[2])
        if now == HELD and slides:
            now = SLID
        taken += eta[M.STORED] / (k_n * k_n) * (e_n * e_n - e_old * e_old)
        # springs held in the first step belong to the start
        totals[B_STEP] += weight * (dashpot_s + sliding + (0.5 * taken if hdt > 0.0 else 0.0))
        totals[B_DASH_S] += weight * dashpot_s
        totals[B_SLIDE] += weight * sliding
        row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2], row[M.F_N] = e_x, e_y, e_z, f_n
        row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2], row[M.DASH_N] = b_x, b_y, b_z, f_n - e_n
        return now, f_n, kick, slides, (f_x, f_y, f_z), (t_x, t_y, t_z)

    return contact


@cache
def make_middle(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build what one pair does between two kicks, for one variant."""
    plane_case, tension = variant.plane_case != 0, choice.tension != 0
    total, drop = "total" in Slip(choice.slip).marks, "drop" in Slip(choice.slip).marks
    cap_total = "total" in Cap(choice.cap).marks

    @device
    def middle(
        weight: float, was: int, c: Any, normal: Vector, apart: float, overlap: float, closing: float,
        bend: float, u: Vector, slip: Vector, eta: Any, row: Any, totals: Any,
    ) -> tuple[int, float, float, float, float, Vector, Vector]:  # fmt: skip
        """Shear, touch or release of a pair; its row goes on where its contact begins or ends.

        Parameters
        ----------
        weight, normal, overlap, closing, slip, eta, row : as those of `pair.make_contact`.
        was : state after the kick.
        apart : distance of the centres; 0 for a plane, at which nothing turns [m].
        bend : of `bending` [m/s2].
        u : velocity of a relative to b [m/s].
        totals : of the interval after the step (step_totals.py).

        Returns
        -------
        State, time of touch or release after the step, inf if there is none [s], whether it slid, change of
        the closing speed [m/s], shift of the overlap times mass [kg m], impulse over the step on a [N], and
        normal times the tangential one [N].
        """
        dt, m_n = c[P.DT], eta[M.MASS]
        n_x, n_y, n_z = normal
        p_x = p_y = p_z = q_x = q_y = q_z = f_n = e_n = 0.0
        if was != APART:
            p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            f_n, e_n = row[M.F_N], row[M.F_N] - row[M.DASH_N]
        found = _middle_of_pair(
            float(was), overlap, closing, bend, _bounding(f_n, e_n), m_n, eta[M.ETA_N], eta[M.K_N],
            eta[M.WAY], eta[M.AFTER], eta[M.MASS_S], eta[M.K_S], eta[M.ETA_S], (p_x, p_y, p_z),
            (p_x + q_x, p_y + q_y, p_z + q_z), slip, tension, (total, drop, cap_total),
            (c[P.K_N], c[P.K_S], c[P.COHESION], c[P.MU]), c,
        )  # fmt: skip
        now, slid, shift = int(found.state), found.slid, found.shift
        spent, let_go = found.spent_n + found.spent_s, 0.0
        if _is_held(was) and not _is_held(now):  # what its springs held
            let_go = eta[M.STORED] * (e_n / eta[M.K_N]) ** 2
            if eta[M.K_S] > 0.0:
                let_go += (p_x * p_x + p_y * p_y + p_z * p_z) / eta[M.K_S]
        totals[T.OF_STEP] += weight * (spent - 0.5 * let_go)
        totals[T.OF_DASH_N] += weight * found.spent_n
        totals[T.OF_DASH_S] += 0.0 if slid > 0.0 else weight * found.spent_s
        totals[T.OF_SLIDE] += weight * found.spent_s if slid > 0.0 else 0.0
        if found.when < math.inf:
            row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2] = found.spring
            row[M.F_N] = row[M.DASH_S] = row[M.DASH_S + 1] = row[M.DASH_S + 2] = row[M.DASH_N] = 0.0
        g_x, g_y, g_z = found.push
        f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
            plane_case, n_x, n_y, n_z, -m_n * found.change / dt, g_x / dt, g_y / dt, g_z / dt
        )
        if apart > 0.0:  # a pair moved together keeps its angular momentum
            turned = m_n / dt * shift / (apart - shift)
            f_x += turned * (u[0] - closing * n_x)
            f_y += turned * (u[1] - closing * n_y)
            f_z += turned * (u[2] - closing * n_z)
        return now, found.when, slid, found.change, m_n * shift, (f_x, f_y, f_z), (t_x, t_y, t_z)

    return middle
