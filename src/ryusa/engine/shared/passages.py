"""Grains taken out of a snapshot and put into it; their energy goes through the account as a change.

The account of a step belongs to x(n), and a snapshot holds x(n+1) and v(n+1/2). A grain that leaves takes
what it held at x(n), (1/2) m v(n-1/2).v(n+1/2) and its height; v(n-1/2) follows from the weight and the
contact forces of that step, so that grains leave without a residual, also out of contacts. Their springs are
let go; what the force of a grain that leaves still does to its partner in the second half of the step is
entered too, and a moving wall does no more work on it. Forces of water in that step are left out of v(n-1/2):
so a grain takes along the work of the second half as well, which is booked with the next step whether it is
there or not, and nothing remains. A grain that enters brings (1/2) m v(n+1/2).(v(n+1/2) + dt g m_weight/m),
to which the next step adds the work of all other forces; it touches nothing. In a column m counts the water
that moves along with what of a grain is in it by `State.fluid`, in which grains that enter have to be.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.shared.contact_history import SpringEnergies, energies_of_springs, forces_of_contacts
from ryusa.engine.shared.contact_records import closed_records, sorted_events
from ryusa.engine.shared.passing_bodies import (
    Held,
    half_step_on_bodies,
    held_at_entry,
    held_by_bodies,
    split,
    with_bodies,
)
from ryusa.laws.families import ContactTiming
from ryusa.model import BodyState, Scene, State, Tally, Term
from ryusa.model.arrays import Bools, Floats
from ryusa.model.contacts import N_EVENT
from ryusa.model.fluid import SUBMERGED
from ryusa.model.scene import EventRule
from ryusa.model.tally import N_TERM, PENDING
from ryusa.model.wall_shape import ways_to_faces
from ryusa.model.walls import N_IMPULSE, SPIN, WORK, pose, surface_velocity

Ints = NDArray[np.int64]
_NO_SPRINGS = SpringEnergies(0.0, 0.0, 0.0)


class Entering(NamedTuple):
    """Grains to be put into a snapshot, in any order of ids; a clump by its first member."""

    ids: Ints
    x: Floats  # centres, inside the period [m], shape (n, 3)
    v: Floats  # [m/s]
    omega: Floats  # [rad/s]
    q: Floats  # orientations of clumps, shape (n, 4)


def everywhere(state: State) -> Bools:
    """Whether each grain of a state is there, shape (n_grain,)."""
    return state.present if len(state.present) else np.ones(state.n_grain, dtype=np.bool_)


def removed(scene: Scene, state: State, ids: Ints) -> tuple[State, np.ndarray]:
    """Take grains out of a snapshot.

    Parameters
    ----------
    scene, state : the scene, and a snapshot of all its grains (`GrainPool.state`).
    ids : of the grains, present ones; of a clump one member at least.

    Returns
    -------
    state : without them; their rows are nan.
    events : records of the contacts that end with it, dtype EVENT; values at parting are nan.
    """
    if not len(ids):
        return state, sorted_events(())
    ids = scene.spheres_of(ids)
    leaves = np.zeros(scene.n_grain, dtype=np.bool_)
    leaves[ids] = True
    held = state.contacts
    touches = leaves[held.i] | (leaves[np.minimum(held.j, scene.n_grain - 1)] & (held.j < scene.n_grain))
    places = np.flatnonzero(touches)
    recorded = scene.events != EventRule.NONE
    rows = closed_records(state, places) if recorded else np.zeros((0, N_EVENT))
    tally = _less(scene, state, ids, leaves, places)
    kept = replace(held, **{name: array[~touches] for name, array in vars(held).items()})
    x, v, omega = (array.copy() for array in (state.x, state.v, state.omega))
    x[ids] = v[ids] = omega[ids] = np.nan
    image = state.image.copy()
    if len(image):
        image[ids] = 0
    bodies = state.bodies
    if bodies is not None:
        bodies = with_bodies(bodies, split(scene, ids)[1], None)
    state = replace(
        state, x=x, v=v, omega=omega, image=image, contacts=kept, tally=tally, engine=None,
        present=everywhere(state) & ~leaves, bodies=bodies,
    )  # fmt: skip
    return state, sorted_events([rows])


def placed(scene: Scene, state: State, grains: Entering) -> State:
    """Put grains into a snapshot; they touch nothing."""
    if not len(grains.ids):
        return state
    ids, there = scene.spheres_of(grains.ids), everywhere(state).copy()
    there[ids] = True
    x, v, omega = (array.copy() for array in (state.x, state.v, state.omega))
    x[grains.ids], v[grains.ids], omega[grains.ids] = grains.x, grains.v, grains.omega
    bodies = state.bodies
    if scene.bodies is not None and bodies is not None:
        of = scene.bodies.of_grain(scene.n_grain)[grains.ids]
        made = of >= 0
        some = scene.bodies.some(of[made], scene.bodies.first[of[made]])
        put = BodyState.of(some, *(one[made] for one in (grains.x, grains.v, grains.q, grains.omega)))
        bodies = with_bodies(bodies, of[made], put)
        x[some.members], v[some.members], omega[some.members] = put.of_members(some)
    image = state.image.copy() if len(state.image) else np.zeros((scene.n_grain, 2), dtype=np.int32)
    image[ids] = 0
    state = replace(state, x=x, v=v, omega=omega, image=image, engine=None, present=there, bodies=bodies)
    return replace(state, tally=_more(scene, state, ids))


def _less(scene: Scene, state: State, ids: Ints, leaves: Bools, places: Ints) -> Tally | None:
    """The account without the grains of some ids, whose contacts are at `places`."""
    contacts, dt = state.contacts, scene.dt
    force, torque = np.zeros((scene.n_grain, 3)), np.zeros((scene.n_grain, 3))
    to_partners = 0.0
    springs, of_walls = _NO_SPRINGS, np.zeros(scene.n_wall)
    if len(places):
        springs = energies_of_springs(scene, state, places)
        normal, on_i = forces_of_contacts(scene, state, places)
        of_walls = _pending_of_walls(scene, state, places, normal, on_i)
        i, j = contacts.i[places], contacts.j[places]
        free = j < scene.n_grain
        about = np.cross(normal, on_i)  # times the radius: the torque on either side
        np.add.at(force, i, on_i)
        np.add.at(torque, i, 0.5 * scene.d[i, None] * about)
        np.add.at(force, j[free], -on_i[free])
        np.add.at(torque, j[free], 0.5 * scene.d[j[free], None] * about[free])
        stays = np.unique(np.concatenate([i, j[free]]))
        stays, partners = split(scene, stays[~leaves[stays]])
        to_partners = half_step_on_bodies(scene, state, partners, force, torque)
        to_partners += 0.5 * dt * float(np.sum(force[stays] * state.v[stays]))
        if scene.rotation:
            to_partners += 0.5 * dt * float(np.sum(torque[stays] * state.omega[stays]))
    ids, which = split(scene, ids)
    v, weight, m = state.v[ids], *_weight_and_mass(scene, state, ids)
    before = v - dt * (weight + force[ids]) / m[:, None]
    kinetic = 0.5 * float(np.sum(m[:, None] * v * before))
    spin, omega = 0.0, state.omega[ids]
    if scene.rotation:
        inertia = scene.inertia[ids, None]
        spin = 0.5 * float(np.sum(inertia * omega * (omega - dt * torque[ids] / inertia)))
    potential = _height(scene, state, ids, state.x[ids] - dt * v)
    held = Held(kinetic, spin, potential) + held_by_bodies(scene, state, which, force, torque)
    less = _entered(state, -held.kinetic, -held.spin, -held.potential, springs, to_partners)
    if less is not None and scene.contact.timing == ContactTiming.EXACT:
        # what contacts would still have done to the grains in the interval after the step
        later = float(np.sum(force[ids] * v)) + (
            float(np.sum(torque[ids] * omega)) if scene.rotation else 0.0
        )
        pending = list(less.pending)
        pending[PENDING.index(Term.STEP)] -= 0.5 * dt * later
        less = replace(less, pending=tuple(pending))
    return less if less is None else _without_work(less, of_walls)


def _pending_of_walls(scene: Scene, state: State, places: Ints, normal: Floats, on_i: Floats) -> Floats:
    """Work that each wall would do in the second half of the step on the grains of some contacts [J].

    Parameters
    ----------
    places, normal, on_i : contacts, and what `forces_of_contacts` gives of them.
    """
    found, walls, held = np.zeros(scene.n_wall), scene.walls, state.contacts
    if walls is None:
        return found
    first, dt, t = scene.n_grain + scene.n_fixed + scene.n_plane, scene.dt, state.t
    face = held.j[places] - first
    works = walls.moving() | walls.running()
    mine = np.flatnonzero((face >= 0) & works[walls.wall[np.maximum(face, 0)]])
    i, owner, f = held.i[places][mine], walls.wall[face[mine]], on_i[mine]
    x, r = state.x[i] - state.v[i] * dt, 0.5 * scene.d[i, None]
    image = x + ways_to_faces(walls, face[mine], x, t - dt, scene.period) + r * normal[mine]
    torque = r * np.cross(normal[mine], f)
    for w in np.unique(owner):
        (turn, shift), (later, shift_later) = pose(walls.motion[w], t - dt), pose(walls.motion[w], t)
        its = owner == w
        moved = (image[its] - shift) @ turn @ later.T + shift_later - image[its]  # mirrored grains go along
        spins = torque[its] @ walls.motion[w, SPIN : SPIN + 3]
        found[w] = 0.5 * float(np.sum(f[its] * moved) - dt * spins.sum())
        if (run := surface_velocity(walls.motion[w], t - dt)).any():
            n = normal[mine][its]
            along = run - (n @ run)[:, None] * n
            found[w] += 0.5 * dt * float(np.sum(f[its] * along))
    return found


def _without_work(tally: Tally, of_walls: Floats) -> Tally:
    """The account without work that walls have yet to do [J], shape (n_wall,)."""
    if not np.any(of_walls):
        return tally
    walls = np.array(tally.walls).reshape(len(of_walls), N_IMPULSE)
    walls[:, WORK] -= of_walls
    pending = list(tally.pending)
    pending[PENDING.index(Term.WALL)] -= float(of_walls.sum())
    return replace(tally, pending=tuple(pending), walls=tuple(walls.ravel().tolist()))


def _more(scene: Scene, state: State, ids: Ints) -> Tally | None:
    """The account with the grains of some ids, which have just been put in."""
    ids, which = split(scene, ids)
    v, weight, m = state.v[ids], *_weight_and_mass(scene, state, ids)
    after = v + scene.dt * weight / m[:, None]
    kinetic = 0.5 * float(np.sum(m[:, None] * v * after))
    spin = 0.5 * float(np.sum(scene.inertia[ids, None] * state.omega[ids] ** 2)) if scene.rotation else 0.0
    held = Held(kinetic, spin, _height(scene, state, ids, state.x[ids])) + held_at_entry(scene, state, which)
    return _entered(state, held.kinetic, held.spin, held.potential, _NO_SPRINGS, 0.0)


def _weight_and_mass(scene: Scene, state: State, ids: Ints) -> tuple[Floats, Floats]:
    """Weight less buoyancy [N], shape (n, 3), and mass with that of the water that moves along [kg]."""
    share = 1.0 if state.fluid is None else state.fluid.sampled[ids, SUBMERGED]
    return scene.m_weight[ids, None] * scene.gravity, scene.m[ids] + share * scene.m_added[ids]


def _height(scene: Scene, state: State, ids: Ints, x: Floats) -> float:
    """Potential energy of grains at x [m], from the origin, periods crossed added [J]."""
    x = x.copy()
    for axis in range(2):
        if np.isfinite(scene.period[axis]) and len(state.image):
            x[:, axis] += state.image[ids, axis] * scene.period[axis]
    return -float(np.sum(scene.m_weight[ids, None] * x * scene.gravity))


def _entered(
    state: State, kinetic: float, spin: float, potential: float, gone: SpringEnergies, to_partners: float
) -> Tally | None:
    """The account after a change of what is held [J]; before the first step it is opened by the engine."""
    if state.step == 0:
        return state.tally
    tally = state.tally or empty_tally(state.t)
    terms = list(tally.terms)
    terms[Term.SWITCH] += kinetic + spin + potential - sum(gone) + to_partners
    return replace(
        tally,
        kinetic=tally.kinetic + kinetic,
        spin=tally.spin + spin,
        potential=tally.potential + potential,
        spring_n=tally.spring_n - gone.normal,
        spring_s=tally.spring_s - gone.tangential,
        spring_r=tally.spring_r - gone.rolling,
        terms=tuple(terms),
    )


def empty_tally(t: float) -> Tally:
    """The account of no grain at time t [s]."""
    return Tally(
        t, *(0.0,) * 6, terms=(0.0,) * N_TERM, overlap_max=0.0, overlap_grain=-1, overlap_step=0,
        speed_max=0.0, spin_max=0.0, n_contact=0, pending=(0.0,) * len(PENDING),
    )  # fmt: skip
