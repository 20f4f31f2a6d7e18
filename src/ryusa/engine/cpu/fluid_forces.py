"""Forces of the water on a batch of grains: gathered to lanes, computed by vector instructions.

As for pairs (pair_batch.py), every formula is a law, and loops are short: first what the grains need is
copied to the batch (fluid_layout.py), then each law runs over all lanes.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu.arrays import GrainArrays
from ryusa.engine.cpu.simd.vec4 import copy4, read4, vec4_of, write4
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import STRESS, height_in_profile, length
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import FluidLaws
from ryusa.laws._family import Family, lanes_of_law
from ryusa.laws.drag import drag_among_neighbours, drag_factor, reynolds
from ryusa.laws.families import Drag, DragOfForm, Hindrance, Lift, Magnus, Profile, WaterTorque
from ryusa.laws.grain_step import flow_force
from ryusa.laws.lift import magnus_force, shear_lift_force
from ryusa.model.fluid import N_SAMPLED, SUBMERGED
from ryusa.model.rigid_bodies import NEWTON, SPHERICITY, STOKES


@inner()
def _profile_arguments(l: int, batch: Any, shared: Any) -> Any:
    u_star, k_rough, nu, speed = shared
    return batch[W.HEIGHT + l], u_star, k_rough, nu, speed


@inner()
def _to_speed(l: int, batch: Any, u_x: float) -> None:
    batch[W.PROFILE + l] = u_x


@inner()
def _hindrance_arguments(l: int, batch: Any, shared: Any) -> Any:
    exponent, nu, stress = shared
    return batch[W.SPEED + l], 1.0 - batch[W.PHI + l], exponent, batch[W.D + l], nu, stress


@inner()
def _to_hindrance(l: int, batch: Any, answer: Any) -> None:
    batch[W.ALONE + l], batch[W.FACTOR + l] = answer


@inner()
def _drag_arguments(l: int, batch: Any, shared: Any) -> Any:
    nu, c_d = shared
    return reynolds(batch[W.ALONE + l], batch[W.D + l], nu), c_d


@inner()
def _to_drag(l: int, batch: Any, c_d: float) -> None:
    batch[W.C_D + l] = c_d


@inner()
def _form_arguments(l: int, batch: Any, shared: Any) -> Any:
    nu, form = shared
    re = reynolds(batch[W.ALONE + l], batch[W.D + l], nu)
    return re, form[l, STOKES], form[l, NEWTON], form[l, SPHERICITY]


@inner()
def _lift_arguments(l: int, batch: Any, shared: Any) -> Any:
    nu, rho_w, a_2, c_l = shared
    u_x, shear, d = batch[W.U_X + l], batch[W.SHEAR + l], batch[W.D + l]
    half = 0.5 * shear * d
    return u_x + half, u_x - half, batch[W.SPEED + l], shear, d, nu, rho_w, a_2, c_l


@inner()
def _to_lift(l: int, batch: Any, answer: Any) -> None:
    batch[W.NORMAL + l], batch[W.ACROSS + l] = answer


@inner()
def _magnus_arguments(l: int, batch: Any, shared: Any) -> Any:
    nu, rho_w = shared
    return batch[W.SPEED + l], batch[W.WHIRL + l], batch[W.D + l], nu, rho_w


@inner()
def _to_magnus(l: int, batch: Any, k: float) -> None:
    batch[W.K_M + l] = k


@inner()
def _torque_arguments(l: int, batch: Any, shared: Any) -> Any:
    nu, rho_w = shared
    return batch[W.WHIRL + l], batch[W.D + l], nu, rho_w


@inner()
def _to_torque(l: int, batch: Any, k: float) -> None:
    batch[W.K_T + l] = k


# what the laws of each family are given, in order, and how lanes are read and written
_OF_PROFILE = ("z", "u_star", "k_rough", "nu", "speed"), _profile_arguments, _to_speed
_OF_HINDRANCE = ("slip", "eps", "exponent", "d", "nu", "stress"), _hindrance_arguments, _to_hindrance
_OF_DRAG = ("re", "c_d"), _drag_arguments, _to_drag
_OF_FORM = ("re", "stokes", "newton", "sphericity"), _form_arguments, _to_drag
_OF_LIFT = ("top", "bottom", "slip", "shear", "d", "nu", "rho_w", "a_2", "c_l"), _lift_arguments, _to_lift
_OF_MAGNUS = ("slip", "spin", "d", "nu", "rho_w"), _magnus_arguments, _to_magnus
_OF_TORQUE = ("spin", "d", "nu", "rho_w"), _torque_arguments, _to_torque


@cache
def _lanes(choice: Family, given: tuple[tuple[str, ...], Any, Any]) -> Any:
    """The loop of one law over lanes; None for a choice without a law."""
    return None if choice.function is None else lanes_of_law(choice, *given, W.LANES)


@inner(fastmath=FAST)
def _fill_spin(m: int, turns: bool, batch: Any) -> None:
    """Spin relative to the water, of which half the shear is the spin where `turns`."""
    for l in range(known_lanes(m, W.LANES)):
        o_x, o_y, o_z = batch[W.SPIN + 4 * l], batch[W.SPIN + 4 * l + 1], batch[W.SPIN + 4 * l + 2]
        batch[W.D + l] = 2.0 * batch[W.SPIN + 4 * l + 3]
        o_y -= 0.5 * batch[W.SHEAR + l] if turns else 0.0
        batch[W.O_X + l], batch[W.O_Y + l], batch[W.O_Z + l] = o_x, o_y, o_z
        batch[W.WHIRL + l] = length(o_x, o_y, o_z)
        batch[W.SPIN + 4 * l], batch[W.SPIN + 4 * l + 1] = o_x, o_y
        batch[W.SPIN + 4 * l + 2], batch[W.SPIN + 4 * l + 3] = o_z, 0.0


@inner(fastmath=FAST)
def _fill_column(m: int, batch: Any) -> None:
    """Slip in a column of water, and the force of its accelerating flow."""
    for l in range(known_lanes(m, W.LANES)):
        u_x, u_y, u_z = batch[W.SLIP + 4 * l], batch[W.SLIP + 4 * l + 1], batch[W.SLIP + 4 * l + 2]
        batch[W.SHEAR + l] = batch[W.SLIP + 4 * l + 3]
        batch[W.U_X + l], batch[W.U_Y + l], batch[W.U_Z + l] = u_x, u_y, u_z
        batch[W.SPEED + l] = length(u_x, u_y, u_z)
        batch[W.PHI + l], a_x = batch[W.FLUID + 4 * l], batch[W.FLUID + 4 * l + 1]
        extra_x, extra_z = batch[W.FLUID + 4 * l + 2], batch[W.FLUID + 4 * l + 3]
        batch[W.A_X + l] = a_x
        batch[W.FLOW + 4 * l] = flow_force(extra_x, batch[W.ADDED + l], a_x)
        batch[W.FLOW + 4 * l + 1], batch[W.FLOW + 4 * l + 2], batch[W.FLOW + 4 * l + 3] = 0.0, extra_z, 0.0


@inner(fastmath=FAST)
def _fill_heights(m: int, above: int, z_zero: float, depth: float, batch: Any) -> None:
    """Where grains are in water of a given profile; the first two of a centre are read to read all four."""
    for l in range(known_lanes(m, W.LANES)):
        x, y = batch[W.FLUID + 4 * l], batch[W.FLUID + 4 * l + 1]
        z, r = batch[W.FLUID + 4 * l + 2], batch[W.FLUID + 4 * l + 3]
        batch[W.HEIGHT + l], batch[W.SHARE + l] = height_in_profile(above, z, z_zero, depth)
        batch[W.D + l], batch[W.U_X + l], batch[W.U_Y + l] = 2.0 * r, x, y


@inner(fastmath=FAST)
def _fill_profile(m: int, batch: Any) -> None:
    """Slip in water of a given speed."""
    for l in range(known_lanes(m, W.LANES)):
        u_x, u_y, u_z = batch[W.SLIP + 4 * l], batch[W.SLIP + 4 * l + 1], batch[W.SLIP + 4 * l + 2]
        u_x += batch[W.PROFILE + l]
        batch[W.SPEED + l] = batch[W.ALONE + l] = length(u_x, u_y, u_z)
        batch[W.SLIP + 4 * l], batch[W.SLIP + 4 * l + 1] = u_x, u_y
        batch[W.SLIP + 4 * l + 2], batch[W.SLIP + 4 * l + 3] = u_z, 0.0


@inner(fastmath=FAST)
def _drag_over_slip(m: int, rho_w: float, a_2: float, batch: Any) -> None:
    for l in range(known_lanes(m, W.LANES)):
        batch[W.K_D + l] = batch[W.SHARE + l] * drag_among_neighbours(
            batch[W.SPEED + l], batch[W.ALONE + l], batch[W.FACTOR + l], batch[W.C_D + l], rho_w, a_2,
            batch[W.D + l],
        )  # fmt: skip


@inner(fastmath=FAST)
def _drag_of_isolated(m: int, rho_w: float, a_2: float, batch: Any) -> None:
    for l in range(known_lanes(m, W.LANES)):
        k_d = drag_factor(batch[W.SPEED + l], batch[W.C_D + l], rho_w, a_2, batch[W.D + l])
        batch[W.K_D + l] = batch[W.SHARE + l] * k_d


@inner(fastmath=FAST)
def _lift_and_magnus(m: int, batch: Any) -> None:
    for l in range(known_lanes(m, W.LANES)):
        u_x, u_y, u_z, share = batch[W.U_X + l], batch[W.U_Y + l], batch[W.U_Z + l], batch[W.SHARE + l]
        s_x, s_z = shear_lift_force(batch[W.NORMAL + l], batch[W.ACROSS + l], u_x, u_z)
        m_x, m_y, m_z = magnus_force(
            batch[W.K_M + l], -batch[W.O_X + l], -batch[W.O_Y + l], -batch[W.O_Z + l], u_x, u_y, u_z
        )
        batch[W.LIFT + 4 * l], batch[W.LIFT + 4 * l + 1] = share * (s_x + m_x), share * m_y
        batch[W.LIFT + 4 * l + 2], batch[W.LIFT + 4 * l + 3] = share * (s_z + m_z), 0.0


@inner(fastmath=FAST)
def _torque_in_water(m: int, batch: Any) -> None:
    for l in range(known_lanes(m, W.LANES)):
        batch[W.K_T + l] *= batch[W.SHARE + l]


@inner(fastmath=FAST, forceinline=True)
def _clear(first: int, rows: int, batch: Any) -> None:
    """Rows of what the scene goes without."""
    for l in range(rows * W.PITCH):
        batch[first + l] = 0.0


@cache
def make_forces_in_column(laws: FluidLaws, bodies: bool) -> Any:
    """Build forces_in_column for laws by number; of rigid bodies, with the drag of their form."""
    drag, lift, magnus, torque = laws.drag, laws.lift, laws.magnus, laws.torque
    stress = laws.buoyancy == STRESS
    hindrance_lanes = _lanes(Hindrance(laws.hindrance), _OF_HINDRANCE)
    formed, drag_lanes = _drag_lanes(laws, bodies)
    lift_lanes, magnus_lanes = _lanes(Lift(lift), _OF_LIFT), _lanes(Magnus(magnus), _OF_MAGNUS)
    torque_lanes = _lanes(WaterTorque(torque), _OF_TORQUE)

    @inner(fastmath=FAST)
    def forces_in_column(
        lo: int, hi: int, c: Any, v: Any, w: Any, m_all: Any, m_bare: Any, fluid: Any, batch: Any, form: Any
    ) -> None:
        """Coefficients and forces of the column of water on grains lo..hi-1, at most LANES, on as many lanes.

        `form` of bodies: columns of `RigidBodies.drag_form`, by lane.
        """
        nu, rho_w, a_2 = c[P.NU], c[P.RHO_W], c[P.A_2]
        for i in range(lo, hi):
            l = i - lo
            write4(batch, W.SLIP + 4 * l, read4(fluid, N_SAMPLED * i) - read4(v, 8 * i))
            copy4(batch, W.FLUID + 4 * l, fluid, N_SAMPLED * i + 4)
            copy4(batch, W.SPIN + 4 * l, w, 8 * i)
            share = fluid[i, SUBMERGED]
            batch[W.SHARE + l] = share
            # water moves along with what of a grain is in it
            batch[W.ADDED + l] = (m_all[i] - m_bare[i]) * share
        m = (hi - lo + 7) // 8 * 8
        _fill_column(m, batch)
        _fill_spin(m, True, batch)
        if drag == 0:
            _clear(W.K_D, 1, batch)
        else:
            hindrance_lanes(m, batch, (c[P.HINDRANCE], nu, stress))
            if formed:
                drag_lanes(m, batch, (nu, form))
            else:
                drag_lanes(m, batch, (nu, c[P.C_D]))
            _drag_over_slip(m, rho_w, a_2, batch)
        if lift == 0 and magnus == 0:
            _clear(W.LIFT, 4, batch)
        else:
            if lift == 0:
                _clear(W.NORMAL, 2, batch)
            else:
                lift_lanes(m, batch, (nu, rho_w, a_2, c[P.C_L]))
            if magnus == 0:
                _clear(W.K_M, 1, batch)
            else:
                magnus_lanes(m, batch, (nu, rho_w))
            _lift_and_magnus(m, batch)
        if torque:
            torque_lanes(m, batch, (nu, rho_w))
            _torque_in_water(m, batch)

    return forces_in_column


@cache
def make_forces_in_profile(laws: FluidLaws, bodies: bool) -> Any:
    """As `make_forces_in_column`, in water of a given profile, which neither lifts nor accelerates."""
    drag, torque, above = laws.drag, laws.torque, laws.above
    profile_lanes = _lanes(Profile(laws.profile), _OF_PROFILE)
    torque_lanes = _lanes(WaterTorque(torque), _OF_TORQUE)
    formed, drag_lanes = _drag_lanes(laws, bodies)

    @inner(fastmath=FAST)
    def forces_in_profile(lo: int, hi: int, c: Any, x: Any, v: Any, w: Any, batch: Any, form: Any) -> None:
        """Coefficients and forces on grains lo..hi-1, at most LANES, on as many lanes."""
        nu, rho_w, a_2 = c[P.NU], c[P.RHO_W], c[P.A_2]
        still = vec4_of(0.0, 0.0, 0.0, 0.0)
        for i in range(lo, hi):
            l = i - lo
            write4(batch, W.SLIP + 4 * l, still - read4(v, 8 * i))
            copy4(batch, W.FLUID + 4 * l, x, 4 * i)
            if torque:
                copy4(batch, W.SPIN + 4 * l, w, 8 * i)
        m = (hi - lo + 7) // 8 * 8
        _fill_heights(m, above, c[P.Z_ZERO], c[P.DEPTH], batch)
        if drag == 0:
            _clear(W.K_D, 1, batch)
        else:
            profile_lanes(m, batch, (c[P.U_STAR], c[P.K_ROUGH], nu, c[P.U_UNIFORM]))
            _fill_profile(m, batch)
            if formed:
                drag_lanes(m, batch, (nu, form))
            else:
                drag_lanes(m, batch, (nu, c[P.C_D]))
            _drag_of_isolated(m, rho_w, a_2, batch)
        if torque:
            _fill_spin(m, False, batch)
            torque_lanes(m, batch, (nu, rho_w))
            _torque_in_water(m, batch)

    return forces_in_profile


def _drag_lanes(laws: FluidLaws, bodies: bool) -> tuple[bool, Any]:
    """Whether drag coefficients are those of forms of rigid bodies, and their loop over lanes."""
    if bodies and DragOfForm(laws.drag_of_form) is not DragOfForm.SPHERE:
        return True, _lanes(DragOfForm(laws.drag_of_form), _OF_FORM)
    return False, _lanes(Drag(laws.drag), _OF_DRAG)


@cache
def make_forces_of_water(column: bool, laws: FluidLaws) -> Any:
    """Build forces_of_water(lo, hi, c, grains, batch) for the water that a scene has."""
    in_column: Any = make_forces_in_column(laws, False) if column else None
    in_profile: Any = None if column else make_forces_in_profile(laws, False)

    @inner(fastmath=FAST, forceinline=True)
    def forces_of_water(lo: int, hi: int, c: Any, grains: GrainArrays, batch: Any) -> None:
        """Coefficients and forces on grains lo..hi-1, at most LANES."""
        x, v, w, m, m_bare = grains.x, grains.v, grains.w, grains.m, grains.m_bare
        if column:
            in_column(lo, hi, c, v, w, m, m_bare, grains.fluid, batch, None)
        else:
            in_profile(lo, hi, c, x, v, w, batch, None)

    return forces_of_water
