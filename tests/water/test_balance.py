"""In steady flow the bed carries the weight of water and grains, whatever the form of buoyancy.

What grains give to the bed is read from the contacts' own impulses, which know nothing of the water.
"""

import numpy as np
import pytest

from ryusa.laws.families import Buoyancy
from ryusa_studies.validation.balance import ChannelFlow


@pytest.mark.full
@pytest.mark.parametrize("form", list(Buoyancy))
def test_bed_and_fixed_grains_carry_the_weight_of_the_mixture(form):
    flow = ChannelFlow(form, seed=1)
    flow.run(1.0)
    weight, contacts, water, gain = flow.run(2.5)
    assert -contacts > 0.8 * weight
    assert weight + contacts + water == pytest.approx(gain, abs=1e-9 * weight)
    assert -(contacts + water) == pytest.approx(weight, rel=0.01)
    assert np.mean(flow.engine.kinematics()[1][:, 0]) > 0.02  # [m/s]; it is bed load that the contacts carry
