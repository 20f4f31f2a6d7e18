"""The choices of physics, each declared once: its word, number, law, meaning and source.

From this table follow the words of the case file and its JSON Schema, the numbers in scenes and kernels, the
dispatch from a word to its law, the lines of `ryusa check`, and the table of laws in the documentation. To
add a law, write one function in the file of its subject and one line here.

Each line lists number, word, function, meaning, source, case keys that the choice takes, and marks. Numbers
are stored in scenes and checkpoints: a new choice takes the next one, and none is reused. A choice without a
word cannot be selected in a case file. The functions of a family take their arguments by name from those
that `laws.dispatch` gives to the family. Modules that distinguish choices without a dispatch list all choices
(`_family.numbers`, `_family.rules`); a missing one is an error at import.
"""
# fmt: off

from ryusa.laws._family import Family
from ryusa.laws.adhesion import adhesion_area, adhesion_constant, adhesion_dmt
from ryusa.laws.collision import zeta_no_tension, zeta_tension
from ryusa.laws.contact import normal_force, normal_force_no_tension, slide
from ryusa.laws.drag import (
    c_d_constant,
    c_d_ferguson_church_sand,
    c_d_ferguson_church_sphere,
    c_d_re_04,
    c_d_re_2,
    c_d_schiller_naumann,
)
from ryusa.laws.hindrance import di_felice, gidaspow, power, richardson_zaki, unhindered, wen_yu
from ryusa.laws.immersed import lubrication_force, restitution_davis, restitution_exponential
from ryusa.laws.lift import (
    magnus_loth,
    magnus_oesterle_dinh,
    magnus_rubinow_keller,
    shear_lift_saffman_mei,
    shear_lift_wiberg_smith,
)
from ryusa.laws.nonspherical import c_d_bagheri_bonadonna, c_d_ganser, c_d_haider_levenspiel
from ryusa.laws.rolling import reduced_radius, rolling_arm_width
from ryusa.laws.side_walls import friction_blasius, friction_karman_prandtl
from ryusa.laws.torque import torque_dennis, torque_stokes
from ryusa.laws.turbulence import (
    length_parabolic_between,
    length_prandtl,
    length_van_driest,
    wall_no_slip,
    wall_rough,
    wall_smooth,
)
from ryusa.laws.water import log_law_rough, log_law_smooth, still, uniform

# ------------------------------------------------------------------------------------------------- contacts


class ContactForce(Family, key="contact.law"):
    """Springs of a contact."""

    LINEAR = (0, "linear", None, "linear springs of constant stiffness k_n and k_s", "Eqs. (1)-(2)",
        ("stiffness", "shear_ratio", "shear_stiffness", "damping", "shear_damping", "parting"))
    HERTZ_MINDLIN = (1, "Hertz-Mindlin", None,
        "elastic spheres: (4/3) E_e sqrt(R_e) x^1.5, and 8 G_e a along the contact",
        "Hertz 1882; Mindlin 1949; design/0018",
        ("youngs_modulus", "poisson_ratio", "damping_law", "unloading", "expected_speed"))


class DampingLaw(Family, key="contact.damping_law"):
    """Normal dashpot of elastic spheres, c x^0.25 v: how c follows from the restitution."""

    THORNTON = (0, "Thornton", zeta_no_tension,
        "the normal force ends where it would pull", "Thornton, Cummins & Cleary 2013")
    TSUJI = (1, "Tsuji", zeta_tension,
        "the dashpot may pull until the overlap ends", "Tsuji, Tanaka & Ishida 1992")


class Unloading(Family, key="contact.unloading"):
    """Tangential spring of elastic spheres as their contact area shrinks. Marks: arguments of hertz_step."""

    RESCALED = (0, "rescaled", None, "the spring is let go with the contact radius, a/a_old",
        "Walton 1993; LAMMPS mindlin_rescale/force", (), ("rescaled",))
    PLAIN = (1, "plain", None, "the spring is kept, which creates energy", "LAMMPS mindlin/force")


