"""Hindrance: the change of the drag on a grain by its neighbours.

Each law returns (speed, factor): the drag is `factor` times that of an isolated grain with the slip `speed`.
Two definitions of drag are in use. In model A the gradients of pressure and stress of the mixture act on the
grain in addition to the drag (buoyancy `stress`); in model B the drag alone balances the submerged weight of
a settling grain (buoyancy `weight` and `pressure`). For the same fluidised bed the drag of model B is that of
model A divided by the void fraction eps = 1 - phi; the argument `stress` selects model A.

In a closed column water returns past the grains, so that a grain which settles at w_p has the slip w_p/eps.
With the isolated drag F_0 ~ w**a (a = 1 for Stokes, 2 for Newton) the settling velocity follows eps**n:

| hindrance | written for | speed | factor, model A | factor, model B | n for Stokes, Newton |
|---|---|---|---|---|---|
| none | - | slip | 1 | 1 | A 2, 1.5; B 1, 1 |
| `richardson_zaki` | n itself | slip eps**(1 - n) | eps | 1 | n, n |
| `wen_yu` | A | slip eps | eps**-3.65 | eps**-4.65 | 4.65, 2.325 |
| `gidaspow` | A | as `wen_yu`; slip below eps = 0.8 | Ergun there | Ergun/eps | no power law below |
| `di_felice` | A | slip eps | eps**-chi | eps**-(chi + 1) | 4.7, 2.35 |
| `power` | as given | slip | eps**-m | eps**-m | A 2 + m, (3 + m)/2; B 1 + m, (2 + m)/2 |

`exponent_settling` gives the last column. In `richardson_zaki`, `wen_yu` and `power` the speed is
proportional to the slip and the factor independent of it: evaluated for a slip of 1, they hold for every slip
at the same eps.
"""

from ryusa.laws import elementary
from ryusa.laws._law import law, step_law
from ryusa.laws.drag import reynolds


@law
def exponent_rowe(re: float) -> float:
    """Exponent n of Richardson and Zaki [-] after Rowe; Re is that of the isolated settling grain [-].

    Notes
    -----
    Source: Rowe 1987, n = (4.7 + 0.41 Re**0.75)/(1 + 0.175 Re**0.75); 4.7 for Stokes, 2.34 for Newton.
    The formula was taken from public code of a lahar model, not from the article.

    Examples
    --------
    >>> exponent_rowe(0.0), round(exponent_rowe(16.0), 9)  # 16**0.75 = 8: 7.98/2.4
    (4.7, 3.325)
    """
    grown = elementary.power(re, 0.75)
    return (4.7 + 0.41 * grown) / (1.0 + 0.175 * grown)


@law
def exponent_garside(re: float) -> float:
    """Exponent n of Richardson and Zaki [-] after Garside; Re is that of the isolated settling grain [-].

    Notes
    -----
    Source: Garside & Al-Dibouni 1977, (5.1 - n)/(n - 2.7) = 0.1 Re**0.9; higher than `exponent_rowe`
    throughout.

    Examples
    --------
    >>> exponent_garside(0.0), round(exponent_garside(10.0 ** (1.0 / 0.9)), 9)  # Re**0.9 = 10: halfway
    (5.1, 3.9)
    """
    grown = 0.1 * elementary.power(re, 0.9)
    return (5.1 + 2.7 * grown) / (1.0 + grown)


@law
def exponent_settling(a: float, p: float, q: float, stress: bool) -> float:
    """Exponent n [-] of the settling velocity of a suspension, w_p = w_0 eps**n, for a given hindrance.

    Parameters
    ----------
    a : exponent of speed in the isolated drag [-]; 1 for Stokes, 2 for Newton.
    p, q : exponents in the hindered drag eps**-q F_0(eps**p slip) [-].
    stress : whether buoyancy is that of the mixture (model A).

    Notes
    -----
    Source: slip = w_p/eps and eps**-q F_0(eps**p slip) = (sigma - rho) V g, times eps on the right in model
    A. If the drag is no power of speed, a is the mean slope of log F_0 against log speed between the two
    speeds.

    Examples
    --------
    >>> exponent_settling(1.0, 0.0, 0.0, False), exponent_settling(1.0, 0.0, 0.0, True)  # no hindrance
    (1.0, 2.0)
    >>> round(exponent_settling(1.0, 1.0, 3.65, True), 9)  # Wen and Yu after Stokes
    4.65
    """
    model_a = 1.0 if stress else 0.0
    return 1.0 - p + (q + model_a) / a


