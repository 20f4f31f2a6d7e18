"""Numbers that the catalogue names for measures that need walls or ends; others: `tests/campaigns/soften`."""

import pytest
from tests.measure.test_deposit import trapping
from tests.measure.test_direct_shear import sheared as drawn_apart
from tests.measure.test_mill import turning
from tests.measure.test_plane_shear import sheared
from tests.measure.test_scour import dug
from tests.measure.test_shear_zone import turned

from ryusa.campaigns.calibrate.study_file import _refuse_quantity
from ryusa.catalogue import MEASURES, load

RUNS = {
    "deposit": lambda _: trapping(),
    "front": lambda _: trapping(),
    "direct_shear": lambda _: drawn_apart(),
    "mill": turning,
    "scour": lambda _: dug(),
    "shear": sheared,
    "shear_zone": turned,
}


@pytest.mark.parametrize("entry", [one for one in MEASURES if one.name in RUNS], ids=lambda one: one.name)
def test_the_numbers_of_the_catalogue_are_those_that_the_measure_gives(entry, make):
    found = load(entry.function)(RUNS[entry.name](make))
    rows = (found.averages if hasattr(found, "averages") else found).rows()
    assert set(entry.numbers) <= {(row["quantity"], row["unit"]) for row in rows}
    for row in rows:
        _refuse_quantity("", entry.name, row["quantity"])  # none that there is is refused
