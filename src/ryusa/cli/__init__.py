"""The command line; every command is a thin layer over a call that a script can make."""

import gc
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from ryusa.cli.signs import write_plainly
from ryusa.errors import RyusaError
from ryusa.version import described

# one module per family of commands; each puts its commands on the app with `register(app)`
_FAMILIES = (
    "ryusa.cli.run", "ryusa.cli.upgrade", "ryusa.cli.measure", "ryusa.cli.draw", "ryusa.cli.view",
    "ryusa.cli.film", "ryusa.cli.report", "ryusa.cli.export",
    "ryusa.cli.design", "ryusa.cli.sweep", "ryusa.cli.soften", "ryusa.cli.calibrate",
    "ryusa.cli.paper", "ryusa.cli.validate", "ryusa.cli.study", "ryusa.cli.kernels", "ryusa.cli.doctor",
)  # fmt: skip
OBJECTS = 20_000  # made between two searches for garbage; loading modules makes many, and all of them stay
INTERRUPTED = 130  # exit code after Ctrl-C


class Commands(TyperGroup):
    """Commands that report an error of ryusa as one block of text; other exceptions keep their traceback."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was given."""
        try:
            answer = super().invoke(ctx)
            _say_what_pictures_lack()
            return answer
        except RyusaError as error:
            typer.echo(f"ryusa: {error}", err=True)
            raise typer.Exit(error.exit_code) from None
        except Exception as error:  # of click, whose class is private to typer
            said = getattr(error, "message", "")
            if "unexpected extra argument" in said:
                hint = "A value with a blank stands in quotes, such as --set 'water.depth=2 cm'"
                vars(error)["message"] = f"{said}. {hint}"
            raise
        except KeyboardInterrupt as error:
            typer.echo(f"ryusa: interrupted{f': {error}' if str(error) else ''}", err=True)
            raise typer.Exit(INTERRUPTED) from None

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands in the order of a typical workflow."""
        return list(self.commands)


def _say_what_pictures_lack() -> None:
    if (fonts := sys.modules.get("ryusa.figures.fonts")) and (said := fonts.signs_without_font()):
        typer.echo(f"ryusa: {said}", err=True)


app = typer.Typer(
    cls=Commands,
    help="Simulates grains of sand, gravel or debris in flowing water by the distinct element method.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"ryusa {described()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show version and commit."),
    ] = False,
) -> None:
    """Simulate grains of sand, gravel or debris in flowing water by the distinct element method."""


try:
    for _family in _FAMILIES:
        import_module(_family).register(app)
except KeyboardInterrupt:  # while modules are loaded
    typer.echo("ryusa: interrupted", err=True)
    raise SystemExit(INTERRUPTED) from None


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; `arguments` default to those of the process."""
    gc.set_threshold(OBJECTS)
    write_plainly()
    given = sys.argv[1:] if arguments is None else arguments
    app(args=[at_home(one) for one in given], prog_name="ryusa")


def at_home(argument: str) -> str:
    """An argument with its leading ~ as the home folder, which a shell leaves as it is within quotes.

    >>> at_home("--output=~/x") == f"--output={Path.home() / 'x'}", at_home("a~/b")
    (True, 'a~/b')
    """
    option, equals, path = argument.partition("=") if argument.startswith("--") else ("", "", argument)
    return f"{option}{equals}{Path(path).expanduser()}" if path == "~" or path.startswith("~/") else argument
