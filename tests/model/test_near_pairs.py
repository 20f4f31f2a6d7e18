"""Pairs of grains that may touch are found whatever their sizes, with few others."""

import numpy as np
import pytest

from ryusa.model.near_pairs import near_free_pairs, near_pairs


def close(x, d, box, gap):
    """Pairs closer than a gap over the mean of both diameters, by all distances."""
    i, j = np.triu_indices(len(d), 1)
    way = x[j] - x[i]
    way -= np.where(box > 0.0, box * np.round(way / np.where(box > 0.0, box, 1.0)), 0.0)
    near = np.linalg.norm(way, axis=1) < 0.5 * (1.0 + gap) * (d[i] + d[j])
    return set(zip(i[near].tolist(), j[near].tolist(), strict=True))


@pytest.mark.parametrize("smallest", [0.8, 0.3, 0.02])
@pytest.mark.parametrize("box", [(0.0, 0.0, 0.0), (6.0, 5.0, 0.0)])
def test_every_pair_in_touch_is_found_once(smallest, box):
    rng = np.random.default_rng(3)
    d = np.exp(rng.uniform(np.log(smallest), 0.0, 600))
    x, box = rng.uniform(0.0, 5.0, (600, 3)), np.array(box)
    found = near_pairs(x, d, box, share=0.1)
    assert np.all(found[:, 0] < found[:, 1])
    pairs = [tuple(one) for one in found.tolist()]
    assert len(pairs) == len(set(pairs))
    asked = close(x, d, box, 0.1)
    assert len(asked) > 10
    assert asked <= set(pairs)


def test_fine_grains_are_not_held_against_all_within_a_coarse_one():
    """8,000 fine grains beside one as wide as all of them: 2.5e7 pairs are within its diameter."""
    x = np.stack(np.meshgrid(*[np.arange(20.0)] * 3), -1).reshape(-1, 3) * 1.01
    d = np.ones(len(x))
    x, d = np.vstack([x, [[40.0, 10.0, 10.0]]]), np.append(d, 20.0)
    assert len(near_pairs(x, d, np.zeros(3))) < 10 * len(d)


@pytest.mark.parametrize("n", [40, 400])  # compared each with each, and by a tree
@pytest.mark.parametrize("box", [(0.0, 0.0, 0.0), (3.0, 2.5, 0.0)])
def test_pairs_of_free_grains_are_those_of_all_pairs_that_touch(n, box):
    rng = np.random.default_rng(5)
    x, d, box = rng.uniform(0.0, 2.5, (n, 3)), rng.uniform(0.3, 0.6, n), np.array(box)
    free = n // 4
    pairs = [tuple(one) for one in near_free_pairs(x, d, box, free).tolist()]
    assert len(pairs) == len(set(pairs))
    assert all(i < j and i < free for i, j in pairs)
    asked = {(i, j) for i, j in close(x, d, box, 0.0) if i < free}
    assert len(asked) > 5
    assert asked <= set(pairs)
