"""`ryusa design`: range of stable stiffness for a grain, and what follows from it."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from ryusa.measure.stability import Grain, StiffnessChoice

_OF_ADHESION = (
    ("overlap/d by the pull-off force alone [-]", "overlap_adhesion"),
    ("sticking speed, head-on on a fixed partner [m/s]", "sticking"),
)
RATE = 5.0e6  # grain steps per second and core, assumed for the cost


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("design")(design)


def design(
    diameter: Annotated[str, typer.Option(help="Grain diameter, such as 0.2cm.")],
    speed: Annotated[str, typer.Option(help="Impact speed, such as 0.6m/s.")],
    density: Annotated[str, typer.Option(help="Density of the grains.")] = "2650 kg/m3",
    restitution: Annotated[
        float, typer.Option(help="Normal restitution e of a contact without tension.")
    ] = 0.7,
    water: Annotated[bool, typer.Option("--water/--dry", help="Include added mass, C_M = 0.5.")] = False,
    pull_off_force: Annotated[
        str, typer.Option(help="Pull-off force of adhesion between two grains, such as 0.1mN.")
    ] = "0 N",
    steps_per_contact: Annotated[
        float | None,
        typer.Option(help="Steps in the shortest contact; default as a case takes them that gives none."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for charts (PNG, SVG) and CSV.")
    ] = None,
) -> None:
    """Print the stiffness that keeps overlap/d in the stable range, and draw fig4, fig8, fig11 and fig12."""
    from rich.console import Console

    from ryusa.casefile.record.time import steps_of_law
    from ryusa.errors import CaseError
    from ryusa.laws.families import ContactTiming
    from ryusa.measure.stability import choice, stable_range

    if not 0.0 < restitution <= 1.0:
        raise CaseError("--restitution", restitution, "must be above 0 and at most 1")
    if steps_per_contact is not None and not 10.0 <= steps_per_contact <= 1.0e4:
        raise CaseError("--steps-per-contact", steps_per_contact, "must be at least 10 and at most 10000")
    grain = _grain(diameter, density, restitution, speed, water, pull_off_force)
    if steps_per_contact is None:
        timing = ContactTiming.AT_STEPS if grain.pull_off > 0.0 else ContactTiming.EXACT
        steps_per_contact = steps_of_law(False, timing, restitution == 1.0)
    soft, stiff = stable_range(grain)
    chosen = [choice(grain, k, steps_per_contact, RATE) for k in (soft, (soft * stiff) ** 0.5, stiff)]
    console = Console(width=None if sys.stdout.isatty() else 120)
    place = "in water (with added mass)" if water else "dry"
    console.print(
        f"grain d = {grain.d * 1e3:g} mm, {grain.rho_s:g} kg/m3, mass {grain.m:.4g} kg, {place}; "
        f"e = {restitution:g}, impact at {grain.speed:g} m/s"
    )
    console.print(f"stable range 0.001 < overlap/d < 0.01: k_n = {soft:.4g} to {stiff:.4g} N/m")
    if grain.pull_off > 0.0:
        console.print(
            f"pull-off force over weight of a grain (Bond number): {grain.bond_number:.4g}; "
            "contact times and overlaps are those without adhesion"
        )
    console.print(_table(chosen, steps_per_contact))
    if chosen[0].travel > 0.3:
        console.print("speed x contact time / d is above 0.3: a grain passes over a crest before it rebounds")
    if output is not None:
        for path in _write(grain, chosen, output):
            console.print(f"wrote {path}", soft_wrap=True, highlight=False)


def _grain(
    diameter: str, density: str, restitution: float, speed: str, water: bool, pull_off: str
) -> "Grain":
    from ryusa.errors import CaseError
    from ryusa.measure.stability import RHO_W, Grain

    grain = Grain(
        d=_positive("--diameter", diameter, "m"),
        rho_s=_positive("--density", density, "kg/m3"),
        e=restitution,
        speed=_positive("--speed", speed, "m/s"),
        water=water,
        pull_off=_positive("--pull-off-force", pull_off, "N", least=0.0),
    )
    if water and grain.pull_off > 0.0 and grain.rho_s <= RHO_W:
        raise CaseError("--density", density, "must be above 1000 kg/m3 with --water and --pull-off-force")
    return grain


def _positive(key: str, text: str, unit: str, least: float | None = None) -> float:
    from ryusa.errors import CaseError
    from ryusa.units import UnitError, quantity

    try:
        value = quantity(text, unit)
    except UnitError as error:
        raise CaseError(key, text, str(error)) from None
    if not (value > 0.0 if least is None else value >= least):
        raise CaseError(
            key, text, "must be above 0" if least is None else f"must be at least {least:g} {unit}"
        )
    return value


def _table(chosen: "list[StiffnessChoice]", steps_per_contact: float) -> "Table":
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    for name in ("softest in range", "middle", "stiffest in range"):
        table.add_column(name, justify="right")
    lines: list[tuple[str, str]] = [
        ("normal stiffness k_n [N/m]", "k_n"),
        ("tangential stiffness k_s = 2/7 k_n [N/m]", "k_s"),
        ("Young's modulus of the same overlap, Hertz-Mindlin, nu = 0.25 [Pa]", "youngs_modulus"),
        ("largest overlap/d, fixed partner [-]", "overlap_fixed"),
        ("largest overlap/d, free partner [-]", "overlap_free"),
        ("Eq. (8), no dashpot, no added mass [s]", "eq_8"),
        ("contact time, fixed partner [s]", "time_fixed"),
        ("contact time, free partner [s]", "time_free"),
        ("dashpot eta_n, fixed partner [N s/m]", "eta_fixed"),
        ("dashpot eta_n, free partner [N s/m]", "eta_free"),
        *(_OF_ADHESION if chosen[0].overlap_adhesion > 0.0 else ()),
        (f"step dt at {steps_per_contact:g} steps per contact [s]", "dt"),
        ("speed x contact time / d [-]", "travel"),
        ("steps per simulated second", "steps"),
        (f"computing per simulated second, 1000 grains at {RATE:.0e} grain steps/s [s]", "cost"),
    ]
    for text, name in lines:
        table.add_row(text, *(f"{getattr(one, name):.4g}" for one in chosen))
    return table


def _write(grain: "Grain", chosen: "list[StiffnessChoice]", folder: Path) -> list[Path]:
    import numpy as np

    from ryusa.errors import ResultsError
    from ryusa.figures import charts, save
    from ryusa.measure import write_csv
    from ryusa.measure.stability import chart_around

    near = grain.d * np.array([0.25, 0.5, 1.0, 2.0, 5.0])
    large = grain.d * np.array([25.0, 50.0, 100.0, 250.0, 500.0])
    small, big = chart_around(grain, near), chart_around(grain, large)
    pictures = {
        "contact-time": charts.times(small, grain, band=False),
        "overlap": charts.overlaps(small, grain),
        "band": charts.times(small, grain, band=True),
        "band-large-grains": charts.times(big, grain, band=True),
    }
    try:
        kinds = (".png", ".svg")
        paths = [save(one, folder / (name + kind)) for name, one in pictures.items() for kind in kinds]
        paths.append(write_csv(folder / "design.csv", [one.row() for one in chosen]))
        paths.append(write_csv(folder / "charts.csv", [*small.rows(), *big.rows()]))
    except OSError as error:
        raise ResultsError(f"{folder}: cannot be written ({error.strerror or error})") from None
    return paths
