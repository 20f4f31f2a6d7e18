"""The paper as data: its equations, symbols and claims, and how we settled what it leaves open.

Osada K., Shimizu Y., Wakai A. (2004), "Study on some problems in applying the distinct element method to the
analysis of sediment-mixture flows". Statements are our wording of the Japanese text; numbers keep
the paper's units.
"""

from dataclasses import dataclass

from ryusa.studies.osada2004._film import FLOWS

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
class Claim:
    """One thing the paper reports, under an id of ours."""

    id: str
    figure: str  # of the paper; "" where the text alone says it
    setup: str
    says: str
    free: str = ""  # what the text does not fix
    caution: str = ""  # what we found about the claim itself


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

_SALTATION = (
    "one 0.2 cm grain over a line of fixed, touching 0.2 cm grains; e = 0.7 normal and tangential, "
    "tau_star 0.3, slope 1/20, depth 2 cm; 1 s to settle, then 30 saltations"
)
_SALTATION_FREE = (
    "k_rough, zero of z, C_D law, nu, A_2, A_3, k_s, friction angle, water above 2 cm, definition of one "
    "saltation"
)
_AVALANCHE = "dry avalanche of 20 cm grains on 40 deg, e = 0.7, collision time 0.01 s or 0.0001 s"
_ITO = (
    "Ito's case 1999-004: d = 0.218 cm, tau_star 1.08, depth 1.48 cm, rigid bed; k_n 200, k_s 15 N/cm, "
    "eta_n 0.001, eta_s 0.0001 N s/cm; rotation locked; water and grains coupled both ways"
)
_HEAP = "heap between walls, mean d 0.2 cm, e = 0.7, one side wall removed at once"
_BOX = "42 grains of 0.2 cm fall into a box of fixed grains, e = 0.7"
_FILMS = (
    "films of experiments show collisions of about 0.01 s",
    "speed and resolution of the film",
    "grains that a film shows in contact may only be nearer to each other than it resolves",
)

