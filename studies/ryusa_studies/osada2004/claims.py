"""What the paper reports: statements in our wording of the Japanese text, numbers in the paper's units."""

from dataclasses import dataclass

from ryusa_studies.osada2004._film import FLOWS


@dataclass(frozen=True)
class Claim:
    """One thing the paper reports, under an id of ours."""

    id: str
    figure: str  # of the paper; "" where the text alone says it
    setup: str
    says: str
    free: str = ""  # what the text does not fix
    caution: str = ""  # what we found about the claim itself
    words: tuple[str, str] | None = None  # where it holds, where it fails; else those of its kind


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
_RIVER = (
    "grains of 20 cm on a saturated bed of 15 deg, on to which water runs, and a reach of 3 deg below; "
    "rotation free, with rolling friction; water varies along the stream, coupled both ways with the grains"
)
_HEAP = "heap between walls, mean d 0.2 cm, e = 0.7, one side wall removed at once"
_BOX = "42 grains of 0.2 cm fall into a box of fixed grains, e = 0.7"
_OURS = ("finding of ours: holds", "finding of ours: does not hold")
_FILMS = (
    "films of experiments show collisions of about 0.01 s",
    "speed and resolution of the film",
    "the film that is judged is one of the model by itself, none of an experiment; grains that it shows in "
    "contact may only be nearer to each other than it resolves",
    ("seen on a film of the model", "not seen on a film of the model"),
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
    Claim(
        "spin-e",
        "",
        f"{_SALTATION}; rotation locked or free",
        "rotation is locked because restitution is no longer uniquely determined with it",
        "which restitution; what counts as unique",
    ),
    Claim("spin-time", "", f"{_SALTATION}; rotation free", "rotation does not change the collision time"),
    *(Claim(claim, "", flow.setup, *_FILMS) for claim, flow in FLOWS.items()),
    Claim("fig8", "8", "largest overlap/d against k_n", "d = 0.2 cm: 0.01 at about 100 N/cm", "impact speed"),
    Claim(
        "fig8-through",
        "",
        "two grains of 0.2 cm, soft springs",
        "at 0.01 N/cm grains overlap greatly; on weak springs they pass through others",
        "impact speed",
    ),
    Claim(
        "fig10-soft",
        "9, 10a",
        f"{_BOX}, k_n = 1 N/cm; z displacement of marked grains per 0.01 s",
        "small vibrations of nearly half of the 42 grains continue until the run ends at 0.5 s",
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
        "fig12-avalanche",
        "12",
        "grains of the size of debris flows, here d = 20 cm in the avalanche of fig13",
        "even in the stable region collisions of large grains are long enough, here 0.01 s",
        "impact speeds in the flow",
    ),
    Claim(
        "hops",
        "",
        f"{_SALTATION}; same e, different collision time",
        "mean and largest jump height and mean length do not change",
        _SALTATION_FREE,
    ),
    Claim(
        "hops-impulse",
        "",
        f"{_SALTATION}; same e, different collision time",
        "the reason: the impulse of a collision does not change with the collision time",
        "which impulse: of one contact, or of a bounce",
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
        "0.0001 s: far more jagged path, shorter travel; 0.01 s: nearer to parallel layers",
    ),
    Claim(
        "fig17",
        "17",
        _ITO,
        "concentration about 0.3 even near the surface; grains of the upper layer collide frequently, and "
        "their collisions throw them up and down, where the experiment rather shows parallel layers",
        "water model, slope (about 15 deg is implied), friction angle, number of grains, what is near the "
        "surface",
    ),
    Claim("fig17-time", "17", _ITO, "collision time about 0.00007 s", "which pair: fixed or free partner"),
    Claim("fig17-e", "17", _ITO, "restitution about 0.7", "which pair: fixed or free partner"),
    Claim(
        "fig17-egashira",
        "17",
        _ITO,
        "springs and dashpots were set so that concentration, grain speed and discharge agree with measured "
        "values",
        "measured values, for which closed forms of Egashira, Miyamoto & Itoh stand; friction angle there",
        "Ito's measured profiles were not found in numbers; a closed form is no measurement",
        ("within the closed forms", "outside the closed forms"),
    ),
    Claim(
        "fig17-parallel",
        "17",
        _ITO,
        "in the experiment the paths of grains rather take the form of parallel layers",
        "how nearly; over what way",
        "the paper shows no track of the experiment: the number asked is ours",
        ("nearly parallel", "not nearly parallel"),
    ),
    Claim(
        "fig17-lock",
        "",
        _ITO,
        "without a deposit layer grains move separately, and locking rotation caused no problem",
    ),
    Claim(
        "fig17-free",
        "",
        _ITO.replace("rotation locked", "rotation free"),
        "grain speed near the bed extremely large, which affects concentration and flux; no solution near "
        "the measurements",
        "as fig17; the measurements are not in the text",
    ),
    Claim(
        "fig18",
        "18",
        "sketch; fig17 with contacts 30 times as long, restitution kept",
        "short contacts end as they begin and shake the paths; during long ones grains are thought to flow "
        "down together, with less motion up and down and paths like parallel layers",
        "as fig17; how long",
        "with linear springs long contacts of small grains are deep overlaps",
    ),
    Claim(
        "long-contacts",
        "13-18",
        "flows of fig13 and fig17 with contacts of several lengths, restitution kept",
        "the short collision time is thought to affect that paths are not like parallel layers",
        "closure of the water",
        "with linear springs long contacts and deep overlaps come together",
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
        "three neighbours move downstream like a rod, as they can hardly climb over the grain in front",
        "tau_star, bed depth, how the bed was laid down, friction angle",
    ),
    Claim(
        "fig22-free",
        "",
        "movable bed, rotation free, no rolling friction",
        "for lack of resistance some grains that roll over the bed spin fast, which affects speed and flux",
        "tau_star, bed depth, which resistance",
    ),
    Claim(
        "eq13",
        "23",
        "rolling friction, Eq. (13)",
        "proposal: a moment M_f opposite to M_t, the moment of the shear force, resists rotation",
        "f', width of the contact",
        "M_t is not the spin: on a rolling grain M_f brakes and drives by turns",
    ),
    Claim(
        "rolling-friction",
        "23",
        "a coefficient of rolling friction, fitted on the heap and the saltating grain",
        "to be done: the best value of f' is to be derived by comparison with basic experiments",
        "form of the law, coefficient, friction angle",
    ),
    Claim(
        "rolling-blind",
        "23",
        "a coefficient of rolling friction, fitted on the heap alone in a wide box, the rest predicted blind",
        "to be done: the best value of f' is to be derived by comparison with basic experiments",
        "form of the law, coefficient, friction angle",
        "the search of rolling-friction ended in the corner of its box, its step too long for the springs",
    ),
    Claim(
        "water-torque",
        "21",
        f"{_SALTATION}; rotation free, with the torque of the water",
        "that the torque of the water is not considered is thought to be one cause of the fast spin",
        "law of the torque, Reynolds number; what spin is too much",
        "an open question of the paper; the number asked is ours",
    ),
    Claim(
        "water-torque-half",
        "21",
        f"{_SALTATION}; rotation free, with the torque of the water",
        "the torque is to be modelled in future; ours: it removes at least half of the excess spin",
        "law of the torque, Reynolds number; what spin is too much",
        "an open question of the paper; the number asked is ours",
    ),
    Claim(
        "water-torque-shear",
        "",
        f"{_SALTATION}; rotation free with the torque of the water, or locked",
        "nothing; ours: with the torque of the water the bed shear resistance of free grains is about half "
        "of that of locked ones",
        "law of the torque, Reynolds number; definition of shear resistance",
        "no explanation of Fig. 20: the run of the paper had no torque of the water, and its half must have "
        "another reason",
        _OURS,
    ),
    Claim(
        "debris-river",
        "",
        _RIVER,
        "to be done: flow and deposition of debris flows at the scale of real rivers, where the problem of "
        "the collision time does not arise",
        "friction angle, k_s, depth of the bed, rolling friction",
        "an open question of the paper; the stream and the numbers asked are ours",
    ),
    Claim(
        "debris-river-time",
        "",
        _RIVER,
        "with the grains of real debris flows the collision time is long enough, and problems of short ones "
        "are thought to be avoided; ours: flow and deposit are alike with 0.01 s and 0.001 s",
        "friction angle, k_s, depth of the bed, rolling friction",
        "an open question of the paper; the stream and the numbers asked are ours",
    ),
)
CLAIMS = {claim.id: claim for claim in _CLAIMS}
