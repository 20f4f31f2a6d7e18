"""A case explained back: every derived number with its unit and where it comes from."""

import math
from typing import Literal

import numpy as np

from ryusa.casefile import estimate
from ryusa.casefile.builders import Box, Drop, Flume, Packing
from ryusa.casefile.column_rows import column_rows, origin_of_u_star
from ryusa.casefile.derive import MANY, Derived, Pair, events_of, slope_at_last
from ryusa.casefile.films import film_rows
from ryusa.casefile.grains import water_over
from ryusa.casefile.rows import Row, row_of
from ryusa.casefile.schema import Case, StiffnessForOverlap, StiffnessForTime, Water
from ryusa.casefile.table import table_of
from ryusa.casefile.water import terminal_velocity, water_speed
from ryusa.laws import collision, drag, torque, water

BAND = (1.0e-3, 1.0e-2)  # overlap over d of stable and free motion: the paper, fig11
SKIMMING = 0.3  # u t/d beyond which contacts end by geometry, not by Eq. (8)
FAR_APART = 1.5  # ratio of tangential to normal half period from which e_s is not defined
FEWEST_STEPS = 10.0
CLOSE = 0.5  # part of the largest stable step beyond which a step is too close to it
ROUND = 3600.0  # [s]


def explain(case: Case) -> list[Row]:
    """Rows of name, value, unit and origin, in the order a reader wants them."""
    found = case.derived
    return [
        *_grain(case, found),
        *_contact(case, found),
        *_damping(case, found),
        *_step(case, found),
        *_impact(case, found),
        *_water(case, found),
        *_cost(case),
    ]


def warnings(case: Case) -> list[str]:
    """Give one sentence per doubtful number of a case; the run goes on."""
    return [f"{row.name} = {row.shown}: {row.how}" for row in explain(case) if row.flag == "warning"]


def _grain(case: Case, found: Derived) -> list[Row]:
    wet = case.water
    at = "mean diameter" if found.d_max > found.d_min else "diameter"
    rows = [row_of("grains", at, found.d, "cm", "grains.diameter")]
    if found.d_max > found.d_min:
        rows += [
            row_of("grains", "smallest diameter", found.d_min, "cm", "lower end of the sizes"),
            row_of("grains", "largest diameter", found.d_max, "cm", "upper end of the sizes"),
        ]
    rows += [
        Row("grains", "free grains", found.n_grain, "", str(found.n_grain), f"builder '{case.build.kind}'"),
        Row("grains", "fixed grains", found.n_fixed, "", str(found.n_fixed), f"builder '{case.build.kind}'"),
        row_of("grains", "mass m", found.m, "kg", "rho_s A_3 d^3: grains weigh as spheres, in a plane too"),
    ]
    if wet is not None:
        added = f"rho_w C_M A_3 d^3, C_M = {wet.added_mass:g}; in the inertia"
        weight = "(rho_s - rho_w) A_3 d^3: what gravity sees"
        rows += [
            row_of("grains", "added mass", found.m_added, "kg", added),
            row_of("grains", "mass under water", found.m_weight, "kg", weight),
        ]
    inertia = "m d^2/10, never with added mass"
    return [*rows, row_of("grains", "moment of inertia", found.inertia, "kg m2", inertia)]


def _contact(case: Case, found: Derived) -> list[Row]:
    rule, contact = case.contact.stiffness, case.contact
    if isinstance(rule, StiffnessForOverlap):
        how = f"asked: overlap {rule.overlap:g} d at {rule.speed:g} m/s on a fixed grain"
    elif isinstance(rule, StiffnessForTime):
        how = f"asked: Eq. (8) gives {rule.collision_time:g} s on a fixed grain"
    else:
        how = "contact.stiffness"
    shear = (
        "contact.shear_stiffness"
        if contact.shear_stiffness is not None
        else f"{found.k_s / found.k_n:.4g} k_n"
    )
    angle = math.degrees(math.atan(found.mu))
    return [
        row_of("contact", "k_n", found.k_n, "N/cm", how),
        row_of("contact", "k_s", found.k_s, "N/cm", shear),
        row_of("contact", "friction mu", found.mu, "-", f"tan(phi), phi = {angle:.3g} deg"),
    ]


