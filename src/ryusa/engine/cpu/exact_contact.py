"""The kicks of a batch of pairs whose contacts begin and end within steps (design/0014).

As `pair_batch.compute`, but every pair has the stiffness of its kick, half of its normal dashpot acts before
the kick and half after (contact_shear.py), and a pair that touched since the last kick has its spring by now.
Of the account, the springs and the tangential direction are booked here; the rest is in contact_shear.py.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import springs_of_row
from ryusa.engine.cpu.lane_kinematics import kinematics_of_lane
from ryusa.engine.cpu.wall_shares import share_of
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import HELD, SLID, is_held
from ryusa.engine.shared.contact_kicks import kick_across, kick_along
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact_step import contact_force
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total


def _make_kinematics(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def kinematics_of_kicks(m: int, most: float, c: Any, batch: Any) -> None:
        """Geometry and velocities of every contact, and its normal force."""
        dt, l_x, l_y = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(known_lanes(m, B.LANES)):
            overlap, closing = kinematics_of_lane(l, plane, most, dt, l_x, l_y, batch)
            state, kick, e_n, f_n = kick_along(
                batch[B.WAS_TOUCHING + l], overlap, closing, batch[B.K_N + l],
                batch[B.RELATIVE_VELOCITY + 4 * l + 3],
            )  # fmt: skip
            batch[B.KICK + l], batch[B.E_N + l] = kick, e_n
            batch[B.F_N + l] = batch[B.RAW + l] = f_n
            batch[B.STATE + l] = state
            batch[B.TOUCHING + l] = 1.0 if overlap > 0.0 else 0.0

    return kinematics_of_kicks


def _make_tangential(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def tangential_of_kicks(
        total: bool, drop: bool, cap_total: bool, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, the energy of the springs; force and torques on both grains."""
        dt, mu, cohesion = c[P.DT], c[P.MU], c[P.COHESION]
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, e_n, kick = batch[B.F_N + l], batch[B.E_N + l], batch[B.KICK + l]
            held = batch[B.STATE + l] == HELD
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            e_old = batch[B.SPRING + 4 * l + 3] - batch[B.DASH + 4 * l + 3]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            s_x, s_y, s_z, twist = batch[B.SLIP + l], 0.0, 0.0, 0.0
            if not plane:
                n_y, twist = batch[B.NORMAL + B.PITCH + l], batch[B.TWIST + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
            (e_x, e_y, e_z), (b_x, b_y, b_z), h, taken, dashpot_s, sliding, slides = kick_across(
                plane, total, drop, cap_total, batch[B.WAS_TOUCHING + l], held, (n_x, n_y, n_z), twist, kick,
                f_n, e_n, (s_x, s_y, s_z), (p_x, p_y, p_z), (q_x, q_y, q_z), batch[B.K_S + l],
                batch[B.ETA_S + l], batch[B.MASS_S + l], cohesion, batch[B.MU + l] if mixed else mu, dt, hdt,
            )  # fmt: skip
            f_x, f_y, f_z, t_x, t_y, t_z = contact_force(plane, n_x, n_y, n_z, kick, h[0], h[1], h[2])
            batch[B.STATE + l] = SLID if held and slides else batch[B.STATE + l]
            k_n = batch[B.K_N + l]
            taken += batch[B.STORED + l] / (k_n * k_n) * (e_n * e_n - e_old * e_old)
            # springs held in the first step belong to the start
            batch[B.STEP + l] += 0.5 * taken if hdt > 0.0 else 0.0
            batch[B.DASH_S + l] += dashpot_s
            batch[B.SLIDE + l] += sliding
            batch[B.SLIDES + l] = 1.0 if slides else 0.0
            batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1] = e_x, e_y
            batch[B.SPRING + 4 * l + 2], batch[B.SPRING + 4 * l + 3] = e_z, f_n
            batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1] = b_x, b_y
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, f_n - e_n
            a_i, a_j, touching = batch[B.ARM_I + l], batch[B.ARM_J + l], batch[B.TOUCHING + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential_of_kicks


@cache
def make_compute_kicks(plane: bool, mixed: bool) -> Any:
    """Build compute_kicks for a plane or for space, and for one material or several."""
    kinematics_of_kicks, tangential_of_kicks = _make_kinematics(plane), _make_tangential(plane, mixed)

    @inner(fastmath=FAST)
    def compute_kicks(choice: LawChoice, m: int, hdt: float, most: float, c: Any, batch: Any) -> None:
        """Forces, torques and springs of m lanes, as `pair_batch.compute`."""
        total, drop, whole = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        kinematics_of_kicks(m, most, c, batch)
        tangential_of_kicks(total, drop, whole, m, hdt, c, batch)

    return compute_kicks


@inner(fastmath=FAST)
def keep_states(m: int, selected: Any, touching: Any, batch: Any) -> None:
    """Keep the states of the first m lanes."""
    for l in range(m):
        touching[selected[l]] = int(batch[B.STATE + l])


@inner(fastmath=FAST)
def spring_energy_of_kicks(b: int, n_solid: int, candidates: Any, met: Any) -> tuple[float, float, int]:
    """Energy in normal and tangential springs of block b [J], and its contacts; `met` may be None."""
    eta, rows = candidates.eta, candidates.rows
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if not is_held(candidates.touching[k]):
            continue
        e_n, s_x, s_y, s_z = springs_of_row(k, rows)
        e = k if len(eta) > 1 else 0
        half = 0.5
        if met is not None:
            half *= share_of(k, n_solid, candidates, met)
        normal += half * e_n * e_n * eta[e, M.STORED] / eta[e, M.K_N] ** 2
        if eta[e, M.K_S] > 0.0:
            for force in (s_x, s_y, s_z):
                tangential += half * force**2 / eta[e, M.K_S]
        count += 1
    return normal, tangential, count
