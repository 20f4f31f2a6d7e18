"""Every choice that the paper leaves open in its saltation runs, changed one at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure import Saltation, saltation
from ryusa.results import Results

FIGURE = "fig7, fig20"
TITLE = "Effect of every free choice on saltation"
SHOWN: tuple[str, ...] = (
    "choice", "rotation", "jump_height [m]", "jump_height error", "jump_length [m]", "jump_length error",
    "contact_time_over_eq8 [-]", "spin_before [rad/s]", "impulse_shear [N s]", "shear_ratio [-]",
)  # fmt: skip
BASE = "as in the case file"
CASE = "paper/fig20.toml"
HOPS = 30
HALF = (0.35, 0.65)  # shares called about half

# label -> overrides; the case file holds the base: roughness d, zero d/4 below the crest, 24/Re+0.4, 30 deg,
# k_s/k_n 2/7, cap on the spring with its dashpot kept, no tension, profile goes on above the water, e_s 0.7
CHOICES: dict[str, dict[str, str]] = {
    BASE: {},
    "k_rough = d/2": {"water.roughness": "0.1 cm"},
    "k_rough = 2 d": {"water.roughness": "0.4 cm"},
    "z = 0 at the crest": {"water.zero": "0.2 cm"},
    "z = 0 at the centres": {"water.zero": "0.1 cm"},
    "C_D = 24/Re + 2": {"water.drag": "24/Re+2"},
    "C_D Schiller-Naumann": {"water.drag": "Schiller-Naumann"},
    "C_D Ferguson-Church sphere": {"water.drag": "Ferguson-Church sphere"},
    "C_D Ferguson-Church sand": {"water.drag": "Ferguson-Church sand"},
    "viscosity at 10 °C": {"water.viscosity": "1.3e-6 m2/s"},
    "phi = 10 deg": {"contact.friction_angle": "10 deg"},
    "phi = 20 deg": {"contact.friction_angle": "20 deg"},
    "phi = 25 deg": {"contact.friction_angle": "25 deg"},
    "phi = 35 deg": {"contact.friction_angle": "35 deg"},
    "phi = 40 deg": {"contact.friction_angle": "40 deg"},
    "k_s/k_n = 15/200": {"contact.shear_ratio": "0.075"},
    "k_s/k_n = 0.8": {"contact.shear_ratio": "0.8"},
    "dashpot dropped while sliding": {"contact.slip": "spring-drop"},
    "cap on spring + dashpot": {"contact.slip": "total"},
    "dashpot may pull": {"contact.parting": "tension"},
    "e_s = 0.5": {"contact.restitution_shear": "0.5"},
    "e_s = 0.9": {"contact.restitution_shear": "0.9"},
    "e_s = 1 (no shear dashpot)": {"contact.restitution_shear": "1.0"},
    "cap on sum, phi = 10 deg": {"contact.slip": "total", "contact.friction_angle": "10 deg"},
    "cap on sum, phi = 20 deg": {"contact.slip": "total", "contact.friction_angle": "20 deg"},
    "dashpot dropped, phi = 10 deg": {"contact.slip": "spring-drop", "contact.friction_angle": "10 deg"},
    "A_2 = 1.2 pi/4": {"water.shape_area": "0.94248"},
    "A_3 = 0.8 pi/6": {"grains.shape_volume": "0.41888"},
    "above 2 cm surface speed": {"water.above": "hold"},
    "above 2 cm no drag": {"water.above": "dry"},
    "water torque, Dennis": {"water.torque": "Dennis"},
    "other starts (seed 2)": {"seed": "2"},
    "started 1 cm above the bed": {"build.start_height": "1 cm"},
    "20 steps per contact": {"time.steps_per_contact": "20"},
    "200 steps per contact": {"time.steps_per_contact": "200"},
}
RISES = {"hops rise above 0.02 d": 0.02, "hops rise above 0.5 d": 0.5}  # read from the base run
ONLY_FREE = {"water torque, Dennis"}  # without spin it does nothing
REPORTED = (
    "jump_height", "jump_height_crest", "jump_length", "speed", "contact_time_over_eq8", "spin_before",
    "bed_shear", "impulse_shear", "shear_ratio", "contacts_per_bounce",
)  # fmt: skip


@dataclass(frozen=True)
class Table:
    """What came out, by choice and state of rotation."""

    found: Mapping[tuple[str, str], Saltation]
    d: float  # [m]

    def rows(self) -> list[dict[str, object]]:
        """One line per choice and state of rotation, each average beside its standard error."""
        rows: list[dict[str, object]] = []
        for (label, rotation), one in self.found.items():
            row: dict[str, object] = {"choice": label, "rotation": rotation, "n_hops": len(one.hops)}
            for name in REPORTED:
                average = one[name]
                row |= {f"{name} [{average.unit}]": average.value, f"{name} error": average.error}
            rows.append(row)
        return rows


def cases() -> Sequence[Variant]:
    """Every choice, with rotation locked and free."""
    return [
        Variant(_name(label, rotation), CASE, {"motion.rotation": rotation, **overrides})
        for rotation in ("locked", "free")
        for label, overrides in CHOICES.items()
        if rotation == "free" or label not in ONLY_FREE
    ]


def _name(label: str, rotation: str) -> str:
    return f"{rotation}-{list(CHOICES).index(label):02d}"


def measure(results: Mapping[str, Results]) -> Table:
    """Hops of every run; the base run also with other thresholds for a hop."""
    found: dict[tuple[str, str], Saltation] = {}
    d = 0.0
    for rotation in ("locked", "free"):
        for label in CHOICES:
            if _name(label, rotation) in results:
                run = results[_name(label, rotation)]
                found[label, rotation] = saltation(run, hops=HOPS)
                d = float(run.scene.d[0])
        for label, rise in RISES.items():
            found[label, rotation] = saltation(results[_name(BASE, rotation)], rise=rise, hops=HOPS)
    return Table(found, d)


def expect(table: Table) -> Sequence[Verdict]:
    """Which choices move the free-over-locked claims of Fig. 20, and by how much."""
    higher: dict[str, float] = {}
    shear: dict[str, float] = {}
    for label in [*CHOICES, *RISES]:
        if (label, "locked") in table.found and (label, "free") in table.found:
            locked, free = table.found[label, "locked"], table.found[label, "free"]
            higher[label] = free["jump_height"].value / locked["jump_height"].value
            shear[label] = free["impulse_shear"].value / locked["impulse_shear"].value
    half = [label for label, share in shear.items() if HALF[0] < share < HALF[1]]
    return (
        Verdict(
            "fig20",
            "free jumps are higher, whatever is chosen",
            f"height free over locked {_range(higher)}",
            min(higher.values()) > 1.0,
        ),
        Verdict(
            "fig20-shear",
            "bed shear resistance falls to about half, whatever is chosen",
            f"shear impulse per bounce free over locked {_range(shear)}; "
            f"{HALF[0]:g} to {HALF[1]:g} with {len(half)} of {len(shear)}: {', '.join(half) or 'none'}",
            len(half) == len(shear),
        ),
    )


def _range(shares: Mapping[str, float]) -> str:
    low, high = min(shares, key=shares.__getitem__), max(shares, key=shares.__getitem__)
    return f"{shares[low]:.2f} ({low}) to {shares[high]:.2f} ({high})"


def draw(table: Table) -> Mapping[str, Figure]:
    """One row per choice: height, length, contact time, spin, shear."""
    labels = [BASE, *[one for one in CHOICES if one != BASE], *RISES]
    panels = ("jump_height", "jump_length", "contact_time_over_eq8", "spin_before", "shear_ratio")
    rows = [
        figures.Choice(
            label,
            {
                f"rotation {rotation}": [table.found[label, rotation][name] for name in panels]
                for rotation in ("locked", "free")
                if (label, rotation) in table.found
            },
        )
        for label in labels
    ]
    titles = ("height / d", "length / d", "contact time / Eq. (8)", "spin (rad/s)", "shear / normal")
    return {"free-choices": figures.choices(rows, titles, (1 / table.d, 1 / table.d, 1.0, 1.0, 1.0))}
