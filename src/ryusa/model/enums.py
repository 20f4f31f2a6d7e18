"""Words of the case file as enums; strings live in TOML, these go inward."""

from enum import IntEnum


class Damping(IntEnum):
    """Where the dashpots come from."""

    RESTITUTION = 0  # from the restitution asked for and the pair's effective mass
    CONSTANTS = 1  # eta_n, eta_s given in N s/m


class Slip(IntEnum):
    """What happens to the tangential force when the Coulomb cap is reached."""

    SPRING = 0  # Eq. (3): the spring is capped, the dashpot stays
    SPRING_DROP = 1  # the spring is capped, the dashpot is dropped while sliding
    TOTAL = 2  # spring and dashpot together are capped (LAMMPS; LIGGGHTS and YADE drop the dashpot)


class Cap(IntEnum):
    """Which normal force feeds the Coulomb cap of Eq. (4)."""

    SPRING = 0  # e_n, as printed
    TOTAL = 1  # f_n = e_n + d_n


class Rolling(IntEnum):
    """Rolling friction."""

    NONE = 0
    PRINTED = 1  # Eq. (13) as printed: against the torque, unlimited
    CONSTANT = 2  # against the relative spin, limited so that it cannot reverse it (type A of Ai et al. 2011)
    EPSD = 3  # elastic-plastic spring-dashpot slider (type C of Ai et al. 2011)


class Arm(IntEnum):
    """The length that turns a rolling coefficient without dimension into f [m]."""

    CONTACT_WIDTH = 0  # f = f' b, b the contact width (Eq. 13)
    REDUCED_RADIUS = 1  # f = mu_r R*, R* = R_i R_j/(R_i + R_j)


class Profile(IntEnum):
    """Water velocity over the bed."""

    NONE = 0  # dry
    LOG_ROUGH = 1  # Eq. (9)
    LOG_SMOOTH = 2
    UNIFORM = 3
    STILL = 4  # water at rest
    COLUMN = 5  # what the engine is told of every grain: water that feels the grains


class Above(IntEnum):
    """What is above the water depth."""

    CONTINUE = 0  # the profile goes on
    HOLD = 1  # the surface speed goes on
    DRY = 2  # nothing: no drag, no buoyancy change is modelled, so weight stays submerged


class Drag(IntEnum):
    """C_D laws."""

    NONE = 0
    CONSTANT = 1
    RE_04 = 2  # 24/Re + 0.4
    RE_2 = 3  # 24/Re + 2
    SCHILLER_NAUMANN = 4
    FERGUSON_CHURCH_SPHERE = 5
    FERGUSON_CHURCH_SAND = 6


class WaterTorque(IntEnum):
    """Torque of the water on a spinning grain."""

    NONE = 0
    STOKES = 1
    DENNIS = 2  # Stokes limit up to Re_r = 32, Dennis et al. 1980 beyond


class Hindrance(IntEnum):
    """How neighbours change the drag of a grain."""

    NONE = 0
    RICHARDSON_ZAKI = 1  # exact: a suspension settles with (1 - phi)**n, n of the lone grain's Re
    POWER = 2  # (1 - phi)**-m
    WEN_YU = 3
    GIDASPOW = 4  # Wen & Yu, Ergun where dense
    DI_FELICE = 5


class Buoyancy(IntEnum):
    """Force of the water on a grain beside drag, lift and added mass, see design/0007."""

    WEIGHT = 0  # -rho V g, Eqs. (10)-(11)
    STRESS = 1  # V (-grad p + d tau/dz)
    PRESSURE = 2  # normal to the bed only


class Lift(IntEnum):
    """Lift by shear of the water."""

    NONE = 0
    WIBERG_SMITH = 1  # Bernoulli between top and bottom of the grain
    SAFFMAN_MEI = 2


class Magnus(IntEnum):
    """Lift by spin."""

    NONE = 0
    RUBINOW_KELLER = 1
    LOTH = 2  # with the correction of Loth 2008
    OESTERLE_DINH = 3


class Rebound(IntEnum):
    """Restitution of a contact under water, fixed at first touch."""

    DRY = 0  # that of the contact law
    EXPONENTIAL = 1  # e exp(-St_c/St), Legendre et al.
    DAVIS = 2  # what the film takes between half a diameter and the asperities


class EventRule(IntEnum):
    """Which contacts are recorded."""

    NONE = 0
    TRACKED = 1
    ALL = 2
