"""What `--help` prints is what is written: brackets in a text must not be taken for markup."""

from typing import Any

import pytest
import typer
from rich.text import Text

from ryusa.cli import app


def walk(command: Any, name: str) -> list[tuple[str, Any]]:
    found = [(name, command)]
    for key, one in getattr(command, "commands", {}).items():
        found += walk(one, f"{name} {key}".strip())
    return found


@pytest.mark.parametrize(("name", "command"), walk(typer.main.get_command(app), ""))
def test_no_part_of_a_help_text_is_taken_for_markup(name: str, command: Any) -> None:
    texts = [command.help, *(getattr(one, "help", None) for one in command.params)]
    for text in (one.replace("\b", "") for one in texts if one):
        assert Text.from_markup(text).plain == text, name
