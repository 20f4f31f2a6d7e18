"""A grain dropped on a fixed grain, a free grain or a plane; copies lie side by side in lanes."""

import math

import numpy as np

from ryusa.build.placement import LANE, Placement, Wall, at_rest
from ryusa.casefile.builders.schema import DropSection
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter

GAP = 0.1  # first gap when only a speed is given, in diameters


def drop(case: Case, _derived: Derived) -> Placement:
    """Struck grain at x = 0 with its base at z = 0, striking grain `height` above it; group `struck`."""
    keys = case.build
    assert isinstance(keys, DropSection)
    d, copies = reference_diameter(case), keys.copies
    height = GAP * d if keys.height is None else keys.height
    lanes = np.arange(copies)
    gap = height + lanes * keys.height_step
    x = at_rest(copies)
    x[:, 0] = keys.offset
    x[:, 1] = lanes * LANE * d
    centre = d / 2.0 if keys.partner == "plane" else d / 2.0 + math.sqrt(d * d - keys.offset * keys.offset)
    x[:, 2] = centre + gap
    v, omega = at_rest(copies), at_rest(copies)
    v[:, 0], v[:, 2] = keys.speed_along, -keys.speed
    omega[:, 1] = keys.spin
    struck = at_rest(copies)
    struck[:, 1], struck[:, 2] = x[:, 1], d / 2.0
    same, rest = np.full(copies, d), at_rest(copies)
    notes = (f"gap at the start {GAP:g} d (build.height not given)",) if keys.height is None else ()
    if keys.partner == "plane":
        floor = (Wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),)
        return Placement(d=same, x=x, v=v, omega=omega, walls=floor, notes=notes)
    if keys.partner == "fixed":
        groups = (("struck", 0, copies),)
        return Placement(
            d=same, x=x, v=v, omega=omega, d_fixed=same, x_fixed=struck, fixed_groups=groups, notes=notes
        )
    return Placement(
        d=np.concatenate([same, same]),
        x=np.concatenate([x, struck]),
        v=np.concatenate([v, rest]),
        omega=np.concatenate([omega, rest]),
        free_groups=(("struck", copies, copies),),
        notes=notes,
    )
