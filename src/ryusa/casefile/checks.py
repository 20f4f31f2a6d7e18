"""Checks that need more than one key: two ways of one thing, what is missing, what contradicts."""

import math
from collections.abc import Iterator
from typing import Any

from ryusa.casefile.box import hole
from ryusa.casefile.builders import Box, Drop, Flume, Packing, Saltation, Table
from ryusa.casefile.column_checks import check_column
from ryusa.casefile.derive import may_spin
from ryusa.casefile.films import check_film_step, check_films
from ryusa.casefile.grains import flume_count, periodic, sizes
from ryusa.casefile.schema import Case, Spread
from ryusa.casefile.water import check_drag_step
from ryusa.errors import CaseError

RIVALS: dict[str, tuple[tuple[str, str], ...]] = {
    "contact": (
        ("friction_angle", "friction"),
        ("shear_ratio", "shear_stiffness"),
        ("restitution", "damping"),
        ("restitution", "shear_damping"),
        ("restitution_shear", "damping"),
        ("restitution_shear", "shear_damping"),
    ),
    "motion": (("slope", "slope_angle"),),
    "water": (("tau_star", "u_star"),),
    "time": (("steps_per_contact", "step"),),
}
MOST_GRAINS = 20_000_000
FEWEST_PERIODS = 3  # largest diameters that a period must hold
COARSEST, FINEST = 5.0, 1.0e4  # steps per contact that a given step must lie between
_CHANGES = ("remove", "slope", "slope_angle", "friction_angle", "friction", "rotation")


def check(case: Case, data: dict[str, Any]) -> list[CaseError]:
    """Find the faults that no single key shows; `data` is what the file held."""
    found = [*_rivals(case), *_needed(case), *_water(case), *check_column(case), *check_films(case)]
    found += [*_motion(case), *_builder(case), *_timeline(case, data)]
    if found:
        return found
    found = [*_numbers(case)]
    if found:
        return found
    step = [*_step(case, data), *check_film_step(case), *check_drag_step(case)]
    return [*_space(case), *step, *([] if step else _frames(case, data)), *_record(case)]


def _given(section: Any, key: str) -> bool:
    return key in section.model_fields_set and getattr(section, key) is not None


def _rivals(case: Case) -> Iterator[CaseError]:
    for name, pairs in RIVALS.items():
        section = getattr(case, name)
        for one, other in pairs if section is not None else ():
            if _given(section, one) and _given(section, other):
                yield CaseError(
                    f"{name}.{one}", None, f"given together with {name}.{other}; say it one way only"
                )


def _needed(case: Case) -> Iterator[CaseError]:
    contact = case.contact
    if contact.friction is None and contact.friction_angle is None:
        yield CaseError(
            "contact.friction_angle",
            None,
            "missing; give friction_angle or friction, for it decides most things",
        )
    if contact.restitution is None and contact.damping is None:
        yield CaseError("contact.restitution", None, "missing; give restitution (or damping, a constant)")
    if contact.slip == "total" and contact.cap == "spring":
        yield CaseError("contact.cap", "spring", "must be 'total' (or left out) when slip is 'total'")
    if case.stop.time is None and case.stop.saltations is None and case.stop.rest is None:
        yield CaseError("stop", None, "needs at least one of time, saltations, rest")


