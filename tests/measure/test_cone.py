import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import ryusa
from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.cone import cone as drawn
from ryusa.measure import cone

D = 0.002


def standing(make, x):
    """A run of one frame with grains at x (n, 3) on a plane at z = 0 called floor."""
    n = len(x)
    scene = replace(
        make.scene(n),
        d=np.full(n, D),
        x_fixed=np.zeros((0, 3)),
        d_fixed=np.zeros(0),
        fixed_active=np.zeros(0, dtype=bool),
        plane_normal=np.array([[0.0, 0.0, 1.0]]),
        plane_point=np.zeros((1, 3)),
        plane_active=np.ones(1, dtype=bool),
        groups={"floor": (n, n + 1)},
        period=(math.inf, math.inf),
        plane_case=False,
    )
    zero = np.zeros((1, n, 3))
    frames = SimpleNamespace(t=np.array([0.0]), x=x[None], v=zero, omega=zero)
    return SimpleNamespace(case={}, frames=frames, scene=scene, contacts=None, tally={})


def heap(degrees, foot=0.04, at=(0.0, 0.0)):
    """Touching columns of grains, whose tops lie on a cone."""
    tangent, rows = math.tan(math.radians(degrees)), []
    for x in np.arange(-foot, foot, 0.5 * D):
        for y in np.arange(-foot, foot, 0.5 * D):
            top = (foot - math.hypot(x, y)) * tangent
            rows += [(x + at[0], y + at[1], z) for z in np.arange(top - D / 2, 0.0, -D)]
    return np.array(rows)


@pytest.mark.parametrize("degrees", [12.0, 20.0, 33.0])
def test_the_slope_of_an_exact_cone_is_found_wherever_it_stands(make, degrees):
    found = cone(standing(make, heap(degrees, at=(0.3, -0.1))))
    assert math.degrees(found.angle) == pytest.approx(degrees, abs=0.5)
    assert math.degrees(found.error) < 0.2
    assert (found.x, found.y) == pytest.approx((0.3, -0.1), abs=1e-4)
    assert found.height == pytest.approx(0.04 * math.tan(math.radians(degrees)), abs=D)
    assert found.foot == pytest.approx(0.04, abs=2.0 * D)
    assert found.moving == 0.0
    assert np.ptp(np.degrees(found.sides)) < 1.5
    assert f"{math.degrees(found.angle):.1f}°" in drawn(found).axes[0].texts[0].get_text()


def test_sides_of_two_slopes_show_in_the_error(make):
    x = heap(25.0)
    steep = x[:, 0] > 0.0
    x[steep, 0] *= math.tan(math.radians(25.0)) / math.tan(math.radians(35.0))
    found = cone(standing(make, x))
    assert math.degrees(np.nanmax(found.sides) - np.nanmin(found.sides)) > 7.0
    assert math.degrees(found.error) > 1.0


def test_a_heap_of_few_grains_is_refused(make):
    with pytest.raises(ResultsError, match="too small to measure a slope"):
        cone(standing(make, heap(30.0, foot=0.004)))


def test_a_plane_scene_is_refused(make):
    run = standing(make, heap(30.0))
    run.scene = replace(run.scene, plane_case=True)
    with pytest.raises(ResultsError, match="no heap with a round foot"):
        cone(run)


@pytest.mark.slow
def test_a_lifted_cylinder_leaves_the_heap_that_pouring_gives_and_rolling_friction_steepens_it(
    tmp_path: Path,
):
    """Measured: 31.0 and 34.5 deg with errors of 1.5 and 1.4; 26.6 with a rolling coefficient of 0.01."""

    def angle(case: str, **less: str) -> float:
        name = case + "".join(less.values())
        run = ryusa.run(ryusa.load(case_path(f"{case}.toml"), less), tmp_path / name, progress=False)
        found = cone(run)
        assert run.tally["residual"].max() < 1e-3
        assert found.moving < 0.05
        return math.degrees(found.angle)

    assert angle("lifted_cylinder") == pytest.approx(angle("poured_heap"), abs=6.0)
    little, much = (angle("lifted_cylinder", **{"rolling.coefficient": one}) for one in ("0.01", "0.3"))
    assert little < much - 2.0
