"""Signs that the encoding of a terminal lacks, in letters that it has."""

import codecs
import io
import sys

PLAIN = {
    "±": "+-", "–": "-", "─": "-", "−": "-", "°": " deg", "℃": " deg C", "²": "^2", "³": "^3",
    "‰": " per mille", "µ": "u", "μ": "u", "×": "x", "“": '"', "”": '"', "…": "...",
}  # fmt: skip
NAME = "ryusa-plain"


def write_plainly() -> None:
    """Let no sign end a command that prints: under LC_ALL=C, or in a file of another encoding than UTF-8."""
    codecs.register_error(NAME, _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=NAME)


def _plain(error: UnicodeError) -> tuple[str | bytes, int]:
    r"""Put letters for one sign; a sign without such as its number, and a byte of a file's name as it was.

    >>> _plain(UnicodeEncodeError("ascii", "0.1 ± 0.02", 4, 5, "not in range"))
    ('+-', 5)
    >>> _plain(UnicodeEncodeError("ascii", "流砂", 0, 2, "not in range"))
    ('\\u6d41', 1)
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    sign, after = error.object[error.start], error.start + 1
    if "\udc80" <= sign <= "\udcff":  # an argument that could not be decoded
        return bytes([ord(sign) - 0xDC00]), after
    return PLAIN.get(sign, sign.encode("ascii", "backslashreplace").decode("ascii")), after
