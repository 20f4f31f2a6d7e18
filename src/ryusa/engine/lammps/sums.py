"""Sums and extremes over ranks, as the column of water needs them (water.processes)."""

from typing import Any

from ryusa.model.arrays import Floats


class RankSums:
    """The ranks that share the grains.

    MPI requires that all ranks receive identical results of an Allreduce, so that the columns of all ranks
    keep the same bits.
    """

    def __init__(self, comm: Any) -> None:
        from mpi4py import MPI

        self._comm, self._here = comm, MPI.IN_PLACE
        self._sum, self._max = MPI.SUM, MPI.MAX
        self.rank, self.n = int(comm.Get_rank()), int(comm.Get_size())

    def add(self, values: Floats) -> None:
        """Put the sum over all ranks in place of the values."""
        self._comm.Allreduce(self._here, values, self._sum)

    def largest(self, values: Floats) -> None:
        """Put the largest of all ranks in place of each value."""
        self._comm.Allreduce(self._here, values, self._max)
