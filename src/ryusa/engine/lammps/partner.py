"""One of the two bodies of a contact, as the words of its law need it."""

import math
from dataclasses import dataclass

from ryusa.laws.motion import inertia_sphere

FLAT = math.inf  # radius of a plane [m]
RIGID = math.inf  # mass of what does not move [kg]


@dataclass(frozen=True)
class Partner:
    """One of the two bodies of a contact: mass with added mass, mass alone [kg], radius [m]."""

    m: float
    m_bare: float
    r: float

    @property
    def inertia(self) -> float:
        """Moment of inertia, without added mass [kg m2]."""
        return inertia_sphere(self.m_bare, 2.0 * self.r) if math.isfinite(self.m_bare) else math.inf
