"""`ryusa doctor`: report on the machine and the installation."""

import typer

_WIDE = 15  # columns of the heading of a line


def register(app: typer.Typer) -> None:
    """Put the commands of this module on the app."""
    app.command()(doctor)


def doctor() -> None:
    """Report what runs depend on: versions, processor, threads, cache of compiled code, available engines."""
    from ryusa.running.doctor import diagnosis

    for name, finding in diagnosis():
        typer.echo(f"{name:<{_WIDE}}{finding}")
