"""Conversion of a `State` to the block of a checkpoint, and back with all shapes and ids checked.

The restored arrays go to compiled code without bounds checks: an id out of range would corrupt memory.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine, GivesPieces
from ryusa.errors import CheckpointError
from ryusa.model import BodyState, Contacts, EngineBlock, FluidAtGrains, FluidState, Scene, State
from ryusa.model.arrays import Floats
from ryusa.model.contacts import N_EVENT, N_STATE
from ryusa.model.pieces import RowsInPieces
from ryusa.model.tally import N_TERM, PENDING, Tally
from ryusa.model.walls import N_IMPULSE as N_WALL_IMPULSE
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.water.kinds import KINDS

_LATEST = 2**62  # step
_NUMBERS = 64  # of an engine, at most
_FLOAT, _INT, _INT32 = np.dtype(np.float64), np.dtype(np.int64), np.dtype(np.int32)
# arrays left out where all their numbers are zero: of rolling friction, exact timing, Hertz, records, and the
# energy account of a row
_ZERO_UNLESS_USED = {f"contacts/{name}" for name in ("spring_r", "dash_r", "k_n", "overlap", "event")} | {
    "coupling/water/energy"
}
_MOTION = ("x", "v", "omega")  # nan in a state where a grain is not there, zero in a checkpoint
_MOTION_OF_BODIES = ("bodies/x", "bodies/v", "bodies/q", "bodies/momentum")
_AT_ONCE = 1 << 14  # contacts
_EDGE = 1e12  # m; larger coordinates are refused
_LARGEST = 1e100  # in any unit: products of a few such values are still finite


def engine_block(engine: Engine, coupling: FluidState | None) -> CheckpointBlock:
    """The state of an engine, and of its water, as a block; arrays piece by piece where it gives them so."""
    state, rows = engine.state_in_pieces() if isinstance(engine, GivesPieces) else (engine.state(), ())
    return state_block(state if coupling is None else replace(state, coupling=coupling), rows)


def state_block(state: State, rows: tuple[RowsInPieces, ...] = ()) -> CheckpointBlock:
    """A state as a block; nested parts have names with slashes.

    Parameters
    ----------
    rows : arrays that take the place of those in the state.
    """
    values: dict[str, Any] = {}
    arrays: dict[str, np.ndarray] = {}
    _flatten("", state, values, arrays)
    if len(state.present):
        for name in _MOTION:
            arrays[name] = np.where(state.present[:, None], arrays[name], 0.0)
        if state.bodies is not None:
            for name in _MOTION_OF_BODIES:
                arrays[name] = np.where(np.isnan(arrays[name]), 0.0, arrays[name])
    else:
        del arrays["present"]
    for name in (name for one in rows for name in one.names):
        arrays.pop(name, None)
    return CheckpointBlock(values, arrays, rows)


def _flatten(before: str, value: Any, values: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
    for one in fields(value):
        inner, name = getattr(value, one.name), f"{before}{one.name}"
        if name in _ZERO_UNLESS_USED and _only_zeros(inner):
            continue
        if isinstance(inner, np.ndarray):
            arrays[name] = inner
        elif isinstance(inner, Mapping) and all(isinstance(part, np.ndarray) for part in inner.values()):
            arrays.update({f"{name}/{key}": part for key, part in inner.items()})
        elif is_dataclass(inner):
            values[name] = True
            _flatten(f"{name}/", inner, values, arrays)
        else:
            values[name] = inner


def _only_zeros(array: np.ndarray) -> bool:
    """Whether all numbers are zero, and none is minus zero."""
    pieces = (array[k : k + _AT_ONCE] for k in range(0, len(array), _AT_ONCE))
    return not any(piece.any() or np.signbit(piece).any() for piece in pieces)


def state_from_block(block: CheckpointBlock, scene: Scene) -> State:
    """State from a block of a checkpoint, for a scene.

    Raises
    ------
    CheckpointError : it does not match the scene, or is not a valid state.
    """
    try:
        return _Reader(block, scene).state()
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CheckpointError(
            f"the state in the checkpoint is not valid, or of another version ({error})"
        ) from error


class _Reader:
    def __init__(self, block: CheckpointBlock, scene: Scene) -> None:
        self._values, self._arrays, self._scene = block.values, block.arrays, scene
        self._read: set[str] = set()

    def state(self) -> State:
        n, values = self._scene.n_grain, self._values
        step, t = int(values["step"]), float(values["t"])
        if not 0 <= step < _LATEST or not np.isfinite(t):
            raise ValueError(f"step {step}, t = {t}")
        image = self._arrays.get("image", np.zeros((0, 2), _INT32))
        present = np.zeros(0, np.bool_)
        if self._scene.traffic is not None:
            present = self._array("present", (n,), np.dtype(np.bool_))
        x, v, omega = self._positions("x", n), self._floats("v", (n, 3)), self._floats("omega", (n, 3))
        if len(present):
            x, v, omega = (np.where(present[:, None], one, np.nan) for one in (x, v, omega))
        state = State(
            x=x,
            v=v,
            omega=omega,
            present=present,
            step=step,
            t=t,
            image=self._array("image", (len(image) and n, 2), _INT32),
            contacts=self._contacts(),
            tally=self._tally(),
            fluid=self._part(FluidAtGrains, "fluid", {"grain": n}) if values.get("fluid") else None,
            coupling=self._coupling(n) if values.get("coupling") else None,
            bodies=self._bodies(present) if values.get("bodies") else None,
            engine=self._engine(),
        )
        if unknown := sorted(set(self._arrays) - self._read):
            raise ValueError(f"'{unknown[0]}' is unknown to this version of ryusa")
        touched = self._scene.flow is not None and n + self._scene.n_fixed
        if touched and (state.coupling is None) != (state.fluid is None):
            raise ValueError("water without the water at its grains, or the reverse")
        return state

    def _contacts(self) -> Contacts:
        scene = self._scene
        n, last = scene.n_grain, scene.n_partner
        k = len(self._arrays["contacts/i"])
        i, j = (self._array(f"contacts/{name}", (k,), _INT) for name in "ij")
        if k and (i.min() < 0 or i.max() >= n or np.any(j <= i) or j.max() >= last):
            raise ValueError("a contact with an id out of range")
        if len(np.unique(i * np.int64(last) + j)) < k:
            raise ValueError("a contact that occurs twice")
        rows = {name: (k, 3) for name in ("spring_s", "dash_s", "spring_r", "dash_r")}
        rows |= {name: (k,) for name in ("dash_n", "f_n", "eta_n", "k_n", "overlap")}
        found = {name: self._floats(f"contacts/{name}", shape) for name, shape in rows.items()}
        event = np.zeros((k, N_EVENT))
        if "contacts/event" in self._arrays:
            event = self._array("contacts/event", (k, N_EVENT), _FLOAT)
        state = self._array("contacts/state", (k,), _INT)
        if k and not (state.min() >= 1 and state.max() <= N_STATE):
            raise ValueError(f"the state of a contact is not 1 to {N_STATE}")
        return Contacts(i=i, j=j, event=event, state=state, **found)

    def _tally(self) -> Tally | None:
        values = self._values
        if not values.get("tally"):
            return None
        given = {one.name: values[f"tally/{one.name}"] for one in fields(Tally)}
        lengths = {"terms": N_TERM, "pending": len(PENDING), "walls": N_WALL_IMPULSE * self._scene.n_wall}
        found: dict[str, Any] = {}
        for name, value in given.items():
            values = [float(one) for one in (value if name in lengths else [value])]
            if len(values) != lengths.get(name, 1) or not all(abs(one) <= _LARGEST for one in values):
                raise ValueError(f"{name} = {str(value)[:60]} in the energy account")
            found[name] = tuple(values) if name in lengths else values[0]
        for name in ("overlap_grain", "overlap_step", "n_contact"):
            found[name] = int(found[name])
        return Tally(**found)

    def _coupling(self, n: int) -> FluidState:
        if (flow := self._scene.flow) is None:
            raise ValueError("water, but the scene has none")
        found: FluidState = self._part(KINDS[type(flow)].state, "coupling", {**flow.places, "grain": n})
        if not 1 <= found.steps < _LATEST or not int(self._values["step"]) < found.due < _LATEST:
            raise ValueError(f"{found.steps} steps between exchanges, the next at step {found.due}")
        if fault := found.fault(n + self._scene.n_fixed):
            raise ValueError(fault)
        return found

    def _part(self, kind: type[Any], about: str, places: Mapping[Any, int]) -> Any:
        """A part of the state of the water, as `_flatten` has named its numbers, arrays and parts."""
        given: dict[str, Any] = {}
        for name, hint in get_type_hints(kind, include_extras=True).items():
            key = f"{about}/{name}"
            or_none = isinstance(hint, UnionType) or get_origin(hint) is Union
            one = get_args(hint)[0] if or_none else hint
            of, *axes = get_args(one) or (one,)
            shape = tuple(places.get(axis, axis) for axis in axes)
            if or_none and not self._values.get(key) and key not in self._arrays:
                given[name] = None
            elif isinstance(of, type) and is_dataclass(of):
                given[name] = self._part(of, key, places)
            elif of in {int, float}:
                given[name] = of(self._values[key])
            elif name == "x":
                given[name] = self._positions(key, shape[0])
            else:
                given[name] = self._floats(key, shape) if of == Floats else self._array(key, shape, _INT)
        return kind(**given)

    def _bodies(self, present: NDArray[np.bool_]) -> BodyState:
        if (bodies := self._scene.bodies) is None:
            raise ValueError("clumps, but the scene has none")
        n = bodies.n
        motion = {"x": self._positions("bodies/x", n)}
        motion |= {name: self._floats(f"bodies/{name}", (n, 3)) for name in ("v", "momentum")}
        motion["q"] = self._floats("bodies/q", (n, 4))
        if len(present):
            if not np.array_equal(present[bodies.members], np.repeat(present[bodies.first], bodies.count)):
                raise ValueError("a clump of which some members are there and others are not")
            there = present[bodies.first][:, None]
            motion = {name: np.where(there, one, np.nan) for name, one in motion.items()}
        return BodyState(**motion, image=self._array("bodies/image", (n, 2), _INT32))

    def _positions(self, name: str, n: int) -> NDArray[np.float64]:
        x = self._floats(name, (n, 3))
        if n and np.abs(x).max() > _EDGE:
            raise ValueError(f"'{name}' has a grain beyond {_EDGE:g} m")
        return x

    def _floats(self, name: str, shape: tuple[int, ...] | None) -> NDArray[np.float64]:
        if shape is not None and name in _ZERO_UNLESS_USED and name not in self._arrays:
            return np.zeros(shape)
        array = self._array(name, shape, _FLOAT)
        if not np.isfinite(array).all():
            raise ValueError(f"'{name}' holds a number that is not finite")
        if array.size and np.abs(array).max() > _LARGEST:
            raise ValueError(f"'{name}' holds {array.flat[np.abs(array).argmax()]:g}: at most {_LARGEST:g}")
        return array

    def _array(self, name: str, shape: tuple[int, ...] | None, dtype: np.dtype[Any]) -> np.ndarray:
        array = self._arrays[name]
        self._read.add(name)
        if array.dtype != dtype or (shape is not None and array.shape != shape):
            raise ValueError(f"'{name}' is {array.shape} of {array.dtype}, expected {shape} of {dtype}")
        return array

    def _engine(self) -> EngineBlock | None:
        """The block of an engine, which alone knows what its arrays and numbers mean and checks them."""
        values = self._values
        if not values.get("engine"):
            return None
        numbers, start = values["engine/numbers"], "engine/arrays/"
        if not isinstance(numbers, Mapping) or len(numbers) > _NUMBERS:
            raise TypeError("the numbers of an engine are not a table")
        names = [name for name in self._arrays if name.startswith(start)]
        return EngineBlock(
            engine=str(values["engine/engine"]),
            version=int(values["engine/version"]),
            arrays={name.removeprefix(start): self._floats(name, None) for name in names},
            numbers={str(name): float(value) for name, value in numbers.items()},
        )
