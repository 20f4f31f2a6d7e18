"""What every engine asks of a scene and a state before it steps, and how it tells of contacts that ended."""

from dataclasses import replace

import numpy as np

from ryusa.errors import NotANumber
from ryusa.model import EVENT, Contacts, Scene, State
from ryusa.model.scene import Floats


def refuse_misfit(scene: Scene, state: State) -> None:
    """Refuse a state of another scene, one that is not finite, and lanes of a plane scene that would meet.

    Raises
    ------
    ValueError, NotANumber : what is wrong; the latter names the grain.
    """
    n = scene.n_grain
    if state.x.shape != (n, 3):
        raise ValueError(f"state.x has shape {state.x.shape}, the scene has {n} free grains")
    if scene.plane_case:
        _refuse_near_lanes(scene, state)
    bad = np.flatnonzero(~np.isfinite(np.hstack([state.x, state.v, state.omega])).all(axis=1))
    if len(bad):
        raise NotANumber(
            "position, velocity or spin is not finite",
            grain=int(bad[0]),
            step=state.step,
            t=state.t,
            hint="Nothing was stepped: give finite numbers.",
        )


def _refuse_near_lanes(scene: Scene, state: State) -> None:
    """In a plane scene another y is another lane; lanes closer than a diameter would hide contacts."""
    lanes = np.unique(np.concatenate([state.x[:, 1], scene.x_fixed[:, 1]]))
    largest = float(np.concatenate([scene.d, scene.d_fixed]).max(initial=0.0))
    apart = np.diff(lanes)
    if len(apart) and apart.min() < largest * (1.0 - 1e-9):
        y = lanes[int(apart.argmin())]
        text = f"a plane scene has grains at y = {y:g} m and {apart.min():g} m beside, less than a diameter"
        raise ValueError(f"{text} ({largest:g} m): give them the same y, or set the lanes apart")


def still_there(scene: Scene, contacts: Contacts) -> tuple[Contacts, np.ndarray]:
    """Contacts whose partner still stands, and the places of those whose partner was taken away."""
    active = np.concatenate([np.ones(scene.n_grain, np.bool_), scene.fixed_active, scene.plane_active])
    keep = active[contacts.j]
    if keep.all():
        return contacts, np.zeros(0, np.int64)
    return replace(contacts, **{name: array[keep] for name, array in vars(contacts).items()}), np.flatnonzero(
        ~keep
    )


def events_of(rows: Floats) -> np.ndarray:
    """Records of ended contacts, shape (n, N_EVENT), as a structured array in order of parting."""
    events = np.zeros(len(rows), EVENT)
    column = 0
    for name in EVENT.names or ():
        wide = len(EVENT[name].shape) > 0
        events[name] = rows[:, column : column + 3] if wide else rows[:, column]
        column += 3 if wide else 1
    return events[np.lexsort((events["j"], events["i"], events["t_part"]))]
