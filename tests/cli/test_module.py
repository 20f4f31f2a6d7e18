"""`python -m ryusa` is the command line."""

import subprocess
import sys


def test_python_m_ryusa_is_the_command_line() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ryusa", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("ryusa ")
