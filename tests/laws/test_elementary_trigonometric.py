"""Sine, cosine and arctangent of a root from power series: errors, and vector instructions."""

import re

import numpy as np
import pytest
from tests.laws.test_elementary import answers_of, over

from ryusa.laws import elementary_trigonometric as trigonometric
from ryusa.laws import kick_and_shear

RNG = np.random.default_rng(21)


def root(z):
    return np.sqrt(z.astype(np.clongdouble))


# name: numbers over the whole range of the function, its value, and the largest error allowed
ANGLES, SLOPES = RNG.uniform(-2.0, 2.0, 20_000), RNG.uniform(-0.04, 0.04, 20_000)
RANGES = {
    "cosine_of_root": (ANGLES, lambda z: np.cos(root(z)).real, 5e-16),
    "sine_of_root": (ANGLES, lambda z: (np.sin(root(z)) / root(z)).real, 3e-16),
    "arctan_of_root": (
        SLOPES,
        lambda z: (np.arctan(root(z)) / root(z)).real,
        3e-16,
    ),
}


@pytest.mark.parametrize("name", RANGES)
def test_the_error_is_that_of_a_few_roundings(name):
    z, exact, bound = RANGES[name]
    assert np.abs(answers_of(getattr(trigonometric, name), z) - exact(z)).max() < bound


@pytest.mark.parametrize("zeta", [0.0, 0.12, 0.99, 1.01, 3.0, 12.0])
def test_the_free_response_is_that_of_the_closed_form(zeta):
    a, q = zeta, 1.0 - zeta * zeta
    t = RNG.uniform(0.0, 1.3, 5000)
    w, long = root(np.array([q])), t.astype(np.longdouble)
    g = (np.exp(-a * long) * np.sin(w * long) / w).real
    h = (np.exp(-a * long) * np.cos(w * long)).real - a * g
    found = np.array([kick_and_shear.free_response(one, a, q) for one in t])
    assert np.abs(found[:, 0] - g).max() < 1e-14
    assert np.abs(found[:, 1] - h).max() < 1e-14


@pytest.mark.parametrize("name", [*RANGES, "free_response", "time_of_release"])
def test_a_loop_becomes_vector_instructions_without_a_call(name):
    from numba import njit

    function = getattr(trigonometric, name, None)
    if function is None:
        law = getattr(kick_and_shear, name)

        @njit(forceinline=True, error_model="numpy")
        def function(x):
            return law(x, 0.1, 1.0)[0] if name == "free_response" else law(x, -1.0, 0.1, 1.0, False)

    loop = over(function)
    loop(np.ones(8), np.ones(8))
    (code,) = loop.inspect_llvm().values()
    assert re.search(r"fmul (nsz |contract )*<\d+ x double>", code)
    assert not re.search(r"call .*@\w*(exp|log|sin|cos|tan)\w*\(", code.replace("llvm.", ""))
