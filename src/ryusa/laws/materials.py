"""Contacts of two materials: stiffness, and the like spheres that two unlike elastic spheres stand for.

Friction and restitution belong to a pair: no law gives them from those of its two materials (design/0020).
"""

from ryusa.laws._law import law


@law
def stiffness_of_two(k_a: float, k_b: float) -> float:
    """Stiffness of a contact of two materials [N/m]: two springs in series, 2/(1/k_a + 1/k_b).

    Parameters
    ----------
    k_a, k_b : stiffness of a contact of each material with itself [N/m].

    Notes
    -----
    Source: each grain gives way as half of the spring between two of its kind, as Hertz's moduli add
    (Johnson 1985, Eq. (4.5)).

    >>> stiffness_of_two(3.0, 6.0), stiffness_of_two(2.0, 2.0)
    (4.0, 2.0)
    """
    return k_a if k_a == k_b else 2.0 * k_a * k_b / (k_a + k_b)


@law
def poisson_of_two(young_a: float, poisson_a: float, young_b: float, poisson_b: float) -> float:
    """Poisson's ratio of the like spheres whose contact is that of two unlike ones [-].

    Parameters
    ----------
    young_a, young_b : Young's moduli [Pa].
    poisson_a, poisson_b : Poisson's ratios [-].

    Notes
    -----
    Source: Johnson 1985, Eqs. (4.5) and (7.43): 1/E_e = sum of (1 - nu**2)/E, 1/G_e = sum of
    2 (2 - nu) (1 + nu)/E. Like spheres have G_e/E_e = (1 - nu)/(2 (2 - nu)), here solved for nu. The
    ratio of two sums lies between the ratios of their parts, so that nu lies between the two.

    >>> poisson_of_two(1.0, 0.25, 3.0, 0.25), round(poisson_of_two(1.0, 0.0, 1.0, 0.5), 4)
    (0.25, 0.3)
    """
    normal = (1.0 - poisson_a * poisson_a) / young_a + (1.0 - poisson_b * poisson_b) / young_b
    shear = (2.0 - poisson_a) * (1.0 + poisson_a) / young_a + (2.0 - poisson_b) * (1.0 + poisson_b) / young_b
    same = poisson_a == poisson_b
    return poisson_a if same else (shear - 2.0 * normal) / (shear - normal)


@law
def young_of_two(young_a: float, poisson_a: float, young_b: float, poisson_b: float) -> float:
    """Young's modulus of the like spheres whose contact is that of two unlike ones [Pa].

    Parameters
    ----------
    young_a, poisson_a, young_b, poisson_b : as in `poisson_of_two`.

    Notes
    -----
    Source: as in `poisson_of_two`; E = 2 (1 - nu**2) E_e.

    >>> young_of_two(2.0, 0.25, 2.0, 0.25), young_of_two(3.0, 0.0, 6.0, 0.0)
    (2.0, 4.0)
    """
    nu = poisson_of_two(young_a, poisson_a, young_b, poisson_b)
    normal = (1.0 - poisson_a * poisson_a) / young_a + (1.0 - poisson_b * poisson_b) / young_b
    same = young_a == young_b and poisson_a == poisson_b
    return young_a if same else 2.0 * (1.0 - nu * nu) / normal
