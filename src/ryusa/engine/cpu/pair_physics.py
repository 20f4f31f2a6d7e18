"""What only some pairs do: rolling friction, open records, films of water, a rebound fixed at first touch.

Lane by lane, after (or, for the rebound, before) the contact law has been computed for the whole batch.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.lane_kinematics import overlap_of_lane
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.contact_instants import APART, MAY_PART, TOUCHES, dashes, is_held
from ryusa.engine.shared.contact_records import (
    add_impulses,
    begin_record,
    end_record,
    is_before_its_touch,
    keep_record,
    touch_as_they_pass,
)
from ryusa.engine.shared.dashpots import dashpot_immersed, dashpot_immersed_hertz
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.rolling import end_rolling, rolling_friction
from ryusa.engine.shared.variant import ForcesKind, LawChoice
from ryusa.laws.dispatch import rolling_alike
from ryusa.laws.geometry import wrap
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius
from ryusa.model.contacts import N_EVENT
from ryusa.model.tally import Term

STEP = int(Term.STEP)


@cache
def make_immersed_dashpots(hertz: bool) -> Any:
    """Build immersed_dashpots for the kind of springs that begin and end at steps."""

    @inner(fastmath=FAST)
    def immersed_dashpots(
        choice: LawChoice, m: int, selected: Any, c: Any, material: Any, table: Any, grains: GrainArrays,
        candidates: CandidateArrays, batch: Any,
    ) -> None:  # fmt: skip
        """Give lanes that touch now and did not before the normal dashpot of their rebound."""
        of = c
        for l in range(m):
            overlap = overlap_of_lane(l, c, batch)
            if batch[B.WAS_TOUCHING + l] > 0.0 or overlap <= 0.0:
                continue
            k = selected[l]
            d_x, d_z = wrap(batch[B.SEPARATION + 4 * l], c[P.PERIOD_X]), batch[B.SEPARATION + 4 * l + 2]
            d_y = wrap(batch[B.SEPARATION + 4 * l + 1], c[P.PERIOD_Y])
            distance = batch[B.SPIN_I + 4 * l + 3] + batch[B.SPIN_J + 4 * l + 3] - overlap
            u_x, u_y, u_z = (
                batch[B.RELATIVE_VELOCITY + 4 * l],
                batch[B.RELATIVE_VELOCITY + 4 * l + 1],
                batch[B.RELATIVE_VELOCITY + 4 * l + 2],
            )
            closing = (u_x * d_x + u_y * d_y + u_z * d_z) / distance
            i, j = candidates.i[k], candidates.j[k]
            if table is not None:
                of = table[material_of(i, grains.ids, material), material_of(j, grains.ids, material)]
            if hertz:
                eta_n = dashpot_immersed_hertz(choice, closing, i, j, of, grains.m, grains.w)
            else:
                eta_n = dashpot_immersed(choice, closing, i, j, of, grains.m, grains.w)
            batch[B.RELATIVE_VELOCITY + 4 * l + 3] = candidates.eta[k, M.ETA_N] = eta_n

    return immersed_dashpots


@cache
def make_record_of_lane(plane: bool, exact: bool) -> Any:
    """Build record_of_lane for the kind of contacts."""

    @inner(fastmath=FAST)
    def record_of_lane(
        choice: LawChoice, l: int, i: int, j: int, n: int, t: float, was: bool, touching: bool, normal: Any,
        slip: Any, force: Any, c: Any, grains: GrainArrays, record: Any, batch: Any, ended: Any, stats: Any,
    ) -> None:  # fmt: skip
        """Begin, keep or end the record of the pair on lane l."""
        dt, overlap, closing, n_touching = (
            c[P.DT],
            batch[B.OVERLAP + l],
            batch[B.CLOSING + l],
            grains.n_touching,
        )
        if touching and not was:
            record[:] = 0.0
            begin_record(
                plane, choice.events, record, t, dt, overlap, closing, slip, normal, i, j, n, grains,
                c[P.PERIOD_X], c[P.PERIOD_Y],
            )  # fmt: skip
        tension, f_last, t_end = choice.tension, record[R.T_PART], record[R.T_END]
        f_n = batch[B.SPRING + 4 * l + 3]
        if exact:  # the end of the force is known, but where others pushed the grains apart
            tension, f_last, f_n = 0, 1.0 if dashes(batch[B.WAS_TOUCHING + l]) else 0.0, batch[B.KICK + l]
            if was and not touching:  # half of a dashpot may still act
                add_impulses(record, f_n, force, dt)
                closing -= f_n * dt / batch[B.MASS + l]
                if is_before_its_touch(record, batch[B.MASS + l]):
                    record[R.PARTNER] = -1.0
        if touching:
            keep_record(
                record, t, dt, overlap, f_n, batch[B.RAW + l], force, batch[B.SLIDES + l] > 0.0,
                n_touching[i] > 1 or (j < n and n_touching[j] > 1),
            )  # fmt: skip
            if exact and not is_held(batch[B.STATE + l]):
                record[R.T_END] = t_end
        elif was and record[R.PARTNER] >= 0.0:
            end_record(
                plane, tension, record, f_last, t, dt, overlap, closing, slip, normal, i, grains.v,
                grains.w, ended, stats,
            )  # fmt: skip

    return record_of_lane


@cache
def make_records_between(plane: bool) -> Any:
    """Build records_between, the records of m lanes between two kicks (contact_shear.py)."""

    @inner(fastmath=FAST)
    def records_between(
        choice: LawChoice, m: int, n: int, t: float, selected: Any, c: Any, grains: GrainArrays,
        candidates: CandidateArrays, batch: Any,
    ) -> None:  # fmt: skip
        """Begin the records of lanes that touch, add impulses, and keep the end of the force."""
        rows, width, dt = candidates.rows, candidates.rows.shape[1], c[P.DT]
        for l in range(m):
            kind, was, when = batch[B.KIND + l], batch[B.WAS_TOUCHING + l], batch[B.WHEN + l]
            if not (is_held(was) or kind == TOUCHES):
                continue
            k = selected[l]
            record, i, j = rows[k, width - N_EVENT :], candidates.i[k], candidates.j[k]
            if was == APART:
                record[:] = 0.0
                normal = batch[B.NORMAL + l], batch[B.NORMAL + B.PITCH + l], batch[B.NORMAL + 2 * B.PITCH + l]
                slip = batch[B.SLIP + l], batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
                begin_record(
                    plane, choice.events, record, t, dt, batch[B.OVERLAP + l], batch[B.CLOSING + l], slip,
                    normal, i, j, n, grains, c[P.PERIOD_X], c[P.PERIOD_Y],
                )  # fmt: skip
                touch_as_they_pass(
                    record, t, dt, -batch[B.OVERLAP + l], batch[B.CLOSING + l], batch[B.BEND + l]
                )
            if record[R.PARTNER] < 0.0:
                continue
            force = batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1], batch[B.FORCE + 4 * l + 2]
            add_impulses(record, -batch[B.MASS + l] * batch[B.CHANGE + l] / dt, force, dt)
            if kind == MAY_PART and when < math.inf:
                record[R.T_END] = t + when
            if batch[B.SLIDES + l] > 0.0 and when < math.inf:
                record[R.T_SLIDE] += dt - when if kind == TOUCHES else when

    return records_between


@cache
def make_optional_physics(kind: ForcesKind) -> Any:
    """Build optional_physics for what the scene has."""
    rolling, events, film, walled = (bool(one) for one in (kind.rolling, kind.events, kind.film, kind.walls))
    exact = bool(kind.exact)
    record_of_lane: Any = make_record_of_lane(bool(kind.plane_case), bool(kind.exact)) if events else None

    @inner(fastmath=FAST)
    def optional_physics(
        choice: LawChoice, m: int, n: int, t: float, hdt: float, selected: Any, c: Any, material: Any,
        table: Any, grains: GrainArrays, candidates: CandidateArrays, batch: Any, ended: Any, account: Any,
        stats: Any,
    ) -> float:  # fmt: skip
        """Rolling friction, records and films of m lanes; returns the energy in rolling springs [J]."""
        w, n_touching = grains.w, grains.n_touching
        rows, width = candidates.rows, candidates.rows.shape[1]
        held, of = 0.0, c
        for l in range(m):
            was, touching = batch[B.WAS_TOUCHING + l] > 0.0, batch[B.TORQUE_I + 4 * l + 3] > 0.0
            overlap, closing = batch[B.OVERLAP + l], batch[B.CLOSING + l]
            if not (was or touching or (film and overlap > -c[P.FILM_REACH])):
                continue
            row, i, j = rows[selected[l]], candidates.i[selected[l]], candidates.j[selected[l]]
            normal = (batch[B.NORMAL + l], batch[B.NORMAL + B.PITCH + l], batch[B.NORMAL + 2 * B.PITCH + l])
            slip = (batch[B.SLIP + l], batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l])
            force = (batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1], batch[B.FORCE + 4 * l + 2])
            spin_i = (w[i, 0], w[i, 1], w[i, 2])  # a wall turns with its mirrored grain
            spin_j = (batch[B.SPIN_J + 4 * l], batch[B.SPIN_J + 4 * l + 1], batch[B.SPIN_J + 4 * l + 2])
            f_n = batch[B.SPRING + 4 * l + 3]
            if walled:
                f_n *= batch[B.SHARE + l]
            if rolling:
                if table is not None:
                    of = table[material_of(i, grains.ids, material), material_of(j, grains.ids, material)]
                sign = 1.0 if rolling_alike(choice.rolling) else -1.0
                if exact:  # the works of torques, which STEP has from the kicks, are booked here
                    for a in range(3):
                        old = row[M.SPRING_R + a] + row[M.DASH_R + a]
                        account[STEP] -= hdt * old * (spin_i[a] + sign * spin_j[a])
                if touching:
                    turned = (
                        normal[1] * force[2] - normal[2] * force[1],
                        normal[2] * force[0] - normal[0] * force[2],
                        normal[0] * force[1] - normal[1] * force[0],
                    )
                    share_j = float(max(n_touching[j], 1)) if j < n else 1.0
                    r_x, r_y, r_z, e_r = rolling_friction(
                        choice.rolling, choice.arm, row, of, f_n, overlap, hdt,
                        (w[i, 3], grains.m[i], grains.inertia[i], float(max(n_touching[i], 1))),
                        (w[j, 3], grains.m[j], grains.inertia[j], share_j),
                        normal, turned, spin_i, spin_j, account,
                    )  # fmt: skip
                    if exact:
                        for a, r in enumerate((r_x, r_y, r_z)):
                            account[STEP] -= hdt * r * (spin_i[a] + sign * spin_j[a])
                    for k, r in enumerate((r_x, r_y, r_z)):
                        batch[B.TORQUE_I + 4 * l + k] += r
                        batch[B.TORQUE_J + 4 * l + k] += sign * r
                    held += e_r
                elif was:
                    radius = reduced_radius(w[i, 3], w[j, 3])
                    end_rolling(choice.rolling, row, of, hdt, spin_i, spin_j, radius, account)
            if events:
                record_of_lane(
                    choice, l, i, j, n, t, was, touching, normal, slip, force, c, grains,
                    row[width - N_EVENT :], batch, ended, stats,
                )  # fmt: skip
            if film and not touching and overlap > -c[P.FILM_REACH]:
                radius = reduced_radius(w[i, 3], w[j, 3])
                f = lubrication_force(
                    -overlap, closing, radius, c[P.ASPERITY], c[P.FILM_REACH], c[P.RHO_W], c[P.NU]
                )
                for k in range(3):
                    grains.film[i, k] -= f * normal[k]
                    grains.film[candidates.target[selected[l]], k] += f * normal[k]
        return held

    return optional_physics
