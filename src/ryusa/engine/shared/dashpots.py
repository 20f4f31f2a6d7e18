"""Dashpots and stiffnesses of one pair: from the damping ratio, and from the immersed rebound at touch."""

from functools import cache
from typing import Any

from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner, kernel
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.collision import effective_mass, effective_mass_tangential, zeta_for_restitution
from ryusa.laws.contact import damping, damping_in_steps
from ryusa.laws.dispatch import wet_restitution
from ryusa.laws.hertz import hertz_damping, hertz_stiffness, mindlin_damping
from ryusa.laws.immersed import stokes_number
from ryusa.laws.kick_and_shear import dashpot_of_kick, springs_of_kicks
from ryusa.laws.rolling import reduced_radius


@inner(fastmath=FAST)
def dashpots(i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any) -> tuple[float, float]:
    """Normal and tangential dashpot of a pair [N s/m]; `x` as in `arrays.Grains`."""
    m_t = effective_mass_tangential(m[i], x[i, 3], inertia[i], m[j], x[j, 3], inertia[j], rotation != 0)
    m_n = effective_mass(m[i], m[j])
    return (
        c[P.ETA_N] + damping_in_steps(damping(c[P.ZETA_N], c[P.K_N], m_n), m_n, c[P.DT]),
        c[P.ETA_S] + damping_in_steps(damping(c[P.ZETA_S], c[P.K_S], m_t), m_t, c[P.DT]),
    )


@inner(fastmath=FAST)
def normal_kicks(at: int, k: float, m: float, dt: float, out: Any) -> None:
    """Fill the normal columns of row `at` of `out` from the dashpot at kicks that it has (memory_rows.py)."""
    out[at, M.K_N], out[at, M.WAY], out[at, M.AFTER], out[at, M.STORED], _ = springs_of_kicks(
        k, out[at, M.ETA_N], m, dt
    )
    out[at, M.MASS] = m


@inner(fastmath=FAST)
def kicks_of_pair(
    at: int, i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any, out: Any
) -> None:
    """Fill row `at` of `out` with the springs and dashpots of a pair with exact timing (memory_rows.py)."""
    m_t = effective_mass_tangential(m[i], x[i, 3], inertia[i], m[j], x[j, 3], inertia[j], rotation != 0)
    m_n = effective_mass(m[i], m[j])
    eta_n = c[P.ETA_N] + damping(c[P.ZETA_N], c[P.K_N], m_n)
    eta_s = dashpot_of_kick(c[P.ETA_S] + damping(c[P.ZETA_S], c[P.K_S], m_t), m_t, c[P.DT])
    out[at, M.ETA_N], out[at, M.ETA_S], out[at, M.MASS_S] = dashpot_of_kick(eta_n, m_n, c[P.DT]), eta_s, m_t
    normal_kicks(at, c[P.K_N], m_n, c[P.DT], out)
    _, _, _, _, out[at, M.K_S] = springs_of_kicks(c[P.K_S], eta_s, m_t, c[P.DT])


@inner(fastmath=FAST)
def springs_hertz(
    i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any
) -> tuple[float, float, float, float]:
    """Dashpots over x**0.25 [N s/m**1.25], stiffness K [N/m**1.5] and 1/m [1/kg] of two elastic spheres."""
    m_t = effective_mass_tangential(m[i], x[i, 3], inertia[i], m[j], x[j, 3], inertia[j], rotation != 0)
    m_n = effective_mass(m[i], m[j])
    k = hertz_stiffness(c[P.E_EFFECTIVE], reduced_radius(x[i, 3], x[j, 3]))
    return (
        hertz_damping(c[P.ZETA_N], k, m_n),
        mindlin_damping(c[P.ZETA_S], c[P.MINDLIN] * k, m_t),
        k,
        1.0 / m_n,
    )


@inner(fastmath=FAST)
def set_springs(
    at: int, i: int, j: int, rotation: int, kind: int, c: Any, m: Any, x: Any, inertia: Any, out: Any
) -> None:
    """Fill row `at` of `out` with the dashpots, and those of a kind with the stiffnesses, of pair i, j."""
    if kind == M.OF_KICKS:
        kicks_of_pair(at, i, j, rotation, c, m, x, inertia, out)
    elif kind == M.HERTZ:
        out[at, M.ETA_N], out[at, M.ETA_S], out[at, M.K_HERTZ], out[at, M.PER_MASS] = springs_hertz(
            i, j, rotation, c, m, x, inertia
        )
    else:
        out[at, M.ETA_N], out[at, M.ETA_S] = dashpots(i, j, rotation, c, m, x, inertia)


