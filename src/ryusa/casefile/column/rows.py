"""Rows of `ryusa check` about a column of water: its driver, its bed, and how its grains will move."""

import math

from ryusa.casefile.builders.schema import FlumeSection
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import bed_thickness, bed_top, water_over
from ryusa.casefile.column.packed import packed
from ryusa.casefile.column.schema import CELL, ColumnSection
from ryusa.casefile.column.spin_up import spin_up_rows
from ryusa.casefile.contact.values import friction_at_last
from ryusa.casefile.facts import Derived
from ryusa.casefile.motion import slope_at_last
from ryusa.casefile.row.values import stream, water_alone
from ryusa.casefile.rows import ExplainRow, Flag, number, word
from ryusa.casefile.water.values import hindrance_exponent, terminal_velocity
from ryusa.laws import drag, transport
from ryusa.laws.eddies import eddy_life
from ryusa.model.column import AGREE

THROUGHOUT, NEAR = 0.8, 2.5  # Rouse numbers below which grains fill the depth, and leave the bed for long
SHEET, THICK = 0.5, 1.0  # tau_star from which sheet flow begins, and is fully developed
C_S, ALPHA = 0.3, 0.25  # Egashira's moving layer: concentration, collisional over static pressure


def origin_of_u_star(case: Case) -> str:
    """Formula or key that the friction velocity of a case comes from."""
    wet = case.water
    assert wet is not None
    keys = case.column
    partly = water_over(case) != wet.depth
    if wet.profile == "column" and keys.drive == "tau_star" and partly:
        key = "tau_star" if wet.tau_star is not None else "u_star"
        return f"at the top of the bed, from water.{key} at water.zero"
    if wet.tau_star is not None:
        return "sqrt(tau_star (rho_s/rho_w - 1) g d)"
    if wet.u_star is not None:
        return "water.u_star"
    over = ", h above the bed" if partly else ""
    if keys.drive == "discharge":
        return f"estimate: Eq. (9) with mean speed discharge/h{over}"
    if keys.drive == "pressure gradient":
        return f"sqrt(h (g sin(slope) - (dp/dx)/rho_w)), steady flow{over}"
    return f"sqrt(g h sin(slope)), steady flow{over}"


def regime(
    tau_star: float, d_star: float, rouse: float, layer: float = 0.0, depth: float = math.inf
) -> tuple[str, str]:
    """Name the regime of transport to expect, and the numbers it is inferred from.

    Parameters
    ----------
    tau_star : dimensionless shear stress [-].
    d_star : dimensionless diameter D_* [-].
    rouse : Rouse number [-].
    layer, depth : thickness of the moving layer, and depth of the water over the bed, in grains [-].

    Notes
    -----
    Threshold: Soulsby & Whitehouse 1997. Suspension: Rouse 1937. Sheet flow from tau_star 0.5 to 1 on: Wilson
    1987; Sumer, Kozakiewicz, Fredsoe & Deigaard 1996. Debris flow where the layer fills the depth:
    Egashira, Miyamoto & Itoh 1997.

    >>> regime(0.3, 50.0, 7.6)[0], regime(0.03, 50.0, 24.0)[0], regime(1.1, 55.0, 4.1, 20.0, 6.8)[0]
    ('bed load: rolling and saltation', 'no motion', 'debris flow')
    """
    threshold = transport.tau_star_critical(d_star)
    begins = f"threshold {threshold:.3g}, Soulsby & Whitehouse 1997"
    if tau_star < threshold:
        return (
            "no motion",
            f"tau_star is below its {begins}; on a slope or in a loose bed some grains move even so",
        )
    if layer >= depth:
        thick = "without a limiting thickness" if math.isinf(layer) else f"of {layer:.3g} d"
        why = f"a moving layer {thick} fills the depth of {depth:.3g} d (Egashira, Miyamoto & Itoh 1997)"
        return "debris flow", f"{why}; {begins}"
    if rouse < NEAR:
        where = "throughout the depth" if rouse < THROUGHOUT else "near the bed"
        words, why = f"suspension {where}", f"Rouse number below {THROUGHOUT if rouse < THROUGHOUT else NEAR}"
    else:
        words, why = "bed load: rolling and saltation", f"Rouse number above {NEAR}"
    if tau_star >= (1.0 - AGREE) * THICK:
        words = f"sheet flow with {words}" if rouse < NEAR else "sheet flow"
    elif tau_star >= SHEET:
        words += ", towards sheet flow"
    if tau_star >= SHEET:
        why += f"; sheet flow from tau_star {SHEET:g} to {THICK:g} on, Wilson 1987, Sumer et al. 1996"
    return words, f"{why}; {begins}"


