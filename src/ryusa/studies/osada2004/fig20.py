"""Fig. 20: saltation with rotation locked and free, k_n = 100 N/cm; jumps and the shear on the bed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.measure import Average, saltation
from ryusa.results import Results
from ryusa.studies.osada2004 import _saltation
from ryusa.studies.osada2004._parts import PHI, SLIP, CaseRun, Found, Plan
from ryusa.studies.osada2004._saltation import SHIPPED, SaltationRun
from ryusa.study import Band, Finding, Trial, over_seeds, pool

FIGURE = "fig20"
TITLE = "Saltation with and without rotation"
CLAIMS = ("fig20", "fig20-shear")
WAY = 0.3  # shown of each path [m]
LARGER = Band(1.0, float("inf"), "-", "free over locked above 1")
HALF = Band(0.35, 0.65, "-", "about half: free over locked 0.35 to 0.65")
# part of the claim -> average
JUMPS = {
    "mean jump height, free over locked": "jump_height",
    "mean jump length, free over locked": "jump_length",
}
IMPULSE = "impulse"  # the choice that fig20-shear leaves open
SHEARS = {"per time": "bed_shear", "per bounce": "impulse_shear", "over the normal impulse": "shear_ratio"}
OTHER = "other"  # whatever else the paper leaves open, one at a time
AS_SHIPPED = "as shipped"
OTHERS: dict[str, dict[str, str]] = {
    "k_rough = d/2": {"water.roughness": "0.1 cm"},
    "k_rough = 2 d": {"water.roughness": "0.4 cm"},
    "z = 0 at the crest": {"water.zero": "0.2 cm"},
    "z = 0 at the centres": {"water.zero": "0.1 cm"},
    "C_D = 24/Re + 2": {"water.drag": "24/Re+2"},
    "C_D Schiller-Naumann": {"water.drag": "Schiller-Naumann"},
    "C_D Ferguson-Church sphere": {"water.drag": "Ferguson-Church sphere"},
    "C_D Ferguson-Church sand": {"water.drag": "Ferguson-Church sand"},
    "viscosity at 10 °C": {"water.viscosity": "1.3e-6 m2/s"},
    "k_s/k_n = 0.8": {"contact.shear_ratio": "0.8"},
    "dashpot may pull": {"contact.parting": "tension"},
    "e_s = 0.5": {"contact.restitution_shear": "0.5"},
    "e_s = 0.9": {"contact.restitution_shear": "0.9"},
    "e_s = 1 (no shear dashpot)": {"contact.restitution_shear": "1.0"},
    "A_2 = 1.2 pi/4": {"water.shape_area": "0.94248"},
    "A_3 = 0.8 pi/6": {"grains.shape_volume": "0.41888"},
    "above 2 cm surface speed": {"water.above": "hold"},
    "above 2 cm no drag": {"water.above": "dry"},
    "started 1 cm above the bed": {"build.start_height": "1 cm"},
    "20 steps per contact": {"time.steps_per_contact": "20"},
    "200 steps per contact": {"time.steps_per_contact": "200"},
}
RISES = {"hops rise above 0.02 d": 0.02, "hops rise above 0.5 d": 0.5}  # read from the shipped runs
# averages drawn of every choice, with their axis
PANELS = {
    "jump_height": "height / d",
    "jump_length": "length / d",
    "contact_time_over_eq8": "contact time / Eq. (8)",
    "spin_before": "spin (rad/s)",
    "shear_ratio": "shear / normal",
}
Setting = tuple[dict[str, str], str]  # set of shared choices, label of the other one


@dataclass(frozen=True)
class Both:
    """Hops of one run; `regrouped` has the averages with other thresholds, by label, of the shipped runs."""

    hops: SaltationRun
    regrouped: Mapping[str, Mapping[str, Average]]

    def average(self, label: str, name: str) -> Average:
        """One average, with the threshold of that label where it names one."""
        return self.regrouped[label][name] if label in RISES else self.hops.found[name]


def settings(plan: Plan) -> list[Setting]:
    """Sets of choices; full: every other choice alone too."""
    others = plan.pick((), (), (*OTHERS, *RISES))
    return [*((one, AS_SHIPPED) for one in _saltation.choices(plan)), *((SHIPPED, label) for label in others)]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free for every setting and seed."""
    runs = [
        _run(one, rotation, seed)
        for one in settings(plan)
        for rotation in ("locked", "free")
        for seed in plan.seeds
    ]
    return list(dict.fromkeys(runs))


def _run(setting: Setting, rotation: str, seed: int) -> CaseRun:
    chosen, label = setting
    return _saltation.run(chosen, rotation, seed, OTHERS.get(label))


def measure(run: Results, one: CaseRun) -> Both:
    """Hops of all starts."""
    names = [*JUMPS.values(), *SHEARS.values(), *PANELS]
    regrouped: dict[str, dict[str, Average]] = {}
    if {key for key, _ in one.overrides} == {"motion.rotation", "seed"}:
        for label, rise in RISES.items():
            found = saltation(run, rise=rise, hops=_saltation.HOPS)
            regrouped[label] = {name: found[name] for name in names}
    return Both(_saltation.hops(run), regrouped)


