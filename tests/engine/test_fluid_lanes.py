"""Forces of the water on lanes: the numbers of one grain alone, for every law, by vector instructions."""

import re

import numpy as np
import pytest
from numba import njit
from numba.core.caching import NullCache

from ryusa.compiled.dispatcher import Entry
from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu.fluid_forces import make_forces_in_column, make_forces_in_profile
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.fluid import column_forces, profile_drag, torque_over_spin
from ryusa.engine.shared.variant import FluidLaws, LawChoice
from ryusa.laws.families import Above, Buoyancy, Drag, Hindrance, Lift, Magnus, Profile, WaterTorque
from ryusa.model.fluid import N_SAMPLED, PHI, SUBMERGED

N = 61  # not a whole number of vectors
NOTHING = LawChoice(*(0,) * len(LawChoice._fields))
COLUMN = NOTHING._replace(profile=int(Profile.COLUMN), buoyancy=int(Buoyancy.STRESS))
CHOICES = [
    *(COLUMN._replace(drag=int(Drag.RE_04), hindrance=int(one)) for one in Hindrance),
    *(COLUMN._replace(drag=int(one), hindrance=int(Hindrance.WEN_YU)) for one in Drag),
    *(COLUMN._replace(lift=int(one)) for one in Lift),
    *(COLUMN._replace(magnus=int(one)) for one in Magnus),
    *(COLUMN._replace(torque=int(one)) for one in WaterTorque),
]
GIVEN = [
    NOTHING._replace(profile=int(one), above=int(above), drag=int(Drag.RE_04))
    for one in Profile
    if one not in (Profile.NONE, Profile.COLUMN)
    for above in Above
]


def words(choice):
    return "-".join(f"{name}{value}" for name, value in choice._asdict().items() if value)


@pytest.fixture
def grains():
    """Rows of grains in water, as the engine keeps them: centres, velocities beside spins, water, masses."""
    rng = np.random.default_rng(5)
    x, both, fluid = zeros(np.float64, N, 4), zeros(np.float64, N, 8), zeros(np.float64, N, N_SAMPLED)
    x[:, :3], x[:, 3] = rng.uniform(-0.002, 0.03, (N, 3)), rng.uniform(0.0005, 0.002, N)
    both[:, :3], both[:, 4:7], both[:, 7] = rng.normal(size=(N, 3)), 50.0 * rng.normal(size=(N, 3)), x[:, 3]
    fluid[:] = rng.normal(size=(N, N_SAMPLED))
    fluid[:, PHI], fluid[:, SUBMERGED] = rng.uniform(0.0, 0.7, N), rng.uniform(0.1, 1.0, N)
    both[0, :3] = fluid[0, :3]  # no slip
    fluid[1, SUBMERGED] = 0.0
    c = np.zeros(P.N_PARAMETER)
    for place, value in {
        P.NU: 1.0e-6, P.RHO_W: 1000.0, P.A_2: 0.7854, P.C_D: 0.4, P.HINDRANCE: 3.1, P.C_L: 0.2, P.U_STAR: 0.1,
        P.K_ROUGH: 0.002, P.U_UNIFORM: 0.3, P.DEPTH: 0.02, P.Z_ZERO: 0.001,
    }.items():  # fmt: skip
        c[place] = value
    return x, both[:, :4], both[:, 4:], fluid, rng.uniform(2.0, 3.0, N), rng.uniform(1.0, 2.0, N), c


def laws_of(choice):
    return FluidLaws(*(getattr(choice, name) for name in FluidLaws._fields))


def in_column(choice, c, v, w, m, m_bare, fluid, batch):
    compiled = make_forces_in_column(laws_of(choice), False)
    compiled(0, len(fluid), c, v, w, m, m_bare, fluid, batch, None)
    return compiled


def in_profile(choice, c, x, v, w, batch):
    compiled = make_forces_in_profile(laws_of(choice), False)
    compiled(0, len(x), c, x, v, w, batch, None)
    return compiled


@njit
def alone_in_column(choice, c, x, v, w, fluid, out):
    for i in range(len(out)):
        out[i] = column_forces(choice, c, x[i, 3], fluid[i], v[i], w[i])


@njit
def torque_alone(choice, c, x, w, fluid, out):
    for i in range(len(out)):
        turn = 0.5 * fluid[i, 3]
        out[i] = torque_over_spin(choice, c, fluid[i, 8], x[i, 3], w[i, 0], w[i, 1] - turn, w[i, 2])


