"""Classes of grains of similar mass: one type of LAMMPS each, because a type has one damping coefficient."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene
from ryusa.model.scene import Floats

# Largest ratio of two masses of a class, where as few classes as `_MOST` allow it. A dashpot is corrected for
# the lag of its velocity (laws.contact.damping_in_steps) by eta dt/(4 m), 2 % at 10 steps per contact and
# e = 0.7, with the mean mass of the class: a ratio of 1.1 leaves an error of 0.05 % of the dashpot.
_RATIO = 1.1
_MOST = 12


@dataclass(frozen=True)
class MassClasses:
    """Free grains in classes of mass.

    Attributes
    ----------
    of : class of each grain, shape (n_grain,), from 0.
    m : mass of a class, added mass included: the geometric mean of its limits [kg], shape (n_class,).
    d : diameter of a grain of that mass [m], shape (n_class,).
    """

    of: NDArray[np.int64]
    m: Floats
    d: Floats

    @property
    def n(self) -> int:
        """Number of classes."""
        return len(self.m)


def mass_classes(scene: Scene) -> MassClasses:
    """Put the free grains of a scene in classes."""
    mass = scene.m + scene.m_added
    if not len(mass):
        return MassClasses(np.zeros(0, np.int64), np.ones(1), np.ones(1))
    least, most = float(mass.min()), float(mass.max())
    span = math.log(most / least)
    n = min(max(math.ceil(span / math.log(_RATIO)), 1), _MOST)
    of = np.zeros(len(mass), np.int64)
    if span > 0.0:
        of = np.minimum((np.log(mass / least) / span * n).astype(np.int64), n - 1)
    m = least * np.exp(span * (np.arange(n) + 0.5) / n)
    k = int(mass.argmin())
    return MassClasses(of, m, scene.d[k] * np.cbrt(m / mass[k]))
