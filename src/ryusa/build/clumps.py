"""Grains of a scene made into clumps of the same volume."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ryusa.build.assemble import read_only
from ryusa.casefile.case import Case
from ryusa.casefile.shape import shapes_of
from ryusa.errors import CaseError
from ryusa.laws.families import ContactForce, Profile
from ryusa.model import BodyState, Materials, RigidBodies, Scene, State, Traffic
from ryusa.model.arrays import Floats
from ryusa.model.clump import Clump, drag_form
from ryusa.model.rigid_bodies import N_DRAG_FORM

Ints = NDArray[np.int64]
_STREAM = 0x434C554D  # tells forms and orientations of grains from their sizes


def with_clumps(
    scene: Scene,
    state: State,
    forms: Sequence[Clump],
    *,
    form_of: ArrayLike | None = None,
    orientation: ArrayLike | None = None,
    names: Sequence[str] = (),
) -> tuple[Scene, State]:
    """Make grains of a scene into clumps, each of the volume of its grain, and shorten the time step.

    The centre of mass of a clump is where the centre of its grain was; velocity and spin are those of the
    grain. The step is that of the lightest contact: a push on a sphere off the centre also turns the clump.

    Parameters
    ----------
    scene, state : at the start of a run.
    forms : clumps of any size; each is scaled.
    form_of : number of the form of each free grain, -1 for a grain that stays a sphere, shape (n_grain,);
        all of the first form when not given.
    orientation : quaternions (w, x, y, z) from the principal axes to space, shape (n_grain, 4); along x, y, z
        when not given.
    names : of the forms.

    Raises
    ------
    CaseError : a shape that does not fit, an orientation of length zero, a scene that has clumps already.
    """
    scene, state = expanded(scene, state, forms, form_of=form_of, orientation=orientation, names=names)
    power = 0.4 if scene.contact.force == ContactForce.HERTZ_MINDLIN else 0.5
    share = min((form.least_mass for form in forms), default=1.0)
    return replace(scene, dt=scene.dt * share**power), state


def random_orientations(n: int, rng: np.random.Generator) -> Floats:
    """Quaternions of orientations that are all as likely, shape (n, 4)."""
    q = rng.standard_normal((n, 4))
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def expanded(
    scene: Scene,
    state: State,
    forms: Sequence[Clump],
    *,
    form_of: ArrayLike | None,
    orientation: ArrayLike | None,
    names: Sequence[str],
) -> tuple[Scene, State]:
    """As `with_clumps`, with the time step of the scene."""
    n = scene.n_grain
    if scene.bodies is not None or len(state.contacts) or state.step:
        raise CaseError("state", f"step {state.step}", "must be the start of a run without clumps")
    which, q = _checked(n, len(forms), form_of, orientation)
    made = np.flatnonzero(which >= 0)
    count = np.ones(n, np.int64)
    count[made] = [len(forms[k].d) for k in which[made]]
    first = np.cumsum(count) - count
    scaled = [forms[which[k]].scaled(float(scene.d[k]) / forms[which[k]].d_volume) for k in made]
    inertia = np.array([form.inertia / form.volume for form in scaled]).reshape(-1, 3)
    bodies = RigidBodies(
        first=first[made],
        count=count[made],
        arm=np.concatenate([np.zeros((0, 3)), *(form.x for form in scaled)]),
        m=scene.m[made],
        m_weight=scene.m_weight[made],
        inertia=inertia * scene.m[made, None],
        d=scene.d[made],
        names=tuple(names),
        form=which[made],
        drag_form=_drag_forms(scene, [forms[which[k]] for k in made], made),
    )
    image = state.image if len(state.image) == n else np.zeros((n, 2), np.int32)
    moved = BodyState.of(bodies, state.x[made], state.v[made], q[made], state.omega[made])
    moved = replace(moved, image=image[made])
    owner, members = np.repeat(np.arange(n), count), bodies.members
    d = scene.d[owner]
    d[members] = np.concatenate([np.zeros(0), *(form.d for form in scaled)])
    share = np.ones(len(d))
    for k, form in zip(made, scaled, strict=True):
        share[first[k] : first[k] + count[k]] = form.d**3 / np.sum(form.d**3)
    x, v, omega = state.x[owner], state.v[owner], state.omega[owner]
    x[members], v[members], omega[members] = moved.of_members(bodies)
    inertia_of_each = scene.inertia[owner]
    inertia_of_each[members] = 0.1 * (scene.m[owner] * share * d**2)[members]
    ends = np.concatenate([first, [len(d)]])

    def new_id(k: int) -> int:
        return int(ends[k]) if k <= n else k - n + len(d)

    scene = replace(
        scene,
        d=read_only(d),
        m=read_only(scene.m[owner] * share),
        m_added=read_only(scene.m_added[owner] * share),
        m_weight=read_only(scene.m_weight[owner] * share),
        inertia=read_only(inertia_of_each),
        tracked=read_only(scene.tracked[owner]) if len(scene.tracked) == n else scene.tracked,
        groups={name: (new_id(a), new_id(b)) for name, (a, b) in scene.groups.items()},
        traffic=_traffic(scene.traffic, new_id),
        materials=_materials(scene.materials, owner, n),
        bodies=bodies,
    )
    arrays = {"x": x, "v": v, "omega": omega, "image": image[owner]}
    if len(state.present):
        arrays["present"] = state.present[owner]
    return scene, replace(state, bodies=moved, **{name: read_only(array) for name, array in arrays.items()})


def _checked(
    n: int, n_form: int, form_of: ArrayLike | None, orientation: ArrayLike | None
) -> tuple[Ints, Floats]:
    """Number of the form (n,) and orientation (n, 4) of each of n grains, as `with_clumps` takes them."""
    which = np.zeros(n, np.int64) if form_of is None else np.array(form_of, np.int64)
    if which.shape != (n,) or which.min(initial=0) < -1 or which.max(initial=0) >= n_form:
        raise CaseError("form_of", which.shape, f"must hold -1 to {n_form - 1} for each of {n} grains")
    q = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)) if orientation is None else np.array(orientation, np.float64)
    if q.shape != (n, 4) or not (np.linalg.norm(q, axis=1) > 0.0).all():
        raise CaseError("orientation", q.shape, f"must hold a quaternion for each of {n} grains")
    return which, q


def _traffic(traffic: Traffic | None, new_id: Callable[[int], int]) -> Traffic | None:
    """Feeds and exits with the ids of spheres."""
    if traffic is None:
        return None
    feeds = [
        replace(one, first=new_id(one.first), count=new_id(one.first + one.count) - new_id(one.first))
        for one in traffic.feeds
    ]
    return replace(traffic, feeds=tuple(feeds), n_first=new_id(traffic.n_first))


def _drag_forms(scene: Scene, forms: Sequence[Clump], made: Ints) -> Floats:
    """Form of the clumps made of grains `made` as the drag of the water sees it; without rows when dry."""
    if scene.water.profile == Profile.NONE:
        return np.zeros((0, N_DRAG_FORM))
    displaced = scene.m[made] - scene.m_weight[made]
    ratios = scene.m[made] / np.where(displaced > 0.0, displaced, np.inf)
    rows = [drag_form(scene.water.drag_of_form, *one) for one in zip(forms, ratios.tolist(), strict=True)]
    return np.array(rows).reshape(-1, N_DRAG_FORM)


def clumps_of(case: Case, scene: Scene, state: State) -> tuple[Scene, State]:
    """Scene and state of a case with its clumps, drawn and turned at random."""
    shapes = shapes_of(case)
    if not shapes:
        return scene, state
    rng = np.random.default_rng([case.seed, _STREAM])
    n = scene.n_grain
    drawn, form_of, begin = rng.permutation(n), np.full(n, -1, np.int64), 0.0
    for k, one in enumerate(shapes):
        end = begin + one.share * n
        form_of[drawn[round(begin) : round(end)]] = k
        begin = end
    return expanded(
        scene,
        state,
        [one.clump for one in shapes],
        form_of=form_of,
        orientation=random_orientations(n, rng),
        names=[one.name for one in shapes],
    )


def _materials(made: Materials | None, owner: Ints, n: int) -> Materials | None:
    if made is None:
        return None
    return replace(made, of=np.concatenate([made.of[:n][owner], made.of[n:]]))
