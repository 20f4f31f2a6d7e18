"""Egashira's debris flow for one case: profiles of speed, concentration and flux to hold a run against."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.optimize import brentq

from ryusa.laws.debris import collision_factor, pore_factor, static_share, velocity_egashira
from ryusa.measure.formulae import K_D, K_F
from ryusa.measure.statistics import Floats

C_STAR, E = 0.6, 0.85  # concentration of the bed, restitution: of the source, read in public code
LEVELS = 400  # of a profile whose concentration varies
SHALLOW = 1.0e-4  # of the depth: so near to the surface begins such a profile
LEAST = 1.0e-6  # concentration that is sought


def collision_pressure_factor(c: float, e: float, k_d: float, rho_s: float, rho_w: float) -> float:
    """Dimensionless pressure of collisions [-], p_d/(rho d**2 (dU/dz)**2) = k_d e**2 (sigma/rho) c**(1/3).

    It is `collision_factor` with the part of the energy that a collision keeps in place of the part that it
    loses. Egashira, Miyamoto & Itoh 1997, from memory: no text or code that states it was found. So it is no
    law of the package, and serves what is shown, not what judges.

    >>> round(collision_pressure_factor(0.125, 0.5, 0.08, 2500.0, 1000.0), 9)  # 0.08 * 0.25 * 2.5 * 0.5
    0.025
    """
    return collision_factor(c, math.sqrt(1.0 - e * e), k_d, rho_s, rho_w)


@dataclass(frozen=True)
class DebrisFlow:
    """A steady, uniform flow of grains and water over a rough rigid bed.

    Attributes
    ----------
    slope : bed angle [rad].
    depth : of the flow [m].
    d : diameter [m].
    rho_s, rho_w : density of grain and water [kg/m3].
    g : gravity [m/s2].
    friction_angle : static friction angle between grains, phi_s [rad].
    c_star : concentration of a bed at rest [-].
    e : restitution [-].
    """

    slope: float
    depth: float
    d: float
    rho_s: float
    rho_w: float
    g: float
    friction_angle: float
    c_star: float = C_STAR
    e: float = E

    def factor(self, c: float) -> float:
        """f_d + f_f at a concentration [-]."""
        return collision_factor(c, self.e, K_D, self.rho_s, self.rho_w) + pore_factor(c, K_F)

    def speed(self, z: Floats, c: float) -> Floats:
        """Speed at heights above the bed [m/s] where the concentration is the same over the depth."""
        f = self.factor(c)
        return np.array(
            [
                velocity_egashira(
                    float(one), self.depth, c, self.slope, self.friction_angle, self.c_star, f, self.rho_s,
                    self.rho_w, self.g, self.d,
                )
                for one in z
            ]
        )  # fmt: skip

    def surface_speed(self, c: float) -> float:
        """Speed at the surface there [m/s]; 0 where friction between the grains alone holds the flow."""
        return float(self.speed(np.array([self.depth]), c)[0])

    def mean_speed(self, c: float) -> float:
        """Mean over the depth there [m/s], 3/5 of that of the surface."""
        return 0.6 * self.surface_speed(c)

    def stratified(self, c: float) -> tuple[Floats, Floats, Floats] | None:
        """Heights [m], concentration [-] and speed [m/s] where both follow from the stresses.

        Parameters
        ----------
        c : mean concentration over the depth [-].

        Returns
        -------
        None where a flow with so many grains has a deposit: there is no such flow over a rigid bed.

        Notes
        -----
        Shear stress: T = p_s tan(phi_s) + rho f d**2 (du/dz)**2. Pressure between grains: P = p_s + p_d with
        p_s/P = (c/c_star)**(1/5) and p_d = rho k_d e**2 (sigma/rho) c**(1/3) d**2 (du/dz)**2. T and P are the
        weight of what lies above a level, along the slope and normal to it, so that their ratio depends on
        the mean concentration above it, C, alone: T/P = tan(slope) (1 + rho/((sigma - rho) C)). With the
        shear rate taken out, the local concentration follows from C, c = G(C), and the definition of C
        gives x dC/dx = G(C) - C, with x the distance from the surface. The form of p_d is from memory: what
        is computed here is shown, and judges nothing.
        """
        over = math.log(SHALLOW)
        try:
            found = solve_ivp(
                lambda _, one: [self._local(float(one[0])) - float(one[0])],
                (0.0, over), [c], rtol=1.0e-9, atol=1.0e-12, dense_output=True,
            )  # fmt: skip
        except _Deposit:
            return None
        x = np.geomspace(SHALLOW, 1.0, LEVELS)
        above = np.maximum(found.sol(np.log(x))[0], LEAST)
        local = np.array([self._local(float(one)) for one in above])
        height = self.depth * x
        shear = self._weight(above) * height - self._friction(local) * above * height
        f = np.array([self.factor(float(one)) for one in local])
        rate = np.sqrt(np.maximum(shear, 0.0) / (self.rho_w * f)) / self.d
        # Speed that is lost from the surface downwards
        down = cumulative_trapezoid(rate, height, initial=0.0)
        return self.depth - height[::-1], local[::-1], (down[-1] - down)[::-1]

    def _weight(self, above: Floats) -> Floats:
        """Shear stress per height [Pa/m] of what lies above, at its mean concentration."""
        return ((self.rho_s - self.rho_w) * above + self.rho_w) * self.g * math.sin(self.slope)

    def _friction(self, local: Floats) -> Floats:
        """Yield stress over concentration above and height [Pa/m], at the local concentration."""
        share = (np.asarray(local) / self.c_star) ** 0.2
        heavy = (self.rho_s - self.rho_w) * self.g * math.cos(self.slope)
        return share * heavy * math.tan(self.friction_angle)

    def _local(self, above: float) -> float:
        """Concentration at a level, G(C), from the mean concentration above it."""
        submerged = (self.rho_s - self.rho_w) * max(above, LEAST)
        ratio = math.tan(self.slope) * (1.0 + self.rho_w / submerged)

        def unbalanced(c: float) -> float:
            share = static_share(c, self.c_star)
            left = (ratio - share * math.tan(self.friction_angle)) / (1.0 - share)
            pressure = collision_pressure_factor(c, self.e, K_D, self.rho_s, self.rho_w)
            return left - self.factor(c) / pressure

        if ratio <= math.tan(self.friction_angle):
            raise _Deposit
        most = self.c_star * (1.0 - 1.0e-9)
        found: Any = brentq(unbalanced, 1.0e-12, most, xtol=1.0e-14)
        return float(found)


class _Deposit(Exception):
    """Friction between grains at rest holds the flow somewhere."""
