"""Contact forces at a frame, from the contact history of an engine's snapshot."""

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.shared.contact_history import forces_of_contacts
from ryusa.model import Scene, State
from ryusa.results import schema


def contact_forces(state: State, scene: Scene) -> NDArray[np.void]:
    """Forces of all contacts that push, pull or shear, dtype schema.FORCE.

    Parameters
    ----------
    state : a snapshot; its contact history holds the forces of the step before, at x - v dt.
    scene : the scene; fixed grains and planes stand where they stood at the start, walls where servos brought
        them.
    """
    held = state.contacts
    rows = np.zeros(len(held), dtype=schema.FORCE)
    rows["i"], rows["j"] = held.i, held.j
    rows["force"] = forces_of_contacts(scene, state, np.arange(len(held))).force
    return rows[np.abs(rows["force"]).max(axis=1, initial=0.0) > 0.0]
