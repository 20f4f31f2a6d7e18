"""What is wrong with a text that is no TOML, and what to write instead."""

import re

_KEY = re.compile(r"""\s*([\w."'-]+)\s*=""")
_AT = re.compile(r"at line (\d+)")
_BOOLEAN = re.compile(r"=\s*(true|false|yes|no|on|off)\b", re.IGNORECASE)
_COMMA = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*(?:#|$)")
_QUANTITY = re.compile(r"=\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?\s*[A-Za-zµμ%°][^#\"']*?)\s*(?:#|$)")
_WORD = re.compile(r"=\s*([A-Za-z][\w. -]*?)\s*(?:#|$)")
_LONGEST = 80  # characters shown of a line


def toml_fault(text: str, error: ValueError) -> str:
    """The complaint of the reader of TOML, with the line it is about and a remedy where one is known."""
    found = _AT.search(str(error))
    if found is None:
        return str(error)
    line = text.split("\n")[int(found[1]) - 1].strip()
    hint = _remedy(str(error), line)
    return f"{error}, {line[:_LONGEST]}{f': {hint}' if hint else ''}"


def encoding_fault(error: UnicodeDecodeError) -> str:
    """Where a file stops being UTF-8, and the remedy."""
    line = error.object[: error.start].count(b"\n") + 1
    return (
        f"is not UTF-8 text: line {line} holds a character in another encoding (byte {error.start}); save "
        "the file as UTF-8 in your editor, or write that line without accents"
    )


def _remedy(said: str, line: str) -> str:
    key = found[1] if (found := _KEY.match(line)) else "the key"
    if any(sign in line for sign in "\u201c\u201d\u201e\u201f\u2018\u2019\u201a\u00ab\u00bb"):
        return "write plain quotes, \" or '"
    if said.startswith("Cannot overwrite"):
        return f"{key} stands twice in its section; leave one of the two out"
    if said.startswith("Cannot declare"):
        return "this section stands twice; put the keys of both into one"
    if found := _BOOLEAN.search(line):
        return "write true or false, in small letters and without quotes"
    if found := _COMMA.search(line):
        return f"decimals stand behind a point: {key} = {found[1]}.{found[2]}"
    if found := _QUANTITY.search(line) or _WORD.search(line):
        return f'write it in quotes: {key} = "{found[1]}"'
    if line.partition("#")[0].count('"') % 2:
        return "a quote is missing"
    return ""
