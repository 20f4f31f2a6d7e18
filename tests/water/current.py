"""A fluid of a page: water that moves as one body, and loses what the grains take."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Self

import numpy as np

from ryusa.model import Scene
from ryusa.model.arrays import Floats
from ryusa.model.flow import Field, Flow
from ryusa.model.fluid import N_SAMPLED, SUBMERGED, U
from ryusa.water.protocol import Fluid


@dataclass(frozen=True, repr=False)
class Current(Flow):
    """Water of a given depth over an area of bed, in equal layers."""

    speed: float  # at the start, along x [m/s]
    depth: float  # [m]
    area: float  # [m2]
    rho: float = 1000.0  # [kg/m3]
    g_x: float = 0.0  # gravity along x [m/s2]
    layers: int = 4
    interval: int = 10
    GROUP: ClassVar[str] = "current"

    @property
    def text(self) -> str:
        return f"a current of {self.layers} layers"

    def account(self, found: Mapping[str, Any]) -> str:
        return f"speed {found['speed']:.4g} m/s"

    @property
    def mass(self) -> float:
        return self.rho * self.depth * self.area

    @property
    def places(self) -> Mapping[str, int]:
        return {"layer": self.layers, "face": self.layers + 1}

    def fields(self) -> Mapping[str, Field]:
        return {"speed": Field("m/s"), "u": Field("m/s", ("layer",))}

    def first_surface(self, x: Floats) -> Floats:
        return np.full(x.shape, self.depth)

    def tilted(self, g_x: float, g_z: float) -> Self:
        return replace(self, g_x=g_x)


@dataclass(frozen=True)
class CurrentState:
    speed: float
    taken: Annotated[Floats, "layer"]  # momentum that the grains took so far, shared by the layers [N s]
    steps: int
    due: int
    mixed: Annotated[Floats, "face"] | None = None

    def fault(self, touched: int) -> str:
        return "" if touched else "a current without grains"


class Drift(Fluid):
    """The water of a `Current`: m du/dt = m g_x - force on the grains."""

    def __init__(self, scene: Scene, flow: Any, n: int, found: CurrentState) -> None:
        self.scene, self.flow, self.n = scene, flow, n
        self.speed, self.taken = found.speed, np.array(found.taken)
        self.steps, self.due = found.steps, found.due

    @classmethod
    def begin(cls, scene: Scene, flow: Current, x: Floats, step: int = 0, threads: int = 1) -> "Drift":
        return cls(scene, flow, len(x), CurrentState(flow.speed, np.zeros(flow.layers), 1, step + 1))

    @classmethod
    def resume(
        cls, scene: Scene, flow: Current, found: CurrentState, sampled: Floats | None = None, threads: int = 1
    ) -> "Drift":
        return cls(scene, flow, scene.n_grain, found)

    @property
    def sampled(self) -> Floats:
        told = np.zeros((self.n, N_SAMPLED))
        told[:, U], told[:, SUBMERGED] = self.speed, 1.0
        return told

    def exchange(self, x: Floats, v: Floats, impulse: Floats) -> Floats:
        took, time = float(impulse[:, 0].sum()), self.steps * self.scene.dt
        self.taken += took / self.flow.layers
        self.speed += time * self.flow.g_x - took / self.flow.mass
        self.steps = self.flow.interval
        self.due += self.steps
        return self.sampled

    def among(self, x: Floats, step: int) -> "Drift":
        return type(self)(self.scene, self.flow, len(x), replace(self.snapshot(), steps=1, due=step + 1))

    def change(self, scene: Scene) -> None:
        self.scene, self.flow = scene, scene.flow

    def snapshot(self, kept: Floats | None = None) -> CurrentState:
        return CurrentState(self.speed, self.taken.copy(), self.steps, self.due)

    def frame(self) -> Mapping[str, Floats]:
        return {"speed": np.array(self.speed), "u": np.full(self.flow.layers, self.speed)}

    def surface_at(self, x: Floats) -> Floats:
        return self.flow.first_surface(x)

    @property
    def text(self) -> str:
        return f"speed {self.speed:.4g} m/s"

    def numbers(self) -> dict[str, float | int]:
        return {"speed": self.speed, "steps_between": self.steps}

    def warnings(self) -> list[str]:
        return ["the water has turned"] if self.speed < 0.0 else []
