"""The TOML file of a calibration."""

import math
import tomllib
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from ryusa.campaigns.calibrate.definition import CalibrationAsked, Observation, Target
from ryusa.campaigns.calibrate.heaps import read_test
from ryusa.campaigns.calibrate.prior import LOG, NORMAL, UNIFORM, Prior
from ryusa.campaigns.sweep.definition import text_of
from ryusa.campaigns.sweep.design import span_of
from ryusa.casefile.files import toml_text
from ryusa.casefile.toml_faults import encoding_fault, toml_fault
from ryusa.catalogue import MEASURES
from ryusa.errors import CaseError, ParseError
from ryusa.spelling import nearest_word
from ryusa.units import UnitError, quantity

MOST = 8  # parameters: an emulator of more needs more runs than a calibration is meant for
_TABLES = ("calibrate", "parameters", "observations", "predictions")
_SETTINGS = ("points", "seeds", "rounds", "more", "design_seed", "set")
_PARAMETER = ("key", "low", "high", "scale", "mean", "sd")
_NAMED = ("case", "measure", "quantity")
_TARGET = (*_NAMED, "at")
_OBSERVATION = (*_TARGET, "value", "error", "discrepancy", "test")

# quantities of a measure beside the `numbers` of its line in the catalogue; * for names of the case
FURTHER: dict[str, tuple[str, ...]] = {
    "saltation": ("contact_time*", "bounce_time", "contacts_per_bounce", "impulse_*"),
    "spin": ("rolling", "water_turn", "beyond_dennis"),
    "rods": ("null_share", "kept"),
    "water": ("surface", "bed"),
    "transport": ("tau_star",),
    "contact_stress": ("fabric_*",),
    "surface": ("floor", "largest_*", "moving_share", "slope*", "time"),
    "discharge": ("grains_in", "grains_out", "in by *", "out by *"),
}


def read_calibration(path: Path) -> CalibrationAsked:
    """Read the file of a calibration.

    Raises
    ------
    CaseError : names the key, its value and what is allowed; all faults of the file together.
    ParseError : the file is no TOML.
    """
    text = ""
    try:
        text = toml_text(path)
        data = tomllib.loads(text)
    except OSError as error:
        raise CaseError(
            "study", str(path), f"cannot be read ({error.strerror or error}); needs a TOML file"
        ) from None
    except UnicodeDecodeError as error:
        raise ParseError(path.name, 1, 1, encoding_fault(error)) from None
    except tomllib.TOMLDecodeError as error:
        raise ParseError(path.name, 1, 1, f"is no TOML: {toml_fault(text, error)}") from None
    if "grains" in data:
        raise CaseError(
            "study", path.name, "is a case; a calibration is a file of its own, which names cases "
            "(docs/calibration.md)",
        )  # fmt: skip
    faults: list[CaseError] = []
    found: Any = None
    with _gathered(faults):
        _known("", data, _TABLES)
    settings = _settings(data.get("calibrate", {}), faults)
    priors = _each(data, "parameters", faults, _prior)
    observations = _each(data, "observations", faults, lambda at, one: _observation(at, one, path.parent))
    predictions = _each(
        data, "predictions", faults, lambda at, one: _target(at, one, path.parent, _TARGET), needed=False
    )
    with _gathered(faults):
        _refuse_repeated(priors, observations)
    with _gathered(faults):
        _refuse_namesakes([*(one.target for one in observations), *predictions])
    with _gathered(faults):
        found = CalibrationAsked(
            path.stem, tuple(priors), tuple(observations), tuple(predictions), **settings
        )
        _refuse_numbers(found)
    if faults:
        raise CaseError.together(faults, path.name)
    return found


@contextmanager
def _gathered(faults: list[CaseError]) -> Generator[None]:
    """Within the block a fault is kept in a list instead of raised."""
    try:
        yield
    except CaseError as error:
        faults.append(error)


