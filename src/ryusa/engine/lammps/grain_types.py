"""Types of LAMMPS: a contact law, and with it one damping coefficient, belongs to a pair of types.

Free grains of one material are in classes of similar mass, one type each; fixed grains of one material are
one type. A plane is no atom: it has a law with each type of the free grains.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene
from ryusa.model.scene import Floats

Ints = NDArray[np.int64]

# Largest ratio of two masses of a class, where as few classes as `_MOST` allow it. A dashpot is corrected for
# the lag of its velocity (laws.contact.damping_in_steps) by eta dt/(4 m), 2 % at 10 steps per contact and
# e = 0.7, with the mean mass of the class: a ratio of 1.1 leaves an error of 0.05 % of the dashpot.
_RATIO = 1.1
_MOST = 12  # of one material
# Types of free grains: LAMMPS has 32 groups, a wall acts on a group, and there are all, free, fixed and gone.
MOST_TYPES = 28


@dataclass(frozen=True)
class GrainTypes:
    """Types of the grains of a scene.

    Attributes
    ----------
    of : type of each free grain, shape (n_grain,), from 0.
    m : mass of a grain of a type, added mass included: the geometric mean of its limits [kg], shape (n,).
    m_bare : without added mass [kg], shape (n,).
    d : diameter of a grain of that mass [m], shape (n,).
    material : number of the material of a type, 0 where there is one material, shape (n,).
    of_fixed : type of each fixed grain among those of fixed grains, shape (n_fixed,), from 0.
    fixed : number of the material of each type of fixed grains; there is one at least.
    """

    of: Ints
    m: Floats
    m_bare: Floats
    d: Floats
    material: Ints
    of_fixed: Ints
    fixed: Ints

    @property
    def n(self) -> int:
        """Number of types of free grains."""
        return len(self.m)


def grain_types(scene: Scene) -> GrainTypes:
    """Put the grains of a scene in types."""
    made_of = np.zeros(scene.n_partner, np.int64) if scene.materials is None else scene.materials.of
    own, beyond = made_of[: scene.n_grain], made_of[scene.n_grain : scene.n_grain + scene.n_fixed]
    fixed, of_fixed = np.unique(beyond if scene.n_fixed else np.zeros(1, np.int64), return_inverse=True)
    mass = scene.m + scene.m_added
    of, rows = np.zeros(scene.n_grain, np.int64), list[tuple[float, float, float, int]]()
    numbers = np.unique(own).tolist()
    for number in numbers:
        some = np.flatnonzero(own == number)
        classes, means = _classes(mass[some], min(_MOST, MOST_TYPES // len(numbers)))
        of[some] = len(rows) + classes
        k = some[int(mass[some].argmin())]
        bare = float(scene.m[k] / mass[k])
        rows += [(m, bare * m, float(scene.d[k] * np.cbrt(m / mass[k])), number) for m in means]
    m, m_bare, d, material = zip(*(rows or [(1.0, 1.0, 1.0, 0)]), strict=True)
    return GrainTypes(
        of, np.array(m), np.array(m_bare), np.array(d), np.array(material, np.int64),
        of_fixed[: scene.n_fixed].astype(np.int64), fixed.astype(np.int64),
    )  # fmt: skip


def _classes(mass: Floats, most: int) -> tuple[Ints, list[float]]:
    """Class of each of some masses, from 0, and the mean mass of each of at most so many classes."""
    least = float(mass.min())
    span = math.log(float(mass.max()) / least)
    n = min(max(math.ceil(span / math.log(_RATIO)), 1), most)
    of = np.zeros(len(mass), np.int64)
    if span > 0.0:
        of = np.minimum((np.log(mass / least) / span * n).astype(np.int64), n - 1)
    return of, (least * np.exp(span * (np.arange(n) + 0.5) / n)).tolist()
