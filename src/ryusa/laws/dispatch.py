"""Laws by number: compiled functions for the engines and the water, built from the table of families.

Each takes a number of its family and then, in the order given below, the arguments of all its laws; a law
receives those that its parameters name. For a number outside the family the result is nan.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from ryusa.compiled.function import compiled_law
from ryusa.laws._family import dispatch, marked, rules
from ryusa.laws.drag import drag_among_neighbours, drag_factor, reynolds
from ryusa.laws.families import (
    Adhesion,
    Arm,
    BedKind,
    Cap,
    Drag,
    Hindrance,
    Lift,
    Magnus,
    Mixing,
    Profile,
    Rebound,
    Rolling,
    SideWalls,
    Slip,
    Unloading,
    WaterTorque,
)

F = TypeVar("F", bound=Callable[..., Any])

# C_D [-] of an isolated grain.
drag_coefficient = dispatch(Drag, ("re", "c_d"), unasked=(Drag.NONE,))
# Slip [m/s] at which the drag of an isolated grain is evaluated, and its factor [-].
hindrance = dispatch(Hindrance, ("slip", "eps", "exponent", "d", "nu", "stress"), answers=2)
# Force along z [N], and factor k [N s/m] of the force k (w x e_y), w = water - grain.
shear_lift = dispatch(
    Lift,
    ("top", "bottom", "slip", "shear", "d", "nu", "rho_w", "a_2", "c_l"),
    answers=2,
    unasked=(Lift.NONE,),
)
# Factor k [kg] of the force k (Omega x w).
magnus = dispatch(Magnus, ("slip", "spin", "d", "nu", "rho_w"), unasked=(Magnus.NONE,))
# Factor k [N m s] of the torque -k omega.
water_torque = dispatch(WaterTorque, ("spin", "d", "nu", "rho_w"), unasked=(WaterTorque.NONE,))
# Speed of the water along x [m/s].
profile_speed = dispatch(
    Profile, ("z", "u_star", "k_rough", "nu", "speed"), unasked=(Profile.NONE, Profile.COLUMN)
)
# Restitution of a contact under water [-].
wet_restitution = dispatch(Rebound, ("e_dry", "st", "st_c", "roughness", "d"), unasked=(Rebound.DRY,))
# Attraction [N] of a pair in touch, and the energy that it has released since touch [J].
attraction = dispatch(Adhesion, ("amount", "r", "overlap"), answers=2, unasked=(Adhesion.NONE,))
# Length that turns the coefficient of rolling friction into its arm [m].
rolling_length = dispatch(Arm, ("r_i", "r_j", "overlap"))
# Mixing length [m] at a face.
mixing_length = dispatch(
    Mixing,
    ("z", "face", "depth", "u_star", "nu", "kappa"),
    unasked=(Mixing.LAMINAR, Mixing.LI_SAWAMOTO, Mixing.SHEAR_LAYER),
)
# Whether it grows through the grains, from the bed that they make.
length_through_grains = marked(Mixing, "grains")
# Whether it is bounded by the thickness of shear layers.
length_of_layers = marked(Mixing, "layers")
# Whether the mixing length depends on the shear stress of a wall, so that the solver must iterate.
length_of_wall = marked(Mixing, "wall")
# Shear stress on the bed over density [m2/s2], and its derivative with respect to u_x [m/s].
wall_stress = dispatch(BedKind, ("u_x", "z", "nu", "k_rough", "square"), answers=2)
# Friction factor of the side walls in turbulent flow [-].
side_friction = dispatch(SideWalls, ("re",), unasked=(SideWalls.NONE,))

# Arguments of `contact.slide`: whether the dashpot is zero while sliding, and whether the cap includes it.
slip_drops, slip_total = rules(Slip, "drop", "total")
# Whether the whole normal force enters the Coulomb cap.
(cap_total,) = rules(Cap, "total")
# Whether the tangential spring of elastic spheres is let go with the contact area.
(unloading_rescales,) = rules(Unloading, "rescaled")
# Whether rolling friction exerts the same torque on both grains; else that on j is opposite to that on i.
rolling_alike = marked(Rolling, "both alike")


def _inlined(function: F) -> F:
    """Compile a function that is inlined into its callers."""
    return compiled_law(forceinline=True)(function)


@_inlined
def drag_of(law: int, speed: float, d: float, nu: float, rho_w: float, a_2: float, c_d: float) -> float:
    """Drag of an isolated grain over relative velocity [N s/m].

    Parameters
    ----------
    law : number of `Drag`, not NONE.
    speed : relative speed of water and grain [m/s].
    d : diameter [m].
    nu, rho_w : kinematic viscosity and density of the water [m2/s], [kg/m3].
    a_2, c_d : area coefficient of Eq. (10), and drag coefficient where it is constant [-].
    """
    if speed == 0.0:
        return 0.0
    return drag_factor(speed, drag_coefficient(law, reynolds(speed, d, nu), c_d), rho_w, a_2, d)


@_inlined
def hindered(
    law: int, among: int, stress: bool, exponent: float, slip: float, phi: float,
    d: float, nu: float, rho_w: float, a_2: float, c_d: float,
) -> float:  # fmt: skip
    """Hindered drag of a grain among neighbours over relative velocity [N s/m].

    Parameters
    ----------
    law, among : numbers of `Drag`, not NONE, and of `Hindrance`.
    stress : True if pressure gradient and stress of the mixture act in addition to the drag (model A).
    exponent : exponent of the hindrance, if it has one [-].
    slip : relative speed of water and grain [m/s].
    phi : concentration around the grain [-], below 1.
    d, nu, rho_w, a_2, c_d : as in `drag_of`.
    """
    speed, factor = hindrance(among, slip, 1.0 - phi, exponent, d, nu, stress)
    return drag_among_neighbours(
        slip, speed, factor, drag_coefficient(law, reynolds(speed, d, nu), c_d), rho_w, a_2, d
    )
