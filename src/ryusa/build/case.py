"""Builds a checked case: scene, initial state and the choices that the case does not state."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ryusa.build.assemble import Laws, assemble
from ryusa.build.belts import refuse_idle_belts
from ryusa.build.box import box
from ryusa.build.clumps import clumps_of
from ryusa.build.column import column_of, zero_of
from ryusa.build.drop import drop
from ryusa.build.empty import empty
from ryusa.build.feeds import before_feeding, leaving_row, moving_with, with_feeds
from ryusa.build.fill import fill
from ryusa.build.flume import flume
from ryusa.build.materials import Numbers, densities, materials_of
from ryusa.build.overlaps import refuse_overlaps
from ryusa.build.packing import packing
from ryusa.build.passing_walls import refuse_passing_walls
from ryusa.build.placement import Placement, Wall
from ryusa.build.row import row_of
from ryusa.build.saltation import saltation
from ryusa.build.servo import servo_notes
from ryusa.build.stream import stream_bed, stream_walls
from ryusa.build.table import table
from ryusa.build.wall_checks import (
    refuse_crushing_servos,
    refuse_fast_walls,
    refuse_full_feeds,
    refuse_grains_beyond_exits,
    refuse_idle_servos,
)
from ryusa.build.walls import SolidWall, refuse_overlaps_with_walls, walls_of, with_room, with_walls
from ryusa.casefile.builders.table import key_of
from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import (
    adhesion,
    adhesion_amount,
    hertz_law,
    is_hertz,
    may_pull,
    timing,
)
from ryusa.casefile.derive import derive
from ryusa.casefile.facts import Derived
from ryusa.casefile.films import film_reach
from ryusa.casefile.grains.values import slab_width
from ryusa.casefile.materials.values import GRAINS, case_of_pair, names_of
from ryusa.casefile.record.time import steps_by_default
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.shape import extent, has_clumps
from ryusa.casefile.water.values import hindrance_exponent
from ryusa.casefile.without_effect import notes_without_effect
from ryusa.errors import CaseError
from ryusa.laws.families import (
    Above,
    Arm,
    Buoyancy,
    Cap,
    Drag,
    DragOfForm,
    Hindrance,
    Lift,
    Magnus,
    Mixing,
    Profile,
    Rebound,
    Rolling,
    Slip,
    WaterTorque,
)
from ryusa.model import ContactLaw, Materials, RollingLaw, Scene, State, Water
from ryusa.model.scene import Damping, EventRule
from ryusa.spelling import nearest_word

BUILDERS = {
    "drop": drop,
    "saltation": saltation,
    "table": table,
    "run": table,
    "packing": packing,
    "flume": flume,
    "box": box,
    "empty": empty,
    "fill": fill,
    "stream": stream_bed,
}
_OF_A_COLUMN = ("buoyancy", "hindrance", "lift", "magnus")
_WATER_DEFAULTS = {  # key of [water]: how `ryusa check` calls it, and its unit
    "drag": ("drag law", ""),
    "viscosity": ("kinematic viscosity", " m2/s"),
    "above": ("speed above the depth", ""),
    "torque": ("torque of the water", ""),
    "buoyancy": ("buoyancy", ""),
    "hindrance": ("hindrance", ""),
    "lift": ("lift", ""),
    "magnus": ("Magnus lift", ""),
}


@dataclass(frozen=True)
class Built:
    """Initial condition of a run."""

    scene: Scene
    state: State
    notes: tuple[str, ...]  # choices that the case does not state


def build(case: Case, derived: Derived | None = None) -> Built:
    """Place the first grains of a case.

    Parameters
    ----------
    case : a checked case.
    derived : what follows from it; computed when not given.

    Raises
    ------
    CaseError : first grains overlap or lie between lanes, the timeline names an unknown group, or a wall, a
        feed or an exit cannot do what it is asked.
    """
    try:
        return _built(case, derived or derive(case))
    except CaseError as error:
        if error.source is not None or case.path is None:
            raise
        raise CaseError(
            error.key, error.value, error.allowed, error.nearest, others=error.others, source=case.path.name
        ) from error


def _built(case: Case, found: Derived) -> Built:
    placement = BUILDERS[case.build.kind](case, found)
    placement = _with_planes(placement, case)
    key = key_of(case.build)
    reach = replace(placement, d=placement.d * extent(case))  # clumps, however they are turned
    refuse_overlaps(reach, key, case.motion.plane)
    walls = (*walls_of(case), *stream_walls(case))
    _refuse_taken_names(placement, walls)
    refuse_overlaps_with_walls(reach, walls, key)
    _refuse_unknown_groups(placement, case)
    laws = replace(
        laws_of(case, found, placement.z_zero),
        flow=row_of(case, found, placement) or column_of(case, found, placement),
    )
    placement, traffic = with_feeds(placement, case, found)
    n_first = len(placement.d) if traffic is None else traffic.n_first
    of = materials_of(case, placement, n_first, traffic)
    if len(of):
        laws = replace(laws, density=densities(case, of[: len(placement.d)]))
    elif (own := placement.density) is not None:
        fed = np.full(len(placement.d) - len(own), case.grains.density)
        laws = replace(laws, density=np.concatenate([own, fed]))
    open_below, open_above = case.domain.low is None, case.domain.high is None
    scene, state = before_feeding(*assemble(placement, laws), traffic, open_below, open_above)
    scene = with_room(with_walls(scene, walls), open_below, open_above)
    scene = leaving_row(moving_with(scene))
    scene, state = clumps_of(case, with_materials(case, scene, of), state)
    refuse_fast_walls(case, scene)
    refuse_idle_belts(case, scene)
    passed = refuse_passing_walls(case, scene)
    refuse_idle_servos(case, scene, state)
    pressed = refuse_crushing_servos(scene)
    areas = servo_notes(
        scene, {k: one.servo.pressure for k, one in enumerate(case.walls) if one.servo and one.servo.pressure}
    )
    gone = refuse_grains_beyond_exits(scene, state)
    refuse_full_feeds(case, scene)
    said = (*placement.notes, *passed, *areas, *pressed, *gone, *notes_without_effect(case), *notes_of(case))
    return Built(scene, state, said)


def laws_of(case: Case, derived: Derived, z_zero: float) -> Laws:
    """Laws of a case; `z_zero` [m] is the origin of the water profile if the case gives none."""
    return Laws(
        density=case.grains.density,
        a_3=case.grains.shape_volume,
        contact=contact_of(case, derived),
        dt=derived.dt,
        rolling=rolling_of(case),
        water=water_of(case, derived, z_zero),
        g=derived.g,
        slope=derived.slope,
        rotation=case.motion.rotation == "free",
        plane_case=case.motion.plane,
        slab_width=slab_width(case) if case.motion.plane else math.nan,
        overlap_limit=case.domain.overlap_limit,
        events=EventRule[events_of(case).upper()],
        forces=case.record.forces,
        tracked=case.record.tracked,
        low=case.domain.low,
        high=case.domain.high,
    )


def with_materials(case: Case, scene: Scene, of: Numbers) -> Scene:
    """The same scene with the materials of a case, `of` by id without faces; as it is where there is one."""
    if not len(of):
        return scene
    names, walls = names_of(case.materials), scene.walls
    if walls is not None:
        of_case = [names.index(one.material or GRAINS) for one in case.walls]
        others = walls.names[len(of_case) :]  # bottom and dams of a stream
        bed = names.index(case.grains.bed_material or GRAINS)
        own = np.array([*of_case, *(bed for _ in others)], np.int8)
        of = np.concatenate([of, own[walls.wall]])
    of.flags.writeable = False
    pairs = [case_of_pair(case, *sorted((a, b), key=names.index)) for a in names for b in names]
    contact = tuple(contact_of(one, derive(one)) for one in pairs)
    return replace(scene, materials=Materials(names, of, contact, tuple(rolling_of(one) for one in pairs)))


def contact_of(case: Case, derived: Derived) -> ContactLaw:
    """Contact law of a case."""
    found, contact = derived, case.contact
    if is_hertz(case.contact):
        return hertz_law(case)
    constants = math.isnan(found.e_n)
    return ContactLaw(
        k_n=found.k_n,
        k_s=found.k_s,
        mu=found.mu,
        cohesion=contact.cohesion,
        damping=Damping.CONSTANTS if constants else Damping.RESTITUTION,
        e_n=found.e_n,
        e_s=found.e_s,
        zeta_n=0.0 if constants else found.fixed.zeta_n,
        zeta_s=0.0 if constants else found.fixed.zeta_s,
        eta_n=found.fixed.eta_n if constants else 0.0,
        eta_s=found.fixed.eta_s if constants else 0.0,
        slip=Slip.of(contact.slip),
        cap=chosen(case, Cap),
        tension=may_pull(case.contact),
        timing=timing(case),
        adhesion=adhesion(case.contact),
        adhesion_amount=adhesion_amount(case.contact),
    )


def rolling_of(case: Case) -> RollingLaw:
    """Rolling friction of a case."""
    rolling = case.rolling
    return RollingLaw(
        model=Rolling.of(rolling.model),
        arm=chosen(case, Arm),
        coefficient=rolling.coefficient,
        stiffness_factor=rolling.stiffness_factor,
        zeta_r=rolling.damping_ratio,
        twisting=rolling.twisting_coefficient,
    )


def water_of(case: Case, derived: Derived, z_zero: float) -> Water:
    """Water of a case; profile NONE when dry."""
    water, found = case.water, derived
    if water is None:
        return Water()
    return Water(
        profile=Profile.of(water.profile),
        u_star=0.0 if math.isnan(found.u_star) else found.u_star,
        k_rough=found.k_rough,
        z_zero=zero_of(case, z_zero),
        u_uniform=water.speed or 0.0,
        depth=math.inf if water.depth is None else water.depth,
        above=Above.of(water.above),
        nu=water.viscosity,
        rho_w=water.density,
        drag=Drag.of(water.drag),
        drag_of_form=DragOfForm.of(water.drag_of_form) if has_clumps(case.grains) else DragOfForm.SPHERE,
        c_d=water.drag_coefficient,
        a_2=water.shape_area,
        c_m=water.added_mass,
        torque=WaterTorque.of(water.torque),
        rebound=Rebound.of(water.rebound),
        st_c=water.rebound_stokes,
        e_least=water.rebound_least,
        asperity=water.asperity or 0.0,
        film_reach=film_reach(case),
        **(column_laws_of(case) if water.profile == "column" else {}),
    )


def column_laws_of(case: Case) -> dict[str, Any]:
    """Fields of `Water` that apply to a column only."""
    water = case.water
    assert water is not None
    return {
        "buoyancy": Buoyancy.of(water.buoyancy),
        "hindrance": Hindrance.of(water.hindrance),
        "hindrance_exponent": hindrance_exponent(case),
        "lift": Lift.of(water.lift),
        "c_l": water.lift_coefficient,
        "magnus": Magnus.of(water.magnus),
    }


def notes_of(case: Case) -> tuple[str, ...]:
    """Defaults that the case does not state and that influence the results."""
    notes: list[str] = []
    contact, water = case.contact, case.water
    if water is not None and water_alone(case):
        if water.roughness is None and case.column.bed == "rough":
            notes.append("roughness k_s of Eq. (9) = mean d (water.roughness not given)")
        return (*notes, *_column_notes(case))
    elastic = is_hertz(case.contact)
    if elastic:
        notes += _elastic_notes(case)
    elif contact.shear_ratio is None and contact.shear_stiffness is None:
        notes.append("k_s = 2/7 k_n (contact.shear_ratio not given)")
    if contact.restitution is not None and contact.restitution_shear is None:
        notes.append("tangential restitution = normal restitution (contact.restitution_shear not given)")
    for key, what in (("slip", "slip rule"), ("parting", "parting")):
        if key not in contact.model_fields_set and not (key == "parting" and elastic):
            notes.append(f"{what}: {getattr(contact, key)} (contact.{key} not given)")
    if water is not None:
        bed = case.column.bed if water.profile == "column" else ""
        if water.roughness is None and (water.profile == "log rough" or bed == "rough"):
            notes.append("roughness k_s of Eq. (9) = mean d (water.roughness not given)")
        if water.depth is None and case.row is None:
            notes.append("water of unlimited depth (water.depth not given)")
        notes += [
            f"{what}: {getattr(water, key)}{unit} (water.{key} not given)"
            for key, (what, unit) in _WATER_DEFAULTS.items()
            if key not in water.model_fields_set
            and not (key == "torque" and case.motion.rotation == "locked")
            and not (key == "above" and bed)
            and not (key in _OF_A_COLUMN and not bed)
        ]
        if bed:
            notes += _column_notes(case)
    if case.time.step is None and case.time.steps_per_contact is None:
        notes.append(f"{steps_by_default(case):g} steps in the shortest contact (time not given)")
    if case.record.events is None:
        notes.append(f"contacts recorded: {events_of(case)} (record.events not given)")
    return tuple(notes)


def _elastic_notes(case: Case) -> list[str]:
    keys = (("poisson_ratio", "Poisson's ratio"), ("damping_law", "damping"), ("unloading", "unloading"))
    notes = [
        f"{what}: {getattr(case.contact, key)} (contact.{key} not given)"
        for key, what in keys
        if key not in case.contact.model_fields_set
    ]
    if case.contact.expected_speed is None:
        speed, origin = expected_speed(case)
        notes.append(f"expected impact speed: {speed:.3g} m/s, {origin} (contact.expected_speed not given)")
    return notes


def _column_notes(case: Case) -> list[str]:
    keys = case.column
    notes = [
        f"{what}: {getattr(keys, key)} (water.column.{key} not given)"
        for key, what in (("bed", "lower boundary of the water"), ("drive", "driver of the water"))
        if key not in keys.model_fields_set
    ]
    if keys.mixing_length is None:
        notes.append(f"mixing length: {chosen(case, Mixing).word} (water.column.mixing_length not given)")
    return notes


def _with_planes(placement: Placement, case: Case) -> Placement:
    walls = tuple(Wall(plane.name, plane.point, plane.normal) for plane in case.planes)
    taken = {
        *(wall.name for wall in placement.walls),
        "grains",
        "bed",
        *(name for name, _, _ in placement.fixed_groups),
    }
    for number, wall in enumerate(walls):
        if wall.name in taken:
            raise CaseError(
                f"planes.{number}.name", wall.name, "is already used by the builder; choose another name"
            )
    return replace(placement, walls=(*placement.walls, *walls))


def _refuse_taken_names(placement: Placement, walls: Sequence[SolidWall]) -> None:
    taken = {"grains", *placement.groups()}
    for number, wall in enumerate(walls):
        if wall.name in taken:
            raise CaseError(
                f"walls.{number}.name", wall.name, "is the name of a plane or a group of grains already"
            )


def _refuse_unknown_groups(placement: Placement, case: Case) -> None:
    known = [name for name, (first, _) in placement.groups().items() if first >= len(placement.d)]
    known += [wall.name for wall in case.walls]
    for number, entry in enumerate(case.timeline):
        if entry.remove is not None and entry.remove not in known:
            there = ", ".join(known) or "there is none"
            allowed = f"must be a group of fixed grains, a plane or a wall: {there}"
            raise CaseError(
                f"timeline.{number}.remove", entry.remove, allowed, nearest_word(entry.remove, known)
            )
