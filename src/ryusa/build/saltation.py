"""A grain over a line of fixed, touching grains; independent copies lie side by side in lanes."""

import numpy as np

from ryusa.build.placement import LANE, Placement, at_rest
from ryusa.casefile.builders.schema import SaltationSection
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.water.values import water_speed

ZERO = 0.25  # depth of the profile's zero below the crest, in diameters: the classical choice
START = 2.0  # first gap above the crest, in diameters


def saltation(case: Case, derived: Derived) -> Placement:
    """Bed centres at z = d/2, crest at z = d, one free grain per lane at a random x; group `bed`."""
    keys = case.build
    assert isinstance(keys, SaltationSection)
    d, n_bed, starts = reference_diameter(case), keys.n_bed, keys.starts
    period = n_bed * d
    rng = np.random.default_rng(case.seed)
    x = at_rest(starts)
    x[:, 0] = rng.uniform(0.0, period, starts)
    x[:, 1] = np.arange(starts) * LANE * d
    x[:, 2] = 1.5 * d + (START * d if keys.start_height is None else keys.start_height)
    z_zero = (1.0 - ZERO) * d
    zero = z_zero if case.water is None or case.water.zero is None else case.water.zero
    v = at_rest(starts)
    v[:, 0] = (
        water_speed(case, derived, float(x[0, 2]) - zero) if keys.start_speed is None else keys.start_speed
    )
    x_fixed = np.zeros((starts, n_bed, 3))
    x_fixed[:, :, 0] = (np.arange(n_bed) + 0.5) * d
    x_fixed[:, :, 1] = x[:, 1, None]
    x_fixed[:, :, 2] = d / 2.0
    notes: list[str] = []
    if case.water is not None and case.water.zero is None:
        notes.append(f"zero of the water profile {ZERO:g} d below the crest (water.zero not given)")
    if keys.start_height is None:
        notes.append(f"grains start {START:g} d above the crest (build.start_height not given)")
    if keys.start_speed is None and case.water is not None:
        notes.append("grains start with the speed of the water at their centre (build.start_speed not given)")
    return Placement(
        d=np.full(starts, d),
        x=x,
        v=v,
        omega=at_rest(starts),
        d_fixed=np.full(starts * n_bed, d),
        x_fixed=x_fixed.reshape(-1, 3),
        period=(period, float("inf")),
        z_zero=z_zero,
        notes=tuple(notes),
    )