def _water(case: Case) -> Iterator[CaseError]:
    water = case.water
    if water is None:
        return
    shear = water.tau_star is not None or water.u_star is not None
    logarithmic = water.profile.startswith("log")
    if logarithmic and not shear:
        yield CaseError(
            "water.tau_star", None, f"missing; profile '{water.profile}' needs tau_star or u_star"
        )
    if not (logarithmic or water.profile == "column") and shear:
        key = "tau_star" if water.tau_star is not None else "u_star"
        yield CaseError(f"water.{key}", getattr(water, key), f"has no meaning with profile '{water.profile}'")
    if (water.speed is not None) != (water.profile == "uniform"):
        if water.speed is None:
            yield CaseError("water.speed", None, "missing; profile 'uniform' needs it")
        else:
            yield CaseError("water.speed", water.speed, f"has no meaning with profile '{water.profile}'")
    if water.roughness is not None and water.profile not in {"log rough", "column"}:
        yield CaseError("water.roughness", water.roughness, f"has no meaning with profile '{water.profile}'")
    if water.tau_star is not None and case.grains.density <= water.density:
        yield CaseError(
            "water.tau_star", water.tau_star, "needs grains denser than water; give u_star instead"
        )
    if _given(water, "drag_coefficient") and water.drag != "constant":
        yield CaseError(
            "water.drag_coefficient", water.drag_coefficient, f"has no meaning with drag '{water.drag}'"
        )
    if water.above != "continue" and water.depth is None and water.profile != "column":
        yield CaseError("water.depth", None, f"missing; above = '{water.above}' needs it")
    if water.torque != "none" and not may_spin(case):
        yield CaseError("water.torque", water.torque, "needs motion.rotation = 'free'")


def _motion(case: Case) -> Iterator[CaseError]:
    rolling = case.rolling
    if rolling.model != "none":
        if not may_spin(case):
            yield CaseError("rolling.model", rolling.model, "needs motion.rotation = 'free'")
        if rolling.coefficient == 0.0:
            yield CaseError("rolling.coefficient", None, f"missing or zero; model '{rolling.model}' needs it")
    elif rolling.coefficient > 0.0:
        yield CaseError(
            "rolling.coefficient", rolling.coefficient, "has no meaning with rolling.model 'none'"
        )
    if rolling.model == "spring-dashpot-slider" and rolling.arm == "contact width":
        yield CaseError("rolling.arm", rolling.arm, "must be 'reduced radius' for the spring-dashpot-slider")
    if case.motion.slab_width is not None and not case.motion.plane:
        yield CaseError(
            "motion.slab_width", case.motion.slab_width, "has no meaning unless motion.plane = true"
        )
    yield from _planes(case)


def _planes(case: Case) -> Iterator[CaseError]:
    period = dict(zip("xy", periodic(case), strict=True))
    opened = "; build.periodic = false opens it" if isinstance(case.build, Packing) else ""
    for number, plane in enumerate(case.planes):
        key, normal = f"planes.{number}.normal", list(plane.normal)
        if not any(normal):
            yield CaseError(key, normal, "must not be zero")
        elif case.motion.plane and normal[1] != 0.0:
            yield CaseError(key, normal, "must have y = 0 in a plane scene")
        for axis, one in enumerate(period):
            if period[one] and normal[axis] != 0.0:
                yield CaseError(key, normal, f"must have {one} = 0, for {one} is periodic{opened}")
    names = [plane.name for plane in case.planes]
    for number, name in enumerate(names):
        if name in names[:number]:
            yield CaseError(f"planes.{number}.name", name, "is used twice")


