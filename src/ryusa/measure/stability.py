"""Closed forms for a grain before a run: stiffness, contact time, overlap, time step, cost."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.laws.adhesion import sticking_speed
from ryusa.laws.collision import (
    collision_time,
    contact_time_no_tension,
    omega_natural,
    overlap_max,
    shortest_contact,
    stiffness_for_overlap,
    zeta_no_tension,
)
from ryusa.laws.contact import damping
from ryusa.laws.drag import added_mass, volume
from ryusa.laws.hertz import modulus_for_stiffness, stiffness_hertz_for_overlap
from ryusa.measure._run import Floats
from ryusa.measure.table import lines
from ryusa.printed import ByShape

BAND = (0.001, 0.01)  # largest overlap over diameter: stiffer costs steps, softer trembles (Fig. 11)
A_3 = math.pi / 6.0
C_M = 0.5
RHO_W = 1000.0
G = 9.80665
SHEAR_RATIO = 2.0 / 7.0
POISSON = 0.25


@dataclass(frozen=True)
class Grain:
    """A grain, how hard it hits, and where it is.

    Attributes
    ----------
    d : diameter [m].
    rho_s : density [kg/m3].
    e : restitution wanted, without tension [-].
    speed : impact speed [m/s].
    water : True when it carries added mass (C_M = 0.5, 1000 kg/m3).
    pull_off : pull-off force [N]; 0 without adhesion.
    """

    d: float
    rho_s: float
    e: float
    speed: float
    water: bool = False
    pull_off: float = 0.0

    @property
    def bond_number(self) -> float:
        """Pull-off force over weight, in water less buoyancy [-]."""
        return self.pull_off / (G * (self.m - (RHO_W * volume(self.d, A_3) if self.water else 0.0)))

    @property
    def m(self) -> float:
        """Mass [kg]."""
        return self.rho_s * volume(self.d, A_3)

    @property
    def m_moving(self) -> float:
        """Mass that resists acceleration [kg]: with added mass in water."""
        return self.m + (added_mass(RHO_W, C_M, volume(self.d, A_3)) if self.water else 0.0)


@dataclass(frozen=True)
class StiffnessChoice:
    """What follows from one stiffness; "fixed" against a fixed grain, "free" between two alike.

    Attributes
    ----------
    k_n, k_s : stiffness [N/m].
    youngs_modulus : of elastic spheres of Poisson's ratio 0.25 with the same overlap on a fixed grain [Pa].
    overlap_fixed, overlap_free : largest overlap over diameter at the impact speed [-].
    eq_8 : Eq. (8) with the dry grain's mass [s].
    time_fixed, time_free : contact time with dashpot and added mass [s].
    eta_fixed, eta_free : normal dashpot that gives e [N s/m].
    overlap_adhesion : overlap over diameter that the pull-off force alone gives [-].
    sticking : speed up to which head-on impacts on a fixed grain stick [m/s].
    dt : step, the shortest contact of a free pair over the steps per contact [s].
    travel : speed times contact time over diameter [-]; beyond about 0.3 a grain skims the crests.
    steps : steps per simulated second.
    cost : seconds of computing per simulated second and thousand grains at `rate`.
    """

    k_n: float
    k_s: float
    youngs_modulus: float
    overlap_fixed: float
    overlap_free: float
    eq_8: float
    time_fixed: float
    time_free: float
    eta_fixed: float
    eta_free: float
    overlap_adhesion: float
    sticking: float
    dt: float
    travel: float
    steps: float
    cost: float

    def row(self) -> dict[str, object]:
        """One line of a CSV table."""
        units = {"k_n": "N_per_m", "k_s": "N_per_m", "eq_8": "s", "time_fixed": "s", "time_free": "s"}
        units |= {"eta_fixed": "Ns_per_m", "eta_free": "Ns_per_m", "dt": "s", "steps": "per_s"}
        units |= {"cost": "s_per_s", "youngs_modulus": "Pa", "sticking": "m_per_s"}
        return {f"{n}_{units[n]}" if n in units else n: v for n, v in vars(self).items()}


def stable_range(grain: Grain, band: tuple[float, float] = BAND) -> tuple[float, float]:
    """Softest and stiffest k_n [N/m] whose largest overlap on a fixed grain stays in the band."""
    zeta = zeta_no_tension(grain.e)
    soft = stiffness_for_overlap(band[1] * grain.d, grain.speed, grain.m_moving, zeta)
    stiff = stiffness_for_overlap(band[0] * grain.d, grain.speed, grain.m_moving, zeta)
    return soft, stiff


def choice(grain: Grain, k_n: float, steps_per_contact: float = 50.0, rate: float = 5.0e6) -> StiffnessChoice:
    """Everything that follows from a stiffness.

    Parameters
    ----------
    grain : what hits.
    k_n : normal stiffness [N/m].
    steps_per_contact : steps in the shortest contact of two free grains [-].
    rate : grain steps per second that the machine is assumed to do [1/s].
    """
    zeta = zeta_no_tension(grain.e)
    fixed, free = grain.m_moving, 0.5 * grain.m_moving
    time_fixed = contact_time_no_tension(zeta, omega_natural(k_n, fixed))
    overlap = overlap_max(grain.speed, fixed, k_n, zeta)
    hertz = stiffness_hertz_for_overlap(overlap, grain.speed, fixed, zeta)
    dt = shortest_contact(free, k_n, zeta, False) / steps_per_contact
    return StiffnessChoice(
        k_n=k_n,
        k_s=SHEAR_RATIO * k_n,
        youngs_modulus=modulus_for_stiffness(hertz, 0.25 * grain.d, POISSON),
        overlap_fixed=overlap / grain.d,
        overlap_free=overlap_max(grain.speed, free, k_n, zeta) / grain.d,
        eq_8=collision_time(grain.m, k_n),
        time_fixed=time_fixed,
        time_free=contact_time_no_tension(zeta, omega_natural(k_n, free)),
        eta_fixed=damping(zeta, k_n, fixed),
        eta_free=damping(zeta, k_n, free),
        overlap_adhesion=grain.pull_off / k_n / grain.d,
        sticking=sticking_speed(grain.pull_off, fixed, k_n, zeta, False),
        dt=dt,
        travel=grain.speed * time_fixed / grain.d,
        steps=1.0 / dt,
        cost=1.0e3 / dt / rate,
    )


@dataclass(frozen=True, repr=False)
class Chart(ByShape):
    """Contact time and overlap of several diameters over a range of stiffness.

    Attributes
    ----------
    d : diameters [m], shape (n,).
    k_n : stiffness [N/m], shape (m,).
    time : Eq. (8) with the dry mass [s], shape (n, m).
    overlap : largest overlap over diameter on a fixed grain [-], damped, shape (n, m).
    band_k, band_time : stiffness [N/m] and Eq. (8) [s] at both edges of the band, shape (2, n).
    """

    d: Floats
    k_n: Floats
    time: Floats
    overlap: Floats
    band_k: Floats
    band_time: Floats

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per diameter and stiffness."""
        columns = {
            "d_m": self.d[:, None], "k_n_N_per_m": self.k_n, "time_s": self.time,
            "overlap_over_d": self.overlap,
        }  # fmt: skip
        return lines(columns)