class Parting(Family, key="contact.parting"):
    """End of a contact: whether the dashpot may pull before the overlap ends."""

    NO_TENSION = (0, "no tension", normal_force_no_tension,
        "the normal force ends where it would pull", "Eq. (1); Schwager & Poeschel 2007")
    TENSION = (1, "tension", normal_force,
        "the dashpot may pull until the overlap ends", "Eq. (1) as printed")


class ContactTiming(Family, key="contact.timing"):
    """Begin and end of a contact in time."""

    AT_STEPS = (0, "at steps", None,
        "a contact begins and ends at time steps, with errors of one step", "LAMMPS and others")
    EXACT = (1, "exact", None,
        "a contact begins and ends at its true instants within a step", "design/0014")


class Adhesion(Family, key="contact.adhesion"):
    """Attraction of two grains in touch, along their normal, beside springs and dashpots."""

    NONE = (0, "none", None, "no attraction")
    CONSTANT = (1, "constant", adhesion_constant, "the pull-off force that is given, the same for all pairs",
        "design/0024", ("pull_off_force",))
    DMT = (2, "DMT", adhesion_dmt, "the pull-off force 2 pi w R_e, constant in touch",
        "Bradley 1932; Derjaguin, Muller & Toporov 1975", ("work_of_adhesion",))
    CONTACT_AREA = (3, "contact area", adhesion_area,
        "c pi R_e x, energy density times the contact area of elastic spheres: simplified JKR",
        "LIGGGHTS sjkr, with the area of Hertz", ("adhesion_density",), ("elastic",))


class Slip(Family, key="contact.slip"):
    """Tangential contact: the forces that the Coulomb cap limits. Marks: arguments of `contact.slide`."""

    SPRING = (0, "spring", slide, "the spring is capped, the dashpot kept", "Eqs. (2)-(4) as printed")
    SPRING_DROP = (1, "spring-drop", slide,
        "the spring is capped, the dashpot left out while sliding", "Eqs. (2)-(4)", (), ("drop",))
    TOTAL = (2, "total", slide,
        "spring and dashpot are capped together", "LAMMPS; Luding 2008", (), ("total",))


class Cap(Family, key="contact.cap"):
    """Coulomb cap: the normal force in Eq. (4)."""

    SPRING = (0, "spring", None, "the spring e_n alone", "Eq. (4) as printed")
    TOTAL = (1, "total", None, "the whole normal force f_n", "LAMMPS", (), ("total",))


class Rolling(Family, key="rolling.model"):
    """Rolling friction."""

    NONE = (0, "none", None, "no rolling friction")
    PRINTED = (1, "printed", None,
        "f N against the torque of the shear force, unlimited", "Eq. (13) as printed",
        ("arm", "coefficient"), ("both alike",))
    CONSTANT = (2, "constant", None,
        "f N against the relative spin, which it cannot reverse in a step", "Ai et al. 2011, type A",
        ("arm", "coefficient"))
    EPSD = (3, "spring-dashpot-slider", None,
        "elastic-plastic spring with a dashpot, capped at f N", "Ai et al. 2011, type C",
        ("arm", "coefficient", "stiffness_factor", "damping_ratio"), ("spring",))
    LIMITED = (4, "printed-limited", None,
        "as printed, but at most the torque of the shear force that it opposes", "Eq. (13), limited to |M_t|",
        ("arm", "coefficient"), ("both alike",))


class Arm(Family, key="rolling.arm"):
    """Rolling friction: the length that turns its coefficient into the arm f."""

    CONTACT_WIDTH = (0, "contact width", rolling_arm_width,
        "f = f' b, b the width of the contact", "Eq. (13)", (), ("varies",))
    REDUCED_RADIUS = (1, "reduced radius", reduced_radius,
        "f = mu_r R*, R* = R_i R_j/(R_i + R_j)", "Ai et al. 2011")


# ------------------------------------------------------------------------------------- water of a given flow


