"""A kernel calls a piece by its address."""

from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from ryusa.compiled.function import compiled
from ryusa.compiled.piece import LentType, call, lend, taken


class Arrays(NamedTuple):
    x: Any
    y: Any
    none: Any


def arrays() -> Arrays:
    return Arrays(np.arange(4.0), np.ones((2, 3)), None)


LENT = LentType(numba.typeof(arrays()))
INTEGER, NUMBER = numba.types.int64, numba.types.float64


@compiled()
def double(k, lent):
    held = taken(lent)
    held.x[k] *= 2.0
    if held.none is not None:
        held.x[k] = 0.0


@compiled()
def triple(k, lent):
    held = taken(lent)
    held.x[k] *= 3.0


@compiled()
def sums(k, factor, lent):
    held = taken(lent)
    return k + 1, factor * held.y.sum()


@compiled(nogil=True)
def kernel(one, total, held):
    lent = lend(held)
    for k in range(len(held.x)):
        call(one, (k, lent))
    return call(total, (7, 2, lent))


def test_a_kernel_calls_pieces_and_gets_what_they_return():
    held, total = arrays(), sums.pieces.piece(INTEGER, NUMBER, LENT)
    assert kernel(double.pieces.piece(INTEGER, LENT), total, held) == (8, 12.0)
    assert held.x.tolist() == [0.0, 2.0, 4.0, 6.0]


def test_another_piece_of_the_same_types_does_not_compile_the_kernel_again():
    held, total = arrays(), sums.pieces.piece(INTEGER, NUMBER, LENT)
    kernel(double.pieces.piece(INTEGER, LENT), total, held)
    before = dict(kernel.entry.overloads)
    kernel(triple.pieces.piece(INTEGER, LENT), total, held)
    assert held.x.tolist() == [0.0, 6.0, 12.0, 18.0]
    assert kernel.entry.overloads.keys() == before.keys()


def test_pieces_of_other_types_are_other_types():
    def piece(x):
        return numba.typeof(double.pieces.piece(INTEGER, LentType(numba.typeof(Arrays(x, x, None)))))

    assert piece(np.ones(2)) == piece(np.ones(3))
    assert piece(np.ones(2)) != piece(np.ones(2, np.float32))


def test_a_kernel_that_calls_a_piece_with_other_arguments_does_not_compile():
    @compiled()
    def short(one):
        call(one, (1,))

    @compiled()
    def other(one):
        call(one, (1, 2.0))

    piece = double.pieces.piece(INTEGER, LENT)
    with pytest.raises(TypeError, match="takes 2 arguments"):
        short(piece)
    with pytest.raises(TypeError, match="takes Lent"):
        other(piece)
