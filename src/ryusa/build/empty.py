"""A scene without free grains at the start, with or without a plate of fixed ones."""

import numpy as np

from ryusa.build.placement import Placement, at_rest
from ryusa.casefile.builders.schema import EmptySection
from ryusa.casefile.builders.values import plate_of
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived


def empty(case: Case, derived: Derived) -> Placement:
    """Place the plate, its top at z = 0; group `floor`."""
    keys = case.build
    assert isinstance(keys, EmptySection)
    x = plate_of(case, keys.plate)
    groups = (("floor", 0, len(x)),) if len(x) else ()
    return Placement(
        d=np.zeros(0), x=at_rest(0), v=at_rest(0), omega=at_rest(0),
        d_fixed=np.full(len(x), derived.d), x_fixed=x, fixed_groups=groups,
    )  # fmt: skip
