"""Run by `mpirun -np N`: grains collide across the border of ranks; the first rank prints where they end."""

import json
import math
import sys
from dataclasses import replace

import numpy as np
from tests.engine.conftest import M, contact_law, elastic_law
from tests.engine.heaps import COLUMN

from ryusa.build import Material, MaterialPair, scene
from ryusa.engine import registry
from ryusa.laws.families import (
    BedKind,
    ContactTiming,
    Drag,
    Fluctuations,
    Mixing,
    Profile,
    Slip,
    SurfaceRule,
)
from ryusa.model import Column, Water
from ryusa.model.contact_law import contact_time_of
from ryusa.model.fluid import N_SAMPLED, SUBMERGED, U
from ryusa.model.scene import EventRule
from ryusa.running.water import advanced, changed, snapshot, started

D = 2.0e-3
INTERVAL, STEPS = 20, 310


def stream():
    """Grains that fly through a column of water, over fixed ones and out of its surface, and collide.

    Without friction the laws of both engines are the same. Grains cross borders of ranks within intervals.
    """
    rng, wide = np.random.default_rng(6), 8.0 * D
    layer = (np.arange(6) + 0.5) * wide / 6.0
    x = np.stack(np.meshgrid(layer, layer, 2.2 * D + 1.1 * D * np.arange(4), indexing="ij"), -1).reshape(
        -1, 3
    )
    spots = (np.arange(5) + 0.5) * wide / 5.0
    bed = np.stack(np.meshgrid(spots, spots, [0.5 * D], indexing="ij"), -1).reshape(-1, 3)
    bed[:, 2] += rng.uniform(0.0, 0.5 * D, len(bed))
    v = np.array([1.0, 0.4, 0.0]) + rng.normal(0.0, 0.3, x.shape)
    fixed, first = scene(
        x, D, v=v, omega=rng.normal(0.0, 30.0, x.shape), x_fixed=bed,
        d_fixed=D, period=(wide, wide), slip=Slip.TOTAL, friction=0.0, timing=ContactTiming.AT_STEPS,
        events=EventRule.NONE, water=COLUMN, slope=0.1, stiffness=2e3,
    )  # fmt: skip
    column = Column(
        z_low=0.0, dz=0.2 * D, n=45, depth=5.5 * D, z_bed=D, area=wide**2, bed=BedKind.MOVING, phi_max=0.6,
        surface=SurfaceRule.VOLUME, mixing=Mixing.LI_SAWAMOTO, g_x=float(fixed.gravity[0]), d=D,
        fluctuations=Fluctuations.RANDOM_WALK, seed=3, interval=INTERVAL,
    )  # fmt: skip
    return replace(fixed, flow=column), first


