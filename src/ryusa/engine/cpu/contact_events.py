"""Contacts that begin, or may end, within a step: packed, computed by vector instructions, put back.

Few pairs of a batch begin or end in a step, and each costs as much as thirty that do not. Those of a kind are
packed into neighbouring lanes, so that one loop without branches does eight at a time (design/0014).
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import (
    BEGAN,
    BEGINS,
    CORRECTS,
    ENDING,
    HELD,
    MAY_END,
    begin_contact,
    end_contact,
)
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.collision import effective_mass, effective_mass_tangential
from ryusa.laws.contact_map import passing
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total
from ryusa.laws.geometry import turn

NEXT = B.PITCH  # from one row to the next


@inner(fastmath=FAST)
def _find(m: int, selected: Any, i_of: Any, j_of: Any, mass: Any, dt: float, batch: Any) -> tuple[int, int]:
    """List lanes that begin and lanes that may end, correct those that ended; returns how many of each."""
    begin = end = 0
    for l in range(m):  # no branch but the rarest: which lanes are events is not predictable
        kind = batch[B.KIND + l]
        batch[B.BEGINS + begin] = batch[B.MAY_END + end] = l
        begin += int(kind == BEGINS)
        end += int(kind == MAY_END)
        if kind == CORRECTS:
            m_n = effective_mass(mass[i_of[selected[l]]], mass[j_of[selected[l]]])
            batch[B.F_N + l] = -m_n * batch[B.SPRING + 4 * l] / dt
    return begin, end


@inner(fastmath=FAST)
def _pack(
    n: int, lanes: int, selected: Any, i_of: Any, j_of: Any, mass: Any, inertia: Any, w: Any, ids: Any,
    material: Any, table: Any, batch: Any,
) -> int:  # fmt: skip
    """Copy n events, of the lanes listed from `lanes` on, to event lanes; returns these in whole vectors.

    The lanes beyond n hold what earlier events left there: finite or not, it is not read.
    """
    for e in range(n):
        l = int(batch[lanes + e])
        i, j = i_of[selected[l]], j_of[selected[l]]
        u_x, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], batch[B.RELATIVE_VELOCITY + 4 * l + 2]
        u_y = batch[B.RELATIVE_VELOCITY + 4 * l + 1]  # 0 in a plane
        for row in range(B.N_INPUT):
            batch[B.EVENT + row * NEXT + e] = batch[B.OVERLAP + row * NEXT + l]
        for a in range(4):
            batch[B.SPRING_OF_EVENT + a * NEXT + e] = batch[B.SPRING + 4 * l + a]
            batch[B.DASH_OF_EVENT + a * NEXT + e] = batch[B.DASH + 4 * l + a]
        batch[B.ETA_N_OF_EVENT + e] = batch[B.RELATIVE_VELOCITY + 4 * l + 3]
        batch[B.STATE_OF_EVENT + e] = batch[B.WAS_TOUCHING + l]
        batch[B.MASS_OF_EVENT + e], batch[B.MASS_OF_EVENT + NEXT + e] = mass[i], mass[j]
        batch[B.INERTIA_OF_EVENT + e], batch[B.INERTIA_OF_EVENT + NEXT + e] = inertia[i], inertia[j]
        batch[B.RADIUS_OF_EVENT + e] = batch[B.SPIN_I + 4 * l + 3]
        batch[B.RADIUS_OF_EVENT + NEXT + e] = batch[B.SPIN_J + 4 * l + 3]
        if table is not None:
            a, b = material_of(i, ids, material), material_of(j, ids, material)
            batch[B.MU_OF_EVENT + e] = table[a, b, P.MU]
            batch[B.K_N_OF_EVENT + e], batch[B.K_S_OF_EVENT + e] = table[a, b, P.K_N], table[a, b, P.K_S]
        batch[B.CURVE_OF_EVENT + e] = passing(
            u_x * u_x + u_y * u_y + u_z * u_z, batch[B.CLOSING + l],
            w[i, 3] + w[j, 3] - batch[B.OVERLAP + l],  # inf of a plane, whose radius on its lane is that of i
        )  # fmt: skip
    return (n + 7) // 8 * 8


@inner(fastmath=FAST)
def _put_back(n: int, lanes: int, batch: Any) -> None:
    """Copy the answers of n events to the lanes of their pairs."""
    for e in range(n):
        l = int(batch[lanes + e])
        for row in range(B.N_ANSWER):
            batch[B.F_N + row * NEXT + l] = batch[B.ANSWER + row * NEXT + e]


@inner(fastmath=FAST, forceinline=True)
def _masses(e: int, rotates: bool, batch: Any) -> tuple[float, float]:
    """Effective masses of event e in the normal and the tangential direction [kg]."""
    m_i, m_j = batch[B.MASS_OF_EVENT + e], batch[B.MASS_OF_EVENT + NEXT + e]
    return effective_mass(m_i, m_j), effective_mass_tangential(
        m_i, batch[B.RADIUS_OF_EVENT + e], batch[B.INERTIA_OF_EVENT + e],
        m_j, batch[B.RADIUS_OF_EVENT + NEXT + e], batch[B.INERTIA_OF_EVENT + NEXT + e], rotates,
    )  # fmt: skip


@inner(fastmath=FAST, forceinline=True)
def _slip(e: int, plane: bool, batch: Any) -> tuple[float, float, float]:
    """Slip velocity of event e [m/s]."""
    if plane:
        return batch[B.EVENT + (B.SLIP - B.OVERLAP) + e], 0.0, 0.0
    return (
        batch[B.EVENT + (B.SLIP - B.OVERLAP) + e],
        batch[B.EVENT + (B.SLIP - B.OVERLAP) + NEXT + e],
        batch[B.EVENT + (B.SLIP - B.OVERLAP) + 2 * NEXT + e],
    )


@inner(fastmath=FAST, forceinline=True)
def _answer(
    e: int, f_n: float, e_n: float, push: float, state: float, given: float, spring: Any, rest: Any,
    slid: float, until: float, correction: float, batch: Any,
) -> None:  # fmt: skip
    """Keep what became of event e."""
    at = B.ANSWER - B.F_N + e
    batch[at + B.F_N], batch[at + B.E_N], batch[at + B.RAW] = f_n, e_n, push
    batch[at + B.STATE], batch[at + B.GIVEN], batch[at + B.GIVEN_SLID] = state, given, slid
    batch[at + B.GIVEN_SPRING], batch[at + B.GIVEN_REST] = spring[0], rest[0]
    batch[at + B.GIVEN_SPRING + NEXT], batch[at + B.GIVEN_REST + NEXT] = spring[1], rest[1]
    batch[at + B.GIVEN_SPRING + 2 * NEXT], batch[at + B.GIVEN_REST + 2 * NEXT] = spring[2], rest[2]
    batch[at + B.UNTIL], batch[at + B.REST] = until, correction


@inner(fastmath=FAST, forceinline=True)
def _springs(e: int, cohesion: float, batch: Any) -> tuple[float, float, float, float]:
    """Stiffnesses [N/m], cohesion [N] and friction [-] of event e, where materials differ."""
    return batch[B.K_N_OF_EVENT + e], batch[B.K_S_OF_EVENT + e], cohesion, batch[B.MU_OF_EVENT + e]


def _make_begin(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def begin(n: int, rotates: bool, rules: Any, c: Any, batch: Any) -> None:
        """Begin the contacts of the first n event lanes."""
        alike, cohesion = (c[P.K_N], c[P.K_S], c[P.COHESION], c[P.MU]), c[P.COHESION]
        for e in range(known_lanes(n, B.LANES)):
            m_n, m_t = _masses(e, rotates, batch)
            law = _springs(e, cohesion, batch) if mixed else alike
            at = B.EVENT - B.OVERLAP + e
            f_n, e_n, spring, rest, slid = begin_contact(
                batch[at + B.OVERLAP], batch[at + B.CLOSING], batch[B.CURVE_OF_EVENT + e], m_n,
                batch[at + B.K_N], batch[B.ETA_N_OF_EVENT + e], m_t, batch[at + B.K_S], batch[at + B.ETA_S],
                _slip(e, plane, batch), rules, law, c,
            )  # fmt: skip
            _answer(e, f_n, e_n, f_n, BEGAN, 1.0, spring, rest, 1.0 if slid else 0.0, math.inf, 0.0, batch)

    return begin


def _make_end(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def end(n: int, rotates: bool, rules: Any, tension: bool, c: Any, batch: Any) -> None:
        """End the contacts of the first n event lanes, or let them go on."""
        alike, cohesion = (c[P.K_N], c[P.K_S], c[P.COHESION], c[P.MU]), c[P.COHESION]
        for e in range(known_lanes(n, B.LANES)):
            m_n, m_t = _masses(e, rotates, batch)
            law = _springs(e, cohesion, batch) if mixed else alike
            at = B.EVENT - B.OVERLAP + e
            overlap, closing, k_n = batch[at + B.OVERLAP], batch[at + B.CLOSING], batch[at + B.K_N]
            p_x, p_y, p_z = batch[B.SPRING_OF_EVENT + e], 0.0, 0.0
            q_x, q_y, q_z = batch[B.DASH_OF_EVENT + e], 0.0, 0.0
            e_old = batch[B.SPRING_OF_EVENT + 3 * NEXT + e] - batch[B.DASH_OF_EVENT + 3 * NEXT + e]
            if not plane:
                n_x, n_y = batch[at + B.NORMAL], batch[at + B.NORMAL + NEXT]
                n_z, twist = batch[at + B.NORMAL + 2 * NEXT], batch[at + B.TWIST]
                p_y, p_z = batch[B.SPRING_OF_EVENT + NEXT + e], batch[B.SPRING_OF_EVENT + 2 * NEXT + e]
                q_y, q_z = batch[B.DASH_OF_EVENT + NEXT + e], batch[B.DASH_OF_EVENT + 2 * NEXT + e]
                p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
                q_x, q_y, q_z = turn(q_x, q_y, q_z, n_x, n_y, n_z, twist)
            # the overlap that the oscillator had when it began is in its spring
            late = (overlap - e_old / k_n) / c[P.DT] - closing - 0.5 * c[P.DT] * batch[B.CURVE_OF_EVENT + e]
            ends, correction, f_n, push, rest, slid, until = end_contact(
                late if batch[B.STATE_OF_EVENT + e] == BEGAN else 0.0, overlap, closing, m_n, k_n,
                batch[B.ETA_N_OF_EVENT + e], m_t, batch[at + B.K_S], batch[at + B.ETA_S], (p_x, p_y, p_z),
                (p_x + q_x, p_y + q_y, p_z + q_z), _slip(e, plane, batch), tension, rules, law, c,
            )  # fmt: skip
            _answer(
                e, f_n, k_n * overlap, push, ENDING if ends else HELD, 1.0 if ends else 0.0, (0.0, 0.0, 0.0),
                rest, 1.0 if slid and ends else 0.0, until, correction, batch,
            )  # fmt: skip

    return end


@cache
def make_begin_and_end(plane: bool, mixed: bool) -> Any:
    """Build begin_and_end for a plane or for space, and for one material or several."""
    begin_some, end_some = _make_begin(plane, mixed), _make_end(plane, mixed)

    @inner(fastmath=FAST)
    def begin_and_end(
        rotation: int, choice: LawChoice, m: int, selected: Any, i_of: Any, j_of: Any, mass: Any,
        inertia: Any, w: Any, ids: Any, material: Any, table: Any, c: Any, batch: Any,
    ) -> None:  # fmt: skip
        """Do the events among the first m lanes."""
        rules = (slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap))
        begin, end = _find(m, selected, i_of, j_of, mass, c[P.DT], batch)
        if begin > 0:
            n = _pack(begin, B.BEGINS, selected, i_of, j_of, mass, inertia, w, ids, material, table, batch)
            begin_some(n, rotation != 0, rules, c, batch)
            _put_back(begin, B.BEGINS, batch)
        if end > 0:
            n = _pack(end, B.MAY_END, selected, i_of, j_of, mass, inertia, w, ids, material, table, batch)
            end_some(n, rotation != 0, rules, choice.tension != 0, c, batch)
            _put_back(end, B.MAY_END, batch)

    return begin_and_end
