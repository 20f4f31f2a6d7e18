"""A column of water explained back: its driver, what its grains will do in it, its cells."""

import math
from typing import Literal

from ryusa.casefile.column import CELL, Column
from ryusa.casefile.derive import friction_at_last, slope_at_last
from ryusa.casefile.grains import bed_thickness, bed_top, packed, water_over
from ryusa.casefile.rows import Row, row_of
from ryusa.casefile.schema import Case
from ryusa.casefile.water import hindrance_exponent, terminal_velocity
from ryusa.laws import drag, transport
from ryusa.laws.eddies import eddy_life
from ryusa.model.column import AGREE

THROUGHOUT, NEAR = 0.8, 2.5  # Rouse numbers below which grains fill the depth, and leave the bed for long
SHEET, THICK = 0.5, 1.0  # tau_star from which a bed begins to move as a sheet, and surely does
C_S, ALPHA = (
    0.3,
    0.25,
)  # of Egashira's moving layer: concentration, pressure of collisions per static pressure


def origin_of_u_star(case: Case) -> str:
    """Where the friction velocity of a case comes from."""
    wet = case.water
    assert wet is not None
    keys = wet.column or Column()
    if wet.profile == "column" and keys.drive == "tau_star" and water_over(case) != wet.depth:
        key = "tau_star" if wet.tau_star is not None else "u_star"
        return f"what water.{key}, at water.zero, leaves of stress at the top of the bed"
    if wet.tau_star is not None:
        return "sqrt(tau_star (rho_s/rho_w - 1) g d)"
    if wet.u_star is not None:
        return "water.u_star"
    over = ", h over the bed" if water_over(case) != wet.depth else ""
    if keys.drive == "discharge":
        return f"to expect: Eq. (9) with the mean speed discharge/h{over}"
    if keys.drive == "pressure gradient":
        return f"sqrt(h (g sin(slope) - (dp/dx)/rho_w)), steady flow{over}"
    return f"sqrt(g h sin(slope)), steady flow{over}"


def regime(
    tau_star: float, d_star: float, rouse: float, layer: float = 0.0, depth: float = math.inf
) -> tuple[str, str]:
    """How grains will move, in words, and by which numbers.

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
        return "no motion", f"tau_star below its {begins}; on a slope or in a loose bed some still move"
    if layer >= depth:
        thick = "of any thickness" if math.isinf(layer) else f"{layer:.3g} d"
        why = f"the moving layer, {thick}, fills the depth of {depth:.3g} d: Egashira, Miyamoto & Itoh 1997"
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


def column_rows(case: Case) -> list[Row]:
    """Rows about the column of a case; none where its water does not feel the grains."""
    wet, found = case.water, case.derived
    if wet is None or wet.profile != "column" or wet.depth is None:
        return []
    keys = wet.column or Column()
    cell = keys.cell or CELL * found.d
    still = not found.u_star > 0.0
    rows = [row_of("water", "depth", wet.depth, "cm", "water.depth, above water.zero")]
    rows += _bed(case, keys)
    if not still:
        rows += _motion(case, keys)
    elif keys.drive != "discharge":
        rows.append(Row("water", "driver", "none", "", "none", "no slope, no pressure gradient: still water"))
    if wet.hindrance == "Richardson-Zaki":
        given = "water.hindrance_exponent" if wet.hindrance_exponent is not None else "Rowe 1987, by grain Re"
        rows.append(row_of("water", "hindrance exponent n", hindrance_exponent(case), "-", given))
    count = math.ceil(wet.depth / cell - 1e-9)
    coarse = keys.bed == "moving" and cell > found.d and not still
    how = f"{count} in the depth" + ("; thicker than a grain" if coarse else "")
    rows.append(row_of("water", "cell", cell, "cm", how, "note" if coarse else ""))
    time = keys.interval * found.dt
    how = f"{keys.interval} steps between two exchanges, fewer where drag is stiff"
    rows.append(row_of("water", "coupling interval", time, "s", how))
    return rows


def _bed(case: Case, keys: Column) -> list[Row]:
    """The loose bed, and the water over it."""
    if keys.bed != "moving" or math.isnan(bed_top(case)):
        return []
    wet = case.water
    assert wet is not None
    thick, over, top = bed_thickness(case), water_over(case), bed_top(case)
    how = f"free grains once as dense as {packed(case):g} (water.column.packed)"
    given = "water.zero not given: the depth counts from there"
    if wet.zero is not None:
        given = f"water.zero + depth less the top of the bed, z = {100.0 * top:.3g} cm"
    return [
        row_of("water", "bed thickness", thick, "cm", how),
        row_of("water", "water over the bed", over, "cm", given, "" if over > 0.0 else "note"),
    ]


def _eddies(case: Case, keys: Column) -> list[Row]:
    """Turbulent fluctuations, where asked for."""
    if keys.fluctuations == "none":
        return []
    found = case.derived
    z = min(found.d, water_over(case))
    life = eddy_life(found.u_star / (keys.kappa * z))
    how = f"{keys.fluctuations}: rms normal to the bed; near it an eddy lives {life:.2g} s (2 kappa d/u_star)"
    return [row_of("water", "eddies", found.u_star, "m/s", how)]


def _motion(case: Case, keys: Column) -> list[Row]:
    """Numbers of flowing water, and what its grains will do."""
    wet, found = case.water, case.derived
    assert wet is not None
    tilted = slope_at_last(case) != found.slope
    after: Literal["", "note"] = "note" if tilted else ""
    re = drag.reynolds(found.u_star, found.d, wet.viscosity)
    how = "u_star d/nu" + ("; u_star after the last slope of the timeline" if tilted else "")
    rows = [row_of("water", "Re_star", re, "-", how, after)]
    rows += _eddies(case, keys)
    settling = terminal_velocity(case)
    if not (0.0 < settling < math.inf) or math.isnan(found.tau_star):
        return rows
    rouse = transport.rouse_number(settling, found.u_star, keys.kappa)
    rows.append(row_of("water", "Rouse number", rouse, "-", "settling velocity over kappa u_star"))
    d_star = transport.d_star(case.grains.density / wet.density - 1.0, found.g, found.d, wet.viscosity)
    layer = transport.bedload_layer(
        found.tau_star, slope_at_last(case), math.atan(friction_at_last(case)), C_S, ALPHA
    )
    words, why = regime(found.tau_star, d_star, rouse, layer, water_over(case) / found.d)
    return [*rows, Row("water", "expected motion", words, "", words, why)]
