"""The reduced mass, radius or inertia of a pair."""

from ryusa.laws._law import law


@law
def reduced(a: float, b: float) -> float:
    """Reduced value of a pair, 1/(1/a + 1/b), in the unit of a and b ([kg], [m], [kg m2]).

    Parameters
    ----------
    a, b : values of the two grains, positive; one of them may be inf, and the result is then the other.

    Notes
    -----
    Source: two bodies on one spring. Bitwise the same with a and b exchanged; nan if either is nan.

    Examples
    --------
    >>> reduced(2.0, 2.0), reduced(2.0, float("inf"))
    (1.0, 2.0)
    """
    a_smaller = a < b
    small = a if a_smaller else b
    large = b if a_smaller else a
    return small / (1.0 + small / large)
