"""Scenes as small HDF5 files in parts/; measures need their sizes, masses, laws and water."""

import hashlib
import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, get_origin

import h5py
import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.laws.families import Adhesion, ContactForce
from ryusa.model import ContactLaw, FaceKind, Materials, RigidBodies, RollingLaw, Scene, Walls, Water
from ryusa.model.feeds import NONE, Arrivals, Traffic
from ryusa.model.scene import ONLY_ADHESIVE, ONLY_HERTZ, EventRule
from ryusa.model.walls import N_MOTION, N_RIGID, N_SERVO
from ryusa.results.flow_file import FLOW_ARRAYS, ROW, flow_arrays, flow_from, flow_scalars, numbers_of
from ryusa.results.hdf5 import opened, read_dataset

# Left out where a scene has none: digests of earlier versions stay.
_TRAFFIC, _MATERIALS = "traffic", "materials"
_BODIES = "bodies"
_ARRIVALS = "arrivals"
_OF_ARRIVALS = tuple(f.name for f in fields(Arrivals) if f.name != "feed")
_OF_BODIES = tuple(f.name for f in fields(RigidBodies) if f.name != "names")
_LAWS: dict[str, type] = {"contact": ContactLaw, "rolling": RollingLaw, "water": Water}
# Fields that scenes of earlier versions had not: left out at their default, so that digests stay.
_LATER = {"rolling": ("twisting",), "water": ("drag_of_form",)}
# `NDArray` is a name of its own from numpy 2.5 on, before a short form of np.ndarray
_ARRAYS = tuple(f.name for f in fields(Scene) if get_origin(f.type) in (np.ndarray, NDArray))
_WALLS = tuple(f.name for f in fields(Walls) if f.name != "names")  # datasets of the group "walls"
_LIMIT = 1 << 20  # bytes of JSON read from a scene file


def write_scene(file: h5py.File, scene: Scene, step: int, t: float) -> None:
    """Write a scene that is valid from `step` and time `t` [s] into an open HDF5 file."""
    for name in _ARRAYS:
        file.create_dataset(name, data=np.asarray(getattr(scene, name)))
    if scene.walls is not None:
        for name in _datasets_of(scene.walls):
            file.create_dataset(f"walls/{name}", data=_array_of_walls(scene.walls, name))
    if scene.materials is not None:
        file.create_dataset(f"{_MATERIALS}/of", data=scene.materials.of)
    for name in _datasets_of_bodies(scene.bodies):
        file.create_dataset(f"{_BODIES}/{name}", data=getattr(scene.bodies, name))
    for name, array in flow_arrays(scene.flow).items():
        file.create_dataset(f"{ROW}/{name}", data=array)
    for name, array in _arrays_of_arrivals(scene.traffic).items():
        file.create_dataset(f"{_ARRIVALS}/{name}", data=array)
    scalars = _scalars(scene) | {"step": step, "t": t}
    file.create_dataset(
        "scalars", data=np.frombuffer(json.dumps(scalars, default=_plain).encode(), dtype=np.uint8)
    )


def _scalars(scene: Scene) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for f in fields(Scene):
        if f.name not in _ARRAYS:
            value = getattr(scene, f.name)
            if f.name == "flow":
                found |= flow_scalars(value)
                continue
            if f.name in {_TRAFFIC, _MATERIALS, _BODIES} and value is None:
                continue
            if f.name == _BODIES:  # its arrays are datasets
                found[_BODIES] = list(value.names)
                continue
            law = f.name in {*_LAWS, _TRAFFIC, _MATERIALS}
            found[f.name] = asdict(value) if law and value is not None else value
    if _MATERIALS in found:  # an array of its own
        del found[_MATERIALS]["of"]
    for law, names in _LATER.items():
        default = {one.name: one.default for one in fields(_LAWS[law])}
        for one in _each(found, law):
            for name in names:
                if one[name] == default[name]:
                    del one[name]
    if scene.contact.force == ContactForce.LINEAR:  # as before there were others: the digest stays
        found["contact"] = {key: one for key, one in found["contact"].items() if key not in ONLY_HERTZ}
    for one in _each(found, "contact"):
        if one["adhesion"] == Adhesion.NONE:  # as before there was any
            for key in ONLY_ADHESIVE:
                del one[key]
    for one in (*found.get(_TRAFFIC, {}).get("feeds", ()), *found.get(_TRAFFIC, {}).get("exits", ())):
        if one["wall"] == NONE:  # as before any moved with a wall: the digest stays
            del one["wall"]
    if (arrivals := found.get(_TRAFFIC, {}).pop(_ARRIVALS, None)) is not None:
        found[_TRAFFIC][_ARRIVALS] = arrivals["feed"]  # its arrays are datasets
    walls: Walls | None = found.pop("walls")
    return found if walls is None else found | {"walls": list(walls.names)}


