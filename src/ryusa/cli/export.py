"""`ryusa export`: frames of a run as files of other programs."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.options import Begin, End, Quiet, RunFolder, open_run, times_of
from ryusa.spelling import known_word


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(export)


def export(
    run: RunFolder,
    to: Annotated[
        str,
        typer.Option(metavar="FORMAT", help="One of lammps-dump, extxyz, vtu, csv, parquet."),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The file to write. vtu writes a .pvd, with one .vtu a frame in a folder of the same name.",
        ),
    ],
    at: Annotated[
        str | None, typer.Option(metavar="TIME", help="Only the frame nearest to this time, such as 0.5s.")
    ] = None,
    begin: Begin = None,
    end: End = None,
    every: Annotated[int, typer.Option(min=1, metavar="N", help="Write every Nth frame.")] = 1,
    quiet: Quiet = False,
) -> None:
    """Write the grains of a run for another program: LAMMPS, OVITO, ASE, ParaView, a table.

    Free and fixed grains, with position, velocity, spin, diameter and mass, in SI; of clumps also which
    spheres belong together and how they are turned. A case of spheres can start from any of these files but
    parquet.
    """
    from ryusa.errors import CaseError
    from ryusa.formats.export import FORMATS
    from ryusa.formats.export import export as write

    known_word(to, FORMATS, "--to")
    if to == "vtu" and output.suffix != ".pvd":
        raise CaseError("--output", str(output), "must end in .pvd: it lists the .vtu files, one a frame")
    if at is not None and (begin is not None or end is not None or every != 1):
        raise CaseError("--at", at, "excludes --begin, --end and --every")
    window = times_of(at=at, begin=begin, end=end)
    results = open_run(run)
    from ryusa.cli.progress import shown_progress

    with shown_progress("frames", quiet=quiet) as progress:
        paths = write(results, output, to, every=every, progress=progress, **window)
    size = sum(one.stat().st_size for one in paths)
    more = f", its frames in {output.with_suffix('')}" if len(paths) > 1 else ""
    typer.echo(f"wrote {paths[0]}{more} ({size / 1e6:.1f} MB)")
