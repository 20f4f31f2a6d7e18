"""The number of lanes of a loop that becomes vector instructions."""

from ryusa.compiled.function import compiled


@compiled(forceinline=True)
def known_lanes(m: int, most: int) -> int:
    """The number m of lanes, 1 to `most`, as an expression that shows the compiler these bounds.

    `most` is a power of two. Only then does it know that a loop never writes one row of a batch into the
    next, and turns the loop into vector instructions. `min(m, most)` shows no least value: whether one was
    found depended on the order of the compiler's passes.
    """
    return ((m - 1) & (most - 1)) + 1
