"""Defaults that a case does not state and that influence the results."""

from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import (
    is_hertz,
)
from ryusa.casefile.record.time import steps_by_default
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.values import water_alone
from ryusa.laws.families import (
    Mixing,
)

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


def unstated_notes(case: Case) -> tuple[str, ...]:
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
