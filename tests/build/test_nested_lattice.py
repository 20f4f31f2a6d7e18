"""Cells of a lattice are filled from below, evenly or in proportion to a thickness along x."""

import numpy as np
import pytest

from ryusa.build.nested_lattice import LatticeCells, filled_cells, places

N_X, N_Y = 12, 5


def filled(n: int, thickness: list[float] | None, seed: int = 1) -> np.ndarray:
    w = None if thickness is None else np.array(thickness)
    cells = LatticeCells((1.0, 1.0, 1.0), N_X, N_Y, w)
    return places(filled_cells(n, cells, np.random.default_rng(seed)), cells)


def counts(found: np.ndarray) -> np.ndarray:
    """Filled cells of each column, shape (n_y, n_x); none above an empty one."""
    n = np.zeros((N_Y, N_X), int)
    np.add.at(n, (found[:, 1], found[:, 0]), 1)
    top = np.full((N_Y, N_X), -1)
    np.maximum.at(top, (found[:, 1], found[:, 0]), found[:, 2])
    assert np.array_equal(top + 1, n)
    return n


@pytest.mark.parametrize("n", [0, 1, 59, 60, 61, 400, 420])
def test_an_even_block_differs_by_one_layer_at_most(n: int) -> None:
    found = counts(filled(n, None))
    assert found.sum() == n
    assert np.ptp(found) <= 1
    assert found.min() == n // (N_X * N_Y)


@pytest.mark.parametrize("n", [1, 59, 60, 400, 421])
def test_a_block_with_a_thickness_holds_as_many_grains(n: int) -> None:
    assert counts(filled(n, [1.5, 0.5] * 6)).sum() == n


def test_columns_hold_grains_in_proportion_to_the_thickness() -> None:
    w = 1.0 + 0.4 * np.cos(2.0 * np.pi * (np.arange(N_X) + 0.5) / N_X)
    found = counts(filled(600, w.tolist()))
    assert np.abs(found - 10.0 * w).max() <= 1.5  # of a place: its fraction is at random
    many = np.mean([counts(filled(600, w.tolist(), seed)).mean(axis=0) for seed in range(40)], axis=0)
    assert np.abs(many - 10.0 * w).max() < 0.15


def test_a_column_without_thickness_stays_empty() -> None:
    found = counts(filled(100, [0.0, 1.0, 2.0] * 4))
    assert found[:, ::3].sum() == 0
    assert found.sum() == 100


@pytest.mark.parametrize("thickness", [[0.0] * N_X, [1.0] * 11 + [-0.1]])
def test_a_thickness_that_cannot_be_is_refused(thickness: list[float]) -> None:
    with pytest.raises(ValueError, match="at least 0"):
        filled(10, thickness)