_CLAIMS = (
    Claim(
        "fig4",
        "4",
        "Eq. (8), d = 0.05 to 1 cm",
        "shorter for small d and stiff springs; d = 0.2 cm, k_n = 0.01 N/cm: about 0.01 s",
        "density (2650 kg/m3 gives the quoted number), range of k_n",
    ),
    Claim(
        "fig5",
        "5",
        "grain dropped on a fixed grain, e = 0.7, d = 0.2 cm",
        "collision time hardly differs from Eq. (8)",
        "impact speed; whether the dashpot may pull",
    ),
    Claim(
        "pair",
        "",
        "as fig5, with the struck grain free to move",
        "should not differ much from the fixed case",
        "",
        "Eq. (8) with half the mass gives a factor of 0.71",
    ),
    Claim(
        "fig7",
        "6, 7",
        f"{_SALTATION}; rotation locked; k_n swept (fig6 is 1 N/cm)",
        "mean collision time at the bed agrees with Eq. (8)",
        _SALTATION_FREE,
        "the grain skims the crests if it travels more than about 0.3 d during a contact",
    ),
    Claim("spin-time", "", f"{_SALTATION}; rotation free", "rotation does not change the collision time"),
    *(Claim(claim, "", flow.setup, *_FILMS) for claim, flow in FLOWS.items()),
    Claim("fig8", "8", "largest overlap/d against k_n", "d = 0.2 cm: 0.01 at about 100 N/cm", "impact speed"),
    Claim(
        "fig10-soft",
        "9, 10a",
        f"{_BOX}, k_n = 1 N/cm; z displacement of marked grains per 0.01 s",
        "nearly half of the 42 grains still vibrate at 0.5 s",
        "packing, drop height, rotation, threshold",
    ),
    Claim(
        "fig10-stiff", "9, 10b", f"{_BOX}, k_n = 100 N/cm", "every grain at rest by 0.125 s", "as fig10-soft"
    ),
    Claim(
        "fig10-rule",
        "",
        "as fig10, other diameters",
        "no vibration wherever overlap/d is below 0.01",
        "diameters",
    ),
    Claim(
        "steps",
        "",
        "collision time over dt",
        "at least 10 steps per contact; with fewer, grains rebound abnormally",
        "scheme",
        "the ten-step rule applies to forward differences in time",
    ),
    Claim(
        "fig11",
        "11",
        "band 0.001 < overlap/d < 0.01 laid over fig4",
        "d = 0.2 cm: collision time about 0.0001 s",
        "impact speed",
    ),
    Claim(
        "fig12",
        "12",
        "the same for large grains",
        "d = 20 cm: both 0.01 s and 0.0001 s lie in the band",
        "impact speed",
        "the two times differ by a factor of 100, the band spans a factor of 10: both cannot be in it at "
        "one speed",
    ),
    Claim(
        "hops",
        "",
        f"{_SALTATION}; same e, different collision time",
        "mean and largest jump height and mean length do not change",
        _SALTATION_FREE,
    ),
    Claim(
        "fig14",
        "13, 14",
        _AVALANCHE,
        "concentration profiles alike",
        "number of grains, bed, length, friction angle, rotation",
        "the flow is never steady with rotation free: equal time windows are compared",
    ),
    Claim(
        "fig15",
        "15",
        _AVALANCHE,
        "grain speed about 100 cm/s larger over the whole depth for 0.01 s",
        "time window",
    ),
    Claim(
        "fig15-flux",
        "15",
        _AVALANCHE,
        "so, at equal concentration, the transport rate depends on the collision time",
    ),
    Claim(
        "fig16",
        "16",
        f"{_AVALANCHE}; tracks over 1 s of grains that alternate between fixed bed and movers",
        "0.0001 s: very jagged, shorter travel; 0.01 s: nearer to parallel layers",
    ),
    Claim(
        "fig17",
        "17",
        _ITO,
        "concentration about 0.3 near the surface; even surface grains are thrown up and down, where "
        "the experiment shows nearly parallel layers",
        "water model, slope (about 15 deg is implied), friction angle, number of grains",
    ),
    Claim("fig17-time", "17", _ITO, "collision time about 0.00007 s", "which pair: fixed or free partner"),
    Claim("fig17-e", "17", _ITO, "restitution about 0.7", "which pair: fixed or free partner"),
    Claim("fig17-lock", "", _ITO, "without a deposit layer, locking rotation does no harm"),
    Claim(
        "fig17-free",
        "",
        _ITO.replace("rotation locked", "rotation free"),
        "grain speed near the bed far too large; the measurements cannot be met",
    ),
    Claim(
        "fig18",
        "18",
        "sketch",
        "long contacts carry grains along together and damp the vertical motion; short ones scatter them",
    ),
    Claim(
        "fig19-locked",
        "19b",
        f"{_HEAP}; rotation locked",
        "final slope about 33 deg (natural gravel about 38)",
        "spread of d, heap size, friction angle, floor",
        "the friction angle decides: a locked grain stays in its pocket up to a slope of 30 deg + phi",
    ),
    Claim("fig19-free", "19c", f"{_HEAP}; rotation free", "final slope about 18 deg", "as fig19-locked"),
    Claim("bed18", "", "bed of grains steeper than 18 deg, rotation free", "flows with no water force"),
    Claim(
        "fig20",
        "20",
        f"{_SALTATION}; k_n = 100 N/cm, rotation locked or free",
        "free: higher jumps and, with them, longer ones",
        _SALTATION_FREE,
        "slip rule and k_s/k_n change jump heights by tens of per cent",
    ),
    Claim(
        "fig20-shear",
        "20",
        f"{_SALTATION}; k_n = 100 N/cm, rotation locked or free",
        "free: bed shear resistance about half",
        "definition of shear resistance",
    ),
    Claim(
        "fig21",
        "21",
        f"{_SALTATION}; k_n = 100 N/cm, rotation free",
        "spin grows with every bed hit and reaches about 900 rad/s (about 140 turns a second)",
        _SALTATION_FREE,
    ),
    Claim(
        "fig22",
        "22",
        "movable bed, rotation locked",
        "neighbouring grains move downstream like rods, unable to climb over one another",
        "tau_star, bed depth",
    ),
    Claim(
        "fig22-free",
        "",
        "movable bed, rotation free, no rolling friction",
        "grains rolling over the bed spin fast, which changes speed and flux",
        "tau_star, bed depth",
    ),
    Claim(
        "eq13", "23", "rolling friction, Eq. (13)", "principle only; f' is to be identified from experiments"
    ),
)
CLAIMS = {claim.id: claim for claim in _CLAIMS}

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
