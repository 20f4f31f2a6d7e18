"""Memory and traffic of the CUDA engine by count.

    python benchmarks/card_cost.py [--listed 9 --touching 6]

Memory is that of the arrays the engine allocates; a test compares the sum with those that it has allocated in
numba's simulator. Traffic is what a step asks for, and the least of it, with everything that belongs to a
partner found in the card's caches.
"""

import argparse
import json
from typing import Any, NamedTuple

from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared.variant import KernelVariant
from ryusa.model.contacts import N_EVENT
from ryusa.model.fluid import N_IMPULSE, N_SAMPLED

VARIANTS = {
    "dry": KernelVariant(0, 1, 0, 0, 0, 0, 0, 0),
    "column": KernelVariant(0, 1, 0, 0, 1, 0, 1, 0),
    "exact": KernelVariant(0, 1, 0, 0, 0, 0, 0, 1),
}
_D, _I, _L = 8, 4, 8  # bytes of a double, an int32 and an int64


class Traffic(NamedTuple):
    """Bytes that a step moves for one grain."""

    asked: float  # by its instructions
    least: float  # that cannot come from a cache, if all of a partner's does


def a_pair(variant: KernelVariant) -> int:
    """Bytes of a neighbour in a list: place, state, springs, row of memory."""
    return _I + 1 + _D * (variant.springs + variant.row_width)


def room_of(pairs: int) -> int:
    """Neighbours that a list of so many has room for, when it is first allocated."""
    return max(pairs * 9 // 8, 1)


def memory_of_grains(n: int, n_fixed: int, n_plane: int, variant: KernelVariant) -> int:
    """Bytes on the device that grow with grains: all arrays but the two of pairs."""
    total, solid = n + n_fixed + n_plane, n + n_fixed
    fluid = _D * (N_SAMPLED + N_IMPULSE) * (n if variant.column else 1)
    two_halves = 3 * 2 * 4 * _D * total + 2 * _I * n  # positions, velocities, spins; contacts
    masses = 2 * _D * total + 2 * _D * n + 4 * _D * n  # in the order of cells, and by id
    two_orders = 2 * (_I * solid + 2 * _I * n + fluid)  # ids, images, water
    cells = 3 * _I * (2 * solid + 65) + _I * max(n, n_fixed)
    orders = 2 * _I * n + 2 * _I * max(n_fixed, 1)
    return two_halves + masses + n + two_orders + cells + orders + 3 * _D * n + 2 * _L * (n + 1)


def memory(
    n: int, n_fixed: int, n_plane: int, variant: KernelVariant, room: int, held: int, records: int = 1
) -> int:
    """Bytes on the device but for parameters, walls and sums.

    Parameters
    ----------
    room, held : neighbours that the list has room for, and pairs in contact that are kept while it is
        written anew.
    records : of ended contacts.
    """
    pairs = a_pair(variant) * (room + held)
    return memory_of_grains(n, n_fixed, n_plane, variant) + pairs + _D * N_EVENT * records


def allocated(engine: Any) -> int:
    """Bytes of the arrays that a CUDA engine has on the device, each counted once."""
    found: dict[int, int] = {}
    seen = [*vars(engine).values(), *vars(engine._device).values()]
    while seen:
        one = seen.pop()
        if isinstance(one, tuple):
            seen.extend(one)
        elif hasattr(one, "copy_to_host"):
            found[id(one)] = one.size * one.dtype.itemsize
    return sum(found.values())


def traffic(variant: KernelVariant, listed: float, touching: float) -> Traffic:
    """Bytes a grain and step.

    Parameters
    ----------
    listed, touching : neighbours of a grain in the list, and of those in contact.
    """
    vectors = 2 * 3 * 4 * _D  # read and written
    own = vectors + 4 * _D + 2 * _L + 2 * _I + (_D * (N_SAMPLED + 2 * N_IMPULSE) if variant.column else 0)
    row = 2 * _D * (M.END_ROLLING if variant.rolling else M.WIDTH)
    memory_of_pair = row + _D * variant.springs + 1
    in_list = _I + 1
    asked = own + listed * (in_list + _I + 4 * _D) + touching * (memory_of_pair + 2 * 4 * _D)
    return Traffic(asked, own + listed * in_list + touching * memory_of_pair)


def counted(kind: str, listed: float, touching: float) -> dict[str, Any]:
    """Memory and traffic of one kind of scene, of many grains."""
    variant, many = VARIANTS[kind], 1_000_000
    bytes_a_grain = memory(
        many, 0, 0, variant, room_of(round(listed * many)), room_of(round(0.5 * touching * many))
    )
    moved = traffic(variant, listed, touching)
    return {
        "kind": kind,
        "listed": listed,
        "touching": touching,
        "bytes a grain": round(bytes_a_grain / many),
        "asked a step [B]": round(moved.asked),
        "least a step [B]": round(moved.least),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--listed", type=float, default=9.0, help="neighbours a grain in the list")
    parser.add_argument("--touching", type=float, default=6.0, help="neighbours a grain in contact")
    args = parser.parse_args()
    for kind in VARIANTS:
        print(json.dumps(counted(kind, args.listed, args.touching)))


if __name__ == "__main__":
    main()
