"""One pair of elastic spheres (laws/hertz_step.py, design/0018), as `pair.py` for linear springs."""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.dashpots import dashpot_immersed_hertz
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact_step import contact_force
from ryusa.laws.families import Cap, Slip, Unloading
from ryusa.laws.hertz_step import (
    dashpot_hertz,
    normal_step_hertz,
    normal_work_hertz,
    shear_spring_hertz,
    spring_hertz,
    tangential_step_hertz,
)
from ryusa.model.tally import Term

B_DASH_N, B_DASH_S, B_SLIDE = int(Term.DASH_N), int(Term.DASH_S), int(Term.SLIDE)
B_RELEASED_N, B_RELEASED_S, B_STEP = int(Term.RELEASED_N), int(Term.RELEASED_S), int(Term.STEP)

Vector = tuple[float, float, float]
_dashpot_immersed = on_device(dashpot_immersed_hertz)


@cache
def make_hertz_contact(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the contact of one pair for one variant."""
    plane_case = variant.plane_case != 0
    least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
    total, drop = "total" in Slip(choice.slip).marks, "drop" in Slip(choice.slip).marks
    cap_total, rebound = "total" in Cap(choice.cap).marks, choice.rebound
    rescaled = "rescaled" in Unloading(choice.unloading).marks

    @device
    def contact(
        a: int, b: int, weight: float, was: int, hdt: float, c: Any, m: Any, inertia: Any, w: Any,
        normal: Vector, overlap: float, closing: float, slip: Vector, twist: float, eta: Any, row: Any,
        totals: Any,
    ) -> tuple[int, float, float, bool, Vector, Vector]:  # fmt: skip
        """Forces of a pair in contact; parameters and results as those of `pair.make_contact`."""
        dt = c[P.DT]
        n_x, n_y, n_z = normal
        s_x, s_y, s_z = slip
        p_x = p_y = p_z = q_x = q_y = q_z = f_old = overlap_old = 0.0
        if was != 0:
            p_x, p_y, p_z = row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2]
            q_x, q_y, q_z = row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2]
            f_old, overlap_old = row[M.F_N], row[M.OVERLAP]
        elif rebound and overlap > 0.0:
            eta[M.ETA_N] = _dashpot_immersed(choice, closing, a, b, c, m, w)

        stiff = eta[M.K_HERTZ]
        e_n, root = spring_hertz(overlap, stiff)
        e_old, root_old = spring_hertz(overlap_old, stiff)
        fourth = math.sqrt(root)
        raw = e_n + dashpot_hertz(fourth, eta[M.ETA_N], eta[M.PER_MASS], dt) * closing
        f_n, held, touching, dashpot_n, released_n = normal_step_hertz(overlap, closing, raw, e_n, least, hdt)
        dashpot_old, released_old, step = normal_work_hertz(
            overlap, closing, e_n, overlap_old, f_old, e_old, least, hdt
        )
        k_s, soft_s, soft_old, scale = shear_spring_hertz(rescaled, root, root_old, c[P.MINDLIN] * stiff)
        e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, released_s = tangential_step_hertz(
            plane_case, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, held, s_x, s_y, s_z,
            p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, soft_old, scale, eta[M.ETA_S] * fourth,
            c[P.COHESION], c[P.MU], dt, hdt,
        )  # fmt: skip
        f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
            plane_case, n_x, n_y, n_z, f_n, e_x + b_x, e_y + b_y, e_z + b_z
        )

        totals[B_DASH_N] += weight * (dashpot_n + dashpot_old)
        totals[B_RELEASED_N] += weight * (released_n + released_old)
        totals[B_STEP] += weight * step
        totals[B_DASH_S] += weight * dashpot_s
        totals[B_SLIDE] += weight * sliding
        totals[B_RELEASED_S] += weight * released_s
        row[M.SPRING_S], row[M.SPRING_S + 1], row[M.SPRING_S + 2], row[M.F_N] = e_x, e_y, e_z, f_n
        row[M.DASH_S], row[M.DASH_S + 1], row[M.DASH_S + 2] = b_x, b_y, b_z
        row[M.OVERLAP] = max(overlap, 0.0)
        return int(touching), f_n, raw, share < 1.0, (f_x, f_y, f_z), (t_x, t_y, t_z)

    return contact
