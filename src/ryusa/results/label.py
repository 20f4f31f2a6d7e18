"""What a run is called where runs are told apart: a legend, a column, the caption of a picture."""

import re
from typing import Any

_DIGITS = re.compile(r"(?:^|-)(?=[0-9]*[a-f])[0-9a-f]{8}$")  # of studies, `study.task`; a date has no letter
_SIGNS = re.compile(r"[^A-Za-z0-9.+-]+")  # of a value, left out of the name of a folder (campaigns.sweep)
_QUOTES = "'\""
_LONGEST = 60  # letters of such a name, which may end within a value


def run_label(results: Any) -> str:
    """Name of a run: of a sweep what varies in it, in words, else the name of its folder.

    Digits by which folders of a study or a sweep are told apart are left out.

    Parameters
    ----------
    results : `results.Results`, or what has its `folder` and `provenance`.
    """
    name = results.folder.resolve().name
    overrides: dict[str, str] = getattr(results, "provenance", {}).get("overrides", {})
    return ", ".join(_varied(re.sub("-[0-9a-f]{8}$", "", name), overrides)) or _DIGITS.sub("", name) or "run"


def _varied(name: str, overrides: dict[str, str]) -> list[str]:
    """Overrides of which the name of a folder consists, in words; none where it is another name.

    >>> _varied("friction_angle-30deg_seed-2", {"contact.friction_angle": "30 deg", "seed": "2"})
    ['friction angle 30 deg', 'seed 2']
    """
    words = {
        f"{word}-{_SIGNS.sub('', value)}_": f"{word.replace('_', ' ')} {value.strip(_QUOTES)}"
        for key, value in overrides.items()
        for word in (key, key.rsplit(".", 1)[-1])
    }
    found, rest, cut = list[str](), f"{name}_", len(name) >= _LONGEST
    while rest:
        part = next((one for one in words if rest.startswith(one) or (cut and one.startswith(rest[:-1]))), "")
        if not part:
            return []
        found.append(words[part])
        rest = rest[len(part) :]
    seed = words[f"seed-{overrides['seed']}_"] if cut and "seed" in overrides else ""
    return [*found, seed] if seed and seed not in found else found