def chart(grain: Grain, d: Floats, k_n: Floats, band: tuple[float, float] = BAND) -> Chart:
    """Contact time, overlap and band for diameters d [m] over stiffness k_n [N/m]; the rest as `grain`."""
    zeta = zeta_no_tension(grain.e)
    grains = [replace(grain, d=float(one)) for one in d]
    time = [[collision_time(g.m, float(k)) for k in k_n] for g in grains]
    overlap = [[overlap_max(g.speed, g.m_moving, float(k), zeta) / g.d for k in k_n] for g in grains]
    edges = np.array([stable_range(g, band) for g in grains]).T  # softest, stiffest
    at_edges = [[collision_time(g.m, float(k)) for g, k in zip(grains, row, strict=True)] for row in edges]
    return Chart(
        d=np.asarray(d, dtype=np.float64),
        k_n=np.asarray(k_n, dtype=np.float64),
        time=np.array(time),
        overlap=np.array(overlap),
        band_k=edges,
        band_time=np.array(at_edges),
    )


def chart_around(grain: Grain, d: Floats) -> Chart:
    """Chart that holds the whole band of all diameters d [m], and three times as stiff and as soft."""
    edges = chart(grain, d, np.ones(1)).band_k
    middle = float(np.sqrt(edges.min() * edges.max()))
    half = max(100.0, 3.0 * float(np.sqrt(edges.max() / edges.min())))
    return chart(
        grain, d, np.logspace(np.floor(np.log10(middle / half)), np.ceil(np.log10(middle * half)), 81)
    )