def in_a_column(name):
    """Where grains and water are after a few exchanges; then after a change of the slope and of the bed."""
    fixed, first = stream()
    engine = registry.create(name)
    engine.load(fixed, first)
    water = started(fixed, engine, first, 0)
    begun = ranks_of(engine)
    step, flags = advanced(engine, water, 0, STEPS)
    flags.raise_if_any()
    found = {**seen(engine, water), "crossed": int(np.count_nonzero(ranks_of(engine) != begun))}
    kept = replace(engine.state(), coupling=snapshot(engine, water))
    gone = fixed.fixed_active & (np.arange(fixed.n_fixed) % 2 == 0)
    steeper = replace(
        fixed, gravity=np.array([1.5, 0.0, -9.6]), fixed_active=gone,
        flow=replace(fixed.column, g_x=1.5),
    )  # fmt: skip
    ends = []
    for state in (engine.state(), kept):  # the second goes on from the snapshot
        if state is kept:
            engine = registry.create(name)
            engine.load(fixed, kept)
            water = started(fixed, engine, kept, step)
        engine.load(steeper, engine.state())
        changed(engine, water, steeper)
        _, flags = advanced(engine, water, step, STEPS // 2)
        flags.raise_if_any()
        ends.append(seen(engine, water))
    apart = {name: float(np.abs(np.array(ends[0][name]) - one).max()) for name, one in ends[1].items()}
    return {**found, **{f"{name}, later": one for name, one in ends[0].items()}, "apart": apart}


def ranks_of(engine):
    """Rank of every grain."""
    of = np.zeros(len(engine.grains().x), int)
    for rank, (ids, _) in enumerate(engine._all("kept") if hasattr(engine, "kept") else ()):
        of[ids] = rank
    return of


def seen(engine, water):
    """Grains and water."""
    state, now = engine.grains(), water.state
    x = state.x + 8.0 * D * np.column_stack([state.image, np.zeros(len(state.x))])
    kept = water.snapshot(engine.kept()) if hasattr(engine, "kept") else water.snapshot()
    return {
        "x": x.tolist(), "v": state.v.tolist(), "u": now.u.tolist(), "tau": now.tau.tolist(),
        "surface": now.z_surface, "phi": water.phi.tolist(), "worst": water.worst, "due": int(water.due),
        "walk": kept.eddies.r.tolist(), "age": kept.eddies.spent.tolist(), "cut": kept.z.tolist(),
        "n_contact": engine.tally().n_contact,
    }  # fmt: skip


def owners(engine, fixed):
    """Rank of every grain, by what each rank holds."""
    of = np.zeros(fixed.n_grain, int)
    for rank, rows in enumerate(engine._all("rows", 0, fixed.n_grain)):
        of[rows.ids] = rank
    return of.tolist()


def closed_forms():
    """A collision across the border of ranks, a grain that begins to roll as it crosses it, two that fall."""
    dry = {"slip": Slip.TOTAL, "timing": ContactTiming.AT_STEPS, "events": EventRule.NONE}
    found = {"rebound": [], "elastic": [], "owners": []}
    spheres = elastic_law(0.2, m=0.5 * M, slip=Slip.TOTAL, restitution=0.7)
    elastic = {"contact": spheres, "dt": contact_time_of(spheres, 0.5 * M, 0.25 * D, 0.2) / 50.0}
    for phase in (0.0, 0.25, 0.5, 0.75):
        made = scene(
            [[0.0, 0.0, 0.0], [1.0001 * D, 0.0, 0.0]], D, v=[[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]], gravity=0.0,
            restitution=0.7, steps_per_contact=50.0, **dry,
        )  # fmt: skip
        apart = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) * 0.1 * phase * made[0].dt
        first = replace(made[1], x=made[1].x + apart)
        engine = registry.create("lammps")
        engine.load(made[0], first)
        found["owners"].append(owners(engine, made[0]))
        engine.advance(125).raise_if_any()
        found["rebound"].append(float(np.diff(engine.grains().v[:, 0])[0]) / 0.2)
        pair = scene([[0.0, 0.0, 0.0], [1.0001 * D, 0.0, 0.0]], D, v=made[1].v, gravity=0.0,
            events=EventRule.NONE, **elastic)  # fmt: skip
        engine = registry.create("lammps")
        engine.load(pair[0], replace(pair[1], x=pair[1].x + apart / made[0].dt * pair[0].dt))
        found["owners"].append(owners(engine, pair[0]))
        engine.advance(125).raise_if_any()
        found["elastic"].append(float(np.diff(engine.grains().v[:, 0])[0]) / 0.2)
    law = contact_law(k_n=1e3, zeta_n=0.5, zeta_s=0.3, slip=Slip.TOTAL, mu=0.3)
    floor = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    # the second lies still: the border is half way
    places = [[0.0, 0.0, 0.5 * D], [2.4 * D, 1.1 * D, 0.5 * D]]
    made = scene(
        places, D, v=[[0.2, 0.0, 0.0], [0.0] * 3], planes=floor, contact=law, allow_overlap=True,
        events=EventRule.NONE,
    )  # fmt: skip
    sunk = float(made[0].m_weight[0]) * 9.80665 / law.k_n
    engine = registry.create("lammps")
    engine.load(made[0], replace(made[1], x=made[1].x - [0.0, 0.0, sunk]))
    found["slide owners"] = [owners(engine, made[0])]
    engine.advance(math.ceil(0.022 / made[0].dt)).raise_if_any()
    found["slide owners"].append(owners(engine, made[0]))
    end = engine.grains()
    found |= {"speed": end.v[0, 0], "surface": end.omega[0, 1] * 0.5 * D, "still": np.abs(end.v[1]).max()}
    water = Water(profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN)
    made = scene([[0.0, 0.0, 1.0], [8.0 * D, 0.0, 1.0]], D, water=water, stiffness=1.0, **dry)
    fixed = replace(made[0], world_low=(-math.inf,) * 3)
    engine = registry.create("lammps")
    engine.load(fixed, made[1])
    found["fall owners"] = owners(engine, fixed)
    engine.advance(math.ceil(0.6 / fixed.dt)).raise_if_any()
    fall = (-engine.grains().v[:, 2]).tolist()
    return {**found, "fall": fall, "weight": float(fixed.m_weight[0] * 9.80665)}


