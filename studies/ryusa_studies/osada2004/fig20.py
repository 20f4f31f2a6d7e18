"""Fig. 20: saltation with rotation locked and free, k_n = 100 N/cm; jumps and the shear on the bed."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding
from ryusa_studies.osada2004 import _saltation
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import FREE, LOCKED, SHIPPED, Group, SaltationRun
from ryusa_studies.osada2004.figures import SensitivityRow, sensitivity

FIGURE = "fig20"
TITLE = "Saltation with and without rotation"
CLAIMS = ("fig20", "fig20-shear")
WAY = 0.3  # shown of each path [m]
# part of the claim -> average
JUMPS = {
    "mean jump height, free over locked": "jump_height",
    "mean jump length, free over locked": "jump_length",
}
PART_SHEAR = "bed shear, free over locked"
SHEAR = "shear resistance"  # the choice of what is meant by it
SHEARS = {
    "impulse against the flow, per time": "bed_shear",
    "impulse against the flow, per bounce": "impulse_shear",
    "impulse against the flow over the normal one": "shear_ratio",
    "friction force alone, per time": "bed_friction",
    "friction force alone, per bounce": "impulse_friction",
}
# averages drawn of every setting, with their axis
PANELS = {
    "jump_height": "height / d",
    "jump_length": "length / d",
    "contact_time_over_eq8": "contact time / Eq. (8)",
    "spin_before": "spin (rad/s)",
    "shear_ratio": "shear / normal",
}


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free for every setting and seed."""
    return [
        _saltation.run(one, rotation, seed)
        for one in _saltation.settings(plan)
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
    ]


measure = _saltation.measure


def _pair(found: Found, plan: Plan, chosen: Mapping[str, str]) -> tuple[Group, Group]:
    """Free runs and locked ones of a setting."""
    free, locked = (
        [found[_saltation.run(chosen, rotation, seed)] for seed in plan.seeds] for rotation in (FREE, LOCKED)
    )
    return free, locked


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Free: higher and longer jumps, about half the shear on the bed."""
    sets = _saltation.settings(plan)
    pairs = [_pair(found, plan, one) for one in sets]
    jumps = [
        trial
        for part, name in JUMPS.items()
        for trial in _saltation.trials(
            "fig20", part, sets, [_saltation.ratios(*pair, name) for pair in pairs]
        )
    ]
    shears = [
        trial
        for way, name in SHEARS.items()
        for trial in _saltation.trials(
            "fig20-shear",
            PART_SHEAR,
            [{**one, SHEAR: way} for one in sets],
            [_saltation.ratios(*pair, name) for pair in pairs],
        )
    ]
    free, locked = pairs[0]
    normal = _saltation.ratio(free, locked, "bed_normal")
    return (
        finding(
            "fig20",
            jumps,
            also=[
                f"{words}, rotation {rot}: {_saltation.mean(here, name, 'm')}"
                for rot, here in ((LOCKED, locked), (FREE, free))
                for words, name in (("mean jump height", "jump_height"), ("mean jump length", "jump_length"))
            ],
        ),
        finding(
            "fig20-shear",
            shears,
            also=[
                f"{words}, rotation {rot}: {_saltation.mean(here, name, unit)}"
                for rot, here in ((LOCKED, locked), (FREE, free))
                for words, name, unit in (
                    ("shear over normal impulse", "shear_ratio", "-"),
                    ("impulse against the flow per time", "bed_shear", "N"),
                    ("of it friction force alone", "bed_friction", "N"),
                )
            ],
            normal=normal,
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per average, run and setting."""
    return [
        {**one, "rotation": rotation, "seed": seed, **row}
        for one in _saltation.settings(plan)
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
        for row in found[_saltation.run(one, rotation, seed)].found.rows()
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Paths of both, how their jumps are distributed, and what the settings do."""
    free, locked = (one[0] for one in _pair(found, plan, SHIPPED))
    base: dict[str, SaltationRun] = {"rotation locked": locked, "rotation free": free}
    pictures = {
        "fig20": figures.tracks_side_by_side({name: one.path for name, one in base.items()}, WAY),
        "fig20-hops": figures.hops({name: one.found for name, one in base.items()}, free.d),
    }
    sets = _saltation.settings(plan)
    if len(sets) > 1:
        lines = [
            SensitivityRow(
                "as shipped" if k == 0 else f"setting {k}",
                {
                    f"rotation {rot}": [
                        found[_saltation.run(one, rot, plan.seeds[0])].found[name] for name in PANELS
                    ]
                    for rot in (LOCKED, FREE)
                },
            )
            for k, one in enumerate(sets)
        ]
        scales = (1 / free.d, 1 / free.d, 1.0, 1.0, 1.0)
        pictures["free-choices"] = sensitivity(lines, tuple(PANELS.values()), scales)
    return pictures
