"""exp, log and power from polynomials: errors against 80-bit numbers, limits, and vector instructions."""

import ast
import math
import re
from pathlib import Path

import numpy as np
import pytest
from numba import njit

from ryusa.laws import elementary

RNG = np.random.default_rng(20)
SMALL = 10.0 ** RNG.uniform(-300.0, 0.0, 2000)
MIDDLE = RNG.uniform(-2.0, 2.0, 20_000)
POSITIVE = 10.0 ** RNG.uniform(-307.0, 308.0, 20_000)
AROUND_ONE = np.concatenate([RNG.uniform(0.5, 2.0, 20_000), 1.0 + 10.0 ** RNG.uniform(-15.0, -1.0, 2000)])
# name: numbers over the whole range of the function, and the largest relative error allowed
RANGES = {
    "exp": (np.concatenate([RNG.uniform(-708.0, 709.7, 20_000), MIDDLE, SMALL]), 4e-16),
    "expm1": (np.concatenate([RNG.uniform(-800.0, 709.7, 20_000), MIDDLE, SMALL, -SMALL]), 4e-16),
    "log": (np.concatenate([POSITIVE, AROUND_ONE]), 4e-16),
    "log10": (np.concatenate([POSITIVE, AROUND_ONE]), 6e-16),
    "tanh": (np.concatenate([RNG.uniform(-30.0, 30.0, 20_000), MIDDLE, SMALL, -SMALL]), 1e-15),
}


def over(function):
    """Loop over numbers with one function, as a kernel has it."""

    @njit
    def loop(x, answers):
        for k in range(len(x)):
            answers[k] = function(x[k])

    return loop


def answers_of(function, x):
    answers = np.empty_like(x)
    over(function)(x, answers)
    return answers


@pytest.mark.parametrize("name", RANGES)
def test_the_error_is_that_of_a_few_roundings(name):
    x, bound = RANGES[name]
    exact = getattr(np, name)(x.astype(np.longdouble))
    error = np.abs((answers_of(getattr(elementary, name), x) - exact) / exact)
    assert error.max() < bound, x[error.argmax()]


def test_the_error_of_a_power_grows_with_its_logarithm():
    x, y = 10.0 ** RNG.uniform(-12.0, 12.0, 50_000), RNG.uniform(-20.0, 20.0, 50_000)
    found = np.array([elementary.power(a, b) for a, b in zip(x, y, strict=True)])
    exact = x.astype(np.longdouble) ** y.astype(np.longdouble)
    error = np.abs((found - exact) / exact)
    assert (error / (1.0 + np.abs(y * np.log(x)))).max() < 3e-16
    assert error.max() < 1e-12


@pytest.mark.parametrize("x", [0.0, 5e-324, 1e-310, 2.2250738585072014e-308, math.inf, -math.inf, -1.0])
def test_logarithms_have_the_limits_of_the_library(x):
    with np.errstate(all="ignore"):
        expected = float(np.log(x)), float(np.log10(x))
    assert (elementary.log.entry(x), elementary.log10.entry(x)) == pytest.approx(
        expected, rel=1e-15, nan_ok=True
    )


@pytest.mark.parametrize(
    "x", [0.0, -720.0, -745.0, -745.2, -1e300, 709.4, 709.7, 709.79, 1e300, math.inf, -math.inf]
)
def test_exponentials_have_the_limits_of_the_library(x):
    with np.errstate(all="ignore"):
        expected = float(np.exp(x)), float(np.expm1(x)), float(np.tanh(x))
    found = elementary.exp.entry(x), elementary.expm1.entry(x), elementary.tanh.entry(x)
    assert found == pytest.approx(expected, rel=1e-15, abs=5e-324)


@pytest.mark.parametrize("x", [0.0, 5e-324, 0.5, 1.0, 1e300, math.inf])
@pytest.mark.parametrize("y", [0.0, 0.7, -0.7, 1e300, -1e300, math.inf, -math.inf])
def test_a_power_has_the_limits_of_the_library(x, y):
    if x == 1.0 and math.isinf(y):  # 1 in C; here 0 times infinity, and no law has such an exponent
        assert math.isnan(elementary.power.entry(x, y))
        return
    with np.errstate(all="ignore"):
        expected = float(np.power(x, y))
    assert elementary.power.entry(x, y) == pytest.approx(expected, rel=1e-12, abs=5e-324)


def test_neighbouring_numbers_keep_their_order():
    x = 1.0 + np.arange(1000) * 1e-13
    assert (np.diff(answers_of(elementary.exp, x)) >= 0.0).all()
    assert (np.diff(answers_of(elementary.log, x)) >= 0.0).all()


@pytest.mark.parametrize("name", [*RANGES, "power"])
def test_a_loop_becomes_vector_instructions_without_a_call(name):
    function = getattr(elementary, name)
    if name == "power":

        @njit(forceinline=True)
        def seven_tenths(x):
            return elementary.power(x, 0.7)

        function = seven_tenths
    loop = over(function)
    loop(np.ones(8), np.ones(8))
    (code,) = loop.inspect_llvm().values()
    assert re.search(r"= fmul contract (nsz )?<\d+ x double>|= fmul (nsz )?contract <\d+ x double>", code)
    assert not re.search(r"call .*@\w*(exp|log|pow|tanh)\w*\(", code.replace("llvm.", ""))


@pytest.mark.parametrize("module", ["drag", "hindrance", "immersed", "lift", "torque", "water"])
def test_force_laws_take_exp_log_and_powers_from_here(module):
    text = Path(elementary.__file__).with_name(f"{module}.py").read_text(encoding="utf-8")
    called = {ast.unparse(node.func) for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)}
    assert not called & {f"math.{name}" for name in ("exp", "expm1", "log", "log10", "log1p", "pow", "tanh")}
    powers = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow)
    ]
    assert all(isinstance(one.right, ast.Constant) and type(one.right.value) is int for one in powers)