def _each(
    data: Mapping[str, Any],
    name: str,
    faults: list[CaseError],
    read: Callable[[str, Mapping[str, Any]], Any],
    *,
    needed: bool = True,
) -> list[Any]:
    every = data.get(name, [])
    if not isinstance(every, list) or not all(isinstance(one, dict) for one in every):
        faults.append(CaseError(name, None, f"must be tables [[{name}]]"))
        return []
    if needed and not every:
        faults.append(CaseError(name, None, f"missing; needs one table [[{name}]] or more"))
    found: list[Any] = []
    for k, one in enumerate(every):
        with _gathered(faults):
            found.append(read(f"{name}.{k}", one))
    return found


def _known(at: str, table: Mapping[str, Any], names: Sequence[str]) -> None:
    for name in table:
        if name not in names:
            raise CaseError(
                f"{at}.{name}".lstrip("."), None, f"unknown key; must be one of {', '.join(names)}",
                nearest_word(name, list(names)),
            )  # fmt: skip


def _settings(table: Any, faults: list[CaseError]) -> dict[str, Any]:
    if not isinstance(table, dict):
        faults.append(CaseError("calibrate", table, "must be a table"))
        return {}
    with _gathered(faults):
        _known("calibrate", table, _SETTINGS)
    found: dict[str, Any] = {}
    for name in _SETTINGS[:-1]:
        value = table.get(name)
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int):
            faults.append(CaseError(f"calibrate.{name}", value, "must be a whole number"))
        else:
            found[name] = value
    given = table.get("set", {})
    if not isinstance(given, dict):
        faults.append(
            CaseError("calibrate.set", given, "must be a table of keys of the case and their values")
        )
        return found
    with _gathered(faults):
        found["overrides"] = {key: text_of(key, one) for key, one in given.items()}
    return found


def _refuse_numbers(asked: CalibrationAsked) -> None:
    n = len(asked.priors)
    for name, value, least in (
        ("seeds", asked.seeds, 1), ("rounds", asked.rounds, 0), ("more", asked.more, 1),
        ("design_seed", asked.design_seed, 0),
    ):  # fmt: skip
        if value < least:
            raise CaseError(f"calibrate.{name}", value, f"must be {least} or more")
    power = math.log2(asked.points) if asked.points > 0 else math.nan
    if not power.is_integer() or asked.points < 4 * n:
        raise CaseError(
            "calibrate.points", asked.points,
            f"must be a power of 2, and at least 4 for each of the {n} parameters, such as "
            f"{2 ** math.ceil(math.log2(max(8 * n, 1)))}",
        )  # fmt: skip
    if n > MOST:
        raise CaseError("parameters", n, f"at most {MOST} parameters can be calibrated together")


def _prior(at: str, table: Mapping[str, Any]) -> Prior:
    _known(at, table, _PARAMETER)
    key = table.get("key")
    if not isinstance(key, str) or not key:
        raise CaseError(f"{at}.key", key, "must be a key of the case, such as 'contact.friction_angle'")
    for name in ("low", "high"):
        if name not in table:
            raise CaseError(f"{at}.{name}", None, f"missing; {key} needs the range low to high")
    scale = table.get("scale", "linear")
    try:
        span = span_of(key, table["low"], table["high"], str(scale))
    except CaseError as error:
        raise CaseError(f"{at} ({key})", error.value, error.allowed, error.nearest) from None
    if "mean" not in table and "sd" not in table:
        return Prior(key, LOG if span.log else UNIFORM, span.low, span.high, span.unit)
    if "mean" not in table or "sd" not in table or span.log:
        raise CaseError(f"{at} ({key})", None, "a normal prior has mean and sd, and no scale")
    mean, sd = (_in_unit(f"{at}.{name}", table[name], span.unit) for name in ("mean", "sd"))
    if not sd > 0.0:
        raise CaseError(f"{at}.sd", table["sd"], "must be greater than 0")
    if not span.low <= mean <= span.high:
        raise CaseError(f"{at}.mean", table["mean"], "must lie between low and high")
    return Prior(key, NORMAL, span.low, span.high, span.unit, mean, sd)


def _in_unit(at: str, value: object, unit: str) -> float:
    """A number written in a given unit, or without one where that is empty."""
    text = str(value).strip()
    number = text.removesuffix(unit).strip() if unit else text
    try:
        if unit and number == text:
            raise ValueError
        found = float(number)
    except ValueError:
        raise CaseError(
            at, value, f"must be a number in the unit of low and high, '{unit or 'none'}'"
        ) from None
    if not math.isfinite(found):
        raise CaseError(at, value, "must be finite")
    return found


