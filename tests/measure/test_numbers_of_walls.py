"""Numbers that the catalogue names for measures that need walls; the others: `tests/studies/soften`."""

import pytest
from tests.measure.test_direct_shear import sheared as drawn_apart
from tests.measure.test_mill import turning
from tests.measure.test_plane_shear import sheared
from tests.measure.test_shear_zone import turned

from ryusa.catalogue import MEASURES, load

RUNS = {
    "direct_shear": lambda _: drawn_apart(),
    "mill": turning,
    "shear": sheared,
    "shear_zone": turned,
}


@pytest.mark.parametrize(
    "entry", [one for one in MEASURES if one.numbers and "walls" in one.needs], ids=lambda one: one.name
)
def test_the_numbers_of_the_catalogue_are_those_that_the_measure_gives(entry, make):
    found = load(entry.function)(RUNS[entry.name](make))
    rows = (found.averages if hasattr(found, "averages") else found).rows()
    assert set(entry.numbers) <= {(row["quantity"], row["unit"]) for row in rows}