@step_law
def unhindered(slip: float) -> tuple[float, float]:
    """No hindrance: the slip itself [m/s] and the factor 1 [-].

    Examples
    --------
    >>> unhindered(0.1)
    (0.1, 1.0)
    """
    return slip, 1.0


@step_law
def richardson_zaki(slip: float, eps: float, exponent: float, stress: bool) -> tuple[float, float]:
    """Hindered drag that makes a suspension settle with eps**n exactly, whatever the drag law.

    Parameters
    ----------
    slip : speed of the water relative to the grain [m/s], >= 0.
    eps : void fraction 1 - phi [-], > 0.
    exponent : n [-]; `exponent_rowe`, `exponent_garside` or a value of the case.
    stress : whether buoyancy is that of the mixture (model A).

    Returns
    -------
    speed : slip at which the drag of an isolated grain is evaluated [m/s].
    factor : factor of that drag [-].

    Notes
    -----
    Source: Richardson & Zaki 1954 for w_p = w_0 eps**n; from it F = F_0(slip eps**(1 - n)), times eps in
    model A. The law was found for settling; its use for flow along a bed is an assumption.

    Examples
    --------
    >>> richardson_zaki(0.1, 0.5, 3.0, False), richardson_zaki(0.1, 0.5, 3.0, True)
    ((0.4, 1.0), (0.4, 0.5))
    """
    return slip * elementary.power(eps, 1.0 - exponent), eps if stress else 1.0


@step_law
def wen_yu(slip: float, eps: float, stress: bool) -> tuple[float, float]:
    """Hindered drag after Wen and Yu.

    Parameters
    ----------
    slip : speed of the water relative to the grain [m/s], >= 0.
    eps : void fraction 1 - phi [-], > 0.
    stress : whether buoyancy is that of the mixture (model A).

    Returns
    -------
    speed : slip at which the drag of an isolated grain is evaluated [m/s].
    factor : factor of that drag [-].

    Notes
    -----
    Source: Wen & Yu 1966 in the form of Gidaspow 1994 (model A), beta = (3/4) C_D eps phi rho slip/d
    eps**-2.65 with C_D at Re = eps slip d/nu. Per grain, beta slip V/phi is eps**-3.65 F_0(eps slip); model B
    divides by eps. The exponent of settling is 4.65 for Stokes and 2.325 for Newton.

    Examples
    --------
    >>> speed, factor = wen_yu(0.1, 0.5, True)
    >>> speed, round(factor, 4)  # 2**3.65
    (0.05, 12.5533)
    """
    return eps * slip, elementary.power(eps, -3.65 if stress else -4.65)


@step_law
def stokes_multiple(re: float) -> float:
    """Drag of a smooth sphere over its Stokes drag [-], C_D Re/24 after Schiller and Naumann.

    Notes
    -----
    Source: as `drag.c_d_schiller_naumann`, finite at Re = 0.

    Examples
    --------
    >>> stokes_multiple(0.0), round(stokes_multiple(2400.0), 9)
    (1.0, 44.0)
    """
    if re > 1000.0:
        return 0.44 * re / 24.0
    return 1.0 + 0.15 * elementary.power(re, 0.687)