def broken(kind, words):
    """`ryusa` with these words, until something happens to the second rank alone."""
    from ryusa.cli import main as ryusa
    from ryusa.engine.lammps.ranks import world
    from ryusa.engine.lammps.share import GrainShare

    advance = GrainShare.advance

    def breaks(self, n_steps):
        if world().Get_rank() == 1 and self._lmp.extract_global("ntimestep") > 40:
            if kind == "program":
                raise MemoryError("no room for a list")
            _, free = self._free()
            self._atoms("x" if kind == "place" else "v")[free[0], 2] = np.nan
        advance(self, n_steps)

    GrainShare.advance = breaks
    sys.argv = ["ryusa", *words]
    ryusa()


def main() -> None:
    if sys.argv[1] == "broken":
        broken(sys.argv[2], sys.argv[3:])
        return
    with registry.leading("lammps") as leads:
        if not leads:
            return
        if sys.argv[1] == "closed forms":
            print(json.dumps(closed_forms()))
            return
        if sys.argv[1] == "two-way":
            print(json.dumps(in_a_column("lammps")))
            return
        column = sys.argv[1] == "column"
        law = {"slip": Slip.TOTAL, "timing": ContactTiming.AT_STEPS, "restitution": 0.3}
        if sys.argv[1] == "elastic":
            spheres = elastic_law(0.1, m=0.5 * M, youngs_modulus=1e7, slip=Slip.TOTAL, restitution=0.3)
            law = {"contact": spheres, "dt": contact_time_of(spheres, 0.5 * M, 0.25 * D, 0.1) / 50.0}
        if sys.argv[1] == "materials":
            law |= {
                "materials": [Material("heavy", density=5000.0), Material("steel", friction=0.1)],
                "pairs": [MaterialPair((one, "steel"), friction=0.2) for one in ("grains", "heavy")],
                "made_of": {"grains": ["heavy", "grains"] * 32, "floor": "steel"},
            }
        rng = np.random.default_rng(2)
        x = 1.0002 * D * np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), -1).reshape(-1, 3)
        fixed, first = scene(
            x + np.array([0.5 * D, 0.5 * D, 0.0]), D, v=rng.normal(0.0, 0.05, x.shape),
            omega=rng.normal(0.0, 20.0, x.shape),
            period=(4.5 * D, 4.5 * D), planes=[("floor", (0, 0, -0.5001 * D), (0, 0, 1))],
            events=EventRule.NONE, water=COLUMN if column else Water(), **law,
        )  # fmt: skip
        engine = registry.create("lammps")
        engine.load(fixed, first)
        for k in range(3):
            if column:
                sampled = np.zeros((fixed.n_grain, N_SAMPLED))
                sampled[:, U], sampled[:, SUBMERGED] = 0.1 * k + first.x[:, 2], 1.0
                engine.set_fluid(sampled)
            engine.advance(200).raise_if_any()
        end, tally, impulse = engine.state(), engine.tally(), engine.kinematics()[2]
        print(json.dumps({
            "x": (end.x + fixed.period[0] * np.column_stack([end.image, np.zeros(len(end.x))])).tolist(),
            "v": end.v.tolist(), "omega": end.omega.tolist(), "impulse": impulse.tolist(),
            "kinetic": tally.kinetic, "spring_n": tally.spring_n, "n_contact": tally.n_contact,
            "overlap_max": tally.overlap_max, "restart": len(end.engine.arrays["restart"]),
        }))  # fmt: skip


if __name__ == "__main__":
    main()