@cache
def make_set_springs(kind: int) -> Any:
    """Build set_springs(at, i, j, rotation, c, m, x, inertia, out) of one kind alone."""
    of_kicks, of_spheres = kind == M.OF_KICKS, kind == M.HERTZ

    @inner(fastmath=FAST)
    def set_springs_of_kind(
        at: int, i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any, out: Any
    ) -> None:
        """Fill row `at` of `out` with the dashpots and stiffnesses of pair i, j."""
        if of_kicks:
            kicks_of_pair(at, i, j, rotation, c, m, x, inertia, out)
        elif of_spheres:
            out[at, M.ETA_N], out[at, M.ETA_S], out[at, M.K_HERTZ], out[at, M.PER_MASS] = springs_hertz(
                i, j, rotation, c, m, x, inertia
            )
        else:
            out[at, M.ETA_N], out[at, M.ETA_S] = dashpots(i, j, rotation, c, m, x, inertia)

    return set_springs_of_kind


@cache
def make_springs_of(kind: int) -> Any:
    """Build springs_of(i, j, rotation, c, m, x, inertia, out) of one kind."""
    set_springs_of_kind = make_set_springs(kind)

    @kernel()
    def springs_of(i: Any, j: Any, rotation: int, c: Any, m: Any, x: Any, inertia: Any, out: Any) -> None:
        """Fill `out`, (n, KernelVariant.springs), with those of pairs i, j."""
        for k in range(len(i)):
            set_springs_of_kind(k, i[k], j[k], rotation, c, m, x, inertia, out)

    return springs_of


@kernel()
def normal_springs_of(i: Any, j: Any, c: Any, m: Any, out: Any) -> None:
    """Fill the normal springs of pairs i, j with exact timing from the dashpots that `out` has."""
    for k in range(len(i)):
        normal_kicks(k, c[P.K_N], effective_mass(m[i[k]], m[j[k]]), c[P.DT], out)


@inner(fastmath=FAST)
def zeta_immersed(choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any) -> float:
    """Damping ratio of a pair that just touched under water at a closing speed [-]."""
    m_n = effective_mass(m[i], m[j])
    st = stokes_number(closing, m_n, reduced_radius(w[i, 3], w[j, 3]), c[P.RHO_W], c[P.NU])
    smaller = 2.0 * min(w[i, 3], w[j, 3])
    e = wet_restitution(choice.rebound, c[P.E_DRY], st, c[P.ST_C], c[P.ASPERITY], smaller)
    return zeta_for_restitution(max(e, c[P.E_LEAST]), choice.tension != 0)


@inner(fastmath=FAST)
def damping_immersed(
    choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any
) -> tuple[float, float]:
    """Effective mass [kg] and dashpot [N s/m] of a pair that just touched under water at a closing speed."""
    m_n = effective_mass(m[i], m[j])
    return m_n, damping(zeta_immersed(choice, closing, i, j, c, m, w), c[P.K_N], m_n)


@kernel()
def dashpot_immersed(choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any) -> float:
    """Normal dashpot [N s/m] of a pair that just touched under water at this closing speed."""
    m_n, eta = damping_immersed(choice, closing, i, j, c, m, w)
    return damping_in_steps(eta, m_n, c[P.DT])


@inner(fastmath=FAST)
def springs_immersed(
    at: int, choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any, out: Any
) -> None:
    """Give row `at` of `out` the normal dashpot of `dashpot_immersed`, and the kicks that it makes."""
    m_n, eta = damping_immersed(choice, closing, i, j, c, m, w)
    out[at, M.ETA_N] = dashpot_of_kick(eta, m_n, c[P.DT])
    normal_kicks(at, c[P.K_N], m_n, c[P.DT], out)


@kernel()
def dashpot_immersed_hertz(
    choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any
) -> float:
    """Normal dashpot over x**0.25 [N s/m**1.25] of two elastic spheres, as in `dashpot_immersed`."""
    k = hertz_stiffness(c[P.E_EFFECTIVE], reduced_radius(w[i, 3], w[j, 3]))
    return hertz_damping(zeta_immersed(choice, closing, i, j, c, m, w), k, effective_mass(m[i], m[j]))
