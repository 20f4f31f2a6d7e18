"""`ryusa measure`: numbers from a run folder."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

from ryusa.catalogue import BEDS, MEASURES, SIDES, called
from ryusa.cli import measure_options
from ryusa.cli.measure_options import entry_of, keywords, listed, naming, of_row, refuse_swapped, taking
from ryusa.cli.options import open_run, write_rows
from ryusa.errors import CaseError, ResultsError

if TYPE_CHECKING:
    from ryusa.measure import Averages
    from ryusa.results import Results

CHECKS: dict[str, measure_options.Check] = {
    "--at": measure_options.time,
    "--bed": measure_options.one_of(BEDS),
    "--begin": measure_options.time,
    "--dam": lambda _name, value, _results: value,
    "--end": measure_options.time,
    "--fps": measure_options.in_range(1.0, 1.0e6),
    "--material": lambda _name, value, _results: value,
    "--layer": measure_options.in_range(0.01, 100.0),
    "--reach": measure_options.reach,
    "--resolution": measure_options.in_range(0.001, 1.0),
    "--rise": measure_options.in_range(0.0, 100.0),
    "--settle": measure_options.time,
    "--side": measure_options.one_of(SIDES),
    "--threshold": measure_options.length,
    "--window": measure_options.window,
}


Runs = Annotated[
    list[Path],
    typer.Argument(metavar="RUN", help="A run folder, or several that differ in their seed."),
]
What = Annotated[str, typer.Argument(help=f"One of {', '.join(one.name for one in MEASURES)}.")]
Csv = Annotated[
    Path | None,
    typer.Option("--csv", metavar="FILE", help="Write the averages, or the table of a measure without any."),
]
SeriesFile = Annotated[
    Path | None,
    typer.Option(
        "--series",
        metavar="FILE",
        help="Write what was averaged as CSV: a time series, or single events; of sizes the mass by class.",
    ),
]
LayersFile = Annotated[
    Path | None,
    typer.Option(
        "--layers",
        metavar="FILE",
        help="profile, water, stress, contact_stress, coordination: write the layers over height as CSV.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the numbers as JSON instead of a table.")]
Settle = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('settle', MEASURES)}: leave out what happens before this time; default "
        "record.settle of the case."
    ),
]
Rise = Annotated[
    float,
    typer.Option(
        help=f"{taking('rise', MEASURES)}: a flight that rises less than this, in diameters, counts as "
        "part of one bounce."
    ),
]
Begin = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('begin', MEASURES)}: begin of the window; default the end of settling, "
        "for tracks and vibration the first frame, and for long_section one moment."
    ),
]
End = Annotated[
    str | None,
    typer.Option(help=f"{taking('end', MEASURES)}: end of the window; default the last frame."),
]
Layer = Annotated[
    float, typer.Option(help=f"{taking('layer', MEASURES)}: thickness of a layer, in mean diameters.")
]
Fps = Annotated[
    float,
    typer.Option(
        help=f"{taking('fps', MEASURES)}: frames of the film per second; the run needs four times as many."
    ),
]
Resolution = Annotated[
    float,
    typer.Option(
        help=f"{taking('resolution', MEASURES)}: gap below which grains look as if they touched, in mean "
        "diameters."
    ),
]
Window = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('window', MEASURES)}: length of the windows that the record is cut into; default "
        "1 s for paths, 0.01 s for vibration, 5 sqrt(d/g) for rods. For loads the time over which the "
        "largest is averaged, default that between two frames."
    ),
]
Threshold = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('threshold', MEASURES)}: a grain vibrates if its height varies by more than this "
        "within a window; default 0.001 mean diameters."
    ),
]
At = Annotated[
    str | None, typer.Option(help=f"{taking('t', MEASURES)}: time of the frame; default the last frame.")
]
Material = Annotated[
    str | None,
    typer.Option(help=f"{taking('material', MEASURES)}: only the grains of this material; default all."),
]
Side = Annotated[
    str, typer.Option(help=f"{taking('side', MEASURES)}: slope of a heap, {' or '.join(SIDES)}.")
]
Bed = Annotated[str, of_row("bed", MEASURES)]
Dam = Annotated[str | None, of_row("dam", MEASURES)]
Reach = Annotated[str | None, of_row("reach", MEASURES)]


class _Measure(TyperCommand):
    """Names the argument that is missing: a single one is taken for the last, WHAT."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Refuse a run without WHAT."""
        typed = self.make_parser(ctx).parse_args(list(args))[0]
        names = [one.name for one in MEASURES]
        if not typed.get("runs") and typed.get("what") not in (None, *names):
            raise CaseError("WHAT", None, f"missing after {typed['what']}; must be one of {', '.join(names)}")
        return super().parse_args(ctx, args)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("measure", cls=_Measure, help=listed(measure.__doc__ or "", MEASURES))(measure)


