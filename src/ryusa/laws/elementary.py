"""Exponential, logarithm and power without branch, table or library call.

A loop over grains that calls them becomes vector instructions, which the functions of the C library prevent.
All laws evaluated for every grain or contact in every step take these functions from here. The relative error
is below 4e-16 for `exp` and `expm1`, `log` and `log10`, and 1e-15 for `tanh`; that of `power` is given with
it. Where the result is smaller than 2.2e-308 (subnormal), the absolute error is below 5e-324 instead. The
limits (0, infinity, not a number) are those of IEEE 754; the sign of zero is not kept.

Rounding to an integer and powers of two work on the bits of the double: 1.5 * 2**52 added to a number of
magnitude below 2**51 leaves its nearest integer in the lowest bits, and a biased exponent shifted by 52 bits
is a power of two. No compiler flag that reorders sums may be used here: it would cancel the added number.
"""

import math

import numpy as np

from ryusa.laws._law import step_law, step_law_of_bits

ROUNDER = 1.5 * 2.0**52
ROUNDER_BITS = 0x4338000000000000
BIAS = 1023  # of the exponent of a double
LN2_HIGH = float.fromhex("0x1.62e42feep-1")  # times an exponent it is exact
LN2_LOW = float.fromhex("0x1.a39ef35793c76p-33")
PER_LN2 = 1.0 / math.log(2.0)
PER_LN10 = 1.0 / math.log(10.0)
NORMAL = 2.0**-1022  # the smallest number with all its bits
ROOT_HALF_BITS = 0x3FE6A09E667F3BCD  # sqrt(1/2)
# exp and expm1 are 0 and -1 below the first, infinite above the second
UNDERFLOW, OVERFLOW = -746.0, 710.0


def _power(x: float, y: float) -> float:
    return math.pow(x, y) if x >= 0.0 or y == 0.0 else math.nan  # of a negative number math has some


@step_law
def exp_parts(x: float) -> tuple[float, float, float, float]:
    """Factors of exp(x) [-]: exp(x) = (1 + q) a b with powers of two a and b, none out of range.

    Parameters
    ----------
    x : exponent [-].

    Returns
    -------
    q : exp(r) - 1 for the remainder r of x, abs(r) <= ln(2)/2.
    a, b : powers of two; 1 for abs(x) < ln(2)/2.
    per_b : 1/b.

    Notes
    -----
    Source: Taylor series of exp(r) - 1 to r**13, truncated below 5e-18.

    >>> [float(part) for part in exp_parts(0.0)]
    [0.0, 1.0, 1.0, 1.0]
    """
    x = UNDERFLOW if x < UNDERFLOW else x
    x = OVERFLOW if x > OVERFLOW else x
    rounded = x * PER_LN2 + ROUNDER
    whole = rounded - ROUNDER
    r = (x - whole * LN2_HIGH) - whole * LN2_LOW
    tail = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0)
    tail = 1.0 / 3628800.0 + r * (1.0 / 39916800.0 + r * tail)
    tail = 1.0 / 40320.0 + r * (1.0 / 362880.0 + r * tail)
    tail = 1.0 / 720.0 + r * (1.0 / 5040.0 + r * tail)
    tail = 1.0 / 24.0 + r * (1.0 / 120.0 + r * tail)
    q = r + r * r * (0.5 + r * (1.0 / 6.0 + r * tail))
    n = np.float64(rounded).view(np.int64) - ROUNDER_BITS
    half = n >> 1
    a = np.int64((n - half + BIAS) << 52).view(np.float64)
    b = np.int64((half + BIAS) << 52).view(np.float64)
    return q, a, b, np.int64((BIAS - half) << 52).view(np.float64)


@step_law_of_bits(math.exp)
def exp(x: float) -> float:
    """Exponential [-]; 0 below -745.2, inf above 709.8.

    >>> exp(0.0), round(exp(1.0), 12), exp(-math.inf), exp(1000.0)
    (1.0, 2.718281828459, 0.0, inf)
    """
    q, a, b, _ = exp_parts(x)
    return (a + a * q) * b


@step_law_of_bits(math.expm1)
def expm1(x: float) -> float:
    """exp(x) - 1 [-], accurate for small x; inf above 709.8.

    >>> expm1(1.0e-20), expm1(-1000.0)
    (1e-20, -1.0)
    """
    q, a, b, per_b = exp_parts(x)
    return (a * q + (a - per_b)) * b


@step_law_of_bits(math.tanh)
def tanh(x: float) -> float:
    """Hyperbolic tangent [-].

    >>> tanh(1.0e-20), round(tanh(0.5), 12), tanh(-1000.0)
    (1e-20, 0.46211715726, -1.0)
    """
    grown = expm1(2.0 * math.fabs(x))
    return math.copysign(1.0 if grown > 1.0e30 else grown / (grown + 2.0), x)


@step_law_of_bits(math.log)
def log(x: float) -> float:
    """Natural logarithm [-]; -inf at 0, nan below, inf at inf.

    Notes
    -----
    Source: x = 2**e m with m between sqrt(1/2) and sqrt(2); ln(m) = 2 atanh(s), s = (m - 1)/(m + 1), by its
    Taylor series to s**21, truncated below 3e-17, arranged so that m - 1 is the leading term.

    >>> log(1.0), round(log(10.0), 12), log(0.0)
    (0.0, 2.302585092994, -inf)
    """
    tiny = x < NORMAL
    bits = np.float64(x * 2.0**54 if tiny else x).view(np.int64)
    e = (bits - ROOT_HALF_BITS) >> 52
    f = np.int64(bits - (e << 52)).view(np.float64) - 1.0
    exponent = np.int64(e + ROUNDER_BITS).view(np.float64) - (ROUNDER + 54.0 if tiny else ROUNDER)
    s = f / (2.0 + f)
    z = s * s
    tail = 2.0 / 17.0 + z * (2.0 / 19.0 + z * (2.0 / 21.0))
    tail = 2.0 / 13.0 + z * (2.0 / 15.0 + z * tail)
    tail = 2.0 / 9.0 + z * (2.0 / 11.0 + z * tail)
    tail = z * (2.0 / 3.0 + z * (2.0 / 5.0 + z * (2.0 / 7.0 + z * tail)))
    found = exponent * LN2_HIGH + (f - (s * (f - tail) - exponent * LN2_LOW))
    found = -math.inf if x == 0.0 else found
    found = math.nan if x < 0.0 else found
    return found if x < math.inf else x


@step_law_of_bits(math.log10)
def log10(x: float) -> float:
    """Logarithm to base 10 [-]; -inf at 0, nan below, inf at inf.

    >>> log10(1.0), round(log10(1000.0), 14), log10(0.0)
    (0.0, 3.0, -inf)
    """
    return log(x) * PER_LN10


@step_law_of_bits(_power)
def power(x: float, y: float) -> float:
    """x**y [-] for x >= 0; nan for x < 0 unless y = 0.

    Parameters
    ----------
    x : base [-].
    y : exponent [-].

    Notes
    -----
    Source: exp(y ln x). The relative error is below 3e-16 (1 + abs(y ln x)): 3e-15 for 10**4 to the
    power 0.7, 2e-13 at the limits of the range.

    >>> power(4.0, 0.5), power(0.0, 0.7), power(0.0, -0.7), power(0.0, 0.0), round(power(2.0, 10.0), 9)
    (2.0, 0.0, inf, 1.0, 1024.0)
    """
    return 1.0 if y == 0.0 else exp(y * log(x))