def _builder(case: Case) -> Iterator[CaseError]:
    build = case.build
    spread = case.grains.spread
    ratio = spread.ratio if isinstance(spread, Spread) else spread
    if isinstance(build, (Drop, Saltation)) and ratio > 0.0:
        yield CaseError("grains.spread", ratio, f"must be 0 for builder '{build.kind}'")
    if isinstance(build, Drop):
        if build.height is None and build.speed == 0.0:
            yield CaseError("build.height", None, "missing; a drop needs height or speed")
        if build.spin != 0.0 and not may_spin(case):
            yield CaseError("build.spin", build.spin, "needs motion.rotation = 'free'")
        if abs(build.offset) >= case.grains.diameter:
            yield CaseError(
                "build.offset", build.offset, "must be smaller than the diameter, or nothing is struck"
            )
        if build.offset != 0.0 and build.partner == "plane":
            yield CaseError("build.offset", build.offset, "has no meaning with partner 'plane'")
    if isinstance(build, (Drop, Saltation)) and not case.motion.plane:
        lanes = build.copies if isinstance(build, Drop) else build.starts
        if lanes > 1:
            key = "build.copies" if isinstance(build, Drop) else "build.starts"
            yield CaseError(key, lanes, "needs motion.plane = true; in three dimensions lanes could meet")
    if isinstance(build, Packing | Box) and case.motion.plane and build.rows > 1:
        yield CaseError("build.rows", build.rows, "must be 1 in a plane scene")
    if isinstance(build, Packing | Box) and periodic(case)[1] and build.rows < FEWEST_PERIODS:
        yield CaseError("build.rows", build.rows, f"must be at least {FEWEST_PERIODS} where y is periodic")
    if isinstance(build, Flume):
        yield from _flume(case, build)
    if isinstance(build, Box):
        yield from _box(case, build)
    if case.stop.saltations is not None and not isinstance(build, (Saltation, Table)):
        yield CaseError(
            "stop.saltations",
            case.stop.saltations,
            "needs a bed to saltate over: builder 'saltation' or 'table'",
        )


def _flume(case: Case, build: Flume) -> Iterator[CaseError]:
    plane, (_, across), (_, _, largest) = case.motion.plane, periodic(case), sizes(case)
    if plane and build.width is not None:
        yield CaseError("build.width", build.width, "has no meaning in a plane scene; motion.slab_width has")
    if not plane and build.width is None:
        yield CaseError("build.width", None, "missing; a flume in three dimensions needs its width")
    for key, value, least in (
        ("length", build.length, FEWEST_PERIODS * largest),
        ("width", build.width, FEWEST_PERIODS * largest if across else largest),
    ):
        if value is not None and value < least:
            yield CaseError(f"build.{key}", value, f"must be at least {least:.4g} m for grains of this size")
    if flume_count(case) < 1:
        yield CaseError("build.layers", build.layers, "gives no grain; more layers or a longer flume")


def _box(case: Case, build: Box) -> Iterator[CaseError]:
    if build.floor == "plane":
        for key in ("run_out", "drop", "floor_height"):
            value = getattr(build, key)
            if value is not None and (key == "drop" or value > 0.0):
                yield CaseError(
                    f"build.{key}", value, "has no meaning with floor 'plane', which is flat and never ends"
                )
    d, d_min, _ = sizes(case)
    if d_min <= (free := hole(build, case.motion.plane)) * d:
        yield CaseError(
            "grains.spread",
            None,
            f"the smallest grain, {d_min:.3g} m, slips through fixed grains of mean diameter: through up to "
            f"{free:.2g} d; take less spread (or floor_height), or build.floor = 'plane', walls = 'planes'",
        )
    caught = build.drop is not None or any(plane.normal[2] > 0.0 for plane in case.planes)
    for number, change in enumerate(case.timeline):
        ends = build.floor == "grains" and (
            change.remove == "back" or (change.remove == "gate" and build.run_out == 0.0)
        )
        if not caught and (ends or change.remove == "floor"):
            ways = ["build.run_out makes it longer"] if change.remove == "gate" else []
            ways += ["build.drop catches them"] if build.floor == "grains" else []
            ways += ["build.floor = 'plane' never ends"] if ends else []
            yield CaseError(
                f"timeline.{number}.remove",
                change.remove,
                "lets grains fall out of the world, for no floor is there; "
                + ", ".join([*ways, "a plane of [[planes]] catches them"]),
            )


def _timeline(case: Case, data: dict[str, Any]) -> Iterator[CaseError]:
    before, said = 0.0, data.get("timeline", [])
    for number, change in enumerate(case.timeline):
        key, at = f"timeline.{number}", said[number]["at"]
        given = [name for name in _CHANGES if getattr(change, name) is not None]
        if len(given) != 1:
            yield CaseError(
                key, None, f"needs exactly one of {', '.join(_CHANGES)} beside at; it has {len(given)}"
            )
        if change.at < before:
            yield CaseError(
                f"{key}.at", at, "comes before the entry above it; write the timeline in order of time"
            )
        if case.stop.time is not None and change.at > case.stop.time:
            yield CaseError(f"{key}.at", at, f"comes after stop.time, {data['stop']['time']}")
        before = max(before, change.at)


