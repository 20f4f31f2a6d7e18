"""A box with floor, back wall and gate, filled with a jittered lattice of grains that settle in a run."""

import numpy as np

from ryusa.build.nested_lattice import LatticeCells, nested_lattice
from ryusa.build.placement import Placement, Wall, at_rest
from ryusa.build.sizes import draw, draw_laid
from ryusa.casefile.builders.box import BoxPlan, box_plan, stands_on_floor
from ryusa.casefile.builders.schema import BoxSection
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grains.values import graded
from ryusa.casefile.shape import extent
from ryusa.model.scene import Floats

ZERO = 0.25  # depth of the profile's zero below the crest of a floor of grains, in diameters


def box(case: Case, derived: Derived) -> Placement:
    """Free lattice between x = 0 and the gate, floor with its base at z = 0; periodic in y unless plane.

    Groups `floor`, `back` and `gate`, whether of grains or planes; `pit`, a plane, when there is a drop.
    """
    keys = case.build
    assert isinstance(keys, BoxSection)
    rng = np.random.default_rng(case.seed)
    d, plane = derived.d, case.motion.plane
    plan = box_plan(keys, d, derived.room, plane)
    floor = _floor(keys, plan, rng, d, plane)
    back, gate = _stacks(keys, plan, floor, d, plane)
    top = float(floor[:, 2].max()) + d / 2.0 if len(floor) else 0.0
    sized: Floats | None = None
    if not graded(case):
        x = _lattice(keys, plan, rng, derived.room, plane)
    else:
        sized = draw_laid(case, keys.columns * keys.rows * keys.layers, rng)
        cells = LatticeCells(plan.pitch, keys.columns, keys.rows)
        x = nested_lattice(sized * extent(case), cells, keys.gap, keys.jitter, plane, rng)
    x[:, 2] += top + keys.height
    parts = [(name, rows) for name, rows in (("floor", floor), ("back", back), ("gate", gate)) if len(rows)]
    firsts = np.cumsum([0, *(len(rows) for _, rows in parts)]).tolist()
    x_fixed = np.concatenate([at_rest(0), *(rows for _, rows in parts)])
    crest = float(floor[:, 2].mean()) + d / 2.0 if len(floor) else 0.0
    inf = float("inf")
    return Placement(
        d=draw(case, len(x), rng) if sized is None else sized,
        x=x,
        v=at_rest(len(x)),
        omega=at_rest(len(x)),
        d_fixed=np.full(len(x_fixed), d),
        x_fixed=x_fixed,
        fixed_groups=tuple((name, firsts[k], len(rows)) for k, (name, rows) in enumerate(parts)),
        walls=_walls(keys, plan),
        period=(inf, inf if plane else plan.deep),
        z_zero=crest - ZERO * d if len(floor) else 0.0,
        endless=keys.drop is not None or keys.floor == "plane",
        notes=_notes(case, keys),
    )


def _lattice(keys: BoxSection, plan: BoxPlan, rng: np.random.Generator, room: float, plane: bool) -> Floats:
    """Jittered centres from z = 0 upwards, each axis `room` apart at least [m]."""
    cells = np.stack(
        np.meshgrid(np.arange(keys.layers), np.arange(keys.rows), np.arange(keys.columns), indexing="ij"), -1
    )
    pitch = np.array(plan.pitch)
    free = 0.5 * keys.jitter * np.maximum(pitch - room, 0.0)
    x = (cells.reshape(-1, 3)[:, ::-1] + 0.5) * pitch
    x = x + rng.uniform(-1.0, 1.0, x.shape) * free
    if plane:
        x[:, 1] = 0.0
    return np.asarray(x)


def _floor(keys: BoxSection, plan: BoxPlan, rng: np.random.Generator, d: float, plane: bool) -> Floats:
    """Touching grains from x = 0 to the end of the run-out, x fastest [m]."""
    x = _sheet(plan, plan.n_floor, d, plane)
    x[:, 2] = d / 2.0 + rng.uniform(0.0, keys.floor_height * d, len(x))
    return x


def _stacks(keys: BoxSection, plan: BoxPlan, floor: Floats, d: float, plane: bool) -> tuple[Floats, Floats]:
    """Grains of back wall and gate, from the bottom of the floor or, where it goes on, from its top [m]."""
    back, gate = _sheet(plan, plan.n_back, d, plane), _sheet(plan, plan.n_gate, d, plane)
    for stack in (back, gate):
        stack[:, 2], stack[:, 0] = stack[:, 0], -d / 2.0
    gate[:, 0] = plan.wide + d / 2.0
    if len(gate) and stands_on_floor(keys):
        beneath = floor.reshape(plan.n_deep, plan.n_floor, 3)[:, plan.n_wide, 2]
        gate[:, 2] += np.repeat(beneath, plan.n_gate) + d / 2.0
    return back, gate


def _sheet(plan: BoxPlan, n: int, d: float, plane: bool) -> Floats:
    """Square sheet of n touching grains along x, and a period of them along y, at z = 0 [m]."""
    grid = np.stack(np.meshgrid(np.arange(plan.n_deep), np.arange(n), indexing="ij"), -1).reshape(-1, 2)
    x = at_rest(len(grid))
    x[:, 0] = (grid[:, 1] + 0.5) * d
    if not plane:
        x[:, 1] = (grid[:, 0] + 0.5) * d
    return x


def _walls(keys: BoxSection, plan: BoxPlan) -> tuple[Wall, ...]:
    walls: list[Wall] = []
    if keys.floor == "plane":
        walls.append(Wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    if keys.walls == "planes":
        walls.append(Wall("back", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
        walls.append(Wall("gate", (plan.wide, 0.0, 0.0), (-1.0, 0.0, 0.0)))
    if keys.drop is not None:
        walls.append(Wall("pit", (0.0, 0.0, -keys.drop), (0.0, 0.0, 1.0)))
    return tuple(walls)


def _notes(case: Case, keys: BoxSection) -> tuple[str, ...]:
    """Choices the case left open."""
    notes: list[str] = []
    for key in ("floor", "walls"):
        if key not in keys.model_fields_set:
            notes.append(f"{key} of the box: {getattr(keys, key)} (build.{key} not given)")
    if "spread" not in case.grains.model_fields_set and not graded(case):
        notes.append("grains of one size, which settle into rows (grains.spread not given)")
    opened = any(entry.remove == "gate" for entry in case.timeline)
    if opened and keys.floor == "grains":
        if "run_out" not in keys.model_fields_set:
            notes.append("the floor ends at the gate (build.run_out not given)")
        if keys.drop is None:
            notes.append("a grain that runs past the end of the floor stops the run (build.drop not given)")
    if case.water is not None and case.water.zero is None:
        where = f"{ZERO:g} d below the mean crest of the floor" if keys.floor == "grains" else "at the floor"
        notes.append(f"zero of the water profile {where} (water.zero not given)")
    return tuple(notes)
