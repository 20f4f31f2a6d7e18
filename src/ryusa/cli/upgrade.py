"""`ryusa upgrade`: a case file of an earlier version in the words of this one."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.run import CaseFile


def register(app: typer.Typer) -> None:
    """Put the command of this module on the app."""
    app.command()(upgrade)


def upgrade(
    case: CaseFile,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", metavar="FILE", help="File to write; CASE itself when not given."),
    ] = None,
    as_before: Annotated[
        bool,
        typer.Option(
            "--as-before", help="Also write the values that CASE leaves out and that were others before."
        ),
    ] = False,
) -> None:
    """Rewrite a case file of an earlier version for this one; comments stay.

    It says what it wrote, and which keys that the file leaves out had other values before.
    """
    from ryusa.casefile.files import toml_text
    from ryusa.casefile.read import read
    from ryusa.casefile.upgrade import upgrade as upgraded
    from ryusa.errors import RyusaError
    from ryusa.running.disk import write_atomically

    read(case)  # every fault of a file that cannot be read
    found, target = upgraded(toml_text(case), path=case, as_before=as_before), out or case
    if not found.written:
        typer.echo(f"{case}: is in the words of this version")
    if found.written or out is not None:
        try:
            write_atomically(target, found.text.encode())
        except OSError as error:
            raise RyusaError(f"{target}: cannot be written ({error.strerror or error})") from error
    for key, value in found.written.items():
        typer.echo(f"{target}: written {key} = {value}")
    for key, value in found.open.items():
        typer.echo(f"{target}: leaves out {key}, which was {value} before ryusa 1; --as-before writes it")
