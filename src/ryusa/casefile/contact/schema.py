"""Keys of [contact] and [rolling]."""

from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from ryusa.casefile.quantities import (
    AdhesionDensity,
    Dashpot,
    Duration,
    Force,
    FrictionAngle,
    FrictionCoefficient,
    Number,
    PoissonRatio,
    PullOffForce,
    Restitution,
    RollingCoefficient,
    Speed,
    SpringStiffness,
    Stiffness,
    WordOf,
    WorkOfAdhesion,
    YoungsModulus,
)
from ryusa.casefile.section import Section
from ryusa.laws import families

RIVALS = (
    ("stiffness", "youngs_modulus"),
    ("friction_angle", "friction"),
    ("shear_ratio", "shear_stiffness"),
    ("restitution", "damping"),
    ("restitution", "shear_damping"),
    ("restitution_shear", "damping"),
    ("restitution_shear", "shear_damping"),
)


class OverlapStiffnessSection(Section):
    """Stiffness from the largest overlap allowed in an impact."""

    overlap: Annotated[Number, Field(gt=0, le=0.5)]
    """Largest overlap over d in the impact of one mean grain on a fixed one."""
    speed: Annotated[Speed, Field(gt=0)]
    """Impact speed at which this overlap is reached."""


class TimeStiffnessSection(Section):
    """Stiffness from the collision time of Eq. (8)."""

    collision_time: Duration
    """Duration of an undamped collision of one mean grain with a fixed one, Eq. (8), with added mass."""


def _stiffness_kind(value: Any) -> str:
    """Branch of the union for a value from the file, or for one already read that is written again."""
    if isinstance(value, TimeStiffnessSection):
        return "<time>"
    if isinstance(value, OverlapStiffnessSection):
        return "<overlap>"
    if isinstance(value, dict):
        return "<time>" if "collision_time" in value else "<overlap>"
    return "<value>"


