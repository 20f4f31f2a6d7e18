"""Overlaps of the contacts of one rank, from the distances of its pairs and the places of its grains."""

import numpy as np

from ryusa.laws.families import ContactForce
from ryusa.model import Scene
from ryusa.model.pair_springs import pair_springs
from ryusa.model.scene import Floats


def contacts(
    scene: Scene, ids: np.ndarray, x: Floats, distance: Floats, ends: np.ndarray
) -> tuple[float, int, float, tuple[int, int]]:
    """Energy of normal springs [J], number of contacts, largest overlap over diameter, and its pair.

    Parameters
    ----------
    ids, x : free grains of the rank, and their centres [m].
    distance, ends : of its pairs that touch: distance of the centres [m], and their ids, shape (n, 2).
    """
    n, r = scene.n_grain, 0.5 * np.concatenate([scene.d, scene.d_fixed])
    i, j = np.minimum(*ends.T), np.maximum(*ends.T)
    overlaps = [np.maximum(r[i] + r[j] - distance, 0.0)]
    firsts, seconds, sizes = [i], [j], [2.0 * np.minimum(r[i], r[j])]
    for k in np.flatnonzero(scene.plane_active).tolist():
        into = r[ids] - (x - scene.plane_point[k]) @ scene.plane_normal[k]
        met = np.flatnonzero(into > 0.0)
        overlaps.append(into[met])
        firsts.append(ids[met])
        seconds.append(np.full(len(met), n + scene.n_fixed + k))
        sizes.append(2.0 * r[ids[met]])
    overlap, size = np.concatenate(overlaps), np.concatenate(sizes)
    if not len(overlap):
        return 0.0, 0, 0.0, (-1, -1)
    worst = int((overlap / size).argmax())
    pair = int(np.concatenate(firsts)[worst]), int(np.concatenate(seconds)[worst])
    # force over overlap
    k_n, _ = pair_springs(scene, np.concatenate(firsts), np.concatenate(seconds), overlap)
    share = 0.4 if scene.contact.force == ContactForce.HERTZ_MINDLIN else 0.5
    energy = share * float(np.sum(k_n * overlap**2))
    return energy, int(np.count_nonzero(overlap)), float((overlap / size)[worst]), pair