def _each(found: dict[str, Any], law: str) -> list[dict[str, Any]]:
    """The law of a scene, and those of each two of its materials."""
    return [found[law], *found.get(_MATERIALS, {}).get(law, ())]


def _datasets_of(walls: Walls) -> tuple[str, ...]:
    """Arrays of walls; servos where there are some, so that other scenes keep their digest."""
    return _WALLS if len(walls.servo) else tuple(name for name in _WALLS if name != "servo")


def _array_of_walls(walls: Walls | None, name: str) -> np.ndarray:
    """An array of walls as it is stored: without columns of surfaces that run where none does."""
    array = np.asarray(getattr(walls, name))
    return (
        array[:, :N_RIGID] if name == "motion" and walls is not None and not walls.running().any() else array
    )


def _datasets_of_bodies(bodies: RigidBodies | None) -> tuple[str, ...]:
    """Arrays of clumps; their form in water where there is some, so that dry scenes keep their digest."""
    if bodies is None:
        return ()
    return _OF_BODIES if len(bodies.drag_form) else tuple(name for name in _OF_BODIES if name != "drag_form")


def _arrays_of_arrivals(traffic: Traffic | None) -> dict[str, np.ndarray]:
    """Arrays of the grains of a feeder reach by the name of their dataset; none without one."""
    if traffic is None or traffic.arrivals is None:
        return {}
    return {name: getattr(traffic.arrivals, name) for name in _OF_ARRIVALS}


def scene_digest(scene: Scene) -> str:
    """Digest of all numbers of a scene; the same before writing and after reading."""
    digest = hashlib.sha256()
    for name in _ARRAYS:
        array = np.ascontiguousarray(getattr(scene, name))
        digest.update(f"{name} {array.shape} ".encode())
        digest.update(array.astype(np.float64).tobytes())
    for name in () if scene.walls is None else _datasets_of(scene.walls):
        digest.update(np.ascontiguousarray(_array_of_walls(scene.walls, name), dtype=np.float64).tobytes())
    if scene.materials is not None:
        digest.update(scene.materials.of.astype(np.float64).tobytes())
    for name in _datasets_of_bodies(scene.bodies):
        digest.update(np.ascontiguousarray(getattr(scene.bodies, name), dtype=np.float64).tobytes())
    for name, array in (*flow_arrays(scene.flow).items(), *_arrays_of_arrivals(scene.traffic).items()):
        digest.update(f"{name} {array.shape} ".encode())
        digest.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
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
        faces = {
            name: read_dataset(file, f"walls/{name}", path) for name in _WALLS if f"walls/{name}" in file
        }
        of = read_dataset(file, f"{_MATERIALS}/of", path) if _MATERIALS in file else np.zeros(0, np.int8)
        bodies = {
            name: read_dataset(file, f"{_BODIES}/{name}", path)
            for name in _OF_BODIES
            if _BODIES in file and (name != "drag_form" or f"{_BODIES}/{name}" in file)
        }
        of_flow = {
            name: read_dataset(file, f"{ROW}/{name}", path) for name in FLOW_ARRAYS if f"{ROW}/{name}" in file
        }
        listed = {
            name: read_dataset(file, f"{_ARRIVALS}/{name}", path)
            for name in _OF_ARRIVALS
            if _ARRIVALS in file
        }
    try:
        if raw.dtype != np.uint8 or raw.nbytes > _LIMIT:
            raise ValueError("its scalars are not text")
        scalars = json.loads(raw.tobytes())
        step, t = int(scalars.pop("step")), float(scalars.pop("t"))
        laws = {name: numbers_of(kind, scalars.pop(name)) for name, kind in _LAWS.items()}
        if _TRAFFIC in scalars:
            scalars[_TRAFFIC] = _traffic(scalars[_TRAFFIC], listed)
        if _MATERIALS in scalars:
            scalars[_MATERIALS] = _materials(of, scalars[_MATERIALS])
        if (forms := scalars.pop(_BODIES, None)) is not None:
            scalars[_BODIES] = _bodies(bodies, forms, len(arrays["d"]))
        scalars["flow"] = flow_from(scalars, of_flow)
        if (names := scalars.pop("walls", None)) is not None:
            scalars["walls"] = _walls(faces, names)
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