class ContactSection(Section):
    """Springs, dashpots and slider of every contact, Eqs. (1)-(4)."""

    law: Annotated[str, WordOf(families.ContactForce)] = "linear"
    """Springs: linear ones of constant stiffness, or those of elastic spheres after Hertz and Mindlin."""
    stiffness: (
        Annotated[
            Annotated[SpringStiffness, Tag("<value>")]
            | Annotated[OverlapStiffnessSection, Tag("<overlap>")]
            | Annotated[TimeStiffnessSection, Tag("<time>")],
            Discriminator(_stiffness_kind),
        ]
        | None
    ) = None
    """Normal stiffness k_n of the linear spring: a value, or { overlap, speed }, or { collision_time }."""
    shear_ratio: Annotated[Number, Field(ge=0, le=10)] | None = None
    """k_s over k_n; 2/7 when neither this nor shear_stiffness is given."""
    shear_stiffness: Annotated[Stiffness, Field(ge=0, le=1.0e15)] | None = None
    """Tangential stiffness k_s, instead of shear_ratio."""
    youngs_modulus: YoungsModulus | None = None
    """Young's modulus E of elastic spheres; walls and fixed grains are of the same material,
    unless [materials] says otherwise."""
    poisson_ratio: PoissonRatio = 0.25
    """Poisson's ratio of elastic spheres."""
    expected_speed: Annotated[Speed, Field(gt=0)] | None = None
    """Impact speed to be expected: the contact time of elastic spheres, and with it the time step, is that at
    this speed. When not given it follows from the builder, as `ryusa check` shows."""
    restitution: Restitution | None = None
    """Normal coefficient of restitution e, the same on fixed grains and between free grains."""
    restitution_shear: Restitution | None = None
    """Tangential coefficient of restitution e_s; equal to restitution when not given."""
    damping: Annotated[Dashpot, Field(ge=0, le=1.0e12)] | None = None
    """Constant normal dashpot eta_n, instead of restitution."""
    shear_damping: Annotated[Dashpot, Field(ge=0, le=1.0e12)] | None = None
    """Constant tangential dashpot eta_s; zero when only damping is given."""
    friction_angle: FrictionAngle | None = None
    """Internal friction angle phi of Eq. (4)."""
    friction: FrictionCoefficient | None = None
    """Friction coefficient mu = tan(phi), instead of friction_angle."""
    cohesion: Annotated[Force, Field(ge=0)] = 0.0
    """Cohesion c of Eq. (4): the shear force that a contact carries without normal force."""
    adhesion: Annotated[str, WordOf(families.Adhesion)] = "none"
    """Attraction of grains in touch, along the normal of their contact: none, a constant pull-off force, that
    of Derjaguin, Muller & Toporov, or one in proportion to the contact area of elastic spheres. Contacts
    begin and end at overlap 0. Friction sees the push that carries load and attraction."""
    pull_off_force: PullOffForce | None = None
    """Pull-off force of every pair with adhesion = "constant": what parts two grains at rest."""
    work_of_adhesion: WorkOfAdhesion | None = None
    """Work of adhesion w with adhesion = "DMT", twice the surface energy of the material: the pull-off force
    is 2 pi w R_e, R_e the reduced radius of the pair, half the radius of two equal grains."""
    adhesion_density: AdhesionDensity | None = None
    """Energy density with adhesion = "contact area", the attraction per contact area pi R_e x, x the overlap;
    half of it is the cohesion energy density of LIGGGHTS' sjkr."""
    slip: Annotated[str, WordOf(families.Slip)] = "total"
    """Force that the Coulomb limit caps: "total" caps the sum of tangential spring and dashpot, "spring-drop"
    caps the spring and drops the dashpot while sliding, "spring", the reading of Eq. (3) as printed, caps the
    spring and keeps the dashpot, so that a sliding contact can carry more than mu N."""
    cap: Annotated[str, WordOf(families.Cap)] | None = None
    """Normal force in the Coulomb limit: that of the spring, e_n, or the total, f_n; "total" when not given
    with slip = "total", else "spring"."""
    timing: Annotated[str, WordOf(families.ContactTiming)] | None = None
    """Whether a contact begins and ends at time steps, or at its true instants within a step, which needs far
    fewer steps per contact for the same restitution. When not given "exact", and "at steps" with law
    "Hertz-Mindlin", with adhesion and with clumps, which have no other."""
    parting: Annotated[str, WordOf(families.Parting)] = "no tension"
    """Whether the normal dashpot may pull before the overlap ends."""
    damping_law: Annotated[str, WordOf(families.DampingLaw)] = "Thornton"
    """Normal dashpot of elastic spheres, which gives the restitution at every speed: "Thornton" never pulls,
    "Tsuji" may pull until the overlap ends."""
    unloading: Annotated[str, WordOf(families.Unloading)] = "rescaled"
    """Whether the tangential spring of elastic spheres is let go as the contact area shrinks."""


class RollingSection(Section):
    """Rolling resistance, Eq. (13) and its variants."""

    model: Annotated[str, WordOf(families.Rolling)] = "none"
    """None, Eq. (13) as printed or limited to the torque it opposes, a constant torque against the relative
    rotation, or a spring that slides."""
    arm: Annotated[str, WordOf(families.Arm)] | None = None
    """Length that the coefficient multiplies; "contact width", as in Eq. (13), when not given. The
    spring-dashpot-slider always takes "reduced radius"."""
    coefficient: RollingCoefficient = 0.0
    """f' of Eq. (13) with the contact width, or mu_r with the reduced radius."""
    stiffness_factor: Annotated[Number, Field(gt=0)] = 2.25
    """Rolling stiffness over k_n times lever arm squared; only for spring-dashpot-slider."""
    damping_ratio: Annotated[Number, Field(ge=0)] = 0.3
    """Damping ratio of the rolling spring; only for spring-dashpot-slider."""
    twisting_coefficient: Annotated[Number, Field(ge=0)] = 0.0
    """Twisting friction, in space: the largest torque about the normal of a contact over normal force and
    reduced radius R*; it opposes the relative spin about the normal, which it cannot reverse in a step. A
    contact disc of radius a that slips everywhere has 3 pi/16 mu a/R*. With no rolling friction, constant or
    spring-dashpot-slider."""