def _numbers(case: Case) -> Iterator[CaseError]:
    derived = case.derived
    count = derived.n_grain + derived.n_fixed
    if count > MOST_GRAINS:
        yield CaseError("build", None, f"asks for {count:,} grains; at most {MOST_GRAINS:,}")
    for name in ("m", "inertia", "k_n", "shortest", "dt"):
        value = getattr(derived, name)
        if not (0.0 < value < math.inf):
            yield CaseError("case", None, f"its numbers are out of range: {name} = {value:g}")


def _space(case: Case) -> Iterator[CaseError]:
    largest = case.derived.d_max
    for key in ("period_x", "period_y"):
        period = getattr(case.domain, key)
        if period is not None and period < FEWEST_PERIODS * largest:
            yield CaseError(
                f"domain.{key}",
                period,
                f"must be at least {FEWEST_PERIODS} largest diameters, {3 * largest:.4g} m",
            )
        if period is not None and not isinstance(case.build, Table):
            yield CaseError(
                f"domain.{key}",
                period,
                f"is set by builder '{case.build.kind}' itself; only 'table' takes it",
            )
    if case.motion.plane and case.domain.period_y is not None:
        yield CaseError("domain.period_y", case.domain.period_y, "has no meaning in a plane scene")
    low, high = case.domain.low, case.domain.high
    if low is not None and high is not None and any(a >= b for a, b in zip(low, high, strict=True)):
        yield CaseError("domain.low", list(low), "must lie below domain.high in every direction")


def _step(case: Case, data: dict[str, Any]) -> Iterator[CaseError]:
    found = case.derived
    if found.dt > found.step_limit:
        key = "steps_per_contact" if case.time.step is None else "step"
        which = "tangential" if found.step_limit_shear == found.step_limit else "normal"
        softer = "contact.shear_ratio" if which == "tangential" else "contact.stiffness"
        yield CaseError(
            f"time.{key}",
            data.get("time", {}).get(key),
            f"dt = {found.dt:.3g} s is beyond {found.step_limit:.3g} s, from where on the {which} motion "
            f"in a contact grows without end; take a shorter step, a smaller {softer} or less damping",
        )
    if case.time.step is None:
        return
    t_col, steps = case.derived.shortest, case.derived.steps_per_contact
    written = data.get("time", {}).get("step")
    if steps < COARSEST:
        yield CaseError(
            "time.step",
            written,
            f"must be below {t_col / COARSEST:.3g} s, a fifth of the shortest contact {t_col:.3g} s",
        )
    if steps > FINEST:
        yield CaseError(
            "time.step",
            written,
            f"must be above {t_col / FINEST:.3g} s, 1e-4 of the shortest contact {t_col:.3g} s",
        )


def _frames(case: Case, data: dict[str, Any]) -> Iterator[CaseError]:
    interval, dt = case.record.frames, case.derived.dt
    if interval < dt:
        written = data.get("record", {}).get("frames", f"{interval:g} s")
        yield CaseError("record.frames", written, f"must be at least one step, {dt:.4g} s")


def _record(case: Case) -> Iterator[CaseError]:
    record, n_grain = case.record, case.derived.n_grain
    for number, one in enumerate(record.tracked):
        if one >= n_grain:
            yield CaseError(
                f"record.tracked.{number}", one, f"must be below {n_grain}, the number of free grains"
            )
    if record.events == "tracked" and not record.tracked:
        yield CaseError("record.tracked", None, "missing; events = 'tracked' needs ids of grains")
    if case.stop.time is not None and record.settle >= case.stop.time:
        yield CaseError("record.settle", record.settle, "must be shorter than stop.time")
