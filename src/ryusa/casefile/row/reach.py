"""The feeder reach of a river: a finished periodic run over an even bed that supplies its water and grains.

What a river takes from it is read from its run folder once and kept as reach.json in that of the river.
"""

import hashlib
import json
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from ryusa.model.arrays import Floats

KEY = "water.row.upstream.run"
NAME = "reach"  # of the feed that brings its grains
END = "feeder reach"


@dataclass(frozen=True)
class FeederReach:
    """Water and grains that pass the downstream end of a period, means and record of a window.

    Attributes
    ----------
    name : of its run folder, as the case gives it.
    begin, end : window, from the settling time to the last frame [s].
    length, width : of the period and of its bed [m].
    side_walls : whether the grains have walls at both sides; else it is periodic across.
    slope : of the x axis, positive where it falls downstream [rad].
    frames : time between two frames [s].
    discharge : of water per width [m2/s].
    in_bed : part of it that passes below the bed line [-].
    bed : height of the bed line over the lowest face of the cells, the top of the bed over which an inlet
        lets water in (design/0027), mean of all frames and segments [m].
    depth : of the water over the bed line, along z [m].
    z, u : heights over the bed line [m] and mean speeds there along x [m/s], shape (n,).
    solid_discharge, error : volume of grains that passes per width and time, mean along the period, and its
        standard error [m2/s].
    backwards : crossings upstream that no crossing downstream of the same grain makes up for.
    t, y, height, d : of each crossing downstream: time since `begin` [s], ascending, place across [m], height
        over the bed line [m], diameter [m], shape (n,).
    v, omega : velocity [m/s] and spin [rad/s] then, shape (n, 3).
    case : case.json of the run, while it is read from there.
    """

    name: str
    begin: float
    end: float
    length: float
    width: float
    side_walls: bool
    slope: float
    frames: float
    discharge: float
    in_bed: float
    bed: float
    depth: float
    z: Floats
    u: Floats
    solid_discharge: float
    error: float
    backwards: int
    t: Floats
    y: Floats
    height: Floats
    d: Floats
    v: Floats
    omega: Floats
    case: dict[str, Any] | None = field(default=None, compare=False)

    @property
    def duration(self) -> float:
        """Length of the record [s]."""
        return self.end - self.begin

    def to_bytes(self) -> bytes:
        """Content of reach.json, whose numbers are exact."""
        kept = {one.name: getattr(self, one.name) for one in fields(self) if one.name != "case"}
        plain = {key: one.tolist() if isinstance(one, np.ndarray) else one for key, one in kept.items()}
        return (json.dumps(plain, allow_nan=False) + "\n").encode()

    @staticmethod
    def from_bytes(content: bytes) -> "FeederReach":
        """The inverse of `to_bytes`.

        Raises
        ------
        ValueError : it is no such file, or its arrays do not match.
        """
        try:
            data = json.loads(content)
            kept: dict[str, Any] = {key: _array(one) for key, one in data.items()}
            found = FeederReach(**kept)
            n = len(found.t)
            shapes = [one.shape for one in (found.y, found.height, found.d)]
            good = shapes == [(n,)] * 3 and found.v.shape == found.omega.shape == (n, 3)
        except (TypeError, AttributeError, UnicodeDecodeError) as error:
            raise ValueError(str(error)) from error
        if not n or not good or found.z.shape != found.u.shape or not (np.diff(found.t) >= 0.0).all():
            raise ValueError("its arrays do not match")
        return found


def _array(value: Any) -> Any:
    return np.array(value, np.float64) if isinstance(value, list) else value


def digest_of(content: bytes) -> str:
    """Digest of reach.json, as provenance.json holds it."""
    return hashlib.sha256(content).hexdigest()
