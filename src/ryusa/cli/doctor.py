"""`ryusa doctor`: what this machine and installation are."""

import typer

_WIDE = 13  # columns of the heading of a line


def register(app: typer.Typer) -> None:
    """Put the commands of this module on the app."""
    app.command()(doctor)


def doctor() -> None:
    """Say what runs depend on here: versions, processor, threads, numba's cache, engines that can step."""
    from ryusa.running.doctor import diagnosis

    for name, finding in diagnosis():
        typer.echo(f"{name:<{_WIDE}}{finding}")