@step_law
def gidaspow(slip: float, eps: float, d: float, nu: float, stress: bool) -> tuple[float, float]:
    """Hindered drag after Gidaspow: Wen and Yu for eps >= 0.8, Ergun's packed bed below.

    Parameters
    ----------
    slip : speed of the water relative to the grain [m/s], >= 0.
    eps : void fraction 1 - phi [-], > 0.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    stress : whether buoyancy is that of the mixture (model A).

    Returns
    -------
    speed : slip at which the drag of an isolated grain is evaluated [m/s].
    factor : factor of that drag [-].

    Notes
    -----
    Source: Gidaspow 1994 (model A), beta = 150 phi**2 mu/(eps d**2) + 1.75 phi rho slip/d below eps = 0.8
    (Ergun 1952). Written as a multiple of the drag of a smooth sphere (Schiller and Naumann, for which it was
    published): with that drag law it is exactly Ergun's, with another it keeps the ratio of that law to the
    smooth sphere. Settling does not follow a power of eps below 0.8: w_p/w_0 = 0.12 eps**3/phi for Stokes and
    sqrt(0.33/1.75) eps**1.5 for Newton, the same for both models. The drag is discontinuous at 0.8: it
    changes by 15 % for Stokes and by a factor of 3.7 for Newton.

    Examples
    --------
    >>> speed, factor = gidaspow(0.001, 0.4, 1.0e-9, 1.0e-6, True)
    >>> speed, round(factor, 2)  # Stokes: 150 phi/(18 eps)
    (0.001, 12.5)
    """
    if eps >= 0.8:
        return wen_yu(slip, eps, stress)
    re = reynolds(slip, d, nu)
    ergun = (150.0 * (1.0 - eps) / eps + 1.75 * re) / (18.0 * stokes_multiple(re))
    return slip, ergun if stress else ergun / eps


@step_law
def chi_di_felice(re: float) -> float:
    """Exponent chi of the void fraction [-] after Di Felice; Re is taken with eps slip [-].

    Notes
    -----
    Source: Di Felice 1994, chi = 3.7 - 0.65 exp(-(1.5 - log10 Re)**2/2); 3.7 at small and large Re, 3.05 at
    31.6.

    Examples
    --------
    >>> chi_di_felice(0.0), round(chi_di_felice(10.0**1.5), 9)
    (3.7, 3.05)
    """
    if re <= 0.0:
        return 3.7
    away = 1.5 - elementary.log10(re)
    return 3.7 - 0.65 * elementary.exp(-0.5 * away * away)


@step_law
def di_felice(slip: float, eps: float, d: float, nu: float, stress: bool) -> tuple[float, float]:
    """Hindered drag after Di Felice.

    Parameters
    ----------
    slip : speed of the water relative to the grain [m/s], >= 0.
    eps : void fraction 1 - phi [-], > 0.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    stress : whether buoyancy is that of the mixture (model A).

    Returns
    -------
    speed : slip at which the drag of an isolated grain is evaluated [m/s].
    factor : factor of that drag [-].

    Notes
    -----
    Source: Di Felice 1994, F = F_0(eps slip) eps**-chi with chi from `chi_di_felice`; F_0 is the drag of an
    isolated grain at the same superficial velocity. Read as model A, because only then are the exponents of
    settling 4.7 for Stokes and 2.35 for Newton, as observed. In between, w_p/w_0 is not an exact power of
    eps, because chi varies with Re. Published with C_D = (0.63 + 4.8/sqrt(Re))**2.

    Examples
    --------
    >>> speed, factor = di_felice(0.1, 0.5, 0.001, 1.0e-6, True)  # eps slip d/nu = 50
    >>> speed, round(chi_di_felice(50.0), 4), round(factor, 4)
    (0.05, 3.0627, 8.3556)
    """
    speed = eps * slip
    chi = chi_di_felice(reynolds(speed, d, nu))
    return speed, elementary.power(eps, -chi if stress else -chi - 1.0)


@step_law
def power(slip: float, eps: float, exponent: float) -> tuple[float, float]:
    """Hindered drag, eps**-m times that of an isolated grain at the same slip.

    Parameters
    ----------
    slip : speed of the water relative to the grain [m/s], >= 0.
    eps : void fraction 1 - phi [-], > 0.
    exponent : m [-].

    Returns
    -------
    speed : slip at which the drag of an isolated grain is evaluated [m/s]; the slip itself.
    factor : factor of that drag [-].

    Notes
    -----
    Source: the form used in YADE (m = 3.1, there with the weight of the displaced clear water: model B).
    Used unchanged in both models; the exponent of settling is (a + m)/a in B and (a + 1 + m)/a in A.

    Examples
    --------
    >>> speed, factor = power(0.1, 0.5, 3.0)
    >>> speed, round(factor, 12)
    (0.1, 8.0)
    """
    return slip, elementary.power(eps, -exponent)
