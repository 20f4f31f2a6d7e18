"""The levels of the suite: what `make test` may compile, and what it says of the rest."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.kernel_variants import QUICK, confined, refusal, words

from ryusa.engine.shared.variant import KernelVariant

OTHER = KernelVariant(*(1,) * len(KernelVariant._fields))


@pytest.fixture
def make() -> Callable[[KernelVariant], Any]:
    return confined(words)


def test_the_quick_level_has_at_most_a_dozen_kernels_and_says_what_each_is_for():
    assert len(QUICK) <= 12
    assert all(QUICK.values())
    assert len(set(QUICK.values())) == len(QUICK)


def test_together_they_have_every_feature_but_films():
    columns = dict(zip(KernelVariant._fields, zip(*QUICK, strict=True), strict=True))
    assert [name for name, values in columns.items() if not any(values)] == ["film"]  # a golden has one
    assert [name for name, values in columns.items() if all(values)] == []


def test_the_kernels_of_the_quick_level_are_made(make):
    for variant in QUICK:
        assert make(variant) == words(variant)


def test_another_kernel_fails_the_test_with_its_features_and_its_level(make):
    with pytest.raises(pytest.fail.Exception) as failed:
        make(OTHER)
    said = str(failed.value)
    assert said == refusal(OTHER)
    for word in (str(tuple(OTHER)), *KernelVariant._fields, "@pytest.mark.full", "make test-all"):
        assert word in said