def _damping(case: Case, found: Derived) -> list[Row]:
    asked = not math.isnan(found.e_n)
    rows: list[Row] = []
    for name, pair in (("on fixed", found.fixed), ("between grains", found.free)):
        eta = "2 zeta sqrt(k_n m_eff) for the restitution asked" if asked else "contact.damping, a constant"
        e = (
            f"asked, {case.contact.parting}"
            if asked
            else f"from eta_n and the pair's mass, {case.contact.parting}"
        )
        differ = not asked and abs(found.fixed.e - found.free.e) > 0.02
        rows += [
            row_of("damping", f"eta_n {name}", pair.eta_n, "N s/cm", eta),
            row_of(
                "damping",
                f"eta_s {name}",
                pair.eta_s,
                "N s/cm",
                "2 zeta_s sqrt(k_s m_t)" if asked else "a constant",
            ),
            row_of("damping", f"restitution e {name}", pair.e, "-", e, "note" if differ else ""),
        ]
    rows += _shear(case, "on fixed", found.fixed)
    if found.meet:
        rows += _shear(case, "between grains", found.free)
    return rows


def _shear(case: Case, name: str, pair: Pair) -> list[Row]:
    if math.isinf(pair.t_shear):
        none = "k_s = 0: no tangential spring"
        return [Row("damping", f"tangential half period {name}", "none", "", "none", none)]
    ratio = pair.t_shear / pair.t_undamped
    locked = "locked" if case.motion.rotation == "locked" else "free"
    how = f"{ratio:.3g} normal half periods, rotation {locked}"
    flag: Literal["", "note"] = ""
    if not 1.0 / FAR_APART <= ratio <= FAR_APART:
        how += "; a tangential restitution is not defined there"
        flag = "note"
    return [row_of("damping", f"tangential half period {name}", pair.t_shear, "s", how, flag)]


def _step(case: Case, found: Derived) -> list[Row]:
    rows: list[Row] = []
    for name, pair in (("on fixed", found.fixed), ("between grains", found.free)):
        rows += [
            row_of("time", f"collision time {name}", pair.t_undamped, "s", "Eq. (8), added mass, no dashpot"),
            row_of("time", f"contact time {name}", pair.t_col, "s", f"damped, {case.contact.parting}"),
        ]
    who = "two free grains" if found.meet else "a grain on a fixed one"
    size = "smallest" if found.d_max > found.d_min else "such"
    given = (
        "time.step" if case.time.step is not None else f"shortest contact over {found.steps_per_contact:.4g}"
    )
    few = found.steps_per_contact < FEWEST_STEPS
    advice = "; fewer than the ten that the paper asks for: restitution will be off" if few else ""
    which = "tangential" if found.step_limit_shear == found.step_limit else "normal"
    close = found.dt > CLOSE * found.step_limit
    limit = f"{which} motion in one contact; dt is {found.dt / found.step_limit:.2g} of it"
    limit += ", and grains in several contacts need less" if close else ""
    return [
        *rows,
        row_of("time", "shortest contact", found.shortest, "s", f"{who}, {size} grains"),
        row_of("time", "largest stable step", found.step_limit, "s", limit, "warning" if close else ""),
        row_of("time", "dt", found.dt, "s", given),
        row_of(
            "time",
            "steps per contact",
            found.steps_per_contact,
            "-",
            f"shortest contact over dt{advice}",
            "warning" if few else "",
        ),
    ]


