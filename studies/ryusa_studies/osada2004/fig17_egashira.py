"""Fig. 17 against measurement: Egashira's closed forms for the case, and how parallel the paths are."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.errors import OverlapTooLarge, RyusaError, WaterError
from ryusa.figures.comparison import Axis, Curve, compared
from ryusa.laws.debris import equilibrium_concentration
from ryusa.measure import collisions, profiles
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Finding, Trial, exact, over_seeds, seeds_trial, short
from ryusa_studies.osada2004 import _debris
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._debris_run import LAYER, concentration, inside
from ryusa_studies.osada2004._egashira import DebrisFlow
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parallel import STRETCHES, Parallel, parallel
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

FIGURE = "fig17"
TITLE = "Ito's debris flow against Egashira's closed forms, and how parallel its paths are"
CLAIMS = ("fig17-egashira", "fig17-parallel")
TIME = "collision time"
OF_CASE = "8.4e-5 s"  # by Eq. (8), of the 200 N/cm of the paper
ONE_LONG = 8.4226e-5  # the same with more digits [s]
TIMES = (OF_CASE, "1e-5 s", "1e-3 s", "1e-2 s")
STEPS = {"1e-3 s": "30", "1e-2 s": "1200"}  # in the shortest contact: as many as resolve drag and water
ANGLE, STRETCH = "friction angle of the closed form", "way along the bed"
SAND, GRAINS = "38 deg", "that of the grains"
THIN = 0.01  # concentration of a layer whose speed counts
SPEED = "mean grain speed over that of the closed form"
OF_PROFILE = ("speed", "concentration", "flux")
PROFILE = "difference of the profile of {} from the closed form"
CHANGE = "change of height along a path, in diameters"
STANDS = "by the closed form friction between grains at rest holds the flow"
THROUGH = "grains pass through each other: {} of {} runs stopped"


def _springs(time: str) -> dict[str, str]:
    """Constants for a collision time; restitution and k_s/k_n stay."""
    if time == OF_CASE:
        return {}
    longer = float(time.removesuffix(" s")) / ONE_LONG
    keys = _debris.longer_by(f"{longer:.6g}")
    return {**keys, "time.steps_per_contact": STEPS.get(time, "10")}


DESIGN = design("fig17_egashira", {TIME: {one: _springs(one) for one in TIMES}})
SHIPPED = DESIGN.base


@dataclass(frozen=True)
class BesideClosedForms:
    """One run, after it has settled.

    Attributes
    ----------
    flow : the case, with the friction angle of its grains.
    c : volume of grains over that of the depth [-].
    speed : of all grains, mean over time [m/s].
    q : flux of grains per width [m2/s].
    z : heights of the middles of the layers above the crest of the bed [m]; below the surface of the water.
    weight : height of each layer that lies in the depth [m].
    phi, v : concentration [-] and speed [m/s] of the layers.
    upper : concentration in the upper third of the depth [-].
    paths : how parallel they are.
    overlap : largest overlap over d, mean over contacts [-].
    along : way of a grain along the bed during a contact, in diameters.
    """

    flow: DebrisFlow
    c: float
    speed: float
    q: float
    z: Floats
    weight: Floats
    phi: Floats
    v: Floats
    upper: float
    paths: Parallel
    overlap: float
    along: float

    def beside(self, angle: str) -> DebrisFlow:
        """Flow of the closed form, by a reading of its friction angle."""
        if angle == GRAINS:
            return self.flow
        return DebrisFlow(
            self.flow.slope, self.flow.depth, self.flow.d, self.flow.rho_s, self.flow.rho_w, self.flow.g,
            math.radians(float(SAND.split(maxsplit=1)[0])),
        )  # fmt: skip

    def speed_ratio(self, angle: str) -> float:
        """Mean speed of the grains over that of the closed form with as many of them; nan where that is 0."""
        closed = self.beside(angle).mean_speed(self.c)
        return self.speed / closed if closed > 0.0 else math.nan

    def misfit(self, what: str, angle: str) -> float:
        """Root mean square over the depth of a profile less that of the closed form, in units of the latter.

        Speed counts over that of the surface, concentration over its mean, flux over the product of both.
        """
        flow = self.beside(angle)
        top = flow.surface_speed(self.c)
        if top <= 0.0 and what != "concentration":
            return math.nan
        closed = flow.speed(self.z, self.c)
        there = self.phi > THIN
        away = {
            "speed": lambda: np.where(there, self.v - closed, 0.0) / top,
            "concentration": lambda: self.phi / self.c - 1.0,
            "flux": lambda: (self.phi * self.v - self.c * closed) / (self.c * top),
        }[what]()
        weight = self.weight * there if what == "speed" else self.weight
        return math.sqrt(float(weight @ away**2) / float(weight.sum()))


@dataclass(frozen=True)
class PassedThrough:
    """A run that stopped because grains came into each other by half a diameter, or left water no room."""

    said: str


def failed(error: RyusaError) -> PassedThrough | None:
    """Grains that pass through each other are a result: contacts this long do not keep grains apart.

    Where many are pressed together at once the water stops the run first: the drag that it would have in what
    is left between them has no end.
    """
    return PassedThrough(str(error)) if isinstance(error, OverlapTooLarge | WaterError) else None


settings = DESIGN.sets


def sweep(plan: Plan) -> list[dict[str, str]]:
    """The case as it ships with every collision time; at the quick level only as it ships."""
    return [{**SHIPPED, TIME: one} for one in plan.pick(TIMES[:1], TIMES)]


def run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """One run."""
    return paper_run(_debris.CASE, DESIGN.overrides(chosen), seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting, and every collision time as shipped otherwise, with every seed."""
    return list(
        dict.fromkeys(run(one, seed) for one in [*settings(plan), *sweep(plan)] for seed in plan.seeds)
    )