class Profile(Family, key="water.profile"):
    """Velocity profile of the water."""

    NONE = (0, "", None, "no water")
    LOG_ROUGH = (1, "log rough", log_law_rough, "logarithmic over a rough bed", "Eq. (9)",
        ("tau_star", "u_star", "roughness", "above"))
    LOG_SMOOTH = (2, "log smooth", log_law_smooth, "logarithmic over a smooth bed, with a viscous layer",
        "law of the wall, u+ = z+ up to 11.3", ("tau_star", "u_star", "above"))
    UNIFORM = (3, "uniform", uniform, "one speed at every height above `water.zero`", "", ("speed", "above"))
    STILL = (4, "still", still, "water at rest", "", ("above",))
    COLUMN = (5, "column", None, "a water column, coupled both ways with the grains", "design/0007",
        ("tau_star", "u_star", "roughness", "buoyancy", "hindrance", "lift", "magnus", "column", "row"))


class Above(Family, key="water.above"):
    """Flow above the depth of the water."""

    CONTINUE = (0, "continue", None, "the profile continues")
    HOLD = (1, "hold", None, "the speed is that of the surface")
    DRY = (2, "dry", None, "neither drag nor torque; the weight remains that under water")


# ------------------------------------------------------------------------------------------- water on a grain


class Drag(Family, key="water.drag"):
    """Drag coefficient C_D of an isolated grain; Re is the slip times d/nu."""

    NONE = (0, "none", None, "no drag")
    CONSTANT = (1, "constant", c_d_constant, "the same at every Re", "", ("drag_coefficient",))
    RE_04 = (2, "24/Re+0.4", c_d_re_04, "24/Re + 0.4: spheres", "customary in Japanese bed-load studies")
    RE_2 = (3, "24/Re+2", c_d_re_2, "24/Re + 2: angular natural grains", "Rubey's form")
    SCHILLER_NAUMANN = (4, "Schiller-Naumann", c_d_schiller_naumann,
        "24/Re (1 + 0.15 Re^0.687), 0.44 above Re = 1000: smooth spheres", "Schiller & Naumann 1933")
    FERGUSON_CHURCH_SPHERE = (5, "Ferguson-Church sphere", c_d_ferguson_church_sphere,
        "(1/3) (sqrt(0.3) + sqrt(0.3 + 72/Re))^2: settling of spheres", "Ferguson & Church 2004")
    FERGUSON_CHURCH_SAND = (6, "Ferguson-Church sand", c_d_ferguson_church_sand,
        "(1/3) (sqrt(0.75) + sqrt(0.75 + 72/Re))^2: settling of natural sand", "Ferguson & Church 2004")


class DragOfForm(Family, key="water.drag_of_form"):
    """Drag coefficient of clumps; Re is the slip times d/nu, d the diameter of the sphere of their volume."""

    SPHERE = (0, "sphere", None, "that of the sphere of the same volume, `drag`")
    GANSER = (1, "Ganser", c_d_ganser, "by sphericity", "Ganser 1993")
    HAIDER_LEVENSPIEL = (2, "Haider-Levenspiel", c_d_haider_levenspiel, "by sphericity",
        "Haider & Levenspiel 1989")
    BAGHERI_BONADONNA = (3, "Bagheri-Bonadonna", c_d_bagheri_bonadonna, "by the lengths of three axes",
        "Bagheri & Bonadonna 2016")


class Hindrance(Family, key="water.hindrance"):
    """Effect of neighbours on drag; n is the exponent of settling for Stokes and for Newton drag."""

    NONE = (0, "none", unhindered, "the drag of an isolated grain; n = 2 and 1.5 with buoyancy `stress`")
    RICHARDSON_ZAKI = (1, "Richardson-Zaki", richardson_zaki,
        "a suspension settles with (1 - phi)^n exactly", "Richardson & Zaki 1954; n of Rowe 1987",
        ("hindrance_exponent",))
    POWER = (2, "power", power, "(1 - phi)^-m times the isolated drag; n = 2 + m and (3 + m)/2 with `stress`",
        "YADE, m = 3.1", ("hindrance_exponent",))
    WEN_YU = (3, "Wen-Yu", wen_yu, "(1 - phi)^-3.65 F_0((1 - phi) slip); n = 4.65 and 2.33",
        "Wen & Yu 1966")
    GIDASPOW = (4, "Gidaspow", gidaspow, "Wen & Yu up to phi = 0.2, Ergun's packed bed above",
        "Gidaspow 1994")
    DI_FELICE = (5, "Di Felice", di_felice, "(1 - phi)^-chi(Re) F_0((1 - phi) slip); n = 4.7 and 2.35",
        "Di Felice 1994")


