"""Forces and energies that the history of contacts in a snapshot holds."""

from typing import NamedTuple

import numpy as np

from ryusa.engine.shared.contact_instants import BACK, BEGAN
from ryusa.laws.families import ContactForce
from ryusa.laws.rolling import epsd_stiffness, reduced_radius
from ryusa.model import Scene, State
from ryusa.model.pair_springs import pair_attractions, pair_springs
from ryusa.model.scene import Floats
from ryusa.model.wall_contacts import shares_of_contacts
from ryusa.model.wall_shape import ways_to_faces


class ContactForces(NamedTuple):
    """Forces of some contacts in the last step, at x - v dt."""

    normal: Floats  # unit, from grain i to its partner, shape (n_contact, 3)
    force: Floats  # on grain i [N], shape (n_contact, 3)


class SpringEnergies(NamedTuple):
    """Energy in springs [J]."""

    normal: float  # less that released by adhesion
    tangential: float
    rolling: float


def forces_of_contacts(scene: Scene, state: State, places: np.ndarray) -> ContactForces:
    """Forces of some contacts of a snapshot.

    Parameters
    ----------
    scene, state : the scene, and a snapshot; its contact history holds the forces of the step before.
    places : of the contacts, among those of the state.
    """
    held = state.contacts
    x, i, j = state.x - state.v * scene.dt, held.i[places], held.j[places]
    every = np.concatenate([x, scene.x_fixed.reshape(-1, 3)])
    plane = (j >= len(every)) & (j < len(every) + scene.n_plane)
    face = j >= len(every) + scene.n_plane
    grain = ~(plane | face)
    normal = np.zeros((len(i), 3))
    gap = every[j[grain]] - x[i[grain]]
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            gap[:, axis] -= period * np.round(gap[:, axis] / period)
    if scene.plane_case:
        gap[:, 1] = 0.0
    normal[grain] = gap / np.linalg.norm(gap, axis=1)[:, None]
    if scene.walls is not None and face.any():
        number = j[face] - len(every) - scene.n_plane
        ways = ways_to_faces(scene.walls, number, x[i[face]], state.t - scene.dt, scene.period)
        normal[face] = ways / np.linalg.norm(ways, axis=1)[:, None]
    normal[plane] = -scene.plane_normal[j[plane] - len(every)]
    shear = (held.spring_s[places] + held.dash_s[places]) * _in_force(state, places)[:, None]
    if scene.plane_case:  # one component, along (n_z, 0, -n_x)
        along = shear[:, 0]
        shear = np.stack([along * normal[:, 2], np.zeros(len(i)), -along * normal[:, 0]], axis=1)
    f_n = held.f_n[places] - pair_attractions(scene, i, j, overlaps_of_contacts(scene, state, places))[0]
    share = shares_of_contacts(scene, x, state.t - scene.dt, i, j)
    return ContactForces(normal, share[:, None] * (shear - f_n[:, None] * normal))


def _in_force(state: State, places: np.ndarray) -> Floats:
    """1 for contacts that had a force in the last step, 0 for those whose spring is that of the next one."""
    states = state.contacts.state[places]
    return np.where((states == BEGAN) | (states == BACK), 0.0, 1.0)


def overlaps_of_contacts(scene: Scene, state: State, places: np.ndarray) -> Floats:
    """Overlaps of some contacts that begin and end at steps, in the last step of a snapshot [m]."""
    held = state.contacts
    if scene.contact.force == ContactForce.HERTZ_MINDLIN:
        return held.overlap[places]
    return (held.f_n[places] - held.dash_n[places]) / scene.contact.k_n


def energies_of_springs(scene: Scene, state: State, places: np.ndarray) -> SpringEnergies:
    """Energy in the springs of some contacts of a snapshot.

    Parameters
    ----------
    scene, state, places : as in `forces_of_contacts`.
    """
    if not len(places):
        return SpringEnergies(0.0, 0.0, 0.0)
    held = state.contacts
    overlap, i, j = held.overlap[places], held.i[places], held.j[places]
    share = shares_of_contacts(scene, state.x - state.v * scene.dt, state.t - scene.dt, i, j)
    k_n, k_s = pair_springs(scene, held.i[places], held.j[places], overlap)
    e_n = held.f_n[places] - held.dash_n[places]
    if scene.contact.force == ContactForce.HERTZ_MINDLIN:
        normal = float(np.sum(share * 0.4 * e_n * overlap))
    else:
        normal = float(np.sum(share * 0.5 * e_n**2 / np.where(held.k_n[places] > 0.0, held.k_n[places], k_n)))
    normal -= float(pair_attractions(scene, i, j, overlaps_of_contacts(scene, state, places))[1].sum())
    tangential = 0.0
    if scene.contact.k_s > 0.0:
        share = share * _in_force(state, places)
        tangential = float(np.sum(0.5 * share[:, None] * held.spring_s[places] ** 2 / k_s[:, None]))
    return SpringEnergies(normal, tangential, rolling_energy(scene, state, places))


def rolling_energy(scene: Scene, state: State, places: np.ndarray) -> float:
    """Energy in the rolling springs of some of a state's contacts [J]."""
    if "spring" not in scene.rolling.model.marks:
        return 0.0
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane + scene.n_face, np.inf)])
    energy, i, j = 0.0, state.contacts.i[places], state.contacts.j[places]
    for one, some in scene.by_pair(i, j):
        for place in places[some]:
            radius = reduced_radius(float(r[state.contacts.i[place]]), float(r[state.contacts.j[place]]))
            f = one.rolling.coefficient * radius
            k_r = epsd_stiffness(one.contact.k_n, f, one.rolling.stiffness_factor)
            energy += 0.5 * float(np.sum(state.contacts.spring_r[place] ** 2)) / k_r if k_r > 0.0 else 0.0
    return energy
