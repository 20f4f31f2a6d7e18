"""The cells in which faces are found: every face in every cell of its box, made once, whatever the mesh."""

import numpy as np

from ryusa.build import scene
from ryusa.build.walls import cylinder, rectangle, triangles, with_walls
from ryusa.engine.cpu.faces import face_arrays
from ryusa.model import Walls


def walls_of(*walls) -> Walls:  # type: ignore[no-untyped-def]
    made = with_walls(scene([[0.0, 0.0, 9.0]], 2e-3)[0], walls).walls
    assert made is not None
    return made


def needles(n: int) -> np.ndarray:
    """Triangles as long as the mesh, beside many short ones."""
    a = np.random.default_rng(1).uniform(size=(n, 1, 3))
    short = a + np.random.default_rng(2).uniform(-1e-3, 1e-3, (n, 3, 3))
    long = (
        np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]]) + 1e-4 * np.arange(n)[:, None, None]
    )
    return np.concatenate([short, long])


def test_a_face_is_in_every_cell_of_its_box_and_in_no_other() -> None:
    made = walls_of(triangles("part", needles(20)), rectangle("floor", (0, 0, -1), (2, 0, 0), (0, 2, 0)),
                    cylinder("tube", (5, 0, 0), (0, 0, 1), 0.3, closed=(True, True)))  # fmt: skip
    found = face_arrays(made, 3)
    held = [set[int]() for _ in range(made.n_face)]
    for cell in range(len(found.cell_first) - 1):
        faces = found.cell_face[found.cell_first[cell] : found.cell_first[cell + 1]].tolist()
        assert faces == sorted(set(faces))
        for f in faces:
            held[f].add(cell)
    for f in range(made.n_face):
        w = made.wall[f]
        axes = [range(a, b + 1) for a, b in zip(found.cells_low[f], found.cells_high[f], strict=True)]
        n = found.grid_dims[w]
        cells = {found.grid_first[w] + (a * n[1] + b) * n[2] + c
                 for a in axes[0] for b in axes[1] for c in axes[2]}  # fmt: skip
        assert held[f] == cells


def test_long_faces_beside_short_ones_do_not_fill_the_memory() -> None:
    made = walls_of(triangles("part", needles(3_000)))
    assert len(face_arrays(made, 0).cell_face) < 64 * made.n_face + 1_000_001


def test_faces_of_the_same_walls_are_laid_out_once() -> None:
    made, other = walls_of(triangles("part", needles(5))), walls_of(triangles("part", needles(6)))
    first = face_arrays(made, 3)
    again = face_arrays(made, 9)
    assert again.cell_face is first.cell_face
    assert again.first == 9
    assert again.poses is not first.poses
    assert len(face_arrays(other, 3).rows) == other.n_face
