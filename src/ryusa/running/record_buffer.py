"""What a run has recorded and not yet written: frames, contacts that ended, forces, water."""

from collections.abc import Mapping, Sequence
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ryusa.model import EVENT, PASSAGE, Scene, State, Tally
from ryusa.model.contacts import joined
from ryusa.model.walls import N_IMPULSE
from ryusa.results import schema
from ryusa.running.contact_forces import contact_forces
from ryusa.water.protocol import Fluid

_FIRST_ROOM = 16  # frames
# Contacts in a delivery, from which it is written as it is; a call of HDF5 takes as long as to copy these.
_MANY_CONTACTS = 1000


def bytes_per_frame(n_grain: int) -> int:
    """Disk space of one frame [B]."""
    per_grain = sum(dtype.itemsize * tail[0] for dtype, tail in schema.FRAME_DATASETS.values() if tail)
    return n_grain * per_grain + schema.TALLY.itemsize + 24


class RecordBuffer:
    """Frames and contacts in memory, by dataset of a part.

    Attributes
    ----------
    n_frame, n_contact : in the buffer.
    """

    def __init__(self, scene: Scene) -> None:
        self.n_frame = self.n_contact = 0
        self._scene = scene
        self._frames = self._room(_FIRST_ROOM)
        self._tally: list[tuple[float, ...]] = []
        self._contacts: list[NDArray[np.void]] = []
        self._forces: list[NDArray[np.void]] | None = [] if scene.forces else None  # of each frame
        self._passages: list[NDArray[np.void]] | None = None if scene.traffic is None else []
        self._water: dict[str, list[NDArray[np.float64]]] = {}
        self._bodies: dict[str, list[NDArray[Any]]] = {}  # motion of clumps at each frame
        self._walls: list[NDArray[np.float64]] = []  # impulses on them up to each frame
        self._travel: list[NDArray[np.float64]] = []  # of those that servos press, up to each frame

    def __bool__(self) -> bool:
        return self.n_frame > 0 or self.n_contact > 0 or any(len(one) for one in self._passages or ())

    @property
    def nbytes(self) -> int:
        """Size of the content [B]."""
        forces = sum(one.nbytes for one in self._forces or ())
        frames = self.n_frame * bytes_per_frame(self._scene.n_grain)
        for held in (self._bodies, self._water):
            frames += sum(one.nbytes for rows in held.values() for one in rows)
        passages = sum(one.nbytes for one in self._passages or ())
        return frames + forces + passages + self.n_contact * EVENT.itemsize

    def frame(
        self,
        state: State,
        tally: Tally,
        water: Fluid | None,
        travel: NDArray[np.float64] | None,
        placed: Scene | None,
    ) -> None:
        """Add a frame, as copies of its arrays; parameters as for `Recorder.frame`."""
        if water is not None:
            for name, one in water.frame().items():
                self._water.setdefault(name, []).append(one)
        self._make_room(1)
        row, k = self._frames, self.n_frame
        row["t"][k], row["step"][k] = state.t, state.step
        row["x"][k], row["v"][k], row["omega"][k] = state.x, state.v, state.omega
        row["image"][k] = state.image if len(state.image) else 0
        if self._forces is not None:
            self._forces.append(contact_forces(state, placed or self._scene))
        if state.bodies is not None:
            for name in schema.BODY_DATASETS:
                moved = getattr(state.bodies, name.removeprefix("bodies/"))
                self._bodies.setdefault(name, []).append(np.array(moved))
        self._tally.append(schema.tally_row(tally))
        if n_wall := self._scene.n_wall:
            so_far = tally.walls or (0.0,) * (n_wall * N_IMPULSE)
            self._walls.append(np.array(so_far).reshape(n_wall, N_IMPULSE))
            if self._scene.has_servo:
                self._travel.append(np.zeros(n_wall) if travel is None else np.array(travel))
        self.n_frame += 1

    def contacts(self, events: NDArray[np.void]) -> None:
        """Add contacts that ended, dtype model.EVENT; the array is kept, not copied."""
        if len(events):
            self._contacts.append(events)
            self.n_contact += len(events)

    def passages(self, rows: NDArray[np.void]) -> None:
        """Add grains that entered or left, dtype PASSAGE, in order of time."""
        assert self._passages is not None
        self._passages.append(rows)

    def rows(self) -> dict[str, NDArray[Any]]:
        """Content by dataset of a part."""
        return self._rows(self._contacts)

    def _rows(self, contacts: Sequence[NDArray[np.void]]) -> dict[str, NDArray[Any]]:
        rows: dict[str, NDArray[Any]] = {name: rows[: self.n_frame] for name, rows in self._frames.items()}
        rows["tally"] = np.array(self._tally, dtype=schema.TALLY)
        rows["contacts"] = joined(contacts)
        if self._forces is not None:
            rows[schema.N_FORCE] = np.array([len(one) for one in self._forces], dtype=np.int64)
            rows[schema.FORCES] = np.concatenate([np.zeros(0, dtype=schema.FORCE), *self._forces])
        if self._passages is not None:
            rows[schema.PASSAGES] = np.concatenate([np.zeros(0, dtype=PASSAGE), *self._passages])
        if self._scene.n_wall:
            rows[schema.WALLS] = np.array(self._walls).reshape(self.n_frame, self._scene.n_wall, N_IMPULSE)
        if self._scene.has_servo:
            rows[schema.TRAVEL] = np.array(self._travel).reshape(self.n_frame, self._scene.n_wall)
        if self._scene.bodies is not None:
            for name, (dtype, tail) in schema.BODY_DATASETS.items():
                shape = (self.n_frame, self._scene.bodies.n, *tail)
                rows[name] = np.array(self._bodies.get(name, ()), dtype).reshape(shape)
        if (flow := self._scene.flow) is not None:
            rows |= {f"{flow.GROUP}/{name}": np.array(one) for name, one in self._water.items()}
        return rows

    def write(self, file: h5py.File) -> None:
        """Write the datasets of a part; many contacts as they were delivered, without a copy."""
        in_pieces = self.n_contact > _MANY_CONTACTS * len(self._contacts)
        for name, rows in self._rows(() if in_pieces else self._contacts).items():
            if name != "contacts" or not in_pieces:
                file.create_dataset(name, data=rows)
        if in_pieces:
            contacts, begin = file.create_dataset("contacts", (self.n_contact,), EVENT), 0
            for piece in self._contacts:
                contacts[begin : begin + len(piece)] = piece
                begin += len(piece)
        if (flow := self._scene.flow) is not None and self.n_frame:
            for name, field in flow.fields().items():
                file[f"{flow.GROUP}/{name}"].attrs.update(unit=field.unit, axes=("frame", *field.at))

    def extend(self, rows: Mapping[str, NDArray[Any]]) -> None:
        """Add the content of another buffer, as its `rows` give it."""
        count = len(rows["t"])
        self._make_room(count)
        for name, mine in self._frames.items():
            mine[self.n_frame : self.n_frame + count] = rows[name]
        self.n_frame += count
        self._tally += rows["tally"].tolist()
        self.contacts(rows["contacts"])
        if self._forces is not None and count:
            self._forces += np.split(rows[schema.FORCES], np.cumsum(rows[schema.N_FORCE])[:-1])
        if self._passages is not None:
            self._passages.append(rows[schema.PASSAGES])
        self._walls += list(rows.get(schema.WALLS, ()))
        self._travel += list(rows.get(schema.TRAVEL, ()))
        for name in schema.BODY_DATASETS:
            if name in rows:
                self._bodies.setdefault(name, []).extend(rows[name])
        if (flow := self._scene.flow) is not None:
            for name in flow.frame_shapes():
                self._water.setdefault(name, []).extend(rows.get(f"{flow.GROUP}/{name}", ()))

    def _room(self, k: int) -> dict[str, NDArray[Any]]:
        n = self._scene.n_grain
        return {
            name: np.zeros((k, n, *tail) if name in schema.PER_GRAIN else (k,), dtype=dtype)
            for name, (dtype, tail) in schema.FRAME_DATASETS.items()
        }

    def _make_room(self, count: int) -> None:
        room = len(self._frames["t"])
        if self.n_frame + count <= room:
            return
        wider = self._room(max(2 * room, self.n_frame + count))
        for name, rows in self._frames.items():
            wider[name][: self.n_frame] = rows[: self.n_frame]
        self._frames = wider
