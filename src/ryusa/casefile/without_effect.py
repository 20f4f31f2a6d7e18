"""Keys that a case gives and that cannot act in it: those that would mislead are faults, the rest is said.

A key that no choice of a law takes is found in `choices`, one that its own section excludes in that section.
Here is what only several sections together show. What is neither refused nor said has an effect:
tests/casefile/test_keys_without_effect.py goes through the whole schema.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from ryusa.casefile.builders.schema import (
    BuildSection,
    DropSection,
    EmptySection,
    FillSection,
    FlumeSection,
    PackingSection,
    RunSection,
    StreamSection,
    TableSection,
)
from ryusa.casefile.builders.table import table_of
from ryusa.casefile.builders.values import counts, drawn_materials, fill_count
from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import restitution, stiffness
from ryusa.casefile.feeds.schema import FeedSection
from ryusa.casefile.grains.schema import spread_of
from ryusa.casefile.grains.values import has_own_sizes, laid_shares
from ryusa.casefile.materials.values import GRAINS, OF_PAIRS, SAID_ALSO, meeting
from ryusa.casefile.motion import MotionSection, slope
from ryusa.casefile.record.schema import Timeline
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.ends import hydrograph_points
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.section import Section, given
from ryusa.casefile.shape import has_clumps, spheres_of
from ryusa.casefile.walls.schema import WallSection
from ryusa.casefile.water.schema import WaterSection
from ryusa.errors import CaseError
from ryusa.laws.families import Drag, Lift

Found = Iterator[CaseError]

# What acts where water flows and no grain ever is: keys, with all below them.
_OF_WATER = (
    "schema", "title", "grains.diameter", "motion.slope", "motion.slope_angle", "motion.gravity", "timeline",
    "water.profile", "water.depth", "water.density", "water.viscosity", "water.temperature",
    "water.roughness", "water.buoyancy", "water.column", "water.row", "build.kind", "time.step", "stop.time",
    "record.frames", "record.settle",
)  # fmt: skip
_TANGENTIAL = (
    "contact.shear_ratio", "contact.shear_stiffness", "contact.restitution_shear", "contact.shear_damping",
    "contact.friction", "contact.friction_angle", "contact.cohesion", "contact.slip", "contact.cap",
    "rolling.model",
)  # fmt: skip


def check_without_effect(case: Case) -> Found:
    """Find keys that cannot act, where who wrote them would think that they do."""
    yield from _builder(case.build, case.motion)
    yield from _walls(case.walls, case.timeline)
    yield from _traffic(case.feeds)
    if water_alone(case):
        for k, plane in enumerate(case.planes):
            text = "has no effect on water, and there are no grains; what stands in it is [[water.row.dams]]"
            yield CaseError(f"planes.{k}", plane.name, text)
    else:
        yield from _grains(case)
        yield from _motion(case.motion, case.timeline)
        yield from _water(case.water)
        yield from _record(case)


def _builder(build: BuildSection, motion: MotionSection) -> Found:
    if isinstance(build, FlumeSection) and motion.plane and given(build, "walls"):
        text = "has no effect in a plane scene, which has no side walls"
        yield CaseError("build.walls", build.walls, text)
    if isinstance(build, DropSection) and build.copies == 1 and given(build, "height_step"):
        text = "has no effect on a single drop; it is between one of build.copies and the next"
        yield CaseError("build.height_step", build.height_step, text)
    if isinstance(build, TableSection) and build.format in {"csv", "vtu"} and given(build, "mass_unit"):
        text = f"has no effect with format '{build.format}', only with lammps-dump, lammps-data, xyz"
        yield CaseError("build.mass_unit", build.mass_unit, text)


def _walls(walls: tuple[WallSection, ...], timeline: Timeline) -> Found:
    moved: list[tuple[str, Any]] = [(f"walls.{k}", wall) for k, wall in enumerate(walls)]
    moved += [(f"timeline.{k}.move", one.move) for k, one in enumerate(timeline) if one.move is not None]
    for key, one in moved:
        if given(one, "phase") and one.amplitude is None and one.frequency is None:
            text = "has no effect without an oscillation: amplitude and frequency"
            yield CaseError(f"{key}.phase", one.phase, text)


def _traffic(feeds: tuple[FeedSection, ...]) -> Found:
    for k, feed in enumerate(feeds):
        key = f"feeds.{k}"
        if feed.low is not None and given(feed, "normal"):
            yield CaseError(f"{key}.normal", list(feed.normal), "has no effect in a box; it is for a disc")
        if feed.brings:
            continue
        for name in ("begin", "end", "total", "material"):
            if given(feed, name):
                shown = None if name == "total" else getattr(feed, name)
                text = "has no effect without a rate: grains that an exit sends here stay as they are, and "
                yield CaseError(f"{key}.{name}", shown, f"{text}come in as they arrive")


def _grains(case: Case) -> Found:
    grains = case.grains
    if GRAINS in grains.mixture:
        text = "is the material of the rest of the grains: leave it out, and give the shares of others"
        yield CaseError(f"grains.mixture.{GRAINS}", grains.mixture[GRAINS], text)
    elif grains.mixture and table_of(case) is None and not laid_shares(case.grains, case.build):
        text = f"has no effect: builder '{case.build.kind}' lays no grain here; give feeds a material"
        yield CaseError("grains.mixture", None, text)
    if grains.bed_material is not None and not _sets_a_bed(case):
        text = f"has no effect: builder '{case.build.kind}' sets nothing beside the free grains here; planes "
        yield CaseError("grains.bed_material", grains.bed_material, f"{text}and walls have a material each")


def _draws_sizes_of_grains(case: Case) -> bool:
    """Whether some grain has the distribution of [grains], or that of a material which takes it over."""
    for name in drawn_materials(case):
        if name is None or not has_own_sizes(case.materials, name):
            return True
        own = case.materials[name]
        if own.sieve_curve is None and own.spread is None:
            return True
    return False


def _sets_a_bed(case: Case) -> bool:
    """Whether a builder sets fixed grains, a floor or walls of its own."""
    build = case.build
    if isinstance(build, DropSection):
        return build.partner != "free"
    if isinstance(build, EmptySection | FillSection):
        return build.plate is not None
    if isinstance(build, TableSection | RunSection):
        table = table_of(case)
        return table is not None and (bool(table.fixed.any()) or bool(table.planes))
    return True


def _of_materials(case: Case) -> Iterator[str]:
    """Values of materials that no contact takes: each of its pairs says its own."""
    if not case.materials or case.contact.restitution is None:
        return
    pairs = meeting(case)
    said = {frozenset(one.materials): one for one in case.pairs}
    for name, one in case.materials.items():
        touched = [pair for pair in pairs if name in pair]
        if not touched or (name, name) in pairs:
            continue
        entries = [said.get(frozenset(pair)) for pair in touched]
        for key in OF_PAIRS:
            keys = SAID_ALSO.get(key, (key,))
            own = [key for key in keys if given(one, key)]
            if own and all(entry is not None and any(given(entry, key) for key in keys) for entry in entries):
                with_it = ", ".join(b if a == name else a for a, b in touched)
                yield (
                    f"materials.{name}.{own[0]} has no effect: two of {name} never touch, and [[pairs]] "
                    f"gives it with {with_it}"
                )


def _motion(motion: MotionSection, timeline: Timeline) -> Found:
    if motion.gravity == 0.0:
        for key in ("slope", "slope_angle"):
            value = getattr(motion, key)
            if value is not None and value != 0.0:
                yield CaseError(f"motion.{key}", value, "has no effect without gravity: motion.gravity is 0")
            for k, one in enumerate(timeline):
                if getattr(one, key) is not None:
                    text = "has no effect without gravity: motion.gravity is 0"
                    yield CaseError(f"timeline.{k}.{key}", getattr(one, key), text)


def _water(water: WaterSection | None) -> Found:
    wet = water
    if wet is None:
        return
    if given(wet, "shape_area") and Drag.of(wet.drag) is Drag.NONE and Lift.of(wet.lift) is Lift.NONE:
        yield CaseError("water.shape_area", wet.shape_area, f"has no effect with drag '{wet.drag}'")
    if given(wet, "zero") and wet.profile in {"uniform", "still"} and wet.depth is None:
        text = f"has no effect with profile '{wet.profile}' and no water.depth, which is measured from it"
        yield CaseError("water.zero", wet.zero, text)


def _record(case: Case) -> Found:
    record = case.record
    there = all(one < counts(case)[0] for one in record.tracked)  # else `check_record` says so
    if record.tracked and there and events_of(case) == "none":
        text = "has no effect with record.events 'none'; give events = 'tracked'"
        yield CaseError("record.tracked", list(record.tracked), text)


def notes_without_effect(case: Case) -> tuple[str, ...]:
    """What a case gives and has no effect, where that is common and harmless."""
    if water_alone(case):
        idle = [key for key in _given_keys(case) if not _acts_on_water(case, key)]
        return (f"no grain is in the water, so these have no effect: {', '.join(idle)}",) if idle else ()
    build, record, notes = case.build, case.record, list[str]()
    if given(case, "seed") and not _draws(case):
        notes.append("seed has no effect: nothing is drawn at random")
    if not _draws_sizes_of_grains(case):
        for key, there in (
            ("spread", spread_of(case.grains)[1] > 0.0),
            ("sieve_curve", case.grains.sieve_curve is not None and case.grains.diameter is not None),
        ):
            if there:
                notes.append(f"grains.{key} has no effect: no grain is drawn with the sizes of [grains]")
    if getattr(build, "gap", None) == 0.0 and given(build, "jitter") and getattr(build, "jitter", 0.0) > 0.0:
        notes.append("build.jitter has no effect with build.gap = 0, of which it is a fraction")
    if (
        isinstance(build, PackingSection | FlumeSection)
        and build.bed != "random"
        and given(build, "bed_height")
    ):
        what = "whose grains lie at one height" if build.bed == "flat" else "which has no grains"
        notes.append(f"build.bed_height has no effect with bed '{build.bed}', {what}; it is for 'random'")
    if isinstance(build, StreamSection) and build.bed == 0.0:
        idle = [f"build.{key}" for key in ("begin", "end", "gap", "jitter") if given(build, key)]
        notes += [f"{', '.join(idle)}: no effect without build.bed"] if idle else []
    if record.tracked and events_of(case) == "all" and case.stop.saltations is None:
        notes.append("record.tracked has no effect: contacts of all grains are recorded (record.events)")
    if isinstance(build, FillSection) and build.most is not None:
        as_many = build.model_copy(update={"most": None})
        if build.most >= (held := fill_count(case, as_many)):
            notes.append(f"build.most = {build.most:,} has no effect: the box holds {held:,} grains")
    if _is_central(case):
        idle = [key for key in _given_keys(case) if key in _TANGENTIAL]
        if idle:
            notes.append(f"the impact is central, so these have no effect: {', '.join(idle)}")
    more = (_of_materials, _of_contacts, _of_timeline, _of_bounds)
    return (*notes, *(one for say in more for one in say(case)))


def _given_keys(case: Case) -> list[str]:
    """Keys that a case gives, dotted, in its order; a list of tables counts as one key."""

    def below(section: BaseModel, before: str) -> Iterator[str]:
        for name in section.model_fields_set:
            value = getattr(section, name)
            key = f"{before}{type(section).model_fields[name].alias or name}"
            if isinstance(value, Section):
                yield from below(value, f"{key}.")
            elif value is not None:
                yield key

    fields = type(case).model_fields.items()
    places = {field.alias or name: k for k, (name, field) in enumerate(fields)}
    return sorted(below(case, ""), key=lambda key: (places[key.partition(".")[0]], key))


def _acts_on_water(case: Case, key: str) -> bool:
    """Whether a key acts where no grain ever is."""
    if key == "water.row.width":  # of a discharge of the whole width, and of grains
        keys = case.row
        end = None if keys is None else keys.upstream
        every = [one.discharge for one in (end, *case.timeline) if one is not None]
        if end is not None and end.hydrograph is not None:
            every += [q for _, q in hydrograph_points(case.folder, end.hydrograph)]
        return any(one is not None and one[1] == "m3/s" for one in every)
    curve = ("grains.sieve_curve", "grains.finest", "grains.coarsest")
    if key in curve:  # D50 is the roughness
        return case.grains.diameter is None
    return any(key == one or key.startswith(f"{one}.") for one in _OF_WATER)


def _draws(case: Case) -> bool:
    """Whether anything is drawn at random."""
    wet = case.water
    if case.feeds or has_clumps(case.grains) or case.grains.mixture:
        return True
    if wet is not None and wet.column is not None and wet.column.fluctuations != "none":
        return True
    return not isinstance(case.build, DropSection | TableSection | RunSection)


def _is_central(case: Case) -> bool:
    """Whether a drop has nothing that moves along its contact."""
    build = case.build
    level = slope(case.motion) == 0.0 and not any(one.slope or one.slope_angle for one in case.timeline)
    return (
        isinstance(build, DropSection)
        and build.offset == build.speed_along == build.spin == 0.0
        and level
        and case.water is None
        and not (case.planes or case.walls)
    )


def _of_contacts(case: Case) -> Iterator[str]:
    """Keys of dashpots and springs that are zero."""
    contact = case.contact
    if contact.restitution == 1.0 or (contact.restitution is None and contact.damping == 0.0):
        for key in ("parting", "damping_law"):
            if given(contact, key):
                yield f"contact.{key} has no effect: there is no normal dashpot"
    if stiffness(case)[1] == 0.0:
        shear = given(contact, "restitution_shear") and restitution(case.contact)[1] != 1.0
        if shear:
            yield "contact.restitution_shear has no effect: there is no tangential spring"


def _of_timeline(case: Case) -> Iterator[str]:
    """Entries that change nothing, and those at the very end."""
    rotation = case.motion.rotation
    for k, one in enumerate(case.timeline):
        if case.stop.time is not None and one.at == case.stop.time:
            yield f"timeline.{k} has no effect: it comes at stop.time"
        if one.rotation is not None:
            if one.rotation == rotation:
                yield f"timeline.{k}.rotation has no effect: rotation is {one.rotation} already"
            rotation = one.rotation


def _of_bounds(case: Case) -> Iterator[str]:
    """Bounds that are not reached, and feeds and exits attached to a wall that stays where it is."""
    moved = {one.move.wall for one in case.timeline if one.move is not None}
    keys = ("velocity", "angular_velocity", "amplitude", "servo")
    moved |= {wall.name for wall in case.walls if any(given(wall, key) for key in keys)}
    for k, feed in enumerate(case.feeds):
        if feed.end is not None and feed.total is not None:  # `check_traffic` asks for all of it by then
            yield f"feeds.{k}.end has no effect: feeds.{k}.total is fed by then"
    for name, form in case.shapes.items():
        both = form.spheres is not None and form.filled is not None
        if both and (n := len(spheres_of(case, name))) < (form.spheres or 0):
            yield f"shapes.{name}.spheres = {form.spheres} has no effect: {n} fill {form.filled:g} of it"
    sections: Mapping[str, Any] = {"feeds": case.feeds, "exits": case.exits}
    for kind, entries in sections.items():
        for k, one in enumerate(entries):
            if one.moves_with is not None and one.moves_with not in moved:
                yield f"{kind}.{k}.moves_with has no effect: wall '{one.moves_with}' stays where it is"
