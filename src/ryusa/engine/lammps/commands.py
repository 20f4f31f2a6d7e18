"""A scene as commands of LAMMPS: box, types, contact laws, planes, motion. Text alone; nothing is run here.

Types (`grain_types`): those of the free grains, then those of the fixed grains. Ids are those of ryusa plus
one. All names are made here, so that no text of a user enters a command.
"""

import math

import numpy as np

from ryusa.engine.lammps.contact_words import contact_words
from ryusa.engine.lammps.grain_types import GrainTypes
from ryusa.engine.lammps.partner import FLAT, RIGID, Partner
from ryusa.laws.families import Profile
from ryusa.model import Scene
from ryusa.model.fluid import N_IMPULSE, N_KEPT, N_SAMPLED
from ryusa.model.scene import Floats

SKIN = 0.15  # of the mean diameter: distance beyond contact up to which neighbours are listed
WATER = "water"  # fix external that completes the forces
# what a grain knows of a column of water, columns of model.fluid and of `forces`; it goes with the grain
SAMPLED, IMPULSE, LAST, KEPT = "d2_sampled", "d2_impulse", "d2_last", "d2_kept"
N_LAST = 7
PAIRS = "pairs"  # compute of pairs in contact: distance of their centres [m]
PROCESSORS = "processors * {} 1"  # grains lie in layers: ranks share the bed, not its height
_MARGIN = 2.0  # of the largest diameter: margin of open sides around the first grains
_IDS = 200  # in one command


def completes_forces(scene: Scene) -> bool:
    """Whether forces are completed in every step: by water, or for the spin of grains with added mass."""
    return scene.water.profile != Profile.NONE or bool(np.any(scene.m_added != 0.0))


def box(scene: Scene, types: GrainTypes, x: Floats) -> list[str]:
    """Commands that come before the grains.

    Parameters
    ----------
    types : of the grains.
    x : centres of free and fixed grains [m], shape (n, 3).
    """
    largest = scene.d_max
    low, high = x.min(axis=0) - _MARGIN * largest, x.max(axis=0) + _MARGIN * largest
    sides = ["m", "m", "m"]  # they follow the grains outwards
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            low[axis], high[axis], sides[axis] = 0.0, period, "p"
    if scene.plane_case:
        sides[1] = "f"  # nothing moves across
    corners = " ".join(f"{float(a)!r} {float(b)!r}" for a, b in zip(low, high, strict=True))
    return [
        "units si",
        "atom_style sphere",
        "atom_modify map array",
        "newton on",
        f"boundary {' '.join(sides)}",
        "comm_modify vel yes",
        PROCESSORS.format(1 if scene.plane_case else "*"),
        f"region box block {corners} units box",
        f"create_box {types.n + len(types.fixed)} box",
    ]


def laws(scene: Scene, types: GrainTypes) -> list[str]:
    """Commands that come after the grains: groups, contact laws, neighbours, motion, planes, weight."""
    n, mean = types.n, float(scene.d.mean())
    still = range(n + 1, n + len(types.fixed) + 1)
    commands = [f"group free type 1:{n}", f"group fixed type {still[0]}:{still[-1]}"]
    commands += [f"group type{k} type {k + 1}" for k in range(n)]
    commands.append("pair_style granular")
    commands += [f"pair_coeff {words}" for words in _pairs(scene, types)]
    apart = " ".join(f"exclude type {a} {b}" for a in still for b in still if a <= b)
    commands += [
        f"neighbor {SKIN * mean!r} bin",
        f"neigh_modify delay 0 every 1 check yes {apart}",
        f"timestep {scene.dt!r}",
        "fix hold fixed freeze",
        f"fix move free nve{'/sphere' if scene.rotation else ''}",
        f"compute {PAIRS} all pair/local dist cutoff radius",
        f"compute {PAIRS}_ids all property/local patom1 patom2 cutoff radius",
        "thermo_style custom step",
        "thermo_modify norm no",
        "thermo 0",
    ]
    for k in np.flatnonzero(scene.plane_active).tolist():
        commands += plane(scene, types, k)
    if completes_forces(scene):
        if scene.water.profile == Profile.COLUMN:
            columns = f"{SAMPLED} {N_SAMPLED} {IMPULSE} {N_IMPULSE} {LAST} {N_LAST} {KEPT} {N_KEPT}"
            commands.append(f"fix rows all property/atom {columns}")
        commands.append(f"fix {WATER} all external pf/callback 1 1")  # the last that changes forces
    else:
        commands.append(weight(scene))
    return commands


def _pairs(scene: Scene, types: GrainTypes) -> list[str]:
    """Two types each, and the words of their contact."""
    free = [_free(types, k) for k in range(types.n)]
    bed = float(scene.d_fixed.mean()) if scene.n_fixed else float(scene.d.mean())
    rigid, found = Partner(RIGID, RIGID, 0.5 * bed), list[str]()
    for a, one in enumerate(free):
        for b in range(a, types.n):
            law = _between(scene, types.material[a], types.material[b])
            found.append(f"{a + 1} {b + 1} {contact_words(law, one, free[b])}")
        for b, material in enumerate(types.fixed):
            law = _between(scene, types.material[a], material)
            found.append(f"{a + 1} {types.n + b + 1} {contact_words(law, one, rigid)}")
    never = contact_words(scene, free[0], rigid)  # fixed grains are excluded from each other's neighbours
    still = range(types.n + 1, types.n + len(types.fixed) + 1)
    return [*found, *(f"{a} {b} {never}" for a in still for b in still if a <= b)]


def plane(scene: Scene, types: GrainTypes, k: int) -> list[str]:
    """A plane: a region, and a wall for each type of the free grains."""
    point, normal = scene.plane_point[k].tolist(), scene.plane_normal[k].tolist()
    where = " ".join(repr(float(a)) for a in (*point, *normal))
    flat = Partner(RIGID, RIGID, FLAT)
    number = 0 if scene.materials is None else scene.materials.of[scene.n_grain + scene.n_fixed + k]
    commands = [f"region plane{k} plane {where} side in units box"]
    for c in range(types.n):
        words = contact_words(_between(scene, types.material[c], number), _free(types, c), flat)
        commands.append(f"fix {wall(k, c)} type{c} wall/gran/region granular {words} region plane{k}")
    return commands


def wall(k: int, c: int) -> str:
    """Name of the wall that plane k is for free grains of type c."""
    return f"wall{k}_{c}"


def weight(scene: Scene) -> str:
    """Gravity on dry grains."""
    g = scene.gravity * scene.m_weight[0] / scene.m[0]  # all have the same share
    size = float(np.linalg.norm(g))
    x, y, z = g.tolist() if size > 0.0 else (0.0, 0.0, -1.0)
    if scene.plane_case:
        y = 0.0
    return f"fix weight free gravity {size!r} vector {x!r} {y!r} {z!r}"


def removed(ids: np.ndarray) -> list[str]:
    """Commands that take fixed grains away, by their ids in ryusa."""
    groups = [
        "group gone id " + " ".join(str(one + 1) for one in ids[k : k + _IDS].tolist())
        for k in range(0, len(ids), _IDS)
    ]
    return [*groups, "delete_atoms group gone compress no", "group gone delete"] if groups else []


def _free(types: GrainTypes, k: int) -> Partner:
    """A free grain of a type."""
    return Partner(float(types.m[k]), float(types.m_bare[k]), 0.5 * float(types.d[k]))


def _between(scene: Scene, a: int, b: int) -> Scene:
    """The scene in which all contacts are those of two materials."""
    return scene if scene.materials is None else scene.of_pair(int(a) * scene.materials.n + int(b))
