"""Contact laws made from what a user knows, and how long their contacts last."""

import math

from ryusa.laws import adhesion, collision, hertz
from ryusa.laws._family import evaluate, numbers
from ryusa.laws.contact import damping
from ryusa.laws.families import Adhesion, Cap, ContactForce, ContactTiming, DampingLaw, Slip, Unloading
from ryusa.model.scene import ContactLaw, Damping

numbers(__name__, DampingLaw.THORNTON, DampingLaw.TSUJI)  # the one ends the force, the other lets it pull


def elastic_spheres(
    m: float,
    r: float,
    *,
    youngs_modulus: float,
    speed: float,
    poisson_ratio: float = 0.25,
    friction: float = 0.5,
    restitution: float = 0.7,
    restitution_shear: float | None = None,
    damping_law: DampingLaw = DampingLaw.THORNTON,
    unloading: Unloading = Unloading.RESCALED,
    slip: Slip = Slip.TOTAL,
    cap: Cap | None = None,
    cohesion: float = 0.0,
    adhesion: Adhesion = Adhesion.NONE,
    adhesion_amount: float = 0.0,
) -> ContactLaw:
    """Contact law of elastic spheres after Hertz and Mindlin (design/0018).

    Parameters
    ----------
    m, r : effective mass [kg] and reduced radius [m] of a typical pair, for its linear springs of the same
        contact time.
    youngs_modulus, poisson_ratio : of grains and walls, which are of one material [Pa], [-].
    speed : impact speed to be expected [m/s]; contacts are as short as at this speed.
    friction : mu = tan(phi) [-].
    restitution, restitution_shear : normal one [-], at every speed; and that of the tangential oscillator at
        any overlap, the same as the normal one when not given.
    damping_law, unloading, slip, cap, cohesion, adhesion : as in a case file; cap follows from slip when not
        given.
    adhesion_amount : pull-off force [N], work of adhesion [J/m2] or energy density [Pa].

    >>> law = elastic_spheres(1.1e-5, 1.0e-3, youngs_modulus=1.0e7, speed=0.1)
    >>> law.tension, round(law.zeta_n, 5), round(law.k_s / law.k_n, 3)
    (False, 0.12221, 0.857)
    """
    stiff = hertz.hertz_stiffness(hertz.effective_modulus(youngs_modulus, poisson_ratio), r)
    # Without damping
    k_n = collision.stiffness_for_time(hertz.contact_time_hertz(speed, m, stiff, 0.0, True), m, 0.0, True)
    tension = damping_law == DampingLaw.TSUJI
    e_s = restitution if restitution_shear is None else restitution_shear
    return ContactLaw(
        k_n=k_n,
        k_s=2.0 / 3.0 * hertz.mindlin_ratio(poisson_ratio) * k_n,
        mu=friction,
        cohesion=cohesion,
        e_n=restitution,
        e_s=e_s,
        zeta_n=collision.zeta_for_restitution(restitution, tension),
        zeta_s=collision.zeta_tension(e_s),
        slip=slip,
        cap=(Cap.TOTAL if "total" in slip.marks else Cap.SPRING) if cap is None else cap,
        tension=tension,
        timing=ContactTiming.AT_STEPS,
        force=ContactForce.HERTZ_MINDLIN,
        youngs_modulus=youngs_modulus,
        poisson_ratio=poisson_ratio,
        unloading=unloading,
        speed=speed,
        adhesion=adhesion,
        adhesion_amount=adhesion_amount,
    )


def stiffness_key(law: ContactLaw) -> str:
    """Key of a case file that makes contacts stiffer: messages name it."""
    elastic = law.force == ContactForce.HERTZ_MINDLIN
    return "contact.youngs_modulus" if elastic else "contact.stiffness"


def hertz_stiffness_of(law: ContactLaw, r: float) -> float:
    """Stiffness K of elastic spheres of a reduced radius [N/m**1.5]."""
    return hertz.hertz_stiffness(hertz.effective_modulus(law.youngs_modulus, law.poisson_ratio), r)


def attraction_of(law: ContactLaw, r: float) -> tuple[float, float]:
    """Attraction of a pair at touch [N], and its increase with the overlap [N/m].

    Parameters
    ----------
    r : reduced radius of the pair [m].
    """
    if law.adhesion == Adhesion.NONE:
        return 0.0, 0.0
    at, beyond = (
        float(evaluate(law.adhesion, amount=law.adhesion_amount, r=r, overlap=x)[0]) for x in (0.0, 1.0)
    )
    return at, beyond - at


def pull_off_of(law: ContactLaw, r: float) -> float:
    """Force that parts a pair at rest [N]; parameters as in `attraction_of`."""
    pull, slope = attraction_of(law, r)
    return pull if slope == 0.0 else adhesion.pull_off_area(slope, hertz_stiffness_of(law, r))


def rest_overlap_of(law: ContactLaw, r: float, load: float = 0.0) -> float:
    """Overlap of a pair at rest under a load [N] and its attraction [m]."""
    pull, slope = attraction_of(law, r)
    if law.force == ContactForce.HERTZ_MINDLIN:
        return adhesion.overlap_at_rest_hertz(load + pull, slope, hertz_stiffness_of(law, r))
    return (load + pull) / law.k_n


