"""Drag of water that seeps through grains at rest: Ergun's law, as a force per volume of mixture."""

from ryusa.laws._law import law


@law
def ergun_linear(phi: float, d: float, nu: float) -> float:
    """Viscous part of Ergun's drag over density and speed in the pores [1/s].

    Parameters
    ----------
    phi : concentration of the grains [-], below 1.
    d : their diameter [m].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: Ergun 1952, Chem. Eng. Prog. 48, 89, as quoted elsewhere (not consulted):
    -dp/dx = 150 mu phi**2/(eps**3 d**2) w + 1.75 rho phi/(eps**3 d) w**2, with eps = 1 - phi and w = eps u
    per area of mixture. The grains take eps (-dp/dx) per volume of mixture. The first term alone is Darcy's
    law with the conductivity g eps**3 d**2/(150 nu phi**2).

    Examples
    --------
    >>> round(ergun_linear(0.6, 0.001, 1.0e-6), 6)  # 150 * 0.36/0.4
    135.0
    """
    return 150.0 * nu * phi * phi / ((1.0 - phi) * d * d)


@law
def ergun_quadratic(phi: float, d: float) -> float:
    """Inertial part of Ergun's drag over density and squared speed in the pores [1/m].

    Parameters
    ----------
    phi : concentration of the grains [-].
    d : their diameter [m].

    Notes
    -----
    Source: as `ergun_linear`.

    Examples
    --------
    >>> round(ergun_quadratic(0.6, 0.001), 6)  # 1.75 * 0.6/0.001
    1050.0
    """
    return 1.75 * phi / d
