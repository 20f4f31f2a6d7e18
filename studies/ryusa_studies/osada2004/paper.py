"""The paper as data: its equations and symbols, and how we settled what it leaves open.

Osada K., Shimizu Y., Wakai A. (2004), "Study on some problems in applying the distinct element method to the
analysis of sediment-mixture flows". Statements are our wording of the Japanese text; numbers keep
the paper's units.
"""

from dataclasses import dataclass

CITATION = (
    "Osada K., Shimizu Y., Wakai A. (2004): Study on some problems in applying the distinct element method "
    "to the analysis of sediment-mixture flows."
)


@dataclass(frozen=True)
class Equation:
    """One numbered equation and the law or room that carries it."""

    number: str
    formula: str
    says: str
    code: str  # dotted name below ryusa


@dataclass(frozen=True)
class Symbol:
    """One symbol of the paper, its name in the code and its SI unit."""

    paper: str
    code: str
    unit: str
    means: str


@dataclass(frozen=True)
class Reading:
    """One doubt and how it was settled."""

    id: str
    where: str
    choice: str
    why: str


_EQUATIONS = (
    Equation(
        "1",
        "f_n = e_n + d_n = k_n overlap + eta_n closing",
        "normal force: spring and dashpot",
        "laws.contact.normal_force",
    ),
    Equation(
        "2",
        "f_s = e_s + d_s, e_s accumulated from k_s slip dt, d_s = eta_s slip",
        "tangential force: spring with history and dashpot",
        "engine",
    ),
    Equation("3", "e_s = sign(e_s) tau_c where abs(e_s) >= tau_c", "sliding", "laws.contact.slip_spring"),
    Equation("4", "tau_c = c + e_n tan(phi)", "cohesion and friction", "laws.contact.shear_strength"),
    Equation(
        "5", "m du/dt = sum(-f_n cos(a) + f_s sin(a)) + m g sin(theta)", "motion along the bed", "engine"
    ),
    Equation(
        "6", "m dv/dt = sum(-f_n sin(a) - f_s cos(a)) - m g cos(theta)", "motion normal to the bed", "engine"
    ),
    Equation("7", "I dw/dt = (d/2) sum(-f_s)", "spin; I = m d**2/10", "laws.motion.acceleration_spin"),
    Equation("8", "t = pi sqrt(m/k_n)", "collision time without loss", "laws.collision.collision_time"),
    Equation("9", "U = u_star (8.5 + 5.75 log10(z/k_rough))", "water speed", "laws.water.log_law_rough"),
    Equation(
        "10",
        "m' du/dt = contacts + (1/2) rho C_D A_2 d**2 abs(w) (U - u) + (sigma - rho) V g sin(theta)",
        "motion in water along the bed; m' = rho (sigma/rho + C_M) A_3 d**3",
        "laws.motion.acceleration",
    ),
    Equation(
        "11",
        "m' dv/dt = contacts + (1/2) rho C_D A_2 d**2 abs(w) (V - v) - (sigma - rho) V g cos(theta)",
        "motion in water normal to the bed",
        "laws.motion.acceleration",
    ),
    Equation("12", "RS = (d_i + d_j)/2 - distance", "overlap; touch where RS > 0", "laws.geometry.overlap"),
    Equation("13", "M_f = -f N sign(M_t), f = f' b", "rolling friction", "laws.rolling.rolling_printed"),
)
EQUATIONS = {equation.number: equation for equation in _EQUATIONS}