@njit
def alone_in_profile(choice, c, x, v, out):
    for i in range(len(out)):
        dry, d_x, d_y, d_z = profile_drag(choice, c, x[i, 3], x[i, 2], v[i, 0], v[i, 1], v[i, 2])
        out[i] = (d_x, d_y, d_z) if not dry else (0.0, 0.0, 0.0)


def group(batch, place):
    return batch[place : place + 4 * N].reshape(N, 4)


@pytest.mark.full
@pytest.mark.parametrize("choice", CHOICES, ids=words)
def test_lanes_hold_what_one_grain_in_a_column_feels(choice, grains):
    x, v, w, fluid, m, m_bare, c = grains
    batch, out = zeros(np.float64, W.SIZE), np.zeros((N, 7))
    in_column(choice, c, v, w, m, m_bare, fluid, batch)
    alone_in_column(choice, c, x, v, w, fluid, out)
    assert np.isfinite(out).all()
    assert batch[W.K_D : W.K_D + N] == pytest.approx(out[:, 0], rel=1e-13)
    assert group(batch, W.LIFT)[:, :3] == pytest.approx(out[:, 4:], rel=1e-13, abs=1e-13 * abs(out).max())
    if choice.torque:
        found = np.zeros(N)
        torque_alone(choice, c, x, w, fluid, found)
        assert batch[W.K_T : W.K_T + N] == pytest.approx(found, rel=1e-13)


@pytest.mark.parametrize("choice", GIVEN, ids=words)
def test_lanes_hold_what_one_grain_in_given_water_feels(choice, grains):
    x, v, w, _, _, _, c = grains
    batch, out = zeros(np.float64, W.SIZE), np.zeros((N, 3))
    in_profile(choice, c, x, v, w, batch)
    alone_in_profile(choice, c, x, v, out)
    drag = batch[W.K_D : W.K_D + N, None] * group(batch, W.SLIP)[:, :3]
    assert np.isfinite(out).all()
    assert np.count_nonzero(out) > N
    assert drag == pytest.approx(out, rel=1e-13)


def test_a_law_outside_its_family_is_refused_before_it_is_compiled():
    with pytest.raises(ValueError, match="99 is not a valid Drag"):
        make_forces_in_column(laws_of(COLUMN._replace(drag=99)), False)


def test_a_lane_does_not_depend_on_its_place(grains):
    _, v, w, fluid, m, m_bare, c = grains
    choice = COLUMN._replace(
        drag=int(Drag.SCHILLER_NAUMANN), hindrance=int(Hindrance.DI_FELICE), lift=int(Lift.SAFFMAN_MEI),
        magnus=int(Magnus.OESTERLE_DINH), torque=int(WaterTorque.DENNIS),
    )  # fmt: skip
    whole, one = zeros(np.float64, W.SIZE), zeros(np.float64, W.SIZE)
    in_column(choice, c, v, w, m, m_bare, fluid, whole)
    for i in range(N):
        rows = [np.ascontiguousarray(a[i : i + 1]) for a in (m, m_bare, fluid)]
        in_column(choice, c, v[i : i + 1], w[i : i + 1], *rows, one)
        assert one[W.K_D] == whole[W.K_D + i]
        assert one[W.K_T] == whole[W.K_T + i]
        assert (one[W.LIFT : W.LIFT + 4] == whole[W.LIFT + 4 * i : W.LIFT + 4 * i + 4]).all()


def test_no_law_on_lanes_leaves_them_for_a_call_of_the_library(grains):
    x, v, w, fluid, m, m_bare, c = grains
    column = in_column(CHOICES[0], c, v, w, m, m_bare, fluid, zeros(np.float64, W.SIZE))
    profile = in_profile(GIVEN[0], c, x, v, w, zeros(np.float64, W.SIZE))
    for loop in (column, profile):
        for kinds in loop.entry.signatures:
            compiler = Entry(loop, loop.entry.targetoptions)
            compiler._cache = NullCache()  # it is to be compiled here, not taken from a store
            compiler.compile(kinds)
            code = compiler.overloads[kinds].library.get_llvm_str()
            # each product of a law is there twice: for vectors, and for the grains left at the end of a loop;
            # how many there are is the compiler's choice
            vectors = len(re.findall(r"fmul.* <\d+ x double>", code))
            assert vectors > 0.9 * len(re.findall(r"fmul [a-z ]*double", code)) > 0
            assert not re.findall(r"@(?:llvm\.)?(?:exp|expm1|log|log10|pow|tanh)\b", code)