def expected_speed(case: Case) -> tuple[float, str]:
    """Impact speed to judge the overlap by [m/s], and where it comes from."""
    rule, build, found = case.contact.stiffness, case.build, case.derived
    if isinstance(rule, StiffnessForOverlap):
        return rule.speed, "contact.stiffness.speed"
    settling = terminal_velocity(case)
    if isinstance(build, Drop):
        height = build.height or 0.0
        fall = math.sqrt(
            build.speed**2 + 2.0 * found.g * height * (found.m_weight / (found.m + found.m_added))
        )
        if math.isfinite(settling) and settling < fall:
            return max(settling, build.speed), "settling velocity, reached before the drop speed"
        return fall, "speed of the drop, no drag"
    if isinstance(build, Box) and (fall := build.height + build.layers * build.gap * found.d_max) > found.d:
        fastest = math.sqrt(2.0 * found.g * fall * (found.m_weight / (found.m + found.m_added)))
        return min(fastest, settling), "fall of the top layer through the free room below it"
    if isinstance(build, Packing | Flume | Box):
        return math.sqrt(2.0 * found.g * found.d), "fall through one diameter, sqrt(2 g d)"
    if math.isfinite(settling):
        return settling, "settling velocity; a saltating grain mostly hits more slowly"
    return math.sqrt(2.0 * found.g * found.d), "fall through one diameter, sqrt(2 g d)"


def _impact(case: Case, found: Derived) -> list[Row]:
    speed, origin = expected_speed(case)
    rows = [row_of("impact", "expected impact speed", speed, "m/s", origin)]
    overlap = collision.overlap_max(speed, found.fixed.m, found.k_n, found.fixed.zeta_n) / found.d
    low, high = BAND
    flag: Literal["", "note", "warning"] = "warning" if overlap > high else "note" if overlap < low else ""
    verdict = (
        "above the stable band"
        if overlap > high
        else "below the band"
        if overlap < low
        else "in the stable band"
    )
    advice = "; stiffen k_n" if overlap > high else "; k_n could be softer" if overlap < low else ""
    how = f"on a fixed grain: {verdict} 0.001-0.01{advice}"
    rows.append(row_of("impact", "largest overlap/d", overlap, "-", how, flag))
    if isinstance(case.build, Packing | Flume | Box):
        weight = case.build.layers * found.m_weight * found.g * math.cos(found.slope)
        rest = weight / (found.k_n * found.d)
        deep: Literal["", "warning"] = "warning" if rest > high else ""
        how = f"{case.build.layers:g} layers stacked in a column"
        rows.append(row_of("impact", "overlap/d at rest", rest, "-", how, deep))
    along, where = _speed_along(case, found)
    if along > 0.0:
        travel = along * found.fixed.t_col / found.d
        skims = travel > SKIMMING
        how = f"travel within one contact at {along:.3g} m/s ({where})"
        how += f"; beyond {SKIMMING:g} contacts end by geometry, not by Eq. (8)" if skims else ""
        rows.append(row_of("impact", "u t/d", travel, "-", how, "warning" if skims else ""))
    return rows


def _speed_along(case: Case, found: Derived) -> tuple[float, str]:
    if isinstance(case.build, Drop):
        return abs(case.build.speed_along), "build.speed_along"
    if case.water is not None and case.water.profile != "still":
        return abs(water_speed(case, 1.25 * found.d)), "water one diameter above the crest"
    return math.sqrt(found.g * found.d), "sqrt(g d)"


def _water(case: Case, found: Derived) -> list[Row]:
    wet = case.water
    if wet is None:
        return []
    rows: list[Row] = []
    if found.u_star > 0.0:
        rows.append(row_of("water", "u_star", found.u_star, "m/s", origin_of_u_star(case)))
        if not math.isnan(found.tau_star):
            rows.append(row_of("water", "tau_star", found.tau_star, "-", "u_star^2/((rho_s/rho_w - 1) g d)"))
        depth = water_over(case)
        if depth > 0.0 and (tilt := slope_at_last(case)) > 0.0:
            implied = water.u_star_from_slope(depth, tilt, found.g)
            apart = abs(implied / found.u_star - 1.0) > 0.1
            how, flag = "sqrt(g h sin(slope)), to compare", "note" if apart else ""
            if implied != found.u_star:
                rows.append(row_of("water", "u_star of slope and depth", implied, "m/s", how, flag))
        rough = found.u_star * found.k_rough / wet.viscosity
        rows.append(row_of("water", "roughness Re", rough, "-", "u_star k_rough/nu; rough above 70"))
    settling = terminal_velocity(case)
    if math.isfinite(settling):
        rows += [
            row_of("water", "settling velocity", settling, "m/s", f"drag {wet.drag}"),
            row_of(
                "water",
                "grain Re",
                drag.reynolds(settling, found.d, wet.viscosity),
                "-",
                "settling velocity times d/nu",
            ),
        ]
    return [*rows, *film_rows(case), *column_rows(case), *_spin(case, found, wet)]


