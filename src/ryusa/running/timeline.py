"""Changes of the scene during a run, and the order of contacts recorded between them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine
from ryusa.errors import CaseError
from ryusa.model import Scene
from ryusa.model.contacts import in_order_of_parting, joined


@dataclass(frozen=True)
class Change:
    """One change of the timeline."""

    at: float  # [s]; falls on the nearest step
    apply: Callable[[Scene], Scene]
    what: str = "scene changed"  # for the log


def refuse_changes(engine: Engine, scene: Scene, changes: Sequence[Change]) -> None:
    """Check a timeline before the first step, for an engine that cannot change everything.

    Raises
    ------
    CaseError : the engine cannot make one of the changes.
    """
    refuses = getattr(engine, "refuses_change", None)
    if refuses is None:
        return
    for change in sorted(changes, key=lambda one: one.at):
        after = change.apply(scene)
        if reasons := refuses(scene, after):
            raise CaseError("engine", engine.name, f"does not support {'; '.join(reasons)}: {change.what}")
        scene = after


def in_order(contacts: Sequence[NDArray[np.void]]) -> NDArray[np.void]:
    """Contacts that ended in a stretch, in an order independent of its division into calls of the engine."""
    return in_order_of_parting(contacts[0] if len(contacts) == 1 else joined(contacts))