def ratios(found: Found, plan: Plan, name: str) -> list[list[float]]:
    """Free over locked of one average, by setting, then seed."""
    values: list[list[float]] = []
    for one in settings(plan):
        pairs = [
            [found[_run(one, rot, seed)].average(one[1], name).value for rot in ("free", "locked")]
            for seed in plan.seeds
        ]
        values.append([free / locked for free, locked in pairs])
    return values


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Free: higher and longer jumps, about half the shear on the bed."""
    sets = [{**chosen, OTHER: label} for chosen, label in settings(plan)]
    jumps: list[Trial] = []
    for part, name in JUMPS.items():
        groups = ratios(found, plan, name)
        spread = pool(groups)
        jumps += [
            Trial(part, chosen, over_seeds(values, "-", spread), LARGER)
            for chosen, values in zip(sets, groups, strict=True)
        ]
    shears: list[Trial] = []
    for impulse, name in SHEARS.items():
        groups = ratios(found, plan, name)
        spread = pool(groups)
        shears += [
            Trial(
                "bed shear, free over locked",
                {**chosen, IMPULSE: impulse},
                over_seeds(values, "-", spread),
                HALF,
            )
            for chosen, values in zip(sets, groups, strict=True)
        ]
    locked, free = (found[_run((SHIPPED, AS_SHIPPED), rot, plan.seeds[0])].hops for rot in ("locked", "free"))
    normal = free.value("bed_normal") / locked.value("bed_normal")
    return (
        Finding(
            "fig20",
            tuple(jumps),
            "A locked grain is slowed by friction at every hit and leaves the bed slowly; a free grain, "
            "once it spins, rolls off, keeps its speed and hits the next crest faster.",
            settings={"k_n": "100 N/cm"},
            also=tuple(
                f"{words}, rotation {rot}: {one.value(name) / one.d:.3g} d"
                for rot, one in (("locked", locked), ("free", free))
                for words, name in (("mean jump height", "jump_height"), ("mean jump length", "jump_length"))
            ),
        ),
        Finding(
            "fig20-shear",
            tuple(shears),
            f"The mean normal force on the bed is nearly the same (free over locked {normal:.2f}), so the "
            "shear force decides. As printed (cap on the spring, dashpot kept) the shear force on a "
            "locked grain has no limit. A small friction angle, a dashpot that is capped or set to zero "
            "while sliding, or a softer shear spring reduce it and bring free and locked closer. A "
            "rotating grain has little slip.",
            settings={"k_n": "100 N/cm"},
            also=tuple(
                f"shear over normal impulse, rotation {rot}: {one.value('shear_ratio'):.2f}"
                for rot, one in (("locked", locked), ("free", free))
            ),
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per average, run and setting."""
    return [
        {**one[0], OTHER: one[1], "rotation": rotation, "seed": seed, **row}
        for one in settings(plan)
        if one[1] not in RISES
        for rotation in ("locked", "free")
        for seed in plan.seeds
        for row in found[_run(one, rotation, seed)].hops.found.rows()
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Paths of both, how their jumps are distributed, and what every choice does."""
    base = {
        f"rotation {rot}": found[_run((SHIPPED, AS_SHIPPED), rot, plan.seeds[0])].hops
        for rot in ("locked", "free")
    }
    paths = {name: one.path for name, one in base.items()}
    d = next(iter(base.values())).d
    pictures = {
        "fig20": figures.tracks_side_by_side(paths, WAY),
        "fig20-hops": figures.hops({name: one.found for name, one in base.items()}, d),
    }
    if len(settings(plan)) > 1:
        lines = [
            figures.SensitivityRow(
                _label(one),
                {
                    f"rotation {rot}": [
                        found[_run(one, rot, plan.seeds[0])].average(one[1], name) for name in PANELS
                    ]
                    for rot in ("locked", "free")
                },
            )
            for one in settings(plan)
            if one[1] != AS_SHIPPED or _few(one[0])
        ]
        scales = (1 / d, 1 / d, 1.0, 1.0, 1.0)
        pictures["free-choices"] = figures.sensitivity(lines, tuple(PANELS.values()), scales)
    return pictures


def _few(chosen: Mapping[str, str]) -> bool:
    """Whether one choice is changed at most, or shear is weak for two reasons; the table has them all."""
    changed = [name for name in SHIPPED if chosen[name] != SHIPPED[name]]
    return len(changed) <= 1 or (chosen[PHI] == "10 deg" and changed == [PHI, SLIP])


def _label(setting: Setting) -> str:
    """What a setting changes, in few words."""
    chosen, label = setting
    if label != AS_SHIPPED:
        return label
    changed = [
        value if name == SLIP else f"{'phi' if name == PHI else name} = {value}"
        for name, value in chosen.items()
        if value != SHIPPED[name]
    ]
    return ", ".join(changed) or AS_SHIPPED
