"""Dashpots of one pair: from the damping ratio, and from the immersed rebound at first touch."""

from typing import Any

from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import inner, kernel
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.collision import effective_mass, effective_mass_tangential, zeta_for_restitution
from ryusa.laws.contact import damping, damping_in_steps
from ryusa.laws.dispatch import wet_restitution
from ryusa.laws.immersed import stokes_number
from ryusa.laws.rolling import reduced_radius


@inner()
def dashpots(i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any) -> tuple[float, float]:
    """Normal and tangential dashpot of a pair [N s/m]; `x` as in `arrays.Grains`."""
    m_t = effective_mass_tangential(m[i], x[i, 3], inertia[i], m[j], x[j, 3], inertia[j], rotation != 0)
    m_n = effective_mass(m[i], m[j])
    return (
        c[P.ETA_N] + damping_in_steps(damping(c[P.ZETA_N], c[P.K_N], m_n), m_n, c[P.DT]),
        c[P.ETA_S] + damping_in_steps(damping(c[P.ZETA_S], c[P.K_S], m_t), m_t, c[P.DT]),
    )


@kernel()
def dashpots_of(i: Any, j: Any, rotation: int, c: Any, m: Any, x: Any, inertia: Any, out: Any) -> None:
    """Fill `out`, (n, 2), with the dashpots of pairs i, j."""
    for k in range(len(i)):
        out[k, M.ETA_N], out[k, M.ETA_S] = dashpots(i[k], j[k], rotation, c, m, x, inertia)


@kernel()
def dashpot_immersed(choice: LawChoice, closing: float, i: int, j: int, c: Any, m: Any, w: Any) -> float:
    """Normal dashpot [N s/m] of a pair that just touched under water at this closing speed."""
    m_n = effective_mass(m[i], m[j])
    st = stokes_number(closing, m_n, reduced_radius(w[i, 3], w[j, 3]), c[P.RHO_W], c[P.NU])
    smaller = 2.0 * min(w[i, 3], w[j, 3])
    e = wet_restitution(choice.rebound, c[P.E_DRY], st, c[P.ST_C], c[P.ASPERITY], smaller)
    zeta = zeta_for_restitution(max(e, c[P.E_LEAST]), choice.tension != 0)
    return damping_in_steps(damping(zeta, c[P.K_N], m_n), m_n, c[P.DT])