class Buoyancy(Family, key="water.buoyancy"):
    """Force of the water on a grain apart from drag, lift and added mass."""

    WEIGHT = (0, "weight", None, "V (-rho_w g - dp/dx): weight of the displaced water, pressure gradient",
        "Eqs. (10)-(11)")
    STRESS = (1, "stress", None, "V (-grad p + d tau/dz): pressure and shear stress of the mixture",
        "design/0007")
    PRESSURE = (2, "pressure", None, "rho_w V g cos(slope), only normal to the bed", "design/0007")


class Lift(Family, key="water.lift"):
    """Lift by shear of the water."""

    NONE = (0, "none", None, "no shear lift")
    WIBERG_SMITH = (1, "Wiberg-Smith", shear_lift_wiberg_smith,
        "(1/2) rho_w C_L A (u_top^2 - u_bottom^2)", "Wiberg & Smith 1985", ("lift_coefficient",))
    SAFFMAN_MEI = (2, "Saffman-Mei", shear_lift_saffman_mei,
        "1.615 rho_w sqrt(nu |dU/dz|) d^2, times Mei's factor, across the slip", "Saffman 1965; Mei 1992")


class Magnus(Family, key="water.magnus"):
    """Lift by the spin of a grain relative to the water (Magnus force), k (Omega x slip)."""

    NONE = (0, "none", None, "no lift by spin")
    RUBINOW_KELLER = (1, "Rubinow-Keller", magnus_rubinow_keller, "k = pi rho_w R^3: Re << 1",
        "Rubinow & Keller 1961")
    LOTH = (2, "Loth", magnus_loth, "Rubinow & Keller, reduced by the inertia of the water", "Loth 2008")
    OESTERLE_DINH = (3, "Oesterle-Dinh", magnus_oesterle_dinh,
        "Rubinow & Keller, reduced as measured for 10 < Re < 140", "Oesterle & Bui Dinh 1998")


class WaterTorque(Family, key="water.torque"):
    """Torque of the water on a spinning grain."""

    NONE = (0, "none", None, "no torque")
    STOKES = (1, "Stokes", torque_stokes, "pi rho_w nu d^3 omega: slow spin", "Stokes")
    DENNIS = (2, "Dennis", torque_dennis, "Stokes up to Re_r = 32, 12.9/sqrt(Re_r) + 128.4/Re_r above",
        "Dennis, Singh & Ingham 1980")


# -------------------------------------------------------------------------------- films of water at a contact


class Rebound(Family, key="water.rebound"):
    """Restitution of a contact in water, as a function of the Stokes number St at first touch."""

    DRY = (0, "dry", None, "that of [contact], at every St")
    EXPONENTIAL = (1, "exponential", restitution_exponential, "e exp(-St_c/St)", "Legendre et al. 2005, 2006",
        ("rebound_stokes", "rebound_least"))
    DAVIS = (2, "Davis", restitution_davis, "e (1 + ln(2 asperity/d)/St)", "Davis, Serayssol & Hinch 1986",
        ("rebound_least", "asperity"))


class Film(Family, key="water.film"):
    """Force of the water film between grains that do not touch."""

    NONE = (0, "none", None, "no force before the grains touch")
    LUBRICATION = (1, "lubrication", lubrication_force, "6 pi mu R*^2 v/(gap + asperity), zero in touch",
        "Izard, Bonometti & Lacaze 2014; YADE", ("film_reach", "asperity"))


# ------------------------------------------------------------------------------------------ column of water


class BedKind(Family, key="water.column.bed"):
    """Boundary at the bottom of the column."""

    NO_SLIP = (0, "", wall_no_slip, "smooth wall, viscous stress in the lowest half cell")
    SMOOTH = (1, "smooth", wall_smooth, "smooth wall: logarithmic law with a viscous layer",
        "law of the wall")
    ROUGH = (2, "rough", wall_rough, "rough bed: logarithmic law at the middle of the lowest cell", "Eq. (9)",
        ("roughness",))
    MOVING = (3, "moving", wall_no_slip, "a bed of grains, whose drag stops the water; eddies may enter it")


