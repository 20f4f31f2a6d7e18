"""Settings of a study by a space-filling design."""

from collections import Counter
from itertools import combinations

import pytest

from ryusa.study import Design, Factor


def factor(name, n):
    return Factor(name, {str(k): ({} if k == 0 else {f"key.{name}": str(k)}) for k in range(n)})


MANY = Design(tuple(factor(name, n) for name, n in zip("abcdefg", (2, 2, 2, 3, 3, 4, 4), strict=True)))


@pytest.mark.parametrize("n", [16, 32, 64])
def test_levels_are_used_equally_often_and_pairs_of_levels_nearly_so(n):
    first, *others = MANY.settings(n)
    assert first == MANY.base == dict.fromkeys("abcdefg", "0")
    for name, levels in MANY.levels.items():
        used = Counter(one[name] for one in others)
        assert set(used) == set(levels)
        assert max(used.values()) - min(used.values()) <= n // 16 + 1
    for one, other in combinations("abcdefg", 2):
        pairs = Counter((each[one], each[other]) for each in others)
        cells = len(MANY.levels[one]) * len(MANY.levels[other])
        assert max(pairs.values()) <= max(2.5 * n / cells, 3.0)
        assert len(pairs) > 0.5 * cells


def test_settings_do_not_repeat_and_a_larger_design_contains_a_smaller_one():
    small, large = MANY.settings(16), MANY.settings(64)
    assert len({tuple(one.items()) for one in large}) == len(large)
    assert large[: len(small)] == small
    assert MANY.settings(16) == small


def test_few_combinations_are_all_tried_the_one_as_shipped_first():
    sets = Design((factor("a", 2), factor("b", 3))).settings(16)
    assert len(sets) == 6
    assert sets[0] == {"a": "0", "b": "0"}


def test_a_number_of_settings_that_is_neither_one_block_nor_whole_blocks_is_refused():
    with pytest.raises(ValueError, match="n = 24 must be at most 16 or a multiple of it"):
        MANY.settings(24)
    assert MANY.settings(0) == [MANY.base]
    assert len(MANY.settings(8)) == 9


def test_a_setting_changes_the_keys_of_its_levels_alone():
    assert MANY.overrides(MANY.base) == {}
    assert MANY.overrides({**MANY.base, "d": "2", "no factor": "x"}) == {"key.d": "2"}


def test_the_level_as_shipped_stays_first_among_some_levels():
    assert list(factor("a", 4).only("3", "0", "2").levels) == ["0", "3", "2"]
