import numpy as np
import pytest
from matplotlib.patches import Circle

from ryusa.build import scene as scene_of
from ryusa.build.clumps import with_clumps
from ryusa.errors import ResultsError
from ryusa.figures.clump_shapes import clump_shapes
from ryusa.model.clump import shape

D = 0.004


class Run:
    def __init__(self, scene):
        self.scene = scene


def test_forms_are_drawn_in_the_volume_of_the_sphere_beside_them():
    """Of spheres that only touch the volumes add up; circles are the spheres, one more is dashed."""
    at = [(0.0, 0.0, 0.0), (0.02, 0.0, 0.0)]
    scene, _ = with_clumps(*scene_of(at, D), [shape("dumbbell"), shape("tetrahedron")], form_of=[0, 1])
    figure, rows = clump_shapes(Run(scene))
    assert [row["shape"] for row in rows] == ["form 0"] * 2 + ["form 1"] * 4
    pair = np.array([row["d_sphere_over_d"] for row in rows[:2]])
    assert np.sum(pair**3) == pytest.approx(1.0)
    x = np.array([[row[f"{one}_over_d"] for one in "xyz"] for row in rows[:2]])
    assert np.linalg.norm(x[0] - x[1]) == pytest.approx(pair.mean())
    circles = [[one for one in axes.patches if isinstance(one, Circle)] for axes in figure.axes]
    assert [len(one) for one in circles] == [3, 5, 3, 5]
    assert sorted(one.radius for one in circles[0])[:2] == pytest.approx(0.5 * pair)
    texts = [one.get_text() for axes in figure.axes for one in axes.texts]
    assert "b/a 0.41\nc/b 1.00\nvolume exact" in texts
    assert [row["volume_error"] for row in rows[:2]] == [0.0] * 2
    [error] = {row["volume_error"] for row in rows[2:]}  # three spheres have a common point: no closed form
    assert 0.0 < error < 1e-9
    assert f"volume to {error:.0e}" in texts[-1]


def test_a_run_of_spheres_has_none():
    with pytest.raises(ResultsError, match="no clumps"):
        clump_shapes(Run(scene_of([(0.0, 0.0, 0.0)], D)[0]))
