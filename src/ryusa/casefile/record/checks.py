"""[stop], [[timeline]] and [record]: when a run ends, what changes on the way, and what is kept of it."""

from collections.abc import Iterator
from typing import Any

from ryusa.casefile.builders.schema import BuildSection, FromFile, SaltationSection
from ryusa.casefile.builders.values import periodic
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.precision import INDEPENDENT, PrecisionSection, measure_of
from ryusa.casefile.record.schema import StopSection, Timeline
from ryusa.casefile.record.values import begin_of
from ryusa.errors import CaseError

LONG = 5.0e-3  # [s] that no contact of grains lasts
CHANGES = (
    "remove", "slope", "slope_angle", "friction_angle", "friction", "rotation", "move", "discharge", "level",
)  # fmt: skip


def check_stop(stop: StopSection, build: BuildSection) -> Iterator[CaseError]:
    """Find a run without an end, and saltations without a bed."""
    if stop.time is None and stop.saltations is None and stop.rest is None:
        yield CaseError("stop", None, "needs at least one of time, saltations, rest")
    if stop.saltations is not None and not isinstance(build, SaltationSection | FromFile):
        yield CaseError(
            "stop.saltations",
            stop.saltations,
            "needs a bed to saltate over: builder 'saltation', 'table' or 'run'",
        )


def check_timeline(timeline: Timeline, stop: StopSection, data: dict[str, Any]) -> Iterator[CaseError]:
    """Find changes with several keys or none, out of order, or after the end of the run."""
    before, written = 0.0, data.get("timeline", [])
    for k, change in enumerate(timeline):
        key, at = f"timeline.{k}", written[k]["at"]
        present = [name for name in CHANGES if getattr(change, name) is not None]
        if len(present) != 1:
            yield CaseError(
                key, None, f"needs exactly one of {', '.join(CHANGES)} beside at; it has {len(present)}"
            )
        if change.at < before:
            yield CaseError(
                f"{key}.at", at, "is earlier than the change before it; write the timeline in order of time"
            )
        if stop.time is not None and change.at > stop.time:
            yield CaseError(f"{key}.at", at, f"comes after stop.time, {data['stop']['time']}")
        before = max(before, change.at)


def check_record(case: Case, derived: Derived) -> Iterator[CaseError]:
    """Find tracked grains that do not exist, and a settling time beyond the end of the run."""
    record, n_grain = case.record, derived.n_grain
    for k, one in enumerate(record.tracked):
        if one >= n_grain:
            yield CaseError(f"record.tracked.{k}", one, f"must be below {n_grain}, the number of free grains")
    if record.events == "tracked" and not record.tracked:
        yield CaseError("record.tracked", None, "missing; events = 'tracked' needs the numbers of grains")
    if case.stop.time is not None and record.settle >= case.stop.time:
        yield CaseError(
            "record.settle",
            record.settle,
            f"must be shorter than stop.time, {case.stop.time:g} s: the case lets so much time pass before "
            "measures begin; give a shorter one in [record] or with --set record.settle=...",
        )


def check_frames(case: Case, derived: Derived, data: dict[str, Any]) -> Iterator[CaseError]:
    """Find frames closer together than steps, or farther apart than begin and end of the run."""
    interval, end = case.record.frames, case.stop.time
    written = data.get("record", {}).get("frames", f"{interval:g} s")
    if end is not None and interval > end:
        allowed = (
            f"must be at most stop.time, {data['stop']['time']}: the run would keep its first frame alone"
        )
        yield CaseError("record.frames", written, allowed)
    if interval < derived.dt:
        stiffness = "youngs_modulus" if case.contact.youngs_modulus is not None else "stiffness"
        given = data.get("contact", {}).get(stiffness)
        if case.time.step is None and derived.shortest > max(interval, LONG):
            yield CaseError(
                f"contact.{stiffness}", given, f"is so small that the shortest contact lasts "
                f"{derived.shortest:.4g} s and a step {derived.dt:.4g} s, longer than record.frames, "
                f"{interval:g} s: take stiffer contacts (`ryusa check` shows overlaps) or fewer frames",
            )  # fmt: skip
            return
        yield CaseError("record.frames", written, f"must be at least one step, {derived.dt:.4g} s")


def check_precision(case: Case) -> Iterator[CaseError]:
    """Find averages that the run will not have, and a precision without a latest end."""
    precision = case.stop.precision
    if precision is None:
        return
    limits, key, wet = precision.limits(), "stop.precision", case.water
    if not limits:
        yield CaseError(key, None, f"needs one of {', '.join(PrecisionSection.model_fields)}")
        return
    if case.stop.time is None:
        yield CaseError(key, None, "needs stop.time beside it, the latest end of the run")
    elif case.stop.time - begin_of(case) < (INDEPENDENT - 1) * case.record.frames:
        since = f"t = {begin_of(case):g} s (record.settle, or the last change of the timeline)"
        yield CaseError(
            key, None,
            f"needs {INDEPENDENT} frames or more between {since} and stop.time, {case.stop.time:g} s; frames "
            f"are {case.record.frames:g} s apart (record.frames)",
        )  # fmt: skip
    for name, limit in limits.items():
        one = f"{key}.{name}"
        if measure_of(name) == "water":
            if wet is None or wet.profile != "column":
                yield CaseError(one, str(limit), "needs a column of water (water.profile = 'column')")
            elif wet.row is not None:
                yield CaseError(one, str(limit), "needs one column of water, not a row; leave out water.row")
        elif not periodic(case)[0]:
            yield CaseError(one, str(limit), "needs a scene that is periodic along x, such as a flume")
        if name == "q_star" and wet is not None and not case.grains.density > wet.density:
            yield CaseError(one, str(limit), "needs grains that sink; give q instead", "stop.precision.q")