def measure(
    context: typer.Context,
    runs: Runs,
    what: What,
    csv: Csv = None,
    series: SeriesFile = None,
    layers: LayersFile = None,
    json: Json = False,
    settle: Settle = None,
    rise: Rise = 0.1,
    begin: Begin = None,
    end: End = None,
    layer: Layer = 0.5,
    fps: Fps = 250.0,
    resolution: Resolution = 0.05,
    window: Window = None,
    threshold: Threshold = None,
    at: At = None,
    side: Side = "right",
    material: Material = None,
    bed: Bed = "packed",
    dam: Dam = None,
    reach: Reach = None,
) -> None:
    """Measure a run and print averages with standard errors, or a table; --csv writes the numbers.

    Of several runs, the averages are pooled: the mean of the runs, with the error between them.

    An average is printed with its standard error, the number of samples, the
    window in time and whether the record is steady. An option that a measure
    does not take is an error.
    """
    refuse_swapped("measure", runs[0], [what], MEASURES)
    entry = entry_of(what, MEASURES, "measure")
    opened = [open_run(run) for run in runs]
    records: list[Any] = []
    printed: dict[str, Any] = {}
    for results in opened:
        given = keywords(context, entry, results, CHECKS)
        printed = {name: given.pop(name) for name in entry.printing if name in given}
        with naming(results, entry.name):
            records.append(called(entry)(results, **given))
    found: Any = records[0] if len(records) == 1 else _pooled(entry.name, opened, records)
    files = {"--series": (series, _series), "--layers": (layers, _layers)}
    for option, (path, rows_of) in files.items():
        if path is not None and len(records) > 1:
            raise CaseError(option, str(path), "takes one run; --csv writes the averages of several")
        if path is not None:
            typer.echo(f"wrote {write_rows(path, rows_of(entry.name, found))}", err=json)
    averages = getattr(found, "averages", None)
    rows = found.rows() if averages is None else averages.rows()
    if csv is not None:
        typer.echo(f"wrote {write_rows(csv, rows)}", err=json)
    if json:
        typer.echo(_as_json(entry.name, runs, rows, () if averages is None else averages.remarks))
        return
    from ryusa.cli.printing import print_averages, print_found

    if len(records) > 1:
        print_averages(found.averages)
    else:
        print_found(entry.name, found, opened[0], **printed)


@dataclass(frozen=True)
class _Pooled:
    """Averages of several runs, printed as those of one."""

    averages: "Averages"


def _pooled(name: str, opened: "Sequence[Results]", records: Sequence[Any]) -> _Pooled:
    from ryusa.measure.pooled import pooled
    from ryusa.running.resume import changes_of

    if not all(hasattr(one, "averages") for one in records):
        raise ResultsError(f"{name} has no averages that could be pooled; measure its runs one by one")
    found = pooled([one.averages for one in records])
    differ: dict[str, None] = {}
    for results in opened[1:]:
        for change in changes_of(opened[0].case, results.case):
            differ.setdefault(change.split(" ", 1)[0])
    differ.pop("seed", None)
    if differ:
        note = f"the cases differ in more than their seed: {', '.join(differ)}"
        found = replace(found, notes=(note, *found.notes))
    return _Pooled(found)


def _series(name: str, found: Any) -> list[dict[str, object]]:
    rows = found.series() if hasattr(found, "series") else []
    if not rows:
        raise ResultsError(f"{name} keeps no series behind its averages; --csv writes its numbers")
    return rows


def _layers(name: str, found: Any) -> list[dict[str, object]]:
    rows = found.rows()
    if not rows or "z_m" not in rows[0]:
        raise ResultsError(
            f"{name} has no layers over height; profile, water, stress, contact_stress and coordination have"
        )
    return rows


def _as_json(name: str, runs: Sequence[Path], rows: list[dict[str, object]], remarks: Sequence[str]) -> str:
    """One object: measure, runs, rows, remarks; what is not finite is null."""

    def plain(value: object) -> object:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return dumps(
        {
            "measure": name,
            "runs": [str(run) for run in runs],
            "rows": [{key: plain(value) for key, value in row.items()} for row in rows],
            "remarks": list(remarks),
        },
        indent=1,
        ensure_ascii=False,
    )
