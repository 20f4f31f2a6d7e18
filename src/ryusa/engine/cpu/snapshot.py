"""A snapshot piece by piece, straight from the arrays of the engine.

A whole one takes 100 bytes a grain and 180 a contact beside them.
"""

import dataclasses
from collections.abc import Iterator

import numpy as np

from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.contact_rows import has_short_rows, lengthened
from ryusa.engine.cpu.prune import copy_rows_out
from ryusa.engine.cpu.verlet_list import room_for_memory
from ryusa.engine.shared.contact_memory import ContactMemory, contacts_of
from ryusa.engine.shared.variant import KernelVariant
from ryusa.model import Contacts
from ryusa.model.pieces import RowsInPieces
from ryusa.model.scene import Floats

_AT_ONCE = 1 << 13  # grains or candidate pairs


def place_by_id(ids: np.ndarray, n: int) -> np.ndarray:
    """Place of each of n free grains, int32."""
    place = np.empty(n, np.int32)
    place[ids[:n]] = np.arange(n, dtype=np.int32)
    return place


def grain_rows(grains: GrainArrays, n: int, x_listed: Floats, column: bool) -> RowsInPieces:
    """What a snapshot holds of each free grain, in the order of ids."""
    place, names = place_by_id(grains.ids, n), ("x", "v", "omega", "image", "engine/arrays/x_listed")
    arrays = (grains.x[:, :3], grains.v[:, :3], grains.w[:, :3], grains.image, x_listed)
    if column:
        names, arrays = (*names, "fluid/sampled", "fluid/impulse"), (*arrays, grains.fluid, grains.impulse)

    def pieces() -> Iterator[dict[str, np.ndarray]]:
        for begin in range(0, max(n, 1), _AT_ONCE):
            some = place[begin : begin + _AT_ONCE]
            yield {name: one[some] for name, one in zip(names, arrays, strict=True)}

    return RowsInPieces(names, n, pieces)


def contact_rows(
    n: int, ids: np.ndarray, candidates: CandidateArrays, count: int, variant: KernelVariant
) -> RowsInPieces:
    """The contacts of a snapshot, in list order, without arrays that are zero where a law is not used.

    Parameters
    ----------
    n, ids : free grains, and the id of each place.
    count : contacts.
    """
    used = {
        "spring_r": variant.rolling, "dash_r": variant.rolling, "k_n": variant.exact,
        "overlap": variant.hertz, "event": variant.events,
    }  # fmt: skip
    fields = [one.name for one in dataclasses.fields(Contacts) if used.get(one.name, True)]

    def piece_of(memory: ContactMemory) -> dict[str, np.ndarray]:
        contacts = contacts_of(lengthened(memory) if has_short_rows(variant) else memory, variant)
        return {f"contacts/{name}": getattr(contacts, name) for name in fields}

    def pieces() -> Iterator[dict[str, np.ndarray]]:
        room = room_for_memory(_AT_ONCE, candidates)
        if not count:
            yield piece_of(room.first(0))
        for b, (first, length) in enumerate(zip(candidates.first[:-1], candidates.count, strict=True)):
            for k in range(first, first + length, _AT_ONCE):
                found = copy_rows_out(b, b + 1, k, k + _AT_ONCE, n, candidates, ids, *room)
                yield piece_of(room.first(found))

    return RowsInPieces(tuple(f"contacts/{name}" for name in fields), count, pieces)
