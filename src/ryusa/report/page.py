"""Write the ledger: JSON, and one page that needs nothing but itself."""

import json
from pathlib import Path

from ryusa.report.ledger import Ledger


def write(ledger: Ledger, copy: Path | None = None) -> tuple[Path, ...]:
    """Write ledger.json into the folder of the ledger, and a copy where asked.

    Raises
    ------
    OSError : a file cannot be written.
    """
    text = json.dumps(ledger.plain(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    files = [ledger.folder / "ledger.json"]
    if copy is not None:
        copy.parent.mkdir(parents=True, exist_ok=True)
        files.append(copy)
    for path in files:
        path.write_text(text, encoding="utf-8")
    return tuple(files)
