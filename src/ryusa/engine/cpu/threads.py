"""The threads of an engine: that of the caller, and those that help it."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import pairwise
from typing import Any


class Threads:
    """Threads that do the same at once.

    Parameters
    ----------
    count : with that of the caller.
    """

    def __init__(self, count: int) -> None:
        if count < 1:
            raise ValueError(f"threads = {count}: at least 1")
        self.count = count
        self._pool = ThreadPoolExecutor(count - 1, thread_name_prefix="ryusa") if count > 1 else None

    def together(self, calls: list[Callable[[], Any]]) -> list[Any]:
        """What the calls return; the first is made by the caller."""
        others: list[Future[Any]] = [self._pool.submit(call) for call in calls[1:]] if self._pool else []
        return [calls[0](), *(other.result() for other in others)]

    def share(self, blocks: int, task: Callable[[int, int], Any]) -> list[Any]:
        """Results of a task for blocks first..last-1, in order, one for each thread that has some."""
        ends = [k * blocks // self.count for k in range(self.count + 1)]
        return self.together([lambda a=a, b=b: task(a, b) for a, b in pairwise(ends) if b > a])