def _materials(of: np.ndarray, raw: dict[str, Any]) -> Materials:
    """Materials, whose numbers go to compiled code and are therefore checked."""
    names = tuple(str(name) for name in raw["names"])
    contact = tuple(numbers_of(ContactLaw, one) for one in raw["contact"])
    rolling = tuple(numbers_of(RollingLaw, one) for one in raw["rolling"])
    if of.dtype != np.int8 or of.ndim != 1 or (len(of) and not 0 <= of.min() <= of.max() < len(names)):
        raise ValueError(f"materials/of holds a number that is not 0 to {len(names) - 1}")
    if len(contact) != len(names) ** 2 or len(rolling) != len(names) ** 2:
        raise ValueError(f"{len(names)} materials have {len(contact)} contact laws")
    of.flags.writeable = False
    return Materials(names, of, contact, rolling)


def _traffic(raw: dict[str, Any], arrays: dict[str, np.ndarray]) -> Traffic:
    """Feeds and exits; the arrays of a feeder reach place grains and are therefore checked."""
    if _ARRIVALS not in raw:
        return Traffic.from_data(raw)
    arrivals = Arrivals(int(raw[_ARRIVALS]), **arrays)
    traffic = Traffic.from_data(raw, arrivals)
    n = traffic.feeds[-1].count if arrivals.feed == len(traffic.feeds) - 1 else -1
    for name, array in arrays.items():
        wanted = (n, 3) if name in {"v", "omega"} else (n,)
        if array.shape != wanted or array.dtype != np.float64 or not np.isfinite(array).all():
            raise ValueError(f"{_ARRIVALS}/{name} has shape {array.shape}, expected {wanted} finite numbers")
        array.flags.writeable = False
    return traffic


def _bodies(arrays: dict[str, np.ndarray], names: list[str], n_grain: int) -> RigidBodies:
    """Clumps from their arrays, whose numbers go to compiled code and are therefore checked."""
    for name, array in arrays.items():
        wanted = np.int64 if name in {"first", "count", "form"} else np.float64
        if array.dtype != wanted or not np.isfinite(array).all():
            raise ValueError(f"bodies/{name} is no array of finite numbers of type {wanted.__name__}")
        array.flags.writeable = False
    bodies = RigidBodies(**arrays, names=tuple(str(name) for name in names))
    if fault := bodies.fault(n_grain):
        raise ValueError(fault)
    return bodies


def _walls(arrays: dict[str, np.ndarray], names: list[str]) -> Walls:
    """Walls from their arrays, whose numbers go to compiled code and are therefore checked."""
    if (motion := arrays["motion"]).ndim == 2 and motion.shape[1] == N_RIGID:
        arrays["motion"] = np.pad(motion, ((0, 0), (0, N_MOTION - N_RIGID)))
    walls = Walls(**arrays, names=tuple(str(name) for name in names))
    n, n_wall = walls.n_face, walls.n_wall
    wanted = {
        "face": (n, 9), "kind": (n,), "wall": (n,), "surface": (n,), "active": (n_wall,),
        "motion": (n_wall, N_MOTION),
    }  # fmt: skip
    if "servo" in arrays:
        wanted["servo"] = (n_wall, N_SERVO)
    for name, shape in wanted.items():
        array = arrays[name]
        if array.shape != shape or not np.isfinite(array).all():
            raise ValueError(f"walls/{name} has shape {array.shape}, expected {shape} of finite numbers")
        array.flags.writeable = False
    for name, most in (("kind", len(FaceKind)), ("wall", n_wall), ("surface", max(n, 1))):
        if arrays[name].dtype != np.int64 or (n and not 0 <= arrays[name].min() <= arrays[name].max() < most):
            raise ValueError(f"walls/{name} holds a number that is not 0 to {most - 1}")
    return walls


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