def _target(at: str, table: Mapping[str, Any], folder: Path, names: Sequence[str]) -> Target:
    _known(at, table, names)
    for name in _NAMED:
        if not isinstance(table.get(name), str) or not table[name]:
            raise CaseError(f"{at}.{name}", table.get(name), "missing; case, measure and quantity are words")
    known = [one.name for one in MEASURES if not one.table]
    if table["measure"] not in known:
        raise CaseError(
            f"{at}.measure", table["measure"], f"must be one of {', '.join(known)}",
            nearest_word(table["measure"], known),
        )  # fmt: skip
    at_height = _height(at, table) if "at" in table else None
    if at_height is None:
        _refuse_quantity(at, table["measure"], table["quantity"])
    return Target(folder / table["case"], table["measure"], table["quantity"], at_height)


def _refuse_quantity(at: str, measure: str, name: str) -> None:
    """Refuse a quantity that no run gives, of the measures whose quantities are known before."""
    numbers = next((one.numbers for one in MEASURES if one.name == measure), ())
    names = [*(one for one, _ in numbers), *FURTHER.get(measure, ())]
    if numbers and not any(fnmatchcase(name, one) for one in names):
        raise CaseError(
            f"{at}.quantity",
            name,
            f"{measure} gives {', '.join(map(repr, names))}",
            nearest_word(name, names),
        )


def _height(at: str, table: Mapping[str, Any]) -> float:
    """Height of a quantity over height [m]."""
    layers = {one.name: one.layers for one in MEASURES if one.layers}
    names = layers.get(table["measure"], ())
    if not names:
        raise CaseError(
            f"{at}.at", table["at"], f"is for a quantity over height, of the measures {', '.join(layers)}"
        )
    if table["quantity"] not in names:
        raise CaseError(
            f"{at}.quantity", table["quantity"], f"at one height, must be one of {', '.join(names)}",
            nearest_word(table["quantity"], names),
        )  # fmt: skip
    try:
        return quantity(table["at"], "m")
    except UnitError as error:
        raise CaseError(f"{at}.at", table["at"], str(error)) from None


def _observation(at: str, table: Mapping[str, Any], folder: Path) -> Observation:
    target = _target(at, table, folder, _OBSERVATION)
    for name in ("value", "error"):
        one = table.get(name)
        if one is None or isinstance(one, bool) or not isinstance(one, (str, int, float)):
            raise CaseError(f"{at}.{name}", one, "missing; needs a quantity with its unit, such as '21 deg'")
    discrepancy = table.get("discrepancy")
    if isinstance(discrepancy, bool) or not isinstance(discrepancy, (str, int, float, type(None))):
        raise CaseError(f"{at}.discrepancy", discrepancy, "must be a quantity with its unit, such as '2 deg'")
    test = read_test(f"{at}.test", table.get("test"), target.measure)
    return Observation(target, table["value"], table["error"], discrepancy, test)


def _refuse_repeated(priors: Sequence[Prior], observations: Sequence[Observation]) -> None:
    keys = [one.key for one in priors]
    for k, key in enumerate(keys):
        if key == "seed":
            raise CaseError(f"parameters.{k}.key", key, "is no parameter; calibrate.seeds says how many")
        if key in keys[:k]:
            raise CaseError(f"parameters.{k}.key", key, "stands there twice")
    targets = [one.target for one in observations]
    for k, target in enumerate(targets):
        if target in targets[:k]:
            raise CaseError(f"observations.{k}", target.words, "was observed twice; combine the two values")


def _refuse_namesakes(targets: Sequence[Target]) -> None:
    """Refuse two cases of one name, whose runs would have the same folders."""
    seen: dict[str, Path] = {}
    for one in targets:
        other = seen.setdefault(one.case.stem, one.case)
        if other != one.case:
            raise CaseError(
                "case", str(one.case), f"has the name of another case, {other}; runs are named by their case"
            )
