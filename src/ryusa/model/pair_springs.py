"""Stiffness and attraction of single pairs, as the steps of a scene use them."""

import math

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.collision import effective_mass, effective_mass_tangential
from ryusa.laws.contact import damping
from ryusa.laws.families import Adhesion, ContactForce, ContactTiming
from ryusa.laws.hertz import effective_modulus, hertz_stiffness, mindlin_ratio
from ryusa.laws.kick_and_shear import dashpot_of_kick, springs_of_kicks
from ryusa.model.contact_law import attraction_of
from ryusa.model.scene import Floats, Scene

Ints = NDArray[np.int64]


def pair_springs(scene: Scene, i: Ints, j: Ints, overlap: Floats) -> tuple[Floats, Floats]:
    """Normal and tangential stiffness of each pair [N/m], both of shape (n,).

    Parameters
    ----------
    scene : law, masses and time step.
    i, j : ids of each pair, shape (n,); i is a free grain, j a free grain, a fixed grain, a plane or a face.
    overlap : of each pair [m], shape (n,); only the stiffness of elastic spheres depends on it.

    Notes
    -----
    Of elastic spheres the normal one is the force over the overlap, the tangential one that at the overlap
    (design/0018). Else they are those of the law; the tangential one with exact timing that of its kicks
    (design/0014), which depends on the masses and the step.
    """
    if scene.materials is not None:
        k_n, k_s = np.empty(len(i)), np.empty(len(i))
        for one, some in scene.by_pair(i, j):
            k_n[some], k_s[some] = pair_springs(one, i[some], j[some], overlap[some])
        return k_n, k_s
    law, n = scene.contact, len(i)
    if law.force == ContactForce.HERTZ_MINDLIN:
        return _springs_hertz(scene, i, j, overlap)
    k_n, k_s = np.full(n, law.k_n), np.full(n, law.k_s)
    if law.timing != ContactTiming.EXACT or n == 0:
        return k_n, k_s
    beyond = np.full(scene.n_partner - scene.n_grain, math.inf)
    m = np.concatenate([scene.m + scene.m_added, beyond])
    inertia = np.concatenate([scene.inertia, beyond])
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane + scene.n_face, math.inf)])
    both = np.column_stack([m[i], r[i], inertia[i], m[j], r[j], inertia[j]])
    kinds, place = np.unique(both, axis=0, return_inverse=True)
    found = np.array([_springs_of_kicks(scene, *(float(one) for one in kind)) for kind in kinds])[
        place.ravel()
    ]
    return found[:, 0], found[:, 1]


def pair_attractions(scene: Scene, i: Ints, j: Ints, overlap: Floats) -> tuple[Floats, Floats]:
    """Attraction of each pair in touch [N], and the energy that it has released [J], both of shape (n,).

    Parameters
    ----------
    scene, i, j, overlap : as in `pair_springs`.
    """
    force, energy = np.zeros(len(i)), np.zeros(len(i))
    if scene.contact.adhesion == Adhesion.NONE:
        return force, energy
    for one, some in scene.by_pair(i, j):
        pull, slope = attraction_of(one.contact, 1.0)  # by the radius, or the same for all pairs
        r = 1.0 if one.contact.adhesion == Adhesion.CONSTANT else _reduced_radii(scene, i[some], j[some])
        x = np.maximum(overlap[some], 0.0)
        force[some] = r * (pull + slope * x)
        energy[some] = r * (pull + 0.5 * slope * x) * x
    return force, energy


def _reduced_radii(scene: Scene, i: Ints, j: Ints) -> Floats:
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane + scene.n_face, math.inf)])
    return 1.0 / (1.0 / r[i] + 1.0 / r[j])


def _springs_hertz(scene: Scene, i: Ints, j: Ints, overlap: Floats) -> tuple[Floats, Floats]:
    law, r_eff = scene.contact, _reduced_radii(scene, i, j)
    k_n = hertz_stiffness(effective_modulus(law.youngs_modulus, law.poisson_ratio), 1.0) * np.sqrt(r_eff)
    k_n *= np.sqrt(np.maximum(overlap, 0.0))
    return k_n, mindlin_ratio(law.poisson_ratio) * k_n


def _springs_of_kicks(
    scene: Scene, m_i: float, r_i: float, inertia_i: float, m_j: float, r_j: float, inertia_j: float
) -> tuple[float, float]:
    law = scene.contact
    m_n = effective_mass(m_i, m_j)
    m_t = effective_mass_tangential(m_i, r_i, inertia_i, m_j, r_j, inertia_j, bool(scene.rotation))
    eta_s = law.eta_s + damping(law.zeta_s, law.k_s, m_t)
    eta_n = law.eta_n + damping(law.zeta_n, law.k_n, m_n)
    normal = springs_of_kicks(law.k_n, dashpot_of_kick(eta_n, m_n, scene.dt), m_n, scene.dt)
    tangential = springs_of_kicks(law.k_s, dashpot_of_kick(eta_s, m_t, scene.dt), m_t, scene.dt)
    return normal[0], tangential[-1]
