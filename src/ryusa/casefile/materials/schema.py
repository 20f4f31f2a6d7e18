"""Keys of [materials.NAME] and [[pairs]]."""

from ryusa.casefile.grains.schema import CurvePoints, GrainLength, Spread
from ryusa.casefile.quantities import (
    AdhesionDensity,
    FrictionAngle,
    FrictionCoefficient,
    GrainDensity,
    PoissonRatio,
    PullOffForce,
    Restitution,
    RollingCoefficient,
    SpringStiffness,
    WorkOfAdhesion,
    YoungsModulus,
)
from ryusa.casefile.section import Section


class MaterialSection(Section):
    """A material of grains or walls; what it does not say is as in [grains], [contact] and [rolling]."""

    density: GrainDensity | None = None
    """Density of grains of this material; of walls and fixed grains it means nothing."""
    diameter: GrainLength | None = None
    """Mean diameter of the grains of this material that feeds bring and grains.mixture lays; of walls and
    fixed grains it means nothing."""
    spread: Spread | None = None
    """Spread of their sizes about it, as grains.spread."""
    sieve_curve: CurvePoints | None = None
    """Their sizes by mass, in place of diameter and spread: pairs of diameter and percent finer, from 0 to
    100."""
    stiffness: SpringStiffness | None = None
    """Normal stiffness k_n of the linear spring between two grains of this material. Two materials give way
    as springs in series: 2/(1/k_a + 1/k_b)."""
    youngs_modulus: YoungsModulus | None = None
    """Young's modulus of elastic spheres; two materials combine as Hertz and Mindlin have it."""
    poisson_ratio: PoissonRatio | None = None
    """Poisson's ratio of elastic spheres."""
    friction_angle: FrictionAngle | None = None
    """Friction angle between two grains of this material."""
    friction: FrictionCoefficient | None = None
    """Friction coefficient between two grains of this material, instead of friction_angle."""
    restitution: Restitution | None = None
    """Normal coefficient of restitution between two grains of this material."""
    rolling_coefficient: RollingCoefficient | None = None
    """rolling.coefficient between two grains of this material."""
    pull_off_force: PullOffForce | None = None
    """contact.pull_off_force between two grains of this material."""
    work_of_adhesion: WorkOfAdhesion | None = None
    """contact.work_of_adhesion between two grains of this material."""
    adhesion_density: AdhesionDensity | None = None
    """contact.adhesion_density between two grains of this material."""


class PairSection(Section):
    """Contacts of two different materials.

    No law gives friction, restitution and adhesion of a pair from those of its two materials: where these
    differ, they have to be given here.
    """

    materials: tuple[str, str]
    """Names of the two; "grains" is the material of [grains] and [contact]."""
    friction_angle: FrictionAngle | None = None
    """Friction angle of the pair."""
    friction: FrictionCoefficient | None = None
    """Friction coefficient of the pair, instead of friction_angle."""
    restitution: Restitution | None = None
    """Normal coefficient of restitution of the pair."""
    rolling_coefficient: RollingCoefficient | None = None
    """rolling.coefficient of the pair."""
    pull_off_force: PullOffForce | None = None
    """contact.pull_off_force of the pair."""
    work_of_adhesion: WorkOfAdhesion | None = None
    """contact.work_of_adhesion of the pair."""
    adhesion_density: AdhesionDensity | None = None
    """contact.adhesion_density of the pair."""
