"""What a column needs of the processes that share its grains: sums and extremes over all of them."""

from typing import Protocol

from ryusa.model.scene import Floats


class SharingProcesses(Protocol):
    """Processes of which each holds a part of the grains, and all hold the same column.

    Attributes
    ----------
    rank, n : number of this process, from 0, and number of processes.
    """

    rank: int
    n: int

    def add(self, values: Floats) -> None:
        """Put the sum over all processes in place of the values; the same bits in each."""
        ...

    def largest(self, values: Floats) -> None:
        """Put the largest of all processes in place of each value."""
        ...
