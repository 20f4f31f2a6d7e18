"""What only some pairs do: rolling friction, open records, films of water, a rebound fixed at first touch.

Lane by lane, after (or, for the rebound, before) the contact law has been computed for the whole batch.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.pair_batch import overlap_of_lane
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.contact_records import begin_record, end_record, keep_record
from ryusa.engine.shared.dashpots import dashpot_immersed, dashpot_immersed_hertz, spring_immersed
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.rolling import end_rolling, rolling_friction
from ryusa.engine.shared.variant import ForcesKind, LawChoice
from ryusa.laws.dispatch import rolling_alike
from ryusa.laws.geometry import wrap
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius
from ryusa.model.contacts import N_EVENT


@cache
def make_immersed_dashpots(exact: bool, hertz: bool) -> Any:
    """Build immersed_dashpots for the kind of springs."""

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
            elif not exact:
                eta_n = dashpot_immersed(choice, closing, i, j, of, grains.m, grains.w)
            else:
                eta_n, k_n = spring_immersed(choice, closing, i, j, of, grains.m, grains.w)
                batch[B.K_N + l] = candidates.eta[k, M.K_N] = k_n
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
        goes_on, tension, f_last, until = touching, choice.tension, record[R.T_PART], math.inf
        if exact:  # a record ends after the last force, which may act after the grains parted
            goes_on, until = batch[B.STATE + l] > 0.0, batch[B.UNTIL + l]
            tension, f_last = 0, 1.0 if until == 0.0 else 0.0
        if goes_on:
            t_end = record[R.T_END]
            keep_record(
                record, t, dt, overlap, batch[B.SPRING + 4 * l + 3], batch[B.RAW + l], force,
                batch[B.SLIDES + l] > 0.0, n_touching[i] > 1 or (j < n and n_touching[j] > 1),
            )  # fmt: skip
            if exact and until < math.inf:
                record[R.T_END] = t + until if until >= 0.0 else t_end
        elif was and record[R.PARTNER] >= 0.0:
            end_record(
                plane, tension, record, f_last, t, overlap, closing, slip, normal, i, grains.v,
                grains.w, ended, stats,
            )  # fmt: skip

    return record_of_lane


@cache
def make_optional_physics(kind: ForcesKind) -> Any:
    """Build optional_physics for what the scene has."""
    rolling, events, film, walled = (bool(one) for one in (kind.rolling, kind.events, kind.film, kind.walls))
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
                    sign = 1.0 if rolling_alike(choice.rolling) else -1.0
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