def column_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Rows about the column of a case; none where the water does not respond to the grains."""
    wet = case.water
    if wet is None or wet.profile != "column" or wet.depth is None:
        return []
    if water_alone(case) or stream(case):
        return []
    keys = case.column
    cell = keys.cell or CELL * derived.d
    still = not derived.u_star > 0.0
    rows = [number("water", "depth", wet.depth, "cm", "water.depth, above water.zero")]
    rows += _bed(case, keys)
    if not still:
        rows += _flow(case, derived, keys)
        rows += spin_up_rows(case, derived, keys)
    elif keys.drive != "discharge":
        rows.append(word("water", "driver", "none", "no slope and no pressure gradient: still water"))
    if wet.hindrance == "Richardson-Zaki":
        origin = (
            "water.hindrance_exponent" if wet.hindrance_exponent is not None else "Rowe 1987, from grain Re"
        )
        rows.append(number("water", "hindrance exponent n", hindrance_exponent(case), "-", origin))
    cells = math.ceil(wet.depth / cell - 1e-9)
    coarse = keys.bed == "moving" and cell > derived.d and not still
    origin = f"{cells} in the depth" + ("; thicker than a grain" if coarse else "")
    rows.append(number("water", "cell", cell, "cm", origin, "note" if coarse else ""))
    origin = f"{keys.interval} steps between two exchanges of momentum; fewer where drag is stiff"
    rows.append(number("water", "coupling interval", keys.interval * derived.dt, "s", origin))
    return rows


def _bed(case: Case, keys: ColumnSection) -> list[ExplainRow]:
    """The loose bed, and the depth of water over it."""
    top = bed_top(case)
    if keys.bed != "moving" or math.isnan(top):
        return []
    wet = case.water
    assert wet is not None
    over = water_over(case)
    settled = f"free grains settled to the concentration {packed(case):g} (water.column.packed)"
    if isinstance(case.build, FlumeSection) and case.build.waves:
        settled += f"; mean of {case.build.waves} waves {100.0 * case.build.wave_height:.3g} cm high"
    origin = "water.depth, measured from the top of the bed (water.zero not given)"
    if wet.zero is not None:
        origin = f"water.zero + depth less the top of the bed, z = {100.0 * top:.3g} cm"
    return [
        number("water", "bed thickness", bed_thickness(case), "cm", settled),
        number("water", "water over the bed", over, "cm", origin, "" if over > 0.0 else "note"),
    ]


def _fluctuations(case: Case, derived: Derived, keys: ColumnSection) -> list[ExplainRow]:
    """Turbulent velocity fluctuations, where the case has them."""
    if keys.fluctuations == "none":
        return []
    z = min(derived.d, water_over(case))
    life = eddy_life(derived.u_star / (keys.kappa * z))
    origin = (
        f"rms normal to the bed, {keys.fluctuations}; time scale {life:.2g} s near the bed (2 kappa d/u_star)"
    )
    return [number("water", "fluctuations", derived.u_star, "m/s", origin)]


def _flow(case: Case, derived: Derived, keys: ColumnSection) -> list[ExplainRow]:
    """Numbers of flowing water, and the regime of transport to expect."""
    wet = case.water
    assert wet is not None
    tilted = slope_at_last(case.motion, case.timeline) != derived.slope
    changed: Flag = "note" if tilted else ""
    re = drag.reynolds(derived.u_star, derived.d, wet.viscosity)
    origin = "u_star d/nu" + ("; u_star after the last change of slope in the timeline" if tilted else "")
    rows = [number("water", "Re_star", re, "-", origin, changed)]
    rows += _fluctuations(case, derived, keys)
    settling = terminal_velocity(case)
    if not (0.0 < settling < math.inf) or math.isnan(derived.tau_star):
        return rows
    rouse = transport.rouse_number(settling, derived.u_star, keys.kappa)
    rows.append(number("water", "Rouse number", rouse, "-", "settling velocity over kappa u_star"))
    excess = case.grains.density / wet.density - 1.0
    d_star = transport.d_star(excess, derived.g, derived.d, wet.viscosity)
    repose = math.atan(friction_at_last(case.contact, case.timeline))
    layer = transport.bedload_layer(
        derived.tau_star, slope_at_last(case.motion, case.timeline), repose, C_S, ALPHA
    )
    motion, why = regime(derived.tau_star, d_star, rouse, layer, water_over(case) / derived.d)
    return [*rows, word("water", "expected motion", motion, why)]
