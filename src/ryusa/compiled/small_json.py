"""A small file of JSON beside the code, which is read and written without ever being at fault.

Processes that write it at once may lose a number of one another, which costs an estimate and no more.
"""

import contextlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any


def read(file: Path) -> Any:
    """What is in a file; None where there is none, or it is not JSON."""
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def write(file: Path, content: Any) -> None:
    """Write under another name, then rename; a disk that does not take it is no fault."""
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, prefix=".", suffix=".part")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as out:
                json.dump(content, out)
            os.replace(name, file)
        except OSError:
            os.unlink(name)
            raise