def _spin(case: Case, found: Derived, wet: Water) -> list[Row]:
    spin, d = abs(case.build.spin) if isinstance(case.build, Drop) else 0.0, found.d
    if (grid := table_of(case)) is not None:
        spins, sizes = np.abs(grid.column("wy")), grid.column("d")
        if not case.motion.plane:
            spins = np.sqrt(spins**2 + grid.column("wx") ** 2 + grid.column("wz") ** 2)
        fastest = int(np.argmax(np.where(grid.fixed, 0.0, spins * sizes**2)))
        spin, d = float(spins[fastest]), float(sizes[fastest])
    if wet.torque == "none" or spin == 0.0:
        return []
    beyond = wet.torque == "Dennis" and not torque.torque_in_range(spin, d, wet.viscosity)
    how = f"d^2 spin/nu of the first spin, {spin:.4g} rad/s"
    how += "; torque Dennis is fitted up to 4000 only" if beyond else ""
    re_r = torque.reynolds_spin(spin, d, wet.viscosity)
    return [row_of("water", "rotational Re", re_r, "-", how, "warning" if beyond else "")]


def _cost(case: Case) -> list[Row]:
    simulated, origin = estimate.time_expected(case)
    steps, frames = estimate.steps_expected(case), estimate.frames_expected(case)
    seconds, disk = estimate.seconds_needed(case), estimate.disk_needed(case)
    memory, each = estimate.memory_needed(case), estimate.memory_per_grain(case)
    wall = f"{seconds / ROUND:.3g} h" if seconds > ROUND else f"{seconds:.3g} s"
    return [
        row_of("cost", "simulated time", simulated, "s", origin),
        Row("cost", "steps", steps, "", f"{steps:,}", "simulated time over dt"),
        Row("cost", "frames", frames, "", f"{frames:,}", f"one every {case.record.frames:g} s"),
        Row("cost", "disk for frames", disk, "B", human(disk), "positions, velocities and spins"),
        *_events(case),
        *_disk(case),
        Row(
            "cost",
            "memory",
            memory,
            "B",
            human(memory),
            f"{each} B a grain, events {events_of(case)}; frames that wait; the rest 250 MB",
        ),
        Row("cost", "wall time", seconds, "s", wall, "rule of thumb, one core"),
    ]


def _events(case: Case) -> list[Row]:
    kept, asked = events_of(case), case.record.events
    origin = "record.events"
    if asked is None:
        origin = f"all up to {MANY} free grains, or where saltations end the run; record.events not given"
    rows = [Row("cost", "contacts recorded", kept, "", kept, origin, "" if asked else "note")]
    if kept != "none":
        n_row, size = estimate.events_expected(case), estimate.disk_for_events(case)
        how = f"about {n_row:,} contacts, rule of thumb"
        rows.append(Row("cost", "disk for events", size, "B", human(size), how))
    return rows


def _disk(case: Case) -> list[Row]:
    """What the run needs against what is free, where it does not fit."""
    needed, free = estimate.disk_in_all(case), estimate.free_here()
    if needed <= free:
        return []
    how = f"frames and events, but only {human(free)} are free in this folder: run will refuse here"
    return [Row("cost", "disk in all", needed, "B", human(needed), how, "warning")]


def human(size: float) -> str:
    """Bytes as a person writes them.

    >>> human(2_500_000)
    '2.5 MB'
    """
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
