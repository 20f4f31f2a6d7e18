"""`python -m ryusa` is the command line."""

import subprocess
import sys


def test_python_m_ryusa_is_the_command_line() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ryusa", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("ryusa ")


def test_ctrl_c_while_modules_are_loaded_is_one_line() -> None:
    program = (
        "import importlib\ndef stopped(_): raise KeyboardInterrupt\n"
        "import typer, ryusa.errors\nimportlib.import_module = stopped\nimport ryusa.cli"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "ryusa: interrupted\n")