class SurfaceRule(Family, key="water.column.surface"):
    """What is kept constant when grains enter or leave the water."""

    DEPTH = (0, "depth", None, "the height of the surface; the volume of water changes")
    VOLUME = (1, "volume", None, "the volume of water; the surface moves")


class Pressure(Family, key="water.row.pressure"):
    """Pressure of the water along a row of columns."""

    HYDROSTATIC = (0, "hydrostatic", None, "the weight of the water above, whatever its vertical motion")
    FULL = (1, "full", None, "with what turns the water up and down: waves, sills, jumps",
        "design/0030; Casulli 1999; Stelling & Zijlema 2003")


class Drive(Family, key="water.column.drive"):
    """What drives the water in addition to gravity along the slope."""

    GRAVITY = (0, "slope", None, "gravity along the slope alone", "", ("tau_star", "u_star"))
    GRADIENT = (1, "pressure gradient", None, "the given pressure gradient", "", ("pressure_gradient",))
    TAU = (2, "tau_star", None, "the pressure gradient that gives the required stress at `water.zero`", "",
        ("tau_star", "u_star"))
    DISCHARGE = (3, "discharge", None, "the pressure gradient that keeps the discharge constant", "",
        ("discharge",))


class Start(Family, key="water.column.start"):
    """Initial velocity of the water."""

    REST = (0, "rest", None, "at rest")
    STEADY = (1, "steady", None, "steady flow past the grains at rest")


class Mixing(Family, key="water.column.mixing_length"):
    """Mixing length of turbulence."""

    LAMINAR = (0, "none", None, "no turbulence")
    PRANDTL = (1, "Prandtl", length_prandtl, "kappa z", "Prandtl 1925", ("kappa",))
    PARABOLIC = (2, "parabolic", length_parabolic_between, "kappa z sqrt(1 - z/depth)",
        "Nezu & Nakagawa 1993; YADE", ("kappa",))
    VAN_DRIEST = (3, "van Driest", length_van_driest, "kappa z (1 - exp(-z+/26))", "van Driest 1956",
        ("kappa",), ("wall",))
    LI_SAWAMOTO = (4, "Li-Sawamoto", None, "kappa times the integral of (packed - phi)/packed",
        "Li & Sawamoto 1995", ("kappa", "packed"), ("grains",))
    SHEAR_LAYER = (5, "shear layer", None,
        "that of Li & Sawamoto, at most 0.12 of the vorticity thickness of jets and mixing layers",
        "Launder & Rodi 1983, Birch & Eggers 1972",
        ("kappa", "packed"), ("grains", "layers"))


class SideWalls(Family, key="water.column.side_friction"):
    """Friction of turbulent flow at two smooth side walls; laminar flow follows plane Poiseuille flow."""

    NONE = (0, "", None, "no side walls")
    BLASIUS = (1, "Blasius", friction_blasius, "f = 0.3164 Re^-0.25", "Blasius 1913")
    KARMAN_PRANDTL = (2, "Karman-Prandtl", friction_karman_prandtl, "1/sqrt(f) = 2 log10(Re sqrt(f)) - 0.8",
        "Prandtl 1935")


class Fluctuations(Family, key="water.column.fluctuations"):
    """Turbulent fluctuations of the water at the grains."""

    NONE = (0, "none", None, "only the mean flow")
    RANDOM_WALK = (1, "random walk", None, "each grain meets a random sequence of eddies",
        "YADE; Maurin et al. 2015")


FAMILIES: tuple[type[Family], ...] = (
    ContactForce, DampingLaw, Unloading, Parting, ContactTiming, Adhesion, Slip, Cap, Rolling, Arm,
    Profile, Above, Drag, DragOfForm, Hindrance, Buoyancy, Lift, Magnus, WaterTorque, Rebound, Film,
    BedKind, SurfaceRule, Pressure, Drive, Start, Mixing, SideWalls, Fluctuations,
)