SYMBOLS = (
    Symbol("k_n, k_s", "k_n, k_s", "N/m", "normal and tangential spring"),
    Symbol("η_n, η_s", "eta_n, eta_s", "N s/m", "dashpots"),
    Symbol("e_n, e_s", "spring_n, spring_s", "N", "spring forces (Eqs. 1-4)"),
    Symbol("d_n, d_s", "dash_n, dash_s", "N", "dashpot forces (Eqs. 1-2)"),
    Symbol("f_n, f_s", "f_n, f_s", "N", "contact forces"),
    Symbol("restitution", "e, e_n, e_s", "-", "restitution"),
    Symbol("c", "cohesion", "N", "cohesion of grains"),
    Symbol("φ", "friction_angle, mu", "rad, -", "friction angle of grains and its tangent"),
    Symbol("τ_c", "tau_c", "N", "shear strength of a contact; a force"),
    Symbol("RS_ij", "overlap", "m", "overlap"),
    Symbol("t_ij", "t_col", "s", "collision time"),
    Symbol("d", "d", "m", "diameter"),
    Symbol("I", "inertia", "kg m2", "moment of inertia, never with added mass"),
    Symbol("ω, w", "omega", "rad/s", "spin; +y rolls downstream (the paper plots it negative)"),
    Symbol("U, V", "u_x, u_z", "m/s", "water velocity"),
    Symbol("u_p, v_p", "v_x, v_z", "m/s", "grain velocity"),
    Symbol("U_*", "u_star", "m/s", "friction velocity"),
    Symbol("τ_*", "tau_star", "-", "dimensionless shear stress"),
    Symbol("k_s (Eq. 9)", "k_rough", "m", "equivalent roughness"),
    Symbol("C_D, C_M", "c_d, c_m", "-", "drag and added-mass coefficient"),
    Symbol("A_2, A_3", "a_2, a_3", "-", "shape coefficients of area and volume"),
    Symbol("ρ, σ", "rho_w, rho_s", "kg/m3", "density of water and grains"),
    Symbol("m_i", "m, m_added", "kg", "mass; added mass of Eq. (10)"),
    Symbol("θ", "slope", "rad", "slope of the bed"),
    Symbol("f, f'", "f_roll, f_roll_star", "m, -", "rolling friction arm and coefficient"),
    Symbol("b", "b_contact", "m", "contact width"),
    Symbol("concentration", "phi", "-", "grain volume over volume"),
)

_READINGS = (
    Reading("sign", "Eq. (3)", "sign(e_s) tau_c", "a force cannot equal a sign"),
    Reading(
        "angle",
        "Eqs. (5)-(6)",
        "unit normals; angle from the x axis",
        "printed signs work only from the flow axis",
    ),
    Reading(
        "spring",
        "Eq. (1)",
        "spring force read from the overlap",
        "same law for small dt; accumulating biases e",
    ),
    Reading(
        "cap",
        "Eqs. (3)-(4)",
        "the cap acts on the spring alone",
        "as printed; capping the sum has its own name",
    ),
    Reading(
        "parting",
        "Eq. (1)",
        "no tension by default, tension by name; restitution exact for either",
        "the text does not say whether the dashpot may pull",
    ),
    Reading(
        "sphere", "Eqs. (7)-(8)", "grains weigh and turn as spheres", "then Eq. (8) gives the quoted 0.01 s"
    ),
    Reading(
        "arm", "Eq. (7)", "arms meet in the middle of the overlap", "keeps angular momentum; d/2 is the limit"
    ),
    Reading(
        "damping",
        "e = 0.7",
        "damping from the pair's effective mass; added mass counts, a fixed grain is infinite",
        "one dashpot cannot give one e on fixed grains and between grains",
    ),
    Reading(
        "tangential",
        "e = 0.7 tangential",
        "damping ratio of the tangential oscillator; the ratio got is measured and reported",
        "tangential and normal periods differ",
    ),
    Reading(
        "log",
        "Eq. (9)",
        "base 10, clipped at zero below k_rough/30",
        "8.5 and 5.75 are the base-10 constants",
    ),
    Reading("weight", "Eqs. (10)-(11)", "(sigma - rho) V g, no added mass", "else quartz is 30 % too heavy"),
    Reading("shape", "Eqs. (10)-(11)", "A_2 = pi/4, A_3 = pi/6", "spheres"),
    Reading("inertia", "Eqs. (7), (10)", "added mass never enters I", "it resists translation only"),
    Reading(
        "scheme",
        "section 2",
        "semi-implicit: velocity first",
        "forward differences pump energy into contacts",
    ),
    Reading(
        "spin",
        "Fig. 21",
        "rad is rad/s; clockwise negative there, +y here",
        "900 rad/s is 140 turns a second",
    ),
    Reading(
        "concentration",
        "Fig. 14",
        "sphere volume over slab volume, slab one mean d wide; area fraction beside it",
        "the text does not say which it means",
    ),
    Reading(
        "width",
        "Eq. (13)",
        "b is the circle where two spheres cut each other",
        "contact width is not defined",
    ),
)
READINGS = {reading.id: reading for reading in _READINGS}
