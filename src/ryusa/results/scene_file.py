"""Scenes as small HDF5 files in parts/; measures need their sizes, masses, laws and water."""

import hashlib
import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, get_origin, get_type_hints

import h5py
import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.families import ContactForce
from ryusa.model import Column, ContactLaw, RollingLaw, Scene, Water
from ryusa.model.scene import ONLY_HERTZ, EventRule
from ryusa.model.traffic import Traffic
from ryusa.results.hdf5 import opened, read_dataset

_TRAFFIC = "traffic"  # left out where a scene has none, so that scenes of earlier versions keep their digest
_LAWS: dict[str, type] = {"contact": ContactLaw, "rolling": RollingLaw, "water": Water, "column": Column}
_ARRAYS = tuple(f.name for f in fields(Scene) if get_origin(f.type) is np.ndarray)
_LIMIT = 1 << 20  # bytes of JSON read from a scene file


def write_scene(file: h5py.File, scene: Scene, step: int, t: float) -> None:
    """Write a scene that is valid from `step` and time `t` [s] into an open HDF5 file."""
    for name in _ARRAYS:
        file.create_dataset(name, data=np.asarray(getattr(scene, name)))
    scalars = _scalars(scene) | {"step": step, "t": t}
    file.create_dataset(
        "scalars", data=np.frombuffer(json.dumps(scalars, default=_plain).encode(), dtype=np.uint8)
    )


def _scalars(scene: Scene) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for f in fields(Scene):
        if f.name not in _ARRAYS:
            value = getattr(scene, f.name)
            if f.name == _TRAFFIC and value is None:
                continue
            found[f.name] = asdict(value) if f.name in {*_LAWS, _TRAFFIC} and value is not None else value
    if scene.contact.force == ContactForce.LINEAR:  # as before there were others: the digest stays
        found["contact"] = {key: one for key, one in found["contact"].items() if key not in ONLY_HERTZ}
    return found


def scene_digest(scene: Scene) -> str:
    """Digest of all numbers of a scene; the same before writing and after reading."""
    digest = hashlib.sha256()
    for name in _ARRAYS:
        array = np.ascontiguousarray(getattr(scene, name))
        digest.update(f"{name} {array.shape} ".encode())
        digest.update(array.astype(np.float64).tobytes())
    digest.update(json.dumps(_even(_scalars(scene)), sort_keys=True).encode())
    return digest.hexdigest()


def _even(value: Any) -> Any:
    """Convert all numbers to floats, so that 0 and 0.0 are equal."""
    if isinstance(value, dict):
        return {str(key): _even(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_even(one) for one in value]
    return value if value is None or isinstance(value, str) else float(value)


def read_scene(path: Path) -> tuple[int, float, Scene]:
    """Read a scene, with the step and the time [s] from which it is valid.

    Raises
    ------
    ResultsError : the file is damaged or does not hold a scene.
    """
    with opened(path) as file:
        arrays = {name: read_dataset(file, name, path) for name in _ARRAYS}
        raw = read_dataset(file, "scalars", path)
    try:
        if raw.dtype != np.uint8 or raw.nbytes > _LIMIT:
            raise ValueError("its scalars are not text")
        scalars = json.loads(raw.tobytes())
        step, t = int(scalars.pop("step")), float(scalars.pop("t"))
        laws = {
            name: _law(kind, raw) for name, kind in _LAWS.items() if (raw := scalars.pop(name)) is not None
        }
        if _TRAFFIC in scalars:
            scalars[_TRAFFIC] = Traffic.from_data(scalars[_TRAFFIC])
        scalars["events"] = EventRule(scalars["events"])
        scalars["groups"] = {str(name): (int(a), int(b)) for name, (a, b) in scalars["groups"].items()}
        for name in ("period", "world_low", "world_high"):
            scalars[name] = tuple(float(value) for value in scalars[name])
        for array in arrays.values():
            array.flags.writeable = False
        scene = Scene(**arrays, **laws, **scalars)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ResultsError(f"{path}: not a scene of ryusa ({error})") from error
    _check_shapes(scene, path)
    return step, t, scene


def _plain(value: np.generic) -> Any:
    return value.item()


def _law(kind: type, raw: dict[str, Any]) -> Any:
    hints = get_type_hints(kind)
    return kind(**{name: hints[name](value) for name, value in raw.items()})


def _check_shapes(scene: Scene, path: Path) -> None:
    n, n_fixed, n_plane = scene.n_grain, scene.n_fixed, scene.n_plane
    wanted = {
        "d": (n,), "m": (n,), "m_added": (n,), "m_weight": (n,), "inertia": (n,), "gravity": (3,),
        "x_fixed": (n_fixed, 3), "d_fixed": (n_fixed,), "fixed_active": (n_fixed,),
        "plane_normal": (n_plane, 3), "plane_point": (n_plane, 3), "plane_active": (n_plane,),
    }  # fmt: skip
    for name, shape in wanted.items():
        got = getattr(scene, name).shape
        if got != shape and not (0 in shape and 0 in got):
            raise ResultsError(f"{path}: {name} has shape {got}, expected {shape}")
