"""A terminal that lacks a sign gets letters for it, and no command ends of it."""

import io
import os
import subprocess
import sys

import pytest

from ryusa.cli import signs


@pytest.mark.parametrize(
    ("printed", "encoding", "shown"),
    [
        ("q = 0.1 ± 0.02 m²/s, 3 µs", "ascii", b"q = 0.1 +- 0.02 m^2/s, 3 us"),
        ("q = 0.1 ± 0.02 m²/s", "latin-1", b"q = 0.1 \xb1 0.02 m\xb2/s"),
        ("流砂 ± 1", "euc-jp", "流砂 ± 1".encode("euc-jp")),
        ("河床.toml", "ascii", b"\\u6cb3\\u5e8a.toml"),
        ("a\udce6b.toml", "ascii", b"a\xe6b.toml"),  # as Python hands over a name that it could not decode
    ],
)
def test_what_a_terminal_lacks(
    printed: str, encoding: str, shown: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(kept, encoding=encoding))
    signs.write_plainly()
    print(printed, end="", flush=True)
    assert kept.getvalue() == shown


def test_a_command_on_an_ascii_terminal() -> None:
    asked = (
        r"from ryusa.cli import main, app; app.command('signs')(lambda: print('1 \xb1 2')); main(['signs'])"
    )
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": ""}
    words = [sys.executable, "-c", asked]
    done = subprocess.run(words, env={**os.environ, **plain}, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == b"1 +- 2"
