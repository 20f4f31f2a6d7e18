"""What only some pairs do: rolling friction, open records, films of water, a rebound fixed at first touch.

Lane by lane, after (or, for the rebound, before) the law of contact has been reckoned for the whole batch.
"""
# ruff: noqa: E741, F403, F405  (l is a lane; the places of lanes.py and the columns of rows.py, all of them plain integers)

from typing import Any

from ryusa.engine.cpu.arrays import Grains, Near
from ryusa.engine.cpu.batch_layout import *
from ryusa.engine.cpu.pair_batch import overlap_on
from ryusa.engine.shared.contact_records import begin_record, end_record, keep_record
from ryusa.engine.shared.kernel import FAST, inner, kernel
from ryusa.engine.shared.pair import ROLL_PRINTED, dashpot_wet, roll, roll_out
from ryusa.engine.shared.rows import *
from ryusa.laws.geometry import wrap
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius


@kernel(fastmath=FAST)
def wet_dashpots(choice: Choice, m: int, which: Any, c: Any, grains: Grains, near: Near, desk: Any) -> None:
    """Give lanes that touch now and did not before the normal dashpot of their rebound."""
    for l in range(m):
        overlap = overlap_on(l, c, desk)
        if desk[D_WAS + l] > 0.0 or overlap <= 0.0:
            continue
        k = which[l]
        d_x, d_z = wrap(desk[D_APART + 4 * l], c[C_PERIOD_X]), desk[D_APART + 4 * l + 2]
        d_y = wrap(desk[D_APART + 4 * l + 1], c[C_PERIOD_Y])
        distance = desk[D_SPIN_I + 4 * l + 3] + desk[D_SPIN_J + 4 * l + 3] - overlap
        u_x, u_y, u_z = desk[D_MOVING + 4 * l], desk[D_MOVING + 4 * l + 1], desk[D_MOVING + 4 * l + 2]
        closing = (u_x * d_x + u_y * d_y + u_z * d_z) / distance
        eta_n = dashpot_wet(choice, closing, near.i[k], near.j[k], c, grains.m, grains.w)
        desk[D_MOVING + 4 * l + 3] = near.eta[k, ETA_N] = eta_n


@inner(fastmath=FAST)
def keep_company(
    kind: Variant,
    choice: Choice,
    m: int,
    n: int,
    t: float,
    hdt: float,
    which: Any,
    c: Any,
    grains: Grains,
    near: Near,
    desk: Any,
    ended: Any,
    book: Any,
    now: Any,
) -> float:
    """Rolling friction, records and films of the first m lanes; returns the energy in rolling springs [J]."""
    v, w, touched = grains.v, grains.w, grains.touched
    rows, dt, width = near.rows, c[C_DT], near.rows.shape[1]
    held = 0.0
    for l in range(m):
        was, live = desk[D_WAS + l] > 0.0, desk[D_TORQUE_I + 4 * l + 3] > 0.0
        overlap, closing = desk[D_OVERLAP + l], desk[D_CLOSING + l]
        if not (was or live or (kind.film and overlap > -c[C_FILM_REACH])):
            continue
        row, i, j = rows[which[l]], near.i[which[l]], near.j[which[l]]
        normal = (desk[D_NORMAL + l], desk[D_NORMAL + PITCH + l], desk[D_NORMAL + 2 * PITCH + l])
        slip = (desk[D_SLIP + l], desk[D_SLIP + PITCH + l], desk[D_SLIP + 2 * PITCH + l])
        force = (desk[D_FORCE + 4 * l], desk[D_FORCE + 4 * l + 1], desk[D_FORCE + 4 * l + 2])
        spin_i, spin_j = (w[i, 0], w[i, 1], w[i, 2]), (w[j, 0], w[j, 1], w[j, 2])
        f_n = desk[D_SPRING + 4 * l + 3]
        if kind.rolling:
            if live:
                turned = (
                    normal[1] * force[2] - normal[2] * force[1],
                    normal[2] * force[0] - normal[0] * force[2],
                    normal[0] * force[1] - normal[1] * force[0],
                )
                share_j = float(max(touched[j], 1)) if j < n else 1.0
                r_x, r_y, r_z, e_r = roll(
                    choice.rolling, choice.arm, row, c, f_n, overlap, hdt,
                    (w[i, 3], grains.m[i], grains.inertia[i], float(max(touched[i], 1))),
                    (w[j, 3], grains.m[j], grains.inertia[j], share_j),
                    normal, turned, spin_i, spin_j, book,
                )  # fmt: skip
                sign = 1.0 if choice.rolling == ROLL_PRINTED else -1.0
                for k, r in enumerate((r_x, r_y, r_z)):
                    desk[D_TORQUE_I + 4 * l + k] += r
                    desk[D_TORQUE_J + 4 * l + k] += sign * r
                held += e_r
            elif was:
                radius = reduced_radius(w[i, 3], w[j, 3])
                roll_out(choice.rolling, row, c, hdt, spin_i, spin_j, radius, book)
        if kind.events:
            record = row[width - N_EVENT :]
            if live and not was:
                record[:] = 0.0
                begin_record(
                    kind.plane_case, choice.events, record, t, dt, overlap, closing, slip, normal, i, j, n,
                    grains, c[C_PERIOD_X], c[C_PERIOD_Y],
                )  # fmt: skip
            if live:
                keep_record(
                    record, t, dt, overlap, f_n, desk[D_RAW + l], force,
                    desk[D_SLIDES + l] > 0.0, touched[i] > 1 or (j < n and touched[j] > 1),
                )  # fmt: skip
            elif was and record[E_J] >= 0.0:
                end_record(
                    kind.plane_case, choice.tension, record, record[E_T_PART], t, overlap, closing, slip,
                    normal, i, v, w, ended, now,
                )  # fmt: skip
        if kind.film and not live and overlap > -c[C_FILM_REACH]:
            radius = reduced_radius(w[i, 3], w[j, 3])
            f = lubrication_force(
                -overlap, closing, radius, c[C_ASPERITY], c[C_FILM_REACH], c[C_RHO_W], c[C_NU]
            )
            for k in range(3):
                grains.film[i, k] -= f * normal[k]
                grains.film[near.to[which[l]], k] += f * normal[k]
    return held
