"""Frames and contacts that a checkpoint holds because they were in no part yet."""

from pathlib import Path
from typing import Any

import numpy as np

from ryusa.errors import CheckpointError
from ryusa.model import EVENT, PASSAGE, Scene
from ryusa.model.walls import N_IMPULSE
from ryusa.results import schema
from ryusa.running.checkpoint import CheckpointBlock

_FLOAT = np.dtype(np.float64)


def buffered_frames(recorder: CheckpointBlock, scene: Scene, folder: Path) -> dict[str, np.ndarray]:
    """Data that was buffered and not in a part, every shape checked.

    Raises
    ------
    CheckpointError : it does not match the run.
    """
    if not recorder.arrays:
        return {}
    rows = recorder.arrays
    try:
        k = len(rows["t"])
        shapes: dict[str, tuple[tuple[int, ...], np.dtype[Any]]] = {
            name: ((k, scene.n_grain, *tail) if name in schema.PER_GRAIN else (k,), dtype)
            for name, (dtype, tail) in schema.FRAME_DATASETS.items()
        }
        shapes |= {"tally": ((k,), schema.TALLY), "contacts": ((len(rows["contacts"]),), EVENT)}
        if scene.flow is not None and k:
            of_water = scene.flow.frame_shapes()
            shapes |= {f"{scene.flow.GROUP}/{name}": ((k, *tail), _FLOAT) for name, tail in of_water.items()}
        if scene.forces:
            n_force = rows[schema.N_FORCE].sum() if schema.N_FORCE in rows else 0
            shapes |= {schema.N_FORCE: ((k,), np.dtype(np.int64)), schema.FORCES: ((n_force,), schema.FORCE)}
        if scene.traffic is not None:
            n_passage = len(rows[schema.PASSAGES]) if schema.PASSAGES in rows else 0
            shapes[schema.PASSAGES] = ((n_passage,), PASSAGE)
        if scene.n_wall:
            shapes[schema.WALLS] = ((k, scene.n_wall, N_IMPULSE), _FLOAT)
        if scene.bodies is not None:
            for name, (dtype, tail) in schema.BODY_DATASETS.items():
                shapes[name] = ((k, scene.bodies.n, *tail), dtype)
        if scene.has_servo:
            shapes[schema.TRAVEL] = ((k, scene.n_wall), _FLOAT)
        if set(shapes) != set(rows):
            raise ValueError(f"datasets {', '.join(sorted(rows))}")
        for name, (shape, dtype) in shapes.items():
            if rows[name].shape != shape or rows[name].dtype != dtype:
                raise ValueError(f"'{name}' is {rows[name].shape} of {rows[name].dtype}")
    except (KeyError, ValueError, TypeError) as error:
        raise CheckpointError(
            f"{folder}: the buffered frames in the checkpoint do not match the run ({error})"
        ) from error
    return rows
