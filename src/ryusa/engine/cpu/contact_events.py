"""Contacts that begin, or may end, before the next step: packed, computed by vector instructions, put back.

Few pairs of a batch begin or end in a step, and each costs as much as thirty that do not. Those of a kind are
packed into neighbouring lanes, so that one loop without branches does eight at a time (design/0014).
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import dashpot_row, make_begin_row, make_lane_to_row
from ryusa.engine.cpu.simd.vec4 import fill4
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import (
    APART,
    MAY_PART,
    TOUCHES,
    Middle,
    bounding,
    is_held,
    part,
    touch,
)
from ryusa.engine.shared.dashpots import springs_immersed
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total

NEXT = B.PITCH  # from one row to the next


@inner(fastmath=FAST)
def find_events(m: int, batch: Any) -> tuple[int, int]:
    """List lanes that touch and lanes that may part; returns how many of each."""
    touching = parting = 0
    for l in range(m):  # no branch: which lanes are events is not predictable
        kind = batch[B.KIND + l]
        batch[B.TOUCHES + touching] = batch[B.MAY_PART + parting] = l
        touching += int(kind == TOUCHES)
        parting += int(kind == MAY_PART)
    return touching, parting


@cache
def make_pack(rebound: bool) -> Any:
    """Build pack for contacts whose restitution depends on the water at touch, or not."""
    begin_row = make_begin_row(M.OF_KICKS)

    @inner(fastmath=FAST)
    def pack(
        n: int, lanes: int, rotation: int, choice: LawChoice, selected: Any, i_of: Any, j_of: Any,
        touching: Any, mass: Any, inertia: Any, x: Any, w: Any, eta: Any, rows: Any, ids: Any, material: Any,
        table: Any, c: Any, batch: Any,
    ) -> int:  # fmt: skip
        """Copy n events, of the lanes listed from `lanes` on, to event lanes; returns these in whole vectors.

        A pair that was apart gets its springs. The lanes beyond n hold what earlier events left there: finite
        or not, it is not read.
        """
        of = c
        for e in range(n):
            l = int(batch[lanes + e])
            k = selected[l]
            i, j = i_of[k], j_of[k]
            if table is not None:
                of = table[material_of(i, ids, material), material_of(j, ids, material)]
                batch[B.LAW_E + e], batch[B.LAW_E + NEXT + e] = of[P.K_N], of[P.K_S]
                batch[B.LAW_E + 2 * NEXT + e] = of[P.MU]
            if touching[k] == APART:
                begin_row(k, i, j, rotation, of, mass, x, inertia, eta, rows)
                if rebound:
                    springs_immersed(k, choice, batch[B.CLOSING + l], i, j, of, mass, w, eta)
                for a in range(4):
                    batch[B.SPRING + 4 * l + a] = batch[B.DASH + 4 * l + a] = 0.0
            at = dashpot_row(k, eta)
            batch[B.STATE_E + e] = touching[k]
            batch[B.OVERLAP_E + e], batch[B.CLOSING_E + e] = batch[B.OVERLAP + l], batch[B.CLOSING + l]
            f_n = batch[B.SPRING + 4 * l + 3]
            batch[B.F_N_E + e] = bounding(f_n, f_n - batch[B.DASH + 4 * l + 3])
            batch[B.MASS_E + e] = batch[B.MASS + l] = eta[at, M.MASS]
            batch[B.MASS_S_E + e] = eta[at, M.MASS_S]
            batch[B.ETA_N_E + e], batch[B.K_N_E + e] = eta[at, M.ETA_N], eta[at, M.K_N]
            batch[B.WAY_E + e], batch[B.AFTER_E + e] = eta[at, M.WAY], eta[at, M.AFTER]
            batch[B.ETA_S_E + e], batch[B.K_S_E + e] = eta[at, M.ETA_S], eta[at, M.K_S]
            for a in range(3):
                batch[B.SPRING_E + a * NEXT + e] = batch[B.SPRING + 4 * l + a]
                batch[B.SHEAR_E + a * NEXT + e] = batch[B.SPRING + 4 * l + a] + batch[B.DASH + 4 * l + a]
                batch[B.SLIP_E + a * NEXT + e] = batch[B.SLIP + a * NEXT + l]
        return (n + 7) // 8 * 8

    return pack


@inner(fastmath=FAST, forceinline=True)
def _three(at: int, plane: bool, batch: Any) -> tuple[float, float, float]:
    """Three rows from one place on; in a plane the first alone."""
    if plane:
        return batch[at], 0.0, 0.0
    return batch[at], batch[at + NEXT], batch[at + 2 * NEXT]


@inner(fastmath=FAST, forceinline=True)
def _answer(e: int, found: Middle, batch: Any) -> None:
    """Keep what becomes of event e."""
    batch[B.STATE_E + e], batch[B.CLOSING_E + e], batch[B.OVERLAP_E + e] = found[0], found[1], found[2]
    for a in range(3):
        batch[B.PUSH_E + a * NEXT + e], batch[B.SPRING_E + a * NEXT + e] = found[3][a], found[4][a]
    batch[B.SPENT_E + e], batch[B.SPENT_E + NEXT + e] = found[5], found[6]
    batch[B.SLID_E + e], batch[B.WHEN_E + e] = found[7], found[8]


def _make_touch(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def touch_some(n: int, rules: Any, c: Any, batch: Any) -> None:
        """Begin the contacts of the first n event lanes."""
        dt, cohesion = c[P.DT], c[P.COHESION]
        law = c[P.K_N], c[P.K_S], cohesion, c[P.MU]
        for e in range(known_lanes(n, B.LANES)):
            if mixed:
                law = (
                    batch[B.LAW_E + e], batch[B.LAW_E + NEXT + e], cohesion, batch[B.LAW_E + 2 * NEXT + e],
                )  # fmt: skip
            m, eta, after = batch[B.MASS_E + e], batch[B.ETA_N_E + e], batch[B.AFTER_E + e]
            found = touch(
                batch[B.OVERLAP_E + e], batch[B.CLOSING_E + e], m, eta, batch[B.WAY_E + e], after,
                batch[B.K_N_E + e] * dt / m - after, 1.0 - eta * dt / m, batch[B.MASS_S_E + e],
                batch[B.K_S_E + e], batch[B.ETA_S_E + e], _three(B.SLIP_E + e, plane, batch), rules, law, c,
            )  # fmt: skip
            _answer(e, found, batch)

    return touch_some


def _make_part(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def part_some(n: int, tension: bool, rules: Any, c: Any, batch: Any) -> None:
        """End the contacts of the first n event lanes, or let them go on."""
        dt, cohesion = c[P.DT], c[P.COHESION]
        law = c[P.K_N], c[P.K_S], cohesion, c[P.MU]
        for e in range(known_lanes(n, B.LANES)):
            if mixed:
                law = (
                    batch[B.LAW_E + e], batch[B.LAW_E + NEXT + e], cohesion, batch[B.LAW_E + 2 * NEXT + e],
                )  # fmt: skip
            m, eta, after = batch[B.MASS_E + e], batch[B.ETA_N_E + e], batch[B.AFTER_E + e]
            found = part(
                batch[B.STATE_E + e], batch[B.OVERLAP_E + e], batch[B.CLOSING_E + e], batch[B.F_N_E + e], m,
                eta, batch[B.WAY_E + e], after, batch[B.K_N_E + e] * dt / m - after, 1.0 - eta * dt / m,
                batch[B.MASS_S_E + e], batch[B.K_S_E + e], batch[B.ETA_S_E + e],
                _three(B.SPRING_E + e, plane, batch), _three(B.SHEAR_E + e, plane, batch),
                _three(B.SLIP_E + e, plane, batch), tension, rules, law, c,
            )  # fmt: skip
            _answer(e, found, batch)

    return part_some


@cache
def make_events(plane: bool, mixed: bool) -> Any:
    """Build events for a plane or for space, and for one material or several."""
    touch_some, part_some = _make_touch(plane, mixed), _make_part(plane, mixed)

    @inner(fastmath=FAST)
    def events(begins: bool, n: int, choice: LawChoice, c: Any, batch: Any) -> None:
        """Do the first n event lanes, all of which touch, or all of which may part."""
        rules = (slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap))
        if begins:
            touch_some(n, rules, c, batch)
        else:
            part_some(n, choice.tension != 0, rules, c, batch)

    return events


@cache
def make_put_back(short: bool) -> Any:
    """Build put_back for the length of rows (contact_rows.py)."""
    lane_to_row = make_lane_to_row(short)

    @inner(fastmath=FAST)
    def put_back(n: int, lanes: int, selected: Any, touching: Any, rows: Any, batch: Any) -> None:
        """Copy what becomes of n events to the lanes of their pairs, book it, and keep their memory."""
        for e in range(n):
            l = int(batch[lanes + e])
            state = batch[B.STATE_E + e]
            batch[B.CHANGE + l], batch[B.SHIFT + l] = batch[B.CLOSING_E + e], batch[B.OVERLAP_E + e]
            for a in range(3):
                batch[B.PUSH + a * NEXT + l] = batch[B.PUSH_E + a * NEXT + e]
            batch[B.WHEN + l], batch[B.SLIDES + l] = batch[B.WHEN_E + e], batch[B.SLID_E + e]
            spent_n, spent_s = batch[B.SPENT_E + e], batch[B.SPENT_E + NEXT + e]
            slid, let_go = batch[B.SLID_E + e] > 0.0, 0.0
            batch[B.DASH_N + l] += spent_n
            batch[B.SLIDE + l] += spent_s if slid else 0.0
            batch[B.DASH_S + l] += 0.0 if slid else spent_s
            if not is_held(state) and is_held(batch[B.WAS_TOUCHING + l]):  # what its springs held
                e_n = batch[B.SPRING + 4 * l + 3] - batch[B.DASH + 4 * l + 3]
                let_go = batch[B.STORED + l] * (e_n / batch[B.K_N + l]) ** 2
                for a in range(3):
                    if batch[B.K_S + l] > 0.0:
                        let_go += batch[B.SPRING + 4 * l + a] ** 2 / batch[B.K_S + l]
            batch[B.STEP + l] += spent_n + spent_s - 0.5 * let_go
            for a in range(3):
                batch[B.SPRING + 4 * l + a] = batch[B.SPRING_E + a * NEXT + e]
            if not is_held(state):
                batch[B.SPRING + 4 * l + 3] = 0.0
                fill4(batch, B.DASH + 4 * l, 0.0)
            touching[selected[l]] = int(state)
            lane_to_row(l, selected[l], rows, batch)

    return put_back