def measure(results: Results, one: CaseRun) -> BesideClosedForms:
    """Profiles, paths and contacts of a run."""
    del one
    profile = profiles(results, layer=LAYER, above="mean crest", bed=True)
    begin, end = float(profile.t[0]), float(profile.t[-1])
    t = np.asarray(results.frames.t)
    kept = slice(int(np.searchsorted(t, begin)), int(np.searchsorted(t, end)) + 1)
    x = np.asarray(results.frames.x[kept], dtype=np.float64)
    water, scene = results.water, results.scene
    assert water is not None
    assert scene.water is not None
    depth = float(water.z_surface[water.t >= begin].mean()) - profile.origin
    weight = inside(profile, 0.0, depth)
    there = weight > 0.0
    contacts = collisions(results)
    touched = len(contacts.events) > 0
    speed = float(profile.speed.mean())
    return BesideClosedForms(
        flow=DebrisFlow(
            math.atan2(float(scene.gravity[0]), -float(scene.gravity[2])), depth, profile.d, profile.density,
            scene.water.rho_w, float(np.linalg.norm(scene.gravity)), math.atan(scene.contact.mu),
        ),
        c=float(profile.volume.mean()) / depth,
        speed=speed,
        q=float(profile.q.mean()),
        z=profile.z[there],
        weight=weight[there],
        phi=np.nan_to_num(profile.phi.value[there]),
        v=np.nan_to_num(profile.v_x.value[there]),
        upper=concentration(profile, 2.0 / 3.0 * depth, depth),
        paths=parallel(x[:, :, 0], x[:, :, 2], profile.d),
        overlap=contacts["overlap_over_d"].value if touched else math.nan,
        along=speed * contacts["duration"].value / profile.d if touched else math.nan,
    )  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Profiles against the closed forms; paths against parallel layers."""
    return _of_profiles(found, plan), _of_paths(found, plan)


def _runs(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[BesideClosedForms]:
    """Runs of a setting that went to their end."""
    every = [found[run(chosen, seed)] for seed in plan.seeds]
    return [one for one in every if isinstance(one, BesideClosedForms)]


def _trial(plan: Plan, claim: str, part: str, chosen: Mapping[str, str], values: Sequence[float]) -> Trial:
    """Mean over seeds; a part fails where the closed form stands, or where grains pass through each other."""
    limits = band(claim, part)
    lost = len(plan.seeds) - len(values)
    note = THROUGH.format(lost, len(plan.seeds)) if lost else ""
    if lost or not np.isfinite(values).all():
        return Trial(part, chosen, exact(math.nan, limits.unit), limits, decided=False, note=note or STANDS)
    return seeds_trial(part, chosen, values, limits)


def _of_profiles(found: Found, plan: Plan) -> Finding:
    def tried(chosen: Mapping[str, str]) -> list[Trial]:
        runs = _runs(found, plan, chosen)
        return [
            _trial(
                plan, "fig17-egashira", part, {**chosen, ANGLE: angle}, [value(one, angle) for one in runs]
            )
            for angle in (SAND, GRAINS)
            for part, value in _PARTS.items()
        ]

    base = _runs(found, plan, SHIPPED)
    c, flow = float(np.mean([one.c for one in base])), base[0].beside(SAND)
    most = equilibrium_concentration(flow.slope, flow.friction_angle, flow.rho_s, flow.rho_w)
    return finding(
        "fig17-egashira",
        [trial for one in settings(plan) for trial in tried(one)],
        also=(
            *(_said(found, plan, one) for one in sweep(plan)),
            *(_stratified(base, angle) for angle in (SAND, GRAINS)),
            "the closed form has as many grains as the run, so that its flux differs from that of the run by "
            "the same factor as the speed",
        ),
        beside=[
            Trial(one.part, one.choices, one.found, None, note=one.note)
            for chosen in sweep(plan)[1:]
            for one in tried(chosen)
        ],
        most=short(most),
        c=short(c),
    )


_PARTS: Mapping[str, Callable[[BesideClosedForms, str], float]] = {
    SPEED: lambda one, angle: one.speed_ratio(angle),
    **{PROFILE.format(what): lambda one, angle, what=what: one.misfit(what, angle) for what in OF_PROFILE},
}


def _said(found: Found, plan: Plan, chosen: Mapping[str, str]) -> str:
    """Numbers of one collision time."""
    runs = _runs(found, plan, chosen)
    if lost := len(plan.seeds) - len(runs):
        return f"collision time {chosen[TIME]}: {THROUGH.format(lost, len(plan.seeds))}"

    def mean(value: Callable[[BesideClosedForms], float], unit: str = "-") -> str:
        return str(over_seeds([value(one) for one in runs], unit))

    return (
        f"collision time {chosen[TIME]}: mean speed {mean(lambda one: one.speed, 'm/s')}, closed form "
        f"{mean(lambda one: one.beside(SAND).mean_speed(one.c), 'm/s')}; flux "
        f"{mean(lambda one: 1.0e4 * one.q, 'cm2/s')}; concentration of the upper third "
        f"{mean(lambda one: one.upper)}; largest overlap over d, mean over contacts "
        f"{mean(lambda one: one.overlap)}; u t/d {mean(lambda one: one.along)}"
    )


def _stratified(runs: Sequence[BesideClosedForms], angle: str) -> str:
    """Shown, not judged: what follows where concentration and speed both come from the stresses."""
    c = float(np.mean([one.c for one in runs]))
    made = runs[0].beside(angle).stratified(c)
    if made is None:
        return f"friction angle {angle}: with concentration and speed both from the stresses, a deposit"
    z, phi, u = made
    upper = z > 2.0 / 3.0 * runs[0].flow.depth
    thick = float(np.trapezoid(np.where(upper, phi, 0.0), z)) / (runs[0].flow.depth / 3.0)
    return (
        f"friction angle {angle}: with concentration and speed both from the stresses (its pressure of "
        f"collisions is from memory: not judged), concentration of the upper third {short(thick)}, mean "
        f"speed of the grains {short(float(np.trapezoid(phi * u, z) / np.trapezoid(phi, z)))} m/s"
    )


def _of_paths(found: Found, plan: Plan) -> Finding:
    def tried(chosen: Mapping[str, str]) -> list[Trial]:
        runs = _runs(found, plan, chosen)
        return [
            _trial(
                plan, "fig17-parallel", CHANGE, {**chosen, STRETCH: f"{far:g} d"},
                [one.paths.change[far] for one in runs],
            )
            for far in STRETCHES
        ]  # fmt: skip

    def steep(chosen: Mapping[str, str]) -> str:
        steeps = [one.paths.steep for one in _runs(found, plan, chosen)]
        return str(over_seeds(steeps, "-")) if steeps else "none, grains pass through each other"

    return finding(
        "fig17-parallel",
        [trial for one in settings(plan) for trial in tried(one)],
        also=[
            f"collision time {one[TIME]}: heights gained and lost over the way, from diameter to diameter "
            f"{steep(one)}"
            for one in sweep(plan)
        ],
        beside=[
            Trial(one.part, one.choices, one.found, None, note=one.note)
            for chosen in sweep(plan)[1:]
            for one in tried(chosen)
        ],
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {
            **chosen, "seed": seed, "c": one.c, "speed_m_per_s": one.speed, "q_m2_per_s": one.q,
            "phi_upper": one.upper, "closed_m_per_s": one.beside(SAND).mean_speed(one.c),
            **{f"misfit_{what}": one.misfit(what, SAND) for what in OF_PROFILE},
            **{f"change_{far:g}d": change for far, change in one.paths.change.items()},
            "steep": one.paths.steep, "overlap": one.overlap, "along_in_a_contact_d": one.along,
        }
        for chosen in {tuple(one.items()): one for one in [*settings(plan), *sweep(plan)]}.values()
        for seed in plan.seeds
        for one in [found[run(chosen, seed)]]
        if isinstance(one, BesideClosedForms)
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Profiles of speed and concentration, by collision time, with the closed forms."""
    shown = {one[TIME]: runs[0] for one in sweep(plan) if (runs := _runs(found, plan, one))}
    base = shown[OF_CASE]
    height = Axis("height above the bed over d")
    fine = np.linspace(0.0, base.flow.depth, 100)
    made = base.beside(SAND).stratified(base.c)
    closed = {"speed": (base.beside(SAND).speed(fine, base.c), fine)}
    closed["concentration"] = (np.full_like(fine, base.c), fine)
    pictures: dict[str, Figure] = {}
    for what, x in {"speed": Axis("grain speed", "m/s"), "concentration": Axis("concentration")}.items():
        ours = [
            Curve(name, one.v if what == "speed" else one.phi, one.z / base.flow.d)
            for name, one in shown.items()
        ]
        lines = [Curve("closed form", closed[what][0], closed[what][1] / base.flow.d)]
        if made is not None:
            lines.append(
                Curve("both from stresses", made[2 if what == "speed" else 1], made[0] / base.flow.d)
            )
        pictures[f"fig17-egashira-{what}"] = compared(x, height, ours, lines)
    return pictures
