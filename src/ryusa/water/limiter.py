"""Slope limiter of what flows along a row."""

from ryusa.water._kernel import kernel


@kernel
def limited(before: float, after: float) -> float:
    """Slope limiter of van Leer: twice the harmonic mean of two differences, 0 at an extremum.

    >>> limited(1.0, 3.0), limited(-1.0, 3.0)
    (1.5, 0.0)
    """
    product = before * after
    return 2.0 * product / (before + after) if product > 0.0 else 0.0
