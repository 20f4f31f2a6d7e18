"""How long functions took to compile on this machine, by their names, which outlast every change of them.

One small file beside the code (store.py).
"""

from pathlib import Path

from ryusa.compiled import small_json

_FILE = "seconds.json"
_MOST = 4_000  # names, and contents, that are remembered; the latest


class Seconds:
    """What is remembered of earlier compilations.

    Attributes
    ----------
    by_name : processor time [s] of each function's own compilation, by kind and name.
    contents : kinds and contents that have been compiled, and so are likely to be in the store.
    """

    def __init__(self, folder: Path) -> None:
        self._file = folder / _FILE
        self.by_name: dict[str, float] = {}
        self.contents: dict[str, None] = {}
        self._read()

    def _read(self) -> None:
        try:
            found = small_json.read(self._file)
            self.by_name |= {str(name): float(seconds) for name, seconds in found["seconds"].items()}
            self.contents |= dict.fromkeys(str(one) for one in found["contents"])
        except (ValueError, TypeError, KeyError, AttributeError):
            return  # none yet, or not ours

    def add(self, by_name: dict[str, float], contents: list[str]) -> None:
        """Remember more; a disk that does not take it is no fault."""
        self._read()  # what other processes have added
        for name in by_name:
            self.by_name.pop(name, None)  # the latest comes last
        self.by_name |= {name: round(seconds, 3) for name, seconds in by_name.items()}
        self.contents |= dict.fromkeys(contents)
        self._write()

    def forget_contents(self) -> None:
        """The store has been emptied; the seconds stay."""
        self.contents = {}
        if self.by_name:
            self._write()

    def _write(self) -> None:
        found = {
            "seconds": dict(list(self.by_name.items())[-_MOST:]),
            "contents": list(self.contents)[-_MOST:],
        }
        small_json.write(self._file, found)
