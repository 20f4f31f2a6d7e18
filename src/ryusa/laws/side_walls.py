"""Side walls of a flume: their friction factors, and the deceleration of the water by them."""

import math

from ryusa.laws._law import law


@law
def friction_gap_laminar(re: float) -> float:
    """Friction factor of laminar flow between two walls [-], 96/Re, Re with the hydraulic diameter.

    Notes
    -----
    Source: plane Poiseuille flow; the hydraulic diameter of a gap of width b is 2 b.

    Examples
    --------
    >>> friction_gap_laminar(960.0)
    0.1
    """
    return 96.0 / re


@law
def friction_blasius(re: float) -> float:
    """Friction factor (Darcy-Weisbach) of a smooth wall [-], 0.3164 Re**-0.25.

    Notes
    -----
    Source: Blasius 1913, for Re = u D/nu between about 4e3 and 1e5, D the hydraulic diameter; one of the two
    side-wall options of YADE's HydroForceEngine, where Re contains the width instead of twice the width.

    Examples
    --------
    >>> round(friction_blasius(1.0e4), 5)
    0.03164
    """
    return 0.3164 / re**0.25


@law
def friction_karman_prandtl(re: float) -> float:
    """Friction factor (Darcy-Weisbach) of a smooth wall [-], 1/sqrt(f) = 2 log10(Re sqrt(f)) - 0.8.

    Notes
    -----
    Source: Prandtl 1935 (with von Karman), as tabulated in White, Fluid Mechanics, Eq. (6.54): 0.0399 at
    Re = 4000, 0.0180 at 1e5. Re = u D/nu with the hydraulic diameter D. Newton's method for x = 1/sqrt(f).

    Examples
    --------
    >>> round(friction_karman_prandtl(4000.0), 4), round(friction_karman_prandtl(1.0e5), 4)
    (0.0399, 0.018)
    """
    x = re / (2.0 + re) * 6.0  # first guess: near Re/2.51 at small Re, 5 to 15 at large Re
    for _ in range(40):
        change = (2.0 * math.log10(re / x) - 0.8 - x) / (1.0 + 2.0 / (math.log(10.0) * x))
        x = max(x + change, 0.1 * x)
        if abs(change) <= 1.0e-15 * x:
            break
    return 1.0 / (x * x)


@law
def side_wall_drag(u_x: float, friction: float, width: float) -> float:
    """Deceleration of the water by the two side walls of a flume [m/s2], f |u| u/(4 width), opposite to u_x.

    Parameters
    ----------
    u_x : water speed [m/s].
    friction : Darcy-Weisbach friction factor f [-].
    width : distance of the walls [m], > 0.

    Notes
    -----
    Source: the stress f rho u**2/8 on two walls, per mass of water between them; as in Maurin et al. 2015.

    Examples
    --------
    >>> round(side_wall_drag(0.5, 0.03, 0.0065), 6)  # 0.03 * 0.25 / 0.026
    -0.288462
    """
    return -friction * abs(u_x) * u_x / (4.0 * width)
