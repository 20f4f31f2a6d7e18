"""Parameters of contacts between grains and walls of several materials (design/0020)."""

from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import inner
from ryusa.model import Scene
from ryusa.model.scene import Floats


@inner(forceinline=True)
def material_of(place: int, ids: Any, material: Any) -> int:
    """Material of the grain, plane or face in a place; `ids` are those of the places of grains."""
    return material[ids[place]] if place < len(ids) else material[place]


def material_arrays(scene: Scene) -> tuple[Any, Any]:
    """Material of each id, and the parameters of each two of them; (None, None) where there is one.

    Parameters have shape (n_material, n_material, N_PARAMETER): each row is that of a scene in which all
    contacts are those of the pair.
    """
    made = scene.materials
    if made is None:
        return None, None
    rows = [P.parameters_of(scene.of_pair(k)) for k in range(made.n**2)]
    return made.of.astype(np.int64), np.array(rows).reshape(made.n, made.n, P.N_PARAMETER)


def common_parameters(scene: Scene) -> Floats:
    """Parameters that kernels read for all pairs alike."""
    return P.parameters_of(replace(scene, materials=None))
