"""What kernels are compiled for, and the laws they pick while they run."""

from typing import NamedTuple

from ryusa.engine.shared import memory_rows as M
from ryusa.laws._family import numbers
from ryusa.laws.families import Adhesion, ContactForce, ContactTiming, Profile, Rolling
from ryusa.model import Scene
from ryusa.model.contacts import N_EVENT
from ryusa.model.scene import EventRule

_, HERTZ = numbers(__name__, ContactForce.LINEAR, ContactForce.HERTZ_MINDLIN)
_, EXACT = numbers(__name__, ContactTiming.AT_STEPS, ContactTiming.EXACT)


class KernelVariant(NamedTuple):
    """What a scene needs of its kernels."""

    plane_case: int
    rotation: int
    rolling: int
    events: int
    column: int
    film: int  # films resist before touch
    water: int  # there is any
    exact: int  # contacts begin and end within steps
    walls: int = 0  # faces, at rest or moving
    hertz: int = 0  # contacts are those of elastic spheres
    mixed: int = 0  # materials differ
    bodies: int = 0  # grains that are members of rigid bodies
    adhesive: int = 0  # grains in touch attract each other

    @property
    def row_width(self) -> int:
        """Doubles per contact row."""
        return self.event_column + (N_EVENT if self.events else 0)

    @property
    def springs(self) -> int:
        """Dashpots and stiffnesses kept for each pair."""
        return (M.K_N, M.N_SPRING_OF_KICKS, M.N_SPRING)[self.kind]

    @property
    def kind(self) -> int:
        """Kind of springs (memory_rows.py)."""
        return M.OF_KICKS * self.exact + M.HERTZ * self.hertz

    @property
    def event_column(self) -> int:
        """Where the open record starts."""
        return M.WIDTH_ROLLING if self.rolling else M.WIDTH


class ForcesKind(NamedTuple):
    """What the forces of contacts are compiled for; what is 0 is not compiled."""

    plane_case: int
    rotation: int
    rolling: int
    events: int
    film: int
    exact: int
    walls: int
    hertz: int
    mixed: int
    adhesive: int
    rebound: int  # restitution depends on the water at touch


class FluidLaws(NamedTuple):
    """Laws of the water by number (laws.families); each is compiled, the others of its family are not."""

    profile: int
    above: int
    drag: int
    torque: int
    buoyancy: int
    hindrance: int
    lift: int
    magnus: int
    drag_of_form: int


class MotionKind(NamedTuple):
    """What the motion of grains is compiled for; what is 0 is not compiled."""

    plane_case: int
    rotation: int
    counted: int  # contacts of each grain are counted
    film: int
    bodies: int
    water: int
    column: int
    exact: int  # grains move after the shear of their contacts
    laws: FluidLaws


class LawChoice(NamedTuple):
    """Laws of a scene by number (laws.families), as kernels pick them while they run."""

    slip: int
    cap: int
    tension: int
    rolling: int
    arm: int
    events: int
    profile: int
    above: int
    drag: int
    torque: int
    buoyancy: int
    hindrance: int
    lift: int
    magnus: int
    rebound: int
    unloading: int
    drag_of_form: int  # of rigid bodies
    adhesion: int


def resists_spin(scene: Scene) -> bool:
    """Whether contacts have rolling or twisting friction."""
    return scene.rolling.model != Rolling.NONE or scene.rolling.twisting > 0.0


def variant_of(scene: Scene) -> KernelVariant:
    """The kernel this scene needs."""
    return KernelVariant(
        plane_case=int(scene.plane_case),
        rotation=int(scene.rotation),
        rolling=int(scene.rotation and resists_spin(scene)),
        events=int(scene.events != EventRule.NONE),
        column=int(scene.water.profile == Profile.COLUMN),
        film=int(scene.water.profile != Profile.NONE and scene.water.film_reach > 0.0),
        water=int(scene.water.profile != Profile.NONE),
        exact=int(int(scene.contact.timing) == EXACT),
        walls=int(scene.n_face > 0),
        hertz=int(int(scene.contact.force) == HERTZ),
        mixed=int(scene.materials is not None),
        bodies=int(scene.bodies is not None),
        adhesive=int(scene.contact.adhesion != Adhesion.NONE),
    )


def choice_of(scene: Scene) -> LawChoice:
    """The laws this scene names."""
    law, rolling, water = scene.contact, scene.rolling, scene.water
    own = {
        "rolling": rolling.model,
        "arm": rolling.arm,
        "events": scene.events,
        "rebound": water.rebound if water.profile != Profile.NONE else 0,
    }
    for name in LawChoice._fields:  # others have the name that they have in the scene
        if name not in own:
            own[name] = getattr(law if hasattr(law, name) else water, name)
    return LawChoice(**{name: int(one) for name, one in own.items()})


def forces_kind(variant: KernelVariant, choice: LawChoice) -> ForcesKind:
    """Forces of contacts that this variant needs."""
    own = {name: getattr(variant, name) for name in ForcesKind._fields if name != "rebound"}
    return ForcesKind(**own, rebound=int(variant.water and choice.rebound != 0))


def motion_kind(variant: KernelVariant, choice: LawChoice) -> MotionKind:
    """Motion of grains that this variant needs."""
    laws = FluidLaws(*(getattr(choice, name) if variant.water else 0 for name in FluidLaws._fields))
    if not variant.rotation:
        laws = laws._replace(torque=0)
    return MotionKind(
        variant.plane_case, variant.rotation, int(variant.rolling or variant.events), variant.film,
        variant.bodies, variant.water, variant.column, variant.exact, laws,
    )  # fmt: skip
