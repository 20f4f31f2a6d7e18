"""Drag on a grain by the numbers of `model.enums`: which law speaks; every formula is a law.

It stands here because an engine asks it for free grains and the water for fixed ones.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from ryusa.laws._law import LAWS, compiled, edition
from ryusa.laws.drag import (
    c_d_ferguson_church_sand,
    c_d_ferguson_church_sphere,
    c_d_re_04,
    c_d_re_2,
    c_d_schiller_naumann,
    drag_factor,
    reynolds,
)
from ryusa.laws.hindrance import di_felice, gidaspow, power, richardson_zaki, wen_yu
from ryusa.model.enums import Drag, Hindrance

F = TypeVar("F", bound=Callable[..., Any])

D_CONSTANT, D_04, D_2 = int(Drag.CONSTANT), int(Drag.RE_04), int(Drag.RE_2)
D_SN, D_FC_SPHERE = int(Drag.SCHILLER_NAUMANN), int(Drag.FERGUSON_CHURCH_SPHERE)
RICHARDSON_ZAKI, POWER, WEN_YU = int(Hindrance.RICHARDSON_ZAKI), int(Hindrance.POWER), int(Hindrance.WEN_YU)
GIDASPOW, DI_FELICE = int(Hindrance.GIDASPOW), int(Hindrance.DI_FELICE)
_EDITION = edition(LAWS, Path(__file__), Path(__file__).parent / "enums.py")


def _inlined(function: F) -> F:
    """Compile into whoever calls."""
    return compiled(_EDITION, fastmath=False, forceinline=True)(function)


@_inlined
def drag_of(law: int, speed: float, d: float, nu: float, rho_w: float, a_2: float, c_d: float) -> float:
    """Drag of a lone grain over relative velocity [N s/m].

    Parameters
    ----------
    law : of `Drag`, not NONE.
    speed : relative [m/s].
    d : diameter [m].
    nu, rho_w : kinematic viscosity and density of the water [m2/s], [kg/m3].
    a_2, c_d : area coefficient of Eq. (10), and drag coefficient where it is constant [-].
    """
    if speed == 0.0:
        return 0.0
    re = reynolds(speed, d, nu)
    if law == D_CONSTANT:
        c = c_d
    elif law == D_04:
        c = c_d_re_04(re)
    elif law == D_2:
        c = c_d_re_2(re)
    elif law == D_SN:
        c = c_d_schiller_naumann(re)
    elif law == D_FC_SPHERE:
        c = c_d_ferguson_church_sphere(re)
    else:
        c = c_d_ferguson_church_sand(re)
    return drag_factor(speed, c, rho_w, a_2, d)


@_inlined
def hindered(
    law: int, hindrance: int, stress: bool, exponent: float, slip: float, phi: float,
    d: float, nu: float, rho_w: float, a_2: float, c_d: float,
) -> float:  # fmt: skip
    """Drag among neighbours over relative velocity [N s/m].

    Parameters
    ----------
    law, hindrance : of `Drag`, not NONE, and `Hindrance`.
    stress : True where pressure and stress of the mixture act beside the drag (model A).
    exponent : of the hindrance, where it takes one [-].
    slip : relative speed [m/s].
    phi : concentration of grains around it [-], below 1.
    d, nu, rho_w, a_2, c_d : as in `drag_of`.
    """
    if slip == 0.0:
        return 0.0
    eps = 1.0 - phi
    speed, factor = slip, 1.0
    if hindrance == RICHARDSON_ZAKI:
        speed, factor = richardson_zaki(slip, eps, exponent, stress)
    elif hindrance == POWER:
        speed, factor = power(slip, eps, exponent)
    elif hindrance == WEN_YU:
        speed, factor = wen_yu(slip, eps, stress)
    elif hindrance == GIDASPOW:
        speed, factor = gidaspow(slip, eps, d, nu, stress)
    elif hindrance == DI_FELICE:
        speed, factor = di_felice(slip, eps, d, nu, stress)
    return factor * drag_of(law, speed, d, nu, rho_w, a_2, c_d) * speed / slip
