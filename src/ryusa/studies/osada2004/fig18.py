"""Fig. 18, a sketch: long contacts carry grains along together, short ones scatter them."""

from collections.abc import Callable, Mapping, Sequence

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.studies.osada2004 import _debris
from ryusa.studies.osada2004._debris import SETTLED, Debris
from ryusa.studies.osada2004._parts import PHI, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Finding, Trial, over_seeds, pool, short

FIGURE = "fig18"
TITLE = "Effect of long and short contacts on the paths of grains"
CLAIMS = ("fig18",)
LONGER = "contacts longer by"
SHIPPED = {LONGER: "30", PHI: "30 deg", SLIP: "spring"}
K_N, K_S, ETA_N, ETA_S = 200.0, 15.0, 1.0e-3, 1.0e-4  # of fig17 [N/cm], [N s/cm]
KEYS = {PHI: "contact.friction_angle", SLIP: "contact.slip"}
TOGETHER = Band(
    0.1,
    float("inf"),
    "-",
    "carried along together: the correlation of touching grains is larger by at least 0.1",
)
DAMPED = Band(0.0, 0.95, "-", "vertical motion damped: at most 0.95 of that with short contacts")
FLATTER = Band(0.0, 0.95, "-", "nearer to parallel layers: paths at most 0.95 times as steep")
PARTS: tuple[tuple[str, Callable[[Debris, Debris], float], Band], ...] = (
    (
        "correlation of the speeds of grains that touch, long minus short",
        lambda long, short: long.companions - short.companions,
        TOGETHER,
    ),
    ("vertical speed (rms), long over short", lambda long, short: long.rms_z / short.rms_z, DAMPED),
    (
        "vertical speed over speed along the bed, long over short",
        lambda long, short: long.steep / short.steep,
        FLATTER,
    ),
)

measure = _debris.measure


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices, the shipped one first."""
    changes = plan.pick(
        (),
        ((LONGER, ("3", "10")), (SLIP, ("total",)), (PHI, ("20 deg",))),
        (
            (LONGER, ("3", "10", "60")),
            (SLIP, ("total", "spring-drop")),
            (PHI, ("10 deg", "20 deg", "40 deg")),
        ),
    )
    return [SHIPPED, *({**SHIPPED, name: value} for name, values in changes for value in values)]


def _run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """Contacts so many times as long as in fig17; those of once are its own case."""
    keys = {KEYS[name]: value for name, value in chosen.items() if name in KEYS and SHIPPED[name] != value}
    longer = chosen[LONGER]
    if longer == "1":
        return paper_run(_debris.CASE, keys, seed)
    if longer != SHIPPED[LONGER]:
        s = float(longer)
        keys |= {
            "contact.stiffness": f"{K_N / s**2:.5g} N/cm",
            "contact.shear_stiffness": f"{K_S / s**2:.5g} N/cm",
            "contact.damping": f"{ETA_N / s:.5g} N s/cm",
            "contact.shear_damping": f"{ETA_S / s:.5g} N s/cm",
        }
        if s > float(SHIPPED[LONGER]):  # so long a step would carry a grain a quarter of its diameter
            keys["time.steps_per_contact"] = f"{10.0 * s / float(SHIPPED[LONGER]):g}"
    return paper_run("fig18", keys, seed)


def _short(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _run({**chosen, LONGER: "1"}, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Long and short contacts for every setting and seed."""
    both = [(one, seed) for one in settings(plan) for seed in plan.seeds]
    return list(dict.fromkeys(which(one, seed) for one, seed in both for which in (_run, _short)))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """More alike, and less up and down."""
    trials: list[Trial] = []
    for part, value, band in PARTS:
        groups = [
            [value(found[_run(one, seed)], found[_short(one, seed)]) for seed in plan.seeds]
            for one in settings(plan)
        ]
        spread = pool(groups)
        trials += [
            Trial(part, one, over_seeds(values, band.unit, spread), band)
            for one, values in zip(settings(plan), groups, strict=True)
        ]

    def text(value: Callable[[Debris], float], chosen: Mapping[str, str]) -> str:
        values = [value(found[_run(chosen, seed)]) for seed in plan.seeds]
        return short(sum(values) / len(values))

    times = [one for one in settings(plan) if one == SHIPPED | {LONGER: one[LONGER]}]
    series = "; ".join(
        f"{one[LONGER]} times: contact {text(lambda run: run.contacts['all contacts'].time, one)} s, "
        f"correlation {text(lambda run: run.companions, one)}, "
        f"{text(lambda run: 100.0 * run.rms_z, one)} cm/s up and down, "
        f"{text(lambda run: run.speed, one)} m/s along"
        for one in sorted([SHIPPED | {LONGER: "1"}, *times], key=lambda one: float(one[LONGER]))
    )
    return (
        Finding(
            "fig18",
            tuple(trials),
            "A contact that lasts as long as a grain needs to pass its neighbour has not ended when the "
            f"next begins: grains stay in touch and share the momentum that one of them gains. {series}.",
            {
                **{
                    name: value for name, value in SETTLED.items() if name not in {"k_n, k_s", "eta_n, eta_s"}
                },
                "short": "contacts of fig17, k_n 200 N/cm; long: springs over n^2, dashpots over n, so that "
                "restitution and k_s/k_n stay",
                "rotation": "locked",
            },
            also=(
                "contacts 100 times as long (0.009 s on a fixed grain, the time that the paper takes as "
                "realistic) would have overlaps of three quarters of the diameter at these speeds",
            ),
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    sets = settings(plan)
    every = [*sets, *({**one, LONGER: "1"} for one in sets)]
    unique = list({tuple(one.items()): one for one in every}.values())
    return [
        {**one, "seed": seed, **_debris.row(found[_run(one, seed)])} for one in unique for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Ways with long and short contacts over the same length, and the profiles."""
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {
        "(a) long": found[_run(SHIPPED, seed)],
        "(b) short": found[_short(SHIPPED, seed)],
    }
    far = min(float((one.path.x[-1] - one.path.x[0]).min()) for one in runs.values())
    return {
        "fig18": figures.tracks_side_by_side({name: one.path for name, one in runs.items()}, far, "cm"),
        "fig18-profiles": figures.profiles(
            {name: one.profile for name, one in runs.items()}, ("phi", "v_x", "temperature_z")
        ),
    }
