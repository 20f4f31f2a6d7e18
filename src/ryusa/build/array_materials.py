"""Materials of a scene from arrays, and the contact of each two of them (design/0020)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.materials.checks import MOST
from ryusa.casefile.materials.values import GRAINS
from ryusa.errors import CaseError
from ryusa.laws import collision
from ryusa.laws.families import Adhesion, ContactForce, ContactTiming, Rolling
from ryusa.laws.hertz import effective_modulus, mindlin_ratio
from ryusa.laws.materials import poisson_of_two, stiffness_of_two, young_of_two
from ryusa.model import ContactLaw, Materials, RollingLaw, Scene
from ryusa.model.scene import Damping, Floats
from ryusa.spelling import nearest_word

Numbers = NDArray[np.int8]
MadeOf = Mapping[str, str | Sequence[str]]


@dataclass(frozen=True)
class Material:
    """A material of grains or walls; what it does not say is as in the contact law of the scene.

    Friction, restitution, rolling and adhesion are those of two grains of this material.
    """

    name: str
    density: float | None = None  # [kg/m3]; of walls and fixed grains it means nothing
    stiffness: float | None = None  # k_n of linear springs between two grains of it [N/m]
    youngs_modulus: float | None = None  # of elastic spheres [Pa]
    poisson_ratio: float | None = None  # of elastic spheres [-]
    friction: float | None = None  # mu = tan(phi) [-]
    restitution: float | None = None  # [-]
    rolling_coefficient: float | None = None  # of RollingLaw [-]
    adhesion_amount: float | None = None  # of ContactLaw


@dataclass(frozen=True)
class MaterialPair:
    """What belongs to contacts of two different materials, and follows from neither of them."""

    materials: tuple[str, str]
    friction: float | None = None  # mu = tan(phi) [-]
    restitution: float | None = None  # [-]
    rolling_coefficient: float | None = None  # of RollingLaw [-]
    adhesion_amount: float | None = None  # of ContactLaw


@dataclass(frozen=True)
class ArrayMaterials:
    """Materials of a scene before it is assembled.

    Attributes
    ----------
    names : "grains", the material of the contact law of the scene, and those that were given.
    of : number of the material of each grain, fixed grain and plane, shape (n,).
    of_walls : of each wall, shape (n_wall,).
    density : of each grain [kg/m3].
    contact, rolling : of each two materials, as in `model.Materials`.
    """

    names: tuple[str, ...]
    of: Numbers
    of_walls: Numbers
    density: Floats
    contact: tuple[ContactLaw, ...]
    rolling: tuple[RollingLaw, ...]

    def meeting(self) -> dict[tuple[int, int], bool]:
        """Pairs of materials that can meet, the lower number first, and whether as two free grains."""
        return meeting(self.of, self.of_walls, len(self.density))

    def on(self, scene: Scene) -> Scene:
        """The scene, with all its walls, made of these materials."""
        walls = scene.walls
        faces = np.zeros(0, np.int8) if walls is None else self.of_walls[walls.wall]
        of = np.concatenate([self.of, faces])
        of.flags.writeable = False
        return replace(scene, materials=Materials(self.names, of, self.contact, self.rolling))


def array_materials(
    materials: Sequence[Material],
    pairs: Sequence[MaterialPair],
    made_of: MadeOf,
    groups: Mapping[str, tuple[int, int]],
    walls: Sequence[str],
    n: tuple[int, int],
    density: float,
    contact: ContactLaw,
    rolling: RollingLaw,
) -> ArrayMaterials | None:
    """Materials by id, and the contact of each two; None where there is one material.

    Parameters
    ----------
    made_of : name of the material of each group, plane and wall, by its name; for groups of grains also a
        sequence with one name for each.
    groups : ids of groups of grains and of planes; `walls` are names of walls.
    n : free grains, and all ids without faces of walls.

    Raises
    ------
    CaseError : a name that is unknown or used twice, a number out of its range, a material without use, two
        materials that meet and differ in what no law mixes.
    """
    if not materials:
        for key, given in (("made_of", made_of), ("pairs", pairs)):
            if given:
                raise CaseError(key, None, "needs materials")
        return None
    names = (GRAINS, *(one.name for one in materials))
    _refuse_materials(materials, contact, rolling)
    of, of_walls = _numbers(names, made_of, groups, walls, n)
    for one in materials:
        number = names.index(one.name)
        if number not in of and number not in of_walls:
            raise CaseError("materials", one.name, "is never used; name it in made_of")
    by_name = {one.name: one for one in materials}
    given = _pairs(pairs, names)
    meet = meeting(of, of_walls, n[0])
    values: dict[tuple[int, int], dict[str, float]] = {}
    for a in range(len(names)):
        for b in range(a, len(names)):
            values[a, b] = _values(by_name, given, names[a], names[b], (a, b) in meet, contact, rolling)
    for a, b in given:
        first, second = sorted((names.index(a), names.index(b)))
        if (first, second) not in meet:
            raise CaseError("pairs", (a, b), "has no effect: the two never meet")
    every = [tuple(sorted((a, b))) for a in range(len(names)) for b in range(len(names))]
    own = np.array([density, *(density if one.density is None else one.density for one in materials)])
    return ArrayMaterials(
        names, of, of_walls, own[of[: n[0]]],
        tuple(_law(by_name, names[a], names[b], values[a, b], contact) for a, b in every),
        tuple(replace(rolling, coefficient=values[a, b]["rolling_coefficient"]) for a, b in every),
    )  # fmt: skip


def meeting(of: Numbers, of_walls: Numbers, n_grain: int) -> dict[tuple[int, int], bool]:
    """Pairs of materials that can meet, the lower number first, and whether as two free grains."""
    count = np.bincount(of[:n_grain], minlength=1)
    free = np.flatnonzero(count).tolist()
    still = sorted({*of[n_grain:].tolist(), *of_walls.tolist()})
    found = {(a, b): True for a in free for b in free if a < b or (a == b and count[a] > 1)}
    for a in free:
        for b in still:
            found.setdefault((min(a, b), max(a, b)), False)
    return found


def _refuse_materials(materials: Sequence[Material], contact: ContactLaw, rolling: RollingLaw) -> None:
    elastic = contact.force == ContactForce.HERTZ_MINDLIN
    if contact.damping is not Damping.RESTITUTION:
        raise CaseError("materials", None, "need a contact law with a restitution, not constant dashpots")
    if len(materials) >= MOST:
        raise CaseError("materials", len(materials), f"are too many; at most {MOST - 1}")
    seen = {GRAINS}
    for one in materials:
        if one.name in seen:
            text = (
                "is the material of the contact law of the scene" if one.name == GRAINS else "is used twice"
            )
            raise CaseError("materials", one.name, text)
        seen.add(one.name)
        key = f"materials ({one.name})"
        _refuse_numbers(key, one)
        for name, has in (
            ("stiffness", not elastic),
            ("youngs_modulus", elastic),
            ("poisson_ratio", elastic),
            ("rolling_coefficient", rolling.model != Rolling.NONE),
            ("adhesion_amount", contact.adhesion != Adhesion.NONE),
        ):
            if getattr(one, name) is not None and not has:
                raise CaseError(
                    f"{key}.{name}", getattr(one, name), "has no effect with the laws of the scene"
                )
        if one.stiffness not in (None, contact.k_n) and contact.timing != ContactTiming.EXACT:
            raise CaseError(
                f"{key}.stiffness", one.stiffness,
                "needs timing EXACT: linear springs that begin and end at steps are all alike",
            )  # fmt: skip


def _refuse_numbers(key: str, one: Material | MaterialPair) -> None:
    """Raise a `CaseError` for a number that is not finite or out of its range."""
    above = ("density", "stiffness", "youngs_modulus", "restitution")
    most = {"restitution": 1.0, "poisson_ratio": 0.5}
    for name, value in vars(one).items():
        if value is None or name in {"name", "materials"}:
            continue
        low_enough = value <= most.get(name, np.finfo(float).max)
        if not (low_enough and (value > 0.0 if name in above else value >= 0.0)):
            text = f"must be {'greater than' if name in above else 'at least'} 0"
            text += f" and at most {most[name]:g}" if name in most else " and finite"
            raise CaseError(f"{key}.{name}", value, text)


def _pairs(pairs: Sequence[MaterialPair], names: Sequence[str]) -> dict[tuple[str, str], MaterialPair]:
    found: dict[tuple[str, str], MaterialPair] = {}
    for one in pairs:
        a, b = one.materials
        for name in (a, b):
            if name not in names:
                allowed = f"must be two materials of: {', '.join(names)}"
                raise CaseError("pairs", name, allowed, nearest_word(name, names))
        if a == b:
            raise CaseError("pairs", (a, b), "is one material: say so in it, or in the laws of the scene")
        if (a, b) in found or (b, a) in found:
            raise CaseError("pairs", (a, b), "is given twice")
        _refuse_numbers(f"pairs ({a}, {b})", one)
        found[a, b] = one
    return found


def _numbers(
    names: tuple[str, ...],
    made_of: MadeOf,
    groups: Mapping[str, tuple[int, int]],
    walls: Sequence[str],
    n: tuple[int, int],
) -> tuple[Numbers, Numbers]:
    """Number of the material of each id without faces, and of each wall."""
    of, of_walls = np.zeros(n[1], np.int8), np.zeros(len(walls), np.int8)
    known = [*groups, *walls]
    for group, said in made_of.items():
        if group not in known:
            allowed = f"must be a group, a plane or a wall: {', '.join(known)}"
            raise CaseError("made_of", group, allowed, nearest_word(group, known))
        begin, end = groups.get(group, (0, 1))
        words = [said] * (end - begin) if isinstance(said, str) else list(said)
        if len(words) != end - begin:
            raise CaseError(
                f"made_of ({group})", len(words), f"needs one name, or one for each of {end - begin}"
            )
        for word in set(words):
            if word not in names:
                allowed = f"must be a material: {', '.join(names)}"
                raise CaseError(f"made_of ({group})", word, allowed, nearest_word(word, names))
        numbers = [names.index(word) for word in words]
        if group in walls:
            of_walls[list(walls).index(group)] = numbers[0]
        else:
            of[begin:end] = numbers
    return of, of_walls


def _values(
    by_name: Mapping[str, Material],
    pairs: Mapping[tuple[str, str], MaterialPair],
    a: str,
    b: str,
    meet: bool,
    contact: ContactLaw,
    rolling: RollingLaw,
) -> dict[str, float]:
    """What belongs to a pair, of two materials or one; that of the first where nobody asks for it."""
    base = {  # keys of a pair, and what the laws of the scene say
        "friction": contact.mu, "restitution": contact.e_n, "rolling_coefficient": rolling.coefficient,
        "adhesion_amount": contact.adhesion_amount,
    }  # fmt: skip
    pair = pairs.get((a, b), pairs.get((b, a)))
    found: dict[str, float] = {}
    for key, common in base.items():
        both = [getattr(by_name.get(name), key, None) for name in (a, b)]
        own = [common if one is None else float(one) for one in both]
        asked = None if pair is None else getattr(pair, key)
        if meet and asked is None and own[0] != own[1]:
            raise CaseError(
                f"pairs ({a}, {b}): {key}", None,
                f"missing; {a} has {own[0]:.4g} and {b} {own[1]:.4g}, and no law mixes them",
            )  # fmt: skip
        found[key] = own[0] if asked is None else float(asked)
    return found


def _law(
    by_name: Mapping[str, Material], a: str, b: str, values: Mapping[str, float], contact: ContactLaw
) -> ContactLaw:
    """Contact law of two materials; that of the scene in all that they do not say."""
    e_n = values["restitution"]
    e_s = e_n if contact.e_s == contact.e_n else contact.e_s
    made = replace(
        contact, mu=values["friction"], adhesion_amount=values["adhesion_amount"], e_n=e_n, e_s=e_s
    )
    # A law of one's own may have dashpots that its restitutions do not give; materials that do not ask for
    # another restitution keep them.
    if e_n != contact.e_n:
        made = replace(made, zeta_n=collision.zeta_for_restitution(e_n, contact.tension))
    if e_s != contact.e_s:
        made = replace(made, zeta_s=collision.zeta_tension(e_s))

    def own(key: str, base: float) -> tuple[float, float]:
        found = [getattr(by_name.get(name), key, None) for name in (a, b)]
        first, second = (base if one is None else float(one) for one in found)
        return first, second

    if contact.force != ContactForce.HERTZ_MINDLIN:
        k_n = stiffness_of_two(*own("stiffness", contact.k_n))
        return replace(made, k_n=k_n, k_s=contact.k_s / contact.k_n * k_n)
    (e_a, e_b), (nu_a, nu_b) = (
        own("youngs_modulus", contact.youngs_modulus),
        own("poisson_ratio", contact.poisson_ratio),
    )
    young, nu = young_of_two(e_a, nu_a, e_b, nu_b), poisson_of_two(e_a, nu_a, e_b, nu_b)
    stiffer = effective_modulus(young, nu) / effective_modulus(contact.youngs_modulus, contact.poisson_ratio)
    k_n = contact.k_n * stiffer**0.8  # the contact time goes with the modulus to the power -0.4
    return replace(
        made, youngs_modulus=young, poisson_ratio=nu, k_n=k_n, k_s=2.0 / 3.0 * mindlin_ratio(nu) * k_n
    )