def sticking_speed_of(law: ContactLaw, m: float, r: float) -> float:
    """Closing speed up to which a head-on impact of a pair sticks [m/s].

    Parameters
    ----------
    m, r : effective mass [kg] and reduced radius [m] of the pair.
    """
    pull, slope = attraction_of(law, r)
    zeta = damping_ratio_of(law, m)
    if law.force == ContactForce.HERTZ_MINDLIN:
        return adhesion.sticking_speed_hertz(
            pull, slope, m, hertz_stiffness_of(law, r), zeta, law.tension
        )  # fmt: skip
    return adhesion.sticking_speed(pull, m, law.k_n, zeta, law.tension)


def deepest_speed_of(law: ContactLaw, m: float, r: float) -> float:
    """Speed at which elastic spheres without adhesion overlap as far as at the expected one with it [m/s].

    There contacts are stiffest: the step follows from it. Parameters as in `contact_time_of`.
    """
    pull, slope = attraction_of(law, r)
    if pull == 0.0 and slope == 0.0:
        return law.speed
    stiff = hertz_stiffness_of(law, r)
    overlap = adhesion.overlap_max_adhesive_hertz(0.5 * m * law.speed**2, pull, slope, stiff)
    return hertz.speed_for_overlap_hertz(overlap, m, stiff, 0.0)


def damping_ratio_of(law: ContactLaw, m: float) -> float:
    """Damping ratio of the normal motion of a pair of effective mass m [kg]."""
    if law.damping == Damping.RESTITUTION:
        return law.zeta_n
    return collision.damping_ratio(law.eta_n, law.k_n, m)


def contact_time_of(law: ContactLaw, m: float, r: float, speed: float) -> float:
    """Time that the force of an impact lasts [s].

    Parameters
    ----------
    m, r : effective mass [kg] and reduced radius [m] of the pair.
    speed : closing speed at first touch [m/s].
    """
    zeta = damping_ratio_of(law, m)
    if law.force == ContactForce.HERTZ_MINDLIN:
        return hertz.contact_time_hertz(speed, m, hertz_stiffness_of(law, r), zeta, law.tension)
    return collision.contact_time(zeta, collision.omega_natural(law.k_n, m), law.tension)


def shortest_contact_of(law: ContactLaw, m: float, r: float) -> float:
    """Shortest contact of a pair [s], damped or undamped; of elastic spheres at the expected speed.

    Adhesion makes contacts longer, but of elastic spheres deeper and so stiffer: there it is the contact that
    goes as deep without adhesion.

    Parameters
    ----------
    m, r : effective mass [kg] and reduced radius [m] of the lightest pair.
    """
    if law.force == ContactForce.HERTZ_MINDLIN:
        stiff, speed = hertz_stiffness_of(law, r), deepest_speed_of(law, m, r)
        return min(
            hertz.contact_time_hertz(speed, m, stiff, law.zeta_n, law.tension),
            hertz.contact_time_hertz(speed, m, stiff, 0.0, True),
        )
    return collision.shortest_contact(m, law.k_n, damping_ratio_of(law, m), law.tension)


def largest_overlap_of(law: ContactLaw, m: float, r: float, speed: float) -> float:
    """Largest overlap of an impact [m]; parameters as in `contact_time_of`.

    Of elastic spheres with adhesion an estimate from above: the dashpot takes what it takes without adhesion.
    """
    zeta, (pull, slope) = damping_ratio_of(law, m), attraction_of(law, r)
    if law.force == ContactForce.HERTZ_MINDLIN:
        stiff = hertz_stiffness_of(law, r)
        if pull == 0.0 and slope == 0.0:
            return hertz.overlap_max_hertz(speed, m, stiff, zeta)
        damped = hertz.speed_for_overlap_hertz(hertz.overlap_max_hertz(speed, m, stiff, zeta), m, stiff, 0.0)
        return adhesion.overlap_max_adhesive_hertz(0.5 * m * damped**2, pull, slope, stiff)
    if pull == 0.0:
        return collision.overlap_max(speed, m, law.k_n, zeta)
    return adhesion.overlap_max_adhesive(speed, m, law.k_n, zeta, pull)


def step_limits_of(law: ContactLaw, m: float, m_t: float, r: float) -> tuple[float, float]:
    """Largest stable steps [s] of the normal and of the tangential motion in one contact.

    Parameters
    ----------
    m, m_t, r : effective masses in the normal and the tangential direction [kg], reduced radius [m].

    Notes
    -----
    Those of `collision.step_limit`; of elastic spheres at the largest overlap at the expected speed, where
    they are stiffest. There the normal damping ratio is sqrt(5/6) of that of the law.
    """
    k_n, k_s = law.k_n, law.k_s
    eta_s, zeta_n = law.eta_s, damping_ratio_of(law, m)
    if law.force == ContactForce.HERTZ_MINDLIN:
        stiff = hertz_stiffness_of(law, r)
        root = math.sqrt(hertz.overlap_max_hertz(deepest_speed_of(law, m, r), m, stiff, 0.0))
        k_n, k_s = 1.5 * stiff * root, hertz.mindlin_ratio(law.poisson_ratio) * stiff * root
        zeta_n *= math.sqrt(5.0 / 6.0)
    if law.damping == Damping.RESTITUTION:
        eta_s = damping(law.zeta_s, k_s, m_t)
    normal = collision.step_limit(zeta_n, collision.omega_natural(k_n, m))
    if k_s > 0.0:
        zeta_s = (
            law.zeta_s if law.damping == Damping.RESTITUTION else collision.damping_ratio(eta_s, k_s, m_t)
        )
        return normal, collision.step_limit(zeta_s, collision.omega_natural(k_s, m_t))
    return normal, 2.0 * m_t / eta_s if eta_s > 0.0 else math.inf
